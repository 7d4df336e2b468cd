//! Plane Bézier curves of degree 1 to 3.

/// A point of the page.
pub type Point = [f64; 2];

/// Distance, relative to its length, within which a curve is straight.
const STRAIGHT: f64 = 1e-9;

/// A line, or a quadratic or cubic curve, by its control points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bezier {
    /// A line.
    Line([Point; 2]),
    /// A quadratic curve.
    Quadratic([Point; 3]),
    /// A cubic curve.
    Cubic([Point; 4]),
}

pub(crate) fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(crate) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn norm(a: Point) -> f64 {
    (a[0] * a[0] + a[1] * a[1]).sqrt()
}

fn lerp(a: Point, b: Point, t: f64) -> Point {
    [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]
}

impl Bezier {
    /// The control points.
    pub fn points(&self) -> &[Point] {
        match self {
            Bezier::Line(p) => p,
            Bezier::Quadratic(p) => p,
            Bezier::Cubic(p) => p,
        }
    }

    fn of(points: &[Point]) -> Bezier {
        match *points {
            [a, b] => Bezier::Line([a, b]),
            [a, b, c] => Bezier::Quadratic([a, b, c]),
            [a, b, c, d] => Bezier::Cubic([a, b, c, d]),
            _ => unreachable!("a curve has two to four control points"),
        }
    }

    /// The image of the curve by an affine map.
    #[must_use]
    pub fn mapped(&self, map: &dyn Fn(Point) -> Point) -> Bezier {
        let mut points = [[0.0; 2]; 4];
        let own = self.points();
        own.iter().enumerate().for_each(|(k, p)| points[k] = map(*p));
        Bezier::of(&points[..own.len()])
    }

    /// The first and the last point.
    pub fn ends(&self) -> [Point; 2] {
        let points = self.points();
        [points[0], points[points.len() - 1]]
    }

    /// The same curve between points that are its ends but for rounding.
    pub(crate) fn between(&self, [p, q]: [Point; 2]) -> Bezier {
        let mut made = *self;
        match &mut made {
            Bezier::Line(all) => *all = [p, q],
            Bezier::Quadratic(all) => (all[0], all[2]) = (p, q),
            Bezier::Cubic(all) => (all[0], all[3]) = (p, q),
        }
        made
    }

    /// The same curve from its last point to its first.
    #[must_use]
    pub fn reversed(&self) -> Bezier {
        let mut points = [[0.0; 2]; 4];
        let n = self.points().len();
        self.points().iter().enumerate().for_each(|(k, p)| points[n - 1 - k] = *p);
        Bezier::of(&points[..n])
    }

    /// The two parts on both sides of a parameter (de Casteljau).
    pub(crate) fn split(&self, t: f64) -> [Bezier; 2] {
        let own = self.points();
        let n = own.len();
        let mut row = [[0.0; 2]; 4];
        row[..n].copy_from_slice(own);
        let (mut first, mut second) = ([[0.0; 2]; 4], [[0.0; 2]; 4]);
        for k in 0..n {
            first[k] = row[0];
            second[n - 1 - k] = row[n - 1 - k];
            for j in 0..n - 1 - k {
                row[j] = lerp(row[j], row[j + 1], t);
            }
        }
        [Bezier::of(&first[..n]), Bezier::of(&second[..n])]
    }

    /// The part between two parameters.
    pub(crate) fn part(&self, from: f64, to: f64) -> Bezier {
        let [first, _] = self.split(to);
        if from <= 0.0 { first } else { first.split(from / to)[1] }
    }

    /// The point at a parameter in [0, 1].
    pub fn at(&self, t: f64) -> Point {
        self.split(t)[0].ends()[1]
    }

    /// The derivative with respect to the parameter.
    pub(crate) fn velocity(&self, t: f64) -> Point {
        let w = 1.0 - t;
        let sum = |terms: &[(f64, Point)]| {
            terms.iter().fold([0.0; 2], |s, (f, p)| [s[0] + f * p[0], s[1] + f * p[1]])
        };
        match *self {
            Bezier::Line([a, b]) => minus(b, a),
            Bezier::Quadratic([a, b, c]) => sum(&[(2.0 * w, minus(b, a)), (2.0 * t, minus(c, b))]),
            Bezier::Cubic([a, b, c, d]) => sum(&[
                (3.0 * w * w, minus(b, a)),
                (6.0 * w * t, minus(c, b)),
                (3.0 * t * t, minus(d, c)),
            ]),
        }
    }

