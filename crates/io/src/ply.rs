//! PLY (Turk 1994, The PLY Polygon File Format): written binary, vertices in double precision and faces; read in text
//! and binary of either byte order.
//!
//! A header is data: elements and properties of any names and types are stepped over, those of vertices and faces are
//! taken. Memory grows with the bytes that are there, not with the counts of the header.
//!
//! The patches are in comments, each with its range of faces: properties of faces besides their
//! corners would serve too, but common readers (meshio 5.3, trimesh 5) refuse such files.

use crate::error::check_positions;
use crate::foreign::{ForeignMesh, MeshInProgress};
use crate::text::{put, quoted, word};
use crate::{FilePosition, ReadError, WriteError};
use moldloft_mesh::{Mesh, is_triangle};
use moldloft_num::Vec3;

const FORMAT: &str = "PLY";

/// The file. Quads are written as such if there are no triangles: common readers (trimesh 5, gmsh
/// 4.15) refuse a binary list of faces of different lengths.
///
/// # Errors
/// Positions that are not finite; more than 2^31 - 1 vertices.
pub fn write(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let triangles = mesh.faces().iter().filter(|f| is_triangle(**f)).count();
    let split = (triangles > 0 && triangles < mesh.faces().len()).then(|| mesh.triangulated());
    let mesh = split.as_ref().unwrap_or(mesh);
    let mut used = vec![false; mesh.positions().len()];
    mesh.faces().iter().flatten().for_each(|&v| used[v as usize] = true);
    let mut number = vec![0i32; used.len()];
    let mut points = Vec::new();
    for (v, p) in mesh.positions().iter().enumerate().filter(|&(v, _)| used[v]) {
        let what = "vertices";
        let count = points.len();
        number[v] = i32::try_from(count).map_err(|_| WriteError::TooLarge { what, count })?;
        points.push(p.to_array());
    }
    let mut head = String::from("ply\nformat binary_little_endian 1.0\n");
    for patch in mesh.patches() {
        let (name, tag) = (word(&patch.info.name), word(patch.info.tag.word()));
        put!(head, "comment patch {name} {tag} faces {} {}\n", patch.faces.start, patch.faces.end);
    }
    put!(head, "element vertex {}\n", points.len());
    for axis in ["x", "y", "z"] {
        put!(head, "property double {axis}\n");
    }
    put!(head, "element face {}\nproperty list uchar int vertex_indices\n", mesh.faces().len());
    head.push_str("end_header\n");
    let mut out = head.into_bytes();
    for x in points.iter().flatten() {
        out.extend_from_slice(&(x + 0.0).to_le_bytes());
    }
    for &face in mesh.faces() {
        let n = if is_triangle(face) { 3 } else { 4 };
        out.push(n as u8);
        for v in &face[..n] {
            out.extend_from_slice(&number[*v as usize].to_le_bytes());
        }
    }
    Ok(out)
}

const LONGEST_HEADER: usize = 1 << 20;

#[derive(Clone, Copy, Debug, PartialEq)]
enum PlyScalar {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

impl PlyScalar {
    fn of(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::Signed(1),
            "short" | "int16" => Self::Signed(2),
            "int" | "int32" => Self::Signed(4),
            "uchar" | "uint8" => Self::Unsigned(1),
            "ushort" | "uint16" => Self::Unsigned(2),
            "uint" | "uint32" => Self::Unsigned(4),
            "float" | "float32" => Self::Float(4),
            "double" | "float64" => Self::Float(8),
            _ => return None,
        })
    }

    fn size(self) -> usize {
        let (Self::Signed(size) | Self::Unsigned(size) | Self::Float(size)) = self;
        size
    }
}

#[derive(Debug)]
struct PlyProperty {
    name: String,
    /// The type of the length of a list.
    length: Option<PlyScalar>,
    value: PlyScalar,
}

