//! Points in text: rows of two or three coordinates, as tables (CSV), lists and aerofoil files have
//! them, in and out.
//!
//! `bytes -> PointTable` keeps what a program needs to write the same file with other numbers: the
//! headings, the separator of columns, the empty lines between curves, an aerofoil's two halves.

use crate::text::{lines, pointed, quoted, text_of};
use crate::{FilePosition, ReadError};
use moldloft_num::Vec3;
use std::ops::Range;

const FORMAT: &str = "coordinates";

/// The rows of a text.
#[derive(Clone, Debug, PartialEq)]
pub struct PointTable {
    /// The points, in the order of the curve; z = 0 where there are two columns.
    pub rows: Vec<Vec3>,
    /// Two or three.
    pub columns: usize,
    /// The line of each row, from 1.
    pub lines: Vec<usize>,
    /// Groups of rows separated by empty lines.
    pub blocks: Vec<Range<usize>>,
    /// Lines before the first row: comments first, then titles or names of columns.
    pub head: Vec<String>,
    /// Separator of the columns of the first row; `None` for blanks.
    pub delimiter: Option<char>,
    /// The numbers of points of an aerofoil in two halves, each from the leading edge. The rows are
    /// then one run, from the upper trailing edge round the leading edge.
    pub halves: Option<[usize; 2]>,
}

/// The points of a text with two or three numbers per line.
///
/// Blanks, tabs, commas and semicolons separate, also behind the last number. `#` begins a comment.
/// Before the first row there may be lines without numbers (names of columns) and one title with
/// words and numbers. Exponents may be written with `D`. Two halves of an aerofoil with their
/// counts before them become one run.
///
/// # Errors
/// A line with another number of columns, an empty cell, a word that is not a number, or numbers that
/// are not finite; no points at all.
///
/// # Example
/// ```
/// let table = moldloft_io::points::read(b"x, y\n0, 0\n1; 0.5\n").unwrap();
/// assert_eq!(table.rows[1].to_array(), [1.0, 0.5, 0.0]);
/// assert_eq!((table.columns, table.lines[1], table.delimiter), (2, 3, Some(',')));
/// ```
pub fn read(bytes: &[u8]) -> Result<PointTable, ReadError> {
    let text = text_of(bytes);
    let mut table = PointTable {
        rows: Vec::new(),
        columns: 0,
        lines: Vec::new(),
        blocks: Vec::new(),
        head: Vec::new(),
        delimiter: None,
        halves: None,
    };
    let mut titles = Vec::new();
    let mut in_block = false;
    let mut last = 1;
    for (number, raw) in (1..).zip(lines(&text)) {
        last = number;
        let line = raw.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            if raw.trim().is_empty() {
                in_block = false;
            } else if table.rows.is_empty() {
                table.head.push(raw.trim_end().into());
            }
            continue;
        }
        let cells = DelimitedLine::of(line);
        let titled = titles.iter().any(|(_, of_words)| *of_words);
        if table.rows.is_empty() && (cells.no_numbers() || !titled && cells.is_title()) {
            titles.push((raw.trim_end().to_owned(), !cells.no_numbers()));
            continue;
        }
        let row = cells.row(number, (!table.rows.is_empty()).then_some(table.columns))?;
        if table.rows.is_empty() {
            (table.columns, table.delimiter) = (row.len(), cells.delimiter);
        }
        if !in_block {
            table.blocks.push(table.rows.len()..table.rows.len());
            in_block = true;
        }
        table.rows.push(Vec3::of(row[0], row[1], row.get(2).copied().unwrap_or(0.0)));
        table.lines.push(number);
        if let Some(block) = table.blocks.last_mut() {
            block.end = table.rows.len();
        }
    }
    table.head.extend(titles.into_iter().map(|(line, _)| line));
    if table.rows.is_empty() {
        return Err(error(last, "two or three numbers to a line", "no points"));
    }
    table.join_halves();
    Ok(table)
}

fn error(line: usize, expected: impl Into<String>, found: impl Into<String>) -> ReadError {
    let (expected, found) = (expected.into(), found.into());
    ReadError { format: FORMAT, place: FilePosition::Line(line), expected, found }
}

