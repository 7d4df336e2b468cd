"""Tables of offsets as offices write them, drawn at random, against the numbers drawn."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from moldloft.fairing.files import PointFile, points_text, read_points

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

SCALES = {None: 1.0, "m": 1.0, "cm": 1.0, "ft": 1.0, "in": 1.0, "mm": 1000.0}
LABELS = {"station": "St ", "waterline": "WL ", "wl": "WL ", "buttock": "Buttock "}


@dataclass
class Drawn:
    """A table and the offsets in it, by station and level."""

    text: str
    offsets: dict[tuple[float, float], float]
    unit: str | None
    heights: bool


class Writer:
    """The forms in which one table writes its numbers and missing cells."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.notation = self.pick("plain", "plain", "plain", "comma", "eighths")
        units = (None, "m", "mm", "cm", "ft", "in")
        self.unit = None if self.notation == "eighths" else self.pick(*units)
        self.step = 1 / 16 if self.notation == "eighths" else 1.0 if self.unit == "mm" else 0.01
        self.scale = 12.0 if self.notation == "eighths" else SCALES[self.unit]
        signs = (";", "\t") if self.notation == "comma" else (",", ";", "\t", "|", ", ", "; ")
        self.sign = self.pick(*signs)

    def pick(self, *choices: Any) -> Any:
        return choices[int(self.rng.integers(len(choices)))]

    def number(self, value: float, *, place: bool = False) -> str:
        if self.notation == "eighths":
            return self.eighths(value)
        short = place and self.rng.random() < 0.5
        text = f"{value:.0f}" if self.unit == "mm" else f"{value:g}" if short else f"{value:.2f}"
        return text.replace(".", ",") if self.notation == "comma" else text

    def eighths(self, inches: float) -> str:
        """Feet, inches and eighths; an odd sixteenth has + or -."""
        count, mark = round(16 * abs(inches)), ""
        if count % 2:
            up = self.rng.random() < 0.5
            count, mark = (count - 1, "+") if up else (count + 1, "-")
        feet, rest = divmod(count, 192)
        sign = "-" if inches < 0 else ""
        return f"{sign}{feet}-{rest // 16}-{rest % 16 // 2}{mark}"

    def missing(self) -> str:
        return str(self.pick("x", "-", "n/a") if not self.sign.strip("\t") else
                   self.pick("x", "-", "", "\u2013"))  # fmt: skip


