//! IGES 5.3 of boundary representations: a trimmed surface (144) for each face, with curves in parameters and in
//! space, names, colours and levels; curves (126).
//!
//! Planes are written as B-spline surfaces of degree 1 round their loops, for many readers take no others as trimmed.

use crate::WriteError;
use crate::text::append;
use moldloft_brep::{Brep, BrepFace, Coedge, SurfaceShape};
use moldloft_num::{Pace, Vec3};
use moldloft_spline::nurbs::Nurbs;
use std::collections::BTreeMap;

/// Header data of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct IgesHeader<'a> {
    /// The name of the model.
    pub title: &'a str,
    /// The unit of length in metres.
    pub metres: f64,
    /// Version of the writing program.
    pub version: &'a str,
}

/// The file.
///
/// # Errors
/// As [`crate::step::write`].
pub fn write(brep: &Brep, header: &IgesHeader<'_>) -> Result<Vec<u8>, WriteError> {
    crate::step::check(brep, "iges")?;
    // Faces of IGES have no sense.
    let brep = &brep.clone().facing();
    let mut file = File::default();
    for part in &brep.parts {
        for &f in part.shells.iter().flat_map(|s| &s.faces) {
            file.face(brep, &brep.faces[f]);
        }
        for wire in &part.wires {
            let style = file.style(&wire.name, wire.colour, &wire.layers);
            file.curve(&wire.curve, true, "00000000", &style);
        }
        for point in &part.points {
            let style = file.style(&point.name, point.colour, &[]);
            let mut fields: Vec<String> = point.place.to_array().map(real).into();
            fields.push("0".into());
            file.add(116, 0, "00000000", &style, &fields);
        }
    }
    // The functions of levels: their names.
    for (k, level) in file.levels.clone().iter().enumerate() {
        let style = Style { level: k + 1, ..Style::default() };
        let fields = ["2".to_string(), "0".to_string(), string(level)];
        file.add(406, 3, "00000200", &style, &fields);
    }
    Ok(file.finished(brep, header))
}

/// Name, colour and level of an entity.
#[derive(Default)]
struct Style {
    name: usize,
    colour: usize,
    level: usize,
}

#[derive(Default)]
struct File {
    directory: String,
    parameters: String,
    /// Lines of each section.
    entries: usize,
    lines: usize,
    colours: BTreeMap<[u8; 3], usize>,
    levels: Vec<String>,
}

impl File {
    /// Adds an entity; the number of its line in the directory.
    fn add(
        &mut self,
        kind: usize,
        form: usize,
        status: &str,
        style: &Style,
        fields: &[String],
    ) -> usize {
        let number = self.entries + 1;
        let first = self.lines + 1;
        let mut text = kind.to_string();
        let mut lines = Vec::new();
        let named = [String::from("0"), String::from("1"), style.name.to_string()];
        let all = fields.iter().chain(named.iter().filter(|_| style.name > 0));
        for field in all {
            text.push(',');
            if text.len() + field.len() > 63 {
                lines.push(std::mem::take(&mut text));
            }
            text.push_str(field);
            // Strings may be longer than a line.
            while text.len() > 63 {
                let rest = text.split_off(63);
                lines.push(std::mem::replace(&mut text, rest));
            }
        }
        text.push(';');
        lines.push(text);
        for line in &lines {
            self.lines += 1;
            append(
                &mut self.parameters,
                format_args!("{line:<64} {number:>7}P{:>7}\n", self.lines),
            );
        }
        let colour = if style.colour > 0 { format!("-{}", style.colour) } else { "0".into() };
        let count = lines.len();
        append(
            &mut self.directory,
            format_args!(
                "{kind:>8}{first:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{status:>8}D{number:>7}\n",
                0, 0, style.level, 0, 0, 0
            ),
        );
        append(
            &mut self.directory,
            format_args!(
                "{kind:>8}{:>8}{colour:>8}{count:>8}{form:>8}{:>8}{:>8}{:>8}{:>8}D{:>7}\n",
                0,
                "",
                "",
                "",
                0,
                number + 1
            ),
        );
        self.entries += 2;
        number
    }

