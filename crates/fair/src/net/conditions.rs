//! Linear conditions on the surface of a net: points, tangent planes, area, volume.

use crate::curve::condition::{AXES, across};
use crate::{Condition, FairError, Network, Space};
use moldloft_num::{GAUSS_4, Vec3};

/// The basis functions of one direction at a parameter: control points, values and slopes.
struct BasisValues {
    columns: Vec<usize>,
    values: [Vec<f64>; 2],
}

impl BasisValues {
    fn of(space: &Space, t: f64) -> Self {
        let (k, t) = space.locate(t);
        let basis = space.basis(k, t);
        let values = [0, 1].map(|order| basis.rows[order].to_vec());
        Self { columns: space.columns(k).collect(), values }
    }
}

/// Stencil of the surface at a point: for each control point its coefficients in the position and
/// in the derivatives by u and v, with the spaces' knots.
struct ControlStencil(Vec<(usize, [f64; 3])>);

impl ControlStencil {
    fn of(u: &BasisValues, v: &BasisValues, count: usize, weights: Option<&[f64]>) -> Self {
        let mut all = Vec::with_capacity(u.columns.len() * v.columns.len());
        for (a, &i) in u.columns.iter().enumerate() {
            for (b, &j) in v.columns.iter().enumerate() {
                let at = i * count + j;
                let w = weights.map_or(1.0, |w| w[at]);
                let product = |k: usize, l: usize| w * u.values[k][a] * v.values[l][b];
                all.push((at, [product(0, 0), product(1, 0), product(0, 1)]));
            }
        }
        if weights.is_some() {
            // (x / w)' = x' / w - x w' / w^2, linear in the points as the weights stay.
            let total = |k: usize| all.iter().map(|e| e.1[k]).sum::<f64>();
            let (w, wu, wv) = (total(0), total(1), total(2));
            for (_, [p, u, v]) in &mut all {
                (*u, *v) = (*u / w - *p * wu / (w * w), *v / w - *p * wv / (w * w));
                *p /= w;
            }
        }
        Self(all)
    }

    /// Position or a derivative.
    fn sum(&self, order: usize, points: &[Vec3<f64>]) -> Vec3<f64> {
        self.0.iter().fold(Vec3::zero(), |s, (i, x)| s + points[*i] * x[order])
    }

    fn entries(&self, order: usize, axis: Vec3<f64>) -> Vec<(usize, Vec3<f64>)> {
        self.0.iter().map(|(i, x)| (*i, axis * x[order])).collect()
    }
}

impl Network {
    fn spaces(&self) -> Result<(&[Space; 2], Option<&[f64]>), FairError> {
        let none = FairError::Count { what: "directions of a net", expected: 2, actual: 0 };
        self.net_parts().ok_or(none)
    }

    fn place(&self, at: [f64; 2]) -> Result<ControlStencil, FairError> {
        let (spaces, weights) = self.spaces()?;
        let line = |k: usize| {
            let (start, end) = spaces[k].domain();
            BasisValues::of(&spaces[k], start + (end - start) * at[k])
        };
        Ok(ControlStencil::of(&line(0), &line(1), spaces[1].count(), weights))
    }

    /// The surface passes through a point at (u, v) in [0, 1]: three conditions.
    ///
    /// # Errors
    /// [`FairError::Count`] when the network is not a net.
    pub fn point_condition(
        &self,
        at: [f64; 2],
        through: Vec3<f64>,
    ) -> Result<Vec<Condition>, FairError> {
        let place = self.place(at)?;
        let one = |a: Vec3<f64>| Condition { entries: place.entries(0, a), value: a.dot(through) };
        Ok(AXES.map(one).to_vec())
    }

    /// The surface's tangent plane at (u, v) in [0, 1] is perpendicular to a normal: two
    /// conditions.
    ///
    /// # Errors
    /// As [`Network::point_condition`].
    pub fn normal_condition(
        &self,
        at: [f64; 2],
        normal: Vec3<f64>,
    ) -> Result<Vec<Condition>, FairError> {
        let place = self.place(at)?;
        let normal = normal.normalized().unwrap_or(AXES[2]);
        let one = |order| Condition { entries: place.entries(order, normal), value: 0.0 };
        Ok(vec![one(1), one(2)])
    }

    /// The surface's derivative by u (`along` 0) or v (1) at (u, v) in [0, 1] is parallel to a
    /// vector: two conditions.
    ///
    /// # Errors
    /// As [`Network::point_condition`].
    pub fn tangent_condition(
        &self,
        at: [f64; 2],
        along: usize,
        direction: Vec3<f64>,
    ) -> Result<Vec<Condition>, FairError> {
        let place = self.place(at)?;
        let (a, b) = across(direction);
        let one = |axis| Condition { entries: place.entries(1 + along.min(1), axis), value: 0.0 };
        Ok(vec![one(a), one(b)])
    }

    /// The volume between the faired and the original surface of a net is zero to first order, so
    /// that a hull keeps its displacement: the sum over the control points of their moves times the
    /// integral of their basis function along S_u x S_v.
    ///
    /// # Errors
    /// As [`Network::point_condition`].
    pub fn volume_condition(&self) -> Result<Condition, FairError> {
        self.integral(|u, v| [u.cross(v), Vec3::zero(), Vec3::zero()])
    }

    /// The area is preserved to first order: |S_u x S_v| changes by N . (dS_u x S_v + S_u x dS_v).
    ///
    /// # Errors
    /// As [`Network::point_condition`].
    pub fn area_condition(&self) -> Result<Condition, FairError> {
        self.integral(|u, v| match u.cross(v).normalized() {
            Some(n) => [Vec3::zero(), v.cross(n), n.cross(u)],
            None => [Vec3::zero(); 3],
        })
    }

    /// An integral over the parameters keeps its value to first order; `slopes` are its derivatives
    /// by position, S_u and S_v, where these last are given.
    fn integral(
        &self,
        slopes: impl Fn(Vec3<f64>, Vec3<f64>) -> [Vec3<f64>; 3],
    ) -> Result<Condition, FairError> {
        let (spaces, weights) = self.spaces()?;
        let [u, v] = spaces.each_ref().map(|space| {
            let mut out = Vec::new();
            for k in space.spans() {
                let (a, b) = (space.knot(k), space.knot(k + 1));
                for (x, w) in GAUSS_4 {
                    let t = 0.5 * (a + b) + 0.5 * (b - a) * x;
                    out.push((0.5 * (b - a) * w, BasisValues::of(space, t)));
                }
            }
            out
        });
        let mut slope = vec![Vec3::zero(); self.points.len()];
        for (ws, lu) in &u {
            for (wt, lv) in &v {
                let place = ControlStencil::of(lu, lv, spaces[1].count(), weights);
                let by = slopes(place.sum(1, &self.points), place.sum(2, &self.points));
                for (i, x) in &place.0 {
                    for k in 0..3 {
                        slope[*i] += by[k] * (x[k] * ws * wt);
                    }
                }
            }
        }
        let mut condition =
            Condition { entries: slope.into_iter().enumerate().collect(), value: 0.0 };
        condition.value = condition.at(&self.points);
        Ok(condition)
    }
}
