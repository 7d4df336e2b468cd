//! Features: objects that are made of others and computed again with every change.

use super::blend::blended;
use super::blend_order::BlendSize;
use super::combine::{CombineError, combined, united};
pub use super::edges::TreatmentFault;
use super::face_place::FacePlane;
use super::kept_bodies::{KeptBodies, KeptBody, numbers};
use super::loft::lofted;
use super::offset::{drafted, moved, shelled};
use super::offset_section::moved_section;
use super::one_sided::confirm;
use super::operation::Operation;
use super::outline::FacetDensity;
use super::outline_offset::offset_outline;
use super::outline_sides::outline_sides;
use super::pierced::{bored, lie_apart, side_by_side};
use super::place::Similarity;
use super::sweep_path::{SweepPath, border_path, drawn_path};
use super::swept::{extruded, swept};
use super::turn::turned;
use super::validity::{SolidDefect, valid, valid_turned};
use super::{SketchSolid, unchecked};
use crate::feature::{EdgeBlend, FaceChoice, Feature, FeatureKind, FeatureOperand, Placement};
use crate::{DimensionExpr, DimensionLayout, Estimate, Planes, SketchObject, Variable, solve};
use moldloft_num::{Real, Vec3};
use std::any::Any;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// Reason why an object has no body.
#[derive(Clone, Debug, PartialEq)]
pub enum NoBody {
    /// It has no faces, or dimensions are missing.
    Unfinished,
    /// It is not valid.
    Flaw(SolidDefect),
    /// The operands cannot be combined.
    Combine(CombineError),
    /// An operand without a body.
    Operand {
        /// Its name.
        name: String,
        /// Its index, from 0.
        number: usize,
        /// Why.
        why: Box<NoBody>,
    },
    /// A number of the feature has no value.
    NoValue(String),
    /// A number of copies that is not an integer, or out of range.
    Copies(f64),
    /// Edges or faces cannot be treated.
    Treatment(TreatmentFault),
    /// An operand is a cross section but should not be, or the reverse.
    Section {
        /// Its name.
        name: String,
        /// True if a cross section is required.
        wanted: bool,
    },
    /// The section is on both sides of the axis of rotation, or the axis has zero length.
    Axis,
}

/// More copies than this are refused.
pub(crate) const MAX_COPIES: u32 = 400;

/// Maximum number of subdivisions of chords into three, near points at which facets do not
/// determine the intersecting surfaces, then everywhere.
const FINEST: u32 = 4;
const FINEST_EVERYWHERE: u32 = 2;

/// Maximum number of rounds; finer facets may reveal further such points.
const ROUNDS: u32 = 12;

/// Maximum number of facets of all attempts of a combination.
const MAX_TRIED_FACETS: usize = 40_000;

/// The valid body of an object. Facets too coarse to determine intersecting surfaces are refined.
/// If measures may lack derivatives, the two one-sided derivatives are compared.
///
/// # Errors
/// [`NoBody`], with the position.
pub fn body<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    layout: &DimensionLayout<T>,
) -> Result<SketchSolid<T>, NoBody> {
    let mut made = FacetPlan::default().searched(object, planes, layout)?;
    confirm(&mut made, layout, &|layout| Some(body(object, planes, layout).ok()?.mass()));
    Ok(made)
}

/// The valid body of an object, with the bodies that are kept.
pub(crate) fn body_kept(
    object: &Arc<SketchObject>,
    planes: &Planes,
    layout: &DimensionLayout<f64>,
    kept: &Arc<SessionBodies>,
) -> Result<SketchSolid<f64>, NoBody> {
    let mut plan = FacetPlan { kept: Arc::clone(kept), ..FacetPlan::default() };
    match object.feature {
        Some(_) => plan.made(object, planes, layout),
        // Drawings change at every move of a drag.
        None => plan.searched(object, planes, layout),
    }
}

type Made = Result<SketchSolid<f64>, NoBody>;

/// The latest bodies of a session.
pub(crate) type SessionBodies = KeptBodies<Made>;

/// Facets of a body: those that the features need that have it as an operand, in its own coordinates, and its own.
#[derive(Clone, Default)]
pub(super) struct FacetPlan {
    inherited: FacetDensity,
    own: FacetDensity,
    kept: Arc<SessionBodies>,
}

impl FacetPlan {
    fn density(&self) -> FacetDensity {
        self.inherited.with(&self.own)
    }

