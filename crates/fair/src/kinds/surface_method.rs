//! Algorithm for a surface: near its points, or one that moves control points.

use super::unknown;
use crate::Bound;
use moldloft_registry::{CallError, FieldId};
use std::sync::Arc;

/// Default steps per point of each curve, and default number of sweeps.
const STEPS: usize = 3;
const SWEEPS: usize = 50;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SurfaceMethod {
    /// Optimum with a bound on the distance of each point from the surface.
    NearPoints,
    /// Optimum of the control net.
    Joint(Bound),
    /// Curve after curve by single steps.
    Passes { passes: usize, steps: usize, along_v_first: bool },
    /// Number of sweeps over all points in order.
    Sweeps(usize),
}

/// Options of a method as written, and their fields.
pub(super) struct MethodOptions<'a> {
    pub mode: (&'a str, FieldId),
    pub bound: (&'a Option<Arc<str>>, FieldId),
    pub order: (&'a Option<Arc<str>>, FieldId),
    pub steps: (Option<usize>, FieldId),
    pub passes: (usize, FieldId),
    /// True if the points are data whose parameters depend on them.
    pub data: bool,
}

impl MethodOptions<'_> {
    /// The selected method; options of another one are refused.
    pub fn method(&self) -> Result<SurfaceMethod, CallError> {
        let (mode, field) = self.mode;
        let other = |option: &str, needed: &str, field: FieldId| {
            CallError::new("other-mode", format!("`{option}` is for another mode"))
                .expected(needed)
                .found(format!("mode = \"{mode}\""))
                .in_field(field)
        };
        if !["optimum", "faithful", "sweeps"].contains(&mode) {
            return Err(unknown("mode", mode, &["optimum", "faithful", "sweeps"], field));
        }
        if let (Some(_), field) = self.bound
            && mode != "optimum"
        {
            return Err(other("bound", "mode = \"optimum\"", field));
        }
        if let (Some(_), field) = self.order
            && mode != "faithful"
        {
            return Err(other("order", "mode = \"faithful\"", field));
        }
        if let (Some(_), field) = self.steps
            && mode == "optimum"
        {
            return Err(other("steps", "mode = \"faithful\" or \"sweeps\"", field));
        }
        let (passes, field) = self.passes;
        if passes != 1 && mode != "faithful" {
            return Err(other("passes", "mode = \"faithful\"", field));
        }
        let steps = self.steps.0;
        match mode {
            "faithful" => {
                let along_v_first = match self.order.0.as_deref() {
                    None | Some("vu") => false,
                    Some("uv") => true,
                    Some(word) => return Err(unknown("order", word, &["vu", "uv"], self.order.1)),
                };
                let steps = steps.unwrap_or(STEPS);
                Ok(SurfaceMethod::Passes { passes, steps, along_v_first })
            }
            "sweeps" => Ok(SurfaceMethod::Sweeps(steps.unwrap_or(SWEEPS))),
            _ => match (self.bound.0.as_deref(), self.data) {
                (None | Some("data"), true) => Ok(SurfaceMethod::NearPoints),
                (None | Some("points"), _) => Ok(SurfaceMethod::Joint(Bound::ControlPoints)),
                (Some("curve"), _) => Ok(SurfaceMethod::Joint(Bound::Bezier)),
                (Some("data"), false) => {
                    let text = "the bound \"data\" is for surfaces near their points";
                    Err(CallError::new("not-near", text)
                        .expected("as = \"fit\", without spacing \"index\"")
                        .found("bound = \"data\"")
                        .in_field(self.bound.1))
                }
                (Some(word), _) => {
                    Err(unknown("bound", word, &["data", "points", "curve"], self.bound.1))
                }
            },
        }
    }
}
