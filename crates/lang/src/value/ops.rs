//! Operators on values: element by element over rows and grids of equal shape, or with a scalar.

use crate::value::blocks;
use crate::value::variables::Called as _;
use moldloft_diag::Diagnostic;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Array, ArrayShape, Value, Vectors as Planes};
use moldloft_syntax::sdl::{BinaryOp, UnaryOp};

use std::borrow::Cow;
use std::sync::Arc;

/// A value as its elements: all numbers or all vectors, and the shape they form.
enum Elements<'v, T: Real> {
    Number(T),
    Vector(Vec3<T>),
    Numbers(&'v Array<T>),
    Vectors(&'v Planes<T>),
}

fn elements<'v, T: Real>(value: &'v Value<T>, op: &str) -> Result<Elements<'v, T>, Diagnostic> {
    Ok(match value {
        Value::Number(x) => Elements::Number(*x),
        Value::Vector(v) => Elements::Vector(*v),
        Value::Point(p) => Elements::Vector(p.xyz),
        Value::Numbers(a) => Elements::Numbers(a),
        Value::Vectors(a) => Elements::Vectors(a),
        other => {
            let class = crate::value::variables::a(other);
            let help = match other {
                Value::Curve(_) => Some(
                    "a pcurve is only assigned, passed and returned; compute with its points: \
                     c(t), or distc(c, s) for a row of parameters",
                ),
                Value::Surface(_) => Some(
                    "a psurface is only assigned, passed and returned; compute with its points: \
                     s(u, v), or dists(s, us, vs)",
                ),
                _ => None,
            };
            let help = match other {
                Value::Text(_) if op == "+" => {
                    Some("texts join texts: format(\"%g\", x) makes a text of a number")
                }
                _ => help,
            };
            return Err(Diagnostic::error(
                "wrong-operand",
                format!("`{op}` does not take {class}"),
            )
            .expected("numbers, vectors, farrays, curves or surfaces")
            .found(class)
            .maybe_help(help));
        }
    })
}

/// The longest text that a program may make: as long as the longest program.
pub(crate) const LONGEST_TEXT: usize = 64 << 20;

pub(crate) fn shapes_differ(a: ArrayShape, b: ArrayShape) -> Diagnostic {
    Diagnostic::error("shapes-differ", format!("shapes differ: {a} and {b}"))
        .expected("equal shapes, or a single value on one side")
        .found(format!("{a} and {b}"))
}

/// A row or grid whose elements come one by one.
trait Elementwise<E> {
    fn shape(&self) -> ArrayShape;
    fn each(&self) -> impl Iterator<Item = E>;
}

impl<E: Copy> Elementwise<E> for Array<E> {
    fn shape(&self) -> ArrayShape {
        self.shape
    }
    fn each(&self) -> impl Iterator<Item = E> {
        self.items.iter().copied()
    }
}

impl<T: Real> Elementwise<Vec3<T>> for Planes<T> {
    fn shape(&self) -> ArrayShape {
        self.shape
    }
    fn each(&self) -> impl Iterator<Item = Vec3<T>> {
        self.iter()
    }
}

fn zipped<A, B, C>(
    a: &impl Elementwise<A>,
    b: &impl Elementwise<B>,
    mut f: impl FnMut(A, B) -> C,
) -> Result<Array<C>, Diagnostic> {
    if a.shape() != b.shape() {
        return Err(shapes_differ(a.shape(), b.shape()));
    }
    let items = a.each().zip(b.each()).map(|(x, y)| f(x, y)).collect();
    Ok(Array { shape: a.shape(), items })
}

fn mapped<A, C>(a: &impl Elementwise<A>, f: impl FnMut(A) -> C) -> Array<C> {
    Array { shape: a.shape(), items: a.each().map(f).collect() }
}

fn numbers<T: Real>(array: Array<T>) -> Value<T> {
    Value::Numbers(Arc::new(array))
}

fn vectors<T: Real>(array: Array<Vec3<T>>) -> Value<T> {
    Value::Vectors(Arc::new(Planes::new(array.shape, array.items)))
}

/// Rules of an operator by operand classes, such as a number and a vector; `None` if not defined.
struct Rules<T> {
    nn: Option<fn(T, T) -> T>,
    nv: Option<fn(T, Vec3<T>) -> Vec3<T>>,
    vn: Option<fn(Vec3<T>, T) -> Vec3<T>>,
    vv: Option<fn(Vec3<T>, Vec3<T>) -> Vec3<T>>,
    /// Two vectors to a number: the dot product.
    dot: bool,
}

