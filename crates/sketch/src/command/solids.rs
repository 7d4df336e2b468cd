//! Commands that make faces and solids.

use super::CommandError;
use super::args::Args;
use super::draw::{require_lines, require_point};
use super::info::{likely_aligns, suggested_in_turn, suggestions};
use super::question::Question;
use super::session::{CommandReply, MAX_POINTS, SketchSession, Wireframe};
use super::subject::{ReplySubject, Suggestion};
use crate::solid::faces::{Fitted, Polygon, WireframeFit, fit, fit_plane};
use crate::solid::merge::{self, Placed};
use crate::{CoordinateAxis, DimensionExpr, FaceId, PointId, SketchFace, SketchObject};
use moldloft_num::Vec3;
use moldloft_syntax::number::plain;
use std::collections::BTreeMap;
use std::sync::Arc;

impl SketchSession {
    /// Positions of the points of a fully dimensioned object, or the missing dimensions.
    pub(super) fn placed(
        &mut self,
        object: &SketchObject,
    ) -> Result<BTreeMap<PointId, Vec3>, CommandError> {
        let (view, layout) = self.laid_out(object);
        require_lines(object)?;
        match layout.positions(&view.planes) {
            Some(at) => Ok(view.planes.ids().iter().copied().zip(at).collect()),
            None => {
                let lines = self.loose_lines(object, &view, &layout);
                let list: Vec<&str> = lines.iter().map(|l| l.0.as_str()).collect();
                let text = format!("{} is not fully dimensioned; {}", object.name, list.join("; "));
                let error = CommandError::new(404, text, "CONVERT lists what is missing");
                Err(error.about(super::subject::all_missing(lines)))
            }
        }
    }

    pub(super) fn wireframe(
        &mut self,
        object: &SketchObject,
    ) -> Result<(Vec<PointId>, Fitted), CommandError> {
        let at = self.placed(object)?;
        let ids: Vec<PointId> = at.keys().copied().collect();
        let positions: Vec<Vec3> = at.values().copied().collect();
        let index = |p: PointId| ids.binary_search(&p).unwrap_or(0);
        let edges: Vec<[usize; 2]> =
            object.drawing.lines.values().map(|l| [index(l.p), index(l.q)]).collect();
        let key = (positions.clone(), edges.clone(), object.drawing.section);
        let known = self.fitted.take().filter(|known| known.0 == key).map(|known| known.1);
        let search = |(positions, edges, section): &Wireframe| match *section {
            Some(normal) => {
                let mut n = Vec3::zero();
                match normal {
                    CoordinateAxis::X => n.x = 1.0,
                    // X to the right and Z up is seen against Y.
                    CoordinateAxis::Y => n.y = -1.0,
                    CoordinateAxis::Z => n.z = 1.0,
                }
                fit_plane(positions, edges, n)
            }
            None => fit(positions, edges),
        };
        let fitted = known.unwrap_or_else(|| search(&key));
        self.fitted = Some((key, fitted.clone()));
        let pairs = |list: &[[usize; 2]]| {
            let text: Vec<String> = (list.iter())
                .filter(|e| e.iter().all(|v| *v < ids.len()))
                .take(12)
                .map(|[a, b]| format!("{}-{}", ids[*a], ids[*b]))
                .collect();
            text.join(", ")
        };
        if fitted.too_large {
            return Err(CommandError::new(
                200,
                "the wireframe has too many crossing faces",
                "divide the object, or give faces with FACE",
            ));
        }
        if let Some(p) = fitted.crossings.first() {
            let at = p.to_array().map(plain).join(" ");
            return Err(CommandError::new(
                701,
                format!("two lines cross at {at} without a point"),
                "SPLIT both and WELD the points, or correct the dimensions",
            )
            .about(ReplySubject::of("lines-cross").place(*p)));
        }
        if !fitted.open.is_empty() {
            return Err(CommandError::new(
                701,
                format!("faces do not close: {}", open_text(&positions, &edges, &ids, &fitted)),
                "add the missing lines, or CHECK types and dimensions",
            )
            .about(
                ReplySubject::of("open-lines")
                    .points(fitted.open.iter().flatten().filter_map(|v| ids.get(*v).copied())),
            ));
        }
        if fitted.fits.is_empty() {
            return Err(CommandError::new(
                701,
                "no solid fits these lines",
                "add missing lines; or give faces with FACE",
            ));
        }
        if !fitted.dangling.is_empty() {
            self.out.push(CommandReply::warning(format!(
                "lines with a loose end are in no face: {}",
                pairs(&fitted.dangling)
            )));
        }
        Ok((ids, fitted))
    }

