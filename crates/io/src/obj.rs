//! Wavefront OBJ: vertices, faces, groups.

use crate::error::check_positions;
use crate::foreign::{ForeignMesh, MeshInProgress};
use crate::text::{TextLine, lines, lines_text, put, quoted, real, word};
use crate::{FilePosition, LinesAndPoints, ReadError, WriteError};
use moldloft_mesh::{Mesh, is_triangle};
use moldloft_num::Vec3;
use std::borrow::Cow;

const FORMAT: &str = "OBJ";

/// The file: all vertices, then one group per patch, quads as quads.
///
/// # Errors
/// Positions that are not finite.
pub fn write(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    write_with(mesh, &LinesAndPoints::default())
}

/// As [`write()`], with polylines (`l`) and points (`p`) after the faces.
///
/// # Errors
/// As [`write()`].
pub fn write_with(mesh: &Mesh, strands: &LinesAndPoints) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let mut used = vec![false; mesh.positions().len()];
    mesh.faces().iter().flatten().for_each(|&v| used[v as usize] = true);
    // Vertices of no face may hold anything, so they are left out.
    let mut number = vec![0u32; used.len()];
    let mut next = 0;
    let mut out = String::from("# vertices in the model's unit; groups are patches\n");
    for (v, p) in mesh.positions().iter().enumerate().filter(|&(v, _)| used[v]) {
        next += 1;
        number[v] = next;
        let [x, y, z] = p.to_array().map(real);
        put!(out, "v {x} {y} {z}\n");
    }
    for patch in mesh.patches() {
        // A patch belongs to a group of its own name, and to one for each of its tags.
        put!(out, "g {}", word(&patch.info.name));
        for tag in &patch.info.tags {
            put!(out, " {}", word(tag));
        }
        out.push('\n');
        for &face in &mesh.faces()[patch.faces.clone()] {
            let [a, b, c, d] = face.map(|v| number[v as usize]);
            if is_triangle(face) {
                put!(out, "f {a} {b} {c}\n");
            } else {
                put!(out, "f {a} {b} {c} {d}\n");
            }
        }
    }
    for (name, wire) in &strands.wires {
        put!(out, "g {}\n", word(name));
        for p in wire {
            let [x, y, z] = p.to_array().map(real);
            put!(out, "v {x} {y} {z}\n");
        }
        out.push('l');
        for _ in wire {
            next += 1;
            put!(out, " {next}");
        }
        out.push('\n');
    }
    for (name, p) in &strands.dots {
        next += 1;
        let [x, y, z] = p.to_array().map(real);
        put!(out, "g {}\nv {x} {y} {z}\np {next}\n", word(name));
    }
    Ok(out.into_bytes())
}

/// The mesh: a patch per sequence of faces of one group or object. Texture and normal references,
/// materials, colours and comments are skipped; polylines, points and free-form curves and surfaces
/// are counted in the warnings. A face may name vertices that follow it, and a line may be
/// continued after `\`.
///
/// # Errors
/// Bad numbers, faces of fewer than three corners, references to vertices that are not there.
pub fn read(bytes: &[u8]) -> Result<ForeignMesh, ReadError> {
    let text = lines_text(bytes, FORMAT)?;
    let mut mesh = MeshInProgress::default();
    let (mut strands, mut free_form) = (0, 0);
    let mut corners = Vec::new();
    // The first corner beyond the vertices before it: it must be there in the end.
    let mut ahead: Option<(u32, usize)> = None;
    let mut last = 1;
    for (number, text) in statements(&text) {
        last = number;
        let line = TextLine { format: FORMAT, number, text: &text };
        let mut words = text.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut next = || line.real(words.next(), "a coordinate");
                mesh.points.push(Vec3::of(next()?, next()?, next()?));
            }
            Some("g" | "o") => mesh.group(words.next().unwrap_or("default")),
            Some("f" | "fo") => {
                corners.clear();
                for word in words {
                    let corner = vertex(&line, word, mesh.points.len())?;
                    if corner as usize >= mesh.points.len()
                        && ahead.is_none_or(|(furthest, _)| corner > furthest)
                    {
                        ahead = Some((corner, number));
                    }
                    corners.push(corner);
                }
                if corners.len() < 3 {
                    let found = corners.len().to_string();
                    return Err(line.error("a face of three corners or more", found));
                }
                mesh.polygon(&corners);
            }
            Some("l" | "p") => strands += 1,
            Some("curv" | "curv2" | "surf") => free_form += 1,
            _ => {}
        }
    }
    if let Some((corner, number)) = ahead
        && corner as usize >= mesh.points.len()
    {
        let line = TextLine { format: FORMAT, number, text: "" };
        let expected = format!("a vertex from 1 to {}", mesh.points.len());
        return Err(line.error(expected, format!("`{}`", u64::from(corner) + 1)));
    }
    mesh.left_out(strands, "polylines and points");
    mesh.left_out(free_form, "free-form curves and surfaces");
    mesh.built(FORMAT, FilePosition::Line(last), false)
}

