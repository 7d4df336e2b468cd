//! Facets: the boundary of a set as triangles with their primitives.
//!
//! `set & box -> division by ranges -> blocks of cells -> a vertex per piece of surface -> triangles`
//!
//! The box is divided where the range of the set contains zero; in every part, primitives that do
//! not decide are left out. A cell's vertex is on all the primitives of its piece of surface: one
//! puts it on a face, two on an edge, three on a corner. If these have no common point, several
//! edges or corners pass through the cell, and it has several vertices. Each crossed edge of the
//! grid gives a quadrilateral with the primitive that decides at the crossing, so faces of two
//! primitives meet in vertices on both.

mod assemble;
mod block;
mod cell;
mod contacts;
mod crossing;
mod cut_off;
mod divide;
mod flats;
mod grid;
mod lost;
pub(crate) mod memo;
mod padded_bounds;
mod place_vertices;
mod planes;
mod rebuild;
mod refine;
mod remove_intersections;
mod sharpen;
pub(crate) mod sheets;
pub(crate) mod shells;
mod simplify;
mod slivers;
mod split;
mod trace;
pub(crate) mod types;
mod unfold;
mod unresolved;
pub(crate) mod vertex;
pub(crate) mod wires;

use crate::error::solid_box;
use crate::expr::form::Form;
use crate::expr::tape::ExprTape;
use crate::set::{Compiled, Leaf, SetAttributes};
use crate::{FieldError, Set};
pub use crossing::crossing_faces;
use grid::Grid;
use moldloft_mesh::{Mesh, PatchInfo, TopologyBuilder};
use moldloft_num::{Box3, Vec3};
use refine::{RefinementRule, Tapes, refine};
use smallvec::SmallVec;
use std::sync::Arc;
use types::FacetBlock;
use types::Reuse;
pub use types::{FacetOptions, Resolution, Unresolved};

/// Memory of refinement for each triangle: a copy, the adjacent edges, the normals, and the new
/// triangles.
const REFINEMENT_BYTES: u64 = 400;

/// The boundary of a set within a box.
#[derive(Clone, Debug)]
pub struct Facets {
    /// The triangles: closed, manifold, oriented; one patch per visible primitive.
    pub mesh: Mesh,
    /// The leaves of the set, followed by the six faces of the box.
    pub leaves: Vec<Leaf>,
    /// Number of leaves of the set itself.
    pub own_leaves: usize,
    /// The leaf of each patch.
    pub patch_leaves: Vec<usize>,
    /// Leaves of each vertex.
    pub surfaces: Vec<SmallVec<[u32; 3]>>,
    /// Cells whose triangles intersect others, or may do so if facets were to be sharp. Elsewhere
    /// no two triangles intersect: by construction, or by test for cells with several vertices or
    /// one outside.
    pub undecided: Vec<Box3>,
    /// Cells with cut-off edges or corners: no vertex is within a hundredth of a cell of the edge
    /// or corner. Causes: a feature thinner than a cell, or vertices that would have made triangles
    /// intersect. Includes cells in which another primitive cuts off triangles by as much at their
    /// corners, midpoints or centres, and cells with folded triangles.
    pub blunt: Vec<Box3>,
    /// Cells, or parts of them, that may contain features that do not show at their corners.
    /// Elsewhere no feature is missed.
    pub unresolved: Vec<Unresolved>,
    /// Contacts of bodies without common volume, which were meshed separately.
    pub contacts: Vec<Vec3>,
    /// The point about which moments are taken: the middle of the box.
    pub(crate) about: Vec3,
    /// Number of cells that the surface passes through.
    pub cells: usize,
    /// Side of a cell; for a body of planes its shortest edge.
    pub step: f64,
    /// Number of blocks of 8 x 8 x 8 cells that contain the surface.
    pub blocks: usize,
    /// Number of blocks computed; the others were reused from earlier facets.
    pub computed: usize,
    memory: Memory,
}

/// The blocks of the last division, to be used again.
#[derive(Clone)]
struct Memory {
    grid: Grid,
    blocks: Arc<Vec<(Arc<ExprTape<f64>>, Arc<FacetBlock>)>>,
}

impl std::fmt::Debug for Memory {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{} blocks", self.blocks.len())
    }
}

