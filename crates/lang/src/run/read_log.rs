//! Log of the objects that an expression reads: they become the parents of the object that it
//! defines.

use moldloft_num::trace::Key;

/// The objects that were read since it was begun.
#[derive(Debug, Default)]
pub(crate) struct ReadLog {
    keys: Vec<Key>,
    open: bool,
}

impl ReadLog {
    /// Begins a new log if `asked`.
    pub fn begin(&mut self, asked: bool) {
        if asked {
            self.keys.clear();
        }
        self.open = asked;
    }

    /// Notes no more.
    pub fn end(&mut self) {
        self.open = false;
    }

    /// Notes an object, while the log is open.
    pub fn note(&mut self, key: Key) {
        if self.open {
            self.keys.push(key);
        }
    }

    /// Each object that was read, once, in order; the log is empty afterwards.
    pub fn taken(&mut self) -> Vec<Key> {
        let mut keys = std::mem::take(&mut self.keys);
        keys.sort_unstable();
        keys.dedup();
        keys
    }
}
