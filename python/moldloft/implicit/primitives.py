"""Sets other than solid sides of fields: everything, nothing, boxes, tetrahedra, wires, points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from moldloft import _core
from moldloft.arguments import explain
from moldloft.implicit.moving import triple
from moldloft.implicit.sets import Set

if TYPE_CHECKING:
    Triple = Sequence[float]

__all__ = ["cuboid", "everything", "nothing", "point", "segment", "tetrahedron"]


def everything() -> Set:
    """All of space.

    Returns
    -------
    Set
        Neutral element of ``&``.
    """
    return Set(_core.Set.everything())


def nothing() -> Set:
    """The empty set.

    Returns
    -------
    Set
        Neutral element of ``|``.
    """
    return Set(_core.Set.nothing())


def cuboid(low: Triple, high: Triple) -> Set:
    """The box between two corners.

    Parameters
    ----------
    low
        The corner with the least coordinates, ``(3,)``.
    high
        The corner with the greatest coordinates, ``(3,)``.

    Returns
    -------
    Set
        A solid.
    """
    return Set(_core.Set.cuboid(triple(low, "low corner"), triple(high, "high corner")))


def segment(start: Triple, end: Triple) -> Set:
    """The straight line between two points, as a wire.

    Parameters
    ----------
    start
        Start, ``(3,)``.
    end
        End, ``(3,)``.

    Returns
    -------
    Set
        Without area or volume.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> facets = im.segment((0, 0, 0), (3, 4, 0)).facets(depth=4)
    >>> len(facets.wires), len(facets.triangles)
    (1, 0)
    """
    return Set(_core.Set.segment(triple(start, "start"), triple(end, "end")))


def point(at: Triple) -> Set:
    """One point.

    Parameters
    ----------
    at
        Position, ``(3,)``.

    Returns
    -------
    Set
        Without length, area or volume.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> im.point((1, 2, 3)).facets((0, 0, 0), (4, 4, 4), depth=4).points.round(12).tolist()
    [[1.0, 2.0, 3.0]]
    """
    return Set(_core.Set.point(triple(at, "point")))


def tetrahedron(a: Triple, b: Triple, c: Triple, d: Triple) -> Set:
    """The tetrahedron of four points, in any order.

    Parameters
    ----------
    a
        A corner, ``(3,)``.
    b
        A corner.
    c
        A corner.
    d
        A corner.

    Returns
    -------
    Set
        A solid.
    """
    return Set(_core.Set.tetrahedron([triple(p, "corner") for p in (a, b, c, d)]))


explain(globals())
