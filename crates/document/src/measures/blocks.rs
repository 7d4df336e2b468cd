//! Volume meshes of documents.

use crate::Document;
use moldloft_diag::Diagnostic;
use moldloft_lang::source::env::Evaluation;
use moldloft_mesh::{Blocks, BlocksReport};
use moldloft_num::{Dual4, Vec3};
use moldloft_panel::Blocking;
use std::sync::Arc;

/// The blocks of a model with their positions.
#[derive(Debug)]
pub struct Blocked {
    /// The objects that compute each vertex.
    pub blocking: Blocking,
    /// The volume mesh.
    pub blocks: Blocks,
    /// Counts, volumes and quality.
    pub report: BlocksReport,
}

impl Blocked {
    /// Errors of the mesh: folded cells, and blocks that do not match at joins.
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let folded = self.report.blocks.iter().filter(|b| b.folded > 0).map(|b| {
            let ([i, j, k], [u, v, w], [x, y, z]) = (b.worst.cell, b.worst.parameters, b.worst.at);
            let inside_out = b.folded == b.cells;
            let message = format!(
                "{} of the {} cells of `{}` have a Jacobian that is not positive",
                b.folded, b.cells, b.name
            );
            let help = if inside_out {
                "all cells are: the solid is left-handed; reverse w, or swap u and v"
            } else {
                "move its faces apart where they cross, or divide it into several solids"
            };
            Diagnostic::warning("negative-jacobian", message)
                .expected("a positive Jacobian at all corners and Gauss points of each cell")
                .found(format!(
                    "{:.3e} (scaled {:.3}) in cell ({i}, {j}, {k}) at (u, v, w) = ({u:.3}, {v:.3}, \
                     {w:.3}), ({x:.6}, {y:.6}, {z:.6})",
                    b.worst.jacobian, b.worst.scaled_jacobian
                ))
                .help(help)
        });
        let joins =
            self.blocking.remarks().iter().map(|r| Diagnostic::warning(r.id(), r.to_string()));
        folded.chain(joins).collect()
    }
}

impl Document {
    /// The volume mesh of all shown solids, cached until the model changes.
    ///
    /// # Errors
    /// If there are no solids, divisions contradict each other, or the cells exceed the limit.
    pub fn blocked(&mut self) -> Result<Arc<Blocked>, Diagnostic> {
        // The blocks of an incomplete model look like those of a complete one.
        self.complete().map_err(|mut faults| faults.swap_remove(0))?;
        let clock = self.plain.graph.last_change();
        if let Some((at, blocked)) = &self.blocked
            && *at == clock
        {
            return Ok(blocked.clone());
        }
        let graph = &self.plain.graph;
        let blocking = Blocking::new(graph).map_err(|f| self.at_object(&f))?;
        if blocking.is_empty() {
            return Err(Diagnostic::error("no-blocks", "the model has no solids")
                .help("declare a solid, such as RuledSolid S(s1, s2)"));
        }
        let blocks = blocking
            .blocks(graph)
            .ok_or_else(|| Diagnostic::error("no-blocks", "the blocks have no positions"))?;
        let report = blocks.report();
        let blocked = Arc::new(Blocked { blocking, blocks, report });
        self.blocked = Some((clock, blocked.clone()));
        Ok(blocked)
    }

    /// Derivatives of all vertices of the volume mesh: `[by][vertex]`.
    ///
    /// # Errors
    /// Errors in a name or in the mesh.
    pub fn block_jacobian(&mut self, by: &[String]) -> Result<Vec<Vec<Vec3>>, Vec<Diagnostic>> {
        let mut columns = Vec::with_capacity(by.len());
        self.passes(by, |document, evaluation, count| {
            let positions = document.block_vertices_in_pass(evaluation)?;
            for k in 0..count {
                columns.push(positions.iter().map(|p| p.map(|x| x.eps[k])).collect());
            }
            Ok(())
        })?;
        Ok(columns)
    }

    /// The vertices of the volume mesh in a pass.
    pub(crate) fn block_vertices_in_pass(
        &mut self,
        evaluation: &Evaluation<Dual4>,
    ) -> Result<Vec<Vec3<Dual4>>, Vec<Diagnostic>> {
        let blocked = self.blocked().map_err(|d| vec![d])?;
        let positions = blocked.blocking.positions(&evaluation.graph);
        positions
            .ok_or_else(|| vec![Diagnostic::error("no-blocks", "the blocks have no positions")])
    }
}
