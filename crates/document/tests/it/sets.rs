//! Fields and sets in the language: operators, grouping, objects, measures, facets, derivatives.

use crate::common::{ids, number, open, reported, sound, vector};
use moldloft_document::Document;
use moldloft_registry::Value;
use std::f64::consts::PI;

/// The T-piece of the svLis manual, its radii and shape as parameters.
const TEE: &str = "
param float r1 = 1 in [0.8, 1.2];
param float r2 = 0.6 in [0.4, 0.8];
AbsPoint O(0, 0, 0); AbsPoint X(1, 0, 0); AbsPoint D(1, 0, 1);
Line along(O, X); Line slope(O, D);
field c1 = cylinder(along, r1);
field c2 = cylinder(slope, r2);
vector d = {1, 0, 1} / |{1, 0, 1}|;
AbsPoint apex(4.5, 0, 4.5);
Line back(apex, O);
field k = cone(back, radians(17));
field s = plane(d, {0, 0, 0});
set ends = set(plane({1, 0, 0}, {3.5, 0, 0})) & set(plane({-1, 0, 0}, {-3.5, 0, 0}));
set top = set(-s) & set(s - 4);
field q = 0.6*c1*c2 - 0.4*k^2;
set tee = set(c1) & ends | set(c2) & top | set(q) & set(k) & top;
";

fn holds(text: &str) {
    sound(&format!("AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z);\n{text}"));
}

/// The ids and messages of a text's diagnostics.
fn faults(text: &str) -> Vec<String> {
    reported(&open(&format!("AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z);\n{text}")))
}

#[test]
fn arithmetic_on_fields_is_that_of_their_values() {
    holds(
        "field a = sphere({0, 0, 0}, 1); field b = plane({1, 0, 0}, {0.5, 0, 0}); vector p = {0.3, 0.4, 0.5};
         field all = 0.6*a*b - 0.4*b^2 + a/2 - 1 + 3*b;
         float f = a(p); float g = b(p);
         assert abs(all(p) - (0.6*f*g - 0.4*g^2 + f/2 - 1 + 3*g)) < 1e-15;
         assert (-a)(p) == -f; assert (1 - a)(p) == 1 - f; assert (2/4*a)(p) == 0.5*f;
         assert abs(a)(p) == abs(f); assert |b|(p) == abs(g); assert (a^3)(p) == f*f*f;
         assert abs(sin(b)(p) - sin(g)) < 1e-15; assert abs(exp(a)(p) - exp(f)) < 1e-15;
         assert abs(s_sqrt(b)(p) - s_sqrt(g)) < 1e-15;
         assert min(a, b)(p) == min(f, g); assert max(a, b, 3)(p) == 3; assert abs(atan2(a, b)(p) - atan2(f, g)) < 1e-15;
         assert gradient(a, p).y == 0.8; assert degree(all) == 3; assert sign(b)(p) == -1;
         curve rows[2]; rows[1] = p; rows[2] = {1, 0, 0}; farray v = a(rows); assert v[2] == 0;",
    );
}

#[test]
fn sets_group_as_in_c_and_fields_as_numbers() {
    holds(
        "field a = sphere({0, 0, 0}, 1); field b = sphere({1.5, 0, 0}, 1); field c = plane({0, 0, 1}, {0, 0, 0});
         set A = set(a); set B = set(b); set C = set(c);
         vector both = {0.75, 0, -0.1}; vector left = {-0.5, 0, -0.1}; vector above = {-0.5, 0, 0.1};
         set u = A | B & C; assert member(u, above) == \"solid\"; assert member((A | B) & C, above) == \"air\";
         set x = A ^ B; assert member(x, both) == \"air\"; assert member(x, left) == \"solid\";
         set d = A - B & C; assert member(d, both) == \"air\"; assert member(d, above) == \"air\"; assert member(d, left) == \"solid\";
         assert member(-A, left) == \"air\"; assert member(-A | A, left) == \"solid\";
         field f = a - 2*c^2; assert f(left) == a(left) - 2*c(left)^2;
         assert |volume(A | B, {-2, -2, -2}, {3, 2, 2}, 1e-3) - 8| < 2;
         assert member(A | C, above) == \"solid\"; assert member(a & c, above) == \"air\";
         assert winner(A | B, {1.4, 0, 0}) == \"B\";",
    );
}

