//! Pictures for the reference: the objects of one kind among those that they are made of.

use moldloft_diag::Diagnostic;
use moldloft_document::Document;
use moldloft_mesh::{Mesh, MeshError, PatchInfo, TopologyBuilder};
use moldloft_model::Object;
use moldloft_num::{Box3, Order, Plane, Solid, Vec3};
use moldloft_picture::{Options, PatchStyle, PointName, StyledPolyline, render};
use moldloft_registry::Value;

const SUBJECT: [u8; 3] = [0xc2, 0x41, 0x2d];
/// Colour of its parents.
const OTHER: [u8; 3] = [0x5d, 0x6b, 0x7a];
/// Colour of its parents' names.
const NAME: [u8; 3] = [0x2f, 0x3a, 0x46];
/// Colour of the path to a point.
const WAY: [u8; 3] = [0xa9, 0xb4, 0xbf];
/// Surfaces of the subject, and others.
const SURFACES: [[u8; 3]; 2] = [[0x78, 0xa5, 0xe0], [0xd5, 0xdb, 0xe2]];
/// Steps in which curves are drawn.
const STEPS: usize = 96;
/// Panels along the edges of solids.
const PANELS: usize = 8;

/// The picture of a model with the objects of one kind highlighted: visible curves as lines, points
/// as dots, planes and frames as outlines, solids by their faces. If there are only points, the
/// path to each along x, y and z is drawn too.
///
/// # Errors
/// An impossible size; a model without panels that can be made.
pub fn kind_picture(
    document: &mut Document,
    kind: &str,
    width: usize,
    height: usize,
) -> Result<Vec<u8>, Vec<Diagnostic>> {
    let panelled = document.panelled().map_err(|d| vec![d])?;
    let graph = document.graph();
    let objects: Vec<_> = graph.objects().filter(|o| o.head.shown()).collect();
    let subjects = objects.iter().filter(|o| o.row.name == kind);
    let solids = subjects.filter_map(|o| match o.value() {
        Some(Value::Solid(solid)) => Some((&*o.name, &**solid)),
        _ => None,
    });
    let mesh = with_solids(&panelled.mesh, solids)
        .map_err(|error| vec![Diagnostic::error("no-picture", error.to_string())])?;
    let mut bounds = Box3::around(mesh.positions().iter().copied());
    let is_point = |v: &Value<f64>| matches!(v, Value::Point(_));
    let points_only = objects.iter().filter_map(|o| o.value()).all(is_point);
    if points_only {
        bounds = bounds.including(Vec3::zero());
    }
    for object in &objects {
        match object.value() {
            Some(Value::Point(p)) => bounds = bounds.including(p.xyz),
            Some(Value::Curve(c)) => {
                for k in 0..=8 {
                    bounds = bounds.including(c.jet(f64::from(k) / 8.0, Order::Zero)[0]);
                }
            }
            _ => {}
        }
    }
    let size = if bounds.diagonal() > 0.0 { bounds.diagonal() } else { 1.0 };
    let mut lines = Vec::new();
    // The subject is last, so that it is on top.
    for own in [false, true] {
        let colour = if own { SUBJECT } else { OTHER };
        for object in objects.iter().filter(|o| (o.row.name == kind) == own) {
            let width = if own { 2.4 } else { 1.2 };
            let mut line = |points: Vec<Vec3>, width: f32| {
                lines.push(StyledPolyline { points, colour, width, on_surface: false });
            };
            match object.value() {
                Some(Value::Point(p)) => {
                    line(vec![p.xyz; 2], if own { 9.0 } else { 5.0 });
                    if points_only {
                        let Vec3 { x, y, .. } = p.xyz;
                        let turns = [Vec3::zero(), Vec3::of(x, 0.0, 0.0), Vec3::of(x, y, 0.0)];
                        let way = turns.into_iter().chain([p.xyz]).collect();
                        let way = StyledPolyline {
                            points: way,
                            colour: WAY,
                            width: 1.0,
                            on_surface: false,
                        };
                        lines.push(way);
                    }
                }
                Some(Value::Curve(c)) => {
                    let at = |k: usize| c.jet(k as f64 / STEPS as f64, Order::Zero)[0];
                    line((0..=STEPS).map(at).collect(), width);
                }
                Some(Value::Plane(plane)) => line(outline(plane, &bounds, size), width),
                Some(Value::Frame(frame)) => {
                    for axis in frame.axes {
                        line(vec![frame.origin, frame.origin + axis * (0.25 * size)], width);
                    }
                }
                _ => {}
            }
        }
    }
    let labels = labels(&objects, kind);
    for section in document.sections() {
        for points in section.lines.iter().flat_map(|(_, lines)| lines) {
            let again = points.points.first().filter(|_| points.closed);
            let points = points.points.iter().chain(again).copied().collect();
            lines.push(StyledPolyline { points, colour: SUBJECT, width: 2.0, on_surface: true });
        }
    }
    let graph = document.graph();
    let of_kind = |name: &str| {
        // The names of a body's patches begin with its name, followed by the surface.
        let whole = || graph.find(name.split('.').next()?);
        let object = graph.find(name).or_else(whole).and_then(|key| graph.get(key));
        object.is_some_and(|o| o.row.name == kind)
    };
    let patches = mesh.patches();
    let look = |own: bool| PatchStyle { colour: SURFACES[usize::from(!own)], raised: own };
    let looks = patches.iter().map(|p| look(of_kind(&p.info.name))).collect();
    let options = Options { width, height, looks: Some(looks), labels, ..Options::default() };
    render(&mesh, &lines, &options)
        .map_err(|error| vec![Diagnostic::error("no-picture", error.to_string())])
}

