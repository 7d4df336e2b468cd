//! Sets of mixed dimension as meshes: solids, sheets, wires and points.
//!
//! A sheet is |f| in a set. A point of f = 0 belongs to the set if the set contains it when this sheet is
//! taken for everything and the other sheets for nothing; it shows as a sheet unless the solid part (all
//! sheets taken for nothing) contains it already. So the sheet of f is the faces that f has on the solid
//! {f <= 0} & (that set - the solid part): its boundary, edges and vertices are found as those of any
//! solid. Likewise a wire is the edge between two sheets, and a point the corner of three.

use crate::facet::padded_bounds::padded_bounds;
use crate::facet::types::{LeafIncidence, TriangleView};
use crate::facet::wires::{FacetWire, wires_of};
use crate::facet::{FacetOptions, Facets, facet, facet_within};
use crate::{FieldError, Leaf, Primitive, Set};
use moldloft_mesh::{Mesh, PatchInfo, TopologyBuilder};
use moldloft_num::{Box3, Vec3};
use std::collections::HashMap;

/// A piece of surface without an inside.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Its triangles, with normals along the gradient of the primitive; open at its boundary.
    pub mesh: Mesh,
    /// Index of its leaf in [`Set::leaves`].
    pub leaf: usize,
    /// Leaves of its vertices.
    pub on: LeafIncidence,
    /// Index of its primitive among the leaves of `on`.
    pub own: usize,
}

/// A point where three sheets meet.
#[derive(Clone, Debug)]
pub struct TriplePoint {
    /// Position.
    pub point: Vec3,
    /// Indices of its three leaves.
    pub leaves: [usize; 3],
    /// Leaves of the point.
    pub on: LeafIncidence,
}

impl Sheet {
    /// Its triangles with their leaves and those of their corners.
    pub(crate) fn flat(&self) -> TriangleView<'_> {
        TriangleView {
            positions: self.mesh.positions(),
            faces: self.mesh.faces(),
            patches: vec![(self.own as u32, 0..self.mesh.faces().len())],
            leaves: &self.on.leaves,
            surfaces: &self.on.surfaces,
        }
    }
}

/// A set of solids, sheets, wires and points.
#[derive(Clone, Debug)]
pub struct Mixed {
    /// The solid part.
    pub solid: Facets,
    /// The sheets, in the order of their leaves.
    pub sheets: Vec<Sheet>,
    /// The wires, in the order of their leaves.
    pub wires: Vec<FacetWire>,
    /// The points where three sheets meet.
    pub points: Vec<TriplePoint>,
    /// The leaves of the set, to which the indices refer.
    pub leaves: Vec<Leaf>,
}

/// The set without its sheets, wires and points; the set itself if it has none.
pub fn solid_part(set: &Set) -> Set {
    match set.leaves().iter().any(|leaf| leaf.primitive.is_sheet()) {
        true => with_sheets(set, &[]),
        false => set.clone(),
    }
}

/// The set with its sheets replaced: those of `kept` by everything, others by nothing.
fn with_sheets(set: &Set, kept: &[&Primitive]) -> Set {
    set.replaced(&|p| {
        if !p.is_sheet() {
            return None;
        }
        // The complement of a sheet is everything but a surface: solid for all that has an inside.
        let negated = p.of_sheet().abs().same(&-p);
        if negated {
            return Some(Set::everything());
        }
        let chosen = kept.iter().any(|k| k.same(p));
        Some(if chosen { Set::everything() } else { Set::nothing() })
    })
}

