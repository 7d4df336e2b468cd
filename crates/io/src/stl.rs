//! STL: triangles, in binary or text, both written and read.
//!
//! Text has a solid for each patch, named as it: mesh generators take regions of the boundary from them.
//!
//! Binary: 80 bytes of anything, a count, then per triangle its normal, three corners (single
//! precision, little endian) and two unused bytes (3D Systems 1989, Appendix).

use crate::error::{check_positions, check_single};
use crate::foreign::{ForeignMesh, MeshInProgress};
use crate::text::{TextLine, lines, lines_text, put, quoted, real, word};
use crate::{FilePosition, ReadError, StructuredGrid, WriteError, facing};
use moldloft_mesh::{Mesh, PatchInfo, TopologyBuilder};
use moldloft_num::Vec3;

const FORMAT: &str = "STL";
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Number of triangles written between two checks for cancellation.
const TRIANGLES_AT_ONCE: usize = 1 << 14;

/// The binary file. Quads are split along their shorter diagonal. Triangles with two coincident
/// corners in single precision are omitted, which neither closes nor opens a gap; other thin ones
/// are kept, since their neighbours need them.
///
/// # Errors
/// Positions that are not finite in single precision, or so far from the origin that single
/// precision does not resolve the shape; more than 2^32 - 1 triangles.
pub fn write(mesh: &Mesh, name: &str) -> Result<Vec<u8>, WriteError> {
    write_while(mesh, name, &|| true)
}

fn write_while(mesh: &Mesh, name: &str, go_on: &dyn Fn() -> bool) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::from(f32::MAX))?;
    ended_unless(go_on())?;
    check_single(mesh, Vec3::zero(), FORMAT)?;
    ended_unless(go_on())?;
    let triangles = mesh.triangulated();
    // The header must not begin with `solid`, the mark of the text form.
    let mut out = format!("binary STL: {name}").into_bytes();
    out.resize(HEADER, b' ');
    out.truncate(HEADER);
    let mut count = 0usize;
    for (number, &[a, b, c, _]) in triangles.faces().iter().enumerate() {
        if number % TRIANGLES_AT_ONCE == 0 {
            ended_unless(go_on())?;
        }
        // Adding zero turns -0 into 0, so that readers that compare bytes find equal corners.
        let corners =
            [a, b, c].map(|v| mesh.positions()[v as usize].to_array().map(|x| x as f32 + 0.0));
        let [p, q, r] = corners;
        if p == q || q == r || r == p {
            continue;
        }
        let at = |p: [f32; 3]| Vec3::from(p.map(f64::from));
        let normal = (at(q) - at(p)).cross(at(r) - at(p)).normalized().unwrap_or_default();
        for x in normal.to_array().map(|x| x as f32).iter().chain(corners.iter().flatten()) {
            out.extend_from_slice(&x.to_le_bytes());
        }
        out.extend_from_slice(&[0, 0]);
        count += 1;
    }
    let number =
        u32::try_from(count).map_err(|_| WriteError::TooLarge { what: "triangles", count })?;
    out[80..HEADER].copy_from_slice(&number.to_le_bytes());
    Ok(out)
}

/// The text file, with a solid for each patch that has faces; blanks are removed from its name.
/// Coordinates are the shortest decimals of double precision, so that neighbours agree to the bit.
///
/// # Errors
/// Positions that are not finite.
pub fn write_text(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let triangles = mesh.triangulated();
    let mut out = String::new();
    for patch in triangles.patches().iter().filter(|p| !p.faces.is_empty()) {
        let name = word(&patch.info.name);
        put!(out, "solid {name}\n");
        for &[a, b, c, _] in &triangles.faces()[patch.faces.clone()] {
            let corners = [a, b, c].map(|v| triangles.positions()[v as usize]);
            let [p, q, r] = corners;
            if p == q || q == r || r == p {
                continue;
            }
            let normal = (q - p).cross(r - p).normalized().unwrap_or_default();
            let [x, y, z] = normal.to_array().map(|x| real(f64::from(x as f32)));
            put!(out, "facet normal {x} {y} {z}\n outer loop\n");
            for p in corners {
                let [x, y, z] = p.to_array().map(real);
                put!(out, "  vertex {x} {y} {z}\n");
            }
            out.push_str(" endloop\nendfacet\n");
        }
        put!(out, "endsolid {name}\n");
    }
    Ok(out.into_bytes())
}

