//! A reply as one binary message: a head in JSON, and arrays of numbers behind it.
//!
//! `u32 magic, u32 version, u32 bytes of the head, u32 zero, head, zeros to a multiple of 8, arrays`,
//! little endian. The head names each array by type, first byte (after the padding) and count.

use crate::scene::SceneItem;
use rustc_hash::FxHashMap;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::sync::Arc;

/// The first four bytes, "MLFT".
pub const MAGIC: u32 = u32::from_le_bytes(*b"MLFT");

/// The form of frames.
pub const VERSION: u32 = 1;

/// A reply that is being made.
#[derive(Default)]
pub struct ReplyFrame {
    /// The facts.
    pub head: Map<String, Value>,
    /// Items of the scene, as text: they are many, and differ with each move of a slider.
    items: Option<String>,
    arrays: Vec<u8>,
}

/// An array of an item, as the head names it.
#[derive(Serialize)]
struct ArrayHead {
    role: &'static str,
    #[serde(rename = "type")]
    number: &'static str,
    offset: usize,
    count: usize,
}

/// An item of the scene, as the head names it.
#[derive(Serialize)]
struct ItemHead<'a> {
    key: (u8, &'a str),
    name: &'a str,
    object: &'a str,
    kind: &'static str,
    colour: [u8; 3],
    hue: u8,
    stale: &'a str,
    origin: [f64; 3],
    parts: Vec<ArrayHead>,
}

impl ReplyFrame {
    /// Adds a fact.
    pub fn put(&mut self, key: &str, value: impl Into<Value>) {
        self.head.insert(key.into(), value.into());
    }

    /// Adds an array of 32-bit floats; what names it.
    pub fn floats(&mut self, role: &str, values: &[f32]) -> Value {
        let offset = self.append(values, f32::to_le_bytes);
        json!({"role": role, "type": "f32", "offset": offset, "count": values.len()})
    }

    /// Adds an array of whole numbers; what names it.
    pub fn numbers(&mut self, role: &str, values: &[u32]) -> Value {
        let offset = self.append(values, u32::to_le_bytes);
        json!({"role": role, "type": "u32", "offset": offset, "count": values.len()})
    }

    /// Adds numbers of four bytes; where they begin.
    fn append<T: Copy>(&mut self, values: &[T], bytes: impl Fn(T) -> [u8; 4]) -> usize {
        let offset = self.arrays.len();
        self.arrays.resize(offset + 4 * values.len(), 0);
        let (places, _) = self.arrays[offset..].as_chunks_mut();
        for (place, x) in places.iter_mut().zip(values) {
            *place = bytes(*x);
        }
        offset
    }

    /// Adds the bytes of a file; what names it.
    pub fn bytes(&mut self, role: &str, bytes: &[u8]) -> Value {
        let offset = self.arrays.len();
        self.arrays.extend_from_slice(bytes);
        self.arrays.resize(self.arrays.len().next_multiple_of(8), 0);
        json!({"role": role, "type": "u8", "offset": offset, "count": bytes.len()})
    }

    /// The message.
    pub fn encoded(self) -> Vec<u8> {
        let mut head = Value::Object(self.head).to_string();
        if let Some(items) = self.items {
            let facts = head.len() > "{}".len();
            head.truncate(head.len() - "}".len());
            head.push_str(if facts { ",\"items\":[" } else { "\"items\":[" });
            head.push_str(&items);
            head.push_str("]}");
        }
        let mut bytes = Vec::with_capacity(24 + head.len() + self.arrays.len());
        for word in [MAGIC, VERSION, head.len() as u32, 0] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(head.into_bytes());
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes.extend(self.arrays);
        bytes
    }
}

/// The stamps of an item that a viewer has: head, positions, connections.
type Stamps = [u64; 3];

/// What a viewer has.
#[derive(Default)]
pub struct ViewerCache {
    items: FxHashMap<(u8, Arc<str>), Stamps>,
    /// Texts of other facts that were sent, by their names.
    facts: HashMap<&'static str, String>,
    /// Stamps of facts that are long, by their names.
    stamps: HashMap<&'static str, u64>,
}

impl ViewerCache {
    /// Adds a fact unless it was sent before.
    pub fn fact(&mut self, frame: &mut ReplyFrame, key: &'static str, value: Value) {
        let text = value.to_string();
        if self.facts.get(key) != Some(&text) {
            self.facts.insert(key, text);
            frame.put(key, value);
        }
    }

    /// Adds a fact whose stamp is not that of what was sent before.
    pub fn stamped(
        &mut self,
        frame: &mut ReplyFrame,
        key: &'static str,
        stamp: u64,
        value: impl FnOnce() -> Value,
    ) {
        if self.stamps.insert(key, stamp) != Some(stamp) {
            frame.put(key, value());
        }
    }

    /// Adds what differs from what the viewer has.
    pub fn scene(&mut self, frame: &mut ReplyFrame, items: &[SceneItem]) {
        let mut now = FxHashMap::with_capacity_and_hasher(items.len(), Default::default());
        for item in items {
            let key = (item.kind as u8, item.name.clone());
            let stamps = [item.head_stamp, item.stamp, item.topology_stamp];
            let old = self.items.get(&key);
            if old != Some(&stamps) {
                frame.item(item, old);
            }
            now.insert(key, stamps);
        }
        let mut removed: Vec<Value> = Vec::new();
        for (kind, name) in self.items.keys().filter(|k| !now.contains_key(*k)) {
            removed.push(json!([kind, &**name]));
        }
        removed.sort_by_key(Value::to_string);
        self.items = now;
        if frame.items.is_some() || !removed.is_empty() {
            frame.items.get_or_insert_default();
            frame.put("removed", removed);
        }
    }
}

impl ReplyFrame {
    /// Adds what differs of an item from that of those stamps.
    fn item(&mut self, item: &SceneItem, old: Option<&Stamps>) {
        let is_new = |k: usize, stamp: u64| old.is_none_or(|o| o[k] != stamp);
        let mut parts = Vec::with_capacity(5);
        let connected = is_new(2, item.topology_stamp);
        if is_new(1, item.stamp) || connected {
            let (positions, normals) = (&item.positions, &item.normals);
            for (role, values) in [("position", positions), ("normal", normals)] {
                if role == "position" || !values.is_empty() {
                    let offset = self.append(values, f32::to_le_bytes);
                    parts.push(ArrayHead { role, number: "f32", offset, count: values.len() });
                }
            }
        }
        if connected {
            let c = &item.connections;
            for (role, values) in [("triangle", &c.triangles), ("edge", &c.edges), ("rim", &c.rim)]
            {
                let offset = self.append(values, u32::to_le_bytes);
                parts.push(ArrayHead { role, number: "u32", offset, count: values.len() });
            }
        }
        let head = ItemHead {
            key: (item.kind as u8, &item.name),
            name: &item.name,
            object: &item.object,
            kind: item.kind.word(),
            colour: item.colour,
            hue: item.hue,
            stale: &item.stale,
            origin: item.origin,
            parts,
        };
        let text = serde_json::to_string(&head).expect("names and numbers have a text");
        match &mut self.items {
            Some(items) => {
                items.push(',');
                items.push_str(&text);
            }
            none => *none = Some(text),
        }
    }
}
