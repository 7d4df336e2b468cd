//! Aerofoil sections, as collections of them publish them: a name and a list of points.

use crate::points::{self, PointTable};
use crate::text::quoted;
use crate::{FilePosition, ReadError};
use moldloft_num::Vec3;

const FORMAT: &str = "aerofoil";

/// Order of points in an aerofoil file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listing {
    /// From the trailing edge along the upper side to the leading edge, and back along the lower
    /// side.
    Selig,
    /// Two lists, upper and lower side, each from the leading to the trailing edge.
    Lednicer,
}

/// An aerofoil section.
#[derive(Clone, Debug, PartialEq)]
pub struct AerofoilSection {
    /// The heading.
    pub name: String,
    /// Points from the trailing edge along the upper side to the leading edge, and back along the
    /// lower, in the file's units; z = 0.
    pub points: Vec<Vec3>,
    /// Index of the leading edge: the point of least x.
    pub nose: usize,
    /// Order of the points in the file.
    pub listing: Listing,
}

/// The section of an aerofoil file, in Selig's or Lednicer's order; the latter begins with two
/// numbers of points.
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
pub fn read_aerofoil(bytes: &[u8]) -> Result<AerofoilSection, ReadError> {
    let table = points::read(bytes).map_err(|e| ReadError { format: FORMAT, ..e })?;
    let PointTable { rows, lines, head, .. } = &table;
    let error = |line: usize, expected: String, found: String| {
        Err(ReadError { format: FORMAT, place: FilePosition::Line(line), expected, found })
    };
    let mut titles = head.iter().filter(|line| !line.trim_start().starts_with('#'));
    let name = titles.next().map(|line| line.trim().to_owned()).unwrap_or_default();
    if let Some(second) = titles.next() {
        return error(lines[0], "one heading before the points".into(), quoted(second));
    }
    if table.columns != 2 {
        return error(lines[0], "a pair of numbers".into(), format!("{} numbers", table.columns));
    }
    let (points, listing) = match (table.halves, table.announces()) {
        (None, Some([upper, lower])) if upper.fract() == 0.0 => {
            let expected = format!("{} points, and at least six", upper + lower);
            return error(lines[0], expected, format!("{} points", rows.len() - 1));
        }
        (None, _) => (rows.clone(), Listing::Selig),
        (Some(_), _) => (rows.clone(), Listing::Lednicer),
    };
    let last = lines.iter().copied().max().unwrap_or(1);
    if points.len() < 5 {
        return error(last, "at least five points".into(), format!("{} points", points.len()));
    }
    let nose = (0..points.len()).fold(0, |n, k| if points[k].x < points[n].x { k } else { n });
    if nose == 0 || nose + 1 == points.len() {
        return error(
            last,
            "points from the trailing edge around the leading edge and back".into(),
            "the leading edge at an end of the list".into(),
        );
    }
    Ok(AerofoilSection { name, points, nose, listing })
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
        assert_eq!((a.name.as_str(), b.name.as_str()), ("ÉTUDE 12", "NAME"));
        let short = b"NAME\n 4. 3.\n 0 0\n 0.5 0.1\n 1 0\n 0 0\n 0.4 -0.05\n 1 0\n";
        let error = read_aerofoil(short).unwrap_err();
        assert_eq!((error.place, error.found.as_str()), (FilePosition::Line(2), "6 points"));
        assert_eq!(read_aerofoil(b"X\n1 0\n0 0 0\n").unwrap_err().place, FilePosition::Line(3));
        assert!(
            read_aerofoil(b"X\n0 0\n1 0\n2 0\n3 1\n4 1\n")
                .unwrap_err()
                .found
                .contains("leading edge")
        );
        assert!(read_aerofoil(b"").is_err());
    }
}
