//! Curves, surfaces, edges, faces, shells and their styles as entities.

use super::RepresentationItems;
use super::part21::{Part21, joined, list, real, reals, text};
use crate::WriteError;
use moldloft_brep::{
    Brep, BrepFace, ExactCurve, FacetedPart, Part, Shell, SurfaceAxes, SurfaceShape, Wire,
};
use moldloft_num::Vec3;
use moldloft_spline::nurbs::Nurbs;
use std::collections::BTreeMap;

/// The highest degree that readers take.
const HIGHEST_DEGREE: usize = 25;

/// Refuses content that readers would drop silently.
pub fn check(brep: &Brep, format: &'static str) -> Result<(), WriteError> {
    let empty =
        brep.parts.iter().all(|p| p.shells.is_empty() && p.wires.is_empty() && p.points.is_empty());
    if brep.parts.iter().flat_map(|p| &p.points).any(|p| !p.place.is_finite()) {
        return Err(WriteError::CannotHold { format, what: "a number that is not finite" });
    }
    let positions = brep.faceted.iter().flat_map(|part| &part.positions);
    if positions.into_iter().any(|p| !p.is_finite()) {
        return Err(WriteError::CannotHold { format, what: "a number that is not finite" });
    }
    if empty && brep.faceted.is_empty() {
        return Err(WriteError::CannotHold { format, what: "a model without surfaces and curves" });
    }
    let curves = brep.edges.iter().map(|e| &e.curve);
    let wires = brep.parts.iter().flat_map(|p| &p.wires).map(|w| &w.curve);
    for curve in curves.chain(wires) {
        check_spline(
            format,
            &curve.degrees,
            &curve.knots,
            &curve.points,
            curve.weights.as_deref(),
        )?;
    }
    for face in &brep.faces {
        if let SurfaceShape::Nurbs(s) = &face.surface {
            check_spline(format, &s.degrees, &s.knots, &s.points, s.weights.as_deref())?;
        }
        let patch = matches!(face.surface, SurfaceShape::Image(_) | SurfaceShape::Extruded(_));
        if patch && brep.nurbs(face).is_none() {
            return Err(WriteError::CannotHold { format, what: "a surface without an axis" });
        }
    }
    Ok(())
}

fn check_spline(
    format: &'static str,
    degrees: &[usize],
    knots: &[Vec<f64>],
    points: &[Vec3],
    weights: Option<&[f64]>,
) -> Result<(), WriteError> {
    let fault = |what| Err(WriteError::CannotHold { format, what });
    if points.iter().any(|p| !p.is_finite()) || knots.iter().flatten().any(|k| !k.is_finite()) {
        return fault("a number that is not finite");
    }
    if weights.is_some_and(|w| w.iter().any(|w| !(w.is_finite() && *w > 0.0))) {
        return fault("a weight that is not positive");
    }
    for (degree, knots) in degrees.iter().zip(knots) {
        if *degree > HIGHEST_DEGREE {
            return fault("a degree above 25");
        }
        let inner = &knots[degree + 1..knots.len() - degree - 1];
        if inner.chunk_by(|a, b| a == b).any(|run| run.len() > *degree) {
            return fault("a curve with a gap");
        }
    }
    Ok(())
}

fn point(file: &mut Part21, p: Vec3) -> usize {
    file.point(&p.to_array())
}

fn direction(file: &mut Part21, d: Vec3) -> usize {
    file.add(format!("DIRECTION('',{})", reals(d.to_array())))
}

/// A placement at `o` with its z and x axes.
pub fn axis(file: &mut Part21, o: Vec3, z: Vec3, x: Vec3) -> usize {
    let (o, z, x) = (point(file, o), direction(file, z), direction(file, x));
    file.add(format!("AXIS2_PLACEMENT_3D('',#{o},#{z},#{x})"))
}

fn placed(file: &mut Part21, axes: &SurfaceAxes) -> usize {
    axis(file, axes.origin, axes.z, axes.x)
}

