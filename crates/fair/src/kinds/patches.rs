//! `FairPatches` and `NetSurf`: surfaces with common edges, faired together.

use super::figures::FairFigures;
use super::options::shared_options;
use super::surface::{PointGrid, Rims, counts, enough, fitted_net, is_fit, lines, net_surface};
use super::{ArgumentFields, fault, measure};
use crate::curve::request::ACCURACY;
use crate::{
    Bound, EndContinuity, FairError, Limit, Measure, Motion, Network, Optimum, PatchNet, Seam,
    Space, are_exact,
};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Build, CallError, Class, Context, Kind, Value};
use std::sync::Arc;

/// Move by rounding, relative to the size.
const ROUNDING: f64 = 1e-13;

shared_options! {
    {
        /// Surfaces with common edges, faired together within a tolerance, with continuous tangent
        /// planes or curvature across the edges.
        ///
        /// Each grid of points is a surface; two sides with the same points, in either direction,
        /// form a seam (also two sides of one surface). All points move together, so that the sum
        /// of the measure over all curves of the nets is minimal. `seams` is the continuity across
        /// seams; the ratio of the parameter speeds on both sides is that of the given surfaces.
        /// Corners that are not on a seam keep position, tangents and twist. The value is the list
        /// of the faired surfaces: `NetSurf` makes one an object.
        #[derive(Kind)]
        #[kind(
            forward,
            class = List,
            example = "Line a({0, 0, 0}, {4, 0, 0}); farray t = uniform(0, 1, 5); surface g[5, 5]; surface h[5, 5]; \
                       vector up = {0, 1, 0.3}; g[1,] = distc(a, t); g[2,] = g[1,] + up; \
                       g[3,] = g[2,] + {0, 1, 0.2}; g[4,] = g[2,] + {0, 2, 0.32}; g[5,] = g[1,] + {0, 4, 0.7}; \
                       h[1,] = g[5,]; h[2,] = g[5,] + {0, 1, 0.01}; h[3,] = g[5,] + {0, 2, 0}; \
                       h[4,] = g[5,] + {0, 3, -0.04}; h[5,] = g[5,] + {0, 4, -0.1}; \
                       FairPatches n({g, h}, 0.2); NetSurf first(n, 1); NetSurf second(n, 2);"
        )]
        pub struct FairPatches<T: Real>
    }
    {
        /// Grids of points, each at least degree + 2 in each direction.
        #[field(min_items = 1)]
        surfaces: Vec<PointGrid<T>>,
        /// Largest move of control points, in units of length; 0: unchanged.
        #[field(min = 0)]
        tolerance: T,
        /// Measure to minimise; see `FairCurve`.
        #[field(default = "second")]
        measure: Arc<str>,
        /// Role of the points: "fit" (interpolated, then faired) or "control" (control points).
        #[field(default = "fit")]
        r#as: Arc<str>,
        /// Polynomial degree along u, and along v without `degree_v`.
        #[field(default = 3, min = 2, max = 9)]
        degree: usize,
        /// Continuity across seams: "position", "tangent" or "curvature".
        #[field(default = "curvature")]
        seams: Arc<str>,
        /// Condition at rims that are not seams; see `FairSurf`.
        #[field(default = "corners")]
        rims: Rims,
        /// "fairest" (minimum of the measure), or "near": the same, except that grids whose lines
        /// are all exact (lines, conics, plane cubics, helices) move only as far as the continuity
        /// across seams requires, within a factor of 8.
        #[field(default = "near")]
        goal: Arc<str>,
        /// Polynomial degree along v. Default: `degree`.
        #[field(default, min = 2, max = 9)]
        degree_v: Option<usize>,
    }
    [along]
    {
        /// Quantity that the tolerance bounds: "points" (move of each control point) or "curve"
        /// (move of the surfaces, which allows larger moves of control points).
        #[field(default = "points")]
        bound: Arc<str>,
    }
}