/// The words of a line, empty ones between two delimiters included.
struct DelimitedLine<'a> {
    words: Vec<&'a str>,
    delimiter: Option<char>,
    /// A comma, semicolon or tab ends the line.
    trailing: bool,
}

impl<'a> DelimitedLine<'a> {
    /// A run of blanks is one separator, and so is one comma, semicolon or tab with the blanks
    /// around it. A last one ends the line.
    fn of(line: &'a str) -> Self {
        let mut cells = DelimitedLine { words: Vec::new(), delimiter: None, trailing: false };
        let mut rest = line.trim();
        while !rest.is_empty() {
            let end = rest.find(|c: char| c.is_whitespace() || ",;".contains(c));
            let (word, more) = rest.split_at(end.unwrap_or(rest.len()));
            cells.words.push(word);
            let after = more.trim_start();
            let blanks = &more[..more.len() - after.len()];
            let delimiter = after.chars().next().filter(|c| ",;".contains(*c));
            let tab = delimiter.is_none().then(|| blanks.find('\t')).flatten();
            // Between two tabs there is an empty cell.
            rest = match (delimiter, tab) {
                (Some(_), _) => after[1..].trim_start_matches([' ', '\u{a0}']).trim_start(),
                (None, Some(at)) => blanks_after(&more[at + 1..]),
                (None, None) => after,
            };
            let own = delimiter.or(tab.map(|_| '\t'));
            cells.trailing = rest.is_empty() && own.is_some();
            cells.delimiter = match (cells.delimiter, own) {
                (Some(','), _) | (_, None) => cells.delimiter,
                (Some(';'), Some('\t')) => cells.delimiter,
                (_, own) => own,
            };
        }
        cells
    }

    fn number(word: &str) -> Option<f64> {
        // Fortran writes the exponents of doubles with D.
        word.parse().ok().or_else(|| word.replace(['d', 'D'], "e").parse().ok())
    }

    fn no_numbers(&self) -> bool {
        self.words.iter().all(|word| Self::number(word).is_none())
    }

    /// True for `NACA 0012` and `2412 airfoil`; false for a row with a typing error, such as `1.0
    /// O.5` or `1, y`.
    fn is_title(&self) -> bool {
        let begins = |word: &str, letters: usize| {
            word.chars().count() >= letters && word.chars().take(letters).all(char::is_alphabetic)
        };
        let named = |word: &&str| Self::number(word).is_none() && begins(word, 2);
        let first = self.words.first();
        let leads = first.is_some_and(|word| Self::number(word).is_none() && begins(word, 1));
        self.delimiter.is_none() && (leads || self.words.iter().any(named))
    }

    fn row(&self, line: usize, columns: Option<usize>) -> Result<Vec<f64>, ReadError> {
        let mut row = Vec::with_capacity(3);
        for word in &self.words {
            if word.is_empty() {
                return Err(error(line, "a number in each column", "an empty one: it is missing"));
            }
            let value = Self::number(word).ok_or_else(|| error(line, "a number", quoted(word)))?;
            if !value.is_finite() {
                let found = format!("{}, which is not finite", quoted(word));
                return Err(error(line, "a finite number", found));
            }
            row.push(value);
        }
        match columns {
            None if !matches!(row.len(), 2 | 3) => {
                Err(error(line, "2 or 3 columns", row.len().to_string()))
            }
            Some(n) if row.len() + 1 == n && self.trailing => {
                Err(error(line, "a number in each column", "an empty one: it is missing"))
            }
            Some(n) if row.len() != n => Err(error(
                line,
                format!("{n} columns, as in the lines before"),
                row.len().to_string(),
            )),
            _ => Ok(row),
        }
    }
}

/// The rest of a line behind a tab, without the blanks up to the next tab or word.
fn blanks_after(rest: &str) -> &str {
    rest.trim_start_matches(|c: char| c.is_whitespace() && c != '\t')
}

