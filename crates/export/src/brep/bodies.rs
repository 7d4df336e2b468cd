//! Bodies of sets as exact faces where these are planes, quadrics with an axis and tori, else as patches.
//!
//! `set -> facets, each with its primitive -> faces, edges, vertices -> points on the border of the
//! set?`
//!
//! A body with any other surface, as a blend, has exact plane faces, and patches of splines that are
//! within the accuracy elsewhere.
//!
//! Facets determine connectivity only; if a point of an edge or face is not on the boundary of the
//! set, the facets have missed something, and finer ones are made, or the body is refused with the
//! position.

use crate::ExportFailure;
use moldloft_brep::{
    Brep, FacetFault, FacetFaultKind, LabelledFacets, SurfaceAxes, SurfaceField, SurfaceImage,
    SurfaceShape,
};
use moldloft_diag::Diagnostic;
use moldloft_document::Document;
use moldloft_field::{
    BehindSheet, Effort, FacetOptions, Facets, FieldError, Form, Leaf, Membership, Primitive,
    QuadricClass, Resolution, Set, around, behind_sheets, certified, facet, set_of, solid_part,
};
use moldloft_mesh::{Mesh, measure};
use moldloft_model::Object;
use moldloft_num::{Box3, Vec3};
use moldloft_picture::PALETTE;
use moldloft_registry::{FromValue, Point, Value};
use std::collections::HashMap;

/// Levels of cells that are tried for exact faces, and for patches.
const LEVELS: std::ops::RangeInclusive<u32> = 5..=8;
const PATCH_LEVELS: std::ops::RangeInclusive<u32> = 4..=6;

/// Number of points along an edge compared with the set, per length of a cell.
const PLACES: f64 = 6.0;

/// A part that cells pass over.
const THIN: &str = "thin-part";

/// Relative accuracy of the proved volume of a body, and maximum number of cells for it: fewer if
/// the facets are proved to be complete.
const SHARE: f64 = 1e-9;
const PROOF: usize = 20_000;
const CHECK: usize = 4_000;

/// Remedy for a refused body.
const HELP: &str = "write it as stl, 3mf or obj, or hide it";

/// Adds the faces of the body of that name, if it is one of a set; false for other bodies.
///
/// # Errors
/// Surfaces with a kink, or that no patches come near enough to; parts that are thinner than the finest cells.
pub fn add(
    brep: &mut Brep,
    document: &Document,
    mesh: &Mesh,
    name: &str,
    [accuracy, size]: [f64; 2],
) -> Result<bool, ExportFailure> {
    let graph = document.graph();
    let Some(object) = graph.find(name).and_then(|key| graph.get(key)) else { return Ok(false) };
    let Some((set, over)) = set_and_box(document, object) else { return Ok(false) };
    if set.leaves().iter().all(|leaf| !leaf.primitive.is_sheet()) {
        SetOfBody { set: &set, over: &over, name, mesh }.add(brep, accuracy, size)?;
        return Ok(true);
    }
    // A body refused later is written as triangles as a whole.
    let mut made = Brep::default();
    let solid = solid_part(&set);
    if !solid.is_nothing() {
        SetOfBody { set: &solid, over: &over, name, mesh }.add(&mut made, accuracy, size)?;
    }
    SetOfBody { set: &set, over: &over, name, mesh }.sheets(&mut made, accuracy, size)?;
    brep.append(made);
    Ok(true)
}

struct SetOfBody<'a> {
    set: &'a Set,
    over: &'a Box3,
    name: &'a str,
    mesh: &'a Mesh,
}

