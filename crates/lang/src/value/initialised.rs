//! Initialised elements of an array, and agreement of the edges of a grid at corners.
//!
//! A dimensioned array begins as zeros. Library routines that depend on values of their caller (the
//! ends before `line`, the edges before `transfinite`) check this record, so that zeros are not
//! taken for data.

use crate::value::subarray::{ArraySection, Selection};
use moldloft_num::{Real, Vec3};
use moldloft_registry::{ArrayShape, Value};

/// Initialised elements of a variable.
#[derive(Clone, Debug, Default)]
pub struct Known {
    /// The elements without a value; `None` when all have one.
    missing: Option<Box<Missing>>,
    /// Ends of each edge of a grid when last assigned: edges i = 1, i = d1, j = 1, j = d2.
    edges: Option<Box<[[Option<Vec3>; 2]; 4]>>,
}

#[derive(Clone, Debug)]
struct Missing {
    left: usize,
    given: Vec<bool>,
}

/// A corner of a grid where the two edges do not meet.
pub struct Gap {
    /// Numbers from 1.
    pub corner: [usize; 2],
    /// The two edges, and where they end.
    pub edges: [(String, Vec3); 2],
}

impl Known {
    /// Nothing of an array of `count` elements.
    pub fn nothing(count: usize) -> Self {
        let missing = Missing { left: count, given: vec![false; count] };
        Self { missing: Some(Box::new(missing)), edges: None }
    }

    /// True when all elements of the section have a value.
    pub fn has(&self, shape: ArrayShape, section: ArraySection) -> bool {
        self.first_missing(shape, section).is_none()
    }

    /// The first element of the section without a value, by its numbers from 1.
    pub fn first_missing(&self, shape: ArrayShape, section: ArraySection) -> Option<Vec<usize>> {
        let missing = self.missing.as_ref()?;
        let mut found = None;
        section.runs(shape, |start, count, step| {
            let at = |k: usize| (start as isize + step * k as isize) as usize;
            let gap = (0..count).map(at).find(|&k| !missing.given[k]);
            found = found.or(gap);
        });
        found.map(|k| match shape {
            ArrayShape::Row(_) => vec![k + 1],
            ArrayShape::Grid(_, n) => vec![k / n + 1, k % n + 1],
        })
    }

    /// Notes that the section (the whole when `None`) was given a value; `value` is the variable's
    /// new value.
    pub fn give<T: Real>(&mut self, section: Option<ArraySection>, value: &Value<T>) {
        match value {
            Value::Numbers(a) => self.give_section(section, a.shape, None),
            Value::Vectors(a) => self.give_section(section, a.shape, Some(&|k| a.at(k).re())),
            _ => {}
        }
    }

    /// Notes a section of an array of a shape, with the vector at a position in memory.
    pub fn give_section(
        &mut self,
        section: Option<ArraySection>,
        shape: ArrayShape,
        vector: Option<&dyn Fn(usize) -> Vec3>,
    ) {
        match section {
            None => self.missing = None,
            Some(section) => {
                if let Some(missing) = &mut self.missing {
                    let Missing { left, given } = &mut **missing;
                    section.runs(shape, |start, count, step| {
                        let at = |k: usize| (start as isize + step * k as isize) as usize;
                        for k in (0..count).map(at) {
                            *left -= usize::from(!std::mem::replace(&mut given[k], true));
                        }
                    });
                    if *left == 0 {
                        self.missing = None;
                    }
                }
            }
        }
        if let (Some(vector), ArrayShape::Grid(m, n)) = (vector, shape) {
            let point = |i: usize, j: usize| vector(i * n + j);
            match section {
                Some(ArraySection::Grid(a, b)) => self.give_edges([m, n], a, b, point),
                _ => self.edges = None,
            }
        }
    }