/// The facets of a set that may hold sheets, wires and points besides solids, within a box.
///
/// # Errors
/// As [`facet`].
///
/// # Example
/// ```
/// use moldloft_field::{FacetOptions, Primitive, Resolution, Set, facet_mixed};
/// use moldloft_num::{Box3, Vec3};
///
/// let ball = Primitive::sphere(Vec3::zero(), 1.0)?;
/// let over = Box3 { low: Vec3::of(-2.0, -2.0, -2.0), high: Vec3::of(2.0, 2.0, 2.0) };
/// let options = FacetOptions::new(Resolution::Depth(5));
/// let shell = facet_mixed(&Set::new(&ball.abs()), &over, &options)?;
/// assert!(shell.solid.mesh.faces().is_empty());
/// assert_eq!(shell.sheets.len(), 1);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn facet_mixed(set: &Set, over: &Box3, options: &FacetOptions) -> Result<Mixed, FieldError> {
    let solid_set = with_sheets(set, &[]);
    let solid = facet(&solid_set, over, options)?;
    let leaves = set.leaves();
    let thin = thin_leaves(&leaves);
    let leaf = |k: usize| &leaves[k].primitive;
    let half = |k: usize| Set::new(leaf(k).of_sheet());

    let mut sheets = Vec::new();
    let mut covered: HashMap<usize, Set> = HashMap::new();
    for &k in &thin {
        let here = &with_sheets(set, &[leaf(k)]) - &solid_set;
        let Some((facets, info)) = behind(&here, &leaves[k], over, options)? else { continue };
        covered.insert(k, here);
        if let Some((mesh, on, own)) = patch_of(&facets, leaf(k).of_sheet(), info)? {
            sheets.push(Sheet { mesh, leaf: k, on, own });
        }
    }
    let mut wires = Vec::new();
    let mut points = Vec::new();
    for (i, &a) in thin.iter().enumerate() {
        for (j, &b) in thin.iter().enumerate().skip(i + 1) {
            let mut here = &with_sheets(set, &[leaf(a), leaf(b)]) - &solid_set;
            for k in [a, b] {
                if let Some(sheet) = covered.get(&k) {
                    here = &here - sheet;
                }
            }
            if !here.is_nothing() {
                let pair = [leaf(a).of_sheet(), leaf(b).of_sheet()];
                let wide = padded_bounds(over, &here, &pair);
                let facets = facet_within(&(half(a) & half(b) & here), &wide, over, options, None)?;
                wires.extend(wires_of(&facets, pair, [a, b]));
            }
            for &c in thin.iter().skip(j + 1) {
                let mut here = &with_sheets(set, &[leaf(a), leaf(b), leaf(c)]) - &solid_set;
                for pair in [[a, b], [b, c], [a, c]] {
                    here = &here - &with_sheets(set, &pair.map(leaf));
                }
                if !here.is_nothing() {
                    let three = [a, b, c].map(|k| leaf(k).of_sheet());
                    let wide = padded_bounds(over, &here, &three);
                    let here = &(half(a) & half(b) & half(c) & here);
                    let facets = facet_within(here, &wide, over, options, None)?;
                    for v in corners(&facets, three) {
                        let (point, on) =
                            (facets.mesh.positions()[v as usize], lying_on(&facets, &[v]));
                        points.push(TriplePoint { point, leaves: [a, b, c], on });
                    }
                }
            }
        }
    }
    Ok(Mixed { solid, sheets, wires, points, leaves })
}

/// The numbers of the leaves that are sheets.
fn thin_leaves(leaves: &[Leaf]) -> Vec<usize> {
    let plain = |p: &Primitive| p.is_sheet() && !p.of_sheet().abs().same(&-p);
    (0..leaves.len()).filter(|&k| plain(&leaves[k].primitive)).collect()
}

/// The facets of the solid {f <= 0} & `here`, and the attributes of the sheet of f.
fn behind(
    here: &Set,
    leaf: &Leaf,
    over: &Box3,
    options: &FacetOptions,
) -> Result<Option<(Facets, PatchInfo)>, FieldError> {
    if here.is_nothing() {
        return Ok(None);
    }
    let f = leaf.primitive.of_sheet();
    let wide = padded_bounds(over, here, &[f]);
    let facets = facet_within(&(Set::new(f) & here.clone()), &wide, over, options, None)?;
    let sheet = Leaf { primitive: f.clone(), attributes: leaf.attributes.clone() };
    Ok(Some((facets, crate::facet::info(&sheet))))
}

/// A solid with some faces that form a sheet.
#[derive(Clone, Debug)]
pub struct BehindSheet {
    /// The closed facets of the solid.
    pub facets: Facets,
    /// For each of its patches, true if it is the sheet.
    pub shown: Vec<bool>,
    /// Attributes of the sheet.
    pub info: PatchInfo,
}