    fn style(&mut self, name: &str, colour: Option<[u8; 3]>, layers: &[String]) -> Style {
        let plain = Style::default();
        let fields = ["1".to_string(), string(name)];
        let name = self.add(406, 15, "00010200", &plain, &fields);
        let colour = colour.map_or(0, |rgb| match self.colours.get(&rgb) {
            Some(&known) => known,
            None => {
                let fields = rgb.map(|x| real(f64::from(x) / 2.55));
                let number = self.add(314, 0, "00000200", &plain, &fields);
                self.colours.insert(rgb, number);
                number
            }
        });
        let level = layers.first().map_or(0, |layer| {
            let known = self.levels.iter().position(|l| l == layer);
            1 + known.unwrap_or_else(|| {
                self.levels.push(layer.clone());
                self.levels.len() - 1
            })
        });
        Style { name, colour, level }
    }

    fn curve(&mut self, c: &Nurbs<1>, space: bool, status: &str, style: &Style) -> usize {
        let n = c.points.len();
        let [knots] = &c.knots;
        let closed = usize::from(c.points.first() == c.points.last());
        let whole = |x: usize| x.to_string();
        let mut fields = vec![whole(n - 1), whole(c.degrees[0])];
        // Only curves in parameters are known to be plane.
        let flags = [usize::from(!space), closed, usize::from(c.weights.is_none()), 0];
        fields.extend(flags.map(whole));
        fields.extend(knots.iter().map(|k| real(*k)));
        fields.extend((0..n).map(|k| real(c.weights.as_ref().map_or(1.0, |w| w[k]))));
        fields.extend(c.points.iter().flat_map(|p| p.to_array()).map(real));
        let normal = if space { 0.0 } else { 1.0 };
        fields.extend([0.0, 1.0, 0.0, 0.0, normal].map(real));
        self.add(126, 0, status, style, &fields)
    }

    fn surface(&mut self, s: &Nurbs<2>, style: &Style) -> usize {
        let [nu, nv] = s.counts();
        let whole = |x: usize| x.to_string();
        let mut fields: Vec<String> =
            [nu - 1, nv - 1, s.degrees[0], s.degrees[1]].map(whole).into();
        let closed_u = (0..nv).all(|j| s.points[j] == s.points[(nu - 1) * nv + j]);
        let closed_v = (0..nu).all(|i| s.points[i * nv] == s.points[i * nv + nv - 1]);
        let polynomial = s.weights.is_none();
        fields
            .extend([closed_u, closed_v, polynomial, false, false].map(|x| whole(usize::from(x))));
        fields.extend(s.knots.iter().flatten().map(|k| real(*k)));
        // The first index runs fastest.
        let order: Vec<usize> = (0..nv).flat_map(|j| (0..nu).map(move |i| i * nv + j)).collect();
        fields.extend(order.iter().map(|&k| real(s.weights.as_ref().map_or(1.0, |w| w[k]))));
        fields.extend(order.iter().flat_map(|&k| s.points[k].to_array()).map(real));
        fields.extend([0.0, 1.0, 0.0, 1.0].map(real));
        self.add(128, 0, "00010000", style, &fields)
    }

    fn face(&mut self, brep: &Brep, face: &BrepFace) {
        let style = self.style(&face.name, face.colour, &face.layers);
        let plain =
            Style { name: 0, ..Style { colour: style.colour, level: style.level, name: 0 } };
        let flat;
        let (surface, frame) = match &face.surface {
            SurfaceShape::Nurbs(surface) => (&**surface, None),
            SurfaceShape::Plane { origin, normal, axis } => {
                let made = rectangle(brep, face, *origin, *normal, *axis);
                flat = made.0;
                (&flat, Some(made.1))
            }
            // Cylinders, cones, spheres and tori; their curves are in space alone.
            _ => {
                let Some(made) = brep.nurbs(face) else { return };
                flat = made;
                (&flat, None)
            }
        };
        let mut bounds = Vec::new();
        let number = self.surface(surface, &plain);
        if let [cycle] = &face.loops[..]
            && doubly_closed(cycle)
        {
            // The loop consists of two seams alone: the face is all of the surface.
            let fields = [number, 0, 0, 0].map(|x| x.to_string());
            self.add(144, 0, "00000000", &style, &fields);
            return;
        }
        for cycle in &face.loops {
            let (mut inner, mut outer) = (Vec::new(), Vec::new());
            for side in cycle {
                let curve = &brep.edges[side.edge].curve;
                let curve = if side.forward { curve.clone() } else { curve.reversed() };
                outer.push(self.curve(&curve, true, "00010000", &Style::default()));
                if let Some(trace) = traced(side, &curve, frame.as_ref()) {
                    inner.push(self.curve(&trace, false, "00010500", &Style::default()));
                }
            }
            let space = self.chain(&outer, "00010000");
            let own = if inner.len() == outer.len() { self.chain(&inner, "00010500") } else { 0 };
            // 1: the curve in parameters is the better one; 2: that in space is.
            let better = if own > 0 { 1 } else { 2 };
            let fields = [1, number, own, space, better].map(|x: usize| x.to_string());
            bounds.push(self.add(142, 0, "00010000", &Style::default(), &fields));
        }
        let holes = bounds.len().saturating_sub(1);
        let mut fields = vec![number.to_string(), "1".into(), holes.to_string()];
        fields.extend(bounds.iter().map(usize::to_string));
        if !bounds.is_empty() {
            self.add(144, 0, "00000000", &style, &fields);
        }
    }

