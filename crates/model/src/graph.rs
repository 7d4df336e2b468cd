//! The graph of named objects: declared, matched with the run before, evaluated rank by rank where something changed.
//!
//! An evaluation whose result is bitwise equal to the one before ends the wave there.

use crate::memo::Memo;
use crate::object::{Failure, Object, State};
use indexmap::IndexMap;
use moldloft_budget::{Budget, Spent};
use moldloft_diag::nearest;
use moldloft_num::trace::Key;
use moldloft_parallel::prelude::*;
use moldloft_registry::{Attributes, CallError, Class, Context, FieldId, Kept, Row, Scalar, Value};
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap, HashSet};
use std::sync::Arc;

/// The largest number of a shape: the sixth powers of lengths, which curvatures take, stay finite.
const LARGEST: f64 = 1e50;

/// Maximum nesting of shapes, which protects the stack during evaluation.
pub const DEEPEST_NESTING: u32 = 100;

/// Fewer pending objects than this are evaluated on the calling thread.
const WORTH_A_THREAD: usize = 64;

/// The named objects of a model with their dependencies, evaluated with one scalar.
///
/// It is changed by [`Graph::apply`] alone. An object declared with the same name, kind, data
/// bits and parents keeps its shape; others, and their dependants, are evaluated again, until
/// results are bitwise equal.
#[derive(Debug, Default)]
pub struct Graph<T: Scalar> {
    /// By key; `None` where an object has gone.
    objects: Vec<Option<Object<T>>>,
    names: IndexMap<Arc<str>, Key>,
    /// Keys of objects that have gone, free for others; and those that will be so after a run.
    free: Vec<Key>,
    gone: Vec<Key>,
    /// (parent, child) pairs that the parent still lists although they are obsolete.
    loose: HashSet<(Key, Key)>,
    /// Objects whose rank must be checked; and those of them that the run has not declared yet.
    unranked: Vec<Key>,
    unranked_later: HashSet<Key>,
    /// True while a run declares objects.
    running: bool,
    /// Objects that must be evaluated, by rank, then key.
    pending: BinaryHeap<Reverse<(u32, Key)>>,
    /// Counts applications.
    clock: u64,
    /// The clock at which something visible changed last.
    last_change: u64,
    declared: u32,
    evaluated: usize,
    failed: usize,
    /// Number of objects with warnings about their construction.
    remarked: usize,
    any_read: bool,
    memo: Memo<T>,
    /// Objects that sweep a point; the list may contain deleted ones and duplicates.
    sweeps: Vec<Key>,
    /// Objects that were not evaluated because the budget was spent; the list may contain deleted
    /// ones.
    unfinished: Vec<Key>,
    context: Context,
}

/// Extent of an application: the whole model or a part of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// A run: objects that it does not declare are removed.
    Whole,
    /// An edit: objects that it does not mention are kept.
    Edit,
}

/// Statistics of an application.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Applied {
    /// Number of evaluated objects.
    pub evaluated: usize,
    /// Number of existing objects.
    pub objects: usize,
    /// Number of failed or blocked objects.
    pub failed: usize,
}

/// An object as declared by a producer.
#[derive(Clone, Debug)]
pub struct Declaration<'a, T: Scalar> {
    /// Its name.
    pub name: &'a str,
    /// The row of the call.
    pub row: &'a Arc<Row>,
    /// The arguments in the order of the row's fields, checked.
    pub args: Vec<Value<T>>,
    /// Display attributes and divisions.
    pub head: Attributes,
    /// Position of its declaration, in the producer's own numbering.
    pub origin: u32,
}

/// An application in progress: declares, reads and removes objects.
#[derive(Debug)]
pub struct Run<'g, T: Scalar> {
    graph: &'g mut Graph<T>,
    extent: Extent,
}

impl<T: Scalar> Graph<T> {
    /// An empty model.
    pub fn new(context: Context) -> Self {
        Self { context, ..Default::default() }
    }

