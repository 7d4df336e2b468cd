//! Splines through arrays of points: `pcurve` and `psurface`.

use crate::value::{Points, VectorGrid};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, FieldId, Kind, Scalar, SurfaceRef, Value,
};
use moldloft_spline::{
    ByArclen, End, Ends, GridSpline, InterpolatingSpline, InterpolationError, Parametrization,
    PiecewiseCubic, curvature_breaks,
};
use std::sync::Arc;

/// The error of a spline through the points of an argument, with the end conditions of another;
/// `of` names a point there.
pub fn fault(error: InterpolationError, of: &str, [points, ends]: [FieldId; 2]) -> CallError {
    match error {
        InterpolationError::Coincident { first, second } => {
            let (a, b) = (first + 1, second + 1);
            CallError::new("coincident-points", format!("{of}s {a} and {b} coincide"))
                .expected("distinct neighbouring points")
                .found(format!("no distance between {of}s {a} and {b}"))
                .help(format!("remove {of} {b}, or use the basis \"index\""))
                .in_item(second)
                .in_field(points)
        }
        InterpolationError::TooFew { expected, actual } => CallError::new(
            "too-few-items",
            format!("a spline needs {expected} {of}s, found {actual}"),
        )
        .expected(format!("at least {expected} {of}s"))
        .found(actual.to_string())
        .in_field(points),
        InterpolationError::NotFinite { index } => {
            CallError::new("not-finite", error.to_string()).in_item(index).in_field(points)
        }
        InterpolationError::NotClosed { gap } => CallError::new("not-closed", error.to_string())
            .expected(format!("the first {of} again as the last"))
            .found(format!("a gap of {gap}"))
            .help(format!("repeat the first {of} at the end"))
            .in_field(ends),
        InterpolationError::Type { .. } | InterpolationError::Knots { .. } => {
            CallError::new("no-spline", error.to_string())
        }
    }
}

/// The conditions by the names of the language.
const ENDS: &str = "\"natural\", \"quadratic\", \"specified\", \"notaknot\", \"bessel\" or \
                    \"periodic\", or two of them such as \"natural,specified\"";

/// Condition at one end, before its slope is computed.
#[derive(Clone, Copy, PartialEq)]
enum EndCondition {
    Natural,
    Quadratic,
    Specified,
    NotAKnot,
    Bessel,
    Periodic,
}

fn unknown(word: &str, field: FieldId, what: &str, expected: &str) -> CallError {
    CallError::new("unknown-word", format!("unknown {what} \"{word}\""))
        .expected(expected)
        .found(format!("\"{word}\""))
        .in_field(field)
}

fn name(word: &str, field: FieldId) -> Result<EndCondition, CallError> {
    Ok(match word {
        "natural" => EndCondition::Natural,
        "quadratic" => EndCondition::Quadratic,
        "specified" | "clamped" => EndCondition::Specified,
        "notaknot" | "not-a-knot" => EndCondition::NotAKnot,
        "bessel" => EndCondition::Bessel,
        "periodic" | "closed" => EndCondition::Periodic,
        _ => return Err(unknown(word, field, "end condition", ENDS)),
    })
}

/// The conditions at both ends.
fn names(text: &str, field: FieldId) -> Result<[EndCondition; 2], CallError> {
    let words: Vec<&str> = text.split(',').map(str::trim).collect();
    let pair = match words[..] {
        [one] => [name(one, field)?; 2],
        [start, end] => [name(start, field)?, name(end, field)?],
        _ => return Err(unknown(text, field, "pair of end conditions", ENDS)),
    };
    if (pair[0] == EndCondition::Periodic) != (pair[1] == EndCondition::Periodic) {
        return Err(CallError::new("unknown-word", "a spline is periodic at both ends or at none")
            .expected("\"periodic\" alone")
            .found(format!("\"{text}\""))
            .in_field(field));
    }
    Ok(pair)
}

fn condition<T>(name: EndCondition, slope: Vec3<T>) -> End<T> {
    match name {
        EndCondition::Natural => End::Natural,
        EndCondition::Specified => End::Clamped(slope),
        EndCondition::NotAKnot => End::NotAKnot,
        EndCondition::Bessel => End::Bessel,
        // Periodic splines are distinguished before.
        EndCondition::Quadratic | EndCondition::Periodic => End::Quadratic,
    }
}

