//! Sets: combinations of the solid parts of primitives.

pub(crate) mod body;

use crate::expr::algebra::Unary;
use crate::expr::interval::Interval;
use crate::expr::primitive::{Binary, Op};
use crate::expr::tape::{Builder, ExprInstruction, ExprTape, NO_LEAF};
use crate::{Affine, FieldError, Primitive};
use moldloft_budget::Budget;
use moldloft_num::{Box3, Real, Vec3};
use rustc_hash::{FxHashMap, FxHashSet, FxHasher};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::hash::{Hash, Hasher};
use std::ops::{BitAnd, BitOr, BitXor, Neg, Sub};
use std::sync::Arc;

/// Attributes of a handle to a set; leaves inherit missing attributes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SetAttributes {
    /// Name.
    pub name: Option<String>,
    /// True for an explicit name, which is preserved when the set is declared under another.
    pub given: bool,
    /// Index of a palette colour, 0 to 15.
    pub colour: Option<u8>,
    /// Material.
    pub material: Option<String>,
    /// Distance below which two points count as one.
    pub tolerance: Option<f64>,
    /// Further attributes, by tag.
    pub tags: BTreeMap<String, String>,
}

impl SetAttributes {
    /// These attributes, with missing ones taken from `outer`.
    pub fn or(&self, outer: &Self) -> Self {
        Self {
            name: self.name.clone().or_else(|| outer.name.clone()),
            given: if self.name.is_some() { self.given } else { outer.given },
            colour: self.colour.or(outer.colour),
            material: self.material.clone().or_else(|| outer.material.clone()),
            tolerance: self.tolerance.or(outer.tolerance),
            tags: match (self.tags.is_empty(), outer.tags.is_empty()) {
                (_, true) => self.tags.clone(),
                (true, _) => outer.tags.clone(),
                _ => outer.tags.clone().into_iter().chain(self.tags.clone()).collect(),
            },
        }
    }
}

/// State of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Membership {
    /// Inside.
    Solid,
    /// On the surface.
    Surface,
    /// Outside.
    Air,
}

enum SetNodeKind<T: Real> {
    Everything,
    Nothing,
    Leaf(Primitive<T>),
    Union,
    Intersection,
}

struct SetNode<T: Real> {
    kind: SetNodeKind<T>,
    /// Two operands of unions and intersections.
    operands: Vec<Set<T>>,
    /// By which different sets mostly differ; attributes do not count.
    fingerprint: u64,
}

impl<T: Real> Drop for SetNode<T> {
    /// Long chains are taken apart in a loop: recursion would overflow the stack.
    fn drop(&mut self) {
        let mut pending = std::mem::take(&mut self.operands);
        while let Some(set) = pending.pop() {
            if let Some(mut node) = Arc::into_inner(set.node) {
                pending.append(&mut node.operands);
            }
        }
    }
}

/// A set of points: primitives under union, intersection and complement.
///
/// Sets are immutable and share their parts; holding on to an operand is all that undo needs.
/// Attributes belong to the handle, so one geometry may carry several.
///
/// # Example
/// ```
/// use moldloft_field::{Membership, Primitive, Set};
/// use moldloft_num::Vec3;
///
/// let ball = Set::new(&Primitive::sphere(Vec3::zero(), 2.0)?);
/// let hole = Set::new(&Primitive::sphere(Vec3::zero(), 1.0)?);
/// let shell = ball - hole;
/// assert_eq!(shell.member(Vec3::of(1.5, 0.0, 0.0), 1e-9), Membership::Solid);
/// assert_eq!(shell.member(Vec3::of(1.0, 0.0, 0.0), 1e-9), Membership::Surface);
/// assert_eq!(shell.member(Vec3::of(0.5, 0.0, 0.0), 1e-9), Membership::Air);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub struct Set<T: Real = f64> {
    node: Arc<SetNode<T>>,
    attributes: Option<Arc<SetAttributes>>,
    figures: Option<[T; 2]>,
}

impl<T: Real> Clone for Set<T> {
    fn clone(&self) -> Self {
        Self { node: self.node.clone(), attributes: self.attributes.clone(), figures: self.figures }
    }
}

