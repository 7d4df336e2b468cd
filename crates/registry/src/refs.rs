//! Evaluated parents as arguments: located points, curves, surfaces, solids, fields, sets and reparametrizations, with
//! the identity of their objects.

use crate::SearchReport;
use moldloft_num::trace::{Key, Piece, Root, Trace};
use moldloft_num::{
    Curve, Field, Jet, Order, Real, Reparametrization, ReparametrizationJet, Solid, Surface, Vec3,
    lift_curve, lift_reparametrization, lift_surface,
};
use smallvec::SmallVec;
use std::any::Any;
use std::ops::Deref;
use std::sync::{Arc, OnceLock};

/// A point in space with its parameters on a curve and on a surface, if any: beads, magnets and
/// rings are points with more data.
#[derive(Clone, Debug)]
pub struct Point<T: Real> {
    /// Position.
    pub xyz: Vec3<T>,
    /// The object, once it has a name; or another object that is the same point by construction.
    pub key: Option<Key>,
    /// Curve and parameter t, for beads and rings.
    pub on_curve: Option<Arc<(CurveRef<T>, T)>>,
    /// Surface and parameters (u, v), for magnets and rings.
    pub on_surface: Option<Arc<(SurfaceRef<T>, [T; 2])>>,
    /// The original point of an image under a map of space. For joins: coincident images of one
    /// point are the same.
    pub image_of: Option<Key>,
    /// Report of the search, if there was one.
    pub found: Option<Arc<SearchReport>>,
}

impl<T: Real> Point<T> {
    /// A free point.
    pub fn free(xyz: Vec3<T>) -> Self {
        Self { xyz, key: None, on_curve: None, on_surface: None, image_of: None, found: None }
    }

    /// The image of a point under a map of space.
    pub fn image(xyz: Vec3<T>, of: &Self) -> Self {
        Self { image_of: of.key, ..Self::free(xyz) }
    }

    /// The point of `curve` at `t`; on a snake also with its parameters on the surface.
    ///
    /// At t = 0 or 1 to the bit it is the end of the curve: its key is that of the point object that the
    /// curve ends at, if there is one, or that of the end itself, so that meshes join there.
    pub fn on_curve(curve: CurveRef<T>, t: T) -> Self {
        let key = match t.re() {
            0.0 => curve.end_points()[0],
            1.0 => curve.end_points()[1],
            _ => None,
        };
        let xyz = curve.jet(t, Order::Zero)[0];
        let on_surface = curve.surface.as_ref().and_then(|surface| {
            let w = curve.on_surface(t, Order::Zero)?[0];
            Some(Arc::new((SurfaceRef::clone(surface), [w.x, w.y])))
        });
        let on_curve = Some(Arc::new((curve, t)));
        Self { xyz, key, on_curve, on_surface, image_of: None, found: None }
    }

    /// The point of `surface` at (`u`, `v`); at a corner it equals that corner to the bit, as for
    /// [`Point::on_curve`].
    pub fn on_surface(surface: SurfaceRef<T>, u: T, v: T) -> Self {
        let corner = match (u.re(), v.re()) {
            (0.0, 0.0) => Some(0),
            (1.0, 0.0) => Some(1),
            (1.0, 1.0) => Some(2),
            (0.0, 1.0) => Some(3),
            _ => None,
        };
        let key = corner.and_then(|k| surface.edges().corners[k].or(surface.key?.corner(k)));
        let xyz = surface.jet(u, v, Order::Zero).p;
        let on_surface = Some(Arc::new((surface, [u, v])));
        Self { xyz, key, on_curve: None, on_surface, image_of: None, found: None }
    }

    /// The same point with a report of its search.
    pub fn with_found(mut self, found: SearchReport) -> Self {
        self.found = Some(Arc::new(found));
        self
    }

    /// Nesting depth of the shapes that this point refers to.
    pub fn depth(&self) -> u32 {
        let curve = self.on_curve.as_ref().map_or(0, |p| p.0.depth);
        curve.max(self.on_surface.as_ref().map_or(0, |p| p.0.depth))
    }

    /// True when the positions have the same bits and the parameters belong to the same shapes with
    /// the same bits.
    pub fn same(&self, o: &Self) -> bool {
        let curves = match (&self.on_curve, &o.on_curve) {
            (Some(a), Some(b)) => a.1.bits_eq(b.1) && a.0.same(&b.0),
            (a, b) => a.is_none() && b.is_none(),
        };
        let surfaces = match (&self.on_surface, &o.on_surface) {
            (Some(a), Some(b)) => {
                a.1[0].bits_eq(b.1[0]) && a.1[1].bits_eq(b.1[1]) && a.0.same(&b.0)
            }
            (a, b) => a.is_none() && b.is_none(),
        };
        let places = self.xyz.bits_eq(o.xyz) && curves && surfaces;
        let names = self.key == o.key && self.image_of == o.image_of;
        places && names && self.found == o.found
    }
}

