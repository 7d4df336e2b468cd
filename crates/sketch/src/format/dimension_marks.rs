//! Layout of dimensions on a drawing: dimension lines beside the measured parts, witness lines, and
//! positions of texts.

use crate::{
    CoordinateAxis, DimensionRole, Drawing, LineId, MeasuredQuantity, Planes, PointId, SketchObject,
};
use moldloft_syntax::number::plain;
use std::collections::BTreeMap;

/// Distance of the first dimension line from the drawing, relative to its size, and between further
/// ones.
const APART: f64 = 0.05;

/// Extension of a witness line beyond the dimension line, and its gap to the drawing, relative to
/// the size.
const BEYOND: f64 = 0.012;

/// A dimension on the page, v up.
#[derive(Clone, Debug, PartialEq)]
pub struct DimensionMark {
    /// Its name.
    pub name: String,
    /// Name and value, in brackets for a reference dimension.
    pub text: String,
    /// Its value; `None` while it is unknown.
    pub value: Option<f64>,
    /// True for a reference dimension.
    pub reference: bool,
    /// Its axis.
    pub axis: Option<CoordinateAxis>,
    /// Position of the text: the middle of the dimension line.
    pub at: [f64; 2],
    /// The dimension line, with arrows at both ends, in the direction of the dimension; `None` of slopes, angles and equal lengths.
    pub line: Option<[[f64; 2]; 2]>,
    /// The witness lines, from the drawing to beyond the dimension line.
    pub witnesses: Vec<[[f64; 2]; 2]>,
}

/// A page: where points are drawn, and the directions of the axes.
pub(crate) struct Page<'a> {
    pub place: &'a dyn Fn(PointId) -> Option<[f64; 2]>,
    pub unit: &'a dyn Fn(CoordinateAxis) -> [f64; 2],
}

/// A drawing in the coordinates along and across a direction of the page.
struct PageFrame {
    /// The points, in the order of the places; `None` where the directions are parallel.
    points: Vec<Option<[f64; 2]>>,
    /// The lines, from their lower ends, in the order of these.
    lines: Vec<[[f64; 2]; 2]>,
}

impl PageFrame {
    fn of(
        drawing: &Drawing,
        places: &BTreeMap<PointId, [f64; 2]>,
        [a, w]: [[f64; 2]; 2],
    ) -> PageFrame {
        let line = |p: PointId, q: PointId| {
            let [p, q] = [p, q].map(|p| places.get(&p).and_then(|at| split(*at, a, w)));
            let (p, q) = (p?, q?);
            Some(if p[0] <= q[0] { [p, q] } else { [q, p] })
        };
        let mut lines: Vec<_> = drawing.lines.values().filter_map(|l| line(l.p, l.q)).collect();
        lines.sort_unstable_by(|l, m| l[0][0].total_cmp(&m[0][0]));
        PageFrame { points: places.values().map(|at| split(*at, a, w)).collect(), lines }
    }
}

/// The points of a drawing by their planes, with its frames of two axes.
struct PageLayout {
    places: BTreeMap<PointId, [f64; 2]>,
    /// Of each point its planes.
    classes: Vec<[Option<usize>; 3]>,
    /// By axis and plane, the indices of the points.
    members: BTreeMap<(usize, usize), Vec<usize>>,
    frames: [[Option<PageFrame>; 3]; 3],
}

impl PageLayout {
    fn of(drawing: &Drawing, planes: &Planes, page: &Page<'_>) -> PageLayout {
        let places: BTreeMap<PointId, [f64; 2]> =
            drawing.points.keys().filter_map(|&p| Some((p, (page.place)(p)?))).collect();
        let classes: Vec<[Option<usize>; 3]> =
            places.keys().map(|&p| CoordinateAxis::ALL.map(|a| planes.plane(a, p))).collect();
        let mut members: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
        for (k, own) in classes.iter().enumerate() {
            for (axis, plane) in own.iter().enumerate() {
                if let Some(plane) = plane {
                    members.entry((axis, *plane)).or_default().push(k);
                }
            }
        }
        let frame = |a: CoordinateAxis, w: CoordinateAxis| {
            let units = [(page.unit)(a), (page.unit)(w)];
            (a != w).then(|| PageFrame::of(drawing, &places, units))
        };
        let frames = CoordinateAxis::ALL.map(|a| CoordinateAxis::ALL.map(|w| frame(a, w)));
        PageLayout { classes, members, frames, places }
    }
}

/// A dimension line that is still to be put in its row: the axes of its direction and its witness lines.
struct UnplacedMark {
    mark: usize,
    axis: CoordinateAxis,
    across: CoordinateAxis,
    side: f64,
    /// Ends in (along, across).
    ends: [[f64; 2]; 2],
    /// The first row that is clear of the drawing.
    clear: f64,
}

