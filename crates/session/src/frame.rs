//! A reply as one binary message: a head in JSON, and arrays of numbers behind it.
//!
//! `u32 magic, u32 version, u32 bytes of the head, u32 zero, head, zeros to a multiple of 8, arrays`,
//! little endian. The head names each array by type, first byte (after the padding) and count.

use crate::scene::SceneItem;
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
    arrays: Vec<u8>,
}

impl ReplyFrame {
    /// Adds a fact.
    pub fn put(&mut self, key: &str, value: impl Into<Value>) {
        self.head.insert(key.into(), value.into());
    }

    /// Adds an array of 32-bit floats; what names it.
    pub fn floats(&mut self, role: &str, values: &[f32]) -> Value {
        let offset = self.arrays.len();
        self.arrays.extend(values.iter().flat_map(|x| x.to_le_bytes()));
        json!({"role": role, "type": "f32", "offset": offset, "count": values.len()})
    }

    /// Adds an array of whole numbers; what names it.
    pub fn numbers(&mut self, role: &str, values: &[u32]) -> Value {
        let offset = self.arrays.len();
        self.arrays.extend(values.iter().flat_map(|x| x.to_le_bytes()));
        json!({"role": role, "type": "u32", "offset": offset, "count": values.len()})
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
        let head = Value::Object(self.head).to_string().into_bytes();
        let mut bytes = Vec::with_capacity(24 + head.len() + self.arrays.len());
        for word in [MAGIC, VERSION, head.len() as u32, 0] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(head);
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
    items: HashMap<(u8, Arc<str>), Stamps>,
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
        let mut changed = Vec::new();
        let mut now = HashMap::with_capacity(items.len());
        for item in items {
            let key = (item.kind as u8, item.name.clone());
            let stamps = [item.head_stamp, item.stamp, item.topology_stamp];
            let old = self.items.get(&key);
            if old != Some(&stamps) {
                changed.push(sent(frame, item, old));
            }
            now.insert(key, stamps);
        }
        let mut removed: Vec<Value> = Vec::new();
        for (kind, name) in self.items.keys().filter(|k| !now.contains_key(*k)) {
            removed.push(json!([kind, &**name]));
        }
        removed.sort_by_key(Value::to_string);
        self.items = now;
        if !changed.is_empty() || !removed.is_empty() {
            frame.put("items", changed);
            frame.put("removed", removed);
        }
    }
}

fn sent(frame: &mut ReplyFrame, item: &SceneItem, old: Option<&Stamps>) -> Value {
    let is_new = |k: usize, stamp: u64| old.is_none_or(|o| o[k] != stamp);
    let mut parts = Vec::new();
    if is_new(1, item.stamp) || is_new(2, item.topology_stamp) {
        parts.push(frame.floats("position", &item.positions));
        if !item.normals.is_empty() {
            parts.push(frame.floats("normal", &item.normals));
        }
    }
    if is_new(2, item.topology_stamp) {
        let c = &item.connections;
        for (role, values) in [("triangle", &c.triangles), ("edge", &c.edges), ("rim", &c.rim)] {
            parts.push(frame.numbers(role, values));
        }
    }
    json!({
        "key": [item.kind as u8, &*item.name],
        "name": &*item.name,
        "object": &*item.object,
        "kind": item.kind.word(),
        "colour": item.colour,
        "hue": item.hue,
        "stale": &*item.stale,
        "origin": item.origin,
        "parts": parts,
    })
}
