//! The values of the language: numbers, text, arrays, located points, shapes, sets, bodies, families of contours.

use crate::{
    Class, CurveRef, FieldRef, LocusRef, Point, Remark, ReparametrizationRef, SearchReport, SetRef,
    SolidRef, SurfaceRef, TriangleBody,
};
use moldloft_num::trace::Key;
use moldloft_num::{Axis, Frame, Plane, Real, Vec3};
use std::sync::Arc;

/// A row `[n]` or a grid `[m, n]` of numbers or other items. Memory order is that of NumPy: the
/// last index runs fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Array<E> {
    /// The extents.
    pub shape: ArrayShape,
    /// The elements, `[i * n + j]`.
    pub items: Vec<E>,
}

/// The extents of an [`Array`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrayShape {
    /// `[n]`.
    Row(usize),
    /// `[m, n]`.
    Grid(usize, usize),
}

/// A row `[n]` or a grid `[m, n]` of vectors, stored as three planes of components, so that
/// operations on all x, all y and all z run at memory speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Vectors<T> {
    /// The extents; one or two of them.
    pub shape: ArrayShape,
    /// All x, all y, all z, each in the order of [`Array::items`].
    pub planes: [Vec<T>; 3],
}

impl<T: Copy> Vectors<T> {
    /// An array of that shape.
    ///
    /// # Panics
    /// When the number of points does not fit the shape.
    pub fn new(shape: ArrayShape, points: impl IntoIterator<Item = Vec3<T>>) -> Self {
        let points = points.into_iter();
        let count = shape.count();
        let mut planes = [(); 3].map(|()| Vec::with_capacity(count));
        for p in points {
            planes[0].push(p.x);
            planes[1].push(p.y);
            planes[2].push(p.z);
        }
        assert_eq!(planes[0].len(), count);
        Self { shape, planes }
    }

    /// A row.
    pub fn row(points: Vec<Vec3<T>>) -> Self {
        Self::new(ArrayShape::Row(points.len()), points)
    }

    /// A grid of `m` by `n`.
    ///
    /// # Panics
    /// When there are not `m * n` points.
    pub fn grid(m: usize, n: usize, points: Vec<Vec3<T>>) -> Self {
        Self::new(ArrayShape::Grid(m, n), points)
    }

    /// An array with all vectors equal.
    pub fn filled(shape: ArrayShape, v: Vec3<T>) -> Self {
        Self { shape, planes: [v.x, v.y, v.z].map(|x| vec![x; shape.count()]) }
    }

    /// The number of vectors.
    pub fn len(&self) -> usize {
        self.planes[0].len()
    }

    /// True if empty.
    pub fn is_empty(&self) -> bool {
        self.planes[0].is_empty()
    }

    /// Vector `k`, counted from 0 in the order of memory.
    pub fn at(&self, k: usize) -> Vec3<T> {
        let [x, y, z] = &self.planes;
        Vec3 { x: x[k], y: y[k], z: z[k] }
    }

    /// Replaces vector `k`.
    pub fn set(&mut self, k: usize, v: Vec3<T>) {
        let [x, y, z] = &mut self.planes;
        (x[k], y[k], z[k]) = (v.x, v.y, v.z);
    }

    /// All vectors in the order of memory.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Vec3<T>> + DoubleEndedIterator + '_ {
        (0..self.len()).map(|k| self.at(k))
    }

    /// All vectors in the order of memory.
    pub fn points(&self) -> Vec<Vec3<T>> {
        self.iter().collect()
    }
}

impl ArrayShape {
    /// The number of elements.
    pub fn count(self) -> usize {
        match self {
            ArrayShape::Row(n) => n,
            ArrayShape::Grid(m, n) => m * n,
        }
    }
}

impl<E> Array<E> {
    /// A row.
    pub fn row(items: Vec<E>) -> Self {
        Self { shape: ArrayShape::Row(items.len()), items }
    }

    /// A grid of `m` by `items.len() / m`.
    pub fn grid(m: usize, n: usize, items: Vec<E>) -> Self {
        assert_eq!(m * n, items.len());
        Self { shape: ArrayShape::Grid(m, n), items }
    }
}

impl std::fmt::Display for ArrayShape {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            ArrayShape::Row(n) => write!(f, "[{n}]"),
            ArrayShape::Grid(m, n) => write!(f, "[{m},{n}]"),
        }
    }
}

