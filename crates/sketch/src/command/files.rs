//! Commands that read and write: SAVE, INPUT, RUN, EXPORT.

use super::CommandError;
use super::args::Args;
use super::session::{CommandReply, SketchSession};
use super::subject::ReplySubject;
use super::words::CommandTokenKind;
use crate::format::json::Json;
use crate::format::json_format::{ObjectData, from_json, object_data, to_json};
use crate::format::page_shapes::PageShapes;
pub(super) use crate::format::script::measure_text;
use crate::format::script::{script, scripts};
use crate::{
    CoordinateAxis, Dimension, DimensionRole, MeasuredQuantity, SketchObject, SketchSolid,
    Variable, export,
};
use moldloft_syntax::number::plain;
use std::sync::Arc;

impl SketchSession {
    /// All objects with their derived data.
    pub fn objects(&mut self) -> Vec<ObjectData> {
        let objects: Vec<Arc<SketchObject>> = self.state.objects.values().map(Arc::clone).collect();
        objects.iter().map(|o| self.data(o)).collect()
    }

    /// The objects as JSON: `{"objects": [...]}`.
    pub fn objects_json(&mut self) -> Json {
        Json::map([("objects", Json::list(self.objects().iter().map(ObjectData::to_json)))])
    }

    pub(super) fn data(&mut self, object: &Arc<SketchObject>) -> ObjectData {
        let worked = self.worked(object);
        object_data(object, &worked.view.planes, &worked.layout, worked.solid().cloned())
    }

    pub(super) fn save(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let mut names: Vec<String> = Vec::new();
        let mut file = None;
        while args.len() > 0 {
            if args.take_short("AS") {
                file = Some(args.name("the name of a file")?);
                break;
            }
            let fault = args.wants("names of objects, then AS and a file");
            let word = args.name("the name of an object or file").map_err(|_| fault)?;
            let known = self.object(&word).is_some();
            if known {
                names.push(word);
            } else if args.len() == 0 && (word.contains('.') || word.contains('/')) {
                file = Some(word);
            } else {
                self.known(&word)?;
            }
        }
        args.end()?;
        if names.is_empty() {
            names = self.state.objects.values().map(|o| o.name.clone()).collect();
        }
        if names.is_empty() {
            return Err(CommandError::new(
                110,
                "there is no object to save",
                "start one with SKETCH",
            ));
        }
        let file = file.unwrap_or_else(|| format!("{}.skt", names[0]));
        if file.trim().is_empty() || file.contains('\0') {
            return Err(CommandError::new(
                600,
                format!("cannot write \"{file}\": it is not a file name"),
                "SAVE object AS name.skt",
            ));
        }
        // A section on a face is written with the body.
        let mut k = 0;
        while let Some(object) = names.get(k).and_then(|n| self.object(n)) {
            k += 1;
            let body = object.on.as_ref().and_then(|on| self.object(&on.body));
            let body = body.map(|o| o.name.clone());
            names.extend(body.filter(|b| names.iter().all(|n| !n.eq_ignore_ascii_case(b))));
        }
        let objects: Vec<&SketchObject> = names.iter().filter_map(|n| self.object(n)).collect();
        let texts = scripts(&objects).into_iter();
        let text = if file.to_ascii_lowercase().ends_with(".json") {
            Json::list(texts.map(|(o, text)| to_json(o, &text))).to_string() + "\n"
        } else {
            texts.map(|(_, text)| text).collect()
        };
        self.write(&file, text.into_bytes());
        Ok(())
    }

    pub(super) fn input(&mut self, args: &mut Args, rename: bool) -> Result<(), CommandError> {
        let file = args.name("the name of a file")?;
        let into =
            if rename && args.take_short("INTO") { Some(args.name("a name")?) } else { None };
        args.end()?;
        let text = self.read(&file)?;
        let text = if text.trim_start().starts_with(['{', '[']) {
            from_json(&text).map_err(|why| {
                CommandError::new(
                    399,
                    format!("{file} is not a sketch: {why}"),
                    "SAVE writes files that can be read",
                )
            })?
        } else {
            text
        };
        let before: Vec<String> = self.state.objects.keys().cloned().collect();
        self.nested(&text)?;
        if let Some(new) = into {
            let added: Vec<String> =
                self.state.objects.keys().filter(|k| !before.contains(k)).cloned().collect();
            // Its operands keep their names.
            let objects: Vec<&SketchObject> =
                added.iter().filter_map(|key| self.object(key)).collect();
            let made: Vec<&String> = (added.iter().zip(crate::results(&objects)))
                .filter_map(|(key, result)| result.then_some(key))
                .collect();
            let [one] = made[..] else {
                return Err(CommandError::new(
                    110,
                    format!("{file} brought {} objects, so INTO cannot name them", made.len()),
                    "INPUT it without INTO, then RENAME",
                ));
            };
            let name = self.state.objects[one].name.clone();
            if !name.eq_ignore_ascii_case(&new) {
                self.nested(&format!("RENAME \"{name}\" TO \"{new}\""))?;
            }
        }
        Ok(())
    }