    /// Changes the model: `produce` declares (or edits) objects, and may read others; pending
    /// objects are evaluated at the end.
    pub fn apply<R>(
        &mut self,
        extent: Extent,
        produce: impl FnOnce(&mut Run<'_, T>) -> R,
    ) -> (R, Applied) {
        self.clock += 1;
        self.evaluated = 0;
        if extent == Extent::Whole {
            self.declared = 0;
            self.any_read = false;
        }
        self.running = extent == Extent::Whole;
        let produced = produce(&mut Run { graph: self, extent });
        self.running = false;
        if extent == Extent::Whole {
            self.remove_undeclared();
        }
        self.unlink();
        // Cancelled objects, and those beyond the budget, may succeed now.
        for key in std::mem::take(&mut self.unfinished) {
            if self.get(key).is_some() {
                self.mark_pending(key);
            }
        }
        self.evaluate_pending();
        if extent == Extent::Whole {
            // There are no references left: everything was declared again or removed.
            self.free.append(&mut self.gone);
        }
        self.memo.forget_unused(self.clock);
        let applied =
            Applied { evaluated: self.evaluated, objects: self.names.len(), failed: self.failed };
        (produced, applied)
    }

    /// The object called `name`.
    pub fn find(&self, name: &str) -> Option<Key> {
        self.names.get(name).copied()
    }

    /// The object of a key.
    pub fn get(&self, key: Key) -> Option<&Object<T>> {
        self.objects.get(key.0 as usize)?.as_ref()
    }

    /// Context of calls besides their arguments.
    pub fn context(&self) -> Context {
        self.context.clone()
    }

    /// Limits of evaluations.
    pub fn budget(&self) -> &Budget {
        &self.context.budget
    }

    /// Sets the limits of evaluations.
    pub fn set_budget(&mut self, budget: Arc<Budget>) {
        self.context.budget = budget;
    }

    /// Sets the cache that calls share.
    pub fn keep_in(&mut self, kept: Kept) {
        self.context.kept = kept;
    }

    /// Sets [`Context::coarser`]; the next application evaluates objects whose value depends on it.
    pub fn set_coarser(&mut self, halvings: u32) {
        if std::mem::replace(&mut self.context.coarser, halvings) == halvings {
            return;
        }
        let previewed: Vec<Key> =
            self.objects().filter(|o| o.row.previewed).map(|o| o.key).collect();
        for key in previewed {
            self.mark_pending(key);
        }
    }

    pub(crate) fn object(&self, key: Key) -> &Object<T> {
        self.get(key).expect("the key of a living object")
    }

    fn object_mut(&mut self, key: Key) -> &mut Object<T> {
        self.objects[key.0 as usize].as_mut().expect("the key of a living object")
    }

    /// All objects in the order of declaration.
    ///
    /// While a run declares objects, those declared so far.
    pub fn objects(&self) -> impl Iterator<Item = &Object<T>> {
        let there = |o: &&Object<T>| !self.running || o.declared_at == self.clock;
        let objects = self.objects.iter().flatten().filter(there);
        let mut keys: Vec<_> = objects.map(|o| (o.order, o.key)).collect();
        keys.sort_unstable();
        keys.into_iter().map(|(_, key)| self.object(key))
    }

    /// Number of objects.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Number of failed or blocked objects.
    pub fn failed(&self) -> usize {
        self.failed
    }

    /// Number of objects with a warning about their construction.
    pub fn remarked(&self) -> usize {
        self.remarked
    }

    /// True when the program has read the value of an object during its run.
    pub fn any_read(&self) -> bool {
        self.any_read
    }

    /// True when there is no object.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// The name most like `name`.
    pub fn nearest_name(&self, name: &str) -> Option<&str> {
        nearest(name, self.names.keys().map(|n| &**n))
    }

    /// Time of the last change of a value, head or name: results derived from the whole model are
    /// stale if this has increased.
    pub fn last_change(&self) -> u64 {
        self.last_change
    }

    /// All objects that depend on `key`, directly or indirectly, in the order of declaration.
    pub fn dependents(&self, key: Key) -> Vec<Key> {
        self.closure(key, |o| &o.children)
    }

    /// All objects that `key` depends on, directly or indirectly, in the order of declaration.
    pub fn ancestors(&self, key: Key) -> Vec<Key> {
        self.closure(key, |o| &o.parents)
    }

    fn closure(&self, key: Key, next: impl Fn(&Object<T>) -> &[Key]) -> Vec<Key> {
        let mut seen = HashSet::from([key]);
        let mut stack = vec![key];
        let mut found = Vec::new();
        while let Some(key) = stack.pop() {
            for &other in next(self.object(key)) {
                if seen.insert(other) {
                    found.push(other);
                    stack.push(other);
                }
            }
        }
        found.sort_unstable_by_key(|&k| self.object(k).order);
        found
    }

    fn remove_undeclared(&mut self) {
        let clock = self.clock;
        let gone: Vec<Key> = self
            .objects
            .iter()
            .flatten()
            .filter(|o| o.declared_at != clock)
            .map(|o| o.key)
            .collect();
        self.remove(&gone);
    }

    fn remove(&mut self, gone: &[Key]) {
        if !gone.is_empty() {
            self.last_change = self.clock;
        }
        for &key in gone {
            let object = self.objects[key.0 as usize].take().expect("a living object");
            self.names.swap_remove(&object.name);
            self.failed -= usize::from(object.state.is_failure());
            self.remarked -= usize::from(object.state.warns());
            self.loose.extend(object.parents.iter().map(|&parent| (parent, key)));
            self.gone.push(key);
        }
    }

    /// Removes obsolete children from their parents' lists, all at once: one by one would be
    /// quadratic.
    fn unlink(&mut self) {
        let loose = std::mem::take(&mut self.loose);
        let parents: HashSet<Key> = loose.iter().map(|(parent, _)| *parent).collect();
        for parent in parents {
            if let Some(parent) = &mut self.objects[parent.0 as usize] {
                parent.children.retain(|&child| !loose.contains(&(parent.key, child)));
            }
        }
    }

    fn mark_pending(&mut self, key: Key) {
        let object = self.object_mut(key);
        if !object.pending {
            object.pending = true;
            let rank = object.rank;
            self.pending.push(Reverse((rank, key)));
        }
    }

    /// Evaluates all that is pending, rank by rank: objects of one rank do not depend on each
    /// other, so they may be evaluated at once, in any order, with the same bits.
    fn evaluate_pending(&mut self) {
        self.evaluate_ranks();
        // The objects between a sweep and its point may have changed although its point has not.
        let mut sweeps = std::mem::take(&mut self.sweeps);
        sweeps.retain(|&key| self.get(key).is_some_and(|o| o.row.sweep.is_some()));
        sweeps.sort_unstable_by_key(|&key| (self.object(key).rank, key));
        sweeps.dedup();
        self.sweeps.extend_from_slice(&sweeps);
        for key in sweeps {
            if self.sweep_is_stale(key) {
                self.mark_pending(key);
                self.evaluate_ranks();
            }
        }
    }

    /// True when something that a sweep depends on has changed since it was evaluated.
    fn sweep_is_stale(&self, key: Key) -> bool {
        let object = self.object(key);
        object.row.sweep.is_some()
            && self.ancestors(key).iter().any(|&k| self.object(k).changed_at > object.swept_at)
    }

    fn evaluate_ranks(&mut self) {
        self.rank_all();
        let mut batch = Vec::new();
        while let Some(&Reverse((rank, _))) = self.pending.peek() {
            batch.clear();
            while let Some(&Reverse((r, key))) = self.pending.peek() {
                if r != rank {
                    break;
                }
                self.pending.pop();
                // The heap may still hold objects that were forced, re-ranked or removed since.
                if self.get(key).is_some_and(|o| o.pending && o.rank == rank) {
                    batch.push(key);
                }
            }
            batch.dedup();
            let states: Vec<State<T>> = if batch.len() < WORTH_A_THREAD {
                batch.iter().map(|&key| self.evaluated_state(key)).collect()
            } else {
                let graph = &*self;
                batch.par_iter().with_min_len(16).map(|&key| graph.evaluated_state(key)).collect()
            };
            for (&key, state) in batch.iter().zip(states) {
                self.store(key, state);
            }
        }
    }

    /// Evaluates `key` and its ancestors, if pending.
    fn force(&mut self, key: Key) {
        self.rank_all();
        let mut wanted = vec![key];
        let mut seen = HashSet::from([key]);
        let mut at = 0;
        while at < wanted.len() {
            let object = self.object(wanted[at]);
            at += 1;
            if object.verified_at == self.clock && !object.pending {
                continue;
            }
            let parents = object.parents.clone();
            wanted.extend(parents.into_iter().filter(|&parent| seen.insert(parent)));
        }
        // Parents have a lower rank, so this order meets each after all that may change it.
        wanted.sort_unstable_by_key(|&k| (self.object(k).rank, k));
        for key in wanted {
            if self.object(key).pending || self.sweep_is_stale(key) {
                let state = self.evaluated_state(key);
                self.store(key, state);
            }
            let clock = self.clock;
            self.object_mut(key).verified_at = clock;
        }
    }

    fn evaluated_state(&self, key: Key) -> State<T> {
        let object = self.object(key);
        let mut args = Vec::with_capacity(object.args.len());
        for arg in &object.args {
            match self.resolved(arg) {
                Ok(arg) => args.push(arg),
                Err(by) => return State::Failed(Failure::Blocked { by }),
            }
        }
        if let Some([bead, point]) = object.row.sweep {
            let named = |field: FieldId| match object.args[field.position()] {
                Value::Object(key) => Ok(key),
                _ => Err(CallError::new("constant-point", "a sweep needs names")
                    .expected("a bead and an object that depends on it, by name")
                    .found("something without a name")
                    .in_field(field)),
            };
            let locus = named(bead).and_then(|bead| {
                let follower = named(point)?;
                self.locus(bead, follower).map_err(|fault| fault.in_field(point))
            });
            match locus {
                Ok(locus) => args[point.position()] = Value::Locus(locus),
                Err(fault) => return State::Failed(Failure::CallError(fault)),
            }
        }
        for (k, arg) in args.iter().enumerate() {
            let largest = arg.largest();
            // The largest double marks a literal that was refused.
            if largest > LARGEST && largest < f64::MAX {
                let fault = too_large("a number", largest).in_field(object.row.id(k));
                return State::Failed(Failure::CallError(fault));
            }
        }
        if let Err(spent) = self.context.budget.poll() {
            return State::Failed(Failure::CallError(spent.into()));
        }
        let call = || T::call(&object.row, &args, &self.context);
        // A kind that panics is our fault, but it must not take the model with it.
        let called = std::panic::catch_unwind(std::panic::AssertUnwindSafe(call));
        let value = match called {
            Ok(Ok(value)) => value,
            Ok(Err(fault)) => return State::Failed(Failure::CallError(fault)),
            Err(_) => {
                let message = format!("{} failed unexpectedly", object.row.name);
                let fault = CallError::new("internal-error", message)
                    .help("this is a fault of the program, not of the model: please report it");
                return State::Failed(Failure::CallError(fault));
            }
        };
        if !value.is_finite() {
            let fault = CallError::new("not-finite", "the result is not a finite number")
                .expected("finite coordinates")
                .found("NaN or infinity")
                .help("look for a division by zero or a number far too large in its data");
            return State::Failed(Failure::CallError(fault));
        }
        let largest = value.largest();
        if largest > LARGEST && largest < f64::MAX {
            return State::Failed(Failure::CallError(too_large("a coordinate", largest)));
        }
        if value.depth() > DEEPEST_NESTING {
            let fault =
                CallError::new("nested-too-deep", "too many shapes are built on one another")
                    .expected(format!("at most {DEEPEST_NESTING} levels of curves and surfaces"))
                    .found(format!("{} levels", value.depth()))
                    .help("build on an earlier shape instead");
            return State::Failed(Failure::CallError(fault));
        }
        State::Ok(value.named(key))
    }

    /// The argument with every object replaced by its value, or the failed object it waits for.
    fn resolved(&self, arg: &Value<T>) -> Result<Value<T>, Key> {
        match arg {
            Value::Object(key) => match &self.object(*key).state {
                State::Ok(value) => Ok(value.clone()),
                State::Failed(Failure::Blocked { by }) => Err(*by),
                State::Failed(Failure::CallError(_)) | State::New => Err(*key),
            },
            Value::List(items) => {
                let items: Result<Vec<_>, _> = items.iter().map(|v| self.resolved(v)).collect();
                Ok(Value::list(items?))
            }
            other => Ok(other.clone()),
        }
    }

    fn store(&mut self, key: Key, state: State<T>) {
        self.evaluated += 1;
        let clock = self.clock;
        let object = self.object_mut(key);
        object.pending = false;
        object.verified_at = clock;
        object.swept_at = clock;
        if object.row.sweep.is_some() {
            self.sweeps.push(key);
        }
        if matches!(&state, State::Failed(Failure::CallError(f)) if Spent::is_id(f.id)) {
            self.unfinished.push(key);
        }
        let object = self.object_mut(key);
        if object.state.same(&state) {
            return;
        }
        let (was, is) = (object.state.is_failure(), state.is_failure());

        let (warned, warns) = (object.state.warns(), state.warns());
        object.state = state;
        object.changed_at = clock;
        self.last_change = clock;
        self.failed = self.failed + usize::from(is) - usize::from(was);
        self.remarked = self.remarked + usize::from(warns) - usize::from(warned);
        for at in 0..self.object(key).children.len() {
            let child = self.object(key).children[at];
            if self.loose.is_empty() || !self.loose.contains(&(key, child)) {
                self.mark_pending(child);
            }
        }
    }

    fn connect(&mut self, key: Key, args: Vec<Value<T>>) {
        let mut parents: Vec<Key> = Vec::new();
        args.iter().for_each(|arg| arg.for_each_object(&mut |parent| parents.push(parent)));
        if parents.len() <= 16 {
            for at in (1..parents.len()).rev() {
                if parents[..at].contains(&parents[at]) {
                    parents.remove(at);
                }
            }
        } else {
            let mut seen = HashSet::with_capacity(parents.len());
            parents.retain(|&parent| seen.insert(parent));
        }
        let old = std::mem::take(&mut self.object_mut(key).parents);
        if old.as_slice() != parents.as_slice() {
            let (before, now): (HashSet<Key>, HashSet<Key>) =
                (old.iter().copied().collect(), parents.iter().copied().collect());
            self.loose.extend(before.difference(&now).map(|&parent| (parent, key)));
            for &parent in parents.iter().filter(|parent| !before.contains(parent)) {
                if !self.loose.remove(&(parent, key)) {
                    self.object_mut(parent).children.push(key);
                }
            }
            if !self.running {
                self.unlink();
            }
        }
        let object = self.object_mut(key);
        object.args = args;
        object.parents = parents.into();
        self.rank(key);
    }

    fn rank_above_parents(&self, key: Key) -> u32 {
        self.object(key).parents.iter().map(|&p| self.object(p).rank + 1).max().unwrap_or(0)
    }

    /// Ranks `key` above its parents, or notes that this must be done.
    fn rank(&mut self, key: Key) {
        if self.unranked.is_empty() {
            let rank = self.rank_above_parents(key);
            if rank == self.object(key).rank {
                return;
            }
            if self.object(key).children.is_empty() {
                self.set_rank(key, rank);
                return;
            }
        }
        self.unranked.push(key);
    }

    fn set_rank(&mut self, key: Key, rank: u32) {
        let object = self.object_mut(key);
        object.rank = rank;
        if std::mem::take(&mut object.pending) {
            self.mark_pending(key);
        }
    }

    /// Ranks the noted objects and their dependants, in the order of declaration, so that each
    /// object is ranked after its parents, once. Objects that a run has not declared yet must wait:
    /// their parents may still change.
    fn rank_all(&mut self) {
        if !self.running {
            self.unranked.extend(self.unranked_later.drain());
        }
        if self.unranked.is_empty() {
            return;
        }
        let noted = std::mem::take(&mut self.unranked);
        let mut todo: BTreeSet<(u32, Key)> =
            noted.into_iter().filter_map(|key| self.get(key)).map(|o| (o.order, o.key)).collect();
        while let Some((_, key)) = todo.pop_first() {
            let rank = self.rank_above_parents(key);
            if rank == self.object(key).rank {
                continue;
            }
            self.set_rank(key, rank);
            for at in 0..self.object(key).children.len() {
                let Some(child) = self.get(self.object(key).children[at]) else { continue };
                if self.running && child.declared_at != self.clock {
                    let later = child.key;
                    self.unranked_later.insert(later);
                } else {
                    todo.insert((child.order, child.key));
                }
            }
        }
    }
}

fn too_large(what: &str, found: f64) -> CallError {
    CallError::new("number-too-large", format!("{what} is too large to compute with"))
        .expected(format!("at most {LARGEST:e}"))
        .found(format!("{found:e}"))
        .help("choose a larger unit of length")
}

fn too_many_objects(most: u64) -> CallError {
    CallError::new("too-many-objects", "the model has too many objects")
        .expected(format!("at most {most}"))
        .help("allow more: `--limit objects=1e6`, `moldloft.limits(objects=...)`")
}

impl<T: Scalar> Run<'_, T> {
    /// Declares an object. An object equal to that of the previous run keeps its shape.
    ///
    /// # Errors
    /// A [`CallError`] when this run has declared the name before, or when the object would depend on
    /// itself.
    pub fn declare(&mut self, declaration: Declaration<'_, T>) -> Result<Key, CallError> {
        let Declaration { name, row, args, head, origin } = declaration;
        let clock = self.graph.clock;
        let order = self.graph.declared;
        let Some(key) = self.graph.find(name) else {
            let most = moldloft_budget::limits().objects;
            if self.graph.names.len() as u64 >= most {
                return Err(too_many_objects(most));
            }
            return Ok(self.insert(name, row, args, head, origin));
        };
        let object = self.graph.object_mut(key);
        if object.declared_at == clock {
            return Err(CallError::new("duplicate-name", format!("`{name}` is declared twice"))
                .help("give one of them another name"));
        }
        if !Arc::ptr_eq(&object.row, row) && object.row.name != row.name {
            // Another kind of the same name: a new object, so that nothing of the old one stays.
            if self.extent == Extent::Whole {
                let children = std::mem::take(&mut object.children);
                self.graph.remove(&[key]);
                // They were declared on the old object; this run declares them again or removes
                // them.
                for child in children {
                    if let Some(child) = &mut self.graph.objects[child.0 as usize] {
                        child.parents.retain(|p| *p != key);
                    }
                }
                return Ok(self.insert(name, row, args, head, origin));
            }
            return Err(CallError::new("duplicate-name", format!("`{name}` exists already")));
        }
        object.declared_at = clock;
        object.origin = origin;
        if self.extent == Extent::Whole {
            if object.order != order {
                // Meshes follow the order of declaration.
                object.order = order;
                self.graph.last_change = clock;
            }
            let object = self.graph.object_mut(key);
            object.read_by_program = false;
            self.graph.declared += 1;
            if !self.graph.unranked_later.is_empty() && self.graph.unranked_later.remove(&key) {
                self.graph.unranked.push(key);
            }
        }
        let object = self.graph.object_mut(key);
        if object.head != head {
            object.head = head;
            object.head_changed_at = clock;
            self.graph.last_change = clock;
        }
        let object = self.graph.object_mut(key);
        let same_row = Arc::ptr_eq(&object.row, row);
        let same = object.args.len() == args.len()
            && object.args.iter().zip(&args).all(|(a, b)| a.same(b));
        if !same {
            self.check_cycle(key, &args)?;
            self.graph.connect(key, args);
        }
        // Cancelled objects, and those beyond the budget, have no result.
        let unknown = matches!(
            &self.graph.object(key).state,
            State::Failed(Failure::CallError(fault)) if Spent::is_id(fault.id)
        );
        if !same || !same_row || unknown {
            self.graph.object_mut(key).row = row.clone();
            self.graph.mark_pending(key);
        }
        Ok(key)
    }

