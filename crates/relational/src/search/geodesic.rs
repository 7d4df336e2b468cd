//! Geodesics between two magnets.
//!
//! A path X(t) = S(w(t)) of constant speed is a geodesic if its second derivative is normal to the
//! surface: S_u . X'' = S_v . X'' = 0. X is the polynomial through its points at Chebyshev nodes,
//! and the equations hold at the inner ones (collocation; Trefethen 2000, Spectral Methods in
//! MATLAB, chapters 6 and 7). Newton's method, and the exact derivatives of its solution, need
//! second derivatives of the surface only.

use crate::arguments::{Magnet, common_surface};
use crate::snake::OnSurface;
use moldloft_num::period::within;
use moldloft_num::trace::Trace;
use moldloft_num::{CurveFormula, Jet, Order, Real, SurfJet, Vec3, solve_dense};
use moldloft_registry::{
    Build, CallError, Context, CurveRef, Kind, SearchReport, SearchStatus, SurfaceRef, Value,
};

/// Successive numbers of spans between nodes, until the path has converged.
const SPANS: [usize; 5] = [8, 16, 24, 36, 54];

/// Further numbers for paths of several turns, and minimum number of spans per turn.
const MORE_SPANS: [usize; 3] = [80, 120, 180];
const SPANS_A_TURN: f64 = 12.0;

/// A path that changes by less than this in u and v is taken.
const SETTLED: f64 = 1e-11;

/// Steps of Newton's method.
const MOST_STEPS: usize = 60;

/// Maximum distance of a path beyond the surface, in u and v.
const OUTSIDE: f64 = 1e-9;

/// The shortest path on a surface between two magnets, more exactly a geodesic: a curve of zero
/// geodesic curvature. Its parameter t is the fraction of its length.
///
/// Of several geodesics it is the one found by Newton's method from the straight line of the
/// parameter plane: on surfaces with little curvature between the magnets, the shortest. On a
/// closed surface those across its seam are tried too, and the shortest is the result (of equal
/// ones, the one inside the seam); `turns_u` and `turns_v` select another. At the seam the
/// parameter on the surface jumps between 0 and 1.
#[derive(Kind)]
#[kind(
    class = Snake,
    columns = "relabel m1 m2",
    example = "AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); \
               AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); \
               AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.9, 0.8); GeoSnake s(p, q); \
               AbsPoint O(0, 0, -4); AbsPoint X(4, 0, -4); Line axis(O, X); AbsPoint F(0, 0, -3); \
               AbsPoint G(4, 0, -3.5); Line k(F, G); RevSurf R(k, axis); AbsMagnet a(R, 0.1, 0.3); \
               AbsMagnet b(R, 0.9, 0.9); GeoSnake g(a, b); GeoSnake round(a, b, turns_v = 1);"
)]
pub struct GeoSnake<T: Real> {
    /// Start.
    m1: Magnet<T>,
    /// End, on the same surface.
    m2: Magnet<T>,
    /// Number of crossings of the seam u = 0, forwards if positive, backwards if negative. Default:
    /// the shortest path with 0, 1 or -1.
    #[field(min = -10, max = 10)]
    turns_u: Option<i32>,
    /// Number of forward crossings of the seam v = 0; see `turns_u`.
    #[field(min = -10, max = 10)]
    turns_v: Option<i32>,
}

impl<T: Real> Build<T> for GeoSnake<T> {
    fn build(self, context: &Context) -> Result<Value<T>, CallError> {
        let Self { m1, m2, turns_u, turns_v } = self;
        let items = [(m1.key, &m1.surface), (m2.key, &m2.surface)];
        let fields = [Self::M1, Self::M2];
        let surface = common_surface(&items, |fault, k| fault.in_field(fields[k]))?;
        let sheet = SeamlessSurface { round: surface.closed(), surface: &surface };
        let plain = [m1.uv, m2.uv].map(|w| w.map(|x| x.re()));
        let ways = ways(&sheet, plain, [turns_u, turns_v])?;
        let (turns, (gap, iterations, nodes)) = shortest(&sheet, plain, &ways)?;
        let path = GeodesicPath::new(&sheet, [m1.uv, m2.uv], turns, &nodes)?;
        let found = SearchReport {
            status: SearchStatus::Ok,
            residual: gap,
            iterations: iterations as u32,
            start: plain.as_flattened().to_vec(),
            last: plain.as_flattened().to_vec(),
            alternatives: Vec::new(),
            advice: "",
        };
        let trace = Trace::Own([m1.key, m2.key]);
        let shape = OnSurface { surface: surface.clone(), path, trace };
        Ok(Value::Curve(CurveRef::snake(shape, surface, context.nesting).with_found(found)))
    }
}

