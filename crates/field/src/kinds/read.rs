//! Implicit arguments (fields, sets and values convertible to them), results and errors.

use crate::{FieldError, Primitive, Set};
use moldloft_num::{Field, Real, Vec3};
use moldloft_registry::{CallError, Class, FieldRef, FromValue, ImplicitFunction, SetRef, Value};
use std::sync::Arc;

impl<T: Real> ImplicitFunction<T> for Primitive<T> {
    fn alike(&self, o: &Self) -> bool {
        self.same(o)
    }
    fn fingerprint(&self) -> u64 {
        self.0.fingerprint
    }
}

impl<T: Real> Field<T> for Set<T> {
    fn value_and_gradient(&self, p: Vec3<T>) -> (T, Vec3<T>) {
        match self.winner(p) {
            (value, None) => (value, Vec3::zero()),
            (_, Some(leaf)) => {
                let g = self.leaves()[leaf].primitive.gradient(p);
                (g.value, g.slope)
            }
        }
    }
    fn value(&self, p: Vec3<T>) -> T {
        Set::value(self, p)
    }

    moldloft_num::field_facts!(T: second_by_differences, no_bounds);
}

impl<T: Real> ImplicitFunction<T> for Set<T> {
    fn alike(&self, o: &Self) -> bool {
        self.same(o)
    }
    fn fingerprint(&self) -> u64 {
        Set::fingerprint(self)
    }
}

/// A primitive as a value of the language.
pub fn field_value<T: Real>(primitive: Primitive<T>) -> Value<T> {
    Value::Field(FieldRef::new(primitive))
}

/// A set as a value of the language.
pub fn set_value<T: Real>(set: Set<T>) -> Value<T> {
    Value::Set(SetRef::new(set))
}

/// The primitive of a value: a field, a plane (the half-space behind it), a number (a constant).
pub fn primitive_of<T: Real>(value: &Value<T>) -> Option<Primitive<T>> {
    match value {
        Value::Field(f) => f.get::<Primitive<T>>().cloned(),
        Value::Number(x) if x.is_finite() => Some(Primitive::real(*x)),
        Value::Plane(p) => Primitive::plane(p.normal, p.point).ok(),
        _ => None,
    }
}

/// The set of a value: a set, or the solid side of a field or plane. Faces of a field have the name
/// of the field.
pub fn set_of<T: Real>(value: &Value<T>) -> Option<Set<T>> {
    match value {
        Value::Set(s) => s.get::<Set<T>>().cloned(),
        Value::Field(f) => {
            let set = Set::new(f.get::<Primitive<T>>()?);
            Some(match &f.name {
                Some(name) => set.named(name),
                None => set,
            })
        }
        Value::Plane(_) => primitive_of(value).map(|p| Set::new(&p)),
        _ => None,
    }
}

/// A field with the name that it was declared under.
pub struct NamedField<T: Real> {
    pub primitive: Primitive<T>,
    pub name: Option<Arc<str>>,
}

impl<T: Real> NamedField<T> {
    /// It as a value again.
    pub fn value(self) -> Value<T> {
        let mut field = FieldRef::new(self.primitive);
        field.name = self.name;
        Value::Field(field)
    }
}

impl<T: Real> FromValue<T> for NamedField<T> {
    const CLASS: Class = Class::Field;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let name = match value {
            Value::Field(f) => f.name.clone(),
            _ => None,
        };
        match primitive_of(value) {
            Some(primitive) => Ok(Self { primitive, name }),
            None => Err(CallError::wrong_class(Class::Field, value.class())),
        }
    }
}

/// A set, or the solid side of a field.
pub struct SetArgument<T: Real>(pub Set<T>);

impl<T: Real> FromValue<T> for SetArgument<T> {
    const CLASS: Class = Class::Set;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match set_of(value) {
            Some(set) => Ok(Self(set)),
            None => Err(CallError::wrong_class(Class::Set, value.class())),
        }
    }
}

