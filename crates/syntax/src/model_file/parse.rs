//! Text into objects.

use super::*;

const MAX_NESTING: usize = 200;
const MAX_DIAGNOSTICS: usize = 100;

/// Parses a model file. It never fails: errors are in the diagnostics, in the order of the text,
/// and parts with errors are kept unchanged.
pub fn parse(text: impl Into<Arc<str>>, file: FileId) -> (ModelFile, Vec<Diagnostic>) {
    let text: Arc<str> = text.into();
    let too_large = crate::decode::check_size(&text, file);
    let text = if too_large.is_some() { Arc::from("") } else { text };
    let model = ModelFile {
        text: text.clone(),
        file,
        version: None,
        first_line_rest: None,
        header: Vec::new(),
        header_comments: Vec::new(),
        begin: None,
        items: Vec::new(),
        end: None,
        trailer: None,
        fields: Vec::new(),
        numbers: Vec::new(),
        edited: Vec::new(),
    };
    let mut parser = ModelFileParser {
        text: &text,
        bytes: text.as_bytes(),
        file,
        at: 0,
        model,
        scratch: Vec::new(),
        diagnostics: Vec::new(),
        unlisted: 0,
        header_until: 0,
    };
    match too_large {
        Some(diagnostic) => parser.diagnostics.push(diagnostic),
        None => parser.run(),
    }
    if parser.unlisted > 0 {
        let message = format!("{} more faults are not listed", parser.unlisted);
        let at = Span::point(file, text.len() as u32);
        parser.diagnostics.push(Diagnostic::error("too-many-errors", message).at(at));
    }
    (parser.model, parser.diagnostics)
}

struct ModelFileParser<'a> {
    text: &'a str,
    bytes: &'a [u8],
    file: FileId,
    at: usize,
    model: ModelFile,
    /// Fields of the objects and lists under construction.
    scratch: Vec<EntryField>,
    diagnostics: Vec<Diagnostic>,
    unlisted: usize,
    /// Start of the next header line, if found.
    header_until: usize,
}

/// A list that is not closed yet.
struct OpenList {
    closer: u8,
    at: Span,
    /// The name of the argument that it is.
    argument: Option<Span>,
    /// Start of its fields in the scratch stack.
    base: usize,
}

impl<'a> ModelFileParser<'a> {
    fn run(&mut self) {
        if self.text.starts_with('\u{feff}') {
            self.at = '\u{feff}'.len_utf8();
        }
        self.header();
        while self.model.end.is_none() {
            let gap = self.skip_blanks();
            if self.at >= self.bytes.len() {
                break;
            }
            self.item(gap);
        }
        self.finish();
    }

    fn peek(&self) -> u8 {
        self.bytes.get(self.at).copied().unwrap_or(0)
    }

    fn span(&self, start: usize) -> Span {
        Span::new(self.file, start as u32, self.at as u32)
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        if self.diagnostics.len() < MAX_DIAGNOSTICS {
            self.diagnostics.push(diagnostic);
        } else {
            self.unlisted += 1;
        }
    }

    /// Skips blanks and line ends; whether there was an empty line.
    fn skip_blanks(&mut self) -> bool {
        let mut line_ends = 0;
        while self.peek().is_ascii_whitespace() {
            line_ends += usize::from(self.peek() == b'\n');
            self.at += 1;
        }
        line_ends > 1
    }

    fn skip_line_blanks(&mut self) {
        while matches!(self.peek(), b' ' | b'\t' | b'\r') {
            self.at += 1;
        }
    }

    /// The rest of the line without blanks around it.
    fn rest_of_line(&mut self) -> Span {
        self.skip_line_blanks();
        let start = self.at;
        let rest = &self.bytes[start..];
        self.at += rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
        let kept = self.text[start..self.at].trim_end().len();
        Span::new(self.file, start as u32, (start + kept) as u32)
    }

