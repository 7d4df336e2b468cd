//! Element-wise statements of code: a pass over the elements.

use super::code::{ArrayKernel, CodeRegion, CodeSection, CodeSubscript, KernelTarget, OF_FILE};
use super::machine::CodeOutcome;
use super::registers::{ArrayItems, ArrayRegister, RegisterMachine, declared_by};
use crate::run::interpreter::{Interpreter, of_array};
use crate::value::initialised::Known;
use crate::value::subarray::{ArraySection, Selection, picked, put, put_all};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{ArrayShape, Scalar};
use moldloft_syntax::sdl::Type;
use smallvec::SmallVec;
use std::borrow::Cow;

/// Results of a pass that are yet to be stored.
type Rows<T> = SmallVec<[Vec<T>; 3]>;

/// The arrays of a pass: which they are, which part is meant, and the shape of that.
struct Located {
    at: usize,
    section: Option<ArraySection>,
    shape: ArrayShape,
}

impl<T: Scalar> RegisterMachine<T> {
    fn array_at(&self, array: u16) -> usize {
        match array & OF_FILE {
            0 => self.first_array + array as usize,
            _ => (array & !OF_FILE) as usize,
        }
    }

    fn number(&self, register: u16) -> f64 {
        self.registers[self.first + register as usize].re()
    }

    /// The section that subscripts mean; `None` when the array has no such part.
    fn located(&self, section: &CodeSection) -> Option<Located> {
        let at = self.array_at(section.array);
        let array = &self.arrays[at];
        if matches!(array.items, ArrayItems::Nothing) {
            return None;
        }
        let Some(subscripts) = &section.subscripts else {
            return Some(Located { at, section: None, shape: array.shape });
        };
        let extents: SmallVec<[usize; 2]> = match array.shape {
            ArrayShape::Row(n) => SmallVec::from_slice(&[n]),
            ArrayShape::Grid(m, n) => SmallVec::from_slice(&[m, n]),
        };
        if extents.len() != subscripts.len() {
            return None;
        }
        let parts = subscripts.iter().zip(&extents).map(|(sub, n)| self.selection(*sub, *n));
        let parts = parts.collect::<Option<SmallVec<[Selection; 2]>>>()?;
        let section = ArraySection::of_parts(&parts)?;
        Some(Located { at, section: Some(section), shape: section.shape()? })
    }

    fn selection(&self, sub: CodeSubscript, extent: usize) -> Option<Selection> {
        let position =
            |x: f64| (x.fract() == 0.0 && x >= 1.0 && x <= extent as f64).then(|| x as usize - 1);
        match sub {
            CodeSubscript::Whole => Some(Selection::whole(extent)),
            CodeSubscript::At(at) => position(self.number(at)).map(Selection::at),
            CodeSubscript::Range(of) => {
                let [from, to, step] = of.map(|at| at.map(|at| self.number(at)));
                let step = step.unwrap_or(1.0);
                let ends = if step < 0.0 { [extent as f64, 1.0] } else { [1.0, extent as f64] };
                let from = position(from.unwrap_or(ends[0]))?;
                let to = position(to.unwrap_or(ends[1]))?;
                Selection::range(from, to, step)
            }
        }
    }
}

impl<T: Real> ArrayRegister<T> {
    /// The rows of its elements: one of numbers, three of vectors.
    fn rows(&self) -> &[Vec<T>] {
        match &self.items {
            ArrayItems::Nothing | ArrayItems::OwnedText(_) | ArrayItems::SharedText(_) => &[],
            ArrayItems::Owned(items) => std::slice::from_ref(items),
            ArrayItems::Shared(array) => std::slice::from_ref(&array.items),
            ArrayItems::OwnedVectors(planes) => planes,
            ArrayItems::SharedVectors(array) => &array.planes,
        }
    }

    /// Its rows to write: nothing else holds them then.
    fn rows_mut(&mut self) -> &mut [Vec<T>] {
        self.own();
        match &mut self.items {
            ArrayItems::Owned(items) => std::slice::from_mut(items),
            ArrayItems::OwnedVectors(planes) => planes,
            _ => &mut [],
        }
    }

    /// Notes that a section was given a value.
    fn note_given(&mut self, section: Option<ArraySection>) {
        let mut known = std::mem::take(&mut self.known);
        let point = |k: usize| Vec3::from(self.vector(k).map(|x| x.re()));
        let vectors = self.rows().len() == 3;
        known.give_section(section, self.shape, vectors.then_some(&point));
        self.known = known;
    }
}