/// The marks of all dimensions of an object; `values` by folded name.
pub(crate) fn dimension_marks(
    object: &SketchObject,
    planes: &Planes,
    page: &Page<'_>,
    values: &dyn Fn(&str) -> Option<f64>,
) -> Vec<DimensionMark> {
    let drawing = &object.drawing;
    if object.dimensions.is_empty() {
        return vec![];
    }
    let layout = PageLayout::of(drawing, planes, page);
    let places = &layout.places;
    let size = {
        let extent = |k: usize| {
            let all = places.values().map(|p| p[k]);
            let (l, h) = all.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
            h - l
        };
        if places.is_empty() { return vec![] } else { extent(0).max(extent(1)).max(1e-12) }
    };
    let middle = |l: LineId| {
        let line = drawing.lines.get(&l)?;
        let ([a, b], [c, d]) = ((page.place)(line.p)?, (page.place)(line.q)?);
        Some([(a + c) / 2.0, (b + d) / 2.0])
    };
    let mut marks = Vec::new();
    let mut rows: Vec<UnplacedMark> = Vec::new();
    for (key, dimension) in &object.dimensions {
        let value = values(key);
        let reference = dimension.role == DimensionRole::Reference;
        let text = value.map_or_else(|| "?".to_owned(), plain);
        let text = format!("{} {text}", dimension.name);
        let mut mark = DimensionMark {
            name: dimension.name.clone(),
            text: if reference { format!("({text})") } else { text },
            value,
            reference,
            axis: None,
            at: [0.0; 2],
            line: None,
            witnesses: vec![],
        };
        let at = match dimension.measure {
            MeasuredQuantity::Along { axis, p, q } => {
                mark.axis = Some(axis);
                match beside(drawing, planes, page, &layout, axis, [p, q]) {
                    Some(row) => {
                        rows.push(UnplacedMark { mark: marks.len(), ..row });
                        Some([0.0; 2])
                    }
                    // An axis that this view looks along.
                    None => None,
                }
            }
            MeasuredQuantity::Datum { axis, point } => {
                mark.axis = Some(axis);
                (page.place)(point)
            }
            MeasuredQuantity::Length(l) => drawing.lines.get(&l).and_then(|line| {
                let (a, b) = ((page.place)(line.p)?, (page.place)(line.q)?);
                let d = [b[0] - a[0], b[1] - a[1]];
                let length = libm::hypot(d[0], d[1]);
                if length < 1e-9 * size {
                    return None;
                }
                let n = [-d[1] / length, d[0] / length];
                let put = |p: [f64; 2], by: f64| [p[0] + by * n[0], p[1] + by * n[1]];
                let by = APART * size;
                mark.line = Some([put(a, by), put(b, by)]);
                mark.witnesses =
                    [a, b].map(|p| [put(p, BEYOND * size), put(p, by + BEYOND * size)]).to_vec();
                Some(put([(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0], by))
            }),
            MeasuredQuantity::Slope(l) => middle(l),
            MeasuredQuantity::Angle(l, m) => common(drawing, page, l, m).or_else(|| middle(l)),
            MeasuredQuantity::Equal(l, _) => middle(l),
        };
        if let Some(at) = at {
            marks.push(DimensionMark { at, ..mark });
        }
    }
    place_rows(rows, page, size, &mut marks);
    marks
}

/// The common end of two lines.
fn common(drawing: &Drawing, page: &Page<'_>, l: LineId, m: LineId) -> Option<[f64; 2]> {
    let (a, b) = (drawing.lines.get(&l)?, drawing.lines.get(&m)?);
    let shared = [a.p, a.q].into_iter().find(|p| *p == b.p || *p == b.q)?;
    (page.place)(shared)
}

/// Coordinates of a point along two directions of the page; `None` if they are parallel.
fn split(at: [f64; 2], a: [f64; 2], w: [f64; 2]) -> Option<[f64; 2]> {
    let det = a[0] * w[1] - a[1] * w[0];
    let (m, n) = (libm::hypot(a[0], a[1]), libm::hypot(w[0], w[1]));
    (det.abs() > 0.05 * m * n && m * n > 0.0)
        .then(|| [(at[0] * w[1] - at[1] * w[0]) / det, (a[0] * at[1] - a[1] * at[0]) / det])
}

/// The side on which the dimension line is nearest to the two planes that it measures: from points that a line along
/// one other axis leads away from, beyond all that is drawn between them. Planes of which no two points are level on
/// the third axis, such as those of an eave and of a ridge, are measured from the points of the dimension itself.
/// `None` for an axis that the view looks along.
fn beside(
    drawing: &Drawing,
    planes: &Planes,
    page: &Page<'_>,
    layout: &PageLayout,
    axis: CoordinateAxis,
    ends: [PointId; 2],
) -> Option<UnplacedMark> {
    let a = (page.unit)(axis);
    let of_planes = ends.map(|p| planes.plane(axis, p));
    let [Some(first), Some(second)] = of_planes else { return None };
    let [Some(begin), Some(end)] = ends.map(|p| layout.places.get(&p).copied()) else {
        return None;
    };
    let of_plane = |plane| layout.members.get(&(axis.index(), plane)).map_or(&[][..], |m| m);
    let members = [first, second].map(of_plane);
    // Level pairs, and the dimension's own points.
    let mut best: [Option<(f64, UnplacedMark)>; 2] = [None, None];
    for across in CoordinateAxis::ALL.into_iter().filter(|w| *w != axis) {
        if drawing.section == Some(across) {
            continue;
        }
        let w = (page.unit)(across);
        let third = CoordinateAxis::ALL.into_iter().find(|t| *t != axis && *t != across);
        let third = third.filter(|t| drawing.section != Some(*t));
        let class = |k: usize| third.and_then(|t| layout.classes[k][t.index()]);
        let Some(frame) = &layout.frames[axis.index()][across.index()] else { continue };
        for side in [-1.0, 1.0] {
            // The outermost point of each plane, by its coordinate on the third axis.
            let mut outer: [BTreeMap<Option<usize>, [f64; 2]>; 2] = Default::default();
            for (outer, members) in outer.iter_mut().zip(members) {
                for &k in members {
                    let Some(at) = frame.points[k] else { continue };
                    let known = outer.entry(class(k)).or_insert(at);
                    if side * at[1] > side * known[1] {
                        *known = at;
                    }
                }
            }
            let [outer_first, outer_second] = &outer;
            let level =
                outer_first.iter().filter_map(|(k, &from)| Some((from, *outer_second.get(k)?)));
            let own = split(begin, a, w).zip(split(end, a, w));
            let pairs = level.map(|pair| (0, pair)).chain(own.map(|pair| (1, pair)));
            for (kind, (from, to)) in pairs {
                let reach = [from[0].min(to[0]), from[0].max(to[0])];
                let clear = outermost(frame, reach, side);
                let clear = clear.max(side * from[1]).max(side * to[1]);
                let cost = (clear - side * from[1]) + (clear - side * to[1]);
                let row = UnplacedMark { mark: 0, axis, across, side, ends: [from, to], clear };
                if best[kind].as_ref().is_none_or(|b| cost < b.0 - 1e-9 * cost.abs()) {
                    best[kind] = Some((cost, row));
                }
            }
        }
    }
    let [level, own] = best;
    level.or(own).map(|b| b.1)
}

/// Maximum extent of a drawing's lines to a side of an axis, between two positions along it.
fn outermost(frame: &PageFrame, reach: [f64; 2], side: f64) -> f64 {
    let mut far = f64::NEG_INFINITY;
    let slack = 1e-6 * (reach[1] - reach[0]);
    for &[p, q] in frame.lines.iter().take_while(|l| l[0][0] <= reach[1] - slack) {
        let (low, high) = (p[0].max(reach[0] + slack), q[0].min(reach[1] - slack));
        if low > high {
            continue;
        }
        let wide = q[0] - p[0];
        for x in [low, high] {
            let t = if wide > 0.0 { (x - p[0]) / wide } else { 0.0 };
            far = far.max(side * (p[1] + t * (q[1] - p[1])));
        }
        if wide <= 0.0 {
            far = far.max(side * p[1]).max(side * q[1]);
        }
    }
    far
}

/// Arranges dimension lines in rows beside the drawing, shorter ones nearer, without overlap.
fn place_rows(
    mut rows: Vec<UnplacedMark>,
    page: &Page<'_>,
    size: f64,
    marks: &mut [DimensionMark],
) {
    rows.sort_by(|x, y| {
        let long = |r: &UnplacedMark| (r.ends[1][0] - r.ends[0][0]).abs();
        long(x).total_cmp(&long(y)).then(x.mark.cmp(&y.mark))
    });
    // By direction: occupied intervals, as (from, to, position across).
    let mut taken: BTreeMap<(usize, usize, bool), Vec<[f64; 3]>> = BTreeMap::new();
    for row in rows {
        let (a, w) = ((page.unit)(row.axis), (page.unit)(row.across));
        let step = APART * size / libm::hypot(w[0], w[1]).max(1e-12);
        let [from, to] = row.ends;
        let (low, high) = (from[0].min(to[0]), from[0].max(to[0]));
        let key = (row.axis.index(), row.across.index(), row.side > 0.0);
        let own = taken.entry(key).or_default();
        let mut at = row.clear + step;
        // Neighbours in a chain may touch.
        let slack = 1e-6 * (high - low);
        loop {
            let hit = own.iter().find(|t| {
                t[0] < high - slack && t[1] > low + slack && (t[2] - at).abs() < 0.9 * step
            });
            match hit {
                Some(t) => at = t[2] + step,
                None => break,
            }
        }
        own.push([low, high, at]);
        let place = |[x, y]: [f64; 2]| [x * a[0] + y * w[0], x * a[1] + y * w[1]];
        let beyond = BEYOND / APART * step;
        let mark = &mut marks[row.mark];
        let ends = [from, to].map(|e| place([e[0], row.side * at]));
        mark.line = Some(ends);
        mark.witnesses = [from, to]
            .map(|e| [e[1] + row.side * beyond, row.side * (at + beyond)].map(|y| place([e[0], y])))
            .to_vec();
        mark.at = [(ends[0][0] + ends[1][0]) / 2.0, (ends[0][1] + ends[1][1]) / 2.0];
    }
}
