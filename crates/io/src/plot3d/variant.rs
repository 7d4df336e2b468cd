//! Variants of the format. Invariant: a default variant is read by every program.

/// Name of the format in errors.
pub(super) const FORMAT: &str = "Plot3D";

/// Encoding of numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Laid {
    /// Text.
    Formatted,
    /// Plain numbers, as written by C.
    #[default]
    Stream,
    /// Fortran records, each with its length before and after.
    Unformatted,
}

/// Choices that the format leaves open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// Encoding of the numbers.
    pub laid: Laid,
    /// Double precision, otherwise single. Irrelevant for text.
    pub double: bool,
    /// The number of blocks comes first; otherwise there is one block.
    pub multi: bool,
    /// Three sizes and coordinates; two otherwise.
    pub three: bool,
    /// An integer for each point follows the coordinates of its block.
    pub iblank: bool,
    /// The most significant byte comes first.
    pub big_endian: bool,
    /// Bytes of a record's length: 4 or 8.
    pub mark: usize,
    /// Coordinates come plane by plane, k = 1 first; with records, one record per plane.
    pub planes: bool,
}

impl Variant {
    /// Variant that every program reads: plain numbers, double precision, several blocks, three
    /// coordinates.
    pub const USUAL: Self = Self {
        laid: Laid::Stream,
        double: true,
        multi: true,
        three: true,
        iblank: false,
        big_endian: false,
        mark: 4,
        planes: false,
    };
}

impl Default for Variant {
    fn default() -> Self {
        Self::USUAL
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
