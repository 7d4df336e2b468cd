//! Planes, frames, contours, relabels and everything else.

use crate::laws::program::Program;

/// The arguments of a random object of this kind; `None` for a kind of another family.
pub fn arguments(p: &mut Program, kind: &str) -> Option<String> {
    let [x, y, _] = p.coordinates();
    Some(match kind {
        "Model" => "symmetry = \"\"".to_string(),
        "XPlane" | "YPlane" | "ZPlane" => x,
        "OffsetPlane" => format!("{}, {x}", p.random.pick(&p.planes)),
        "ThreePointPlane" => p.points::<3>().join(", "),
        "TwoPointPlane" => p.points::<2>().join(", "),
        "PlaneThroughPoint" => format!("{}, {}", p.point(), p.random.pick(&p.planes)),
        "TanPlane" => {
            let surface = p.surface();
            p.magnet(&surface)
        }
        "NormalPlane" => {
            let curve = p.curve();
            p.bead(&curve)
        }
        "ThreePointFrame" => p.points::<3>().join(", "),
        "RPYFrame" => format!("{}, {x}, {y}*w, 0.5", p.point()),
        "XContours" | "YContours" | "ZContours" => format!("0, 3, {x}, {y}"),
        "Relabel" => {
            format!("{{0, {}*w, {}, 1}}, degree = 2", p.number(0.05, 0.2), p.number(0.5, 0.9))
        }
        "SolveSet" => {
            // h = 0.5 w + 0.25 + what the unknown adds: solved by x = w^2.
            let x = p.name("x");
            let name = p.point();
            p.text += &format!("param float {x} = 1; AbsPoint {x}p({x}, {x}*h, {name}.z);\n");
            format!("{{{x}}}, {{{x}p.x^1.5 - w*{x}p.x^0.5 - 0.125*({x} - w)^3}}")
        }
        "PlaneContours" => format!("{}, 0, 3, {x}, {y}", p.random.pick(&p.planes)),
        "CylinderContours" | "AngleContours" => {
            let [a, b] = p.points();
            format!("{}, 0, 3, 0.5*w, 0.25", p.object("Line", &format!("{a}, {b}")))
        }
        "Field" => format!("sphere({}, w) - 0.5*w", p.point()),
        "Set" => {
            format!("set(sphere({}, w)) & -set(plane({{{x}, 1, 0.3}}, {}))", p.point(), p.point())
        }
        // Vertices move along normals, unlike differences of facets; those of a set that stays are at rest.
        "SetBody" => "set(sphere({0.1, 0, 0}, 1)), depth = 3".to_string(),
        "RealList" => format!("{{{x}, {y}*w}}"),
        "KnotList" => format!("{{0, 0, {}*w, 2, 2}}", p.number(0.1, 0.9)),
        "EntityList" => format!("{{{}, {}}}", p.point(), p.curve()),
        "CosRelabel" => {
            let end = *p.random.pick(&["both", "start", "end"]);
            format!("\"{end}\", {}", p.number(0.2, 0.9))
        }
        "GeoRelabel" => format!("{}*w", p.number(0.3, 4.0)),
        "TanhRelabel" => {
            let end = *p.random.pick(&["both", "start", "end"]);
            format!("{}, \"{end}\"", p.number(0.5, 4.0))
        }
        "TableRelabel" => {
            format!(
                "{{0, 0.3, {}, 1}}, {{0, {}*w, 0.5, 1}}",
                p.number(0.5, 0.9),
                p.number(0.05, 0.2)
            )
        }
        "ArcLenRelabel" => {
            let points = p.points::<3>().join(", ");
            p.object("BCurve", &format!("{{{points}}}, degree = 2"))
        }
        "CopyRelabel" => {
            let ratio = p.number(0.3, 4.0);
            let law = p.object("GeoRelabel", &format!("{ratio}*w"));
            let points = p.points::<3>().join(", ");
            p.object("BCurve", &format!("{{{points}}}, degree = 2, relabel = {law}"))
        }
        "InvRelabel" => p.object("CosRelabel", "\"both\", 0.6*h"),
        "ComposeRelabel" => {
            let ratio = p.number(0.3, 4.0);
            let law = p.object("GeoRelabel", &format!("{ratio}*w"));
            let end = p.object("TanhRelabel", "2, \"end\"");
            format!("{{{law}, {end}}}")
        }
        "FaceSet" => {
            let points = p.points::<4>().join(", ");
            let body = p.object(
                "MeshBody",
                &format!("{{{points}}}, {{1, 3, 2, 1, 2, 4, 2, 3, 4, 3, 1, 4}}"),
            );
            match p.random.below(2) {
                0 => body,
                _ => format!("{body}, {{1, 2, 3, 4}}"),
            }
        }
        "TriMesh" => {
            let points = p.points::<4>().join(", ");
            let levels = p.random.below(3);
            format!("{{{points}}}, {{1, 3, 2, 1, 2, 4, 2, 3, 4, 3, 1, 4}}, {levels}")
        }
        "MeshBody" => {
            let points = p.points::<4>().join(", ");
            format!("{{{points}}}, {{1, 3, 2, 1, 2, 4, 2, 3, 4, 3, 1, 4}}")
        }
        _ => return None,
    })
}
