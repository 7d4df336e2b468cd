//! Lines and points of bodies of sets, beside the faces.
//!
//! A line is where two sheets meet, and the body has points of it: cubics between them have its tangents, and are halved
//! until they are near enough to both sheets, so that the line is within the accuracy like all else in the file.

use super::bodies::set_and_box;
use moldloft_brep::{Brep, Part, PartPoint, Wire, foot};
use moldloft_diag::Diagnostic;
use moldloft_document::Document;
use moldloft_field::Primitive;
use moldloft_num::{Pace, Vec3};
use moldloft_picture::PALETTE;
use moldloft_registry::Value;
use moldloft_spline::nurbs::Nurbs;

/// Halvings of a piece.
const DEEPEST: u32 = 16;
/// Distance from a sheet, relative to the size, below which a point is on it.
const ON: f64 = 1e-7;
/// Deviation, relative to the size, below which a line is straight.
const STRAIGHT: f64 = 1e-12;

/// Adds the lines and points of the shown bodies, and their images in planes of symmetry, a part for each body.
///
/// # Errors
/// Lines that are not where two sheets meet: how near a curve is to them is not known.
pub fn add(
    brep: &mut Brep,
    document: &Document,
    [accuracy, size]: [f64; 2],
    symmetry: &str,
) -> Result<(), Diagnostic> {
    for object in document.graph().objects().filter(|o| o.head.shown()) {
        let Some(Value::Body(body)) = object.value() else { continue };
        if body.wires.is_empty() && body.dots.is_empty() {
            continue;
        }
        let sheets: Vec<Primitive> = set_and_box(document, object)
            .map(|(set, _)| set.leaves())
            .unwrap_or_default()
            .iter()
            .filter(|leaf| leaf.primitive.is_sheet())
            .map(|leaf| leaf.primitive.of_sheet().clone())
            .collect();
        let colour = Some(PALETTE[(object.head.colour & 15) as usize]);
        let named = |k: usize, of: &str, count: usize| match count {
            1 => format!("{}.{of}", object.name),
            _ => format!("{}.{of}.{}", object.name, k + 1),
        };
        let mut part = Part { name: format!("{}.lines", object.name), ..Part::default() };
        for (k, line) in body.wires.iter().enumerate() {
            let (pieces, error) = refined(line, &sheets, [accuracy, size], ON * size)
                .map_err(|place| unknown(&object.name, place))?;
            let Some(curve) = spline(&pieces, error, size) else { continue };
            brep.gap = brep.gap.max(curve.error);
            let name = named(k, "line", body.wires.len());
            part.wires.push(Wire { name, colour, layers: Vec::new(), curve });
        }
        for (k, &place) in body.dots.iter().enumerate() {
            let name = named(k, "point", body.dots.len());
            part.points.push(PartPoint { name, colour, place });
        }
        for axis in ['x', 'y', 'z'].iter().enumerate().filter(|(_, c)| symmetry.contains(**c)) {
            mirror(&mut part, axis.0);
        }
        brep.parts.push(part);
    }
    Ok(())
}

fn unknown(name: &str, p: Vec3) -> Diagnostic {
    let place = format!("({:.6}, {:.6}, {:.6})", p.x, p.y, p.z);
    Diagnostic::error(
        "cannot-write",
        format!("a wire of `{name}` is not the intersection of two sheets near {place}"),
    )
    .help("write it as obj or vtp, or hide it")
}

/// Adds the images of all lines and points in a coordinate plane, except those in the plane.
fn mirror(part: &mut Part, axis: usize) {
    let image = |p: &Vec3| {
        let mut p = p.to_array();
        p[axis] = -p[axis];
        Vec3::of(p[0], p[1], p[2])
    };
    let off = |p: &Vec3| p[axis] != 0.0;
    let wires: Vec<Wire> =
        part.wires.iter().filter(|w| w.curve.points.iter().any(off)).cloned().collect();
    part.wires.extend(wires.into_iter().map(|mut wire| {
        wire.name += " image";
        wire.curve.points = wire.curve.points.iter().map(image).collect();
        wire
    }));
    let points: Vec<PartPoint> = part.points.iter().filter(|p| off(&p.place)).cloned().collect();
    part.points.extend(points.into_iter().map(|mut point| {
        point.name += " image";
        point.place = image(&point.place);
        point
    }));
}

/// A piece of a line: both ends, its first derivatives there by `length`, and `length`.
#[derive(Clone, Copy)]
struct LinePiece {
    ends: [Vec3; 2],
    tangents: [Vec3; 2],
    length: f64,
}

impl LinePiece {
    /// The cubic with these tangents whose parameter is near to the length: that of an arc of the angle between them.
    fn new(ends: [Vec3; 2], pair: [&Primitive; 2]) -> Self {
        let chord = ends[1] - ends[0];
        let straight = chord.normalized().unwrap_or_default();
        let tangents = ends.map(|p| along(p, pair, chord).unwrap_or(straight));
        let half =
            0.5 * libm::atan2(tangents[0].cross(tangents[1]).norm(), tangents[0].dot(tangents[1]));
        let stretch = if half < 1e-4 { 1.0 + half * half / 6.0 } else { half / libm::sin(half) };
        Self { ends, tangents, length: chord.norm() * stretch }
    }

    /// The inner control points.
    fn inner(&self) -> [Vec3; 2] {
        let third = self.length / 3.0;
        [self.ends[0] + self.tangents[0] * third, self.ends[1] - self.tangents[1] * third]
    }

