//! Fields from the text forms of other programs: fidget's list of operations and libfive's nested lists.

use super::{TextError, wrong};
use crate::{FieldError, Primitive};
use std::collections::HashMap;

fn unary(name: &str, a: &Primitive) -> Option<Result<Primitive, FieldError>> {
    let one = || Primitive::real(1.0);
    let floor = |a: &Primitive| a.remainder(&one()).map(|m| a - &m);
    Some(match name {
        "neg" => Ok(-a),
        "abs" => Ok(a.abs()),
        "sqrt" => Ok(a.sqrt()),
        "square" => Ok(a.power(2)),
        "recip" | "reciprocal" => one().over(a),
        "sin" => Ok(a.sin()),
        "cos" => Ok(a.cos()),
        "tan" => Ok(a.tan()),
        "exp" => Ok(a.exp()),
        "ln" | "log" => Ok(a.ln()),
        "atan" => Ok(a.atan2(&one())),
        "asin" => Ok(a.atan2(&(one() - a.power(2)).sqrt())),
        "acos" => Ok((one() - a.power(2)).sqrt().atan2(a)),
        "floor" => floor(a),
        "ceil" => floor(&-a).map(|f| -f),
        "round" => floor(&(a + 0.5)),
        "copy" | "const-var" => Ok(a.clone()),
        _ => return None,
    })
}

fn binary(name: &str, a: &Primitive, b: &Primitive) -> Option<Result<Primitive, FieldError>> {
    Some(match name {
        "add" | "+" => Ok(a + b),
        "sub" | "-" => Ok(a - b),
        "mul" | "*" => Ok(a * b),
        "div" | "/" => a.over(b),
        "min" => Ok(a.min(b)),
        "max" => Ok(a.max(b)),
        "mod" | "modulo" => a.remainder(b),
        "atan2" | "atan" => Ok(a.atan2(b)),
        "compare" => Ok((a - b).sign()),
        "pow" | "expt" => match b.constant_value() {
            Some(n) => a.to_power(n),
            None => Err(FieldError::Exponent { value: f64::NAN }),
        },
        "nth-root" => match b.constant_value() {
            Some(2.0) => Ok(a.sqrt()),
            _ => Err(FieldError::Exponent { value: f64::NAN }),
        },
        _ => return None,
    })
}

fn axis(name: &str) -> Option<Primitive> {
    let [x, y, z] = Primitive::axes();
    match name {
        "var-x" | "x" | "X" => Some(x),
        "var-y" | "y" | "Y" => Some(y),
        "var-z" | "z" | "Z" => Some(z),
        _ => None,
    }
}

/// The field of a fidget text: a line `name operation operands` for each value, the last being the
/// field.
///
/// # Errors
/// The fault of the text, with its line.
///
/// # Example
/// ```
/// use moldloft_field::read_fidget;
/// use moldloft_num::Vec3;
///
/// let text = "# a circle\n_0 const 1\n_1 var-x\n_2 square _1\n_3 var-y\n_4 square _3\n_5 add _2 _4\n_6 sub _5 _0\n";
/// assert_eq!(read_fidget(text).unwrap().value(Vec3::of(3.0, 4.0, 7.0)), 24.0);
/// ```
pub fn read_fidget(text: &str) -> Result<Primitive, TextError> {
    let mut known: HashMap<&str, Primitive> = HashMap::new();
    let mut last = None;
    for (number, line) in text.lines().enumerate().map(|(k, l)| (k + 1, l.trim())) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        let [name, op, operands @ ..] = &words[..] else {
            return wrong(number, format!("expected `name operation operands`, found `{line}`"));
        };
        let of = |k: usize| match operands.get(k).map(|n| (n, known.get(n))) {
            Some((_, Some(p))) => Ok(p),
            Some((n, None)) => wrong(number, format!("`{n}` is not above")),
            None => wrong(number, format!("`{op}` lacks an operand")),
        };
        let made = if *op == "const" {
            match operands.first().map(|c| c.parse::<f64>()) {
                Some(Ok(c)) if c.is_finite() => Ok(Primitive::real(c)),
                _ => return wrong(number, "expected a finite number after `const`"),
            }
        } else if let Some(p) = axis(op) {
            Ok(p)
        } else if operands.len() == 1 {
            match unary(op, of(0)?) {
                Some(made) => made,
                None => return wrong(number, format!("there is no operation `{op}` of one value")),
            }
        } else {
            match binary(op, of(0)?, of(1)?) {
                Some(made) => made,
                None => {
                    return wrong(number, format!("there is no operation `{op}` of two values"));
                }
            }
        };
        let made = made.or_else(|e| wrong(number, e.to_string()))?;
        known.insert(name, made.clone());
        last = Some(made);
    }
    match last {
        Some(p) => Ok(p),
        None => wrong(1, "the text has no operation"),
    }
}

