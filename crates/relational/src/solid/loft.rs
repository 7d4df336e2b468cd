//! Solids between and through surfaces.

use super::layers::{edges_of, on};
use crate::arguments::EndRule;
use crate::faults;
use moldloft_num::trace::{Faces, LayerLaw, Layers, Turn};
use moldloft_num::{Curve, Jet, Order, Real, SolidFormula, Vec3};
use moldloft_registry::{Build, CallError, Context, FieldId, Kind, SolidRef, SurfaceRef, Value};
use moldloft_spline::{InterpolatingSpline, InterpolationError, KnotVector};
use smallvec::SmallVec;

/// A solid between two surfaces: X(u, v, w) = (1 - w) S1(u, v) + w S2(u, v).
///
/// Solids whose surfaces join along an edge join along the face over it if they have equal
/// divisions.
#[derive(Kind)]
#[kind(
    class = Solid,
    columns = "s1 s2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0.5); \
               AbsPoint E(0, 0, 2); AbsPoint F(2, 0, 3); AbsPoint G(0, 2, 2); AbsPoint H(2, 2, 2); \
               AbsPoint I(1, 1, 3); Line a(A, B); Line b(C, D); RuledSurf low(a, b); BCurve c({E, I, F}, 2); \
               Line d(G, H); RuledSurf high(c, d); RuledSolid S(low, high, divisions = {4, 4, 6});"
)]
pub struct RuledSolid<T: Real> {
    /// The face w = 0.
    s1: SurfaceRef<T>,
    /// The face w = 1.
    s2: SurfaceRef<T>,
}

impl<T: Real> Build<T> for RuledSolid<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let knots = KnotVector::clamped_uniform(1, 2).expect("two knots at each end");
        let solid =
            LoftedSolid { layers: vec![self.s1, self.s2], across: LoftMethod::Blend(knots) };
        Ok(Value::Solid(SolidRef::new(solid, context.nesting)))
    }
}

/// A solid that approximates its surfaces: X(u, v, w) = sum N_i(w) S_i(u, v), with N_i the
/// B-splines of clamped uniform knots. It has the first and the last surface as faces.
///
/// With N surfaces the degree is at most N - 1: a higher one is lowered to that.
#[derive(Kind)]
#[kind(
    class = Solid,
    columns = "degree surfaces",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0.5); \
               AbsPoint E(0.5, 0, 2); AbsPoint F(3, 0, 2); AbsPoint G(0.5, 2, 2); AbsPoint H(3, 3, 2); \
               AbsPoint I(0, 0, 4); AbsPoint J(2, 0, 4); AbsPoint K(0, 2, 4.5); AbsPoint L(2, 2, 4); \
               Line a(A, B); Line b(C, D); Line c(E, F); Line d(G, H); Line e(I, J); Line f(K, L); \
               RuledSurf low(a, b); RuledSurf middle(c, d); RuledSurf high(e, f); \
               BLoftSolid S({low, middle, high}, degree = 2);"
)]
pub struct BLoftSolid<T: Real> {
    /// Surfaces, two or more, in order of w.
    #[field(min_items = 2)]
    surfaces: Vec<SurfaceRef<T>>,
    /// Polynomial degree across the surfaces.
    #[field(default = 3, min = 1, max = 25)]
    degree: usize,
}

impl<T: Real> Build<T> for BLoftSolid<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let count = several(&self.surfaces, Self::SURFACES)?;
        let knots = KnotVector::clamped_uniform(self.degree.min(count - 1), count)
            .map_err(|error| faults::of_spline(error.into(), Self::SURFACES, Self::DEGREE))?;
        let solid = LoftedSolid { layers: self.surfaces, across: LoftMethod::Blend(knots) };
        Ok(Value::Solid(SolidRef::new(solid, context.nesting)))
    }
}

/// A solid that interpolates its surfaces: at each u and v the interpolating spline through their
/// points there, with knots at chord lengths, evaluated at w.
///
/// Two surfaces give rulings, three parabolas, four or more cubic splines. Neighbouring surfaces must
/// not meet, unless all meet in one point.
#[derive(Kind)]
#[kind(
    class = Solid,
    columns = "surfaces",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0.5); \
               AbsPoint E(0.5, 0, 2); AbsPoint F(3, 0, 2); AbsPoint G(0.5, 2, 2); AbsPoint H(3, 3, 2); \
               AbsPoint I(0, 0, 4); AbsPoint J(2, 0, 4); AbsPoint K(0, 2, 4.5); AbsPoint L(2, 2, 4); \
               Line a(A, B); Line b(C, D); Line c(E, F); Line d(G, H); Line e(I, J); Line f(K, L); \
               RuledSurf low(a, b); RuledSurf middle(c, d); RuledSurf high(e, f); \
               CLoftSolid S({low, middle, high}); CLoftSolid N({low, middle, high}, \"natural\");"
)]
pub struct CLoftSolid<T: Real> {
    /// Surfaces, two or more, in order of w.
    #[field(min_items = 2)]
    surfaces: Vec<SurfaceRef<T>>,
    /// End conditions: "notaknot", "natural", "bessel" or "quadratic".
    #[field(default = "notaknot")]
    ends: EndRule,
}