    pub(super) fn generate(&mut self, args: &mut Args) -> Result<(), CommandError> {
        if !args.take("FACES") {
            return Err(args.wants("FACES"));
        }
        if let Some(token) = args.peek().filter(|_| !args.at("ASK") && !args.at("AUTO")) {
            self.known(&token.text)?;
        }
        self.take_object(args)?;
        let ask = args.take("ASK");
        args.take("AUTO");
        args.end()?;
        let object = self.active()?.clone();
        let (ids, fitted) = self.wireframe(&object)?;
        if ask {
            let left: Vec<Vec<Vec<PointId>>> = (fitted.polygons.iter())
                .map(|p| face_of(p, &ids).loops().map(<[PointId]>::to_vec).collect())
                .collect();
            self.active_mut()?.faces.clear();
            self.question =
                Some(Question::Face { object: object.name.clone(), left, taken: vec![] });
            self.offer();
            return Ok(());
        }
        self.take_fit(&ids, &fitted.fits[0])?;
        if object.drawing.section.is_none() {
            let fit = &fitted.fits[0];
            // Curves round corners of the wireframe.
            let made = self.active_arc()?;
            let curved = Some(self.worked(&made)).filter(|_| !made.curves.is_empty());
            let volume = match curved.as_ref().map(|worked| worked.solid()) {
                None => format!(", volume {}", plain(fit.volume)),
                Some(solid) => {
                    solid.map_or(String::new(), |s| format!(", volume {}", plain(s.mass().volume)))
                }
            };
            let text = format!(
                "{} candidates, {} cells, {} faces{volume}",
                fitted.candidates,
                fitted.cells,
                fit.faces.len(),
            );
            self.out.push(CommandReply::note(text));
            let pairs = |list: &[[usize; 2]]| {
                let all: Vec<String> = list
                    .iter()
                    .filter(|e| e.iter().all(|v| *v < ids.len()))
                    .map(|[a, b]| format!("{}-{}", ids[*a], ids[*b]))
                    .collect();
                all.join(", ")
            };
            for inner in &fit.internal {
                let text: Vec<String> =
                    inner.iter().filter_map(|k| ids.get(*k)).map(ToString::to_string).collect();
                self.out.push(CommandReply::note(format!(
                    "internal polygon {} is not a face",
                    text.join(" ")
                )));
            }
            if !fit.branching.is_empty() {
                self.out.push(CommandReply::warning(format!(
                    "more than two faces meet at {}",
                    pairs(&fit.branching)
                )));
            }
            if !fit.scribed.is_empty() {
                self.out.push(CommandReply::note(format!(
                    "lines between faces of one plane: {}; CLEAN removes them",
                    pairs(&fit.scribed)
                )));
            }
        }
        if fitted.fits.len() > 1 {
            let volumes: Vec<String> = fitted.fits.iter().map(|f| plain(f.volume)).collect();
            let more = if fitted.complete { "" } else { " and more" };
            let mut reply = CommandReply::warning(format!(
                "several solids fit: {}{more}, of volumes {}",
                fitted.fits.len(),
                volumes.join(", ")
            ));
            (reply.code, reply.next) = (Some(702), Some("CHOOSE n takes another".to_owned()));
            self.out.push(reply);
            let faces = fitted
                .fits
                .iter()
                .map(|f| f.faces.iter().map(|p| face_of(p, &ids)).collect())
                .collect();
            self.question = Some(Question::Solid { object: object.name.clone(), faces });
        }
        self.report_validity()
    }

