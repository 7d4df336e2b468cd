"""DXF drawings, by ezdxf: curves as exact NURBS named after their layers."""

from __future__ import annotations

import io
import math
from collections import Counter
from collections.abc import Iterator
from importlib import import_module
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.budget import limits
from moldloft.cad import identifier, needed
from moldloft.errors import FileError
from moldloft.overlays.overlay import Overlay
from moldloft.overlays.pieces import arc, joined, line
from moldloft.shapes.nurbs import Nurbs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["parse"]

_METRES = {
    1: 0.0254, 2: 0.3048, 3: 1609.344, 4: 0.001, 5: 0.01, 6: 1.0, 7: 1000.0,
    8: 2.54e-8, 9: 2.54e-5, 10: 0.9144, 13: 1e-6, 14: 0.1, 15: 10.0, 16: 100.0,
}  # fmt: skip
"""Units of $INSUNITS in metres (Autodesk, DXF Reference, HEADER section)."""

_MOST_ANGLE = 1e6
"""Angle in radians beyond which the end of an arc is inaccurate."""


def parse(name: str, data: bytes) -> tuple[Overlay, float | None]:
    """The model space of a DXF file, and its unit in metres, if stated.

    Lines, arcs, circles, ellipses, splines and polylines are curves, points are points, faces are
    faces; blocks are expanded. Other entities are counted in the remarks.

    Parameters
    ----------
    name
        The name of the file, for the overlay.
    data
        Its bytes.
    """
    ezdxf: Any = needed("ezdxf", "ezdxf", "reading DXF")
    from ezdxf import recover

    try:
        document, auditor = recover.read(io.BytesIO(data))
    except (ezdxf.DXFError, OSError, ValueError, KeyError, IndexError, TypeError) as error:
        raise FileError(f"not a DXF file that ezdxf takes, or cut short: {error}") from error
    curves: dict[str, Nurbs] = {}
    taken: set[str] = set()
    points: list[Any] = []
    faces: list[list[int]] = []
    left: Counter[str] = Counter()
    space = document.modelspace()
    _check_count(document, space)
    for entity in _entities(space, left):
        kind = entity.dxftype()
        if kind == "POINT":
            points.append(tuple(entity.dxf.location))
        elif kind == "3DFACE":
            corners = [tuple(corner) for corner in entity.wcs_vertices()]
            first = len(points)
            points += corners
            numbers = list(range(first, first + len(corners)))
            faces.append([*numbers, numbers[-1]][:4])
        else:
            try:
                curve = _curve(entity)
            except (ezdxf.DXFError, ValueError, ZeroDivisionError) as error:
                left[f"{kind} ({error})"] += 1
                continue
            if curve is None or not np.isfinite(curve.points).all():
                left[kind] += 1
                continue
            curves[identifier(f"{entity.dxf.layer}_{len(curves) + 1}", taken)] = curve
    remarks = [f"{count} entities {kind} are left out" for kind, count in left.items()]
    remarks += [str(fault.message) for fault in auditor.errors[:5]]
    unit = _METRES.get(int(document.header.get("$INSUNITS", 0)))
    at = np.array(points, dtype=np.float64).reshape(-1, 3)
    if not np.isfinite(at).all():
        raise FileError("a point is not a finite number")
    found = Overlay(
        name,
        at,
        np.array(faces, dtype=np.uint32).reshape(-1, 4),
        (("faces", 0, len(faces)),) if faces else (),
        curves,
        remarks=tuple(remarks),
    )
    return found, unit


_DEEPEST = 16
"""Blocks within blocks."""


def _check_count(document: Any, space: Any) -> None:
    """Rejects a drawing whose inserted blocks exceed the limit of entities of a model."""
    counts: dict[str, int] = {}

    def count(entities: Any, depth: int) -> int:
        found = 0
        for entity in entities:
            if entity.dxftype() != "INSERT":
                found += 1
                continue
            name = str(entity.dxf.name)
            if name not in counts:
                if depth == _DEEPEST:
                    continue
                # Until its own entities are counted.
                counts[name] = -1
                block = document.blocks.get(name)
                counts[name] = count(block, depth + 1) if block is not None else 0
            if counts[name] < 0:
                raise FileError(f"block `{name}` is inserted in itself")
            found += counts[name] * max(1, int(entity.mcount))
        return found

    found, most = count(space, 0), limits().objects
    if found > most:
        raise FileError(
            f"it holds {found} entities once its blocks are inserted, {most} are allowed\n"
            "help: allow more: `--limit objects=N`, `moldloft.limits(objects=...)`"
        )


def _entities(space: Any, left: Counter[str], depth: int = 0) -> Iterator[Any]:
    """The entities, with inserted blocks in position and polygon meshes as faces."""
    for entity in space:
        kind = entity.dxftype()
        if kind == "INSERT":
            if depth == _DEEPEST:
                left["INSERT (blocks within blocks)"] += 1
                continue
            # Blocks in rows and columns, one after the other.
            for single in entity.multi_insert() if entity.mcount > 1 else (entity,):
                yield from _entities(single.virtual_entities(), left, depth + 1)
        elif kind == "POLYLINE" and (entity.is_poly_face_mesh or entity.is_polygon_mesh):
            yield from entity.virtual_entities()
        elif kind == "MESH":
            try:
                yield from _mesh_faces(entity)
            except (AttributeError, IndexError, TypeError, ValueError) as error:
                left[f"MESH ({error})"] += 1
        else:
            yield entity


