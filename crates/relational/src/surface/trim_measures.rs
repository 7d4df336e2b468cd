//! Area, middle and cone volume of a part of a surface, by integrals over the part itself.
//!
//! Triangles of the parameter plane fill the polygon of the border's vertices; between each side of it and its snake
//! lies a lens, which is added with its sign. Cells are divided until two rules agree.

use moldloft_num::{Order, Real, Vec3};
use moldloft_registry::{CurveRef, SheetMeasures, SurfaceRef};

/// Rules may differ by this share of the whole.
const ACCURACY: f64 = 1e-10;

/// How often a cell is halved in each direction.
const DEPTH: u32 = 9;

/// A side of the polygon and the snake that it is a chord of.
pub struct BorderLens<'a, T: Real> {
    pub snake: &'a CurveRef<T>,
    /// Where it begins and ends, as the loop runs.
    pub from: T,
    pub to: T,
}

/// Area, first moments of it, and three times the volume of the cone from the origin.
#[derive(Clone, Copy)]
struct SurfaceSums<T: Real> {
    area: T,
    moment: Vec3<T>,
    cone: T,
}

impl<T: Real> SurfaceSums<T> {
    fn zero() -> Self {
        Self { area: T::zero(), moment: Vec3::zero(), cone: T::zero() }
    }

    fn plus(self, o: Self, by: T) -> Self {
        Self {
            area: self.area + o.area * by,
            moment: self.moment + o.moment * by,
            cone: self.cone + o.cone * by,
        }
    }

    /// How far two are apart, in areas of a body of that size.
    fn apart(&self, o: &Self, size: f64) -> f64 {
        let moment = (self.moment - o.moment).re().norm();
        let cone = (self.cone - o.cone).re().abs();
        (self.area - o.area).re().abs().max((moment.max(cone)) / size)
    }
}

type Place<T> = [T; 2];

fn blend<T: Real>(parts: &[(T, Place<T>)]) -> Place<T> {
    parts.iter().fold([T::zero(); 2], |s, (w, p)| [s[0] + *w * p[0], s[1] + *w * p[1]])
}

struct SurfaceIntegral<'a, T: Real> {
    surface: &'a SurfaceRef<T>,
    size: f64,
    /// The error that a cell of one triangle's share may have.
    allowed: f64,
}

impl<T: Real> SurfaceIntegral<'_, T> {
    /// The integrand per parameter area.
    fn at(&self, p: Place<T>) -> SurfaceSums<T> {
        let jet = self.surface.jet(p[0], p[1], Order::First);
        let normal = jet.u.cross(jet.v);
        let area = if normal.re().norm() > 0.0 { normal.norm() } else { T::zero() };
        SurfaceSums { area, moment: jet.p * area, cone: jet.p.dot(normal) }
    }

    /// A triangle by the rule of seven points (Dunavant 1985, degree 5).
    fn rule(&self, [a, b, c]: [Place<T>; 3]) -> SurfaceSums<T> {
        const RULE: [(f64, f64, f64); 3] = [
            (0.225, 1.0 / 3.0, 1.0 / 3.0),
            (0.132_394_152_788_506_2, 0.059_715_871_789_769_82, 0.470_142_064_105_115_1),
            (0.125_939_180_544_827_15, 0.797_426_985_353_087_3, 0.101_286_507_323_456_34),
        ];
        let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let mut sums = SurfaceSums::zero();
        for (k, (weight, one, other)) in RULE.into_iter().enumerate() {
            for turn in 0..if k == 0 { 1 } else { 3 } {
                let corners = [[a, b, c], [b, c, a], [c, a, b]][turn];
                let w = [one, other, other].map(T::from);
                let p = blend(&[(w[0], corners[0]), (w[1], corners[1]), (w[2], corners[2])]);
                sums = sums.plus(self.at(p), twice * T::from(0.5 * weight));
            }
        }
        sums
    }

    fn triangle(&self, corners: [Place<T>; 3], once: SurfaceSums<T>, depth: u32) -> SurfaceSums<T> {
        let [a, b, c] = corners;
        let half = |p: Place<T>, q: Place<T>| blend(&[(T::from(0.5), p), (T::from(0.5), q)]);
        let (ab, bc, ca) = (half(a, b), half(b, c), half(c, a));
        let parts = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
        let rules = parts.map(|part| self.rule(part));
        let fine = rules.iter().fold(SurfaceSums::zero(), |s, r| s.plus(*r, T::one()));
        if depth == 0 || once.apart(&fine, self.size) <= self.allowed {
            return fine;
        }
        let parts = parts.into_iter().zip(rules);
        parts.fold(SurfaceSums::zero(), |s, (part, rule)| {
            s.plus(self.triangle(part, rule, depth - 1), T::one())
        })
    }

    /// Between a part of a snake and the chord from `ends`, by Gauss' rules of five and three points.
    fn lens_rule(
        &self,
        lens: &BorderLens<'_, T>,
        ends: [Place<T>; 2],
        [s0, s1]: [f64; 2],
    ) -> SurfaceSums<T> {
        const ALONG: [(f64, f64); 5] = [
            (0.046_910_077_030_668_0, 0.118_463_442_528_094_54),
            (0.230_765_344_947_158_45, 0.239_314_335_249_683_24),
            (0.5, 0.284_444_444_444_444_44),
            (0.769_234_655_052_841_5, 0.239_314_335_249_683_24),
            (0.953_089_922_969_332, 0.118_463_442_528_094_54),
        ];
        const ACROSS: [(f64, f64); 3] = [
            (0.112_701_665_379_258_31, 0.277_777_777_777_777_8),
            (0.5, 0.444_444_444_444_444_4),
            (0.887_298_334_620_741_7, 0.277_777_777_777_777_8),
        ];
        let mut sums = SurfaceSums::zero();
        for (x, weight) in ALONG {
            let s = s0 + (s1 - s0) * x;
            let t = lens.from + (lens.to - lens.from) * T::from(s);
            let Some([p, d, ..]) = lens.snake.on_surface(t, Order::First) else { continue };
            let speed = lens.to - lens.from;
            let (curve, along) = ([p.x, p.y], [d.x * speed, d.y * speed]);
            let chord = blend(&[(T::from(1.0 - s), ends[0]), (T::from(s), ends[1])]);
            let straight = [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]];
            let across = [chord[0] - curve[0], chord[1] - curve[1]];
            for (r, share) in ACROSS {
                let [near, far] = [T::from(1.0 - r), T::from(r)];
                let place = blend(&[(near, curve), (far, chord)]);
                let run = blend(&[(near, along), (far, straight)]);
                let jacobian = run[0] * across[1] - run[1] * across[0];
                let by = jacobian * T::from(weight * share * (s1 - s0));
                sums = sums.plus(self.at(place), by);
            }
        }
        sums
    }

    fn lens(
        &self,
        lens: &BorderLens<'_, T>,
        ends: [Place<T>; 2],
        span: [f64; 2],
        once: SurfaceSums<T>,
        depth: u32,
    ) -> SurfaceSums<T> {
        let middle = 0.5 * (span[0] + span[1]);
        let halves = [[span[0], middle], [middle, span[1]]];
        let rules = halves.map(|half| self.lens_rule(lens, ends, half));
        let fine = rules[0].plus(rules[1], T::one());
        if depth == 0 || once.apart(&fine, self.size) <= self.allowed {
            return fine;
        }
        let [a, b] = [0, 1].map(|k| self.lens(lens, ends, halves[k], rules[k], depth - 1));
        a.plus(b, T::one())
    }
}

