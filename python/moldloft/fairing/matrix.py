"""Tables of offsets as matrices: a row for each waterline or station, a column for each other."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from moldloft.errors import FairingError
from moldloft.fairing.cells import SEPARATORS, Cells, lines_at
from moldloft.fairing.tables import MISSING, length, names_axes, spans, unit_named

__all__ = ["OffsetTable", "decimal_commas", "matrix", "number_at", "place_at", "rows_are_stations"]

_LABEL = re.compile(r"(?:[A-Za-z.]+\s*)?(\S.*)")
_STATION = re.compile(r"\b(stations?|st|sta|frames?|ordinates?)\b")
_LEVEL = re.compile(r"\b(waterlines?|wl|heights?|levels?|z|buttocks?)\b")
_BRACKETS = re.compile(r"[(\[]([^)\]]*)[)\]]")
_BUTTOCK = re.compile(r"\bbuttocks?\b")
_BUTTOCK_LABEL = re.compile(r"butt", re.IGNORECASE)


@dataclass
class OffsetTable:
    """A table of offsets, as read."""

    points: list[tuple[float, float, float]]
    """Station, half-breadth and height of each offset."""
    lines: list[int]
    """The line of each offset, from 1."""
    cells: Cells
    """Its cells, whose owners are the offsets."""
    heights: bool = False
    """True if all offsets are heights at buttocks, not half-breadths at waterlines."""
    unit: str | None = None
    """The unit that it states."""
    inches: bool = False
    """True if lengths are in feet, inches and eighths."""
    comma: bool = False
    """True for decimal commas."""
    stations: dict[float, str] = field(default_factory=dict)
    """Names of stations by position."""
    levels: dict[float, str] = field(default_factory=dict)
    """Names of waterlines or buttocks by position."""
    curves: list[tuple[str, list[int]]] | None = None
    """Lines by name with their offsets; ``None`` where stations and levels are all."""
    motions: list[str] | None = None
    """Axes along which each offset moves, such as ``"y"``, ``"yz"`` or nothing."""
    point_names: list[str] = field(default_factory=list)
    """Names of the offsets."""
    notes: list[str] = field(default_factory=list)
    """Notes about the table for the user."""


def number_at(cell: str, comma: bool) -> float | None:
    """The length in a cell; ``None`` if it is not a length.

    Parameters
    ----------
    cell
        The cell without blanks round it.
    comma
        True for decimal commas.
    """
    return length(cell.replace(",", ".") if comma else cell)


def place_at(cell: str, comma: bool) -> float | None:
    """The position in a column head or row label: `0.5`, `WL 0.5`, `0.5 m`.

    Parameters
    ----------
    cell
        The cell without blanks round it.
    comma
        True for decimal commas.
    """
    value = number_at(cell, comma)
    if value is not None:
        return value
    found = _LABEL.fullmatch(cell)
    bare = found[1] if found else cell
    for text in (bare, cell):
        number, _, word = text.rpartition(" ")
        if number and unit_named(word) is not None:
            return place_at(number, comma)
    return number_at(bare, comma)


def _header(line: str, comma: bool) -> tuple[str, list[float]] | None:
    """The corner and the values of a head line: a word (or nothing) and four numbers or more.

    Raises
    ------
    FairingError
        If nearly all, but not all, of its cells are positions.
    """
    cells = [line[a:b].strip('"').strip() for a, b in spans(line)]
    if any(sign in line for sign in SEPARATORS):
        corner, values = cells[0], [place_at(c, comma) for c in cells[1:]]
        if place_at(corner, comma) is not None:
            return None
        known = [v for v in values if v is not None]
        if len(known) < 4:
            return None
        if len(known) < len(values):
            if rows_are_stations(corner, "") is None:
                return None
            odd = cells[1 + values.index(None)]
            raise FairingError(
                f"expected the place of a column, such as 0.5 or WL 0.5, found `{odd}`: "
                "a sheer or a profile is a curve of its own"
            )
        return corner, known
    values = [number_at(c, comma) for c in cells[1:]]
    if len(values) < 4 or any(v is None for v in values):
        # Blanks separate the words of a corner, too.
        numbers = [k for k, c in enumerate(cells) if number_at(c, comma) is None]
        last = numbers[-1] if numbers else -1
        values = [number_at(c, comma) for c in cells[last + 1 :]]
        if last < 0 or len(values) < 4:
            return None
        return " ".join(cells[: last + 1]), [v for v in values if v is not None]
    if number_at(cells[0], comma) is not None:
        return None
    return cells[0], [v for v in values if v is not None]


def rows_are_stations(corner: str, above: str) -> bool | None:
    """True if rows are stations, according to the corner cell or the text before the table.

    Parameters
    ----------
    corner, above
        The first cell of the head line; the text before it.
    """
    for text in (corner.lower(), above.lower()):
        station, level = _STATION.search(text), _LEVEL.search(text)
        if station and level:
            # As in `waterline \ station`: rows first.
            return station.start() < level.start()
        if station or level:
            return station is not None
    return None


def decimal_commas(text: str) -> bool:
    """True if a table has decimal commas.

    Parameters
    ----------
    text
        The table.
    """
    apart = any(";" in line or "\t" in line.strip() for line in text.splitlines())
    return apart and not re.search(r"\d\.\d", text) and bool(re.search(r"\d,\d", text))


def matrix(text: str) -> OffsetTable | None:
    r"""The offsets of a table with a row for each waterline or station, if the text is one.

    The first cell of the head line states the type of the rows: ``waterline``, ``buttock`` (its
    cells are heights) or ``station``; cells ``x``, ``-`` and empty cells are missing values.

    Raises
    ------
    FairingError
        With the line of a cell that cannot be read as a length, or of a row of another width.

    Examples
    --------
    >>> table = matrix("waterline; 0; 1; 2; 3\n0.5; 0; 1; 1.5; x\n1; 0.1; 1.2; 1.6; 1.7\n")
    >>> table.points[2], len(table.points)
    ((1.0, 1.0, 0.5), 7)
    """
    lines, starts = lines_at(text)
    used = [k for k, s in enumerate(lines) if s.strip() and not s.startswith("#")]
    comma = decimal_commas(text)
    head = None
    for k in used[:12]:
        try:
            if _header(lines[k], comma):
                head = k
        except FairingError as error:
            raise FairingError(f"line {k + 1}: {error}") from error
        if head is not None or names_axes(lines[k]):
            break
    if head is None or used.index(head) + 2 >= len(used):
        return None
    if any(names_axes(lines[k]) for k in used if k < head):
        return None
    made = _header(lines[head], comma)
    assert made is not None
    corner, across = made
    below = [k for k in used if k > head]
    # A table of points by names of columns has no numbers in its head; a matrix has a label a row.
    first = [lines[below[0]][a:b] for a, b in spans(lines[below[0]])]
    if len(first) < 4 or len(first) > len(across) + 2:
        return None
    above = " ".join(lines[k] for k in used if k < head)
    stations = rows_are_stations(corner, above)
    if stations is None:
        raise FairingError(
            f"line {head + 1}: a matrix of offsets? its first cell says what the rows are: "
            "`waterline`, `buttock` or `station`"
        )
    title = f"{above} {corner}".lower()
    heights = _BUTTOCK.search(title) is not None and not re.search(r"\b(waterlines?|wl)\b", title)
    heads = [lines[head][a:b].strip('"').strip() for a, b in spans(lines[head])][-len(across) :]
    labels = heads if stations else [lines[k].strip(' "') for k in below]
    heights |= all(_BUTTOCK_LABEL.match(label) for label in labels)
    out = OffsetTable([], [], Cells(text), heights=heights)
    out.inches = any("-" in cell.lstrip("-") for cell in heads if number_at(cell, comma))
    try:
        out.unit = _unit(lines[head], above)
    except FairingError as error:
        raise FairingError(f"line {head + 1}: {error}") from error
    of_heads, of_rows = (out.levels, out.stations) if stations else (out.stations, out.levels)
    of_heads.update(zip(across, heads, strict=True))
    for k in below:
        found_at = spans(lines[k])
        cells = [lines[k][a:b].strip('"').strip() for a, b in found_at]
        # Words before the value of a row, as in `WL 0.5`.
        words = 1
        if number_at(cells[0], comma) is None and len(cells) > 1 and " " not in cells[0]:
            words = 2 if len(cells) == len(across) + 2 else 1
        value = place_at(cells[words - 1], comma)
        if value is None:
            raise FairingError(f"line {k + 1}: expected the value of a row, found `{cells[0]}`")
        if value in of_rows:
            raise FairingError(f"line {k + 1}: a second row of {value:g}")
        of_rows[value] = " ".join(cells[:words])
        own = found_at[words:]
        if len(own) > len(across):
            raise FairingError(
                f"line {k + 1}: expected {len(across)} offsets at most, found {len(own)}"
            )
        for at, (a, b) in zip(across, own, strict=False):
            a, b = _unquoted(lines[k], a, b)
            cell = lines[k][a:b]
            if cell in MISSING:
                continue
            offset = number_at(cell, comma)
            if offset is None:
                raise FairingError(f"line {k + 1}: expected an offset, found `{cell}`")
            out.inches |= bool(re.fullmatch(r"-?\d+-\d+-\d+.?", cell))
            out.comma |= "," in cell
            station, level = (value, at) if stations else (at, value)
            point = (station, level, offset) if heights else (station, offset, level)
            out.cells.places.append((starts[k] + a, starts[k] + b))
            out.points.append(point)
            out.lines.append(k + 1)
    if not stations:
        # Station after station, in the order of the table.
        column = {x: at for at, x in enumerate(across)}
        order = sorted(range(len(out.points)), key=lambda i: (column[out.points[i][0]], i))
        out.points = [out.points[i] for i in order]
        out.lines = [out.lines[i] for i in order]
        out.cells.places = [out.cells.places[i] for i in order]
    axis = 2 if heights else 1
    out.cells.owners = [(row, axis) for row in range(len(out.points))]
    return out


def _unquoted(line: str, start: int, end: int) -> tuple[int, int]:
    """The span of a cell within its quotes."""
    cell = line[start:end]
    if len(cell) > 1 and cell[0] == cell[-1] == '"':
        inner = cell[1:-1]
        start += 1 + len(inner) - len(inner.lstrip())
        return start, start + len(inner.strip())
    return start, end


def _unit(head: str, above: str) -> str | None:
    """The unit in column heads, also in brackets: `0.5 m`, `station (m)`."""
    cells = [head[a:b].strip('"').strip() for a, b in spans(head)]
    behind = [cell.rpartition(" ")[2] for cell in cells[1:] if " " in cell]
    words = behind + _BRACKETS.findall(f"{above} {cells[0]}")
    units = {unit for word in words if (unit := unit_named(word))}
    if len(units) > 1:
        raise FairingError(f"positions in {' and '.join(sorted(units))}: expected one unit")
    return units.pop() if units else None