    /// The plan of an operand that is used at several positions.
    fn of_operand<T: Real>(&self, images: &[Similarity<T>]) -> FacetPlan {
        let density = self.density();
        let back = |image: &Similarity<T>| density.mapped(&|p| image.source_of(p));
        let inherited = images.iter().map(back).fold(FacetDensity::default(), |d, e| d.with(&e));
        FacetPlan { inherited, own: FacetDensity::default(), kept: Arc::clone(&self.kept) }
    }

    /// The body of an object, kept or made. Bodies with derivatives are made of the facets of those without.
    fn made<T: Real>(
        &self,
        object: &Arc<SketchObject>,
        planes: &Planes,
        layout: &DimensionLayout<T>,
    ) -> Result<SketchSolid<T>, NoBody> {
        let mut plan = self.clone();
        let numbers = numbers(layout);
        let known = self.kept.find(object, &numbers, &self.inherited);
        if let Some((own, made)) = known {
            if let Some(made) = (made.as_deref()).and_then(|m| (m as &dyn Any).downcast_ref()) {
                return Result::clone(made);
            }
            plan.own = own;
        } else if self.inherited != FacetDensity::default() {
            plan.own = self.plain_facets(object, planes, layout, &numbers);
        }
        let made = plan.searched(object, planes, layout);
        let plain = (&made as &dyn Any).downcast_ref::<Made>().map(|m| Arc::new(m.clone()));
        let FacetPlan { inherited, own, .. } = plan;
        let object = Arc::clone(object);
        let body = plain.as_deref().and_then(|m: &Made| m.as_ref().ok());
        let size = body.map_or(1, |body| body.vertices.len());
        self.kept.keep(KeptBody { object, numbers, inherited, own, made: plain, size });
        made
    }

    /// The facets that an object needs apart from its operands.
    fn plain_facets<T: Real>(
        &self,
        object: &Arc<SketchObject>,
        planes: &Planes,
        layout: &DimensionLayout<T>,
        numbers: &[u64],
    ) -> FacetDensity {
        let plain = FacetPlan { kept: Arc::clone(&self.kept), ..FacetPlan::default() };
        let find = || self.kept.find(object, numbers, &plain.inherited);
        if find().is_none() {
            let _ = plain.made(object, planes, layout);
        }
        find().map(|known| known.0).unwrap_or_default()
    }

    /// The body of an object with the facets that determine it. Those are then the plan's own ones.
    fn searched<T: Real>(
        &mut self,
        object: &SketchObject,
        planes: &Planes,
        layout: &DimensionLayout<T>,
    ) -> Result<SketchSolid<T>, NoBody> {
        let start = self.own.clone();
        let first = body_at(object, planes, layout, self);
        let error = first.as_ref().err().and_then(NoBody::facet_error).cloned();
        let Some(error) = error else { return first };
        let mut failed = Some(error.clone());
        let (mut facets, mut last) = (0, usize::MAX);
        for _ in 0..ROUNDS {
            let Some(why) = failed.take() else { break };
            let own = why.facets();
            facets += own;
            // Finer facets along a whole contact become more by the same factor each time.
            let next = if own / 2 > last { own.saturating_mul(own / last.max(1)) } else { 0 };
            last = own;
            if facets.saturating_add(next) > MAX_TRIED_FACETS || !self.refine(&why) {
                break;
            }
            match body_at(object, planes, layout, self) {
                Err(why) if why.too_large() => facets = usize::MAX,
                Err(why) => failed = why.facet_error().cloned(),
                made => return made,
            }
        }
        // Else the points at which surfaces touch are not all known.
        let coarse = matches!(error.cause(), CombineError::Coarse(_));
        for everywhere in 1..=FINEST_EVERYWHERE {
            // Facets of curved surfaces in both directions.
            facets = facets.saturating_add(9usize.pow(everywhere) * error.facets());
            if coarse || facets > MAX_TRIED_FACETS {
                break;
            }
            self.own = FacetDensity { everywhere, ..start.clone() };
            match body_at(object, planes, layout, self) {
                Err(why) if why.too_large() => break,
                Err(_) => {}
                made => return made,
            }
        }
        self.own = start;
        first
    }

    /// Lets chords end where surfaces touch, then makes facets finer near the places of an error; returns whether that was
    /// still possible.
    fn refine(&mut self, why: &CombineError) -> bool {
        let known = self.density().rulings;
        let new: Vec<_> = why.rulings().iter().filter(|r| !known.contains(r)).cloned().collect();
        if !new.is_empty() {
            self.own.rulings.extend(new);
            return true;
        }
        let times = self.own.near.iter().map(|p| p.1).max().unwrap_or(0) + 1;
        self.own.near.extend(why.places().into_iter().map(|p| (p, times)));
        times <= FINEST
    }
}

