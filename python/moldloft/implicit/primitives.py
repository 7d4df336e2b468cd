"""Sets without volume: wires and points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from moldloft import _core
from moldloft.arguments import explain
from moldloft.implicit.moving import triple
from moldloft.implicit.sets import Set

if TYPE_CHECKING:
    Triple = Sequence[float]

__all__ = ["point", "segment"]


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


explain(globals())