/// The field of a libfive text: nested lists such as `(- (sqrt (+ (square x) (square y))) 1)`.
///
/// # Errors
/// The fault of the text, with its line.
///
/// # Example
/// ```
/// use moldloft_field::read_libfive;
/// use moldloft_num::Vec3;
///
/// let f = read_libfive("(max (- x 1) (- (+ x y z)) )").unwrap();
/// assert_eq!(f.value(Vec3::of(3.0, 0.0, 0.0)), 2.0);
/// ```
pub fn read_libfive(text: &str) -> Result<Primitive, TextError> {
    let mut line = 1;
    let mut stack: Vec<(Option<String>, Vec<Primitive>, usize)> = Vec::new();
    let mut whole: Option<Primitive> = None;
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        let value = match c {
            '\n' => {
                line += 1;
                continue;
            }
            ';' => {
                while chars.next_if(|c| *c != '\n').is_some() {}
                continue;
            }
            _ if c.is_whitespace() => continue,
            '(' => {
                stack.push((None, Vec::new(), line));
                continue;
            }
            ')' => {
                let Some((op, operands, from)) = stack.pop() else {
                    return wrong(line, "`)` without `(`");
                };
                let Some(op) = op else { return wrong(from, "a list without an operation") };
                applied(&op, &operands, line)?
            }
            _ => {
                let mut word = String::from(c);
                while let Some(c) =
                    chars.next_if(|c| !c.is_whitespace() && !matches!(c, '(' | ')' | ';'))
                {
                    word.push(c);
                }
                if let Some((op @ None, ..)) = stack.last_mut() {
                    *op = Some(word);
                    continue;
                }
                match (axis(&word), word.parse::<f64>()) {
                    (Some(p), _) => p,
                    (_, Ok(x)) if x.is_finite() => Primitive::real(x),
                    _ => {
                        return wrong(
                            line,
                            format!("expected x, y, z or a number, found `{word}`"),
                        );
                    }
                }
            }
        };
        match stack.last_mut() {
            Some((Some(_), operands, _)) => operands.push(value),
            Some((None, ..)) => return wrong(line, "a list begins with an operation"),
            None if whole.is_some() => return wrong(line, "nothing more was expected"),
            None => whole = Some(value),
        }
    }
    match (stack.last(), whole) {
        (Some((_, _, from)), _) => wrong(*from, "`(` without `)`"),
        (None, Some(p)) => Ok(p),
        (None, None) => wrong(1, "the text has no field"),
    }
}

/// An operation of any number of operands.
fn applied(op: &str, operands: &[Primitive], line: usize) -> Result<Primitive, TextError> {
    let made = match operands {
        [] => return wrong(line, format!("`{op}` lacks an operand")),
        [a] if op == "-" => Some(Ok(-a)),
        [a] if op == "/" => unary("recip", a),
        [a] if matches!(op, "+" | "*" | "min" | "max") => Some(Ok(a.clone())),
        [a] => unary(op, a),
        [a, rest @ ..] => {
            let mut sum = Some(Ok(a.clone()));
            for b in rest {
                sum = match sum {
                    Some(Ok(a)) => binary(op, &a, b),
                    other => other,
                };
            }
            sum
        }
    };
    match made {
        Some(made) => made.or_else(|e| wrong(line, e.to_string())),
        None => wrong(line, format!("there is no operation `{op}` of {} values", operands.len())),
    }
}
