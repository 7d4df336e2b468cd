//! Why an object has no body, in words.

use super::CommandError;
use super::digits::place_text;
use super::subject::ReplySubject;
use crate::SketchObject;
use crate::solid::combine::CombineError;
use crate::solid::feature::{MAX_COPIES, NoBody};
use crate::solid::validity::SolidDefect;

/// The reason why an object has no body, with the position and a remedy.
pub fn no_body(object: &SketchObject, why: &NoBody) -> CommandError {
    let name = &object.name;
    match why {
        NoBody::Unfinished => CommandError::new(
            404,
            format!("{name} has no faces or is not fully dimensioned"),
            "CONVERT says what is missing; then GENERATE FACES",
        )
        .about(ReplySubject::of("no-faces").names([name])),
        NoBody::Flaw(SolidDefect::Open(edges)) => {
            let list: Vec<String> =
                edges.iter().take(12).map(|[p, q]| format!("{p}-{q}")).collect();
            CommandError::new(
                701,
                format!(
                    "{name} is open, so it has no volume: lines {} have a face on one side only",
                    list.join(", ")
                ),
                "GENERATE FACES finds all faces; or give the missing one with FACE",
            )
            .about(ReplySubject::of("open-body").points(edges.iter().flatten().copied()))
        }
        NoBody::Flaw(SolidDefect::Crossed { face, sides: [a, b], at }) => {
            let number = *face;
            let face = face.map_or_else(|| "a face".to_owned(), |f| format!("face {f}"));
            CommandError::new(
                701,
                format!(
                    "{name} crosses itself: in {face} the sides {}-{} and {}-{} cross at {}",
                    a[0],
                    a[1],
                    b[0],
                    b[1],
                    place_text(*at)
                ),
                "a dimension has moved lines past each other: UNDO, or change it",
            )
            .about(
                ReplySubject::of("crossed-body")
                    .faces(number)
                    .points([a[0], a[1], b[0], b[1]])
                    .place(*at),
            )
        }
        NoBody::Flaw(SolidDefect::Outside { face, hole }) => {
            let face = face.map_or_else(|| "a face".to_owned(), |f| format!("face {f}"));
            CommandError::new(
                701,
                format!("{name}: the hole of point {hole} is not inside of {face}"),
                "a dimension has moved it out: UNDO, change it, or GENERATE FACES",
            )
        }
        NoBody::Flaw(SolidDefect::Unresolved(e)) | NoBody::Combine(e) => combine_error(name, e),
        NoBody::Flaw(SolidDefect::NotFinite) => CommandError::new(
            300,
            format!("{name} has coordinates that are not finite, or beyond 1e60"),
            "CHECK the dimensions",
        )
        .about(ReplySubject::of("not-finite").names([name])),
        NoBody::Operand { name: inner, why, .. } => {
            let inner = no_body(&SketchObject::new(inner, None), why);
            let text = format!("{name}: {}", inner.text);
            CommandError { text, ..inner }
        }
        NoBody::Section { name: inner, wanted } => {
            let (is, next) = match wanted {
                true => {
                    ("no cross section now", "UNDO; or DELETE it, and the body keeps what it was")
                }
                false => ("a cross section", "EXTRUDE it"),
            };
            CommandError::text(format!("{name} is made of {inner}, which is {is}"), next)
                .about(ReplySubject::of("cross-section").names([name, inner]))
        }
        NoBody::NoValue(reads) => CommandError::text(
            format!("{name} reads {reads}, which has no value"),
            format!("VARIABLE {reads} defines it"),
        )
        .about(ReplySubject::of("no-value").names([name, reads])),
        NoBody::Copies(n) => CommandError::new(
            200,
            format!("{name} has {} copies", moldloft_syntax::number::plain(*n)),
            format!("give a whole number from 1 to {MAX_COPIES}"),
        )
        .about(ReplySubject::of("count").names([name]).value(*n)),
        NoBody::Treatment(fault) => {
            let place = fault.at.map(|p| format!(" at {}", place_text(p))).unwrap_or_default();
            let mut about = ReplySubject::of("treatment");
            about.place = fault.at.map(|p| p.to_array());
            let text = format!("{name}: {}{place}", fault.text);
            CommandError::new(701, text, fault.next.clone()).about(about)
        }
        NoBody::Axis => CommandError::new(
            701,
            format!("{name}: the section lies on both sides of the line it is turned about"),
            "change the dimension that moved it",
        )
        .about(ReplySubject::of("section-across-axis").names([name])),
    }
}

fn combine_error(name: &str, e: &CombineError) -> CommandError {
    match e {
        CombineError::Open(p) => CommandError::new(
            701,
            format!("{name}: surfaces do not close, or nearly coincide, at {}", place_text(*p)),
            "CHECK the bodies, or move one of them a little",
        )
        .about(ReplySubject::of("open-body").place(*p)),
        CombineError::Touching(p) => CommandError::new(
            701,
            format!("{name}: round surfaces touch, or nearly so, at {}", place_text(*p)),
            "let them cross clearly or stay apart",
        )
        .about(ReplySubject::of("touching-surfaces").place(*p)),
        CombineError::Coarse(places) => {
            let p = places.first().copied().unwrap_or_default();
            CommandError::new(
                701,
                format!(
                    "{name}: surfaces nearly meet at {}, too closely to tell which comes first",
                    place_text(p)
                ),
                "let them meet exactly, cross clearly or stay apart",
            )
            .about(ReplySubject::of("nearly-meeting-surfaces").place(p))
        }
        CombineError::Unbalanced(p) => CommandError::new(
            701,
            format!("{name}: its faces do not close to rounding near {}", place_text(*p)),
            "change a dimension there a little; CHECK the bodies that it is made of",
        )
        .about(ReplySubject::of("open-body").place(*p)),
        CombineError::AtFacets(_) => combine_error(name, e.cause()),
        CombineError::TooLarge => CommandError::new(
            200,
            format!("{name}: there are too many pieces"),
            "combine smaller objects",
        )
        .about(ReplySubject::of("too-many-pieces").names([&name.to_owned()])),
        CombineError::Empty => {
            CommandError::new(701, format!("{name}: nothing is left"), "CHECK the dimensions")
                .about(ReplySubject::of("nothing-left").names([&name.to_owned()]))
        }
    }
}
