//! Curves in which two surfaces cross, as splines of degree 3 with a proved bound of their distance from both.

use crate::{SurfaceAxes, SurfaceImage, SurfaceShape};
use moldloft_num::{Pace, Vec3};
use moldloft_spline::nurbs::Nurbs;

/// Directions of two normals that differ less than this count as one: the surfaces touch.
const TOUCH: f64 = 1e-3;

/// The most pieces into which a stretch between two points of the guide is divided, as a power of
/// 2.
const DEEPEST: u32 = 12;

/// Most turn of the tangent along a piece, radians.
const TURN: f64 = 0.8;

/// The point of both surfaces near another, by Newton's method; `None` at contacts, and without an
/// intersection.
pub fn on_both(surfaces: [&SurfaceShape; 2], mut p: Vec3) -> Option<Vec3> {
    const STEPS: usize = 30;
    let mut last = f64::INFINITY;
    for _ in 0..STEPS {
        let [a, b] = [surfaces[0].distance(p)?, surfaces[1].distance(p)?];
        let [m, n] = surfaces.map(|s| s.normal(p));
        let c = m.dot(n);
        let det = 1.0 - c * c;
        if det < TOUCH * TOUCH {
            return None;
        }
        // The shortest step d with m.d = -a and n.d = -b.
        let step = m * ((c * b - a) / det) + n * ((c * a - b) / det);
        p += step;
        let size = step.norm();
        if size >= last || size <= 1e-15 * (1.0 + p.norm()) {
            let left = surfaces.map(|s| s.distance(p).unwrap_or(f64::INFINITY).abs());
            let scale = 1e-12 * (1.0 + p.norm());
            return (left[0].max(left[1]) <= scale || size <= scale).then_some(p);
        }
        last = size;
    }
    None
}

/// The point near another where two surfaces touch: both distances and the sine of their normals' angle are zero.
/// Newton's method for the five, with differences of normals.
pub fn touch(surfaces: [&SurfaceShape; 2], mut p: Vec3, near: f64) -> Option<Vec3> {
    const STEPS: usize = 30;
    let value = |p: Vec3| -> [f64; 5] {
        let [a, b] = surfaces.map(|s| s.distance(p).unwrap_or(f64::NAN));
        let [m, n] = surfaces.map(|s| s.normal(p));
        let c = m.cross(n);
        // Distances weigh more: they are zero to rounding.
        [a / near, b / near, c.x / 1e-6, c.y / 1e-6, c.z / 1e-6]
    };
    let h = 1e3 * near;
    for _ in 0..STEPS {
        let f = value(p);
        let step = [Vec3::of(h, 0.0, 0.0), Vec3::of(0.0, h, 0.0), Vec3::of(0.0, 0.0, h)];
        let rows = step.map(|d| {
            let [up, down] = [value(p + d), value(p - d)];
            let slope: [f64; 5] = std::array::from_fn(|k| (up[k] - down[k]) / (2.0 * h));
            slope
        });
        let dot = |a: &[f64; 5], b: &[f64; 5]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let columns = [0, 1, 2].map(|j| Vec3::from([0, 1, 2].map(|i| dot(&rows[i], &rows[j]))));
        let right = Vec3::from([0, 1, 2].map(|i| dot(&rows[i], &f)));
        let det = columns[0].dot(columns[1].cross(columns[2]));
        let scale = columns.iter().map(|c| c.norm()).product::<f64>();
        if !det.is_finite() || det.abs() <= 1e-16 * scale {
            return None;
        }
        let d = Vec3::of(
            right.dot(columns[1].cross(columns[2])),
            right.dot(columns[2].cross(columns[0])),
            right.dot(columns[0].cross(columns[1])),
        ) / det;
        p -= d;
        if d.norm() <= 1e-3 * near {
            let last = value(p);
            return last.iter().all(|x| x.abs() <= 1.0).then_some(p);
        }
    }
    None
}

