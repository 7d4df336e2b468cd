//! Blends as rows of the registry.

use super::read::{NamedField, fault, field, set};
use super::region::corners;
use crate::{
    FieldError, Primitive, SetBlend, check_rail, check_rails, liming, liming_on_rail, zhang,
};
use moldloft_num::Real;
use moldloft_registry::{Build, CallError, Context, FieldId, Kind, Point, Value};

/// The surface through the four curves in which two bodies meet two others:
/// lambda L1 L2 - (1 - lambda) L3 L4. With one rail, L4 = L3, it touches both bodies where the rail does.
///
/// After Liming (1944). With a rail, `contact = n` gives contact G^n by lambda L1 L2 - (1 - lambda)
/// |L3|^(n + 1). The rail must cut each body outside the other; over a box `low`, `high` this is
/// proved, or the point at which it fails is reported.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "liming",
    example = "field x = plane({1, 0, 0}, {0, 0, 0}); field y = plane({0, 1, 0}, {0, 0, 0}); field b = liming(x, y, x + y - 1, lambda = 2/3);"
)]
pub struct Liming<T: Real> {
    /// A body.
    l1: NamedField<T>,
    /// The other body.
    l2: NamedField<T>,
    /// The rail, or the first of the two other bodies.
    l3: NamedField<T>,
    /// The second of the two other bodies.
    #[field(default)]
    l4: Option<NamedField<T>>,
    /// Shape between 0 (near the rail) and 1 (near the bodies).
    #[field(default = 0.5)]
    lambda: T,
    /// Order of contact on a rail.
    #[field(default = 1, min = 1, max = 100)]
    contact: u32,
    /// Low corner of a box over which the contact is checked.
    #[field(default)]
    low: Option<Point<T>>,
    /// High corner of the box.
    #[field(default)]
    high: Option<Point<T>>,
}

impl<T: Real> Build<T> for Liming<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let [l1, l2, l3] = [&self.l1, &self.l2, &self.l3].map(|s| &s.primitive);
        if let Some(l4) = &self.l4 {
            return field(liming([l1, l2], [l3, &l4.primitive], self.lambda));
        }
        if let Some(over) = corners(&self.low, &self.high, Self::HIGH)? {
            checked(check_rail([&l1.re(), &l2.re()], &l3.re(), &over), Self::L3)?;
        }
        field(liming_on_rail([l1, l2], l3, self.lambda, self.contact))
    }
}

fn checked(outcome: Result<(), FieldError>, field: FieldId) -> Result<(), CallError> {
    outcome.map_err(|e| fault(&e).in_field(field))
}

/// The transition from one body, tangent to it at its rail, to another, tangent at its own rail: (1
/// - lambda) L1 |L4|^(n + 1) + lambda L2 |L3|^(n + 1).
///
/// After Zhang. The rails L3 (on L1) and L4 (on L2) must not meet; over a box `low`, `high` this is
/// proved, or the point at which it fails is reported.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "zhang",
    example = "field x = plane({1, 0, 0}, {0, 0, 0}); field a = sphere({0, 0, 0}, 1); field duct = zhang(a, sphere({0, 0, 0}, 2), x, 1 - x);"
)]
pub struct Zhang<T: Real> {
    /// The body at the first rail.
    l1: NamedField<T>,
    /// The body at the second rail.
    l2: NamedField<T>,
    /// The rail on the first body.
    l3: NamedField<T>,
    /// The rail on the second.
    l4: NamedField<T>,
    /// Shape between 0 (longer along the first body) and 1 (longer along the second).
    #[field(default = 0.5)]
    lambda: T,
    /// Order of contact.
    #[field(default = 1, min = 1, max = 100)]
    contact: u32,
    /// Low corner of a box over which the contact is checked.
    #[field(default)]
    low: Option<Point<T>>,
    /// High corner of the box.
    #[field(default)]
    high: Option<Point<T>>,
}

impl<T: Real> Build<T> for Zhang<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let [l1, l2, l3, l4] = [&self.l1, &self.l2, &self.l3, &self.l4].map(|s| &s.primitive);
        if let Some(over) = corners(&self.low, &self.high, Self::HIGH)? {
            checked(check_rails([&l1.re(), &l2.re()], [&l3.re(), &l4.re()], &over), Self::L3)?;
        }
        field(zhang([l1, l2], [l3, l4], self.lambda, self.contact))
    }
}

/// The rail of prescribed setbacks, L1/a + L2/b - 1: it meets L1 = 0 where L2 = b and L2 = 0 where L1 = a.
/// With distances the setbacks are lengths.
#[derive(Kind)]
#[kind(
    forward,
    class = Field,
    function,
    name = "setback",
    example = "field x = plane({1, 0, 0}, {0, 0, 0}); field y = plane({0, 1, 0}, {0, 0, 0}); field rail = setback(x, y, 0.2, 0.3);"
)]
pub struct Setback<T: Real> {
    /// A body.
    l1: NamedField<T>,
    /// The other body.
    l2: NamedField<T>,
    /// Setback on the second body, measured by the first.
    #[field(min = 0)]
    a: T,
    /// Setback on the first body, measured by the second; default: the same.
    #[field(default, min = 0)]
    b: Option<T>,
}

