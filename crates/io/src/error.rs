//! Errors of readers and writers: fault of the data, and position in the file.

use moldloft_mesh::{Blocks, Mesh, MeshError};
use moldloft_num::Vec3;
use std::fmt;

/// Reason why a mesh cannot be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WriteError {
    /// A position is NaN or infinite, or beyond the range of the format's numbers.
    NotFinite {
        /// A patch that uses the vertex.
        patch: String,
        /// The vertex.
        vertex: u32,
    },
    /// More items than the format can number.
    TooLarge {
        /// Name of the items.
        what: &'static str,
        /// Number of items.
        count: usize,
    },
    /// A patch without a grid, in a structured format.
    NoGrid {
        /// The patches without a grid; empty when there are no patches at all.
        patches: Vec<String>,
    },
    /// A grid without cells, or a block among surfaces.
    NoSurface {
        /// The format.
        format: &'static str,
        /// The grid.
        name: String,
        /// Points along i, j and k.
        size: [usize; 3],
    },
    /// A mesh declared as one half extends to both sides of its symmetry plane.
    BothSides {
        /// `x` or `y`: the coordinate that changes sign.
        axis: char,
        /// A patch beyond the plane.
        patch: String,
    },
    /// The model contains something that the format cannot hold.
    CannotHold {
        /// The format.
        format: &'static str,
        /// Unsupported content.
        what: &'static str,
    },
    /// An object has a dimension that the format cannot hold.
    NoPlace {
        /// The format.
        format: &'static str,
        /// `wires` or `points`.
        what: &'static str,
        /// The object.
        name: String,
    },
    /// A panel extends above the water, which the format does not allow.
    AboveWater {
        /// The format.
        format: &'static str,
        /// A patch with such a panel.
        patch: String,
    },
    /// The positions are too far from the origin for the format's single precision.
    Single {
        /// The format.
        format: &'static str,
        /// A patch that would lose its shape.
        patch: String,
        /// Spacing of representable numbers there.
        step: Bits,
    },
    /// A cell of a grid is too thin for the format's single precision.
    Thin {
        /// The format.
        format: &'static str,
        /// The block, counted from 1, and the indices of both points, from 1.
        place: [usize; 7],
        /// Their distance, and its value in single precision.
        length: [Bits; 2],
    },
    /// Cancelled by the caller.
    Ended,
    /// A number does not fit its column.
    TooWide {
        /// The format.
        format: &'static str,
        /// The number.
        value: Bits,
    },
}

/// A number compared by its bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bits(u64);

impl Bits {
    /// The bits of a number.
    pub fn of(x: f64) -> Self {
        Self(x.to_bits())
    }

    /// The number.
    pub fn value(self) -> f64 {
        f64::from_bits(self.0)
    }
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { patch, vertex } => write!(
                f,
                "vertex {vertex} of patch `{patch}` is not a finite position that the format holds"
            ),
            Self::TooLarge { what, count } => {
                write!(f, "{count} {what} are more than the format can count")
            }
            Self::NoGrid { patches } if patches.is_empty() => {
                write!(f, "no structured grid to write")
            }
            Self::NoGrid { patches } => {
                write!(f, "no structured grid in patch `{}`", patches.join("`, `"))
            }
            Self::NoSurface { format, name, size: [i, j, k] } => write!(
                f,
                "{format} takes surfaces of two lines or more each way, but `{name}` has {i} x {j} x {k} points"
            ),
            Self::NoPlace { format, what, name } => {
                write!(f, "{format} cannot hold the {what} of `{name}`; obj and vtp can")
            }
            Self::CannotHold { format, what } => write!(f, "{format} cannot hold {what}"),
            Self::AboveWater { format, patch } => write!(
                f,
                "{format} takes no panels above the water, z = 0, but patch `{patch}` reaches above it"
            ),
            Self::Single { format, patch, step } => write!(
                f,
                "{format} has single precision, of steps of {} so far from the origin, in which patch `{patch}` loses \
                 its shape; move the model to the origin, or write stl-text, obj or ply",
                step.value()
            ),
            Self::Thin { format, place: [block, i, j, k, to @ ..], length: [exact, rounded] } => {
                write!(
                    f,
                    "in {format} with single precision points ({i}, {j}, {k}) and ({}, {}, {}) of block {block} would be {:.3e} \
                 apart, where they are {:.3e}; write double precision",
                    to[0],
                    to[1],
                    to[2],
                    rounded.value(),
                    exact.value()
                )
            }
            Self::Ended => write!(f, "the work was ended"),
            Self::TooWide { format, value } => {
                write!(f, "the coordinate {} does not fit a column of {format}", value.value())
            }
            Self::BothSides { axis, patch } => write!(
                f,
                "a half mirrored in {axis} = 0 must stay on one side, but patch `{patch}` crosses it"
            ),
        }
    }
}

