"""Smooth unions, intersections and differences: bodies with the edge between them rounded."""

from __future__ import annotations

from moldloft import _core
from moldloft.arguments import explain
from moldloft.implicit.fields import Field
from moldloft.implicit.sets import Set

__all__ = ["smooth_difference", "smooth_intersection", "smooth_union"]


def _function(of: Field | Set) -> _core.Field:
    """A field, or the function of a set: minima over unions and maxima over intersections."""
    return of._core.as_field() if isinstance(of, Set) else of._core


def smooth_union(a: Field | Set, b: Field | Set, width: float, blend: str = "quadratic") -> Field:
    """The union of two bodies with the edge between them filled.

    The blend is where both functions differ by less than ``width``; with distances this is a
    length. A set counts by its function: minima over unions, maxima over intersections.

    Parameters
    ----------
    a
        A body.
    b
        The other body.
    width
        The width of the blend.
    blend
        ``"quadratic"`` for common tangents with both bodies, ``"cubic"`` for common curvature,
        ``"circular"`` for an arc between planes at right angles.

    Returns
    -------
    Field
        Negative inside.

    Raises
    ------
    Error
        If the width is not above 0, or there is no such blend.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> ball = im.sphere((0, 0, 0), 1, distance=True)
    >>> blob = im.smooth_union(ball, ball.translated((1.8, 0, 0)), 0.5)
    >>> blob((0.9, 0.5, 0)) < 0
    True
    """
    return Field(_function(a).smooth(_function(b), float(width), str(blend)))


def smooth_intersection(
    a: Field | Set, b: Field | Set, width: float, blend: str = "quadratic"
) -> Field:
    """The intersection of two bodies with the edge between them rounded; see :func:`smooth_union`.

    Parameters
    ----------
    a
        A body.
    b
        The other body.
    width
        The width of the blend.
    blend
        ``"quadratic"``, ``"cubic"`` or ``"circular"``.

    Returns
    -------
    Field
        Negative inside.

    Raises
    ------
    Error
        See :func:`smooth_union`.
    """
    first, second = _function(a).unary("-"), _function(b).unary("-")
    return Field(first.smooth(second, float(width), str(blend)).unary("-"))


def smooth_difference(
    a: Field | Set, b: Field | Set, width: float, blend: str = "quadratic"
) -> Field:
    """One body without another, with the edge between them rounded; see :func:`smooth_union`.

    Parameters
    ----------
    a
        The body.
    b
        Body to subtract.
    width
        The width of the blend.
    blend
        ``"quadratic"``, ``"cubic"`` or ``"circular"``.

    Returns
    -------
    Field
        Negative inside.

    Raises
    ------
    Error
        See :func:`smooth_union`.
    """
    first = _function(a).unary("-")
    return Field(first.smooth(_function(b), float(width), str(blend)).unary("-"))


explain(globals())
