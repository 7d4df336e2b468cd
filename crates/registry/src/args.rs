//! Arguments of a call bound to the fields of its row: order, defaults, counts, names and classes are checked here,
//! so that the kinds need not.

use crate::{Argument, Attributes, CallError, Class, FieldId, FieldSpec, Row, Value};
use moldloft_num::Real;
use moldloft_num::trace::Key;

/// The arguments of a call, as written.
#[derive(Clone, Debug)]
pub struct Given<'a, T: Real> {
    /// In order.
    pub positional: Vec<Value<T>>,
    /// `name = value`.
    pub named: Vec<(&'a str, Value<T>)>,
}

/// `1 argument`, `2 arguments`: a count in a message.
pub fn argument_count(count: usize) -> String {
    format!("{count} argument{}", if count == 1 { "" } else { "s" })
}

/// Puts arguments in the order of the row's fields, fills in defaults and checks count, names,
/// classes and ranges; `class_of` gives the class of an object that has not been read. Named
/// arguments of the head are stored there.
///
/// # Errors
/// A [`CallError`] with its position.
pub fn bind_arguments<T: Real>(
    row: &Row,
    mut given: Given<T>,
    class_of: impl Fn(Key) -> Class,
) -> Result<(Vec<Value<T>>, Attributes), CallError> {
    let fields = &row.fields;
    let mut head = Attributes::of(row.class);
    gather(fields, &mut given.positional);
    if given.positional.len() > fields.len() {
        let names: Vec<_> = fields.iter().map(|f| f.name).collect();
        return Err(CallError::new(
            "too-many-arguments",
            format!("{} takes at most {}", row.name, argument_count(fields.len())),
        )
        .expected(format!("{}({})", row.name, names.join(", ")))
        .found(argument_count(given.positional.len()))
        .in_argument(Argument::Extra));
    }
    let mut args: Vec<Option<Value<T>>> = given.positional.into_iter().map(Some).collect();
    args.resize(fields.len(), None);
    for (k, (name, value)) in given.named.into_iter().enumerate() {
        match row.field(name) {
            Some(at) if args[at].is_none() => args[at] = Some(value),
            Some(at) => {
                return Err(CallError::new(
                    "argument-twice",
                    format!("`{name}` of {} is given twice", row.name),
                )
                .help(format!("`{name}` is already the argument number {}", at + 1))
                .in_argument(Argument::Named(k)));
            }
            None if row.kind => {
                let set = head.set(name, &value).map_err(|f| f.in_argument(Argument::Named(k)))?;
                if !set {
                    return Err(unknown_argument(row, name).in_argument(Argument::Named(k)));
                }
            }
            None => return Err(unknown_argument(row, name).in_argument(Argument::Named(k))),
        }
    }
    let mut filled = Vec::with_capacity(fields.len());
    for (at, (field, arg)) in fields.iter().zip(args).enumerate() {
        let arg = match (arg, field.default) {
            (None | Some(Value::Unset), Some(default)) => default.value(),
            (Some(arg), _) => arg,
            (None, None) => {
                return Err(CallError::new(
                    "missing-argument",
                    format!("{} needs `{}`: {}", row.name, field.name, lower(field.help)),
                )
                .expected(expectation(field))
                .in_field(FieldId::at(at)));
            }
        };
        check(field, &arg, &class_of).map_err(|fault| fault.in_field(FieldId::at(at)))?;
        filled.push(arg);
    }
    Ok((filled, head))
}

/// Makes one list of the arguments for a last field that takes any number of them.
fn gather<T: Real>(fields: &[FieldSpec], positional: &mut Vec<Value<T>>) {
    let Some(last) = fields.last().filter(|field| field.variadic) else { return };
    let at = fields.len() - 1;
    let several = positional.len() > fields.len();
    // One argument is the list itself, or its only item.
    let single = positional.len() == fields.len()
        && !matches!(positional[at], Value::List(_) | Value::Unset)
        && match last.class {
            Class::Any => true,
            class => class.accepts(positional[at].class()),
        };
    if several || single {
        let items = positional.split_off(at);
        positional.push(Value::list(items));
    }
}

fn lower(help: &str) -> String {
    let mut chars = help.trim_end_matches('.').chars();
    match chars.next() {
        Some(first) => first.to_lowercase().chain(chars).collect(),
        None => String::new(),
    }
}

fn expectation(field: &FieldSpec) -> String {
    if field.many {
        format!("a list {{...}} of {}s", field.class.name())
    } else {
        field.class.with_article().to_string()
    }
}