    /// The word that begins here, without taking it.
    fn word_ahead(&self) -> &'a str {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|byte| ends_word(*byte)).unwrap_or(rest.len());
        &self.text[self.at..self.at + length]
    }

    fn word(&mut self) -> Span {
        let start = self.at;
        self.at += self.word_ahead().len();
        self.span(start)
    }

    fn at_comment(&self) -> bool {
        self.peek() == b'#' || self.word_ahead().eq_ignore_ascii_case("rem")
    }

    fn header(&mut self) {
        self.header_blanks();
        if self.word_ahead().eq_ignore_ascii_case("MultiSurf") {
            self.word();
            self.skip_line_blanks();
            let version = self.word();
            if version.is_empty() {
                let diagnostic =
                    Diagnostic::error("not-a-model-file", "the version of the format is missing");
                self.report(diagnostic.at(version).expected("a number such as 0.35"));
            }
            self.model.version = Some(version);
            let rest = self.rest_of_line();
            self.model.first_line_rest = Some(rest).filter(|rest| !rest.is_empty());
        } else {
            let found: String = self.word_ahead().chars().take(30).collect();
            let found = if found.is_empty() {
                "nothing of the kind".to_owned()
            } else {
                format!("`{}`", found.escape_debug())
            };
            let start = self.at;
            let at = Span::new(self.file, start as u32, (start + self.word_ahead().len()) as u32);
            let message = "this is not a MultiSurf model file";
            let diagnostic = Diagnostic::error("not-a-model-file", message).at(at);
            self.report(diagnostic.expected("`MultiSurf` and a version").found(found));
        }
        loop {
            self.header_blanks();
            let word = self.word_ahead();
            if word.eq_ignore_ascii_case("BeginModel") {
                self.model.begin = Some(self.word());
                self.optional_semicolon();
                return;
            }
            if self.at_comment() || !(word.len() > 1 && word.ends_with(':')) {
                return;
            }
            let mut key = self.word();
            key.end -= 1;
            let rest = self.rest_of_line();
            self.model.header.push(HeaderLine { key, rest });
        }
    }

    /// Skips blanks, and comments as long as the version or `BeginModel` may still follow.
    fn header_blanks(&mut self) {
        loop {
            let before = self.at;
            self.skip_blanks();
            if self.at >= self.bytes.len() || !self.at_comment() || !self.header_goes_on() {
                // The gap belongs to the item that follows.
                if self.at_comment() || self.model.version.is_some() {
                    let ahead = self.word_ahead();
                    let more = ahead.ends_with(':') || ahead.eq_ignore_ascii_case("BeginModel");
                    // A comment such as `#note:` is no line of the header.
                    self.at = if more && !self.at_comment() { self.at } else { before };
                }
                return;
            }
            let comment = self.rest_of_line();
            self.model.header_comments.push(comment);
        }
    }

    /// True if a header line, the first line or `BeginModel` follows the comments at this position.
    fn header_goes_on(&mut self) -> bool {
        if self.at < self.header_until {
            return true;
        }
        let mut start = self.at;
        for raw in self.text[self.at..].split_inclusive('\n') {
            let line = raw.trim();
            let word =
                line.split(|c: char| c.is_ascii_whitespace() || c == ';').next().unwrap_or("");
            let is_comment = line.starts_with('#') || word.eq_ignore_ascii_case("rem");
            if !(line.is_empty() || is_comment) {
                let goes_on = (word.len() > 1 && word.ends_with(':'))
                    || word.eq_ignore_ascii_case("BeginModel")
                    || (self.model.version.is_none() && word.eq_ignore_ascii_case("MultiSurf"));
                if goes_on {
                    self.header_until = start;
                }
                return goes_on;
            }
            start += raw.len();
        }
        false
    }

    fn optional_semicolon(&mut self) {
        let before = self.at;
        self.skip_blanks();
        if self.peek() == b';' {
            self.at += 1;
        } else {
            self.at = before;
        }
    }

    fn push_item(&mut self, kind: ItemKind, span: Span, after_gap: bool) {
        self.model.items.push(Item { kind, span, after_gap });
    }

    fn item(&mut self, after_gap: bool) {
        let start = self.at;
        if self.at_comment() {
            let span = self.rest_of_line();
            return self.push_item(ItemKind::Comment, span, after_gap);
        }
        if self.peek() == b';' {
            self.at += 1;
            return;
        }
        let word = self.word_ahead();
        if word.eq_ignore_ascii_case("EndModel") {
            self.model.end = Some(self.word());
            self.optional_semicolon();
            return;
        }
        // Some entities begin with a count: 3PtPlane.
        let counted = matches!(word.as_bytes(), [n, a, b, ..]
            if n.is_ascii_digit() && a.is_ascii_uppercase() && b.is_ascii_lowercase());
        let named = (counted || word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_'))
            && word.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
        if !named || word.eq_ignore_ascii_case("BeginModel") {
            return self.unknown(start, after_gap);
        }
        self.object(start, after_gap);
    }

    /// Reads an unknown item, up to its `;` or to the end of its line.
    fn unknown(&mut self, start: usize, after_gap: bool) {
        let rest = &self.bytes[start..];
        let length = rest.iter().position(|byte| matches!(byte, b';' | b'\n'));
        self.at = start + length.unwrap_or(rest.len());
        let span = Span {
            end: start as u32 + self.text[start..self.at].trim_end().len() as u32,
            ..self.span(start)
        };
        let shown: String = self.text[span.range()].chars().take(30).collect();
        let diagnostic =
            Diagnostic::error("unexpected-token", "this is neither an object nor a comment")
                .at(span)
                .expected("an entity word, such as `AbsPoint`")
                .found(format!("`{}`", shown.escape_debug()));
        self.report(diagnostic);
        if self.peek() == b';' {
            self.at += 1;
        }
        let end = self.at as u32;
        self.push_item(ItemKind::Unknown, Span { end: end.max(span.end), ..span }, after_gap);
    }

    fn object(&mut self, start: usize, after_gap: bool) {
        let entity = self.word();
        self.skip_blanks();
        let name = if self.object_starts_here() {
            Span::point(self.file, self.at as u32)
        } else {
            self.word()
        };
        let mut complete = true;
        if name.is_empty() {
            complete = false;
            if self.at < self.bytes.len() {
                let message = format!("this `{}` has no name", self.text_of(entity));
                self.report(
                    Diagnostic::error("missing-name", message).at(entity).expected("a name"),
                );
            }
        }
        let base = self.scratch.len();
        let mut open: Vec<OpenList> = Vec::new();
        let ended = loop {
            let before = self.at;
            self.skip_blanks();
            if self.at >= self.bytes.len() {
                self.at = before;
                break ObjectEnd::Text;
            }
            if self.peek() == b';' {
                break ObjectEnd::Semicolon;
            }
            if self.object_starts_here() {
                self.at = before;
                break ObjectEnd::NextObject;
            }
            complete &= self.field(&mut open);
        };
        let span = self.span(start);
        complete &= matches!(ended, ObjectEnd::Semicolon);
        match ended {
            ObjectEnd::Text => self.truncated(entity, name, &open),
            ObjectEnd::NextObject => {
                let place = Span::point(self.file, self.at as u32);
                let message = format!("`;` is missing after `{}`", self.text_of(name));
                let diagnostic = Diagnostic::error("missing-semicolon", message)
                    .at(place)
                    .expected("`;`")
                    .edit(place, ";", "insert `;`");
                self.report(diagnostic.note_at(entity, "the object begins here"));
            }
            ObjectEnd::Semicolon => self.at += 1,
        }
        while let Some(list) = open.pop() {
            if matches!(ended, ObjectEnd::Semicolon) {
                complete = false;
                let diagnostic = Diagnostic::error("unclosed-bracket", "this list is not closed")
                    .at(list.at)
                    .expected(format!("`{}`", char::from(list.closer)))
                    .found("`;`");
                self.report(diagnostic);
            }
            self.close(&list, span.end);
        }
        let fields = self.take_fields(base);
        let span = if matches!(ended, ObjectEnd::Semicolon) { self.span(start) } else { span };
        let object = ObjectEntry { entity, name, fields, span, complete };
        self.push_item(ItemKind::Object(object), span, after_gap);
    }

    fn text_of(&self, span: Span) -> &'a str {
        &self.text[span.range()]
    }

    fn truncated(&mut self, entity: Span, name: Span, open: &[OpenList]) {
        let what = if name.is_empty() {
            format!("this `{}`", self.text_of(entity))
        } else {
            format!("`{} {}`", self.text_of(entity), self.text_of(name))
        };
        let expected = match open.last() {
            Some(list) => format!("`{}` and `;`", char::from(list.closer)),
            None => "`;`".to_owned(),
        };
        let diagnostic =
            Diagnostic::error("truncated-file", format!("the file ends inside {what}"))
                .at(Span::point(self.file, self.at as u32))
                .note_at(entity, "the object begins here")
                .expected(expected)
                .found("the end of the file")
                .object(self.text_of(name));
        self.report(diagnostic.help("the file may have been cut off when it was copied or saved"));
    }

    /// True if an unindented line begins here that looks like `Entity name colour visible`, or
    /// `EndModel`.
    fn object_starts_here(&self) -> bool {
        let line_start = self.at > 0 && self.bytes[self.at - 1] == b'\n';
        if !line_start || !self.peek().is_ascii_alphabetic() {
            return false;
        }
        let rest = &self.text[self.at..];
        let line = &rest[..rest.find('\n').unwrap_or(rest.len())];
        let mut words = line.split_ascii_whitespace();
        let first = words.next().unwrap_or("");
        if first.trim_end_matches(';').eq_ignore_ascii_case("EndModel") {
            return true;
        }
        let named =
            words.next().is_some_and(|word| word.starts_with(|c: char| c.is_ascii_alphabetic()));
        let mut is_int =
            || words.next().is_some_and(|word| word.bytes().all(|b| b.is_ascii_digit()));
        named && is_int() && is_int()
    }

    /// Takes one field, or the end of a list; whether it was sound.
    fn field(&mut self, open: &mut Vec<OpenList>) -> bool {
        let start = self.at;
        let byte = self.peek();
        let closer = match byte {
            b'{' => b'}',
            b'(' => b')',
            b'}' | b')' => return self.close_list(open, byte),
            b'"' => return self.delimited(b'"', FieldKind::Text),
            b'[' => return self.delimited(b']', FieldKind::Formula),
            b'#' => {
                let span = self.rest_of_line();
                self.push_item(ItemKind::Comment, span, false);
                return true;
            }
            _ => return self.plain_field(start, open),
        };
        self.at += 1;
        let at = self.span(start);
        self.open_list(open, OpenList { closer, at, argument: None, base: self.scratch.len() })
    }

    fn open_list(&mut self, open: &mut Vec<OpenList>, list: OpenList) -> bool {
        if open.len() >= MAX_NESTING {
            let diagnostic =
                Diagnostic::error("nesting-too-deep", "lists are nested too deep").at(list.at);
            self.report(diagnostic.expected(format!("at most {MAX_NESTING} levels")));
            // The rest of this object is skipped.
            let rest = &self.bytes[self.at..];
            self.at += rest.iter().position(|byte| *byte == b';').unwrap_or(rest.len());
            return false;
        }
        open.push(list);
        true
    }

    fn close_list(&mut self, open: &mut Vec<OpenList>, byte: u8) -> bool {
        let start = self.at;
        self.at += 1;
        let matches = open.last().is_some_and(|list| list.closer == byte);
        if !matches {
            let message = format!("unmatched `{}`", char::from(byte));
            let mut diagnostic =
                Diagnostic::error("unexpected-token", message).at(self.span(start));
            if let Some(list) = open.last() {
                diagnostic = diagnostic.note_at(list.at, "this list is open");
            }
            self.report(diagnostic);
            return false;
        }
        if let Some(list) = open.pop() {
            let end = self.at as u32;
            self.close(&list, end);
        }
        true
    }

    fn close(&mut self, list: &OpenList, end: u32) {
        let fields = self.take_fields(list.base);
        let kind = match list.argument {
            Some(name) => FieldKind::Argument { name, value: fields },
            None if list.closer == b'}' => FieldKind::List(fields),
            None => FieldKind::Tuple(fields),
        };
        self.scratch.push(EntryField { kind, span: Span { end: end.max(list.at.end), ..list.at } });
    }

    fn take_fields(&mut self, base: usize) -> Fields {
        let start = self.model.fields.len() as u32;
        let count = (self.scratch.len() - base) as u32;
        self.model.fields.extend_from_slice(&self.scratch[base..]);
        self.scratch.truncate(base);
        Fields { start, count }
    }

    /// A text or formula up to its closing character, on one line.
    fn delimited(&mut self, closer: u8, kind: FieldKind) -> bool {
        let start = self.at;
        let rest = &self.bytes[start + 1..];
        let length =
            rest.iter().position(|byte| *byte == closer || *byte == b'\n').unwrap_or(rest.len());
        let closed = rest.get(length) == Some(&closer);
        self.at = start + 1 + length + usize::from(closed);
        if !closed {
            let message = format!("this is not closed by `{}` on its line", char::from(closer));
            self.report(Diagnostic::error("unclosed-string", message).at(self.span(start)));
        }
        let span = self.span(start);
        self.scratch.push(EntryField { kind, span });
        closed
    }

    fn plain_field(&mut self, start: usize, open: &mut Vec<OpenList>) -> bool {
        let span = self.word();
        let word = self.text_of(span);
        let mut sound = true;
        let kind = if word == "/" {
            FieldKind::Slash
        } else if word.starts_with('*') {
            FieldKind::Star
        } else if word.starts_with('=') && word.len() > 1 {
            FieldKind::Formula
        } else if word == ARGUMENT && self.peek() == b'(' {
            self.at += 1;
            self.skip_line_blanks();
            let at = self.span(start);
            let argument = Some(self.word());
            let list = OpenList { closer: b')', at, argument, base: self.scratch.len() };
            return self.open_list(open, list);
        } else if word.starts_with("A:") && self.peek() == b'(' {
            return self.attribute(start, span);
        } else if let Some(pair) = self.pair(span, word) {
            pair
        } else {
            match read_number(word) {
                Some(value) if value.is_finite() => {
                    FieldKind::Number(self.push_number(value, span))
                }
                Some(_) => {
                    let message = "this number is too large for a double";
                    let diagnostic = Diagnostic::error("bad-number", message).at(span);
                    self.report(diagnostic.expected("at most 1.797e308"));
                    sound = false;
                    FieldKind::Word
                }
                None => {
                    sound = self.check_word(word, span);
                    FieldKind::Word
                }
            }
        };
        self.scratch.push(EntryField { kind, span });
        sound
    }

    fn check_word(&mut self, word: &str, span: Span) -> bool {
        let odd = word.chars().find(|c| c.is_control());
        if let Some(odd) = odd {
            let message = format!("`{}` is not a valid character", odd.escape_debug());
            self.report(Diagnostic::error("bad-character", message).at(span));
        }
        odd.is_none()
    }

    fn attribute(&mut self, start: usize, word: Span) -> bool {
        let value_start = self.at + 1;
        let closed = self.skip_to_closing_parenthesis();
        let value_end = if closed { self.at - 1 } else { self.at };
        let name = Span { start: word.start + 2, ..word };
        let value = Span::new(self.file, value_start as u32, value_end.max(value_start) as u32);
        let span = self.span(start);
        if !closed {
            let diagnostic =
                Diagnostic::error("unclosed-bracket", "this attribute is not closed").at(span);
            self.report(diagnostic.expected("`)`"));
        }
        self.scratch.push(EntryField { kind: FieldKind::Attribute { name, value }, span });
        closed
    }

    /// Skips from `(` to after its `)` on the same line; inner parentheses are counted.
    fn skip_to_closing_parenthesis(&mut self) -> bool {
        let mut depth = 0;
        while self.at < self.bytes.len() && self.peek() != b'\n' {
            match self.peek() {
                b'(' => depth += 1,
                b')' => depth -= 1,
                _ => {}
            }
            self.at += 1;
            if depth == 0 {
                return true;
            }
        }
        false
    }

    fn push_number(&mut self, value: f64, span: Span) -> NumberId {
        let is_int =
            self.text_of(span).bytes().all(|b| b.is_ascii_digit() || b == b'-' || b == b'+');
        let id = NumberId(self.model.numbers.len() as u32);
        self.model.numbers.push(Number { value, is_int, span, edited: false });
        id
    }

    /// `8x4`.
    fn pair(&mut self, span: Span, word: &str) -> Option<FieldKind> {
        let (n, m) = word.split_once('x')?;
        let digits = |text: &str| {
            !text.is_empty() && text.len() < 10 && text.bytes().all(|b| b.is_ascii_digit())
        };
        if !digits(n) || !digits(m) {
            return None;
        }
        let middle = span.start + n.len() as u32;
        let first = self.push_number(n.parse().ok()?, Span { end: middle, ..span });
        let second = self.push_number(m.parse().ok()?, Span { start: middle + 1, ..span });
        Some(FieldKind::Pair(first, second))
    }

    fn finish(&mut self) {
        if self.model.end.is_some() {
            self.skip_blanks();
            let start = self.at;
            self.at = self.bytes.len();
            let kept = self.text[start..].trim_end().len();
            if kept > 0 {
                let span = Span::new(self.file, start as u32, (start + kept) as u32);
                self.model.trailer = Some(span);
                let first_line = self.text[start..].lines().next().map_or(0, str::len) as u32;
                let place = Span { end: span.start + first_line, ..span };
                let message = "text after `EndModel` is not part of the model";
                self.report(Diagnostic::warning("text-after-end", message).at(place));
            }
        } else if !self
            .diagnostics
            .iter()
            .any(|d| matches!(&*d.id, "truncated-file" | "not-a-model-file"))
        {
            let diagnostic = Diagnostic::warning("missing-end", "the file ends without `EndModel`")
                .at(Span::point(self.file, self.text.trim_end().len() as u32))
                .expected("`EndModel;`")
                .found("the end of the file")
                .help("if objects are missing, the file was cut off");
            self.report(diagnostic);
        }
    }
}

