//! What foil curves and foil snakes have in common: their section from their arguments.

use crate::arguments::Named;
use moldloft_num::{Curve, CurveJet, Order, Real, Vec3};
use moldloft_registry::{CurveRef, Fault};
use moldloft_spline::foil::{FoilError, Layout, Metric, Offset, Profile, Section, SectionSpec};
use std::sync::Arc;

/// The fields of a foil, in this order in both kinds.
pub const POINTS: usize = 0;
const FAMILY: usize = 1;
const MEAN: usize = 2;
const CAMBER_AT: usize = 3;
const LOAD: usize = 4;
const NOSE_INDEX: usize = 5;
const THICKNESS_AT: usize = 6;
const TAIL: usize = 7;
const OFFSET: usize = 8;
const ORDINATES: usize = 10;
const METRIC: usize = 11;

/// The arguments of a foil but its points.
pub struct Arguments<T: Real> {
    pub family: Named,
    pub mean: Arc<str>,
    pub camber_at: T,
    pub load: Option<T>,
    pub nose_index: T,
    pub thickness_at: T,
    pub tail: Arc<str>,
    pub offset: Arc<str>,
    pub section: Option<CurveRef<T>>,
    pub ordinates: Option<Vec<Vec3<T>>>,
    pub metric: Option<Vec3<T>>,
}

/// The choice of a word of two.
fn either(word: &str, names: [&str; 2], field: usize) -> Result<bool, Fault> {
    match names.iter().position(|name| *name == word) {
        Some(at) => Ok(at == 0),
        None => Err(Fault::new("unknown-name", format!("there is no \"{word}\" to choose here"))
            .expected(names.map(|n| format!("\"{n}\"")).join(" or "))
            .found(format!("\"{word}\""))
            .in_field(field)),
    }
}

impl<T: Real> Arguments<T> {
    /// The foil between `points`, whether its section is closed, and how deep shapes are nested in
    /// it.
    pub fn profile(self, points: &[Vec3<T>]) -> Result<(Profile<T>, bool, u32), Fault> {
        let families = Section::<T>::FAMILIES;
        let family = self.family.among(&families, FAMILY)?;
        let closed = either(&self.tail, ["closed", "open"], TAIL)?;
        let offset = match either(&self.offset, ["affine", "normal"], OFFSET)? {
            true => Offset::Affine,
            false => Offset::Normal,
        };
        let metric = self.metric.map_or(Metric::Space, |m| Metric::Plane(m.to_array()));
        let layout = Layout::new(points, metric).map_err(of_foil)?;
        let mut nesting = 0;
        let section = match (self.section, self.ordinates) {
            (Some(_), Some(_)) => {
                return Err(Fault::new(
                    "unused-argument",
                    "a section is given by a curve or by ordinates, not by both",
                )
                .help("leave `ordinates` or `section` out")
                .in_field(ORDINATES));
            }
            (Some(curve), None) => {
                nesting = curve.depth;
                Ok(Section::of_curve(Arc::new(Shared(curve))))
            }
            (None, Some(ordinates)) => Section::of_ordinates(&ordinates),
            (None, None) => Section::new(&SectionSpec {
                family,
                mean: &self.mean,
                camber_at: self.camber_at,
                load: self.load,
                nose_index: self.nose_index,
                thickness_at: self.thickness_at,
                ratio: layout.ratio(),
                closed,
            }),
        }
        .map_err(of_foil)?;
        if offset == Offset::Normal && !section.has_slope() {
            return Err(of_foil(FoilError::NoSlope));
        }
        let closed = section.is_closed();
        Ok((Profile { section: Arc::new(section), layout, offset }, closed, nesting))
    }
}

/// A curve that is shared with its object.
struct Shared<T: Real>(CurveRef<T>);

impl<T: Real> Curve<T> for Shared<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.0.jet(t, order)
    }
    fn breaks(&self) -> Vec<f64> {
        self.0.breaks()
    }
}

/// The fault of a foil.
fn of_foil(error: FoilError) -> Fault {
    let text = error.to_string();
    match error {
        FoilError::Family { name } => Fault::new("unknown-name", text)
            .expected(Section::<f64>::FAMILIES.map(|n| format!("\"{n}\"")).join(", "))
            .found(format!("\"{name}\""))
            .in_field(FAMILY),
        FoilError::Mean { name } => Fault::new("unknown-name", text)
            .expected(Section::<f64>::MEANS.map(|n| format!("\"{n}\"")).join(", "))
            .found(format!("\"{name}\""))
            .in_field(MEAN),
        FoilError::Range { name, value, min, max } => {
            let field = match name {
                "a nose index" => NOSE_INDEX,
                "the place of the greatest thickness" => THICKNESS_AT,
                "the place of the greatest camber" => CAMBER_AT,
                _ => LOAD,
            };
            Fault::new("out-of-range", text)
                .expected(format!("a number from {min} to {max}"))
                .found(value.to_string())
                .in_field(field)
        }
        FoilError::Ordinates { index, .. } => Fault::new("no-section", text)
            .expected("{x, half thickness, camber} with x ascending from 0 to 1")
            .in_item(index)
            .in_field(ORDINATES),
        FoilError::Points { actual } => Fault::new("wrong-length", text)
            .expected("3 points (half a section), 4 (symmetric) or 5 (cambered)")
            .found(actual.to_string())
            .in_field(POINTS),
        FoilError::NoChord => Fault::new("coincident-points", text)
            .expected("a nose away from the tail")
            .found("no chord between them")
            .in_field(POINTS),
        FoilError::Metric => Fault::new("out-of-range", text)
            .expected("{uu, uv, vv} with uu > 0 and uu vv > uv^2")
            .in_field(METRIC),
        FoilError::NoSlope => Fault::new("unused-argument", text)
            .expected("offset = \"affine\" with a section of one's own")
            .in_field(OFFSET),
        FoilError::NotFinite { index } => {
            Fault::new("not-finite", text).in_item(index).in_field(POINTS)
        }
    }
}
