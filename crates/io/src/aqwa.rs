//! The geometry decks of an AQWA input file (`.dat`): vertices and panels.
//!
//! Deck 1 has the vertices in fixed columns (structure 5-6, number 7-11, coordinates 21-50), deck 2
//! the panels: `QPPL DIFF` for quads, `TPPL DIFF` for triangles, their vertices in brackets, and
//! `SYMX` (y = 0 is a symmetry plane) and `SYMY` (x = 0 is) (Ansys, Aqwa Reference Manual, data
//! categories 1 and 2; the columns are those that BEMRosetta reads). Corners are counter-clockwise
//! seen from the water.
//!
//! Only the panels below z = 0 diffract, and AQWA accepts none that crosses it, so the mesh must
//! end there: see [`Mesh::immersed`]. Mass, environment and run (decks 3 and on) are added by the
//! user.

use crate::solver::{SolverPanels, corners, title};
use crate::text::put;
use crate::{Bits, PanelFileOptions, WriteError};
use moldloft_mesh::Mesh;

/// The most vertices of a structure, by the width of their column.
const MOST_NODES: usize = 97_999;

/// Width of the column of a coordinate.
const WIDTH: usize = 10;

/// The file of the mesh's skin; coordinates have seven or eight digits, the width of their column.
///
/// # Errors
/// [`WriteError::AboveWater`] for panels that reach above z = 0; more than 97 999 vertices (numbers
/// from 98 000 are those of centres of gravity); coordinates that ten characters cannot show;
/// positions that are not finite; a half that crosses its plane.
pub fn write(mesh: &Mesh, name: &str, options: PanelFileOptions) -> Result<Vec<u8>, WriteError> {
    let panels = SolverPanels::of(mesh, options)?;
    let count = panels.points.len();
    if count > MOST_NODES {
        return Err(WriteError::TooLarge { what: "vertices", count });
    }
    let mut faces = panels.faces.iter();
    for (patch, n) in &panels.patches {
        for face in faces.by_ref().take(*n) {
            let top = face.iter().map(|&v| panels.points[v as usize][2]).fold(f64::MIN, f64::max);
            // A height that the column shows as zero is in the water plane.
            if top > 1e-7 {
                return Err(WriteError::AboveWater { format: "AQWA", patch: patch.clone() });
            }
        }
    }
    let rule = "*".repeat(80);
    let ruler: String = (1..=8).map(|k| format!("*********{k}")).collect();
    let mut out = format!("{ruler}\n{rule}\n* geometry of {}: decks 1 and 2\n", title(name));
    let deck = |out: &mut String, k: u8| {
        let side = "*".repeat(35);
        put!(*out, "{rule}\n{side} DECK  {k} {}\n{rule}\n", "*".repeat(36));
    };
    deck(&mut out, 0);
    put!(out, "JOB AQWA  LINE\nTITLE               {}\n", first(&title(name), 60));
    out.push_str("OPTIONS GOON REST END\nRESTART  1  2\n");
    deck(&mut out, 1);
    out.push_str("          COOR\n      NOD5\n      STRC        1\n");
    for (k, p) in (1..).zip(&panels.points) {
        put!(out, "{:6}{k:5}         ", 1);
        for &x in p {
            let digits = fixed(x).ok_or(WriteError::TooWide { format: "AQWA", value: Bits::of(x) });
            out.push_str(&digits?);
        }
        out.push('\n');
    }
    out.push_str(" END\n");
    deck(&mut out, 2);
    put!(out, "          ELM1      {}\n", first(&title(name), 40));
    if options.mirror_x {
        out.push_str("      SYMY\n");
    }
    if options.mirror_y {
        out.push_str("      SYMX\n");
    }
    out.push_str("      ZLWL          (        0.)\n");
    for &face in &panels.faces {
        let (corners, n) = corners(face);
        put!(out, "{:6}{} DIFF{:5}(1)", 1, if n == 3 { "TPPL" } else { "QPPL" }, 15);
        for v in &corners[..n] {
            put!(out, "({v:5})");
        }
        out.push('\n');
    }
    put!(out, " END\n          FINI\n{rule}\n");
    Ok(out.into_bytes())
}

/// At most `n` characters of a text.
fn first(text: &str, n: usize) -> String {
    text.chars().take(n).collect()
}

/// A number in ten columns, the leftmost of them blank, with as many digits as fit.
fn fixed(x: f64) -> Option<String> {
    let x = x + 0.0;
    (0..=7).rev().map(|digits| format!("{x:.digits$}")).find(|s| s.len() < WIDTH).map(|s| {
        let s = if s.contains('.') { s } else { s + "." };
        // Rounded to nothing, -0.0000 would be read as a number below zero by some.
        let s = if s.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
            "0.".to_string()
        } else {
            s
        };
        format!("{s:>WIDTH$}")
    })
}
