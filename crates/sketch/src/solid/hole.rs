//! Drilled holes: through or blind, with a counterbore or a countersink, one or in patterns.

use super::SketchSolid;
use super::combine::combined;
use super::drill::{DrillProfile, DrillRing, rotational};
use super::edges::{FaceForm, TreatmentFault};
use super::feature::{NoBody, copies, number, repeated};
use super::operation::Operation;
use super::outline::FacetDensity;
use super::pierced::pierced;
use super::place::Similarity;
use super::validity::valid;
use crate::feature::{FaceChoice, Hole, HoleHead};
use crate::{DimensionExpr, DimensionLayout};
use moldloft_num::{Box3, Real, Vec3};

/// Maximum volume removed, relative to the body's, at which a hole is beside the body.
const NOTHING_REMOVED: f64 = 1e-12;

impl<T: Real> DrillProfile<T> {
    fn solid(&self, density: FacetDensity) -> Result<SketchSolid<T>, NoBody> {
        let mut drill = rotational(self.axis.index(), self.centre, &self.rings);
        drill.density = density;
        valid(drill).map_err(NoBody::Flaw)
    }
}

impl Hole {
    /// The positions of the holes relative to the first one.
    pub(super) fn images<T: Real>(
        &self,
        layout: &DimensionLayout<T>,
    ) -> Result<Vec<Similarity<T>>, NoBody> {
        let mut images = vec![Similarity::identity()];
        for (step, count) in &self.copies {
            let step = step.similarity(&|e| number(layout, e))?;
            let row = images.clone();
            let mut last = row.clone();
            for _ in 1..copies(layout, count)? {
                last = last.iter().map(|image| image.then(&step)).collect();
                images.extend(last.iter().cloned());
            }
        }
        Ok(images)
    }

    /// The drill in its first position, as long as the body needs.
    pub(super) fn drill<T: Real>(
        &self,
        body: &SketchSolid<T>,
        layout: &DimensionLayout<T>,
        density: FacetDensity,
    ) -> Result<SketchSolid<T>, NoBody> {
        self.profile(body, layout)?.solid(density)
    }

    fn profile<T: Real>(
        &self,
        body: &SketchSolid<T>,
        layout: &DimensionLayout<T>,
    ) -> Result<DrillProfile<T>, NoBody> {
        let size = |e: &DimensionExpr, what: &str| -> Result<T, NoBody> {
            let x = number(layout, e)?;
            match x.re() > 0.0 && x.re().is_finite() {
                true => Ok(x),
                false => {
                    Err(fault(format!("the {what} of a hole is {}", x.re()), "give more than 0"))
                }
            }
        };
        let k = self.axis.index();
        let bounds = Box3::around(body.vertices.iter().map(|v| v.at.re()));
        let (low, high) = (bounds.low[k], bounds.high[k]);
        // Bulges beyond the vertices are smaller than the diagonal.
        let over = bounds.diagonal();
        let radius = size(&self.diameter, "diameter")? * 0.5;
        // From the side that is drilled from, down into the body.
        let inwards = if self.top { -1.0 } else { 1.0 };
        let outside = T::from(if self.top { high + over } else { low - over });
        let entry = || -> Result<T, NoBody> {
            let side = FaceChoice::Extreme { axis: self.axis, top: self.top };
            let faces = body.chosen_faces(&side).map_err(NoBody::Treatment)?;
            match body.form(faces[0]) {
                FaceForm::Plane { at, .. } => Ok(at[k]),
                _ => Err(fault(format!("there is no face {side}"), "drill from another side")),
            }
        };
        let mut rings = Vec::new();
        let mut ring = |radius: T, level: T, above| rings.push(DrillRing { radius, level, above });
        let end = match &self.depth {
            Some(depth) => entry()? + size(depth, "depth")? * inwards,
            None => T::from(if self.top { low - over } else { high + over }),
        };
        ring(radius, end, "WALL");
        match &self.head {
            None => ring(radius, outside, "WALL"),
            Some(HoleHead::Counterbore { diameter, depth }) => {
                let wide = size(diameter, "counterbore's diameter")? * 0.5;
                let seat = entry()? + size(depth, "counterbore's depth")? * inwards;
                self.widens(radius, wide)?;
                ring(radius, seat, "SEAT");
                ring(wide, seat, "HEAD");
                ring(wide, outside, "HEAD");
            }
            Some(HoleHead::Countersink { diameter, angle }) => {
                let wide = size(diameter, "countersink's diameter")? * 0.5;
                let half = size(angle, "countersink's angle")? * (std::f64::consts::PI / 360.0);
                if half.re() >= std::f64::consts::FRAC_PI_2 {
                    return Err(fault(
                        "a countersink's angle is below 180 degrees",
                        "give 90, say",
                    ));
                }
                self.widens(radius, wide)?;
                let surface = entry()?;
                ring(radius, surface + (wide - radius) / half.tan() * inwards, "HEAD");
                ring(wide, surface, "HEAD");
                ring(wide, outside, "HEAD");
            }
        }
        let deeper = |pair: &[DrillRing<T>]| (pair[1].level - pair[0].level).re() * -inwards >= 0.0;
        if !rings.windows(2).all(deeper) {
            return Err(fault("the head of a hole is deeper than the hole", "give it less depth"));
        }
        if !self.top {
            // From the lower ring to the upper one, each with the face above it.
            rings.reverse();
            for j in 1..rings.len() {
                rings[j - 1].above = rings[j].above;
            }
        }
        let [x, y] = self.at.each_ref().map(|e| number(layout, e));
        let mut centre = [T::zero(); 3];
        let [a, b] = self.axis.others();
        (centre[a.index()], centre[b.index()]) = (x?, y?);
        Ok(DrillProfile { axis: self.axis, centre: Vec3::from(centre), rings })
    }

    fn widens<T: Real>(&self, radius: T, wide: T) -> Result<(), NoBody> {
        match wide.re() > radius.re() {
            true => Ok(()),
            false => Err(fault("the head of a hole is no wider than the hole", "give it more")),
        }
    }

    /// The body with the holes.
    pub(super) fn drilled<T: Real>(
        &self,
        body: &SketchSolid<T>,
        layout: &DimensionLayout<T>,
        density: FacetDensity,
    ) -> Result<SketchSolid<T>, NoBody> {
        let (drill, images) = (self.profile(body, layout)?, self.images(layout)?);
        if let Some(mut made) = pierced(body, &drill, &images) {
            made.density = density;
            return valid(made).map_err(NoBody::Flaw);
        }
        let drills = repeated(&drill.solid(density)?, &images)?;
        let made = combined([body, &drills], Operation::Cut).map_err(NoBody::Combine)?;
        let [before, after] = [body, &made].map(|solid| solid.mass().volume.re());
        if before - after <= NOTHING_REMOVED * before {
            return Err(fault("the hole is beside the body", "give its centre AT two coordinates"));
        }
        Ok(made)
    }
}

fn fault(text: impl Into<String>, next: &'static str) -> NoBody {
    NoBody::Treatment(TreatmentFault::new(text, None, next))
}