/// A primitive of a set with the attributes that apply to it.
#[derive(Clone, Debug)]
pub struct Leaf<T: Real = f64> {
    /// The primitive as used in the set: negated within a complement.
    pub primitive: Primitive<T>,
    /// Its attributes, completed by those of the enclosing sets.
    pub attributes: SetAttributes,
}

#[derive(Clone)]
pub(crate) struct Compiled<T: Real> {
    pub(crate) tape: Arc<ExprTape<T>>,
    pub(crate) leaves: Vec<Leaf<T>>,
    /// The number of the leaf at every position of the tree, in order; a shared part counts once.
    pub(crate) places: Vec<u32>,
}

impl<T: Real> Compiled<T> {
    /// The value that decides at a point, and the number of its leaf.
    pub(crate) fn winner(&self, p: Vec3<T>) -> (T, Option<usize>) {
        let mut values = Vec::new();
        let value = self.tape.eval::<T>(&p, &mut values);
        let leaf = self.tape.leaf[self.tape.winner(&values, T::re)];
        (value, (leaf != NO_LEAF).then_some(leaf as usize))
    }
}

/// Neighbours joined two and two until one is left.
fn balanced<S>(mut all: Vec<S>, join: impl Fn(S, S) -> S) -> Option<S> {
    while all.len() > 1 {
        let mut next = Vec::with_capacity(all.len().div_ceil(2));
        let mut rest = all.into_iter();
        while let Some(a) = rest.next() {
            next.push(match rest.next() {
                Some(b) => join(a, b),
                None => a,
            });
        }
        all = next;
    }
    all.pop()
}

impl<T: Real> Set<T> {
    fn of(kind: SetNodeKind<T>, operands: Vec<Set<T>>) -> Self {
        let mut h = FxHasher::default();
        std::mem::discriminant(&kind).hash(&mut h);
        if let SetNodeKind::Leaf(p) = &kind {
            p.0.fingerprint.hash(&mut h);
        }
        operands.iter().for_each(|o| o.node.fingerprint.hash(&mut h));
        let fingerprint = h.finish();
        let node = Arc::new(SetNode { kind, operands, fingerprint });
        Self { node, attributes: None, figures: None }
    }

    /// A number by which different sets mostly differ.
    pub(crate) fn fingerprint(&self) -> u64 {
        self.node.fingerprint
    }

    /// All of space.
    pub fn everything() -> Self {
        Self::of(SetNodeKind::Everything, Vec::new())
    }

    /// No point.
    pub fn nothing() -> Self {
        Self::of(SetNodeKind::Nothing, Vec::new())
    }

    /// The union of some sets as a balanced tree.
    pub fn union_of(sets: Vec<Self>) -> Self {
        balanced(sets, |a, b| a | b).unwrap_or_else(Self::nothing)
    }

    /// The intersection of some sets, as a balanced tree.
    pub fn intersection_of(sets: Vec<Self>) -> Self {
        balanced(sets, |a, b| a & b).unwrap_or_else(Self::everything)
    }

    /// The points where `primitive` is not positive. Constants give everything or nothing, a minimum
    /// a union and a maximum an intersection, so that each part keeps its own faces.
    pub fn new(primitive: &Primitive<T>) -> Self {
        let mut negated = false;
        let mut p = primitive;
        while let Op::Unary(Unary::Neg, inner) = &p.0.op {
            negated = !negated;
            p = inner;
        }
        let set = match &p.0.op {
            Op::Real(c) if (c.re() > 0.0) != negated => Self::nothing(),
            Op::Real(_) => Self::everything(),
            Op::Binary(Binary::Min, a, b) => Self::new(a) | Self::new(b),
            Op::Binary(Binary::Max, a, b) => Self::new(a) & Self::new(b),
            _ if negated => return Self::of(SetNodeKind::Leaf(-p), Vec::new()),
            _ => return Self::of(SetNodeKind::Leaf(p.clone()), Vec::new()),
        };
        if negated { -set } else { set }
    }

    /// The box between two corners, as an intersection of six half-spaces.
    ///
    /// # Errors
    /// A box without volume.
    pub fn cuboid(low: Vec3<T>, high: Vec3<T>) -> Result<Self, FieldError> {
        crate::error::solid_box(Box3 { low: low.re(), high: high.re() })?;
        let mut set = Self::everything();
        for k in 0..3 {
            let n = Affine::identity().rows[k];
            let up = Primitive::linear(n, -high[k]);
            let down = Primitive::linear(-n, low[k]);
            set = set & Self::new(&down) & Self::new(&up);
        }
        Ok(set)
    }