/// Family of contours: on each member, this quantity is constant.
#[derive(Clone, Debug, PartialEq)]
pub enum Family<T> {
    /// The distance from a plane, along its normal.
    Planes(Plane<T>),
    /// The distance from a line: cylinders about it.
    Cylinders(Axis<T>),
    /// The angle about a line, right-handed, from the half-plane on the side of the unit vector
    /// `zero`, which is normal to the line: half-planes.
    Angles {
        /// The line.
        axis: Axis<T>,
        /// The direction of angle 0.
        zero: Vec3<T>,
    },
}

/// Components of unit vectors below this are zero in the search for mirror images.
const SYMMETRIC: f64 = 1e-12;

/// The axis of contours that are not planes of constant x, y or z.
pub const OBLIQUE: usize = 3;

/// A family of sections.
#[derive(Clone, Debug, PartialEq)]
pub struct Contours<T> {
    /// Axis of the sections' common normal: 0, 1, 2 for X, Y, Z, or [`OBLIQUE`].
    pub axis: usize,
    /// The quantity that is constant on each section.
    pub family: Family<T>,
    /// The values: coordinates, distances, radii, or angles in radians.
    pub values: Vec<T>,
}

impl<T: Real> Family<T> {
    /// Planes on which the coordinate 0, 1 or 2 is constant.
    pub fn coordinate(axis: usize) -> Self {
        let mut normal = [0.0; 3];
        normal[axis] = 1.0;
        Family::Planes(Plane { point: Vec3::zero(), normal: Vec3::lifted(normal.into()) })
    }

    fn parts(&self) -> [Vec3<T>; 3] {
        match self {
            Family::Planes(p) => [p.point, p.normal, Vec3::zero()],
            Family::Cylinders(a) => [a.point, a.direction, Vec3::zero()],
            Family::Angles { axis, zero } => [axis.point, axis.direction, *zero],
        }
    }

    /// A function of position that is zero on the section of that value and changes sign across it.
    pub fn height(&self, value: T, p: Vec3<T>) -> T {
        match self {
            Family::Planes(plane) => plane.distance(p) - value,
            Family::Cylinders(axis) => (p - axis.foot(p)).norm() - value,
            Family::Angles { axis, zero } => {
                let across = axis.direction.cross(*zero);
                let d = p - axis.point;
                d.dot(across) * value.cos() - d.dot(*zero) * value.sin()
            }
        }
    }

    /// The slope of [`Self::height`] at a point; zero on the axis of cylinders.
    pub fn gradient(&self, value: T, p: Vec3<T>) -> Vec3<T> {
        match self {
            Family::Planes(plane) => plane.normal,
            Family::Cylinders(axis) => {
                let away = p - axis.foot(p);
                if away.re().norm_sq() > 0.0 { away / away.norm() } else { Vec3::zero() }
            }
            Family::Angles { axis, zero } => {
                axis.direction.cross(*zero) * value.cos() - *zero * value.sin()
            }
        }
    }

    /// The unit normal of the section `value`, if it is a plane.
    pub fn normal(&self, value: T) -> Option<Vec3<T>> {
        match self {
            Family::Cylinders(_) => None,
            _ => Some(self.gradient(value, Vec3::zero())),
        }
    }

    /// True when the reflection in the coordinate plane `axis` = 0 maps each section to itself, and
    /// no section is that plane.
    pub fn is_symmetric(&self, axis: usize) -> bool {
        let across = |v: Vec3<T>| v.re()[axis].abs() <= SYMMETRIC;
        let along = |v: Vec3<T>| v.re()[axis].abs() >= 1.0 - SYMMETRIC;
        match self {
            Family::Planes(plane) => across(plane.normal),
            Family::Cylinders(line) => {
                let size = line.point.re().norm().max(1.0);
                along(line.direction)
                    || across(line.direction) && line.point.re()[axis].abs() <= SYMMETRIC * size
            }
            Family::Angles { axis: line, .. } => along(line.direction),
        }
    }

    /// True where a zero of [`Self::height`] belongs to the section: for angles, the half-plane on
    /// the right side of the axis.
    pub fn holds(&self, value: T, p: Vec3<T>) -> bool {
        match self {
            Family::Angles { axis, zero } => {
                let across = axis.direction.cross(*zero);
                let d = p - axis.point;
                let along = d.dot(*zero) * value.cos() + d.dot(across) * value.sin();
                along.re() >= -1e-12 * d.re().norm()
            }
            _ => true,
        }
    }
}

