//! Plot3D grids in every variant: text, plain binary or Fortran records; single or double precision;
//! one block or several; two or three coordinates; with or without blanking; both byte orders; whole
//! blocks or plane by plane.
//!
//! The format says none of this about itself. The reader tries what the bytes can mean, and takes
//! what fits to the byte: record marks, sizes and counts against the length of the file, and, where
//! more than one reading fits, coordinates that look like coordinates.
//!
//! Layout: Walatka et al. 1990, PLOT3D User's Manual, NASA TM 101067, chapter 8.

use crate::lattice::Lattice;
use crate::text::real;
use crate::{Place, ReadError, WriteError};

const FORMAT: &str = "Plot3D";

/// How the numbers are laid down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Laid {
    /// Text.
    Formatted,
    /// Plain numbers, as C writes them.
    #[default]
    Stream,
    /// Records as a Fortran program writes them, each with its length before and after.
    Unformatted,
}

/// Everything that the format leaves open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// How the numbers are laid down.
    pub laid: Laid,
    /// Double precision; single otherwise. Text has either.
    pub double: bool,
    /// The number of blocks comes first; without, there is one block.
    pub multi: bool,
    /// Three sizes and coordinates; two otherwise.
    pub three: bool,
    /// A whole number for each point follows its block's coordinates.
    pub iblank: bool,
    /// The most significant byte comes first.
    pub big_endian: bool,
    /// Bytes of a record's length: 4 or 8.
    pub mark: usize,
    /// Coordinates come plane by plane, k = 1 first: of records a record each.
    pub planes: bool,
}

impl Default for Variant {
    fn default() -> Self {
        Self {
            laid: Laid::Stream,
            double: true,
            multi: true,
            three: true,
            iblank: false,
            big_endian: false,
            mark: 4,
            planes: false,
        }
    }
}

impl std::fmt::Display for Variant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let word = |yes: bool, a: &'static str, b: &'static str| if yes { a } else { b };
        let blocks = word(self.multi, "multi-block", "single-block");
        let dimension = word(self.three, "3-D", "2-D");
        match self.laid {
            Laid::Formatted => write!(f, "text, {blocks}, {dimension}")?,
            laid => {
                let laid = word(laid == Laid::Stream, "stream", "Fortran records");
                let precision = word(self.double, "double", "single");
                let order = word(self.big_endian, "big-endian", "little-endian");
                write!(f, "{laid}, {precision} precision, {order}, {blocks}, {dimension}")?;
                if self.laid == Laid::Unformatted && self.mark == 8 {
                    write!(f, ", marks of 8 bytes")?;
                }
            }
        }
        if self.iblank {
            write!(f, ", iblank")?;
        }
        if self.planes {
            write!(f, ", by planes")?;
        }
        Ok(())
    }
}

/// The file of these blocks.
///
/// # Errors
/// No blocks; coordinates that are not finite or beyond single precision; several blocks in a
/// single-block file; blocks that are no plane surfaces in a 2-D file; sizes beyond 31 bits.
pub fn write(blocks: &[Lattice], variant: Variant) -> Result<Vec<u8>, WriteError> {
    let single = !variant.double && variant.laid != Laid::Formatted;
    Lattice::check(blocks, if single { f64::from(f32::MAX) } else { f64::MAX })?;
    let cannot = |what| WriteError::CannotHold { format: FORMAT, what };
    if !variant.multi && blocks.len() != 1 {
        return Err(cannot("several blocks in a single-block file"));
    }
    for block in blocks {
        let flat = block.size[2] == 1 && block.planes[2].iter().all(|z| *z == 0.0);
        if !variant.three && !flat {
            return Err(cannot("z in a 2-D file"));
        }
        if variant.iblank && block.iblank.as_ref().is_some_and(|b| b.len() != block.count()) {
            return Err(cannot("blanking of some points only"));
        }
    }
    let mut out = Out { variant, bytes: Vec::new() };
    let integer = |n: usize| {
        i32::try_from(n).map_err(|_| WriteError::TooLarge { what: "points of a block", count: n })
    };
    let axes = if variant.three { 3 } else { 2 };
    let mut sizes = Vec::new();
    for block in blocks {
        for n in &block.size[..axes] {
            sizes.push(integer(*n)?);
        }
    }
    if variant.multi {
        out.record(&[Part::Integers(&[integer(blocks.len())?])])?;
    }
    out.record(&[Part::Integers(&sizes)])?;
    for block in blocks {
        let ones;
        let blank = match &block.iblank {
            Some(blank) => blank,
            None => {
                ones = vec![1; block.count()];
                &ones
            }
        };
        let [ni, nj, nk] = block.size;
        let (step, layers) = if variant.planes { (ni * nj, nk) } else { (block.count(), 1) };
        for layer in 0..layers {
            let range = layer * step..(layer + 1) * step;
            let mut parts: Vec<Part> = block.planes[..axes]
                .iter()
                .map(|plane| Part::Reals(&plane[range.clone()]))
                .collect();
            if variant.iblank {
                parts.push(Part::Integers(&blank[range.clone()]));
            }
            out.record(&parts)?;
        }
    }
    Ok(out.bytes)
}

