//! Outlines of texts, as closed curves.

use crate::functions::run_call::RunCall;
use crate::run::interpreter::Interpreter;
use moldloft_diag::Diagnostic;
use moldloft_font::{Bezier, Font, HorizontalAlign, OutlineLoop, TextLayout, font_file};
use moldloft_num::Vec3;
use moldloft_registry::{CurveRef, Scalar, Value};
use moldloft_spline::{BSplineCurve, KnotVector};

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// The outlines of a text in the plane z = 0, with capitals of a height.
    pub(crate) fn text_outlines(&mut self, call: &RunCall<'_>) -> Result<Value<T>, Diagnostic> {
        let m = call.m;
        let text = self.text(m, call.first())?;
        let argument = call.at(1).unwrap_or(call.first());
        let name = self.text(m, argument)?;
        let size = match call.at(2) {
            Some(size) => self.number(m, size)?,
            None => T::one(),
        };
        if size.re() <= 0.0 || !size.is_finite() {
            return Err(Diagnostic::error("out-of-range", "a text of no height")
                .expected("a size above 0")
                .found(size.re().to_string()));
        }
        let mut layout = TextLayout::default();
        if let Some(align) = call.at(3) {
            layout.horizontal = match &*self.text(m, align)? {
                "left" => HorizontalAlign::Left,
                "centre" => HorizontalAlign::Centre,
                "right" => HorizontalAlign::Right,
                other => {
                    let words = ["left", "centre", "right"];
                    return Err(Diagnostic::error("unknown-word", "no such alignment")
                        .at(m.program[align].span)
                        .expected("\"left\", \"centre\" or \"right\"")
                        .found(format!("\"{other}\""))
                        .suggest(other, words));
                }
            };
        }
        let from = self.modules.get(0).path.clone();
        let bytes = self.env.files.bytes(self.loader.world, &from, &font_file(&name));
        let bytes = bytes.map_err(|d| d.or_at(m.program[argument].span))?;
        let outlines = Font::new(&bytes, Some(&name))
            .and_then(|font| font.outlines(&text, &layout))
            .map_err(|why| Diagnostic::error("no-outlines", why.to_string()).help(why.help()))?;
        let curves =
            outlines.iter().map(|outline| curve(outline, size)).collect::<Option<Vec<_>>>();
        let curves =
            curves.ok_or_else(|| Diagnostic::error("no-outlines", "an outline is no curve"))?;
        Ok(Value::list(curves))
    }
}

/// A loop as a B-spline of degree 3 with a break at each joint.
fn curve<T: Scalar>(outline: &OutlineLoop, size: T) -> Option<Value<T>> {
    let place = |[x, y]: [f64; 2]| Vec3::new(size * x, size * y, T::zero());
    let n = outline.pieces.len();
    let mut knots = vec![0.0];
    let mut points = vec![place(outline.pieces[0].ends()[0])];
    for (k, piece) in outline.pieces.iter().enumerate() {
        knots.extend([k as f64 / n as f64; 3]);
        points.extend(cubic(piece)[1..].iter().map(|p| place(*p)));
    }
    knots.extend([1.0; 4]);
    let knots = KnotVector::new(3, knots).ok()?;
    let made = BSplineCurve::new(knots, points, None).ok()?;
    Some(Value::Curve(CurveRef::new(made, 0)))
}

/// A curve raised to degree 3.
fn cubic(piece: &Bezier) -> [[f64; 2]; 4] {
    let toward = |p: [f64; 2], q: [f64; 2], t: f64| [0, 1].map(|k| p[k] + (q[k] - p[k]) * t);
    match *piece {
        Bezier::Line([p, q]) => [p, toward(p, q, 1.0 / 3.0), toward(q, p, 1.0 / 3.0), q],
        Bezier::Quadratic([p, q, r]) => [p, toward(p, q, 2.0 / 3.0), toward(r, q, 2.0 / 3.0), r],
        Bezier::Cubic(points) => points,
    }
}
