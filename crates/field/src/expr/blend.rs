//! Blends: surfaces that touch others along prescribed rails.
//!
//! Liming's blend meets the bodies L1 and L2 where the rail L3 does, Zhang's leads from L1 at the rail L3
//! to L2 at the rail L4 (Liming, Practical Analytic Geometry with Applications to Aircraft, 1944; the
//! svLis manual). Contact is a matter of signs: on L1 = L3 = 0 Liming's gradient is lambda L2 times that
//! of L1, so it has L1's orientation only where L2 is positive. [`check_rail`] and [`check_rails`] prove
//! that over a box.

use crate::expr::interval::{Interval, sides};
use crate::expr::tape::RangeRoom;
use crate::{FieldError, Primitive, Set};
use moldloft_num::{Box3, Real, Vec3};

/// A weight strictly between 0 and 1.
fn weight<T: Real>(lambda: T) -> Result<T, FieldError> {
    if lambda.is_finite() && lambda.re() > 0.0 && lambda.re() < 1.0 {
        Ok(lambda)
    } else {
        Err(FieldError::Lambda { value: lambda.re() })
    }
}

/// |f|^n, without the absolute value where n is even.
fn one_signed_power<T: Real>(f: &Primitive<T>, n: u32) -> Primitive<T> {
    if n.is_multiple_of(2) { f.power(n) } else { f.abs().power(n) }
}

/// Liming's blend through the four curves in which `l1` and `l2` meet `l3` and `l4`:
/// lambda L1 L2 - (1 - lambda) L3 L4.
///
/// # Errors
/// A weight outside (0, 1).
pub fn liming<T: Real>(
    [l1, l2]: [&Primitive<T>; 2],
    [l3, l4]: [&Primitive<T>; 2],
    lambda: T,
) -> Result<Primitive<T>, FieldError> {
    let w = weight(lambda)?;
    Ok(l1 * l2 * w - l3 * l4 * (-w + 1.0))
}

/// Liming's blend with one rail: lambda L1 L2 - (1 - lambda) |L3|^(n + 1), which touches both bodies on
/// the rail with contact G^n (n = 1: common tangent planes).
///
/// # Errors
/// A weight outside (0, 1); n = 0 or above 100.
pub fn liming_on_rail<T: Real>(
    [l1, l2]: [&Primitive<T>; 2],
    rail: &Primitive<T>,
    lambda: T,
    contact: u32,
) -> Result<Primitive<T>, FieldError> {
    let (w, n) = (weight(lambda)?, contact_power(contact)?);
    Ok(l1 * l2 * w - one_signed_power(rail, n) * (-w + 1.0))
}

/// Zhang's transition from `l1`, which it touches at the rail `l3`, to `l2`, which it touches at `l4`:
/// (1 - lambda) L1 |L4|^(n + 1) + lambda L2 |L3|^(n + 1), with contact G^n.
///
/// # Errors
/// A weight outside (0, 1); n = 0 or above 100.
pub fn zhang<T: Real>(
    [l1, l2]: [&Primitive<T>; 2],
    [l3, l4]: [&Primitive<T>; 2],
    lambda: T,
    contact: u32,
) -> Result<Primitive<T>, FieldError> {
    let (w, n) = (weight(lambda)?, contact_power(contact)?);
    Ok(l1 * one_signed_power(l4, n) * (-w + 1.0) + l2 * one_signed_power(l3, n) * w)
}

fn contact_power(contact: u32) -> Result<u32, FieldError> {
    if (1..=100).contains(&contact) {
        Ok(contact + 1)
    } else {
        Err(FieldError::Exponent { value: f64::from(contact) })
    }
}

/// The rail of prescribed setbacks, L1/a + L2/b - 1: it meets L1 = 0 where L2 = b and L2 = 0 where L1 = a,
/// and is negative at the corner. With true distances the setbacks are lengths.
///
/// # Errors
/// Setbacks that are not above zero.
pub fn setback_rail<T: Real>(
    [l1, l2]: [&Primitive<T>; 2],
    [a, b]: [T; 2],
) -> Result<Primitive<T>, FieldError> {
    let a = crate::error::positive("setback", a)?;
    let b = crate::error::positive("setback", b)?;
    Ok(l1 / a + l2 / b - T::one())
}

