//! Wrong digits and knuckles among points that several lines share: grids, networks.

use crate::interrogate::outliers::{DataFinding, data_findings, detectable};
use moldloft_num::Vec3;

/// Points that differ from their neighbours along lines through numbered points, as the index of
/// the line and the finding with the number of the point. A line is its points and whether it is
/// closed.
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