/// The exponent, if it is a small integer: such powers are computed by multiplication, exact for
/// integers and defined for negative bases.
pub(crate) fn whole_power<T: Real>(b: T) -> Option<i32> {
    let k = b.re();
    (b.is_constant() && k.fract() == 0.0 && k.abs() <= 64.0).then_some(k as i32)
}

/// A whole power by multiplication; a negative one is the reciprocal of the positive one, which is exact for more bases
/// than the power of the reciprocal.
pub(crate) fn power_whole<T: Real>(a: T, k: i32) -> T {
    if k < 0 { T::one() / a.powi(-k) } else { a.powi(k) }
}

pub(crate) fn power<T: Real>(a: T, b: T) -> T {
    match whole_power(b) {
        Some(k) => power_whole(a, k),
        None => a.powf(b),
    }
}

/// True for an operand that makes a chain of operators one of sets.
pub(crate) fn is_set<T: Real>(value: &Value<T>) -> bool {
    matches!(value, Value::Set(_))
}

fn rules<T: Real>(op: BinaryOp) -> Option<Rules<T>> {
    let each = |f: fn(T, T) -> T, v: fn(Vec3<T>, Vec3<T>) -> Vec3<T>| Rules {
        nn: Some(f),
        nv: None,
        vn: None,
        vv: Some(v),
        dot: false,
    };
    Some(match op {
        BinaryOp::Add => each(|a, b| a + b, |a, b| a + b),
        BinaryOp::Sub => each(|a, b| a - b, |a, b| a - b),
        BinaryOp::Mul => Rules {
            nv: Some(|a, b| b * a),
            vn: Some(|a, b| a * b),
            ..each(|a, b| a * b, |a, b| Vec3::new(a.x * b.x, a.y * b.y, a.z * b.z))
        },
        BinaryOp::Div => Rules {
            vn: Some(|a, b| a / b),
            ..each(|a, b| a / b, |a, b| Vec3::new(a.x / b.x, a.y / b.y, a.z / b.z))
        },
        BinaryOp::Caret => Rules { nn: Some(power), nv: None, vn: None, vv: None, dot: false },
        BinaryOp::Cross => {
            Rules { nn: None, nv: None, vn: None, vv: Some(Vec3::cross), dot: false }
        }
        BinaryOp::Dot => Rules { nn: None, nv: None, vn: None, vv: None, dot: true },
        _ => return None,
    })
}

/// True for operands that `and` and `or` combine element by element.
pub(crate) fn is_array<T: Real>(value: &Value<T>) -> bool {
    matches!(value, Value::Numbers(_) | Value::Vectors(_) | Value::List(_) | Value::Block(_))
}

/// `a and b`, `a or b` by element, one of them an array.
pub(crate) fn logical<T: Real>(
    op: BinaryOp,
    a: &Value<T>,
    b: &Value<T>,
) -> Result<Value<T>, Diagnostic> {
    let f = move |a: T, b: T| {
        let (a, b) = (a.re() != 0.0, b.re() != 0.0);
        T::from(f64::from(u8::from(if op == BinaryOp::And { a && b } else { a || b })))
    };
    let differ = |found: String| {
        Diagnostic::error("shapes-differ", format!("shapes differ: {found}"))
            .expected("equal shapes, or a single value on one side")
            .found(found)
    };
    if let Some(layers) = blocks::by_layers(a, b, |a, b| logical(op, a, b), differ) {
        return layers;
    }
    let (a, b) = (&*moldloft_arrays::gathered(a), &*moldloft_arrays::gathered(b));
    let (a, b) = (&*beside(op, a, b), &*beside(op, b, a));
    Ok(match (elements(a, op.spelling())?, elements(b, op.spelling())?) {
        (Elements::Numbers(a), Elements::Numbers(b)) => numbers(zipped(a, b, f)?),
        (Elements::Numbers(a), Elements::Number(b)) => numbers(mapped(a, |a| f(a, b))),
        (Elements::Number(a), Elements::Numbers(b)) => numbers(mapped(b, |b| f(a, b))),
        _ => {
            let message = format!("`{}` combines conditions", op.spelling());
            return Err(Diagnostic::error("wrong-operand", message)
                .expected("comparisons, numbers or masks"));
        }
    })
}

pub(crate) fn not<T: Real>(a: &Array<T>) -> Value<T> {
    numbers(mapped(a, |x| T::from(f64::from(u8::from(x.re() == 0.0)))))
}

