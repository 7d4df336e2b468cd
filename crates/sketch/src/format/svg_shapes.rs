//! The shapes of an SVG picture: lines, polygons, rectangles, circles, ellipses, and paths.

use crate::format::page_curve::{PageCurve, mix};
use crate::format::page_shapes::PageShapes;
use crate::format::svg_transform::{SvgTransform, numbers};
use std::collections::HashMap;

/// Elements whose content is not drawn where it is.
const UNSEEN: [&str; 7] = ["defs", "clipPath", "mask", "marker", "pattern", "symbol", "metadata"];

/// The most elements that are drawn by reference, and the deepest reference in a reference.
const MOST_USES: usize = 10_000;
const DEEPEST_USE: usize = 32;

/// Reads the shapes of an SVG text; v is up, as on the page of a sketch.
///
/// # Errors
/// The reason why the text is not an SVG, or cannot be placed.
pub fn svg_shapes(text: &str) -> Result<PageShapes, String> {
    let mut reading = SvgReading { named: named(text)?, shapes: PageShapes::default(), uses: 0 };
    let known = reading.elements(text, SvgTransform::NONE, 0)?;
    if known { Ok(reading.shapes) } else { Err("it has no svg element".into()) }
}

/// The text after the next tag that is no comment, and the tag.
fn next_tag(mut rest: &str) -> Result<Option<(&str, &str)>, String> {
    while let Some(at) = rest.find('<') {
        rest = &rest[at + 1..];
        if let Some(comment) = rest.strip_prefix("!--") {
            let end = comment.find("-->").ok_or("a comment does not end")?;
            rest = &comment[end + 3..];
            continue;
        }
        let end = tag_end(rest).ok_or("an element does not end")?;
        let tag = &rest[..end];
        rest = &rest[end + 1..];
        if !tag.starts_with(['!', '?']) {
            return Ok(Some((rest, tag)));
        }
    }
    Ok(None)
}

/// The name of an element, without and with its prefix, its attributes as text, and whether it has no content.
fn parts_of(tag: &str) -> (&str, &str, &str, bool) {
    let (body, alone) = tag.strip_suffix('/').map_or((tag, false), |t| (t, true));
    let name = body.split(|c: char| c.is_whitespace()).next().unwrap_or("");
    let local = name.rsplit(':').next().unwrap_or(name);
    (local, name, &body[name.len()..], alone)
}

/// The elements with names, from their tags to their ends; none where nothing refers to them.
fn named(text: &str) -> Result<HashMap<&str, &str>, String> {
    let mut found = HashMap::new();
    if !text.contains("<use") && !text.contains(":use") {
        return Ok(found);
    }
    let mut open: Vec<(Option<&str>, usize)> = Vec::new();
    let mut rest = text;
    while let Some((after, tag)) = next_tag(rest)? {
        rest = after;
        let end = text.len() - after.len();
        if tag.starts_with('/') {
            if let Some((Some(id), start)) = open.pop() {
                found.entry(id).or_insert(&text[start..end]);
            }
            continue;
        }
        let (_, _, own, alone) = parts_of(tag);
        let id = attributes(own).unwrap_or_default().into_iter().find(|a| a.0 == "id").map(|a| a.1);
        let start = end - tag.len() - 2;
        match (alone, id) {
            (true, Some(id)) => {
                found.entry(id).or_insert(&text[start..end]);
            }
            (true, None) => {}
            (false, id) => open.push((id, start)),
        }
    }
    Ok(found)
}

/// The shapes that are read so far.
struct SvgReading<'a> {
    named: HashMap<&'a str, &'a str>,
    shapes: PageShapes,
    uses: usize,
}

