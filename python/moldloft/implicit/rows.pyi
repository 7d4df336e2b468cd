# Made by `make stubs` from the declarations in `crates/`; not edited by hand.
"""Functions of fields and sets, made from the rows of the language."""

from collections.abc import Sequence
from typing import TypeAlias

from moldloft.implicit.fields import Field
from moldloft.implicit.sets import Set

Triple: TypeAlias = Sequence[float]

__all__ = ['cone', 'convex_hull', 'cuboid', 'cyclide', 'cylinder', 'everything', 'fillet', 'liming', 'minkowski_sum', 'nothing', 'plane', 'remainder', 'rounded', 'setback', 'smooth_difference', 'smooth_intersection', 'smooth_union', 'sphere', 'tetrahedron', 'torus', 'transition', 'zhang']
def cone(
    point: Triple,
    direction: Triple,
    angle: float,
) -> Field:
    """The double cone with its apex at the start of a line.

    Parameters
    ----------
    point
        Start, ``(3,)``. A line along the axis, from the apex.
    direction
        Direction of the line, of any length, ``(3,)``.
    angle
        Full angle at the apex, below half a turn. At least 0.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(1, 0, 1); Line axis(a, b); field tip = cone(axis, 0.3);
    """
    ...
def convex_hull(
    *sets: Set | Field,
) -> Set:
    """The convex hull of sets: the smallest convex set that holds all of them.

    Its surface is of planes, balls, cylinders, cones and tori, and smooth where balls span it. The sets are unions of
    bounded polyhedra and balls; or of polyhedra, cylinders and cones of one axis direction; or of cylinders, cones, tori
    and balls about one axis.

    Parameters
    ----------
    *sets
        The sets.

    Returns
    -------
    Set

    Notes
    -----
    In the language::

        set pill = convex_hull({set(sphere({0, 0, 0}, 1)), set(sphere({3, 0, 0}, 1))}); assert abs(volume(pill) - 13/3*PI) < 1e-6;
    """
    ...
def cuboid(
    low: Triple,
    high: Triple,
) -> Set:
    """The box between two corners, of six half-spaces.

    Parameters
    ----------
    low
        Low corner.
    high
        High corner.

    Returns
    -------
    Set

    Notes
    -----
    In the language::

        set block = cuboid({0, 0, 0}, {2, 1, 1});
    """
    ...
def cyclide(
    point: Triple,
    direction: Triple,
    along: Triple,
    major: float,
    minor: float,
    change: float,
) -> Field:
    """The Dupin cyclide about a line, centred at its start: a ring whose tube is thinner on one side.

    Parameters
    ----------
    point
        Start, ``(3,)``. A line along the axis, from the centre.
    direction
        Direction of the line, of any length, ``(3,)``.
    along
        Direction of the thin side.
    major
        Radius of the ring. At least 0.
    minor
        Mean radius of the tube. At least 0.
    change
        Variation of the tube's radius, less than the major radius.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); field ring = cyclide(axis, {1, 0, 0}, 2, 0.5, 0.2);
    """
    ...
def cylinder(
    point: Triple,
    direction: Triple,
    radius: float,
    distance: int = ...,
) -> Field:
    """The infinite cylinder p^2 + q^2 - radius^2 about a line; with `distance = 1` the distance
    sqrt(p^2 + q^2) - radius.

    Parameters
    ----------
    point
        Start, ``(3,)``. A line along the axis.
    direction
        Direction of the line, of any length, ``(3,)``.
    radius
        Radius. At least 0.
    distance
        1 for the distance instead of the polynomial. 0 to 1, default 0.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(1, 0, 1); Line axis(a, b); field pipe = cylinder(axis, 0.6);
    """
    ...
def everything() -> Set:
    """All of space.

    Returns
    -------
    Set

    Notes
    -----
    In the language::

        set all = everything();
    """
    ...
def fillet(
    l1: Field | float,
    l2: Field | float,
    width: float,
    other: float | None = ...,
    lambda_: float = ...,
    low: Triple | None = ...,
    high: Triple | None = ...,
) -> Set:
    """The union of the solid sides of two fields with a fillet in their corner.

    For distance fields the widths are lengths. Over a box `low`, `high` the contact is
    proved, or the point at which it fails is reported.

    Parameters
    ----------
    l1
        A body.
    l2
        The other body.
    width
        Setback of the blend on both bodies. At least 0.
    other
        Setback on the first body, if different. At least 0.
    lambda_
        Shape between 0 (a chamfer) and 1 (the corner); 2/3 is a circular arc between
        perpendicular planes. Default 0.666667.
    low
        Low corner of a box over which the contact is checked.
    high
        High corner of the box.

    Returns
    -------
    Set

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field z = plane({0, 0, 1}, {0, 0, 0}); set corner = fillet(x, z, 0.2);
    """
    ...
