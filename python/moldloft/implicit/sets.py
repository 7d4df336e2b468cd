"""Sets: what fields leave solid, combined."""

from __future__ import annotations

import itertools
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.implicit.answers import (
    Attributes,
    Distance,
    Hit,
    Lamp,
    Leaf,
    Mass,
    Nearest,
    Sun,
)
from moldloft.implicit.facets import Facets
from moldloft.implicit.fields import (
    Field,
    points_of,
    reflection,
    scaling,
    triple,
    turn,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]
    Triple = Sequence[float]

__all__ = ["Set", "load", "loads"]

USUAL_LIMIT = 2e7
"""Cells that the surface may pass through, unless asked otherwise."""

Corners = "tuple[list[float], list[float]] | None"


def _whole(value: int | None, what: str, least: int) -> int | None:
    """A whole number that is not below the least."""
    if value is None:
        return None
    if int(value) != value or not least <= value < 2**31:
        raise ValueError(f"the {what} is a whole number from {least}, found {value}")
    return int(value)


def _corners(low: Triple | None, high: Triple | None) -> tuple[list[float], list[float]] | None:
    if low is None and high is None:
        return None
    if low is None or high is None:
        raise ValueError("a box has two corners: give both low and high, or neither")
    return triple(low, "low corner"), triple(high, "high corner")