    fn take_fit(&mut self, ids: &[PointId], fit: &WireframeFit) -> Result<(), CommandError> {
        let object = self.active_mut()?;
        let faces = fit.faces.iter().map(|p| face_of(p, ids));
        object.faces = (1..).map(FaceId).zip(faces).collect();
        Ok(())
    }

    pub(super) fn choose(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let n = args.count("the number of a solid")? as usize;
        args.end()?;
        let Some(Question::Solid { object, faces }) = &self.question else {
            return Err(CommandError::new(
                702,
                "nothing to choose",
                "GENERATE FACES offers what fits",
            ));
        };
        let (key, count) = (object.to_lowercase(), faces.len());
        let Some(chosen) = faces.get(n - 1).cloned() else {
            return Err(CommandError::new(
                702,
                format!("there are {count} solids, not {n}"),
                "choose one of them",
            ));
        };
        let Some(object) = self.state.objects.get_mut(&key) else {
            return Err(CommandError::new(
                110,
                format!("there is no object {key}"),
                "GENERATE FACES again",
            )
            .about(ReplySubject::of("unknown-object").names([&key])));
        };
        Arc::make_mut(object).faces = (1..).map(FaceId).zip(chosen).collect();
        self.state.active = Some(key);
        self.report_validity()
    }

    /// Offers the next candidate without an edge that has two faces already.
    fn offer(&mut self) {
        let Some(Question::Face { object, left, taken }) = &mut self.question else { return };
        let uses = |p: PointId, q: PointId| {
            let has = |c: &[PointId]| {
                (0..c.len()).any(|k| {
                    let pair = (c[k], c[(k + 1) % c.len()]);
                    pair == (p, q) || pair == (q, p)
                })
            };
            taken.iter().flat_map(SketchFace::loops).filter(|c| has(c)).count()
        };
        let full = |c: &Vec<PointId>| (0..c.len()).any(|k| uses(c[k], c[(k + 1) % c.len()]) >= 2);
        while left.first().is_some_and(|loops| loops.iter().any(full)) {
            left.remove(0);
        }
        match left.first() {
            Some(loops) => {
                let text: Vec<String> = loops
                    .iter()
                    .map(|c| c.iter().map(ToString::to_string).collect::<Vec<_>>().join(" "))
                    .collect();
                let mut reply =
                    CommandReply::note(format!("is this a face: {}?", text.join(" HOLE ")));
                reply.next = Some("ACCEPT, REJECT, REVERSE or REPEAT".to_owned());
                self.out.push(reply);
            }
            None => {
                let (key, faces) = (object.to_lowercase(), std::mem::take(taken));
                self.out.push(CommandReply::note(format!("{} faces", faces.len())));
                if let Some(object) = self.state.objects.get_mut(&key) {
                    Arc::make_mut(object).faces = (1..).map(FaceId).zip(faces).collect();
                }
                self.question = None;
            }
        }
    }

    /// `ACCEPT ALL`: every missing dimension as the picture suggests it.
    pub(super) fn accept_all(&mut self) -> Result<(), CommandError> {
        let before = self.active()?.clone();
        let (object, taken) = self.completed(&before);
        let aligned = &object.drawing.aligns[before.drawing.aligns.len()..];
        if taken.is_empty() && aligned.is_empty() {
            return Err(CommandError::text(
                "no dimension is missing, or the picture suggests none",
                "CHECK lists what is missing",
            ));
        }
        let text: Vec<String> = taken
            .iter()
            .map(|(name, s)| format!("{name} {} {} TO {} = {}", s.axis, s.p, s.q, plain(s.value)))
            .collect();
        let aligned = aligned.iter().map(|a| format!("ALIGN {} {} {}", a.axis, a.p, a.q));
        let text: Vec<String> = aligned.chain(text).collect();
        *self.active_mut()? = object;
        self.out.push(CommandReply::note(format!("taken from the picture: {}", text.join(", "))));
        self.report_counts()
    }

