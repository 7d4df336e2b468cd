//! Built-in functions that write arrays of points as grid files and read such files.
//!
//! Files are whole: each call writes one, into the set that the host commits. CGNS is HDF5, which the
//! host writes: the run keeps the blocks and their names for it.

use crate::functions::block_files::{CgnsBlocks, NamedBlock, face_names, joined, one_mesh, whole};
use crate::functions::builtins::{GridFormat, RowFormat};
use crate::functions::plots::plot;
use crate::run::interpreter::{Interpreter, silent};
use crate::run::usage;
use crate::source::module::Module;
use crate::value::variables;
use moldloft_diag::Diagnostic;
use moldloft_grid::FaceNames;
use moldloft_io::plot3d::{self, Laid, Variant};
use moldloft_io::{StructuredGrid, WriteError, hexahedra, points, section, stl, vtk};
use moldloft_model::Extent;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{ArrayShape, Scalar, Value, Vectors};
use moldloft_syntax::sdl::ExprId;
use std::sync::Arc;

type Evaluated<T> = Result<Value<T>, Diagnostic>;

/// The words that choose a variant of Plot3D, the usual ones first.
const VARIANTS: &str = "stream, records, text; double, single; multi, single-block; 3d, 2d; whole, planes; little, \
                        big; iblank; mark8";

/// The variant that words choose.
fn variant(words: &str) -> Result<Variant, Diagnostic> {
    let mut v = Variant::default();
    for word in words.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty()) {
        match word.to_ascii_lowercase().as_str() {
            "stream" | "binary" => v.laid = Laid::Stream,
            "records" | "fortran" | "unformatted" => v.laid = Laid::Unformatted,
            "text" | "ascii" | "formatted" => v.laid = Laid::Formatted,
            "double" => v.double = true,
            "single" => v.double = false,
            "multi" | "multi-block" => v.multi = true,
            "single-block" => v.multi = false,
            "3d" => v.three = true,
            "2d" => v.three = false,
            "whole" => v.planes = false,
            "planes" => v.planes = true,
            "little" => v.big_endian = false,
            "big" => v.big_endian = true,
            "iblank" => v.iblank = true,
            "mark4" => v.mark = 4,
            "mark8" => v.mark = 8,
            _ => {
                return Err(Diagnostic::error(
                    "unknown-word",
                    format!("Plot3D has no variant \"{word}\""),
                )
                .expected(VARIANTS)
                .found(format!("\"{word}\"")));
            }
        }
    }
    Ok(v)
}

fn grid<T: Real>(a: &Vectors<T>) -> StructuredGrid {
    let [m, n] = match a.shape {
        ArrayShape::Row(n) => [n, 1],
        ArrayShape::Grid(m, n) => [m, n],
    };
    let plane = |c: usize| (0..m * n).map(|k| a.planes[c][k % m * n + k / m].re() + 0.0).collect();
    StructuredGrid { size: [m, n, 1], planes: [plane(0), plane(1), plane(2)], iblank: None }
}

/// The block whose layers k these surfaces are: what `tfi` of six faces and `hyperbolic` off a surface give.
fn volume<T: Real>(layers: &[Value<T>], written: &str) -> Result<StructuredGrid, Diagnostic> {
    let mut block: Option<StructuredGrid> = None;
    for (k, layer) in layers.iter().enumerate() {
        let Value::Vectors(a) = layer else {
            let found = variables::a(layer);
            let message = format!("item {} of `{written}` is not a layer of a block", k + 1);
            return Err(Diagnostic::error("wrong-type", message)
                .expected("surfaces of one shape")
                .found(found));
        };
        let next = finite(grid(a), a.shape, &format!("layer {} of {written}", k + 1))?;
        match &mut block {
            None => block = Some(next),
            Some(block) => {
                let ([m, n, _], [p, q, _]) = (block.size, next.size);
                if [m, n] != [p, q] {
                    let message = format!("layers 1 and {} of `{written}` differ in shape", k + 1);
                    return Err(Diagnostic::error("shapes-differ", message)
                        .expected(format!("[{m},{n}]"))
                        .found(format!("[{p},{q}]")));
                }
                for (all, plane) in block.planes.iter_mut().zip(next.planes) {
                    all.extend(plane);
                }
                block.size[2] += 1;
            }
        }
    }
    block.ok_or_else(|| {
        Diagnostic::error("wrong-type", format!("`{written}` has no layers"))
            .expected("a list of surfaces")
    })
}

