"""B-reps of Rhino as bytes: rhino3dm has no function that joins faces or trims surfaces.

The layout is that of openNURBS (McNeel), classes `ON_Brep`, `ON_NurbsCurve` and `ON_NurbsSurface`:
chunks of a code, a length, content and, for codes with a certain bit, a checksum of what is not in
inner chunks. rhino3dm decodes them and validates the result.
"""

from __future__ import annotations

import base64
import itertools
import struct
import zlib
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.cad.tracing import traced
from moldloft.errors import FormatError
from moldloft.shapes.nurbs import Nurbs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.cad.boundary import Boundary, Face

    Floats = NDArray[np.float64]

__all__ = ["brep"]

_ANONYMOUS, _CLASS, _UUID, _DATA, _END = 0x40008000, 0x00027FFA, 0x0002FFFB, 0x0002FFFC, 0x80027FFF
_CHECKED = 0x8000

_KINDS = {
    "curve": "ddd4d74e47e9d311bfe50010830122f0",
    "surface": "ded4d74e47e9d311bfe50010830122f0",
    "brep": "c5dbb56060e6d311bfe40010830122f0",
}
"""Identifiers of classes."""

_BOUNDARY, _MATED, _SEAM, _SINGULAR = 1, 2, 3, 4
"""Types of trims: of an edge with one face, with two, with one face twice, of a pole."""

_NOT, _X, _Y, _W, _S, _E, _N = range(7)
"""A trim across the parameters, along v or u, and on the sides u = 0, v = 0, u = 1, v = 1."""

_MARGIN = 0.05
"""Space around a plane face in its surface, relative to its size."""

_ON_SIDE = 1e-9
"""Distance in the parameters within which a trim is on a side."""


_ON_END = 1e-6
"""Distance in the parameters within which the end of a trim is the start of the next one."""

_ENDS = np.array([0.0, 0.0, 1.0, 1.0])
"""Knots of a line."""


class _Chunk(bytes):
    """A chunk within another one."""


def _chunk(code: int, *pieces: bytes) -> _Chunk:
    body = b"".join(pieces)
    if code & _CHECKED:
        own = b"".join(piece for piece in pieces if not isinstance(piece, _Chunk))
        body += struct.pack("<I", zlib.crc32(own))
    return _Chunk(struct.pack("<IQ", code, len(body)) + body)


def _object(kind: str, *pieces: bytes) -> _Chunk:
    return _chunk(
        _CLASS,
        _chunk(_UUID, bytes.fromhex(_KINDS[kind])),
        _chunk(_DATA, *pieces),
        _Chunk(struct.pack("<IQ", _END, 0)),
    )


def _ints(*values: int) -> bytes:
    return struct.pack(f"<{len(values)}i", *values)


def _doubles(values: Any) -> bytes:
    return np.ascontiguousarray(values, dtype="<f8").tobytes()


def _listed(values: Iterable[int]) -> bytes:
    held = list(values)
    return _ints(len(held), *held)


def _array(items: list[bytes], tail: bytes = b"", minor: int = 0) -> _Chunk:
    """An array of records."""
    return _chunk(_ANONYMOUS, bytes([16 + minor]), _ints(len(items)), *items, tail)


def _objects(items: list[_Chunk]) -> _Chunk:
    """An array of curves or surfaces."""
    pieces: list[bytes] = [bytes([16]), _ints(len(items))]
    for item in items:
        pieces += [_ints(1), item]
    return _chunk(_ANONYMOUS, *pieces)


_NO_BOX = _doubles([1, 0, 0, -1, 0, 0])


def _homogeneous(shape: Nurbs, dimension: int) -> tuple[int, Floats]:
    """The rational flag and the control points as they are stored."""
    points = shape.points[..., :dimension]
    if shape.weights is None:
        return 0, points
    weights = shape.weights[..., None]
    return 1, np.concatenate([points * weights, weights], axis=-1)


