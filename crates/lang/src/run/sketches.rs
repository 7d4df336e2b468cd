//! Runs a program: the objects of loaded sketches.

use crate::model_file::header;
use crate::model_file::units::{self, PhysicalDimension};
use crate::run::interpreter::Interpreter;
use crate::source::env::{DeclarationOrigin, Param};
use crate::source::module::Module;
use crate::source::scope::{Binding, ScopedBinding};
use crate::source::sketch_file::{Drawn, SketchFile};
use moldloft_diag::{Diagnostic, Span};
use moldloft_field::{set_of, set_value};
use moldloft_mesh::Mesh;
use moldloft_model::{Declaration, Extent};
use moldloft_num::Vec3;
use moldloft_num::trace::Key;
use moldloft_registry::{Given, Scalar, Value, bind_arguments};
use moldloft_sketch::curve::{SmoothPiece, Traced};
use moldloft_sketch::{
    BodyTree, CoordinateAxis, DimensionFault, DimensionLayout, NoBody, Operation, PointId,
    RoundFace, SketchSolid, body_tree, solve,
};
use moldloft_syntax::sdl::{Arg, Ident, NodeList, StmtId};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Position of a sketch's declaration.
#[derive(Clone, Copy)]
pub(crate) struct Site {
    pub origin: u32,
    pub span: Span,
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// `load "dam.skt"`: once, at file level.
    pub fn load_sketch(&mut self, path: &str, id: StmtId, span: Span) -> Result<(), Diagnostic> {
        let file = self.modules.load_sketch(self.current, path, span, &mut self.loader)?;
        // The parser has reported it inside a loop or subroutine.
        if !self.env.scope.frame().global || !self.env.scope.frame().loops.is_empty() {
            return Ok(());
        }
        if !self.env.scope.sketches_done.insert(file.path.clone()) {
            return Ok(());
        }
        let origin = self.sketch_origin(id);
        self.sketch(&file, Site { origin, span });
        Ok(())
    }

    /// Remembers the unit of length that a sketch states.
    fn note_unit(&mut self, file: &SketchFile, span: Span) {
        let known = self.env.sketch_units.iter().any(|u| u.0 == file.path);
        if let Some(unit) = file.unit().filter(|_| !known) {
            self.env.sketch_units.push((file.path.clone(), unit, span));
        }
    }

    /// Reports sketches whose numbers are in another unit of length than the model states, or than one another.
    pub fn judge_units(&mut self) {
        let text = header::text(self.run.graph(), "units");
        let stated = units::parsed(&text).unwrap_or_default();
        let own = stated.into_iter().find(|u| u.1 == PhysicalDimension::Length);
        let own = own.map(|u| (u.0.to_owned(), "the model".to_owned()));
        let first = self
            .env
            .sketch_units
            .first()
            .map(|(path, unit, _)| (unit.clone(), format!("`{path}`")));
        let Some((unit, whose)) = own.or(first) else { return };
        let size = |word: &str| units::unit(word).map(|u| u.2);
        let others: Vec<Diagnostic> = (self.env.sketch_units.iter())
            .filter(|(_, other, _)| size(other) != size(&unit))
            .map(|(path, other, span)| {
                let text = format!("the sketch `{path}` is in {other}, {whose} in {unit}");
                Diagnostic::error("units-differ", text)
                    .at(*span)
                    .expected("one unit of length for all numbers")
                    .help(format!(
                        "SET UNITS {} CONVERT in the sketch converts its numbers",
                        unit.to_ascii_uppercase()
                    ))
            })
            .collect();
        others.into_iter().for_each(|fault| self.report(fault));
    }

    fn sketch_origin(&mut self, id: StmtId) -> u32 {
        let origin = self.env.origins.len() as u32;
        // The statement makes several objects, so no literal belongs to one of them.
        self.env.origins.push(DeclarationOrigin {
            module: self.current as u32,
            stmt: id,
            repeated: true,
        });
        origin
    }

