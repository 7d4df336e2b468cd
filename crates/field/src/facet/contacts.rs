//! Bodies that only touch: each is made by itself, so that both stay manifold and neither needs fine cells for the
//! sake of the contact.

use super::{Facets, Memory, at_step};
use crate::measure::certified::{Effort, certified};
use crate::{FacetOptions, FieldError, Set};
use moldloft_budget::Budget;
use moldloft_mesh::{Mesh, TopologyBuilder};
use moldloft_num::{Box3, Vec3};
use std::sync::Arc;

/// A union of more sets than this is taken as one.
const MOST: usize = 24;
/// The cells by which it is proved that two sets share no volume.
const CELLS: usize = 3000;
/// Boxes about a contact in a point or a line are no larger than this part of the whole.
const SMALL: f64 = 1.0 / 4.0;
/// Two sets share no more than this part of the box where they only touch.
const SHARED: f64 = 1e-9;

/// The operands of a union of unions, each with the attributes that reach it.
fn operands(set: &Set) -> Option<Vec<Set>> {
    let mut out = Vec::new();
    let mut stack = vec![set.clone()];
    while let Some(set) = stack.pop() {
        if set.is_union() {
            let outer = set.attributes().cloned();
            for o in set.operands().iter().rev() {
                stack.push(match &outer {
                    Some(a) => o.within(a.clone()),
                    None => o.clone(),
                });
            }
        } else {
            out.push(set);
        }
        if out.len() + stack.len() > MOST {
            return None;
        }
    }
    (out.len() > 1).then_some(out)
}

/// A place of a contact in points or lines, given the boxes that may hold it. Bodies that share a face are one.
fn contact<T>(over: &Box3, open: &[(Box3, T)]) -> Option<Vec3> {
    let side = |b: &Box3| (0..3).map(|k| b.high[k] - b.low[k]).fold(0.0, f64::max);
    let boxes = || open.iter().map(|(place, _)| place);
    let all = boxes().copied().reduce(|a, b| a.union(b))?;
    let smallest = boxes().min_by(|a, b| side(a).total_cmp(&side(b)))?;
    let largest = boxes().map(side).fold(0.0, f64::max);
    // A face that is shared exactly shows no volume in large boxes either. Along a line the boxes are as many as its
    // length has sides; on a face their number is the square of that.
    let few = open.len() as f64 <= 64.0 + 8.0 * side(&all) / side(smallest);
    (largest <= SMALL * side(over) && few).then(|| smallest.centre())
}

/// Sets that share no volume, and the places where they touch; `None` when there is one only, or none touch.
pub(super) fn parted(
    set: &Set,
    over: &Box3,
    budget: &Budget,
) -> Result<Option<(Vec<Set>, Vec<Vec3>)>, FieldError> {
    let Some(parts) = operands(set) else { return Ok(None) };
    let size: f64 = (0..3).map(|k| over.high[k] - over.low[k]).product();
    let mut group: Vec<usize> = (0..parts.len()).collect();
    let mut contacts = Vec::new();
    for i in 0..parts.len() {
        for j in i + 1..parts.len() {
            if group[i] == group[j] {
                continue;
            }
            let both = &parts[i] & &parts[j];
            let shared = certified(&both, over, &Effort::of_cells(CELLS), budget)?;
            if shared.bracket.volume().high > SHARED * size {
                let (a, b) = (group[i].min(group[j]), group[i].max(group[j]));
                group.iter_mut().filter(|g| **g == b).for_each(|g| *g = a);
            } else if let Some(place) = contact(over, &shared.open) {
                contacts.push(place);
            }
        }
    }
    if contacts.is_empty() || group.iter().all(|g| *g == group[0]) {
        return Ok(None);
    }
    let mut sets = Vec::new();
    for g in 0..parts.len() {
        let mine = parts.iter().zip(&group).filter(|(_, own)| **own == g).map(|(p, _)| p.clone());
        sets.extend(mine.reduce(|a, b| a | b));
    }
    Ok(Some((sets, contacts)))
}

/// The facets of several sets that share no volume as those of one.
pub(super) fn together(
    sets: &[Set],
    contacts: &[Vec3],
    over: &Box3,
    step: f64,
    accuracy: f64,
    options: &FacetOptions,
) -> Result<Facets, FieldError> {
    let each = sets.iter().map(|s| at_step(s, over, step, accuracy, options, None));
    let parts: Vec<Facets> = each.collect::<Result<_, _>>()?;
    let own: usize = parts.iter().map(|p| p.own_leaves).sum();
    let mut leaves: Vec<_> =
        parts.iter().flat_map(|p| p.leaves[..p.own_leaves].iter().cloned()).collect();
    leaves.extend(parts.iter().flat_map(|p| p.leaves[p.own_leaves..].iter().cloned()));
    let (mut first_own, mut first_cap) = (0, own);
    let mut positions = Vec::new();
    let mut surfaces = Vec::new();
    let mut builder = TopologyBuilder::new();
    let mut patch_leaves = Vec::new();
    let count = parts.iter().map(|p| p.mesh.faces().len()).sum::<usize>() as f64;
    let broken = |_| FieldError::TooFine { boxes: count, limit: options.limit };
    for part in &parts {
        let number = |leaf: usize| match leaf < part.own_leaves {
            true => first_own + leaf,
            false => first_cap + leaf - part.own_leaves,
        };
        let start = positions.len() as u32;
        builder.add_vertices(part.mesh.positions().len()).map_err(broken)?;
        positions.extend_from_slice(part.mesh.positions());
        surfaces.extend(
            part.surfaces.iter().map(|on| on.iter().map(|l| number(*l as usize) as u32).collect()),
        );
        for (patch, leaf) in part.mesh.patches().iter().zip(&part.patch_leaves) {
            let faces = &part.mesh.faces()[patch.faces.clone()];
            let faces: Vec<[u32; 4]> = faces.iter().map(|f| f.map(|v| v + start)).collect();
            builder.add_faces(patch.info.clone(), faces).map_err(broken)?;
            patch_leaves.push(number(*leaf));
        }
        first_own += part.own_leaves;
        first_cap += part.leaves.len() - part.own_leaves;
    }
    let mesh = Mesh::new(builder.build().into(), positions).map_err(broken)?;
    let first = &parts[0];
    Ok(Facets {
        mesh,
        leaves,
        own_leaves: own,
        patch_leaves,
        surfaces,
        undecided: parts.iter().flat_map(|p| p.undecided.iter().copied()).collect(),
        blunt: parts.iter().flat_map(|p| p.blunt.iter().copied()).collect(),
        unresolved: parts.iter().flat_map(|p| p.unresolved.iter().copied()).collect(),
        contacts: contacts.to_vec(),
        about: first.about,
        cells: parts.iter().map(|p| p.cells).sum(),
        step,
        blocks: parts.iter().map(|p| p.blocks).sum(),
        computed: parts.iter().map(|p| p.computed).sum(),
        memory: Memory { grid: first.memory.grid.clone(), blocks: Arc::default() },
    })
}