#[derive(Clone, Copy, PartialEq)]
struct SplineParametrization {
    law: Parametrization,
    by_arclen: bool,
    breaks: bool,
}

fn basis(word: &str, field: FieldId) -> Result<SplineParametrization, CallError> {
    let plain = |law| SplineParametrization { law, by_arclen: false, breaks: false };
    Ok(match word.replace(' ', "").as_str() {
        "arc" | "chord" => plain(Parametrization::Chord),
        "index" => plain(Parametrization::Index),
        "centripetal" => plain(Parametrization::Centripetal),
        "arclen" => SplineParametrization { by_arclen: true, ..plain(Parametrization::Chord) },
        "arclen+breaks" => {
            SplineParametrization { by_arclen: true, breaks: true, ..plain(Parametrization::Chord) }
        }
        "arc+breaks" | "chord+breaks" => {
            SplineParametrization { breaks: true, ..plain(Parametrization::Chord) }
        }
        _ => {
            let expected = "\"arc\" (chords), \"index\", \"centripetal\", \"arclen\", \
                            \"arclen+breaks\" or \"arc+breaks\"";
            return Err(unknown(word, field, "basis", expected));
        }
    })
}

/// The cubic spline through the points of a curve, as a pcurve.
///
/// `ends` gives the end conditions: "natural" (zero second derivative), "quadratic" (the end piece
/// is a parabola), "specified" (the tangents `t1`, `t2`), "notaknot", "bessel", "periodic"; or one
/// of each as "natural,specified". `basis` is the parameter: "arc", the cumulative chord over the
/// whole; "index"; "centripetal"; "arclen", the true arc length; "arclen+breaks", true arc length
/// of splines that end at jumps of curvature, which a plain spline rounds off. The curve
/// interpolates every point, the two ends exactly.
///
/// Tangents are dr/ds for the length-like bases and dr/d(index) for "index". Jumps of curvature are
/// detected from the points: the curvatures of circles through three neighbours, extrapolated from
/// both sides, differ there by a quarter or more. `breaks` gives them by indices of points instead.
#[derive(Kind)]
#[kind(
    class = Curve,
    function,
    name = "makecc",
    example = "Line l({0, 0, 0}, {1, 2, 0}); curve c = distc(l, uniform(0, 1, 9)); \
               pcurve p = makecc(c, \"quadratic\", \"arc\"); curve d = distc(p, cosine(0, 1, 20));"
)]
pub struct Makecc<T: Scalar> {
    /// The points, two or more.
    curve: Points<T>,
    /// End conditions: "natural", "quadratic", "specified", "notaknot", "bessel" or "periodic".
    #[field(default = "quadratic")]
    ends: Arc<str>,
    /// The parameter: "arc", "index", "centripetal", "arclen", "arclen+breaks" or "arc+breaks".
    #[field(default = "arc")]
    basis: Arc<str>,
    /// Tangent at the start, for "specified".
    t1: Option<Vec3<T>>,
    /// Tangent at the end, for "specified".
    t2: Option<Vec3<T>>,
    /// Indices of the points at which the spline is split; default: detected.
    #[field(min = 1)]
    breaks: Option<Vec<usize>>,
}

