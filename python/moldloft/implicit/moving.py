"""Boxes, and common transformations of fields and sets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from moldloft.arguments import explain

if TYPE_CHECKING:
    from typing import Self

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]
    Triple = Sequence[float]

__all__ = ["Moving", "box_of", "corners_of", "triple"]


def triple(x: Sequence[float] | Floats, what: str) -> list[float]:
    """Three numbers as a list."""
    values = [float(v) for v in x]
    if len(values) != 3:
        raise ValueError(f"the {what} has three coordinates, found {len(values)}")
    return values


def box_of(low: Sequence[float] | Floats, high: Sequence[float] | Floats) -> list[list[float]]:
    """The low and the high corner of a box, which may be flat."""
    corners = [triple(low, "low corner"), triple(high, "high corner")]
    if not all(
        a <= b and abs(a) < np.inf and abs(b) < np.inf for a, b in zip(*corners, strict=True)
    ):
        raise ValueError(
            f"the low corner {tuple(corners[0])} is not below the high {tuple(corners[1])}"
        )
    return corners


def corners_of(low: Triple | None, high: Triple | None) -> tuple[list[float], list[float]] | None:
    """The corners of a box; ``None`` without a box."""
    if low is None and high is None:
        return None
    if low is None or high is None:
        raise ValueError("a box has two corners: give both low and high, or neither")
    first, last = box_of(low, high)
    return first, last


def turn(point: Triple, direction: Triple, angle: float) -> tuple[Floats, list[float]]:
    """The map of a rotation (Rodrigues' formula)."""
    angle = float(angle)
    d = np.array(triple(direction, "direction"))
    size = float(np.linalg.norm(d))
    if not size > 0 or not np.isfinite(size):
        raise ValueError("the direction of the axis has no length")
    d /= size
    cross = np.array([[0, -d[2], d[1]], [d[2], 0, -d[0]], [-d[1], d[0], 0]])
    matrix = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross)
    p = np.array(triple(point, "point"))
    return matrix, list(p - matrix @ p)


def reflection(normal: Triple, point: Triple) -> tuple[Floats, list[float]]:
    """The map of a mirror."""
    n = np.array(triple(normal, "normal"))
    size = float(np.linalg.norm(n))
    if not size > 0 or not np.isfinite(size):
        raise ValueError("the normal of the mirror plane is zero")
    n /= size
    p = np.array(triple(point, "point"))
    return np.eye(3) - 2 * np.outer(n, n), list(2 * n * (n @ p))


def scaling(factor: float, centre: Triple) -> tuple[Floats, list[float]]:
    """The map of a scaling."""
    c = np.array(triple(centre, "centre"))
    return np.eye(3) * float(factor), list(c * (1 - float(factor)))


class Moving:
    """Transformations; they return a new shape and leave this one unchanged."""

    def mapped(self, matrix: ArrayLike, shift: Triple = (0, 0, 0)) -> Self:
        """The shape moved by the affine map X -> matrix X + shift.

        Parameters
        ----------
        matrix
            Matrix ``(3, 3)``.
        shift
            Translation after the matrix, ``(3,)``.

        Returns
        -------
        Field or Set
            A new one; this stays as it is.
        """
        raise NotImplementedError

    def translated(self, by: Triple) -> Self:
        """The shape moved by a vector.

        Parameters
        ----------
        by
            The vector, ``(3,)``.

        Returns
        -------
        Field or Set
            A new one; this stays as it is.

        Raises
        ------
        ArgumentError
            If the vector has not three coordinates.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> im.sphere((0, 0, 0), 1).translated((3, 0, 0))((3, 0, 0))
        -1.0
        """
        return self.mapped(np.eye(3), by)

    def turned(self, point: Triple, direction: Triple, angle: float) -> Self:
        """The shape turned about a line, right-handed, by an angle in radians.

        Parameters
        ----------
        point
            A point of the axis, ``(3,)``.
        direction
            A direction of any length, ``(3,)``.
        angle
            Angle, radians.

        Returns
        -------
        Field or Set
            A new one; this stays as it is.

        Raises
        ------
        ArgumentError
            If the direction has no length.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> import math
        >>> ball = im.sphere((0, 0, 0), 1).translated((3, 0, 0))
        >>> round(ball.turned((0, 0, 0), (0, 0, 1), math.pi)((-3, 0, 0)), 9)
        -1.0
        """
        return self.mapped(*turn(point, direction, angle))

    def mirrored(self, normal: Triple, point: Triple = (0, 0, 0)) -> Self:
        """The mirror image in a plane.

        Parameters
        ----------
        normal
            A normal of any length, ``(3,)``; it points from solid to air.
        point
            A point, ``(3,)``.

        Returns
        -------
        Field or Set
            A new one; this stays as it is.

        Raises
        ------
        ArgumentError
            If the normal has no length.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> im.sphere((0, 0, 0), 1).translated((3, 0, 0)).mirrored((1, 0, 0))((-3, 0, 0))
        -1.0
        """
        return self.mapped(*reflection(normal, point))

    def scaled(self, factor: float, centre: Triple = (0, 0, 0)) -> Self:
        """The shape scaled about a point.

        Parameters
        ----------
        factor
            The factor, not zero.
        centre
            The centre, ``(3,)``.

        Returns
        -------
        Field or Set
            A new one; this stays as it is.

        Raises
        ------
        Error
            If the factor is 0.

        Examples
        --------
        >>> from moldloft import implicit as im
        >>> im.sphere((0, 0, 0), 1).scaled(4)((3, 0, 0)) < 0
        True
        """
        return self.mapped(*scaling(factor, centre))


explain(globals())
