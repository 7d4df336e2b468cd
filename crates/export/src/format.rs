//! Formats: names, content of their files, writers.

use crate::export::FileName;
use crate::{Export, ExportFailure};
use moldloft_io::vtk::NamedFile;
use moldloft_io::{StructuredGrid, WriteError};
use moldloft_mesh::Blocks;

/// A format with its writer.
pub struct Format {
    /// Its name in commands and calls.
    pub name: &'static str,
    /// Other names of the format.
    pub aliases: &'static [&'static str],
    /// Extension of its files, without the dot.
    pub suffix: &'static str,
    /// Another usual extension of its files, which does not identify the format.
    pub other_suffix: &'static str,
    /// A line about it.
    pub about: &'static str,
    /// Content of its files.
    pub holds: Holds,
    /// The planes x = 0 and y = 0 that its files can name as planes of symmetry.
    pub symmetry: SymmetryPlanes,
    /// Treatment of lids.
    pub lids: Lids,
    /// True if the immersed part alone can be written.
    pub immersed: bool,
    /// True if the main file is text.
    pub text: bool,
    /// Makes the files. The main one is named [`Export::main`].
    pub write: fn(&mut Export<'_>) -> Result<Vec<NamedFile>, ExportFailure>,
    /// Makes the files of grids of points, if the format holds these.
    pub grids: Option<GridsEncoder>,
    /// Makes the files of the cells of solids, if the format holds these.
    pub volume: Option<CellsEncoder>,
}

/// Makes files of grids of points with their names; the last name is that of the main file.
pub type GridsEncoder =
    fn(&[StructuredGrid], &[String], &FileName<'_>) -> Result<Vec<NamedFile>, WriteError>;

/// Makes files of the cells of solids; the name is that of the main file.
pub type CellsEncoder = fn(&SolidCells<'_>, &FileName<'_>) -> Result<Vec<NamedFile>, WriteError>;

/// The cells of solids, with what their model states.
#[derive(Clone, Copy, Debug)]
pub struct SolidCells<'a> {
    /// The cells.
    pub blocks: &'a Blocks,
    /// The planes of symmetry, such as "y".
    pub symmetry: &'a str,
    /// The unit of length; empty without one.
    pub length: &'a str,
}

impl Format {
    /// Defaults: panels of all patches, one side, binary.
    pub const PANELS: Self = Self {
        name: "",
        aliases: &[],
        suffix: "",
        other_suffix: "",
        about: "",
        holds: Holds::Panels,
        symmetry: SymmetryPlanes::None,
        lids: Lids::Patches,
        immersed: false,
        text: false,
        write: |_| Ok(Vec::new()),
        grids: None,
        volume: None,
    };

    /// Defaults of formats for the cells of solids.
    pub const VOLUME: Self =
        Self { holds: Holds::Volumes, write: |e| e.write_volume(), ..Self::PANELS };

    /// Defaults of panel codes: text, the skin, lids on request, both planes of symmetry.
    pub const PANEL_CODE: Self = Self {
        holds: Holds::Panels,
        symmetry: SymmetryPlanes::Both,
        lids: Lids::Asked,
        immersed: true,
        text: true,
        ..Self::PANELS
    };

    /// True if lids are written only on request.
    pub fn asks_for_lids(&self) -> bool {
        self.lids != Lids::Patches
    }

    /// The name of the main file of a model.
    pub fn file_name(&self, stem: &str) -> String {
        format!("{stem}.{}", self.suffix)
    }
}

/// Contents of a format's files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// Panels.
    Panels,
    /// Panels, and the wires and points of bodies.
    PanelsAndLines,
    /// Structured patches.
    Grids,
    /// The surfaces themselves.
    Surfaces,
    /// The cells of solids.
    Volumes,
    /// A drawing.
    Drawing,
    /// The model itself.
    Model,
}

impl Holds {
    /// The word for tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Panels => "panels",
            Self::PanelsAndLines => "panels, lines, points",
            Self::Grids => "grids",
            Self::Surfaces => "surfaces",
            Self::Volumes => "volumes",
            Self::Drawing => "drawing",
            Self::Model => "model",
        }
    }
}

/// The planes of symmetry that a file can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymmetryPlanes {
    /// None: one side is written as it is.
    None,
    /// y = 0; a model that is mirrored in x = 0 too is written with both sides of it.
    Y,
    /// y = 0, or both; a model that is mirrored in x = 0 alone is written with both sides.
    YThenX,
    /// Either; a model mirrored in both is written with both sides of x = 0.
    Either,
    /// Either, or both.
    Both,
}

impl SymmetryPlanes {
    /// True when a file can name x = 0 for a model that is mirrored in y = 0 or not mirrored at
    /// all.
    pub fn names_x(self, mirror_y: bool) -> bool {
        match self {
            Self::None | Self::Y => false,
            Self::YThenX => mirror_y,
            Self::Either => !mirror_y,
            Self::Both => true,
        }
    }
}

/// Treatment of lids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lids {
    /// Written as patches like any other.
    Patches,
    /// Written on request.
    Asked,
    /// Written to a file of their own on request.
    OwnFile,
}
