//! Members of values: `.x`, `.t`, `.length`, `.area`, the edges and corners of surfaces, and
//! others.

use moldloft_diag::Diagnostic;
use moldloft_hydro::{USUAL_ACCURACY, solid_measures, surface_measures};
use moldloft_model::Object;
use moldloft_num::{Order, Real, Surface, Vec3, gauss_legendre};
use moldloft_registry::{Array, ArrayShape, Point, Scalar, SolidRef, SurfaceRef, Value, Vectors};
use std::sync::Arc;

/// The member called `name`, if the value has one.
pub fn of_value<T: Scalar>(value: &Value<T>, name: &str) -> Option<Result<Value<T>, Diagnostic>> {
    if let Value::Record(record) = value {
        return record.position(name).map(|k| match &record.values[k] {
            Value::Unset => {
                Err(Diagnostic::error("no-value", format!("`{name}` has no value yet")))
            }
            value => Ok(value.clone()),
        });
    }
    if let Some(member) = of_found(value, name) {
        return Some(Ok(member));
    }
    if let Some((_, figure)) = value.figures().iter().find(|(own, _)| *own == name) {
        return Some(Ok(Value::Number(T::from(*figure))));
    }
    let axis = ["x", "y", "z"].iter().position(|c| *c == name);
    let number = |x: T| Some(Ok(Value::Number(x)));
    match (value, axis) {
        (Value::Vector(v), Some(c)) => number(v[c]),
        (Value::Point(p), Some(c)) => number(p.xyz[c]),
        (Value::Vectors(a), Some(c)) => {
            let items = a.planes[c].clone();
            Some(Ok(Value::Numbers(Arc::new(Array { shape: a.shape, items }))))
        }
        (Value::Block(_), Some(c)) => crate::value::variables::component(value, c).map(Ok),
        (Value::Point(p), None) => match (name, &p.on_curve, &p.on_surface) {
            ("t", Some(place), _) => number(place.1),
            ("u", _, Some(place)) => number(place.1[0]),
            ("v", _, Some(place)) => number(place.1[1]),
            _ => None,
        },
        (Value::Body(mesh), None) => match name {
            "volume" => number(mesh.measures()?.volume),
            "area" => number(mesh.measures()?.area),
            "centroid" => Some(Ok(Value::Vector(mesh.measures()?.centroid))),
            _ => FLAWS.contains(&name).then(|| {
                let flaw = mesh.flaws.iter().find(|f| f.name == name);
                let places = flaw.map_or(&[][..], |f| &f.places);
                let lifted = places.iter().map(|p| Vec3::lifted(*p)).collect();
                Ok(Value::Vectors(Arc::new(Vectors::row(lifted))))
            }),
        },
        (Value::Surface(surface), None) => part_of_surface(surface, name).map(Ok),
        (Value::Curve(curve), None) if name == "length" => {
            // To about twelve digits, as the function of this name.
            let speed = |t: f64| curve.jet(T::from(t), Order::First)[1].re().norm();
            let rough = gauss_legendre(0.0, 1.0, speed);
            if rough == 0.0 {
                return number(T::zero());
            }
            number(moldloft_spline::arclen(&**curve, T::zero(), T::one(), 1e-12 * rough))
        }
        (Value::Numbers(_) | Value::Vectors(_) | Value::List(_) | Value::Block(_), None) => {
            let extents = crate::value::variables::extents(value)?;
            let extent = match name {
                "d1" => extents.first(),
                "d2" => extents.get(1),
                "d3" => extents.get(2),
                _ => None,
            }?;
            number(T::from(*extent as f64))
        }
        _ => None,
    }
}

/// The edges of surfaces, in order, and their corners.
const EDGES: [&str; 4] = ["v0", "u1", "v1", "u0"];
const CORNERS: [(&str, [f64; 2]); 4] =
    [("c00", [0.0, 0.0]), ("c10", [1.0, 0.0]), ("c11", [1.0, 1.0]), ("c01", [0.0, 1.0])];

/// An edge of a surface as a snake, or a corner as a magnet.
fn part_of_surface<T: Real>(surface: &SurfaceRef<T>, name: &str) -> Option<Value<T>> {
    if let Some(k) = EDGES.iter().position(|edge| *edge == name) {
        let mut edge = moldloft_relational::edge(surface.clone(), k, surface.depth);
        // One curve, however often it is named.
        edge.key = surface.key.and_then(|key| key.edge(k));
        return Some(Value::Curve(edge));
    }
    let &(_, [u, v]) = CORNERS.iter().find(|corner| corner.0 == name)?;
    let corner = Point::on_surface(surface.clone(), T::from(u), T::from(v));
    Some(Value::Point(Box::new(corner)))
}

/// Report of the search behind a value: `.status`, `.residual`, `.iterations`, `.start`,
/// `.alternatives`.
fn of_found<T: Real>(value: &Value<T>, name: &str) -> Option<Value<T>> {
    let found = value.found()?;
    let row = |all: &[f64]| {
        Value::Numbers(Arc::new(Array::row(all.iter().map(|&x| T::from(x)).collect())))
    };
    Some(match name {
        "status" => Value::text(found.status.word()),
        "residual" => Value::Number(T::from(found.residual)),
        "iterations" => Value::Number(T::from(f64::from(found.iterations))),
        "start" => row(&found.start),
        "alternatives" => {
            let columns = found.alternatives.first().map_or(0, |(p, _)| p.len());
            let all = found.alternatives.iter().flat_map(|(p, _)| p.iter().map(|&x| T::from(x)));
            let items: Vec<T> = all.collect();
            Value::Numbers(Arc::new(Array::grid(found.alternatives.len(), columns, items)))
        }
        _ => return None,
    })
}