impl<T: Real> Build<T> for Setback<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let setbacks = [self.a, self.b.unwrap_or(self.a)];
        field(crate::setback_rail([&self.l1.primitive, &self.l2.primitive], setbacks))
    }
}

macro_rules! corner_blend {
    ($kind:ident, $name:literal, $make:path, $doc:literal, $example:literal) => {
        #[doc = $doc]
        ///
        /// For distance fields the widths are lengths. Over a box `low`, `high` the contact is
        /// proved, or the point at which it fails is reported.
        #[derive(Kind)]
        #[kind(forward, class = Set, function, name = $name, example = $example)]
        pub struct $kind<T: Real> {
            /// A body.
            l1: NamedField<T>,
            /// The other body.
            l2: NamedField<T>,
            /// Setback of the blend on both bodies.
            #[field(min = 0)]
            width: T,
            /// Setback on the first body, if different.
            #[field(default, min = 0)]
            other: Option<T>,
            /// Shape between 0 (a chamfer) and 1 (the corner); 2/3 is a circular arc between
            /// perpendicular planes.
            #[field(default = crate::CIRCULAR)]
            lambda: T,
            /// Low corner of a box over which the contact is checked.
            #[field(default)]
            low: Option<Point<T>>,
            /// High corner of the box.
            #[field(default)]
            high: Option<Point<T>>,
        }

        impl<T: Real> Build<T> for $kind<T> {
            fn build(self, _: &Context) -> Result<Value<T>, CallError> {
                let bodies = [&self.l1.primitive, &self.l2.primitive];
                let setbacks = [self.width, self.other.unwrap_or(self.width)];
                let blend = $make(bodies, setbacks, self.lambda).map_err(|e| fault(&e))?;
                if let Some(over) = corners(&self.low, &self.high, Self::HIGH)? {
                    let sign = |p: &Primitive<T>| if $name == "rounded" { -p } else { p.clone() };
                    let signed = bodies.map(sign);
                    let rail = crate::setback_rail([&signed[0], &signed[1]], setbacks);
                    let rail = rail.map_err(|e| fault(&e))?;
                    checked(
                        check_rail([&signed[0].re(), &signed[1].re()], &rail.re(), &over),
                        Self::WIDTH,
                    )?;
                }
                finished(blend, [&self.l1, &self.l2], $name)
            }
        }
    };
}

/// The blend with its parts named: the bodies as they are called, the blend as its function is.
fn finished<T: Real>(
    blend: SetBlend<T>,
    bodies: [&NamedField<T>; 2],
    word: &str,
) -> Result<Value<T>, CallError> {
    let name = |p: &Primitive<T>| {
        let called = |s: &&&NamedField<T>| s.primitive.same(p) || s.primitive.same(&-p);
        match bodies.iter().find(called) {
            Some(body) => body.name.as_ref().map(|n| n.to_string()),
            None => Some(word.to_string()),
        }
    };
    set(Ok(blend.set.with_names(&name)))
}

corner_blend!(
    Fillet,
    "fillet",
    crate::fillet,
    "The union of the solid sides of two fields with a fillet in their corner.",
    "field x = plane({1, 0, 0}, {0, 0, 0}); field z = plane({0, 0, 1}, {0, 0, 0}); set corner = fillet(x, z, 0.2);"
);
corner_blend!(
    Rounded,
    "rounded",
    crate::round,
    "The intersection of the solid sides of two fields with their edge rounded.",
    "field x = plane({1, 0, 0}, {0, 0, 0}); field z = plane({0, 0, 1}, {0, 0, 0}); set edge = rounded(x, z, 0.2);"
);

/// One body up to its rail, the other up to its own, and Zhang's transition between them.
///
/// The solid sides of the rails keep the bodies. See `zhang`.
#[derive(Kind)]
#[kind(
    forward,
    class = Set,
    function,
    name = "transition",
    example = "field a = sphere({0, 0, 0}, 1); field b = sphere({3, 0, 0}, 0.5); set neck = transition(a, b, plane({1, 0, 0}, {0.8, 0, 0}), plane({-1, 0, 0}, {2.7, 0, 0}));"
)]
pub struct Transition<T: Real> {
    /// The body that it begins on.
    l1: NamedField<T>,
    /// The body that it ends on.
    l2: NamedField<T>,
    /// The rail on the first body; the body is kept on its solid side.
    l3: NamedField<T>,
    /// The rail on the second.
    l4: NamedField<T>,
    /// Shape: which body it follows longer.
    #[field(default = 0.5)]
    lambda: T,
    /// Order of contact.
    #[field(default = 1, min = 1, max = 100)]
    contact: u32,
    /// Low corner of a box over which the contact is checked.
    #[field(default)]
    low: Option<Point<T>>,
    /// High corner of the box.
    #[field(default)]
    high: Option<Point<T>>,
}

impl<T: Real> Build<T> for Transition<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let [l1, l2, l3, l4] = [&self.l1, &self.l2, &self.l3, &self.l4].map(|s| &s.primitive);
        if let Some(over) = corners(&self.low, &self.high, Self::HIGH)? {
            checked(check_rails([&l1.re(), &l2.re()], [&l3.re(), &l4.re()], &over), Self::L3)?;
        }
        let blend = crate::transition([l1, l2], [l3, l4], self.lambda, self.contact);
        finished(blend.map_err(|e| fault(&e))?, [&self.l1, &self.l2], "transition")
    }
}