impl std::error::Error for WriteError {}

/// A position in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilePosition {
    /// A line of text, from 1.
    Line(usize),
    /// A byte, from 0.
    Byte(usize),
    /// A block of a grid, from 1.
    Block(usize),
}

/// Reason why bytes are not a file of a format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// Name of the format.
    pub format: &'static str,
    /// Position.
    pub place: FilePosition,
    /// Expected input.
    pub expected: String,
    /// Found input.
    pub found: String,
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (word, number) = match self.place {
            FilePosition::Line(line) => ("line", line),
            FilePosition::Byte(byte) => ("byte", byte),
            FilePosition::Block(block) => ("block", block),
        };
        let Self { format, expected, found, .. } = self;
        write!(f, "{format}, {word} {number}: expected {expected}, found {found}")
    }
}

impl std::error::Error for ReadError {}

impl ReadError {
    /// The error for a mesh that cannot be built from the data.
    pub(crate) fn mesh(format: &'static str, place: FilePosition, error: MeshError) -> Self {
        Self { format, place, expected: "a mesh".into(), found: error.to_string() }
    }
}

/// Refuses vertices of faces or grids whose coordinates exceed `limit`, NaN included.
pub(crate) fn check_positions(mesh: &Mesh, limit: f64) -> Result<(), WriteError> {
    let good = |v: u32| mesh.positions()[v as usize].to_array().iter().all(|x| x.abs() <= limit);
    for patch in mesh.patches() {
        let faces = mesh.faces()[patch.faces.clone()].iter().flatten();
        let grid = patch.block.iter().flat_map(|b| &b.vertices);
        if let Some(&vertex) = faces.chain(grid).find(|&&v| !good(v)) {
            return Err(WriteError::NotFinite { patch: patch.info.name.clone(), vertex });
        }
    }
    Ok(())
}

/// The largest change of the area vectors of a patch by single precision, relative to its area.
const LOST: f64 = 0.01;

/// Refuses a mesh with a patch that loses its shape in single precision, with positions relative to
/// `origin`.
pub(crate) fn check_single(
    mesh: &Mesh,
    origin: Vec3,
    format: &'static str,
) -> Result<(), WriteError> {
    let at = |v: u32| mesh.positions()[v as usize] - origin;
    let rounded = |p: Vec3| p.map(|x| f64::from(x as f32));
    let largest =
        mesh.positions().iter().flat_map(|p| p.to_array()).fold(0.0f64, |m, x| m.max(x.abs()));
    for patch in mesh.patches() {
        let (mut all, mut lost) = (0.0, 0.0);
        for face in &mesh.faces()[patch.faces.clone()] {
            let [a, b, c, d] = face.map(at);
            let exact = (c - a).cross(d - b);
            let [a, b, c, d] = [a, b, c, d].map(rounded);
            all += exact.norm();
            lost += (exact - (c - a).cross(d - b)).norm();
        }
        if lost > LOST * all && all > 0.0 {
            let largest = largest as f32;
            let step = f64::from(f32::from_bits(largest.to_bits() + 1)) - f64::from(largest);
            let patch = patch.info.name.clone();
            return Err(WriteError::Single { format, patch, step: Bits::of(step) });
        }
    }
    Ok(())
}

/// Refuses volume meshes without blocks, and vertices whose coordinates exceed `limit`, NaN
/// included.
pub(crate) fn check_blocks(blocks: &Blocks, limit: f64) -> Result<(), WriteError> {
    if blocks.blocks().is_empty() {
        return Err(WriteError::NoGrid { patches: vec![] });
    }
    let good = |v: u32| blocks.positions()[v as usize].to_array().iter().all(|x| x.abs() <= limit);
    for block in blocks.blocks() {
        if let Some(&vertex) = block.vertices.iter().find(|&&v| !good(v)) {
            return Err(WriteError::NotFinite { patch: block.name.clone(), vertex });
        }
    }
    Ok(())
}
