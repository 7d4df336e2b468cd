//! Nearest points of one shape for many points: everything that does not depend on the point is
//! computed beforehand.

use crate::cells::{Cells, Flat, LEAF, PolynomialPiece};
use crate::nearest::{
    Sought, apart, nearest_in_curve, nearest_in_surface, on_crease, on_whole_surface,
};
use crate::report::{LocateStatus, Solution};
use crate::tree::CurveTree;
use moldloft_num::{Box3, Curve, Order, Surface, Vec3};
use smallvec::SmallVec;

/// Depth at which boxes are not divided further: the possible gain of a nearer minimum is below
/// rounding.
const DEEPEST: u32 = 9;

/// Boxes that one point looks at before it takes the best it has, as where all points of a surface
/// are equally near.
const MOST_BOXES: u32 = 20_000;

/// The nearest point of a shape with N parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest<const N: usize> {
    /// Its parameters.
    pub at: [f64; N],
    /// Position.
    pub xyz: Vec3,
    /// Distance.
    pub distance: f64,
    /// `Ok`, `EdgeClamped` at an end or edge, `Multiple` if others are equally near, `Tangent` if
    /// the distance is stationary to second order, `Diverged` for a point that is not finite.
    pub status: LocateStatus,
}

impl<const N: usize> Nearest<N> {
    /// The answer for a point that is not finite.
    fn lost() -> Self {
        let xyz = Vec3::of(f64::NAN, f64::NAN, f64::NAN);
        Self { at: [f64::NAN; N], xyz, distance: f64::NAN, status: LocateStatus::Diverged }
    }
}

/// A surface prepared for many nearest-point queries.
///
/// On surfaces that are exactly cubic pieces (B-splines up to degree three) the answer is the
/// nearest point, to 1e-9 of the size: a cell is excluded only if a bound of its distance exceeds
/// the best, and a foot in it is its only one only if the second derivatives of the distance
/// dominate the bound of its third ones. Other surfaces are searched through cubic pieces near them
/// and the feet moved to the surface itself; there the answer is right within the pieces' slack
/// (see [`crate::pieces`]).
///
/// Each answer depends on the surface and its point only.
#[derive(Clone, Debug)]
pub struct NearestSurface {
    cells: Cells,
}

/// The nearest point to `q` of the parallelogram a s + b t over |s|, |t| <= 1, and the square of
/// its distance.
#[inline]
fn nearest_flat(q: Vec3, flat: &Flat) -> ([f64; 2], f64) {
    let [aa, ab, bb] = flat.products;
    let [by_det, by_aa, by_bb] = flat.inverses;
    let (f, g) = (q.dot(flat.a), q.dot(flat.b));
    let (mut s, mut t) = ((f * bb - ab * g) * by_det, (g * aa - ab * f) * by_det);
    if !(by_det > 0.0 && s.abs() <= 1.0 && t.abs() <= 1.0) {
        [s, t] = on_side([-f, -g], flat.products, [by_aa, by_bb], [s, t]);
    }
    ([s, t], (q - flat.a * s - flat.b * t).norm_sq())
}

/// Minimiser of g . w + w . H w / 2 over the square |w| <= 1, for a matrix that is positive
/// definite or nearly so.
#[inline]
fn least_quadratic(g: [f64; 2], [aa, ab, bb]: [f64; 3]) -> [f64; 2] {
    let det = aa * bb - ab * ab;
    let (s, t) = ((ab * g[1] - g[0] * bb) / det, (ab * g[0] - g[1] * aa) / det);
    if det > 0.0 && s.abs() <= 1.0 && t.abs() <= 1.0 {
        return [s, t];
    }
    on_side(g, [aa, ab, bb], [1.0 / aa, 1.0 / bb], [s, t])
}

/// The same if the minimiser (s, t) of the whole plane is outside: it is on a side beyond which (s,
/// t) is.
#[inline]
fn on_side(g: [f64; 2], [aa, ab, bb]: [f64; 3], by: [f64; 2], [s, t]: [f64; 2]) -> [f64; 2] {
    let clamp = |x: f64| if x.is_finite() { x.clamp(-1.0, 1.0) } else { 0.0 };
    let value = |s: f64, t: f64| g[0] * s + g[1] * t + 0.5 * (aa * s * s + bb * t * t) + ab * s * t;
    let s1 = clamp(s);
    let t1 = clamp(-(g[1] + ab * s1) * by[1]);
    let t2 = clamp(t);
    let s2 = clamp(-(g[0] + ab * t2) * by[0]);
    if value(s1, t1) <= value(s2, t2) { [s1, t1] } else { [s2, t2] }
}

