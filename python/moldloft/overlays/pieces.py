"""Chains of lines, Bezier curves and arcs as one NURBS each, exactly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from moldloft.errors import FileError
from moldloft.shapes.nurbs import Nurbs

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["arc", "bezier", "joined", "line"]


def bezier(*points: ArrayLike) -> Floats:
    """A Bezier curve of degree 1 to 3: its control points with weights of 1, ``(n, 4)``."""
    xyz = np.array(points, dtype=np.float64)
    return np.concatenate([xyz, np.ones((len(xyz), 1))], axis=1)


def line(start: ArrayLike, end: ArrayLike) -> Floats:
    """A straight piece."""
    return bezier(start, end)


def arc(centre: ArrayLike, a: ArrayLike, b: ArrayLike, start: float, end: float) -> list[Floats]:
    """Pieces of centre + a cos t + b sin t from ``start`` to ``end``, each at most a quarter turn.

    They are rational quadratics: points multiplied by weights, and weights, ``(3, 4)``.
    """
    c, a, b = (np.asarray(v, dtype=np.float64) for v in (centre, a, b))
    if not (np.isfinite([c, a, b]).all() and math.isfinite(end - start)):
        raise FileError("an arc whose centre, radii or angles are not finite numbers")
    count = max(1, math.ceil(abs(end - start) / (math.pi / 2) - 1e-9))
    half = (end - start) / count / 2
    pieces = []
    for k in range(count):
        t0 = start + 2 * half * k
        middle, t1 = t0 + half, t0 + 2 * half
        w = math.cos(half)
        ends = [c + a * math.cos(t) + b * math.sin(t) for t in (t0, t1)]
        top = c * w + a * math.cos(middle) + b * math.sin(middle)
        pieces.append(np.array([[*ends[0], 1.0], [*top, w], [*ends[1], 1.0]]))
    return pieces


def joined(pieces: Sequence[Floats]) -> Nurbs:
    """The NURBS of consecutive pieces, with the highest degree among them.

    The multiplicity of knots at joints equals the degree, which preserves corners.
    """
    degree = max(len(piece) - 1 for piece in pieces)
    raised = [_raised(piece, degree) for piece in pieces]
    for before, after in pairwise(raised):
        # Two roundings of one place.
        after[0] = before[-1]
    control = np.concatenate([raised[0][:1], *(piece[1:] for piece in raised)])
    inner = np.repeat(np.arange(1, len(pieces)) / len(pieces), degree)
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    weights = control[:, 3].copy()
    points = control[:, :3] / weights[:, None]
    return Nurbs((degree,), (knots,), points, None if (weights == 1).all() else weights)


def _raised(piece: Floats, degree: int) -> Floats:
    """The same piece with a higher degree (Farin 2002, section 6.1)."""
    while len(piece) <= degree:
        n = len(piece)
        share = np.arange(n + 1)[:, None] / n
        before = np.concatenate([piece[:1], piece])
        after = np.concatenate([piece, piece[-1:]])
        piece = share * before + (1 - share) * after
    return np.array(piece)
