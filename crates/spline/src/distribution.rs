//! Distributions: `n` numbers from `start` to `end`, spaced by a law, for grids.
//!
//! The first and last number are the given ones to the bit. Spacings are positive lengths whatever
//! the direction. Unknowns of a law are solved for in plain numbers, and one more Newton step gives
//! their derivatives (implicit function theorem).

use crate::even_functions::{cos_of_sq, sinc_of_sq};
use moldloft_num::{Dual, Real, find_root};
use std::f64::consts::FRAC_PI_2;
use std::fmt;

/// Reason why there is no such distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DistributionError {
    /// Too few numbers.
    TooFew {
        /// The minimum for this law.
        expected: usize,
        /// The given number.
        actual: usize,
    },
    /// A limit or spacing is NaN or infinite, or the limits coincide although a spacing is given.
    Limits {
        /// The start.
        start: f64,
        /// The end.
        end: f64,
    },
    /// A spacing is negative, NaN, or zero where the law needs a positive one.
    Spacing {
        /// The spacing.
        spacing: f64,
    },
    /// Spacings at both ends were given to a one-sided law.
    TwoSided {
        /// The spacings.
        spacings: [f64; 2],
    },
    /// No distribution of this law has these spacings.
    Unreachable {
        /// The given spacings.
        spacings: [f64; 2],
        /// The distance to be divided.
        length: f64,
        /// The number of cells.
        cells: usize,
    },
}

impl fmt::Display for DistributionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooFew { expected, actual } => {
                write!(f, "expected at least {expected} numbers, found {actual}")
            }
            Self::Limits { start, end } => {
                write!(f, "expected two different finite limits, found {start} and {end}")
            }
            Self::Spacing { spacing } => {
                write!(f, "expected a positive spacing, found {spacing}")
            }
            Self::TwoSided { spacings: [a, b] } => write!(
                f,
                "this law takes a spacing at one end only (0 at the other), found {a} and {b}"
            ),
            Self::Unreachable { spacings: [a, b], length, cells } => write!(
                f,
                "no division of {length} into {cells} cells has the end spacings {a} and {b}"
            ),
        }
    }
}

impl std::error::Error for DistributionError {}

type Result<T> = std::result::Result<Vec<T>, DistributionError>;

/// Equal steps from `start` to `end`.
///
/// # Errors
/// [`DistributionError`] for n < 2 or limits that are not finite; the same for all laws here.
///
/// # Example
/// ```
/// let fives = moldloft_spline::distribution::uniform(0.0, 10.0, 3).unwrap();
/// assert_eq!(fives, [0.0, 5.0, 10.0]);
/// ```
pub fn uniform<T: Real>(start: T, end: T, n: usize) -> Result<T> {
    check(start, end, n, 2)?;
    let step = 1.0 / (n - 1) as f64;
    Ok(fill(start, end, n, |i, j| (T::from(i as f64 * step), T::from(j as f64 * step))))
}

/// Steps of equal angle on a half circle: start + (end - start) (1 - cos pi x) / 2, x uniform.
///
/// # Errors
/// As [`uniform`].
pub fn cosine<T: Real>(start: T, end: T, n: usize) -> Result<T> {
    check(start, end, n, 2)?;
    let step = FRAC_PI_2 / (n - 1) as f64;
    // (1 - cos 2a) / 2 = sin^2 a, which keeps the digits of the small first steps.
    let share = |i: usize| T::from(libm::sin(i as f64 * step).powi(2));
    Ok(fill(start, end, n, |i, j| (share(i), share(j))))
}

/// Cells that grow by a constant ratio, starting with `first`.
///
/// # Errors
/// As [`uniform`]; [`DistributionError::Unreachable`] unless `first` is less than the distance.
pub fn geometric<T: Real>(start: T, end: T, first: T, n: usize) -> Result<T> {
    check(start, end, n, 2)?;
    spacing(first, f64::MIN_POSITIVE)?;
    let length = distance(start, end)?;
    let cells = n - 1;
    if cells == 1 {
        return uniform(start, end, n);
    }
    let growth =
        GeometricGrowth::solve(length / first, cells).ok_or(DistributionError::Unreachable {
            spacings: [first.re(), 0.0],
            length: length.re(),
            cells,
        })?;
    let mut all = fill(start, end, n, |i, _| {
        let share = growth.sum(i) * first / length;
        (share, -share + 1.0)
    });
    all[1] = start + (end - start) * (first / length);
    Ok(all)
}

