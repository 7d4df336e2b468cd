//! `area(hull)`, `volume(tank)`, `volume(side, lid)`, `distance(P, hull)`: functions of sets applied to objects that
//! have these numbers as members, and distances of points from points, curves and surfaces.

use crate::functions::enclosed;
use crate::run::interpreter::Interpreter;
use crate::source::fault_location::unplaced;
use moldloft_diag::Diagnostic;
use moldloft_num::Vec3;
use moldloft_registry::{CallError, Given, Scalar, Value};
use moldloft_relational::{distance_from_curve, distance_from_surface, separation};

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// The function `name` of sets for other shapes; `None` if the call has another meaning.
    pub fn shape_measure(
        &self,
        name: &str,
        given: &Given<T>,
    ) -> Option<Result<Value<T>, Diagnostic>> {
        if !given.named.is_empty() {
            return None;
        }
        match (name, &given.positional[..]) {
            ("area" | "volume", [shape]) => {
                let key = match shape {
                    Value::List(items) if name == "volume" => {
                        return self.shape_measure(
                            name,
                            &Given { positional: items.to_vec(), named: Vec::new() },
                        );
                    }
                    Value::Surface(surface) => surface.key,
                    Value::Solid(solid) => solid.key,
                    Value::Body(_) => return crate::value::member::of_value(shape, name),
                    _ => None,
                };
                crate::value::member::of_patch(self.run.graph().get(key?)?, name)
            }
            ("volume", shapes) => {
                let sides = enclosed::sides(shapes).filter(|sides| sides.len() > 1)?;
                Some(enclosed::enclosed(&sides).map(Value::Number))
            }
            ("distance", [a, b]) => {
                let found = match (place(a), place(b)) {
                    (Some(p), Some(q)) => Ok(separation(p, q)),
                    (Some(p), None) => distance_from(b, p)?,
                    (None, Some(q)) => distance_from(a, q)?,
                    (None, None) if is_shape(a) || is_shape(b) => {
                        return Some(Err(Diagnostic::error(
                            "wrong-class",
                            "a curve or surface has a distance from a point",
                        )
                        .expected("a point, or two sets")
                        .help("two shapes have a distance as bodies: `distance` of sets")));
                    }
                    (None, None) => return None,
                };
                Some(found.map(Value::Number).map_err(|fault| unplaced(&fault)))
            }
            _ => None,
        }
    }
}

fn is_shape<T: Scalar>(value: &Value<T>) -> bool {
    matches!(value, Value::Curve(_) | Value::Surface(_))
}

fn distance_from<T: Scalar>(shape: &Value<T>, point: Vec3<T>) -> Option<Result<T, CallError>> {
    match shape {
        Value::Curve(curve) => Some(distance_from_curve(curve, point)),
        Value::Surface(surface) => Some(distance_from_surface(surface, point)),
        _ => None,
    }
}

/// The position of a point or vector.
fn place<T: Scalar>(value: &Value<T>) -> Option<Vec3<T>> {
    match value {
        Value::Point(point) => Some(point.xyz),
        Value::Vector(place) => Some(*place),
        _ => None,
    }
}
