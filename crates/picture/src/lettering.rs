//! Names on pictures, in letters of single strokes.
//!
//! A letter is in a grid of 5 columns (0 to 4) and 9 rows: descenders extend to row 0, the base
//! line is row 2, small letters are as high as row 6, capitals and digits as row 8.

use crate::camera::ScreenPoint;
use crate::raster::Raster;
use moldloft_num::Vec3;

/// A name beside a point of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct PointName {
    /// The point.
    pub at: Vec3,
    /// The name; characters that cannot occur in names of the language are drawn as boxes.
    pub text: String,
    /// sRGB colour.
    pub colour: [u8; 3],
}

/// Samples (half picture points) a column or row: capitals are 8 picture points high.
const UNIT: f32 = 2.6;
/// Columns from one letter to the next.
const ADVANCE: f32 = 5.6;
/// Samples between a point and its name.
const CLEAR: f32 = 9.0;

/// The strokes of a letter: points `xy` joined by blanks, strokes by `;`.
fn strokes(letter: char) -> &'static str {
    match letter {
        'A' => "02 28 42;14 34",
        'B' => "02 08 38 47 46 35 05;35 44 43 32 02",
        'C' => "47 38 18 07 03 12 32 43",
        'D' => "02 08 28 46 44 22 02",
        'E' => "48 08 02 42;05 35",
        'F' => "48 08 02;05 35",
        'G' => "47 38 18 07 03 12 32 43 45 25",
        'H' => "02 08;42 48;05 45",
        'I' => "12 32;18 38;22 28",
        'J' => "48 43 32 12 03",
        'K' => "02 08;48 05 42",
        'L' => "08 02 42",
        'M' => "02 08 25 48 42",
        'N' => "02 08 42 48",
        'O' => "03 07 18 38 47 43 32 12 03",
        'P' => "02 08 38 47 46 35 05",
        'Q' => "03 07 18 38 47 43 32 12 03;24 42",
        'R' => "02 08 38 47 46 35 05;25 42",
        'S' => "47 38 18 07 06 15 35 44 43 32 12 03",
        'T' => "08 48;28 22",
        'U' => "08 03 12 32 43 48",
        'V' => "08 22 48",
        'W' => "08 12 26 32 48",
        'X' => "02 48;08 42",
        'Y' => "08 25 48;25 22",
        'Z' => "08 48 02 42",
        'a' => "16 36 45 42;44 14 03 12 32 43",
        'b' => "08 02;05 16 36 45 43 32 12 03",
        'c' => "45 36 16 05 03 12 32 43",
        'd' => "48 42;45 36 16 05 03 12 32 43",
        'e' => "04 44 45 36 16 05 03 12 32 43",
        'f' => "38 28 17 12;06 36",
        'g' => "46 41 30 10;45 36 16 05 03 12 32 43",
        'h' => "08 02;05 16 36 45 42",
        'i' => "22 26;28 28",
        'j' => "26 21 10;28 28",
        'k' => "08 02;46 04 42",
        'l' => "28 22",
        'm' => "02 06;05 16 25 22;25 36 45 42",
        'n' => "02 06;05 16 36 45 42",
        'o' => "03 05 16 36 45 43 32 12 03",
        'p' => "00 06;05 16 36 45 43 32 12 03",
        'q' => "40 46;45 36 16 05 03 12 32 43",
        'r' => "02 06;05 16 36",
        's' => "45 36 16 05 14 34 43 32 12 03",
        't' => "18 13 22 32;06 36",
        'u' => "06 03 12 32 43;46 42",
        'v' => "06 22 46",
        'w' => "06 12 25 32 46",
        'x' => "02 46;06 42",
        'y' => "06 22;46 10",
        'z' => "06 46 02 42",
        '0' => "03 07 18 38 47 43 32 12 03;13 37",
        '1' => "07 28 22;12 32",
        '2' => "07 18 38 47 46 02 42",
        '3' => "08 48 26 36 45 43 32 12 03",
        '4' => "32 38 04 44",
        '5' => "48 08 05 35 44 43 32 12 03",
        '6' => "38 18 05 03 12 32 43 44 35 05",
        '7' => "08 48 12",
        '8' => "15 06 07 18 38 47 46 35 15 04 03 12 32 43 44 35",
        '9' => "12 32 45 47 38 18 07 06 15 45",
        '_' => "01 41",
        '.' => "22 22",
        '-' => "15 35",
        ' ' => "",
        _ => "02 06 46 42 02",
    }
}

