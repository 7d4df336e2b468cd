//! Operations on whole sets: offset and shell by true distance, fillets between sets, rounded and chamfered edges.
//!
//! All are sets of fields again: their surfaces have closed forms, and derivatives by every parameter. Edges are named by the
//! two faces that meet in them, which change of parameters leaves as they are.

mod convex;
mod hull;

pub use convex::{convex_hull, minkowski_sum};

use crate::expr::blend::fillet;
use crate::expr::form::Form;
use crate::measure::certified::{Effort, certified};
use crate::query::separation::solid_within;
use crate::{FieldError, Primitive, Set};
use moldloft_budget::Budget;
use moldloft_num::{Box3, Real};

/// A set as a union of intersections may have this many of these.
const MOST_PIECES: usize = 64;

impl<T: Real> Primitive<T> {
    /// The same solid by the distance from its surface, exact outside and inside.
    ///
    /// # Errors
    /// [`FieldError::NoDistance`] where none is known in closed form: planes, balls, cylinders, cones and tori have one.
    pub fn distance_form(&self) -> Result<Self, FieldError> {
        let none = || FieldError::NoDistance { kind: self.form().name() };
        let within = solid_within(&self.re()).ok_or_else(none)?;
        let f = match self.form() {
            Form::Plane(p) => Self::plane(p.normal, p.point)?,
            Form::Sphere { centre, radius } => Self::sphere_distance(*centre, *radius)?,
            Form::Cylinder { axis, radius } => Self::cylinder_distance(*axis, *radius)?,
            Form::Torus { axis, major, minor } => Self::torus_distance(*axis, *major, *minor)?,
            Form::Cone { axis, angle } => Self::cone_distance(*axis, *angle)?,
            _ => return Err(none()),
        };
        Ok(if within { f } else { -f })
    }
}

impl<T: Real> Set<T> {
    /// The set grown by a distance, or shrunk by a negative one: every face moves along its normals. Edges of an
    /// intersection that grows stay sharp (mitred), as do those of a union that shrinks; the others are exact.
    ///
    /// # Errors
    /// [`FieldError::NoDistance`]; a distance that is not finite.
    ///
    /// # Example
    /// ```
    /// use moldloft_field::Set;
    /// use moldloft_num::Vec3;
    ///
    /// let block = Set::cuboid(Vec3::of(0.0, 0.0, 0.0), Vec3::of(2.0, 1.0, 1.0))?;
    /// assert_eq!(block.offset(0.25)?.value(Vec3::of(1.0, 0.5, 1.5)), 0.25);
    /// # Ok::<(), moldloft_field::FieldError>(())
    /// ```
    pub fn offset(&self, distance: T) -> Result<Self, FieldError> {
        if !distance.is_finite() {
            return Err(FieldError::NotFinite { what: "distance" });
        }
        for leaf in self.leaves() {
            leaf.primitive.distance_form()?;
        }
        Ok(self.replaced(&|p| p.distance_form().ok().map(|f| Self::of_leaf(&(f - distance)))))
    }

    /// The wall of that thickness inside of the set's surface.
    ///
    /// # Errors
    /// [`FieldError::NoDistance`]; a thickness that is not above zero.
    pub fn shell(&self, thickness: T) -> Result<Self, FieldError> {
        let thickness = crate::error::positive("thickness", thickness)?;
        Ok(self - &self.offset(-thickness)?)
    }

    /// The set as a union of intersections of primitives.
    fn pieces(&self) -> Result<Vec<Vec<Primitive<T>>>, FieldError> {
        let join = |union: bool, a: Option<Vec<Vec<_>>>, b: Option<Vec<Vec<_>>>| {
            let (mut a, b) = (a?, b?);
            if union {
                a.extend(b);
            } else {
                let both = |x: &Vec<Primitive<T>>| {
                    let x = x.clone();
                    b.iter().map(move |y| x.iter().chain(y).cloned().collect())
                };
                a = a.iter().flat_map(both).collect();
            }
            (a.len() <= MOST_PIECES).then_some(a)
        };
        let leaf = |p: &Primitive<T>| Some(vec![vec![p.clone()]]);
        self.folded(&leaf, Some(vec![vec![]]), Some(vec![]), &join)
            .ok_or(FieldError::ManyFaces { most: MOST_PIECES })
    }