    /// The tetrahedron of four points, in any order.
    ///
    /// # Errors
    /// Points in one plane.
    pub fn tetrahedron(points: [Vec3<T>; 4]) -> Result<Self, FieldError> {
        let mut set = Self::everything();
        for k in 0..4 {
            let [a, b, c] = [1, 2, 3].map(|j| points[(k + j) % 4]);
            let normal = (b - a).cross(c - a);
            let face = Primitive::plane(normal, a)?;
            let height = face.value(points[k]);
            // No volume within rounding: the height is lost relative to the edges' lengths.
            if height.re().abs() <= 1e-12 * (points[k] - a).norm().re() {
                return Err(FieldError::Degenerate { what: "tetrahedron" });
            }
            let inward = if height.re() > 0.0 { -face } else { face };
            set = set & Self::new(&inward);
        }
        Ok(set)
    }

    /// A wire: the straight line between two points, as the intersection of two sheets.
    ///
    /// # Errors
    /// Points that coincide.
    pub fn segment(from: Vec3<T>, to: Vec3<T>) -> Result<Self, FieldError> {
        let along = to - from;
        if along.norm_sq().re() == 0.0 {
            return Err(FieldError::Degenerate { what: "line: its ends coincide; it" });
        }
        // Slanting sheets, so that they are not parallel to planes of the grid.
        let (p, q) = (along.perpendicular(), along.cross(along.perpendicular()));
        let (p, q) = (p / p.norm(), q / q.norm());
        let sheets = [p * T::from(0.8) + q * T::from(0.6), q * T::from(0.8) - p * T::from(0.6)];
        let mut set = Self::new(&Primitive::plane(along, to)?);
        set = Self::new(&Primitive::plane(-along, from)?) & set;
        for normal in sheets {
            set = Self::new(&Primitive::plane(normal, from)?.abs()) & set;
        }
        Ok(set)
    }

    /// A point: the intersection of three sheets.
    ///
    /// # Errors
    /// A coordinate that is not finite.
    pub fn point(at: Vec3<T>) -> Result<Self, FieldError> {
        // Columns of a rotated frame, so that the sheets are not parallel to planes of the grid.
        let frame = [[2.0, 1.0, 2.0], [-2.0, 2.0, 1.0], [1.0, 2.0, -2.0]];
        let mut set = Self::everything();
        for [x, y, z] in frame {
            set = set & Self::new(&Primitive::plane(Vec3::of(x, y, z), at)?.abs());
        }
        Ok(set)
    }

    /// The sheets on the faces of the cuboid between two corners, without its inside.
    ///
    /// # Errors
    /// A box without volume.
    pub fn thin_cuboid(low: Vec3<T>, high: Vec3<T>) -> Result<Self, FieldError> {
        Ok(Self::cuboid(low, high)?.skin())
    }

    /// The boundary of the set without its interior: of each primitive the sheet where the set
    /// differs on both sides. Faces between parts that touch, or inside another part, are none.
    pub fn skin(&self) -> Self {
        let all = self.traversal();
        let plain = |p: &Primitive<T>| Leaf { primitive: p.re(), attributes: Default::default() };
        let (_, sides) = body::surfaces_of(&all.iter().map(plain).collect::<Vec<_>>());
        let place: FxHashMap<usize, usize> =
            all.iter().enumerate().map(|(k, p)| (p.identity(), k)).collect();
        let mut done: FxHashSet<u32> = FxHashSet::default();
        let mut skin = Self::nothing();
        for (leaf, own) in all.iter().zip(&sides) {
            if leaf.is_sheet() {
                skin = skin | (Self::of_leaf(leaf) & self.clone());
                continue;
            }
            if !done.insert(own.surface) {
                continue;
            }
            let on_side = |positive: bool| {
                self.replaced(&|p| {
                    let side = sides[*place.get(&p.identity())?];
                    let same = side.surface == own.surface && !p.is_sheet();
                    same.then(|| match side.flipped == positive {
                        true => Self::everything(),
                        false => Self::nothing(),
                    })
                })
            };
            skin = skin | (Self::new(&leaf.abs()) & (on_side(false) ^ on_side(true)));
        }
        skin
    }

