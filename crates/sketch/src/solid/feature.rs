//! Features: objects that are made of others and computed again with every change.

use super::blend::{BlendSize, blended};
use super::combine::{CombineError, combined, united};
pub use super::edges::TreatmentFault;
use super::offset::{drafted, shelled};
use super::place::Similarity;
use super::turn::turned;
use super::validity::{SolidDefect, valid};
use super::{SketchSolid, unchecked};
use crate::feature::{EdgeBlend, Feature, FeatureKind, FeatureOperand, Placement};
use crate::{DimensionExpr, DimensionLayout, Estimate, Planes, SketchObject, Variable, solve};
use moldloft_num::{Real, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Why an object has no body.
#[derive(Clone, Debug, PartialEq)]
pub enum NoBody {
    /// It has no faces, or misses dimensions.
    Unfinished,
    /// It is not valid.
    Flaw(SolidDefect),
    /// The operands cannot be combined.
    Combine(CombineError),
    /// An operand has none.
    Operand {
        /// Its name.
        name: String,
        /// Why.
        why: Box<NoBody>,
    },
    /// A number of the feature has no value.
    NoValue(String),
    /// Edges or faces cannot be treated as asked.
    Treatment(TreatmentFault),
    /// The section lies on both sides of the line it is turned about, or the line has no length.
    Axis,
}

/// How often chords are cut in three until facets tell where round surfaces meet.
const FINEST: u32 = 2;

/// The valid body of an object. Where its facets are too coarse to say which surfaces meet, it is made again with finer
/// ones.
///
/// # Errors
/// [`NoBody`], with the place.
pub fn body<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    layout: &DimensionLayout<T>,
) -> Result<SketchSolid<T>, NoBody> {
    let first = body_at(object, planes, layout, 0);
    let Err(why) = &first else { return first };
    if !why.coarse() {
        return first;
    }
    for fineness in 1..=FINEST {
        match body_at(object, planes, layout, fineness) {
            Err(why) if why.coarse() => {}
            // More pieces than can be handled: what the first look says is nearer to the point.
            Err(NoBody::Combine(CombineError::TooLarge)) => break,
            found => return found,
        }
    }
    first
}

impl NoBody {
    /// Whether finer facets may help.
    fn coarse(&self) -> bool {
        let nearly = |e: &CombineError| {
            matches!(e, CombineError::Coarse(_) | CombineError::Touching(_) | CombineError::Open(_))
        };
        match self {
            NoBody::Combine(e) | NoBody::Flaw(SolidDefect::Unresolved(e)) => nearly(e),
            NoBody::Operand { why, .. } => why.coarse(),
            _ => false,
        }
    }
}

fn body_at<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    layout: &DimensionLayout<T>,
    fineness: u32,
) -> Result<SketchSolid<T>, NoBody> {
    match &object.feature {
        Some(feature) => feature.body(layout, fineness),
        None => {
            let mut body = unchecked(object, planes, layout).ok_or(NoBody::Unfinished)?;
            body.name_faces(object);
            body.fineness = fineness;
            valid(body).map_err(NoBody::Flaw)
        }
    }
}

impl Feature {
    /// An object of this feature. The numbers of its operands become its variables.
    pub fn object(self, name: &str) -> SketchObject {
        let mut out = SketchObject::new(name, None);
        if let Some(first) = self.operands.first() {
            out.units.clone_from(&first.object.units);
            let drawing = out.draw();
            drawing.projection = first.object.drawing.projection;
            drawing.letters = first.object.drawing.letters;
            if first.object.drawing.section.is_some() {
                drawing.projection = crate::Projection::default();
            }
        }
        for operand in &self.operands {
            let inner = &operand.object;
            let named = |n: &str| inner.has_name(n).then(|| format!("{}{n}", operand.prefix));
            let variables = inner.variables.values().map(|v| (&v.name, &v.value, v.range));
            let dimensions = (inner.dimensions.values())
                .filter(|d| d.role == crate::DimensionRole::Driving)
                .filter_map(|d| Some((&d.name, d.value.as_ref()?, d.range)));
            for (name, value, range) in variables.chain(dimensions) {
                let name = format!("{}{name}", operand.prefix);
                let value = value.renamed(&named);
                let key = name.to_ascii_lowercase();
                out.variables.insert(key, Variable { name, value, range });
            }
        }
        out.feature = Some(Arc::new(self));
        out
    }