impl SetOfBody<'_> {
    fn facets(&self, level: u32) -> Result<Facets, ExportFailure> {
        let options = FacetOptions::new(Resolution::Level(level));
        facet(self.set, self.over, &options).map_err(|e| no_facets(self.name, &e).into())
    }

    /// Adds the body as exact faces, or with patches.
    fn add(&self, brep: &mut Brep, accuracy: f64, size: f64) -> Result<(), ExportFailure> {
        let exact = if self.is_plain() { self.exact(brep, accuracy, size)? } else { Some(None) };
        let Some(refused) = exact else { return Ok(()) };
        // Coarser facets miss such parts, too.
        if let Some(thin) = refused.as_ref().filter(|d| d.id == THIN && !self.has_expressions()) {
            return Err(thin.clone().into());
        }
        match self.patches(brep, accuracy, size)? {
            None => Ok(()),
            Some(patches) if self.has_expressions() => Err(patches.into()),
            // A body of such faces alone is recognised by them.
            Some(patches) => Err(refused.unwrap_or(patches).into()),
        }
    }

    /// True if all visible surfaces may have an exact form; facets give the final answer.
    fn is_plain(&self) -> bool {
        const KINDS: [&str; 6] = ["plane", "sphere", "cylinder", "cone", "torus", "field"];
        let kinds = self.shown_kinds();
        let quadric = |leaf: &Leaf| {
            !matches!(leaf.primitive.form(), Form::General)
                || quadric(&leaf.primitive, self.over).is_some()
        };
        kinds.iter().all(|k| KINDS.contains(k))
            && (!kinds.contains(&"field") || self.set.leaves().iter().all(quadric))
    }

    /// True if it has surfaces of expressions, for which patches may be made if there are no exact
    /// faces.
    fn has_expressions(&self) -> bool {
        self.shown_kinds().contains(&"field")
    }

    fn shown_kinds(&self) -> Vec<&str> {
        let prefix = format!("{}.", self.name);
        let shown = self.mesh.patches().iter().map(|p| &p.info);
        let own = |name: &str| name == self.name || name.starts_with(&prefix);
        shown.filter(|i| own(&i.name)).map(|i| i.kind.as_str()).collect()
    }

    /// Adds the sheets of the set, as open faces.
    fn sheets(&self, brep: &mut Brep, accuracy: f64, size: f64) -> Result<(), ExportFailure> {
        let mut last = None;
        for level in PATCH_LEVELS {
            let options = FacetOptions::new(Resolution::Level(level));
            let sheets = behind_sheets(self.set, self.over, &options)
                .map_err(|e| no_facets(self.name, &e))?;
            let mut made = Brep::default();
            last = sheets.iter().find_map(|s| self.sheet(&mut made, s, [accuracy, size]));
            if last.is_none() {
                brep.append(made);
                return Ok(());
            }
        }
        Err(last.map_or_else(|| ExportFailure::from(Vec::new()), Into::into))
    }

    /// Adds a sheet; else why not.
    fn sheet(&self, brep: &mut Brep, sheet: &BehindSheet, scale: [f64; 2]) -> Option<Diagnostic> {
        let facets = &sheet.facets;
        if let Some(open) = facets.unresolved.first() {
            return Some(missed(self.name, open.place.centre(), facets.step));
        }
        let field = field_of(facets);
        let mut labelled = labelled(facets, self.mesh, self.name, self.over);
        let own = format!("{}.{}", self.name, sheet.info.name);
        let known = self.mesh.patches().iter().map(|p| &p.info).find(|i| i.name == own);
        let info = known.unwrap_or(&sheet.info);
        for k in (0..sheet.shown.len()).filter(|k| sheet.shown[*k]) {
            labelled.names[k] = own.clone();
            labelled.colours[k] = info.colour.map(|c| PALETTE[usize::from(c & 15)]);
            labelled.layers[k] = info.tags.clone();
        }
        if labelled.surfaces.iter().all(Option::is_some) {
            let mut made = Brep::default();
            let (whole, shown) = (labelled.clone(), sheet.shown.clone());
            let places = made.add_facets_on(whole, shown, scale[0], scale[1]);
            if self.judged(&made, places, facets.step, scale).is_none() {
                brep.append(made);
                return None;
            }
        }
        let mut made = Brep::default();
        let places = made.add_sheet(labelled, sheet.shown.clone(), &field, scale[0], scale[1]);
        let fault = self.judged(&made, places, facets.step, scale);
        if fault.is_none() {
            brep.append(made);
        }
        fault
    }

    /// Adds the body as exact faces; otherwise returns the reason, or `None` for a surface of
    /// another form.
    fn exact(
        &self,
        brep: &mut Brep,
        accuracy: f64,
        size: f64,
    ) -> Result<Option<Option<Diagnostic>>, ExportFailure> {
        let mut last = None;
        let mut before = f64::INFINITY;
        for level in LEVELS {
            let facets = self.facets(level)?;
            // A thin box makes the cells of coarse levels equal.
            if std::mem::replace(&mut before, facets.step) == facets.step {
                continue;
            }
            let (labelled, step) =
                (labelled(&facets, self.mesh, self.name, self.over), facets.step);
            if labelled.surfaces.iter().any(Option::is_none) {
                return Ok(Some(None));
            }
            let mut made = Brep::default();
            let places = made.add_facets(labelled, accuracy, size);
            let fault = match self.judged(&made, places, step, [accuracy, size]) {
                None => self.wrong_volume(&made, &facets)?,
                fault => fault,
            };
            match fault {
                None => {
                    brep.append(made);
                    return Ok(None);
                }
                fault => last = fault,
            }
        }
        Ok(Some(last))
    }

    /// Adds the body with patches; else why not.
    fn patches(
        &self,
        brep: &mut Brep,
        accuracy: f64,
        size: f64,
    ) -> Result<Option<Diagnostic>, ExportFailure> {
        let mut last = None;
        // Finer cells make better patches than patience does.
        let mut tries: Vec<(bool, u32)> = PATCH_LEVELS.map(|level| (false, level)).collect();
        let mut before = f64::INFINITY;
        let mut next = 0;
        while let Some(&(patient, level)) = tries.get(next) {
            next += 1;
            let facets = self.facets(level)?;
            if !patient && std::mem::replace(&mut before, facets.step) == facets.step {
                continue;
            }
            let field = field_of(&facets);
            let labelled = labelled(&facets, self.mesh, self.name, self.over);
            // Cylinders and cones as whole faces, unless that fails where patches do not.
            if wants_whole(&labelled, &field) {
                let mut made = Brep::default();
                let places =
                    made.add_patches(labelled.clone(), &field, accuracy, size, [true, patient]);
                if places.is_ok()
                    && self.judged(&made, places, facets.step, [accuracy, size]).is_none()
                    && self.wrong_volume(&made, &facets)?.is_none()
                {
                    brep.append(made);
                    return Ok(None);
                }
            }
            let mut made = Brep::default();
            let places = made.add_patches(labelled, &field, accuracy, size, [false, patient]);
            match &places {
                // Finer cells only make more.
                Err(fault) if fault.kind == FacetFaultKind::Many => {
                    return Ok(Some(reported(self.name, fault)));
                }
                // Nor does patience find these.
                Err(fault)
                    if matches!(fault.kind, FacetFaultKind::Vertex | FacetFaultKind::NotClosed) => {
                }
                _ if !patient => tries.push((true, level)),
                _ => {}
            }
            let fault = match self.judged(&made, places, facets.step, [accuracy, size]) {
                None => self.wrong_volume(&made, &facets)?,
                fault => fault,
            };
            match fault {
                None => {
                    brep.append(made);
                    return Ok(None);
                }
                fault => last = fault,
            }
        }
        Ok(last)
    }

    /// The fault of faces.
    fn judged(
        &self,
        made: &Brep,
        places: Result<Vec<Vec3>, FacetFault>,
        step: f64,
        scale: [f64; 2],
    ) -> Option<Diagnostic> {
        match places {
            Err(fault) => Some(reported(self.name, &fault)),
            Ok(_) if let Some(place) = between_one_line(made) => {
                Some(missed(self.name, place, step))
            }
            Ok(places) => elsewhere(made, self.set, self.over, places, step, scale)
                .map(|place| missed(self.name, place, step)),
        }
    }

    /// The fault of a body whose faces do not enclose the proved volume of the set: a part missed
    /// by all cells. If the volume of the faces is not known from their edges, that of the facets
    /// is compared.
    fn wrong_volume(
        &self,
        made: &Brep,
        facets: &Facets,
    ) -> Result<Option<Diagnostic>, ExportFailure> {
        let shown = measure(&facets.mesh);
        let size = (0..3).map(|k| self.over.high[k] - self.over.low[k]).fold(0.0, f64::max);
        let (volume, off) = match made.volume() {
            Some(v) => (v.volume, v.error + (made.gap + 1e-9 * size) * shown.area),
            // Triangles are as far from their surfaces as their centres.
            None => (shown.volume, facets.worst_centre() * shown.area),
        };
        let cells = if facets.unresolved.is_empty() { CHECK } else { PROOF };
        let effort = Effort { cells, ..Effort::to(SHARE * volume.abs()) };
        let proved = certified(self.set, self.over, &effort, &Default::default()).map_err(|e| {
            Diagnostic::error(
                "cannot-write",
                format!("`{}` has no certified volume: {e}", self.name),
            )
        })?;
        let bracket = proved.bracket.volume();
        if volume >= bracket.low - off && volume <= bracket.high + off {
            return Ok(None);
        }
        let place =
            proved.open.first().map_or_else(|| self.over.centre(), |(place, _)| place.centre());
        Ok(Some(missed(self.name, place, facets.step).found(format!(
            "faces that enclose {volume:.9}, and a volume from {:.9} to {:.9}",
            bracket.low, bracket.high
        ))))
    }
}

