//! Fillets between bodies, rounded and chamfered edges.
//!
//! A convex edge of a body is between two terms of its complement, a concave one between two terms
//! of the body itself: on the intersection curve of a face of each, within the rest of both.

use super::terms::BodyTerms;
use crate::expr::blend::fillet;
use crate::expr::form::Form;
use crate::expr::interval::{octants, sides as sides_of};
use crate::{FieldError, Leaf, Primitive, Set};
use moldloft_num::{Box3, Real, Vec3};
use rustc_hash::FxHashMap;
use std::collections::VecDeque;

/// Edges by the names of their two faces; `None`: all.
pub type Edges<'a> = Option<&'a [[String; 2]]>;

/// Maximum number of boxes in the search for an edge.
const MOST_BOXES: usize = 600;
/// Distance of probes beside an edge, and of its points within the faces, relative to the box.
const BESIDE: f64 = 1e-7;
/// Faces that meet at a smaller angle are tangent: they have no edge.
const TANGENT: f64 = 1e-6;

/// The name by which a face is chosen.
fn face_name<T: Real>(leaf: &Leaf<T>) -> String {
    let named = leaf.attributes.name.clone();
    named.unwrap_or_else(|| leaf.primitive.form().name().to_owned())
}

/// The chosen edges, and for each whether it was found.
struct EdgeSelection<'a> {
    edges: Edges<'a>,
    met: Vec<bool>,
}

impl<'a> EdgeSelection<'a> {
    fn new(edges: Edges<'a>) -> Self {
        Self { edges, met: vec![false; edges.map_or(0, <[_]>::len)] }
    }

    fn takes(&mut self, a: &str, b: &str) -> bool {
        let Some(edges) = self.edges else { return true };
        let mut taken = false;
        for (edge, met) in edges.iter().zip(&mut self.met) {
            if edge == &[a, b] || edge == &[b, a] {
                (*met, taken) = (true, true);
            }
        }
        taken
    }

    fn finished(&self) -> Result<(), FieldError> {
        let missing = self.edges.and_then(|e| Some(&e[self.met.iter().position(|m| !m)?]));
        match missing {
            Some([a, b]) => Err(FieldError::NoEdge { faces: [a.clone(), b.clone()] }),
            None => Ok(()),
        }
    }
}

/// Two planes that never meet.
fn parallel<T: Real>(a: &Primitive<T>, b: &Primitive<T>) -> bool {
    match (a.form(), b.form()) {
        (Form::Plane(p), Form::Plane(q)) => p.normal.re().cross(q.normal.re()).norm() < 1e-9,
        _ => false,
    }
}

/// Region in which edges of a body are searched.
struct EdgeSpace {
    over: Option<Box3>,
    /// The set on the open side of an edge: the body for its convex edges, its complement for
    /// concave ones.
    beside: Set,
}

impl EdgeSpace {
    /// True if two faces meet in an edge within `rest`: at a point of both there is `beside`
    /// between them.
    fn shows<T: Real>(&self, faces: [&Primitive<T>; 2], rest: &Set<T>) -> bool {
        let Some(over) = &self.over else { return true };
        let faces = faces.map(Primitive::re);
        let rest = rest.re();
        let tape = rest.compiled().tape;
        let size = over.diagonal();
        let mut room = Vec::new();
        let mut pending = VecDeque::from([sides_of(over)]);
        for _ in 0..MOST_BOXES {
            let Some(sides) = pending.pop_front() else { return false };
            let (low, high) = (sides.map(|s| s.low), sides.map(|s| s.high));
            let cell = Box3 { low: Vec3::from(low), high: Vec3::from(high) };
            if faces.iter().any(|f| !f.range(&cell).contains(0.0))
                || tape.range(&sides, &mut room).low > 0.0
            {
                continue;
            }
            if let Some(p) = on_both(&faces, cell.centre())
                && p.distance(cell.centre()) <= cell.diagonal() + BESIDE * size
                && self.opens(&faces, &rest, p, size)
            {
                return true;
            }
            pending.extend(octants(&sides));
        }
        false
    }