/// A foot that may be the nearest.
#[derive(Clone, Copy, Debug)]
struct FootCandidate {
    /// Distance to the piece, and the most it can be from the surface.
    distance: f64,
    slack: f64,
    uv: [f64; 2],
    /// At an edge of the surface.
    edge: bool,
    /// Stopped at the border of a box, beyond which the surface continues.
    border: bool,
    flat: bool,
}

/// A box of a cell's parameters, in the piece's.
#[derive(Clone, Copy)]
struct ParameterBox {
    middle: [f64; 2],
    half: [f64; 2],
    /// At the middle, by the box's own parameters: position less the point, s, t, ss, st, tt.
    jet: [Vec3; 6],
    /// See [`crate::cells::Bent`], for this box and point.
    third: [f64; 4],
    /// Bounds of the third derivatives of the position.
    far: [f64; 4],
    open: [[bool; 2]; 2],
    depth: u32,
}

/// One point's search.
struct Search<'a> {
    p: Vec3,
    piece: &'a PolynomialPiece,
    /// Feet farther than this do not count.
    limit: f64,
    feet: SmallVec<[FootCandidate; 4]>,
    slop: f64,
    boxes: u32,
}

impl NearestSurface {
    /// Prepares a surface.
    pub fn new(surface: &dyn Surface<f64>) -> Self {
        Self { cells: Cells::new(surface) }
    }

    /// The point of the surface that is nearest to `p`.
    pub fn nearest(&self, surface: &dyn Surface<f64>, p: Vec3) -> Nearest<2> {
        if !p.is_finite() {
            return Nearest::lost();
        }
        let cells = &self.cells;
        let size = cells.tree.size;
        let (exactly, sought) = (p, Sought::new(p, &cells.tree.bounds, size));
        let (p, slop) = (sought.near, sought.slop);
        let mut search = Search {
            p,
            piece: &cells.pieces[0],
            limit: f64::INFINITY,
            feet: SmallVec::new(),
            slop,
            boxes: 0,
        };
        if cells.quads.is_empty() {
            search.cell(cells, 0);
        } else {
            // Depth first, the nearest child first; depths are the logarithm of the number of cells.
            let mut stack = [(0.0, 0u32); 64];
            let mut top = 1;
            while top > 0 {
                top -= 1;
                let (low, at) = stack[top];
                if low >= search.limit * search.limit {
                    continue;
                }
                if at & LEAF != 0 {
                    search.cell(cells, (at & !LEAF) as usize);
                    continue;
                }
                let quad = &cells.quads[at as usize];
                let mut order: [(f64, u32); 4] = [(f64::INFINITY, 0); 4];
                let d = quad.distances_sq(p);
                let mut count = 0;
                let most = search.limit * search.limit;
                for k in 0..4 {
                    if d[k] < most {
                        // The farthest first, so that the nearest is on top.
                        let mut at = count;
                        while at > 0 && order[at - 1].0 < d[k] {
                            order[at] = order[at - 1];
                            at -= 1;
                        }
                        order[at] = (d[k], quad.below[k]);
                        count += 1;
                    }
                }
                stack[top..top + count].copy_from_slice(&order[..count]);
                top += count;
            }
        }
        let mut found = self.chosen(surface, &search, sought.p);
        found.distance = apart(found.xyz, exactly);
        found
    }