/// Cells that grow by one constant ratio from both ends inward, `first` and `last` being the end
/// cells. The cell at which the two progressions meet is chosen for the smallest jump between them;
/// the choice follows the real parts.
///
/// # Errors
/// As [`geometric`]; at least three numbers, and `first + last` less than the distance if there are
/// more.
pub fn geometric2<T: Real>(start: T, end: T, first: T, last: T, n: usize) -> Result<T> {
    check(start, end, n, 4)?;
    spacing(first, f64::MIN_POSITIVE)?;
    spacing(last, f64::MIN_POSITIVE)?;
    let length = distance(start, end)?;
    let cells = n - 1;
    let (a, b, l) = (first.re(), last.re(), length.re());
    let unreachable = DistributionError::Unreachable { spacings: [a, b], length: l, cells };
    // Growth for m cells from the start, and ratio of the two cells at the junction.
    let total = |m: usize, r: f64| (a * growth_sum(r, m) + b * growth_sum(r, cells - m)) / l;
    let solve = |m: usize| -> Option<(f64, f64)> {
        let bound = 2.0 + libm::log((l / a).max(l / b)).abs();
        let r = find_root(|r| libm::log(total(m, r)), -bound, bound).ok()?;
        let meet = libm::log(a / b) + (m as f64 - (cells - m) as f64) * r;
        Some((r, meet))
    };
    if a + b >= l {
        return Err(unreachable);
    }
    let (mut low, mut high) = (1, cells - 1);
    let at_low = solve(low).ok_or(unreachable)?.1;
    let at_high = solve(high).ok_or(unreachable)?.1;
    if at_low * at_high < 0.0 {
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            let meet = solve(middle).ok_or(unreachable)?.1;
            if meet * at_low > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
    }
    let unevenness = |m: usize| solve(m).map_or(f64::INFINITY, |(_, meet)| meet.abs());
    let m = if unevenness(low) <= unevenness(high) { low } else { high };
    let (r, _) = solve(m).ok_or(unreachable)?;
    let sum = |r: T, m: usize| growth_sum(r, m);
    let residual = (sum(T::from(r), m) * first + sum(T::from(r), cells - m) * last) / length;
    let slope = {
        let r = Dual::<1>::seeded(r, 0);
        (growth_sum(r, m) * a + growth_sum(r, cells - m) * b).eps[0] / l
    };
    let r = (residual - residual.re()) * (-1.0 / slope) + r;
    let mut all = fill(start, end, n, |i, j| {
        if i <= m {
            let share = growth_sum(r, i) * first / length;
            (share, -share + 1.0)
        } else {
            let share = growth_sum(r, j) * last / length;
            (-share + 1.0, share)
        }
    });
    let direction = (end - start) / length;
    all[1] = start + direction * first;
    all[n - 2] = end - direction * last;
    Ok(all)
}

/// One-sided hyperbolic sine law (Thompson, Warsi and Mastin 1985, ch. VIII): the slope is
/// `start_spacing` or `end_spacing` per step at that end; the other must be 0. Both 0: uniform. A
/// sine is used if the spacing is wider than uniform.
///
/// # Errors
/// As [`uniform`]; [`DistributionError::TwoSided`], [`DistributionError::Unreachable`] for a
/// spacing above pi/2 times the uniform one.
pub fn d_sinh<T: Real>(start: T, end: T, start_spacing: T, end_spacing: T, n: usize) -> Result<T> {
    check(start, end, n, 2)?;
    spacing(start_spacing, 0.0)?;
    spacing(end_spacing, 0.0)?;
    let spacings = [start_spacing.re(), end_spacing.re()];
    let (near, mirrored) = match spacings {
        [0.0, 0.0] => return uniform(start, end, n),
        [_, 0.0] => (start_spacing, false),
        [0.0, _] => (end_spacing, true),
        _ => return Err(DistributionError::TwoSided { spacings }),
    };
    let (length, cells) = (distance(start, end)?, n - 1);
    let unreachable = DistributionError::Unreachable { spacings, length: length.re(), cells };
    let b = length / (near * cells as f64);
    if b.re() < 1.0 / FRAC_PI_2 || b.re() > LARGEST {
        return Err(unreachable);
    }
    let w = inverse_sinhc(b);
    let whole = T::one() / sinhc(w);
    let share = |i: usize| {
        let x = i as f64 / cells as f64;
        sinhc(w * (x * x)) * whole * x
    };
    Ok(fill(start, end, n, |i, j| {
        let near = share(if mirrored { j } else { i });
        if mirrored { (-near + 1.0, near) } else { (near, -near + 1.0) }
    }))
}

