//! Numbers and texts: their types, extents and positions.

use super::Hdf5File;
use super::bytes::{Cursor, fault};
use super::codes;
use super::header::Message;
use crate::ReadError;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StoredNumbers {
    /// Extents, the last running fastest.
    pub extents: Vec<usize>,
    /// All of them; characters are numbers, too.
    pub values: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct NumberType {
    /// 0 whole, 1 real, 3 text.
    class: u8,
    size: usize,
    big_endian: bool,
    signed: bool,
}

impl NumberType {
    fn read(at: &mut Cursor<'_>) -> Result<Self, ReadError> {
        let start = at.at;
        let class = at.byte()? & 15;
        let flags = at.number(3)?;
        let size = at.number(4)? as usize;
        let sound = match class {
            0 => [1, 2, 4, 8].contains(&size),
            1 => [4, 8].contains(&size) && flags & 64 == 0,
            3 => size > 0,
            _ => false,
        };
        if !sound {
            let found = format!("class {class} of {size} bytes");
            return Err(fault(start, "whole numbers, reals or texts", found));
        }
        Ok(Self { class, size, big_endian: flags & 1 != 0, signed: flags & 8 != 0 })
    }

    fn number(self, bytes: &[u8]) -> f64 {
        let raw = match self.big_endian {
            true => bytes.iter().fold(0u64, |sum, b| sum << 8 | u64::from(*b)),
            false => bytes.iter().rev().fold(0u64, |sum, b| sum << 8 | u64::from(*b)),
        };
        match (self.class, self.size) {
            (1, 4) => f64::from(f32::from_bits(raw as u32)),
            (1, _) => f64::from_bits(raw),
            _ if self.signed => {
                let unused = 64 - 8 * self.size as u32;
                ((raw << unused) as i64 >> unused) as f64
            }
            _ => raw as f64,
        }
    }
}

/// The extents of a dataspace; empty for a single value.
fn extents(at: &mut Cursor<'_>) -> Result<Vec<usize>, ReadError> {
    let start = at.at;
    let (version, rank, flags) = (at.byte()?, at.byte()?, at.byte()?);
    match version {
        1 => at.skip(5)?,
        2 => at.skip(1)?,
        other => return Err(fault(start, "a dataspace of version 1 or 2", other)),
    }
    if rank > 32 || flags > 3 {
        return Err(fault(start, "at most 32 extents", rank));
    }
    (0..rank).map(|_| Ok(usize::try_from(at.size()?).unwrap_or(usize::MAX))).collect()
}

/// The text of an attribute, if it has that name.
pub(super) fn text_attribute(
    message: &Message<'_>,
    name: &str,
) -> Result<Option<String>, ReadError> {
    let mut at = message.body;
    let start = at.at;
    let (version, flags) = (at.byte()?, at.byte()?);
    let sizes = [at.number(2)?, at.number(2)?, at.number(2)?];
    if version == 3 {
        at.skip(1)?;
    }
    // The first version pads its parts.
    let [own, kind, space] = sizes.map(|size| match version {
        1 => size.next_multiple_of(8) as usize,
        _ => size as usize,
    });
    let spelled = at.take(own)?;
    let end = spelled.iter().position(|b| *b == 0).unwrap_or(spelled.len());
    if &spelled[..end] != name.as_bytes() {
        return Ok(None);
    }
    if !(1..=3).contains(&version) || (version > 1 && flags & 3 != 0) {
        return Err(fault(start, "an attribute with its own type", format!("version {version}")));
    }
    let from = at.at;
    let kind_of = NumberType::read(&mut Cursor { at: from, ..at })?;
    let space_of = extents(&mut Cursor { at: from + kind, ..at })?;
    at.skip(kind + space)?;
    if kind_of.class != 3 || space_of.iter().any(|n| *n != 1) {
        return Err(fault(from, "a text", "numbers"));
    }
    let text = at.take(kind_of.size)?;
    let end = text.iter().position(|b| *b == 0).unwrap_or(text.len());
    Ok(Some(String::from_utf8_lossy(&text[..end]).trim_end().to_string()))
}

/// The numbers that the messages of an object describe.
pub(super) fn numbers<'a>(
    file: &Hdf5File<'a>,
    messages: &[Message<'a>],
) -> Result<StoredNumbers, ReadError> {
    let of = |kind: u16, what: &str| {
        let message = messages.iter().find(|message| message.kind == kind);
        message.copied().ok_or_else(|| fault(0, what, "an object without"))
    };
    let kind = of(codes::DATATYPE, "a type of numbers")?;
    if kind.shared {
        return Err(fault(kind.body.at, "a type of its own", "a committed type"));
    }
    let kind = NumberType::read(&mut kind.body.clone())?;
    let extents = extents(&mut of(codes::DATASPACE, "extents")?.body.clone())?;
    let count = extents.iter().try_fold(1usize, |all, n| all.checked_mul(*n));
    let bytes = count.and_then(|count| count.checked_mul(kind.size));
    let layout = of(codes::LAYOUT, "the layout of the numbers")?;
    let here = layout.body.at;
    let Some(bytes) = bytes.filter(|bytes| *bytes <= file.bytes.len().saturating_mul(1024)) else {
        return Err(fault(here, "no more numbers than bytes", format!("{extents:?} of them")));
    };
    let raw = stored(file, layout.body, &extents, kind.size, bytes, messages)?;
    let values = match kind.class {
        3 => raw.iter().map(|byte| f64::from(*byte)).collect(),
        _ => raw.chunks_exact(kind.size).map(|bytes| kind.number(bytes)).collect(),
    };
    Ok(StoredNumbers { extents, values })
}

/// The bytes of all numbers, as the layout message places them.
fn stored<'a>(
    file: &Hdf5File<'a>,
    mut at: Cursor<'a>,
    extents: &[usize],
    size: usize,
    bytes: usize,
    messages: &[Message<'a>],
) -> Result<Vec<u8>, ReadError> {
    let start = at.at;
    let version = at.byte()?;
    let piece = |at: &mut Cursor<'a>| at.take(bytes).map(<[u8]>::to_vec);
    match version {
        1 | 2 => {
            let (rank, class) = (at.byte()?, at.byte()?);
            at.skip(5)?;
            let address = if class == 0 { 0 } else { at.address()? };
            let chunk: Vec<usize> =
                (0..rank).map(|_| Ok(at.number(4)? as usize)).collect::<Result<_, ReadError>>()?;
            match class {
                0 => {
                    at.skip(4)?;
                    piece(&mut at)
                }
                1 => contiguous(file, at, address, bytes),
                _ => chunked(file, address, &chunk, extents, size, bytes, messages),
            }
        }
        3 | 4 => match at.byte()? {
            0 => {
                at.skip(2)?;
                piece(&mut at)
            }
            1 => {
                let address = at.address()?;
                contiguous(file, at, address, bytes)
            }
            2 if version == 3 => {
                let rank = at.byte()?;
                let address = at.address()?;
                let chunk: Vec<usize> = (1..rank)
                    .map(|_| Ok(at.number(4)? as usize))
                    .collect::<Result<_, ReadError>>()?;
                chunked(file, address, &chunk, extents, size, bytes, messages)
            }
            other => Err(fault(
                start,
                "numbers in one piece, or in chunks found by a tree",
                format!(
                    "layout {other} of version {version} (`h5repack -l CONTI` writes one piece)"
                ),
            )),
        },
        other => Err(fault(start, "a layout of version 1 to 4", other)),
    }
}

/// StoredNumbers in one piece; those never written are zeros.
fn contiguous(
    file: &Hdf5File<'_>,
    at: Cursor<'_>,
    address: u64,
    bytes: usize,
) -> Result<Vec<u8>, ReadError> {
    if bytes == 0 {
        return Ok(Vec::new());
    }
    if at.is_nothing(address) {
        // No more than a file of them would hold.
        if bytes > file.bytes.len() {
            return Err(fault(at.at, &format!("{bytes} bytes of numbers"), "none written"));
        }
        return Ok(vec![0; bytes]);
    }
    file.cursor(address)?.take(bytes).map(<[u8]>::to_vec)
}

/// StoredNumbers in chunks, found by a tree.
fn chunked(
    file: &Hdf5File<'_>,
    tree: u64,
    chunk: &[usize],
    extents: &[usize],
    size: usize,
    bytes: usize,
    messages: &[Message<'_>],
) -> Result<Vec<u8>, ReadError> {
    if let Some(filters) = messages.iter().find(|message| message.kind == codes::FILTERS) {
        return Err(fault(
            filters.body.at,
            "numbers that are not compressed",
            "a compressed array (`h5repack -f NONE` unpacks it)",
        ));
    }
    let rank = extents.len();
    let whole = chunk.iter().try_fold(size, |all, n| all.checked_mul(*n));
    let whole = whole.filter(|whole| *whole > 0 && *whole <= file.bytes.len());
    let Some(whole) = whole.filter(|_| chunk.len() == rank && rank > 0) else {
        return Err(fault(0, "chunks of the array", format!("chunks {chunk:?} of {extents:?}")));
    };
    let mut all = vec![0u8; bytes.min(file.bytes.len())];
    if all.len() != bytes {
        return Err(fault(0, &format!("{bytes} bytes of numbers"), "a smaller file"));
    }
    let mut stack = vec![tree];
    let mut seen = 0usize;
    while let Some(node) = stack.pop() {
        let mut at = file.cursor(node)?;
        seen += 1;
        if seen > file.bytes.len() / 24 {
            return Err(fault(at.at, "a tree that ends", "nodes in a circle"));
        }
        at.signature("TREE")?;
        at.skip(1)?;
        let level = at.byte()?;
        let count = at.number(2)?;
        at.skip(2 * file.offset)?;
        for _ in 0..count {
            at.skip(8)?;
            let corner: Vec<usize> =
                (0..rank).map(|_| Ok(at.number(8)? as usize)).collect::<Result<_, ReadError>>()?;
            at.skip(8)?;
            let child = at.address()?;
            if level > 0 {
                stack.push(child);
                continue;
            }
            let from = file.cursor(child)?.take(whole)?;
            copy_chunk(from, chunk, &corner, extents, size, &mut all);
        }
    }
    Ok(all)
}

/// Copies the part of a chunk inside the array, line by line.
fn copy_chunk(
    from: &[u8],
    chunk: &[usize],
    corner: &[usize],
    extents: &[usize],
    size: usize,
    all: &mut [u8],
) {
    let rank = extents.len();
    let last = rank - 1;
    if (0..rank).any(|d| corner[d] >= extents[d]) {
        return;
    }
    let run = chunk[last].min(extents[last] - corner[last]) * size;
    let lines = from.len() / (chunk[last] * size);
    for line in 0..lines {
        let (mut rest, mut to, mut step) = (line, 0, extents[last]);
        let mut inside = true;
        for d in (0..last).rev() {
            let k = rest % chunk[d] + corner[d];
            rest /= chunk[d];
            inside &= k < extents[d];
            to += k * step;
            step *= extents[d];
        }
        if inside {
            let (to, from_at) = ((to + corner[last]) * size, line * chunk[last] * size);
            all[to..to + run].copy_from_slice(&from[from_at..from_at + run]);
        }
    }
}
