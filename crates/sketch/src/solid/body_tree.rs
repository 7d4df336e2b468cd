//! Bodies as sets of the bodies that they are combined of: those have the faces that were drawn, not parts of them.

use super::SketchSolid;
use super::feature::{FacetPlan, body_at};
use super::operation::Operation;
use super::outline::FacetDensity;
use super::place::Similarity;
use crate::feature::{Feature, FeatureKind};
use crate::{DimensionLayout, Planes, SketchObject};
use moldloft_num::Real;

/// A body, or an operation on bodies.
#[derive(Clone, Debug)]
pub enum BodyTree<T> {
    /// A body with plane faces and faces between arcs and their copies, or others bounded by their
    /// own edges.
    Plain(Box<SketchSolid<T>>),
    /// The first body combined with each of the others.
    Combined(Operation, Vec<BodyTree<T>>),
}

/// The combination tree of an object's body; `None` without a body, or if a body in it has trimmed
/// round faces.
pub fn body_tree<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    layout: &DimensionLayout<T>,
) -> Option<BodyTree<T>> {
    match &object.feature {
        Some(feature) => feature.tree(layout),
        None => plain(body_at(object, planes, layout, &FacetPlan::default()).ok()?),
    }
}

fn plain<T>(body: SketchSolid<T>) -> Option<BodyTree<T>> {
    body.trims.is_empty().then(|| BodyTree::Plain(Box::new(body)))
}

impl Feature {
    fn tree<T: Real>(&self, layout: &DimensionLayout<T>) -> Option<BodyTree<T>> {
        let operands = || -> Option<Vec<BodyTree<T>>> {
            let laid = self.laid(layout);
            let each = self.operands.iter().zip(&laid);
            each.map(|(operand, (planes, own))| body_tree(&operand.object, planes, own)).collect()
        };
        match &self.kind {
            FeatureKind::Boolean(operation) => Some(BodyTree::Combined(*operation, operands()?)),
            FeatureKind::Place(_) | FeatureKind::OnFace { .. } | FeatureKind::Pattern { .. } => {
                let laid = self.laid(layout);
                let images = self.images(layout, &laid, &FacetPlan::default()).ok()?;
                let (planes, own) = laid.first()?;
                let one = body_tree(&self.operands.first()?.object, planes, own)?;
                let mut copies: Vec<BodyTree<T>> =
                    images.iter().map(|image| one.placed(image)).collect();
                match copies.len() {
                    1 => copies.pop(),
                    _ => Some(BodyTree::Combined(Operation::Union, copies)),
                }
            }
            FeatureKind::Hole(hole) => {
                let (planes, own) = self.laid(layout).pop()?;
                let inner = &self.operands[0].object;
                let body = body_at(inner, &planes, &own, &FacetPlan::default()).ok()?;
                let drill = hole.drill(&body, layout, FacetDensity::default()).ok()?;
                let drill = BodyTree::Plain(Box::new(drill));
                let images = hole.images(layout).ok()?;
                let mut parts = operands()?;
                parts.extend(images.iter().map(|image| drill.placed(image)));
                Some(BodyTree::Combined(Operation::Cut, parts))
            }
            _ => plain(self.body(layout, &FacetPlan::default()).ok()?),
        }
    }
}

impl<T: Real> BodyTree<T> {
    fn placed(&self, image: &Similarity<T>) -> BodyTree<T> {
        match self {
            BodyTree::Plain(body) => BodyTree::Plain(Box::new(body.placed(image))),
            BodyTree::Combined(operation, parts) => {
                BodyTree::Combined(*operation, parts.iter().map(|p| p.placed(image)).collect())
            }
        }
    }
}