    fn opens(&self, faces: &[Primitive; 2], rest: &Set, p: Vec3, size: f64) -> bool {
        let near = BESIDE * size;
        let [a, b] = [0, 1].map(|k| faces[k].gradient(p).slope.normalized().unwrap_or_default());
        if a.cross(b).norm() < TANGENT {
            return false;
        }
        let Some(out) = (a + b).normalized() else { return false };
        // On the open side, where a part that stands on the face of another begins, and to both
        // sides along the edge, not to one side of its end.
        let open = p + out * near;
        let along = a.cross(b) * (near / a.cross(b).norm());
        let within = |q: Vec3| rest.value(q) < 0.0 || rest.is_everything();
        within(open + along) && within(open - along) && self.beside.value(open) < 0.0
    }
}

/// A point on both faces near another.
pub(super) fn on_both(faces: &[Primitive; 2], from: Vec3) -> Option<Vec3> {
    let mut p = from;
    for _ in 0..40 {
        let [f, g] = [0, 1].map(|k| faces[k].gradient(p));
        let (a, b, c) = (f.slope.norm_sq(), f.slope.dot(g.slope), g.slope.norm_sq());
        let det = a * c - b * b;
        if det <= TANGENT * TANGENT * a * c {
            return None;
        }
        let (s, t) = ((f.value * c - g.value * b) / det, (g.value * a - f.value * b) / det);
        let step = f.slope * s + g.slope * t;
        p -= step;
        if step.norm() <= 1e-14 * (1.0 + p.norm()) {
            return p.is_finite().then_some(p);
        }
    }
    None
}

/// The literals of a term but one.
fn others<T: Real>(body: &BodyTerms<T>, term: &[u32], own: u32) -> Set<T> {
    let rest = term.iter().filter(|code| **code != own);
    rest.fold(Set::everything(), |s, code| s & Set::of_leaf(&body.literal(*code).primitive))
}

/// An edge between a face of one term and a face of another, by the indices of the terms and the
/// codes of the faces.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct TermEdge {
    terms: [usize; 2],
    faces: [u32; 2],
}

/// The chosen edges in which a face of a term of one body meets a face of a term of the other,
/// within the rest of both terms.
fn edges_between<T: Real>(
    bodies: [&BodyTerms<T>; 2],
    choice: &mut EdgeSelection,
    space: &EdgeSpace,
) -> Vec<TermEdge> {
    let same = std::ptr::eq(bodies[0], bodies[1]);
    let mut found = Vec::new();
    for (k, p) in bodies[0].terms.iter().enumerate() {
        let from = if same { k + 1 } else { 0 };
        for (m, q) in bodies[1].terms.iter().enumerate().skip(from) {
            for (&i, &j) in p.iter().flat_map(|i| q.iter().map(move |j| (i, j))) {
                let (l1, l2) = (bodies[0].literal(i), bodies[1].literal(j));
                if parallel(&l1.primitive, &l2.primitive) {
                    continue;
                }
                let rest = others(bodies[0], p, i) & others(bodies[1], q, j);
                if space.shows([&l1.primitive, &l2.primitive], &rest)
                    && choice.takes(&face_name(l1), &face_name(l2))
                {
                    found.push(TermEdge { terms: [k, m], faces: [i, j] });
                }
            }
        }
    }
    found
}

