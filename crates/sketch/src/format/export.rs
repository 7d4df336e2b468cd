//! Writers of finished objects: bytes out, no input or output.

use crate::SketchSolid;
use crate::format::json::Json;
use moldloft_mesh::{Mesh, is_triangle};
use moldloft_num::Vec3;
use moldloft_syntax::number::plain;
use std::fmt::Write;

/// A triangle mesh as plain arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IndexedTriangles {
    /// Vertices.
    pub vertices: Vec<Vec3>,
    /// Triangles, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl IndexedTriangles {
    /// The triangles of a mesh, vertices that nothing uses left out.
    pub fn of(mesh: &Mesh<f64>) -> IndexedTriangles {
        let mut number = vec![u32::MAX; mesh.positions().len()];
        let mut out = IndexedTriangles::default();
        let mut vertex = |v: u32, out: &mut IndexedTriangles| {
            let own = &mut number[v as usize];
            if *own == u32::MAX {
                *own = out.vertices.len() as u32;
                out.vertices.push(mesh.positions()[v as usize]);
            }
            *own
        };
        for &face in mesh.faces() {
            let [a, b, c, d] = face.map(|v| vertex(v, &mut out));
            out.triangles.push([a, b, c]);
            if !is_triangle(face) {
                out.triangles.push([a, c, d]);
            }
        }
        out
    }

    fn corners(&self, t: [u32; 3]) -> [Vec3; 3] {
        t.map(|v| self.vertices[v as usize])
    }
}

fn words(p: Vec3) -> String {
    p.to_array().map(plain).join(" ")
}

/// ASCII STL.
pub fn stl(mesh: &IndexedTriangles, name: &str) -> String {
    let mut out = format!("solid {name}\n");
    for &t in &mesh.triangles {
        let [a, b, c] = mesh.corners(t);
        let n = (b - a).cross(c - a).normalized().unwrap_or_default();
        let _ = writeln!(out, " facet normal {}\n  outer loop", words(n));
        for p in [a, b, c] {
            let _ = writeln!(out, "   vertex {}", words(p));
        }
        out.push_str("  endloop\n endfacet\n");
    }
    let _ = writeln!(out, "endsolid {name}");
    out
}

/// Wavefront OBJ.
pub fn obj(mesh: &IndexedTriangles, name: &str) -> String {
    let mut out = format!("o {name}\n");
    for &p in &mesh.vertices {
        let _ = writeln!(out, "v {}", words(p));
    }
    for [a, b, c] in &mesh.triangles {
        let _ = writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    out
}

/// glTF 2.0 with its buffer inside, in metres; the unit is `metres` long. glTF has y up, so (x, y,
/// z) becomes (x, z, -y).
pub fn gltf(mesh: &IndexedTriangles, name: &str, metres: f64) -> String {
    let bytes = buffer(mesh);
    let uri = format!("data:application/octet-stream;base64,{}", base64(&bytes));
    gltf_text(
        mesh,
        name,
        metres,
        Json::map([("byteLength", Json::from(bytes.len())), ("uri", Json::from(uri.as_str()))]),
    )
}

/// glTF 2.0 in the binary form: a header, the text, the buffer (glTF 2.0, section 4.4).
pub fn glb(mesh: &IndexedTriangles, name: &str, metres: f64) -> Vec<u8> {
    let bytes = buffer(mesh);
    let length = Json::map([("byteLength", Json::from(bytes.len()))]);
    let mut text = gltf_text(mesh, name, metres, length).into_bytes();
    while !text.len().is_multiple_of(4) {
        text.push(b' ');
    }
    // The buffer is made of words of four bytes.
    let total = 12 + 8 + text.len() + 8 + bytes.len();
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut out = Vec::with_capacity(total);
    out.extend(b"glTF");
    out.extend(word(2));
    out.extend(word(total));
    out.extend(word(text.len()));
    out.extend(b"JSON");
    out.extend(text);
    out.extend(word(bytes.len()));
    out.extend(b"BIN\0");
    out.extend(bytes);
    out
}

/// Positions, then corners of triangles.
fn buffer(mesh: &IndexedTriangles) -> Vec<u8> {
    let mut bytes: Vec<u8> = Vec::new();
    for p in &mesh.vertices {
        [p.x as f32, p.z as f32, -p.y as f32].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    mesh.triangles.iter().flatten().for_each(|v| bytes.extend(v.to_le_bytes()));
    bytes
}

fn gltf_text(mesh: &IndexedTriangles, name: &str, metres: f64, buffer: Json) -> String {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for p in &mesh.vertices {
        for (k, x) in [p.x as f32, p.z as f32, -p.y as f32].into_iter().enumerate() {
            (low[k], high[k]) = (low[k].min(x), high[k].max(x));
        }
    }
    let start = 12 * mesh.vertices.len();
    let end = start + 12 * mesh.triangles.len();
    let number = |x: usize| Json::from(x);
    let bounds = |b: [f32; 3]| Json::list(b.map(|x| Json::from(f64::from(x))));
    let view = |offset: usize, length: usize, target: usize| {
        Json::map([
            ("buffer", number(0)),
            ("byteOffset", number(offset)),
            ("byteLength", number(length)),
            ("target", number(target)),
        ])
    };
    let attributes = Json::map([("POSITION", number(0))]);
    let primitive = Json::map([("attributes", attributes), ("indices", number(1))]);
    let one = |x: Json| Json::list([x]);
    let scale = Json::list([metres; 3].map(Json::from));
    let node = [("mesh", number(0)), ("name", Json::from(name)), ("scale", scale)];
    Json::map([
        ("asset", Json::map([("version", Json::from("2.0"))])),
        ("scene", number(0)),
        ("scenes", one(Json::map([("nodes", one(number(0)))]))),
        ("nodes", one(Json::map(node))),
        ("meshes", one(Json::map([("primitives", one(primitive))]))),
        (
            "accessors",
            Json::list([
                Json::map([
                    ("bufferView", number(0)),
                    ("componentType", number(5126)),
                    ("count", number(mesh.vertices.len())),
                    ("type", Json::from("VEC3")),
                    ("min", bounds(low)),
                    ("max", bounds(high)),
                ]),
                Json::map([
                    ("bufferView", number(1)),
                    ("componentType", number(5125)),
                    ("count", number(3 * mesh.triangles.len())),
                    ("type", Json::from("SCALAR")),
                ]),
            ]),
        ),
        ("bufferViews", Json::list([view(0, start, 34962), view(start, end - start, 34963)])),
        ("buffers", one(buffer)),
    ])
    .to_string()
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len() * 4 / 3 + 4);
    for chunk in bytes.chunks(3) {
        let part = |k: usize| u32::from(chunk.get(k).copied().unwrap_or(0));
        let word = part(0) << 16 | part(1) << 8 | part(2);
        for k in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * k) & 63) as usize] as char;
            out.push(if k <= chunk.len() { digit } else { '=' });
        }
    }
    out
}