enum Part<'a> {
    Integers(&'a [i32]),
    Reals(&'a [f64]),
}

struct Out {
    variant: Variant,
    bytes: Vec<u8>,
}

impl Out {
    fn put<const N: usize>(&mut self, little: [u8; N]) {
        let mut bytes = little;
        if self.variant.big_endian {
            bytes.reverse();
        }
        self.bytes.extend_from_slice(&bytes);
    }

    fn mark(&mut self, length: usize) -> Result<(), WriteError> {
        if self.variant.laid != Laid::Unformatted {
            return Ok(());
        }
        if self.variant.mark == 8 {
            self.put((length as u64).to_le_bytes());
            return Ok(());
        }
        let length = i32::try_from(length)
            .map_err(|_| WriteError::TooLarge { what: "bytes of a record", count: length })?;
        self.put(length.to_le_bytes());
        Ok(())
    }

    fn record(&mut self, parts: &[Part]) -> Result<(), WriteError> {
        if self.variant.laid == Laid::Formatted {
            for part in parts {
                self.text(part);
            }
            return Ok(());
        }
        let width = if self.variant.double { 8 } else { 4 };
        let length = |part: &Part| match part {
            Part::Integers(all) => 4 * all.len(),
            Part::Reals(all) => width * all.len(),
        };
        let length = parts.iter().map(length).sum();
        self.mark(length)?;
        for part in parts {
            match part {
                Part::Integers(all) => all.iter().for_each(|x| self.put(x.to_le_bytes())),
                // Adding zero turns -0 into 0.
                Part::Reals(all) if self.variant.double => {
                    all.iter().for_each(|x| self.put((x + 0.0).to_le_bytes()));
                }
                Part::Reals(all) => {
                    all.iter().for_each(|x| self.put((*x as f32 + 0.0).to_le_bytes()))
                }
            }
        }
        self.mark(length)
    }

    fn text(&mut self, part: &Part) {
        let words: Vec<String> = match part {
            Part::Integers(all) => all.iter().map(|x| x.to_string()).collect(),
            Part::Reals(all) => all.iter().map(|x| real(*x)).collect(),
        };
        for line in words.chunks(6) {
            self.bytes.extend_from_slice(line.join(" ").as_bytes());
            self.bytes.push(b'\n');
        }
    }
}

/// The blocks of a file and which variant it is.
///
/// Memory grows with the bytes that are there, whatever the sizes in the file say.
///
/// # Errors
/// What no variant explains: with the reading that comes nearest, and what it would expect.
pub fn read(bytes: &[u8]) -> Result<(Vec<Lattice>, Variant), ReadError> {
    if looks_like_text(bytes) {
        return read_text(bytes);
    }
    let mut complaints: Vec<Complaint> = Vec::new();
    let mut readings: Vec<(Vec<Lattice>, Variant)> = Vec::new();
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
            place: Place::Byte(0),
            expected: "the sizes of a grid, as text or as binary numbers".into(),
            found: match bytes.len() {
                0 => "an empty file".into(),
                1 => "one byte".into(),
                n => format!("{n} bytes that no variant explains"),
            },
        },
        |c| c.error,
    ))
}

