//! From faults to places in the text, and from names of numbers to arguments.

use crate::module::Module;
use moldloft_diag::{Diagnostic, Span};
use moldloft_num::Vec3;
use moldloft_registry::{Fault, Row, Scalar, Value};
use moldloft_syntax::sdl::{Arg, ExprId, ExprKind, List};

/// The fault as a diagnostic without a place.
pub(crate) fn unplaced(fault: &Fault) -> Diagnostic {
    let mut diagnostic = Diagnostic::error(fault.id, fault.message.clone());
    if let Some(expected) = &fault.expected {
        diagnostic = diagnostic.expected(expected.clone());
    }
    if let Some(found) = &fault.found {
        diagnostic = diagnostic.found(found.clone());
    }
    for help in &fault.help {
        diagnostic = diagnostic.help(help.clone());
    }
    diagnostic
}

/// The fault of a call, at the argument that it is about; `whole` when that is unknown.
pub(crate) fn diagnostic(
    m: &Module,
    args: List<Arg>,
    row: &Row,
    positional: usize,
    fault: &Fault,
    whole: Span,
) -> Diagnostic {
    unplaced(fault).at(span(m, args, row, positional, fault).unwrap_or(whole))
}

fn span(m: &Module, args: List<Arg>, row: &Row, positional: usize, fault: &Fault) -> Option<Span> {
    let place = fault.place?;
    let args = &m.program[args];
    let expr = if place.field >= row.fields.len() {
        // Too many positional arguments, or a named one by number.
        let named: Vec<&Arg> = args.iter().filter(|a| a.name.is_some()).collect();
        if fault.id == "too-many-arguments" {
            args.get(row.fields.len())?.value
        } else {
            let arg = named.get(place.field - row.fields.len())?;
            if fault.id == "unknown-argument" {
                return arg.name.map(|n| n.span);
            }
            arg.value
        }
    } else {
        // An item of a list that was given as so many arguments is an argument of its own.
        let spread = row.fields[place.field].variadic && positional > place.field + 1;
        let at = place.field + place.item.filter(|_| spread).unwrap_or(0);
        if let Some(arg) = args.iter().filter(|a| a.name.is_none()).nth(at).filter(|_| spread) {
            arg.value
        } else {
            argument(m, args, row, positional, place.field)?
        }
    };
    let item = place.item.and_then(|k| item(m, expr, k));
    Some(m.program[item.unwrap_or(expr)].span)
}

/// The expression given for a field.
pub(crate) fn argument(
    m: &Module,
    args: &[Arg],
    row: &Row,
    positional: usize,
    field: usize,
) -> Option<ExprId> {
    let unnamed = args.iter().filter(|a| a.name.is_none());
    if field < positional
        && let Some(arg) = unnamed.clone().nth(field)
    {
        return Some(arg.value);
    }
    let name = row.fields.get(field)?.name;
    let named = |a: &&Arg| a.name.is_some_and(|n| m.program.name(n.symbol) == name);
    args.iter().find(named).map(|a| a.value)
}

/// The expression of item `k` of a list literal.
pub(crate) fn item(m: &Module, expr: ExprId, k: usize) -> Option<ExprId> {
    match m.program[m.program.bare(expr)].kind {
        ExprKind::List(items) => m.program[items].get(k).copied(),
        _ => None,
    }
}

/// A number in the arguments of an object: `P21.y`, `knots.values[3]`, `l.p1.x`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NumberPath {
    pub field: usize,
    pub item: Option<usize>,
    pub component: Option<usize>,
}

impl NumberPath {
    /// Reads what stands after the object's name: `.field`, `.field[item]`, `.field.x`.
    pub fn parse(row: &Row, text: &str) -> Option<Self> {
        let text = text.strip_prefix('.')?;
        let end = text.find(['.', '[']).unwrap_or(text.len());
        let field = row.field(&text[..end])?;
        let mut rest = &text[end..];
        let mut item = None;
        if let Some(after) = rest.strip_prefix('[') {
            let (index, after) = after.split_once(']')?;
            item = Some(index.trim().parse::<usize>().ok()?.checked_sub(1)?);
            rest = after;
        }
        let component = match rest {
            "" => None,
            ".x" => Some(0),
            ".y" => Some(1),
            ".z" => Some(2),
            _ => return None,
        };
        Some(Self { field, item, component })
    }

    /// Changes the number in the arguments; `None` when there is no number at the path.
    pub fn change<T: Scalar>(&self, args: &mut [Value<T>], f: impl FnOnce(T) -> T) -> Option<()> {
        fn at<T: Scalar>(
            value: &mut Value<T>,
            item: Option<usize>,
            component: Option<usize>,
            f: impl FnOnce(T) -> T,
        ) -> Option<()> {
            match (value, item, component) {
                (Value::List(items), Some(k), _) => {
                    let mut list = items.to_vec();
                    at(list.get_mut(k)?, None, component, f)?;
                    *items = list.into();
                }
                (Value::Number(x), None, None) => *x = f(*x),
                // {a, b, c} of numbers may stand for a list or a vector.
                (Value::Vector(v), k, c) if k.is_some() != c.is_some() => {
                    let mut xyz = v.to_array();
                    let x = xyz.get_mut(k.or(c)?)?;
                    *x = f(*x);
                    *v = Vec3::from(xyz);
                }
                _ => return None,
            }
            Some(())
        }
        at(args.get_mut(self.field)?, self.item, self.component, f)
    }
}

/// Seeds the literals of an object that derivatives are asked by.
pub(crate) fn seed<T: Scalar>(
    row: &Row,
    args: &mut [Value<T>],
    object: &str,
    seed: crate::interpreter::Seed<'_, T>,
) {
    // The few paths an object can have are tried: the seeding function knows the names.
    for (at, field) in row.fields.iter().enumerate() {
        let mut try_path = |path: NumberPath, name: String| {
            let _ = path.change(args, |x| seed(&name, x));
        };
        let base = format!("{object}.{}", field.name);
        try_path(NumberPath { field: at, item: None, component: None }, base.clone());
        for (c, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let path = NumberPath { field: at, item: None, component: Some(c) };
            try_path(path, format!("{base}.{axis}"));
        }
        let count = if field.many { length(&args[at]) } else { 0 };
        for k in 0..count {
            let mut try_path = |path: NumberPath, name: String| {
                let _ = path.change(args, |x| seed(&name, x));
            };
            let base = format!("{base}[{}]", k + 1);
            try_path(NumberPath { field: at, item: Some(k), component: None }, base.clone());
            for (c, axis) in ["x", "y", "z"].into_iter().enumerate() {
                let path = NumberPath { field: at, item: Some(k), component: Some(c) };
                try_path(path, format!("{base}.{axis}"));
            }
        }
    }
}

fn length<T: Scalar>(value: &Value<T>) -> usize {
    match value {
        Value::List(items) => items.len(),
        Value::Vector(_) => 3,
        _ => 0,
    }
}