impl<T: Scalar> Interpreter<'_, '_, T> {
    /// Executes an element-wise statement; `None` when the interpreter must.
    pub(super) fn pass(
        &mut self,
        region: &CodeRegion<T>,
        machine: &mut RegisterMachine<T>,
        kernel: u16,
    ) -> Option<CodeOutcome<T>> {
        let code = &region.units[machine.unit];
        let kernel = &code.kernels[kernel as usize];
        let leaves: SmallVec<[Located; 4]> =
            kernel.leaves.iter().map(|leaf| machine.located(leaf)).collect::<Option<_>>()?;
        let (into, part) = match &kernel.target {
            KernelTarget::Section(section, part) => (machine.located(section)?, *part),
            KernelTarget::Declared { array, .. } => {
                let (at, shape) = (machine.array_at(*array), leaves.first()?.shape);
                let grid = matches!(shape, ArrayShape::Grid(..));
                match code.arrays[*array as usize].ty {
                    Type::Curve if grid => return None,
                    Type::Surface if !grid => return None,
                    _ => (Located { at, section: None, shape }, None),
                }
            }
        };
        if leaves.iter().any(|leaf| leaf.shape != into.shape) {
            return None;
        }
        let rows = self.computed_rows(kernel, machine, &leaves, &into)?;
        // All arrays of the statement have as many elements.
        let most = self.limits.steps;
        for span in &kernel.charges {
            self.usage.steps += of_array(into.shape.count()) as u64;
            if self.usage.cost() > most && self.in_module(region, machine, |this| this.step(*span))
            {
                return Some(CodeOutcome::Stop);
            }
        }
        let array = &mut machine.arrays[into.at];
        if let KernelTarget::Declared { origin, .. } = kernel.target {
            array.mark = declared_by(origin);
            array.shape = into.shape;
        }
        self.store_rows(array, &into, part, rows);
        machine.pc += 1;
        Some(CodeOutcome::Next)
    }

    /// The values of the roots; `None` for a fault. A single value for all elements is a row of one.
    fn computed_rows(
        &mut self,
        kernel: &ArrayKernel<T>,
        machine: &RegisterMachine<T>,
        leaves: &[Located],
        into: &Located,
    ) -> Option<Rows<T>> {
        let mut consts: SmallVec<[T; 16]> = SmallVec::from_slice(kernel.tape.constants());
        for (at, register) in &kernel.inputs {
            consts[*at as usize] = machine.registers[machine.first + *register as usize];
        }
        let of_plane = |(leaf, part): &(u16, u8)| {
            let leaf = &leaves[*leaf as usize];
            let array = &machine.arrays[leaf.at];
            let row = &array.rows()[*part as usize];
            match leaf.section {
                Some(section) => Cow::Owned(picked(row, array.shape, section)),
                None => Cow::Borrowed(row),
            }
        };
        let planes: SmallVec<[Cow<'_, Vec<T>>; 8]> = kernel.planes.iter().map(of_plane).collect();
        let planes: SmallVec<[&Vec<T>; 8]> = planes.iter().map(|row| &**row).collect();
        let count = if leaves.is_empty() { 1 } else { into.shape.count() };
        let spare = &mut self.arrays.spare;
        let mut rows: Rows<T> = kernel.roots.iter().map(|_| spare.take(count)).collect();
        let sound = kernel.tape.execute(&planes, &consts, &kernel.roots, count, &mut rows);
        (sound || self.arrays.ieee).then_some(rows)
    }

    fn store_rows(
        &mut self,
        array: &mut ArrayRegister<T>,
        into: &Located,
        part: Option<u8>,
        rows: Rows<T>,
    ) {
        let single = rows.iter().all(|row| row.len() == 1) && into.shape.count() != 1;
        if let (None, None, false) = (into.section, part, single) {
            let vectors = rows.len() == 3;
            let mut rows = rows.into_iter();
            let mut next = || rows.next().unwrap_or_default();
            let items = match vectors {
                true => ArrayItems::OwnedVectors([next(), next(), next()]),
                false => ArrayItems::Owned(next()),
            };
            match std::mem::replace(&mut array.items, items) {
                ArrayItems::Owned(row) => self.arrays.spare.keep(row),
                ArrayItems::OwnedVectors(planes) => {
                    planes.into_iter().for_each(|row| self.arrays.spare.keep(row));
                }
                _ => {}
            }
            array.known = Known::default();
            return;
        }
        let shape = array.shape;
        let section = into.section.unwrap_or(ArraySection::whole(shape));
        let planes = array.rows_mut();
        let planes = match part {
            Some(part) => &mut planes[part as usize..=part as usize],
            None => planes,
        };
        for (plane, row) in planes.iter_mut().zip(rows) {
            match single {
                true => put_all(plane, shape, section, row[0]),
                false => put(plane, shape, section, &row),
            }
            self.arrays.spare.keep(row);
        }
        array.note_given(into.section);
    }
}
