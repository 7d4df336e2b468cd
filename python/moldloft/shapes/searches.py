"""Nearest points and intersections of curves and surfaces, as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import ModelError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from moldloft.shapes.objects import Object

    Floats = NDArray[np.float64]

__all__ = ["Branch", "Intersection", "NearestPoints"]

#: The words for the codes of the extension.
_STATUSES = np.array(["ok", "edge-clamped", "multiple", "tangent", "failed"])

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True)
class NearestPoints:
    """The points of a curve or surface that are nearest to given ones.

    The first extents of all arrays are those of the given points, without the last.
    """

    parameters: Floats
    """Parameters: u and v on a surface, shape ``(…, 2)``; t on a curve, shape ``(…)``."""
    points: Floats
    """The feet, shape ``(…, 3)``."""
    distances: Floats
    """Distances from the given points."""
    statuses: NDArray[np.str_]
    """``"ok"``; ``"edge-clamped"`` at an edge or end because the shape ends there;
    ``"multiple"`` where others are equally near, to 1e-9 of the size; ``"tangent"`` where the
    distance is stationary to second order, so that the foot is not well determined."""


@dataclass(frozen=True)
class Branch:
    """A connected part of the intersection of a surface with another one or a plane."""

    points: Floats
    """Points along it, exactly on both, shape ``(n, 3)``; a closed branch repeats its first."""
    tangents: Floats
    """Unit tangents there, along the product of both normals, shape ``(n, 3)``."""
    parameters: Floats
    """u and v on the first surface, shape ``(n, 2)``."""
    other_parameters: Floats
    """The same on the second, shape ``(n, 2)``; of a plane ``(n, 0)``."""
    ends: tuple[str, str]
    """Reasons why it ends: ``"edge"`` of the first surface, ``"other-edge"`` of the second,
    ``"closed"``, ``"tangent"`` where the surfaces touch, ``"lost"`` after too many steps.
    """

    @property
    def closed(self) -> bool:
        """True for a closed branch."""
        return self.ends[0] == "closed"

    def __len__(self) -> int:
        """The number of points."""
        return len(self.points)


@dataclass(frozen=True)
class Intersection:
    """Intersection of two shapes."""

    branches: list[Branch]
    """Curves of intersection of two surfaces; empty if one of the shapes is a curve."""
    points: Floats
    """Single common points, shape ``(n, 3)``: intersections of a curve, or contacts of surfaces."""
    parameters: Floats
    """Parameters on the first shape: u and v, or t; shape ``(n, 2)`` or ``(n, 1)``."""
    other_parameters: Floats
    """On the second; of a plane shape ``(n, 0)``."""
    tangent: NDArray[np.bool_]
    """True if the shapes touch at the point without crossing."""
    complete: bool
    """False if the search reached its limit, as for coincident shapes: there may be more."""
    smallest: float
    """Minimum length of the branches that are found, if not tangent everywhere."""
    nearest: tuple[tuple[float, float], float] | None = None
    """Parameters of the nearest points of two curves that do not meet, and their distance; None for
    other shapes, or if the search is not complete."""

    def __bool__(self) -> bool:
        """True if there is a common point."""
        return bool(self.branches) or len(self.points) > 0


def _points(points: ArrayLike) -> Floats:
    try:
        array = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ModelError(f"points are arrays of numbers with a last extent of 3: {error}") from None
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ModelError(f"points are arrays with a last extent of 3, not of shape {array.shape}")
    bad = ~np.isfinite(array).all(axis=-1)
    if bad.any():
        first = np.argwhere(np.atleast_1d(bad))[0]
        where = ", ".join(str(k) for k in first)
        raise ModelError(
            f"point [{where}] is not finite: {array.reshape(-1, 3)[bad.ravel()][0].tolist()}"
        )
    return array


def nearest(target: Object, points: ArrayLike) -> NearestPoints:
    """Implements :meth:`moldloft.Object.nearest`."""
    array = _points(points)
    shape = array.shape[:-1]
    flat = np.ascontiguousarray(array.reshape(-1, 3))
    parameters, feet, distances, codes = _core.nearest(target._document, target.name, flat)
    width = parameters.shape[1]
    return NearestPoints(
        parameters=parameters.reshape(shape if width == 1 else (*shape, width)),
        points=feet.reshape(*shape, 3),
        distances=distances.reshape(shape),
        statuses=_STATUSES[codes].reshape(shape),
    )


def _plane(plane: object) -> tuple[list[float], list[float]]:
    if isinstance(plane, str):
        axis, equals, value = plane.replace(" ", "").partition("=")
        try:
            if equals and axis in _AXES:
                normal = _AXES[axis]
                return [float(value) * n for n in normal], list(normal)
        except ValueError:
            pass
        raise ModelError(f'a plane is written like "z=0.5", not {plane!r}')
    try:
        pair = np.asarray(plane, dtype=np.float64)
    except (TypeError, ValueError):
        pair = np.empty(0)
    if pair.shape != (2, 3):
        raise ModelError(
            "`other` of an intersection: expected a curve, surface or plane of a model, a plane as "
            f'a point and a normal, or as text like "z=0.5", not {plane!r}'
        )
    return pair[0].tolist(), pair[1].tolist()


def intersect(target: Object, other: object) -> Intersection:
    """Implements :meth:`moldloft.Object.intersect`."""
    from moldloft.shapes.objects import Object

    found: dict[str, Any]
    if isinstance(other, Object):
        found = _core.intersect(target._document, target.name, other._document, other.name)
    else:
        point, normal = _plane(other)
        found = _core.intersect_plane(target._document, target.name, point, normal)
    branches = [
        Branch(b["points"], b["tangents"], b["parameters"], b["other"], tuple(b["ends"]))
        for b in found["branches"]
    ]
    return Intersection(
        branches=branches,
        points=found["points"],
        parameters=found["parameters"],
        other_parameters=found["other"],
        tangent=found["tangent"],
        complete=found["complete"],
        smallest=found["smallest"],
        nearest=None
        if found["nearest"] is None
        else (tuple(found["nearest"][0]), found["nearest"][1]),
    )


explain(globals())
