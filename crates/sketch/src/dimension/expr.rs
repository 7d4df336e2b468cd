//! Values of dimensions and variables: expressions over names.

use moldloft_diag::FileId;
use moldloft_num::Real;
use moldloft_syntax::sdl::{self, BinaryOp, ExprId, ExprKind, Grouping, Program, Step, UnaryOp};
use std::fmt;

/// The functions an expression may call. The last ones, from [`FIRST_OF_TWO`] on, take two arguments.
pub const FUNCTIONS: [&str; 17] = [
    "sqrt", "abs", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "ln", "floor", "ceil",
    "round", "min", "max", "atan2", "mod",
];

/// The index of the first function of two arguments.
const FIRST_OF_TWO: usize = 13;

#[derive(Clone, Debug, PartialEq)]
enum ExprOp {
    Number(f64),
    Name(String),
    Negate,
    Binary(BinaryOp),
    Call(usize),
}

/// An expression in the grammar of SDL, of numbers only; angles are in degrees, as in all of this
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

/// Why an expression has no value: a name is unknown or has none itself.
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

    /// Parses a text.
    ///
    /// # Errors
    /// Says what is not understood.
    pub fn parse(text: &str) -> Result<DimensionExpr, String> {
        let text = text.trim();
        let (program, root, diagnostics) = sdl::parse_expr(text, FileId(0));
        if let Some(d) = diagnostics.first() {
            return Err(d.message.clone());
        }
        let mut ops = Vec::new();
        compile(&program, root, &mut ops)?;
        Ok(DimensionExpr { text: text.to_owned(), ops })
    }

    /// As written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The number, when the expression is nothing else.
    pub fn literal(&self) -> Option<f64> {
        match self.ops.as_slice() {
            [ExprOp::Number(x)] => Some(*x),
            [ExprOp::Number(x), ExprOp::Negate] => Some(-x),
            _ => None,
        }
    }

    /// The names it reads, in lower case.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.ops.iter().filter_map(|op| match op {
            ExprOp::Name(name) => Some(name.as_str()),
            _ => None,
        })
    }

    /// The same with every name changed by `rename` (given and giving lower case).
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

    /// The value, with names looked up in lower case.
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
                ExprOp::Binary(op) => {
                    let (right, left) = (pop(&mut stack), pop(&mut stack));
                    match op {
                        BinaryOp::Add => left + right,
                        BinaryOp::Sub => left - right,
                        BinaryOp::Mul => left * right,
                        BinaryOp::Div => left / right,
                        _ => power(left, right),
                    }
                }
                ExprOp::Call(k) if *k >= FIRST_OF_TWO => {
                    let (y, x) = (pop(&mut stack), pop(&mut stack));
                    match FUNCTIONS[*k] {
                        "min" => x.min(y),
                        "max" => x.max(y),
                        "atan2" => x.atan2(y) * (180.0 / std::f64::consts::PI),
                        _ => x - y * (x.re() / y.re()).floor(),
                    }
                }
                ExprOp::Call(k) => {
                    let x = pop(&mut stack);
                    let degree = std::f64::consts::PI / 180.0;
                    match FUNCTIONS[*k] {
                        "sqrt" => x.sqrt(),
                        "abs" => x.abs(),
                        "sin" => (x * degree).sin(),
                        "cos" => (x * degree).cos(),
                        "tan" => (x * degree).tan(),
                        "asin" => x.asin() / degree,
                        "acos" => x.acos() / degree,
                        "atan" => x.atan() / degree,
                        "exp" => x.exp(),
                        "floor" => T::from(x.re().floor()),
                        "ceil" => T::from(x.re().ceil()),
                        "round" => T::from(x.re().round()),
                        _ => x.ln(),
                    }
                }
            };
            stack.push(next);
        }
        Ok(pop(&mut stack))
    }
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
            let wanted = if k >= FIRST_OF_TWO { 2 } else { 1 };
            if args.len() != wanted {
                let many = if wanted == 2 { "two arguments" } else { "one argument" };
                return Err(format!("`{name}` takes {many}"));
            }
            for arg in args {
                compile(program, arg.value, ops)?;
            }
            ops.push(ExprOp::Call(k));
        }
        _ => return refused(),
    }
    Ok(())
}

fn sign(op: UnaryOp, ops: &mut Vec<ExprOp>) -> Result<(), String> {
    match op {
        UnaryOp::Plus => {}
        UnaryOp::Minus => ops.push(ExprOp::Negate),
        UnaryOp::Not => return Err("`not` does not apply to numbers".to_owned()),
    }
    Ok(())
}

fn binary(op: BinaryOp) -> Result<ExprOp, String> {
    use BinaryOp::{Add, Caret, Div, Mul, Sub};
    match op {
        Add | Sub | Mul | Div | Caret => Ok(ExprOp::Binary(op)),
        _ => Err(format!("`{}` does not combine numbers to a number", op.spelling())),
    }
}

impl fmt::Display for DimensionExpr {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