    /// Gives an object new arguments, in an edit.
    ///
    /// # Errors
    /// A [`CallError`] when it would depend on itself.
    pub fn set_args(&mut self, key: Key, args: Vec<Value<T>>) -> Result<(), CallError> {
        let old = &self.graph.object(key).args;
        if old.len() == args.len() && old.iter().zip(&args).all(|(a, b)| a.same(b)) {
            return Ok(());
        }
        self.check_cycle(key, &args)?;
        self.graph.connect(key, args);
        self.graph.mark_pending(key);
        Ok(())
    }

    fn insert(
        &mut self,
        name: &str,
        row: &Arc<Row>,
        args: Vec<Value<T>>,
        head: Attributes,
        origin: u32,
    ) -> Key {
        let graph = &mut *self.graph;
        let key = graph.free.pop().unwrap_or_else(|| {
            graph.objects.push(None);
            Key(u32::try_from(graph.objects.len() - 1).expect("fewer than 2^32 objects"))
        });
        let name: Arc<str> = name.into();
        let order = if self.extent == Extent::Whole {
            graph.declared
        } else {
            // An edit adds at the end.
            graph.objects.iter().flatten().map(|o| o.order + 1).max().unwrap_or(0)
        };
        graph.declared = graph.declared.max(order + 1);
        graph.names.insert(name.clone(), key);
        let object = Object::new(key, name, row.clone(), head, origin, order, graph.clock);
        graph.objects[key.0 as usize] = Some(object);
        graph.connect(key, args);
        graph.mark_pending(key);
        key
    }

