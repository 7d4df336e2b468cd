//! The session: processes requests in order, each with a reply.

use crate::drag::{Drag, HandleKind};
use crate::facts::{self, json_of};
use crate::fields::field;
use crate::frame::{ReplyFrame, ViewerCache};
use crate::overlay::Overlays;
use crate::replies::{AdjustmentFact, EditFact, HandleFact};
use crate::request::{Adjusted, Ask, Request};
use crate::scene::Scene;
use crate::text::{byte, changed, difference, unit};
use crate::volume::{self, GridPlane};
use moldloft_budget::Budget;
use moldloft_diag::Diagnostic;
use moldloft_document::{
    Adjustable, CompletionKind, Document, OpenFiles, OpenTexts, ReadAs, WantedNumber, World,
    registry,
};
use moldloft_export::{FORMATS, WriteOptions, format_named, length_unit, write};
use moldloft_mesh::{closure, qualities};
use moldloft_num::{Order, Vec3};
use moldloft_registry::Value as Quantity;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Maximum number of viewers; beyond it the oldest is dropped.
const MOST_TABS: usize = 64;

/// Maximum number of sections of a curve of areas, and its accuracy: that of the hydrostatics,
/// whose body is cached.
const MOST_SECTIONS: usize = 401;
const AREA_ACCURACY: f64 = 1e-6;

/// Number of points of a curvature comb.
const COMB_POINTS: usize = 129;

/// An interactive session with a document.
pub struct Session {
    document: Document,
    /// Texts of files beside the document that count before they are saved.
    texts: Arc<OpenTexts>,
    /// The text as in the page.
    text: String,
    /// Version of the text, counted by the page.
    version: u64,
    /// Increases with every change.
    rev: u64,
    /// Parameters whose values cannot be written into the text.
    kept: Vec<String>,
    scene: Scene,
    /// The revision that the scene shows.
    drawn: Option<u64>,
    tabs: HashMap<u64, Tab>,
    drag: Option<Drag>,
    overlays: Overlays,
}

/// A viewer.
#[derive(Default)]
struct Tab {
    known: ViewerCache,
    watched: Vec<String>,
}

/// Reason why a request is not answered.
enum Refusal {
    Words(String),
    Diagnostics(Vec<Diagnostic>),
}

impl From<String> for Refusal {
    fn from(words: String) -> Self {
        Self::Words(words)
    }
}

impl From<Vec<Diagnostic>> for Refusal {
    fn from(diagnostics: Vec<Diagnostic>) -> Self {
        Self::Diagnostics(diagnostics)
    }
}

impl From<Diagnostic> for Refusal {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Diagnostics(vec![diagnostic])
    }
}

type Answer = Result<(), Refusal>;

impl Session {
    /// A session on a text; `name` as for [`Document::from_text`].
    pub fn new(world: Box<dyn World>, name: &str, text: &str) -> Self {
        Self::within(world, name, text, Arc::default())
    }

    /// As [`Self::new`], with a budget that limits and can cancel its work.
    pub fn within(world: Box<dyn World>, name: &str, text: &str, budget: Arc<Budget>) -> Self {
        let texts = Arc::<OpenTexts>::default();
        let world = Box::new(OpenFiles::new(world, texts.clone()));
        let document = Document::edited(registry(), world, (name, text), budget);
        Self {
            document,
            texts,
            text: text.into(),
            version: 0,
            rev: 1,
            kept: Vec::new(),
            scene: Scene::default(),
            drawn: None,
            tabs: HashMap::new(),
            drag: None,
            overlays: Overlays::default(),
        }
    }

    /// The text as in the page.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The files that the text and those files read.
    pub fn files(&self) -> Vec<ReadAs> {
        self.texts.files()
    }

    /// The document.
    pub fn document(&mut self) -> &mut Document {
        &mut self.document
    }

