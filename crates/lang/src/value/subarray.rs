//! Sections: elements of an array selected by subscripts; and places: parts of variables that
//! assignments and returned arguments write to.

use crate::source::module::Name;
use moldloft_diag::Diagnostic;
use moldloft_registry::ArrayShape;
use smallvec::SmallVec;

/// Part of a dimension selected by a subscript: `count` positions from `start`, `step` apart,
/// counted from 0; and whether the dimension is kept (a range) or dropped (an index).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Selection {
    /// The first position.
    pub start: usize,
    /// Step between positions.
    pub step: isize,
    /// The number of positions.
    pub count: usize,
    /// True for a range, which keeps its dimension; false for a single position.
    pub keeps: bool,
}

impl Selection {
    /// All positions of a dimension.
    pub fn whole(extent: usize) -> Self {
        Self { start: 0, step: 1, count: extent, keeps: true }
    }

    /// One position.
    pub fn at(position: usize) -> Self {
        Self { start: position, step: 1, count: 1, keeps: false }
    }

    /// The positions between two ends, both included and counted from 0; `None` if empty.
    pub fn range(from: usize, to: usize, step: f64) -> Option<Self> {
        let length = to as f64 - from as f64;
        if step.fract() != 0.0 || step == 0.0 || length * step < 0.0 {
            return None;
        }
        let count = (length / step).floor() as usize + 1;
        let step = if count == 1 { 1 } else { step as isize };
        Some(Self { start: from, step, count, keeps: true })
    }

    /// Position `k`.
    pub fn position(self, k: usize) -> usize {
        (self.start as isize + self.step * k as isize) as usize
    }

    /// The positions, in order.
    pub fn positions(self) -> impl ExactSizeIterator<Item = usize> {
        (0..self.count).map(move |k| self.position(k))
    }

    /// The range of positions when they are neighbours in increasing order.
    fn run(self) -> Option<std::ops::Range<usize>> {
        (self.step == 1 || self.count == 1).then(|| self.start..self.start + self.count)
    }

    /// The selection `inner` applied to the result of this one.
    pub fn of(self, inner: Selection) -> Selection {
        Selection {
            start: self.position(inner.start),
            step: self.step * inner.step,
            count: inner.count,
            keeps: inner.keeps,
        }
    }

    fn bounds(self) -> (usize, usize) {
        let (a, b) = (self.start, self.position(self.count.max(1) - 1));
        (a.min(b), a.max(b))
    }

    fn holds(self, position: usize) -> bool {
        let d = position as isize - self.start as isize;
        d % self.step == 0 && (0..self.count as isize).contains(&(d / self.step))
    }

    /// True when both select some position.
    fn meets(self, o: Selection) -> bool {
        let ((a, b), (c, d)) = (self.bounds(), o.bounds());
        if b < c || d < a {
            return false;
        }
        let (few, many) = if self.count <= o.count { (self, o) } else { (o, self) };
        few.positions().any(|k| many.holds(k))
    }
}

/// The selections of all subscripts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArraySection {
    /// Section of a row.
    Row(Selection),
    /// Section of a grid.
    Grid(Selection, Selection),
    /// Section of a block.
    Block(Selection, Selection, Selection),
}

impl ArraySection {
    /// The whole of an array.
    pub fn whole(shape: ArrayShape) -> Self {
        match shape {
            ArrayShape::Row(n) => ArraySection::Row(Selection::whole(n)),
            ArrayShape::Grid(m, n) => ArraySection::Grid(Selection::whole(m), Selection::whole(n)),
        }
    }

    /// The whole of a block.
    pub fn whole_block([ni, nj, nk]: [usize; 3]) -> Self {
        ArraySection::Block(Selection::whole(ni), Selection::whole(nj), Selection::whole(nk))
    }

