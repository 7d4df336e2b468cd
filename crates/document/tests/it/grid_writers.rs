//! Grid files: plane meshes, boundaries of all types, and what is said of grids that no solver takes.

use crate::common::{ids, open, reported};
use moldloft_document::Document;

const GRID: &str = "surface g[3,3]; for (i=1:3) for (j=1:3) g[i,j] = {i, j, 0};\n";

fn text_of(document: &Document, name: &str) -> String {
    let (_, bytes) = document.written().find(|(own, _)| *own == name).expect("the file");
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn written(text: &str, name: &str) -> String {
    let document = open(text);
    assert!(!document.has_errors(), "{}\n{text}", reported(&document).join("\n"));
    text_of(&document, name)
}

fn said(text: &str, id: &str) {
    let document = open(text);
    assert!(ids(&document).iter().any(|found| found == id), "{:?}\n{text}", reported(&document));
}

/// The area of the cells of a plane mesh of SU2, and the length of each marker.
fn measured(su2: &str) -> (f64, Vec<(String, f64)>) {
    let lines: Vec<Vec<&str>> = su2.lines().map(|l| l.split_whitespace().collect()).collect();
    let at = |word: &str| lines.iter().position(|l| l.first() == Some(&word)).expect("the section");
    let count = |word: &str| lines[at(word)][1].parse::<usize>().unwrap();
    let points: Vec<[f64; 2]> = lines[at("NPOIN=") + 1..][..count("NPOIN=")]
        .iter()
        .map(|l| [l[0].parse().unwrap(), l[1].parse().unwrap()])
        .collect();
    let node = |word: &str| points[word.parse::<usize>().unwrap()];
    let mut area = 0.0;
    for cell in &lines[at("NELEM=") + 1..][..count("NELEM=")] {
        let corners: Vec<[f64; 2]> = cell[1..cell.len() - 1].iter().map(|n| node(n)).collect();
        let own: f64 = (0..corners.len())
            .map(|k| {
                let ([x, y], [u, v]) = (corners[k], corners[(k + 1) % corners.len()]);
                0.5 * (x * v - u * y)
            })
            .sum();
        assert!(own > 0.0, "counter-clockwise: {cell:?}");
        area += own;
    }
    let mut markers = Vec::new();
    for (k, line) in lines.iter().enumerate() {
        if line.first() == Some(&"MARKER_TAG=") {
            let elements = lines[k + 1][1].parse::<usize>().unwrap();
            let length = lines[k + 2..][..elements].iter().map(|edge| {
                assert_eq!(edge[0], "3");
                let ([x, y], [u, v]) = (node(edge[1]), node(edge[2]));
                ((u - x).powi(2) + (v - y).powi(2)).sqrt()
            });
            markers.push((line[1].to_string(), length.sum()));
        }
    }
    markers.sort_by(|a, b| a.0.cmp(&b.0));
    (area, markers)
}

#[test]
fn plane_grids_are_plane_meshes() {
    let names = "\"i1 = inlet inflow, im = outlet outflow, j1 jn = sides wall\"";
    for turned in ["g", "g[::-1,]", "swap(g)", "{g.x, 0*g.x, g.y}", "{7 + 0*g.x, g.x, g.y}"] {
        let grid = turned.starts_with('{').then(|| format!("surface h = {turned};"));
        let shown = if grid.is_some() { "h" } else { turned };
        let text =
            format!("{GRID}{}write_su2(\"a.su2\", {shown}, {names});", grid.unwrap_or_default());
        let (area, markers) = measured(&written(&text, "a.su2"));
        assert_eq!(area, 4.0, "{turned}");
        let lengths: Vec<f64> = markers.iter().map(|(_, length)| *length).collect();
        assert_eq!(lengths, [2.0, 2.0, 4.0], "{turned}: {markers:?}");
    }
    // Two grids with a common edge are one mesh; a pole gives triangles.
    let text = format!(
        "{GRID}surface parts[] = {{g, g + {{2, 0, 0}}}}; write_su2(\"a.su2\", parts, \"j1 jn = sides\");
         surface fan[2,5]; for (j=1:5) fan[2,j] = {{cos(j/4), sin(j/4), 0}}; write_su2(\"fan.su2\", fan, \"im = rim\");
         write_gmsh(\"a.msh\", g, \"i1 = inlet\"); write_blockmesh(\"d\", g, \"i1 = inlet inflow\");"
    );
    let document = open(&text);
    assert!(!document.has_errors(), "{}", reported(&document).join("\n"));
    let both = text_of(&document, "a.su2");
    assert!(both.contains("NPOIN= 15\n"), "{both}");
    assert_eq!(measured(&both).0, 8.0);
    assert!(text_of(&document, "fan.su2").contains("\n5 "), "triangles at the pole");
    let msh = text_of(&document, "a.msh");
    assert!(msh.contains("1 1 \"inlet\"") && msh.contains("\n2 1 3 4\n"), "{msh}");
    let dict = text_of(&document, "d");
    assert!(
        dict.contains("frontAndBack\n{\n    type empty;") && dict.contains("scale 1;"),
        "{dict}"
    );
    said(&format!("{GRID}g[2,2].z = 1; write_su2(\"a.su2\", g);"), "cannot-write");
}

#[test]
fn lists_of_blocks_are_written_one_by_one() {
    let text = format!(
        "{GRID}subroutine all(string n, surface x...) {{ write_p3d(n, \"text\", x); }} all(\"two.x\", g, g + {{5,0,0}});
         block b[2]; for (k=1:2) b[k] = stack(g, g + {{0,0,1}}) + {{0,0,k-1}};
         write_blockmesh(\"d\", b, {{\"k1 = floor wall\", \"kn = roof wall\"}}); write_p3d(\"b.x\", \"text\", b);"
    );
    let document = open(&text);
    assert!(!document.has_errors(), "{}", reported(&document).join("\n"));
    let head = |name: &str, n: usize| -> Vec<String> {
        text_of(&document, name).split_whitespace().take(n).map(str::to_string).collect()
    };
    assert_eq!(head("two.x", 7), ["2", "3", "3", "1", "3", "3", "1"]);
    assert_eq!(head("b.x", 7), ["2", "3", "3", "2", "3", "3", "2"]);
    let dict = text_of(&document, "d");
    assert!(dict.contains("floor") && dict.contains("roof") && dict.matches("hex").count() == 8);
    said(&format!("{GRID}write_su2(\"a\", {{g, g}}, {{\"i1 = a\"}});"), "shapes-differ");
}

#[test]
fn periodic_boundaries_belong_together() {
    let dict = written(
        &format!(
            "{GRID}block b = {{g, g + {{0,0,1}}}}; write_blockmesh(\"d\", b, \"k1 = low periodic, kn = high periodic\");"
        ),
        "d",
    );
    assert!(dict.contains("type cyclic;\n    neighbourPatch high;\n    transform translational;\n    separationVector (0.0 0.0 1.0);"), "{dict}");
    let sector = "surface s[3,3], t[3,3]; for (i=1:3) for (j=1:3) { s[i,j] = {i, j, 0}; t[i,j] = {i, j*cos(.3), j*sin(.3)}; }
                  block b = {s, t}; write_blockmesh(\"d\", b, \"k1 = low periodic, kn = high periodic\");";
    let dict = written(sector, "d");
    assert!(dict.contains("transform rotational;\n    rotationAxis (1 0 0);"), "{dict}");
    let other = format!(
        "{GRID}block b = {{g, 2*g + {{0,0,1}}}}; write_blockmesh(\"d\", b, \"k1 = low periodic, kn = high periodic\");"
    );
    said(&other, "cannot-write");
    said(
        &format!(
            "{GRID}block b = {{g, g + {{0,0,1}}}}; write_cgns(\"d\", b, \"k1 = low periodic\");"
        ),
        "cannot-write",
    );
}

/// Movements that map the points of two sides onto each other, with the cells of both on the same
/// side of the image, make no pair.
#[test]
fn periodic_sides_face_each_other() {
    let stacked = "surface g[3,3]; for (i=1:3) for (j=1:3) g[i,j] = {i - 1, j - 1, 0};
                   block a = {g, g + {0,0,1}}, b = a + {0,2,0}; ";
    // The lower sides are as far apart as the upper ones.
    let one = written(
        &format!(
            "{stacked}write_blockmesh(\"d\", a, \"i1 = low periodic, in = high periodic\", b, \"i1 = low periodic, in = high periodic\");"
        ),
        "d",
    );
    assert!(one.contains("neighbourPatch high;\n    transform translational;\n    separationVector (2.0 0.0 0.0);"), "{one}");
    let apart = format!(
        "{stacked}write_blockmesh(\"d\", a, \"i1 = p periodic, in = q periodic\", b, \"i1 = r periodic, in = s periodic\");"
    );
    said(&apart, "cannot-write");
    let lower =
        format!("{stacked}write_blockmesh(\"d\", a, \"i1 = p periodic\", b, \"i1 = q periodic\");");
    said(&lower, "cannot-write");
    // Its lower sides are turned onto each other about the axes, too.
    let cube = "surface g[3,3]; for (i=1:3) for (j=1:3) g[i,j] = {i - 1, j - 1, 0}; block a = {g, g + {0,0,1}, g + {0,0,2}};
                write_blockmesh(\"d\", a, \"i1 = west periodic, j1 = south periodic, k1 = down periodic, in = east periodic, jn = north periodic, kn = up periodic\");";
    let cube = written(cube, "d");
    for (name, partner, by) in [
        ("west", "east", "2.0 0.0 0.0"),
        ("south", "north", "0.0 2.0 0.0"),
        ("up", "down", "0.0 0.0 -2.0"),
    ] {
        let entry = format!(
            "{name}\n{{\n    type cyclic;\n    neighbourPatch {partner};\n    transform translational;\n    separationVector ({by});"
        );
        assert!(cube.contains(&entry), "{cube}");
    }
    // The ends of half a ring are equal up to a shift, which leaves both cells below.
    let half = "surface g[5,3]; for (i=1:5) for (j=1:3) { g[i,j] = {(j + 1)*cos(PI*(i - 1)/4), (j + 1)*sin(PI*(i - 1)/4), 0}; }
                write_blockmesh(\"d\", g, \"i1 = low periodic, im = high periodic\");";
    let half = written(half, "d");
    assert!(half.contains("transform rotational;\n    rotationAxis (0 0 1);"), "{half}");
}

#[test]
fn what_no_solver_takes_is_said() {
    let folded = format!("{GRID}g[2,2] = {{4, 4, 0}}; block b = {{g, g + {{0,0,1}}}}; ");
    for write in [
        "write_su2(\"f\", b)",
        "write_p3d(\"f\", b)",
        "write_cgns(\"f\", b)",
        "write_vts(\"f\", g)",
    ] {
        said(&format!("{folded}{write};"), "folded-grid");
    }
    let left = format!("{GRID}block b = {{g + {{0,0,1}}, g}}; ");
    said(&format!("{left}write_p3d(\"f\", b);"), "left-handed");
    said(&format!("{left}write_cgns(\"f\", b, \"k1 = a\");"), "left-handed");
    let pair = |n: usize, gap: &str| {
        format!(
            "surface a[5,5], b[{n},5]; for (i=1:5) for (j=1:5) a[i,j] = {{i-1, j-1, 0}};
             for (i=1:{n}) for (j=1:5) b[i,j] = {{4*(i-1)/{}, j+3+{gap}, 0}};
             block ba = {{a, a+{{0,0,1}}}}, bb = {{b, b+{{0,0,1}}}}; write_su2(\"n\", ba, \"k1 kn = s\", bb, \"k1 kn = s\");",
            n - 1
        )
    };
    said(&pair(9, "0"), "cannot-write");
    said(&pair(8, "0"), "not-joined");
    said(&pair(5, "1e-8"), "not-joined");
    let met = open(&pair(5, "0"));
    assert_eq!(ids(&met), ["nameless"], "{:?}", reported(&met));
    let curved = format!("{GRID}g.z = 0.2*sin(g.x); block b = {{g, g + {{0,0,1}}}}; ");
    said(&format!("{curved}write_blockmesh(\"d\", b, \"k1 = sym symmetry\");"), "not-plane");
    said(&format!("{curved}write_cgns(\"d\", b, \"k1 = sym symmetry\");"), "not-plane");
    let two = written(
        &format!(
            "{GRID}block b = {{g, g + {{0,0,1}}}}; write_blockmesh(\"d\", b, \"k1 kn = ends symmetry\");"
        ),
        "d",
    );
    assert!(two.contains("type symmetry;") && !two.contains("symmetryPlane"), "{two}");
    let one = written(
        &format!(
            "{GRID}block b = {{g, g + {{0,0,1}}}}; write_blockmesh(\"d\", b, \"k1 = end symmetry\");"
        ),
        "d",
    );
    assert!(one.contains("type symmetryPlane;"), "{one}");
}

#[test]
fn families_contain_their_coarse_grids() {
    for law in [
        "d_tanh(0, 1, refined_step(.01), 0, refined(25))",
        "d_tanhx(0, 1, refined_step(.01), refined_step(.02), refined(25))",
        "d_tanhx(0, 1, refined_step(.01), 0, refined(25))",
        "d_sinh(0, 1, refined_step(.01), 0, refined(25))",
        "geometric(0, 1, refined_step(.01), refined(25))",
        "geometric2(0, 1, refined_step(.01), refined_step(.005), refined(25))",
        "cosine(0, 1, refined(25))",
        "uniform(0, 1, refined(25))",
        "redist(geometric(0, 1, .01, 20), refined(25))",
        "redist(d_tanh(0, 1, refined_step(.01), 0, refined(25)), refined(13))",
    ] {
        let mut rows = Vec::new();
        for level in 0..3 {
            let mut document = open(&format!("farray a = {law};"));
            document.refine(level).unwrap();
            assert!(document.diagnostics().is_empty(), "{law}: {:?}", reported(&document));
            let moldloft_registry::Value::Numbers(a) = document.eval("a").unwrap() else {
                panic!()
            };
            assert!(a.items.windows(2).all(|pair| pair[1] > pair[0]), "{law}");
            rows.push(a.items.clone());
        }
        for (level, row) in rows.iter().enumerate() {
            let off = rows[0].iter().enumerate().map(|(k, x)| (row[k << level] - x).abs());
            assert!(off.fold(0.0, f64::max) < 1e-15, "{law} at {level}");
        }
    }
    for law in [
        "geometric(0, 1, .01, refined(25))",
        "redist(d_tanh(0, 1, refined_step(.01), 0, refined(25)), refined(17))",
    ] {
        let mut document = open(&format!("farray a = {law};"));
        assert!(document.diagnostics().is_empty());
        document.refine(1).unwrap();
        assert_eq!(ids(&document), ["not-nested"], "{law}");
    }
}
