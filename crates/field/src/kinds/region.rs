//! The box in which a set is evaluated.

use super::read::fault;
use crate::Set;
use crate::query::bounds::around;
use moldloft_num::{Box3, Real, Vec3};
use moldloft_registry::{CallError, FieldId, Point};

/// The box of two corners, if both are given; `field` is the second.
pub fn corners<T: Real>(
    low: &Option<Point<T>>,
    high: &Option<Point<T>>,
    field: FieldId,
) -> Result<Option<Box3>, CallError> {
    match (low, high) {
        (Some(low), Some(high)) => {
            let over = Box3 { low: low.xyz.re(), high: high.xyz.re() };
            crate::error::solid_box(over).map(Some).map_err(|e| fault(&e).in_field(field))
        }
        (None, None) => Ok(None),
        _ => Err(CallError::new("missing-argument", "a box has two corners, and one is missing")
            .expected("low and high, or neither")
            .in_field(field)),
    }
}

/// A box with its corners as the language gave them, when it did.
pub struct Region<T> {
    pub over: Box3,
    pub corners: Option<[Vec3<T>; 2]>,
}

/// The box that was given, or one found around the set: the arguments of the set and of the second corner.
///
/// # Errors
/// A set without end, or without a point.
pub fn region<T: Real>(
    set: &Set<f64>,
    low: &Option<Point<T>>,
    high: &Option<Point<T>>,
    [of, second]: [FieldId; 2],
) -> Result<Region<T>, CallError> {
    if let Some(over) = corners(low, high, second)? {
        let corners = low.as_ref().zip(high.as_ref()).map(|(l, h)| [l.xyz, h.xyz]);
        return Ok(Region { over, corners });
    }
    let over = around(set).map_err(|e| fault(&e).in_field(of))?;
    match over {
        Some(over) => Ok(Region { over, corners: None }),
        None => Err(CallError::new("empty-set", "the set is empty: it has no box")
            .expected("a set with points in it, or a box")
            .in_field(of)),
    }
}
