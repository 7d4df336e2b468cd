# Made by `make stubs` from the declarations in `crates/`; not edited by hand.
"""Functions of the language, for models that are written in Python."""

from collections.abc import Sequence
from typing import Any, TypeAlias

from numpy.typing import NDArray

from moldloft.expressions import (
    AnyHandle,
    AnyShape,
    BeadHandle,
    BodyHandle,
    ContoursHandle,
    CurveHandle,
    Expr,
    FieldShape,
    FrameHandle,
    MagnetHandle,
    PlaneHandle,
    PointHandle,
    RelabelHandle,
    RingHandle,
    SetShape,
    SnakeHandle,
    SolidHandle,
    SurfaceHandle,
)

_Any: TypeAlias = AnyHandle | AnyShape
_Number: TypeAlias = float | Expr | _Any
_Integer: TypeAlias = int | Expr | _Any
_Text: TypeAlias = str | _Any
_Array: TypeAlias = NDArray[Any]
_Vector: TypeAlias = PointHandle | Sequence[float | Expr] | _Array | _Any
_Numbers: TypeAlias = Sequence[float | Expr] | _Array | _Any
_Item: TypeAlias = PointHandle | Sequence[float | Expr] | _Array
_Vectors: TypeAlias = Sequence[_Item | Sequence[_Item]] | _Array | _Any
_Point: TypeAlias = _Vector
_Bead: TypeAlias = BeadHandle | _Any
_Magnet: TypeAlias = MagnetHandle | _Any
_Ring: TypeAlias = RingHandle | _Any
_Curve: TypeAlias = CurveHandle | _Any
_Snake: TypeAlias = SnakeHandle | _Any
_Surface: TypeAlias = SurfaceHandle | _Any
_Solid: TypeAlias = SolidHandle | _Any
_Plane: TypeAlias = PlaneHandle | str | _Any
_Mirror: TypeAlias = _Plane | _Point | CurveHandle
_Side: TypeAlias = SnakeHandle | MagnetHandle | _Any
_Along: TypeAlias = CurveHandle | BeadHandle | _Any
_AlongSnake: TypeAlias = SnakeHandle | RingHandle | _Any
_Onto: TypeAlias = SurfaceHandle | MagnetHandle | _Any
_Target: TypeAlias = _Plane | SurfaceHandle | CurveHandle | _Point | FieldShape
_Frame: TypeAlias = FrameHandle | _Point
_Contours: TypeAlias = ContoursHandle | _Any
_Relabel: TypeAlias = RelabelHandle | _Any
_Field: TypeAlias = FieldShape | PlaneHandle | float | Expr | _Any
_Set: TypeAlias = SetShape | FieldShape | PlaneHandle | _Any
_Body: TypeAlias = BodyHandle | _Any

def fair(
    points: _Vectors,
    tolerance: _Number,
    measure: _Text | None = ...,
    mode: _Text | None = ...,
    closed: _Integer | None = ...,
) -> AnyShape:
    """Faired points, each within a tolerance of the original.

    The points are faired as control points of a uniform cubic; on uniform points this is the same
    as fairing the interpolated points, because interpolation and fourth differences commute. Open
    rows keep their first and last two points. Points on a line, conic, plane cubic or helix do not
    move.

    Parameters
    ----------
    points : list of vector
        Points, at least 5 (closed: 8).
    tolerance : number
        Largest move of each point, in units of length; 0: unchanged. At least 0.
    measure : text, optional
        Measure to minimise; see `FairCurve`. Default second.
    mode : text, optional
        "optimum" or "faithful"; see `FairCurve`. Default optimum.
    closed : integer, optional
        1: closed row; the first point is not repeated. 0 to 1, default 0.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        Line l({0, 0, 0}, {1, 0, 0}); curve p = distc(l, uniform(0, 1, 9)); curve q = fair(p, 0.01);
    """
    ...
def jumps(
    points: _Vectors,
    closed: _Integer | None = ...,
) -> AnyShape:
    """Jumps of the third derivative of the uniform cubic with given control points, a measure of
    unfairness: `|d[i-2] - 4 d[i-1] + 6 d[i] - 4 d[i+1] + d[i+2]|` at each knot.

    An open row of n points has n - 4 jumps, a closed one n.

    Parameters
    ----------
    points : list of vector
        Control points, at least 5 (closed: 8).
    closed : integer, optional
        1: closed row; the first point is not repeated. 0 to 1, default 0.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        Line l({0, 0, 0}, {1, 0, 0}); curve p = distc(l, uniform(0, 1, 9)); farray e = jumps(p);
    """
    ...
def curvature(
    curve: _Curve,
    t: object,
) -> AnyShape:
    """Curvature |C' x C''| / |C'|^3 of a curve at a parameter or an array of parameters.

    Parameters
    ----------
    curve : curve
        The curve.
    t : value
        A parameter, from 0 to 1, or an array of them.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 0, 0); BCurve c({A, B, C}); float k = curvature(c, 0.5);
    """
    ...
def plane(
    normal: _Point,
    point: _Point,
) -> FieldShape:
    """The half-space behind a plane: the distance from it, positive on the side of the normal.

    Parameters
    ----------
    normal : point
        Its normal, from solid to air.
    point : point
        A point of the plane.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        field floor = plane({0, 0, -1}, {0, 0, 0});
    """
    ...
def half_space(
    plane: _Plane,
) -> FieldShape:
    """The half-space behind a plane object or a coordinate plane: the distance from it, positive on the
    side of its normal.

    Parameters
    ----------
    plane : plane
        The plane.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        ZPlane deck(3); field below = half_space(deck);
    """
    ...
def sphere(
    centre: _Point,
    radius: _Number,
    distance: _Integer | None = ...,
) -> FieldShape:
    """The ball |X - centre|^2 - radius^2; with `distance = 1` the distance |X - centre| - radius.

    Parameters
    ----------
    centre : point
        Centre.
    radius : number
        Radius. At least 0.
    distance : integer, optional
        1 for the distance instead of the polynomial. 0 to 1, default 0.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        field ball = sphere({1, 0, 2}, 1.5);
    """
    ...
def cylinder(
    axis: _Curve,
    radius: _Number,
    distance: _Integer | None = ...,
) -> FieldShape:
    """The infinite cylinder p^2 + q^2 - radius^2 about a line; with `distance = 1` the distance
    sqrt(p^2 + q^2) - radius.

    Parameters
    ----------
    axis : line
        A line along the axis.
    radius : number
        Radius. At least 0.
    distance : integer, optional
        1 for the distance instead of the polynomial. 0 to 1, default 0.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(1, 0, 1); Line axis(a, b); field pipe = cylinder(axis, 0.6);
    """
    ...
def cone(
    axis: _Curve,
    angle: _Number,
) -> FieldShape:
    """The double cone with its apex at the start of a line.

    Parameters
    ----------
    axis : line
        A line along the axis, from the apex.
    angle : number
        Full angle at the apex, below half a turn. At least 0.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(1, 0, 1); Line axis(a, b); field tip = cone(axis, 0.3);
    """
    ...
def torus(
    axis: _Curve,
    major: _Number,
    minor: _Number,
) -> FieldShape:
    """The torus about a line, centred at its start.

    Parameters
    ----------
    axis : line
        A line along the axis, from the centre.
    major : number
        Radius of the circle of centres. At least 0.
    minor : number
        Radius of the tube. At least 0.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); field ring = torus(axis, 2, 0.5);
    """
    ...
def cyclide(
    axis: _Curve,
    along: _Point,
    major: _Number,
    minor: _Number,
    change: _Number,
) -> FieldShape:
    """The Dupin cyclide about a line, centred at its start: a ring whose tube is thinner on one side.

    Parameters
    ----------
    axis : line
        A line along the axis, from the centre.
    along : point
        Direction of the thin side.
    major : number
        Radius of the ring. At least 0.
    minor : number
        Mean radius of the tube. At least 0.
    change : number
        Variation of the tube's radius, less than the major radius.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); field ring = cyclide(axis, {1, 0, 0}, 2, 0.5, 0.2);
    """
    ...
def tube(
    curve: _Curve,
    radius: _Number,
) -> FieldShape:
    """The distance from a curve minus a radius: a round bar along the curve, with round ends.

    Parameters
    ----------
    curve : curve
        The curve.
    radius : number
        Radius. At least 0.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 1); BCurve c({A, B, C}); field bar = tube(c, 0.2);
    """
    ...
def plate(
    surface: _Surface,
    thickness: _Number,
) -> FieldShape:
    """The distance from a surface on both sides, minus half a thickness: a plate with round edges.

    Parameters
    ----------
    surface : surface
        The surface.
    thickness : number
        Thickness. At least 0.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); field p = plate(S, 0.1);
    """
    ...
def side(
    surface: _Surface,
) -> FieldShape:
    """The half-space behind a surface: the distance from it, positive on the side of its natural normal.

    Value: (p - q) . n for the point q of the surface nearest to p and the normal n there; beyond
    the edges the half-space is continued along their tangent planes. The nearest point, and with it
    the side, jumps where the planes of two edges meet and far behind a surface that bends by more
    than half a turn: cut the surface before. The ranges are valid there too.

    Parameters
    ----------
    surface : surface
        The surface.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); field below = side(S);
    """
    ...
def inside(
    body: _Body,
) -> FieldShape:
    """The signed distance from a closed body of triangles, such as a sketch's solid or a `SetBody`.

    Parameters
    ----------
    body : mesh
        The body.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        SetBody b(set(sphere({0, 0, 0}, 1)), depth = 4); field f = inside(b); assert abs(f({3, 0, 0}) - 2) < 0.05;
    """
    ...
def profile(
    curve: _Curve,
) -> FieldShape:
    """The signed distance from a closed plane curve, measured in its plane: a prism without ends, negative inside.

    The curve must not cross itself; if it does, regions of odd winding are inside.

    Parameters
    ----------
    curve : curve
        The closed plane curve.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(1, 1, 0); BCurve c({A, B, C, A}, degree = 1); field f = profile(c); assert abs(f({3, 0, 7}) - 1) < 1e-9;
    """
    ...
def extruded(
    curve: _Curve,
    by: _Point,
) -> SetShape:
    """The prism over a closed plane curve, from its plane to the plane moved by a vector, which may be oblique.

    Its volume is the area of the curve times the height of the vector over the plane.

    Parameters
    ----------
    curve : curve
        The closed plane curve.
    by : point
        Vector from its plane to the end.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(1, 1, 0); BCurve c({A, B, C, A}, degree = 1); set s = extruded(c, {0, 0, 0.5}); SetBody bar(s, {-0.1, -0.1, -0.1}, {2.2, 1.1, 0.6}, depth = 4); assert abs(bar.volume - 0.5) < 0.01;
    """
    ...
def extruded_region(
    curves: Sequence[_Curve] | _Any,
    by: _Point,
) -> SetShape:
    """The prism over the region inside an odd number of closed curves of one plane, such as the outlines of a text.

    The curves must not cross one another.

    Parameters
    ----------
    curves : list of curve
        The closed curves.
    by : point
        Vector from their plane to the end.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(3, 0, 0); AbsPoint C(3, 3, 0); AbsPoint D(0, 3, 0); BCurve c({A, B, C, D, A}, degree = 1); AbsPoint P(1, 1, 0); AbsPoint Q(2, 1, 0); AbsPoint R(2, 2, 0); AbsPoint S(1, 2, 0); BCurve d({P, Q, R, S, P}, degree = 1); set s = extruded_region({c, d}, {0, 0, 0.5}); SetBody frame(s, {-0.1, -0.1, -0.1}, {3.2, 3.1, 0.6}, depth = 5); assert abs(frame.volume - 4) < 0.01;
    """
    ...
def revolved(
    curve: _Curve,
    axis: _Curve,
) -> SetShape:
    """The solid of revolution of a closed plane curve about a line in its plane.

    Parameters
    ----------
    curve : curve
        The closed plane curve.
    axis : line
        The axis: a line in the plane of the curve that does not cross it.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        AbsPoint A(2, 0, 0); AbsPoint B(3, 0, 0); AbsPoint C(2, 0, 1); BCurve c({A, B, C, A}, degree = 1); AbsPoint P(0, 0, 0); AbsPoint Q(0, 0, 1); Line axis(P, Q); set s = revolved(c, axis); SetBody ring(s, {-3.1, -3.1, -0.1}, {3.1, 3.1, 1.1}, depth = 5); assert abs(ring.volume - 7*PI/3) < 0.1;
    """
    ...
def set(
    field: object,
) -> SetShape:
    """The points where a field is not positive; or a line as a wire; or a point.

    Its faces are called as the field is. A line reaches from its start to its end. Sets are combined by `|` (union), `&` (intersection), `-`
    (difference), `^` (points in just one) and the sign `-` (complement).

    Parameters
    ----------
    field : value
        The field, line or point.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        field c = sphere({0, 0, 0}, 1); set ball = set(c) & -set(plane({0, 0, 1}, {0, 0, 0}));
    """
    ...
def cuboid(
    low: _Point,
    high: _Point,
) -> SetShape:
    """The box between two corners, of six half-spaces.

    Parameters
    ----------
    low : point
        Low corner.
    high : point
        High corner.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set block = cuboid({0, 0, 0}, {2, 1, 1});
    """
    ...
def tetrahedron(
    a: _Point,
    b: _Point,
    c: _Point,
    d: _Point,
) -> SetShape:
    """The tetrahedron of four points, in any order.

    Parameters
    ----------
    a : point
        A corner.
    b : point
        A corner.
    c : point
        A corner.
    d : point
        A corner.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set t = tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    """
    ...
def thin(
    set: _Set,
) -> SetShape:
    """The faces of a set as sheets, without its interior.

    Parameters
    ----------
    set : set
        The set whose primitives intersect.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set tank = thin(cuboid({0, 0, 0}, {2, 1, 1}));
    """
    ...
def everything() -> SetShape:
    """All of space.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set all = everything();
    """
    ...
def nothing() -> SetShape:
    """The empty set: the start of a union in a loop.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set balls = nothing(); for (i = 1:3) balls = balls | set(sphere({i, 0, 0}, 0.4));
    """
    ...
def attributes(
    set: _Set,
    name: _Text | None = ...,
    colour: _Integer | None = ...,
    material: _Text | None = ...,
    tolerance: _Number | None = ...,
    tags: _Text | None = ...,
) -> SetShape:
    """The same set with attributes; attributes of its parts take precedence.

    They reach every triangle, and the panels of each are a patch under the name.

    Parameters
    ----------
    set : set
        The set.
    name : text, optional
        The name of its faces.
    colour : integer, optional
        Index of a palette colour. 0 to 15.
    material : text, optional
        Its material.
    tolerance : number, optional
        Distance below which two points of the set count as one. At least 0.
    tags : text, optional
        Further attributes, as `tag = text` separated by `;`.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set ball = attributes(set(sphere({0, 0, 0}, 1)), name = "ball", colour = 12);
    """
    ...
def regularized(
    set: _Set,
) -> SetShape:
    """An equal set without parts that combine to nothing new: A|A = A, A|-A = everything, A&-A = nothing,
    A|(A&B) = A, A&(A|B) = A.

    Parameters
    ----------
    set : set
        The set.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set b = set(sphere({0, 0, 0}, 1)); set once = regularized(b | b);
    """
    ...
