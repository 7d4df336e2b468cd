//! Elements that masks and index arrays choose: read, and written.
//!
//! A mask has the shape of its array and contains only 0 and 1; any other array is an index:
//! positions from 1.

use crate::value::subarray::Selection;
use crate::value::variables::{self, Called as _};
use moldloft_diag::Diagnostic;
use moldloft_num::Real;
use moldloft_registry::{Array, ArrayShape, Value, Vectors};
use moldloft_syntax::sdl::Type;
use std::sync::Arc;

/// Elements selected by one subscript.
pub(crate) enum Selected {
    Regular(Selection),
    Chosen(Vec<usize>),
}

impl Selected {
    fn positions(&self) -> Vec<usize> {
        match self {
            Self::Regular(selection) => selection.positions().collect(),
            Self::Chosen(positions) => positions.clone(),
        }
    }

    fn keeps(&self) -> bool {
        match self {
            Self::Regular(selection) => selection.keeps,
            Self::Chosen(_) => true,
        }
    }
}

/// Elements of an array, by their positions in memory, and the shape that they form.
#[derive(Clone, Debug)]
pub(crate) struct Chosen {
    pub positions: Vec<usize>,
    shape: ArrayShape,
}

/// The numbers of an index or a mask; `None` for other values.
pub(crate) fn index_array<T: Real>(value: &Value<T>) -> Option<Array<T>> {
    match &*moldloft_arrays::gathered(value) {
        Value::Numbers(a) => Some((**a).clone()),
        Value::Vector(v) => Some(Array::row(v.to_array().to_vec())),
        _ => None,
    }
}

/// The positions, from 0, that an index or a mask of one dimension chooses.
pub(crate) fn along<T: Real>(index: &Array<T>, extent: usize) -> Result<Vec<usize>, Diagnostic> {
    if is_mask(index, ArrayShape::Row(extent)) {
        return Ok(held(index));
    }
    let mut positions = Vec::with_capacity(index.items.len());
    for x in &index.items {
        let x = x.re();
        if !(x.fract() == 0.0 && x >= 1.0 && x <= extent as f64) {
            return Err(Diagnostic::error("outside", format!("index {x} is outside the array"))
                .expected(format!(
                    "a mask [{extent}] of 0 and 1, or whole numbers from 1 to {extent}"
                ))
                .found(format!("an array {} with {x}", index.shape)));
        }
        positions.push(x as usize - 1);
    }
    Ok(positions)
}

fn is_mask<T: Real>(index: &Array<T>, shape: ArrayShape) -> bool {
    index.shape == shape && index.items.iter().all(|x| [0.0, 1.0].contains(&x.re()))
}

fn held<T: Real>(mask: &Array<T>) -> Vec<usize> {
    let held = mask.items.iter().enumerate().filter(|(_, x)| x.re() != 0.0);
    held.map(|(k, _)| k).collect()
}

impl Chosen {
    /// Elements selected by a single subscript: by a mask of the whole shape a row of elements; by
    /// an index elements of a row, or lines i of a grid.
    pub fn by<T: Real>(index: &Array<T>, shape: ArrayShape) -> Result<Self, Diagnostic> {
        if is_mask(index, shape) {
            let positions = held(index);
            return Ok(Self { shape: ArrayShape::Row(positions.len()), positions });
        }
        match shape {
            ArrayShape::Row(n) => {
                let positions = along(index, n)?;
                Ok(Self { shape: ArrayShape::Row(positions.len()), positions })
            }
            ArrayShape::Grid(m, n) => {
                let lines = along(index, m)?;
                let shape = ArrayShape::Grid(lines.len(), n);
                let positions = lines.iter().flat_map(|i| (0..n).map(move |j| i * n + j)).collect();
                Ok(Self { positions, shape })
            }
        }
    }

    /// The elements of a row at these positions.
    pub fn of_row(positions: Vec<usize>) -> Self {
        Self { shape: ArrayShape::Row(positions.len()), positions }
    }

    /// Elements selected by two subscripts from a grid with lines of `n`.
    pub fn of_grid(i: &Selected, j: &Selected, n: usize) -> Self {
        let (lines, columns) = (i.positions(), j.positions());
        let shape = match (i.keeps(), j.keeps()) {
            (true, true) => ArrayShape::Grid(lines.len(), columns.len()),
            (true, false) => ArrayShape::Row(lines.len()),
            _ => ArrayShape::Row(columns.len()),
        };
        let positions = lines.iter().flat_map(|i| columns.iter().map(move |j| i * n + j));
        Self { positions: positions.collect(), shape }
    }

