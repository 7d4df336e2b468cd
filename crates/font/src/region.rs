//! Regions that closed curves wind around, as loops without crossings.
//!
//! `curves -> divided where they meet -> winding numbers on both sides of each part -> the parts beside the region -> loops`

use crate::bezier::{Bezier, Point, cross, minus, norm};

/// Relative distance below which points are one.
const SAME: f64 = 1e-9;

/// Maximum number of pairs of parts of curves that are compared for one pair of curves.
const MOST_PARTS: usize = 4_000;

/// A direction across which no line or curve of a font is level.
const ALONG: Point = [0.577_215_664_901_532_9, 0.816_592_770_374_913_6];

/// A closed curve with the region to its left: counter-clockwise round it, clockwise round a hole.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlineLoop {
    /// Its pieces, each beginning where the one before ends.
    pub pieces: Vec<Bezier>,
    /// By piece, the number of the character that it belongs to, from 0.
    pub characters: Vec<usize>,
    /// For a hole, the index of the loop round it.
    pub around: Option<usize>,
}

/// Curves that bound no region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutlineFault {
    /// The number of the character, from 0.
    pub character: usize,
    /// A point of it, in heights of a capital letter.
    pub place: Point,
}

/// A curve of a character.
#[derive(Clone, Copy, Debug)]
struct GlyphSide {
    curve: Bezier,
    character: usize,
}

/// A part of a curve on which the height along [`ALONG`] is monotone.
struct Climb {
    curve: Bezier,
    side: usize,
    low: f64,
    high: f64,
    /// +1 if it goes up.
    sense: i32,
}

fn height(p: Point) -> f64 {
    p[0] * ALONG[0] + p[1] * ALONG[1]
}

/// The coordinate across, growing to the right of [`ALONG`].
fn across(p: Point) -> f64 {
    p[0] * ALONG[1] - p[1] * ALONG[0]
}

/// The loops round the region of closed curves; each curve with the number of its character.
///
/// # Errors
/// Curves that run along one another.
pub(crate) fn region(curves: &[Vec<(Bezier, usize)>]) -> Result<Vec<OutlineLoop>, OutlineFault> {
    let all = curves.iter().flatten().flat_map(|c| c.0.bounds());
    let size = all.flatten().map(f64::abs).fold(0.0, f64::max);
    let mut sides = Vec::new();
    for curve in curves {
        let kept = curve
            .iter()
            .filter_map(|(c, k)| Some(GlyphSide { curve: c.simplified(size)?, character: *k }));
        sides.extend(kept);
    }
    let sides = divided(sides, size)?;
    let climbs = climbs(&sides);
    let twins = twins(&sides, size);
    let mut kept: Vec<GlyphSide> = Vec::new();
    for (k, side) in sides.iter().enumerate() {
        // Of parts that are one curve, the first stands for all.
        if twins[k].iter().any(|(j, _)| *j < k) {
            continue;
        }
        let [left, right] = windings(&climbs, k, &twins[k]);
        match (left != 0, right != 0) {
            (true, false) => kept.push(*side),
            (false, true) => kept.push(GlyphSide { curve: side.curve.reversed(), ..*side }),
            _ => {}
        }
    }
    let mut loops = chained(kept, size)?;
    // Holes after what they are in.
    loops.sort_by_key(|l| l.area() <= 0.0);
    nest(&mut loops);
    Ok(loops)
}

/// The parts of curves between the points where they meet others.
fn divided(sides: Vec<GlyphSide>, size: f64) -> Result<Vec<GlyphSide>, OutlineFault> {
    let near = SAME * size;
    let mut cuts: Vec<Vec<f64>> = vec![Vec::new(); sides.len()];
    let boxes: Vec<[Point; 2]> = sides.iter().map(|s| s.curve.bounds()).collect();
    let mut order: Vec<usize> = (0..sides.len()).collect();
    order.sort_by(|a, b| boxes[*a][0][0].total_cmp(&boxes[*b][0][0]));
    for (n, &i) in order.iter().enumerate() {
        let ahead = order[n + 1..].iter();
        for &j in ahead.take_while(|&&j| boxes[j][0][0] <= boxes[i][1][0] + near) {
            if boxes[j][0][1] > boxes[i][1][1] + near || boxes[i][0][1] > boxes[j][1][1] + near {
                continue;
            }
            let found = meetings([&sides[i].curve, &sides[j].curve], near).ok_or_else(|| {
                OutlineFault { character: sides[i].character, place: sides[i].curve.at(0.5) }
            })?;
            for [s, t] in found {
                cuts[i].push(s);
                cuts[j].push(t);
            }
        }
    }
    let mut out = Vec::new();
    for (side, mut own) in sides.into_iter().zip(cuts) {
        own.retain(|t| *t > 0.0 && *t < 1.0);
        own.sort_by(f64::total_cmp);
        let mut from = 0.0;
        let mut start = side.curve.ends()[0];
        let end = side.curve.ends()[1];
        for t in own.into_iter().chain([1.0]) {
            let at = if t < 1.0 { side.curve.at(t) } else { end };
            let last = t < 1.0 && norm(minus(at, end)) <= near;
            if norm(minus(at, start)) <= near && t < 1.0 || last {
                continue;
            }
            let whole = from == 0.0 && t == 1.0;
            let curve = if whole { side.curve } else { side.curve.part(from, t) };
            out.push(GlyphSide { curve: curve.between([start, at]), ..side });
            (from, start) = (t, at);
        }
    }
    Ok(out)
}

