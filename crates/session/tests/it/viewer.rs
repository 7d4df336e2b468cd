//! A viewer as a page is one: it keeps what it was sent and takes what is new.

use moldloft_document::NoFiles;
use moldloft_session::{Reply, Session};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A thing as it was sent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    pub kind: String,
    pub stale: String,
    pub origin: Vec<f64>,
    pub parts: BTreeMap<String, Vec<u32>>,
}

/// What a viewer has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Viewer {
    pub items: BTreeMap<String, Drawn>,
    pub facts: BTreeMap<String, Value>,
}

impl Viewer {
    /// Takes a reply, checking that all arrays are within it.
    pub fn take(&mut self, reply: &Reply) {
        for gone in reply.head["removed"].as_array().into_iter().flatten() {
            assert!(self.items.remove(&gone.to_string()).is_some(), "{gone}");
        }
        for item in reply.head["items"].as_array().into_iter().flatten() {
            let drawn = self.items.entry(item["key"].to_string()).or_default();
            drawn.kind = item["kind"].as_str().unwrap().into();
            drawn.stale = item["stale"].as_str().unwrap().into();
            drawn.origin = serde_json::from_value(item["origin"].clone()).unwrap();
            for part in item["parts"].as_array().unwrap() {
                let role = part["role"].as_str().unwrap();
                // Floats as their bits.
                drawn.parts.insert(role.into(), reply.numbers(part));
            }
            let vertices = drawn.parts["position"].len() / 3;
            for role in ["triangle", "edge", "rim"] {
                assert!(drawn.parts[role].iter().all(|&v| (v as usize) < vertices), "{role}");
            }
            if drawn.kind == "patch" {
                assert_eq!(drawn.parts["normal"].len(), 3 * vertices);
            }
        }
        for key in ["params", "objects", "diagnostics", "mirror"] {
            if let Some(value) = reply.head.get(key) {
                self.facts.insert(key.into(), value.clone());
            }
        }
    }

    /// The things that are up to date.
    pub fn fresh(&self) -> BTreeMap<&String, &Drawn> {
        self.items.iter().filter(|(_, d)| d.stale.is_empty()).collect()
    }
}

/// The reply to a request.
pub fn ask(session: &mut Session, request: Value) -> Reply {
    Reply::of(&session.answer(&request.to_string()))
}

/// A session on a text.
pub fn session(text: &str) -> Session {
    Session::new(Box::new(NoFiles), "model.sdl", text)
}

/// What one that comes now is sent.
pub fn opened(session: &mut Session, tab: u64) -> Viewer {
    let mut viewer = Viewer::default();
    viewer.take(&ask(session, json!({"kind": "open", "tab": tab})));
    viewer
}

/// The text with the edits of a reply.
pub fn edited(text: &str, reply: &Reply) -> String {
    let units: Vec<u16> = text.encode_utf16().collect();
    let mut made = units.clone();
    for edit in reply.head["edits"].as_array().unwrap().iter().rev() {
        let at = |key: &str| edit[key].as_u64().unwrap() as usize;
        made.splice(at("from")..at("to"), edit["insert"].as_str().unwrap().encode_utf16());
    }
    String::from_utf16(&made).unwrap()
}

/// The text of an example.
pub fn example(name: &str) -> String {
    let path = format!("{}/../../examples/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}

/// The programs among the examples: their names and texts.
pub fn examples() -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut folders =
        vec![std::path::PathBuf::from(format!("{}/../../examples", env!("CARGO_MANIFEST_DIR")))];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "sdl") {
                found.push((path.display().to_string(), std::fs::read_to_string(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}
