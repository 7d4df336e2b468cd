//! Parsed files with their names resolved: every module of a model has one numbering of names.

use crate::World;
use crate::source::sketch_file::SketchFile;
use moldloft_diag::{Diagnostic, Sources, Span};
use moldloft_registry::{Registry, Row};
use moldloft_syntax::sdl::{self, Program, RoutineId, Symbol};
use std::collections::HashMap;
use std::sync::Arc;

/// A name, by number; the same number in all files of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Name(pub u32);

/// A routine of a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoutineAt {
    /// The module, by its number.
    pub module: usize,
    /// The routine, by its number in the module.
    pub routine: RoutineId,
}

/// A parsed file of a model, with names resolved across its files.
#[derive(Debug)]
pub struct Module {
    /// The name of the file, as given by the world.
    pub path: String,
    /// The syntax tree.
    pub program: Program,
    /// The model-wide name of each symbol.
    pub names: Vec<Name>,
    /// The registry's row of each symbol.
    pub rows: Vec<Option<Arc<Row>>>,
    /// Errors in the text of a loaded file; reported in each run.
    pub faults: Vec<Diagnostic>,
    /// True for a built-in library.
    pub library: bool,
}

/// All files of a model, parsed once and executed often.
#[derive(Debug, Default)]
pub struct Modules {
    modules: Vec<Arc<Module>>,
    texts: HashMap<Arc<str>, Name>,
    names: Vec<Arc<str>>,
    /// Loaded files by the name the world gave, and the outcome of each request.
    loaded: HashMap<(usize, String), Result<usize, Diagnostic>>,
    /// Sketch files, and the outcome of each request.
    sketches: Vec<Arc<SketchFile>>,
    sketched: HashMap<(usize, String), Result<Arc<SketchFile>, Diagnostic>>,
}

impl Modules {
    /// The module of that number.
    pub fn get(&self, module: usize) -> &Arc<Module> {
        &self.modules[module]
    }

    /// The module for editing its literals, when no run is active.
    pub fn get_mut(&mut self, module: usize) -> &mut Module {
        Arc::get_mut(&mut self.modules[module]).expect("no run holds on to a module")
    }

    /// The number of modules.
    pub fn len(&self) -> usize {
        self.modules.len()
    }

    /// True before the first module is parsed.
    pub fn is_empty(&self) -> bool {
        self.modules.is_empty()
    }

    /// The model-wide number of a name, assigned on first use.
    pub fn name(&mut self, text: &str) -> Name {
        if let Some(&name) = self.texts.get(text) {
            return name;
        }
        let name = Name(self.names.len() as u32);
        let text: Arc<str> = text.into();
        self.names.push(text.clone());
        self.texts.insert(text, name);
        name
    }

    /// The text of a name.
    pub fn text(&self, name: Name) -> &Arc<str> {
        &self.names[name.0 as usize]
    }

    /// The number of names.
    pub fn name_count(&self) -> usize {
        self.names.len()
    }

    /// Adds a parsed program; `at` replaces the module of that number.
    pub fn add(
        &mut self,
        path: &str,
        program: Program,
        registry: &Registry,
        at: Option<usize>,
    ) -> usize {
        let (names, rows) = self.resolve(&program, registry);
        let module = Arc::new(Module {
            path: path.into(),
            program,
            names,
            rows,
            faults: Vec::new(),
            library: path.starts_with(crate::source::library::FOLDER),
        });
        match at {
            Some(at) => {
                self.modules[at] = module;
                if at == 0 {
                    // A new text reads all files again: they may have changed.
                    self.loaded.clear();
                    self.sketched.clear();
                } else {
                    self.loaded.retain(|(from, _), _| *from != at);
                    self.sketched.retain(|(from, _), _| *from != at);
                }
                at
            }
            None => {
                self.modules.push(module);
                self.modules.len() - 1
            }
        }
    }

    /// Adds an expression temporarily; removed by [`Self::remove_expression`].
    pub fn add_expression(&mut self, program: Program, registry: &Registry) -> usize {
        self.add("", program, registry, None)
    }

    /// Removes the expression added last.
    pub fn remove_expression(&mut self, at: usize) {
        if at + 1 == self.modules.len() {
            self.modules.pop();
        }
    }

    fn resolve(
        &mut self,
        program: &Program,
        registry: &Registry,
    ) -> (Vec<Name>, Vec<Option<Arc<Row>>>) {
        (0..program.symbol_count() as u32)
            .map(|k| {
                let text = program.name(Symbol(k));
                (self.name(text), registry.get(text).cloned())
            })
            .unzip()
    }

    /// Resolves the rows again after a change of the registry.
    pub fn relink(&mut self, registry: &Registry) {
        for module in &mut self.modules {
            let module = Arc::get_mut(module).expect("no run holds on to a module");
            for (k, row) in module.rows.iter_mut().enumerate() {
                *row = registry.get(module.program.name(Symbol(k as u32))).cloned();
            }
        }
    }