/// Members for imperfect regions of a set's facets.
const FLAWS: [&str; 3] = ["undecided", "blunt", "touching"];

/// Members of values found by a search.
const FOUND: [&str; 5] = ["status", "residual", "iterations", "start", "alternatives"];

/// The names of the members that a value has.
pub fn names<T: Real>(value: &Value<T>) -> Vec<Arc<str>> {
    if let Value::Record(record) = value {
        return record.names.to_vec();
    }
    let mut names = own_names(value);
    names.extend(value.found().iter().flat_map(|_| FOUND));
    names.extend(value.figures().iter().map(|(name, _)| *name));
    names.into_iter().map(Arc::from).collect()
}

fn own_names<T: Real>(value: &Value<T>) -> Vec<&'static str> {
    match value {
        Value::Vector(_) => vec!["x", "y", "z"],
        Value::Point(p) => {
            let mut names = vec!["x", "y", "z"];
            names.extend(p.on_curve.as_ref().map(|_| "t"));
            names.extend(p.on_surface.iter().flat_map(|_| ["u", "v"]));
            names
        }
        Value::Vectors(a) if matches!(a.shape, ArrayShape::Grid(..)) => {
            vec!["x", "y", "z", "d1", "d2"]
        }
        Value::Vectors(_) => vec!["x", "y", "z", "d1"],
        Value::Numbers(_) | Value::List(_) => vec!["d1"],
        Value::Block(_) => vec!["x", "y", "z", "d1", "d2", "d3"],
        Value::Curve(_) => vec!["length"],
        Value::Surface(_) => {
            let mut names = vec!["area", "centroid", "volume"];
            names.extend(EDGES);
            names.extend(CORNERS.map(|corner| corner.0));
            names
        }
        Value::Body(_) => [&["volume", "area", "centroid"][..], &FLAWS].concat(),
        Value::Solid(_) => vec!["volume"],
        Value::Contours(_) => super::contours::MEMBERS.to_vec(),
        _ => Vec::new(),
    }
}

/// The area, the centroid of the area, or the enclosed volume of a surface; the volume of a solid.
pub fn of_patch<T: Scalar>(object: &Object<T>, name: &str) -> Option<Result<Value<T>, Diagnostic>> {
    if let Value::Solid(solid) = object.value()? {
        return (name == "volume").then(|| solid_volume(solid, object).map(Value::Number));
    }
    let Value::Surface(surface) = object.value()? else { return None };
    if !matches!(name, "area" | "centroid" | "volume") {
        return None;
    }
    let Some(measures) = surface_measures(&**surface, USUAL_ACCURACY) else {
        return Some(Err(not_finite()));
    };
    Some(match name {
        "area" => Ok(Value::Number(measures.area)),
        "centroid" => Ok(Value::Vector(measures.area_centre)),
        _ if measures.open <= CLOSED * measures.area.re() && is_closed(&**surface) => {
            Ok(Value::Number(measures.volume.abs()))
        }
        _ => Err(Diagnostic::error("not-closed", format!("`{}` encloses no volume", object.name))
            .expected("a closed surface")
            .help("`hydrostatics.volume` is that of all shown surfaces below the water")),
    })
}

/// The fault of a surface whose positions are not finite.
pub fn not_finite() -> Diagnostic {
    Diagnostic::error(
        "no-body",
        "a surface has positions that are not finite, so it has no measures",
    )
}

/// Maximum integral of the normal of a closed surface, relative to its area.
const CLOSED: f64 = 1e-7;

/// True if every edge is a point, is folded on itself, or coincides with its opposite edge. The
/// vector area does not suffice: it vanishes for an open tube too.
fn is_closed<T: Scalar>(surface: &dyn Surface<T>) -> bool {
    let along = |k: usize| k as f64 / EDGE_PLACES as f64;
    let edge = |axis: usize, end: f64| -> Vec<Vec3> {
        let at = |t: f64| if axis == 0 { (end, t) } else { (t, end) };
        let place = |(u, v): (f64, f64)| surface.jet(T::from(u), T::from(v), Order::Zero).p.re();
        (0..=EDGE_PLACES).map(|k| place(at(along(k)))).collect()
    };
    let edges = [0, 1].map(|axis| [0.0, 1.0].map(|end| edge(axis, end)));
    let origin = edges[0][0][0];
    let all = edges.iter().flatten().flatten();
    let near = CLOSED * all.fold(0.0, |size: f64, p| size.max(p.distance(origin)));
    let meet = |p: &Vec3, q: &Vec3| p.distance(*q) <= near;
    let sealed = |edge: &[Vec3]| {
        edge.iter().all(|p| meet(p, &edge[0]))
            || edge.iter().zip(edge.iter().rev()).all(|(p, q)| meet(p, q))
    };
    edges.iter().all(|[low, high]| {
        low.iter().zip(high).all(|(p, q)| meet(p, q)) || sealed(low) && sealed(high)
    })
}

/// Number of points of an edge, between its ends, at which it is compared with others.
const EDGE_PLACES: usize = 24;

/// Relative error above which a volume is refused.
pub const ROUGH: f64 = 1e-6;

/// The volume of a solid by quadrature on its shape, negative when it is left-handed: the figure that weights take, too.
fn solid_volume<T: Scalar>(solid: &SolidRef<T>, object: &Object<T>) -> Result<T, Diagnostic> {
    let (volume, _, error) = solid_measures(&**solid).ok_or_else(not_finite)?;
    if error > ROUGH * volume.re().abs() {
        let message = format!("the volume of `{}` does not converge", object.name);
        return Err(Diagnostic::error("rough-volume", message)
            .expected("a solid without kinks that run across its parameters")
            .found(format!("a volume of {} that is known to {error:.1e}", volume.re())));
    }
    Ok(volume)
}