def polyhedron(
    body: _Body,
) -> SetShape:
    """The set of a closed body of plane faces: exact half-spaces, one per plane.

    Coplanar triangles form a face. For bodies with thousands of faces, such as a triangulated ball,
    use `set(inside(body))`. Coplanar faces share a half-space, even if a change of a parameter
    would separate them.

    Parameters
    ----------
    body : mesh
        The body.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        MeshBody b({{0,0,0}, {1,0,0}, {0,1,0}, {0,0,1}}, {1,3,2, 1,2,4, 2,3,4, 3,1,4}); set s = polyhedron(b); assert abs(volume(s) - 1/6) < 1e-6;
    """
    ...
def translated(
    shape: _Set,
    by: _Point,
) -> AnyShape:
    """A field or set moved by a vector.

    Parameters
    ----------
    shape : set
        The field or set to move.
    by : point
        Translation vector.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        set ball = translated(set(sphere({0, 0, 0}, 1)), {3, 0, 0});
    """
    ...
def turned(
    shape: _Set,
    axis: _Curve,
    angle: _Number,
) -> AnyShape:
    """A field or set rotated about a line.

    Parameters
    ----------
    shape : set
        The field or set to turn.
    axis : line
        The axis, right-handed.
    angle : number
        The angle.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); set s = turned(cuboid({0, 0, 0}, {2, 1, 1}), axis, 0.5);
    """
    ...
def mirrored(
    shape: _Set,
    mirror: _Mirror,
) -> AnyShape:
    """The mirror image of a field or set.

    Parameters
    ----------
    shape : set
        The field or set to mirror.
    mirror : mirror
        A plane, line or point.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        set both = set(sphere({0, 2, 0}, 1)); both = both | mirrored(both, "y=0");
    """
    ...
def scaled(
    shape: _Set,
    factor: _Number,
    centre: _Point | None = ...,
) -> AnyShape:
    """A field or set scaled about a point.

    Parameters
    ----------
    shape : set
        The field or set to scale.
    factor : number
        The factor, not 0.
    centre : point, optional
        Fixed point; default: the origin.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        set half = scaled(cuboid({0, 0, 0}, {2, 1, 1}), 0.5);
    """
    ...
def stretched(
    shape: _Set,
    axis: _Curve,
    factor: _Number,
) -> AnyShape:
    """A field or set stretched along a line; the plane across the line's start is fixed.

    Parameters
    ----------
    shape : set
        The field or set to stretch.
    axis : line
        The line.
    factor : number
        The factor, not 0.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); set egg = stretched(set(sphere({0, 0, 0}, 1)), axis, 1.5);
    """
    ...
def liming(
    l1: _Field,
    l2: _Field,
    l3: _Field,
    l4: _Field | None = ...,
    lambda_: _Number | None = ...,
    contact: _Integer | None = ...,
    low: _Point | None = ...,
    high: _Point | None = ...,
) -> FieldShape:
    """The surface through the four curves in which two bodies meet two others:
    lambda L1 L2 - (1 - lambda) L3 L4. With one rail, L4 = L3, it touches both bodies where the rail does.

    After Liming (1944). With a rail, `contact = n` gives contact G^n by lambda L1 L2 - (1 - lambda)
    |L3|^(n + 1). The rail must cut each body outside the other; over a box `low`, `high` this is
    proved, or the point at which it fails is reported.

    Parameters
    ----------
    l1 : field
        A body.
    l2 : field
        The other body.
    l3 : field
        The rail, or the first of the two other bodies.
    l4 : field, optional
        The second of the two other bodies.
    lambda : number, optional
        Shape between 0 (near the rail) and 1 (near the bodies). Default 0.5.
    contact : integer, optional
        Order of contact on a rail. 1 to 100, default 1.
    low : point, optional
        Low corner of a box over which the contact is checked.
    high : point, optional
        High corner of the box.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field y = plane({0, 1, 0}, {0, 0, 0}); field b = liming(x, y, x + y - 1, lambda = 2/3);
    """
    ...
def zhang(
    l1: _Field,
    l2: _Field,
    l3: _Field,
    l4: _Field,
    lambda_: _Number | None = ...,
    contact: _Integer | None = ...,
    low: _Point | None = ...,
    high: _Point | None = ...,
) -> FieldShape:
    """The transition from one body, tangent to it at its rail, to another, tangent at its own rail: (1
    - lambda) L1 |L4|^(n + 1) + lambda L2 |L3|^(n + 1).

    After Zhang. The rails L3 (on L1) and L4 (on L2) must not meet; over a box `low`, `high` this is
    proved, or the point at which it fails is reported.

    Parameters
    ----------
    l1 : field
        The body at the first rail.
    l2 : field
        The body at the second rail.
    l3 : field
        The rail on the first body.
    l4 : field
        The rail on the second.
    lambda : number, optional
        Shape between 0 (longer along the first body) and 1 (longer along the second). Default
        0.5.
    contact : integer, optional
        Order of contact. 1 to 100, default 1.
    low : point, optional
        Low corner of a box over which the contact is checked.
    high : point, optional
        High corner of the box.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field a = sphere({0, 0, 0}, 1); field duct = zhang(a, sphere({0, 0, 0}, 2), x, 1 - x);
    """
    ...
def setback(
    l1: _Field,
    l2: _Field,
    a: _Number,
    b: _Number | None = ...,
) -> FieldShape:
    """The rail of prescribed setbacks, L1/a + L2/b - 1: it meets L1 = 0 where L2 = b and L2 = 0 where L1 = a.
    With distances the setbacks are lengths.

    Parameters
    ----------
    l1 : field
        A body.
    l2 : field
        The other body.
    a : number
        Setback on the second body, measured by the first. At least 0.
    b : number, optional
        Setback on the first body, measured by the second; default: the same. At least 0.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field y = plane({0, 1, 0}, {0, 0, 0}); field rail = setback(x, y, 0.2, 0.3);
    """
    ...
def fillet(
    l1: _Field,
    l2: _Field,
    width: _Number,
    other: _Number | None = ...,
    lambda_: _Number | None = ...,
    low: _Point | None = ...,
    high: _Point | None = ...,
) -> SetShape:
    """The union of the solid sides of two fields with a fillet in their corner.

    For distance fields the widths are lengths. Over a box `low`, `high` the contact is
    proved, or the point at which it fails is reported.

    Parameters
    ----------
    l1 : field
        A body.
    l2 : field
        The other body.
    width : number
        Setback of the blend on both bodies. At least 0.
    other : number, optional
        Setback on the first body, if different. At least 0.
    lambda : number, optional
        Shape between 0 (a chamfer) and 1 (the corner); 2/3 is a circular arc between
        perpendicular planes. Default 0.666667.
    low : point, optional
        Low corner of a box over which the contact is checked.
    high : point, optional
        High corner of the box.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field z = plane({0, 0, 1}, {0, 0, 0}); set corner = fillet(x, z, 0.2);
    """
    ...
def rounded(
    l1: _Field,
    l2: _Field,
    width: _Number,
    other: _Number | None = ...,
    lambda_: _Number | None = ...,
    low: _Point | None = ...,
    high: _Point | None = ...,
) -> SetShape:
    """The intersection of the solid sides of two fields with their edge rounded.

    For distance fields the widths are lengths. Over a box `low`, `high` the contact is
    proved, or the point at which it fails is reported.

    Parameters
    ----------
    l1 : field
        A body.
    l2 : field
        The other body.
    width : number
        Setback of the blend on both bodies. At least 0.
    other : number, optional
        Setback on the first body, if different. At least 0.
    lambda : number, optional
        Shape between 0 (a chamfer) and 1 (the corner); 2/3 is a circular arc between
        perpendicular planes. Default 0.666667.
    low : point, optional
        Low corner of a box over which the contact is checked.
    high : point, optional
        High corner of the box.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field z = plane({0, 0, 1}, {0, 0, 0}); set edge = rounded(x, z, 0.2);
    """
    ...
def transition(
    l1: _Field,
    l2: _Field,
    l3: _Field,
    l4: _Field,
    lambda_: _Number | None = ...,
    contact: _Integer | None = ...,
    low: _Point | None = ...,
    high: _Point | None = ...,
) -> SetShape:
    """One body up to its rail, the other up to its own, and Zhang's transition between them.

    The solid sides of the rails keep the bodies. See `zhang`.

    Parameters
    ----------
    l1 : field
        The body that it begins on.
    l2 : field
        The body that it ends on.
    l3 : field
        The rail on the first body; the body is kept on its solid side.
    l4 : field
        The rail on the second.
    lambda : number, optional
        Shape: which body it follows longer. Default 0.5.
    contact : integer, optional
        Order of contact. 1 to 100, default 1.
    low : point, optional
        Low corner of a box over which the contact is checked.
    high : point, optional
        High corner of the box.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        field a = sphere({0, 0, 0}, 1); field b = sphere({3, 0, 0}, 0.5); set neck = transition(a, b, plane({1, 0, 0}, {0.8, 0, 0}), plane({-1, 0, 0}, {2.7, 0, 0}));
    """
    ...
def smooth_union(
    a: _Set,
    b: _Set,
    width: _Number,
    blend: _Text | None = ...,
) -> FieldShape:
    """The union of two bodies with the edge between them filled smoothly.

    The blend extends over the points where the functions differ by less than the width, a
    length for distances. A set is taken as its function. Quadratic blends have common
    tangents with both bodies, cubic ones common curvature, circular ones are arcs between
    planes at right angles.

    Parameters
    ----------
    a : set
        A body.
    b : set
        The other body.
    width : number
        The width of the blend. At least 0.
    blend : text, optional
        Shape of the blend: "quadratic", "cubic" or "circular". Default quadratic.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        field blob = smooth_union(sphere({0, 0, 0}, 1, distance = 1), sphere({1.5, 0, 0}, 1, distance = 1), 0.5);
    """
    ...
def smooth_intersection(
    a: _Set,
    b: _Set,
    width: _Number,
    blend: _Text | None = ...,
) -> FieldShape:
    """The intersection of two bodies with the edge between them rounded.

    The blend extends over the points where the functions differ by less than the width, a
    length for distances. A set is taken as its function. Quadratic blends have common
    tangents with both bodies, cubic ones common curvature, circular ones are arcs between
    planes at right angles.

    Parameters
    ----------
    a : set
        A body.
    b : set
        The other body.
    width : number
        The width of the blend. At least 0.
    blend : text, optional
        Shape of the blend: "quadratic", "cubic" or "circular". Default quadratic.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        field lens = smooth_intersection(sphere({0, 0, 0}, 1, distance = 1), sphere({1, 0, 0}, 1, distance = 1), 0.2);
    """
    ...
def smooth_difference(
    a: _Set,
    b: _Set,
    width: _Number,
    blend: _Text | None = ...,
) -> FieldShape:
    """The difference of two bodies with the edge between them rounded.

    The blend extends over the points where the functions differ by less than the width, a
    length for distances. A set is taken as its function. Quadratic blends have common
    tangents with both bodies, cubic ones common curvature, circular ones are arcs between
    planes at right angles.

    Parameters
    ----------
    a : set
        A body.
    b : set
        The other body.
    width : number
        The width of the blend. At least 0.
    blend : text, optional
        Shape of the blend: "quadratic", "cubic" or "circular". Default quadratic.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        field bowl = smooth_difference(sphere({0, 0, 0}, 1, distance = 1), sphere({0, 0, 1}, 0.8, distance = 1), 0.2);
    """
    ...
def remapped(
    shape: _Set,
    x: _Field,
    y: _Field,
    z: _Field,
) -> AnyShape:
    """A field or set under a change of coordinates: its value at p is that of the shape at (x(p),
    y(p), z(p)).

    Twists, bends, tapers and repetitions are such replacements.

    Parameters
    ----------
    shape : set
        Field or set.
    x : field
        Field that replaces x.
    y : field
        Field that replaces y.
    z : field
        Field that replaces z.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field y = plane({0, 1, 0}, {0, 0, 0}); field z = plane({0, 0, 1}, {0, 0, 0}); field egg = remapped(sphere({0, 0, 0}, 1), x, y, z*(1 + z/10));
    """
    ...
def twisted(
    shape: _Set,
    rate: _Number,
) -> AnyShape:
    """A field or set twisted about the z axis.

    Parameters
    ----------
    shape : set
        Field or set.
    rate : number
        Angle of rotation per unit of z.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        set drill = twisted(cuboid({-1, -0.3, 0}, {1, 0.3, 4}), 0.8);
    """
    ...
def remainder(
    x: _Field,
    y: _Field,
) -> FieldShape:
    """The remainder x - y floor(x / y) of fields: x repeated with the period y.

    Parameters
    ----------
    x : field
        The dividend.
    y : field
        The divisor.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        field x = plane({1, 0, 0}, {0, 0, 0}); field teeth = remainder(x, 0.5);
    """
    ...
def repeated(
    set: _Set,
    by: _Point,
    count: _Integer,
) -> SetShape:
    """Copies of a set, each moved from the one before by the same vector.

    Parameters
    ----------
    set : set
        The set.
    by : point
        Vector from each copy to the next.
    count : integer
        Number of copies. 1 to 10000.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set row = repeated(set(sphere({0, 0, 0}, 0.4)), {1, 0, 0}, 5); assert components(row) == 5;
    """
    ...
def circular_array(
    set: _Set,
    axis: _Curve,
    count: _Integer,
    angle: _Number | None = ...,
) -> SetShape:
    """Copies of a set about an axis, each rotated from the one before by the same angle.

    Parameters
    ----------
    set : set
        The set.
    axis : line
        The axis, right-handed.
    count : integer
        Number of copies. 1 to 10000.
    angle : number, optional
        Angle from each copy to the next; default: a full turn divided by their number.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); set holes = circular_array(set(sphere({3, 0, 0}, 0.5)), axis, 6); assert components(holes) == 6;
    """
    ...
def set_union(
    *sets: _Set | Sequence[_Set] | _Any,
) -> SetShape:
    """The union of any number of sets, in a balanced tree, which is the fastest to evaluate for many
    sets.

    Parameters
    ----------
    sets : list of set
        The sets.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set balls = set_union({sphere({0, 0, 0}, 1), sphere({3, 0, 0}, 1), sphere({6, 0, 0}, 1)}); assert components(balls) == 3;
    """
    ...
def set_intersection(
    *sets: _Set | Sequence[_Set] | _Any,
) -> SetShape:
    """The intersection of any number of sets, in a balanced tree.

    Parameters
    ----------
    sets : list of set
        The sets.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set lens = set_intersection({sphere({0, 0, 0}, 1), sphere({1, 0, 0}, 1)}); assert abs(volume(lens) - 5*PI/12) < 1e-6;
    """
    ...
def set_offset(
    set: _Set,
    distance: _Number,
) -> SetShape:
    """A set grown by a distance, or shrunk by a negative one: every face moves along its normals, edges stay sharp.

    Parameters
    ----------
    set : set
        The set, of planes, balls, cylinders, cones and tori.
    distance : number
        Outward displacement of the faces.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set grown = set_offset(cuboid({0, 0, 0}, {1, 1, 1}), 0.1); assert abs(volume(grown) - 1.728) < 1e-9;
    """
    ...
def set_shell(
    set: _Set,
    thickness: _Number,
) -> SetShape:
    """The wall inside a set's surface.

    Parameters
    ----------
    set : set
        The set, of planes, balls, cylinders, cones and tori.
    thickness : number
        Wall thickness. At least 0.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set tank = set_shell(cuboid({0, 0, 0}, {1, 1, 1}), 0.1); assert abs(volume(tank) - 0.488) < 1e-9;
    """
    ...