/// Any value of an expression, an argument or an object.
#[derive(Clone, Debug)]
pub enum Value<T: Real> {
    /// An omitted argument without a default (`*` in a model file).
    Unset,
    /// A number.
    Number(T),
    /// A text.
    Text(Arc<str>),
    /// A vector.
    Vector(Vec3<T>),
    /// A row or grid of numbers.
    Numbers(Arc<Array<T>>),
    /// A row or grid of vectors.
    Vectors(Arc<Vectors<T>>),
    /// A list.
    List(Arc<[Value<T>]>),
    /// A grid `[l, m, n]` of numbers or vectors, as its layers k: one or more grids of the same
    /// shape and class.
    Block(Arc<[Value<T>]>),
    /// Members by name.
    Record(Arc<Record<T>>),
    /// A declared object that has not been read.
    Object(Key),
    /// A point, bead, magnet or ring.
    Point(Box<Point<T>>),
    /// A curve or snake.
    Curve(CurveRef<T>),
    /// A surface.
    Surface(SurfaceRef<T>),
    /// A solid.
    Solid(SolidRef<T>),
    /// A plane.
    Plane(Arc<Plane<T>>),
    /// A frame.
    Frame(Arc<Frame<T>>),
    /// Plane sections.
    Contours(Arc<Contours<T>>),
    /// A law that redistributes a parameter.
    Relabel(ReparametrizationRef<T>),
    /// An implicit function.
    Field(FieldRef<T>),
    /// A set of points: a combination of implicit solids.
    Set(SetRef<T>),
    /// A body of triangles.
    Body(Arc<TriangleBody<T>>),
    /// Position of a point as a function of a bead's parameter, for kinds that sweep one.
    Locus(LocusRef<T>),
}

/// A record: members by name, of a type declared by a program.
#[derive(Clone, Debug)]
pub struct Record<T: Real> {
    /// The name of the type.
    pub of: Arc<str>,
    /// The names of the members, in the order of their declaration.
    pub names: Arc<[Arc<str>]>,
    /// The members' values, in the same order.
    pub values: Vec<Value<T>>,
}

impl<T: Real> Record<T> {
    /// The index of the member of that name.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|own| **own == *name)
    }
}

impl<T: Real> Value<T> {
    /// A text.
    pub fn text(text: &str) -> Self {
        Value::Text(text.into())
    }

    /// A list.
    pub fn list(items: impl IntoIterator<Item = Value<T>>) -> Self {
        Value::List(items.into_iter().collect())
    }

    /// The block of these layers; `None` unless they are grids of one shape, all of numbers or all of vectors.
    pub fn block(layers: impl IntoIterator<Item = Value<T>>) -> Option<Self> {
        let layers: Arc<[Value<T>]> = layers.into_iter().collect();
        let of = |layer: &Value<T>| match layer {
            Value::Vectors(a) => Some((true, a.shape)),
            Value::Numbers(a) => Some((false, a.shape)),
            _ => None,
        };
        let first =
            of(layers.first()?).filter(|(_, shape)| matches!(shape, ArrayShape::Grid(..)))?;
        layers.iter().all(|layer| of(layer) == Some(first)).then_some(Value::Block(layers))
    }

    /// The value with each number mapped, in memory order; for a point, its position. `None` for
    /// values other than numbers and texts: shapes, planes, sets.
    pub fn map_numbers<S: Real>(&self, map: &mut impl FnMut(T) -> S) -> Option<Value<S>> {
        let mut vector = |v: Vec3<T>| {
            let [x, y, z] = v.to_array();
            Vec3::new(map(x), map(y), map(z))
        };
        Some(match self {
            Value::Unset => Value::Unset,
            Value::Text(text) => Value::Text(text.clone()),
            Value::Number(x) => Value::Number(map(*x)),
            Value::Vector(v) => Value::Vector(vector(*v)),
            Value::Point(p) => Value::Vector(vector(p.xyz)),
            Value::Numbers(a) => Value::Numbers(Arc::new(Array {
                shape: a.shape,
                items: a.items.iter().map(|&x| map(x)).collect(),
            })),
            Value::Vectors(a) => {
                Value::Vectors(Arc::new(Vectors::new(a.shape, a.iter().map(vector))))
            }
            Value::List(items) => {
                let items: Option<Vec<_>> = items.iter().map(|v| v.map_numbers(map)).collect();
                Value::list(items?)
            }
            Value::Block(layers) => {
                let layers: Option<Vec<_>> = layers.iter().map(|v| v.map_numbers(map)).collect();
                Value::block(layers?)?
            }
            _ => return None,
        })
    }

    /// All numbers, in the order of [`Self::map_numbers`].
    pub fn numbers(&self) -> Option<Vec<T>> {
        let mut all = Vec::new();
        self.map_numbers(&mut |x: T| {
            all.push(x);
            x
        })?;
        Some(all)
    }