/// The unit tangent of the crossing there, towards `along`.
fn tangent(surfaces: [&SurfaceShape; 2], p: Vec3, along: Vec3) -> Option<Vec3> {
    let [m, n] = surfaces.map(|s| s.normal(p));
    let t = m.cross(n);
    if t.norm() < TOUCH {
        return None;
    }
    let t = t.normalized()?;
    Some(if t.dot(along) < 0.0 { -t } else { t })
}

/// An end of a piece, and the tangent there.
type PieceEnd = (Vec3, Option<Vec3>);

/// A piece: its ends and their tangents.
type Piece = [PieceEnd; 2];

/// A piece's tangents: where surfaces touch at an end, the one that makes the piece a part of a circle.
fn tangents([(p, s), (q, t)]: Piece) -> [Vec3; 2] {
    let chord = (q - p).normalized().unwrap_or_default();
    let like = |t: Vec3| chord * (2.0 * chord.dot(t)) - t;
    match (s, t) {
        (Some(s), Some(t)) => [s, t],
        (None, Some(t)) => [like(t), t],
        (Some(s), None) => [s, like(s)],
        (None, None) => [chord, chord],
    }
}

/// Four control points and the length of their parameter interval.
fn bezier(piece: Piece) -> ([Vec3; 4], f64) {
    let ([(p, _), (q, _)], [s, t]) = (piece, tangents(piece));
    let turn = libm::acos(s.dot(t).clamp(-1.0, 1.0));
    let c = libm::cos(turn / 4.0);
    let length = p.distance(q) / (c * c);
    ([p, p + s * (length / 3.0), q - t * (length / 3.0), q], length)
}

/// The crossing from the first point of a guide to its last, which are on both surfaces, near the others: as a spline
/// within the accuracy of both surfaces.
pub fn crossing(
    surfaces: [&SurfaceShape; 2],
    guide: &[Vec3],
    accuracy: f64,
    reach: f64,
) -> Option<Nurbs<1>> {
    let last = guide.len() - 1;
    let mut nodes = Vec::with_capacity(guide.len());
    for (k, &p) in guide.iter().enumerate() {
        let on = if k == 0 || k == last { p } else { on_both(surfaces, p)? };
        if on.distance(p) > reach {
            return None;
        }
        nodes.push(on);
    }
    let closed = guide[0].distance(guide[last]) == 0.0;
    let mut ends = Vec::with_capacity(nodes.len());
    for k in 0..nodes.len() {
        let before = if k > 0 {
            nodes[k - 1]
        } else if closed {
            nodes[last - 1]
        } else {
            nodes[0]
        };
        let after = if k < last {
            nodes[k + 1]
        } else if closed {
            nodes[1]
        } else {
            nodes[last]
        };
        let own = tangent(surfaces, nodes[k], after - before);
        // Within, they cross; at an end they may touch.
        if own.is_none() && k > 0 && k < last {
            return None;
        }
        ends.push((nodes[k], own));
    }
    let mut pieces: Vec<Piece> = Vec::new();
    // Few long pieces first.
    let mut pending = vec![(0, last)];
    while let Some((i, j)) = pending.pop() {
        let piece = [ends[i], ends[j]];
        if i + 1 >= j {
            if divided(surfaces, piece, accuracy, DEEPEST, &mut pieces).is_none() {
                // Cells miss thinner parts, such as the end of a flat ellipse.
                let places = [1.0, -1.0]
                    .into_iter()
                    .find_map(|sign| walked(surfaces, guide, &ends, closed, reach, sign))?;
                pieces.clear();
                for part in places.windows(2) {
                    divided(surfaces, [part[0], part[1]], accuracy, DEEPEST, &mut pieces)?;
                }
                break;
            }
        } else if piece.iter().all(|end| end.1.is_some())
            && good(surfaces, piece, accuracy)
            && near(&guide[i..=j], piece, reach)
        {
            pieces.push(piece);
        } else {
            let m = i.midpoint(j);
            pending.push((m, j));
            pending.push((i, m));
        }
    }
    Some(joined(surfaces, &pieces))
}

