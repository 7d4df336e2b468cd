//! Conditions across a shared edge of two surfaces; see [`super::patches`].

use crate::curve::condition::AXES;
use crate::optimum::Bend;
use crate::{Condition, EndContinuity, FairError};
use moldloft_num::{Real, Vec3};

/// Conditions across one seam.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SeamCondition {
    /// Points along the seam, from it into each sheet: for each control point on the seam.
    pub rows: [Vec<Vec<usize>>; 2],
    /// Derivatives into each sheet by those rows.
    pub factors: [[Vec<f64>; 2]; 2],
    /// The continuity across it.
    pub keeps: EndContinuity,
}

impl SeamCondition {
    /// D and D' (into the sheet) of one side at control point `j`.
    fn slopes<T: Real>(&self, side: usize, j: usize, points: &[Vec3<T>]) -> [Vec3<T>; 2] {
        [0, 1].map(|order| {
            let row = self.factors[side][order].iter().zip(&self.rows[side][j]);
            row.fold(Vec3::zero(), |s, (f, &i)| s + points[i] * T::from(*f))
        })
    }

    /// b and c of the seam.
    fn ratios<T: Real>(&self, points: &[Vec3<T>]) -> Result<[T; 2], FairError> {
        let all: Vec<[[Vec3<T>; 2]; 2]> = (0..self.rows[0].len())
            .map(|j| {
                // The first side runs towards the seam.
                let [d, dd] = self.slopes(0, j, points);
                [[-d, dd], self.slopes(1, j, points)]
            })
            .collect();
        let sum =
            |f: &dyn Fn(&[[Vec3<T>; 2]; 2]) -> T| all.iter().map(f).fold(T::zero(), |s, x| s + x);
        let length = sum(&|[a, _]| a[0].norm_sq());
        if length.re() <= 0.0 || !length.is_finite() {
            return Err(FairError::Singular);
        }
        let b = sum(&|[a, e]| e[0].dot(a[0])) / length;
        if b.re() <= 0.0 {
            return Err(FairError::TurnsBack);
        }
        let c = sum(&|[a, e]| (e[1] - a[1] * (b * b)).dot(a[0])) / length;
        Ok([b, c])
    }

    /// The conditions: E - b D = 0, then E' - b² D' - c D = 0, at each control point along each axis.
    pub fn conditions(&self, points: &[Vec3<f64>]) -> Result<Vec<Condition>, FairError> {
        if self.keeps.kept() < 2 {
            return Ok(Vec::new());
        }
        let [b, c] = self.ratios(points)?;
        let mut out = Vec::new();
        for j in 0..self.rows[0].len() {
            let side = |side: usize, order: usize, factor: f64| {
                let row = self.factors[side][order].iter().zip(&self.rows[side][j]);
                row.map(move |(f, &i)| (i, f * factor)).collect::<Vec<_>>()
            };
            let mut add = |parts: Vec<Vec<(usize, f64)>>| {
                // A point of the seam has a factor from each side.
                let mut entries: Vec<(usize, f64)> = Vec::new();
                for (i, f) in parts.into_iter().flatten().filter(|(_, f)| *f != 0.0) {
                    match entries.iter_mut().find(|(k, _)| *k == i) {
                        Some((_, sum)) => *sum += f,
                        None => entries.push((i, f)),
                    }
                }
                for axis in AXES {
                    let entries = entries.iter().map(|(i, f)| (*i, axis * *f)).collect();
                    out.push(Condition { entries, value: 0.0 });
                }
            };
            // D runs towards the seam: against the derivative into the first sheet.
            add(vec![side(1, 0, 1.0), side(0, 0, b)]);
            if self.keeps.kept() >= 3 {
                add(vec![side(1, 1, 1.0), side(0, 1, -b * b), side(0, 0, c)]);
            }
        }
        Ok(out)
    }

    /// How the factors of the conditions change with b and c, which change with the points given; the
    /// conditions count from `first`.
    pub fn bends<T: Real>(
        &self,
        given: &[Vec3<T>],
        first: usize,
    ) -> Result<Vec<Bend<T>>, FairError> {
        if self.keeps.kept() < 2 {
            return Ok(Vec::new());
        }
        let [b, c] = self.ratios(given)?;
        let change = |x: T| x - T::from(x.re());
        let (db, dbb, dc) = (change(b), change(b * b), change(c));
        let mut out: Vec<Bend<T>> = Vec::new();
        let mut add = |parts: &[(usize, usize, T)]| {
            for axis in AXES {
                let entry = |&(j, order, by): &(usize, usize, T)| {
                    let row = self.factors[0][order].iter().zip(&self.rows[0][j]);
                    row.map(move |(f, &i)| (i, axis.map(|x| by * (f * x)))).collect::<Vec<_>>()
                };
                out.push((first + out.len(), parts.iter().flat_map(entry).collect()));
            }
        };
        for j in 0..self.rows[0].len() {
            add(&[(j, 0, db)]);
            if self.keeps.kept() >= 3 {
                add(&[(j, 1, -dbb), (j, 0, dc)]);
            }
        }
        Ok(out)
    }
}
