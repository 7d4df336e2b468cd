//! Conditions on the shape of a curve, and how commands and models write them.

use moldloft_num::Vec3;

/// A required shape of the curve. Data are numbered from 0.
///
/// Signs of curvature are those of a plane curve seen from above, or in a vertical plane with z up:
/// convex is a turn to the left, as of a graph over x (or over y) from left to right.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeCondition {
    /// Between two data the curve turns in one direction: to the left (convex) or to the right
    /// (concave).
    Turn {
        /// The first and the last datum.
        between: [usize; 2],
        /// To the left.
        left: bool,
    },
    /// Between two data the curve has no inflection; its direction of turning is free.
    OneWay {
        /// The first and the last datum.
        between: [usize; 2],
    },
    /// A straight line from datum to datum.
    Straight {
        /// The first and the last datum.
        between: [usize; 2],
        /// Its direction, if given.
        along: Option<Vec3<f64>>,
    },
    /// A circular arc from datum to datum, tangent to straight runs and arcs beside it.
    Arc {
        /// The first and the last datum.
        between: [usize; 2],
    },
    /// Maximum number of pieces of monotone curvature.
    Pieces(usize),
    /// The whole curve stays where `direction . x` is at most `most`.
    Within {
        /// The direction.
        direction: Vec3<f64>,
        /// The largest value.
        most: f64,
    },
    /// The curve leaves the data only against this direction.
    OneSided {
        /// The direction.
        direction: Vec3<f64>,
    },
}

/// Syntax of shapes, for messages.
const GRAMMAR: &str = "convex, concave, one-way, straight or arc with points (convex=4-10; alone the \
                       whole curve), straight=4-10:0,1 in a direction, pieces=2, within=0,1:4.6, \
                       side=0,-1";

impl ShapeCondition {
    /// Reads a condition in the notation of command and language, for `count` points: `convex=4-10`
    /// (points from 1), `concave`, `one-way=3-9`, `straight=1-9`, `straight=1-9:0,1`, `arc=9-15`,
    /// `pieces=2`, `within=0,1:4.6`, `side=0,-1`.
    ///
    /// # Errors
    /// The expected syntax.
    ///
    /// # Example
    /// ```
    /// use moldloft_fair::ShapeCondition;
    /// let convex = ShapeCondition::read("convex=4-10", 20).unwrap();
    /// assert_eq!(convex, ShapeCondition::Turn { between: [3, 9], left: true });
    /// assert!(ShapeCondition::read("round=4-10", 20).is_err());
    /// ```
    pub fn read(text: &str, count: usize) -> Result<Self, String> {
        let (word, rest) = match text.split_once('=') {
            Some((word, rest)) => (word.trim(), Some(rest.trim())),
            None => (text.trim(), None),
        };
        // The whole of a curve in a direction.
        let (word, along) = match word.split_once(':').filter(|_| rest.is_none()) {
            Some((word, along)) => (word.trim(), Some(along.trim())),
            None => (word, None),
        };
        let wrong = || format!("expected one of: {GRAMMAR}; found `{text}`");
        let (what, more) = match rest.map(|r| r.split_once(':')) {
            None => (None, along),
            Some(None) => (rest, None),
            Some(Some((a, b))) => (Some(a.trim()), Some(b.trim())),
        };
        let between = |what: Option<&str>| -> Result<[usize; 2], String> {
            let Some(what) = what else { return Ok([0, count.saturating_sub(1)]) };
            let (a, b) = what.split_once('-').ok_or_else(wrong)?;
            let number = |s: &str| s.trim().parse::<usize>().map_err(|_| wrong());
            let (a, b) = (number(a)?, number(b)?);
            if !(1 <= a && a < b && b <= count) {
                return Err(format!(
                    "expected a first and a later point of 1 to {count}, found `{text}`"
                ));
            }
            Ok([a - 1, b - 1])
        };
        let vector = |what: &str| -> Result<Vec3<f64>, String> {
            let all: Result<Vec<f64>, _> = what.split(',').map(|x| x.trim().parse()).collect();
            match all.map_err(|_| wrong())?[..] {
                [x, y] => Ok(Vec3::of(x, y, 0.0)),
                [x, y, z] => Ok(Vec3::of(x, y, z)),
                _ => Err(wrong()),
            }
        };
        match (word, what, more) {
            ("convex" | "concave", what, None) => {
                Ok(Self::Turn { between: between(what)?, left: word == "convex" })
            }
            ("one-way", what, None) => Ok(Self::OneWay { between: between(what)? }),
            ("straight", what, more) => {
                Ok(Self::Straight { between: between(what)?, along: more.map(vector).transpose()? })
            }
            ("arc", what, None) => Ok(Self::Arc { between: between(what)? }),
            ("pieces", Some(k), None) => k.parse().map(Self::Pieces).map_err(|_| wrong()),
            ("within", Some(d), Some(most)) => {
                Ok(Self::Within { direction: vector(d)?, most: most.parse().map_err(|_| wrong())? })
            }
            ("side", Some(d), None) => Ok(Self::OneSided { direction: vector(d)? }),
            _ => Err(wrong()),
        }
    }

    /// The same condition for renumbered points.
    #[must_use]
    pub fn renumbered(&self, of: impl Fn(usize) -> usize) -> Self {
        let mut out = self.clone();
        if let Self::Turn { between, .. }
        | Self::OneWay { between }
        | Self::Straight { between, .. }
        | Self::Arc { between } = &mut out
        {
            *between = between.map(of);
        }
        out
    }
}
