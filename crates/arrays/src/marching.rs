//! Hyperbolic marching in the language.

use crate::grids::{EDGES, extended, fault, unknown};
use crate::value::{GridArg, Points, block, distinct_neighbours, gathered, surface};
use moldloft_grid::{
    GridError, Hyperbolic, JoinFault, MarchBoundary, MarchReport, OpenFrontEdges, Stop, Support,
    SurfaceGrid, hyperbolic_curve_until, hyperbolic_surfaces_until, hyperbolic_until,
};
use moldloft_num::{Order, Real, Vec3};
use moldloft_registry::{
    ArrayShape, Build, CallError, Context, FieldId, FromValue, Kind, Scalar, SurfaceRef, Value,
};
use std::sync::Arc;

/// A grid marched off a surface or a curve by the hyperbolic equations (Steger and Chaussee 1980;
/// Chan and Steger 1992): its lines leave at right angles, and its layers are at given heights.
///
/// Off a surface, along s_i x s_j: the value is a block, the surface its first layer. Off a list of
/// surfaces, marched as one front: the value is the list of their blocks. Edges whose points
/// coincide to 1e-8 of the size are joined, also of one surface, in either direction, with any
/// number of edges at a point; collapsed edges are poles; all blocks are on the side of the first
/// surface, so that of a surface with the opposite normal is left-handed. Off a curve,
/// to the left of its direction for a view against `normal`: the value is the surface whose line
/// g[k,] is layer k, in the plane of the curve or on the surface `on` (a collar). The first layer
/// has its height everywhere, also at corners and sharp tails; heights farther out are means.
/// `sides` gives conditions at edges, as "i1 pole, j1 symmetry z, jn symmetry z": "pole" for an
/// edge that is one point; "symmetry x", "y" or "z" for an edge in a symmetry plane of constant x,
/// y or z; "constant x", "y" or "z" for an edge that only keeps that coordinate, "constant xy" and the like
/// for one that keeps two; "splay 0.25" for a free edge that leans outward, continued beyond itself
/// by cells 1.25 times as long; "periodic" for two coincident edges; edges without a condition are
/// free. Of a list, "symmetry y" is the condition of all open edges, and "2 j1 constant x" that of
/// one edge of surface 2. The ends of a curve are "i1" and "im".
/// Every cell is tested; a layer that would fold is marched with weaker constraints and more
/// smoothing, or is an error with layer, position and cause. `stop` ends a march early: "keep"
/// (below the layer that cannot be marched), "jacobian 0.1", "skew 0.9", "growth 1.5" (below the
/// first layer with a worse cell), "isotropic" (with the first layer whose cells are as high as
/// long).
#[derive(Kind)]
#[kind(
    forward,
    class = Any,
    function,
    name = "hyperbolic",
    example = "curve c = uniform(0, 1, 9) * {1, 0, 0}; \
               surface g = hyperbolic(c, list(0, 0.1, 0.3)); assert |g[3,5] - {0.5, 0.3, 0}| < 1e-9;"
)]
pub struct HyperbolicGrid<T: Scalar> {
    /// The surface, the list of surfaces, or the curve.
    s: Value<T>,
    /// The distances of the layers, the first 0.
    heights: crate::value::Farray<T>,
    /// Conditions at the edges: "i1", "im", "j1", "jn" with "pole", "free", "periodic", "symmetry x", "symmetry y",
    /// "symmetry z", "constant x", "constant xy", "splay 0.25" and the like; of a list without an edge, or with the
    /// number of a surface before it.
    #[field(default = "")]
    sides: Arc<str>,
    /// Strength of the smoothing of converging lines; 0: none.
    #[field(default = 1, min = 0, max = 10)]
    smoothing: T,
    /// Normal of the plane of a curve, default z; with `on`, the visible side of the surface.
    normal: Option<Vec3<T>>,
    /// When the march ends early: "keep", "jacobian 0.1", "skew 0.9", "growth 1.5" or "isotropic".
    #[field(default = "")]
    stop: Arc<str>,
    /// The surface that a grid off a curve stays on.
    on: Option<SurfaceRef<T>>,
}

