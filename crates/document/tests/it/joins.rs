//! Divisions along chains of patches, vertices shared by identity, and what is reported for joins.

use crate::common::{Random, WATER, ids, open, reported, rounds, sound};
use moldloft_document::{Document, Panelled};
use moldloft_num::Vec3;
use moldloft_panel::PanelNote;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::sync::Arc;

fn panelled(document: &mut Document) -> Arc<Panelled> {
    document.panelled().unwrap_or_else(|d| panic!("{}", d.message))
}

/// The divisions of a patch of the mesh.
fn divisions(document: &mut Document, name: &str) -> [usize; 2] {
    let panelled = panelled(document);
    let patch = panelled.mesh.patches().iter().find(|p| p.info.name == name);
    let block = patch.and_then(|p| p.block.as_ref()).expect("a patch of that name");
    [block.nu - 1, block.nv - 1]
}

/// Four lines above each other, and the strips between them with the given arguments.
fn strips(arguments: [&str; 3]) -> String {
    let mut text = String::new();
    for k in 0..4 {
        let _ = writeln!(
            text,
            "AbsPoint A{k}(0, {k}, 0); AbsPoint B{k}(4, {k}, 1); Line l{k}(A{k}, B{k});"
        );
    }
    for (k, arguments) in arguments.iter().enumerate() {
        let _ = writeln!(text, "RuledSurf S{k}(l{k}, l{}{arguments});", k + 1);
    }
    text
}

#[test]
fn counts_flow_from_patch_to_patch() {
    let mut d = sound(&strips([", divisions = {10, 4}", ", divisions = {0, 3}", ""]));
    assert_eq!(divisions(&mut d, "S0"), [10, 4]);
    assert_eq!(divisions(&mut d, "S1"), [10, 3]);
    assert_eq!(divisions(&mut d, "S2"), [10, 8]);
    let report = panelled(&mut d).mesh.report();
    assert_eq!((report.components, report.open_loops.len()), (1, 1));
    // Both ways, and by a word.
    let mut d = sound(&strips(["", ", divisions = \"auto\"", ", divisions = {7, \"auto\"}"]));
    assert_eq!(divisions(&mut d, "S0"), [7, 8]);
    assert!(d.diagnostics().is_empty());
}

#[test]
fn contradictions_are_told_with_the_chain() {
    let mut d = open(&strips([", divisions = {10, 4}", "", ", divisions = {12, 5}"]));
    let p = panelled(&mut d);
    let [PanelNote::Divisions { chain, divisions: [10, 12] }] = p.panelling.remarks() else {
        panic!("{:?}", p.panelling.remarks())
    };
    let names: Vec<_> =
        chain.iter().map(|s| (s.patch.as_str(), s.along, s.shares.as_str())).collect();
    assert_eq!(
        names,
        [
            ("S0", 'u', "the line from `A1` to `B1`"),
            ("S1", 'u', "the line from `A2` to `B2`"),
            ("S2", 'u', "")
        ]
    );
    assert_eq!(ids(&d), ["divisions-contradict"]);
    assert_eq!(
        d.diagnostics()[0].message,
        "`S0` has 10 divisions along u and `S2` has 12 along u, but panels run on from one to the \
         other: `S0` along u, joined by the line from `A1` to `B1` to `S1` along u, joined by the \
         line from `A2` to `B2` to `S2` along u"
    );
    // The rest is joined.
    assert_eq!(p.mesh.report().components, 2);
}

/// A strip between `l` and `m`, and below it two that share `l` between them, meeting at a bead.
fn parts(whole: &str, first: &str, second: &str) -> String {
    format!(
        "param float t = 0.3 in [0.1, 0.9];
         AbsPoint A(0, 0, 0); AbsPoint M(1, 0.7, 0.2); AbsPoint B(4, 0, 1); BCurve l({{A, M, B}});
         AbsPoint C(0, 1, 0); AbsPoint D(4, 1, 1); Line m(C, D);
         AbsBead a(l, 0); AbsBead b(l, t); AbsBead c(l, 1);
         SubCurve l1(a, b); SubCurve l2(c, b);
         AbsPoint E(0, -1, 0); AbsPoint F(2, -1, 0); AbsPoint G(4, -1, 0); Line n1(E, F); Line n2(G, F);
         RuledSurf S(l, m{whole}); RuledSurf S1(l1, n1{first}); RuledSurf S2(l2, n2{second});"
    )
}

#[test]
fn a_bead_in_the_middle_of_an_edge_is_a_vertex_of_it() {
    let mut d = sound(&parts(", divisions = {10, 3}", ", divisions = {4, 2}", ""));
    // Along v the second has the first's two: they share the line from the bead down.
    assert_eq!(divisions(&mut d, "S2"), [6, 2]);
    let p = panelled(&mut d);
    assert!(p.panelling.remarks().is_empty());
    let report = p.mesh.report();
    assert_eq!((report.components, report.open_loops.len(), report.euler), (1, 1, 1));
    let bead = crate::common::vector(&mut d, "b");
    let hits = p.mesh.positions().iter().filter(|q| **q == bead).count();
    assert_eq!(hits, 1, "one vertex, exactly at the bead");
    // The end points of the curve and the beads at its ends are one vertex each.
    for corner in [Vec3::zero(), Vec3::of(4.0, 0.0, 1.0)] {
        assert_eq!(p.mesh.positions().iter().filter(|q| **q == corner).count(), 1);
    }
    // From the parts to the whole, and shared out by length when nobody says anything.
    let mut d = sound(&parts("", ", divisions = {4, 2}", ", divisions = {3, 2}"));
    assert_eq!(divisions(&mut d, "S"), [7, 8]);
    let mut d = sound(&parts(", divisions = {10, 3}", "", ""));
    let (n, m) = (divisions(&mut d, "S1")[0], divisions(&mut d, "S2")[0]);
    assert!(n + m == 10 && n < m && n >= 2, "{n} + {m}");
    assert!(panelled(&mut d).panelling.remarks().is_empty());
    // Pieces that do not add up.
    let mut d =
        open(&parts(", divisions = {10, 3}", ", divisions = {4, 2}", ", divisions = {5, 2}"));
    let p = panelled(&mut d);
    assert_eq!(
        p.panelling.remarks()[0].to_string(),
        "`S` has 10 divisions along u, but the pieces of its edge have 4 (`l`) + 5 (`l`)"
    );
    assert_eq!(p.panelling.remarks().len(), 1, "positions at the bead are not compared");
}

