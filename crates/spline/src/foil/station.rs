//! A station of a section, before it is laid between points.

/// A station of a section, in units of the chord, of half the greatest thickness and of the
/// greatest camber.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station<J> {
    /// Distance from the leading edge along the chord.
    pub x: J,
    /// Half thickness; negative on the lower side.
    pub thickness: J,
    /// Height of the mean line.
    pub camber: J,
    /// Slope of the mean line, d camber / dx, limited near the leading edge; see
    /// [`Section::at`](super::Section::at).
    pub slope: J,
    /// True on the lower side.
    pub lower: bool,
}
