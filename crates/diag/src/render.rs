//! Printing for a terminal, without colours: the layout, folding and widths of characters are those of `annotate-snippets`.

use crate::{Diagnostic, FileId, Label, Severity, Sources};
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Renderer, Snippet};
use std::fmt::Write;
use std::ops::Range;

/// Columns of a printed line; of a longer source line the piece around the marks is shown.
const WIDTH: usize = 140;
/// A span of more lines than this is marked on its first line alone.
const MOST_LINES: u32 = 8;

/// The diagnostic as text with its source lines, ending with a line end.
///
/// A span of several lines is marked from its first to its last; one of more than eight lines on
/// its first alone.
pub fn render(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let expectation = diagnostic.expectation();
    let primary = diagnostic.primary.as_ref().map(|label| {
        let text = if label.text.is_empty() {
            expectation.clone().unwrap_or_default()
        } else {
            label.text.clone()
        };
        Label { span: label.span, text }
    });
    let said = primary.as_ref().is_some_and(|label| Some(&label.text) == expectation.as_ref());

    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let mut group =
        Group::with_title(level.primary_title(&*diagnostic.message).id(&*diagnostic.id));

    let places: Vec<MarkedPlace> = primary
        .iter()
        .map(|label| (label, AnnotationKind::Primary))
        .chain(diagnostic.secondary.iter().map(|label| (label, AnnotationKind::Context)))
        .filter_map(|(label, kind)| MarkedPlace::find(label, kind, sources))
        .collect();
    let mut left: Vec<&MarkedPlace> = places.iter().collect();
    while let Some(first) = left.first() {
        let file = first.file;
        let (of_file, others): (Vec<&MarkedPlace>, Vec<&MarkedPlace>) =
            left.into_iter().partition(|place| place.file == file);
        left = others;
        if let Some(snippet) = snippet(&of_file, sources) {
            group = group.element(snippet);
        }
    }

    let mut below: Vec<(Level, String)> = Vec::new();
    if let (Some(text), false) = (expectation, said) {
        below.push((Level::NOTE, text));
    }
    if let (true, Some(object)) = (places.is_empty(), &diagnostic.object) {
        below.push((Level::NOTE, format!("this is about `{object}`")));
    }
    below.extend(diagnostic.notes.iter().map(|text| (Level::NOTE, text.clone())));
    below.extend(diagnostic.help.iter().map(|text| (Level::HELP, text.clone())));
    if places.is_empty() {
        // Without a source there is no margin to attach them to.
        let mut out = Renderer::plain().render(&[group]) + "\n";
        for (level, text) in below {
            let word = if level == Level::HELP { "help" } else { "note" };
            let _ = writeln!(out, "{word}: {}", clean(&text));
        }
        return out;
    }
    for (level, text) in below {
        group = group.element(level.message(clean(&text)));
    }
    let mut out = Renderer::plain().term_width(WIDTH).render(&[group]);
    // Lines carry no blanks at their ends.
    out = out.lines().map(str::trim_end).collect::<Vec<_>>().join("\n");
    out.push('\n');
    out
}

/// Several diagnostics, an empty line between them.
pub fn render_all<'a>(
    diagnostics: impl IntoIterator<Item = &'a Diagnostic>,
    sources: &Sources,
) -> String {
    let texts: Vec<String> =
        diagnostics.into_iter().map(|diagnostic| render(diagnostic, sources)).collect();
    texts.join("\n")
}

/// A label whose span exists.
struct MarkedPlace<'a> {
    label: &'a Label,
    kind: AnnotationKind,
    file: FileId,
    /// Bytes of the text, on the boundaries of characters.
    bytes: Range<usize>,
    /// First and last line, from 1.
    lines: [u32; 2],
}