#[test]
fn counts_stay_when_a_parameter_moves_the_bead() {
    let text = parts(", divisions = {10, 3}", "", "");
    let mut d = sound(&text);
    let at_home = panelled(&mut d).panelling.topology().clone();
    for t in [0.11, 0.5, 0.89, 0.3] {
        d.set(&[("t".into(), t)]).unwrap();
        let p = panelled(&mut d);
        assert_eq!(*p.panelling.topology(), at_home, "at t = {t}");
        assert!(p.panelling.remarks().is_empty());
        let bead = crate::common::vector(&mut d, "b");
        assert!(p.mesh.positions().contains(&bead));
        // The same as from the text, opened and set at once.
        let mut fresh = sound(&text);
        fresh.set(&[("t".into(), t)]).unwrap();
        assert_eq!(panelled(&mut fresh).mesh, p.mesh);
    }
}

#[test]
fn vertices_follow_the_bead_with_their_derivatives() {
    let mut d = sound(&parts(", divisions = {6, 3}", ", divisions = {2, 2}", ""));
    let exact = d.jacobian(&["t".into()]).unwrap();
    let h = 1e-5;
    let mut at = |t: f64| {
        d.set(&[("t".into(), t)]).unwrap();
        panelled(&mut d).mesh.positions().to_vec()
    };
    let (low, high) = (at(0.3 - h), at(0.3 + h));
    let mut moved = 0;
    for (k, d) in exact[0].iter().enumerate() {
        let difference = (high[k] - low[k]) / (2.0 * h);
        assert!(d.distance(difference) < 1e-6, "vertex {k}: {d:?}, {difference:?}");
        moved += usize::from(d.norm() > 0.1);
    }
    assert!(moved > 6);
}

#[test]
fn sizes_and_spacings() {
    let mut d = sound(&strips([", size = 0.5", "", ", size = {9, 0.25}"]));
    // The longest of the lines along u is sqrt(17).
    assert_eq!(divisions(&mut d, "S0"), [9, 2]);
    assert_eq!(divisions(&mut d, "S2"), [9, 4]);
    let cosine = ", divisions = {4, 2}, spacing = {\"cosine\", \"uniform\"}";
    let mut d = sound(&strips(["", cosine, ""]));
    let p = panelled(&mut d);
    let wanted: Vec<f64> =
        (0..=4).map(|i| 2.0 * (1.0 - (i as f64 / 4.0 * std::f64::consts::PI).cos())).collect();
    for (name, rows) in [("S0", 9), ("S1", 3), ("S2", 9)] {
        let patch = p.mesh.patches().iter().find(|p| p.info.name == name).unwrap();
        let block = patch.block.as_ref().unwrap();
        for i in 0..=4 {
            for j in 0..rows {
                let x = p.mesh.positions()[block.at(i, j) as usize].x;
                assert!((x - wanted[i]).abs() < 1e-12, "the spacing runs through the chain");
            }
        }
    }
    assert!(p.panelling.remarks().is_empty());
    // A neighbour with a law of its own keeps it away from the shared edge.
    let mut d = sound(&strips([", divisions = {4, 2}, spacing = \"cosine\"", ", spacing = 2", ""]));
    let p = panelled(&mut d);
    assert!(p.panelling.remarks().is_empty(), "{:?}", p.panelling.remarks());
    assert_eq!(p.mesh.report().components, 1);
    let block = p.mesh.patches()[1].block.as_ref().unwrap();
    let x = |i: usize, j: usize| p.mesh.positions()[block.at(i, j) as usize].x;
    assert!((x(1, 0) - wanted[1]).abs() < 1e-12);
    assert!((x(1, 8) - 4.0 / 15.0).abs() < 1e-12, "1, 2, 4 and 8 fifteenths");
    for (wrong, id) in [
        ("size = -1", "out-of-range"),
        ("size = {1, 2, 3}", "wrong-length"),
        ("spacing = \"cosinus\"", "unknown-word"),
        ("spacing = 50", "out-of-range"),
        ("divisions = \"any\"", "wrong-class"),
        ("divisions = {-1, 2}", "out-of-range"),
        ("tags = {\"wet hull\"}", "out-of-range"),
        ("tags = 3", "wrong-class"),
    ] {
        let d = open(&strips([&format!(", {wrong}"), "", ""]));
        assert_eq!(ids(&d), [id], "{wrong}: {:?}", reported(&d));
    }
}