/// Figures of a construction about its own result, such as the greatest deviation of a faired
/// curve: members of the object.
pub type Figures = Arc<Vec<(&'static str, f64)>>;

/// Two edges of patches declared to be the same.
#[derive(Clone)]
pub struct DeclaredJoin<T: Real> {
    /// The edges.
    pub edges: [CurveRef<T>; 2],
    /// Maximum distance of the two edges.
    pub tolerance: f64,
    /// True if the whole edges coincide; otherwise one coincides with a part of the other.
    pub whole: bool,
}

/// A curve with the identity of its object.
#[derive(Clone)]
pub struct CurveRef<T: Real> {
    pub(crate) shape: Arc<dyn Curve<T>>,
    /// True when it is closed; computed on first use.
    pub(crate) closed: OnceLock<bool>,
    /// The object, once it has a name.
    pub key: Option<Key>,
    /// Surface of a snake.
    pub surface: Option<Box<SurfaceRef<T>>>,
    /// For a part of another curve with proportional parameter: the original curve, which is not
    /// such a part itself, and its parameters at the ends of the part.
    pub part_of: Option<Arc<(CurveRef<T>, [T; 2])>>,
    /// For the common edge of a declared join.
    pub joins: Option<Arc<DeclaredJoin<T>>>,
    /// For an intersection: the same curve as snakes on its surfaces.
    pub snakes: Arc<[CurveRef<T>]>,
    /// Report of the search, if there was one.
    pub found: Option<Arc<SearchReport>>,
    /// Figures of its construction.
    pub figures: Option<Figures>,
    /// Nesting depth of its shapes, itself included.
    pub depth: u32,
}

/// A surface with the identity of its object.
#[derive(Clone)]
pub struct SurfaceRef<T: Real> {
    pub(crate) shape: Arc<dyn Surface<T>>,
    /// Which parameters are closed; computed on first use.
    pub(crate) closed: OnceLock<[bool; 2]>,
    /// Which seams are smooth; computed on first use.
    pub(crate) smooth_seams: OnceLock<[bool; 2]>,
    /// The object, once it has a name.
    pub key: Option<Key>,
    /// Report of the search or fit, if there was one.
    pub found: Option<Arc<SearchReport>>,
    /// Figures of its construction.
    pub figures: Option<Figures>,
    /// For a fillet: the contact lines, snakes on both surfaces, at v = 0 and v = 1.
    pub contacts: Option<Arc<[CurveRef<T>; 2]>>,
    /// For a part of another surface: that surface and the sides of the part on it.
    pub part_of: Option<Arc<SurfacePart<T>>>,
    /// Nesting depth of its shapes, itself included.
    pub depth: u32,
}

/// A part of a surface.
pub struct SurfacePart<T: Real> {
    /// The whole surface.
    pub surface: SurfaceRef<T>,
    /// The snakes on it along the edges v = 0, u = 1, v = 1, u = 0 of the part; none along an edge that is one point of
    /// its parameter plane.
    pub sides: [Option<CurveRef<T>>; 4],
}

/// An implicit function or set that can be compared with another.
pub trait ImplicitFunction<T: Real>: Field<T> + Any {
    /// True when both are the same expression of the same bits under the same names.
    fn alike(&self, o: &Self) -> bool;
    /// A number by which those that are not alike mostly differ.
    fn fingerprint(&self) -> u64;
}

/// An [`ImplicitFunction`] whose type was forgotten.
trait Erased<T: Real>: Field<T> + Any {
    fn alike_any(&self, o: &dyn Any) -> bool;
    fn print(&self) -> u64;
}

impl<T: Real, P: ImplicitFunction<T>> Erased<T> for P {
    fn alike_any(&self, o: &dyn Any) -> bool {
        o.downcast_ref::<P>().is_some_and(|o| self.alike(o))
    }
    fn print(&self) -> u64 {
        self.fingerprint()
    }
}

/// An implicit function.
#[derive(Clone)]
pub struct FieldRef<T: Real> {
    shape: Arc<dyn Erased<T>>,
    /// The name of its declaration.
    pub name: Option<Arc<str>>,
}

/// A set of points: solid where its value is negative.
#[derive(Clone)]
pub struct SetRef<T: Real> {
    shape: Arc<dyn Erased<T>>,
}

/// A law that redistributes a parameter.
#[derive(Clone)]
pub struct ReparametrizationRef<T: Real> {
    shape: Arc<dyn Reparametrization<T>>,
    /// The object, once it has a name.
    pub key: Option<Key>,
    /// Nesting depth of its shapes, itself included.
    pub depth: u32,
}

/// A solid with the identity of its object.
#[derive(Clone)]
pub struct SolidRef<T: Real> {
    shape: Arc<dyn Solid<T>>,
    /// The object, once it has a name.
    pub key: Option<Key>,
    /// Nesting depth of its shapes, itself included.
    pub depth: u32,
}

macro_rules! shape_ref {
    // As itself, where it knows more than the shape that it holds; else as that shape.
    ($name:ident, $shape:ident, $as:ident => $of:expr) => {
        impl<T: Real> Deref for $name<T> {
            type Target = dyn $shape<T>;
            fn deref(&self) -> &Self::Target {
                let $as = self;
                $of
            }
        }

        impl<T: Real> $name<T> {
            /// True when both are the very same shape under the same name.
            pub fn same(&self, o: &Self) -> bool {
                Arc::ptr_eq(&self.shape, &o.shape)
            }
        }

        impl<T: Real> std::fmt::Debug for $name<T> {
            fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str(stringify!($name))
            }
        }
    };
}
shape_ref!(CurveRef, Curve, itself => itself);
shape_ref!(SurfaceRef, Surface, itself => itself);
shape_ref!(ReparametrizationRef, Reparametrization, own => &*own.shape);
shape_ref!(SolidRef, Solid, own => &*own.shape);