impl<'a> MarkedPlace<'a> {
    fn find(label: &'a Label, kind: AnnotationKind, sources: &Sources) -> Option<MarkedPlace<'a>> {
        let span = label.span;
        let text = sources.text(span.file)?;
        let start = boundary(text, span.start as usize);
        let mut end = boundary(text, (span.end as usize).max(start));
        let first = sources.locate(span.file, start as u32)?.line;
        let mut last = sources.locate(span.file, end as u32)?.line;
        if last - first >= MOST_LINES {
            last = first;
            end = start + text[start..].find(['\r', '\n']).unwrap_or(text.len() - start);
        }
        Some(MarkedPlace { label, kind, file: span.file, bytes: start..end, lines: [first, last] })
    }
}

/// A text without control characters (except line ends) and changes of writing direction.
fn clean(text: &str) -> String {
    let turns = |c| matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let shown = |c: char| if (c.is_control() && c != '\n') || turns(c) { '\u{fffd}' } else { c };
    text.chars().map(shown).collect()
}

/// The last boundary between characters that is not after `at`.
fn boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// The lines of one file with their marks; only these lines are handed on, however long the file is.
fn snippet<'a>(
    places: &[&'a MarkedPlace],
    sources: &'a Sources,
) -> Option<Snippet<'a, Annotation<'a>>> {
    let file = places.first()?.file;
    let text: &str = sources.text(file)?;
    let from_line = places.iter().map(|place| place.lines[0]).min()?;
    let start = text[..places.iter().map(|place| place.bytes.start).min()?]
        .rfind('\n')
        .map_or(0, |at| at + 1);
    let last = places.iter().map(|place| place.bytes.end).max()?;
    let end = last + text[last..].find('\n').unwrap_or(text.len() - last);
    let end = if text[last..end].ends_with('\r') { end - 1 } else { end };
    let mut snippet = Snippet::source(&text[start..end])
        .line_start(from_line as usize)
        .path(sources.name(file)?)
        .fold(true);
    for place in places {
        let within = place.bytes.start - start..place.bytes.end - start;
        let words = clean(&place.label.text).replace('\n', " ");
        let words = Some(words).filter(|words| !words.is_empty());
        snippet = snippet.annotation(place.kind.span(within).label(words));
    }
    Some(snippet)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FileId, Span};

    fn span_of(sources: &Sources, file: FileId, piece: &str) -> Span {
        let at = sources.text(file).unwrap().find(piece).unwrap() as u32;
        Span::new(file, at, at + piece.len() as u32)
    }

    #[test]
    fn looks_like_the_illustration() {
        let mut text = "\n".repeat(8);
        text.push_str("surface hull = loft(m1, m2, m3)\n\n\n\n\nbead b1 = on(hull, 0.5)\n");
        let mut sources = Sources::new();
        let file = sources.add("boat.srf", text);
        let defined = span_of(&sources, file, "hull =");
        let used = span_of(&sources, file, "hull, 0.5");
        let d = Diagnostic::error("wrong-parent", "a bead needs a curve, but `hull` is a surface")
            .at(Span { end: used.start + 4, ..used })
            .note_at(Span { end: defined.start + 4, ..defined }, "`hull` is defined here")
            .expected("a curve")
            .found("a surface")
            .help("for a point on a surface write `magnet b1 = on(hull, 0.5, v)`");
        assert_eq!(
            render(&d, &sources),
            "\
error[wrong-parent]: a bead needs a curve, but `hull` is a surface
  --> boat.srf:14:14
   |
 9 | surface hull = loft(m1, m2, m3)
   |         ---- `hull` is defined here
...
14 | bead b1 = on(hull, 0.5)
   |              ^^^^ expected a curve, found a surface
   |
   = help: for a point on a surface write `magnet b1 = on(hull, 0.5, v)`
"
        );
    }

    #[test]
    fn tabs_crlf_characters_and_long_spans() {
        let mut sources = Sources::new();
        let file = sources.add("t.sdl", "\té = |x;\r\nnext\r\n");
        let d = Diagnostic::error("open-magnitude", "this magnitude is never closed")
            .at(Span::new(file, 6, 12));
        assert_eq!(
            render(&d, &sources),
            "\
error[open-magnitude]: this magnitude is never closed
 --> t.sdl:1:6
  |
1 |       é = |x;
  |  _________^
2 | | next
  | |_^
"
        );
    }

