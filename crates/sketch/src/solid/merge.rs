//! Uniting objects, and changes of whole objects that keep them parametric.

use crate::dimension::layout::chain_expression;
use crate::identifier::identifier;
use crate::{
    Align, CoordinateAxis, Dimension, DimensionExpr, DimensionFault, DimensionLayout,
    DimensionRole, Drawing, DrawnLine, DrawnPoint, MeasuredQuantity, Planes, PointId, Projection,
    Reference, SketchObject, Variable,
};
use moldloft_num::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// An object with its positions.
pub struct Placed<'a> {
    /// The object.
    pub object: &'a SketchObject,
    /// Its points with their positions.
    pub at: BTreeMap<PointId, Vec3>,
}

/// Result of a merge.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MergeReport {
    /// Points that occurred twice.
    pub shared: usize,
    /// Lines that occurred twice.
    pub lines: usize,
    /// Dimensions that contradicted others; they are reference dimensions now.
    pub contradictory: Vec<String>,
}

/// Unites objects under a name, with names prefixed by their object, except those of the first if
/// `keep_first`. Equal points (within `tolerance`) and equal lines are merged; all dimensions are
/// kept.
pub fn merge(
    name: &str,
    parts: &[Placed],
    tolerance: f64,
    keep_first: bool,
    solve: &dyn Fn(&SketchObject) -> DimensionLayout<f64>,
) -> (SketchObject, MergeReport) {
    let mut out = SketchObject::new(name, None);
    let mut report = MergeReport::default();
    let mut placed: Vec<(PointId, Vec3)> = Vec::new();
    let mut references: Vec<(String, Reference)> = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        let old = part.object;
        if k == 0 {
            out.units.clone_from(&old.units);
            let drawing = out.draw();
            (drawing.projection, drawing.letters) = (old.drawing.projection, old.drawing.letters);
        }
        let prefix = if k == 0 && keep_first {
            String::new()
        } else {
            format!("{}.", identifier(&old.name))
        };
        let mut number: BTreeMap<PointId, PointId> = BTreeMap::new();
        for (&id, &p) in &part.at {
            let equal = placed.iter().find(|(_, q)| q.distance(p) <= tolerance).map(|x| x.0);
            report.shared += usize::from(equal.is_some());
            let new = equal.unwrap_or_else(|| {
                let new = PointId(placed.len() as u32 + 1);
                placed.push((new, p));
                let [u, v] = out.drawing.projection.project(p);
                out.draw().points.insert(new, DrawnPoint { u, v });
                new
            });
            number.insert(id, new);
        }
        let mut lines = BTreeMap::new();
        for (&id, line) in &old.drawing.lines {
            let (p, q) = (number[&line.p], number[&line.q]);
            let same = out.drawing.line_between(p, q);
            report.lines += usize::from(same.is_some());
            let new = same.unwrap_or_else(|| out.drawing.next_line());
            if p != q && same.is_none() {
                out.draw().lines.insert(new, DrawnLine { p, q, ..*line });
            }
            lines.insert(id, new);
        }
        for a in &old.drawing.aligns {
            let a = Align { axis: a.axis, p: number[&a.p], q: number[&a.q] };
            if a.p != a.q && !out.drawing.aligns.contains(&a) {
                out.draw().aligns.push(a);
            }
        }
        let own = |n: &str| old.has_name(n).then(|| format!("{prefix}{n}"));
        for v in old.variables.values() {
            let name = format!("{prefix}{}", v.name);
            let new = Variable { name: name.clone(), value: v.value.renamed(&own), range: v.range };
            out.variables.insert(name.to_ascii_lowercase(), new);
        }
        for d in old.dimensions.values() {
            let point = |p: PointId| number[&p];
            let measure = match d.measure {
                MeasuredQuantity::Along { axis, p, q } => {
                    MeasuredQuantity::Along { axis, p: point(p), q: point(q) }
                }
                MeasuredQuantity::Datum { axis, point: p } => {
                    MeasuredQuantity::Datum { axis, point: point(p) }
                }
                MeasuredQuantity::Length(l) => MeasuredQuantity::Length(lines[&l]),
                MeasuredQuantity::Slope(l) => MeasuredQuantity::Slope(lines[&l]),
                MeasuredQuantity::Angle(a, b) => MeasuredQuantity::Angle(lines[&a], lines[&b]),
                MeasuredQuantity::Equal(a, b) => MeasuredQuantity::Equal(lines[&a], lines[&b]),
            };
            let value = d.value.as_ref().map(|v| v.renamed(&own));
            let name = format!("{prefix}{}", d.name);
            out.add_dimension(Dimension { name, measure, value, ..d.clone() });
        }
        for c in old.curves.values() {
            let mut c = c.clone();
            c.name = format!("{prefix}{}", c.name);
            c.points.iter_mut().for_each(|p| *p = number[p]);
            c.sizes_mut().for_each(|size| *size = size.renamed(&own));
            let twin =
                |o: &crate::solid::curve::SketchCurve| o.kind == c.kind && o.points == c.points;
            if !out.curves.values().any(twin) {
                out.curves.insert(c.name.to_ascii_lowercase(), c);
            }
        }
        if let Some(r) = old.reference() {
            let at = r.at.map(|e| e.renamed(&own));
            references.push((prefix, Reference { point: number[&r.point], at }));
        }
    }
    out.reference = references.first().map(|(_, first)| first.clone());
    settle(&mut out, &mut report, solve);
    // Coordinates without a common plane keep the position of their own reference.
    for (prefix, Reference { point, at }) in references.iter().skip(1) {
        for axis in CoordinateAxis::ALL {
            let planes = Planes::of(&out.drawing);
            if solve(&out).coordinate(&planes, axis, *point).is_none() {
                out.add_dimension(Dimension {
                    name: format!("{prefix}ref_{}", axis.letter().to_ascii_lowercase()),
                    measure: MeasuredQuantity::Datum { axis, point: *point },
                    value: Some(at[axis.index()].clone()),
                    role: DimensionRole::Driving,
                    range: None,
                });
            }
        }
    }
    settle(&mut out, &mut report, solve);
    (out, report)
}