/// What speaks against a reading; those that came further count more.
struct Complaint {
    rank: usize,
    error: ReadError,
}

fn complaint(rank: usize, byte: usize, expected: String, found: String) -> Complaint {
    Complaint {
        rank,
        error: ReadError { format: FORMAT, place: Place::Byte(byte), expected, found },
    }
}

/// Text begins with a number, and no byte of it is none of a text's: sizes in binary have zeros.
fn looks_like_text(bytes: &[u8]) -> bool {
    let of_text = |b: &u8| b.is_ascii_graphic() || b" \t\r\n\x0c".contains(b);
    let first = bytes.trim_ascii_start().first();
    first.is_some_and(|b| b.is_ascii_digit() || *b == b'+') && bytes.iter().all(of_text)
}

/// Refuses what is no number, and tells where the first is.
fn finite(blocks: &[Lattice]) -> Result<(), ReadError> {
    for (number, block) in blocks.iter().enumerate() {
        for (axis, plane) in ["x", "y", "z"].iter().zip(&block.planes) {
            let Some(at) = plane.iter().position(|x| !x.is_finite()) else { continue };
            let [ni, nj, _] = block.size;
            let [i, j, k] = [at % ni + 1, at / ni % nj + 1, at / ni / nj + 1];
            let (number, x) = (number + 1, plane[at]);
            return Err(ReadError {
                format: FORMAT,
                place: Place::Block(number),
                expected: "finite coordinates".into(),
                found: format!("{axis} = {x} at point [{i},{j},{k}]"),
            });
        }
    }
    Ok(())
}

/// True for coordinates as grids have them: finite, neither huge nor next to nothing.
fn plausible(blocks: &[Lattice]) -> bool {
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
struct Record {
    parts: Vec<std::ops::Range<usize>>,
}

impl Record {
    fn len(&self) -> usize {
        self.parts.iter().map(|p| p.len()).sum()
    }

    fn start(&self) -> usize {
        self.parts[0].start
    }
}

/// The records of the file; an empty error when it does not begin with one.
fn records(bytes: &[u8], big_endian: bool, mark: usize) -> Result<Vec<Record>, Option<Complaint>> {
    let mut all: Vec<Record> = Vec::new();
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
            // A negative length: the record goes on (gfortran, beyond 2 GiB).
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
        all.push(Record { parts });
        if all.len() == 1 && !matches!(all[0].len(), 4 | 8 | 12) {
            return Err(None);
        }
    }
    if all.len() < 2 { Err(None) } else { Ok(all) }
}

/// Bytes of a record in order.
fn joined<'a>(bytes: &'a [u8], record: &Record) -> std::borrow::Cow<'a, [u8]> {
    match &record.parts[..] {
        [one] => bytes[one.clone()].into(),
        many => many.iter().flat_map(|p| &bytes[p.clone()]).copied().collect::<Vec<u8>>().into(),
    }
}

/// Sizes from a header; `None` unless all are positive and their points can be counted.
fn sizes(words: &[i64], axes: usize) -> Option<Vec<[usize; 3]>> {
    let mut all = Vec::new();
    for size in words.chunks(axes) {
        let mut block = [1; 3];
        for (n, word) in block.iter_mut().zip(size) {
            *n = usize::try_from(*word).ok().filter(|n| *n > 0)?;
        }
        block.iter().try_fold(1usize, |count, n| count.checked_mul(*n)).filter(|c| *c < 1 << 40)?;
        all.push(block);
    }
    Some(all)
}

