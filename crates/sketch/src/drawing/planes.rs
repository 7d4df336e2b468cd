//! Dimensioning planes: which points share a coordinate, and why.
//!
//! A line of type X has equal y and equal z at its ends, so its ends are in a common Y plane and a
//! common Z plane, and so on. The planes of an axis are the classes of this relation; N planes need
//! N - 1 dimensions and one reference value (manual, pp. 5-8; routines DETPNS, SETPLS, PLNTES).

use crate::{Align, CoordinateAxis, Drawing, Free, LineId, PointId};
use moldloft_num::union_find::UnionFind;
use std::collections::VecDeque;

/// Reason why two points share a coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The type of a line.
    Line(LineId),
    /// An alignment.
    Align(Align),
    /// Both are in the section plane.
    Section,
}

impl Reason {
    /// For people.
    pub fn text(self, drawing: &Drawing) -> String {
        match self {
            Reason::Line(id) => drawing.line_text(id),
            Reason::Align(a) => format!("ALIGN {} {} {}", a.axis, a.p, a.q),
            Reason::Section => "the section plane".to_owned(),
        }
    }
}

/// A fault in the types of lines.
#[derive(Clone, Debug, PartialEq)]
pub enum TypeFault {
    /// Error 400: a line cannot have its type, because the constraints of the path make its ends
    /// coincide along the axis.
    Contradiction {
        /// The line that would have zero length.
        line: LineId,
        /// The axis along which its ends should differ.
        axis: CoordinateAxis,
        /// The constraints that connect its ends along this axis.
        path: Vec<Reason>,
    },
    /// By its planes, a line varies along fewer axes than its type.
    Degraded {
        /// The line.
        line: LineId,
        /// Type as named.
        named: Free,
        /// Actual type.
        really: Free,
        /// Constraints that connect its ends along the first missing axis.
        path: Vec<Reason>,
    },
    /// Two points have the same three planes: they coincide.
    Coincident {
        /// The first.
        p: PointId,
        /// The second.
        q: PointId,
    },
    /// Error 401: a point without a line.
    Loose {
        /// The point.
        point: PointId,
    },
    /// Error 402: a line without a type.
    Untyped {
        /// The line.
        line: LineId,
    },
}

/// The planes of the three axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Planes {
    ids: Vec<PointId>,
    class: [Vec<u32>; 3],
    count: [usize; 3],
}

impl Planes {
    /// The planes of a drawing. Planes are numbered in the order of their first points.
    pub fn of(drawing: &Drawing) -> Planes {
        let ids: Vec<PointId> = drawing.points.keys().copied().collect();
        let index = |p: PointId| ids.binary_search(&p).ok();
        let mut class = [const { Vec::new() }; 3];
        let mut count = [0; 3];
        for axis in CoordinateAxis::ALL {
            let mut sets = UnionFind::new(ids.len());
            let mut join = |a: usize, b: usize| sets.join(a, b);
            for line in drawing.lines.values() {
                if let (Some(free), Some(p), Some(q)) = (line.free, index(line.p), index(line.q))
                    && !free.contains(axis)
                {
                    join(p, q);
                }
            }
            for align in drawing.aligns.iter().filter(|a| a.axis == axis) {
                if let (Some(p), Some(q)) = (index(align.p), index(align.q)) {
                    join(p, q);
                }
            }
            if drawing.section == Some(axis) {
                (1..ids.len()).for_each(|k| join(0, k));
            }
            let k = axis.index();
            let mut number = vec![u32::MAX; ids.len()];
            for point in 0..ids.len() {
                let top = sets.find(point);
                if number[top] == u32::MAX {
                    number[top] = count[k] as u32;
                    count[k] += 1;
                }
                class[k].push(number[top]);
            }
        }
        Planes { ids, class, count }
    }

    /// Numbers of planes on X, Y and Z.
    pub fn counts(&self) -> [usize; 3] {
        self.count
    }

    /// Number of dimensions needed on an axis: the number of planes less one.
    pub fn required(&self, axis: CoordinateAxis) -> usize {
        self.count[axis.index()].saturating_sub(1)
    }

    /// The plane of a point on an axis.
    pub fn plane(&self, axis: CoordinateAxis, point: PointId) -> Option<usize> {
        let k = self.ids.binary_search(&point).ok()?;
        Some(self.class[axis.index()][k] as usize)
    }

