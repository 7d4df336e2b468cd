//! The sections that a model asks for: stations, waterlines, buttocks, cylinders, meridians.

use crate::Document;
use moldloft_num::trace::Key;
use moldloft_panel::{Contour, ContourCutter, body_section};
use moldloft_registry::Value;
use std::collections::HashMap;

/// The lines of one section of a contours object.
#[derive(Clone, Debug)]
pub struct Section {
    /// The contours object, such as `stations`.
    pub contours: String,
    /// The plane's coordinate axis: 0, 1, 2 for X, Y, Z; 3 for sections of other kinds.
    pub axis: usize,
    /// The plane's coordinate, the distance, the radius, or the angle in radians.
    pub value: f64,
    /// The lines on each surface or body that it cuts, with its name.
    pub lines: Vec<(String, Vec<Contour>)>,
}

impl Document {
    /// The sections by all shown contours of the surfaces that they name, or of all shown ones and all shown
    /// bodies; sections without lines left out.
    pub fn sections(&self) -> Vec<Section> {
        let graph = self.graph();
        let shown = || graph.objects().filter(|o| o.head.shown());
        let is_surface = |key: Key| match graph.get(key)?.value()? {
            Value::Surface(surface) => Some(surface),
            _ => None,
        };
        let body = |key: Key| match graph.get(key)?.value()? {
            Value::Body(body) => Some(body),
            _ => None,
        };
        let drawn = |k: &Key| is_surface(*k).is_some() || body(*k).is_some();
        let all: Vec<Key> = shown().map(|o| o.key).filter(drawn).collect();
        let mut tables: HashMap<Key, ContourCutter<'_>> = HashMap::new();
        let mut sections = Vec::new();
        for object in shown() {
            let Some(Value::Contours(contours)) = object.value() else { continue };
            let keys = contours.surfaces.as_ref().unwrap_or(&all);
            for &key in keys {
                if let (Some(surface), Some(object)) = (is_surface(key), graph.get(key)) {
                    tables.entry(key).or_insert_with(|| ContourCutter::new(surface, &object.head));
                }
            }
            for &value in &contours.values {
                let cut = |key: &Key| {
                    let lines = match tables.get(key) {
                        Some(table) => table.section(&contours.family, value),
                        None => body_section(body(*key)?, &contours.family, value),
                    };
                    (!lines.is_empty()).then_some((graph.get(*key)?.name.to_string(), lines))
                };
                let lines: Vec<_> = keys.iter().filter_map(cut).collect();
                if !lines.is_empty() {
                    sections.push(Section {
                        contours: object.name.to_string(),
                        axis: contours.axis,
                        value,
                        lines,
                    });
                }
            }
        }
        sections
    }
}