    /// The primitive, if the set is a single one.
    pub fn primitive(&self) -> Option<&Primitive<T>> {
        match &self.node.kind {
            SetNodeKind::Leaf(p) => Some(p),
            _ => None,
        }
    }

    /// Addresses of its node and its attributes; unique while both live.
    pub(crate) fn identity(&self) -> (usize, usize) {
        let attributes = self.attributes.as_ref().map_or(0, |a| Arc::as_ptr(a) as usize);
        (Arc::as_ptr(&self.node) as usize, attributes)
    }

    /// True if another handle may hold its node; other nodes occur once.
    fn is_shared(&self) -> bool {
        Arc::strong_count(&self.node) > 1
    }

    pub(crate) fn is_union(&self) -> bool {
        matches!(self.node.kind, SetNodeKind::Union)
    }

    /// A primitive as it is, without looking for unions in it.
    pub(crate) fn of_leaf(p: &Primitive<T>) -> Self {
        Self::of(SetNodeKind::Leaf(p.clone()), Vec::new())
    }

    /// Two sets joined as they are.
    pub(crate) fn of_two(union: bool, a: Self, b: Self) -> Self {
        Self::of(if union { SetNodeKind::Union } else { SetNodeKind::Intersection }, vec![a, b])
    }

    /// True if the set is known to be the whole of space.
    pub fn is_everything(&self) -> bool {
        matches!(self.node.kind, SetNodeKind::Everything)
    }

    /// True if the set is known to be empty.
    pub fn is_nothing(&self) -> bool {
        matches!(self.node.kind, SetNodeKind::Nothing)
    }

    /// The two operands of a union or intersection.
    pub fn operands(&self) -> &[Set<T>] {
        &self.node.operands
    }

    /// The same set, of which volume and area are known; what is made of it has its own.
    #[must_use]
    pub fn measured(self, volume: T, area: T) -> Self {
        Self { figures: Some([volume, area]), ..self }
    }

    /// Volume and area, if they are known by its faces.
    pub fn figures(&self) -> Option<[T; 2]> {
        self.figures
    }

    /// The same set with these attributes, completed by its existing ones.
    pub fn with(&self, attributes: SetAttributes) -> Self {
        let attributes = match &self.attributes {
            Some(old) => attributes.or(old),
            None => attributes,
        };
        Self { attributes: Some(Arc::new(attributes)), ..self.clone() }
    }

    /// The same set, its own attributes completed by those of a set around it.
    pub(crate) fn within(&self, outer: SetAttributes) -> Self {
        let attributes = match &self.attributes {
            Some(own) => own.or(&outer),
            None => outer,
        };
        Self { attributes: Some(Arc::new(attributes)), ..self.clone() }
    }

    /// The same set under a name.
    pub fn named(&self, name: &str) -> Self {
        self.with(SetAttributes { name: Some(name.to_owned()), ..SetAttributes::default() })
    }

    /// The set with names for unnamed primitives.
    pub(crate) fn with_names(&self, name: &dyn Fn(&Primitive<T>) -> Option<String>) -> Self {
        let leaf = |p: &Primitive<T>| {
            let set = Self::of(SetNodeKind::Leaf(p.clone()), Vec::new());
            match name(p) {
                Some(name) => set.named(&name),
                None => set,
            }
        };
        self.rebuilt(&leaf, false, &Self::combined)
    }

    /// True when both are the same combination of the same primitives, with the same attributes.
    pub fn same(&self, o: &Self) -> bool {
        if self.is(o) && self.attributes == o.attributes {
            return true;
        }
        let (a, b) = (self.compiled(), o.compiled());
        let said =
            |c: &Compiled<T>| c.leaves.iter().map(|l| l.attributes.clone()).collect::<Vec<_>>();
        a.tape.leaf == b.tape.leaf && a.tape.same(&b.tape) && said(&a) == said(&b)
    }

    /// Attributes of this handle.
    pub fn attributes(&self) -> Option<&SetAttributes> {
        self.attributes.as_deref()
    }

    /// True when both handles refer to the same node.
    pub fn is(&self, o: &Self) -> bool {
        Arc::ptr_eq(&self.node, &o.node)
    }