    /// The name by which an edge's face is chosen.
    fn face_name(&self, p: &Primitive<T>) -> String {
        let plain = p.re();
        let leaf = self.re().leaves().into_iter().find(|l| l.primitive.same(&plain));
        leaf.and_then(|l| l.attributes.name).unwrap_or_else(|| p.form().name().to_owned())
    }
}

/// Edges by the names of the two faces that meet in them; none for all.
pub type Edges<'a> = Option<&'a [[String; 2]]>;

/// Which of the chosen edges were met.
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

/// False when it is proved that a set has nothing in a box.
fn shows<T: Real>(set: &Set<T>, over: &Option<Box3>) -> bool {
    let Some(over) = over else { return true };
    let size: f64 = (0..3).map(|k| over.high[k] - over.low[k]).product();
    let found = certified(&set.re(), over, &Effort::of_cells(600), &Budget::default());
    found.is_ok_and(|f| f.bracket.volume().high > 1e-12 * size)
}

/// The union of two sets with fillets of setback `widths` where their faces meet, along all edges or those chosen by
/// the names of a face of each.
///
/// Each pair of faces that meets outside of both sets gets a blend that touches both along its rails; at the ends of
/// an edge it is cut by the faces beside it.
///
/// # Errors
/// [`FieldError::NoDistance`]; a weight or width out of range; [`FieldError::NoEdge`] for a chosen edge that is none.
pub fn fillet_sets<T: Real>(
    [a, b]: [&Set<T>; 2],
    widths: [T; 2],
    lambda: T,
    edges: Edges,
) -> Result<Set<T>, FieldError> {
    let mut choice = EdgeSelection::new(edges);
    let both = a.clone() | b.clone();
    let over = crate::kinds::region::around(&both.re()).ok().flatten();
    let mut out = both;
    let (pieces, others) = (a.pieces()?, b.pieces()?);
    for (p, q) in pieces.iter().flat_map(|p| others.iter().map(move |q| (p, q))) {
        for (i, l1) in p.iter().enumerate() {
            for (j, l2) in q.iter().enumerate() {
                if parallel(l1, l2) || !choice.takes(&a.face_name(l1), &b.face_name(l2)) {
                    continue;
                }
                let [d1, d2] = [l1.distance_form()?, l2.distance_form()?];
                let mut patch = fillet([&d1, &d2], widths, lambda)?.patch;
                let beside = |list: &[Primitive<T>], own: usize, patch: Set<T>| {
                    let rest = list.iter().enumerate().filter(|(k, _)| *k != own);
                    rest.fold(patch, |s, (_, l)| s & Set::of_leaf(l))
                };
                patch = beside(q, j, beside(p, i, patch));
                if shows(&(patch.clone() - a.clone() - b.clone()), &over) {
                    out = out | patch.named("fillet");
                }
            }
        }
    }
    choice.finished()?;
    Ok(out)
}

/// Cuts every chosen edge of an intersection's faces by what `cut` makes of the distances from both.
fn edges_cut<T: Real>(
    set: &Set<T>,
    edges: Edges,
    name: &str,
    cut: impl Fn(&Primitive<T>, &Primitive<T>) -> Result<Set<T>, FieldError>,
) -> Result<Set<T>, FieldError> {
    let mut choice = EdgeSelection::new(edges);
    let over = crate::kinds::region::around(&set.re()).ok().flatten();
    let mut out = Set::nothing();
    for piece in set.pieces()? {
        let mut part = piece
            .iter()
            .fold(Set::everything(), |s, l| s & Set::of_leaf(l).named(&set.face_name(l)));
        let whole = part.clone();
        for (i, l1) in piece.iter().enumerate() {
            for l2 in &piece[i + 1..] {
                if parallel(l1, l2) || !choice.takes(&set.face_name(l1), &set.face_name(l2)) {
                    continue;
                }
                let kept = cut(&l1.distance_form()?, &l2.distance_form()?)?;
                if shows(&(whole.clone() - kept.clone()), &over) {
                    part = part & kept.named(name);
                }
            }
        }
        out = out | part;
    }
    choice.finished()?;
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
    edges_cut(set, edges, "round", |d1, d2| {
        Ok(fillet([&-d1, &-d2], [width, width], lambda)?.patch.complement())
    })
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
        Ok(Set::of_leaf(&((d1 + d2 + width) / T::from(std::f64::consts::SQRT_2))))
    })
}