/// Makes references of dimensions that others determine.
pub(crate) fn settle(
    out: &mut SketchObject,
    report: &mut MergeReport,
    solve: &dyn Fn(&SketchObject) -> DimensionLayout<f64>,
) {
    for fault in solve(out).faults {
        let (name, wrong) = match fault {
            DimensionFault::Redundant { name, .. } => (name, false),
            DimensionFault::Contradictory { name, .. } => (name, true),
            _ => continue,
        };
        if let Some(d) = out.dimensions.get_mut(&name.to_ascii_lowercase()) {
            d.role = DimensionRole::Reference;
        }
        if wrong {
            report.contradictory.push(name);
        }
    }
}

/// Removes lines (scribed ones) and then points inside straight lines. Dimensions that end at such
/// points become variables, and are replaced by their sums, so that the object stays parametric.
pub fn clean(
    object: &SketchObject,
    lines: &[[PointId; 2]],
    at: &BTreeMap<PointId, Vec3>,
) -> SketchObject {
    let mut out = object.clone();
    for [p, q] in lines {
        if let Some(id) = out.drawing.line_between(*p, *q) {
            out.draw().lines.remove(&id);
        }
    }
    let mut gone: Vec<PointId> = Vec::new();
    loop {
        let straight = out.drawing.points.keys().copied().find_map(|p| {
            let mut own = out.drawing.lines.iter().filter(|(_, l)| l.p == p || l.q == p);
            match (own.next(), own.next(), own.next()) {
                (None, ..) => Some((p, None)),
                (Some((&i, a)), Some((&j, b)), None) => {
                    let far = |l: &DrawnLine| if l.p == p { l.q } else { l.p };
                    let (a, b) = (at.get(&far(a))?, at.get(&far(b))?);
                    let here = *at.get(&p)?;
                    let (da, db) = (*a - here, *b - here);
                    let flat = da.cross(db).norm() <= 1e-9 * da.norm() * db.norm();
                    (flat && da.dot(db) < 0.0).then_some((p, Some((i, j))))
                }
                _ => None,
            }
        });
        let Some((p, pair)) = straight else { break };
        let drawing = out.draw();
        if let Some((i, j)) = pair {
            let far = |l: DrawnLine| if l.p == p { l.q } else { l.p };
            let (a, b) = (drawing.lines[&i], drawing.lines[&j]);
            let joined = DrawnLine { p: far(a), q: far(b), ..a };
            drawing.lines.remove(&j);
            if drawing.line_between(joined.p, joined.q).is_none() {
                drawing.lines.insert(i, joined);
            } else {
                drawing.lines.remove(&i);
            }
        }
        drawing.remove_point(p);
        gone.push(p);
    }
    let Some(reference) = object.reference() else { return out };
    // The reference must stay: it moves to another corner.
    let old_planes = Planes::of(&object.drawing);
    if gone.contains(&reference.point)
        && let Some((&point, p)) = at.iter().find(|(p, _)| !gone.contains(p))
    {
        let coordinate = |axis: CoordinateAxis| {
            let here = &reference.at[axis.index()];
            if old_planes.same(axis, reference.point, point) {
                return here.clone();
            }
            let way = chain_expression(object, &old_planes, axis, reference.point, point);
            way.and_then(|way| DimensionExpr::parse(&format!("({here}) + ({way})")).ok())
                .unwrap_or_else(|| DimensionExpr::number(p[axis.index()]))
        };
        out.reference = Some(Reference { point, at: CoordinateAxis::ALL.map(coordinate) });
    }
    let doomed: Vec<String> = (object.dimensions.iter())
        .filter(|(_, d)| match d.measure {
            MeasuredQuantity::Along { p, q, .. } => gone.contains(&p) || gone.contains(&q),
            MeasuredQuantity::Datum { point, .. } => gone.contains(&point),
            _ => false,
        })
        .map(|(k, _)| k.clone())
        .collect();
    for key in &doomed {
        if let Some(Dimension { name, value: Some(value), range, .. }) =
            out.dimensions.shift_remove(key)
        {
            out.variables.insert(key.clone(), Variable { name, value, range });
        }
    }
    out.drop_dangling();
    out.faces.clear();
    let new_planes = Planes::of(&out.drawing);
    let Some(from) = out.reference() else { return out };
    for axis in CoordinateAxis::ALL {
        let mut seen: Vec<usize> = Vec::new();
        for &p in new_planes.ids() {
            let Some(plane) = new_planes.plane(axis, p) else { continue };
            if seen.contains(&plane) {
                continue;
            }
            seen.push(plane);
            let linked = crate::chain(&out, &new_planes, axis, from.point, p).is_some();
            if linked || new_planes.same(axis, from.point, p) {
                continue;
            }
            let sum = chain_expression(object, &old_planes, axis, from.point, p);
            let here = at.get(&p).map_or(0.0, |x| x[axis.index()]);
            let there = at.get(&from.point).map_or(0.0, |x| x[axis.index()]);
            let value = sum
                .and_then(|s| DimensionExpr::parse(&s).ok())
                .unwrap_or_else(|| DimensionExpr::number(here - there));
            let measure = MeasuredQuantity::Along { axis, p: from.point, q: p };
            let name = out.fresh_name("D");
            out.add_dimension(Dimension {
                name,
                measure,
                value: Some(value),
                role: DimensionRole::Driving,
                range: None,
            });
        }
    }
    out
}

