//! The same curve in other words: more knots, parts, a higher degree, backwards.

use crate::{BSplineCurve, KnotVector, SplineError};
use moldloft_num::{Real, Vec3};

/// A control point times its weight, and the weight.
type Homogeneous<T> = (Vec3<T>, T);

impl<T: Real> BSplineCurve<T> {
    fn homogeneous(&self) -> Vec<Homogeneous<T>> {
        match &self.weights {
            None => self.points.iter().map(|&p| (p, T::one())).collect(),
            Some(w) => self.points.iter().zip(w).map(|(&p, &w)| (p * w, w)).collect(),
        }
    }

    fn of_homogeneous(&self, knots: KnotVector, net: Vec<Homogeneous<T>>) -> Self {
        match self.weights {
            None => {
                Self { knots, points: net.into_iter().map(|(p, _)| p).collect(), weights: None }
            }
            Some(_) => {
                let (points, weights) = net.into_iter().map(|(p, w)| (p / w, w)).unzip();
                Self { knots, points, weights: Some(weights) }
            }
        }
    }

    /// The same curve with the knot `t` inserted `times` more (Boehm 1980; Piegl and Tiller 1997,
    /// eq. 5.15, once per insertion).
    ///
    /// # Errors
    /// [`SplineError::Outside`] unless 0 < t < 1, [`SplineError::Knots`] if the multiplicity would
    /// exceed `degree`.
    pub fn insert_knot(&self, t: f64, times: usize) -> Result<Self, SplineError> {
        if !(t > 0.0 && t < 1.0) {
            return Err(SplineError::Outside { t });
        }
        let p = self.degree();
        let actual = self.knots.multiplicity(t) + times;
        if actual > p {
            return Err(crate::KnotError::Multiplicity { knot: t, actual, allowed: p }.into());
        }
        let (mut knots, mut net) = (self.knots.clone(), self.homogeneous());
        for _ in 0..times {
            let (k, s, u) = (knots.find_span(t), knots.multiplicity(t), knots.as_slice());
            let mut refined = net[..=k - p].to_vec();
            for i in k - p + 1..=k - s {
                let share = (t - u[i]) / (u[i + p] - u[i]);
                refined.push(mix(net[i - 1], net[i], T::from(share)));
            }
            refined.extend_from_slice(&net[k - s..]);
            (knots, net) = (knots.with_knot(t, 1)?, refined);
        }
        Ok(self.of_homogeneous(knots, net))
    }

    /// The parts before and after `t`, each over [0, 1] with clamped ends at the cut.
    ///
    /// # Errors
    /// [`SplineError::Outside`] unless 0 < t < 1.
    ///
    /// # Example
    /// ```
    /// use moldloft_num::{Curve, Order, Vec3};
    /// use moldloft_spline::BSplineCurve;
    /// let points = vec![Vec3::of(0., 0., 0.), Vec3::of(1., 2., 0.), Vec3::of(2., 0., 0.)];
    /// let curve = BSplineCurve::<f64>::uniform(2, points).unwrap();
    /// let (left, right) = curve.split_at(0.5).unwrap();
    /// assert_eq!(left.jet(1.0, Order::Zero), right.jet(0.0, Order::Zero));
    /// ```
    pub fn split_at(&self, t: f64) -> Result<(Self, Self), SplineError> {
        let p = self.degree();
        let there = self.knots.multiplicity(t);
        let cut = self.insert_knot(t, p.saturating_sub(there))?;
        let (u, net) = (cut.knots.as_slice(), cut.homogeneous());
        let first = u.partition_point(|&k| k < t);
        let after = u.partition_point(|&k| k <= t);
        let mut low = u[..first].to_vec();
        low.extend(std::iter::repeat_n(t, p + 1));
        let mut high = vec![t; p + 1];
        high.extend_from_slice(&u[after..]);
        let (low, high) = (KnotVector::new(p, low)?, KnotVector::new(p, high)?);
        let left = net[..low.points()].to_vec();
        let right = net[net.len() - high.points()..].to_vec();
        Ok((
            self.of_homogeneous(low.normalized(), left),
            self.of_homogeneous(high.normalized(), right),
        ))
    }

    /// The same curve in the next higher degree.
    ///
    /// Each new control point is the polar form F of the curve at consecutive new knots, and F(t_0
    /// … t_p) is the mean of the old polar form over all choices of one t_j left out (Ramshaw 1989,
    /// "Blossoms are polar forms", sections 5 and 8).
    ///
    /// # Errors
    /// [`SplineError::Knots`] above the highest degree.
    pub fn elevate_degree(&self) -> Result<Self, SplineError> {
        let p = self.degree();
        let knots = self.knots.elevated()?;
        let (net, u) = (self.homogeneous(), knots.as_slice());
        let mut raised = Vec::with_capacity(knots.points());
        for i in 0..knots.points() {
            // Any non-empty span in the support will do; the widest is the best conditioned.
            let spans = knots.spans().filter(|&k| i <= k && k <= i + p + 1);
            let span = spans.max_by(|&a, &b| (u[a + 1] - u[a]).total_cmp(&(u[b + 1] - u[b])));
            let span = span.unwrap_or_else(|| knots.find_span(u[i + 1]));
            let old_span = self.knots.find_span(0.5 * (u[span] + u[span + 1]));
            let arguments = &u[i + 1..=i + p + 1];
            let mut sum = (Vec3::zero(), T::zero());
            for left_out in 0..=p {
                let mut kept = arguments.to_vec();
                kept.remove(left_out);
                let (point, weight) = self.polar_form(&net, old_span, &kept);
                sum = (sum.0 + point, sum.1 + weight);
            }
            let share = 1.0 / (p + 1) as f64;
            raised.push((sum.0.map(|x| x * share), sum.1 * share));
        }
        Ok(self.of_homogeneous(knots, raised))
    }

    /// The polar form of the polynomial on `span` at `degree` arguments: de Boor's triangle with a
    /// different argument in each step.
    fn polar_form(&self, net: &[Homogeneous<T>], span: usize, arguments: &[f64]) -> Homogeneous<T> {
        let (p, u) = (self.degree(), self.knots.as_slice());
        let mut d = net[span - p..=span].to_vec();
        for (r, &t) in arguments.iter().enumerate() {
            for j in 0..p - r {
                let (low, high) = (u[span - p + 1 + j + r], u[span + 1 + j]);
                d[j] = mix(d[j], d[j + 1], T::from((t - low) / (high - low)));
            }
        }
        d[0]
    }

    /// The curve run backwards.
    pub fn reversed(&self) -> Self {
        let mut back = Self { knots: self.knots.reversed(), ..self.clone() };
        back.points.reverse();
        if let Some(weights) = &mut back.weights {
            weights.reverse();
        }
        back
    }
}

fn mix<T: Real>(a: Homogeneous<T>, b: Homogeneous<T>, share: T) -> Homogeneous<T> {
    (a.0.lerp(b.0, share), a.1 * (-share + 1.0) + b.1 * share)
}
