//! Weights: masses with their centres, as kinds. A mass is a number of the program, `engine.mass`;
//! it follows from a shape if given per length, area or volume.

use crate::model_file::text::Text;
use crate::value::member::ROUGH;
use moldloft_hydro::{USUAL_ACCURACY, curve_measures, solid_measures, surface_measures};
use moldloft_model::Object;
use moldloft_num::{Real, Vec3};
use moldloft_registry::export::StaticRow;
use moldloft_registry::{Array, Build, CallError, Context, Kind, Role, Row, Scalar, Value};
use std::sync::Arc;

/// A mass with its centre: an item of a ship's weight.
///
/// Masses are used as given, also in a mirrored model (`Model info(symmetry = "y")`): `images =
/// "y"` adds the mirror image, which doubles the mass and moves the centre into the plane.
///
/// The mass is given, or follows from a mass per length of a curve, per area of a surface, per volume of a solid or
/// body. `w.mass` is the mass with its margin, `w.centre`, `w.x`, `w.y`, `w.z` are the centre: numbers of the program.
/// `m.weights()` in Python and `moldloft hydro --weights` list all of them by group.
#[derive(Kind)]
#[kind(
    class = Numbers,
    role = Weight,
    example = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); \
               Line l(A, B); Line m(C, D); RuledSurf S(l, m); Weight plating(S, per = 0.05, group = \"hull\"); \
               Weight engine({2, 0, 0.5}, mass = 3, group = \"machinery\", margin = 5); \
               WeightSum light({plating, engine});"
)]
pub struct Weight<T: Real> {
    /// Position: a point or {x, y, z}; or a curve, surface, solid or body whose centroid is the
    /// centre.
    at: Value<T>,
    /// The mass.
    mass: Option<T>,
    /// Mass per length of the curve, per area of the surface or per volume of the solid; replaces
    /// `mass`.
    per: Option<T>,
    /// Group in the list of weights.
    #[field(default = "")]
    group: Text<T>,
    /// A margin that is added to the mass, in percent.
    #[field(default = 0)]
    margin: T,
    /// Source of the mass: "estimated", "calculated" or "weighed".
    #[field(default = "estimated")]
    status: Text<T>,
    /// Mirror planes: "y" adds the mirror image in y = 0, "" adds no image. Required for a mass per
    /// area of one half of a symmetric model.
    images: Option<Text<T>>,
}

/// The sum of weights: their mass and common centre.
#[derive(Kind)]
#[kind(
    class = Numbers,
    role = WeightSum,
    example = "Weight engine({2, 0, 0.5}, mass = 3); Weight ballast({1, 0, -1}, mass = 2); \
               WeightSum all({engine, ballast});"
)]
pub struct WeightSum<T: Real> {
    /// Weights, and sums of weights.
    #[field(min_items = 1)]
    weights: Vec<Value<T>>,
}

impl<T: Real> Build<T> for Weight<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        // The group is for lists.
        let _ = self.group.as_str();
        const STATES: [&str; 3] = ["estimated", "calculated", "weighed"];
        if !STATES.contains(&self.status.as_str()) {
            return Err(CallError::new("unknown-word", "unknown status of a weight")
                .expected("estimated, calculated or weighed")
                .found(format!("\"{}\"", self.status.as_str()))
                .in_field(Self::STATUS));
        }
        let unsound = || {
            CallError::new("no-body", "the shape has positions that are not finite")
                .in_field(Self::AT)
        };
        // Size of the shape (`None` for a point), and its centre.
        let (size, centre) = match &self.at {
            Value::Point(p) => (None, p.xyz),
            Value::Vector(p) => (None, *p),
            Value::Curve(curve) => {
                let (length, centre) = curve_measures(&**curve);
                (Some(length), centre)
            }
            Value::Surface(surface) => {
                let m = surface_measures(&**surface, USUAL_ACCURACY).ok_or_else(unsound)?;
                (Some(m.area), m.area_centre)
            }
            Value::Solid(solid) => {
                let (volume, centre, error) = solid_measures(&**solid).ok_or_else(unsound)?;
                let volume = volume.abs();
                if error > ROUGH * volume.re() {
                    let found = format!("a volume of {} that is known to {error:.1e}", volume.re());
                    return Err(CallError::new(
                        "rough-volume",
                        "the volume of the solid does not converge",
                    )
                    .expected("a solid without kinks that run across its parameters")
                    .found(found)
                    .in_field(Self::AT));
                }
                (Some(volume), centre)
            }
            Value::Body(body) => {
                let m = body.measures().ok_or_else(unsound)?;
                (Some(if body.is_closed() { m.volume } else { m.area }), m.centroid)
            }
            other => {
                return Err(CallError::new("wrong-class", "a weight needs a position")
                    .expected("a point, {x, y, z}, a curve, a surface, a solid or a body")
                    .found(other.class().with_article())
                    .in_field(Self::AT));
            }
        };
        let mass = match (self.mass, self.per, size) {
            (Some(mass), None, _) => mass,
            (None, Some(per), Some(size)) => per * size,
            (None, Some(_), None) => {
                return Err(CallError::new("no-size", "a point has no size to multiply")
                    .expected("`mass = ...`, or a curve, surface or solid")
                    .in_field(Self::PER));
            }
            (Some(_), Some(_), _) => {
                return Err(CallError::new("two-masses", "the mass is stated twice")
                    .expected("`mass`, or `per`")
                    .in_field(Self::PER));
            }
            (None, None, _) => {
                return Err(CallError::new("no-mass", "a weight without mass")
                    .expected("`mass = ...`, or `per = ...` of a shape")
                    .in_field(Self::MASS));
            }
        };
        let mass = mass * (self.margin / 100.0 + 1.0);
        let (mass, centre) = match &self.images {
            Some(planes) => with_images(mass, centre, planes.as_str())?,
            None => (mass, centre),
        };
        // Written so that NaN is refused.
        let sound = mass.re() >= 0.0 && mass.re().is_finite();
        if !sound {
            return Err(CallError::new("out-of-range", "a mass is not negative")
                .expected("a mass of zero or more, with its margin")
                .found(mass.re().to_string())
                .in_field(if self.mass.is_some() { Self::MASS } else { Self::PER }));
        }
        Ok(row_of(mass, centre))
    }
}