    /// An object with its missing dimensions as the picture suggests them, and those. Parts of open
    /// depth are aligned with the rest where their planes coincide.
    pub(super) fn completed(
        &mut self,
        object: &SketchObject,
    ) -> (SketchObject, Vec<(String, Suggestion)>) {
        let mut out = object.clone();
        let mut taken = Vec::new();
        let mut free = 1;
        loop {
            let (view, layout) = self.laid_out(&out);
            let aligned = likely_aligns(&out, &view, &layout);
            if !aligned.is_empty() {
                out.draw().aligns.extend(aligned);
                continue;
            }
            let found: Vec<Suggestion> = if out.drawing.exact {
                suggestions(&out, &view, &layout).flatten().collect()
            } else {
                suggested_in_turn(&out, &view, &layout)
            };
            if found.is_empty() {
                return (out, taken);
            }
            for s in found {
                // Names are only added, so the lowest free number never falls.
                let name = loop {
                    let name = format!("E{free}");
                    if !out.has_name(&name) {
                        break name;
                    }
                    free += 1;
                };
                out.add_dimension(crate::Dimension {
                    name: name.clone(),
                    measure: crate::MeasuredQuantity::Along { axis: s.axis, p: s.p, q: s.q },
                    value: Some(DimensionExpr::number(s.value)),
                    role: crate::DimensionRole::Driving,
                    range: None,
                });
                taken.push((name, s));
            }
        }
    }

    /// The body of an object as far as the picture and its dimensions determine it, with the
    /// suggested values of missing dimensions and the faces of the likeliest solid. Returns also
    /// the guessed dimensions.
    pub fn preview(
        &mut self,
        name: &str,
    ) -> Option<(crate::SketchSolid<f64>, Vec<(String, Suggestion)>)> {
        let object = self.object(name)?.clone();
        let (mut guessed, taken) = self.completed(&object);
        if guessed.faces.is_empty() && guessed.feature.is_none() {
            let outer = std::mem::take(&mut self.out);
            let found = self.wireframe(&guessed);
            self.out = outer;
            let (ids, fitted) = found.ok()?;
            let faces = fitted.fits.first()?.faces.iter().map(|p| face_of(p, &ids));
            guessed.faces = (1..).map(FaceId).zip(faces).collect();
        }
        let (view, layout) = self.laid_out(&guessed);
        crate::solid(&guessed, &view.planes, &layout).map(|solid| (solid, taken))
    }

    pub(super) fn answer(&mut self, verb: &str) -> Result<(), CommandError> {
        match (self.question.take(), verb) {
            (Some(Question::Dimension { name, axis, p, q, value }), "YES" | "ACCEPT") => {
                self.add_along(name, axis, p, q, DimensionExpr::number(value), None)
            }
            (Some(Question::Dimension { .. } | Question::Solid { .. }), "NO" | "REJECT") => Ok(()),
            (Some(Question::Face { object, mut left, mut taken }), _) => {
                let known = self.state.objects.get(&object.to_lowercase());
                if known.is_none() || left.is_empty() {
                    return Ok(());
                }
                let result = match verb {
                    "ACCEPT" | "YES" => {
                        let face = oriented(left.remove(0), &taken);
                        taken.push(face);
                        Ok(())
                    }
                    "REJECT" | "NO" => {
                        left.remove(0);
                        Ok(())
                    }
                    "REVERSE" if taken.iter().any(|f| touches(f, &left[0])) => {
                        Err(CommandError::new(
                            700,
                            "this face cannot be reversed: it would disagree with its accepted neighbours",
                            "ACCEPT or REJECT it",
                        ))
                    }
                    "REVERSE" => {
                        left[0].iter_mut().for_each(|c| c.reverse());
                        Ok(())
                    }
                    _ => Ok(()),
                };
                self.question = Some(Question::Face { object, left, taken });
                if result.is_ok() {
                    self.offer();
                }
                result
            }
            (question, _) => {
                self.question = question;
                Err(CommandError::text(
                    "no question is open",
                    "GENERATE FACES ASK, or DIMENSION without a value, asks one",
                ))
            }
        }
    }

