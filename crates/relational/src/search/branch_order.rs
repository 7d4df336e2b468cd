//! The branch of an intersection by its number in the order along a parameter of a surface.

use moldloft_locate::branches::Branches;
use moldloft_locate::march::Branch;
use moldloft_registry::{CallError, FieldId};
use std::sync::Arc;

/// The number of a branch among all in the order along u (0) or v (1) of the surface that is given first.
#[derive(Clone, Copy)]
pub(super) struct BranchNumber {
    number: usize,
    count: usize,
    axis: usize,
    field: FieldId,
}

impl BranchNumber {
    /// From the arguments: number and count, and the parameter, "u" by default.
    pub fn of(
        branch: Option<Vec<usize>>,
        along: Option<Arc<str>>,
        [field, along_field]: [FieldId; 2],
    ) -> Result<Option<Self>, CallError> {
        let axis = match along.as_deref() {
            None | Some("u") => 0,
            Some("v") => 1,
            Some(other) => {
                let text = format!("there is no \"{other}\"");
                return Err(CallError::new("unknown-parameter", text)
                    .expected("\"u\" or \"v\"")
                    .found(format!("\"{other}\""))
                    .in_field(along_field));
            }
        };
        let Some(branch) = branch else { return Ok(None) };
        match branch[..] {
            [number, count] if (1..=count).contains(&number) => {
                Ok(Some(Self { number, count, axis, field }))
            }
            _ => Err(CallError::new("out-of-range", "a branch has a number among all")
                .expected("{number, count}, such as {1, 2} for the first of two")
                .found(format!("{branch:?}").replace('[', "{").replace(']', "}"))
                .in_field(field)),
        }
    }

    /// The error of a branch that is stated by a magnet as well.
    pub fn twice(self) -> CallError {
        CallError::new("unused-argument", "a magnet and a number both select the branch")
            .expected("one of them")
            .found("both")
            .help("give the surface instead of the magnet, or leave out `branch`")
            .in_field(self.field)
    }

    /// Index of the branch with the number; the parameters of the surface are the unknowns from `first` on.
    pub fn chosen(self, found: &Branches, first: usize) -> Result<usize, CallError> {
        let letter = ["u", "v"][self.axis];
        let mut ranges: Vec<([f64; 2], usize)> = found
            .branches
            .iter()
            .enumerate()
            .map(|(k, branch)| (range(branch, first + self.axis), k))
            .collect();
        ranges.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]).then(a.0[1].total_cmp(&b.0[1])));
        let listed = || {
            let all: Vec<String> =
                ranges.iter().map(|([a, b], _)| format!("{letter} = {a:.6} to {b:.6}")).collect();
            if all.is_empty() { "none".to_owned() } else { all.join(", ") }
        };
        if ranges.len() != self.count || !found.complete {
            let state =
                if found.complete { "" } else { ", and parts that the search did not look at" };
            let text =
                format!("the intersection has {} branches here, not {}", ranges.len(), self.count);
            return Err(CallError::new("branch-count", text)
                .expected(format!("{} branches at all values of the parameters", self.count))
                .found(format!("{}{state}", listed()))
                .help("narrow the ranges of the parameters, or state the count of this value")
                .in_field(self.field));
        }
        let ([low, high], index) = ranges[self.number - 1];
        let beside = |&([a, b], k): &([f64; 2], usize)| k != index && b >= low && a <= high;
        if let Some(([a, b], _)) = ranges.iter().find(|r| beside(r)) {
            let text = format!("branch {} is not in order along {letter} here", self.number);
            let other = ["v", "u"][self.axis];
            return Err(CallError::new("branch-order", text)
                .expected(format!("no other branch beside it, within {letter} = {low:.6} to {high:.6}"))
                .found(format!("one from {letter} = {a:.6} to {b:.6}"))
                .help(format!(
                    "state the order along the other parameter (`along = \"{other}\"`), or select the branch by a magnet near it"
                ))
                .in_field(self.field));
        }
        Ok(index)
    }
}

fn range(branch: &Branch, k: usize) -> [f64; 2] {
    branch.stations.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], s| {
        [low.min(s.q[k]), high.max(s.q[k])]
    })
}
