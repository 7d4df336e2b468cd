//! Splines of drawings as Bézier curves.

use crate::format::page_curve::{PageCurve, mix};

/// The curves of a spline of degree 1 to 3; rational ones of degree 2.
///
/// # Errors
/// Names a spline that has no exact curves here, or whose numbers do not agree.
pub fn spline_curves(
    degree: usize,
    knots: &[f64],
    points: &[[f64; 2]],
    weights: &[f64],
) -> Result<Vec<PageCurve>, String> {
    if points.is_empty() {
        return Err("SPLINE through points, without control points".into());
    }
    let count = points.len();
    let agree = knots.len() == count + degree + 1 && count > degree;
    let sorted = knots.windows(2).all(|w| w[0] <= w[1]);
    let weighed = weights.is_empty() || weights.len() == count && weights.iter().all(|w| *w > 0.0);
    if !agree || !sorted || !weighed {
        return Err("SPLINE whose numbers do not agree".into());
    }
    if !(1..=3).contains(&degree) {
        return Err(format!("SPLINE of degree {degree}"));
    }
    let first = weights.first().copied().unwrap_or(1.0);
    let rational = weights.iter().any(|w| (w - first).abs() > 1e-12 * first);
    if rational && degree == 3 {
        return Err("rational SPLINE of degree 3".into());
    }
    // Homogeneous control points.
    let weight = |k: usize| if rational { weights[k] } else { 1.0 };
    let lifted: Vec<[f64; 3]> = (0..count)
        .map(|k| [weight(k) * points[k][0], weight(k) * points[k][1], weight(k)])
        .collect();
    let mut out = Vec::new();
    for k in degree..count {
        let [from, to] = [knots[k], knots[k + 1]];
        if to <= from {
            continue;
        }
        let control: Vec<[f64; 3]> = (0..=degree)
            .map(|j| {
                let args: Vec<f64> =
                    (0..degree).map(|i| if i < degree - j { from } else { to }).collect();
                blossom(degree, k, knots, &lifted, &args)
            })
            .collect();
        let place = |j: usize| [control[j][0] / control[j][2], control[j][1] / control[j][2]];
        out.push(match degree {
            1 => PageCurve::Line([place(0), place(1)]),
            2 => {
                let [p, m, q] = [place(0), place(1), place(2)];
                let w = control[1][2] / libm::sqrt(control[0][2] * control[2][2]);
                if (w - 1.0).abs() <= 1e-12 {
                    PageCurve::Cubic([p, mix(p, m, 2.0 / 3.0), mix(q, m, 2.0 / 3.0), q])
                } else if w < 1.0 {
                    PageCurve::Conic([p, m, q], w)
                } else {
                    return Err("hyperbola of a SPLINE".into());
                }
            }
            _ => PageCurve::Cubic([place(0), place(1), place(2), place(3)]),
        });
    }
    Ok(out)
}

/// The polar form of the part of a spline after knot `k` (L. Ramshaw, *Blossoms are polar forms*, 1989).
fn blossom(degree: usize, k: usize, knots: &[f64], points: &[[f64; 3]], args: &[f64]) -> [f64; 3] {
    let mut at: Vec<[f64; 3]> = points[k - degree..=k].to_vec();
    for (level, x) in args.iter().enumerate() {
        for j in 0..degree - level {
            let (low, high) = (knots[k - degree + level + 1 + j], knots[k + 1 + j]);
            let s = (x - low) / (high - low);
            at[j] = [0, 1, 2].map(|c| (1.0 - s) * at[j][c] + s * at[j + 1][c]);
        }
    }
    at[0]
}
