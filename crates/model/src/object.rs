//! Named objects: a call of a row, its parents and children, and the result of its evaluation.

use moldloft_num::trace::Key;
use moldloft_registry::{Attributes, CallError, Row, Scalar, Value};
use smallvec::SmallVec;
use std::sync::Arc;

/// Reason why an object has no value.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// The call itself failed.
    CallError(CallError),
    /// Something that it depends on failed.
    Blocked {
        /// The failed object that caused this.
        by: Key,
    },
}

/// Result of an object's evaluation.
#[derive(Clone, Debug)]
pub enum State<T: Scalar> {
    /// Not evaluated yet.
    New,
    /// Its value.
    Ok(Value<T>),
    /// Failure as a value: other objects are not affected.
    Failed(Failure),
}

impl<T: Scalar> State<T> {
    /// The value, if there is one.
    pub fn value(&self) -> Option<&Value<T>> {
        match self {
            State::Ok(value) => Some(value),
            _ => None,
        }
    }

    /// True for a failed or blocked object.
    pub fn is_failure(&self) -> bool {
        matches!(self, State::Failed(_))
    }

    /// True when the search for its value ended with a status that deserves a warning.
    pub fn warns(&self) -> bool {
        self.value().is_some_and(Value::warns)
    }

    /// True if dependents need not be evaluated again.
    pub fn same(&self, other: &Self) -> bool {
        match (self, other) {
            (State::Ok(a), State::Ok(b)) => a.same(b),
            (State::Failed(a), State::Failed(b)) => a == b,
            _ => false,
        }
    }
}

/// A named object: a call of a row whose result is kept.
#[derive(Clone, Debug)]
pub struct Object<T: Scalar> {
    /// Its identity, preserved by renaming.
    pub key: Key,
    /// Its name.
    pub name: Arc<str>,
    /// Row of the call.
    pub row: Arc<Row>,
    /// The arguments, in the order of the row's fields; parents as [`Value::Object`].
    pub args: Vec<Value<T>>,
    /// Display attributes and divisions.
    pub head: Attributes,
    /// Position of its declaration, in the producer's numbering.
    pub origin: u32,
    /// Direct dependencies, in order of mention.
    pub parents: SmallVec<[Key; 4]>,
    /// Direct dependants.
    pub children: Vec<Key>,
    /// Its index in the order of declaration.
    pub order: u32,
    /// Result of its evaluation.
    pub state: State<T>,
    /// The clock at which its value changed last.
    pub changed_at: u64,
    /// The clock at which its head changed last.
    pub head_changed_at: u64,
    /// True when a statement of the program has read its value, so that a change requires another
    /// run.
    pub read_by_program: bool,
    pub(crate) declared_at: u64,
    pub(crate) verified_at: u64,
    /// The clock of its last evaluation.
    pub(crate) swept_at: u64,
    pub(crate) rank: u32,
    pub(crate) pending: bool,
}

impl<T: Scalar> Object<T> {
    pub(crate) fn new(
        key: Key,
        name: Arc<str>,
        row: Arc<Row>,
        head: Attributes,
        origin: u32,
        order: u32,
        clock: u64,
    ) -> Self {
        Self {
            key,
            name,
            row,
            args: Vec::new(),
            head,
            origin,
            parents: SmallVec::new(),
            children: Vec::new(),
            order,
            state: State::New,
            changed_at: clock,
            head_changed_at: clock,
            read_by_program: false,
            declared_at: clock,
            verified_at: 0,
            swept_at: 0,
            // Below any real rank, so that the first ranking always counts as a change.
            rank: 0,
            pending: false,
        }
    }

    /// Its own fault, if its call failed.
    pub fn fault(&self) -> Option<&CallError> {
        match &self.state {
            State::Failed(Failure::CallError(fault)) => Some(fault),
            _ => None,
        }
    }

    /// The failed object that it depends on.
    pub fn blocked_by(&self) -> Option<Key> {
        match &self.state {
            State::Failed(Failure::Blocked { by }) => Some(*by),
            _ => None,
        }
    }

    /// Its value, if it has one.
    pub fn value(&self) -> Option<&Value<T>> {
        self.state.value()
    }
}