/// The parameters of the points where two curves meet, except common ends; `None` if they run along each other.
fn meetings(curves: [&Bezier; 2], near: f64) -> Option<Vec<[f64; 2]>> {
    if curves[0].sense_of(curves[1], near).is_some() {
        return Some(vec![]);
    }
    if let [Bezier::Line(p), Bezier::Line(q)] = curves
        && let Some(found) = along(p, q, near)
    {
        return Some(found);
    }
    let mut found: Vec<[f64; 2]> = Vec::new();
    let mut pending = vec![[(0.0, 1.0), (0.0, 1.0)]];
    let mut looked = 0;
    while let Some([a, b]) = pending.pop() {
        looked += 1;
        if looked > MOST_PARTS {
            return None;
        }
        let parts = [curves[0].part(a.0, a.1), curves[1].part(b.0, b.1)];
        let [p, q] = [parts[0].bounds(), parts[1].bounds()];
        if (0..2).any(|k| p[0][k] > q[1][k] + near || q[0][k] > p[1][k] + near) {
            continue;
        }
        let long = [norm(minus(p[1], p[0])), norm(minus(q[1], q[0]))];
        // Both are points, or nearly straight and met once.
        if long[0].max(long[1]) <= near {
            found.push([0.5 * (a.0 + a.1), 0.5 * (b.0 + b.1)]);
            continue;
        }
        let flat = |k: usize| parts[k].bend() <= 1e-3 * long[k];
        if flat(0) && flat(1) {
            match converged(curves, [0.5 * (a.0 + a.1), 0.5 * (b.0 + b.1)], near) {
                Some([s, t])
                    if (a.0..=a.1).contains(&s)
                        && (b.0..=b.1).contains(&t)
                        && steep(curves, [s, t]) =>
                {
                    found.push([s, t]);
                    continue;
                }
                // Straight parts whose lines meet elsewhere.
                _ if apart(&parts, near) => continue,
                _ => {}
            }
        }
        let half = |(lo, hi): (f64, f64)| [(lo, 0.5 * (lo + hi)), (0.5 * (lo + hi), hi)];
        match long[0] >= long[1] {
            true => pending.extend(half(a).map(|a| [a, b])),
            false => pending.extend(half(b).map(|b| [a, b])),
        }
    }
    let mut out: Vec<[f64; 2]> = Vec::new();
    for [s, t] in found {
        let at = curves[0].at(s);
        let known = |[u, _]: &[f64; 2]| norm(minus(curves[0].at(*u), at)) <= 4.0 * near;
        let at_end = |k: usize| curves[k].ends().iter().any(|e| norm(minus(*e, at)) <= 4.0 * near);
        if !(out.iter().any(known) || at_end(0) && at_end(1)) {
            out.push([s, t]);
        }
    }
    Some(out)
}

/// The ends of two lines on one another, if the lines are parts of one.
fn along(p: &[Point; 2], q: &[Point; 2], near: f64) -> Option<Vec<[f64; 2]>> {
    let (u, v) = (minus(p[1], p[0]), minus(q[1], q[0]));
    let off =
        |r: Point, from: Point, along: Point| cross(along, minus(r, from)).abs() / norm(along);
    let one =
        q.iter().all(|r| off(*r, p[0], u) <= near) || p.iter().all(|r| off(*r, q[0], v) <= near);
    if !one {
        return None;
    }
    let place = |r: Point, from: Point, along: Point| {
        let d = minus(r, from);
        (d[0] * along[0] + d[1] * along[1]) / (along[0] * along[0] + along[1] * along[1])
    };
    let mut out = Vec::new();
    out.extend(q.iter().enumerate().map(|(k, r)| [place(*r, p[0], u), k as f64]));
    out.extend(p.iter().enumerate().map(|(k, r)| [k as f64, place(*r, q[0], v)]));
    out.retain(|cut| cut.iter().all(|t| (0.0..=1.0).contains(t)));
    Some(out)
}