def _curve(curve: Nurbs, dimension: int) -> _Chunk:
    rational, points = _homogeneous(curve, dimension)
    # The first and the last knot are not stored.
    knots = curve.knots[0][1:-1]
    count = len(points)
    head = _ints(dimension, rational, curve.degrees[0] + 1, count, 0, 0)
    return _object(
        "curve",
        bytes([16]) + head + _NO_BOX + _ints(len(knots)) + _doubles(knots) + _ints(count)
        + _doubles(points),
    )  # fmt: skip


def _surface(surface: Nurbs) -> _Chunk:
    rational, points = _homogeneous(surface, 3)
    u, v = (knots[1:-1] for knots in surface.knots)
    nu, nv = points.shape[:2]
    head = _ints(3, rational, *(degree + 1 for degree in surface.degrees), nu, nv, 0, 0)
    knots = _ints(len(u)) + _doubles(u) + _ints(len(v)) + _doubles(v)
    net = _ints(nu * nv) + _doubles(points)
    return _object("surface", bytes([16]) + head + _NO_BOX + knots + net)


class _Trim:
    """A side of a loop as a curve in the parameters, in the direction of the loop."""

    def __init__(self, path: Nurbs, edge: int, against: bool, ends: tuple[int, int]) -> None:
        self.path = path
        self.edge = edge
        self.against = against
        self.ends = ends
        self.loop = -1
        self.type = _SINGULAR if edge < 0 else _BOUNDARY
        self.side = _side_of(path)


def _side_of(path: Nurbs) -> int:
    points = path.points
    for k, (low, high, along) in enumerate(((_W, _E, _X), (_S, _N, _Y))):
        at = points[:, k]
        if np.abs(at).max() <= _ON_SIDE:
            return low
        if np.abs(at - 1).max() <= _ON_SIDE:
            return high
        if np.ptp(at) <= _ON_SIDE:
            return along
    return _NOT


def _turned(path: Nurbs) -> Nurbs:
    weights = None if path.weights is None else path.weights[::-1]
    return Nurbs(path.degrees, (1 - path.knots[0][::-1],), path.points[::-1].copy(), weights)


def _rectangle(shape: Boundary, face: Face) -> tuple[Nurbs, Floats, Floats]:
    """A rectangle around a plane face, its corner, and the map from space to its parameters."""
    assert face.plane is not None
    origin, normal, along = face.plane
    axes = np.stack([along, np.cross(normal, along)])
    points = np.concatenate([shape.edges[s.edge].curve.points for c in face.loops for s in c])
    flat = (points - origin) @ axes.T
    low, high = flat.min(axis=0), flat.max(axis=0)
    size = float((high - low).max())
    low, high = low - _MARGIN * size, high + _MARGIN * size
    corners = [
        [origin + np.array([x, y]) @ axes for y in (low[1], high[1])] for x in (low[0], high[0])
    ]
    corner = origin + low @ axes
    return (
        Nurbs((1, 1), (_ENDS, _ENDS), np.array(corners), None),
        corner,
        axes / (high - low)[:, None],
    )


def _loops(shape: Boundary, face: Face) -> tuple[Nurbs, list[list[_Trim]]]:
    """The surface of a face, and the trims of its loops."""
    inward = None
    if face.surface is None:
        surface, corner, inward = _rectangle(shape, face)
    else:
        surface = face.surface
    loops = []
    for cycle in face.loops:
        paths: list[list[Nurbs]] = []
        for side in cycle:
            curve = shape.edges[side.edge].curve
            if inward is not None:
                # Weights stay: the map is affine.
                flat = (curve.points - corner) @ inward.T
                flat = np.column_stack([flat, np.zeros(len(flat))])
                known = [Nurbs(curve.degrees, curve.knots, flat, curve.weights)]
            elif side.trace is not None:
                known = [replace(side.trace, points=side.trace.points.copy())]
            else:
                known = _along_sides(surface, curve, 2 * shape.gap)
                known = known or traced(surface, curve, 2 * shape.gap)
            if not known:
                raise FormatError(f"an edge of `{face.name}` has no curve in its parameters")
            paths.append([path if side.forward else _turned(path) for path in known])
        trims = []
        for side, path in zip(cycle, _chosen(paths), strict=True):
            edge = shape.edges[side.edge]
            ends = (edge.start, edge.end) if side.forward else (edge.end, edge.start)
            trims.append(_Trim(path, side.edge, not side.forward, ends))
        loops.append(_closed(trims))
    return surface, loops


