//! The skin of a model as B-spline patches with clamped uniform knots on [-1, 1], for codes that take
//! the surfaces themselves.
//!
//! Surfaces that are such B-splines of degrees up to 5 (lofts, rulings and translations of such
//! curves) are exact, with the fewest control points. Knuckles at even parameters become edges
//! between patches. Anything else is interpolated by cubics and halved until it is near enough.

use crate::ExportFailure;
use moldloft_diag::Diagnostic;
use moldloft_document::Document;
pub use moldloft_io::gdf::SplinePatch;
use moldloft_mesh::Tag;
use moldloft_num::{Banded, Order, Surface, Vec3};
use moldloft_registry::Value;
use moldloft_spline::KnotVector;

const DEGREES: std::ops::RangeInclusive<usize> = 1..=5;

/// The largest number of spans that is tried for an exact form, in each direction.
const MOST_SPANS: usize = 24;

/// The largest number of even pieces that is tried where a surface has knuckles.
const MOST_PIECES: usize = 16;

const FIT_DEGREE: usize = 3;
const FIT_SPANS: [usize; 5] = [2, 4, 8, 16, 32];

/// Maximum number of halvings of a patch per direction before its fit fails.
const DEEPEST: usize = 4;

/// Deviation over the size of the model that counts as rounding.
const ROUNDING: f64 = 4e-13;

/// Distance from a plane of symmetry over the size of the model that counts as in the plane.
const IN_PLANE: f64 = 1e-9;

/// Positions, in [-1, 1], of the curves that are tested for an exact form.
const PROBES: [f64; 5] = [-0.83, -0.31, 0.17, 0.56, 0.97];

/// The model's skin as B-spline patches, in the order of its patches; S_u x S_v points out of the
/// water. A fit is within `tolerance` (default: 1e-5 of the model's diagonal) at four points of
/// each span in each direction. Lids are included on request.
///
/// # Errors
/// Patches that are no surface of u and v; positions that are not finite; a half that crosses its
/// plane of symmetry; surfaces that no fit comes near enough to.
pub fn spline_patches(
    document: &mut Document,
    tolerance: Option<f64>,
    lids: bool,
) -> Result<Vec<SplinePatch>, ExportFailure> {
    let panelled = document.entire_panels()?;
    let mesh = &panelled.mesh;
    if !mesh.positions().iter().all(|p| p.is_finite()) {
        return cannot("a position is not a finite number");
    }
    if mesh.patches().is_empty() {
        return cannot("the model shows no surface");
    }
    let size = mesh.bounds().diagonal();
    let allowed = tolerance.unwrap_or(1e-5 * size);
    if allowed.is_nan() || allowed <= 0.0 {
        let message = format!("a tolerance is a positive number, not {allowed}");
        return Err(Diagnostic::error("bad-tolerance", message).into());
    }
    let symmetry = document.symmetry();
    let mirrored = [symmetry.contains('x'), symmetry.contains('y')];
    let mut out = Vec::new();
    for patch in mesh.patches() {
        let (name, tag) = (&patch.info.name, &patch.info.tag);
        if matches!(tag, Tag::Waterline | Tag::Symmetry) || (*tag == Tag::Lid && !lids) {
            continue;
        }
        let graph = document.graph();
        let object = graph.find(name).and_then(|key| graph.get(key));
        let value = object.and_then(|object| object.value());
        let (Some(block), Some(Value::Surface(surface))) = (&patch.block, value) else {
            return cannot(&format!("`{name}` is not a surface of u and v"));
        };
        let fit = SurfaceFit { name, surface: &**surface, size, allowed };
        for mut part in fit.whole()? {
            if !block.reversed {
                // Panels face the water along S_u x S_v: u is reversed.
                part.turn();
            }
            for axis in (0..2).filter(|&axis| mirrored[axis]) {
                for point in &mut part.points {
                    let mut xyz = point.to_array();
                    if xyz[axis].abs() <= IN_PLANE * size {
                        xyz[axis] = 0.0;
                        *point = xyz.into();
                    }
                }
                check_side(&part, axis, size)?;
            }
            out.push(part);
        }
    }
    Ok(out)
}

fn cannot<T>(why: &str) -> Result<T, ExportFailure> {
    let message = format!("cannot write gdf-high: {why}");
    Err(Diagnostic::error("cannot-write", message).into())
}

/// Refuses a patch of a half that reaches to both sides of its plane of symmetry.
fn check_side(patch: &SplinePatch, axis: usize, size: f64) -> Result<(), ExportFailure> {
    let even: Vec<f64> = (0..17).map(|k| f64::from(k) / 8.0 - 1.0).collect();
    let side = patch.grid(&even, &even).into_iter().map(|p| p[axis]);
    let (low, high) = side.fold((0.0, 0.0), |(low, high), x| (x.min(low), x.max(high)));
    if low < -IN_PLANE * size && high > IN_PLANE * size {
        let (axis, name) = (["x", "y"][axis], &patch.name);
        return cannot(&format!(
            "a half mirrored in {axis} = 0 must stay on one side, but patch `{name}` crosses it"
        ));
    }
    Ok(())
}