impl<T: Scalar> Build<T> for Makecc<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let points = self.curve.0;
        let ends = names(&self.ends, Self::ENDS)?;
        let basis = basis(&self.basis, Self::BASIS)?;
        let tangents = [self.t1, self.t2];
        for (k, (end, tangent)) in ends.iter().zip(&tangents).enumerate() {
            let (which, field) = (["start", "end"][k], [Self::T1, Self::T2][k]);
            match (*end == EndCondition::Specified, tangent) {
                (true, None) => {
                    return Err(CallError::new(
                        "missing-argument",
                        format!("the tangent at the {which} is specified, but not given"),
                    )
                    .expected(format!("t{} = {{x, y, z}}", k + 1))
                    .help("makecc(c, \"specified\", \"arc\", t1, t2): dr/ds at both ends")
                    .help("\"quadratic\" ends need no tangents")
                    .in_field(field));
                }
                (false, Some(_)) => {
                    return Err(CallError::new(
                        "unused-argument",
                        format!("a tangent is given, but the {which} is not \"specified\""),
                    )
                    .expected("\"specified\" in `ends`")
                    .found(format!("\"{}\"", self.ends))
                    .in_field(field));
                }
                _ => {}
            }
        }
        let splits = splits(&points, basis, ends[0] == EndCondition::Periodic, self.breaks)?;
        let mut parts: Vec<PiecewiseCubic<T>> = Vec::with_capacity(splits.len() - 1);
        for (k, w) in splits.windows(2).enumerate() {
            let piece = &points[w[0]..=w[1]];
            let knots = basis
                .law
                .knots(piece)
                .map_err(|error| shifted(error, w[0], [Self::CURVE, Self::ENDS]))?;
            let end = |at: usize, outer: bool| {
                let name = if outer { ends[at] } else { inner(ends[at]) };
                condition(name, slope(basis.law, piece, &knots, at, tangents[at]))
            };
            let ends = match ends[0] {
                EndCondition::Periodic => Ends::Periodic,
                _ => Ends::Open(end(0, k == 0), end(1, k + 2 == splits.len())),
            };
            let spline = InterpolatingSpline::with_knots(&knots, piece, ends);
            let spline = spline.map_err(|error| shifted(error, w[0], [Self::CURVE, Self::ENDS]))?;
            if splits.len() == 2 && !basis.by_arclen {
                return Ok(Value::Curve(CurveRef::new(spline, 0)));
            }
            parts.push(spline.pieces().clone());
        }
        if !basis.by_arclen {
            return Ok(Value::Curve(CurveRef::new(
                joined(basis.law, &points, &splits, &parts)?,
                0,
            )));
        }
        let curve = ByArclen::of(parts).ok_or_else(|| {
            CallError::new("coincident-points", "the curve has no length").in_field(Self::CURVE)
        })?;
        Ok(Value::Curve(CurveRef::new(curve, 0)))
    }
}

/// The condition at a break, whose sides are independent.
fn inner(outer: EndCondition) -> EndCondition {
    if outer == EndCondition::NotAKnot { EndCondition::NotAKnot } else { EndCondition::Quadratic }
}

/// dC/dt at an end from the specified tangent.
fn slope<T: Real>(
    law: Parametrization,
    points: &[Vec3<T>],
    knots: &[T],
    at: usize,
    tangent: Option<Vec3<T>>,
) -> Vec3<T> {
    let Some(tangent) = tangent else { return Vec3::zero() };
    let n = points.len();
    let (a, b) = if at == 0 { (0, 1) } else { (n - 2, n - 1) };
    let gap = knots[b] - knots[a];
    // dr/dt = dr/ds ds/dt, with ds/dt from the chord of the end interval.
    let step = if law == Parametrization::Index { T::one() } else { points[a].distance(points[b]) };
    tangent * (step / gap)
}

fn shifted(error: InterpolationError, by: usize, fields: [FieldId; 2]) -> CallError {
    let error = match error {
        InterpolationError::Coincident { first, second } => {
            InterpolationError::Coincident { first: first + by, second: second + by }
        }
        InterpolationError::NotFinite { index } => {
            InterpolationError::NotFinite { index: index + by }
        }
        other => other,
    };
    fault(error, "point", fields)
}