    /// Declares all objects of a sketch file, their dimensions as parameters.
    pub fn sketch(&mut self, file: &Arc<SketchFile>, site: Site) {
        file.faults.iter().for_each(|fault| self.report(fault.clone()));
        self.note_unit(file, site.span);
        let mut given = Vec::new();
        for drawn in &file.objects {
            let prefix = file.prefix(drawn);
            let mut values = BTreeMap::new();
            for (key, name, default, range) in drawn.parameters() {
                let full = format!("{prefix}.{name}");
                let place = drawn.place(key).unwrap_or(Span::new(file.file, 0, 0));
                match self.sketch_param(full, default, range, place) {
                    Ok(Some(value)) => drop(values.insert(key.clone(), value)),
                    Ok(None) => {}
                    Err(diagnostic) => self.report(diagnostic),
                }
            }
            given.push((prefix, values));
        }
        share_numbers(&file.objects, &mut given);
        for (drawn, (prefix, values)) in file.objects.iter().zip(given) {
            self.drawn(drawn, &prefix, &values, site);
            // Found under its own name as well, and in small letters: sketches do not tell them apart.
            let own = crate::model_file::names::identifier(&drawn.object.name);
            for alias in [&prefix, &prefix.to_ascii_lowercase(), &own] {
                let name = self.modules.name(alias);
                self.env.scope.make_room(self.modules.name_count());
                if self.env.scope.lookup(name).is_none() {
                    let what = Binding::Instance(prefix.as_str().into());
                    self.env.scope.globals[name.0 as usize] =
                        Some(ScopedBinding { span: site.span, what });
                }
            }
        }
    }

    /// A dimension as a parameter; its value when it is another than the file's, or has derivatives.
    fn sketch_param(
        &mut self,
        name: String,
        default: f64,
        range: Option<[f64; 2]>,
        span: Span,
    ) -> Result<Option<T>, Diagnostic> {
        let given = self.inputs.overrides.get(&name).copied();
        let x = given.unwrap_or(default);
        let range = range.map(|[low, high]| (low, high));
        let inside = range.is_none_or(|(low, high)| (low..=high).contains(&x));
        if !x.is_finite() || !inside {
            let expected = match range {
                Some((low, high)) => format!("a number from {low} to {high}"),
                None => "a finite number".to_owned(),
            };
            let text = format!("`{name}` = {x} is out of its range");
            return Err(Diagnostic::error("out-of-range", text)
                .at(span)
                .expected(expected)
                .found(moldloft_syntax::number::plain(x)));
        }
        let value = (self.inputs.seed)(&name, T::from(x));
        let changed = given.is_some() || !value.is_constant();
        self.env.params.push(Param { name, value: x, default, range, is_int: false, span });
        self.env.param_values.push(value);
        Ok(changed.then_some(value))
    }

    /// `Sketch low("dam.skt", CREST = w);`: a named sketch with values that are not parameters but
    /// results of the program.
    pub fn sketch_object(
        &mut self,
        m: &Module,
        id: StmtId,
        name: Ident,
        args: NodeList<Arg>,
        span: Span,
    ) -> Result<(), Diagnostic> {
        if self.run.extent() == Extent::Edit {
            return Err(Diagnostic::error("misplaced-object", "an expression declares no objects")
                .at(name.span));
        }
        let wants = |at: Span| {
            Diagnostic::error("wrong-argument", "a sketch takes its file, then dimensions by name")
                .at(at)
                .expected("Sketch low(\"dam.skt\", CREST = 20)")
        };
        let mut path = None;
        let mut given: Vec<(Ident, T)> = Vec::new();
        for arg in &m.program[args] {
            let at = m.program[arg.value].span;
            let value = self.operand(m, arg.value)?;
            match (value, arg.name) {
                (Value::Text(text), None) if path.is_none() => path = Some(text),
                (Value::Number(x), Some(ident)) => given.push((ident, x)),
                _ => return Err(wants(at)),
            }
        }
        let path = path.ok_or_else(|| wants(span))?;
        let file = self.modules.load_sketch(self.current, &path, span, &mut self.loader)?;
        let results: Vec<usize> = (file.objects.iter().enumerate())
            .filter_map(|(k, drawn)| drawn.result.then_some(k))
            .collect();
        let [own] = results[..] else {
            file.faults.iter().for_each(|fault| self.report(fault.clone()));
            let found = format!("{} objects in `{path}`", results.len());
            return Err(Diagnostic::error("wrong-count", "a named sketch must have one result")
                .at(span)
                .expected("a file with one object, and those that it is made of")
                .found(found)
                .help(format!("load \"{path}\" brings all of them in")));
        };
        file.faults.iter().for_each(|fault| self.report(fault.clone()));
        let drawn = &file.objects[own];
        let mut values: Vec<(String, BTreeMap<String, T>)> =
            file.objects.iter().map(|_| (String::new(), BTreeMap::new())).collect();
        for (ident, x) in given {
            let word = m.program.name(ident.symbol);
            if !drawn.object.has_number(word) {
                let stands = drawn.object.variables.values().map(|v| v.name.as_str());
                let stands = stands.filter(|name| drawn.object.alias(name).is_some());
                let known = drawn.parameters().map(|p| p.1.as_str());
                let known: Vec<&str> = known.chain(stands).collect();
                return Err(Diagnostic::error(
                    "unknown-argument",
                    format!("the sketch has no dimension `{word}`"),
                )
                .at(ident.span)
                .expected(known.join(", "))
                .suggest(word, known.iter().copied()));
            }
            // A number of an object that this one follows is given to that object.
            let source = drawn.object.source(word);
            let of = source.split_once('.').filter(|_| !drawn.object.has_number(&source));
            let called = |d: &Drawn, of: &str| {
                moldloft_sketch::identifier(&d.object.name).eq_ignore_ascii_case(of)
            };
            let other = of.and_then(|(of, number)| {
                Some((file.objects.iter().position(|d| called(d, of))?, number.to_owned()))
            });
            let (k, key) = other.unwrap_or((own, source));
            values[k].1.insert(key, x);
        }
        share_numbers(&file.objects, &mut values);
        self.note_unit(&file, span);
        let full = self.instance_name(m, name)?;
        let origin = self.sketch_origin(id);
        self.drawn(drawn, &full, &values[own].1, Site { origin, span });
        Ok(())
    }