/// Degree and spans in one direction.
type Form = (usize, usize);

/// A box of parameters in [0, 1]: from and to in u, from and to in v.
type Part = [[f64; 2]; 2];

/// A surface that becomes patches.
struct SurfaceFit<'s> {
    name: &'s str,
    surface: &'s dyn Surface<f64>,
    size: f64,
    allowed: f64,
}

impl SurfaceFit<'_> {
    /// The patches of the whole surface: one, or one between knuckles at even parameters.
    fn whole(&self) -> Result<Vec<SplinePatch>, ExportFailure> {
        let whole = [[0.0, 1.0]; 2];
        let exact = self.exact_forms(whole);
        let counts = [0, 1].map(|axis| match exact[axis] {
            Some(_) => 1,
            None => self.pieces(whole, axis),
        });
        let mut out = Vec::new();
        if counts == [1, 1] {
            self.part(whole, exact, 0, &mut out)?;
            return Ok(out);
        }
        for u in even_parts(counts[0]) {
            for v in even_parts(counts[1]) {
                self.part([u, v], self.exact_forms([u, v]), 1, &mut out)?;
            }
        }
        Ok(out)
    }

    /// The patches of a part with these exact forms, halved until they are near enough.
    fn part(
        &self,
        part: Part,
        exact: [Option<Form>; 2],
        depth: usize,
        out: &mut Vec<SplinePatch>,
    ) -> Result<(), ExportFailure> {
        let mut forms = exact;
        let mut best: Option<SplinePatch> = None;
        for spans in FIT_SPANS {
            let chosen = forms.map(|form| form.unwrap_or((FIT_DEGREE, spans)));
            let patch = self.interpolated(part, chosen);
            let near = patch.deviation <= self.allowed;
            if best.as_ref().is_none_or(|best| patch.deviation < best.deviation) {
                best = Some(patch);
            }
            if near {
                out.extend(best);
                return Ok(());
            }
            if forms.iter().all(Option::is_some) {
                // Exact along the probes but not between them.
                forms = [None, None];
            }
        }
        if depth == DEEPEST {
            let (name, allowed) = (self.name, self.allowed);
            let off = best.map_or(f64::NAN, |patch| patch.deviation);
            return Err(Diagnostic::error(
                "not-fitted",
                format!("no B-spline comes within {allowed:.2e} of `{name}`"),
            )
            .found(format!("the error of the best fit is {off:.2e}"))
            .help("ask for less with a larger tolerance")
            .into());
        }
        // A knuckle that is not a knot: halve the patch, so that the knuckle becomes an edge.
        let halves = [0, 1].map(|axis| {
            let [low, high] = part[axis];
            let middle = (low + high) / 2.0;
            match forms[axis] {
                Some(_) => vec![[low, high]],
                None => vec![[low, middle], [middle, high]],
            }
        });
        for &u in &halves[0] {
            for &v in &halves[1] {
                self.part([u, v], self.exact_forms([u, v]), depth + 1, out)?;
            }
        }
        Ok(())
    }

    /// Points of a part on a grid of parameters in [-1, 1], v fastest.
    fn at(&self, part: Part, u: &[f64], v: &[f64]) -> Vec<Vec3> {
        let own = |[low, high]: [f64; 2], t: &[f64]| -> Vec<f64> {
            t.iter().map(|t| low + (high - low) * (t + 1.0) / 2.0).collect()
        };
        let (u, v) = (own(part[0], u), own(part[1], v));
        let mut points = vec![Vec3::zero(); u.len() * v.len()];
        self.surface.grid(&u, &v, &mut points, None);
        points
    }

    /// Points of a part along an axis, on the curves through the probes of the other: a row for each
    /// parameter.
    fn along(&self, part: Part, axis: usize, t: &[f64]) -> Vec<Vec3> {
        if axis == 0 {
            return self.at(part, t, &PROBES);
        }
        let across = self.at(part, &PROBES, t);
        let place = |k: usize| across[k % PROBES.len() * t.len() + k / PROBES.len()];
        (0..across.len()).map(place).collect()
    }

    fn exact_forms(&self, part: Part) -> [Option<Form>; 2] {
        [0, 1].map(|axis| self.exact(part, axis))
    }

    /// The form, with the fewest control points, that gives the curves along an axis exactly.
    fn exact(&self, part: Part, axis: usize) -> Option<Form> {
        let spans = |degree| (1..=MOST_SPANS).map(move |spans| (degree, spans));
        let mut forms: Vec<Form> = DEGREES.flat_map(spans).collect();
        forms.sort_by_key(|&(degree, spans)| (degree + spans, degree));
        forms.into_iter().find(|&form| self.is_exact(part, axis, form))
    }

    fn is_exact(&self, part: Part, axis: usize, form: Form) -> bool {
        let basis = UniformBasis::new(form);
        let mut points = self.along(part, axis, &basis.means);
        let curves = PROBES.len();
        basis.interpolate(&mut points, curves);
        let tests = tests(form.1);
        let given = self.along(part, axis, &tests);
        let made = tests.iter().flat_map(|&t| basis.at(t, &points, curves));
        let off = made.zip(given).map(|(a, b)| (a - b).to_array());
        off.flatten().all(|x| x.abs() <= ROUNDING * self.size)
    }

    /// The minimum number, two or more, of equal pieces that are polynomials; 1 if there is none.
    fn pieces(&self, part: Part, axis: usize) -> usize {
        let is_polynomial = |piece: [f64; 2], degree: usize| {
            let mut own = part;
            own[axis] = piece;
            self.is_exact(own, axis, (degree, 1))
        };
        let all = |count: usize| {
            DEGREES.into_iter().any(|d| even_parts(count).all(|piece| is_polynomial(piece, d)))
        };
        (2..=MOST_PIECES).find(|&count| all(count)).unwrap_or(1)
    }

    /// The patch of given forms that interpolates a part, and its error.
    fn interpolated(&self, part: Part, forms: [Form; 2]) -> SplinePatch {
        let [u, v] = forms.map(UniformBasis::new);
        let (nu, nv) = (u.means.len(), v.means.len());
        let mut points = self.at(part, &u.means, &v.means);
        u.interpolate(&mut points, nv);
        let mut turned = transposed(&points, nv);
        v.interpolate(&mut turned, nu);
        let points = transposed(&turned, nu);
        let [(p, m), (q, n)] = forms;
        let (degree, spans) = ([p, q], [m, n]);
        let mut patch =
            SplinePatch { name: self.name.into(), degree, spans, points, deviation: 0.0 };
        let (us, vs) = (tests(m), tests(n));
        let given = self.at(part, &us, &vs);
        let off = patch.grid(&us, &vs).into_iter().zip(given).map(|(a, b)| (a - b).norm());
        // A distance that is not a number is the worst there is.
        patch.deviation =
            off.fold(0.0, |most, x| if x.is_nan() { f64::INFINITY } else { x.max(most) });
        patch
    }
}

