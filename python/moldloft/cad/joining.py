"""Common edges of faces of a CAD file as joins of the surfaces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from moldloft.cad.occt import Imported, ImportedFace, border, is_whole
from moldloft.nurbs import Nurbs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["joins"]

_PLACES = 65
"""Number of points at which two sides are compared, as in ``Join``."""

_ROUNDING = 1e-9
"""Least tolerance of a join, relative to the model's size."""

_PARTED = 1e-3
"""Distance of two sides, relative to their length, above which they are not joined."""


@dataclass
class _Side:
    """A side of a face along an edge."""

    face: str
    """The face."""
    name: str
    """Name in the program."""
    places: Floats
    """Points at equal steps of the parameter."""


def joins(found: Imported, taken: set[str], left_out: frozenset[str]) -> list[str]:
    """Statements that join faces along common edges; edges left open give a remark.

    Parameters
    ----------
    found
        Content of the file.
    taken
        The names in use.
    left_out
        Joins, by name, that are not to be made.
    """
    shared: dict[int, list[_Side | None]] = {}
    for face in found.faces:
        for c, cycle in enumerate(face.loops):
            for k, (number, _, _) in enumerate(cycle):
                shared.setdefault(number, []).append(_side(face, c, k))
    lost = [sides for sides in shared.values() if len(sides) > 1 and None in sides]
    lines: list[str] = []
    count = 0

    def joined(first: str, second: str, tolerance: str) -> None:
        nonlocal count
        count += 1
        name = f"join{count}"
        while name in taken:
            name += "_"
        if name not in left_out:
            lines.append(f"Join {name}({first}, {second}, tolerance = {tolerance});")

    nets = [face.surface.points.reshape(-1, 3) for face in found.faces]
    size = float(np.ptp(np.concatenate(nets), axis=0).max()) if nets else 0.0
    apart = 0.0
    left = 0
    seams: list[str] = []
    trimmed = {face.name for face in found.faces if not face.natural}
    for sides in shared.values():
        for one, other in pairwise(sides):
            if one is None or other is None:
                continue
            gap = min(_gap(one.places, other.places), _gap(one.places, other.places[::-1]))
            length = float(np.linalg.norm(np.diff(one.places, axis=0), axis=1).sum())
            if one.name == other.name or length == 0:
                continue
            if one.face == other.face and one.face in trimmed:
                seams.append(one.face)
                continue
            if gap > _PARTED * length:
                left += 1
                apart = max(apart, gap)
                continue
            joined(one.name, other.name, _rounded_up(max(2 * gap, _ROUNDING * size)))
    poles, alone = _poles(found, _ROUNDING * size)
    for first, second in poles:
        joined(first, second, _rounded_up(_ROUNDING * size))
    if alone:
        found.remarks.append(
            f"trimmed faces with a degenerate edge stay open at it: {', '.join(alone)}"
        )
    if lost:
        found.remarks.append(
            f"{len(lost)} shared edges are not joined: they are parts of edges of their surfaces"
        )
    if seams:
        found.remarks.append(
            f"trimmed faces that meet themselves are open there: {', '.join(dict.fromkeys(seams))}"
        )
    if left:
        found.remarks.append(
            f"{left} shared edges are not joined: their faces run along them differently, or are "
            f"up to {apart:.3g} apart"
        )
    return lines


def _side(face: ImportedFace, cycle: int, k: int) -> _Side | None:
    """A side as it is named in the program; None for a part of an edge of a whole surface."""
    _, backwards, trace = face.loops[cycle][k]
    t = np.linspace(0, 1, _PLACES)
    if face.natural:
        if not is_whole(trace):
            return None
        edge = border(trace)
        held = np.full(_PLACES, float(edge[1]))
        at = (held, t) if edge[0] == "u" else (t, held)
        return _Side(face.name, f"{face.name}.{edge}", face.surface(*at))
    # In the program a side ends where the next one begins.
    _, turned, following = face.loops[cycle][(k + 1) % len(face.loops[cycle])]
    points = trace.points.copy()
    points[0 if backwards else -1] = following.points[-1 if turned else 0]
    u, v, _ = Nurbs(trace.degrees, trace.knots, points, trace.weights)(
        t[::-1] if backwards else t
    ).T
    return _Side(
        face.name, f"{face.name}_s{cycle}_{k}", face.surface(np.clip(u, 0, 1), np.clip(v, 0, 1))
    )


def _poles(found: Imported, near: float) -> tuple[list[tuple[str, str]], list[str]]:
    """Sides of trimmed faces that are one point: those of two faces that meet, and other faces."""
    sides: list[_Side] = []
    for face in found.faces:
        if face.natural:
            continue
        for c, cycle in enumerate(face.loops):
            own = [_side(face, c, k) for k in range(len(cycle))]
            sides += [s for s in own if s is not None and np.ptp(s.places, axis=0).max() <= near]
    pairs: list[tuple[str, str]] = []
    alone: list[str] = []
    while sides:
        one = sides.pop()
        there = [s for s in sides if np.abs(s.places[0] - one.places[0]).max() <= near]
        if len(there) == 1 and there[0].face != one.face:
            pairs.append((there[0].name, one.name))
        else:
            alone += dict.fromkeys([one.face, *(s.face for s in there)])
        sides = [s for s in sides if all(s is not other for other in there)]
    return pairs, alone


def _gap(one: Floats, other: Floats) -> float:
    return float(np.linalg.norm(one - other, axis=1).max())


def _rounded_up(x: float) -> str:
    """A number of two digits that is not smaller."""
    exponent = math.floor(math.log10(x)) - 1
    return f"{math.ceil(x / 10.0**exponent)}e{exponent}"