/// The set and the box of a body of facets.
pub fn set_and_box(document: &Document, object: &Object<f64>) -> Option<(Set, Box3)> {
    if object.row.name != "SetBody" {
        return None;
    }
    let graph = document.graph();
    let value = |k: usize| -> Option<Value<f64>> {
        match object.args.get(k)? {
            Value::Object(key) => graph.get(*key)?.value().cloned(),
            other => Some(other.clone()),
        }
    };
    let set = set_of(&value(0)?)?;
    let corner = |k: usize| value(k).and_then(|v| Point::from_value(&v).ok()).map(|p| p.xyz);
    let over = match (corner(1), corner(2)) {
        (Some(low), Some(high)) => Box3 { low, high },
        _ => around(&set).ok()??,
    };
    Some((set, over))
}

fn no_facets(name: &str, why: &FieldError) -> Diagnostic {
    Diagnostic::error("cannot-write", format!("`{name}` has no facets: {why}"))
}

/// The function of each patch of facets, and its gradient.
fn field_of(facets: &Facets) -> impl Fn(u32, Vec3) -> (f64, Vec3) + Sync {
    |k: u32, p: Vec3| {
        let g = facets.leaves[facets.patch_leaves[k as usize]].primitive.gradient(p);
        (g.value, g.slope)
    }
}

