"""Reparametrisation of common sides of two faces with different parametrisations.

A program may write the circle between two faces as splines of two parametrisations. A join compares
its sides at equal parameters: the path of one side in its surface's parameters is fitted again with
the parametrisation of the other. It stays on the old path.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from moldloft.cad.occt import ImportedFace, border, is_whole
from moldloft.nurbs import Nurbs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["align"]

_NEAR = 1e-7
"""Distance at equal parameters, relative to the length, below which two sides have the same
parametrisation.
"""

_PARTED = 1e-4
"""Distance of two curves, relative to their length, above which they are distinct."""

_AS_NEAR = 1.1
"""Distance of a fitted path from the other curve, relative to the distance of the two curves."""

_PLACES = 1025
_STEPS = 14
"""Steps towards a point of the other curve: Newton's, within the known bounds."""

_PARTS = (1, 2, 4, 8, 16, 32)
_DEGREE = 7
"""The degree of the fitted path."""

_NODES = (1 - np.cos(np.pi * np.arange(_DEGREE + 1) / _DEGREE)) / 2
_BEZIER = np.linalg.inv(
    np.stack(
        [
            math.comb(_DEGREE, k) * _NODES**k * (1 - _NODES) ** (_DEGREE - k)
            for k in range(_DEGREE + 1)
        ],
        axis=1,
    )
)
"""Control points of the polynomial through points at the nodes."""


def align(faces: list[ImportedFace]) -> None:
    """Gives the two sides along each shared edge the same parametrisation, if they are one curve.

    Parameters
    ----------
    faces
        The faces; paths of their sides are replaced.
    """
    shared: dict[int, list[tuple[ImportedFace, int, int]]] = {}
    for face in faces:
        for c, cycle in enumerate(face.loops):
            for k, (number, _, _) in enumerate(cycle):
                shared.setdefault(number, []).append((face, c, k))
    for sides in shared.values():
        if len(sides) == 2 and sides[0][0] is not sides[1][0]:
            _pair(*sides)


def _pair(one: tuple[ImportedFace, int, int], other: tuple[ImportedFace, int, int]) -> None:
    first, second = _curve(*one), _curve(*other)
    if first is None or second is None:
        return
    t = np.linspace(0, 1, 65)
    places, theirs = first(t), second(t)
    length = float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum())

    def gap(p: Floats, q: Floats) -> float:
        return float(np.linalg.norm(p - q, axis=1).max())

    turned = gap(places, theirs[::-1]) < gap(places, theirs)
    if length == 0 or min(gap(places, theirs), gap(places, theirs[::-1])) <= _NEAR * length:
        return
    # A whole surface keeps its edges where it can.
    if other[0].natural and not one[0].natural:
        one, other, first, second = other, one, second, first
    face, c, k = other
    if face.natural:
        numbers = [n for cycle in face.loops for n, _, _ in cycle]
        if len({*numbers}) < len(numbers) or len(numbers) != 4:
            return
        face.natural = False
        again = _curve(*other)
        if again is None:
            return
        second, turned = again, gap(first(t), again(t)[::-1]) < gap(first(t), again(t))

    def wanted(s: Floats) -> Floats:
        return first(1 - s) if turned else first(s)

    number, backwards, trace = face.loops[c][k]
    own = _reversed(trace) if backwards else trace
    made = _rerun(own, face.surface, wanted, length)
    if made is not None:
        face.loops[c][k] = (number, backwards, _reversed(made) if backwards else made)


def _curve(face: ImportedFace, c: int, k: int) -> Callable[[Floats], Floats] | None:
    """The side in space, with the parameter that it has in the program."""
    _, backwards, trace = face.loops[c][k]
    if face.natural:
        if not is_whole(trace):
            return None
        edge = border(trace)
        held = float(edge[1])

        def along(t: Floats) -> Floats:
            still = np.full(len(t), held)
            return face.surface(still, t) if edge[0] == "u" else face.surface(t, still)

        return along
    own = _reversed(trace) if backwards else trace
    return lambda t: _on(face.surface, own(t))