def drawn(seed: int) -> Drawn:
    """A hull at random stations and levels, as a matrix or a list of one of many forms."""
    rng = np.random.default_rng([6, seed])
    w = Writer(rng)
    stations = np.cumsum(rng.choice([0.5, 1, 1, 2], int(rng.integers(5, 9))))
    stations = (stations - stations[0]) * w.scale
    levels = np.cumsum(rng.choice([0.25, 0.5, 0.5, 1], int(rng.integers(5, 8)))) * w.scale
    if rng.random() < 0.3:
        stations = stations[::-1].copy()
    u, v = stations[:, None] / stations.max(), levels[None] / w.scale
    offsets = (1 + np.sin(2.5 * u + 0.3) * (1 - np.exp(-v))) * w.scale
    offsets = np.round(offsets / w.step) * w.step
    if rng.random() < 0.15:
        offsets[0] *= -1
    gone = {(int(rng.integers(1, len(stations) - 1)), 0) for _ in range(int(rng.integers(3)))}
    heights = bool(rng.random() < 0.25)
    level = "buttock" if heights else w.pick("waterline", "waterline", "wl")
    make = matrix if rng.random() < 0.6 else table_list
    lines, unit = make(w, (stations, levels, offsets), gone, level)
    if rng.random() < 0.3:
        lines.insert(0, "# Hull 7")
    if make is matrix and rng.random() < 0.2:
        lines.insert(0, "Motor yacht")
    if rng.random() < 0.2:
        lines = [line + w.pick("", " ", "  ") if w.sign != "\t" else line for line in lines]
    if rng.random() < 0.15:
        lines.insert(len(lines) // 2, "# checked")
    end = w.pick("\n", "\n", "\r\n")
    text = w.pick("", "", "\ufeff") + end.join(lines) + w.pick(end, "")
    there = {
        (s, z): offsets[i, j]
        for i, s in enumerate(stations)
        for j, z in enumerate(levels)
        if (i, j) not in gone
    }
    return Drawn(text, there, "in" if w.notation == "eighths" else unit, heights)


def matrix(w: Writer, table: Any, gone: set[tuple[int, int]], level: str) -> Any:
    """A row for each station or level, with labels and units in some of the heads."""
    stations, levels, offsets = table
    by_stations = w.rng.random() < 0.5
    mark = w.pick("", f" ({w.unit})", f" [{w.unit}]") if w.unit else ""
    name = "station" if by_stations else level
    corner = name.capitalize() if w.rng.random() < 0.3 else name
    if by_stations and level == "buttock":
        corner = w.pick("station \\ buttock", "station/buttock")
    other = level if by_stations else "station"
    label, row_label = (LABELS[n] if w.rng.random() < 0.3 else "" for n in (other, name))
    behind = f" {w.unit}" if w.unit and not mark and w.rng.random() < 0.4 else ""
    rows, heads = (stations, levels) if by_stations else (levels, stations)
    places = [label + w.number(h, place=True) + behind for h in heads]
    lines = [w.sign.join([corner + mark, *places])]
    for a, row in enumerate(rows):
        cells = [row_label + w.number(row, place=True)]
        for b in range(len(heads)):
            i, j = (a, b) if by_stations else (b, a)
            cells.append(w.missing() if (i, j) in gone else w.number(offsets[i, j]))
        lines.append(w.sign.join(cells))
    return lines, w.unit if mark or behind else None


def table_list(w: Writer, table: Any, gone: set[tuple[int, int]], level: str) -> Any:
    """A row for each offset, with columns in any order, some of them without a meaning."""
    stations, levels, offsets = table
    mark = w.pick("", f" ({w.unit})", f" [{w.unit}]") if w.unit else ""
    breadths = ("half-breadth", "Half-breadth", "offset", "half_breadth")
    names = {
        "s": w.pick("station", "Station", "STATION"),
        "l": w.pick(level, level.capitalize()),
        "o": "height" if level == "buttock" else w.pick(*breadths),
    }
    columns = [*names, *(c for c in ("no", "remark") if w.rng.random() < 0.3)]
    columns = w.rng.permutation(columns).tolist()
    lines = [w.sign.join(names.get(c, c) + (mark if c in names else "") for c in columns)]
    order = [(i, j) for i in range(len(stations)) for j in range(len(levels))]
    if w.rng.random() < 0.4:
        order.sort(key=lambda place: (place[1], place[0]))
    for k, (i, j) in enumerate(order):
        if (i, j) in gone and w.rng.random() < 0.5:
            continue
        cells = {
            "s": w.number(stations[i], place=True),
            "l": w.number(levels[j], place=True),
            "o": w.missing() if (i, j) in gone else w.number(offsets[i, j]),
            "no": str(k + 1),
            "remark": f"p{k}",
        }
        lines.append(w.sign.join(cells[c] for c in columns))
    return lines, w.unit if mark else None


def offsets_of(file: PointFile, heights: bool) -> dict[tuple[float, float], float]:
    assert file.table is not None
    rows = file.table.tolist()
    return {(s, y if heights else z): z if heights else y for s, y, z in rows}


@pytest.mark.parametrize("first", range(0, 4000 if SOAK else 80, 20))
def test_drawn_tables_are_read_and_come_back_to_the_byte(tmp_path: Any, first: int) -> None:
    path = tmp_path / "t.csv"
    for seed in range(first, first + 20):
        table = drawn(seed)
        path.write_bytes(table.text.encode())
        file = read_points(path)
        own = offsets_of(file, table.heights)
        near = {(round(s, 6), round(z, 6)): round(y, 6) for (s, z), y in own.items()}
        drew = table.offsets.items()
        assert near == {(round(s, 6), round(z, 6)): round(y, 6) for (s, z), y in drew}, seed
        assert file.unit == table.unit, seed
        assert points_text(file.table, file).encode(file.encoding) == table.text.encode(), seed


def test_heads_and_rows_of_buttocks_are_heights(tmp_path: Any) -> None:
    """Labels say what a matrix holds, where its first cell does not."""
    path = tmp_path / "t.csv"
    rows = [f"{s},{s + 1},{s + 2},{s + 3},{s + 4},{s + 5}" for s in range(6)]
    path.write_text("\n".join(["station,Buttock 1,Buttock 2,Butt. 3,Butt. 4,Butt. 5", *rows]))
    file = read_points(path)
    assert file.moves == 2 and file.table is not None
    assert file.table[0].tolist() == [0, 1, 1] and file.table[7].tolist() == [1, 3, 4]