    /// Declares an object of a sketch with some of its numbers replaced.
    fn drawn(&mut self, drawn: &Drawn, prefix: &str, values: &BTreeMap<String, T>, site: Site) {
        let object = &drawn.object;
        let layout = solve(object, &drawn.planes, values, &|| drawn.estimate());
        for fault in &layout.faults {
            if let Some(text) = fault_text(fault) {
                let diagnostic =
                    Diagnostic::error("sketch-unsolved", format!("`{prefix}`: {text}"));
                self.report(diagnostic.at(site.span).help("change the dimensions, or see CHECK"));
            }
        }
        if !layout.complete() && !object.drawing.points.is_empty() {
            let missing = |a: CoordinateAxis| (a, layout.counts[a.index()].missing);
            let missing: Vec<String> = (CoordinateAxis::ALL.map(missing).iter())
                .filter(|m| m.1 > 0)
                .map(|(a, n)| format!("{a}: {n}"))
                .collect();
            let text =
                format!("`{prefix}` is not fully dimensioned; missing {}", missing.join(", "));
            let diagnostic = Diagnostic::warning("sketch-incomplete", text);
            self.report(
                diagnostic.at(site.span).help("CONVERT in the sketch names the free points"),
            );
        }
        let mut names = SketchDeclarations {
            prefix,
            site,
            shown: drawn.result,
            members: Vec::new(),
            points: BTreeMap::new(),
        };
        for &id in drawn.planes.ids() {
            if let Some(at) = layout.point(&drawn.planes, id) {
                self.sketch_point(&mut names, id, at);
            }
        }
        let body = match moldloft_sketch::body(object, &drawn.planes, &layout) {
            Ok(body) => Some(body),
            Err(NoBody::Unfinished) => None,
            Err(why) => {
                let fault = moldloft_sketch::command::no_body(object, &why);
                let text = format!("`{prefix}` has no body: {}", fault.text);
                let diagnostic = Diagnostic::error("sketch-invalid", text).at(site.span);
                self.report(diagnostic.help(fault.next));
                None
            }
        };
        for v in body.iter().flat_map(|b| &b.vertices) {
            if !names.points.contains_key(&v.id) {
                self.sketch_point(&mut names, v.id, v.at);
            }
        }
        for (id, line) in &object.drawing.lines {
            if let (Some(&p), Some(&q)) = (names.points.get(&line.p), names.points.get(&line.q)) {
                let ends = vec![Value::Object(p), Value::Object(q)];
                self.part(&mut names, &format!("l{id}"), "Line", ends, true);
            }
        }
        if let Some(body) = &body {
            self.sketch_body(&mut names, drawn, &layout, body);
        }
        for (key, d) in &object.dimensions {
            let measured = || layout.measured(object, &drawn.planes, &d.measure);
            let value = layout.values.get(key).copied().or_else(measured);
            names.members.extend(value.map(|x| (d.name.clone(), Value::Number(x))));
        }
        for (key, v) in &object.variables {
            let value = layout.values.get(key);
            names.members.extend(value.map(|x| (v.name.clone(), Value::Number(*x))));
        }
        let members = names.members;
        for (name, value) in members {
            let full = format!("{prefix}.{name}");
            self.env.sketch_members.insert(full.to_ascii_lowercase(), value.clone());
            // Numbers as the sketch spells them; objects are in the graph.
            self.env.sketch_members.insert(full, value);
        }
        self.env.sketches.push(prefix.to_owned());
    }

