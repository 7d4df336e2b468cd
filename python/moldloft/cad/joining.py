"""Common edges of faces of a CAD file as joins of the surfaces."""

from __future__ import annotations

import math

import numpy as np

from moldloft import _core
from moldloft.cad.faces import Imported

__all__ = ["joins"]

_ROUNDING = 1e-9
"""Least tolerance of a join, relative to the model's size."""


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
    nets = [face.surface.points.reshape(-1, 3) for face in found.faces]
    size = float(np.ptp(np.concatenate(nets), axis=0).max()) if nets else 0.0
    names = [face.name for face in found.faces]
    contacts, poles, alone = _core.common_sides(
        [face._data() for face in found.faces], _ROUNDING * size
    )
    lines: list[str] = []
    count = 0

    def joined(first: str, second: str, gap: float) -> None:
        nonlocal count
        count += 1
        name = f"join{count}"
        while name in taken:
            name += "_"
        if name not in left_out:
            tolerance = _rounded_up(max(2 * gap, _ROUNDING * size))
            lines.append(f"Join {name}({first}, {second}, tolerance = {tolerance});")

    for kind, faces, sides, gap in contacts:
        if kind in ("joined", "tolerated"):
            first, second = (names[f] + side for f, side in zip(faces, sides, strict=True))
            joined(first, second, gap)
    for (one, side), (other, twin) in poles:
        joined(names[one] + side, names[other] + twin, 0.0)
    _say(found, contacts, [names[f] for f in alone])
    return lines


def _say(
    found: Imported, contacts: list[tuple[str, list[int], list[str], float]], alone: list[str]
) -> None:
    """Remarks on edges that are left open, and on those that only their tolerance joins."""

    def of(wanted: str) -> list[tuple[list[int], float]]:
        return [(faces, gap) for kind, faces, _, gap in contacts if kind == wanted]

    def faces(of_all: list[str]) -> str:
        return ", ".join(dict.fromkeys(of_all))

    if alone:
        found.remarks.append(
            f"trimmed faces with a degenerate edge stay open at it: {faces(alone)}"
        )
    if tolerated := of("tolerated"):
        widest = max(tolerated, key=lambda contact: contact[1])
        one, other = (found.faces[f].name for f in widest[0])
        found.remarks.append(
            f"{len(tolerated)} shared edges are joined within their tolerances: their faces are "
            f"up to {widest[1]:.3g} apart along them (`{one}`, `{other}`); panels have the "
            "vertices of the first"
        )
    if lost := of("part"):
        found.remarks.append(
            f"{len(lost)} shared edges are not joined: they are parts of edges of their surfaces"
        )
    if seams := of("seam"):
        named = [found.faces[face].name for (face,), _ in seams]
        found.remarks.append(f"trimmed faces that meet themselves are open there: {faces(named)}")
    if left := of("apart"):
        widest = max(left, key=lambda contact: contact[1])
        one, other = (found.faces[f].name for f in widest[0])
        found.remarks.append(
            f"{len(left)} shared edges are not joined: their faces run along them differently, or "
            f"are up to {widest[1]:.3g} apart (`{one}`, `{other}`)"
        )


def _rounded_up(x: float) -> str:
    """A number of two digits that is not smaller."""
    exponent = math.floor(math.log10(x)) - 1
    return f"{math.ceil(x / 10.0**exponent)}e{exponent}"
