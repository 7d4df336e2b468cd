"""``blockMeshDict`` of OpenFOAM from volume blocks.

blockMesh joins whole faces of blocks and identifies an edge by its two vertices. So blocks are cut
where a part of a face meets another block, where two edges would run between the same vertices,
where a ring closes on itself, and where the corners alone are no block. Edges are ``polyLine``
through the vertices of the grid, graded cell by cell, so that blockMesh's points on them are the
grid's; inside faces and blocks it interpolates between the edges. More cuts (``every``) bring that
closer to the grid.

Format: OpenFOAM user guide, section 4.3 "Mesh generation with the blockMesh utility".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import Error

if TYPE_CHECKING:
    from moldloft.shapes.blocks import Blocks

__all__ = ["Hex", "cut", "encode", "write"]

Place: TypeAlias = tuple[int, int, int]


@dataclass(frozen=True)
class Hex:
    """A part of a block that becomes one block of blockMesh."""

    block: int
    """The block."""
    begin: Place
    end: Place
    """Its first and last vertex, (i, j, k)."""


def cut(blocks: Blocks, every: int = 0) -> list[Hex]:
    """The blocks divided into parts that blockMesh can join.

    Parameters
    ----------
    blocks
        The blocks.
    every
        Maximum number of cells between cuts; 0: only the cuts that blockMesh requires.
    """
    parts = blocks._core.block_mesh_parts(every)
    return [
        Hex(block, (begin[0], begin[1], begin[2]), (end[0], end[1], end[2]))
        for block, begin, end in parts
    ]


def write(blocks: Blocks, every: int = 0) -> bytes:
    """The dictionary.

    Faces of blocks without a neighbour are patches, named after their surfaces; those in a plane of
    symmetry of the model are ``symmetryPlane``. A surface's patch is a ``wall``.

    Parameters
    ----------
    blocks
        The blocks.
    every
        Maximum number of cells between cuts of the blocks, for a closer interpolation by blockMesh;
        0: only the required cuts.
    """
    if not np.isfinite(blocks.vertices).all():
        raise Error("cannot write blockMeshDict: a position is not a finite number")
    if not blocks.positive:
        worst = min(blocks.blocks, key=lambda b: b.scaled_jacobian)
        raise Error(
            f"cannot write blockMeshDict: `{worst.name}` has cells without positive volume\n"
            "help: exchange the two surfaces of a left-handed block"
        )
    kinds = {"symmetry": "symmetryPlane", "wall": "wall"}
    patches = [
        (
            (free.block, free.face, [*free.begin], [*free.end]),
            free.name,
            kinds.get(free.kind, "patch"),
        )
        for free in blocks.boundaries
    ]
    return blocks._core.block_mesh(patches, every)


def encode(blocks: Blocks, title: str = "") -> bytes:
    """The dictionary with the required cuts only; the format has no title.

    Parameters
    ----------
    blocks
        The hexahedra.
    title
        A title, for formats that have one.
    """
    return write(blocks)


explain(globals())