#[test]
fn a_full_turn_and_its_poles_are_joined() {
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 1); AbsPoint C(0, 0, 2); BCurve c({A, B, C});
        Line axis(A, C); RevSurf R(c, axis, divisions = {6, 12}, spacing = {\"cosine\", 1.1});";
    let mut d = sound(text);
    let p = panelled(&mut d);
    let report = p.mesh.report();
    assert!(report.closed && report.manifold && report.oriented && report.outward == Some(true));
    assert_eq!(report.vertices, 5 * 12 + 2);
}

/// A surface cut into bands by snakes, each band into patches at places of its own, so that corners
/// lie in the middle of neighbours' edges, marked by rings; some patches state counts.
fn bands(random: &mut Random, bands: usize, stated: usize) -> String {
    let mut text = String::from(
        "AbsPoint P(0, 0, 0); AbsPoint Q(2, 1, 0); AbsPoint R(4, 0, 0); AbsPoint S(0, 0, 2); \
         AbsPoint T(4, 1, 3); BCurve p({P, Q, R}); Line q(S, T); RuledSurf base(p, q, visible = 0);\n",
    );
    for j in 0..=bands {
        let v = j as f64 / bands as f64;
        let _ = writeln!(
            text,
            "AbsMagnet a{j}(base, 0, {v}); AbsMagnet b{j}(base, 1, {v}); LineSnake s{j}(a{j}, b{j}); \
             AbsRing r{j}_0(s{j}, 0); AbsRing r{j}_1(s{j}, 1);"
        );
    }
    for j in 0..bands {
        let cuts = random.below(4);
        // Rings on the lower and upper snake; the names of those at both ends are common.
        let mut rings = vec![(format!("r{j}_0"), format!("r{}_0", j + 1))];
        for k in 0..cuts {
            let t = (k as f64 + 0.2 + 0.6 * random.decimal(0.0, 1.0)) / cuts as f64;
            let _ =
                writeln!(text, "AbsRing c{j}_{k}(s{j}, {t}); AbsRing d{j}_{k}(s{}, {t});", j + 1);
            rings.push((format!("c{j}_{k}"), format!("d{j}_{k}")));
        }
        rings.push((format!("r{j}_1"), format!("r{}_1", j + 1)));
        for (k, (low, high)) in rings.iter().enumerate() {
            let _ = writeln!(text, "LineSnake w{j}_{k}({low}, {high});");
        }
        for (k, pair) in rings.windows(2).enumerate() {
            let ((a, d), (b, c)) = (&pair[0], &pair[1]);
            let _ = writeln!(text, "SubSnake e{j}_{k}({a}, {b}); SubSnake f{j}_{k}({d}, {c});");
            let turned = random.chance(50);
            let (low, high, west, east) = (
                format!("e{j}_{k}"),
                format!("f{j}_{k}"),
                format!("w{j}_{k}"),
                format!("w{j}_{}", k + 1),
            );
            let sides = if turned {
                format!("{{{west}, {high}, {east}, {low}}}")
            } else {
                format!("{{{low}, {east}, {high}, {west}}}")
            };
            let orientation = u8::from(turned);
            let divisions = if random.below(100) < stated {
                let (n, m) = (random.below(6), random.below(6));
                format!(", divisions = {{{n}, {m}}}")
            } else {
                String::new()
            };
            let _ = writeln!(
                text,
                "SubSurf x{j}_{k}({sides}, orientation = {orientation}{divisions});"
            );
        }
    }
    text
}

#[test]
fn random_bands_join_or_say_why() {
    let mut random = Random::new(0x10a5);
    let mut explained = 0;
    for round in 0..rounds(5000) {
        let stated = [0, 0, 15, 60][round % 4];
        let text = bands(&mut random, 1 + round % 6, stated);
        let mut d = sound(&text);
        let p = panelled(&mut d);
        let report = p.mesh.report();
        let remarks = p.panelling.remarks();
        assert!(report.branching_edges == 0 && report.oriented, "{text}");
        if stated == 0 {
            assert!(remarks.is_empty(), "{remarks:?}\n{text}");
        }
        if remarks.is_empty() {
            assert_eq!((report.components, report.open_loops.len()), (1, 1), "{text}");
            assert!(report.manifold, "{text}");
            // The rim alone is open: no T-junctions.
            let rim = report.open_loops[0].edge_count();
            assert_eq!(report.euler, 1, "a disc");
            assert!(rim >= 4);
        } else {
            assert!(
                report.components > 1 || report.euler != 1 || report.open_loops.len() > 1,
                "{text}"
            );
            explained += 1;
        }
        // The mesh does not depend on how many threads made it, nor on the way to the model.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1 + round % 3).build().unwrap();
        let again = pool.install(|| panelled(&mut sound(&text)));
        assert_eq!(again.mesh, p.mesh);
    }
    assert!(explained > 0);
}

/// A stern of two strips with a transom whose outline has a knuckle; its halves are 3 and 3 panels.
fn stern(outline: &str, divisions: u32) -> String {
    format!(
        "Model info(symmetry = \"y\");
         AbsPoint k0(0, 0, -0.8); AbsPoint c0(0, 0, -0.2); AbsPoint d0(0, 0, 1);
         AbsPoint k1(10, 0, -1); AbsPoint c1(10, 1.5, -0.5); AbsPoint d1(10, 2, 1); AbsPoint m1(10, 0, 1);
         Line K(k0, k1); Line C(c0, c1); Line S(d0, d1); Line M(d0, m1); Line Z(k1, m1); {outline}
         RuledSurf bottom(K, C, divisions = {{12, 3}}); RuledSurf side(C, S, divisions = {{12, 3}});
         RuledSurf deck(S, M, divisions = {{12, 3}}); RuledSurf transom(Z, T, divisions = {{{divisions}, 3}});"
    )
}

#[test]
fn contradictory_counts_open_the_panels_and_not_the_body() {
    use moldloft_document::{FloatRequest, Immersion};
    let outline = "Line t1(k1, c1); Line t2(c1, d1); PolyCurve T({t1, t2});";
    let mut answers = Vec::new();
    for divisions in [6, 12, 5, 2] {
        let mut d = open(&stern(outline, divisions));
        let reported = ids(&d);
        d.panelled().unwrap();
        assert_eq!(d.entire().is_err(), divisions != 6);
        d.allow_partial(true);
        let contradicts = d.diagnostics().iter().any(|x| x.id == "divisions-contradict");
        assert_eq!(contradicts, divisions != 6, "{divisions}: {reported:?}");
        // What is said by the counts is not said again by the corners.
        assert_eq!(d.junctions().unwrap(), [], "{divisions}");
        let request = |heel| FloatRequest { immersion: Immersion::Level(0.2), trim: 0.0, heel };
        let requests = [request(0.0), request(0.3)];
        let found = d.floating(&requests, WATER, &[]).unwrap();
        for answer in &found {
            assert_eq!(answer.open_edges, 0, "{divisions}");
            assert!(answer.figures.iter().all(|(name, _)| *name != "freeboard"), "{divisions}");
        }
        // Form coefficients are those of the upright body.
        let has = |k: usize| found[k].figures.iter().any(|(name, _)| *name == "cb");
        assert!(has(0) && !has(1));
        answers.push(found.into_iter().map(|a| a.figures).collect::<Vec<_>>());
    }
    assert!(answers.windows(2).all(|w| w[0] == w[1]), "{answers:?}");
}

#[test]
fn a_polyline_is_the_lines_between_its_points() {
    for outline in [
        "BCurve T({k1, c1, d1}, degree = 1);",
        "CCurve T({k1, c1, d1}, degree = 1);",
        // A part of a longer one, run backwards.
        "BCurve W({m1, d1, c1, k1}, degree = 1); AbsBead a(W, 1); AbsBead b(W, 1/3.); SubCurve T(a, b);",
    ] {
        let mut d = sound(&stern(outline, 6));
        assert_eq!(d.junctions().unwrap(), [], "{outline}");
        let report = panelled(&mut d).mesh.report();
        assert!(report.manifold && report.components == 1, "{outline}");
        assert_eq!(report.open_loops.len(), 1, "open in the plane of symmetry alone: {outline}");
    }
}

#[test]
fn corners_that_miss_their_neighbours_are_told() {
    // Two strips below a third meet at points that lie on its edge but mark nothing there.
    let text = |middle: &str| {
        format!(
            "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(4, 1, 0);
             AbsPoint M(1.4, 0, 0);
             AbsPoint E(0, -1, 0); AbsPoint F(4, -1, 0); AbsPoint G(2, -1, 0);
             Line ab(A, B); Line cd(C, D); Line ef(E, G); Line gf(G, F); {middle}
             RuledSurf top(ab, cd, divisions = {{10, 2}});
             RuledSurf left(am, ef, divisions = {{4, 2}}); RuledSurf right(mb, gf, divisions = {{6, 2}});"
        )
    };
    let mut d = sound(&text("Line am(A, M); Line mb(M, B);"));
    let reported = d.junctions().unwrap();
    let said: Vec<_> = reported.iter().map(|t| t.message.as_str()).collect();
    let (id, first) = (
        &reported[0].id,
        "the corner (u, v) = (1, 0) of `left` is in the middle of edge v = 0 of \
         `top` at u = 0.350000 but is not joined to it, at (1.4, 0, 0)",
    );
    assert!(id == "corner-not-joined" && said.contains(&first), "{said:?}");
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(d.panelled().unwrap().mesh.report().open_loops.len() > 1);
    // The lines of the remedy mend it.
    let remedy: String = reported
        .iter()
        .map(|t| t.help.first().and_then(|help| help.split('`').nth(1)).unwrap_or_default())
        .collect();
    assert_eq!(remedy.matches("Join ").count(), 2, "{remedy}");
    let mut d = sound(&(text("Line am(A, M); Line mb(M, B);") + &remedy));
    assert_eq!(d.junctions().unwrap(), [], "{remedy}");
    assert_eq!(d.panelled().unwrap().mesh.report().euler, 1, "a disc");
    let marked = "AbsBead m(ab, 0.35); AbsBead a(ab, 0); AbsBead b(ab, 1); SubCurve am(a, m); SubCurve mb(m, b);";
    let mut d = sound(&text(marked));
    assert_eq!(d.junctions().unwrap().len(), 0);
    assert_eq!(d.panelled().unwrap().mesh.report().euler, 1, "a disc");
}

/// Two strips of their own points along one edge of a third, which is a line or a curve of three points.
fn strips_at_an_edge(lines: [&str; 2], joins: &str, counts: [&str; 3]) -> String {
    let [am, mb] = lines;
    let [top, left, right] = counts;
    format!(
        "param float t = 0.35 in [0.05, 0.95]; param float h = 1 in [0.5, 3];
         AbsPoint A(0, 0, 0); AbsPoint B(4, 0, h); AbsPoint C(0, 1, 0); AbsPoint D(4, 1, 0);
         AbsPoint O(0, 0, 0); AbsPoint M(4 * t, 0, h * t); AbsPoint N(4, 0, h);
         AbsPoint E(0, -1, 0); AbsPoint F(4, -1, 0); AbsPoint G(2, -1, 0);
         Line ab(A, B); Line cd(C, D); Line ef(E, G); Line gf(G, F); {am} {mb}
         RuledSurf top(ab, cd{top}); RuledSurf left(am, ef{left}); RuledSurf right(mb, gf{right});
         AbsBead a(ab, 0); AbsBead m(ab, t); AbsBead b(ab, 1); SubCurve am0(a, m); SubCurve bm0(b, m);
         {joins}"
    )
}

/// A whole edge is joined to a part of another: the corner between two neighbours is a vertex of the
/// third's edge at all values of the parameters, with the same numbers.
#[test]
fn whole_edges_join_parts_of_others() {
    let counts = [
        [", divisions = {10, 2}", ", divisions = {4, 2}", ""],
        ["", ", divisions = {4, 2}", ", divisions = {6, 2}"],
        [", divisions = {7, 3}", "", ""],
    ];
    let lines = ["Line am(O, M); Line mb(M, N);", "Line am(M, O); Line mb(N, M);"];
    let joins = [
        "Join j(left.v0, am0); Join k(right.v0, bm0);",
        "Join j(am0, left.v0); Join k(bm0, right.v0);",
        "EdgeSnake e(1, left); Join k(right.v0, bm0); Join j(e, am0); Join g(left.u1, right.u0);",
        "Join g(right.u0, left.u1); Join j(left.v0, am0); Join k(right.v0, bm0);",
    ];
    for (n, (line, join)) in lines.iter().flat_map(|l| joins.map(|j| (l, j))).enumerate() {
        let line = line.split_inclusive(';').collect::<Vec<_>>();
        // Turned strips meet at their other ends.
        let join = if n < joins.len() {
            join.to_string()
        } else {
            join.replace("left.u1, right.u0", "left.u0, right.u1")
                .replace("right.u0, left.u1", "right.u1, left.u0")
        };
        let foot = if n < joins.len() { "" } else { "turned" };
        for counts in counts {
            let mut text = strips_at_an_edge([line[0], line[1]], &join, counts);
            if foot == "turned" {
                text =
                    text.replace("Line ef(E, G); Line gf(G, F);", "Line ef(G, E); Line gf(F, G);");
            }
            let mut d = sound(&text);
            let at_home = panelled(&mut d).panelling.topology().clone();
            for k in 0..40 {
                let t = 0.06 + 0.0221 * f64::from(k);
                d.set(&[("t".into(), t), ("h".into(), 0.5 + 0.06 * f64::from(k))]).unwrap();
                let p = panelled(&mut d);
                assert_eq!(*p.panelling.topology(), at_home, "{text} at {t}");
                assert!(p.panelling.remarks().is_empty(), "{:?}", p.panelling.remarks());
                let junctions = d.junctions().unwrap();
                assert!(junctions.is_empty(), "{junctions:?}");
                let report = p.mesh.report();
                assert_eq!((report.components, report.open_loops.len(), report.euler), (1, 1, 1));
            }
            d.set(&[("h".into(), 1.0)]).unwrap();
            vertices_have_their_derivatives(&mut d);
        }
    }
    let apart = strips_at_an_edge(["Line am(O, M);", "Line mb(M, N);"], joins[0], counts[0])
        .replace("AbsPoint M(4 * t,", "AbsPoint M(4 * t + 0.1,");
    let d = open(&apart);
    assert!(ids(&d).contains(&"edges-apart".to_string()), "{:?}", ids(&d));
    let parts =
        strips_at_an_edge(["Line am(O, M);", "Line mb(M, N);"], "Join j(am0, bm0);", counts[0]);
    assert!(ids(&open(&parts)).contains(&"not-an-edge".to_string()));
}

/// Derivatives of the mesh by `t` at 0.35 against central differences.
fn vertices_have_their_derivatives(d: &mut Document) {
    d.set(&[("t".into(), 0.35)]).unwrap();
    let exact = d.jacobian(&["t".into()]).unwrap();
    let mut at = |t: f64| {
        d.set(&[("t".into(), t)]).unwrap();
        panelled(d).mesh.positions().to_vec()
    };
    let (low, high) = (at(0.35 - 1e-5), at(0.35 + 1e-5));
    for (k, d) in exact[0].iter().enumerate() {
        let difference = (high[k] - low[k]) / 2e-5;
        assert!(d.distance(difference) < 1e-6, "vertex {k}: {d:?}, {difference:?}");
    }
}

/// A patch along the whole of a curved or straight edge, and two beside parts of it that are drawn through
/// the bead between them: curves by the theorem of de Casteljau, straight lines without a join.
fn beside_parts(curved: bool, joins: &str) -> String {
    let (edge, parts) = if curved {
        (
            "BCurve edge({O, M, N}, degree = 2);",
            "AbsPoint q1(2 * t, 1.2 * t, 0); AbsPoint q2(2 + 2 * t, 1.2 - 0.7 * t, 0.8 * t);
             BCurve c1({O, q1, b}, degree = 2); BCurve c2({N, q2, b}, degree = 2);",
        )
    } else {
        ("Line edge(O, N);", "Line c1(O, b); Line c2(N, b);")
    };
    format!(
        "param float t = 0.3 in [0.02, 0.98];
         AbsPoint O(0, 0, 0); AbsPoint M(2, 1.2, 0); AbsPoint N(4, 0.5, 0.8); {edge} AbsBead b(edge, t); {parts}
         Line up({{0, 0, 2}}, {{4, 0, 2}}); AbsPoint E(1, 0, -2); Line d1({{0, 0, -2}}, E); Line d2({{3, 0, -2}}, E);
         RuledSurf low1(c1, d1, divisions = {{3, 2}}); RuledSurf whole(edge, up, divisions = {{0, 2}});
         RuledSurf low2(c2, d2, divisions = {{4, 2}}); {joins}"
    )
}

#[test]
fn parts_end_at_the_points_that_they_are_drawn_through() {
    let joins = ["Join j1(low1.v0, whole.v0); Join j2(whole.v0, low2.v0);", ""];
    for (curved, joins) in [(true, joins[0]), (false, joins[0]), (false, joins[1])] {
        let text = beside_parts(curved, joins);
        let mut d = sound(&text);
        assert_eq!(divisions(&mut d, "whole"), [7, 2], "{text}");
        let at_home = panelled(&mut d).panelling.topology().clone();
        for k in 0..40 {
            d.set(&[("t".into(), 0.03 + 0.0237 * f64::from(k))]).unwrap();
            let p = panelled(&mut d);
            assert_eq!(*p.panelling.topology(), at_home);
            assert!(p.panelling.remarks().is_empty(), "{:?}", p.panelling.remarks());
            assert!(d.junctions().unwrap().is_empty());
            let report = p.mesh.report();
            assert_eq!((report.components, report.open_loops.len(), report.euler), (1, 1, 1));
        }
        vertices_have_their_derivatives(&mut d);
    }
    // A point typed at the place of the bead is another point, at any distance.
    let typed = beside_parts(true, joins[0]).replace(
        "BCurve c1({O, q1, b}",
        "AbsPoint e(4 * t * (1 - t) + 4 * t * t, 2.4 * t * (1 - t) + 0.5 * t * t, 0.8 * t * t);
         BCurve c1({O, q1, e}",
    );
    let mut d = open(&typed);
    let p = panelled(&mut d);
    let unnamed = p.panelling.remarks().iter().find(|r| r.id() == "part-not-named");
    assert_eq!(
        unnamed.map(ToString::to_string).as_deref(),
        Some(
            "`j1` joins an edge to a part of another, but `e` is no point of the longer edge: \
             coordinates join nothing"
        ),
        "{:?}",
        p.panelling.remarks()
    );
}

/// A cone of two grids, whose apex is a row of one place, and a plane that ends on its side.
fn cone_and_plane(tags: &str, join: &str) -> String {
    format!(
        "BSurf skin({{{{0, 0, 0}}, {{0, 0, 0}}, {{0, 0, 0}}, {{4, 1, 0}}, {{4, 0.7, 0.7}}, {{4, 0, 1}}}}, nu = 2, nv = 3, degree_u = 1,
             degree_v = 1, divisions = {{4, 6}});
         BSurf plane({{{{0, 0, 0}}, {{-2, 1, 0}}, {{4, 1, 0}}, {{4, 3, 0}}}}, nu = 2, nv = 2, degree_u = 1, degree_v = 1,
             divisions = {{4, 3}}{tags});
         {join}"
    )
}

#[test]
fn a_corner_in_the_apex_of_a_grid_is_joined_by_the_edges_that_end_there() {
    let reported = |text: String| -> Vec<String> {
        let mut d = sound(&text);
        d.junctions().unwrap().iter().map(|t| t.id.to_string()).collect()
    };
    let joined = reported(cone_and_plane("", "Join j(skin.v0, plane.v0);"));
    assert_eq!(joined, Vec::<String>::new());
    assert!(!reported(cone_and_plane("", "")).is_empty());
    // A plane of symmetry is none of the body's patches.
    assert_eq!(reported(cone_and_plane(", tags = \"symmetry\"", "")), Vec::<String>::new());
}

#[test]
fn what_lies_in_a_coordinate_plane_has_exact_zeros() {
    // Half a turn: the sine of pi is not zero.
    let text =
        "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 1); AbsPoint C(2, 0, 0.5); BCurve c({A, B, C});
        AbsPoint O(0, 0, -1); AbsPoint P(2, 0, -1); Line axis(O, P);
        RevSurf R(c, axis, 0, 3.141592653589793, divisions = {5, 9}); MirrSurf M(R, \"y=0\");";
    let mut d = sound(text);
    let p = panelled(&mut d);
    let block = p.mesh.patches()[0].block.as_ref().unwrap();
    for i in 0..=5 {
        for j in [0, 9] {
            assert_eq!(p.mesh.positions()[block.at(i, j) as usize].y.to_bits(), 0);
        }
    }
    let report = p.mesh.report();
    // Both halves are joined along both seams: a tube, open at its ends.
    assert_eq!((report.components, report.open_loops.len(), report.euler), (1, 2, 0));
    // The derivatives go on as if nothing had been rounded.
    let exact = d.jacobian(&["A.z".into()]).unwrap();
    assert!(exact[0].iter().any(|v| v.norm() > 0.5));
}

#[test]
fn tags_reach_the_patches() {
    let mut d = sound(&strips([
        ", tags = \"lid\"",
        ", tags = {\"keel\", \"symmetry\"}",
        ", tags = \"bow\"",
    ]));
    let p = panelled(&mut d);
    let words: Vec<_> = p.mesh.patches().iter().map(|p| p.info.tag.word()).collect();
    assert_eq!(words, ["lid", "symmetry", "bow"]);
    assert!(p.mesh.patches()[1].info.is("keel") && !p.mesh.patches()[1].info.is("lid"));
    assert_eq!(p.mesh.selected(|i| i.is("bow")).unwrap().patches().len(), 1);
}

#[test]
fn panels_made_anew_are_those_made_step_by_step() {
    let mut random = Random::new(0xbeef);
    let (mut kept, mut edits) = (0, 0);
    for round in 0..rounds(1000) {
        let text = bands(&mut random, 1 + round % 4, 20);
        let mut d = sound(&text);
        panelled(&mut d);
        for _ in 0..4 {
            let before = panelled(&mut d);
            let (name, value) = match random.below(3) {
                0 => ("Q.y", random.decimal(0.2, 1.5)),
                1 => ("T.z", random.decimal(2.5, 4.0)),
                _ => ("r0_1.t", random.decimal(0.97, 1.0)),
            };
            d.set(&[(name.into(), value)]).unwrap();
            let after = panelled(&mut d);
            let mut fresh = sound(&d.text());
            let fresh = panelled(&mut fresh);
            assert_eq!(after.mesh, fresh.mesh, "{name} = {value}\n{text}");
            assert_eq!(after.panelling.remarks(), fresh.panelling.remarks());
            // An edit may count pieces anew, by their lengths; mostly it does not.
            let (a, b) = (before.panelling.topology(), after.panelling.topology());
            edits += 1;
            kept += usize::from(Arc::ptr_eq(a, b));
        }
    }
    assert!(2 * kept > edits, "{kept} of {edits} kept their connectivity");
}

#[test]
fn five_thousand_patches_take_linear_time() {
    let strips = |n: usize| {
        let mut text = String::new();
        for k in 0..=n {
            let _ = writeln!(
                text,
                "AbsPoint A{k}(0, {k}, 0); AbsPoint B{k}(4, {k}, 1); Line l{k}(A{k}, B{k});"
            );
        }
        for k in 0..n {
            let divisions = if k == 0 { ", divisions = {3, 1}" } else { ", divisions = {0, 1}" };
            let _ = writeln!(text, "RuledSurf S{k}(l{k}, l{}{divisions});", k + 1);
        }
        text
    };
    // The shortest of several: other work on the machine only ever adds.
    let mut seconds = Vec::new();
    for n in [1, 500, 5000] {
        let text = strips(n);
        let mut shortest = f64::INFINITY;
        for _ in 0..3 {
            let mut d = sound(&text);
            let start = std::time::Instant::now();
            let p = panelled(&mut d);
            shortest = shortest.min(start.elapsed().as_secs_f64());
            assert_eq!(p.mesh.faces().len(), 3 * n);
            assert_eq!(p.mesh.report().open_loops.len(), 1);
        }
        seconds.push(shortest);
    }
    assert!(!moldloft_testing::soak() || seconds[2] < 60.0 * seconds[1].max(1e-3), "{seconds:?}");
}

/// The numbers of components and of open loops, when nothing was remarked; panels face alike.
fn pieces(document: &mut Document) -> (usize, usize) {
    let p = panelled(document);
    assert!(p.panelling.remarks().is_empty(), "{:?}", p.panelling.remarks());
    let report = p.mesh.report();
    assert!(report.manifold && report.oriented, "{report:?}");
    (report.components, report.open_loops.len())
}

/// The area of a patch of the mesh.
fn area(p: &Panelled, name: &str) -> f64 {
    let patch = p.mesh.patches().iter().find(|p| p.info.name == name).expect("a patch");
    let at = |v: u32| p.mesh.positions()[v as usize];
    let faces = &p.mesh.topology().faces()[patch.faces.clone()];
    let half = |f: &[u32; 4]| (at(f[2]) - at(f[0])).cross(at(f[3]) - at(f[1])).norm() / 2.0;
    faces.iter().map(half).sum()
}

#[test]
fn a_rolled_fillet_joins_what_is_left_of_both_surfaces() {
    let text = "param float r = 0.5 in [0.2, 1.5];
        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 0); Line a(A, B);
        Line b(C, D); RuledSurf floor(a, b, visible = 0); AbsPoint E(0, 2, -1); AbsPoint F(4, 2, -1);
        AbsPoint G(0, 2, 3); AbsPoint H(4, 2, 3); Line c(E, F); Line d(G, H); RuledSurf wall(c, d, visible = 0);
        RollFillet S(floor, wall, r, side2 = 1, divisions = {10, 6}); ContactSnake low(S, 1);
        ContactSnake high(S, 2); EdgeSnake front(1, floor); EdgeSnake top(3, wall);
        SubSurf deck({front, low}, divisions = {0, 4}); SubSurf bulkhead({high, top}, divisions = {0, 5});";
    let mut d = sound(text);
    let start = panelled(&mut d).panelling.topology().clone();
    assert_eq!(divisions(&mut d, "deck"), [10, 4]);
    assert_eq!(divisions(&mut d, "bulkhead"), [10, 5]);
    let mut random = Random::new(7);
    for r in [0.5, 0.2, 1.5].into_iter().chain((0..rounds(500)).map(|_| random.decimal(0.2, 1.5))) {
        d.set(&[("r".into(), r)]).unwrap();
        assert_eq!(pieces(&mut d), (1, 1), "r = {r}");
        let p = panelled(&mut d);
        assert_eq!(*p.panelling.topology(), start, "r = {r}");
        assert!((area(&p, "deck") - 4.0 * (2.0 - r)).abs() < 1e-11, "r = {r}");
        assert!((area(&p, "bulkhead") - 4.0 * (3.0 - r)).abs() < 1e-11, "r = {r}");
        // Six chords of a quarter of a circle.
        let arc = 12.0 * r * (std::f64::consts::PI / 24.0).sin();
        assert!((area(&p, "S") - 4.0 * arc).abs() < 1e-11, "r = {r}");
    }
    // The snakes lie on the parents, where the ball touches.
    d.set(&[("r".into(), 0.5)]).unwrap();
    let near = |d: &mut Document, text: &str, want: Vec3| {
        let found = crate::common::vector(d, text);
        assert!(found.distance(want) < 1e-12, "{text}: {found:?}");
    };
    near(&mut d, "low(0.25)", Vec3::of(1.0, 1.5, 0.0));
    near(&mut d, "high(0.75)", Vec3::of(3.0, 2.0, 0.5));
    // The vertices move as their derivatives say, along the contacts, too.
    let exact = d.jacobian(&["r".into()]).unwrap();
    let h = 1e-5;
    let mut at = |r: f64| {
        d.set(&[("r".into(), r)]).unwrap();
        panelled(&mut d).mesh.positions().to_vec()
    };
    let (least, most) = (at(0.5 - h), at(0.5 + h));
    for (k, slope) in exact[0].iter().enumerate() {
        let difference = (most[k] - least[k]) / (2.0 * h);
        assert!(slope.distance(difference) < 1e-9, "vertex {k}: {slope:?}, {difference:?}");
    }
    assert!(exact[0].iter().any(|slope| slope.norm() > 0.9));
    // And those of a fillet between snakes are these.
    let between = text.replace(
        "RollFillet S(floor, wall, r, side2 = 1,",
        "UVSnake m(floor, \"v\", 0.5*r); UVSnake n(wall, \"v\", 0.7); FilletSurf S(m, n,",
    );
    assert_eq!(pieces(&mut sound(&between)), (1, 1));
    let wrong = open(&text.replace("ContactSnake low(S, 1)", "ContactSnake low(floor, 1)"));
    assert!(ids(&wrong).contains(&"no-contact".to_string()), "{:?}", reported(&wrong));
}

#[test]
fn a_ball_that_rolls_round_a_mast_joins_it_to_the_deck() {
    let text = "param float r = 0.5 in [0.3, 0.9];
        AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z); AbsPoint A(1, 0, -1); AbsPoint B(1, 0, 3);
        Line side(A, B); RevSurf mast(side, axis, visible = 0); AbsPoint C(-4, -4, 0); AbsPoint D(4, -4, 0);
        AbsPoint E(-4, 4, 0); AbsPoint F(4, 4, 0); Line c(C, D); Line d(E, F); RuledSurf deck(c, d, visible = 0);
        AbsMagnet m(mast, 0.4, 0); RollFillet S(m, deck, r, side1 = -1, divisions = {16, 4});
        ContactSnake foot(S, 1); ContactSnake ring(S, 2); EdgeSnake rim(2, mast);
        SubSurf shaft({foot, rim}, divisions = {0, 6}); TrimSurf plate(deck, {ring}, whole = 1, nu = 9, nv = 7);";
    let mut d = sound(text);
    for r in [0.5, 0.3, 0.9, 0.77] {
        d.set(&[("r".into(), r)]).unwrap();
        // Open at the deck's outer edge and at the masthead only.
        assert_eq!(pieces(&mut d), (1, 2), "r = {r}");
        assert_eq!(divisions(&mut d, "shaft"), [16, 6]);
        let p = panelled(&mut d);
        // A square without a regular polygon of 16 corners; a mast of 16 flat sides.
        let turn = std::f64::consts::TAU / 16.0;
        let hole = 8.0 * (1.0 + r) * (1.0 + r) * turn.sin();
        assert!((area(&p, "plate") - (64.0 - hole)).abs() < 1e-9, "r = {r}");
        let shaft = 32.0 * (turn / 2.0).sin() * (3.0 - r);
        assert!((area(&p, "shaft") - shaft).abs() < 1e-9, "r = {r}");
    }
}

