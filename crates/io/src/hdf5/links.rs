//! Content of groups: tables of symbols, links in the header, links in a fractal heap.

use super::bytes::{Cursor, fault};
use super::codes;
use super::header::Message;
use super::{Hdf5File, Link, MOST_OBJECTS, StoredObject};
use crate::ReadError;

pub(super) fn links<'a>(
    file: &Hdf5File<'a>,
    messages: &[Message<'a>],
) -> Result<Vec<Link>, ReadError> {
    let mut links = Vec::new();
    for message in messages {
        let mut body = message.body;
        match message.kind {
            codes::SYMBOL_TABLE => {
                let (tree, heap) = (body.address()?, body.address()?);
                symbols(file, tree, heap, &mut links)?;
            }
            codes::LINK => links.push(link(body)?),
            codes::LINK_INFO => {
                body.skip(1)?;
                let flags = body.byte()?;
                body.skip(if flags & 1 != 0 { 8 } else { 0 })?;
                let (heap, names) = (body.address()?, body.address()?);
                if !body.is_nothing(heap) {
                    dense(file, heap, names, &mut links)?;
                }
            }
            _ => {}
        }
    }
    Ok(links)
}

fn link(mut at: Cursor<'_>) -> Result<Link, ReadError> {
    at.skip(1)?;
    let flags = at.byte()?;
    let kind = if flags & 8 != 0 { at.byte()? } else { 0 };
    let order = if flags & 4 != 0 { Some(at.number(8)?) } else { None };
    at.skip(usize::from(flags & 16 != 0))?;
    let length = at.number(1 << (flags & 3))?;
    let name = at.take(usize::try_from(length).unwrap_or(usize::MAX))?;
    let name = String::from_utf8_lossy(name).into_owned();
    let to = if kind == 0 { Some(StoredObject(at.address()?)) } else { None };
    Ok(Link { name, to, order })
}

/// The links of a table of symbols: a tree of nodes, names in a heap.
fn symbols(
    file: &Hdf5File<'_>,
    tree: u64,
    heap: u64,
    links: &mut Vec<Link>,
) -> Result<(), ReadError> {
    let mut at = file.cursor(heap)?;
    at.signature("HEAP")?;
    at.skip(4)?;
    let size = at.size()?;
    at.skip(file.length)?;
    let names = file.cursor(at.address()?)?;
    let end = names.at.saturating_add(usize::try_from(size).unwrap_or(usize::MAX));
    let names = &file.bytes[names.at..end.min(file.bytes.len())];
    let mut stack = vec![tree];
    let mut seen = 0;
    while let Some(node) = stack.pop() {
        seen += 1;
        if seen > MOST_OBJECTS {
            return Err(fault(0, "a tree that ends", "nodes in a circle"));
        }
        let mut at = file.cursor(node)?;
        if at.bytes[at.at..].starts_with(b"SNOD") {
            at.skip(6)?;
            for _ in 0..at.number(2)? {
                let (name, object) = (at.address()?, at.address()?);
                let kind = at.number(4)?;
                at.skip(20)?;
                let here = at.at;
                let rest = usize::try_from(name).ok().and_then(|name| names.get(name..));
                let Some(rest) = rest else {
                    return Err(fault(here, "a name in the heap of its group", name));
                };
                let end = rest.iter().position(|b| *b == 0).unwrap_or(rest.len());
                let name = String::from_utf8_lossy(&rest[..end]).into_owned();
                let to = (kind != 2).then_some(StoredObject(object));
                links.push(Link { name, to, order: None });
            }
            continue;
        }
        at.signature("TREE")?;
        at.skip(2)?;
        let count = at.number(2)?;
        at.skip(2 * file.offset)?;
        for _ in 0..count {
            at.skip(file.length)?;
            stack.push(at.address()?);
        }
    }
    Ok(())
}

/// The bytes that numbers up to `most` take.
fn width(most: u64) -> usize {
    (most.max(1).ilog2() / 8 + 1) as usize
}

