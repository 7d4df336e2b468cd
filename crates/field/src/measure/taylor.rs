//! A set in a small box: a combination of leaves, each a plane with a proved remainder.
//!
//! Within the box every leaf is f(c) + f'(c) . d plus a remainder whose range second derivatives bound. The set is
//! monotone in its leaves, so that with the remainders at their upper ends it is less, and at their lower ends
//! more, than it is: both are parted by planes, and integrated exactly.

use super::polytope::{CellPolytope, CuttingPlane, SECOND};
use crate::expr::algebra::{GradientRange, Unary};
use crate::expr::interval::Interval;
use crate::expr::second_order::{HessianRange, PAIRS};
use crate::expr::tape::{ExprInstruction, ExprTape, NO_LEAF, RangeRoom};
use crate::{Hessian, Primitive};
use moldloft_num::{Real, Vec3};
use smallvec::SmallVec;

/// More leaves than this are not parted.
pub(crate) const MOST_LEAVES: usize = 6;

#[derive(Clone, Copy, Debug)]
enum CombinationNode {
    /// A leaf, or its complement.
    Leaf(u8, bool),
    Or(u8, u8),
    And(u8, u8),
}

/// The operand of a negation, and whether it is one.
fn unsigned(tape: &ExprTape<f64>, at: u32) -> (u32, bool) {
    match tape.code[at as usize] {
        ExprInstruction::Unary(Unary::Neg, inner) => (inner, true),
        _ => (at, false),
    }
}

/// Some(negated) if two leaves are one function, or one is the negative of the other.
fn alike(tape: &ExprTape<f64>, a: u32, b: u32) -> Option<bool> {
    let ((p, m), (q, n)) = (unsigned(tape, a), unsigned(tape, b));
    if p == q {
        return Some(m != n);
    }
    match (tape.code[p as usize], tape.code[q as usize]) {
        (ExprInstruction::Plane(u, d), ExprInstruction::Plane(v, e)) if u == -v && d == -e => {
            Some(m == n)
        }
        _ => None,
    }
}

/// A combination of few leaves.
#[derive(Clone, Debug)]
pub(crate) struct Combination {
    nodes: SmallVec<[CombinationNode; 12]>,
    /// The instruction and the number of each leaf.
    pub leaves: SmallVec<[(u32, u32); 6]>,
}

/// State of each leaf at a point: -1 solid, 1 air, 0 unknown.
type Signs = [i8; MOST_LEAVES];

impl Combination {
    /// The combination of a tape; `None` without a leaf, or with too many.
    pub fn of(tape: &ExprTape<f64>) -> Option<Self> {
        let mut number = vec![u8::MAX; tape.code.len()];
        let mut out = Self { nodes: SmallVec::new(), leaves: SmallVec::new() };
        let mut stack: SmallVec<[(u32, bool); 16]> = SmallVec::new();
        stack.push((tape.code.len() as u32 - 1, false));
        while let Some((at, ready)) = stack.pop() {
            let k = at as usize;
            if number[k] != u8::MAX {
                continue;
            }
            let node = match tape.code[k] {
                _ if tape.leaf[k] != NO_LEAF => {
                    // A face with the same on both sides is one leaf, not two that know nothing of each other.
                    let mut known = out.leaves.iter().enumerate();
                    let known = known.find_map(|(j, l)| Some((j, alike(tape, l.0, at)?)));
                    match known {
                        Some((j, turned)) => CombinationNode::Leaf(j as u8, turned),
                        None if out.leaves.len() == MOST_LEAVES => return None,
                        None => {
                            out.leaves.push((at, tape.leaf[k]));
                            CombinationNode::Leaf(out.leaves.len() as u8 - 1, false)
                        }
                    }
                }
                ExprInstruction::Union(a, b) | ExprInstruction::Common(a, b) if !ready => {
                    stack.push((at, true));
                    stack.extend([(b, false), (a, false)]);
                    continue;
                }
                ExprInstruction::Union(a, b) => {
                    CombinationNode::Or(number[a as usize], number[b as usize])
                }
                ExprInstruction::Common(a, b) => {
                    CombinationNode::And(number[a as usize], number[b as usize])
                }
                _ => return None,
            };
            if out.nodes.len() == usize::from(u8::MAX) {
                return None;
            }
            number[k] = out.nodes.len() as u8;
            out.nodes.push(node);
        }
        Some(out)
    }