/// The common point near two parameters, by Newton's method.
fn converged(curves: [&Bezier; 2], start: [f64; 2], near: f64) -> Option<[f64; 2]> {
    let [mut s, mut t] = start;
    for _ in 0..20 {
        let d = minus(curves[1].at(t), curves[0].at(s));
        if norm(d) <= 1e-3 * near {
            return Some([s.clamp(0.0, 1.0), t.clamp(0.0, 1.0)]);
        }
        let (u, v) = (curves[0].velocity(s), curves[1].velocity(t));
        let det = cross(u, v);
        if det == 0.0 {
            return None;
        }
        s += cross(d, v) / det;
        t += cross(d, u) / det;
        if !(-0.1..=1.1).contains(&s) || !(-0.1..=1.1).contains(&t) {
            return None;
        }
    }
    None
}

/// True if curves cross at an angle at which nearly straight parts meet once.
fn steep(curves: [&Bezier; 2], [s, t]: [f64; 2]) -> bool {
    let (u, v) = (curves[0].velocity(s), curves[1].velocity(t));
    cross(u, v).abs() > 0.05 * norm(u) * norm(v)
}

/// True if a line separates two curves by their control points.
fn apart(parts: &[Bezier; 2], near: f64) -> bool {
    [[0, 1], [1, 0]].into_iter().any(|[i, j]| {
        let [p, q] = parts[i].ends();
        let along = minus(q, p);
        let long = norm(along);
        let side = |r: &Point| cross(along, minus(*r, p)) / long;
        let range = |k: usize| {
            let all = parts[k].points().iter().map(side);
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
        };
        let (own, other) = (range(i), range(j));
        long > 0.0 && (other.0 > own.1 + near || own.0 > other.1 + near)
    })
}

fn climbs(sides: &[GlyphSide]) -> Vec<Climb> {
    let mut out = Vec::new();
    for (k, side) in sides.iter().enumerate() {
        let mut from = 0.0;
        for t in side.curve.extremes(ALONG).into_iter().chain([1.0]) {
            if t <= from {
                continue;
            }
            let curve = match from == 0.0 && t == 1.0 {
                true => side.curve,
                false => side.curve.part(from, t),
            };
            from = t;
            let [p, q] = curve.ends().map(height);
            let sense = if q > p { 1 } else { -1 };
            out.push(Climb { curve, side: k, low: p.min(q), high: p.max(q), sense });
        }
    }
    out
}

/// The sum of the senses of climbs to the right of a point at its height.
fn right_of<'a>(climbs: impl Iterator<Item = &'a Climb>, p: Point) -> i32 {
    let (h, x) = (height(p), across(p));
    let mut sum = 0;
    for climb in climbs {
        if h < climb.low || h >= climb.high {
            continue;
        }
        let all = climb.curve.points().iter().map(|p| across(*p));
        let (low, high) =
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        if high < x {
            continue;
        }
        if low > x {
            sum += climb.sense;
            continue;
        }
        let (mut from, mut to) = (0.0, 1.0);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (from + to);
            let below = height(climb.curve.at(middle)) < h;
            if below == (climb.sense > 0) { from = middle } else { to = middle }
        }
        if across(climb.curve.at(0.5 * (from + to))) > x {
            sum += climb.sense;
        }
    }
    sum
}

/// By part, the other parts that are the same curve: +1 in the same sense, -1 in the opposite one.
fn twins(sides: &[GlyphSide], size: f64) -> Vec<Vec<(usize, i32)>> {
    let near = 4.0 * SAME * size;
    let mut order: Vec<usize> = (0..sides.len()).collect();
    let left = |k: usize| sides[k].curve.bounds()[0][0];
    order.sort_by(|a, b| left(*a).total_cmp(&left(*b)));
    let mut out = vec![Vec::new(); sides.len()];
    for (n, &i) in order.iter().enumerate() {
        for &j in order[n + 1..].iter().take_while(|&&j| left(j) <= left(i) + near) {
            if let Some(sense) = sides[i].curve.sense_of(&sides[j].curve, near) {
                out[i].push((j, sense));
                out[j].push((i, sense));
            }
        }
    }
    out
}