impl<'a> SvgReading<'a> {
    /// Adds the shapes of a text, of a reference if it is not the whole; returns whether there is an svg element.
    fn elements(
        &mut self,
        text: &'a str,
        base: SvgTransform,
        depth: usize,
    ) -> Result<bool, String> {
        let mut known = depth > 0;
        let mut hidden: Vec<&str> = Vec::new();
        // The transforms of the elements around.
        let mut around: Vec<SvgTransform> = Vec::new();
        let mut rest = text;
        let mut first = depth > 0;
        while let Some((after, tag)) = next_tag(rest)? {
            rest = after;
            if let Some(name) = tag.strip_prefix('/') {
                if hidden.is_empty() {
                    around.pop();
                } else if hidden.last().is_some_and(|h| *h == name.trim()) {
                    hidden.pop();
                }
                continue;
            }
            let (local, name, own, alone) = parts_of(tag);
            known |= local == "svg";
            if !known {
                return Err("it does not begin with an svg element".into());
            }
            let seen = std::mem::take(&mut first) && local == "symbol";
            if !hidden.is_empty() || (UNSEEN.contains(&local) && !seen) {
                if !alone {
                    hidden.push(name);
                }
                continue;
            }
            let attributes = attributes(own)?;
            let value = |wanted: &str| attributes.iter().find(|a| a.0 == wanted).map(|a| a.1);
            if seen && value("viewBox").is_some() {
                self.shapes.leave_out("symbol with a viewBox");
                return Ok(known);
            }
            let outer = around.last().copied().unwrap_or(base);
            let place = match value("transform") {
                Some(text) => outer.with(text)?,
                None => outer,
            };
            if !alone {
                around.push(place);
            }
            if local == "use" {
                let [x, y] = [number("use", &attributes, "x")?, number("use", &attributes, "y")?];
                let name = value("href").or(value("xlink:href")).and_then(|t| t.strip_prefix('#'));
                let Some(part) = name.and_then(|name| self.named.get(name).copied()) else {
                    self.shapes.leave_out("use");
                    continue;
                };
                self.uses += 1;
                if self.uses > MOST_USES || depth == DEEPEST_USE {
                    return Err("elements that use others do not end".into());
                }
                let moved = SvgTransform([1.0, 0.0, 0.0, 1.0, x, y]);
                self.elements(part, place.after(moved), depth + 1)?;
                continue;
            }
            let mut own = PageShapes::default();
            match local {
                "symbol" => {}
                _ => element(local, &attributes, &mut own)?,
            }
            place.put(own, &mut self.shapes);
        }
        Ok(known)
    }
}

/// End of a tag, outside quotes.
fn tag_end(text: &str) -> Option<usize> {
    let mut quote = None;
    text.char_indices().find_map(|(k, c)| match (quote, c) {
        (None, '>') => Some(k),
        (None, '"' | '\'') => {
            quote = Some(c);
            None
        }
        (Some(q), c) if q == c => {
            quote = None;
            None
        }
        _ => None,
    })
}

fn attributes(mut text: &str) -> Result<Vec<(&str, &str)>, String> {
    let mut out = Vec::new();
    loop {
        text = text.trim_start();
        let Some(at) = text.find('=') else { return Ok(out) };
        let name = text[..at].trim();
        let value = text[at + 1..].trim_start();
        let quote = value.chars().next().filter(|c| ['"', '\''].contains(c));
        let quote = quote.ok_or_else(|| format!("the value of `{name}` has no quotes"))?;
        let end = value[1..].find(quote).ok_or("a value does not end")? + 1;
        out.push((name, &value[1..end]));
        text = &value[end + 1..];
    }
}

/// A number of an element, 0 without it.
fn number(name: &str, attributes: &[(&str, &str)], wanted: &str) -> Result<f64, String> {
    let Some((_, text)) = attributes.iter().find(|a| a.0 == wanted) else { return Ok(0.0) };
    let plain = text.trim().trim_end_matches("px");
    let x: Option<f64> = plain.parse().ok().filter(|x: &f64| x.is_finite());
    x.ok_or_else(|| format!("`{wanted}` of `{name}` is not a plain number: {text}"))
}

fn element(name: &str, attributes: &[(&str, &str)], shapes: &mut PageShapes) -> Result<(), String> {
    let text = |wanted: &str| attributes.iter().find(|a| a.0 == wanted).map(|a| a.1);
    let number = |wanted: &str| number(name, attributes, wanted);
    match name {
        "line" => {
            let ends = [[number("x1")?, -number("y1")?], [number("x2")?, -number("y2")?]];
            shapes.strokes.push(ends);
        }
        "polyline" | "polygon" => {
            let all = numbers(text("points").unwrap_or(""))?;
            let points: Vec<[f64; 2]> = all.chunks_exact(2).map(|p| [p[0], -p[1]]).collect();
            shapes.strokes.extend(points.windows(2).map(|w| [w[0], w[1]]));
            if let ([first, _, .., last], "polygon") = (&points[..], name) {
                shapes.strokes.push([*last, *first]);
            }
        }
        "rect" => {
            let [x, y] = [number("x")?, number("y")?];
            let [w, h] = [number("width")?, number("height")?];
            let radii = match (text("rx").is_some(), text("ry").is_some()) {
                (true, false) => [number("rx")?; 2],
                (false, true) => [number("ry")?; 2],
                _ => [number("rx")?, number("ry")?],
            };
            let [rx, ry] = [radii[0].min(0.5 * w), radii[1].min(0.5 * h)];
            if rx > 0.0 && ry > 0.0 {
                rounded_rectangle([x, -y - h], [w, h], [rx, ry], shapes);
                return Ok(());
            }
            let ring = [[x, -y], [x + w, -y], [x + w, -y - h], [x, -y - h]];
            shapes.strokes.extend((0..4).map(|k| [ring[k], ring[(k + 1) % 4]]));
        }
        "circle" | "ellipse" => {
            let c = [number("cx")?, -number("cy")?];
            let [a, b] = match name {
                "circle" => [number("r")?; 2],
                _ => [number("rx")?, number("ry")?],
            };
            if a > 0.0 && b > 0.0 {
                shapes.rounds.push([c, [a, 0.0], [0.0, b]]);
            }
        }
        "path" => path(text("d").unwrap_or(""), shapes)?,
        "svg" | "g" | "title" | "desc" | "a" | "style" | "switch" | "namedview" => {}
        other => shapes.leave_out(other),
    }
    Ok(())
}