    pub(super) fn face(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let labelled = args.number_at(0) && args.tokens_at(1, "RUNS");
        let label = if labelled { Some(FaceId(args.count("the number of a face")?)) } else { None };
        args.take_short("RUNS");
        let mut cycles: Vec<Vec<PointId>> = vec![vec![]];
        while args.len() > 0 {
            if args.take("HOLE") {
                cycles.push(vec![]);
            } else {
                let p = args.point()?;
                cycles.last_mut().into_iter().for_each(|c| c.push(p));
            }
        }
        let object = self.active()?.clone();
        let closed = |c: &[PointId]| {
            c.len() >= 3
                && (0..c.len())
                    .all(|k| object.drawing.line_between(c[k], c[(k + 1) % c.len()]).is_some())
        };
        let id = label.unwrap_or_else(|| object.next_face());
        for c in &cycles {
            for &p in c {
                require_point(&object, p)?;
            }
            if c.len() < 3 {
                return Err(args.wants("three points or more in each cycle"));
            }
            // A point on a line between two others is allowed, so only wholly foreign pairs are refused.
            if !closed(c)
                && !c.iter().any(|p| object.drawing.lines.values().any(|l| l.p == *p || l.q == *p))
            {
                return Err(CommandError::new(
                    401,
                    "the points of the face are in no line",
                    "draw its lines first",
                )
                .about(ReplySubject::of("loose-point").points(c.iter().copied())));
            }
        }
        let mut cycles = cycles.into_iter();
        let outer = cycles.next().unwrap_or_default();
        self.active_mut()?.faces.insert(id, SketchFace { outer, holes: cycles.collect() });
        self.report_validity_of(true)
    }

    pub(super) fn extrude(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let axis_next = args.peek().is_some_and(|t| CoordinateAxis::of(&t.text).is_some());
        let named = !axis_next && !args.at_number() && args.len() > 1 && !args.tokens_at(1, "INTO");
        let object = match named {
            true => self.operand(&args.name("the name of a cross section")?)?,
            false => self.active_arc()?,
        };
        let axis = args.axis();
        let value = args.value(object.units.as_deref())?;
        let follows = args.len() > 0 || object.feature.is_some() || object.on.is_some();
        let target = self.target(args, &object.name)?;
        args.end()?;
        let normal = self.section_axis(&object)?;
        if axis.is_some_and(|a| a != normal) {
            return Err(CommandError::new(
                113,
                format!("the section is perpendicular to {normal}"),
                format!("EXTRUDE {normal} value"),
            )
            .about(ReplySubject::of("no-cross-section").names([&object.name]).axis(normal)));
        }
        if follows {
            return self.extrude_section(object, value, &target);
        }
        self.state.active = Some(object.name.to_lowercase());
        if 2 * object.drawing.points.len() > MAX_POINTS {
            return Err(CommandError::new(
                200,
                format!("an object has at most {MAX_POINTS} points"),
                "extrude a smaller section",
            ));
        }
        let name = object.fresh_name("D");
        let (_, layout) = self.laid_out(&object);
        let number = value.eval(&|n| layout.values.get(n).copied());
        if number.as_ref().is_ok_and(|x| *x == 0.0 || !x.is_finite()) {
            return Err(CommandError::new(
                300,
                "an extrusion of length 0 has no volume",
                "give a length",
            ));
        }
        let Some(solid) = merge::extrude(&object, &name, value) else {
            return Err(CommandError::new(
                101,
                format!("object {} has no points yet", object.name),
                "draw some",
            )
            .about(ReplySubject::of("no-points").names([&object.name])));
        };
        *self.active_mut()? = solid;
        self.faces_if_complete()
    }