fn labelled(facets: &Facets, shown: &Mesh, name: &str, over: &Box3) -> LabelledFacets {
    let mesh = &facets.mesh;
    let (mut triangles, mut labels) = (Vec::new(), Vec::new());
    let (mut surfaces, mut names, mut colours, mut layers) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut taken: HashMap<String, usize> = HashMap::new();
    for (k, patch) in mesh.patches().iter().enumerate() {
        for face in &mesh.faces()[patch.faces.clone()] {
            triangles.push([face[0], face[1], face[2]]);
            labels.push(k as u32);
        }
        let own = &patch.info.name;
        let count = taken.entry(own.clone()).or_insert(0);
        *count += 1;
        let full =
            if *count == 1 { format!("{name}.{own}") } else { format!("{name}.{own}.{count}") };
        let primitive = &facets.leaves[facets.patch_leaves[k]].primitive;
        surfaces.push(surface(primitive, over));
        // As its panels are shown; those of a face that their cells miss as the first of the body.
        let prefix = format!("{name}.");
        let patches = || shown.patches().iter().map(|p| &p.info);
        let info = patches()
            .find(|p| p.name == full)
            .or_else(|| patches().find(|p| p.name.starts_with(&prefix)))
            .unwrap_or(&patch.info);
        names.push(full);
        colours.push(info.colour.map(|c| PALETTE[usize::from(c & 15)]));
        layers.push(info.tags.clone());
    }
    let positions = mesh.positions().to_vec();
    let step = facets.step;
    let certain = false;
    LabelledFacets { positions, triangles, labels, surfaces, names, colours, layers, step, certain }
}

