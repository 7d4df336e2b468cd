//! Where curves of a page meet, and curves divided until their corners are apart.

use crate::format::page_curve::{PageCurve, cross, dot, size, way};

type Place = [f64; 2];

/// Most pairs of parts examined for two curves.
const MOST_PARTS: usize = 4000;

/// Most halvings that separate two corners, and most curves that they may become.
const MOST_HALVINGS: usize = 9;
const MOST_CURVES: usize = 20_000;

/// A meeting of two curves: their parameters, and the place.
struct CurveMeet {
    at: [f64; 2],
    place: Place,
}

/// A curve of a drawing, and the shape that it is a part of.
#[derive(Clone)]
pub(super) struct OwnedCurve {
    pub curve: PageCurve,
    pub owner: usize,
    /// Halvings so far.
    pub halved: usize,
}

/// Divides curves and lines where they meet, then curves whose corners others reach into. Lines are divided by lines
/// already. Returns the places where corners still touch.
pub(super) fn separated(curves: &mut Vec<OwnedCurve>, tolerance: f64) -> Vec<Place> {
    drop_copies(curves, tolerance);
    let ranges: Vec<[Place; 2]> = curves.iter().map(|c| c.curve.range()).collect();
    let mut cuts: Vec<Vec<(f64, Place)>> = vec![Vec::new(); curves.len()];
    for i in 0..curves.len() {
        for j in 0..i {
            let (a, b) = (&curves[i].curve, &curves[j].curve);
            let lines = matches!((a, b), (PageCurve::Line(_), PageCurve::Line(_)));
            if lines || apart(ranges[i], ranges[j], tolerance) {
                continue;
            }
            for meet in meets(a, b, tolerance) {
                for (k, s) in [(i, meet.at[0]), (j, meet.at[1])] {
                    if s > 0.0 && s < 1.0 {
                        cuts[k].push((s, meet.place));
                    }
                }
            }
        }
    }
    let parts = |(owned, mut own): (OwnedCurve, Vec<(f64, Place)>)| {
        own.sort_by(|a, b| a.0.total_cmp(&b.0));
        own.dedup_by(|a, b| size(way(a.1, b.1)) <= 2.0 * tolerance);
        let (mut out, mut rest, mut from) = (Vec::new(), owned.curve.clone(), 0.0);
        for (s, place) in own {
            // The parameter of a part of a conic is not that of the whole.
            let part = match rest {
                PageCurve::Conic(..) => nearest(&rest, place),
                _ => (s - from) / (1.0 - from),
            };
            let [mut one, mut other] = rest.divided(part);
            one.set_end(1, place);
            other.set_end(0, place);
            out.push(OwnedCurve { curve: one, ..owned });
            (rest, from) = (other, s);
        }
        out.push(OwnedCurve { curve: rest, ..owned });
        out
    };
    *curves = std::mem::take(curves).into_iter().zip(cuts).flat_map(parts).collect();
    in_corners(curves);
    drop_copies(curves, 16.0 * tolerance);
    halved_apart(curves, tolerance)
}

/// Leaves one of curves that coincide.
fn drop_copies(curves: &mut Vec<OwnedCurve>, tolerance: f64) {
    let near = |p: &Place, q: &Place| size(way(*p, *q)) <= tolerance;
    let same = |a: &PageCurve, b: &PageCurve| {
        let (p, q) = (a.points(), b.points());
        let alike = match (a, b) {
            (PageCurve::Conic(_, u), PageCurve::Conic(_, v)) => (u - v).abs() <= 1e-6,
            (PageCurve::Line(_), _) | (_, PageCurve::Line(_)) => false,
            _ => p.len() == q.len(),
        };
        let forward = || p.iter().zip(q).all(|(p, q)| near(p, q));
        let back = || p.iter().zip(q.iter().rev()).all(|(p, q)| near(p, q));
        alike && (forward() || back())
    };
    let copy = |k: usize| {
        let own = &curves[k].curve;
        !matches!(own, PageCurve::Line(_)) && curves[..k].iter().any(|c| same(&c.curve, own))
    };
    let mut keep: Vec<bool> = (0..curves.len()).map(|k| !copy(k)).collect();
    keep.reverse();
    curves.retain(|_| keep.pop().unwrap_or(true));
}

fn in_corners(curves: &mut Vec<OwnedCurve>) {
    let pieces = |owned: OwnedCurve| {
        let mut out = Vec::new();
        owned.curve.in_corners(&mut out);
        out.into_iter().map(move |curve| OwnedCurve { curve, ..owned })
    };
    *curves = std::mem::take(curves).into_iter().flat_map(pieces).collect();
}

