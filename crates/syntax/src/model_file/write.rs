//! Model files back into text.

use super::*;

impl ModelFile {
    /// The canonical text: one object a line, numbers in their shortest spelling, single empty
    /// lines and all comments kept, in the original order. Objects for which `verbatim` holds, and
    /// those with errors, are written as in the source (changed numbers included).
    pub fn to_canonical(&self, mut verbatim: impl FnMut(&ObjectEntry) -> bool) -> String {
        let mut out = String::with_capacity(self.text.len());
        self.write_header(&mut out);
        for item in &self.items {
            if item.after_gap && !out.is_empty() {
                out.push('\n');
            }
            match &item.kind {
                ItemKind::Object(object) if object.complete && !verbatim(object) => {
                    self.write_object(object, &mut out);
                }
                ItemKind::Object(_) => out.push_str(&self.slice_with_edits(item.span)),
                ItemKind::Comment | ItemKind::Unknown => out.push_str(self.slice(item.span)),
            }
            out.push('\n');
        }
        if self.end.is_some() {
            out.push_str("EndModel;\n");
        }
        if let Some(trailer) = self.trailer {
            out.push_str(self.slice(trailer));
            out.push('\n');
        }
        out
    }

    /// The canonical text of one object, without a line end.
    pub fn object_text(&self, object: &ObjectEntry) -> String {
        let mut out = String::new();
        self.write_object(object, &mut out);
        out
    }

    /// The source text of a span with the changed numbers.
    pub fn slice_with_edits(&self, span: Span) -> String {
        let edits: Vec<(Span, String)> = self
            .edits()
            .into_iter()
            .filter(|(at, _)| span.start <= at.start && at.end <= span.end)
            .map(|(at, text)| {
                (Span { start: at.start - span.start, end: at.end - span.start, ..at }, text)
            })
            .collect();
        crate::splice(self.slice(span), &edits)
    }

    fn write_header(&self, out: &mut String) {
        if let Some(version) = self.version {
            out.push_str("MultiSurf ");
            out.push_str(self.slice(version));
            if let Some(rest) = self.first_line_rest {
                out.push(' ');
                out.push_str(self.slice(rest));
            }
            out.push('\n');
        }
        // Comments and header lines, in their order.
        let comments = self.header_comments.iter().map(|span| (span.start, None, *span));
        let lines = self.header.iter().map(|line| (line.key.start, Some(line.key), line.rest));
        let mut all: Vec<_> = comments.chain(lines).collect();
        all.sort_by_key(|(start, ..)| *start);
        for (_, key, rest) in all {
            if let Some(key) = key {
                out.push_str(self.slice(key));
                out.push_str(if rest.is_empty() { ":" } else { ": " });
            }
            out.push_str(self.slice(rest));
            out.push('\n');
        }
        if self.begin.is_some() {
            out.push_str("BeginModel;\n");
        }
    }

    fn write_object(&self, object: &ObjectEntry, out: &mut String) {
        out.push_str(self.slice(object.entity));
        out.push(' ');
        out.push_str(self.slice(object.name));
        self.write_fields(object.fields, out);
        out.push(';');
    }

    fn write_fields(&self, fields: Fields, out: &mut String) {
        for field in &self[fields] {
            out.push(' ');
            match field.kind {
                FieldKind::Number(id) => out.push_str(&number::plain(self[id].value)),
                FieldKind::Pair(n, m) => {
                    out.push_str(&number::plain(self[n].value));
                    out.push('x');
                    out.push_str(&number::plain(self[m].value));
                }
                FieldKind::List(list) => {
                    out.push('{');
                    self.write_fields(list, out);
                    out.push_str(" }");
                }
                FieldKind::Tuple(list) => {
                    out.push('(');
                    self.write_fields(list, out);
                    out.push_str(" )");
                }
                FieldKind::Argument { name, value } => {
                    out.push_str(ARGUMENT);
                    out.push('(');
                    out.push_str(self.slice(name));
                    self.write_fields(value, out);
                    out.push(')');
                }
                FieldKind::Word
                | FieldKind::Star
                | FieldKind::Text
                | FieldKind::Formula
                | FieldKind::Attribute { .. }
                | FieldKind::Slash => out.push_str(self.slice(field.span)),
            }
        }
    }
}