#[derive(Debug)]
struct PlyElement {
    name: String,
    count: usize,
    properties: Vec<PlyProperty>,
    /// The line of the header.
    line: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum PlyEncoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// The mesh of a file: points, polygons as quads and triangles, strips of triangles (`tristrips`) as triangles.
///
/// # Errors
/// A header out of order, fewer bytes than the header says, coordinates that are not finite, corners that are no
/// vertices.
pub fn read(bytes: &[u8]) -> Result<ForeignMesh, ReadError> {
    let (PlyHeader { encoding, elements, unknown, lines }, body) = header(bytes)?;
    let mut data = PlyBody { rest: &bytes[body..], at: body, line: lines + 1, encoding, longer: 0 };
    let mut mesh = MeshInProgress::default();
    mesh.left_out(unknown, "lines of the header");
    let mut corners = PlyCorners::default();
    for element in &elements {
        let least = element.properties.iter().map(|p| data.least(p)).sum::<usize>();
        let needed = element.count.saturating_mul(least);
        // A text's last number needs no blank behind it.
        if needed > data.rest.len() + 1 {
            return Err(ReadError {
                format: FORMAT,
                place: FilePosition::Line(element.line),
                expected: format!("at least {needed} bytes of {} {}", element.count, element.name),
                found: format!("{}", data.rest.len()),
            });
        }
        match element.name.as_str() {
            "vertex" => vertices(element, &mut data, &mut mesh)?,
            "face" | "tristrips" => corners.read(element, &mut data)?,
            other => {
                for k in 0..if least == 0 { 0 } else { element.count } {
                    for property in &element.properties {
                        data.skip(property, other, k)?;
                    }
                    data.end();
                }
                mesh.left_out(element.count, &format!("elements `{}`", shown(other)));
            }
        }
    }
    mesh.left_out(data.longer, "ends of lines with more numbers than the header says");
    corners.put(&mut mesh)?;
    mesh.built(FORMAT, FilePosition::Byte(bytes.len()), false)
}

fn shown(name: &str) -> String {
    quoted(name).trim_matches('`').to_owned()
}

struct PlyHeader {
    encoding: PlyEncoding,
    elements: Vec<PlyElement>,
    /// Lines that do not belong to a header.
    unknown: usize,
    lines: usize,
}

/// The header, and where the body begins.
fn header(bytes: &[u8]) -> Result<(PlyHeader, usize), ReadError> {
    let error = |line: usize, expected: &str, found: &str| ReadError {
        format: FORMAT,
        place: FilePosition::Line(line),
        expected: expected.into(),
        found: if found.is_empty() { "an empty line".into() } else { quoted(found) },
    };
    let (mut at, mut encoding, mut unknown) = (0, None, 0);
    let mut elements: Vec<PlyElement> = Vec::new();
    let mut line = 0;
    loop {
        line += 1;
        let head = bytes.get(at..bytes.len().min(LONGEST_HEADER)).unwrap_or_default();
        let Some(length) = head.iter().position(|b| matches!(b, b'\n' | b'\r')) else {
            return Err(ReadError {
                format: FORMAT,
                place: FilePosition::Line(line),
                expected: if line == 1 { "`ply`" } else { "`end_header`" }.into(),
                found: "the end of the file".into(),
            });
        };
        let text = String::from_utf8_lossy(&head[..length]);
        at += length + if head[length..].starts_with(b"\r\n") { 2 } else { 1 };
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        match *words.as_slice() {
            ["ply"] if line == 1 => {}
            _ if line == 1 => return Err(error(line, "`ply`", &text)),
            [] | ["comment" | "obj_info", ..] => {}
            ["format", form, ..] => {
                encoding = Some(match form {
                    "ascii" => PlyEncoding::Text,
                    "binary_little_endian" => PlyEncoding::LittleEndian,
                    "binary_big_endian" => PlyEncoding::BigEndian,
                    _ => return Err(error(line, "`ascii` or a binary format", form)),
                });
            }
            ["element", name, count] => {
                let count = count.parse().map_err(|_| error(line, "a count of elements", count))?;
                elements.push(PlyElement {
                    name: name.into(),
                    count,
                    properties: Vec::new(),
                    line,
                });
            }
            ["property", ref rest @ ..] => {
                let property = property(rest).ok_or_else(|| {
                    error(line, "`property TYPE NAME` or `property list TYPE TYPE NAME`", &text)
                })?;
                let element = elements.last_mut();
                element.ok_or_else(|| error(line, "`element`", &text))?.properties.push(property);
            }
            ["end_header", ..] => {
                let encoding = encoding.ok_or_else(|| error(line, "`format` before it", &text))?;
                return Ok((PlyHeader { encoding, elements, unknown, lines: line }, at));
            }
            // A comment that was broken into lines, as some programs write it.
            _ => unknown += 1,
        }
    }
}

fn property(words: &[&str]) -> Option<PlyProperty> {
    let (length, value, name) = match *words {
        ["list", length, value, name] => (Some(PlyScalar::of(length)?), value, name),
        [value, name] => (None, value, name),
        _ => return None,
    };
    Some(PlyProperty { name: name.into(), length, value: PlyScalar::of(value)? })
}

/// Data after the header.
struct PlyBody<'a> {
    rest: &'a [u8],
    at: usize,
    line: usize,
    encoding: PlyEncoding,
    /// Lines of a text with more numbers than an element has.
    longer: usize,
}

