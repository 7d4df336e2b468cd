//! Plane faces of bodies: sections that are drawn on them, bodies that are placed on them.

use super::CommandError;
use super::args::Args;
use super::no_body::no_body;
use super::session::{CommandReply, SketchSession};
use super::subject::ReplySubject;
use super::treatments::face_choice;
use crate::feature::{FaceChoice, Feature, FeatureKind, FeatureOperand, SectionPlace};
use crate::format::script::face_text;
use crate::identifier::identifier;
use crate::solid::face_place::FacePlane;
use crate::solid::feature::NoBody;
use crate::solid::place::Similarity;
use crate::{CoordinateAxis, SketchObject, SketchSolid};
use std::sync::Arc;

/// The place of a section that is drawn on a face.
#[derive(Clone, Debug)]
pub struct SectionFrame {
    /// The body and its face.
    pub on: SectionPlace,
    /// From the coordinates of the section to those of the body.
    pub place: Similarity<f64>,
    /// 1 if an extrusion by a positive length is outside the body, -1 if inside.
    pub outward: f64,
    /// The body.
    pub body: SketchSolid<f64>,
    /// The faces.
    pub faces: Vec<usize>,
}

impl SketchSession {
    /// `ON body face`, of a section; without a plane it is drawn in the nearest one.
    pub(super) fn section_on(
        &mut self,
        args: &mut Args,
        section: Option<CoordinateAxis>,
    ) -> Result<(SectionPlace, CoordinateAxis), CommandError> {
        let body = args.name("the name of a body")?;
        let on = SectionPlace { body, face: face_choice(args)? };
        args.end()?;
        let plane = self.face_plane(&on);
        match (section, plane) {
            (Some(axis), Ok(_)) => Ok((on, axis)),
            (None, Ok((_, plane))) => Ok((on, plane.nearest_axis())),
            // The face may come back with another dimension.
            (Some(axis), Err(fault)) => {
                self.out.push(CommandReply::warning_of(fault));
                Ok((on, axis))
            }
            (None, Err(fault)) => Err(fault),
        }
    }

    fn face_plane(
        &mut self,
        on: &SectionPlace,
    ) -> Result<(SketchSolid<f64>, FacePlane<f64>), CommandError> {
        let base = self.operand(&on.body)?;
        let worked = self.worked(&base);
        let body = worked.body().map_err(|why| no_body(&base, why))?;
        let plane =
            FacePlane::of(body, &on.face).map_err(|why| no_body(&base, &NoBody::Treatment(why)))?;
        Ok((body.clone(), plane))
    }

    /// Moves the body that was made of a section to the face on which the section is drawn.
    pub(super) fn onto_face(
        &mut self,
        section: &SketchObject,
        target: &str,
    ) -> Result<(), CommandError> {
        // The text of a feature has the move itself.
        let Some(on) = section.on.clone().filter(|_| self.state.outside.is_empty()) else {
            return Ok(());
        };
        let made = self.operand(target)?;
        let base = self.operand(&on.body)?;
        self.out.pop();
        self.placed_on(made, base, on.face, section.drawing.section, target)
    }

    /// Refuses a section on a face for a command that has no place for it.
    pub(super) fn not_on_face(
        &self,
        section: &SketchObject,
        verb: &str,
    ) -> Result<(), CommandError> {
        let Some(on) = section.on.as_ref().filter(|_| self.state.outside.is_empty()) else {
            return Ok(());
        };
        Err(CommandError::text(
            format!(
                "{} is drawn on a face of {}; {verb} has no place on a face",
                section.name, on.body
            ),
            format!("EXTRUDE or REVOLVE it, or SKETCH a section without ON {}", on.body),
        )
        .about(ReplySubject::of("cross-section").names([&section.name])))
    }

    /// `MOVE a ON b face [ALONG axis] [INTO c]`.
    pub(super) fn place_on(
        &mut self,
        object: Arc<SketchObject>,
        args: &mut Args,
    ) -> Result<(), CommandError> {
        let base = args.name("the name of a body")?;
        let base = self.operand(&base)?;
        let face = face_choice(args)?;
        let along = match args.take("ALONG") {
            true => Some(args.axis().ok_or_else(|| args.wants("an axis"))?),
            false => None,
        };
        let target = self.target(args, &object.name)?;
        args.end()?;
        self.placed_on(object, base, face, along, &target)
    }

    fn placed_on(
        &mut self,
        object: Arc<SketchObject>,
        base: Arc<SketchObject>,
        face: FaceChoice,
        along: Option<CoordinateAxis>,
        target: &str,
    ) -> Result<(), CommandError> {
        for part in [&object, &base] {
            if part.drawing.section.is_some() {
                return Err(CommandError::new(
                    114,
                    format!("{} is a cross section; only solids are placed on faces", part.name),
                    "EXTRUDE it first",
                )
                .about(ReplySubject::of("cross-section").names([&part.name])));
            }
            self.require_body(part)?;
        }
        if base.name.eq_ignore_ascii_case(&object.name) || base.name.eq_ignore_ascii_case(target) {
            return Err(CommandError::text(
                format!("{} cannot be placed on itself", base.name),
                "COPY makes another",
            )
            .about(ReplySubject::of("object-twice").names([&base.name])));
        }
        let prefix = format!("{}.", identifier(&base.name));
        let base = FeatureOperand { object: base, prefix, follows: true };
        let operands = vec![FeatureOperand::part(object), base];
        let kind = FeatureKind::OnFace { face, along };
        self.make(Feature { kind, operands }, target, |_| None)
    }

    /// The place of a section on a face; `None` for others, and while there is no such face.
    pub fn section_frame(&mut self, name: &str) -> Option<SectionFrame> {
        let section = self.object(name)?;
        let (on, axis) = (section.on.clone()?, section.drawing.section?);
        let (body, plane) = self.face_plane(&on).ok()?;
        let place = plane.place(&on.face, Some(axis)).ok()?;
        let faces = body.chosen_faces(&on.face).ok()?;
        Some(SectionFrame { on, place, outward: plane.outward(axis), body, faces })
    }
}

/// For each face of a body on which a section can be drawn: the face as commands name it, and the axis across the
/// plane in which the section is drawn.
pub fn drawable_faces(body: &SketchSolid<f64>) -> Vec<Option<(String, CoordinateAxis)>> {
    let choice = |f: usize| {
        body.faces[f].names.iter().find_map(|name| {
            let face = FaceChoice::Named(name.to_string());
            let plane = FacePlane::of(body, &face).ok()?;
            Some((face_text(&face), plane.nearest_axis()))
        })
    };
    match body.flat {
        true => vec![None; body.faces.len()],
        false => (0..body.faces.len()).map(choice).collect(),
    }
}