    #[test]
    fn two_labels_on_a_line_and_another_file() {
        let mut sources = Sources::new();
        let a = sources.add("a.sdl", "x = y + z;");
        let b = sources.add("b.sdl", "float y;");
        let d = Diagnostic::warning("shapes-differ", "shapes differ")
            .labelled(Span::new(a, 4, 5), "curve[60]")
            .note_at(Span::new(a, 8, 9), "curve[59]")
            .note_at(Span::new(b, 6, 7), "declared here")
            .expected("equal shapes");
        assert_eq!(
            render(&d, &sources),
            "\
warning[shapes-differ]: shapes differ
 --> a.sdl:1:5
  |
1 | x = y + z;
  |     ^   - curve[59]
  |     |
  |     curve[60]
  |
 ::: b.sdl:1:7
  |
1 | float y;
  |       - declared here
  |
  = note: expected equal shapes
"
        );
    }

    #[test]
    fn long_lines_are_cut_and_no_place_is_fine() {
        let mut sources = Sources::new();
        let file = sources.add("long.sdl", format!("{}@{}", "a".repeat(5000), "b".repeat(5000)));
        let d = Diagnostic::error("odd", "odd character").at(Span::new(file, 5000, 5001));
        let text = render(&d, &sources);
        assert!(text.lines().all(|line| line.chars().count() < 200), "{text}");
        let lines: Vec<&str> = text.lines().collect();
        let shown = lines.iter().position(|line| line.contains('@')).unwrap();
        let at = lines[shown].chars().position(|c| c == '@').unwrap();
        assert_eq!(lines[shown + 1].chars().nth(at), Some('^'));

        let bare = Diagnostic::error("no-file", "no such file").object("hull").help("look again");
        assert_eq!(
            render(&bare, &sources),
            "error[no-file]: no such file\nnote: this is about `hull`\nhelp: look again\n"
        );
        let past = Diagnostic::error("odd", "past the end").at(Span::new(file, 99_999, 100_000));
        assert!(render(&past, &sources).contains("long.sdl:1:10002"));
    }

    #[test]
    fn marks_stand_under_wide_characters() {
        let mut sources = Sources::new();
        let file = sources.add("t.sdl", "# 船体 x\n船 = y;");
        let d = Diagnostic::error("odd", "odd").at(Span::new(file, 9, 10));
        let text = render(&d, &sources);
        // Two columns for each of the two characters.
        assert!(text.contains("1 | # 船体 x\n  |        ^\n"), "{text}");
    }

    #[test]
    fn a_place_of_many_lines_is_marked_on_its_first() {
        let mut sources = Sources::new();
        let file = sources.add("t.sdl", "line\n".repeat(20_000));
        let d = Diagnostic::error("odd", "odd").at(Span::new(file, 10, 90_000));
        assert_eq!(
            render(&d, &sources),
            "error[odd]: odd\n --> t.sdl:3:1\n  |\n3 | line\n  | ^^^^\n"
        );
    }

    /// Any spans in any text: marks within the text or past it, inside characters, at line ends.
    #[test]
    fn any_place_can_be_printed() {
        let pieces = [
            "a",
            "\t",
            "\n",
            "\r\n",
            "\r",
            "é",
            "船",
            "\u{1b}[31m",
            "\u{202e}",
            "e\u{301}",
            "",
            " ",
            "\0",
        ];
        let mut state = 1_u64;
        let mut below = |n: usize| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % n
        };
        for _ in 0..4000 {
            let text: String = (0..below(30)).map(|_| pieces[below(pieces.len())]).collect();
            let mut sources = Sources::new();
            let files = [sources.add("a", text.clone()), sources.add("b", text.clone())];
            let mut span = || {
                let start = below(text.len() + 3) as u32;
                Span::new(files[below(2)], start, start + below(12) as u32)
            };
            let d = Diagnostic::error("odd", text.clone())
                .labelled(span(), "first\nsecond")
                .note_at(span(), "")
                .note_at(span(), "here")
                .help(text.clone());
            let out = render(&d, &sources);
            assert!(out.starts_with("error[odd]:") && out.ends_with('\n'), "{out}");
            assert!(!out.contains(['\u{1b}', '\u{202e}', '\0']), "{out:?}");
        }
    }
}
