//! Spans of source text.

/// A source text of a [`Sources`](crate::Sources) table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(pub u32);

impl FileId {
    /// The file of things that have no source text (made from Python, built in).
    pub const UNKNOWN: FileId = FileId(u32::MAX);
}

impl Default for FileId {
    fn default() -> Self {
        FileId::UNKNOWN
    }
}

/// A half-open range of bytes `start..end` of one source text. The default is the unknown span.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// The text.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The span of things that have no source text.
    pub const UNKNOWN: Span = Span { file: FileId::UNKNOWN, start: 0, end: 0 };

    /// The bytes `start..end` of `file`.
    pub const fn new(file: FileId, start: u32, end: u32) -> Self {
        Span { file, start, end }
    }

    /// The empty span before the byte `at`.
    pub const fn point(file: FileId, at: u32) -> Self {
        Span { file, start: at, end: at }
    }

    /// True if the position is in a source text.
    pub fn is_known(self) -> bool {
        self.file != FileId::UNKNOWN
    }

    /// The smallest span that covers both; the known one if only one is known, `self` if the files
    /// differ.
    #[must_use]
    pub fn to(self, other: Span) -> Span {
        if !other.is_known() || (self.is_known() && self.file != other.file) {
            return self;
        }
        if !self.is_known() {
            return other;
        }
        Span { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }

    /// Number of bytes.
    pub fn len(self) -> usize {
        (self.end.saturating_sub(self.start)) as usize
    }

    /// True for an empty range.
    pub fn is_empty(self) -> bool {
        self.end <= self.start
    }

    /// True if the byte offset is in the range or directly at its end.
    pub fn touches(self, offset: u32) -> bool {
        self.is_known() && self.start <= offset && offset <= self.end
    }

    /// The range as `usize`, to index a text.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..(self.end.max(self.start)) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joins() {
        let f = FileId(0);
        let a = Span::new(f, 3, 5);
        let b = Span::new(f, 9, 12);
        assert_eq!(a.to(b), Span::new(f, 3, 12));
        assert_eq!(a.to(Span::UNKNOWN), a);
        assert_eq!(Span::UNKNOWN.to(b), b);
        assert_eq!(a.to(Span::new(FileId(1), 0, 1)), a);
        assert!(!Span::default().is_known());
        assert!(a.touches(5) && !a.touches(6));
    }
}