/// The block, if all of its points are finite: files with others are of no use to their readers.
fn finite(
    block: StructuredGrid,
    shape: ArrayShape,
    written: &str,
) -> Result<StructuredGrid, Diagnostic> {
    let bad = |k: &usize| block.planes.iter().any(|plane| !plane[*k].is_finite());
    let Some(k) = (0..block.count()).find(bad) else { return Ok(block) };
    let [ni, ..] = block.size;
    let place = match shape {
        ArrayShape::Row(_) => format!("[{}]", k + 1),
        ArrayShape::Grid(..) => format!("[{},{}]", k % ni + 1, k / ni + 1),
    };
    let [x, y, z] = [0, 1, 2].map(|c| block.planes[c][k]);
    Err(Diagnostic::error("not-finite", format!("point {place} of `{written}` is not finite"))
        .expected("finite coordinates")
        .found(format!("{{{x}, {y}, {z}}}"))
        .help("look for a division by zero in what it was computed from"))
}

fn cannot(error: impl std::fmt::Display) -> Diagnostic {
    let text = error.to_string();
    Diagnostic::error("cannot-write", text.trim_start_matches("error: ").to_string())
}

fn named(
    blocks: Vec<StructuredGrid>,
    names: Vec<String>,
    faces: Vec<FaceNames>,
) -> Vec<NamedBlock> {
    let all = blocks.into_iter().zip(names).zip(faces);
    all.map(|((grid, name), faces)| NamedBlock { grid, name, faces }).collect()
}