/// A circle or an ellipse with its longer axis first, run by increasing angle.
fn ellipse(file: &mut Part21, centre: Vec3, x: Vec3, y: Vec3) -> Option<usize> {
    let (a, b) = (x.norm(), y.norm());
    let (z, unit) = (x.cross(y).normalized()?, x.normalized()?);
    if (a - b).abs() <= 1e-14 * a {
        let placement = axis(file, centre, z, unit);
        return Some(file.add(format!("CIRCLE('',#{placement},{})", real(a))));
    }
    let (long, short, first) = if a > b { (a, b, unit) } else { (b, a, y.normalized()?) };
    let placement = axis(file, centre, z, first);
    Some(file.add(format!("ELLIPSE('',#{placement},{},{})", real(long), real(short))))
}

/// Multiplicities and distinct knots.
fn knots_of(knots: &[f64]) -> [String; 2] {
    let runs: Vec<&[f64]> = knots.chunk_by(|a, b| a == b).collect();
    let times = joined(runs.iter().map(|run| run.len().to_string()));
    [times, reals(runs.iter().map(|run| run[0]))]
}

fn logical(yes: bool) -> &'static str {
    if yes { ".T." } else { ".F." }
}

/// A curve of two or three coordinates.
fn curve(file: &mut Part21, c: &Nurbs<1>, coordinates: usize) -> usize {
    named_curve(file, "", c, coordinates)
}

fn named_curve(file: &mut Part21, name: &str, c: &Nurbs<1>, coordinates: usize) -> usize {
    let points: Vec<usize> =
        c.points.iter().map(|p| file.point(&p.to_array()[..coordinates])).collect();
    if let [from, to] = points[..]
        && coordinates == 2
        && c.weights.is_none()
        && c.knots[0] == [0.0, 0.0, 1.0, 1.0]
    {
        return file.trace([from, to], |file| spline(file, name, c, &points));
    }
    spline(file, name, c, &points)
}

fn spline(file: &mut Part21, name: &str, c: &Nurbs<1>, points: &[usize]) -> usize {
    let name = text(name);
    let closed = logical(c.points.first() == c.points.last());
    let (degree, points) = (c.degrees[0], list(points));
    let [times, knots] = knots_of(&c.knots[0]);
    let Some(weights) = &c.weights else {
        return file.add(format!(
            "B_SPLINE_CURVE_WITH_KNOTS({name},{degree},{points},.UNSPECIFIED.,{closed},.F.,{times},{knots},.UNSPECIFIED.)"
        ));
    };
    let weights = reals(weights.iter().copied());
    file.add(format!(
        "(BOUNDED_CURVE()B_SPLINE_CURVE({degree},{points},.UNSPECIFIED.,{closed},.F.)B_SPLINE_CURVE_WITH_KNOTS({times},{knots},.UNSPECIFIED.)CURVE()GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE({weights})REPRESENTATION_ITEM({name}))"
    ))
}

fn surface(file: &mut Part21, brep: &Brep, face: &BrepFace) -> usize {
    let image;
    let s = match &face.surface {
        SurfaceShape::Plane { origin, normal, axis: x } => {
            let placement = axis(file, *origin, *normal, *x);
            return file.add(format!("PLANE('',#{placement})"));
        }
        SurfaceShape::Cylinder { axes, radius } => {
            let (placement, radius) = (placed(file, axes), real(*radius));
            return file.add(format!("CYLINDRICAL_SURFACE('',#{placement},{radius})"));
        }
        SurfaceShape::Cone { axes, radius, half_angle } => {
            let placement = placed(file, axes);
            let (radius, angle) = (real(*radius), real(*half_angle));
            return file.add(format!("CONICAL_SURFACE('',#{placement},{radius},{angle})"));
        }
        SurfaceShape::Sphere { axes, radius } => {
            let (placement, radius) = (placed(file, axes), real(*radius));
            return file.add(format!("SPHERICAL_SURFACE('',#{placement},{radius})"));
        }
        SurfaceShape::Torus { axes, major, minor } => {
            let placement = placed(file, axes);
            let (major, minor) = (real(*major), real(*minor));
            return file.add(format!("TOROIDAL_SURFACE('',#{placement},{major},{minor})"));
        }
        SurfaceShape::Nurbs(s) => s,
        SurfaceShape::Image(_) | SurfaceShape::Extruded(_) => {
            let Some(made) = brep.nurbs(face) else { return 0 };
            image = made;
            &image
        }
    };
    let [nu, nv] = s.counts();
    let points: Vec<usize> = s.points.iter().map(|&p| point(file, p)).collect();
    let rows = joined(points.chunks_exact(nv).map(list));
    let alike = |mut pairs: Box<dyn Iterator<Item = (usize, usize)>>| {
        logical(pairs.all(|(a, b)| s.points[a] == s.points[b]))
    };
    let closed_u = alike(Box::new((0..nv).map(move |j| (j, (nu - 1) * nv + j))));
    let closed_v = alike(Box::new((0..nu).map(move |i| (i * nv, i * nv + nv - 1))));
    let [[tu, ku], [tv, kv]] = [0, 1].map(|d| knots_of(&s.knots[d]));
    let [p, q] = s.degrees;
    let Some(weights) = &s.weights else {
        return file.add(format!(
            "B_SPLINE_SURFACE_WITH_KNOTS('',{p},{q},{rows},.UNSPECIFIED.,{closed_u},{closed_v},.F.,{tu},{tv},{ku},{kv},.UNSPECIFIED.)"
        ));
    };
    let weights = joined(weights.chunks_exact(nv).map(|row| reals(row.iter().copied())));
    file.add(format!(
        "(BOUNDED_SURFACE()B_SPLINE_SURFACE({p},{q},{rows},.UNSPECIFIED.,{closed_u},{closed_v},.F.)B_SPLINE_SURFACE_WITH_KNOTS({tu},{tv},{ku},{kv},.UNSPECIFIED.)GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE({weights})REPRESENTATION_ITEM('')SURFACE())"
    ))
}