    fn check_cycle(&self, key: Key, args: &[Value<T>]) -> Result<(), CallError> {
        // In a run, parents are declared before their children: no cycle can arise.
        if self.extent == Extent::Whole {
            return Ok(());
        }
        let mut parents = Vec::new();
        args.iter().for_each(|arg| arg.for_each_object(&mut |parent| parents.push(parent)));
        let mut path_to = IndexMap::from([(key, key)]);
        let mut stack = vec![key];
        while let Some(at) = stack.pop() {
            for &child in &self.graph.object(at).children {
                if !path_to.contains_key(&child) {
                    path_to.insert(child, at);
                    stack.push(child);
                }
            }
        }
        let Some(&parent) = parents.iter().find(|&p| path_to.contains_key(p)) else {
            return Ok(());
        };
        let name = |key: Key| self.graph.object(key).name.to_string();
        let mut path = vec![name(key)];
        let mut at = parent;
        while at != key {
            path.push(name(at));
            at = path_to[&at];
        }
        path.push(name(key));
        Err(CallError::new("cycle", format!("`{}` would depend on itself", name(key)))
            .found(path.join(" -> "))
            .help("remove the circular dependency"))
    }

    /// The class of an object, known without evaluating it.
    pub fn class_of(&self, key: Key) -> Class {
        self.graph.get(key).map_or(Class::Any, |o| o.row.class)
    }