def _mesh_faces(mesh: Any) -> Iterator[Any]:
    entities: Any = import_module("ezdxf.entities")

    vertices = list(mesh.vertices)
    for face in mesh.faces:
        at = [vertices[k] for k in face]
        for k in range(1, len(at) - 1):
            yield entities.Face3d.new(
                dxfattribs={"vtx0": at[0], "vtx1": at[k], "vtx2": at[k + 1], "vtx3": at[k + 1]}
            )


def _curve(entity: Any) -> Nurbs | None:
    kind = entity.dxftype()
    if kind == "SPLINE":
        return _spline(entity)
    pieces = _pieces(entity)
    return joined(pieces) if pieces else None


def _pieces(entity: Any) -> list[Floats]:
    entities: Any = import_module("ezdxf.entities")

    kind = entity.dxftype()
    if kind == "LINE":
        return _lines([entity.dxf.start, entity.dxf.end])
    if kind in ("ARC", "CIRCLE"):
        return _ellipse(entities.Ellipse.from_arc(entity))
    if kind == "ELLIPSE":
        return _ellipse(entity)
    if kind in ("LWPOLYLINE", "POLYLINE"):
        return _chain(entity)
    return []


def _chain(polyline: Any) -> list[Floats]:
    """The sides of a polyline; its arcs are counter-clockwise and are reversed where needed."""
    light = polyline.dxftype() == "LWPOLYLINE"
    vertices = polyline.vertices_in_wcs() if light else polyline.points_in_wcs()
    at = np.array(tuple(next(iter(vertices))), dtype=np.float64)
    pieces: list[Floats] = []
    for side in polyline.virtual_entities():
        own = _pieces(side)
        if not own:
            continue
        start, end = own[0][0, :3], own[-1][-1, :3]
        if np.linalg.norm(end - at) < np.linalg.norm(start - at):
            own = [piece[::-1].copy() for piece in own[::-1]]
        pieces += own
        at = own[-1][-1, :3]
    return pieces


def _lines(at: list[Any]) -> list[Floats]:
    points = [np.array(tuple(p), dtype=np.float64) for p in at]
    return [line(a, b) for a, b in pairwise(points) if (a != b).any()]


def _ellipse(ellipse: Any) -> list[Floats]:
    tool = ellipse.construction_tool()
    start, end = float(tool.start_param), float(tool.end_param)
    if not max(abs(start), abs(end)) < _MOST_ANGLE:
        raise ValueError(f"its angles are {start:g} and {end:g} radians")
    # Arcs run counter-clockwise for a turn at most.
    span = (end - start) % (2 * math.pi)
    end = start + (span if span > 1e-12 else 2 * math.pi)
    centre, a, b = (tuple(v) for v in (tool.center, tool.major_axis, tool.minor_axis))
    return arc(centre, a, b, start, end)


def _spline(entity: Any) -> Nurbs | None:
    """A spline with its own data; ezdxf interpolates fit points."""
    spline = entity.construction_tool()
    degree = int(spline.degree)
    knots = np.array(spline.knots(), dtype=np.float64)
    points = np.array([tuple(p) for p in spline.control_points], dtype=np.float64)
    weights = np.array(list(spline.weights()) or [1.0] * len(points), dtype=np.float64)
    if len(points) <= degree or len(knots) != len(points) + degree + 1 or (weights <= 0).any():
        return None
    ends = knots[degree], knots[-degree - 1]
    if not ends[1] > ends[0] or (np.diff(knots) < 0).any():
        return None
    if (knots[: degree + 1] != ends[0]).any() or (knots[-degree - 1 :] != ends[1]).any():
        return _clamped(degree, knots, points, weights)
    plain = bool((weights == weights[0]).all())
    return Nurbs(
        (degree,), ((knots - ends[0]) / (ends[1] - ends[0]),), points, None if plain else weights
    )


def _clamped(degree: int, knots: Floats, points: Floats, weights: Floats) -> Nurbs:
    """An unclamped spline between its ends, which become knots (Boehm 1980)."""
    control = np.concatenate([points * weights[:, None], weights[:, None]], axis=1)
    low, high = knots[degree], knots[-degree - 1]
    for end in (low, high):
        while int((knots == end).sum()) < degree:
            span = int(np.searchsorted(knots, end, side="right")) - 1
            span = min(span, len(control) - 1)
            made = []
            for i in range(len(control) + 1):
                if i <= span - degree:
                    share = 1.0
                elif i > span:
                    share = 0.0
                else:
                    width = knots[i + degree] - knots[i]
                    share = (end - knots[i]) / width if width > 0 else 0.0
                after = control[min(i, len(control) - 1)]
                made.append(share * after + (1 - share) * control[max(i - 1, 0)])
            control = np.array(made)
            knots = np.insert(knots, span + 1, end)
    first = int(np.searchsorted(knots, low, side="right")) - degree
    last = int(np.searchsorted(knots, high, side="left"))
    inner = knots[first + degree : last]
    control = control[first - 1 : last]
    knots = np.concatenate([[low] * (degree + 1), inner, [high] * (degree + 1)])
    weights = control[:, 3]
    plain = bool(np.ptp(weights) <= 1e-15 * abs(weights[0]))
    points = control[:, :3] / weights[:, None]
    return Nurbs((degree,), ((knots - low) / (high - low),), points, None if plain else weights)
