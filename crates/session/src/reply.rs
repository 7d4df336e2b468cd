//! Decoding of frames, for tests and other programs.

use crate::frame::{MAGIC, VERSION};
use serde_json::Value;

/// A decoded reply.
#[derive(Clone, Debug)]
pub struct Reply {
    /// The header.
    pub head: Value,
    /// The bytes of all arrays.
    pub arrays: Vec<u8>,
}

impl Reply {
    /// Decodes a frame.
    ///
    /// # Panics
    /// If the bytes are not a frame.
    pub fn of(bytes: &[u8]) -> Self {
        let word = |k: usize| {
            let word = bytes[4 * k..4 * k + 4].try_into().expect("four bytes");
            u32::from_le_bytes(word)
        };
        assert_eq!((word(0), word(1)), (MAGIC, VERSION));
        let end = 16 + word(2) as usize;
        let head = serde_json::from_slice(&bytes[16..end]).expect("a head in JSON");
        let arrays = bytes[end.next_multiple_of(8).min(bytes.len())..].to_vec();
        Self { head, arrays }
    }

    /// The array of 32-bit floats of a header entry.
    pub fn floats(&self, part: &Value) -> Vec<f32> {
        self.words(part).map(f32::from_le_bytes).collect()
    }

    /// The array of 32-bit unsigned integers of a header entry.
    pub fn numbers(&self, part: &Value) -> Vec<u32> {
        self.words(part).map(u32::from_le_bytes).collect()
    }

    fn words(&self, part: &Value) -> impl Iterator<Item = [u8; 4]> {
        let number = |key: &str| part[key].as_u64().expect("a whole number") as usize;
        let (offset, count) = (number("offset"), number("count"));
        let bytes = &self.arrays[offset..offset + 4 * count];
        bytes.chunks_exact(4).map(|c| c.try_into().expect("four bytes"))
    }
}
