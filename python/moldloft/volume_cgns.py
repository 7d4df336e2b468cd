"""CGNS files of volume blocks: structured zones, one-to-one interfaces, named boundaries."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from moldloft import cgns
from moldloft.blocks import Boundary, Interface
from moldloft.errors import Error

if TYPE_CHECKING:
    from moldloft.blocks import Blocks

__all__ = ["write", "write_grids"]

_KINDS = {
    "symmetry": "BCSymmetryPlane",
    "wall": "BCWall",
    "farfield": "BCFarfield",
    "inflow": "BCInflow",
    "outflow": "BCOutflow",
}

Side = tuple[int, int, Sequence[int], Sequence[int]]
"""A part of a face: block, face from 0, first and last index (i, j, k) from 0."""


Movement = tuple[Sequence[float], Sequence[float], Sequence[float]]
"""Motion of a periodic joint: the centre and the angles of a rotation, in radians, and a
translation.
"""


@dataclass(frozen=True)
class _GridBlock:
    """A block of the language."""

    name: str
    points: NDArray[np.float64]

    @property
    def indices(self) -> NDArray[np.float64]:
        """An array of the block's shape."""
        return self.points[..., 0]


@dataclass(frozen=True)
class _GridBlocks:
    """Blocks of the language with their joints and boundaries, as :class:`Blocks` has them."""

    blocks: Sequence[_GridBlock]
    interfaces: Sequence[Interface]
    boundaries: Sequence[Boundary]
    movements: Sequence[Movement | None]
    unit_of_length: str = ""

    @property
    def vertices(self) -> NDArray[np.float64]:
        """All points."""
        return np.concatenate([block.points.reshape(-1, 3) for block in self.blocks])


def write_grids(
    title: str,
    names: Sequence[str],
    points: Sequence[NDArray[np.float64]],
    joints: Sequence[tuple[Side, Side, Sequence[int], Movement | None]],
    boundaries: Sequence[tuple[Side, str, str]],
) -> bytes:
    """The file of blocks of points ``(ni, nj, nk, 3)``.

    Parameters
    ----------
    title
        The name of the base.
    names
        Names of the zones.
    points
        The points of each block.
    joints
        Interfaces of blocks: (block, face, begin, end) of both sides, the transform of CGNS, and
        the motion from the second to the first if they are periodic.
    boundaries
        Boundaries: range, name and type.
    """

    def place(side: Side) -> tuple[int, int, tuple[int, int, int], tuple[int, int, int]]:
        block, face, begin, end = side
        return block, face, (begin[0], begin[1], begin[2]), (end[0], end[1], end[2])

    return write(
        _GridBlocks(
            [_GridBlock(name, grid) for name, grid in zip(names, points, strict=True)],
            [Interface(*place(a), *place(b), (t[0], t[1], t[2])) for a, b, t, _ in joints],
            [Boundary(*place(side), name, kind) for side, name, kind in boundaries],
            [movement for *_, movement in joints],
        ),
        title,
    )


def write(blocks: Blocks | _GridBlocks, title: str) -> bytes:
    """The file: a zone per block.

    Interfaces are written from both sides. Faces without a neighbour are boundaries of the family
    of their name: a wall for a surface object, a symmetry plane for faces in one.

    Parameters
    ----------
    blocks
        The blocks.
    title
        The name of the base.
    """
    try:
        import h5py  # type: ignore[import-untyped]
    except ImportError as error:
        raise Error("CGNS needs h5py\nhelp: pip install 'moldloft[grids]'") from error
    points = blocks.vertices
    if not np.isfinite(points).all():
        raise Error("cannot write cgns: a position is not a finite number")
    taken: set[str] = set()
    every: Sequence[Any] = blocks.blocks
    zones = [cgns.unique(block.name, taken) for block in every]
    families: dict[str, str] = {}
    for free in blocks.boundaries:
        if free.name not in families:
            families[free.name] = cgns.unique(free.name, taken)
    memory = io.BytesIO()
    with h5py.File(memory, "w", track_order=True) as file:
        base = cgns.begin(file, title, 3, blocks.unit_of_length)
        for free in blocks.boundaries:
            if families[free.name] in base:
                continue
            family = cgns.node(base, families[free.name], "Family_t")
            cgns.node(family, "FamilyBC", "FamilyBC_t", _KINDS.get(free.kind, "UserDefined"))
        for number, block in enumerate(every):
            size = np.array(block.indices.shape, dtype=np.int32)
            sizes = np.array([size, size - 1, 0 * size], dtype=np.int32)
            zone = cgns.node(base, zones[number], "Zone_t", sizes)
            cgns.node(zone, "ZoneType", "ZoneType_t", "Structured")
            grid = cgns.node(zone, "GridCoordinates", "GridCoordinates_t")
            for axis, letter in enumerate("XYZ"):
                # Fortran's order: i fastest, so the transpose of ours.
                values = np.ascontiguousarray(block.points[..., axis].T) + 0.0
                cgns.coordinate(grid, letter, values)
            _joints(zone, blocks, zones, number)
            _boundaries(zone, blocks, families, number)
    return memory.getvalue()


