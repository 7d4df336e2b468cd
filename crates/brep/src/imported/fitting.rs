//! Polynomial paths in the parameters of a surface, piece by piece.

use super::faces::within;
use super::points::NurbsPoints;
use moldloft_num::{Pace, Vec3};
use moldloft_spline::nurbs::Nurbs;
use std::sync::OnceLock;

/// Degree of a fitted path.
const DEGREE: usize = 7;

/// Maximum number of its pieces.
const MAX_PIECES: usize = 128;

/// The least length of a piece.
const LEAST_PIECE: f64 = 1e-5;

/// A piece is divided at a cut if the cut is not nearer to its ends than this part of it.
const INNER: f64 = 0.2;

/// The nodes of a piece of length 1 (Chebyshev–Lobatto).
fn nodes() -> [f64; DEGREE + 1] {
    std::array::from_fn(|k| {
        (1.0 - libm::cos(std::f64::consts::PI * k as f64 / DEGREE as f64)) / 2.0
    })
}

type Matrix = [[f64; DEGREE + 1]; DEGREE + 1];

/// Control points of the polynomial through points at the nodes.
fn bezier() -> &'static Matrix {
    static MADE: OnceLock<Matrix> = OnceLock::new();
    MADE.get_or_init(|| {
        // The inverse of the matrix of Bernstein's polynomials at the nodes, by elimination.
        let mut left: Matrix = nodes().map(|t| std::array::from_fn(|k| bernstein(k, t)));
        let mut right: Matrix =
            std::array::from_fn(|i| std::array::from_fn(|k| f64::from(u8::from(i == k))));
        for c in 0..=DEGREE {
            let best = (c..=DEGREE).max_by(|&a, &b| left[a][c].abs().total_cmp(&left[b][c].abs()));
            let best = best.unwrap_or(c);
            left.swap(c, best);
            right.swap(c, best);
            let pivot = left[c][c];
            left[c].iter_mut().chain(&mut right[c]).for_each(|x| *x /= pivot);
            let (own_left, own_right) = (left[c], right[c]);
            for r in (0..=DEGREE).filter(|&r| r != c) {
                let factor = left[r][c];
                for k in 0..=DEGREE {
                    left[r][k] -= factor * own_left[k];
                    right[r][k] -= factor * own_right[k];
                }
            }
        }
        right
    })
}

/// Bernstein's polynomial `k` of the degree of a fitted path.
fn bernstein(k: usize, t: f64) -> f64 {
    let choose = (0..k).fold(1.0, |c, i| c * (DEGREE - i) as f64 / (i + 1) as f64);
    choose * power(t, k) * power(1.0 - t, DEGREE - k)
}

fn power(x: f64, n: usize) -> f64 {
    (0..n).fold(1.0, |p, _| p * x)
}

/// A path that is to be followed: its place at each parameter, if it has one.
pub(super) struct FollowedPath<'a> {
    /// The surface.
    pub surface: &'a NurbsPoints<2>,
    /// The place at a parameter.
    pub place: &'a dyn Fn(f64) -> Option<[f64; 2]>,
    /// Parameters in (0, 1) at which it may have a kink, ascending.
    pub kinks: Vec<f64>,
    /// Parameters at which a derivative of it may jump, ascending.
    pub cuts: Vec<f64>,
}

/// Kinks within this distance of a parameter are one.
const SAME_KINK: f64 = 1e-9;

struct FittedPiece {
    to: f64,
    points: [[f64; 2]; DEGREE + 1],
}

/// A path with the places of another within a distance in space, and the distance that is reached.
pub(super) fn followed(goal: &FollowedPath, near: f64) -> Option<(Nurbs<1>, f64)> {
    let mut pieces = Vec::new();
    let mut worst = 0.0f64;
    let mut stops = vec![0.0];
    for &kink in &goal.kinks {
        if kink - stops[stops.len() - 1] > SAME_KINK && 1.0 - kink > SAME_KINK {
            stops.push(kink);
        }
    }
    stops.push(1.0);
    for w in stops.windows(2) {
        divided(goal, near, [w[0], w[1]], &mut pieces, &mut worst)?;
    }
    let mut knots = vec![0.0];
    let mut points = Vec::new();
    let mut from = 0.0;
    for piece in &pieces {
        knots.extend([from; DEGREE]);
        points.extend(piece.points[..DEGREE].iter().map(|p| Vec3::of(p[0], p[1], 0.0)));
        from = piece.to;
    }
    let [u, v] = pieces.last()?.points[DEGREE];
    points.push(Vec3::of(u, v, 0.0));
    knots.extend([1.0; DEGREE + 1]);
    let path = Nurbs {
        degrees: [DEGREE],
        knots: [knots],
        points,
        weights: None,
        error: 0.0,
        exact: true,
        paces: [Pace::Even],
    };
    Some((path, worst))
}

fn divided(
    goal: &FollowedPath,
    near: f64,
    [from, to]: [f64; 2],
    pieces: &mut Vec<FittedPiece>,
    worst: &mut f64,
) -> Option<()> {
    let nodes = nodes();
    let at = |x: f64| if x == 1.0 { to } else { from + (to - from) * x };
    let mut through = [[0.0; 2]; DEGREE + 1];
    for (slot, x) in through.iter_mut().zip(nodes) {
        *slot = (goal.place)(at(x))?;
    }
    let matrix = bezier();
    let mut points: [[f64; 2]; DEGREE + 1] = std::array::from_fn(|i| {
        [0, 1].map(|axis| (0..=DEGREE).map(|k| matrix[i][k] * through[k][axis]).sum())
    });
    (points[0], points[DEGREE]) = (through[0], through[DEGREE]);
    let mut apart = 0.0f64;
    for w in nodes.windows(2) {
        let x = 0.5 * (w[0] + w[1]);
        let own: [f64; 2] =
            [0, 1].map(|axis| (0..=DEGREE).map(|k| bernstein(k, x) * points[k][axis]).sum::<f64>());
        let there = (goal.place)(at(x))?;
        let clipped = |p: [f64; 2]| within(Vec3::of(p[0], p[1], 0.0));
        let [own, there] = [own, there].map(|p| goal.surface.at(clipped(p)));
        apart = apart.max(own.distance(there));
    }
    let whole = to - from;
    if apart <= near || whole < LEAST_PIECE || pieces.len() >= MAX_PIECES {
        *worst = worst.max(apart);
        pieces.push(FittedPiece { to, points });
        return Some(());
    }
    let middle = 0.5 * (from + to);
    let inner = [from + INNER * whole, to - INNER * whole];
    let cuts = goal.cuts.iter().copied().filter(|c| *c > inner[0] && *c < inner[1]);
    let cut = cuts.min_by(|a, b| (a - middle).abs().total_cmp(&(b - middle).abs()));
    let cut = cut.unwrap_or(middle);
    divided(goal, near, [from, cut], pieces, worst)?;
    divided(goal, near, [cut, to], pieces, worst)
}
