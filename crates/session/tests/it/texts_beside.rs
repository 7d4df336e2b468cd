//! Texts of files beside the document: they count before they are saved, and what a viewer has is what a fresh session
//! of the saved files would send.

use crate::viewer::{Viewer, ask, opened};
use moldloft_document::{ReadText, TextReadError, World};
use moldloft_session::Session;
use serde_json::json;

const MAIN: &str = "load \"part.sdl\"\ncurve c = read_points(\"z.csv\");\nAbsPoint E(c[2]);\n";
const PART: &str = "load \"inner.sdl\"\nAbsPoint B(width, 0, 0);\nLine l(A, B);\n";
const INNER: &str = "float width = 2;\nAbsPoint A(0, 0, 0);\n";

const TABLE: &str = "1 2 3\n4 5 6\n";

struct Folder(Vec<(&'static str, String)>);

impl World for Folder {
    fn read(&self, path: &str, _from: Option<&str>) -> Result<ReadText, TextReadError> {
        let found = self.0.iter().find(|(name, _)| *name == path);
        let (name, text) = found
            .ok_or_else(|| TextReadError { message: format!("no file `{path}`"), help: None })?;
        Ok(ReadText { name: format!("/models/{name}"), bytes: text.as_bytes().into() })
    }
}

fn session(part: &str, inner: &str, table: &str) -> Session {
    let files = [("part.sdl", part), ("inner.sdl", inner), ("z.csv", table)];
    let folder = Folder(files.map(|(name, text)| (name, text.to_string())).into());
    Session::new(Box::new(folder), "model.sdl", MAIN)
}

fn seen(s: &mut Session) -> Viewer {
    opened(s, 9)
}

#[test]
fn a_text_counts_before_it_is_saved() {
    let mut s = session(PART, INNER, TABLE);
    let open = ask(&mut s, json!({"kind": "open"}));
    let names = ["/models/part.sdl", "/models/inner.sdl", "/models/z.csv"];
    assert_eq!(open.head["reads"], json!(names), "{}", open.head);
    assert_eq!(open.head["diagnostics"], json!([]));
    let begin = seen(&mut s);
    let texts = [
        PART.replace("0, 0);", "1, 0);"),
        INNER.replace("2;", "5;"),
        TABLE.replace("4 5 6", "4 5 7"),
    ];
    let [part, inner, table] = &texts;
    for (name, text) in names.iter().zip(&texts) {
        ask(&mut s, json!({"kind": "text_beside", "name": name, "text": text}));
    }
    assert_eq!(seen(&mut s), seen(&mut session(part, inner, table)));
    // One after the other is given back, the inner one first: what reads it stays as it is.
    ask(&mut s, json!({"kind": "text_beside", "name": names[1], "text": null}));
    assert_eq!(seen(&mut s), seen(&mut session(part, INNER, table)));
    for name in names {
        ask(&mut s, json!({"kind": "text_beside", "name": name, "text": null}));
    }
    assert_eq!(seen(&mut s), begin);
    // A text that nothing reads changes nothing.
    ask(&mut s, json!({"kind": "text_beside", "name": "/models/other.sdl", "text": "("}));
    assert_eq!(seen(&mut s), begin);
}

#[test]
fn faults_and_declarations_have_their_places_in_their_file() {
    let mut s = session(PART, INNER, TABLE);
    let found = ask(&mut s, json!({"kind": "locate", "name": "B"}));
    let at = PART.find("B(").unwrap();
    assert_eq!(found.head["place"], json!(null));
    assert_eq!(found.head["elsewhere"]["file"], "/models/part.sdl");
    assert_eq!(found.head["elsewhere"]["place"][0], at, "{}", found.head);
    let wrong = PART.replace("width", "wide");
    let reply =
        ask(&mut s, json!({"kind": "text_beside", "name": "/models/part.sdl", "text": wrong}));
    let fault = &reply.head["diagnostics"][0];
    let at = wrong.find("wide").unwrap();
    assert_eq!(fault["file"], "/models/part.sdl", "{}", reply.head);
    assert_eq!(fault["elsewhere"], json!([at, at + 4]));
    // Files of a text that no longer loads them are none of its files.
    let reply = ask(&mut s, json!({"kind": "text", "text": "AbsPoint A(0, 0, 0);\n"}));
    assert_eq!(reply.head["reads"], json!([]));
}

const DAM: &str = include_str!("../../../../examples/sketch/dam.skt");

fn dam(text: &str) -> Session {
    let folder = Folder(vec![("dam.skt", text.to_string())]);
    Session::new(Box::new(folder), "model.sdl", "load \"dam.skt\";\nAbsPoint A(dam.p4.x, 0, 0);\n")
}

/// A value that is set and written: the reply to `write`, and the text beside with its edits.
fn written(s: &mut Session, text: &str, values: serde_json::Value) -> (Viewer, Option<String>) {
    let reply = ask(s, json!({"kind": "write", "values": values}));
    let beside = reply.head["beside"].as_array().cloned().unwrap_or_default();
    let mut edited = text.to_string();
    for one in beside.iter().rev() {
        assert_eq!(one["file"], "/models/dam.skt");
        let at = |k: &str| one[k].as_u64().unwrap() as usize;
        assert_eq!(&text[at("from")..at("to")], one["found"].as_str().unwrap());
        edited.replace_range(at("from")..at("to"), one["insert"].as_str().unwrap());
    }
    let shown = seen(s);
    ask(s, json!({"kind": "text_beside", "name": "/models/dam.skt", "text": edited}));
    (shown, (edited != text).then_some(edited))
}

#[test]
fn numbers_of_a_sketch_are_written_where_it_states_them() {
    let forms = [
        DAM.to_string(),
        DAM.replace("CONVERT", "SET CREST 18\nCONVERT"),
        DAM.replace("CONVERT", "SET LENGTH1 16\nSET CREST = 16\nCONVERT"),
        // The automatic name D1 is not in the text.
        DAM.replace("DIMENSION LENGTH1 Y", "DIMENSION Y"),
    ];
    for text in &forms {
        let length = if text.contains("LENGTH1") { "dam.LENGTH1" } else { "dam.D1" };
        for (name, value) in [("dam.CREST", 21.25), (length, 40.0), ("dam.PARAPET", 12.5)] {
            let mut s = dam(text);
            let (shown, edited) = written(&mut s, text, json!({name: value}));
            let edited = edited.unwrap_or_else(|| panic!("{name} is not written:\n{text}"));
            assert_eq!(seen(&mut s), seen(&mut dam(&edited)), "{name}");
            assert_eq!(shown.items, seen(&mut s).items, "{name}");
            assert_eq!(edited.lines().count(), text.lines().count());
            // The file counts again: nothing holds what was set.
            ask(&mut s, json!({"kind": "text_beside", "name": "/models/dam.skt", "text": null}));
            assert_eq!(seen(&mut s), seen(&mut dam(text)), "{name}");
        }
    }
}

#[test]
fn a_number_that_no_file_states_is_held() {
    // The value is the result of an expression, in which the number 16 is another.
    let text = DAM.replace("= 16 IN 10 30", "= \"32/2\" IN 10 30");
    let mut s = dam(&text);
    let open = opened(&mut s, 3);
    let (shown, edited) = written(&mut s, &text, json!({"dam.HEIGHT": 80.0}));
    assert!(edited.is_some() && shown != open);
    let script = DAM.lines().map(|line| json!(line)).collect::<Vec<_>>();
    let text = json!({"format": "sketch", "version": 1, "script": script}).to_string();
    let folder = Folder(vec![("dam.skt.json", text)]);
    let model = "load \"dam.skt.json\";\n";
    let mut s = Session::new(Box::new(folder), "model.sdl", model);
    let reply = ask(&mut s, json!({"kind": "write", "values": {"dam.CREST": 20.0}}));
    assert_eq!(reply.head["beside"], json!([]), "{}", reply.head);
    assert_eq!(reply.head["kept"], json!(["dam.CREST"]));
}