/// A surface continued across its seams.
struct SeamlessSurface<'s, T: Real> {
    surface: &'s SurfaceRef<T>,
    round: [bool; 2],
}

impl<T: Real> SeamlessSurface<'_, T> {
    fn jet(&self, w: [T; 2], order: Order) -> SurfJet<T> {
        self.surface.jet(w[0], w[1], order)
    }
}

/// Candidate turns across the seams: the given ones; by default none, and one in the opposite
/// direction.
fn ways<T: Real>(
    sheet: &SeamlessSurface<T>,
    [from, to]: [[f64; 2]; 2],
    asked: [Option<i32>; 2],
) -> Result<Vec<[f64; 2]>, CallError> {
    let mut each = [vec![0.0], vec![0.0]];
    for a in 0..2 {
        match asked[a] {
            Some(turns) if turns != 0 && !sheet.round[a] => {
                let letter = ["u", "v"][a];
                return Err(CallError::new(
                    "no-seam",
                    format!("the surface has no seam {letter} = 0"),
                )
                .expected(format!("a surface whose edges {letter} = 0 and {letter} = 1 are one"))
                .found(format!("{turns} turns over it"))
                .help("close the surface by a full turn, or by curves that end where they begin")
                .related(sheet.surface.key, "is open")
                .in_field([GeoSnake::<T>::TURNS_U, GeoSnake::<T>::TURNS_V][a]));
            }
            Some(turns) => each[a] = vec![f64::from(turns)],
            None if sheet.round[a] && to[a] != from[a] => {
                each[a].push(if to[a] > from[a] { -1.0 } else { 1.0 });
            }
            None => {}
        }
    }
    let [us, vs] = &each;
    Ok(us.iter().flat_map(|&u| vs.iter().map(move |&v| [u, v])).collect())
}

/// Relative difference by which a path must be shorter to be preferred.
const SHORTER: f64 = 1e-6;

/// Change in the last refinement, number of iterations, and parameters of the nodes.
type Solved = (f64, usize, Vec<[f64; 2]>);

/// The shortest of the paths with the given turns.
fn shortest<T: Real>(
    sheet: &SeamlessSurface<T>,
    [from, to]: [[f64; 2]; 2],
    ways: &[[f64; 2]],
) -> Result<([f64; 2], Solved), CallError> {
    let mut best: Option<(f64, [f64; 2], Solved)> = None;
    let mut refused = None;
    for &turns in ways {
        let end = [to[0] + turns[0], to[1] + turns[1]];
        match solved(sheet, [from, end], turns != [0.0; 2]) {
            // A crease at the seam excludes a smooth path.
            Ok(found) if found.0 > CREASED && ways.len() > 1 && turns != [0.0; 2] => {}
            Ok(found) => {
                let length = length(sheet, &found.2);
                if best.as_ref().is_none_or(|b| length < b.0 * (1.0 - SHORTER)) {
                    best = Some((length, turns, found));
                }
            }
            Err(fault) => refused = refused.or(Some(fault)),
        }
    }
    match (best, refused) {
        (Some((_, turns, found)), _) => Ok((turns, found)),
        (None, Some(fault)) => Err(fault),
        (None, None) => Err(no_convergence()),
    }
}

/// A path that the last refinement moved by more than this is not smooth.
const CREASED: f64 = 1e-6;

/// Chords by which lengths are compared.
const CHORDS: usize = 64;

fn length<T: Real>(sheet: &SeamlessSurface<T>, places: &[[f64; 2]]) -> f64 {
    let places = resampled(places, CHORDS);
    let at = |w: &[f64; 2]| sheet.jet(w.map(T::from), Order::Zero).p.re();
    places.windows(2).map(|w| at(&w[0]).distance(at(&w[1]))).sum()
}

fn no_convergence() -> CallError {
    CallError::new("no-convergence", "no geodesic was found between the magnets")
        .expected("magnets with a smooth stretch of the surface between them")
        .found("an iteration from the straight line in u and v that did not converge")
        .help("put magnets between them, and join the geodesics by PolySnake")
}

/// The angle of node k of n spans; the node is at t = (1 - cos) / 2.
fn angle(k: usize, n: usize) -> f64 {
    std::f64::consts::PI * k as f64 / n as f64
}

fn node(k: usize, n: usize) -> f64 {
    0.5 - 0.5 * Real::cos(angle(k, n))
}

