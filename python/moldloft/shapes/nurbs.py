"""Shapes as NURBS data: control points, knots, weights, degrees, and an error bound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import Error

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["Nurbs"]

_WIDTH = 96
"""Characters of a line of a program."""


@dataclass(frozen=True, eq=False)
class Nurbs:
    """A curve, surface or solid as a NURBS with clamped knots over [0, 1] in each parameter.

    Examples
    --------
    >>> import moldloft
    >>> m = moldloft.loads('''
    ... AbsPoint A(1, 0, 0); AbsPoint O(0, 0, 0); AbsPoint B(0, 1, 0); Arc a(A, O, B, type = 2);
    ... ''')
    >>> n = m["a"].to_nurbs()
    >>> n.exact, n.degrees, n.weights.round(6).tolist()
    (True, (2,), [1.0, 0.707107, 1.0])
    >>> n.points.round(12).tolist()
    [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]
    >>> bool(abs(n(0.3)[0] ** 2 + n(0.3)[1] ** 2 - 1) < 1e-14)
    True
    """

    degrees: tuple[int, ...]
    """Polynomial degree in each parameter: one of a curve, two of a surface, three of a solid."""
    knots: tuple[Floats, ...]
    """Knots in each parameter, end knots included (degree + 1 times)."""
    points: Floats
    """Control points, not multiplied by weights: ``(n, 3)``, ``(nu, nv, 3)`` or
    ``(nu, nv, nw, 3)``."""
    weights: Floats | None = None
    """Weights in the shape of the points; None if all are 1."""
    error: float = 0.0
    """Bound of the distance from the shape at equal parameters, in its unit of length."""
    exact: bool = True
    """True if the NURBS equals the shape to rounding."""
    angles: tuple[float, ...] = ()
    """For each parameter that is linear in an angle, that angle in radians: there the NURBS is the
    same set of points at other parameters (see :meth:`parameters`). Else 0.
    """

    def __post_init__(self) -> None:
        if len(self.knots) != len(self.degrees):
            raise Error(f"{len(self.degrees)} degrees do not fit {len(self.knots)} rows of knots")
        shape = tuple(len(k) - p - 1 for k, p in zip(self.knots, self.degrees, strict=True))
        if self.points.shape != (*shape, 3):
            raise Error(f"{self.points.shape} control points do not fit knots for {shape}")
        if self.weights is not None and self.weights.shape != shape:
            raise Error(f"{self.weights.shape} weights do not fit {shape} control points")
        if not self.angles:
            object.__setattr__(self, "angles", (0.0,) * len(shape))

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> Nurbs:
        counts = tuple(data["counts"])
        weights = data["weights"]
        return cls(
            tuple(data["degrees"]),
            tuple(data["knots"]),
            data["points"].reshape(*counts, 3),
            None if weights is None else weights.reshape(counts),
            float(data["error"]),
            bool(data["exact"]),
            tuple(data["angles"]),
        )

    def _data(self) -> tuple[list[int], list[Floats], Floats, Floats | None]:
        """Degrees, knots, control points ``(n, 3)`` and weights, for the compiled part."""
        weights = None if self.weights is None else np.ascontiguousarray(self.weights.ravel())
        net = np.ascontiguousarray(self.points.reshape(-1, 3), dtype=np.float64)
        return list(self.degrees), list(map(np.ascontiguousarray, self.knots)), net, weights

    @property
    def dimension(self) -> int:
        """1 for a curve, 2 for a surface, 3 for a solid."""
        return len(self.degrees)

    def __call__(self, *parameters: ArrayLike) -> Floats:
        """Points at parameters of the NURBS, broadcast against each other: ``(…, 3)``."""
        if len(parameters) != self.dimension:
            raise TypeError(f"{self.dimension} parameters are needed, {len(parameters)} were given")
        at = np.broadcast_arrays(*(np.asarray(p, dtype=np.float64) for p in parameters))
        places = np.stack([each.ravel() for each in at], axis=-1)
        weights = None if self.weights is None else np.ascontiguousarray(self.weights.ravel())
        net = np.ascontiguousarray(self.points.reshape(-1, 3), dtype=np.float64)
        found = _core.nurbs_points(self.degrees, self.knots, net, weights, places)
        points: Floats = found.reshape(*at[0].shape, 3)
        return points

    def parameters(self, *parameters: ArrayLike) -> tuple[Floats, ...]:
        """The shape's own parameters at parameters of the NURBS.

        The two differ only along parameters that are linear in an angle for the shape.

        Parameters
        ----------
        *parameters
            Parameters of the NURBS, one array for each direction; they are broadcast.

        Returns
        -------
        tuple of numpy.ndarray
            One for each direction, of the broadcast shape.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads('''
        ... AbsPoint A(1, 0, 0); AbsPoint O(0, 0, 0); AbsPoint B(0, 1, 0); Arc a(A, O, B, type = 2);
        ... ''')
        >>> n = m["a"].to_nurbs()
        >>> bool(abs(m["a"](*n.parameters(0.2)) - n(0.2)).max() < 1e-15)
        True
        """
        found: list[Floats] = []
        for s, angle in zip(parameters, self.angles, strict=True):
            at = np.asarray(s, dtype=np.float64)
            if angle == 0:
                found.append(at)
                continue
            pieces = max(1.0, np.ceil(abs(angle) / (np.pi / 2) - 1e-9))
            each = abs(angle) / pieces
            piece = np.clip(np.floor(at * pieces), 0, pieces - 1)
            x = at * pieces - piece
            y = 1 - x
            across = 2 * x * y * np.sin(each / 2) + x * x * np.sin(each)
            along = y * y + 2 * x * y * np.cos(each / 2) + x * x * np.cos(each)
            found.append((piece + np.arctan2(across, along) / each) / pieces)
        return tuple(found)

    def to_sdl(self, name: str, *, points: str = "") -> str:
        """A statement that declares this curve or surface: ``NURBCurve`` or ``NURBSurf``.

        Parameters
        ----------
        name
            The name of the object.
        points
            An expression of the control points in their order; by default their coordinates.

        Returns
        -------
        str
            One statement.

        Raises
        ------
        Error
            For a solid, for which the language has no such kind.

        Examples
        --------
        >>> import moldloft
        >>> m = moldloft.loads("Line l({0, 0, 0}, {1, 2, 3});")
        >>> print(m["l"].to_nurbs().to_sdl("copy"))
        NURBCurve copy({{0, 0, 0}, {1, 2, 3}}, 1, {0, 0, 1, 1});
        """
        return self._statement(name, {}, points)

    def _statement(self, name: str, points_of: Mapping[int, str], points: str = "") -> str:
        """The statement, with some control points as named objects."""
        if not points:
            flat = self.points.reshape(-1, 3)
            points = _braced(
                points_of.get(k) or _braced(map(_plain, p)) for k, p in enumerate(flat)
            )
        weights = "" if self.weights is None else _braced(map(_plain, self.weights.ravel()))
        knots = [_braced(map(_plain, k)) for k in self.knots]
        if self.dimension == 1:
            text = f"NURBCurve {name}({points}, {self.degrees[0]}, {knots[0]}"
            return _wrapped(text + (f", {weights});" if weights else ");"))
        if self.dimension == 2:
            (nu, nv), (p, q) = self.points.shape[:2], self.degrees
            text = f"NURBSurf {name}({points}, nu = {nu}, nv = {nv}, degree_u = {p}, "
            text += f"degree_v = {q}, knots_u = {knots[0]}, knots_v = {knots[1]}"
            return _wrapped(text + (f", weights = {weights});" if weights else ");"))
        raise Error("no kind of solid takes control points with knots")

    def __repr__(self) -> str:
        what = ("curve", "surface", "solid")[self.dimension - 1]
        counts = " x ".join(str(n) for n in self.points.shape[:-1])
        degrees = ", ".join(map(str, self.degrees))
        how = "exact" if self.exact else f"error at most {self.error:.2g}"
        rational = "" if self.weights is None else "rational "
        return f"<Nurbs: {rational}{what} of degree {degrees}, {counts} control points, {how}>"


def _plain(x: float) -> str:
    """The shortest decimal that reads back as the same number."""
    text = repr(float(x) + 0.0)
    return text[:-2] if text.endswith(".0") else text


def _braced(items: Sequence[str] | Any) -> str:
    return "{" + ", ".join(items) + "}"


def _wrapped(text: str) -> str:
    """A statement in lines."""
    lines = []
    at, indent = 0, ""
    while len(text) - at > _WIDTH - len(indent):
        cut = text.rfind(" ", at, at + _WIDTH - len(indent))
        if cut <= at:
            break
        lines.append(indent + text[at:cut])
        at, indent = cut + 1, "    "
    return "\n".join([*lines, indent + text[at:]])


explain(globals())