/// 3MF: a ZIP archive (entries stored as they are) with one mesh.
pub fn three_mf(mesh: &IndexedTriangles, unit: Option<&str>) -> Vec<u8> {
    let unit = match unit {
        Some("CM") => "centimeter",
        Some("M") => "meter",
        Some("IN") => "inch",
        Some("FT") => "foot",
        _ => "millimeter",
    };
    let mut model = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"{unit}\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources><object id=\"1\" type=\"model\"><mesh><vertices>\n"
    );
    for p in &mesh.vertices {
        let [x, y, z] = p.to_array().map(plain);
        let _ = writeln!(model, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
    }
    model.push_str("</vertices><triangles>\n");
    for [a, b, c] in &mesh.triangles {
        let _ = writeln!(model, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>");
    }
    model.push_str(
        "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>\n",
    );
    let types = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\"><Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/><Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
    let links = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";
    zip(&[
        ("[Content_Types].xml", types.as_bytes()),
        ("_rels/.rels", links.as_bytes()),
        ("3D/3dmodel.model", model.as_bytes()),
    ])
}

/// A ZIP archive of stored entries, dated 1980-01-01 so that equal content gives equal bytes.
fn zip(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in entries {
        let offset = out.len() as u32;
        let size = (bytes.len() as u32).to_le_bytes();
        let mut common: Vec<u8> = vec![20, 0, 0, 0, 0, 0, 0, 0, 33, 0];
        common.extend(crc32(bytes).to_le_bytes());
        common.extend(size);
        common.extend(size);
        common.extend((name.len() as u16).to_le_bytes());
        common.extend([0, 0]);
        out.extend(b"PK\x03\x04");
        out.extend(&common);
        out.extend(name.as_bytes());
        out.extend(*bytes);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&common);
        directory.extend([0; 10]);
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let start = out.len() as u32;
    let count = (entries.len() as u16).to_le_bytes();
    out.extend(&directory);
    out.extend(b"PK\x05\x06\0\0\0\0");
    out.extend(count);
    out.extend(count);
    out.extend((directory.len() as u32).to_le_bytes());
    out.extend(start.to_le_bytes());
    out.extend([0, 0]);
    out
}

/// CRC-32 of IEEE 802.3, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = !0u32;
    for &b in bytes {
        crc ^= u32::from(b);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
        }
    }
    !crc
}

/// DXF (release 12): facets as 3DFACE, edges as LINE on a separate layer.
pub fn dxf(mesh: &IndexedTriangles, solid: &SketchSolid<f64>, tolerance: f64) -> String {
    let mut out = String::from("0\nSECTION\n2\nENTITIES\n");
    let point = |out: &mut String, k: u32, p: Vec3| {
        let [x, y, z] = p.to_array().map(plain);
        let _ = write!(out, "{}\n{x}\n{}\n{y}\n{}\n{z}\n", 10 + k, 20 + k, 30 + k);
    };
    for &t in &mesh.triangles {
        let [a, b, c] = mesh.corners(t);
        out.push_str("0\n3DFACE\n8\nFACES\n");
        for (k, p) in [a, b, c, c].into_iter().enumerate() {
            point(&mut out, k as u32, p);
        }
    }
    for edge in &solid.edges {
        let [p, q] = edge.ends.map(|v| solid.vertices[v].at);
        let n = edge.piece.map_or(1, |piece| piece.chords(tolerance));
        let at = |k: usize| match edge.piece {
            Some(piece) => piece.at(k as f64 / n as f64),
            None => [p, q][k],
        };
        for k in 0..n {
            out.push_str("0\nLINE\n8\nEDGES\n");
            point(&mut out, 0, at(k));
            point(&mut out, 1, at(k + 1));
        }
    }
    out.push_str("0\nENDSEC\n0\nEOF\n");
    out
}
