//! Curves on the page as pieces in corners, divided where they meet others: lines, conics and cubics in Bézier form.

type Place = [f64; 2];

/// Largest turn of a piece in a corner, in radians.
const MOST_TURN: f64 = 1.75;

/// Pieces that turn less are straight.
const STRAIGHT: f64 = 1e-9;

/// Most halvings of a curve into pieces.
const DEPTH: usize = 20;

/// A curve on the page, or a line as one without a corner.
#[derive(Clone, Debug, PartialEq)]
pub enum PageCurve {
    /// A straight line.
    Line([Place; 2]),
    /// Start, corner, end, weight of the corner (the cosine of half the angle for an arc of a circle).
    Conic([Place; 3], f64),
    /// Control points.
    Cubic([Place; 4]),
}

pub(super) fn mix(a: Place, b: Place, s: f64) -> Place {
    [0, 1].map(|k| (1.0 - s) * a[k] + s * b[k])
}

pub(super) fn way(p: Place, q: Place) -> Place {
    [q[0] - p[0], q[1] - p[1]]
}

pub(super) fn cross(a: Place, b: Place) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn dot(a: Place, b: Place) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn size(a: Place) -> f64 {
    libm::hypot(a[0], a[1])
}

impl PageCurve {
    /// Its control points.
    pub fn points(&self) -> &[Place] {
        match self {
            PageCurve::Line(p) => p,
            PageCurve::Conic(p, _) => p,
            PageCurve::Cubic(p) => p,
        }
    }

    /// Start and end.
    pub fn ends(&self) -> [Place; 2] {
        let p = self.points();
        [p[0], p[p.len() - 1]]
    }

    /// The same with other ends.
    pub(crate) fn set_end(&mut self, side: usize, at: Place) {
        let p: &mut [Place] = match self {
            PageCurve::Line(p) => p,
            PageCurve::Conic(p, _) => p,
            PageCurve::Cubic(p) => p,
        };
        let last = p.len() - 1;
        p[side * last] = at;
    }

    /// The image by an affine map.
    pub fn mapped(&self, map: impl Fn(Place) -> Place) -> PageCurve {
        match *self {
            PageCurve::Line(p) => PageCurve::Line(p.map(map)),
            PageCurve::Conic(p, w) => PageCurve::Conic(p.map(map), w),
            PageCurve::Cubic(p) => PageCurve::Cubic(p.map(map)),
        }
    }

    /// Position and derivative at a parameter from 0 to 1.
    pub(super) fn at(&self, s: f64) -> [Place; 2] {
        match *self {
            PageCurve::Line([p, q]) => [mix(p, q, s), way(p, q)],
            PageCurve::Conic([p, m, q], w) => {
                let v = 1.0 - s;
                let [a, b, c] = [v * v, 2.0 * w * s * v, s * s];
                let [da, db, dc] = [-2.0 * v, 2.0 * w * (v - s), 2.0 * s];
                let (sum, rate) = (a + b + c, da + db + dc);
                let at = [0, 1].map(|k| (a * p[k] + b * m[k] + c * q[k]) / sum);
                let up = [0, 1].map(|k| da * p[k] + db * m[k] + dc * q[k]);
                [at, [0, 1].map(|k| (up[k] - rate * at[k]) / sum)]
            }
            PageCurve::Cubic([p, a, b, q]) => {
                let [x, y, z] = [mix(p, a, s), mix(a, b, s), mix(b, q, s)];
                let [x, y] = [mix(x, y, s), mix(y, z, s)];
                [mix(x, y, s), way(x, y).map(|d| 3.0 * d)]
            }
        }
    }

    /// The parts before and after a parameter.
    pub(super) fn divided(&self, s: f64) -> [PageCurve; 2] {
        match *self {
            PageCurve::Line([p, q]) => {
                let at = mix(p, q, s);
                [PageCurve::Line([p, at]), PageCurve::Line([at, q])]
            }
            PageCurve::Conic([p, m, q], w) => {
                // Between points with weights.
                let blend = |a: Place, u: f64, b: Place, v: f64| {
                    let (u, v) = ((1.0 - s) * u, s * v);
                    (mix(a, b, v / (u + v)), u + v)
                };
                let ((x, u), (y, v)) = (blend(p, 1.0, m, w), blend(m, w, q, 1.0));
                let (at, middle) = blend(x, u, y, v);
                let root = libm::sqrt(middle);
                [PageCurve::Conic([p, x, at], u / root), PageCurve::Conic([at, y, q], v / root)]
            }
            PageCurve::Cubic([p, a, b, q]) => {
                let [x, y, z] = [mix(p, a, s), mix(a, b, s), mix(b, q, s)];
                let [u, v] = [mix(x, y, s), mix(y, z, s)];
                let at = mix(u, v, s);
                [PageCurve::Cubic([p, x, u, at]), PageCurve::Cubic([at, v, z, q])]
            }
        }
    }

    /// Lowest and highest coordinates of the control points.
    pub(super) fn range(&self) -> [Place; 2] {
        let first = (self.points()[0], self.points()[0]);
        let (low, high) = self.points().iter().fold(first, |(l, h), p| {
            ([0, 1].map(|k| l[k].min(p[k])), [0, 1].map(|k| h[k].max(p[k])))
        });
        [low, high]
    }