/// A rectangle of samples: left, top, right, bottom.
type Area = [f32; 4];

fn apart(a: Area, b: Area) -> bool {
    a[2] < b[0] || b[2] < a[0] || a[3] < b[1] || b[3] < a[1]
}

/// Writes names beside their points (`seen`, in samples), the first ones first: above right, above
/// left, below right or below left, where no other name or point is. Without a free position a name
/// is left out.
pub(crate) fn write(
    raster: &mut Raster,
    labels: &[(&PointName, [f32; 2])],
    width: f32,
    height: f32,
) {
    let mut taken: Vec<Area> =
        labels.iter().map(|(_, [x, y])| [x - 5.0, y - 5.0, x + 5.0, y + 5.0]).collect();
    for (label, [x, y]) in labels {
        let broad = ((label.text.chars().count() as f32 - 1.0) * ADVANCE + 4.0) * UNIT;
        let high = 6.0 * UNIT;
        let places = [[1.0, -1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[right, down]| {
            let left = if right > 0.0 { x + CLEAR } else { x - CLEAR - broad };
            let top = if down > 0.0 { y + CLEAR } else { y - CLEAR - high };
            [left, top, left + broad, top + high]
        });
        let free = places.into_iter().find(|&[left, top, right, bottom]| {
            let around = [left - 2.0, top - 2.0, right + 2.0, bottom + 2.0];
            left > 2.0
                && top > 2.0
                && right < width - 2.0
                && bottom < height - 2.0
                && taken.iter().all(|&other| apart(around, other))
        });
        let Some(area) = free else { continue };
        taken.push(area);
        // A light rim first, so that names are read on dark surfaces as well.
        for (half_width, colour) in [(4.2, [0xfc, 0xfd, 0xfe]), (1.25, label.colour)] {
            for (k, letter) in label.text.chars().enumerate() {
                let at = |place: &str| {
                    let [column, row] = [0, 1].map(|n| f32::from(place.as_bytes()[n] - b'0'));
                    ScreenPoint {
                        x: area[0] + (k as f32 * ADVANCE + column) * UNIT,
                        y: area[3] - (row - 2.0) * UNIT,
                        near: f32::MAX,
                    }
                };
                for stroke in strokes(letter).split(';') {
                    let points: Vec<ScreenPoint> = stroke.split_whitespace().map(at).collect();
                    for ends in points.windows(2) {
                        raster.line(ends[0], ends[1], half_width, [0.0, f32::INFINITY], colour);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_stay_in_their_grid() {
        for letter in ('!'..='~').chain(['é']) {
            for place in strokes(letter).split([' ', ';']).filter(|place| !place.is_empty()) {
                let &[x, y] = place.as_bytes() else { panic!("{letter}: {place}") };
                assert!(
                    (b'0'..=b'4').contains(&x) && (b'0'..=b'8').contains(&y),
                    "{letter}: {place}"
                );
            }
        }
    }

    #[test]
    fn letters_of_names_differ() {
        let names = ('a'..='z').chain('A'..='Z').chain('0'..='9').chain(['_']);
        let all: std::collections::BTreeSet<&str> = names.clone().map(strokes).collect();
        assert_eq!(all.len(), names.count());
        assert!(!all.contains(strokes('é')));
    }
}
