//! Plot3D in, as text: numbers with Fortran's repeat counts and exponents.

use super::read::{SOLUTION, fill, sizes, solution_numbers};
use super::variant::{FORMAT, Laid, Variant};
use crate::{FilePosition, ReadError, StructuredGrid};

/// A word of the text: a number, with a repeat count, and its line.
struct TextNumbers {
    values: Vec<f64>,
    whole: Vec<bool>,
    lines: Vec<u32>,
}

/// A repeat count may not make more numbers than this out of a file.
const MOST_REPEATED: usize = 1 << 27;

fn words(bytes: &[u8]) -> Result<TextNumbers, ReadError> {
    let mut all = TextNumbers { values: Vec::new(), whole: Vec::new(), lines: Vec::new() };
    let text = std::str::from_utf8(bytes).unwrap_or("");
    for (number, line) in (1..).zip(text.lines()) {
        for word in line.split(|c: char| c.is_whitespace() || c == ',' || c == ';') {
            if word.is_empty() {
                continue;
            }
            let error = |expected: &str| ReadError {
                format: FORMAT,
                place: FilePosition::Line(number),
                expected: expected.into(),
                found: format!("`{word}`"),
            };
            // Fortran writes `3*0.0` for three equal numbers, and D for the exponent of a double.
            let (times, value) = match word.split_once('*') {
                Some((times, value)) => {
                    (times.parse::<usize>().map_err(|_| error("a repeat count"))?, value)
                }
                None => (1, word),
            };
            let whole = value.bytes().all(|b| b.is_ascii_digit() || b == b'-' || b == b'+');
            let value: f64 =
                value.replace(['d', 'D'], "e").parse().map_err(|_| error("a number"))?;
            if !value.is_finite() {
                return Err(error("a finite number"));
            }
            if times > MOST_REPEATED || all.values.len() + times > MOST_REPEATED.max(bytes.len()) {
                return Err(error("fewer repeated numbers"));
            }
            for _ in 0..times {
                all.values.push(value);
                all.whole.push(whole);
                all.lines.push(number as u32);
            }
        }
    }
    Ok(all)
}

/// A reading whose sizes require another number of values.
struct Misfit {
    ends_line: bool,
    left: usize,
    wanted: u128,
    multi: bool,
    axes: usize,
    solution: bool,
}

impl Misfit {
    fn rank(&self) -> (bool, bool, u128) {
        (!self.solution, !self.ends_line, self.wanted.abs_diff(self.left as u128))
    }
}

pub(super) fn read_text(bytes: &[u8]) -> Result<(Vec<StructuredGrid>, Variant), ReadError> {
    let words = words(bytes)?;
    let count = words.values.len();
    let whole = |k: usize| -> Option<i64> {
        let x = *words.values.get(k)?;
        (words.whole[k] && x.abs() < 1e15).then_some(x as i64)
    };
    // Among readings that do not fit: one whose sizes end with their line, then the nearest in
    // number.
    let mut nearest: Option<Misfit> = None;
    // One number in the first line and several in the next: the number of blocks, then sizes.
    let line = |k: usize| words.lines.get(k);
    let alone = line(0) != line(1) && line(1).is_some() && line(1) == line(2);
    for multi in [true, false] {
        if alone && !multi {
            continue;
        }
        for axes in [3, 2] {
            let blocks = if multi { whole(0).unwrap_or(0) } else { 1 };
            let start = usize::from(multi);
            let Some(header) =
                usize::try_from(blocks).ok().and_then(|b| b.checked_mul(axes)).filter(|h| *h > 0)
            else {
                continue;
            };
            if start + header > count {
                continue;
            }
            let Some(sizes) = (0..header)
                .map(|k| whole(start + k))
                .collect::<Option<Vec<i64>>>()
                .and_then(|w| sizes(&w, axes))
            else {
                continue;
            };
            let points: u128 = sizes.iter().map(|s| s.iter().product::<usize>() as u128).sum();
            let left = count - start - header;
            for iblank in [false, true] {
                let each = axes + usize::from(iblank);
                let wanted = points * each as u128;
                if wanted != left as u128 {
                    let ends_line = line(start + header - 1) != line(start + header);
                    let solution =
                        solution_numbers(points, sizes.len(), axes) == left as u128 && ends_line;
                    let misfit = Misfit { ends_line, left, wanted, multi, axes, solution };
                    if nearest.as_ref().is_none_or(|other| misfit.rank() < other.rank()) {
                        nearest = Some(misfit);
                    }
                    continue;
                }
                let mut at = start + header;
                let mut all = Vec::new();
                let mut sound = true;
                for size in &sizes {
                    let mut block =
                        StructuredGrid { size: *size, planes: Default::default(), iblank: None };
                    let n = block.count();
                    for plane in block.planes.iter_mut().take(axes) {
                        plane.extend_from_slice(&words.values[at..at + n]);
                        at += n;
                    }
                    if iblank {
                        sound &= words.whole[at..at + n].iter().all(|w| *w);
                        let blank = words.values[at..at + n].iter().map(|x| *x as i32);
                        block.iblank = Some(blank.collect());
                        at += n;
                    }
                    fill(&mut block, axes);
                    all.push(block);
                }
                if sound {
                    let three = axes == 3;
                    let laid = Laid::Formatted;
                    let variant = Variant { laid, multi, three, iblank, ..Variant::default() };
                    return Ok((all, variant));
                }
            }
        }
    }
    let line = words.lines.last().copied().unwrap_or(1) as usize;
    let error = |expected: String, found: String| ReadError {
        format: FORMAT,
        place: FilePosition::Line(line),
        expected,
        found,
    };
    Err(match nearest {
        Some(Misfit { left, wanted, multi, axes, solution, .. }) => error(
            format!(
                "{wanted} coordinates after the sizes ({}, {axes}-D)",
                if multi { "multi-block" } else { "single-block" }
            ),
            match (left as u128).checked_sub(wanted) {
                _ if solution => SOLUTION.into(),
                Some(more) => format!("{left} numbers, {more} too many"),
                None => format!("{left} numbers"),
            },
        ),
        None => error("the sizes of a grid".into(), "numbers that are not sizes".into()),
    })
}
