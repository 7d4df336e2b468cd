//! Built-in functions that write arrays of points as grid files and read such files.
//!
//! Files are whole: each call writes one, into the set that the host commits.

use crate::functions::block_files::face_names;
use crate::functions::grid_checks;
use crate::functions::grid_formats::{CONNECTIONS, GridFile, GridFormat};
use crate::functions::grid_values::grid_of;
use crate::functions::joint_report::joint_report;
use crate::functions::named_blocks::NamedBlock;
use crate::functions::run_call::RunCall;
use crate::run::interpreter::{Interpreter, silent};
use crate::source::module::Module;
use crate::value::variables;
use moldloft_budget::Budget;
use moldloft_diag::{Diagnostic, Span};
use moldloft_grid::FaceNames;
use moldloft_io::{StructuredGrid, plot3d, points, section};
use moldloft_model::Extent;
use moldloft_num::{Real, Vec3};
use moldloft_registry::{Array, ArrayShape, Scalar, Value, Vectors};
use moldloft_syntax::sdl::ExprId;
use std::sync::Arc;

type Evaluated<T> = Result<Value<T>, Diagnostic>;

/// Formats that are read as a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RowFormat {
    Points,
    Aerofoil,
}

/// Arguments of a call of `write_...`, collected.
#[derive(Default)]
struct TakenIn {
    blocks: Vec<NamedBlock>,
    /// The blocks of the argument before: boundaries behind a list are those of all its items.
    last: std::ops::Range<usize>,
}

impl TakenIn {
    fn put<T: Real>(
        &mut self,
        value: &Value<T>,
        written: &str,
        format: &GridFormat,
    ) -> Result<(), Diagnostic> {
        let grid = match value {
            Value::Block(_) if !format.blocks => {
                let message = format!("`{written}` is a block");
                return Err(Diagnostic::error("wrong-type", message)
                    .expected("a curve, a surface, or a list of them")
                    .found(variables::a(value)));
            }
            Value::List(items) => {
                // Points in braces are a curve, curves in braces a surface.
                match &*moldloft_arrays::gathered(value) {
                    array @ Value::Vectors(_) => grid_of(array, written)?,
                    _ => {
                        for (k, item) in items.iter().enumerate() {
                            self.put(item, &format!("{written}[{}]", k + 1), format)?;
                        }
                        return Ok(());
                    }
                }
            }
            value => grid_of(value, written)?,
        };
        self.blocks.push(NamedBlock { grid, name: written.into(), faces: FaceNames::default() });
        Ok(())
    }

    /// Names the boundaries of the argument before.
    fn name_faces(&mut self, words: &str) -> Result<(), Diagnostic> {
        for block in &mut self.blocks[self.last.clone()] {
            block.faces = face_names(words, block.grid.size[2] == 1)?;
        }
        Ok(())
    }

    /// Names the boundaries of the list before, a text for each item.
    fn name_each<T: Real>(&mut self, texts: &[Value<T>]) -> Result<(), Diagnostic> {
        if texts.len() != self.last.len() {
            let (n, m) = (self.last.len(), texts.len());
            return Err(Diagnostic::error(
                "shapes-differ",
                format!("{m} texts name the boundaries of {n} blocks"),
            )
            .expected(format!("one text, or {n}"))
            .found(format!("{m} texts")));
        }
        for (k, text) in self.last.clone().zip(texts) {
            let Value::Text(words) = text else { continue };
            let block = &mut self.blocks[k];
            block.faces = face_names(words, block.grid.size[2] == 1)?;
        }
        Ok(())
    }