impl<T: Real> CurveRef<T> {
    /// A curve that refers to shapes with nesting depth `nesting` (0 if none).
    pub fn new(shape: impl Curve<T> + 'static, nesting: u32) -> Self {
        let shape: Arc<dyn Curve<T>> = Arc::new(shape);
        let depth = nesting + 1;
        Self {
            shape,
            closed: OnceLock::new(),
            key: None,
            surface: None,
            part_of: None,
            joins: None,
            snakes: Arc::new([]),
            found: None,
            figures: None,
            depth,
        }
    }

    /// A snake on `surface`.
    pub fn snake(shape: impl Curve<T> + 'static, surface: SurfaceRef<T>, nesting: u32) -> Self {
        let depth = nesting.max(surface.depth) + 1;
        Self { surface: Some(Box::new(surface)), ..Self::new(shape, depth - 1) }
    }

    /// The same curve with a report of its search.
    pub fn with_found(mut self, found: SearchReport) -> Self {
        self.found = Some(Arc::new(found));
        self
    }

    /// The same curve with its figures.
    pub fn with_figures(mut self, figures: &[(&'static str, f64)]) -> Self {
        self.figures = Some(Arc::new(figures.to_vec()));
        self
    }

    /// The position at a parameter that is a jet.
    #[inline(always)]
    pub fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        lift_curve(&self.jet(t.value(), J::ORDER), t)
    }

    /// The position at the end `t` = 0 or 1.
    pub fn end(&self, t: f64) -> Vec3<T> {
        self.shape.jet(T::from(t), Order::Zero)[0]
    }

    /// The roots along it; empty for a nameless curve that is not an alias.
    pub fn pieces(&self) -> SmallVec<[Piece<T>; 1]> {
        match (self.shape.trace(), self.key) {
            (Trace::Own(_), None) => SmallVec::new(),
            // A ring begins and ends in one point.
            (Trace::Own([None, None]), Some(key)) if self.shape.closed() => {
                Trace::Own([key.end(0); 2]).pieces(Root::Curve(key))
            }
            (trace, key) => trace.pieces(Root::Curve(key.unwrap_or(Key(u32::MAX)))),
        }
    }

    /// The points at its two ends: the end's point object if there is one, otherwise the corner of
    /// the surface or the end of the curve that it follows, otherwise its own end. A closed curve
    /// of a kind that closes it has one point.
    pub fn end_points(&self) -> [Option<Key>; 2] {
        let own = |k: usize| self.key.and_then(|key| key.end(k));
        match self.shape.trace() {
            Trace::Own([None, None]) if self.shape.closed() => [own(0); 2],
            Trace::Own([from, to]) => [from.or_else(|| own(0)), to.or_else(|| own(1))],
            Trace::Point(point) => [point, point],
            Trace::Pieces(pieces) => {
                let [from, to] = [
                    pieces.first().map(|p| (p.root, p.from)),
                    pieces.last().map(|p| (p.root, p.to)),
                ];
                let end = |piece: Option<(Root, moldloft_num::trace::Mark<T>)>, k: usize| {
                    let (root, mark) = piece?;
                    mark.point.or_else(|| root.end(mark.t.re())).or_else(|| own(k))
                };
                [end(from, 0), end(to, 1)]
            }
        }
    }

    /// Origin of its shape, for joins: the object itself or, without a name, the original of the
    /// image.
    pub fn made_of(&self) -> Vec<Key> {
        self.key.or_else(|| self.shape.image_of()).into_iter().collect()
    }
}

impl<T: Real> SurfaceRef<T> {
    /// A surface that refers to shapes with nesting depth `nesting` (0 if none).
    pub fn new(shape: impl Surface<T> + 'static, nesting: u32) -> Self {
        let depth = nesting + 1;
        Self {
            shape: Arc::new(shape),
            closed: OnceLock::new(),
            smooth_seams: OnceLock::new(),
            key: None,
            found: None,
            figures: None,
            contacts: None,
            part_of: None,
            depth,
        }
    }