/// The triangles, with corners at equal positions merged; triangles left without area are omitted.
/// A file is binary if its size agrees with its count, otherwise text if it begins with `solid` and
/// has a facet. A count of 0 or the maximum, as left by programs that write without seeking, is
/// derived from the size.
///
/// # Errors
/// A size that does not fit the count, coordinates that are not finite, and text out of order.
pub fn read(bytes: &[u8]) -> Result<ForeignMesh, ReadError> {
    let count = bytes.get(80..HEADER).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let promised = count.map(|n| HEADER as u64 + TRIANGLE as u64 * u64::from(n));
    let size = bytes.len() as u64;
    if promised == Some(size) {
        return binary(&bytes[HEADER..], MeshInProgress::default());
    }
    if is_text(bytes) {
        return text(bytes);
    }
    let mut mesh = MeshInProgress::default();
    match (count, promised) {
        (Some(n @ (0 | u32::MAX)), _) if bytes.len() >= HEADER + TRIANGLE => {
            mesh.remark(format!("the count of triangles is {n}: all that the file holds are read"));
            let whole = (bytes.len() - HEADER) / TRIANGLE * TRIANGLE;
            mesh.left_out(bytes.len() - HEADER - whole, "bytes after the last triangle");
            binary(&bytes[HEADER..HEADER + whole], mesh)
        }
        (Some(_), Some(promised)) if promised < size => {
            mesh.left_out((size - promised) as usize, "bytes after the last triangle");
            binary(&bytes[HEADER..promised as usize], mesh)
        }
        _ => Err(ReadError {
            format: FORMAT,
            place: FilePosition::Byte(bytes.len().min(80)),
            expected: match (count, promised) {
                (Some(n), Some(promised)) => format!("{promised} bytes of {n} triangles"),
                _ => "a header of 84 bytes, or text that begins with `solid`".into(),
            },
            found: format!("{size} bytes"),
        }),
    }
}

/// True if a file is text: `solid` in any case, followed by a keyword of a facet or of the end.
fn is_text(bytes: &[u8]) -> bool {
    const LOOKED_AT: usize = 4096;
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let head = bytes[..bytes.len().min(LOOKED_AT)].to_ascii_lowercase();
    let holds = |word: &[u8]| head.windows(word.len()).any(|w| w == word);
    head.starts_with(b"solid")
        && [b"facet".as_slice(), b"vertex", b"endsolid"].iter().any(|word| holds(word))
}

fn binary(triangles: &[u8], mut mesh: MeshInProgress) -> Result<ForeignMesh, ReadError> {
    mesh.group("solid");
    mesh.points.reserve(3 * (triangles.len() / TRIANGLE));
    for (k, triangle) in triangles.chunks_exact(TRIANGLE).enumerate() {
        let number = |b: &[u8]| b.try_into().map_or(f64::NAN, |b| f64::from(f32::from_le_bytes(b)));
        for corner in triangle[12..48].chunks_exact(12) {
            let p = Vec3::of(number(&corner[..4]), number(&corner[4..8]), number(&corner[8..]));
            if !p.is_finite() {
                return Err(ReadError {
                    format: FORMAT,
                    place: FilePosition::Byte(HEADER + TRIANGLE * k),
                    expected: "finite coordinates".into(),
                    found: format!("{:?}", p.to_array()),
                });
            }
            mesh.points.push(p);
        }
        facet(&mut mesh);
    }
    mesh.built(FORMAT, FilePosition::Byte(HEADER), true)
}

/// The last three points as a triangle.
fn facet(mesh: &mut MeshInProgress) {
    let end = mesh.points.len() as u32;
    mesh.polygon(&[end - 3, end - 2, end - 1]);
}

fn text(bytes: &[u8]) -> Result<ForeignMesh, ReadError> {
    let text = lines_text(bytes, FORMAT)?;
    let mut mesh = MeshInProgress::default();
    let (mut open, mut last) = (false, 1);
    for (number, text) in (1..).zip(lines(&text)) {
        last = number;
        let line = TextLine { format: FORMAT, number, text };
        let mut words = line.words();
        let word = words.next().map(str::to_ascii_lowercase);
        match word.as_deref() {
            Some("vertex") => {
                let mut next = || line.real(words.next(), "a coordinate");
                mesh.points.push(Vec3::of(next()?, next()?, next()?));
                if mesh.points.len().is_multiple_of(3) {
                    facet(&mut mesh);
                }
            }
            Some("endloop" | "endfacet") if !mesh.points.len().is_multiple_of(3) => {
                return Err(line.error("three vertices in a loop", "another number"));
            }
            Some("solid") => {
                open = true;
                mesh.group(words.next().unwrap_or("solid"));
            }
            Some("endsolid") => open = false,
            None | Some("facet" | "outer" | "endloop" | "endfacet" | "color") => {}
            Some(other) => return Err(line.error("a line of an STL text", quoted(other))),
        }
    }
    if !mesh.points.len().is_multiple_of(3) {
        let line = TextLine { format: FORMAT, number: last, text: "" };
        return Err(line.error("three vertices in a loop", "the end of the file"));
    }
    if open {
        mesh.remark(format!("line {last}: `endsolid` is missing, the file may be cut short"));
    }
    mesh.built(FORMAT, FilePosition::Line(last), true)
}