    /// `IMPORT file`: the lines of a DXF drawing become points and lines; other files are read as by
    /// INPUT.
    pub(super) fn import(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let file = args.name("the name of a file")?;
        args.end()?;
        let text = self.read(&file)?;
        let lower = file.to_ascii_lowercase();
        let kind = if lower.ends_with(".dxf") {
            "DXF"
        } else if lower.ends_with(".svg") {
            "SVG"
        } else {
            let words =
                [crate::command::words::CommandToken { kind: CommandTokenKind::Text, text: file }];
            return self.input(&mut Args::new(&words, ""), true);
        };
        let read = if kind == "DXF" {
            crate::format::dxf::dxf_shapes(&text)
        } else {
            crate::format::svg_shapes::svg_shapes(&text)
        };
        let mut shapes = read.map_err(|why| {
            let next = format!("EXPORT {kind} writes one");
            CommandError::new(399, format!("{file} is not a {kind} drawing: {why}"), next)
        })?;
        if shapes.line_count() == 0 {
            return Err(CommandError::new(
                102,
                format!("{file} has no lines, arcs or circles"),
                "draw LINE or polyline",
            ));
        }
        if self.active_object().is_none() {
            let stem = std::path::Path::new(&file).file_stem().map(|s| s.to_string_lossy());
            let name: String = stem.map_or("NONAME".into(), |s| s.chars().take(32).collect());
            // A flat drawing is a section; for a picture of a solid, SKETCH comes first.
            self.nested(&format!("SKETCH \"{}\" 2D XY", name.replace('"', "_")))?;
        }
        let before = self.active()?.clone();
        self.check_page(shapes.size(), shapes.line_count())?;
        self.begin_exact(&mut shapes)?;
        self.check_page(shapes.size(), shapes.line_count())?;
        let size = shapes.size();
        let (points, lines, curves) = shapes.draw(self.active_mut()?, 1e-6 * size);
        self.refer_to_page()?;
        let mut said = format!("{points} points and {lines} lines");
        if !curves.is_empty() {
            let radii: Vec<&str> = (self.active()?.variables.values())
                .filter(|v| !before.has_name(&v.name))
                .map(|v| v.name.as_str())
                .collect();
            said.push_str(&format!(", curves {}", curves.join(", ")));
            if !radii.is_empty() {
                said.push_str(&format!("; the radii {} are as drawn", radii.join(", ")));
            }
        }
        self.out.push(CommandReply::note(said));
        if !shapes.left_out.is_empty() {
            let all = shapes.left_out.iter().map(|(kind, n)| format!("{n} {kind}"));
            let all: Vec<String> = all.collect();
            self.out.push(CommandReply::warning(format!("not drawn: {}", all.join(", "))));
        }
        self.recorded = Some(drawn_since(&before, self.active()?));
        Ok(())
    }

    /// An empty section takes a drawing exactly: positions are coordinates, lines are split where
    /// they cross.
    fn begin_exact(&mut self, shapes: &mut PageShapes) -> Result<(), CommandError> {
        let object = self.active()?;
        let drawing = &object.drawing;
        let flat =
            drawing.section.is_some_and(|s| drawing.projection == crate::Projection::section(s));
        if !flat || (!drawing.points.is_empty() && !drawing.exact) {
            return Ok(());
        }
        let (first, unit) = (drawing.points.is_empty(), object.units.is_none());
        if first {
            self.set_exact(true)?;
        }
        if let Some(word) = shapes.unit.filter(|_| unit) {
            self.active_mut()?.units = Some(word.to_owned());
        }
        let tolerance = 1e-9 * shapes.size();
        shapes.split(tolerance);
        if let Some(at) = shapes.separate(tolerance).first() {
            let about = ReplySubject::of("curves-touch");
            let at = at.map(plain).join(" ");
            let text = format!("two curves of the drawing touch without crossing at {at}");
            let next = "move one of them, or join them there in the drawing";
            self.out.push(CommandReply {
                about,
                next: Some(next.into()),
                ..CommandReply::warning(text)
            });
        }
        Ok(())
    }

