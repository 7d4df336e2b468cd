//! Values of dimensions and variables: expressions over names.

use moldloft_diag::FileId;
use moldloft_num::{Real, log10, modulo, whole_quotient};
use moldloft_syntax::sdl::{self, BinaryOp, ExprId, ExprKind, Grouping, Program, Step, UnaryOp};
use std::fmt;

/// The functions that an expression may call: those of the model language from numbers to a number,
/// and `ln`.
pub const FUNCTIONS: [&str; 27] = [
    "sqrt", "abs", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "ln", "log", "log10",
    "sinh", "cosh", "tanh", "sign", "floor", "ceil", "round", "atan2", "hypot", "mod", "div",
    "clamp", "where", "min", "max",
];

/// Minimum and maximum number of arguments of a function, by its index.
fn arity(function: usize) -> [usize; 2] {
    match FUNCTIONS[function] {
        "atan2" | "hypot" | "mod" | "div" => [2; 2],
        "clamp" | "where" => [3; 2],
        "min" | "max" => [1, usize::MAX],
        _ => [1; 2],
    }
}

#[derive(Clone, Debug, PartialEq)]
enum ExprOp {
    Number(f64),
    Name(String),
    Negate,
    Not,
    /// Arithmetic, and comparisons and connections of conditions.
    Binary(BinaryOp),
    /// A function and its number of arguments.
    Call(usize, usize),
}

/// A numeric expression in the grammar of SDL, with angles in degrees as everywhere in this
/// language. It is parsed once and evaluated over any scalar.
///
/// ```
/// use moldloft_sketch::DimensionExpr;
/// let e = DimensionExpr::parse("2*W1 + 0.5").unwrap();
/// assert_eq!(e.eval(&|name| (name == "w1").then_some(3.0)), Ok(6.5));
/// assert_eq!(e.names().collect::<Vec<_>>(), ["w1"]);
/// assert!(DimensionExpr::parse("2*").is_err());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DimensionExpr {
    text: String,
    ops: Vec<ExprOp>,
}

/// Reason why an expression has no value: a name is unknown or has no value itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoValue {
    /// The name, folded.
    pub name: String,
}

impl DimensionExpr {
    /// A plain number.
    pub fn number(value: f64) -> DimensionExpr {
        DimensionExpr {
            text: moldloft_syntax::number::plain(value),
            ops: vec![ExprOp::Number(value)],
        }
    }

    /// The value of a name, as an expression.
    pub fn name(name: &str) -> DimensionExpr {
        DimensionExpr { text: name.to_owned(), ops: vec![ExprOp::Name(name.to_ascii_lowercase())] }
    }

    /// Parses a text.
    ///
    /// # Errors
    /// A description of the syntax error.
    pub fn parse(text: &str) -> Result<DimensionExpr, String> {
        let text = text.trim();
        let (program, root, diagnostics) = sdl::parse_expr(text, FileId(0));
        if let Some(d) = diagnostics.first() {
            return Err(d.message.clone());
        }
        let mut ops = Vec::new();
        compile(&program, root, &mut ops)?;
        if !is_number(&ops) {
            return Err(format!("`{text}` is not a number, or has a condition in place of one"));
        }
        Ok(DimensionExpr { text: text.to_owned(), ops })
    }

    /// As written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The number, if the expression is only a number.
    pub fn literal(&self) -> Option<f64> {
        match self.ops.as_slice() {
            [ExprOp::Number(x)] => Some(*x),
            [ExprOp::Number(x), ExprOp::Negate] => Some(-x),
            _ => None,
        }
    }

    /// The expression plus a number.
    pub fn plus(&self, shift: f64) -> DimensionExpr {
        match self.literal() {
            Some(x) => DimensionExpr::number(x + shift),
            None => self.within(&format!("({self})+({})", moldloft_syntax::number::plain(shift))),
        }
    }

    /// The expression times a number.
    pub fn times(&self, factor: f64) -> DimensionExpr {
        match self.literal() {
            Some(x) => DimensionExpr::number(x * factor),
            None => self.within(&format!("({self})*({})", moldloft_syntax::number::plain(factor))),
        }
    }

    /// A text with this expression in it; two of them parse if each does.
    fn within(&self, text: &str) -> DimensionExpr {
        DimensionExpr::parse(text).unwrap_or_else(|_| self.clone())
    }

