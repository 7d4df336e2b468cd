//! A reply as one binary message: a JSON header followed by arrays of numbers.
//! `u32 magic, u32 version, u32 length of the header, u32 zero, header, zeros to a multiple of 8,
//! arrays`, little endian. The header describes each array by type, byte offset (after the padding)
//! and count.

use crate::scene::SceneItem;
use rustc_hash::FxHashMap;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::sync::Arc;

/// Magic number: the first four bytes are "MLFT".
pub const MAGIC: u32 = u32::from_le_bytes(*b"MLFT");

/// Version of the frame format.
pub const VERSION: u32 = 1;

/// A reply under construction.
#[derive(Default)]
pub struct ReplyFrame {
    /// The header.
    pub head: Map<String, Value>,
    /// Items of the scene, serialised at once: there are many, and they change with every move of a
    /// slider.
    items: Option<String>,
    arrays: Vec<u8>,
}

/// The header entry of an array.
#[derive(Serialize)]
struct ArrayHead {
    role: &'static str,
    #[serde(rename = "type")]
    number: &'static str,
    offset: usize,
    count: usize,
}

/// The header entry of an item of the scene.
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
    /// Adds a header entry.
    pub fn put(&mut self, key: &str, value: impl Into<Value>) {
        self.head.insert(key.into(), value.into());
    }

    /// Adds an array of 32-bit floats and returns its header entry.
    pub fn floats(&mut self, role: &str, values: &[f32]) -> Value {
        let offset = self.append(values, f32::to_le_bytes);
        json!({"role": role, "type": "f32", "offset": offset, "count": values.len()})
    }

    /// Adds an array of 32-bit unsigned integers and returns its header entry.
    pub fn numbers(&mut self, role: &str, values: &[u32]) -> Value {
        let offset = self.append(values, u32::to_le_bytes);
        json!({"role": role, "type": "u32", "offset": offset, "count": values.len()})
    }

    /// Adds four-byte numbers and returns their byte offset.
    fn append<T: Copy>(&mut self, values: &[T], bytes: impl Fn(T) -> [u8; 4]) -> usize {
        let offset = self.arrays.len();
        self.arrays.resize(offset + 4 * values.len(), 0);
        let (places, _) = self.arrays[offset..].as_chunks_mut();
        for (place, x) in places.iter_mut().zip(values) {
            *place = bytes(*x);
        }
        offset
    }

    /// Adds the bytes of a file and returns their header entry.
    pub fn bytes(&mut self, role: &str, bytes: &[u8]) -> Value {
        let offset = self.arrays.len();
        self.arrays.extend_from_slice(bytes);
        self.arrays.resize(self.arrays.len().next_multiple_of(8), 0);
        json!({"role": role, "type": "u8", "offset": offset, "count": bytes.len()})
    }

    /// The encoded message.
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

/// The stamps of an item known to a viewer: header entry, positions, connectivity.
type Stamps = [u64; 3];

/// State of a viewer, as sent so far.
#[derive(Default)]
pub struct ViewerCache {
    items: FxHashMap<(u8, Arc<str>), Stamps>,
    /// The other header entries sent, as text, by name.
    facts: HashMap<&'static str, String>,
    /// Stamps of long header entries, by name.
    stamps: HashMap<&'static str, u64>,
}

impl ViewerCache {
    /// Adds a header entry, if it differs from the one sent last.
    pub fn fact(&mut self, frame: &mut ReplyFrame, key: &'static str, value: Value) {
        let text = value.to_string();
        if self.facts.get(key) != Some(&text) {
            self.facts.insert(key, text);
            frame.put(key, value);
        }
    }

    /// Adds a header entry, if its stamp differs from the one sent last.
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

    /// Adds the differences from the viewer's scene.
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
    /// Adds the parts of an item whose stamps differ from `old`.
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