    /// The selections of the dimensions.
    pub fn parts(self) -> SmallVec<[Selection; 3]> {
        match self {
            ArraySection::Row(a) => SmallVec::from_slice(&[a]),
            ArraySection::Grid(a, b) => SmallVec::from_slice(&[a, b]),
            ArraySection::Block(a, b, c) => SmallVec::from_slice(&[a, b, c]),
        }
    }

    /// The section of these selections, one to three.
    pub fn of_parts(parts: &[Selection]) -> Option<Self> {
        Some(match *parts {
            [a] => ArraySection::Row(a),
            [a, b] => ArraySection::Grid(a, b),
            [a, b, c] => ArraySection::Block(a, b, c),
            _ => return None,
        })
    }

    /// The extents of the selection; empty for a single element.
    pub fn extents(self) -> ([usize; 3], usize) {
        let mut extents = ([0; 3], 0);
        for part in self.parts().into_iter().filter(|s| s.keeps) {
            extents.0[extents.1] = part.count;
            extents.1 += 1;
        }
        extents
    }

    /// The shape of the selection; `None` for a single element, and for a block.
    pub fn shape(self) -> Option<ArrayShape> {
        match self.extents() {
            ([n, ..], 1) => Some(ArrayShape::Row(n)),
            ([m, n, _], 2) => Some(ArrayShape::Grid(m, n)),
            _ => None,
        }
    }

    /// The selection `inner` applied to the result of this one; `None` if the number of dimensions
    /// differs.
    pub fn of(self, inner: ArraySection) -> Option<ArraySection> {
        let (mut parts, inner) = (self.parts(), inner.parts());
        if parts.iter().filter(|part| part.keeps).count() != inner.len() {
            return None;
        }
        for (part, inner) in parts.iter_mut().filter(|part| part.keeps).zip(inner) {
            *part = part.of(inner);
        }
        Self::of_parts(&parts)
    }

    /// True when the selections have a common element.
    pub fn meets(self, o: ArraySection) -> bool {
        let (a, b) = (self.parts(), o.parts());
        a.len() != b.len() || a.into_iter().zip(b).all(|(a, b)| a.meets(b))
    }

    /// Calls `f` with the position in memory of each selected element, in order, as runs of
    /// neighbours: (first position, count, step).
    pub fn runs(self, shape: ArrayShape, mut f: impl FnMut(usize, usize, isize)) {
        match (self, shape) {
            (ArraySection::Row(a), _) => f(a.start, a.count, a.step),
            (ArraySection::Grid(a, b), ArrayShape::Grid(_, n)) => {
                if b.count == 1 {
                    f(a.start * n + b.start, a.count, a.step * n as isize);
                } else if b.run() == Some(0..n) && a.run().is_some() {
                    f(a.start * n, a.count * n, 1);
                } else {
                    a.positions().for_each(|i| f(i * n + b.start, b.count, b.step));
                }
            }
            // A block has no one array in memory.
            (ArraySection::Grid(..), ArrayShape::Row(_)) | (ArraySection::Block(..), _) => {}
        }
    }
}

/// The selected elements of `items`, in order.
pub fn picked<E: Copy>(items: &[E], shape: ArrayShape, section: ArraySection) -> Vec<E> {
    let mut out = Vec::with_capacity(section.shape().map_or(1, ArrayShape::count));
    section.runs(shape, |start, count, step| {
        if step == 1 {
            out.extend_from_slice(&items[start..start + count]);
        } else {
            let at = |k: usize| (start as isize + step * k as isize) as usize;
            out.extend((0..count).map(|k| items[at(k)]));
        }
    });
    out
}

/// Writes `from`, in order, to the selected elements of `items`.
pub fn put<E: Copy>(items: &mut [E], shape: ArrayShape, section: ArraySection, from: &[E]) {
    let mut done = 0;
    section.runs(shape, |start, count, step| {
        let part = &from[done..done + count];
        done += count;
        if step == 1 {
            items[start..start + count].copy_from_slice(part);
        } else {
            let at = |k: usize| (start as isize + step * k as isize) as usize;
            part.iter().enumerate().for_each(|(k, &x)| items[at(k)] = x);
        }
    });
}

