//! One named object: a drawing, its dimensions, faces and curves.

use crate::feature::Feature;
use crate::solid::curve::SketchCurve;
use crate::{
    CoordinateAxis, Dimension, Drawing, FaceId, LineId, MeasuredQuantity, PointId, Variable,
};
use indexmap::IndexMap;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A plane face: cycles of points, counter-clockwise seen from outside, holes clockwise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SketchFace {
    /// The outer cycle.
    pub outer: Vec<PointId>,
    /// The cycles of its holes.
    pub holes: Vec<Vec<PointId>>,
}

impl SketchFace {
    /// The outer cycle, then the holes.
    pub fn loops(&self) -> impl Iterator<Item = &[PointId]> {
        std::iter::once(self.outer.as_slice()).chain(self.holes.iter().map(Vec::as_slice))
    }

    /// The face seen from the other side.
    #[must_use]
    pub fn reversed(&self) -> SketchFace {
        let turn = |cycle: &Vec<PointId>| {
            let mut turned = cycle.clone();
            turned.reverse();
            turned
        };
        SketchFace { outer: turn(&self.outer), holes: self.holes.iter().map(turn).collect() }
    }
}

/// The point whose coordinates are given outright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// The point.
    pub point: PointId,
    /// Coordinates.
    pub at: [f64; 3],
}

/// An object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SketchObject {
    /// Its name, as written.
    pub name: String,
    /// True if it is shown.
    pub display: bool,
    /// True if it is a result although other objects use it.
    pub keep: bool,
    /// The unit of its lengths, as a tag (`FT`, `M`, …).
    pub units: Option<String>,
    /// The picture; shared, so that derived data are computed once.
    pub drawing: Arc<Drawing>,
    /// The reference point; the first point at the origin when `None`.
    pub reference: Option<Reference>,
    /// Dimensions by folded name, in order of entry.
    pub dimensions: IndexMap<String, Dimension>,
    /// Variables by folded name, in order of entry.
    pub variables: IndexMap<String, Variable>,
    /// The accepted faces.
    pub faces: BTreeMap<FaceId, SketchFace>,
    /// Curves by folded name, in order of entry.
    pub curves: IndexMap<String, SketchCurve>,
    /// Its definition, unless it is a drawing.
    pub feature: Option<Arc<Feature>>,
}

/// For each of several objects, true if it is a result: not used by another one, or kept.
pub fn results(objects: &[&SketchObject]) -> Vec<bool> {
    let operands = |object: &SketchObject| -> Vec<String> {
        let all = object.feature.iter().flat_map(|f| &f.operands);
        all.map(|o| o.object.name.to_lowercase()).collect()
    };
    let used: Vec<(String, Vec<String>)> =
        objects.iter().map(|o| (o.name.to_lowercase(), operands(o))).collect();
    let consumed =
        |name: &String| used.iter().any(|(other, of)| other != name && of.contains(name));
    objects.iter().zip(&used).map(|(object, (name, _))| object.keep || !consumed(name)).collect()
}

impl SketchObject {
    /// An empty object of a name; a cross section perpendicular to `section` if given.
    pub fn new(name: &str, section: Option<CoordinateAxis>) -> SketchObject {
        let drawing = Drawing {
            section,
            projection: section.map(crate::Projection::section).unwrap_or_default(),
            ..Drawing::default()
        };
        SketchObject {
            name: name.to_owned(),
            display: true,
            drawing: Arc::new(drawing),
            ..SketchObject::default()
        }
    }

    /// The drawing, to change it.
    pub fn draw(&mut self) -> &mut Drawing {
        Arc::make_mut(&mut self.drawing)
    }

    /// The reference point and where it is.
    pub fn reference(&self) -> Option<Reference> {
        let first = self.drawing.points.keys().next();
        self.reference
            .filter(|r| self.drawing.points.contains_key(&r.point))
            .or_else(|| first.map(|&point| Reference { point, at: [0.0; 3] }))
    }

    /// The first unused `prefix` + number among dimensions, variables and curves.
    pub fn fresh_name(&self, prefix: &str) -> String {
        let taken = |name: &str| self.has_name(name);
        let start = self.dimensions.len() + self.curves.len();
        (1..=start + self.variables.len() + 1)
            .map(|k| format!("{prefix}{k}"))
            .find(|name| !taken(name))
            .unwrap_or_else(|| format!("{prefix}{start}_"))
    }

    /// True if a dimension, variable or curve has this name.
    pub fn has_name(&self, name: &str) -> bool {
        let key = name.to_ascii_lowercase();
        self.dimensions.contains_key(&key)
            || self.variables.contains_key(&key)
            || self.curves.contains_key(&key)
    }

    /// Adds a dimension.
    pub fn add_dimension(&mut self, dimension: Dimension) {
        self.dimensions.insert(dimension.name.to_ascii_lowercase(), dimension);
    }

    /// The label after the highest one.
    pub fn next_face(&self) -> FaceId {
        FaceId(self.faces.keys().last().map_or(1, |f| f.0.saturating_add(1)))
    }

    /// Removes faces, curves and dimensions of deleted points or lines. Returns the names of the
    /// removed dimensions and curves.
    pub fn drop_dangling(&mut self) -> Vec<String> {
        let drawing = Arc::clone(&self.drawing);
        let point = |p: &PointId| drawing.points.contains_key(p);
        let line = |l: &LineId| drawing.lines.contains_key(l);
        let mut gone = Vec::new();
        self.dimensions.retain(|_, d| {
            let stays = match &d.measure {
                MeasuredQuantity::Along { p, q, .. } => point(p) && point(q),
                MeasuredQuantity::Datum { point: p, .. } => point(p),
                MeasuredQuantity::Length(l) | MeasuredQuantity::Slope(l) => line(l),
                MeasuredQuantity::Angle(a, b) | MeasuredQuantity::Equal(a, b) => line(a) && line(b),
            };
            if !stays {
                gone.push(d.name.clone());
            }
            stays
        });
        self.curves.retain(|_, c| {
            let stays = c.points.iter().all(point);
            if !stays {
                gone.push(c.name.clone());
            }
            stays
        });
        self.faces.retain(|_, f| f.loops().all(|cycle| cycle.iter().all(point)));
        if self.reference.is_some_and(|r| !point(&r.point)) {
            self.reference = None;
        }
        gone
    }
}
