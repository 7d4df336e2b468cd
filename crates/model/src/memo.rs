//! The memory of anonymous calls: `f(...)` with the same arguments is computed once in a run, and kept for the next.

use moldloft_num::Vec3;
use moldloft_registry::{CallError, Context, Row, Scalar, Value};
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// Anonymous calls and their values: `f(...)` with the same arguments is computed once in a run,
/// and not again in the next.
#[derive(Debug)]
pub(crate) struct Memo<T: Scalar> {
    calls: HashMap<u64, Vec<Remembered<T>>>,
}

#[derive(Debug)]
struct Remembered<T: Scalar> {
    row: Arc<Row>,
    args: Vec<Value<T>>,
    value: Value<T>,
    used_at: u64,
}

impl<T: Scalar> Default for Memo<T> {
    fn default() -> Self {
        Self { calls: HashMap::new() }
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
        let bucket = self.calls.entry(fingerprint(row, &args)).or_default();
        let same = |r: &&mut Remembered<T>| {
            Arc::ptr_eq(&r.row, row) && r.args.iter().zip(&args).all(|(a, b)| a.same(b))
        };
        if let Some(found) = bucket.iter_mut().find(same) {
            found.used_at = clock;
            return Ok(found.value.clone());
        }
        let value = T::call(row, &args, context)?;
        bucket.push(Remembered { row: row.clone(), args, value: value.clone(), used_at: clock });
        Ok(value)
    }

    /// Forgets what neither this nor the last application used.
    pub(crate) fn forget_unused(&mut self, clock: u64) {
        self.calls.retain(|_, bucket| {
            bucket.retain(|r| r.used_at + 1 >= clock);
            !bucket.is_empty()
        });
    }
}

/// Equal arguments have equal fingerprints; shapes count by their class only.
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
        Value::List(items) => items.iter().for_each(|item| hash(item, h)),
        Value::Object(key) => key.hash(h),
        Value::Point(p) => vector(p.xyz, h),
        _ => {}
    }
}