/// The stem of a file's name: "body" of "out/body.vts".
fn stem(name: &str) -> &str {
    let last = name.rsplit('/').next().unwrap_or(name);
    last.rsplit_once('.').map_or(last, |(stem, _)| stem)
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Writes the grids given behind the name of a file and its words; `name` is the function's.
    pub(crate) fn write_grids(
        &mut self,
        m: &Module,
        (name, format): (&str, GridFormat),
        given: &[ExprId],
    ) -> Result<(), Diagnostic> {
        if self.run.extent() == Extent::Edit {
            let message = "a queried expression cannot write files";
            return Err(Diagnostic::error("misplaced-assignment", message)
                .expected("an expression that reads the program's variables"));
        }
        let path = self.text(m, given[0])?;
        let at_name = m.program[given[0]].span;
        let mut words: Arc<str> = "".into();
        let mut words_at = at_name;
        let mut blocks: Vec<StructuredGrid> = Vec::new();
        let mut names: Vec<String> = Vec::new();
        let mut faces: Vec<FaceNames> = Vec::new();
        for (k, &arg) in given[1..].iter().enumerate() {
            let span = m.program[arg].span;
            let value = self.operand(m, arg)?;
            self.charge(&value, span)?;
            match &value {
                Value::Text(text) if format.names_faces() && !blocks.is_empty() => {
                    let last = faces.last_mut().expect("there is one for each block");
                    *last = face_names(text).map_err(|d| d.at(span))?;
                }
                Value::Text(text) if k == 0 => (words, words_at) = (text.clone(), span),
                Value::Vectors(a) => {
                    let written = m.program.slice(span).trim().to_string();
                    blocks.push(finite(grid(a), a.shape, &written).map_err(|d| d.at(span))?);
                    names.push(written);
                    faces.push(FaceNames::default());
                }
                Value::List(layers) if !matches!(format, GridFormat::Stl | GridFormat::Csv) => {
                    let written = m.program.slice(span).trim().to_string();
                    blocks.push(volume(layers, &written).map_err(|d| d.or_at(span))?);
                    names.push(written);
                    faces.push(FaceNames::default());
                }
                Value::Numbers(a) if format == GridFormat::Plot3d && !blocks.is_empty() => {
                    let block = blocks.last_mut().expect("there is one");
                    let [ni, nj, _] = block.size;
                    if a.items.len() != ni * nj || a.items.iter().any(|x| x.re().fract() != 0.0) {
                        return Err(Diagnostic::error(
                            "shapes-differ",
                            format!("blanking {} does not fit the preceding surface", a.shape),
                        )
                        .at(span)
                        .expected(format!("a whole number for each of {ni} x {nj} points"))
                        .found(format!("farray{}", a.shape)));
                    }
                    let at = |k: usize| a.items[k % ni * nj + k / ni].re() as i32;
                    block.iblank = Some((0..ni * nj).map(at).collect());
                }
                other => {
                    let found = variables::a(other);
                    return Err(Diagnostic::error(
                        "wrong-type",
                        format!("{name} writes arrays of points"),
                    )
                    .at(span)
                    .expected("a curve or a surface")
                    .found(found));
                }
            }
        }
        if blocks.is_empty() {
            return Err(Diagnostic::error(
                "missing-argument",
                format!("{name} has nothing to write"),
            )
            .at(at_name)
            .expected("a curve or a surface"));
        }
        let nothing_of = |words: &str, known: &str| match words.trim() {
            "" => Ok(false),
            word if word == known => Ok(true),
            word => {
                let expected = if known.is_empty() { "no words" } else { known };
                Err(Diagnostic::error("unknown-word", format!("{name} has no option \"{word}\""))
                    .at(words_at)
                    .expected(expected.to_string()))
            }
        };
        let at = |d: Diagnostic| d.or_at(at_name);
        let count: usize = blocks.iter().map(StructuredGrid::count).sum();
        match format {
            GridFormat::Plot3d => {
                let mut v = variant(&words).map_err(|d| d.or_at(words_at))?;
                v.iblank |= blocks.iter().any(|b| b.iblank.is_some());
                if v.iblank {
                    for block in &mut blocks {
                        let all = || vec![1; block.planes[0].len()];
                        block.iblank = Some(block.iblank.take().unwrap_or_else(all));
                    }
                }
                let bytes = self.apart(count, at_name, move || plot3d::write(&blocks, v))?;
                self.env.files.put(&path, bytes.map_err(|e| at(cannot(e)))?).map_err(at)
            }
            GridFormat::Vts => {
                nothing_of(&words, "")?;
                let folder = path.rfind('/').map_or("", |k| &path[..=k]);
                let stem = stem(&path).to_string();
                let files = self.apart(count, at_name, move || vtk::grid_files(&blocks, &stem))?;
                for file in files.map_err(|e| at(cannot(e)))? {
                    let name = format!("{folder}{}", file.name);
                    self.env.files.put(&name, file.bytes).map_err(at)?;
                }
                Ok(())
            }
            GridFormat::Plot => {
                let budget = self.inputs.budget;
                let bytes = plot(&path, &words, &blocks, &names, budget).map_err(|d| {
                    let place = if d.id == "unknown-word" { words_at } else { at_name };
                    d.or_at(place)
                })?;
                self.env.files.put(&path, bytes).map_err(at)
            }
            GridFormat::Stl => {
                let flip = nothing_of(&words, "flip")?;
                let budget = self.inputs.budget;
                let go_on = || !budget.is_spent();
                let bytes = stl::write_grids(&blocks, stem(&path), flip, &go_on);
                let bytes = bytes.map_err(|e| match budget.poll() {
                    Err(reason) if e == WriteError::Ended => at(usage::spent(reason)),
                    _ => at(cannot(e)),
                })?;
                self.env.files.put(&path, bytes).map_err(at)
            }
            GridFormat::Cgns => {
                nothing_of(&words, "")?;
                let flat = blocks.iter().filter(|b| b.size[2] == 1).count();
                if flat != 0 && flat != blocks.len() {
                    return Err(at(Diagnostic::error("cannot-write", "surfaces among blocks")
                        .expected("surfaces, or blocks, in one file")));
                }
                if let Some(k) = blocks.iter().position(|b| b.size[0] < 2 || b.size[1] < 2) {
                    let message = format!("CGNS cannot hold `{}`: it has no cells", names[k]);
                    return Err(at(Diagnostic::error("cannot-write", message)
                        .expected("surfaces with at least two points along each index")));
                }
                let (bytes, content) = self.apart(count, at_name, move || {
                    let bytes = plot3d::write(&blocks, Variant::default());
                    let content = match flat {
                        0 => joined(&named(blocks, names, faces)),
                        _ => Ok(CgnsBlocks { names, ..CgnsBlocks::default() }),
                    };
                    (bytes, content)
                })?;
                self.env.files.put(&path, bytes.map_err(|e| at(cannot(e)))?).map_err(at)?;
                self.env.files.for_cgns(&path, content.map_err(at)?).map_err(at)
            }
            GridFormat::Su2 | GridFormat::Gmsh | GridFormat::BlockMesh => {
                nothing_of(&words, "")?;
                if let Some(k) = blocks.iter().position(|b| b.size.iter().any(|n| *n < 2)) {
                    let message = format!("`{}` is not a block of cells", names[k]);
                    return Err(at(Diagnostic::error("cannot-write", message)
                        .expected("blocks with at least two points along each index")));
                }
                let bytes = self.apart(count, at_name, move || {
                    let mesh = one_mesh(&named(blocks, names, faces));
                    match format {
                        GridFormat::Su2 => whole(hexahedra::su2(&mesh), &mesh, "SU2"),
                        GridFormat::Gmsh => whole(hexahedra::gmsh(&mesh), &mesh, "Gmsh"),
                        _ => Ok(hexahedra::block_mesh(&mesh)),
                    }
                })?;
                self.env.files.put(&path, bytes.map_err(at)?).map_err(at)
            }
            GridFormat::Csv => {
                nothing_of(&words, "")?;
                let rows: Vec<Vec3> = blocks.iter().flat_map(StructuredGrid::points).collect();
                if !rows.iter().all(|p| p.is_finite()) {
                    return Err(at(cannot("a point is not finite")));
                }
                let text = self.apart(count, at_name, move || points::write_csv(&rows, 3))?;
                self.env.files.put(&path, text.into_bytes()).map_err(at)
            }
        }
    }

    pub(crate) fn bytes_of(
        &mut self,
        m: &Module,
        arg: ExprId,
    ) -> Result<(Arc<str>, Vec<u8>), Diagnostic> {
        let path = self.text(m, arg)?;
        let from = self.modules.get(0).path.clone();
        let bytes = self.env.files.bytes(self.loader.world, &from, &path);
        Ok((path, bytes.map_err(|d| d.or_at(m.program[arg].span))?))
    }

    /// `read_p3d("body.x")`, `read_p3d("body.x", 2)`.
    pub(crate) fn read_p3d(&mut self, m: &Module, given: &[ExprId]) -> Evaluated<T> {
        let (path, bytes) = self.bytes_of(m, given[0])?;
        let unreadable = |e: &dyn std::fmt::Display| {
            Diagnostic::error("cannot-read", format!("cannot read `{path}`: {e}"))
        };
        let blocks =
            self.apart(bytes.len(), m.program[given[0]].span, move || plot3d::read(&bytes))?;
        let (blocks, _) = blocks.map_err(|e| unreadable(&e))?;
        let number = match given.get(1) {
            Some(&arg) => self.whole(m, arg)? as usize,
            None => 1,
        };
        let Some(block) = blocks.get(number - 1) else {
            let message = format!("`{path}` has no block {number}");
            return Err(Diagnostic::error("outside", message)
                .expected(format!("a block from 1 to {}", blocks.len()))
                .found(number.to_string()));
        };
        Ok(self.grid_value(block))
    }

    /// A surface, or the layers of a block.
    pub(crate) fn grid_value(&self, block: &StructuredGrid) -> Value<T> {
        let [ni, nj, nk] = block.size;
        let layer = |k: usize| {
            let points = block.layer(k).into_iter().map(Vec3::lifted).collect();
            self.points(ArrayShape::Grid(ni, nj), points)
        };
        if nk == 1 { layer(0) } else { Value::list((0..nk).map(layer)) }
    }

    /// `count_p3d("body.x")`.
    pub(crate) fn count_p3d(&mut self, m: &Module, file: ExprId) -> Evaluated<T> {
        let (path, bytes) = self.bytes_of(m, file)?;
        let blocks = self.apart(bytes.len(), m.program[file].span, move || plot3d::read(&bytes))?;
        let (blocks, _) = blocks
            .map_err(|e| Diagnostic::error("cannot-read", format!("cannot read `{path}`: {e}")))?;
        Ok(Value::Number(T::from(blocks.len() as f64)))
    }

    /// The points of a text.
    pub(crate) fn read_rows(
        &mut self,
        m: &Module,
        format: RowFormat,
        given: &[ExprId],
    ) -> Evaluated<T> {
        let (path, bytes) = self.bytes_of(m, given[0])?;
        let unreadable = |e: &dyn std::fmt::Display| {
            Diagnostic::error("cannot-read", format!("cannot read `{path}`: {e}"))
        };
        let points = self.apart(bytes.len(), m.program[given[0]].span, move || match format {
            RowFormat::Points => points::read(&bytes).map(|table| table.rows),
            RowFormat::Aerofoil => section::read_aerofoil(&bytes).map(|section| section.points),
        })?;
        let points = points.map_err(|e| unreadable(&e))?;
        let points: Vec<Vec3<T>> = points.into_iter().map(Vec3::lifted).collect();
        if points.is_empty() {
            return Err(silent());
        }
        Ok(self.points(ArrayShape::Row(points.len()), points))
    }

    fn points(&self, shape: ArrayShape, points: Vec<Vec3<T>>) -> Value<T> {
        Value::Vectors(Arc::new(Vectors::new(shape, points)))
    }
}