    /// The reference of an exact drawing: where its first point is drawn.
    fn refer_to_page(&mut self) -> Result<(), CommandError> {
        let object = self.active()?;
        let (drawing, none) = (&object.drawing, object.reference.is_none());
        let Some((&point, _)) = drawing.points.first_key_value().filter(|_| drawing.exact && none)
        else {
            return Ok(());
        };
        let at = CoordinateAxis::ALL.map(|a| drawing.drawn_coordinate(a, point).unwrap_or(0.0));
        self.active_mut()?.reference = Some(crate::Reference::number(point, at));
        Ok(())
    }

    /// `STROKES u v u v …`: lines by their ends, as a host's canvas has them.
    pub(super) fn strokes(&mut self, args: &mut Args) -> Result<(), CommandError> {
        if args.take("SAMPLES") {
            return self.pen_stroke(args);
        }
        let mut strokes = Vec::new();
        while args.at_number() {
            let mut end = || -> Result<[f64; 2], CommandError> {
                Ok([args.number("the coordinate u of an end")?, args.number("its coordinate v")?])
            };
            strokes.push([end()?, end()?]);
        }
        args.end()?;
        if strokes.is_empty() {
            return Err(args.wants("four numbers for each line"));
        }
        self.draw_strokes(&strokes)
    }

    /// Refuses too many lines, and lines too far away.
    pub(super) fn check_page(&self, size: f64, lines: usize) -> Result<(), CommandError> {
        let points = self.active()?.drawing.points.len() + 2 * lines;
        if size > 1e9 || points > super::session::MAX_POINTS {
            return Err(CommandError::new(
                200,
                format!("{lines} lines on this page are too many, or it ends beyond 1e9"),
                "draw a part of them",
            ));
        }
        Ok(())
    }

    fn draw_strokes(
        &mut self,
        strokes: &[crate::format::page_shapes::Stroke],
    ) -> Result<(), CommandError> {
        let ends = strokes.iter().flatten();
        let size = ends.fold(0.0, |s: f64, [u, v]| s.max(u.abs()).max(v.abs()));
        self.check_page(size, strokes.len())?;
        let drawing = self.active_mut()?.draw();
        let (points, lines) = crate::format::page_shapes::draw(drawing, strokes, 1e-6 * size);
        self.out.push(CommandReply::note(format!("{points} points and {lines} lines")));
        Ok(())
    }

    /// `GIVE name measure = value [ONLY]`: a dimension exactly as it is, for files; `GIVE REFERENCE p = x y z`: the
    /// reference point.
    pub(super) fn give(&mut self, args: &mut Args) -> Result<(), CommandError> {
        if args.tokens_at(0, "REFERENCE") && args.number_at(1) {
            args.skip();
            self.active_mut()?.reference = Some(self.reference_at(args)?);
            return Ok(());
        }
        let name = self.new_name(args)?;
        let object = self.active()?.clone();
        let line = |args: &mut Args| -> Result<crate::LineId, CommandError> {
            let id = args.line()?;
            super::draw::require_line(&object, id).map(|_| id)
        };
        let point = |args: &mut Args| -> Result<crate::PointId, CommandError> {
            let p = args.point()?;
            super::draw::require_point(&object, p).map(|()| p)
        };
        let measure = if let Some(axis) = args.axis() {
            let p = point(args)?;
            args.take_short("TO");
            MeasuredQuantity::Along { axis, p, q: point(args)? }
        } else if args.take("POINT") {
            let p = point(args)?;
            let axis = args.axis().ok_or_else(|| args.wants("an axis"))?;
            MeasuredQuantity::Datum { axis, point: p }
        } else if args.take("LENGTH") {
            MeasuredQuantity::Length(line(args)?)
        } else if args.take("SLOPE") {
            MeasuredQuantity::Slope(line(args)?)
        } else if args.take("ANGLE") {
            MeasuredQuantity::Angle(line(args)?, line(args)?)
        } else if args.take("EQUAL") {
            MeasuredQuantity::Equal(line(args)?, line(args)?)
        } else {
            return Err(args.wants("an axis, POINT, LENGTH, SLOPE, ANGLE or EQUAL"));
        };
        let value = if args.take_short("UNSET") {
            None
        } else {
            Some(args.value(object.units.as_deref())?)
        };
        let role =
            if args.take_short("ONLY") { DimensionRole::Reference } else { DimensionRole::Driving };
        let range = args.range()?;
        args.end()?;
        self.active_mut()?.add_dimension(Dimension { name, measure, value, role, range });
        Ok(())
    }