    /// Blanks the surface before.
    fn blank<T: Real>(&mut self, a: &Array<T>) -> Result<(), Diagnostic> {
        let Some(block) = self.blocks.last_mut() else { return Ok(()) };
        let [ni, nj, _] = block.grid.size;
        if a.items.len() != ni * nj || a.items.iter().any(|x| x.re().fract() != 0.0) {
            let message = format!("blanking {} does not fit the preceding surface", a.shape);
            return Err(Diagnostic::error("shapes-differ", message)
                .expected(format!("a whole number for each of {ni} x {nj} points"))
                .found(format!("farray{}", a.shape)));
        }
        let at = |k: usize| a.items[k % ni * nj + k / ni].re() as i32;
        block.grid.iblank = Some((0..ni * nj).map(at).collect());
        Ok(())
    }
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Writes the grids given behind the name of a file and its words.
    pub(crate) fn write_grids(
        &mut self,
        call: &RunCall<'_>,
        format: &'static GridFormat,
    ) -> Evaluated<T> {
        if self.run.extent() == Extent::Edit {
            let message = "a queried expression cannot write files";
            return Err(Diagnostic::error("misplaced-assignment", message)
                .expected("an expression that reads the program's variables"));
        }
        let path = self.text(call.m, call.first())?;
        let at_name = call.m.program[call.first()].span;
        let (blocks, words) = self.taken_grids(call, format, call.rest(), at_name)?;
        let (words, words_at) = words.unwrap_or(("".into(), at_name));
        let count: usize = blocks.iter().map(|block| block.grid.count()).sum();
        let (file, text) = (path.to_string(), words.to_string());
        let encoded = move |budget: &Budget| {
            let (found, connected) = match grid_checks::checked(&blocks, format) {
                Ok(checked) => checked,
                Err(diagnostic) => return (Vec::new(), Err(diagnostic)),
            };
            let file = GridFile { path: &file, words: &text, blocks, connected, budget };
            (found, (format.encode)(file))
        };
        let (found, encoded) = match format.watches {
            true => encoded(self.inputs.budget),
            false => self.apart(count, at_name, move || encoded(&Budget::default()))?,
        };
        for diagnostic in found {
            self.report(diagnostic.at(at_name));
        }
        let place = |d: Diagnostic| {
            let span = if d.id == "unknown-word" { words_at } else { at_name };
            d.or_at(span)
        };
        for (name, bytes) in encoded.map_err(place)? {
            self.env.files.put(&name, bytes).map_err(place)?;
        }
        Ok(Value::Unset)
    }

    /// The grids given to a function, with the names of their boundaries; and the words before them, with their place.
    fn taken_grids(
        &mut self,
        call: &RunCall<'_>,
        format: &'static GridFormat,
        given: impl Iterator<Item = ExprId>,
        at: Span,
    ) -> Result<(Vec<NamedBlock>, Option<(Arc<str>, Span)>), Diagnostic> {
        let mut words = None;
        let mut taken = TakenIn::default();
        let m = call.m;
        for (k, arg) in given.enumerate() {
            let span = m.program[arg].span;
            let value = self.operand(m, arg)?;
            self.charge(&value, span)?;
            let texts = |items: &[Value<T>]| items.iter().all(|v| matches!(v, Value::Text(_)));
            let done = match &value {
                Value::Text(text) if format.joins && !taken.blocks.is_empty() => {
                    taken.name_faces(text)
                }
                Value::Text(text) if k == 0 => {
                    words = Some((text.clone(), span));
                    Ok(())
                }
                Value::List(items)
                    if format.joins
                        && !taken.blocks.is_empty()
                        && !items.is_empty()
                        && texts(items) =>
                {
                    taken.name_each(items)
                }
                Value::Numbers(a) if format.blanking && !taken.blocks.is_empty() => taken.blank(a),
                value => {
                    let first = taken.blocks.len();
                    let written = m.program.slice(span).trim().to_string();
                    let done = taken.put(value, &written, format);
                    taken.last = first..taken.blocks.len();
                    done
                }
            };
            done.map_err(|d| d.or_at(span))?;
        }
        if taken.blocks.is_empty() {
            return Err(Diagnostic::error(
                "missing-argument",
                format!("{} has nothing to write", call.row.name),
            )
            .at(at)
            .expected("a curve or a surface"));
        }
        Ok((taken.blocks, words))
    }

