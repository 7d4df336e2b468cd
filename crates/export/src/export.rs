//! One export: the document, the name of the main file, the options, and the services for rows of
//! the table.

use crate::{Format, Holds, SolidCells, SymmetryPlanes, length_unit, stated_length};
use moldloft_diag::Diagnostic;
use moldloft_document::{Document, Panelled, PatchAnalysis};
use moldloft_io::vtk::{self, NamedFile};
use moldloft_io::{LinesAndPoints, StructuredGrid, WriteError};
use moldloft_mesh::Mesh;
use moldloft_num::Fineness;
use moldloft_registry::Value;
use std::ops::Deref;
use std::sync::Arc;

/// Options of an export.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// Write lids among the panels of panel codes, or to a file of their own if the code requires
    /// it.
    pub lids: bool,
    /// Write only the part below z = 0, cut there, in files of panel codes.
    pub immersed: bool,
    /// Only patches with one of these tags; empty: all.
    pub tags: Vec<String>,
    /// Write both sides of a symmetric model, joined in its planes, if the format cannot name these
    /// planes.
    pub whole: bool,
    /// Triangles only.
    pub triangles: bool,
    /// Maximum error of fitted spline patches, default 1e-5 of the model's diagonal; in files of
    /// panels, maximum distance of panels from their surfaces, by default that of their divisions.
    pub tolerance: Option<f64>,
    /// In files of panels, the maximum turn of a surface along a panel, in radians.
    pub angle: Option<f64>,
}

/// Maximum turn along a panel, in radians, if only a distance is given: holes smaller than it stay
/// round.
const USUAL_TURN: f64 = 0.5;

impl WriteOptions {
    /// Required accuracy of panels, if given.
    ///
    /// # Errors
    /// A number that is not positive.
    pub fn fineness(&self) -> Result<Option<Fineness>, Diagnostic> {
        for (name, value) in [("tolerance", self.tolerance), ("angle", self.angle)] {
            if value.is_some_and(|x| !x.is_finite() || x <= 0.0) {
                let message = format!("`{name}` has to be positive");
                return Err(Diagnostic::error("out-of-range", message));
            }
        }
        Ok((self.tolerance.is_some() || self.angle.is_some()).then(|| Fineness {
            angle: self.angle.unwrap_or(USUAL_TURN),
            chord: self.tolerance.unwrap_or(f64::INFINITY),
            side: f64::INFINITY,
        }))
    }
}

/// Reason why a model could not be written.
#[derive(Clone, Debug)]
pub enum ExportFailure {
    /// The format cannot hold it.
    Write(WriteError),
    /// The model is at fault, or the request.
    Model(Vec<Diagnostic>),
}

impl ExportFailure {
    /// The failure as diagnostics, for the format of that name.
    pub fn diagnostics(self, format: &str) -> Vec<Diagnostic> {
        match self {
            Self::Model(diagnostics) => diagnostics,
            Self::Write(error) => {
                let message = format!("cannot write {format}: {error}");
                vec![Diagnostic::error("cannot-write", message)]
            }
        }
    }
}

impl From<WriteError> for ExportFailure {
    fn from(error: WriteError) -> Self {
        Self::Write(error)
    }
}

impl From<Diagnostic> for ExportFailure {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Model(vec![diagnostic])
    }
}

impl From<Vec<Diagnostic>> for ExportFailure {
    fn from(diagnostics: Vec<Diagnostic>) -> Self {
        Self::Model(diagnostics)
    }
}

/// The files of a model in one format; `main` is the name of the first one, without folder.
///
/// # Errors
/// Unsupported options, content that the format cannot represent, errors of the model.
pub fn write(
    document: &mut Document,
    format: &'static Format,
    main: &str,
    options: &WriteOptions,
) -> Result<Vec<NamedFile>, Vec<Diagnostic>> {
    refuse_options(format, options).map_err(|d| vec![d])?;
    let main = FileName(main);
    document.set_export_remarks(Vec::new());
    let mut export = Export { document, format, main, options: options.clone() };
    let files = (format.write)(&mut export).map_err(|failure| failure.diagnostics(format.name))?;
    if STATE_UNIT.contains(&format.name)
        && let Some(warning) = document.assumed_unit()
    {
        let remarks = document.export_remarks().iter().cloned().chain([warning]).collect();
        document.set_export_remarks(remarks);
    }
    Ok(files)
}

/// Formats that state a unit of length.
const STATE_UNIT: [&str; 4] = ["step", "iges", "3mf", "glb"];