/// A rectangle by its lowest corner whose corners are quarters of ellipses.
fn rounded_rectangle(
    [x, y]: [f64; 2],
    [w, h]: [f64; 2],
    [a, b]: [f64; 2],
    shapes: &mut PageShapes,
) {
    let middles = [[x + w - a, y + h - b], [x + a, y + h - b], [x + a, y + b], [x + w - a, y + b]];
    for (k, [u, v]) in middles.into_iter().enumerate() {
        let start = k as f64 * std::f64::consts::FRAC_PI_2;
        match a == b {
            true => shapes.arc([u, v], a, start, std::f64::consts::FRAC_PI_2),
            false => {
                let half = [[a, 0.0], [0.0, b]];
                shapes.elliptical([u, v], half, start, std::f64::consts::FRAC_PI_2);
            }
        }
    }
    let lines = [
        [[x + w - a, y + h], [x + a, y + h]],
        [[x, y + h - b], [x, y + b]],
        [[x + a, y], [x + w - a, y]],
        [[x + w, y + b], [x + w, y + h - b]],
    ];
    shapes.strokes.extend(lines.into_iter().filter(|[p, q]| p != q));
}

/// A path.
fn path(d: &str, shapes: &mut PageShapes) -> Result<(), String> {
    let mut at = [0.0; 2];
    let mut start = [0.0; 2];
    let mut rest = d.trim_start();
    // The last control point of a curve, which S and T mirror, and the degree of the curve.
    let mut handle: Option<([f64; 2], char)> = None;
    let line = |p: [f64; 2], q: [f64; 2], shapes: &mut PageShapes| {
        if p != q {
            shapes.strokes.push([[p[0], -p[1]], [q[0], -q[1]]]);
        }
    };
    while let Some(command) = rest.chars().next() {
        if !command.is_ascii_alphabetic() {
            return Err(format!("a path has `{command}` where a command should be"));
        }
        let body = &rest[1..];
        let end = body.find(|c: char| c.is_ascii_alphabetic() && c != 'e' && c != 'E');
        let (body, after) = body.split_at(end.unwrap_or(body.len()));
        rest = after;
        let relative = command.is_ascii_lowercase();
        let kind = command.to_ascii_uppercase();
        let count = match kind {
            'M' | 'L' | 'T' => 2,
            'H' | 'V' => 1,
            'A' => 7,
            'C' => 6,
            'S' | 'Q' => 4,
            'Z' => {
                line(at, start, shapes);
                at = start;
                handle = None;
                continue;
            }
            other => return Err(format!("a path has the unknown command {other}")),
        };
        let all = if kind == 'A' { arc_numbers(body)? } else { numbers(body)? };
        if all.is_empty() || all.len() % count != 0 {
            return Err(format!("{command} of a path has {} numbers", all.len()));
        }
        for (k, n) in all.chunks_exact(count).enumerate() {
            let base = if relative { at } else { [0.0; 2] };
            let to = match kind {
                'H' => [base[0] + n[0], at[1]],
                'V' => [at[0], if relative { at[1] + n[0] } else { n[0] }],
                _ => [base[0] + n[count - 2], base[1] + n[count - 1]],
            };
            let point = |k: usize| [base[0] + n[k], base[1] + n[k + 1]];
            let mirrored = |degree: char| match handle.filter(|h| h.1 == degree) {
                Some((h, _)) => [2.0 * at[0] - h[0], 2.0 * at[1] - h[1]],
                None => at,
            };
            let mut next = None;
            match kind {
                'M' if k == 0 => start = to,
                'M' | 'L' | 'H' | 'V' => line(at, to, shapes),
                'A' => path_arc(at, to, n, shapes),
                'C' | 'S' => {
                    let first = if kind == 'C' { point(0) } else { mirrored('C') };
                    let second = point(if kind == 'C' { 2 } else { 0 });
                    let up = |p: [f64; 2]| [p[0], -p[1]];
                    shapes.curves.push(PageCurve::Cubic([at, first, second, to].map(up)));
                    next = Some((second, 'C'));
                }
                _ => {
                    let middle = if kind == 'Q' { point(0) } else { mirrored('Q') };
                    let up = |p: [f64; 2]| [p[0], -p[1]];
                    let [p, m, q] = [at, middle, to].map(up);
                    let control = [p, mix(p, m, 2.0 / 3.0), mix(q, m, 2.0 / 3.0), q];
                    shapes.curves.push(PageCurve::Cubic(control));
                    next = Some((middle, 'Q'));
                }
            }
            handle = next;
            at = to;
        }
    }
    Ok(())
}

