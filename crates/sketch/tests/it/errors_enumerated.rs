//! Every error of the commands has a case here: the texts are read from the sources, and each must
//! occur in one of the cases, with a kind and the parts that its text names as data.

use crate::errors::{TABLE, session};
use moldloft_diag::Severity;
use moldloft_sketch::*;
use std::path::Path;

/// Start of a text and the pieces between its arguments.
struct Template {
    place: String,
    /// Alternatives of several texts, each as its fixed pieces.
    texts: Vec<Vec<String>>,
}

/// Said where no short command leads: guards against a fault of our own, or against sizes that take minutes to reach.
const GUARDS: &[&str] = &[
    "an edge vanishes when the other edges of its corner are blended",
    // Names of numbers of other objects have a dot, which own ones have not.
    "{name} is a number of two objects of {target}",
    // The reference of an open question is dropped with its object.
    "there is no object {key}",
    // A curve waits for its points without a word; bodies of objects without positions are not begun.
    "the points of {name} are not determined yet",
    // A chain has a length as soon as its dimensions have values, and they have.
    "the chain {} determines it already",
    // Errors that earlier steps prevent in all known cases.
    "{name}: round surfaces touch, or nearly so, at {}",
    "{name}: its faces do not close to rounding near {}",
    // Moved sides that nearly touch: none of many random outlines has such sides.
    "the moved sides do not meet clearly",
    "the moved border does not close",
    "moved sides touch, or nearly so",
    // Sizes.
    "an outline of {} sides",
    "there is no estimate of this sketch",
    "{name}: there are too many pieces",
    "the wireframe has too many crossing faces",
    "{points} points are too many",
    // Steps of blends and walls that an earlier refusal has caught in all that was tried.
    "faces are tangent at an edge",
    "three fillets meet where no ball touches all faces",
    "no ball fits a corner",
    "two edges of a corner have no face in common",
    "two blends meet in no plane",
    "two blends of a corner that stands in do not meet in one curve",
    "an arc ends in a corner",
    "a corner has not three faces across each other",
    "a corner has one face only",
    "faces pass each other when they are moved",
    "a round face is not a cylinder between two arcs",
    "an edge is neither straight nor an arc about a cylinder",
    "{name}: surfaces do not close, or nearly coincide, at {}",
];

fn sources(folder: &Path, into: &mut Vec<(String, String)>) {
    let mut all: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    all.sort();
    for path in all {
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            into.push((name, std::fs::read_to_string(&path).unwrap()));
        }
    }
}

/// The string literals of a piece of source, as written.
fn literals(text: &str) -> Vec<String> {
    let mut out = Vec::new();
    let mut own: Option<String> = None;
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        match (&mut own, c) {
            (Some(s), '\\') => match chars.next() {
                Some('\n') | None => {}
                Some(c) => s.push(c),
            },
            (Some(_), '"') => out.extend(own.take()),
            (Some(s), c) => s.push(c),
            (None, '"') => own = Some(String::new()),
            _ => {}
        }
    }
    out
}

/// The arguments of a call that begins at a bracket.
fn arguments(text: &str) -> Vec<String> {
    let (mut depth, mut quoted, mut escaped) = (0, false, false);
    let mut out = vec![String::new()];
    for c in text.chars() {
        if quoted {
            quoted = escaped || c != '"';
            escaped = !escaped && c == '\\';
        } else {
            match c {
                '"' => quoted = true,
                '(' | '[' | '{' => {
                    depth += 1;
                    if depth == 1 {
                        continue;
                    }
                }
                ')' | ']' | '}' => depth -= 1,
                ',' if depth == 1 => {
                    out.push(String::new());
                    continue;
                }
                _ => {}
            }
        }
        if depth == 0 {
            break;
        }
        out.last_mut().unwrap().push(c);
    }
    out
}

fn pieces(template: &str) -> Vec<String> {
    let plain = template.replace("{{", "\u{1}").replace("}}", "\u{2}");
    let mut out = Vec::new();
    for (k, part) in plain.split('{').enumerate() {
        let rest = if k == 0 { part } else { part.split_once('}').map_or("", |p| p.1) };
        out.push(rest.replace('\u{1}', "{").replace('\u{2}', "}"));
    }
    out
}