/// The cosine of 20 degrees: normals at the ends of an edge differ by more only where cells are so coarse
/// that dividing it five times does not help.
const TURN: f64 = 0.939_692_620_785_908_4;

/// At this [`Resolution::HessePlane`] the thinnest side of a box has one cell.
const LEVEL_OF_SIDE: i32 = 5;

/// The names of the box's faces.
const CAPS: [&str; 6] = ["cap -x", "cap +x", "cap -y", "cap +y", "cap -z", "cap +z"];

/// The set within a box whose faces are named.
fn capped(set: &Set, over: &Box3) -> Result<Set, FieldError> {
    let mut caps = Set::cuboid(over.low, over.high)?.leaves().into_iter();
    let mut capped = set.clone();
    for name in CAPS {
        if let Some(leaf) = caps.next() {
            let attributes =
                SetAttributes { name: Some(name.to_owned()), ..SetAttributes::default() };
            capped = capped & Set::new(&leaf.primitive).with(attributes);
        }
    }
    Ok(capped)
}

/// The facets of `set` within the box `over`; faces of the box that cut the set are faces of the
/// mesh.
///
/// # Errors
/// A box without volume or thinner than its cells, a resolution beyond the limit, a primitive without value, a budget that is spent.
///
/// # Example
/// ```
/// use moldloft_field::{FacetOptions, Primitive, Resolution, Set, facet};
/// use moldloft_num::{Box3, Vec3};
///
/// let ball = Set::new(&Primitive::sphere(Vec3::zero(), 1.0)?);
/// let over = Box3 { low: Vec3::of(-1.5, -1.5, 0.0), high: Vec3::of(1.5, 1.5, 1.5) };
/// let facets = facet(&ball, &over, &FacetOptions::new(Resolution::Depth(4)))?;
/// assert!(facets.mesh.report().closed);
/// let names: Vec<&str> = facets.mesh.patches().iter().map(|p| p.info.name.as_str()).collect();
/// assert_eq!(names, ["sphere", "cap -z"]);
/// # Ok::<(), moldloft_field::FieldError>(())
/// ```
pub fn facet(set: &Set, over: &Box3, options: &FacetOptions) -> Result<Facets, FieldError> {
    refacet(set, over, options, None)
}

/// As `facet`, with unchanged blocks taken from `before`: the same result, bit for bit.
///
/// # Errors
/// As [`facet`].
pub fn refacet(
    set: &Set,
    over: &Box3,
    options: &FacetOptions,
    before: Option<&Facets>,
) -> Result<Facets, FieldError> {
    facet_within(set, over, over, options, before)
}