/// The mass and the centre of a weight and its mirror images.
fn with_images<T: Real>(mass: T, centre: Vec3<T>, planes: &str) -> Result<(T, Vec3<T>), CallError> {
    let (mut mass, mut centre) = (mass, centre.to_array());
    for (k, letter) in planes.char_indices() {
        let axis = "xyz".find(letter).filter(|_| !planes[..k].contains(letter));
        let Some(axis) = axis else {
            return Err(CallError::new("unknown-plane", format!("unknown planes \"{planes}\""))
                .expected("letters of x, y and z, each once")
                .in_field(Weight::<T>::IMAGES));
        };
        mass = mass * 2.0;
        centre[axis] = T::zero();
    }
    Ok((mass, centre.into()))
}

impl<T: Real> Build<T> for WeightSum<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let (mut mass, mut moment) = (T::zero(), Vec3::zero());
        for (k, weight) in self.weights.iter().enumerate() {
            let Some((m, centre)) = mass_and_centre(weight) else {
                return Err(CallError::new("wrong-class", "a sum of weights is of weights")
                    .expected("Weight or WeightSum")
                    .found(weight.class().with_article())
                    .in_item(k)
                    .in_field(Self::WEIGHTS));
            };
            mass += m;
            moment += centre * m;
        }
        if mass.re() == 0.0 {
            return Err(CallError::new("no-mass", "the weights have no mass, so no centre")
                .expected("a positive mass")
                .in_field(Self::WEIGHTS));
        }
        Ok(row_of(mass, moment / mass))
    }
}

fn row_of<T: Real>(mass: T, centre: Vec3<T>) -> Value<T> {
    let [x, y, z] = centre.to_array();
    Value::Numbers(Arc::new(Array::row(vec![mass, x, y, z])))
}

/// Mass and centre of the value of a weight.
pub fn mass_and_centre<T: Real>(value: &Value<T>) -> Option<(T, Vec3<T>)> {
    let Value::Numbers(row) = value else { return None };
    let [mass, x, y, z] = row.items[..] else { return None };
    Some((mass, Vec3::new(x, y, z)))
}

/// `.mass`, `.centre`, `.x`, `.y`, `.z` of a weight.
pub fn member<T: Scalar>(object: &Object<T>, word: &str) -> Option<Value<T>> {
    if !matches!(object.row.role, Role::Weight | Role::WeightSum) {
        return None;
    }
    let (mass, centre) = mass_and_centre(object.value()?)?;
    Some(match word {
        "mass" => Value::Number(mass),
        "centre" => Value::Vector(centre),
        "x" => Value::Number(centre.x),
        "y" => Value::Number(centre.y),
        "z" => Value::Number(centre.z),
        _ => return None,
    })
}

pub(crate) fn rows() -> [Row; 2] {
    [<Weight<f64> as StaticRow>::row(), <WeightSum<f64> as StaticRow>::row()]
}
