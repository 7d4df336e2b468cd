//! Volume meshes of solids: blocks of hexahedra from their own parameters, joined by identity.
//!
//! Vertices of different blocks are identical if they are at the same position of the same surface
//! object, of the same root curve between the same ends, at the same point object, or on lines
//! along w of the same law between identical vertices. Divisions are solved through all blocks: a
//! number given for one block holds for every block that shares the edge, and so on.

mod divisions;
mod draft;
mod joiner;
mod marks;
mod notes;

use divisions::{BlockDivisions, DivisionClasses};
use draft::grid;
use draft::{BlockDraft, solid_of};
use joiner::BlockJoiner;
use moldloft_mesh::{BlockFace, Blocks, HexBlock};
use moldloft_model::Graph;
use moldloft_num::Vec3;
use moldloft_registry::{CallError, Scalar};
pub use notes::BlockNote;
use std::collections::HashMap;
use std::sync::Arc;

const MOST_CELLS: u64 = 20_000_000;

/// The vertices of volume blocks and the blocks that compute them; independent of the scalar.
#[derive(Clone, Debug)]
pub struct Blocking {
    plans: Vec<BlockPlan>,
    vertices: usize,
    remarks: Vec<BlockNote>,
}

#[derive(Clone, Debug)]
struct BlockPlan {
    name: Arc<str>,
    divisions: [usize; 3],
    /// Vertex of (i, j, k) at `[(i * (nv + 1) + j) * (nw + 1) + k]`.
    vertices: Vec<u32>,
    faces: [BlockFace; 6],
}

impl Blocking {
    /// The blocks of all shown solids that have a value.
    ///
    /// # Errors
    /// A [`CallError`] when divisions contradict each other or there would be too many cells.
    pub fn new(graph: &Graph<f64>) -> Result<Self, CallError> {
        let drafts: Vec<BlockDraft> = graph
            .objects()
            .filter(|o| o.head.shown())
            .filter_map(|object| {
                let solid = solid_of(object)?;
                Some(BlockDraft { object, solid, faces: solid.faces() })
            })
            .collect();
        // Adjacency is determined on undivided blocks first; the divisions follow from it.
        let rough = vec![[1; 3]; drafts.len()];
        let mut joiner = BlockJoiner::new(&drafts, &rough);
        joiner.join_all();
        let BlockDivisions { divisions, mut remarks } =
            DivisionClasses::of(&mut joiner).solved(&drafts)?;
        let cells = divisions.iter().map(|d| d.iter().map(|&n| n as u64).product::<u64>());
        let cells = cells.fold(0u64, u64::saturating_add);
        if cells > MOST_CELLS {
            return Err(CallError::new("too-many-cells", format!("{cells} cells are too many"))
                .expected(format!("at most {MOST_CELLS}"))
                .found(cells.to_string())
                .help("lower the divisions of the solids"));
        }
        let mut joiner = BlockJoiner::new(&drafts, &divisions);
        joiner.join_all();
        remarks.extend(joiner.apart());
        let mut number: HashMap<u32, u32> = HashMap::new();
        let mut plans = Vec::with_capacity(drafts.len());
        for (b, draft) in drafts.iter().enumerate() {
            let [nu, nv, nw] = divisions[b];
            let count = ((nu + 1) * (nv + 1) * (nw + 1)) as u32;
            let vertices = (joiner.first[b]..joiner.first[b] + count).map(|v| {
                let next = number.len() as u32;
                *number.entry(joiner.joined.find(v)).or_insert(next)
            });
            plans.push(BlockPlan {
                name: draft.object.name.clone(),
                divisions: divisions[b],
                vertices: vertices.collect(),
                faces: draft.face_names(graph),
            });
        }
        Ok(Self { plans, vertices: number.len(), remarks })
    }

    /// Notes about the joins.
    pub fn remarks(&self) -> &[BlockNote] {
        &self.remarks
    }

    /// True when there are no solids.
    pub fn is_empty(&self) -> bool {
        self.plans.is_empty()
    }

    /// The positions of all vertices, evaluated with the scalar of `graph`; `None` when a solid has
    /// no value in that graph.
    pub fn positions<T: Scalar>(&self, graph: &Graph<T>) -> Option<Vec<Vec3<T>>> {
        let mut positions = vec![Vec3::zero(); self.vertices];
        // Backwards, so that the first block has the last word.
        for plan in self.plans.iter().rev() {
            let solid = solid_of(graph.get(graph.find(&plan.name)?)?)?;
            for (&vertex, p) in plan.vertices.iter().zip(grid(solid, plan.divisions)) {
                positions[vertex as usize] = p;
            }
        }
        Some(positions)
    }

    /// The volume mesh, evaluated with the scalar of `graph`.
    pub fn blocks<T: Scalar>(&self, graph: &Graph<T>) -> Option<Blocks<T>> {
        let blocks = self.plans.iter().map(|plan| HexBlock {
            name: plan.name.to_string(),
            size: plan.divisions.map(|n| n + 1),
            vertices: plan.vertices.clone(),
            faces: plan.faces.clone(),
        });
        Blocks::new(self.positions(graph)?, blocks.collect()).ok()
    }
}
