//! Evaluation of a part of the graph with a moved bead, for curves swept by a point and surfaces
//! swept by a curve.

use crate::Graph;
use moldloft_num::trace::Key;
use moldloft_registry::{CallError, Context, CurveRef, LocusRef, Point, Row, Scalar, Sweep, Value};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

impl<T: Scalar> Graph<T> {
    /// The locus of `follower` when `bead` moves along its curve.
    ///
    /// # Errors
    /// `constant-point` when the one does not depend on the other.
    pub(crate) fn locus(&self, bead: Key, follower: Key) -> Result<LocusRef<T>, CallError> {
        let unrelated = || {
            CallError::new("constant-point", "the swept object does not depend on the bead")
                .expected("an object that moves when the bead does")
                .found("one that stays")
                .help("build it on the bead")
                .related(Some(bead), "is the bead")
                .related(Some(follower), "does not move with it")
        };
        let after: HashSet<Key> = self.dependents(bead).into_iter().collect();
        if !after.contains(&follower) {
            return Err(unrelated());
        }
        let mut between = self.ancestors(follower);
        between.retain(|key| after.contains(key));
        between.push(follower);
        // Parents have a lower rank.
        between.sort_unstable_by_key(|&key| (self.object(key).rank, key));
        let inside: HashSet<Key> = between.iter().copied().collect();
        let mut steps = Vec::with_capacity(between.len());
        for key in between {
            let object = self.object(key);
            if object.row.sweep.is_some() {
                return Err(CallError::new(
                    "nested-sweep",
                    "the swept object depends on another sweep",
                )
                .expected("an object that depends on no ProcCurve or ProcSurf")
                .found("one that does")
                .help("sweep the object that the other sweep follows")
                .related(Some(key), "sweeps itself"));
            }
            let moves = |key: Key| key == bead || inside.contains(&key);
            let args = object.args.iter().map(|arg| self.resolved_but(arg, &moves));
            steps.push(SweepStep { key, row: object.row.clone(), args: args.collect() });
        }
        let Some(Value::Point(at)) = self.object(bead).value() else { return Err(unrelated()) };
        let Some(place) = &at.on_curve else { return Err(unrelated()) };
        let curve = place.0.clone();
        Ok(LocusRef::new(BeadSweep { bead, curve, steps, context: self.context() }))
    }

    /// The argument with the objects that stay replaced by their values.
    fn resolved_but(&self, arg: &Value<T>, moves: &impl Fn(Key) -> bool) -> Value<T> {
        match arg {
            Value::Object(key) if !moves(*key) => {
                self.object(*key).value().cloned().unwrap_or(Value::Unset)
            }
            Value::List(items) => {
                Value::list(items.iter().map(|item| self.resolved_but(item, moves)))
            }
            other => other.clone(),
        }
    }
}

/// One object to evaluate again.
struct SweepStep<T: Scalar> {
    key: Key,
    row: Arc<Row>,
    /// Arguments; moving ones are objects.
    args: Vec<Value<T>>,
}

struct BeadSweep<T: Scalar> {
    bead: Key,
    curve: CurveRef<T>,
    steps: Vec<SweepStep<T>>,
    context: Context,
}

fn filled<T: Scalar>(arg: &Value<T>, values: &HashMap<Key, Value<T>>) -> Value<T> {
    match arg {
        Value::Object(key) => values.get(key).cloned().unwrap_or(Value::Unset),
        Value::List(items) => Value::list(items.iter().map(|item| filled(item, values))),
        other => other.clone(),
    }
}

impl<T: Scalar> Sweep<T> for BeadSweep<T> {
    fn at(&self, t: T) -> Result<Value<T>, CallError> {
        let bead = Value::Point(Box::new(Point::on_curve(self.curve.clone(), t)));
        let mut values = HashMap::from([(self.bead, bead.named(self.bead))]);
        let mut last = Value::Unset;
        for SweepStep { key, row, args } in &self.steps {
            let args: Vec<_> = args.iter().map(|arg| filled(arg, &values)).collect();
            let call = || T::call(row, &args, &self.context);
            // As for any object: a kind that panics must not take the model with it.
            let called = std::panic::catch_unwind(std::panic::AssertUnwindSafe(call));
            let value = called.unwrap_or_else(|_| {
                Err(CallError::new("internal-error", format!("{} failed unexpectedly", row.name)))
            });
            let value = value.map_err(|fault| fault.related(Some(*key), "has no value there"))?;
            if !value.is_finite() {
                return Err(CallError::new("not-finite", "the result is not a finite number")
                    .related(Some(*key), "has no finite value there"));
            }
            last = value.named(*key);
            values.insert(*key, last.clone());
        }
        Ok(last)
    }
}