    fn state(&self, signs: &Signs) -> i8 {
        let mut values: SmallVec<[i8; 12]> = SmallVec::new();
        for node in &self.nodes {
            values.push(match *node {
                CombinationNode::Leaf(k, false) => signs[k as usize],
                CombinationNode::Leaf(k, true) => -signs[k as usize],
                CombinationNode::Or(a, b) => values[a as usize].min(values[b as usize]),
                CombinationNode::And(a, b) => values[a as usize].max(values[b as usize]),
            });
        }
        values[self.nodes.len() - 1]
    }

    /// Hands every solid part of a piece to `take`; `false` from it ends the search.
    fn solid_parts<T: Real>(
        &self,
        piece: CellPolytope<T>,
        cuts: &[Option<CuttingPlane<T>>],
        signs: Signs,
        from: usize,
        take: &mut dyn FnMut(&CellPolytope<T>),
    ) {
        match self.state(&signs) {
            -1 => return take(&piece),
            1 => return,
            _ => {}
        }
        // The state is unknown, so that a leaf is.
        let Some(k) = (from..self.leaves.len()).find(|&k| signs[k] == 0) else { return };
        let Some(cut) = &cuts[k] else { return };
        let [inside, outside] = piece.split(cut, k);
        for (part, sign) in [(inside, -1), (outside, 1)] {
            if let Some(part) = part {
                let mut signs = signs;
                signs[k] = sign;
                self.solid_parts(part, cuts, signs, k + 1, take);
            }
        }
    }
}

/// A leaf in a box: value and gradient at the centre, and the range of the remainder.
#[derive(Clone, Copy, Debug)]
struct TaylorModel {
    value: Interval,
    slope: Vec3,
    rest: Interval,
}

/// Proved bounds of the solid part of a box.
pub(crate) struct MomentBounds {
    /// At least …
    pub least: [f64; 10],
    /// … and at most.
    pub most: [f64; 10],
}

/// Shift of planes relative to a cell's extent, and widening of integrals relative to the volume,
/// against rounding: some hundred roundings.
const ROUNDING: f64 = 1e-13;

/// The middle of a box and its half sides, rounded so that they reach its ends.
pub(crate) fn frame(sides: &[Interval; 3]) -> (Vec3, Vec3) {
    let c = sides.map(Interval::middle);
    let half = [0, 1, 2].map(|k| (sides[k].high - c[k]).max(c[k] - sides[k].low));
    (c.into(), half.into())
}

/// Reusable memory.
#[derive(Default)]
pub(crate) struct TaylorRoom {
    pub ranges: RangeRoom,
    pub forms: Vec<HessianRange>,
    centre: Vec<GradientRange>,
}

/// Bounds of the integrals over the solid part of a box, about its centre; the upper bound of the
/// volume only, unless `moments` are requested.
pub(crate) fn bounds(
    tape: &ExprTape<f64>,
    combination: &Combination,
    sides: &[Interval; 3],
    moments: bool,
    room: &mut TaylorRoom,
) -> MomentBounds {
    let (centre, half) = frame(sides);
    tape.eval::<HessianRange>(sides, &mut room.forms);
    tape.eval::<GradientRange>(&centre.to_array().map(Interval::point), &mut room.centre);
    let reach = [half.x, half.y, half.z];
    let form = |at: u32| {
        let (range, plain) = (&room.forms[at as usize], &room.centre[at as usize]);
        let value = plain.value;
        let slope = Vec3::from(plain.slope.map(Interval::middle));
        // Second derivatives, and the difference of the gradient at the centre from the one used.
        let mut second = Interval::ZERO;
        for k in 0..3 {
            let more = 0.5 * plain.slope[k].width() * reach[k];
            second = second + Interval { low: -more, high: more };
        }
        for (k, [i, j]) in PAIRS.into_iter().enumerate() {
            let square = if i == j {
                Interval { low: 0.0, high: 0.5 * reach[i] * reach[i] }
            } else {
                let r = reach[i] * reach[j];
                Interval { low: -r, high: r }
            };
            second = second + range.second[k] * square;
        }
        // By the range of first derivatives, for kinks.
        let mut first = Interval::ZERO;
        for k in 0..3 {
            let more = (range.slope[k] - Interval::point(slope[k])).magnitude() * reach[k];
            first = first + Interval { low: -more, high: more };
        }
        // By the range of values.
        let spread = (0..3).map(|k| slope[k].abs() * reach[k]).sum::<f64>();
        let plainly = range.value - value + Interval { low: -spread, high: spread };
        let usable = |x: Interval| if x.low <= x.high { x } else { Interval::ENTIRE };
        let rest = usable(second).meet(usable(first)).meet(usable(plainly));
        let slack = ROUNDING * (spread + value.magnitude());
        let rest = Interval { low: rest.low - slack, high: rest.high + slack };
        TaylorModel { value, slope, rest }
    };
    let forms: SmallVec<[TaylorModel; 6]> = combination.leaves.iter().map(|l| form(l.0)).collect();
    let whole = CellPolytope::<f64>::of_box(half);
    let integrate = |least: bool| {
        let mut signs = [0; MOST_LEAVES];
        let cuts: SmallVec<[Option<CuttingPlane<f64>>; 6]> = forms
            .iter()
            .enumerate()
            .map(|(k, f)| {
                let offset = match least {
                    true => f.value.high + f.rest.high,
                    false => f.value.low + f.rest.low,
                };
                if !(offset.is_finite() && f.slope.is_finite()) {
                    // Nothing is known of this leaf.
                    signs[k] = if least { 1 } else { -1 };
                    return None;
                }
                Some(CuttingPlane { normal: f.slope, offset })
            })
            .collect();
        let mut sum = [0.0; 10];
        combination.solid_parts(whole.clone(), &cuts, signs, 0, &mut |part| {
            if least || moments {
                sum.iter_mut().zip(part.moments()).for_each(|(s, x)| *s += x);
            } else {
                sum[0] += part.volume();
            }
        });
        sum
    };
    MomentBounds { least: integrate(true), most: integrate(false) }
}