/// Three numbers in braces beside a row of three numbers, where a vector has no meaning: a row as well.
fn beside<'v, T: Real>(op: BinaryOp, value: &'v Value<T>, other: &Value<T>) -> Cow<'v, Value<T>> {
    let row = match (value, other) {
        (Value::Vector(v), Value::Numbers(a)) if a.shape == ArrayShape::Row(3) => v.to_array(),
        _ => return Cow::Borrowed(value),
    };
    match op {
        BinaryOp::Mul | BinaryOp::Div | BinaryOp::Dot | BinaryOp::Cross => Cow::Borrowed(value),
        _ => Cow::Owned(numbers(Array::row(row.to_vec()))),
    }
}

/// Two texts as one; `None` for one that is too long.
pub(crate) fn joined(a: &str, b: &str) -> Option<Arc<str>> {
    if a.len() + b.len() > LONGEST_TEXT {
        return None;
    }
    let mut text = String::with_capacity(a.len() + b.len());
    text.push_str(a);
    text.push_str(b);
    Some(text.into())
}

/// The value of `a op b`.
pub(crate) fn binary<T: Real>(
    op: BinaryOp,
    a: &Value<T>,
    b: &Value<T>,
) -> Result<Value<T>, Diagnostic> {
    use Elements::*;
    if let Some(outcome) = crate::value::implicit::binary(op, a, b) {
        return outcome;
    }
    if let (BinaryOp::Add, Value::Text(a), Value::Text(b)) = (op, a, b) {
        return joined(a, b).map(Value::Text).ok_or_else(|| {
            Diagnostic::error("too-many-elements", "the text is too long")
                .expected(format!("at most {LONGEST_TEXT} bytes"))
                .found(format!("{}", a.len() + b.len()))
                .help("write long texts to a file, piece by piece")
        });
    }
    if let Some(value) = of_texts(op, a, b) {
        return value;
    }
    let differ = |found: String| {
        Diagnostic::error("shapes-differ", format!("shapes differ: {found}"))
            .expected("equal shapes, or a single value on one side")
            .found(found)
    };
    if let Some(layers) = blocks::by_layers(a, b, |a, b| binary(op, a, b), differ) {
        return layers;
    }
    let (a, b) = (&*moldloft_arrays::gathered(a), &*moldloft_arrays::gathered(b));
    let (a, b) = (&*beside(op, a, b), &*beside(op, b, a));
    let word = op.spelling();
    let Some(r) = rules::<T>(op) else { return compare(op, a, b) };
    let undefined = || {
        let name = |value: &Value<T>| {
            let of = crate::value::variables::a(value);
            of.split_once(' ').map_or(of, |(_, name)| name)
        };
        let found = format!("{} {word} {}", name(a), name(b));
        let d = Diagnostic::error("wrong-operand", format!("`{word}` is not defined for {found}"));
        match op {
            BinaryOp::Add | BinaryOp::Sub => d.help(
                "add numbers to numbers and vectors to vectors: take a component (.x) or write \
                 {a, a, a}",
            ),
            _ if [a, b].iter().any(|v| matches!(v, Value::Text(_))) => d,
            BinaryOp::Caret => d.help("only numbers have powers; use . for a dot product"),
            BinaryOp::Dot | BinaryOp::Cross => {
                d.help("both sides must be vectors; multiply with *")
            }
            _ => d,
        }
    };
    let (x, y) = (elements(a, word)?, elements(b, word)?);
    if r.dot {
        let dot = |a: Vec3<T>, b: Vec3<T>| a.dot(b);
        return Ok(match (x, y) {
            (Vector(a), Vector(b)) => Value::Number(dot(a, b)),
            (Vectors(a), Vector(b)) => numbers(mapped(a, |a| dot(a, b))),
            (Vector(a), Vectors(b)) => numbers(mapped(b, |b| dot(a, b))),
            (Vectors(a), Vectors(b)) => numbers(zipped(a, b, dot)?),
            _ => return Err(undefined()),
        });
    }
    Ok(match (x, y, r.nn, r.nv, r.vn, r.vv) {
        (Number(a), Number(b), Some(f), ..) => Value::Number(f(a, b)),
        (Numbers(a), Number(b), Some(f), ..) => numbers(mapped(a, |a| f(a, b))),
        (Number(a), Numbers(b), Some(f), ..) => numbers(mapped(b, |b| f(a, b))),
        (Numbers(a), Numbers(b), Some(f), ..) => numbers(zipped(a, b, f)?),
        (Number(a), Vector(b), _, Some(f), ..) => Value::Vector(f(a, b)),
        (Numbers(a), Vector(b), _, Some(f), ..) => vectors(mapped(a, |a| f(a, b))),
        (Number(a), Vectors(b), _, Some(f), ..) => vectors(mapped(b, |b| f(a, b))),
        (Numbers(a), Vectors(b), _, Some(f), ..) => vectors(zipped(a, b, f)?),
        (Vector(a), Number(b), _, _, Some(f), _) => Value::Vector(f(a, b)),
        (Vectors(a), Number(b), _, _, Some(f), _) => vectors(mapped(a, |a| f(a, b))),
        (Vector(a), Numbers(b), _, _, Some(f), _) => vectors(mapped(b, |b| f(a, b))),
        (Vectors(a), Numbers(b), _, _, Some(f), _) => vectors(zipped(a, b, f)?),
        (Vector(a), Vector(b), .., Some(f)) => Value::Vector(f(a, b)),
        (Vectors(a), Vector(b), .., Some(f)) => vectors(mapped(a, |a| f(a, b))),
        (Vector(a), Vectors(b), .., Some(f)) => vectors(mapped(b, |b| f(a, b))),
        (Vectors(a), Vectors(b), .., Some(f)) => vectors(zipped(a, b, f)?),
        _ => return Err(undefined()),
    })
}