/// The links in a fractal heap, found by the tree of their names.
fn dense(
    file: &Hdf5File<'_>,
    heap: u64,
    names: u64,
    links: &mut Vec<Link>,
) -> Result<(), ReadError> {
    let heap = FractalHeap::at(file, heap)?;
    let mut at = file.cursor(names)?;
    at.signature("BTHD")?;
    at.skip(2)?;
    let (node, record, depth) = (at.number(4)?, at.number(2)?, at.number(2)?);
    at.skip(2)?;
    let (root, records) = (at.address()?, at.number(2)?);
    let here = at.at;
    if record < 5 || node < 32 || depth > 16 || record > node {
        return Err(fault(here, "a tree of names", "other sizes"));
    }
    // Maximum number of records in a node of each depth, alone and with all below it.
    let leaf = (node - 10) / record;
    let count_width = width(leaf);
    let mut below = vec![leaf];
    for d in 1..=depth as usize {
        let pointer = file.offset + count_width + if d > 1 { width(below[d - 1]) } else { 0 };
        let most = (node - 10).saturating_sub(pointer as u64) / (record + pointer as u64);
        below.push((most + 1).saturating_mul(below[d - 1]).saturating_add(most));
    }
    let mut stack = vec![(root, records, depth as usize)];
    while let Some((address, count, depth)) = stack.pop() {
        if links.len() > MOST_OBJECTS || stack.len() > MOST_OBJECTS {
            return Err(fault(here, "a tree that ends", "nodes in a circle"));
        }
        let mut at = file.cursor(address)?;
        at.signature(if depth == 0 { "BTLF" } else { "BTIN" })?;
        at.skip(2)?;
        for _ in 0..count {
            // A hash, then the position in the heap.
            at.skip(4)?;
            let id = at.take(record as usize - 4)?;
            links.push(link(heap.object(file, id)?)?);
        }
        if depth > 0 {
            for _ in 0..=count {
                let (child, inside) = (at.address()?, at.number(count_width)?);
                at.skip(if depth > 1 { width(below[depth - 1]) } else { 0 })?;
                stack.push((child, inside, depth - 1));
            }
        }
    }
    Ok(())
}

/// Location of the objects of a heap.
struct FractalHeap {
    /// Bytes of a position in the heap, and of a length.
    place: usize,
    length: usize,
    columns: u64,
    first: u64,
    most_direct: u64,
    root: u64,
    /// Rows of the root; 0 when it is a block of data itself.
    rows: u64,
}

impl FractalHeap {
    fn at(file: &Hdf5File<'_>, address: u64) -> Result<Self, ReadError> {
        let mut at = file.cursor(address)?;
        at.signature("FRHP")?;
        at.skip(3)?;
        let filters = at.number(2)?;
        at.skip(1)?;
        let most_object = at.number(4)?;
        at.skip(10 * file.length + 2 * file.offset)?;
        let columns = at.number(2)?;
        let (first, most_direct) = (at.size()?, at.size()?);
        let bits = at.number(2)?;
        at.skip(2)?;
        let (root, rows) = (at.address()?, at.number(2)?);
        let sound = filters == 0
            && (1..=64).contains(&bits)
            && columns > 0
            && columns < 1 << 15
            && first > 0
            && most_direct >= first
            && rows <= 64;
        if !sound {
            return Err(fault(at.at, "a heap of links without filters", "another heap"));
        }
        let place = (bits as usize).div_ceil(8);
        let length = width(most_object).min((most_direct.ilog2() as usize).div_ceil(8));
        Ok(Self { place, length, columns, first, most_direct, root, rows })
    }

    fn object<'a>(&self, file: &Hdf5File<'a>, id: &[u8]) -> Result<Cursor<'a>, ReadError> {
        let mut at = Cursor { bytes: id, at: 0, offset: file.offset, length: file.length };
        let kind = at.byte()? >> 4 & 3;
        if kind != 0 {
            return Err(fault(0, "a link inside of its heap", "one that is kept apart"));
        }
        let (place, length) = (at.number(self.place)?, at.number(self.length)? as usize);
        let block = self.block(file, self.root, self.rows, place, 0)?;
        let mut at = file.cursor(block)?;
        at.skip(length)?;
        Ok(Cursor { bytes: &file.bytes[..at.at], at: at.at - length, ..at })
    }

    /// The address in the file of a position in the heap, inside the block at `address`.
    fn block(
        &self,
        file: &Hdf5File<'_>,
        address: u64,
        rows: u64,
        place: u64,
        depth: usize,
    ) -> Result<u64, ReadError> {
        if rows == 0 {
            return Ok(address.saturating_add(place));
        }
        let mut at = file.cursor(address)?;
        if depth > 16 {
            return Err(fault(at.at, "a heap that ends", "blocks in a circle"));
        }
        at.signature("FHIB")?;
        at.skip(1 + file.offset + self.place)?;
        let mut start = 0u64;
        for row in 0..rows {
            let size = self.first.saturating_mul(1u64 << row.saturating_sub(1).min(62));
            for _ in 0..self.columns {
                let child = at.address()?;
                let end = start.saturating_add(size);
                if place < end {
                    let inner = if size <= self.most_direct {
                        0
                    } else {
                        // As many rows as hold its size.
                        let part = (size / self.first.saturating_mul(self.columns)).max(1);
                        u64::from(part.ilog2()) + 1
                    };
                    return self.block(file, child, inner, place - start, depth + 1);
                }
                start = end;
            }
        }
        Err(fault(at.at, "a position inside the heap", place))
    }
}