    /// The geometry without this handle's attributes, to compare by.
    fn alike(&self, o: &Self) -> bool {
        self.is(o)
            || match (&self.node.kind, &o.node.kind) {
                (SetNodeKind::Leaf(a), SetNodeKind::Leaf(b)) => a.same(b),
                _ => false,
            }
    }

    fn opposite(&self, o: &Self) -> bool {
        match (&self.node.kind, &o.node.kind) {
            (SetNodeKind::Leaf(a), SetNodeKind::Leaf(b)) => (-a).same(b) || a.same(&-b),
            _ => false,
        }
    }

    fn join(self, o: Self) -> Self {
        match (&self.node.kind, &o.node.kind) {
            (SetNodeKind::Everything, _) | (_, SetNodeKind::Nothing) => self,
            (SetNodeKind::Nothing, _) | (_, SetNodeKind::Everything) => o,
            _ => Self::of(SetNodeKind::Union, vec![self, o]),
        }
    }

    fn cut(self, o: Self) -> Self {
        match (&self.node.kind, &o.node.kind) {
            (SetNodeKind::Nothing, _) | (_, SetNodeKind::Everything) => self,
            (SetNodeKind::Everything, _) | (_, SetNodeKind::Nothing) => o,
            _ => Self::of(SetNodeKind::Intersection, vec![self, o]),
        }
    }

    /// The set rebuilt from its leaves with the attributes of each handle; shared nodes stay
    /// shared.
    fn rebuilt<S: Real>(
        &self,
        leaf: &dyn Fn(&Primitive<T>) -> Set<S>,
        turned: bool,
        combine: &dyn Fn(bool, Set<S>, Set<S>) -> Set<S>,
    ) -> Set<S> {
        let made: Result<_, Infallible> = self.bottom_up(&mut |set, operands| {
            let made = match (&set.node.kind, operands) {
                (SetNodeKind::Leaf(p), _) => leaf(p),
                (kind, Some([a, b])) => combine(matches!(kind, SetNodeKind::Union) != turned, a, b),
                (kind, None) if matches!(kind, SetNodeKind::Everything) != turned => {
                    Set::everything()
                }
                _ => Set::nothing(),
            };
            Ok(match &set.attributes {
                Some(a) => made.with((**a).clone()),
                None => made,
            })
        });
        let Ok(made) = made;
        made
    }

    /// The result of `make` for the set, from those of its operands; of a shared part once.
    ///
    /// # Errors
    /// The first of `make`.
    pub(crate) fn bottom_up<R: Clone, E>(
        &self,
        make: &mut dyn FnMut(&Self, Option<[R; 2]>) -> Result<R, E>,
    ) -> Result<R, E> {
        let mut known: FxHashMap<(usize, usize), R> = FxHashMap::default();
        let mut out: Vec<R> = Vec::new();
        let mut stack = vec![(self, false)];
        while let Some((set, ready)) = stack.pop() {
            if let Some(made) = known.get(&set.identity()) {
                out.push(made.clone());
                continue;
            }
            let operands = &set.node.operands;
            if !operands.is_empty() && !ready {
                stack.push((set, true));
                stack.extend(operands.iter().rev().map(|o| (o, false)));
                continue;
            }
            let pair = out.split_off(out.len() - operands.len()).try_into().ok();
            let made = make(set, pair)?;
            if set.is_shared() {
                known.insert(set.identity(), made.clone());
            }
            out.push(made);
        }
        Ok(out.swap_remove(0))
    }

    /// The set with other primitives, as far as memory suffices.
    ///
    /// # Errors
    /// [`FieldError::Spent`].
    fn copied(&self, leaf: &dyn Fn(&Primitive<T>) -> Self) -> Result<Self, FieldError> {
        let spent = Cell::new(None);
        let within_memory = |p: &Primitive<T>| {
            if spent.get().is_none() {
                spent.set(Budget::default().grow(0).err());
            }
            if spent.get().is_none() { leaf(p) } else { Self::nothing() }
        };
        let copy = self.rebuilt(&within_memory, false, &Self::combined);
        spent.get().map_or(Ok(copy), |spent| Err(FieldError::Spent(spent)))
    }

    fn combined(union: bool, a: Self, b: Self) -> Self {
        if union { a.join(b) } else { a.cut(b) }
    }