/// A curve that is straight and bounded by planes alone is a line.
fn straight(c: &Nurbs<1>) -> Option<(Vec3, Vec3)> {
    let (&a, &b) = (c.points.first()?, c.points.last()?);
    let d = (b - a).normalized()?;
    let length = a.distance(b);
    let mut before = 0.0;
    for &p in &c.points {
        let along = (p - a).dot(d);
        if (p - a - d * along).norm() > 1e-14 * (length + a.norm()) || along < before {
            return None;
        }
        before = along;
    }
    Some((a, d))
}

/// The entities of shapes, each written once.
pub(crate) struct Shapes<'a> {
    brep: &'a Brep,
    flat: usize,
    vertices: Vec<Option<usize>>,
    edges: Vec<Option<usize>>,
    surfaces: Vec<Option<usize>>,
    /// The traces on B-spline surfaces of each edge: face, loop, side.
    traces: Vec<Vec<[usize; 3]>>,
    colours: BTreeMap<[u8; 3], usize>,
    styled: Vec<usize>,
    layers: BTreeMap<String, Vec<usize>>,
}

impl<'a> Shapes<'a> {
    pub fn new(brep: &'a Brep, flat: usize) -> Self {
        let mut traces = vec![Vec::new(); brep.edges.len()];
        for (f, face) in brep.faces.iter().enumerate() {
            for (l, cycle) in face.loops.iter().enumerate() {
                for (s, side) in cycle.iter().enumerate() {
                    if side.alike
                        && side.trace.is_some()
                        && matches!(face.surface, SurfaceShape::Nurbs(_))
                    {
                        traces[side.edge].push([f, l, s]);
                    }
                }
            }
        }
        Self {
            brep,
            flat,
            vertices: vec![None; brep.vertices.len()],
            edges: vec![None; brep.edges.len()],
            surfaces: vec![None; brep.faces.len()],
            traces,
            colours: BTreeMap::new(),
            styled: Vec::new(),
            layers: BTreeMap::new(),
        }
    }