fn says(text: &str, pieces: &[String]) -> bool {
    let mut rest = text;
    for (k, piece) in pieces.iter().enumerate() {
        match rest.find(piece.as_str()) {
            Some(at) if k > 0 || at == 0 || text.contains(": ") => rest = &rest[at + piece.len()..],
            _ => return false,
        }
    }
    true
}

/// Constructors of errors, and the index of the argument with the text.
const CALLS: [(&str, usize); 5] = [
    ("CommandError::new(", 1),
    ("CommandError::text(", 0),
    ("TreatmentFault::new(", 0),
    (" fault(", 0),
    ("(fault(", 0),
];

fn templates() -> Vec<Template> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&folder, &mut files);
    let mut out = Vec::new();
    for (name, text) in files.iter().filter(|f| f.0 != "error.rs") {
        for (call, at) in CALLS {
            for (start, _) in text.match_indices(call) {
                let own = arguments(&text[start + call.len() - 1..]);
                let line = text[..start].matches('\n').count() + 1;
                let mut found = literals(own.get(at).map_or("", |a| a));
                if call.contains("fault(") && !own[0].trim().starts_with('"') {
                    continue;
                }
                if (own.len() < 2 && !call.contains("fault(")) || own[0].contains("text: impl") {
                    continue;
                }
                let word = own[at].trim().split('.').next().unwrap_or("").to_owned();
                if found.is_empty() {
                    // A name: the texts that are bound above it, up to the statement before.
                    let above = &text[start.saturating_sub(700)..start];
                    let from = ["let (code, text)", "let text", "let what", "let fault = |text"];
                    let Some(from) = from.iter().filter_map(|f| above.rfind(f)).max() else {
                        assert!(
                            ["why", "fault", "text"].contains(&word.as_str()),
                            "{name}:{line}: {word}"
                        );
                        continue;
                    };
                    found = literals(&above[from..]);
                }
                if found.is_empty() {
                    // A closure whose calls are examined themselves.
                    assert_eq!(word, "text", "{name}:{line}");
                    continue;
                }
                let texts = found.iter().map(|t| pieces(t)).collect();
                out.push(Template { place: format!("{name}:{line} {found:?}"), texts });
            }
        }
    }
    out
}

/// A box of 4 x 3 x 2, its edges drawn along the axes.
const BOX: &str = "SKETCH B
    POINT 1 0 0; POINT 2 97 -26; POINT 3 173 38; POINT 4 77 64
    POINT 5 0 100; POINT 6 97 74; POINT 7 173 138; POINT 8 77 164
    LINE 1 1 2 TYPE X; LINE 2 2 3 TYPE Y; LINE 3 3 4 TYPE X; LINE 4 4 1 TYPE Y
    LINE 5 1 5 TYPE Z; LINE 6 2 6 TYPE Z; LINE 7 3 7 TYPE Z; LINE 8 4 8 TYPE Z
    LINE 9 5 6 TYPE X; LINE 10 6 7 TYPE Y; LINE 11 7 8 TYPE X; LINE 12 8 5 TYPE Y
    DIM W X 1 2 = 4; DIM D Y 1 4 = 3; DIM H Z 1 5 = 2; GENERATE FACES";

/// A plate that follows its drill.
const DRILLED: &str = "SKETCH A 2D XY; RECTANGLE 60 40; EXTRUDE A 8
    SKETCH D 2D XY; CIRCLE DIAMETER 10 AT 0 0; EXTRUDE D 12; MOVE D 20 15 -2; CUT A D INTO P";

/// A square section of 8 with its faces.
const SECTION: &str = "SKETCH A 2D XZ; POINT 1 0 0; POINT 2 90 2; POINT 3 91 90; POINT 4 1 89
    POLYLINE 1 2 3 4 CLOSE; DIM W X 1 2 8; DIM H Z 1 4 8; GENERATE FACES";

/// Two lines of a section and their dimensions.
const BENT: &str = "SKETCH A 2D XZ; POINT 1 0 0; POINT 2 90 0; POINT 3 90 90; POINT 4 200 300
    LINE 1 1 2; LINE 2 2 3; LINE 3 3 4 TYPE F; DIM W X 1 2 8; DIM Z 2 3 5";