impl NoBody {
    /// The error, if finer facets can remove it.
    fn facet_error(&self) -> Option<&CombineError> {
        match self {
            NoBody::Combine(e) | NoBody::Flaw(SolidDefect::Unresolved(e)) => {
                (!matches!(e, CombineError::TooLarge | CombineError::Empty)).then_some(e)
            }
            _ => None,
        }
    }

    /// True if this feature or one of its operands had too many pieces.
    fn too_large(&self) -> bool {
        match self {
            NoBody::Combine(e) | NoBody::Flaw(SolidDefect::Unresolved(e)) => {
                *e == CombineError::TooLarge
            }
            NoBody::Operand { why, .. } => why.too_large(),
            _ => false,
        }
    }
}

pub(super) fn body_at<T: Real>(
    object: &SketchObject,
    planes: &Planes,
    layout: &DimensionLayout<T>,
    plan: &FacetPlan,
) -> Result<SketchSolid<T>, NoBody> {
    let made = match &object.feature {
        // A moved body closes as it did.
        Some(feature)
            if matches!(feature.kind, FeatureKind::Place(_) | FeatureKind::OnFace { .. }) =>
        {
            return feature.body(layout, plan);
        }
        Some(feature) => feature.body(layout, plan)?,
        None => {
            let mut body = unchecked(object, planes, layout).ok_or(NoBody::Unfinished)?;
            body.name_faces(object);
            body.density = plan.density();
            valid(body).map_err(NoBody::Flaw)?
        }
    };
    // What was combined is balanced already.
    if made.facets.is_some() { Ok(made) } else { made.balanced().map_err(NoBody::Combine) }
}

impl Feature {
    /// An object defined by this feature. The numbers of its operands become its variables.
    pub fn object(self, name: &str) -> SketchObject {
        let section = match &self.kind {
            FeatureKind::Text(text) => Some(text.axis),
            _ => self.operands.first().and_then(|first| first.object.drawing.section),
        };
        let mut out = SketchObject::new(name, section.filter(|_| self.kind.makes_section()));
        if let Some(first) = self.operands.first() {
            out.on = first.object.on.clone().filter(|_| self.kind.makes_section());
            out.units.clone_from(&first.object.units);
            let drawing = out.draw();
            drawing.projection = first.object.drawing.projection;
            drawing.letters = first.object.drawing.letters;
            if section.is_some() && drawing.section.is_none() {
                drawing.projection = crate::Projection::default();
            }
        }
        for operand in &self.operands {
            let inner = &operand.object;
            let named = |n: &str| inner.has_name(n).then(|| format!("{}{n}", operand.prefix));
            for (name, value, range) in inner.own_numbers() {
                // A number of an object that is followed stays there; here is its name alone.
                let (value, range) = match operand.follows {
                    true if !operand.prefix.is_empty() => continue,
                    true => {
                        let of = crate::identifier::identifier(&inner.name);
                        (DimensionExpr::name(&format!("{of}.{name}")), None)
                    }
                    false => (value.renamed(&named), range),
                };
                let name = format!("{}{name}", operand.prefix);
                let key = name.to_ascii_lowercase();
                out.variables.insert(key, Variable { name, value, range });
            }
        }
        out.feature = Some(Arc::new(self));
        out
    }

    /// The operands of objects, each true if it is another object of the session, with prefixes
    /// that keep their names distinct.
    pub fn operands(objects: Vec<(Arc<SketchObject>, bool)>) -> Vec<FeatureOperand> {
        let own = |object: &SketchObject| -> Vec<String> {
            object.own_numbers().map(|n| n.0.to_ascii_lowercase()).collect()
        };
        let of_others = |object: &SketchObject| -> Vec<String> {
            object.followed_numbers().iter().map(|n| n.0.to_ascii_lowercase()).collect()
        };
        let path = |object: &SketchObject| {
            format!("{}.", crate::identifier::identifier(&object.name).to_ascii_lowercase())
        };
        // The names of numbers that are followed, wherever they are read.
        let mut taken: Vec<String> = Vec::new();
        for (object, follows) in &objects {
            taken.extend(of_others(object));
            if *follows {
                taken.extend(own(object).iter().map(|n| format!("{}{n}", path(object))));
            }
        }
        let mut shared: Vec<String> = Vec::new();
        let mut operands = Vec::new();
        for (object, follows) in objects {
            // The names of a feature differ already.
            let (names, others) = (own(&object), of_others(&object));
            let plain = object.feature.is_some()
                && !names.iter().any(|n| taken.contains(n) || shared.contains(n))
                && !others.iter().any(|n| shared.contains(n));
            let prefix = match plain {
                true => String::new(),
                false => format!("{}.", crate::identifier::identifier(&object.name)),
            };
            shared.extend(names.iter().map(|n| format!("{}{n}", prefix.to_ascii_lowercase())));
            shared.extend(others);
            operands.push(FeatureOperand { object, prefix, follows });
        }
        operands
    }

