//! The plane sections that a model asks for: stations, waterlines, buttocks.

use crate::Document;
use moldloft_model::{Polyline, Sectioned};
use moldloft_registry::Value;

/// The lines of one plane of a contours object.
#[derive(Clone, Debug)]
pub struct Section {
    /// The contours object, such as `stations`.
    pub contours: String,
    /// The plane's coordinate axis: 0, 1, 2 for X, Y, Z.
    pub axis: usize,
    /// The plane's coordinate.
    pub value: f64,
    /// The lines on each shown surface that it cuts, with the surface's name.
    pub lines: Vec<(String, Vec<Polyline>)>,
}

impl Document {
    /// The sections of all shown surfaces by all shown contours, planes without lines left out.
    pub fn sections(&self) -> Vec<Section> {
        let shown = || self.graph().objects().filter(|o| o.head.shown());
        let surfaces: Vec<_> = shown()
            .filter_map(|o| match o.value() {
                Some(Value::Surface(surface)) => {
                    Some((o.name.to_string(), Sectioned::new(surface, &o.head)))
                }
                _ => None,
            })
            .collect();
        let mut sections = Vec::new();
        for object in shown() {
            let Some(Value::Contours(contours)) = object.value() else { continue };
            for &value in &contours.values {
                let cut = |(name, surface): &(String, Sectioned<'_>)| {
                    let lines = surface.section(contours.axis, value);
                    (!lines.is_empty()).then(|| (name.clone(), lines))
                };
                let lines: Vec<_> = surfaces.iter().filter_map(cut).collect();
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
