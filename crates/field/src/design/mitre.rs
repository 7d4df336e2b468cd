//! Mitres of false edges, which are not on the body's surface.
//!
//! A term of a body may have an edge inside of it, or in the middle of one of its faces. Grown with sharp edges the term
//! reaches further there than the body does, unless other terms cover its tip: then the grown body would have a spike.

use super::edges::on_both;
use super::grown;
use super::terms::BodyTerms;
use crate::expr::interval::{octants, sides as sides_of};
use crate::{FieldError, Primitive, Set};
use moldloft_num::{Box3, Real, Vec3};
use std::collections::VecDeque;

/// Maximum number of boxes in which points of an edge are searched, and of those points.
const MOST_BOXES: usize = 400;
const MOST_POINTS: usize = 12;
/// Distance of probes beside an edge, relative to the box.
const BESIDE: f64 = 1e-7;
/// Faces that meet at a smaller angle have no edge.
const TANGENT: f64 = 1e-6;
/// Offset of probes below the other face, relative to that beyond the first.
const BELOW: f64 = 0.2;

/// A point on an edge inside the body, or in one of its faces, whose mitre would protrude from the
/// body offset by `distance`.
pub(super) fn false_mitre<T: Real>(
    body: &BodyTerms<T>,
    target: &Set,
    over: &Box3,
    distance: f64,
) -> Result<Option<Vec3>, FieldError> {
    if body.terms.len() < 2 {
        return Ok(None);
    }
    let half = |code: u32| body.literal(code).primitive.re();
    let parts: Vec<Set> = body
        .terms
        .iter()
        .map(|term| {
            term.iter()
                .try_fold(Set::everything(), |s, &code| Ok(s & grown(&half(code), distance)?))
        })
        .collect::<Result<_, FieldError>>()?;
    for (k, term) in body.terms.iter().enumerate() {
        let mut covers: Option<Set> = None;
        for (n, &i) in term.iter().enumerate() {
            for &j in &term[n + 1..] {
                let faces = [half(i), half(j)];
                let rest = term.iter().filter(|code| **code != i && **code != j);
                let rest = rest.fold(Set::everything(), |s, code| s & Set::of_leaf(&half(*code)));
                for p in points_of(&faces, &rest, over) {
                    let Some(tip) = tip(&faces, target, p, distance, over) else { continue };
                    // Every other term first, and then those without the same false edge.
                    let cover = |covers: &dyn Fn(usize) -> bool| {
                        let other = parts.iter().enumerate().filter(|(n, _)| *n != k && covers(*n));
                        Set::union_of(other.map(|(_, s)| s.clone()).collect()) | target.clone()
                    };
                    let others = covers.get_or_insert_with(|| cover(&|_| true));
                    let alike = |n: usize| has_edge(body, &body.terms[n], &faces, p, over);
                    if others.value(tip) > 0.0
                        || (0..parts.len()).any(|n| n != k && alike(n))
                            && cover(&|n| !alike(n)).value(tip) > 0.0
                    {
                        return Ok(Some(p));
                    }
                }
            }
        }
    }
    Ok(None)
}

/// True if two faces of a term meet at a point with the normals of `faces`.
fn has_edge<T: Real>(
    body: &BodyTerms<T>,
    term: &[u32],
    faces: &[Primitive; 2],
    p: Vec3,
    over: &Box3,
) -> bool {
    let near = BESIDE * over.diagonal();
    let normals = [0, 1].map(|k| faces[k].gradient(p).slope.normalized().unwrap_or_default());
    let mut met = [false; 2];
    for &code in term {
        let g = body.literal(code).primitive.re().gradient(p);
        let slope = g.slope.norm();
        if g.value > near * slope {
            return false;
        }
        if g.value.abs() <= near * slope {
            for (met, normal) in met.iter_mut().zip(normals) {
                *met |= (g.slope / slope - normal).norm() < TANGENT;
            }
        }
    }
    met == [true; 2]
}

/// Some points of the edge between two faces within the rest of their term.
fn points_of(faces: &[Primitive; 2], rest: &Set, over: &Box3) -> Vec<Vec3> {
    let tape = rest.compiled().tape;
    let mut out: Vec<Vec3> = Vec::new();
    let mut room = Vec::new();
    let mut pending = VecDeque::from([sides_of(over)]);
    for _ in 0..MOST_BOXES {
        let Some(sides) = pending.pop_front() else { break };
        let (low, high) = (sides.map(|s| s.low).into(), sides.map(|s| s.high).into());
        let cell = Box3 { low, high };
        if faces.iter().any(|f| !f.range(&cell).contains(0.0))
            || tape.range(&sides, &mut room).low > 0.0
        {
            continue;
        }
        let centre = cell.centre();
        if let Some(p) = on_both(faces, centre)
            && p.distance(centre) <= cell.diagonal()
            && rest.value(p) < 0.0
        {
            let new = out.iter().all(|q| q.distance(p) > 1e-3 * over.diagonal());
            if new {
                out.push(p);
                if out.len() == MOST_POINTS {
                    break;
                }
            }
        }
        pending.extend(octants(&sides));
    }
    out
}

/// The tip of the mitre at a point of a term's edge where the body has no such edge.
fn tip(faces: &[Primitive; 2], target: &Set, p: Vec3, distance: f64, over: &Box3) -> Option<Vec3> {
    let [a, b] = [0, 1].map(|k| faces[k].gradient(p).slope.normalized().unwrap_or_default());
    let cosine = a.dot(b);
    if a.cross(b).norm() < TANGENT || 1.0 + cosine < TANGENT {
        return None;
    }
    let near = BESIDE * over.diagonal();
    let beside = |way: Vec3| {
        let way = way.normalized().unwrap_or_default();
        target.value(p + way * near) < 0.0
    };
    // Beyond one face and a little below the other, and beyond both.
    let over_first = (a - b * cosine).normalized().unwrap_or_default() - b * BELOW;
    let over_second = (b - a * cosine).normalized().unwrap_or_default() - a * BELOW;
    let shown = ![over_first, over_second, a + b].into_iter().any(beside);
    let reach = distance / (1.0 + cosine) * (1.0 - 1e-9);
    (!shown).then(|| p + (a + b) * reach)
}