    /// The names it reads, in lower case.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.ops.iter().filter_map(|op| match op {
            ExprOp::Name(name) => Some(name.as_str()),
            _ => None,
        })
    }

    /// The expression with every name changed by `rename` (lower case in and out).
    pub fn renamed(&self, rename: &dyn Fn(&str) -> Option<String>) -> DimensionExpr {
        let mut names: Vec<&str> = self.names().filter(|n| rename(n).is_some()).collect();
        names.sort_unstable();
        names.dedup();
        if names.is_empty() {
            return self.clone();
        }
        let mut out = String::new();
        let mut word = String::new();
        let lower = |w: &str| w.to_ascii_lowercase();
        for c in self.text.chars().chain(['\n']) {
            if c.is_ascii_alphanumeric() || c == '_' || (c == '.' && !word.is_empty()) {
                word.push(c);
                continue;
            }
            let replaced = names.iter().find(|n| **n == lower(&word)).and_then(|n| rename(n));
            out.push_str(replaced.as_deref().unwrap_or(&word));
            word.clear();
            if c != '\n' {
                out.push(c);
            }
        }
        DimensionExpr::parse(&out).unwrap_or_else(|_| self.clone())
    }

    /// The value; names are looked up in lower case.
    ///
    /// # Errors
    /// The first name without a value.
    pub fn eval<T: Real>(&self, value: &dyn Fn(&str) -> Option<T>) -> Result<T, NoValue> {
        let mut stack: Vec<T> = Vec::with_capacity(4);
        for op in &self.ops {
            let next = match op {
                ExprOp::Number(x) => T::from(*x),
                ExprOp::Name(name) => value(name).ok_or_else(|| NoValue { name: name.clone() })?,
                ExprOp::Negate => -pop(&mut stack),
                ExprOp::Not => truth(pop(&mut stack).re() == 0.0),
                ExprOp::Binary(op) => {
                    let (right, left) = (pop(&mut stack), pop(&mut stack));
                    binary_value(*op, left, right)
                }
                ExprOp::Call(k, count) => {
                    let arguments = stack.split_off(stack.len().saturating_sub(*count));
                    call(FUNCTIONS[*k], &arguments)
                }
            };
            stack.push(next);
        }
        Ok(pop(&mut stack))
    }
}

/// A condition as a number.
fn truth<T: Real>(holds: bool) -> T {
    T::from(f64::from(u8::from(holds)))
}

fn binary_value<T: Real>(op: BinaryOp, left: T, right: T) -> T {
    let (a, b) = (left.re(), right.re());
    match op {
        BinaryOp::Add => left + right,
        BinaryOp::Sub => left - right,
        BinaryOp::Mul => left * right,
        BinaryOp::Div => left / right,
        BinaryOp::Lt => truth(a < b),
        BinaryOp::Gt => truth(a > b),
        BinaryOp::Le => truth(a <= b),
        BinaryOp::Ge => truth(a >= b),
        BinaryOp::Eq => truth(a == b),
        BinaryOp::Ne => truth(a != b),
        BinaryOp::And => truth(a != 0.0 && b != 0.0),
        BinaryOp::Or => truth(a != 0.0 || b != 0.0),
        _ => power(left, right),
    }
}

/// A function of as many numbers as it takes; angles are in degrees.
fn call<T: Real>(function: &str, x: &[T]) -> T {
    let degree = std::f64::consts::PI / 180.0;
    match (function, x) {
        ("min", [first, rest @ ..]) => rest.iter().fold(*first, |a, b| a.min(*b)),
        ("max", [first, rest @ ..]) => rest.iter().fold(*first, |a, b| a.max(*b)),
        ("atan2", &[y, x]) => y.atan2(x) / degree,
        ("hypot", &[x, y]) => (x * x + y * y).sqrt(),
        ("mod", &[x, y]) => modulo(x, y),
        ("div", &[x, y]) => T::from(whole_quotient(x.re(), y.re())),
        ("clamp", &[x, low, high]) => x.max(low).min(high),
        ("where", &[condition, a, b]) => {
            if condition.re() == 0.0 {
                b
            } else {
                a
            }
        }
        (_, &[x]) => match function {
            "sqrt" => x.sqrt(),
            "abs" => x.abs(),
            "sin" => (x * degree).sin(),
            "cos" => (x * degree).cos(),
            "tan" => (x * degree).tan(),
            "asin" => x.asin() / degree,
            "acos" => x.acos() / degree,
            "atan" => x.atan() / degree,
            "exp" => x.exp(),
            "log10" => log10(x),
            "sinh" => x.sinh(),
            "cosh" => x.cosh(),
            "tanh" => x.tanh(),
            "sign" => T::from(if x.re() == 0.0 { 0.0 } else { x.re().signum() }),
            "floor" => T::from(x.re().floor()),
            "ceil" => T::from(x.re().ceil()),
            "round" => T::from(x.re().round()),
            _ => x.ln(),
        },
        // The compiler has counted the arguments.
        _ => T::zero(),
    }
}

