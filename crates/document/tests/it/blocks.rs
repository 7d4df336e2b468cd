//! Volume meshes of models: joins by identity, divisions through all blocks, folded cells.

use crate::common::{number, sound};
use moldloft_document::Document;

/// Two storeys of four rooms: nine columns of corner points in the plane, three levels.
fn rooms(extra: &str) -> String {
    let mut text = String::from("param float h = 1.5;\n");
    for k in 0..3 {
        for j in 0..3 {
            for i in 0..3 {
                let (x, y) = (i * 2, j * 3);
                text += &format!("AbsPoint P{i}{j}{k}({x}.0 + 0.1*{j}, {y}.0, {k}*h + 0.2*{i});\n");
            }
        }
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1), (0, 2), (1, 2)] {
            text += &format!("Line x{i}{j}{k}(P{i}{j}{k}, P{}{j}{k});\n", i + 1);
        }
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            text += &format!("RuledSurf F{i}{j}{k}(x{i}{j}{k}, x{i}{}{k}, visible = 0);\n", j + 1);
        }
    }
    text + extra
}

fn four(divisions: [&str; 4]) -> String {
    let room = |(at, given): (&str, &str)| {
        format!("RuledSolid R{at}(F{at}0, F{at}1{given});\nRuledSolid U{at}(F{at}1, F{at}2);\n")
    };
    let all = ["00", "10", "01", "11"].into_iter().zip(divisions);
    rooms(&all.map(room).collect::<String>())
}

#[test]
fn blocks_share_faces_by_identity() {
    // One number each way is enough for all eight.
    let mut document = sound(&four([
        ", divisions = {4, 0, 0}",
        ", divisions = {3, 5, 0}",
        ", divisions = {0, 2, 6}",
        "",
    ]));
    let blocked = document.blocked().unwrap();
    let report = &blocked.report;
    let sizes: Vec<[usize; 3]> = blocked.blocks.blocks().iter().map(|b| b.divisions()).collect();
    // In order R00 U00 R10 U10 R01 U01 R11 U11; nobody divides the upper storey along w.
    let expected =
        [[4, 5, 6], [4, 5, 8], [3, 5, 6], [3, 5, 8], [4, 2, 6], [4, 2, 8], [3, 2, 6], [3, 2, 8]];
    assert_eq!(sizes, expected);
    assert_eq!(report.vertices, (4 + 3 + 1) * (5 + 2 + 1) * (6 + 8 + 1));
    assert_eq!(report.vertices, blocked.blocks.positions().len());
    assert_eq!(report.interfaces, 4 + 4 + 4);
    assert!(report.positive() && blocked.diagnostics().is_empty(), "{:?}", blocked.diagnostics());
    // All cells are sheared bricks: 4 x 6 x 3.
    assert!((report.volume - 72.0).abs() < 1e-12, "{}", report.volume);
    assert_eq!(blocked.blocks.interfaces().1.len(), 8 * 6 - 2 * 12);
}

#[test]
fn contradictions_are_explained() {
    let mut document = sound(&four([", divisions = {4, 0, 0}", "", ", divisions = {6, 0, 0}", ""]));
    let error = document.blocked().unwrap_err();
    let text = format!("{error:?}");
    assert_eq!(error.id, "divisions-contradict", "{text}");
    assert!(error.message.contains("`R00` has 4 cells along u but `R01` has 6 along u"), "{text}");
}

#[test]
fn other_laws_do_not_join() {
    let blocks = "CLoftSolid A({F000, F001, F002}, divisions = 4); CLoftSolid B({F100, F101, F102}, divisions = 4);
                  BLoftSolid C({F010, F011, F012}, degree = 2, divisions = 4); TranSolid D(F110, x000, divisions = 4, visible = 0);";
    let mut document = sound(&rooms(blocks));
    let blocked = document.blocked().unwrap();
    // A and B share the face between them, with C each only edges at the levels.
    assert_eq!(blocked.report.interfaces, 1);
    assert_eq!(blocked.report.vertices, 2 * 125 - 25 + 125 - 2 * 5);
}