impl<T: Real> Build<T> for FairPatches<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let task = self.task()?;
        let (faired, best) = task.fair().map_err(Self::unmade)?;
        let surface = |(sheet, points): (&PatchNet, Vec<Vec3<T>>)| {
            let figures = FairFigures::of_net(super::moves(&points, &sheet.points), best.as_ref());
            net_surface(&sheet.spaces, points, None, figures, Self::SURFACES)
        };
        let surfaces: Result<Vec<_>, CallError> =
            task.sheets.iter().zip(faired).map(surface).collect();
        Ok(Value::list(surfaces?))
    }
}

/// Control nets of surfaces with their seams, before fairing.
struct PatchTask<T> {
    sheets: Vec<PatchNet>,
    seams: Vec<Seam>,
    /// Control points of all surfaces.
    given: Vec<Vec3<T>>,
    tolerance: T,
    /// True if the surfaces move only as far as the continuity requires.
    exact: bool,
    measure: Measure,
    bound: Bound,
}

/// The control points of each surface, and the optimum, if one was solved for.
type FairedSheets<T> = (Vec<Vec<Vec3<T>>>, Option<Optimum>);

impl<T: Real> FairPatches<T> {
    const PLACES: ArgumentFields = ArgumentFields {
        points: Self::SURFACES,
        tolerance: Self::TOLERANCE,
        degree: Self::DEGREE,
        breaks: Self::SURFACES,
    };

    /// Checks the arguments, and finds the control nets and the seams.
    fn task(&self) -> Result<PatchTask<T>, CallError> {
        let measure = measure(&self.measure, Self::MEASURE)?;
        let fit = is_fit(&self.r#as, Self::AS)?;
        let keeps = match &*self.seams {
            "position" => EndContinuity::Position,
            "tangent" => EndContinuity::Tangent,
            "curvature" => EndContinuity::Curvature,
            word => {
                let known = ["position", "tangent", "curvature"];
                return Err(super::unknown("way to keep a seam", word, &known, Self::SEAMS));
            }
        };
        let motion =
            super::motion(self.along, self.motion.as_deref(), [Self::ALONG, Self::MOTION])?;
        let bound = super::bound_of_points(&self.bound, Self::BOUND)?;
        let near = match &*self.goal {
            "near" => true,
            "fairest" => false,
            word => return Err(super::unknown("goal", word, &["near", "fairest"], Self::GOAL)),
        };
        let mut exact = near && self.tolerance.re() > 0.0;
        let (mut sheets, mut given) = (Vec::new(), Vec::new());
        for (k, PointGrid(grid)) in self.surfaces.iter().enumerate() {
            let counts = counts(grid, Self::SURFACES).map_err(|e| e.in_item(k))?;
            let points = grid.points();
            let (sheet, net) = self
                .sheet(&points, counts, fit, motion)
                .map_err(|e| fault(e, &Self::PLACES).in_item(k))?;
            let plain: Vec<Vec3<f64>> = points.iter().map(|p| p.re()).collect();
            exact = exact && are_exact(&plain, &lines(counts, [false; 2]), &[]);
            sheets.push(sheet);
            given.extend(net);
        }
        // Rims that are seams have only the seam's conditions.
        let seams = Seam::found(&sheets, keeps);
        for seam in &seams {
            for k in 0..2 {
                let edge = seam.edges[k];
                sheets[seam.sheets[k]].rims[edge.direction][edge.end] = EndContinuity::Free;
            }
        }
        Ok(PatchTask { sheets, seams, given, tolerance: self.tolerance, exact, measure, bound })
    }

    /// The control net of a grid of points.
    fn sheet(
        &self,
        points: &[Vec3<T>],
        counts: [usize; 2],
        fit: bool,
        motion: Motion,
    ) -> Result<(PatchNet, Vec<Vec3<T>>), FairError> {
        let degrees = [self.degree, self.degree_v.unwrap_or(self.degree)];
        enough(counts, degrees)?;
        let (spaces, net) = if fit {
            let (spaces, net, _) = fitted_net(degrees, points, counts[0], &Default::default())?;
            (spaces, net)
        } else {
            let space = |d: usize| Space::clamped(degrees[d], counts[d]);
            ([space(0)?, space(1)?], points.to_vec())
        };
        let limit = Limit::new(motion, vec![self.tolerance.re(); net.len()])?;
        let mut sheet = PatchNet::new(spaces, net.iter().map(|p| p.re()).collect(), limit);
        sheet.rims = self.rims.sides();
        Ok((sheet, net))
    }

    /// Converts an error of the fairing to one at its argument.
    fn unmade(error: FairError) -> CallError {
        match error {
            FairError::Contradiction { miss, .. } => {
                let text = format!(
                    "the surfaces cannot be continuous across their seams within the tolerance \
                    (missed by {miss:.3e})"
                );
                CallError::new("contradiction", text)
                    .expected("a larger tolerance, or surfaces that join more smoothly")
                    .in_field(Self::SEAMS)
            }
            FairError::TurnsBack => CallError::new("turns-back", error.to_string())
                .expected("surfaces that continue their neighbours")
                .in_field(Self::SURFACES),
            other => fault(other, &Self::PLACES),
        }
    }
}

impl<T: Real> PatchTask<T> {
    /// The faired surfaces. Exact surfaces have the smallest tolerance, in powers of 8, that admits
    /// the continuity.
    fn fair(&self) -> Result<FairedSheets<T>, FairError> {
        let size = self.given.iter().map(|p| p.re().norm()).fold(0.0, f64::max);
        let tries = (0..16).map(|k| ROUNDING * size * f64::powi(8.0, k));
        tries
            .filter(|&t| self.exact && t < self.tolerance.re())
            .map(|t| self.within(T::from(t)))
            .find(|made| !matches!(made, Err(FairError::Contradiction { .. })))
            .unwrap_or_else(|| self.within(self.tolerance))
    }