    /// Notes that the number at this position in memory was given a value.
    #[inline(always)]
    pub fn give_at(&mut self, k: usize) {
        if let Some(missing) = &mut self.missing {
            missing.left -= usize::from(!std::mem::replace(&mut missing.given[k], true));
            if missing.left == 0 {
                self.missing = None;
            }
        }
    }

    /// Notes that the vector at this position in memory of a grid was given a value.
    #[inline(always)]
    pub fn give_vector_at(&mut self, k: usize, [m, n]: [usize; 2], point: impl Fn() -> Vec3) {
        self.give_at(k);
        let (i, j) = (k / n, k % n);
        if (i == 0 || i + 1 == m) && (j == 0 || j + 1 == n) {
            let [a, b] = [i, j].map(Selection::at);
            self.give_edges([m, n], a, b, |_, _| point());
        }
    }

    /// Notes that the elements at these positions in memory were given a value.
    pub fn give_each<T: Real>(&mut self, positions: &[usize], value: &Value<T>) {
        let shape = match value {
            Value::Numbers(a) => a.shape,
            Value::Vectors(a) => a.shape,
            _ => return,
        };
        for &k in positions {
            let at = match shape {
                ArrayShape::Row(_) => ArraySection::Row(Selection::at(k)),
                ArrayShape::Grid(_, n) => {
                    ArraySection::Grid(Selection::at(k / n), Selection::at(k % n))
                }
            };
            self.give(Some(at), value);
        }
    }

    fn give_edges(
        &mut self,
        [m, n]: [usize; 2],
        a: Selection,
        b: Selection,
        point: impl Fn(usize, usize) -> Vec3,
    ) {
        let (whole_a, whole_b) = (a.count == m && m > 1, b.count == n && n > 1);
        let along = |edge: usize| match edge {
            0 | 1 => !a.keeps && whole_b,
            _ => !b.keeps && whole_a,
        };
        let covers =
            |i: usize, j: usize| a.positions().any(|k| k == i) && b.positions().any(|k| k == j);
        for edge in 0..4 {
            for end in 0..2 {
                let [i, j] = corner(edge, end, [m, n]);
                // The assignment of one edge does not determine the end of the other there.
                let other = match edge {
                    0 | 1 => 2 + end,
                    _ => end,
                };
                if (along(other) && !along(edge)) || !covers(i, j) {
                    continue;
                }
                let edges = self.edges.get_or_insert_default();
                edges[edge][end] = Some(point(i, j));
            }
        }
    }

    /// The widest gap between edges that were put to different corners.
    pub fn widest_gap(&self, [m, n]: [usize; 2]) -> Option<Gap> {
        let edges = self.edges.as_ref()?;
        let mut widest: Option<(f64, Gap)> = None;
        for edge in 0..2 {
            for end in 0..2 {
                let other = 2 + end;
                let [i, j] = corner(edge, end, [m, n]);
                // Edge i = 1 ends where edge j = 1 or j = d2 has its end number `edge`.
                let (Some(p), Some(q)) = (edges[edge][end], edges[other][edge]) else { continue };
                let gap = p.distance(q);
                if gap > 0.0 && widest.as_ref().is_none_or(|(w, _)| gap > *w) {
                    let name = |edge: usize| match edge {
                        0 => "i = 1".to_string(),
                        1 => format!("i = {m}"),
                        2 => "j = 1".to_string(),
                        _ => format!("j = {n}"),
                    };
                    let edges = [(name(edge), p), (name(other), q)];
                    widest = Some((gap, Gap { corner: [i + 1, j + 1], edges }));
                }
            }
        }
        widest.map(|(_, gap)| gap)
    }
}

/// The element at an end of an edge, from 0.
fn corner(edge: usize, end: usize, [m, n]: [usize; 2]) -> [usize; 2] {
    let last = |n: usize, end: usize| if end == 0 { 0 } else { n - 1 };
    match edge {
        0 => [0, last(n, end)],
        1 => [m - 1, last(n, end)],
        2 => [last(m, end), 0],
        _ => [last(m, end), n - 1],
    }
}
