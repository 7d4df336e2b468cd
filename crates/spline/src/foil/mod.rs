//! Foil sections: thickness forms and mean lines of the NACA families, and how they are laid
//! between points.
//!
//! A section is parameterised by s in [-1, 1], with x = s^2 the distance from the nose in chords:
//! 1 to 0 is the upper side from tail to nose, 0 to -1 the lower side back to the tail. In s the
//! nose is smooth, where in x the slope is infinite; and the speed vanishes nowhere.
//!
//! `family, mean line -> Section -> Station (x, thickness, camber) -> Layout -> position`

mod error;
mod layout;
mod mean;
mod six_series;
mod station;
mod tables;
#[cfg(test)]
mod tests;
mod thickness;

pub use error::FoilError;
pub use layout::{Layout, Metric, Offset};
pub use mean::MeanLine;
pub use station::Station;
pub use thickness::Thickness;

use moldloft_num::{CurveFormula, Jet, Real, Vec3};
use std::sync::Arc;

/// Definition of a section by names; see [`Section::new`].
#[derive(Clone, Debug)]
pub struct SectionSpec<'a, T> {
    /// Thickness form: one of [`Section::FAMILIES`].
    pub family: &'a str,
    /// Mean line: one of [`Section::MEANS`], or empty for the default of the family.
    pub mean: &'a str,
    /// Position x of the greatest camber of the parabolic mean line, in (0, 1).
    pub camber_at: T,
    /// Extent a of the uniform load of the mean line "a", in [0, 1]; `None` for the default of the
    /// family.
    pub load: Option<T>,
    /// Nose index of the modified four-digit family: 6 is the standard leading edge, 0 a sharp one.
    pub nose_index: T,
    /// Position x of the greatest thickness of the modified four-digit family, in [0.2, 0.6].
    pub thickness_at: T,
    /// Greatest thickness in chords; the 6-series depend on it.
    pub ratio: T,
    /// True when the trailing edge is closed.
    pub closed: bool,
}

impl<T: Real> Default for SectionSpec<'_, T> {
    fn default() -> Self {
        Self {
            family: "4-digit",
            mean: "",
            camber_at: T::from(0.4),
            load: None,
            nose_index: T::from(6.0),
            thickness_at: T::from(0.3),
            ratio: T::from(0.12),
            closed: true,
        }
    }
}

/// A thickness form with a mean line.
///
/// # Example
/// ```
/// use moldloft_spline::foil::{Section, SectionSpec};
/// let open = SectionSpec { closed: false, ..SectionSpec::default() };
/// let section = Section::<f64>::new(&open).unwrap();
/// // NACA 0012 at x = 0.3, where it is thickest.
/// assert!((0.06 * section.at(0.3f64.sqrt()).thickness - 0.06002).abs() < 1e-5);
/// ```
#[derive(Clone)]
pub struct Section<T: Real> {
    thickness: Thickness<T>,
    mean: MeanLine<T>,
}

impl<T: Real> Section<T> {
    /// The names of the thickness forms.
    pub const FAMILIES: [&'static str; 13] = [
        "4-digit", "modified", "5-digit", "16", "63", "64", "65", "66", "63A", "64A", "65A",
        "66tmb", "67",
    ];

    /// The names of the mean lines.
    pub const MEANS: [&'static str; 13] = [
        "flat",
        "parabolic",
        "210",
        "220",
        "230",
        "240",
        "250",
        "221",
        "231",
        "241",
        "251",
        "a",
        "a modified",
    ];

    /// The section of these names and numbers.
    ///
    /// A closed tail of the four-digit forms has the textbook's last coefficient 0.1036 in place of
    /// 0.1015; those of the other forms are drawn to a point by a cubic behind the greatest
    /// thickness, which leaves nose and greatest thickness as they are.
    ///
    /// # Errors
    /// [`FoilError`] for an unknown name or a number out of range.
    pub fn new(spec: &SectionSpec<T>) -> Result<Self, FoilError> {
        let within = |name, x: T, min: f64, max: f64| {
            let value = x.re();
            if x.is_finite() && (min..=max).contains(&value) {
                return Ok(x);
            }
            Err(FoilError::Range { name, value, min, max })
        };
        let modified = |index: T, at: T| {
            let index = within("a nose index", index, 0.0, 9.0)?;
            let at = within("the position of the greatest thickness", at, 0.2, 0.6)?;
            Ok(Thickness::modified(index, at))
        };
        let half = T::from(0.5);
        let thickness = match spec.family {
            "4-digit" | "5-digit" => Thickness::four_digit(spec.closed),
            "modified" => modified(spec.nose_index, spec.thickness_at)?,
            // NACA 16-0xx is 00xx-45.
            "16" => modified(T::from(4.0), half)?,
            "66tmb" => Thickness::tmb(),
            name => six_series::thickness(name, spec.ratio)
                .ok_or_else(|| FoilError::Family { name: name.to_string() })?,
        };
        let thickness = if spec.closed { thickness.closed() } else { thickness };
        let usual = match spec.family {
            "4-digit" | "modified" => "parabolic",
            "5-digit" => "230",
            "63A" | "64A" | "65A" => "a modified",
            _ => "a",
        };
        let load = spec.load.unwrap_or(T::from(if spec.family == "66tmb" { 0.8 } else { 1.0 }));
        let mean = match if spec.mean.is_empty() { usual } else { spec.mean } {
            "flat" => MeanLine::flat(),
            "parabolic" => {
                let at = within("the position of the greatest camber", spec.camber_at, 0.01, 0.99)?;
                MeanLine::parabolic(at)
            }
            "a" => MeanLine::uniform_load(within("the extent of the load", load, 0.0, 1.0)?),
            "a modified" => MeanLine::uniform_load_modified(),
            name => {
                MeanLine::cubic(name).ok_or_else(|| FoilError::Mean { name: name.to_string() })?
            }
        };
        Ok(Self { thickness, mean })
    }