/// As [`refacet`], with cells of the size that they have in the box `sized`.
pub(crate) fn facet_within(
    set: &Set,
    over: &Box3,
    sized: &Box3,
    options: &FacetOptions,
    before: Option<&Facets>,
) -> Result<Facets, FieldError> {
    let (over, sized) = (solid_box(*over)?, solid_box(*sized)?);
    if let Some(facets) = planes::facets(set, &over, options)? {
        return Ok(facets);
    }
    let size = (0..3).map(|k| sized.high[k] - sized.low[k]).fold(0.0, f64::max);
    // A surface across the whole box passes through about this many cells.
    let crossed = |step: f64| (size / step).powi(2);
    let check = |step: f64| {
        let boxes = crossed(step);
        if boxes > options.limit {
            Err(FieldError::TooFine { boxes, limit: options.limit })
        } else {
            Ok(())
        }
    };
    let thin = |step: f64| {
        let (axis, side) = shortest(&over);
        let missed = side < step && !set.is_nothing();
        let depth = least_depth(size, &over);
        if missed { Err(FieldError::ThinBox { axis, side, step, depth }) } else { Ok(()) }
    };
    let step_of = |depth: u32| size / 2f64.powi(depth.min(1000) as i32);
    match options.resolution {
        Resolution::Level(level) => {
            let part = 2f64.powi(LEVEL_OF_SIDE - level.min(1000) as i32);
            let step = step_of(level).min(shortest(&over).1 * part.min(1.0));
            check(step)?;
            let facets = sharpest(set, &over, step, options, before)?;
            // Integrals treat thin features separately.
            if options.sharp {
                return Ok(facets);
            }
            let found = whole(set, &over, facets, USUAL_CELLS.min(options.limit), options)?;
            found.checked(size)
        }
        Resolution::Depth(depth) => {
            let step = step_of(depth);
            check(step)?;
            thin(step)?;
            let facets = sharpest(set, &over, step, options, before)?;
            // The resolution is as requested; bodies that only touch are separated nevertheless.
            if options.sharp {
                return Ok(facets);
            }
            Ok(whole(set, &over, facets, 0.0, options)?.facets)
        }
        Resolution::Accuracy(accuracy) => {
            crate::error::positive("accuracy", accuracy)?;
            let mut step = step_of(least_depth(size, &over).max(4));
            check(step)?;
            // First fine enough that nothing is missed.
            let most = MOST_CELLS.min(options.limit);
            let found = loop {
                let facets = at_step(set, &over, step, f64::INFINITY, options, before)?;
                let found = whole(set, &over, facets, most, options)?;
                let Some(u) = lost::lost(&found.facets, accuracy) else { break found };
                step = found.facets.step;
                let count = found.facets.cells + found.facets.unresolved.len();
                if !found.all || 4.0 * count as f64 > most {
                    let open = found.facets.unresolved.iter().filter(|u| u.missed);
                    let thickness = open.map(thickness).fold(thickness(&u), f64::max);
                    let depth = halvings(size, thickness.min(0.5 * step)) + 1;
                    return Err(FieldError::Thin { place: u.place, step, depth });
                }
                step *= 0.5;
            };
            let mut facets = found.facets.clone();
            step = facets.step;
            // The error is of second order, so one estimate nearly hits; a few correct it. The few triangles
            // that are worse than the others then are divided edge by edge.
            for _ in 0..8 {
                let mut all = facets.centre_distances();
                all.sort_by(f64::total_cmp);
                let (most, worst) = match &all[..] {
                    [] => break,
                    [.., worst] => (all[all.len() * 49 / 50], *worst),
                };
                if worst <= accuracy {
                    break;
                }
                if most <= accuracy {
                    facets = found.again(set, &over, (step, accuracy), options, Some(&facets))?;
                    if facets.worst_centre() <= accuracy {
                        break;
                    }
                }
                step *= (0.8 * accuracy / most).sqrt().clamp(1e-6, 0.8);
                let boxes = facets.cells as f64 * (facets.step / step).powi(2);
                if boxes > options.limit {
                    return Err(FieldError::TooFine { boxes, limit: options.limit });
                }
                facets = found.again(set, &over, (step, f64::INFINITY), options, before)?;
            }
            Ok(facets)
        }
    }
}

/// Default maximum number of cells spent on thin features, and the maximum with a given accuracy.
const USUAL_CELLS: f64 = 4e5;
const MOST_CELLS: f64 = 3e6;

/// Missed content, relative to the body, that is visible and justifies finer cells by default.
const MATTERS: f64 = 1e-5;

/// Minimum thickness of the content of a region, since it crosses the region along its diagonal.
fn thickness(u: &Unresolved) -> f64 {
    u.volume / (3f64.sqrt() * lost::side(&u.place).powi(2))
}

/// Facets that miss nothing, with the sets that they are made of where these only touch.
struct CompleteFacets {
    facets: Facets,
    /// False when more cells would have been needed than allowed.
    all: bool,
    parted: Option<contacts::Parted>,
}

impl CompleteFacets {
    fn again(
        &self,
        set: &Set,
        over: &Box3,
        (step, accuracy): (f64, f64),
        options: &FacetOptions,
        before: Option<&Facets>,
    ) -> Result<Facets, FieldError> {
        match &self.parted {
            Some(parted) => match contacts::together(set, parted, over, step, accuracy, options)? {
                Some(facets) => Ok(facets),
                None => at_step(set, over, step, accuracy, options, before),
            },
            None => at_step(set, over, step, accuracy, options, before),
        }
    }
}

/// Facets that miss more than this fraction of their body are an error.
const REFUSED: f64 = 1e-3;

