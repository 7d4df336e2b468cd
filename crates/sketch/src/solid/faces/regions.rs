//! Candidate faces: the regions into which edges divide the planes they span.

use super::wire::Wireframe;
use moldloft_num::{Real, Vec3};

/// A plane that two edges with a common end span, with its own coordinates.
#[derive(Clone, Debug)]
pub(super) struct SpannedPlane {
    pub normal: Vec3,
    pub offset: f64,
    u: Vec3,
    v: Vec3,
}

impl SpannedPlane {
    fn spanned(point: Vec3, a: Vec3, b: Vec3) -> Option<SpannedPlane> {
        let mut normal = a.normalized()?.cross(b.normalized()?);
        if normal.norm() < 1e-6 {
            return None;
        }
        normal = normal.normalized()?;
        // The first coordinate that is not nothing is positive: one normal for one plane.
        let first = normal.to_array().into_iter().find(|x| x.abs() > 1e-9)?;
        if first < 0.0 {
            normal = -normal;
        }
        let u = normal.perpendicular();
        Some(SpannedPlane { normal, offset: normal.dot(point), u, v: normal.cross(u) })
    }

    pub fn contains(&self, p: Vec3, tolerance: f64) -> bool {
        (self.normal.dot(p) - self.offset).abs() <= tolerance
    }

    pub fn flat(&self, p: Vec3) -> [f64; 2] {
        [self.u.dot(p), self.v.dot(p)]
    }
}

/// The sheets of a wireframe's drawn edges.
pub(super) fn sheets(wire: &Wireframe) -> Vec<SpannedPlane> {
    let mut at: Vec<Vec<usize>> = vec![Vec::new(); wire.vertices.len()];
    for (k, e) in wire.edges.iter().enumerate() {
        e.ends.iter().for_each(|&v| at[v].push(k));
    }
    let mut sheets: Vec<SpannedPlane> = Vec::new();
    let mut of_edge: Vec<Vec<usize>> = vec![Vec::new(); wire.edges.len()];
    for (v, edges) in at.iter().enumerate() {
        let p = wire.vertices[v];
        for (k, &a) in edges.iter().enumerate() {
            for &b in &edges[k + 1..] {
                if of_edge[a].iter().any(|s| of_edge[b].contains(s)) {
                    continue;
                }
                let to = |e: usize| {
                    let [x, y] = wire.edges[e].ends;
                    wire.vertices[if x == v { y } else { x }] - p
                };
                let Some(sheet) = SpannedPlane::spanned(p, to(a), to(b)) else { continue };
                for (e, edge) in wire.edges.iter().enumerate() {
                    let on = |v: usize| sheet.contains(wire.vertices[v], wire.tolerance);
                    if edge.ends.iter().all(|&v| on(v)) {
                        of_edge[e].push(sheets.len());
                    }
                }
                sheets.push(sheet);
            }
        }
    }
    sheets
}

/// An edge, and whether it is traversed from its first end to its second.
pub(super) type Half = (usize, bool);

/// A candidate face: a region of a sheet, to the left of its loops seen against the normal.
#[derive(Clone, Debug)]
pub(super) struct SheetRegion {
    pub sheet: usize,
    /// The outer loop, then holes. Slits are traversed along both sides.
    pub loops: Vec<Vec<Half>>,
}

impl Wireframe {
    pub fn tail(&self, (edge, forward): Half) -> usize {
        self.edges[edge].ends[usize::from(!forward)]
    }

    pub fn head(&self, (edge, forward): Half) -> usize {
        self.edges[edge].ends[usize::from(forward)]
    }
}

