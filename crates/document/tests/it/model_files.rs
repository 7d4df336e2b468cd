//! Model files: read, built, edited, converted to programs and back; and what is wrong with bad ones.

use moldloft_diag::Severity;
use moldloft_document::{Document, ModelFormat, NoFiles, ReadText, TextReadError, World, registry};
use moldloft_num::Vec3;
use moldloft_registry::{Attributes, Value};
use std::f64::consts::PI;

/// Our own copy of Table 2 of Letcher and Shook (1995).
const HULL: &str = "\
MultiSurf 0.35 /y
Rem the hull of Table 2
AbsPoint P11 14 1 0 0 3.6;
AbsPoint P12 14 1 1.367 0 .602;
AbsPoint P13 14 1 2.324 0 -0.8;
AbsPoint P14 14 1 3 0 -.9;
BCurve MC1 11 1 10 * 2 { P11 P12 P13 P14 };

AbsPoint P21 14 1 15 4.815 2.56;
AbsPoint P22 14 1 15. 5.046 0.628;
AbsPoint P23 14 1 15.000 3.603 -0.87;
AbsPoint P24 14 1 15 0 -1.175;
BCurve MC2 11 1 10 * 2 { P21 P22 P23 P24 };
AbsPoint P31 14 1 30 3.5 2.76;
AbsPoint P32 14 1 30 3.5 1.32;
AbsPoint P33 14 1 30 2.5 .12;
AbsPoint P34 14 1 30 0 0.12;
BCurve MC3 11 1 10 * 2 { P31 P32 P33 P34 };
CLoftSurf hull 10 1 10 1 20 1 0 3 { MC1 MC2 MC3 };
XContours stations 12 1 0 10 1.8 2.735;
ZContours waterlines 13 1 0 0 0. 1.;
EndModel
";

/// Every feature of 1.x that is kept: header lines, comments, attributes, layers, divisions,
/// orientation, names that are no identifiers, planes of the system, angles, unknown entities.
const EVERYTHING: &str = "\
MultiSurf 1.44
# by hand
Units: m kg
Symmetry: x y
Extents: -1 -2 -3 10 20 30
Places: 3
Rem the last of the header
DivMult: 2
BeginModel;

