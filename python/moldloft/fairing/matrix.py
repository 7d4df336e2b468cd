"""Tables of offsets as matrices: a row for each waterline or station, a column for each other."""

from __future__ import annotations

import re

from moldloft.errors import FairingError
from moldloft.fairing.tables import MISSING, Cells, length, names_axes, spans

__all__ = ["matrix"]

_LABEL = re.compile(r"(?:[A-Za-z.]+\s*)?(\S.*)")
_STATION = re.compile(r"\b(stations?|st|sta|frames?|ordinates?)\b")
_LEVEL = re.compile(r"\b(waterlines?|wl|heights?|levels?|z|buttocks?)\b")
_BUTTOCK = re.compile(r"\bbuttocks?\b")


def _number(cell: str, comma: bool) -> float | None:
    return length(cell.replace(",", ".") if comma else cell)


def _header(line: str, comma: bool) -> tuple[str, list[float]] | None:
    """The corner and the values of a head line: a word (or nothing) and four numbers or more."""
    cells = [line[a:b].strip('"').strip() for a, b in spans(line)]
    values = [_number(c, comma) for c in cells[1:]]
    if len(values) < 4 or any(v is None for v in values):
        # Blanks separate the words of a corner, too.
        numbers = [k for k, c in enumerate(cells) if _number(c, comma) is None]
        last = numbers[-1] if numbers else -1
        values = [_number(c, comma) for c in cells[last + 1 :]]
        if any(sign in line for sign in ";\t,") or last < 0 or len(values) < 4:
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
    head = next((k for k in used[:12] if _header(lines[k], comma)), None)
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
        value = _number(label, comma)
        if value is None and (found := _LABEL.fullmatch(label)):
            value = _number(found[1], comma)
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
        Cells(lines, [places[i] for i in order], heights),
        inches,
    )


def _order(
    rows: list[tuple[float, float, float]], i: int, across: list[float], stations: bool
) -> tuple[int, int]:
    """Station after station, in the order of the table."""
    if stations:
        return (0, i)
    return (across.index(rows[i][0]), i)
