//! An object as the commands that make it: the file format.

use crate::feature::{
    EdgeBlend, EdgeChoice, FaceChoice, Feature, FeatureKind, HoleHead, OffsetCorner, Placement,
    SectionText,
};
use crate::solid::curve::{CurveKind, SketchCurve};
use crate::{
    CoordinateAxis, DimensionExpr, DimensionRole, LineTypeSource, MeasuredQuantity, Reference,
    SketchObject,
};
use moldloft_font::{HorizontalAlign, VerticalAlign};
use moldloft_syntax::number::plain;
use std::fmt::Write;

/// A name or expression, in quotes where a command needs them.
pub(crate) fn quoted(text: &str) -> String {
    let simple = text.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && text.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '.');
    let number = text.parse::<f64>().is_ok_and(f64::is_finite)
        && !text.starts_with(|c: char| c.is_alphabetic());
    match (simple || number, text.contains('"')) {
        (true, _) => text.to_owned(),
        (_, true) => format!("'{text}'"),
        _ => format!("\"{text}\""),
    }
}

/// A text in quotes.
fn quoted_text(text: &str) -> String {
    let mark = if text.contains('"') { '\'' } else { '"' };
    format!("{mark}{text}{mark}")
}

/// `X 1 TO 3`, `LENGTH 4`: the quantity of a dimension, as in its command.
pub(crate) fn measure_text(measure: &MeasuredQuantity) -> String {
    match measure {
        MeasuredQuantity::Along { axis, p, q } => format!("{axis} {p} TO {q}"),
        MeasuredQuantity::Datum { axis, point } => format!("POINT {point} {axis}"),
        MeasuredQuantity::Length(l) => format!("LENGTH {l}"),
        MeasuredQuantity::Slope(l) => format!("SLOPE {l}"),
        MeasuredQuantity::Angle(a, b) => format!("ANGLE {a} {b}"),
        MeasuredQuantity::Equal(a, b) => format!("EQUAL {a} {b}"),
    }
}

fn range_text(range: Option<[f64; 2]>) -> String {
    range.map_or(String::new(), |[a, b]| format!(" IN {} {}", plain(a), plain(b)))
}

/// A face as commands name it: in quotes where its name could be another word.
pub(crate) fn face_text(face: &FaceChoice) -> String {
    match face {
        FaceChoice::Named(name) if name.parse::<u32>().is_ok() => name.clone(),
        FaceChoice::Named(name) => format!("\"{name}\""),
        FaceChoice::Extreme { .. } => face.to_string(),
    }
}

fn edge_text(edge: &EdgeChoice) -> String {
    match edge {
        EdgeChoice::Of(face) => format!("OF {}", face_text(face)),
        EdgeChoice::Between(a, b) => format!("BETWEEN {} {}", face_text(a), face_text(b)),
        other => other.to_string(),
    }
}

/// The commands that make an object, after those of the objects that it follows. Running them makes
/// an identical object.
pub fn script(object: &SketchObject) -> String {
    scripts(&[object]).into_iter().map(|(_, text)| text).collect()
}

