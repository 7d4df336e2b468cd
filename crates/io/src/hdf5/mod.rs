//! HDF5 files: groups, their attributes and numbers (HDF5 File Format Specification, version 3).
//!
//! Read are all superblocks; groups of both kinds (symbol tables; links in headers and in fractal heaps); numbers stored
//! compactly, in one piece or in chunks. Compressed numbers, committed types and links into other files are refused by
//! name. No address or count of a file is trusted: each read stays inside of the bytes, walks are bounded.
//!
//! Written (`write`) is one form of each: what HDF5 1.8 and newer reads.
//!
//! Own code, though a library reads all of HDF5: that one takes 49 s of processor time to compile, and would be
//! in the engine of each page; CGNS needs a small part of it.
//!
//! `bytes -> Hdf5File -> Group (address of an object header) -> children, texts, numbers`

mod bytes;
mod codes;
mod dataset;
mod header;
mod links;
mod write;

pub(crate) use dataset::StoredNumbers;
pub(crate) use write::{Hdf5Array, Hdf5Attribute, Hdf5Element, Hdf5Group, Hdf5Object, write};

use crate::ReadError;
use bytes::{Cursor, fault};
use header::{Message, messages};

/// Objects that a file may have; links in a circle end there.
const MOST_OBJECTS: usize = 1 << 20;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Hdf5File<'a> {
    /// All bytes from the superblock on: addresses count from there.
    bytes: &'a [u8],
    /// Bytes of an address, and of a length.
    offset: usize,
    length: usize,
    root: u64,
}

/// An object: the address of its header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StoredObject(u64);

/// A named member of a group.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Link {
    pub name: String,
    /// `None` of links by name and into other files.
    pub to: Option<StoredObject>,
    /// The index among the links of the group in order of creation, where the file has it.
    pub order: Option<u64>,
}

impl<'a> Hdf5File<'a> {
    /// The file of these bytes.
    ///
    /// # Errors
    /// If they are not an HDF5 file.
    pub fn open(all: &'a [u8]) -> Result<Self, ReadError> {
        let starts = std::iter::once(0).chain((9..40).map(|k| 1usize << k));
        let start = starts
            .take_while(|start| start + 8 <= all.len())
            .find(|&start| &all[start..start + 8] == codes::SIGNATURE)
            .ok_or_else(|| fault(0, "an HDF5 file", "other bytes"))?;
        let bytes = &all[start..];
        let mut at = Cursor { bytes, at: 8, offset: 8, length: 8 };
        let version = at.byte()?;
        let sizes = match version {
            0 | 1 => {
                at.skip(4)?;
                let sizes = [at.byte()?, at.byte()?];
                at.skip(if version == 0 { 9 } else { 13 })?;
                sizes
            }
            2 | 3 => {
                let sizes = [at.byte()?, at.byte()?];
                at.skip(1)?;
                sizes
            }
            other => return Err(fault(8, "a superblock of version 0 to 3", other)),
        };
        if sizes.iter().any(|size| ![2, 4, 8].contains(size)) {
            return Err(fault(8, "addresses of 2, 4 or 8 bytes", format!("{sizes:?}")));
        }
        let [offset, length] = sizes.map(usize::from);
        (at.offset, at.length) = (offset, length);
        let base = at.address()?;
        if base != 0 && base != start as u64 {
            return Err(fault(at.at, "addresses that count from the superblock", base));
        }
        at.skip(if version < 2 { 3 * offset } else { 2 * offset })?;
        if version < 2 {
            at.skip(offset)?;
        }
        let root = at.address()?;
        Ok(Self { bytes, offset, length, root })
    }

    /// The group that all others are in.
    pub fn root(&self) -> StoredObject {
        StoredObject(self.root)
    }

    fn cursor(&self, at: u64) -> Result<Cursor<'a>, ReadError> {
        match usize::try_from(at) {
            Ok(at) if at < self.bytes.len() => {
                Ok(Cursor { bytes: self.bytes, at, offset: self.offset, length: self.length })
            }
            _ => Err(fault(
                self.bytes.len(),
                "an address inside of the file",
                format!("{at}: the file is cut off or damaged"),
            )),
        }
    }

    fn messages(&self, object: StoredObject) -> Result<Vec<Message<'a>>, ReadError> {
        messages(self, object.0)
    }

    /// Members of a group, in the order of creation if stored, otherwise by name.
    pub fn children(&self, group: StoredObject) -> Result<Vec<Link>, ReadError> {
        let mut links = links::links(self, &self.messages(group)?)?;
        match links.iter().all(|link| link.order.is_some()) {
            true => links.sort_by_key(|link| link.order),
            false => links.sort_by(|a, b| a.name.cmp(&b.name)),
        }
        Ok(links)
    }

    /// A text among the attributes of an object.
    pub fn text(&self, object: StoredObject, name: &str) -> Result<Option<String>, ReadError> {
        for message in self.messages(object)? {
            if message.kind == codes::ATTRIBUTE
                && let Some(text) = dataset::text_attribute(&message, name)?
            {
                return Ok(Some(text));
            }
        }
        Ok(None)
    }

    /// The numbers of an object.
    pub fn numbers(&self, object: StoredObject) -> Result<StoredNumbers, ReadError> {
        dataset::numbers(self, &self.messages(object)?)
    }
}
