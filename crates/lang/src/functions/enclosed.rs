//! `volume(side, bottom, lid)`: the volume that surfaces enclose together.
//!
//! A set of surfaces is closed when the integrals of each smooth vector field along their boundaries cancel, each with
//! the side that faces outward. Integrals of more fields than surfaces thus give the sides, and refuse what is open.

use moldloft_diag::Diagnostic;
use moldloft_hydro::{USUAL_ACCURACY, surface_measures};
use moldloft_num::{Order, Real, Vec3, gauss_points};
use moldloft_registry::{Border, CurveRef, Scalar, SurfaceRef, Value};

/// Number of parts between two breaks of a boundary, each with eight Gauss points.
const PARTS: usize = 12;

/// Fields beyond the number of surfaces.
const MORE_FIELDS: usize = 6;

/// Integrals along boundaries, relative to the largest, that are zero.
const NOTHING: f64 = 1e-7;

/// Maximum difference of the weight of a surface from 1.
const WHOLE: f64 = 1e-4;

/// A surface, or a part of one.
pub(crate) enum EnclosingSide<'a, T: Real> {
    Whole(&'a SurfaceRef<T>),
    Trimmed(&'a Border<T>),
}

/// The surfaces among the arguments, lists of which count as their members; `None` if there is another value.
pub(crate) fn sides<T: Real>(values: &[Value<T>]) -> Option<Vec<EnclosingSide<'_, T>>> {
    let mut found = Vec::new();
    for value in values {
        match value {
            Value::Surface(surface) => found.push(EnclosingSide::Whole(surface)),
            Value::Body(body) => found.push(EnclosingSide::Trimmed(body.border.as_ref()?)),
            Value::List(items) => found.extend(sides(items)?),
            _ => return None,
        }
    }
    Some(found)
}

/// The volume that surfaces enclose.
pub(crate) fn enclosed<T: Scalar>(sides: &[EnclosingSide<'_, T>]) -> Result<T, Diagnostic> {
    let boundaries: Vec<Vec<[Vec3<T>; 2]>> = sides.iter().map(EnclosingSide::boundary).collect();
    let signs = signs(&boundaries)?;
    let mut volume = T::zero();
    for ((side, boundary), sign) in sides.iter().zip(&boundaries).zip(signs) {
        let cone = side.cone(boundary).ok_or_else(crate::value::member::not_finite)?;
        volume += cone * sign;
    }
    Ok(volume.abs())
}

impl<T: Scalar> EnclosingSide<'_, T> {
    /// Points and steps along the boundary, counter-clockwise about the natural normal.
    fn boundary(&self) -> Vec<[Vec3<T>; 2]> {
        let mut steps = Vec::new();
        match self {
            EnclosingSide::Whole(surface) => {
                let breaks = surface.breaks();
                for edge in 0..4 {
                    let at = |t: f64| {
                        let end = T::from(if edge == 1 || edge == 2 { 1.0 } else { 0.0 });
                        let t = T::from(t);
                        let jet = if edge % 2 == 0 {
                            surface.jet(t, end, Order::First)
                        } else {
                            surface.jet(end, t, Order::First)
                        };
                        [jet.p, if edge % 2 == 0 { jet.u } else { jet.v }]
                    };
                    along(&breaks[edge % 2], edge >= 2, at, &mut steps);
                }
            }
            EnclosingSide::Trimmed(border) => {
                let curves = border.0.curves();
                for (k, cycle) in border.0.cycles().iter().enumerate() {
                    // The outer loop is counter-clockwise, holes are clockwise.
                    let turned = (turn(curves.iter().map(|c| &c.curve), cycle) < 0.0) == (k == 0);
                    for &(number, backwards) in cycle {
                        let curve = &curves[number].curve;
                        let at = |t: f64| {
                            let [p, d, _] = curve.jet(T::from(t), Order::First);
                            [p, d]
                        };
                        along(&curve.breaks(), backwards != turned, at, &mut steps);
                    }
                }
            }
        }
        steps
    }

    /// The volume of the cone from the origin.
    fn cone(&self, boundary: &[[Vec3<T>; 2]]) -> Option<T> {
        match self {
            EnclosingSide::Trimmed(border) => Some(border.0.measures()?.volume),
            EnclosingSide::Whole(surface) => {
                let measures = surface_measures(&***surface, USUAL_ACCURACY)?;
                let mut area = Vec3::zero();
                boundary.iter().for_each(|&[p, d]| area += p.cross(d) * T::from(0.5));
                Some(measures.volume + area.dot(measures.middle.map(T::from)) / 3.0)
            }
        }
    }
}