/// The indices, from 0, of the ends of the pieces.
fn splits<T: Scalar>(
    points: &[Vec3<T>],
    basis: SplineParametrization,
    periodic: bool,
    given: Option<Vec<usize>>,
) -> Result<Vec<usize>, CallError> {
    let n = points.len();
    if n < 2 {
        return Err(fault(
            InterpolationError::TooFew { expected: 2, actual: n },
            "point",
            [Makecc::<T>::CURVE, Makecc::<T>::ENDS],
        ));
    }
    let mut all = vec![0];
    match given {
        Some(_) if !basis.breaks => {
            return Err(CallError::new(
                "unused-argument",
                "breaks are given, but the basis has none",
            )
            .expected("the basis \"arclen+breaks\" or \"arc+breaks\"")
            .in_field(Makecc::<T>::BREAKS));
        }
        Some(given) => {
            for (k, index) in given.into_iter().enumerate() {
                let last = all[all.len() - 1];
                // Index 1 is the start.
                if index < last + 2 || index >= n {
                    let message = format!("point {index} cannot be a break");
                    return Err(CallError::new("out-of-range", message)
                        .expected(format!("ascending indices from 2 to {}", n - 1))
                        .found(index.to_string())
                        .in_item(k)
                        .in_field(Makecc::<T>::BREAKS));
                }
                all.push(index - 1);
            }
        }
        None if basis.breaks => {
            let plain: Vec<Vec3> = points.iter().map(|p| p.re()).collect();
            all.extend(curvature_breaks(&plain));
        }
        None => {}
    }
    if periodic && all.len() > 1 {
        return Err(CallError::new("no-spline", "a periodic spline has no breaks")
            .expected("open ends, such as \"quadratic\"")
            .found(format!("a break at point {}", all[1] + 1))
            .in_field(Makecc::<T>::ENDS));
    }
    all.push(n - 1);
    Ok(all)
}

/// The parts as one curve, their parameters in proportion to the knots of all points.
fn joined<T: Scalar>(
    law: Parametrization,
    points: &[Vec3<T>],
    splits: &[usize],
    parts: &[PiecewiseCubic<T>],
) -> Result<PiecewiseCubic<T>, CallError> {
    let knots = law
        .knots(points)
        .map_err(|error| shifted(error, 0, [Makecc::<T>::CURVE, Makecc::<T>::ENDS]))?;
    let mut coefficients = Vec::with_capacity(points.len());
    for (w, part) in splits.windows(2).zip(parts) {
        let shrink = T::one() / (knots[w[1]] - knots[w[0]]);
        for &[a, b, c, d] in &part.coefficients()[..w[1] - w[0]] {
            let (one, two) = (shrink, shrink * shrink);
            coefficients.push([a, b * one, c * two, d * (two * one)]);
        }
    }
    Ok(PiecewiseCubic::of_pieces(&knots, &coefficients, points[points.len() - 1]))
}

/// The polyline through the points of a curve, as a pcurve.
#[derive(Kind)]
#[kind(
    class = Curve,
    function,
    name = "makelc",
    example = "Line l({0, 0, 0}, {1, 2, 0}); curve c = distc(l, uniform(0, 1, 9)); \
               pcurve p = makelc(c, \"arc\"); vector q = evalc(p, 0.25);"
)]
pub struct Makelc<T: Scalar> {
    /// The points, two or more.
    curve: Points<T>,
    /// The parameter: "arc" (true arc length here), "index" or "centripetal".
    #[field(default = "arc")]
    basis: Arc<str>,
}

impl<T: Scalar> Build<T> for Makelc<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let points = self.curve.0;
        let law = basis(&self.basis, Self::BASIS)?.law;
        let knots =
            law.knots(&points).map_err(|error| shifted(error, 0, [Self::CURVE, Self::BASIS]))?;
        let line = |k: usize| {
            let slope = (points[k + 1] - points[k]) / (knots[k + 1] - knots[k]);
            [points[k], slope, Vec3::zero(), Vec3::zero()]
        };
        let pieces: Vec<_> = (0..points.len() - 1).map(line).collect();
        let curve = PiecewiseCubic::of_pieces(&knots, &pieces, points[points.len() - 1]);
        Ok(Value::Curve(CurveRef::new(curve, 0)))
    }
}

fn knots_of<T: Scalar>(
    net: &VectorGrid<T>,
    word: &str,
    [points, field]: [FieldId; 2],
) -> Result<[Vec<T>; 2], CallError> {
    let basis = basis(word, field)?;
    if basis.by_arclen || basis.breaks {
        return Err(unknown(
            word,
            field,
            "basis of a surface",
            "\"arc\", \"index\" or \"centripetal\"",
        )
        .help("the lines of a surface share their parameters, which are means over all lines"));
    }
    let knots = |axis: usize| {
        basis
            .law
            .averaged(net.m, net.n, &net.points, axis)
            .map_err(|error| surface_fault(error, axis, points))
    };
    Ok([knots(0)?, knots(1)?])
}