fn of_records(
    bytes: &[u8],
    records: &[Record],
    big_endian: bool,
    mark: usize,
    complaints: &mut Vec<Complaint>,
) -> Option<(Vec<Lattice>, Variant)> {
    let words = |record: &Record| -> Vec<i64> {
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
            complaints.push(complaint(
                0,
                record.start(),
                expected(),
                format!("{} bytes", record.len()),
            ));
            return None;
        };
        let (step, layers) = if here.planes { (plane, size[2]) } else { (count, 1) };
        let mut block = Lattice { size: *size, planes: Default::default(), iblank: None };
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
fn take(data: &[u8], at: usize, count: usize, variant: &Variant, block: &mut Lattice) {
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

/// A 2-D grid lies in z = 0.
fn fill(block: &mut Lattice, axes: usize) {
    if axes == 2 {
        block.planes[2] = vec![0.0; block.count()];
    }
}

fn of_stream(
    bytes: &[u8],
    big_endian: bool,
    multi: bool,
    three: bool,
    readings: &mut Vec<(Vec<Lattice>, Variant)>,
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
            let mut block = Lattice { size: *size, planes: Default::default(), iblank: None };
            let count = block.count();
            take(bytes, at, count, &variant, &mut block);
            fill(&mut block, axes);
            at += count * width;
            all.push(block);
        }
        readings.push((all, variant));
    }
    // Sizes that ask for a little more or less than there is: cut off, or something else behind.
    let per_point = left as f64 / points as f64;
    if !fits && points > 1 && (1.0..100.0).contains(&per_point) {
        let width = axes as u128 * if per_point < 5.0 * axes as f64 { 4 } else { 8 };
        let kind = if multi { "multi-block" } else { "single-block" };
        complaints.push(complaint(
            2,
            start + header,
            format!(
                "{} bytes of coordinates for {points} points ({kind}, {axes}-D, {} precision)",
                points * width,
                if width / axes as u128 == 8 { "double" } else { "single" }
            ),
            format!("{left} bytes"),
        ));
    }
}

/// A word of the text: a number, perhaps several times over, and the line it stands in.
struct Words {
    values: Vec<f64>,
    whole: Vec<bool>,
    lines: Vec<u32>,
}

/// A repeat count may not make more numbers than this out of a file.
const MOST_REPEATED: usize = 1 << 27;