/// For each sheet of a set, a solid whose faces on one surface are the sheet; its other faces
/// determine the border.
///
/// # Errors
/// As [`facet`].
pub fn behind_sheets(
    set: &Set,
    over: &Box3,
    options: &FacetOptions,
) -> Result<Vec<BehindSheet>, FieldError> {
    let solid_set = with_sheets(set, &[]);
    let leaves = set.leaves();
    let mut found = Vec::new();
    for k in thin_leaves(&leaves) {
        let f = leaves[k].primitive.of_sheet();
        let here = &with_sheets(set, &[&leaves[k].primitive]) - &solid_set;
        let Some((facets, info)) = behind(&here, &leaves[k], over, options)? else { continue };
        let own = number(&facets, f);
        let shown: Vec<bool> = facets.patch_leaves.iter().map(|&l| own == Some(l as u32)).collect();
        if shown.contains(&true) {
            found.push(BehindSheet { facets, shown, info });
        }
    }
    Ok(found)
}

/// Leaves of some vertices of facets.
fn lying_on(facets: &Facets, vertices: &[u32]) -> LeafIncidence {
    let surfaces = vertices.iter().map(|&v| facets.surfaces[v as usize].clone()).collect();
    LeafIncidence { leaves: facets.leaves.clone(), surfaces }
}

/// The number of a primitive among the leaves of facets.
pub(super) fn number(facets: &Facets, f: &Primitive) -> Option<u32> {
    facets.leaves.iter().position(|l| l.primitive.same(f)).map(|k| k as u32)
}

/// The faces of one primitive as a mesh of their own.
fn patch_of(
    facets: &Facets,
    f: &Primitive,
    info: PatchInfo,
) -> Result<Option<(Mesh, LeafIncidence, usize)>, FieldError> {
    let Some(leaf) = number(facets, f) else { return Ok(None) };
    let patch = facets.patch_leaves.iter().position(|&l| l == leaf as usize);
    let Some(patch) = patch.map(|k| &facets.mesh.patches()[k]) else { return Ok(None) };
    let mut numbers: HashMap<u32, u32> = HashMap::new();
    let mut positions = Vec::new();
    let mut used = Vec::new();
    let mut faces = Vec::with_capacity(patch.faces.len());
    for face in &facets.mesh.faces()[patch.faces.clone()] {
        faces.push(face.map(|v| {
            *numbers.entry(v).or_insert_with(|| {
                positions.push(facets.mesh.positions()[v as usize]);
                used.push(v);
                positions.len() as u32 - 1
            })
        }));
    }
    let count = faces.len() as f64;
    let broken = |_| FieldError::TooFine { boxes: count, limit: count };
    let mut builder = TopologyBuilder::new();
    builder.add_vertices(positions.len()).map_err(broken)?;
    builder.add_faces(info, faces).map_err(broken)?;
    let mesh = Mesh::new(builder.build().into(), positions).map_err(broken)?;
    Ok(Some((mesh, lying_on(facets, &used), leaf as usize)))
}

/// Vertices on three primitives.
fn corners(facets: &Facets, three: [&Primitive; 3]) -> Vec<u32> {
    let found = three.map(|f| number(facets, f));
    let [Some(a), Some(b), Some(c)] = found else { return Vec::new() };
    let on_all = |s: &[u32]| [a, b, c].iter().all(|k| s.contains(k));
    let vertices = facets.surfaces.iter().enumerate();
    let mut out: Vec<u32> = vertices.filter(|(_, s)| on_all(s)).map(|(v, _)| v as u32).collect();
    // Cells beside a corner may each have found it.
    let near = 1e-9 * facets.step;
    let at = |v: u32| facets.mesh.positions()[v as usize];
    let mut kept: Vec<u32> = Vec::new();
    out.retain(|&v| {
        let new = kept.iter().all(|&q| at(v).distance(at(q)) > near);
        if new {
            kept.push(v);
        }
        new
    });
    out
}