    /// The points, in the order of [`Self::classes`].
    pub fn ids(&self) -> &[PointId] {
        &self.ids
    }

    /// The plane of each point on an axis.
    pub fn classes(&self, axis: CoordinateAxis) -> &[u32] {
        &self.class[axis.index()]
    }

    /// The points of a plane.
    pub fn members(&self, axis: CoordinateAxis, plane: usize) -> Vec<PointId> {
        let classes = self.class[axis.index()].iter();
        classes.zip(&self.ids).filter(|(c, _)| **c as usize == plane).map(|(_, p)| *p).collect()
    }

    /// True if two points share a plane.
    pub fn same(&self, axis: CoordinateAxis, p: PointId, q: PointId) -> bool {
        self.plane(axis, p).is_some() && self.plane(axis, p) == self.plane(axis, q)
    }

    /// All faults of the types, contradictions first.
    pub fn faults(&self, drawing: &Drawing) -> Vec<TypeFault> {
        let mut faults = Vec::new();
        let mut later = Vec::new();
        for (&id, line) in &drawing.lines {
            let Some(named) = line.free else {
                faults.push(TypeFault::Untyped { line: id });
                continue;
            };
            let tied = |a: &CoordinateAxis| self.same(*a, line.p, line.q);
            match Free::those(|a| !tied(&a)) {
                None => {
                    let axis = named.axes().next().unwrap_or(CoordinateAxis::X);
                    let path = why(drawing, axis, line.p, line.q).unwrap_or_default();
                    faults.push(TypeFault::Contradiction { line: id, axis, path });
                }
                Some(really) if really != named => {
                    let axis = named.axes().find(tied).unwrap_or(CoordinateAxis::X);
                    let path = why(drawing, axis, line.p, line.q).unwrap_or_default();
                    later.push(TypeFault::Degraded { line: id, named, really, path });
                }
                Some(_) => {}
            }
        }
        let used: std::collections::BTreeSet<PointId> =
            drawing.lines.values().flat_map(|l| [l.p, l.q]).collect();
        let loose = self.ids.iter().filter(|p| !used.contains(p));
        faults.extend(loose.map(|&point| TypeFault::Loose { point }));
        let mut triads: Vec<([u32; 3], PointId)> = (0..self.ids.len())
            .map(|k| ([0, 1, 2].map(|a: usize| self.class[a][k]), self.ids[k]))
            .collect();
        triads.sort_unstable();
        for pair in triads.windows(2) {
            if pair[0].0 == pair[1].0 {
                faults.push(TypeFault::Coincident { p: pair[0].1, q: pair[1].1 });
            }
        }
        faults.append(&mut later);
        faults
    }
}

/// The shortest chain of reasons for which two points share a coordinate; `None` when they do not.
pub fn why(drawing: &Drawing, axis: CoordinateAxis, p: PointId, q: PointId) -> Option<Vec<Reason>> {
    if p == q || (drawing.section == Some(axis) && drawing.points.contains_key(&p)) {
        let alone = if p == q { vec![] } else { vec![Reason::Section] };
        return drawing.points.contains_key(&q).then_some(alone);
    }
    let mut next: std::collections::BTreeMap<PointId, Vec<(PointId, Reason)>> = Default::default();
    let mut tie = |a: PointId, b: PointId, reason| {
        next.entry(a).or_default().push((b, reason));
        next.entry(b).or_default().push((a, reason));
    };
    for (&id, line) in &drawing.lines {
        if line.free.is_some_and(|f| !f.contains(axis)) {
            tie(line.p, line.q, Reason::Line(id));
        }
    }
    for &align in drawing.aligns.iter().filter(|a| a.axis == axis) {
        tie(align.p, align.q, Reason::Align(align));
    }
    let mut from = std::collections::BTreeMap::new();
    let mut queue = VecDeque::from([p]);
    from.insert(p, None);
    while let Some(at) = queue.pop_front() {
        if at == q {
            break;
        }
        for &(to, reason) in next.get(&at).into_iter().flatten() {
            from.entry(to).or_insert_with(|| {
                queue.push_back(to);
                Some((at, reason))
            });
        }
    }
    let mut path = Vec::new();
    let mut at = q;
    while let Some((before, reason)) = *from.get(&at)? {
        path.push(reason);
        at = before;
    }
    path.reverse();
    Some(path)
}
