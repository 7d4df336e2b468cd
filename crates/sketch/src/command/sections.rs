//! OFFSET, SWEEP, LOFT, and EXTRUDE of sections that are kept: features of cross sections.

use super::CommandError;
use super::args::Args;
use super::session::SketchSession;
use super::subject::ReplySubject;
use super::treatments::OwnNumbers;
use crate::dimension::expr::DimensionExpr;
use crate::feature::{Feature, FeatureKind, FeatureOperand, OffsetCorner};
use crate::identifier::identifier;
use crate::{CoordinateAxis, SketchObject};
use std::sync::Arc;

impl SketchSession {
    /// The axis across a section.
    pub(super) fn section_axis(
        &self,
        object: &SketchObject,
    ) -> Result<CoordinateAxis, CommandError> {
        object.drawing.section.ok_or_else(|| {
            CommandError::new(
                113,
                format!("{} is not a cross section", object.name),
                "SKETCH name 2D starts one",
            )
            .about(ReplySubject::of("no-cross-section").names([&object.name]))
        })
    }

    /// A section with its faces, found if it has none, and a body.
    pub(super) fn section_with_faces(
        &mut self,
        object: Arc<SketchObject>,
    ) -> Result<Arc<SketchObject>, CommandError> {
        self.section_axis(&object)?;
        let mut object = object;
        if object.feature.is_none() {
            self.placed(&object)?;
            if object.faces.is_empty() {
                self.state.active = Some(object.name.to_lowercase());
                self.generate(&mut Args::new(&[super::solids::faces_word()], ""))?;
                object = self.active_arc()?;
            }
        }
        self.require_body(&object)?;
        Ok(object)
    }

    /// `OFFSET section distance [ROUND|MITRED] [INTO c]`.
    pub(super) fn offset(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let name = args.name("the name of a cross section")?;
        let object = self.operand(&name)?;
        self.section_axis(&object)?;
        let distance = args.value(object.units.as_deref())?;
        let corner = match args.take("MITRED") {
            true => OffsetCorner::Mitred,
            false => OffsetCorner::Round,
        };
        if corner == OffsetCorner::Round {
            args.take("ROUND");
        }
        let target = self.target(args, &object.name)?;
        args.end()?;
        let object = self.section_with_faces(object)?;
        let mut own = OwnNumbers::of(&object);
        let distance = own.add("OFFSET", distance)?;
        let operands = vec![FeatureOperand::part(object)];
        let kind = FeatureKind::Offset { distance, corner };
        self.make_with(Feature { kind, operands }, own.made, &target, |_| None)
    }

    /// `SWEEP section ALONG path [INTO c]`.
    pub(super) fn sweep_section(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let name = args.name("the name of a cross section")?;
        let object = self.operand(&name)?;
        self.section_axis(&object)?;
        self.not_on_face(&object, "SWEEP")?;
        if !args.take("ALONG") {
            return Err(args.wants("ALONG and the name of a path"));
        }
        let path = args.name("the name of a path")?;
        let path = self.operand(&path)?;
        let target = self.target(args, &object.name)?;
        args.end()?;
        if path.feature.is_some() && path.drawing.section.is_none() {
            return Err(CommandError::text(
                format!("{} is a solid, and no path", path.name),
                "SKETCH draws a chain of lines",
            )
            .about(ReplySubject::of("no-path").names([&path.name])));
        }
        let same = [&object.name, &target].into_iter().any(|n| path.name.eq_ignore_ascii_case(n));
        if same {
            return Err(CommandError::text(
                format!("{} cannot be moved along itself", path.name),
                "give the section and the result other names than the path",
            )
            .about(ReplySubject::of("object-twice").names([&path.name])));
        }
        if path.feature.is_none() {
            self.placed(&path)?;
        }
        let object = self.section_with_faces(object)?;
        let prefix = format!("{}.", identifier(&path.name));
        let path = FeatureOperand { object: path, prefix, follows: true };
        let operands = vec![FeatureOperand::part(object), path];
        self.make_with(Feature { kind: FeatureKind::Sweep, operands }, Vec::new(), &target, |_| {
            None
        })
    }

    /// `LOFT a b … [INTO c]`.
    pub(super) fn loft(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let mut sections: Vec<Arc<SketchObject>> = Vec::new();
        while sections.len() < 2 || (args.len() > 0 && !args.tokens_at(0, "INTO")) {
            let name = args.name("the name of a cross section")?;
            let object = self.operand(&name)?;
            self.section_axis(&object)?;
            self.not_on_face(&object, "LOFT")?;
            if sections.iter().any(|s| s.name.eq_ignore_ascii_case(&object.name)) {
                return Err(CommandError::text(
                    format!("LOFT wants different sections, not {} twice", object.name),
                    "COPY makes another",
                )
                .about(ReplySubject::of("object-twice").names([&object.name])));
            }
            sections.push(object);
        }
        let target = self.target(args, &sections[0].name)?;
        args.end()?;
        let mut operands = Vec::new();
        for section in sections {
            let section = self.section_with_faces(section)?;
            let follows = self.follows(&section.name, &target);
            operands.push((section, follows));
        }
        let operands = Feature::operands(operands);
        self.make_with(Feature { kind: FeatureKind::Loft, operands }, Vec::new(), &target, |_| None)
    }

    /// An extrusion that follows its section.
    pub(super) fn extrude_section(
        &mut self,
        object: Arc<SketchObject>,
        distance: DimensionExpr,
        target: &str,
    ) -> Result<(), CommandError> {
        let object = self.section_with_faces(object)?;
        let mut own = OwnNumbers::of(&object);
        let distance = own.add("EXTRUDE", distance)?;
        let operands = vec![FeatureOperand::part(Arc::clone(&object))];
        let kind = FeatureKind::Extrude(distance);
        self.make_with(Feature { kind, operands }, own.made, target, |_| None)?;
        self.onto_face(&object, target)
    }
}