def convex_hull(
    *sets: _Set | Sequence[_Set] | _Any,
) -> SetShape:
    """The convex hull of sets: the smallest convex set that holds all of them.

    Its surface is of planes, balls, cylinders, cones and tori, and smooth where balls span it. The sets are unions of
    bounded polyhedra and balls; or of polyhedra, cylinders and cones of one axis direction; or of cylinders, cones, tori
    and balls about one axis.

    Parameters
    ----------
    sets : list of set
        The sets.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set pill = convex_hull({set(sphere({0, 0, 0}, 1)), set(sphere({3, 0, 0}, 1))}); assert abs(volume(pill) - 13/3*PI) < 1e-6;
    """
    ...
def minkowski_sum(
    a: _Set,
    b: _Set,
) -> SetShape:
    """The Minkowski sum of two sets: all sums of a point of one and a point of the other.

    With a ball it is the set grown by its radius, with round edges. Each set is a union of convex
    parts, as for `convex_hull`; a cylinder or prism may be added to another with the same axis, or
    to a ball.

    Parameters
    ----------
    a : set
        A set.
    b : set
        The other set.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set soft = minkowski_sum(cuboid({0, 0, 0}, {3, 2, 1}), sphere({0, 0, 0}, 0.2)); assert abs(volume(soft) - (6 + 22*0.2 + 6*PI*0.04 + 4/3*PI*0.008)) < 1e-6;
    """
    ...
def set_fillet(
    a: _Set,
    b: _Set,
    width: _Number,
    other: _Number | None = ...,
    lambda_: _Number | None = ...,
    edges: _Text | None = ...,
) -> SetShape:
    """The union of two sets with fillets where their faces meet.

    Parameters
    ----------
    a : set
        A set, of planes, balls, cylinders, cones and tori.
    b : set
        The other set.
    width : number
        Setback of the blend on both. At least 0.
    other : number, optional
        Setback on the first set, if different. At least 0.
    lambda : number, optional
        Shape between 0 (a chamfer) and 1 (the corner); 2/3 is a circular arc between
        perpendicular planes. Default 0.666667.
    edges : text, optional
        The edges, by the names of a face of each set: "top, side; top, front". Default: all.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set post = set_fillet(cuboid({-2, -2, -1}, {2, 2, 0}), cuboid({-0.5, -0.5, -0.5}, {0.5, 0.5, 2}), 0.2);
    """
    ...
def set_round(
    set: _Set,
    width: _Number,
    lambda_: _Number | None = ...,
    edges: _Text | None = ...,
) -> SetShape:
    """A set with the convex edges between its faces rounded.

    Parameters
    ----------
    set : set
        The set, of planes, balls, cylinders, cones and tori.
    width : number
        Setback of the round on both faces. At least 0.
    lambda : number, optional
        Shape between 0 (a chamfer) and 1 (the corner); 2/3 is a circular arc between
        perpendicular planes. Default 0.666667.
    edges : text, optional
        The edges, by the names of both faces: "top, side; top, front". Default: all.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set soft = set_round(cuboid({0, 0, 0}, {3, 2, 1}), 0.2);
    """
    ...
def set_chamfer(
    set: _Set,
    width: _Number,
    edges: _Text | None = ...,
) -> SetShape:
    """A set with the convex edges between its faces chamfered.

    Parameters
    ----------
    set : set
        The set, of planes, balls, cylinders, cones and tori.
    width : number
        Setback of the chamfer on both faces. At least 0.
    edges : text, optional
        The edges, by the names of both faces: "top, side; top, front". Default: all.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        set block = set_chamfer(cuboid({0, 0, 0}, {10, 6, 4}), 1); assert abs(volume(block) - 206) < 1e-6;
    """
    ...
def volume(
    set: _Set,
    low: _Point | None = ...,
    high: _Point | None = ...,
    accuracy: _Number | None = ...,
) -> Expr:
    """The volume of a set within a box, by a high-order rule; `volume_bracket` gives guaranteed bounds.

    Default box: the bounds of the set; an unbounded set needs a box. Faces of the box cut
    the set. Volume and area of the body of a sketch are those of its faces, exact.

    Parameters
    ----------
    set : set
        The set.
    low : point, optional
        Low corner of the box.
    high : point, optional
        High corner of the box.
    accuracy : number, optional
        Maximum difference of two values at successive divisions of the box; default: 1e-8 of
        the box's volume.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert abs(volume(set(sphere({0, 0, 0}, 1))) - 4.18879) < 1e-4;
    """
    ...
def area(
    set: _Set,
    low: _Point | None = ...,
    high: _Point | None = ...,
    accuracy: _Number | None = ...,
) -> Expr:
    """The area of the surface of a set within a box, sheets counted once.

    Default box: the bounds of the set; an unbounded set needs a box. Faces of the box cut
    the set. Volume and area of the body of a sketch are those of its faces, exact.

    Parameters
    ----------
    set : set
        The set.
    low : point, optional
        Low corner of the box.
    high : point, optional
        High corner of the box.
    accuracy : number, optional
        Maximum difference of two values at successive divisions of the box; default: 1e-6 of
        the area.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert abs(area(set(sphere({0, 0, 0}, 1))) - 12.56637) < 1e-5;
    """
    ...
def wire_length(
    set: _Set,
    low: _Point | None = ...,
    high: _Point | None = ...,
    accuracy: _Number | None = ...,
) -> Expr:
    """The length of the wires of a set within a box: curves in which two sheets meet.

    Default box: the bounds of the set; an unbounded set needs a box. Faces of the box cut
    the set. Volume and area of the body of a sketch are those of its faces, exact.

    Parameters
    ----------
    set : set
        The set.
    low : point, optional
        Low corner of the box.
    high : point, optional
        High corner of the box.
    accuracy : number, optional
        Maximum difference of two values at successive divisions of the box; default: 1e-6 of
        the length.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        set ring = set(abs(sphere({0, 0, 0}, 1))) & set(abs(plane({0, 0, 1}, {0, 0, 0.6}))); assert abs(wire_length(ring) - 5.0265482) < 1e-5;
    """
    ...
def mass_centre(
    set: _Set,
    low: _Point | None = ...,
    high: _Point | None = ...,
    accuracy: _Number | None = ...,
) -> PointHandle:
    """The centre of mass of a set within a box.

    Default box: the bounds of the set; an unbounded set needs a box. Faces of the box cut
    the set. Volume and area of the body of a sketch are those of its faces, exact.

    Parameters
    ----------
    set : set
        The set.
    low : point, optional
        Low corner of the box.
    high : point, optional
        High corner of the box.
    accuracy : number, optional
        Maximum difference of two volumes at successive divisions of the box; default: 1e-8 of
        the box's volume.

    Returns
    -------
    vector

    Notes
    -----
    In the language::

        set half = set(sphere({0, 0, 0}, 1)) & set(plane({0, 0, -1}, {0, 0, 0})); assert abs(mass_centre(half).z - 0.375) < 1e-4;
    """
    ...
def inertia(
    set: _Set,
    low: _Point | None = ...,
    high: _Point | None = ...,
    accuracy: _Number | None = ...,
) -> AnyShape:
    """The rows of the matrix of inertia of a set of density 1 about its centroid.

    Default box: the bounds of the set; an unbounded set needs a box. Faces of the box cut
    the set. Volume and area of the body of a sketch are those of its faces, exact.

    Parameters
    ----------
    set : set
        The set.
    low : point, optional
        Low corner of the box.
    high : point, optional
        High corner of the box.
    accuracy : number, optional
        Maximum difference of two volumes at successive divisions of the box; default: 1e-8 of
        the box's volume.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        curve rows = inertia(cuboid({0, 0, 0}, {1, 2, 3})); assert abs(rows[1].x - 6.5) < 1e-6;
    """
    ...
def volume_bracket(
    set: _Set,
    low: _Point | None = ...,
    high: _Point | None = ...,
    depth: _Integer | None = ...,
) -> AnyShape:
    """Proved bounds of the volume of a set within a box, {low, high}, from ranges over boxes.

    Parameters
    ----------
    set : set
        The set.
    low : point, optional
        Low corner of the box.
    high : point, optional
        High corner of the box.
    depth : integer, optional
        Number of halvings of the box. 1 to 12, default 6.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray v = volume_bracket(set(sphere({0, 0, 0}, 1)), depth = 5); assert v[1] < 4.18879; assert v[2] > 4.18879;
    """
    ...
def member(
    set: _Set,
    point: _Point,
    tolerance: _Number | None = ...,
) -> AnyShape:
    """The position of a point: "solid", "surface" or "air".

    Parameters
    ----------
    set : set
        The set.
    point : point
        The point.
    tolerance : number, optional
        Distance from a surface that counts as on it. At least 0, default 1e-09.

    Returns
    -------
    text

    Notes
    -----
    In the language::

        assert member(set(sphere({0, 0, 0}, 1)), {0.5, 0, 0}) == "solid";
    """
    ...
def winner(
    set: _Set,
    point: _Point,
) -> AnyShape:
    """Name of the primitive that decides the value at a point: the least of a union, the greatest of
    an intersection.

    Parameters
    ----------
    set : set
        The set.
    point : point
        The point.

    Returns
    -------
    text

    Notes
    -----
    In the language::

        field a = sphere({0, 0, 0}, 1); field b = sphere({3, 0, 0}, 1); assert winner(set(a) | set(b), {2.9, 0, 0}) == "b";
    """
    ...
def gradient(
    shape: _Set,
    point: _Point,
) -> PointHandle:
    """The exact gradient of a field or set at a point.

    Parameters
    ----------
    shape : set
        The field or set.
    point : point
        The point.

    Returns
    -------
    vector

    Notes
    -----
    In the language::

        vector g = gradient(sphere({0, 0, 0}, 1), {0.5, 0, 0}); assert g.x == 1;
    """
    ...
def range(
    shape: _Set,
    low: _Point,
    high: _Point,
) -> AnyShape:
    """Bounds {low, high} of the values of a field or set over a box, rounded outward.

    Parameters
    ----------
    shape : set
        The field or set.
    low : point
        Low corner of the box.
    high : point
        High corner of the box.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray r = range(sphere({0, 0, 0}, 1), {0, 0, 0}, {1, 1, 1}); assert r[1] <= -1; assert r[2] >= 2;
    """
    ...
def degree(
    shape: _Set,
) -> Expr:
    """The degree of a field, or the highest in a set: numbers 0, planes 1, sums the maximum, products
    the sum, functions one more, external primitives 100.

    Parameters
    ----------
    shape : set
        The field or set.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        AbsPoint a(0, 0, 0); AbsPoint b(0, 0, 1); Line axis(a, b); assert degree(torus(axis, 2, 0.5)) == 4;
    """
    ...
def nearest(
    set: _Set,
    point: _Point,
    low: _Point | None = ...,
    high: _Point | None = ...,
    accuracy: _Number | None = ...,
) -> PointHandle:
    """The point of a set's surface that is nearest to a point.

    Default box: the bounds of the set.

    Parameters
    ----------
    set : set
        The set.
    point : point
        The point.
    low : point, optional
        Low corner of the box.
    high : point, optional
        High corner of the box.
    accuracy : number, optional
        Error bound of the distance; default: 1e-6 of the box.

    Returns
    -------
    vector

    Notes
    -----
    In the language::

        vector p = nearest(set(sphere({0, 0, 0}, 1)), {3, 0, 0}); assert abs(p.x - 1) < 1e-9;
    """
    ...
def hit(
    set: _Set,
    start: _Point,
    direction: _Point,
    length: _Number | None = ...,
) -> Expr:
    """The first intersection of a ray with the surface of a set, in lengths of its direction.

    Parameters
    ----------
    set : set
        The set.
    start : point
        Start of the ray.
    direction : point
        Its direction, of any length.
    length : number, optional
        Length of the ray; default: through the box of the set. At least 0.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert abs(hit(set(sphere({0, 0, 0}, 1)), {-3, 0, 0}, {1, 0, 0}) - 2) < 1e-12;
    """
    ...
def distance(
    a: _Set,
    b: _Set,
    low: _Point | None = ...,
    high: _Point | None = ...,
    accuracy: _Number | None = ...,
) -> Expr:
    """The distance between two sets; 0 where they overlap or touch.

    Default box: the bounds of the set.

    Parameters
    ----------
    a : set
        A set.
    b : set
        The other set.
    low : point, optional
        Low corner of the box.
    high : point, optional
        High corner of the box.
    accuracy : number, optional
        Error bound of the distance; default: 1e-5 of the box.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert abs(distance(set(sphere({0, 0, 0}, 1)), set(sphere({5, 0, 0}, 1))) - 3) < 1e-6;
    """
    ...
def components(
    set: _Set,
    low: _Point | None = ...,
    high: _Point | None = ...,
    depth: _Integer | None = ...,
) -> Expr:
    """The number of bodies of a set, by facets; bodies that only touch are counted separately.

    Parameters
    ----------
    set : set
        The set.
    low : point, optional
        Low corner of the box.
    high : point, optional
        High corner of the box.
    depth : integer, optional
        Number of halvings of the longest side of the box. 1 to 10, default 6.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert components(set(sphere({0, 0, 0}, 1)) | set(sphere({5, 0, 0}, 1))) == 2;
    """
    ...
def bounds(
    set: _Set,
    accuracy: _Number | None = ...,
) -> AnyShape:
    """A box around a set, {low, high}.

    Parameters
    ----------
    set : set
        The set.
    accuracy : number, optional
        Maximum distance between the box and the set. At least 0, default 0.001.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        curve b = bounds(set(sphere({0, 0, 0}, 1)), 1e-3); assert abs(b[2].x - 1) < 2e-3;
    """
    ...
def uniform(
    start: _Number,
    end: _Number,
    n: _Integer,
) -> AnyShape:
    """`n` numbers in equal steps from `start` to `end`, both included.

    Parameters
    ----------
    start : number
        First number.
    end : number
        Last number.
    n : integer
        Number of values. 2 to 1e+06.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray s = uniform(0, 1, 11);
    """
    ...
def cosine(
    start: _Number,
    end: _Number,
    n: _Integer,
) -> AnyShape:
    """`n` numbers from `start` to `end`, dense at both: start + (end - start) (1 - cos pi x) / 2 for
    uniform x.

    Parameters
    ----------
    start : number
        First number.
    end : number
        Last number.
    n : integer
        Number of values. 2 to 1e+06.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray s = cosine(0, 1, 11);
    """
    ...
def geometric(
    start: _Number,
    end: _Number,
    ds1: _Number,
    n: _Integer,
) -> AnyShape:
    """`n` numbers from `start` to `end` with steps in geometric progression; the first step is `ds1`.

    The ratio solves ds1 (r^N - 1) / (r - 1) = |end - start| for N = n - 1 steps; it is below 1 if
    `ds1` exceeds the mean step.

    Parameters
    ----------
    start : number
        First number.
    end : number
        Last number.
    ds1 : number
        First step, a positive length.
    n : integer
        Number of values. 2 to 1e+06.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray s = geometric(0, 1, 0.01, 25); assert abs(s[2] - 0.01) < 1e-15;
    """
    ...