fn surface_fault(error: InterpolationError, axis: usize, points: FieldId) -> CallError {
    let line = ["line s[i,]", "line s[,j]"][axis];
    fault(error, line, [points, points])
}

/// The bicubic spline surface through the points of a surface, as a psurface, with u along the
/// first index and v along the second.
///
/// `ends` as for `makecc`, without "specified"; `ends_v` for the lines along the second index. Parameters
/// are means over the lines: "arc" chords, "index" or "centripetal". Lines that are one point (a nose,
/// a tail) are allowed.
#[derive(Kind)]
#[kind(
    class = Surface,
    function,
    name = "makecs",
    example = "Line l({0, 0, 0}, {1, 2, 0}); curve c = distc(l, uniform(0, 1, 5)); surface s[5,4]; \
               for (j = 1:4) s[,j] = c + {0, 0, 1} * j; \
               psurface p = makecs(s, \"natural\", \"arc\"); vector q = evals(p, 0.5, 0.25);"
)]
pub struct Makecs<T: Scalar> {
    /// The points.
    surface: VectorGrid<T>,
    /// End conditions of the lines along the first index: "natural", "quadratic", "specified", "notaknot", "bessel" or
    /// "periodic".
    #[field(default = "quadratic")]
    ends: Arc<str>,
    /// The parameters: "arc", "index" or "centripetal".
    #[field(default = "arc")]
    basis: Arc<str>,
    /// End conditions of the lines along the second index (default: those of the first): "natural",
    /// "quadratic", "specified", "notaknot", "bessel" or "periodic".
    ends_v: Option<Arc<str>>,
}

impl<T: Scalar> Build<T> for Makecs<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let [u, v] = knots_of(&self.surface, &self.basis, [Self::SURFACE, Self::BASIS])?;
        let ends = |word: &str, field: FieldId| -> Result<Ends<T>, CallError> {
            let pair = names(word, field)?;
            if pair.contains(&EndCondition::Specified) {
                let fault = unknown(word, field, "end condition of a surface", ENDS);
                return Err(fault.help("tangents can be specified for curves, with makecc"));
            }
            Ok(match pair[0] {
                EndCondition::Periodic => Ends::Periodic,
                _ => {
                    let [start, end] = pair.map(|name| condition(name, Vec3::zero()));
                    Ends::Open(start, end)
                }
            })
        };
        let along = ends(&self.ends, Self::ENDS)?;
        let across = match &self.ends_v {
            Some(word) => ends(word, Self::ENDS_V)?,
            None => along,
        };
        let spline = GridSpline::bicubic_with(u, v, self.surface.points, [along, across]);
        let spline = spline.map_err(|error| surface_fault(error, 0, Self::SURFACE))?;
        Ok(Value::Surface(SurfaceRef::new(spline, 0)))
    }
}

/// The bilinear surface through the points of a surface, as a psurface.
#[derive(Kind)]
#[kind(
    class = Surface,
    function,
    name = "makels",
    example = "Line l({0, 0, 0}, {1, 2, 0}); curve c = distc(l, uniform(0, 1, 5)); surface s[5,4]; \
               for (j = 1:4) s[,j] = c + {0, 0, 1} * j; psurface p = makels(s, \"index\");"
)]
pub struct Makels<T: Scalar> {
    /// The points.
    surface: VectorGrid<T>,
    /// The parameters: "arc", "index" or "centripetal".
    #[field(default = "arc")]
    basis: Arc<str>,
}

impl<T: Scalar> Build<T> for Makels<T> {
    fn build(self, _: &Context) -> Result<Value<T>, CallError> {
        let [u, v] = knots_of(&self.surface, &self.basis, [Self::SURFACE, Self::BASIS])?;
        let surface = GridSpline::bilinear(u, v, self.surface.points);
        let surface = surface.map_err(|error| surface_fault(error, 0, Self::SURFACE))?;
        Ok(Value::Surface(SurfaceRef::new(surface, 0)))
    }
}
