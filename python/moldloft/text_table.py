"""Tables of plain text, for terminals and for `repr`."""

from __future__ import annotations

import shutil
import sys
from textwrap import wrap

__all__ = ["table", "terminal_width"]

#: Least width to which texts are wrapped.
_LEAST = 20


def terminal_width() -> int | None:
    """The number of columns of the terminal that is printed to; None for files and pipes."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else None


def table(
    header: list[str], rows: list[list[str]], *, left: int = 1, width: int | None = None
) -> str:
    """A table; the first ``left`` columns are left-aligned, the others right-aligned.

    Parameters
    ----------
    header
        Titles of the columns.
    rows
        Rows of as many texts.
    left
        Number of left-aligned columns.
    width
        Maximum length of lines. Longer texts of a last, left-aligned column are wrapped, or
        moved to lines of their own. Numbers continue in a second table below the first, which
        begins with the same column.

    Examples
    --------
    >>> print(table(["patch", "panels"], [["hull", "200"]]))
    patch  panels
    hull      200
    >>> print(table(["z", "area", "volume"], [["1", "2.5", "3.75"]], width=9))
    z  area
    1   2.5
    <BLANKLINE>
    z  volume
    1    3.75
    """
    everything = [header, *rows]
    widths = [max(len(row[k]) for row in everything) for k in range(len(header))]
    last = len(header) - 1
    if width is None or sum(widths) + 2 * last <= width:
        return _lines(everything, widths, left)
    if left > last:
        beside = width - sum(widths[:-1]) - 2 * last
        if beside < _LEAST:
            return _below(everything, widths, width)
        lines = []
        for row in everything:
            texts = wrap(row[-1], beside) or [""]
            lines.append([*row[:-1], texts[0]])
            lines += [[*[""] * last, text] for text in texts[1:]]
        return _lines(lines, widths, left)
    parts = []
    columns = [0]
    for k in range(1, len(header)):
        wide = sum(widths[c] + 2 for c in columns) + widths[k]
        if wide > width and len(columns) > 1:
            parts.append(columns)
            columns = [0]
        columns = [*columns, k]
    parts.append(columns)
    return "\n\n".join(
        _lines(
            [[row[k] for k in columns] for row in everything],
            [widths[k] for k in columns],
            sum(k < left for k in columns),
        )
        for columns in parts
    )


def _below(rows: list[list[str]], widths: list[int], width: int) -> str:
    """Rows without the last column, whose texts are on indented lines below them."""
    heads = _lines([row[:-1] for row in rows], widths[:-1], len(widths)).splitlines()
    indent = " " * 4
    lines = []
    for head, row in zip(heads, rows, strict=True):
        texts = wrap(row[-1], max(width - len(indent), _LEAST))
        lines += [head, *(indent + text for text in texts)]
    return "\n".join(lines)


def _lines(rows: list[list[str]], widths: list[int], left: int) -> str:
    lines = []
    for row in rows:
        padded = zip(row, widths, strict=True)
        cells = [c.ljust(w) if k < left else c.rjust(w) for k, (c, w) in enumerate(padded)]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)