    fn sketch_point(&mut self, names: &mut SketchDeclarations<'_, T>, id: PointId, at: Vec3<T>) {
        let xyz = at.to_array().map(Value::Number).to_vec();
        if let Some(key) = self.part(names, &format!("p{id}"), "AbsPoint", xyz, true) {
            names.points.insert(id, key);
        }
    }

    /// The set of combined bodies, of a set of faces for each; those are hidden objects.
    fn set_of_bodies(
        &mut self,
        names: &mut SketchDeclarations<'_, T>,
        tree: &BodyTree<T>,
        leaves: &mut Vec<Key>,
    ) -> Option<Value<T>> {
        match tree {
            BodyTree::Plain(body) => {
                let mesh = body.faceted();
                let n = leaves.len() + 1;
                let args = mesh_arguments(body, &mesh);
                let key = self.part(names, &format!("part{n}"), "MeshBody", args, false)?;
                let args = face_arguments(body, &mesh, key);
                let key = self.part(names, &format!("body{n}"), "FaceSet", args, false)?;
                leaves.push(key);
                self.forced(key).ok()
            }
            BodyTree::Combined(operation, parts) => {
                let (first, others) = parts.split_first()?;
                let mut all = set_of(&self.set_of_bodies(names, first, leaves)?)?;
                for other in others {
                    let other = set_of(&self.set_of_bodies(names, other, leaves)?)?;
                    all = match operation {
                        Operation::Union => all | other,
                        Operation::Cut => all - other,
                        Operation::Common => all & other,
                    };
                }
                Some(set_value(all))
            }
        }
    }

    /// Faces, curves, the mesh and its measures.
    fn sketch_body(
        &mut self,
        names: &mut SketchDeclarations<'_, T>,
        drawn: &Drawn,
        layout: &DimensionLayout<T>,
        body: &SketchSolid<T>,
    ) {
        let object = &drawn.object;
        for (k, curve) in object.curves.values().enumerate() {
            let Some(traced) = body.curves.get(&k) else { continue };
            let ends = match &curve.points[..] {
                [a, _, b] if !curve.kind.at_corner() => [Some(*a), Some(*b)],
                [_, a, .., b, _] if !curve.kind.at_corner() => [Some(*a), Some(*b)],
                _ => {
                    let edge = body.edges.iter().find(|e| e.curve == Some(k));
                    let ends = edge.filter(|_| traced.tangents.is_some() && curve.replaces);
                    ends.map_or([None, None], |e| e.ends.map(|v| Some(body.vertices[v].id)))
                }
            };
            let ends = ends.map(|id| id.and_then(|id| names.points.get(&id).copied()));
            let (kind, args) = curve_arguments(traced, ends);
            let name =
                if is_taken(&curve.name) { format!("{}_", curve.name) } else { curve.name.clone() };
            self.part(names, &name, kind, args, true);
        }
        for (id, face) in &object.faces {
            let keys: Option<Vec<Value<T>>> =
                face.outer.iter().map(|p| names.points.get(p).map(|&k| Value::Object(k))).collect();
            if let Some(keys) = keys {
                self.part(names, &format!("face{id}"), "FacePatch", vec![Value::list(keys)], false);
            }
        }
        let mesh = body.faceted();
        let mass = body.mass();
        let args = mesh_arguments(body, &mesh);
        let key = self.part(names, "solid", "MeshBody", args, true);
        if let Some(plain) = (body as &dyn std::any::Any).downcast_ref::<SketchSolid<f64>>()
            && key.is_some()
            && !body.flat
        {
            let full = format!("{}.solid", names.prefix);
            self.env.sketch_bodies.insert(full, Arc::new(plain.clone()));
        }
        // A set of faces knows cylinders and cones by their straight borders only: a body with round faces that is
        // combined of others is the set of those.
        let closed = !body.flat && mesh.report().closed;
        let round = body.faces.iter().any(|f| f.ruled) && object.is_combined();
        match key.filter(|_| closed) {
            Some(key) if body.trims.is_empty() && !round => {
                let args = face_arguments(body, &mesh, key);
                self.part(names, "body", "FaceSet", args, false);
            }
            Some(_) => {
                let mut leaves = Vec::new();
                let set = body_tree(object, &drawn.planes, layout)
                    .and_then(|tree| self.set_of_bodies(names, &tree, &mut leaves));
                if let Some(set) = set.as_ref().and_then(set_of) {
                    let set = set_value(set.measured(mass.volume, mass.area));
                    let parents = Value::list(leaves.into_iter().map(Value::Object));
                    self.part(names, "body", "Set", vec![set, parents], false);
                }
            }
            None => {}
        }
        if !body.flat {
            names.members.push(("volume".into(), Value::Number(mass.volume)));
        }
        names.members.push(("area".into(), Value::Number(mass.area)));
        names.members.push(("centroid".into(), Value::Vector(mass.centroid)));
    }

