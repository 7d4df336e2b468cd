"""Simpler curves within the tolerances of data: a straight line, a circle, another conic."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.fairing.report import Numbers

    Floats = NDArray[np.float64]

__all__ = ["simpler"]

_ROUNDS = 60
"""Rounds of weights for the least largest distance (Lawson 1961)."""

_SLOPES = 5
"""Rounds after which the slopes of distances are known."""

_NEAR = 1.02
"""Ratio to the least largest distance that is near enough."""

_MOST_FITTED = 1000
"""Points that are fitted."""

_SPARE = 4
"""Points beyond those that determine a curve, for a coincidence to be excluded."""

_STRAIGHT = 1e-3
"""Turn over the length of a curve that is straight."""

_PLANE = 1e-9
"""Distance from a plane, relative to the size, of points in it."""

_FAR = 10.0
"""A step over the size of the points beyond which there is no foot."""

_MOST_PIECES = {"line": 1, "circle": 1, "conic": 4}


def simpler(
    data: Floats, limits: Floats, motion: tuple[str, Floats], after: Numbers, length: float
) -> str | None:
    """A curve with fewer monotone pieces than the result that is within all tolerances.

    Parameters
    ----------
    data
        The points, ``(n, 3)``.
    limits
        Their tolerances, ``(n,)``.
    motion
        ``"ball"``, ``"box"`` or ``"along"``, with the direction ``(3,)``.
    after
        The numbers of the result.
    length
        Its length.

    Returns
    -------
    str or None
        A note; ``None`` where there is no such curve of these kinds.
    """
    word, way = motion
    if word not in ("ball", "box", "along") or not (limits > 0).all():
        return None
    # Points without limit say nothing about a curve.
    held = np.isfinite(limits)
    data, limits = data[held], limits[held]
    if len(data) < 2 + _SPARE:
        return None
    plane = _plane(data)
    if plane is None:
        return None
    middle, axes = plane
    size = float(np.abs(data - middle).max())
    points = (data - middle) @ axes.T / size
    along = axes @ way if word == "along" else None
    if along is not None and np.linalg.norm(along) < (1 - _PLANE) * np.linalg.norm(way):
        return None
    for kind in ("line", "circle", "conic"):
        bent = after.pieces > _MOST_PIECES[kind] or after.inflections > 0
        if kind == "line":
            bent |= after.largest_curvature * length > _STRAIGHT
        if not bent:
            continue
        found = _within((points, limits / size), along, kind)
        if found is not None:
            share, q = found
            return f"{_said(kind, q, middle, axes, size)} is within {share:.2f} of the tolerances"
    return None


def _plane(data: Floats) -> tuple[Floats, Floats] | None:
    """The middle of points in a plane, and two unit vectors of it; xy where it is that."""
    middle = data.mean(axis=0)
    off = data - middle
    if not off[:, 2].any():
        return middle, np.eye(3)[:2]
    _, sizes, rows = np.linalg.svd(off, full_matrices=False)
    return (middle, rows[:2]) if sizes[2] <= _PLANE * sizes[0] else None


def _terms(kind: str, p: Floats) -> tuple[Floats, Floats, Floats]:
    """The terms of a curve at points, ``(n, m)``, and their derivatives by x and y."""
    x, y, one, no = p[:, 0], p[:, 1], np.ones(len(p)), np.zeros(len(p))
    value, by_x, by_y = [x, y, one], [one, no, no], [no, one, no]
    if kind == "circle":
        value, by_x, by_y = [x * x + y * y, *value], [2 * x, *by_x], [2 * y, *by_y]
    if kind == "conic":
        value = [x * x, x * y, y * y, *value]
        by_x, by_y = [2 * x, y, no, *by_x], [no, x, 2 * y, *by_y]
    return np.stack(value, 1), np.stack(by_x, 1), np.stack(by_y, 1)


def _within(
    data: tuple[Floats, Floats], along: Floats | None, kind: str
) -> tuple[float, Floats] | None:
    """The coefficients of a curve within the tolerances, with the largest share of these."""
    # Of very many points some are fitted, and all are compared.
    every = -(-len(data[0]) // _MOST_FITTED)
    points, limits = (each[::every] for each in data)
    terms, by_x, by_y = _terms(kind, points)
    if len(points) < terms.shape[1] - 1 + _SPARE:
        return None
    weights, slope = np.ones(len(points)), np.ones(len(points))
    best: tuple[float, Floats] | None = None
    for k in range(_ROUNDS):
        rows = terms * (np.sqrt(weights) / (slope * limits))[:, None]
        q = np.linalg.svd(rows, full_matrices=False)[2][-1]
        gradient = np.stack([by_x @ q, by_y @ q], 1)
        slope = np.linalg.norm(gradient, axis=1) if along is None else np.abs(gradient @ along)
        slope = np.maximum(slope, 1e-9 * slope.max())
        share = np.abs(terms @ q) / (slope * limits)
        if best is None or share.max() < best[0]:
            best = (float(share.max()), q)
        # Weighted means are no larger than the least largest distance, once slopes are known.
        least = float(np.sqrt((weights * share**2).sum() / weights.sum()))
        if share.max() == 0.0 or (k >= _SLOPES and (least > 1.0 or best[0] <= _NEAR * least)):
            break
        weights = weights * share
        weights /= weights.max()
    if best is None or best[0] > 1.0:
        return None
    points, limits = data
    feet = _feet(kind, best[1], points, along)
    if feet is None or not _in_order(kind, best[1], feet, limits):
        return None
    share = np.linalg.norm(feet - points, axis=1) / limits
    return (float(share.max()), best[1]) if share.max() <= 1.0 else None


def _feet(kind: str, q: Floats, points: Floats, along: Floats | None) -> Floats | None:
    """The points of the curve nearest to these, or on the lines along a direction."""
    at = points.copy()
    for _ in range(50):
        terms, by_x, by_y = _terms(kind, at)
        gradient = np.stack([by_x @ q, by_y @ q], 1)
        value = terms @ q
        # Of a point that no direction leads from.
        least = np.finfo(float).tiny
        if along is not None:
            slope = gradient @ along
            slope[slope == 0.0] = least
            step = -(value / slope)[:, None] * along
        else:
            square = np.maximum((gradient**2).sum(axis=1), least)
            off = points - at
            across = ((off * gradient).sum(axis=1) / square)[:, None] * gradient
            step = off - across - (value / square)[:, None] * gradient
        if not np.abs(step).max() < _FAR:
            return None
        at = at + step
        if np.abs(step).max() < 1e-13:
            return at
    return None


def _in_order(kind: str, q: Floats, feet: Floats, limits: Floats) -> bool:
    """True if the feet follow each other along one branch, up to steps within the tolerances."""
    usual = float(np.median(np.linalg.norm(np.diff(feet, axis=0), axis=1)))
    every = int(min(1 + 3 * limits.max() // max(usual, np.finfo(float).tiny), len(feet)))
    feet, limits = feet[::every], limits[::every]
    if len(feet) < 3:
        return False
    _, by_x, by_y = _terms(kind, feet)
    tangent = np.stack([-(by_y @ q), by_x @ q], 1)
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    step = np.diff(feet, axis=0)
    on = (step * (tangent[:-1] + tangent[1:])).sum(axis=1)
    long = np.linalg.norm(step, axis=1) > limits[:-1] + limits[1:]
    same = (tangent[:-1] * tangent[1:]).sum(axis=1) > 0
    return bool(same.all() and long.any() and (np.sign(on[long]) == np.sign(on.sum())).all())


def _said(kind: str, q: Floats, middle: Floats, axes: Floats, size: float) -> str:
    if kind == "line":
        return "a straight line"
    if kind == "circle":
        centre = -0.5 * q[1:3] / q[0]
        radius = size * float(np.sqrt(max(centre @ centre - q[3] / q[0], 0.0)))
        place = middle + size * (centre @ axes)
        at = ", ".join(f"{x:.6g}" for x in (place if axes[:, 2].any() else place[:2]))
        return f"a circle of radius {radius:.6g} about ({at})"
    bend = q[1] ** 2 - 4 * q[0] * q[2]
    flat = abs(bend) <= 1e-6 * float((q[:3] ** 2).sum())
    return "a parabola" if flat else "a hyperbola" if bend > 0 else "an ellipse"
