//! OFF, text: vertices and polygons (Rost 1989, Object File Format; Geomview manual, section OFF).

use crate::error::check_positions;
use crate::foreign::{ForeignMesh, MeshInProgress};
use crate::numbered::used_vertices;
use crate::text::{TextLine, lines, lines_text, put, quoted, real};
use crate::{FilePosition, ReadError, WriteError};
use moldloft_mesh::{Mesh, is_triangle};
use moldloft_num::Vec3;

const FORMAT: &str = "OFF";

/// The file. Quads are written as such; patches have no names, because readers disagree on
/// comments.
///
/// # Errors
/// Positions that are not finite.
pub fn write(mesh: &Mesh) -> Result<Vec<u8>, WriteError> {
    check_positions(mesh, f64::MAX)?;
    let (points, number) = used_vertices(mesh);
    let mut out = format!("OFF\n{} {} 0\n", points.len(), mesh.faces().len());
    for p in &points {
        let [x, y, z] = p.to_array().map(real);
        put!(out, "{x} {y} {z}\n");
    }
    for patch in mesh.patches() {
        for &face in &mesh.faces()[patch.faces.clone()] {
            let [a, b, c, d] = face.map(|v| number[v as usize]);
            if is_triangle(face) {
                put!(out, "3 {a} {b} {c}\n");
            } else {
                put!(out, "4 {a} {b} {c} {d}\n");
            }
        }
    }
    Ok(out.into_bytes())
}

/// The mesh of a text: `OFF`, possibly with letters for colours, normals and textures before it,
/// which are skipped; counts of vertices, faces and edges; one vertex or face per line. The counts
/// may follow `OFF` on its line, and the word may be missing.
///
/// # Errors
/// Counts that are more than there are lines, bad numbers, corners that are no vertices; other dimensions than three,
/// and the binary form.
pub fn read(bytes: &[u8]) -> Result<ForeignMesh, ReadError> {
    let text = lines_text(bytes, FORMAT)?;
    let mut lines = (1..)
        .zip(lines(&text))
        .map(|(number, text)| (number, text.split('#').next().unwrap_or_default()))
        .filter(|(_, text)| !text.trim().is_empty())
        .map(|(number, text)| TextLine { format: FORMAT, number, text });
    let mut last = 1;
    let mut next = |expected: &dyn Fn() -> String| {
        let line = lines.next().ok_or_else(|| {
            TextLine { format: FORMAT, number: last, text: "" }
                .error(expected(), "the end of the file")
        })?;
        last = line.number;
        Ok::<_, ReadError>(line)
    };
    let counts = || "counts of vertices and faces".to_owned();
    let mut line = next(&|| "`OFF`".into())?;
    line.text = without_name(&line)?;
    if line.text.trim().is_empty() {
        line = next(&counts)?;
    }
    let mut words = line.words();
    let mut count = || {
        let word = words.next();
        let count = line.integer(word, &counts())?;
        usize::try_from(count).map_err(|_| line.error(counts(), quoted(word.unwrap_or_default())))
    };
    let (vertices, faces) = (count()?, count()?);
    let mut mesh = MeshInProgress::default();
    // Every vertex and face has a line, so that memory is proportional to the file.
    for k in 1..=vertices {
        let line = next(&|| format!("vertex {k} of {vertices}"))?;
        let mut words = line.words();
        let mut real = || line.real(words.next(), "a coordinate");
        mesh.points.push(Vec3::of(real()?, real()?, real()?));
    }
    let mut corners = Vec::new();
    for k in 1..=faces {
        let line = next(&|| format!("face {k} of {faces}"))?;
        let mut words = line.words();
        let count = line.integer(words.next(), "a number of corners")?;
        corners.clear();
        for _ in 0..count {
            let word = words.next();
            let corner = line.integer(word, "the number of a vertex")?;
            match u32::try_from(corner) {
                Ok(corner) if (corner as usize) < vertices => corners.push(corner),
                _ => {
                    let expected = format!("a vertex from 0 to {}", vertices.saturating_sub(1));
                    return Err(line.error(expected, quoted(word.unwrap_or_default())));
                }
            }
        }
        if corners.len() < 3 {
            return Err(line.error("a face of three corners or more", corners.len().to_string()));
        }
        mesh.polygon(&corners);
    }
    mesh.built(FORMAT, FilePosition::Line(last), false)
}

/// The first line behind `OFF` and the letters before it.
fn without_name<'a>(line: &TextLine<'a>) -> Result<&'a str, ReadError> {
    let text = line.text.trim_start_matches('\u{feff}').trim_start();
    let letters = text.bytes().take_while(|b| b.is_ascii_alphanumeric()).count();
    let Some(at) = text[..letters].find("OFF") else {
        return if text.starts_with(|c: char| c.is_ascii_digit()) {
            Ok(text)
        } else {
            Err(line.error("`OFF`", quoted(text.split_whitespace().next().unwrap_or_default())))
        };
    };
    let (before, rest) = (&text[..at], &text[at + 3..]);
    if before.contains(['4', 'n']) {
        return Err(line.error("three coordinates to a vertex (`OFF`)", quoted(&text[..at + 3])));
    }
    if rest.trim_start().starts_with("BINARY") {
        return Err(line.error("the text form of OFF", "`BINARY`"));
    }
    Ok(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quads_and_triangles_by_patch() {
        let mesh = crate::fixtures::two_patches();
        let text = String::from_utf8(write(&mesh).unwrap()).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let used = mesh.faces().iter().flatten().collect::<std::collections::BTreeSet<_>>().len();
        assert_eq!(lines[..2], ["OFF".to_string(), format!("{used} {} 0", mesh.faces().len())]);
        assert_eq!(lines.len(), 2 + used + mesh.faces().len());
        assert!(lines.last().unwrap().starts_with("3 "));
    }
}