    /// Declares `prefix.name`.
    fn part(
        &mut self,
        names: &mut SketchDeclarations<'_, T>,
        name: &str,
        kind: &str,
        args: Vec<Value<T>>,
        shown: bool,
    ) -> Option<Key> {
        let row = self.loader.registry.get(kind)?.clone();
        let full = format!("{}.{name}", names.prefix);
        let given = Given { positional: args, named: Vec::new() };
        let declared =
            bind_arguments(&row, given, |key| self.run.class_of(key)).and_then(|filled| {
                let (args, mut head) = filled;
                head.visible = i32::from(shown && names.shown);
                if !shown {
                    // One panel: its corners are the face's.
                    (head.divisions, head.divided) = ([1, 1], true);
                }
                let origin = names.site.origin;
                self.run.declare(Declaration { name: &full, row: &row, args, head, origin })
            });
        match declared {
            Ok(key) => {
                names.members.push((name.to_owned(), Value::Object(key)));
                Some(key)
            }
            Err(fault) => {
                self.report(crate::source::fault_location::unplaced(&fault).at(names.site.span));
                None
            }
        }
    }
}

/// Adds to the values of each object the numbers of the others, by the names that expressions have for them.
fn share_numbers<T: Scalar>(objects: &[Drawn], given: &mut [(String, BTreeMap<String, T>)]) {
    if objects.iter().all(|d| moldloft_sketch::command::foreign(&d.object).is_empty()) {
        return;
    }
    // A number may read another one that reads a third: as often as there are objects.
    let mut shared: BTreeMap<String, T> = BTreeMap::new();
    for _ in objects {
        let before = shared.len();
        for (drawn, (_, own)) in objects.iter().zip(&*given) {
            let mut known = shared.clone();
            known.extend(own.iter().map(|(name, x)| (name.clone(), *x)));
            let name = moldloft_sketch::identifier(&drawn.object.name).to_ascii_lowercase();
            let values = moldloft_sketch::numbers(&drawn.object, &known);
            let own = values.into_iter().filter(|(key, _)| drawn.object.has_name(key));
            shared.extend(own.map(|(key, x)| (format!("{name}.{key}"), x)));
        }
        if shared.len() == before {
            break;
        }
    }
    for (drawn, (_, own)) in objects.iter().zip(given) {
        let others = shared.iter().filter(|(name, _)| !drawn.object.has_name(name));
        for (name, x) in others {
            own.entry(name.clone()).or_insert(*x);
        }
    }
}

/// The arguments of `MeshBody`: points, triangles and the exact measures.
fn mesh_arguments<T: Scalar>(body: &SketchSolid<T>, mesh: &Mesh<T>) -> Vec<Value<T>> {
    let mass = body.mass();
    let corners = mesh.faces().iter().flat_map(|&[a, b, c, d]| {
        let second = [a, c, d];
        [Some([a, b, c]), (c != d).then_some(second)].into_iter().flatten()
    });
    let corners: Vec<T> = corners.flatten().map(|v| T::from(f64::from(v + 1))).collect();
    let row = |n: Vec<T>| Value::Numbers(Arc::new(moldloft_registry::Array::row(n)));
    let points = moldloft_registry::Vectors::row(mesh.positions().to_vec());
    vec![
        Value::Vectors(Arc::new(points)),
        row(corners),
        if body.flat { Value::Unset } else { Value::Number(mass.volume) },
        Value::Number(mass.area),
        Value::Vector(mass.centroid),
    ]
}