/// The surface of a primitive, where CAD formats have one.
fn surface(primitive: &Primitive<f64>, over: &Box3) -> Option<SurfaceShape> {
    let about = |axis: &moldloft_num::Axis<f64>| SurfaceAxes::about(axis.point, axis.direction);
    Some(match primitive.form() {
        Form::Plane(plane) => SurfaceShape::Plane {
            origin: plane.point,
            normal: plane.normal,
            axis: plane.normal.perpendicular(),
        },
        Form::Sphere { centre, radius } => SurfaceShape::Sphere {
            axes: SurfaceAxes::about(*centre, Vec3::of(0.0, 0.0, 1.0)),
            radius: *radius,
        },
        Form::Cylinder { axis, radius } => {
            SurfaceShape::Cylinder { axes: about(axis), radius: *radius }
        }
        Form::Cone { axis, angle } => {
            SurfaceShape::Cone { axes: about(axis), radius: 0.0, half_angle: 0.5 * angle }
        }
        // A self-intersecting torus has points without a normal.
        Form::Torus { axis, major, minor } if minor < major => {
            SurfaceShape::Torus { axes: about(axis), major: *major, minor: *minor }
        }
        _ => return quadric(primitive, over),
    })
}

/// The ellipsoid, elliptic cylinder or cone of an expression.
fn quadric(primitive: &Primitive<f64>, over: &Box3) -> Option<SurfaceShape> {
    /// Radii that differ less are one.
    const ROUND: f64 = 1e-12;
    let size = over.diagonal();
    let found = primitive.quadric(over.centre(), size, 1e-9 * size)?;
    let [x, y, z] = found.half;
    let [a, b, c] = found.half.map(|v| v.norm());
    let one = |a: f64, b: f64| (a - b).abs() <= ROUND * a;
    let axes = SurfaceAxes::about(found.centre, z);
    let unit = SurfaceAxes {
        origin: Vec3::zero(),
        z: Vec3::of(0.0, 0.0, 1.0),
        x: Vec3::of(1.0, 0.0, 0.0),
    };
    let of = match found.class {
        QuadricClass::Ellipsoid if one(a, b) && one(b, c) => {
            return Some(SurfaceShape::Sphere { axes, radius: a });
        }
        QuadricClass::Cylinder if one(a, b) => {
            return Some(SurfaceShape::Cylinder { axes, radius: a });
        }
        QuadricClass::Cone if one(a, b) => {
            return Some(SurfaceShape::Cone { axes, radius: 0.0, half_angle: libm::atan2(a, c) });
        }
        QuadricClass::Ellipsoid => SurfaceShape::Sphere { axes: unit, radius: 1.0 },
        QuadricClass::Cylinder => SurfaceShape::Cylinder { axes: unit, radius: 1.0 },
        QuadricClass::Cone => {
            SurfaceShape::Cone { axes: unit, radius: 0.0, half_angle: std::f64::consts::FRAC_PI_4 }
        }
    };
    let right = if x.cross(y).dot(z) < 0.0 { -y } else { y };
    SurfaceImage::new(of, found.centre, [x, right, z]).map(|i| SurfaceShape::Image(Box::new(i)))
}

/// A point of a face whose border is one straight edge in both directions: the facets do not
/// represent it.
fn between_one_line(made: &Brep) -> Option<Vec3> {
    let straight = |edge: usize| made.edges[edge].curve.points.len() == 2;
    let borders = made.faces.iter().flat_map(|face| &face.loops);
    let mut lines = borders.filter(|sides| sides.len() <= 2);
    let found = lines.find(|sides| sides.iter().all(|side| straight(side.edge)))?;
    Some(made.edges[found.first()?.edge].curve.points[0])
}