/// Objects and those that they follow, each after its operands, with the commands that make it.
pub fn scripts<'a>(objects: &[&'a SketchObject]) -> Vec<(&'a SketchObject, String)> {
    fn add<'a>(
        object: &'a SketchObject,
        given: &[&'a SketchObject],
        out: &mut Vec<(&'a SketchObject, String)>,
    ) {
        let namesake = |o: &&SketchObject| o.name.eq_ignore_ascii_case(&object.name);
        if out.iter().any(|(known, _)| namesake(known)) {
            return;
        }
        let object = given.iter().copied().find(namesake).unwrap_or(object);
        add_followed(object, given, out);
        let below = object.on.as_ref().map(|on| &on.body);
        let below = below.and_then(|b| given.iter().find(|o| o.name.eq_ignore_ascii_case(b)));
        if let Some(body) = below.filter(|body| !namesake(body)) {
            add(body, given, out);
        }
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = write(object, &mut text);
        out.push((object, text));
    }
    fn add_followed<'a>(
        object: &'a SketchObject,
        given: &[&'a SketchObject],
        out: &mut Vec<(&'a SketchObject, String)>,
    ) {
        for operand in object.feature.iter().flat_map(|f| &f.operands) {
            match operand.follows {
                true => add(&operand.object, given, out),
                false => add_followed(&operand.object, given, out),
            }
        }
    }
    let mut out = Vec::new();
    objects.iter().for_each(|object| add(object, objects, &mut out));
    out
}

/// A feature: its parts, the command that makes it of them, and its numbers.
fn write_feature(object: &SketchObject, feature: &Feature, out: &mut String) -> std::fmt::Result {
    let name = quoted(&object.name);
    writeln!(out, "WITHIN {name}")?;
    for operand in feature.operands.iter().filter(|o| !o.follows) {
        write(&operand.object, out)?;
    }
    let parts: Vec<String> = feature.operands.iter().map(|o| quoted(&o.object.name)).collect();
    let parts = parts.join(" ");
    let value = |e: &DimensionExpr| quoted(e.text());
    let vector = |v: &[DimensionExpr; 3]| v.each_ref().map(value).join(" ");
    let place = |p: &Placement| match p {
        Placement::Move(by) => vector(by),
        Placement::Rotate { axis, through, angle } => {
            format!("{axis} {} THROUGH {}", value(angle), vector(through))
        }
        Placement::Mirror { axis, at } => format!("{axis} {}", value(at)),
        Placement::Scale(factor) => value(factor),
    };
    // Value of a number of the feature itself, which its command names again.
    let own_value = |e: &DimensionExpr| {
        let known = object.variables.get(&e.text().to_ascii_lowercase());
        value(known.map_or(e, |v| &v.value))
    };
    let list = |word: &str, faces: &[FaceChoice]| {
        let all: Vec<String> = faces.iter().map(face_text).collect();
        if all.is_empty() { String::new() } else { format!(" {word} {}", all.join(" ")) }
    };
    // The command may contain numbers of the feature itself.
    let own = object.variables.values().filter(|v| object.alias(&v.name).is_none());
    let own: Vec<&crate::Variable> = own.collect();
    let command = match &feature.kind {
        FeatureKind::Boolean(operation) => format!("{} {parts} INTO {name}", operation.word()),
        FeatureKind::Text(text) => text_command(text, &name, &own_value),
        FeatureKind::Offset { distance, corner } => {
            let corner = match corner {
                OffsetCorner::Round => "ROUND",
                OffsetCorner::Mitred => "MITRED",
            };
            format!("OFFSET {parts} {} {corner} INTO {name}", own_value(distance))
        }
        FeatureKind::Sweep => {
            let [section, path] = [0, 1].map(|k| quoted(&feature.operands[k].object.name));
            format!("SWEEP {section} ALONG {path} INTO {name}")
        }
        FeatureKind::Loft => format!("LOFT {parts} INTO {name}"),
        FeatureKind::Extrude(distance) => {
            format!("EXTRUDE {parts} {} INTO {name}", own_value(distance))
        }
        FeatureKind::Revolve { line: [p, q], angle } => {
            let section = &feature.operands[0].object.drawing;
            let line = section.line_between(*p, *q).map_or(0, |l| l.0);
            format!("REVOLVE {parts} {line} {} INTO {name}", value(angle))
        }
        FeatureKind::Place(p) => {
            let word = match p {
                Placement::Move(_) => "MOVE",
                Placement::Rotate { .. } => "ROTATE",
                Placement::Mirror { .. } => "MIRROR",
                Placement::Scale(_) => "SCALE",
            };
            format!("{word} {parts} {} FEATURE INTO {name}", place(p))
        }
        FeatureKind::OnFace { face, along } => {
            let [object, base] = [0, 1].map(|k| quoted(&feature.operands[k].object.name));
            let along = along.map_or(String::new(), |axis| format!(" ALONG {axis}"));
            format!("MOVE {object} ON {base} {}{along} INTO {name}", face_text(face))
        }
        FeatureKind::Pattern { step, count } => {
            let word = match step {
                Placement::Move(_) => format!("LINEAR {}", value(count)),
                Placement::Rotate { axis, .. } => format!("POLAR {} {axis}", value(count)),
                Placement::Mirror { .. } => "MIRROR".to_owned(),
                Placement::Scale(_) => "LINEAR".to_owned(),
            };
            let rest = place(step);
            let rest = match step {
                Placement::Rotate { .. } => rest.get(2..).unwrap_or_default().to_owned(),
                _ => rest,
            };
            format!("PATTERN {parts} {word} {rest} INTO {name}")
        }
        FeatureKind::Blend { blend, edges } => {
            let edges: Vec<String> = edges.iter().map(edge_text).collect();
            let (word, size) = match blend {
                EdgeBlend::Chamfer([a, b]) if a == b => ("CHAMFER", own_value(a)),
                EdgeBlend::Chamfer([a, b]) => {
                    ("CHAMFER", format!("{} {}", own_value(a), own_value(b)))
                }
                EdgeBlend::Fillet(radius) => ("FILLET", own_value(radius)),
            };
            format!("{word} {parts} {size} EDGES {} INTO {name}", edges.join(" "))
        }
        FeatureKind::Shell { thickness, open } => {
            let open = list("OPEN", open);
            format!("SHELL {parts} {}{open} INTO {name}", own_value(thickness))
        }
        FeatureKind::Hole(hole) => {
            let mut text = format!(
                "HOLE {parts} {} AT {} FROM {} {}",
                own_value(&hole.diameter),
                hole.at.each_ref().map(own_value).join(" "),
                if hole.top { "TOP" } else { "BOTTOM" },
                hole.axis,
            );
            if let Some(depth) = &hole.depth {
                text += &format!(" DEPTH {}", own_value(depth));
            }
            match &hole.head {
                Some(HoleHead::Counterbore { diameter, depth }) => {
                    text += &format!(" COUNTERBORE {} {}", own_value(diameter), own_value(depth));
                }
                Some(HoleHead::Countersink { diameter, angle }) => {
                    text += &format!(" COUNTERSINK {} {}", own_value(diameter), own_value(angle));
                }
                None => {}
            }
            for (step, count) in &hole.copies {
                let [a, b] = hole.axis.others().map(CoordinateAxis::index);
                text += &match step {
                    Placement::Rotate { through, angle, .. } => {
                        let origin = [a, b].iter().all(|&k| through[k].literal() == Some(0.0));
                        let (p, q) = (own_value(&through[a]), own_value(&through[b]));
                        let place = match origin {
                            true => String::new(),
                            false => format!(" THROUGH {p} {q}"),
                        };
                        format!(" POLAR {} {}{place}", own_value(count), own_value(angle))
                    }
                    Placement::Move(by) => format!(
                        " LINEAR {} {} {}",
                        own_value(count),
                        own_value(&by[a]),
                        own_value(&by[b])
                    ),
                    Placement::Mirror { .. } | Placement::Scale(_) => String::new(),
                };
            }
            format!("{text} INTO {name}")
        }
        FeatureKind::Draft { angle, axis, at, faces } => {
            let (angle, at, faces) = (own_value(angle), own_value(at), list("FACES", faces));
            format!("DRAFT {parts} {axis} {angle} AT {at}{faces} INTO {name}")
        }
    };
    writeln!(out, "{command}")?;
    for v in own {
        writeln!(out, "DECLARE {} {}{}", v.name, quoted(v.value.text()), range_text(v.range))?;
    }
    if let Some(units) = &object.units {
        writeln!(out, "SET UNITS {units}")?;
    }
    writeln!(out, "LEAVE")?;
    if object.keep {
        writeln!(out, "KEEP {name}")?;
    }
    if !object.display {
        writeln!(out, "ERASE {name}")?;
    }
    writeln!(out, "END")
}

fn text_command(
    text: &SectionText,
    name: &str,
    value: &dyn Fn(&DimensionExpr) -> String,
) -> String {
    let lines: Vec<String> = text.lines.iter().map(|line| quoted_text(line)).collect();
    let plane = match text.axis {
        CoordinateAxis::X => "YZ",
        CoordinateAxis::Y => "XZ",
        CoordinateAxis::Z => "XY",
    };
    let along = match text.layout.horizontal {
        HorizontalAlign::Left => "LEFT",
        HorizontalAlign::Centre => "CENTRE",
        HorizontalAlign::Right => "RIGHT",
    };
    let across = match text.layout.vertical {
        VerticalAlign::Baseline => "BASELINE",
        VerticalAlign::Bottom => "BOTTOM",
        VerticalAlign::Middle => "MIDDLE",
        VerticalAlign::Top => "TOP",
    };
    let mirrored = if text.mirrored { " MIRRORED" } else { "" };
    let [p, q] = text.at.each_ref().map(value);
    format!(
        "TEXT {name} {} FONT {} SIZE {} AT {p} {q} ANGLE {} {along} {across} PLANE {plane}{mirrored}",
        lines.join(" "),
        quoted_text(&text.font),
        value(&text.size),
        value(&text.angle),
    )
}

fn write(object: &SketchObject, out: &mut String) -> std::fmt::Result {
    if let Some(feature) = &object.feature {
        return write_feature(object, feature, out);
    }
    let drawing = &object.drawing;
    let section = match drawing.section {
        Some(CoordinateAxis::X) => " 2D YZ",
        Some(CoordinateAxis::Y) => " 2D XZ",
        Some(CoordinateAxis::Z) => " 2D XY",
        None => "",
    };
    let on = object
        .on
        .as_ref()
        .map_or(String::new(), |on| format!(" ON {} {}", quoted(&on.body), face_text(&on.face)));
    writeln!(out, "SKETCH {}{section}{on}", quoted(&object.name))?;
    if drawing.letters.up != CoordinateAxis::Z {
        writeln!(out, "SET UP {}", drawing.letters.up)?;
    }
    if drawing.letters.naming == crate::Naming::Seed {
        writeln!(out, "SET NAMES SEED")?;
    }
    if let Some(units) = &object.units {
        writeln!(out, "SET UNITS {units}")?;
    }
    if drawing.exact {
        writeln!(out, "SET EXACT ON")?;
    }
    if drawing.certainty != 0.0 {
        writeln!(out, "SET CERTAINTY {}", plain(drawing.certainty))?;
    }
    let p = &drawing.projection;
    let [a, b, c] = p.angle_deg.map(plain);
    write!(out, "AXES {a} {b} {c}")?;
    if p.scale != [1.0; 3] {
        write!(out, " SCALE {}", p.scale.map(plain).join(" "))?;
    }
    writeln!(out)?;
    for (id, p) in &drawing.points {
        writeln!(out, "POINT {id} AT {} {}", plain(p.u), plain(p.v))?;
    }
    for (id, l) in &drawing.lines {
        write!(out, "LINE {id} FROM {} TO {}", l.p, l.q)?;
        let slope = drawing.slope_type(l);
        let by_slope = l.source == LineTypeSource::Auto
            && slope.map_or((None, 0.0), |s| (Some(s.0), s.1)) == (l.free, l.confidence);
        if !by_slope {
            write!(out, " TYPE {}", l.free.map_or("NONE", crate::Free::spelling))?;
            match l.source {
                LineTypeSource::User => {}
                LineTypeSource::Auto => write!(out, " AUTO {}", plain(l.confidence))?,
                LineTypeSource::Inferred => write!(out, " INFERRED {}", plain(l.confidence))?,
            }
        }
        writeln!(out)?;
    }
    for a in &drawing.aligns {
        writeln!(out, "ALIGN {} {} {}", a.axis, a.p, a.q)?;
    }
    if let Some(r) = &object.reference {
        writeln!(out, "{}", reference_text(r))?;
    }
    for v in object.variables.values() {
        writeln!(out, "DECLARE {} {}{}", v.name, quoted(v.value.text()), range_text(v.range))?;
    }
    for d in object.dimensions.values() {
        let value = d.value.as_ref().map_or("UNSET".to_owned(), |v| quoted(v.text()));
        let role = if d.role == DimensionRole::Reference { " ONLY" } else { "" };
        let text = measure_text(&d.measure);
        writeln!(out, "GIVE {} {text} = {value}{role}{}", d.name, range_text(d.range))?;
    }
    for (id, f) in &object.faces {
        let cycles: Vec<String> = (f.loops())
            .map(|c| c.iter().map(ToString::to_string).collect::<Vec<_>>().join(" "))
            .collect();
        writeln!(out, "FACE {id} RUNS {}", cycles.join(" HOLE "))?;
    }
    for c in object.curves.values() {
        writeln!(out, "{}", curve_text(c))?;
    }
    if object.keep {
        writeln!(out, "KEEP {}", quoted(&object.name))?;
    }
    if !object.display {
        writeln!(out, "ERASE {}", quoted(&object.name))?;
    }
    writeln!(out, "END")
}

/// Expressions may read names that come later.
pub(crate) fn reference_text(r: &Reference) -> String {
    let plain = r.at.iter().all(|e| e.literal().is_some());
    let word = if plain { "REFERENCE" } else { "GIVE REFERENCE" };
    let at = r.at.each_ref().map(|e| quoted(e.text()));
    format!("{word} {} {}", r.point, at.join(" "))
}

pub(crate) fn curve_text(c: &SketchCurve) -> String {
    let points: Vec<String> = c.points.iter().map(ToString::to_string).collect();
    let mut text = match (c.kind, &points[..]) {
        (CurveKind::EllipticalArc, [a, m, b]) => {
            format!("ELLIPSE {} ARC CORNER {m} {a} {b}", c.name)
        }
        (kind, [a, m, b]) if kind.at_corner() => {
            format!("{} {} CORNER {m} {a} {b}", kind.word(), c.name)
        }
        (kind, _) => format!("{} {} POINTS {}", kind.word(), c.name, points.join(" ")),
    };
    if let Some(r) = &c.radius {
        text.push_str(&format!(" RADIUS {}", quoted(r.text())));
    }
    if let Some([m, n]) = &c.semi {
        text.push_str(&format!(" SEMI {} {}", quoted(m.text()), quoted(n.text())));
    }
    match &c.shape[..] {
        [w] => text.push_str(&format!(" WEIGHT {}", quoted(w.text()))),
        [x, y] => text.push_str(&format!(" HANDLES {} {}", quoted(x.text()), quoted(y.text()))),
        _ => {}
    }
    if let Some(n) = c.steps {
        text.push_str(&format!(" STEPS {n}"));
    }
    match (c.kind.at_corner(), c.replaces) {
        (true, false) => text.push_str(" KEEP"),
        (false, true) => text.push_str(" REPLACE"),
        _ => {}
    }
    if c.centripetal {
        text.push_str(" CENTRIPETAL");
    }
    text
}
