"""Division of space by a set: boxes that are solid, empty, or contain few primitives."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from moldloft.arguments import explain
from moldloft.implicit.moving import corners_of, triple
from moldloft.implicit.sets import Set

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Triple = Sequence[float]

__all__ = ["Division", "DivisionBox"]

# The most boxes of a division: a list of more is a mistake, or wants a smaller depth.
MOST = 200_000

FILLS = {"solid": "#b9c4cf", "air": "none", "surface": "#f2d7a0"}


@dataclass(frozen=True)
class DivisionBox:
    """A box of a division, with the set restricted to it."""

    low: Floats
    """The low corner, ``(3,)``."""
    high: Floats
    """The high corner, ``(3,)``."""
    set: Set
    """The same set inside of the box, and unspecified outside."""
    kind: str
    """``"solid"`` or ``"air"``, both proved, or ``"surface"`` if it may contain the surface."""
    depth: int
    """Number of halvings of the whole box along each axis."""


class Division:
    """A box, halved where the surface of a set may be and depends on many primitives.

    Parameters
    ----------
    set
        The set.
    low, high
        The box; found around a set that has an end.
    depth
        Maximum number of halvings along each axis.
    primitives
        Number of remaining primitives at which a box is not halved any more.

    Raises
    ------
    Error
        If the set has no end and no box is given.
    ValueError
        If the depth is negative.

    Examples
    --------
    >>> from moldloft import implicit as im
    >>> balls = im.union(im.sphere((0, 0, 0), 1), im.sphere((3, 0, 0), 1))
    >>> division = im.Division(balls, (-2, -2, -2), (6, 2, 2), depth=3)
    >>> box = division.leaf((3, 0, 0.9))
    >>> box.kind, len(box.set.leaves)
    ('surface', 1)
    """

    def __init__(
        self,
        set: Set,
        low: Triple | None = None,
        high: Triple | None = None,
        *,
        depth: int = 5,
        primitives: int = 1,
    ) -> None:
        if depth < 0:
            raise ValueError(f"a depth is 0 or more, found {depth}")
        corners = corners_of(low, high) or set._core.around()
        self.low, self.high = (np.array(corner, dtype=float) for corner in corners)
        self.depth, self.primitives = int(depth), int(primitives)
        self._root = self._box(self.low, self.high, set, 0)

    def _box(self, low: Floats, high: Floats, of: Set, depth: int) -> DivisionBox:
        least, most = of.range(low.tolist(), high.tolist())
        if most < 0 or of.is_everything:
            return DivisionBox(low, high, of, "solid", depth)
        if least > 0 or of.is_nothing:
            return DivisionBox(low, high, of, "air", depth)
        inside = of.pruned(low.tolist(), high.tolist())
        return DivisionBox(low, high, inside, "surface", depth)

    def _divided(self, box: DivisionBox) -> bool:
        few = len(box.set.leaves) <= self.primitives
        return box.kind == "surface" and box.depth < self.depth and not few

    def _half(self, box: DivisionBox, upper: Sequence[bool]) -> DivisionBox:
        middle = 0.5 * (box.low + box.high)
        low, high = np.where(upper, middle, box.low), np.where(upper, box.high, middle)
        return self._box(low, high, box.set, box.depth + 1)

    def leaf(self, point: Triple) -> DivisionBox:
        """The box that contains a point, without the rest of the division.

        Parameters
        ----------
        point
            A point of the whole box, ``(3,)``.

        Returns
        -------
        DivisionBox
            The box of a point; for a point between two, the upper one.

        Raises
        ------
        ValueError
            If the point is outside of the whole box.
        """
        at = np.array(triple(point, "point"))
        if (at < self.low).any() or (at > self.high).any():
            raise ValueError(f"{at.tolist()} is outside of the box that is divided")
        box = self._root
        while self._divided(box):
            box = self._half(box, (at >= 0.5 * (box.low + box.high)).tolist())
        return box

    def _walk(
        self, box: DivisionBox, axis: int = 0, at: float | None = None
    ) -> Iterator[DivisionBox]:
        if at is not None and not box.low[axis] <= at <= box.high[axis]:
            return
        if not self._divided(box):
            yield box
            return
        for upper in itertools.product((False, True), repeat=3):
            yield from self._walk(self._half(box, upper), axis, at)

    @cached_property
    def boxes(self) -> tuple[DivisionBox, ...]:
        """All boxes; at most 200 000, more are a ValueError."""
        found = tuple(itertools.islice(self._walk(self._root), MOST + 1))
        if len(found) > MOST:
            raise ValueError(f"more than {MOST} boxes: take a smaller depth than {self.depth}")
        return found

    def section_svg(self, axis: str = "z", at: float | None = None) -> str:
        """The boxes that a plane across an axis cuts, as an SVG drawing.

        Solid boxes are grey, those that may contain the surface yellow; the title of each states
        its number of primitives.

        Parameters
        ----------
        axis
            ``"x"``, ``"y"`` or ``"z"``: the plane is perpendicular to it.
        at
            The coordinate of the plane, by default that of the middle of the box.

        Returns
        -------
        str
            The drawing, in units of the model.

        Raises
        ------
        ValueError
            If the axis is another, or the plane does not cut the box.
        """
        if axis not in ("x", "y", "z"):
            raise ValueError(f"an axis is x, y or z, found {axis!r}")
        k = "xyz".index(axis)
        place = float(0.5 * (self.low[k] + self.high[k]) if at is None else at)
        if not self.low[k] <= place <= self.high[k]:
            raise ValueError(f"the plane {axis} = {place} does not intersect the box")
        i, j = [(1, 2), (0, 2), (0, 1)][k]
        width, height = self.high[i] - self.low[i], self.high[j] - self.low[j]
        line = 0.002 * max(width, height)
        out = [
            f'<svg xmlns="http://www.w3.org/2000/svg" '
            f'viewBox="0 0 {width:.9g} {height:.9g}" width="800">'
        ]
        for box in self._walk(self._root, k, place):
            # A plane between two boxes shows the upper one.
            if place == box.high[k] and place < self.high[k]:
                continue
            x, y = box.low[i] - self.low[i], self.high[j] - box.high[j]
            w, h = box.high[i] - box.low[i], box.high[j] - box.low[j]
            count = len(box.set.leaves) if box.kind == "surface" else 0
            title = f"{box.kind}, {count} primitives" if count else box.kind
            out.append(
                f'<rect x="{x:.9g}" y="{y:.9g}" width="{w:.9g}" height="{h:.9g}" '
                f'fill="{FILLS[box.kind]}" stroke="#30363c" stroke-width="{line:.3g}">'
                f"<title>{title}</title></rect>"
            )
        out.append("</svg>")
        return "\n".join(out)


explain(globals())