    /// The set with leaves replaced where `new` has something else for them.
    pub(crate) fn replaced(&self, new: &dyn Fn(&Primitive<T>) -> Option<Self>) -> Self {
        let leaf = |p: &Primitive<T>| {
            new(p).unwrap_or_else(|| Self::of(SetNodeKind::Leaf(p.clone()), Vec::new()))
        };
        self.rebuilt(&leaf, false, &Self::combined)
    }

    /// Everything that is not in the set.
    pub fn complement(&self) -> Self {
        self.rebuilt(&|p| Self::of(SetNodeKind::Leaf(-p), Vec::new()), true, &Self::combined)
    }

    /// `leaf` of the primitives, joined up the tree: unions with `true`. A shared part is joined
    /// once.
    pub(crate) fn folded<R: Clone>(
        &self,
        leaf: &dyn Fn(&Primitive<T>) -> R,
        everything: R,
        nothing: R,
        join: &dyn Fn(bool, R, R) -> R,
    ) -> R {
        let made: Result<_, Infallible> = self.bottom_up(&mut |set, operands| {
            Ok(match (&set.node.kind, operands) {
                (SetNodeKind::Leaf(p), _) => leaf(p),
                (kind, Some([a, b])) => join(matches!(kind, SetNodeKind::Union), a, b),
                (SetNodeKind::Everything, None) => everything.clone(),
                _ => nothing.clone(),
            })
        });
        let Ok(made) = made;
        made
    }

    /// The set with real parts only.
    pub fn re(&self) -> Set<f64> {
        let any: &dyn std::any::Any = self;
        if let Some(plain) = any.downcast_ref::<Set<f64>>() {
            return plain.clone();
        }
        self.rebuilt(&|p| Set::of(SetNodeKind::Leaf(p.re()), Vec::new()), false, &Set::combined)
    }

    /// The set with its coordinates replaced; see [`Primitive::remapped`]. A map that only rotates
    /// about the z axis, such as a twist, is intersected with a box that contains all rotations, so
    /// that its ends need no search.
    ///
    /// # Errors
    /// [`FieldError::Spent`] if memory does not suffice.
    pub fn remapped(&self, coordinates: &[Primitive<T>; 3]) -> Result<Self, FieldError> {
        let made = self.copied(&|p| Self::of_leaf(&p.remapped(coordinates)))?;
        Ok(match crate::query::bounds::box_of_turns(self, coordinates)? {
            Some(within) => made & within.constant(),
            None => made,
        })
    }

    /// The function of the set as one primitive: minima over unions, maxima over intersections.
    pub fn as_primitive(&self) -> Primitive<T> {
        let [full, empty] = [-1.0, 1.0].map(|x| Primitive::real(T::from(x)));
        let join = |union: bool, a: Primitive<T>, b: Primitive<T>| match union {
            true => a.min(&b),
            false => a.max(&b),
        };
        self.folded(&Primitive::clone, full, empty, &join)
    }

    /// The set moved by an affine map.
    ///
    /// # Errors
    /// A map without inverse, or [`FieldError::Spent`] if memory does not suffice.
    pub fn mapped(&self, world_from: &Affine<T>) -> Result<Self, FieldError> {
        // One trial decides: a map has an inverse or not, whatever the primitive.
        Primitive::real(T::zero()).mapped(world_from)?;
        let move_leaf = |p: &Primitive<T>| match p.mapped(world_from) {
            Ok(p) => Self::of(SetNodeKind::Leaf(p), Vec::new()),
            Err(_) => Self::nothing(),
        };
        self.copied(&move_leaf)
    }

    /// An equal set without parts that combine to nothing new: A|A = A, A|-A = everything, A&-A =
    /// nothing (its surface alone would dangle), A|(A&B) = A, A&(A|B) = A.
    pub fn regularized(&self) -> Self {
        let combine = |union: bool, a: Self, b: Self| {
            if a.alike(&b) {
                return a;
            }
            if a.opposite(&b) {
                return if union { Self::everything() } else { Self::nothing() };
            }
            let absorbs = |whole: &Self, part: &Self| {
                let other = matches!(part.node.kind, SetNodeKind::Union) != union
                    && matches!(part.node.kind, SetNodeKind::Union | SetNodeKind::Intersection);
                other && part.operands().iter().any(|o| o.alike(whole))
            };
            if absorbs(&a, &b) {
                a
            } else if absorbs(&b, &a) {
                b
            } else {
                Self::combined(union, a, b)
            }
        };
        self.rebuilt(&|p| Self::of(SetNodeKind::Leaf(p.clone()), Vec::new()), false, &combine)
    }