class Set:
    """A set of points: the solid sides of fields under ``|``, ``&``, ``-``, ``^`` and complement.

    Sets never change and share their parts, so holding on to an operand is all that undo needs.

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
        """The same set with these attributes; what its parts say of themselves stays.

        Parameters
        ----------
        name
            A name.
        colour
            Colour index, 0 to 255.
        material
            Name of a material.
        tolerance
            How near to the surface a point counts as on it.
        tags
            Texts by name.
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
        """The faces as sheets, without the inside; of sets whose primitives meet."""
        return Set(self._core.skin())

    def regularized(self) -> Set:
        """An equal set without parts that combine to nothing new, such as A | A."""
        return Set(self._core.regularized())

    def pruned(self, low: Triple, high: Triple) -> Set:
        """The set as it is inside a box: what is all solid or all air there is left out.

        Parameters
        ----------
        low
            The low corner of a box, ``(3,)``.
        high
            The high corner of a box, ``(3,)``.
        """
        return Set(self._core.pruned(triple(low, "low corner"), triple(high, "high corner")))

    def translated(self, by: Triple) -> Set:
        """The set moved by a vector.

        Parameters
        ----------
        by
            The vector, ``(3,)``.
        """
        return self.mapped(np.eye(3), by)

    def turned(self, point: Triple, direction: Triple, angle: float) -> Set:
        """The set turned about a line, right-handed, by an angle in radians.

        Parameters
        ----------
        point
            A point of the axis, ``(3,)``.
        direction
            A direction of any length, ``(3,)``.
        angle
            Angle, radians.
        """
        return self.mapped(*turn(point, direction, angle))

    def mirrored(self, normal: Triple, point: Triple = (0, 0, 0)) -> Set:
        """The mirror image in a plane.

        Parameters
        ----------
        normal
            A normal of any length, ``(3,)``; it points from solid to air.
        point
            A point, ``(3,)``.
        """
        return self.mapped(*reflection(normal, point))

    def scaled(self, factor: float, centre: Triple = (0, 0, 0)) -> Set:
        """The set scaled about a point.

        Parameters
        ----------
        factor
            The factor, not zero.
        centre
            The centre, ``(3,)``.
        """
        return self.mapped(*scaling(factor, centre))

    def mapped(self, matrix: ArrayLike, shift: Triple = (0, 0, 0)) -> Set:
        """The set moved by the affine map X -> matrix X + shift.

        Parameters
        ----------
        matrix
            Matrix ``(3, 3)``.
        shift
            Translation after the matrix, ``(3,)``.
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
        """
        return Set(self._core.remapped(x._core, y._core, z._core))

    def offset(self, distance: float) -> Set:
        """The set grown by a distance, or shrunk by a negative one; edges stay sharp.

        Parameters
        ----------
        distance
            By how much it grows; negative: shrinks.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> round(im.cuboid((0, 0, 0), (1, 1, 1)).offset(0.1).mass().volume, 9)
        1.728
        """
        return Set(self._core.offset(float(distance)))

    def shell(self, thickness: float) -> Set:
        """The wall of that thickness inside of the surface.

        Parameters
        ----------
        thickness
            Thickness of the wall, in model units.
        """
        return Set(self._core.shell(float(thickness)))

    def rounded(
        self, width: float, *, lam: float = 2 / 3, edges: Sequence[Sequence[str]] | None = None
    ) -> Set:
        """The set with its convex edges rounded, of setback ``width`` on both faces.

        ``edges`` are pairs of the names of faces, by default all; ``lam`` shapes the round between
        0 (a chamfer) and 1 (the edge), 2/3 is an arc between perpendicular planes.

        Parameters
        ----------
        width
            Setback on both faces, in model units.
        lam
            Shape of the blend, between 0 and 1.
        edges
            Pairs of names of faces; by default all edges.
        """
        return Set(self._core.rounded(float(width), float(lam), _pairs(edges)))

    def filleted(
        self,
        other: Set | Field,
        width: float,
        other_width: float | None = None,
        *,
        lam: float = 2 / 3,
        edges: Sequence[Sequence[str]] | None = None,
    ) -> Set:
        """The union with another set, with fillets of setback ``width`` where their faces meet.

        ``edges`` are pairs of the names of a face of this set and one of the other, by default all.
        The faces are planes, balls, cylinders, cones and tori.

        Parameters
        ----------
        other
            The set that is joined.
        width
            Setback on this set, in model units.
        other_width
            Setback on the other set; by default the same.
        lam
            Shape of the blend, between 0 and 1.
        edges
            Pairs of a face of this set and one of the other; by default all.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> plate, post = im.cuboid((-2, -2, -1), (2, 2, 0)), im.cuboid((-1, -1, -1), (1, 1, 2))
        >>> round(plate.filleted(post, 0.5).mass().volume - 24, 2) > 0
        True
        """
        o = Set(other) if isinstance(other, Field) else other
        widths = [float(width), float(width if other_width is None else other_width)]
        return Set(self._core.filleted(o._core, widths, float(lam), _pairs(edges)))

    def chamfered(self, width: float, *, edges: Sequence[Sequence[str]] | None = None) -> Set:
        """The set with its convex edges chamfered, of setback ``width`` on both faces.

        Parameters
        ----------
        width
            Setback on both faces, in model units.
        edges
            Pairs of names of faces; by default all edges.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> round(im.cuboid((0, 0, 0), (10, 6, 4)).chamfered(1).mass().volume, 6)
        206.0
        """
        return Set(self._core.rounded(float(width), None, _pairs(edges)))

    # -- kept ------------------------------------------------------------------------------

    def dumps(self) -> str:
        """The set as text, from which :func:`loads` makes the same one, bit for bit.

        Raises
        ------
        Error
            When a primitive is a function from outside, which has no text.

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
        """
        from moldloft.storage import put

        put(Path(path), self.dumps().encode())

    def sdl(self, name: str = "part") -> str:
        """The set as a program of the language that declares it under ``name``.

        Parameters
        ----------
        name
            The name that the program declares it under.
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
        """True for the whole of space, known as such."""
        return self._core.is_everything

    @property
    def is_nothing(self) -> bool:
        """True for the empty set, known as such."""
        return self._core.is_nothing

    def same(self, other: Set) -> bool:
        """True when both are the same combination with the same attributes.

        Parameters
        ----------
        other
            The other set.
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

        A primitive counts as zero where it is at most ``tolerance`` from its surface. The fields
        ``known`` do everywhere: on their surfaces the points are known to lie.

        Parameters
        ----------
        points
            Points ``(…, 3)``.
        tolerance
            The distance from the surface within which a point is on it.
        known
            Fields whose leaves are taken to be zero.
        """
        flat, shape = points_of(points)
        cores = [field._core for field in known]
        members = self._core.members(flat, float(tolerance), cores).reshape(shape)
        return members if shape else int(members)

    def winner(self, points: ArrayLike) -> Any:
        """The number in :attr:`leaves` of the primitive that decides at each point; -1 for none.

        Parameters
        ----------
        points
            Points ``(…, 3)``.
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
        """
        return self._core.range(triple(low, "low corner"), triple(high, "high corner"))

    def bounds(self, accuracy: float = 1e-3) -> tuple[Floats, Floats] | None:
        """A box that is proved to contain the set, ``low, high``; None for an empty set.

        Parameters
        ----------
        accuracy
            The largest error, in the unit of the result.

        Raises
        ------
        Error
            When the set has no end.
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

        Best values lie inside their brackets, and are those of the language. Parts of any thinness
        count.

        Parameters
        ----------
        low, high
            The box; found around a set that has an end. Its faces cut the set.
        depth
            How often the box is halved for the brackets; they close by a factor of about 4 with
            each. By default some thousand cells are divided where the brackets are widest.
        accuracy
            Instead: how far the volume may be from its best value, proved.
        cells
            The most cells by which the accuracy is sought, by default 400 000.

        Raises
        ------
        Error
            When the accuracy is not reached with that many cells; it says what is.

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
        facts = self._core.mass(_corners(low, high), depth, accuracy, _whole(cells, "cells", 1))
        return Mass(
            volume=facts["volume"],
            volume_bracket=facts["volume_bracket"],
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
        """The point of the surface, in a box, that is nearest to ``point``; None without a surface.

        ``accuracy`` is how much nearer another point may be, by default 1e-6 of the box.

        Parameters
        ----------
        point
            A point, ``(3,)``.
        low
            The low corner of a box, ``(3,)``.
        high
            The high corner of a box, ``(3,)``.
        accuracy
            How much nearer another point may be.
        """
        found = self._core.nearest(triple(point, "point"), _corners(low, high), accuracy)
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
        """How far another set is from this one in a box; None when one of them has no point there.

        ``accuracy`` is how much nearer they may be, by default 1e-5 of the box.

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

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> a, b = im.Set(im.sphere((0, 0, 0), 1)), im.Set(im.sphere((3, 4, 0), 1))
        >>> round(a.distance(b).distance, 6)
        3.0
        """
        o = Set(other) if isinstance(other, Field) else other
        found = self._core.distance(o._core, _corners(low, high), accuracy)
        if found is None:
            return None
        distance, at_least, first, second = found
        return Distance(distance, at_least, np.array(first), np.array(second))

    def hits(self, start: Triple, direction: Triple, length: float = 1e3) -> list[Hit]:
        """Where a ray crosses the surface, in order; ``length`` is how far it goes.

        Parameters
        ----------
        start
            Where it begins, ``(3,)``.
        direction
            A direction of any length, ``(3,)``.
        length
            How far the ray goes, in model units.
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
            The box; found around a set that has an end. Where it cuts the set its faces close it.
        depth
            Cells of the 2^depth-th part of the longest side; by default 6.
        accuracy
            Instead: how far the middles of triangles are from the surface at most, by refining.
        before
            Facets of a similar set in the same box at the same depth: boxes in which the set did
            not change are taken over. The result is the same, bit for bit.
        limit
            The most cells that the surface may pass through.
        """
        if depth is not None and accuracy is not None:
            raise ValueError("give a depth or an accuracy, not both")
        depth = _whole(depth, "depth", 0)
        old = None if before is None else before._core
        core = self._core.facets(_corners(low, high), depth, accuracy, float(limit), old)
        return Facets(core)

    def picture(
        self,
        path: str | os.PathLike[str] | None = None,
        low: Triple | None = None,
        high: Triple | None = None,
        *,
        size: tuple[int, int] = (800, 600),
        eye: Triple | None = None,
        centre: Triple | None = None,
        up: Triple = (0, 0, 1),
        angle: float = 0.6,
        lights: Sequence[Sun | Lamp] | None = None,
        ambient: float = 0.22,
        shadows: bool = True,
        shine: float = 0.15,
        samples: int = 1,
    ) -> bytes:
        """A ray-traced picture, a PNG file: exact surfaces with lights, shadows and colours.

        Parameters
        ----------
        path
            Where to write it too.
        low, high
            The box that is shown.
        size
            Picture points across and down.
        eye, centre, up
            From where to where one looks; by default from the front, right and above.
        angle
            Angle of view from top to bottom, in radians.
        lights
            :class:`Sun` and :class:`Lamp`; by default a sun over the left shoulder and a weak one
            from the right.
        ambient
            Light from everywhere.
        shadows
            Whether things throw shadows.
        shine
            Strength of highlights, 0 to 1.
        samples
            Rays along each side of a picture point.
        """
        if not 0 < angle < math.pi:
            raise ValueError(f"the angle of view must be between 0 and pi radians, found {angle}")
        if min(size) < 1:
            raise ValueError(f"a picture is 1 to 8192 points wide and high, found {size}")
        if samples < 1:
            raise ValueError(f"a picture point takes at least one sample, found {samples}")
        corners = _corners(low, high) or self._core.around()
        box = np.array(corners)
        target = np.array(triple(centre, "centre")) if centre is not None else box.mean(axis=0)
        if eye is not None:
            place = np.array(triple(eye, "eye"))
        else:
            away = np.array([-0.62, -0.68, 0.42])
            away /= np.linalg.norm(away)
            place = target + away * _reach(box, target, away, triple(up, "up"), angle, size)
        if lights is None:
            ahead = (target - place) / np.linalg.norm(target - place)
            right = np.cross(ahead, np.array(triple(up, "up")))
            lights = [
                Sun(tuple(ahead + 0.5 * right - 0.9 * np.array(up)), (0.75, 0.74, 0.7)),
                Sun(tuple(ahead - 1.2 * right - 0.2 * np.array(up)), (0.16, 0.18, 0.22)),
            ]
        rows: list[tuple[list[float] | None, list[float], list[float]]] = []
        for light in lights:
            colour = triple(light.colour, "colour")
            if isinstance(light, Sun):
                rows.append((triple(light.direction, "direction"), [0.0, 0.0, 0.0], colour))
            else:
                rows.append((None, triple(light.place, "place"), colour))
        png = self._core.picture(
            corners,
            [int(size[0]), int(size[1])],
            (list(place), list(target), triple(up, "up"), float(angle)),
            rows,
            [float(ambient)] * 3,
            [[0xFC, 0xFD, 0xFE], [0xE2, 0xE8, 0xEE]],
            (shadows, [float(shine), 40.0], int(samples)),
        )
        if path is not None:
            from moldloft.files import Output, commit

            target_path = Path(path)
            commit(target_path.parent, [Output(target_path.name, png)])
        return png

    def __repr__(self) -> str:
        if self.is_everything:
            return "<set of everything>"
        if self.is_nothing:
            return "<empty set>"
        count = self._core.contents
        return f"<set of {count} primitive{'s' if count != 1 else ''}>"


def _pairs(edges: Sequence[Sequence[str]] | None) -> list[list[str]] | None:
    """Edges by the names of two faces each."""
    if edges is None:
        return None
    pairs = [[str(name) for name in edge] for edge in edges]
    for pair in pairs:
        if len(pair) != 2:
            raise ValueError(f"an edge is named by two faces, found {len(pair)}")
    return pairs


def loads(text: str) -> Set:
    """The set of a text that :meth:`Set.dumps` made.

    Parameters
    ----------
    text
        A text that :meth:`Set.dumps` made.
    """
    return Set(_core.Set.from_text(text))


def load(path: str | os.PathLike[str]) -> Set:
    """The set of a file that :meth:`Set.save` wrote.

    Parameters
    ----------
    path
        The file.
    """
    from moldloft.storage import read_text

    return loads(read_text(path))


def _reach(
    box: Floats,
    target: Floats,
    away: Floats,
    up: Sequence[float],
    angle: float,
    size: tuple[int, int],
) -> float:
    """How far away one sees all of a box, with a little room about it."""
    right = np.cross(np.array(up), away)
    if not np.linalg.norm(right) > 0:
        right = np.array([1.0, 0.0, 0.0])
    right /= np.linalg.norm(right)
    corners = np.array(list(itertools.product(*box.T))) - target
    across, along = np.abs(corners @ right), corners @ away
    upward = np.abs(corners @ np.cross(away, right))
    slope = 0.92 * math.tan(angle / 2)
    wide = slope * size[0] / size[1]
    return float(max((upward / slope + along).max(), (across / wide + along).max()))


explain(globals())
