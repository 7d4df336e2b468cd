//! RECTANGLE, POLYGON, SLOT, CIRCLE DIAMETER: closed outlines of a cross section with their dimensions, by the commands
//! that draw them one by one.

use super::CommandError;
use super::args::Args;
use super::session::{CommandReply, SketchSession};
use super::subject::ReplySubject;
use super::{verbs, words};
use crate::format::script::quoted;
use crate::{CoordinateAxis, DimensionExpr, PointId, Reference};
use moldloft_num::Real;
use moldloft_syntax::number::plain;
use std::f64::consts::TAU;

/// Relative difference of coordinates of a polygon below which they are equal.
const LEVEL: f64 = 1e-12;

/// The corners of a polygon are at most these.
const MAX_CORNERS: u32 = 200;

/// Commands that draw a shape, and how its first point is placed.
struct SectionOutline {
    text: String,
    /// The numbers of its points, in a cycle.
    points: Vec<PointId>,
    axes: [CoordinateAxis; 2],
    /// The new numbers and what they are now.
    numbers: Vec<(String, f64)>,
}

impl SketchSession {
    /// `RECTANGLE width height`, `POLYGON n diameter`, `SLOT length width`, `CIRCLE DIAMETER d`, each with `[AT p q]`.
    pub(super) fn section_shape(
        &mut self,
        args: &mut Args,
        verb: &str,
    ) -> Result<(), CommandError> {
        let object = self.active()?.clone();
        let Some(normal) = object.drawing.section else {
            return Err(CommandError::new(
                113,
                format!("{} is not a cross section", object.name),
                "SKETCH name 2D starts one",
            )
            .about(ReplySubject::of("no-cross-section").names([&object.name])));
        };
        let units = object.units.clone();
        let units = units.as_deref();
        let corners = match verb {
            "POLYGON" => args.count("a number of corners")?,
            _ => 4,
        };
        if !(3..=MAX_CORNERS).contains(&corners) {
            let text = format!("a polygon of {corners} corners");
            return Err(CommandError::text(text, format!("give 3 to {MAX_CORNERS} corners")));
        }
        if verb == "CIRCLE" {
            args.take("DIAMETER");
        }
        let stems: &[&str] = match verb {
            "RECTANGLE" => &["WIDTH", "HEIGHT"],
            "SLOT" => &["LENGTH", "WIDTH"],
            _ => &["DIAMETER"],
        };
        let (_, layout) = self.laid_out(&object);
        let mut names: Vec<String> = Vec::new();
        let mut drawn: Vec<f64> = Vec::new();
        let mut text = String::new();
        for stem in stems {
            let value = args.value(units)?;
            let size = now(&value, &|name| self.known_number(&object, &layout, name))?;
            if !(size > 0.0 && size.is_finite()) {
                let text = format!("a {} of {}", stem.to_lowercase(), plain(size));
                return Err(CommandError::text(text, "give more than 0"));
            }
            let name = object.fresh_name(stem);
            text += &format!("VARIABLE {name} \"{}\"\n", value.text());
            drawn.push(size);
            names.push(name);
        }
        let at = match args.take_short("AT") {
            true => [args.value(units)?, args.value(units)?],
            false => [0.0; 2].map(DimensionExpr::number),
        };
        args.end()?;
        let first = object.drawing.next_point().0;
        let points: Vec<PointId> = (0..corners).map(|k| PointId(first + k)).collect();
        let numbers = names.iter().cloned().zip(drawn.iter().copied()).collect();
        let mut outline = SectionOutline { text, points, axes: normal.others(), numbers };
        // Shapes with a centre are placed by it.
        let at = match verb {
            "CIRCLE" => shifted(at, ["-0.5", "-0.5"], &names[0])?,
            "POLYGON" => shifted(at, ["+0.5", "+0"], &names[0])?,
            _ => at,
        };
        let start = self.start(&mut outline, &at)?;
        match verb {
            "POLYGON" => outline.polygon(start, drawn[0], &names[0]),
            _ => {
                let (width, height) = (&names[0], names.last().unwrap_or(&names[0]));
                let size = [drawn[0], *drawn.last().unwrap_or(&drawn[0])];
                outline.rectangle(start, size, [width, height]);
            }
        }
        let [p, q, r, s] = [0, 1, 2, 3].map(|k| outline.points[k % outline.points.len()]);
        match verb {
            "CIRCLE" => {
                let name = object.fresh_name("C");
                outline.text += &format!("CIRCLE {name} CORNER {p} {q} {s}\n");
            }
            "SLOT" => {
                let radius = format!("\"{}/2\"", names[1]);
                let end = |group: usize, k: usize| format!("END{group}_{k}");
                let free = |group: &usize| (1..=4).all(|k| !object.has_name(&end(*group, k)));
                let group = (1..).find(free).unwrap_or(1);
                for (k, [m, a, b]) in
                    [[p, s, q], [q, p, r], [r, q, s], [s, r, p]].into_iter().enumerate()
                {
                    let name = end(group, k + 1);
                    outline.text += &format!("ARC {name} CORNER {m} {a} {b} RADIUS {radius}\n");
                }
            }
            _ => {}
        }
        let outer = std::mem::take(&mut self.out);
        let done = outline.text.lines().try_for_each(|line| self.subcommand(line));
        self.out = outer;
        done?;
        let list =
            |ids: &[PointId]| ids.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
        self.out.push(CommandReply::note(format!(
            "{verb}: points {}, {}",
            list(&outline.points),
            names.join(" ")
        )));
        Ok(())
    }