    /// The fairest surfaces within a tolerance.
    fn within(&self, tolerance: T) -> Result<FairedSheets<T>, FairError> {
        let mut sheets = self.sheets.clone();
        for sheet in &mut sheets {
            sheet.limit.radii.fill(tolerance.re());
        }
        let network = Network::joined(&sheets, &self.seams)?;
        let points = network.gathered(&self.given);
        let (faired, best) = if tolerance.re() == 0.0 {
            (points, None)
        } else {
            let tolerances = vec![tolerance; points.len()];
            let (measure, bound) = (self.measure, self.bound);
            let (points, best) =
                network.optimum_with(measure, bound, ACCURACY, &points, &tolerances)?;
            (points, Some(best))
        };
        Ok(((0..sheets.len()).map(|k| network.sheet(k, &faired)).collect(), best))
    }
}

/// One surface of a `FairPatches`, as an object.
///
/// Members: `deviation` (largest move of its control points) and, for all surfaces together,
/// `value`, `gap` and `active`; see `FairCurve`.
#[derive(Kind)]
#[kind(
    forward,
    class = Surface,
    example = "Line a({0, 0, 0}, {4, 0, 0}); farray t = uniform(0, 1, 5); surface g[5, 5]; \
               g[1,] = distc(a, t); g[2,] = g[1,] + {0, 1, 0.3}; g[3,] = g[1,] + {0, 2, 0.4}; \
               g[4,] = g[1,] + {0, 3, 0.3}; g[5,] = g[1,] + {0, 4, 0}; \
               FairPatches n({g}, 0.02); NetSurf s(n, 1);"
)]
pub struct NetSurf<T: Real> {
    /// A `FairPatches`.
    net: Value<T>,
    /// Number of the surface in the list, from 1.
    #[field(min = 1)]
    index: usize,
}

impl<T: Real> Build<T> for NetSurf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let Value::List(surfaces) = &self.net else {
            return Err(CallError::wrong_class(Class::List, self.net.class())
                .expected("surfaces that are faired together, a FairPatches")
                .in_field(Self::NET));
        };
        match surfaces.get(self.index.wrapping_sub(1)) {
            Some(Value::Surface(surface)) => Ok(Value::Surface(surface.clone())),
            Some(other) => {
                Err(CallError::wrong_class(Class::Surface, other.class()).in_item(self.index - 1))
            }
            None => {
                Err(CallError::new("out-of-range", format!("there is no surface {}", self.index))
                    .expected(format!("a number from 1 to {}", surfaces.len()))
                    .found(self.index.to_string())
                    .in_field(Self::INDEX))
            }
        }
    }
}