/// Refuses options without an effect on the format.
fn refuse_options(format: &Format, options: &WriteOptions) -> Result<(), Diagnostic> {
    let error = |message: String| Err(Diagnostic::error("unused-option", message));
    let name = format.name;
    let names = |takes: fn(&Format) -> bool| {
        let all: Vec<&str> = crate::FORMATS.iter().filter(|f| takes(f)).map(|f| f.name).collect();
        all.join(", ")
    };
    let of_panels = matches!(format.holds, Holds::Panels | Holds::PanelsAndLines);
    if options.tolerance.is_some() && format.holds != Holds::Surfaces && !of_panels {
        return error(format!("a tolerance is for fitted patches and panels, not for {name}"));
    }
    if options.angle.is_some() && !of_panels {
        return error(format!("an angle is for panels, not for {name}"));
    }
    if (options.whole || options.triangles)
        && !(of_panels && format.symmetry == SymmetryPlanes::None)
    {
        let option = if options.whole { "whole" } else { "triangles" };
        let meshes = names(|f| {
            matches!(f.holds, Holds::Panels | Holds::PanelsAndLines)
                && f.symmetry == SymmetryPlanes::None
        });
        return error(format!("`{option}` is for files of plain panels, {meshes}"));
    }
    let whole = matches!(format.holds, Holds::Surfaces | Holds::Volumes);
    if whole && (options.immersed || !options.tags.is_empty()) {
        let option = if options.immersed { "immersed" } else { "tags" };
        return error(format!("`{option}` is not for {name}, which takes whole surfaces"));
    }
    if options.lids && !format.asks_for_lids() || options.immersed && !format.immersed {
        let option = if options.lids { "lids" } else { "immersed" };
        let codes = names(|f| f.immersed);
        return error(format!("`{option}` is for the files of panel codes, {codes}"));
    }
    Ok(())
}

/// The files of volume blocks in one format; `main` is the name of the first one, without folder.
///
/// # Errors
/// A format for other content; content that the format cannot represent.
pub fn write_blocks(
    cells: &SolidCells<'_>,
    format: &Format,
    main: &str,
) -> Result<Vec<NamedFile>, Vec<Diagnostic>> {
    let encode = format.volume.ok_or_else(|| vec![no_format(format, "cells of solids")])?;
    encode(cells, &FileName(main)).map_err(|e| ExportFailure::Write(e).diagnostics(format.name))
}

/// The files of grids of points in one format; `main` is the name of the first one, without folder.
///
/// # Errors
/// A format for other content; content that the format cannot represent.
pub fn write_grids(
    grids: &[StructuredGrid],
    names: &[String],
    format: &Format,
    main: &str,
) -> Result<Vec<NamedFile>, Vec<Diagnostic>> {
    let encode = format.grids.ok_or_else(|| vec![no_format(format, "grids of points")])?;
    encode(grids, names, &FileName(main))
        .map_err(|e| ExportFailure::Write(e).diagnostics(format.name))
}

fn no_format(format: &Format, what: &str) -> Diagnostic {
    let message = format!("{} is not a format of {what}", format.name);
    Diagnostic::error("unknown-format", message)
}

/// File name of the main file, without folder.
#[derive(Clone, Copy, Debug)]
pub struct FileName<'a>(pub &'a str);

impl<'a> FileName<'a> {
    /// The name up to its last dot, from which titles and names of other files are derived.
    pub fn stem(&self) -> &'a str {
        match self.0.rfind('.') {
            Some(at) if at > 0 => &self.0[..at],
            _ => self.0,
        }
    }

    /// The main file alone.
    pub fn main_file(&self, bytes: Vec<u8>) -> Vec<NamedFile> {
        vec![NamedFile { name: self.0.into(), bytes }]
    }

    /// The files; the file named after the stem with this ending is the main one.
    pub fn renamed(&self, ending: &str, mut files: Vec<NamedFile>) -> Vec<NamedFile> {
        let usual = format!("{}.{ending}", self.stem());
        if let Some(main) = files.iter_mut().find(|file| file.name == usual) {
            main.name = self.0.into();
        }
        files
    }
}

/// Context of a row's writer.
pub struct Export<'d> {
    /// The model.
    pub document: &'d mut Document,
    /// The row.
    pub format: &'static Format,
    /// File name of the main file.
    pub main: FileName<'d>,
    /// Options.
    pub options: WriteOptions,
}

/// The panels to be written.
pub struct Panels {
    whole: Arc<Panelled>,
    part: Option<Mesh>,
}

impl Deref for Panels {
    type Target = Mesh;

    fn deref(&self) -> &Mesh {
        self.part.as_ref().unwrap_or(&self.whole.mesh)
    }
}