/// A pyramid over a rectangle.
const PYRAMID: &str = "SKETCH P
    POINT 1 0 0; POINT 2 97 -26; POINT 3 173 38; POINT 4 77 64; POINT 5 80 120
    LINE 1 1 2 TYPE X; LINE 2 2 3 TYPE Y; LINE 3 3 4 TYPE X; LINE 4 4 1 TYPE Y
    LINE 5 1 5 TYPE O; LINE 6 2 5 TYPE O; LINE 7 3 5 TYPE O; LINE 8 4 5 TYPE O
    DIM W X 1 2 = 4; DIM D Y 1 4 = 3; DIM H Z 1 5 = 2; DIM U X 1 5 = 1; DIM V Y 1 5 = 1; GENERATE FACES";

/// A section like an L, drawn out.
const ELL: &str = "SKETCH ELL 2D XY
    POINT 1 0 0; POINT 2 90 0; POINT 3 90 30; POINT 4 30 30; POINT 5 30 90; POINT 6 0 90
    POLYLINE 1 2 3 4 5 6 CLOSE
    DIM L X 1 2 9; DIM T X 1 4 3; DIM M Y 1 6 9; DIM S Y 1 3 3; EXTRUDE 5";

/// A section with a square hole.
const HOLED: &str = "SKETCH A 2D XZ; POINT 1 0 0; POINT 2 100 0; POINT 3 100 80; POINT 4 0 80; POLYLINE 1 2 3 4 CLOSE
    POINT 5 20 20; POINT 6 60 20; POINT 7 60 60; POINT 8 20 60; POLYLINE 5 6 7 8 CLOSE
    DIM X 1 2 10; DIM Z 1 4 8; DIM Q X 1 5 2; DIM X 5 6 4; DIM Z 1 5 2; DIM Z 5 8 4; GENERATE FACES";