/// The lines with their numbers, those that end in `\` together with the next.
fn statements(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let mut rows = (1..).zip(lines(text));
    std::iter::from_fn(move || {
        let (number, first) = rows.next()?;
        let mut line = Cow::Borrowed(first);
        while let Some(begun) = line.strip_suffix('\\') {
            let next = rows.next().map_or("", |(_, next)| next);
            line = format!("{begun} {next}").into();
        }
        Some((number, line))
    })
}

/// The vertex of a reference such as `3`, `-1` or `3/1/2`; it may be one that follows.
fn vertex(line: &TextLine<'_>, word: &str, count: usize) -> Result<u32, ReadError> {
    let index = line.integer(word.split('/').next(), "a vertex number")?;
    let zero_based = if index < 0 { index.saturating_add(count as i64) } else { index - 1 };
    // The largest number marks an invalid one.
    u32::try_from(zero_based)
        .ok()
        .filter(|&v| v < u32::MAX)
        .ok_or_else(|| line.error("a vertex number from 1, or from -1 backwards", quoted(word)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::two_patches;
    use moldloft_mesh::{PatchInfo, TopologyBuilder};

    #[test]
    fn everything_comes_back() {
        let mesh = two_patches();
        let back = read(&write(&mesh).unwrap()).unwrap().mesh;
        assert_eq!(back.positions(), mesh.positions());
        assert_eq!(back.faces(), mesh.faces());
        let names: Vec<_> = back.patches().iter().map(|p| p.info.name.as_str()).collect();
        assert_eq!(names, ["fore_body", "aft", "lid"]);
    }

    #[test]
    fn unused_vertices_may_hold_anything() {
        let mut b = TopologyBuilder::new();
        b.add_vertices(4).unwrap();
        b.add_faces(PatchInfo::new("a"), [[1, 2, 3, 3]]).unwrap();
        let p = [[f64::NAN; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vec3::from);
        let mesh = Mesh::new(b.build().into(), p.to_vec()).unwrap();
        assert_eq!(read(&write(&mesh).unwrap()).unwrap().mesh.faces(), [[0, 1, 2, 2]]);
    }

    #[test]
    fn common_forms_and_errors() {
        let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 .5 0\nvn 0 0 1\n\
            usemtl x\nf 1/1/1 2//1 3/1 4\nf -5 -4 -3 -2 -1\n";
        let mesh = read(text.as_bytes()).unwrap().mesh;
        assert_eq!(mesh.faces(), [[0, 1, 2, 3], [0, 1, 2, 2], [0, 2, 3, 3], [0, 3, 4, 4]]);
        for (bad, place) in [
            ("v 0 0\n", 1),
            ("v 0 0 inf\n", 1),
            ("v 0 0 0\nf 1 1\n", 2),
            ("v 0 0 0\nf 1 1 2\n", 2),
            ("v 0 0 0\nf 0 1 1\n", 2),
            ("v 0 0 0\nf -2 1 1\n", 2),
            ("v 0 0 0\n\nf a b c\n", 3),
            ("v 0 0 0\nf -9223372036854775808 1 1\n", 2),
        ] {
            assert_eq!(
                read(bad.as_bytes()).unwrap_err().place,
                FilePosition::Line(place),
                "{bad:?}"
            );
        }
    }
}
