//! Conditions on a surface near its grid of points, besides the tolerance.

use crate::{Condition, FairError, GridData};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{ArrayShape, CallError, Class, FieldId, FromValue, Point, Value};
use std::sync::Arc;

pub(super) struct NumberGrid<T> {
    pub shape: ArrayShape,
    pub items: Vec<T>,
}

impl<T: Real> FromValue<T> for NumberGrid<T> {
    const CLASS: Class = Class::Numbers;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        match value {
            Value::Numbers(array) => Ok(Self { shape: array.shape, items: array.items.to_vec() }),
            other => Err(CallError::wrong_class(Class::Numbers, other.class())),
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum SurfaceDemand {
    Through([f64; 2], Vec3<f64>),
    Normal([f64; 2], Vec3<f64>),
    Area,
    Volume,
}

/// All conditions, with the field and item of each.
#[derive(Default)]
pub(super) struct SurfaceDemands {
    all: Vec<(SurfaceDemand, FieldId, usize)>,
}

/// Values and their parameters along u and v, as given in the fields.
pub(super) struct PlacedValues<'a, T: Real> {
    pub what: &'static str,
    pub values: Vec<Vec3<T>>,
    pub at: [&'a Option<Vec<T>>; 2],
    pub field: FieldId,
}

impl SurfaceDemands {
    /// Conditions from points, normals and preserved quantities.
    pub fn of<T: Real>(
        through: PlacedValues<'_, T>,
        normals: PlacedValues<'_, T>,
        (keep, field): (&[Arc<str>], FieldId),
    ) -> Result<Self, CallError> {
        let mut out = Self::default();
        if let Some(k) = normals.values.iter().position(|d| d.re().norm() == 0.0) {
            return Err(CallError::new("zero-direction", "the direction has no length")
                .in_item(k)
                .in_field(normals.field));
        }
        out.place(through, SurfaceDemand::Through)?;
        out.place(normals, SurfaceDemand::Normal)?;
        for (k, word) in keep.iter().enumerate() {
            let what = match &**word {
                "area" => SurfaceDemand::Area,
                "volume" => SurfaceDemand::Volume,
                _ => {
                    return Err(CallError::new("unknown-name", format!("`{word}` cannot be kept"))
                        .expected("\"area\" or \"volume\"")
                        .found(word.to_string())
                        .in_item(k)
                        .in_field(field));
                }
            };
            out.all.push((what, field, k));
        }
        Ok(out)
    }

    fn place<T: Real>(
        &mut self,
        given: PlacedValues<'_, T>,
        make: fn([f64; 2], Vec3<f64>) -> SurfaceDemand,
    ) -> Result<(), CallError> {
        let PlacedValues { what, values, at, field } = given;
        let [us, vs] = at.map(|list| list.as_deref().unwrap_or_default());
        for (name, list) in [("u", us), ("v", vs)] {
            if list.len() != values.len() {
                return Err(CallError::new(
                    "wrong-count",
                    format!("`{what}` has a parameter along {name} for each"),
                )
                .expected(format!("{} parameters", values.len()))
                .found(list.len().to_string())
                .in_field(field));
            }
        }
        for (k, ((value, &u), &v)) in values.iter().zip(us).zip(vs).enumerate() {
            let mut numbers = value.to_array().into_iter().chain([u, v]);
            if !numbers.all(|c| c.is_constant()) {
                return Err(CallError::new(
                    "no-derivative",
                    format!("no derivatives are available for `{what}`"),
                )
                .expected("constants")
                .found(what)
                .in_item(k)
                .in_field(field));
            }
            if let Some(t) = [u.re(), v.re()].into_iter().find(|t| !(0.0..=1.0).contains(t)) {
                return Err(CallError::new("out-of-range", "a parameter is out of range")
                    .expected("0 to 1")
                    .found(t.to_string())
                    .in_item(k)
                    .in_field(field));
            }
            self.all.push((make([u.re(), v.re()], value.re()), field, k));
        }
        Ok(())
    }

    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Linear conditions on the surface through the data, and the index of the demand behind each.
    pub fn conditions(&self, data: &GridData) -> Result<(Vec<Condition>, Vec<usize>), FairError> {
        let (mut out, mut owners) = (Vec::new(), Vec::new());
        if self.all.is_empty() {
            return Ok((out, owners));
        }
        let network = data.network(data.original()?)?;
        for (k, (demand, ..)) in self.all.iter().enumerate() {
            let own = match *demand {
                SurfaceDemand::Through(at, p) => network.point_condition(at, p)?,
                SurfaceDemand::Normal(at, n) => network.normal_condition(at, n)?,
                SurfaceDemand::Area => vec![network.area_condition()?],
                SurfaceDemand::Volume => vec![network.volume_condition()?],
            };
            owners.extend(std::iter::repeat_n(k, own.len()));
            out.extend(own);
        }
        Ok((out, owners))
    }

    /// Error for contradicting conditions, at the first of them.
    pub fn refused(&self, conditions: &[usize], owners: &[usize], miss: f64) -> CallError {
        let message = format!("conditions cannot hold within the tolerance (missed by {miss:.3e})");
        let fault = CallError::new("contradiction", message)
            .expected("a larger tolerance, or conditions that agree");
        let first = conditions.first().and_then(|&c| self.all.get(*owners.get(c)?));
        match first {
            Some(&(_, field, item)) => fault.in_item(item).in_field(field),
            None => fault,
        }
    }
}

pub(super) fn places<T: Real>(points: &Option<Vec<Point<T>>>) -> Vec<Vec3<T>> {
    points.iter().flatten().map(|p| p.xyz).collect()
}
