"""Content of CAD files: faces with their loops, and curves."""

from __future__ import annotations

from dataclasses import dataclass, field
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


def is_whole(trace: Nurbs) -> bool:
    """True if a curve along an edge of the parameter square covers the whole edge.

    Parameters
    ----------
    trace
        The curve, in (u, v, 0).
    """
    return bool(abs(np.ptp(trace.points[[0, -1]], axis=0).max() - 1) < 1e-9)