    /// The same feature of the present states of the objects that it follows, by their folded names; `None` if they are
    /// as they were. One that is no more becomes a part.
    pub(crate) fn refreshed(
        &self,
        live: &dyn Fn(&str) -> Option<Arc<SketchObject>>,
    ) -> Option<Feature> {
        let mut changed = false;
        let mut operands = self.operands.clone();
        for operand in &mut operands {
            let now = match operand.followed() {
                Some(name) => live(&name.to_lowercase()),
                None => operand.object.refreshed(live),
            };
            match now {
                Some(now) if !Arc::ptr_eq(&now, &operand.object) => operand.object = now,
                None if operand.follows => operand.follows = false,
                _ => continue,
            }
            changed = true;
        }
        changed.then(|| Feature { kind: self.kind.clone(), operands })
    }

    /// The planes and positions of each operand.
    pub(super) fn laid<T: Real>(
        &self,
        layout: &DimensionLayout<T>,
    ) -> Vec<(Planes, DimensionLayout<T>)> {
        let of = |operand: &FeatureOperand| {
            let inner = &operand.object;
            let path = operand.path();
            let mut own: BTreeMap<String, T> = (layout.values.iter())
                .filter_map(|(k, v)| Some((k.strip_prefix(&path)?.to_owned(), *v)))
                .collect();
            // Numbers of other objects have the same names everywhere.
            for name in foreign(inner) {
                if let Some(value) = layout.values.get(&name) {
                    own.entry(name).or_insert(*value);
                }
            }
            let planes = Planes::of(&inner.drawing);
            let estimate =
                || Estimate::of(&inner.drawing, &planes, inner.reference().map(|r| r.point)?);
            let own = solve(inner, &planes, &own, &estimate);
            (planes, own)
        };
        self.operands.iter().map(of).collect()
    }

    /// Positions of the operand: one, or those of a pattern.
    pub(super) fn images<T: Real>(
        &self,
        layout: &DimensionLayout<T>,
        laid: &[(Planes, DimensionLayout<T>)],
        plan: &FacetPlan,
    ) -> Result<Vec<Similarity<T>>, NoBody> {
        match &self.kind {
            FeatureKind::OnFace { face, along } => {
                let base = self.operand_body(1, &laid[1], plan, &[])?;
                // Named as the operand itself names it.
                let face = match face {
                    FaceChoice::Named(name) => {
                        FaceChoice::Named(format!("{}{name}", self.operands[1].prefix))
                    }
                    extreme @ FaceChoice::Extreme { .. } => extreme.clone(),
                };
                let place = FacePlane::of(&base, &face).and_then(|p| p.place(&face, *along));
                Ok(vec![place.map_err(NoBody::Treatment)?])
            }
            FeatureKind::Place(place) => Ok(vec![place.similarity(&|e| number(layout, e))?]),
            FeatureKind::Pattern { step, count } => {
                let step = step.similarity(&|e| number(layout, e))?;
                let mut images = vec![Similarity::identity()];
                for k in 1..copies(layout, count)? {
                    images.push(images[k - 1].then(&step));
                }
                Ok(images)
            }
            _ => Ok(vec![Similarity::identity()]),
        }
    }

