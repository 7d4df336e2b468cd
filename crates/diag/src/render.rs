//! Printing for a terminal, without colours.

use crate::{Diagnostic, Label, Location, Sources};
use std::fmt::Write;

/// Tabs are printed as this many blanks, whatever their column, so that the marks stand under the text.
const TAB: &str = "    ";
/// Characters of a source line that are shown; of a longer line a piece around the place is shown.
const LINE_LIMIT: usize = 160;

/// The diagnostic as text with its source lines, ending with a line end.
///
/// A place that spans several lines is marked on its first line, up to that line's end, with a trailing `…`.
pub fn render(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "{}[{}]: {}", diagnostic.severity, diagnostic.id, diagnostic.message);

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

    let places: Vec<LabelPlace> = primary
        .iter()
        .map(|label| (label, '^'))
        .chain(diagnostic.secondary.iter().map(|label| (label, '-')))
        .filter_map(|(label, mark)| LabelPlace::find(label, mark, sources))
        .collect();
    let gutter = places.iter().map(|place| digits(place.start.line)).max().unwrap_or(1);

    let mut shown: Option<&LabelPlace> = None;
    for place in &places {
        let same_file = shown.is_some_and(|last| last.label.span.file == place.label.span.file);
        if !same_file {
            let arrow = if shown.is_none() { "-->" } else { ":::" };
            let (name, at) = (place.name, place.start);
            let _ = writeln!(out, "{:gutter$}{arrow} {name}:{}:{}", "", at.line, at.column);
        }
        let same_line = same_file
            && shown.is_some_and(|last| last.start.line == place.start.line && !last.clipped);
        place.print(&mut out, gutter, same_line);
        shown = Some(place);
    }

    if let (Some(text), false) = (&expectation, said) {
        let _ = writeln!(out, "note: {text}");
    }
    if places.is_empty() && diagnostic.object.is_some() {
        let _ =
            writeln!(out, "note: this is about `{}`", diagnostic.object.as_deref().unwrap_or(""));
    }
    for text in &diagnostic.notes {
        let _ = writeln!(out, "note: {text}");
    }
    for text in &diagnostic.help {
        let _ = writeln!(out, "help: {text}");
    }
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

fn digits(line: u32) -> usize {
    line.checked_ilog10().unwrap_or(0) as usize + 1
}

struct LabelPlace<'a> {
    label: &'a Label,
    mark: char,
    name: &'a str,
    line: &'a str,
    start: Location,
    end: Location,
    clipped: bool,
}

impl<'a> LabelPlace<'a> {
    fn find(label: &'a Label, mark: char, sources: &'a Sources) -> Option<LabelPlace<'a>> {
        let span = label.span;
        let start = sources.locate(span.file, span.start)?;
        let end = sources.locate(span.file, span.end.max(span.start))?;
        let line = sources.line(span.file, start.line)?;
        let clipped = line.chars().count() > LINE_LIMIT;
        Some(LabelPlace { label, mark, name: sources.name(span.file)?, line, start, end, clipped })
    }

    fn print(&self, out: &mut String, gutter: usize, line_is_shown: bool) {
        let first = self.start.column as usize - 1;
        let line_chars = self.line.chars().count();
        let last = if self.end.line == self.start.line {
            self.end.column as usize - 1
        } else {
            line_chars
        };

        // The piece of the line that is shown, in characters.
        let from = if self.clipped { first.saturating_sub(LINE_LIMIT / 4) } else { 0 };
        let to = if self.clipped { (from + LINE_LIMIT).min(line_chars) } else { line_chars };

        let mut text = String::new();
        let mut before_mark = 0;
        let mut marks = 0;
        if from > 0 {
            text.push('…');
            before_mark += 1;
        }
        for (at, c) in self.line.chars().enumerate().skip(from).take(to - from) {
            let width = if c == '\t' { TAB.len() } else { 1 };
            match c {
                '\t' => text.push_str(TAB),
                // Control characters would move the cursor or be invisible.
                c if c.is_control() => text.push('\u{fffd}'),
                c => text.push(c),
            }
            if at < first {
                before_mark += width;
            } else if at < last {
                marks += width;
            }
        }
        if to < line_chars {
            text.push('…');
        }
        if !line_is_shown {
            let shown = format!("{:>gutter$} | {text}", self.start.line);
            let _ = writeln!(out, "{}", shown.trim_end());
        }
        let underline: String = std::iter::repeat_n(self.mark, marks.max(1)).collect();
        let more = if self.end.line > self.start.line || last > to { "…" } else { "" };
        let marked =
            format!("{:gutter$} | {:before_mark$}{underline}{more} {}", "", "", self.label.text);
        let _ = writeln!(out, "{}", marked.trim_end());
    }
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
14 | bead b1 = on(hull, 0.5)
   |              ^^^^ expected a curve, found a surface
 9 | surface hull = loft(m1, m2, m3)
   |         ---- `hull` is defined here
help: for a point on a surface write `magnet b1 = on(hull, 0.5, v)`
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
1 |     é = |x;
  |         ^^^…
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
1 | x = y + z;
  |     ^ curve[60]
  |         - curve[59]
 ::: b.sdl:1:7
1 | float y;
  |       - declared here
note: expected equal shapes
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
        let at = lines[2].chars().position(|c| c == '@').unwrap();
        assert_eq!(lines[3].chars().nth(at), Some('^'));

        let bare = Diagnostic::error("no-file", "no such file").object("hull").help("look again");
        assert_eq!(
            render(&bare, &sources),
            "error[no-file]: no such file\nnote: this is about `hull`\nhelp: look again\n"
        );
        let past = Diagnostic::error("odd", "past the end").at(Span::new(file, 99_999, 100_000));
        assert!(render(&past, &sources).contains("long.sdl:1:10002"));
    }
}
