//! Bytes read one after the other, each within the file.

use crate::{FilePosition, ReadError};
use std::fmt::Display;

/// Error for unexpected bytes.
pub(super) fn fault(byte: usize, expected: &str, found: impl Display) -> ReadError {
    ReadError {
        format: "HDF5",
        place: FilePosition::Byte(byte),
        expected: expected.to_string(),
        found: found.to_string(),
    }
}

/// A position in a file, or in a part of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
    /// Bytes of an address, and of a length.
    pub offset: usize,
    pub length: usize,
}

impl<'a> Cursor<'a> {
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], ReadError> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.bytes.len());
        let Some(end) = end else {
            let rest = self.bytes.len().saturating_sub(self.at);
            return Err(fault(self.at, &format!("{count} bytes"), format!("{rest} bytes")));
        };
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }

    pub fn skip(&mut self, count: usize) -> Result<(), ReadError> {
        self.take(count).map(|_| ())
    }

    /// An unsigned integer of `count` bytes (at most 8), little-endian.
    pub fn number(&mut self, count: usize) -> Result<u64, ReadError> {
        let bytes = self.take(count)?;
        Ok(bytes.iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
    }

    pub fn byte(&mut self) -> Result<u8, ReadError> {
        Ok(self.take(1)?[0])
    }

    /// An address; that of nothing has all bits set.
    pub fn address(&mut self) -> Result<u64, ReadError> {
        self.number(self.offset)
    }

    /// A length; it must be addressable.
    pub fn size(&mut self) -> Result<u64, ReadError> {
        self.number(self.length)
    }

    /// True of an address of nothing.
    pub fn is_nothing(&self, address: u64) -> bool {
        let all = if self.offset == 8 { u64::MAX } else { (1 << (8 * self.offset)) - 1 };
        address == all
    }

    /// The four letters with which a structure begins.
    pub fn signature(&mut self, word: &str) -> Result<(), ReadError> {
        let at = self.at;
        let found = self.take(4)?;
        if found != word.as_bytes() {
            return Err(fault(at, &format!("`{word}`"), String::from_utf8_lossy(found)));
        }
        Ok(())
    }
}