fn unknown_argument(row: &Row, name: &str) -> CallError {
    let heads = if row.kind { &crate::ATTRIBUTES[..] } else { &[] };
    let known = || row.fields.iter().chain(heads).map(|f| f.name);
    let fault =
        CallError::new("unknown-argument", format!("{} has no argument `{name}`", row.name))
            .expected(known().collect::<Vec<_>>().join(", "));
    match moldloft_diag::nearest(name, known()) {
        Some(near) => fault.help(format!("did you mean `{near}`?")),
        None => fault,
    }
}

fn check<T: Real>(
    field: &FieldSpec,
    arg: &Value<T>,
    class_of: &impl Fn(Key) -> Class,
) -> Result<(), CallError> {
    let one = |value: &Value<T>| -> Result<(), CallError> {
        let found = match value {
            Value::Object(key) => class_of(*key),
            Value::Unset if field.default.is_some() => return Ok(()),
            other => other.class(),
        };
        if !field.class.accepts(found) {
            return Err(CallError::wrong_class(field.class, found));
        }
        if let Value::Number(x) = value {
            range(field, x.re())?;
        }
        Ok(())
    };
    if !field.many {
        return one(arg);
    }
    let length = match arg {
        Value::List(items) => {
            for (k, item) in items.iter().enumerate() {
                one(item).map_err(|fault| fault.in_item(k))?;
            }
            items.len()
        }
        Value::Vector(_) if matches!(field.class, Class::Number | Class::Integer) => 3,
        Value::Numbers(a) => a.items.len(),
        Value::Vectors(a) => a.len(),
        Value::Unset if field.default.is_some() => return Ok(()),
        Value::Unset => 0,
        other => {
            let found = match other {
                Value::Object(key) => class_of(*key),
                other => other.class(),
            };
            if found == Class::Any || gives_items(field.class, found) {
                return Ok(());
            }
            return Err(CallError::new(
                "not-a-list",
                format!(
                    "expected a list of {}s, found {}",
                    field.class.name(),
                    found.with_article()
                ),
            )
            .expected(expectation(field))
            .found(found.with_article())
            .help("write the items in braces: {a, b}"));
        }
    };
    enough(field, length)
}

fn enough(field: &FieldSpec, length: usize) -> Result<(), CallError> {
    if length >= field.min_items {
        return Ok(());
    }
    Err(CallError::new(
        "too-few-items",
        format!("`{}` needs at least {} items, found {length}", field.name, field.min_items),
    )
    .expected(format!("at least {} {}s", field.min_items, field.class.name()))
    .found(format!("{length}")))
}

/// True if an object of class `found` is accepted as a list of items of class `item`.
fn gives_items(item: Class, found: Class) -> bool {
    match found {
        Class::List => true,
        Class::Numbers => matches!(item, Class::Number | Class::Integer | Class::Any),
        Class::Vectors => matches!(item, Class::Vector | Class::Point | Class::Any),
        _ => false,
    }
}

/// Checks that require the evaluation of an object: number of items, and range of numbers.
///
/// # Errors
/// A [`CallError`] with its item.
pub fn check_evaluated<T: Real>(field: &FieldSpec, value: &Value<T>) -> Result<(), CallError> {
    if field.many {
        let length = match value {
            Value::List(items) => items.len(),
            Value::Numbers(a) => a.items.len(),
            Value::Vectors(a) => a.len(),
            _ => return Ok(()),
        };
        enough(field, length)?;
    }
    if field.min.is_none() && field.max.is_none() {
        return Ok(());
    }
    match value {
        Value::Number(x) => range(field, x.re()),
        Value::Numbers(a) => {
            let mut each = a.items.iter().enumerate();
            each.try_for_each(|(k, x)| range(field, x.re()).map_err(|f| f.in_item(k)))
        }
        _ => Ok(()),
    }
}

fn range(field: &FieldSpec, x: f64) -> Result<(), CallError> {
    if !x.is_finite() {
        return Err(CallError::new("not-finite", format!("`{}` is {x}, not a number", field.name))
            .expected("a finite number")
            .found(x.to_string()));
    }
    let low = field.min.is_some_and(|low| x < low);
    let high = field.max.is_some_and(|high| x > high);
    if !low && !high {
        return Ok(());
    }
    let expected = match (field.min, field.max) {
        (Some(low), Some(high)) => format!("a number from {low} to {high}"),
        (Some(low), None) => format!("a number of at least {low}"),
        (None, Some(high)) => format!("a number of at most {high}"),
        (None, None) => unreachable!("a bound was exceeded"),
    };
    Err(CallError::new("out-of-range", format!("`{}` = {x} is out of range", field.name))
        .expected(expected)
        .found(x.to_string()))
}