impl CompleteFacets {
    /// The facets, or an error if the missing part changes the body.
    fn checked(self, size: f64) -> Result<Facets, FieldError> {
        let missed = || self.facets.unresolved.iter().filter(|u| u.missed);
        let volume: f64 = missed().map(|u| u.volume).sum();
        let body = moldloft_mesh::measure(&self.facets.mesh).volume.abs();
        let worst = missed().max_by(|a, b| a.volume.total_cmp(&b.volume));
        match worst {
            Some(u) if !self.all && volume > REFUSED * body => {
                let step = self.facets.step;
                let depth = halvings(size, thickness(u).min(0.5 * step)) + 1;
                Err(FieldError::Thin { place: u.place, step, depth })
            }
            _ => Ok(self.facets),
        }
    }
}

/// The facets with bodies that only touch apart, and with cells halved until nothing is missed.
fn whole(
    set: &Set,
    over: &Box3,
    facets: Facets,
    most: f64,
    options: &FacetOptions,
) -> Result<CompleteFacets, FieldError> {
    let mut found = CompleteFacets { facets, all: true, parted: None };
    if let Some(parted) = contacts::parted(set, over, &options.budget)? {
        let step = found.facets.step;
        let made = contacts::together(set, &parted, over, step, f64::INFINITY, options)?;
        if let Some(facets) = made {
            found.facets = facets;
            found.parted = Some(parted);
        }
    }
    loop {
        let missed = found.facets.unresolved.iter().filter(|u| u.missed);
        let (count, volume) = missed.fold((0, 0.0), |(n, v), u| (n + 1, v + u.volume));
        if count == 0 {
            return Ok(found);
        }
        let body = moldloft_mesh::measure(&found.facets.mesh).volume.abs();
        let matters = most > USUAL_CELLS || volume > MATTERS * body;
        // Halved cells of a surface are four times as many.
        if !matters || 4.0 * (found.facets.cells + count) as f64 > most {
            found.all = false;
            return Ok(found);
        }
        let step = 0.5 * found.facets.step;
        found.facets = found.again(set, over, (step, f64::INFINITY), options, None)?;
    }
}

/// The axis along which a box is thinnest, and its side.
fn shortest(over: &Box3) -> (usize, f64) {
    let side = |k: usize| over.high[k] - over.low[k];
    let axis = (1..3).fold(0, |a, k| if side(k) < side(a) { k } else { a });
    (axis, side(axis))
}

/// Minimum depth at which the cells of a box of that size are not thicker than one.
fn least_depth(size: f64, over: &Box3) -> u32 {
    halvings(size, shortest(over).1)
}

/// Number of halvings after which a length is at most `least`; at most 1000.
fn halvings(length: f64, least: f64) -> u32 {
    (0..1000).find(|&k| length <= least * 2f64.powi(k)).unwrap_or(1000) as u32
}

/// Number of leaves of a capped set that are the set's own. A face of the set in a face of the box
/// belongs to the set.
fn own_leaves(capped: &Compiled<f64>) -> usize {
    let own = capped.places.len().saturating_sub(CAPS.len());
    capped.places[..own].iter().map(|&l| l as usize + 1).max().unwrap_or(0)
}

/// Facets of more cells than this are not repeated with a shifted grid.
const FEW_CELLS: usize = 60_000;
/// Maximum number of cells of facets for integrals, whose finer levels follow.
const FEW_SHARP: usize = 12_000;

/// The facets with the fewest cut-off edges and cells whose triangles intersect others, among a few
/// positions of the grid.
fn sharpest(
    set: &Set,
    over: &Box3,
    step: f64,
    options: &FacetOptions,
    before: Option<&Facets>,
) -> Result<Facets, FieldError> {
    let mut best = at_step(set, over, step, f64::INFINITY, options, before)?;
    // For integrals, intersecting triangles do not matter.
    let cost = |f: &Facets| match options.sharp {
        true => f.blunt.len(),
        false => f.blunt.len() + f.undecided.len() + slivers::count(&f.mesh),
    };
    let few = if options.sharp { FEW_SHARP } else { FEW_CELLS };
    for place in 1..grid::PLACES {
        if cost(&best) == 0 || best.cells > few {
            break;
        }
        let grid = Grid::at(over, step, place)?;
        let other = on_grid(set, over, grid, f64::INFINITY, options, before)?;
        if cost(&other) < cost(&best) {
            best = other;
        }
    }
    Ok(best)
}

fn at_step(
    set: &Set,
    over: &Box3,
    step: f64,
    accuracy: f64,
    options: &FacetOptions,
    before: Option<&Facets>,
) -> Result<Facets, FieldError> {
    on_grid(set, over, Grid::new(over, step)?, accuracy, options, before)
}