def geometric2(
    start: _Number,
    end: _Number,
    ds1: _Number,
    ds2: _Number,
    n: _Integer,
) -> AnyShape:
    """`n` numbers from `start` to `end` with steps that grow by one ratio from both ends inward; the
    first step is `ds1`, the last `ds2`.

    The step at which the two progressions meet is chosen so that they meet as evenly as whole
    numbers of steps allow.

    Parameters
    ----------
    start : number
        First number.
    end : number
        Last number.
    ds1 : number
        First step, a positive length.
    ds2 : number
        Last step, a positive length.
    n : integer
        Number of values, at least 4. 2 to 1e+06.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray s = geometric2(0, 1, 0.001, 0.02, 40);
    """
    ...
def d_sinh(
    start: _Number,
    end: _Number,
    ds1: _Number,
    ds2: _Number,
    n: _Integer,
) -> AnyShape:
    """`n` numbers from `start` to `end` by the hyperbolic sine law with a given slope at one end
    (Thompson, Warsi and Mastin 1985): nearer to equal steps at that end than `d_tanh`, coarser at the
    other.

    One of `ds1` and `ds2` must be 0; both 0 is uniform.

    Parameters
    ----------
    start : number
        First number.
    end : number
        Last number.
    ds1 : number
        Slope at the start, per index; 0 leaves it free. At least 0.
    ds2 : number
        Slope at the end, per index; 0 leaves it free. At least 0.
    n : integer
        Number of values. 2 to 1e+06.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray s = d_sinh(0, 1, 0.01, 0, 25);
    """
    ...
def d_tanh(
    start: _Number,
    end: _Number,
    ds1: _Number,
    ds2: _Number,
    n: _Integer,
) -> AnyShape:
    """`n` numbers from `start` to `end` by the hyperbolic tangent law with given slopes at the ends
    (Vinokur, J. Comput. Phys. 50, 1983).

    `ds1` and `ds2` are steps per index at the two ends; 0 leaves that end free, both 0 gives uniform spacing. The
    first and last cells differ from them by the curvature of the law; `d_tanhx` has exact cells.

    Parameters
    ----------
    start : number
        First number.
    end : number
        Last number.
    ds1 : number
        Slope at the start, per index; 0 leaves it free. At least 0.
    ds2 : number
        Slope at the end, per index; 0 leaves it free. At least 0.
    n : integer
        Number of values. 2 to 1e+06.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray s = d_tanh(0, 1, 0.01, 0.05, 60);
    """
    ...
def d_tanhx(
    start: _Number,
    end: _Number,
    ds1: _Number,
    ds2: _Number,
    n: _Integer,
) -> AnyShape:
    """`n` numbers from `start` to `end` by the hyperbolic tangent law, with first and last steps of
    exactly `ds1` and `ds2`.

    A step of 0 leaves that end free; two give uniform spacing. On coarse rows `d_tanh`, whose `ds1`
    and `ds2` are slopes, misses the requested cells by up to a third; this function solves for the
    slopes that give them.

    Parameters
    ----------
    start : number
        First number.
    end : number
        Last number.
    ds1 : number
        First step; 0 leaves it free. At least 0.
    ds2 : number
        Last step; 0 leaves it free. At least 0.
    n : integer
        Number of values, at least 4. 2 to 1e+06.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray s = d_tanhx(0, 1, 0.07, 0.01, 60); assert s[2] == 0.07;
    """
    ...
def redist(
    given: _Numbers,
    n: _Integer,
) -> AnyShape:
    """`n` numbers distributed like those of a given row: its linear interpolation by index, with
    identical ends.

    Parameters
    ----------
    given : list of number
        The row.
    n : integer
        Number of values. 2 to 1e+06.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray s = redist(d_tanh(0, 1, 0.01, 0.05, 60), 31); assert s[31] == 1;
    """
    ...
def count_for(
    length: _Number,
    ds1: _Number,
    ds2: _Number,
    growth: _Number | None = ...,
) -> Expr:
    """The fewest numbers with which `d_tanhx(0, length, ds1, ds2, n)` grows by at most the factor
    `growth` from step to step; a step of 0 means a free end.

    The value is an integer and has no derivatives.

    Parameters
    ----------
    length : number
        The length to be divided. At least 0.
    ds1 : number
        First step; 0 leaves it free. At least 0.
    ds2 : number
        Last step; 0 leaves it free. At least 0.
    growth : number, optional
        The largest ratio of neighbouring steps, more than 1. At least 1, default 1.2.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        int n = count_for(1, 0.001, 0.02, 1.15); assert growth(d_tanhx(0, 1, 0.001, 0.02, n)) <= 1.15; assert growth(d_tanhx(0, 1, 0.001, 0.02, n - 1)) > 1.15;
    """
    ...
def first_for(
    length: _Number,
    growth: _Number,
    n: _Integer,
) -> Expr:
    """The first step of `n` numbers over `length` with steps that grow by the factor `growth`: length
    (growth - 1) / (growth^(n-1) - 1).

    Parameters
    ----------
    length : number
        The length to be divided. At least 0.
    growth : number
        Ratio of a step to the one before it; below 1 for steps that shrink. 1e-06 to 1e+06.
    n : integer
        Number of values. 2 to 1e+06.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        float ds = first_for(1, 1.1, 25); assert abs(growth(geometric(0, 1, ds, 25)) - 1.1) < 1e-11;
    """
    ...
def first_cell(
    row: object,
) -> Expr:
    """The first step of a row: |a[2] - a[1]|, of numbers or of points.

    The spacing that makes a neighbour's cells match: `d_tanhx(0, 1, last_cell(before), 0.1, n)`.

    Parameters
    ----------
    row : value
        Numbers or points, two or more.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert first_cell(d_tanhx(0, 1, 0.07, 0.01, 60)) == 0.07;
    """
    ...
def last_cell(
    row: object,
) -> Expr:
    """The last step of a row: |a[n] - a[n-1]|, of numbers or of points.

    Parameters
    ----------
    row : value
        Numbers or points, two or more.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        farray s = d_tanhx(0, 1, 0.07, 0.01, 60); farray next = d_tanhx(1, 3, last_cell(s), 0.2, 30); assert abs(first_cell(next) - 0.01) < 1e-14;
    """
    ...
def growth(
    row: object,
) -> Expr:
    """The largest ratio of neighbouring steps of a row, of numbers or of points; 1 or more.

    Parameters
    ----------
    row : value
        Numbers or points, three or more.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert abs(growth(d_tanh(0, 1, 0.07, 0.01, 60)) - 1.1380126) < 1e-7;
    """
    ...
def makecc(
    curve: _Vectors,
    ends: _Text | None = ...,
    basis: _Text | None = ...,
    t1: _Vector | None = ...,
    t2: _Vector | None = ...,
    breaks: Sequence[_Integer] | _Array | _Any | None = ...,
) -> CurveHandle:
    """The cubic spline through the points of a curve, as a pcurve.

    `ends` gives the end conditions: "natural" (zero second derivative), "quadratic" (the end piece
    is a parabola), "specified" (the tangents `t1`, `t2`), "notaknot", "bessel", "periodic"; or one
    of each as "natural,specified". `basis` is the parameter: "arc", the cumulative chord over the
    whole; "index"; "centripetal"; "arclen", the true arc length; "arclen+breaks", true arc length
    of splines that end at jumps of curvature, which a plain spline rounds off. The curve
    interpolates every point, the two ends exactly.

    Tangents are dr/ds for the length-like bases and dr/d(index) for "index". Jumps of curvature are
    detected from the points: the curvatures of circles through three neighbours, extrapolated from
    both sides, differ there by a quarter or more. `breaks` gives them by indices of points instead.

    Parameters
    ----------
    curve : curve or surface
        The points, two or more.
    ends : text, optional
        End conditions: "natural", "quadratic", "specified", "notaknot", "bessel" or "periodic".
        Default quadratic.
    basis : text, optional
        The parameter: "arc", "index", "centripetal", "arclen", "arclen+breaks" or "arc+breaks".
        Default arc.
    t1 : vector, optional
        Tangent at the start, for "specified".
    t2 : vector, optional
        Tangent at the end, for "specified".
    breaks : list of integer, optional
        Indices of the points at which the spline is split; default: detected. At least 1.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        Line l({0, 0, 0}, {1, 2, 0}); curve c = distc(l, uniform(0, 1, 9)); pcurve p = makecc(c, "quadratic", "arc"); curve d = distc(p, cosine(0, 1, 20));
    """
    ...
def makelc(
    curve: _Vectors,
    basis: _Text | None = ...,
) -> CurveHandle:
    """The polyline through the points of a curve, as a pcurve.

    Parameters
    ----------
    curve : curve or surface
        The points, two or more.
    basis : text, optional
        The parameter: "arc" (true arc length here), "index" or "centripetal". Default arc.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        Line l({0, 0, 0}, {1, 2, 0}); curve c = distc(l, uniform(0, 1, 9)); pcurve p = makelc(c, "arc"); vector q = evalc(p, 0.25);
    """
    ...
def makecs(
    surface: _Vectors,
    ends: _Text | None = ...,
    basis: _Text | None = ...,
    ends_v: _Text | None = ...,
) -> SurfaceHandle:
    """The bicubic spline surface through the points of a surface, as a psurface, with u along the
    first index and v along the second.

    `ends` as for `makecc`, without "specified"; `ends_v` for the lines along the second index. Parameters
    are means over the lines: "arc" chords, "index" or "centripetal". Lines that are one point (a nose,
    a tail) are allowed.

    Parameters
    ----------
    surface : curve or surface
        The points.
    ends : text, optional
        End conditions of the lines along the first index: "natural", "quadratic", "specified",
        "notaknot", "bessel" or "periodic". Default quadratic.
    basis : text, optional
        The parameters: "arc", "index" or "centripetal". Default arc.
    ends_v : text, optional
        End conditions of the lines along the second index (default: those of the first):
        "natural", "quadratic", "specified", "notaknot", "bessel" or "periodic".

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        Line l({0, 0, 0}, {1, 2, 0}); curve c = distc(l, uniform(0, 1, 5)); surface s[5,4]; for (j = 1:4) s[,j] = c + {0, 0, 1} * j; psurface p = makecs(s, "natural", "arc"); vector q = evals(p, 0.5, 0.25);
    """
    ...
def makels(
    surface: _Vectors,
    basis: _Text | None = ...,
) -> SurfaceHandle:
    """The bilinear surface through the points of a surface, as a psurface.

    Parameters
    ----------
    surface : curve or surface
        The points.
    basis : text, optional
        The parameters: "arc", "index" or "centripetal". Default arc.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        Line l({0, 0, 0}, {1, 2, 0}); curve c = distc(l, uniform(0, 1, 5)); surface s[5,4]; for (j = 1:4) s[,j] = c + {0, 0, 1} * j; psurface p = makels(s, "index");
    """
    ...
def distc(
    curve: _Curve,
    parameters: _Numbers,
) -> AnyShape:
    """The points of a curve at given parameters: C(s[1]), C(s[2]), ...

    Parameters are in [0, 1]; at 0 and 1 the points are the curve's ends to the bit.

    Parameters
    ----------
    curve : curve
        The curve.
    parameters : list of number
        Parameters.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); farray s = cosine(0, 1, 11); curve points = distc(c, s);
    """
    ...
def dists(
    surface: _Surface,
    u: _Numbers,
    v: _Numbers,
) -> AnyShape:
    """The points of a surface at given parameters: S(u[i], v[j]) for rows u[m] and v[n], or
    S(u[i,j], v[i,j]) for parameters that are arrays [m,n] themselves.

    Parameters are in [0, 1].

    Parameters
    ----------
    surface : surface
        The surface.
    u : list of number
        Parameters u.
    v : list of number
        Parameters v.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 1}); RuledSurf r(a, b); surface s = dists(r, uniform(0, 1, 5), d_tanh(0, 1, 0.1, 0, 7));
    """
    ...
def evalc(
    curve: _Curve,
    u: object,
) -> AnyShape:
    """The point of a curve at a parameter, or the points at those of an farray.

    Outside [0, 1] the curve's natural continuation.

    Parameters
    ----------
    curve : curve
        The curve.
    u : value
        A parameter, or an farray of them.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        Line l({0, 0, 0}, {1, 2, 0}); vector p = evalc(l, 0.5); assert p.y == 1;
    """
    ...
def evals(
    surface: _Surface,
    u: object,
    v: object,
) -> AnyShape:
    """The point of a surface at a pair of parameters, or the points at those of two farrays of equal
    shape.

    Parameters
    ----------
    surface : surface
        The surface.
    u : value
        Parameter u, or an farray.
    v : value
        Parameter v, or an farray.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 1}); RuledSurf r(a, b); vector p = evals(r, 1, 0.5); assert p.z == 0.5;
    """
    ...
def derivc(
    curve: _Curve,
    u: object,
    k: _Integer | None = ...,
) -> AnyShape:
    """The derivative of a curve by its parameter, d^k C / du^k, at a parameter or at those of an farray.

    Parameters
    ----------
    curve : curve
        The curve.
    u : value
        A parameter, or an farray of them.
    k : integer, optional
        Order of the derivative: 0, 1 or 2. 0 to 2, default 1.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        Line l({0, 0, 0}, {1, 2, 0}); vector d = derivc(l, 0.5); assert |d - {1, 2, 0}| == 0;
    """
    ...
def derivs(
    surface: _Surface,
    u: object,
    v: object,
    ku: _Integer | None = ...,
    kv: _Integer | None = ...,
) -> AnyShape:
    """The derivative of a surface, `ku` times by u and `kv` times by v, at a pair of parameters or at
    those of two farrays of equal shape.

    Parameters
    ----------
    surface : surface
        The surface.
    u : value
        Parameter u, or an farray.
    v : value
        Parameter v, or an farray.
    ku : integer, optional
        Order of the derivative by u. 0 to 2, default 1.
    kv : integer, optional
        Order of the derivative by v. 0 to 2, default 0.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 1}); RuledSurf r(a, b); vector twist = derivs(r, 0.5, 0.5, 1, 1); assert |twist - {0, 0, 1}| < 1e-15;
    """
    ...
def curvc(
    curve: _Curve,
    u: object,
) -> AnyShape:
    """The curvature of a curve, |C' x C''| / |C'|^3, at a parameter or at those of an farray.

    Not signed; a zero tangent is an error.

    Parameters
    ----------
    curve : curve
        The curve.
    u : value
        A parameter, or an farray of them.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        Arc a({1, 0, 0}, {0, 1, 0}, {-1, 0, 0}); assert abs(curvc(a, 0.3) - 1) < 1e-12;
    """
    ...
def lengthc(
    curve: _Curve,
) -> Expr:
    """The length of a curve: the integral of |C'(t)| from 0 to 1, to about twelve digits.

    Parameters
    ----------
    curve : curve
        The curve.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        Arc a({1, 0, 0}, {0, 1, 0}, {-1, 0, 0}); assert abs(lengthc(a) - 3.141592653589793) < 1e-11;
    """
    ...
def length(
    curve: object,
) -> Expr:
    """The length of a curve: for a pcurve the same as `lengthc`, for points the sum of the distances
    of neighbours.

    Parameters
    ----------
    curve : value
        A pcurve, or a curve of points.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); float l = length(c);
    """
    ...
def prod(
    a: _Numbers,
) -> Expr:
    """The product of all numbers of an array.

    Parameters
    ----------
    a : list of number
        The numbers.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert prod(list(2, 3, 4)) == 24;
    """
    ...
def argmin(
    a: _Numbers,
) -> Expr:
    """The index, from 1, of the least number of a row; of equal ones the first.

    Parameters
    ----------
    a : list of number
        The row.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert argmin(list(3, 1, 2)) == 2;
    """
    ...
