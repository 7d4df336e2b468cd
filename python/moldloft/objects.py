"""Objects of a model, seen from Python."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from moldloft._core import Document
    from moldloft.fairing.surface import Look
    from moldloft.nurbs import Nurbs
    from moldloft.searches import Intersection, NearestPoints

    Floats = NDArray[np.float64]

__all__ = ["Object"]

_OWN = frozenset({"_document", "name"})


class Object:
    """A named object of a model.

    It is a name and no copy: after a change of the model it shows the new shape. Calling it
    evaluates a curve or a surface; its numbers are read and written as attributes.

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

    __slots__ = ("_document", "name")

    _document: Document
    name: str
    """Its name in the model."""

    def __init__(self, document: Document, name: str) -> None:
        object.__setattr__(self, "_document", document)
        object.__setattr__(self, "name", name)

    @property
    def kind(self) -> str:
        """The entity kind, such as ``"BCurve"``."""
        return str(self._facts()["kind"])

    @property
    def class_(self) -> str:
        """What kind of thing it is, such as ``"point"``, ``"curve"`` or ``"surface"``."""
        return str(self._facts()["class"])

    @property
    def parents(self) -> list[str]:
        """The names of what it depends on directly."""
        return list(self._facts()["parents"])

    @property
    def children(self) -> list[str]:
        """The names of what depends on it directly."""
        return list(self._facts()["children"])

    @property
    def ok(self) -> bool:
        """False when it failed or waits for one that did."""
        return bool(self._facts()["ok"])

    def __call__(self, *parameters: ArrayLike) -> Floats:
        """Positions on the curve at ``t``, or on the surface at ``u, v``.

        Of a field or set the values at points ``(…, 3)``.

        Parameters
        ----------
        *parameters
            One array for a curve, two for a surface (broadcast against each other); the shape
            runs over [0, 1].

        Returns
        -------
        numpy.ndarray
            Shape ``(…, 3)``: that of the parameters and the coordinates.
        """
        if len(parameters) == 1 and self.class_ in ("field", "set"):
            values: Floats = self.value(parameters[0])
            return values
        if len(parameters) == 1:
            t = np.asarray(parameters[0], dtype=np.float64)
            flat = self._document.curve(self.name, np.ascontiguousarray(t.ravel()))
            return flat.reshape(*t.shape, 3)
        if len(parameters) == 2:
            u, v = np.broadcast_arrays(*(np.asarray(p, dtype=np.float64) for p in parameters))
            flat = self._document.surface(
                self.name, np.ascontiguousarray(u.ravel()), np.ascontiguousarray(v.ravel())
            )
            return flat.reshape(*u.shape, 3)
        raise TypeError(f"a curve takes t and a surface u, v; {len(parameters)} were given")

    @overload
    def grid(self, nu: int, nv: int) -> Floats: ...
    @overload
    def grid(self, nu: int, nv: int, *, normals: bool) -> Floats | tuple[Floats, Floats]: ...

    def grid(self, nu: int, nv: int, *, normals: bool = False) -> Floats | tuple[Floats, Floats]:
        """Positions of a surface on an even grid of its parameters.

        Parameters
        ----------
        nu, nv
            Numbers of points along u and v, at least 2.
        normals
            Also the unit normals, along the product of the derivatives by u and v; zero where
            the surface is singular.

        Returns
        -------
        numpy.ndarray or tuple of two
            Shape ``(nu, nv, 3)``.
        """
        if normals:
            return self._document.grid_with_normals(self.name, nu, nv)
        return self._document.grid(self.name, nu, nv)

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
        from moldloft.models import _wrapped

        return _wrapped(self._document.eval(self.name))

    def look(self, u: ArrayLike = 41, v: ArrayLike = 41) -> Look:
        """Normals, curvatures and reflections of a surface.

        Parameters
        ----------
        u, v
            Parameters in [0, 1] along each direction, or numbers of even ones.
        """
        from moldloft.fairing.surface import Look, _parameters

        return Look(self._document.look(self.name, _parameters(u), _parameters(v)))

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

        Raises
        ------
        ModelError
            When the object is something else.
        Error
            When no NURBS comes near enough, with the bound that was reached and its place.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("BCurve c({{0, 0, 0}, {1, 2, 0}, {3, 2, 1}, {4, 0, 0}});")
        >>> m["c"].to_nurbs()
        <Nurbs: curve of degree 3, 4 control points, exact>
        """
        from moldloft import _core
        from moldloft.nurbs import Nurbs

        return Nurbs._of(_core.nurbs(self._document, self.name, accuracy, degree))

    def nearest(self, points: ArrayLike) -> NearestPoints:
        """The points of a curve or surface that are nearest to given ones, all at once.

        The first call on a shape prepares it for searches (milliseconds); later calls, of any
        number of points, use that until the shape changes. The answers do not depend on each other.

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
            When the object is not a curve or surface, the shape is not ``(…, 3)``, or a number is
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
        from moldloft.searches import nearest

        return nearest(self, points)

    def intersect(self, other: Object | str | tuple[ArrayLike, ArrayLike]) -> Intersection:
        """What a curve or surface has in common with another, or with a plane.

        Two surfaces, or a surface and a plane, cross in branches; a curve meets the other in
        points. All branches longer than 2 % of the size are found that cross at an angle somewhere,
        and all points where a curve crosses; on shapes that are no B-splines up to the third degree
        this is as right as cubic pieces near them are.

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
            When one of the two is something else, or a plane has no normal.

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
        from moldloft.searches import intersect

        return intersect(self, other)

    def delete(self) -> None:
        """Removes the object from the model and its text; refused while others depend on it."""
        self._document.delete(self.name)

    def rename(self, name: str) -> None:
        """Gives the object another name, everywhere in the text."""
        self._document.rename(self.name, name)
        object.__setattr__(self, "name", name)

    def __getattr__(self, member: str) -> Any:
        if member.startswith("_"):
            raise AttributeError(member)
        from moldloft.errors import Error

        try:
            return self._document.eval(f"{self.name}.{member}")
        except Error as error:
            raise AttributeError(str(error)) from error

    def __setattr__(self, member: str, value: float) -> None:
        if member in _OWN or isinstance(getattr(type(self), member, None), property):
            raise AttributeError(f"`{member}` of an object cannot be set")
        self._document.set([(f"{self.name}.{member}", float(value))])

    def _facts(self) -> dict[str, Any]:
        return self._document.object(self.name)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Object):
            return NotImplemented
        return self._document is other._document and self.name == other.name

    def __hash__(self) -> int:
        return hash(self.name)

    def __repr__(self) -> str:
        return f"<{self.kind} {self.name}>"
