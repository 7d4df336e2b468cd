//! Pieces of an intersection, from stations along it.

use super::cut::{
    Both, CutPiece, Guide, NODES, RUN, guess, node, on_guide, polynomial, powers_of, to_powers,
};
use moldloft_locate::march::{Crossing, TracePoint, Unknowns};
use moldloft_num::{Order, Real, Vec3};

/// Maximum relative error of the speed along a piece: lengths are then exact to rounding, and
/// independent of the stations.
const SPEED_ACCURACY: f64 = 1e-12;

/// Maximum error of the unknowns along a piece, relative to the size in space: points are on both
/// shapes to rounding.
const PLACE_ACCURACY: f64 = 1e-13;

/// Stations within this fraction of the size are one, whose directions differ at a crease.
const SAME_STATION: f64 = 1e-13;
const SAME_DIRECTION: f64 = 1e-6;

/// A stretch between stations is halved this many times at most.
const MOST_HALVINGS: u32 = 8;

/// Points besides the ends at which a fit is checked.
const CHECKS: [f64; 3] = [-0.95, -0.1, 0.9];

/// End of pieces: a station and, at a joint of a surface, the number of the unknown and its value
/// there.
#[derive(Clone, Copy)]
pub(super) struct PieceEnd {
    pub station: TracePoint,
    pub joint: Option<(usize, f64)>,
}

impl From<TracePoint> for PieceEnd {
    fn from(station: TracePoint) -> Self {
        Self { station, joint: None }
    }
}

/// True for the two stations at a seam: the same point, with an unknown that is 0 here and 1 there.
pub(super) fn at_seam(a: &TracePoint, b: &TracePoint) -> bool {
    (0..4).any(|k| (a.q[k] - b.q[k]).abs() > 0.5)
}

/// The cubic of the positions and tangents of both ends.
fn cubic(a: &TracePoint, b: &TracePoint) -> Guide {
    let half = 0.5 * a.x.distance(b.x);
    let (s, t) = (a.tangent * half, b.tangent * half);
    let chord = b.x - a.x;
    [
        (a.x + b.x) * 0.5 + (s - t) * 0.25,
        chord * 0.75 - (s + t) * 0.25,
        (t - s) * 0.25,
        (s + t) * 0.25 - chord * 0.25,
    ]
}

/// A stretch with a cubic near it, in plain numbers.
pub(super) struct PieceFit {
    guide: Guide,
    /// The unknowns at the nodes.
    at: [Unknowns; NODES],
    pub ends: [PieceEnd; 2],
    /// True after a seam.
    seam: bool,
    /// See [`CutPiece`].
    exact: bool,
}

/// Derivative of the length with respect to y at the point of the intersection opposite to the guide's: with (X - c) . c' = 0,
/// X' . c' = c' . c' - (X - c) . c''. `None` where the point is so far from the guide that it moves
/// back as the guide goes on; the tangent may have either sense.
fn speed<T: Real>([c, d, dd]: [Vec3; 3], x: Vec3<T>, tangent: Vec3<T>) -> Option<T> {
    let [c, d, dd] = [c, d, dd].map(Vec3::<T>::lifted);
    let (advance, along) = (d.dot(d) - (x - c).dot(dd), d.dot(tangent));
    let along = if along.re() < 0.0 { -along } else { along };
    (advance.re() > 0.0 && along.re() > 0.0).then(|| advance / along)
}

/// True when a stretch leads from one end to the other in the sense of its tangents at both.
fn runs_on(a: &TracePoint, b: &TracePoint) -> bool {
    let chord = b.x - a.x;
    chord.dot(a.tangent) > 0.0 && chord.dot(b.tangent) > 0.0
}

/// The unknowns between two stations, from their values and rates at both.
fn between(a: &TracePoint, b: &TracePoint, y: f64) -> Unknowns {
    let chord = a.x.distance(b.x);
    let (s, r) = (0.5 + 0.5 * y, 0.5 - 0.5 * y);
    std::array::from_fn(|k| {
        a.q[k] * (r * r * (1.0 + 2.0 * s))
            + a.rate[k] * (chord * r * r * s)
            + b.q[k] * (s * s * (3.0 - 2.0 * s))
            - b.rate[k] * (chord * s * s * r)
    })
}

type Matrix = [[f64; NODES]; NODES];

impl PieceFit {
    /// The part between two stops, and whether its speed and its unknowns are polynomials.
    fn new(
        crossing: &Crossing<'_>,
        matrix: &Matrix,
        a: &PieceEnd,
        b: &PieceEnd,
    ) -> Option<(Self, bool)> {
        let ends = [*a, *b];
        let (a, b) = (&a.station, &b.station);
        let guide = cubic(a, b);
        let found = |y: f64, guess: Unknowns| {
            let jet = on_guide(&guide, y);
            let station = crossing.station_across(guess, jet[0], jet[1].normalized()?)?;
            Some((station.q, speed(jet, station.x, station.tangent)?))
        };
        let (mut at, mut speeds) = ([[0.0; 4]; NODES], [0.0; NODES]);
        for k in 0..NODES {
            (at[k], speeds[k]) = found(node(k), between(a, b, node(k)))?;
        }
        let (places, fit) = (powers(matrix, &at), powers_of(matrix, &speeds));
        let near = |y: f64, speed: f64| {
            let value = polynomial(&fit, y)[0];
            (value - speed).abs() <= SPEED_ACCURACY * value.abs()
        };
        let there = |y: f64, q: &Unknowns| {
            crossing.distance(q, &guess(&places, y)) <= PLACE_ACCURACY * crossing.size
        };
        // At its ends the position is the cubic's and the tangent its own, unless the surface has a
        // crease.
        let along =
            |k: usize, y: f64| ends[k].joint.is_some() || near(y, on_guide(&guide, y)[1].norm());
        let mut good = along(0, -1.0) && along(1, 1.0);
        let mut exact = there(-1.0, &a.q) && there(1.0, &b.q);
        for y in CHECKS {
            if good && exact {
                let (q, speed) = found(y, guess(&places, y))?;
                good = near(y, speed);
                exact = there(y, &q);
            }
        }
        Some((Self { guide, at, ends, seam: false, exact }, good && exact))
    }
}

