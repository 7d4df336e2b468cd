//! Neutral map files (.nmf): connections and boundaries of blocks (NASA Langley, GEOLAB, "The
//! Neutral Map File").

use std::fmt::Write;

/// A part of a face of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapFace {
    /// The block, from 0.
    pub block: usize,
    /// The face: i1, in, j1, jn, k1, kn from 0.
    pub face: usize,
    /// Node (i, j, k), from 0, of its first corner.
    pub from: [usize; 3],
    /// Node of its last corner; less than the first along an axis that runs backwards.
    pub to: [usize; 3],
}

/// An entry of a map.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MapEntry {
    /// Two faces with the same points; for each axis of the first block, the axis of the second, 0
    /// to 2.
    Joined([MapFace; 2], [usize; 3]),
    /// A boundary and its type.
    Boundary(MapFace, String),
}

/// The primary and the secondary axis of a face.
fn directions(face: usize) -> [usize; 2] {
    [[1, 2], [2, 0], [0, 1]][face / 2]
}

/// Number of a face in the format: kmin, kmax, imin, imax, jmin, jmax from 1.
fn number(face: usize) -> usize {
    [3, 4, 5, 6, 1, 2][face]
}

fn extent(of: &MapFace) -> String {
    let mut text = format!("{:5} {:3}", of.block + 1, number(of.face));
    for axis in directions(of.face) {
        let _ = write!(text, " {:6} {:6}", of.from[axis] + 1, of.to[axis] + 1);
    }
    text
}

/// The map of blocks of these sizes.
///
/// # Example
/// ```
/// use moldloft_io::neutral_map::{MapEntry, MapFace, neutral_map};
///
/// let floor = MapFace { block: 0, face: 4, from: [0, 0, 0], to: [4, 2, 0] };
/// let map = neutral_map(&[[5, 3, 2]], &[MapEntry::Boundary(floor, "wall".into())]);
/// let text = String::from_utf8(map).unwrap();
/// let last: Vec<&str> = text.lines().last().unwrap().split_whitespace().collect();
/// assert_eq!(last, ["'wall'", "1", "1", "1", "5", "1", "3"]);
/// ```
pub fn neutral_map(sizes: &[[usize; 3]], entries: &[MapEntry]) -> Vec<u8> {
    let rule = format!("# {}", "=".repeat(98));
    let mut out = format!("# Neutral map file\n{rule}\n# Block#   IDIM   JDIM   KDIM\n");
    let _ = writeln!(out, "# {}\n{:8}\n", "-".repeat(98), sizes.len());
    for (k, [ni, nj, nk]) in sizes.iter().enumerate() {
        let _ = writeln!(out, "{:8} {ni:6} {nj:6} {nk:6}", k + 1);
    }
    let _ = writeln!(out, "\n{rule}");
    out.push_str("# Type  B1 F1 S1 E1 S2 E2  B2 F2 S1 E1 S2 E2  Swap\n");
    let _ = writeln!(out, "# {}", "-".repeat(98));
    for entry in entries {
        let _ = match entry {
            MapEntry::Joined([a, b], axes) => {
                let swapped = axes[directions(a.face)[0]] != directions(b.face)[0];
                let swap = if swapped { "TRUE" } else { "FALSE" };
                writeln!(out, "{:24} {} {}  {swap}", "'one-to-one'", extent(a), extent(b))
            }
            MapEntry::Boundary(of, kind) => {
                writeln!(out, "{:24} {}", format!("'{kind}'"), extent(of))
            }
        };
    }
    out.into_bytes()
}