/// Preparation (a name in capitals is one of the texts above) and command: with [`TABLE`], one for
/// each error.
const CASES: &[(&str, &str)] = &[
    ("", "TEXT L \"H\" FONT nothing.ttf"),
    (
        "SKETCH A 2D XY; RECTANGLE 4 4; EXTRUDE A 2; SKETCH D 2D XY",
        "CIRCLE DIAMETER 2 AT \"A.WIDTH9/2\" 0",
    ),
    (
        "SKETCH A 2D XY; RECTANGLE 4 4; EXTRUDE A 2; SKETCH D 2D XY ON A TOP Z; RECTANGLE 1 1",
        "LOFT D A INTO L",
    ),
    (DRILLED, "COPY D E; MOVE E 20 0 0; CUT P E INTO A"),
    (DRILLED, "COPY D F; MOVE F 20 0 0; CUT P F; RENAME P Q; RENAME F P"),
    (
        "SKETCH S 2D XZ; RECTANGLE 10 20 AT 5 0; REVOLVE S 4 90 INTO T",
        "MEASURE T; EXTRUDE S 4",
    ),
    // Words and numbers.
    ("", "FROBNICATE"),
    (
        "SKETCH S 2D XY; RECTANGLE 4 4; EXTRUDE S 2; SKETCH T 2D XY; RECTANGLE 2 2",
        "MOVE T ON S TOP Z",
    ),
    (
        "SKETCH S 2D XY; RECTANGLE 4 4; EXTRUDE S 2",
        "MOVE S ON S TOP Z",
    ),
    (
        "SKETCH \"A-B\" 2D XY; RECTANGLE 4 4; EXTRUDE \"A-B\" 2; SKETCH A_B 2D XY; RECTANGLE 2 2; \
         EXTRUDE A_B 1; MOVE A_B 1 1 1.5",
        "CUT \"A-B\" A_B INTO P",
    ),
    ("", "S"),
    ("", "REVE A B"),
    ("", "SAVE \"x"),
    ("", "DIM W X ?1 2"),
    ("BOX", "DIM Q X 1.2.3 4"),
    ("BOX", "DIM Q X 12-3 4"),
    ("BOX", "DIM Q X 1A2 4"),
    ("BOX", "DIM Q X 1?2 4"),
    ("BOX", "DIM Q X 1 2 1e999"),
    ("BOX", "TYPE"),
    ("BOX", "VARIABLE V 6ft"),
    ("BOX", "VARIABLE V \"1+\""),
    ("BOX", "VARIABLE V 3 IN 5 4"),
    // Drawing.
    ("", "SKETCH \"aaaaaaaaaabbbbbbbbbbccccccccccddd\""),
    ("SKETCH A", "COPY A TO \"aaaaaaaaaabbbbbbbbbbccccccccccddd\""),
    ("SKETCH A", "COPY A TO A"),
    ("SKETCH A", "POINT 1 2e9 0"),
    ("SKETCH A", "SET CERTAINTY 2"),
    ("SKETCH A", "STROKES SAMPLES 100 0 99 13 97 26 92 38 87 50 79 61 71 71 61 79 50 87 38 92 26 97 13 99 0 100 -13 99 -26 97 -38 92 -50 87 -61 79 -71 71 -79 61 -87 50 -92 38 -97 26 -99 13 -100 0"),
    ("SKETCH A; POINT 1 0 0", "LINE 1 2"),
    ("BENT", "LINE 1 2"),
    ("BENT", "SPLIT 1 2"),
    ("BENT", "SPLIT 9 0.5"),
    ("BOX", "DELETE FACE 99"),
    ("BOX", "DELETE DIMENSION NONE"),
    ("SKETCH A; POINT 1 0 0; POINT 2 9 0; LINE 1 2", "AXES AUTO"),
    ("SKETCH A", "AXES SOMEHOW"),
    ("SKETCH A", "AXES 30 30 30"),
    ("BENT", "UNALIGN X 1 2"),
    ("BENT", "TYPE 1 AS Y"),
    // Dimensions.
    ("BENT", "DIM Q ANGLE 1 1 30"),
    ("BENT", "DIM Q LENGTH 3"),
    ("BOX", "DIM X 2 6 3"),
    ("BOX", "DIM \"a-b\" X 1 2 4"),
    ("BOX", "VARIABLE PI 4"),
    ("BOX", "VARIABLE W 4"),
    ("BOX", "SET UNITS MILE"),
    ("BOX; SET UNITS M", "SET UNITS FT"),
    ("BOX; COPY B TO C; MOVE C 1 1 1; SET UNITS M; UNION B C INTO U; USING U; SET UNITS M", "SET UNITS FT CONVERT"),
    ("BOX", "SET NONE 5"),
    ("BOX", "UNSET NONE"),
    ("BOX", "REVERSE NONE"),
    ("BOX; SET W 4 IN 1 9", "SET W 99"),
    ("BOX; VARIABLE V 3; SET W \"2*V\" IN 1 9", "SET V 8"),
    ("BOX", "SET W \"NONE + 1\""),
    ("BOX; VARIABLE V 1", "SET W \"1/(V-1)\""),
    ("BOX; VARIABLE V 3", "SET V \"W\"; SET W \"V\""),
    ("BOX", "WHY NONE"),
    ("SKETCH A", "ESTIMATE"),
    ("BOX", "ACCEPT ALL"),
    ("BOX", "YES"),
    ("SKETCH A; POINT 1 0 0; POINT 2 9 0; POINT 3 9 9; POINT 4 0 9; LINE 1 1 2 TYPE X; LINE 2 2 3 TYPE Z
      LINE 3 3 4 TYPE F; LINE 4 4 1 TYPE Z", "CHECK"),
    ("SKETCH A; POINT 1 0 0; POINT 2 9 0; POINT 3 9 1; LINE 1 1 2 TYPE X; LINE 2 1 3 TYPE X; LINE 3 2 3 TYPE NONE", "CHECK"),
    ("SKETCH A; POINT 1 0 0; POINT 2 9 0; POINT 3 0 9; POINT 4 9 9; LINE 1 1 2 TYPE X; LINE 2 1 3 TYPE Z
      LINE 3 2 4 TYPE Z; LINE 4 3 4 TYPE X; ALIGN X 1 2; ALIGN Y 1 4", "CHECK"),
    ("SKETCH A; POINT 1 0 0; POINT 2 9 0; POINT 3 4 9; LINE 1 1 2 TYPE X; LINE 2 2 3 TYPE F; LINE 3 1 3 TYPE Z
      ALIGN X 1 2", "CHECK"),
    // Pictures and files.
    ("BOX", "SHOW FACE 99"),
    ("BOX", "ZOOM -1"),
    ("BOX", "ZOOM WINDOW 1 1 1 1"),
    ("BOX", "VIEW NOWHERE"),
    ("", "SAVE"),
    ("BOX", "EXPORT BMP"),
    ("SKETCH A 2D XY", "IMPORT \"far.dxf\""),
    ("SKETCH A 2D XY", "IMPORT \"touching.dxf\""),
    ("SKETCH P 2D XY; RECTANGLE 40 20", "BEZIER B CORNER 3 WEIGHT 1.2"),
    ("", "RUN \"again.skt\""),
    ("", "UNDO"),
    ("SKETCH A", "REDO"),
    ("", "LEAVE"),
    ("NEST", "WITHIN A"),
    // Curves.
    ("BENT", "ARC R LINES 1 3"),
    ("BENT", "ARC R CORNER 2 1 1"),
    ("BENT", "ARC R CORNER 1 RADIUS 1"),
    ("BENT", "CUBIC R LINES 1 3 2"),
    ("BENT", "ARC R CORNER 2 RADIUS 1 STEPS 1000"),
    ("BENT", "ARC R CORNER 2 RADIUS NONE"),
    ("BENT", "ARC R CORNER 2 RADIUS -1"),
    ("SKETCH A 2D XZ; POINT 1 0 0; POINT 2 90 0; POINT 3 180 0; LINE 1 1 2; LINE 2 2 3; DIM X 1 2 4; DIM X 2 3 4",
     "ARC R CORNER 2 RADIUS 1"),
    ("SKETCH A 2D XZ; POINT 1 0 0; POINT 2 90 0; POINT 3 90 90; LINE 1 1 2; LINE 2 2 3",
     "ARC R CORNER 2 RADIUS 1; CHECK"),
    ("SECTION", "POINT 5 40 -60; LINE 1 5 TYPE F; LINE 5 2 TYPE F; DIM X 1 5 4; DIM Z 5 1 4; GENERATE FACES
      ARC R CORNER 1 4 2 RADIUS 1"),
    ("SECTION", "ARC R CORNER 1 RADIUS 1; ARC Q CORNER 1 RADIUS 2"),
    ("SECTION", "ARC R CORNER 1 RADIUS 5; ARC Q CORNER 2 RADIUS 5"),
    ("SECTION", "CIRCLE C CORNER 1 4 2 RADIUS 2"),
    ("BENDABLE", "QUADRATIC C LINES 7 14"),
    // Faces and solids.
    ("SKETCH S", "FACE 1 RUNS 1 2 3"),
    ("BOX; POINT 9 300 300; POINT 10 320 300; POINT 11 310 320", "FACE 9 10 11"),
    ("SECTION", "EXTRUDE X 5"),
    ("SECTION", "EXTRUDE 0"),
    ("SECTION", "REVOLVE 1 0"),
    ("SECTION; POINT 5 45 -60; POINT 6 45 160; LINE 5 6 TYPE Z; DIM X 1 5 4; DIM Z 5 1 4; DIM Z 5 6 20", "REVOLVE 5"),
    ("SECTION; POINT 5 -45 -60; POINT 6 -45 160; LINE 5 6 TYPE Z; DIM Q X 5 1 4; DIM Z 5 1 4; DIM Z 5 6 20
      GENERATE FACES; REVOLVE 5 INTO V; USING V", "SET Q -4"),
    ("SKETCH A 2D XZ; POINT 1 0 0; POINT 2 100 0; POINT 3 100 80; POINT 4 0 80; POLYLINE 1 2 3 4 CLOSE
      POINT 5 60 20; POINT 6 140 20; POINT 7 140 60; POINT 8 60 60; POLYLINE 5 6 7 8 CLOSE
      DIM X 1 2 10; DIM Z 1 4 8; DIM X 1 5 6; DIM X 5 6 8; DIM Z 1 5 2; DIM Z 5 8 4", "GENERATE FACES"),
    ("BOX; DELETE LINE 1", "GENERATE FACES"),
    ("BOX; DELETE FACE 1 2 3 4 5 6; COPY B TO C; GENERATE FACES", "UNION B C INTO U"),
    ("BOX; COPY B TO C; USING C; SKETCH S 2D XZ", "UNION B S INTO U"),
    ("BOX", "UNION B B INTO U"),
    ("BOX; COPY B TO C", "CUT B C INTO U"),
    ("BOX; COPY B TO C; USING C; VARIABLE Q 1; MOVE C Q 0 0; CUT B C INTO U; USING U", "SET Q 0; CHECK"),
    ("BOX; SKETCH C; POINT 1 0 0; POINT 2 9 0; LINE 1 1 2 TYPE X; DIM X 1 2 3", "UNION B C INTO U"),
    ("BOX", "PATTERN B LINEAR 9999 1 1 1 INTO P"),
    ("SKETCH A 3D", "SET EXACT ON"),
    ("BOX", "EXPORT GLTF B b.gltf"),
    ("BOX", "SCALE B -1"),
    ("BOX; COPY B TO C; MOVE C 1 1 1; UNION B C INTO U", "SCALE U -1"),
    ("SECTION", "ROTATE A X 30"),
    ("BOX", "GENERATE FACES ASK; YES; REVERSE"),
    ("SECTION", "SET W -1; CHECK"),
    ("BOX; MOVE B 1.7e308 0 0", "SET W 1.7e308; CHECK"),
    ("ELL", "SET S 12; SET T 12"),
    ("HOLED", "SET Q 30"),
    // Round bodies that nearly meet.
    ("BARS 3.9999999", "UNION R S INTO U"),
    // Edges and faces.
    ("BOX", "FILLET B 0 EDGES ALL"),
    ("BOX", "CHAMFER B 0.1 0.2 EDGES ALL"),
    ("BOX", "FILLET B 0.1 EDGES OF nothing"),
    ("BOX", "FILLET B 0.1 EDGES BETWEEN 1 1"),
    ("BOX", "FILLET B 1.9 EDGES ALL"),
    ("BOX", "SHELL B 0.1 OPEN TOP X BOTTOM X TOP Y BOTTOM Y TOP Z BOTTOM Z"),
    ("BOX", "SHELL B 1.2"),
    ("BOX", "DRAFT B Z 95"),
    ("BOX", "DRAFT B Z 60"),
    ("BOX; FILLET B 0.5 EDGES ALONG Z INTO R", "DRAFT R Z 5"),
    ("BOX; FILLET B 0.5 EDGES ALONG Z INTO R", "SHELL R 0.1 OPEN TOP X INTO Q"),
    ("BOX; FILLET B 0.2 EDGES OF TOP Z INTO R", "SHELL R 0.1 INTO Q"),
    ("PYRAMID", "SHELL P 0.2"),
    ("BOX", "HOLE B 0.2 AT 0.5 0.5 COUNTERSINK 0.4 180"),
    ("BOX", "HOLE B 0.2 AT 0.5 0.5 DEPTH 0.1 COUNTERBORE 0.4 0.2"),
    ("BOX", "HOLE B 0.2 AT 0.5 0.5 COUNTERBORE 0.2 0.1"),
    ("BOX", "HOLE B 0.2 AT 50 50"),
    ("", "SKETCH P 2D XY; POLYGON 2 5"),
    ("", "SKETCH P 2D XY; RECTANGLE 5 4; REFERENCE 1 \"WIDTH1/0\" 1"),
    ("PYRAMID", "DRAFT P Z 5"),
    ("PYRAMID", "DRAFT P X 5"),
    ("ELL", "CHAMFER ELL 1 EDGES ALL INTO Q"),
    ("SKETCH P 2D XY; RECTANGLE 40 20; OFFSET P 1 INTO Q", "REVOLVE Q 1"),
    ("SKETCH P 2D XY; RECTANGLE 40 20", "OFFSET P 0"),
    ("SKETCH P 2D XY; RECTANGLE 40 20", "OFFSET P -15"),
    (
        "SKETCH P 2D XY; SET EXACT ON; POINT 1 0 0; POINT 2 1000000 0; POINT 3 1000000 10; POLYLINE 1 2 3 CLOSE; \
         ACCEPT ALL; GENERATE FACES",
        "OFFSET P 1 MITRED",
    ),
    (
        "SKETCH P 2D XY; RECTANGLE 40 20; ELLIPSE E ARC CORNER 3 2 4 SEMI 4 2; GENERATE FACES",
        "OFFSET P 1",
    ),
    (
        "SKETCH P 2D XY; SET EXACT ON; POINT 1 0 0; POINT 2 10 0; POINT 3 5 8; POINT 4 0 16; POINT 5 10 16; \
         POLYLINE 1 2 3 CLOSE; POLYLINE 3 4 5 CLOSE; ACCEPT ALL; GENERATE FACES",
        "OFFSET P 1",
    ),
    ("PIPE", "SWEEP DISC ALONG DISC INTO P"),
    ("PIPE; EXTRUDE DISC 3 INTO E", "SWEEP DISC ALONG E INTO P"),
    ("PIPE; QUADRATIC Q LINES 1 2", "SWEEP DISC ALONG WAY INTO P"),
    ("PIPE; POINT 4 30 70; LINE 3 4; DIM Z 3 4 30", "ARC A CORNER 2 RADIUS 25; ARC B CORNER 3 RADIUS 25; SWEEP DISC ALONG WAY INTO P"),
    ("PIPE; POINT 4 30 70; LINE 3 4; DIM Z 3 4 30", "ARC A CORNER 2 RADIUS 30; SWEEP DISC ALONG WAY INTO P"),
    ("PIPE", "SWEEP DISC ALONG RING INTO P"),
    ("PIPE; SET TALL 2", "SWEEP DISC ALONG WAY INTO P"),
    ("PIPE; REFERENCE 1 0 0 5", "SWEEP DISC ALONG WAY INTO P"),
    ("PIPE; ARC A CORNER 2 RADIUS 2", "SWEEP DISC ALONG WAY INTO P"),
    (
        "SKETCH DISC 2D XY; CIRCLE DIAMETER 2 AT 0 0; SKETCH WAY 3D; POINT 1 0 0; POINT 2 0 50; POINT 3 80 30; \
         POINT 4 120 65; LINE 1 2 TYPE Z; LINE 2 3 TYPE X; LINE 3 4 TYPE Y; LINE 4 1 TYPE O; \
         DIM Z 1 2 30; DIM X 2 3 40; DIM Y 3 4 20",
        "REFERENCE 1 0 0 -15; SWEEP DISC ALONG WAY INTO P",
    ),
    ("LOFTED", "LOFT A A INTO C"),
    ("LOFTED", "LOFT A B INTO C"),
    ("LOFTED; CIRCLE DIAMETER 2 AT 4 4; MOVE B 0 0 9", "LOFT A B INTO C"),
    ("LOFTED; SKETCH C 2D XZ; RECTANGLE 9 9", "LOFT A C INTO D"),
    (
        "LOFTED; SKETCH E 2D XY; POINT 1 0 0; POINT 2 9 0; POINT 3 9 9; POINT 4 5 9; POINT 5 5 4; POINT 6 0 4; \
         POLYLINE 1 2 3 4 5 6 CLOSE; DIM X 1 2 9; DIM Y 2 3 9; DIM X 1 4 5; DIM Y 1 6 4; MOVE E 0 0 9",
        "LOFT A E INTO C",
    ),
];

/// Two sections in one plane.
const LOFTED: &str = "SKETCH A 2D XY; RECTANGLE 20 20; SKETCH B 2D XY; RECTANGLE 9 9";

/// A disc across the start of an angle.
const PIPE: &str = "SKETCH RING 2D XZ; RECTANGLE 40 20; CIRCLE DIAMETER 4 AT 20 10; GENERATE FACES; OFFSET RING 1; \
    SKETCH DISC 2D XY; CIRCLE DIAMETER 6 AT 0 0; SKETCH WAY 2D XZ; POINT 1 0 0; POINT 2 0 40; POINT 3 30 40; \
    POLYLINE 1 2 3; DIM TALL Z 1 2 40; DIM OUT X 2 3 30";

/// A session after some text; its first word may be the name of one of the texts above.
fn prepared(before: &str) -> SketchSession {
    let mut s = session();
    let (first, rest) = before.split_once([';', ' ']).unwrap_or((before, ""));
    let (text, rest) = match first {
        "BOX" => (BOX.to_owned(), rest.to_owned()),
        "SECTION" => (SECTION.to_owned(), rest.to_owned()),
        "PYRAMID" => (PYRAMID.to_owned(), rest.to_owned()),
        "ELL" => (ELL.to_owned(), rest.to_owned()),
        "HOLED" => (HOLED.to_owned(), rest.to_owned()),
        "LOFTED" => (LOFTED.to_owned(), rest.to_owned()),
        "PIPE" => (PIPE.to_owned(), rest.to_owned()),
        "BENT" => (BENT.to_owned(), rest.to_owned()),
        // Its gable has five corners, and one of its lines is to be bent out of its plane.
        "BENDABLE" => {
            let shed = crate::common::case_named("T11").object;
            s.insert(shed);
            ("GENERATE FACES".to_owned(), String::new())
        }
        "NEST" => ((0..32).map(|k| format!("WITHIN W{k}\n")).collect(), String::new()),
        "BARS" => {
            for (name, turned) in [("R", false), ("S", true)] {
                s.insert(crate::generators::bar(name, 4.0, [0.0; 2], [-5.0, 5.0]));
                if turned {
                    s.run_text("ROTATE S X 90");
                }
            }
            (format!("MOVE S {rest} 0 0"), String::new())
        }
        _ => (before.to_owned(), String::new()),
    };
    for reply in s.run_text(&format!("{text}\n{rest}")) {
        assert!(!reply.is_error(), "before, {before}: {}", reply.text);
    }
    s
}

/// Replies to a program that drags and calls at a wrong time.
fn by_hand(said: &mut Vec<CommandReply>) {
    let mut s = prepared("BOX");
    s.begin().unwrap();
    said.push(s.begin().unwrap_err().into());
    said.extend(s.run_line("UNDO"));
    s.rollback();
    said.extend(s.run_line(&"X".repeat(5_000_000)));
    // A cube in a cube, their corners joined: three solids fit.
    let mut s = session();
    for (name, size) in [("A", 6.0), ("I", 2.0)] {
        let object = crate::common::with_faces(crate::common::cuboid([size; 3]));
        s.insert(SketchObject { name: name.into(), ..object });
    }
    s.run_text("MOVE I 2 2 2; MERGE A I INTO C");
    for k in 1..=8 {
        s.run_line(&format!("LINE FROM {k} TO {} TYPE O", k + 8));
    }
    s.run_line("GENERATE FACES");
    said.extend(s.run_line("CHOOSE 9"));
}

#[test]
fn every_error_has_its_case() {
    let mut said: Vec<CommandReply> = Vec::new();
    let table = TABLE.iter().map(|t| (t.1, t.2));
    by_hand(&mut said);
    for (before, command) in table.chain(CASES.iter().copied()) {
        let mut s = prepared(before);
        let replies = s.run_text(command);
        if !replies.iter().any(|r| r.is_error() || r.severity == Severity::Warning) {
            panic!("{command} was accepted: {replies:?}");
        }
        said.extend(replies);
    }
    said.retain(|r| r.is_error() || r.severity == Severity::Warning);
    for reply in said.iter().filter(|r| r.is_error()) {
        assert!(!reply.about.kind.is_empty(), "{}", reply.text);
        assert!(reply.next.as_ref().is_some_and(|n| !n.is_empty()), "{}", reply.text);
        // Points, lines and faces that a sentence names by number are in its data.
        let words: Vec<&str> = reply.text.split([' ', ',', ';', ':']).collect();
        for w in words.windows(2) {
            let Ok(n) = w[1].parse::<u32>() else { continue };
            let about = &reply.about;
            // Lines of files have no data.
            if about.kind == "file" || reply.text.starts_with(&format!("line {n}:")) {
                continue;
            }
            match w[0] {
                "point" => assert!(about.points.contains(&PointId(n)), "{}", reply.text),
                "line" => assert!(about.lines.contains(&LineId(n)), "{}", reply.text),
                "face" => assert!(about.faces.contains(&FaceId(n)), "{}", reply.text),
                _ => {}
            }
        }
    }
    let mut missing = Vec::new();
    for t in templates() {
        let guarded = t.texts.iter().any(|p| GUARDS.iter().any(|g| pieces(g) == *p));
        let reached = t.texts.iter().any(|p| said.iter().any(|r| says(&r.text, p)));
        if !reached && !guarded {
            missing.push(t.place);
        }
    }
    assert!(missing.is_empty(), "no case says:\n{}", missing.join("\n"));
}