/// The winding numbers of all curves to the left and to the right of a part of one.
fn windings(climbs: &[Climb], side: usize, twins: &[(usize, i32)]) -> [i32; 2] {
    let own = climbs.iter().filter(|c| c.side == side);
    let Some(best) = own.max_by(|a, b| (a.high - a.low).total_cmp(&(b.high - b.low))) else {
        return [0; 2];
    };
    let at = best.curve.at(0.5);
    // The part itself and its twins pass the point on one of their climbs.
    let through = |c: &Climb| {
        let ends = c.curve.ends();
        let [p, q] = best.curve.ends();
        let off = |p: Point, q: Point| norm(minus(ends[0], p)) + norm(minus(ends[1], q));
        off(p, q).min(off(q, p)) <= 1e-3 * (best.high - best.low)
            && (c.side == side && std::ptr::eq(c, best) || twins.iter().any(|t| t.0 == c.side))
    };
    let others = climbs.iter().filter(|c| !through(c));
    let beyond = right_of(others, at);
    let net = best.sense * (1 + twins.iter().map(|t| t.1).sum::<i32>());
    let inner = beyond + net;
    // Right of the direction in which heights grow.
    if best.sense > 0 { [inner, beyond] } else { [beyond, inner] }
}

/// Curves as closed loops, each turning as far left as it can where several begin.
fn chained(sides: Vec<GlyphSide>, size: f64) -> Result<Vec<OutlineLoop>, OutlineFault> {
    let near = 10.0 * SAME * size;
    let mut starts: Vec<usize> = (0..sides.len()).collect();
    let first = |k: usize| sides[k].curve.ends()[0];
    starts.sort_by(|a, b| first(*a)[0].total_cmp(&first(*b)[0]));
    let mut used = vec![false; sides.len()];
    let mut loops = Vec::new();
    for begin in 0..sides.len() {
        if used[begin] {
            continue;
        }
        let mut chain = vec![begin];
        used[begin] = true;
        let home = first(begin);
        loop {
            let here = sides[chain[chain.len() - 1]];
            let end = here.curve.ends()[1];
            if norm(minus(end, home)) <= near {
                break;
            }
            let low = starts.partition_point(|&k| first(k)[0] < end[0] - near);
            let open = starts[low..].iter().copied();
            let open = open.take_while(|&k| first(k)[0] <= end[0] + near);
            let open = open.filter(|&k| !used[k] && norm(minus(first(k), end)) <= near);
            let back = here.curve.velocity(1.0);
            let turn = |k: usize| {
                let on = sides[k].curve.velocity(0.0);
                libm::atan2(cross(back, on), back[0] * on[0] + back[1] * on[1])
            };
            let Some(next) = open.max_by(|a, b| turn(*a).total_cmp(&turn(*b))) else {
                return Err(OutlineFault { character: here.character, place: end });
            };
            used[next] = true;
            chain.push(next);
        }
        let n = chain.len();
        if let [only] = chain[..] {
            // A loop has two pieces at least.
            let halves = sides[only].curve.split(0.5).to_vec();
            let characters = vec![sides[only].character; 2];
            loops.push(OutlineLoop { pieces: halves, characters, around: None });
            continue;
        }
        let ends = |k: usize| [first(chain[k]), first(chain[(k + 1) % n])];
        let pieces = (0..n).map(|k| sides[chain[k]].curve.between(ends(k))).collect();
        let characters = chain.iter().map(|&k| sides[k].character).collect();
        loops.push(OutlineLoop { pieces, characters, around: None });
    }
    Ok(loops)
}

impl OutlineLoop {
    /// The area inside, negative if the loop is clockwise.
    pub fn area(&self) -> f64 {
        self.pieces.iter().map(Bezier::area).sum()
    }
}

/// Finds the loop round each hole: the smallest one that winds around it.
fn nest(loops: &mut [OutlineLoop]) {
    let areas: Vec<f64> = loops.iter().map(OutlineLoop::area).collect();
    let sides = |l: &OutlineLoop| -> Vec<GlyphSide> {
        l.pieces.iter().map(|c| GlyphSide { curve: *c, character: 0 }).collect()
    };
    let climbs: Vec<Vec<Climb>> = loops.iter().map(|l| climbs(&sides(l))).collect();
    for k in 0..loops.len() {
        if areas[k] > 0.0 {
            continue;
        }
        let at = loops[k].pieces[0].at(0.5);
        let round = |j: &usize| areas[*j] > 0.0 && right_of(climbs[*j].iter(), at) != 0;
        let around = (0..loops.len()).filter(round);
        loops[k].around = around.min_by(|a, b| areas[*a].total_cmp(&areas[*b]));
    }
}
