//! The clear text of ISO 10303-21: entities by number, strings, reals.

use super::StepHeader;
use crate::text::append;
use std::collections::HashMap;

/// The data section as it grows.
#[derive(Default)]
pub(crate) struct Part21 {
    data: String,
    last: usize,
    /// Points without a name, by the bits of their coordinates.
    points: HashMap<[u64; 3], usize>,
    /// Straight curves in parameters, by their ends.
    traces: HashMap<[usize; 2], usize>,
}

impl Part21 {
    /// The point at two or three coordinates, which all that passes through it shares: neighbours have the same ones along
    /// their edges.
    pub fn point(&mut self, coordinates: &[f64]) -> usize {
        // No finite number has these bits.
        let mut key = [u64::MAX; 3];
        for (own, x) in key.iter_mut().zip(coordinates) {
            *own = (x + 0.0).to_bits();
        }
        if let Some(number) = self.points.get(&key) {
            return *number;
        }
        let number =
            self.add(format!("CARTESIAN_POINT('',{})", reals(coordinates.iter().copied())));
        self.points.insert(key, number);
        number
    }

    /// A straight curve in parameters, which all sides along it share.
    pub fn trace(&mut self, ends: [usize; 2], make: impl FnOnce(&mut Self) -> usize) -> usize {
        if let Some(number) = self.traces.get(&ends) {
            return *number;
        }
        let number = make(self);
        self.traces.insert(ends, number);
        number
    }

    /// Adds an entity; its number.
    pub fn add(&mut self, entity: String) -> usize {
        self.last += 1;
        append(&mut self.data, format_args!("#{}={entity};\n", self.last));
        self.last
    }

    /// The file.
    pub fn finished(
        self,
        header: &StepHeader<'_>,
        error: f64,
        exact: bool,
        faceted: usize,
    ) -> Vec<u8> {
        let [schema, ..] = header.protocol.words();
        let about = if exact {
            "surfaces exact but for rounding".to_string()
        } else {
            format!("surfaces within {} of the model", real(error))
        };
        let about = match faceted {
            0 => about,
            1 => format!("{about}; 1 body of triangles"),
            n => format!("{about}; {n} bodies of triangles"),
        };
        let mut out = String::with_capacity(self.data.len() + 600);
        out.push_str("ISO-10303-21;\nHEADER;\n");
        append(
            &mut out,
            format_args!("FILE_DESCRIPTION(({},{}),'2;1');\n", text(header.title), text(&about)),
        );
        // No time: the same model gives the same bytes.
        append(
            &mut out,
            format_args!(
                "FILE_NAME({},'1970-01-01T00:00:00',(''),(''),{},{},'');\n",
                text(header.title),
                text(&format!("moldloft {}", header.version)),
                text("moldloft")
            ),
        );
        append(&mut out, format_args!("FILE_SCHEMA(('{schema}'));\nENDSEC;\nDATA;\n"));
        out.push_str(&self.data);
        out.push_str("ENDSEC;\nEND-ISO-10303-21;\n");
        out.into_bytes()
    }
}

/// A number with a point, its exponent after a capital E; the shortest that reads back as the same double.
pub(crate) fn real(x: f64) -> String {
    let mut out = String::new();
    push_real(&mut out, x);
    out
}

fn push_real(out: &mut String, x: f64) {
    let start = out.len();
    append(out, format_args!("{:?}", x + 0.0));
    let own = &out[start..];
    match own.find('e') {
        Some(k) => {
            let power = if own[..k].contains('.') { "E" } else { ".E" };
            out.replace_range(start + k..=start + k, power);
        }
        None if own.ends_with(".0") => out.truncate(out.len() - 1),
        None => {}
    }
}

/// Numbers in parentheses.
pub(crate) fn reals(numbers: impl IntoIterator<Item = f64>) -> String {
    let mut out = String::from("(");
    for (k, x) in numbers.into_iter().enumerate() {
        if k > 0 {
            out.push(',');
        }
        push_real(&mut out, x);
    }
    out.push(')');
    out
}

/// References in parentheses.
pub(crate) fn list(numbers: &[usize]) -> String {
    let mut out = String::from("(");
    for (k, n) in numbers.iter().enumerate() {
        append(&mut out, format_args!("{}#{n}", if k > 0 { "," } else { "" }));
    }
    out.push(')');
    out
}

/// Items in parentheses.
pub(crate) fn joined(items: impl IntoIterator<Item = String>) -> String {
    let mut out = String::from("(");
    for (k, item) in items.into_iter().enumerate() {
        if k > 0 {
            out.push(',');
        }
        out.push_str(&item);
    }
    out.push(')');
    out
}

/// A string with other characters than plain ASCII encoded.
pub(crate) fn text(words: &str) -> String {
    let mut out = String::from("'");
    // Width of the open sequence of codes: 4, 8, or 0 outside one.
    let mut open = 0;
    for c in words.chars() {
        let code = c as u32;
        let width = match code {
            0x20..=0x7e => 0,
            0..=0xffff => 4,
            _ => 8,
        };
        if width != open {
            if open > 0 {
                out.push_str("\\X0\\");
            }
            if width > 0 {
                out.push_str(if width == 4 { "\\X2\\" } else { "\\X4\\" });
            }
            open = width;
        }
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            _ if width == 0 => out.push(c),
            _ if width == 4 => append(&mut out, format_args!("{code:04X}")),
            _ => append(&mut out, format_args!("{code:08X}")),
        }
    }
    if open > 0 {
        out.push_str("\\X0\\");
    }
    out.push('\'');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_strings() {
        let reals = [1.0, -0.5, 1e-7, 2.5e-9, 1e16, -0.0, 0.1].map(real);
        assert_eq!(reals, ["1.", "-0.5", "1.E-7", "2.5E-9", "1.E16", "0.", "0.1"]);
        assert_eq!(text("it's \\"), "'it''s \\\\'");
        assert_eq!(text("ä☂b𝄞"), "'\\X2\\00E42602\\X0\\b\\X4\\0001D11E\\X0\\'");
        assert_eq!(text("a\nb"), "'a\\X2\\000A\\X0\\b'");
    }
}
