"""Polygons of VTK: PolyData in files of the legacy format and of XML (`vtp`).

Kitware, *VTK File Formats*: versions 1 to 5.1 of the legacy format, text and binary; XML with
arrays as text, in base64 or appended, plain or compressed by zlib and LZMA.
"""

from __future__ import annotations

import base64
import binascii
import lzma
import re
import zlib
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np

from moldloft.budget import limits
from moldloft.errors import FileError
from moldloft.overlays.overlay import Overlay

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[Any]

__all__ = ["is_legacy", "legacy", "xml"]

_LEGACY = {
    "float": ">f4", "double": ">f8", "char": "i1", "unsigned_char": "u1", "short": ">i2",
    "unsigned_short": ">u2", "int": ">i4", "unsigned_int": ">u4", "long": ">i8",
    "unsigned_long": ">u8", "vtktypeint64": ">i8", "vtktypeuint64": ">u8", "vtkidtype": ">i4",
}  # fmt: skip
_XML = {
    "Float32": "f4", "Float64": "f8", "Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2",
    "Int32": "i4", "UInt32": "u4", "Int64": "i8", "UInt64": "u8",
}  # fmt: skip

_CELLS = {"VERTICES": "points", "LINES": "lines", "POLYGONS": "", "TRIANGLE_STRIPS": ""}
"""Sections of cells; those with a name are omitted."""


def is_legacy(data: bytes) -> bool:
    """True for PolyData in the legacy format.

    Parameters
    ----------
    data
        A file.
    """
    return re.search(rb"^DATASET\s+POLYDATA\s*$", data[:2000], re.M | re.I) is not None


def legacy(name: str, data: bytes) -> Overlay:
    """The polygons of a file of the legacy format.

    Parameters
    ----------
    name
        The name of the file, for the overlay.
    data
        Its bytes.

    Raises
    ------
    FileError
        If it is cut short, or not as the format prescribes.
    """
    return _Legacy(data).overlay(name)