    /// Distance from both sheets.
    fn off(&self, pair: [&Primitive; 2], scale: [f64; 2]) -> f64 {
        let [b, c] = self.inner();
        let at = |t: f64| {
            let s = 1.0 - t;
            self.ends[0] * (s * s * s)
                + b * (3.0 * s * s * t)
                + c * (3.0 * s * t * t)
                + self.ends[1] * (t * t * t)
        };
        let off = |t: f64| {
            let near = on_both(at(t), pair, self.length, scale);
            near.map_or(f64::INFINITY, |p| at(t).distance(p))
        };
        [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875].map(off).into_iter().fold(0.0, f64::max)
    }
}

/// Cubics along the line that are near enough to the sheets, and their largest distance; else a
/// point that is not on two sheets within `near`.
fn refined(
    line: &[Vec3],
    sheets: &[Primitive],
    scale: [f64; 2],
    near: f64,
) -> Result<(Vec<LinePiece>, f64), Vec3> {
    let mut found = Vec::new();
    let mut worst = 0.0f64;
    // Cells that a line leaves by a corner have a point each there.
    let whole: f64 = line.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
    let mut line = line.to_vec();
    line.dedup_by(|next, p| next.distance(*p) <= 1e-9 * whole);
    for ends in line.windows(2) {
        let pair = pair_at(sheets, ends, near).ok_or(ends[0])?;
        let mut todo = vec![([ends[0], ends[1]], 0)];
        while let Some((ends, depth)) = todo.pop() {
            let piece = LinePiece::new(ends, pair);
            let off = piece.off(pair, scale);
            if off > 0.5 * scale[0] && depth < DEEPEST {
                let middle = (ends[0] + ends[1]) * 0.5;
                let middle = on_both(middle, pair, piece.length, scale).ok_or(middle)?;
                todo.push(([middle, ends[1]], depth + 1));
                todo.push(([ends[0], middle], depth + 1));
            } else {
                // Between the sampled points it may be somewhat farther.
                worst = worst.max(1.5 * off);
                found.push(piece);
            }
        }
    }
    Ok((found, worst))
}

/// The unit tangent of the line in which two sheets meet, on the side of a direction.
fn along(p: Vec3, [a, b]: [&Primitive; 2], side: Vec3) -> Option<Vec3> {
    let (f, g) = (a.gradient(p).slope.normalized()?, b.gradient(p).slope.normalized()?);
    let t = f.cross(g);
    let t = if t.norm() > 1e-6 { t.normalized()? } else { return None };
    Some(if t.dot(side) < 0.0 { -t } else { t })
}

/// The two sheets on which both ends are, within `near`.
fn pair_at<'a>(sheets: &'a [Primitive], ends: &[Vec3], near: f64) -> Option<[&'a Primitive; 2]> {
    let off = |f: &Primitive| {
        let away = |p: &Vec3| {
            let g = f.gradient(*p);
            g.value.abs() / g.slope.norm().max(f64::MIN_POSITIVE)
        };
        ends.iter().map(away).fold(0.0, f64::max)
    };
    let mut known: Vec<(f64, &Primitive)> = sheets.iter().map(|f| (off(f), f)).collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    match known[..] {
        [(_, a), (off, b), ..] if off <= near => Some([a, b]),
        _ => None,
    }
}

/// The point near another on both sheets, if there is one.
fn on_both(p: Vec3, pair: [&Primitive; 2], reach: f64, scale: [f64; 2]) -> Option<Vec3> {
    let field = |k: u32, p: Vec3| {
        let g = pair[k as usize].gradient(p);
        (g.value, g.slope)
    };
    foot(&field, &[0, 1], p, reach, scale)
}

/// Pieces as one spline: a straight line where all are, else a cubic with a tangent everywhere but at corners.
fn spline(pieces: &[LinePiece], error: f64, size: f64) -> Option<Nurbs<1>> {
    let (first, last) = (pieces.first()?.ends[0], pieces.last()?.ends[1]);
    let chord = last - first;
    let aside = |p: Vec3| (p - first).cross(chord).norm() <= STRAIGHT * size * chord.norm();
    let straight = chord.norm() > 0.0
        && error <= STRAIGHT * size
        && pieces.iter().all(|piece| piece.inner().into_iter().chain(piece.ends).all(aside));
    let made = |degree: usize, knots: Vec<f64>, points: Vec<Vec3>| Nurbs {
        degrees: [degree],
        knots: [knots],
        points,
        weights: None,
        error: if straight { 0.0 } else { error },
        exact: straight,
        paces: [Pace::Even],
    };
    if straight {
        return Some(made(1, vec![0.0, 0.0, 1.0, 1.0], vec![first, last]));
    }
    let whole: f64 = pieces.iter().map(|piece| piece.length).sum();
    let mut knots = vec![0.0; 4];
    let mut points = vec![first];
    let mut at = 0.0;
    for (k, piece) in pieces.iter().enumerate() {
        points.extend(piece.inner());
        at += piece.length;
        let Some(next) = pieces.get(k + 1) else { break };
        let smooth = piece.tangents[1].distance(next.tangents[0]) < 1e-9;
        // At a smooth junction the point between follows from its neighbours.
        if !smooth {
            points.push(piece.ends[1]);
        }
        knots.extend(std::iter::repeat_n(at / whole, if smooth { 2 } else { 3 }));
    }
    points.push(last);
    knots.extend([1.0; 4]);
    Some(made(3, knots, points))
}