    pub(super) fn body<T: Real>(
        &self,
        layout: &DimensionLayout<T>,
        plan: &FacetPlan,
    ) -> Result<SketchSolid<T>, NoBody> {
        let value = |e: &DimensionExpr| number(layout, e);
        // An object that is followed may have become a solid, or a section.
        let section = self.kind.takes_section();
        let made_of = match self.kind {
            FeatureKind::Sweep => 1,
            _ => self.operands.len(),
        };
        let mut operands = self.operands.iter().take(made_of);
        let other = operands.find(|o| o.object.drawing.section.is_some() != section);
        if let Some(operand) = other {
            return Err(NoBody::Section { name: operand.object.name.clone(), wanted: section });
        }
        let laid = self.laid(layout);
        let images = self.images(layout, &laid, plan)?;
        let mut bodies = Vec::new();
        let mut empty = Vec::new();
        let used = match self.kind {
            FeatureKind::OnFace { .. } => 1,
            _ => made_of,
        };
        for (k, own) in laid.iter().enumerate().take(used) {
            let body = self.operand_body(k, own, plan, &images);
            // An empty operand is valid: the result may have a body.
            let nothing = matches!(&body, Err(NoBody::Operand { why, .. })
                if **why == NoBody::Combine(CombineError::Empty));
            empty.push(nothing);
            bodies.push(match body {
                Err(_) if nothing => SketchSolid::default(),
                body => body?,
            });
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
            (FeatureKind::Boolean(Operation::Cut), [a, b]) if let Some(mut made) = bored(a, b) => {
                made.density = plan.density();
                valid(made).map_err(NoBody::Flaw)
            }
            (FeatureKind::Boolean(operation), [a, b]) => {
                let apart = *operation == Operation::Union && lie_apart(&bodies);
                match apart {
                    true => Ok(side_by_side(bodies)),
                    false => combined([a, b], *operation).map_err(NoBody::Combine),
                }
            }
            (FeatureKind::Text(text), []) => {
                let size = value(&text.size)?;
                if size.re() <= 0.0 {
                    let fault = "a text of no height";
                    let fault = TreatmentFault::new(fault, None, "give a size above 0");
                    return Err(NoBody::Treatment(fault));
                }
                let angle = value(&text.angle)? * (std::f64::consts::PI / 180.0);
                let [p, q] = &text.at;
                let mut made = text.section(size, [value(p)?, value(q)?], angle);
                made.density = plan.density();
                valid(made).map_err(NoBody::Flaw)
            }
            (FeatureKind::Offset { distance, corner }, [section]) => {
                let name = |e: usize| side_name(&self.operands[0].object, section, e);
                let mut made = offset_outline(section, value(distance)?, *corner, &name)
                    .map_err(NoBody::Treatment)?;
                made.density = plan.density();
                valid(made).map_err(NoBody::Flaw)
            }
            (FeatureKind::Extrude(distance), [section]) => {
                let object = &self.operands[0].object;
                let axis = object.drawing.section.ok_or(NoBody::Unfinished)?;
                let mut by = [T::zero(); 3];
                by[axis.index()] = value(distance)?;
                let name = |e: usize| side_name(object, section, e);
                let mut made = extruded(section, by.into(), &name).ok_or_else(no_length)?;
                made.density = plan.density();
                valid(made).map_err(NoBody::Flaw)
            }
            (FeatureKind::Sweep, [section]) => {
                let object = &self.operands[0].object;
                let path = self.path(&laid[1], plan)?;
                let axis = object.drawing.section.ok_or(NoBody::Unfinished)?;
                let mut normal = [0.0; 3];
                normal[axis.index()] = 1.0;
                let moved = path.rings(section, normal.into()).map_err(NoBody::Treatment)?;
                let name = |e: usize| side_name(object, section, e);
                let mut made = swept(section, &moved.rings, &moved.spans, &name);
                made.density = plan.density();
                valid(made).map_err(NoBody::Flaw)
            }
            (FeatureKind::Loft, sections) if sections.len() > 1 => {
                let outline = |k: usize| {
                    let FeatureOperand { object, prefix, .. } = &self.operands[k];
                    let name = |e: usize| {
                        let name = side_name(object, &sections[k], e)?;
                        Some(format!("{prefix}{name}").into())
                    };
                    outline_sides(&sections[k], &name)
                };
                let outlines = (0..sections.len()).map(outline).collect::<Result<Vec<_>, _>>();
                let made = outlines.and_then(|all| lofted(&all)).map_err(NoBody::Treatment)?;
                valid(SketchSolid { density: plan.density(), ..made }).map_err(NoBody::Flaw)
            }
            (FeatureKind::Revolve { line, angle }, [section]) => {
                let (planes, own) = &laid[0];
                let ends = line.map(|p| own.point(planes, p));
                let [Some(p), Some(q)] = ends else { return Err(NoBody::Unfinished) };
                self.turned(section, [p, q], value(angle)?, plan.density())
            }
            (FeatureKind::Place(_) | FeatureKind::OnFace { .. }, [body]) => {
                Ok(body.placed(&images[0]))
            }
            (FeatureKind::Pattern { .. }, [body]) => repeated(body, &images),
            (FeatureKind::Blend { blend, edges }, [body]) => {
                let size = match blend {
                    EdgeBlend::Chamfer([a, b]) => BlendSize::Chamfer([value(a)?, value(b)?]),
                    EdgeBlend::Fillet(radius) => BlendSize::Fillet(value(radius)?),
                };
                blended(body, &self.operands[0].object, size, edges)
            }
            (FeatureKind::Shell { thickness, open }, [body]) => {
                let parts = |by: T, still: &BTreeSet<String>| {
                    let (planes, own) = &laid[0];
                    self.operand_moved(0, (planes, own), &plan.of_operand(&images), by, still)
                };
                shelled(body, value(thickness)?, open, &parts)
            }
            (FeatureKind::Hole(hole), [body]) => hole.drilled(body, layout, plan.density()),
            (FeatureKind::Draft { angle, axis, at, faces }, [body]) => {
                let angle = value(angle)? * (std::f64::consts::PI / 180.0);
                drafted(body, angle, *axis, value(at)?, faces)
            }
            _ => Err(NoBody::Unfinished),
        }
    }