def _along_sides(surface: Nurbs, curve: Nurbs, gap: float) -> list[Nurbs]:
    """The sides of a surface that are a curve with its parametrisation, in either direction."""
    t = np.linspace(0, 1, 17)
    points = curve(t)
    size = float(np.ptp(surface.points.reshape(-1, 3), axis=0).max())
    found = []
    for fixed in (0.0, 1.0):
        for along in (0, 1):
            for run in (t, 1 - t):
                uv = (run, np.full(17, fixed)) if along == 0 else (np.full(17, fixed), run)
                if np.abs(surface(*uv) - points).max() <= max(gap, 1e-9 * size):
                    ends = np.array([[uv[0][k], uv[1][k], 0.0] for k in (0, -1)])
                    found.append(Nurbs((1,), (_ENDS,), ends, None))
    return found


_MOST_WAYS = 4096
"""Number of ways round a loop that are compared."""


def _chosen(paths: list[list[Nurbs]]) -> list[Nurbs]:
    """The paths, one for each side, of which the fewest begin where the one before does not end."""
    if all(len(known) == 1 for known in paths):
        return [known[0] for known in paths]

    def gaps(way: tuple[Nurbs, ...]) -> int:
        return sum(
            bool(np.abs(a.points[-1] - b.points[0]).max() > _ON_END)
            for a, b in zip(way, (*way[1:], way[0]), strict=True)
        )

    ways = list(itertools.islice(itertools.product(*paths), _MOST_WAYS))
    # A seam runs there and back on two sides.
    best = min(ways, key=lambda way: (gaps(way), -len({_side_of(path) for path in way})))
    return [replace(path, points=path.points.copy()) for path in best]


def _closed(trims: list[_Trim]) -> list[_Trim]:
    """The trims of a loop with those of poles between them; the end of one begins the next."""
    found: list[_Trim] = []
    for k, trim in enumerate(trims):
        found.append(trim)
        following = trims[(k + 1) % len(trims)]
        here, there = trim.path.points[-1], following.path.points[0]
        if np.abs(here - there).max() > _ON_END:
            at = trim.ends[1]
            path = Nurbs((1,), (_ENDS,), np.array([here, there]), None)
            found.append(_Trim(path, -1, False, (at, at)))
        else:
            following.path.points[0] = here
    return found


