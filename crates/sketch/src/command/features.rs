//! UNION, CUT, COMMON, REVOLVE, PATTERN and placements: objects made of others.

use super::CommandError;
use super::args::Args;
use super::no_body::no_body;
use super::session::{CommandReply, SketchSession};
use super::subject::ReplySubject;
use crate::SketchObject;
use crate::dimension::expr::DimensionExpr;
use crate::feature::{Feature, FeatureKind, FeatureOperand, Placement};
use crate::identifier::identifier;
use crate::solid::combine::CombineError;
use crate::solid::feature::NoBody;
use crate::solid::operation::Operation;
use moldloft_syntax::number::plain;
use std::sync::Arc;

/// A name that an object may have.
pub(super) fn new_name(name: String, args: &Args) -> Result<String, CommandError> {
    match name.chars().count() {
        1..=32 => Ok(name),
        _ => Err(args.wants("a name of 1 to 32 characters")),
    }
}

impl SketchSession {
    /// Combines two bodies. The result is made of both and computed again with every change of theirs.
    pub(super) fn combine(&mut self, args: &mut Args, verb: &str) -> Result<(), CommandError> {
        let operation = match verb {
            "UNION" => Operation::Union,
            "CUT" => Operation::Cut,
            _ => Operation::Common,
        };
        let names =
            [args.name("the name of an object")?, args.name("the name of a second object")?];
        let target = self.target(args, &names[0])?;
        args.end()?;
        let mut parts: Vec<Arc<SketchObject>> = Vec::new();
        for name in &names {
            let object = self.operand(name)?;
            if object.drawing.section.is_some() {
                return Err(CommandError::new(
                    114,
                    format!("{} is a cross section; only solids are combined", object.name),
                    "EXTRUDE it first",
                )
                .about(ReplySubject::of("cross-section").names([&object.name])));
            }
            self.require_body(&object)?;
            parts.push(object);
        }
        if parts[0].name.eq_ignore_ascii_case(&parts[1].name) {
            return Err(CommandError::text(
                format!("{verb} wants two objects, not {} twice", parts[0].name),
                "COPY makes another",
            )
            .about(ReplySubject::of("object-twice").names([&parts[0].name])));
        }
        let followed = |o: &Arc<SketchObject>| (Arc::clone(o), self.follows(&o.name, &target));
        let operands = Feature::operands(parts.iter().map(followed).collect());
        let feature = Feature { kind: FeatureKind::Boolean(operation), operands };
        self.make(feature, &target, |why| match why {
            NoBody::Combine(CombineError::Empty) => Some(
                CommandError::new(
                    701,
                    format!("{verb} of {} and {} leaves nothing", parts[0].name, parts[1].name),
                    "MOVE one of them, or CHECK the dimensions",
                )
                .about(ReplySubject::of("nothing-left").names([&parts[0].name, &parts[1].name])),
            ),
            _ => None,
        })
    }

    /// `INTO name`, or the name itself.
    pub(super) fn target(&self, args: &mut Args, default: &str) -> Result<String, CommandError> {
        let target = if args.take_short("INTO") {
            args.name("a name")?
        } else {
            self.operand(default)?.name.clone()
        };
        new_name(target, args)
    }

    /// Refuses an object without a body, with the reason.
    pub(super) fn require_body(&mut self, object: &Arc<SketchObject>) -> Result<(), CommandError> {
        if object.feature.is_none() {
            self.placed(object)?;
            if object.faces.is_empty() {
                return Err(CommandError::new(
                    701,
                    format!("{} has no faces yet", object.name),
                    format!("GENERATE FACES {}", object.name),
                )
                .about(ReplySubject::of("no-faces").names([&object.name])));
            }
        }
        match self.worked(object).body() {
            Ok(_) => Ok(()),
            Err(why) => Err(no_body(object, why)),
        }
    }

    /// Replaces `target` by an object of a feature.
    pub(super) fn make(
        &mut self,
        feature: Feature,
        target: &str,
        refused: impl Fn(&NoBody) -> Option<CommandError>,
    ) -> Result<(), CommandError> {
        self.make_with(feature, Vec::new(), target, refused)
    }