def liming(
    l1: Field | float,
    l2: Field | float,
    l3: Field | float,
    l4: Field | float | None = ...,
    lambda_: float = ...,
    contact: int = ...,
    low: Triple | None = ...,
    high: Triple | None = ...,
) -> Field:
    """The surface through the four curves in which two bodies meet two others:
    lambda L1 L2 - (1 - lambda) L3 L4. With one rail, L4 = L3, it touches both bodies where the rail does.

    After Liming (1944). With a rail, `contact = n` gives contact G^n by lambda L1 L2 - (1 - lambda)
    |L3|^(n + 1). The rail must cut each body outside the other; over a box `low`, `high` this is
    proved, or the point at which it fails is reported.

    Parameters
    ----------
    l1
        A body.
    l2
        The other body.
    l3
        The rail, or the first of the two other bodies.
    l4
        The second of the two other bodies.
    lambda_
        Shape between 0 (near the rail) and 1 (near the bodies). Default 0.5.
    contact
        Order of contact on a rail. 1 to 100, default 1.
    low
        Low corner of a box over which the contact is checked.
    high
        High corner of the box.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field y = plane({0, 1, 0}, {0, 0, 0}); field b = liming(x, y, x + y - 1, lambda = 2/3);
    """
    ...
def minkowski_sum(
    a: Set | Field,
    b: Set | Field,
) -> Set:
    """The Minkowski sum of two sets: all sums of a point of one and a point of the other.

    With a ball it is the set grown by its radius, with round edges. Each set is a union of convex
    parts, as for `convex_hull`; a cylinder or prism may be added to another with the same axis, or
    to a ball.

    Parameters
    ----------
    a
        A set.
    b
        The other set.

    Returns
    -------
    Set

    Notes
    -----
    In the language::

        set soft = minkowski_sum(cuboid({0, 0, 0}, {3, 2, 1}), sphere({0, 0, 0}, 0.2)); assert abs(volume(soft) - (6 + 22*0.2 + 6*PI*0.04 + 4/3*PI*0.008)) < 1e-6;
    """
    ...
def nothing() -> Set:
    """The empty set: the start of a union in a loop.

    Returns
    -------
    Set

    Notes
    -----
    In the language::

        set balls = nothing(); for (i = 1:3) balls = balls | set(sphere({i, 0, 0}, 0.4));
    """
    ...
def plane(
    normal: Triple,
    point: Triple,
) -> Field:
    """The half-space behind a plane: the distance from it, positive on the side of the normal.

    Parameters
    ----------
    normal
        Its normal, from solid to air.
    point
        A point of the plane.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        field floor = plane({0, 0, -1}, {0, 0, 0});
    """
    ...
def remainder(
    x: Field | float,
    y: Field | float,
) -> Field:
    """The remainder x - y floor(x / y) of fields: x repeated with the period y.

    Parameters
    ----------
    x
        The dividend.
    y
        The divisor.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field teeth = remainder(x, 0.5);
    """
    ...
def rounded(
    l1: Field | float,
    l2: Field | float,
    width: float,
    other: float | None = ...,
    lambda_: float = ...,
    low: Triple | None = ...,
    high: Triple | None = ...,
) -> Set:
    """The intersection of the solid sides of two fields with their edge rounded.

    For distance fields the widths are lengths. Over a box `low`, `high` the contact is
    proved, or the point at which it fails is reported.

    Parameters
    ----------
    l1
        A body.
    l2
        The other body.
    width
        Setback of the blend on both bodies. At least 0.
    other
        Setback on the first body, if different. At least 0.
    lambda_
        Shape between 0 (a chamfer) and 1 (the corner); 2/3 is a circular arc between
        perpendicular planes. Default 0.666667.
    low
        Low corner of a box over which the contact is checked.
    high
        High corner of the box.

    Returns
    -------
    Set

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field z = plane({0, 0, 1}, {0, 0, 0}); set edge = rounded(x, z, 0.2);
    """
    ...
def setback(
    l1: Field | float,
    l2: Field | float,
    a: float,
    b: float | None = ...,
) -> Field:
    """The rail of prescribed setbacks, L1/a + L2/b - 1: it meets L1 = 0 where L2 = b and L2 = 0 where L1 = a.
    With distances the setbacks are lengths.

    Parameters
    ----------
    l1
        A body.
    l2
        The other body.
    a
        Setback on the second body, measured by the first. At least 0.
    b
        Setback on the first body, measured by the second; default: the same. At least 0.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field y = plane({0, 1, 0}, {0, 0, 0}); field rail = setback(x, y, 0.2, 0.3);
    """
    ...
def smooth_difference(
    a: Set | Field,
    b: Set | Field,
    width: float,
    blend: str = ...,
) -> Field:
    """The difference of two bodies with the edge between them rounded.

    The blend extends over the points where the functions differ by less than the width, a
    length for distances. A set is taken as its function. Quadratic blends have common
    tangents with both bodies, cubic ones common curvature, circular ones are arcs between
    planes at right angles.

    Parameters
    ----------
    a
        A body.
    b
        The other body.
    width
        The width of the blend. At least 0.
    blend
        Shape of the blend: "quadratic", "cubic" or "circular". Default quadratic.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        field bowl = smooth_difference(sphere({0, 0, 0}, 1, distance = 1), sphere({0, 0, 1}, 0.8, distance = 1), 0.2);
    """
    ...