/// A bent sheet with a window of four snakes: what is left of it, the window, and a strip beside it.
fn window(trim: &str, inside: &str, strip: &str) -> String {
    format!(
        "param float t = 0.3 in [0.2, 0.4];
         AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0.5); AbsPoint C(4, 0, 0); AbsPoint D(0, 3, 0); AbsPoint E(4, 3, 1);
         BCurve l({{A, B, C}}); Line m(D, E); RuledSurf S(l, m, visible = 0);
         AbsMagnet p(S, t, 0.3); AbsMagnet q(S, 0.7, 0.25); AbsMagnet o(S, 0.75, 0.7); AbsMagnet n(S, 0.3, 0.75);
         AbsMagnet k(S, 0.5, 0.2); BSnake south({{p, k, q}}); LineSnake east(q, o); LineSnake north(n, o);
         LineSnake west(p, n);
         TrimSurf rest(S, {{south, east, north, west}}, whole = 1{trim});
         SubSurf pane({{south, east, north, west}}{inside});
         AbsPoint F(0, 5, 0); AbsPoint G(4, 5, 0); Line e(F, G); RuledSurf beside(m, e{strip});"
    )
}

#[test]
fn a_trimmed_surface_has_its_neighbours_vertices() {
    let mut d = sound(&window("", ", divisions = {7, 5}", ", divisions = {9, 3}"));
    assert_eq!(pieces(&mut d), (1, 1));
    let p = panelled(&mut d);
    // Its border has the neighbours' divisions: 2 (7 + 5) round the window, 9 beside the strip, and
    // 12, as many as its own net, elsewhere.
    let patch = |name: &str| p.mesh.patches().iter().find(|p| p.info.name == name).unwrap();
    let vertices = |name: &str| -> BTreeSet<u32> {
        p.mesh.topology().faces()[patch(name).faces.clone()].iter().flatten().copied().collect()
    };
    let shared = |a: &str, b: &str| vertices(a).intersection(&vertices(b)).count();
    assert_eq!((shared("rest", "pane"), shared("rest", "beside")), (24, 10));
    let report = p.mesh.report();
    assert_eq!(report.euler, 1);
    // Counts flow the other way, too.
    let mut d = sound(&window(", rim = 6", "", ""));
    assert_eq!(divisions(&mut d, "pane"), [6, 6]);
    assert_eq!(pieces(&mut d), (1, 1));
    // The magnet moves: joined for all places, and with the derivatives of all vertices.
    let mut d = sound(&window(", nu = 6, nv = 6", ", divisions = {4, 3}", ", divisions = {5, 2}"));
    let exact = d.jacobian(&["t".into()]).unwrap();
    let h = 1e-6;
    let mut at = |t: f64| {
        d.set(&[("t".into(), t)]).unwrap();
        assert_eq!(pieces(&mut d), (1, 1));
        panelled(&mut d).mesh.positions().to_vec()
    };
    let (low, high) = (at(0.3 - h), at(0.3 + h));
    for (k, d) in exact[0].iter().enumerate() {
        let difference = (high[k] - low[k]) / (2.0 * h);
        assert!(d.distance(difference) < 1e-7, "vertex {k}: {d:?}, {difference:?}");
    }
    assert!(exact[0].iter().any(|d| d.norm() > 0.1));
    // From the text, and step by step.
    let text = window("", ", divisions = {7, 5}", "");
    let mut stepped = sound(&text);
    let _ = panelled(&mut stepped);
    stepped.set(&[("t".into(), 0.22)]).unwrap();
    let _ = panelled(&mut stepped);
    stepped.set(&[("t".into(), 0.37)]).unwrap();
    let mut fresh = sound(&text);
    fresh.set(&[("t".into(), 0.37)]).unwrap();
    assert_eq!(panelled(&mut fresh).mesh, panelled(&mut stepped).mesh);
}