    /// The object called `name`, if declared in this run (in an edit: in the model).
    pub fn find(&self, name: &str) -> Option<Key> {
        let key = self.graph.find(name)?;
        let object = self.graph.object(key);
        (self.extent == Extent::Edit || object.declared_at == self.graph.clock).then_some(key)
    }

    /// The value of an object, evaluated immediately with all its dependencies.
    ///
    /// # Errors
    /// The reason why it has no value.
    pub fn force(&mut self, key: Key) -> Result<Value<T>, Failure> {
        self.graph.force(key);
        // Reads by an edit are not part of the program.
        if self.extent == Extent::Whole {
            self.graph.object_mut(key).read_by_program = true;
            self.graph.any_read = true;
        }
        match &self.graph.object(key).state {
            State::Ok(value) => Ok(value.clone()),
            State::Failed(failure) => Err(failure.clone()),
            State::New => unreachable!("forcing evaluates"),
        }
    }

    /// The value of an anonymous call, cached by its arguments from this run and the last.
    ///
    /// # Errors
    /// Errors of the row's implementation.
    pub fn call(&mut self, row: &Arc<Row>, args: Vec<Value<T>>) -> Result<Value<T>, CallError> {
        let graph = &mut *self.graph;
        graph.memo.call(row, args, graph.clock, &graph.context)
    }

