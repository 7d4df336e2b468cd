//! The numbered cases of `cases.jsonl` as objects.
#![allow(dead_code)]

use moldloft_num::Vec3;
use moldloft_sketch::json::Json;
use moldloft_sketch::*;

pub struct Case {
    pub id: String,
    pub object: SketchObject,
    pub counts: [usize; 3],
    pub xyz: Vec<Vec3>,
    pub faces: Vec<SketchFace>,
    pub volume: f64,
    pub area: f64,
    pub centroid: Vec3,
}

fn numbers(json: &Json) -> Vec<f64> {
    json.items().iter().map(|x| x.number().unwrap()).collect()
}

fn vector(json: &Json) -> Vec3 {
    let n = numbers(json);
    Vec3::new(n[0], n[1], n[2])
}

fn cycle(json: &Json) -> Vec<PointId> {
    numbers(json).into_iter().map(|x| PointId(x as u32)).collect()
}

/// A drawing with points but no lines.
/// All objects of a session as commands.
pub fn all_commands(s: &SketchSession) -> String {
    let names = s.names();
    let objects: Vec<&SketchObject> = names.iter().filter_map(|n| s.object(n)).collect();
    scripts(&objects).into_iter().map(|(_, text)| text).collect()
}

pub fn drawn(axes: [f64; 3], points: &[(f64, f64)]) -> SketchObject {
    let mut object = SketchObject::new("A", None);
    let drawing = object.draw();
    drawing.projection = Projection { angle_deg: axes, scale: [1.0; 3] };
    for (k, &(u, v)) in points.iter().enumerate() {
        drawing.points.insert(PointId(k as u32 + 1), DrawnPoint { u, v });
    }
    object
}

pub fn add_lines(object: &mut SketchObject, kind: &str, pairs: &str) {
    let drawing = object.draw();
    for pair in pairs.split_whitespace() {
        let (p, q) = pair.split_once('-').unwrap();
        let [p, q] = [p, q].map(|x| PointId(x.parse().unwrap()));
        let free = drawing.letters.free(kind, drawing.section);
        let id = drawing.next_line();
        let line = DrawnLine { p, q, free, source: LineTypeSource::User, confidence: 1.0 };
        drawing.lines.insert(id, line);
    }
}

/// `X 1 4 5.5`
pub fn add_dimension(object: &mut SketchObject, text: &str) {
    let words: Vec<&str> = text.split_whitespace().collect();
    let point = |k: usize| PointId(words[k].parse().unwrap());
    object.add_dimension(Dimension {
        name: object.fresh_name("D"),
        measure: MeasuredQuantity::Along {
            axis: CoordinateAxis::of(words[0]).unwrap(),
            p: point(1),
            q: point(2),
        },
        value: Some(DimensionExpr::parse(words[3]).unwrap()),
        role: DimensionRole::Driving,
        range: None,
    });
}

pub fn align(object: &mut SketchObject, text: &str) {
    let words: Vec<&str> = text.split_whitespace().collect();
    let point = |k: usize| PointId(words[k].parse().unwrap());
    object.draw().aligns.push(Align {
        axis: CoordinateAxis::of(words[0]).unwrap(),
        p: point(1),
        q: point(2),
    });
}

pub fn cases() -> Vec<Case> {
    include_str!("cases.jsonl").lines().map(case).collect()
}

pub fn case_named(prefix: &str) -> Case {
    cases().into_iter().find(|c| c.id.starts_with(prefix)).unwrap()
}