def _range(parent: Any, name: str, begin: Sequence[int], end: Sequence[int]) -> None:
    ends = np.array([begin, end], dtype=np.int32) + np.int32(1)
    cgns.node(parent, name, "IndexRange_t", ends)


def _rising(joint: Interface) -> tuple[list[int], list[int], list[int], list[int]]:
    """Both ranges of an interface, turned so that the block's own rises; the donor's follows it."""
    begin, end = list(joint.begin), list(joint.end)
    donor_begin, donor_end = list(joint.donor_begin), list(joint.donor_end)
    for axis, number in enumerate(joint.transform):
        if begin[axis] > end[axis]:
            other = abs(number) - 1
            begin[axis], end[axis] = end[axis], begin[axis]
            donor_begin[other], donor_end[other] = donor_end[other], donor_begin[other]
    return begin, end, donor_begin, donor_end


def _joints(zone: Any, blocks: Blocks | _GridBlocks, zones: Sequence[str], number: int) -> None:
    movements = (
        blocks.movements if isinstance(blocks, _GridBlocks) else [None] * len(blocks.interfaces)
    )
    every = list(zip(blocks.interfaces, movements, strict=True))
    seen = [(joint, movement, 1.0) for joint, movement in every if joint.block == number]
    seen += [
        (joint.reversed(), movement, -1.0) for joint, movement in every if joint.donor == number
    ]
    if not seen:
        return
    group = cgns.node(zone, "ZoneGridConnectivity", "ZoneGridConnectivity_t")
    for k, (joint, movement, sign) in enumerate(seen, 1):
        one = cgns.node(group, f"join{k}", "GridConnectivity1to1_t", zones[joint.donor])
        begin, end, donor_begin, donor_end = _rising(joint)
        _range(one, "PointRange", begin, end)
        _range(one, "PointRangeDonor", donor_begin, donor_end)
        transform = np.array(joint.transform, dtype=np.int32)
        cgns.node(one, "Transform", '"int[IndexDimension]"', transform)
        if movement:
            _periodic(one, movement, sign)


def _periodic(joint: Any, movement: Movement, sign: float) -> None:
    """Position of the donor relative to the zone's own side (SIDS 8.5)."""
    centre, angles, translation = movement
    group = cgns.node(joint, "GridConnectivityProperty", "GridConnectivityProperty_t")
    periodic = cgns.node(group, "Periodic", "Periodic_t")
    for name, values, factor in (
        ("RotationCenter", centre, 1.0),
        ("RotationAngle", angles, sign),
        ("Translation", translation, sign),
    ):
        numbers = np.array(values, dtype=np.float32) * np.float32(factor) + np.float32(0)
        cgns.node(periodic, name, "DataArray_t", numbers)


def _boundaries(
    zone: Any, blocks: Blocks | _GridBlocks, families: dict[str, str], number: int
) -> None:
    seen = [free for free in blocks.boundaries if free.block == number]
    if not seen:
        return
    group = cgns.node(zone, "ZoneBC", "ZoneBC_t")
    for k, free in enumerate(seen, 1):
        name = ("u0", "u1", "v0", "v1", "w0", "w1")[free.face]
        one = cgns.node(group, f"{name}_{k}", "BC_t", "FamilySpecified")
        _range(one, "PointRange", free.begin, free.end)
        cgns.node(one, "FamilyName", "FamilyName_t", families[free.name])