fn compare<T: Real>(op: BinaryOp, a: &Value<T>, b: &Value<T>) -> Result<Value<T>, Diagnostic> {
    if !matches!(
        op,
        BinaryOp::Lt | BinaryOp::Gt | BinaryOp::Le | BinaryOp::Ge | BinaryOp::Eq | BinaryOp::Ne
    ) {
        return Err(unsupported(op, a_of(a)));
    }
    let each = move |a: T, b: T| {
        let (a, b) = (a.re(), b.re());
        match op {
            BinaryOp::Lt => a < b,
            BinaryOp::Gt => a > b,
            BinaryOp::Le => a <= b,
            BinaryOp::Ge => a >= b,
            BinaryOp::Eq => a == b,
            _ => a != b,
        }
    };
    let mask = move |a: T, b: T| T::from(f64::from(u8::from(each(a, b))));
    let holds = match (a, b) {
        (Value::Number(a), Value::Number(b)) => each(*a, *b),
        // Arrays give masks: 1 where it holds, 0 elsewhere.
        (Value::Numbers(a), Value::Numbers(b)) => return Ok(numbers(zipped(&**a, &**b, mask)?)),
        (Value::Numbers(a), Value::Number(b)) => return Ok(numbers(mapped(&**a, |a| mask(a, *b)))),
        (Value::Number(a), Value::Numbers(b)) => return Ok(numbers(mapped(&**b, |b| mask(*a, b)))),
        // By code points, as in dictionaries of plain letters.
        (Value::Text(a), Value::Text(b)) => texts_compare(op, a, b),
        _ => {
            let found =
                format!("{} and {}", crate::value::variables::a(a), crate::value::variables::a(b));
            return Err(Diagnostic::error(
                "wrong-operand",
                format!("`{}` compares numbers, not {found}", op.spelling()),
            )
            .expected("numbers or arrays of numbers")
            .found(found)
            .help("compare a component (.x) or a length |v|"));
        }
    };
    Ok(Value::Number(T::from(f64::from(u8::from(holds)))))
}

fn texts_compare(op: BinaryOp, a: &str, b: &str) -> bool {
    match op {
        BinaryOp::Eq => a == b,
        BinaryOp::Ne => a != b,
        BinaryOp::Lt => a < b,
        BinaryOp::Le => a <= b,
        BinaryOp::Gt => a > b,
        _ => a >= b,
    }
}

/// Rows of texts joined or compared by element, with a row of as many or a single text; a comparison gives a mask.
/// `None` of other operands and operators.
fn of_texts<T: Real>(
    op: BinaryOp,
    a: &Value<T>,
    b: &Value<T>,
) -> Option<Result<Value<T>, Diagnostic>> {
    let row = |value: &Value<T>| -> Option<Vec<Arc<str>>> {
        let Value::List(items) = value else { return None };
        let text = |v: &Value<T>| if let Value::Text(t) = v { Some(t.clone()) } else { None };
        items.iter().map(text).collect::<Option<Vec<_>>>().filter(|texts| !texts.is_empty())
    };
    let pairs: Vec<(Arc<str>, Arc<str>)> = match (row(a), row(b), a, b) {
        (Some(a), Some(b), ..) if a.len() == b.len() => a.into_iter().zip(b).collect(),
        (Some(a), Some(b), ..) => {
            return Some(Err(shapes_differ(ArrayShape::Row(a.len()), ArrayShape::Row(b.len()))));
        }
        (Some(a), None, _, Value::Text(b)) => a.into_iter().map(|a| (a, b.clone())).collect(),
        (None, Some(b), Value::Text(a), _) => b.into_iter().map(|b| (a.clone(), b)).collect(),
        _ => return None,
    };
    Some(Ok(match op {
        BinaryOp::Add => Value::list(pairs.iter().map(|(a, b)| Value::text(&format!("{a}{b}")))),
        BinaryOp::Lt | BinaryOp::Gt | BinaryOp::Le | BinaryOp::Ge | BinaryOp::Eq | BinaryOp::Ne => {
            let holds = |(a, b): &(Arc<str>, Arc<str>)| u8::from(texts_compare(op, a, b));
            let mask = pairs.iter().map(|pair| T::from(f64::from(holds(pair))));
            numbers(Array::row(mask.collect()))
        }
        _ => return None,
    }))
}

