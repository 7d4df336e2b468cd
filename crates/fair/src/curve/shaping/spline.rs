//! Shapes of splines whose control points hang on other unknowns: those of a network's curves.

use super::{CollinearPoints, CurvePlane, ShapeConstraints, refused};
use crate::curve::shape_condition::ShapeCondition;
use crate::optimum::ControlInequality;
use crate::{FairError, Space};
use moldloft_num::Vec3;

impl ShapeConstraints {
    /// Points on one line, in a direction where it is known.
    pub(crate) fn straight(points: Vec<usize>, along: Option<Vec3<f64>>) -> Self {
        let line = CollinearPoints { points, along, through: None, owner: 0 };
        Self { lines: vec![line], ..Self::default() }
    }

    /// The signs and limits of a spline with its data at these parameters, whose control points hang on
    /// other unknowns; spans of straight runs are left out. What is held otherwise is not taken. `bulge` is the
    /// direction to which a part that turns one way bends, where that is known.
    ///
    /// # Errors
    /// [`FairError::Shapeless`].
    pub(crate) fn of_spline(
        space: &Space,
        control: &[Vec3<f64>],
        at: &[f64],
        runs: &[[f64; 2]],
        wanted: &[(usize, &ShapeCondition)],
        bulge: &dyn Fn([usize; 2]) -> Option<Vec3<f64>>,
    ) -> Result<Self, FairError> {
        let mut out = Self { plane: CurvePlane::of(space, control), ..Self::default() };
        for run in runs {
            out.taken(space, *run);
        }
        for &(owner, condition) in wanted {
            match condition {
                ShapeCondition::Within { direction, most } => {
                    out.limit(owner, *direction, *most)?
                }
                ShapeCondition::Turn { .. } | ShapeCondition::OneWay { .. }
                    if out.plane.is_none() =>
                {
                    return Err(refused(
                        owner,
                        "a curve in space has no sign of curvature: shape its projections",
                    ));
                }
                ShapeCondition::OneWay { between } => {
                    let left = bulge(*between).zip(out.plane).map(|(bulge, plane)| {
                        let along = control[control.len() - 1] - control[0];
                        along.cross(bulge).dot(plane.normal()) > 0.0
                    });
                    let turn = left.map(|left| ShapeCondition::Turn { between: *between, left });
                    out.turned(space, at, owner, turn.as_ref().unwrap_or(condition));
                }
                _ => out.turned(space, at, owner, condition),
            }
        }
        Ok(out)
    }

    /// The half-spaces of signs and limits made linear at a spline, with what they are now: lengths,
    /// negative where they are left.
    pub(crate) fn spline_halves(
        &self,
        space: &Space,
        control: &[Vec3<f64>],
    ) -> Vec<(ControlInequality, f64)> {
        let own = self.by(space, control);
        let signs = own.signs.iter().flat_map(|sign| own.linear(space, sign, control));
        let room = |half: ControlInequality| {
            let sum: f64 = half.entries.iter().map(|(c, f)| f.dot(control[*c])).sum();
            let now = half.most - sum;
            (half, now)
        };
        signs.chain(self.limited(space).into_iter().map(room)).collect()
    }
}
