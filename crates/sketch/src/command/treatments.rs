//! CHAMFER, FILLET, SHELL, DRAFT: features that treat edges and faces of a body.

use super::CommandError;
use super::args::Args;
use super::session::SketchSession;
use super::subject::ReplySubject;
use super::words::CommandTokenKind;
use crate::dimension::expr::DimensionExpr;
use crate::feature::{
    EdgeBlend, EdgeChoice, FaceChoice, Feature, FeatureKind, FeatureOperand, Hole, HoleHead,
    Placement,
};
use crate::{CoordinateAxis, SketchObject, Variable};
use std::sync::Arc;

/// Numbers of a feature itself: each becomes a variable, so that SET changes it.
pub(super) struct OwnNumbers {
    probe: SketchObject,
    pub made: Vec<Variable>,
}

impl OwnNumbers {
    pub fn of(object: &Arc<SketchObject>) -> Self {
        // The names that the feature takes over.
        let nothing = [0.0; 3].map(DimensionExpr::number);
        let feature = Feature {
            kind: FeatureKind::Place(Placement::Move(nothing)),
            operands: operand(object),
        };
        OwnNumbers::new(feature.object(&object.name))
    }

    /// Numbers beside those of an object.
    pub fn new(probe: SketchObject) -> Self {
        OwnNumbers { probe, made: Vec::new() }
    }

    pub fn add(&mut self, stem: &str, value: DimensionExpr) -> Result<DimensionExpr, CommandError> {
        let name = self.probe.fresh_name(stem);
        let variable = Variable { name: name.clone(), value, range: None };
        self.probe.variables.insert(name.to_ascii_lowercase(), variable.clone());
        self.made.push(variable);
        DimensionExpr::parse(&name).map_err(|why| CommandError::text(why.to_string(), "RENAME"))
    }
}

fn operand(object: &Arc<SketchObject>) -> Vec<FeatureOperand> {
    vec![FeatureOperand::part(Arc::clone(object))]
}

impl SketchSession {
    /// The object of a treatment, with a body.
    fn treated(&mut self, args: &mut Args) -> Result<Arc<SketchObject>, CommandError> {
        let name = args.name("the name of an object")?;
        let object = self.operand(&name)?;
        if object.drawing.section.is_some() {
            return Err(CommandError::new(
                114,
                format!(
                    "{} is a cross section; only solids have such edges and faces",
                    object.name
                ),
                "EXTRUDE or REVOLVE it first; ARC rounds a corner of a section",
            )
            .about(ReplySubject::of("cross-section").names([&object.name])));
        }
        self.require_body(&object)?;
        Ok(object)
    }

    /// `CHAMFER a d [d2] EDGES … [INTO c]`, `FILLET a radius EDGES … [INTO c]`.
    pub(super) fn blend(&mut self, args: &mut Args, verb: &str) -> Result<(), CommandError> {
        let object = self.treated(args)?;
        let units = object.units.as_deref();
        let mut own = OwnNumbers::of(&object);
        let first = args.value(units)?;
        let blend = if verb == "FILLET" {
            EdgeBlend::Fillet(own.add("FILLET", first)?)
        } else if args.at("EDGES") {
            let size = own.add("CHAMFER", first)?;
            EdgeBlend::Chamfer([size.clone(), size])
        } else {
            let second = args.value(units)?;
            EdgeBlend::Chamfer([own.add("CHAMFER", first)?, own.add("CHAMFER", second)?])
        };
        if !args.take("EDGES") {
            return Err(args.wants("EDGES"));
        }
        let mut edges = Vec::new();
        while let Some(choice) = edge_choice(args)? {
            edges.push(choice);
        }
        if edges.is_empty() {
            return Err(args.wants("ALL, ALONG axis, OF face, BETWEEN face face or LINE n"));
        }
        let target = self.target(args, &object.name)?;
        args.end()?;
        let feature =
            Feature { kind: FeatureKind::Blend { blend, edges }, operands: operand(&object) };
        self.make_with(feature, own.made, &target, |_| None)
    }

    /// `SHELL a thickness [OPEN face …] [INTO c]`.
    pub(super) fn shell(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let object = self.treated(args)?;
        let mut own = OwnNumbers::of(&object);
        let thickness = args.value(object.units.as_deref())?;
        let thickness = own.add("SHELL", thickness)?;
        let open = if args.take("OPEN") { face_choices(args)? } else { Vec::new() };
        let target = self.target(args, &object.name)?;
        args.end()?;
        let kind = FeatureKind::Shell { thickness, open };
        self.make_with(Feature { kind, operands: operand(&object) }, own.made, &target, |_| None)
    }

