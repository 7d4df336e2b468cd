//! Nearest points and intersections of a model's curves and surfaces, for many points at once.
//! Shapes are prepared for searches once and cached by the name of their object while its shape is
//! unchanged. Results do not depend on the cache.

use moldloft_budget::Budget;
use moldloft_locate::branches::{Branches, CutSurface};
use moldloft_locate::curve_pairs::all_curve_curve;
use moldloft_locate::march::Crossing;
use moldloft_locate::roots::{all_curve_surface, all_on_level};
use moldloft_locate::{FoundRoot, Level, Nearest, NearestCurve, NearestSurface, Roots, by_place};
use moldloft_num::{Plane, Vec3};
use moldloft_parallel::prelude::*;
use moldloft_registry::{CurveRef, SurfaceRef, Value};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Points per task of a thread.
const CHUNK: usize = 256;

/// Maximum number of cached shapes.
const KEPT: usize = 64;

/// Shapes prepared for searches.
#[derive(Default)]
pub struct Searches {
    kept: Mutex<SearchCache>,
}

/// By the name of the object, each with the shape it was prepared from.
#[derive(Default)]
struct SearchCache {
    surfaces: HashMap<String, (SurfaceRef<f64>, Arc<NearestSurface>)>,
    curves: HashMap<String, (CurveRef<f64>, Arc<NearestCurve>)>,
    cuts: HashMap<String, (SurfaceRef<f64>, Arc<CutSurface>)>,
}

/// Nearest points, in the order of the points given.
pub enum NearestPoints {
    /// The results for a curve.
    Curve(Vec<Nearest<1>>),
    /// The results for a surface.
    Surface(Vec<Nearest<2>>),
}

/// The second operand of an intersection.
pub enum With {
    /// A plane.
    Plane(Plane<f64>),
    /// A curve.
    Curve(CurveRef<f64>),
    /// A surface, prepared by [`Searches::cut`].
    Surface(SurfaceRef<f64>, Arc<CutSurface>),
}

/// Result of an intersection.
pub enum Meeting {
    /// Points.
    Points(CommonPoints),
    /// Curves; true when both operands are parametric surfaces.
    Branches(Branches, bool),
}

/// Isolated common points.
pub struct CommonPoints {
    /// Parameters of the first operand at each point, `widths[0]` each.
    pub ours: Vec<Vec<f64>>,
    /// Parameters of the second operand at each point, `widths[1]` each.
    pub theirs: Vec<Vec<f64>>,
    /// Number of parameters of each operand.
    pub widths: [usize; 2],
    /// Positions.
    pub xyz: Vec<Vec3>,
    /// True at points of tangential contact.
    pub tangent: Vec<bool>,
    /// True when all common points were found.
    pub complete: bool,
    /// Parameters of the nearest points of two curves that do not meet, and their distance; `None` for other shapes and for
    /// incomplete searches.
    pub nearest: Option<([f64; 2], f64)>,
}

impl CommonPoints {
    fn of<const N: usize>(roots: &Roots<N>, ours: &[usize], theirs: &[usize]) -> Meeting {
        Meeting::Points(Self::listed(roots, ours, theirs))
    }

    fn of_curves(roots: &Roots<2>) -> Meeting {
        let nearest = roots.closest.filter(|_| roots.complete && roots.roots.is_empty());
        Meeting::Points(Self { nearest, ..Self::listed(roots, &[0], &[1]) })
    }

    fn listed<const N: usize>(roots: &Roots<N>, ours: &[usize], theirs: &[usize]) -> Self {
        let part = |which: &[usize]| -> Vec<Vec<f64>> {
            let row = |r: &FoundRoot<N>| which.iter().map(|&k| r.at[k]).collect();
            roots.roots.iter().map(row).collect()
        };
        Self {
            ours: part(ours),
            theirs: part(theirs),
            widths: [ours.len(), theirs.len()],
            xyz: roots.roots.iter().map(|r| r.xyz).collect(),
            tangent: roots.roots.iter().map(|r| r.tangent).collect(),
            complete: roots.complete,
            nearest: None,
        }
    }
}