    /// `interfaces(b1, "k1 = hull wall", b2)`: connections and boundaries of blocks.
    pub(crate) fn interfaces(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let at = call.m.program[call.first()].span;
        let given = std::iter::once(call.first()).chain(call.rest());
        let (blocks, words) = self.taken_grids(call, &CONNECTIONS, given, at)?;
        if let Some((_, span)) = words {
            return Err(Diagnostic::error("wrong-type", "a text names the boundaries of no block")
                .at(span)
                .expected("a block or a surface before it"));
        }
        let count: usize = blocks.iter().map(|block| block.grid.count()).sum();
        let described = move || -> Result<(Vec<Diagnostic>, String), Diagnostic> {
            let (found, connected) = grid_checks::checked(&blocks, &CONNECTIONS)?;
            let flat = blocks.iter().all(|block| block.grid.size[2] == 1);
            let Some(connected) = connected else {
                return Err(Diagnostic::error(
                    "wrong-type",
                    "these arrays have no common boundaries",
                )
                .expected("blocks, or surfaces in one plane, with cells"));
            };
            Ok((found, joint_report(&blocks, &connected, flat)))
        };
        let (found, text) = self.apart(count, at, described)?.map_err(|d| d.or_at(at))?;
        for diagnostic in found {
            self.report(diagnostic.at(at));
        }
        Ok(Value::Text(text.into()))
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

    /// A block of a Plot3D file, and the file's name.
    fn plot3d_block(
        &mut self,
        call: &RunCall<'_>,
    ) -> Result<(Arc<str>, StructuredGrid), Diagnostic> {
        let m = call.m;
        let (path, bytes) = self.bytes_of(m, call.first())?;
        let unreadable = |e: &dyn std::fmt::Display| {
            Diagnostic::error("cannot-read", format!("cannot read `{path}`: {e}"))
        };
        let blocks =
            self.apart(bytes.len(), m.program[call.first()].span, move || plot3d::read(&bytes))?;
        let (mut blocks, _) = blocks.map_err(|e| unreadable(&e))?;
        let number = match call.at(1) {
            Some(arg) => self.whole(m, arg)? as usize,
            None => 1,
        };
        if number > blocks.len() {
            let message = format!("`{path}` has no block {number}");
            return Err(Diagnostic::error("outside", message)
                .expected(format!("a block from 1 to {}", blocks.len()))
                .found(number.to_string()));
        }
        Ok((path, blocks.swap_remove(number - 1)))
    }

    /// `read_p3d("body.x")`, `read_p3d("body.x", 2)`.
    pub(crate) fn read_p3d(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let (path, block) = self.plot3d_block(call)?;
        let blanked = block.iblank.as_ref().is_some_and(|all| all.iter().any(|b| *b != 1));
        if blanked {
            let message = format!("`{path}` is read without its blanking");
            self.report(
                Diagnostic::remark("blanked", message).at(call.m.program[call.first()].span).help(
                    "iblank_p3d(name, block) is the blanking, to be written behind the surface",
                ),
            );
        }
        Ok(self.grid_value(&block))
    }

    /// `iblank_p3d("body.x")`, `iblank_p3d("body.x", 2)`: the blanking of a surface.
    pub(crate) fn iblank_p3d(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let (path, block) = self.plot3d_block(call)?;
        let [ni, nj, nk] = block.size;
        let Some(iblank) = &block.iblank else {
            return Err(Diagnostic::error("cannot-read", format!("`{path}` has no blanking"))
                .expected("a Plot3D file with IBLANK"));
        };
        let layer = |k: usize| {
            let at = |i: usize, j: usize| T::from(f64::from(iblank[i + ni * (j + nj * k)]));
            let items = (0..ni).flat_map(|i| (0..nj).map(move |j| at(i, j))).collect();
            Value::Numbers(Arc::new(Array::grid(ni, nj, items)))
        };
        Ok(match nk {
            1 => layer(0),
            _ => Value::block((0..nk).map(layer)).expect("layers of one shape"),
        })
    }

    /// A surface, or a block.
    pub(crate) fn grid_value(&self, block: &StructuredGrid) -> Value<T> {
        let [ni, nj, nk] = block.size;
        let layer = |k: usize| {
            let points = block.layer(k).into_iter().map(Vec3::lifted).collect();
            self.points(ArrayShape::Grid(ni, nj), points)
        };
        match nk {
            1 => layer(0),
            _ => Value::block((0..nk).map(layer)).expect("layers of one shape"),
        }
    }

    /// `count_p3d("body.x")`.
    pub(crate) fn count_p3d(&mut self, call: &RunCall<'_>) -> Evaluated<T> {
        let (m, file) = (call.m, call.first());
        let (path, bytes) = self.bytes_of(m, file)?;
        let blocks = self.apart(bytes.len(), m.program[file].span, move || plot3d::read(&bytes))?;
        let (blocks, _) = blocks
            .map_err(|e| Diagnostic::error("cannot-read", format!("cannot read `{path}`: {e}")))?;
        Ok(Value::Number(T::from(blocks.len() as f64)))
    }

    /// The points of a text.
    pub(crate) fn read_rows(&mut self, call: &RunCall<'_>, format: RowFormat) -> Evaluated<T> {
        let (m, file) = (call.m, call.first());
        let (path, bytes) = self.bytes_of(m, file)?;
        let unreadable = |e: &dyn std::fmt::Display| {
            Diagnostic::error("cannot-read", format!("cannot read `{path}`: {e}"))
        };
        let points = self.apart(bytes.len(), m.program[file].span, move || match format {
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