class _Legacy:
    """A file of the legacy format, read from section to section."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        head = re.match(
            rb"# vtk DataFile Version (\d+)\.\d+[^\n]*\n[^\n]*\n\s*(ASCII|BINARY)\s*\n", data, re.I
        )
        if head is None:
            raise FileError(
                "expected the four lines of a VTK file: version, title, ASCII or BINARY"
            )
        self._offsets = int(head[1]) >= 5
        self._binary = head[2].upper() == b"BINARY"
        self._at = head.end()

    def overlay(self, name: str) -> Overlay:
        points = np.empty((0, 3))
        cells = []
        left = {"points": 0, "lines": 0}
        while (words := self._line()) is not None:
            word = words[0].upper() if words else ""
            if word == "POINTS":
                count = self._count(words, 1)
                points = self._numbers(3 * count, self._type(words, 2), word).reshape(-1, 3)
            elif word in _CELLS:
                connectivity, offsets = self._cells(words, word)
                if _CELLS[word]:
                    left[_CELLS[word]] += len(offsets) - 1
                else:
                    cells.append((connectivity, offsets, word == "TRIANGLE_STRIPS"))
            elif word == "FIELD":
                self._field(self._count(words, 2))
            elif word == "METADATA":
                while self._line():
                    pass
            elif word in ("POINT_DATA", "CELL_DATA"):
                break
            elif word not in ("", "DATASET"):
                raise FileError(f"byte {self._at}: expected a section of PolyData, found `{word}`")
        return _overlay(name, points, cells, left)

    def _line(self) -> list[str] | None:
        if self._at >= len(self._data):
            return None
        end = self._data.find(b"\n", self._at)
        end = len(self._data) if end < 0 else end
        line, self._at = self._data[self._at : end], end + 1
        return line[:200].decode("ascii", "replace").split()

    def _count(self, words: list[str], k: int) -> int:
        if len(words) <= k or not words[k].isdigit() or len(words[k]) > 15:
            raise FileError(f"`{' '.join(words)[:60]}`: expected a count after {words[0]}")
        return int(words[k])

    def _type(self, words: list[str], k: int) -> np.dtype[Any]:
        kind = _LEGACY.get(words[k].lower() if len(words) > k else "")
        if kind is None:
            raise FileError(f"`{' '.join(words)[:60]}`: expected a type of numbers")
        return np.dtype(kind)

    def _numbers(self, count: int, kind: np.dtype[Any], what: str) -> Numbers:
        """The next numbers, to the end of their line."""
        if self._binary:
            size = count * kind.itemsize
            found = np.frombuffer(self._data[self._at : self._at + size], dtype=np.uint8)
            if len(found) < size:
                raise FileError(f"{what}: expected {size} bytes, found {len(found)}: cut short")
            self._at += size
            if self._data[self._at : self._at + 1] == b"\n":
                self._at += 1
            return found.view(kind).astype(np.float64 if kind.kind == "f" else np.int64)
        end = _LETTER.search(self._data, self._at)
        text = self._data[self._at : end.start() if end else len(self._data)]
        self._at = end.start() if end else len(self._data)
        numbers = _of_text(text, kind.kind == "f", what)
        if len(numbers) != count:
            raise FileError(f"{what}: expected {count} numbers, found {len(numbers)}")
        return numbers

    def _cells(self, words: list[str], what: str) -> tuple[Numbers, Numbers]:
        first, second = self._count(words, 1), self._count(words, 2)
        if not self._offsets:
            return _split(self._numbers(second, np.dtype(">i4"), what), first, what)
        parts = []
        for part, count in (("OFFSETS", first), ("CONNECTIVITY", second)):
            line = self._line() or [""]
            if line[0].upper() != part:
                raise FileError(f"{what}: expected {part}, found `{' '.join(line)[:60]}`")
            parts.append(self._numbers(count, self._type(line, 1), part))
        return parts[1], parts[0] if first else np.zeros(1, dtype=np.int64)

    def _field(self, count: int) -> None:
        """Skips arrays of numbers."""
        for _ in range(count):
            words: list[str] = []
            while not words:
                found = self._line()
                if found is None:
                    raise FileError("FIELD: an array is missing; cut short")
                words = found
            size = self._count(words, 1) * self._count(words, 2)
            self._numbers(size, self._type(words, 3), words[0])


_LETTER = re.compile(rb"^\s*[A-Za-z]", re.M)


def _of_text(text: bytes, real: bool, what: str) -> Numbers:
    try:
        return np.array(text.split(), dtype=np.float64 if real else np.int64)
    except (ValueError, OverflowError) as error:
        raise FileError(f"{what}: expected numbers: {error}") from None


def _split(numbers: Numbers, count: int, what: str) -> tuple[Numbers, Numbers]:
    """Connectivity and offsets of cells that are stored as count and corners."""
    sizes: list[int] = []
    at = 0
    listed = numbers.tolist()
    keep = np.ones(len(listed), dtype=bool)
    for _ in range(count):
        if at >= len(listed) or listed[at] < 0:
            raise FileError(f"{what}: expected {count} cells, found {len(sizes)}")
        keep[at] = False
        sizes.append(listed[at])
        at += 1 + listed[at]
    if at != len(listed):
        raise FileError(f"{what}: {count} cells have {at} numbers, the file states {len(listed)}")
    return numbers[keep], np.concatenate([[0], np.cumsum(sizes, dtype=np.int64)])


def xml(name: str, data: bytes) -> Overlay:
    """The polygons of a file of VTK's XML.

    Parameters
    ----------
    name
        The name of the file, for the overlay.
    data
        Its bytes.

    Raises
    ------
    FileError
        If it is cut short, or not as the format prescribes.
    """
    return _Xml(data).overlay(name)


class _Xml:
    def __init__(self, data: bytes) -> None:
        if b"<!ENTITY" in data:
            raise FileError("unsupported file: it declares entities")
        found = re.search(rb"<AppendedData[^>]*>", data)
        self._appended = b""
        text = data
        if found:
            # What is appended may be no text.
            start = data.find(b"_", found.end())
            end = data.rfind(b"</AppendedData>")
            if start < 0 or end < start:
                raise FileError("the end of the appended data is missing: cut short")
            self._appended = data[start + 1 : end]
            text = data[: found.start()] + b"</VTKFile>"
        self._raw = bool(found and re.search(rb"encoding\s*=\s*[\"']raw", found[0]))
        try:
            self._root = ElementTree.fromstring(text)
        except ElementTree.ParseError as error:
            raise FileError(f"not a file of VTK's XML, or cut short: {error}") from None
        if self._root.tag != "VTKFile" or self._root.get("type") != "PolyData":
            raise FileError(
                f"expected PolyData of VTK, found `{self._root.tag}` of type "
                f"`{self._root.get('type', '')}`"
            )
        order = ">" if self._root.get("byte_order") == "BigEndian" else "<"
        self._order = order
        self._header = np.dtype(order + _XML.get(self._root.get("header_type", "UInt32"), "u4"))
        packed = self._root.get("compressor", "")
        if packed not in _UNPACKED:
            raise FileError(f"data compressed by {packed} are not supported: write them by zlib")
        self._unpacked = _UNPACKED[packed]

    def overlay(self, name: str) -> Overlay:
        points: list[Numbers] = [np.empty((0, 3))]
        cells: list[tuple[Numbers, Numbers, bool]] = []
        left = {"points": 0, "lines": 0}
        first = 0
        for piece in self._root.iter("Piece"):
            count = _stated(piece, "NumberOfPoints")
            arrays = piece.findall("./Points/DataArray")
            own = self._array(arrays[0], "Points") if arrays else np.empty(0)
            if len(own) != 3 * count:
                raise FileError(f"Points: expected {3 * count} numbers, found {len(own)}")
            points.append(own.reshape(-1, 3).astype(np.float64))
            left["points"] += _stated(piece, "NumberOfVerts")
            left["lines"] += _stated(piece, "NumberOfLines")
            for tag, stated in (("Polys", "NumberOfPolys"), ("Strips", "NumberOfStrips")):
                if cell_count := _stated(piece, stated):
                    found = {
                        array.get("Name", ""): self._array(array, tag).astype(np.int64)
                        for array in piece.findall(f"./{tag}/DataArray")
                    }
                    if not {"connectivity", "offsets"} <= set(found):
                        raise FileError(f"{tag}: `connectivity` or `offsets` is missing")
                    if len(found["offsets"]) != cell_count:
                        raise FileError(
                            f"{tag}: expected {cell_count} offsets, found {len(found['offsets'])}"
                        )
                    ends = np.concatenate([[0], found["offsets"]])
                    connectivity = found["connectivity"]
                    if connectivity.size and connectivity.max() >= count:
                        raise FileError(
                            f"{tag}: a vertex number is beyond the {count} vertices of its piece"
                        )
                    cells.append((connectivity + first, ends, tag == "Strips"))
            first += count
        return _overlay(name, np.concatenate(points), cells, left)

    def _array(self, array: ElementTree.Element, what: str) -> Numbers:
        kind = _XML.get(array.get("type", ""))
        if kind is None:
            raise FileError(f"{what}: the type of numbers `{array.get('type', '')}` is unknown")
        form = array.get("format", "ascii")
        text = (array.text or "").encode()
        if form == "ascii":
            return _of_text(text, kind.startswith("f"), what)
        try:
            if form == "binary":
                found = self._coded(text.strip(), what)
            elif form == "appended":
                at = _stated(array, "offset")
                if at > len(self._appended):
                    raise FileError(f"{what}: its data are missing: cut short")
                part = self._appended[at:]
                found = self._plain(part, what) if self._raw else self._coded(part, what)
            else:
                raise FileError(f"{what}: the format `{form}` is unknown")
            return np.frombuffer(found, dtype=self._order + kind)
        except (ValueError, binascii.Error, zlib.error, lzma.LZMAError) as error:
            raise FileError(f"{what}: its data cannot be decoded: {error}") from None

    def _coded(self, text: bytes, what: str) -> bytes:
        """Data in base64: the header, if blocks are compressed, is coded apart."""
        size = self._header.itemsize
        if self._unpacked is None:
            count = self._sizes(_decoded(text, size), 1, what)[0]
            return self._plain(_decoded(text, size + count), what)
        blocks = self._sizes(_decoded(text, 3 * size), 3, what)[0]
        self._bounded(blocks * size)
        head = _decoded(text, (3 + blocks) * size)
        begin = -(-(3 + blocks) * size // 3) * 4
        sizes = self._sizes(head, 3 + blocks, what)[3:]
        self._bounded(sum(sizes))
        return self._plain(head + _decoded(text[begin:], sum(sizes)), what)

    def _plain(self, part: bytes, what: str) -> bytes:
        """The bytes of an array whose header and data are bytes."""
        size = self._header.itemsize
        if self._unpacked is None:
            count = self._sizes(part, 1, what)[0]
            if len(part) < size + count:
                raise FileError(f"{what}: expected {count} bytes, found {len(part) - size}")
            return part[size : size + count]
        blocks, whole, last = self._sizes(part, 3, what)
        self._bounded(blocks * size)
        self._bounded(blocks * whole)
        at = (3 + blocks) * size
        found = []
        for k, packed in enumerate(self._sizes(part, 3 + blocks, what)[3:]):
            most = last if last and k == blocks - 1 else whole
            found.append(self._unpacked(part[at : at + packed], most))
            if len(found[-1]) != most:
                raise FileError(f"{what}: a block unfolds to {len(found[-1])} bytes, not {most}")
            at += packed
        return b"".join(found)

    def _sizes(self, part: bytes, count: int, what: str) -> list[int]:
        if len(part) < count * self._header.itemsize:
            raise FileError(f"{what}: the sizes before its data are missing: cut short")
        return [int(n) for n in np.frombuffer(part, dtype=self._header, count=count)]

    def _bounded(self, size: int) -> None:
        if size > limits().memory // 4:
            raise FileError(
                f"an array of it takes {size / 1e6:.0f} MB: more than the memory that is allowed"
            )


def _decoded(text: bytes, size: int) -> bytes:
    """The first bytes of a text in base64."""
    return base64.b64decode(text[: -(-size // 3) * 4])[:size]


def _zlib(data: bytes, most: int) -> bytes:
    return zlib.decompressobj().decompress(data, most + 1)


def _lzma(data: bytes, most: int) -> bytes:
    return lzma.LZMADecompressor().decompress(data, most + 1)


_UNPACKED: dict[str, Any] = {
    "": None,
    "vtkZLibDataCompressor": _zlib,
    "vtkLZMADataCompressor": _lzma,
}
"""Functions of compressed bytes and their greatest unfolded size."""


def _stated(element: ElementTree.Element, name: str) -> int:
    text = element.get(name, "0").strip()
    if not text.isdigit() or len(text) > 15:
        raise FileError(f"`{name}`: expected a whole number, found `{text[:30]}`")
    return int(text)


def _overlay(
    name: str,
    points: Numbers,
    cells: list[tuple[Numbers, Numbers, bool]],
    left: dict[str, int],
) -> Overlay:
    """The faces of polygons and strips: more than four corners become fans."""
    faces = [np.empty((0, 4), dtype=np.int64)]
    for connectivity, offsets, strips in cells:
        if (
            len(offsets) == 0
            or offsets[0] != 0
            or offsets[-1] != len(connectivity)
            or (np.diff(offsets) < 0).any()
        ):
            raise FileError("the offsets of cells do not divide their vertex numbers")
        if connectivity.size and not 0 <= connectivity.min() <= connectivity.max() < len(points):
            raise FileError(f"a face has a vertex number beyond the {len(points)} vertices")
        faces.append(_strips(connectivity, offsets) if strips else _fans(connectivity, offsets))
    if not np.isfinite(points).all():
        raise FileError("a coordinate is not a finite number")
    whole = np.concatenate(faces)
    remarks = tuple(f"{count} cells of {what} are omitted" for what, count in left.items() if count)
    groups = (("faces", 0, len(whole)),) if len(whole) else ()
    return Overlay(
        name, points.astype(np.float64), whole.astype(np.uint32), groups, remarks=remarks
    )


def _fans(connectivity: Numbers, offsets: Numbers) -> Numbers:
    sizes = np.diff(offsets)
    found: list[Numbers] = [np.empty((0, 4), dtype=np.int64)]
    order: list[Numbers] = [np.empty(0, dtype=np.int64)]
    for size in np.unique(sizes[sizes > 2]).tolist():
        which = np.flatnonzero(sizes == size)
        corners = connectivity[offsets[which, None] + np.arange(size)]
        if size <= 4:
            found.append(corners[:, [0, 1, 2, size - 1]])
            order.append(which)
        else:
            inner = np.arange(1, size - 1)
            first = np.zeros_like(inner)
            fans = corners[:, np.stack([first, inner, inner + 1, inner + 1], axis=1)]
            found.append(fans.reshape(-1, 4))
            order.append(np.repeat(which, size - 2))
    return np.concatenate(found)[np.argsort(np.concatenate(order), kind="stable")]


def _strips(connectivity: Numbers, offsets: Numbers) -> Numbers:
    found: list[Numbers] = [np.empty((0, 4), dtype=np.int64)]
    for start, end in zip(offsets[:-1].tolist(), offsets[1:].tolist(), strict=True):
        own = connectivity[start:end]
        if len(own) < 3:
            continue
        corners = np.stack([own[:-2], own[1:-1], own[2:]], axis=1)
        corners[1::2] = corners[1::2, [1, 0, 2]]
        found.append(corners[:, [0, 1, 2, 2]])
    return np.concatenate(found)