    /// The reply to a request.
    pub fn answer(&mut self, request: &str) -> Vec<u8> {
        let mut frame = ReplyFrame::default();
        let request: Request = match serde_json::from_str(request) {
            Ok(request) => request,
            Err(error) => {
                // The sender recognises the reply by its id.
                let id = serde_json::from_str(request).map(|given: Value| given["id"].clone());
                frame.put("id", id.unwrap_or_default());
                frame.put("error", format!("not a request: {error}"));
                return frame.encoded();
            }
        };
        let id = request.id;
        let run = AssertUnwindSafe(|| {
            let mut frame = ReplyFrame::default();
            self.reply(request, &mut frame);
            frame
        });
        let mut frame = catch_unwind(run).unwrap_or_else(|_| {
            let mut frame = ReplyFrame::default();
            frame.put("error", "this request made the engine fail: please report it");
            frame.put("internal", true);
            // The recorded state of viewers may be incomplete.
            self.tabs.clear();
            self.drawn = None;
            frame
        });
        frame.put("id", id);
        frame.put("rev", self.rev);
        frame.put("version", self.version);
        frame.encoded()
    }

    fn reply(&mut self, request: Request, frame: &mut ReplyFrame) {
        let (tab, changes) = (request.tab, request.ask.changes());
        if let Ask::Close = request.ask {
            self.tabs.remove(&tab);
            return;
        }
        if let Ask::Open = request.ask {
            self.tabs.remove(&tab);
        }
        if matches!(request.ask, Ask::Text { .. } | Ask::Splice { .. })
            && let Some(version) = request.version
        {
            self.version = version;
        }
        let previewed = request.coarser > 0;
        let settles = matches!(request.ask, Ask::Settle);
        if (previewed || request.ask.settles()) && self.document.preview(request.coarser) {
            self.rev += 1;
        }
        match self.carry_out(request.ask, tab, frame) {
            Ok(()) => {}
            Err(Refusal::Words(words)) => frame.put("error", words),
            Err(Refusal::Diagnostics(all)) => {
                let said = all.first().map_or("refused".to_string(), |d| d.message.clone());
                frame.put("error", said);
                let faults = facts::diagnostics(&self.document, &self.text, &all);
                frame.put("faults", json_of(faults));
            }
        }
        // Bodies that a cancelled run has not reached stay in the picture.
        if changes && !(settles && self.document.is_cut_short()) {
            self.sync(tab, frame);
        }
    }

    /// Adds changes since the last reply to the viewer.
    fn sync(&mut self, tab: u64, frame: &mut ReplyFrame) {
        if self.drawn != Some(self.rev) {
            self.scene.update(&mut self.document);
            self.drawn = Some(self.rev);
        }
        if !self.tabs.contains_key(&tab)
            && self.tabs.len() >= MOST_TABS
            && let Some(&oldest) = self.tabs.keys().min()
        {
            self.tabs.remove(&oldest);
        }
        if !self.tabs.contains_key(&tab) {
            // The viewer discards items of an earlier engine.
            frame.put("all", true);
        }
        let document = &self.document;
        let known = &mut self.tabs.entry(tab).or_default().known;
        known.scene(frame, self.scene.items());
        known.fact(frame, "params", json_of(facts::params(document, &self.text)));
        let stamp = facts::objects_stamp(document);
        known.stamped(frame, "objects", stamp, || json_of(facts::objects(document)));
        let mut diagnostics = document.diagnostics();
        // A diagnostic of the run with the same id is more precise.
        let fault = self.scene.fault().filter(|f| diagnostics.iter().all(|d| d.id != f.id));
        diagnostics.extend(fault.cloned());
        let faults = facts::diagnostics(document, &self.text, &diagnostics);
        known.fact(frame, "diagnostics", json_of(faults));
        known.fact(frame, "reads", facts::files(&self.texts.files()));
        known.fact(frame, "printed", document.printed().iter().take(1000).cloned().collect());
        known.fact(frame, "mirror", document.symmetry().into());
        known.fact(frame, "unit", length_unit(document).0.into());
        known.fact(frame, "program", document.is_program().into());
    }

