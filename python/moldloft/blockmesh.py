"""``blockMeshDict`` of OpenFOAM from volume blocks.

blockMesh joins whole faces of blocks and identifies an edge by its two vertices. So blocks are cut
where a part of a face meets another block, where two edges would run between the same vertices,
and where a ring closes on itself. Edges are ``polyLine`` through the vertices of the grid, graded
cell by cell, so that blockMesh's points on them are the grid's; inside faces and blocks it
interpolates between the edges. More cuts (``every``) bring that closer to the grid.

Format: OpenFOAM user guide, section 4.3 "Mesh generation with the blockMesh utility".
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import Error

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.blocks import Blocks, Interface

__all__ = ["Hex", "cut", "encode", "write"]

Place: TypeAlias = tuple[int, int, int]

_CORNERS: tuple[Place, ...] = (
    (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1),
)  # fmt: skip
_EDGES = (
    ((0, 1), (3, 2), (7, 6), (4, 5)),
    ((0, 3), (1, 2), (5, 6), (4, 7)),
    ((0, 4), (1, 5), (2, 6), (3, 7)),
)
"""The four edges along each axis, in blockMesh's order."""
_FACES = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))
"""The corners of the faces u = 0 to w = 1, seen from outside."""


@dataclass(frozen=True)
class Hex:
    """A part of a block that becomes one block of blockMesh."""

    block: int
    """The block."""
    begin: Place
    end: Place
    """Its first and last vertex, (i, j, k)."""

    def corner(self, k: int) -> Place:
        """Corner 0 to 7 in OpenFOAM's order.

        Parameters
        ----------
        k
            0 to 7.
        """
        u, v, w = (
            self.end[axis] if high else self.begin[axis] for axis, high in enumerate(_CORNERS[k])
        )
        return u, v, w


Cuts: TypeAlias = list[tuple[set[int], set[int], set[int]]]


def cut(blocks: Blocks, every: int = 0) -> list[Hex]:
    """The blocks divided into parts that blockMesh can join.

    Parameters
    ----------
    blocks
        The blocks.
    every
        Maximum number of cells between cuts; 0: only the cuts that blockMesh requires.
    """
    cuts: Cuts = []
    for block in blocks.blocks:
        of = [{0, n, *(range(0, n, every) if every else ())} for n in block.divisions]
        cuts.append((of[0], of[1], of[2]))
    for joint in blocks.interfaces:
        for axis in range(3):
            cuts[joint.block][axis].update((joint.begin[axis], joint.end[axis]))
            cuts[joint.donor][axis].update((joint.donor_begin[axis], joint.donor_end[axis]))
    for free in blocks.boundaries:
        for axis in range(3):
            cuts[free.block][axis].update((free.begin[axis], free.end[axis]))
    while True:
        _spread(cuts, blocks.interfaces)
        parts = list(_parts(cuts))
        if not _separate(blocks, parts, cuts):
            return parts


def _spread(cuts: Cuts, interfaces: Sequence[Interface]) -> None:
    """Propagates cuts to joined blocks until there are no new ones."""
    changed = True
    while changed:
        changed = False
        for joint in interfaces:
            for axis, number in enumerate(joint.transform):
                if joint.begin[axis] == joint.end[axis]:
                    continue
                own = cuts[joint.block][axis]
                other = cuts[joint.donor][abs(number) - 1]
                start, there = joint.begin[axis], joint.donor_begin[abs(number) - 1]
                sign = 1 if number > 0 else -1
                count = joint.end[axis] - start
                for step in range(count + 1):
                    a, b = start + step, there + sign * step
                    if (a in own) != (b in other):
                        own.add(a)
                        other.add(b)
                        changed = True


def _parts(cuts: Cuts) -> Iterator[Hex]:
    for block, axes in enumerate(cuts):
        us, vs, ws = (list(pairwise(sorted(axis))) for axis in axes)
        for (i0, i1), (j0, j1), (k0, k1) in product(us, vs, ws):
            yield Hex(block, (i0, j0, k0), (i1, j1, k1))


def _line(indices: NDArray[np.uint32], part: Hex, axis: int, edge: int) -> NDArray[np.uint32]:
    """The vertices of an edge of a part."""
    a, b = (part.corner(k) for k in _EDGES[axis][edge])
    at: list[int | slice] = [slice(a[k], b[k] + 1) if k == axis else a[k] for k in range(3)]
    line: NDArray[np.uint32] = indices[tuple(at)]
    return line