def argmax(
    a: _Numbers,
) -> Expr:
    """The index, from 1, of the greatest number of a row; of equal ones the first.

    Parameters
    ----------
    a : list of number
        The row.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert argmax(list(3, 1, 4)) == 3;
    """
    ...
def dot(
    a: _Numbers,
    b: _Numbers,
) -> Expr:
    """The scalar product of two arrays of numbers of equal shape: the sum of a b.

    Vectors have the operator: a . b.

    Parameters
    ----------
    a : list of number
        Numbers.
    b : list of number
        Second row, of equal length.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert dot(list(1, 2, 3, 4), list(1, 0, 1, 0)) == 4;
    """
    ...
def norm(
    a: object,
) -> Expr:
    """The root of the sum of squares of an array of numbers, or of the coordinates of vectors.

    Parameters
    ----------
    a : value
        Numbers, or vectors.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert norm(list(3, 4)) == 5;
    """
    ...
def len(
    a: object,
) -> Expr:
    """The number of items: elements of a row, lines of a grid, layers of a block, items of a list, characters of a text.

    The length of a curve is `length`.

    Parameters
    ----------
    a : value
        The array, list or text.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert len(list(5, 6)) == 2 and len("wing") == 4;
    """
    ...
def cumlen(
    curve: _Vectors,
) -> AnyShape:
    """The arc lengths of the points of a curve, from its first point, from 0 to `length`.

    Parameters
    ----------
    curve : curve or surface
        The points.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray s = cumlen(points({0, 0, 0}, {3, 4, 0}, {3, 4, 1})); assert s[2] == 5;
    """
    ...
def centroid(
    o: _Vectors,
) -> PointHandle:
    """The centroid of a curve of points (segments weighted by length) or of a surface (cells weighted
    by area); for zero length or area, the mean of the points.

    Parameters
    ----------
    o : curve or surface
        The points.

    Returns
    -------
    vector

    Notes
    -----
    In the language::

        assert |centroid(points({0, 0, 0}, {1, 0, 0}, {3, 0, 0})) - {1.5, 0, 0}| < 1e-15;
    """
    ...
def bbox_min(
    o: object,
) -> PointHandle:
    """The least x, y and z of a curve or surface of points.

    Parameters
    ----------
    o : value
        The points.

    Returns
    -------
    vector

    Notes
    -----
    In the language::

        assert |bbox_min(points({0, 5, 0}, {1, 2, -3})) - {0, 2, -3}| == 0;
    """
    ...
def bbox_max(
    o: object,
) -> PointHandle:
    """The greatest x, y and z of a curve or surface of points.

    Parameters
    ----------
    o : value
        The points.

    Returns
    -------
    vector

    Notes
    -----
    In the language::

        assert |bbox_max(points({0, 5, 0}, {1, 2, -3})) - {1, 5, 0}| == 0;
    """
    ...
def where(
    mask: object,
    a: object,
    b: object,
) -> AnyShape:
    """Choice by a mask: `a` where the mask is true, else `b`, element by element.

    Numbers or vectors; each a single one or an array of the mask's shape. Both are computed before one is chosen.

    Parameters
    ----------
    mask : value
        The mask.
    a : value
        Value where the mask is true.
    b : value
        Value where it is false.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        farray a = list(-1, 2, -3, 4); assert sum(where(a > 0, a, 0)) == 6;
    """
    ...
def clamp(
    a: object,
    low: object,
    high: object,
) -> AnyShape:
    """Numbers kept between two bounds, element by element; the bounds are numbers or arrays of the same shape.

    The derivative is that of the number or bound that is returned.

    Parameters
    ----------
    a : value
        The numbers.
    low : value
        The least.
    high : value
        The greatest.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert sum(clamp(list(-1, 0.5, 3), 0, 1)) == 1.5;
    """
    ...
def any(
    mask: object,
) -> Expr:
    """1 when a mask holds somewhere, else 0.

    Parameters
    ----------
    mask : value
        The mask.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert any(list(1, 2, 3) > 2);
    """
    ...
def all(
    mask: object,
) -> Expr:
    """1 when a mask holds everywhere, else 0.

    Parameters
    ----------
    mask : value
        The mask.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert all(list(1, 2, 3) > 0);
    """
    ...
def find(
    a: object,
    part: _Text | None = ...,
) -> AnyShape:
    """The positions, from 1, of the true elements of a row; empty if there are none. For a text: the
    position of the first occurrence of a part, or 0.

    Parameters
    ----------
    a : value
        The mask, or the text.
    part : text, optional
        Part of the text to find.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        farray k = find(list(5, 1, 7) > 4); assert k[1] == 1 and k[2] == 3; assert find("wing.dat", ".") == 5;
    """
    ...
def sort(
    a: _Numbers,
) -> AnyShape:
    """A row in ascending order; equal numbers keep their order.

    Parameters
    ----------
    a : list of number
        The row.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray a = sort(list(3, 1, 2)); assert a[1] == 1 and a[3] == 3;
    """
    ...
def cumsum(
    a: _Numbers,
) -> AnyShape:
    """The sums of the first, the first two, ... numbers of a row.

    Parameters
    ----------
    a : list of number
        The row.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray s = cumsum(list(1, 2, 3)); assert s[3] == 6;
    """
    ...
def diff(
    a: _Numbers,
) -> AnyShape:
    """The differences of neighbours in a row of numbers: one element fewer than the row.

    Parameters
    ----------
    a : list of number
        The row.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray d = diff(list(1, 4, 9)); assert d[2] == 5;
    """
    ...
def interp(
    x: object,
    xs: _Numbers,
    ys: _Numbers,
) -> AnyShape:
    """The piecewise linear function through the points (xs, ys), evaluated at x, a number or an array;
    constant beyond the ends.

    Parameters
    ----------
    x : value
        Positions.
    xs : list of number
        Ascending.
    ys : list of number
        Ordinates, one for each abscissa.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert interp(1.5, list(0, 1, 2), list(0, 10, 30)) == 20;
    """
    ...
def cut(
    text: _Text,
    first: _Integer,
    last: _Integer | None = ...,
) -> AnyShape:
    """The characters `first` to `last` of a text, both included; without `last` to its end.

    Parameters
    ----------
    text : text
        The text.
    first : integer
        The number of the first character, from 1. At least 1.
    last : integer, optional
        The number of the last character.

    Returns
    -------
    text

    Notes
    -----
    In the language::

        assert cut("wing.dat", 1, 4) == "wing" and cut("wing.dat", 6) == "dat";
    """
    ...
def number(
    text: _Text,
) -> Expr:
    """The number that a text spells, blanks around it left out.

    Parameters
    ----------
    text : text
        The text.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert number(" -2.5e3 ") == -2500;
    """
    ...
def replace(
    text: _Text,
    part: _Text,
    by: _Text,
) -> AnyShape:
    """The text with every occurrence of a part replaced.

    Parameters
    ----------
    text : text
        The text.
    part : text
        Part to replace, at least one character.
    by : text
        Replacement.

    Returns
    -------
    text

    Notes
    -----
    In the language::

        assert replace("a-b-c", "-", "+") == "a+b+c";
    """
    ...
def split(
    text: _Text,
    separator: _Text | None = ...,
) -> AnyShape:
    """The parts of a text between separators, as a list of texts; without a separator the words between blanks.

    Parameters
    ----------
    text : text
        The text.
    separator : text, optional
        Separator of the parts.

    Returns
    -------
    list

    Notes
    -----
    In the language::

        string words[] = split("a, b", ","); assert len(words) == 2 and trim(words[2]) == "b";
    """
    ...
def trim(
    text: _Text,
) -> AnyShape:
    """The text without the blanks at its ends.

    Parameters
    ----------
    text : text
        The text.

    Returns
    -------
    text

    Notes
    -----
    In the language::

        assert trim("  wing ") == "wing";
    """
    ...
def lower(
    text: _Text,
) -> AnyShape:
    """The text in lower-case letters.

    Parameters
    ----------
    text : text
        The text.

    Returns
    -------
    text

    Notes
    -----
    In the language::

        assert lower("NACA 0012") == "naca 0012";
    """
    ...
def upper(
    text: _Text,
) -> AnyShape:
    """The text in upper-case letters.

    Parameters
    ----------
    text : text
        The text.

    Returns
    -------
    text

    Notes
    -----
    In the language::

        assert upper("naca") == "NACA";
    """
    ...
def append(
    items: object,
    value: object,
) -> AnyShape:
    """A list with values appended.

    Parameters
    ----------
    items : value
        The list.
    value : value
        Item to append.

    Returns
    -------
    list

    Notes
    -----
    In the language::

        surface s[2,2], parts[] = {s}; parts = append(parts, s + {1, 0, 0}); assert len(parts) == 2;
    """
    ...
def list(
    *numbers: _Number | _Numbers,
) -> AnyShape:
    """The farray of these numbers.

    Parameters
    ----------
    numbers : list of number
        The numbers.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        farray a = list(1, 4, 9); assert a.d1 == 3;
    """
    ...
def points(
    *points: _Vector | _Vectors,
) -> AnyShape:
    """The curve of these points.

    Parameters
    ----------
    points : list of vector
        The points.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        curve c = points({0, 0, 0}, {1, 2, 0}); assert c[2].y == 2;
    """
    ...
def join(
    *parts: object,
) -> AnyShape:
    """Curves (or farrays) joined end to end; a point common to two neighbours is kept once.

    Ends count as one when they differ by less than 1e-12 of the size: by rounding. The point of the
    first of the two stays.

    Parameters
    ----------
    parts : list of value
        The curves, or farrays.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        curve c = join(points({0, 0, 0}, {1, 0, 0}), points({1, 0, 0}, {1, 1, 0})); assert c.d1 == 3; farray a = join(list(1, 2), list(3, 4)); assert a.d1 == 4;
    """
    ...
def stack(
    *parts: object,
) -> AnyShape:
    """The surface with these curves, of equal length, as lines s[1,], s[2,], ...; or the block with
    these surfaces, of equal shape, as layers b[,,1], b[,,2], ....

    Parameters
    ----------
    parts : list of value
        The curves or surfaces.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        surface s = stack(points({0, 0, 0}, {1, 0, 0}), points({0, 1, 0}, {1, 1, 0})); assert s[2,1].y == 1; block b = stack(s, s + {0, 0, 1}); assert b.d3 == 2;
    """
    ...
def reverse(
    a: object,
    index: _Integer | None = ...,
) -> AnyShape:
    """The same array with its elements in the opposite order; of a surface or grid of numbers along the
    first index, or along the second.

    Parameters
    ----------
    a : value
        The array.
    index : integer, optional
        The index of a grid to reverse: 1 or 2. 1 to 2, default 1.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        farray a = reverse(list(1, 2, 3)); assert a[1] == 3;
    """
    ...
def swap(
    s: object,
) -> AnyShape:
    """The surface or grid of numbers with its two indices exchanged: swap(s)[i,j] = s[j,i].

    Parameters
    ----------
    s : value
        The grid.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        surface s[2,3]; surface t = swap(s); assert t.d1 == 3;
    """
    ...
def spread_i(
    a: object,
    n: _Integer,
) -> AnyShape:
    """The grid [m,n] of a row a[m] repeated along the second index: g[i,j] = a[i].

    Parameters
    ----------
    a : value
        The row, of numbers or vectors.
    n : integer
        The number of columns: the second extent. 1 to 1e+06.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        surface s[3,5]; s = spread_i(list(1, 2, 3), 5) * {0, 1, 0}; assert s[3,4].y == 3;
    """
    ...
def spread_j(
    a: object,
    m: _Integer,
) -> AnyShape:
    """The grid [m,n] of a row a[n] repeated along the first index: g[i,j] = a[j].

    Parameters
    ----------
    a : value
        The row, of numbers or vectors.
    m : integer
        The number of rows: the first extent. 1 to 1e+06.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        surface s = spread_j(points({0, 0, 0}, {1, 0, 0}), 4); assert s.d1 == 4;
    """
    ...
def d1(
    a: object,
) -> Expr:
    """The first extent of an array: the same as `a.d1`, for any expression.

    Parameters
    ----------
    a : value
        The array.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert d1(uniform(0, 1, 7)) == 7;
    """
    ...
def d2(
    a: object,
) -> Expr:
    """The second extent of a surface or grid of numbers.

    Parameters
    ----------
    a : value
        The grid.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert d2(spread_i(uniform(0, 1, 7), 3)) == 3;
    """
    ...
def translate(
    o: object,
    v: _Vector,
) -> AnyShape:
    """A vector, curve, surface or block shifted by a vector.

    Parameters
    ----------
    o : value
        The points to shift.
    v : vector
        The shift.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        vector p = translate({1, 0, 0}, {0, 2, 0}); assert p.y == 2;
    """
    ...
def scale(
    o: object,
    by: object,
) -> AnyShape:
    """A vector, curve, surface or block with its coordinates multiplied by those of a vector, or all by a
    number.

    Parameters
    ----------
    o : value
        The points to scale, about the origin.
    by : value
        The three factors, or one.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        vector p = scale({1, 2, 3}, {1, 1, 2}); assert p.z == 6;
    """
    ...
def mirror(
    o: object,
    p: _Vector,
    n: _Vector,
) -> AnyShape:
    """A vector, curve, surface or block mirrored in the plane through a point with a normal.

    Parameters
    ----------
    o : value
        The points to mirror.
    p : vector
        A point of the plane.
    n : vector
        Normal of the plane, of any length.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        vector p = mirror({1, 2, 3}, {0, 0, 0}, {0, 1, 0}); assert p.y == -2;
    """
    ...
def rotate(
    o: object,
    p: _Vector,
    axis: object,
    angle: _Number | None = ...,
) -> AnyShape:
    """A vector, curve, surface or block rotated about an axis, right-handed: rotate(o, axis, angle)
    about the axis through the origin, rotate(o, p, axis, angle) about the one through p (Rodrigues
    1840). Rotations by multiples of PI/2 are exact.

    Parameters
    ----------
    o : value
        The points to turn.
    p : vector
        A point of the axis with four arguments; the direction of the axis with three.
    axis : value
        Direction of the axis; or the angle, in radians.
    angle : number, optional
        The angle, in radians.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        vector p = rotate({1, 0, 0}, {0, 0, 1}, 1.5707963267948966); assert |p - {0, 1, 0}| < 1e-15; vector q = rotate({2, 0, 0}, {1, 0, 0}, {0, 0, 1}, 1.5707963267948966); assert |q - {1, 1, 0}| < 1e-15;
    """
    ...
def revolve(
    curve: _Vectors,
    a0: _Number,
    a1: _Number,
    n: _Integer,
) -> AnyShape:
    """The surface of revolution of a curve about the x axis: line s[,j] is at the j-th of `n` equally
    spaced angles from `a0` to `a1`.

    A point (x, y, z) maps to (x, y cos a - z sin a, y sin a + z cos a). Points on the axis stay
    there exactly: the surface has a pole. Lines at multiples of PI/2 are exactly in the coordinate
    planes.

    Parameters
    ----------
    curve : curve or surface
        The meridian.
    a0 : number
        First angle.
    a1 : number
        Last angle.
    n : integer
        Number of lines. 2 to 1e+06.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        surface s = revolve(points({0, 0, 0}, {1, 1, 0}), 0, 3.141592653589793, 5); assert |s[2,3] - {1, 0, 1}| < 1e-15;
    """
    ...