fn a_of<T: Real>(value: &Value<T>) -> &'static str {
    value.class().with_article()
}

fn unsupported(op: BinaryOp, what: &str) -> Diagnostic {
    Diagnostic::error("wrong-operand", format!("`{}` is not defined for {what}", op.spelling()))
}

/// `-a`.
pub(crate) fn negated<T: Real>(a: &Value<T>) -> Result<Value<T>, Diagnostic> {
    if let Some(value) = crate::value::implicit::negated(a) {
        return Ok(value);
    }
    if let Some(layers) = blocks::by_layer(a, negated) {
        return layers;
    }
    Ok(match elements(&moldloft_arrays::gathered(a), "-")? {
        Elements::Number(x) => Value::Number(-x),
        Elements::Vector(v) => Value::Vector(-v),
        Elements::Numbers(a) => numbers(mapped(a, |x| -x)),
        Elements::Vectors(a) => vectors(mapped(a, |v| -v)),
    })
}

/// `|a|`: the length of vectors, the absolute value of numbers.
pub(crate) fn magnitude<T: Real>(a: &Value<T>) -> Result<Value<T>, Diagnostic> {
    if let Some(value) = crate::value::implicit::magnitude(a) {
        return Ok(value);
    }
    if let Some(layers) = blocks::by_layer(a, magnitude) {
        return layers;
    }
    Ok(match elements(a, "|")? {
        Elements::Number(x) => Value::Number(x.abs()),
        Elements::Vector(v) => Value::Number(v.norm()),
        Elements::Numbers(a) => numbers(mapped(a, T::abs)),
        Elements::Vectors(a) => numbers(mapped(a, Vec3::norm)),
    })
}

/// `{a, b, c, ...}`: a vector of three numbers, a row of vectors of three rows of numbers, else a
/// list.
pub(crate) fn braces<T: Real>(items: Vec<Value<T>>) -> Result<Value<T>, Diagnostic> {
    if let [Value::Number(x), Value::Number(y), Value::Number(z)] = items[..] {
        return Ok(Value::Vector(Vec3::new(x, y, z)));
    }
    if let [Value::Numbers(x), Value::Numbers(y), Value::Numbers(z)] = &items[..] {
        let xy = zipped(&**x, &**y, |x, y| (x, y))?;
        return Ok(vectors(zipped(&xy, &**z, |(x, y), z| Vec3::new(x, y, z))?));
    }
    Ok(Value::list(items))
}

pub(crate) fn is_elementwise(op: BinaryOp) -> bool {
    matches!(
        op,
        BinaryOp::Add
            | BinaryOp::Sub
            | BinaryOp::Mul
            | BinaryOp::Div
            | BinaryOp::Caret
            | BinaryOp::Dot
            | BinaryOp::Cross
    )
}

pub(crate) fn unary<T: Real>(op: UnaryOp, value: &Value<T>) -> Result<Value<T>, Diagnostic> {
    match op {
        UnaryOp::Plus => Ok(value.clone()),
        UnaryOp::Minus => negated(value),
        UnaryOp::Not => match value {
            Value::Number(x) => Ok(Value::Number(T::from(f64::from(u8::from(x.re() == 0.0))))),
            Value::Numbers(a) => Ok(not(a)),
            Value::Block(_) => match blocks::by_layer(value, |layer| unary(op, layer)) {
                Some(layers) => layers,
                None => Ok(value.clone()),
            },
            other => Err(Diagnostic::error("wrong-operand", "`not` takes a condition")
                .expected("a comparison or a number")
                .found(other.called())),
        },
    }
}

/// The value of `a op b` for two numbers; `None` where it is not a number.
pub(crate) fn of_numbers<T: Real>(op: BinaryOp, a: T, b: T) -> Option<T> {
    rules::<T>(op)?.nn.map(|f| f(a, b))
}