impl Searches {
    /// The points of a curve or surface nearest to given ones; `None` for anything else. The answer
    /// is incomplete when `budget` is spent.
    pub fn nearest(
        &self,
        name: &str,
        value: &Value<f64>,
        points: &[Vec3],
        budget: &Budget,
    ) -> Option<NearestPoints> {
        match value {
            Value::Surface(surface) => {
                let prepare = |s: &SurfaceRef<f64>| NearestSurface::new(&**s);
                let found =
                    self.prepared(name, surface, |k| &mut k.surfaces, SurfaceRef::same, prepare);
                let answer = |p: Vec3| found.nearest(&**surface, p);
                Some(NearestPoints::Surface(answered(points, budget, answer)))
            }
            Value::Curve(curve) => {
                let prepare = |c: &CurveRef<f64>| NearestCurve::new(&**c);
                let found = self.prepared(name, curve, |k| &mut k.curves, CurveRef::same, prepare);
                let answer = |p: Vec3| found.nearest(&**curve, p);
                Some(NearestPoints::Curve(answered(points, budget, answer)))
            }
            _ => None,
        }
    }

    /// A surface prepared for intersections.
    pub fn cut(&self, name: &str, surface: &SurfaceRef<f64>) -> Arc<CutSurface> {
        let prepare = |s: &SurfaceRef<f64>| CutSurface::new(&**s);
        self.prepared(name, surface, |kept| &mut kept.cuts, SurfaceRef::same, prepare)
    }

    /// Intersection of a curve or surface with something; `None` for other values.
    pub fn intersection(&self, name: &str, value: &Value<f64>, with: &With) -> Option<Meeting> {
        Some(match (value, with) {
            (Value::Surface(surface), With::Curve(curve)) => {
                // The first operand has u and v, the second t.
                CommonPoints::of(&all_curve_surface(&**curve, &**surface), &[1, 2], &[0])
            }
            (Value::Surface(surface), With::Plane(plane)) => {
                let cut = self.cut(name, surface);
                let crossing = Crossing::with_plane(&**surface, *plane);
                Meeting::Branches(crossing.branches_in(&cut, None), false)
            }
            (Value::Surface(surface), With::Surface(other, second)) => {
                let cut = self.cut(name, surface);
                let crossing = Crossing::with_surface(&**surface, &**other);
                Meeting::Branches(crossing.branches_in(&cut, Some(second)), true)
            }
            (Value::Curve(curve), With::Plane(plane)) => {
                let offset = plane.normal.dot(plane.point);
                let level = Level::Plane { normal: plane.normal, offset };
                CommonPoints::of(&all_on_level(&**curve, &level), &[0], &[])
            }
            (Value::Curve(curve), With::Curve(other)) => {
                CommonPoints::of_curves(&all_curve_curve(&**curve, &**other, 0.0))
            }
            (Value::Curve(curve), With::Surface(other, _)) => {
                CommonPoints::of(&all_curve_surface(&**curve, &**other), &[0], &[1, 2])
            }
            _ => return None,
        })
    }

    /// The prepared shape of an object, from the cache if the object is unchanged.
    fn prepared<S: Clone, P>(
        &self,
        name: &str,
        shape: &S,
        of: fn(&mut SearchCache) -> &mut HashMap<String, (S, Arc<P>)>,
        same: fn(&S, &S) -> bool,
        prepare: impl FnOnce(&S) -> P,
    ) -> Arc<P> {
        let lock = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((kept, prepared)) = of(&mut lock()).get(name)
            && same(kept, shape)
        {
            return prepared.clone();
        }
        let made = Arc::new(prepare(shape));
        let mut kept = lock();
        let map = of(&mut kept);
        if map.len() >= KEPT {
            map.clear();
        }
        map.insert(name.to_owned(), (shape.clone(), made.clone()));
        made
    }
}

/// Results for many points, in order.
fn answered<const N: usize>(
    points: &[Vec3],
    budget: &Budget,
    answer: impl Fn(Vec3) -> Nearest<N> + Sync,
) -> Vec<Nearest<N>> {
    let chunk = |points: &[Vec3]| -> Vec<Nearest<N>> {
        if budget.is_spent() {
            return Vec::new();
        }
        points.iter().map(|p| answer(*p)).collect()
    };
    if points.len() <= CHUNK {
        return chunk(points);
    }
    // Consecutive points should be near each other, so that they share search results.
    let order = by_place(points);
    let sorted: Vec<Vec3> = order.iter().map(|&k| points[k as usize]).collect();
    let found: Vec<Nearest<N>> = sorted.par_chunks(CHUNK).flat_map_iter(chunk).collect();
    let Some(&first) = found.first() else { return found };
    let mut all = vec![first; points.len()];
    for (k, answer) in order.into_iter().zip(found) {
        all[k as usize] = answer;
    }
    all
}
