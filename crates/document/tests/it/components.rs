//! Components: a file of objects inserted with parents of the caller's.

use crate::common::{ids, number, reported, vector, with_files};
use moldloft_document::Document;
use moldloft_num::Vec3;
use moldloft_registry::Value;

/// A keel on a curve, with a curve, a span and points of its own.
const KEEL: (&str, &str) = (
    "keel.sdl",
    "param float span = 2 in [0.5, 4];
     AbsPoint K1(0, 0, 0); AbsPoint K2(1, 0, 0); Line root(K1, K2, visible = 0);
     float taper = 0.5;
     AbsBead fore(root, 0.25); AbsBead aft(root, 0.75);
     RelPoint tip(fore, 0, 0, -span); RelPoint heel(aft, -0.25*taper, 0, -span);
     SubCurve top(fore, aft); Line low(tip, heel); RuledSurf plate(top, low, divisions = {2, 3});
     for (i = 1:3) { RelPoint rib(tip, i, 0, 0); }",
);

const BOAT: &str = "param float length = 8; AbsPoint A(0, 0, 1); AbsPoint B(length, 0, 1); Line hull(A, B);
    Component keel(\"keel.sdl\", root = hull); Component second(\"keel.sdl\", root = hull, span = 1);
    RelPoint bulb(keel.tip, 0, 0, -0.5);";

fn boat() -> Document {
    let document = with_files(BOAT, &[KEEL]);
    assert!(document.diagnostics().is_empty(), "{:?}", reported(&document));
    document
}

fn objects(document: &Document) -> Vec<String> {
    document.graph().objects().map(|o| o.name.to_string()).collect()
}

#[test]
fn a_component_stands_on_the_parents_it_is_given() {
    let mut document = boat();
    assert_eq!(vector(&mut document, "keel.tip"), Vec3::of(2.0, 0.0, -1.0));
    assert_eq!(vector(&mut document, "second.tip"), Vec3::of(2.0, 0.0, 0.0));
    assert_eq!(vector(&mut document, "bulb"), Vec3::of(2.0, 0.0, -1.5));
    assert_eq!(vector(&mut document, "keel.plate(0, 1)"), Vec3::of(2.0, 0.0, -1.0));
    assert_eq!(vector(&mut document, "keel.rib[2]"), Vec3::of(4.0, 0.0, -1.0));
    assert_eq!(number(&mut document, "keel.span"), 2.0);
    // Its own root is not made, nor what only that was built on.
    let names = objects(&document);
    assert!(!names.iter().any(|n| n.contains("K1") || n.contains("root")), "{names:?}");
    // By itself the file has parents of its own.
    let alone = with_files(KEEL.1, &[]);
    assert!(alone.diagnostics().is_empty() && objects(&alone).contains(&"K1".to_string()));
}

#[test]
fn its_parameters_are_the_models() {
    let mut document = boat();
    let names: Vec<&str> = document.params().iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["length", "keel.span"]);
    let exact = document
        .derivatives(
            &["keel.heel".into(), "bulb".into()],
            &["keel.span".into(), "length".into(), "A.z".into()],
        )
        .unwrap();
    let at = |row: usize, column: usize| match exact[row][column] {
        Value::Vector(v) => v,
        ref other => panic!("{other:?}"),
    };
    assert_eq!((at(0, 0), at(0, 1)), (Vec3::of(0.0, 0.0, -1.0), Vec3::of(0.75, 0.0, 0.0)));
    assert_eq!((at(1, 1), at(1, 2)), (Vec3::of(0.25, 0.0, 0.0), Vec3::of(0.0, 0.0, 0.75)));
    document.set(&[("keel.span".into(), 3.0), ("A.z".into(), 0.0)]).unwrap();
    assert_eq!(vector(&mut document, "keel.tip"), Vec3::of(2.0, 0.0, -2.75));
    assert_eq!(vector(&mut document, "second.tip").z, -0.75);
    assert_eq!(document.set(&[("keel.span".into(), 9.0)]).unwrap_err()[0].id, "out-of-range");
    // A number in the file belongs to the file.
    let refused = document.set(&[("keel.fore.t".into(), 0.5)]).unwrap_err();
    assert_eq!(refused[0].id, "not-a-literal");
    // The text changes, the parameter stays as it was set.
    document.set_text(&BOAT.replace("-0.5)", "-0.25)"));
    assert_eq!(vector(&mut document, "bulb").z, 1.0 - 3.0 - 0.25);
}