#[test]
fn names_of_faces_are_those_of_the_innermost_declaration() {
    let mut model =
        sound(&format!("{TEE} SetBody part(tee, {{-4, -4, -4}}, {{4, 4, 4}}, depth = 5);"));
    let mesh = model.panelled().unwrap();
    let names: Vec<&str> = mesh.mesh.patches().iter().map(|p| p.info.name.as_str()).collect();
    assert_eq!(names, ["part.c1", "part.ends", "part.ends.2", "part.c2", "part.top", "part.q"]);
    assert_eq!(mesh.mesh.patches()[0].info.kind, "cylinder");
    let report = mesh.mesh.report();
    assert!(report.closed && report.manifold && report.oriented && report.components == 1);
    let euler = report.vertices as i64 - 3 * report.faces as i64 / 2 + report.faces as i64;
    assert_eq!(euler, 2, "genus 0");
}

#[test]
fn the_golden_volume_and_its_bracket() {
    let mut model = sound(TEE);
    let volume = number(&mut model, "volume(tee, {-4,-4,-4}, {4,4,4})");
    assert!((volume - 25.097).abs() < 1e-3, "{volume}");
    let found = number(&mut model, "volume(tee)");
    assert!((volume - found).abs() < 1e-3, "{volume} {found}");
    let Ok(Value::Numbers(bracket)) = model.eval("volume_bracket(tee, {-4,-4,-4}, {4,4,4})") else {
        panic!()
    };
    assert!(bracket.items[0] < volume && volume < bracket.items[1]);
}

#[test]
fn closed_forms() {
    let mut model = sound(
        "param float r = 1 in [0.5, 2]; AbsPoint O(0, 0, 0); AbsPoint X(1, 0, 0); AbsPoint Z(0, 0, 1);
         Line x(O, X); Line z(O, Z);
         set ball = set(sphere(O, r)); set ring = set(torus(z, 2*r, 0.5*r));
         set steinmetz = set(cylinder(x, r)) & set(cylinder(z, r));
         set napkin = set(sphere(O, r)) - set(cylinder(z, 0.6*r));",
    );
    let r = 1.0f64;
    let forms = [
        ("volume(ball)", 4.0 * PI / 3.0 * r.powi(3)),
        ("area(ball)", 4.0 * PI),
        ("volume(ring)", 2.0 * PI * PI * 2.0 * 0.25),
        ("volume(steinmetz)", 16.0 / 3.0),
        ("area(steinmetz)", 16.0),
        ("volume(napkin)", PI * 1.6f64.powi(3) / 6.0),
    ];
    for (text, exact) in forms {
        let found = number(&mut model, text);
        assert!((found - exact).abs() < 3e-4 * exact, "{text}: {found} {exact}");
        // d/dr: volumes grow as r^3, areas as r^2.
        let power = if text.starts_with("volume") { 3.0 } else { 2.0 };
        let slope = model.derivatives(&[text.into()], &["r".into()]).unwrap();
        let Value::Number(slope) = slope[0][0] else { panic!() };
        assert!((slope - power * exact).abs() < 1e-3 * exact, "{text}: {slope}");
    }
}