def tangents(
    curve: _Vectors,
) -> AnyShape:
    """The unit tangents of a curve of points.

    At an inner point that of the parabola through it and its neighbours, at an end that of the
    nearest parabola.

    Parameters
    ----------
    curve : curve or surface
        The points.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        curve t = tangents(points({0, 0, 0}, {1, 0, 0}, {2, 0, 0})); assert t[2].x == 1;
    """
    ...
def frame(
    curve: _Vectors,
    n0: _Vector | None = ...,
) -> AnyShape:
    """Unit normals of a curve of points with the least rotation about its tangents; together with
    `tangents(c)` and their vector product they are a frame at each point (double reflection: Wang
    and others, ACM Trans. Graph. 27, 2008).

    The first normal is the component of `n0` normal to the first tangent; by default `n0` is the
    coordinate axis with the largest angle to the tangent.

    Parameters
    ----------
    curve : curve or surface
        The points.
    n0 : vector, optional
        The first normal.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        curve n = frame(points({0, 0, 0}, {1, 0, 0}, {2, 0, 0}), {0, 0, 3}); assert |n[3] - {0, 0, 1}| < 1e-15;
    """
    ...
def curvatures(
    curve: _Vectors,
) -> AnyShape:
    """The curvatures at the points of a curve: 4 A / (a b c) of the triangle of a point and its two
    neighbours, the inverse radius of the circle through them. An end point has the curvature of its
    neighbour.

    For curves with a parameter use `curvc` and `curvature`.

    `curvature(c)` of a curve of points is the same; `curvature(c, t)` is for a parametric curve.

    Parameters
    ----------
    curve : curve or surface
        The points, three or more.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        Arc a({2, 0, 0}, {0, 2, 0}, {-2, 0, 0}); farray k = curvature(distc(a, uniform(0, 1, 9))); assert abs(k[3] - 0.5) < 1e-12 and k[3] == curvatures(distc(a, uniform(0, 1, 9)))[3];
    """
    ...
def torsion(
    curve: _Vectors,
) -> AnyShape:
    """The torsions at the points of a curve, positive for right-handed screws: 18 V / (d e f) of the
    tetrahedron of four neighbouring points, times a ratio of curvatures (Boutin 2000). A segment
    has one torsion, stored at its first point. Zero where the curve is plane or straight.

    First-order accurate in the spacing of the points.

    Parameters
    ----------
    curve : curve or surface
        The points, four or more.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        curve c[9]; for (i = 1:9) c[i] = {cos(0.1 * i), sin(0.1 * i), 0.1 * i}; farray t = torsion(c); assert abs(t[5] - 0.5) < 0.01;
    """
    ...
def gauss(
    s: _Vectors,
) -> AnyShape:
    """The Gaussian curvatures at the points of a surface: K = (L N - M^2) / (E G - F^2), of the bicubic
    spline through them.

    At poles the mean of the next line.

    Parameters
    ----------
    s : curve or surface
        The points.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        Arc a({2, 0, 0}, {1.414213562373095, 1.414213562373095, 0}, {0, 2, 0}); surface s = revolve(distc(a, uniform(0.2, 0.8, 15)), 0, 1, 12); farray k[15,12]; k = gauss(s); assert abs(k[7,6] - 0.25) < 1e-3;
    """
    ...
def mean(
    s: _Vectors,
) -> AnyShape:
    """The mean curvatures at the points of a surface, positive where it bends towards its natural
    normal s_i x s_j: H = (E N - 2 F M + G L) / (2 (E G - F^2)), of the bicubic spline through them.

    For numbers and vectors `mean` is their average: see `average`.

    Parameters
    ----------
    s : curve or surface
        The points.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        Arc a({2, 0, 0}, {1.414213562373095, 1.414213562373095, 0}, {0, 2, 0}); surface s = revolve(distc(a, uniform(0.2, 0.8, 15)), 0, 1, 12); farray h[15,12]; h = mean(s); assert abs(abs(h[7,6]) - 0.5) < 1e-3;
    """
    ...
def normals(
    s: _Vectors,
) -> AnyShape:
    """The unit normals at the points of a surface, along s_i x s_j, of the bicubic spline through
    them; at a pole the normalised mean of the normals of the adjacent line.

    Parameters
    ----------
    s : curve or surface
        The points.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        surface s = spread_i(list(0, 1, 2), 4) * {1, 0, 0} + spread_j(list(0, 1, 2, 3), 3) * {0, 1, 0}; surface n = normals(s); assert |n[2,2] - {0, 0, 1}| < 1e-15;
    """
    ...
def closest(
    p: object,
    curve: _Curve,
) -> AnyShape:
    """The parameter of the point of a curve that is nearest to a point; for each point of a curve of
    points, an farray.

    With several at equal distance, the first. Ends are included.

    Parameters
    ----------
    p : value
        A point, or a curve of points.
    curve : curve
        The curve.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        Line l({0, 0, 0}, {4, 0, 0}); assert abs(closest({1, 2, 0}, l) - 0.25) < 1e-12;
    """
    ...
def project(
    o: object,
    surface: _Surface,
    dir: object,
) -> AnyShape:
    """The points of a surface nearest to the points of an array ("closest"), or their projections
    along a direction, forwards or backwards.

    Along a direction the nearest of several intersections counts. With "closest" a point beyond an
    edge is projected to the edge.

    Parameters
    ----------
    o : value
        A vector, a curve or a surface of points.
    surface : surface
        The surface.
    dir : value
        The direction, or "closest".

    Returns
    -------
    value

    Notes
    -----
    In the language::

        Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 1}); RuledSurf r(a, b); vector p = project({0.5, 0.5, 3}, r, {0, 0, 1}); assert abs(p.z - 0.25) < 1e-12; vector q = project({0.5, 0.5, 3}, r, "closest");
    """
    ...
def intersect(
    a: object,
    b: object,
    branch: _Integer | None = ...,
) -> AnyShape:
    """The intersection of two shapes with parameters: of two curves, or a curve and a surface, the points, in
    the order of the first curve's parameter; of two surfaces a branch of their intersection, as a
    curve of points: the longest, or another by its number.

    Points are found to 1e-12 of the size. `intersections` gives all branches.

    Parameters
    ----------
    a : value
        A curve or a surface.
    b : value
        A curve or a surface.
    branch : integer, optional
        The number of the branch, longest first; only two surfaces have several. At least 1,
        default 1.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 1}); RuledSurf r(a, b); Line l({0.5, 0.5, -1}, {0.5, 0.5, 1}); curve p = intersect(l, r); assert |p[1] - {0.5, 0.5, 0.25}| < 1e-12;
    """
    ...
def intersections(
    a: object,
    b: object,
) -> AnyShape:
    """All branches of the intersection of two surfaces as a list of curves, the longest first; for
    other shapes, the result of `intersect` alone.

    `foreach (c in intersections(p, q))` walks through them, `intersections(p, q)[2]` is the second.

    Parameters
    ----------
    a : value
        A curve or a surface.
    b : value
        A curve or a surface.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 0}); RuledSurf r(a, b); BCurve w({{0, 0.5, 1}, {0.5, 0.5, -3}, {1, 0.5, 1}}); Line y({0, 0, 1}, {0, 1, 1}); TranSurf t(y, w); float n = 0; foreach (c in intersections(r, t)) n += 1; assert n == 2;
    """
    ...
def tfi(
    s: object,
    kind: _Text | None = ...,
) -> AnyShape:
    """Transfinite interpolation: the surface with exactly the four edges of `s`, and interior points
    interpolated from these.

    `s` is a surface with its edges set (inner points are ignored); or a list of four curves, s[1,],
    s[m,], s[,1], s[,n], which must meet at the corners; or a list of six surfaces, the faces i = 1,
    i = ni, j = 1, j = nj, k = 1, k = nk of a block, for which the value is that block. `kind` is
    "arc" (arc-length blending: Soni 1985), "linear" (by index), "hermite" (arc length with cubic
    blending: blocks join smoothly) or "soni2" (averaged arc lengths instead of their intersection).
    An edge of zero length, a pole, takes the spacing of the opposite one.

    Parameters
    ----------
    s : value
        The surface, four curves or six surfaces.
    kind : text, optional
        "arc", "linear", "hermite" or "soni2". Default arc.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        surface s[5,4]; s[,1] = spread_i(uniform(0, 1, 5), 1)[,1] * {1, 0, 0}; s[,4] = s[,1] + {0, 1, 0}; s[1,] = uniform(0, 1, 4) * {0, 1, 0}; s[5,] = s[1,] + {1, 0, 0}; surface g = tfi(s, "arc");
    """
    ...
def elliptic(
    s: _Vectors,
    n: _Integer | None = ...,
    tol: _Number | None = ...,
    method: _Text | None = ...,
    on: _Surface | None = ...,
    walls: _Text | None = ...,
    spacing: _Number | None = ...,
    angle: _Number | None = ...,
    omega: _Number | None = ...,
    periodic: _Text | None = ...,
    folded: _Text | None = ...,
) -> AnyShape:
    """A grid smoothed by the elliptic equations a (r_xx + p r_x) - 2 b r_xy + c (r_yy + q r_y) = 0;
    its edges are fixed, except periodic ones.

    `method`: "laplace" (p = q = 0: Winslow 1966), "middlecoff" (propagates the spacing of the edges
    inward: Thomas and Middlecoff 1980), "sorenson" (spacing and angle at walls: Steger and Sorenson
    1979, by the iteration of Hilgenstock 1988). A plane grid is smoothed in its plane; a curved one
    on the surface `on`, by default on the spline surface through its own points. The iteration ends
    after `n` sweeps, or when no point moves by more than `tol` of the size and the walls have the
    requested spacing and angle; without convergence a note gives the residual. For "sorenson"
    `walls` names edges, "i1", "im", "j1", "jn", separated by blanks, `spacing` is the first cell
    height there, `angle` the angle of the grid lines to the wall. `periodic` names two opposite edges
    of a plane grid that are one line, the second moved by a constant vector (the cut of an O-grid, the
    sides of a cascade): their points move like those inside, except the ends. A result with folded
    cells is an error, unless `folded` is "allow".

    Parameters
    ----------
    s : curve or surface
        The grid.
    n : integer, optional
        Maximum number of sweeps. 0 to 1e+06, default 5000.
    tol : number, optional
        Convergence: maximum displacement of a point in a sweep, relative to the size; 1:
        exactly `n` sweeps. At least 0, default 1e-08.
    method : text, optional
        "laplace", "middlecoff" or "sorenson". Default laplace.
    on : surface, optional
        The surface that the points stay on.
    walls : text, optional
        Walls, for the method sorenson: "i1", "im", "j1", "jn".
    spacing : number, optional
        First cell height at the walls. At least 0.
    angle : number, optional
        Angle to the walls; default: a right angle. Default 1.5708.
    omega : number, optional
        Over-relaxation. 0.01 to 1.99, default 1.3.
    periodic : text, optional
        Periodic edges: "i1 im" or "j1 jn".
    folded : text, optional
        "refuse" or "allow" folded cells in the result. Default refuse.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        surface s[5,4]; for (j = 1:4) s[,j] = uniform(0, 1, 5) * {1, 0, 0} + {0, 1, 0} * j; s[3,2] += {0.1, 0.2, 0}; surface g = elliptic(s, 200, 1e-12); assert |g[3,2] - {0.5, 2, 0}| < 1e-9;
    """
    ...
def hyperbolic(
    s: object,
    heights: _Numbers,
    sides: _Text | None = ...,
    smoothing: _Number | None = ...,
    normal: _Vector | None = ...,
    stop: _Text | None = ...,
    on: _Surface | None = ...,
) -> AnyShape:
    """A grid marched off a surface or a curve by the hyperbolic equations (Steger and Chaussee 1980;
    Chan and Steger 1992): its lines leave at right angles, and its layers are at given heights.

    Off a surface, along s_i x s_j: the value is a block, the surface its first layer. Off a list of
    surfaces, marched as one front: the value is the list of their blocks. Edges whose points
    coincide to 1e-8 of the size are joined, also of one surface, in either direction, with any
    number of edges at a point; collapsed edges are poles; all blocks are on the side of the first
    surface, so that of a surface with the opposite normal is left-handed. Off a curve,
    to the left of its direction for a view against `normal`: the value is the surface whose line
    g[k,] is layer k, in the plane of the curve or on the surface `on` (a collar). The first layer
    has its height everywhere, also at corners and sharp tails; heights farther out are means.
    `sides` gives conditions at edges, as "i1 pole, j1 symmetry z, jn symmetry z": "pole" for an
    edge that is one point; "symmetry x", "y" or "z" for an edge in a symmetry plane of constant x,
    y or z; "constant x", "y" or "z" for an edge that only keeps that coordinate, "constant xy" and the like
    for one that keeps two; "splay 0.25" for a free edge that leans outward, continued beyond itself
    by cells 1.25 times as long; "periodic" for two coincident edges; edges without a condition are
    free. Of a list, "symmetry y" is the condition of all open edges, and "2 j1 constant x" that of
    one edge of surface 2. The ends of a curve are "i1" and "im".
    Every cell is tested; a layer that would fold is marched with weaker constraints and more
    smoothing, or is an error with layer, position and cause. `stop` ends a march early: "keep"
    (below the layer that cannot be marched), "jacobian 0.1", "skew 0.9", "growth 1.5" (below the
    first layer with a worse cell), "isotropic" (with the first layer whose cells are as high as
    long).

    Parameters
    ----------
    s : value
        The surface, the list of surfaces, or the curve.
    heights : list of number
        The distances of the layers, the first 0.
    sides : text, optional
        Conditions at the edges: "i1", "im", "j1", "jn" with "pole", "free", "periodic",
        "symmetry x", "symmetry y", "symmetry z", "constant x", "constant xy", "splay 0.25" and
        the like; of a list without an edge, or with the number of a surface before it.
    smoothing : number, optional
        Strength of the smoothing of converging lines; 0: none. 0 to 10, default 1.
    normal : vector, optional
        Normal of the plane of a curve, default z; with `on`, the visible side of the surface.
    stop : text, optional
        When the march ends early: "keep", "jacobian 0.1", "skew 0.9", "growth 1.5" or
        "isotropic".
    on : surface, optional
        The surface that a grid off a curve stays on.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        curve c = uniform(0, 1, 9) * {1, 0, 0}; surface g = hyperbolic(c, list(0, 0.1, 0.3)); assert |g[3,5] - {0.5, 0.3, 0}| < 1e-9;
    """
    ...
def elliptic_block(
    b: _Array | Sequence[object] | _Any,
    n: _Integer | None = ...,
    tol: _Number | None = ...,
    method: _Text | None = ...,
    walls: _Text | None = ...,
    spacing: _Number | None = ...,
    omega: _Number | None = ...,
) -> AnyShape:
    """A block smoothed by the elliptic equations; its faces are fixed.

    `method`: "laplace" equalises spacings, "middlecoff" propagates the spacing of the edges inward.
    `walls` names faces, "i1", "in", "j1", "jn", "k1", "kn", separated by blanks, at which grid
    lines are perpendicular with the first cell height `spacing` (by the iteration of Hilgenstock
    1988). Without convergence in `n` sweeps a note gives the residual; folded cells are an
    error.

    Parameters
    ----------
    b : block
        The block.
    n : integer, optional
        Maximum number of sweeps. 0 to 1e+06, default 2000.
    tol : number, optional
        Convergence: maximum displacement of a point in a sweep, relative to the size. At least
        0, default 1e-08.
    method : text, optional
        "laplace" or "middlecoff". Default middlecoff.
    walls : text, optional
        Walls: "i1", "in", "j1", "jn", "k1", "kn".
    spacing : number, optional
        First cell height at the walls. At least 0.
    omega : number, optional
        Over-relaxation. 0.01 to 1.99, default 1.

    Returns
    -------
    block

    Notes
    -----
    In the language::

        surface b[4,4]; for (i = 1:4) for (j = 1:4) b[i,j] = {i, j, 0}; print report(elliptic_block(hyperbolic(b, list(0, 1, 2, 3))));
    """
    ...
