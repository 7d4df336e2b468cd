"""Curves on surfaces in the parameters of these, where a file has them in space alone."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from moldloft.shapes.nurbs import Nurbs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["traced"]

_FEWEST, _MOST = 4, 64
"""Numbers of divisions between two breaks."""

_STEP = 1e-6
"""Step of differences in the parameters."""

_STARTS = 25
"""Places along u and v at which the nearest one is looked for first."""

_CROSSINGS = 128
"""Number of places at which crossings of knots are looked for."""

_HALVINGS = 40
"""Number of halvings that find a crossing."""

_ROUNDS = 24
"""Number of steps of the method of Newton."""

_LEAST = 1e-10
"""Square of the ratio of slopes below which a direction is none."""

_NEAR = 1e-7
"""Least distance of a path from its curve, relative to the size of the surface."""


def traced(surface: Nurbs, curve: Nurbs, gap: float) -> list[Nurbs]:
    """A curve on a surface in its parameters, with the curve's parametrisation; empty without one.

    Along a seam there are two paths.

    Parameters
    ----------
    surface
        The surface, smooth along the curve.
    curve
        The curve, in space.
    gap
        Largest distance of the result from the curve.
    """
    size = float(np.ptp(surface.points.reshape(-1, 3), axis=0).max())
    near = max(gap, _NEAR * size)
    breaks = _breaks(surface, curve)
    count = _FEWEST
    while count <= _MOST:
        parts = [np.linspace(a, b, count + 1) for a, b in pairwise(breaks)]
        t = np.append(np.concatenate([part[:-1] for part in parts]), 1.0)
        path = _joined(parts, _feet(surface, curve(t)))
        fine = np.concatenate([np.linspace(a, b, 5 * count + 1) for a, b in pairwise(breaks)])
        at = path(fine)[:, :2]
        inside = np.clip(at, 0, 1)
        off = np.linalg.norm(surface(inside[:, 0], inside[:, 1]) - curve(fine), axis=1).max()
        if off <= near and np.abs(inside - at).max() < _STEP:
            np.clip(path.points, 0, 1, out=path.points)
            return [path, *_beyond_seam(surface, path, near)]
        count *= 2
    return []


def _breaks(surface: Nurbs, curve: Nurbs) -> Floats:
    """The knots of a curve, and where it crosses those of a surface."""
    inner = np.unique(curve.knots[0])
    count = max(2, _CROSSINGS // len(inner))
    parts = [np.linspace(a, b, count + 1)[:-1] for a, b in pairwise(inner)]
    t = np.append(np.concatenate(parts), 1.0)
    uv = _feet(surface, curve(t))
    found = [inner]
    for k in (0, 1):
        for knot in np.unique(surface.knots[k])[1:-1]:
            low = (uv[:-1, k] - knot) * (uv[1:, k] - knot) < 0
            a, b = t[:-1][low], t[1:][low]
            before = uv[:-1, k][low] < knot
            at = (uv[:-1][low] + uv[1:][low]) / 2
            for _ in range(_HALVINGS if len(a) else 0):
                middle = (a + b) / 2
                at = _nearest(surface, curve(middle), at, 4)
                same = (at[:, k] < knot) == before
                a, b = np.where(same, middle, a), np.where(same, b, middle)
            found.append((a + b) / 2)
    every = np.unique(np.concatenate(found))
    kept = np.diff(every, prepend=-1.0) > 1e-7
    kept[-1] = True
    return np.append(every[kept][:-1], 1.0)


def _beyond_seam(surface: Nurbs, path: Nurbs, near: float) -> list[Nurbs]:
    """The path on the other side of a seam on which a path is."""
    found = []
    for k in (0, 1):
        for side in (0.0, 1.0):
            if np.abs(path.points[:, k] - side).max() > _STEP:
                continue
            path.points[:, k] = side
            points = path.points.copy()
            points[:, k] = 1 - side
            t = np.linspace(0, 1, 17)
            other = replace(path, points=points)
            one, two = (surface(*at(t)[:, :2].T) for at in (path, other))
            if np.abs(one - two).max() <= near:
                found.append(other)
    return found


def _feet(surface: Nurbs, points: Floats) -> Floats:
    """The parameters of points on a surface, by the method of Gauss and Newton."""
    grid = np.linspace(0, 1, _STARTS)
    u, v = (g.ravel() for g in np.meshgrid(grid, grid, indexing="ij"))
    known = surface(u, v)
    k = np.linalg.norm(known[:, None] - points[None], axis=-1).argmin(axis=0)
    at = _nearest(surface, points, np.column_stack([u[k], v[k]]))
    for axis in (0, 1):
        # The nearest of the first places may be beyond a seam.
        start = at.copy()
        start[:, axis] = np.where(at[:, axis] < 0.5, 1.0, 0.0)
        border = np.abs(at[:, axis] - 0.5) > 0.45
        other = _nearest(surface, points[border], start[border])
        better = _away(surface, points[border], other) < 0.1 * _away(
            surface, points[border], at[border]
        )
        at[np.flatnonzero(border)[better]] = other[better]
    # From the middle, which is on no seam, without a jump to its other side.
    middle = len(at) // 2
    for order in (range(middle + 1, len(at)), range(middle - 1, -1, -1)):
        before = at[middle]
        for n in order:
            for k in (0, 1):
                if abs(at[n, k] - before[k]) > 0.5:
                    at[n, k] = round(before[k])
            before = at[n]
    return at


def _away(surface: Nurbs, points: Floats, at: Floats) -> Floats:
    return np.asarray(np.linalg.norm(surface(at[:, 0], at[:, 1]) - points, axis=1) + 1e-13)


def _nearest(surface: Nurbs, points: Floats, at: Floats, rounds: int = _ROUNDS) -> Floats:
    for _ in range(rounds if len(points) else 0):
        inward = np.where(at + _STEP > 1, -_STEP, _STEP)
        here = surface(at[:, 0], at[:, 1])
        along_u = (surface(at[:, 0] + inward[:, 0], at[:, 1]) - here) / inward[:, :1]
        along_v = (surface(at[:, 0], at[:, 1] + inward[:, 1]) - here) / inward[:, 1:]
        away = points - here
        uu, uv, vv = ((a * b).sum(axis=1) for a, b in (
            (along_u, along_u), (along_u, along_v), (along_v, along_v),
        ))  # fmt: skip
        # At a pole one of the directions has no length.
        uu, vv = uu + _LEAST * vv, vv + _LEAST * uu
        to_u, to_v = (along_u * away).sum(axis=1), (along_v * away).sum(axis=1)
        both = np.column_stack([vv * to_u - uv * to_v, uu * to_v - uv * to_u])
        step = both / (uu * vv - uv * uv)[:, None]
        at = np.clip(at + np.clip(step, -0.1, 0.1), 0, 1)
    return at


def _joined(parts: list[Floats], uv: Floats) -> Nurbs:
    """Cubics through points at parameters, one after the other."""
    knots, points = [np.zeros(1)], [uv[:1]]
    first = 0
    for t in parts:
        end = first + len(t)
        knots += [np.full(3, t[0]), t[2:-2]]
        points.append(_control(t, uv[first:end])[1:])
        first = end - 1
    knots.append(np.ones(4))
    flat = np.concatenate(points)
    flat = np.column_stack([flat, np.zeros(len(flat))])
    return Nurbs((3,), (np.concatenate(knots),), flat, None)


def _control(t: Floats, uv: Floats) -> Floats:
    """The control points of a cubic without knots at the second and the last but one parameter."""
    unit = (t - t[0]) / (t[-1] - t[0])
    knots = np.concatenate([[0.0] * 4, unit[2:-2], [1.0] * 4])
    count = len(t)
    basis = np.zeros((count, count))
    for k in range(0, count, 3):
        # Three functions at a time, as coordinates of a curve.
        one = np.zeros((count, 3))
        width = min(3, count - k)
        one[range(k, k + width), range(width)] = 1.0
        basis[:, k : k + width] = Nurbs((3,), (knots,), one, None)(unit)[:, :width]
    points: Floats = np.asarray(np.linalg.solve(basis, uv))
    points[[0, -1]] = uv[[0, -1]]
    return points