/// Hyperbolic tangent law of Vinokur (J. Comput. Phys. 50, 1983, p. 215): the slopes at the ends
/// are `start_spacing` and `end_spacing` per step, with 0 for a free end (both free: uniform).
///
/// The spacings are slopes, so the first and last cells differ from them by the curvature of the
/// law; [`d_tanhx`] has exact cells. Tangent and hyperbolic tangent are one entire function here,
/// so nothing special happens where spacings are uniform or wider.
///
/// # Errors
/// As [`uniform`]; [`DistributionError::Unreachable`] for spacings below 1e-300 of the distance.
pub fn d_tanh<T: Real>(start: T, end: T, start_spacing: T, end_spacing: T, n: usize) -> Result<T> {
    check(start, end, n, 2)?;
    spacing(start_spacing, 0.0)?;
    spacing(end_spacing, 0.0)?;
    if start_spacing.re() == 0.0 && end_spacing.re() == 0.0 {
        return uniform(start, end, n);
    }
    let (length, cells) = (distance(start, end)?, n - 1);
    let law = TanhLaw::new([start_spacing / length, end_spacing / length], cells);
    let law = law.ok_or(DistributionError::Unreachable {
        spacings: [start_spacing.re(), end_spacing.re()],
        length: length.re(),
        cells,
    })?;
    Ok(fill(start, end, n, |i, _| law.shares(i)))
}

/// The law of [`d_tanh`] with slopes such that the first and last *cells* are `first` and `last`,
/// with 0 for a free end.
///
/// # Errors
/// As [`d_tanh`]; at least four numbers, and [`DistributionError::Unreachable`] unless the law can
/// have both cells with others between them.
pub fn d_tanhx<T: Real>(start: T, end: T, first: T, last: T, n: usize) -> Result<T> {
    check(start, end, n, 4)?;
    spacing(first, 0.0)?;
    spacing(last, 0.0)?;
    if first.re() == 0.0 && last.re() == 0.0 {
        return uniform(start, end, n);
    }
    let (length, cells) = (distance(start, end)?, n - 1);
    let spacings = [first.re(), last.re()];
    let unreachable = DistributionError::Unreachable { spacings, length: length.re(), cells };
    if spacings[0] + spacings[1] >= length.re() {
        return Err(unreachable);
    }
    let wanted = [first / length, last / length];
    let slopes = slopes_of_cells(wanted, cells).ok_or(unreachable)?;
    let law = TanhLaw::new(slopes, cells).ok_or(unreachable)?;
    let mut all = fill(start, end, n, |i, _| law.shares(i));
    let direction = (end - start) / length;
    if spacings[0] > 0.0 {
        all[1] = start + direction * first;
    }
    if spacings[1] > 0.0 {
        all[n - 2] = end - direction * last;
    }
    Ok(all)
}

/// `n` numbers with the law of the given ones: their linear interpolation by index.
///
/// # Errors
/// [`DistributionError::TooFew`] for n < 2 or fewer than two given numbers.
pub fn redist<T: Real>(given: &[T], n: usize) -> Result<T> {
    let actual = given.len().min(n);
    if actual < 2 {
        return Err(DistributionError::TooFew { expected: 2, actual });
    }
    let (cells, steps) = (given.len() - 1, n - 1);
    // Index i * cells / steps, split into whole and fraction in integers: exact at the ends.
    let at = |i: usize| {
        let position = i as u128 * cells as u128;
        let (k, rest) = (position / steps as u128, position % steps as u128);
        let (k, share) = (k as usize, rest as f64 / steps as f64);
        if share == 0.0 { given[k] } else { given[k] * (1.0 - share) + given[k + 1] * share }
    };
    Ok((0..n).map(at).collect())
}