/// Twice the area inside a loop, positive when counter-clockwise.
fn area(wire: &Wireframe, sheet: &SpannedPlane, cycle: &[Half]) -> f64 {
    let Some(&first) = cycle.first() else { return 0.0 };
    let o = sheet.flat(wire.vertices[wire.tail(first)]);
    cycle
        .iter()
        .map(|&h| {
            let p = sheet.flat(wire.vertices[wire.tail(h)]);
            let q = sheet.flat(wire.vertices[wire.head(h)]);
            (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
        })
        .sum()
}

/// True if a point is inside a loop (even-odd), for points that are not on it.
pub(super) fn encloses(
    wire: &Wireframe,
    sheet: &SpannedPlane,
    cycle: &[Half],
    [x, y]: [f64; 2],
) -> bool {
    let mut inside = false;
    for &h in cycle {
        let [ax, ay] = sheet.flat(wire.vertices[wire.tail(h)]);
        let [bx, by] = sheet.flat(wire.vertices[wire.head(h)]);
        if (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax) {
            inside = !inside;
        }
    }
    inside
}

/// The loops of half-edges, each turning as far right as it can, with the region to its left.
pub(super) fn walk(wire: &Wireframe, sheet: &SpannedPlane, halves: &[Half]) -> Vec<Vec<Half>> {
    let mut leaving: std::collections::BTreeMap<usize, Vec<(f64, usize)>> = Default::default();
    for (k, &h) in halves.iter().enumerate() {
        let a = sheet.flat(wire.vertices[wire.tail(h)]);
        let b = sheet.flat(wire.vertices[wire.head(h)]);
        let angle = Real::atan2(b[1] - a[1], b[0] - a[0]);
        leaving.entry(wire.tail(h)).or_default().push((angle, k));
    }
    let next = |k: usize| -> Option<usize> {
        let h = halves[k];
        let back = {
            let a = sheet.flat(wire.vertices[wire.head(h)]);
            let b = sheet.flat(wire.vertices[wire.tail(h)]);
            Real::atan2(b[1] - a[1], b[0] - a[0])
        };
        // The first one clockwise from the incoming direction; its reverse comes last.
        let turn = |angle: f64, other: usize| {
            if halves[other].0 == h.0 {
                return f64::INFINITY;
            }
            let t = (back - angle).rem_euclid(2.0 * std::f64::consts::PI);
            if t <= 1e-12 { 2.0 * std::f64::consts::PI } else { t }
        };
        let out = leaving.get(&wire.head(h))?;
        out.iter().min_by(|a, b| turn(a.0, a.1).total_cmp(&turn(b.0, b.1))).map(|o| o.1)
    };
    let mut used = vec![false; halves.len()];
    let mut loops = Vec::new();
    for start in 0..halves.len() {
        let mut cycle = Vec::new();
        let mut at = start;
        while !used[at] {
            used[at] = true;
            cycle.push(halves[at]);
            match next(at) {
                Some(k) => at = k,
                None => break,
            }
        }
        if !cycle.is_empty() {
            loops.push(cycle);
        }
    }
    loops
}

/// Loops sorted into outer ones with their holes. Holes belong to the smallest loop around them.
pub(super) fn nested(
    wire: &Wireframe,
    sheet: &SpannedPlane,
    loops: Vec<Vec<Half>>,
) -> Vec<Vec<Vec<Half>>> {
    let nothing = wire.tolerance * wire.tolerance;
    let (mut outer, mut inner) = (Vec::new(), Vec::new());
    for cycle in loops {
        let a = area(wire, sheet, &cycle);
        if a > nothing { outer.push((a, vec![cycle])) } else { inner.push(cycle) }
    }
    for cycle in inner {
        let own: std::collections::BTreeSet<usize> =
            cycle.iter().flat_map(|&h| [wire.tail(h), wire.head(h)]).collect();
        let point = sheet.flat(wire.vertices[wire.tail(cycle[0])]);
        let around = outer.iter_mut().filter(|(_, face)| {
            // Its own component's loops touch it and are not around it.
            let touches = face[0].iter().any(|&h| own.contains(&wire.tail(h)));
            !touches && encloses(wire, sheet, &face[0], point)
        });
        if let Some((_, face)) = around.min_by(|a, b| a.0.total_cmp(&b.0)) {
            face.push(cycle);
        }
    }
    outer.into_iter().map(|(_, face)| face).collect()
}

/// All candidate faces of a sheet.
pub(super) fn regions(wire: &Wireframe, index: usize, sheet: &SpannedPlane) -> Vec<SheetRegion> {
    let on = |v: usize| sheet.contains(wire.vertices[v], wire.tolerance);
    let halves: Vec<Half> = (0..wire.edges.len())
        .filter(|&e| wire.edges[e].ends.iter().all(|&v| on(v)))
        .flat_map(|e| [(e, true), (e, false)])
        .collect();
    let loops = walk(wire, sheet, &halves);
    nested(wire, sheet, loops)
        .into_iter()
        .map(|loops| SheetRegion { sheet: index, loops })
        .collect()
}

/// Removes, repeatedly, regions with an edge that nothing else shares.
pub(super) fn drop_unshared(wire: &Wireframe, regions: &mut Vec<SheetRegion>) {
    loop {
        let mut wings = vec![0; wire.edges.len()];
        for region in regions.iter() {
            region.loops.iter().flatten().for_each(|&(e, _)| wings[e] += 1);
        }
        let before = regions.len();
        regions.retain(|r| r.loops.iter().flatten().all(|&(e, _)| wings[e] >= 2));
        if regions.len() == before {
            break;
        }
    }
}

/// Segments along which regions cross inside both: two such regions cannot both be faces whole.
pub(super) fn cuts(
    wire: &Wireframe,
    sheets: &[SpannedPlane],
    regions: &[SheetRegion],
) -> Vec<[Vec3; 2]> {
    let mut of_sheet: Vec<Vec<&SheetRegion>> = vec![Vec::new(); sheets.len()];
    regions.iter().for_each(|r| of_sheet[r.sheet].push(r));
    let boxes: Vec<[Vec3; 2]> = of_sheet.iter().map(|own| bounds(wire, own)).collect();
    let mut found = Vec::new();
    for a in 0..sheets.len() {
        for b in a + 1..sheets.len() {
            let apart = |k: usize| {
                boxes[a][0][k] > boxes[b][1][k] + wire.tolerance
                    || boxes[b][0][k] > boxes[a][1][k] + wire.tolerance
            };
            if of_sheet[a].is_empty() || of_sheet[b].is_empty() || (0..3).any(apart) {
                continue;
            }
            let pair = [(&sheets[a], &of_sheet[a]), (&sheets[b], &of_sheet[b])];
            found.extend(common_segments(wire, pair));
        }
    }
    found
}

fn bounds(wire: &Wireframe, regions: &[&SheetRegion]) -> [Vec3; 2] {
    let mut low: Vec3 = Vec3::of(f64::INFINITY, f64::INFINITY, f64::INFINITY);
    let mut high = -low;
    for &h in regions.iter().flat_map(|r| &r.loops[0]) {
        let p = wire.vertices[wire.tail(h)];
        low = Vec3::new(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z));
        high = Vec3::new(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z));
    }
    [low, high]
}