    /// The body of an operand that is used at some positions, with the names of its faces.
    fn operand_body<T: Real>(
        &self,
        k: usize,
        (planes, own): &(Planes, DimensionLayout<T>),
        plan: &FacetPlan,
        images: &[Similarity<T>],
    ) -> Result<SketchSolid<T>, NoBody> {
        let FeatureOperand { object, prefix, .. } = &self.operands[k];
        match plan.of_operand(images).made(object, planes, own) {
            Ok(mut body) => {
                body.prefix_names(prefix);
                Ok(body)
            }
            Err(why) => {
                let name = object.name.clone();
                Err(NoBody::Operand { name, number: k, why: Box::new(why) })
            }
        }
    }

    /// The path of a sweep: a drawn chain, or the border of a section that was made of another one.
    fn path<T: Real>(
        &self,
        laid: &(Planes, DimensionLayout<T>),
        plan: &FacetPlan,
    ) -> Result<SweepPath<T>, NoBody> {
        let object = &self.operands[1].object;
        let path = match object.feature {
            None => drawn_path(object, &laid.0, &laid.1),
            Some(_) => border_path(&object.name, &self.operand_body(1, laid, plan, &[])?),
        };
        path.map_err(NoBody::Treatment)
    }

    /// A section turned about the line through two points, by an angle in degrees.
    fn turned<T: Real>(
        &self,
        section: &SketchSolid<T>,
        [p, q]: [Vec3<T>; 2],
        angle: T,
        density: FacetDensity,
    ) -> Result<SketchSolid<T>, NoBody> {
        let angle = angle * (std::f64::consts::PI / 180.0);
        one_side(section, [p.re(), q.re()]).then_some(()).ok_or(NoBody::Axis)?;
        let name = |e: usize| side_name(&self.operands[0].object, section, e);
        let mut body = turned(section, [p, q], angle, &name).ok_or(NoBody::Axis)?;
        body.density = density;
        // What meets about one axis meets in the section, which was checked.
        let whole = angle.re().abs() >= std::f64::consts::TAU * (1.0 - 1e-12);
        if whole { valid_turned(body) } else { valid(body) }.map_err(NoBody::Flaw)
    }

    /// An operand with its faces moved outwards by a distance, but for those of some names.
    fn operand_moved<T: Real>(
        &self,
        k: usize,
        (planes, layout): (&Planes, &DimensionLayout<T>),
        plan: &FacetPlan,
        by: T,
        still: &BTreeSet<String>,
    ) -> Result<SketchSolid<T>, NoBody> {
        let FeatureOperand { object, prefix, .. } = &self.operands[k];
        let own = still.iter().filter_map(|n| n.strip_prefix(&**prefix)).map(str::to_owned);
        let mut body = moved_object(object, planes, layout, plan, by, &own.collect())?;
        body.prefix_names(prefix);
        Ok(body)
    }