impl PlyBody<'_> {
    /// The fewest bytes that a property takes.
    fn least(&self, property: &PlyProperty) -> usize {
        match self.encoding {
            // A digit and a blank.
            PlyEncoding::Text => 2,
            _ => property.length.unwrap_or(property.value).size(),
        }
    }

    /// Position of the next number.
    fn place(&mut self) -> FilePosition {
        self.skip_blanks();
        self.here()
    }

    fn here(&self) -> FilePosition {
        match self.encoding {
            PlyEncoding::Text => FilePosition::Line(self.line),
            _ => FilePosition::Byte(self.at),
        }
    }

    fn error(&self, expected: impl Into<String>, found: impl Into<String>) -> ReadError {
        let (expected, found) = (expected.into(), found.into());
        ReadError { format: FORMAT, place: self.here(), expected, found }
    }

    /// Skips blanks of a text; binary numbers follow one another.
    fn skip_blanks(&mut self) {
        if self.encoding == PlyEncoding::Text {
            while let Some(blank) = self.rest.first().filter(|b| b.is_ascii_whitespace()) {
                self.line += usize::from(*blank == b'\n');
                self.taken(1);
            }
        }
    }

    /// After an element: in a text it has a line of its own.
    fn end(&mut self) {
        if self.encoding == PlyEncoding::Text {
            let length = self.rest.iter().position(|b| matches!(b, b'\n' | b'\r'));
            let more = !self.taken(length.unwrap_or(self.rest.len())).trim_ascii().is_empty();
            self.longer += usize::from(more);
        }
    }

    fn taken(&mut self, count: usize) -> &[u8] {
        let (taken, rest) = self.rest.split_at(count);
        self.rest = rest;
        self.at += count;
        taken
    }

    /// The next number of element `k` (from 0).
    fn number(&mut self, scalar: PlyScalar, element: &str, k: usize) -> Result<f64, ReadError> {
        let end = |data: &Self| {
            let expected = format!("{} {}", shown(element), k + 1);
            Err(data.error(expected, "the end of the file"))
        };
        if self.encoding == PlyEncoding::Text {
            self.skip_blanks();
            let length = self.rest.iter().position(u8::is_ascii_whitespace);
            let word = self.taken(length.unwrap_or(self.rest.len()));
            if word.is_empty() {
                return end(self);
            }
            let word = String::from_utf8_lossy(word).into_owned();
            return word.parse().map_err(|_| self.error("a number", quoted(&word)));
        }
        if self.rest.len() < scalar.size() {
            return end(self);
        }
        let big = self.encoding == PlyEncoding::BigEndian;
        let mut word = [0; 8];
        let size = scalar.size();
        word[..size].copy_from_slice(self.taken(size));
        if big {
            word[..size].reverse();
        }
        let bits = u64::from_le_bytes(word);
        Ok(match scalar {
            PlyScalar::Float(4) => f64::from(f32::from_bits(bits as u32)),
            PlyScalar::Float(_) => f64::from_bits(bits),
            PlyScalar::Unsigned(_) => bits as f64,
            PlyScalar::Signed(_) => {
                let unused = 64 - 8 * size as u32;
                ((bits << unused) as i64 >> unused) as f64
            }
        })
    }

    fn length(&mut self, scalar: PlyScalar, element: &str, k: usize) -> Result<usize, ReadError> {
        let length = self.number(scalar, element, k)?;
        let most = self.rest.len();
        if length >= 0.0 && length <= most as f64 && length.fract() == 0.0 {
            Ok(length as usize)
        } else {
            Err(self.error(format!("the length of a list, at most {most}"), format!("{length}")))
        }
    }

    fn skip(&mut self, property: &PlyProperty, element: &str, k: usize) -> Result<(), ReadError> {
        let length = match property.length {
            None => 1,
            Some(scalar) => self.length(scalar, element, k)?,
        };
        for _ in 0..length {
            self.number(property.value, element, k)?;
        }
        Ok(())
    }
}