    /// The nearest of the feet that were found; from a point that was pulled nearer they are brought to
    /// where they are for the point `from` itself.
    fn chosen(&self, surface: &dyn Surface<f64>, search: &Search<'_>, from: Vec3) -> Nearest<2> {
        let (p, tree) = (search.p, &self.cells.tree);
        let exact = tree.exact && from == p;
        let exhausted = search.boxes > MOST_BOXES;
        // As a rule there is one.
        if let ([foot], true) = (search.feet.as_slice(), exact) {
            let xyz = surface.jet(foot.uv[0], foot.uv[1], Order::Zero).p;
            let status = alone(foot, exhausted);
            return Nearest { at: foot.uv, xyz, distance: xyz.distance(p), status };
        }
        let limit = search.limit;
        let mut feet: SmallVec<[(FootCandidate, Vec3); 4]> = SmallVec::new();
        let mut settled = !search.feet.is_empty();
        for foot in search.feet.iter().filter(|f| f.distance - f.slack <= limit) {
            let mut foot = *foot;
            if !exact {
                let exact = on_whole_surface(surface, from, foot.uv, tree.size);
                settled &= exact.converged;
                foot.uv = exact.at;
                foot.edge = exact.held.iter().any(|h| *h);
                foot.border = false;
                foot.flat = exact.flat && !foot.edge;
            }
            let x = surface.jet(foot.uv[0], foot.uv[1], Order::Zero).p;
            foot.distance = x.distance(p);
            feet.push((foot, x));
        }
        let apart = |x: Vec3, y: Vec3| x.distance(y) > 1e-6 * tree.size;
        let best = feet.iter().map(|(f, _)| f.distance).fold(f64::INFINITY, f64::min);
        feet.retain(|(f, _)| f.distance <= best + search.slop);
        if !(tree.exact || settled && feet.len() == 1)
            && let Some((near, _)) =
                feet.iter().min_by(|a, b| a.0.distance.total_cmp(&b.0.distance))
            && let Some(foot) = on_crease(surface, p, near.uv, tree.size)
            && foot.xyz.distance(p) <= best + 1e-12 * tree.size
        {
            let distance = foot.xyz.distance(p);
            return Nearest { at: foot.at, xyz: foot.xyz, distance, status: LocateStatus::Ok };
        }
        // The least on the border of a box is a foot only where no neighbour has a nearer one.
        let nearer = |a: &(FootCandidate, Vec3)| {
            feet.iter().any(|b| {
                let near = b.1.distance(a.1) <= 1e-3 * tree.size;
                near && !b.0.border && b.0.distance <= a.0.distance + 1e-15 * tree.size
            })
        };
        let mut feet: SmallVec<[(FootCandidate, Vec3); 4]> =
            feet.iter().filter(|a| !a.0.border || !nearer(a)).copied().collect();
        // In the order of the parameters; one that two cells share counts once.
        feet.sort_by(|(a, _), (b, _)| {
            a.uv[0].total_cmp(&b.uv[0]).then(a.uv[1].total_cmp(&b.uv[1]))
        });
        let equal = best + 1e-14 * tree.size;
        let Some(&(foot, xyz)) = feet.iter().find(|(f, _)| f.distance <= equal) else {
            if tree.exact || exhausted {
                return Nearest::lost();
            }
            // No descent in a cell converged, as at an unknown crease.
            let Solution { at, report, .. } = nearest_in_surface(surface, tree, p, None);
            let xyz = surface.jet(at[0], at[1], Order::Zero).p;
            return Nearest { at, xyz, distance: xyz.distance(p), status: report.status };
        };
        let mut places: SmallVec<[Vec3; 4]> = SmallVec::new();
        places.push(xyz);
        for (_, x) in feet.iter().filter(|(f, _)| !f.border) {
            if places.iter().all(|y| apart(*x, *y)) {
                places.push(*x);
            }
        }
        let next = places[1..].iter().map(|x| x.distance(xyz)).fold(f64::INFINITY, f64::min);
        // Its number among them in the order of the parameters.
        let before = feet.iter().take_while(|(f, _)| f.uv != foot.uv);
        let chosen = before.filter(|(f, x)| !f.border && apart(*x, xyz)).count();
        let chosen = chosen.min(places.len() - 1);
        let status = if places.len() > 1 {
            LocateStatus::Multiple { count: places.len(), chosen, next }
        } else {
            alone(&foot, exhausted)
        };
        Nearest { at: foot.uv, xyz, distance: foot.distance, status }
    }

    /// The box around the surface.
    pub fn bounds(&self) -> Box3 {
        self.cells.tree.bounds
    }

    /// Number of cells that the surface is divided into.
    pub fn cells(&self) -> usize {
        self.cells.flats.len()
    }
}

/// The status of a foot that no other is as near as.
fn alone(foot: &FootCandidate, exhausted: bool) -> LocateStatus {
    if foot.flat || exhausted {
        LocateStatus::Tangent
    } else if foot.edge {
        LocateStatus::EdgeClamped
    } else {
        LocateStatus::Ok
    }
}