    /// Replaces `target` by an object of a feature with numbers of its own.
    pub(super) fn make_with(
        &mut self,
        feature: Feature,
        own: Vec<crate::Variable>,
        target: &str,
        refused: impl Fn(&NoBody) -> Option<CommandError>,
    ) -> Result<(), CommandError> {
        let mut feature = feature;
        for operand in &mut feature.operands {
            operand.follows = self.follows(&operand.object.name, target);
            let name = operand.object.name.to_lowercase();
            let called = identifier(&name).to_ascii_lowercase();
            let namesake = self.state.called(&called).filter(|o| o.name.to_lowercase() != name);
            if let Some(other) = namesake.filter(|_| operand.follows) {
                return Err(CommandError::text(
                    format!(
                        "{} and {} are one name in expressions",
                        other.name, operand.object.name
                    ),
                    "RENAME one of them",
                )
                .about(ReplySubject::of("name-not-free").names([&other.name])));
            }
        }
        let mut made = feature.object(target);
        self.no_circle(&made)?;
        let twice = made.followed_numbers().into_iter().find(|n| made.has_number(&n.0));
        if let Some((name, ..)) = twice {
            return Err(CommandError::text(
                format!("{name} is a number of two objects of {target}"),
                "RENAME the one that is followed",
            )
            .about(ReplySubject::of("name-not-free").names([&name])));
        }
        made.variables.extend(own.into_iter().map(|v| (v.name.to_ascii_lowercase(), v)));
        let made = Arc::new(made);
        let worked = self.worked(&made);
        let solid = match worked.body() {
            Ok(solid) => solid,
            Err(why) => return Err(refused(why).unwrap_or_else(|| no_body(&made, why))),
        };
        let mass = solid.mass();
        let measure = match solid.flat {
            true => format!("area {}", plain(mass.area)),
            false => format!("volume {}", plain(mass.volume)),
        };
        let text = format!(
            "{target}: {} vertices, {} edges, {} faces, {measure}",
            solid.vertices.len(),
            solid.edges.len(),
            solid.faces.len(),
        );
        self.out.push(CommandReply::note(text));
        let key = made.name.to_lowercase();
        self.state.objects.insert(key.clone(), made);
        self.state.active = Some(key);
        Ok(())
    }

    /// `REVOLVE [name] line [angle] [INTO name]`.
    pub(super) fn revolve(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let named = match args.at_number() {
            true => None,
            false => Some(args.name("the name of a cross section")?),
        };
        let line = args.line()?;
        let object = match named {
            Some(name) => self.operand(&name)?,
            None => self.active_arc()?,
        };
        let angle = if args.len() > 0 && !args.tokens_at(0, "INTO") {
            args.value(None)?
        } else {
            DimensionExpr::number(360.0)
        };
        let target = self.target(args, &object.name)?;
        args.end()?;
        if object.feature.is_some() && object.drawing.section.is_some() {
            return Err(CommandError::text(
                format!("{} has no lines to turn about", object.name),
                "REVOLVE a drawn section, or EXTRUDE this one",
            )
            .about(ReplySubject::of("no-cross-section").names([&object.name])));
        }
        let line = super::draw::require_line(&object, line)?;
        self.section_axis(&object)?;
        if angle.literal().is_some_and(|a| a == 0.0 || !a.is_finite()) {
            return Err(CommandError::new(
                300,
                "a turn by nothing has no volume",
                "give an angle in degrees",
            ));
        }
        let object = self.section_with_faces(object)?;
        // Its numbers keep their names.
        let operands = vec![FeatureOperand::part(Arc::clone(&object))];
        let kind = FeatureKind::Revolve { line: [line.p, line.q], angle };
        self.make(Feature { kind, operands }, &target, |why| match why {
            NoBody::Axis => Some(CommandError::new(
                701,
                "the section lies on both sides of the line, or the line has no length",
                "revolve about a line on its border or beside it",
            )),
            _ => None,
        })?;
        self.onto_face(&object, &target)
    }