/// Best estimate of the integrals over the solid part of a box, about its centre: from the leaves'
/// planes at the centre, and to first order from the shift of the faces by second derivatives.
pub(crate) fn best<T: Real>(
    combination: &Combination,
    sides: &[Interval; 3],
    primitive: &dyn Fn(u32) -> Option<Primitive<T>>,
) -> [T; 10] {
    let (centre, half) = frame(sides);
    let jets: SmallVec<[Option<Hessian<T>>; 6]> = combination
        .leaves
        .iter()
        .map(|l| Some(primitive(l.1)?.hessian(Vec3::lifted(centre))))
        .collect();
    let cuts: SmallVec<[Option<CuttingPlane<T>>; 6]> = jets
        .iter()
        .map(|jet| {
            let jet = jet.as_ref()?;
            Some(CuttingPlane { normal: jet.slope, offset: jet.value })
        })
        .collect();
    let mut sum = [T::zero(); 10];
    let whole = CellPolytope::<T>::of_box(half);
    combination.solid_parts(whole, &cuts, [0; MOST_LEAVES], 0, &mut |part| {
        sum.iter_mut().zip(part.moments()).for_each(|(s, x)| *s += x);
        for face in &part.faces {
            if face.owner == super::polytope::WALL {
                continue;
            }
            let leaf = usize::from(face.owner.unsigned_abs()) - 1;
            let Some(Some(jet)) = jets.get(leaf) else { continue };
            let size = jet.slope.norm_sq();
            if size.re() == 0.0 {
                continue;
            }
            // Outward of the piece, the face moves by -q / |f'| where it is inside of the leaf, else by q / |f'|.
            let factor = if face.owner > 0 { T::from(-1.0) } else { T::one() } / size.sqrt();
            let bend = |p: Vec3<T>| {
                let rows = jet.second.map(|row| row.dot(p));
                (p.x * rows[0] + p.y * rows[1] + p.z * rows[2]) * 0.5
            };
            for k in 1..face.corners.len().saturating_sub(1) {
                let t = [face.corners[0], face.corners[k], face.corners[k + 1]];
                let normal = (t[1] - t[0]).cross(t[2] - t[0]);
                if normal.re().norm_sq() == 0.0 {
                    continue;
                }
                let area = normal.norm() * 0.5;
                // Exact to degree two, by middles, for the volume; moments of degree two are of the cell's own size.
                for m in 0..3 {
                    let p = (t[m] + t[(m + 1) % 3]) * T::from(0.5);
                    let weight = bend(p) * factor * area / 3.0;
                    sum[0] += weight;
                    for i in 0..3 {
                        sum[1 + i] += weight * p[i];
                    }
                    for (m, [i, j]) in SECOND.into_iter().enumerate() {
                        sum[4 + m] += weight * p[i] * p[j];
                    }
                }
            }
        }
    });
    sum
}