impl<T: Scalar> Build<T> for HyperbolicGrid<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        if let Some(surfaces) = self.surfaces()? {
            return self.front(&surfaces, context);
        }
        let heights = self.heights.row().map_err(|fault| fault.in_field(Self::HEIGHTS))?;
        let start = gathered(&self.s);
        let is_curve =
            matches!(&*start, Value::Vectors(a) if matches!(a.shape, ArrayShape::Row(_)));
        if let Value::Vectors(a) = &*start {
            extended(&a.planes, Self::S)?;
        }
        let options = Hyperbolic {
            heights,
            sides: sides(&self.sides, is_curve, Self::SIDES)?,
            smoothing: self.smoothing.re(),
            stop: stop(&self.stop, Self::STOP)?,
        };
        let marched = if is_curve {
            let Points(curve) =
                Points::from_value(&start).map_err(|fault| fault.in_field(Self::S))?;
            distinct_neighbours(&curve, Self::S)?;
            let support: Box<dyn Support<T>> = match &self.on {
                Some(surface) => {
                    let side = self.normal.map(|normal| normal.re());
                    Box::new(OrientedSurface { surface: surface.clone(), side })
                }
                None => {
                    let normal = self.normal.unwrap_or_else(|| Vec3::of(0.0, 0.0, 1.0));
                    let unit = normal.normalized().ok_or_else(|| {
                        CallError::new("no-direction", "the normal has no length")
                            .expected("a vector that is not zero")
                            .in_field(Self::NORMAL)
                    })?;
                    Box::new(InPlane { normal: unit })
                }
            };
            hyperbolic_curve_until(&curve, &*support, &options, &context.budget)
        } else {
            Self::check_no_support(self.on.as_ref())?;
            let GridArg(grid) =
                GridArg::from_value(&start).map_err(|fault| fault.in_field(Self::S))?;
            hyperbolic_until(&grid, &options, &context.budget)
        };
        let marched = marched.map_err(Self::fault)?;
        remark_stop(&marched.report, context);
        let mut layers = marched.layers.into_iter().map(surface);
        Ok(if is_curve {
            layers.next().expect("one grid off a curve")
        } else {
            Value::block(layers).expect("layers of one shape")
        })
    }
}

impl<T: Scalar> HyperbolicGrid<T> {
    fn fault(error: GridError) -> CallError {
        match error {
            GridError::Heights { .. } => fault(error, Self::HEIGHTS),
            GridError::Join(reason)
                if matches!(
                    *reason,
                    JoinFault::NotOpen { .. } | JoinFault::Open { .. } | JoinFault::NotPlane { .. }
                ) =>
            {
                fault(GridError::Join(reason), Self::SIDES)
            }
            error => fault(error, Self::S),
        }
    }

    fn check_no_support(on: Option<&SurfaceRef<T>>) -> Result<(), CallError> {
        if on.is_none() {
            return Ok(());
        }
        Err(CallError::new("unused-argument", "`on` applies to grids marched off curves")
            .expected("a curve to march from")
            .in_field(Self::ON))
    }

    /// The surfaces of a list; `None` for any other value.
    fn surfaces(&self) -> Result<Option<Vec<SurfaceGrid<T>>>, CallError> {
        let Value::List(items) = &self.s else { return Ok(None) };
        let is_grid = |item: &Value<T>| matches!(item, Value::Vectors(a) if matches!(a.shape, ArrayShape::Grid(..)));
        if !items.iter().any(is_grid) {
            return Ok(None);
        }
        let grid = |(k, item): (usize, &Value<T>)| {
            let in_list = |fault: CallError| fault.in_field(Self::S).in_item(k);
            let GridArg(grid) = GridArg::from_value(item).map_err(in_list)?;
            extended(&grid.planes, Self::S).map_err(in_list)?;
            Ok(grid)
        };
        items.iter().enumerate().map(grid).collect::<Result<_, _>>().map(Some)
    }

    /// The blocks off surfaces marched as one front.
    fn front(self, surfaces: &[SurfaceGrid<T>], context: &Context) -> Result<Value<T>, CallError> {
        Self::check_no_support(self.on.as_ref())?;
        let edges = open_edges(&self.sides, surfaces.len(), Self::SIDES)?;
        let mut options =
            Hyperbolic::new(self.heights.row().map_err(|fault| fault.in_field(Self::HEIGHTS))?);
        options.smoothing = self.smoothing.re();
        options.stop = stop(&self.stop, Self::STOP)?;
        let marched = hyperbolic_surfaces_until(surfaces, &edges, &options, &context.budget)
            .map_err(Self::fault)?;
        remark_stop(&marched.report, context);
        Ok(Value::list(marched.blocks.into_iter().map(|grid| block(grid.layers()))))
    }
}

fn remark_stop(report: &MarchReport, context: &Context) {
    if let Some(reason) = &report.stopped {
        context.remark(
            "stopped-early",
            format!("the march ends with layer {}: {reason}", report.layers),
            "the value contains the layers up to this one",
        );
    }
}

struct InPlane<T> {
    normal: Vec3<T>,
}

impl<T: Real> Support<T> for InPlane<T> {
    fn project(&self, points: &[Vec3<T>]) -> Vec<(Vec3<T>, Vec3<T>)> {
        points.iter().map(|p| (*p, self.normal)).collect()
    }
}

/// A surface of the language, seen from the side of a vector.
struct OrientedSurface<T: Scalar> {
    surface: SurfaceRef<T>,
    side: Option<Vec3>,
}

