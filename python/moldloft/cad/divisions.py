"""Number of panels of whole faces of CAD files, from the curvature of their surfaces."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from moldloft.cad.faces import ImportedFace, border, together

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.shapes.nurbs import Nurbs

    Floats = NDArray[np.float64]

__all__ = ["cone_volume", "divisions"]

_TURN = 0.07
"""The largest turn along a panel, in radians: that of trimmed faces."""

_LEAST, _MOST = 8, 500
"""Divisions along u or v, at least and at most."""

_PLACES, _LINES = 97, 5
"""Number of points along a line of the surface, and of lines, at which the turn is measured."""

_NODES = 10
"""Gauss nodes between two knots."""

_KINK = 0.5
"""Turn between two points, in radians, above which it is a kink."""


def divisions(faces: list[ImportedFace], finer: Mapping[str, float]) -> dict[str, tuple[int, int]]:
    """The divisions along u and v, by name, of the faces that cover a whole surface.

    Divisions along a common edge of two faces are equal.

    Parameters
    ----------
    faces
        The faces.
    finer
        Factors of the divisions of some faces.
    """
    whole = [face for face in faces if face.natural]
    edges: dict[int, list[int]] = {}
    for k, face in enumerate(whole):
        for side in face.sides:
            # An edge at one u runs along v.
            edges.setdefault(side.edge, []).append(2 * k + (border(side.trace)[:1] == "u"))
    pairs = (pair for sides in edges.values() for pair in pairwise(sides))
    group = together(2 * len(whole), pairs)
    counts = [0] * len(group)
    for k, face in enumerate(whole):
        for along in (0, 1):
            at = group[2 * k + along]
            count = math.ceil(finer.get(face.name, 1.0) * _count(face.surface, along))
            counts[at] = max(counts[at], min(count, _MOST))
    return {
        face.name: (counts[group[2 * k]], counts[group[2 * k + 1]]) for k, face in enumerate(whole)
    }


def cone_volume(surface: Nurbs) -> float:
    """The volume of the cone from the origin to a whole surface, to about 1e-7.

    Parameters
    ----------
    surface
        The surface.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    apart = nodes[:, None] - nodes[None, :] + np.eye(_NODES)
    scale = apart.prod(axis=1)
    slopes = scale[:, None] / (scale[None, :] * apart)
    np.fill_diagonal(slopes, (1 / apart).sum(axis=1) - 1)
    places, steps = [], []
    for knots in surface.knots:
        ends = np.unique(np.asarray(knots))
        ends = (ends - ends[0]) / (ends[-1] - ends[0])
        steps.append(np.diff(ends) / 2)
        places.append((ends[:-1, None] + steps[-1][:, None] * (1 + nodes)).ravel())
    u, v = np.meshgrid(*places, indexing="ij")
    points = surface(u, v).reshape(len(steps[0]), _NODES, len(steps[1]), _NODES, 3)
    # The steps of the parameters cancel out.
    along_u = np.einsum("ki,aibjx->akbjx", slopes, points)
    along_v = np.einsum("kj,aibjx->aibkx", slopes, points)
    cones = (points * np.cross(along_u, along_v)).sum(axis=-1)
    return float(np.einsum("aibj,i,j->", cones, weights, weights)) / 3


def _count(surface: Nurbs, along: int) -> int:
    """Number of equal divisions along u (0) or v (1) with turns within the limit."""
    t, held = np.meshgrid(np.linspace(0, 1, _PLACES), np.linspace(0, 1, _LINES), indexing="ij")
    points = surface(t, held) if along == 0 else surface(held, t)
    chords = np.diff(points, axis=0)
    length = np.linalg.norm(chords, axis=-1)
    size = float(length.sum(axis=0).max())
    if size == 0:
        return _LEAST
    cross = np.linalg.norm(np.cross(chords[:-1], chords[1:]), axis=-1)
    turn = np.arctan2(cross, (chords[:-1] * chords[1:]).sum(axis=-1))
    seen = (turn < _KINK) & (np.minimum(length[:-1], length[1:]) > 1e-9 * size)
    most = float(np.where(seen, turn, 0).max())
    return int(np.clip(np.ceil(most * (_PLACES - 1) / _TURN), _LEAST, _MOST))