/// Halves curves until their corners are apart.
fn halved_apart(curves: &mut Vec<OwnedCurve>, tolerance: f64) -> Vec<Place> {
    let mut touching = Vec::new();
    // Those that are new; pairs of others are apart.
    let mut fresh = vec![true; curves.len()];
    loop {
        touching.clear();
        let hulls: Vec<Vec<Place>> = curves.iter().map(|c| hull(&c.curve)).collect();
        let ranges: Vec<[Place; 2]> = hulls.iter().map(|h| range(h)).collect();
        let mut halve = vec![false; curves.len()];
        for i in 0..curves.len() {
            for j in 0..i {
                let lines = hulls[i].len() == 2 && hulls[j].len() == 2;
                if lines || !(fresh[i] || fresh[j]) || apart(ranges[i], ranges[j], tolerance) {
                    continue;
                }
                let Some(at) = conflict(&hulls[i], &hulls[j], tolerance) else { continue };
                let bulge = [i, j].map(|k| curves[k].curve.bulge());
                let mut any = false;
                for (k, own, other) in [(i, bulge[0], bulge[1]), (j, bulge[1], bulge[0])] {
                    if own >= 0.5 * other && curves[k].halved < MOST_HALVINGS && own > 0.0 {
                        (halve[k], any) = (true, true);
                    }
                }
                if !any {
                    touching.push(at);
                }
            }
        }
        if !halve.contains(&true) || curves.len() > MOST_CURVES {
            return touching;
        }
        let mut next = Vec::new();
        fresh.clear();
        for (owned, divide) in std::mem::take(curves).into_iter().zip(halve) {
            if !divide {
                next.push(owned);
                fresh.push(false);
                continue;
            }
            for half in owned.curve.divided(0.5) {
                let mut pieces = Vec::new();
                half.in_corners(&mut pieces);
                for curve in pieces {
                    next.push(OwnedCurve { curve, halved: owned.halved + 1, ..owned });
                    fresh.push(true);
                }
            }
        }
        *curves = next;
    }
}

fn hull(curve: &PageCurve) -> Vec<Place> {
    curve.corner().map_or(curve.ends().to_vec(), |c| c.to_vec())
}

fn range(points: &[Place]) -> [Place; 2] {
    points.iter().fold([points[0]; 2], |[l, h], p| {
        [[0, 1].map(|k| l[k].min(p[k])), [0, 1].map(|k| h[k].max(p[k]))]
    })
}

fn apart(a: [Place; 2], b: [Place; 2], tolerance: f64) -> bool {
    (0..2).any(|k| a[1][k] < b[0][k] - tolerance || b[1][k] < a[0][k] - tolerance)
}

/// A place common to two lines or triangles other than a common corner of both.
fn conflict(a: &[Place], b: &[Place], tolerance: f64) -> Option<Place> {
    let near = |p: Place, q: Place| size(way(p, q)) <= 4.0 * tolerance;
    let shared = |p: Place| [a, b].iter().all(|h| ends(h).iter().any(|q| near(p, *q)));
    let sides = |h: &[Place]| -> Vec<[Place; 2]> {
        let n = h.len();
        (0..if n == 2 { 1 } else { n }).map(|k| [h[k], h[(k + 1) % n]]).collect()
    };
    for [p, q] in sides(a) {
        for [r, s] in sides(b) {
            if let Some(at) = sides_meet([p, q], [r, s], tolerance).filter(|at| !shared(*at)) {
                return Some(at);
            }
        }
    }
    let inside = |p: &&Place, h: &[Place]| {
        let n = h.len();
        let turns: Vec<f64> =
            (0..n).map(|k| cross(way(h[k], h[(k + 1) % n]), way(h[k], **p))).collect();
        n == 3 && !shared(**p) && (turns.iter().all(|t| *t > 0.0) || turns.iter().all(|t| *t < 0.0))
    };
    a.iter().find(|p| inside(p, b)).or_else(|| b.iter().find(|p| inside(p, a))).copied()
}

fn ends(h: &[Place]) -> [Place; 2] {
    [h[0], h[h.len() - 1]]
}

