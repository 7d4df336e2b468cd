"""Tables of offsets with names: blocks of heights and breadths, sheer and wale, ends of profiles.

The head line names the stations. A row ``Positions`` says where they are, or a block
``FORE-AFT POSITION`` where each line meets them, as its ends do on stem and post. In the blocks
``HEIGHT``, ``BREADTH`` and ``DIAGONAL`` a row is a line: a waterline or a buttock by its place, a
sheer, a wale or a diagonal by its name. Without blocks a table has half-breadths at waterlines, or
heights at rows called buttocks.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from moldloft.errors import FairingError
from moldloft.fairing.cells import Cells, lines_at
from moldloft.fairing.matrix import (
    OffsetTable,
    decimal_commas,
    number_at,
    place_at,
    rows_are_stations,
)
from moldloft.fairing.tables import MISSING, names_axes, spans, unit_named

__all__ = ["blocks"]

_POSITION = re.compile(r"((fore[ -]?(and[ -])?)?aft\s+)?positions?|distances?|x")
_HEIGHT = re.compile(r"heights?( above .*)?")
_BREADTH = re.compile(r"(half[ -]?)?breadths?( from .*)?")
_DIAGONAL = re.compile(r"diagonals?( .*)?")
_KINDS = {"x": _POSITION, "z": _HEIGHT, "y": _BREADTH, "d": _DIAGONAL}

#: Heads of columns with stations, and lines that have names and no places.
_STATIONS = re.compile(r"(stations?|st|sta|frames?|ordinates?)\.?")
_LINES = re.compile(
    r"\b(sheer|wale|deck|rail|chine|knuckle|gunwale|bulwark|rabbet|fairbody|margin|clamp)\b"
)
_WITH_AXIS = re.compile(r"(.*?)[\s,:(]*\b(heights?|half[ -]?breadths?|breadths?)\)?")
_BUTTOCK = re.compile(r"\bbutt(ock)?s?\b")
_ENDS = re.compile(r"\b(stem|post|stern|sternpost|transom|bow|rudder|profile)\b")
_UNIT = re.compile(r"[(\[]([^)\]]*)[)\]]")


@dataclass
class _Cell:
    text: str
    line: int
    start: int
    end: int


@dataclass
class _Row:
    """A line of the table: its block, its name, and a cell for each station."""

    kind: str
    label: str
    line: int
    cells: list[_Cell | None]


@dataclass
class _Grid:
    """A table with a row for each line, independent of its layout in the file."""

    names: list[str]
    head: int
    corner: str
    rows: list[_Row] = field(default_factory=list)


def _kind_of(text: str) -> str | None:
    """The block that a heading begins: positions x, breadths y, heights z, diagonals d."""
    bare = _UNIT.sub("", text).strip(" :.").lower()
    return next((kind for kind, words in _KINDS.items() if words.fullmatch(bare)), None)


def _cells_of(lines: list[str], starts: list[int], k: int) -> list[_Cell]:
    out = []
    for a, b in spans(lines[k]):
        raw = lines[k][a:b]
        bare = raw.strip('"').strip()
        shift = raw.find(bare) if bare else 0
        start = starts[k] + a + shift
        out.append(_Cell(bare, k + 1, start, start + len(bare)))
    return out


def _named(label: str, comma: bool) -> bool:
    return place_at(label, comma) is None and _LINES.search(label.lower()) is not None


def _grid(rows: list[list[_Cell]], comma: bool, above: str) -> _Grid | None:
    """The table with its lines in rows, if it has blocks, positions or lines by name."""
    head = rows[0]
    if len(head) < 4:
        return None
    corner, heads = head[0], head[1:]
    if place_at(corner.text, comma) is not None:
        # The row of a station, whose `x` is a missing cell.
        return None
    blocks = [k for k, row in enumerate(rows) if k and len(_filled(row)) == 1 and row[0].text]
    blocks = [k for k in blocks if _kind_of(rows[k][0].text)]
    positions = len(rows) > 1 and len(_filled(rows[1])) > 1 and _kind_of(rows[1][0].text) == "x"
    stations = _STATIONS.fullmatch(_UNIT.sub("", corner.text).strip().lower()) is not None
    if stations and (blocks or positions):
        return _by_lines(rows, comma)
    by_rows = rows_are_stations(corner.text, above)
    # Columns that name axes have an offset in each row.
    long = names_axes(",".join(cell.text for cell in head))
    if long or by_rows is None or not all(row[0].text for row in rows):
        return None
    if by_rows:
        odd = [c for c in heads if c.text and place_at(c.text, comma) is None]
        if odd and all(_kind_of(c.text) == "x" or _named(c.text, comma) for c in odd):
            return _turned(rows)
        return None
    odd = [row[0] for row in rows[1:] if place_at(row[0].text, comma) is None]
    known = (_kind_of(c.text) == "x" or _named(c.text, comma) for c in odd)
    return _by_lines(rows, comma) if odd and all(known) else None


def _filled(row: list[_Cell]) -> list[_Cell]:
    return [cell for cell in row if cell.text]


def _by_lines(rows: list[list[_Cell]], comma: bool) -> _Grid:
    head = rows[0]
    grid = _Grid([c.text for c in head[1:]], head[0].line, head[0].text)
    buttocks = _BUTTOCK.search(head[0].text.lower()) is not None
    kind = "z" if buttocks else "y"
    for row in rows[1:]:
        first = row[0]
        said = _kind_of(first.text)
        if said and len(_filled(row)) == 1:
            kind = said
            continue
        own: list[_Cell | None] = list(row[1:])
        if len(own) > len(grid.names):
            raise FairingError(
                f"line {first.line}: expected {len(grid.names)} cells after `{first.text}`, "
                f"found {len(own)}"
            )
        own += [None] * (len(grid.names) - len(own))
        grid.rows.append(_row(said or kind, first, own, comma, stated=said is not None))
    return grid


def _turned(rows: list[list[_Cell]]) -> _Grid:
    """The grid of a table with a row for each station."""
    head = rows[0]
    grid = _Grid([row[0].text for row in rows[1:]], head[0].line, head[0].text)
    for k, label in enumerate(head[1:], 1):
        for row in rows[1:]:
            if len(row) > len(head):
                raise FairingError(
                    f"line {row[0].line}: expected {len(head)} cells, found {len(row)}"
                )
        own = [row[k] if k < len(row) else None for row in rows[1:]]
        said = _kind_of(label.text)
        grid.rows.append(_row(said or "y", label, own, comma=False, stated=said is not None))
    return grid


def _row(kind: str, label: _Cell, cells: list[_Cell | None], comma: bool, *, stated: bool) -> _Row:
    """A row of a block; a label may name another axis, as in `sheer height` or `buttock 1`."""
    text = label.text
    if not stated and kind in "yz":
        with_axis = _WITH_AXIS.fullmatch(text.lower())
        if with_axis and with_axis[1]:
            kind = "z" if with_axis[2].startswith("height") else "y"
            text = text[: len(with_axis[1])]
        elif _BUTTOCK.search(text.lower()):
            kind = "z"
    return _Row(kind, text, label.line, cells)


def blocks(text: str) -> OffsetTable | None:
    r"""The offsets of a table whose stations or lines have names, if the text is one.

    Raises
    ------
    FairingError
        With the line of a cell that is not a length, or of a station without a position.

    Examples
    --------
    >>> table = blocks(
    ...     "Stations,A,B,C,D\nPositions,0,1,2,3\nHEIGHT\nSheer,9,8,8,9\n"
    ...     "BREADTH\nSheer,1,2,2,1\nWL 4,0,1,1,x\n"
    ... )
    >>> [(name, len(own)) for name, own in table.curves][:2]
    [('sheer', 4), ('WL 4', 3)]
    >>> table.motions[0], table.point_names[5]
    ('yz', 'station B, WL 4')
    """
    lines, starts = lines_at(text)
    used = [k for k, s in enumerate(lines) if s.strip() and not s.startswith("#")]
    comma = decimal_commas(text)
    for n, k in enumerate(used[:12]):
        rows = [_cells_of(lines, starts, j) for j in used[n:]]
        above = " ".join(lines[j] for j in used[:n])
        if len(rows) < 3 or rows_are_stations(rows[0][0].text, "") is None:
            continue
        grid = _grid(rows, comma, above)
        if grid is not None:
            return _Reading(text, grid, comma, f"{above} {lines[k]}").table()
    return None


class _Reading:
    """Converts a grid of names to offsets, lines and cells."""

    def __init__(self, text: str, grid: _Grid, comma: bool, head: str) -> None:
        self.grid, self.comma = grid, comma
        self.out = OffsetTable([], [], Cells(text), comma=comma)
        self.out.motions, self.out.curves = [], []
        self.out.unit = next((u for w in _UNIT.findall(head) if (u := unit_named(w))), None)
        self.of_station: dict[int, list[int]] = {}
        self.lacking: list[str] = []

    def value(self, cell: _Cell | None) -> float | None:
        """The length in a cell; ``None`` for a missing one."""
        if cell is None or cell.text in MISSING:
            return None
        value = number_at(cell.text, self.comma)
        if value is None:
            raise FairingError(f"line {cell.line}: expected an offset, found `{cell.text}`")
        self.out.inches |= bool(re.fullmatch(r"[-\u2212]?\d+-\d+-\d+.?|.*['\u2032].*", cell.text))
        return value

    def table(self) -> OffsetTable:
        self._positions()
        rows = [row for row in self.grid.rows if row.kind != "x"]
        named: dict[str, dict[str, _Row]] = {}
        for row in rows:
            place = place_at(row.label, self.comma)
            if row.kind == "d" or place is None:
                own = named.setdefault(("diagonal " if row.kind == "d" else "") + row.label, {})
                if row.kind in own:
                    raise FairingError(f"line {row.line}: a second row of `{row.label}`")
                own[row.kind] = row
        done: set[str] = set()
        places: dict[tuple[str, float], int] = {}
        for row in rows:
            place = place_at(row.label, self.comma)
            name = ("diagonal " if row.kind == "d" else "") + row.label
            if name in named:
                if name not in done:
                    done.add(name)
                    self._by_name(name, named[name])
                continue
            assert place is not None
            if (row.kind, place) in places:
                at = places[row.kind, place]
                raise FairingError(f"line {row.line}: a second row of {row.label}, as in line {at}")
            places[row.kind, place] = row.line
            self._by_place(row, place)
        self._stations()
        if self.out.inches:
            self.out.notes.append("lengths in feet, inches and eighths are read as inches")
        if self.lacking:
            self.out.notes.append(
                f"no position at {', '.join(dict.fromkeys(self.lacking))}: left out there"
            )
        self._ordered()
        return self.out

    def _positions(self) -> None:
        """Positions of stations, and of single lines on them."""
        names = self.grid.names
        rows = [row for row in self.grid.rows if row.kind == "x"]
        if any(re.search(r"['\u2032]|\d-\d+-\d", name) for name in names):
            self.out.inches = True
        whole = [row for row in rows if _kind_of(row.label) == "x"]
        self.lines_x = {
            row.label.lower(): [self.value(cell) for cell in row.cells]
            for row in rows
            if row not in whole
        }
        if len(whole) > 1:
            raise FairingError(f"line {whole[1].line}: a second row of positions")
        self.common = bool(whole)
        self.x: list[float | None] = []
        for k, name in enumerate(names):
            if whole:
                at = self.value(whole[0].cells[k])
                if at is None:
                    raise FairingError(f"line {whole[0].line}: the position of `{name}` is missing")
                self.x.append(at)
            elif self.lines_x:
                self.x.append(self._common(k, name, rows))
            else:
                at = place_at(name, self.comma)
                if at is None:
                    raise FairingError(
                        f"line {self.grid.head}: expected the place of a station, found `{name}`: "
                        "a row `Positions` says where stations with names are"
                    )
                self.x.append(at)

    def _common(self, k: int, name: str, rows: list[_Row]) -> float | None:
        """The position of a station; a stem or a post has another one for each line."""
        own = Counter(x[k] for x in self.lines_x.values() if x[k] is not None)
        if not own:
            return None
        at, count = own.most_common(1)[0]
        if len(own) == 1:
            return at
        if 2 * count <= own.total() or _ENDS.search(name.lower()):
            return None
        odd = next(row for row in rows if self.lines_x[row.label.lower()][k] not in (None, at))
        cell, usual = (
            odd.cells[k],
            next(row.cells[k] for row in rows if self.lines_x[row.label.lower()][k] == at),
        )
        assert cell is not None and usual is not None
        raise FairingError(
            f"line {cell.line}: station `{name}` is at {usual.text}, and at {cell.text} for "
            f"`{odd.label}`"
        )

    def _at(self, label: str, k: int) -> float | None:
        """The position of a line at a station."""
        own = self.lines_x.get(label.lower())
        if own is not None:
            return own[k]
        if self.x[k] is None:
            self.lacking.append(f"{self.grid.names[k]}, {label}")
        return self.x[k]

    def _add(
        self, k: int, line: str, point: Sequence[float], cells: list[tuple[int, _Cell]]
    ) -> int:
        """Adds an offset; it and others at the same position become fixed."""
        out = self.out
        assert out.motions is not None
        row = len(out.points)
        for axis, cell in cells:
            out.cells.places.append((cell.start, cell.end))
            out.cells.owners.append((row, axis))
        station = self.grid.names[k]
        station = station if _STATIONS.match(station.lower()) else f"station {station}"
        name = self.grid.names[k].lower() if self._is_end(k) else station
        out.points.append((point[0], point[1], point[2]))
        out.lines.append(cells[0][1].line)
        out.motions.append("" if self._is_end(k) else "".join("xyz"[axis] for axis, _ in cells))
        out.point_names.append(f"{name}, {line}")
        return row

    def _is_end(self, k: int) -> bool:
        return self.x[k] is None or _ENDS.search(self.grid.names[k].lower()) is not None

    def _by_place(self, row: _Row, place: float) -> None:
        """A waterline or a buttock."""
        word = "waterline" if row.kind == "y" else "buttock"
        bare = re.fullmatch(r"[\d.,'\u2032\"\u2033+/ \u00bc-\u00be-]+", row.label)
        name = f"{word} {row.label}" if bare else row.label
        own = []
        for k, cell in enumerate(row.cells):
            offset = self.value(cell)
            if offset is None or cell is None:
                continue
            if self.common and self._is_end(k):
                # The common position is that of the sheer: others end elsewhere on a stem.
                self.lacking.append(f"{self.grid.names[k]}, {name}")
                continue
            x = self._at(row.label, k)
            if x is None:
                continue
            axis = 1 if row.kind == "y" else 2
            point = (x, offset, place) if axis == 1 else (x, place, offset)
            own.append(self._add(k, name, point, [(axis, cell)]))
            if not self._is_end(k):
                self.of_station.setdefault(k, []).append(own[-1])
        self._line(name, own)

    def _by_name(self, name: str, rows: dict[str, _Row]) -> None:
        """A sheer of heights and half-breadths, or one of a single view; a diagonal."""
        called = name.lower() if name.isupper() or name.istitle() else name
        single = len(rows) == 1
        if "d" in rows:
            called = f"{name} (expanded)"
        elif single:
            called += " (profile)" if "z" in rows else " (plan)"
        own = []
        label = next(iter(rows.values())).label
        for k in range(len(self.grid.names)):
            found = {kind: (row.cells[k], self.value(row.cells[k])) for kind, row in rows.items()}
            have = [
                (kind, c, v) for kind, (c, v) in found.items() if c is not None and v is not None
            ]
            if len(have) < len(rows):
                continue
            x = self._at(label, k)
            if x is None:
                continue
            point, cells = [x, 0.0, 0.0], []
            for kind, cell, value in sorted(have, key=lambda h: h[0]):
                axis = 2 if kind == "z" else 1
                point[axis] = value
                cells.append((axis, cell))
            own.append(self._add(k, called, point, cells))
            if not single and not self._is_end(k):
                self.of_station.setdefault(k, []).append(own[-1])
        if single:
            self.out.notes.append(
                f"{called}: one view alone, faired in its plane and not part of the stations"
            )
        self._line(called, own)

    def _line(self, name: str, own: list[int]) -> None:
        """A line along the ship, in the order of its stations."""
        assert self.out.curves is not None
        points = self.out.points
        self.out.curves.append((name, sorted(own, key=lambda i: points[i][0])))

    def _stations(self) -> None:
        """Stations, each from the keel up."""
        out = self.out
        assert out.curves is not None and out.motions is not None
        for k, own in sorted(self.of_station.items()):
            name = self.grid.names[k]
            name = name if _STATIONS.match(name.lower()) else f"station {name}"
            kept: list[int] = []
            for i in sorted(own, key=lambda i: out.points[i][:0:-1]):
                if kept and out.points[kept[-1]] == out.points[i]:
                    # Two lines cross in one place: their offsets hold each other.
                    for j in (kept[-1], i):
                        out.motions[j] = ""
                    continue
                kept.append(i)
            out.curves.append((name, kept))

    def _ordered(self) -> None:
        """Stations in order, as far as they have positions."""
        known = [(k, x) for k, x in enumerate(self.x) if x is not None]
        rises = Counter(b > a for (_, a), (_, b) in pairwise(known))
        if len(rises) > 1:
            usual = rises.most_common(1)[0][0]
            k = next(
                n for n in range(1, len(known)) if (known[n][1] > known[n - 1][1]) is not usual
            )
            names = self.grid.names
            raise FairingError(
                f"line {self.grid.head}: station `{names[known[k][0]]}` at {known[k][1]:g} is out "
                f"of order after `{names[known[k - 1][0]]}` at {known[k - 1][1]:g}"
            )
