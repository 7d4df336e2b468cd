"""Content of CAD files: faces with their loops, and curves."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from moldloft import _core
from moldloft.shapes.nurbs import Nurbs

__all__ = [
    "RESERVED",
    "Imported",
    "ImportedFace",
    "ImportedSide",
    "Placement",
    "align",
    "border",
    "is_whole",
    "part_seams",
    "together",
]


class ImportedSide(NamedTuple):
    """A side of a loop."""

    edge: int
    """Number of its edge; sides of the same number are one edge."""
    backwards: bool
    """True if the loop runs against the trace."""
    trace: Nurbs
    """The curve in the parameters (u, v, 0) of the surface."""
    tolerance: float
    """Maximum distance of the edge from its surfaces."""


@dataclass
class ImportedFace:
    """A face of a CAD file."""

    name: str
    """A name that objects of a model may have."""
    surface: Nurbs
    """Its surface."""
    loops: list[list[ImportedSide]]
    """Its loops, the outer one first."""
    natural: bool
    """True if its loops are the edges of the surface's parameters."""
    reversed: bool
    """True if its normal is opposite to that of its surface."""
    tags: tuple[str, ...] = ()
    """The products that it is in, from the outermost one, and its body."""
    colour: tuple[float, float, float] | None = None
    """sRGB, 0 to 1, of the face or of a shape that contains it."""
    cavity: bool = False
    """True if it bounds a cavity of a solid."""

    @property
    def sides(self) -> list[ImportedSide]:
        """The sides of all loops."""
        return [side for cycle in self.loops for side in cycle]

    def renumber(self, first: int) -> None:
        """Adds a number to those of its edges."""
        self.loops = [[s._replace(edge=s.edge + first) for s in cycle] for cycle in self.loops]

    def _data(self) -> tuple[object, ...]:
        """Data for the compiled part: both faces are within the tolerance of an edge."""
        loops = [
            [(s.edge, s.backwards, s.trace._data(), 2 * s.tolerance) for s in cycle]
            for cycle in self.loops
        ]
        return self.surface._data(), self.natural, loops


RESERVED = ("info", "origin", "x_axis", "y_axis", "z_axis", "at", "placed", "turned")
"""Names in the program of a component, which place it."""

Triple = tuple[float, float, float]


class Placement(NamedTuple):
    """A product that is placed in another one."""

    part: str
    """Name of the product."""
    name: str
    """Name of the placed product; unique in the one that it is placed in."""
    origin: Triple
    """Its origin."""
    x_axis: Triple
    """Direction of its x axis."""
    y_axis: Triple
    """Direction of its y axis."""


@dataclass
class Imported:
    """Content of a CAD file."""

    faces: list[ImportedFace] = field(default_factory=list)
    """Its faces."""
    curves: dict[str, Nurbs] = field(default_factory=dict)
    """Curves that bound no face."""
    metres: float = 1.0
    """The unit of length."""
    remarks: list[str] = field(default_factory=list)
    """Omitted or doubtful content."""
    parts: dict[str, Imported] = field(default_factory=dict)
    """The products of the file that are placed in more than one place, by name."""
    placed: list[Placement] = field(default_factory=list)
    """The products that are placed in it; their faces are not among its own."""
    reserved: tuple[str, ...] = ()
    """Names that none of its objects may have."""

    @property
    def count(self) -> int:
        """The number of faces, each of a product once."""
        return len(self.faces) + sum(part.count for part in self.parts.values())


def align(faces: list[ImportedFace]) -> None:
    """Gives the two sides along each shared edge the same parametrisation, if they are one curve.

    Parameters
    ----------
    faces
        The faces; paths of their sides are replaced.
    """
    natural, paths = _core.aligned_faces([face._data() for face in faces])
    for face, whole in zip(faces, natural, strict=True):
        face.natural = whole
    for f, c, k, path in paths:
        cycle = faces[f].loops[c]
        cycle[k] = cycle[k]._replace(trace=Nurbs._of(path))


def border(trace: Nurbs) -> str:
    """The edge of the parameter square along which a curve runs, such as ``u0``; may be empty.

    Parameters
    ----------
    trace
        The curve, in (u, v, 0).
    """
    for k, letter in enumerate("uv"):
        for end in (0, 1):
            if np.abs(trace.points[:, k] - end).max() < 1e-9:
                return f"{letter}{end}"
    return ""


def together(count: int, pairs: Iterable[tuple[int, int]]) -> list[int]:
    """The group of each of some things, by the number of one of its members.

    Parameters
    ----------
    count
        How many things there are.
    pairs
        Two that are of one group.
    """
    root = list(range(count))

    def first(k: int) -> int:
        while root[k] != k:
            root[k] = root[root[k]]
            k = root[k]
        return k

    for one, other in pairs:
        root[first(one)] = first(other)
    return [first(k) for k in range(count)]


_CLOSED = 1e-9
"""Distance of two borders, relative to the size of the surface, within which they are one line."""


def part_seams(face: ImportedFace) -> None:
    """Gives the two sides of a face along its seam the two borders of a closed surface.

    A curve in space does not say on which of them it is, so that both sides may have the same.

    Parameters
    ----------
    face
        The face; paths of its sides are replaced.
    """
    taken = {border(side.trace) for side in face.sides}
    first: dict[tuple[int, str], None] = {}
    net = face.surface.points
    size = float(np.ptp(net.reshape(-1, 3), axis=0).max())
    for cycle in face.loops:
        for k, side in enumerate(cycle):
            at = border(side.trace)
            if not at or (side.edge, at) not in first:
                first[side.edge, at] = None
                continue
            axis = "uv".index(at[0])
            other = f"{at[0]}{1 - int(at[1])}"
            ends = np.take(net, 0, axis=axis) - np.take(net, -1, axis=axis)
            if other in taken or np.abs(ends).max() > _CLOSED * size:
                continue
            points = side.trace.points.copy()
            points[:, axis] = 1.0 - points[:, axis].round()
            cycle[k] = side._replace(trace=replace(side.trace, points=points))


def is_whole(trace: Nurbs) -> bool:
    """True if a curve along an edge of the parameter square covers the whole edge.

    Parameters
    ----------
    trace
        The curve, in (u, v, 0).
    """
    return bool(abs(np.ptp(trace.points[[0, -1]], axis=0).max() - 1) < 1e-9)
