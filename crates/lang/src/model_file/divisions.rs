//! The divisions of a model file's object: their forms, by class.

use moldloft_diag::Span;
use moldloft_registry::Class;
use moldloft_syntax::model_file::{EntryField as Written, FieldKind, NumberId};

/// A part of a head: its name, its numbers and their position.
pub(super) type Part = (&'static str, Vec<NumberId>, Span);

/// The divisions of an object of `class`, or the expected form.
pub(super) fn divisions(class: Class, fields: &[Written]) -> Result<Vec<Part>, &'static str> {
    let kinds: Vec<FieldKind> = fields.iter().map(|field| field.kind).collect();
    let span = |from: usize, to: usize| fields[from].span.to(fields[to].span);
    let two = |n: [NumberId; 2], m: [NumberId; 2], span| {
        vec![("divisions", n.to_vec(), span), ("subdivisions", m.to_vec(), span)]
    };
    match (class.dimension(), &kinds[..]) {
        (Some(1), [FieldKind::Number(n)]) => Ok(vec![("divisions", vec![*n], fields[0].span)]),
        (Some(1), [FieldKind::Pair(n, m)]) => Ok(vec![
            ("divisions", vec![*n], fields[0].span),
            ("subdivisions", vec![*m], fields[0].span),
        ]),
        (Some(1), _) => Err("divisions, such as 8x4 or 8"),
        (Some(2), [FieldKind::Pair(nu, mu), FieldKind::Pair(nv, mv), rest @ ..]) => {
            let mut parts = two([*nu, *nv], [*mu, *mv], span(0, 1));
            match rest {
                [] => Ok(parts),
                [FieldKind::Number(orientation)] => {
                    parts.push(("orientation", vec![*orientation], fields[2].span));
                    Ok(parts)
                }
                _ => Err("divisions and orientation, such as 8x1 8x1 0"),
            }
        }
        (
            Some(2),
            [
                FieldKind::Number(nu),
                FieldKind::Number(mu),
                FieldKind::Number(nv),
                FieldKind::Number(mv),
                FieldKind::Number(orientation),
            ],
        ) => {
            let mut parts = two([*nu, *nv], [*mu, *mv], span(0, 3));
            parts.push(("orientation", vec![*orientation], fields[4].span));
            Ok(parts)
        }
        (Some(2), _) => Err("divisions and orientation, such as 8x1 8x1 0 or 8 1 8 1 0"),
        (_, []) => Ok(Vec::new()),
        _ => Err("data after colour and visibility: there is nothing to divide"),
    }
}

/// True for two numbers such as 8x4.
pub(super) fn is_pair(field: &Written) -> bool {
    matches!(field.kind, FieldKind::Pair(..))
}
