//! `interfaces`: the connections and boundaries of blocks as text.

use crate::functions::block_files::Connected;
use crate::functions::named_blocks::NamedBlock;
use moldloft_grid::GridFace;
use moldloft_io::cgns::FacePart;
use std::fmt::Write;

/// A part of a face, with its index ranges from 1.
pub(super) fn part_text(
    blocks: &[NamedBlock],
    flat: bool,
    (block, face, from, to): &FacePart,
) -> String {
    let word = match (flat, GridFace::ALL[*face].word()) {
        (true, "in") => "im",
        (_, word) => word,
    };
    let range = |k: usize| match from[k] == to[k] {
        true => (from[k] + 1).to_string(),
        false => format!("{}:{}", from[k] + 1, to[k] + 1),
    };
    let axes = if flat { 2 } else { 3 };
    let ranges: Vec<String> = (0..axes).map(range).collect();
    format!("{} {word} [{}]", blocks[*block].name, ranges.join(","))
}

/// A line for each connection, each hanging interface and each boundary: names, faces and index ranges from 1; behind a connection the axis of the
/// second block along each one of the first.
pub(super) fn joint_report(blocks: &[NamedBlock], connected: &Connected, flat: bool) -> String {
    let axes = if flat { 2 } else { 3 };
    let part = |of: &FacePart| part_text(blocks, flat, of);
    let mut lines = Vec::new();
    for (own, other, transform, movement) in &connected.joints {
        let axis = |k: usize| {
            let name = ["i", "j", "k"][transform[k].unsigned_abs() as usize - 1];
            if transform[k] < 0 { format!("-{name}") } else { name.to_string() }
        };
        let along: Vec<String> = (0..axes).map(axis).collect();
        let mut line = format!("{} = {}: axes {}", part(own), part(other), along.join(","));
        if let Some((_, angles, shift)) = movement {
            let turned = (0..3).find(|k| angles[*k] != 0.0);
            let _ = match turned {
                Some(k) => write!(
                    line,
                    ", periodic: turned by {} degrees about {}",
                    angles[k].to_degrees(),
                    ["x", "y", "z"][k]
                ),
                None => {
                    write!(line, ", periodic: moved by ({}, {}, {})", shift[0], shift[1], shift[2])
                }
            };
        }
        lines.push(line);
    }
    for joint in &connected.hanging {
        let [own, theirs] = joint.sides.map(|side| part(&side));
        let cells = |[m, n]: [usize; 2]| match flat {
            true => (m * n).to_string(),
            false => format!("{m} x {n}"),
        };
        let [a, b] = joint.cells.map(cells);
        lines.push(format!(
            "{own} ~ {theirs}: hanging, {a} and {b} cells, up to {:.3e} apart",
            joint.gap
        ));
    }
    for faces in &connected.abutting {
        let [own, theirs] = faces.parts.map(|side| part(&side));
        let [a, b] = faces.sizes.map(|[m, n]| format!("{m} x {n}"));
        lines.push(format!(
            "{own} | {theirs}: not joined, {a} and {b} points, up to {:.3e} apart",
            faces.gap
        ));
    }
    let is_side = |of: &FacePart| flat && of.1 > 3;
    for (of, name, kind) in &connected.boundaries {
        if is_side(of) || connected.is_hanging(of) {
            continue;
        }
        lines.push(match connected.nameless.contains(of) {
            true => format!("{}: without a name", part(of)),
            false => format!("{}: {name} {kind}", part(of)),
        });
    }
    lines.join("\n")
}
