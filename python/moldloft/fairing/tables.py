"""Conversion of tables of points in common forms to plain rows.

Aerofoils with prose, decimal commas, named columns, lengths in feet, inches and eighths.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from fractions import Fraction

from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.cells import SEPARATORS

__all__ = [
    "MISSING",
    "Plain",
    "eighths",
    "length",
    "names_axes",
    "plain",
    "spans",
    "unit_named",
]

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")
_SLIP = re.compile(r"[-+.\dOoIl]+")
_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?")
_EIGHTHS = re.compile(r"([-\u2212]?)(\d+)-(\d+)-(\d+)([+\u00bd-]?)")
_FEET = re.compile(
    r"([-\u2212]?)(\d+)['\u2032]\s*-?\s*"
    r"(?:(\d+\.\d+|\d+)(?:\s+(\d+)/(\d+))?|(\d+)/(\d+))?\s*[\"\u2033]?"
)
_PARTS = {
    "\u00bd": (1, 2),
    "\u2153": (1, 3),
    "\u2154": (2, 3),
    "\u00bc": (1, 4),
    "\u00be": (3, 4),
    "\u215b": (1, 8),
    "\u215c": (3, 8),
    "\u215d": (5, 8),
    "\u215e": (7, 8),
}
_FRACTION = re.compile(rf"([-\u2212]?)(\d*)(?:\s*([{''.join(_PARTS)}])|\s+([1-9]\d*)/([1-9]\d*))")
MISSING = frozenset(("", "x", "X", "-", "\u2013", "\u2014", "null", "nan", "NaN", "n/a"))

_AXES = {
    "x": "x",
    "y": "y",
    "z": "z",
    "station": "x",
    "half_breadth": "y",
    "halfbreadth": "y",
    "buttock": "y",
    "offset": "y",
    "waterline": "z",
    "wl": "z",
    "height": "z",
}
"""Axis of named columns, in ship axes: x along, y across, z up."""


def eighths(text: str) -> Fraction | None:
    """Feet, inches and eighths as inches: ``4-5-1``; ``+`` or ``-`` is a sixteenth more or less.

    Parameters
    ----------
    text
        A length, such as ``4-5-1``.

    Examples
    --------
    >>> float(eighths("4-5-1")), float(eighths("0-54-0+")), eighths("4-5")
    (53.125, 54.0625, None)
    """
    found = _EIGHTHS.fullmatch(text)
    if found is None:
        return None
    sign, feet, inches, parts, more = found.groups()
    value = Fraction(12 * int(feet) + int(inches)) + Fraction(int(parts), 8)
    value += {"+": 1, "\u00bd": 1, "-": -1}.get(more, 0) * Fraction(1, 16)
    return -value if sign else value


def length(text: str) -> float | None:
    """A length in handwritten notation; feet and inches are converted to inches.

    Accepted are numbers, feet-inches-eighths, and feet and inches. Numbers may have fractions:
    ``8½``, ``8 1/2``.

    Parameters
    ----------
    text
        A length, such as ``1.5`` or ``4-5-1``.

    Examples
    --------
    >>> length("1.5"), length("4-5-1"), length("4' 5 1/8"), length("six")
    (1.5, 53.125, 53.125, None)
    >>> length("4' 5.25"), length("8\u00bd"), length("\u00be"), length("1 3/8")
    (53.25, 8.5, 0.75, 1.375)
    """
    text = text.strip()
    if _NUMBER.fullmatch(text):
        return float(text.replace("d", "e").replace("D", "e"))
    inches = eighths(text)
    if inches is not None:
        return float(inches)
    part = _FRACTION.fullmatch(text)
    if part is not None and (part[2] or part[3]):
        share = Fraction(*_PARTS[part[3]]) if part[3] else Fraction(int(part[4]), int(part[5]))
        own_value = int(part[2] or 0) + share
        return float(-own_value if part[1] else own_value)
    feet = _FEET.fullmatch(text)
    if feet is None:
        return None
    sign, whole, own, top, under, alone, below = feet.groups()
    top, under = top or alone or "0", under or below or "1"
    if int(under) == 0:
        return None
    value = 12 * int(whole) + Fraction(own or 0) + Fraction(int(top), int(under))
    return float(-value if sign else value)


@dataclass
class Plain:
    """A table as plain rows, one for each line of the original, with a record of the changes."""

    text: str
    head: list[str] | None = None
    """The original lines before the first row."""
    notes: list[str] = field(default_factory=list)
    inches: bool = False
    """True if lengths were in feet, inches and eighths."""
    unit: str | None = None
    """The unit that the names of columns state: m, cm, mm, ft or in."""
    comma: bool = False
    """True if numbers had decimal commas."""
    stations: bool = False
    """True if the rows are offsets: their columns are station, half-breadth and height."""
    heights: bool = False
    """True if these are heights at buttocks, not half-breadths at waterlines."""
    axes: list[int] | None = None
    """Columns of x, y and z, if names identify them among others."""


def spans(line: str) -> list[tuple[int, int]]:
    """Start and end of the cells of a line, separated by :data:`SEPARATORS` or blanks.

    Parameters
    ----------
    line
        A line of a table.
    """
    sign = next((s for s in SEPARATORS if s in line), None)
    if sign is None:
        return [m.span() for m in re.finditer(r"\S+", line)]
    out, at = [], 0
    for cell in line.split(sign):
        bare = cell.strip()
        start = at + (len(cell) - len(cell.lstrip())) if bare else at
        out.append((start, start + len(bare)))
        at += len(cell) + len(sign)
    # The empty text after a last separator is not a cell.
    while len(out) > 1 and out[-1][0] == out[-1][1]:
        out.pop()
    return out


def _cells(line: str) -> list[str]:
    """The cells of a line, separated by separators or blanks."""
    line = line.strip().rstrip(f"{SEPARATORS} ")
    for sign in SEPARATORS:
        if sign in line:
            return [c.strip().strip('"').strip() for c in line.split(sign)]
    return line.split()


def _numbers(cells: list[str]) -> bool:
    return bool(cells) and all(_NUMBER.fullmatch(c) for c in cells)


def plain(text: str) -> Plain:
    """Plain text of a table. Other content is kept, so that the reader can report its line.

    Parameters
    ----------
    text
        Any text.
    """
    out = Plain(text.lstrip("\ufeff"))
    lines = out.text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    lines = _openfast(lines, out)
    lines = _decimal_commas(lines, out)
    lines = _lengths(lines, out)
    lines = _named(lines, out)
    lines = _prose(lines, out)
    out.text = "\n".join(lines)
    return out


_COORDINATES = re.compile(r"\s*(\d+)\s+NumCoords\b.*", re.IGNORECASE)


def _openfast(lines: list[str], out: Plain) -> list[str]:
    """Coordinates of an aerofoil for OpenFAST.

    Comments begin with ``!``, and the first point is the reference and not on the section.
    """
    counted = next((k for k, s in enumerate(lines) if _COORDINATES.fullmatch(s)), None)
    if counted is None:
        return lines
    made = [f"# {s}" if k == counted or s.lstrip().startswith("!") else s
            for k, s in enumerate(lines)]  # fmt: skip
    rows = [k for k, s in enumerate(made) if s.strip() and not s.startswith("#")]
    found = _COORDINATES.fullmatch(lines[counted])
    assert found is not None
    if len(rows) != int(found[1]):
        raise FairingError(
            f"line {counted + 1}: expected {found[1]} coordinates (NumCoords), found {len(rows)}"
        )
    if rows:
        made[rows[0]] = f"# {made[rows[0]]}"
        out.notes.append(f"line {rows[0] + 1}: the reference point is not on the aerofoil")
    out.axes = [0, 1]
    return made


def _decimal_commas(lines: list[str], out: Plain) -> list[str]:
    """Converts decimal commas, if columns have another separator."""

    def pieces(line: str) -> list[str]:
        """Cells and separators, alternating; semicolons and tabs take precedence over blanks."""
        between = r"(\s*[;\t]\s*)" if ";" in line or "\t" in line.strip() else r"(\s+)"
        return re.split(between, line)

    def is_row(cells: list[str]) -> bool:
        return len(cells) > 1 and any(_COMMA.fullmatch(c) for c in cells)

    rows = [[c for c in pieces(s.strip())[::2] if c] for s in lines if not s.startswith("#")]
    marked = any(";" in s or "\t" in s.strip() for s in lines)
    if not marked:
        # Blanks alone: prose has commas, too.
        rows = [w for w in rows if all(_COMMA.fullmatch(c) or c.isdigit() for c in w)]
    inner = [w for w in rows if is_row(w)]
    some = [c for w in inner for c in w if _COMMA.fullmatch(c)]
    if len(inner) < 3 or any(_NUMBER.fullmatch(c) and "." in c for w in inner for c in w):
        return lines
    # `1,2 3,4` could be four whole numbers; points with blanks alone have fractions of some digits.
    if all(len(c.partition(",")[2]) < 2 for c in some) and not any(";" in s for s in lines):
        return lines
    out.comma = True
    out.notes.append("numbers are read with decimal commas")

    def one(line: str) -> str:
        if not marked and not all(_COMMA.fullmatch(c) or c.isdigit() for c in line.split()):
            return line
        cells = pieces(line)
        return "".join(c.replace(",", ".") if _COMMA.fullmatch(c.strip()) else c for c in cells)

    return [one(line) for line in lines]


def _lengths(lines: list[str], out: Plain) -> list[str]:
    """Lengths in feet, inches and eighths become inches, and fractions numbers."""
    made = []
    large = 0
    for line in lines:
        places = spans(line)
        cells = [line[a:b].strip('"').strip() for a, b in places]
        in_feet = [_EIGHTHS.fullmatch(c) or _FEET.fullmatch(c) for c in cells]
        own = [
            f or (_FRACTION.fullmatch(c) and length(c) is not None)
            for f, c in zip(in_feet, cells, strict=True)
        ]
        # Between blanks alone a line of words is prose; a named column may hold words, too.
        words = not any(sign in line for sign in SEPARATORS)
        if not any(own) or (words and any(length(c) is None for c in cells)):
            made.append(line)
            continue
        out.inches |= any(in_feet)
        large += sum(1 for c in cells if (e := _EIGHTHS.fullmatch(c)) and int(e[3]) >= 12)
        large += sum(1 for c in cells if (e := _EIGHTHS.fullmatch(c)) and int(e[4]) >= 8)
        for (a, b), cell, found in reversed(list(zip(places, cells, own, strict=True))):
            if found:
                line = line[:a] + repr(length(cell)) + line[b:]
        made.append(line)
    if out.inches:
        out.notes.append("lengths in feet, inches and eighths are read as inches")
    if large:
        out.notes.append(f"{large} lengths have 12 inches or 8 eighths and more")
    return made


def names_axes(line: str) -> bool:
    """True if a line names columns of two axes or more.

    Parameters
    ----------
    line
        A line of a table.
    """
    return len({_axis(n) for n in _cells(line.lstrip("# "))} - {None}) >= 2


def _axis(name: str) -> str | None:
    name = re.sub(r"[\s-]+", "_", _UNIT.sub("", name.strip().lower()))
    own = _AXES.get(name) or _AXES.get(name.rstrip("s"))
    if own is None and name[-2:] in ("_x", "_y", "_z"):
        # As in `waterline_z`.
        before = _AXES.get(name[:-2])
        own = before if before == name[-1] else None
    return own


_UNIT = re.compile(r"\s*[(\[]\s*([^)\]]*?)\s*[)\]]$")
_UNIT_WORDS = {
    "m": ("m", "metre", "metres", "meter", "meters"),
    "cm": ("cm", "centimetre", "centimetres", "centimeter", "centimeters"),
    "mm": ("mm", "millimetre", "millimetres", "millimeter", "millimeters"),
    "ft": ("ft", "foot", "feet"),
    "in": ("in", "inch", "inches"),
}


def unit_named(word: str) -> str | None:
    """The unit of length for a word: m, cm, mm, ft or in.

    Parameters
    ----------
    word
        Unit of a word such as those in brackets after the name of a column.

    Examples
    --------
    >>> unit_named("Metres"), unit_named("in."), unit_named("deg")
    ('m', 'in', None)
    """
    bare = word.strip().rstrip(".").lower()
    return next((unit for unit, words in _UNIT_WORDS.items() if bare in words), None)


def _named(lines: list[str], out: Plain) -> list[str]:
    """Columns by name: x, y, z or station, half-breadth and height; others are ignored."""
    first = next((k for k, s in enumerate(lines) if s.strip() and not s.startswith("#")), None)
    if first is None:
        return lines
    names = _cells(lines[first].lstrip("# "))
    axes = [_axis(n) for n in names]
    plain_names = [_UNIT.sub("", n.strip().lower()) for n in names]
    units = {u[1] for n, a in zip(names, axes, strict=True) if a and (u := _UNIT.search(n.lower()))}
    if len(units) > 1:
        raise FairingError(
            f"line {first + 1}: columns in {' and '.join(sorted(units))}: expected one unit"
        )
    out.unit = next((unit_named(unit) for unit in units), None)
    if {"x", "y"} <= set(plain_names):
        # Beside x and y a station is a number of the section.
        axes = [n if n in ("x", "y", "z") else None for n in plain_names]
    known = [a for a in axes if a]
    if len(known) < 2 or len(set(known)) != len(known):
        if len(known) > len(set(known)):
            raise FairingError(f"line {first + 1}: two columns of {', '.join(names)} are the same")
        return lines
    order = sorted((a, k) for k, a in enumerate(axes) if a)
    of_x = plain_names[order[0][1]]
    out.stations = of_x.startswith("station") and "x" in known
    if not out.stations and set(known) == {"x", "y", "z"}:
        out.stations = _in_levels(lines[first + 1 :], [k for _, k in order], len(names))
        if out.stations:
            out.notes.append("rows of equal x with common z are the stations of a table of offsets")
    out.heights = out.stations and any(n.startswith("buttock") for n in plain_names)
    in_order = len(known) == len(names) and [k for _, k in order] == list(range(len(names)))
    out.axes = [at for _, at in order]
    sign = next((s for s in SEPARATORS if s in lines[first]), None)
    if in_order and not out.stations and sign != "|":
        return lines
    unused = [n for n, a in zip(names, axes, strict=True) if not a]
    if unused:
        word = "column" if len(unused) == 1 else "columns"
        out.notes.append(f"{word} {', '.join(f'`{n}`' for n in unused)}: not used")
    made = list(lines[: first + 1])
    made[first] = ", ".join(names[k] for _, k in order)
    for k in range(first + 1, len(lines)):
        line = lines[k]
        if not line.strip() or line.startswith("#"):
            made.append(line)
            continue
        # An empty cell at the end is one, too.
        cells = [c.strip().strip('"').strip() for c in line.split(sign)] if sign else line.split()
        while len(cells) > len(names) and not cells[-1]:
            cells.pop()
        if len(cells) != len(names):
            if _numbers([c for c in cells if c]):
                raise FairingError(f"line {k + 1}: expected {len(names)} cells, found {len(cells)}")
            made.append(line)
            continue
        gone = next((at for _, at in order if cells[at] in MISSING), None)
        if gone is None:
            made.append(", ".join(cells[at] for _, at in order))
        elif out.stations:
            made.append(f"# {line}")
            out.notes.append(f"line {k + 1}: a missing cell, the row is left out")
        else:
            raise FairingError(f"line {k + 1}: the cell of `{names[gone]}` is empty")
    return made


def _in_levels(lines: list[str], axes: list[int], width: int) -> bool:
    """True if points run through stations of equal x, each through heights that others have, too.

    So rows of a table of offsets do, and no curve in space does.
    """
    stations: list[tuple[str, set[str]]] = []
    if "\n\n" in "\n".join(line.strip() for line in lines).strip():
        # Curves are apart.
        return False
    for line in lines:
        if line.startswith("#"):
            continue
        cells = _cells(line)
        if len(cells) != width:
            continue
        x, _, z = (cells[k] for k in axes)
        if not stations or stations[-1][0] != x:
            stations.append((x, set()))
        if z in stations[-1][1]:
            return False
        stations[-1][1].add(z)
    levels = [own for _, own in stations]
    apart = len({x for x, _ in stations}) == len(stations)
    common = set.intersection(*levels) if levels else set()
    return apart and len(stations) > 2 and len(common) > 2


def _prose(lines: list[str], out: Plain) -> list[str]:
    """Removes titles, program output and prose around the rows of an aerofoil."""
    rows = [k for k, s in enumerate(lines) if len(c := _cells(s)) in (2, 3) and _numbers(c)]
    if len(rows) < 5:
        return lines
    first, last = rows[0], rows[-1]
    made = list(lines)
    own = [k for k in range(first) if lines[k].strip()]
    odd = [k for k in own if not lines[k].startswith("#") and len(_cells(lines[k])) != 1]
    four = [k for k in odd if len(c := _cells(lines[k])) in (4, 5) and _numbers(c)]
    if four:
        # The grid's box of an aerofoil for MSES.
        out.notes.append(f"line {four[0] + 1}: four numbers before the points, not read")
    if any("\t" in lines[k] or "," in lines[k] or ";" in lines[k] for k in odd) or four:
        words = [c for k in odd if k not in four for c in _cells(lines[k])]
        if not _column_names(words):
            out.head = [lines[k].rstrip() for k in own]
            for k in own:
                made[k] = f"# {lines[k]}"
    after = [k for k in range(last + 1, len(lines)) if lines[k].strip()]
    after = [k for k in after if not lines[k].startswith("#")]
    # A slip of the pen in a last row is no prose.
    width = len(_cells(lines[last]))
    slip = any(
        len(cells := _cells(lines[k])) == width and _SLIP.fullmatch(cells[0]) is not None
        for k in after
    )
    if after and not slip:
        where = f"line {after[0] + 1}"
        if len(after) > 1:
            where = f"lines {after[0] + 1} to {after[-1] + 1}"
        out.notes.append(f"{where} after the points: text, not read")
        for k in after:
            made[k] = f"# {lines[k]}"
    return made


def _column_names(words: list[str]) -> bool:
    return bool(words) and all(_axis(w) for w in words)


explain(globals())