/// Adds points and weighted derivatives of a curve.
fn along<T: Real>(
    breaks: &[f64],
    backwards: bool,
    at: impl Fn(f64) -> [Vec3<T>; 2],
    steps: &mut Vec<[Vec3<T>; 2]>,
) {
    let mut ends = vec![0.0];
    ends.extend(breaks.iter().copied().filter(|b| *b > 0.0 && *b < 1.0));
    ends.push(1.0);
    for w in ends.windows(2) {
        for part in 0..PARTS {
            let end = |k: usize| w[0] + (w[1] - w[0]) * (k as f64 / PARTS as f64);
            for (t, weight) in gauss_points(end(part), end(part + 1)) {
                let [p, d] = at(t);
                steps.push([p, d * T::from(if backwards { -weight } else { weight })]);
            }
        }
    }
}

/// Twice the area of a loop in parameters, approximately.
fn turn<'a, T: Real>(
    curves: impl Iterator<Item = &'a CurveRef<T>>,
    cycle: &[(usize, bool)],
) -> f64 {
    let curves: Vec<&CurveRef<T>> = curves.collect();
    let mut places: Vec<[f64; 2]> = Vec::new();
    for &(number, backwards) in cycle {
        places.extend((0..64).filter_map(|k| {
            let t = f64::from(k) / 64.0;
            let t = if backwards { 1.0 - t } else { t };
            let [w, ..] = curves[number].on_surface(T::from(t), Order::Zero)?;
            Some([w.x.re(), w.y.re()])
        }));
    }
    let next = places.iter().cycle().skip(1);
    places.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
}

/// 1 or -1 for each boundary, so that all of them cancel.
fn signs<T: Real>(boundaries: &[Vec<[Vec3<T>; 2]>]) -> Result<Vec<f64>, Diagnostic> {
    let count = boundaries.len();
    let points = || boundaries.iter().flatten().map(|[p, _]| p.re());
    let (mut low, mut high) =
        (Vec3::of(1.0, 1.0, 1.0) * f64::INFINITY, Vec3::of(1.0, 1.0, 1.0) * f64::NEG_INFINITY);
    for p in points() {
        low = Vec3::of(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z));
        high = Vec3::of(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z));
    }
    let size = (high - low).norm();
    if !size.is_finite() {
        return Err(crate::value::member::not_finite());
    }
    // Waves of all directions, of the order of the size.
    let wave = |field: usize, of: usize| {
        let x = (1 + field * 12 + of) as f64 * 0.618_033_988_749_894_9;
        2.0 * (x - x.floor()) - 1.0
    };
    let mut rows: Vec<Vec<f64>> = (0..count + MORE_FIELDS)
        .map(|field| {
            let [a, k] = [0, 3].map(|first| {
                Vec3::of(wave(field, first), wave(field, first + 1), wave(field, first + 2))
            });
            let k = k * (4.0 / size.max(f64::MIN_POSITIVE));
            let phase = 3.0 * wave(field, 6);
            let of = |steps: &Vec<[Vec3<T>; 2]>| {
                let each = steps
                    .iter()
                    .map(|[p, d]| a.dot(d.re()) * libm::cos(k.dot(p.re() - low) + phase) / size);
                each.sum::<f64>()
            };
            boundaries.iter().map(of).collect()
        })
        .collect();
    let most = rows.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
    let mut pivots = Vec::new();
    let mut free = Vec::new();
    for column in 0..count {
        let first = pivots.len();
        let best = (first..rows.len())
            .max_by(|&i, &k| rows[i][column].abs().total_cmp(&rows[k][column].abs()));
        let Some(best) = best.filter(|&k| rows[k][column].abs() > NOTHING * most.max(NOTHING))
        else {
            free.push(column);
            continue;
        };
        rows.swap(first, best);
        let pivot = rows[first].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(k, _)| *k != first) {
            let share = row[column] / pivot[column];
            row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= share * p);
        }
        pivots.push(column);
    }
    let refused = |what: String, help: &str| {
        Diagnostic::error("not-closed", what)
            .expected("surfaces that bound one body together")
            .help(help)
    };
    let [last] = free[..] else {
        return Err(if free.is_empty() {
            let help = "`hydrostatics.volume` is that of all shown surfaces below the water";
            refused("the surfaces enclose no volume: they are open".to_string(), help)
        } else {
            let help = "add the volumes of its bodies";
            refused(format!("the surfaces enclose {} volumes", free.len()), help)
        });
    };
    let mut weights = vec![0.0; count];
    weights[last] = 1.0;
    for (row, &column) in pivots.iter().enumerate() {
        weights[column] = -rows[row][last] / rows[row][column];
    }
    match weights.iter().position(|w| (w.abs() - 1.0).abs() > WHOLE) {
        Some(k) => Err(refused(
            format!("surface {} is no side of the volume that the others enclose", k + 1),
            "leave it out, or its neighbours do not meet it",
        )),
        None => Ok(weights.iter().map(|w| w.signum()).collect()),
    }
}