    /// Half the integral of x dy - y dx: the area between the curve and the origin.
    pub fn area(&self) -> f64 {
        let c = |i: usize, j: usize| cross(self.points()[i], self.points()[j]);
        match self {
            Bezier::Line(_) => c(0, 1) / 2.0,
            Bezier::Quadratic(_) => (2.0 * c(0, 1) + c(0, 2) + 2.0 * c(1, 2)) / 6.0,
            Bezier::Cubic(_) => {
                (6.0 * c(0, 1)
                    + 3.0 * c(0, 2)
                    + c(0, 3)
                    + 3.0 * c(1, 2)
                    + 3.0 * c(1, 3)
                    + 6.0 * c(2, 3))
                    / 20.0
            }
        }
    }

    /// +1 for the same curve within a distance, -1 for the same one from its other end.
    pub(crate) fn sense_of(&self, other: &Bezier, near: f64) -> Option<i32> {
        let same = |o: &Bezier| {
            let (own, other) = (self.points(), o.points());
            own.len() == other.len()
                && own.iter().zip(other).all(|(p, q)| norm(minus(*p, *q)) <= near)
        };
        if same(other) { Some(1) } else { same(&other.reversed()).then_some(-1) }
    }

    /// The box round the control points, lower corner first.
    pub(crate) fn bounds(&self) -> [Point; 2] {
        let mut out = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for p in self.points() {
            for k in 0..2 {
                out[0][k] = out[0][k].min(p[k]);
                out[1][k] = out[1][k].max(p[k]);
            }
        }
        out
    }

    /// Bound on the distance from the line between the ends.
    pub(crate) fn bend(&self) -> f64 {
        let [p, q] = self.ends();
        let (along, long) = (minus(q, p), norm(minus(q, p)));
        let off = |r: &Point| match long > 0.0 {
            true => cross(along, minus(*r, p)).abs() / long,
            false => norm(minus(*r, p)),
        };
        self.points().iter().map(off).fold(0.0, f64::max)
    }

    /// A curve without a bend as a line; `None` for one without length.
    pub(crate) fn simplified(&self, size: f64) -> Option<Bezier> {
        let [p, q] = self.ends();
        let along = minus(q, p);
        let long = norm(along);
        let points = self.points();
        let reach = points.iter().map(|r| norm(minus(*r, p))).fold(0.0, f64::max);
        if reach <= STRAIGHT * size {
            return None;
        }
        let dot = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1];
        let onward = |w: &[Point]| dot(minus(w[1], w[0]), along) >= 0.0;
        let straight = long > 0.0 && self.bend() <= STRAIGHT * long;
        Some(if straight && points.windows(2).all(onward) { Bezier::Line([p, q]) } else { *self })
    }

    /// Parameters inside (0, 1) at which a coordinate along a direction is extreme, in order.
    pub(crate) fn extremes(&self, along: Point) -> Vec<f64> {
        let height = |p: &Point| p[0] * along[0] + p[1] * along[1];
        let h: Vec<f64> = self.points().iter().map(height).collect();
        let roots = match h[..] {
            [a, b, c] => {
                let down = a - 2.0 * b + c;
                if down == 0.0 { vec![] } else { vec![(a - b) / down] }
            }
            [a, b, c, d] => {
                // (1-t)^2 (b-a) + 2 t (1-t) (c-b) + t^2 (d-c)
                let (p, q, r) = (b - a, c - b, d - c);
                quadratic(p - 2.0 * q + r, 2.0 * (q - p), p)
            }
            _ => vec![],
        };
        let mut inside: Vec<f64> = roots.into_iter().filter(|t| *t > 0.0 && *t < 1.0).collect();
        inside.sort_by(f64::total_cmp);
        inside
    }
}

/// The real zeros of a t^2 + b t + c.
fn quadratic(a: f64, b: f64, c: f64) -> Vec<f64> {
    let inside = b * b - 4.0 * a * c;
    if inside < 0.0 {
        return vec![];
    }
    // Without cancellation: one root by the larger sum, the other by their product.
    let q = -0.5 * (b + if b < 0.0 { -inside.sqrt() } else { inside.sqrt() });
    let first = if a != 0.0 { Some(q / a) } else { None };
    let second = if q != 0.0 { Some(c / q) } else { None };
    first.into_iter().chain(second).collect()
}
