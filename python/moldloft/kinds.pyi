# Made by `make stubs` from the declarations in `crates/`; not edited by hand.
"""The kinds of entities, for models written in Python."""

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

def AbsPoint(
    name: str,
    /,
    x: _Number,
    y: _Number,
    z: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """A point given by its coordinates: X = (x, y, z).

    Three degrees of freedom (Letcher and Shook 1995).

    Parameters
    ----------
    name : str
        The name of the object.
    x : number
        First coordinate.
    y : number
        Second coordinate.
    z : number
        Third coordinate.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(1, 2, 0.5);
    """
    ...
def RelPoint(
    name: str,
    /,
    point: _Point,
    dx: _Number | None = ...,
    dy: _Number | None = ...,
    dz: _Number | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """A point at a fixed offset from another: X = P + (dx, dy, dz).

    Parameters
    ----------
    name : str
        The name of the object.
    point : point
        Reference point.
    dx : number, optional
        Offset along x. Default 0.
    dy : number, optional
        Offset along y. Default 0.
    dz : number, optional
        Offset along z. Default 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(1, 2, 0.5); RelPoint B(A, 0, 0, 1.5);
    """
    ...
def MirrPoint(
    name: str,
    /,
    point: _Point,
    mirror: _Mirror,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """The mirror image of a point: X = 2 F - P, with F the foot of the perpendicular from P to the
    plane or line, or the centre of a point reflection.

    Parameters
    ----------
    name : str
        The name of the object.
    point : point
        The point to mirror.
    mirror : mirror
        The mirror: a plane, line or point.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(1, 2, 0.5); MirrPoint B(A, "y=0");
    """
    ...
def FramePoint(
    name: str,
    /,
    point: _Point | None = ...,
    frame: _Frame | None = ...,
    a: _Number | None = ...,
    b: _Number | None = ...,
    c: _Number | None = ...,
    type: _Integer | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """A point at an offset from another, in the axes of a frame.

    Type 0: Cartesian offset (a, b, c). Type 1: cylindrical, with a the distance from the z axis, b
    the angle from x toward y, c the height. Type 2: spherical, with a the distance, b the
    longitude, c the latitude. The point defaults to the frame's origin. A point given as `frame`
    means the world axes at that point.

    Parameters
    ----------
    name : str
        The name of the object.
    point : point, optional
        Reference point; default: the frame's origin.
    frame : frame, optional
        Frame of the axes; default: world axes.
    a : number, optional
        First coordinate. Default 0.
    b : number, optional
        Second coordinate; an angle in types 1 and 2. Default 0.
    c : number, optional
        Third coordinate; an angle in type 2. Default 0.
    type : integer, optional
        0 Cartesian, 1 cylindrical, 2 spherical. 0 to 2, default 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(1, 0, 0); RPYFrame keel(A, 0.35, 0, 0.1); FramePoint p(A, keel, 0, 0, -3); FramePoint q(p, keel, 2, 0.5, 1, type = 1); FramePoint r(q, A, 2, 0.5, 1, 2);
    """
    ...
def PolarPoint(
    name: str,
    /,
    point: _Point | None = ...,
    frame: _Frame | None = ...,
    theta: _Number | None = ...,
    phi: _Number | None = ...,
    *,
    r: _Number,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """A point at a distance and direction from another, in the axes of a frame:
    X = P + r (cos phi cos theta, cos phi sin theta, sin phi).

    Parameters
    ----------
    name : str
        The name of the object.
    point : point, optional
        Reference point; default: the frame's origin.
    frame : frame, optional
        Frame of the axes; default: world axes.
    r : number
        Distance.
    theta : number, optional
        Longitude, from x toward y. Default 0.
    phi : number, optional
        Latitude, from the xy plane toward z. Default 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(1, 0, 0); RPYFrame keel(A, 0.35, 0, 0.1); PolarPoint p(A, keel, 2, 0.5, 0.2);
    """
    ...
def OffsetPoint(
    name: str,
    /,
    magnet: _Magnet,
    distance: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """A point off a surface: X = S(u, v) + d n, with n the unit normal along S_u x S_v.

    At a pole the normal is the limit along the parameter line that ends there.

    Parameters
    ----------
    name : str
        The name of the object.
    magnet : magnet
        The magnet on the surface.
    distance : number
        The distance, on the side of the natural normal if positive.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.25, 0.5); OffsetPoint q(p, 0.75);
    """
    ...
def TanPoint(
    name: str,
    /,
    bead: _Bead,
    distance: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """A point on the tangent of a curve: X = C(t) + d C'(t) / |C'(t)|.

    Parameters
    ----------
    name : str
        The name of the object.
    bead : bead
        The bead on the curve.
    distance : number
        The distance, in the direction of increasing parameter if positive.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); AbsBead b(c, 0.25); TanPoint p(b, 1.5);
    """
    ...
def RotatPoint(
    name: str,
    /,
    point: _Point,
    line: _Curve,
    angle: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """A point rotated about a line by an angle, right-handed (Rodrigues).

    Parameters
    ----------
    name : str
        The name of the object.
    point : point
        The point to turn.
    line : line
        The axis, from the line's first end to its last.
    angle : number
        The angle.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(1, 2, 0.5); AbsPoint B(0, 0, 0); AbsPoint C(3, 1, 0); Line axis(B, C); RotatPoint p(A, axis, 0.75);
    """
    ...
def CopyPoint(
    name: str,
    /,
    point: _Point,
    from_: _Point,
    to: _Point,
    sx: _Number | None = ...,
    sy: _Number | None = ...,
    sz: _Number | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """A point copied from one reference point to another and scaled along the axes: X = to + (sx, sy,
    sz) (P - from), component by component.

    Parameters
    ----------
    name : str
        The name of the object.
    point : point
        The point to copy.
    from : point
        A point that is moved to `to`.
    to : point
        The image of `from`.
    sx : number, optional
        Scale along x. Default 1.
    sy : number, optional
        Scale along y. Default 1.
    sz : number, optional
        Scale along z. Default 1.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(1, 2, 0.5); AbsPoint B(0, 0, 0); AbsPoint C(3, 1, 0); CopyPoint p(A, B, C, 2, 1, -1);
    """
    ...
def BlendPoint(
    name: str,
    /,
    points: _Vectors,
    weights: _Numbers | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """The weighted sum of points: X = sum w_i P_i.

    By default the weights are equal. Weights whose sum is not 1 raise a warning: the blend would
    not translate with its points. The weights 1, -1, 1 give the fourth corner of a parallelogram.

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of point
        The points.
    weights : list of number, optional
        Their weights, which should add up to 1.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(1, 2, 0.5); AbsPoint B(0, 0, 0); AbsPoint C(3, 1, 0); BlendPoint fourth({A, B, C}, {1, -1, 1}); BlendPoint middle({A, C});
    """
    ...
def CentroidPoint(
    name: str,
    /,
    objects: Sequence[object] | _Array | _Any,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """The centroid of points, of curves by their length, of surfaces by their area, or of solids and closed
    bodies of triangles by their volume.

    All entries have one class, since a point has neither length nor area to weigh against a curve.
    Left-handed solids count as positive volume; where a solid is folded, volume covered twice
    counts twice.

    Parameters
    ----------
    name : str
        The name of the object.
    objects : list of value
        Points, curves, surfaces or solids.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); BCurve l({A, B, D}); Line m(C, D); RuledSurf S(l, m); CentroidPoint p({A, B, C}); CentroidPoint q({l, m}); CentroidPoint r({S}); AbsPoint E(0, 3, 0); Line up(A, E); TranSolid block(S, up); CentroidPoint s({block});
    """
    ...
def TabPoint(
    name: str,
    /,
    file: _Text | None = ...,
    row: _Integer | None = ...,
    points: _Vectors | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """A point of a table of points.

    The file has a point in a line: x, y, z (or x, y) with blanks or commas between.

    Parameters
    ----------
    name : str
        The name of the object.
    file : text, optional
        The file, relative to the program that declares the point.
    row : integer, optional
        Number of the point, from 1. At least 1, default 1.
    points : list of vector, optional
        The points, if there is no file.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        TabPoint top(row = 2, points = {{0, 0, 0}, {1, 2, 0.5}, {3, 2, 1}});
    """
    ...
def ProjPoint(
    name: str,
    /,
    point: _Point,
    mirror: _Target,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """The foot of the perpendicular from a point to a plane, line, surface or the zero set of a field;
    if the target is a point, that point.

    On the zero set of a field it is the foot found by descent along the field.

    On a surface it is the nearest foot; from a magnet of the surface, the foot found by descent
    from there. A foot beyond an edge is clamped to the edge and reported.

    Parameters
    ----------
    name : str
        The name of the object.
    point : point
        The point to project.
    mirror : target
        The target of the projection.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(1, 2, 0.5); AbsPoint B(0, 0, 0); AbsPoint C(3, 1, 0); Line axis(B, C); ProjPoint foot(A, axis); AbsPoint D(0, 3, 2); Line m(D, A); RuledSurf S(axis, m); ProjPoint on(D, S);
    """
    ...
def IntPoint(
    name: str,
    /,
    shape1: _Target,
    shape2: _Target,
    shape3: _Target,
    near: _Point | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PointHandle:
    """The common point of three planes, surfaces or zero sets of fields.

    With magnets instead of surfaces it is the point found by Newton's method from there. Without
    them all points are searched: the result is the one nearest to `near`, by default to the middle
    of the surfaces' parameters, and the others are reported.

    Parameters
    ----------
    name : str
        The name of the object.
    shape1 : target
        A plane, a surface (or a magnet on it near the intended point), or a field.
    shape2 : target
        Another.
    shape3 : target
        A third.
    near : point, optional
        Selects the nearest of several common points.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    point

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); IntPoint p(S, "x=0", "y=0"); XPlane x(1.5); YPlane y(2); ZPlane z(3); IntPoint q(x, y, z); AbsPoint E(1, 0.5, -2); AbsPoint F(2, 4, -2); AbsPoint G(3, -1, 4); AbsPoint H(2, 4, 4); Line n(E, F); Line o(G, H); RuledSurf T(n, o); IntPoint r(S, T, y);
    """
    ...
def AbsBead(
    name: str,
    /,
    curve: _Curve,
    t: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BeadHandle:
    """A point on a curve at a given parameter: X = C(t).

    Outside [0, 1] it continues the curve's formula. On a snake the bead is a ring and has a
    position on the surface too.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        Host curve.
    t : number
        Its parameter.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    bead

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); Line l(A, B); AbsBead b(l, 0.25);
    """
    ...
def RelBead(
    name: str,
    /,
    bead: _Bead,
    dt: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BeadHandle:
    """A point on the curve of another bead, at a fixed difference of parameter: X = C(t + dt).

    When the other bead moves, the difference of parameters stays the same, not the length
    of the curve between them.

    Parameters
    ----------
    name : str
        The name of the object.
    bead : bead
        Reference bead.
    dt : number
        Difference of parameter.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    bead

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); Line l(A, B); AbsBead b(l, 0.25); RelBead c(b, 0.5);
    """
    ...
def ArcLenBead(
    name: str,
    /,
    start: _Along,
    length: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BeadHandle:
    """The bead at a signed arc length along a curve from another bead or from the curve's start;
    negative lengths run backwards.

    Parameters
    ----------
    name : str
        The name of the object.
    start : curve or bead
        A bead, or a curve for its start.
    length : number
        The length.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    bead

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); ArcLenBead b(c, 1.5); ArcLenBead d(b, -0.5);
    """
    ...
def CopyBead(
    name: str,
    /,
    bead: _Bead,
    curve: _Curve,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BeadHandle:
    """The bead of another curve at the parameter of a bead: X = C(t).

    Parameters
    ----------
    name : str
        The name of the object.
    bead : bead
        The bead whose parameter is copied.
    curve : curve
        The target curve.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    bead

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); Line l(A, C); AbsBead b(c, 0.25); CopyBead d(b, l);
    """
    ...
def AbsMagnet(
    name: str,
    /,
    surface: _Surface,
    u: _Number,
    v: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> MagnetHandle:
    """A point on a surface at given parameters: X = S(u, v).

    Outside [0, 1] it continues the surface's formula.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        Host surface.
    u : number
        Its first parameter.
    v : number
        Its second parameter.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    magnet

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.25, 0.5);
    """
    ...
def RelMagnet(
    name: str,
    /,
    magnet: _Magnet,
    du: _Number | None = ...,
    dv: _Number | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> MagnetHandle:
    """A point on the surface of another magnet, at a fixed difference of parameters:
    X = S(u + du, v + dv).

    Parameters
    ----------
    name : str
        The name of the object.
    magnet : magnet
        Reference magnet.
    du : number, optional
        Difference of the first parameter. Default 0.
    dv : number, optional
        Difference of the second parameter. Default 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    magnet

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.25, 0.5); RelMagnet q(p, 0.5, 0.125);
    """
    ...
def CopyMagnet(
    name: str,
    /,
    magnet: _Magnet,
    surface: _Surface,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> MagnetHandle:
    """The magnet of another surface at the parameters of a magnet: X = S(u, v).

    Parameters
    ----------
    name : str
        The name of the object.
    magnet : magnet
        The magnet whose parameters are copied.
    surface : surface
        The target surface.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    magnet

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); RuledSurf T(m, l); AbsMagnet p(S, 0.25, 0.375); CopyMagnet q(p, T);
    """
    ...
def AbsRing(
    name: str,
    /,
    snake: _Snake,
    t: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RingHandle:
    """A point on a snake at a given parameter: X = S(w(t)).

    It is both a bead of the snake and a magnet of the surface.

    Parameters
    ----------
    name : str
        The name of the object.
    snake : snake
        The snake of the ring.
    t : number
        Its parameter.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    ring

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, "u", 0.4); AbsRing r(s, 0.5);
    """
    ...
def RelRing(
    name: str,
    /,
    ring: _Ring,
    dt: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RingHandle:
    """A point on the snake of another ring, at a fixed difference of parameter: X = S(w(t + dt)).

    Parameters
    ----------
    name : str
        The name of the object.
    ring : ring
        Reference ring.
    dt : number
        Difference of parameter.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    ring

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, "u", 0.4); AbsRing r(s, 0.5); RelRing q(r, 0.25);
    """
    ...
def ArcLenRing(
    name: str,
    /,
    start: _Along,
    length: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RingHandle:
    """The ring at a signed arc length along a snake from another ring or from the snake's start;
    negative lengths run backwards.

    Parameters
    ----------
    name : str
        The name of the object.
    start : curve or bead
        A ring, or a snake for its start.
    length : number
        The length.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    ring

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, "u", 0.4); ArcLenRing r(s, 0.5); ArcLenRing q(r, 0.25);
    """
    ...
def CopyRing(
    name: str,
    /,
    ring: _Ring,
    snake: _Snake,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RingHandle:
    """The ring of another snake at the parameter of a ring: X = S(w(t)).

    Parameters
    ----------
    name : str
        The name of the object.
    ring : ring
        The ring whose parameter is copied.
    snake : snake
        The target snake.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    ring

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, "u", 0.4); UVSnake t(S, "v", 0.3); AbsRing r(s, 0.3); CopyRing q(r, t);
    """
    ...
def IntBead(
    name: str,
    /,
    curve: _Along,
    target: _Target,
    point: _Point | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BeadHandle:
    """The intersection of a curve with a plane, a surface, another curve or a sphere: C(t) on the target. From a bead it is found by damped Newton iteration; without one it is the intersection nearest to t = 0.5, and the others are reported.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve or bead
        The curve, or a bead on it near the intended point.
    target : target
        A plane, surface (or magnet), curve (or bead), or the centre of a sphere.
    point : point, optional
        With a plane: selects the parallel plane through this point. With a centre: a point of
        the sphere.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    bead

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); BCurve c({A, B, C, D}); XPlane middle(2); IntBead b(c, middle); AbsBead near(c, 0.1); IntBead d(near, "y=0", {0, 1, 0});
    """
    ...
def XYZBead(
    name: str,
    /,
    curve: _Along,
    axis: _Text,
    value: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BeadHandle:
    """The point of a curve with a given coordinate x, y or z. From a bead it is found by damped Newton iteration; without one it is the point nearest to t = 0.5.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve or bead
        The curve, or a bead on it near the intended point.
    axis : text
        The coordinate: "x", "y" or "z".
    value : number
        Value of the coordinate.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    bead

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); XYZBead b(c, "x", 1.25);
    """
    ...
def ProjBead(
    name: str,
    /,
    curve: _Along,
    point: _Point,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BeadHandle:
    """The foot of the perpendicular from a point to a curve: C'(t) . (C(t) - P) = 0, where the distance is least. From a bead it is the foot found by descent; without one, the nearest of all. If the foot is beyond an end, the end is the result and is reported.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve or bead
        The curve, or a bead on it near the intended point.
    point : point
        The point to project.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    bead

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); AbsPoint P(1, 3, 1); ProjBead b(c, P);
    """
    ...
def ProxBead(
    name: str,
    /,
    curve: _Along,
    point: _Point,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BeadHandle:
    """The point of a curve nearest to a given point, of the whole curve and ends included. Equally near ones are reported.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve or bead
        The curve, or a bead on it near the intended point.
    point : point
        The point to be near to.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    bead

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); AbsPoint P(1, 3, 1); ProxBead b(c, P);
    """
    ...
def ProjMagnet(
    name: str,
    /,
    point: _Point,
    surface: _Onto,
    mirror: _Mirror | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> MagnetHandle:
    """The projection of a point onto a surface: along the surface's normal (the foot of the
    perpendicular), along a direction, or away from a point.

    From a magnet it is the foot found by Newton's method; without one, the nearest of all. A foot
    beyond an edge is clamped to the edge and reported.

    Parameters
    ----------
    name : str
        The name of the object.
    point : point
        The point to project.
    surface : surface or magnet
        The surface, or a magnet on it near the intended point.
    mirror : mirror, optional
        Direction of projection: a plane's normal, a line's direction, or rays from a point.
        Default: the surface's own normal.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    magnet

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsPoint P(1, 2, 4); ProjMagnet foot(P, S); ProjMagnet below(P, S, "z=0"); AbsPoint eye(1, 1, 9); AbsMagnet near(S, 0.3, 0.5); ProjMagnet shadow(P, near, eye);
    """
    ...
def ProxMagnet(
    name: str,
    /,
    point: _Point,
    surface: _Onto,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> MagnetHandle:
    """The point of a surface nearest to a given point, among all points of the surface and its edges.
    Equally near points are reported.

    Parameters
    ----------
    name : str
        The name of the object.
    point : point
        The given point.
    surface : surface or magnet
        The surface.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    magnet

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsPoint P(1, 2, 4); ProxMagnet m1(P, S);
    """
    ...
def IntMagnet(
    name: str,
    /,
    curve: _Along,
    surface: _Onto,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> MagnetHandle:
    """The intersection of a curve with a surface, as a point of the surface: C(t) = S(u, v).

    The bead names the curve and a start t, the magnet the surface and a start (u, v).

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve or bead
        The curve, or a bead on it.
    surface : surface or magnet
        The surface, or a magnet on it.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    magnet

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsPoint P(1, 2, 4); AbsPoint Q(2, 1, -3); Line n(P, Q); IntMagnet hit(n, S);
    """
    ...
def XYZMagnet(
    name: str,
    /,
    surface: _Onto,
    axis1: _Text,
    value1: _Number,
    axis2: _Text,
    value2: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> MagnetHandle:
    """The point of a surface with two given coordinates.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface or magnet
        The surface, or a magnet on it near the intended point.
    axis1 : text
        The first coordinate: "x", "y" or "z".
    value1 : number
        Value of the first coordinate.
    axis2 : text
        The second coordinate, different from the first.
    value2 : number
        Value of the second coordinate.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    magnet

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); XYZMagnet m1(S, "x", 1, "z", 0.75);
    """
    ...
def TanMagnet(
    name: str,
    /,
    magnet: _Magnet,
    a: _Number | None = ...,
    b: _Number | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> MagnetHandle:
    """The point of a surface near another magnet, at distances measured in its tangent plane: the foot
    on the surface of S + a e1 + b e2, with e1 the direction of S_u and e2 the one perpendicular to
    it towards S_v.

    Parameters
    ----------
    name : str
        The name of the object.
    magnet : magnet
        Reference magnet.
    a : number, optional
        Distance along u. Default 0.
    b : number, optional
        Distance across. Default 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    magnet

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.5, 0.5); TanMagnet q(p, 0.5, -0.25);
    """
    ...
def BoxMagnet(
    name: str,
    /,
    snake: _Snake,
    corner: _Integer,
    edge: _Integer | None = ...,
    margin: _Number | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> MagnetHandle:
    """A corner of the box round a snake: 1 is the low u and the low v, 2 the high u and the low v, 3 the high u and the high v, 4 the low u
    and the high v.

    The sides of the box are parameter lines of the surface. They keep a distance from the snake, in both directions the same in
    space, and stay off the edges of the surface: the box is between the snake and the edges for every size of the snake. The snake is closed,
    or begins and ends on one edge of the surface, which is then a side of the box.

    Parameters
    ----------
    name : str
        The name of the object.
    snake : snake
        The snake.
    corner : integer
        The corner. 1 to 4.
    edge : integer, optional
        The edge of the surface on which the snake begins and ends: 1 is v = 0, 2 is u = 1, 3 is
        v = 1, 4 is u = 0. 0: it is closed. At most 4, default 0.
    margin : number, optional
        Distance of the box from the snake, as a fraction of the snake's size. Default 0.5.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    magnet

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.5, 0.5); AbsMagnet q(S, 0.6, 0.5); AbsMagnet r(S, 0.5, 0.7); ConicSnake s(p, q, r); BoxMagnet c(s, 1); BoxMagnet d(s, 3); LineSnake diagonal(c, d);
    """
    ...
def IntRing(
    name: str,
    /,
    snake: _AlongSnake,
    target: _Target,
    point: _Point | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RingHandle:
    """The intersection of a curve with a plane, a surface, another curve or a sphere: C(t) on the target. From a bead it is found by damped Newton iteration; without one it is the intersection nearest to t = 0.5, and the others are reported.

    A ring is such a point on a snake.

    Parameters
    ----------
    name : str
        The name of the object.
    snake : snake or ring
        The snake, or a ring on it near the intended point.
    target : target
        A plane, surface (or magnet), curve (or bead), or the centre of a sphere.
    point : point, optional
        With a plane: selects the parallel plane through this point. With a centre: a point of
        the sphere.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    ring

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, "v", 0.4); XPlane p(1.5); IntRing r(s, p);
    """
    ...
def XYZRing(
    name: str,
    /,
    snake: _AlongSnake,
    axis: _Text,
    value: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RingHandle:
    """The point of a curve with a given coordinate x, y or z. From a bead it is found by damped Newton iteration; without one it is the point nearest to t = 0.5.

    A ring is such a point on a snake.

    Parameters
    ----------
    name : str
        The name of the object.
    snake : snake or ring
        The snake, or a ring on it near the intended point.
    axis : text
        The coordinate: "x", "y" or "z".
    value : number
        Value of the coordinate.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    ring

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, "u", 0.4); XYZRing r(s, "z", 1);
    """
    ...
def ProjRing(
    name: str,
    /,
    snake: _AlongSnake,
    point: _Point,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RingHandle:
    """The foot of the perpendicular from a point to a curve: C'(t) . (C(t) - P) = 0, where the distance is least. From a bead it is the foot found by descent; without one, the nearest of all. If the foot is beyond an end, the end is the result and is reported.

    A ring is such a point on a snake.

    Parameters
    ----------
    name : str
        The name of the object.
    snake : snake or ring
        The snake, or a ring on it near the intended point.
    point : point
        The point to project.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    ring

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, "u", 0.4); AbsPoint P(1, 3, 1); ProjRing r(s, P);
    """
    ...
def ProxRing(
    name: str,
    /,
    snake: _AlongSnake,
    point: _Point,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RingHandle:
    """The point of a curve nearest to a given point, of the whole curve and ends included. Equally near ones are reported.

    A ring is such a point on a snake.

    Parameters
    ----------
    name : str
        The name of the object.
    snake : snake or ring
        The snake, or a ring on it near the intended point.
    point : point
        The point to be near to.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    ring

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, "u", 0.4); AbsPoint P(1, 3, 1); ProxRing r(s, P);
    """
    ...
def BoxRing(
    name: str,
    /,
    snake: _Snake,
    corner: _Integer,
    edge: _Integer | None = ...,
    margin: _Number | None = ...,
    side: _Integer | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RingHandle:
    """The ring of a snake that faces a corner of the box round it: on the straight line of the parameter plane from the middle of the
    snake to the corner.

    The rings of the four corners divide the snake into the parts that face the sides of the box; side k is from corner k to the next.
    The snake begins in one of these parts, and the rings keep a distance from its beginning.

    Parameters
    ----------
    name : str
        The name of the object.
    snake : snake
        The snake.
    corner : integer
        The corner. 1 to 4.
    edge : integer, optional
        The edge of the surface on which the snake begins and ends, as of the corner's magnet.
        0: it is closed. At most 4, default 0.
    margin : number, optional
        Distance of the box from the snake, as of the corner's magnet. Default 0.5.
    side : integer, optional
        The side of the box that the beginning of a closed snake faces. 0: as it is at the
        values of the parameters. At most 4, default 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    ring

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.5, 0.5); AbsMagnet q(S, 0.6, 0.5); AbsMagnet r(S, 0.5, 0.7); ConicSnake s(p, q, r); BoxMagnet c(s, 1); BoxRing t(s, 1); LineSnake spoke(t, c);
    """
    ...
def Line(
    name: str,
    /,
    p1: _Point,
    p2: _Point,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A straight line: C(t) = (1 - t) P1 + t P2.

    Coincident points are allowed, but then the line serves no purpose that needs a direction. A line
    from a point to itself is that point: as a master it makes a pole. Lines between the same two
    points are one for meshes, and so are the straight edges of surfaces between them.

    Parameters
    ----------
    name : str
        The name of the object.
    p1 : point
        Start.
    p2 : point
        End.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); Line l(A, B);
    """
    ...
def Arc(
    name: str,
    /,
    p1: _Point,
    p2: _Point,
    p3: _Point,
    type: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A circular arc, uniform in angle.

    Six types: 1 through p1, p2 and p3; 2 from p1 about the centre p2, along the shorter arc to the
    direction of p3; 3 from p1, tangent to the line toward p2, to p3; 4 from p1 to p3, tangent there
    to the line from p2; 5 the semicircle from p1 to p2 on the side of p3; 6 the full circle from p1
    about the centre p2, starting toward the side of p3. The numbers of types 1 and 3 to 6 are
    specific to this program.

    Points in line make types 1 to 4 a straight line, which the arc approaches smoothly.

    Parameters
    ----------
    name : str
        The name of the object.
    p1 : point
        First point.
    p2 : point
        Second point.
    p3 : point
        Third point.
    type : integer, optional
        One of the six types. 1 to 6, default 1.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(1, 0, 0); AbsPoint B(0.6, 0.8, 0.1); AbsPoint C(-1, 0, 0); Arc a(A, B, C, type = 1);
    """
    ...
def BCurve(
    name: str,
    /,
    points: _Vectors,
    degree: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A B-spline curve: C(t) = sum N_i(t) P_i with clamped uniform knots (de Boor 1978).

    It begins at the first point and ends at the last, tangent to the polygon there, and is only
    attracted by the others. With N points the degree is at most N - 1: a higher one is lowered to
    that.

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of point
        Control points, two or more.
    degree : integer, optional
        Polynomial degree: 1 is a polyline, 2 quadratic, 3 cubic. 1 to 25, default 3.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); BCurve c({A, B, C, D}, degree = 2);
    """
    ...
def CCurve(
    name: str,
    /,
    points: _Vectors,
    degree: _Integer | None = ...,
    ends: _Text | None = ...,
    start: _Vector | None = ...,
    end: _Vector | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """The twice differentiable piecewise cubic interpolating spline through points, with knots at the
    cumulative chord lengths (Ahlberg, Nilson and Walsh 1967).

    With the default ends two points give a line, three a parabola, four or more a spline without
    knots at the second and the last but one point (not-a-knot). Neighbouring points must differ.

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of point
        Points of the curve, at least 2; neighbouring points must differ.
    degree : integer, optional
        3: cubic spline. 1: polyline, without end conditions. 2: the same as 3, for at most
        three points. 1 to 3, default 3.
    ends : text, optional
        Conditions at both ends: "notaknot", "natural" (zero second derivative), "bessel" (slope
        of the parabola through the three nearest points), "quadratic" (the end piece is a
        parabola), "clamped" (slopes `start` and `end`) or "periodic" (closed; the last point
        equals the first, at least 4 points). Default notaknot.
    start : vector, optional
        Slope dC/dt at the start, for clamped ends.
    end : vector, optional
        Slope dC/dt at the end, for clamped ends.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); AbsPoint E(6, 0.5, 2); CCurve c({A, B, C, D, E}); CCurve d({A, B, C, D}, ends = "clamped", start = {3, 1, 0}, end = {4, -2, 1});
    """
    ...
def XCurve(
    name: str,
    /,
    axis: object,
    points: _Vectors,
    ends: _Text | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """An explicit spline: one coordinate is linear in t; the other two are cubic splines of that
    coordinate through the points.

    That coordinate increases or decreases strictly from point to point.

    Parameters
    ----------
    name : str
        The name of the object.
    axis : value
        Coordinate linear in t: "x", "y" or "z", or 1, 2 or 3.
    points : list of point
        The points it passes through, two or more.
    ends : text, optional
        End conditions: "notaknot", "natural", "bessel", "quadratic" or "periodic". Default
        notaknot.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); XCurve c("x", {A, B, C, D}); XCurve d(1, {D, C, B, A}, ends = "natural");
    """
    ...
def NURBCurve(
    name: str,
    /,
    points: _Vectors,
    degree: _Integer | None = ...,
    knots: _Numbers | None = ...,
    weights: _Numbers | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A rational B-spline curve: C(t) = sum w_i N_i(t) P_i / sum w_i N_i(t).

    The list contains all knots, end knots included: number of points + degree + 1. Their range is
    mapped to [0, 1]. By default the knots are clamped and uniform and all weights are 1.

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of point
        Control points, two or more.
    degree : integer, optional
        Polynomial degree. 1 to 25, default 3.
    knots : list of number, optional
        Knots, end knots included, ascending.
    weights : list of number, optional
        Weights of the points, positive.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(1, 0, 0); AbsPoint B(1, 1, 0.2); AbsPoint C(0, 1, 0); NURBCurve quarter({A, B, C}, 2, weights = {1, 0.7, 1}); NURBCurve c({A, B, C}, 1, {0, 0, 0.45, 1, 1});
    """
    ...
def Conic(
    name: str,
    /,
    p1: _Point,
    p2: _Point,
    p3: _Point,
    a1: _Number | None = ...,
    a2: _Number | None = ...,
    type: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A conic section in the plane of three points: C = P1 + f(a) (P2 - P1) + g(a) (P3 - P1), where
    a = a1 + t (a2 - a1).

    Type 1 is an ellipse, f = cos a and g = sin a, with its centre at p1 and p2, p3 the ends of
    conjugate half diameters (of the half axes where they are perpendicular). Type 2 is a branch of
    a hyperbola, f = cosh a and g = sinh a, and type 3 a parabola, f = a^2 and g = a (our numbers).

    Parameters
    ----------
    name : str
        The name of the object.
    p1 : point
        Centre, or vertex of a parabola.
    p2 : point
        The point of a = 0 on an ellipse or hyperbola.
    p3 : point
        The end of the conjugate half diameter.
    a1 : number, optional
        Start of the curve. Default 0.
    a2 : number, optional
        End angle; default: a full turn. Default 6.28319.
    type : integer, optional
        1 for an ellipse, 2 for a hyperbola, 3 for a parabola. 1 to 3, default 1.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint O(0, 0, 0); AbsPoint A(3, 0, 0); AbsPoint B(0.2, 2, 1); Conic e(O, A, B, a1 = 0.25, a2 = 4); Conic h(O, A, B, -1, 1, 2); Conic p(O, A, B, -0.5, 1, type = 3);
    """
    ...
def FoilCurve(
    name: str,
    /,
    points: _Vectors,
    family: object | None = ...,
    mean: _Text | None = ...,
    camber_at: _Number | None = ...,
    load: _Number | None = ...,
    nose_index: _Number | None = ...,
    thickness_at: _Number | None = ...,
    tail: _Text | None = ...,
    offset: _Text | None = ...,
    section: _Curve | None = ...,
    ordinates: _Vectors | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A foil section between 3, 4 or 5 points: the thickness form and mean line of a NACA family,
    or given ordinates.

    Three points: nose, thickness point and tail of half a section, from nose to tail. Four:
    tail, thickness point, nose and lower tail of a symmetric section. Five: a lower thickness
    point before the lower tail; the camber is half the sum of the two signed thicknesses.
    Sections of four and five points extend from the tail along the upper side to the nose at t
    = 1/2, and back along the lower side. Only the distance of a thickness point from the chord
    matters: it is half the nominal thickness.

    The parameter is the square root of the position along the chord, so that the nose is smooth; the
    speed vanishes nowhere. Forms: NACA Reports 460, 492, 537 and 824, TM X-3069 (6-series, for the
    thickness ratio that the points have), Brockett 1966 (66tmb).

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of point
        Three, four or five points.
    family : value, optional
        Thickness form: "4-digit", "modified", "5-digit", "16", "63", "64", "65", "66", "63A",
        "64A", "65A", "66tmb" or "67", or its number in this list. Default 4-digit.
    mean : text, optional
        Mean line: "flat", "parabolic", "210" to "250", "221" to "251", "a" or "a modified"; ""
        is the default of the family.
    camber_at : number, optional
        Position of the greatest camber of the parabolic mean line, in chords. Default 0.4.
    load : number, optional
        Extent a of the uniform load of the mean line "a"; default: 0.8 for 66tmb, else 1.
    nose_index : number, optional
        Nose index of the modified form: 6 is the standard leading edge, 0 a sharp one. Default
        6.
    thickness_at : number, optional
        Position of the greatest thickness of the modified form, from 0.2 to 0.6. Default 0.3.
    tail : text, optional
        "closed" closes the trailing edge at its points, "open" keeps its thickness in the form.
        Default closed.
    offset : text, optional
        "affine" adds thickness perpendicular to the chord, "normal" perpendicular to the mean
        line. Default affine.
    section : curve, optional
        A curve of ordinates (x, half thickness, camber) from leading to trailing edge, instead
        of a family.
    ordinates : list of vector, optional
        Ordinates {x, half thickness, camber} from leading to trailing edge, instead of a
        family.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint N(0, 0, 0); AbsPoint U(0.3, 0.1, 0); AbsPoint D(0.5, -0.02, 0.01); AbsPoint T(1, 0.01, 0); FoilCurve naca4412({T, U, N, D, T}, offset = "normal"); FoilCurve half({N, U, T}, "16"); FoilCurve own({N, U, T}, ordinates = {{0, 0, 0}, {0.3, 1, 0}, {1, 0, 0}});
    """
    ...
def Helix(
    name: str,
    /,
    point: _Point,
    line: _Curve,
    angle: _Number,
    pitch: _Number | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A helix: the point rotated about the line by t angle, right-handed, and translated along it by t
    pitch angle / (2 pi), with pitch the advance per turn.

    Parameters
    ----------
    name : str
        The name of the object.
    point : point
        Start.
    line : line
        Its axis, from the line's first end to its last.
    angle : number
        Total angle of rotation.
    pitch : number, optional
        Advance per turn. Default 0.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(1, 0, 0.5); AbsPoint O(0, 0, 0); AbsPoint Z(0.1, 0, 2); Line axis(O, Z); Helix h(A, axis, 9.5, 0.75);
    """
    ...
def PolyCurve(
    name: str,
    /,
    curves: Sequence[_Curve] | _Any,
    breaks: _Numbers | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """Curves end to end: piece k of N covers t = (k - 1) / N to k / N, or the interval between given
    breaks.

    Each piece begins where the one before ends, within the model's tolerance; the direction of a
    piece is never changed. Meshes join along the pieces.

    Parameters
    ----------
    name : str
        The name of the object.
    curves : list of curve
        The curves, in order.
    breaks : list of number, optional
        Parameters of the joints, ascending between 0 and 1; default: equal intervals.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); BCurve c({A, B, C}); Line l(C, D); PolyCurve both({c, l}); PolyCurve late({c, l}, {0.7});
    """
    ...
def Join(
    name: str,
    /,
    first: _Curve,
    second: _Curve,
    tolerance: _Number | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A declared join: two coincident edges of patches count as one edge in meshes, although they are
    different objects. The result is the first edge.

    Edges are given as members: `Join j(a.v1, b.v0);` joins edge v = 1 of `a` to edge v = 0 of `b`.
    Curves and snakes along edges are accepted too; the directions may be opposite. One edge may be on a part
    of the other, at equal fractions of both: the part between the beads, rings or ends of the longer edge that
    the shorter one ends at, or the part that is given, such as a `SubCurve` between beads.
    Patches on the same curves and points join without a declaration. Edges farther apart than the tolerance at
    any point are an error; the vertices are those of the patch declared first.

    Parameters
    ----------
    name : str
        The name of the object.
    first : curve
        An edge.
    second : curve
        The other edge.
    tolerance : number, optional
        Maximum distance between the two edges; default: the model's tolerance. At least 0.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(0, 0, 2); AbsPoint D(2, 1, 2); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsPoint P(2, 1, 2); AbsPoint Q(0, 0, 2); AbsPoint E(0, 3, 2); AbsPoint F(2, 3, 2); Line p(P, Q); Line q(F, E); RuledSurf R(p, q); EdgeSnake a(3, S); EdgeSnake b(1, R); Join j(a, b);
    """
    ...
def SubCurve(
    name: str,
    /,
    bead1: _Bead,
    bead2: _Bead,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """The part of a curve between two of its beads: C(t) = P((1 - t) t1 + t t2), where P is the curve
    and t1, t2 the parameters of the beads. For t1 > t2 it runs backwards.

    Parameters
    ----------
    name : str
        The name of the object.
    bead1 : bead
        Start.
    bead2 : bead
        End, on the same curve.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); BCurve c({A, B, C, D}); AbsBead b(c, 0.9); AbsBead d(c, 0.2); SubCurve part(b, d);
    """
    ...
def BSubCurve(
    name: str,
    /,
    beads: Sequence[_Bead] | _Any,
    degree: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A curve reparametrised by a B-spline: C(t) = P(b(t)), where P is the curve of the beads and b
    the clamped uniform B-spline with their parameters as coefficients.

    It begins at the first bead and ends at the last; the others draw its divisions toward them.
    With N beads the degree is at most N - 1: a higher one is lowered to that.

    Parameters
    ----------
    name : str
        The name of the object.
    beads : list of bead
        Beads of one curve, two or more.
    degree : integer, optional
        Polynomial degree of the law. 1 to 25, default 3.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); BCurve c({A, B, C, D}); AbsBead b(c, 0.1); AbsBead d(c, 0.3); AbsBead e(c, 0.9); BSubCurve part({b, d, e}, degree = 2);
    """
    ...
def RelCurve(
    name: str,
    /,
    curve: _Curve,
    p1: _Point,
    p2: _Point,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A curve moved to new ends: C(t) = c(t) + (1 - t) (P1 - c(0)) + t (P2 - c(1)).

    Ends moved alike give a parallel copy.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        Reference curve.
    p1 : point
        Start.
    p2 : point
        End.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); AbsPoint D(0, 0, 1); AbsPoint E(3.5, 2, 1.5); RelCurve d(c, D, E);
    """
    ...
def CopyCurve(
    name: str,
    /,
    curve: _Curve,
    from_: _Point,
    to: _Point,
    sx: _Number | None = ...,
    sy: _Number | None = ...,
    sz: _Number | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A curve copied from one reference point to another and scaled along the axes: C(t) = to + (sx,
    sy, sz) (c(t) - from), component by component.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        The curve to copy.
    from : point
        The reference point that is moved to `to`.
    to : point
        The image of `from`.
    sx : number, optional
        Scale along x. Default 1.
    sy : number, optional
        Scale along y. Default 1.
    sz : number, optional
        Scale along z. Default 1.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); CopyCurve d(c, A, C, 2, 0.5, -1);
    """
    ...
def RotatCurve(
    name: str,
    /,
    curve: _Curve,
    line: _Curve,
    angle: _Number,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A curve rotated about a line by an angle, right-handed.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        The curve to turn.
    line : line
        The axis, from the line's first end to its last.
    angle : number
        The angle.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); Line axis(A, C); RotatCurve d(c, axis, 0.75);
    """
    ...
def OffsetCurve(
    name: str,
    /,
    curve: _Curve,
    distance: _Number,
    plane: _Plane,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A curve at a distance from another in a plane: C(t) = c(t) + d T x n / |T x n|, with T the
    tangent and n the normal of the plane. A positive d is to the right of the direction of travel,
    seen from the positive side of the plane.

    At an end of zero speed, such as a double control point, T is the limit from inside. Zero speed
    inside, or a distance beyond the radius of curvature on that side (a cusp of the offset), is an
    error.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        The curve that is offset.
    distance : number
        The distance.
    plane : plane
        Plane of the offset, or a plane parallel to it.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 2, 0.25); AbsPoint C(4, 0, 0); BCurve c({A, B, C}); OffsetCurve outside(c, -0.5, "z=0"); OffsetCurve inside(c, 0.25, "z=0");
    """
    ...
def BFitCurve(
    name: str,
    /,
    curve: _Curve,
    degree: _Integer | None = ...,
    points: _Integer | None = ...,
    accuracy: _Number | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A B-spline fitted to a curve by least squares, with clamped uniform knots and the same ends:
    minimises the sum of squared distances at equal parameters.

    The number of control points determines the accuracy. The member `residual` is the greatest
    distance between curve and fit at equal parameters; a residual above `accuracy` is an error.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        The curve to approximate.
    degree : integer, optional
        Polynomial degree. 1 to 25, default 3.
    points : integer, optional
        Number of control points, more than the degree. 2 to 10000, default 8.
    accuracy : number, optional
        Maximum distance between the two curves at equal parameters. At least 0.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); CCurve c({A, B, C, D}); BFitCurve fit(c, 3, 6, 0.05);
    """
    ...
def NUBFitCurve(
    name: str,
    /,
    curve: _Curve,
    degree: _Integer | None = ...,
    accuracy: _Number | None = ...,
    relabel: _Relabel | None = ...,
    *,
    knots: _Numbers,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A B-spline fitted to a curve as in BFitCurve, with given knots.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        The curve to come near to.
    degree : integer, optional
        Polynomial degree. 1 to 25, default 3.
    knots : list of number
        The parameters of the joints between pieces, from 0 to 1, each once.
    accuracy : number, optional
        The greatest distance allowed between the two at equal parameters. At least 0.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); AbsPoint D(4, 0, 1); CCurve c({A, B, C, D}); NUBFitCurve fit(c, 3, {0, 0.3, 0.55, 1});
    """
    ...
def TabCurve(
    name: str,
    /,
    file: _Text | None = ...,
    degree: _Integer | None = ...,
    points: _Vectors | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A curve through the points of a table: a CCurve or, with degree 1, a polyline.

    The file has a point in a line: x, y, z (or x, y) with blanks or commas between.

    Parameters
    ----------
    name : str
        The name of the object.
    file : text, optional
        The file, relative to the program that declares the curve.
    degree : integer, optional
        3 for a cubic spline, 1 for a polyline. 1 to 3, default 3.
    points : list of vector, optional
        The points, where there is no file.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        TabCurve c(points = {{0, 0, 0}, {1, 2, 0.5}, {3, 2, 1}, {4, 0, 1}}); TabCurve lines(degree = 1, points = {{0, 0, 0}, {1, 2, 0.5}, {3, 2, 1}});
    """
    ...
def ProcCurve(
    name: str,
    /,
    bead: _Bead,
    point: _Point,
    t1: _Number | None = ...,
    t2: _Number | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """The locus of a point when a bead that it depends on sweeps its curve: C(t) is where `point` is with
    `bead` at the parameter t1 + t (t2 - t1).

    Everything between bead and point is evaluated at each sample. The curve is a chain of
    polynomials through such samples, halved until they agree to about 1e-12 of its size;
    derivatives with respect to the model's variables are those of the samples. The bead's own
    parameter has no influence.

    Parameters
    ----------
    name : str
        The name of the object.
    bead : bead
        The bead that moves.
    point : point
        The point that follows.
    t1 : number, optional
        Start of the bead. Default 0.
    t2 : number, optional
        End. Default 1.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); AbsBead b(c, 0.5); Line l(A, C); ProjPoint foot(b, l); BlendPoint m({b, foot}); ProcCurve way(b, m);
    """
    ...
def TanCurve(
    name: str,
    /,
    curve: _Curve,
    distance: _Number,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """The curve of points on the tangents of another curve, at a distance from the point of contact:
    C(t) = c(t) + d c'(t) / |c'(t)|; the TanPoint of all beads.

    A corner of the curve, where the tangent jumps, is an error.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        Curve of the tangents.
    distance : number
        The distance, in the direction of increasing parameter if positive.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); TanCurve ahead(c, 0.5); TanCurve behind(c, -0.25);
    """
    ...
def MirrCurve(
    name: str,
    /,
    curve: _Curve,
    mirror: _Mirror,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """The mirror image of a curve in a plane, line or point, point by point: C(t) = 2 F(t) - P(t),
    with F the foot of the perpendicular from P.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        The curve to mirror.
    mirror : mirror
        The mirror: a plane, line or point.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 1, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); MirrCurve port(c, "y=0");
    """
    ...
def ProjCurve(
    name: str,
    /,
    curve: _Curve,
    mirror: _Target,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """The projection of a curve onto a plane, line, point, surface or the zero set of a field, point by point, as a curve in
    space.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        The curve to project.
    mirror : target
        The target of the projection.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 1, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); ProjCurve flat(c, "z=0");
    """
    ...
def Intersection(
    name: str,
    /,
    surface: _Onto,
    target: _Target,
    start: _Magnet | None = ...,
    end: _Magnet | None = ...,
    point: _Point | None = ...,
    branch: Sequence[_Integer] | _Array | _Any | None = ...,
    along: _Text | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """The intersection of two surfaces, or of a surface with a plane or the zero set of a field: one
    curve, the same on either surface. Its parameter is the fraction of its length.

    `IntSnake(a, x)` is the intersection `x` as a snake on its surface `a`. The snakes on both surfaces
    are `x` itself from end to end, so panels on both sides share its vertices. A body of several surfaces
    side by side is one `PolySurf`.

    A magnet selects the branch nearest to it; a surface, the branch nearest to the middle of the
    parameters of the surface declared first. Other branches are reported. `branch = {1, 2}` is the first of two branches
    in the order along u of the surface that is given first (`along = "v"`: along v), at all values of the parameters:
    where there is another number of branches, or another one beside it, an error says so. The direction is n1 x n2, the product of both
    normals. The curve extends from edge to edge, or from the magnet `start` to the magnet `end`, each on either
    surface and on the intersection, which keep their identity, so that patches join. A closed branch begins at
    the point nearest to the magnet or, without one, to S(0.3, 0.4) of the surface declared first. Each point
    is on both shapes to rounding.

    All branches are found that are longer than 2 % of the size and somewhere cross at an angle
    larger than the shapes turn within that length; of two branches closer than that all along, one
    may be missed. Shapes that only touch have no intersection.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface or magnet
        The surface, or a magnet on it near the intended branch.
    target : target
        The plane, the other surface (or a magnet on it), or the field with the zero set.
    start : magnet, optional
        Start: a magnet or ring on the intersection. Default: the start of the branch.
    end : magnet, optional
        End.
    point : point, optional
        With a plane: selects the parallel plane through this point.
    branch : list of integer, optional
        The branch as {number, count}: its number in the order along a parameter of the surface
        that is given first, and the number of all branches.
    along : text, optional
        The parameter of that order, "u" or "v".
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m, visible = 0); AbsPoint E(2, -1, -2); AbsPoint F(2, 4, -2); AbsPoint G(3, -1, 4); AbsPoint H(2, 4, 4); Line n(E, F); Line o(G, H); RuledSurf T(n, o, visible = 0); Intersection x(S, T); IntSnake a(S, x); IntSnake b(T, x); EdgeSnake hem(4, S); EdgeSnake rim(3, T); SubSurf half({hem, a}); SubSurf web({b, rim}); AbsBead p(x, 0.5); XPlane y(1); Intersection c(S, y);
    """
    ...
def BodyIntersection(
    name: str,
    /,
    faces1: Sequence[_Surface] | _Any,
    faces2: Sequence[_Surface] | _Any,
    near: _Point | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """The intersection of two bodies, each a list of surfaces side by side: one curve from face to face, the same on
    both bodies. Its parameter is the fraction of its length, its joints are on the edges of the faces.

    `IntSnake(face, x)` is the part of the intersection `x` on one of the faces; patches there share its vertices with those of the
    other body. Where `x` returns to a face, a magnet on the face selects the nearest part. Of several curves, `near` selects the
    nearest to a point, by default to the middle of the first face; the others are reported. The curve begins with the first
    pair of faces in the order of the lists, in the direction n1 x n2 of their normals.

    Faces of a body meet in common edges: pieces that end in one point, within the tolerance of the model, continue each
    other. The curve is open where a body is.

    Parameters
    ----------
    name : str
        The name of the object.
    faces1 : list of surface
        The faces of one body.
    faces2 : list of surface
        The faces of the other.
    near : point, optional
        A point near the intended curve.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, -2, -2); AbsPoint B(0, 2, -2); AbsPoint C(0, -2, 2); AbsPoint D(0, 2, 2); Line ab(A, B); Line cd(C, D); RuledSurf wall(ab, cd, visible = 0); AbsPoint P(-1, -1, -1); AbsPoint Q(-1, 1, -1); AbsPoint R(-1, 0, 1); AbsPoint S(2, -1, -1); AbsPoint T(2, 1, -1); AbsPoint U(2, 0, 1); Line p(P, S); Line q(Q, T); Line r(R, U); RuledSurf f1(p, q, visible = 0); RuledSurf f2(q, r, visible = 0); RuledSurf f3(r, p, visible = 0); BodyIntersection x({f1, f2, f3}, {wall}); IntSnake hole(wall, x); IntSnake rim(f1, x); TrimSurf plate(wall, {hole}, whole = 1); EdgeSnake far(2, f1); SubSurf tube({rim, far});
    """
    ...
def LineSnake(
    name: str,
    /,
    m1: _Magnet,
    m2: _Magnet,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """The curve on a surface that is straight in the parameter plane:
    X(t) = S((1 - t) w1 + t w2), with w1, w2 the parameters of two magnets.

    Parameters
    ----------
    name : str
        The name of the object.
    m1 : magnet
        Start.
    m2 : magnet
        End, on the same surface.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.9, 0.8); LineSnake s(p, q);
    """
    ...
def BSnake(
    name: str,
    /,
    magnets: Sequence[_Magnet] | _Any,
    degree: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """The curve on a surface that is a B-spline in the parameter plane:
    X(t) = S(sum N_i(t) w_i), with w_i the parameters of the magnets and clamped uniform knots.

    With N magnets the degree is at most N - 1: a higher one is lowered to that.

    Parameters
    ----------
    name : str
        The name of the object.
    magnets : list of magnet
        Magnets of one surface, two or more.
    degree : integer, optional
        Polynomial degree of the path. 1 to 25, default 3.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.9, 0.3); AbsMagnet r(S, 0.8, 0.9); BSnake s({p, q, r}, degree = 2);
    """
    ...
def EdgeSnake(
    name: str,
    /,
    edge: _Integer,
    surface: _Surface,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """An edge of a surface, in the direction of increasing parameter.

    Parameters
    ----------
    name : str
        The name of the object.
    edge : integer
        The edge: 1 is v = 0, 2 is u = 1, 3 is v = 1, 4 is u = 0. 1 to 4.
    surface : surface
        The surface.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); EdgeSnake s(2, S);
    """
    ...
def ContactSnake(
    name: str,
    /,
    fillet: _Surface,
    side: _Integer,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """The contact line of a fillet with one of its two surfaces: a snake on that surface and an edge
    of the fillet.

    Its parameter is the fillet's u. A part of the surface bounded by it (`SubSurf`, `TrimSurf`)
    shares the fillet's vertices, which are the rings at t = 0 and 1. It crosses the seam of a
    closed surface, where its parameter jumps from 1 to 0; the magnet of the fillet chooses the
    start of the path of a ball that rolls round the whole surface, and a start at the seam avoids
    the jump.

    Parameters
    ----------
    name : str
        The name of the object.
    fillet : surface
        The fillet: a RollFillet or a FilletSurf.
    side : integer
        1 for its first surface, 2 for its second. 1 to 2.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0.2); AbsPoint D(4, 3, 0); AbsPoint E(0, 2.5, -1); AbsPoint F(4, 2, -1); AbsPoint G(0, 2.5, 3); AbsPoint H(4, 2.25, 3); Line a(A, B); Line b(C, D); RuledSurf floor(a, b, visible = 0); Line c(E, F); Line d(G, H); RuledSurf wall(c, d, visible = 0); RollFillet S(floor, wall, 0.8); ContactSnake low(S, 1); ContactSnake high(S, 2); EdgeSnake front(1, floor); EdgeSnake top(3, wall); SubSurf deck({front, low}); SubSurf bulkhead({high, top});
    """
    ...
def UVSnake(
    name: str,
    /,
    surface: _Surface,
    parameter: _Text,
    value: _Number,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """A parameter line of a surface: X(t) = S(value, t), or X(t) = S(t, value).

    At the values 0 and 1 it is the edge of the surface itself and joins in meshes.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The surface.
    parameter : text
        Constant parameter, "u" or "v".
    value : number
        Value of the constant parameter.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); UVSnake r(S, "u", 0.4); UVSnake s(S, "v", 0.25);
    """
    ...
def ArcSnake(
    name: str,
    /,
    m1: _Magnet,
    m2: _Magnet,
    m3: _Magnet,
    type: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """A circular arc in the parameter plane of a surface, of the six types of an arc.

    Parameters
    ----------
    name : str
        The name of the object.
    m1 : magnet
        First magnet.
    m2 : magnet
        Second magnet, on the same surface.
    m3 : magnet
        Third magnet, on the same surface.
    type : integer, optional
        One of the six types. 1 to 6, default 1.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.5, 0.3); AbsMagnet r(S, 0.8, 0.2); ArcSnake s(p, q, r);
    """
    ...
def CSnake(
    name: str,
    /,
    magnets: Sequence[_Magnet] | _Any,
    degree: _Integer | None = ...,
    ends: _Text | None = ...,
    start: _Vector | None = ...,
    end: _Vector | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """An interpolating spline in the parameter plane of a surface, as a C-curve.

    Parameters
    ----------
    name : str
        The name of the object.
    magnets : list of magnet
        Magnets of one surface, two or more.
    degree : integer, optional
        3 for the cubic spline, 1 for a polyline. 1 to 3, default 3.
    ends : text, optional
        End conditions: "notaknot", "natural", "bessel", "quadratic", "clamped" or "periodic".
        Default notaknot.
    start : vector, optional
        Slope {du/dt, dv/dt, 0} at the start, for clamped ends.
    end : vector, optional
        Slope {du/dt, dv/dt, 0} at the end, for clamped ends.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.5, 0.3); AbsMagnet r(S, 0.8, 0.2); CSnake s({p, q, r}); CSnake t({p, q, r}, ends = "clamped", start = {1, 1, 0}, end = {1, -0.5, 0});
    """
    ...
def NURBSnake(
    name: str,
    /,
    magnets: Sequence[_Magnet] | _Any,
    degree: _Integer | None = ...,
    knots: _Numbers | None = ...,
    weights: _Numbers | None = ...,
    places: _Numbers | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """A rational B-spline in the parameter plane of a surface, as a NURB-curve.

    Parameters
    ----------
    name : str
        The name of the object.
    magnets : list of magnet
        Magnets of one surface, two or more.
    degree : integer, optional
        Polynomial degree. 1 to 25, default 3.
    knots : list of number, optional
        Knots, end knots included, ascending.
    weights : list of number, optional
        Weights of the magnets, positive; those of `places` are between those of the two
        magnets.
    places : list of number, optional
        Control points between the first and the second magnet that are not objects, as u, v, u,
        v, ...; there are no other magnets then.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.5, 0.3); AbsMagnet r(S, 0.8, 0.2); NURBSnake s({p, q, r}, 2, weights = {1, 0.7, 1}); NURBSnake w({p, r}, 2, places = {0.5, 0.3});
    """
    ...
def ConicSnake(
    name: str,
    /,
    m1: _Magnet,
    m2: _Magnet,
    m3: _Magnet,
    a1: _Number | None = ...,
    a2: _Number | None = ...,
    type: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """A conic section in the parameter plane of a surface, as a conic.

    Parameters
    ----------
    name : str
        The name of the object.
    m1 : magnet
        Centre, or vertex of a parabola.
    m2 : magnet
        The point of angle 0 on an ellipse or hyperbola, on the same surface.
    m3 : magnet
        The end of the conjugate half diameter, on the same surface.
    a1 : number, optional
        Start of the snake. Default 0.
    a2 : number, optional
        End angle; default: a full turn. Default 6.28319.
    type : integer, optional
        1 for an ellipse, 2 for a hyperbola, 3 for a parabola. 1 to 3, default 1.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet p(S, 0.5, 0.5); AbsMagnet q(S, 0.8, 0.4); AbsMagnet r(S, 0.6, 0.7); ConicSnake s(p, q, r, 0.5, 5);
    """
    ...
def FoilSnake(
    name: str,
    /,
    magnets: Sequence[_Magnet] | _Any,
    family: object | None = ...,
    mean: _Text | None = ...,
    camber_at: _Number | None = ...,
    load: _Number | None = ...,
    nose_index: _Number | None = ...,
    thickness_at: _Number | None = ...,
    tail: _Text | None = ...,
    offset: _Text | None = ...,
    section: _Curve | None = ...,
    ordinates: _Vectors | None = ...,
    metric: _Vector | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """A foil section in the parameter plane of a surface, between 3, 4 or 5 magnets, as a foil curve.

    The section is a true foil in space only if the surface is a scaled plane. On a cylinder
    with u the angle and v a length, `metric` = {radius^2, 0, 1} makes the thickness
    perpendicular to the chord on the unrolled surface.

    Parameters
    ----------
    name : str
        The name of the object.
    magnets : list of magnet
        Three, four or five magnets of one surface.
    family : value, optional
        Thickness form: "4-digit", "modified", "5-digit", "16", "63", "64", "65", "66", "63A",
        "64A", "65A", "66tmb" or "67", or its number in this list. Default 4-digit.
    mean : text, optional
        Mean line: "flat", "parabolic", "210" to "250", "221" to "251", "a" or "a modified"; ""
        is the default of the family.
    camber_at : number, optional
        Position of the greatest camber of the parabolic mean line, in chords. Default 0.4.
    load : number, optional
        Extent a of the uniform load of the mean line "a"; default: 0.8 for 66tmb, else 1.
    nose_index : number, optional
        Nose index of the modified form: 6 is the standard leading edge, 0 a sharp one. Default
        6.
    thickness_at : number, optional
        Position of the greatest thickness of the modified form, from 0.2 to 0.6. Default 0.3.
    tail : text, optional
        "closed" closes the trailing edge at its points, "open" keeps its thickness in the form.
        Default closed.
    offset : text, optional
        "affine" adds thickness perpendicular to the chord, "normal" perpendicular to the mean
        line. Default affine.
    section : curve, optional
        A curve of ordinates (x, half thickness, camber) from leading to trailing edge, instead
        of a family.
    ordinates : list of vector, optional
        Ordinates {x, half thickness, camber} from leading to trailing edge, instead of a
        family.
    metric : vector, optional
        Metric of the parameter plane: {uu, uv, vv}; default: {1, 0, 1}.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet n(S, 0.2, 0.4); AbsMagnet u(S, 0.4, 0.55); AbsMagnet d(S, 0.5, 0.4); AbsMagnet t(S, 0.9, 0.5); FoilSnake root({t, u, n, d, t}); FoilSnake half({n, u, t}, "16", metric = {16, 1, 5});
    """
    ...
def RelSnake(
    name: str,
    /,
    snake: _Snake,
    m1: _Magnet,
    m2: _Magnet,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """A snake moved to new ends in the parameter plane: w(t) + (1 - t) (w1 - w(0)) + t (w2 - w(1)).

    Parameters
    ----------
    name : str
        The name of the object.
    snake : snake
        Reference snake.
    m1 : magnet
        Start, on the same surface.
    m2 : magnet
        End, on the same surface.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.5, 0.3); AbsMagnet r(S, 0.8, 0.2); BSnake s({p, q, r}); AbsMagnet a(S, 0.2, 0.5); AbsMagnet b(S, 0.9, 0.7); RelSnake t(s, a, b);
    """
    ...
def CopySnake(
    name: str,
    /,
    snake: _Snake,
    surface: _Surface,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """The snake of another surface with the same path in the parameter plane: X = S(w(t)).

    Parameters
    ----------
    name : str
        The name of the object.
    snake : snake
        Snake with the path.
    surface : surface
        The target surface.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); RuledSurf T(m, l); AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.8, 0.3); LineSnake s(p, q); CopySnake t(s, T);
    """
    ...
def PolySnake(
    name: str,
    /,
    snakes: Sequence[_Snake] | _Any,
    breaks: _Numbers | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """Snakes of one surface end to end, which is a snake again: as a poly-curve.

    The pieces must meet in the parameter plane: one that crosses the seam of a closed surface is
    refused.

    Parameters
    ----------
    name : str
        The name of the object.
    snakes : list of snake
        The snakes, in order.
    breaks : list of number, optional
        Parameters of the joints, ascending between 0 and 1; default: equal intervals.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet p(S, 0.1, 0.2); AbsMagnet q(S, 0.9, 0.1); AbsMagnet r(S, 0.8, 0.9); LineSnake s(p, q); LineSnake t(q, r); PolySnake both({s, t});
    """
    ...
def ProjSnake(
    name: str,
    /,
    curve: _Curve,
    surface: _Onto,
    mirror: _Mirror | None = ...,
    ends: Sequence[_Magnet] | _Any | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """The projection of a curve onto a surface, point by point, as a snake: along the surface's
    normals, along a direction, or away from a point.

    The foot of the start of the curve is found first, near the magnet if one is given; the
    projection follows the curve from there continuously. Each of its points is on the surface and
    is the projection to rounding. A projection that leaves the surface or is tangent to it is an
    error.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        The curve to project.
    surface : surface or magnet
        The surface, or a magnet on it near the projection of the start of the curve.
    mirror : mirror, optional
        Direction of projection: a plane's normal, a line's direction, or rays from a point.
        Default: the surface's own normals.
    ends : list of magnet, optional
        Magnets at the two ends, shared with other snakes so that patches join there.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsPoint P(1, 1, 2); AbsPoint Q(3, 1, 2); AbsPoint R(2, 1.2, 2.5); BCurve c({P, R, Q}); ProjSnake s(c, S); ProjSnake t(c, S, "z=0"); AbsPoint eye(2, 1.5, 8); ProjSnake u(c, S, eye);
    """
    ...
def IntSnake(
    name: str,
    /,
    surface: _Onto,
    target: _Target,
    start: _Magnet | None = ...,
    end: _Magnet | None = ...,
    point: _Point | None = ...,
    branch: Sequence[_Integer] | _Array | _Any | None = ...,
    along: _Text | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """The intersection of a surface with a plane, another surface or the zero set of a field, as a
    snake on the surface: [`Intersection`] on one of its surfaces.

    `IntSnake(a, x)` is the intersection `x` on its surface `a`. Otherwise the arguments are those of the
    intersection: `IntSnake(a, b)` and `IntSnake(b, a)` are one curve in opposite directions, which patches on both
    sides share. At the seam of a closed surface the parameter jumps between 0 and 1.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface or magnet
        The surface of the snake, or a magnet on it near the intended branch.
    target : target
        The plane, the other surface (or a magnet on it), the field with the zero set, or an
        intersection on the surface.
    start : magnet, optional
        Start: a magnet or ring on the intersection. Default: the start of the branch.
    end : magnet, optional
        End.
    point : point, optional
        With a plane: selects the parallel plane through this point.
    branch : list of integer, optional
        The branch as {number, count}: its number in the order along a parameter of the surface
        that is given first, and the number of all branches.
    along : text, optional
        The parameter of that order, "u" or "v".
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 1); Line l(A, B); Line m(C, D); RuledSurf S(l, m); ZPlane z(0.5); IntSnake w(S, z); AbsPoint E(2, -1, -2); AbsPoint F(2, 4, -2); AbsPoint G(3, -1, 4); AbsPoint H(2, 4, 4); Line n(E, F); Line o(G, H); RuledSurf T(n, o); IntSnake x(S, T); IntRing r(x, "y=0", {0, 1, 0}); AbsMagnet near(S, 0.5, 0.5); IntSnake y(near, T, start = r);
    """
    ...
def GeoSnake(
    name: str,
    /,
    m1: _Magnet,
    m2: _Magnet,
    turns_u: _Integer | None = ...,
    turns_v: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """The shortest path on a surface between two magnets, more exactly a geodesic: a curve of zero
    geodesic curvature. Its parameter t is the fraction of its length.

    Of several geodesics it is the one found by Newton's method from the straight line of the
    parameter plane: on surfaces with little curvature between the magnets, the shortest. On a
    closed surface those across its seam are tried too, and the shortest is the result (of equal
    ones, the one inside the seam); `turns_u` and `turns_v` select another. At the seam the
    parameter on the surface jumps between 0 and 1.

    Parameters
    ----------
    name : str
        The name of the object.
    m1 : magnet
        Start.
    m2 : magnet
        End, on the same surface.
    turns_u : integer, optional
        Number of crossings of the seam u = 0, forwards if positive, backwards if negative.
        Default: the shortest path with 0, 1 or -1. -10 to 10.
    turns_v : integer, optional
        Number of forward crossings of the seam v = 0; see `turns_u`. -10 to 10.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet p(S, 0.2, 0.1); AbsMagnet q(S, 0.9, 0.8); GeoSnake s(p, q); AbsPoint O(0, 0, -4); AbsPoint X(4, 0, -4); Line axis(O, X); AbsPoint F(0, 0, -3); AbsPoint G(4, 0, -3.5); Line k(F, G); RevSurf R(k, axis); AbsMagnet a(R, 0.1, 0.3); AbsMagnet b(R, 0.9, 0.9); GeoSnake g(a, b); GeoSnake round(a, b, turns_v = 1);
    """
    ...
def SubSnake(
    name: str,
    /,
    ring1: _Ring,
    ring2: _Ring,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """The part of a snake between two of its rings, which is a snake again: as a sub-curve.

    Parameters
    ----------
    name : str
        The name of the object.
    ring1 : ring
        Start.
    ring2 : ring
        End, on the same snake.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, "u", 0.4); AbsRing r(s, 0.9); AbsRing q(s, 0.25); SubSnake part(r, q);
    """
    ...
def BSubSnake(
    name: str,
    /,
    rings: Sequence[_Ring] | _Any,
    degree: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """A snake reparametrised by a B-spline; the counterpart of a B-sub-curve.

    Parameters
    ----------
    name : str
        The name of the object.
    rings : list of ring
        Rings of one snake, two or more.
    degree : integer, optional
        Polynomial degree of the law. 1 to 25, default 3.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); UVSnake s(S, "u", 0.4); AbsRing r(s, 0.9); AbsRing q(s, 0.75); AbsRing p(s, 0.25); BSubSnake part({r, q, p}, degree = 2);
    """
    ...
def RuledSurf(
    name: str,
    /,
    c1: _Curve,
    c2: _Curve,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """Straight rulings between two curves: S(u, v) = (1 - v) C1(u) + v C2(u).

    Parameters
    ----------
    name : str
        The name of the object.
    c1 : curve
        Edge v = 0.
    c2 : curve
        Edge v = 1.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m);
    """
    ...
def BLoftSurf(
    name: str,
    /,
    curves: Sequence[_Curve] | _Any,
    degree: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A surface that approximates its master curves: S(u, v) = sum N_i(v) C_i(u), with N_i the
    B-splines of clamped uniform knots. It interpolates only the first and the last master.

    With N masters the degree is at most N - 1: a higher one is lowered to that (Letcher and Shook
    1995).

    Parameters
    ----------
    name : str
        The name of the object.
    curves : list of curve
        Master curves, two or more, in order of v.
    degree : integer, optional
        Polynomial degree across the masters. 1 to 25, default 3.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 2); AbsPoint B(1, 0, -1); AbsPoint C(4, 2, 2); AbsPoint D(4, 1.5, -1); AbsPoint E(4, 0, -1.5); AbsPoint F(8, 1.5, 2); AbsPoint G(8, 0, -0.5); Line a(A, B); BCurve b({C, D, E}); Line c(F, G); BLoftSurf S({a, b, c}, degree = 2);
    """
    ...
def CLoftSurf(
    name: str,
    /,
    curves: Sequence[_Curve] | _Any,
    degree: _Integer | None = ...,
    ends: _Text | None = ...,
    start: _Vector | None = ...,
    end: _Vector | None = ...,
    about: _Curve | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A surface that interpolates its master curves: S(u, v) is the interpolating spline through the
    points C_1(u) ... C_N(u), evaluated at v; its knots are their chord lengths at that u.

    Two masters give rulings, three parabolas, four or more cubic splines, as for a C-curve (Letcher
    and Shook 1995). Neighbouring masters must not meet, unless all meet in one point.

    Parameters
    ----------
    name : str
        The name of the object.
    curves : list of curve
        Master curves, two or more, in order of v.
    degree : integer, optional
        3 for cubic splines across the masters, 1 for polylines. 1 to 3, default 3.
    ends : text, optional
        End conditions: "notaknot", "natural", "bessel", "quadratic", "clamped" or "periodic".
        Default notaknot.
    start : vector, optional
        Slope dX/dv at the first master, constant along it, for clamped ends.
    end : vector, optional
        Slope dX/dv at the last master, constant along it, for clamped ends.
    about : line, optional
        A line for lofting in cylindrical coordinates: r, theta (less than half a turn between
        masters) and the length along the line, as for blades.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 2); AbsPoint B(1, 0, -1); AbsPoint C(4, 2, 2); AbsPoint D(4, 1.5, -1); AbsPoint E(4, 0, -1.5); AbsPoint F(8, 1.5, 2); AbsPoint G(8, 0, -0.5); Line a(A, B); BCurve b({C, D, E}); Line c(F, G); CLoftSurf hull({a, b, c}, divisions = {6, 8}); AbsPoint O(0, -5, 0); AbsPoint X(2, -5, 0); Line shaft(O, X); Line p({0, -5, 1}, {0, -5, 3}); Line q({1, -4.6, 0.9}, {1.2, -4, 2.8}); Line r({2, -4.3, 0.7}, {2.4, -3.2, 2.4}); CLoftSurf blade({p, q, r}, about = shaft);
    """
    ...
def XLoftSurf(
    name: str,
    /,
    axis: _Integer | None = ...,
    ends: _Text | None = ...,
    about: _Curve | None = ...,
    relabel: _Relabel | None = ...,
    *,
    curves: Sequence[_Curve] | _Any,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A surface that interpolates its master curves by an explicit spline at each u: one coordinate is
    linear in v, the others are cubic splines of that coordinate.

    Unlike those of a C-loft its knots are that coordinate of the masters, which must increase or
    decrease from master to master at every u.

    Parameters
    ----------
    name : str
        The name of the object.
    axis : integer, optional
        The independent coordinate: 1 for x, 2 for y, 3 for z; with `about` 1 for r, 2 for
        theta, 3 for the length along the line. 1 to 3, default 1.
    curves : list of curve
        Master curves, two or more, in order of v.
    ends : text, optional
        End conditions: "notaknot", "natural", "bessel" or "quadratic". Default notaknot.
    about : line, optional
        A line about which the loft is made in cylinder coordinates, r, theta (within half a
        turn from master to master) and the length along it, as for blades.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 2); AbsPoint B(1, 0, -1); AbsPoint C(4, 2, 2); AbsPoint D(4, 1.5, -1); AbsPoint E(4, 0, -1.5); AbsPoint F(8, 1.5, 2); AbsPoint G(8, 0, -0.5); AbsPoint H(9, 1, 2); AbsPoint I(9.5, 0, 0); Line a(A, B); BCurve b({C, D, E}); Line c(F, G); Line d(H, I); XLoftSurf hull(1, {a, b, c, d}); AbsPoint O(0, -5, 0); AbsPoint X(2, -5, 0); Line shaft(O, X); Line p({0, -5, 1}, {0, -5, 3}); Line q({1, -4.6, 0.9}, {1.2, -4, 2.8}); Line r({2, -4.3, 0.7}, {2.4, -3.2, 2.4}); XLoftSurf blade(3, {r, q, p}, about = shaft);
    """
    ...
def ArcLoftSurf(
    name: str,
    /,
    c1: _Curve,
    c2: _Curve,
    c3: _Curve,
    type: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A surface of circular arcs by three curves: at each u the arc, of a type as for `Arc`, by the
    three points of the curves at u.

    If the three points are collinear, types 1, 3 and 4 are straight for a second point between the
    others and have no finite radius for one outside, and types 5 and 6 have no plane: such u are an
    error that names u.

    Parameters
    ----------
    name : str
        The name of the object.
    c1 : curve
        The curve of the first points.
    c2 : curve
        The curve of the second points.
    c3 : curve
        The curve of the third points.
    type : integer, optional
        One of the six types of `Arc`. 1 to 6, default 1.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(0, 1, 1); AbsPoint C(0, 2, 0); AbsPoint D(4, 0, 0.5); AbsPoint E(4, 1.5, 2); AbsPoint F(4, 2.5, 0); AbsPoint G(2, 1, 2); Line a(A, D); BCurve b({B, G, E}, 2); Line c(C, F); ArcLoftSurf roof(a, b, c); ArcLoftSurf sector(a, b, c, 2); ArcLoftSurf tangent(a, b, c, 3); ArcLoftSurf late(a, b, c, 4); ArcLoftSurf half(a, c, b, 5); ArcLoftSurf pipe(a, b, c, 6);
    """
    ...
def BSurf(
    name: str,
    /,
    points: _Vectors,
    nu: _Integer,
    nv: _Integer,
    degree_u: _Integer | None = ...,
    degree_v: _Integer | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A B-spline surface of a net of points: S(u, v) = sum N_i(u) N_j(v) P_ij, with clamped uniform
    knots (de Boor 1978).

    It passes through the four corner points and is attracted by the others. A degree that the net
    is too small for is lowered to the number of points less one.

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of point
        Net of points, v running fastest: nu rows of nv points.
    nu : integer
        Points along u. At least 2.
    nv : integer
        Points along v. At least 2.
    degree_u : integer, optional
        Polynomial degree in u. 1 to 25, default 3.
    degree_v : integer, optional
        Polynomial degree in v. 1 to 25, default 3.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(0, 1, 1); AbsPoint C(1, 0, 1); AbsPoint D(1, 1, 0); BSurf S({A, B, C, D}, nu = 2, nv = 2, degree_u = 1, degree_v = 1);
    """
    ...
def NURBSurf(
    name: str,
    /,
    points: _Vectors,
    nu: _Integer,
    nv: _Integer,
    degree_u: _Integer | None = ...,
    degree_v: _Integer | None = ...,
    weights: _Numbers | None = ...,
    knots_u: _Numbers | None = ...,
    knots_v: _Numbers | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A rational B-spline surface (NURBS) of a net of points: S(u, v) = sum w_ij N_i(u) N_j(v) P_ij /
    sum w_ij N_i(u) N_j(v) (Piegl and Tiller 1997, equation 4.11).

    Knot vectors list every knot, end knots included: nu + degree_u + 1 of them, ascending; they are
    scaled to [0, 1]. By default knots are clamped and uniform, and weights are 1.

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of point
        Net of points, v running fastest: nu rows of nv points.
    nu : integer
        Points along u. At least 2.
    nv : integer
        Points along v. At least 2.
    degree_u : integer, optional
        Polynomial degree in u. 1 to 25, default 3.
    degree_v : integer, optional
        Polynomial degree in v. 1 to 25, default 3.
    weights : list of number, optional
        Positive weights in the order of the points; default: all 1.
    knots_u : list of number, optional
        Knots in u: nu + degree_u + 1 ascending numbers; default: uniform.
    knots_v : list of number, optional
        Knots in v: nv + degree_v + 1 ascending numbers; default: uniform.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(1, 0, 0); AbsPoint B(1, 1, 0); AbsPoint C(0, 1, 0.2); AbsPoint D(2, 0, 1); AbsPoint E(2, 2, 1.5); AbsPoint F(0, 2, 1); AbsPoint G(1, 0, 3); AbsPoint H(1, 1, 2); AbsPoint I(0, 1, 3); NURBSurf S({A, B, C, D, E, F}, nu = 2, nv = 3, degree_u = 1, degree_v = 2, weights = {1, 0.7071, 1, 1, 0.7071, 1}); NURBSurf T({A, B, C, D, E, F, G, H, I}, nu = 3, nv = 3, degree_u = 1, degree_v = 2, knots_u = {0, 0, 0.25, 1, 1}, knots_v = {0, 0, 0, 2, 2, 2});
    """
    ...
def FoilLoftSurf(
    name: str,
    /,
    curves: Sequence[_Curve] | _Any,
    family: object | None = ...,
    mean: _Text | None = ...,
    camber_at: _Number | None = ...,
    load: _Number | None = ...,
    nose_index: _Number | None = ...,
    thickness_at: _Number | None = ...,
    tail: _Text | None = ...,
    offset: _Text | None = ...,
    section: _Curve | None = ...,
    ordinates: _Vectors | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """Foil sections between points of three, four or five curves: at each u a section, as in
    `FoilCurve`. A wing, a keel, a blade.

    With three curves (nose, thickness, tail) v goes from nose to tail; with four (upper tail,
    thickness, nose, lower tail) or five (a lower thickness before the lower tail) from the
    upper tail to the nose at v = 1/2, and back. Sections of the 6-series have the form of the
    thickness ratio at u. If all curves meet in a point, the wing ends in it; elsewhere nose and
    tail must be distinct.

    Parameters
    ----------
    name : str
        The name of the object.
    curves : list of curve
        Three, four or five curves.
    family : value, optional
        Thickness form: "4-digit", "modified", "5-digit", "16", "63", "64", "65", "66", "63A",
        "64A", "65A", "66tmb" or "67", or its number in this list. Default 4-digit.
    mean : text, optional
        Mean line: "flat", "parabolic", "210" to "250", "221" to "251", "a" or "a modified"; ""
        is the default of the family.
    camber_at : number, optional
        Position of the greatest camber of the parabolic mean line, in chords. Default 0.4.
    load : number, optional
        Extent a of the uniform load of the mean line "a"; default: 0.8 for 66tmb, else 1.
    nose_index : number, optional
        Nose index of the modified form: 6 is the standard leading edge, 0 a sharp one. Default
        6.
    thickness_at : number, optional
        Position of the greatest thickness of the modified form, from 0.2 to 0.6. Default 0.3.
    tail : text, optional
        "closed" closes the trailing edge at its points, "open" keeps its thickness in the form.
        Default closed.
    offset : text, optional
        "affine" adds thickness perpendicular to the chord, "normal" perpendicular to the mean
        line. Default affine.
    section : curve, optional
        A curve of ordinates (x, half thickness, camber) from leading to trailing edge, instead
        of a family.
    ordinates : list of vector, optional
        Ordinates {x, half thickness, camber} from leading to trailing edge, instead of a
        family.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint N(0, 0, 0); AbsPoint U(0.4, 0.12, 0); AbsPoint T(1, 0, 0.01); AbsPoint O(0.5, 0, 3); AbsPoint V(0.7, 0.05, 3); AbsPoint W(1.1, -0.03, 3); AbsPoint D(0.4, -0.05, 0); AbsPoint E(0.7, -0.04, 3); Line nose(N, O); Line up(U, V); Line tail(T, W); Line low(D, E); FoilLoftSurf wing({tail, up, nose, low, tail}); FoilLoftSurf half({nose, up, tail}, "modified", nose_index = 4); FoilLoftSurf sharp({tail, up, nose, tail}, "16", offset = "normal");
    """
    ...
def RevSurf(
    name: str,
    /,
    curve: _Curve,
    line: _Curve,
    a1: _Number | None = ...,
    a2: _Number | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A curve rotated about a line: S(u, v) is C(u) rotated by a1 + v (a2 - a1), right-handed about
    the direction from the line's start to its end (Rodrigues).

    An end of the curve on the line gives a pole. A full turn closes the surface.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        Generating curve.
    line : line
        Axis of rotation.
    a1 : number, optional
        Angle at v = 0, in radians (degrees in model files). Default 0.
    a2 : number, optional
        Angle at v = 1, in radians (degrees in model files). Default 6.28319.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint O(0, 0, 0); AbsPoint X(1, 0, 0); Line axis(O, X); AbsPoint A(-1, 0, 0.1); AbsPoint B(0, 1.5, 0.2); AbsPoint C(2, 0.5, 0); BCurve c({A, B, C}); RevSurf S(c, axis, 0.25, 2.5);
    """
    ...
def TranSurf(
    name: str,
    /,
    c1: _Curve,
    c2: _Curve,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A curve translated along another: S(u, v) = C1(u) + (C2(v) - C2(0)).

    Parameters
    ----------
    name : str
        The name of the object.
    c1 : curve
        The curve to translate: edge v = 0.
    c2 : curve
        The path.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 1, 2); AbsPoint E(1, 1, 3); BCurve l({A, B, C}); BCurve m({A, D, E}); TranSurf S(l, m);
    """
    ...
def SweepSurf(
    name: str,
    /,
    profile: _Curve,
    path: _Curve,
    frame: _Text | None = ...,
    up: _Vector | None = ...,
    twist: _Numbers | None = ...,
    scale: _Numbers | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A curve swept along a path by a moving frame: S(u, v) = path(v) + F(v) (profile(u) - path(0)),
    with F(0) = 1, so that edge v = 0 is the profile.

    Frames: "minimal" does not rotate about the tangent of the path (rotation-minimising; Wang,
    Juettler, Zheng and Liu 2008); "up" keeps one axis as upright as the tangent allows; "fixed"
    only translates the profile, along a path that may have corners. `twist` and `scale` are
    functions of v: coefficients of a clamped uniform B-spline of degree at most 3, so {a, b} is
    linear from a to b. The twist is right-handed about the tangent ("fixed": about the tangent at v
    = 0).

    Parameters
    ----------
    name : str
        The name of the object.
    profile : curve
        The curve to sweep: edge v = 0.
    path : curve
        Path of the profile.
    frame : text, optional
        Motion of the frame: "minimal", "up" or "fixed". Default minimal.
    up : vector, optional
        Upright direction of frame = "up"; default: z.
    twist : list of number, optional
        Angles of rotation about the tangent along v, in radians.
    scale : list of number, optional
        Scale factors of the profile along v.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(3, 2, 0.5); AbsPoint D(3, 3, 3); BCurve path({A, B, C, D}); AbsPoint P(0, 0.5, 0); AbsPoint Q(0.1, 0.3, 0.6); AbsPoint R(0, -0.5, 0.2); BCurve profile({P, Q, R}); SweepSurf S(profile, path); SweepSurf upright(profile, path, "up", up = {0, 0.1, 1}); SweepSurf screw(profile, path, twist = {0, 0, 1.5}, scale = {1, 0.5}); SweepSurf moved(profile, path, "fixed", scale = {1, 0.5});
    """
    ...
def BlendSurf(
    name: str,
    /,
    curves: Sequence[_Curve] | _Any,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A patch between four curves, its edges v = 0, u = 1, v = 1 and u = 0, each in increasing
    parameter: the bilinear Coons patch P_u + P_v - P_uv (Coons 1967).

    With three curves the edge u = 0 is the point at which the first and the third begin. Curves
    that do not meet at the corners are errors; they are never reversed.

    Parameters
    ----------
    name : str
        The name of the object.
    curves : list of curve
        The four (or three) boundary curves.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 1); AbsPoint C(5, 4, 0); AbsPoint D(0, 3, 1); AbsPoint E(2, -1, 2); AbsPoint F(2, 4, -1); BCurve south({A, E, B}, 2); Line east(B, C); BCurve north({D, F, C}, 2); Line west(A, D); BlendSurf S({south, east, north, west}); Line slope(A, C); BlendSurf three({south, east, slope});
    """
    ...
def BlendCenter(
    name: str,
    /,
    curves: Sequence[_Curve] | _Any,
    centre: _Point,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A patch between four curves that passes through a given centre point: the Coons patch plus 16 u
    (1 - u) v (1 - v) times the vector from its centre to the point.

    Parameters
    ----------
    name : str
        The name of the object.
    curves : list of curve
        The four (or three) boundary curves.
    centre : point
        The point at u = v = 0.5.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 1); AbsPoint C(5, 4, 0); AbsPoint D(0, 3, 1); AbsPoint E(2, -1, 2); AbsPoint F(2, 4, -1); BCurve south({A, E, B}, 2); Line east(B, C); BCurve north({D, F, C}, 2); Line west(A, D); AbsPoint top(2, 2, 3); BlendCenter S({south, east, north, west}, top);
    """
    ...
def TanBoundary(
    name: str,
    /,
    sides: Sequence[_Curve] | _Any,
    free: Sequence[_Integer] | _Array | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A patch between four curves, its edges v = 0, u = 1, v = 1 and u = 0, each in increasing
    parameter, tangent to the surfaces of the curves that are snakes, except those listed as `free`.

    It is the bicubically blended Coons patch (Coons 1967) of the curves and of slopes across them,
    with the twists of Gregory (1974), which need not agree at the corners. The slope across a snake
    is in the tangent plane of its surface; its components along the snake and perpendicular to it
    vary linearly between those of the two neighbouring edges. Across a free edge it is the slope of
    the bilinear patch. A neighbour must leave a tangent edge in the tangent plane there, as snakes
    of the same surface do: otherwise no patch is tangent at that corner. With three curves the edge
    u = 0 is the point at which the first and the third begin.

    Parameters
    ----------
    name : str
        The name of the object.
    sides : list of curve
        The four (or three) boundary curves; snakes for the edges that are tangent to a surface.
    free : list of integer, optional
        The numbers (from 1) of sides without tangency although they are snakes.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0.5); AbsPoint C(0, 3, 0.2); AbsPoint D(4, 3, 0); AbsPoint G(2, 1, 0.6); BCurve a({A, G, B}, 2); Line b(C, D); RuledSurf floor(a, b); EdgeSnake low(3, floor); BlendPoint I({C, A}, {1.5, -0.5}); BlendPoint J({D, B}, {1.5, -0.5}); AbsPoint E(0, 6, 2); AbsPoint F(4, 6, 1.5); BCurve west({C, I, E}, 2); BCurve east({D, J, F}, 2); Line high(E, F); TanBoundary S({low, east, high, west}); TanBoundary plain({low, east, high, west}, free = {1});
    """
    ...
def DevSurf(
    name: str,
    /,
    c1: _Curve,
    c2: _Curve,
    along: object | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A developable surface between two curves, a plate bent without stretching: straight rulings from
    C1(s) to C2(t) with a constant tangent plane, det[C1'(s), C2'(t), C2(t) - C1(s)] = 0; S(u, v) =
    (1 - v) C1(s(u)) + v C2(t(u)).

    The rulings extend from the ruling of both starts to that of both ends; cones about an end of a
    curve (fans) complete the surface if those two are not rulings. By default u = (s + t) / 2 and
    no edge has the divisions of its curve: build neighbours on an EdgeSnake of this surface. With
    `along` = "c1" (or "c2") u is the parameter of that curve and meshes join along it; a fan about
    one of its ends is then an error. Errors: no pair of points has a common tangent plane; rulings
    cross between the curves.

    Parameters
    ----------
    name : str
        The name of the object.
    c1 : curve
        Edge v = 0.
    c2 : curve
        Edge v = 1.
    along : value, optional
        Curve or curves whose parameter is u: "both", "c1" or "c2". Default both.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0.75, 0); AbsPoint C(4, 0, 0); AbsPoint D(0.5, 0, 2); AbsPoint E(2, 1.5, 2.25); AbsPoint F(4.5, 0.25, 2); BCurve l({A, B, C}); BCurve m({D, E, F}); DevSurf plate(l, m); AbsPoint G(0.5, -1, 3); CopyCurve k(l, A, G, 0.5, 0.5, 0.5); DevSurf cone(l, k, "c1");
    """
    ...
def ExpandedSurf(
    name: str,
    /,
    surface: _Surface,
    frame: _Frame | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A developable surface unrolled: the plate before bending, which preserves lengths and angles, at
    equal parameters.

    Its lines u = const must be straight with one tangent plane along each, like those of DevSurf,
    cones and cylinders. The plate is in the xy plane of `frame` (default: world), its normal along
    z, its first ruling along y with the middle at the origin. From ruling to ruling the direction
    turns as in the tangent plane under parallel transport (do Carmo 1976, section 4-4). The image
    of a snake is its CopySnake on the plate.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The surface to unroll.
    frame : frame, optional
        Frame whose xy plane contains the plate; default: world axes.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0.75, 0.25); AbsPoint C(4, 0, 0); AbsPoint D(0.5, 0.25, 2); BCurve l({A, B, C}); Line up(A, D); TranSurf hull(l, up); ExpandedSurf plate(hull); AbsPoint O(0, 0, 5); RPYFrame table(O, 0.2, 0, 0.5); ExpandedSurf there(hull, table);
    """
    ...
def FilletSurf(
    name: str,
    /,
    snake1: _Snake,
    snake2: _Snake,
    m1: _Number | None = ...,
    m2: _Number | None = ...,
    continuity: _Integer | None = ...,
    direction1: _Text | None = ...,
    direction2: _Text | None = ...,
    closed: _Integer | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A fillet between two snakes, tangent to their surfaces: for each u a cubic from the first snake
    at v = 0 to the second at v = 1, with end tangents in the two tangent planes.

    The tangents are perpendicular to the snakes ("perpendicular"), along the chord between the two
    snakes projected to the tangent plane ("chord"), or along a parameter line of the surface ("u",
    "v"). Their lengths are `m1` and `m2` chords; 1.17 is closest to a circular quarter. With
    `continuity = 2` it is a quintic that also has the curvature of both surfaces across the edges.
    For closed snakes `closed = 1` declares the edges u = 0 and u = 1 as one line.

    Parameters
    ----------
    name : str
        The name of the object.
    snake1 : snake
        Edge v = 0.
    snake2 : snake
        Edge v = 1.
    m1 : number, optional
        Length of the tangent at v = 0, relative to the chord between the snakes. At least 0,
        default 1.
    m2 : number, optional
        Length of the tangent at v = 1, relative to the chord between the snakes. At least 0,
        default 1.
    continuity : integer, optional
        1: common tangent planes; 2: also common curvature across the edges. 1 to 2, default 1.
    direction1 : text, optional
        Direction at the first surface: "perpendicular", "chord", "u" or "v". Default
        perpendicular.
    direction2 : text, optional
        Direction at the second surface: "perpendicular", "chord", "u" or "v". Default
        perpendicular.
    closed : integer, optional
        1 when the edges u = 0 and u = 1 coincide. 0 to 1, default 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0.5); AbsPoint C(0, 3, 0.2); AbsPoint D(4, 3, 0); AbsPoint E(0, 4, 1); AbsPoint F(4, 4.5, 1); AbsPoint G(0, 4, 4); AbsPoint H(4, 4.2, 4); AbsPoint I(2, 1, 0.6); BCurve a({A, I, B}, 2); Line b(C, D); RuledSurf floor(a, b); Line c(E, F); Line d(G, H); RuledSurf wall(c, d); UVSnake low(floor, "v", 0.7); UVSnake high(wall, "v", 0.2); FilletSurf S(low, high); FilletSurf G2(low, high, 1.2, 0.9, continuity = 2, direction2 = "chord"); FilletSurf across(low, high, direction1 = "v");
    """
    ...
def RollFillet(
    name: str,
    /,
    surface1: _Onto,
    surface2: _Onto,
    radius: _Number,
    side1: _Integer | None = ...,
    side2: _Integer | None = ...,
    radii: _Numbers | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """The fillet of a ball rolling along two surfaces: circular arcs from the contact line on the
    first, at v = 0, to that on the second, at v = 1; tangent to both.

    The centre of the ball is on the intersection of both surfaces offset by `radius`, which extends
    from edge to edge or is closed; u is the fraction of its length. The direction and the selection
    among several paths follow IntSnake: a magnet selects the ball with the nearest contact. With
    `radii` the radius is a function of u: the centre is in the normal plane of the path for the
    constant `radius`, and the arcs pass through both contacts, tangent to both surfaces. A radius
    larger than a radius of curvature of either surface on its side is an error.

    `ContactSnake` gives the lines of contact on both surfaces, which are the edges v = 0 and v = 1.
    Parts of the surfaces bounded by them (`SubSurf`, `TrimSurf`) join the fillet exactly.

    Parameters
    ----------
    name : str
        The name of the object.
    surface1 : surface or magnet
        The first surface, or a magnet on it near the intended contact.
    surface2 : surface or magnet
        The second surface, or a magnet on it near the intended contact.
    radius : number
        Radius of the ball, greater than 0. At least 0.
    side1 : integer, optional
        Side of the ball: 1 on the side of the natural normal of the first surface, -1 on the
        other. -1 to 1, default 1.
    side2 : integer, optional
        Side of the ball for the second surface; see `side1`. -1 to 1, default 1.
    radii : list of number, optional
        Radii along u, greater than 0: coefficients of a clamped uniform B-spline of degree 3
        (for n < 4 coefficients: n - 1). Default: constant `radius`.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 0.2); AbsPoint D(4, 3, 0); AbsPoint E(0, 2.5, -1); AbsPoint F(4, 2, -1); AbsPoint G(0, 2.5, 3); AbsPoint H(4, 2.25, 3); Line a(A, B); Line b(C, D); RuledSurf floor(a, b); Line c(E, F); Line d(G, H); RuledSurf wall(c, d); RollFillet S(floor, wall, 0.8); RollFillet more(floor, wall, 0.5, radii = {0.25, 0.5, 0.75}, visible = 0);
    """
    ...
def SubSurf(
    name: str,
    /,
    sides: Sequence[_Side] | _Any,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """The part of a surface between snakes and magnets on it: S(u, v) = P(w(u, v)), with P the surface
    and w a patch of its parameter plane.

    Two sides w1, w2 are edges v = 0 and v = 1: w = (1 - v) w1(u) + v w2(u). Four sides are the
    edges v = 0, u = 1, v = 1, u = 0 in this order, each in increasing parameter (the third and the
    fourth are therefore opposite to a walk round the patch); w is the bilinear Coons patch (Coons
    1967). Three sides: the same, with the edge u = 0 reduced to the point at which the first and
    the third begin. A magnet is a side of zero length. Sides that do not meet are errors, never
    reversed; so are folded patches. Two sides that each begin and end at one point, or at the seam
    of a closed surface, bound a closed band; a closed snake and a magnet inside it, a cap.

    Parameters
    ----------
    name : str
        The name of the object.
    sides : list of side
        Two, three or four snakes and magnets of one surface.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet p(S, 0.1, 0.2); AbsMagnet q(S, 0.9, 0.1); AbsMagnet r(S, 0.8, 0.9); AbsMagnet s(S, 0.2, 0.7); AbsMagnet t(S, 0.5, 0.3); BSnake south({p, t, q}); LineSnake east(q, r); LineSnake north(s, r); LineSnake west(p, s); LineSnake middle(p, r); SubSurf part({south, east, north, west}); SubSurf half({south, north}, visible = 0); SubSurf fan({south, r}, visible = 0); SubSurf three({south, east, middle}, visible = 0);
    """
    ...
def TrimSurf(
    name: str,
    /,
    surface: _Surface,
    loops: Sequence[_Snake] | _Any,
    whole: _Integer | None = ...,
    rim: _Integer | None = ...,
    nu: _Integer | None = ...,
    nv: _Integer | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BodyHandle:
    """The part of a surface within loops of snakes on it, as triangles.

    Consecutive snakes form a loop, in either direction; a closed snake is a loop on its own. The
    first loop is the outer one, the others are holes; with `whole = 1` the boundary of the surface
    is the outer loop and all given loops are holes. All vertices are on the surface. Without stated
    divisions the border is divided by its own curvature and the interior by the surface's, until
    the area of the triangles is within 1e-3 of that of the surface; a larger difference is a
    warning. With `nu` or `nv` the interior contains points of the surface's own nu x nv divisions
    at some distance from the border. The triangulation is Delaunay's, in parameters scaled to
    lengths or by curvature.

    Along its snakes, and with `whole = 1` along the surface's edges, it joins its neighbours:
    patches, fillets and other trimmed surfaces whose edges follow the same snakes share its
    vertices by identity. Derivatives of vertices are at fixed parameters of their divisions. Divisions propagate across such edges; `rim` states those of each snake,
    and a contradiction is reported.

    For two, three or four sides prefer `SubSurf`, which has a net of panels.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The surface that is trimmed.
    loops : list of snake
        Snakes on it, loop after loop.
    whole : integer, optional
        1 when the whole surface is kept except for holes. 0 to 1, default 0.
    rim : integer, optional
        Divisions of each snake; default: by its curvature and that of the surface, with the
        neighbours' as a minimum. 1 to 10000.
    nu : integer, optional
        Divisions along u of the surface's grid inside the border; default: by the curvature of
        the surface. 1 to 1000.
    nv : integer, optional
        Divisions of the surface along v. 1 to 1000.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    mesh

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0.5); AbsPoint C(4, 0, 0); AbsPoint D(0, 3, 0); AbsPoint E(4, 3, 1); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m, visible = 0); AbsMagnet p(S, 0.5, 0.45); AbsMagnet q(S, 0.71, 0.45); AbsMagnet r(S, 0.5, 0.7); ArcSnake round(q, p, r, type = 6); AbsMagnet a(S, 0.1, 0.15); AbsMagnet b(S, 0.95, 0.2); AbsMagnet c(S, 0.8, 0.93); LineSnake ab(a, b); LineSnake cb(c, b); LineSnake ca(c, a); TrimSurf window(S, {round}, whole = 1); TrimSurf part(S, {ab, cb, ca}, visible = 0);
    """
    ...
def TriMesh(
    name: str,
    /,
    points: _Vectors,
    triangles: Sequence[_Integer] | _Array | _Any,
    levels: _Integer | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BodyHandle:
    """Triangles between points of the model: a body if they close, otherwise an open sheet.

    `levels` times, each triangle is divided into four and the vertices move as in Loop's
    subdivision surfaces (Loop 1987): smooth inside, cubic B-splines along open edges. The vertices
    keep points of the model as parents: a moved point moves the sheet, with derivatives.

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of point
        The vertices.
    triangles : list of integer
        Corners of the triangles as vertex numbers from 1, counter-clockwise from outside.
    levels : integer, optional
        Number of subdivisions. At most 8, default 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    mesh

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(0, 0, 1); TriMesh t({A, B, C, D}, {1,3,2, 1,2,4, 2,3,4, 3,1,4}); TriMesh egg({A, B, C, D}, {1,3,2, 1,2,4, 2,3,4, 3,1,4}, levels = 2);
    """
    ...
def Blister(
    name: str,
    /,
    snake: _Snake,
    centre: _Magnet,
    height: _Number,
    edge: _Text | None = ...,
    top: _Text | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A bump on a surface inside a closed snake: a sonar dome, a blister of a fairing, a bulge round a shaft.

    S(u, v) = P(w) + h b(v) n(w), with w on the straight line of the parameter plane from the snake
    at u (v = 0) to the magnet (v = 1), n the unit normal of the surface P and b a polynomial from 0
    to 1. Edge of the bump: "sharp" (b' non-zero), "tangent" to the surface (b' = 0), or "curvature"
    (b' = b'' = 0, equal curvatures too). Top: "round" (b' = 0 at v = 1) or "pointed". It joins
    other objects on the same snake.

    Parameters
    ----------
    name : str
        The name of the object.
    snake : snake
        The closed snake around the bump.
    centre : magnet
        The magnet below the top.
    height : number
        The height, on the side of the natural normal if positive.
    edge : text, optional
        At the snake: "sharp", "tangent" or "curvature". Default tangent.
    top : text, optional
        At the centre: "round" or "pointed". Default round.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 3); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsMagnet c(S, 0.5, 0.5); AbsMagnet p(S, 0.8, 0.5); AbsMagnet q(S, 0.5, 0.75); ConicSnake ring(c, p, q); Blister dome(ring, c, 0.4); Blister cone(ring, c, -0.2, "sharp", "pointed");
    """
    ...
def MirrSurf(
    name: str,
    /,
    surface: _Surface,
    mirror: _Mirror,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """The mirror image of a surface in a plane, line or point, point by point.

    A plane or point reverses the natural normal; panels keep the orientation of the original.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The surface to mirror.
    mirror : mirror
        The mirror: a plane, line or point.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0.5, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); MirrSurf port(S, "y=0");
    """
    ...
def RotatSurf(
    name: str,
    /,
    surface: _Surface,
    line: _Curve,
    angle: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A surface rotated about a line, right-handed about the direction from the line's start to its
    end (Rodrigues). Images of joined surfaces under the same rotation are joined.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The surface to turn.
    line : line
        Axis of rotation.
    angle : number
        The angle, in radians (degrees in model files).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0.5, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsPoint O(0, 0, 0); AbsPoint X(1, 0, 0.2); Line axis(O, X); RotatSurf blade(S, axis, 1.25);
    """
    ...
def CopySurf(
    name: str,
    /,
    surface: _Surface,
    from_: _Point,
    to: _Point,
    sx: _Number | None = ...,
    sy: _Number | None = ...,
    sz: _Number | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A copy of a surface, translated and scaled along the axes: p maps to `to` + diag(sx, sy, sz) (p
    - `from`).

    A negative product of the three factors reverses the natural normal; panels keep the orientation
    of the original.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The surface to copy.
    from : point
        The point that is moved to `to`.
    to : point
        Its image.
    sx : number, optional
        Stretch along x. Default 1.
    sy : number, optional
        Stretch along y. Default 1.
    sz : number, optional
        Stretch along z. Default 1.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0.5, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsPoint P(1, 8, 0.5); CopySurf beside(S, A, P); CopySurf small(S, A, P, 0.5, -0.25, 0.4);
    """
    ...
def ProjSurf(
    name: str,
    /,
    surface: _Surface,
    mirror: _Mirror,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A surface projected onto a plane along its normal: each point maps to the foot of its
    perpendicular.

    The image of a surface perpendicular to the plane degenerates; panels overlap there.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The surface to project.
    mirror : mirror
        The plane of projection.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0.5, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); YPlane p(2.5); ProjSurf shadow(S, p); ProjSurf flat(S, "y=0");
    """
    ...
def RelSurf(
    name: str,
    /,
    surface: _Surface,
    p00: _Point,
    p10: _Point,
    p11: _Point,
    p01: _Point,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A surface whose four corners are moved to given points: S plus the bilinear blend of the
    corners' displacements, which is linear along each edge.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The surface it follows.
    p00 : point
        The corner (u, v) = (0, 0).
    p10 : point
        The corner (1, 0).
    p11 : point
        The corner (1, 1).
    p01 : point
        The corner (0, 1).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0.5, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(4, 1, 3); BCurve l({A, B, C}); Line m(D, E); RuledSurf S(l, m); AbsPoint P(0, 2, 0); AbsPoint Q(4.5, 2, 0.5); AbsPoint R(4, 2, 3); AbsPoint T(0, 1.5, 2); RelSurf moved(S, P, Q, R, T);
    """
    ...
def OffsetSurf(
    name: str,
    /,
    surface: _Surface,
    distance: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A surface at a distance from another along its natural normal: S(u, v) + d n(u, v), with n = S_u
    x S_v / |S_u x S_v|; a negative distance is on the other side.

    At a pole the normal is the limit along the parameter line that ends there. Errors: a distance
    beyond a radius of curvature on that side, which would fold the offset; a surface without a
    normal.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The surface that is offset.
    distance : number
        The distance, on the side of the natural normal if positive.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0.5); AbsPoint C(4, 0, 0); AbsPoint D(0, 0.5, 2); AbsPoint E(2, 2, 2); AbsPoint F(4, 1, 3); BCurve l({A, B, C}); BCurve m({D, E, F}); RuledSurf S(l, m); OffsetSurf plate(S, 0.25); OffsetSurf inside(S, -0.5);
    """
    ...
def PolySurf(
    name: str,
    /,
    surfaces: Sequence[_Surface] | _Any,
    along: object | None = ...,
    breaks: _Numbers | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """Adjacent surfaces as one: piece k of N has u from (k - 1) / N to k / N (v, with `along` = "v"),
    or between the given breaks.

    Each piece begins where the one before ends: edge u = 1 of the one is edge u = 0 of the other,
    point by point at equal v, within the model's tolerance. A piece is never reversed. Meshes join
    along the pieces' own edges.

    Parameters
    ----------
    name : str
        The name of the object.
    surfaces : list of surface
        The surfaces, in order.
    along : value, optional
        The parameter along which the pieces are joined: "u" or "v". Default u.
    breaks : list of number, optional
        Parameters of the seams, ascending between 0 and 1; default: equal intervals.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(2, 2, 2); AbsPoint F(4, 1, 3); AbsPoint G(1, 2, 0.5); BCurve a({A, G, B}, 2); Line b(D, E); RuledSurf R(a, b); Line c(B, C); Line d(E, F); RuledSurf S(c, d); PolySurf both({R, S}); PolySurf early({R, S}, breaks = {0.375}); AbsPoint H(0, 1, 4); AbsPoint I(2, 3, 4); Line e(H, I); RuledSurf T(b, e); PolySurf up({R, T}, "v");
    """
    ...
def BFitSurf(
    name: str,
    /,
    surface: _Surface,
    degree_u: _Integer | None = ...,
    degree_v: _Integer | None = ...,
    nu: _Integer | None = ...,
    nv: _Integer | None = ...,
    accuracy: _Number | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A B-spline surface fitted to another by least squares, with clamped uniform knots and the
    corners of the surface.

    The lines v = const are fitted first, then their control points across, which is the fit of the
    tensor product; each edge is the fit of the surface's edge. The member `residual` is the
    greatest distance between surface and fit at equal parameters; a residual above `accuracy` is an
    error.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The surface to approximate.
    degree_u : integer, optional
        Polynomial degree in u. 1 to 25, default 3.
    degree_v : integer, optional
        Polynomial degree in v. 1 to 25, default 3.
    nu : integer, optional
        Number of control points along u, more than the degree. 2 to 1000, default 8.
    nv : integer, optional
        Number of control points along v, more than the degree. 2 to 1000, default 8.
    accuracy : number, optional
        The greatest distance allowed between the two at equal parameters. At least 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(2, 2, 2.5); AbsPoint F(4, 1, 3); CCurve l({A, B, C}); CCurve m({D, E, F}); RuledSurf S(l, m); BFitSurf fit(S, 3, 2, 5, 3, 0.05);
    """
    ...
def NUBFitSurf(
    name: str,
    /,
    surface: _Surface,
    degree_u: _Integer | None = ...,
    degree_v: _Integer | None = ...,
    accuracy: _Number | None = ...,
    *,
    knots_u: _Numbers,
    knots_v: _Numbers,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A B-spline surface fitted to another as in BFitSurf, with given knots.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The surface to come near to.
    degree_u : integer, optional
        Polynomial degree in u. 1 to 25, default 3.
    degree_v : integer, optional
        Polynomial degree in v. 1 to 25, default 3.
    knots_u : list of number
        The parameters u of the joints between pieces, from 0 to 1, each once.
    knots_v : list of number
        The parameters v of the joints between pieces, from 0 to 1, each once.
    accuracy : number, optional
        The greatest distance allowed between the two at equal parameters. At least 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 1, 0); AbsPoint C(4, 0, 0); AbsPoint D(0, 0, 2); AbsPoint E(2, 2, 2.5); AbsPoint F(4, 1, 3); CCurve l({A, B, C}); CCurve m({D, E, F}); RuledSurf S(l, m); NUBFitSurf fit(S, 3, 1, {0, 0.4, 1}, {0, 1});
    """
    ...
def TabSurf(
    name: str,
    /,
    file: _Text | None = ...,
    rows: _Integer | None = ...,
    degree: _Integer | None = ...,
    points: _Vectors | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A surface through the points of a table: a C-loft of the curves through its rows of points.

    Consecutive rows with equal numbers of points; u runs along a row, v across the rows. Empty
    lines between the rows, or the header of a Plot3D file with one grid, give their number.

    Parameters
    ----------
    name : str
        The name of the object.
    file : text, optional
        The file, relative to the program that declares the surface.
    rows : integer, optional
        Number of rows, two or more; 0 if the file determines it. Default 0.
    degree : integer, optional
        3 for cubic splines, 1 for polylines. 1 to 3, default 3.
    points : list of vector, optional
        The points, where there is no file.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        TabSurf s(rows = 2, points = {{0, 0, 0}, {1, 2, 0.5}, {3, 2, 1}, {0, 0, 3}, {1, 1, 3}, {3, 2, 4}});
    """
    ...
def ProcSurf(
    name: str,
    /,
    bead: _Bead,
    curve: _Curve,
    t1: _Number | None = ...,
    t2: _Number | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """The surface swept by a curve as a bead on which it depends moves along its curve: S(u, v) is the
    point u of `curve` with `bead` at the parameter t1 + v (t2 - t1).

    Everything between bead and curve is evaluated at each sample of the bead, as for `ProcCurve`:
    along v the surface is a chain of polynomials through such curves, halved until they agree to
    about 1e-12 of its size.

    Parameters
    ----------
    name : str
        The name of the object.
    bead : bead
        The bead that moves.
    curve : curve
        The curve that follows.
    t1 : number, optional
        Start of the bead. Default 0.
    t2 : number, optional
        End. Default 1.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); AbsBead b(c, 0.5); AbsPoint D(0, 0, 3); AbsPoint E(3, 0, 3); Line l(D, E); ProjPoint foot(b, l); RelPoint m(b, 0, -0.5, 1); BCurve rib({b, m, foot}, 2); ProcSurf skin(b, rib);
    """
    ...
def FaceSurf(
    name: str,
    /,
    face: _Integer,
    solid: _Solid,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A face of a solid as a surface: 1 is u = 0, 2 is u = 1, 3 is v = 0, 4 is v = 1, 5 is w = 0, 6 is
    w = 1. Its parameters are the solid's other two, in order.

    Another solid with this surface as a face shares the vertices of the first solid there.

    Parameters
    ----------
    name : str
        The name of the object.
    face : integer
        The number of the face. 1 to 6.
    solid : solid
        The solid.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0); AbsPoint E(0, 0, 2); AbsPoint F(2, 0, 2); Line a(A, B); Line b(C, D); Line c(E, F); RuledSurf low(a, b); RuledSurf side(a, c); Line up(A, E); TranSolid S(low, up); FaceSurf top(6, S); TranSolid next(top, up);
    """
    ...
def RuledSolid(
    name: str,
    /,
    s1: _Surface,
    s2: _Surface,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SolidHandle:
    """A solid between two surfaces: X(u, v, w) = (1 - w) S1(u, v) + w S2(u, v).

    Solids whose surfaces join along an edge join along the face over it if they have equal
    divisions.

    Parameters
    ----------
    name : str
        The name of the object.
    s1 : surface
        The face w = 0.
    s2 : surface
        The face w = 1.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    solid

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0.5); AbsPoint E(0, 0, 2); AbsPoint F(2, 0, 3); AbsPoint G(0, 2, 2); AbsPoint H(2, 2, 2); AbsPoint I(1, 1, 3); Line a(A, B); Line b(C, D); RuledSurf low(a, b); BCurve c({E, I, F}, 2); Line d(G, H); RuledSurf high(c, d); RuledSolid S(low, high, divisions = {4, 4, 6});
    """
    ...
def BLoftSolid(
    name: str,
    /,
    surfaces: Sequence[_Surface] | _Any,
    degree: _Integer | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SolidHandle:
    """A solid that approximates its surfaces: X(u, v, w) = sum N_i(w) S_i(u, v), with N_i the
    B-splines of clamped uniform knots. It has the first and the last surface as faces.

    With N surfaces the degree is at most N - 1: a higher one is lowered to that.

    Parameters
    ----------
    name : str
        The name of the object.
    surfaces : list of surface
        Surfaces, two or more, in order of w.
    degree : integer, optional
        Polynomial degree across the surfaces. 1 to 25, default 3.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    solid

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0.5); AbsPoint E(0.5, 0, 2); AbsPoint F(3, 0, 2); AbsPoint G(0.5, 2, 2); AbsPoint H(3, 3, 2); AbsPoint I(0, 0, 4); AbsPoint J(2, 0, 4); AbsPoint K(0, 2, 4.5); AbsPoint L(2, 2, 4); Line a(A, B); Line b(C, D); Line c(E, F); Line d(G, H); Line e(I, J); Line f(K, L); RuledSurf low(a, b); RuledSurf middle(c, d); RuledSurf high(e, f); BLoftSolid S({low, middle, high}, degree = 2);
    """
    ...
def CLoftSolid(
    name: str,
    /,
    surfaces: Sequence[_Surface] | _Any,
    ends: _Text | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SolidHandle:
    """A solid that interpolates its surfaces: at each u and v the interpolating spline through their
    points there, with knots at chord lengths, evaluated at w.

    Two surfaces give rulings, three parabolas, four or more cubic splines. Neighbouring surfaces must
    not meet, unless all meet in one point.

    Parameters
    ----------
    name : str
        The name of the object.
    surfaces : list of surface
        Surfaces, two or more, in order of w.
    ends : text, optional
        End conditions: "notaknot", "natural", "bessel" or "quadratic". Default notaknot.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    solid

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0.5); AbsPoint E(0.5, 0, 2); AbsPoint F(3, 0, 2); AbsPoint G(0.5, 2, 2); AbsPoint H(3, 3, 2); AbsPoint I(0, 0, 4); AbsPoint J(2, 0, 4); AbsPoint K(0, 2, 4.5); AbsPoint L(2, 2, 4); Line a(A, B); Line b(C, D); Line c(E, F); Line d(G, H); Line e(I, J); Line f(K, L); RuledSurf low(a, b); RuledSurf middle(c, d); RuledSurf high(e, f); CLoftSolid S({low, middle, high}); CLoftSolid N({low, middle, high}, "natural");
    """
    ...
def BSolid(
    name: str,
    /,
    points: _Vectors,
    nu: _Integer,
    nv: _Integer,
    nw: _Integer,
    degree_u: _Integer | None = ...,
    degree_v: _Integer | None = ...,
    degree_w: _Integer | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SolidHandle:
    """A B-spline solid of a net of points: X(u, v, w) = sum N_i(u) N_j(v) N_k(w) P_ijk, with clamped
    uniform knots.

    It passes through the eight corner points and is attracted by the others. A degree that the net is
    too small for is lowered to the number of points less one.

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of point
        Net of points, w running fastest, then v: nu times nv rows of nw points.
    nu : integer
        Points along u. At least 2.
    nv : integer
        Points along v. At least 2.
    nw : integer
        Points along w. At least 2.
    degree_u : integer, optional
        Polynomial degree in u. 1 to 25, default 3.
    degree_v : integer, optional
        Polynomial degree in v. 1 to 25, default 3.
    degree_w : integer, optional
        Polynomial degree in w. 1 to 25, default 3.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    solid

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(0, 0, 2); AbsPoint C(0, 2, 0); AbsPoint D(0, 2, 2); AbsPoint E(1, 0.5, 0); AbsPoint F(1, 0, 3); AbsPoint G(1, 2, 0); AbsPoint H(1, 2.5, 2); AbsPoint I(3, 0, 0); AbsPoint J(3, 0, 2); AbsPoint K(3, 2, 0); AbsPoint L(3, 2, 2); BSolid S({A, B, C, D, E, F, G, H, I, J, K, L}, nu = 3, nv = 2, nw = 2);
    """
    ...
def BlendSolid(
    name: str,
    /,
    surfaces: Sequence[_Surface] | _Any,
    turns: Sequence[_Integer] | _Array | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SolidHandle:
    """A solid between six faces u = 0, u = 1, v = 0, v = 1, w = 0, w = 1: their transfinite blend, the three
    ruled solids less the three of edges plus that of the corners (Gordon and Hall 1973).

    The parameters of a face are the solid's other two, in order: (v, w), (u, w), (u, v). A surface
    of another orientation has a number in `turns`: 1 if its u is the second of the two, plus 2 if
    its u and plus 4 if its v is opposite to the solid's. Faces must meet along the twelve edges.

    Parameters
    ----------
    name : str
        The name of the object.
    surfaces : list of surface
        The six faces u = 0, u = 1, v = 0, v = 1, w = 0, w = 1.
    turns : list of integer, optional
        Orientation of each surface, 0 to 7; default: all 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    solid

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0); AbsPoint E(0, 0, 2); AbsPoint F(2, 0, 3); AbsPoint G(0, 2, 2); AbsPoint H(2.5, 2, 2); AbsPoint M(1, -0.5, 0); BCurve ab({A, M, B}, 2); Line cd(C, D); Line ef(E, F); Line gh(G, H); Line ac(A, C); Line bd(B, D); Line eg(E, G); Line fh(F, H); Line ae(A, E); Line bf(B, F); Line cg(C, G); Line dh(D, H); BlendSurf west({ac, cg, eg, ae}); BlendSurf east({bf, fh, dh, bd}); BlendSurf south({ab, bf, ef, ae}); BlendSurf north({cd, dh, gh, cg}); BlendSurf low({ab, bd, cd, ac}); BlendSurf high({ef, fh, gh, eg}); BlendSolid S({west, east, south, north, low, high}, turns = {0, 1, 0, 0, 0, 0});
    """
    ...
def TranSolid(
    name: str,
    /,
    surface: _Surface,
    curve: _Curve,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SolidHandle:
    """A surface translated along a curve: X(u, v, w) = S(u, v) + C(w) - C(0).

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The face w = 0.
    curve : curve
        Path of the surface.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    solid

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0.5); AbsPoint E(0.5, 0, 2); AbsPoint F(1, 1, 4); Line a(A, B); Line b(C, D); RuledSurf low(a, b); BCurve way({A, E, F}); TranSolid S(low, way);
    """
    ...
def SweepSolid(
    name: str,
    /,
    surface: _Surface,
    path: _Curve,
    frame: _Text | None = ...,
    up: _Vector | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SolidHandle:
    """A surface swept along a path by a moving frame: X(u, v, w) = path(w) + F(w) (S(u, v) - path(0)),
    with F(0) = 1, so that the face w = 0 is the surface. The frames are those of `SweepSurf`.

    Parameters
    ----------
    name : str
        The name of the object.
    surface : surface
        The face w = 0.
    path : curve
        Path of the surface.
    frame : text, optional
        Motion of the frame: "minimal", "up" or "fixed". Default minimal.
    up : vector, optional
        Upright direction of frame = "up"; default: z.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    solid

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 2, 0); AbsPoint D(2, 2, 0.5); AbsPoint E(0.5, 0, 2); AbsPoint F(1, 1, 4); Line a(A, B); Line b(C, D); RuledSurf low(a, b); BCurve way({A, E, F}); SweepSolid S(low, way); SweepSolid U(low, way, "up", up = {1, 0, 0});
    """
    ...
def Relabel(
    name: str,
    /,
    values: _Numbers,
    degree: _Integer | None = ...,
    partial: _Integer | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RelabelHandle:
    """A redistribution by a B-spline function of the parameter: R(t) = sum N_i(t) r_i, with clamped
    uniform knots, as in a B-sub-curve.

    The values increase from 0 to 1. With `partial = 1` they increase between any two values, and
    the law covers a part of the curve or its continuation beyond the ends. For N values the degree
    is at most N - 1; a higher one is lowered. Degree 1 is linear between its breaks, so parts of
    other curves stay parts of them.

    Parameters
    ----------
    name : str
        The name of the object.
    values : list of number
        Values from 0 to 1, two or more.
    degree : integer, optional
        Polynomial degree. 1 to 25, default 3.
    partial : integer, optional
        1 when the values may start and end at other numbers than 0 and 1. 0 to 1, default 0.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    relabel

    Notes
    -----
    In the language::

        Relabel r({0, 0.1, 0.6, 0.8, 1}, degree = 2); AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); Line l(A, B, relabel = r);
    """
    ...
def CosRelabel(
    name: str,
    /,
    dense: _Text | None = ...,
    weight: _Number | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RelabelHandle:
    """A cosine redistribution: R(t) = (1 - w) t + w f(t), with f = (1 - cos pi t) / 2 dense at both ends,
    1 - cos(pi t / 2) at the start or sin(pi t / 2) at the end.

    Parameters
    ----------
    name : str
        The name of the object.
    dense : text, optional
        Dense end: "both", "start" or "end". Default both.
    weight : number, optional
        Weight w of the cosine, 0 to 1. 0 to 1, default 1.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    relabel

    Notes
    -----
    In the language::

        CosRelabel r(); CosRelabel s("start", 0.8);
    """
    ...
def GeoRelabel(
    name: str,
    /,
    ratio: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RelabelHandle:
    """A geometric redistribution: R(t) = (q^t - 1) / (q - 1). For many equal steps of t, the last is q
    times the first; q = 1 is the identity.

    Parameters
    ----------
    name : str
        The name of the object.
    ratio : number
        Ratio q of the last step to the first; below 1 the law is dense at the end. 1e-09 to
        1e+09.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    relabel

    Notes
    -----
    In the language::

        GeoRelabel r(4);
    """
    ...
def TanhRelabel(
    name: str,
    /,
    strength: _Number,
    dense: _Text | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RelabelHandle:
    """A hyperbolic tangent redistribution (Vinokur, J. Comput. Phys. 50, 1983): dense at both ends
    R(t) = 1/2 + tanh(d (t - 1/2)) / (2 tanh(d/2)), at the start 1 + tanh(d (t - 1)) / tanh d, at the end
    the mirror image of that.

    Parameters
    ----------
    name : str
        The name of the object.
    strength : number
        Strength d, 0 to 100; 0 is the identity. 0 to 100.
    dense : text, optional
        Dense end: "both", "start" or "end". Default both.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    relabel

    Notes
    -----
    In the language::

        TanhRelabel r(3); TanhRelabel s(2.5, "end");
    """
    ...
def TableRelabel(
    name: str,
    /,
    parameters: _Numbers,
    values: _Numbers,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RelabelHandle:
    """A redistribution by a table: the monotone piecewise cubic through (parameter, value) pairs
    (Fritsch and Carlson, SIAM J. Numer. Anal. 17, 1980).

    The pairs range from (0, 0) to (1, 1); both columns increase.

    Parameters
    ----------
    name : str
        The name of the object.
    parameters : list of number
        Parameters t from 0 to 1.
    values : list of number
        Values R(t) from 0 to 1, as many.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    relabel

    Notes
    -----
    In the language::

        TableRelabel r({0, 0.25, 0.5, 1}, {0, 0.15, 0.4, 1});
    """
    ...
def ArcLenRelabel(
    name: str,
    /,
    curve: _Curve,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RelabelHandle:
    """A redistribution by arc length: R is the inverse of s(t) / L, with s the arc length along a
    curve and L its total, so that equal steps of t are equal lengths.

    Intended as the relabel of a curve of the same shape: a copy, a neighbour, or a curve on the
    same points. The curve must have non-zero speed everywhere.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        Curve whose arc length is used.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    relabel

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(4, 2, 1); BCurve c({A, B, C}); ArcLenRelabel r(c); BCurve even({A, B, C}, relabel = r);
    """
    ...
def CopyRelabel(
    name: str,
    /,
    curve: _Curve,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RelabelHandle:
    """A copy of the reparametrisation of another curve, so that neighbours match: the identity for a
    curve without one, that of the original for an image.

    Parameters
    ----------
    name : str
        The name of the object.
    curve : curve
        Curve whose relabel is copied.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    relabel

    Notes
    -----
    In the language::

        CosRelabel cosine(); AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(4, 2, 1); BCurve c({A, B, C}, relabel = cosine); CopyRelabel r(c); Line l(A, C, relabel = r);
    """
    ...
def InvRelabel(
    name: str,
    /,
    relabel: _Relabel,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RelabelHandle:
    """The inverse of a relabel: R(t) is the parameter at which the other has the value t. The other
    must have a nonzero slope at both ends.

    Parameters
    ----------
    name : str
        The name of the object.
    relabel : relabel
        The relabel to undo.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    relabel

    Notes
    -----
    In the language::

        CosRelabel cosine("both", 0.9); InvRelabel r(cosine);
    """
    ...
def ComposeRelabel(
    name: str,
    /,
    relabels: Sequence[_Relabel] | _Any,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> RelabelHandle:
    """Composition of relabels: {a, b} gives R(t) = b(a(t)).

    On a curve that is relabelled by b already, a relabel by a is the same.

    Parameters
    ----------
    name : str
        The name of the object.
    relabels : list of relabel
        Relabels in order of application.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    relabel

    Notes
    -----
    In the language::

        CosRelabel cosine(); GeoRelabel growth(3); ComposeRelabel r({growth, cosine});
    """
    ...
def XPlane(
    name: str,
    /,
    x: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PlaneHandle:
    """The plane of the points with a given x; its normal is (1, 0, 0).

    Parameters
    ----------
    name : str
        The name of the object.
    x : number
        The coordinate that all points of the plane have.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    plane

    Notes
    -----
    In the language::

        XPlane amidships(15);
    """
    ...
def YPlane(
    name: str,
    /,
    y: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PlaneHandle:
    """The plane of the points with a given y; its normal is (0, 1, 0).

    Parameters
    ----------
    name : str
        The name of the object.
    y : number
        The coordinate that all points of the plane have.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    plane

    Notes
    -----
    In the language::

        YPlane centre(0);
    """
    ...
def ZPlane(
    name: str,
    /,
    z: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PlaneHandle:
    """The plane of the points with a given z; its normal is (0, 0, 1).

    Parameters
    ----------
    name : str
        The name of the object.
    z : number
        The coordinate that all points of the plane have.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    plane

    Notes
    -----
    In the language::

        ZPlane waterline(0.25);
    """
    ...
def OffsetPlane(
    name: str,
    /,
    plane: _Plane,
    distance: _Number,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PlaneHandle:
    """The plane at a signed distance from another, positive along its normal.

    Parameters
    ----------
    name : str
        The name of the object.
    plane : plane
        Reference plane.
    distance : number
        The distance.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    plane

    Notes
    -----
    In the language::

        ZPlane waterline(0); OffsetPlane deck(waterline, 1.5);
    """
    ...
def ThreePointPlane(
    name: str,
    /,
    p1: _Point,
    p2: _Point,
    p3: _Point,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PlaneHandle:
    """The plane through three points (3PtPlane of model files); its normal is along
    (P2 - P1) x (P3 - P1).

    Parameters
    ----------
    name : str
        The name of the object.
    p1 : point
        First point.
    p2 : point
        Second point.
    p3 : point
        Third point.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    plane

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0.5); AbsPoint C(0, 1, 0.25); ThreePointPlane deck(A, B, C);
    """
    ...
def TwoPointPlane(
    name: str,
    /,
    p1: _Point,
    p2: _Point,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PlaneHandle:
    """The plane through one point with its normal toward another (2PtPlane of model files).

    Parameters
    ----------
    name : str
        The name of the object.
    p1 : point
        A point of the plane.
    p2 : point
        A point in the direction of the normal.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    plane

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, -1, 2); TwoPointPlane deck(A, B);
    """
    ...
def PlaneThroughPoint(
    name: str,
    /,
    point: _Point,
    plane: _Plane,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PlaneHandle:
    """The plane through a point, parallel to another plane.

    Parameters
    ----------
    name : str
        The name of the object.
    point : point
        A point of the plane.
    plane : plane
        Reference plane.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    plane

    Notes
    -----
    In the language::

        AbsPoint A(1, 2, 3); ZPlane water(0); PlaneThroughPoint deck(A, water);
    """
    ...
def TanPlane(
    name: str,
    /,
    magnet: _Magnet,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PlaneHandle:
    """The tangent plane of a surface at a magnet, with the surface's normal; at a pole the limit along
    the parameter line through the magnet.

    Parameters
    ----------
    name : str
        The name of the object.
    magnet : magnet
        The point of contact.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    plane

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0.25, 0.5); TanPlane t(p);
    """
    ...
def NormalPlane(
    name: str,
    /,
    bead: _Bead,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> PlaneHandle:
    """The plane normal to a curve at a bead; its normal is the tangent, in the direction of increasing
    parameter.

    Parameters
    ----------
    name : str
        The name of the object.
    bead : bead
        The point of intersection with the curve.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    plane

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(3, 2, 1); BCurve c({A, B, C}); AbsBead b(c, 0.25); NormalPlane across(b);
    """
    ...
def ThreePointFrame(
    name: str,
    /,
    p1: _Point,
    p2: _Point,
    p3: _Point,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> FrameHandle:
    """The frame of three points: the first is the origin, the second is on the positive x axis, and
    the third is in the xy plane with y > 0.

    Parameters
    ----------
    name : str
        The name of the object.
    p1 : point
        Origin.
    p2 : point
        A point of the positive x axis.
    p3 : point
        A point of the xy plane.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    frame

    Notes
    -----
    In the language::

        AbsPoint A(1, 0, 0); AbsPoint B(2, 0.5, 0); AbsPoint C(0, 1, 0.25); ThreePointFrame f(A, B, C); FramePoint p(A, f, 1, 2, 3);
    """
    ...
def RPYFrame(
    name: str,
    /,
    point: _Point,
    roll: _Number | None = ...,
    pitch: _Number | None = ...,
    yaw: _Number | None = ...,
    frame: _Frame | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> FrameHandle:
    """The frame at a point, rotated from the axes of another frame (default: world) by yaw about z,
    then pitch about the new y, then roll about the new x; all right-handed.

    Parameters
    ----------
    name : str
        The name of the object.
    point : point
        Origin.
    roll : number, optional
        Angle about the x axis. Default 0.
    pitch : number, optional
        Angle about the y axis. Default 0.
    yaw : number, optional
        Angle about the z axis. Default 0.
    frame : frame, optional
        Frame of the initial axes; default: world axes.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    frame

    Notes
    -----
    In the language::

        AbsPoint A(1, 0, 0); RPYFrame keel(A, 0.35, 0, 0.1); FramePoint p(A, keel, 0, 0, -3); RPYFrame bulb(p, 0, -0.2, 0, keel); FramePoint q(p, bulb, 1, 2, 3);
    """
    ...
def XContours(
    name: str,
    /,
    first: _Integer,
    last: _Integer,
    start: _Number,
    step: _Number,
    surfaces: Sequence[object] | _Array | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> ContoursHandle:
    """Sections x = start + i step, for i from first to last: the stations of a hull.

    Parameters
    ----------
    name : str
        The name of the object.
    first : integer
        First index i.
    last : integer
        Last index i.
    start : number
        Position of the section with index 0.
    step : number
        Distance of neighbouring sections.
    surfaces : list of value, optional
        Surfaces and bodies to cut; default: all visible ones.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    contours

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, -1); AbsPoint B(30, 0, -1.5); AbsPoint C(0, 3, 2); AbsPoint D(15, 8, 2); AbsPoint E(30, 4, 2.5); Line keel(A, B); BCurve sheer({C, D, E}, 2); RuledSurf hull(keel, sheer); XContours stations(0, 10, 1.8, 2.735);
    """
    ...
def YContours(
    name: str,
    /,
    first: _Integer,
    last: _Integer,
    start: _Number,
    step: _Number,
    surfaces: Sequence[object] | _Array | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> ContoursHandle:
    """Sections y = start + i step, for i from first to last: the buttocks of a hull.

    Parameters
    ----------
    name : str
        The name of the object.
    first : integer
        First index i.
    last : integer
        Last index i.
    start : number
        Position of the section with index 0.
    step : number
        Distance of neighbouring sections.
    surfaces : list of value, optional
        Surfaces and bodies to cut; default: all visible ones.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    contours

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, -1); AbsPoint B(30, 0, -1.5); AbsPoint C(0, 3, 2); AbsPoint D(15, 8, 2); AbsPoint E(30, 4, 2.5); Line keel(A, B); BCurve sheer({C, D, E}, 2); RuledSurf hull(keel, sheer); YContours buttocks(0, 4, 0.5, 0.75);
    """
    ...
def ZContours(
    name: str,
    /,
    first: _Integer,
    last: _Integer,
    start: _Number,
    step: _Number,
    surfaces: Sequence[object] | _Array | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> ContoursHandle:
    """Sections z = start + i step, for i from first to last: the waterlines of a hull.

    Parameters
    ----------
    name : str
        The name of the object.
    first : integer
        First index i.
    last : integer
        Last index i.
    start : number
        Position of the section with index 0.
    step : number
        Distance of neighbouring sections.
    surfaces : list of value, optional
        Surfaces and bodies to cut; default: all visible ones.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    contours

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, -1); AbsPoint B(30, 0, -1.5); AbsPoint C(0, 3, 2); AbsPoint D(15, 8, 2); AbsPoint E(30, 4, 2.5); Line keel(A, B); BCurve sheer({C, D, E}, 2); RuledSurf hull(keel, sheer); ZContours waterlines(-2, 4, 0, 0.5);
    """
    ...
def PlaneContours(
    name: str,
    /,
    plane: _Plane,
    first: _Integer,
    last: _Integer,
    start: _Number,
    step: _Number,
    surfaces: Sequence[object] | _Array | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> ContoursHandle:
    """Sections by planes parallel to a given plane, at the distances start + i step along its normal,
    for i from first to last: diagonals, cant frames.

    Parameters
    ----------
    name : str
        The name of the object.
    plane : plane
        The plane at distance 0.
    first : integer
        First index i.
    last : integer
        Last index i.
    start : number
        Distance of the section with index 0 from the plane.
    step : number
        Distance of neighbouring sections.
    surfaces : list of value, optional
        Surfaces and bodies to cut; default: all visible ones.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    contours

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 0.5, 2); TwoPointPlane deck(A, B); AbsPoint P(0, 0, -1); AbsPoint Q(4, 0, -1); AbsPoint R(0, 2, 1.5); AbsPoint S(2, 3, 2.5); AbsPoint T(4, 2, 1.5); Line low(P, Q); BCurve high({R, S, T}, 2); RuledSurf side(low, high); PlaneContours diagonals(deck, 0, 4, -1, 0.5);
    """
    ...
def CylinderContours(
    name: str,
    /,
    line: _Curve,
    first: _Integer,
    last: _Integer,
    start: _Number,
    step: _Number,
    surfaces: Sequence[object] | _Array | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> ContoursHandle:
    """Sections by cylinders about a line, of the radii start + i step, for i from first to last: the
    sections of a propeller blade.

    Parameters
    ----------
    name : str
        The name of the object.
    line : line
        The common axis: the line through the ends of a curve.
    first : integer
        First index i.
    last : integer
        Last index i.
    start : number
        Radius of the section with index 0.
    step : number
        Difference of neighbouring radii.
    surfaces : list of value, optional
        Surfaces and bodies to cut; default: all visible ones.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    contours

    Notes
    -----
    In the language::

        AbsPoint O(0, 0, 0); AbsPoint X(1, 0.25, 0); Line shaft(O, X); AbsPoint P(0, 0, -1); AbsPoint Q(4, 0, -1); AbsPoint R(0, 2, 1.5); AbsPoint S(2, 3, 2.5); AbsPoint T(4, 2, 1.5); Line low(P, Q); BCurve high({R, S, T}, 2); RuledSurf side(low, high); CylinderContours radii(shaft, 0, 8, 1, 0.25);
    """
    ...
def AngleContours(
    name: str,
    /,
    line: _Curve,
    first: _Integer,
    last: _Integer,
    start: _Number,
    step: _Number,
    zero: _Point | None = ...,
    surfaces: Sequence[object] | _Array | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> ContoursHandle:
    """Sections by half-planes through a line, at the angles start + i step about it (right-handed), for
    i from first to last: the meridians of a body of revolution.

    Angle 0 is on the side of the point `zero` or, without one, of the z-axis (of the x-axis when
    the line is within a degree of z).

    Parameters
    ----------
    name : str
        The name of the object.
    line : line
        The common axis: the line through the ends of a curve.
    first : integer
        First index i.
    last : integer
        Last index i.
    start : number
        Angle of the section with index 0, in radians (degrees in model files).
    step : number
        Angle between neighbouring sections, in radians (degrees in model files).
    zero : point, optional
        A point of the half-plane at angle 0.
    surfaces : list of value, optional
        Surfaces and bodies to cut; default: all visible ones.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    contours

    Notes
    -----
    In the language::

        AbsPoint O(0, 0, 0); AbsPoint X(1, 0.25, 0); Line shaft(O, X); AbsPoint up(0, 0.5, 2); AbsPoint P(0, 0, -1); AbsPoint Q(4, 0, -1); AbsPoint R(0, 2, 1.5); AbsPoint S(2, 3, 2.5); AbsPoint T(4, 2, 1.5); Line low(P, Q); BCurve high({R, S, T}, 2); RuledSurf side(low, high); AngleContours meridians(shaft, 0, 3, -1, 0.5); AngleContours others(shaft, 0, 3, 0.25, 0.5, zero = up);
    """
    ...
def RealList(
    name: str,
    /,
    values: _Numbers,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """A list of numbers under a name, accepted wherever a list of numbers is expected.

    Parameters
    ----------
    name : str
        The name of the object.
    values : list of number
        The numbers.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        RealList spacing({0, 0.25, 0.5, 1}); AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); TableRelabel r(spacing, {0, 0.1, 0.4, 1}); Line l(A, B, relabel = r);
    """
    ...
def KnotList(
    name: str,
    /,
    values: _Numbers,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """A named list of knots: non-decreasing numbers, accepted as any list of numbers.

    The spline determines the number of knots and their multiplicity.

    Parameters
    ----------
    name : str
        The name of the object.
    values : list of number
        The knots, two or more, in ascending order; equal ones are multiple knots.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        KnotList k({0, 0, 0, 0.4, 1, 1, 1});
    """
    ...
def EntityList(
    name: str,
    /,
    objects: Sequence[object] | _Array | _Any,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """Objects under a common name, accepted wherever a list of such objects is expected: the wetted
    surfaces, the points of a curve.

    A list among the objects adds its own.

    Parameters
    ----------
    name : str
        The name of the object.
    objects : list of value
        The objects.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    list

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 0); AbsPoint C(2, 2, 1); EntityList ends({A, B}); EntityList all({ends, C}); BCurve c(all, degree = 2);
    """
    ...
def FairCurve(
    name: str,
    /,
    points: _Vectors,
    tolerance: _Number,
    measure: _Text | None = ...,
    as_: _Text | None = ...,
    breaks: Sequence[_Integer] | _Array | _Any | None = ...,
    ends: _Text | None = ...,
    mode: _Text | None = ...,
    degree: _Integer | None = ...,
    closed: _Integer | None = ...,
    joins: Sequence[_Curve] | _Any | None = ...,
    weights: _Numbers | None = ...,
    knots: _Numbers | None = ...,
    spacing: _Text | None = ...,
    goal: _Text | None = ...,
    along: _Vector | None = ...,
    motion: _Text | None = ...,
    share: _Number | None = ...,
    shape: Sequence[_Text] | _Any | None = ...,
    tolerances: _Numbers | None = ...,
    fixed: Sequence[_Integer] | _Array | _Any | None = ...,
    release: Sequence[_Integer] | _Array | _Any | None = ...,
    through_at: _Numbers | None = ...,
    tangents: _Vectors | None = ...,
    tangents_at: _Numbers | None = ...,
    bends: _Integer | None = ...,
    at: _Numbers | None = ...,
    last_end: _Text | None = ...,
    bound: _Text | None = ...,
    count: _Integer | None = ...,
    period: _Number | None = ...,
    steps: _Integer | None = ...,
    least_move: _Number | None = ...,
    least_drop: _Number | None = ...,
    stop_gap: _Number | None = ...,
    stop_pieces: _Integer | None = ...,
    through: _Vectors | None = ...,
    keep: Sequence[_Text] | _Any | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A fair B-spline curve within a tolerance of its points.

    The curve minimises `measure` among all splines with knots at the points, within the
    tolerance of each point; `goal` selects how far the data are smoothed. Data that are as
    fair as the tolerance allows are interpolated unchanged. Parameters and knots follow the
    spacing of the points, and the result depends continuously on the points.

    Members: `deviation` (largest distance of a point from the curve), `value` (the
    measure), `gap` (upper bound on how much lower the measure of any admissible curve can
    be), `active` (number of tolerances reached), `used` (mean squared residual relative to
    noise that fills the tolerance), `fairest_used` (the same for the fairest curve) and
    `findings` (number of points that do not fit their neighbours).

    Control points are moved instead of data with `as = "control"`, `knots`, `weights`,
    `count`, a `bound` of "curve" or "points" and every `mode` except "optimum".
    Members are then `deviation` (largest move of a control point or point; with `knots`,
    `weights` or `count` the largest distance of a point), `value`, `gap`, and `active` for
    the optimum or `steps` for the other modes.

    Points on a line, conic, plane cubic or helix do not move, unless `goal` is "fairest".
    Mode "faithful" repeats the removal and re-insertion of the worst knot (Farin and
    Sapidis 1989), one step per point; its result may jump where two knots are equally bad.

    Differences from the Python function: `breaks` and `release` are numbers, never "auto";
    `ends` are words; the log of single steps is available from the command (`moldloft fair
    model.sdl:name --log`); there are no `accuracy` (optima are solved to rounding, so that
    derivatives exist), no `original` and no `draft`, which is for pictures while a tolerance
    slides.

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of point
        Points, at least degree + 2 (closed: 2 degree + 2).
    tolerance : number
        Largest distance of each point from the curve, in units of length; 0: interpolation. At
        least 0.
    measure : text, optional
        Measure to minimise: "second" or "third" (squared differences of control points),
        "jumps" or "jump-lengths" (squares or lengths of the jumps of the highest derivative),
        "bending" or "variation" (integral of the squared second or third derivative). Default:
        "variation" for data ("bending" below degree 3), "second" where control points move.
    as : text, optional
        Role of the points: "fit" (data on the curve; default for the optimum), "control"
        (control points of a uniform spline, which does not end at its points; default for the
        other modes) or "points" (faired, then interpolated; for the optimum the same as "fit",
        except with `spacing = "index"`).
    breaks : list of integer, optional
        Numbers, from 1, of points that are intended breaks: they do not move, nothing is
        smoothed across them, and the curve has corners at them. A closed curve starts at the
        first of them.
    ends : text, optional
        Condition at open ends, relative to the curve through the points: "free" (within the
        tolerance), "position", "tangent", "curvature" or a number of fixed control points.
        Default: "free" for data, "tangent" for fits whose control points move, otherwise "2".
    mode : text, optional
        "optimum", or stepwise: "faithful" (removal and re-insertion of knots, longest
        achievable move first), "literal" (largest jump first; may stall), "vertex" (each
        control point to its own minimum), "sweeps" (all points in order) or "levels"
        (multilevel cycles). "sweeps" and "levels" have no derivatives. Default optimum.
    degree : integer, optional
        Polynomial degree. 2 to 9, default 3.
    closed : integer, optional
        1 for a closed curve, whose first point is not repeated. 0 to 1, default 0.
    joins : list of curve, optional
        Curves to continue with the same tangent direction and curvature; each begins or ends at
        the first or last point. They are not changed. `ends` applies to an end without a
        neighbour.
    weights : list of number, optional
        Positive weights of the control points, constant (`as = "control"`, or a fit with as
        many control points as points): the curve is rational. No derivatives with respect to
        them.
    knots : list of number, optional
        Knots of the control points (`as = "control"`) or of a fit, constant. Open: number of
        control points + degree + 1, non-decreasing; closed: number of control points,
        increasing. In a fit they determine the number of control points.
    spacing : text, optional
        Parametrisation of the points: "chord", "centripetal", a coordinate ("x", "y" or "z",
        for offsets at stations), "index", or "curvature" (chord lengths, extended where the
        curve turns). "auto" is "curvature" for the goals "near" and "budget" without further
        conditions, otherwise "chord"; with control points it is "index". Default auto.
    goal : text, optional
        Selects the result within the tolerance: "near" (residuals up to the level of noise that
        fills the tolerance; data with little to gain do not move), "budget" (the same, without
        the exception), "fairest" (minimum of the measure), "nearest" (nearest to the points
        with a measure at most `share` above the minimum), "energy" (nearest with a measure of
        at most `share`) or, for curves, "closest" (nearest with the given `shape`). Default
        near.
    along : vector, optional
        Direction in which points may move, such as {0, 1, 0} for offsets at fixed stations.
        Default: any direction.
    motion : text, optional
        "across" (points move in the plane perpendicular to `along`) or "box" (each coordinate
        is bounded separately). Default: along `along`, or in any direction without it.
    share : number, optional
        Parameter of the goal. "near" and "budget": mean squared residual relative to noise that
        fills the tolerance; default 0.5 for plane curves with free motion, otherwise 0.8; 0.3
        for networks that noise does not explain ("budget": 0.8). "nearest": relative excess of
        the measure, default 0.1. "energy": the largest measure, required.
    shape : list of text, optional
        Shape conditions, with numbers of points from 1: "convex=4-10", "concave=1-4", "one-
        way=1-9" (no inflection), "straight=1-9", "straight=1-9:0,1" (in a direction),
        "arc=9-15", "pieces=2" (number of pieces with monotone curvature), "within=0,1:4.6"
        (largest coordinate along a direction), "side=0,-1" (points may be left only against
        this direction). A word without numbers applies to the whole curve. No derivatives.
    tolerances : list of number, optional
        Tolerances of the individual points, instead of `tolerance`.
    fixed : list of integer, optional
        Numbers, from 1, of points that do not move.
    release : list of integer, optional
        Numbers, from 1, of faulty points: the curve may leave them.
    through_at : list of number, optional
        Parameters of `through`, from 0 to 1.
    tangents : list of vector, optional
        Tangent directions at `tangents_at`. No derivatives.
    tangents_at : list of number, optional
        Parameters of `tangents`, from 0 to 1.
    bends : integer, optional
        1 allows more inflections and monotone pieces of curvature than the fairest curve within
        the tolerances has; 0 removes them. With 0, derivatives exist where there is nothing to
        remove. 0 to 1, default 0.
    at : list of number, optional
        Parameters of the individual points, increasing, instead of `spacing` (closed: within a
        range of less than 1).
    last_end : text, optional
        Condition at the end, if different from the start (`ends`).
    bound : text, optional
        Quantity that the tolerance bounds: "data" (distance of each point from the curve;
        default for optima of data), "curve" (distance of the curve from the initial one,
        everywhere; default for other fits) or "points" (move of each control point; default for
        control points). "curve" and "points" have derivatives if the parameters are constant
        (`spacing = "index"`).
    count : integer, optional
        Number of control points of a least-squares fit, less than the number of points. No
        derivatives. At least 3.
    period : number, optional
        Period of the `knots` of a closed curve. Default: 1.
    steps : integer, optional
        Number of steps in the modes "faithful", "literal" and "vertex" (default: one per
        point), of sweeps (10) or of multilevel cycles (2). 0 to 1e+07.
    least_move : number, optional
        Single steps stop when the next move is shorter than this fraction of the tolerance; 0:
        never. At least 0, default 0.
    least_drop : number, optional
        Single steps stop when a step reduces the measure by less than this fraction; 0: never.
        At least 0, default 0.
    stop_gap : number, optional
        Single steps stop when the certified gap is below this fraction of the measure; 0:
        never. At least 0, default 0.
    stop_pieces : integer, optional
        1: single steps stop when the number of pieces with monotone curvature has not decreased
        for n steps, with n the number of points. 0 to 1, default 0.
    through : list of point, optional
        Points on the curve at `through_at`. No derivatives.
    keep : list of text, optional
        Quantities of the initial curve that are preserved to first order: "area" (swept about
        the origin in the plane of x and y), "volume" (of revolution about x) or "centroid" (of
        the control points). No derivatives.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 0.52, 0); AbsPoint C(2, 0.83, 0); AbsPoint D(3, 0.88, 0); AbsPoint E(4, 0.81, 0); AbsPoint F(5, 0.49, 0); AbsPoint G(6, 0, 0); FairCurve c({A, B, C, D, E, F, G}, 0.05);
    """
    ...
def FairSnake(
    name: str,
    /,
    magnets: Sequence[_Magnet] | _Any,
    tolerance: _Number,
    measure: _Text | None = ...,
    ends: _Text | None = ...,
    mode: _Text | None = ...,
    degree: _Integer | None = ...,
    spacing: _Text | None = ...,
    goal: _Text | None = ...,
    share: _Number | None = ...,
    breaks: Sequence[_Integer] | _Array | _Any | None = ...,
    shape: Sequence[_Text] | _Any | None = ...,
    tolerances: _Numbers | None = ...,
    fixed: Sequence[_Integer] | _Array | _Any | None = ...,
    release: Sequence[_Integer] | _Array | _Any | None = ...,
    through_at: _Numbers | None = ...,
    tangents: _Vectors | None = ...,
    tangents_at: _Numbers | None = ...,
    bends: _Integer | None = ...,
    at: _Numbers | None = ...,
    last_end: _Text | None = ...,
    bound: _Text | None = ...,
    count: _Integer | None = ...,
    period: _Number | None = ...,
    steps: _Integer | None = ...,
    least_move: _Number | None = ...,
    least_drop: _Number | None = ...,
    stop_gap: _Number | None = ...,
    stop_pieces: _Integer | None = ...,
    along: _Vector | None = ...,
    motion: _Text | None = ...,
    weights: _Numbers | None = ...,
    knots: _Numbers | None = ...,
    through: Sequence[_Magnet] | _Any | None = ...,
    as_: _Text | None = ...,
    closed: _Integer | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SnakeHandle:
    """A fair curve on a surface near magnets: its path in the parameter plane is faired.

    The tolerance and the members are distances in the parameter plane. The options are
    those of `FairCurve`, applied to the path: directions are {u, v, 0}, "x" is u and "y" is
    v. There are no `joins` and no `keep`, which refer to space.

    Parameters
    ----------
    name : str
        The name of the object.
    magnets : list of magnet
        Magnets on one surface, at least degree + 2 (closed: 2 degree + 2).
    tolerance : number
        Largest distance of each magnet from the path, in u and v; 0: interpolation. At least 0.
    measure : text, optional
        Measure to minimise; see `FairCurve`.
    ends : text, optional
        Condition at the ends: "position", "tangent" or "curvature". Default: "position".
    mode : text, optional
        "optimum", or a stepwise mode; see `FairCurve`. Default optimum.
    degree : integer, optional
        Polynomial degree of the path. 2 to 9, default 3.
    spacing : text, optional
        Parametrisation of the magnets along the path, as for `FairCurve`: "chord",
        "centripetal", "x" (u) or "y" (v) if monotone, "index" or "curvature". "auto" is
        "chord", with control points "index". Default auto.
    goal : text, optional
        Selects the result within the tolerance: "near" (residuals up to the level of noise that
        fills the tolerance; data with little to gain do not move), "budget" (the same, without
        the exception), "fairest" (minimum of the measure), "nearest" (nearest to the points
        with a measure at most `share` above the minimum), "energy" (nearest with a measure of
        at most `share`) or, for curves, "closest" (nearest with the given `shape`). Default
        near.
    share : number, optional
        Parameter of the goal. "near" and "budget": mean squared residual relative to noise that
        fills the tolerance; default 0.5 for plane curves with free motion, otherwise 0.8; 0.3
        for networks that noise does not explain ("budget": 0.8). "nearest": relative excess of
        the measure, default 0.1. "energy": the largest measure, required.
    breaks : list of integer, optional
        Numbers of magnets, from 1, that are intended breaks: they do not move, and the path has
        corners there.
    shape : list of text, optional
        Shape conditions, with numbers of points from 1: "convex=4-10", "concave=1-4", "one-
        way=1-9" (no inflection), "straight=1-9", "straight=1-9:0,1" (in a direction),
        "arc=9-15", "pieces=2" (number of pieces with monotone curvature), "within=0,1:4.6"
        (largest coordinate along a direction), "side=0,-1" (points may be left only against
        this direction). A word without numbers applies to the whole curve. No derivatives.
    tolerances : list of number, optional
        Tolerances of the individual points, instead of `tolerance`.
    fixed : list of integer, optional
        Numbers, from 1, of points that do not move.
    release : list of integer, optional
        Numbers, from 1, of faulty points: the curve may leave them.
    through_at : list of number, optional
        Parameters of `through`, from 0 to 1.
    tangents : list of vector, optional
        Tangent directions at `tangents_at`. No derivatives.
    tangents_at : list of number, optional
        Parameters of `tangents`, from 0 to 1.
    bends : integer, optional
        1 allows more inflections and monotone pieces of curvature than the fairest curve within
        the tolerances has; 0 removes them. With 0, derivatives exist where there is nothing to
        remove. 0 to 1, default 0.
    at : list of number, optional
        Parameters of the individual points, increasing, instead of `spacing` (closed: within a
        range of less than 1).
    last_end : text, optional
        Condition at the end, if different from the start (`ends`).
    bound : text, optional
        Quantity that the tolerance bounds: "data" (distance of each point from the curve;
        default for optima of data), "curve" (distance of the curve from the initial one,
        everywhere; default for other fits) or "points" (move of each control point; default for
        control points). "curve" and "points" have derivatives if the parameters are constant
        (`spacing = "index"`).
    count : integer, optional
        Number of control points of a least-squares fit, less than the number of points. No
        derivatives. At least 3.
    period : number, optional
        Period of the `knots` of a closed curve. Default: 1.
    steps : integer, optional
        Number of steps in the modes "faithful", "literal" and "vertex" (default: one per
        point), of sweeps (10) or of multilevel cycles (2). 0 to 1e+07.
    least_move : number, optional
        Single steps stop when the next move is shorter than this fraction of the tolerance; 0:
        never. At least 0, default 0.
    least_drop : number, optional
        Single steps stop when a step reduces the measure by less than this fraction; 0: never.
        At least 0, default 0.
    stop_gap : number, optional
        Single steps stop when the certified gap is below this fraction of the measure; 0:
        never. At least 0, default 0.
    stop_pieces : integer, optional
        1: single steps stop when the number of pieces with monotone curvature has not decreased
        for n steps, with n the number of points. 0 to 1, default 0.
    along : vector, optional
        Direction in which points may move, such as {0, 1, 0} for offsets at fixed stations.
        Default: any direction.
    motion : text, optional
        "across" (points move in the plane perpendicular to `along`) or "box" (each coordinate
        is bounded separately). Default: along `along`, or in any direction without it.
    weights : list of number, optional
        Positive weights of the control points, constant (`as = "control"`, or a fit with as
        many control points as points): the curve is rational. No derivatives with respect to
        them.
    knots : list of number, optional
        Knots of the control points (`as = "control"`) or of a fit, constant. Open: number of
        control points + degree + 1, non-decreasing; closed: number of control points,
        increasing. In a fit they determine the number of control points.
    through : list of magnet, optional
        Magnets on the path at `through_at`. No derivatives.
    as : text, optional
        Role of the magnets; see `FairCurve`.
    closed : integer, optional
        1: closed path; the first magnet is not repeated. 0 to 1, default 0.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    snake

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 3); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); AbsMagnet p(S, 0, 0.2); AbsMagnet q(S, 0.3, 0.32); AbsMagnet r(S, 0.5, 0.29); AbsMagnet s(S, 0.7, 0.33); AbsMagnet t(S, 1, 0.2); FairSnake f({p, q, r, s, t}, 0.02);
    """
    ...
def FairSurf(
    name: str,
    /,
    points: _Vectors,
    tolerance: _Number,
    measure: _Text | None = ...,
    as_: _Text | None = ...,
    degree: _Integer | None = ...,
    breaks_u: Sequence[_Integer] | _Array | _Any | None = ...,
    breaks_v: Sequence[_Integer] | _Array | _Any | None = ...,
    mode: _Text | None = ...,
    passes: _Integer | None = ...,
    rims: object | None = ...,
    weights: _Numbers | None = ...,
    knots_u: _Numbers | None = ...,
    knots_v: _Numbers | None = ...,
    spacing: _Text | None = ...,
    goal: _Text | None = ...,
    along: _Vector | None = ...,
    motion: _Text | None = ...,
    degree_v: _Integer | None = ...,
    closed_u: _Integer | None = ...,
    closed_v: _Integer | None = ...,
    share: _Number | None = ...,
    tolerances: _Numbers | None = ...,
    fixed: Sequence[_Integer] | _Array | _Any | None = ...,
    through: _Vectors | None = ...,
    through_u: _Numbers | None = ...,
    through_v: _Numbers | None = ...,
    normals: _Vectors | None = ...,
    normals_u: _Numbers | None = ...,
    normals_v: _Numbers | None = ...,
    keep: Sequence[_Text] | _Any | None = ...,
    bound: _Text | None = ...,
    steps: _Integer | None = ...,
    order: _Text | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A fair B-spline surface within a tolerance of a grid of points.

    All rows and columns of the control net are faired together: the sum of the measure over
    both directions is minimal within the tolerance. The four corners keep position,
    tangents and twist. Mode "faithful" fairs curve after curve, those of constant v first,
    then those of constant u, in `passes` passes of three steps per point; its result
    depends on this order and may jump where two knots are equally bad.

    Parameters
    ----------
    name : str
        The name of the object.
    points : curve or surface
        Grid of points, at least degree + 2 in each direction.
    tolerance : number
        Largest distance of each point from the surface (`as = "control"`: of the surface from
        the initial one), in units of length; 0: unchanged. At least 0.
    measure : text, optional
        Measure to minimise; see `FairCurve`. Default second.
    as : text, optional
        Role of the points: "fit" (interpolated, then faired) or "control" (control points of a
        uniform surface, which does not end at its points). Default fit.
    degree : integer, optional
        Polynomial degree along u, and along v without `degree_v`. 2 to 9, default 3.
    breaks_u : list of integer, optional
        Rows (numbers of points along u, from 1) that are knuckle lines: their points do not
        move, nothing is smoothed across them, and the surface has a sharp edge there.
    breaks_v : list of integer, optional
        Columns that are knuckle lines; see `breaks_u`.
    mode : text, optional
        "optimum", "faithful", or "sweeps": all points in order, each to its own minimum, for
        nets too large for the optimum. Sweeps have no derivatives. Default optimum.
    passes : integer, optional
        Passes of the mode "faithful". 1 to 100, default 1.
    rims : value, optional
        Condition at the rims: "corners" (only these are kept), "position", "tangent" or
        "curvature", or a list of four for v = 0, u = 1, v = 1 and u = 0. Default corners.
    weights : farray, optional
        Positive weights of the control points (`as = "control"`), constant, a grid of the same
        shape as the points: the surface is rational. No derivatives with respect to them.
    knots_u : list of number, optional
        Knots along u of the control points (`as = "control"`), constant, non-decreasing: number
        of control points + degree + 1.
    knots_v : list of number, optional
        Knots along v; see `knots_u`.
    spacing : text, optional
        Parametrisation, as for `FairCurve`: the mean over all lines of the grid in each
        direction. The mode "faithful" and control points use "index". Default chord.
    goal : text, optional
        Selects the result within the tolerance: "near" (residuals up to the level of noise that
        fills the tolerance; data with little to gain do not move), "budget" (the same, without
        the exception), "fairest" (minimum of the measure), "nearest" (nearest to the points
        with a measure at most `share` above the minimum), "energy" (nearest with a measure of
        at most `share`) or, for curves, "closest" (nearest with the given `shape`). Default
        near.
    along : vector, optional
        Direction in which points may move, such as {0, 1, 0} for offsets at fixed stations.
        Default: any direction.
    motion : text, optional
        "across" (points move in the plane perpendicular to `along`) or "box" (each coordinate
        is bounded separately). Default: along `along`, or in any direction without it.
    degree_v : integer, optional
        Polynomial degree along v. Default: `degree`. 2 to 9.
    closed_u : integer, optional
        1: closed along u; the first row of points is not repeated. 0 to 1, default 0.
    closed_v : integer, optional
        1: closed along v; the first column of points is not repeated. 0 to 1, default 0.
    share : number, optional
        Parameter of the goal. "near" and "budget": mean squared residual relative to noise that
        fills the tolerance; default 0.5 for plane curves with free motion, otherwise 0.8; 0.3
        for networks that noise does not explain ("budget": 0.8). "nearest": relative excess of
        the measure, default 0.1. "energy": the largest measure, required.
    tolerances : farray, optional
        Tolerances of the individual points, a grid of the same shape, instead of `tolerance`.
    fixed : list of integer, optional
        Numbers, from 1, of points on the surface: (i - 1) n + j in a grid [m, n].
    through : list of point, optional
        Points on the surface at `through_u`, `through_v`. No derivatives.
    through_u : list of number, optional
        Parameters of `through` along u, from 0 to 1.
    through_v : list of number, optional
        Parameters of `through` along v, from 0 to 1.
    normals : list of vector, optional
        Normal directions of the surface at `normals_u`, `normals_v`. No derivatives.
    normals_u : list of number, optional
        Parameters of `normals` along u, from 0 to 1.
    normals_v : list of number, optional
        Parameters of `normals` along v, from 0 to 1.
    keep : list of text, optional
        Quantities of the surface through the points that are preserved to first order: "volume"
        (the displacement of a hull) or "area". No derivatives.
    bound : text, optional
        Quantity that the tolerance bounds in the optimum: "data" (distance of each point from
        the surface; default for fits), "points" (move of each control point) or "curve"
        (distance of the surface from the initial one, which allows larger moves of control
        points).
    steps : integer, optional
        Steps per point of each curve in the mode "faithful" (default 3), or number of sweeps
        (default 50). 1 to 100000.
    order : text, optional
        Order of the curves in a pass of the mode "faithful": "vu" (those of constant v first;
        default) or "uv".
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        Line a({0, 0, 0}, {4, 0, 0}); farray t = uniform(0, 1, 5); surface g[5, 5]; vector up = {0, 1, 0.3}; g[1,] = distc(a, t); g[2,] = g[1,] + up; g[3,] = g[2,] + {0, 1, 0.1}; g[4,] = g[2,] + {0, 2, 0}; g[5,] = g[1,] + {0, 4, 0}; FairSurf s(g, 0.02);
    """
    ...
def FairNet(
    name: str,
    /,
    curves: Sequence[object] | _Array | _Any,
    tolerance: _Number,
    measure: _Text | None = ...,
    breaks: _Vectors | None = ...,
    kept_ends: _Text | None = ...,
    along: _Vector | None = ...,
    motion: _Text | None = ...,
    degree: _Integer | None = ...,
    mode: _Text | None = ...,
    passes: _Integer | None = ...,
    spacing: _Text | None = ...,
    goal: _Text | None = ...,
    share: _Number | None = ...,
    fixed: _Vectors | None = ...,
    tolerances: _Numbers | None = ...,
    tolerances_at: _Vectors | None = ...,
    steps: _Integer | None = ...,
    bound: _Text | None = ...,
    shape: Sequence[_Text] | _Any | None = ...,
    knuckles: Sequence[_Integer] | _Array | _Any | None = ...,
    release: _Vectors | None = ...,
    keep: Sequence[_Text] | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """Curves with common points, faired together within a tolerance: stations, waterlines and
    buttocks of a hull.

    Each curve is a list of points; a point object in several lists is common to these
    curves (points with equal coordinates are not). All points move together, each at most
    by the tolerance, so that the sum of the measure over all curves is minimal; each curve
    then interpolates its moved points, so that intersections are preserved. A list that
    ends with its first point is a closed curve. The value is the list of the faired curves:
    `net[2]` is the second, `NetCurve` makes it an object. Options refer to curves by number,
    from 1.

    Parameters
    ----------
    name : str
        The name of the object.
    curves : list of value
        Curves, each a list of at least degree + 2 points (closed: 2 degree + 2).
    tolerance : number
        Largest move of each point, in units of length; 0: unchanged. At least 0.
    measure : text, optional
        Measure to minimise; see `FairCurve`. Default second.
    breaks : list of point, optional
        Intended breaks: these points do not move, nothing is smoothed across them, and the
        curves have corners there.
    kept_ends : text, optional
        Fixed ends of open curves: "corners" (ends of all curves through them), "ends" (all) or
        "none". Default corners.
    along : vector, optional
        Direction in which points may move, such as {0, 1, 0} for offsets at fixed stations.
        Default: any direction.
    motion : text, optional
        "across" (points move in the plane perpendicular to `along`) or "box" (each coordinate
        is bounded separately). Default: along `along`, or in any direction without it.
    degree : integer, optional
        Polynomial degree. 2 to 9, default 3.
    mode : text, optional
        "optimum", or "faithful": curve after curve in the order of the list, by removal and re-
        insertion of knots, `steps` per point. The result of "faithful" depends on this order
        and may jump where two knots are equally bad. Default optimum.
    passes : integer, optional
        Passes of the mode "faithful". 1 to 100, default 1.
    spacing : text, optional
        Parametrisation of the points of each curve; see `FairCurve`. A coordinate is used for
        the curves along which it is monotone, chord lengths for the others. The mode "faithful"
        uses "index". Default chord.
    goal : text, optional
        Selects the result within the tolerance: "near" (residuals up to the level of noise that
        fills the tolerance; data with little to gain do not move), "budget" (the same, without
        the exception), "fairest" (minimum of the measure), "nearest" (nearest to the points
        with a measure at most `share` above the minimum), "energy" (nearest with a measure of
        at most `share`) or, for curves, "closest" (nearest with the given `shape`). Default
        near.
    share : number, optional
        Parameter of the goal. "near" and "budget": mean squared residual relative to noise that
        fills the tolerance; default 0.5 for plane curves with free motion, otherwise 0.8; 0.3
        for networks that noise does not explain ("budget": 0.8). "nearest": relative excess of
        the measure, default 0.1. "energy": the largest measure, required.
    fixed : list of point, optional
        Additional fixed points besides those of `kept_ends`.
    tolerances : list of number, optional
        Tolerances of the points in `tolerances_at`, instead of `tolerance`.
    tolerances_at : list of point, optional
        The points with the tolerances of `tolerances`.
    steps : integer, optional
        Steps per point of each curve and pass in the mode "faithful". 1 to 1000, default 3.
    bound : text, optional
        Quantity that the tolerance bounds: "points" (the move of each point) or "curve" (the
        distance of each curve from its initial one, by the smaller tolerance of the two
        neighbouring points). Default points.
    shape : list of text, optional
        Exact shape conditions of curves, given by their numbers: "2: convex", "2:
        straight=3-9:1,0,0" (points from 1), "2..5 at 8..12: straight:1,0,0" (of each curve, its
        points on the others), "2..5 at 8..12: flat:0,1,0" (these in one plane), "3: arc=3-9"
        (on a circle, tangent to adjacent straight runs), "1: tangent=start:1,0,0". No
        derivatives.
    knuckles : list of integer, optional
        Numbers of curves, from 1, along which all curves that cross them break.
    release : list of point, optional
        Wrong points: they move to the curves through the others.
    keep : list of text, optional
        "volume", and with it "centroid": preserved by splines through the sections, if points
        move along one direction. No derivatives.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    list

    Notes
    -----
    In the language::

        AbsPoint A1(0, 0, 0); AbsPoint A2(1, 0.5, 0); AbsPoint A3(2, 0.83, 0); AbsPoint A4(3, 0.88, 0); AbsPoint A5(4, 1.02, 0); AbsPoint B2(1, 0.6, 1); AbsPoint C2(1, 0.72, 2); AbsPoint D2(1, 0.7, 3); AbsPoint E2(1, 0.66, 4); FairNet n({{A1, A2, A3, A4, A5}, {A2, B2, C2, D2, E2}}, 0.05); NetCurve waterline(n, 1); NetCurve station(n, 2);
    """
    ...
def NetCurve(
    name: str,
    /,
    net: object,
    index: _Integer,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """One curve of a faired network, as an object.

    Parameters
    ----------
    name : str
        The name of the object.
    net : value
        A `FairNet`.
    index : integer
        Number of the curve in the network's list, from 1. At least 1.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(1, 0.52, 0); AbsPoint C(2, 0.83, 0); AbsPoint D(3, 0.88, 0); AbsPoint E(4, 0.81, 0); FairNet n({{A, B, C, D, E}}, 0.05); NetCurve c(n, 1);
    """
    ...
def FairPatches(
    name: str,
    /,
    surfaces: Sequence[_Vectors] | _Any,
    tolerance: _Number,
    measure: _Text | None = ...,
    as_: _Text | None = ...,
    degree: _Integer | None = ...,
    seams: _Text | None = ...,
    rims: object | None = ...,
    goal: _Text | None = ...,
    degree_v: _Integer | None = ...,
    along: _Vector | None = ...,
    motion: _Text | None = ...,
    bound: _Text | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """Surfaces with common edges, faired together within a tolerance, with continuous tangent
    planes or curvature across the edges.

    Each grid of points is a surface; two sides with the same points, in either direction,
    form a seam (also two sides of one surface). All points move together, so that the sum
    of the measure over all curves of the nets is minimal. `seams` is the continuity across
    seams; the ratio of the parameter speeds on both sides is that of the given surfaces.
    Corners that are not on a seam keep position, tangents and twist. The value is the list
    of the faired surfaces: `NetSurf` makes one an object.

    Parameters
    ----------
    name : str
        The name of the object.
    surfaces : list of curve or surface
        Grids of points, each at least degree + 2 in each direction.
    tolerance : number
        Largest move of control points, in units of length; 0: unchanged. At least 0.
    measure : text, optional
        Measure to minimise; see `FairCurve`. Default second.
    as : text, optional
        Role of the points: "fit" (interpolated, then faired) or "control" (control points).
        Default fit.
    degree : integer, optional
        Polynomial degree along u, and along v without `degree_v`. 2 to 9, default 3.
    seams : text, optional
        Continuity across seams: "position", "tangent" or "curvature". Default curvature.
    rims : value, optional
        Condition at rims that are not seams; see `FairSurf`. Default corners.
    goal : text, optional
        "fairest" (minimum of the measure), or "near": the same, except that grids whose lines
        are all exact (lines, conics, plane cubics, helices) move only as far as the continuity
        across seams requires, within a factor of 8. Default near.
    degree_v : integer, optional
        Polynomial degree along v. Default: `degree`. 2 to 9.
    along : vector, optional
        Direction in which points may move, such as {0, 1, 0} for offsets at fixed stations.
        Default: any direction.
    motion : text, optional
        "across" (points move in the plane perpendicular to `along`) or "box" (each coordinate
        is bounded separately). Default: along `along`, or in any direction without it.
    bound : text, optional
        Quantity that the tolerance bounds: "points" (move of each control point) or "curve"
        (move of the surfaces, which allows larger moves of control points). Default points.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    list

    Notes
    -----
    In the language::

        Line a({0, 0, 0}, {4, 0, 0}); farray t = uniform(0, 1, 5); surface g[5, 5]; surface h[5, 5]; vector up = {0, 1, 0.3}; g[1,] = distc(a, t); g[2,] = g[1,] + up; g[3,] = g[2,] + {0, 1, 0.2}; g[4,] = g[2,] + {0, 2, 0.32}; g[5,] = g[1,] + {0, 4, 0.7}; h[1,] = g[5,]; h[2,] = g[5,] + {0, 1, 0.01}; h[3,] = g[5,] + {0, 2, 0}; h[4,] = g[5,] + {0, 3, -0.04}; h[5,] = g[5,] + {0, 4, -0.1}; FairPatches n({g, h}, 0.2); NetSurf first(n, 1); NetSurf second(n, 2);
    """
    ...
def NetSurf(
    name: str,
    /,
    net: object,
    index: _Integer,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """One surface of a `FairPatches`, as an object.

    Members: `deviation` (largest move of its control points) and, for all surfaces together,
    `value`, `gap` and `active`; see `FairCurve`.

    Parameters
    ----------
    name : str
        The name of the object.
    net : value
        A `FairPatches`.
    index : integer
        Number of the surface in the list, from 1. At least 1.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        Line a({0, 0, 0}, {4, 0, 0}); farray t = uniform(0, 1, 5); surface g[5, 5]; g[1,] = distc(a, t); g[2,] = g[1,] + {0, 1, 0.3}; g[3,] = g[1,] + {0, 2, 0.4}; g[4,] = g[1,] + {0, 3, 0.3}; g[5,] = g[1,] + {0, 4, 0}; FairPatches n({g}, 0.02); NetSurf s(n, 1);
    """
    ...
def Field(
    name: str,
    /,
    field: _Field,
    of: Sequence[object] | _Array | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """A named implicit function: the declaration `field f = ...;`.

    Parameters
    ----------
    name : str
        The name of the object.
    field : field
        The function.
    of : list of value, optional
        Objects that it is computed from.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    field

    Notes
    -----
    In the language::

        Field ball(sphere({0, 0, 0}, 1));
    """
    ...
def Set(
    name: str,
    /,
    set: _Set,
    of: Sequence[object] | _Array | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """A named set: the declaration `set s = ...;`.

    Parameters
    ----------
    name : str
        The name of the object.
    set : set
        The set.
    of : list of value, optional
        Objects from which it is computed.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        Set ball(set(sphere({0, 0, 0}, 1)));
    """
    ...
def FaceSet(
    name: str,
    /,
    body: _Body,
    faces: Sequence[_Integer] | _Array | _Any | None = ...,
    rounds: _Vectors | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """A closed body of plane and round faces as a set: half-spaces, cylinders and cones, all exact. The
    `body` of a sketch is one.

    A round face is ruled between an arc and a translated and scaled copy of it. Its five vectors
    are, for an arc of an ellipse: centre; half-diameter to the start; conjugate half-diameter;
    translation of the centre; {angle, scale, number of the face}. For a parabola: start;
    intersection of the end tangents; end; translation; {0, scale, number of the face}. The scale is
    1 for cylinders and 0 for a cone whose apex is the translated centre. Velocity x translation
    points outward.

    With more than 200 faces, with too many intersections for a list of half-spaces, or with round
    faces in contact, the set is defined by distances from the triangles.

    Parameters
    ----------
    name : str
        The name of the object.
    body : mesh
        The body; the triangles of round faces are inscribed.
    faces : list of integer, optional
        Face number of each triangle; by default the triangles of one plane are a face.
    rounds : list of vector, optional
        The round faces, as five vectors each.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    set

    Notes
    -----
    In the language::

        MeshBody b({{0,0,0}, {1,0,0}, {0,1,0}, {0,0,1}}, {1,3,2, 1,2,4, 2,3,4, 3,1,4}); FaceSet s(b, {1, 2, 3, 4});
    """
    ...
def SetBody(
    name: str,
    /,
    set: _Set,
    low: _Point | None = ...,
    high: _Point | None = ...,
    depth: _Integer | None = ...,
    accuracy: _Number | None = ...,
    simplify: _Number | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BodyHandle:
    """The surface of a set as triangles: a mesh like any other.

    Each visible primitive gives a patch of panels, named after its set or field (`part.pipe`), with
    its colour, and its material as a tag. Solids are closed, oriented and manifold; faces of the
    box close a solid that it cuts (`part.cap -x`). Sheets are open, wires are polylines and points
    are points. The members `volume` and `centroid` are corrected for the distance of the triangles
    from the surface.

    Parameters
    ----------
    name : str
        The name of the object.
    set : set
        The set.
    low : point, optional
        Low corner of the box; default: bounds of the set, if bounded.
    high : point, optional
        High corner of the box.
    depth : integer, optional
        Number of halvings of the longest side of the box; the cells have 2^-depth of its
        length. Default: 6, without an accuracy. 1 to 16.
    accuracy : number, optional
        Maximum distance of triangle centres from the surface, reached by refinement, estimated.
    simplify : number, optional
        Largest distance from the surface when triangles are merged, in units of length.
        Default: no merging.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    mesh

    Notes
    -----
    In the language::

        set ball = set(sphere({0, 0, 0}, 1)); SetBody b(ball, depth = 4);
    """
    ...
def ConjugateArc(
    name: str,
    /,
    centre: _Point,
    start: _Point,
    quarter: _Point,
    sweep: _Number,
    end: _Point | None = ...,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """An arc of a circle or ellipse by two conjugate half-diameters:
    C(t) = M + (S - M) cos(t sweep) + (Q - M) sin(t sweep).

    It is circular when both half-diameters are perpendicular and equally long. The fillets, circles
    and ellipses of sketches are of this kind.

    Parameters
    ----------
    name : str
        The name of the object.
    centre : point
        Centre M.
    start : point
        Start S, at t = 0.
    quarter : point
        The point Q a quarter turn after the start.
    sweep : number
        The angle swept from t = 0 to 1, in radians; negative turns away from Q.
    end : point, optional
        The point object at t = 1, if any.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        AbsPoint M(0, 0, 0); AbsPoint S(2, 0, 0); AbsPoint Q(0, 1, 0); ConjugateArc c(M, S, Q, 1.5707963267948966);
    """
    ...
def CubicChain(
    name: str,
    /,
    points: _Vectors,
    relabel: _Relabel | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> CurveHandle:
    """A chain of cubic Bézier pieces, each over an equal part of t; neighbours share a point.

    The quadratics and Overhauser cubics of sketches are of this kind.

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of point
        The Bézier points: 3 n + 1 of n pieces.
    relabel : relabel, optional
        Reparametrisation of t (surfaces: v).
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    curve

    Notes
    -----
    In the language::

        CubicChain c({{0,0,0}, {1,1,0}, {2,1,0}, {3,0,0}, {4,-1,0}, {5,0,1}, {6,0,0}});
    """
    ...
def FacePatch(
    name: str,
    /,
    corners: _Vectors,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> SurfaceHandle:
    """A face given by its corners, as a surface for magnets, snakes and projections.

    Four corners P1 to P4 make the bilinear patch with P1 at (0, 0), P2 at (1, 0), P3 at (1, 1) and P4
    at (0, 1); with three, P3 is the whole side v = 1. More corners make the rectangle around them in
    the plane of Newell's normal, u along the line from P1 to P2. The natural normal is that of corners
    that run counter-clockwise.

    Parameters
    ----------
    name : str
        The name of the object.
    corners : list of point
        The corners in order.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    surface

    Notes
    -----
    In the language::

        FacePatch f({{0,0,0}, {4,0,0}, {4,3,0}, {0,3,1}});
    """
    ...
def MeshBody(
    name: str,
    /,
    points: _Vectors,
    triangles: Sequence[_Integer] | _Array | _Any | None = ...,
    volume: _Number | None = ...,
    area: _Number | None = ...,
    centroid: _Vector | None = ...,
    quads: Sequence[_Integer] | _Array | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> BodyHandle:
    """A body bounded by triangles. The solid of a sketch is one.

    Its members are `volume`, `area` and `centroid`: those of the triangles unless better ones are
    given, as sketches do for bodies with curves.

    Parameters
    ----------
    name : str
        The name of the object.
    points : list of vector
        The vertices.
    triangles : list of integer, optional
        Corners of the triangles as numbers of vertices from 1, counter-clockwise from outside.
    volume : number, optional
        Exact volume, if known.
    area : number, optional
        Exact area, if known.
    centroid : vector, optional
        Exact centroid, if known.
    quads : list of integer, optional
        Corners of quadrilateral panels, numbered as for the triangles.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    mesh

    Notes
    -----
    In the language::

        MeshBody b({{0,0,0}, {1,0,0}, {0,1,0}, {0,0,1}}, {1,3,2, 1,2,4, 2,3,4, 3,1,4}); MeshBody plate({{0,0,0}, {1,0,0}, {1,1,0}, {0,1,0}}, quads = {1,2,3,4});
    """
    ...
def Model(
    name: str,
    /,
    symmetry: _Text | None = ...,
    units: _Text | None = ...,
    version: _Text | None = ...,
    lines: Sequence[_Text] | _Any | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """The model's properties: its symmetry planes, units, and the header of its model file.

    A model has one at most. With `symmetry = "y"` the objects are the half on one side of y = 0,
    and hydrostatics count both.

    Parameters
    ----------
    name : str
        The name of the object.
    symmetry : text, optional
        The mirror planes, as letters: "y" for y = 0, "xy" for x = 0 and y = 0.
    units : text, optional
        The units of length, mass, force and angle, at most one of each, such as "m t kN".
    version : text, optional
        The version of the model file, such as "0.35" or "1.44".
    lines : list of text, optional
        The other lines of the model file's header.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    list

    Notes
    -----
    In the language::

        Model info(symmetry = "y", units = "m kg");
    """
    ...
def SolveSet(
    name: str,
    /,
    unknowns: _Numbers,
    conditions: _Numbers,
    steps: _Integer | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """Solves for parameters and numbers of objects that make an equal number of expressions zero, by
    damped Newton iteration from their given values.

    An unknown is a parameter of the program, or a literal number in the declaration of an object:
    `P21.y` of a point, `b.t` of a bead. Objects that depend on it use the solution; ranges of
    parameters and arguments bound the search. The program text keeps the initial value. The
    conditions are expressions, zero when satisfied: `hull.volume - 100`. `s.x` is the solution for
    the unknown x, `s.residual` the largest remaining condition, `s.iterations` the number of steps.

    Parameters
    ----------
    name : str
        The name of the object.
    unknowns : list of number
        Unknowns: parameters, and numbers of objects.
    conditions : list of number
        Conditions, as many as unknowns: expressions that become zero.
    steps : integer, optional
        Maximum number of steps. 1 to 1000, default 50.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        param float x = 1 in [0, 5]; param float y = 1; AbsPoint A(x, y, 0); AbsPoint B(0, 0, 0); Line l(A, B); SolveSet s({x, y}, {l.length - 5, A.x - 0.75*A.y});
    """
    ...
def Weight(
    name: str,
    /,
    at: object,
    mass: _Number | None = ...,
    per: _Number | None = ...,
    group: _Text | None = ...,
    margin: _Number | None = ...,
    status: _Text | None = ...,
    images: _Text | None = ...,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """A mass with its centre: an item of a ship's weight.

    Masses are used as given, also in a mirrored model (`Model info(symmetry = "y")`): `images =
    "y"` adds the mirror image, which doubles the mass and moves the centre into the plane.

    The mass is given, or follows from a mass per length of a curve, per area of a surface, per volume of a solid or
    body. `w.mass` is the mass with its margin, `w.centre`, `w.x`, `w.y`, `w.z` are the centre: numbers of the program.
    `m.weights()` in Python and `moldloft hydro --weights` list all of them by group.

    Parameters
    ----------
    name : str
        The name of the object.
    at : value
        Position: a point or {x, y, z}; or a curve, surface, solid or body whose centroid is the
        centre.
    mass : number, optional
        The mass.
    per : number, optional
        Mass per length of the curve, per area of the surface or per volume of the solid;
        replaces `mass`.
    group : text, optional
        Group in the list of weights.
    margin : number, optional
        A margin that is added to the mass, in percent. Default 0.
    status : text, optional
        Source of the mass: "estimated", "calculated" or "weighed". Default estimated.
    images : text, optional
        Mirror planes: "y" adds the mirror image in y = 0, "" adds no image. Required for a mass
        per area of one half of a symmetric model.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 0, 2); AbsPoint D(4, 1, 3); Line l(A, B); Line m(C, D); RuledSurf S(l, m); Weight plating(S, per = 0.05, group = "hull"); Weight engine({2, 0, 0.5}, mass = 3, group = "machinery", margin = 5); WeightSum light({plating, engine});
    """
    ...
def WeightSum(
    name: str,
    /,
    weights: Sequence[object] | _Array | _Any,
    *,
    colour: _Integer | None = ...,
    visible: _Integer | None = ...,
    layer: _Integer | None = ...,
    divisions: _Integer | str | Sequence[_Integer | str] | _Array | None = ...,
    subdivisions: _Integer | Sequence[_Integer] | None = ...,
    size: _Number | Sequence[_Number] | None = ...,
    spacing: str | _Number | Sequence[str | _Number] | None = ...,
    tags: str | Sequence[str] | None = ...,
    orientation: _Integer | None = ...,
    attributes: _Text | None = ...,
) -> AnyHandle:
    """The sum of weights: their mass and common centre.

    Parameters
    ----------
    name : str
        The name of the object.
    weights : list of value
        Weights, and sums of weights.
    **attributes
        By name, of every kind: colour, visible, layer, divisions, subdivisions, size, spacing,
        tags, orientation, attributes.

    Returns
    -------
    farray

    Notes
    -----
    In the language::

        Weight engine({2, 0, 0.5}, mass = 3); Weight ballast({1, 0, -1}, mass = 2); WeightSum all({engine, ballast});
    """
    ...