impl Export<'_> {
    /// See [`FileName::stem`].
    pub fn stem(&self) -> &str {
        self.main.stem()
    }

    /// The main file alone.
    pub fn main_file(&self, bytes: Vec<u8>) -> Vec<NamedFile> {
        self.main.main_file(bytes)
    }

    /// The cells of the solids in the row's format.
    ///
    /// # Errors
    /// Cells that cannot be made; content that the format cannot represent.
    pub fn write_volume(&mut self) -> Result<Vec<NamedFile>, ExportFailure> {
        let blocked = self.document.blocked()?;
        let Some(encode) = self.format.volume else { return Ok(Vec::new()) };
        let (symmetry, length) = (self.document.symmetry(), self.stated_length());
        let cells = SolidCells { blocks: &blocked.blocks, symmetry: &symmetry, length: &length };
        Ok(encode(&cells, &self.main)?)
    }

    /// The unit of length that the model states; empty without one.
    pub fn stated_length(&self) -> String {
        stated_length(self.document).unwrap_or_default()
    }

    /// The size of the model's unit of length in metres.
    pub fn metres(&self) -> f64 {
        length_unit(self.document).1 / 1000.0
    }

    /// The panels of the selected patches.
    ///
    /// # Errors
    /// Panels that cannot be made; unknown tags; wires and points, when the format cannot hold
    /// them.
    pub fn panels(&mut self) -> Result<Panels, ExportFailure> {
        let lines = self.lines_and_points();
        let takes_lines = self.format.holds == Holds::PanelsAndLines;
        if !takes_lines {
            lines.refused(self.format.name)?;
        }
        // The spline patches of a solver have a tolerance of their own.
        let mut panels = panels(self.document, &self.options)?;
        if self.options.triangles {
            panels.part = Some(panels.triangulated());
        }
        if panels.faces().is_empty() && (!takes_lines || lines.is_empty()) {
            return Err(nothing_shown(self.format.name).into());
        }
        Ok(panels)
    }

    /// The polylines and points of the shown bodies.
    pub fn lines_and_points(&self) -> LinesAndPoints {
        lines_and_points(self.document)
    }

    /// Fields of the surfaces for viewers.
    ///
    /// # Errors
    /// Panels that cannot be made.
    pub fn surface_fields(&mut self) -> Result<Vec<vtk::PatchFields>, ExportFailure> {
        let field = |f: moldloft_fair::surface::PointField| vtk::VtkArray {
            name: f.name.into(),
            components: f.components,
            values: f.values,
        };
        let patch = |p: PatchAnalysis| vtk::PatchFields {
            patch: p.patch,
            fields: p.fields.into_iter().map(field).collect(),
        };
        Ok(self.document.patch_fields()?.into_iter().map(patch).collect())
    }
}

/// The panels selected by options: tags, both sides, accuracy.
///
/// # Errors
/// Panels that cannot be made; unknown tags; numbers that are not positive.
pub fn panels(document: &mut Document, options: &WriteOptions) -> Result<Panels, Vec<Diagnostic>> {
    document.entire()?;
    let whole = match options.fineness().map_err(|d| vec![d])? {
        Some(fineness) => document.panelled_within(&fineness),
        None => document.panelled(),
    };
    let whole = whole.map_err(|d| vec![d])?;
    let mut part = tagged(&whole.mesh, &options.tags)?;
    if options.whole {
        let letters = document.symmetry();
        for axis in (0..3).filter(|&k| letters.contains(['x', 'y', 'z'][k])) {
            let suffix = [".mirror_x", ".mirror_y", ".mirror_z"][axis];
            let both = part.as_ref().unwrap_or(&whole.mesh).with_mirror_image(axis, suffix);
            part = Some(both.map_err(|e| vec![Diagnostic::error("too-large", e.to_string())])?);
        }
    }
    Ok(Panels { whole, part })
}

impl Panels {
    /// All panels of the model, and the panels to be written if these differ.
    pub fn into_parts(self) -> (Arc<Panelled>, Option<Mesh>) {
        (self.whole, self.part)
    }
}

/// The fault of a file that would hold nothing.
pub(crate) fn nothing_shown(format: &str) -> Diagnostic {
    Diagnostic::error(
        "cannot-write",
        format!("cannot write {format}: there are no panels to write"),
    )
    .expected("a surface or body that is shown")
    .help("remove `visible = 0`; curves go to step, iges, 3dm, dxf and svg")
}

/// The polylines and points of the shown bodies.
pub(crate) fn lines_and_points(document: &Document) -> LinesAndPoints {
    let mut found = LinesAndPoints::default();
    for object in document.graph().objects().filter(|o| o.head.shown()) {
        if let Some(Value::Body(body)) = object.value() {
            let name = object.name.to_string();
            found.wires.extend(body.wires.iter().map(|w| (name.clone(), w.clone())));
            found.dots.extend(body.dots.iter().map(|p| (name.clone(), *p)));
        }
    }
    found
}

/// The patches with one of the tags; `None` for the whole mesh when no tags are given.
///
/// # Errors
/// When no patch has any of them.
pub fn tagged(mesh: &Mesh, tags: &[String]) -> Result<Option<Mesh>, Vec<Diagnostic>> {
    if tags.is_empty() {
        return Ok(None);
    }
    if let Some(tag) = tags.iter().find(|tag| !mesh.patches().iter().any(|p| p.info.is(tag))) {
        let infos = mesh.patches().iter().map(|p| &p.info);
        let mut known: Vec<&str> =
            infos.flat_map(|i| i.tags.iter().map(String::as_str).chain([i.tag.word()])).collect();
        known.sort_unstable();
        known.dedup();
        return Err(vec![
            Diagnostic::error("unknown-tag", format!("no patch has the tag `{tag}`"))
                .expected(known.join(", "))
                .suggest(tag, known.iter().copied()),
        ]);
    }
    let part = mesh.selected(|info| tags.iter().any(|tag| info.is(tag)));
    part.map(Some).map_err(|e| vec![Diagnostic::error("too-large", e.to_string())])
}