    /// The primitives in order of their first appearance, with the attributes that apply to them.
    pub fn leaves(&self) -> Vec<Leaf<T>> {
        self.compiled().leaves
    }

    /// Number of leaves of the tree, shared parts counted at each occurrence; at most `usize::MAX`.
    pub fn contents(&self) -> usize {
        self.folded(&|_| 1, 0, 0, &|_, a: usize, b| a.saturating_add(b))
    }

    /// The highest degree of its primitives.
    pub fn degree(&self) -> u32 {
        self.leaves().iter().map(|leaf| leaf.primitive.degree()).max().unwrap_or(0)
    }

    /// The primitives of its leaves in order; those of a part that occurs many times once.
    pub(crate) fn traversal(&self) -> Vec<Primitive<T>> {
        let (mut out, mut stack) = (Vec::new(), vec![self]);
        let mut seen: FxHashSet<*const SetNode<T>> = FxHashSet::default();
        while let Some(set) = stack.pop() {
            if seen.insert(Arc::as_ptr(&set.node)) {
                out.extend(set.primitive().cloned());
                stack.extend(set.node.operands.iter().rev());
            }
        }
        out
    }

    pub(crate) fn compiled(&self) -> Compiled<T> {
        let made: Result<_, Infallible> = self.compiled_while(&|| Ok(()));
        let Ok(made) = made;
        made
    }

    /// As [`Self::compiled`], as far as memory suffices.
    ///
    /// # Errors
    /// [`FieldError::Spent`].
    pub(crate) fn compiled_within_memory(&self) -> Result<Compiled<T>, FieldError> {
        let budget = Budget::default();
        self.compiled_while(&|| budget.grow(0).map_err(FieldError::Spent))
    }

    /// The code of the set, as long as `check` allows another leaf.
    fn compiled_while<E>(&self, check: &dyn Fn() -> Result<(), E>) -> Result<Compiled<T>, E> {
        let mut builder = Builder::new();
        let mut leaves: Vec<Leaf<T>> = Vec::new();
        let mut values: Vec<u32> = Vec::new();
        let mut places = Vec::new();
        // A node under the same attributes has one value, and attributes under the same outer ones are the same.
        let mut known: FxHashMap<(*const SetNode<T>, *const SetAttributes), u32> =
            FxHashMap::default();
        type Inherited =
            FxHashMap<(*const SetAttributes, *const SetAttributes), Arc<SetAttributes>>;
        let mut inherited = Inherited::default();
        let none = Arc::new(SetAttributes::default());
        let mut stack = vec![(self, false, none)];
        while let Some((set, ready, outer)) = stack.pop() {
            let here = match &set.attributes {
                _ if ready => outer,
                Some(own) => inherited
                    .entry((Arc::as_ptr(own), Arc::as_ptr(&outer)))
                    .or_insert_with(|| Arc::new(own.or(&outer)))
                    .clone(),
                None => outer,
            };
            let key = (Arc::as_ptr(&set.node), Arc::as_ptr(&here));
            if let Some(&at) = known.get(&key) {
                values.push(at);
                continue;
            }
            let at = match (&set.node.kind, ready) {
                // The ranges that svLis gives to the two constant sets.
                (SetNodeKind::Everything, _) => builder.push(ExprInstruction::Real(T::from(-1.0))),
                (SetNodeKind::Nothing, _) => builder.push(ExprInstruction::Real(T::one())),
                (SetNodeKind::Leaf(p), _) => {
                    check()?;
                    let at = builder.primitive(p);
                    builder.mark(at, leaves.len() as u32);
                    places.push(builder.leaf_of(at));
                    if builder.leaf_of(at) == leaves.len() as u32 {
                        leaves.push(Leaf { primitive: p.clone(), attributes: (*here).clone() });
                    }
                    at
                }
                (_, false) => {
                    stack.push((set, true, here.clone()));
                    stack.extend(set.node.operands.iter().rev().map(|o| (o, false, here.clone())));
                    continue;
                }
                (kind, true) => {
                    let b = values.pop().unwrap_or(0);
                    let a = values.pop().unwrap_or(0);
                    builder.push(match kind {
                        SetNodeKind::Union => ExprInstruction::Union(a, b),
                        _ => ExprInstruction::Common(a, b),
                    })
                }
            };
            if set.is_shared() {
                known.insert(key, at);
            }
            values.push(at);
        }
        let root = values.pop().unwrap_or(0);
        Ok(Compiled { tape: Arc::new(builder.build(root)), leaves, places })
    }