impl PointTable {
    /// An aerofoil in two halves becomes one run from the upper trailing edge round the nose.
    fn join_halves(&mut self) {
        let Some([upper, lower]) = self.counts() else { return };
        let nose_twice = self.rows[1] == self.rows[upper + 1];
        let below = upper + 1 + usize::from(nose_twice)..upper + lower + 1;
        let order: Vec<usize> = (1..=upper).rev().chain(below).collect();
        self.rows = order.iter().map(|&k| self.rows[k]).collect();
        self.lines = order.iter().map(|&k| self.lines[k]).collect();
        self.blocks = std::iter::once(0..order.len()).collect();
        self.halves = Some([upper, lower]);
    }

    /// The first row when it counts the two halves behind it: two whole numbers above one, which no
    /// coordinates of a unit chord are, and as many rows as they say.
    fn counts(&self) -> Option<[usize; 2]> {
        let first = self.announces()?;
        let whole = first.map(|x| x as usize);
        let rows = self.rows.len();
        (rows >= 7 && first.iter().all(|x| x.fract() == 0.0) && whole[0] + whole[1] == rows - 1)
            .then_some(whole)
    }

    /// The first row when it can be nothing but the counts of two halves of a unit chord.
    pub(crate) fn announces(&self) -> Option<[f64; 2]> {
        let Vec3 { x, y, .. } = *self.rows.first()?;
        (self.columns == 2 && x > 1.5 && y > 1.5 && x < 1e6 && y < 1e6).then_some([x, y])
    }
}

/// Layout of rows in a text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointLayout {
    /// Lines before the first row.
    pub head: Vec<String>,
    /// Separator of the columns, blanks included, such as `", "`.
    pub separator: String,
    /// Groups of rows with an empty line between them; one group without such lines.
    pub blocks: Vec<Range<usize>>,
    /// The counts of an aerofoil's two halves, each written from the leading edge.
    pub halves: Option<[usize; 2]>,
}

/// The text of rows of two or three numbers. Each number reads back as the same double; -0 becomes
/// 0. A layout whose halves or blocks do not match the rows is ignored.
///
/// # Panics
/// When there are not two or three columns.
pub fn write(rows: &[Vec3], columns: usize, layout: &PointLayout) -> String {
    assert!(matches!(columns, 2 | 3));
    let row = |p: &Vec3| {
        let words: Vec<String> = p.to_array()[..columns].iter().map(|x| pointed(*x)).collect();
        words.join(&layout.separator)
    };
    let mut out = layout.head.clone();
    match layout.halves {
        Some([upper, lower]) if upper <= rows.len() && lower <= rows.len() => {
            out.push(format!("{upper}.{}{lower}.", layout.separator));
            out.push(String::new());
            out.extend(rows[..upper].iter().rev().map(row));
            out.push(String::new());
            out.extend(rows[rows.len() - lower..].iter().map(row));
        }
        _ => {
            let whole = std::iter::once(0..rows.len()).collect::<Vec<_>>();
            let fit = layout.blocks.last().is_some_and(|block| block.end == rows.len());
            let blocks = if fit { &layout.blocks[..] } else { &whole[..] };
            for (k, block) in blocks.iter().enumerate() {
                if k > 0 {
                    out.push(String::new());
                }
                out.extend(rows[block.clone()].iter().map(row));
            }
        }
    }
    out.push(String::new());
    out.join("\n")
}