/// A point of the faces' edges, or of triangles moved onto their surfaces, that is not on the
/// border of the set.
fn elsewhere(
    made: &Brep,
    set: &Set,
    over: &Box3,
    mut places: Vec<Vec3>,
    step: f64,
    [accuracy, size]: [f64; 2],
) -> Option<Vec3> {
    let tolerance = accuracy.max(made.gap) + 1e-9 * size;
    places.extend(&made.vertices);
    for edge in &made.edges {
        let length = edge.curve.points.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
        let count = (PLACES * length / step).clamp(PLACES, 1e4) as usize;
        let ts: Vec<f64> = (1..count).map(|k| k as f64 / count as f64).collect();
        places.extend(edge.curve.grid(&[ts]));
    }
    let mut values = vec![0.0; places.len()];
    set.values(&places, &mut values);
    let body = set.as_body();
    let on = |(p, value): (&Vec3, &f64)| {
        let above = |k: usize| (p[k] - over.high[k]).max(over.low[k] - p[k]);
        let outside = (0..3).map(above).fold(f64::NEG_INFINITY, f64::max);
        if outside > tolerance {
            return false;
        }
        if value.abs() <= 1e-12 * size.min(size * size) {
            return outside <= tolerance;
        }
        match body.member(*p, tolerance, &[]) {
            Membership::Surface => true,
            Membership::Solid => outside >= -tolerance,
            Membership::Air => false,
        }
    };
    places.iter().zip(&values).find(|pair| !on(*pair)).map(|pair| *pair.0)
}

fn place_of(p: Vec3) -> String {
    format!("({:.6}, {:.6}, {:.6})", p.x, p.y, p.z)
}

fn missed(name: &str, place: Vec3, step: f64) -> Diagnostic {
    Diagnostic::error(
        THIN,
        format!("`{name}` has a part that is thinner than cells near {}", place_of(place)),
    )
    .found(format!("cells of {step:.3e}"))
    .help(HELP)
}

fn reported(name: &str, fault: &FacetFault) -> Diagnostic {
    let surfaces = fault.surfaces.join("` and `");
    let of = if surfaces.is_empty() { format!("`{name}`") } else { format!("`{surfaces}`") };
    let what = match fault.kind {
        FacetFaultKind::NotClosed => "has facets that do not close",
        FacetFaultKind::Seam => "closes around its axis, and no seam avoids its vertices",
        FacetFaultKind::Edge => "meet or touch along an edge that could not be computed",
        FacetFaultKind::Vertex => "meet in a corner that could not be computed",
        FacetFaultKind::Surface => "is not a surface of a type that formats have",
        FacetFaultKind::Many => "takes tens of thousands of patches for this tolerance, some",
        FacetFaultKind::Patch => "has a kink, or turns too fast for patches,",
    };
    let help = match fault.kind {
        FacetFaultKind::Many => "ask for a larger `tolerance`, or write it as stl, 3mf or obj",
        _ => HELP,
    };
    Diagnostic::error("curved-body", format!("{of} {what} near {}", place_of(fault.place)))
        .help(help)
}

/// True if whole faces on cylinders and cones should be tried: there are some, and their neighbours
/// cross them. Beside a tangent surface, such as a blend, edges would intersect their neighbours
/// within the accuracy.
fn wants_whole(facets: &LabelledFacets, field: &SurfaceField<'_>) -> bool {
    /// The sine of the angle between surfaces that cross.
    const CROSSING: f64 = 0.1;
    let shape = |label: u32| facets.surfaces[label as usize].as_ref();
    let round = |label: u32| {
        let of = shape(label).map(|s| match s {
            SurfaceShape::Image(image) => image.of(),
            other => other,
        });
        matches!(of, Some(SurfaceShape::Cylinder { .. } | SurfaceShape::Cone { .. }))
    };
    let flat = |label: u32| matches!(shape(label), Some(SurfaceShape::Plane { .. }));
    if !(0..facets.surfaces.len() as u32).any(round) {
        return false;
    }
    let sides = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let all = facets.triangles.iter().zip(&facets.labels);
    let label_at: HashMap<[u32; 2], u32> =
        all.flat_map(|(t, label)| sides(t).map(|side| (side, *label))).collect();
    label_at.iter().all(|(&[a, b], &own)| {
        let Some(&other) = label_at.get(&[b, a]) else { return true };
        if own == other || !round(own) || flat(other) {
            return true;
        }
        let middle = facets.positions[a as usize].lerp(facets.positions[b as usize], 0.5);
        let [n, m] = [own, other].map(|label| field(label, middle).1);
        n.cross(m).norm() > CROSSING * n.norm() * m.norm()
    })
}
