"""Cells of a table with their positions in the text, and lengths in the notation of a cell."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from moldloft.arguments import explain

__all__ = ["Cells", "lines_at", "notation", "rounded", "sixteenths", "step_of", "written_as"]

SEPARATORS = ";\t,|"
"""Separators of cells, in the order of preference."""

_LINE = re.compile(r"[^\r\n]*")
_EIGHTHS = re.compile(r"[-\u2212]?\d+-\d+-\d+[+\u00bd-]?")
_FEET = re.compile(r"[-\u2212]?\d+['\u2032].*")
_DECIMALS = re.compile(r"[+-]?\d*[.,]?(\d*)")

#: The finest step of feet, inches and eighths, in inches: an eighth with + or - is a sixteenth.
SIXTEENTH = 0.0625

#: The fewest steps of the written digits in a tolerance.
_STEPS_IN_TOLERANCE = 5

#: Decimals at most: a double has no more.
_MOST_DECIMALS = 15


@dataclass
class Cells:
    """The cells of a table that contain coordinates."""

    text: str
    """The text as it was read, with its byte order mark and ends of lines."""
    places: list[tuple[int, int]] = field(default_factory=list)
    """Begin and end of each cell in the text."""
    owners: list[tuple[int, int]] = field(default_factory=list)
    """Row of points and axis of each cell."""

    def cell(self, k: int) -> str:
        """The text of a cell.

        Parameters
        ----------
        k
            The cell, from 0.
        """
        start, end = self.places[k]
        return self.text[start:end]

    def written(self, texts: Sequence[str | None]) -> str:
        """The text with new numbers in its cells; columns separated by blanks keep their width.

        Parameters
        ----------
        texts
            The number of each cell; ``None`` leaves it as it is.
        """
        out, at = [], 0
        for (start, end), new in sorted(zip(self.places, texts, strict=True), key=lambda p: p[0]):
            if new is None:
                continue
            out.append(self.text[at:start])
            out.append(new.rjust(end - start) if self._set_by_blanks(start, end) else new)
            at = end
        return "".join([*out, self.text[at:]])

    def _set_by_blanks(self, start: int, end: int) -> bool:
        low = max(self.text.rfind("\n", 0, start), self.text.rfind("\r", 0, start)) + 1
        high = _LINE.match(self.text, end)
        line = self.text[low : high.end() if high else end]
        return not any(sign in line for sign in SEPARATORS)


def lines_at(text: str) -> tuple[list[str], list[int]]:
    r"""The lines of a text without line ends, with the offset of each.

    A byte order mark is skipped.

    Parameters
    ----------
    text
        Any text.

    Examples
    --------
    >>> lines_at("a,b\r\nc\n")
    (['a,b', 'c', ''], [0, 5, 7])
    """
    lines, starts = [], []
    at = 1 if text.startswith("\ufeff") else 0
    while True:
        found = _LINE.match(text, at)
        assert found is not None
        lines.append(found[0])
        starts.append(at)
        at = found.end()
        if at >= len(text):
            return lines, starts
        at += 2 if text.startswith("\r\n", at) else 1


def notation(cell: str) -> str:
    """The notation of a length: ``"eighths"``, ``"feet"`` or ``"decimal"``.

    Parameters
    ----------
    cell
        The length as it is written.

    Examples
    --------
    >>> notation("4-5-1+"), notation("4' 5 1/8"), notation("1.25")
    ('eighths', 'feet', 'decimal')
    """
    if _EIGHTHS.fullmatch(cell):
        return "eighths"
    return "feet" if _FEET.fullmatch(cell) else "decimal"


def _decimals(cell: str) -> int:
    found = _DECIMALS.fullmatch(cell)
    return len(found[1]) if found and re.search("[.,]", cell) else 0


def step_of(cells: Sequence[str], tolerance: float) -> float:
    """The step of written offsets: the digit of the table, or finer for small tolerances.

    For feet, inches and eighths, a sixteenth of an inch. For decimals, the last digit of the cell
    with the most, but at most a fifth of the tolerance, which preserves the fairing.

    Parameters
    ----------
    cells
        The cells that may change.
    tolerance
        The smallest tolerance above 0; infinite for none.

    Examples
    --------
    >>> step_of(["1.250", "0.3"], 0.01), step_of(["0.31", "0.3"], 0.005), step_of(["4-5-1"], 0.125)
    (0.001, 0.001, 0.0625)
    """
    if any(notation(cell) != "decimal" for cell in cells):
        return SIXTEENTH
    digits = max((_decimals(cell) for cell in cells), default=0)
    while digits < _MOST_DECIMALS and 10.0**-digits * _STEPS_IN_TOLERANCE > tolerance * (1 + 1e-9):
        digits += 1
    return 10.0**-digits


def rounded(value: float, given: float, step: float, tolerance: float) -> float:
    """A faired number rounded to a step, within the tolerance of the original.

    This is the nearest multiple; if it is beyond the tolerance, the next one towards the original;
    if there is none in between, the original.

    Parameters
    ----------
    value, given
        The faired number and the one that was read.
    step, tolerance
        Lengths in their unit.

    Examples
    --------
    >>> rounded(1.2343, 1.23, 0.01, 0.005), rounded(1.2347, 1.23, 0.001, 0.0049)
    (1.23, 1.234)
    """
    count = Fraction(value) / Fraction(repr(step))
    down = math.floor(count)
    for whole in (round(count), down if value > given else down + 1):
        near = float(whole * Fraction(repr(step)))
        kept = abs(near - given) <= tolerance * (1 + 1e-12)
        if kept and (near - given) * (value - given) >= 0:
            return near
    return given


def sixteenths(inches: float) -> str:
    """A length in feet, inches and eighths, to the nearest sixteenth.

    Parameters
    ----------
    inches
        The length.

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


def _feet(inches: float, like: str) -> str:
    """Feet and inches with a fraction, as in ``4' 5 1/8"``; with decimals where ``like`` has."""
    close = '"' if like.rstrip().endswith(('"', "\u2033")) else ""
    decimal = re.search(r"\.\d+", like)
    sign = "-" if inches < 0 else ""
    if decimal:
        digits = max(len(decimal[0]) - 1, 4)
        feet, rest = divmod(round(abs(inches), digits), 12)
        return f"{sign}{feet:.0f}' {round(rest, digits):g}{close}"
    count = round(16 * abs(inches))
    feet, rest = divmod(count, 192)
    whole, parts = divmod(rest, 16)
    share = Fraction(parts, 16)
    return f"{sign}{feet}' {whole}{f' {share}' if share else ''}{close}"


def written_as(value: float, like: str, step: float) -> str:
    """A length in the notation of a cell.

    Parameters
    ----------
    value
        The length; inches where the notation is in feet.
    like
        The cell as it was read.
    step
        The step to which it is rounded; 0 for all digits.

    Examples
    --------
    >>> written_as(53.1875, "4-5-1", 0.0625), written_as(53.25, "4' 5 1/8", 0.0625)
    ('4-5-1+', "4' 5 1/4")
    >>> written_as(0.31, "0,300", 0.001), written_as(0.125, "0.3", 0)
    ('0,310', '0.125')
    """
    kind = notation(like)
    if kind == "eighths":
        return sixteenths(value)
    if kind == "feet":
        return _feet(value, like)
    if step > 0:
        digits = max(_decimals(like), _decimals(f"{step:.15f}".rstrip("0")))
        text = f"{value:.{digits}f}"
        text = text.removeprefix("-") if float(text) == 0 else text
    else:
        text = repr(float(value) + 0.0)
    return text.replace(".", ",") if "," in like else text


explain(globals())
