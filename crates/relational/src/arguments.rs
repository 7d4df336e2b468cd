//! Common types of arguments: beads, magnets, snakes, the sides of patches.

use moldloft_num::trace::Key;
use moldloft_num::{CurveJet, Order, Real};
use moldloft_registry::{CallError, Class, CurveRef, FieldId, FromValue, SurfaceRef, Value};
use moldloft_spline::{End, Ends};
use std::sync::Arc;

fn wrong<T: Real, R>(class: Class, value: &Value<T>) -> Result<R, CallError> {
    Err(CallError::wrong_class(class, value.class()))
}

/// A point on a curve.
#[derive(Clone, Debug)]
pub struct Bead<T: Real> {
    /// The point object.
    pub key: Option<Key>,
    /// Host curve.
    pub curve: CurveRef<T>,
    /// Its parameter there.
    pub t: T,
}

fn bead<T: Real>(value: &Value<T>, class: Class) -> Result<Bead<T>, CallError> {
    let Value::Point(point) = value else { return wrong(class, value) };
    match &point.on_curve {
        Some(place) => Ok(Bead { key: point.key, curve: place.0.clone(), t: place.1 }),
        None => wrong(class, value),
    }
}

impl<T: Real> FromValue<T> for Bead<T> {
    const CLASS: Class = Class::Bead;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        bead(value, Class::Bead)
    }
}

/// A point on a snake.
#[derive(Clone, Debug)]
pub struct Ring<T: Real>(pub Bead<T>);

impl<T: Real> FromValue<T> for Ring<T> {
    const CLASS: Class = Class::Ring;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let bead = bead(value, Class::Ring)?;
        if bead.curve.surface.is_some() { Ok(Ring(bead)) } else { wrong(Class::Ring, value) }
    }
}

/// A point on a surface.
#[derive(Clone, Debug)]
pub struct Magnet<T: Real> {
    /// The point object.
    pub key: Option<Key>,
    /// Host surface.
    pub surface: SurfaceRef<T>,
    /// Its parameters (u, v) there.
    pub uv: [T; 2],
}

impl<T: Real> FromValue<T> for Magnet<T> {
    const CLASS: Class = Class::Magnet;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Point(p) => match &p.on_surface {
                Some(place) => Ok(Magnet { key: p.key, surface: place.0.clone(), uv: place.1 }),
                None => wrong(Class::Magnet, value),
            },
            other => wrong(Class::Magnet, other),
        }
    }
}

/// A curve on a surface.
#[derive(Clone, Debug)]
pub struct Snake<T: Real> {
    /// The curve.
    pub curve: CurveRef<T>,
    /// Host surface.
    pub surface: SurfaceRef<T>,
}

impl<T: Real> Snake<T> {
    /// The jet of (u(t), v(t), 0) on the surface.
    pub fn path(&self, t: T, order: Order) -> CurveJet<T> {
        self.curve.on_surface(t, order).expect("a curve with a surface knows its place on it")
    }
}

impl<T: Real> FromValue<T> for Snake<T> {
    const CLASS: Class = Class::Snake;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Curve(curve) => match &curve.surface {
                Some(surface) => {
                    Ok(Snake { curve: curve.clone(), surface: SurfaceRef::clone(surface) })
                }
                None => wrong(Class::Snake, value),
            },
            other => wrong(Class::Snake, other),
        }
    }
}

/// A side of a patch on a surface: a snake, or a magnet for a side without length.
#[derive(Clone, Debug)]
pub enum Side<T: Real> {
    /// A side with length.
    Snake(Snake<T>),
    /// A side that is a single point.
    Magnet(Magnet<T>),
}

impl<T: Real> Side<T> {
    /// Host surface.
    pub fn surface(&self) -> &SurfaceRef<T> {
        match self {
            Side::Snake(snake) => &snake.surface,
            Side::Magnet(magnet) => &magnet.surface,
        }
    }
}

impl<T: Real> FromValue<T> for Side<T> {
    const CLASS: Class = Class::Side;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value.class() {
            Class::Snake => Snake::from_value(value).map(Side::Snake),
            Class::Magnet | Class::Ring => Magnet::from_value(value).map(Side::Magnet),
            _ => wrong(Class::Side, value),
        }
    }
}

/// Condition at both ends of an interpolating spline, by its name in the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndRule {
    /// "notaknot": the first two pieces are one polynomial.
    NotAKnot,
    /// "natural": zero second derivative.
    Natural,
    /// "bessel": the slope of the parabola through three points.
    Bessel,
    /// "quadratic": the end piece is a parabola.
    Quadratic,
    /// "clamped": given slopes.
    Clamped,
    /// "periodic": closed, with continuous first and second derivative.
    Periodic,
}

impl EndRule {
    const NAMES: [(&'static str, EndRule); 6] = [
        ("notaknot", EndRule::NotAKnot),
        ("natural", EndRule::Natural),
        ("bessel", EndRule::Bessel),
        ("quadratic", EndRule::Quadratic),
        ("clamped", EndRule::Clamped),
        ("periodic", EndRule::Periodic),
    ];

    /// The conditions, when they need no slopes.
    pub fn ends<T: Real>(self) -> Option<Ends<T>> {
        Some(match self {
            EndRule::NotAKnot => Ends::Open(End::NotAKnot, End::NotAKnot),
            EndRule::Natural => Ends::Open(End::Natural, End::Natural),
            EndRule::Bessel => Ends::Open(End::Bessel, End::Bessel),
            EndRule::Quadratic => Ends::Open(End::Quadratic, End::Quadratic),
            EndRule::Clamped => return None,
            EndRule::Periodic => Ends::Periodic,
        })
    }
}

impl<T: Real> FromValue<T> for EndRule {
    const CLASS: Class = Class::Text;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let text = Arc::<str>::from_value(value)?;
        let found = Self::NAMES.iter().find(|(name, _)| *name == &*text);
        found.map(|(_, rule)| *rule).ok_or_else(|| {
            let names = Self::NAMES.map(|(name, _)| format!("\"{name}\"")).join(", ");
            CallError::new("unknown-ends", format!("unknown ends \"{text}\""))
                .expected(names)
                .found(format!("\"{text}\""))
        })
    }
}