    /// The items of a part.
    pub fn part(&mut self, file: &mut Part21, part: &Part) -> RepresentationItems {
        let (mut solids, mut shells) = (Vec::new(), Vec::new());
        let cavities: Vec<usize> = part
            .shells
            .iter()
            .filter(|shell| shell.cavity)
            .map(|shell| {
                let number = self.shell(file, shell);
                // Its faces look out of the material already.
                file.add(format!("ORIENTED_CLOSED_SHELL('',*,#{number},.T.)"))
            })
            .collect();
        for shell in part.shells.iter().filter(|shell| !shell.cavity) {
            let number = self.shell(file, shell);
            if shell.closed && !cavities.is_empty() {
                let (name, voids) = (text(&part.name), list(&cavities));
                solids.push(file.add(format!("BREP_WITH_VOIDS({name},#{number},{voids})")));
            } else if shell.closed {
                solids
                    .push(file.add(format!("MANIFOLD_SOLID_BREP({},#{number})", text(&part.name))));
            } else {
                shells.push(number);
            }
        }
        let name = text(&part.name);
        if !shells.is_empty() {
            let model = file.add(format!("SHELL_BASED_SURFACE_MODEL({name},{})", list(&shells)));
            let kind = "MANIFOLD_SURFACE_SHAPE_REPRESENTATION";
            // Solids beside open shells of one part: their shells are written as such.
            let items = [model].into_iter().chain(solids).collect();
            return RepresentationItems { items, kind };
        }
        if !solids.is_empty() {
            return RepresentationItems {
                items: solids,
                kind: "ADVANCED_BREP_SHAPE_REPRESENTATION",
            };
        }
        let mut items: Vec<usize> = part.wires.iter().map(|w| self.wire(file, w)).collect();
        for p in &part.points {
            let at = reals(p.place.to_array());
            items.push(file.add(format!("CARTESIAN_POINT({},{at})", text(&p.name))));
        }
        let set = file.add(format!("GEOMETRIC_CURVE_SET({name},{})", list(&items)));
        RepresentationItems {
            items: vec![set],
            kind: "GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION",
        }
    }

    fn wire(&mut self, file: &mut Part21, wire: &Wire) -> usize {
        let number = named_curve(file, &wire.name, &wire.curve, 3);
        if let Some(colour) = wire.colour {
            let colour = self.colour(file, colour);
            let font = file.add("DRAUGHTING_PRE_DEFINED_CURVE_FONT('continuous')".into());
            let style =
                file.add(format!("CURVE_STYLE('',#{font},POSITIVE_LENGTH_MEASURE(0.1),#{colour})"));
            let style = file.add(format!("PRESENTATION_STYLE_ASSIGNMENT((#{style}))"));
            self.styled.push(file.add(format!("STYLED_ITEM('color',(#{style}),#{number})")));
        }
        for layer in &wire.layers {
            self.layers.entry(layer.clone()).or_default().push(number);
        }
        number
    }

    fn shell(&mut self, file: &mut Part21, shell: &Shell) -> usize {
        let faces: Vec<usize> = shell.faces.iter().map(|&f| self.face(file, f)).collect();
        let kind = if shell.closed { "CLOSED_SHELL" } else { "OPEN_SHELL" };
        file.add(format!("{kind}('',{})", list(&faces)))
    }