enum ObjectEnd {
    Semicolon,
    NextObject,
    Text,
}

fn ends_word(byte: u8) -> bool {
    byte.is_ascii_whitespace() || matches!(byte, b';' | b'{' | b'}' | b'(' | b')' | b'"')
}

/// A number as model files spell it; infinite if it is too large.
fn read_number(word: &str) -> Option<f64> {
    let plausible =
        word.bytes().all(|b| matches!(b, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E'));
    let has_digit = word.bytes().any(|b| b.is_ascii_digit());
    if plausible && has_digit { word.parse().ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(text: &str) -> Vec<String> {
        let (_, diagnostics) = parse(text, FileId(0));
        diagnostics.iter().map(|d| format!("{}@{}", d.id, d.span().start)).collect()
    }

    #[test]
    fn both_versions() {
        let old = "MultiSurf 0.35 /y\nRem a hull\nAbsPoint P 14 1 0.000 .5 3.;\nBCurve C 11 1 10 * 2 { P Q };\n\nEndModel";
        let (model, faults) = parse(old, FileId(0));
        assert!(faults.is_empty(), "{faults:#?}");
        assert_eq!(
            model.to_canonical(|_| false),
            "MultiSurf 0.35 /y\nRem a hull\nAbsPoint P 14 1 0 0.5 3;\nBCurve C 11 1 10 * 2 { P Q };\nEndModel;\n"
        );
        let new = "MultiSurf 1.44\n# made by hand\nUnits: m kg\nSymmetry: x y\nPlaces: 3\nBeginModel;\n\
            CLoftSurf hull 2 1 36x4 12x4\n  A:Layer(3) A:Note(a (b) c)\n  / * 3 { MC1\n  MC2 } =beam [2*b] *X=0 (P 1.5);\n\
            Variable b 3 1 5;\nEndModel;\n";
        let (model, faults) = parse(new, FileId(0));
        assert!(faults.is_empty(), "{faults:#?}");
        assert_eq!((model.symmetry(), model.header_value("Units")), ("xy".into(), Some("m kg")));
        let hull = model.objects().next().unwrap();
        assert_eq!(
            model.attributes(&hull).collect::<Vec<_>>(),
            [("Layer", "3"), ("Note", "a (b) c")]
        );
        let canonical = "MultiSurf 1.44\n# made by hand\nUnits: m kg\nSymmetry: x y\nPlaces: 3\nBeginModel;\n\
            CLoftSurf hull 2 1 36x4 12x4 A:Layer(3) A:Note(a (b) c) / * 3 { MC1 MC2 } =beam [2*b] *X=0 ( P 1.5 );\n\
            Variable b 3 1 5;\nEndModel;\n";
        assert_eq!(model.to_canonical(|_| false), canonical);
        assert_eq!(parse(canonical, FileId(0)).0.to_canonical(|_| false), canonical);
        assert!(model.to_canonical(|_| true).contains("36x4 12x4\n  A:Layer(3)"));
    }

    #[test]
    fn faults() {
        let head = "MultiSurf 0.35\n";
        let cases = [
            ("AbsPoint P 14 1 0 0", "truncated-file@34"),
            ("BCurve C 1 1 { P Q", "truncated-file@33"),
            ("AbsPoint P 14 1 0 0 0;", "missing-end@37"),
            ("A P 1 1 0\nA Q 1 1 0;\nEndModel", "missing-semicolon@24"),
            ("A P 1 1 { Q ;\nEndModel", "unclosed-bracket@23"),
            ("A P 1 1 Q };\nEndModel", "unexpected-token@25"),
            ("A P 1 1 1e999;\nEndModel", "bad-number@23"),
            ("%%% ; A P 1 1;\nEndModel", "unexpected-token@15"),
            ("A;\nEndModel", "missing-name@15"),
            ("EndModel;\nmore", "text-after-end@25"),
            ("A P A:x(3;\nEndModel", "unclosed-bracket@19"),
        ];
        for (body, expected) in cases {
            assert_eq!(ids(&format!("{head}{body}"))[0], expected, "{body}");
        }
        assert_eq!(ids("hello"), ["not-a-model-file@0", "truncated-file@5"]);
        assert_eq!(ids(""), ["not-a-model-file@0"]);
        let deep = format!("{head}A P 1 1 {};\nEndModel", "{".repeat(100_000));
        assert!(ids(&deep)[0].starts_with("nesting-too-deep"));
    }

    #[test]
    fn numbers_change_in_place() {
        let text = "MultiSurf 0.35\nA P 14 1 8x4 -2.50 ;\nEndModel\n";
        let (mut model, _) = parse(text, FileId(0));
        assert_eq!(model.numbers().len(), 5);
        model.set_number(NumberId(4), 0.25).unwrap();
        model.set_number(NumberId(2), 16.0).unwrap();
        assert_eq!(model.text_with_edits(), "MultiSurf 0.35\nA P 14 1 16x4 0.25 ;\nEndModel\n");
        assert!(model.to_canonical(|_| true).contains("16x4 0.25 ;"));
        assert_eq!(model.set_number(NumberId(4), f64::NAN).unwrap_err().id, "not-finite");
        assert_eq!(model.set_number(NumberId(99), 1.0).unwrap_err().id, "unknown-literal");
    }
}