    /// `DECLARE name value`: a variable whose value may read names that come later, for files.
    pub(super) fn declare(&mut self, args: &mut Args) -> Result<(), CommandError> {
        // The numbers of a feature are those of its parts until they are given.
        let known = args.peek().and_then(|t| {
            let object = self.active_object().filter(|o| o.feature.is_some())?;
            object.variables.get(&t.text.to_ascii_lowercase()).map(|v| v.name.clone())
        });
        let name = match known {
            Some(name) => {
                args.skip();
                name
            }
            None => self.new_name(args)?,
        };
        let units = self.active()?.units.clone();
        let value = args.value(units.as_deref())?;
        let range = args.range()?;
        args.end()?;
        let key = name.to_ascii_lowercase();
        self.active_mut()?.variables.insert(key, Variable { name, value, range });
        Ok(())
    }

    pub(super) fn export(&mut self, args: &mut Args) -> Result<(), CommandError> {
        const FORMATS: [&str; 10] =
            ["STL", "OBJ", "GLTF", "GLB", "3MF", "DXF", "SVG", "JSON", "SKETCH83", "STEP"];
        let mut format = args.name("a format")?.to_ascii_uppercase();
        if format == "STP" {
            format = "STEP".to_owned();
        }
        if !FORMATS.contains(&format.as_str()) {
            return Err(CommandError::new(
                600,
                format!("there is no format {format} here"),
                format!("formats are {}", FORMATS.join(", ")),
            ));
        }
        let named = args.peek().is_some_and(|t| {
            self.object(&t.text).is_some() && !matches!(t.kind, CommandTokenKind::Number(..))
        });
        if named {
            self.take_object(args)?;
        }
        let file = if args.len() > 0 { Some(args.name("the name of a file")?) } else { None };
        args.end()?;
        let object = self.active_arc()?;
        let extension = format.to_ascii_lowercase();
        let file = file.unwrap_or_else(|| format!("{}.{extension}", object.name));
        // The extension of a file determines its format.
        let suffix = file.rsplit_once('.').map(|s| s.1.to_ascii_uppercase()).unwrap_or_default();
        let suffix = if suffix == "STP" { "STEP".to_owned() } else { suffix };
        match (format.as_str(), suffix.as_str()) {
            ("GLTF", "GLB") => format = suffix,
            (_, other) if other != format && FORMATS.contains(&other) => {
                return Err(CommandError::new(
                    600,
                    format!("{file} would not be {other}: {format} was asked for"),
                    format!("EXPORT {other}, or another name"),
                ));
            }
            _ => {}
        }
        let unit = object.units.as_deref().unwrap_or("MM");
        let metres =
            super::words::UNITS.iter().find(|u| u.0 == unit).map_or(1e-3, |u| u.1 / 10_000.0);
        if object.units.is_none() && matches!(format.as_str(), "STEP" | "3MF" | "GLTF" | "GLB") {
            let mut reply = CommandReply::warning(format!(
                "{file} is in millimetres: {} has no unit",
                object.name
            ));
            reply.next = Some("SET UNITS states one".to_owned());
            self.out.push(reply);
        }
        let data = self.data(&object);
        let bytes = match format.as_str() {
            "JSON" => (data.to_json().to_string() + "\n").into_bytes(),
            "SKETCH83" => {
                if object.name.chars().count() > 6 {
                    self.out.push(CommandReply::warning(format!(
                        "the name {} is cut to 6 characters",
                        object.name
                    )));
                }
                let mut short = SketchObject::clone(&object);
                short.name = object.name.chars().take(6).collect();
                script(&short).into_bytes()
            }
            "SVG" => {
                let shown: Vec<Arc<SketchObject>> =
                    self.state.objects.values().filter(|o| o.display).map(Arc::clone).collect();
                if shown.is_empty() {
                    return Err(CommandError::new(
                        112,
                        "nothing is displayed",
                        "DISPLAY shows objects",
                    ));
                }
                let all: Vec<ObjectData> = shown.iter().map(|o| self.data(o)).collect();
                let pairs: Vec<(&SketchObject, &ObjectData)> =
                    shown.iter().map(|o| &**o).zip(&all).collect();
                crate::format::svg::svg(&pairs, &self.state.picture, self.page()).into_bytes()
            }
            _ => {
                let worked = self.worked(&object);
                let solid = worked.body().map_err(|why| super::no_body::no_body(&object, why))?;
                let size = solid.vertices.iter().map(|v| v.at.norm()).fold(0.0, f64::max);
                let mesh = export::IndexedTriangles::of(&solid.mesh(1e-3 * size));
                match format.as_str() {
                    "STEP" => self.step_bytes(&object, solid, metres)?,
                    "STL" => export::stl(&mesh, &object.name).into_bytes(),
                    "OBJ" => export::obj(&mesh, &object.name).into_bytes(),
                    "GLTF" => export::gltf(&mesh, &object.name, metres).into_bytes(),
                    "GLB" => export::glb(&mesh, &object.name, metres),
                    "3MF" => export::three_mf(&mesh, object.units.as_deref()),
                    _ => export::dxf(&mesh, solid, 1e-3 * size).into_bytes(),
                }
            }
        };
        self.write(&file, bytes);
        Ok(())
    }