/// The matrix that takes values at the nodes to second derivatives by t there, by Welfert's formula
/// (1997, Generation of pseudospectral differentiation matrices I, SIAM J. Numer. Anal. 34, 1640) and
/// with gaps of nodes as products of sines: the product of two first-order matrices loses n^2 times as
/// many digits. The diagonal makes derivatives of a constant zero.
fn second_derivatives(n: usize) -> Vec<f64> {
    let m = n + 1;
    let gap = |i: usize, j: usize| {
        let (a, b) = (0.5 * angle(i, n), 0.5 * angle(j, n));
        Real::sin(a + b) * Real::sin(a - b)
    };
    let weight = |k: usize| {
        let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        if k == 0 || k == n { 0.5 * sign } else { sign }
    };
    let mut dd = vec![0.0; m * m];
    for i in 0..m {
        let others = || (0..m).filter(move |&j| j != i);
        let first = |j: usize| weight(j) / weight(i) / gap(i, j);
        let own: f64 = -others().map(first).sum::<f64>();
        let mut sum = 0.0;
        for j in others() {
            dd[i * m + j] = 2.0 * first(j) * (own - 1.0 / gap(i, j));
            sum += dd[i * m + j];
        }
        dd[i * m + i] = -sum;
    }
    dd
}

/// The equations at the inner nodes and their matrix by the inner parameters, in the order u, v of
/// each.
fn equations<T: Real>(
    sheet: &SeamlessSurface<T>,
    places: &[[T; 2]],
    dd: &[f64],
    with_matrix: bool,
) -> (Vec<T>, Vec<T>) {
    let m = places.len();
    let inner = m - 2;
    let order = if with_matrix { Order::Second } else { Order::First };
    let jets: Vec<SurfJet<T>> = places.iter().map(|&w| sheet.jet(w, order)).collect();
    let mut rest = Vec::with_capacity(2 * inner);
    let mut matrix = if with_matrix { vec![T::zero(); 4 * inner * inner] } else { Vec::new() };
    for k in 1..m - 1 {
        // From differences of positions: the largest entries belong to the nearest nodes.
        let own = jets[k].p;
        let bend = (0..m)
            .filter(|&j| j != k)
            .fold(Vec3::zero(), |sum, j| sum + (jets[j].p - own) * T::from(dd[k * m + j]));
        let own = [jets[k].u, jets[k].v];
        rest.extend(own.map(|d| d.dot(bend)));
        if !with_matrix {
            continue;
        }
        for (a, d) in own.into_iter().enumerate() {
            let row = (2 * (k - 1) + a) * 2 * inner;
            for j in 1..m - 1 {
                let share = T::from(dd[k * m + j]);
                matrix[row + 2 * (j - 1)] = d.dot(jets[j].u) * share;
                matrix[row + 2 * (j - 1) + 1] = d.dot(jets[j].v) * share;
            }
            let (by_u, by_v) =
                if a == 0 { (jets[k].uu, jets[k].uv) } else { (jets[k].uv, jets[k].vv) };
            matrix[row + 2 * (k - 1)] += by_u.dot(bend);
            matrix[row + 2 * (k - 1) + 1] += by_v.dot(bend);
        }
    }
    (rest, matrix)
}

/// The parameters of a path at other nodes, by the barycentric formula.
fn resampled(places: &[[f64; 2]], n: usize) -> Vec<[f64; 2]> {
    let m = places.len();
    (0..=n)
        .map(|k| {
            let t = node(k, n);
            let (mut sum, mut total) = ([0.0; 2], 0.0);
            for (j, place) in places.iter().enumerate() {
                let gap = t - node(j, m - 1);
                if gap == 0.0 {
                    return *place;
                }
                let sign = if j.is_multiple_of(2) { 1.0 } else { -1.0 };
                let share = if j == 0 || j == m - 1 { 0.5 * sign } else { sign } / gap;
                sum = [sum[0] + share * place[0], sum[1] + share * place[1]];
                total += share;
            }
            sum.map(|x| x / total)
        })
        .collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, x| a.max(x.abs()))
}

