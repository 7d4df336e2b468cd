//! Plot3D in: which variant the bytes are, and the grids that they hold.
//!
//! Text is distinguished from binary by its bytes; binary files are tried as Fortran records in both byte
//! orders and mark sizes, then as plain numbers.

use super::read_text::read_text;
use super::variant::{FORMAT, Laid, Variant};
use crate::{FilePosition, ReadError, StructuredGrid};

/// The blocks of a file, and its variant.
///
/// Memory grows with the bytes that are there, whatever the sizes in the file say.
///
/// # Errors
/// Data without a valid reading: with the closest reading, and what it would expect.
pub fn read(bytes: &[u8]) -> Result<(Vec<StructuredGrid>, Variant), ReadError> {
    if looks_like_text(bytes) {
        return read_text(bytes);
    }
    let mut complaints: Vec<Complaint> = Vec::new();
    let mut readings: Vec<(Vec<StructuredGrid>, Variant)> = Vec::new();
    for big_endian in [false, true] {
        for mark in [4, 8] {
            match records(bytes, big_endian, mark) {
                Ok(found) => {
                    readings.extend(of_records(bytes, &found, big_endian, mark, &mut complaints))
                }
                Err(complaint) => complaints.extend(complaint),
            }
        }
    }
    if readings.is_empty() {
        for big_endian in [false, true] {
            for multi in [true, false] {
                for three in [true, false] {
                    of_stream(bytes, big_endian, multi, three, &mut readings, &mut complaints);
                }
            }
        }
    }
    // Stable: of equally plausible readings the first one tried.
    readings.sort_by_key(|(blocks, _)| !plausible(blocks));
    if let Some((blocks, variant)) = readings.into_iter().next() {
        return finite(&blocks).map(|()| (blocks, variant));
    }
    complaints.sort_by_key(|c| c.rank);
    Err(complaints.into_iter().next().map_or_else(
        || ReadError {
            format: FORMAT,
            place: FilePosition::Byte(0),
            expected: "the sizes of a grid, as text or as binary numbers".into(),
            found: match bytes.len() {
                0 => "an empty file".into(),
                1 => "one byte".into(),
                n => format!("{n} bytes, which match no variant"),
            },
        },
        |c| c.error,
    ))
}

/// Reason why an interpretation failed; the one that parsed furthest is reported.
struct Complaint {
    rank: usize,
    error: ReadError,
}

fn complaint(rank: usize, byte: usize, expected: String, found: String) -> Complaint {
    Complaint {
        rank,
        error: ReadError { format: FORMAT, place: FilePosition::Byte(byte), expected, found },
    }
}

/// Text begins with a number and has only text bytes: binary sizes have zeros.
fn looks_like_text(bytes: &[u8]) -> bool {
    let of_text = |b: &u8| b.is_ascii_graphic() || b" \t\r\n\x0c".contains(b);
    let first = bytes.trim_ascii_start().first();
    first.is_some_and(|b| b.is_ascii_digit() || *b == b'+') && bytes.iter().all(of_text)
}

/// Refuses numbers that are not finite, with the first position.
fn finite(blocks: &[StructuredGrid]) -> Result<(), ReadError> {
    for (number, block) in blocks.iter().enumerate() {
        for (axis, plane) in ["x", "y", "z"].iter().zip(&block.planes) {
            let Some(at) = plane.iter().position(|x| !x.is_finite()) else { continue };
            let [ni, nj, _] = block.size;
            let [i, j, k] = [at % ni + 1, at / ni % nj + 1, at / ni / nj + 1];
            let (number, x) = (number + 1, plane[at]);
            return Err(ReadError {
                format: FORMAT,
                place: FilePosition::Block(number),
                expected: "finite coordinates".into(),
                found: format!("{axis} = {x} at point [{i},{j},{k}]"),
            });
        }
    }
    Ok(())
}

/// True for coordinates as grids have them: finite, neither huge nor next to nothing.
fn plausible(blocks: &[StructuredGrid]) -> bool {
    let sound = |x: &f64| x.abs() < 1e15 && (*x == 0.0 || x.abs() > 1e-40);
    blocks.iter().all(|b| b.planes.iter().flatten().all(sound))
        && blocks.iter().all(|b| b.iblank.iter().flatten().all(|x| x.abs() < 1_000_000))
}

