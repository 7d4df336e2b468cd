//! The three axes, and sets of axes along which a line may extend.

use std::fmt;

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CoordinateAxis {
    /// First.
    X,
    /// Second.
    Y,
    /// Third; up by default.
    Z,
}

impl CoordinateAxis {
    /// All, in order.
    pub const ALL: [CoordinateAxis; 3] = [CoordinateAxis::X, CoordinateAxis::Y, CoordinateAxis::Z];

    /// 0, 1 or 2.
    pub fn index(self) -> usize {
        self as usize
    }

    /// The two other axes, in the order x, y, z.
    pub fn others(self) -> [CoordinateAxis; 2] {
        let [x, y, z] = CoordinateAxis::ALL;
        match self {
            CoordinateAxis::X => [y, z],
            CoordinateAxis::Y => [x, z],
            CoordinateAxis::Z => [x, y],
        }
    }

    /// The capital letter.
    pub fn letter(self) -> &'static str {
        ["X", "Y", "Z"][self.index()]
    }

    /// The axis of a letter, in either case.
    pub fn of(text: &str) -> Option<CoordinateAxis> {
        CoordinateAxis::ALL.into_iter().find(|a| a.letter().eq_ignore_ascii_case(text))
    }
}

impl fmt::Display for CoordinateAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.letter())
    }
}

/// The axes along which the ends of a line differ: the type of the line.
///
/// The letters H, P, F and O are spellings of it ([`Letters`]); only this set is ever stored, so a
/// disagreement about letters cannot change a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Free(u8);

impl Free {
    /// All three axes: an oblique line.
    pub const OBLIQUE: Free = Free(7);

    /// One axis only: a principal line.
    pub fn along(axis: CoordinateAxis) -> Free {
        Free(1 << axis.index())
    }

    /// The axes perpendicular to `axis`.
    pub fn across(axis: CoordinateAxis) -> Free {
        Free(7 & !(1 << axis.index()))
    }

    /// The axes for which `test` holds; `None` if there are none.
    pub fn those(mut test: impl FnMut(CoordinateAxis) -> bool) -> Option<Free> {
        let bits =
            CoordinateAxis::ALL.into_iter().filter(|&a| test(a)).map(|a| 1 << a.index()).sum();
        (bits != 0).then_some(Free(bits))
    }

    /// True if the ends may differ along `axis`.
    pub fn contains(self, axis: CoordinateAxis) -> bool {
        self.0 >> axis.index() & 1 == 1
    }

    /// The axes in order.
    pub fn axes(self) -> impl Iterator<Item = CoordinateAxis> {
        CoordinateAxis::ALL.into_iter().filter(move |&a| self.contains(a))
    }

    /// The axis of a principal line.
    pub fn single(self) -> Option<CoordinateAxis> {
        let mut axes = self.axes();
        axes.next().filter(|_| axes.next().is_none())
    }

    /// The set with two axes exchanged.
    pub fn swapped(self, a: CoordinateAxis, b: CoordinateAxis) -> Free {
        let other = |x: CoordinateAxis| {
            if x == a {
                b
            } else if x == b {
                a
            } else {
                x
            }
        };
        Free(
            CoordinateAxis::ALL
                .into_iter()
                .filter(|&x| self.contains(other(x)))
                .map(|x| 1 << x.index())
                .sum(),
        )
    }

    /// `X`, `XY`, …, `O`: the spelling that no setting changes.
    pub fn spelling(self) -> &'static str {
        ["", "X", "Y", "XY", "Z", "XZ", "YZ", "O"][self.0 as usize]
    }
}

/// Spelling of the inclined types.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Naming {
    /// By descriptive geometry: H is parallel to the ground, F to the front view, P to the side view.
    #[default]
    Standard,
    /// The list of the 1983 manual read in order: H, P, F are XY, XZ, YZ.
    Seed,
}

/// The meaning of the letters H, P, F.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Letters {
    /// The axis that points up.
    pub up: CoordinateAxis,
    /// Spelling of the inclined types.
    pub naming: Naming,
}

impl Default for Letters {
    fn default() -> Self {
        Letters { up: CoordinateAxis::Z, naming: Naming::Standard }
    }
}

impl Letters {
    /// H, P, F with the axis that each keeps constant.
    fn table(self) -> [(&'static str, CoordinateAxis); 3] {
        use CoordinateAxis::{X, Y, Z};
        match (self.naming, self.up) {
            (Naming::Seed, _) => [("H", Z), ("P", Y), ("F", X)],
            (_, Z) => [("H", Z), ("P", X), ("F", Y)],
            (_, Y) => [("H", Y), ("P", X), ("F", Z)],
            (_, X) => [("H", X), ("P", Z), ("F", Y)],
        }
    }

    /// The set for a spelling, in either case. In a section (perpendicular to `section`) F is any
    /// line that is not parallel to its axes.
    pub fn free(self, text: &str, section: Option<CoordinateAxis>) -> Option<Free> {
        let text = text.to_ascii_uppercase();
        if let ("F", Some(normal)) = (text.as_str(), section) {
            return Some(Free::across(normal));
        }
        if text == "XYZ" {
            return Some(Free::OBLIQUE);
        }
        let lettered = self.table().into_iter().find(|(l, _)| *l == text);
        lettered
            .map(|(_, axis)| Free::across(axis))
            .or_else(|| (1..8).map(Free).find(|f| f.spelling() == text))
    }

    /// The letter shown for a set.
    pub fn letter(self, free: Free, section: Option<CoordinateAxis>) -> &'static str {
        match section {
            Some(normal) if free == Free::across(normal) => "F",
            _ => (self.table().into_iter())
                .find(|(_, axis)| free == Free::across(*axis))
                .map_or(free.spelling(), |(l, _)| l),
        }
    }
}