    /// The body of this feature with its faces offset outwards by a distance, except for those of
    /// some names, as the same feature of operands with offset faces; subtracted operands are
    /// offset in the opposite direction. `None` if that is another body: faces of united bodies may
    /// end within the other one, and an inward offset would separate them there.
    fn moved<T: Real>(
        &self,
        layout: &DimensionLayout<T>,
        plan: &FacetPlan,
        by: T,
        still: &BTreeSet<String>,
    ) -> Option<Result<SketchSolid<T>, NoBody>> {
        let laid = self.laid(layout);
        let images = match self.images(layout, &laid, plan) {
            Ok(images) => images,
            Err(why) => return Some(Err(why)),
        };
        let part = |k: usize, by: T| {
            let (planes, own) = &laid[k];
            self.operand_moved(k, (planes, own), &plan.of_operand(&images), by, still)
        };
        let grows = by.re() > 0.0;
        match &self.kind {
            FeatureKind::Boolean(operation) => {
                let ways = match operation {
                    Operation::Cut if !grows => [by, -by],
                    Operation::Common if !grows => [by, by],
                    Operation::Union if grows => [by, by],
                    _ => return None,
                };
                let both = part(0, ways[0]).map(|a| (a, part(1, ways[1])));
                Some(both.and_then(|(a, b)| match b {
                    // Nothing was cut away.
                    Err(NoBody::Combine(CombineError::Empty)) if *operation == Operation::Cut => {
                        Ok(a)
                    }
                    b => combined([&a, &b?], *operation).map_err(NoBody::Combine),
                }))
            }
            FeatureKind::Place(_) | FeatureKind::OnFace { .. } => {
                let scale = images[0].columns[0].norm();
                Some(part(0, by / scale).map(|body| body.placed(&images[0])))
            }
            FeatureKind::Pattern { .. } if grows => {
                Some(part(0, by).and_then(|body| repeated(&body, &images)))
            }
            FeatureKind::Revolve { line, angle } => {
                let (planes, own) = &laid[0];
                let [Some(p), Some(q)] = line.map(|p| own.point(planes, p)) else { return None };
                let angle = number(layout, angle).ok()?;
                if angle.re().abs() < 360.0 * (1.0 - 1e-12) {
                    return None;
                }
                let object = &self.operands[0].object;
                let section = plan.of_operand(&images).made(object, planes, own).ok()?;
                let shift = |e: usize| {
                    let name = side_name(object, &section, e);
                    if name.is_some_and(|n| still.contains(&*n)) { T::zero() } else { by }
                };
                let section = moved_section(&section, [p, q], &shift)?;
                Some(self.turned(&section, [p, q], angle, plan.density()))
            }
            _ => None,
        }
    }
}

/// The body of an object with its faces moved outwards by a distance, but for those of some names.
fn moved_object<T: Real>(
    object: &Arc<SketchObject>,
    planes: &Planes,
    layout: &DimensionLayout<T>,
    plan: &FacetPlan,
    by: T,
    still: &BTreeSet<String>,
) -> Result<SketchSolid<T>, NoBody> {
    let body = plan.made(object, planes, layout)?;
    let stays = |f: usize| body.faces[f].names.iter().any(|n| still.contains(&**n));
    let first = match moved(&body, &|f| if stays(f) { T::zero() } else { by }) {
        Ok(body) => return Ok(body),
        Err(why) => why,
    };
    let parts = object.feature.as_ref().and_then(|f| f.moved(layout, plan, by, still));
    parts.unwrap_or(Err(first))
}

/// Copies of a body, united.
pub(super) fn repeated<T: Real>(
    body: &SketchSolid<T>,
    images: &[Similarity<T>],
) -> Result<SketchSolid<T>, NoBody> {
    let mut copies = vec![body.clone()];
    for (k, image) in images.iter().enumerate().skip(1) {
        let mut copy = body.placed(image);
        copy.prefix_names(&format!("COPY{}.", k + 1));
        copies.push(copy);
    }
    if copies.len() > 1 && lie_apart(&copies) {
        return Ok(side_by_side(copies));
    }
    let all: Vec<&SketchSolid<T>> = copies.iter().collect();
    united(&all).map_err(NoBody::Combine)
}

/// The value of a number of a feature.
pub(super) fn number<T: Real>(layout: &DimensionLayout<T>, e: &DimensionExpr) -> Result<T, NoBody> {
    let x = e.eval(&|n| layout.values.get(n).copied());
    x.map_err(|no| NoBody::NoValue(no.name))
}