    /// Finds faces if everything is determined; otherwise reports the missing dimensions.
    fn faces_if_complete(&mut self) -> Result<(), CommandError> {
        let object = self.active()?.clone();
        let complete = self.laid_out(&object).1.complete();
        if complete {
            self.generate(&mut Args::new(&[faces_word()], ""))
        } else {
            self.report_counts()
        }
    }

    pub(super) fn clean(&mut self, args: &mut Args) -> Result<(), CommandError> {
        if let Some(token) = args.peek() {
            self.known(&token.text)?;
        }
        self.take_object(args)?;
        args.end()?;
        let object = self.active()?.clone();
        let at = self.placed(&object)?;
        let (ids, fitted) = self.wireframe(&object)?;
        let scribed: Vec<[PointId; 2]> =
            fitted.fits[0].scribed.iter().map(|e| e.map(|k| ids[k])).collect();
        let cleaned = merge::clean(&object, &scribed, &at);
        let (p, l) = (
            object.drawing.points.len() - cleaned.drawing.points.len(),
            object.drawing.lines.len() - cleaned.drawing.lines.len(),
        );
        *self.active_mut()? = cleaned;
        self.out.push(CommandReply::note(format!("{p} points and {l} lines removed")));
        self.faces_if_complete()
    }

    pub(super) fn merge(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let wrong = || {
            CommandError::new(
                191,
                "usage: MERGE A [B] [INTO] C",
                "name the objects to unite, then the one to make",
            )
        };
        let mut tolerance = None;
        let mut words: Vec<String> = Vec::new();
        while args.len() > 0 {
            if args.take_short("TOL") {
                tolerance = Some(args.number("a tolerance")?);
                break;
            }
            words.push(args.name("the name of an object").map_err(|_| wrong())?);
        }
        args.end().map_err(|_| wrong())?;
        let into = |w: &String| w.eq_ignore_ascii_case("INTO");
        // INTO may be left out, but must be spelled right.
        let (names, target): (Vec<String>, String) = match &words[..] {
            [a, c] if !into(a) && !into(c) => (vec![a.clone()], c.clone()),
            [a, i, c] if into(i) => (vec![a.clone()], c.clone()),
            [a, b, c] if ![a, b, c].into_iter().any(into) => {
                (vec![a.clone(), b.clone()], c.clone())
            }
            [a, b, i, c] if into(i) => (vec![a.clone(), b.clone()], c.clone()),
            [_, _, i, _] => {
                return Err(CommandError::new(
                    192,
                    format!("\"INTO\" is misspelt as \"{i}\""),
                    "MERGE A B INTO C",
                ));
            }
            _ => return Err(wrong()),
        };
        if target.is_empty() || target.chars().count() > 32 || into(&target) {
            return Err(wrong());
        }
        let mut keys: Vec<String> = Vec::new();
        let old = target.to_lowercase();
        let keep_first = self.state.objects.contains_key(&old);
        keys.extend(keep_first.then(|| old.clone()));
        for name in &names {
            let object = self.known(name)?;
            let key = object.name.to_lowercase();
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
        let mut parts: Vec<(Arc<SketchObject>, BTreeMap<PointId, Vec3>)> = Vec::new();
        for key in &keys {
            let object = Arc::clone(&self.state.objects[key]);
            if object.drawing.section.is_some() {
                return Err(CommandError::new(
                    114,
                    format!("{} is a cross section; only solids are merged", object.name),
                    "EXTRUDE it first",
                )
                .about(ReplySubject::of("cross-section").names([&object.name])));
            }
            let at = self.placed(&object)?;
            parts.push((object, at));
        }
        let points: usize = parts.iter().map(|p| p.1.len()).sum();
        if points > MAX_POINTS {
            return Err(CommandError::new(
                200,
                format!("{points} points are too many"),
                "merge smaller objects",
            ));
        }
        if let [(one, _)] = &parts[..]
            && one.name.eq_ignore_ascii_case(&target)
        {
            self.out.push(CommandReply::note(format!(
                "{} is the only one; nothing was changed",
                one.name
            )));
            self.state.active = Some(old);
            return Ok(());
        }
        let all = || parts.iter().flat_map(|p| p.1.values());
        let size = all().map(|p| p.norm()).fold(0.0, f64::max);
        let tolerance = tolerance.filter(|t| *t >= 0.0).unwrap_or(1e-6 * size);
        let placed: Vec<Placed> =
            parts.iter().map(|(o, at)| Placed { object: o, at: at.clone() }).collect();
        let others: BTreeMap<String, f64> =
            parts.iter().flat_map(|(o, _)| self.state.others(o)).collect();
        let solve = |o: &SketchObject| {
            let planes = crate::Planes::of(&o.drawing);
            crate::solve(o, &planes, &others, &|| {
                crate::Estimate::of(&o.drawing, &planes, o.reference()?.point)
            })
        };
        let (made, report) = merge::merge(&target, &placed, tolerance, keep_first, &solve);
        let count = |f: &dyn Fn(&SketchObject) -> usize| {
            parts.iter().map(|p| f(&p.0).to_string()).collect::<Vec<_>>().join("+")
        };
        let text = format!(
            "{} points, {} shared: {}; {} lines, {} shared: {}",
            count(&|o| o.drawing.points.len()),
            report.shared,
            made.drawing.points.len(),
            count(&|o| o.drawing.lines.len()),
            report.lines,
            made.drawing.lines.len()
        );
        self.out.push(CommandReply::note(text));
        if !report.contradictory.is_empty() {
            self.out.push(CommandReply::warning(format!(
                "these dimensions contradict others and only measure now: {}",
                report.contradictory.join(", ")
            )));
        }
        self.insert(made);
        self.faces_if_complete()
    }

    pub(super) fn transform(&mut self, args: &mut Args, verb: &str) -> Result<(), CommandError> {
        let Some(name) = args.peek().map(|t| t.text.clone()) else {
            return Err(args.wants("the name of an object"));
        };
        let object = SketchObject::clone(&*self.operand(&name)?);
        let key = name.to_lowercase();
        // By expressions, by angles other than quarter turns, about points other than the origin,
        // and for objects without a drawing: a feature.
        let quarters = |k: usize| args.number_of(k).is_some_and(|a| (a / 90.0).fract() == 0.0);
        let drawn = object.feature.is_none()
            && match verb {
                "MOVE" => (1..4).all(|k| args.number_of(k).is_some()),
                "SCALE" => args.number_of(1).is_some(),
                "MIRROR" => args.len() == 2,
                _ => args.len() == 3 && quarters(2),
            };
        if !drawn && args.len() > 1 {
            return self.place(args, verb);
        }
        args.skip();
        let new = match verb {
            "MOVE" => {
                let by =
                    [args.number("a shift")?, args.number("a shift")?, args.number("a shift")?];
                merge::moved(&object, by.into())
            }
            "SCALE" => {
                let factor = args.number("a factor")?;
                if !(factor > 0.0 && factor < 1e9) {
                    return Err(CommandError::text(
                        format!("the factor {factor} is not positive"),
                        "MIRROR turns objects over",
                    ));
                }
                merge::scaled(&object, factor)
            }
            _ => {
                let axis = args.axis().ok_or_else(|| args.wants("an axis"))?;
                let turned = if verb == "MIRROR" {
                    merge::mirrored(&object, axis)
                } else {
                    let angle = args.number("an angle in degrees")?;
                    let quarters = angle / 90.0;
                    let n = (quarters as i64).rem_euclid(4);
                    (0..n).fold(object.clone(), |o, _| merge::quarter_turned(&o, axis))
                };
                let at = self.placed(&turned)?;
                merge::redrawn(&turned, &at)
            }
        };
        args.end()?;
        self.state.objects.insert(key, Arc::new(new));
        Ok(())
    }
}

pub(super) fn faces_word() -> super::words::CommandToken {
    super::words::CommandToken {
        kind: super::words::CommandTokenKind::Word,
        text: "FACES".to_owned(),
    }
}

pub(super) fn face_of(polygon: &Polygon, ids: &[PointId]) -> SketchFace {
    // Vertices beyond the points were refused before.
    let cycle = |c: &Vec<usize>| c.iter().filter_map(|k| ids.get(*k).copied()).collect();
    SketchFace { outer: cycle(&polygon.outer), holes: polygon.holes.iter().map(cycle).collect() }
}

fn runs(face: &SketchFace, p: PointId, q: PointId) -> bool {
    face.loops().any(|c| (0..c.len()).any(|k| (c[k], c[(k + 1) % c.len()]) == (p, q)))
}

fn pairs(loops: &[Vec<PointId>]) -> impl Iterator<Item = (PointId, PointId)> {
    loops.iter().flat_map(|c| (0..c.len()).map(|k| (c[k], c[(k + 1) % c.len()])))
}

/// True if a candidate shares an edge with a face.
fn touches(face: &SketchFace, loops: &[Vec<PointId>]) -> bool {
    pairs(loops).any(|(p, q)| runs(face, p, q) || runs(face, q, p))
}

/// A candidate turned so that it agrees with accepted neighbours.
fn oriented(loops: Vec<Vec<PointId>>, taken: &[SketchFace]) -> SketchFace {
    let clash = pairs(&loops).any(|(p, q)| taken.iter().any(|f| runs(f, p, q)));
    let mut cycles = loops.into_iter();
    let face = SketchFace { outer: cycles.next().unwrap_or_default(), holes: cycles.collect() };
    if clash { face.reversed() } else { face }
}

/// Parts at which faces fail to close: points with two lines, loops that are nearly plane, and the
/// first lines with fewer than two candidates.
fn open_text(positions: &[Vec3], edges: &[[usize; 2]], ids: &[PointId], fitted: &Fitted) -> String {
    let mut next: Vec<Vec<usize>> = vec![Vec::new(); positions.len()];
    for &[a, b] in edges {
        next[a].push(b);
        next[b].push(a);
    }
    let mut parts: Vec<String> = Vec::new();
    let few: Vec<String> = (0..positions.len())
        .filter(|&k| next[k].len() < 3 && !next[k].is_empty())
        .take(8)
        .map(|k| ids[k].to_string())
        .collect();
    if !few.is_empty() {
        parts.push(format!("fewer than three lines meet at points {}", few.join(", ")));
    }
    // Quadrilaterals that miss being plane by a little.
    let size = positions.iter().map(|p| p.distance(positions[0])).fold(0.0, f64::max);
    let mut warped: Vec<(f64, String)> = Vec::new();
    for &[a, b] in edges {
        for &c in next[b].iter().filter(|&&c| c != a) {
            for &d in next[c].iter().filter(|&&d| d != b && d != a) {
                if a < b.min(c).min(d) && b < d && next[d].contains(&a) {
                    let off = crate::faces::flatness(&[a, b, c, d].map(|k| positions[k]));
                    if off > 1e-7 * size && off < 0.1 * size {
                        let loop_text = [a, b, c, d].map(|k| ids[k].to_string()).join(" ");
                        warped.push((
                            off,
                            format!(
                                "{loop_text} is out of plane by {}",
                                plain(super::digits::rounded(off))
                            ),
                        ));
                    }
                }
            }
        }
    }
    warped.sort_by(|a, b| a.0.total_cmp(&b.0));
    parts.extend(warped.into_iter().take(4).map(|w| w.1));
    let list: Vec<String> = (fitted.first_open.iter())
        .filter(|e| e.iter().all(|v| *v < ids.len()))
        .take(8)
        .map(|[a, b]| format!("{}-{}", ids[*a], ids[*b]))
        .collect();
    parts.push(format!("lines {} have fewer than two faces", list.join(", ")));
    parts.join("; ")
}