#[test]
fn components_are_renamed_and_deleted() {
    let mut document = boat();
    document.rename("keel", "fin").unwrap();
    assert!(document.text().contains("Component fin(") && document.text().contains("fin.tip"));
    assert!(document.diagnostics().is_empty());
    assert_eq!(vector(&mut document, "fin.tip"), Vec3::of(2.0, 0.0, -1.0));
    assert_eq!(document.delete("fin").unwrap_err().id, "has-dependents");
    document.delete("bulb").unwrap();
    document.delete("fin").unwrap();
    assert!(!objects(&document).iter().any(|n| n.starts_with("fin.")));
    assert_eq!(vector(&mut document, "second.tip"), Vec3::of(2.0, 0.0, 0.0));
    document.rename("hull", "keelson").unwrap();
    assert!(document.text().contains("root = keelson"), "{}", document.text());
}

#[test]
fn components_nest_and_stand_in_loops() {
    let rig = (
        "rig.sdl",
        "AbsPoint foot(0, 0, 0); RelPoint top(foot, 0, 0, 5);
         Line base(foot, top); Component plate(\"keel.sdl\", root = base, span = 1);
         function float twice(float x) { return 2*x; } RelPoint out(foot, twice(2), 0, 0);",
    );
    let text = "for (i = 1:2) { AbsPoint at(i, 0, 0); Component mast(\"rig.sdl\", foot = at); }
                float foot = 7; float own = mast[2].out.x;";
    let mut document = with_files(text, &[KEEL, rig]);
    assert!(document.diagnostics().is_empty(), "{:?}", reported(&document));
    assert_eq!(vector(&mut document, "mast[2].top"), Vec3::of(2.0, 0.0, 5.0));
    assert_eq!(vector(&mut document, "mast[1].plate.tip"), Vec3::of(1.0, 0.0, 0.25));
    assert_eq!((number(&mut document, "own"), number(&mut document, "foot")), (6.0, 7.0));
}

#[test]
fn model_files_are_components_too() {
    let file = (
        "post.ms2",
        "MultiSurf 1.44\nSymmetry: y\nBeginModel;\nAbsPoint A 14 1 / 1 2 3;\nVariable h 4 1 9;\n\
         RelPoint B 14 1 / A 0 0 [2*h];\nLine l 11 1 8x4 / * A B;\nEndModel;\n",
    );
    let text =
        "AbsPoint P(0, 0, 1); Component post(\"post.ms2\", A = P); Component own(\"post.ms2\");";
    let mut document = with_files(text, &[file]);
    assert!(document.diagnostics().is_empty(), "{:?}", reported(&document));
    assert_eq!(vector(&mut document, "post.B"), Vec3::of(0.0, 0.0, 9.0));
    assert_eq!(vector(&mut document, "own.l(1)"), Vec3::of(1.0, 2.0, 11.0));
    document.set(&[("post.h".into(), 2.0)]).unwrap();
    assert_eq!(vector(&mut document, "post.B").z, 5.0);
}

#[test]
fn what_is_no_component() {
    let bad = ("bad.sdl", "RelPoint tip(nobody, 0, 0, 1);");
    let own = ("own.sdl", "Component again(\"own.sdl\");");
    let mut wrong = Vec::new();
    for (text, id, says) in [
        ("Component c();", "missing-argument", "one file"),
        ("Component c(\"keel.sdl\", \"bad.sdl\");", "missing-argument", "2 files"),
        ("Component c(3);", "wrong-class", "a file"),
        ("Component c(\"none.sdl\");", "cannot-read", "unknown file"),
        ("Component c(\"keel.sdl\", rot = 3);", "unknown-argument", "`rot`"),
        // A word of the file that is not a name in it, and nothing near: what there is is reported.
        ("Component c(\"keel.sdl\", RelPoint = 3);", "unknown-argument", "`RelPoint`"),
        ("Component c(\"keel.sdl\", zebra = 3);", "unknown-argument", "declares: `span`"),
        ("Component c(\"keel.sdl\", root = 3);", "wrong-class", "expected a curve"),
        ("AbsPoint nobody(0, 0, 0); Component c(\"bad.sdl\");", "unknown-name", "`nobody`"),
        ("Component c(\"own.sdl\");", "cycle", "into itself"),
        ("AbsPoint c(0, 0, 0); Component c(\"keel.sdl\");", "duplicate-name", "`c`"),
        ("Component c(\"keel.sdl\"); AbsPoint p(c.tep.x, 0, 0);", "unknown-name", "c.tep"),
    ] {
        let document = with_files(text, &[KEEL, bad, own]);
        let found = reported(&document);
        if ids(&document).first().map(String::as_str) != Some(id) || !found[0].contains(says) {
            wrong.push(format!("{text}: {found:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