    /// The value that decides at a point, and the index of its leaf in [`Set::leaves`]; `None` for
    /// the whole of space and the empty set.
    pub fn winner(&self, p: Vec3<T>) -> (T, Option<usize>) {
        self.compiled().winner(p)
    }

    /// The value at a point: minima over unions, maxima over intersections.
    pub fn value(&self, p: Vec3<T>) -> T {
        self.winner(p).0
    }

    /// State of a point. A surface passes through it if it is within `tolerance`, by |f| / |f'|;
    /// faces with the same state on both sides are not on the body's surface.
    pub fn member(&self, p: Vec3<T>, tolerance: f64) -> Membership {
        self.re().as_body().member(p.re(), tolerance, &[])
    }
}

impl Set<f64> {
    /// The same set in numbers with derivatives; it depends on no parameter.
    pub fn constant<S: Real>(&self) -> Set<S> {
        let leaf = |p: &Primitive| Set::of(SetNodeKind::Leaf(p.constant()), Vec::new());
        self.rebuilt(&leaf, false, &Set::combined)
    }

    /// A range of the value over a box.
    pub fn range(&self, over: &Box3) -> Interval {
        self.compiled().tape.range(&crate::expr::interval::sides(over), &mut Vec::new())
    }

    /// The values at many points.
    pub fn values(&self, points: &[Vec3], out: &mut [f64]) {
        self.compiled().tape.bulk(points, out, &mut Default::default());
    }

    /// The set inside a box, without primitives that are all solid or all air there.
    pub fn pruned(&self, over: &Box3) -> Self {
        let leaf = |p: &Primitive| {
            let range = p.range(over);
            if range.low > 0.0 {
                Self::nothing()
            } else if range.high < 0.0 {
                Self::everything()
            } else {
                Self::of(SetNodeKind::Leaf(p.clone()), Vec::new())
            }
        };
        self.rebuilt(&leaf, false, &Self::combined)
    }
}

impl<T: Real> std::fmt::Debug for Set<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match &self.node.kind {
            SetNodeKind::Everything => write!(f, "everything"),
            SetNodeKind::Nothing => write!(f, "nothing"),
            _ => write!(f, "set of {} primitives", self.contents()),
        }
    }
}

macro_rules! set_operator {
    ($trait:ident, $method:ident, $doc:literal, |$a:ident, $b:ident| $body:expr) => {
        impl<T: Real> $trait for Set<T> {
            type Output = Set<T>;
            #[doc = $doc]
            fn $method(self, o: Set<T>) -> Set<T> {
                let ($a, $b) = (self, o);
                $body
            }
        }
        impl<T: Real> $trait for &Set<T> {
            type Output = Set<T>;
            #[doc = $doc]
            fn $method(self, o: &Set<T>) -> Set<T> {
                let ($a, $b) = (self.clone(), o.clone());
                $body
            }
        }
    };
}
set_operator!(BitOr, bitor, "The points in either.", |a, b| a.join(b));
set_operator!(BitAnd, bitand, "The points in both.", |a, b| a.cut(b));
set_operator!(Sub, sub, "The points of the first that are not in the second.", |a, b| a.cut(-b));
set_operator!(BitXor, bitxor, "The points in exactly one of the two.", |a, b| {
    let (outside, apart) = (a.complement(), b.complement());
    a.cut(apart).join(b.cut(outside))
});

impl<T: Real> Neg for Set<T> {
    type Output = Set<T>;
    fn neg(self) -> Set<T> {
        self.complement()
    }
}

impl<T: Real> Neg for &Set<T> {
    type Output = Set<T>;
    fn neg(self) -> Set<T> {
        self.complement()
    }
}