/// The surfaces as one binary STL. Quads are split along their shorter diagonal; triangles without
/// area at poles are dropped. Facets point out of closed bodies regardless of the orientation of
/// their surfaces, and out of open ones whose rims determine the outside; else along r_i x r_j.
/// With `flip` they are reversed.
///
/// # Errors
/// Empty grids; blocks that are not surfaces; coordinates that are not finite in single precision;
/// [`WriteError::Ended`] when `go_on`, which is called periodically, returns false.
pub fn write_grids(
    blocks: &[StructuredGrid],
    name: &str,
    flip: bool,
    go_on: &dyn Fn() -> bool,
) -> Result<Vec<u8>, WriteError> {
    StructuredGrid::check(blocks, f64::from(f32::MAX))?;
    let cannot = |what| WriteError::CannotHold { format: "STL", what };
    let mut builder = TopologyBuilder::new();
    let mut positions: Vec<Vec3> = Vec::new();
    if blocks.iter().any(|block| block.size[2] != 1 || block.size[0].min(block.size[1]) < 2) {
        return Err(cannot("grids with fewer than two points along an index"));
    }
    let turned = facing::turned(blocks, go_on).ok_or(WriteError::Ended)?;
    for (number, block) in blocks.iter().enumerate() {
        let [m, n, _] = block.size;
        let first = u32::try_from(positions.len())
            .ok()
            .filter(|first| first.checked_add((m * n) as u32).is_some())
            .ok_or(WriteError::TooLarge { what: "points", count: positions.len() })?;
        ended_unless(go_on())?;
        positions.extend(block.layer(0));
        let large = |_| WriteError::TooLarge { what: "points", count: m * n };
        builder.add_vertices(m * n).map_err(large)?;
        let vertices = (first..first + (m * n) as u32).collect();
        let info = PatchInfo::new(format!("grid {}", number + 1));
        builder.add_block(info, m, n, vertices, flip != turned[number]).map_err(large)?;
    }
    let mesh = Mesh::new(builder.build().into(), positions);
    let mesh = mesh.map_err(|_| WriteError::TooLarge { what: "points", count: 0 })?;
    ended_unless(go_on())?;
    write_while(&mesh, name, go_on)
}

fn ended_unless(goes_on: bool) -> Result<(), WriteError> {
    if goes_on { Ok(()) } else { Err(WriteError::Ended) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::two_patches;
    use moldloft_mesh::measure;

    #[test]
    fn triangles_come_back() {
        let mesh = two_patches();
        let bytes = write(&mesh, "hull").unwrap();
        assert_eq!(bytes.len(), 84 + 50 * 7);
        let back = read(&bytes).unwrap().mesh;
        assert_eq!((back.faces().len(), back.positions().len()), (7, 9));
        let area = measure(&mesh.triangulated()).area;
        assert!((measure(&back).area - area).abs() < 1e-6);
        let far = Mesh::new(mesh.topology().clone(), vec![Vec3::of(1e39, 0.0, 0.0); 9]).unwrap();
        assert!(matches!(write(&far, ""), Err(WriteError::NotFinite { vertex: 0, .. })));
    }

    #[test]
    fn text_has_a_solid_for_each_patch() {
        let mesh = two_patches();
        let bytes = write_text(&mesh).unwrap();
        let text = std::str::from_utf8(&bytes).unwrap();
        let solids: Vec<&str> = text.lines().filter(|l| l.starts_with("solid ")).collect();
        let names: Vec<String> =
            mesh.patches().iter().map(|p| format!("solid {}", word(&p.info.name))).collect();
        assert_eq!(solids, names);
        let (back, area) = (read(&bytes).unwrap().mesh, measure(&mesh.triangulated()).area);
        assert_eq!((back.faces().len(), back.positions().len()), (7, 9));
        assert!((measure(&back).area - area).abs() < 1e-15);
    }

    #[test]
    fn text_is_read() {
        let text = b"solid wedge\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
            vertex 0 1 0\nendloop\nendfacet\nendsolid wedge\n";
        let mesh = read(text).unwrap().mesh;
        assert_eq!((measure(&mesh).area, mesh.patches()[0].info.name.as_str()), (0.5, "wedge"));
        let bad = b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n";
        assert_eq!(read(bad).unwrap_err().place, FilePosition::Line(6));
        assert!(read(b"solid\nvertex 1 2\n").unwrap_err().expected.contains("coordinate"));
        assert!(read(b"solid\nvertex 1 2 3\n").is_err());
    }

    #[test]
    fn hostile_counts_are_refused() {
        let mut bytes = write(&two_patches(), "hull").unwrap();
        bytes[83] = 0xff;
        assert!(read(&bytes).unwrap_err().to_string().contains("triangles"));
        assert!(read(&bytes[..50]).is_err() && read(b"").is_err());
        let mut bytes = write(&two_patches(), "hull").unwrap();
        bytes[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
        assert!(read(&bytes).is_err());
    }
}
