"""Snapping of the pointer on the drawing board."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from moldloft import _core

__all__ = ["Axes", "snapped"]

#: Sine of the angle below which two directions have no crossing worth the name.
_PARALLEL = 0.1
#: Sine of the angle below which a line is along an axis.
_ALONG = 0.02
#: Part of a line's length around its middle that is the middle.
_MIDDLE = 0.04

Place = tuple[float, float]


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
    axes: Axes,
    at: Place,
    reach: float,
    start: Place | None,
    woken: Sequence[int],
) -> dict[str, Any]:
    """The snap for a pointer position: the nearest of the strongest kind within reach.

    In this order: a point; the crossing of a direction through the start with one through another
    point, or of two through activated points; the middle of a line; a line; a direction through the
    start or an activated point. Directions are the axes, the lines that end at an activated point,
    through that point as extensions, and through the start as parallels.

    Returns
    -------
    dict
        ``at``, ``why`` (``"point"``, ``"cross"``, ``"mid"``, ``"line"``, ``"axis"``,
        ``"extension"``, ``"parallel"``), the ``point`` or ``line`` with the ``part`` of its length,
        ``axes`` (a line by its number) and the points ``of`` them.
    """
    found = session.snap(name, [at[0], at[1]], reach)
    if found is not None and found[1] is not None and found[3] is None:
        return {"at": list(found[0]), "why": "point", "point": found[1]}
    places, lines = _drawn(session, name)
    directions = {letter: _unit(d) for letter, d in axes.units.items()}
    rays = [
        ray
        for point, through in places.items()
        for ray in _rays(point, through, directions, at)
        if ray.off <= reach
    ]
    ways = _lines_at(places, lines, directions, woken)
    strong = [r for r in _rays(0, start, directions, at) if r.off <= reach] if start else []
    lively = [r for r in rays if r.point in woken]
    for point, directed in ways.items():
        lively += [
            r for r in _rays(point, places[point], directed, at, "extension") if r.off <= reach
        ]
        if start:
            strong += [r for r in _rays(0, start, directed, at, "parallel") if r.off <= reach]
    crossings = []
    for one in [*strong, *lively]:
        for two in rays if one in strong else lively:
            place = _crossing(one, two)
            if place is None or (start is not None and math.dist(place, start) <= reach):
                continue
            crossings.append((math.dist(place, at), place, one, two))
    crossings = [c for c in crossings if c[0] <= reach]
    if crossings:
        _, place, one, two = min(crossings, key=lambda c: c[0])
        of = [k for k in (one.point, two.point) if k]
        return {"at": list(place), "why": "cross", "axes": [one.axis, two.axis], "of": of}
    if found is not None and found[2] is not None:
        line, part = found[2]
        if abs(part - 0.5) <= _MIDDLE:
            p, q = lines[line]
            middle = [(a + b) / 2 for a, b in zip(places[p], places[q], strict=True)]
            return {"at": middle, "why": "mid", "line": line, "part": 0.5}
        if 0.0 < part < 1.0:
            return {"at": list(found[0]), "why": "line", "line": line, "part": part}
    for ray in sorted([*strong, *lively], key=lambda r: r.off):
        (u, v), (c, s) = ray.through, ray.along
        along = (at[0] - u) * c + (at[1] - v) * s
        if abs(along) > reach:
            of = [ray.point] if ray.point else []
            foot = [u + c * along, v + s * along]
            return {"at": foot, "why": ray.why, "axes": [ray.axis], "of": of}
    return {}


class _Ray(NamedTuple):
    """A direction through a point of the drawing, or through the start (0), near the pointer."""

    off: float
    axis: str
    point: int
    through: Place
    along: Place
    why: str


def _drawn(
    session: _core.SketchSession, name: str
) -> tuple[dict[int, Place], dict[int, tuple[int, int]]]:
    """The points of an object on the page, and the ends of its lines."""
    found = json.loads(session.objects_json())["objects"]
    data = next(o for o in found if o["name"] == name)
    places = {p["id"]: (p["page"][0], p["page"][1]) for p in data["points"] if p["page"]}
    ends = {ln["id"]: (ln["points"][0], ln["points"][1]) for ln in data["lines"]}
    return places, {k: e for k, e in ends.items() if set(e) <= set(places)}


def _lines_at(
    places: dict[int, Place],
    lines: dict[int, tuple[int, int]],
    axes: dict[str, Place],
    woken: Sequence[int],
) -> dict[int, dict[str, Place]]:
    """For each woken point the directions of the lines that end there, but for those along axes."""
    found: dict[int, dict[str, Place]] = {p: {} for p in woken if p in places}
    for line, ends in lines.items():
        (a, b), (c, d) = places[ends[0]], places[ends[1]]
        way = _unit((c - a, d - b))
        if any(abs(way[0] * e[1] - way[1] * e[0]) < _ALONG for e in axes.values()):
            continue
        for end in ends:
            if end in found:
                found[end][f"line {line}"] = way
    return found


def _rays(
    point: int, through: Place, directions: dict[str, Place], at: Place, why: str = "axis"
) -> list[_Ray]:
    off = (at[0] - through[0], at[1] - through[1])
    return [
        _Ray(abs(off[0] * d[1] - off[1] * d[0]), axis, point, through, d, why)
        for axis, d in directions.items()
    ]


def _crossing(one: _Ray, two: _Ray) -> Place | None:
    (p, d), (q, e) = (one.through, one.along), (two.through, two.along)
    sine = d[0] * e[1] - d[1] * e[0]
    if abs(sine) < _PARALLEL:
        return None
    t = ((q[0] - p[0]) * e[1] - (q[1] - p[1]) * e[0]) / sine
    return (p[0] + t * d[0], p[1] + t * d[1])


def _unit(d: Sequence[float]) -> Place:
    size = math.hypot(*d) or 1.0
    return (d[0] / size, d[1] / size)