fn on_grid(
    set: &Set,
    over: &Box3,
    grid: Grid,
    accuracy: f64,
    options: &FacetOptions,
    before: Option<&Facets>,
) -> Result<Facets, FieldError> {
    let step = grid.step;
    let compiled = capped(set, over)?.compiled_within_memory()?;
    let own_leaves = own_leaves(&compiled);
    let grid = grid.fitted(&compiled.tape, own_leaves, over);
    let reuse = before
        .filter(|b| b.memory.grid == grid)
        .map(|b| Reuse { blocks: b.memory.blocks.iter().map(|pair| (pair.1.at, pair)).collect() });
    let divided = divide::divide(&grid, &compiled.tape, &compiled.leaves, options, reuse.as_ref())?;
    let leaves = compiled.leaves;
    let mut made = remove_intersections::assembled(&grid, &leaves, &divided.blocks, options.sharp);
    let (shortest, slack) = (0.2 * step, cut_off::NEAR * step);
    let rule = RefinementRule { turn: TURN, accuracy, shortest, goal: grid.goal, slack };
    let tapes = Tapes::new(&grid, &divided.blocks, &compiled.tape);
    sharpen::sharpen(&mut made, &grid, &leaves, &tapes);
    options.budget.grow(made.triangles.len() as u64 * REFINEMENT_BYTES)?;
    let bends = refine(&mut made, &leaves, &tapes, rule, &options.budget)?;
    if !options.sharp {
        slivers::remove(&mut made);
    }
    let mut bends: Vec<[usize; 3]> = bends.into_iter().map(|p| grid.cell_of(p)).collect();
    let amiss = |made: &_| {
        let mut cells = cut_off::cut_off(made, &grid, &leaves, &tapes);
        // Not needed for integrals.
        if !options.sharp {
            cells.extend(cut_off::folded(made, &grid, &leaves, &tapes));
        }
        cells
    };
    shells::remove_flat(&mut made, step);
    let mut cut_off = amiss(&made);
    let own = made.blunt.iter().map(|b| b.1);
    let mut bad: Vec<[usize; 3]> = own.chain(cut_off.iter().chain(&bends).copied()).collect();
    // A surface with an edge of its own keeps it to itself.
    bad.retain(|c| !tapes.at(grid.cell(*c).centre()).creased_in(&grid.cell(*c)));
    if !bad.is_empty() {
        bad.sort_unstable();
        bad.dedup();
        let done = rebuild::rebuild(&mut made, &grid, &leaves, &tapes, &bad, &options.budget)?;
        if !done.is_empty() {
            made.blunt.retain(|b| done.binary_search(&b.1).is_err());
            let again = refine(&mut made, &leaves, &tapes, rule, &options.budget)?;
            bends = again.into_iter().map(|p| grid.cell_of(p)).collect();
            if !options.sharp {
                slivers::remove(&mut made);
            }
            shells::remove_flat(&mut made, step);
            cut_off = amiss(&made);
        }
    }
    if grid.joined && !options.sharp {
        flats::merge(&mut made, &leaves);
    }
    let open = divided.blocks.iter().flat_map(|b| b.1.unresolved.iter().copied()).collect();
    let unresolved = unresolved::not_shown(open, &made.positions, &made.triangles, step);

    let mut builder = TopologyBuilder::new();
    let broken =
        |_| FieldError::TooFine { boxes: made.triangles.len() as f64, limit: options.limit };
    builder.add_vertices(made.positions.len()).map_err(broken)?;
    let mut patch_leaves = Vec::new();
    let mut by_leaf: Vec<Vec<[u32; 4]>> = vec![Vec::new(); leaves.len()];
    for (leaf, [a, b, c]) in &made.triangles {
        by_leaf[*leaf as usize].push([*a, *b, *c, *c]);
    }
    for (leaf, faces) in by_leaf.into_iter().enumerate() {
        if !faces.is_empty() {
            patch_leaves.push(leaf);
            builder.add_faces(info(&leaves[leaf]), faces).map_err(broken)?;
        }
    }
    let mesh = Mesh::new(builder.build().into(), made.positions).map_err(broken)?;

    let undecided = match options.sharp {
        true => cells(&grid, made.doubtful.iter().map(|d| d.1).collect()),
        false => undecided(&grid, &mesh, &made.doubtful),
    };
    let blunt = made.blunt.into_iter().map(|b| b.1).chain(cut_off).chain(bends).collect();
    let blunt = cells(&grid, blunt);
    Ok(Facets {
        mesh,
        own_leaves,
        leaves,
        patch_leaves,
        surfaces: made.surfaces,
        undecided,
        blunt,
        unresolved,
        contacts: Vec::new(),
        about: over.centre(),
        cells: divided.blocks.iter().map(|(_, b)| b.active).sum(),
        step,
        blocks: divided.blocks.len(),
        computed: divided.computed,
        memory: Memory { grid, blocks: Arc::new(divided.blocks) },
    })
}

