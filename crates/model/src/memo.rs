//! The memory of anonymous calls: `f(...)` with the same arguments is computed once in a run, and kept for the next.

use moldloft_num::Vec3;
use moldloft_registry::{CallError, CallRemark, Context, Row, Scalar, Value};
use std::collections::{HashMap, VecDeque};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// Anonymous calls and their values: `f(...)` with the same arguments is computed once in a run,
/// and not again in the next. Of large values only the latest are kept.
#[derive(Debug)]
pub(crate) struct Memo<T: Scalar> {
    calls: HashMap<u64, Vec<Remembered<T>>>,
    /// Fingerprints in the order in which their calls were made.
    order: VecDeque<u64>,
    /// Numbers in all arguments and values that are remembered.
    held: usize,
}

/// No more numbers are held than this: 64 MiB of plain ones.
const MOST_HELD: usize = 8 << 20;

#[derive(Debug)]
struct Remembered<T: Scalar> {
    row: Arc<Row>,
    args: Vec<Value<T>>,
    value: Value<T>,
    /// Notes of the call; repeated when its result is reused.
    remarks: Vec<CallRemark>,
    numbers: usize,
    used_at: u64,
}

impl<T: Scalar> Default for Memo<T> {
    fn default() -> Self {
        Self { calls: HashMap::new(), order: VecDeque::new(), held: 0 }
    }
}

impl<T: Scalar> Memo<T> {
    pub(crate) fn call(
        &mut self,
        row: &Arc<Row>,
        args: Vec<Value<T>>,
        clock: u64,
        context: &Context,
    ) -> Result<Value<T>, CallError> {
        let print = fingerprint(row, &args);
        let bucket = self.calls.entry(print).or_default();
        let same = |r: &&mut Remembered<T>| {
            Arc::ptr_eq(&r.row, row) && r.args.iter().zip(&args).all(|(a, b)| a.same(b))
        };
        if let Some(found) = bucket.iter_mut().find(same) {
            found.used_at = clock;
            for remark in &found.remarks {
                context.remark(remark.id, remark.message.clone(), remark.help);
            }
            return Ok(found.value.clone());
        }
        let before = context.take_remarks();
        let called = T::call(row, &args, context);
        let remarks = context.take_remarks();
        for remark in before.iter().chain(&remarks) {
            context.remark(remark.id, remark.message.clone(), remark.help);
        }
        let value = called?;
        let numbers = number_count(&value) + args.iter().map(number_count).sum::<usize>();
        let row = row.clone();
        bucket.push(Remembered {
            row,
            args,
            value: value.clone(),
            remarks,
            numbers,
            used_at: clock,
        });
        self.order.push_back(print);
        self.held += numbers;
        self.forget_oldest();
        Ok(value)
    }

    /// Forgets the oldest calls until no more than [`MOST_HELD`] numbers are held; the latest stays.
    fn forget_oldest(&mut self) {
        while self.held > MOST_HELD && self.order.len() > 1 {
            let Some(print) = self.order.pop_front() else { return };
            let Some(bucket) = self.calls.get_mut(&print) else { continue };
            if !bucket.is_empty() {
                self.held -= bucket.remove(0).numbers;
            }
            if bucket.is_empty() {
                self.calls.remove(&print);
            }
        }
    }

    /// Removes results that neither this nor the last application used.
    pub(crate) fn forget_unused(&mut self, clock: u64) {
        let mut held = 0;
        self.calls.retain(|_, bucket| {
            bucket.retain(|r| r.used_at + 1 >= clock);
            held += bucket.iter().map(|r| r.numbers).sum::<usize>();
            !bucket.is_empty()
        });
        self.held = held;
        self.order.retain(|print| self.calls.contains_key(print));
    }
}

/// The numbers that a value holds.
pub fn number_count<T: Scalar>(value: &Value<T>) -> usize {
    match value {
        Value::Numbers(a) => a.items.len() * T::PARTS,
        Value::Vectors(a) => a.shape.count() * 3 * T::PARTS,
        Value::List(items) | Value::Block(items) => items.iter().map(number_count).sum(),
        Value::Record(record) => record.values.iter().map(number_count).sum(),
        _ => 1,
    }
}

/// Equal arguments have equal fingerprints; curves and surfaces count by their class only.
fn fingerprint<T: Scalar>(row: &Arc<Row>, args: &[Value<T>]) -> u64 {
    let mut hasher = DefaultHasher::new();
    row.name.hash(&mut hasher);
    args.iter().for_each(|arg| hash(arg, &mut hasher));
    hasher.finish()
}

fn hash<T: Scalar>(value: &Value<T>, h: &mut DefaultHasher) {
    let number = |x: T, h: &mut DefaultHasher| x.re().to_bits().hash(h);
    let vector = |v: Vec3<T>, h: &mut DefaultHasher| v.re().to_array().map(f64::to_bits).hash(h);
    value.class().hash(h);
    match value {
        Value::Number(x) => number(*x, h),
        Value::Text(text) => text.hash(h),
        Value::Vector(v) => vector(*v, h),
        Value::Numbers(a) => a.items.iter().for_each(|&x| number(x, h)),
        Value::Vectors(a) => a.planes.iter().flatten().for_each(|&x| number(x, h)),
        Value::List(items) | Value::Block(items) => items.iter().for_each(|item| hash(item, h)),
        Value::Record(record) => {
            record.of.hash(h);
            record.values.iter().for_each(|item| hash(item, h));
        }
        Value::Object(key) => key.hash(h),
        Value::Point(p) => vector(p.xyz, h),
        Value::Field(f) => f.fingerprint().hash(h),
        Value::Set(s) => s.fingerprint().hash(h),
        _ => {}
    }
}
