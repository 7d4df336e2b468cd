//! Wrong digits and knuckles among points that several lines share: grids, networks.

use crate::interrogate::outliers::{DataFinding, data_findings, detectable};
use moldloft_num::Vec3;

/// Points that differ from their neighbours along lines through numbered points: index of the line,
/// and the finding with the number of the point. A line is given by its points and true if closed.
///
/// A wrong digit shows in all lines that judge its point, or in two of them, a knuckle in one. Points
/// that are `marked` are left out.
///
/// # Example
/// ```
/// use moldloft_fair::line_findings;
/// use moldloft_num::Vec3;
/// let place = |k: usize| Vec3::of((k / 15) as f64, (k % 15) as f64, 0.0);
/// let mut points: Vec<_> = (0..225).map(place).collect();
/// points[65].z = 0.5;
/// let rows = (0..15).map(|i| ((0..15).map(|j| 15 * i + j).collect(), false));
/// let columns = (0..15).map(|j| ((0..15).map(|i| 15 * i + j).collect(), false));
/// let lines: Vec<(Vec<usize>, bool)> = rows.chain(columns).collect();
/// let found = line_findings(&points, &lines, &[]);
/// assert_eq!(found.len(), 1);
/// assert_eq!((found[0].0, found[0].1.index()), (4, 65));
/// ```
pub fn line_findings(
    points: &[Vec3<f64>],
    lines: &[(Vec<usize>, bool)],
    marked: &[usize],
) -> Vec<(usize, DataFinding)> {
    let mut found = Vec::new();
    let (mut seen, mut judged) = (vec![0; points.len()], vec![0; points.len()]);
    for (k, (own, closed)) in lines.iter().enumerate() {
        let row: Vec<Vec3<f64>> = own.iter().map(|&i| points[i]).collect();
        let here = data_findings(&row, *closed);
        // A knuckle is a judgement, too.
        let turns = |k: usize| {
            let knuckle = |f: &DataFinding| matches!(f, DataFinding::Knuckle { .. });
            here.iter().any(|f| knuckle(f) && f.index() == k)
        };
        for (k, (&i, least)) in own.iter().zip(detectable(&row, *closed)).enumerate() {
            judged[i] += usize::from(least.is_finite() || turns(k));
        }
        for mut finding in here {
            let place = own[finding.index()];
            if marked.contains(&place) {
                continue;
            }
            seen[place] += usize::from(matches!(finding, DataFinding::WrongDigit { .. }));
            match &mut finding {
                DataFinding::WrongDigit { index, .. }
                | DataFinding::Knuckle { index, .. }
                | DataFinding::Swapped { index } => {
                    *index = place;
                }
            }
            found.push((k, finding));
        }
    }
    let mut reported = vec![false; points.len()];
    found.retain(|(_, finding)| {
        let i = finding.index();
        let wrong = matches!(finding, DataFinding::WrongDigit { .. });
        !wrong || (seen[i] >= judged[i].min(2) && !std::mem::replace(&mut reported[i], true))
    });
    found
}

/// The fewest points of a line whose knuckles are looked for.
const FEWEST_JUDGED: usize = 7;

/// Knuckles that several lines share. From the findings of [`line_findings`], the line and the
/// point of each knuckle; where a line of the network connects the knuckles of those that cross it,
/// all of these from the first to the last found, and beyond over lines too short to be judged.
///
/// At least two crossing lines turn, and no fewer than half of those between.
pub fn shared_knuckles(
    lines: &[(Vec<usize>, bool)],
    found: &[(usize, DataFinding)],
) -> Vec<(usize, usize)> {
    let knuckle = |f: &&(usize, DataFinding)| matches!(f.1, DataFinding::Knuckle { .. });
    let mut out: Vec<(usize, usize)> =
        found.iter().filter(knuckle).map(|(k, f)| (*k, f.index())).collect();
    let turns = out.clone();
    for (along, (own, _)) in lines.iter().enumerate() {
        // Of each point the lines that cross there and do not end.
        let crossing: Vec<Vec<usize>> = own
            .iter()
            .map(|i| {
                let passes = |k: &usize| {
                    let (other, closed) = &lines[*k];
                    let place = other.iter().position(|j| j == i);
                    place.is_some_and(|c| *closed || (0 < c && c + 1 < other.len()))
                };
                (0..lines.len()).filter(|k| *k != along && passes(k)).collect()
            })
            .collect();
        let sharp = |c: usize| crossing[c].iter().any(|&k| turns.contains(&(k, own[c])));
        let all: Vec<usize> = (0..own.len()).filter(|&c| sharp(c)).collect();
        let [first, .., last] = all[..] else { continue };
        let between = (first..=last).filter(|&c| !crossing[c].is_empty()).count();
        if 2 * all.len() < between {
            continue;
        }
        let short = |c: usize| crossing[c].iter().all(|&k| lines[k].0.len() < FEWEST_JUDGED);
        let from = (0..first).rev().take_while(|&c| short(c)).last().unwrap_or(first);
        let to = (last + 1..own.len()).take_while(|&c| short(c)).last().unwrap_or(last);
        for c in from..=to {
            out.extend(crossing[c].iter().map(|&k| (k, own[c])));
        }
        // The line itself runs on.
        out.retain(|&(k, i)| k != along || turns.contains(&(k, i)));
    }
    out.sort_unstable();
    out.dedup();
    out
}