    /// The class of the value; `Any` for an object that has not been read.
    pub fn class(&self) -> Class {
        match self {
            Value::Unset | Value::Object(_) => Class::Any,
            Value::Number(_) => Class::Number,
            Value::Text(_) => Class::Text,
            Value::Vector(_) => Class::Vector,
            Value::Numbers(_) => Class::Numbers,
            Value::Vectors(_) => Class::Vectors,
            Value::List(_) => Class::List,
            Value::Block(_) => Class::Block,
            Value::Record(_) => Class::Record,
            Value::Point(p) => match (&p.on_curve, &p.on_surface) {
                (Some(_), Some(_)) => Class::Ring,
                (Some(_), None) => Class::Bead,
                (None, Some(_)) => Class::Magnet,
                (None, None) => Class::Point,
            },
            Value::Curve(c) if c.surface.is_some() => Class::Snake,
            Value::Curve(_) => Class::Curve,
            Value::Surface(_) => Class::Surface,
            Value::Solid(_) => Class::Solid,
            Value::Plane(_) => Class::Plane,
            Value::Frame(_) => Class::Frame,
            Value::Contours(_) => Class::Contours,
            Value::Relabel(_) => Class::Relabel,
            Value::Field(_) => Class::Field,
            Value::Set(_) => Class::Set,
            Value::Body(_) => Class::Mesh,
            Value::Locus(_) => Class::Point,
        }
    }

    /// True when both have the same bits, the same objects and identical shapes.
    pub fn same(&self, o: &Self) -> bool {
        match (self, o) {
            (Value::Unset, Value::Unset) => true,
            (Value::Number(a), Value::Number(b)) => a.bits_eq(*b),
            (Value::Text(a), Value::Text(b)) => a == b,
            (Value::Vector(a), Value::Vector(b)) => a.bits_eq(*b),
            (Value::Numbers(a), Value::Numbers(b)) => {
                Arc::ptr_eq(a, b)
                    || a.shape == b.shape
                        && a.items.iter().zip(&b.items).all(|(x, y)| x.bits_eq(*y))
            }
            (Value::Vectors(a), Value::Vectors(b)) => {
                let bits = |(x, y): (&Vec<T>, &Vec<T>)| x.iter().zip(y).all(|(x, y)| x.bits_eq(*y));
                Arc::ptr_eq(a, b) || a.shape == b.shape && a.planes.iter().zip(&b.planes).all(bits)
            }
            (Value::List(a), Value::List(b)) | (Value::Block(a), Value::Block(b)) => {
                a.len() == b.len() && a.iter().zip(b.iter()).all(|(x, y)| x.same(y))
            }
            (Value::Record(a), Value::Record(b)) => {
                a.of == b.of && a.values.iter().zip(&b.values).all(|(x, y)| x.same(y))
            }
            (Value::Object(a), Value::Object(b)) => a == b,
            (Value::Point(a), Value::Point(b)) => a.same(b),
            (Value::Curve(a), Value::Curve(b)) => a.same(b),
            (Value::Surface(a), Value::Surface(b)) => a.same(b),
            (Value::Solid(a), Value::Solid(b)) => a.same(b),
            (Value::Plane(a), Value::Plane(b)) => {
                a.point.bits_eq(b.point) && a.normal.bits_eq(b.normal)
            }
            (Value::Frame(a), Value::Frame(b)) => {
                a.origin.bits_eq(b.origin) && a.axes.iter().zip(&b.axes).all(|(x, y)| x.bits_eq(*y))
            }
            (Value::Contours(a), Value::Contours(b)) => {
                let pairs = a.family.parts().into_iter().zip(b.family.parts());
                std::mem::discriminant(&a.family) == std::mem::discriminant(&b.family)
                    && pairs.into_iter().all(|(x, y)| x.bits_eq(y))
                    && a.axis == b.axis
                    && a.values.len() == b.values.len()
                    && a.values.iter().zip(&b.values).all(|(x, y)| x.bits_eq(*y))
            }
            (Value::Relabel(a), Value::Relabel(b)) => a.same(b),
            (Value::Field(a), Value::Field(b)) => a.same(b),
            (Value::Set(a), Value::Set(b)) => a.same(b),
            (Value::Body(a), Value::Body(b)) => Arc::ptr_eq(a, b) || a.same(b),
            _ => false,
        }
    }