/// The weight at which a fillet between perpendicular planes is a circular arc: with u = L1/a and
/// v = L2/b, (u - 1)^2 + (v - 1)^2 = 1 is (u + v - 1)^2 = 2 u v.
pub const CIRCULAR: f64 = 2.0 / 3.0;

/// A blend with the sets that it makes.
#[derive(Clone, Debug)]
pub struct SetBlend<T: Real = f64> {
    /// The surface of the blend.
    pub primitive: Primitive<T>,
    /// Region of validity: the rail's solid side; for transitions the part beyond both rails.
    pub patch: Set<T>,
    /// The bodies with their blend.
    pub set: Set<T>,
}

impl<T: Real> SetBlend<T> {
    /// Degree of the blend's polynomial.
    pub fn degree(&self) -> u32 {
        self.primitive.degree()
    }
}

/// The scaled inputs u = L1/a, v = L2/b of a fillet, its rail u + v - 1 and the blend of weight `lambda`.
fn filleted<T: Real>(
    [l1, l2]: [&Primitive<T>; 2],
    [a, b]: [T; 2],
    lambda: T,
) -> Result<[Primitive<T>; 2], FieldError> {
    let rail = setback_rail([l1, l2], [a, b])?;
    // Scaling by the setbacks makes the weight free of units.
    let q = liming_on_rail([&(l1 / a), &(l2 / b)], &rail, lambda, 1)?;
    Ok([rail, q])
}

/// The union of two bodies with a fillet in their corner, of setback `width` on both.
///
/// `lambda` shapes it between 0 (a chamfer) and 1 (the corner itself); [`CIRCULAR`] is an arc between
/// perpendicular planes.
///
/// # Errors
/// A weight outside (0, 1), a width that is not above zero.
///
/// # Example
/// ```
/// use moldloft_field::{CIRCULAR, Primitive, fillet};
/// use moldloft_num::Vec3;
///
/// let [_, y, z] = Primitive::<f64>::axes();
/// let corner = fillet([&y, &z], [1.0, 1.0], CIRCULAR)?;
/// // The middle of the arc of radius 1 about y = z = 1.
/// let t = 1.0 - 0.5f64.sqrt();
/// assert!(corner.primitive.value(Vec3::of(0.0, t, t)).abs() < 1e-15);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn fillet<T: Real>(
    [l1, l2]: [&Primitive<T>; 2],
    setbacks: [T; 2],
    lambda: T,
) -> Result<SetBlend<T>, FieldError> {
    let [rail, primitive] = filleted([l1, l2], setbacks, lambda)?;
    let patch = Set::new(&primitive) & Set::new(&rail);
    let set = Set::new(l1) | Set::new(l2) | patch.clone();
    Ok(SetBlend { primitive, patch, set })
}

/// The intersection of two bodies with their edge rounded, of setback `width` on both: the fillet of
/// the complements, complemented.
///
/// # Errors
/// As [`fillet`].
pub fn round<T: Real>(
    [l1, l2]: [&Primitive<T>; 2],
    setbacks: [T; 2],
    lambda: T,
) -> Result<SetBlend<T>, FieldError> {
    let hollow = fillet([&-l1, &-l2], setbacks, lambda)?;
    let patch = hollow.patch.complement();
    Ok(SetBlend { primitive: -hollow.primitive, patch, set: hollow.set.complement() })
}

