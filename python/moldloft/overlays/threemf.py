"""3MF files: the triangles of the items of a build, each at its position.

3MF Consortium, Core Specification 1.3; Production Extension 1.1 for parts in several files.
"""

from __future__ import annotations

import io
import posixpath
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import IO, TYPE_CHECKING
from xml.parsers import expat

import numpy as np

from moldloft.budget import limits
from moldloft.errors import FileError
from moldloft.overlays.overlay import Overlay

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["parse"]

MOST_FACES = 1 << 25
"""Maximum number of faces, the copies of components included."""

LARGEST = 1e50
"""Largest coordinate, as of models."""

_METRES = {
    "micron": 1e-6,
    "millimeter": 1e-3,
    "centimeter": 1e-2,
    "inch": 0.0254,
    "foot": 0.3048,
    "meter": 1.0,
}

_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_SUPPORTED = (
    "http://schemas.microsoft.com/3dmanufacturing/production/",
    "http://schemas.microsoft.com/3dmanufacturing/material/",
    "http://schemas.3mf.io/3dmanufacturing/trianglesets/",
)
"""Extensions that leave the shape of meshes as it is."""

_BYTES_PER_BYTE = 4
"""Memory that a byte of a part takes while it is read."""


def parse(name: str, data: bytes) -> tuple[Overlay, float]:
    """The triangles of a 3MF file, and its unit of length in metres.

    Parameters
    ----------
    name
        The name of the file, for the overlay.
    data
        Its bytes.

    Raises
    ------
    FileError
        If it is not a 3MF file, is damaged, or needs an extension that is not supported.
    """
    return _Package(data).overlay(name)


@dataclass
class _Thing:
    """An object: a mesh, or components."""

    name: str
    kind: str
    points: list[float] = field(default_factory=list)
    corners: list[int] = field(default_factory=list)
    parts: list[_Placed] = field(default_factory=list)


@dataclass
class _Placed:
    """An object at a position: its file within the package, its id, 4 rows of 3 numbers."""

    path: str
    number: str
    place: Floats


@dataclass
class _Part:
    """A file of the package."""

    unit: str = "millimeter"
    things: dict[str, _Thing] = field(default_factory=dict)
    items: list[_Placed] = field(default_factory=list)
    lattices: int = 0


class _Package:
    def __init__(self, data: bytes) -> None:
        try:
            self._files = zipfile.ZipFile(io.BytesIO(data))
        except (zipfile.BadZipFile, ValueError, OSError) as error:
            raise FileError(f"not a 3MF file, or cut short: {error}") from None
        self._names = {name.lower(): name for name in self._files.namelist()}
        self._parts: dict[str, _Part] = {}
        self._sizes: dict[tuple[str, str], int] = {}

    def overlay(self, name: str) -> tuple[Overlay, float]:
        root = self._root()
        main = self._part(root)
        points, faces, groups = [np.empty((0, 3))], [np.empty((0, 4), dtype=np.uint32)], []
        first = start = 0
        helping = 0
        total = sum(self._count(item.path or root, item.number, ()) for item in main.items)
        if total > MOST_FACES:
            raise FileError(f"it holds {total} faces; at most {MOST_FACES} are read")
        for item in main.items:
            begun = start
            label = self._thing(item.path or root, item.number).name or f"object {item.number}"
            for thing, place in self._meshes(item, root, np.eye(4)):
                if thing.kind in ("support", "solidsupport"):
                    helping += 1
                    continue
                own = np.array(thing.points).reshape(-1, 3)
                corners = np.array(thing.corners, dtype=np.int64).reshape(-1, 3)
                if not np.abs(own).max(initial=0.0) <= LARGEST:
                    raise FileError(f"object {item.number}: a coordinate exceeds {LARGEST:g}")
                if np.linalg.det(place[:3, :3]) < 0:
                    corners = corners[:, ::-1]
                points.append(own @ place[:3, :3] + place[3, :3])
                faces.append((corners[:, [0, 1, 2, 2]] + first).astype(np.uint32))
                first, start = first + len(own), start + len(corners)
            if start > begun:
                groups.append((label, begun, start))
        whole = np.concatenate(points)
        remarks = []
        if helping:
            remarks.append(f"{helping} objects that support others are omitted")
        if lattices := sum(part.lattices for part in self._parts.values()):
            remarks.append(f"beams of {lattices} lattices are omitted")
        made = Overlay(name, whole, np.concatenate(faces), tuple(groups), remarks=tuple(remarks))
        return made, _METRES[main.unit]

    def _root(self) -> str:
        """The file of the model, by the relations of the package."""
        found: list[str] = []

        def element(tag: str, words: Mapping[str, str]) -> None:
            if tag == "Relationship" and words.get("Type", "").endswith("/3dmodel"):
                found.append(words.get("Target", ""))

        if "_rels/.rels" in self._names:
            self._parse("_rels/.rels", element)
        path = _whole_path(found[0] if found else "3D/3dmodel.model")
        if path[1:].lower() not in self._names:
            raise FileError(f"not a 3MF file: it contains no `{path[1:]}`")
        return path

    def _parse(self, path: str, element: Callable[[str, Mapping[str, str]], None]) -> None:
        """Calls a function for each element of a file, which is unfolded a piece at a time."""
        name = self._names.get(path.lstrip("/").lower())
        if name is None:
            raise FileError(f"`{path}` is missing in it")
        size = self._files.getinfo(name).file_size
        allowed = limits().memory
        if size * _BYTES_PER_BYTE > allowed:
            raise FileError(
                f"`{path}` unfolds to {size / 1e6:.0f} MB; reading it would take more than the "
                f"{allowed / 2**30:.3g} GiB of memory that are allowed"
            )
        try:
            with self._files.open(name) as file:
                _parsed(path, file, element)
        except FileError:
            raise
        except (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError) as error:
            raise FileError(f"`{path}` in it cannot be unfolded: {error}") from None
        except (EOFError, OSError) as error:
            raise FileError(f"`{path}` in it is cut short: {error}") from None

    def _part(self, path: str) -> _Part:
        if path not in self._parts:
            reader = _Reader()
            self._parse(path, reader.element)
            reader.check()
            self._parts[path] = reader.part
        return self._parts[path]

    def _thing(self, path: str, number: str) -> _Thing:
        found = self._part(path).things.get(number)
        if found is None:
            raise FileError(f"`{path}`: expected an object {number}, found none")
        return found

    def _count(self, path: str, number: str, above: tuple[tuple[str, str], ...]) -> int:
        """Faces of an object with its components."""
        key = (path, number)
        if key in above:
            raise FileError(f"object {number} is a component of itself")
        if len(above) > _DEEPEST:
            raise FileError(f"components are nested deeper than {_DEEPEST}")
        if key not in self._sizes:
            thing = self._thing(path, number)
            inner = (*above, key)
            parts = sum(self._count(p.path or path, p.number, inner) for p in thing.parts)
            self._sizes[key] = len(thing.corners) // 3 + parts
        return self._sizes[key]

    def _meshes(self, item: _Placed, path: str, above: Floats) -> Iterator[tuple[_Thing, Floats]]:
        """Meshes of an item and their positions."""
        path = item.path or path
        if not self._sizes[path, item.number]:
            return
        thing = self._thing(path, item.number)
        place = item.place @ above
        if thing.corners:
            yield thing, place
        for part in thing.parts:
            yield from self._meshes(part, path, place)


