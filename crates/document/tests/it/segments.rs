//! Straight edges between the same two point objects are one, whoever draws them.

use crate::common::{number, sound};

fn closed_volume(text: &str) -> f64 {
    let mut document = sound(text);
    let panelled = document.panelled().unwrap();
    let report = panelled.mesh.report();
    assert!(report.open_loops.is_empty() && report.manifold, "{report:?}");
    number(&mut document, "mesh.volume")
}

const CUBE: &str = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(1, 1, 0); AbsPoint D(0, 1, 0); \
                    AbsPoint E(0, 0, 1); AbsPoint F(1, 0, 1); AbsPoint G(1, 1, 1); AbsPoint H(0, 1, 1); ";

/// Ruled surfaces whose rulings lie on each other's edges, in both directions.
#[test]
fn a_cube_of_ruled_surfaces_is_closed() {
    let text = format!(
        "{CUBE} Line ab(A, B); Line dc(D, C); Line ef(E, F); Line hg(H, G); Line bc(B, C);
         Line fg(F, G); Line da(D, A); Line he(H, E);
         RuledSurf low(dc, ab, divisions = {{3, 4}}); RuledSurf front(ab, ef, divisions = {{3, 5}});
         RuledSurf top(hg, ef, divisions = {{3, 4}}, orientation = 1); RuledSurf right(bc, fg, divisions = {{4, 5}});
         RuledSurf left(da, he, divisions = {{4, 5}});
         BLoftSurf far(hg, dc, degree = 1, divisions = {{3, 5}});"
    )
    .replace("far(hg, dc", "far({hg, dc}");
    let volume = closed_volume(&text);
    assert!((volume - 1.0).abs() < 1e-12, "{volume}");
}

/// A line from a point to itself is a pole.
#[test]
fn a_pyramid_has_a_pole() {
    let text = format!(
        "{CUBE} AbsPoint T(0.5, 0.5, 1); Line top(T, T); Line ab(A, B); Line bc(B, C); Line cd(C, D);
         Line da(D, A); Line dc(D, C);
         RuledSurf s1(ab, top); RuledSurf s2(bc, top); RuledSurf s3(cd, top); RuledSurf s4(da, top);
         RuledSurf base(ab, dc);"
    );
    let volume = closed_volume(&text);
    assert!((volume - 1.0 / 3.0).abs() < 1e-12, "{volume}");
}

/// Ruled surfaces under one law join along their rulings, under two they do not.
#[test]
fn rulings_under_the_same_law_are_one() {
    let tent = |second: &str| {
        format!(
            "{CUBE} CosRelabel a(\"start\"); GeoRelabel b(3); Line ab(A, B); Line ef(E, F); Line bc(B, C);
             Line fg(F, G); RuledSurf one(ab, ef, relabel = a); RuledSurf two(bc, fg, relabel = {second});"
        )
    };
    let loops = |text: &str| {
        let mut document = sound(text);
        let panelled = document.panelled().unwrap();
        panelled.mesh.report().open_loops.len()
    };
    assert_eq!(loops(&tent("a")), 1);
    assert_eq!(loops(&tent("b")), 2);
}