def _tables(
    shape: Boundary,
    held: list[Face],
    trims: list[_Trim],
    all_loops: list[tuple[int, int, list[_Trim]]],
    users: dict[int, list[int]],
    colours: bool,
) -> list[_Chunk]:
    """The records of vertices, edges, trims, loops and faces."""
    edge_of = {edge: k for k, edge in enumerate(users)}
    points = sorted({v for trim in trims for v in trim.ends})
    vertex_of = {v: k for k, v in enumerate(points)}
    at: dict[int, list[int]] = {v: [] for v in points}
    for edge in users:
        at[shape.edges[edge].start].append(edge_of[edge])
        at[shape.edges[edge].end].append(edge_of[edge])
    gap = max(2 * shape.gap, 1e-9)
    unit = _doubles([0, 1])
    vertices = [
        _ints(vertex_of[v]) + _doubles(shape.vertices[v]) + _listed(at[v]) + _doubles([gap])
        for v in points
    ]
    edges = [
        _ints(k, k, 0) + unit + _ints(*(vertex_of[v] for v in _ends_of(shape, edge)))
        + _listed(users[edge]) + _doubles([gap]) + unit
        for edge, k in edge_of.items()
    ]  # fmt: skip
    trim_records = [
        _ints(k, k) + unit + _ints(
            edge_of.get(trim.edge, -1), *(vertex_of[v] for v in trim.ends), int(trim.against),
            trim.type, trim.side, trim.loop,
        ) + _doubles([gap, gap]) + unit + bytes(32) + _doubles([gap, gap])
        for k, trim in enumerate(trims)
    ]  # fmt: skip
    loop_records, face_records = [], []
    of_face: list[list[int]] = [[] for _ in held]
    first = 0
    for number, (f, k, loop) in enumerate(all_loops):
        listed = _listed(range(first, first + len(loop)))
        loop_records.append(_ints(number) + listed + _ints(1 if k == 0 else 2, f))
        of_face[f].append(number)
        first += len(loop)
    for f, face in enumerate(held):
        face_records.append(_ints(f) + _listed(of_face[f]) + _ints(f, int(face.reversed), 0))
    # Identifiers, which are none, and colours.
    tail = bytes(16 * len(held)) + bytes([int(colours)])
    if colours:
        tail += b"".join(bytes([*(face.colour or (0, 0, 0)), 0]) for face in held)
    return [
        _array(vertices),
        _array(edges),
        _array(trim_records),
        _array(loop_records),
        _array(face_records, tail, 2),
    ]


def brep(shape: Boundary, faces: Iterable[int], colours: bool = True) -> dict[str, Any]:
    """Faces of a model with their common edges, for `rhino3dm.CommonObject.Decode`.

    Parameters
    ----------
    shape
        The model; its normals are those of its surfaces.
    faces
        Numbers of the faces.
    colours
        True to give each face its colour.

    Raises
    ------
    FormatError
        If an edge has no curve in the parameters of its face.
    """
    held = [shape.faces[k] for k in faces]
    made = [_loops(shape, face) for face in held]
    all_loops = [(f, k, loop) for f, (_, loops) in enumerate(made) for k, loop in enumerate(loops)]
    trims: list[_Trim] = []
    for number, (_, _, loop) in enumerate(all_loops):
        for trim in loop:
            trim.loop = number
            trims.append(trim)
    used = sorted({trim.edge for trim in trims if trim.edge >= 0})
    users: dict[int, list[int]] = {edge: [] for edge in used}
    for k, trim in enumerate(trims):
        if trim.edge >= 0:
            users[trim.edge].append(k)
    for own in users.values():
        if len(own) > 1:
            face_of = {all_loops[trims[k].loop][0] for k in own}
            sides = {trims[k].side for k in own}
            seam = len(face_of) == 1 and sides in ({_W, _E}, {_S, _N})
            for k in own:
                trims[k].type = _SEAM if seam else _MATED
    tables = _tables(shape, held, trims, all_loops, users, colours)
    every = np.concatenate([surface.points.reshape(-1, 3) for surface, _ in made])
    none = _chunk(_ANONYMOUS, bytes(len(held)))
    data = _object(
        "brep",
        bytes([0x32]),
        _objects([_curve(trim.path, 2) for trim in trims]),
        _objects([_curve(shape.edges[edge].curve, 3) for edge in used]),
        _objects([_surface(surface) for surface, _ in made]),
        *tables,
        _doubles([every.min(axis=0), every.max(axis=0)]),
        none,
        none,
        # Whether it is a solid is for the reader to find.
        _ints(0),
    )
    return {
        "version": 10000, "archive3dm": 80, "opennurbs": -1869833980,
        "data": base64.b64encode(data).decode(),
    }  # fmt: skip


def _ends_of(shape: Boundary, edge: int) -> tuple[int, int]:
    return shape.edges[edge].start, shape.edges[edge].end