    /// The chosen elements.
    pub fn of<T: Real>(&self, value: &Value<T>) -> Result<Value<T>, Diagnostic> {
        let shape = self.shape;
        Ok(match value {
            Value::Numbers(a) => {
                let items = self.positions.iter().map(|k| a.items[*k]).collect();
                Value::Numbers(Arc::new(Array { shape, items }))
            }
            Value::Vectors(a) => {
                let planes =
                    [0, 1, 2].map(|c| self.positions.iter().map(|k| a.planes[c][*k]).collect());
                Value::Vectors(Arc::new(Vectors { shape, planes }))
            }
            Value::List(items) => Value::list(self.positions.iter().map(|k| items[*k].clone())),
            other => return Err(not_chosen_from(other)),
        })
    }

    /// Puts a value into the chosen elements, or a component of them: one for all, or one for each.
    pub fn put<T: Real>(
        &self,
        into: &mut Value<T>,
        component: Option<usize>,
        value: Value<T>,
    ) -> Result<(), Diagnostic> {
        let numbers = component.is_some() || matches!(into, Value::Numbers(_));
        let value = match value {
            Value::List(_) | Value::Vector(_) if numbers => {
                variables::converted(Type::Farray, value)?
            }
            Value::List(_) => moldloft_arrays::gathered(&value).into_owned(),
            Value::Point(p) => Value::Vector(p.xyz),
            other => other,
        };
        let differs = |from: ArrayShape| {
            let to = self.shape;
            Diagnostic::error("shapes-differ", format!("shapes differ: {to} = {from}"))
                .expected(format!("a value of shape {to}, or a single one"))
                .found(from.to_string())
        };
        let wrong = |expected: &str, value: &Value<T>| {
            let found = value.called();
            Diagnostic::error("wrong-type", format!("expected {expected}, found {found}"))
                .expected(expected.to_string())
                .found(found)
        };
        match (&mut *into, component) {
            (Value::Numbers(array), None) => {
                let items = &mut Arc::make_mut(array).items;
                self.put_numbers(items, &value, differs, wrong)
            }
            (Value::Vectors(array), Some(c)) => {
                let plane = &mut Arc::make_mut(array).planes[c];
                self.put_numbers(plane, &value, differs, wrong)
            }
            (Value::Vectors(array), None) => {
                let planes = &mut Arc::make_mut(array).planes;
                match &value {
                    Value::Vector(v) => {
                        for (plane, x) in planes.iter_mut().zip(v.to_array()) {
                            self.positions.iter().for_each(|k| plane[*k] = x);
                        }
                    }
                    Value::Vectors(from) if from.shape == self.shape => {
                        for (plane, from) in planes.iter_mut().zip(&from.planes) {
                            self.positions.iter().zip(from).for_each(|(k, x)| plane[*k] = *x);
                        }
                    }
                    Value::Vectors(from) => return Err(differs(from.shape)),
                    other => return Err(wrong("a vector, a curve or a surface", other)),
                }
                Ok(())
            }
            (other, _) => Err(not_chosen_from(other)),
        }
    }

    fn put_numbers<T: Real>(
        &self,
        items: &mut [T],
        value: &Value<T>,
        differs: impl Fn(ArrayShape) -> Diagnostic,
        wrong: impl Fn(&str, &Value<T>) -> Diagnostic,
    ) -> Result<(), Diagnostic> {
        match value {
            Value::Number(x) => self.positions.iter().for_each(|k| items[*k] = *x),
            Value::Numbers(from) if from.shape == self.shape => {
                self.positions.iter().zip(&from.items).for_each(|(k, x)| items[*k] = *x);
            }
            Value::Numbers(from) => return Err(differs(from.shape)),
            other => return Err(wrong("a number or an farray", other)),
        }
        Ok(())
    }
}

fn not_chosen_from<T: Real>(value: &Value<T>) -> Diagnostic {
    Diagnostic::error("wrong-subscripts", "masks and index arrays choose from arrays")
        .expected("an farray, a curve or a surface")
        .found(value.called())
}