def _separate(blocks: Blocks, parts: Sequence[Hex], cuts: Cuts) -> bool:
    """Cuts edges between vertices of another edge. True if any edge was cut."""
    known: dict[tuple[int, int], tuple[int, ...]] = {}
    new = False
    for part in parts:
        indices = blocks.blocks[part.block].indices
        for axis, edge in product(range(3), range(4)):
            line = tuple(_line(indices, part, axis, edge).tolist())
            if len(set(line)) == 1 or len(line) == 2:
                continue
            if line[0] > line[-1]:
                line = line[::-1]
            other = known.setdefault((line[0], line[-1]), line)
            if line[0] == line[-1] or other != line:
                middle = (part.begin[axis] + part.end[axis]) // 2
                if middle not in cuts[part.block][axis]:
                    cuts[part.block][axis].add(middle)
                    new = True
    return new


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
    points = blocks.vertices
    if not np.isfinite(points).all():
        raise Error("cannot write blockMeshDict: a position is not a finite number")
    if not blocks.positive:
        worst = min(blocks.blocks, key=lambda b: b.scaled_jacobian)
        raise Error(
            f"cannot write blockMeshDict: `{worst.name}` has cells without positive volume\n"
            "help: exchange the two surfaces of a left-handed block"
        )
    parts = cut(blocks, every)
    numbers: dict[int, int] = {}
    hexes: list[str] = []
    edges: dict[tuple[int, int], str] = {}
    for part in parts:
        block = blocks.blocks[part.block]
        corners = [
            numbers.setdefault(int(block.indices[part.corner(k)]), len(numbers)) for k in range(8)
        ]
        cells = " ".join(str(b - a) for a, b in zip(part.begin, part.end, strict=True))
        grading: list[str] = []
        for axis, edge in product(range(3), range(4)):
            line = _line(block.indices, part, axis, edge)
            lengths = np.linalg.norm(np.diff(points[line], axis=0), axis=1)
            grading.append(_graded(lengths))
            first, last = (corners[k] for k in _EDGES[axis][edge])
            if first != last and len(line) > 2 and (last, first) not in edges:
                inner = " ".join(_vector(points[v]) for v in line[1:-1])
                edges.setdefault((first, last), f"    polyLine {first} {last} ({inner})")
        hexes.append(
            f"    hex ({' '.join(map(str, corners))}) {_word(block.name)} ({cells})"
            f" edgeGrading ({' '.join(grading)})"
        )
    patches = _patches(blocks, parts, numbers)
    lines = [
        "FoamFile",
        "{",
        "    version 2.0;",
        "    format ascii;",
        "    class dictionary;",
        "    object blockMeshDict;",
        "}",
        "",
        "scale 1;",
        "",
        "vertices",
        "(",
        *(f"    {_vector(points[v])}" for v in numbers),
        ");",
        "",
        "blocks",
        "(",
        *hexes,
        ");",
        "",
        "edges",
        "(",
        *edges.values(),
        ");",
        "",
        "boundary",
        "(",
    ]
    for (name, kind), faces in patches.items():
        lines += [f"    {name}", "    {", f"        type {kind};", "        faces", "        ("]
        lines += [f"            ({' '.join(map(str, face))})" for face in faces]
        lines += ["        );", "    }"]
    lines += [");", "", "mergePatchPairs", "(", ");", ""]
    return "\n".join(lines).encode()


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


def _vector(point: NDArray[np.float64]) -> str:
    return "(" + " ".join(repr(float(x) + 0.0) for x in point) + ")"


def _word(name: str) -> str:
    """A word of OpenFOAM: no blanks, quotes, slashes, brackets or semicolons."""
    return "".join(c if c.isalnum() or c in "._-+" else "_" for c in name) or "unnamed"


def _graded(lengths: NDArray[np.float64]) -> str:
    """Gradings of an edge: one number if uniform, else the fraction of the length per cell."""
    total = float(lengths.sum())
    if total == 0.0 or np.ptp(lengths) <= 1e-13 * total:
        return "1"
    return "(" + " ".join(f"({float(x) / total!r} 1 1)" for x in lengths) + ")"


def _patches(
    blocks: Blocks, parts: Sequence[Hex], numbers: dict[int, int]
) -> dict[tuple[str, str], list[tuple[int, ...]]]:
    """The faces of each patch, by its name and kind."""
    faces: dict[tuple[str, str], list[tuple[int, ...]]] = defaultdict(list)
    by_block: dict[int, list[Hex]] = defaultdict(list)
    for part in parts:
        by_block[part.block].append(part)
    for free in blocks.boundaries:
        block = blocks.blocks[free.block]
        for part in by_block[free.block]:
            axis, high = divmod(free.face, 2)
            at = part.end[axis] if high else part.begin[axis]
            inside = all(
                free.begin[k] <= part.begin[k] and part.end[k] <= free.end[k]
                for k in range(3)
                if k != axis
            )
            if at != free.begin[axis] or not inside:
                continue
            corners = [numbers[int(block.indices[part.corner(k)])] for k in _FACES[free.face]]
            if len(set(corners)) < 3:
                continue
            kind = {"symmetry": "symmetryPlane", "wall": "wall"}.get(free.kind, "patch")
            faces[_word(free.name), kind].append(tuple(corners))
    return faces


explain(globals())
