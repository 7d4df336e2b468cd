//! Names and numbers of model files, and how the language spells them.

use moldloft_diag::FileId;
use moldloft_registry::Unit;
use moldloft_syntax::number;

/// True for the words of numbers without objects.
pub(crate) fn is_real(entity: &str) -> bool {
    matches!(entity, "Variable" | "Formula")
}

/// Our word for an entity of model files that has another one there.
pub(crate) fn our_word(entity: &str) -> &str {
    match entity {
        "CGPoint" => "CentroidPoint",
        "PolyCurve2" => "PolyCurve",
        "2PtPlane" => "TwoPointPlane",
        "3PtPlane" => "ThreePointPlane",
        other => other,
    }
}

/// A formula without its `=` or brackets.
pub(crate) fn bare(formula: &str) -> &str {
    let inside = formula.strip_prefix('[').map(|f| f.strip_suffix(']').unwrap_or(f));
    inside.unwrap_or_else(|| formula.trim_start_matches('=')).trim()
}

/// The words of a formula that may be names, with their start; words after a point are left out.
pub(crate) fn words(formula: &str) -> impl Iterator<Item = (usize, &str)> {
    let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut at = 0;
    std::iter::from_fn(move || {
        let begin = at + formula[at..].find(word)?;
        let length = formula[begin..].find(|c| !word(c)).unwrap_or(formula.len() - begin);
        at = begin + length;
        Some((begin, &formula[begin..at]))
    })
    .filter(move |(begin, word)| {
        let member = formula[..*begin].ends_with('.');
        !member && word.starts_with(|c: char| !c.is_ascii_digit())
    })
}

/// True for `A:Layer(3)`, spelled as the writer does.
pub(crate) fn is_layer(attribute: &str) -> bool {
    let number = attribute.strip_prefix("A:Layer(").and_then(|rest| rest.strip_suffix(')'));
    number.is_some_and(|n| n.parse::<u8>().is_ok_and(|layer| layer > 0 && layer.to_string() == n))
}

/// The plane "y=0" of the name `*Y=0`.
pub(crate) fn system_name(text: &str) -> Option<String> {
    let plane = text.strip_prefix('*')?.to_ascii_lowercase();
    matches!(&*plane, "x=0" | "y=0" | "z=0").then_some(plane)
}

/// The angle in degrees: the shortest decimal that reads back as these very radians.
pub(crate) fn degrees(radians: f64) -> f64 {
    let near = radians.to_degrees();
    let shortest = (0..17).filter_map(|digits| format!("{near:.digits$e}").parse::<f64>().ok());
    let neighbours = [near.next_up(), near.next_down()];
    let exact = |x: &f64| x.to_radians() == radians;
    shortest.chain(neighbours).find(exact).unwrap_or(near)
}

/// The name of an object as an identifier of the language; [`plain_name`] takes it back.
///
/// A character that no identifier has becomes `_x2d_`, its code in hexadecimal digits; so do the
/// first letter of a reserved word and a `_` that would look like the beginning of such a code.
pub(crate) fn identifier(name: &str) -> String {
    let word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let code = |c: char| format!("_x{:02x}_", u32::from(c));
    let mut out = String::with_capacity(name.len());
    for (at, c) in name.char_indices() {
        let rest = &name[at + c.len_utf8()..];
        let like_code = c == '_'
            && rest.strip_prefix('x').is_some_and(|rest| {
                let after = rest.trim_start_matches(|c| matches!(c, '0'..='9' | 'a'..='f'));
                let ends = after.starts_with('_') || after.starts_with(|c| !word(c));
                rest.len() - after.len() >= 2 && ends
            });
        if !word(c) || like_code || (at == 0 && c.is_ascii_digit()) {
            out.push_str(&code(c));
        } else {
            out.push(c);
        }
    }
    let may_be_reserved = !out.is_empty() && out.bytes().all(|b| b.is_ascii_lowercase());
    if may_be_reserved && !stands_as_name(&out) {
        let first = out.remove(0);
        out.insert_str(0, &code(first));
    }
    out
}

fn stands_as_name(word: &str) -> bool {
    use moldloft_syntax::sdl;
    if sdl::is_contextual(word) {
        return false;
    }
    let (program, expr, found) = sdl::parse_expr(word.to_string(), FileId(0));
    found.is_empty() && program.as_name(expr).is_some()
}

/// The name that became this identifier.
pub(crate) fn plain_name(identifier: &str) -> String {
    let mut out = String::with_capacity(identifier.len());
    let mut rest = identifier;
    while let Some(at) = rest.find("_x") {
        out.push_str(&rest[..at]);
        let digits = &rest[at + 2..];
        let length = digits.find(|c| !matches!(c, '0'..='9' | 'a'..='f')).unwrap_or(digits.len());
        let c = u32::from_str_radix(&digits[..length], 16).ok().and_then(char::from_u32);
        match c {
            Some(c) if length >= 2 && digits[length..].starts_with('_') => {
                out.push(c);
                rest = &digits[length + 1..];
            }
            _ => {
                out.push('_');
                rest = &rest[at + 1..];
            }
        }
    }
    out + rest
}

/// A number as model files spell it.
pub(crate) fn spelled(value: f64, unit: Unit) -> String {
    number::plain(if unit == Unit::Angle { degrees(value) } else { value })
}