    /// The whole model for a run, a part for an edit.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// The graph in its current state.
    pub fn graph(&self) -> &Graph<T> {
        self.graph
    }

    /// Removes an object without dependents.
    ///
    /// # Errors
    /// A [`CallError`] that names the dependents.
    pub fn remove(&mut self, key: Key) -> Result<(), CallError> {
        let object = self.graph.object(key);
        if object.children.is_empty() {
            self.graph.remove(&[key]);
            self.graph.unlink();
            return Ok(());
        }
        let mut names: Vec<_> = object
            .children
            .iter()
            .take(5)
            .map(|&c| self.graph.object(c).name.to_string())
            .collect();
        if object.children.len() > names.len() {
            names.push(format!("{} more", object.children.len() - names.len()));
        }
        let names = names.join(", ");
        Err(CallError::new("has-dependents", format!("`{}` cannot be deleted", object.name))
            .found(format!("{names} built on it"))
            .help("delete or rebuild those first"))
    }

    /// Renames an object; references to it are kept.
    ///
    /// # Errors
    /// A [`CallError`] when the name is taken.
    pub fn rename(&mut self, key: Key, name: &str) -> Result<(), CallError> {
        if self.graph.names.contains_key(name) {
            return Err(CallError::new("duplicate-name", format!("`{name}` exists already"))
                .help("choose another name"));
        }
        self.graph.last_change = self.graph.clock;
        let new: Arc<str> = name.into();
        let old = std::mem::replace(&mut self.graph.object_mut(key).name, new.clone());
        self.graph.names.swap_remove(&old);
        self.graph.names.insert(new, key);
        Ok(())
    }
}