/// The largest ratio of neighbouring cells, the larger over the smaller; 1 for fewer than two
/// cells.
///
/// # Example
/// ```
/// assert_eq!(moldloft_spline::distribution::growth(&[1.0, 2.0, 1.5]), 2.0);
/// ```
pub fn growth<T: Real>(cells: &[T]) -> T {
    let ratio = |c: &[T]| if c[0].re() < c[1].re() { c[1] / c[0] } else { c[0] / c[1] };
    cells.windows(2).map(ratio).fold(T::one(), T::max)
}

/// The first cell of `n` numbers over `length` whose cells grow by the ratio `growth`.
///
/// # Example
/// ```
/// use moldloft_spline::distribution::first_for;
/// assert_eq!((first_for(7.0, 2.0, 4), first_for(3.0, 1.0, 4)), (1.0, 1.0));
/// ```
pub fn first_for<T: Real>(length: T, growth: T, n: usize) -> T {
    // Horner's rule is smooth through 1 and exact for small whole ratios; beyond it, closed form.
    if n <= 64 {
        let sum = (1..n - 1).fold(T::one(), |sum, _| sum * growth + 1.0);
        return length / sum;
    }
    length / growth_sum(growth.ln(), n - 1)
}

/// The fewest numbers, at most `most_numbers`, with which the law of [`d_tanhx`] over `length` has
/// these end cells (0: free) and grows by at most `growth` from cell to cell; `None` if there is no
/// such number.
///
/// # Errors
/// [`DistributionError`] for a length or spacings that are no lengths.
pub fn count_for(
    length: f64,
    first: f64,
    last: f64,
    growth_limit: f64,
    most_numbers: usize,
) -> std::result::Result<Option<usize>, DistributionError> {
    check(0.0, length, 4, 4)?;
    distance(0.0, length)?;
    spacing(first, 0.0)?;
    spacing(last, 0.0)?;
    if first == 0.0 && last == 0.0 {
        return Ok(Some(2));
    }
    let good = |n: usize| {
        let cells = |s: Vec<f64>| s.windows(2).map(|w| w[1] - w[0]).collect::<Vec<f64>>();
        let law = d_tanhx(0.0, length, first, last, n).map(cells);
        law.is_ok_and(|cells| growth(&cells) <= growth_limit)
    };
    // With more numbers the growth falls until the cells are even, and rises again beyond. Steps of
    // an eighth come upon any stretch of good numbers that is wider than that; evenly divided ones
    // are tried too.
    let smallest = [first, last].into_iter().filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
    let even = (length / smallest).min(most_numbers as f64) as usize;
    let (mut bad, mut n) = (3, 4);
    while !good(n) {
        if n >= most_numbers || n > even + even / 2 + 16 {
            return Ok(None);
        }
        bad = n;
        n = (n + 1 + n / 8).min(most_numbers);
    }
    while n - bad > 1 {
        let middle = bad + (n - bad) / 2;
        if good(middle) { n = middle } else { bad = middle }
    }
    Ok(Some(n))
}

/// Ratio of uniform to given spacing beyond which sinh overflows.
const LARGEST: f64 = 1e300;

fn check<T: Real>(
    start: T,
    end: T,
    n: usize,
    expected: usize,
) -> std::result::Result<(), DistributionError> {
    if n < expected {
        return Err(DistributionError::TooFew { expected, actual: n });
    }
    if !(start.is_finite() && end.is_finite()) {
        return Err(DistributionError::Limits { start: start.re(), end: end.re() });
    }
    Ok(())
}

fn spacing<T: Real>(spacing: T, min: f64) -> std::result::Result<(), DistributionError> {
    if spacing.is_finite() && spacing.re() >= min {
        return Ok(());
    }
    Err(DistributionError::Spacing { spacing: spacing.re() })
}

fn distance<T: Real>(start: T, end: T) -> std::result::Result<T, DistributionError> {
    if start.re() == end.re() {
        return Err(DistributionError::Limits { start: start.re(), end: end.re() });
    }
    Ok((end - start).abs())
}

/// The numbers at the fractions of the distance that `shares(i, n - 1 - i)` gives from both ends;
/// each is measured from the nearer end, which keeps the digits of small cells there.
fn fill<T: Real>(start: T, end: T, n: usize, shares: impl Fn(usize, usize) -> (T, T)) -> Vec<T> {
    let way = end - start;
    let mut all: Vec<T> = (0..n)
        .map(|i| {
            let (from_start, from_end) = shares(i, n - 1 - i);
            if 2 * i < n { start + way * from_start } else { end - way * from_end }
        })
        .collect();
    (all[0], all[n - 1]) = (start, end);
    all
}

