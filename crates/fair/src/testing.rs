//! Random numbers for tests: a generator of our own, so that figures recur anywhere.

/// The linear congruential generator u <- (1103515245 u + 12345) mod 2^31.
pub(crate) struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Uniform in [-1/2, 1/2).
    pub fn unit(&mut self) -> f64 {
        self.0 = (1_103_515_245 * self.0 + 12_345) % (1 << 31);
        self.0 as f64 / (1u64 << 31) as f64 - 0.5
    }
}
