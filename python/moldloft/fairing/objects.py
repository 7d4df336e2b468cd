"""Objects of models as points to be faired."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from moldloft.errors import FairingError
from moldloft.fairing.spline import Spline
from moldloft.fairing.surface import SplineSurface

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]

__all__ = ["Sampled", "sampled"]

SHARE = 0.01
"""Maximum error of a fit, relative to the tolerance."""


@dataclass
class Sampled:
    """Points sampled on an object."""

    points: Floats
    """``(n, 3)`` of a curve, ``(m, n, 3)`` of a surface."""
    role: str
    """``"fit"`` for shapes, ``"control"`` for rows of points."""
    error: float | None
    """Distance between the spline through the points and the shape."""
    closed: bool = False
    """True if a curve returns to its start without a corner."""
    breaks: list[int] = field(default_factory=list)
    """Points at which a curve has corners."""


def sampled(model: Model, name: str, tol: float | None) -> Sampled:
    """The curve, the surface or the rows of points called ``name``, as points.

    Their number keeps the spline through them within a hundredth of the tolerance.
    """
    document = model._document
    if not document.has(name):
        # An expression of the program's own arrays.
        value = model.eval(name)
        points = np.asarray(value, np.float64) if not isinstance(value, (str, list)) else None
        if points is None or points.ndim not in (2, 3) or points.shape[-1] != 3:
            raise FairingError(f"`{name}` is neither a curve, a surface nor rows of points")
        return Sampled(points, "control", None)
    facts = document.object(name)
    kind = facts["class"]
    if kind in ("curve", "snake"):
        return _curve(model, name, tol)
    if kind == "surface":
        return _surface(model, name, tol)
    raise FairingError(f"`{name}` is a {kind}: only curves and surfaces are faired")


def _corners(model: Model, name: str) -> tuple[list[float], bool]:
    """Parameters of corners, and true if the curve closes smoothly."""
    document = model._document
    eps = 1e-7
    _, _, breaks = document.curve_derivatives(name, np.array([0.5]))
    corners = []
    for t in breaks:
        sides, _, _ = document.curve_derivatives(name, np.array([t - eps, t + eps]))
        if _turn(sides[0], sides[1]) > 1e-4:
            corners.append(float(t))
    ends = model[name]([0.0, 1.0])
    extent = float(np.ptp(model[name](np.linspace(0, 1, 33)), axis=0).max())
    together = bool(np.linalg.norm(ends[1] - ends[0]) <= 1e-12 * extent)
    tangents, _, _ = document.curve_derivatives(name, np.array([1.0, 0.0]))
    return corners, together and _turn(tangents[0], tangents[1]) <= 1e-4


def _turn(a: Floats, b: Floats) -> float:
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return (
        0.0
        if size == 0
        else float(np.linalg.norm(np.cross(a, b)) / size) + max(0.0, -float(a @ b) / size)
    )


def _allowed(tol: float | None, extent: float) -> float:
    return max(SHARE * tol, 1e-9 * extent) if tol else 1e-6 * extent


def _curve(model: Model, name: str, tol: float | None) -> Sampled:
    curve = model[name]
    corners, closed = _corners(model, name)
    extent = float(np.ptp(curve(np.linspace(0, 1, 65)), axis=0).max())
    allowed = _allowed(tol, extent)
    ends = [0.0, *corners, 1.0]
    per_piece = 32 if not corners else 16
    while True:
        ts: list[float] = []
        breaks: list[int] = []
        for a, b in pairwise(ends):
            if ts:
                breaks.append(len(ts))
            ts += list(a + (b - a) * np.arange(per_piece) / per_piece)
        if not (closed and not corners):
            ts.append(1.0)
        points = curve(ts)
        smooth = closed and not corners
        spacing = "index" if not corners else "chord"
        spline, at, _ = Spline._interpolated(points, 3, spacing, smooth, breaks)
        middle = 0.5 * (np.asarray(ts) + np.append(ts[1:], 1.0))
        middle = middle if smooth else middle[:-1]
        if corners:
            wanted = curve(middle)
            dense = spline(np.linspace(0, 1, 8 * len(ts) + 1))
            error = max(float(np.linalg.norm(dense - w, axis=1).min()) for w in wanted)
            # The samples' own distance is no error of the fit.
            error = min(error, _chordal(spline, at, wanted))
        else:
            error = float(np.linalg.norm(spline(middle) - curve(middle), axis=1).max())
        if error <= allowed or len(ts) >= 1024:
            return Sampled(points, "fit", error, smooth, breaks)
        per_piece *= 2


def _chordal(spline: Spline, at: Floats, wanted: Floats) -> float:
    """Distances of points from the spline, each near the middle of its interval."""
    worst = 0.0
    for k, w in enumerate(wanted):
        low, high = at[k], at[k + 1]
        for _ in range(40):
            thirds = [low + (high - low) / 3, high - (high - low) / 3]
            a, b = np.linalg.norm(spline(thirds) - w, axis=1)
            low, high = (low, thirds[1]) if a < b else (thirds[0], high)
        worst = max(worst, float(np.linalg.norm(spline(0.5 * (low + high)) - w)))
    return worst


def _surface(model: Model, name: str, tol: float | None) -> Sampled:
    surface = model[name]
    size = 17
    extent = float(np.ptp(surface.grid(9, 9).reshape(-1, 3), axis=0).max())
    allowed = _allowed(tol, extent)
    while True:
        points = surface.grid(size, size)
        fitted = SplineSurface.interpolate(points)
        middle = (np.arange(size - 1) + 0.5) / (size - 1)
        u, v = np.meshgrid(middle, middle, indexing="ij")
        off = fitted.grid(middle, middle) - surface(u, v)
        error = float(np.linalg.norm(off, axis=-1).max())
        if error <= allowed or size >= 65:
            return Sampled(points, "fit", error)
        size = 2 * size - 1