def _on(surface: Nurbs, uv: Floats) -> Floats:
    u, v, _ = np.clip(uv, 0, 1).T
    return surface(u, v)


def _reversed(trace: Nurbs) -> Nurbs:
    weights = None if trace.weights is None else trace.weights[::-1]
    return Nurbs(trace.degrees, (1 - trace.knots[0][::-1],), trace.points[::-1], weights)


def _rerun(
    own: Nurbs, surface: Nurbs, wanted: Callable[[Floats], Floats], length: float
) -> Nurbs | None:
    """The path with the parameters of another curve; ``None`` if that is a distinct curve."""
    fine = np.linspace(0, 1, _PLACES)
    known = _on(surface, own(fine))

    def parameters(t: Floats) -> Floats:
        """Parameters at which the path is nearest to points of the other curve."""
        goals = wanted(t)
        nearest = np.array([int(np.argmin(((known - p) ** 2).sum(axis=1))) for p in goals])
        low, high = fine[np.maximum(nearest - 1, 0)], fine[np.minimum(nearest + 1, _PLACES - 1)]
        found: Floats = fine[nearest]
        step = 1e-6
        for _ in range(_STEPS):
            a, b = np.clip(found - step, 0, 1), np.clip(found + step, 0, 1)
            p, q = np.split(_on(surface, own(np.concatenate([a, b]))), 2)
            along = q - p
            ahead = ((goals - (p + q) / 2) * along).sum(axis=1)
            low, high = np.where(ahead > 0, found, low), np.where(ahead > 0, high, found)
            speed = (along * along).sum(axis=1) / (b - a)
            moved = (a + b) / 2 + ahead / np.where(speed > 0, speed, 1)
            inside = (speed > 0) & (moved >= low) & (moved <= high)
            found = np.where(inside, moved, (low + high) / 2)
        return found

    # Both may change their pace at their knots.
    inner = np.unique(own.knots[0])[1:-1]
    breaks = np.array([0.0, 1.0])
    if len(inner):
        t = np.linspace(0, 1, 257)
        s = np.maximum.accumulate(parameters(t))
        breaks = np.unique(np.concatenate([[0, 1], np.interp(inner, s, t)]))
        breaks = breaks[np.concatenate([[True], np.diff(breaks) > 1e-6])]
        breaks[-1] = 1
    probe = np.linspace(0, 1, 129)
    there = wanted(probe)
    # The two curves are as far apart as the tolerance of the program that made them.
    floor = float(np.linalg.norm(_on(surface, own(parameters(probe))) - there, axis=1).max())
    if floor > _PARTED * length:
        return None
    near = max(_NEAR * length, _AS_NEAR * floor)
    for parts in _PARTS:
        ends = np.concatenate(
            [np.linspace(a, b, parts, endpoint=False) for a, b in pairwise(breaks)] + [[1.0]]
        )
        n = _DEGREE
        t = np.append((ends[:-1, None] + np.diff(ends)[:, None] * _NODES[:n]).ravel(), 1.0)
        s = parameters(t)
        s[0], s[-1] = 0, 1
        if np.any(np.diff(s) <= 0):
            return None
        through = own(s)
        spans = [through[n * i : n * i + n + 1] for i in range(len(ends) - 1)]
        points = np.concatenate([(_BEZIER @ span)[:n] for span in spans] + [through[-1:]])
        points[::n] = through[::n]
        knots = np.concatenate([[0.0], np.repeat(ends, n), [1.0]])
        made = Nurbs((n,), (knots,), points, None)
        apart = float(np.linalg.norm(_on(surface, made(probe)) - there, axis=1).max())
        if apart <= near:
            return made
    return made if apart <= _PARTED * length else None
