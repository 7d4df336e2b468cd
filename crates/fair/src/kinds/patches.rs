//! `FairPatches` and `NetSurf`: surfaces with common edges, faired together.

use super::figures::FairFigures;
use super::options::shared_options;
use super::surface::{PointGrid, Rims, fitted, lines, turned};
use super::{ArgumentFields, PointRole, fault, measure, role};
use crate::curve::request::ACCURACY;
use crate::{Bound, EndContinuity, FairError, Limit, Network, PatchNet, Seam, Space, are_exact};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{ArrayShape, Build, CallError, Class, Context, Kind, SurfaceRef, Value};
use moldloft_spline::BSplineSurface;
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
        let measure = measure(&self.measure, Self::MEASURE)?;
        let fit = match role(&self.r#as, Self::AS)? {
            PointRole::Fit => true,
            PointRole::Control => false,
            PointRole::Points => {
                return Err(CallError::new("unknown-name", "surfaces have no role \"points\"")
                    .expected("\"fit\" or \"control\"")
                    .found("\"points\"")
                    .in_field(Self::AS));
            }
        };
        let keeps = match &*self.seams {
            "position" => EndContinuity::Position,
            "tangent" => EndContinuity::Tangent,
            "curvature" => EndContinuity::Curvature,
            word => {
                let known = ["position", "tangent", "curvature"];
                return Err(super::unknown("way to keep a seam", word, &known, Self::SEAMS));
            }
        };
        let Rims([south, east, north, west]) = self.rims;
        let places = ArgumentFields {
            points: Self::SURFACES,
            tolerance: Self::TOLERANCE,
            degree: Self::DEGREE,
            breaks: Self::SURFACES,
        };
        let degrees = [self.degree, self.degree_v.unwrap_or(self.degree)];
        let motion =
            super::motion(self.along, self.motion.as_deref(), [Self::ALONG, Self::MOTION])?;
        let bound = match &*self.bound {
            "points" => Bound::ControlPoints,
            "curve" => Bound::Bezier,
            word => {
                return Err(super::unknown("bound", word, &["points", "curve"], Self::BOUND));
            }
        };
        let near = match &*self.goal {
            "near" => true,
            "fairest" => false,
            word => return Err(super::unknown("goal", word, &["near", "fairest"], Self::GOAL)),
        };
        let mut exact = near && self.tolerance.re() > 0.0;
        let mut sheets = Vec::new();
        let mut given: Vec<Vec3<T>> = Vec::new();
        for (k, PointGrid(grid)) in self.surfaces.iter().enumerate() {
            let ArrayShape::Grid(m, n) = grid.shape else {
                return Err(CallError::new("wrong-shape", "a surface needs a grid of points")
                    .expected("a grid [m, n] of vectors")
                    .found(format!("a row {}", grid.shape))
                    .in_item(k)
                    .in_field(Self::SURFACES));
            };
            let made = || -> Result<(PatchNet, Vec<Vec3<T>>), FairError> {
                let few = [m, n].into_iter().zip(degrees).find(|&(c, degree)| c < degree + 2);
                if let Some((actual, degree)) = few {
                    return Err(FairError::TooFew { expected: degree + 2, actual });
                }
                let (spaces, net) = if fit {
                    let (u, net, _) = fitted(degrees[0], &grid.points(), m, &[])?;
                    let (v, net, _) = fitted(degrees[1], &turned(&net, u.count()), n, &[])?;
                    let net = turned(&net, v.count());
                    ([u, v], net)
                } else {
                    let spaces = [Space::clamped(degrees[0], m)?, Space::clamped(degrees[1], n)?];
                    (spaces, grid.points())
                };
                let limit = Limit::new(motion, vec![self.tolerance.re(); net.len()])?;
                let plain = net.iter().map(|p| p.re()).collect();
                let mut sheet = PatchNet::new(spaces, plain, limit);
                sheet.rims = [[west, east], [south, north]];
                Ok((sheet, net))
            };
            let (sheet, net) = made().map_err(|e| fault(e, &places).in_item(k))?;
            let plain: Vec<Vec3<f64>> = grid.points().iter().map(|p| p.re()).collect();
            exact = exact && are_exact(&plain, &lines([m, n], [false; 2]), &[]);
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
        type Made<T> = (Vec<Vec<Vec3<T>>>, Option<crate::Optimum>);
        let solve = |tolerance: T| -> Result<Made<T>, FairError> {
            let mut sheets = sheets.clone();
            for sheet in &mut sheets {
                sheet.limit.radii.fill(tolerance.re());
            }
            let network = Network::joined(&sheets, &seams)?;
            let points = network.gathered(&given);
            let tolerances = vec![tolerance; points.len()];
            let (faired, best) = if tolerance.re() == 0.0 {
                (points, None)
            } else {
                let (points, best) =
                    network.optimum_with(measure, bound, ACCURACY, &points, &tolerances)?;
                (points, Some(best))
            };
            Ok(((0..sheets.len()).map(|k| network.sheet(k, &faired)).collect(), best))
        };
        let contradicted = |e: FairError| match e {
            FairError::Contradiction { miss, .. } => {
                let text = format!(
                    "the surfaces cannot be continuous across their seams within the tolerance \
                    (missed by {miss:.3e})"
                );
                CallError::new("contradiction", text)
                    .expected("a larger tolerance, or surfaces that join more smoothly")
                    .in_field(Self::SEAMS)
            }
            FairError::TurnsBack => CallError::new("turns-back", e.to_string())
                .expected("surfaces that continue their neighbours")
                .in_field(Self::SURFACES),
            e => fault(e, &places),
        };
        // Exact surfaces: the smallest tolerance, in powers of 8, that admits the continuity.
        let size = given.iter().map(|p| p.re().norm()).fold(0.0, f64::max);
        let tries = (0..16).map(|k| ROUNDING * size * f64::powi(8.0, k));
        let smaller = tries.filter(|&t| exact && t < self.tolerance.re());
        let found = smaller
            .map(|t| solve(T::from(t)))
            .find(|made| !matches!(made, Err(FairError::Contradiction { .. })));
        let (faired, best) =
            found.unwrap_or_else(|| solve(self.tolerance)).map_err(contradicted)?;
        let surface = |(sheet, points): (&PatchNet, &Vec<Vec3<T>>)| {
            let [u, v] = sheet.spaces.each_ref().map(|s| s.knot_vector().0);
            let surface = BSplineSurface::new(u, v, points.clone(), None)
                .map_err(|e| CallError::new("no-spline", e.to_string()).in_field(Self::SURFACES))?;
            let made = best.as_ref().map(|b| (&b.certificate, Some(b.active), None));
            let own = FairFigures::of_moves(super::moves(points, &sheet.points), made);
            let surface = SurfaceRef::new(surface, 0);
            Ok(Value::Surface(surface.with_figures(&own.members_of_moves())))
        };
        let surfaces: Result<Vec<_>, CallError> = sheets.iter().zip(&faired).map(surface).collect();
        Ok(Value::list(surfaces?))
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