    fn carry_out(&mut self, ask: Ask, tab: u64, frame: &mut ReplyFrame) -> Answer {
        match ask {
            Ask::Open | Ask::Sync | Ask::Settle | Ask::Close | Ask::Ping => {}
            Ask::Text { text } => self.take_text(text),
            Ask::TextBeside { name, text } => {
                // Its numbers count again, in place of values that were set.
                let states = |param: &String| {
                    facts::beside(&self.document, param).is_some_and(|found| found.file == name)
                };
                self.kept.retain(|param| !states(param));
                self.texts.put(&name, text.as_deref());
                self.take_text(self.text.clone());
            }
            Ask::Reads => frame.put("reads", facts::files(&self.texts.files())),
            Ask::Splice { changes } => {
                let start = self.text.clone();
                self.take_text(changes.iter().try_fold(start, |text, c| changed(&text, c))?);
            }
            Ask::Set { values } => self.set(values)?,
            Ask::Commit => self.commit(frame),
            Ask::Reset => {
                self.kept.clear();
                self.take_text(self.text.clone());
            }
            Ask::Write { values } => {
                self.set(values)?;
                self.commit(frame);
            }
            Ask::DragBegin { object, at } => self.drag_begin(&object, &at, frame)?,
            Ask::DragTo { target, basis, names, grain } => {
                let basis: Vec<Vec3> = basis.into_iter().map(Vec3::from).collect();
                self.drag_to(target.into(), &basis, &names, grain, frame)?;
            }
            Ask::SolveFor { targets, by } => self.solve_for(targets, by, frame)?,
            Ask::DragEnd { commit } => self.drag_end(commit, frame)?,
            Ask::Inspect { name, by } => self.inspect(&name, by.as_deref(), frame)?,
            Ask::Watch { expressions } => {
                self.tabs.entry(tab).or_default().watched = expressions;
                self.measure(tab, frame);
            }
            Ask::Measure => self.measure(tab, frame),
            Ask::Evaluate { expressions, by } => {
                let values = facts::values(&mut self.document, &expressions, by.as_deref());
                frame.put("values", json_of(values));
            }
            Ask::Show { contours, revealed } => {
                self.scene.contours = contours.unwrap_or(self.scene.contours);
                if let Some(revealed) = revealed {
                    self.scene.revealed = revealed.into_iter().collect();
                }
                self.drawn = None;
            }
            Ask::Field { field, by } => self.put_field(&field, by.as_deref(), frame)?,
            Ask::Combs { names } => self.combs(&names, frame),
            Ask::Blocks { block, axis, index } => {
                let plane = block.map(|block| GridPlane { block, axis, index });
                volume::put(&mut self.document, plane.as_ref(), frame)?;
            }
            Ask::Overlay { name, data } => {
                self.overlays.add(&name, &data)?;
                self.overlays.put(&mut self.document, frame, true);
            }
            Ask::RemoveOverlay { name } => {
                self.overlays.remove(name.as_deref());
                self.overlays.put(&mut self.document, frame, true);
            }
            Ask::Deviation => self.overlays.put(&mut self.document, frame, false),
            Ask::SectionAreas { count } => self.section_areas(count, frame)?,
            Ask::LinesPlan { title } => self.lines_plan(&title, frame)?,
            Ask::Mesh => self.mesh(frame)?,
            Ask::Hydrostatics => self.hydrostatics(frame)?,
            Ask::Export { format, stem } => self.export(&format, &stem, frame)?,
            Ask::Formats => {
                let one = |f: &moldloft_export::Format| json!([f.name, f.about]);
                frame.put("formats", FORMATS.iter().map(one).collect::<Vec<_>>());
            }
            Ask::Complete { offset } => self.complete(offset, frame),
            Ask::Hover { offset } => {
                if let Some((said, span)) = self.document.hover(byte(&self.text, offset) as u32) {
                    frame.put("markdown", said);
                    self.put_place(span, frame);
                }
            }
            Ask::Definition { offset } => {
                if let Some(span) = self.document.definition(byte(&self.text, offset) as u32) {
                    self.put_place(span, frame);
                }
            }
            Ask::Locate { name } => {
                if let Some(span) = self.document.declaration(&name) {
                    self.put_place(span, frame);
                }
            }
            Ask::Rename { offset, new } => self.rename(offset, &new, frame)?,
            Ask::Kinds => frame.put("kinds", json_of(facts::kinds(self.document.registry()))),
            Ask::Add { statement } => self.rewrite(|d| d.add(&statement), frame)?,
            Ask::Delete { name } => self.rewrite(|d| d.delete(&name).map(drop), frame)?,
            Ask::Duplicate { name } => {
                let new = self.rewrite(|d| d.duplicate(&name), frame)?;
                frame.put("name", new);
            }
            Ask::Reorder { name, beside, behind } => {
                self.rewrite(|d| d.reorder(&name, &beside, behind), frame)?;
            }
            Ask::RenameObject { name, new } => {
                self.rewrite(|d| d.rename(&name, &new).map(drop), frame)?;
            }
            Ask::Format => self.format(frame)?,
            Ask::Words => self.words(frame),
        }
        Ok(())
    }