fn case(line: &str) -> Case {
    let json = Json::parse(line).unwrap();
    let get = |key: &str| json.get(key).unwrap();
    let axes = numbers(get("axes"));
    let points: Vec<(f64, f64)> =
        get("sketch").items().iter().map(|p| (numbers(p)[0], numbers(p)[1])).collect();
    let mut object = drawn([axes[0], axes[1], axes[2]], &points);
    let Json::Map(lines) = get("lines") else { panic!("lines by type") };
    for (kind, pairs) in lines {
        add_lines(&mut object, kind, pairs.text().unwrap());
    }
    for a in json.get("align").map_or(&[][..], Json::items) {
        align(&mut object, a.text().unwrap());
    }
    for d in get("dims").items() {
        add_dimension(&mut object, d.text().unwrap());
    }
    let n = numbers(get("N"));
    let face = |f: &Json| match f.get("outer") {
        Some(outer) => SketchFace {
            outer: cycle(outer),
            holes: f.get("holes").unwrap().items().iter().map(cycle).collect(),
        },
        None => SketchFace { outer: cycle(f), holes: vec![] },
    };
    let object = SketchObject { name: "A".into(), ..object };
    let first = vector(&get("xyz").items()[0]);
    assert_eq!(first, Vec3::zero(), "the default reference serves every case");
    Case {
        id: get("id").text().unwrap().to_owned(),
        object,
        counts: [n[0] as usize, n[1] as usize, n[2] as usize],
        xyz: get("xyz").items().iter().map(vector).collect(),
        faces: get("faces").items().iter().map(face).collect(),
        volume: get("volume").number().unwrap(),
        area: get("area").number().unwrap(),
        centroid: vector(get("centroid")),
    }
}

/// Solves without derived dimensions.
pub fn layout(object: &SketchObject) -> (Planes, DimensionLayout<f64>) {
    let planes = Planes::of(&object.drawing);
    let guess = || {
        let reference = object.reference()?.point;
        Estimate::of(&object.drawing, &planes, reference)
    };
    let layout = solve(object, &planes, &Default::default(), &guess);
    (planes, layout)
}

/// A box of points 1-4 below, 5-8 above, counter-clockwise from the origin.
pub fn cuboid(size: [f64; 3]) -> SketchObject {
    let p = Projection::default();
    let mut points = Vec::new();
    for z in [0.0, size[2]] {
        for (x, y) in [(0.0, 0.0), (size[0], 0.0), (size[0], size[1]), (0.0, size[1])] {
            let [u, v] = p.project(Vec3::new(x, y, z));
            points.push((u, v));
        }
    }
    let mut object = drawn(p.angle_deg, &points);
    add_lines(&mut object, "X", "1-2 3-4 5-6 7-8");
    add_lines(&mut object, "Y", "2-3 4-1 6-7 8-5");
    add_lines(&mut object, "Z", "1-5 2-6 3-7 4-8");
    add_dimension(&mut object, &format!("X 1 2 {}", size[0]));
    add_dimension(&mut object, &format!("Y 1 4 {}", size[1]));
    add_dimension(&mut object, &format!("Z 1 5 {}", size[2]));
    object
}

/// Finds and stores the faces of the likeliest solid.
pub fn with_faces(mut object: SketchObject) -> SketchObject {
    let (planes, layout) = layout(&object);
    let positions = layout.positions(&planes).unwrap();
    let at = |p: PointId| planes.ids().binary_search(&p).unwrap();
    let edges: Vec<[usize; 2]> =
        object.drawing.lines.values().map(|l| [at(l.p), at(l.q)]).collect();
    let fitted = moldloft_sketch::faces::fit(&positions, &edges);
    let points = |c: &Vec<usize>| c.iter().map(|&k| planes.ids()[k]).collect();
    for f in &fitted.fits[0].faces {
        let face =
            SketchFace { outer: points(&f.outer), holes: f.holes.iter().map(points).collect() };
        object.faces.insert(object.next_face(), face);
    }
    object
}

pub fn built(object: &SketchObject) -> SketchSolid<f64> {
    let (planes, layout) = layout(object);
    solid(object, &planes, &layout).unwrap()
}

pub fn curve(
    name: &str,
    kind: curve::CurveKind,
    points: &[u32],
    size: &[&str],
) -> curve::SketchCurve {
    let size: Vec<DimensionExpr> = size.iter().map(|s| DimensionExpr::parse(s).unwrap()).collect();
    let corner = matches!(kind, curve::CurveKind::Arc | curve::CurveKind::Circle);
    curve::SketchCurve {
        name: name.into(),
        kind,
        points: points.iter().map(|&p| PointId(p)).collect(),
        radius: size.first().filter(|_| corner).cloned(),
        semi: (size.len() == 2).then(|| [size[0].clone(), size[1].clone()]),
        shape: Vec::new(),
        steps: None,
        replaces: true,
        centripetal: false,
    }
}

pub fn add_curve(object: &mut SketchObject, c: curve::SketchCurve) {
    object.curves.insert(c.name.to_ascii_lowercase(), c);
}
