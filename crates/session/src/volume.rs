//! Grid planes and folded cells of volume blocks, of solids and of programs.

use crate::facts::number;
use crate::frame::ReplyFrame;
use moldloft_document::Document;
use moldloft_io::NamedGrid;
use moldloft_mesh::{BlockFace, Blocks, HexBlock};
use serde_json::{Value, json};

/// Maximum number of folded cells drawn; all are counted.
const MOST_FOLDED: usize = 5000;

/// The edges of a cell, by its corners.
const CELL_EDGES: [[usize; 2]; 12] = [
    [0, 1],
    [2, 3],
    [4, 5],
    [6, 7],
    [0, 2],
    [1, 3],
    [4, 6],
    [5, 7],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];

/// A grid plane of a block: the vertices with one index along one axis.
#[derive(Clone, Debug)]
pub struct GridPlane {
    /// The block.
    pub block: String,
    /// 0, 1 or 2.
    pub axis: usize,
    /// The index along it, from 0.
    pub index: usize,
}

/// Adds all blocks with counts and quality, the folded cells, and one grid plane.
///
/// # Errors
/// If the block or the index of the plane does not exist.
pub fn put(
    document: &mut Document,
    plane: Option<&GridPlane>,
    frame: &mut ReplyFrame,
) -> Result<(), String> {
    let solids = document.blocked().ok();
    let own = computed(document);
    let all = || solids.iter().map(|b| &b.blocks).chain(&own);
    let mut rows: Vec<Value> = Vec::new();
    let (mut folded, mut drawn): (Vec<f32>, usize) = (Vec::new(), 0);
    for blocks in all() {
        for (k, block) in blocks.blocks().iter().enumerate() {
            let quality = blocks.quality(k);
            rows.push(json!({
                "name": block.name,
                "divisions": block.divisions(),
                "cells": quality.cells,
                "volume": number(quality.volume),
                "folded": quality.folded,
                "worst": number(quality.worst.scaled_jacobian),
                "cell": quality.worst.cell,
                "at": quality.worst.at.map(number),
                "mean": number(quality.mean_scaled_jacobian),
                "aspect": number(quality.largest_aspect),
            }));
            if quality.folded == 0 {
                continue;
            }
            for place in block.cells() {
                let cell = blocks.cell(k, place);
                let (least, _) = cell.scaled_jacobian();
                // NaN counts as a folded cell, but cannot be drawn.
                if least > 0.0 || !cell.0.iter().all(|p| p.is_finite()) || drawn == MOST_FOLDED {
                    continue;
                }
                drawn += 1;
                let ends = CELL_EDGES.into_iter().flatten().map(|c| cell.0[c].to_array());
                folded.extend(ends.flatten().map(|x| x as f32));
            }
        }
    }
    frame.put("blocks", rows);
    let part = frame.floats("folded", &folded);
    frame.put("folded", part);
    let Some(GridPlane { block: name, axis, index }) = plane else { return Ok(()) };
    let found = all().find_map(|b| {
        let k = b.blocks().iter().position(|block| block.name == *name)?;
        Some((b, k))
    });
    let (blocks, k) = found.ok_or(format!("there is no block `{name}`"))?;
    let part = plane_parts(blocks, k, *axis, *index, frame)?;
    frame.put("plane", part);
    Ok(())
}

/// Panels of a plane, with separate corners and the minimum scaled Jacobian of the adjacent cells.
fn plane_parts(
    blocks: &Blocks,
    which: usize,
    axis: usize,
    index: usize,
    frame: &mut ReplyFrame,
) -> Result<Value, String> {
    let block = &blocks.blocks()[which];
    if axis > 2 || index >= block.size[axis] {
        return Err(format!("`{}` has no such plane", block.name));
    }
    let [p, q] = [[1, 2], [0, 2], [0, 1]][axis];
    let divisions = block.divisions();
    let (mut positions, mut values): (Vec<f32>, Vec<f32>) = (Vec::new(), Vec::new());
    let (mut triangles, mut edges): (Vec<u32>, Vec<u32>) = (Vec::new(), Vec::new());
    for (a, b) in (0..divisions[p]).flat_map(|a| (0..divisions[q]).map(move |b| (a, b))) {
        let place = |da: usize, db: usize, along: usize| {
            let mut at = [0; 3];
            (at[p], at[q], at[axis]) = (a + da, b + db, along);
            at
        };
        let cells = [index.checked_sub(1), Some(index).filter(|&k| k < divisions[axis])];
        let least = cells
            .into_iter()
            .flatten()
            .map(|k| blocks.cell(which, place(0, 0, k)).scaled_jacobian().0)
            .fold(1.0, f64::min);
        let first = (positions.len() / 3) as u32;
        for (da, db) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
            let at = blocks.positions()[block.at(place(da, db, index)) as usize];
            positions.extend(at.to_array().map(|x| x as f32));
            values.push(least as f32);
        }
        triangles.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
        edges.extend([0, 1, 1, 2, 2, 3, 3, 0].map(|k| first + k));
    }
    Ok(json!({
        "position": frame.floats("position", &positions),
        "value": frame.floats("value", &values),
        "triangle": frame.numbers("triangle", &triangles),
        "edge": frame.numbers("edge", &edges),
    }))
}

/// Blocks among the variables of a program, with those in records and lists.
fn computed(document: &Document) -> Vec<Blocks> {
    let made = |NamedGrid { name, grid }: NamedGrid| {
        let [ni, nj, nk] = grid.size;
        let places =
            (0..ni).flat_map(|i| (0..nj).flat_map(move |j| (0..nk).map(move |k| [i, j, k])));
        let block = HexBlock {
            name,
            size: grid.size,
            vertices: (0..grid.count() as u32).collect(),
            faces: std::array::from_fn(|_| BlockFace::default()),
        };
        // A single layer is not a block.
        Blocks::new(places.map(|place| grid.at(place)).collect(), vec![block]).ok()
    };
    document.grids().into_iter().filter_map(made).collect()
}