/// The parameters at which a new loft is tried.
const TRIALS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

impl<T: Real> Build<T> for CLoftSolid<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { surfaces, ends } = self;
        several(&surfaces, Self::SURFACES)?;
        if matches!(ends, EndRule::Clamped | EndRule::Periodic) {
            return Err(CallError::new("unknown-ends", "a solid is neither clamped nor periodic")
                .expected("\"notaknot\", \"natural\", \"bessel\" or \"quadratic\"")
                .in_field(Self::ENDS));
        }
        let solid = LoftedSolid { layers: surfaces, across: LoftMethod::Spline(ends) };
        for (u, v) in TRIALS.iter().flat_map(|&u| TRIALS.map(|v| (u, v))) {
            let points = solid.column(T::from(u), T::from(v));
            if let Err(error) = solid.spline(ends, &points)
                && points.iter().any(|p| p.re() != points[0].re())
            {
                return Err(faults::of_interpolation(
                    error,
                    "surface",
                    [Self::SURFACES, Self::SURFACES, Self::ENDS],
                )
                .help(format!("this happens at u = {u}, v = {v}")));
            }
        }
        Ok(Value::Solid(SolidRef::new(solid, context.nesting)))
    }
}

fn several<T: Real>(surfaces: &[SurfaceRef<T>], field: FieldId) -> Result<usize, CallError> {
    if surfaces.len() >= 2 {
        return Ok(surfaces.len());
    }
    Err(CallError::new("too-few-items", "a solid needs at least 2 surfaces")
        .expected("at least 2 surfaces")
        .found(surfaces.len().to_string())
        .in_field(field))
}

enum LoftMethod {
    Blend(KnotVector),
    Spline(EndRule),
}

struct LoftedSolid<T: Real> {
    layers: Vec<SurfaceRef<T>>,
    across: LoftMethod,
}

type Points<S> = SmallVec<[Vec3<S>; 6]>;

impl<T: Real> LoftedSolid<T> {
    fn column<J: Jet<T>>(&self, u: J, v: J) -> Points<J> {
        self.layers.iter().map(|surface| surface.at(u, v)).collect()
    }

    fn spline<S: Real>(
        &self,
        ends: EndRule,
        points: &[Vec3<S>],
    ) -> Result<InterpolatingSpline<S>, InterpolationError> {
        InterpolatingSpline::with_ends(points, ends.ends().unwrap_or_default())
    }

    /// The points at `ws` of one line along w.
    fn line<S: Real>(&self, points: &[Vec3<S>], ws: &[S], mut out: impl FnMut(Vec3<S>)) {
        match &self.across {
            LoftMethod::Blend(knots) => {
                for &w in ws {
                    let basis = knots.basis(w, Order::Zero);
                    let shares = basis.rows[0].iter().zip(&points[basis.first..]);
                    out(shares.fold(Vec3::zero(), |sum, (&b, &p)| sum + p * b));
                }
            }
            LoftMethod::Spline(ends) => match self.spline(*ends, points) {
                Ok(spline) => ws.iter().for_each(|&w| out(spline.jet(w, Order::Zero)[0])),
                // All surfaces meet here, as far as was tried.
                Err(_) => ws.iter().for_each(|_| out(points[0])),
            },
        }
    }
}

impl<T: Real> SolidFormula for LoftedSolid<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, u: J, v: J, w: J) -> Vec3<J> {
        let mut found = Vec3::zero();
        self.line(&self.column(u, v), &[w], |p| found = p);
        found
    }

    fn grid(&self, us: &[f64], vs: &[f64], ws: &[f64], points: &mut [Vec3<T>]) {
        let layers: Vec<Vec<Vec3<T>>> = self
            .layers
            .iter()
            .map(|surface| {
                let mut layer = vec![Vec3::zero(); us.len() * vs.len()];
                surface.grid(us, vs, &mut layer, None);
                layer
            })
            .collect();
        let ws: Vec<T> = ws.iter().map(|&w| T::from(w)).collect();
        let mut out = points.iter_mut();
        for at in 0..us.len() * vs.len() {
            let column: Points<T> = layers.iter().map(|layer| layer[at]).collect();
            self.line(&column, &ws, |p| {
                if let Some(x) = out.next() {
                    *x = p;
                }
            });
        }
    }

    fn faces(&self) -> Faces<T> {
        let mut faces = Faces::own();
        faces.faces[4] = on(&self.layers[0], Turn::default());
        faces.faces[5] = on(&self.layers[self.layers.len() - 1], Turn::default());
        faces.layers = Some(Layers {
            surfaces: self.layers.iter().map(|s| (s.key, edges_of(s))).collect(),
            law: match &self.across {
                LoftMethod::Blend(knots) => LayerLaw::Blend(knots.degree()),
                LoftMethod::Spline(ends) => LayerLaw::Spline(*ends as usize),
            },
        });
        faces
    }
}
