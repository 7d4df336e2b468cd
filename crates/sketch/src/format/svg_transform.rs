//! Transforms of SVG elements (SVG 1.1, chapter 7), applied to shapes of a page.

use crate::format::page_curve::PageCurve;
use crate::format::page_shapes::PageShapes;

/// The matrix (a c e; b d f) of an element's coordinates, whose y runs down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SvgTransform(pub [f64; 6]);

impl SvgTransform {
    /// The identity transform.
    pub const NONE: SvgTransform = SvgTransform([1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);

    /// First `inner`, then this.
    pub fn after(self, inner: SvgTransform) -> SvgTransform {
        let ([a, b, c, d, e, f], [p, q, r, s, t, u]) = (self.0, inner.0);
        SvgTransform([
            a * p + c * q,
            b * p + d * q,
            a * r + c * s,
            b * r + d * s,
            a * t + c * u + e,
            b * t + d * u + f,
        ])
    }

    /// This transform followed by those of a nested attribute.
    ///
    /// # Errors
    /// A text that is not a list of transforms.
    pub fn with(self, text: &str) -> Result<SvgTransform, String> {
        let wrong = || format!("the transform `{text}` is not understood");
        let mut out = self;
        let mut rest = text.trim_start_matches(|c: char| c.is_whitespace() || c == ',');
        while !rest.is_empty() {
            let (name, after) = rest.split_once('(').ok_or_else(wrong)?;
            let (inside, after) = after.split_once(')').ok_or_else(wrong)?;
            rest = after.trim_start_matches(|c: char| c.is_whitespace() || c == ',');
            let n = numbers(inside)?;
            let turned = |degrees: f64| {
                let (s, c) = (libm::sin(degrees.to_radians()), libm::cos(degrees.to_radians()));
                SvgTransform([c, s, -s, c, 0.0, 0.0])
            };
            let moved = |x: f64, y: f64| SvgTransform([1.0, 0.0, 0.0, 1.0, x, y]);
            let next = match (name.trim(), &n[..]) {
                ("matrix", &[a, b, c, d, e, f]) => SvgTransform([a, b, c, d, e, f]),
                ("translate", &[x]) => moved(x, 0.0),
                ("translate", &[x, y]) => moved(x, y),
                ("scale", &[x]) => SvgTransform([x, 0.0, 0.0, x, 0.0, 0.0]),
                ("scale", &[x, y]) => SvgTransform([x, 0.0, 0.0, y, 0.0, 0.0]),
                ("rotate", &[angle]) => turned(angle),
                ("rotate", &[angle, x, y]) => moved(x, y).after(turned(angle)).after(moved(-x, -y)),
                ("skewX", &[angle]) => {
                    SvgTransform([1.0, 0.0, libm::tan(angle.to_radians()), 1.0, 0.0, 0.0])
                }
                ("skewY", &[angle]) => {
                    SvgTransform([1.0, libm::tan(angle.to_radians()), 0.0, 1.0, 0.0, 0.0])
                }
                _ => return Err(wrong()),
            };
            out = out.after(next);
        }
        Ok(out)
    }

    /// Adds shapes (v up), transformed. Arcs become parts of ellipses under a non-uniform scale.
    pub fn put(self, shapes: PageShapes, into: &mut PageShapes) {
        let [a, b, c, d, e, f] = self.0;
        let way = |[u, v]: [f64; 2]| [a * u - c * v, -(b * u - d * v)];
        let at = |p: [f64; 2]| {
            let [u, v] = way(p);
            [u + e, v - f]
        };
        into.strokes.extend(shapes.strokes.iter().map(|s| s.map(at)));
        let [x, y] = [libm::hypot(a, b), libm::hypot(c, d)];
        let size = x.max(y);
        let alike = (x - y).abs() <= 1e-6 * size && (a * c + b * d).abs() <= 1e-6 * size * size;
        for (points, radius) in shapes.arcs {
            match alike {
                true => into.arcs.push((points.map(at), radius * x)),
                false => {
                    let half =
                        libm::hypot(points[1][0] - points[0][0], points[1][1] - points[0][1]);
                    let weight = radius / libm::hypot(radius, half);
                    into.curves.push(PageCurve::Conic(points.map(at), weight));
                }
            }
        }
        into.curves.extend(shapes.curves.iter().map(|c| c.mapped(at)));
        let rounds = shapes.rounds.into_iter().map(|[m, p, q]| [at(m), way(p), way(q)]);
        into.rounds.extend(rounds);
        into.unit = into.unit.or(shapes.unit);
        for (kind, count) in shapes.left_out {
            *into.left_out.entry(kind).or_default() += count;
        }
    }
}

/// Numbers separated by blanks or commas, or by the sign or point of the next.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let mut out = Vec::new();
    let mut word = String::new();
    let mut flush = |word: &mut String| -> Result<(), String> {
        if !word.is_empty() {
            let x: Option<f64> = word.parse().ok().filter(|x: &f64| x.is_finite());
            out.push(x.ok_or_else(|| format!("`{word}` is not a number"))?);
            word.clear();
        }
        Ok(())
    };
    for c in text.chars() {
        let exponent = word.ends_with(['e', 'E']);
        match c {
            ',' => flush(&mut word)?,
            c if c.is_whitespace() => flush(&mut word)?,
            '+' | '-' if !exponent => {
                flush(&mut word)?;
                word.push(c);
            }
            '.' if word.contains('.') || word.contains(['e', 'E']) => {
                flush(&mut word)?;
                word.push(c);
            }
            c => word.push(c),
        }
    }
    flush(&mut word)?;
    Ok(out)
}
