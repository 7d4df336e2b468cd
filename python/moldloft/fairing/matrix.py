"""Tables of offsets as matrices: a row for each waterline or station, a column for each other."""

from __future__ import annotations

import re

from moldloft.errors import FairingError
from moldloft.fairing.tables import (
    MISSING,
    SEPARATORS,
    Cells,
    length,
    names_axes,
    spans,
    unit_named,
)

__all__ = ["matrix"]

_LABEL = re.compile(r"(?:[A-Za-z.]+\s*)?(\S.*)")
_STATION = re.compile(r"\b(stations?|st|sta|frames?|ordinates?)\b")
_LEVEL = re.compile(r"\b(waterlines?|wl|heights?|levels?|z|buttocks?)\b")
_BRACKETS = re.compile(r"[(\[]([^)\]]*)[)\]]")
_BUTTOCK = re.compile(r"\bbuttocks?\b")


def _number(cell: str, comma: bool) -> float | None:
    return length(cell.replace(",", ".") if comma else cell)


def _place(cell: str, comma: bool) -> float | None:
    """The place that a head of a column or the label of a row says: `0.5`, `WL 0.5`, `0.5 m`."""
    value = _number(cell, comma)
    if value is not None:
        return value
    found = _LABEL.fullmatch(cell)
    bare = found[1] if found else cell
    for text in (bare, cell):
        number, _, word = text.rpartition(" ")
        if number and unit_named(word) is not None:
            return _place(number, comma)
    return _number(bare, comma)


def _header(line: str, comma: bool) -> tuple[str, list[float]] | None:
    """The corner and the values of a head line: a word (or nothing) and four numbers or more.

    Raises
    ------
    FairingError
        When all but a few of its cells say a place.
    """
    cells = [line[a:b].strip('"').strip() for a, b in spans(line)]
    if any(sign in line for sign in SEPARATORS):
        corner, values = cells[0], [_place(c, comma) for c in cells[1:]]
        if _place(corner, comma) is not None:
            return None
        known = [v for v in values if v is not None]
        if len(known) < 4:
            return None
        if len(known) < len(values):
            if _rows_are_stations(corner, "") is None:
                return None
            odd = cells[1 + values.index(None)]
            raise FairingError(
                f"expected the place of a column, such as 0.5 or WL 0.5, found `{odd}`: "
                "a sheer or a profile is a curve of its own"
            )
        return corner, known
    values = [_number(c, comma) for c in cells[1:]]
    if len(values) < 4 or any(v is None for v in values):
        # Blanks separate the words of a corner, too.
        numbers = [k for k, c in enumerate(cells) if _number(c, comma) is None]
        last = numbers[-1] if numbers else -1
        values = [_number(c, comma) for c in cells[last + 1 :]]
        if last < 0 or len(values) < 4:
            return None
        return " ".join(cells[: last + 1]), [v for v in values if v is not None]
    if _number(cells[0], comma) is not None:
        return None
    return cells[0], [v for v in values if v is not None]


def _rows_are_stations(corner: str, above: str) -> bool | None:
    """Whether rows are stations, by the word of the corner, or by what precedes the table."""
    for text in (corner.lower(), above.lower()):
        station, level = _STATION.search(text), _LEVEL.search(text)
        if station and level:
            # As in `waterline \ station`: rows first.
            return station.start() < level.start()
        if station or level:
            return station is not None
    return None