fn integer(bytes: &[u8], at: usize, big_endian: bool) -> Option<i64> {
    let four: [u8; 4] = bytes.get(at..at.checked_add(4)?)?.try_into().ok()?;
    Some(i64::from(if big_endian { i32::from_be_bytes(four) } else { i32::from_le_bytes(four) }))
}

fn mark_at(bytes: &[u8], at: usize, big_endian: bool, mark: usize) -> Option<i64> {
    if mark == 4 {
        return integer(bytes, at, big_endian);
    }
    let eight: [u8; 8] = bytes.get(at..at.checked_add(8)?)?.try_into().ok()?;
    Some(if big_endian { i64::from_be_bytes(eight) } else { i64::from_le_bytes(eight) })
}

/// A record: the stretches of the file that hold it (more than one beyond 2 GiB).
struct FortranRecord {
    parts: Vec<std::ops::Range<usize>>,
}

impl FortranRecord {
    fn len(&self) -> usize {
        self.parts.iter().map(|p| p.len()).sum()
    }

    fn start(&self) -> usize {
        self.parts[0].start
    }
}

/// The records of the file; an empty error when it does not begin with one.
fn records(
    bytes: &[u8],
    big_endian: bool,
    mark: usize,
) -> Result<Vec<FortranRecord>, Option<Complaint>> {
    let mut all: Vec<FortranRecord> = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let mut parts = Vec::new();
        loop {
            // The first record of any variant has 4, 8 or 12 n bytes and ends with its own mark.
            let known = all.len() >= 2;
            let wrong =
                |expected: String, found: String| known.then(|| complaint(1, at, expected, found));
            let Some(lead) = mark_at(bytes, at, big_endian, mark) else {
                return Err(wrong("a record".into(), "the end of the file".into()));
            };
            // A negative length: the record is continued (gfortran, beyond 2 GiB).
            let length = usize::try_from(lead.unsigned_abs()).unwrap_or(usize::MAX);
            let start = at + mark;
            let end = start.checked_add(length).filter(|end| end + mark <= bytes.len());
            let Some(end) = end else {
                let left = bytes.len().saturating_sub(start);
                return Err(wrong(
                    format!("a record of {length} bytes"),
                    format!("{left} bytes up to the end of the file"),
                ));
            };
            let trail = mark_at(bytes, end, big_endian, mark).unwrap_or(0);
            if trail.unsigned_abs() != lead.unsigned_abs() {
                return Err(wrong(
                    format!("{length} again after a record of {length} bytes"),
                    trail.to_string(),
                ));
            }
            parts.push(start..end);
            at = end + mark;
            if lead >= 0 {
                break;
            }
        }
        all.push(FortranRecord { parts });
        if all.len() == 1 && !matches!(all[0].len(), 4 | 8 | 12) {
            return Err(None);
        }
    }
    if all.len() < 2 { Err(None) } else { Ok(all) }
}

fn joined<'a>(bytes: &'a [u8], record: &FortranRecord) -> std::borrow::Cow<'a, [u8]> {
    match &record.parts[..] {
        [one] => bytes[one.clone()].into(),
        many => many.iter().flat_map(|p| &bytes[p.clone()]).copied().collect::<Vec<u8>>().into(),
    }
}

/// Sizes from a header; `None` unless all are positive and their points can be counted.
pub(super) fn sizes(words: &[i64], axes: usize) -> Option<Vec<[usize; 3]>> {
    let mut all = Vec::new();
    for size in words.chunks(axes) {
        let mut block = [1; 3];
        for (n, word) in block.iter_mut().zip(size) {
            *n = usize::try_from(*word).ok().filter(|n| *n > 0)?;
        }
        let points = block.iter().try_fold(1u64, |count, n| count.checked_mul(*n as u64));
        points.filter(|c| *c < 1 << 40)?;
        all.push(block);
    }
    Some(all)
}

/// Numbers in front of a block of a solution file: Mach number, angle of attack, Reynolds number, time.
const FLOW_CONDITIONS: u128 = 4;

/// The number of numbers that a solution (q) file has after its sizes: the flow conditions and, for
/// each point, density, momentum and energy.
pub(super) fn solution_numbers(points: u128, blocks: usize, axes: usize) -> u128 {
    points * (axes as u128 + 2) + FLOW_CONDITIONS * blocks as u128
}