    /// Calls `f` with every object that the value refers to, in order.
    pub fn for_each_object(&self, f: &mut impl FnMut(Key)) {
        match self {
            Value::Object(key) => f(*key),
            Value::List(items) => items.iter().for_each(|item| item.for_each_object(f)),
            _ => {}
        }
    }

    /// Nesting depth of its shapes.
    pub fn depth(&self) -> u32 {
        match self {
            Value::Point(p) => p.depth(),
            Value::Curve(c) => c.depth,
            Value::Surface(s) => s.depth,
            Value::Relabel(r) => r.depth,
            Value::Solid(s) => s.depth,
            Value::List(items) => items.iter().map(Value::depth).max().unwrap_or(0),
            Value::Record(record) => record.values.iter().map(Value::depth).max().unwrap_or(0),
            _ => 0,
        }
    }

    /// The value with the name of an object, stored in shapes and points.
    pub fn named(mut self, key: Key) -> Self {
        match &mut self {
            // One that is an end of a curve by construction stays that end.
            Value::Point(p) => p.key = p.key.or(Some(key)),
            Value::Curve(c) => c.key = Some(key),
            Value::Surface(s) => s.key = Some(key),
            Value::Relabel(r) => r.key = Some(key),
            Value::Solid(s) => s.key = Some(key),
            _ => {}
        }
        self
    }

    /// Report of the search, if there was one.
    pub fn found(&self) -> Option<&Arc<SearchReport>> {
        match self {
            Value::Point(p) => p.found.as_ref(),
            Value::Curve(c) => c.found.as_ref(),
            Value::Surface(s) => s.found.as_ref(),
            _ => None,
        }
    }

    /// Figures of its construction, by name.
    pub fn figures(&self) -> &[(&'static str, f64)] {
        let all = match self {
            Value::Curve(c) => c.figures.as_ref(),
            Value::Surface(s) => s.figures.as_ref(),
            _ => None,
        };
        all.map_or(&[], |all| all.as_slice())
    }

    /// True when there is something to warn of.
    pub fn warns(&self) -> bool {
        match self {
            Value::Body(m) => !m.flaws.is_empty(),
            _ => self.found().is_some_and(|found| found.warns()),
        }
    }

    /// Warnings.
    pub fn remarks(&self) -> Vec<Remark> {
        match self {
            Value::Body(m) => m.flaws.iter().map(|f| f.remark.clone()).collect(),
            _ => self.found().and_then(|found| found.remark()).into_iter().collect(),
        }
    }

    /// The largest absolute value of its numbers and coordinates; zero for shapes. NaN and infinity
    /// are ignored.
    pub fn largest(&self) -> f64 {
        let of = |x: &T| Some(x.re().abs()).filter(|x| x.is_finite()).unwrap_or(0.0);
        let vector = |v: &Vec3<T>| of(&v.x).max(of(&v.y)).max(of(&v.z));
        match self {
            Value::Number(x) => of(x),
            Value::Vector(v) => vector(v),
            Value::Numbers(a) => a.items.iter().map(of).fold(0.0, f64::max),
            Value::Vectors(a) => a.planes.iter().flatten().map(of).fold(0.0, f64::max),
            Value::List(items) | Value::Block(items) => {
                items.iter().map(Value::largest).fold(0.0, f64::max)
            }
            Value::Record(record) => record.values.iter().map(Value::largest).fold(0.0, f64::max),
            Value::Point(p) => vector(&p.xyz),
            Value::Plane(p) => vector(&p.point),
            Value::Frame(f) => vector(&f.origin),
            _ => 0.0,
        }
    }

    /// True when every number in it, derivatives included, is finite.
    pub fn is_finite(&self) -> bool {
        match self {
            Value::Number(a) => a.is_finite(),
            Value::Vector(v) => v.is_finite(),
            Value::Numbers(a) => a.items.iter().all(|x| x.is_finite()),
            Value::Vectors(a) => a.planes.iter().flatten().all(|x| x.is_finite()),
            Value::List(items) | Value::Block(items) => items.iter().all(Value::is_finite),
            Value::Record(record) => record.values.iter().all(Value::is_finite),
            Value::Point(p) => p.xyz.is_finite(),
            Value::Plane(p) => p.point.is_finite() && p.normal.is_finite(),
            Value::Frame(f) => f.origin.is_finite() && f.axes.iter().all(|a| a.is_finite()),
            Value::Contours(c) => {
                let finite = c.family.parts().iter().all(|v| v.is_finite());
                finite && c.values.iter().all(|x| x.is_finite())
            }
            Value::Body(m) => m.is_finite(),
            _ => true,
        }
    }
}
