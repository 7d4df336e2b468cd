"""Files of points and grids, read with the line of every fault."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import FairingError, FileError

if TYPE_CHECKING:
    import os

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "GridFile",
    "PointFile",
    "is_grid",
    "points_text",
    "read_grids",
    "read_numbers",
    "read_points",
    "write_vts",
]

LARGEST = 1 << 30
"""The most bytes of a file that is read."""


@dataclass
class PointFile:
    """A file of points: rows of two or three numbers."""

    path: Path
    """Where it was read."""
    points: Floats
    """All rows in the order of the curve, ``(n, 2)`` or ``(n, 3)``."""
    lines: list[int]
    """The line of each row, from 1."""
    blocks: list[range]
    """Runs of rows that blank lines separate."""
    head: list[str]
    """Title or names of columns, comments."""
    delimiter: str | None = None
    """What separates columns; ``None`` for blanks."""
    counts: tuple[int, int] | None = None
    """Of an aerofoil in two halves, from the leading edge each: the numbers of their points."""
    notes: list[str] = field(default_factory=list)
    """What reading it showed."""

    @property
    def width(self) -> int:
        """The number of columns."""
        return int(self.points.shape[1])


def _bytes(path: Path) -> bytes:
    try:
        if path.stat().st_size > LARGEST:
            raise FileError(f"error: `{path}` is larger than {LARGEST >> 20} MB")
        return path.read_bytes()
    except FileError:
        raise
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise FileError(f"error: cannot read `{path}`: {reason}") from error


def _number(word: str) -> float | None:
    # Fortran writes 1.0D-3.
    try:
        return float(word)
    except ValueError:
        try:
            return float(word.replace("D", "E").replace("d", "e"))
        except ValueError:
            return None


def _split(line: str) -> tuple[list[str], str | None]:
    for delimiter in (",", ";", "\t"):
        if delimiter in line:
            return [w.strip() for w in line.split(delimiter)], delimiter
    return line.split(), None


def read_points(path: str | os.PathLike[str]) -> PointFile:
    """Read rows of points.

    CSV with or without names of columns, blanks or tabs, aerofoils with a title (in one run, or in
    two halves with their counts). ``#`` begins a comment, blank lines separate curves.

    Raises
    ------
    FairingError
        With the line at fault.
    FileError
        When the file cannot be read.
    """
    path = Path(path)
    try:
        text = _bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FairingError(f"error: `{path}` is no text: byte {error.start}") from error
    rows: list[list[float]] = []
    lines: list[int] = []
    starts: list[int] = []
    head: list[str] = []
    comments: list[str] = []
    delimiter: str | None = None
    width = 0
    open_block = False

    def refuse(line: int, what: str) -> FairingError:
        return FairingError(f"error: {path}:{line}: {what}")

    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.split("#", 1)[0].strip()
        if not line:
            if not raw.strip():
                open_block = False
            elif not rows:
                comments.append(raw.rstrip())
            continue
        words, found = _split(line)
        values = [_number(w) for w in words]
        if not rows and any(v is None for v in values):
            # A title may hold numbers, names of columns do not.
            if not head and (found is None or all(v is None for v in values)):
                head.append(raw.rstrip())
                continue
            bad = next(w for w, v in zip(words, values, strict=True) if v is None)
            raise refuse(number, f"expected a number, found `{bad}`")
        if None in values:
            bad = words[values.index(None)]
            what = f"expected a number, found `{bad}`" if bad else "a number is missing"
            raise refuse(number, what)
        numbers = [v for v in values if v is not None]
        for word, value in zip(words, numbers, strict=True):
            if not math.isfinite(value):
                raise refuse(number, f"`{word}` is not finite")
        if not rows:
            if len(numbers) not in (2, 3):
                raise refuse(number, f"expected 2 or 3 columns, found {len(numbers)}")
            width, delimiter = len(numbers), found
        if len(numbers) != width:
            raise refuse(number, f"expected {width} columns, found {len(numbers)}")
        if not open_block:
            starts.append(len(rows))
            open_block = True
        rows.append(numbers)
        lines.append(number)
    if not rows:
        raise FairingError(f"error: there are no points in `{path}`")
    made = PointFile(path, np.array(rows), lines, [], comments + head, delimiter)
    ends = [*starts[1:], len(rows)]
    made.blocks = [range(a, b) for a, b in zip(starts, ends, strict=True)]
    return _halves(made)


def _halves(file: PointFile) -> PointFile:
    """An aerofoil in two halves becomes one run from the upper trailing edge round the nose."""
    if file.width != 2 or len(file.points) < 7:
        return file
    a, b = file.points[0]
    if not (a > 1.5 and b > 1.5 and a == int(a) and b == int(b)):
        return file
    upper, lower = int(a), int(b)
    if upper + lower != len(file.points) - 1:
        return file
    order = [*range(upper, 0, -1), *range(upper + 1, upper + lower + 1)]
    if (file.points[1] == file.points[upper + 1]).all():
        del order[upper]
    file.points = file.points[order]
    file.lines = [file.lines[k] for k in order]
    file.blocks = [range(len(order))]
    file.counts = (upper, lower)
    file.notes.append("the two halves are read as one curve from the upper trailing edge")
    return file


def points_text(points: Floats, like: PointFile | None = None, delimiter: str = ",") -> str:
    """Rows of points as text that reads back to the bit, in the form of a file read."""
    if like is not None:
        join = {None: " ", ",": ", ", ";": "; ", "\t": "\t"}[like.delimiter]
    else:
        join = delimiter + " " if delimiter.strip() else delimiter

    def row(p: Floats) -> str:
        return join.join(repr(float(c) + 0.0) for c in p)

    out = list(like.head) if like else []
    if like is not None and like.counts is not None:
        upper, lower = like.counts
        first, second = points[upper - 1 :: -1][:upper], points[len(points) - lower :]
        counted = [f"{upper}.{join}{lower}.", ""]
        return "\n".join([*out, *counted, *map(row, first), "", *map(row, second), ""])
    blocks = like.blocks if like is not None and len(like.points) == len(points) else []
    if not blocks:
        blocks = [range(len(points))]
    for k, block in enumerate(blocks):
        if k:
            out.append("")
        out += [row(points[i]) for i in block]
    return "\n".join([*out, ""])


def read_numbers(path: str | os.PathLike[str]) -> list[float]:
    """The numbers of a text, in their order: knots, weights. ``#`` begins a comment.

    Raises
    ------
    FairingError
        With the line of a word that is no number.
    FileError
        When the file cannot be read.
    """
    path = Path(path)
    out = []
    for number, line in enumerate(_bytes(path).decode("latin-1").splitlines(), 1):
        for word in line.partition("#")[0].replace(",", " ").replace(";", " ").split():
            value = _number(word)
            if value is None or not math.isfinite(value):
                raise FairingError(f"error: {path}:{number}: expected a number, found `{word}`")
            out.append(value)
    if not out:
        raise FairingError(f"error: `{path}` has no numbers")
    return out


@dataclass
class GridFile:
    """A Plot3D file of surfaces."""

    path: Path
    """Where it was read."""
    grids: list[Floats]
    """Its blocks, ``(m, n, 3)`` each."""
    layout: str
    """``"text"``, ``"stream"`` or ``"records"``."""
    counted: bool = True
    """Whether it begins with the number of blocks."""

    def encoded(self, grids: list[Floats]) -> bytes:
        """The file with other coordinates."""
        sizes = [n for g in grids for n in (g.shape[0], g.shape[1], 1)]
        # i runs fastest, and all x come before all y.
        numbers = [np.ascontiguousarray(np.moveaxis(g, 2, 0).transpose(0, 2, 1)) for g in grids]
        if self.layout == "text":
            out = [f"{len(grids)}"] if self.counted else []
            out += [" ".join(map(str, sizes[k : k + 3])) for k in range(0, len(sizes), 3)]
            for block in numbers:
                flat = [repr(float(x) + 0.0) for x in block.ravel()]
                out += [" ".join(flat[k : k + 4]) for k in range(0, len(flat), 4)]
            return ("\n".join(out) + "\n").encode()
        parts = [struct.pack("<i", len(grids))] if self.counted else []
        parts.append(struct.pack(f"<{len(sizes)}i", *sizes))
        parts += [block.astype("<f8").tobytes() for block in numbers]
        if self.layout == "records":
            parts = [struct.pack("<i", len(p)) + p + struct.pack("<i", len(p)) for p in parts]
        return b"".join(parts)


_GRID_SUFFIXES = {".p3d", ".plot3d", ".xyz", ".x", ".g", ".grd", ".fmt", ".grid"}


def is_grid(path: Path) -> bool:
    """True for a Plot3D grid: by its name, and for names that others use too by its start."""
    if path.suffix.lower() in (".p3d", ".plot3d"):
        return True
    if path.suffix.lower() not in _GRID_SUFFIXES:
        return False
    try:
        with path.open("rb") as file:
            start = file.read(4096)
    except OSError:
        return False
    if b"\0" in start:
        return True
    first = [line.split() for line in start.decode("latin-1").splitlines() if line.strip()][:2]
    # A count of blocks, or sizes: whole numbers alone.
    return bool(first) and len(first[0]) in (1, 3) and all(w.isdigit() for w in first[0])


def read_grids(path: str | os.PathLike[str]) -> GridFile:
    """Read the surfaces of a Plot3D file.

    Text, plain numbers or Fortran records, one block or several, three coordinates.

    Raises
    ------
    FairingError
        When it is no such file, or holds volumes.
    """
    path = Path(path)
    data = _bytes(path)
    if b"\0" not in data[:4096]:
        return _text_grids(path, data)
    for layout in ("stream", "records"):
        for counted in (True, False):
            grids = _binary_grids(data, layout, counted)
            if grids is not None:
                return GridFile(path, _flat(path, grids), layout, counted)
    raise FairingError(
        f"error: `{path}` is no Plot3D grid: its length does not follow from its sizes"
    )


def _flat(path: Path, grids: list[Floats]) -> list[Floats]:
    out = []
    for k, grid in enumerate(grids):
        thick = [axis for axis in range(3) if grid.shape[axis] > 1]
        if len(thick) != 2:
            size = " x ".join(map(str, grid.shape[:3]))
            raise FairingError(f"error: {path}: block {k + 1} is {size}: expected a surface")
        one = next(axis for axis in range(3) if grid.shape[axis] == 1)
        surface = np.ascontiguousarray(np.squeeze(grid, axis=one))
        if not np.isfinite(surface).all():
            raise FairingError(f"error: {path}: block {k + 1} has a point that is not finite")
        out.append(surface)
    return out


def _shaped(sizes: list[int], numbers: Floats) -> Floats:
    ni, nj, nk = sizes
    grid = np.moveaxis(numbers.reshape(3, nk, nj, ni), 0, 3).transpose(2, 1, 0, 3)
    return np.asarray(grid, np.float64)


def _text_grids(path: Path, data: bytes) -> GridFile:
    words: list[str] = []
    lines: list[int] = []
    for number, line in enumerate(data.decode("latin-1").splitlines(), 1):
        own = line.replace(",", " ").split()
        words += own
        lines += [number] * len(own)
    first = data.decode("latin-1").split("\n", 1)[0].split()
    counted = len(first) == 1

    def whole(at: int) -> int:
        if at >= len(words):
            raise FairingError(f"error: `{path}` ends before its sizes do")
        if not words[at].isdigit() or int(words[at]) < 1:
            raise FairingError(f"error: {path}:{lines[at]}: expected a size, found `{words[at]}`")
        return int(words[at])

    blocks = whole(0) if counted else 1
    at = 1 if counted else 0
    if blocks > len(words):
        raise FairingError(f"error: {path}:1: {blocks} blocks do not fit into the file")
    sizes = [[whole(at + 3 * b + c) for c in range(3)] for b in range(blocks)]
    at += 3 * blocks
    grids: list[Floats] = []
    for size in sizes:
        count = 3 * math.prod(size)
        part = words[at : at + count]
        if len(part) < count:
            raise FairingError(
                f"error: `{path}` ends early: expected {count} coordinates of block "
                f"{len(grids) + 1}, found {len(part)}"
            )
        values = [_number(w) for w in part]
        if None in values:
            bad = values.index(None)
            raise FairingError(
                f"error: {path}:{lines[at + bad]}: expected a number, found `{part[bad]}`"
            )
        grids.append(_shaped(size, np.array(values, np.float64)))
        at += count
    if at < len(words):
        raise FairingError(f"error: {path}:{lines[at]}: {len(words) - at} numbers too many")
    return GridFile(path, _flat(path, grids), "text", counted)


def _binary_grids(data: bytes, layout: str, counted: bool) -> list[Floats] | None:
    at = 0

    def take(length: int) -> bytes | None:
        nonlocal at
        if layout == "records":
            if data[at : at + 4] != struct.pack("<i", length):
                return None
            at += 4
        part = data[at : at + length]
        at += length
        if layout == "records":
            if data[at : at + 4] != struct.pack("<i", length):
                return None
            at += 4
        return part if len(part) == length else None

    blocks = 1
    if counted:
        head = take(4)
        if head is None:
            return None
        (blocks,) = struct.unpack("<i", head)
    if not 1 <= blocks <= len(data) // 12 + 1:
        return None
    head = take(12 * blocks)
    if head is None:
        return None
    sizes = np.frombuffer(head, "<i4").reshape(-1, 3)
    if (sizes < 1).any():
        return None
    counts = [3 * math.prod(int(n) for n in own) for own in sizes]
    for width, kind in ((8, "<f8"), (4, "<f4")):
        start = at
        grids: list[Floats] = []
        for own, count in zip(sizes.tolist(), counts, strict=True):
            if count * width > len(data):
                break
            part = take(count * width)
            if part is None:
                break
            numbers = np.frombuffer(part, kind).astype(np.float64)
            grids.append(_shaped(own, numbers))
        if len(grids) == blocks and at == len(data):
            return grids
        at = start
    return None


def write_vts(path: str | os.PathLike[str], points: Floats, fields: dict[str, Any]) -> None:
    """Write a grid of points ``(m, n, 3)`` as a VTK structured grid.

    Fields are ``(m, n)`` or ``(m, n, 3)``.
    """
    from moldloft.files import Output, commit

    path = Path(path)
    commit(path.parent, [Output(path.name, encode_vts(points, fields))])


def encode_vts(points: Floats, fields: dict[str, Any]) -> bytes:
    """The bytes of :func:`write_vts`."""
    m, n = points.shape[:2]
    blob = b""
    arrays = []

    def add(name: str, values: Any) -> str:
        nonlocal blob
        grid = np.asarray(values, np.float64)
        parts = 1 if grid.ndim == 2 else grid.shape[2]
        # i runs fastest.
        data = np.ascontiguousarray(np.swapaxes(grid, 0, 1)).astype("<f8").tobytes()
        offset = len(blob)
        blob += struct.pack("<Q", len(data)) + data
        return (
            f'<DataArray type="Float64" Name="{name}" NumberOfComponents="{parts}" '
            f'format="appended" offset="{offset}"/>\n'
        )

    place = add("Points", points)
    arrays = [add(name, values) for name, values in fields.items()]
    extent = f"0 {m - 1} 0 {n - 1} 0 0"
    head = (
        '<?xml version="1.0"?>\n<VTKFile type="StructuredGrid" version="1.0" '
        'byte_order="LittleEndian" header_type="UInt64">\n'
        f'<StructuredGrid WholeExtent="{extent}">\n<Piece Extent="{extent}">\n'
        f"<PointData>\n{''.join(arrays)}</PointData>\n<Points>\n{place}</Points>\n"
        '</Piece>\n</StructuredGrid>\n<AppendedData encoding="raw">\n_'
    )
    return head.encode() + blob + b"\n</AppendedData>\n</VTKFile>\n"