/// The union of two sets with fillets of setback `widths` where their faces meet, along all edges or those chosen by
/// the names of a face of each.
///
/// Each pair of faces that meets outside of both sets gets a blend that touches both along its rails; at the ends of
/// an edge it is cut by the faces beside it.
///
/// # Errors
/// [`FieldError::NoDistance`]; a weight or width out of range; [`FieldError::NoEdge`] for a chosen
/// edge that does not exist.
pub fn fillet_sets<T: Real>(
    [a, b]: [&Set<T>; 2],
    widths: [T; 2],
    lambda: T,
    edges: Edges,
) -> Result<Set<T>, FieldError> {
    let mut choice = EdgeSelection::new(edges);
    let both = a.clone() | b.clone();
    let plain = both.re();
    let over = crate::query::bounds::around(&plain).ok().flatten();
    let space = EdgeSpace { over, beside: plain.complement() };
    let terms = [BodyTerms::of(a, false)?, BodyTerms::of(b, false)?];
    let mut out = both;
    for edge in edges_between([&terms[0], &terms[1]], &mut choice, &space) {
        let of = |k: usize| terms[k].literal(edge.faces[k]).primitive.distance_form();
        let rest = |k: usize| others(&terms[k], &terms[k].terms[edge.terms[k]], edge.faces[k]);
        let patch = fillet([&of(0)?, &of(1)?], widths, lambda)?.patch;
        out = out | (patch & rest(0) & rest(1)).named("fillet");
    }
    choice.finished()?;
    Ok(out)
}

/// Cuts `off`, made of both distances, from the body at every chosen convex edge. Where two edges of
/// a face meet, as at the rim of a pocket, the cuts run on until they meet in a mitre.
fn edges_cut<T: Real>(
    set: &Set<T>,
    edges: Edges,
    name: &str,
    off: impl Fn(&Primitive<T>, &Primitive<T>) -> Result<Set<T>, FieldError>,
) -> Result<Set<T>, FieldError> {
    let mut choice = EdgeSelection::new(edges);
    let plain = set.re();
    let over = crate::query::bounds::around(&plain).ok().flatten();
    let space = EdgeSpace { over, beside: plain };
    let outside = BodyTerms::of(set, true)?;
    let found = edges_between([&outside, &outside], &mut choice, &space);
    let mut cuts = FxHashMap::default();
    for &edge in &found {
        let [d1, d2] = edge.faces.map(|face| outside.literal(face).primitive.distance_form());
        cuts.insert(edge, off(&d1?, &d2?)?.named(name));
    }
    choice.finished()?;
    let mut out = set.clone();
    for edge in found {
        let mut cut = cuts[&edge].clone();
        for side in 0..2 {
            for &face in outside.terms[edge.terms[side]].iter().filter(|f| **f != edge.faces[side])
            {
                let mut beside = edge;
                beside.faces[side] = face;
                let within = Set::of_leaf(&outside.literal(face).primitive);
                cut = cut
                    & match cuts.get(&beside) {
                        Some(next) => within | next.clone(),
                        None => within,
                    };
            }
        }
        out = out - cut;
    }
    Ok(out)
}

/// The set with the convex edges between its faces rounded, of setback `width` on both: all of them, or those chosen.
///
/// # Errors
/// As [`fillet_sets`].
pub fn round_edges<T: Real>(
    set: &Set<T>,
    width: T,
    lambda: T,
    edges: Edges,
) -> Result<Set<T>, FieldError> {
    edges_cut(set, edges, "round", |d1, d2| Ok(fillet([d1, d2], [width, width], lambda)?.patch))
}

/// The set with the convex edges between its faces chamfered, of setback `width` on both: all of them, or those chosen.
///
/// # Errors
/// As [`fillet_sets`].
///
/// # Example
/// ```
/// use moldloft_field::{Set, chamfer_edges, mass};
/// use moldloft_num::{Box3, Vec3};
///
/// let block = Set::cuboid(Vec3::of(0.0, 0.0, 0.0), Vec3::of(10.0, 6.0, 4.0))?;
/// let over = Box3 { low: Vec3::of(-0.5, -0.6, -0.7), high: Vec3::of(10.4, 6.3, 4.2) };
/// let chamfered = chamfer_edges(&block, 1.0, None)?;
/// assert!((mass(&chamfered, &over, &Default::default())?.best.volume() - 206.0).abs() < 1e-6);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn chamfer_edges<T: Real>(set: &Set<T>, width: T, edges: Edges) -> Result<Set<T>, FieldError> {
    let width = crate::error::positive("width", width)?;
    edges_cut(set, edges, "chamfer", |d1, d2| {
        Ok(Set::of_leaf(&((d1 + d2 - width) / T::from(std::f64::consts::SQRT_2))))
    })
}