    /// One curve, or several as a composite one.
    fn chain(&mut self, curves: &[usize], status: &str) -> usize {
        if let [only] = curves {
            return *only;
        }
        let mut fields = vec![curves.len().to_string()];
        fields.extend(curves.iter().map(usize::to_string));
        self.add(102, 0, status, &Style::default(), &fields)
    }

    fn finished(self, brep: &Brep, header: &IgesHeader<'_>) -> Vec<u8> {
        const UNITS: [(f64, usize, &str); 5] = [
            (1.0, 6, "M"),
            (1e-2, 10, "CM"),
            (1e-3, 2, "MM"),
            (0.3048, 4, "FT"),
            (0.0254, 1, "IN"),
        ];
        let near = |u: &&(f64, usize, &str)| (u.0 - header.metres).abs() < 1e-9 * u.0;
        let (_, flag, unit) = UNITS.iter().find(near).unwrap_or(&UNITS[0]);
        let most = |p: &Vec3| p.to_array().iter().fold(0.0f64, |m, x| m.max(x.abs()));
        let size = brep.vertices.iter().map(most).fold(0.0, f64::max);
        let mut out = String::new();
        let error =
            if brep.exact() { "exact".into() } else { format!("within {}", real(brep.error())) };
        let start = format!("{}, surfaces {error}", ascii(header.title));
        let mut starts = 0;
        let letters: Vec<char> = start.chars().collect();
        for line in letters.chunks(72) {
            starts += 1;
            let line: String = line.iter().collect();
            append(&mut out, format_args!("{line:<72}S{starts:>7}\n"));
        }
        let version = format!("moldloft {}", header.version);
        // No time: the same model gives the same bytes.
        let time = "15H19700101.000000";
        let fields = [
            "1H,".into(),
            "1H;".into(),
            string(header.title),
            string(&format!("{}.igs", header.title)),
            string("moldloft"),
            string(&version),
            "32,38,6,308,15".into(),
            string(header.title),
            "1.".into(),
            flag.to_string(),
            string(unit),
            "1".into(),
            real(1e-3 * size),
            time.into(),
            real((1.5 * brep.gap).max(1e-9 * size)),
            real(size),
            "0H".into(),
            "0H".into(),
            "11".into(),
            "0".into(),
            time.into(),
        ];
        let fields = fields.map(|f: String| if f == "0H" { String::new() } else { f });
        let (mut text, mut globals) = (String::new(), 0);
        for (k, field) in fields.iter().enumerate() {
            if text.len() + field.len() > 70 {
                globals += 1;
                append(&mut out, format_args!("{text:<72}G{globals:>7}\n"));
                text.clear();
            }
            text.push_str(field);
            text.push(if k + 1 == fields.len() { ';' } else { ',' });
            while text.len() > 72 {
                let rest = text.split_off(72);
                globals += 1;
                append(&mut out, format_args!("{text:<72}G{globals:>7}\n"));
                text = rest;
            }
        }
        globals += 1;
        append(&mut out, format_args!("{text:<72}G{globals:>7}\n"));
        out.push_str(&self.directory);
        out.push_str(&self.parameters);
        let (d, p) = (self.entries, self.lines);
        append(
            &mut out,
            format_args!("S{starts:>7}G{globals:>7}D{d:>7}P{p:>7}{:40}T{:>7}\n", "", 1),
        );
        out.into_bytes()
    }
}

/// True for a loop each of whose edges has two sides.
fn doubly_closed(cycle: &[Coedge]) -> bool {
    cycle.iter().all(|a| cycle.iter().filter(|b| a.edge == b.edge).count() == 2)
}

/// A frame of a plane: origin, two axes and their lengths.
struct PlaneFrame {
    origin: Vec3,
    axes: [Vec3; 2],
}