def smooth_intersection(
    a: Set | Field,
    b: Set | Field,
    width: float,
    blend: str = ...,
) -> Field:
    """The intersection of two bodies with the edge between them rounded.

    The blend extends over the points where the functions differ by less than the width, a
    length for distances. A set is taken as its function. Quadratic blends have common
    tangents with both bodies, cubic ones common curvature, circular ones are arcs between
    planes at right angles.

    Parameters
    ----------
    a
        A body.
    b
        The other body.
    width
        The width of the blend. At least 0.
    blend
        Shape of the blend: "quadratic", "cubic" or "circular". Default quadratic.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        field lens = smooth_intersection(sphere({0, 0, 0}, 1, distance = 1), sphere({1, 0, 0}, 1, distance = 1), 0.2);
    """
    ...
def smooth_union(
    a: Set | Field,
    b: Set | Field,
    width: float,
    blend: str = ...,
) -> Field:
    """The union of two bodies with the edge between them filled smoothly.

    The blend extends over the points where the functions differ by less than the width, a
    length for distances. A set is taken as its function. Quadratic blends have common
    tangents with both bodies, cubic ones common curvature, circular ones are arcs between
    planes at right angles.

    Parameters
    ----------
    a
        A body.
    b
        The other body.
    width
        The width of the blend. At least 0.
    blend
        Shape of the blend: "quadratic", "cubic" or "circular". Default quadratic.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        field blob = smooth_union(sphere({0, 0, 0}, 1, distance = 1), sphere({1.5, 0, 0}, 1, distance = 1), 0.5);
    """
    ...
def sphere(
    centre: Triple,
    radius: float,
    distance: int = ...,
) -> Field:
    """The ball |X - centre|^2 - radius^2; with `distance = 1` the distance |X - centre| - radius.

    Parameters
    ----------
    centre
        Centre.
    radius
        Radius. At least 0.
    distance
        1 for the distance instead of the polynomial. 0 to 1, default 0.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        field ball = sphere({1, 0, 2}, 1.5);
    """
    ...
def tetrahedron(
    a: Triple,
    b: Triple,
    c: Triple,
    d: Triple,
) -> Set:
    """The tetrahedron of four points, in any order.

    Parameters
    ----------
    a
        A corner.
    b
        A corner.
    c
        A corner.
    d
        A corner.

    Returns
    -------
    Set

    Notes
    -----
    In the language::

        set t = tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    """
    ...
def torus(
    point: Triple,
    direction: Triple,
    major: float,
    minor: float,
) -> Field:
    """The torus about a line, centred at its start.

    Parameters
    ----------
    point
        Start, ``(3,)``. A line along the axis, from the centre.
    direction
        Direction of the line, of any length, ``(3,)``.
    major
        Radius of the circle of centres. At least 0.
    minor
        Radius of the tube. At least 0.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); field ring = torus(axis, 2, 0.5);
    """
    ...
def transition(
    l1: Field | float,
    l2: Field | float,
    l3: Field | float,
    l4: Field | float,
    lambda_: float = ...,
    contact: int = ...,
    low: Triple | None = ...,
    high: Triple | None = ...,
) -> Set:
    """One body up to its rail, the other up to its own, and Zhang's transition between them.

    The solid sides of the rails keep the bodies. See `zhang`.

    Parameters
    ----------
    l1
        The body that it begins on.
    l2
        The body that it ends on.
    l3
        The rail on the first body; the body is kept on its solid side.
    l4
        The rail on the second.
    lambda_
        Shape: which body it follows longer. Default 0.5.
    contact
        Order of contact. 1 to 100, default 1.
    low
        Low corner of a box over which the contact is checked.
    high
        High corner of the box.

    Returns
    -------
    Set

    Notes
    -----
    In the language::

        field a = sphere({0, 0, 0}, 1); field b = sphere({3, 0, 0}, 0.5); set neck = transition(a, b, plane({1, 0, 0}, {0.8, 0, 0}), plane({-1, 0, 0}, {2.7, 0, 0}));
    """
    ...
def zhang(
    l1: Field | float,
    l2: Field | float,
    l3: Field | float,
    l4: Field | float,
    lambda_: float = ...,
    contact: int = ...,
    low: Triple | None = ...,
    high: Triple | None = ...,
) -> Field:
    """The transition from one body, tangent to it at its rail, to another, tangent at its own rail: (1
    - lambda) L1 |L4|^(n + 1) + lambda L2 |L3|^(n + 1).

    After Zhang. The rails L3 (on L1) and L4 (on L2) must not meet; over a box `low`, `high` this is
    proved, or the point at which it fails is reported.

    Parameters
    ----------
    l1
        The body at the first rail.
    l2
        The body at the second rail.
    l3
        The rail on the first body.
    l4
        The rail on the second.
    lambda_
        Shape between 0 (longer along the first body) and 1 (longer along the second). Default
        0.5.
    contact
        Order of contact. 1 to 100, default 1.
    low
        Low corner of a box over which the contact is checked.
    high
        High corner of the box.

    Returns
    -------
    Field

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field a = sphere({0, 0, 0}, 1); field duct = zhang(a, sphere({0, 0, 0}, 2), x, 1 - x);
    """
    ...
