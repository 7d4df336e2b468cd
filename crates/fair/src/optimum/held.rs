//! Directions in which single points do not move, eliminated from the unknowns: the matrix and all
//! forces are projected on the directions that are left, so that a held direction costs no
//! multiplier.

/// A direction.
type V = [f64; 3];

/// Component of a held direction across the others below which it depends on them, relative to its
/// length.
const DEPENDENT: f64 = 1e-9;

/// Of each point with held directions the orthogonal projection on the others; points ascend.
#[derive(Clone, Debug, Default)]
pub(crate) struct HeldDirections {
    points: Vec<(usize, [V; 3])>,
}

impl HeldDirections {
    /// The projections for directions in the coordinates of a frame, in any order.
    pub fn of(mut directions: Vec<(usize, V)>) -> Self {
        directions.sort_by_key(|d| d.0);
        let mut points: Vec<(usize, [V; 3])> = Vec::new();
        for own in directions.chunk_by(|a, b| a.0 == b.0) {
            let mut across: Vec<V> = Vec::new();
            for (_, d) in own {
                let size = d.iter().map(|x| x * x).sum::<f64>().sqrt();
                let mut left = *d;
                for a in &across {
                    let along: f64 = a.iter().zip(left).map(|(a, x)| a * x).sum();
                    left.iter_mut().zip(a).for_each(|(x, a)| *x -= along * a);
                }
                let length = left.iter().map(|x| x * x).sum::<f64>().sqrt();
                if length > DEPENDENT * size {
                    across.push(left.map(|x| x / length));
                }
            }
            let unit = |r: usize, c: usize| f64::from(u8::from(r == c));
            let projection = std::array::from_fn(|r| {
                std::array::from_fn(|c| across.iter().fold(unit(r, c), |sum, a| sum - a[r] * a[c]))
            });
            points.push((own[0].0, projection));
        }
        Self { points }
    }

    /// The component of a vector at a point in the directions in which it moves.
    pub fn project(&self, point: usize, v: V) -> V {
        match self.points.binary_search_by_key(&point, |p| p.0) {
            Ok(k) => self.points[k].1.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum()),
            Err(_) => v,
        }
    }

    /// The projections over unknowns of D coordinates; `place` is the unknown of a point.
    pub fn over<const D: usize>(
        &self,
        place: impl Fn(usize) -> Option<usize>,
    ) -> Vec<(usize, [[f64; D]; D])> {
        let own = |(point, rows): &(usize, [V; 3])| {
            let cut = std::array::from_fn(|r| std::array::from_fn(|c| rows[r][c]));
            place(*point).map(|at| (at, cut))
        };
        self.points.iter().filter_map(own).collect()
    }
}