    fn face(&mut self, file: &mut Part21, f: usize) -> usize {
        let face = &self.brep.faces[f];
        let shape = self.surface(file, f);
        let mut bounds = Vec::new();
        for (l, cycle) in face.loops.iter().enumerate() {
            let mut sides = Vec::new();
            for side in cycle {
                let edge = self.edge(file, side.edge);
                sides.push(
                    file.add(format!("ORIENTED_EDGE('',*,*,#{edge},{})", logical(side.forward))),
                );
            }
            let cycle = file.add(format!("EDGE_LOOP('',{})", list(&sides)));
            let kind = if l == 0 { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
            bounds.push(file.add(format!("{kind}('',#{cycle},.T.)")));
        }
        let number = file.add(format!(
            "ADVANCED_FACE({},{},#{shape},{})",
            text(&face.name),
            list(&bounds),
            logical(!face.reversed)
        ));
        self.style(file, face.colour, &face.layers, number);
        number
    }

    fn surface(&mut self, file: &mut Part21, f: usize) -> usize {
        if let Some(number) = self.surfaces[f] {
            return number;
        }
        let number = surface(file, self.brep, &self.brep.faces[f]);
        self.surfaces[f] = Some(number);
        number
    }

    fn vertex(&mut self, file: &mut Part21, v: usize) -> usize {
        if let Some(number) = self.vertices[v] {
            return number;
        }
        let place = point(file, self.brep.vertices[v]);
        let number = file.add(format!("VERTEX_POINT('',#{place})"));
        self.vertices[v] = Some(number);
        number
    }

    fn edge(&mut self, file: &mut Part21, e: usize) -> usize {
        if let Some(number) = self.edges[e] {
            return number;
        }
        let edge = &self.brep.edges[e];
        let [from, to] = edge.ends.map(|v| self.vertex(file, v));
        let traces = self.traces[e].clone();
        let line = if traces.is_empty() { straight(&edge.curve) } else { None };
        let conic = match edge.ellipse {
            Some(ExactCurve::Ellipse { centre, x, y }) => ellipse(file, centre, x, y),
            _ => None,
        };
        let mut shape = match (conic, line) {
            (Some(conic), _) => conic,
            (None, Some((a, d))) => {
                let (a, d) = (point(file, a), direction(file, d));
                let vector = file.add(format!("VECTOR('',#{d},1.)"));
                file.add(format!("LINE('',#{a},#{vector})"))
            }
            (None, None) => curve(file, &edge.curve, 3),
        };
        if !traces.is_empty() {
            let seam = traces.len() == 2 && traces[0][0] == traces[1][0];
            let mut associated = Vec::new();
            for &[f, l, s] in traces.iter().take(2) {
                let on = self.surface(file, f);
                let Some(trace) = &self.brep.faces[f].loops[l][s].trace else { continue };
                let own = curve(file, trace, 2);
                let form =
                    file.add(format!("DEFINITIONAL_REPRESENTATION('',(#{own}),#{})", self.flat));
                associated.push(file.add(format!("PCURVE('',#{on},#{form})")));
            }
            let kind = if seam { "SEAM_CURVE" } else { "SURFACE_CURVE" };
            shape = file.add(format!("{kind}('',#{shape},{},.CURVE_3D.)", list(&associated)));
        }
        let number = file.add(format!("EDGE_CURVE('',#{from},#{to},#{shape},.T.)"));
        self.edges[e] = Some(number);
        number
    }

    fn colour(&mut self, file: &mut Part21, rgb: [u8; 3]) -> usize {
        *self.colours.entry(rgb).or_insert_with(|| {
            let [r, g, b] = rgb.map(|x| real(f64::from(x) / 255.0));
            file.add(format!("COLOUR_RGB('',{r},{g},{b})"))
        })
    }

    fn style(
        &mut self,
        file: &mut Part21,
        colour: Option<[u8; 3]>,
        layers: &[String],
        number: usize,
    ) {
        for layer in layers {
            self.layers.entry(layer.clone()).or_default().push(number);
        }
        let Some(rgb) = colour else { return };
        let colour = self.colour(file, rgb);
        let fill = file.add(format!("FILL_AREA_STYLE_COLOUR('',#{colour})"));
        let fill = file.add(format!("FILL_AREA_STYLE('',(#{fill}))"));
        let area = file.add(format!("SURFACE_STYLE_FILL_AREA(#{fill})"));
        let side = file.add(format!("SURFACE_SIDE_STYLE('',(#{area}))"));
        let usage = file.add(format!("SURFACE_STYLE_USAGE(.BOTH.,#{side})"));
        let style = file.add(format!("PRESENTATION_STYLE_ASSIGNMENT((#{usage}))"));
        self.styled.push(file.add(format!("STYLED_ITEM('color',(#{style}),#{number})")));
    }

    /// A body of triangles.
    pub fn facets(&mut self, file: &mut Part21, part: &FacetedPart) -> RepresentationItems {
        let name = text(&part.name);
        let count = part.positions.len();
        let positions = joined(part.positions.iter().map(|p| reals(p.to_array())));
        let list = file.add(format!("COORDINATES_LIST({name},{count},{positions})"));
        let triangles = joined(part.triangles.iter().map(|[a, b, c]| {
            let [a, b, c] = [a, b, c].map(|v| v + 1);
            format!("({a},{b},{c})")
        }));
        let face =
            file.add(format!("TRIANGULATED_FACE({name},#{list},{count},(),$,(),{triangles})"));
        let kind = if part.closed() { "TESSELLATED_SOLID" } else { "TESSELLATED_SHELL" };
        let body = file.add(format!("{kind}({name},(#{face}),$)"));
        self.style(file, part.colour, &part.layers, body);
        RepresentationItems { items: vec![body], kind: "TESSELLATED_SHAPE_REPRESENTATION" }
    }

    /// Colours and layers.
    pub fn presentation(&self, file: &mut Part21, space: usize) {
        if !self.styled.is_empty() {
            file.add(format!(
                "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',{},#{space})",
                list(&self.styled)
            ));
        }
        for (layer, items) in &self.layers {
            file.add(format!("PRESENTATION_LAYER_ASSIGNMENT({},'',{})", text(layer), list(items)));
        }
    }
}