#[test]
fn faces_of_solids_and_turned_blends() {
    let text = rooms(
        "Line up(P000, P001); TranSolid low(F000, up, divisions = {3, 4, 5}); FaceSurf top(6, low, visible = 0);
         TranSolid high(top, up, divisions = {0, 0, 2});
         FaceSurf f1(1, low, visible = 0); FaceSurf f2(2, low, visible = 0); FaceSurf f3(3, low, visible = 0);
         FaceSurf f4(4, low, visible = 0); FaceSurf f5(5, low, visible = 0);",
    );
    let mut document = sound(&text);
    let blocked = document.blocked().unwrap();
    assert_eq!(blocked.report.interfaces, 1);
    assert_eq!(blocked.report.vertices, 4 * 5 * 8);
    // The same box of its own faces, turned: u is the old v, v the old w, w the old u.
    let again = "BlendSolid again({f3, f4, f5, top, f1, f2}, turns = {1, 1, 1, 1, 0, 0});";
    let mut document = sound(&format!("{text}{again}"));
    let blocked = document.blocked().unwrap();
    // All faces are those of the first, so only inner vertices are new.
    let again = blocked.blocks.blocks().last().unwrap();
    assert_eq!(again.divisions(), [4, 5, 3]);
    assert_eq!(blocked.report.vertices, 4 * 5 * 8 + 3 * 4 * 2);
    assert!(blocked.report.positive());
    let volume = |name: &str| blocked.report.blocks.iter().find(|b| b.name == name).unwrap().volume;
    assert!((volume("again") - volume("low")).abs() < 1e-12);
}

#[test]
fn blends_say_how_faces_must_be_turned() {
    let text = rooms(
        "Line up(P000, P001); TranSolid low(F000, up); FaceSurf top(6, low); FaceSurf f1(1, low);
         FaceSurf f2(2, low); FaceSurf f3(3, low); FaceSurf f4(4, low); FaceSurf f5(5, low);
         BlendSolid again({f3, f4, f5, top, f1, f2});",
    );
    let document = crate::common::open(&text);
    let all = document.diagnostics();
    let found = all.iter().find(|d| d.id == "open-edge").unwrap_or_else(|| panic!("{all:?}"));
    assert!(format!("{found:?}").contains("turns = {"), "{found:?}");
}

#[test]
fn folded_cells_are_told() {
    let text = rooms(
        "RuledSolid turned(F001, F000, divisions = 2); AbsPoint Q(9, 5, 0.2); Line q(P010, Q);
         RuledSurf wrong(q, x000, visible = 0); RuledSolid crossed(F000, wrong, divisions = {2, 2, 4});",
    );
    let mut document = sound(&text);
    let blocked = document.blocked().unwrap();
    let reported = blocked.diagnostics();
    assert_eq!(reported.iter().filter(|d| d.id == "negative-jacobian").count(), 2, "{reported:?}");
    assert!(format!("{:?}", reported[0]).contains("left-handed"), "{reported:?}");
    assert_eq!(blocked.report.blocks[0].folded, 8);
    let crossed = &blocked.report.blocks[1];
    assert!(crossed.folded > 0 && crossed.folded <= 16 && crossed.worst.scaled_jacobian < 0.0);
}

#[test]
fn numbers_of_solids_and_their_derivatives() {
    let mut document = sound(&four([", divisions = 2", "", "", ""]));
    assert!((number(&mut document, "R00.volume") - 9.0).abs() < 1e-12);
    assert!((number(&mut document, "R00(0.5, 0.5, 1).z") - 1.6).abs() < 1e-12);
    let by = vec!["h".to_string()];
    let columns = document.block_jacobian(&by).unwrap();
    let before = document.blocked().unwrap();
    let at = |document: &mut Document, h: f64| {
        document.set(&[("h".into(), h)]).unwrap();
        document.blocked().unwrap().blocks.positions().to_vec()
    };
    let (high, low) = (at(&mut document, 1.5 + 1e-3), at(&mut document, 1.5 - 1e-3));
    for (k, d) in columns[0].iter().enumerate() {
        assert!(((high[k] - low[k]) / 2e-3).distance(*d) < 1e-9);
    }
    assert_eq!(columns[0].len(), before.blocks.positions().len());
}

#[test]
fn models_without_solids_say_so() {
    let mut document = sound("AbsPoint A(0, 0, 0);");
    assert_eq!(document.blocked().unwrap_err().id, "no-blocks");
}