    fn drag_to(
        &mut self,
        target: Vec3,
        basis: &[Vec3],
        names: &[String],
        grain: f64,
        frame: &mut ReplyFrame,
    ) -> Answer {
        let mut drag = self.drag.take().ok_or("nothing is dragged".to_string())?;
        let reached = drag.to(&mut self.document, target, basis, names, grain);
        self.drag = Some(drag);
        self.rev += 1;
        let reached = reached?;
        frame.put("reached", reached.place.to_array().to_vec());
        frame.put("left", facts::number(reached.left));
        let values = reached.values.into_iter().map(|(n, x)| (n, facts::number(x)));
        frame.put("values", Value::Object(values.collect()));
        frame.put("ended", reached.ended);
        Ok(())
    }

    fn drag_end(&mut self, commit: bool, frame: &mut ReplyFrame) -> Answer {
        let Some(drag) = self.drag.take() else { return Ok(()) };
        let changed = drag.changed(&self.document);
        // Unchanged numbers keep their spelling.
        self.take_text(self.text.clone());
        if commit && !changed.is_empty() {
            self.set(changed.into_iter().collect())?;
        }
        self.commit(frame);
        Ok(())
    }

    fn inspect(&mut self, name: &str, by: Option<&str>, frame: &mut ReplyFrame) -> Answer {
        let found = facts::inspected(&mut self.document, &self.text, name, by);
        frame.put("object", found.ok_or(format!("there is no object `{name}`"))?);
        Ok(())
    }

    fn put_field(&mut self, name: &str, by: Option<&str>, frame: &mut ReplyFrame) -> Answer {
        let found = field(&mut self.document, self.scene.items(), name, by)?;
        let mut parts = Vec::new();
        for patch in found {
            let mut part = frame.floats("value", &patch.values);
            part["key"] = json!([patch.item.kind as u8, &*patch.item.name]);
            part["components"] = patch.components.into();
            parts.push(part);
        }
        frame.put("field", parts);
        Ok(())
    }

    fn hydrostatics(&mut self, frame: &mut ReplyFrame) -> Answer {
        let options = self.document.hydrostatic_options();
        let figures = self.document.hydrostatics(&options)?.figures();
        let rows = figures.into_iter().map(|(name, x)| json!([name, facts::number(x)]));
        frame.put("figures", rows.collect::<Vec<_>>());
        Ok(())
    }

    fn lines_plan(&mut self, title: &str, frame: &mut ReplyFrame) -> Answer {
        let sheet = moldloft_export::lines_sheet(&mut self.document, title)?;
        let part = frame.bytes("file", &sheet);
        frame.put("sheet", part);
        Ok(())
    }

