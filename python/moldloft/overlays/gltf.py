"""GLB files: the triangles of a scene of glTF, each at the position of its node.

Khronos, glTF 2.0 Specification: chapters 3.5 to 3.7 and 4.4. Lengths are metres, and y is up: it
becomes z.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import FileError
from moldloft.overlays.overlay import Overlay

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["parse"]

MOST_FACES = 1 << 25
"""Maximum number of faces, the copies of shared meshes included."""

LARGEST = 1e50
"""Largest coordinate, as of models."""

_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}

_JSON, _BINARY = 0x4E4F534A, 0x004E4942
"""Types of chunks."""

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
"""Modes of primitives."""

_HARMLESS = ("KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_")
"""Prefixes of extensions without a shape."""

_UP = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
"""Turns y up into z up."""


def parse(name: str, data: bytes) -> tuple[Overlay, float]:
    """The triangles of a GLB file, z up, and its unit of length in metres, 1.

    Parameters
    ----------
    name
        The name of the file, for the overlay.
    data
        Its bytes.

    Raises
    ------
    FileError
        If it is not a GLB file, is cut short, or needs an extension that is not supported.
    """
    return _Scene(*_chunks(data)).overlay(name), 1.0


def _chunks(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The text and the binary chunk."""
    if len(data) < 20 or data[:4] != b"glTF":
        raise FileError("not a GLB file (it must begin with glTF)")
    version, length = struct.unpack_from("<2I", data, 4)
    if version != 2:
        raise FileError(f"expected version 2 of glTF, found {version}")
    if length > len(data):
        raise FileError(f"cut short: expected {length} bytes, found {len(data)}")
    found: dict[int, bytes] = {}
    at = 12
    while at + 8 <= length:
        size, kind = struct.unpack_from("<2I", data, at)
        if at + 8 + size > length:
            raise FileError(f"byte {at}: a chunk of {size} bytes extends beyond the file")
        found.setdefault(kind, data[at + 8 : at + 8 + size])
        at += 8 + size
    try:
        text = json.loads(found.get(_JSON, b"").decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise FileError(f"its chunk of JSON cannot be read: {error}") from None
    if not isinstance(text, dict):
        raise FileError("its chunk of JSON is not an object")
    return text, found.get(_BINARY, b"")


class _Scene:
    """The nodes of a scene, and the meshes that they place."""

    def __init__(self, text: dict[str, Any], binary: bytes) -> None:
        self._text = text
        self._binary = binary
        self._left = 0
        self._posed = 0
        for extension in _strings(text.get("extensionsRequired", [])):
            if extension != "KHR_mesh_quantization" and not extension.startswith(_HARMLESS):
                raise FileError(
                    f"it needs the extension `{extension}`, which is not supported\n"
                    "help: write the file without compression and extensions"
                )

    def overlay(self, name: str) -> Overlay:
        points, faces, groups = [np.empty((0, 3))], [np.empty((0, 4), dtype=np.uint32)], []
        first = start = 0
        for label, place, mesh in self._placed():
            begun = start
            for own, corners in self._primitives(mesh):
                if start + len(corners) > MOST_FACES:
                    raise FileError(f"it holds more than {MOST_FACES} faces")
                if np.linalg.det(place[:3, :3]) < 0:
                    corners = corners[:, ::-1]
                at = own @ place[:3, :3].T + place[:3, 3]
                points.append(at @ _UP.T + 0.0)
                faces.append((corners[:, [0, 1, 2, 2]] + first).astype(np.uint32))
                first, start = first + len(own), start + len(corners)
            if start > begun:
                groups.append((label, begun, start))
        whole = np.concatenate(points)
        remarks = []
        if self._left:
            remarks.append(f"{self._left} primitives of points or lines are omitted")
        if self._posed:
            remarks.append(f"{self._posed} meshes with skins or morph targets are as at rest")
        return Overlay(name, whole, np.concatenate(faces), tuple(groups), remarks=tuple(remarks))

    def _placed(self) -> Iterator[tuple[str, Floats, dict[str, Any]]]:
        """Name, position and mesh of each node that has a mesh, in the order of the file."""
        nodes = self._rows("nodes")
        scenes = self._rows("scenes")
        if scenes:
            roots = _numbers(self._row("scenes", self._text.get("scene", 0)).get("nodes", []))
        else:
            inner = {k for node in nodes for k in _numbers(node.get("children", []))}
            roots = [k for k in range(len(nodes)) if k not in inner]
        seen: set[int] = set()
        stack = [(k, np.eye(4)) for k in reversed(roots)]
        while stack:
            number, above = stack.pop()
            node = self._row("nodes", number)
            if number in seen:
                raise FileError(f"node {number} has two parents, or is inside itself")
            seen.add(number)
            if "EXT_mesh_gpu_instancing" in node.get("extensions", {}):
                raise FileError(f"node {number}: copies by EXT_mesh_gpu_instancing are unsupported")
            place = above @ _transform(node, number)
            children = _numbers(node.get("children", []))
            stack += [(k, place) for k in reversed(children)]
            if "mesh" in node:
                mesh = self._row("meshes", node["mesh"])
                targets = any("targets" in part for part in _rows(mesh.get("primitives")))
                self._posed += "skin" in node or targets
                yield str(node.get("name") or mesh.get("name") or f"node {number}"), place, mesh

    def _primitives(self, mesh: dict[str, Any]) -> Iterator[tuple[Floats, NDArray[np.int64]]]:
        """Points, and corners of triangles, of each primitive."""
        for part in _rows(mesh.get("primitives")):
            mode = part.get("mode", _TRIANGLES)
            attributes = part.get("attributes")
            if not isinstance(attributes, dict) or "POSITION" not in attributes:
                raise FileError("a primitive has no attribute POSITION")
            if mode not in (_TRIANGLES, _STRIP, _FAN):
                self._left += 1
                continue
            points = self._array(attributes["POSITION"], 3).astype(np.float64)
            if not np.isfinite(points).all():
                raise FileError("a coordinate is not a finite number")
            order = np.arange(len(points), dtype=np.int64)
            if "indices" in part:
                order = self._array(part["indices"], 1).reshape(-1).astype(np.int64)
                if order.size and not 0 <= order.min() <= order.max() < len(points):
                    raise FileError(f"a face has a vertex number beyond the {len(points)} vertices")
            yield points, _triangles(order, mode)

    def _array(self, number: Any, width: int) -> NDArray[Any]:
        """The values of an accessor, ``(count, width)``."""
        accessor = self._row("accessors", number)
        kind = _COMPONENTS.get(accessor.get("componentType", 0))
        if kind is None or _WIDTHS.get(accessor.get("type", "")) != width:
            raise FileError(f"accessor {number}: expected {width} numbers an element")
        count = _whole(accessor.get("count"), f"the count of accessor {number}")
        if count > MOST_FACES * 3:
            raise FileError(f"accessor {number} has {count} elements")
        if "bufferView" in accessor:
            found = self._view(accessor, np.dtype(kind), count, width)
        else:
            found = np.zeros((count, width), dtype=kind)
        if "sparse" in accessor:
            found = self._sparse(accessor["sparse"], found, number)
        if accessor.get("normalized") and found.dtype.kind in "iu":
            whole = float(np.iinfo(found.dtype).max)
            return np.maximum(found / whole, -1.0)
        return found

    def _sparse(self, sparse: Any, found: NDArray[Any], number: Any) -> NDArray[Any]:
        if not isinstance(sparse, dict):
            raise FileError(f"accessor {number}: `sparse` is not an object")
        count = _whole(sparse.get("count"), f"the sparse count of accessor {number}")
        at, values = sparse.get("indices"), sparse.get("values")
        if not isinstance(at, dict) or not isinstance(values, dict):
            raise FileError(f"accessor {number}: `sparse` has no indices or no values")
        kind = _COMPONENTS.get(at.get("componentType", 0), "u1")
        rows = self._view(at, np.dtype(kind), count, 1).reshape(-1).astype(np.int64)
        if rows.size and not 0 <= rows.min() <= rows.max() < len(found):
            raise FileError(
                f"accessor {number}: a sparse index is beyond its {len(found)} elements"
            )
        found = found.copy()
        found[rows] = self._view(values, found.dtype, count, found.shape[1])
        return found

    def _view(
        self, accessor: dict[str, Any], kind: np.dtype[Any], count: int, width: int
    ) -> NDArray[Any]:
        """Elements of a view of the binary chunk."""
        number = accessor.get("bufferView")
        view = self._row("bufferViews", number)
        buffer = self._row("buffers", view.get("buffer", 0))
        if view.get("buffer", 0) != 0 or "uri" in buffer:
            raise FileError(
                "its numbers are in another file or in a text\nhelp: write all as one GLB file"
            )
        size = _whole(view.get("byteLength"), f"the length of view {number}")
        start = _whole(view.get("byteOffset", 0), f"the offset of view {number}")
        inner = _whole(accessor.get("byteOffset", 0), "the offset of an accessor")
        item = kind.itemsize * width
        step = _whole(view.get("byteStride", item), f"the stride of view {number}")
        reach = inner + step * (count - 1) + item if count else 0
        if start + size > len(self._binary) or reach > size or step < item:
            raise FileError(
                f"view {number} extends beyond the numbers of the file, or is cut short"
            )
        found: NDArray[Any] = np.ndarray(
            (count, width), kind, self._binary, start + inner, (step, kind.itemsize)
        )
        return found

    def _rows(self, name: str) -> list[dict[str, Any]]:
        return _rows(self._text.get(name))

    def _row(self, name: str, number: Any) -> dict[str, Any]:
        rows = self._rows(name)
        if not isinstance(number, int) or not 0 <= number < len(rows):
            raise FileError(f"expected one of the {len(rows)} {name}, found number {number}")
        return rows[number]


def _rows(value: Any) -> list[dict[str, Any]]:
    if value is None:
        return []
    if not isinstance(value, list) or not all(isinstance(row, dict) for row in value):
        raise FileError("its chunk of JSON has another form than that of glTF 2.0")
    return value


def _numbers(value: Any) -> list[int]:
    if not isinstance(value, list) or not all(type(k) is int for k in value):
        raise FileError("numbers of nodes are expected as a list of whole numbers")
    return value


def _strings(value: Any) -> list[str]:
    if not isinstance(value, list) or not all(isinstance(k, str) for k in value):
        raise FileError("names of extensions are expected as a list of texts")
    return value


def _whole(value: Any, what: str) -> int:
    if type(value) is not int or value < 0:
        raise FileError(f"{what}: expected a whole number of at least 0, found {value!r}")
    return value


def _transform(node: dict[str, Any], number: int) -> Floats:
    """The matrix of a node, from its own or from translation, rotation and scale."""
    try:
        if "matrix" in node:
            place = np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
        else:
            x, y, z, w = np.array(node.get("rotation", [0, 0, 0, 1]), dtype=np.float64)
            size = math.hypot(x, y, z, w)
            x, y, z, w = x / size, y / size, z / size, w / size
            turn = np.array(
                [
                    [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
                ]
            )
            place = np.eye(4)
            place[:3, :3] = turn * np.array(node.get("scale", [1, 1, 1]), dtype=np.float64)
            place[:3, 3] = node.get("translation", [0, 0, 0])
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        raise FileError(f"the transform of node {number} is not of numbers") from None
    if not np.abs(place).max() <= LARGEST:
        raise FileError(f"the transform of node {number} has a number beyond {LARGEST:g}")
    return place


def _triangles(order: NDArray[np.int64], mode: int) -> NDArray[np.int64]:
    """Corners of the triangles of a list, a strip or a fan."""
    if mode == _TRIANGLES:
        if len(order) % 3:
            raise FileError(f"expected three corners a triangle, found {len(order)} in all")
        return order.reshape(-1, 3)
    if len(order) < 3:
        return np.empty((0, 3), dtype=np.int64)
    if mode == _FAN:
        return np.stack([np.full(len(order) - 2, order[0]), order[1:-1], order[2:]], axis=1)
    found = np.stack([order[:-2], order[1:-1], order[2:]], axis=1)
    found[1::2] = found[1::2, [1, 0, 2]]
    return found
