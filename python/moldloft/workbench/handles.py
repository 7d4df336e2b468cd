"""What a hand takes hold of in the picture of the solid: plane faces, and numbers as arrows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moldloft import _core
from moldloft.errors import Error
from moldloft.workbench.statements import Statement

__all__ = ["drawn_handles", "faces", "made_handles", "section_place"]

_AXES = "XYZ"
#: Arrows of a picture; beyond, they cover it.
_MOST = 24
#: Relative difference of velocities of vertices that move as one.
_ALIKE = 1e-6


def faces(session: _core.SketchSession, name: str) -> dict[str, Any]:
    """The mesh of a body with the face of each facet.

    Returns
    -------
    dict
        ``vertices`` and ``quads``; ``of``, the face of each; ``names``, for each plane face its
        name in commands and the plane of a section on it.
    """
    vertices, facets, own, named = session.faces(name)
    return {
        "vertices": vertices.ravel().tolist(),
        "quads": facets.ravel().tolist(),
        "of": own,
        "names": [None if face is None else list(face) for face in named],
    }


def section_place(
    session: _core.SketchSession, name: str, units: Mapping[str, Sequence[float]]
) -> dict[str, Any] | None:
    """The face on which a section is drawn; None for others, and while there is no such face.

    Returns
    -------
    dict
        ``body`` and ``face``; ``columns``, the images of the unit vectors and of the origin;
        ``outward``, 1 if a positive extrusion is outside the body; the ``vertices`` and ``quads``
        of the body; ``border``, the border of the face on the page.
    """
    found = session.section_place(name)
    if found is None:
        return None
    (body, face), columns, outward, (vertices, facets), own = found
    image = np.array(columns)
    turn = image[:3]
    local = (vertices - image[3]) @ turn.T / (turn**2).sum(1)
    page = local[:, [_AXES.index(a) for a in units]] @ np.array(list(units.values()))
    return {
        "body": body,
        "face": face,
        "columns": columns,
        "outward": outward,
        "vertices": vertices.ravel().tolist(),
        "quads": facets.ravel().tolist(),
        "border": [
            [np.round(page[a], 6).tolist(), np.round(page[b], 6).tolist()]
            for a, b in _border(facets[own])
        ],
    }


def _border(facets: NDArray[np.uint32]) -> list[tuple[int, int]]:
    """The sides of one facet only."""
    sides: dict[frozenset[int], tuple[int, int]] = {}
    for facet in facets.tolist():
        for a, b in zip(facet, facet[1:] + facet[:1], strict=True):
            if a == b:
                continue
            key = frozenset((a, b))
            if sides.pop(key, None) is None:
                sides[key] = (a, b)
    return list(sides.values())


def drawn_handles(
    own: Sequence[Statement],
    data: dict[str, Any],
    section: str | None,
    planes: Sequence[Sequence[Any]],
    places: Mapping[int, Sequence[float]],
    marks: Sequence[dict[str, Any]],
) -> list[dict[str, Any]]:
    """Arrows at the planes that dimensions place, and at the reference point.

    Parameters
    ----------
    own
        The statements of the object.
    data
        Its data, with its dimensions.
    section
        The axes of a cross section; None for a solid.
    planes
        Axis, points and coordinate of each plane.
    places
        The points in space.
    marks
        Its dimensions; those without ``p`` and ``q`` are given.

    Returns
    -------
    list of dict
        Each with ``name``, ``value``, place ``at`` and velocity ``along`` of the arrow, and
        ``kind``: ``next`` for a missing dimension (``axis``, ``p``, ``q``), ``value`` for a given
        one, ``place`` for a coordinate of the reference ``point`` (``axis``, all coordinates
        ``now``).
    """
    out: list[dict[str, Any]] = []
    measures = {d["name"]: d["measures"].split() for d in data["dimensions"]}

    planes_of = {(axis, p): tuple(own) for axis, own, _ in reversed(planes) for p in own}

    @cache
    def mean(points: tuple[int, ...]) -> list[float] | None:
        at = [places[m] for m in points if m in places]
        return np.mean(at, axis=0).tolist() if at and np.isfinite(at).all() else None

    def middle(axis: str, point: int) -> list[float] | None:
        return mean(planes_of.get((axis, point), (point,)))

    for mark in marks:
        if len(out) == _MOST:
            return out
        words = measures.get(mark["name"], [])
        if mark["reference"] or not mark["value"]:
            continue
        if "q" in mark:
            axis, q = mark["axis"], mark["q"]
        elif len(words) == 4 and words[0] in _AXES:
            axis, q = words[0], int(words[3])
        else:
            continue
        at = middle(axis, q)
        if at is None:
            continue
        along = [float(a == axis) for a in _AXES]
        kind = "next" if "q" in mark else "value"
        more = {k: mark[k] for k in ("axis", "p", "q") if kind == "next"}
        out.append(
            {"kind": kind, "name": mark["name"], "value": mark["value"], "at": at, "along": along}
            | more
        )
    point = min((p["id"] for p in data["points"] if p["page"] is not None), default=None)
    for s in own:
        if s.verb == "REFERENCE" or (s.verb == "GIVE" and s.word(1) == "REFERENCE"):
            word = s.word(1 if s.verb == "REFERENCE" else 2)
            point = int(word) if word.isdigit() else None
    now = places.get(point) if point is not None else None
    if point is not None and now is not None and np.isfinite(now).all():
        out += [
            {
                "kind": "place", "name": f"point {point} {axis}", "point": point, "axis": axis,
                "value": float(now[k]), "now": [float(x) for x in now], "at": list(now),
                "along": [float(a == axis) for a in _AXES],
            }
            for k, axis in enumerate(_AXES)
            if section is None or axis in section
        ]  # fmt: skip
    return out[:_MOST]


def made_handles(session: _core.SketchSession, name: str) -> list[dict[str, Any]]:
    """Arrows at the vertices that a number of a body moves as one, as :func:`drawn_handles`."""
    rows = [(n, value) for n, value, *_ in session.numbers(name) if value]
    if not rows:
        return []
    try:
        *_, motions, _ = session.gradient(name, [n for n, _ in rows])
    except Error:
        return []
    _, places = session.points(name)
    out: list[dict[str, Any]] = []
    for (number, value), motion in zip(rows, motions, strict=True):
        speed = np.linalg.norm(motion, axis=1)
        moving = speed > _ALIKE * max(1.0, float(np.nanmax(speed, initial=0)))
        if len(places) != len(motion) or not moving.any() or not np.isfinite(motion).all():
            continue
        along = motion[moving].mean(0)
        if np.abs(motion[moving] - along).max() > _ALIKE * np.linalg.norm(along):
            continue
        out.append({
            "kind": "value", "name": number, "value": value,
            "at": places[moving].mean(0).tolist(), "along": along.tolist(),
        })  # fmt: skip
    return out[:_MOST]
