//! Warnings and notes on facets that deviate from their set.

use crate::facet::Facets;
use moldloft_num::Vec3;
use moldloft_registry::{Flaw, Remark};

/// "in n of 900 cells of side 0.1, the first about (x, y, z)".
fn counted(places: &[Vec3], facets: &Facets) -> String {
    counted_of(places.len(), places, facets)
}

/// As [`counted`], for `n` cells with only some positions known.
fn counted_of(n: usize, places: &[Vec3], facets: &Facets) -> String {
    let p = places[0];
    let Facets { cells, step, .. } = facets;
    let first = if n == 1 { "about" } else { "the first about" };
    // Cells without surface are not among those that are counted.
    let of = if n <= *cells { format!("of {cells} ") } else { String::new() };
    format!("in {n} {of}cells of side {step:.3e}, {first} ({:.6}, {:.6}, {:.6})", p.x, p.y, p.z)
}

/// Positions at which facets deviate from the set's surface, or may deviate; all four kinds are
/// rare.
pub(crate) fn flaws(facets: &Facets) -> Vec<Flaw> {
    let centres = |boxes: &[moldloft_num::Box3]| boxes.iter().map(|b| b.centre()).collect();
    let open = facets.open_places().iter().map(|u| u.place.centre()).collect();
    let may_hold: f64 = facets.unresolved.iter().map(|u| u.volume).sum();
    let missed = facets.unresolved.iter().any(|u| u.missed);
    let lists: [(&'static str, Vec<Vec3>); 4] = [
        ("unresolved", open),
        ("undecided", centres(&facets.undecided)),
        ("blunt", centres(&facets.blunt)),
        ("touching", facets.touching()),
    ];
    let found = lists.into_iter().filter(|(_, places)| !places.is_empty());
    let flaw = |(name, places): (&'static str, Vec<Vec3>)| {
        let (id, message, advice) = match name {
            "undecided" => (
                "undecided-cells",
                format!("{}, triangles cut each other", counted(&places, facets)),
                "give smaller cells: a greater depth, or a finer accuracy",
            ),
            "unresolved" => (
                "unresolved-cells",
                format!(
                    "{} {}, up to {may_hold:.3e} of volume",
                    counted_of(facets.unresolved.len(), &places, facets),
                    match missed {
                        true => "a part or a gap thinner than the cell is missing",
                        false => "it is not proved that no part thinner than the cell is missing",
                    }
                ),
                "give smaller cells: a greater depth, or a finer accuracy",
            ),
            "blunt" => (
                "blunt-edges",
                format!(
                    "{}, an edge, corner or bend is cut off: it is thinner than the cell, or a corner of a curved profile",
                    counted(&places, facets)
                ),
                "give smaller cells (a greater depth, or a finer accuracy) if the edge matters",
            ),
            _ => (
                "touching-bodies",
                format!(
                    "bodies touch in {} point{}, the first at ({:.6}, {:.6}, {:.6}): each has vertices of \
                     its own there, so that all stay manifold",
                    places.len(),
                    if places.len() == 1 { "" } else { "s" },
                    places[0].x,
                    places[0].y,
                    places[0].z
                ),
                "let them overlap to join them, or move them apart",
            ),
        };
        Flaw { name, remark: Remark { id, message, advice }, places }
    };
    found.map(flaw).collect()
}