/// A table of points, with the names of its columns, separated by commas.
pub fn write_csv(rows: &[Vec3], columns: usize) -> String {
    let head = vec!["x,y,z"[..2 * columns - 1].to_owned()];
    write(rows, columns, &PointLayout { head, separator: ",".into(), ..PointLayout::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &[u8]) -> Vec<[f64; 3]> {
        read(text).unwrap().rows.into_iter().map(Vec3::to_array).collect()
    }

    fn fault(text: &str) -> (FilePosition, String, String) {
        let error = read(text.as_bytes()).unwrap_err();
        (error.place, error.expected, error.found)
    }

    #[test]
    fn every_way_to_lay_out_the_same_rows() {
        let wanted = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
        for separator in [",", ", ", " , ", ";", "; ", "\t", " ", "   ", "\t ", " \t", ",\t"] {
            for end in ["", ",", " ,", ";", " ", "\t", " # note", "\r"] {
                for head in
                    ["", "x,y,z\n", "\u{feff}x y z\n", "# note\n", "NACA 0012\n", "a\nb\n", "\n"]
                {
                    let row = |r: [f64; 3]| r.map(|x| format!("{x}.0D0")).join(separator) + end;
                    let text = format!("{head}{}\n{}\n", row(wanted[0]), row(wanted[1]));
                    assert_eq!(rows(text.as_bytes()), wanted, "{text:?}");
                }
            }
        }
        assert_eq!(rows(b"1 2 3\r4 5 6\r"), wanted);
    }

    #[test]
    fn what_was_read_is_written_again() {
        for text in [
            "# made by hand\nx, y\n0.1, 0.2\n0.3, 1e-05\n\n5.0, 6e+20\n",
            "1.0\t2.0\t3.0\n4.0\t5.0\t-1e-300\n",
            "1.0; 2.0\n3.0; 4.0\n",
            "NACA 0012\n4. 4.\n\n0.0 0.0\n0.1 0.5\n0.5 0.6\n1.0 0.0\n\n0.0 0.0\n0.1 -0.5\n0.5 -0.6\n1.0 0.0\n",
        ] {
            let table = read(text.as_bytes()).unwrap();
            let separator = match table.delimiter {
                None => " ".into(),
                Some('\t') => "\t".into(),
                Some(c) => format!("{c} "),
            };
            let PointTable { head, blocks, halves, .. } = table;
            let layout = PointLayout { head, separator, blocks, halves };
            assert_eq!(write(&table.rows, table.columns, &layout), text);
        }
    }

    #[test]
    fn two_halves_are_one_run() {
        let table = read(b"X\n4 4\n\n0 0\n1 5\n5 6\n10 0\n\n0 0\n1 -5\n5 -6\n10 0\n").unwrap();
        assert_eq!((table.rows.len(), table.halves), (7, Some([4, 4])));
        assert_eq!((table.rows[0], table.lines[0]), (Vec3::of(10.0, 0.0, 0.0), 7));
        assert_eq!((table.rows[3], table.lines[3]), (Vec3::zero(), 4));
        assert_eq!((table.rows[4], table.lines[4]), (Vec3::of(1.0, -5.0, 0.0), 10));
    }

    #[test]
    fn faults_have_their_line() {
        assert_eq!(
            fault("1 2\n3\n"),
            (FilePosition::Line(2), "2 columns, as in the lines before".into(), "1".into())
        );
        for (text, line, words) in [
            ("1 2\n3 x\n", 2, "`x`"),
            ("1 2\nnone\n", 2, "`none`"),
            ("1 x\n3 4\n", 1, "`x`"),
            ("1, y\n3, 4\n", 1, "`y`"),
            ("1.0 O.5\n3 4\n", 1, "`O.5`"),
            ("NACA 0012\nRAE 2822\n3 4\n", 2, "`RAE`"),
            ("1,,3\n", 1, "missing"),
            ("1\t\t3\n", 1, "missing"),
            (",1,3\n", 1, "missing"),
            ("1, 2\n5,\n", 2, "missing"),
            ("1 nan\n", 1, "not finite"),
            ("1 1e999\n", 1, "not finite"),
            ("1 2 3 4\n", 1, "4"),
            ("7\n", 1, "1"),
            ("head\n", 2, "no points"),
            ("", 1, "no points"),
            ("\0\u{1}", 1, "no points"),
        ] {
            let (place, _, found) = fault(text);
            assert!(
                place == FilePosition::Line(line) && found.contains(words),
                "{text:?}: {place:?} {found}"
            );
        }
        assert!(read(&[0xff, 0xfe]).is_err());
    }

    #[test]
    fn numbers_are_spelled_as_c_does() {
        for (x, text) in [
            (1.0, "1.0"),
            (-0.0, "0.0"),
            (0.1, "0.1"),
            (1e-5, "1e-05"),
            (2.5e-7, "2.5e-07"),
            (0.0001, "0.0001"),
            (1e15, "1000000000000000.0"),
            (1e16, "1e+16"),
            (-1.5e300, "-1.5e+300"),
        ] {
            assert_eq!(pointed(x), text);
            assert_eq!(pointed(x).parse::<f64>().unwrap(), x);
        }
    }
}