/// sinh(sqrt w) / sqrt w, an entire function of w (sin for negative w).
fn sinhc<T: Real>(w: T) -> T {
    sinc_of_sq(-w)
}

/// The w > -pi^2 with sinhc(w) = `b` > 0.
fn inverse_sinhc<T: Real>(b: T) -> T {
    let w = inverse_sinhc_f64(b.re());
    if b.is_constant() {
        return T::from(w);
    }
    let slope = sinhc(Dual::<1>::seeded(w, 0)).eps[0];
    (b - b.re()) / slope + w
}

fn inverse_sinhc_f64(b: f64) -> f64 {
    const ULPS: f64 = 4.0 * f64::EPSILON;
    if b < 3.0 {
        // sinhc is convex and its tangent at 0 is 1 + w/6: the start is to the right of the root,
        // and Newton's steps approach it from there without overshooting.
        let mut w = 6.0 * (b - 1.0);
        for _ in 0..40 {
            let s = sinhc(Dual::<1>::seeded(w, 0));
            let step = (s.re - b) / s.eps[0];
            w -= step;
            if step.abs() <= ULPS * w.abs() {
                break;
            }
        }
        return w;
    }
    // ln(sinh d / d) = ln b is nearly linear in d; start from sinh d ~ exp(d) / 2.
    let log = libm::log(b);
    let mut d = log + libm::log(2.0 * log) * (1.0 + 1.0 / log);
    for _ in 0..40 {
        let decay = libm::exp(-2.0 * d);
        let value = d + libm::log1p(-decay) - libm::log(2.0 * d) - log;
        let slope = (1.0 + decay) / (1.0 - decay) - 1.0 / d;
        let step = value / slope;
        d -= step;
        if step.abs() <= ULPS * d {
            break;
        }
    }
    d * d
}

/// The sum 1 + q + … + q^(m-1) for the ratio q = exp(r), as
/// m exp(r (m-1)/2) sinhc(m r/2) / sinhc(r/2): smooth through q = 1.
fn growth_sum<T: Real>(r: T, m: usize) -> T {
    let (half, m) = (r * 0.5, m as f64);
    let square = half * half;
    (half * (m - 1.0)).exp() * sinhc(square * (m * m)) / sinhc(square) * m
}

/// The growth of a geometric progression of cells.
struct GeometricGrowth<T> {
    r: T,
}

impl<T: Real> GeometricGrowth<T> {
    /// The growth at which `cells` cells add up to `total` times the first.
    fn solve(total: T, cells: usize) -> Option<Self> {
        let sum = total.re();
        if !(sum > 1.0 && sum < LARGEST) {
            return None;
        }
        // 1 / (1 - q) bounds the sum for q < 1, and q^(cells - 1) bounds it below for q > 1.
        let low = libm::log1p(-1.0 / sum).min(0.0) - 1.0;
        let high = libm::log(sum) / (cells - 1) as f64 + 1.0 / cells as f64;
        let r = find_root(|r| libm::log(growth_sum(r, cells) / sum), low, high).ok()?;
        if total.is_constant() {
            return Some(Self { r: T::from(r) });
        }
        let slope = growth_sum(Dual::<1>::seeded(r, 0), cells).eps[0];
        Some(Self { r: (total - sum) / slope + r })
    }

    fn sum(&self, m: usize) -> T {
        if m == 0 { T::zero() } else { growth_sum(self.r, m) }
    }
}

/// Vinokur's law: u = 1/2 + tanh(d (x - 1/2)) / (2 tanh(d/2)) and s = u / (A + (1 - A) u), written
/// with entire functions of w = d^2 (negative w: tan) and without cancellation at either end:
/// u = x sinhc(w x^2) / (sinhc(w/4) cosh(d (x - 1/2))), since
/// tanh a + tanh b = sinh(a + b) / (cosh a cosh b).
struct TanhLaw<T> {
    cells: usize,
    w: T,
    side: SpacedEnds<T>,
}

enum SpacedEnds<T> {
    Both { skew: T },
    Start,
    End,
}