#[test]
fn trimmed_surfaces_join_each_other_and_tell_contradictions() {
    // Two halves of a sheet on both sides of a snake, without any panel between them.
    let text = "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 0); Line a(A, B);
        Line b(C, D); RuledSurf S(a, b, visible = 0); AbsMagnet p(S, 0, 0); AbsMagnet q(S, 1, 0);
        AbsMagnet r(S, 1, 1); AbsMagnet s(S, 0, 1); AbsMagnet m(S, 0.4, 0.6); BSnake cut({q, m, s});
        LineSnake pq(p, q); LineSnake sp(s, p); LineSnake qr(q, r); LineSnake sr(s, r);
        TrimSurf low(S, {pq, cut, sp}); TrimSurf high(S, {cut, qr, sr}, orientation = 1);";
    let mut d = sound(text);
    assert_eq!(pieces(&mut d), (1, 1));
    let p = panelled(&mut d);
    assert!((area(&p, "low") + area(&p, "high") - 12.0).abs() < 1e-12);
    // A hole of two edges has no area; a hole and its cap close the sheet again.
    let round = |divisions: &str| {
        format!(
            "AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 0); Line a(A, B);
             Line b(C, D); RuledSurf S(a, b, visible = 0); AbsMagnet m(S, 0.5, 0.5); AbsMagnet k(S, 0.7, 0.5);
             AbsMagnet l(S, 0.5, 0.7); ArcSnake ring(k, m, l, type = 6); TrimSurf rest(S, {{ring}}, whole = 1);
             SubSurf cap({{ring, m}}, divisions = {divisions});"
        )
    };
    let mut d = sound(&round("{40, 3}"));
    assert_eq!(pieces(&mut d), (1, 1));
    let p = panelled(&mut d);
    assert!((area(&p, "rest") + area(&p, "cap") - 12.0).abs() < 1e-12);
    assert_eq!(p.mesh.report().euler, 1);
    let mut d = open(&round("{2, 3}"));
    let p = panelled(&mut d);
    let [remark] = p.panelling.remarks() else { panic!("{:?}", p.panelling.remarks()) };
    assert_eq!((remark.id(), remark.object()), ("border-not-joined", Some("rest")));
    assert!(remark.to_string().contains("2 divisions"), "{remark}");
    // `rim` is a statement like `divisions`.
    let mut d = open(&window(", rim = 12", ", divisions = {7, 12}", ""));
    let p = panelled(&mut d);
    let chains: Vec<_> = p.panelling.remarks().iter().map(|r| r.id()).collect();
    assert_eq!(chains, ["divisions-contradict"; 2], "{:?}", p.panelling.remarks());
    assert!(p.panelling.remarks()[0].to_string().contains("joined by `south`"));
}