/// The parts of the common line of two sheets inside regions of both and on no edge.
fn common_segments(
    wire: &Wireframe,
    pair: [(&SpannedPlane, &Vec<&SheetRegion>); 2],
) -> Vec<[Vec3; 2]> {
    let [(s, _), (t, _)] = pair;
    let Some(direction) = s.normal.cross(t.normal).normalized() else { return vec![] };
    let cos = s.normal.dot(t.normal);
    let det = 1.0 - cos * cos;
    if det < 1e-12 {
        return vec![];
    }
    let origin = s.normal * ((s.offset - t.offset * cos) / det)
        + t.normal * ((t.offset - s.offset * cos) / det);
    let tol = wire.tolerance;
    let mut stops: Vec<f64> = Vec::new();
    let mut taken: Vec<[f64; 2]> = Vec::new();
    for (_, regions) in pair {
        let mut low = f64::INFINITY;
        let mut high = f64::NEG_INFINITY;
        for &(e, _) in regions.iter().flat_map(|r| r.loops.iter().flatten()) {
            let [p, q] = wire.edges[e].ends.map(|v| wire.vertices[v] - origin);
            let off = |p: Vec3| p - direction * direction.dot(p);
            let (a, b) = (off(p), off(q));
            let (x, y) = (direction.dot(p), direction.dot(q));
            if a.norm() <= tol && b.norm() <= tol {
                taken.push([x.min(y), x.max(y)]);
                stops.extend([x, y]);
                (low, high) = (low.min(x).min(y), high.max(x).max(y));
                continue;
            }
            // The edge is in the sheet with the line, so `a` and `b` are parallel.
            let width = b - a;
            let part = -(a.dot(width)) / width.norm_sq();
            let margin = tol / width.norm();
            if part >= -margin && part <= 1.0 + margin {
                let x = x + (y - x) * part;
                stops.push(x);
                (low, high) = (low.min(x), high.max(x));
            }
        }
        if low > high {
            return vec![];
        }
    }
    stops.sort_by(f64::total_cmp);
    let mut segments: Vec<[Vec3; 2]> = Vec::new();
    let mut open: Option<f64> = None;
    for w in stops.windows(2) {
        let middle = 0.5 * (w[0] + w[1]);
        let at = origin + direction * middle;
        let inside = w[1] - w[0] > tol
            && !taken.iter().any(|i| i[0] - tol <= middle && middle <= i[1] + tol)
            && pair.iter().all(|(sheet, regions)| {
                let p = sheet.flat(at);
                let within = |r: &&SheetRegion| {
                    let mut loops = r.loops.iter().map(|l| encloses(wire, sheet, l, p));
                    loops.next() == Some(true) && loops.all(|hole| !hole)
                };
                regions.iter().any(within)
            });
        if inside {
            let start = *open.get_or_insert(w[0]);
            let piece = [origin + direction * start, origin + direction * w[1]];
            match segments.last_mut() {
                Some(last) if start < w[0] => *last = piece,
                _ => segments.push(piece),
            }
        } else if w[1] - w[0] > tol {
            open = None;
        }
    }
    segments
}
