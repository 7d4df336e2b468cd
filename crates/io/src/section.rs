//! Points in text: rows of coordinates (CSV and the like), and aerofoil sections as collections of
//! them publish them.

use crate::text::{Line, quoted, utf8};
use crate::{Place, ReadError};
use moldloft_num::Vec3;

const FORMAT: &str = "coordinates";

/// The points of a text with two or three numbers to a line, separated by blanks, commas, semicolons
/// or tabulators. Lines without any number before the first point are headings; those that begin with
/// `#` and empty ones are skipped anywhere.
///
/// # Errors
/// A line of another number of numbers, or numbers that are not finite; no points at all.
///
/// # Example
/// ```
/// let points = moldloft_io::section::read_points(b"x, y\n0, 0\n1; 0.5\n").unwrap();
/// assert_eq!(points[1].to_array(), [1.0, 0.5, 0.0]);
/// ```
pub fn read_points(bytes: &[u8]) -> Result<Vec<Vec3>, ReadError> {
    let text = utf8(bytes, FORMAT)?;
    let mut points = Vec::new();
    let mut columns = None;
    let mut last = 1;
    for (number, raw) in (1..).zip(text.lines()) {
        last = number;
        let cleaned = raw.trim().trim_start_matches('\u{feff}').replace(';', " ");
        if cleaned.is_empty() || cleaned.starts_with('#') {
            continue;
        }
        let line = Line { format: FORMAT, number, text: &cleaned };
        let none = !line.words().any(|word| word.parse::<f64>().is_ok());
        if points.is_empty() && none {
            continue;
        }
        points.push(point(&line, &mut columns)?);
    }
    if points.is_empty() {
        let line = Line { format: FORMAT, number: last, text: "" };
        return Err(line.error("two or three numbers to a line", "no numbers"));
    }
    Ok(points)
}

fn point(line: &Line, columns: &mut Option<usize>) -> Result<Vec3, ReadError> {
    let words: Vec<&str> = line.words().collect();
    let expected = *columns.get_or_insert(words.len());
    if words.len() != expected || !matches!(expected, 2 | 3) {
        let wanted = if matches!(expected, 2 | 3) {
            format!("{expected} numbers, as in the lines before")
        } else {
            "two or three numbers".into()
        };
        return Err(line.error(wanted, format!("{} words", words.len())));
    }
    let mut xyz = [0.0; 3];
    for (x, word) in xyz.iter_mut().zip(&words) {
        *x = line.real(Some(word), "a number")?;
    }
    Ok(xyz.into())
}

/// How an aerofoil file lists its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listing {
    /// From the trailing edge along the upper side to the nose and back along the lower.
    Selig,
    /// Two lists, upper and lower, each from the nose to the trailing edge.
    Lednicer,
}

/// An aerofoil section.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The heading.
    pub name: String,
    /// Points from the trailing edge along the upper side to the nose and back along the lower, in the
    /// file's units; z = 0.
    pub points: Vec<Vec3>,
    /// The index of the nose: the point of least x.
    pub nose: usize,
    /// How the file listed them.
    pub listing: Listing,
}