/// Number of copies.
pub(super) fn copies<T: Real>(
    layout: &DimensionLayout<T>,
    count: &DimensionExpr,
) -> Result<usize, NoBody> {
    let n = number(layout, count)?.re();
    let whole = n.fract() == 0.0 && (1.0..=f64::from(MAX_COPIES)).contains(&n);
    if whole { Ok(n as usize) } else { Err(NoBody::Copies(n)) }
}

fn no_length() -> NoBody {
    let text = "an extrusion of length 0 has no volume";
    NoBody::Treatment(TreatmentFault::new(text, None, "give a length"))
}

/// The name of the face that an edge of a section becomes: its own, its curve's, or `L` and the number of its line.
fn side_name<T: Real>(
    object: &SketchObject,
    section: &SketchSolid<T>,
    edge: usize,
) -> Option<Arc<str>> {
    let edge = &section.edges[edge];
    if edge.name.is_some() {
        return edge.name.clone();
    }
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

    /// Adds a prefix to all names of faces.
    pub(super) fn prefix_names(&mut self, prefix: &str) {
        if !prefix.is_empty() {
            for name in self.faces.iter_mut().flat_map(|f| &mut f.names) {
                *name = format!("{prefix}{name}").into();
            }
        }
    }
}

impl Placement {
    pub(super) fn similarity<T: Real>(
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

/// True if a section is on one side of a line.
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

/// The folded names of numbers of other objects in the expressions of objects, by their addresses.
pub(crate) type ForeignNames = HashMap<*const SketchObject, Arc<BTreeSet<String>>>;

/// The folded names of numbers of other objects in its expressions.
pub fn foreign(object: &SketchObject) -> BTreeSet<String> {
    BTreeSet::clone(&foreign_known(object, &mut ForeignNames::new()))
}

/// As [`foreign`], with those of objects that stay where they are, as its operands do.
pub(crate) fn foreign_known(
    object: &SketchObject,
    known: &mut ForeignNames,
) -> Arc<BTreeSet<String>> {
    if let Some(found) = known.get(&std::ptr::from_ref(object)) {
        return Arc::clone(found);
    }
    let values = object.variables.values().map(|v| &v.value);
    let values = values.chain(object.dimensions.values().filter_map(|d| d.value.as_ref()));
    let sizes = object.curves.values().flat_map(|c| c.sizes());
    let feature = object.feature.iter();
    let kinds: Vec<DimensionExpr> = feature.clone().flat_map(|f| f.kind.numbers()).collect();
    let reference = object.reference.iter().flat_map(|r| &r.at);
    let other = |n: &&str| n.contains('.') && !object.has_name(n);
    let all = values.chain(sizes).chain(reference).chain(&kinds);
    let mut names: BTreeSet<String> =
        all.flat_map(DimensionExpr::names).filter(other).map(str::to_owned).collect();
    // References of its operands are references of the feature, and so are the numbers of those that it follows.
    for operand in feature.flat_map(|f| &f.operands) {
        let inner = foreign_known(&operand.object, known);
        names.extend(inner.iter().filter(|n| other(&n.as_str())).cloned());
        if operand.follows {
            let path = operand.path();
            let own = operand.object.own_numbers();
            let own = own.map(|n| format!("{path}{}", n.0.to_ascii_lowercase()));
            names.extend(own.filter(|n| other(&n.as_str())));
        }
    }
    let names = Arc::new(names);
    known.insert(std::ptr::from_ref(object), Arc::clone(&names));
    names
}

impl SketchObject {
    /// The same object of the present states of those that it follows, by their folded names; `None` if they are as
    /// they were.
    pub(crate) fn refreshed(
        &self,
        live: &dyn Fn(&str) -> Option<Arc<SketchObject>>,
    ) -> Option<Arc<SketchObject>> {
        let old = self.feature.as_ref()?;
        let new = old.refreshed(live)?;
        let before = Feature::clone(old).object(&self.name);
        let made = new.object(&self.name);
        let mut out = self.clone();
        for (key, variable) in &made.variables {
            let known = before.variables.get(key);
            // Numbers of its own, and changed copies, stay.
            if out.variables.get(key) == known && known != Some(variable) {
                out.variables.insert(key.clone(), variable.clone());
            }
        }
        let gone = |key: &String, v: &Variable| {
            !made.variables.contains_key(key) && before.variables.get(key) == Some(v)
        };
        out.variables.retain(|key, v| !gone(key, v));
        if out.units == before.units {
            out.units = made.units;
        }
        out.feature = made.feature;
        Some(Arc::new(out))
    }
}
