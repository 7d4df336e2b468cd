//! Sketches in a model: parameters, objects, the solid, derivatives, refusals.

use crate::common::number;
use moldloft_document::{Document, NoFiles, ReadText, TextReadError, World, registry};
use moldloft_registry::Value;
use std::collections::BTreeMap;

const DAM: &str = include_str!("../../../../examples/sketch/dam.skt");
const BRACKET: &str = include_str!("../../../../examples/sketch/bracket.skt");

/// A few files in memory.
struct Shelf(BTreeMap<String, String>);

impl World for Shelf {
    fn read(&self, path: &str, _: Option<&str>) -> Result<ReadText, TextReadError> {
        match self.0.get(path) {
            Some(text) => Ok(ReadText { name: path.into(), bytes: text.as_bytes().into() }),
            None => Err(TextReadError { message: format!("there is no `{path}`"), help: None }),
        }
    }
}

fn shelf(files: &[(&str, &str)]) -> Box<Shelf> {
    Box::new(Shelf(files.iter().map(|(n, t)| ((*n).to_owned(), (*t).to_owned())).collect()))
}

fn model(text: &str) -> Document {
    // One model has one unit.
    let bracket = &BRACKET.replace("SET UNITS MM", "SET UNITS FT");
    let files = [("dam.skt", DAM), ("bracket.skt", bracket), ("deep/dam.skt", DAM)];
    Document::from_text(registry(), shelf(&files), "site.sdl", text)
}

fn fine(document: &Document) {
    assert!(!document.has_errors(), "{:#?}", document.diagnostics());
}

#[test]
fn a_sketch_becomes_parameters_and_objects() {
    let mut m = model("load \"dam.skt\"; AbsPoint top(dam.p4.x, 0, dam.p4.z + dam.CREST);");
    fine(&m);
    let names: Vec<&str> = m.params().iter().map(|p| p.name.as_str()).collect();
    // RUN is an expression, so it is not a parameter but has a value.
    assert_eq!(names, ["dam.CREST", "dam.LENGTH1", "dam.HEIGHT", "dam.PARAPET"]);
    assert_eq!(m.params()[0].range, Some((10.0, 30.0)));
    assert_eq!(number(&mut m, "dam.RUN"), 54.0);
    for (text, want) in [
        ("dam.volume", 169_200.0),
        ("dam.solid.volume", 169_200.0),
        ("dam.area", 20_968.0),
        ("dam.centroid.y", 25.0),
        ("dam.p4.z", 90.0),
        ("top.z", 106.0),
        ("dam.l1.length", 70.0),
        ("dam.face1(0.5, 0.5).y", 0.0),
        // Sketches do not tell small letters from capitals.
        ("DAM.p4.z", 90.0),
        ("dam.crest", 16.0),
    ] {
        let found = number(&mut m, text);
        assert!((found - want).abs() < 1e-6, "{text}: {found} for {want}");
    }
    m.set(&[("dam.CREST".into(), 20.0)]).unwrap();
    fine(&m);
    assert!((number(&mut m, "dam.volume") - 187_200.0).abs() < 1e-6);
    assert_eq!(number(&mut m, "top.z"), 110.0);
    // Only what depends on the crest was evaluated again: not the points of the base.
    let applied = m.applied();
    assert!(applied.evaluated < applied.objects, "{applied:?}");
    // Edits of the text keep the values of dimensions.
    m.set_text("load \"dam.skt\"; float v = dam.volume;");
    assert!((number(&mut m, "v") - 187_200.0).abs() < 1e-6);
}