impl PlaneFrame {
    /// A curve in the plane in the parameters of its rectangle.
    fn trace(&self, c: &Nurbs<1>) -> Nurbs<1> {
        let place = |&p: &Vec3| {
            let d = p - self.origin;
            let [u, v] = self.axes.map(|a| d.dot(a) / a.norm_sq());
            Vec3::of(u, v, 0.0)
        };
        Nurbs { points: c.points.iter().map(place).collect(), ..c.clone() }
    }
}

/// The rectangle round the loops of a plane face.
fn rectangle(
    brep: &Brep,
    face: &BrepFace,
    origin: Vec3,
    normal: Vec3,
    axis: Vec3,
) -> (Nurbs<2>, PlaneFrame) {
    let other = normal.cross(axis);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for side in face.loops.iter().flatten() {
        for &p in &brep.edges[side.edge].curve.points {
            for (k, a) in [axis, other].into_iter().enumerate() {
                let x = (p - origin).dot(a);
                low[k] = low[k].min(x);
                high[k] = high[k].max(x);
            }
        }
    }
    let corner = origin + axis * low[0] + other * low[1];
    let axes = [axis * (high[0] - low[0]), other * (high[1] - low[1])];
    let points = vec![corner, corner + axes[1], corner + axes[0], corner + axes[0] + axes[1]];
    let knots = vec![0.0, 0.0, 1.0, 1.0];
    let surface = Nurbs {
        degrees: [1, 1],
        knots: [knots.clone(), knots],
        points,
        weights: None,
        error: 0.0,
        exact: true,
        paces: [Pace::Even; 2],
    };
    (surface, PlaneFrame { origin: corner, axes })
}

/// A side's curve in parameters, in the direction of the loop; `None` if its parametrisation
/// differs from that of the curve in space, since readers compare both at equal parameters.
fn traced(side: &Coedge, curve: &Nurbs<1>, flat: Option<&PlaneFrame>) -> Option<Nurbs<1>> {
    match flat {
        Some(flat) => Some(flat.trace(curve)),
        None => {
            let trace = side.trace.as_ref().filter(|_| side.alike)?;
            Some(if side.forward { trace.clone() } else { trace.reversed() })
        }
    }
}

/// A number with a point.
fn real(x: f64) -> String {
    let text = format!("{:?}", x + 0.0);
    match text.split_once('e') {
        Some((digits, exponent)) if digits.contains('.') => format!("{digits}E{exponent}"),
        Some((digits, exponent)) => format!("{digits}.E{exponent}"),
        None => text.strip_suffix(".0").map_or(text.clone(), |whole| format!("{whole}.")),
    }
}

/// Plain ASCII: other letters become question marks.
fn ascii(words: &str) -> String {
    words.chars().map(|c| if (' '..='~').contains(&c) { c } else { '?' }).collect()
}

/// A string with its length before it.
fn string(words: &str) -> String {
    let words = ascii(words);
    if words.is_empty() { "1H?".into() } else { format!("{}H{words}", words.len()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moldloft_brep::{Part, Wire};

    #[test]
    fn lines_have_eighty_columns_and_counts_agree() {
        let curve = Nurbs {
            degrees: [1],
            knots: [vec![0.0, 0.0, 1.0, 1.0]],
            points: vec![Vec3::of(0.1, 0.2, 0.3), Vec3::of(1e-7, 2.0, 1e20)],
            weights: None,
            error: 0.0,
            exact: true,
            paces: [Pace::Even],
        };
        let name =
            "a name of more than sixty-four letters, so that it runs over the end of its line"
                .into();
        let wire = Wire { name, colour: Some([255, 0, 51]), layers: vec!["keel".into()], curve };
        let part = Part { name: "part".into(), wires: vec![wire], ..Part::default() };
        let brep = Brep { parts: vec![part], ..Brep::default() };
        let header = IgesHeader { title: "größe", metres: 0.001, version: "0" };
        let text = String::from_utf8(write(&brep, &header).unwrap()).unwrap();
        assert!(text.lines().all(|line| line.len() == 80), "{text}");
        let count =
            |letter: char| text.lines().filter(|l| l.chars().nth(72) == Some(letter)).count();
        let last = text.lines().last().unwrap();
        assert!(last.starts_with(&format!(
            "S{:>7}G{:>7}D{:>7}P{:>7}",
            count('S'),
            count('G'),
            8,
            count('P')
        )));
        assert!(text.contains("314,100.,0.,20.;") && text.contains("2,2HMM,"));
        // The name of the level of the wire.
        assert!(text.contains("406,2,0,4Hkeel;"));
    }
}
