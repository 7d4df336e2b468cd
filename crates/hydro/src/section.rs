//! Plane sections of a body: the immersed area of a station, and the extent of the waterline.

use crate::body::Body;
use crate::strip::{CoordinatePlane, Strip, StripLine, strips};
use moldloft_num::{Real, Vec3, gauss_rule};

/// Samples of a function along a cut from which a root or extremum is searched for.
const LOOKS: usize = 16;

/// Samples along the cut of a strip, whose ends suffice where it is straight.
fn looks<T: Real>(strip: &Strip<T>) -> usize {
    if strip.cell.triangle().is_some() { 1 } else { LOOKS }
}

/// Quadrature points along a piece of a section.
const POINTS: usize = 16;

/// The immersed area of the modelled half or whole at x = `station`, and its first moment about the
/// water: the integrals of (z - level) dy and of (z - level)^2 / 2 dy along the section of the
/// skin.
pub fn section_area<T: Real>(body: &Body<T>, station: T, level: T) -> [T; 2] {
    let cut = CoordinatePlane::new(0, station, body.size());
    let (mut area, mut moment) = (T::zero(), T::zero());
    let mut found = Vec::new();
    for cell in body.cells() {
        let xs = cell.net().iter().map(|p| p.x.re() - station.re());
        let zs = cell.net().iter().map(|p| p.z.re());
        let (low, high) = xs.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
        if low > cut.epsilon || high < -cut.epsilon || zs.fold(f64::MAX, f64::min) >= level.re() {
            continue;
        }
        found.clear();
        strips(cell, cut, &mut found);
        for strip in found.iter().filter(|s| s.is_cut()) {
            let before = strip.wet == crate::strip::Wet::Before;
            let turn = if before { strip.sign() } else { -strip.sign() };
            for [a, b] in under_water(strip, cut, level) {
                let (length, mut line) = (b - a, StripLine::default());
                for &(s, weight) in gauss_rule(POINTS) {
                    let half = std::f64::consts::FRAC_PI_2;
                    let (sine, cosine) = (libm::sin(half * s), libm::cos(half * s));
                    let w = a + length * (sine * sine);
                    let at = strip.cut_at(w, cut, &mut line);
                    let z = at.p.z - level;
                    let dy = at.along.y * length * (2.0 * half * sine * cosine * weight * turn);
                    area += z * dy;
                    moment += z * z * 0.5 * dy;
                }
            }
        }
    }
    [area, moment]
}

/// The intervals of the outer parameter on which the cut is below the level.
fn under_water<T: Real>(strip: &Strip<T>, cut: CoordinatePlane<T>, level: T) -> Vec<[T; 2]> {
    let mut line = StripLine::default();
    let mut height = |w: T| strip.cut_at(w, cut, &mut line).p.z - level;
    let looks = looks(strip);
    let place = |k: usize| {
        let s = k as f64 / looks as f64;
        let sine = libm::sin(std::f64::consts::FRAC_PI_2 * s);
        strip.from + (strip.to - strip.from) * (sine * sine)
    };
    let mut out: Vec<[T; 2]> = Vec::new();
    let mut start = None;
    let mut last = (strip.from, height(strip.from));
    if last.1.re() < 0.0 {
        start = Some(strip.from);
    }
    for k in 1..=looks {
        let w = place(k);
        let z = height(w);
        if (z.re() < 0.0) != (last.1.re() < 0.0) {
            // The root by the Illinois method on real parts, then one secant step for the
            // derivatives.
            let (mut a, mut fa, mut b, mut fb) = (last.0.re(), last.1.re(), w.re(), z.re());
            let mut root = 0.5 * (a + b);
            for _ in 0..60 {
                root = if fb == fa { 0.5 * (a + b) } else { (a * fb - b * fa) / (fb - fa) };
                if !(root > a.min(b) && root < a.max(b)) {
                    root = 0.5 * (a + b);
                }
                let f = height(T::from(root)).re();
                if f == 0.0 || (b - a).abs() < 1e-15 {
                    break;
                }
                if (f < 0.0) == (fb < 0.0) {
                    (b, fb) = (root, f);
                    fa *= 0.5;
                } else {
                    (a, fa) = (b, fb);
                    (b, fb) = (root, f);
                }
            }
            let exact = {
                let at = {
                    let mut line = StripLine::default();
                    strip.cut_at(T::from(root), cut, &mut line)
                };
                let off = (at.p.z - level) / at.along.z;
                if off.is_finite() && off.re().abs() < 1e-6 {
                    T::from(root) - off
                } else {
                    T::from(root)
                }
            };
            match start.take() {
                Some(from) => out.push([from, exact]),
                None => start = Some(exact),
            }
        }
        last = (w, z);
    }
    if let Some(from) = start {
        out.push([from, strip.to]);
    }
    out
}

/// Minimum and maximum x, then y, of the waterline.
pub(crate) fn waterline_extent<T: Real>(
    strips: &[Strip<T>],
    cut: CoordinatePlane<T>,
) -> Option<[T; 4]> {
    let mut best: [Option<(f64, T)>; 4] = [None; 4];
    let mut line = StripLine::default();
    for strip in strips {
        let (a, b) = (strip.from.re(), strip.to.re());
        let looks = looks(strip);
        let place = |k: usize| {
            let s = k as f64 / looks as f64;
            let sine = libm::sin(std::f64::consts::FRAC_PI_2 * s);
            a + (b - a) * sine * sine
        };
        let w_of = |k: usize| match k {
            0 => strip.from,
            k if k == looks => strip.to,
            k => T::from(place(k)),
        };
        let points: Vec<Vec3<T>> =
            (0..=looks).map(|k| strip.cut_at(w_of(k), cut, &mut line).p).collect();
        for (m, best) in best.iter_mut().enumerate() {
            let (axis, sign) = (m / 2, if m % 2 == 0 { 1.0 } else { -1.0 });
            let at = |k: usize| sign * points[k][axis].re();
            let k = (0..=looks).fold(0, |n, k| if at(k) < at(n) { k } else { n });
            // Between the samples the extremum exceeds them by at most the steps between them.
            let step = [k.saturating_sub(1), (k + 1).min(looks)]
                .iter()
                .fold(0.0f64, |s, &n| s.max((at(n) - at(k)).abs()));
            if best.is_some_and(|(b, _)| at(k) - step > b) {
                continue;
            }
            let mut value = points[k][axis];
            let (low, high) = (place(k.saturating_sub(1)), place((k + 1).min(looks)));
            if high > low && looks > 1 {
                let mut f = |w: f64| sign * strip.cut_at(T::from(w), cut, &mut line).p[axis].re();
                let w = least(&mut f, low, high);
                if f(w) < sign * value.re() {
                    value = strip.cut_at(T::from(w), cut, &mut line).p[axis];
                }
            }
            let x = sign * value.re();
            if best.is_none_or(|(b, _)| x < b) {
                *best = Some((x, value));
            }
        }
    }
    let [a, b, c, d] = best;
    Some([a?.1, b?.1, c?.1, d?.1])
}

/// The position of the minimum of `f` between `low` and `high`, by golden section search. The value
/// is flat there, so half of the digits of the position suffice.
pub(crate) fn least(f: &mut dyn FnMut(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    while high - low > 1e-9 {
        if fa <= fb {
            (high, b, fb) = (b, a, fa);
            a = high - GOLDEN * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + GOLDEN * (high - low);
            fb = f(b);
        }
    }
    if fa <= fb { a } else { b }
}