    /// The module for `load "path"` in module `from`, read and parsed on first use, with the
    /// diagnostics of its text reported once.
    pub fn load(
        &mut self,
        from: usize,
        path: &str,
        span: Span,
        loader: &mut Loader<'_>,
    ) -> Result<usize, Diagnostic> {
        if let Some(known) = self.loaded.get(&(from, path.to_string())) {
            return known.clone();
        }
        let outcome = self.read(from, path, span, loader);
        self.loaded.insert((from, path.to_string()), outcome.clone());
        outcome
    }

    /// The sketch file for `load "path"` in module `from`, run on first use.
    pub fn load_sketch(
        &mut self,
        from: usize,
        path: &str,
        span: Span,
        loader: &mut Loader<'_>,
    ) -> Result<Arc<SketchFile>, Diagnostic> {
        if let Some(known) = self.sketched.get(&(from, path.to_string())) {
            return known.clone();
        }
        let outcome = self.read_sketch(from, path, span, loader);
        self.sketched.insert((from, path.to_string()), outcome.clone());
        outcome
    }

    fn read_sketch(
        &mut self,
        from: usize,
        path: &str,
        span: Span,
        loader: &mut Loader<'_>,
    ) -> Result<Arc<SketchFile>, Diagnostic> {
        let from_path = self.modules[from].path.clone();
        let read = loader
            .world
            .read(path, Some(&from_path))
            .map_err(|e| Diagnostic::error("cannot-read", e.message).at(span).maybe_help(e.help))?;
        let text = moldloft_syntax::decode(&read.bytes, &read.name).map_err(|d| d.or_at(span))?;
        // A text that is the same as before was run before.
        let known = self.sketches.iter().find(|s| {
            s.path == read.name && loader.sources.text(s.file).is_some_and(|t| **t == *text)
        });
        if let Some(known) = known {
            return Ok(known.clone());
        }
        let file = loader.sources.add(read.name.clone(), &*text);
        let sketch = Arc::new(SketchFile::open(&read.name, &text, file, loader.world));
        self.sketches.push(sketch.clone());
        Ok(sketch)
    }

    fn read(
        &mut self,
        from: usize,
        path: &str,
        span: Span,
        loader: &mut Loader<'_>,
    ) -> Result<usize, Diagnostic> {
        // A library loads others from beside the user's program first, as the program itself would.
        let from = if self.modules[from].library { 0 } else { from };
        let from_path = self.modules[from].path.clone();
        let read = loader.world.read(path, Some(&from_path)).or_else(|error| {
            crate::source::library::text(path).ok_or_else(|| {
                let near = crate::source::library::near(path);
                Diagnostic::error("cannot-read", error.message)
                    .at(span)
                    .maybe_help(error.help)
                    .maybe_help(near)
            })
        })?;
        let known = self.modules.iter().position(|m| m.path == read.name);
        if known == Some(0) {
            return Ok(0);
        }
        let text = moldloft_syntax::decode(&read.bytes, &read.name).map_err(|d| d.or_at(span))?;
        let text = if read.name.to_ascii_lowercase().ends_with(".ms2") {
            (loader.converted)(&read.name, &text, loader.registry).map_err(|d| d.at(span))?
        } else {
            text.into_owned()
        };
        let text = text.as_str();
        let file = known.and_then(|_| loader.sources.find(&read.name));
        if let (Some(at), Some(file)) = (known, file)
            && loader.sources.text(file).is_some_and(|before| **before == *text)
        {
            return Ok(at);
        }
        let file = match file {
            Some(file) => {
                loader.sources.replace(file, text);
                file
            }
            None => loader.sources.add(read.name.clone(), text),
        };
        let (program, found) = sdl::parse(text, file);
        let ending = std::path::Path::new(&read.name).extension();
        let named_as_program =
            ending.is_none_or(|e| e.eq_ignore_ascii_case("sdl") || e.eq_ignore_ascii_case("ms2"));
        if !named_as_program && found.iter().any(Diagnostic::is_error) {
            let message = format!("cannot read `{path}`: it is not a program");
            return Err(Diagnostic::error("cannot-read", message)
                .at(span)
                .expected("a program (.sdl), a model file (.ms2) or a sketch (.skt)")
                .help(format!(
                    "`moldloft convert {path} -o NAME.sdl` makes a program of a CAD file, a mesh or a table"
                )));
        }
        let at = self.add(&read.name, program, loader.registry, known);
        self.get_mut(at).faults = found;
        Ok(at)
    }
}

/// Context for loading a file.
pub struct Loader<'a> {
    /// The files that may be read.
    pub world: &'a dyn World,
    /// The rows of everything that can be called.
    pub registry: &'a Registry,
    /// The source texts, for spans in diagnostics.
    pub sources: &'a mut Sources,
    /// Diagnostics of the texts read.
    pub diagnostics: &'a mut Vec<Diagnostic>,
    /// The program of a model file.
    pub converted: Convert,
}

/// Converts a model file, given by name and text, to a program.
pub type Convert = fn(&str, &str, &Registry) -> Result<String, Diagnostic>;
