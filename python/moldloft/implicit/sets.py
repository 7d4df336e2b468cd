"""Sets: combinations of the solid sides of fields."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import ArgumentError, explain
from moldloft.errors import Error
from moldloft.implicit.answers import (
    Attributes,
    Distance,
    Hit,
    Leaf,
    Mass,
    Nearest,
    warn_of,
)
from moldloft.implicit.edges import Edged
from moldloft.implicit.facets import Facets
from moldloft.implicit.fields import (
    Field,
    points_of,
)
from moldloft.implicit.moving import Moving, box_of, corners_of, triple
from moldloft.implicit.pictures import Pictured

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]
    Triple = Sequence[float]

__all__ = ["Set", "load", "loads"]

USUAL_LIMIT = 2e7
"""Default limit of cells that the surface may cross."""

Corners = "tuple[list[float], list[float]] | None"


def _whole(value: int | None, what: str, least: int) -> int | None:
    """A whole number that is not below the least."""
    if value is None:
        return None
    if int(value) != value or not least <= value < 2**31:
        raise ValueError(f"the {what} is a whole number from {least}, found {value}")
    return int(value)


class Set(Moving, Edged, Pictured):
    """A set of points: the solid sides of fields under ``|``, ``&``, ``-``, ``^`` and complement.

    Sets are immutable and share their parts, so undo only needs a reference to an operand.

    Parameters
    ----------
    of
        A field, whose solid side is meant.
    name, colour, material, tolerance, tags
        Attributes; they reach every triangle.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> shell = im.Set(im.sphere((0, 0, 0), 2)) - im.Set(im.sphere((0, 0, 0), 1))
    >>> shell.member([[1.5, 0, 0], [1, 0, 0], [0.5, 0, 0]])
    array([-1,  0,  1], dtype=int8)
    """

    __slots__ = ("_core",)
    __array_ufunc__ = None

    def __init__(
        self,
        of: Field | _core.Set,
        *,
        name: str | None = None,
        colour: int | None = None,
        material: str | None = None,
        tolerance: float | None = None,
        tags: Mapping[str, str] | None = None,
    ) -> None:
        core = _core.Set.of_field(of._core) if isinstance(of, Field) else of
        if not isinstance(core, _core.Set):
            raise TypeError(f"a set is made of a field, not of {type(of).__name__}")
        self._core = core
        given = (name, colour, material, tolerance, tags)
        if any(x is not None for x in given):
            self._core = self._with(name, colour, material, tolerance, tags)

    def _with(
        self,
        name: str | None,
        colour: int | None,
        material: str | None,
        tolerance: float | None,
        tags: Mapping[str, str] | None,
    ) -> _core.Set:
        if colour is not None and colour not in range(16):
            raise ValueError(f"a palette colour is a whole number from 0 to 15, found {colour}")
        if tolerance is not None and not 0 <= tolerance < np.inf:
            raise ValueError(f"a tolerance is a length of 0 or more, found {tolerance}")
        words = {str(k): str(v) for k, v in (tags or {}).items()}
        return self._core.with_attributes(name, colour, material, tolerance, words)

    def with_attributes(
        self,
        *,
        name: str | None = None,
        colour: int | None = None,
        material: str | None = None,
        tolerance: float | None = None,
        tags: Mapping[str, str] | None = None,
    ) -> Set:
        """The same set with these attributes; attributes of its parts take precedence.

        Parameters
        ----------
        name
            A name.
        colour
            Colour of the palette, 0 to 15.
        material
            Name of a material.
        tolerance
            Distance below which a point is on the surface.
        tags
            Texts by name.

        Returns
        -------
        Set
            A new one; this stays as it is.

        Raises
        ------
        ArgumentError
            If the colour is not of the palette, or the tolerance negative.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> ball.with_attributes(name="buoy", colour=3).member((0, 0, 0))
        -1
        """
        return Set(self._with(name, colour, material, tolerance, tags))

    # -- combination -----------------------------------------------------------------------

    def _binary(self, other: object, name: str) -> Any:
        if isinstance(other, Field):
            other = Set(other)
        if not isinstance(other, Set):
            return NotImplemented
        return Set(self._core.binary(name, other._core))

    def __or__(self, other: object) -> Any:
        return self._binary(other, "|")

    def __and__(self, other: object) -> Any:
        return self._binary(other, "&")

    def __sub__(self, other: object) -> Any:
        return self._binary(other, "-")

    def __xor__(self, other: object) -> Any:
        return self._binary(other, "^")

    def __neg__(self) -> Set:
        return Set(self._core.complement())

    def __invert__(self) -> Set:
        return Set(self._core.complement())

    def thin(self) -> Set:
        """The faces as sheets without interior, for sets whose primitives intersect.

        Returns
        -------
        Set
            A set without volume: its facets are sheets.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> ball.thin().mass().volume
        0.0
        """
        return Set(self._core.skin())

    def regularized(self) -> Set:
        """An equal set without redundant parts, such as in A | A.

        Returns
        -------
        Set
            A new one; this stays as it is.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> (ball | ball).regularized()
        <set of 1 primitive>
        """
        return Set(self._core.regularized())

    def pruned(self, low: Triple, high: Triple) -> Set:
        """The set inside a box, without parts that are all solid or all empty there.

        Parameters
        ----------
        low
            The low corner of a box, ``(3,)``.
        high
            The high corner of a box, ``(3,)``.

        Returns
        -------
        Set
            The same inside of the box, and unspecified outside.

        Raises
        ------
        ArgumentError
            If the low corner is not below the high one, or a coordinate is not finite.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> (ball | im.sphere((9, 0, 0), 1)).pruned((-2, -2, -2), (2, 2, 2))
        <set of 1 primitive>
        """
        return Set(self._core.pruned(*box_of(low, high)))

    def mapped(self, matrix: ArrayLike, shift: Triple = (0, 0, 0)) -> Set:
        """The set moved by the affine map X -> matrix X + shift.

        Parameters
        ----------
        matrix
            Matrix ``(3, 3)``.
        shift
            Translation after the matrix, ``(3,)``.

        Returns
        -------
        Set
            A new one; this stays as it is.

        Raises
        ------
        Error
            If the matrix is singular.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> ball.mapped([[4, 0, 0], [0, 1, 0], [0, 0, 1]]).member((3, 0, 0))
        -1
        """
        rows = np.asarray(matrix, dtype=np.float64)
        if rows.shape != (3, 3):
            raise ValueError(f"the matrix has the shape (3, 3), found {rows.shape}")
        return Set(self._core.mapped(rows.tolist(), triple(shift, "shift")))

    def remapped(self, x: Field, y: Field, z: Field) -> Set:
        """The set with its coordinates replaced by three fields; see :meth:`Field.remapped`.

        Parameters
        ----------
        x
            The first field.
        y
            The second field.
        z
            The third field.

        Returns
        -------
        Set
            A new one; this stays as it is.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> x, y, z = im.axes()
        >>> ball.remapped(x, y, z / 2).member((0, 0, 1.5))
        -1
        """
        return Set(self._core.remapped(x._core, y._core, z._core))

    # -- kept ------------------------------------------------------------------------------

    def dumps(self) -> str:
        """The set as text, from which :func:`loads` makes the same one, bit for bit.

        Returns
        -------
        str
            A line for each primitive and each combination.

        Raises
        ------
        Error
            If a primitive is a function from outside, which has no text.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1), name="ball")
        >>> im.loads(ball.dumps()).same(ball)
        True
        """
        return self._core.to_text()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes :meth:`dumps` to a file; :func:`load` reads it.

        Parameters
        ----------
        path
            The file.

        Raises
        ------
        FileError
            If there is no such folder, or it cannot be written to.
        """
        from moldloft.storage import put

        put(Path(path), self.dumps().encode())

    def sdl(self, name: str = "part") -> str:
        """The set as a program of the language that declares it under ``name``.

        Parameters
        ----------
        name
            The name that the program declares it under.

        Returns
        -------
        str
            A program.

        Raises
        ------
        ArgumentError
            If that is not a name.
        Error
            If a primitive is a function from outside, which has no text.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> ball.sdl("ball").splitlines()[-1]
        'set ball = ball_11;'
        """
        if not name.isidentifier():
            raise ValueError(f"a set is declared under a name, found {name!r}")
        return self._core.to_sdl(name)

    def __reduce__(self) -> tuple[Any, ...]:
        return loads, (self.dumps(),)

    def __deepcopy__(self, memo: object) -> Set:
        return self

    # -- questions -------------------------------------------------------------------------

    @property
    def leaves(self) -> list[Leaf]:
        """The primitives in order of their first appearance."""
        out = []
        for field, facts in self._core.leaves():
            kind = facts.pop("kind")
            out.append(Leaf(Field(field), kind, Attributes(**facts)))
        return out

    @property
    def operands(self) -> list[Set]:
        """The two operands of a union or intersection."""
        return [Set(core) for core in self._core.operands()]

    @property
    def degree(self) -> int:
        """The highest degree of its primitives."""
        return self._core.degree

    @property
    def is_everything(self) -> bool:
        """True if the set is known to be the whole of space."""
        return self._core.is_everything

    @property
    def is_nothing(self) -> bool:
        """True if the set is known to be empty."""
        return self._core.is_nothing

    def same(self, other: Set) -> bool:
        """True when both are the same combination with the same attributes.

        Parameters
        ----------
        other
            The other set.

        Returns
        -------
        bool
            Sets of the same points that are combined differently are not the same.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> ball.same(im.Set(im.sphere((0, 0, 0), 1))), ball.same(ball | ball)
        (True, False)
        """
        return self._core.same(other._core)

    def __call__(self, points: ArrayLike) -> Any:
        """The values at points ``(…, 3)``: minima over unions, maxima over intersections."""
        flat, shape = points_of(points)
        values = self._core.values(flat).reshape(shape)
        return values if shape else float(values)

    def member(
        self, points: ArrayLike, tolerance: float = 1e-9, *, known: Sequence[Field] = ()
    ) -> Any:
        """-1 in the solid, 0 on the surface, 1 in air, for points ``(…, 3)``.

        A primitive counts as zero within ``tolerance`` of its surface. The fields ``known``
        count as zero everywhere, for points that are on their surfaces by construction.

        Parameters
        ----------
        points
            Points ``(…, 3)``.
        tolerance
            The distance from the surface within which a point is on it.
        known
            Fields whose leaves are taken to be zero.

        Returns
        -------
        int or numpy.ndarray
            Whole numbers of the shape of the points without the last extent.

        Raises
        ------
        ArgumentError
            If the points have another shape.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> ball.member([[0, 0, 0], [1, 0, 0], [2, 0, 0]]).tolist()
        [-1, 0, 1]
        """
        flat, shape = points_of(points)
        others = [type(field).__name__ for field in known if not isinstance(field, Field)]
        if others:
            raise ArgumentError(f"known: expected fields, found {others[0]}")
        cores = [field._core for field in known]
        members = self._core.members(flat, float(tolerance), cores).reshape(shape)
        return members if shape else int(members)

    def winner(self, points: ArrayLike) -> Any:
        """Index in :attr:`leaves` of the primitive that determines each point; -1 without one.

        Parameters
        ----------
        points
            Points ``(…, 3)``.

        Returns
        -------
        int or numpy.ndarray
            Whole numbers of the shape of the points without the last extent.

        Raises
        ------
        ArgumentError
            If the points have another shape.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> (ball | im.sphere((5, 0, 0), 1)).winner([(0, 0, 1), (5, 0, 1)]).tolist()
        [0, 1]
        """
        flat, shape = points_of(points)
        winners = self._core.winners(flat).reshape(shape)
        return winners if shape else int(winners)

    def range(self, low: Triple, high: Triple) -> tuple[float, float]:
        """Proved bounds of the values over a box.

        Parameters
        ----------
        low
            The low corner of a box, ``(3,)``.
        high
            The high corner of a box, ``(3,)``.

        Returns
        -------
        tuple of float
            A lower and an upper bound of all values.

        Raises
        ------
        ArgumentError
            If the low corner is not below the high one, or a coordinate is not finite.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> low, high = ball.range((2, 2, 2), (3, 3, 3))
        >>> low > 0
        True
        """
        return self._core.range(*box_of(low, high))

    def bounds(self, accuracy: float = 1e-3) -> tuple[Floats, Floats] | None:
        """A box that is proved to contain the set, ``low, high``; None for an empty set.

        Parameters
        ----------
        accuracy
            The largest error, in the unit of the result.

        Returns
        -------
        tuple of two numpy.ndarray, or None
            The low and the high corner, ``(3,)`` each.

        Raises
        ------
        Error
            If the set has no end.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> [side.round(2).tolist() for side in ball.bounds()]
        [[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]
        """
        found = self._core.bounds(float(accuracy))
        return None if found is None else (np.array(found[0]), np.array(found[1]))

    def mass(
        self,
        low: Triple | None = None,
        high: Triple | None = None,
        *,
        depth: int | None = None,
        accuracy: float | None = None,
        cells: int | None = None,
    ) -> Mass:
        """Volume, centroid and inertia within a box, each as a proved bracket and a best value.

        Best values are inside their brackets, and equal those of the language. Parts of any
        thickness are included.

        Parameters
        ----------
        low, high
            The box; found around a set that has an end. Its faces cut the set.
        depth
            Number of halvings of the box for the brackets, which narrow by a factor of about 4 with
            each. By default some thousand cells with the widest brackets are divided.
        accuracy
            Alternative to ``depth``: proved bound of the error of the volume.
        cells
            The most cells by which the accuracy is sought, by default 400 000.

        Returns
        -------
        Mass
            ``volume``, ``centroid`` ``(3,)`` and ``inertia`` ``(3, 3)`` for density 1, each with
            its bracket. ``uncertain`` is the maximum error of the volume, proved by the bracket;
            ``estimate`` is by how much facets of two levels differ where edges are thinner than
            cells, and is warned of when it is more than a millionth of the volume.

        Raises
        ------
        Error
            If the accuracy is not reached with this number of cells; the message states the one
            reached.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> low, high = im.Set(im.sphere((0, 0, 0), 1)).mass(accuracy=0.01).volume_bracket
        >>> high - low <= 0.02
        True
        """
        if depth is not None and accuracy is not None:
            raise ValueError("give a depth or an accuracy, not both")
        depth = _whole(depth, "depth", 0)
        facts = self._core.mass(corners_of(low, high), depth, accuracy, _whole(cells, "cells", 1))
        if facts["doubt"] is not None and accuracy is None:
            advice = "ask for the accuracy that will do: then it is proved"
            warn_of(f"{facts['doubt']}\nhelp: {advice}", frames=2)
        return Mass(
            volume=facts["volume"],
            volume_bracket=facts["volume_bracket"],
            uncertain=facts["uncertain"],
            estimate=facts["estimate"],
            centroid=None if facts["centroid"] is None else np.array(facts["centroid"]),
            centroid_bracket=np.array(facts["centroid_bracket"]),
            inertia=None if facts["inertia"] is None else np.array(facts["inertia"]),
            inertia_bracket=np.array(facts["inertia_bracket"]),
        )

    def nearest(
        self,
        point: Triple,
        low: Triple | None = None,
        high: Triple | None = None,
        *,
        accuracy: float | None = None,
    ) -> Nearest | None:
        """The point of the surface in a box nearest to ``point``; None without a surface.

        The distance exceeds the minimum by at most ``accuracy``, by default 1e-6 of the box.

        Parameters
        ----------
        point
            A point, ``(3,)``.
        low
            The low corner of a box, ``(3,)``.
        high
            The high corner of a box, ``(3,)``.
        accuracy
            Maximum excess over the distance of the nearest point.

        Returns
        -------
        Nearest or None
            The point, its distance, and a proved lower bound of the distance.

        Raises
        ------
        Error
            If the set has no end and no box is given.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> round(ball.nearest((3, 0, 0)).distance, 6)
        2.0
        """
        found = self._core.nearest(triple(point, "point"), corners_of(low, high), accuracy)
        if found is None:
            return None
        at, distance, at_least = found
        return Nearest(np.array(at), distance, at_least)

    def distance(
        self,
        other: Set | Field,
        low: Triple | None = None,
        high: Triple | None = None,
        *,
        accuracy: float | None = None,
    ) -> Distance | None:
        """The distance of another set from this one in a box; None if one of them is empty there.

        The distance exceeds the minimum by at most ``accuracy``, by default 1e-5 of the box.

        Parameters
        ----------
        other
            The other set.
        low
            The low corner of a box, ``(3,)``.
        high
            The high corner of a box, ``(3,)``.
        accuracy
            The largest error of the distance.

        Returns
        -------
        Distance or None
            The distance, the two points, and a proved lower bound.

        Raises
        ------
        Error
            If a set has no end and no box is given.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> a, b = im.Set(im.sphere((0, 0, 0), 1)), im.Set(im.sphere((3, 4, 0), 1))
        >>> round(a.distance(b).distance, 6)
        3.0
        """
        o = Set(other) if isinstance(other, Field) else other
        found = self._core.distance(o._core, corners_of(low, high), accuracy)
        if found is None:
            return None
        distance, at_least, first, second = found
        return Distance(distance, at_least, np.array(first), np.array(second))

    def hits(self, start: Triple, direction: Triple, length: float = 1e3) -> list[Hit]:
        """Intersections of a ray with the surface, in order, up to ``length``.

        Parameters
        ----------
        start
            Start of the ray, ``(3,)``.
        direction
            A direction of any length, ``(3,)``.
        length
            Length of the ray, in model units.

        Returns
        -------
        list of Hit
            Each with the length ``t`` along the ray, the point, the outward normal and the
            primitive's number.

        Raises
        ------
        Error
            If the direction or the length is 0.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> [round(hit.t, 9) for hit in ball.hits((0, 0, -3), (0, 0, 1))]
        [2.0, 4.0]
        """
        rays = self._core.hits(
            triple(start, "start"), triple(direction, "direction"), float(length)
        )
        return [Hit(t, np.array(p), leaf, np.array(n), enters) for t, p, leaf, n, enters in rays]

    # -- surfaces --------------------------------------------------------------------------

    def facets(
        self,
        low: Triple | None = None,
        high: Triple | None = None,
        *,
        depth: int | None = None,
        accuracy: float | None = None,
        before: Facets | None = None,
        limit: float = USUAL_LIMIT,
    ) -> Facets:
        """The surface as triangles, sheets, wires and points. Ctrl-C stops it.

        Parameters
        ----------
        low, high
            The box; default: bounds of the set, if bounded. Its faces close a set that it cuts.
        depth
            Cells of the 2^depth-th part of the longest side; by default 6.
        accuracy
            Alternative to ``depth``: maximum distance of the centres of triangles from the surface,
            by refinement.
        before
            Facets of a similar set in the same box at the same depth: boxes in which the set did
            not change are taken over. The result is the same, bit for bit.
        limit
            The most cells that the surface may pass through.

        Returns
        -------
        Facets
            Triangles counter-clockwise from outside; ``closed`` where the set is a solid.

        Raises
        ------
        Error
            If the set has no end and no box is given, or more cells are needed than ``limit``.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> ball = im.Set(im.sphere((0, 0, 0), 1))
        >>> facets = ball.facets(depth=4)
        >>> abs(facets.volume - 4.19) < 0.1
        True
        """
        if depth is not None and accuracy is not None:
            raise ValueError("give a depth or an accuracy, not both")
        depth = _whole(depth, "depth", 0)
        old = None if before is None else before._core
        core = self._core.facets(corners_of(low, high), depth, accuracy, float(limit), old)
        return Facets(core)

    def __repr__(self) -> str:
        if self.is_everything:
            return "<set of everything>"
        if self.is_nothing:
            return "<empty set>"
        count = self._core.contents
        return f"<set of {count} primitive{'s' if count != 1 else ''}>"

    def _repr_png_(self) -> bytes | None:
        # A notebook shows what has an end; of other sets their text.
        try:
            return self.picture(size=(360, 270))
        except Error:
            return None


def loads(text: str) -> Set:
    """The set of a text that :meth:`Set.dumps` made.

    Parameters
    ----------
    text
        A text that :meth:`Set.dumps` made.

    Returns
    -------
    Set
        The same, bit for bit.
    """
    return Set(_core.Set.from_text(text))


def load(path: str | os.PathLike[str]) -> Set:
    """The set of a file that :meth:`Set.save` wrote.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Set
        The same, bit for bit.
    """
    from moldloft.storage import read_text

    return loads(read_text(path))


explain(globals())