#[test]
fn derivatives_equal_differences() {
    let mut model = sound(
        "param float r = 0.7 in [0.5, 1]; param float a = 0.3 in [0, 1];
         AbsPoint P(a, 0.1, 0.2); AbsPoint Q(a + 0.2, 1, 0.5*r); Line axis(P, Q);
         set s = (set(sphere(P, r)) | set(cylinder(axis, 0.3*r))) - set(plane({1, 0.2, 0}, Q));
         SetBody b(s, {-1, -1, -1}, {2, 2, 2}, depth = 5);",
    );
    let texts = [
        "volume(s, {-1,-1,-1}, {2,2,2})",
        "mass_centre(s, {-1,-1,-1}, {2,2,2}).x",
        "inertia(s, {-1,-1,-1}, {2,2,2})[1].x",
        "area(s, {-1,-1,-1}, {2,2,2})",
        "nearest(s, {-3, a, r}, {-1,-1,-1}, {2,2,2}).y",
        "hit(s, {-3, a, 0.1}, {1, r/10, 0}, 9)",
        "s({a, r, 0.1})",
        "gradient(s, {a, r, 0.1}).z",
        "b.volume",
    ];
    for by in ["r", "P.y"] {
        let all: Vec<String> = texts.iter().map(|t| t.to_string()).collect();
        let exact = model.derivatives(&all, &[by.into()]).unwrap();
        let start = number(&mut model, by);
        for (text, exact) in texts.iter().zip(&exact) {
            let Value::Number(exact) = exact[0] else { panic!() };
            // Integrals by facets are smooth to their own accuracy: wide steps, extrapolated twice.
            let integral = ["volume", "mass", "inertia", "area", "b.volume"];
            let integral = integral.iter().any(|i| text.starts_with(i));
            let (h, tolerance) = match *text {
                // Facets at one depth jump a little as the grid passes: by shares of the cells' area.
                "b.volume" => (0.04, 4e-3),
                // Of an area of 12, of which the curvature takes a digit.
                _ if text.starts_with("area") => (0.02, 1e-5),
                _ if integral => (0.02, 1e-6),
                _ => (1e-4, 1e-6),
            };
            let mut at = |x: f64| {
                model.set(&[(by.into(), x)]).unwrap();
                number(&mut model, text)
            };
            let mut slope = |h: f64| (at(start + h) - at(start - h)) / (2.0 * h);
            let (wide, narrow, least) = (slope(h), slope(0.5 * h), slope(0.25 * h));
            let (first, second) = (narrow + (narrow - wide) / 3.0, least + (least - narrow) / 3.0);
            let centred = second + (second - first) / 15.0;
            model.set(&[(by.into(), start)]).unwrap();
            let close = (exact - centred).abs() <= tolerance * exact.abs().max(1.0);
            assert!(close, "d({text})/d({by}) = {exact}, differences {centred}");
        }
    }
}

#[test]
fn a_moved_point_moves_the_blend_and_only_what_hangs_on_it() {
    let text =
        "AbsPoint P(0, 0, 0); AbsPoint Q(5, 0, 0); field a = sphere(P, 1); field b = sphere(Q, 1);
         set A = set(a); set B = set(b); SetBody one(A, depth = 3); SetBody two(B, depth = 3);";
    let mut model = sound(text);
    assert_eq!(model.graph().get(model.graph().find("A").unwrap()).unwrap().parents.len(), 1);
    let before = number(&mut model, "two.volume");
    model.set(&[("P.x".into(), 0.5)]).unwrap();
    // P, a, A, one: the other half stays.
    assert!(model.applied().evaluated <= 4, "{}", model.applied().evaluated);
    assert!((vector(&mut model, "one.centroid").x - 0.5).abs() < 1e-3);
    assert_eq!(number(&mut model, "two.volume").to_bits(), before.to_bits());
    // The same as from the text.
    let mut fresh = sound(&model.text());
    let panels = |m: &mut Document| m.panelled().unwrap().mesh.positions().to_vec();
    assert_eq!(panels(&mut model), panels(&mut fresh));
}

#[test]
fn sets_are_objects_or_variables() {
    let mut model = sound(
        "set balls = nothing(); for (i = 1:3) balls = balls | set(sphere({2*i, 0, 0}, 0.9));
         function set pair(float r) { set s = set(sphere({0, 0, 0}, r)); return s | translated(s, {0, 5, 0}); }
         set two = pair(0.5);",
    );
    assert!((number(&mut model, "volume(balls)") - 4.0 * PI * 0.729).abs() < 1e-3);
    assert!((number(&mut model, "volume(two)") - PI / 3.0).abs() < 1e-3);
    assert!(model.graph().find("two").is_some() && model.graph().find("balls").is_none());
    let twice = open("set s = everything(); set s = nothing();");
    assert_eq!(ids(&twice), ["duplicate-name"]);
}