/// True if operands have the right types (number or condition) and the result is a number.
fn is_number(ops: &[ExprOp]) -> bool {
    use BinaryOp::{And, Eq, Ge, Gt, Le, Lt, Ne, Or};
    // True for a condition.
    let mut stack: Vec<bool> = Vec::new();
    for op in ops {
        let (takes, makes): (Vec<bool>, bool) = match op {
            ExprOp::Number(_) | ExprOp::Name(_) => (vec![], false),
            ExprOp::Negate => (vec![false], false),
            ExprOp::Not => (vec![true], true),
            ExprOp::Binary(And | Or) => (vec![true; 2], true),
            ExprOp::Binary(Lt | Gt | Le | Ge | Eq | Ne) => (vec![false; 2], true),
            ExprOp::Binary(_) => (vec![false; 2], false),
            ExprOp::Call(k, 3) if FUNCTIONS[*k] == "where" => (vec![true, false, false], false),
            ExprOp::Call(_, count) => (vec![false; *count], false),
        };
        let from = stack.len().saturating_sub(takes.len());
        if stack[from..] != takes[..] {
            return false;
        }
        stack.truncate(from);
        stack.push(makes);
    }
    stack == [false]
}

/// Whole powers by multiplication, so that a negative base is allowed.
fn power<T: Real>(base: T, exponent: T) -> T {
    let e = exponent.re();
    if exponent.is_constant() && e == e.trunc() && e.abs() < 1000.0 {
        base.powi(e as i32)
    } else {
        base.powf(exponent)
    }
}

/// The compiler leaves as many values as it takes, so the stack is never empty here.
fn pop<T: Real>(stack: &mut Vec<T>) -> T {
    stack.pop().unwrap_or_default()
}

fn compile(program: &Program, id: ExprId, ops: &mut Vec<ExprOp>) -> Result<(), String> {
    let expr = &program[id];
    let refused = || Err(format!("`{}` is not a number", program.slice(expr.span)));
    match expr.kind {
        ExprKind::Number(literal) => ops.push(ExprOp::Number(program[literal].value)),
        ExprKind::Name(symbol) => {
            let name = program.name(symbol).to_ascii_lowercase();
            ops.push(if name == "pi" {
                ExprOp::Number(std::f64::consts::PI)
            } else {
                ExprOp::Name(name)
            });
        }
        ExprKind::Member { .. } => {
            let name: String =
                program.slice(expr.span).chars().filter(|c| !c.is_whitespace()).collect();
            if !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '.') {
                return refused();
            }
            ops.push(ExprOp::Name(name.to_ascii_lowercase()));
        }
        ExprKind::Paren(inner) => compile(program, inner, ops)?,
        ExprKind::Unary { op, operand } => {
            compile(program, operand, ops)?;
            sign(op, ops)?;
        }
        ExprKind::Binary { op, left, right } => {
            compile(program, left, ops)?;
            compile(program, right, ops)?;
            ops.push(binary(op)?);
        }
        ExprKind::Chain(items) => {
            for step in program.grouped(items, Grouping::Numbers) {
                match step {
                    Step::Push(operand) => compile(program, operand, ops)?,
                    Step::Unary(op, _) => sign(op, ops)?,
                    Step::Binary(op, _) => ops.push(binary(op)?),
                }
            }
        }
        ExprKind::Call { callee, args } => {
            let name = program.slice(program[callee].span).to_ascii_lowercase();
            let Some(k) = FUNCTIONS.iter().position(|f| *f == name) else {
                return Err(format!(
                    "unknown function `{name}` here; there are {}",
                    FUNCTIONS.join(", ")
                ));
            };
            let args = &program[args];
            let [least, most] = arity(k);
            if !(least..=most).contains(&args.len()) {
                let many = match least {
                    2 => "two arguments",
                    3 => "three arguments",
                    _ => "one argument",
                };
                let more = if most > least { " or more" } else { "" };
                return Err(format!("`{name}` takes {many}{more}"));
            }
            for arg in args {
                compile(program, arg.value, ops)?;
            }
            ops.push(ExprOp::Call(k, args.len()));
        }
        _ => return refused(),
    }
    Ok(())
}

fn sign(op: UnaryOp, ops: &mut Vec<ExprOp>) -> Result<(), String> {
    match op {
        UnaryOp::Plus => {}
        UnaryOp::Minus => ops.push(ExprOp::Negate),
        UnaryOp::Not => ops.push(ExprOp::Not),
    }
    Ok(())
}

fn binary(op: BinaryOp) -> Result<ExprOp, String> {
    use BinaryOp::{Add, And, Caret, Div, Eq, Ge, Gt, Le, Lt, Mul, Ne, Or, Sub};
    match op {
        Add | Sub | Mul | Div | Caret | Lt | Gt | Le | Ge | Eq | Ne | And | Or => {
            Ok(ExprOp::Binary(op))
        }
        _ => Err(format!("`{}` does not combine numbers to a number", op.spelling())),
    }
}

impl fmt::Display for DimensionExpr {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