_DEEPEST = 50
"""Maximum depth of components in components."""


class _Reader:
    """Reads a file of the package, element by element."""

    def __init__(self) -> None:
        self.part = _Part()
        self._now: _Thing | None = None

    def check(self) -> None:
        """Refuses faces with vertex numbers that do not exist."""
        for number, thing in self.part.things.items():
            count = len(thing.points) // 3
            corners = thing.corners
            if corners and not 0 <= min(corners) <= max(corners) < count:
                raise FileError(
                    f"object {number}: a face has a vertex number beyond the {count} vertices"
                )

    def element(self, tag: str, words: Mapping[str, str]) -> None:
        """Takes an element of the file."""
        now = self._now
        if tag == "vertex" and now is not None:
            now.points += (float(words["x"]), float(words["y"]), float(words["z"]))
        elif tag == "triangle" and now is not None:
            now.corners += (int(words["v1"]), int(words["v2"]), int(words["v3"]))
        elif tag == "object":
            now = self._now = _Thing(words.get("name", ""), words.get("type", "model"))
            if self.part.things.setdefault(words["id"], now) is not now:
                raise FileError(f"two objects have the id {words['id']}")
        elif tag == "component" and now is not None:
            now.parts.append(_placed(words))
        elif tag == "item":
            self.part.items.append(_placed(words))
        elif tag == "beamlattice":
            self.part.lattices += 1
        elif tag == "model":
            self.part.unit = words.get("unit", "millimeter")
            if self.part.unit not in _METRES:
                known = ", ".join(_METRES)
                raise FileError(f"expected a unit of {known}, found `{self.part.unit}`")


def _placed(words: Mapping[str, str]) -> _Placed:
    place = np.eye(4)
    if "transform" in words:
        numbers = [float(word) for word in words["transform"].split()]
        if len(numbers) != 12 or not all(abs(n) <= LARGEST for n in numbers):
            raise FileError(
                f"expected 12 numbers of a transform, of at most {LARGEST:g}, found "
                f"`{words['transform'][:60]}`"
            )
        place[:, :3] = np.array(numbers).reshape(4, 3)
    path = words.get("path", "")
    return _Placed(_whole_path(path) if path else "", words["objectid"], place)


def _whole_path(path: str) -> str:
    """A path from the top of the package."""
    return posixpath.normpath("/" + path.lstrip("/"))


def _parsed(path: str, file: IO[bytes], element: Callable[[str, Mapping[str, str]], None]) -> None:
    """Calls a function with local name and attributes of each element; errors have the line."""
    parser = expat.ParserCreate(namespace_separator=" ")
    parser.buffer_text = True
    prefixes: dict[str, str] = {}

    def space(prefix: str | None, uri: str | None) -> None:
        prefixes[prefix or ""] = uri or ""

    def entity(*_: object) -> None:
        raise FileError(f"`{path}`: it declares entities")

    def start(tag: str, words: dict[str, str]) -> None:
        own = {key.rpartition(" ")[2]: value for key, value in words.items()}
        tag = tag.rpartition(" ")[2]
        for prefix in own.get("requiredextensions", "").split() if tag == "model" else ():
            if not prefixes.get(prefix, prefix).startswith((*_SUPPORTED, _CORE)):
                raise FileError(
                    f"it needs the extension `{prefixes.get(prefix, prefix)}`, which is unsupported"
                )
        element(tag, own)

    parser.StartNamespaceDeclHandler = space
    parser.EntityDeclHandler = entity
    parser.StartElementHandler = start
    try:
        parser.ParseFile(file)
    except expat.ExpatError as error:
        raise FileError(f"`{path}` is not well-formed: {error}") from None
    except KeyError as error:
        line = parser.CurrentLineNumber
        raise FileError(f"`{path}`, line {line}: the attribute {error} is missing") from None
    except (ValueError, OverflowError) as error:
        line = parser.CurrentLineNumber
        raise FileError(f"`{path}`, line {line}: expected a number: {error}") from None