fn even_parts(count: usize) -> impl Iterator<Item = [f64; 2]> + Clone {
    let at = move |k: usize| k as f64 / count as f64;
    (0..count).map(move |k| [at(k), at(k + 1)])
}

/// The columns of rows of `width` points as rows.
fn transposed(points: &[Vec3], width: usize) -> Vec<Vec3> {
    let height = points.len() / width;
    (0..points.len()).map(|k| points[k % height * width + k / height]).collect()
}

/// Parameters between the knots at which a form is compared with the surface.
fn tests(spans: usize) -> Vec<f64> {
    let inner = [0.11, 0.37, 0.52, 0.83];
    let at = |k: usize, x: f64| -1.0 + 2.0 * (k as f64 + x) / spans as f64;
    let between = (0..spans).flat_map(|k| inner.map(|x| at(k, x)));
    std::iter::once(-1.0).chain(between).chain([1.0]).collect()
}

/// The basis of a form, and the means of its knots (Greville's abscissae), where it interpolates.
struct UniformBasis {
    knots: KnotVector,
    means: Vec<f64>,
}

impl UniformBasis {
    fn new((degree, spans): Form) -> Self {
        let knots = SplinePatch::uniform_knots(degree, spans);
        let numbers = knots.as_slice();
        let mean = |i: usize| numbers[i + 1..=i + degree].iter().sum::<f64>() / degree as f64;
        let means = (0..degree + spans).map(|i| mean(i).clamp(-1.0, 1.0)).collect();
        Self { knots, means }
    }

    /// The control points of curves through points at the means, in place: rows of `width` points,
    /// a curve for each column.
    ///
    /// The matrix is totally positive and has a band (de Boor 1978, chapter XIII): elimination needs
    /// no pivots.
    fn interpolate(&self, points: &mut [Vec3], width: usize) {
        let (n, degree) = (self.means.len(), self.knots.degree());
        let mut matrix = Banded::zero(n, degree);
        for (row, &t) in self.means.iter().enumerate() {
            let basis = self.knots.basis(t, Order::Zero);
            for (k, &value) in basis.rows[0].iter().enumerate() {
                let column = basis.first + k;
                if column.abs_diff(row) <= degree {
                    *matrix.entry(row, column) = value;
                }
            }
        }
        for column in 0..width {
            let mut curve: Vec<Vec3> = (0..n).map(|row| points[row * width + column]).collect();
            let solved = matrix.clone().solve(&mut curve);
            // Every mean is inside the support of its own function, so no pivot vanishes.
            solved.expect("the matrix of interpolation at the means is regular");
            for (row, point) in curve.into_iter().enumerate() {
                points[row * width + column] = point;
            }
        }
    }

    /// The points at a parameter of the curves whose control points are the columns.
    fn at(&self, t: f64, points: &[Vec3], width: usize) -> Vec<Vec3> {
        let basis = self.knots.basis(t, Order::Zero);
        let one = |column: usize| {
            let terms = basis.rows[0].iter().enumerate();
            terms.fold(Vec3::zero(), |sum, (k, &b)| {
                sum + points[(basis.first + k) * width + column] * b
            })
        };
        (0..width).map(one).collect()
    }
}