/// Cells of doubtful vertices with an intersecting triangle.
fn undecided(grid: &Grid, mesh: &Mesh, doubtful: &[(u32, [usize; 3])]) -> Vec<Box3> {
    let positions = mesh.positions();
    let faces = mesh.faces();
    let corners = |f: usize| [faces[f][0], faces[f][1], faces[f][2]];
    let mut bad = vec![false; positions.len()];
    for face in remove_intersections::crossing(positions, faces.len(), corners, doubtful)
        .into_iter()
        .flatten()
    {
        corners(face).into_iter().for_each(|v| bad[v as usize] = true);
    }
    cells(grid, doubtful.iter().filter(|(v, _)| bad[*v as usize]).map(|d| d.1).collect())
}

/// The boxes of some cells, each once.
fn cells(grid: &Grid, mut cells: Vec<[usize; 3]>) -> Vec<Box3> {
    cells.sort_unstable();
    cells.dedup();
    cells.into_iter().map(|c| grid.cell(c)).collect()
}

pub(crate) fn info(leaf: &Leaf) -> PatchInfo {
    let kind = leaf.primitive.form().name();
    let name = leaf.attributes.name.clone().unwrap_or_else(|| kind.to_owned());
    let tags = leaf.attributes.material.iter().cloned().collect();
    PatchInfo { tags, ..PatchInfo::new(name).coloured(leaf.attributes.colour).of_kind(kind) }
}

impl Facets {
    /// The unresolved regions with neighbours joined: at most 100, largest first.
    pub fn open_places(&self) -> Vec<Unresolved> {
        unresolved::gathered(&self.unresolved, self.step)
    }

    /// The form of a patch's primitive.
    pub fn form(&self, patch: usize) -> &Form<f64> {
        self.leaves[self.patch_leaves[patch]].primitive.form()
    }

    /// Distances of the triangles' centres from their surfaces, |f| / |f'|, in the order of faces.
    pub fn centre_distances(&self) -> Vec<f64> {
        let mut solver = vertex::Solver::default();
        let mut out = Vec::with_capacity(self.mesh.faces().len());
        for (patch, &leaf) in self.mesh.patches().iter().zip(&self.patch_leaves) {
            let tape = self.leaves[leaf].primitive.tape();
            for face in &self.mesh.faces()[patch.faces.clone()] {
                let [a, b, c] = [0, 1, 2].map(|k| self.mesh.positions()[face[k] as usize]);
                out.push(distance(&mut solver, tape, (a + b + c) / 3.0).abs());
            }
        }
        out
    }

    /// The largest of [`Facets::centre_distances`].
    pub fn worst_centre(&self) -> f64 {
        self.centre_distances().into_iter().fold(0.0, f64::max)
    }

    /// Largest distance |f| / |f'| of a vertex from its surfaces.
    pub fn worst_vertex(&self) -> f64 {
        let mut solver = vertex::Solver::default();
        let mut worst = 0.0f64;
        for (p, surfaces) in self.mesh.positions().iter().zip(&self.surfaces) {
            for &leaf in surfaces {
                let tape = self.leaves[leaf as usize].primitive.tape();
                worst = worst.max(distance(&mut solver, tape, *p).abs());
            }
        }
        worst
    }
}

/// The signed distance from a primitive's surface, to first order.
fn distance(solver: &mut vertex::Solver, tape: &ExprTape<f64>, p: Vec3) -> f64 {
    let g = solver.gradient(tape, p);
    if g.value == 0.0 { 0.0 } else { g.value / g.slope.norm() }
}