/// Writes one value to all selected elements of `items`.
pub fn put_all<E: Copy>(items: &mut [E], shape: ArrayShape, section: ArraySection, x: E) {
    section.runs(shape, |start, count, step| {
        let at = |k: usize| (start as isize + step * k as isize) as usize;
        (0..count).for_each(|k| items[at(k)] = x);
    });
}

/// Step from a value to one inside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathStep {
    /// The item of a list, from 0.
    Item(u32),
    /// The member of a record, from 0.
    Member(u32),
}

/// Lists and records that are assigned to nest at most this deep.
const MAX_STEPS: usize = 8;

/// The steps through lists and records from a variable to a value inside of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValuePath {
    steps: [PathStep; MAX_STEPS],
    count: u8,
}

impl Default for ValuePath {
    fn default() -> Self {
        Self { steps: [PathStep::Item(0); MAX_STEPS], count: 0 }
    }
}

impl ValuePath {
    /// The steps, outermost first.
    pub fn steps(&self) -> &[PathStep] {
        &self.steps[..usize::from(self.count)]
    }

    /// True when the path leads to the variable itself.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The path with one more step.
    ///
    /// # Errors
    /// When it is too long.
    pub fn then(mut self, step: PathStep) -> Result<Self, Diagnostic> {
        let Some(free) = self.steps.get_mut(usize::from(self.count)) else {
            return Err(Diagnostic::error("nested-too-deep", "lists and records nest too deep")
                .expected(format!("at most {MAX_STEPS} subscripts of lists and members")));
        };
        *free = step;
        self.count += 1;
        Ok(self)
    }
}

/// A part of a variable that is assigned to, or passed by reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The frame of the variable; `None` for a global one.
    pub frame: Option<u32>,
    pub name: Name,
    /// The value inside of it, when it is a list or a record.
    pub path: ValuePath,
    /// The subscripts, when there are some.
    pub section: Option<ArraySection>,
    /// The component x, y, z as 0, 1, 2.
    pub component: Option<usize>,
}

impl Place {
    /// A whole variable.
    pub fn whole(frame: Option<u32>, name: Name) -> Self {
        Self { frame, name, path: ValuePath::default(), section: None, component: None }
    }

    /// True of a whole variable.
    pub fn is_whole(&self) -> bool {
        self.path.is_empty() && self.section.is_none() && self.component.is_none()
    }

    /// A value inside of this place.
    ///
    /// # Errors
    /// When it is too deep.
    pub fn at(self, step: PathStep) -> Result<Self, Diagnostic> {
        Ok(Self { path: self.path.then(step)?, ..self })
    }

    /// A section of this place.
    ///
    /// # Errors
    /// When this place has no such dimensions.
    pub fn indexed(self, inner: ArraySection) -> Result<Self, Diagnostic> {
        let section = match self.section {
            None => Some(inner),
            Some(outer) => outer.of(inner),
        };
        match section {
            Some(_) => Ok(Self { section, ..self }),
            None => Err(Diagnostic::error("wrong-subscripts", "wrong number of subscripts")),
        }
    }

    /// True when writing to one may change the other.
    pub fn meets(&self, o: &Place) -> bool {
        let same = (self.frame, self.name) == (o.frame, o.name);
        let mut steps = self.path.steps().iter().zip(o.path.steps());
        if steps.any(|(a, b)| a != b) {
            return false;
        }
        if self.path != o.path {
            return same;
        }
        let components = match (self.component, o.component) {
            (Some(a), Some(b)) => a == b,
            _ => true,
        };
        let sections = match (self.section, o.section) {
            (Some(a), Some(b)) => a.meets(b),
            _ => true,
        };
        same && components && sections
    }
}