/// A file that is a solution instead.
pub(super) const SOLUTION: &str = "flow conditions and the values of a flow: this is a solution (q) file, its grid is another file";

fn of_records(
    bytes: &[u8],
    records: &[FortranRecord],
    big_endian: bool,
    mark: usize,
    complaints: &mut Vec<Complaint>,
) -> Option<(Vec<StructuredGrid>, Variant)> {
    let words = |record: &FortranRecord| -> Vec<i64> {
        let data = joined(bytes, record);
        (0..data.len() / 4).filter_map(|k| integer(&data, 4 * k, big_endian)).collect()
    };
    let first = words(&records[0]);
    let (multi, size_record) = match first[..] {
        [count] => {
            let second = records.get(1)?;
            let fits = |axes: usize| second.len() as i64 == 4 * axes as i64 * count;
            if !(count > 0 && (fits(2) || fits(3))) {
                complaints.push(complaint(
                    1,
                    second.start(),
                    format!(
                        "a record of {} or {} bytes: the sizes of {count} blocks",
                        12 * count,
                        8 * count
                    ),
                    format!("{} bytes", second.len()),
                ));
                return None;
            }
            (true, 1)
        }
        _ => (false, 0),
    };
    let header = words(&records[size_record]);
    let axes = if multi { header.len() / first[0] as usize } else { header.len() };
    let sizes = sizes(&header, axes)?;
    let mut rest = records[size_record + 1..].iter();
    let mut variant: Option<Variant> = None;
    let mut blocks = Vec::new();
    for (number, size) in sizes.iter().enumerate() {
        let count: usize = size.iter().product();
        let plane = size[0] * size[1];
        let Some(record) = rest.next() else {
            complaints.push(complaint(
                0,
                bytes.len(),
                format!("the coordinates of block {} of {}", number + 1, sizes.len()),
                "the end of the file".into(),
            ));
            return None;
        };
        let made = |double: bool, iblank: bool, planes: bool| Variant {
            laid: Laid::Unformatted,
            double,
            multi,
            three: axes == 3,
            iblank,
            big_endian,
            mark,
            planes,
        };
        let width =
            |v: &Variant| axes * if v.double { 8 } else { 4 } + if v.iblank { 4 } else { 0 };
        let here = match variant {
            Some(known) => Some(known),
            None => {
                let options = [(true, false), (false, false), (true, true), (false, true)];
                let find = |n: usize, planes: bool| {
                    let all = options.iter().map(|(d, b)| made(*d, *b, planes));
                    all.into_iter().find(|v| record.len() == n * width(v))
                };
                find(count, false).or_else(|| find(plane, true).filter(|_| size[2] > 1))
            }
        };
        let expected = || {
            let each = |w: usize| (count * axes * w).to_string();
            format!(
                "a record of {} (double) or {} bytes (single) for block {} of [{},{},{}]",
                each(8),
                each(4),
                number + 1,
                size[0],
                size[1],
                size[2]
            )
        };
        let Some(here) = here else {
            let next = rest.clone().next().map_or(0, FortranRecord::len);
            let solution = [4, 8].into_iter().any(|width| {
                (record.len(), next)
                    == (FLOW_CONDITIONS as usize * width, count * (axes + 2) * width)
            });
            let found = if solution { SOLUTION.into() } else { format!("{} bytes", record.len()) };
            complaints.push(complaint(0, record.start(), expected(), found));
            return None;
        };
        let (step, layers) = if here.planes { (plane, size[2]) } else { (count, 1) };
        let mut block = StructuredGrid { size: *size, planes: Default::default(), iblank: None };
        let mut record = Some(record);
        for _ in 0..layers {
            let this = record.take().or_else(|| rest.next());
            let Some(this) = this.filter(|r| r.len() == step * width(&here)) else {
                complaints.push(complaint(0, bytes.len(), expected(), "another length".into()));
                return None;
            };
            take(&joined(bytes, this), 0, step, &here, &mut block);
        }
        fill(&mut block, axes);
        variant = Some(here);
        blocks.push(block);
    }
    if let Some(extra) = rest.next() {
        complaints.push(complaint(
            0,
            extra.start(),
            "the end of the file".into(),
            format!("another record of {} bytes", extra.len()),
        ));
        return None;
    }
    variant.map(|variant| (blocks, variant))
}