fn vertices(
    element: &PlyElement,
    data: &mut PlyBody<'_>,
    mesh: &mut MeshInProgress,
) -> Result<(), ReadError> {
    let header = |expected: &str, found: &str| ReadError {
        format: FORMAT,
        place: FilePosition::Line(element.line),
        expected: expected.into(),
        found: found.into(),
    };
    let axis = |name: &str| {
        let found = element.properties.iter().position(|p| p.name == name && p.length.is_none());
        found.ok_or_else(|| header("vertices with the properties x, y and z", "others"))
    };
    let axes = [axis("x")?, axis("y")?, axis("z")?];
    for k in 0..element.count {
        let mut p = [0.0; 3];
        for (number, property) in element.properties.iter().enumerate() {
            match axes.iter().position(|&axis| axis == number) {
                None => data.skip(property, "vertex", k)?,
                Some(axis) => {
                    let place = data.place();
                    p[axis] = data.number(property.value, "vertex", k)?;
                    if !p[axis].is_finite() {
                        let (expected, found) = ("a finite coordinate".into(), p[axis].to_string());
                        return Err(ReadError { format: FORMAT, place, expected, found });
                    }
                }
            }
        }
        mesh.points.push(Vec3::from(p));
        data.end();
    }
    Ok(())
}

/// The corners of faces; they may come before the vertices.
#[derive(Default)]
struct PlyCorners {
    all: Vec<i64>,
    /// For each face the end of its corners, and its position.
    faces: Vec<(usize, FilePosition)>,
    strips: bool,
}

impl PlyCorners {
    fn read(&mut self, element: &PlyElement, data: &mut PlyBody<'_>) -> Result<(), ReadError> {
        self.strips |= element.name == "tristrips";
        let lists = || element.properties.iter().enumerate().filter(|(_, p)| p.length.is_some());
        let named = lists().find(|(_, p)| matches!(&*p.name, "vertex_indices" | "vertex_index"));
        let Some(list) = named.or_else(|| lists().next()).map(|(number, _)| number) else {
            let place = FilePosition::Line(element.line);
            let expected = "a list of vertices among the properties of a face".into();
            return Err(ReadError { format: FORMAT, place, expected, found: "none".into() });
        };
        for k in 0..element.count {
            for (number, property) in element.properties.iter().enumerate() {
                let Some(scalar) = property.length.filter(|_| number == list) else {
                    data.skip(property, &element.name, k)?;
                    continue;
                };
                let place = data.place();
                let length = data.length(scalar, &element.name, k)?;
                for _ in 0..length {
                    let corner = data.number(property.value, &element.name, k)?;
                    if corner.fract() != 0.0 || !(corner.abs() < 2.0f64.powi(53)) {
                        return Err(data.error("the number of a vertex", corner.to_string()));
                    }
                    self.all.push(corner as i64);
                }
                if length < 3 && !self.strips {
                    let expected = "a face of three corners or more".into();
                    let found = length.to_string();
                    return Err(ReadError { format: FORMAT, place, expected, found });
                }
                self.faces.push((self.all.len(), place));
            }
            data.end();
        }
        Ok(())
    }

    fn put(self, mesh: &mut MeshInProgress) -> Result<(), ReadError> {
        let count = mesh.points.len();
        let (mut begin, mut corners) = (0, Vec::new());
        for (end, place) in self.faces {
            corners.clear();
            for &corner in &self.all[begin..end] {
                if self.strips && corner == -1 {
                    strip(&corners, mesh);
                    corners.clear();
                    continue;
                }
                match u32::try_from(corner) {
                    Ok(corner) if (corner as usize) < count => corners.push(corner),
                    _ => {
                        let expected = format!("a vertex from 0 to {}", count.saturating_sub(1));
                        let found = corner.to_string();
                        return Err(ReadError { format: FORMAT, place, expected, found });
                    }
                }
            }
            if self.strips {
                strip(&corners, mesh);
            } else {
                mesh.polygon(&corners);
            }
            begin = end;
        }
        Ok(())
    }
}

/// A strip of triangles, every other one turned.
fn strip(corners: &[u32], mesh: &mut MeshInProgress) {
    for (k, w) in corners.windows(3).enumerate() {
        mesh.polygon(&if k % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] });
    }
}
