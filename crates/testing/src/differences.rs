//! Derivatives by differences, the independent check of exact ones.

use moldloft_num::Vec3;

/// The ratio of successive steps (Press et al. 2007, section 5.7).
const RATIO: f64 = 1.4;
/// Steps of the scheme: the last is `RATIO`^-7, about a tenth, of the first.
const LEVELS: usize = 8;

/// The derivative of `f` at `x` by Ridders' extrapolation of central differences (Ridders 1982) with a first
/// step of `step`.
pub fn ridders(mut f: impl FnMut(f64) -> f64, x: f64, step: f64) -> f64 {
    ridders_vectors(|h| Some(vec![f(x + h)]), step, LEVELS).expect("a value at each step")[0]
}

/// The derivative of a point at `x`, as [`ridders`].
pub fn ridders_vector(mut f: impl FnMut(f64) -> Vec3<f64>, x: f64, step: f64) -> Vec3<f64> {
    let found = ridders_vectors(|h| Some(f(x + h).to_array().to_vec()), step, LEVELS);
    let found = found.expect("a value at each step");
    Vec3::of(found[0], found[1], found[2])
}

/// The derivatives at 0 of all values of `f`, each with the order that suits it best, from at most `levels`
/// steps; `None` when `f` has no values at one of the steps, or another number of them.
pub fn ridders_vectors(
    mut f: impl FnMut(f64) -> Option<Vec<f64>>,
    mut step: f64,
    levels: usize,
) -> Option<Vec<f64>> {
    let mut rows: Vec<Vec<Vec<f64>>> = Vec::new();
    let (mut best, mut error) = (Vec::new(), Vec::new());
    for i in 0..levels {
        let (high, low) = (f(step)?, f(-step)?);
        let before = rows.first().map_or(high.len(), |row| row[0].len());
        if high.len() != low.len() || high.len() != before {
            return None;
        }
        let quotients = high.iter().zip(&low).map(|(a, b)| (a - b) / (2.0 * step));
        let mut row = vec![quotients.collect::<Vec<f64>>()];
        if i == 0 {
            (best, error) = (row[0].clone(), vec![f64::INFINITY; row[0].len()]);
        }
        let mut factor = RATIO * RATIO;
        for j in 1..=i {
            let extrapolated = |k: usize| {
                let x = (row[j - 1][k] * factor - rows[i - 1][j - 1][k]) / (factor - 1.0);
                let e = (x - row[j - 1][k]).abs().max((x - rows[i - 1][j - 1][k]).abs());
                if e < error[k] {
                    (best[k], error[k]) = (x, e);
                }
                x
            };
            let next: Vec<f64> = (0..before).map(extrapolated).collect();
            row.push(next);
            // Central differences have errors in even powers of the step.
            factor *= RATIO * RATIO;
        }
        rows.push(row);
        step /= RATIO;
    }
    Some(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms() {
        for x in [-1.0, 0.0, 0.3, 2.0] {
            assert!((ridders(f64::exp, x, 0.1) - x.exp()).abs() <= 1e-11 * x.exp());
            let along = ridders_vector(|t| Vec3::of(t.sin(), t * t, 1.0), x, 0.1);
            assert!((along - Vec3::of(x.cos(), 2.0 * x, 0.0)).norm() <= 1e-11);
        }
    }

    #[test]
    fn a_changing_number_of_values_has_no_derivative() {
        let f = |h: f64| Some(vec![0.0; if h > 0.0 { 2 } else { 3 }]);
        assert_eq!(ridders_vectors(f, 0.1, 3), None);
        assert_eq!(ridders_vectors(|h| (h > 0.05).then(|| vec![h]), 0.1, 3), None);
    }
}