    /// `HOLE a diameter AT p q …`.
    pub(super) fn hole(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let object = self.treated(args)?;
        let units = object.units.as_deref();
        let mut own = OwnNumbers::of(&object);
        let diameter = args.value(units)?;
        let diameter = own.add("HOLE", diameter)?;
        if !args.take_short("AT") {
            return Err(args.wants("AT and two coordinates"));
        }
        let at = [args.value(units)?, args.value(units)?];
        let [p, q] = at;
        let at = [own.add("HOLEP", p)?, own.add("HOLEQ", q)?];
        let (mut axis, mut top) = (CoordinateAxis::Z, true);
        if args.take("FROM") {
            match face_choice(args)? {
                FaceChoice::Extreme { axis: a, top: t } => (axis, top) = (a, t),
                FaceChoice::Named(_) => return Err(args.wants("TOP axis or BOTTOM axis")),
            }
        }
        let mut depth = None;
        if args.take("DEPTH") {
            let value = args.value(units)?;
            depth = Some(own.add("DEPTH", value)?);
        }
        let mut head = None;
        if args.take("COUNTERBORE") {
            let (d, t) = (args.value(units)?, args.value(units)?);
            let (diameter, depth) = (own.add("BORE", d)?, own.add("SEAT", t)?);
            head = Some(HoleHead::Counterbore { diameter, depth });
        } else if args.take("COUNTERSINK") {
            let (d, a) = (args.value(units)?, args.value(None)?);
            let (diameter, angle) = (own.add("SINK", d)?, own.add("CONE", a)?);
            head = Some(HoleHead::Countersink { diameter, angle });
        }
        let nothing = || DimensionExpr::number(0.0);
        let across = |p: DimensionExpr, q: DimensionExpr| {
            let mut all = [nothing(), nothing(), nothing()];
            let [a, b] = axis.others();
            (all[a.index()], all[b.index()]) = (p, q);
            all
        };
        let mut copies = Vec::new();
        loop {
            if args.take("LINEAR") {
                let count = args.value(None)?;
                let (p, q) = (args.value(units)?, args.value(units)?);
                let count = own.add("COUNT", count)?;
                let (p, q) = (own.add("STEPP", p)?, own.add("STEPQ", q)?);
                copies.push((Placement::Move(across(p, q)), count));
            } else if args.take("POLAR") {
                let (count, angle) = (args.value(None)?, args.value(None)?);
                let (count, angle) = (own.add("COUNT", count)?, own.add("ANGLE", angle)?);
                let through = match args.take("THROUGH") {
                    true => {
                        let (p, q) = (args.value(units)?, args.value(units)?);
                        across(own.add("THROUGHP", p)?, own.add("THROUGHQ", q)?)
                    }
                    false => across(nothing(), nothing()),
                };
                copies.push((Placement::Rotate { axis, through, angle }, count));
            } else {
                break;
            }
        }
        let target = self.target(args, &object.name)?;
        args.end()?;
        let kind =
            FeatureKind::Hole(Box::new(Hole { axis, top, at, diameter, depth, head, copies }));
        self.make_with(Feature { kind, operands: operand(&object) }, own.made, &target, |_| None)
    }

    /// `DRAFT a axis degrees [AT c] [FACES face …] [INTO c]`.
    pub(super) fn draft(&mut self, args: &mut Args) -> Result<(), CommandError> {
        let object = self.treated(args)?;
        let mut own = OwnNumbers::of(&object);
        let axis = args.axis().ok_or_else(|| args.wants("an axis"))?;
        let angle = args.value(None)?;
        let angle = own.add("DRAFT", angle)?;
        let at = if args.take_short("AT") {
            args.value(object.units.as_deref())?
        } else {
            DimensionExpr::number(0.0)
        };
        let at = own.add("NEUTRAL", at)?;
        let faces = if args.take("FACES") { face_choices(args)? } else { Vec::new() };
        let target = self.target(args, &object.name)?;
        args.end()?;
        let kind = FeatureKind::Draft { angle, axis, at, faces };
        self.make_with(Feature { kind, operands: operand(&object) }, own.made, &target, |_| None)
    }
}

/// The next choice of edges, if there is one.
fn edge_choice(args: &mut Args) -> Result<Option<EdgeChoice>, CommandError> {
    Ok(Some(if args.take_short("ALL") {
        EdgeChoice::All
    } else if args.take("ALONG") {
        EdgeChoice::Along(args.axis().ok_or_else(|| args.wants("an axis"))?)
    } else if args.take_short("OF") {
        EdgeChoice::Of(face_choice(args)?)
    } else if args.take("BETWEEN") {
        let first = face_choice(args)?;
        EdgeChoice::Between(first, face_choice(args)?)
    } else if args.take("LINE") || args.at_number() {
        EdgeChoice::Line(args.line()?)
    } else {
        return Ok(None);
    }))
}

/// A face: `TOP axis`, `BOTTOM axis`, its number or its name.
pub(super) fn face_choice(args: &mut Args) -> Result<FaceChoice, CommandError> {
    for (word, top) in [("TOP", true), ("BOTTOM", false)] {
        if args.take(word) {
            let axis = args.axis().ok_or_else(|| args.wants("an axis"))?;
            return Ok(FaceChoice::Extreme { axis, top });
        }
    }
    if args.at_number() {
        return Ok(FaceChoice::Named(args.count("the number of a face")?.to_string()));
    }
    Ok(FaceChoice::Named(args.name("TOP axis, BOTTOM axis, or the name of a face")?))
}

fn face_choices(args: &mut Args) -> Result<Vec<FaceChoice>, CommandError> {
    let mut faces = vec![face_choice(args)?];
    let more = |args: &Args| {
        args.at_number()
            || args.peek().is_some_and(|t| {
                t.kind == CommandTokenKind::Text
                    || (t.kind == CommandTokenKind::Word && !t.text.eq_ignore_ascii_case("INTO"))
            })
    };
    while more(args) {
        faces.push(face_choice(args)?);
    }
    Ok(faces)
}
