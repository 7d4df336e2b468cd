"""Objects of a model, seen from Python."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, overload

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import Error, ModelError, UnknownNameError
from moldloft.shapes.calculus import CurveCalculus, SurfaceCalculus, broadcast, parameter
from moldloft.shapes.measures import SurfaceMeasures

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from moldloft._core import Document
    from moldloft.fairing.look import Look
    from moldloft.models import Model
    from moldloft.shapes.nurbs import Nurbs
    from moldloft.shapes.searches import Intersection, NearestPoints

    Floats = NDArray[np.float64]

__all__ = [
    "Bead",
    "Body",
    "Contours",
    "Curve",
    "FieldObject",
    "Frame",
    "Magnet",
    "Object",
    "Plane",
    "Point",
    "Relabel",
    "Ring",
    "SetObject",
    "Snake",
    "Solid",
    "Surface",
    "WrongClassError",
    "object_of",
    "wrapped",
]

_OWN = frozenset({"_model", "name"})


class WrongClassError(ModelError, AttributeError):
    """A method or member that objects of this class do not have."""


def wrapped(value: Any) -> Any:
    """Fields and sets in the classes of :mod:`moldloft.implicit`.

    Parameters
    ----------
    value
        Python object for a value of the core; lists are converted item by item.
    """
    if isinstance(value, _core.Field):
        from moldloft.implicit import Field

        return Field(value)
    if isinstance(value, _core.Set):
        from moldloft.implicit import Set

        return Set(value)
    if isinstance(value, list):
        return [wrapped(item) for item in value]
    return value


class Object:
    """A named object of a model.

    It is a reference, not a copy: after a change of the model it shows the new shape. A call
    evaluates a curve or a surface; its numbers are read and written as attributes. Its methods
    depend on its class, which is its type: :class:`Point`, :class:`Curve`, :class:`Surface`, ...

    Examples
    --------
    >>> import moldloft
    >>> m = moldloft.loads("AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); Line edge(A, B);")
    >>> m["edge"]([0, 0.25, 1])
    array([[0. , 0. , 0. ],
           [0.5, 0. , 0. ],
           [2. , 0. , 0. ]])
    >>> m["B"].y = 4
    >>> m["B"].y
    4.0
    >>> m["edge"](0.5)
    array([1., 2., 0.])
    >>> m["edge"].parents
    ['A', 'B']
    """

    _model: Model
    name: str
    """Its name in the model."""

    def __init__(self, model: Model, name: str) -> None:
        object.__setattr__(self, "_model", model)
        object.__setattr__(self, "name", name)

    @property
    def _document(self) -> Document:
        return self._model._document

    @property
    def kind(self) -> str:
        """The entity kind, such as ``"BCurve"``."""
        return str(self._facts()["kind"])

    @property
    def class_(self) -> str:
        """Class, such as ``"point"``, ``"curve"`` or ``"surface"``."""
        return str(self._facts()["class"])

    @property
    def parents(self) -> list[str]:
        """Names of the objects that it depends on directly."""
        return list(self._facts()["parents"])

    @property
    def children(self) -> list[str]:
        """Names of the objects that depend on it directly."""
        return list(self._facts()["children"])

    @property
    def ok(self) -> bool:
        """False if it failed or depends on a failed object."""
        return bool(self._facts()["ok"])

    @property
    def value(self) -> Any:
        """Its value.

        A :class:`moldloft.implicit.Field` or :class:`moldloft.implicit.Set`, an array of
        coordinates, the data of a body.

        >>> import moldloft
        >>> m = moldloft.loads("AbsPoint P(1, 0, 0); field f = sphere(P, 2); set ball = set(f);")
        >>> m["ball"].value, m["f"]([[1, 0, 0], [4, 0, 0]])
        (<set of 1 primitive>, array([-4.,  5.]))
        """
        return wrapped(self._document.eval(self.name))

    def delete(self) -> None:
        """Removes the object from the model and its text; an error if others depend on it.

        Raises
        ------
        ModelError
            While other objects are made of it.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("AbsPoint P(1, 2, 3);")
        >>> m["P"].delete()
        >>> m.keys()
        []
        """
        self._document.delete(self.name)

    def rename(self, name: str) -> None:
        """Gives the object another name, everywhere in the text.

        Parameters
        ----------
        name
            The new name.

        Raises
        ------
        ModelError
            If the name is not one of the language, or used already.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("AbsPoint P(1, 2, 3); AbsPoint Q(P.x, 0, 0);")
        >>> m["P"].rename("stem")
        >>> print(m.text)
        AbsPoint stem(1, 2, 3); AbsPoint Q(stem.x, 0, 0);
        """
        self._document.rename(self.name, name)
        object.__setattr__(self, "name", name)

    @property
    def members(self) -> list[str]:
        """The names of its numbers and parts: ``x`` of a point, ``area`` of a surface.

        >>> import moldloft
        >>> moldloft.loads("AbsPoint A(1, 2, 3);")["A"].members
        ['x', 'y', 'z']
        """
        line = f"{self.name}."
        return [word for word in self._document.complete(line) if word.isidentifier()]

    if not TYPE_CHECKING:
        # Types list the members of each class; others are found when they are used.
        def __getattr__(self, member: str) -> Any:
            if member.startswith("_"):
                raise AttributeError(member)
            if member in _METHODS:
                message = f"`{self.name}` is a {self.class_}; `{member}` is of {_METHODS[member]}"
                raise WrongClassError(message)
            try:
                value = self._document.eval(f"{self.name}.{member}")
                for remark in self._document.expression_remarks():
                    warnings.warn(str(remark), stacklevel=2)
                return value
            except Error as error:
                from moldloft.spelling import nearest

                near = nearest(member, (n for n in dir(self) if n[0] != "_"))
                known = str(error).rstrip()
                hint = f"\nhelp: did you mean `{near}`?" if near and "help:" not in known else ""
                raise AttributeError(known + hint) from error

    def __setattr__(self, member: str, value: float) -> None:
        if member in _OWN or isinstance(getattr(type(self), member, None), property):
            raise AttributeError(f"`{member}` of an object cannot be set")
        self._document.set([(f"{self.name}.{member}", float(value))])

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self.members})

    def __reduce__(self) -> tuple[Any, ...]:
        return object_of, (self._model, self.name)

    def _repr_html_(self) -> str:
        from moldloft.display import object_html

        return object_html(self)

    def _facts(self) -> dict[str, Any]:
        return self._document.object(self.name)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Object):
            return NotImplemented
        return self._document is other._document and self.name == other.name

    def __hash__(self) -> int:
        return hash(self.name)

    def __repr__(self) -> str:
        try:
            return f"<{self.kind} {self.name}>"
        except Error:
            return f"<{type(self).__name__} {self.name}, which is not in the model any more>"


class Point(Object):
    """A point; ``np.asarray`` gives its coordinates, and each of them can be set."""

    x: float
    y: float
    z: float

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Floats:
        """The coordinates, ``(3,)``."""
        return np.array([self.x, self.y, self.z], dtype=dtype or np.float64)


class Bead(Point):
    """A point on a curve."""

    t: float


class Magnet(Point):
    """A point on a surface."""

    u: float
    v: float


class Ring(Bead, Magnet):
    """A point on a snake."""


class _Located(Object):
    """Targets of searches: curves and surfaces."""

    def nearest(self, points: ArrayLike) -> NearestPoints:
        """The points of a curve or surface nearest to given points.

        The first call on a shape prepares it for searches (milliseconds); later calls, for any
        number of points, reuse this until the shape changes. The answers are independent of each
        other.

        Parameters
        ----------
        points
            Array of shape ``(…, 3)``.

        Returns
        -------
        NearestPoints
            Parameters, feet, distances and statuses.

        Raises
        ------
        ModelError
            If the object is not a curve or surface, the shape is not ``(…, 3)``, or a number is
            not finite.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); Line edge(A, B);")
        >>> near = m["edge"].nearest([[0.5, 1, 0], [5, 0, 0]])
        >>> near.parameters, near.distances
        (array([0.25, 1.  ]), array([1., 3.]))
        >>> near.statuses.tolist()
        ['ok', 'edge-clamped']
        """
        from moldloft.shapes.searches import nearest

        return nearest(self, points)

    def intersect(self, other: Object | str | tuple[ArrayLike, ArrayLike]) -> Intersection:
        """Intersection of a curve or surface with another, or with a plane.

        Two surfaces, or a surface and a plane, cross in branches; a curve meets the other in
        points. All branches longer than 2 % of the size that are not tangent everywhere are found,
        and all points at which a curve crosses. For shapes other than B-splines up to degree 3 this
        holds for their cubic approximations.

        Parameters
        ----------
        other
            A curve, surface or plane of this model or another, a plane as ``(point, normal)``, or
            as text like ``"z=0.5"``.

        Returns
        -------
        Intersection
            Branches and points; empty, and false, when there is nothing in common.

        Raises
        ------
        ModelError
            If one of the two is something else, or a plane has no normal.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 3, 2); AbsPoint D(4, 3, 2);
        ... Line l(A, B); Line m(C, D); RuledSurf S(l, m); Line up(A, D);
        ... ''')
        >>> cut = m["S"].intersect("z=1")
        >>> len(cut.branches), cut.branches[0].ends
        (1, ('edge', 'edge'))
        >>> m["up"].intersect(([0, 1.5, 0], [0, 1, 0])).points
        array([[2. , 1.5, 1. ]])
        """
        from moldloft.shapes.searches import intersect

        return intersect(self, other)

    def to_nurbs(self, *, accuracy: float | None = None, degree: int = 3) -> Nurbs:
        """The curve, snake, surface or solid as a NURBS.

        Piecewise polynomial and rational shapes are exact up to rounding. Others are
        fitted; :attr:`Nurbs.error` is a bound on the distance everywhere, not only at samples.

        Parameters
        ----------
        accuracy
            The largest error of a fit, by default 1e-6 of the shape's diagonal.
        degree
            The degree along parameters in which the shape is not polynomial, 1 to 9.

        Returns
        -------
        Nurbs
            Knots, control points, weights and the proved error.

        Raises
        ------
        ModelError
            If the object is something else.
        Error
            If no NURBS reaches the accuracy, with the bound reached and its position.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("BCurve c({{0, 0, 0}, {1, 2, 0}, {3, 2, 1}, {4, 0, 0}});")
        >>> m["c"].to_nurbs()
        <Nurbs: curve of degree 3, 4 control points, exact>
        """
        from moldloft import _core
        from moldloft.shapes.nurbs import Nurbs

        return Nurbs._of(_core.nurbs(self._document, self.name, accuracy, degree))


class _Measured(Object):
    """What surfaces and parts of surfaces share."""

    def measures(self, *, accuracy: float = 1e-6, by: Sequence[str] = ()) -> SurfaceMeasures:
        """Area and centroid of the surface with bounds of their errors.

        Parameters
        ----------
        accuracy
            The requested relative error, 1e-12 to 0.1.
        by
            Parameters or literals for derivatives, which have bounds, too.

        Returns
        -------
        SurfaceMeasures
            The figures, in the unit of the model.

        Raises
        ------
        ModelError
            If the object is no surface and no part of one, or a name is unknown.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float r = 2; XPlane side(0); AbsPoint A(0, 0, 0); AbsPoint B(0, 0, 1);
        ... AbsPoint C(r, 0, 0); AbsPoint D(r, 0, 1); Line axis(A, B); Line rule(C, D);
        ... RevSurf tube(rule, axis, 0, 2*PI);
        ... ''')
        >>> found = m["tube"].measures(by=["r"])
        >>> round(found.area, 6), round(found.derivatives["area"]["r"], 6)
        (12.566371, 6.283185)
        >>> found.bounds["area"] < 1e-5 and found.derivative_bounds["area"]["r"] < 1e-5
        True
        """
        names = list(by)
        values, slopes = self._document.part_measures(self.name, accuracy, names)
        return SurfaceMeasures._of(values, slopes, names)


class Curve(CurveCalculus, _Located):
    """A curve; calling it gives its points."""

    length: float

    if TYPE_CHECKING:

        def __call__(self, t: ArrayLike, /, *, beyond: bool = False) -> Floats:
            """Positions at ``t`` in [0, 1]: shape ``(…, 3)`` for parameters of shape ``(…)``.

            With ``beyond`` also outside, where the formula is continued.
            """
            ...
    else:

        def __call__(self, *parameters: ArrayLike, beyond: bool = False) -> Floats:
            """Positions at ``t`` in [0, 1]: shape ``(…, 3)`` for parameters of shape ``(…)``.

            With ``beyond`` also outside, where the formula is continued.
            """
            if len(parameters) != 1:
                raise ModelError(
                    f"a curve takes t, and a surface u, v; {len(parameters)} parameters given"
                )
            t = parameter("t", parameters[0], beyond)
            flat = self._document.curve(self.name, np.ascontiguousarray(t.ravel()))
            return flat.reshape(*t.shape, 3)


class Snake(Curve):
    """A curve on a surface."""


class Surface(SurfaceCalculus, _Located, _Measured):
    """A surface; calling it gives its points."""

    area: float
    volume: float
    centroid: Floats

    if TYPE_CHECKING:

        def __call__(self, u: ArrayLike, v: ArrayLike, /, *, beyond: bool = False) -> Floats:
            """Positions at ``u, v`` in [0, 1], which are broadcast; of shape ``(…, 3)``.

            With ``beyond`` also outside, where the formula is continued.
            """
            ...
    else:

        def __call__(self, *parameters: ArrayLike, beyond: bool = False) -> Floats:
            """Positions at ``u, v`` in [0, 1], which are broadcast; of shape ``(…, 3)``.

            With ``beyond`` also outside, where the formula is continued.
            """
            if len(parameters) != 2:
                count = f"{len(parameters)} parameter{'s' * (len(parameters) != 1)}"
                raise ModelError(f"a surface takes u, v, and a curve t; {count} given")
            u, v = broadcast(
                *(parameter(n, p, beyond) for n, p in zip("uv", parameters, strict=True))
            )
            flat = self._document.surface(
                self.name, np.ascontiguousarray(u.ravel()), np.ascontiguousarray(v.ravel())
            )
            return flat.reshape(*u.shape, 3)

    @property
    def divisions(self) -> tuple[int, int] | None:
        """Actual panels along u and v; None for a surface without such panels.

        >>> import moldloft
        >>> m = moldloft.loads('''
        ... Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 0});
        ... RuledSurf s(a, b, divisions = {3, 0});
        ... ''')
        >>> m["s"].divisions
        (3, 8)
        """
        try:
            return self._model.mesh().patch(self.name).divisions
        except UnknownNameError:
            return None

    @overload
    def grid(self, nu: int, nv: int, *, normals: Literal[False] = ...) -> Floats: ...
    @overload
    def grid(self, nu: int, nv: int, *, normals: Literal[True]) -> tuple[Floats, Floats]: ...

    def grid(self, nu: int, nv: int, *, normals: bool = False) -> Floats | tuple[Floats, Floats]:
        """Positions of a surface on a uniform parameter grid.

        Parameters
        ----------
        nu, nv
            Numbers of points along u and v, at least 2.
        normals
            Also the unit normals, in the direction S_u x S_v; zero where
            the surface is singular.

        Returns
        -------
        numpy.ndarray or tuple of two
            Shape ``(nu, nv, 3)``.

        Raises
        ------
        Error
            If a number is below 2.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> m["plate"].grid(3, 5).shape
        (3, 5, 3)
        """
        for name, count in (("nu", nu), ("nv", nv)):
            if not 0 < count < 1 << 31:
                raise ModelError(f"{name} = {count} points: expected a whole number from 2 on")
        if normals:
            return self._document.grid_with_normals(self.name, nu, nv)
        return self._document.grid(self.name, nu, nv)

    def look(self, u: ArrayLike = 41, v: ArrayLike = 41) -> Look:
        """Normals, curvatures and reflections of a surface.

        Parameters
        ----------
        u, v
            Parameters in [0, 1] along each direction, or numbers of even ones.

        Returns
        -------
        Look
            Arrays ``(m, n)`` and ``(m, n, 3)``; NaN where the surface is singular.

        Raises
        ------
        FairingError
            For fewer than two parameters along a direction.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... param float b = 2 in [1, 3];
        ... AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(4, b, 0);
        ... Line low(A, B); Line high(C, D); RuledSurf plate(low, high, divisions = {2, 2});
        ... ''')
        >>> m["plate"].look(3, 5).normals[0, 0].tolist()
        [0.0, 0.0, 1.0]
        """
        from moldloft.fairing.look import Look
        from moldloft.fairing.surface import _parameters

        return Look(self._document.look(self.name, _parameters(u), _parameters(v)))


class Solid(Object):
    """A parametric solid."""

    volume: float

    def to_nurbs(self, *, accuracy: float | None = None, degree: int = 3) -> Nurbs:
        """The curve, snake, surface or solid as a NURBS.

        Shapes that are piecewise polynomial or rational are exact but for rounding. Others are
        fitted; :attr:`Nurbs.error` bounds the distance everywhere, not at samples.

        Parameters
        ----------
        accuracy
            The largest error of a fit, by default 1e-6 of the shape's diagonal.
        degree
            The degree along parameters in which the shape is not polynomial, 1 to 9.

        Returns
        -------
        Nurbs
            Knots, control points, weights and the proved error.

        Raises
        ------
        ModelError
            If the object is something else.
        Error
            If no NURBS reaches the accuracy, with the bound reached and its position.
        """
        from moldloft import _core
        from moldloft.shapes.nurbs import Nurbs

        return Nurbs._of(_core.nurbs(self._document, self.name, accuracy, degree))


class Body(_Measured):
    """A body of triangles, or the part of a surface within loops."""

    volume: float
    area: float
    centroid: Floats


class Plane(Object):
    """A plane."""


class Frame(Object):
    """A frame of three axes."""


class ContourLine(NamedTuple):
    """A line of a section."""

    #: The surface or body that it is on.
    shape: str
    #: Its points, ``(n, 3)``, exact ones of the surface; the first is not repeated when it closes.
    points: Floats
    #: True when it closes.
    closed: bool


class Contours(Object):
    """A family of sections: stations, waterlines, buttocks, and those by cylinders and half-planes.

    ``positions``, ``lengths`` and ``areas`` are arrays with a number for each section; in
    expressions they have derivatives: ``m.derivative("stations.areas", "beam")``. A section
    contains the lines of all its surfaces and bodies, and their mirror images on the same section.
    An open section is closed by a straight chord for its area, which is warned of.

    Examples
    --------
    >>> import moldloft
    >>> m = moldloft.loads('''
    ... param float r = 2;
    ... AbsPoint S(0, 0, -r); AbsPoint E(0, 0, r); AbsPoint Q(r, 0, 0); Arc profile(S, Q, E);
    ... Line axis(S, E); RevSurf ball(profile, axis);
    ... ZContours rings(-1, 1, 0, 1);''')
    >>> m["rings"].positions
    array([-1.,  0.,  1.])
    >>> (m["rings"].areas / np.pi).round(9)
    array([3., 4., 3.])
    >>> [(line.shape, line.points.shape[1]) for line in m["rings"].sections[0]]
    [('ball', 3)]
    """

    #: Where the sections are: coordinates, distances, radii, or angles in radians, ``(n,)``.
    positions: Floats
    #: The length of the lines of each section, ``(n,)``.
    lengths: Floats
    #: The area within each section, holes left out, ``(n,)``.
    areas: Floats

    @property
    def sections(self) -> list[list[ContourLine]]:
        """The lines of each section of the modelled half or whole."""
        cut = self._model._document.sections_of(self.name)
        return [[ContourLine(*line) for line in lines] for _, lines in cut]


class Relabel(Object):
    """A law that redistributes a parameter."""


class _Implicit(Object):
    """A field or set."""

    def __call__(self, points: ArrayLike, /) -> Floats:
        """The values at points ``(…, 3)``."""
        values: Floats = self.value(points)
        return values


class FieldObject(_Implicit):
    """A field: ``value`` is its :class:`moldloft.Field`."""


class SetObject(_Implicit):
    """A set: ``value`` is its :class:`moldloft.Set`."""


_CLASSES: dict[str, type[Object]] = {
    "point": Point,
    "bead": Bead,
    "magnet": Magnet,
    "ring": Ring,
    "curve": Curve,
    "snake": Snake,
    "surface": Surface,
    "solid": Solid,
    "mesh": Body,
    "plane": Plane,
    "frame": Frame,
    "contours": Contours,
    "relabel": Relabel,
    "field": FieldObject,
    "set": SetObject,
}

#: Methods of some classes, for the message of the others.
_METHODS = {
    "nearest": "curves and surfaces",
    "intersect": "curves and surfaces",
    "to_nurbs": "curves, snakes, surfaces and solids",
    "grid": "surfaces",
    "look": "surfaces",
    "derivative": "curves, snakes and surfaces",
    "tangent": "curves and snakes",
    "curvature": "curves, snakes and surfaces",
    "normal": "surfaces",
}


def object_of(model: Model, name: str) -> Object:
    """The object of a name, as one of its class.

    Parameters
    ----------
    model
        The model.
    name
        The name of an object.
    """
    return _CLASSES.get(model._document.object(name)["class"], Object)(model, name)


if TYPE_CHECKING:

    class Entry(Surface, Curve, Ring, Solid, Body, FieldObject, SetObject, float):
        """Type of ``m["name"]`` for type checkers: a number or an object of any class.

        ``isinstance(m["hull"], moldloft.Surface)`` narrows it. At run time it is a float or an
        object of one class.
        """

        length: float
        area: float
        volume: float
        centroid: Floats

        def __call__(self, *parameters: ArrayLike, beyond: bool = False) -> Floats: ...
        def derivative(self, *args: Any, **kwargs: Any) -> Floats: ...
        def curvature(self, *args: Any, **kwargs: Any) -> Any: ...


explain(globals())