    fn complete(&mut self, offset: usize, frame: &mut ReplyFrame) {
        let found = self.document.completions(byte(&self.text, offset) as u32);
        let one = |c: moldloft_document::Completion| json!([c.word, word(c.kind), c.detail]);
        frame.put("completions", found.into_iter().map(one).collect::<Vec<_>>());
    }

    fn put_place(&self, span: moldloft_diag::Span, frame: &mut ReplyFrame) {
        frame.put("place", json_of(facts::place(&self.document, &self.text, span)));
        if let Some((file, place)) = facts::elsewhere(&self.document, span) {
            frame.put("elsewhere", json!({"file": file, "place": place}));
        }
    }

    /// The edits that give the name at an offset another spelling everywhere.
    fn rename(&mut self, offset: usize, new: &str, frame: &mut ReplyFrame) -> Answer {
        let spans = self.document.renamed(byte(&self.text, offset) as u32, new)?;
        let edit = |s: moldloft_diag::Span| {
            let at = |b: u32| unit(&self.text, b as usize);
            EditFact { from: at(s.start), to: at(s.end), insert: new.to_string() }
        };
        frame.put("edits", json_of(spans.into_iter().map(edit).collect::<Vec<_>>()));
        Ok(())
    }

    fn format(&mut self, frame: &mut ReplyFrame) -> Answer {
        let formatted = moldloft_syntax::sdl::format(&self.text)
            .map_err(|_| "the text has errors and is unchanged".to_string())?;
        self.put_edits(frame, &formatted);
        Ok(())
    }

    /// The words of the language by their sort.
    fn words(&mut self, frame: &mut ReplyFrame) {
        let mut words: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for c in self.document.completions_of("") {
            if !matches!(c.kind, CompletionKind::Variable | CompletionKind::Object) {
                words.entry(word(c.kind)).or_default().push(c.word);
            }
        }
        frame.put("words", json!(words));
    }

    /// The watched numbers. The page requests them after the scene, which never waits for
    /// hydrostatics.
    fn measure(&mut self, tab: u64, frame: &mut ReplyFrame) {
        let expressions = self.tabs.entry(tab).or_default().watched.clone();
        frame.put("watched", json_of(facts::values(&mut self.document, &expressions, None)));
    }

    fn take_text(&mut self, text: String) {
        self.drag = None;
        self.document.forget_params(&self.kept);
        self.texts.forget();
        self.text = text;
        self.document.set_text(&self.text);
        self.rev += 1;
    }

    fn set(&mut self, values: BTreeMap<String, f64>) -> Answer {
        let values: Vec<(String, f64)> = values.into_iter().collect();
        // A number typed during a drag is part of the drag.
        if let Some(drag) = &mut self.drag {
            for (name, _) in &values {
                drag.keep(&self.document, name)?;
            }
        }
        self.document.set(&values)?;
        self.rev += 1;
        Ok(())
    }

    /// Turns set values into edits of the text, which the page applies and returns.
    fn commit(&mut self, frame: &mut ReplyFrame) {
        let (_, kept) = self.document.write_params();
        self.kept = kept;
        let text = self.document.text();
        self.put_edits(frame, &text);
        frame.put("kept", self.kept.clone());
        let beside = self.kept.iter().filter_map(|name| facts::beside(&self.document, name));
        frame.put("beside", json_of(beside.collect::<Vec<_>>()));
    }

    /// A change of the text by the document, whose edits the page applies and returns.
    fn rewrite<A>(
        &mut self,
        change: impl FnOnce(&mut Document) -> Result<A, Diagnostic>,
        frame: &mut ReplyFrame,
    ) -> Result<A, Refusal> {
        self.rev += 1;
        let made = change(&mut self.document)?;
        let text = self.document.text();
        self.put_edits(frame, &text);
        Ok(made)
    }

    fn put_edits(&self, frame: &mut ReplyFrame, new: &str) {
        let edit = difference(&self.text, new);
        let edits = edit.map(|(from, to, insert)| EditFact { from, to, insert });
        frame.put("edits", json_of(edits.into_iter().collect::<Vec<_>>()));
    }