fn good(surfaces: [&SurfaceShape; 2], piece: Piece, accuracy: f64) -> bool {
    let ([(p, _), (q, _)], [s, t]) = (piece, tangents(piece));
    let (points, _) = bezier(piece);
    let along = (q - p).normalized().is_some_and(|c| c.dot(s).min(c.dot(t)) > libm::cos(TURN));
    along
        && s.dot(t) > libm::cos(TURN)
        && surfaces.iter().all(|f| distance_bound(f, &points) <= accuracy)
}

/// True when all points of a guide are within reach of a piece.
fn near(guide: &[Vec3], piece: Piece, reach: f64) -> bool {
    const PLACES: usize = 32;
    let (points, _) = bezier(piece);
    let at = |k: usize| {
        let t = k as f64 / PLACES as f64;
        let s = 1.0 - t;
        points[0] * (s * s * s)
            + points[1] * (3.0 * s * s * t)
            + points[2] * (3.0 * s * t * t)
            + points[3] * (t * t * t)
    };
    let places: Vec<Vec3> = (0..=PLACES).map(at).collect();
    let step = places[0].distance(places[PLACES]) / PLACES as f64;
    guide.iter().all(|p| places.iter().any(|q| p.distance(*q) <= reach + step))
}

fn divided(
    surfaces: [&SurfaceShape; 2],
    piece: Piece,
    accuracy: f64,
    deep: u32,
    pieces: &mut Vec<Piece>,
) -> Option<()> {
    if good(surfaces, piece, accuracy) {
        pieces.push(piece);
        return Some(());
    }
    let [(p, _), (q, _)] = piece;
    let (points, _) = bezier(piece);
    let middle = (points[0] + points[3]) * 0.125 + (points[1] + points[2]) * 0.375;
    let middle = if middle.distance(p) > p.distance(q) { (p + q) * 0.5 } else { middle };
    let on = on_both(surfaces, middle)?;
    if deep == 0 || on.distance(middle) > p.distance(q) {
        return None;
    }
    let end = (on, Some(tangent(surfaces, on, q - p)?));
    divided(surfaces, [piece[0], end], accuracy, deep - 1, pieces)?;
    divided(surfaces, [end, piece[1]], accuracy, deep - 1, pieces)
}

/// Points along the crossing from the first point of a guide to its last. The points of the guide
/// in between need not be on the way; all points found must be near one of the guide's chords. With
/// `sign` -1 it starts against the first tangent, whose sense the guide may have wrong.
fn walked(
    surfaces: [&SurfaceShape; 2],
    guide: &[Vec3],
    ends: &[PieceEnd],
    closed: bool,
    reach: f64,
    sign: f64,
) -> Option<Vec<PieceEnd>> {
    const MOST: usize = 20_000;
    /// Maximum turn of the tangent between stations, in radians, and tolerance of the tangent, in
    /// steps.
    const BEND: f64 = 0.3;
    const ASIDE: f64 = 0.2;
    let last = ends.len() - 1;
    let targets = if closed { vec![last / 2, last] } else { vec![last] };
    let first = guide[1] - guide[0];
    let mut along = ends[0].1.or_else(|| first.normalized())? * sign;
    let mut step = 0.1 * first.norm().min(reach);
    let mut places = vec![(ends[0].0, ends[0].1.map(|t| t * sign))];
    let mut p = ends[0].0;
    for target in targets {
        let (to, slope) = ends[target];
        loop {
            let left = to - p;
            let ahead = left.normalized().is_none_or(|d| d.dot(along) > libm::cos(BEND));
            let turned = slope.map(|t| if t.dot(along) < 0.0 { -t } else { t });
            let same = turned.is_none_or(|t| t.dot(along) > libm::cos(BEND));
            if left.norm() <= 1.5 * step && ahead {
                if same {
                    places.push((to, turned));
                    (p, along) = (to, turned.unwrap_or(along));
                    break;
                }
                // The crossing turns before the target.
                step *= 0.5;
            }
            let guess = p + along * step;
            let next =
                on_both(surfaces, guess).and_then(|q| Some((q, tangent(surfaces, q, along)?)));
            match next {
                Some((q, t))
                    if q.distance(guess) <= ASIDE * step && t.dot(along) > libm::cos(BEND) =>
                {
                    places.push((q, Some(t)));
                    (p, along) = (q, t);
                    step = (1.3 * step).min(reach);
                }
                _ => step *= 0.5,
            }
            if step <= 1e-9 * reach || places.len() > MOST {
                return None;
            }
        }
    }
    let passed = |g: &Vec3| places.iter().any(|(p, _)| p.distance(*g) <= reach);
    guide.iter().all(passed).then_some(places)
}

