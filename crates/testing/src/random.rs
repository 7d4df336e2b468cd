//! Generators of random numbers with a stated seed: the same sequence on every machine and in every run.

use moldloft_num::Vec3;

/// SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A number in [`low`, `high`).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A number of three decimals in [`low`, `high`].
    pub fn decimal(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low, high) * 1000.0).round() / 1000.0
    }

    /// A whole number in 0 .. `limit`.
    ///
    /// # Panics
    /// When `limit` is 0.
    pub fn below(&mut self, limit: usize) -> usize {
        (self.bits() % limit as u64) as usize
    }

    /// True `percent` times in a hundred.
    pub fn chance(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }

    /// One of `items`.
    ///
    /// # Panics
    /// If it is empty.
    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }

    /// A point of the cube [-1, 1)^3.
    pub fn point(&mut self) -> Vec3<f64> {
        Vec3::of(self.signed(), self.signed(), self.signed())
    }

    /// `n` points of the cube [-1, 1)^3.
    pub fn points(&mut self, n: usize) -> Vec<Vec3<f64>> {
        (0..n).map(|_| self.point()).collect()
    }
}

/// Marsaglia's xorshift (J. Stat. Softw. 8 (2003), 14), which the random models of the derivative laws are
/// drawn with: their seeds are known to be quick. For anything else take [`Random`].
#[derive(Clone, Debug)]
pub struct Xorshift(u64);

impl Xorshift {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Xorshift(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// A whole number in 0 .. `limit`.
    ///
    /// # Panics
    /// When `limit` is 0.
    pub fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) % limit as u64) as usize
    }

    /// A number of three decimals in [`low`, `high`].
    pub fn decimal(&mut self, low: f64, high: f64) -> f64 {
        let x = low + (high - low) * self.below(1 << 20) as f64 / f64::from(1 << 20);
        (x * 1000.0).round() / 1000.0
    }

    /// One of `items`.
    ///
    /// # Panics
    /// If it is empty.
    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }
}

/// The linear congruential generator u <- (1103515245 u + 12345) mod 2^31, which the recorded figures of
/// fairing are computed with. Weak in its low bits: for anything else take [`Random`].
#[derive(Clone, Debug)]
pub struct Lcg(u64);

impl Lcg {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Lcg(seed)
    }

    /// A number in [-1/2, 1/2).
    pub fn centred(&mut self) -> f64 {
        self.0 = (1_103_515_245 * self.0 + 12_345) % (1 << 31);
        self.0 as f64 / (1u64 << 31) as f64 - 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first outputs of the reference implementation (Vigna, splitmix64.c) for seed 1234567.
    #[test]
    fn splitmix_is_the_published_one() {
        let mut random = Random::new(1_234_567);
        assert_eq!(random.bits(), 6_457_827_717_110_365_317);
        assert_eq!(random.bits(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn ranges_and_means() {
        let mut random = Random::new(3);
        let n = 20_000;
        let (mut sum, mut low, mut high) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..n {
            let x = random.between(-2.0, 4.0);
            (sum, low, high) = (sum + x, low.min(x), high.max(x));
            assert!(random.below(7) < 7 && random.signed().abs() <= 1.0);
        }
        // Five standard deviations of the mean.
        assert!((sum / f64::from(n) - 1.0).abs() < 5.0 * 6.0 / (12.0 * f64::from(n)).sqrt());
        assert!((-2.0..-1.99).contains(&low) && (3.99..4.0).contains(&high));
    }
}