/// The union of Zhang's transition between two bodies with the part of `l1` that is inside the rail `l3`
/// and the part of `l2` inside the rail `l4`.
///
/// # Errors
/// As [`zhang`].
pub fn transition<T: Real>(
    [l1, l2]: [&Primitive<T>; 2],
    [l3, l4]: [&Primitive<T>; 2],
    lambda: T,
    contact: u32,
) -> Result<SetBlend<T>, FieldError> {
    let primitive = zhang([l1, l2], [l3, l4], lambda, contact)?;
    let [s3, s4] = [l3, l4].map(Set::new);
    let patch = &(&Set::new(&primitive) - &s3) - &s4;
    let ends = (Set::new(l1) & s3) | (Set::new(l2) & s4);
    Ok(SetBlend { primitive, set: ends | patch.clone(), patch })
}

/// Boxes are halved this often along each axis, at most.
const DEPTH: u32 = 8;

/// Proves over a box that a blend on `rail` touches both bodies with their own orientation: where the
/// rail meets one body, the other is positive and the one has a normal.
///
/// # Errors
/// The point where this fails, or could not be proved by boxes of 1/256 of the given one.
pub fn check_rail(
    [l1, l2]: [&Primitive; 2],
    rail: &Primitive,
    over: &Box3,
) -> Result<(), FieldError> {
    for (body, other, number) in [(l1, l2, 1), (l2, l1, 2)] {
        contact(body, rail, number, Some((other, 3 - number)), over)?;
    }
    Ok(())
}

/// Proves over a box that a transition touches both bodies: the rails keep apart, and each body has a
/// normal on its rail.
///
/// # Errors
/// As [`check_rail`]; [`FieldError::RailsMeet`].
pub fn check_rails(
    [l1, l2]: [&Primitive; 2],
    [l3, l4]: [&Primitive; 2],
    over: &Box3,
) -> Result<(), FieldError> {
    let mut room = RangeRoom::default();
    search(over, &mut |b, smallest| {
        let at = sides(b);
        let apart = |f: &Primitive, room: &mut RangeRoom| {
            !f.tape().mean_value(&at, room).value.contains(0.0)
        };
        if apart(l3, &mut room) || apart(l4, &mut room) {
            return Ok(true);
        }
        if smallest { Err(FieldError::RailsMeet { place: *b }) } else { Ok(false) }
    })?;
    contact(l1, l3, 1, None, over)?;
    contact(l2, l4, 2, None, over)
}

fn contact(
    body: &Primitive,
    rail: &Primitive,
    number: usize,
    other: Option<(&Primitive, usize)>,
    over: &Box3,
) -> Result<(), FieldError> {
    let mut room = RangeRoom::default();
    search(over, &mut |b, smallest| {
        let at = sides(b);
        let range = body.tape().mean_value(&at, &mut room);
        if !range.value.contains(0.0) || !rail.tape().mean_value(&at, &mut room).value.contains(0.0)
        {
            return Ok(true);
        }
        let outside =
            other.is_none_or(|(f, _)| f.tape().mean_value(&at, &mut room).value.low > 0.0);
        let regular = range.slope.iter().any(|g: &Interval| !g.contains(0.0));
        match (outside, regular, smallest) {
            (true, true, _) => Ok(true),
            (_, _, false) => Ok(false),
            (false, ..) => {
                let body = other.map_or(number, |(_, number)| number);
                Err(FieldError::RailInside { body, place: *b })
            }
            _ => Err(FieldError::RailSingular { body: number, place: *b }),
        }
    })
}

/// Visits halves of a box until `settled` says so; the second argument states that a box is not halved
/// again.
fn search(
    over: &Box3,
    settled: &mut dyn FnMut(&Box3, bool) -> Result<bool, FieldError>,
) -> Result<(), FieldError> {
    let mut stack = vec![(crate::error::solid_box(*over)?, 0)];
    while let Some((b, depth)) = stack.pop() {
        if settled(&b, depth == DEPTH)? {
            continue;
        }
        let c = b.centre();
        for k in 0..8 {
            let pick = |axis: usize| {
                if k >> axis & 1 == 0 { (b.low[axis], c[axis]) } else { (c[axis], b.high[axis]) }
            };
            let (x, y, z) = (pick(0), pick(1), pick(2));
            let (low, high) = (Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1));
            stack.push((Box3 { low, high }, depth + 1));
        }
    }
    Ok(())
}