def o_grid(
    section: _Vectors,
    heights: _Numbers,
    base: _Integer | None = ...,
) -> AnyShape:
    """An O-grid round a section in x and y: the surface whose line g[k,] is layer k; its first and
    last columns coincide on a line from the trailing edge.

    The section is a closed curve from tail to tail, in either direction; the gap of a blunt tail is
    closed with `base` cells. At a sharp tail the least scaled Jacobian is the sine of half its
    angle: a C-grid has better cells there.

    Parameters
    ----------
    section : curve or surface
        The section.
    heights : list of number
        The distances of the layers, the first 0.
    base : integer, optional
        Cells across a blunt trailing edge. 1 to 10000, default 4.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        curve c = points({1, 0, 0}, {0.5, 0.1, 0}, {0, 0, 0}, {0.5, -0.1, 0}, {1, 0, 0}); surface g = o_grid(c, list(0, 0.01, 0.03, 0.07)); assert g.d1 == 4 and folds(g) == 0;
    """
    ...
def c_grid(
    section: _Vectors,
    heights: _Numbers,
    wake: _Number,
    n: _Integer,
) -> AnyShape:
    """A C-grid round a section in x and y: the surface whose line g[k,] is layer k, from the far end
    of the wake below the section round the leading edge to the far end above it.

    The section is a closed curve from tail to tail, in either direction, with the tail at its
    greatest x. The wake is parallel to x over the length `wake`, with `n` cells that grow from the
    cell at the tail; both its sides have identical points. A blunt tail is an error: `c_blocks` of
    topologies.sdl makes its C-grid with the block behind the base.

    Parameters
    ----------
    section : curve or surface
        The section.
    heights : list of number
        The distances of the layers, the first 0.
    wake : number
        The length of the wake. At least 0.
    n : integer
        The cells along it. 1 to 1e+06.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        curve c = points({1, 0, 0}, {0.5, 0.1, 0}, {0, 0, 0}, {0.5, -0.1, 0}, {1, 0, 0}); surface g = c_grid(c, list(0, 0.01, 0.03, 0.07), 2, 6); assert g.d2 == 5 + 12;
    """
    ...
def h_grid(
    section: _Vectors,
    heights: _Numbers,
    ahead: _Number,
    behind: _Number,
    n: _Integer,
    sweeps: _Integer | None = ...,
) -> AnyShape:
    """An H-grid round a section in x and y: the list of two surfaces, below and above it. Their lines
    g[,1] contain the stagnation line, one side of the section and the wake; their lines g[,n] are
    straight, at the last height below and above the section.

    The section is a closed curve from tail to tail, in either direction, with the nose at its least
    x and a sharp tail at its greatest. The lines ahead and behind are parallel to x over `ahead`
    and `behind`, with `n` cells each that grow from the section's own at nose and tail. Both
    surfaces have identical points there; both are right-handed, so the lower one is directed
    upstream. Inner points are smoothed (`elliptic`, "sorenson"): the first cell off g[,1] has the
    first height, at right angles; without convergence in `sweeps` a note gives the residual.
    With `sweeps` 0 the grid is that of `tfi`.

    Parameters
    ----------
    section : curve or surface
        The section.
    heights : list of number
        The distances of the lines from the section, the first 0.
    ahead : number
        The length ahead of the leading edge. At least 0.
    behind : number
        The length behind the trailing edge. At least 0.
    n : integer
        Number of cells along each of these lengths. 1 to 1e+06.
    sweeps : integer, optional
        Maximum number of smoothing sweeps. 0 to 1e+06, default 3000.

    Returns
    -------
    list

    Notes
    -----
    In the language::

        load "naca.sdl"; curve c[41]; naca4s(c, 0, 0, 12); surface upper = h_grid(c, geometric(0, 2, 0.02, 21), 2, 2, 12, 3000)[2]; assert folds(upper) == 0;
    """
    ...
def quality(
    s: object,
    metric: _Text | None = ...,
) -> AnyShape:
    """The quality of the cells of a grid [m,n]: numbers [m-1,n-1]; of a block [l,m,n]: numbers [l-1,m-1,n-1].

    "sj": scaled Jacobian, the least sine of a corner angle, 1 at best, negative at an inverted
    corner; "skew": equiangle skewness, 0 at best; "aspect" and "edge_ratio": 1 at best; "growth_i",
    "growth_j": ratio of neighbouring cells' lengths, 1 at best; "warp": distance of the corners
    from a plane relative to the size; "turn": the greatest angle between consecutive segments of a
    grid line; "area". Cells at poles count as triangles.

    Blocks: "sj", the least triple product of the unit edges at a corner, negative if opposite to
    the block's own orientation; "skew" of all angles of faces; "aspect" of the lines between the
    middles of opposite faces; "edge_ratio", "growth_i", "growth_j", "growth_k", "volume". Corners
    at edges of zero length are ignored.

    Parameters
    ----------
    s : value
        The grid, or the block.
    metric : text, optional
        "sj", "skew", "aspect", "edge_ratio", "growth_i", "growth_j", "growth_k", "warp",
        "turn", "area" or "volume". Default sj.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        surface s = spread_i(list(0, 1, 2), 4) * {1, 0, 0} + spread_j(list(0, 1, 2, 3), 3) * {0, 1, 0}; assert min(quality(s, "sj")) == 1;
    """
    ...
def folds(
    s: object,
) -> Expr:
    """The number of folded cells of a grid or a block.

    Parameters
    ----------
    s : value
        The grid, or the block.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        surface s = spread_i(list(0, 1, 2), 4) * {1, 0, 0} + spread_j(list(0, 1, 2, 3), 3) * {0, 1, 0}; assert folds(s) == 0;
    """
    ...
def report(
    s: object,
) -> AnyShape:
    """A table of the quality of a grid, to be printed: for each metric the least, mean and greatest
    value and the worst cell; for a block the figures of OpenFOAM's checkMesh and the least scaled
    Jacobian.

    Parameters
    ----------
    s : value
        The grid, or the block.

    Returns
    -------
    text

    Notes
    -----
    In the language::

        surface s = spread_i(list(0, 1, 2), 4) * {1, 0, 0} + spread_j(list(0, 1, 2, 3), 3) * {0, 1, 0}; print report(s);
    """
    ...
def sqrt(
    x: object,
) -> AnyShape:
    """Square root.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert sqrt(9) == 3;
    """
    ...
def sin(
    x: object,
) -> AnyShape:
    """Sine of an angle in radians.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert abs(sin(PI/6) - 0.5) < 1e-15;
    """
    ...
def cos(
    x: object,
) -> AnyShape:
    """Cosine of an angle in radians.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert cos(0) == 1;
    """
    ...
def tan(
    x: object,
) -> AnyShape:
    """Tangent of an angle in radians.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert abs(tan(PI/4) - 1) < 1e-15;
    """
    ...
def asin(
    x: object,
) -> AnyShape:
    """Arc sine, in radians.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert abs(asin(1) - PI/2) < 1e-15;
    """
    ...
def acos(
    x: object,
) -> AnyShape:
    """Arc cosine, in radians.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert acos(1) == 0;
    """
    ...
def atan(
    x: object,
) -> AnyShape:
    """Arc tangent, in radians.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert abs(atan(1) - PI/4) < 1e-15;
    """
    ...
def exp(
    x: object,
) -> AnyShape:
    """Exponential.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert abs(exp(1) - 2.718281828459045) < 1e-15;
    """
    ...
def log(
    x: object,
) -> AnyShape:
    """Natural logarithm.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert log(1) == 0;
    """
    ...
def log10(
    x: object,
) -> AnyShape:
    """Logarithm to base 10; exact for powers of ten.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert log10(1000) == 3;
    """
    ...
def sinh(
    x: object,
) -> AnyShape:
    """Hyperbolic sine.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert sinh(0) == 0;
    """
    ...
def cosh(
    x: object,
) -> AnyShape:
    """Hyperbolic cosine.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert cosh(0) == 1;
    """
    ...
def tanh(
    x: object,
) -> AnyShape:
    """Hyperbolic tangent.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert tanh(0) == 0;
    """
    ...
def abs(
    x: object,
) -> AnyShape:
    """Absolute value; for a field its zero set as a sheet, without a solid side.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert abs(-2) == 2;
    """
    ...
def s_sqrt(
    x: object,
) -> AnyShape:
    """sgn(x) sqrt|x|.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert s_sqrt(-4) == -2;
    """
    ...
def floor(
    x: object,
) -> AnyShape:
    """The greatest integer not above x.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert floor(-1.5) == -2;
    """
    ...
def ceil(
    x: object,
) -> AnyShape:
    """The least integer not below x.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert ceil(-1.5) == -1;
    """
    ...
def round(
    x: object,
) -> AnyShape:
    """The nearest integer; halves are rounded away from zero.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert round(2.5) == 3;
    """
    ...
def sign(
    x: object,
) -> AnyShape:
    """-1, 0 or 1.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert sign(-7) == -1;
    """
    ...
def radians(
    x: object,
) -> AnyShape:
    """Converts degrees to radians.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert abs(radians(180) - PI) < 1e-15;
    """
    ...
def degrees(
    x: object,
) -> AnyShape:
    """Converts radians to degrees.

    Parameters
    ----------
    x : value
        A number, a row of numbers or a field.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert abs(degrees(PI) - 180) < 1e-13;
    """
    ...
def atan2(
    y: object,
    x: object,
) -> AnyShape:
    """Angle of the point (x, y), in radians: atan2(y, x).

    Parameters
    ----------
    y : value
        A number or a row.
    x : value
        A number or a row.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert abs(atan2(1, -1) - 3*PI/4) < 1e-15;
    """
    ...
def hypot(
    a: object,
    b: object,
) -> AnyShape:
    """Length of (a, b).

    Parameters
    ----------
    a : value
        A number or a row.
    b : value
        A number or a row.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert hypot(3, 4) == 5;
    """
    ...
def mod(
    a: object,
    b: object,
) -> AnyShape:
    """Remainder of a / b, with the sign of b; exact.

    Parameters
    ----------
    a : value
        A number or a row.
    b : value
        A number or a row.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert mod(-1, 3) == 2;
    """
    ...
def div(
    a: object,
    b: object,
) -> AnyShape:
    """Integer quotient of a / b, rounded down.

    Parameters
    ----------
    a : value
        A number or a row.
    b : value
        A number or a row.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert div(-1, 3) == -1;
    """
    ...
def min(
    a: object,
    b: object | None = ...,
    c: object | None = ...,
    d: object | None = ...,
    axis: object | None = ...,
) -> AnyShape:
    """The least number of an array; with several arguments, the least element by element.

    Parameters
    ----------
    a : value
        A number, vector or row of numbers.
    b : value, optional
        Another number.
    c : value, optional
        Another number.
    d : value, optional
        Another number.
    axis : value, optional
        1 or 2: reduces numbers [m,n] along that index to a row.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert min(3, 1) == 1;
    """
    ...
def max(
    a: object,
    b: object | None = ...,
    c: object | None = ...,
    d: object | None = ...,
    axis: object | None = ...,
) -> AnyShape:
    """The greatest number of an array; with several arguments, the greatest element by element.

    Parameters
    ----------
    a : value
        A number, vector or row of numbers.
    b : value, optional
        Another number.
    c : value, optional
        Another number.
    d : value, optional
        Another number.
    axis : value, optional
        1 or 2: reduces numbers [m,n] along that index to a row.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert max(3, 1) == 3;
    """
    ...
def sum(
    a: object,
    b: object | None = ...,
    c: object | None = ...,
    d: object | None = ...,
    axis: object | None = ...,
) -> AnyShape:
    """The sum of the numbers of an array; with several arguments, the sum element by element.

    Parameters
    ----------
    a : value
        A number, vector or row of numbers.
    b : value, optional
        Another number.
    c : value, optional
        Another number.
    d : value, optional
        Another number.
    axis : value, optional
        1 or 2: reduces numbers [m,n] along that index to a row.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert sum({1, 2, 4}) == 7;
    """
    ...
def average(
    a: object,
    axis: object | None = ...,
) -> AnyShape:
    """The mean of the numbers or vectors of an array; `mean` is the same.

    Parameters
    ----------
    a : value
        A row or grid of numbers.
    axis : value, optional
        1 or 2: the means along that index, a row.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        assert average(list(1, 2, 6)) == 3;
    """
    ...
def format(
    *args: object,
) -> AnyShape:
    """Formats numbers by C directives; the pattern repeats for the remaining values.

    Parameters
    ----------
    pattern : text
        Text with directives as in C: %d %i %f %e %g %s, with flags and widths.
    values : list of value, optional
        Numbers, texts and points for the directives.

    Returns
    -------
    text

    Notes
    -----
    In the language::

        assert format("%6.2f|%d", 2.5, 3) == "  2.50|3";
    """
    ...
def open(
    *args: object,
    mode: object = ...,
    unit: object = ...,
) -> Expr:
    """Opens a text file to read ("r"), write ("w") or append ("a"); open(7, name) chooses the unit.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    mode : text, optional
        "r", "w" or "a"; "r" by default.
    unit : integer, optional
        Number of the unit; may be the first argument, as in open(7, name).

    Returns
    -------
    integer

    Notes
    -----
    In the language::

        file f = open("a.txt", "w"); write(f, 1, {2, 3, 4}); close(f);
    """
    ...
def close(
    *args: object,
) -> AnyShape:
    """Closes a file.

    Parameters
    ----------
    f : value
        The file, or its unit.

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        open(7, "a.txt"); close(7);
    """
    ...
def write(
    *args: object,
) -> AnyShape:
    """Writes values to a file: a point or number on each line, the first index of a grid fastest.

    Parameters
    ----------
    f : value
        The file, its unit, or `stdout`.
    values : list of value, optional
        Texts, numbers, points and arrays, each from a new line.

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        write(stdout, "two points", {{1, 2, 3}, {4, 5, 6}});
    """
    ...
def read(
    *args: object,
) -> AnyShape:
    """Reads numbers into variables or parts of them; a string takes the rest of the line.

    Parameters
    ----------
    f : value
        The file, or its unit.
    variables : list of value
        Variables, elements and sections to fill, in order.

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        open(7, "a.txt"); write(7, {1, 2, 3}); close(7); file f = open("a.txt", "r"); vector v; read(f, v); assert v.z == 3;
    """
    ...
def more(
    *args: object,
) -> Expr:
    """Reports whether a multiple argument, or a file, has unread items.

    Parameters
    ----------
    c : value
        The multiple argument, or the file.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        function float total(float x...) { float s = 0; while (more(x)) s += next(x); return s; } assert total(1, 2) == 3;
    """
    ...