/// The measures of the part: triangles fill a polygon of places, of which each side is the chord of a lens.
pub fn measured<T: Real>(
    surface: &SurfaceRef<T>,
    triangles: &[[Place<T>; 3]],
    lenses: &[BorderLens<'_, T>],
) -> SheetMeasures<T> {
    let mut integral = SurfaceIntegral { surface, size: 1.0, allowed: f64::INFINITY };
    let first: Vec<SurfaceSums<T>> = triangles.iter().map(|t| integral.rule(*t)).collect();
    let rough = first.iter().fold(SurfaceSums::zero(), |s, r| s.plus(*r, T::one()));
    integral.size = rough.area.re().abs().sqrt().max(f64::MIN_POSITIVE);
    // Moments are about the origin: what is far from it has larger ones.
    let far = first.iter().map(|r| {
        let area = r.area.re();
        if area == 0.0 { 0.0 } else { (r.moment.re() / area).norm() }
    });
    integral.size = far.fold(integral.size, f64::max);
    let cells = (triangles.len() + lenses.len()).max(1) as f64;
    integral.allowed = ACCURACY * rough.area.re().abs() / cells.sqrt();
    let mut sums = SurfaceSums::zero();
    for (corners, once) in triangles.iter().zip(first) {
        sums = sums.plus(integral.triangle(*corners, once, DEPTH), T::one());
    }
    for lens in lenses {
        let place = |t: T| lens.snake.on_surface(t, Order::Zero).map(|[p, ..]| [p.x, p.y]);
        let (Some(a), Some(b)) = (place(lens.from), place(lens.to)) else { continue };
        // A snake has corners at its breaks.
        let [low, high] = [lens.from.re(), lens.to.re()];
        let mut cuts: Vec<f64> = vec![0.0, 1.0];
        let inside = lens.snake.breaks().into_iter().map(|t| (t - low) / (high - low));
        cuts.extend(inside.filter(|s| *s > 0.0 && *s < 1.0));
        cuts.sort_by(f64::total_cmp);
        for w in cuts.windows(2) {
            let span = [w[0], w[1]];
            let once = integral.lens_rule(lens, [a, b], span);
            sums = sums.plus(integral.lens(lens, [a, b], span, once, DEPTH), T::one());
        }
    }
    let empty = sums.area.re() <= 0.0;
    let centroid = if empty { Vec3::zero() } else { sums.moment / sums.area };
    SheetMeasures { area: sums.area, centroid, volume: sums.cone / T::from(3.0) }
}
