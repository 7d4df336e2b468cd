//! Branches of intersections, turned to their start and cut at their ends.

use super::pieces::at_seam;
use moldloft_locate::march::{Branch, Crossing, TracePoint};
use moldloft_num::Vec3;

/// A point of a branch, and the station before it.
pub(super) type BranchPlace = (usize, TracePoint);

/// The place of the point `x` on a branch; `None`: it is farther away than the tolerance.
pub(super) fn place_at(
    crossing: &Crossing<'_>,
    branch: &Branch,
    x: Vec3,
    tolerance: f64,
) -> Option<BranchPlace> {
    let nearest = (0..branch.stations.len().saturating_sub(1))
        .filter_map(|i| {
            let (a, b) = (&branch.stations[i], &branch.stations[i + 1]);
            let chord = b.x - a.x;
            let (share, away) = nearest_on_chord(a, b, x);
            let guess = std::array::from_fn(|k| a.q[k] + share * (b.q[k] - a.q[k]));
            (away <= 0.3 * chord.norm() + tolerance).then_some((away, i, guess))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let at_seams = seam_at(&branch.stations, x, SEAM * crossing.size);
    if let Some(i) = at_seams.filter(|_| branch.closed()) {
        return Some((i, branch.stations[i]));
    }
    let (_, i, guess) = nearest?;
    let q = crossing.across(guess, x, branch.stations[i].tangent)?;
    let station = crossing.station(q)?;
    (station.x.distance(x) <= tolerance).then_some((i, station))
}

/// Turns a closed branch to its start, by default the point nearest to `reference`, and cuts it at
/// its end. Returns true if it is whole from a seam to the seam, where it may have a corner.
pub(super) fn turn_to_start(
    crossing: &Crossing<'_>,
    branch: &mut Branch,
    [start, end]: [Option<BranchPlace>; 2],
    reference: Vec3,
) -> bool {
    branch.stations.pop();
    let start = start.or_else(|| nearest_station(crossing, &branch.stations, reference));
    let seam =
        start.and_then(|(_, station)| seam_at(&branch.stations, station.x, SEAM * crossing.size));
    if let Some(i) = seam {
        branch.stations.rotate_left(i);
    } else if let Some((i, station)) = start {
        let count = branch.stations.len();
        branch.stations.rotate_left((i + 1) % count);
        if end.is_none() {
            branch.stations.insert(0, station);
        } else {
            // A branch that was followed from its start has stations there.
            if let [.., before, last] = &branch.stations[..]
                && is_at(last, &station, before)
            {
                branch.stations.pop();
            }
            begin_at(branch, station);
        }
    }
    let from_seam = seam.is_some() && end.is_none();
    if !from_seam {
        let begin = branch.stations[0];
        branch.stations.push(begin);
    }
    if let Some((_, station)) = end {
        cut_after(branch, &station);
    }
    from_seam
}

/// Gives an open branch the direction from its start to its end, and cuts it there; from a start
/// alone it leads to the farther end.
pub(super) fn cut_open(branch: &mut Branch, places: [Option<BranchPlace>; 2]) {
    let order =
        |(i, s): BranchPlace| (i, (s.x - branch.stations[i].x).dot(branch.stations[i].tangent));
    let reversed = match places {
        [Some(start), Some(end)] => {
            let (a, b) = (order(start), order(end));
            b.0 < a.0 || a.0 == b.0 && b.1 < a.1
        }
        [Some((i, _)), None] => i * 2 > branch.stations.len(),
        [None, Some((i, _))] => i * 2 < branch.stations.len(),
        [None, None] => false,
    };
    let turned = |s: TracePoint| {
        if reversed { TracePoint { tangent: -s.tangent, rate: s.rate.map(|r| -r), ..s } } else { s }
    };
    if reversed {
        branch.stations.reverse();
        branch.ends.swap(0, 1);
        branch.stations.iter_mut().for_each(|s| *s = turned(*s));
    }
    if let Some((_, station)) = places[1] {
        cut_after(branch, &turned(station));
    }
    if let Some((_, station)) = places[0] {
        cut_before(branch, &turned(station));
    }
}

/// Distance within which a station at a seam is a start, relative to the size.
const SEAM: f64 = 1e-9;

/// The station beyond a seam, of two at the point `x`, within a distance; the stations are a closed branch.
fn seam_at(stations: &[TracePoint], x: Vec3, near: f64) -> Option<usize> {
    let n = stations.len();
    (0..n).find(|&i| {
        stations[i].x.distance(x) <= near && at_seam(&stations[(i + n - 1) % n], &stations[i])
    })
}

/// The point of a closed branch nearest to `m`, between which stations it is and itself; the last
/// station is not the first again.
fn nearest_station(
    crossing: &Crossing<'_>,
    stations: &[TracePoint],
    m: Vec3,
) -> Option<(usize, TracePoint)> {
    let n = stations.len();
    let along = |s: &TracePoint| (s.x - m).dot(s.tangent);
    let k = (0..n).min_by(|&a, &b| {
        stations[a].x.distance(m).total_cmp(&stations[b].x.distance(m)).then(a.cmp(&b))
    })?;
    let i = if along(&stations[k]) > 0.0 { (k + n - 1) % n } else { k };
    let (mut a, mut b) = (stations[i], stations[(i + 1) % n]);
    if at_seam(&a, &b) {
        return Some((i, a));
    }
    let (mut f, mut g) = (along(&a), along(&b));
    if f > 0.0 || g < 0.0 {
        return Some((i, a));
    }
    for round in 0..80 {
        if b.x.distance(a.x) <= 1e-13 * crossing.size {
            break;
        }
        // False position, and halving when that is slow.
        let share = if round % 3 == 2 || g == f { 0.5 } else { (-f / (g - f)).clamp(0.0, 1.0) };
        let x = a.x + (b.x - a.x) * share;
        let guess = std::array::from_fn(|k| a.q[k] + share * (b.q[k] - a.q[k]));
        let d = (b.x - a.x).normalized()?;
        let mut s = crossing.station(crossing.across_near(guess, x, d)?)?;
        if s.tangent.dot(a.tangent) < 0.0 {
            s.tangent = -s.tangent;
            s.rate = s.rate.map(|r| -r);
        }
        let h = along(&s);
        if h.abs() <= 1e-14 * crossing.size {
            return Some((i, s));
        }
        if h < 0.0 { (a, f) = (s, h) } else { (b, g) = (s, h) }
    }
    Some((i, a))
}

fn cut_after(branch: &mut Branch, station: &TracePoint) {
    let at = position(branch, station);
    branch.stations.truncate(at + 1);
    push_apart(branch, *station);
}

fn cut_before(branch: &mut Branch, station: &TracePoint) {
    let at = position(branch, station);
    branch.stations.drain(..=at);
    begin_at(branch, *station);
}

/// Puts a station before the others, or in place of the first if it is there.
fn begin_at(branch: &mut Branch, station: TracePoint) {
    match &branch.stations[..] {
        [first, next, ..] if is_at(first, &station, next) => branch.stations[0] = station,
        [first] if first.x.distance(station.x).is_finite() => branch.stations[0] = station,
        _ => branch.stations.insert(0, station),
    }
}

/// True if a station is at another one, for what the next station is away.
fn is_at(station: &TracePoint, other: &TracePoint, next: &TracePoint) -> bool {
    station.x.distance(other.x) < 1e-6 * next.x.distance(station.x)
}

/// Position of the nearest point on the chord between two stations, as a fraction, and its
/// distance; at a crease the stations coincide.
fn nearest_on_chord(a: &TracePoint, b: &TracePoint, x: Vec3) -> (f64, f64) {
    let chord = b.x - a.x;
    let length = chord.norm_sq();
    let share = if length > 0.0 { ((x - a.x).dot(chord) / length).clamp(0.0, 1.0) } else { 0.0 };
    (share, (a.x + chord * share).distance(x))
}

/// The last station before the given one.
fn position(branch: &Branch, station: &TracePoint) -> usize {
    let away =
        |i: &usize| nearest_on_chord(&branch.stations[*i], &branch.stations[*i + 1], station.x).1;
    let last = branch.stations.len().saturating_sub(1);
    (0..last).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0)
}

fn push_apart(branch: &mut Branch, station: TracePoint) {
    let count = branch.stations.len();
    let last = branch.stations[count - 1];
    let before =
        if count > 1 { branch.stations[count - 2].x.distance(last.x) } else { f64::INFINITY };
    if count > 1 && last.x.distance(station.x) < 1e-6 * before {
        branch.stations[count - 1] = station;
    } else {
        branch.stations.push(station);
    }
}