    fn drag_begin(&mut self, object: &str, at: &[f64], frame: &mut ReplyFrame) -> Answer {
        let drag = Drag::begin(&mut self.document, object, at)?;
        let rows = drag.handles.iter().map(|h| HandleFact {
            name: h.name.clone(),
            own: h.kind == HandleKind::Own,
            parameter: h.kind == HandleKind::Parameter,
            direction: h.direction.to_array(),
            value: h.value,
            range: h.range.map(|(a, b)| [a, b]),
        });
        frame.put("handles", json_of(rows.collect::<Vec<_>>()));
        let own = drag.handles.iter().filter(|h| h.kind == HandleKind::Own);
        frame.put("own", own.map(|h| h.name.clone()).collect::<Vec<_>>());
        self.drag = Some(drag);
        Ok(())
    }

    /// Adjusts numbers of the model to target values, until these are committed or reset.
    fn solve_for(
        &mut self,
        targets: BTreeMap<String, f64>,
        by: BTreeMap<String, Adjusted>,
        frame: &mut ReplyFrame,
    ) -> Answer {
        let one = |(expression, value)| WantedNumber { expression, value };
        let targets: Vec<WantedNumber> = targets.into_iter().map(one).collect();
        let one =
            |(name, a): (String, Adjusted)| Adjustable { name, weight: a.weight, home: a.home };
        let by: Vec<Adjustable> = by.into_iter().map(one).collect();
        self.rev += 1;
        let found = self.document.solve_for(&targets, &by).map_err(|faults| {
            // The reachable range is the useful answer for an interactive user.
            let one = |d: &Diagnostic| {
                let data = d.to_data(self.document.sources());
                let far = data.expected.map(|e| format!(": {e}")).unwrap_or_default();
                let found = data.found.map(|f| format!(", found {f}")).unwrap_or_default();
                format!("{}{far}{found}", d.message)
            };
            Refusal::Words(faults.iter().map(one).collect::<Vec<_>>().join("; "))
        })?;
        let values = found.adjustments.iter().map(|a| AdjustmentFact {
            name: a.name.clone(),
            before: a.before,
            after: a.after,
            share: a.share,
        });
        frame.put("adjustments", json_of(values.collect::<Vec<_>>()));
        let reached = targets.iter().zip(&found.reached);
        frame.put("reached", reached.map(|(t, x)| json!([t.expression, x])).collect::<Vec<_>>());
        frame.put("steps", found.steps);
        Ok(())
    }