/// A common place of two lines, the farthest from their common end if they overlap.
fn sides_meet([p, q]: [Place; 2], [r, s]: [Place; 2], tolerance: f64) -> Option<Place> {
    let (u, v) = (way(p, q), way(r, s));
    let (long, wide) = (size(u), size(v));
    let det = cross(u, v);
    if det.abs() <= 1e-9 * long * wide {
        // Parallel: an end of one within the other.
        let within = |x: Place, [p, q]: [Place; 2]| {
            let (u, to) = (way(p, q), way(p, x));
            let l = size(u);
            let along = dot(u, to) / l;
            cross(u, to).abs() <= tolerance * l
                && along > 4.0 * tolerance
                && along < l - 4.0 * tolerance
        };
        let all = [(p, [r, s]), (q, [r, s]), (r, [p, q]), (s, [p, q])];
        let same = [[p, q], [q, p]]
            .iter()
            .any(|w| size(way(w[0], r)) <= tolerance && size(way(w[1], s)) <= tolerance);
        let middle = || [0, 1].map(|k| 0.5 * (p[k] + q[k]));
        return all.into_iter().find(|(x, w)| within(*x, *w)).map(|(x, _)| x).or(same.then(middle));
    }
    let (a, b) = (cross(way(p, r), v) / det, cross(way(p, r), u) / det);
    let slack = [tolerance / long, tolerance / wide];
    let on = a >= -slack[0] && a <= 1.0 + slack[0] && b >= -slack[1] && b <= 1.0 + slack[1];
    on.then(|| [0, 1].map(|k| p[k] + a * u[k]))
}

/// The meetings of two curves, of which one is no line, other than at an end of both.
fn meets(a: &PageCurve, b: &PageCurve, tolerance: f64) -> Vec<CurveMeet> {
    let mut out: Vec<CurveMeet> = Vec::new();
    for (k, (one, other)) in [(a, b), (b, a)].into_iter().enumerate() {
        for (side, place) in one.ends().into_iter().enumerate() {
            let s = nearest(other, place);
            if size(way(other.at(s)[0], place)) <= tolerance {
                let end = other.ends().iter().position(|p| size(way(*p, place)) <= 4.0 * tolerance);
                let s = end.map_or(s, |e| e as f64);
                let at = if k == 0 { [side as f64, s] } else { [s, side as f64] };
                out.push(CurveMeet { at, place });
            }
        }
    }
    let mut found: Vec<[f64; 2]> = Vec::new();
    let mut open = vec![(a.clone(), b.clone())];
    let mut count = 0;
    while let Some((p, q)) = open.pop() {
        count += 1;
        if count > MOST_PARTS {
            // They coincide along a part, which begins and ends at ends of them.
            return out;
        }
        if apart(p.range(), q.range(), tolerance) {
            continue;
        }
        let (x, y) = (p.bulge(), q.bulge());
        if x.max(y) <= tolerance {
            let at = sides_meet(p.ends(), q.ends(), 2.0 * tolerance);
            if let Some(at) = at {
                found.push([nearest(a, at), nearest(b, at)]);
            }
        } else if x >= y {
            let [one, other] = p.divided(0.5);
            open.extend([(one, q.clone()), (other, q)]);
        } else {
            let [one, other] = q.divided(0.5);
            open.extend([(p.clone(), one), (p, other)]);
        }
    }
    // Within this of a tangent point two curves are closer than the tolerance.
    let [low, high] = a.range();
    let near = 4.0 * libm::sqrt(tolerance * size(way(low, high)));
    for start in found {
        let (at, crossing) = refined(a, b, start);
        let reach = if crossing { 4.0 * tolerance } else { near };
        let place = a.at(at[0])[0];
        if out.iter().all(|m| size(way(m.place, place)) > reach) {
            out.push(CurveMeet { at, place });
        }
    }
    out
}

/// The parameter of the place of a curve that is nearest to another place.
fn nearest(curve: &PageCurve, place: Place) -> f64 {
    let off = |s: f64| size(way(curve.at(s)[0], place));
    let samples = (0..=16).map(|k| f64::from(k) / 16.0);
    let mut s = samples.min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(0.0);
    for _ in 0..12 {
        let [at, u] = curve.at(s);
        let step = dot(u, way(at, place)) / dot(u, u).max(f64::MIN_POSITIVE);
        let next = (s + step).clamp(0.0, 1.0);
        if off(next) > off(s) {
            break;
        }
        s = next;
    }
    s
}

/// The parameters of a meeting by Newton's method, and whether the curves cross there; where they touch, they are
/// parallel at the nearest places.
fn refined(a: &PageCurve, b: &PageCurve, start: [f64; 2]) -> ([f64; 2], bool) {
    let mut at = start;
    for _ in 0..20 {
        let ([p, u], [q, v]) = (a.at(at[0]), b.at(at[1]));
        let (det, gap) = (cross(u, v), way(p, q));
        if det.abs() <= 1e-3 * size(u) * size(v) {
            return (start, false);
        }
        let step = [cross(gap, v) / det, cross(gap, u) / det];
        at = [0, 1].map(|k| (at[k] + step[k]).clamp(0.0, 1.0));
        if step.iter().all(|s| s.abs() < 1e-15) {
            break;
        }
    }
    (at, true)
}
