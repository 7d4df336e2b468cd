use crate::arguments::Bead;
use moldloft_num::{CurveFormula, Jet, Real, Vec3};
use moldloft_registry::{Build, Context, CurveRef, Fault, Kind, LocusRef, Value};
use std::f64::consts::PI;

/// The way of a point when a bead that it depends on sweeps its curve: C(t) is where `point` is with
/// `bead` at the parameter t1 + t (t2 - t1).
///
/// Everything between bead and point is evaluated anew at each place. The curve is a chain of
/// polynomials through such places, halved until they agree with it to about 1e-12 of its size;
/// derivatives by what the model depends on are those of the places.
#[derive(Kind)]
#[kind(
    class = Curve,
    sweep = [0, 1],
    columns = "relabel bead point",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); \
               AbsBead b(c, 0.5); Line l(A, C); ProjPoint foot(b, l); BlendPoint m({b, foot}); \
               ProcCurve way(b, m);"
)]
pub struct ProcCurve<T: Real> {
    /// The bead that moves.
    bead: Bead<T>,
    /// The point that follows.
    point: LocusRef<T>,
    /// Where the bead begins.
    #[field(default = 0)]
    t1: T,
    /// Where it ends.
    #[field(default = 1)]
    t2: T,
}

/// The degree of a polynomial.
const DEGREE: usize = 16;

/// How far the last coefficients must have fallen, as a share of the size of the curve.
const ACCURACY: f64 = 1e-12;

/// Pieces are halved so often at most, and so many there are at most: beyond, a kink stays.
const DEEPEST: u32 = 16;
const MOST_PIECES: usize = 256;

impl<T: Real> Build<T> for ProcCurve<T> {
    fn build(self, _: &Context) -> Result<Value<T>, Fault> {
        let Self { bead, point, t1, t2 } = self;
        let (low, high) = (t1.re(), t2.re());
        let at = |t: f64| {
            let place = t1 * (1.0 - t) + t2 * t;
            point.at(place).map_err(|fault| {
                let message = format!("the point has no place with the bead at {}", place.re());
                let whole = Fault::new("no-locus", message)
                    .found(fault.message.clone())
                    .help("sweep only a part of the curve: give t1 and t2")
                    .in_field(1);
                fault
                    .related
                    .iter()
                    .fold(whole, |whole, (key, label)| whole.related(Some(*key), label.clone()))
            })
        };
        let mut ends = vec![0.0];
        let breaks = bead.curve.breaks().into_iter().map(|b| (b - low) / (high - low));
        ends.extend(breaks.filter(|t| *t > 0.0 && *t < 1.0));
        ends.push(1.0);
        ends.sort_by(f64::total_cmp);
        let mut todo: Vec<(f64, f64, u32)> = ends.windows(2).map(|w| (w[0], w[1], 0)).collect();
        todo.reverse();
        let mut pieces = Vec::new();
        let mut size = 0.0f64;
        while let Some((a, b, depth)) = todo.pop() {
            let mut samples = Vec::with_capacity(DEGREE + 1);
            for k in 0..=DEGREE {
                samples.push(at(0.5 * (a + b) - 0.5 * (b - a) * cosine(k))?);
            }
            let first = samples[0].re();
            size = samples.iter().fold(size, |s, p| s.max(p.re().distance(first)));
            size = size.max(f64::EPSILON * first.norm());
            let piece = Piece { from: a, to: b, coefficients: transform(&samples) };
            let split = piece.rest() > ACCURACY * size && depth < DEEPEST;
            if split && pieces.len() + todo.len() < MOST_PIECES {
                let mid = 0.5 * (a + b);
                todo.push((mid, b, depth + 1));
                todo.push((a, mid, depth + 1));
            } else {
                pieces.push(piece);
            }
        }
        Ok(Value::Curve(CurveRef::new(Way { pieces }, 0)))
    }
}

/// cos(pi k / DEGREE), exact at the ends.
fn cosine(k: usize) -> f64 {
    match k {
        0 => 1.0,
        DEGREE => -1.0,
        _ => Real::cos(PI * k as f64 / DEGREE as f64),
    }
}

/// The Chebyshev coefficients of the values at the points -cosine(k) (Trefethen 2013, ch. 3).
fn transform<T: Real>(samples: &[Vec3<T>]) -> Vec<Vec3<T>> {
    let n = DEGREE;
    (0..=n)
        .map(|j| {
            let mut sum = Vec3::zero();
            for (k, &p) in samples.iter().enumerate() {
                // T_j at -cosine(k) is cos(j pi (1 - k / n)), an integer multiple of pi / n.
                let m = j * (n - k) % (2 * n);
                let value = if m <= n { cosine(m) } else { cosine(2 * n - m) };
                let share = if k == 0 || k == n { 0.5 } else { 1.0 };
                sum += p * T::from(value * share);
            }
            let share = if j == 0 || j == n { 1.0 } else { 2.0 };
            sum * T::from(share / n as f64)
        })
        .collect()
}

/// A polynomial on a stretch of the parameter.
struct Piece<T> {
    from: f64,
    to: f64,
    coefficients: Vec<Vec3<T>>,
}

impl<T: Real> Piece<T> {
    /// How large the last coefficients are.
    fn rest(&self) -> f64 {
        self.coefficients[DEGREE - 2..].iter().map(|c| c.re().norm()).fold(0.0, f64::max)
    }
}

struct Way<T> {
    pieces: Vec<Piece<T>>,
}

impl<T: Real> CurveFormula for Way<T> {
    type Scalar = T;

    /// Clenshaw's recurrence.
    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        let k = self.pieces[1..].partition_point(|piece| piece.from <= t.re());
        let Piece { from, to, coefficients } = &self.pieces[k];
        let x = ((t - *from) * 2.0 / (*to - *from)) - 1.0;
        let (mut b, mut c) = (Vec3::<J>::zero(), Vec3::<J>::zero());
        for coefficient in coefficients[1..].iter().rev() {
            let next = coefficient.map(J::fixed) + b * (x * 2.0) - c;
            c = b;
            b = next;
        }
        coefficients[0].map(J::fixed) + b * x - c
    }

    fn breaks(&self) -> Vec<f64> {
        self.pieces[1..].iter().map(|piece| piece.from).collect()
    }
}
