//! One named object: a drawing, its dimensions, faces and curves.

use crate::feature::{Feature, FeatureKind, FeatureOperand, SectionPlace};
use crate::identifier::identifier;
use crate::solid::curve::SketchCurve;
use crate::{
    CoordinateAxis, Dimension, DimensionExpr, DimensionRole, Drawing, FaceId, LineId,
    MeasuredQuantity, PointId, Variable,
};
use indexmap::IndexMap;
use std::collections::{BTreeMap, BTreeSet};
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

/// The point with given coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// The point.
    pub point: PointId,
    /// A point with numbers as coordinates.
    pub at: [DimensionExpr; 3],
}

impl Reference {
    /// A point at plain numbers.
    pub fn number(point: PointId, at: [f64; 3]) -> Reference {
        Reference { point, at: at.map(DimensionExpr::number) }
    }
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
    /// The reference point; `None` for the first point at the origin.
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
    /// The face on which it is drawn, of a section.
    pub on: Option<SectionPlace>,
}

/// For each of several objects, true if it is a result: no other object follows it, or it is kept.
pub fn results(objects: &[&SketchObject]) -> Vec<bool> {
    let used: BTreeSet<String> = objects.iter().flat_map(|o| o.followed()).collect();
    objects.iter().map(|o| o.keep || !used.contains(&o.name.to_lowercase())).collect()
}

impl SketchObject {
    /// An empty object of that name; a cross section perpendicular to `section` if given.
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

    /// The folded names of the objects that it follows.
    pub fn followed(&self) -> BTreeSet<String> {
        let operands = self.feature.iter().flat_map(|f| &f.operands);
        let names = operands.flat_map(|operand| match operand.followed() {
            Some(name) => BTreeSet::from([name.to_lowercase()]),
            None => operand.object.followed(),
        });
        names.collect()
    }

    /// Its variables and driving dimensions with a value: name, value and range.
    pub fn own_numbers(&self) -> impl Iterator<Item = (&String, &DimensionExpr, Option<[f64; 2]>)> {
        let variables = self.variables.values().map(|v| (&v.name, &v.value, v.range));
        let dimensions = (self.dimensions.values())
            .filter(|d| d.role == DimensionRole::Driving)
            .filter_map(|d| Some((&d.name, d.value.as_ref()?, d.range)));
        variables.chain(dimensions)
    }

    /// The numbers of the objects that it follows, as `object.number`: name, value and range.
    pub fn followed_numbers(&self) -> Vec<(String, DimensionExpr, Option<[f64; 2]>)> {
        let mut out: Vec<(String, DimensionExpr, Option<[f64; 2]>)> = Vec::new();
        for operand in self.feature.iter().flat_map(|f| &f.operands) {
            let inner = &operand.object;
            if operand.follows {
                let of = identifier(&inner.name);
                let own = inner.own_numbers().filter(|n| inner.alias(n.0).is_none());
                out.extend(
                    own.map(|(n, value, range)| (format!("{of}.{n}"), value.clone(), range)),
                );
            }
            for row in inner.followed_numbers() {
                if out.iter().all(|known| known.0 != row.0) {
                    out.push(row);
                }
            }
        }
        out
    }

    /// The number of another object that one of its variables merely repeats.
    pub fn alias(&self, name: &str) -> Option<&str> {
        let variable = self.variables.get(&name.to_ascii_lowercase())?;
        let (of, number) = variable.value.text().split_once('.')?;
        let stands = |operand: &FeatureOperand| match operand.follows {
            true => {
                operand.prefix.is_empty()
                    && number.eq_ignore_ascii_case(&variable.name)
                    && of.eq_ignore_ascii_case(&identifier(&operand.object.name))
            }
            false => {
                let inner = variable.name.get(operand.prefix.len()..);
                inner.and_then(|n| operand.object.alias(n)) == Some(variable.value.text())
            }
        };
        let mut operands = self.feature.iter().flat_map(|f| &f.operands);
        operands.any(stands).then_some(variable.value.text())
    }

    /// The folded name of a number, or `object.number` for the number of another object that it
    /// repeats.
    pub fn source(&self, name: &str) -> String {
        let mut key = name.to_ascii_lowercase();
        let mut at = self.alias(&key).map(str::to_owned).or_else(|| self.alias_of(&key));
        while let Some(path) = at {
            key = path.to_ascii_lowercase();
            at = self.alias_of(&key);
        }
        key
    }

    /// The number of another object that a number stands for.
    fn alias_of(&self, path: &str) -> Option<String> {
        let (of, number) = path.split_once('.')?;
        for operand in self.feature.iter().flat_map(|f| &f.operands) {
            let inner = &operand.object;
            let found = match operand.follows && of.eq_ignore_ascii_case(&identifier(&inner.name)) {
                true => inner.alias(number).map(str::to_owned),
                false => inner.alias_of(path),
            };
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// True for a body that is combined of others, also if it was placed then.
    pub fn is_combined(&self) -> bool {
        let Some(feature) = &self.feature else { return false };
        match feature.kind {
            FeatureKind::Boolean(_) | FeatureKind::Pattern { .. } | FeatureKind::Hole(_) => true,
            FeatureKind::Place(_) | FeatureKind::OnFace { .. } => {
                feature.operands.first().is_some_and(|o| o.object.is_combined())
            }
            _ => false,
        }
    }

    /// The drawing, mutable.
    pub fn draw(&mut self) -> &mut Drawing {
        Arc::make_mut(&mut self.drawing)
    }

    /// The reference point and its coordinates.
    pub fn reference(&self) -> Option<Reference> {
        let first = self.drawing.points.keys().next();
        (self.reference.clone())
            .filter(|r| self.drawing.points.contains_key(&r.point))
            .or_else(|| first.map(|&point| Reference::number(point, [0.0; 3])))
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
        self.has_number(name) || self.curves.contains_key(&name.to_ascii_lowercase())
    }

    /// True if a dimension or variable has this name.
    pub fn has_number(&self, name: &str) -> bool {
        let key = name.to_ascii_lowercase();
        self.dimensions.contains_key(&key) || self.variables.contains_key(&key)
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
        if self.reference.as_ref().is_some_and(|r| !point(&r.point)) {
            self.reference = None;
        }
        gone
    }
}