    /// The page coordinates of a shape's first point, which `at` places from the origin. The first shape of a section
    /// has the reference point, the others are dimensioned from it.
    fn start(
        &mut self,
        outline: &mut SectionOutline,
        at: &[DimensionExpr; 2],
    ) -> Result<[f64; 2], CommandError> {
        let object = self.active()?.clone();
        let first = outline.points[0];
        let (_, layout) = self.laid_out(&object);
        let own = |name: &str| {
            outline.numbers.iter().find(|n| n.0.eq_ignore_ascii_case(name)).map(|n| n.1)
        };
        let known = |name: &str| own(name).or_else(|| self.known_number(&object, &layout, name));
        let place = [now(&at[0], &known)?, now(&at[1], &known)?];
        let Some(reference) = object.reference() else {
            let mut xyz = [0.0; 3].map(DimensionExpr::number);
            for (axis, e) in outline.axes.into_iter().zip(at) {
                xyz[axis.index()] = e.clone();
            }
            let placed = Reference { point: first, at: xyz };
            if placed != Reference::number(first, [0.0; 3]) {
                let at = placed.at.each_ref().map(|e| quoted(e.text()));
                outline.text += &format!("REFERENCE {first} {}\n", at.join(" "));
            }
            return Ok(place);
        };
        let origin = object.drawing.points[&reference.point];
        let mut page = [origin.u, origin.v];
        for (k, axis) in outline.axes.into_iter().enumerate() {
            let from = &reference.at[axis.index()];
            let by = place[k] - now(from, &known)?;
            let text = match from.literal() {
                Some(0.0) => at[k].text().to_owned(),
                Some(_) | None => format!("({})-({from})", at[k]),
            };
            page[k] += by;
            let point = reference.point;
            let fixed = at[k].literal().is_some() && from.literal().is_some();
            outline.text += &if by == 0.0 && fixed {
                format!("ALIGN {axis} {point} {first}\n")
            } else if by < 0.0 {
                format!("DIMENSION {axis} {first} {point} \"-({text})\"\n")
            } else {
                format!("DIMENSION {axis} {point} {first} \"{text}\"\n")
            };
        }
        Ok(page)
    }

    /// Runs one command as a part of another.
    fn subcommand(&mut self, line: &str) -> Result<(), CommandError> {
        for command in words::parse(line, None).commands {
            let command = command?;
            let (verb, _) = verbs::find(&command.tokens[0].text)?;
            self.dispatch(verb, &command)?;
        }
        Ok(())
    }
}

/// The value of an expression, by the numbers that are known.
fn now(e: &DimensionExpr, known: &dyn Fn(&str) -> Option<f64>) -> Result<f64, CommandError> {
    e.eval(&known).map_err(|no| {
        CommandError::text(
            format!("{e} reads {}, which has no value", no.name),
            format!("VARIABLE {} defines it", no.name),
        )
    })
}

/// Coordinates shifted by multiples of a number.
fn shifted(
    at: [DimensionExpr; 2],
    shares: [&str; 2],
    name: &str,
) -> Result<[DimensionExpr; 2], CommandError> {
    let [p, q] = at;
    let moved = |e: DimensionExpr, share: &str| match share {
        "+0" => Ok(e),
        _ => DimensionExpr::parse(&format!("({}){share}*{name}", e.text()))
            .map_err(|why| CommandError::text(why.to_string(), "give numbers")),
    };
    Ok([moved(p, shares[0])?, moved(q, shares[1])?])
}

impl SectionOutline {
    fn draw(&mut self, page: &[[f64; 2]], types: impl Fn(usize) -> String) {
        let mut points = String::new();
        for (id, [u, v]) in self.points.iter().zip(page) {
            points += &format!("POINT {id} {} {}\n", plain(*u), plain(*v));
        }
        // Points come before what places the first of them.
        self.text.insert_str(0, &points);
        let n = self.points.len();
        for k in 0..n {
            let (p, q) = (self.points[k], self.points[(k + 1) % n]);
            self.text += &format!("LINE FROM {p} TO {q} TYPE {}\n", types(k));
        }
    }

    fn rectangle(&mut self, [u, v]: [f64; 2], [w, h]: [f64; 2], names: [&String; 2]) {
        let axes = self.axes;
        let page = [[u, v], [u + w, v], [u + w, v + h], [u, v + h]];
        self.draw(&page, |k| axes[k % 2].to_string());
        let [p, q, _, s] = [0, 1, 2, 3].map(|k| self.points[k]);
        self.text += &format!("DIMENSION {} {p} {q} \"{}\"\n", axes[0], names[0]);
        self.text += &format!("DIMENSION {} {p} {s} \"{}\"\n", axes[1], names[1]);
    }

    /// Regular, the first corner in the direction of the first axis from its centre.
    fn polygon(&mut self, [u, v]: [f64; 2], diameter: f64, name: &str) {
        let n = self.points.len();
        let corner = |k: usize| {
            let angle = TAU * k as f64 / n as f64;
            let (s, c) = (Real::sin(angle), Real::cos(angle));
            [0.5 * c - 0.5, 0.5 * s]
        };
        let page: Vec<[f64; 2]> =
            (0..n).map(corner).map(|[x, y]| [u + diameter * x, v + diameter * y]).collect();
        self.draw(&page, |_| "F".to_owned());
        let first = self.points[0];
        for k in 1..n {
            let point = self.points[k];
            for (axis, share) in self.axes.into_iter().zip(corner(k)) {
                self.text += &match share {
                    x if x.abs() < LEVEL => format!("ALIGN {axis} {first} {point}\n"),
                    x if x > 0.0 => {
                        format!("DIMENSION {axis} {first} {point} \"{name}*{x:?}\"\n")
                    }
                    x => format!("DIMENSION {axis} {point} {first} \"{name}*{:?}\"\n", -x),
                };
            }
        }
    }
}