    /// The operands of objects, with the prefixes that keep their names apart.
    pub fn operands(objects: &[&SketchObject]) -> Vec<FeatureOperand> {
        let mut taken: Vec<String> = Vec::new();
        objects
            .iter()
            .map(|&object| {
                // The names of a feature differ already.
                let names = || object.variables.keys().chain(object.dimensions.keys());
                let plain = object.feature.is_some() && !names().any(|n| taken.contains(n));
                let prefix = if plain {
                    String::new()
                } else {
                    format!("{}.", crate::solid::merge::identifier(&object.name))
                };
                taken.extend(names().map(|n| format!("{}{n}", prefix.to_ascii_lowercase())));
                FeatureOperand { object: Arc::new(object.clone()), prefix }
            })
            .collect()
    }

    fn body<T: Real>(
        &self,
        layout: &DimensionLayout<T>,
        fineness: u32,
    ) -> Result<SketchSolid<T>, NoBody> {
        let value = |e: &DimensionExpr| {
            let x = e.eval(&|n| layout.values.get(n).copied());
            x.map_err(|no| NoBody::NoValue(no.name))
        };
        let mut bodies = Vec::new();
        let mut laid = Vec::new();
        let mut empty = Vec::new();
        for operand in &self.operands {
            let inner = &operand.object;
            let prefix = operand.prefix.to_ascii_lowercase();
            let own: BTreeMap<String, T> = (layout.values.iter())
                .filter_map(|(k, v)| Some((k.strip_prefix(&prefix)?.to_owned(), *v)))
                .collect();
            let planes = Planes::of(&inner.drawing);
            let estimate =
                || Estimate::of(&inner.drawing, &planes, inner.reference().map(|r| r.point)?);
            let own = solve(inner, &planes, &own, &estimate);
            let name = inner.name.clone();
            let body = body_at(inner, &planes, &own, fineness).map(|mut body| {
                body.prefix_names(&operand.prefix);
                body
            });
            // Nothing is an operand too: what is cut from it or added to it has a body.
            let nothing = matches!(body, Err(NoBody::Combine(CombineError::Empty)));
            empty.push(nothing);
            bodies.push(match body {
                Ok(body) => body,
                Err(_) if nothing => SketchSolid::default(),
                Err(why) => return Err(NoBody::Operand { name, why: Box::new(why) }),
            });
            laid.push((planes, own));
        }
        let nothing = || NoBody::Combine(CombineError::Empty);
        match (&self.kind, &bodies[..]) {
            (FeatureKind::Boolean(operation), [a, b]) if empty.contains(&true) => {
                let rest =
                    [a, b].into_iter().zip(&empty).enumerate().find(|(_, (_, none))| !**none);
                match rest {
                    Some((k, (body, _))) if operation.holds(k == 0, k == 1) => Ok(body.clone()),
                    _ => Err(nothing()),
                }
            }
            (_, [..]) if empty.contains(&true) => Err(nothing()),
            (FeatureKind::Boolean(operation), [a, b]) => {
                combined([a, b], *operation).map_err(NoBody::Combine)
            }
            (FeatureKind::Revolve { line, angle }, [section]) => {
                let (planes, own) = &laid[0];
                let ends = line.map(|p| own.point(planes, p));
                let [Some(p), Some(q)] = ends else { return Err(NoBody::Unfinished) };
                let angle = value(angle)? * (std::f64::consts::PI / 180.0);
                one_side(section, [p.re(), q.re()]).then_some(()).ok_or(NoBody::Axis)?;
                let name = |e: usize| side_name(&self.operands[0].object, section, e);
                let mut body = turned(section, [p, q], angle, &name).ok_or(NoBody::Axis)?;
                body.fineness = fineness;
                valid(body).map_err(NoBody::Flaw)
            }
            (FeatureKind::Place(place), [body]) => Ok(body.placed(&place.similarity(&value)?)),
            (FeatureKind::Pattern { step, count }, [body]) => {
                let step = step.similarity(&value)?;
                let mut place = Similarity::identity();
                let mut copies = vec![body.clone()];
                for k in 1..*count {
                    place = place.then(&step);
                    let mut copy = body.placed(&place);
                    copy.prefix_names(&format!("COPY{}.", k + 1));
                    copies.push(copy);
                }
                let all: Vec<&SketchSolid<T>> = copies.iter().collect();
                united(&all).map_err(NoBody::Combine)
            }
            (FeatureKind::Blend { blend, edges }, [body]) => {
                let size = match blend {
                    EdgeBlend::Chamfer([a, b]) => BlendSize::Chamfer([value(a)?, value(b)?]),
                    EdgeBlend::Fillet(radius) => BlendSize::Fillet(value(radius)?),
                };
                blended(body, &self.operands[0].object, size, edges)
            }
            (FeatureKind::Shell { thickness, open }, [body]) => {
                shelled(body, value(thickness)?, open)
            }
            (FeatureKind::Draft { angle, axis, at, faces }, [body]) => {
                let angle = value(angle)? * (std::f64::consts::PI / 180.0);
                drafted(body, angle, *axis, value(at)?, faces)
            }
            _ => Err(NoBody::Unfinished),
        }
    }
}