/// Appends `count` points from the bytes at `at` on; the bytes are there.
fn take(data: &[u8], at: usize, count: usize, variant: &Variant, block: &mut StructuredGrid) {
    let width = if variant.double { 8 } else { 4 };
    let axes = if variant.three { 3 } else { 2 };
    for (axis, plane) in block.planes.iter_mut().enumerate().take(axes) {
        let start = at + axis * count * width;
        plane.extend(data[start..start + count * width].chunks_exact(width).map(|x| {
            let mut eight = [0; 8];
            eight[..width].copy_from_slice(x);
            if variant.big_endian {
                eight[..width].reverse();
            }
            if variant.double {
                f64::from_le_bytes(eight)
            } else {
                f64::from(f32::from_le_bytes([eight[0], eight[1], eight[2], eight[3]]))
            }
        }));
    }
    if variant.iblank {
        let start = at + axes * count * width;
        let blank = block.iblank.get_or_insert_with(Vec::new);
        let words = (0..count).filter_map(|k| integer(data, start + 4 * k, variant.big_endian));
        blank.extend(words.map(|x| x as i32));
    }
}

/// A 2-D grid is in z = 0.
pub(super) fn fill(block: &mut StructuredGrid, axes: usize) {
    if axes == 2 {
        block.planes[2] = vec![0.0; block.count()];
    }
}

fn of_stream(
    bytes: &[u8],
    big_endian: bool,
    multi: bool,
    three: bool,
    readings: &mut Vec<(Vec<StructuredGrid>, Variant)>,
    complaints: &mut Vec<Complaint>,
) {
    let axes = if three { 3 } else { 2 };
    let blocks = if multi { integer(bytes, 0, big_endian).unwrap_or(0) } else { 1 };
    let start = if multi { 4 } else { 0 };
    let Ok(blocks) = usize::try_from(blocks) else { return };
    // The sizes must be in the file before memory is taken for them.
    let Some(header) = blocks.checked_mul(4 * axes).filter(|h| *h > 0 && start + h <= bytes.len())
    else {
        return;
    };
    let words: Vec<i64> =
        (0..blocks * axes).filter_map(|k| integer(bytes, start + 4 * k, big_endian)).collect();
    let Some(sizes) = sizes(&words, axes) else { return };
    let points: u128 = sizes.iter().map(|s| s.iter().product::<usize>() as u128).sum();
    let left = bytes.len() - start - header;
    let mut fits = false;
    for (double, iblank) in [(true, false), (false, false), (true, true), (false, true)] {
        let width = axes * if double { 8 } else { 4 } + if iblank { 4 } else { 0 };
        if points * width as u128 != left as u128 {
            continue;
        }
        fits = true;
        let variant = Variant {
            laid: Laid::Stream,
            double,
            multi,
            three,
            iblank,
            big_endian,
            mark: 4,
            planes: false,
        };
        let mut at = start + header;
        let mut all = Vec::new();
        for size in &sizes {
            let mut block =
                StructuredGrid { size: *size, planes: Default::default(), iblank: None };
            let count = block.count();
            take(bytes, at, count, &variant, &mut block);
            fill(&mut block, axes);
            at += count * width;
            all.push(block);
        }
        readings.push((all, variant));
    }
    // Sizes that require slightly more or less than the available data: a truncated file, or
    // further data at the end.
    let per_point = left as f64 / points as f64;
    if !fits && points > 1 && (1.0..100.0).contains(&per_point) {
        let width = axes as u128 * if per_point < 5.0 * axes as f64 { 4 } else { 8 };
        let kind = if multi { "multi-block" } else { "single-block" };
        let numbers = solution_numbers(points, blocks, axes);
        let solution = [4 * numbers, 8 * numbers].contains(&(left as u128));
        complaints.push(complaint(
            if solution { 0 } else { 2 },
            start + header,
            format!(
                "{} bytes of coordinates for {points} points ({kind}, {axes}-D, {} precision)",
                points * width,
                if width / axes as u128 == 8 { "double" } else { "single" }
            ),
            if solution { SOLUTION.into() } else { format!("{left} bytes") },
        ));
    }
}