Rem points
AbsPoint P-1 14 1 A:Layer(7) A:Note(a (b) \"c\") / 0 0 1;
AbsPoint P.2 3 0 / 1 0.30000000000000004 0;
# another comment
AbsPoint for 14 1 / 2 0.1 1e-7;
AbsPoint 3d 14 -1 A:Colour(red) A:Layer(2) / 0 0 0;
AbsPoint up_x2d_ 14 1 / 0 0 5;
Line axis 6 1 8x4 / * 3d up_x2d_;
MirrPoint m 11 1 / P-1 *Y=0;
BCurve c 11 1 12x3 / * 2 { P-1 P.2 for };
Line upright 11 1 8x4 A:Note(plain) / * P-1 up_x2d_;
RevSurf shell 2 1 36x4 12x5 1 / * c axis 0 37.123456789;
UVSnake iso 13 1 8x4 / * shell u 0.25;
XPlane mid 12 1 / 2.5;

SolveSet S1 3 1 / { P-1
  P.2 } 0.50;
RuledSurf skin 10 1 8x1 8x2 0 / * c upright;
Rem the end
EndModel;
";

fn open(text: &str) -> Document {
    Document::from_text(registry(), Box::new(NoFiles), "model.ms2", text)
}

fn open_sdl(text: &str) -> Document {
    Document::from_text(registry(), Box::new(NoFiles), "model.sdl", text)
}

fn number(document: &mut Document, text: &str) -> f64 {
    match document.eval(text) {
        Ok(Value::Number(x)) => x,
        other => panic!("{text}: {other:?}"),
    }
}

/// Id, text at the place, and expectation of each diagnostic.
fn faults(text: &str) -> Vec<(String, String, String)> {
    let document = open(text);
    let slice = |d: &moldloft_diag::Diagnostic| document.sources().slice(d.span()).to_string();
    let all = document.diagnostics();
    all.iter().map(|d| (d.id.to_string(), slice(d), format!("{d:?}"))).collect()
}

/// What a model consists of, names as a model file has them.
fn objects(document: &Document) -> Vec<(String, String, Vec<String>, Attributes)> {
    let graph = document.graph();
    let plain = |name: &str| {
        let mut name = name.to_string();
        for (code, c) in
            [("_x5f_x2d_", "-"), ("_x2d_", "-"), ("_x2e_", "."), ("_x33_", "3"), ("_x66_", "f")]
        {
            name = name.replace(code, c);
        }
        name
    };
    fn show(document: &Document, value: &Value<f64>, plain: &dyn Fn(&str) -> String) -> String {
        match value {
            Value::Object(key) => plain(&document.graph().get(*key).unwrap().name),
            Value::List(items) => {
                items.iter().map(|v| show(document, v, plain)).collect::<Vec<_>>().join(" ")
            }
            other => format!("{other:?}"),
        }
    }
    graph
        .objects()
        .filter(|o| o.row.name != "Model")
        .map(|o| {
            let args = o.args.iter().map(|v| show(document, v, &plain)).collect();
            (plain(&o.name), o.row.name.to_string(), args, o.head.clone())
        })
        .collect()
}

#[test]
fn table_2_is_built() {
    let mut document = open(HULL);
    assert!(document.diagnostics().is_empty(), "{:?}", document.diagnostics());
    assert_eq!((document.graph().len(), &*document.symmetry()), (18, "y"));
    for (at, expected) in [
        ("hull(.5,.25)", Vec3::of(8.6422, 2.9203, -0.2053)),
        ("hull(.5,.75)", Vec3::of(22.7195, 4.4203, 0.2042)),
    ] {
        let Ok(Value::Vector(found)) = document.eval(at) else { panic!("{at}") };
        assert!(found.distance(expected) < 1e-4, "{at} = {found:?}");
    }
    let hull = document.graph().get(document.graph().find("hull").unwrap()).unwrap();
    assert_eq!((hull.head.divisions, hull.head.subdivisions), ([10, 20], [1, 1]));
}

#[test]
fn numbers_are_set_in_the_text() {
    let mut document = open(HULL);
    let applied = document.set(&[("P21.y".into(), 5.0)]).unwrap();
    assert_eq!(applied.evaluated, 3, "the point, its curve and the surface");
    assert!(document.text().contains("AbsPoint P21 14 1 15 5 2.56;"));
    let edited = number(&mut document, "hull(.5,.5).y");
    assert_eq!(number(&mut open(&document.text()), "hull(.5,.5).y"), edited);
    assert!(document.set(&[("P21.y".into(), f64::NAN)]).is_err());
    assert!(document.set(&[("P2l.y".into(), 1.0)]).is_err());

    let mut document = open(EVERYTHING);
    document.set(&[("shell.a2".into(), PI / 6.0), ("P-1.z".into(), 2.0)]).unwrap();
    assert!(document.text().contains("c axis 0 30;"), "{}", document.text());
    assert!(document.text().contains("A:Note(a (b) \"c\") / 0 0 2;"));
    assert_eq!(number(&mut document, "P_x2d_1.z"), 2.0);
}

#[test]
fn derivatives_by_numbers_of_the_file() {
    let mut document = open(HULL);
    let steps = [4.815 + 1e-5, 4.815 - 1e-5].map(|y| {
        document.set(&[("P21.y".into(), y)]).unwrap();
        number(&mut document, "hull(.5,.5).y")
    });
    document.set(&[("P21.y".into(), 4.815)]).unwrap();
    let all = document.derivatives(&["hull(.5,.5).y".into()], &["P21.y".into()]).unwrap();
    let Value::Number(exact) = all[0][0] else { panic!("{all:?}") };
    assert!((exact - (steps[0] - steps[1]) / 2e-5).abs() < 1e-8);
}

#[test]
fn parents_may_follow_their_children() {
    let text = "MultiSurf 0.35\nLine l 11 1 4 * A B;\nAbsPoint A 14 1 0 0 0;\nAbsPoint B 14 1 2 0 0;\nEndModel\n";
    let mut document = open(text);
    assert!(document.diagnostics().is_empty(), "{:?}", document.diagnostics());
    assert_eq!(number(&mut document, "l(.5).x"), 1.0);
    let program = document.convert(ModelFormat::Sdl).unwrap();
    assert!(!open_sdl(&program).has_errors());
}

#[test]
fn table_2_there_and_back() {
    let document = open(HULL);
    let program = document.convert(ModelFormat::Sdl).unwrap();
    let converted = open_sdl(&program);
    assert!(converted.diagnostics().is_empty(), "{program}\n{:?}", converted.diagnostics());
    assert!(program.contains("BCurve MC1({P11, P12, P13, P14}, degree = 2, divisions = 10);"));
    assert!(program.contains("# the hull of Table 2\n"));
    assert_eq!(converted.symmetry(), "y");
    assert_eq!(objects(&document), objects(&converted));
    let back = converted.convert(ModelFormat::ModelFile).unwrap();
    assert_eq!(back, document.convert(ModelFormat::ModelFile).unwrap());
    assert_eq!(objects(&open(&back)), objects(&document));
}

#[test]
fn everything_there_and_back() {
    let document = open(EVERYTHING);
    let all = document.diagnostics();
    assert!(all.len() == 1 && all[0].severity == Severity::Warning, "{all:?}");
    let program = document.convert(ModelFormat::Sdl).unwrap();
    let converted = open_sdl(&program);
    assert!(converted.diagnostics().is_empty(), "{program}\n{:?}", converted.diagnostics());
    assert_eq!(converted.symmetry(), "xy");
    assert_eq!(objects(&document), objects(&converted), "{program}");
    let back = converted.convert(ModelFormat::ModelFile).unwrap();
    // Attributes, numbers and comments: all is as it was, down to the text.
    assert_eq!(back, document.convert(ModelFormat::ModelFile).unwrap(), "{program}");
    assert!(back.contains("SolveSet S1 3 1 / { P-1\n  P.2 } 0.50;"));
    assert_eq!(open(&back).convert(ModelFormat::Sdl).unwrap(), program);
    let turned = program.replace("\"xy\"", "\"x\"").replace("\"m kg\"", "\"ft lb\"");
    let file = open_sdl(&turned).convert(ModelFormat::ModelFile).unwrap();
    assert!(file.contains("Units: ft lb\nSymmetry: x\n"), "{file}");
    assert_eq!(open(&file).symmetry(), "x");
    // The program keeps the spelling of formulas; `fmt` spaces them and wraps long lines.
    let formatted = moldloft_syntax::sdl::format(&program).unwrap();
    assert_eq!(converted.convert(ModelFormat::Sdl).unwrap(), formatted);
}

#[test]
fn any_name_may_stand_in_a_program() {
    let names = "int float string file vector farray curve surface pcurve psurface load if then else \
                 while for foreach break continue return subroutine function returned global and or \
                 not print param in assert field set x y z d1 d2 info Model Line length sin hull.1 \
                 a-b a_b a_x2d_ a_x2d-b a_xff a_x1_ _x5f_ 2nd \u{e9}t\u{e9} A+B A/B $ @1 if_ _ __x41_";
    let names: Vec<&str> = names.split_whitespace().collect();
    let mut text = String::from("MultiSurf 1.44\nBeginModel;\n");
    for (k, name) in names.iter().enumerate() {
        text += &format!("AbsPoint {name} 14 1 / {k} 0 0;\n");
    }
    text += &format!("BCurve c 11 1 8x4 / * 1 {{ {} }};\nEndModel;\n", names.join(" "));
    let mut document = open(&text);
    assert!(document.diagnostics().is_empty(), "{:?}", document.diagnostics());
    let program = document.convert(ModelFormat::Sdl).unwrap();
    let converted = open_sdl(&program);
    assert!(converted.diagnostics().is_empty(), "{program}\n{:?}", converted.diagnostics());
    assert_eq!(converted.convert(ModelFormat::ModelFile).unwrap(), text, "{program}");
    assert_eq!(
        number(&mut document, "a_x2d_b.x"),
        names.iter().position(|n| *n == "a-b").unwrap() as f64
    );
}

#[test]
fn angles_survive() {
    for k in 1..=360 {
        // Up to 15 digits: with more, two neighbours may be the same number of radians.
        let angle = f64::from(k) * 1.1 - f64::from(k % 7) / 3.0;
        let angle: f64 = format!("{angle:.12}").parse().unwrap();
        let text = format!(
            "MultiSurf 0.35\nAbsPoint A 14 1 1 0 0;\nAbsPoint B 14 1 0 0 0;\nAbsPoint C 14 1 0 0 1;\n\
             Line l 11 1 8 * A C;\nLine z 11 1 8 * B C;\nRevSurf r 10 1 8 1 8 1 0 * l z 0 {angle};\nEndModel;\n"
        );
        let back = open_sdl(&open(&text).convert(ModelFormat::Sdl).unwrap());
        assert_eq!(back.convert(ModelFormat::ModelFile).unwrap(), text);
    }
}

#[test]
fn programs_become_model_files() {
    let program = "param float w = 2 in [1, 3];\n# five ribs\nfor (i = 1:5) { AbsPoint rib(i, w / 4, 0); }\n\
                   BCurve c({rib[1], rib[3], rib[5]}, degree = 2);\nMirrPoint m(rib[2], \"y=0\", layer = 3);\n";
    let document = open_sdl(program);
    assert!(!document.has_errors(), "{:?}", document.diagnostics());
    let file = document.convert(ModelFormat::ModelFile).unwrap();
    assert_eq!(
        file,
        "MultiSurf 1.44\nBeginModel;\nRem Moldloft: 5 objects have computed numbers that no longer follow the \
         parameters: rib[1], rib[2], rib[3], rib[4], rib[5]\nRem five ribs\nAbsPoint rib[1] 14 1 / 1 0.5 0;\nAbsPoint rib[2] 14 1 / 2 0.5 0;\n\
         AbsPoint rib[3] 14 1 / 3 0.5 0;\nAbsPoint rib[4] 14 1 / 4 0.5 0;\nAbsPoint rib[5] 14 1 / 5 0.5 0;\n\
         BCurve c 11 1 8x4 / * 2 { rib[1] rib[3] rib[5] };\nMirrPoint m 14 1 A:Layer(3) / rib[2] *Y=0;\nEndModel;\n"
    );
    assert!(open(&file).diagnostics().is_empty());

    // What model files have no words for is named.
    let anonymous = open_sdl("AbsPoint A(0, 0, 0);\nLine l(A, {1, 2, 3});\n");
    let errors = anonymous.convert(ModelFormat::ModelFile).unwrap_err();
    assert_eq!((&*errors[0].id, errors[0].object.as_deref()), ("not-in-model-files", Some("l")));
    let errors = open_sdl("AbsPoint A(0, 0);").convert(ModelFormat::ModelFile).unwrap_err();
    assert_eq!(errors.len(), 1);
}

#[test]
fn bad_files_are_told_apart() {
    let head = "MultiSurf 0.35\nAbsPoint A 14 1 0 0 0;\nAbsPoint B 14 1 1 0 0;\nLine l 11 1 4 * A B;\n\
                AbsPoint D 14 1 0 1 0;\nLine k 11 1 4 * B D;\nRuledSurf hull 10 1 4 1 4 1 0 * l k;\n";
    for (line, id, place, says) in [
        ("AbsPoint C 14 1 0 0", "missing-semicolon", "", "insert `;`"),
        ("AbsPiont C 14 1 0 0 0;", "unknown-entity", "AbsPiont", "AbsPoint"),
        ("Line n 11 1 4 * A Hull;", "unknown-object", "Hull", "hull"),
        ("Line n 11 1 4 * A hull;", "wrong-class", "hull", "a surface"),
        ("RuledSurf s 10 1 4 1 4 1 0 * l hull;", "wrong-class", "hull", "expected a curve"),
        ("BCurve c 11 1 4 * 2 { A l };", "wrong-class", "l", "a curve"),
        ("AbsPoint A 14 1 0 0 0;", "duplicate-name", "A", "first declared here"),
        ("Line n 11 1 1000000000 * A B;", "out-of-range", "1000000000", "1000000"),
        (
            "RuledSurf s 10 1 4 1 1000000000 1 0 * l k;",
            "out-of-range",
            "4 1 1000000000 1",
            "1000000",
        ),
        ("AbsPoint C 14 1 0 nan 0;", "not-a-number", "nan", "finite"),
        ("AbsPoint C 14 1 0 inf 0;", "not-a-number", "inf", "finite"),
        ("AbsPoint C 14 1 0 1e999 0;", "bad-number", "1e999", "1.797e308"),
        ("AbsPoint C 14 1 0 0;", "missing-field", "", "x y z"),
        ("AbsPoint C 14 1 0 0 0 0;", "too-many-fields", "0", "x y z"),
        ("AbsPoint C;", "missing-field", "", "colour"),
        ("AbsPoint C 300 1 0 0 0;", "out-of-range", "300", "255"),
        ("BCurve c 11 1 4 * 0 { A B };", "out-of-range", "0", "at least 1|from 1"),
        ("BCurve c 11 1 4 * 2 A;", "not-a-list", "A", "list"),
        ("Line n 11 1 4 * A A2; Line n2 11 1 4 * A n;", "unknown-object", "A2", "want of it: n2"),
        ("Line n 11 1 4 bend A B;", "unsupported-relabel", "bend", "without its relabel"),
        ("AbsBead b 14 1 l =half;", "bad-formula", "=half", "unknown name `half`"),
        ("MirrPoint m 14 1 A *W=0;", "unknown-object", "*W=0", "*Y=0"),
        ("CCurve c 11 1 4 * 3 { A A B };", "coincident-points", "A", ""),
    ] {
        let found = faults(&format!("{head}{line}\nEndModel\n"));
        let hit = found.iter().find(|(i, ..)| i == id);
        let Some((_, at, text)) = hit else { panic!("{line}: {found:#?}") };
        if !place.is_empty() {
            assert_eq!(at, place, "{line}: {text}");
        }
        assert!(says.split('|').any(|s| text.contains(s)), "{line}: {text}");
        assert!(found.len() <= 2, "{line}: {found:#?}");
    }
    assert_eq!(faults("hello")[0].0, "not-a-model-file");
    for length in head.len() - 30..head.len() - 1 {
        let found = faults(&head[..length]);
        assert!(found.iter().any(|f| f.0 == "truncated-file"), "{found:?}");
    }
}

#[test]
fn cycles_are_told_with_their_path() {
    let text = "MultiSurf 0.35\nRelPoint a 14 1 c 0 0 1;\nRelPoint b 14 1 a 0 0 1;\nRelPoint c 14 1 b 0 0 1;\n\
                RelPoint d 14 1 b 0 0 1;\nRelPoint e 14 1 e 0 0 1;\nAbsPoint ok 14 1 0 0 0;\nEndModel\n";
    let document = open(text);
    let all = document.diagnostics();
    assert_eq!(all.iter().map(|d| &*d.id).collect::<Vec<_>>(), ["cycle", "cycle"]);
    assert_eq!(all[0].found.as_deref(), Some("a -> c -> b -> a"));
    assert_eq!(all[1].found.as_deref(), Some("e -> e"));
    assert!(format!("{:?}", all[0]).contains("want of it: d"));
    assert_eq!(document.graph().len(), 1);
}

#[test]
fn what_is_built_on_unknown_entities_is_told_once() {
    let text = "MultiSurf 0.35\nWarpPoint w 14 1 0 0 1;\nRelPoint a 14 1 w 0 0 1;\nRelPoint b 14 1 a 0 0 1;\n\
                RelPoint c 14 1 w 0 0 1;\nEndModel;\n";
    let found = faults(text);
    assert_eq!(found.iter().map(|f| &*f.0).collect::<Vec<_>>(), ["unknown-entity", "blocked"]);
    assert!(found[1].2.contains("a, b, c"));
    // It is converted all the same, and comes back as it was.
    let document = open(text);
    let program = document.convert(ModelFormat::Sdl).unwrap();
    assert_eq!(open_sdl(&program).convert(ModelFormat::ModelFile).unwrap(), text);
}

struct Bytes(&'static [u8]);

impl World for Bytes {
    fn read(&self, path: &str, _: Option<&str>) -> Result<ReadText, TextReadError> {
        Ok(ReadText { name: path.into(), bytes: self.0.into() })
    }
}

#[test]
fn binary_files_are_refused() {
    let bytes = b"MultiSurf 0.35\n\0\x01\x02\xff\xfe";
    let document = Document::open(registry(), Box::new(Bytes(bytes)), "model.ms2");
    assert!(document.has_errors() && document.graph().is_empty());
}

#[test]
fn a_hundred_thousand_objects_in_reverse() {
    let mut text = String::from("MultiSurf 0.35\n");
    for k in (1..100_000).rev() {
        text += &format!("RelPoint p{k} 14 1 p{} 0 0 1;\n", k - 1);
    }
    text += "AbsPoint p0 14 1 0 0 0;\nEndModel\n";
    let mut document = open(&text);
    assert!(document.diagnostics().is_empty());
    assert_eq!(number(&mut document, "p99999.z"), 99_999.0);
    // One round of them all.
    let round = text.replace("AbsPoint p0 14 1", "RelPoint p0 14 1 p99999");
    let document = open(&round);
    assert_eq!(document.diagnostics().len(), 1);
    assert_eq!(document.diagnostics()[0].id, "cycle");
}

/// Whatever is damaged, reading says what is wrong, and what it takes converts there and back.
#[test]
fn damaged_files() {
    let mut source = moldloft_testing::Random::new(5);
    let mut random = |below: usize| source.below(below);
    let rounds = moldloft_testing::rounds(400, 40_000);
    let mut converted = 0;
    for k in 0..rounds {
        let mut text = if k % 2 == 0 { HULL } else { EVERYTHING }.to_string();
        for _ in 0..=random(2) {
            let words: Vec<(usize, &str)> = text
                .split_whitespace()
                .map(|word| (word.as_ptr() as usize - text.as_ptr() as usize, word))
                .collect();
            let (at, word) = words[random(words.len())];
            let (_, other) = words[random(words.len())];
            let new = match random(5) {
                0 => String::new(),
                1 => other.to_string(),
                2 => format!("{word} {other}"),
                3 => word.chars().take(word.len() / 2).collect(),
                _ => [";", "*", "{", "}", "nan", "-1", "1e300", "#", "\"", "=x", "/"][random(11)]
                    .into(),
            };
            let range = at..at + word.len();
            text.replace_range(range, &new);
        }
        let document = open(&text);
        let Ok(program) = document.convert(ModelFormat::Sdl) else { continue };
        converted += 1;
        let again = open_sdl(&program);
        let reported = again.diagnostics();
        let built = |d: &moldloft_diag::Diagnostic| {
            d.object.as_deref().is_some_and(|o| again.graph().find(o).is_some())
        };
        let ours: Vec<_> = reported.iter().filter(|d| d.is_error() && !built(d)).collect();
        assert!(ours.is_empty(), "{text}\n{program}\n{ours:#?}");
        let back = again.convert(ModelFormat::ModelFile).unwrap();
        let reread = open(&back);
        assert_eq!(objects(&reread), objects(&document), "{text}\n{back}");
        let second = open_sdl(&reread.convert(ModelFormat::Sdl).unwrap());
        assert_eq!(second.convert(ModelFormat::ModelFile).unwrap(), back);
    }
    assert!(converted > rounds / 8, "{converted} of {rounds}");
}

#[test]
fn the_given_table_2_is_ours() {
    let here = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = here.join("../../../shared/fixtures/table2.ms2");
    let Ok(text) = std::fs::read_to_string(path) else { return };
    assert_eq!(objects(&open(&text)), objects(&open(HULL)));
}

/// What a program states by names is a relation of the model file, and again one of the program made from that.
#[test]
fn relations_stay_relations_both_ways() {
    let program = "param float w = 2 in [1, 3];\nparam float turn = 0.5 in [0.1, 1];\nparam int n = 3 in [1, 5];\n\
        float half = w/2; float kept = 0.25; float twice = 1; twice = 2;\n\
        AbsPoint A(0, half, -kept); AbsPoint B(4, w, sqrt(w) + A.y); AbsPoint C(n, twice, 2*PI);\n\
        Line axis(A, C); Line l(A, B);\n\
        RevSurf s(l, axis, 0, turn);\n";
    let mut document = open_sdl(program);
    assert!(!document.has_errors(), "{:?}", document.diagnostics());
    let (file, remarks) = document.convert_with_remarks(ModelFormat::ModelFile).unwrap();
    for line in [
        "Variable w 2 1 3;",
        "Variable turn 0.5 0.1 1;",
        "Formula half [w/2];",
        "Formula kept [0.25];",
        "AbsPoint A 14 1 / 0 =half [-kept];",
        "AbsPoint B 14 1 / 4 =w [sqrt(w) + A.y];",
        // A whole number, and what is assigned twice.
        "AbsPoint C 14 1 / 3 2 6.283185307179586;",
        "A:Moldloft(divisions *) / * l axis 0 [(turn)*57.29577951308232];",
        "Rem Moldloft: 1 object has computed numbers that no longer follow the parameters: C",
    ] {
        assert!(file.contains(line), "{line}\n{file}");
    }
    assert!(!file.contains("Variable n") && !file.contains("twice"), "{file}");
    assert_eq!(&*remarks[0].id, "numbers-fixed");
    let mut again = open(&file);
    assert!(again.diagnostics().is_empty(), "{:?}", again.diagnostics());
    let mut third = open_sdl(&again.convert(ModelFormat::Sdl).unwrap());
    assert!(third.diagnostics().is_empty(), "{:?}", third.diagnostics());
    for (w, turn) in [(2.0, 0.5), (1.25, 0.9)] {
        for d in [&mut document, &mut again, &mut third] {
            d.set(&[("w".into(), w), ("turn".into(), turn)]).unwrap();
        }
        for text in ["A.y", "B.z", "l.length"] {
            let value = number(&mut document, text);
            assert_eq!(number(&mut again, text), value);
            assert_eq!(number(&mut third, text), value);
        }
        let area = number(&mut document, "s.area");
        assert!((number(&mut third, "s.area") / area - 1.0).abs() < 1e-12);
    }
    // The file and the program made from it say the same of all relations.
    assert_eq!(
        third.convert(ModelFormat::ModelFile).unwrap().matches('=').count(),
        file.matches('=').count()
    );
}

/// Arguments that have no column are attributes of their names.
#[test]
fn arguments_without_columns_travel_by_name() {
    let program = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(1, 1, 0); AbsPoint D(3, 1, 0);\n\
        Line p(A, B); Line q(B, C); Line r(C, D);\n\
        PolyCurve c({p, q, r}, breaks = {0.2, 0.7});\nWeight w(C, 12.5);\n\
        BCurve far({A, B, C, D}, degree = 2, divisions = 5);\nTranSurf t(far, q, divisions = {4, 3});\nTranSurf u(c, q);\n";
    let document = open_sdl(program);
    assert!(!document.has_errors(), "{:?}", document.diagnostics());
    let file = document.convert(ModelFormat::ModelFile).unwrap();
    assert!(
        file.contains("PolyCurve c 11 1 8x4 A:Moldloft(breaks { 0.2 0.7 }) / * { p q r };"),
        "{file}"
    );
    assert!(file.contains("Weight w 12 1 A:Moldloft("), "{file}");
    assert!(
        file.contains("TranSurf t 10 1 4x1 3x1 0 /")
            && file.contains("TranSurf u 10 1 8x1 8x1 0 A:Moldloft(divisions *) /"),
        "{file}"
    );
    let again = open(&file);
    assert!(again.diagnostics().is_empty(), "{:?}", again.diagnostics());
    assert_eq!(objects(&document).len(), objects(&again).len());
    assert_eq!(again.convert(ModelFormat::ModelFile).unwrap(), file);
    // Renamed like any mention, moved like any number.
    let mut again = again;
    again.rename("C", "corner").unwrap();
    assert!(again.text().contains("corner") && !again.text().contains(" C "), "{}", again.text());
    again.set(&[("c.breaks[2]".into(), 0.75)]).unwrap_or_else(|found| panic!("{found:?}"));
    assert!(again.text().contains("A:Moldloft(breaks { 0.2 0.75 })"), "{}", again.text());
    for (from, to, id) in [
        ("(breaks {", "(brakes {", "unknown-argument"),
        ("{ 0.2 0.7 })", "{ 0.2 0.7 } 3)", "unknown-argument"),
        ("{ 0.2 0.7 })", "nothing)", "not-a-list"),
        ("{ 0.2 0.7 })", "{ 0.2 half })", "not-a-number"),
        ("{ 0.2 0.7 })", "{ 0.2 0.7 }", "unclosed-bracket"),
        ("(divisions *)", "(divisions x)", "wrong-length"),
    ] {
        let found = faults(&file.replace(from, to));
        assert!(found.iter().any(|(i, ..)| i == id), "{to}: {found:?}");
    }
}

/// Order, entity words and unused variables of a file outlast the way through a program.
#[test]
fn order_and_words_survive() {
    let text = "MultiSurf 1.44
Units: m kg
BeginModel;
Rem a bead before its point
AbsBead b 10 1 / c 0.25;
PolyCurve2 c 11 1 8x4 / * { l };
Foo f 1 1 / A B
  12;
Variable unused 2.5 1 5;
Line l 11 1 8x4 / * A B;

Rem the points
AbsPoint A 14 1 / 0 1.25 0;
AbsPoint B 14 1 / 5 2.25 0;
EndModel;
";
    let program = open(text).convert(ModelFormat::Sdl).unwrap();
    let back = open_sdl(&program).convert(ModelFormat::ModelFile).unwrap();
    assert_eq!(back, text, "{program}");
}

/// Variables and formulas, used as words, by `=` and in brackets, above and below their uses.
const REALS: &str = "\
MultiSurf 1.44
BeginModel;
AbsPoint A 14 1 / 0 =half [2*beam - 1];
AbsPoint B 14 1 / beam A.z 0;
AbsPoint C 14 1 / [A.z + B.x] 0 0;
Line l 11 1 8x4 / * A B;
Line m 11 1 8x4 / * A C;
RevSurf s 10 1 8x1 8x1 0 / * l m 0 [10*beam];
Formula half [beam/2];
Variable beam 3 1 5;
Variable depth 14 1 / 2 0 4;
Formula area [l.length*depth];
AbsPoint D 14 1 / area depth 0;
EndModel;
";

#[test]
fn variables_and_formulas_are_computed() {
    let text = REALS.replace("beam A.z 0", "beam [A.z] 0");
    let mut document = open(&text);
    assert!(document.diagnostics().is_empty(), "{:?}", document.diagnostics());
    let names: Vec<&str> = document.params().iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["beam", "depth"]);
    assert_eq!(document.params()[0].range, Some((1.0, 5.0)));
    for (text, value) in [("A.y", 1.5), ("A.z", 5.0), ("B.y", 5.0), ("C.x", 8.0), ("half", 1.5)] {
        assert_eq!(number(&mut document, text), value, "{text}");
    }
    let length = (9.0_f64 + 3.5 * 3.5 + 25.0).sqrt();
    assert!((number(&mut document, "area") - 2.0 * length).abs() < 1e-11);
    assert!((number(&mut document, "s.a2") - PI / 6.0).abs() < 1e-15);
    // Edits and derivatives.
    let exact = document.derivatives(&["D.x".into(), "s.a2".into()], &["beam".into()]).unwrap();
    document.set(&[("beam".into(), 4.0)]).unwrap();
    assert_eq!((number(&mut document, "A.y"), number(&mut document, "C.x")), (2.0, 11.0));
    let mut at = |x: f64| {
        document.set(&[("beam".into(), x)]).unwrap();
        number(&mut document, "D.x")
    };
    let Value::Number(d) = exact[0][0] else { panic!() };
    assert!((d - (at(3.0 + 1e-5) - at(3.0 - 1e-5)) / 2e-5).abs() < 1e-8);
    let Value::Number(d) = exact[1][0] else { panic!() };
    assert!((d - PI / 18.0).abs() < 1e-15);
    assert_eq!(document.set(&[("beam".into(), 6.0)]).unwrap_err()[0].id, "out-of-range");
    let refused = document.set(&[("A.y".into(), 6.0)]).unwrap_err();
    assert_eq!(refused[0].id, "not-a-literal");
    // The other form says the same.
    document.set(&[("beam".into(), 3.0)]).unwrap();
    let program = document.convert(ModelFormat::Sdl).unwrap();
    assert!(program.contains("param float beam = 3 in [1, 5];\n"), "{program}");
    assert!(program.contains("float half = beam/2;\n"), "{program}");
    let mut converted = open_sdl(&program);
    assert!(converted.diagnostics().is_empty(), "{program}\n{:?}", converted.diagnostics());
    for text in ["C.x", "D.x", "s(0.3, 0.8).z"] {
        let (a, b) = (number(&mut document, text), number(&mut converted, text));
        assert!((a - b).abs() < 1e-14, "{text}");
    }
    // Faults: a word in place of a number, a cycle, what is not a number.
    for (from, to, id) in [
        ("[beam/2]", "[beam/]", "bad-formula"),
        ("[beam/2]", "[A.z]", "cycle"),
        ("[beam/2]", "[l]", "cycle"),
        ("[beam/2]", "[beam/0]", "bad-formula"),
        ("[beam/2]", "[lost*2]", "bad-formula"),
        ("beam 3 1 5", "beam 7 1 5", "out-of-range"),
        ("beam 3 1 5", "beam 7 1", "missing-field"),
        ("[beam/2]", "", "missing-field"),
        ("* A B", "* A beam", "wrong-class"),
    ] {
        let found = faults(&text.replace(from, to));
        assert!(found[0].0 == id, "{to}: {found:?}");
    }
}

#[test]
fn objects_of_model_files_are_renamed_and_deleted() {
    let text = REALS.replace("beam A.z 0", "beam [A.z] 0");
    let mut document = open(&text);
    let before = number(&mut document, "C.x");
    document.set(&[("B.z".into(), 0.25)]).unwrap();
    document.rename("A", "bow").unwrap();
    document.rename("beam", "width").unwrap();
    let renamed = document.text();
    assert!(renamed.contains("AbsPoint bow 14 1 / 0 =half [2*width - 1];"), "{renamed}");
    assert!(renamed.contains("AbsPoint B 14 1 / width [bow.z] 0.25;"), "{renamed}");
    assert!(renamed.contains("/ * bow B;") && renamed.contains("Variable width 3 1 5;"));
    assert!(document.diagnostics().is_empty(), "{:?}", document.diagnostics());
    assert_eq!(number(&mut document, "C.x"), before);
    for (old, new, id) in [
        ("bow", "B", "duplicate-name"),
        ("bow", "2", "not-a-name"),
        ("bow", "a b", "not-a-name"),
        ("bow", "Rem", "not-a-name"),
        ("bew", "c", "unknown-name"),
    ] {
        assert_eq!(document.rename(old, new).unwrap_err().id, id);
    }
    let kept = document.delete("bow").unwrap_err();
    assert!(
        kept.id == "has-dependents"
            && kept.found.as_deref().unwrap_or_default().contains("B, C, l")
    );
    assert_eq!(document.delete("depth").unwrap_err().id, "has-dependents");
    assert_eq!(document.delete("nothing").unwrap_err().id, "unknown-name");
    document.delete("D").unwrap();
    document.delete("area").unwrap();
    document.delete("depth").unwrap();
    assert!(document.diagnostics().is_empty(), "{:?}", document.diagnostics());
    assert!(!document.text().contains("area") && document.text().contains("EndModel;"));
    assert_eq!(document.params().len(), 1);
}

#[test]
fn entities_that_have_other_words_in_model_files_are_read() {
    let text = "MultiSurf 1.44
BeginModel;
AbsPoint A 14 1 / 0 0 0;
AbsPoint B 14 1 / 4 0 0;
AbsPoint C 14 1 / 4 2 0;
AbsPoint D 14 1 / 4 2 3;
CGPoint g 14 1 / { A B C };
Line l 11 1 8x4 / * A B;
Line m 11 1 8x4 / * B C;
PolyCurve2 p 11 1 8x4 / * { l m };
3PtPlane flat 11 1 / A B C;
2PtPlane across 11 1 / A B;
ProjPoint f 14 1 / D flat;
EndModel;
";
    let mut d = Document::from_text(registry(), Box::new(NoFiles), "words.ms2", text);
    assert!(d.diagnostics().is_empty(), "{:?}", d.diagnostics());
    let mut at = |text: &str| match d.eval(text) {
        Ok(Value::Point(p)) => p.xyz,
        Ok(Value::Vector(v)) => v,
        other => panic!("{text}: {other:?}"),
    };
    assert!(at("g").distance(Vec3::of(8.0 / 3.0, 2.0 / 3.0, 0.0)) < 1e-15);
    assert_eq!(at("p(0.75)"), Vec3::of(4.0, 1.0, 0.0));
    assert_eq!(at("f"), Vec3::of(4.0, 2.0, 0.0));
}