impl<'a> Search<'a> {
    /// Looks for feet in a cell.
    #[inline]
    fn cell(&mut self, cells: &'a Cells, k: usize) {
        let flat = &cells.flats[k];
        let away = flat.c - self.p;
        let (_, off) = nearest_flat(-away, flat);
        let reach = self.limit + flat.bend;
        if off >= reach * reach {
            return;
        }
        let off = off.sqrt();
        // There is a point as near as this.
        self.limit = self.limit.min(off + flat.bend + self.slop);
        let bent = &cells.bents[k];
        self.piece = &cells.pieces[bent.piece as usize];
        let far = away.norm() + bent.reach;
        let [ss, st, tt] = bent.second;
        self.part(&ParameterBox {
            middle: bent.middle,
            half: bent.half,
            jet: [away, flat.a, flat.b, ss, st, tt],
            third: std::array::from_fn(|k| bent.fixed[k] + far * bent.far[k]),
            far: bent.far,
            open: bent.open,
            depth: 0,
        });
    }

    /// Makes sure that no nearer foot is in the box.
    fn part(&mut self, part: &ParameterBox) {
        self.boxes += 1;
        let [r, s, t, ss, st, tt] = part.jet;
        let slack = self.piece.slack;
        // Half the square of the distance: its derivatives at the middle, and bounds of the third.
        let g = [s.dot(r), t.dot(r)];
        let h = [s.norm_sq() + ss.dot(r), s.dot(t) + st.dot(r), t.norm_sq() + tt.dot(r)];
        let [n0, n1, n2, n3] = part.third;
        let convex = h[0] > 0.0 && h[2] > 0.0 && h[0] * h[2] > h[1] * h[1];
        // Lower bound: the minimum of the quadratic, or of the plane, less their remainders.
        let start = if convex {
            let w = least_quadratic(g, h);
            let value = g[0] * w[0]
                + g[1] * w[1]
                + 0.5 * (h[0] * w[0] * w[0] + h[2] * w[1] * w[1])
                + h[1] * w[0] * w[1];
            let rest = (n0 + 3.0 * (n1 + n2) + n3) / 6.0;
            let low = (r.norm_sq() + 2.0 * (value - rest)).max(0.0).sqrt() - slack;
            if low >= self.limit {
                return;
            }
            let high = (r.norm_sq() + 2.0 * (value + rest)).max(0.0).sqrt() + slack;
            self.limit = self.limit.min(high + self.slop);
            w
        } else {
            let flat = Flat::of(r, s, t, 0.0);
            let (w, off) = nearest_flat(-r, &flat);
            let [f0, f1, f2, f3] = part.far;
            let bend =
                0.5 * (ss.norm() + tt.norm()) + st.norm() + (f0 + 3.0 * (f1 + f2) + f3) / 6.0;
            if off.sqrt() - bend - slack >= self.limit {
                return;
            }
            w
        };
        // If the distance decreases towards one side all over the box, its minimum is there: in the
        // neighbour, unless the border ends there.
        let slack_slope = if slack > 0.0 { 20.0 * slack * (s.norm() + t.norm()) } else { 0.0 };
        let wobble = [
            h[0].abs() + h[1].abs() + 0.5 * (n0 + 2.0 * n1 + n2) + slack_slope,
            h[1].abs() + h[2].abs() + 0.5 * (n1 + 2.0 * n2 + n3) + slack_slope,
        ];
        let mut to_side = [false; 2];
        for k in 0..2 {
            if g[k].abs() > wobble[k] {
                if !part.open[k][usize::from(g[k] < 0.0)] {
                    return;
                }
                to_side[k] = true;
            }
        }
        let change = [n0 + n1, n1 + n2, n2 + n3];
        let definite = |[a, b, c]: [f64; 3], by: [f64; 3]| {
            let (a, b, c) = (a - by[0], b.abs() + by[1], c - by[2]);
            a > 0.0 && c > 0.0 && a * c > b * b
        };
        let one = match to_side {
            [true, true] => true,
            [true, false] => h[2] > change[2],
            [false, true] => h[0] > change[0],
            _ => definite(h, change),
        };
        let last = part.depth >= DEEPEST || self.boxes > MOST_BOXES;
        let foot =
            if one || last || convex || part.depth == 0 { self.descend(part, start) } else { None };
        if last || one && foot.is_some() {
            return;
        }
        if let Some((w, h)) = foot {
            // The foot's own second derivatives against the bound of the third ones up to the
            // corners.
            let d = [1.0 + w[0].abs(), 1.0 + w[1].abs()];
            let by = [
                (n0 * d[0] + n1 * d[1]) / 3.0,
                (n1 * d[0] + n2 * d[1]) / 3.0,
                (n2 * d[0] + n3 * d[1]) / 3.0,
            ];
            if definite(h, by) {
                return;
            }
        }
        // In four, the one with the start first.
        let first = [start[0] > 0.0, start[1] > 0.0];
        for flip in [[false, false], [true, false], [false, true], [true, true]] {
            let high = [first[0] ^ flip[0], first[1] ^ flip[1]];
            let half = part.half.map(|h| 0.5 * h);
            let at = |k: usize| if high[k] { half[k] } else { -half[k] };
            let middle = [part.middle[0] + at(0), part.middle[1] + at(1)];
            let [x, s, t, ss, st, tt] = self.piece.jet(middle[0], middle[1]);
            let [a, b] = half;
            let mut open = part.open;
            for k in 0..2 {
                open[k][usize::from(!high[k])] = false;
            }
            self.part(&ParameterBox {
                middle,
                half,
                jet: [x - self.p, s * a, t * b, ss * (a * a), st * (a * b), tt * (b * b)],
                third: part.third.map(|n| 0.125 * n),
                far: part.far.map(|n| 0.125 * n),
                open,
                depth: part.depth + 1,
            });
        }
    }

