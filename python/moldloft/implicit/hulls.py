"""Unions and intersections of many sets, convex hulls and Minkowski sums."""

from __future__ import annotations

from moldloft._core import Set as Core
from moldloft.arguments import explain
from moldloft.implicit.fields import Field
from moldloft.implicit.sets import Set

__all__ = ["convex_hull", "intersection", "minkowski_sum", "union"]


def _set(of: Set | Field) -> Core:
    return (of if isinstance(of, Set) else Set(of))._core


def union(*sets: Set | Field) -> Set:
    """The union of any number of sets, in a balanced tree: the quickest for thousands.

    Parameters
    ----------
    sets
        The sets; the union of no sets is empty.

    Returns
    -------
    Set
        The union.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> row = im.union(*(im.sphere((3 * k, 0, 0), 1) for k in range(5)))
    >>> row.facets(depth=5).bodies
    5
    """
    return Set(Core.union_of([_set(part) for part in sets]))


def intersection(*sets: Set | Field) -> Set:
    """The intersection of any number of sets, in a balanced tree.

    Parameters
    ----------
    sets
        The sets; the intersection of no sets is everything.

    Returns
    -------
    Set
        The intersection.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> x, y, z = im.axes()
    >>> corner = im.intersection(x, y, z, im.sphere((0, 0, 0), 1))
    >>> round(corner.mass().volume, 6)
    0.523599
    """
    return Set(Core.intersection_of([_set(part) for part in sets]))


def convex_hull(*sets: Set | Field) -> Set:
    """The smallest convex set that contains all of the sets.

    Its surface is of planes, balls, cylinders and cones, and smooth where balls span it (Boissonnat
    and Karavelas 2003).

    Parameters
    ----------
    sets
        Unions of bounded polyhedra and balls, or of cylinders and right prisms of one axis between
        the same two planes.

    Returns
    -------
    Set
        The hull.

    Raises
    ------
    Error
        If the sets are others, or the hull has no volume.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> pill = im.convex_hull(im.sphere((0, 0, 0), 1), im.sphere((3, 0, 0), 1))
    >>> round(pill.mass(depth=6).volume, 6)
    13.613568
    """
    return Set(Core.convex_hull([_set(part) for part in sets]))


def minkowski_sum(a: Set | Field, b: Set | Field) -> Set:
    """All sums of a point of one set and a point of the other.

    With a ball about the origin it is the set grown by its radius, with round edges.

    Parameters
    ----------
    a, b
        Unions of convex parts, as for :func:`convex_hull`; a cylinder or prism may be added to
        another of its axis, or to a ball.

    Returns
    -------
    Set
        The sum.

    Raises
    ------
    Error
        If no closed form of the sum is known.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> soft = im.minkowski_sum(im.cuboid((0, 0, 0), (3, 2, 1)), im.sphere((0, 0, 0), 0.2))
    >>> round(soft.mass(depth=6).volume, 5)
    11.18749
    """
    return Set(_set(a).minkowski_sum(_set(b)))


explain(globals())