/// True when both are the same surface object, or the same nameless surface.
fn same_surface<T: Real>(a: &SurfaceRef<T>, b: &SurfaceRef<T>) -> bool {
    if a.key.is_some() || b.key.is_some() { a.key == b.key } else { a.same(b) }
}

/// The common surface of all `items`; `place` assigns an error to item k.
///
/// # Errors
/// `wrong-surface` at the first item on another surface than the first item.
pub fn common_surface<T: Real>(
    items: &[(Option<Key>, &SurfaceRef<T>)],
    place: impl Fn(CallError, usize) -> CallError,
) -> Result<SurfaceRef<T>, CallError> {
    let (first_key, first) = items[0];
    for (k, (key, surface)) in items.iter().enumerate() {
        if !same_surface(first, surface) {
            let message = format!("item {} is on another surface than item 1", k + 1);
            let fault = CallError::new("wrong-surface", message)
                .expected("magnets and snakes of one surface")
                .found("two different surfaces")
                .help("take magnets of one surface; CopyMagnet and CopySnake take them to another")
                .related(*key, "is on one surface")
                .related(surface.key, "is the surface of the one")
                .related(first_key, "is on another surface")
                .related(first.key, "is the surface of the other");
            return Err(place(fault, k));
        }
    }
    Ok(first.clone())
}

/// The common curve of both beads.
///
/// # Errors
/// `wrong-curve`, in field `field`, if they are on different curves.
pub fn common_curve<T: Real>(
    [a, b]: [&Bead<T>; 2],
    field: FieldId,
) -> Result<CurveRef<T>, CallError> {
    let named = a.curve.key.is_some() || b.curve.key.is_some();
    let same = if named { a.curve.key == b.curve.key } else { a.curve.same(&b.curve) };
    if same {
        return Ok(a.curve.clone());
    }
    Err(CallError::new("wrong-curve", "the two beads are on different curves")
        .expected("two beads of one curve")
        .found("beads of two curves")
        .related(a.key, "is on one curve")
        .related(a.curve.key, "is the curve of the one")
        .related(b.key, "is on another curve")
        .related(b.curve.key, "is the curve of the other")
        .in_field(field))
}

/// One of a list of names, given by its name or by its number in the list (from 1), as old model
/// files have it.
#[derive(Clone, Debug)]
pub enum NamedOption {
    /// By name.
    Text(Arc<str>),
    /// By number.
    Number(usize),
}

impl NamedOption {
    /// The name among `names`.
    ///
    /// # Errors
    /// `unknown-name`, in field `field`.
    pub fn among<'n>(&self, names: &[&'n str], field: FieldId) -> Result<&'n str, CallError> {
        let found = match self {
            NamedOption::Text(text) => names.iter().find(|name| **name == &**text),
            NamedOption::Number(k) => k.checked_sub(1).and_then(|k| names.get(k)),
        };
        found.copied().ok_or_else(|| {
            let found = match self {
                NamedOption::Text(text) => format!("\"{text}\""),
                NamedOption::Number(k) => k.to_string(),
            };
            let list = names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>();
            CallError::new("unknown-name", format!("there is no {found} to choose here"))
                .expected(format!("{}, or a number from 1 to {}", list.join(", "), names.len()))
                .found(found)
                .in_field(field)
        })
    }
}

impl<T: Real> FromValue<T> for NamedOption {
    const CLASS: Class = Class::Any;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Text(text) => Ok(NamedOption::Text(text.clone())),
            Value::Number(_) => usize::from_value(value).map(NamedOption::Number),
            other => wrong(Class::Text, other),
        }
    }
}

/// An axis: "x", "y" or "z", or 1, 2 or 3.
#[derive(Clone, Copy, Debug)]
pub struct AxisName(pub usize);

impl<T: Real> FromValue<T> for AxisName {
    const CLASS: Class = Class::Any;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        let at = match NamedOption::from_value(value)? {
            NamedOption::Text(text) => ["x", "y", "z"].iter().position(|name| *name == &*text),
            NamedOption::Number(k) => k.checked_sub(1).filter(|k| *k < 3),
        };
        at.map(Self).ok_or_else(|| {
            CallError::new("unknown-axis", "unknown axis")
                .expected("\"x\", \"y\" or \"z\", or 1, 2 or 3")
        })
    }
}

/// Start of a length along a curve: a bead, or the start of a curve.
#[derive(Clone, Debug)]
pub struct Start<T: Real> {
    /// The curve.
    pub curve: CurveRef<T>,
    /// The parameter there.
    pub t: T,
}

impl<T: Real> FromValue<T> for Start<T> {
    const CLASS: Class = Class::Along;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Curve(curve) => Ok(Self { curve: curve.clone(), t: T::zero() }),
            Value::Point(point) if point.on_curve.is_some() => {
                let Bead { curve, t, .. } = Bead::from_value(value)?;
                Ok(Self { curve, t })
            }
            other => Err(CallError::new(
                "wrong-class",
                format!(
                    "expected a curve or a bead on one, found {}",
                    other.class().with_article()
                ),
            )
            .expected("a curve, or a bead on one")
            .found(other.class().with_article())),
        }
    }
}