/// Coefficients of the unknowns in powers of y, relative to the middle, so that rounding is
/// relative to the variation.
fn powers(matrix: &Matrix, at: &[Unknowns; NODES]) -> [Unknowns; NODES] {
    let base = at[NODES / 2];
    let each: [[f64; NODES]; 4] = std::array::from_fn(|k| {
        let mut all = powers_of(matrix, &std::array::from_fn(|n| at[n][k] - base[k]));
        all[0] += base[k];
        all
    });
    std::array::from_fn(|p| std::array::from_fn(|k| each[k][p]))
}

/// The stretches between the stops, halved until the speed of each is a polynomial; `None` where
/// they cannot be followed.
pub(super) fn fitted(crossing: &Crossing<'_>, stops: &[PieceEnd]) -> Option<Vec<PieceFit>> {
    let matrix = to_powers();
    let mut all: Vec<PieceFit> = Vec::with_capacity(stops.len());
    let mut seam = false;
    for pair in stops.windows(2) {
        // Stations coincide at a seam or a crease, and where a closed branch comes back to its start.
        let [a, b] = [&pair[0].station, &pair[1].station];
        if at_seam(a, b) || a.x.distance(b.x) <= SAME_STATION * crossing.size {
            seam |= at_seam(a, b) || a.tangent.distance(b.tangent) > SAME_DIRECTION;
            continue;
        }
        let mut a = pair[0];
        let mut open = vec![(pair[1], 0)];
        while let Some((b, halvings)) = open.pop() {
            if !runs_on(&a.station, &b.station) {
                return None;
            }
            let fit = PieceFit::new(crossing, &matrix, &a, &b);
            let good = fit.as_ref().is_some_and(|(_, good)| *good);
            let middle = || {
                let [c, d, _] = on_guide(&cubic(&a.station, &b.station), 0.0);
                let guess = match &fit {
                    Some((fit, _)) => guess(&powers(&matrix, &fit.at), 0.0),
                    None => between(&a.station, &b.station, 0.0),
                };
                let mut m = crossing.station_across(guess, c, d.normalized()?)?;
                if m.tangent.dot(a.station.tangent) < 0.0 {
                    m.tangent = -m.tangent;
                    m.rate = m.rate.map(|r| -r);
                }
                Some(PieceEnd::from(m))
            };
            match (!good && halvings < MOST_HALVINGS).then(middle).flatten() {
                Some(m) => open.extend([(b, halvings + 1), (m, halvings + 1)]),
                None => {
                    all.push(PieceFit { seam, ..fit?.0 });
                    (a, seam) = (b, false);
                }
            }
        }
    }
    Some(all)
}

/// A piece, with the motion of its ends along it: the point at a joint of the surface changes with
/// the model's parameters. `joint` gives it.
pub(super) fn laid<T: Real>(
    both: &Both<T>,
    fit: &PieceFit,
    begin: T,
    joint: impl Fn(&Unknowns, (usize, f64)) -> Option<Vec3<T>>,
) -> Option<CutPiece<T>> {
    let matrix = to_powers();
    let (mut speeds, mut xs) = ([T::zero(); NODES], [Vec3::<T>::zero(); NODES]);
    for k in 0..NODES {
        let y = node(k);
        let jet = on_guide(&fit.guide, y);
        let q = both.unknowns(&fit.guide, fit.at[k], T::from(y))?;
        let along = both.along(q, jet[1], Order::First)?;
        speeds[k] = speed(jet, along.x, along.tangent)?;
        xs[k] = along.x;
    }
    let powers_of_speed = powers_of(&matrix, &speeds);
    let mut run = [T::zero(); RUN];
    for (p, c) in powers_of_speed.iter().enumerate() {
        run[p + 1] = *c / (p + 1) as f64;
    }
    let mut length = polynomial(&run, 1.0)[0];
    run[0] = -polynomial(&run, -1.0)[0];
    length += run[0];
    // Distance of the joint beyond the end of the piece, as far as it depends on parameters; on its
    // own side of the joint, since the surface may have a crease there.
    let beyond = |k: usize| -> Option<T> {
        let at = fit.ends[k].joint.filter(|_| T::PARTS > 1)?;
        let place = joint(&fit.ends[k].station.q, at)?;
        let y = [-1.0, 1.0][k];
        let own = [0, 1, 2].map(|axis| {
            let values = std::array::from_fn(|n| xs[n][axis]);
            polynomial(&powers_of(&matrix, &values), y)
        });
        let [x, d] = [0, 1].map(|k| Vec3::new(own[0][k], own[1][k], own[2][k]));
        let tangent = Vec3::<T>::lifted(d.re().normalized()?);
        let far = tangent.dot(place - x);
        Some(far - far.re())
    };
    if let Some(far) = beyond(0) {
        run[0] -= far;
        length -= far;
    }
    if let Some(far) = beyond(1) {
        length += far;
    }
    let places = powers(&matrix, &fit.at);
    Some(CutPiece {
        begin,
        length,
        guide: fit.guide,
        run,
        within: both.bounds_at(&places[0]),
        places,
        joint: fit.seam || fit.ends[0].joint.is_some(),
        exact: fit.exact,
    })
}