/// The arguments of `FaceSet`: the mesh, the face of each triangle, and the round faces.
fn face_arguments<T: Scalar>(body: &SketchSolid<T>, mesh: &Mesh<T>, key: Key) -> Vec<Value<T>> {
    let number = |n: usize| T::from((n + 1) as f64);
    let mut sides = Vec::new();
    for (n, patch) in mesh.patches().iter().enumerate() {
        for &[_, _, c, d] in &mesh.faces()[patch.faces.clone()] {
            sides.extend(std::iter::repeat_n(number(n), if c == d { 1 } else { 2 }));
        }
    }
    let round = |r: RoundFace<T>| {
        let [p, q, s] = r.profile;
        [p, q, s, r.shift, Vec3::new(r.sweep, r.scale, number(r.face))]
    };
    let rounds: Vec<Vec3<T>> = body.rounds().into_iter().flat_map(round).collect();
    let rounds = if rounds.is_empty() {
        Value::Unset
    } else {
        Value::Vectors(Arc::new(moldloft_registry::Vectors::row(rounds)))
    };
    let sides = Value::Numbers(Arc::new(moldloft_registry::Array::row(sides)));
    vec![Value::Object(key), sides, rounds]
}

/// Current declaration: the object and its names.
struct SketchDeclarations<'a, T: Scalar> {
    prefix: &'a str,
    site: Site,
    /// True if it is visible; a tool of another body is not.
    shown: bool,
    members: Vec<(String, Value<T>)>,
    points: BTreeMap<PointId, Key>,
}

/// Names that points, lines, faces and measures have.
fn is_taken(name: &str) -> bool {
    let numbered = ["p", "l", "face", "part", "body"].iter().any(|start| {
        let number = name.strip_prefix(start).unwrap_or("");
        !number.is_empty() && number.chars().all(|c| c.is_ascii_digit())
    });
    numbered || matches!(name, "solid" | "body" | "volume" | "area" | "centroid")
}

/// A traced curve as the kind that says it and its arguments.
fn curve_arguments<T: Scalar>(
    traced: &Traced<T>,
    ends: [Option<Key>; 2],
) -> (&'static str, Vec<Value<T>>) {
    let end = |k: usize, at: Vec3<T>| ends[k].map_or(Value::Vector(at), Value::Object);
    if let [SmoothPiece::Conic { centre, a, b, sweep }] = traced.pieces[..] {
        let args = vec![
            Value::Vector(centre),
            end(0, centre + a),
            Value::Vector(centre + b),
            Value::Number(sweep),
            ends[1].map_or(Value::Unset, Value::Object),
        ];
        return ("ConjugateArc", args);
    }
    let cubics: Vec<[Vec3<T>; 4]> = (traced.pieces.iter())
        .filter_map(|p| match p {
            SmoothPiece::Cubic(points) => Some(*points),
            SmoothPiece::Conic { .. } => None,
        })
        .collect();
    let mut points: Vec<Value<T>> = Vec::new();
    for (k, piece) in cubics.iter().enumerate() {
        let skip = usize::from(k > 0);
        points.extend(piece[skip..].iter().map(|&p| Value::Vector(p)));
    }
    if let (Some(first), Some(last)) = (cubics.first(), cubics.last()) {
        let n = points.len();
        points[0] = end(0, first[0]);
        points[n - 1] = end(1, last[3]);
    }
    ("CubicChain", vec![Value::list(points)])
}

/// Description of a layout's fault; `None` for redundant dimensions.
fn fault_text(fault: &DimensionFault) -> Option<String> {
    Some(match fault {
        DimensionFault::Redundant { .. } => return None,
        DimensionFault::Contradictory { name, asked, measured, .. } => {
            format!("{name} requires {asked}, but the others give {measured}")
        }
        DimensionFault::NoValue { name, reads } => {
            format!("{name} reads {reads}, which has no value")
        }
        DimensionFault::Cycle { names } => {
            format!("{} depend on each other in a circle", names.join(", "))
        }
        DimensionFault::NotFinite { name } => format!("{name} is not a finite number"),
        DimensionFault::OutOfRange { name, value, range: [low, high] } => {
            format!("{name} = {value} is outside its range, {low} to {high}")
        }
        DimensionFault::Unsolved { name, residual } => {
            format!("{name} cannot be satisfied; it is missed by {residual}")
        }
    })
}