    /// The same surface as a fillet between two snakes.
    pub fn with_contacts(mut self, contacts: [CurveRef<T>; 2]) -> Self {
        self.contacts = Some(Arc::new(contacts));
        self
    }

    /// The same surface as a part of another.
    pub fn with_part_of(mut self, part: Option<SurfacePart<T>>) -> Self {
        self.part_of = part.map(Arc::new);
        self
    }

    /// The same surface with a report of its search.
    pub fn with_found(mut self, found: SearchReport) -> Self {
        self.found = Some(Arc::new(found));
        self
    }

    /// The same surface with its figures.
    pub fn with_figures(mut self, figures: &[(&'static str, f64)]) -> Self {
        self.figures = Some(Arc::new(figures.to_vec()));
        self
    }

    /// The position at parameters that are jets.
    #[inline(always)]
    pub fn at<J: Jet<T>>(&self, u: J, v: J) -> Vec3<J> {
        lift_surface(&self.jet(u.value(), v.value(), J::ORDER), u, v)
    }
}

impl<T: Real> SolidRef<T> {
    /// A solid that refers to shapes with nesting depth `nesting` (0 if none).
    pub fn new(shape: impl Solid<T> + 'static, nesting: u32) -> Self {
        Self { shape: Arc::new(shape), key: None, depth: nesting + 1 }
    }
}

macro_rules! implicit_ref {
    ($name:ident, $what:literal) => {
        impl<T: Real> Deref for $name<T> {
            type Target = dyn Field<T>;
            fn deref(&self) -> &Self::Target {
                &*self.shape
            }
        }

        impl<T: Real> $name<T> {
            /// The original, if it is a `P`.
            pub fn get<P: ImplicitFunction<T>>(&self) -> Option<&P> {
                let any: &dyn Any = &*self.shape;
                any.downcast_ref()
            }

            /// See [`ImplicitFunction::fingerprint`].
            pub fn fingerprint(&self) -> u64 {
                self.shape.print()
            }
        }

        impl<T: Real> std::fmt::Debug for $name<T> {
            fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str($what)
            }
        }
    };
}
implicit_ref!(FieldRef, "FieldRef");
implicit_ref!(SetRef, "SetRef");

impl<T: Real> FieldRef<T> {
    /// An implicit function without a name.
    pub fn new(shape: impl ImplicitFunction<T>) -> Self {
        Self { shape: Arc::new(shape), name: None }
    }

    /// The same function under a name.
    pub fn called(mut self, name: &str) -> Self {
        self.name = Some(name.into());
        self
    }

    /// True when both are the same function under the same name.
    pub fn same(&self, o: &Self) -> bool {
        self.name == o.name
            && (Arc::ptr_eq(&self.shape, &o.shape) || self.shape.alike_any(&*o.shape))
    }
}

impl<T: Real> SetRef<T> {
    /// A set.
    pub fn new(shape: impl ImplicitFunction<T>) -> Self {
        Self { shape: Arc::new(shape) }
    }

    /// True when both are the same set with the same attributes.
    pub fn same(&self, o: &Self) -> bool {
        Arc::ptr_eq(&self.shape, &o.shape) || self.shape.alike_any(&*o.shape)
    }
}

impl<T: Real> ReparametrizationRef<T> {
    /// A law that refers to shapes with nesting depth `nesting` (0 if none).
    pub fn new(law: impl Reparametrization<T> + 'static, nesting: u32) -> Self {
        Self { shape: Arc::new(law), key: None, depth: nesting + 1 }
    }

    /// As `new`, for a law with other owners.
    pub fn shared(law: Arc<dyn Reparametrization<T>>, nesting: u32) -> Self {
        Self { shape: law, key: None, depth: nesting + 1 }
    }

    /// The law itself.
    pub fn law(&self) -> &Arc<dyn Reparametrization<T>> {
        &self.shape
    }

    /// R at a parameter that is a jet.
    #[inline(always)]
    pub fn at<J: Jet<T>>(&self, t: J) -> J {
        lift_reparametrization(&self.shape.jet(t.value(), J::ORDER), t)
    }

    /// R and its derivatives at `t`.
    #[inline(always)]
    pub fn jet(&self, t: T, order: Order) -> ReparametrizationJet<T> {
        self.shape.jet(t, order)
    }
}