/// The name of the face that an edge of a section becomes when it is turned: its curve's, or `L` and the number
/// of its line.
fn side_name<T: Real>(
    object: &SketchObject,
    section: &SketchSolid<T>,
    edge: usize,
) -> Option<Arc<str>> {
    let edge = &section.edges[edge];
    if let Some((_, curve)) = edge.curve.and_then(|k| object.curves.get_index(k)) {
        return Some(curve.name.as_str().into());
    }
    let ends = edge.ends.map(|v| section.vertices[v].id);
    let line = object.drawing.line_between(ends[0], ends[1]);
    line.map(|l| format!("L{l}").into())
}

impl<T: Real> SketchSolid<T> {
    /// Names the faces of a drawing: by their numbers, those of curves by the curves.
    fn name_faces(&mut self, object: &SketchObject) {
        for k in 0..self.faces.len() {
            let face = &self.faces[k];
            let name: Option<Arc<str>> = match face.id {
                Some(id) => Some(id.to_string().into()),
                None => {
                    let curve = face.loops.iter().flatten().find_map(|h| self.edges[h.0].curve);
                    let curve = curve.and_then(|c| object.curves.get_index(c));
                    curve.map(|(_, c)| c.name.as_str().into())
                }
            };
            self.faces[k].names = name.into_iter().collect();
        }
    }

    /// What all names of faces begin with from now on.
    fn prefix_names(&mut self, prefix: &str) {
        if !prefix.is_empty() {
            for name in self.faces.iter_mut().flat_map(|f| &mut f.names) {
                *name = format!("{prefix}{name}").into();
            }
        }
    }
}

impl Placement {
    fn similarity<T: Real>(
        &self,
        value: &dyn Fn(&DimensionExpr) -> Result<T, NoBody>,
    ) -> Result<Similarity<T>, NoBody> {
        let vector = |v: &[DimensionExpr; 3]| -> Result<Vec3<T>, NoBody> {
            Ok(Vec3::new(value(&v[0])?, value(&v[1])?, value(&v[2])?))
        };
        Ok(match self {
            Placement::Move(by) => Similarity::moved(vector(by)?),
            Placement::Rotate { axis, through, angle } => {
                let angle = value(angle)? * (std::f64::consts::PI / 180.0);
                Similarity::turned(axis.index(), vector(through)?, angle)
            }
            Placement::Mirror { axis, at } => Similarity::mirrored(axis.index(), value(at)?),
            Placement::Scale(factor) => Similarity::scaled(value(factor)?),
        })
    }
}

/// Whether a section lies on one side of a line.
fn one_side<T: Real>(section: &SketchSolid<T>, [p, q]: [Vec3; 2]) -> bool {
    let Some(direction) = (q - p).normalized() else { return false };
    let mesh = section.faceted();
    let arms: Vec<Vec3> = mesh.positions().iter().map(|x| (x.re() - p).cross(direction)).collect();
    let Some(farthest) = arms.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())) else {
        return false;
    };
    let size = farthest.norm_sq();
    size > 0.0 && arms.iter().all(|a| a.dot(*farthest) >= -1e-9 * size)
}