#[test]
fn moved_sets_are_where_they_were_moved() {
    holds(
        "set block = cuboid({0, 0, 0}, {1, 2, 3}); float tol = 1e-9;
         assert |mass_centre(translated(block, {1, 1, 1})) - {1.5, 2, 2.5}| < tol;
         assert |mass_centre(turned(block, axis, radians(90))) - {-1, 0.5, 1.5}| < tol;
         assert |mass_centre(mirrored(block, \"x=0\")) - {-0.5, 1, 1.5}| < tol;
         assert abs(volume(scaled(block, 2, {1, 2, 3})) - 48) < tol;
         assert abs(volume(stretched(block, axis, 3)) - 18) < tol;
         assert abs(volume(tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})) - 1/6) < tol;
         assert abs(area(thin(block), {-1, -1, -1}, {4, 4, 4}) - 22) < 1e-3;
         field half = half_space(\"z=0\"); assert half({0, 0, 2}) == 2;
         ZPlane deck(1); assert abs(volume(block & deck) - 2) < tol;
         field far = sphere({0, 0, 0}, 2, distance = 1); assert far({5, 0, 0}) == 3;
         field pipe = cylinder(axis, 2, distance = 1); assert pipe({5, 0, 9}) == 3;",
    );
}

#[test]
fn blends_touch_and_say_where_they_would_not() {
    holds(
        "field x = plane({1, 0, 0}, {0, 0, 0}); field y = plane({0, 1, 0}, {0, 0, 0});
         set f = fillet(x, y, 1, low = {-2, -2, -1}, high = {3, 3, 1});
         float t = 1 - sqrt(0.5); assert abs(nearest(f, {t + 0.01, t + 0.01, 0}, {-2, -2, -1}, {3, 3, 1}).x - t) < 1e-9;
         assert winner(f, {0.1, 0.1, 0}) == \"fillet\";
         set r = rounded(x, y, 1); assert member(r, {-0.1, -0.1, 0}) == \"air\"; assert member(r, {-0.5, -0.5, 0}) == \"solid\";
         field rail = setback(x, y, 1, 2); assert rail({1, 0, 0}) == 0; assert rail({0, 2, 0}) == 0;
         field b = liming(x, y, rail, lambda = 0.3); assert degree(b) == 2;
         field four = liming(x, y, rail, plane({1, 1, 0}, {1, 1, 0})); assert degree(four) == 2;",
    );
    let reported = faults(
        "field a = sphere({0, 0, 0}, 1); field b = sphere({1, 0, 0}, 1);
         field q = liming(a, b, sphere({0.5, 0, 0}, 0.7), low = {-3, -3, -3}, high = {3, 3, 3});",
    );
    assert!(reported[0].contains("rail-inside") && reported[0].contains("near ("), "{reported:?}");
    let reported = faults(
        "field a = sphere({0, 0, 0}, 1); field b = sphere({1, 0, 0}, 1); field p = plane({1, 0, 0}, {0, 0, 0});
         field q = zhang(a, b, p, plane({0, 1, 0}, {0, 0, 0}), low = {-3, -3, -3}, high = {3, 3, 3});",
    );
    assert!(reported[0].contains("rails-meet"), "{reported:?}");
}

#[test]
fn bad_input_is_told() {
    for (text, id, part) in [
        ("field f = sphere({0,0,0}, 0);", "out-of-range", "radius"),
        ("field f = sphere({0,0,0}, -1);", "out-of-range", "radius"),
        ("field f = sphere({0,0,0}, 1)/0;", "field-division", "divided by a non-zero number"),
        ("field f = sphere({0,0,0}, 1)^0.5;", "field-power", "whole number"),
        ("field f = sphere({0,0,0}, 1)^-1;", "field-power", "whole number"),
        ("field f = plane({0,0,0}, {0,0,0});", "degenerate", "normal"),
        ("float n = 0; field f = sphere({0,0,0}, n/n);", "not-finite", "finite"),
        (
            "field a = sphere({0,0,0}, 1); field f = liming(a, a, a, lambda = 1);",
            "out-of-range",
            "between 0 and 1",
        ),
        (
            "field a = sphere({0,0,0}, 1); field f = liming(a, a, a, lambda = 0);",
            "out-of-range",
            "between 0 and 1",
        ),
        ("set s = set(cylinder(axis, 1)); float v = volume(s);", "unbounded-set", "give a box"),
        ("SetBody b(everything());", "unbounded-set", "give a box"),
        ("SetBody b(nothing());", "empty-set", "empty"),
        (
            "float v = volume(set(sphere({0,0,0}, 1)) & set(sphere({9,0,0}, 1)));",
            "empty-set",
            "empty",
        ),
        ("SetBody b(set(sphere({0,0,0}, 1)), {0,0,0}, {1,1,0});", "empty-box", "no volume"),
        ("SetBody b(set(sphere({0,0,0}, 1)), {0,0,0});", "missing-argument", "two corners"),
        ("SetBody b(set(sphere({0,0,0}, 1)), accuracy = 1e-12);", "too-fine", "boxes"),
        ("SetBody b(set(sphere({0,0,0}, 1)), depth = 16);", "too-fine", "boxes"),
        (
            "SetBody b(set(sphere({0,0,0}, 1)), depth = 4, accuracy = 0.1);",
            "argument-twice",
            "both given",
        ),
        ("set s = set(sphere({0,0,0}, 1)) + 1;", "wrong-operand", "`+`"),
        ("set s = set(sphere({0,0,0}, 1)) ^ 2;", "wrong-operand", "`^`"),
        ("set s = set(sphere({0,0,0}, 1)) | 2;", "wrong-operand", "`|`"),
        ("field s = 3 < sphere({0,0,0}, 1);", "wrong-operand", "`<`"),
        ("field f = floor(sphere({0,0,0}, 1));", "wrong-class", "floor"),
        ("set s = abs(set(sphere({0,0,0}, 1)));", "wrong-class", "takes no set"),
        ("field f = set(sphere({0,0,0}, 1));", "wrong-type", "expected a field, found a set"),
        ("set s = 3;", "wrong-type", "expected a set"),
        ("float d = sphere({0,0,0}, 1)(3);", "wrong-type", "evaluated at a point"),
        ("float t = hit(set(sphere({0,0,0}, 1)), {0,5,0}, {1,0,0});", "no-hit", "does not meet"),
        ("set t = tetrahedron({0,0,0}, {1,0,0}, {0,1,0}, {1,1,0});", "degenerate", "tetrahedron"),
        ("set t = scaled(cuboid({0,0,0}, {1,1,1}), 0);", "degenerate", "map"),
    ] {
        let reported = faults(text);
        let found = reported.first().cloned().unwrap_or_default();
        assert!(found.contains(&format!("[{id}]")) && found.contains(part), "{text}: {reported:?}");
    }
}

#[test]
fn facets_tell_where_they_are_not_the_set() {
    let mut model = open(
        "set pair = cuboid({0, 0, 0}, {1, 1, 1}) | cuboid({1, 1, 0}, {2, 2, 1}); SetBody touching(pair, depth = 4);
         AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(1, 1, 0); Arc a(A, C, B); Line l(B, A); PolyCurve c({a, l});
         SetBody half(extruded(c, {0, 0, 1}), {-1, -1, -0.1}, {3.1, 2, 1.2}, depth = 4);
         SetBody ball(set(sphere({0, 0, 0}, 1)), depth = 4);",
    );
    let reported = reported(&model);
    let about = |id: &str, object: &str| {
        reported
            .iter()
            .any(|d| d.contains(&format!("[{id}]")) && d.contains(&format!("`{object}`")))
    };
    assert!(about("touching-bodies", "touching") && about("blunt-edges", "half"), "{reported:?}");
    assert!(!reported.iter().any(|d| d.contains("`ball`")), "{reported:?}");
    // Places are asked for by the members of these names: the shared edge is along z.
    let places = model.eval("touching.touching").unwrap();
    let Value::Vectors(places) = places else { panic!("{places:?}") };
    assert!(
        places.planes[0].iter().all(|x| (x - 1.0).abs() < 1e-9) && !places.planes[0].is_empty()
    );
    for (text, count) in [("ball.blunt", 0), ("ball.undecided", 0)] {
        let Value::Vectors(none) = model.eval(text).unwrap() else { panic!("{text}") };
        assert_eq!(none.len(), count, "{text}");
    }
}

#[test]
fn sheets_wires_and_points_reach_the_body() {
    let model = sound(
        "field a = sphere({0, 0, 0}, 1); field b = plane({0, 0, 1}, {0, 0, 0.5}); field c = plane({1, 0, 0}, {0, 0, 0});
         set shell = set(abs(a)); set rim = shell & set(abs(b)); set dots = rim & set(abs(c));
         SetBody sheet(shell, {-2,-2,-2}, {2,2,2}, depth = 5); SetBody wire(rim, {-2,-2,-2}, {2,2,2}, depth = 5);
         SetBody dot(dots, {-2,-2,-2}, {2,2,2}, depth = 5);",
    );
    let body = |name: &str| {
        let object = model.graph().get(model.graph().find(name).unwrap()).unwrap();
        let Some(Value::Body(m)) = object.value() else { panic!() };
        m.clone()
    };
    let (sheet, wire, dot) = (body("sheet"), body("wire"), body("dot"));
    assert!((sheet.of_triangles.area - 4.0 * PI).abs() < 0.1 && sheet.wires.is_empty());
    assert_eq!(sheet.groups[0].name, "shell");
    assert!(wire.triangles.is_empty() && wire.wires.len() == 1);
    let length: f64 = wire.wires[0].windows(2).map(|p| p[0].distance(p[1])).sum();
    assert!((length - 2.0 * PI * 0.75f64.sqrt()).abs() < 5e-3, "{length}");
    assert_eq!(dot.dots.len(), 2);
}

#[test]
fn lines_and_points_are_sets() {
    let mut model = sound(
        "param float r = 1 in [0.5, 1.2]; AbsPoint A(-1.7, 0.1, 0.2); AbsPoint B(1.8, -0.2, 0.3); AbsPoint C(0, 1.5, 0);
         Line l(A, B); set rod = set(l); set ball = set(sphere({0, 0, 0}, r)); set both = rod | ball;
         set spot = set(C) | ball; set mark = set({2, 1, 0}); SetBody body(both, depth = 5); SetBody seen(spot, depth = 5);
         set ring = set(abs(sphere({0, 0, 0}, r))) & set(abs(plane({0, 0, 1}, {0, 0, 0.3})));",
    );
    let (a, b) = (vector(&mut model, "A"), vector(&mut model, "B"));
    let (length, d) = (a.distance(b), (b - a) / a.distance(b));
    let half = |r: f64| (r * r - (a.norm_sq() - a.dot(d).powi(2))).sqrt();
    let close = |found: f64, exact: f64| assert!((found - exact).abs() < 1e-6, "{found} {exact}");
    close(number(&mut model, "wire_length(rod)"), length);
    close(number(&mut model, "wire_length(both)"), length - 2.0 * half(1.0));
    close(number(&mut model, "wire_length(rod & ball)"), 2.0 * half(1.0));
    close(number(&mut model, "wire_length(ring)"), 2.0 * PI * 0.91f64.sqrt());
    close(number(&mut model, "volume(both)"), 4.0 * PI / 3.0);
    close(number(&mut model, "volume(rod)"), 0.0);
    let body = |model: &Document, name: &str| {
        let object = model.graph().get(model.graph().find(name).unwrap()).unwrap();
        let Some(Value::Body(m)) = object.value() else { panic!() };
        m.clone()
    };
    assert_eq!(body(&model, "body").wires.len(), 2);
    assert_eq!(body(&model, "seen").dots.len(), 1);
    assert_eq!(number(&mut model, "member(mark, {2, 1, 0}) == \"surface\""), 1.0);
    for (text, exact) in
        [("wire_length(both)", -2.0 / half(1.0)), ("wire_length(ring)", 2.0 * PI / 0.91f64.sqrt())]
    {
        let slope = model.derivatives(&[text.into()], &["r".into()]).unwrap();
        let Value::Number(slope) = slope[0][0] else { panic!() };
        close(slope, exact);
    }
    let reported = faults(
        "AbsPoint A(1, 1, 0); AbsPoint B(2, 0, 0); BCurve bow({O, A, B}); set s = set(bow);",
    );
    assert!(reported[0].contains("[not-straight]"), "{reported:?}");
    let reported = faults("set s = set(\"x\");");
    assert!(reported[0].contains("wrong-class"), "{reported:?}");
}

#[test]
fn a_sheet_on_the_face_of_a_solid_adds_nothing() {
    let mut model = sound(
        "field f = sphere({0, 0, 0}, 1); set both = set(f) | set(abs(f)); set lid = cuboid({0, 0, 0}, {1, 1, 1}) |
         set(abs(plane({0, 0, 1}, {0, 0, 1}))) & cuboid({-1, -1, 0}, {2, 2, 2});",
    );
    let volume = number(&mut model, "volume(both)");
    assert!((volume - 4.0 * PI / 3.0).abs() < 1e-6, "{volume}");
    let volume = number(&mut model, "volume(lid)");
    assert!((volume - 1.0).abs() < 1e-9, "{volume}");
    let area = number(&mut model, "area(both)");
    assert!((area - 4.0 * PI).abs() < 1e-5, "{area}");
}

#[test]
fn implicit_surfaces_serve_projections_and_intersections() {
    let mut model = sound(
        "param float r = 1 in [0.5, 2]; AbsPoint O(0, 0, 0); AbsPoint P(3, 4, 0); AbsPoint A(-2, 0.3, 0.1); AbsPoint B(2, 0.3, 0.1);
         Line l(A, B); field ball = sphere(O, r); ProjPoint foot(P, ball); AbsBead near(l, 0.7); IntBead hit(near, ball);
         ProjCurve arc(l, ball);
         AbsPoint C(-2, -2, 0.2); AbsPoint D(2, -2, 0.3); AbsPoint E(-2, 2, 0.1); AbsPoint F(2, 2, 0.4);
         Line m(C, D); Line n(E, F); RuledSurf sheet(m, n); IntSnake cut(sheet, ball);
         IntSnake again(sheet, O.x + ball*1);",
    );
    assert!((vector(&mut model, "foot") - vector(&mut model, "{0.6, 0.8, 0}")).norm() < 1e-12);
    let hit = vector(&mut model, "hit");
    assert!((hit.norm() - 1.0).abs() < 1e-12 && hit.x > 0.0);
    for t in [0.0, 0.1, 0.37, 0.5, 0.9] {
        for curve in ["arc", "cut"] {
            let p = vector(&mut model, &format!("{curve}({t})"));
            assert!((p.norm() - 1.0).abs() < 1e-10, "{curve}({t}) = {p:?}");
        }
    }
    assert_eq!(number(&mut model, "abs(length(cut) - length(again)) < 1e-9"), 1.0);
    for (text, by) in [
        ("foot.x", "r"),
        ("hit.t", "r"),
        ("arc(0.3).y", "r"),
        ("length(cut)", "r"),
        ("cut(0.3).x", "P.x"),
        ("foot.y", "P.y"),
    ] {
        let exact = model.derivatives(&[text.into()], &[by.into()]).unwrap();
        let Value::Number(exact) = exact[0][0] else { panic!() };
        let start = number(&mut model, by);
        let mut at = |x: f64| {
            model.set(&[(by.into(), x)]).unwrap();
            number(&mut model, text)
        };
        let centred = (at(start + 1e-4) - at(start - 1e-4)) / 2e-4;
        model.set(&[(by.into(), start)]).unwrap();
        assert!(
            (exact - centred).abs() < 1e-6,
            "d({text})/d({by}) = {exact}, differences {centred}"
        );
    }
}

#[test]
fn curves_surfaces_and_bodies_become_fields() {
    let mut model = sound(
        "param float r = 0.25 in [0.1, 0.5]; param float h = 1 in [0.5, 2];
         AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); Line l(A, B);
         field bar = tube(l, r); set rod = set(bar);
         AbsPoint C(0, 2, h); AbsPoint D(2, 2, h); Line m(C, D); AbsPoint E(0, -2, h); AbsPoint F(2, -2, h); Line n(E, F);
         RuledSurf S(n, m); field sheet = plate(S, 0.2); field below = side(S);
         set under = set(below) & cuboid({0.2, -1, 0}, {1.2, 1, 3});
         set box = cuboid({0, 0, 0}, {1, 2, h}); SetBody hull(box, {-1, -1, -1}, {2, 3, 3}, depth = 4);
         field skin = inside(hull); set outer = set(skin - 0.5);",
    );
    // A bar with round ends: pi r^2 l + 4/3 pi r^3.
    let exact = |r: f64| PI * r * r * 2.0 + 4.0 / 3.0 * PI * r.powi(3);
    let volume = "volume(rod, {-1,-1,-1}, {3,1,1}, 1e-5)";
    assert!((number(&mut model, volume) - exact(0.25)).abs() < 1e-3);
    let slope = |model: &mut Document, text: &str, by: &str| {
        let all = model.derivatives(&[text.into()], &[by.into()]).unwrap();
        match all[0][0] {
            Value::Number(x) => x,
            ref other => panic!("{other:?}"),
        }
    };
    let along = (exact(0.2501) - exact(0.2499)) / 2e-4;
    assert!((slope(&mut model, volume, "r") - along).abs() < 1e-2);
    assert!((number(&mut model, "bar({1, 3, 4})") - 4.75).abs() < 1e-12);
    assert!((number(&mut model, "sheet({1, 0, 3})").abs() - 1.9).abs() < 1e-9);
    assert!((slope(&mut model, "sheet({1, 0, 3})", "h") + 1.0).abs() < 1e-9);
    let side = number(&mut model, "below({1, 0.5, 3})");
    assert!((side.abs() - 2.0).abs() < 1e-9);
    let part = number(&mut model, "volume(under, {0,-1.5,-0.5}, {2,1.5,3.5}, 1e-4)");
    assert!((part - 2.0).abs() < 2e-3 || (part - 4.0).abs() < 2e-3, "{part}");
    // Inside a box: exact distances, at faces, edges and corners.
    for (point, distance) in [
        ("{0.5, 1, 0.5}", -0.5),
        ("{2, 1, 0.5}", 1.0),
        ("{2, 3, 0.5}", 2.0f64.sqrt()),
        ("{2, 3, 2}", 3.0f64.sqrt()),
        ("{-1, -1, -1}", 3.0f64.sqrt()),
    ] {
        let found = number(&mut model, &format!("skin({point})"));
        assert!((found - distance).abs() < 1e-9, "{point}: {found}");
    }
    assert!((slope(&mut model, "skin({0.5, 1, 3})", "h") + 1.0).abs() < 1e-9);
    // The body at a distance of 0.5: box, faces, quarter cylinders, a ball.
    let offset = 2.0 + 0.5 * 10.0 + PI * 0.25 * 4.0 + 4.0 / 3.0 * PI * 0.125;
    let found = number(&mut model, "volume(outer, {-1,-1,-1}, {2,3,3}, 1e-3)");
    assert!((found - offset).abs() < 2e-2, "{found} {offset}");
    let open = reported(&open(
        "MeshBody b({{0,0,0}, {1,0,0}, {0,1,0}, {0,0,1}}, {1,3,2, 1,2,4, 2,3,4}); field f = inside(b);",
    ));
    assert!(open[0].contains("not-closed"), "{open:?}");
}

#[test]
fn declared_fields_and_sets_are_renamed_and_deleted() {
    let mut model =
        sound("field f = sphere({0, 0, 0}, 1);\nset s = set(f);\nset t = s & -set(f);\n");
    assert!(model.delete("f").is_err());
    model.rename("f", "ball").unwrap();
    assert!(model.text().contains("field ball = sphere") && model.text().contains("set(ball);"));
    model.delete("t").unwrap();
    assert!(!model.text().contains("set t") && !model.has_errors());
    assert_eq!(model.graph().find("t"), None);
    assert!(model.rename("s", "ball").is_err());
}