    /// `PATTERN name LINEAR n dx dy dz | POLAR n axis angle [THROUGH x y z] | MIRROR axis [at]
    /// [INTO name]`.
    pub(super) fn pattern(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let name = args.name("the name of an object")?;
        let object = self.operand(&name)?;
        let units = object.units.clone();
        let (step, count) = if args.take("LINEAR") {
            let count = args.value(None)?;
            let by = [args.value(units.as_deref())?, args.value(units.as_deref())?];
            let [x, y] = by;
            (Placement::Move([x, y, args.value(units.as_deref())?]), count)
        } else if args.take("POLAR") {
            let count = args.value(None)?;
            let axis = args.axis().ok_or_else(|| args.wants("an axis"))?;
            let angle = args.value(None)?;
            (
                Placement::Rotate { axis, through: self.through(args, units.as_deref())?, angle },
                count,
            )
        } else if args.take("MIRROR") {
            let axis = args.axis().ok_or_else(|| args.wants("an axis"))?;
            let given = args.len() > 0 && !args.tokens_at(0, "INTO");
            let at = if given { args.value(units.as_deref())? } else { DimensionExpr::number(0.0) };
            (Placement::Mirror { axis, at }, DimensionExpr::number(2.0))
        } else {
            return Err(args.wants("LINEAR, POLAR or MIRROR"));
        };
        let target = self.target(args, &name)?;
        args.end()?;
        self.require_body(&object)?;
        let operands = vec![FeatureOperand::part(object)];
        self.make(Feature { kind: FeatureKind::Pattern { step, count }, operands }, &target, |_| {
            None
        })
    }

    /// `THROUGH x y z`, the origin when it is not there.
    fn through(
        &self,
        args: &mut Args,
        units: Option<&str>,
    ) -> Result<[DimensionExpr; 3], CommandError> {
        if !args.take("THROUGH") {
            return Ok([0.0; 3].map(DimensionExpr::number));
        }
        Ok([args.value(units)?, args.value(units)?, args.value(units)?])
    }

    /// MOVE, ROTATE, MIRROR, SCALE of objects without a drawing, or by any angle.
    pub(super) fn place(&mut self, args: &mut Args, verb: &str) -> Result<(), CommandError> {
        let name = args.name("the name of an object")?;
        let object = self.operand(&name)?;
        let units = object.units.clone();
        if verb == "MOVE" && args.take_short("ON") {
            return self.place_on(object, args);
        }
        let place = match verb {
            "MOVE" => Placement::Move([
                args.value(units.as_deref())?,
                args.value(units.as_deref())?,
                args.value(units.as_deref())?,
            ]),
            "SCALE" => {
                let factor = args.value(None)?;
                if factor.literal().is_some_and(|f| !(f > 0.0 && f < 1e9)) {
                    return Err(CommandError::text(
                        format!("the factor {factor} is not positive"),
                        "MIRROR turns objects over",
                    ));
                }
                Placement::Scale(factor)
            }
            _ => {
                let axis = args.axis().ok_or_else(|| args.wants("an axis"))?;
                if verb == "MIRROR" {
                    let given = args.len() > 0 && !args.at("FEATURE") && !args.tokens_at(0, "INTO");
                    let at = if given {
                        args.value(units.as_deref())?
                    } else {
                        DimensionExpr::number(0.0)
                    };
                    Placement::Mirror { axis, at }
                } else {
                    let angle = args.value(None)?;
                    let through = self.through(args, units.as_deref())?;
                    Placement::Rotate { axis, through, angle }
                }
            }
        };
        args.take("FEATURE");
        let target = self.target(args, &name)?;
        args.end()?;
        if object.drawing.section.is_some() {
            return Err(CommandError::new(
                114,
                format!("{} is a cross section; this placement is only for solids", object.name),
                "EXTRUDE it first, or turn it by 90, 180 or 270",
            )
            .about(ReplySubject::of("cross-section").names([&object.name])));
        }
        self.require_body(&object)?;
        let operands = vec![FeatureOperand::part(object)];
        self.make(Feature { kind: FeatureKind::Place(place), operands }, &target, |_| None)
    }
}
