//! Wavefront OBJ: vertices, faces, groups.

use crate::error::check_positions;
use crate::text::{TextLine, put, quoted, real, utf8, word};
use crate::{FilePosition, LinesAndPoints, ReadError, WriteError};
use moldloft_mesh::{Mesh, PatchInfo, TopologyBuilder, is_triangle};
use moldloft_num::Vec3;

const FORMAT: &str = "OBJ";

/// The file: all vertices, then one group per patch, quads as quads.
///
/// # Errors
/// Positions that are not finite.
pub fn write(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    write_with(mesh, &LinesAndPoints::default())
}

/// As [`write`], with polylines (`l`) and points (`p`) after the faces.
///
/// # Errors
/// As [`write`].
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

/// The mesh: a patch per run of faces of one group or object. Faces of more than four corners are
/// split into a fan of triangles; texture and normal references, materials and comments are skipped.
///
/// # Errors
/// Bad numbers, faces of fewer than three corners, references to vertices that are not there.
pub fn read(bytes: &[u8]) -> Result<Mesh, ReadError> {
    let text = utf8(bytes, FORMAT)?;
    let mut positions: Vec<Vec3> = Vec::new();
    let mut patches: Vec<(String, Vec<[u32; 4]>)> = vec![("default".into(), Vec::new())];
    let mut last = 0;
    for (number, text) in (1..).zip(text.lines()) {
        last = number;
        let line = TextLine { format: FORMAT, number, text };
        let mut words = text.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut next = || line.real(words.next(), "a coordinate");
                positions.push(Vec3::of(next()?, next()?, next()?));
            }
            Some("g" | "o") => {
                let name = words.next().unwrap_or("default");
                patches.push((name.into(), Vec::new()));
            }
            Some("f") => {
                let corners = words
                    .map(|w| vertex(&line, w, positions.len()))
                    .collect::<Result<Vec<_>, _>>()?;
                let faces = patches.last_mut().map(|p| &mut p.1);
                match (corners.as_slice(), faces) {
                    (&[a, b, c, d], Some(faces)) => faces.push([a, b, c, d]),
                    (&[first, ref rest @ ..], Some(faces)) if rest.len() >= 2 => {
                        faces.extend(rest.windows(2).map(|w| [first, w[0], w[1], w[1]]));
                    }
                    (few, _) => {
                        return Err(
                            line.error("a face of three corners or more", few.len().to_string())
                        );
                    }
                }
            }
            _ => {}
        }
    }
    let build = || {
        let mut builder = TopologyBuilder::new();
        builder.add_vertices(positions.len())?;
        for (name, faces) in patches.into_iter().filter(|p| !p.1.is_empty()) {
            builder.add_faces(PatchInfo::new(name), faces)?;
        }
        Mesh::new(builder.build().into(), positions)
    };
    build().map_err(|e| ReadError::mesh(FORMAT, FilePosition::Line(last), e))
}

/// The vertex of a reference such as `3`, `-1` or `3/1/2`.
fn vertex(line: &TextLine<'_>, word: &str, count: usize) -> Result<u32, ReadError> {
    let index = line.integer(word.split('/').next(), "a vertex number")?;
    let zero_based = if index < 0 { index.saturating_add(count as i64) } else { index - 1 };
    match u32::try_from(zero_based) {
        Ok(v) if (v as usize) < count => Ok(v),
        _ => Err(line.error(format!("a vertex from 1 to {count}"), quoted(word))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::two_patches;

    #[test]
    fn everything_comes_back() {
        let mesh = two_patches();
        let back = read(&write(&mesh).unwrap()).unwrap();
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
        assert_eq!(read(&write(&mesh).unwrap()).unwrap().faces(), [[0, 1, 2, 2]]);
    }

    #[test]
    fn common_forms_and_errors() {
        let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 .5 0\nvn 0 0 1\n\
            usemtl x\nf 1/1/1 2//1 3/1 4\nf -5 -4 -3 -2 -1\n";
        let mesh = read(text.as_bytes()).unwrap();
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
