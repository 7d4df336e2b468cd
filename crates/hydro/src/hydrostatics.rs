//! Hydrostatic figures by name: displacement, waterplane, form coefficients, metacentres.

use moldloft_num::{Real, Vec3};

/// Symmetry of a skin.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Symmetry {
    /// The whole body.
    #[default]
    None,
    /// One side of the plane y = 0; the figures are those of both sides.
    MirroredTwice,
    /// One side of the plane y = 0; the figures are those of this side alone.
    MirroredOnce,
}

/// The displaced volume by the divergence theorem with three fields, which agree for a surface that
/// is open at most in the waterplane and in the symmetry plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeForms<T> {
    /// Integral of (x - x0) n_x, x0 in the middle of the body.
    pub x: T,
    /// Integral of (y - y0) n_y, with y0 = 0 for a mirrored body, otherwise in its middle.
    pub y: T,
    /// Integral of (z - level) n_z: the value used, independent of the open top and side.
    pub z: T,
}

/// The waterplane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waterplane<T> {
    /// Area.
    pub area: T,
    /// Centre of the area, at the level of the water.
    pub centre: Vec3<T>,
    /// Second moment about the longitudinal axis through the centre: the integral of (y - yc)^2.
    pub transverse_moment: T,
    /// Second moment about the transverse axis through the centre: the integral of (x - xc)^2.
    pub longitudinal_moment: T,
    /// The ends of the waterline, its lowest and highest x.
    pub ends: [T; 2],
    /// Extent in x.
    pub length: T,
    /// Extent in y.
    pub beam: T,
    /// Immersed area of the section half-way between the ends.
    pub midship_area: T,
}

/// Form coefficients, ratios of the immersed body to bounding shapes (Lewis 1988, Principles of
/// Naval Architecture I, 2.3); the length and beam are those of the waterline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormCoefficients<T> {
    /// Volume / (length beam draft).
    pub block: T,
    /// Volume / (midship area length).
    pub prismatic: T,
    /// Midship area / (beam draft).
    pub midship: T,
    /// Waterplane area / (length beam).
    pub waterplane: T,
}

/// Hydrostatic figures of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hydrostatics<T> {
    /// Height z of the water.
    pub level: T,
    /// Displaced volume.
    pub volume: T,
    /// Density times volume.
    pub displacement: T,
    /// Centre of buoyancy; `None` for a body above the water.
    pub buoyancy_centre: Option<Vec3<T>>,
    /// Area of the skin below the water.
    pub wetted_area: T,
    /// Depth of the lowest point below the water; zero for a body above the water.
    pub draft: T,
    /// The waterplane; `None` for a body above or below the water.
    pub waterplane: Option<Waterplane<T>>,
    /// Form coefficients; `None` without waterplane.
    pub coefficients: Option<FormCoefficients<T>>,
    /// The volume by three fields, for one or both sides as requested.
    pub forms: VolumeForms<T>,
    /// Maximum difference between the forms over the volume; at rounding level for a closed skin.
    pub closure_error: f64,
    /// Difference between the waterplane area from the skin and from the waterline, over the area.
    pub waterplane_error: f64,
    /// Number of open edges below the water, without those in the symmetry plane: 0 for a
    /// watertight skin.
    pub open_edges: usize,
    /// True when the normals of the skin point outward; otherwise the figures are those of the
    /// reversed skin.
    pub outward: bool,
}

impl<T: Real> Hydrostatics<T> {
    /// Height of the centre of buoyancy above the lowest point.
    pub fn kb(&self) -> Option<T> {
        Some(self.draft + self.buoyancy_centre?.z - self.level)
    }

    /// Transverse metacentric radius: second moment of the waterplane / volume.
    pub fn bm_transverse(&self) -> Option<T> {
        self.waterplane.map(|w| w.transverse_moment / self.volume)
    }

    /// Longitudinal metacentric radius.
    pub fn bm_longitudinal(&self) -> Option<T> {
        self.waterplane.map(|w| w.longitudinal_moment / self.volume)
    }

    /// Height of the transverse metacentre above the lowest point.
    pub fn km_transverse(&self) -> Option<T> {
        Some(self.kb()? + self.bm_transverse()?)
    }

    /// Height of the longitudinal metacentre above the lowest point.
    pub fn km_longitudinal(&self) -> Option<T> {
        Some(self.kb()? + self.bm_longitudinal()?)
    }

    /// Every figure by its name in tables, JSON and derivatives, in a fixed order; undefined ones
    /// (no waterplane) are omitted.
    pub fn figures(&self) -> Vec<(&'static str, T)> {
        let mut rows = vec![
            ("volume", self.volume),
            ("displacement", self.displacement),
            ("wetted_area", self.wetted_area),
            ("draft", self.draft),
        ];
        if let Some(c) = self.buoyancy_centre {
            rows.extend([("lcb", c.x), ("tcb", c.y), ("vcb", c.z)]);
        }
        if let Some(w) = self.waterplane {
            rows.extend([
                ("waterplane_area", w.area),
                ("lcf", w.centre.x),
                ("tcf", w.centre.y),
                ("waterplane_it", w.transverse_moment),
                ("waterplane_il", w.longitudinal_moment),
                ("waterline_low_x", w.ends[0]),
                ("waterline_high_x", w.ends[1]),
                ("waterline_length", w.length),
                ("waterline_beam", w.beam),
                ("midship_area", w.midship_area),
            ]);
        }
        if let Some(c) = self.coefficients {
            rows.extend([
                ("cb", c.block),
                ("cp", c.prismatic),
                ("cm", c.midship),
                ("cwp", c.waterplane),
            ]);
        }
        let heights = [
            ("kb", self.kb()),
            ("bmt", self.bm_transverse()),
            ("bml", self.bm_longitudinal()),
            ("kmt", self.km_transverse()),
            ("kml", self.km_longitudinal()),
        ];
        rows.extend(heights.into_iter().filter_map(|(name, value)| Some((name, value?))));
        rows
    }
}