/// The section of an aerofoil file, in Selig's or Lednicer's listing, which it tells apart by the
/// numbers of points that the latter begins with.
///
/// # Errors
/// Fewer than five points, lines that are no pairs of numbers, and lists of another length than they
/// say.
///
/// # Example
/// ```
/// let selig = b"WEDGE\n1 0\n0.5 0.1\n0 0\n0.5 -0.1\n1 0\n";
/// let section = moldloft_io::section::read_aerofoil(selig).unwrap();
/// assert_eq!((section.name.as_str(), section.nose), ("WEDGE", 2));
/// ```
pub fn read_aerofoil(bytes: &[u8]) -> Result<Section, ReadError> {
    // Old files have headings in any code; only ASCII matters here.
    let text: String = match std::str::from_utf8(bytes) {
        Ok(text) => text.into(),
        Err(_) => bytes.iter().map(|&b| if b.is_ascii() { b as char } else { '?' }).collect(),
    };
    let mut name = String::new();
    let mut rows: Vec<(usize, Vec3)> = Vec::new();
    for (number, raw) in (1..).zip(text.lines()) {
        let trimmed = raw.trim().trim_start_matches('\u{feff}');
        if trimmed.is_empty() || trimmed.starts_with('#') {
            continue;
        }
        let line = Line { format: "aerofoil", number, text: trimmed };
        let words: Vec<&str> = line.words().collect();
        let numbers = words.len() == 2 && words.iter().all(|w| w.parse::<f64>().is_ok());
        if rows.is_empty() && name.is_empty() && !numbers {
            name = trimmed.to_string();
            continue;
        }
        if words.len() != 2 {
            return Err(line.error("a pair of numbers", quoted(trimmed)));
        }
        let x = line.real(Some(words[0]), "a number")?;
        let y = line.real(Some(words[1]), "a number")?;
        rows.push((number, Vec3::of(x, y, 0.0)));
    }
    let last = rows.last().map_or(1, |(number, _)| *number);
    let error = |number: usize, expected: String, found: String| ReadError {
        format: "aerofoil",
        place: Place::Line(number),
        expected,
        found,
    };
    // Lednicer's counts: two whole numbers above one, which no coordinates of a unit chord are.
    let counts = rows.first().filter(|(_, p)| p.x > 1.5 && p.y > 1.5 && p.x.fract() == 0.0);
    let (points, listing) = match counts {
        Some(&(number, counts)) => {
            let (upper, lower) = (counts.x as usize, counts.y as usize);
            let found = rows.len() - 1;
            if counts.y.fract() != 0.0 || upper + lower != found {
                return Err(error(
                    number,
                    format!("{} points", counts.x + counts.y),
                    format!("{found} points"),
                ));
            }
            let side = |from: usize, to: usize| rows[from..to].iter().map(|(_, p)| *p);
            let mut all: Vec<Vec3> = side(1, 1 + upper).rev().collect();
            // The nose is in both lists.
            let nose = all.last().copied();
            let below = side(1 + upper, 1 + upper + lower);
            all.extend(
                below.enumerate().filter(|(k, p)| *k > 0 || Some(*p) != nose).map(|(_, p)| p),
            );
            (all, Listing::Lednicer)
        }
        None => (rows.iter().map(|(_, p)| *p).collect::<Vec<_>>(), Listing::Selig),
    };
    if points.len() < 5 {
        return Err(error(last, "at least five points".into(), format!("{} points", points.len())));
    }
    let nose = (0..points.len()).fold(0, |n, k| if points[k].x < points[n].x { k } else { n });
    if nose == 0 || nose + 1 == points.len() {
        return Err(error(
            last,
            "points from the trailing edge round the nose and back".into(),
            "the nose at an end of the list".into(),
        ));
    }
    Ok(Section { name, points, nose, listing })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_listings_give_the_same_section() {
        let selig = b"\xc9TUDE 12\n 1.0 0.0\n 0.5 0.1\n 0.0 0.0\n 0.4 -0.05\n 1.0 0.0\n";
        let lednicer =
            b"NAME\n  3.  3.\n\n 0.0 0.0\n 0.5 0.1\n 1.0 0.0\n\n 0.0 0.0\n 0.4 -0.05\n 1.0 0.0\n";
        let (a, b) = (read_aerofoil(selig).unwrap(), read_aerofoil(lednicer).unwrap());
        assert_eq!((a.points, a.nose), (b.points, b.nose));
        assert_eq!((a.listing, b.listing), (Listing::Selig, Listing::Lednicer));
        assert_eq!((a.name.as_str(), b.name.as_str()), ("?TUDE 12", "NAME"));
        let short = b"NAME\n 4. 3.\n 0 0\n 0.5 0.1\n 1 0\n 0 0\n 0.4 -0.05\n 1 0\n";
        let error = read_aerofoil(short).unwrap_err();
        assert_eq!((error.place, error.expected.as_str()), (Place::Line(2), "7 points"));
        assert_eq!(read_aerofoil(b"X\n1 0\n0 0 0\n").unwrap_err().place, Place::Line(3));
        assert!(read_aerofoil(b"X\n0 0\n1 0\n2 0\n3 1\n4 1\n").unwrap_err().found.contains("nose"));
        assert!(read_aerofoil(b"").is_err());
    }

    #[test]
    fn rows_of_coordinates() {
        let text = b"\xef\xbb\xbfstation,x,y\n# note\n1,2,3\n4\t5 6\n\n";
        let points = read_points(text).unwrap();
        assert_eq!(points, [Vec3::of(1.0, 2.0, 3.0), Vec3::of(4.0, 5.0, 6.0)]);
        assert_eq!(read_points(b"1 2\n3\n").unwrap_err().place, Place::Line(2));
        assert_eq!(read_points(b"1 2\n3 x\n").unwrap_err().place, Place::Line(2));
        assert!(read_points(b"1 2 3 4\n").is_err() && read_points(b"head\n").is_err());
        assert!(read_points(b"1 nan\n").is_err() && read_points(&[0xff, 0xfe]).is_err());
    }
}