/// Pieces that follow one another as one spline of unit speed at its knots.
fn joined(surfaces: [&SurfaceShape; 2], pieces: &[Piece]) -> Nurbs<1> {
    let mut knots = vec![0.0; 4];
    let mut points = Vec::with_capacity(2 * pieces.len() + 2);
    let (mut at, mut error) = (0.0, 0.0f64);
    for (k, piece) in pieces.iter().enumerate() {
        let (four, length) = bezier(*piece);
        error = surfaces.iter().map(|s| distance_bound(s, &four)).fold(error, f64::max);
        if k == 0 {
            points.push(four[0]);
        }
        points.extend([four[1], four[2]]);
        at += length;
        knots.extend([at; 2]);
        if k + 1 == pieces.len() {
            points.push(four[3]);
            knots.extend([at; 2]);
        }
    }
    let end = at;
    knots.iter_mut().for_each(|k| *k = if *k == end { 1.0 } else { *k / end });
    Nurbs {
        degrees: [3],
        knots: [knots],
        points,
        weights: None,
        error,
        exact: false,
        paces: [Pace::Even],
    }
}

/// A bound of the distance of a Bézier curve from a surface: the surface's polynomial along the curve has control
/// values of its own, which bound it.
pub fn distance_bound(surface: &SurfaceShape, points: &[Vec3; 4]) -> f64 {
    let most = |f: &[f64]| f.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let least = |f: &[f64]| f.iter().fold(f64::INFINITY, |m, x| m.min(*x));
    if let SurfaceShape::Image(image) = surface {
        return image_bound(image, points);
    }
    if let SurfaceShape::Extruded(shape) = surface {
        return shape.bound(points);
    }
    let Some(axes) = surface.axes() else {
        let far = |p: &Vec3| surface.distance(*p).unwrap_or(f64::INFINITY);
        return most(&points.map(|p| far(&p)));
    };
    let local = points.map(|p| axes.local(p));
    let [x, y, z] = [0, 1, 2].map(|k| local.map(|p| p[k]).to_vec());
    let [xx, yy, zz] = [&x, &y, &z].map(|f| times(f, f));
    let ring = sum(&xx, 1.0, &yy, 1.0, 0.0);
    match surface {
        // | |p| - r | = |p^2 - r^2| / (|p| + r).
        SurfaceShape::Cylinder { radius, .. } => {
            most(&ring.iter().map(|f| f - radius * radius).collect::<Vec<_>>()) / radius
        }
        SurfaceShape::Sphere { radius, .. } => {
            most(&sum(&ring, 1.0, &zz, 1.0, -radius * radius)) / radius
        }
        SurfaceShape::Cone { radius, half_angle, .. } => {
            let (sin, cos) = (libm::sin(*half_angle), libm::cos(*half_angle));
            let h: Vec<f64> = z.iter().map(|z| z + radius * cos / sin).collect();
            let f = sum(&ring, cos * cos, &times(&h, &h), -sin * sin, 0.0);
            let away = least(&ring).max(0.0).sqrt();
            let high = least(&h).max(-h.iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x))).max(0.0);
            let below = away * cos + high * sin;
            if below > 0.0 { most(&f) / below } else { f64::INFINITY }
        }
        // With e = ring^2 + z^2 + R^2 - r^2 the torus is e^2 = 4 R^2 ring^2.
        SurfaceShape::Torus { major, minor, .. } => {
            let e = sum(&ring, 1.0, &zz, 1.0, major * major - minor * minor);
            let big = vec![1.0; e.len()];
            let f = sum(&times(&e, &e), 1.0, &times(&ring, &big), -4.0 * major * major, 0.0);
            let below = least(&e) + 2.0 * major * least(&ring).max(0.0).sqrt();
            if below > 0.0 { most(&f) / below / minor } else { f64::INFINITY }
        }
        _ => f64::INFINITY,
    }
}