    /// Largest distance of a control point from the line between the ends.
    pub(super) fn bulge(&self) -> f64 {
        let [p, q] = self.ends();
        let (chord, long) = (way(p, q), size(way(p, q)));
        let off = |x: &Place| match long > 0.0 {
            true => cross(chord, way(p, *x)).abs() / long,
            false => size(way(p, *x)),
        };
        let inner = self.points().iter().map(off).fold(0.0, f64::max);
        // Control points beyond the ends.
        let beyond = |x: &Place| {
            let s = dot(chord, way(p, *x)) / long.max(f64::MIN_POSITIVE);
            (s - long).max(-s)
        };
        self.points().iter().map(beyond).fold(inner, f64::max)
    }

    /// Start, corner and end of a curve that lies in its corner.
    pub(crate) fn corner(&self) -> Option<[Place; 3]> {
        match *self {
            PageCurve::Line(_) => None,
            PageCurve::Conic(p, _) => Some(p),
            PageCurve::Cubic(p) => corner_of(p).map(|(m, _)| [p[0], m, p[3]]),
        }
    }

    /// The numbers of `SketchCurve::shape`, for a curve in its corner.
    pub(crate) fn shape(&self) -> Vec<f64> {
        match *self {
            PageCurve::Line(_) => vec![],
            PageCurve::Conic(_, w) => vec![w],
            PageCurve::Cubic(p) => corner_of(p).map_or(vec![], |(_, h)| h.to_vec()),
        }
    }

    /// Its pieces in corners, and straight ones.
    pub(crate) fn in_corners(&self, out: &mut Vec<PageCurve>) {
        self.pieces(DEPTH, out);
    }

    fn pieces(&self, depth: usize, out: &mut Vec<PageCurve>) {
        let [p, q] = self.ends();
        let long = self.points().windows(2).map(|w| size(way(w[0], w[1]))).sum::<f64>();
        if self.bulge() <= STRAIGHT * long {
            if p != q {
                out.push(PageCurve::Line([p, q]));
            }
            return;
        }
        let fits = match *self {
            PageCurve::Line(_) => true,
            PageCurve::Conic([p, m, q], w) => {
                let (u, v) = (way(p, m), way(m, q));
                libm::atan2(cross(u, v).abs(), dot(u, v)) <= MOST_TURN && w < 1.0
            }
            PageCurve::Cubic(p) => corner_of(p).is_some(),
        };
        if fits || depth == 0 {
            out.push(self.clone());
            return;
        }
        let at = match *self {
            PageCurve::Cubic(p) => inflection(p).unwrap_or(0.5),
            _ => 0.5,
        };
        self.divided(at).iter().for_each(|half| half.pieces(depth - 1, out));
    }
}

/// The corner of a cubic that turns one way, and the distances of its control points as fractions of the lines.
fn corner_of([p, a, b, q]: [Place; 4]) -> Option<(Place, [f64; 2])> {
    let long = size(way(p, a)) + size(way(a, b)) + size(way(b, q));
    let near = |x: Place, y: Place| size(way(x, y)) <= 1e-12 * long;
    // Directions at the ends; a control point at an end has the direction of the next one.
    let u = if near(p, a) { way(p, b) } else { way(p, a) };
    let v = if near(q, b) { way(a, q) } else { way(b, q) };
    let det = cross(u, v);
    let turn = libm::atan2(det.abs(), dot(u, v));
    if !(STRAIGHT..=MOST_TURN).contains(&turn) {
        return None;
    }
    let to = way(p, q);
    let (s, t) = (cross(to, v) / det, cross(u, to) / det);
    if !(s > 0.0 && t > 0.0) {
        return None;
    }
    let m = [p[0] + s * u[0], p[1] + s * u[1]];
    let part = |x: Place, end: Place| {
        if near(x, end) { 0.0 } else { size(way(end, x)) / size(way(end, m)) }
    };
    let handles = [part(a, p), part(b, q)];
    handles.iter().all(|h| *h <= 1.0 + 1e-9).then(|| (m, handles.map(|h| h.min(1.0))))
}

/// A parameter within a cubic at which its curvature changes sign.
fn inflection([p, a, b, q]: [Place; 4]) -> Option<f64> {
    // cross(B', B'') / 18 is quadratic in Bernstein form.
    let (u, v, w) = (way(p, a), way(a, b), way(b, q));
    let [x, y, z] = [cross(u, v), 0.5 * cross(u, w), cross(v, w)];
    let (c2, c1, c0) = (x - 2.0 * y + z, 2.0 * (y - x), x);
    let root = (c1 * c1 - 4.0 * c2 * c0).max(0.0).sqrt();
    let half = -0.5 * (c1 + if c1 < 0.0 { -root } else { root });
    let all = [half / c2, c0 / half];
    let inner = |s: &f64| s.is_finite() && *s > 1e-6 && *s < 1.0 - 1e-6;
    (c1 * c1 - 4.0 * c2 * c0 > 0.0).then(|| all.into_iter().find(inner)).flatten()
}