impl<T: Scalar> Support<T> for OrientedSurface<T> {
    fn project(&self, points: &[Vec3<T>]) -> Vec<(Vec3<T>, Vec3<T>)> {
        let (uv, _) = crate::locate::nearest_parameters(&self.surface, points);
        let foot = |[u, v]: [T; 2]| {
            let jet = self.surface.jet(u, v, Order::First);
            let unit = jet.u.cross(jet.v).normalized().unwrap_or_else(Vec3::zero);
            let away = self.side.is_some_and(|side| unit.re().dot(side) < 0.0);
            (jet.p, if away { -unit } else { unit })
        };
        uv.into_iter().map(foot).collect()
    }
}

fn stop(text: &str, field: FieldId) -> Result<Stop, CallError> {
    let mut stop = Stop::default();
    for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
        let words: Vec<&str> = part.split_whitespace().collect();
        let number = words.get(1).and_then(|word| word.parse::<f64>().ok());
        match (words[0], number, words.len()) {
            ("keep", None, 1) => stop.keep = true,
            ("isotropic", None, 1) => stop.isotropic = true,
            ("jacobian", Some(x), 2) if (0.0..1.0).contains(&x) => stop.jacobian = x,
            ("skew", Some(x), 2) if x > 0.0 && x <= 1.0 => stop.skewness = x,
            ("growth", Some(x), 2) if x > 1.0 && x.is_finite() => stop.growth = x,
            _ => {
                let expected =
                    "\"keep\", \"isotropic\", \"jacobian 0.1\", \"skew 0.9\" or \"growth 1.5\"";
                return Err(unknown(part, "criterion", expected.to_string(), field));
            }
        }
    }
    Ok(stop)
}

/// The condition of an edge or, off a curve, of an end.
fn condition(words: &[&str], is_curve: bool) -> Option<MarchBoundary> {
    let axis = |word: &str| ["x", "y", "z"].iter().position(|axis| *axis == word);
    Some(match words {
        ["free"] => MarchBoundary::Free,
        ["pole"] if !is_curve => MarchBoundary::Pole,
        ["periodic"] => MarchBoundary::Periodic,
        ["symmetry", word] => MarchBoundary::Symmetry(axis(word)?),
        ["constant", word] => match ["yz", "xz", "xy"].iter().position(|pair| pair == word) {
            Some(moving) => MarchBoundary::Along(moving),
            None => MarchBoundary::Constant(axis(word)?),
        },
        ["splay", share] => {
            let share = share.parse::<f64>().ok().filter(|share| (0.0..=10.0).contains(share))?;
            MarchBoundary::Splay(share)
        }
        _ => return None,
    })
}

fn sides(text: &str, is_curve: bool, field: FieldId) -> Result<[MarchBoundary; 4], CallError> {
    let mut sides = [MarchBoundary::Free; 4];
    for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
        let words: Vec<&str> = part.split_whitespace().collect();
        let bad = || {
            let expected =
                "\"i1 pole\", \"j1 symmetry z\", \"im periodic\" and the like".to_string();
            unknown(part, "side", expected, field)
        };
        let at = EDGES.iter().position(|(name, _)| Some(name) == words.first());
        let at = at.filter(|at| !is_curve || *at < 2).ok_or_else(bad)?;
        sides[at] = condition(&words[1..], is_curve).ok_or_else(bad)?;
    }
    for pair in [[0, 1], [2, 3]] {
        // Two edges are one line, or neither is the other.
        if pair.iter().any(|k| sides[*k] == MarchBoundary::Periodic) {
            pair.iter().for_each(|k| sides[*k] = MarchBoundary::Periodic);
        }
    }
    Ok(sides)
}

/// Conditions of a list of surfaces: "symmetry y" of all open edges, "2 j1 constant x" of one.
fn open_edges(text: &str, surfaces: usize, field: FieldId) -> Result<OpenFrontEdges, CallError> {
    let mut edges = OpenFrontEdges::all(surfaces, MarchBoundary::Free);
    for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
        let words: Vec<&str> = part.split_whitespace().collect();
        let bad = || {
            let expected = format!(
                "\"symmetry y\" for all open edges, or \"2 j1 free\" for an edge of one of {surfaces} surfaces"
            );
            unknown(part, "side", expected, field)
        };
        let Ok(number) = words[0].parse::<usize>() else {
            edges.others = condition(&words, false)
                .filter(|found| !matches!(found, MarchBoundary::Pole | MarchBoundary::Periodic))
                .ok_or_else(bad)?;
            continue;
        };
        let at = EDGES.iter().position(|(name, _)| Some(name) == words.get(1)).ok_or_else(bad)?;
        if number == 0 || number > surfaces {
            return Err(bad());
        }
        edges.stated[number - 1][at] = Some(condition(&words[2..], false).ok_or_else(bad)?);
    }
    Ok(edges)
}
