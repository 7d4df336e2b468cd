//! Common part of foil curves, foil snakes and foil lofts: their arguments, and the section they
//! define.

use crate::arguments::NamedOption;
use crate::third_derivatives;
use moldloft_num::{Curve, CurveJet, Jet, Order, Real, Vec3};
use moldloft_registry::{CallError, CurveRef, FieldId};
use moldloft_spline::foil::{FoilError, Layout, Metric, Offset, Profile, Section, SectionSpec};
use std::sync::Arc;

/// The fields of a kind of foil.
#[derive(Clone, Copy)]
pub struct FoilFields {
    pub points: FieldId,
    pub family: FieldId,
    pub mean: FieldId,
    pub camber_at: FieldId,
    pub load: FieldId,
    pub nose_index: FieldId,
    pub thickness_at: FieldId,
    pub tail: FieldId,
    pub offset: FieldId,
    pub ordinates: FieldId,
    /// Field of the points, for a kind without a metric.
    pub metric: FieldId,
}

/// Declares a kind of foil: a list of the points or curves of the section, the arguments that
/// define the section, and further arguments of the kind. `parts` separates them again.
macro_rules! foil_kind {
    ($(#[$kind:meta])* $name:ident {
        $(#[$first:meta])* $items:ident ($ITEMS:ident): $Item:ty
        $(, $(#[$last:meta])* metric ($METRIC:ident): $Metric:ty)? $(,)?
    }) => {
        $(#[$kind])*
        pub struct $name<T: Real> {
            $(#[$first])*
            #[field(min_items = 3)]
            $items: Vec<$Item>,
            /// Thickness form: "4-digit", "modified", "5-digit", "16", "63", "64", "65", "66", "63A",
            /// "64A", "65A", "66tmb" or "67", or its number in this list.
            #[field(default = "4-digit")]
            family: crate::arguments::NamedOption,
            /// Mean line: "flat", "parabolic", "210" to "250", "221" to "251", "a" or "a modified";
            /// "" is the default of the family.
            #[field(default = "")]
            mean: std::sync::Arc<str>,
            /// Position of the greatest camber of the parabolic mean line, in chords.
            #[field(default = 0.4)]
            camber_at: T,
            /// Extent a of the uniform load of the mean line "a"; default: 0.8 for 66tmb, else 1.
            load: Option<T>,
            /// Nose index of the modified form: 6 is the standard leading edge, 0 a sharp one.
            #[field(default = 6)]
            nose_index: T,
            /// Position of the greatest thickness of the modified form, from 0.2 to 0.6.
            #[field(default = 0.3)]
            thickness_at: T,
            /// "closed" closes the trailing edge at its points, "open" keeps its thickness in the
            /// form.
            #[field(default = "closed")]
            tail: std::sync::Arc<str>,
            /// "affine" adds thickness perpendicular to the chord, "normal" perpendicular to the
            /// mean line.
            #[field(default = "affine")]
            offset: std::sync::Arc<str>,
            /// A curve of ordinates (x, half thickness, camber) from leading to trailing edge,
            /// instead of a family.
            section: Option<moldloft_registry::CurveRef<T>>,
            /// Ordinates {x, half thickness, camber} from leading to trailing edge, instead of a
            /// family.
            ordinates: Option<Vec<moldloft_num::Vec3<T>>>,
            $($(#[$last])* metric: $Metric,)?
        }

        impl<T: Real> $name<T> {
            /// Points or curves of the section, and its definition.
            fn parts(self) -> (Vec<$Item>, crate::foil::FoilArguments<T>) {
                let metric: Option<moldloft_num::Vec3<T>> = None;
                $(let metric: $Metric = metric.or(self.metric);)?
                let metric_field = Self::$ITEMS;
                $(let metric_field = { let _ = metric_field; Self::$METRIC };)?
                let fields = crate::foil::FoilFields {
                    points: Self::$ITEMS,
                    family: Self::FAMILY,
                    mean: Self::MEAN,
                    camber_at: Self::CAMBER_AT,
                    load: Self::LOAD,
                    nose_index: Self::NOSE_INDEX,
                    thickness_at: Self::THICKNESS_AT,
                    tail: Self::TAIL,
                    offset: Self::OFFSET,
                    ordinates: Self::ORDINATES,
                    metric: metric_field,
                };
                let arguments = crate::foil::FoilArguments {
                    family: self.family,
                    mean: self.mean,
                    camber_at: self.camber_at,
                    load: self.load,
                    nose_index: self.nose_index,
                    thickness_at: self.thickness_at,
                    tail: self.tail,
                    offset: self.offset,
                    section: self.section,
                    ordinates: self.ordinates,
                    metric,
                    fields,
                };
                (self.$items, arguments)
            }
        }
    };
}
pub(crate) use foil_kind;

/// The arguments of a foil but its points.
#[derive(Clone)]
pub struct FoilArguments<T: Real> {
    pub family: NamedOption,
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
    /// Fields of errors.
    pub fields: FoilFields,
}

/// The choice of a word of two.
fn either(word: &str, names: [&str; 2], field: FieldId) -> Result<bool, CallError> {
    match names.iter().position(|name| *name == word) {
        Some(at) => Ok(at == 0),
        None => {
            Err(CallError::new("unknown-name", format!("there is no \"{word}\" to choose here"))
                .expected(names.map(|n| format!("\"{n}\"")).join(" or "))
                .found(format!("\"{word}\""))
                .in_field(field))
        }
    }
}

/// Distance relative to their size within which points of a section coincide: above the rounding of
/// a chord, below which it has no direction.
const ONE_PLACE: f64 = 64.0 * f64::EPSILON;

impl<T: Real> FoilArguments<T> {
    /// The foil between `points`, whether its section is closed, and how deep shapes are nested in
    /// it.
    pub fn profile(self, points: &[Vec3<T>]) -> Result<(Profile<T>, bool, u32), CallError> {
        let fields = self.fields;
        let metric = self.metric.map_or(Metric::Space, |m| Metric::Plane(m.to_array()));
        let layout = Layout::new(points, metric).map_err(|error| of_foil(error, fields))?;
        let (section, layout, offset, nesting) = self.laid(layout)?;
        let closed = section.is_closed();
        let section = Arc::new(section.settled());
        Ok((Profile { section, layout, offset }, closed, nesting))
    }

    /// The profile of numbers that may depend on a parameter, for lofts; a foil whose points all
    /// coincide has zero size.
    pub fn lifted<J: Jet<T>>(&self, points: &[Vec3<J>]) -> Result<Profile<J>, CallError> {
        let fixed = |v: Vec3<T>| v.map(J::fixed);
        let arguments = FoilArguments::<J> {
            family: self.family.clone(),
            mean: self.mean.clone(),
            camber_at: J::fixed(self.camber_at),
            load: self.load.map(J::fixed),
            nose_index: J::fixed(self.nose_index),
            thickness_at: J::fixed(self.thickness_at),
            tail: self.tail.clone(),
            offset: self.offset.clone(),
            section: self.section.as_ref().map(|c| CurveRef::new(Fixed(c.clone()), c.depth)),
            ordinates: self.ordinates.as_ref().map(|o| o.iter().map(|&p| fixed(p)).collect()),
            metric: self.metric.map(fixed),
            fields: self.fields,
        };
        let size = points.iter().fold(0.0_f64, |size, p| size.max(p.re().norm()));
        let first = points.first().map_or_else(Vec3::zero, |p| p.re());
        let layout = if points.iter().all(|p| p.re().distance(first) <= ONE_PLACE * size) {
            Layout::vanishing(points)
        } else {
            Layout::new(points, Metric::Space)
        };
        let (section, layout, offset, _) =
            arguments.laid(layout.map_err(|error| of_foil(error, self.fields))?)?;
        Ok(Profile { section: Arc::new(section), layout, offset })
    }

    /// The section, its position, the direction of its thickness, and the nesting depth of its
    /// shapes.
    fn laid(self, layout: Layout<T>) -> Result<(Section<T>, Layout<T>, Offset, u32), CallError> {
        let fields = self.fields;
        let families = Section::<T>::FAMILIES;
        let family = self.family.among(&families, fields.family)?;
        let closed = either(&self.tail, ["closed", "open"], fields.tail)?;
        let offset = match either(&self.offset, ["affine", "normal"], fields.offset)? {
            true => Offset::Affine,
            false => Offset::Normal,
        };
        let mut nesting = 0;
        let section = match (self.section, self.ordinates) {
            (Some(_), Some(_)) => {
                return Err(CallError::new(
                    "unused-argument",
                    "a section is given by a curve or by ordinates, not by both",
                )
                .help("leave `ordinates` or `section` out")
                .in_field(fields.ordinates));
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
        .map_err(|error| of_foil(error, fields))?;
        if offset == Offset::Normal && !section.has_slope() {
            return Err(of_foil(FoilError::NoSlope, fields));
        }
        Ok((section, layout, offset, nesting))
    }
}

struct Shared<T: Real>(CurveRef<T>);

impl<T: Real> Curve<T> for Shared<T> {
    fn jet(&self, t: T, order: Order) -> CurveJet<T> {
        self.0.jet(t, order)
    }

    fn grid(&self, ts: &[f64], out: &mut [Vec3<T>]) {
        self.0.grid(ts, out);
    }

    moldloft_num::curve_facts!(breaks of [self.0], closed of [self.0], rational of [self.0]);
}

/// A curve that does not depend on the parameter of a loft, in numbers that may.
struct Fixed<T: Real>(CurveRef<T>);

impl<T: Real, J: Jet<T>> Curve<J> for Fixed<T> {
    fn jet(&self, t: J, order: Order) -> CurveJet<J> {
        let at = t.value();
        let [_, _, dd] = self.0.jet(at, order.max(J::ORDER));
        let along = |t: J| {
            third_derivatives::tangent(|t, order| self.0.jet(t, order), || self.0.breaks(), t)
        };
        let d = if order == Order::Zero { Vec3::zero() } else { along(t) };
        // All sections of a loft have the same parametrisation, so t has no derivatives along the
        // second parameter.
        [self.0.at(t), d, dd.map(J::fixed)]
    }
    moldloft_num::curve_facts!(breaks of [self.0], open, not_rational);
    moldloft_num::curve_one_by_one!(J);
}

fn of_foil(error: FoilError, fields: FoilFields) -> CallError {
    let text = error.to_string();
    match error {
        FoilError::Family { name } => CallError::new("unknown-name", text)
            .expected(Section::<f64>::FAMILIES.map(|n| format!("\"{n}\"")).join(", "))
            .found(format!("\"{name}\""))
            .in_field(fields.family),
        FoilError::Mean { name } => CallError::new("unknown-name", text)
            .expected(Section::<f64>::MEANS.map(|n| format!("\"{n}\"")).join(", "))
            .found(format!("\"{name}\""))
            .in_field(fields.mean),
        FoilError::Range { name, value, min, max } => {
            let field = match name {
                "a nose index" => fields.nose_index,
                "the position of the greatest thickness" => fields.thickness_at,
                "the position of the greatest camber" => fields.camber_at,
                _ => fields.load,
            };
            CallError::new("out-of-range", text)
                .expected(format!("a number from {min} to {max}"))
                .found(value.to_string())
                .in_field(field)
        }
        FoilError::Ordinates { index, .. } => CallError::new("no-section", text)
            .expected("{x, half thickness, camber} with x ascending from 0 to 1")
            .in_item(index)
            .in_field(fields.ordinates),
        FoilError::Points { actual } => CallError::new("wrong-length", text)
            .expected("3 points (half a section), 4 (symmetric) or 5 (cambered)")
            .found(actual.to_string())
            .in_field(fields.points),
        FoilError::NoChord => CallError::new("coincident-points", text)
            .expected("a leading edge distinct from the trailing edge")
            .found("no chord between them")
            .in_field(fields.points),
        FoilError::Metric => CallError::new("out-of-range", text)
            .expected("{uu, uv, vv} with uu > 0 and uu vv > uv^2")
            .in_field(fields.metric),
        FoilError::NoSlope => CallError::new("unused-argument", text)
            .expected("offset = \"affine\" with a section of one's own")
            .in_field(fields.offset),
        FoilError::NotFinite { index } => {
            CallError::new("not-finite", text).in_item(index).in_field(fields.points)
        }
    }
}
