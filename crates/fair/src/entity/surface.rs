use super::{ACCURACY, Places, Role, fault, measure, role};
use crate::{Bound, FairError, Limit, Network, Space, Spacing, fit_with, interpolate};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{
    Array, ArrayShape, Build, Class, Context, Fault, FromValue, Kind, SurfaceRef, Value,
};
use moldloft_spline::BSplineSurface;
use std::sync::Arc;

/// A grid of points.
struct Grid<T: Real>(Arc<Array<Vec3<T>>>);

impl<T: Real> FromValue<T> for Grid<T> {
    const CLASS: Class = Class::Vectors;
    fn from_value(value: &Value<T>) -> Result<Self, Fault> {
        match value {
            Value::Vectors(array) => Ok(Self(array.clone())),
            other => Err(Fault::wrong_class(Class::Vectors, other.class())),
        }
    }
}

/// A fair B-spline surface within a tolerance of the one through a grid of points.
///
/// All rows and columns of the net are faired at once: the sum of the measure over both
/// directions is the least within the tolerance. The four corners keep position, tangents and
/// twist.
#[derive(Kind)]
#[kind(
    class = Surface,
    example = "Line a({0, 0, 0}, {4, 0, 0}); farray t = uniform(0, 1, 5); surface g[5, 5]; \
               vector up = {0, 1, 0.3}; g[1,] = distc(a, t); g[2,] = g[1,] + up; \
               g[3,] = g[2,] + {0, 1, 0.1}; g[4,] = g[2,] + {0, 2, 0}; g[5,] = g[1,] + {0, 4, 0}; \
               FairSurf s(g, 0.02);"
)]
pub struct FairSurf<T: Real> {
    /// A grid of points, at least degree + 2 in each direction.
    points: Grid<T>,
    /// How far the surface may be from the one through the points; 0 leaves it alone.
    #[field(min = 0)]
    tolerance: T,
    /// What there is to be little of; see `FairCurve`.
    #[field(default = "second")]
    measure: Arc<str>,
    /// What the points are: "fit" or "control".
    #[field(default = "fit")]
    r#as: Arc<str>,
    /// Polynomial degree in both directions.
    #[field(default = 3, min = 2, max = 9)]
    degree: usize,
}

impl<T: Real> Build<T> for FairSurf<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        let Grid(grid) = &self.points;
        let ArrayShape::Grid(m, n) = grid.shape else {
            return Err(Fault::new("wrong-shape", "a surface needs a grid of points")
                .expected("a grid [m, n] of vectors")
                .found(format!("a row {}", grid.shape))
                .in_field(0));
        };
        let measure = measure(&self.measure, 2)?;
        let fitted = match role(&self.r#as, 3)? {
            Role::Fit => true,
            Role::Control => false,
            Role::Points => {
                return Err(Fault::new("unknown-name", "surfaces have no role \"points\"")
                    .expected("\"fit\" or \"control\"")
                    .found("\"points\"")
                    .in_field(3));
            }
        };
        let places = Places { points: 0, tolerance: 1, degree: 4, breaks: 0 };
        let make = || -> Result<_, FairError> {
            let degree = self.degree;
            for actual in [m, n] {
                if actual < degree + 2 {
                    return Err(FairError::TooFew { expected: degree + 2, actual });
                }
            }
            let (mut spaces, mut net) =
                ([Space::clamped(degree, m)?, Space::clamped(degree, n)?], grid.items.clone());
            if fitted {
                let lines =
                    |net: &mut [Vec3<T>], start: &dyn Fn(usize) -> usize, count, step, length| {
                        let mut space = None;
                        for k in 0..count {
                            let at = |i: usize| start(k) + i * step;
                            let line: Vec<Vec3<T>> = (0..length).map(|i| net[at(i)]).collect();
                            let plain: Vec<_> = line.iter().map(|p| p.re()).collect();
                            let fit = interpolate(degree, &plain, Spacing::Uniform, false)?;
                            for (i, p) in fit_with(&fit, &line)?.into_iter().enumerate() {
                                net[at(i)] = p;
                            }
                            space = Some(fit.space);
                        }
                        Ok::<_, FairError>(space)
                    };
                let along_u = lines(&mut net, &|j| j, n, n, m)?;
                let along_v = lines(&mut net, &|i| i * n, m, 1, n)?;
                if let (Some(u), Some(v)) = (along_u, along_v) {
                    spaces = [u, v];
                }
            }
            let limit = Limit::ball(m * n, self.tolerance.re())?;
            let plain = net.iter().map(|p| p.re()).collect();
            let network = Network::net(spaces.clone(), plain, None, limit)?;
            let tolerances = vec![self.tolerance; m * n];
            let (points, _) =
                network.optimum_with(measure, Bound::ControlPoints, ACCURACY, &net, &tolerances)?;
            Ok((spaces, points))
        };
        let (spaces, points) = make().map_err(|e| fault(e, &places))?;
        let [u, v] = spaces.map(|s| s.knot_vector().0);
        let surface = BSplineSurface::new(u, v, points, None)
            .map_err(|e| Fault::new("no-spline", e.to_string()).in_field(0))?;
        Ok(Value::Surface(SurfaceRef::new(surface, 0)))
    }
}
