"""Files of points and grids, read with the line of every fault."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import FairingError, FileError, FormatError
from moldloft.fairing.matrix import matrix
from moldloft.fairing.tables import Cells, plain, spans
from moldloft.files import Output, commit
from moldloft.grids import Plot3DVariant, decode_plot3d, encode_plot3d
from moldloft.storage import read_bytes

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
    inches: bool = False
    """Whether lengths were in feet, inches and eighths; they are inches here."""
    unit: str | None = None
    """The unit of length that the file states, of feet, inches and eighths inches."""
    comma: bool = False
    """Whether numbers had decimal commas."""
    offsets: bool = False
    """Whether it is a table of offsets: stations, half-breadths and heights. Its blocks are then
    the stations and the waterlines, which share their points."""
    moves: int = 1
    """The coordinate that a table of offsets gives: 1, half-breadths at stations and waterlines, or
    2, heights at stations and buttocks."""
    table: Floats | None = None
    """The rows of a table of offsets as they were."""
    places: list[int] = field(default_factory=list)
    """Of each row of the curves the row of the table."""
    matrix: Cells | None = None
    """Where the offsets stand in a table with a row for each waterline or station."""
    named: Cells | None = None
    """Where x, y and z of each row stand in a table whose columns have names."""

    @property
    def width(self) -> int:
        """The number of columns."""
        return int(self.points.shape[1])


def _bytes(path: Path) -> bytes:
    return read_bytes(path)


def read_points(path: str | os.PathLike[str], data: bytes | None = None) -> PointFile:
    """Read rows of points.

    CSV with or without names of columns, blanks or tabs, aerofoils with a title (in one run, or in
    two halves with their counts) and prose after the points, decimal commas, lengths in feet,
    inches and eighths (``4-5-1``). Columns named x, y and z, or station, half-breadth and height,
    are taken by name; the rows of the latter are a table of offsets. ``#`` begins a comment, blank
    lines separate curves. Of ``data``, the bytes of a file, the path is only its name.

    Raises
    ------
    FairingError
        With the line at fault.
    FileError
        When the file cannot be read.
    """
    path = Path(path)
    data = _bytes(path) if data is None else data
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    try:
        table = matrix(text)
    except FairingError as error:
        raise FairingError(f"{path}: {error}") from error
    if table is not None:
        offsets, lines, where, inches = table
        if len({s for s, *_ in offsets}) > 1:
            said = ["lengths in feet, inches and eighths are read as inches"] if inches else []
            rows = np.array(offsets)
            comma = any("," in where.lines[k][a:b] for k, a, b in where.places)
            file = PointFile(
                path,
                rows,
                lines,
                [range(len(rows))],
                [],
                notes=said,
                inches=inches,
                unit="in" if inches else where.unit,
                comma=comma,
            )
            file.moves = 2 if where.heights else 1
            return replace(_as_offsets(file), matrix=where)
    try:
        made = plain(text)
        rows, found = _core.read_points(made.text.encode())
    except FormatError as error:
        raise _at(path, error) from error
    except FairingError as error:
        raise FairingError(f"{path}: {error}") from error
    halves = found["halves"]
    notes = ["the two halves are read as one curve from the upper trailing edge"] if halves else []
    file = PointFile(
        path,
        np.ascontiguousarray(rows[:, : found["columns"]]),
        found["lines"],
        [range(first, end) for first, end in found["blocks"]],
        found["head"] if made.head is None else made.head,
        found["delimiter"],
        halves,
        made.notes + notes,
        made.inches,
        "in" if made.inches else made.unit,
        made.comma,
    )
    file.moves = 2 if made.heights else 1
    if made.axes is not None:
        file.named = _named_cells(text, file.lines, made.axes)
    return _as_offsets(file) if made.stations and file.width == 3 else file


def _named_cells(text: str, lines: list[int], axes: list[int]) -> Cells | None:
    """Where the coordinates of rows stand in a text."""
    whole = text.lstrip("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    places = []
    for line in lines:
        found = spans(whole[line - 1])
        if len(found) <= max(axes):
            return None
        places += [(line - 1, *found[at]) for at in axes]
    return Cells(whole, places)


def _as_offsets(file: PointFile) -> PointFile:
    """A table of offsets as the curves of its stations and waterlines, or buttocks."""
    table = file.points
    other = 3 - file.moves
    by_station: dict[float, list[int]] = {}
    by_level: dict[float, list[int]] = {}
    for k, row in enumerate(table.tolist()):
        by_station.setdefault(row[0], []).append(k)
        by_level.setdefault(row[other], []).append(k)
    if len(by_station) < 2 or max(map(len, by_station.values())) < 2:
        return file
    seen: dict[tuple[float, float], int] = {}
    for k, row in enumerate(table.tolist()):
        place = (row[0], row[other])
        if place in seen:
            first = seen[place]
            at = f"{file.path}:{file.lines[k]}"
            if (table[first] == table[k]).all():
                raise FairingError(f"{at}: the same offset as line {file.lines[first]}")
            names = ("buttock", "height") if file.moves == 2 else ("height", "half-breadth")
            raise FairingError(
                f"{at}: a second {names[1]} at station {row[0]:g}, {names[0]} {row[other]:g}: "
                f"{row[file.moves]:g}, and {table[first, file.moves]:g} in line {file.lines[first]}"
            )
        seen[place] = k
    stations = list(by_station)
    rises = [b > a for a, b in itertools.pairwise(stations)]
    if not (all(rises) or not any(rises)):
        k = next(k for k in range(1, len(rises)) if rises[k] != rises[0]) + 1
        line = file.lines[by_station[stations[k]][0]]
        raise FairingError(
            f"{file.path}:{line}: station {stations[k]:g} is out of order after {stations[k - 1]:g}"
        )
    lists = list(by_station.values())
    for rows in by_level.values():
        lists.append(sorted(rows, key=lambda k: table[k, 0]))
    long = [rows for rows in lists if len(rows) >= 5]
    short = len(lists) - len(long)
    if not long:
        raise FairingError(f"{file.path}: none of the curves has 5 points")
    notes = list(file.notes)
    if short:
        notes.append(
            f"{short} {'curve' if short == 1 else 'curves'} with fewer than 5 points: not faired"
        )
    places = [k for rows in long for k in rows]
    ends = list(itertools.accumulate(map(len, long)))
    return replace(
        file,
        points=np.ascontiguousarray(table[places]),
        lines=[file.lines[k] for k in places],
        blocks=[range(end - len(rows), end) for end, rows in zip(ends, long, strict=True)],
        notes=notes,
        offsets=True,
        table=table,
        places=places,
    )


def _at(path: Path, error: FormatError) -> FairingError:
    """The same fault with its place in the file."""
    what = f"expected {error.expected}, found {error.found}"
    if error.place == "line":
        return FairingError(f"{path}:{error.number}: {what}")
    return FairingError(f"`{path}` is no {error.format} grid: {error.place} {error.number}: {what}")


def points_text(points: Floats, like: PointFile | None = None, delimiter: str = ",") -> str:
    """Rows of points as text that reads back to the bit, in the form of a file read."""
    given = None if like is None else like.points if like.table is None else like.table
    if like is not None and like.matrix is not None and given is not None:
        still = [0, 3 - like.moves]
        if (points[:, still] != given[:, still]).any():
            raise FairingError(
                "the stations and levels of such a table stay: without --along and --box, or an "
                "ending of another form"
            )
        pairs = zip(points[:, like.moves], given[:, like.moves], strict=True)
        return like.matrix.written([None if y == old else _cell(y, like) for y, old in pairs])
    alike = given is not None and np.shape(points) == np.shape(given)
    if like is not None and like.named is not None and given is not None and alike:
        # Cells whose number did not change stay as they were written.
        each = zip(np.ravel(points), np.ravel(given), strict=True)
        return like.named.written([None if x == old else _cell(x, like) for x, old in each])
    if like is not None and (like.inches or like.comma):
        return _own_form(points, like)
    own = delimiter if like is None else (like.delimiter or " ")
    separator = own + " " if own.strip() else own
    head = like.head if like else []
    halves = like.counts if like else None
    blocks = [(block.start, block.stop) for block in like.blocks] if like else []
    rows = np.ascontiguousarray(points, dtype=np.float64)
    return _core.points_text(rows, separator, head, blocks, halves)


def _cell(x: float, like: PointFile) -> str:
    if like.inches:
        return sixteenths(x)
    text = repr(float(x) + 0.0)
    return text.replace(".", ",") if like.comma else text


def sixteenths(inches: float) -> str:
    """A length in feet, inches and eighths, to the nearest sixteenth.

    Examples
    --------
    >>> sixteenths(53.125), sixteenths(54.0625), sixteenths(-0.26)
    ('4-5-1', '4-6-0+', '-0-0-2')
    """
    count = round(16 * abs(inches))
    feet, rest = divmod(count, 192)
    whole, parts = divmod(rest, 16)
    sign = "-" if inches < 0 and count else ""
    return f"{sign}{feet}-{whole}-{parts // 2}{'+' if parts % 2 else ''}"


def _own_form(points: Floats, like: PointFile) -> str:
    """Rows with decimal commas, or in feet, inches and eighths."""
    separator = {"\t": "\t", None: " "}.get(like.delimiter, "; " if like.comma else ", ")
    lines = [line.removeprefix("# ") if like.inches else line for line in like.head]
    starts = {block.start for block in like.blocks} - {0}
    for k, row in enumerate(points):
        if k in starts and not like.offsets:
            lines.append("")
        lines.append(separator.join(_cell(x, like) for x in row))
    return "\n".join(lines) + "\n"


def read_numbers(path: str | os.PathLike[str]) -> list[float]:
    """The numbers of a text, in their order: knots, weights. ``#`` begins a comment.

    Raises
    ------
    FairingError
        With the line of a word that is not a number.
    FileError
        When the file cannot be read.
    """
    path = Path(path)
    out = []
    for number, line in enumerate(_bytes(path).decode("latin-1").splitlines(), 1):
        for word in line.partition("#")[0].replace(",", " ").replace(";", " ").split():
            try:
                value = float(word.replace("D", "E").replace("d", "e"))
            except ValueError:
                value = math.nan
            if not math.isfinite(value):
                raise FairingError(f"{path}:{number}: expected a number, found `{word}`")
            out.append(value)
    if not out:
        raise FairingError(f"`{path}` has no numbers")
    return out


@dataclass
class GridFile:
    """A Plot3D file of surfaces."""

    path: Path
    """Where it was read."""
    grids: list[Floats]
    """Its blocks, ``(m, n, 3)`` each."""
    variant: Plot3DVariant
    """What Plot3D leaves open."""
    iblank: list[NDArray[np.int32]] | None = None
    """A whole number for each point of each block, if the file has them."""

    @property
    def layout(self) -> str:
        """``"text"``, ``"stream"`` or ``"records"``."""
        return self.variant.layout

    @property
    def counted(self) -> bool:
        """Whether it begins with the number of blocks."""
        return self.variant.multi

    def __post_init__(self) -> None:
        if isinstance(self.variant, str):
            message = "GridFile takes a moldloft.grids.Plot3DVariant in place of a layout"
            warnings.warn(message, DeprecationWarning, stacklevel=3)
            self.variant = Plot3DVariant(layout=self.variant)

    def encoded(self, grids: Sequence[Floats]) -> bytes:
        """The file with other coordinates; :meth:`write` takes its place."""
        message = "GridFile.encoded is GridFile.write, or moldloft.grids.encode_plot3d"
        warnings.warn(message, DeprecationWarning, stacklevel=2)
        return self._encoded(grids)

    def write(self, path: str | os.PathLike[str], grids: Sequence[Floats]) -> Path:
        """Write other coordinates in the same variant, in double precision.

        A third coordinate is added where the file has two and the points need it; blanking is kept
        where the blocks have as many points as those read.
        """
        path = Path(path)
        commit(path.parent, [Output(path.name, self._encoded(grids))], make=False)
        return path

    def _encoded(self, grids: Sequence[Floats]) -> bytes:
        flat = all((grid[..., 2] == 0).all() for grid in grids)
        variant = replace(self.variant, double=True, three=self.variant.three or not flat)
        blanks = self.iblank
        if blanks is not None and [b.shape for b in blanks] != [g.shape[:2] for g in grids]:
            blanks = None
        return encode_plot3d(grids, variant, iblank=blanks)


_GRID_SUFFIXES = {".p3d", ".plot3d", ".xyz", ".x", ".g", ".grd", ".fmt", ".grid"}


def is_grid(path: Path) -> bool:
    """True for a Plot3D grid: by its name, and for names that others use too by its start."""
    if path.suffix.lower() in (".p3d", ".plot3d"):
        return True
    if path.suffix.lower() not in _GRID_SUFFIXES:
        return False
    try:
        data = read_bytes(path)
    except FileError:
        return False
    start = data[:4096]
    if b"\0" in start:
        return True
    first = [line.split() for line in start.decode("latin-1").splitlines() if line.strip()][:2]
    # A count of blocks, or sizes: whole numbers alone.
    whole = bool(first) and all(w.isdigit() for w in first[0])
    if whole and len(first[0]) == 2:
        # Two sizes or a point: a grid has as many numbers as its sizes ask for.
        try:
            decode_plot3d(data)
        except FormatError:
            return False
        return True
    return whole and len(first[0]) in (1, 3)


def read_grids(path: str | os.PathLike[str]) -> GridFile:
    """Read the surfaces of a Plot3D file of any variant, see :func:`moldloft.grids.read_plot3d`.

    Raises
    ------
    FairingError
        When it is not such a file, or holds volumes.
    """
    path = Path(path)
    try:
        blocks, variant, iblank = decode_plot3d(_bytes(path))
    except FormatError as error:
        raise _at(path, error) from error
    surfaces = []
    for k, grid in enumerate(blocks):
        size = grid.shape[:-1] if grid.ndim == 4 else (*grid.shape[:-1], 1)
        if sum(n > 1 for n in size) != 2:
            sizes = " x ".join(map(str, size))
            raise FairingError(f"{path}: block {k + 1} is {sizes}: expected a surface")
        one = size.index(1)
        whole = grid.reshape(*size, 3)
        surfaces.append(np.ascontiguousarray(np.squeeze(whole, axis=one)))
        if iblank is not None:
            iblank[k] = np.squeeze(iblank[k].reshape(size), axis=one)
    return GridFile(path, surfaces, variant, iblank)


def write_vts(path: str | os.PathLike[str], points: Floats, fields: dict[str, Any]) -> None:
    """Write a grid of points ``(m, n, 3)`` as a VTK structured grid.

    Fields are ``(m, n)`` or ``(m, n, 3)``.
    """

    def shaped(values: Any) -> Floats:
        grid = np.asarray(values, np.float64)
        return np.ascontiguousarray(grid.reshape(*grid.shape[:2], 1, -1))

    path = Path(path)
    named = [(name, shaped(values)) for name, values in fields.items()]
    data = _core.grid_with_fields(shaped(points), named)
    commit(path.parent, [Output(path.name, data)], make=False)


explain(globals())