/// The names of the objects: those of the kind first, and of these and of the others points before lines and surfaces.
fn labels(objects: &[&Object<f64>], kind: &str) -> Vec<PointName> {
    let middle = 0.5;
    let mut all = Vec::new();
    for object in objects {
        let (rank, at) = match object.value() {
            Some(Value::Point(p)) => (0, p.xyz),
            Some(Value::Frame(frame)) => (1, frame.origin),
            Some(Value::Curve(c)) => (2, c.jet(middle, Order::Zero)[0]),
            Some(Value::Surface(s)) => (3, s.jet(middle, middle, Order::Zero).p),
            _ => continue,
        };
        let own = object.row.name == kind;
        let colour = if own { SUBJECT } else { NAME };
        all.push(((!own, rank), PointName { at, text: object.name.to_string(), colour }));
    }
    all.sort_by_key(|(rank, _)| *rank);
    all.into_iter().map(|(_, label)| label).collect()
}

/// The mesh and the faces of solids, as patches of their names.
fn with_solids<'s>(
    mesh: &Mesh<f64>,
    solids: impl Iterator<Item = (&'s str, &'s dyn Solid<f64>)>,
) -> Result<Mesh<f64>, MeshError> {
    let mut builder = TopologyBuilder::extending(mesh.topology().as_ref().clone());
    let mut positions = mesh.positions().to_vec();
    let along: Vec<f64> = (0..=PANELS).map(|k| k as f64 / PANELS as f64).collect();
    let n = along.len();
    for (name, solid) in solids {
        for (axis, end) in (0..3).flat_map(|axis| [(axis, 0.0), (axis, 1.0)]) {
            let fixed = [end];
            let ranges: [&[f64]; 3] =
                std::array::from_fn(|k| if k == axis { &fixed[..] } else { &along[..] });
            let mut points = vec![Vec3::zero(); n * n];
            solid.grid(ranges[0], ranges[1], ranges[2], &mut points);
            let vertices = builder.add_vertices(points.len())?.collect();
            // The normal of the two others' product points along u and w, and against v.
            let outward = (end > 0.5) != (axis == 1);
            builder.add_block(PatchInfo::new(name), n, n, vertices, !outward)?;
            positions.extend(points);
        }
    }
    Mesh::new(builder.build().into(), positions)
}

/// A square of the plane about the foot of the model's middle.
fn outline(plane: &Plane<f64>, bounds: &Box3, size: f64) -> Vec<Vec3> {
    let middle = plane.foot(bounds.centre());
    let n = plane.normal;
    let aside = if n.z.abs() < 0.9 { Vec3::of(0.0, 0.0, 1.0) } else { Vec3::of(1.0, 0.0, 0.0) };
    let a = n.cross(aside).normalized().unwrap_or_default() * (0.4 * size);
    let b = n.cross(a);
    vec![middle - a - b, middle + a - b, middle + a + b, middle - a + b, middle - a - b]
}
