//! The sections declared in a model: stations, waterlines, buttocks, cylinders, meridians.

use crate::Document;
use moldloft_lang::value::contours::listed_shapes;
use moldloft_model::Object;
use moldloft_num::trace::Key;
use moldloft_panel::{Contour, ContourCutter, body_section};
use moldloft_registry::Value;
use std::collections::HashMap;

/// The lines of one section of a contours object.
#[derive(Clone, Debug)]
pub struct ContourSection {
    /// The contours object, such as `stations`.
    pub contours: String,
    /// The plane's coordinate axis: 0, 1, 2 for X, Y, Z; 3 for sections of other kinds.
    pub axis: usize,
    /// The plane's coordinate, the distance, the radius, or the angle in radians.
    pub value: f64,
    /// The name of each surface or body that it cuts, with the lines on it.
    pub lines: Vec<(String, Vec<Contour>)>,
}

/// Search grids of surfaces, made once for all sections of them.
type Cutters<'g> = HashMap<Key, ContourCutter<'g, f64>>;

impl Document {
    /// The sections of all shown contours objects, through the surfaces and bodies that these name
    /// or else all shown ones; sections without lines are omitted.
    pub fn sections(&self) -> Vec<ContourSection> {
        let mut cutters = Cutters::new();
        let shown = self.graph().objects().filter(|o| o.head.shown());
        let mut sections: Vec<ContourSection> =
            shown.flat_map(|object| self.cut(object, &mut cutters)).collect();
        sections.retain(|section| !section.lines.is_empty());
        sections
    }

    /// All sections of one contours object, in the order of its values; empty for another object.
    pub fn sections_of(&self, name: &str) -> Vec<ContourSection> {
        let object = self.graph().objects().find(|o| &*o.name == name);
        object.map_or_else(Vec::new, |object| self.cut(object, &mut Cutters::new()))
    }

    fn cut<'g>(&'g self, object: &Object<f64>, cutters: &mut Cutters<'g>) -> Vec<ContourSection> {
        let Some(Value::Contours(contours)) = object.value() else { return Vec::new() };
        let graph = self.graph();
        let keys = listed_shapes(graph, object)
            .unwrap_or_else(|| graph.objects().filter(|o| o.head.shown()).map(|o| o.key).collect());
        for &key in &keys {
            if let Some(object) = graph.get(key)
                && let Some(Value::Surface(surface)) = object.value()
            {
                cutters.entry(key).or_insert_with(|| ContourCutter::new(surface, &object.head));
            }
        }
        let section = |value: f64| {
            let lines = |key: &Key| {
                let object = graph.get(*key)?;
                let lines = match (cutters.get(key), object.value()?) {
                    (Some(cutter), _) => cutter.section(&contours.family, value),
                    (None, Value::Body(body)) => body_section(body, &contours.family, value),
                    _ => return None,
                };
                (!lines.is_empty()).then(|| (object.name.to_string(), lines))
            };
            ContourSection {
                contours: object.name.to_string(),
                axis: contours.axis,
                value,
                lines: keys.iter().filter_map(lines).collect(),
            }
        };
        contours.values.iter().map(|&value| section(value)).collect()
    }
}