/// Makes a solid wireframe of a cross section: a second copy along its normal, with the dimension
/// `name` between the two.
pub fn extrude(section: &SketchObject, name: &str, value: DimensionExpr) -> Option<SketchObject> {
    let normal = section.drawing.section?;
    let mut out = section.clone();
    out.faces.clear();
    let flat: Drawing = (*section.drawing).clone();
    let shift = flat.next_point().0 - 1;
    let depth = flat.points.values().map(|p| p.u.abs().max(p.v.abs())).fold(1.0, f64::max);
    let [du, dv] = flat.projection.unit(normal);
    let up = |p: PointId| PointId(p.0 + shift);
    let drawing = out.draw();
    drawing.section = None;
    for (&id, p) in &flat.points {
        drawing.points.insert(up(id), DrawnPoint { u: p.u + du * depth, v: p.v + dv * depth });
    }
    for line in flat.lines.values() {
        let id = drawing.next_line();
        drawing.lines.insert(id, DrawnLine { p: up(line.p), q: up(line.q), ..*line });
    }
    for &id in flat.points.keys() {
        let line = DrawnLine {
            p: id,
            q: up(id),
            free: Some(crate::Free::along(normal)),
            source: crate::LineTypeSource::User,
            confidence: 1.0,
        };
        let number = drawing.next_line();
        drawing.lines.insert(number, line);
    }
    let first = *flat.points.keys().next()?;
    for &id in flat.points.keys().skip(1) {
        let planes = Planes::of(drawing);
        // Separate figures are aligned in the same two planes.
        if !planes.same(normal, first, id) {
            drawing.aligns.push(Align { axis: normal, p: first, q: id });
        }
        if !planes.same(normal, up(first), up(id)) {
            drawing.aligns.push(Align { axis: normal, p: up(first), q: up(id) });
        }
    }
    for c in section.curves.values() {
        let mut copy = c.clone();
        copy.points.iter_mut().for_each(|p| *p = up(*p));
        copy.name = out.fresh_name(&format!("{}_", c.name));
        out.curves.insert(copy.name.to_ascii_lowercase(), copy);
    }
    out.add_dimension(Dimension {
        name: name.to_owned(),
        measure: MeasuredQuantity::Along { axis: normal, p: first, q: up(first) },
        value: Some(value),
        role: DimensionRole::Driving,
        range: None,
    });
    Some(out)
}