/// The error with its remedy.
pub fn fault(error: &FieldError) -> CallError {
    let id = match error {
        FieldError::NotFinite { .. } => "not-finite",
        FieldError::NotPositive { .. }
        | FieldError::Exponent { .. }
        | FieldError::Lambda { .. } => "out-of-range",
        FieldError::Degenerate { .. } => "degenerate",
        FieldError::Division => "field-division",
        FieldError::RailsMeet { .. } => "rails-meet",
        FieldError::RailInside { .. } => "rail-inside",
        FieldError::RailSingular { .. } => "rail-singular",
        FieldError::EmptyBox { .. } => "empty-box",
        FieldError::Unbounded { .. } => "unbounded-set",
        FieldError::TooFine { .. } | FieldError::TooRough { .. } | FieldError::FarAway { .. } => {
            "too-fine"
        }
        FieldError::ThinBox { .. } => "thin-box",
        FieldError::Thin { .. } => "thin-part",
        FieldError::NotReached { .. } => "accuracy-not-reached",
        FieldError::NotClosed { .. } => "not-closed",
        FieldError::ManyFaces { .. } | FieldError::RoundSides | FieldError::HiddenEdge { .. } => {
            "faces-tangled"
        }
        FieldError::NoDistance { .. } => "no-distance",
        FieldError::NoHull { .. } => "no-hull",
        FieldError::NoEdge { .. } => "no-edge",
        FieldError::Outside => "no-text",
        FieldError::Spent(spent) => spent.id(),
        FieldError::NoValue { .. } => "no-value",
    };
    if let FieldError::Spent(spent) = error {
        return (*spent).into();
    }
    let fault = CallError::new(id, error.to_string());
    match error {
        FieldError::Division => {
            fault.help("divide by a number, or by a field that is not 0 everywhere")
        }
        FieldError::Exponent { .. } => {
            fault.expected("a whole number from 0 to 1000").help("roots are sqrt() and s_sqrt()")
        }
        FieldError::Lambda { .. } => fault.expected("a number above 0 and below 1"),
        FieldError::RailsMeet { .. } => fault.help("separate the rails, or use a smaller box"),
        FieldError::RailInside { .. } => {
            fault.help("a rail must cut each body outside the other: move it outward")
        }
        FieldError::Unbounded { .. } => {
            fault.expected("a box: {low corner}, {high corner}").help("or cut it with planes")
        }
        FieldError::TooFine { .. } => fault.help("use a coarser accuracy, or a smaller box"),
        FieldError::TooRough { .. } => fault.help("use a set without such waves, or a smaller box"),
        FieldError::ThinBox { depth, .. } => {
            fault.expected(format!("a depth of {depth} or more, or a thicker box"))
        }
        FieldError::Thin { depth, .. } => {
            fault.help(format!("give `depth = {depth}`, or thicken it"))
        }
        FieldError::NotClosed { .. } => fault.expected("a closed, oriented body"),
        FieldError::ManyFaces { .. } | FieldError::RoundSides => {
            fault.help("take set(inside(body)), the set by distances from its triangles")
        }
        FieldError::HiddenEdge { .. } => {
            fault.help("cut the edge off, or take `minkowski_sum` with a ball: its edges are round")
        }
        FieldError::NoHull { .. } => fault.expected(
            "bounded polyhedra and balls; polyhedra, cylinders and cones of one axis direction; or cylinders, cones, tori and balls about one axis",
        ),
        FieldError::EmptyBox { .. } => {
            fault.expected("low and high corners that differ along x, y and z")
        }
        _ => fault,
    }
}

/// A primitive as the value of a row, or its error as a fault.
pub fn field<T: Real>(primitive: Result<Primitive<T>, FieldError>) -> Result<Value<T>, CallError> {
    primitive.map(field_value).map_err(|e| fault(&e))
}

/// A set as the value of a row, or its error as a fault.
pub fn set<T: Real>(set: Result<Set<T>, FieldError>) -> Result<Value<T>, CallError> {
    set.map(set_value).map_err(|e| fault(&e))
}