impl<T: Real> TanhLaw<T> {
    /// The law with these slopes per cell, relative to the distance; not both zero.
    fn new([start, end]: [T; 2], cells: usize) -> Option<Self> {
        let n = cells as f64;
        let (b, side) = match (start.re() > 0.0, end.re() > 0.0) {
            (true, true) => {
                let (a, b) = (start.sqrt(), end.sqrt());
                (T::one() / (a * b * n), SpacedEnds::Both { skew: b / a })
            }
            (true, false) => (T::one() / (start * n), SpacedEnds::Start),
            _ => (T::one() / (end * n), SpacedEnds::End),
        };
        // Below the smallest ratio the tangent is vertical at the ends to working precision.
        let sound = b.is_finite() && (1e-12..LARGEST).contains(&b.re());
        sound.then(|| Self { cells, w: inverse_sinhc(b), side })
    }

    /// The fractions of the distance before and after number `i`.
    fn shares(&self, i: usize) -> (T, T) {
        let (x, y) = (i as f64 / self.cells as f64, (self.cells - i) as f64 / self.cells as f64);
        match self.side {
            SpacedEnds::Both { skew } => {
                let c = x - 0.5;
                let shrink = sinhc(self.w * 0.25) * cos_of_sq(-(self.w * (c * c)));
                let part = |x: f64| sinhc(self.w * (x * x)) / shrink * x;
                let (before, after) = (part(x), part(y) * skew);
                let whole = before + after;
                (before / whole, after / whole)
            }
            SpacedEnds::Start => self.one_sided(x),
            SpacedEnds::End => {
                let (near, far) = self.one_sided(y);
                (far, near)
            }
        }
    }

    /// 1 + tanh(d (x - 1) / 2) / tanh(d / 2) by the same identity, and its complement.
    fn one_sided(&self, x: f64) -> (T, T) {
        let quarter = self.w * 0.25;
        let y = 1.0 - x;
        let far = cos_of_sq(-(quarter * (y * y)));
        let near = sinhc(self.w * 0.25 * (x * x)) / (sinhc(quarter) * far) * x;
        let rest = sinhc(quarter * (y * y)) * cos_of_sq(-quarter) / (sinhc(quarter) * far) * y;
        (near, rest)
    }
}

/// The end slopes for which the first and last cells are the `wanted` shares (0: free): Newton's
/// method on the logarithms, with the Jacobian from dual numbers.
fn slopes_of_cells<T: Real>(wanted: [T; 2], cells: usize) -> Option<[T; 2]> {
    let fixed = wanted.map(|c| c.re() > 0.0);
    let goal = wanted.map(|c| if c.re() > 0.0 { c.ln() } else { T::zero() });
    let mut x = goal.map(|g| g.re());
    // Residuals and their Jacobian; a free end has the equation x = 0.
    let system = |x: [f64; 2]| {
        let slope = |k: usize| {
            if fixed[k] { Dual::<2>::seeded(x[k], k).exp() } else { Dual::from(0.0) }
        };
        let law = TanhLaw::new([slope(0), slope(1)], cells)?;
        let reached = [law.shares(1).0, law.shares(cells - 1).1];
        let row = |k: usize| {
            if fixed[k] { reached[k].ln() - goal[k].re() } else { Dual::seeded(x[k], k) }
        };
        Some([row(0), row(1)])
    };
    let step = |f: [Dual<2>; 2], right: [T; 2]| {
        let [[a, b], [c, d]] = f.map(|f| f.eps);
        let shrink = 1.0 / (a * d - b * c);
        [(right[0] * d - right[1] * b) * shrink, (right[1] * a - right[0] * c) * shrink]
    };
    for round in 0..60 {
        let f = system(x)?;
        let change = step(f, f.map(|f| T::from(f.re))).map(|c| c.re());
        if !(change[0].is_finite() && change[1].is_finite()) {
            return None;
        }
        for k in 0..2 {
            x[k] -= change[k].clamp(-1.0, 1.0);
        }
        let settled = change.iter().all(|c| c.abs() <= 1e-14);
        if settled && round > 0 {
            let f = system(x)?;
            if f.iter().any(|f| f.re.abs() > 1e-11) {
                return None;
            }
            let moved = step(f, goal.map(|g| g - g.re()));
            let slope = |k: usize| {
                if fixed[k] { (moved[k] + x[k]).exp() } else { T::zero() }
            };
            return Some([slope(0), slope(1)]);
        }
    }
    None
}