    fn combs(&mut self, names: &[String], frame: &mut ReplyFrame) {
        let graph = self.document.graph();
        let mut combs = Vec::new();
        for name in names {
            let object = graph.find(name).and_then(|key| graph.get(key));
            let Some(Quantity::Curve(curve)) = object.and_then(|o| o.value()) else { continue };
            let (mut places, mut bends, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
            let (mut length, mut lengths, mut last) = (0.0, Vec::new(), None::<Vec3>);
            for k in 0..COMB_POINTS {
                let t = k as f64 / (COMB_POINTS - 1) as f64;
                let [p, d, dd] = curve.jet(t, Order::Second);
                let speed = d.norm();
                // The component of x'' normal to the tangent, over the square of the speed.
                let across = dd - d * (dd.dot(d) / (speed * speed));
                let bend = across / (speed * speed);
                let bend = if bend.is_finite() { bend } else { Vec3::zero() };
                length += last.map_or(0.0, |q| p.distance(q));
                last = Some(p);
                lengths.push(length as f32);
                places.extend(p.to_array().map(|x| x as f32));
                bends.extend(bend.to_array().map(|x| x as f32));
                sizes.push(bend.norm() as f32);
            }
            combs.push(json!({
                "name": name,
                "position": frame.floats("position", &places),
                "bend": frame.floats("bend", &bends),
                "curvature": frame.floats("curvature", &sizes),
                "length": frame.floats("length", &lengths),
            }));
        }
        frame.put("combs", combs);
    }

    fn section_areas(&mut self, count: usize, frame: &mut ReplyFrame) -> Answer {
        let panelled = self.document.entire_panels()?;
        if panelled.mesh.faces().is_empty() {
            return Err("the model has no panels: show a surface".to_string().into());
        }
        let bounds = panelled.mesh.bounds();
        let (low, high) = (bounds.low.x, bounds.high.x);
        let steps = count.clamp(2, MOST_SECTIONS) - 1;
        let at = |k: usize| low + (high - low) * k as f64 / steps as f64;
        let stations: Vec<f64> = (0..=steps).map(at).collect();
        let areas = self.document.section_areas(&stations, &[0.0], AREA_ACCURACY)?;
        let place: Vec<f32> = stations.iter().map(|&x| x as f32).collect();
        let area: Vec<f32> = areas.iter().map(|levels| levels[0][0] as f32).collect();
        let place = frame.floats("place", &place);
        let area = frame.floats("area", &area);
        frame.put("areas", json!({"place": place, "area": area}));
        Ok(())
    }

    fn mesh(&mut self, frame: &mut ReplyFrame) -> Answer {
        let panelled = self.document.panelled()?;
        let mesh = &panelled.mesh;
        let mirrors: Vec<u8> = self
            .document
            .symmetry()
            .bytes()
            .filter_map(|c| c.checked_sub(b'x').filter(|a| *a < 3))
            .collect();
        let closed = closure(mesh, &mirrors, Some(0.0));
        let leaks = closed.leaks().map(|e| {
            json!({
                "patch": mesh.patches()[e.patch].info.name,
                "edge": e.edge.to_string(),
                "panels": e.panels,
                "length": facts::number(e.length),
            })
        });
        let measured = moldloft_mesh::measure(mesh);
        let patches = mesh.patches().iter().zip(qualities(mesh)).map(|(patch, quality)| {
            let mut row = json!({"name": patch.info.name, "panels": patch.faces.len()});
            if let Some(q) = quality {
                row["aspect"] = facts::number(q.aspect.max);
                row["skew"] = facts::number(q.skew.max);
                row["warp"] = facts::number(q.warp.max);
                row["jump"] = facts::number(q.jump.max);
            }
            row
        });
        frame.put("patches", patches.collect::<Vec<_>>());
        frame.put("leaks", leaks.collect::<Vec<_>>());
        frame.put("closed", closed.closed());
        frame.put("closed_with_lids_and_mirror", closed.closed_with_lids_and_mirror());
        frame.put("panels", mesh.faces().len());
        frame.put("vertices", mesh.positions().len());
        frame.put("area", facts::number(measured.area));
        frame.put("volume", facts::number(measured.volume));
        Ok(())
    }

    fn export(&mut self, format: &str, stem: &str, frame: &mut ReplyFrame) -> Answer {
        let format = format_named(format)?;
        // A name from a page must not be a path.
        let letter = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' };
        let stem: String = stem.chars().map(letter).take(80).collect();
        let stem = if stem.is_empty() { "model".into() } else { stem };
        let name = format.file_name(&stem);
        let files = write(&mut self.document, format, &name, &WriteOptions::default())?;
        let mut parts = Vec::new();
        for file in files {
            let mut part = frame.bytes("file", &file.bytes);
            part["name"] = file.name.into();
            parts.push(part);
        }
        frame.put("files", parts);
        let remarks = facts::remarks(&self.document, self.document.export_remarks());
        frame.put("remarks", json_of(remarks));
        Ok(())
    }
}

fn word(kind: CompletionKind) -> &'static str {
    match kind {
        CompletionKind::Variable => "variable",
        CompletionKind::Object => "object",
        CompletionKind::Function => "function",
        CompletionKind::Kind => "kind",
        CompletionKind::Keyword => "keyword",
        CompletionKind::Member => "member",
        CompletionKind::Argument => "argument",
        CompletionKind::Word => "word",
    }
}