/// The real parameters at the nodes, for a path across a seam or not.
fn solved<T: Real>(
    sheet: &SeamlessSurface<T>,
    [from, to]: [[f64; 2]; 2],
    turned: bool,
) -> Result<Solved, CallError> {
    let at = |w: [f64; 2]| sheet.jet(w.map(T::from), Order::Zero).p.re();
    if from == to || (!turned && at(from).distance(at(to)) == 0.0) {
        return Err(CallError::new("coincident-points", "the geodesic has no length")
            .expected("two magnets at different points")
            .found("one place")
            .in_field(GeoSnake::<T>::M2));
    }
    let mut places: Vec<[f64; 2]> = vec![from, to];
    let mut steps = 0;
    let mut moved = f64::INFINITY;
    let turns = (0..2).map(|a| (to[a] - from[a]).abs()).fold(0.0, f64::max);
    let more = if turned && turns > 1.0 { &MORE_SPANS[..] } else { &[] };
    let least = if turned { (SPANS_A_TURN * turns) as usize } else { 0 };
    for n in SPANS.into_iter().chain(more.iter().copied()).filter(|n| *n >= least) {
        let before = if places.len() == 2 {
            let line = |k: usize| {
                let t = node(k, n);
                [0, 1].map(|a| from[a] * (1.0 - t) + to[a] * t)
            };
            (0..=n).map(line).collect()
        } else {
            resampled(&places, n)
        };
        let Some((next, used)) = newton(sheet, before.clone(), n) else { break };
        steps += used;
        let change = next
            .iter()
            .zip(&before)
            .flat_map(|(a, b)| [a[0] - b[0], a[1] - b[1]])
            .fold(0.0_f64, |a, x| a.max(x.abs()));
        let first = places.len() == 2;
        places = next;
        if !first {
            moved = change;
        }
        if moved <= SETTLED {
            break;
        }
    }
    if places.len() == 2 {
        return Err(no_convergence());
    }
    let outside = |a: usize, x: f64| !sheet.round[a] && !(-OUTSIDE..=1.0 + OUTSIDE).contains(&x);
    if places.iter().any(|w| outside(0, w[0]) || outside(1, w[1])) {
        let span = |a: usize| {
            let all = places.iter().map(|p| p[a]);
            let (low, high) =
                (all.clone().fold(f64::INFINITY, f64::min), all.fold(f64::NEG_INFINITY, f64::max));
            format!("{low:.4} .. {high:.4}")
        };
        return Err(CallError::new("leaves-surface", "the geodesic leaves the surface")
            .expected("a geodesic with u and v in 0 .. 1")
            .found(format!("u in {}, v in {}", span(0), span(1)))
            .help("move the magnets away from the edge, or make the surface larger"));
    }
    Ok((moved, steps, places))
}

/// Newton's method at n spans, halving steps that do not help; `None` when it does not settle.
fn newton<T: Real>(
    sheet: &SeamlessSurface<T>,
    mut places: Vec<[f64; 2]>,
    n: usize,
) -> Option<(Vec<[f64; 2]>, usize)> {
    let dd = second_derivatives(n);
    let lifted =
        |places: &[[f64; 2]]| -> Vec<[T; 2]> { places.iter().map(|p| p.map(T::from)).collect() };
    let plain = |all: Vec<T>| -> Vec<f64> { all.into_iter().map(|x| x.re()).collect() };
    let (rest, matrix) = equations(sheet, &lifted(&places), &dd, true);
    let (mut rest, mut matrix) = (plain(rest), plain(matrix));
    for step in 1..=MOST_STEPS {
        let mut by = rest.clone();
        solve_dense(&mut matrix, &mut by).ok()?;
        let length = largest(&by);
        if !length.is_finite() {
            return None;
        }
        let mut share = (0.25 / length).min(1.0);
        let mut better = false;
        for _ in 0..12 {
            let next: Vec<[f64; 2]> = (0..=n)
                .map(|k| match k {
                    0 => places[0],
                    _ if k == n => places[n],
                    _ => [0, 1].map(|a| places[k][a] - share * by[2 * (k - 1) + a]),
                })
                .collect();
            let (r, m) = equations(sheet, &lifted(&next), &dd, true);
            let (r, m) = (plain(r), plain(m));
            // Near the solution rounding decides, and the full step is right.
            if largest(&r) < largest(&rest) || length < 1e-9 {
                (places, rest, matrix) = (next, r, m);
                better = true;
                break;
            }
            share *= 0.5;
        }
        if length <= 1e-13 {
            return Some((places, step));
        }
        if !better {
            // As far as rounding lets it.
            return (length <= 1e-7).then_some((places, step));
        }
    }
    None
}

/// The last coefficients of a path are rounding if they are less than this of the largest; second
/// derivatives at the ends would have it n^5 / 4 times.
const NOISE: f64 = 2.5e-15;