    /// Newton's method for the foot in a box: where it is in the box's parameters, and the second
    /// derivatives of half the square of the distance there; `None` when it did not settle.
    fn descend(&mut self, part: &ParameterBox, start: [f64; 2]) -> Option<([f64; 2], [f64; 3])> {
        let clamp = |w: [f64; 2]| w.map(|x| x.clamp(-1.0, 1.0));
        let mut w = clamp(start);
        let mut before = f64::INFINITY;
        let mut last = w;
        let mut step_share = 1.0;
        let mut h = [0.0; 3];
        let (mut foot, mut held, mut settled) = (None, [false; 2], false);
        let curvature = |h: f64, m: f64| if h > 1e-3 * m { h } else { h.abs().max(m) };
        for _ in 0..30 {
            let at = [0, 1].map(|k| part.middle[k] + part.half[k] * w[k]);
            let [x, s, t, ss, st, tt] = self.piece.jet(at[0], at[1]);
            let [a, b] = part.half;
            let r = x - self.p;
            let (s, t) = (s * a, t * b);
            let d = r.norm_sq();
            // Every step decreases the distance, up to rounding.
            if d > before * (1.0 + 1e-12) && step_share > 1e-4 {
                step_share *= 0.25;
                w = [0, 1].map(|k| last[k] + 0.25 * (w[k] - last[k]));
                continue;
            }
            (before, last) = (d.min(before), w);
            let g = [s.dot(r), t.dot(r)];
            held = [0, 1].map(|k| w[k] <= -1.0 && g[k] > 0.0 || w[k] >= 1.0 && g[k] < 0.0);
            let m = [s.norm_sq(), s.dot(t), t.norm_sq()];
            h = [
                m[0] + ss.dot(r) * (a * a),
                m[1] + st.dot(r) * (a * b),
                m[2] + tt.dot(r) * (b * b),
            ];
            foot = Some((d, at));
            let step = match held {
                [true, true] => {
                    settled = true;
                    break;
                }
                [true, false] => [0.0, g[1] / curvature(h[2], m[2])],
                [false, true] => [g[0] / curvature(h[0], m[0]), 0.0],
                _ => {
                    let least = 1e-6 * m[0] * m[2];
                    let (mut h11, mut h12, mut h22) = (h[0], h[1], h[2]);
                    if h11 <= 0.0 || h22 <= 0.0 || h11 * h22 - h12 * h12 <= least {
                        // Downhill along both, no farther than either curvature lets it.
                        (h11, h22) = (h11.abs().max(m[0]), h22.abs().max(m[2]));
                        h12 = h12.clamp(-0.9 * (h11 * h22).sqrt(), 0.9 * (h11 * h22).sqrt());
                    }
                    let det = h11 * h22 - h12 * h12;
                    let step = [(g[0] * h22 - h12 * g[1]) / det, (h11 * g[1] - g[0] * h12) / det];
                    // A step that would leave the box from its side is taken along the side instead.
                    let leaves =
                        |k: usize| w[k] <= -1.0 && step[k] > 0.0 || w[k] >= 1.0 && step[k] < 0.0;
                    match [leaves(0), leaves(1)] {
                        [true, _] => [0.0, g[1] / curvature(h[2], m[2])],
                        [_, true] => [g[0] / curvature(h[0], m[0]), 0.0],
                        _ => step,
                    }
                }
            };
            if !(step[0].is_finite() && step[1].is_finite()) {
                break;
            }
            let next = clamp([w[0] - step[0], w[1] - step[1]]);
            let moved = (next[0] - w[0]).abs().max((next[1] - w[1]).abs());
            // Newton's next error is about the square of the step: below rounding then.
            w = next;
            step_share = 1.0;
            if moved < 1e-9 {
                let at = [0, 1].map(|k| part.middle[k] + part.half[k] * w[k]);
                foot = Some((d, at));
                last = w;
                settled = true;
                break;
            }
        }
        if let Some((d, at)) = foot {
            let distance = d.sqrt();
            let slack = self.piece.slack;
            if distance - slack <= self.limit {
                let sides = [0, 1].map(|k| held[k] && part.open[k][usize::from(last[k] > 0.0)]);
                let uv = self.piece.place(at[0], at[1]);
                let border = (0..2).any(|k| held[k] && !sides[k]);
                let edge = (0..2).any(|k| sides[k] && (uv[k] <= 0.0 || uv[k] >= 1.0));
                let flat = held == [false; 2] && h[0] * h[2] - h[1] * h[1] <= 1e-9 * h[0] * h[2];
                let limit = distance + slack + self.slop;
                if limit < self.limit {
                    self.limit = limit;
                    self.feet.retain(|f| f.distance - f.slack <= limit);
                }
                let same = |f: &FootCandidate| {
                    f.border == border && (0..2).all(|k| (f.uv[k] - uv[k]).abs() < 1e-9)
                };
                if !self.feet.iter().any(same) && self.feet.len() < 64 {
                    self.feet.push(FootCandidate { distance, slack, uv, edge, border, flat });
                }
            }
        }
        settled.then_some((last, h))
    }
}

