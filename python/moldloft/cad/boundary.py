"""A model's boundary representation as data: faces, edges, loops and parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.shapes.nurbs import Nurbs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]

__all__ = ["Boundary", "Edge", "Face", "Part", "Side", "boundary"]


@dataclass(frozen=True)
class Edge:
    """An edge."""

    start: int
    """The vertex at 0."""
    end: int
    """The vertex at 1; the same for a closed edge."""
    curve: Nurbs
    """Its curve."""


@dataclass(frozen=True)
class Side:
    """A side of a loop."""

    edge: int
    """The edge."""
    forward: bool
    """True if the loop has the direction of the edge's curve."""
    trace: Nurbs | None
    """The curve in the parameters (u, v, 0) of the surface; None on planes."""
    alike: bool
    """True if the trace has the parametrisation of the edge."""


@dataclass(frozen=True)
class Face:
    """A face."""

    name: str
    """Its name."""
    colour: tuple[int, int, int] | None
    """sRGB, 0 to 255."""
    layers: tuple[str, ...]
    """Its tags."""
    reversed: bool
    """True if its normal is opposite to that of the surface."""
    error: float
    """A bound of the distance from the model's surface."""
    exact: bool
    """True if the deviation is rounding only."""
    plane: tuple[Floats, Floats, Floats] | None
    """For a plane: a point, the normal and a direction in it."""
    surface: Nurbs | None
    """For others: the NURBS."""
    loops: tuple[tuple[Side, ...], ...]
    """The loops, the outer one first."""

    @property
    def natural(self) -> bool:
        """True if the face covers the whole parameter range of its surface."""
        if self.surface is None:
            return False
        sides = [side for cycle in self.loops for side in cycle]
        traces = [s.trace for s in sides if s.trace is not None]
        edge = all(
            any(np.ptp(t.points[:, k]) == 0 and t.points[0, k] in (0.0, 1.0) for k in (0, 1))
            for t in traces
        )
        return edge and len(traces) == len(sides)


@dataclass(frozen=True)
class Part:
    """A named thing."""

    name: str
    """Its name."""
    shells: tuple[tuple[tuple[int, ...], bool], ...]
    """Its shells: their faces, and whether they close."""
    wires: tuple[tuple[str, tuple[int, int, int] | None, Nurbs], ...]
    """Curves that bound no face: name, colour, curve."""
    points: tuple[tuple[str, tuple[int, int, int] | None, tuple[float, float, float]], ...]
    """Isolated points: name, colour, position."""


@dataclass(frozen=True)
class Boundary:
    """Vertices, edges, faces and parts."""

    vertices: Floats
    """Positions, ``(n, 3)``."""
    edges: tuple[Edge, ...]
    """The edges; an edge common to two faces is single."""
    faces: tuple[Face, ...]
    """The faces."""
    parts: tuple[Part, ...]
    """The parts."""
    gap: float
    """A bound of the distances between edges, vertices and surfaces."""


def boundary(
    model: Model, *, accuracy: float | None = None, name: str = "model", facing: bool = False
) -> Boundary:
    """The shown surfaces of a model, with their images in its planes of symmetry, sewn.

    Parameters
    ----------
    model
        The model.
    accuracy
        The largest error of fits, by default 1e-6 of the model's diagonal.
    name
        The name of parts of many objects.
    facing
        True to reverse the surfaces of reversed faces, so that every normal is that of the surface.

    Examples
    --------
    >>> import moldloft
    >>> m = moldloft.loads('''
    ... Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 1}); RuledSurf s(a, b);
    ... ''')
    >>> b = boundary(m)
    >>> len(b.faces), len(b.edges), b.faces[0].surface
    (1, 4, <Nurbs: surface of degree 1, 1, 2 x 2 control points, exact>)
    """
    data = _core.brep(model._document, accuracy, name, facing)
    edges = tuple(Edge(a, b, Nurbs._of(curve)) for a, b, curve in data["edges"])
    parts = tuple(
        Part(
            part["name"],
            tuple((tuple(faces), closed) for faces, closed in part["shells"]),
            tuple((n, _rgb(colour), Nurbs._of(curve)) for n, colour, curve in part["wires"]),
            tuple((n, _rgb(colour), tuple(at)) for n, colour, at in part["points"]),
        )
        for part in data["parts"]
    )
    faces = tuple(_face(face) for face in data["faces"])
    return Boundary(data["vertices"], edges, faces, parts, float(data["gap"]))


def _rgb(colour: Any) -> tuple[int, int, int] | None:
    if colour is None:
        return None
    red, green, blue = colour
    return int(red), int(green), int(blue)


def _face(face: dict[str, Any]) -> Face:
    plane, surface = face["plane"], face["surface"]
    loops = tuple(
        tuple(
            Side(edge, forward, None if trace is None else Nurbs._of(trace), alike)
            for edge, forward, trace, alike in cycle
        )
        for cycle in face["loops"]
    )
    point, normal, axis = (np.array(v) for v in plane) if plane else (None, None, None)
    return Face(
        face["name"],
        _rgb(face["colour"]),
        tuple(face["layers"]),
        face["reversed"],
        face["error"],
        face["exact"],
        None if point is None or normal is None or axis is None else (point, normal, axis),
        None if surface is None else Nurbs._of(surface),
        loops,
    )
