//! Words of the options, parsed here for models, Python and the command.

use crate::curve::fit::ParameterSpacing;
use crate::curve::request::PointSpacing;
use crate::optimum::goal::Goal;
use crate::{EndContinuity, Measure, Motion};
use moldloft_num::Vec3;
use std::fmt;

/// A word that is not a value of an option, or only in combination with another option.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WordError {
    /// The kind of fault: "unknown-name", "no-share" or "other-mode".
    pub id: &'static str,
    /// Name of the option.
    pub noun: &'static str,
    /// The word.
    pub found: String,
    /// Allowed words.
    pub expected: String,
}

impl WordError {
    fn unknown(noun: &'static str, found: &str, all: &[&str]) -> Self {
        let expected = format!("one of: {}", all.join(", "));
        Self { id: "unknown-name", noun, found: found.to_string(), expected }
    }
}

impl fmt::Display for WordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.id == "unknown-name" {
            return write!(f, "unknown {} `{}`; expected {}", self.noun, self.found, self.expected);
        }
        write!(
            f,
            "the {} `{}` is not determined; expected {}",
            self.noun, self.found, self.expected
        )
    }
}

impl std::error::Error for WordError {}

/// The goals.
pub const GOALS: [&str; 6] = ["near", "budget", "fairest", "nearest", "energy", "closest"];

/// Default of `share` for the goal "nearest".
const NEAREST: f64 = 0.1;

/// The goal called `word`, with its share; for "near" and "budget" `budget` by default.
///
/// # Errors
/// For an unknown word, and for "energy" without a measure.
pub fn goal(word: &str, share: Option<f64>, budget: f64) -> Result<Goal, WordError> {
    Ok(match word {
        "near" => Goal::Near(share.unwrap_or(budget)),
        "budget" => Goal::Budget(share.unwrap_or(budget)),
        "fairest" => Goal::Fairest,
        "nearest" => Goal::Nearest(share.unwrap_or(NEAREST)),
        "closest" => Goal::Closest,
        "energy" => Goal::Energy(share.ok_or_else(|| WordError {
            id: "no-share",
            noun: "goal",
            found: word.to_string(),
            expected: "the largest measure, as `share`".to_string(),
        })?),
        _ => return Err(WordError::unknown("goal", word, &GOALS)),
    })
}

/// Values of `spacing`.
pub const SPACINGS: [&str; 8] =
    ["auto", "chord", "centripetal", "x", "y", "z", "index", "curvature"];

/// Parametrisation called `word`.
///
/// # Errors
/// For an unknown word.
pub fn spacing(word: &str) -> Result<PointSpacing, WordError> {
    let axis = |x, y, z| ParameterSpacing::Along(Vec3::of(x, y, z));
    Ok(PointSpacing::Given(match word {
        "auto" => return Ok(PointSpacing::Auto),
        "curvature" => return Ok(PointSpacing::Curvature),
        "chord" => ParameterSpacing::Chord,
        "centripetal" => ParameterSpacing::Centripetal,
        "index" => ParameterSpacing::Uniform,
        "x" => axis(1.0, 0.0, 0.0),
        "y" => axis(0.0, 1.0, 0.0),
        "z" => axis(0.0, 0.0, 1.0),
        _ => return Err(WordError::unknown("spacing", word, &SPACINGS)),
    }))
}

/// Conditions at open ends.
pub const ENDS: [&str; 4] = ["free", "position", "tangent", "curvature"];

/// The end condition called `word`, or a number of control points.
///
/// # Errors
/// For an unknown word.
pub fn end(word: &str) -> Result<EndContinuity, WordError> {
    if let Ok(count) = word.parse() {
        return Ok(EndContinuity::Points(count));
    }
    EndContinuity::named(word).ok_or_else(|| {
        let mut error = WordError::unknown("end condition", word, &ENDS);
        error.expected += ", or a number of control points";
        error
    })
}

/// The measure called `word`.
///
/// # Errors
/// For an unknown word.
pub fn measure(word: &str) -> Result<Measure, WordError> {
    let all = Measure::ALL.map(Measure::name);
    Measure::named(word).ok_or_else(|| WordError::unknown("measure", word, &all))
}

/// Directions of motion; `word` is `None`, "across" or "box".
///
/// # Errors
/// For an unknown word, and for one that needs a direction or excludes one.
pub fn motion(along: Option<Vec3<f64>>, word: Option<&str>) -> Result<Motion, WordError> {
    let with = |word: &str, expected: &str| WordError {
        id: "other-mode",
        noun: "motion",
        found: word.to_string(),
        expected: expected.to_string(),
    };
    match (along, word) {
        (None, None) => Ok(Motion::Ball),
        (None, Some("box")) => Ok(Motion::Box),
        (Some(d), None) => Ok(Motion::Along(d)),
        (Some(d), Some("across")) => Ok(Motion::Across(d)),
        (None, Some("across")) => Err(with("across", "`along`, the direction across which")),
        (Some(_), Some("box")) => Err(with("box", "no `along`")),
        (_, Some(word)) => Err(WordError::unknown("motion", word, &["across", "box"])),
    }
}

/// The modes.
pub const MODES: [&str; 6] = ["optimum", "faithful", "literal", "vertex", "sweeps", "levels"];
