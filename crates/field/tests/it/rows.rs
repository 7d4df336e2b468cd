//! The rows: each is documented, reads its arguments, and carries derivatives and errors.

use moldloft_field::rows;
use moldloft_num::{Curve, CurveJet, Dual4, Order, Real, Vec3};
use moldloft_registry::{
    Class, Context, CurveRef, Given, Point, Registry, Row, Scalar, Value, bind_arguments,
};

/// The line from the origin along z.
struct Up;

impl<T: Real> Curve<T> for Up {
    fn jet(&self, t: T, _: Order) -> CurveJet<T> {
        let along = |z: T| Vec3::new(T::zero(), T::zero(), z);
        [along(t), along(T::one()), Vec3::zero()]
    }

    moldloft_num::curve_facts!(smooth, open, not_rational);
    moldloft_num::curve_one_by_one!(T);
}

/// Arguments for a row by the names of its fields.
fn arguments<T: Real>(row: &Row, radius: T) -> Vec<Value<T>> {
    row.fields
        .iter()
        .map(|f| match f.name {
            "axis" => Value::Curve(CurveRef::new(Up, 0)),
            "normal" | "along" => Value::Vector(Vec3::of(1.0, 0.0, 0.0)),
            "centre" | "point" => Value::Point(Box::new(Point::free(Vec3::zero()))),
            "radius" | "minor" => Value::Number(radius),
            "major" => Value::Number(T::from(2.0)),
            "angle" => Value::Number(T::from(0.5)),
            "change" => Value::Number(T::from(0.1)),
            "distance" => Value::Number(T::zero()),
            other => panic!("what is {other}?"),
        })
        .collect()
}

fn call<T: Scalar>(
    row: &Row,
    positional: Vec<Value<T>>,
) -> Result<Value<T>, moldloft_registry::CallError> {
    let (args, _) = bind_arguments(row, Given { positional, named: vec![] }, |_| Class::Any)?;
    T::call(row, &args, &Context::default())
}

#[test]
fn every_row_makes_a_documented_field() {
    let registry = Registry::new(rows());
    for row in registry.rows() {
        assert!(!row.summary().is_empty() && !row.example.is_empty(), "{}", row.name);
        assert!(row.fields.iter().all(|f| !f.help.is_empty()), "{}", row.name);
    }
    for name in ["plane", "sphere", "cylinder", "cone", "torus", "cyclide"] {
        let row = registry.get(name).unwrap();
        assert!(!row.summary().is_empty() && row.example.contains(&format!("= {}(", row.name)));
        assert!(row.class == Class::Field && !row.kind);
        let Value::Field(f) = call::<f64>(row, arguments(row, 0.5)).unwrap() else { panic!() };
        let p = Vec3::of(0.7, 0.3, 0.2);
        let (value, gradient) = f.value_and_gradient(p);
        // Derivative by the radius, and the same real part.
        let Value::Field(d) = call(row, arguments(row, Dual4::seeded(0.5, 1))).unwrap() else {
            panic!()
        };
        let dual = d.value(Vec3::lifted(p));
        assert_eq!(dual.re.to_bits(), value.to_bits(), "{}", row.name);
        let has_radius = row.fields.iter().any(|f| matches!(f.name, "radius" | "minor"));
        assert_eq!(dual.eps[1] != 0.0, has_radius, "{}", row.name);
        let h = 1e-6;
        let slope =
            (f.value(p + Vec3::of(h, 0.0, 0.0)) - f.value(p - Vec3::of(h, 0.0, 0.0))) / (2.0 * h);
        assert!((slope - gradient.x).abs() < 1e-6, "{}", row.name);
    }
}

#[test]
fn bad_arguments_are_faults() {
    let registry = Registry::new(rows());
    let row = registry.get("sphere").unwrap();
    let fault = |radius: f64| call::<f64>(row, arguments(row, radius)).unwrap_err();
    let zero = fault(0.0);
    assert_eq!(
        (zero.id, zero.message.as_str()),
        ("out-of-range", "the radius must be above 0, found 0")
    );
    assert_eq!(fault(-1.0).id, "out-of-range");
    assert_eq!(fault(f64::NAN).id, "not-finite");
    let row = registry.get("plane").unwrap();
    let nowhere = || Value::<f64>::Vector(Vec3::zero());
    assert_eq!(call(row, vec![nowhere(), nowhere()]).unwrap_err().id, "degenerate");
}