fn words(bytes: &[u8]) -> Result<Words, ReadError> {
    let mut all = Words { values: Vec::new(), whole: Vec::new(), lines: Vec::new() };
    let text = std::str::from_utf8(bytes).unwrap_or("");
    for (number, line) in (1..).zip(text.lines()) {
        for word in line.split(|c: char| c.is_whitespace() || c == ',' || c == ';') {
            if word.is_empty() {
                continue;
            }
            let error = |expected: &str| ReadError {
                format: FORMAT,
                place: Place::Line(number),
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

fn read_text(bytes: &[u8]) -> Result<(Vec<Lattice>, Variant), ReadError> {
    let words = words(bytes)?;
    let count = words.values.len();
    let whole = |k: usize| -> Option<i64> {
        let x = *words.values.get(k)?;
        (words.whole[k] && x.abs() < 1e15).then_some(x as i64)
    };
    let mut nearest: Option<(usize, u128, bool, usize)> = None;
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
                    let better = nearest.is_none_or(|(_, w, ..)| {
                        wanted.abs_diff(left as u128) < w.abs_diff(left as u128)
                    });
                    if better {
                        nearest = Some((left, wanted, multi, axes));
                    }
                    continue;
                }
                let mut at = start + header;
                let mut all = Vec::new();
                let mut sound = true;
                for size in &sizes {
                    let mut block =
                        Lattice { size: *size, planes: Default::default(), iblank: None };
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
        place: Place::Line(line),
        expected,
        found,
    };
    Err(match nearest {
        Some((left, wanted, multi, axes)) => error(
            format!(
                "{wanted} coordinates after the sizes ({}, {axes}-D)",
                if multi { "multi-block" } else { "single-block" }
            ),
            format!("{left} numbers"),
        ),
        None => error("the sizes of a grid".into(), "numbers that are no sizes".into()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blocks(three: bool, many: bool, deep: bool) -> Vec<Lattice> {
        let one = |m: usize, n: usize, k: usize, shift: f64| {
            let count = m * n * k;
            let plane = |c: usize| -> Vec<f64> {
                (0..count)
                    .map(|p| {
                        if c == 2 && !three { 0.0 } else { shift + 0.5 * p as f64 - 3.0 * c as f64 }
                    })
                    .collect()
            };
            let iblank = Some((0..count as i32).map(|p| p % 3 - 1).collect());
            Lattice { size: [m, n, k], planes: [plane(0), plane(1), plane(2)], iblank }
        };
        let k = if deep && three { 4 } else { 1 };
        let mut all = vec![one(5, 3, k, 0.25)];
        if many {
            all.push(one(2, 7, k, -8.0));
        }
        all
    }

    fn variants() -> Vec<Variant> {
        let mut all = Vec::new();
        for laid in [Laid::Formatted, Laid::Stream, Laid::Unformatted] {
            for bits in 0..128u32 {
                let bit = |k: u32| bits >> k & 1 == 1;
                let variant = Variant {
                    laid,
                    double: bit(0),
                    multi: bit(1),
                    three: bit(2),
                    iblank: bit(3),
                    big_endian: bit(4),
                    mark: if bit(5) { 8 } else { 4 },
                    planes: bit(6),
                };
                // What a layout has no notion of.
                let text = laid == Laid::Formatted && (!variant.double || variant.big_endian);
                let marks = laid != Laid::Unformatted && (variant.mark == 8 || variant.planes);
                let flat_planes = variant.planes && !variant.three;
                if !(text || marks || flat_planes) {
                    all.push(variant);
                }
            }
        }
        all
    }

    #[test]
    fn every_variant_is_recognised_and_comes_back() {
        let mut tried = 0;
        for variant in variants() {
            for deep in [false, true] {
                if variant.planes && !deep {
                    continue;
                }
                let mut given = blocks(variant.three, variant.multi, deep);
                if !variant.iblank {
                    given.iter_mut().for_each(|b| b.iblank = None);
                }
                let bytes = write(&given, variant).unwrap();
                let (back, found) = read(&bytes).unwrap_or_else(|e| panic!("{variant}: {e}"));
                assert_eq!(found, variant, "{variant} was taken for {found}");
                assert_eq!(back, given, "{variant}");
                assert_eq!(write(&back, found).unwrap(), bytes);
                tried += 1;
            }
        }
        assert!(tried > 120, "{tried}");
    }

    #[test]
    fn cut_off_and_damaged_files_are_refused() {
        for variant in variants() {
            let given = blocks(variant.three, variant.multi, variant.planes);
            let bytes = write(&given, variant).unwrap();
            for end in [0, 3, 9, bytes.len() / 2, bytes.len() - 1] {
                let cut = &bytes[..end];
                // Text may lose its last line end and nothing else.
                if variant.laid == Laid::Formatted && end == bytes.len() - 1 {
                    continue;
                }
                match read(cut) {
                    Err(error) => assert!(!error.expected.is_empty() && !error.found.is_empty()),
                    Ok((_, found)) => panic!("{variant} cut at {end} was taken for {found}"),
                }
            }
        }
        let text = b"1\n2 2 1\n0.5 1.5 0.5 1.5\n0.25 0.25 1.5 1.5\n0.5 0.5 0.5\n";
        let error = read(text).unwrap_err().to_string();
        assert!(error.contains("12 coordinates") && error.contains("11 numbers"), "{error}");
        let bytes = write(
            &blocks(true, true, false),
            Variant { laid: Laid::Unformatted, ..Variant::default() },
        )
        .unwrap();
        let error = read(&bytes[..bytes.len() - 60]).unwrap_err().to_string();
        assert!(error.contains("a record of"), "{error}");
        let stream = write(&blocks(true, true, false), Variant::default()).unwrap();
        let error = read(&stream[..stream.len() - 8]).unwrap_err().to_string();
        assert!(error.contains("bytes of coordinates"), "{error}");
        for damaged in crate::fixtures::damaged(&stream).take(400) {
            let _ = read(&damaged);
        }
        for damaged in crate::fixtures::damaged(text).take(400) {
            let _ = read(&damaged);
        }
        assert!(read(b"").is_err() && read(b"1 1000000000 1000000000 1").is_err());
        assert!(read(b"900000000*1").is_err());
    }

    #[test]
    fn what_is_no_number_is_told_with_its_place() {
        let mut given = blocks(true, true, false);
        given[1].planes[1][3] = 12345.678;
        for laid in [Laid::Stream, Laid::Unformatted] {
            let mut bytes = write(&given, Variant { laid, ..Variant::default() }).unwrap();
            let marked = 12345.678f64.to_le_bytes();
            let at = bytes.windows(8).position(|eight| eight == marked).unwrap();
            bytes[at..at + 8].copy_from_slice(&f64::NAN.to_le_bytes());
            let error = read(&bytes).unwrap_err();
            assert_eq!(error.place, Place::Block(2));
            assert_eq!(error.found, "y = NaN at point [2,2,1]");
        }
        for (word, expected) in
            [("nan", "a finite number"), ("1e999", "a finite number"), ("abc", "a number")]
        {
            let text = format!("1\n2 2 1\n1 2 3 4\n1 {word} 1 1\n0 0 0 0\n");
            let error = read(text.as_bytes()).unwrap_err();
            assert_eq!((error.place, error.expected.as_str()), (Place::Line(4), expected));
            assert_eq!(error.found, format!("`{word}`"));
        }
    }

    #[test]
    fn fortran_text_with_repeats_and_doubles() {
        let text = b" 2, 2\n 0.0D0 1.0D+00 2*0.5\n 2*0.0, 2*1.E0\n";
        let (blocks, variant) = read(text).unwrap();
        assert_eq!((variant.multi, variant.three), (false, false));
        assert_eq!(blocks[0].planes[0], [0.0, 1.0, 0.5, 0.5]);
        assert_eq!(blocks[0].planes[1], [0.0, 0.0, 1.0, 1.0]);
    }

    #[test]
    fn records_in_several_parts() {
        // gfortran splits what is beyond 2 GiB; here, each record of coordinates into two.
        let given = blocks(true, false, false);
        let one =
            Variant { laid: Laid::Unformatted, multi: false, iblank: true, ..Variant::default() };
        let whole = write(&given, one).unwrap();
        let data = &whole[24..whole.len() - 4];
        let (head, tail) = data.split_at(100);
        let mut split = whole[..20].to_vec();
        for (lead, part, trail) in
            [(-100i32, head, 100i32), (tail.len() as i32, tail, -(tail.len() as i32))]
        {
            split.extend(lead.to_le_bytes());
            split.extend_from_slice(part);
            split.extend(trail.to_le_bytes());
        }
        assert_eq!(read(&split).unwrap().0, given);
    }

    #[test]
    fn sizes_of_files() {
        let n = 60 * 20;
        let body = Lattice {
            size: [60, 20, 1],
            planes: [vec![0.5; n], vec![0.25; n], vec![1.5; n]],
            iblank: None,
        };
        let size = |variant: Variant| write(std::slice::from_ref(&body), variant).unwrap().len();
        let records = Variant { laid: Laid::Unformatted, ..Variant::default() };
        assert_eq!(size(Variant::default()), 28816);
        assert_eq!(size(records), 28840);
        assert_eq!(size(Variant { multi: false, ..records }), 28828);
        assert_eq!(size(Variant { iblank: true, ..records }), 28840 + 4800);
    }

    #[test]
    fn what_a_variant_cannot_hold_is_refused() {
        let deep = blocks(true, true, true);
        let single = Variant { multi: false, ..Variant::default() };
        assert!(matches!(write(&deep, single), Err(WriteError::CannotHold { .. })));
        let flat = Variant { three: false, ..Variant::default() };
        assert!(matches!(write(&deep, flat), Err(WriteError::CannotHold { .. })));
        assert!(matches!(write(&[], flat), Err(WriteError::NoGrid { .. })));
        let mut huge = blocks(true, false, false);
        huge[0].planes[1][3] = 1e200;
        let floats = Variant { double: false, ..Variant::default() };
        assert!(matches!(write(&huge, floats), Err(WriteError::NotFinite { vertex: 3, .. })));
    }
}
