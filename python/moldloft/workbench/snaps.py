"""Snapping of the pointer on the drawing board."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from moldloft import _core
from moldloft.shapes.sketch_values import SketchSnap

__all__ = ["Axes", "snapped"]


@dataclass(frozen=True)
class Axes:
    """Directions of the axes on the page.

    Attributes
    ----------
    letters
        The axes of the drawing.
    angles
        Direction of each, counter-clockwise from the right, degrees.
    scale
        Of each.
    """

    letters: str
    angles: list[float]
    scale: list[float]

    @property
    def units(self) -> dict[str, list[float]]:
        """The image of a unit along each axis on the page."""
        found = {}
        for letter, angle, scale in zip(self.letters, self.angles, self.scale, strict=False):
            a = math.radians(angle)
            found[letter] = [round(scale * math.cos(a), 12), round(scale * math.sin(a), 12)]
        return found


def snapped(
    session: _core.SketchSession,
    name: str,
    at: tuple[float, float],
    reach: float,
    start: tuple[float, float] | None,
    woken: Sequence[int],
) -> dict[str, Any]:
    """The first of the snaps of a pointer position, without axes through points not woken.

    Returns
    -------
    dict
        ``at``, ``why`` (the kind of :class:`~moldloft.shapes.sketch_values.SketchSnap`), the
        ``point`` or ``line`` with the ``part`` of its length, ``axes`` (a line by its number) and
        the points ``of`` them.
    """
    begin = None if start is None else list(start)
    for row in session.snaps(name, list(at), reach, begin, list(woken)):
        snap = SketchSnap.from_row(row)
        if snap.kind == "axis" and not set(snap.of) <= set(woken):
            continue
        out: dict[str, Any] = {"at": list(snap.at), "why": snap.kind}
        if snap.point is not None:
            out["point"] = snap.point
        if snap.line is not None:
            out |= {"line": snap.line, "part": snap.part}
        if snap.directions:
            out |= {"axes": list(snap.directions), "of": list(snap.of)}
        return out
    return {}