/// The object with every length multiplied by a positive factor.
pub fn scaled(object: &SketchObject, factor: f64) -> SketchObject {
    let mut out = object.clone();
    for d in out.dimensions.values_mut() {
        if matches!(
            d.measure,
            MeasuredQuantity::Along { .. }
                | MeasuredQuantity::Datum { .. }
                | MeasuredQuantity::Length(_)
        ) {
            d.value = d.value.as_ref().map(|v| v.times(factor));
            d.range = d.range.map(|r| r.map(|x| x * factor));
        }
    }
    for c in out.curves.values_mut() {
        c.radius = c.radius.as_ref().map(|r| r.times(factor));
        c.semi = c.semi.as_ref().map(|[a, b]| [a.times(factor), b.times(factor)]);
    }
    if let Some(r) = object.reference() {
        out.reference = Some(Reference { at: r.at.each_ref().map(|e| e.times(factor)), ..r });
    }
    out
}

/// Moved by a vector.
pub fn moved(object: &SketchObject, by: Vec3) -> SketchObject {
    let mut out = object.clone();
    if let Some(r) = object.reference() {
        let at = CoordinateAxis::ALL.map(|a| r.at[a.index()].plus(by[a.index()]));
        out.reference = Some(Reference { at, ..r });
    }
    for d in out.dimensions.values_mut() {
        if let (MeasuredQuantity::Datum { axis, .. }, Some(v)) = (d.measure, &d.value) {
            d.value = Some(v.plus(by[axis.index()]));
        }
    }
    out
}

/// Mirrored in the plane through the origin perpendicular to an axis.
pub fn mirrored(object: &SketchObject, axis: CoordinateAxis) -> SketchObject {
    let mut out = object.clone();
    for d in out.dimensions.values_mut() {
        match &mut d.measure {
            MeasuredQuantity::Along { axis: a, p, q } if *a == axis => std::mem::swap(p, q),
            MeasuredQuantity::Datum { axis: a, .. } if *a == axis => {
                d.value = d.value.as_ref().map(|v| v.times(-1.0));
            }
            _ => {}
        }
    }
    if let Some(r) = object.reference() {
        let mut at = r.at.clone();
        at[axis.index()] = at[axis.index()].times(-1.0);
        out.reference = Some(Reference { at, ..r });
    }
    out.faces = out.faces.iter().map(|(id, f)| (*id, f.reversed())).collect();
    out
}

/// Rotated by a quarter turn about an axis, right-handed: exchange the two other axes, then mirror.
pub fn quarter_turned(object: &SketchObject, about: CoordinateAxis) -> SketchObject {
    let (a, b) = match about {
        CoordinateAxis::X => (CoordinateAxis::Y, CoordinateAxis::Z),
        CoordinateAxis::Y => (CoordinateAxis::Z, CoordinateAxis::X),
        CoordinateAxis::Z => (CoordinateAxis::X, CoordinateAxis::Y),
    };
    let other = |x: CoordinateAxis| {
        if x == a {
            b
        } else if x == b {
            a
        } else {
            x
        }
    };
    let mut out = object.clone();
    let drawing = out.draw();
    drawing.section = drawing.section.map(other);
    drawing.lines.values_mut().for_each(|l| l.free = l.free.map(|f| f.swapped(a, b)));
    drawing.aligns.iter_mut().for_each(|l| l.axis = other(l.axis));
    for d in out.dimensions.values_mut() {
        match &mut d.measure {
            MeasuredQuantity::Along { axis, .. } | MeasuredQuantity::Datum { axis, .. } => {
                *axis = other(*axis)
            }
            _ => {}
        }
    }
    if let Some(r) = object.reference() {
        let mut at = r.at.clone();
        at.swap(a.index(), b.index());
        out.reference = Some(Reference { at, ..r });
    }
    // The exchange has turned faces inside out; the mirror turns them back.
    out.faces = out.faces.iter().map(|(id, f)| (*id, f.reversed())).collect();
    mirrored(&out, a)
}

/// The picture redrawn from the positions.
pub fn redrawn(object: &SketchObject, at: &BTreeMap<PointId, Vec3>) -> SketchObject {
    let mut out = object.clone();
    if let Some(normal) = out.drawing.section {
        out.draw().projection = Projection::section(normal);
    }
    let drawing = Arc::make_mut(&mut out.drawing);
    for (id, point) in &mut drawing.points {
        if let Some(p) = at.get(id) {
            let [u, v] = drawing.projection.project(*p);
            *point = DrawnPoint { u, v };
        }
    }
    out
}
