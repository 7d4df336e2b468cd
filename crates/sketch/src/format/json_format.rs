//! The JSON twin of a sketch file, and the data of finished objects.

use crate::format::json::Json;
use crate::format::script::measure_text;
use crate::{
    CoordinateAxis, DimensionLayout, DimensionRole, FaceId, LineId, LineTypeSource, Loose, Mass,
    Planes, PointId, SketchFace, SketchObject, SketchSolid, TypeProposal,
};
use moldloft_num::Vec3;

/// A line with its type, and how that is known.
#[derive(Clone, Debug, PartialEq)]
pub struct LineData {
    /// Its label.
    pub id: LineId,
    /// Its ends.
    pub ends: [PointId; 2],
    /// `X`, `XY`, `O`, or empty while unknown.
    pub free: &'static str,
    /// Source of the type.
    pub source: LineTypeSource,
    /// Confidence of the type, from 0 to 1.
    pub certainty: f64,
    /// The likeliest type of a line without one, if the object has a certainty.
    pub proposal: Option<TypeProposal>,
}

/// Data of a finished (or unfinished) object, for hosts.
#[derive(Clone, Debug)]
pub struct ObjectData {
    /// Its name.
    pub name: String,
    /// `sketch`, `planes` (fully dimensioned) or `solid`.
    pub state: &'static str,
    /// Points and tangent points with their coordinates, as far as determined.
    pub points: Vec<(PointId, [Option<f64>; 3])>,
    /// Positions of points on the page.
    pub page: Vec<(PointId, [f64; 2])>,
    /// Its lines.
    pub lines: Vec<LineData>,
    /// Faces before curves are built in.
    pub faces: Vec<(FaceId, SketchFace)>,
    /// Enclosed volume, of a solid.
    pub volume: Option<f64>,
    /// Area of all faces.
    pub area: Option<f64>,
    /// Centre of the volume, or of the area of a cross section.
    pub centroid: Option<Vec3>,
    /// Area, volume, centroid and inertia together.
    pub mass: Option<Mass<f64>>,
    /// Dimensions missing on X, Y, Z.
    pub missing: [usize; 3],
    /// Parts that they would connect.
    pub loose: Vec<Loose>,
    /// Dimensions with their values, in order.
    pub dimensions: Vec<(String, String, Option<f64>)>,
    /// The body with curves, of a solid or a section with faces.
    pub solid: Option<SketchSolid<f64>>,
}

/// The data of an object from its computed results.
pub fn object_data(
    object: &SketchObject,
    planes: &Planes,
    layout: &DimensionLayout<f64>,
    solid: Option<SketchSolid<f64>>,
) -> ObjectData {
    let mut points: Vec<(PointId, [Option<f64>; 3])> = (planes.ids().iter())
        .map(|&p| (p, CoordinateAxis::ALL.map(|a| layout.coordinate(planes, a, p))))
        .collect();
    if let Some(solid) = &solid {
        let new = solid.vertices.iter().filter(|v| !object.drawing.points.contains_key(&v.id));
        points.extend(new.map(|v| (v.id, v.at.to_array().map(Some))));
        points.sort_by_key(|p| p.0);
    }
    let untyped = |p: &TypeProposal| object.drawing.lines[&p.line].free.is_none();
    let proposals: Vec<TypeProposal> = match object.drawing.certainty > 0.0 {
        true => object.drawing.type_proposals().into_iter().filter(untyped).collect(),
        false => vec![],
    };
    let lines = object.drawing.lines.iter().map(|(id, l)| LineData {
        id: *id,
        ends: [l.p, l.q],
        free: l.free.map_or("", crate::Free::spelling),
        source: l.source,
        certainty: if l.source == LineTypeSource::User { 1.0 } else { l.confidence },
        proposal: proposals.iter().find(|p| p.line == *id).cloned(),
    });
    let mass = solid.as_ref().map(SketchSolid::mass);
    let flat = object.drawing.section.is_some();
    ObjectData {
        name: object.name.clone(),
        state: if solid.is_some() {
            "solid"
        } else if layout.complete() && !points.is_empty() {
            "planes"
        } else {
            "sketch"
        },
        points,
        page: object.drawing.points.iter().map(|(id, p)| (*id, [p.u, p.v])).collect(),
        lines: lines.collect(),
        faces: object.faces.iter().map(|(id, f)| (*id, f.clone())).collect(),
        volume: mass.filter(|_| !flat).map(|m| m.volume),
        area: mass.map(|m| m.area),
        centroid: mass.map(|m| m.centroid),
        mass,
        missing: layout.counts.map(|c| c.missing),
        loose: layout.loose.clone(),
        dimensions: (object.dimensions.iter())
            .map(|(k, d)| {
                let value = match d.role {
                    DimensionRole::Driving => layout.values.get(k).copied(),
                    DimensionRole::Reference => layout.measured(object, planes, &d.measure),
                };
                (d.name.clone(), measure_text(&d.measure), value)
            })
            .collect(),
        solid,
    }
}