def matrix(text: str) -> tuple[list[tuple[float, float, float]], list[int], Cells, bool] | None:
    r"""The offsets of a table with a row for each waterline or station, if the text is one.

    Returned are rows of station, half-breadth and height; their lines, from 1; where they stand in
    the text; whether lengths were in feet, inches and eighths. The first cell of the head line says
    what the rows are: ``waterline``, ``buttock`` (its cells are heights) or ``station``; cells
    ``x``, ``-`` or nothing are missing.

    Raises
    ------
    FairingError
        With the line of a cell that cannot be read as a length, or of a row of another width.

    Examples
    --------
    >>> rows, *_ = matrix("waterline; 0; 1; 2; 3\n0.5; 0; 1; 1.5; x\n1; 0.1; 1.2; 1.6; 1.7\n")
    >>> rows[2], len(rows)
    ((1.0, 1.0, 0.5), 7)
    """
    lines = text.lstrip("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    used = [k for k, s in enumerate(lines) if s.strip() and not s.startswith("#")]
    comma = ";" in text and not re.search(r"\d\.\d", text) and bool(re.search(r"\d,\d", text))
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
    stations = _rows_are_stations(corner, above)
    if stations is None:
        raise FairingError(
            f"line {head + 1}: a matrix of offsets? its first cell says what the rows are: "
            "`waterline`, `buttock` or `station`"
        )
    title = f"{above} {corner}".lower()
    heights = _BUTTOCK.search(title) is not None and not re.search(r"\b(waterlines?|wl)\b", title)
    inches = any("-" in lines[head][a:b] for a, b in spans(lines[head])[1:])
    try:
        unit = _unit(lines[head], above)
    except FairingError as error:
        raise FairingError(f"line {head + 1}: {error}") from error
    rows: list[tuple[float, float, float]] = []
    where: list[int] = []
    places: list[tuple[int, int, int]] = []
    seen: set[float] = set()
    for k in below:
        found_at = spans(lines[k])
        cells = [lines[k][a:b].strip('"').strip() for a, b in found_at]
        # Words before the value of a row, as in `WL 0.5`.
        words = 1
        if _number(cells[0], comma) is None and len(cells) > 1 and " " not in cells[0]:
            words = 2 if len(cells) == len(across) + 2 else 1
        label = cells[words - 1]
        value = _place(label, comma)
        if value is None:
            raise FairingError(f"line {k + 1}: expected the value of a row, found `{cells[0]}`")
        if value in seen:
            raise FairingError(f"line {k + 1}: a second row of {value:g}")
        seen.add(value)
        own = found_at[words:]
        if len(own) > len(across):
            raise FairingError(
                f"line {k + 1}: expected {len(across)} offsets at most, found {len(own)}"
            )
        for at, (a, b) in zip(across, own, strict=False):
            cell = lines[k][a:b].strip('"').strip()
            if cell in MISSING:
                continue
            breadth = _number(cell, comma)
            if breadth is None:
                raise FairingError(f"line {k + 1}: expected an offset, found `{cell}`")
            inches |= bool(re.fullmatch(r"-?\d+-\d+-\d+.?", cell))
            station, level = (value, at) if stations else (at, value)
            rows.append((station, level, breadth) if heights else (station, breadth, level))
            where.append(k + 1)
            places.append((k, a, b))
    order = sorted(range(len(rows)), key=lambda i: _order(rows, i, across, stations))
    return (
        [rows[i] for i in order],
        [where[i] for i in order],
        Cells(lines, [places[i] for i in order], heights, unit),
        inches,
    )


def _unit(head: str, above: str) -> str | None:
    """The unit of the heads of columns, or that stands in brackets: `0.5 m`, `station (m)`."""
    cells = [head[a:b].strip('"').strip() for a, b in spans(head)]
    behind = [cell.rpartition(" ")[2] for cell in cells[1:] if " " in cell]
    words = behind + _BRACKETS.findall(f"{above} {cells[0]}")
    units = {unit for word in words if (unit := unit_named(word))}
    if len(units) > 1:
        raise FairingError(f"places in {' and '.join(sorted(units))}: expected one unit")
    return units.pop() if units else None


def _order(
    rows: list[tuple[float, float, float]], i: int, across: list[float], stations: bool
) -> tuple[int, int]:
    """Station after station, in the order of the table."""
    if stations:
        return (0, i)
    return (across.index(rows[i][0]), i)
