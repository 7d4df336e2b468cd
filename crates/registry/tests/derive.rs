//! The derive macro: a struct becomes a row that reads, checks and builds.

use moldloft_num::trace::Key;
use moldloft_num::{Dual4, Jet, Order, Real, Vec3};
use moldloft_registry::export::StaticRow;
use moldloft_registry::{
    Build, CallError, Class, Context, CurveRef, Given, Kind, Point, Registry, Scalar, Value,
    bind_arguments,
};

/// A straight line: C(t) = (1-t) P1 + t P2.
#[derive(Kind)]
#[kind(class = Curve, columns = "relabel p1 p2", example = "")]
struct Segment<T: Real> {
    /// Start.
    p1: Point<T>,
    /// End.
    p2: Point<T>,
    /// Factor of the length.
    #[field(default = 1, min = 0.5, max = 10)]
    stretch: T,
}

struct Straight<T>([Vec3<T>; 2]);

impl<T: Real> moldloft_num::CurveFormula for Straight<T> {
    type Scalar = T;
    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let [a, b] = self.0.map(|p| p.map(J::fixed));
        a.lerp(b, t)
    }

    moldloft_num::curve_facts!(smooth, open, not_rational);
}

impl<T: Real> Build<T> for Segment<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let end = self.p1.xyz + (self.p2.xyz - self.p1.xyz) * self.stretch;
        Ok(Value::Curve(CurveRef::new(Straight([self.p1.xyz, end]), 0)))
    }
}

fn vector<T: Real>(x: f64, y: f64, z: f64) -> Value<T> {
    Value::Vector(Vec3::of(x, y, z))
}

fn given<T: Real>(positional: Vec<Value<T>>, named: Vec<(&str, Value<T>)>) -> Given<'_, T> {
    Given { positional, named }
}

#[test]
fn a_struct_becomes_a_documented_row() {
    let row = Segment::<f64>::row();
    assert_eq!(row.summary(), "A straight line: C(t) = (1-t) P1 + t P2.");
    // A curve's relabel comes after its own arguments.
    let names: Vec<_> = row.fields.iter().map(|f| f.name).collect();
    assert_eq!(names, ["p1", "p2", "stretch", "relabel"]);
    assert_eq!((row.fields[0].name, row.fields[0].help), ("p1", "Start."));
    assert_eq!(row.fields[2].min, Some(0.5));
    assert!(row.kind && row.class == Class::Curve);
}

#[test]
fn calls_for_both_scalars() {
    let row = Segment::<f64>::row();
    let args = given(vec![vector(0.0, 0.0, 0.0), vector(2.0, 0.0, 0.0)], vec![]);
    let (args, _) = bind_arguments(&row, args, |_| Class::Any).unwrap();
    let Value::Curve(c) = f64::call(&row, &args, &Context::default()).unwrap() else { panic!() };
    assert_eq!(
        c.jet(0.5, Order::First),
        [Vec3::of(1.0, 0.0, 0.0), Vec3::of(2.0, 0.0, 0.0), Vec3::zero()]
    );

    let stretch = Value::Number(Dual4::seeded(1.0, 2));
    let args = given(
        vec![vector(0.0, 0.0, 0.0), vector(2.0, 0.0, 0.0)],
        vec![("stretch", stretch), ("divisions", Value::Number(7.0.into()))],
    );
    let (args, head) = bind_arguments(&row, args, |_| Class::Any).unwrap();
    assert_eq!(head.divisions[0], 7);
    let Value::Curve(c) = Dual4::call(&row, &args, &Context::default()).unwrap() else { panic!() };
    assert_eq!(c.end(1.0).x.eps, [0.0, 0.0, 2.0, 0.0]);
}

#[test]
fn says_what_is_wrong_and_where() {
    let row = Segment::<f64>::row();
    let fault = |positional, named| {
        bind_arguments(&row, given(positional, named), |_| Class::Surface).unwrap_err()
    };
    let p = || vector(0.0, 0.0, 0.0);
    let f = fault(vec![p()], vec![]);
    assert_eq!((f.id, f.field().unwrap()), ("missing-argument", 1));
    let f = fault(vec![p(), Value::Object(Key(3))], vec![]);
    assert_eq!((f.id, f.message.as_str()), ("wrong-class", "expected a point, found a surface"));
    let f = fault(vec![p(), p(), Value::Number(11.0)], vec![]);
    assert_eq!((f.id, f.expected.as_deref()), ("out-of-range", Some("a number from 0.5 to 10")));
    let f = fault(vec![p(), p(), Value::Number(f64::NAN)], vec![]);
    assert_eq!(f.id, "not-finite");
    let f = fault(vec![p(), p()], vec![("strech", Value::Number(1.0))]);
    assert_eq!((f.id, f.help[0].as_str()), ("unknown-argument", "did you mean `stretch`?"));
    let f = fault(vec![p(), p()], vec![("divisions", Value::Number(1e9))]);
    assert_eq!(f.id, "out-of-range");
    let f = fault(vec![p(), p()], vec![("p1", p())]);
    assert_eq!(f.id, "argument-twice");
}

#[test]
fn a_registry_finds_rows_by_name() {
    let registry = Registry::new([Segment::<f64>::row()]);
    assert!(registry.get("Segment").is_some() && registry.get("segment").is_none());
}

/// Fails for its radius.
macro_rules! fails_for_its_radius {
    ($name:ident { $($field:ident),* }) => {
        /// A kind that refuses its radius.
        #[derive(Kind)]
        #[kind(class = Number, function, name = "refuses", example = "")]
        struct $name<T: Real> {
            $(
                /// An argument.
                $field: T,
            )*
        }

        impl<T: Real> Build<T> for $name<T> {
            fn build(self, _: &Context) -> Result<Value<T>, CallError> {
                let _ = ($(self.$field),*);
                Err(CallError::new("out-of-range", "the radius").in_field(Self::RADIUS))
            }
        }
    };
}
fails_for_its_radius!(Before { radius, height });
fails_for_its_radius!(After { height, radius });

#[test]
fn a_field_that_moves_takes_its_faults_along() {
    let call = |row: moldloft_registry::Row| {
        let args = [Value::Number(1.0), Value::Number(2.0)];
        let fault = f64::call(&row, &args, &Context::default()).unwrap_err();
        let field = fault.field().expect("an argument is named");
        (field, row.fields[field].name)
    };
    assert_eq!(call(<Before<f64> as StaticRow>::row()), (0, "radius"));
    assert_eq!(call(<After<f64> as StaticRow>::row()), (1, "radius"));
}