#[test]
fn derivatives_are_differences() {
    let mut m = model("load \"bracket.skt\"; AbsPoint P(bracket.p4.x * bracket.R, 0, 0);");
    fine(&m);
    let by: Vec<String> = ["bracket.R", "bracket.THICK", "bracket.LEG"].map(String::from).to_vec();
    let texts: Vec<String> =
        ["bracket.volume", "P.x", "bracket.F1(0.3).x", "bracket.area", "bracket.p13.x"]
            .map(String::from)
            .to_vec();
    let found = m.derivatives(&texts, &by).unwrap();
    for (k, name) in by.iter().enumerate() {
        let x = m.params().iter().find(|p| p.name == *name).unwrap().value;
        let h = 1e-5;
        let mut at = |value: f64| -> Vec<f64> {
            m.set(&[(name.clone(), value)]).unwrap();
            texts.iter().map(|t| number(&mut m, t)).collect()
        };
        let (up, down) = (at(x + h), at(x - h));
        at(x);
        for (t, text) in texts.iter().enumerate() {
            let Value::Number(exact) = found[t][k] else { panic!("{text}") };
            let slope = (up[t] - down[t]) / (2.0 * h);
            assert!(
                (exact - slope).abs() < 1e-5 * slope.abs().max(1.0),
                "{text} by {name}: {exact} {slope}"
            );
        }
    }
}