def next(
    *args: object,
) -> AnyShape:
    """The next item of a multiple argument.

    Parameters
    ----------
    c : value
        The multiple argument.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        function float second(float x...) { next(x); return next(x); } assert second(1, 2) == 2;
    """
    ...
def rewind(
    *args: object,
) -> AnyShape:
    """Returns to the first item of a multiple argument, or to the start of a file.

    Parameters
    ----------
    c : value
        The multiple argument, or the file.

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        function float first(float x...) { next(x); rewind(x); return next(x); } assert first(1, 2) == 1;
    """
    ...
def count(
    *args: object,
) -> Expr:
    """The number of items of a multiple argument or a list; for a mask, the number of true elements.

    Parameters
    ----------
    c : value
        Multiple argument, list or mask.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        function float n(float x...) { return count(x); } assert n(5, 6, 7) == 3;
    """
    ...
def isset(
    *args: object,
) -> Expr:
    """Reports whether a variable, or every element of a section, has a value.

    Parameters
    ----------
    a : value
        The variable, element or section.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        curve c[3]; c[1:2] = {0, 0, 0}; assert isset(c[2]) and not isset(c);
    """
    ...
def ieee(
    *args: object,
    on: object = ...,
) -> AnyShape:
    """Lets infinite results and NaN pass from here on, such as that of 1/0, or with 0 makes them errors again.

    Parameters
    ----------
    on : number, optional
        0: errors again; default 1.

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        ieee(); float a = 1/0; assert a > 1e308; ieee(0);
    """
    ...
def check_edges(
    *args: object,
) -> AnyShape:
    """Stops with location and gap when the four edges of a surface are not set or do not meet.

    Parameters
    ----------
    s : curve or surface
        The surface.

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        surface s[3,3] = {0, 0, 0}; check_edges(s);
    """
    ...
def refined(
    *args: object,
) -> Expr:
    """`n` points, or more when the run is refined: intervals are halved, so that coarse points recur.

    Parameters
    ----------
    n : integer
        The number of points of the coarse run.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        farray s = uniform(0, 1, refined(5));
    """
    ...
def refined_step(
    *args: object,
) -> Expr:
    """A step per index consistent with refined(n): halved at each refinement; for d_tanhx, geometric and geometric2 the first cell of the coarse run is divided in two.

    Parameters
    ----------
    ds : number
        The step of the coarse run.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        farray s = d_tanh(0, 1, refined_step(.01), 0, refined(25));
    """
    ...
def refinement(
    *args: object,
) -> Expr:
    """The number of parts of each interval of refined(n): 1, 2, 4, ...

    Returns
    -------
    number

    Notes
    -----
    In the language::

        assert refinement() >= 1;
    """
    ...
def write_p3d(
    *args: object,
    words: object = ...,
) -> AnyShape:
    """Writes curves, surfaces or blocks as a Plot3D file.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    words : text, optional
        Variant: "stream", "records" or "text"; "double" or "single"; "multi" or "single-block";
        "3d" or "2d"; "whole" or "planes"; "little" or "big"; "iblank"; "mark8". The first of
        each by default.
    s : list of value
        Arrays to write; an farray of integers after one is its blanking.

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        surface s[3,2] = {1, 2, 3}; write_p3d("s.x", "records single", s); surface t = read_p3d("s.x"); assert t.d1 == 3;
    """
    ...
def write_vts(
    *args: object,
) -> AnyShape:
    """Writes surfaces as VTK structured grids: one .vts, or several with their .vtm.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    s : list of value
        Curves, surfaces or blocks to write; a list counts as its members.

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        surface s[3,2] = {1, 2, 3}; write_vts("s.vts", s);
    """
    ...
def plot(
    *args: object,
    view: object = ...,
) -> AnyShape:
    """Draws curves, surfaces and blocks to a .png or .svg; plot(name, view, ...) looks from "x", "-y", "z", "iso" ...

    Parameters
    ----------
    name : text
        Name of the file, ending in .png or .svg.
    view : text, optional
        "x", "y", "z", "-x", "-y", "-z" or "iso"; default: the view with the largest image.
    s : list of value
        Curves, surfaces and blocks to draw.

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        curve c[30]; c.x = uniform(0, 1, 30); c.y = c.x^2; plot("parabola.svg", c);
    """
    ...
def write_stl(
    *args: object,
    words: object = ...,
) -> AnyShape:
    """Writes surfaces as binary STL, with facets facing out of the body and without the triangles of zero area at poles; "flip" reverses the normals.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    words : text, optional
        "flip" reverses the normals.
    s : list of value
        Curves, surfaces or blocks to write; a list counts as its members.

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; write_stl("s.stl", s);
    """
    ...
def write_cgns(
    *args: object,
    faces: object = ...,
) -> AnyShape:
    """Writes surfaces, or blocks, as structured CGNS zones with the interfaces where they have the same points; after a block its boundaries.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    s : list of value
        Curves, surfaces or blocks to write; a list counts as its members.
    faces : text, optional
        Boundaries of the block before it, such as `k1 = hull wall, i1 in = plane symmetry`:
        faces (of a surface i1, im, j1, jn), a name and one of the types "wall", "symmetry",
        "farfield", "inflow", "outflow", "periodic", "empty", "wedge", "patch".

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        surface s[3,2] = {1, 2, 3}; write_cgns("s.cgns", s);
    """
    ...
def write_su2(
    *args: object,
    faces: object = ...,
) -> AnyShape:
    """Writes blocks, or surfaces in one plane as a 2-D mesh, as one SU2 mesh, joined where they have the same points; faces of equal name are one marker.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    b : list of value
        Blocks, or surfaces in one plane; a list counts as its members.
    faces : text, optional
        Boundaries of the block before it, such as `k1 = hull wall, i1 in = plane symmetry`:
        faces (of a surface i1, im, j1, jn), a name and one of the types "wall", "symmetry",
        "farfield", "inflow", "outflow", "periodic", "empty", "wedge", "patch".

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_su2("b.su2", b, "k1 = floor wall, i1 in j1 jn kn = box outflow");
    """
    ...
def write_gmsh(
    *args: object,
    faces: object = ...,
) -> AnyShape:
    """Writes blocks, or surfaces in one plane as a 2-D mesh, as one Gmsh mesh 4.1, joined where they have the same points; faces of equal name are one physical surface, or for surfaces one physical curve.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    b : list of value
        Blocks, or surfaces in one plane; a list counts as its members.
    faces : text, optional
        Boundaries of the block before it, such as `k1 = hull wall, i1 in = plane symmetry`:
        faces (of a surface i1, im, j1, jn), a name and one of the types "wall", "symmetry",
        "farfield", "inflow", "outflow", "periodic", "empty", "wedge", "patch".

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_gmsh("b.msh", b, "k1 = floor wall, i1 in j1 jn kn = box outflow");
    """
    ...
def write_blockmesh(
    *args: object,
    words: object = ...,
    faces: object = ...,
) -> AnyShape:
    """Writes blocks, or surfaces in one plane between two empty sides, as a blockMeshDict of OpenFOAM with a block for each cell, so that its points are kept, or, "graded", with few blocks whose edges have the points of the grid; faces of equal name are one patch.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    words : text, optional
        "graded": few blocks with curved, graded edges; blockMesh interpolates between the
        edges.
    b : list of value
        Blocks, or surfaces in one plane; a list counts as its members.
    faces : text, optional
        Boundaries of the block before it, such as `k1 = hull wall, i1 in = plane symmetry`:
        faces (of a surface i1, im, j1, jn), a name and one of the types "wall", "symmetry",
        "farfield", "inflow", "outflow", "periodic", "empty", "wedge", "patch".

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_blockmesh("blockMeshDict", b, "k1 = floor wall, i1 in j1 jn kn = box outflow");
    """
    ...
def write_polymesh(
    *args: object,
    faces: object = ...,
) -> AnyShape:
    """Writes blocks, or surfaces in one plane between two empty sides, as a polyMesh of OpenFOAM: the files points, faces, owner, neighbour and boundary of the folder `name`; faces of equal name are one patch.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    b : list of value
        Blocks, or surfaces in one plane; a list counts as its members.
    faces : text, optional
        Boundaries of the block before it, such as `k1 = hull wall, i1 in = plane symmetry`:
        faces (of a surface i1, im, j1, jn), a name and one of the types "wall", "symmetry",
        "farfield", "inflow", "outflow", "periodic", "empty", "wedge", "patch".

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_polymesh("constant/polyMesh", b, "k1 = floor wall, i1 in j1 jn kn = box outflow");
    """
    ...
def write_ugrid(
    *args: object,
    faces: object = ...,
) -> AnyShape:
    """Writes blocks as one UGRID mesh (AFLR3) with the boundary conditions of FUN3D in a .mapbc beside it; the name ends in .b8.ugrid (big-endian), .lb8.ugrid (little-endian) or .ugrid (text). All boundaries have a name and one of the types wall, symmetry, farfield, inflow, outflow.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    b : list of value
        Blocks, or surfaces in one plane; a list counts as its members.
    faces : text, optional
        Boundaries of the block before it, such as `k1 = hull wall, i1 in = plane symmetry`:
        faces (of a surface i1, im, j1, jn), a name and one of the types "wall", "symmetry",
        "farfield", "inflow", "outflow", "periodic", "empty", "wedge", "patch".

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_ugrid("b.b8.ugrid", b, "k1 = floor wall, i1 in j1 jn kn = box outflow");
    """
    ...
def write_nmf(
    *args: object,
    faces: object = ...,
) -> AnyShape:
    """Writes the connections and boundaries of blocks as a neutral map file, for the Plot3D file of the same blocks; types are called as by FUN3D, a patch by its name.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    b : list of value
        Blocks, or surfaces in one plane; a list counts as its members.
    faces : text, optional
        Boundaries of the block before it, such as `k1 = hull wall, i1 in = plane symmetry`:
        faces (of a surface i1, im, j1, jn), a name and one of the types "wall", "symmetry",
        "farfield", "inflow", "outflow", "periodic", "empty", "wedge", "patch".

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; write_nmf("b.nmf", b, "k1 = floor wall, i1 in j1 jn kn = box outflow"); write_p3d("b.p3d", b);
    """
    ...
def interfaces(
    *args: object,
    faces: object = ...,
) -> AnyShape:
    """The connections and boundaries of blocks, or of surfaces in one plane, as the writers use them, a line for each; folded and left-handed cells, faces that are not joined and symmetry that is not plane are reported.

    Parameters
    ----------
    b : list of value
        Blocks, or surfaces in one plane; a list counts as its members.
    faces : text, optional
        Boundaries of the block before it, such as `k1 = hull wall, i1 in = plane symmetry`:
        faces (of a surface i1, im, j1, jn), a name and one of the types "wall", "symmetry",
        "farfield", "inflow", "outflow", "periodic", "empty", "wedge", "patch".

    Returns
    -------
    text

    Notes
    -----
    In the language::

        surface s[2,2]; s[1,] = {{0, 0, 0}, {0, 1, 0}}; s[2,] = {{1, 0, 0}, {1, 1, 0}}; block b = {s, s + {0, 0, 1}}; block c = b + {1, 0, 0}; print interfaces(b, "i1 j1 jn k1 kn = box wall", c, "in j1 jn k1 kn = box wall");
    """
    ...
def write_csv(
    *args: object,
) -> AnyShape:
    """Writes points as lines of x,y,z under a heading, with all digits.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    c : list of curve or surface
        Curves or surfaces to write.

    Returns
    -------
    nothing

    Notes
    -----
    In the language::

        curve c[2] = {1, 2, 3}; write_csv("c.csv", c); assert read_points("c.csv")[2] . {1, 0, 0} == 1;
    """
    ...
def read_p3d(
    *args: object,
    block: object = ...,
) -> AnyShape:
    """A surface or block of a Plot3D file of any variant.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    block : integer, optional
        Number of the block in the file; default 1.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        surface s[3,2] = {1, 2, 3}; write_p3d("s.x", s); assert read_p3d("s.x", 1).d2 == 2;
    """
    ...
def iblank_p3d(
    *args: object,
    block: object = ...,
) -> AnyShape:
    """The blanking of a surface or block of a Plot3D file, a whole number for each point.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    block : integer, optional
        Number of the block in the file; default 1.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        surface s[2,2] = {1, 2, 3}; farray hole[2,2] = 1; hole[1,1] = 0; write_p3d("s.x", s, hole); assert iblank_p3d("s.x")[1,1] == 0;
    """
    ...
def count_p3d(
    *args: object,
) -> Expr:
    """The number of surfaces and blocks of a Plot3D file.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        surface s[3,2] = {1, 2, 3}; write_p3d("s.x", s, s); assert count_p3d("s.x") == 2;
    """
    ...
def read_cgns(
    *args: object,
    zone: object = ...,
) -> AnyShape:
    """A structured zone of a CGNS file (HDF5) as a surface or block.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.
    zone : value, optional
        Number or name of the zone; default 1.

    Returns
    -------
    value

    Notes
    -----
    In the language::

        surface s[3,2] = {1, 2, 3}; write_cgns("s.cgns", s); surface t = read_cgns("s.cgns", "s"); assert t.d1 == 3;
    """
    ...
def count_cgns(
    *args: object,
) -> Expr:
    """The number of zones of a CGNS file.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.

    Returns
    -------
    number

    Notes
    -----
    In the language::

        surface s[3,2] = {1, 2, 3}; write_cgns("s.cgns", s, s); assert count_cgns("s.cgns") == 2;
    """
    ...
def names_cgns(
    *args: object,
) -> AnyShape:
    """The names of the zones of a CGNS file, in their order.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.

    Returns
    -------
    list

    Notes
    -----
    In the language::

        surface s[3,2] = {1, 2, 3}; write_cgns("s.cgns", s); string names[1] = names_cgns("s.cgns"); print names[1];
    """
    ...
def text_outlines(
    *args: object,
    size: object = ...,
    align: object = ...,
) -> AnyShape:
    """The outlines of a text in the plane z = 0 as closed curves, exact: loops round letters anticlockwise, those round holes clockwise.

    Parameters
    ----------
    text : text
        The text, of one or more lines.
    font : text
        A .ttf, .otf or .ttc file beside the program, or the name of a font of the system.
    size : number, optional
        Height of a capital letter; default 1.
    align : text, optional
        "left", "centre" or "right" of the origin; default "left".

    Returns
    -------
    list

    Notes
    -----
    In the language::

        set s = extruded_region(text_outlines("HV", "letters.ttf", size = 7), {0, 0, 2}); SetBody b(s, {-1, -1, -1}, {15, 8, 3}, depth = 5); assert abs(b.volume - 89.84) < 1;
    """
    ...
def read_points(
    *args: object,
) -> AnyShape:
    """The points of a text with two or three numbers to a line, as a curve.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        curve c[2] = {1, 2, 3}; write_csv("c.csv", c); curve d = read_points("c.csv");
    """
    ...
def read_aerofoil(
    *args: object,
) -> AnyShape:
    """A section of a coordinate file in Selig's or Lednicer's listing: tail, upper side, nose, lower side, tail.

    Parameters
    ----------
    name : text
        Name of the file, beside the program.

    Returns
    -------
    curve or surface

    Notes
    -----
    In the language::

        file f = open("a.dat", "w"); write(f, "a wedge"); for (x = 1:0:-.25) write(f, format("%g %g", x, .1*x)); for (x = .25:1:.25) write(f, format("%g %g", x, -.1*x)); close(f); assert read_aerofoil("a.dat").d1 == 9;
    """
    ...
