"""Offsets of sets, and rounds and chamfers of their edges."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from moldloft import _core
from moldloft._core import Set as Core
from moldloft.arguments import explain
from moldloft.implicit.fields import Field

if TYPE_CHECKING:
    from typing import Self

__all__ = ["Edged"]


class Edged:
    """Operations on edges; they return a new shape and leave this one unchanged."""

    _core: Core

    def __init__(self, of: Field | Core) -> None:
        raise NotImplementedError

    def offset(self, distance: float) -> Self:
        """The body grown by a distance, or shrunk by a negative one; opening edges stay sharp.

        Internal faces of the formula, such as those between parts in contact, are ignored.
        :func:`minkowski_sum` with a ball grows it with round edges.

        Parameters
        ----------
        distance
            By how much it grows; negative: shrinks.

        Returns
        -------
        Set
            A new one; empty where it shrinks by more than its thickness.

        Raises
        ------
        Error
            If a face is not on a plane, ball, cylinder, cone or torus: other surfaces have no
            distance in closed form. If the offset of an inner edge would protrude from the body.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> round(im.cuboid((0, 0, 0), (1, 1, 1)).offset(0.1).mass().volume, 9)
        1.728
        """
        return type(self)(_core.call_row("set_offset", [self._core, float(distance)]))

    def shell(self, thickness: float) -> Self:
        """A wall of given thickness inside the surface.

        Parameters
        ----------
        thickness
            Thickness of the wall, in model units.

        Returns
        -------
        Set
            A new set, solid where the original is thinner than twice the wall.

        Raises
        ------
        Error
            If the thickness is not above 0, or a primitive has no offset: see :meth:`offset`.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> ball.shell(0.1).member([(0.95, 0, 0), (0.5, 0, 0)]).tolist()
        [-1, 1]
        """
        return type(self)(_core.call_row("set_shell", [self._core, float(thickness)]))

    def chamfered(self, width: float, *, edges: Sequence[Sequence[str]] | None = None) -> Self:
        """The set with its convex edges chamfered, of setback ``width`` on both faces.

        Parameters
        ----------
        width
            Setback on both faces, in model units.
        edges
            Pairs of names of faces; by default all edges.

        Returns
        -------
        Set
            A new one; this stays as it is. A face that is smaller than the setback is gone.

        Raises
        ------
        Error
            If the width is not above 0, or no edge is between faces of these names.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> round(im.cuboid((0, 0, 0), (10, 6, 4)).chamfered(1).mass().volume, 6)
        206.0
        """
        return type(self)(self._core.rounded(float(width), None, _pairs(edges)))

    def rounded(
        self, width: float, *, lambda_: float = 2 / 3, edges: Sequence[Sequence[str]] | None = None
    ) -> Self:
        """The set with its convex edges rounded, of setback ``width`` on both faces.

        ``edges`` are pairs of the names of faces, by default all; ``lambda_`` shapes the round
        between 0 (a chamfer) and 1 (the edge), 2/3 is an arc between perpendicular planes.

        Parameters
        ----------
        width
            Setback on both faces, in model units.
        lambda_
            Shape of the blend, between 0 and 1.
        edges
            Pairs of names of faces; by default all edges.

        Returns
        -------
        Set
            A new one; this stays as it is. A face that is smaller than the setback is gone.

        Raises
        ------
        Error
            If the width is not above 0, or no edge is between faces of these names.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> round(im.cuboid((0, 0, 0), (10, 6, 4)).rounded(1).mass().volume) < 240
        True
        """
        return type(self)(self._core.rounded(float(width), float(lambda_), _pairs(edges)))

    def filleted(
        self,
        other: Self | Field,
        width: float,
        other_width: float | None = None,
        *,
        lambda_: float = 2 / 3,
        edges: Sequence[Sequence[str]] | None = None,
    ) -> Self:
        """The union with another set, with fillets of setback ``width`` where their faces meet.

        ``edges`` are pairs of the names of a face of this set and one of the other, by default all.
        The faces are planes, balls, cylinders, cones and tori.

        Parameters
        ----------
        other
            The set that is joined.
        width
            Setback on the other set, from this one's face, in model units; on both by default.
        other_width
            Setback on this set, from the other's face, where it differs.
        lambda_
            Shape of the blend, between 0 and 1.
        edges
            Pairs of a face of this set and one of the other; by default all.

        Returns
        -------
        Set
            A new one; both stay as they are.

        Raises
        ------
        Error
            If a width is not above 0, or no edge is between faces of these names.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> plate, post = im.cuboid((-2, -2, -1), (2, 2, 0)), im.cuboid((-1, -1, -1), (1, 1, 2))
        >>> round(plate.filleted(post, 0.5).mass(accuracy=1e-3).volume - 24, 2) > 0
        True
        """
        o = type(self)(other) if isinstance(other, Field) else other
        widths = [float(width), float(width if other_width is None else other_width)]
        return type(self)(self._core.filleted(o._core, widths, float(lambda_), _pairs(edges)))


def _pairs(edges: Sequence[Sequence[str]] | None) -> list[list[str]] | None:
    """Edges by the names of two faces each."""
    if edges is None:
        return None
    pairs = [[str(name) for name in edge] for edge in edges]
    for pair in pairs:
        if len(pair) != 2:
            raise ValueError(f"an edge is named by two faces, found {len(pair)}")
    return pairs


explain(globals())