    /// The body as a STEP file of exact surfaces.
    fn step_bytes(
        &self,
        object: &SketchObject,
        solid: &SketchSolid<f64>,
        metres: f64,
    ) -> Result<Vec<u8>, CommandError> {
        let refused = |why: String| {
            let next = "EXPORT STL, OBJ, 3MF or GLTF for meshes, DXF for edges and facets";
            CommandError::new(600, format!("{} is not written as STEP: {why}", object.name), next)
        };
        if solid.flat {
            return Err(refused("it is a cross section".to_owned()));
        }
        let size = solid.vertices.iter().map(|v| v.at.norm()).fold(0.0, f64::max);
        let made = solid.brep(&object.name, None, &[], 1e-7 * size);
        let mut brep = made.map_err(|fault| refused(fault.to_string()))?;
        let shells = brep.shells();
        let cavity = |s: &moldloft_brep::Shell| {
            let known = s.faces.first().and_then(|&f| brep.faces[f].extent);
            known.is_some_and(|(_, cavity)| cavity)
        };
        let (inner, outer): (Vec<_>, Vec<_>) = shells.into_iter().partition(cavity);
        if !inner.is_empty() && outer.len() != 1 {
            return Err(refused("it has a cavity in one of several bodies".to_owned()));
        }
        let name = |k: usize| match k {
            0 => object.name.clone(),
            k => format!("{} {}", object.name, k + 1),
        };
        let part = |(k, shell)| moldloft_brep::Part {
            name: name(k),
            shells: vec![shell],
            ..moldloft_brep::Part::default()
        };
        brep.parts = outer.into_iter().enumerate().map(part).collect();
        for shell in inner {
            brep.parts[0].shells.push(moldloft_brep::Shell { cavity: true, ..shell });
        }
        self.files.step(&brep, &object.name, metres).map_err(refused)
    }
}

/// Commands for the additions to an object: points, lines, variables, curves.
pub(super) fn drawn_since(before: &SketchObject, now: &SketchObject) -> String {
    let mut out = Vec::new();
    let (a, b) = (&before.drawing, &now.drawing);
    if b.exact != a.exact {
        out.push("SET EXACT ON".to_owned());
    }
    if let Some(unit) = now.units.as_ref().filter(|_| before.units.is_none()) {
        out.push(format!("SET UNITS {unit}"));
    }
    for (id, p) in b.points.iter().filter(|(id, _)| !a.points.contains_key(id)) {
        out.push(format!("POINT {id} AT {} {}", plain(p.u), plain(p.v)));
    }
    for (id, l) in b.lines.iter().filter(|(id, _)| !a.lines.contains_key(id)) {
        out.push(format!("LINE {id} FROM {} TO {}", l.p, l.q));
    }
    if now.reference != before.reference {
        out.extend(now.reference.as_ref().map(crate::format::script::reference_text));
    }
    for v in now.variables.values().filter(|v| !before.has_name(&v.name)) {
        out.push(format!("VARIABLE {} {}", v.name, v.value.text()));
    }
    let curves = now.curves.values().filter(|c| !before.has_name(&c.name));
    out.extend(curves.map(crate::format::script::curve_text));
    out.join("; ")
}
