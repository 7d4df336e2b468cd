//! Object headers: the messages that describe an object.

use super::bytes::{Cursor, fault};
use super::codes::CONTINUATION;
use super::{Hdf5File, MOST_OBJECTS};
use crate::ReadError;

#[derive(Clone, Copy, Debug)]
pub(super) struct Message<'a> {
    pub kind: u16,
    /// True when it is kept elsewhere, as committed types are.
    pub shared: bool,
    pub body: Cursor<'a>,
}

/// The messages of the header at an address, those of its continuations included.
pub(super) fn messages<'a>(
    file: &Hdf5File<'a>,
    address: u64,
) -> Result<Vec<Message<'a>>, ReadError> {
    let mut at = file.cursor(address)?;
    let start = at.at;
    let modern = at.bytes[start..].starts_with(b"OHDR");
    let mut found = Vec::new();
    // Blocks of messages: from where, how long.
    let mut blocks: Vec<(usize, usize)> = Vec::new();
    let mut ordered = false;
    if modern {
        at.skip(5)?;
        let flags = at.byte()?;
        ordered = flags & 4 != 0;
        at.skip(if flags & 32 != 0 { 16 } else { 0 } + if flags & 16 != 0 { 4 } else { 0 })?;
        let length = at.number(1 << (flags & 3))?;
        blocks.push((at.at, usize::try_from(length).unwrap_or(usize::MAX)));
    } else {
        let version = at.byte()?;
        if version != 1 {
            return Err(fault(start, "an object header of version 1 or 2", version));
        }
        at.skip(7)?;
        let length = at.number(4)?;
        at.skip(4)?;
        blocks.push((at.at, length as usize));
    }
    let prefix = match (modern, ordered) {
        (false, _) => 8,
        (true, false) => 4,
        (true, true) => 6,
    };
    let mut next = 0;
    while let Some(&(from, length)) = blocks.get(next) {
        next += 1;
        let end = from.checked_add(length).filter(|end| *end <= file.bytes.len());
        let Some(end) = end else {
            return Err(fault(from, &format!("{length} bytes of messages"), "the end of the file"));
        };
        let mut at = Cursor { bytes: &file.bytes[..end], at: from, ..at };
        // The rest is a gap.
        while at.at + prefix <= end {
            let (kind, size, flags) = if modern {
                let message = (u16::from(at.byte()?), at.number(2)? as usize, at.byte()?);
                at.skip(prefix - 4)?;
                message
            } else {
                let message = (at.number(2)? as u16, at.number(2)? as usize, at.byte()?);
                at.skip(3)?;
                message
            };
            let here = at.at;
            at.skip(size)?;
            let body = Cursor { bytes: &file.bytes[..here + size], at: here, ..at };
            if kind == CONTINUATION {
                let mut body = body;
                let (from, length) = (body.address()?, body.size()?);
                let from = file.cursor(from)?.at;
                let length = usize::try_from(length).unwrap_or(usize::MAX);
                blocks.push(match modern {
                    // Its signature and its checksum.
                    true => (from + 4, length.saturating_sub(8)),
                    false => (from, length),
                });
            } else {
                found.push(Message { kind, shared: flags & 2 != 0, body });
            }
            if found.len() > MOST_OBJECTS || blocks.len() > MOST_OBJECTS {
                return Err(fault(here, "a header that ends", "messages without an end"));
            }
        }
    }
    Ok(found)
}