/// The numbers of arcs, whose flags need no blank after them.
fn arc_numbers(text: &str) -> Result<Vec<f64>, String> {
    let mut out: Vec<f64> = Vec::new();
    let mut rest = text.trim_start_matches([' ', ',', '\t', '\n', '\r']);
    while !rest.is_empty() {
        let flag = matches!(out.len() % 7, 3 | 4);
        let (word, after) = if flag {
            rest.split_at(1)
        } else {
            let mut seen = String::new();
            let end = rest.char_indices().find_map(|(k, c)| {
                let exponent = seen.ends_with(['e', 'E']);
                let stop = c.is_whitespace()
                    || c == ','
                    || (k > 0 && (c == '-' || c == '+') && !exponent)
                    || (c == '.' && seen.contains('.'));
                seen.push(c);
                stop.then_some(k)
            });
            rest.split_at(end.unwrap_or(rest.len()))
        };
        out.extend(numbers(word)?);
        rest = after.trim_start_matches([' ', ',', '\t', '\n', '\r']);
    }
    Ok(out)
}

/// An arc by its ends (SVG 1.1, appendix F.6.5).
fn path_arc(from: [f64; 2], to: [f64; 2], n: &[f64], shapes: &mut PageShapes) {
    let (rx, ry, large, positive) = (n[0].abs(), n[1].abs(), n[3] != 0.0, n[4] != 0.0);
    if from == to {
        return;
    }
    if rx == 0.0 || ry == 0.0 {
        shapes.strokes.push([[from[0], -from[1]], [to[0], -to[1]]]);
        return;
    }
    if (rx - ry).abs() > 1e-9 * rx {
        // The arc of a circle in the coordinates of the ellipse.
        let (s, c) = (libm::sin(n[2].to_radians()), libm::cos(n[2].to_radians()));
        let k = rx / ry;
        let into = |[u, v]: [f64; 2]| [c * u + s * v, k * (c * v - s * u)];
        let back = |[u, v]: [f64; 2]| [c * u - s * v / k, -(s * u + c * v / k)];
        let mut own = PageShapes::default();
        path_arc(into(from), into(to), &[rx, rx, 0.0, n[3], n[4]], &mut own);
        for (corner, radius) in own.arcs {
            let half = libm::hypot(corner[1][0] - corner[0][0], corner[1][1] - corner[0][1]);
            let corner = corner.map(|[u, v]| back([u, -v]));
            shapes.curves.push(PageCurve::Conic(corner, radius / libm::hypot(radius, half)));
        }
        return;
    }
    let chord = [to[0] - from[0], to[1] - from[1]];
    let half = 0.5 * libm::hypot(chord[0], chord[1]);
    // A radius that is too small is enlarged until the arc reaches, as the standard says.
    let radius = rx.max(half);
    let height = (radius * radius - half * half).max(0.0).sqrt() / (2.0 * half);
    let side = if large == positive { -1.0 } else { 1.0 };
    let centre = [
        0.5 * (from[0] + to[0]) - side * height * chord[1],
        0.5 * (from[1] + to[1]) + side * height * chord[0],
    ];
    let angle = |p: [f64; 2]| libm::atan2(-(p[1] - centre[1]), p[0] - centre[0]);
    // On the page v is up, so that positive angles of SVG are negative ones.
    let start = angle(from);
    let mut sweep = angle(to) - start;
    let turn = crate::format::page_shapes::TURN;
    if positive && sweep > 0.0 {
        sweep -= turn;
    } else if !positive && sweep < 0.0 {
        sweep += turn;
    }
    shapes.arc([centre[0], -centre[1]], radius, start, sweep);
}