#[test]
fn a_sketch_under_a_name_of_its_own() {
    let text = "param float w = 20 in [10, 30];
                Sketch low(\"dam.skt\", CREST = w); Sketch high(\"dam.skt\", height = 90);
                float both = low.volume + high.volume;";
    let mut m = model(text);
    fine(&m);
    assert!((number(&mut m, "low.volume") - 187_200.0).abs() < 1e-6);
    let high = 50.0 * (16.0 * 108.0 + 67.5 * 90.0 / 2.0);
    assert!((number(&mut m, "both") - 187_200.0 - high).abs() < 1e-6);
    let slope = m.derivatives(&["both".into()], &["w".into()]).unwrap();
    let Value::Number(slope) = slope[0][0] else { panic!() };
    assert!((slope - 4500.0).abs() < 1e-8);
    let faults = |text: &str| -> Vec<String> {
        model(text).diagnostics().iter().map(|d| d.id.to_string()).collect()
    };
    assert_eq!(faults("Sketch a(\"dam.skt\", CRESTT = 3);"), ["unknown-argument"]);
    assert_eq!(faults("Sketch a(3);"), ["wrong-argument"]);
    assert_eq!(faults("Sketch a(\"none.skt\");"), ["cannot-read"]);
    assert_eq!(faults("for (i = 1:2) { load \"dam.skt\"; }"), ["misplaced-load"; 1]);
    let mut loops = model("for (i = 1:2) { Sketch d(\"dam.skt\", CREST = 10 + i); }");
    fine(&loops);
    assert!((number(&mut loops, "d[2].volume") - 50.0 * (12.0 * 90.0 + 54.0 * 36.0)).abs() < 1e-6);
}

#[test]
fn a_sketch_file_is_a_model() {
    let mut m = Document::open(registry(), shelf(&[("dam.skt", DAM)]), "dam.skt");
    fine(&m);
    assert!((number(&mut m, "dam.volume") - 169_200.0).abs() < 1e-6);
    m.set(&[("dam.HEIGHT".into(), 60.0)]).unwrap();
    assert!((number(&mut m, "dam.p2.x") - 61.0).abs() < 1e-9);
    assert_eq!(m.text(), DAM);
    m.set_text(&DAM.replace("CREST X 1 TO 3 = 16", "CREST X 1 TO 3 = 18"));
    assert!((number(&mut m, "dam.p2.x") - 63.0).abs() < 1e-9);
    let found = m.set(&[("dam.p2.x".into(), 1.0)]).unwrap_err();
    assert_eq!(found[0].id, "not-a-literal");
    assert!(format!("{found:?}").contains("dam.CREST"));
    let found = m.set(&[("dam.CREST".into(), 99.0)]).unwrap_err();
    assert_eq!(found[0].id, "out-of-range");
}

#[test]
fn faults_point_into_the_sketch() {
    let bad = "SKETCH A\nPOINT 1 0 0\nLINE 1 2\nRUN \"other.skt\"\n";
    let files = [("a.skt", bad), ("other.skt", "POINT 2 5 0\nLINE 1 2\nPOINT x\n")];
    let m = Document::from_text(registry(), shelf(&files), "m.sdl", "load \"a.skt\";");
    let found = m.diagnostics();
    let spans: Vec<(&str, &str)> =
        found.iter().map(|d| (d.id.as_ref(), m.sources().slice(d.span()))).collect();
    assert_eq!(
        spans,
        [
            ("refused-command", "LINE 1 2"),
            ("refused-command", "RUN \"other.skt\""),
            ("sketch-incomplete", "load \"a.skt\";")
        ],
        "{found:#?}"
    );
    assert!(found.iter().take(2).all(|d| !d.help.is_empty()));
    let loops = [("a.skt", "RUN \"b.skt\""), ("b.skt", "RUN \"a.skt\"")];
    let m = Document::from_text(registry(), shelf(&loops), "m.sdl", "load \"a.skt\";");
    assert!(m.has_errors());
    let m = Document::from_text(registry(), Box::new(NoFiles), "m.sdl", "load \"a.skt\";");
    assert_eq!(m.diagnostics()[0].id, "cannot-read");
    let m = Document::from_text(registry(), Box::new(NoFiles), "m.skt", "{\"format\": 1}");
    assert_eq!(m.diagnostics()[0].id, "no-sketch");
}

#[test]
fn a_section_that_crosses_itself_has_no_body() {
    let run = "= \"0.75*HEIGHT\"";
    assert!(DAM.contains(run));
    let text = DAM.replace(run, "= 54 IN -30 60");
    let mut m = Document::open(registry(), shelf(&[("dam.skt", &text)]), "dam.skt");
    fine(&m);
    // The toe passes the heel: the downstream face crosses the upstream one.
    m.set(&[("dam.RUN".into(), -21.0)]).unwrap();
    let found = m.diagnostics();
    let invalid = found.iter().find(|d| d.id == "sketch-invalid");
    assert!(invalid.is_some_and(|d| !d.help.is_empty()), "{found:#?}");
    assert!(m.eval("dam.volume").is_err());
    m.set(&[("dam.RUN".into(), 54.0)]).unwrap();
    assert!((number(&mut m, "dam.volume") - 169_200.0).abs() < 1e-6);
}

/// What a run of edits leaves is what a run from scratch makes, bit for bit.
#[test]
fn edits_leave_what_a_fresh_run_makes() {
    let text = "load \"bracket.skt\"; load \"dam.skt\";";
    let mut edited = model(text);
    let mut random = moldloft_testing::Random::new(7);
    for _ in 0..20 {
        let (name, low, high) = *random.pick(&[("bracket.R", 0.1, 1.0), ("dam.CREST", 10.0, 30.0)]);
        let value = random.between(low, high);
        edited.set(&[(name.into(), value)]).unwrap();
    }
    let mut fresh = model(text);
    let values: Vec<(String, f64)> =
        edited.params().iter().map(|p| (p.name.clone(), p.value)).collect();
    fresh.set(&values).unwrap();
    for object in fresh.graph().objects() {
        let other = edited.graph().find(&object.name).and_then(|k| edited.graph().get(k)).unwrap();
        match (object.value(), other.value()) {
            (Some(Value::Point(a)), Some(Value::Point(b))) => assert!(a.xyz.bits_eq(b.xyz)),
            (Some(Value::Body(a)), Some(Value::Body(b))) => assert!(a.same(b)),
            (a, b) => assert_eq!(a.is_some(), b.is_some()),
        }
    }
    assert!(fresh.graph().len() == edited.graph().len() && fresh.graph().len() > 60);
}

/// The solid is panelled with the model: closed, exact for plane faces, as many panels for all sizes.
#[test]
fn the_solid_is_a_mesh_of_the_model() {
    let mut m = model("load \"dam.skt\"; load \"bracket.skt\";");
    let panelled = m.panelled().unwrap();
    let names: Vec<&str> = panelled.mesh.patches().iter().map(|p| p.info.name.as_str()).collect();
    assert_eq!(names, ["dam.solid", "bracket.solid"]);
    let report = panelled.mesh.report();
    assert!(report.closed && report.manifold && report.outward == Some(true), "{report:?}");
    let panels = panelled.mesh.faces().len();
    let volume = number(&mut m, "mesh.volume");
    assert!((volume - 169_227.16).abs() < 0.01, "{volume}");
    m.set(&[("bracket.R".into(), 0.7), ("dam.HEIGHT".into(), 60.0)]).unwrap();
    assert_eq!(m.panelled().unwrap().mesh.faces().len(), panels);
    // Vertices have derivatives: the whole crest moves with the height.
    let columns = m.jacobian(&["dam.HEIGHT".into()]).unwrap();
    let moved = columns[0].iter().filter(|d| d.z == 1.0).count();
    assert_eq!(moved, 6);
    let slope = m.derivatives(&["mesh.volume".into()], &["dam.HEIGHT".into()]).unwrap();
    let Value::Number(slope) = slope[0][0] else { panic!() };
    // 50 (CREST + 0.75 HEIGHT) at HEIGHT = 60.
    assert!((slope - 50.0 * 61.0).abs() < 1e-6, "{slope}");
}

/// The body as a set: its faces are the primitives, so that volumes agree to rounding and derivatives by
/// dimensions are exact.
#[test]
fn the_body_is_an_exact_set() {
    let mut m = model("load \"dam.skt\"; load \"bracket.skt\";");
    let exact = number(&mut m, "dam.volume");
    let found = number(&mut m, "volume(dam.body, {-1,-1,-1}, {71,51,91}, 1)");
    assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
    let slope = |m: &mut Document, what: &str, by: &str| {
        let d = m.derivatives(&[what.into()], &[by.into()]).unwrap();
        let Value::Number(d) = d[0][0] else { panic!() };
        d
    };
    let by = |m: &mut Document, name: &str| {
        let implicit = slope(m, "volume(dam.body, {-1,-1,-1}, {71,51,91}, 1)", name);
        let exact = slope(m, "dam.volume", name);
        assert!(
            (implicit - exact).abs() < 1e-6 * exact.abs().max(1.0),
            "{name}: {implicit} {exact}"
        );
    };
    by(&mut m, "dam.HEIGHT");
    by(&mut m, "dam.CREST");
    // The fillet is a cylinder, not its chords.
    let exact = number(&mut m, "bracket.volume");
    let found = number(&mut m, "volume(bracket.body, {-99,-99,-99}, {99,99,99}, 1e-3)");
    assert!((found - exact).abs() < 1e-3, "{found} {exact}");
    let chords = number(&mut m, "bracket.solid.volume");
    assert!((chords - exact).abs() < 1e-9);
}

#[test]
fn a_sketch_has_the_unit_that_it_states_and_only_one() {
    const SHED: &str = include_str!("../../../../examples/sketch/shed.skt");
    let open = |text: &str| Document::from_text(registry(), Box::new(NoFiles), "shed.skt", text);
    assert_eq!(open(SHED).units(), "m");
    assert_eq!(open(&SHED.replace("SET UNITS M\n", "SET UNITS FT\n")).units(), "ft");
    let unstated = open(&SHED.replace("SET UNITS M\n", ""));
    assert_eq!(unstated.units(), "mm");
    assert!(unstated.assumed_unit().is_some_and(|d| d.id == "assumed-unit"));
    assert!(open(SHED).assumed_unit().is_none());
    // A program that loads it has the same unit, with the same warning, unless it states one.
    let bare = BRACKET.replace("SET UNITS MM\n", "");
    let world = || shelf(&[("bracket.skt", bare.as_str())]);
    let model = |text: &str| Document::from_text(registry(), world(), "site.sdl", text);
    let loaded = model("load \"bracket.skt\";");
    assert_eq!(loaded.units(), "mm");
    let warned = |m: &Document| m.assumed_unit().is_some_and(|d| d.message.contains("bracket"));
    assert!(warned(&loaded));
    let stated = model("Model info(units = \"ft\"); load \"bracket.skt\";");
    assert_eq!((stated.units().as_str(), warned(&stated)), ("ft", false));
    // The second object is the first under another name, in another unit.
    let other = SHED.replace("SKETCH SHED", "SKETCH BARN").replace("UNITS M\n", "UNITS FT\n");
    let both = open(&format!("{SHED}\n{other}"));
    let found = both.diagnostics();
    let fault = found.iter().find(|d| d.id == "units-differ").expect("the fault");
    assert!(fault.message.contains("SHED") && fault.message.contains("FT"), "{}", fault.message);
}