impl ObjectData {
    /// As JSON, with the members of this struct but the solid.
    pub fn to_json(&self) -> Json {
        let numbers = |x: &[f64]| Json::list(x.iter().map(|&x| Json::from(x)));
        let labels = |c: &[PointId]| Json::list(c.iter().map(|p| p.0.into()));
        let points = self.points.iter().map(|(id, at)| {
            let page = self.page.binary_search_by_key(id, |p| p.0).ok();
            Json::map([
                ("id", id.0.into()),
                ("at", Json::list(at.iter().map(|x| Json::from(*x)))),
                ("page", page.map_or(Json::Null, |k| numbers(&self.page[k].1))),
            ])
        });
        let lines = self.lines.iter().map(|line| {
            Json::map([
                ("id", line.id.0.into()),
                ("points", labels(&line.ends)),
                ("type", line.free.into()),
                ("source", line.source.word().into()),
                ("certainty", line.certainty.into()),
                ("proposal", line.proposal.as_ref().map(proposal_json).into()),
            ])
        });
        let faces = self.faces.iter().map(|(id, f)| {
            let holes = Json::list(f.holes.iter().map(|h| labels(h)));
            Json::map([("id", id.0.into()), ("outer", labels(&f.outer)), ("holes", holes)])
        });
        let missing =
            CoordinateAxis::ALL.map(|a| (a.letter(), Json::from(self.missing[a.index()])));
        let loose = self
            .loose
            .iter()
            .map(|l| Json::map([("axis", l.axis.letter().into()), ("points", labels(&l.points))]));
        let dimensions = self.dimensions.iter().map(|(name, what, value)| {
            Json::map([
                ("name", name.as_str().into()),
                ("measures", what.as_str().into()),
                ("value", Json::from(*value)),
            ])
        });
        Json::map([
            ("name", self.name.as_str().into()),
            ("state", self.state.into()),
            ("points", Json::list(points)),
            ("lines", Json::list(lines)),
            ("faces", Json::list(faces)),
            ("volume", self.volume.into()),
            ("area", self.area.into()),
            ("centroid", self.centroid.map_or(Json::Null, |c| numbers(&c.to_array()))),
            (
                "inertia",
                self.mass
                    .filter(|_| self.volume.is_some())
                    .map_or(Json::Null, |m| numbers(&m.inertia)),
            ),
            ("missing", Json::map(missing)),
            ("loose", Json::list(loose)),
            ("dimensions", Json::list(dimensions)),
        ])
    }
}

/// A proposed type: type, probability, alternatives; null for an inclined line without a type.
fn proposal_json(proposal: &TypeProposal) -> Json {
    let one = |free: Option<crate::Free>, p: f64| {
        [("type", free.map(crate::Free::spelling).into()), ("probability", Json::from(p))]
    };
    let others = proposal.alternatives.iter().map(|(free, p)| Json::map(one(*free, *p)));
    let own = one(Some(proposal.free), proposal.probability);
    Json::map(own.into_iter().chain([("alternatives", Json::list(others))]))
}

/// The JSON form: format and version, the fields of the object as data, and the commands that make
/// it ([`crate::script`]), which are what is read back.
pub fn to_json(object: &SketchObject, script: &str) -> Json {
    let d = &object.drawing;
    let points = d
        .points
        .iter()
        .map(|(id, p)| Json::map([("id", Json::from(id.0)), ("u", p.u.into()), ("v", p.v.into())]));
    let lines = d.lines.iter().map(|(id, l)| {
        Json::map([
            ("id", Json::from(id.0)),
            ("p", l.p.0.into()),
            ("q", l.q.0.into()),
            ("free", l.free.map(crate::Free::spelling).into()),
            ("source", l.source.word().into()),
            ("confidence", l.confidence.into()),
        ])
    });
    Json::map([
        ("format", Json::from("sketch")),
        ("version", Json::from(1.0)),
        ("name", object.name.as_str().into()),
        ("display", object.display.into()),
        ("keep", object.keep.into()),
        ("units", object.units.as_deref().into()),
        ("axes", Json::list(d.projection.angle_deg.map(Json::from))),
        ("scale", Json::list(d.projection.scale.map(Json::from))),
        ("section", d.section.map(CoordinateAxis::letter).into()),
        ("certainty", d.certainty.into()),
        ("points", Json::list(points)),
        ("lines", Json::list(lines)),
        ("script", Json::list(script.lines().map(Json::from))),
    ])
}

/// The commands of a twin, or of a list of twins.
///
/// # Errors
/// Names the missing part of the text.
pub fn from_json(text: &str) -> Result<String, String> {
    let json = Json::parse(text)?;
    let one = [json.clone()];
    let twins = if json.items().is_empty() { &one[..] } else { json.items() };
    let mut out = String::new();
    for twin in twins {
        if twin.get("format").and_then(Json::text) != Some("sketch") {
            return Err("no member \"format\" of value \"sketch\"".to_owned());
        }
        if twin.get("version").and_then(Json::number) != Some(1.0) {
            return Err("only version 1 is known".to_owned());
        }
        for line in twin.get("script").map_or(&[][..], Json::items) {
            out.push_str(line.text().ok_or("a line of the script is not text")?);
            out.push('\n');
        }
    }
    Ok(out)
}
