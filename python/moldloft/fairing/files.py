"""Files of points and grids, read with the line of every fault."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.budget import limited
from moldloft.errors import FairingError, FileError, FormatError
from moldloft.exchange.files import Output, commit
from moldloft.fairing.blocks import blocks
from moldloft.fairing.cells import Cells, lines_at, rounded, step_of, written_as
from moldloft.fairing.matrix import OffsetTable, matrix
from moldloft.fairing.tables import plain, spans
from moldloft.grids import Plot3DVariant, decode_plot3d, encode_plot3d
from moldloft.storage import read_bytes

if TYPE_CHECKING:
    import os

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "GridFile",
    "PointFile",
    "cell_texts",
    "is_grid",
    "points_text",
    "read_grids",
    "read_numbers",
    "read_points",
    "write_vts",
]


#: The fewest points of a curve that is faired.
FEWEST = 5


@dataclass
class PointFile:
    """A file of points: rows of two or three numbers."""

    path: Path
    """Path of the file."""
    points: Floats
    """All rows in the order of the curve, ``(n, 2)`` or ``(n, 3)``."""
    lines: list[int]
    """The line of each row, from 1."""
    blocks: list[range]
    """Runs of rows that blank lines separate."""
    head: list[str]
    """Title or names of columns, comments."""
    delimiter: str | None = None
    """Separator of columns; ``None`` for blanks."""
    counts: tuple[int, int] | None = None
    """Numbers of points of the halves of an aerofoil, if each starts at the leading edge."""
    notes: list[str] = field(default_factory=list)
    """Notes from reading."""
    inches: bool = False
    """True if lengths were in feet, inches and eighths; they are inches here."""
    unit: str | None = None
    """The unit of length that the file states, of feet, inches and eighths inches."""
    comma: bool = False
    """True if numbers had decimal commas."""
    offsets: bool = False
    """True if it is a table of offsets: stations, half-breadths and heights. Its blocks are then
    the stations and the waterlines, which share their points."""
    moves: int = 1
    """The coordinate that a table of offsets gives: 1, half-breadths at stations and waterlines, or
    2, heights at stations and buttocks."""
    table: Floats | None = None
    """The original rows of a table of offsets."""
    places: list[int] = field(default_factory=list)
    """Row in the table of each row of the curves."""
    cells: Cells | None = None
    """The cells of the coordinates of rows, in a table of offsets or of named columns."""
    fixed_stations: bool = False
    """True if the rows of a single curve are stations with one offset each."""
    names: list[str] = field(default_factory=list)
    """Names of the curves of a table of offsets."""
    point_names: list[str] = field(default_factory=list)
    """Names of the rows of a table of offsets."""
    motions: list[str] | None = None
    """Axes in which each row of a table moves, such as ``"y"`` or ``"yz"``, where these differ."""
    encoding: str = "utf-8"
    """The encoding of the file."""

    @property
    def width(self) -> int:
        """The number of columns."""
        return int(self.points.shape[1])


def _bytes(path: Path) -> bytes:
    return read_bytes(path)


@limited
def read_points(path: str | os.PathLike[str], data: bytes | None = None) -> PointFile:
    """Read rows of points.

    CSV with or without names of columns, blanks or tabs, aerofoils with a title (in one run, or in
    two halves with their counts) and prose after the points, decimal commas, lengths in feet,
    inches and eighths (``4-5-1``). Columns named x, y and z, or station, half-breadth and height,
    are taken by name; rows with the latter form a table of offsets. ``#`` begins a comment, blank
    lines separate curves. Of ``data``, the bytes of a file, the path is only its name.

    Raises
    ------
    FairingError
        With the line at fault.
    FileError
        If the file cannot be read.
    """
    path = Path(path)
    data = _bytes(path) if data is None else data
    _refuse_binary(path, data)
    encoding = "utf-8"
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        encoding = "latin-1"
        text = data.decode(encoding)
    try:
        table = blocks(text) or matrix(text)
    except FairingError as error:
        raise FairingError(f"{path}: {error}") from error
    if table is not None and len({s for s, *_ in table.points}) > 1:
        return _of_table(path, table, encoding)
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
        encoding=encoding,
    )
    file.moves = 2 if made.heights else 1
    if made.axes is not None:
        file.cells = _named_cells(text, file.lines, made.axes)
    if made.stations and file.width == 3:
        return _as_offsets(file)
    file.fixed_stations = made.stations
    return file


_WORKBOOKS = (".xlsx", ".xlsm", ".xls", ".ods")


def _refuse_binary(path: Path, data: bytes) -> None:
    """Workbooks and other binary files are rejected by name."""
    zipped = data.startswith(b"PK\x03\x04")
    compound = data.startswith(b"\xd0\xcf\x11\xe0")
    if path.suffix.lower() in _WORKBOOKS:
        if zipped or compound:
            raise FairingError(f"`{path}` is a workbook: save its sheet as CSV")
        raise FairingError(f"`{path}` is text and no workbook: give it the ending .csv")
    if zipped or compound or b"\0" in data[:4096]:
        raise FairingError(f"`{path}` is not text: expected rows of points")


def _of_table(path: Path, table: OffsetTable, encoding: str) -> PointFile:
    """A table of offsets with its names and cells."""
    said = ["lengths in feet, inches and eighths are read as inches"] if table.inches else []
    file = PointFile(
        path,
        np.array(table.points),
        table.lines,
        [range(len(table.points))],
        [],
        notes=table.notes or said,
        inches=table.inches,
        unit="in" if table.inches else table.unit,
        comma=table.comma,
        cells=table.cells,
        encoding=encoding,
    )
    file.moves = 2 if table.heights else 1
    if table.curves is not None:
        file.point_names, file.motions = table.point_names, table.motions
        return _of_curves(file, table.curves)
    return _as_offsets(file, table.stations, table.levels)


def _named_cells(text: str, lines: list[int], axes: list[int]) -> Cells | None:
    """The cells of the coordinates of rows in a text."""
    whole, starts = lines_at(text)
    cells = Cells(text)
    for row, line in enumerate(lines):
        found = spans(whole[line - 1])
        if len(found) <= max(axes):
            return None
        for axis, at in enumerate(axes):
            a, b = found[at]
            cells.places.append((starts[line - 1] + a, starts[line - 1] + b))
            cells.owners.append((row, axis))
    return cells


def _as_offsets(
    file: PointFile,
    stations: dict[float, str] | None = None,
    levels: dict[float, str] | None = None,
) -> PointFile:
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
            said = ("buttock", "height") if file.moves == 2 else ("height", "half-breadth")
            raise FairingError(
                f"{at}: a second {said[1]} at station {row[0]:g}, {said[0]} {row[other]:g}: "
                f"{row[file.moves]:g}, and {table[first, file.moves]:g} in line {file.lines[first]}"
            )
        seen[place] = k
    order = list(by_station)
    falling = _falling(table, by_level.values())
    if falling is not None:
        # A level may begin at a station before those of the first.
        order.sort(reverse=falling)
        by_station = {x: by_station[x] for x in order}
    rises = [b > a for a, b in itertools.pairwise(order)]
    if not (all(rises) or not any(rises)):
        k = next(k for k in range(1, len(rises)) if rises[k] != rises[0]) + 1
        line = file.lines[by_station[order[k]][0]]
        raise FairingError(
            f"{file.path}:{line}: station {order[k]:g} is out of order after {order[k - 1]:g}"
        )
    word = "buttock" if file.moves == 2 else "waterline"
    stations = _written(file, 0, by_station) if stations is None else stations
    levels = _written(file, other, by_level) if levels is None else levels
    names = {x: _name("station", stations.get(x, f"{x:g}")) for x in by_station}
    level_names = {z: _name(word, levels.get(z, f"{z:g}")) for z in by_level}
    curves = [(names[x], rows) for x, rows in by_station.items()]
    for z, rows in by_level.items():
        curves.append((level_names[z], sorted(rows, key=lambda k: table[k, 0])))
    file.point_names = [f"{names[row[0]]}, {level_names[row[other]]}" for row in table.tolist()]
    return _of_curves(file, curves)


def _falling(table: Floats, levels: Iterable[list[int]]) -> bool | None:
    """True or false if a table has level after level, all with falling or all with rising stations.

    ``None`` if it does not.
    """
    own = [np.array(rows) for rows in levels]
    if any((np.diff(rows) != 1).any() for rows in own):
        return None
    falls = np.concatenate([np.diff(table[rows, 0]) for rows in own]) < 0
    return bool(falls[0]) if len(falls) and (falls == falls[0]).all() else None


def _written(file: PointFile, axis: int, groups: dict[float, list[int]]) -> dict[float, str]:
    """The positions along an axis as written in the table."""
    if file.cells is None:
        return {}
    at = {owner: k for k, owner in enumerate(file.cells.owners)}
    return {
        place: file.cells.cell(at[rows[0], axis]).strip('"')
        for place, rows in groups.items()
        if (rows[0], axis) in at
    }


def _name(word: str, label: str) -> str:
    """The name of a line: its label, with a word before a mere number."""
    return label if label[:1].isalpha() else f"{word} {label}"


def _of_curves(file: PointFile, curves: list[tuple[str, list[int]]]) -> PointFile:
    """A table of offsets as the curves through its rows."""
    table = file.points
    long = [(name, rows) for name, rows in curves if len(rows) >= FEWEST]
    if not long:
        raise FairingError(f"{file.path}: no curve has {FEWEST} points")
    notes = list(file.notes)
    short = [name for name, rows in curves if 0 < len(rows) < FEWEST]
    if short:
        listed = ", ".join(short[:4]) + (" ..." if len(short) > 4 else "")
        notes.append(
            f"{len(short)} {'curve' if len(short) == 1 else 'curves'} with fewer than {FEWEST} "
            f"points: not faired ({listed})"
        )
    places = [k for _, rows in long for k in rows]
    ends = list(itertools.accumulate(len(rows) for _, rows in long))
    return replace(
        file,
        points=np.ascontiguousarray(table[places]),
        lines=[file.lines[k] for k in places],
        blocks=[range(end - len(own), end) for end, (_, own) in zip(ends, long, strict=True)],
        names=[name for name, _ in long],
        notes=notes,
        offsets=True,
        table=table,
        places=places,
    )


def _at(path: Path, error: FormatError) -> FairingError:
    """The error with its position in the file."""
    what = f"expected {error.expected}, found {error.found}"
    if error.place == "line":
        return FairingError(f"{path}:{error.number}: {what}")
    return FairingError(
        f"`{path}` is not a valid {error.format} grid: {error.place} {error.number}: {what}"
    )


def points_text(
    points: Floats,
    like: PointFile | None = None,
    delimiter: str = ",",
    *,
    tol: Floats | float | None = None,
    step: float | None = None,
) -> str:
    """Rows of points as text, in the form of a file read.

    A table of offsets is written to its own digit (see :func:`~moldloft.fairing.cells.step_of`),
    and stays within the tolerance. Other numbers read back to the bit.

    Parameters
    ----------
    points
        ``(n, 2)`` or ``(n, 3)``: the rows of the curve, or of the table.
    like
        The file read. Cells whose number did not change stay as they were written.
    delimiter
        Separator of columns without a file.
    tol
        The tolerance, or that of each row.
    step
        The step to which numbers are rounded; 0 for all digits.
    """
    given = None if like is None else like.points if like.table is None else like.table
    alike = given is not None and np.shape(points) == np.shape(given)
    if like is not None and like.cells is not None and given is not None and alike:
        return like.cells.written(cell_texts(points, like, tol, step))
    if like is not None and like.table is not None:
        raise FairingError("the rows of a table of offsets are as many as were read")
    if step and given is not None and alike:
        most = np.broadcast_to(np.inf if tol is None else tol, len(points))
        pairs = zip(points, given, most, strict=True)
        points = np.array([_rounded_point(p, q, step, float(t)) for p, q, t in pairs])
    if like is not None and (like.inches or like.comma):
        return _own_form(points, like)
    own = delimiter if like is None else (like.delimiter or " ")
    separator = own + " " if own.strip() else own
    head = like.head if like else []
    halves = like.counts if like else None
    blocks = [(block.start, block.stop) for block in like.blocks] if like else []
    rows = np.ascontiguousarray(points, dtype=np.float64)
    return _core.points_text(rows, separator, head, blocks, halves)


def _rounded_point(point: Floats, given: Floats, step: float, tol: float) -> Floats:
    """A point rounded in each coordinate, within the tolerance of its distance."""
    pairs = list(zip(point.tolist(), given.tolist(), strict=True))
    near = np.array([b if a == b else rounded(a, b, step, np.inf) for a, b in pairs])
    if np.linalg.norm(near - given) <= tol * (1 + 1e-12):
        return near
    # Each coordinate towards the one read: then no distance grows.
    return np.array([b if a == b else rounded(a, b, step, abs(a - b)) for a, b in pairs])


def cell_texts(
    points: Floats, like: PointFile, tol: Floats | float | None = None, step: float | None = None
) -> list[str | None]:
    """Texts of the changed cells of a table; ``None`` for unchanged ones.

    Parameters
    ----------
    points
        The rows of the table, as many as were read.
    like
        The file read, with cells.
    tol, step
        See :func:`points_text`.

    Raises
    ------
    FairingError
        If a coordinate changed that has no cell.
    """
    cells, given = like.cells, like.points if like.table is None else like.table
    if cells is None:
        raise FairingError(f"`{like.path}` is not a table with cells")
    changed = {(int(k), int(axis)) for k, axis in np.argwhere(points != given)}
    if beyond := changed - set(cells.owners):
        row, axis = min(beyond)
        name = like.point_names[row] if like.point_names else f"row {row + 1}"
        raise FairingError(
            f"{name}: {'xyz'[axis]} moved, and the table has no cell for it: stations and levels "
            "stay without --along, --across and --box"
        )
    most = np.broadcast_to(np.inf if tol is None else tol, len(points))
    moving = [cells.cell(k) for k, owner in enumerate(cells.owners) if owner in changed]
    if step is None:
        positive = [float(t) for t in most if t > 0]
        step = step_of(moving, min(positive, default=np.inf)) if like.offsets else 0.0
    at_step = points.copy()
    for row in {row for row, _ in changed} if step else ():
        at_step[row] = _rounded_point(points[row], given[row], step, float(most[row]))
    texts: list[str | None] = []
    for k, (row, axis) in enumerate(cells.owners):
        new = float(at_step[row, axis])
        same = new == given[row, axis]
        texts.append(None if same else written_as(new, cells.cell(k), step))
    return texts


def _own_form(points: Floats, like: PointFile) -> str:
    """Rows with decimal commas, or in feet, inches and eighths."""
    separator = {"\t": "\t", None: " "}.get(like.delimiter, "; " if like.comma else ", ")
    lines = [line.removeprefix("# ") if like.inches else line for line in like.head]
    starts = {block.start for block in like.blocks} - {0}
    form = "0-0-0" if like.inches else "0,0" if like.comma else "0"
    for k, row in enumerate(points):
        if k in starts and not like.offsets:
            lines.append("")
        lines.append(separator.join(written_as(x, form, 0.0) for x in row))
    return "\n".join(lines) + "\n"


@limited
def read_numbers(path: str | os.PathLike[str]) -> list[float]:
    """The numbers of a text, in their order: knots, weights. ``#`` begins a comment.

    Raises
    ------
    FairingError
        With the line of a word that is not a number.
    FileError
        If the file cannot be read.
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
    """Path of the file."""
    grids: list[Floats]
    """Its blocks, ``(m, n, 3)`` each."""
    variant: Plot3DVariant
    """Variant of the Plot3D format."""
    iblank: list[NDArray[np.int32]] | None = None
    """A whole number for each point of each block, if the file has them."""

    @property
    def layout(self) -> str:
        """``"text"``, ``"stream"`` or ``"records"``."""
        return self.variant.layout

    @property
    def counted(self) -> bool:
        """True if it begins with the number of blocks."""
        return self.variant.multi

    def write(self, path: str | os.PathLike[str], grids: Sequence[Floats]) -> Path:
        """Write other coordinates in the same variant, in double precision.

        A third coordinate is added if the points need it; blanking is kept if the number of points
        is unchanged.
        """
        path = Path(path)
        flat = all((grid[..., 2] == 0).all() for grid in grids)
        variant = replace(self.variant, double=True, three=self.variant.three or not flat)
        blanks = self.iblank
        if blanks is not None and [b.shape for b in blanks] != [g.shape[:2] for g in grids]:
            blanks = None
        data = encode_plot3d(grids, variant, iblank=blanks)
        commit(path.parent, [Output(path.name, data)], make=False)
        return path


_GRID_SUFFIXES = {".p3d", ".plot3d", ".xyz", ".x", ".g", ".grd", ".fmt", ".grid"}


def is_grid(path: Path) -> bool:
    """True for a Plot3D grid, by its name or, for ambiguous names, by its first bytes."""
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


@limited
def read_grids(path: str | os.PathLike[str]) -> GridFile:
    """Read the surfaces of a Plot3D file of any variant, see :func:`moldloft.grids.read_plot3d`.

    Raises
    ------
    FairingError
        If it is not such a file, or contains volumes.
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
