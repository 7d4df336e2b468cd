//! Between the two forms of a model: programs and model files.
//!
//! A model file becomes a program with one statement an object, in the order of the file (parents
//! first), and converts back to the same objects and numbers. Records without a counterpart in the
//! language are kept in comments that begin with `#ms2`. A program becomes a model file of the
//! objects that it makes; its parameters, variables and expressions stay relations where the file
//! format can state them.

use crate::document::{Document, ObjectSource};
use moldloft_diag::Diagnostic;
use moldloft_lang::model_file::{prevents_conversion, quoted, to_model_file, to_program};
use moldloft_lang::source::fault_location::unplaced;
use moldloft_registry::CallError;
use moldloft_syntax::sdl;

/// Text formats of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelFormat {
    /// A program.
    Sdl,
    /// A MultiSurf model file, in the version of its header or 1.44.
    ModelFile,
}

impl Document {
    /// Text of the model in format `to`; canonical text when it has this format already.
    ///
    /// # Errors
    /// The errors of the model, or the objects that the format cannot represent.
    ///
    /// # Example
    /// ```
    /// use moldloft_document::{Document, ModelFormat, NoFiles, registry};
    /// let text = "MultiSurf 0.35 /y\nAbsPoint P-1 14 1 0 0 3.6;\nEndModel\n";
    /// let model = Document::from_text(registry(), Box::new(NoFiles), "p.ms2", text);
    /// let program = model.convert(ModelFormat::Sdl).unwrap();
    /// assert!(program.ends_with("AbsPoint P_x2d_1(0, 0, 3.6);\n"));
    /// ```
    pub fn convert(&self, to: ModelFormat) -> Result<String, Vec<Diagnostic>> {
        self.convert_with_remarks(to).map(|(text, _)| text)
    }

    /// Warnings about parts of the model that the last exported file does not represent.
    pub fn export_remarks(&self) -> &[Diagnostic] {
        &self.export_remarks
    }

    /// Stores the warnings that [`Document::export_remarks`] returns.
    pub fn set_export_remarks(&mut self, remarks: Vec<Diagnostic>) {
        self.export_remarks = remarks;
    }

    /// As [`Document::convert`], with warnings about what the format does not represent.
    ///
    /// # Errors
    /// The errors of the model, or the objects that the format cannot represent.
    pub fn convert_with_remarks(
        &self,
        to: ModelFormat,
    ) -> Result<(String, Vec<Diagnostic>), Vec<Diagnostic>> {
        // If memory ran out while reading the text back, the fault is not one of the objects.
        self.converted(to).map_err(|faults| match self.budget().poll() {
            Ok(()) => faults,
            Err(spent) => vec![unplaced(&CallError::from(spent))],
        })
    }

    fn converted(&self, to: ModelFormat) -> Result<(String, Vec<Diagnostic>), Vec<Diagnostic>> {
        let objects = self.graph();
        let all = self.text_diagnostics.iter().chain(&self.run_diagnostics);
        let errors: Vec<Diagnostic> =
            all.filter(|d| prevents_conversion(&self.plain, d)).cloned().collect();
        if !errors.is_empty() {
            return Err(errors);
        }
        let text = match (&self.source, to) {
            (ObjectSource::ModelFile(source), ModelFormat::Sdl) => {
                Ok(to_program(source, self.registry(), &self.plain))
            }
            (ObjectSource::ModelFile(source), ModelFormat::ModelFile) => {
                let model = source.model();
                Ok(model.to_canonical(|line| objects.find(model.slice(line.name)).is_none()))
            }
            (ObjectSource::Program, ModelFormat::Sdl) => sdl::format(&self.text()),
            (ObjectSource::Sketch(sketch), ModelFormat::Sdl) => {
                let base = sketch.path.rsplit(['/', '\\']).next().unwrap_or(&sketch.path);
                Ok(format!("load {};\n", quoted(base)))
            }
            (ObjectSource::Program | ObjectSource::Sketch(_), ModelFormat::ModelFile) => {
                let written =
                    to_model_file(self.modules.get(0), &self.plain, self.registry(), &*self.world)?;
                return Ok((written.text, written.remarks));
            }
            (ObjectSource::None, _) => Ok(String::new()),
        };
        text.map(|text| (text, Vec::new()))
    }
}