/// The path in the parameter plane: the straight line and t (1 - t) p(t), with a polynomial p in
/// Chebyshev's of the second kind, so its ends equal the magnets' parameters to the bit.
struct GeodesicPath<T: Real> {
    ends: [[T; 2]; 2],
    /// The second end without its turns.
    last: [T; 2],
    round: [bool; 2],
    coefficients: Vec<[T; 2]>,
}

impl<T: Real> GeodesicPath<T> {
    fn new(
        sheet: &SeamlessSurface<T>,
        [from, last]: [[T; 2]; 2],
        turns: [f64; 2],
        plain: &[[f64; 2]],
    ) -> Result<Self, CallError> {
        let n = plain.len() - 1;
        let ends = [from, [last[0] + turns[0], last[1] + turns[1]]];
        let places = derived(sheet, ends, plain).ok_or_else(super::outcome::tangent)?;
        let [from, to] = ends;
        // The polynomial p at node k is the deviation from the line over sin^2 / 4; its
        // coefficients follow from the orthogonality of sines.
        let coefficient = |j: usize| {
            (1..n).fold([T::zero(); 2], |sum, k| {
                let (t, theta) = (node(k, n), angle(k, n));
                let factor = 8.0 / n as f64 * Real::sin((j + 1) as f64 * theta) / Real::sin(theta);
                [0, 1].map(|a| {
                    let line = from[a] * (1.0 - t) + to[a] * t;
                    sum[a] + (places[k][a] - line) * factor
                })
            })
        };
        let mut coefficients: Vec<[T; 2]> = (0..n - 1).map(coefficient).collect();
        for a in 0..2 {
            let largest = coefficients.iter().fold(1.0, |all: f64, c| all.max(c[a].re().abs()));
            let noise = |c: &&mut [T; 2]| c[a].re().abs() <= NOISE * largest;
            for c in coefficients.iter_mut().rev().take_while(noise) {
                c[a] = c[a] - c[a].re();
            }
        }
        Ok(Self { ends, last, round: sheet.round, coefficients })
    }
}

/// Parameters of the nodes with derivatives with respect to the model's parameters: one step of
/// Newton's method in T, without its real part.
fn derived<T: Real>(
    sheet: &SeamlessSurface<T>,
    [from, to]: [[T; 2]; 2],
    plain: &[[f64; 2]],
) -> Option<Vec<[T; 2]>> {
    let n = plain.len() - 1;
    let mut places: Vec<[T; 2]> = plain.iter().map(|p| p.map(T::from)).collect();
    (places[0], places[n]) = (from, to);
    if T::PARTS == 1 {
        return Some(places);
    }
    let dd = second_derivatives(n);
    let (rest, _) = equations(sheet, &places, &dd, false);
    let mut by: Vec<T> = rest.into_iter().map(|r| r - r.re()).collect();
    if by.iter().any(|r| !r.is_constant()) {
        let at: Vec<[T; 2]> = plain.iter().map(|p| p.map(T::from)).collect();
        let (_, matrix) = equations(sheet, &at, &dd, true);
        let mut matrix: Vec<T> = matrix.into_iter().map(|x| T::from(x.re())).collect();
        solve_dense(&mut matrix, &mut by).ok()?;
        for k in 1..n {
            places[k] = [0, 1].map(|a| places[k][a] - by[2 * (k - 1) + a]);
        }
    }
    Some(places)
}

impl<T: Real> CurveFormula for GeodesicPath<T> {
    type Scalar = T;

    fn at<J: Jet<T>>(&self, t: J) -> Vec3<J> {
        // In y = cos(theta) of the nodes, from 1 to -1.
        let y = t * -2.0 + 1.0;
        let s = -t + 1.0;
        let bump = t * s;
        let place = [0, 1].map(|a| {
            // Clenshaw's recursion for U_j.
            let (mut b1, mut b2) = (J::zero(), J::zero());
            for c in self.coefficients.iter().rev() {
                (b1, b2) = (J::fixed(c[a]) + y * b1 * 2.0 - b2, b1);
            }
            let [from, to] = [self.ends[0][a], self.ends[1][a]];
            s.scaled(from) + t.scaled(to) + bump * b1
        });
        let [mut u, mut v] = within(self.round, place);
        if t.re() == 1.0 {
            // To the bit, whatever turns were taken off.
            (u, v) = (u + (self.last[0].re() - u.re()), v + (self.last[1].re() - v.re()));
        }
        Vec3::new(u, v, J::zero())
    }

    moldloft_num::curve_facts!(smooth, open, not_rational);
}