/// A bound of the distance of a Bézier curve from an ellipsoid or an elliptic cylinder or cone,
/// given as the image of the unit sphere, the unit cylinder or a cone as wide as high. With F half
/// the polynomial that is zero on it, there is a zero within 2 |F| / |F'| along the normal if F'
/// changes little over that distance.
fn image_bound(image: &SurfaceImage, points: &[Vec3; 4]) -> f64 {
    let of = image.of();
    let (signs, one) = match of {
        SurfaceShape::Sphere { .. } => ([1.0, 1.0, 1.0], 1.0),
        SurfaceShape::Cylinder { .. } => ([1.0, 1.0, 0.0], 1.0),
        SurfaceShape::Cone { .. } => ([1.0, 1.0, -1.0], 0.0),
        _ => return f64::INFINITY,
    };
    let Some(axes) = of.axes() else { return f64::INFINITY };
    // The radius of a cone belongs to a height; its coordinates begin at the apex.
    let origin = of.apex().unwrap_or(axes.origin);
    let axes = SurfaceAxes { origin, ..*axes };
    let local = points.map(|p| axes.local(image.local(p)));
    let coordinate = [0, 1, 2].map(|k| local.map(|p| p[k]).to_vec());
    let squares = [0, 1, 2].map(|k| times(&coordinate[k], &coordinate[k]));
    let f: Vec<f64> = (0..squares[0].len())
        .map(|i| 0.5 * ((0..3).map(|k| signs[k] * squares[k][i]).sum::<f64>() - one))
        .collect();
    let most = f.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    // Half the gradient by the image's coordinates.
    let unit = [axes.x, axes.y(), axes.z];
    let gradient = [0, 1, 2].map(|k| image.gradient(unit[k]) * signs[k]);
    let parts: [Vec<f64>; 3] = [0, 1, 2]
        .map(|j| (0..4).map(|i| (0..3).map(|k| gradient[k][j] * coordinate[k][i]).sum()).collect());
    let steep = (0..2 * parts[0].len() - 1)
        .map(|i| parts.iter().map(|g| times(g, g)[i]).sum::<f64>())
        .fold(f64::INFINITY, f64::min);
    let curved = gradient.iter().map(|g| g.norm_sq()).sum::<f64>();
    if steep > 0.0 && 2.0 * most * curved <= steep {
        2.0 * most / steep.sqrt()
    } else {
        f64::INFINITY
    }
}

/// a f + b g + c of Bernstein forms of one degree.
fn sum(f: &[f64], a: f64, g: &[f64], b: f64, c: f64) -> Vec<f64> {
    f.iter().zip(g).map(|(x, y)| a * x + b * y + c).collect()
}

/// The product of two Bernstein forms.
pub(crate) fn times(f: &[f64], g: &[f64]) -> Vec<f64> {
    let (m, n) = (f.len() - 1, g.len() - 1);
    let mut out = vec![0.0; m + n + 1];
    for (i, x) in f.iter().enumerate() {
        for (j, y) in g.iter().enumerate() {
            out[i + j] += choose(m, i) * choose(n, j) / choose(m + n, i + j) * x * y;
        }
    }
    out
}

fn choose(n: usize, k: usize) -> f64 {
    (0..k.min(n - k)).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64)
}