    /// The section of ordinates (x, half thickness, camber) from the leading edge, x = 0, to the
    /// trailing edge, x = 1, in units of the chord, of half the greatest thickness and of the
    /// greatest camber.
    ///
    /// They are joined by a cubic spline in the square root of x.
    ///
    /// # Errors
    /// [`FoilError::Ordinates`].
    pub fn of_ordinates(ordinates: &[Vec3<T>]) -> Result<Self, FoilError> {
        Ok(Self { thickness: Thickness::of_ordinates(ordinates)?, mean: MeanLine::InOrdinates })
    }

    /// The section of a curve of ordinates (x, half thickness, camber), from leading to trailing
    /// edge; the sides have the curve's parameter.
    pub fn of_curve(curve: Arc<dyn moldloft_num::Curve<T>>) -> Self {
        Self { thickness: Thickness::Curve(curve), mean: MeanLine::InOrdinates }
    }

    /// The same section, prepared for evaluation at many parameters; for a single section, not
    /// those of a loft.
    pub fn settled(self) -> Self {
        Self { thickness: self.thickness.settled(), ..self }
    }

    /// The station at `s` in [-1, 1]; beyond, its formula continues.
    ///
    /// The slope of the mean lines with uniform load is infinite at the nose: in front of x = 1/75
    /// the slope is taken at an x that tends smoothly to 0.005, as usual (Abbott and von Doenhoff
    /// 1959, section 6.5).
    pub fn at<J: Jet<T>>(&self, s: J) -> Station<J> {
        let lower = s.re() < 0.0;
        let a = if lower { -s } else { s };
        let (x, thickness, camber) = self.thickness.at(a);
        let thickness = if lower { -thickness } else { thickness };
        let (camber, slope) = match camber {
            Some(camber) => (camber, J::zero()),
            None => self.mean.at(x),
        };
        Station { x, thickness, camber, slope, lower }
    }

    /// True when the mean line has a slope.
    pub fn has_slope(&self) -> bool {
        !matches!(self.mean, MeanLine::InOrdinates)
    }

    /// True when thickness and camber are zero at the trailing edge, up to rounding.
    pub fn is_closed(&self) -> bool {
        let tail = self.at(T::one());
        tail.thickness.re().abs() <= 1e-12 && tail.camber.re().abs() <= 1e-12
    }

    /// The parameters s in (0, 1) at which a second derivative may jump, ascending.
    pub fn breaks(&self) -> Vec<f64> {
        self.with_mean(self.thickness.breaks())
    }

    /// As `breaks`, without parameters at which only third derivatives jump.
    pub fn second_order_breaks(&self) -> Vec<f64> {
        self.with_mean(self.thickness.second_order_breaks())
    }

    fn with_mean(&self, mut breaks: Vec<f64>) -> Vec<f64> {
        breaks.extend(self.mean.breaks().into_iter().map(f64::sqrt));
        breaks.retain(|s| *s > 0.0 && *s < 1.0);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        breaks
    }
}

/// A section positioned in space or in a plane of parameters.
///
/// On [0, 1]: from nose to tail for a half section (three points), else from the tail along the
/// upper side to the nose, at 1/2, and back along the lower side.
#[derive(Clone)]
pub struct Profile<T: Real> {
    /// The section.
    pub section: Arc<Section<T>>,
    /// Position of the section.
    pub layout: Layout<T>,
    /// Direction of the thickness.
    pub offset: Offset,
}

impl<T: Real> Profile<T> {
    /// The parameters at which a second derivative may jump, from those of the section.
    fn at_both_sides(&self, places: Vec<f64>) -> Vec<f64> {
        if self.layout.is_half() {
            return places;
        }
        let upper = places.iter().rev().map(|s| 0.5 * (1.0 - s));
        let lower = places.iter().map(|s| 0.5 * (1.0 + s));
        upper.chain([0.5]).chain(lower).collect()
    }

    /// The breaks without the parameters at which only third derivatives jump.
    pub fn second_order_breaks(&self) -> Vec<f64> {
        self.at_both_sides(self.section.second_order_breaks())
    }
}

impl<T: Real> CurveFormula for Profile<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let s = if self.layout.is_half() { t } else { -(t * 2.0) + 1.0 };
        self.layout.place(self.section.at(s), self.offset)
    }

    fn breaks(&self) -> Vec<f64> {
        self.at_both_sides(self.section.breaks())
    }

    fn kinks(&self) -> Vec<f64> {
        self.second_order_breaks()
    }

    moldloft_num::curve_facts!(joints_at_breaks, open, not_rational);
}