/// An order in which consecutive points are near each other, which keeps the data of a search in
/// the cache: along a Morton curve through the box around them (Morton 1966).
pub fn by_place(points: &[Vec3]) -> Vec<u32> {
    let finite = points.iter().copied().filter(|p| p.is_finite());
    let around = Box3::around(finite);
    let side = around.high - around.low;
    let cell = |x: f64, low: f64, side: f64| -> u64 {
        let share = if side > 0.0 { (x - low) / side } else { 0.0 };
        // Ten bits; NaN becomes 0.
        let mut k = (share * 1024.0).clamp(0.0, 1023.0) as u64;
        k = (k | k << 16) & 0x0300_00ff;
        k = (k | k << 8) & 0x0300_f00f;
        k = (k | k << 4) & 0x030c_30c3;
        (k | k << 2) & 0x0924_9249
    };
    let key = |p: &Vec3| {
        cell(p.x, around.low.x, side.x)
            | cell(p.y, around.low.y, side.y) << 1
            | cell(p.z, around.low.z, side.z) << 2
    };
    let mut keys: Vec<u64> =
        points.iter().enumerate().map(|(k, p)| key(p) << 32 | k as u64).collect();
    keys.sort_unstable();
    keys.into_iter().map(|k| k as u32).collect()
}

/// A curve prepared for many nearest-point queries; see [`NearestSurface`].
#[derive(Clone, Debug)]
pub struct NearestCurve {
    tree: CurveTree,
}

impl NearestCurve {
    /// Prepares a curve.
    pub fn new(curve: &dyn Curve<f64>) -> Self {
        Self { tree: CurveTree::new(curve) }
    }

    /// The point of the curve that is nearest to `p`.
    pub fn nearest(&self, curve: &dyn Curve<f64>, p: Vec3) -> Nearest<1> {
        if !p.is_finite() {
            return Nearest::lost();
        }
        let found = nearest_in_curve(curve, &self.tree, p, None);
        let xyz = curve.jet(found.at[0], Order::Zero)[0];
        Nearest { at: found.at, xyz, distance: apart(xyz, p), status: found.report.status }
    }

    /// The box around the curve.
    pub fn bounds(&self) -> Box3 {
        self.tree.bounds
    }
}
