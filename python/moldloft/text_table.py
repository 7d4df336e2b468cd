"""Tables of plain text, for terminals and for `repr`."""

from __future__ import annotations

__all__ = ["table"]


def table(header: list[str], rows: list[list[str]], *, left: int = 1) -> str:
    """A table; the first ``left`` columns are left-aligned, the others right-aligned.

    Parameters
    ----------
    header
        Titles of the columns.
    rows
        Rows of as many texts.
    left
        Number of left-aligned columns.

    Examples
    --------
    >>> print(table(["patch", "panels"], [["hull", "200"]]))
    patch  panels
    hull      200
    """
    widths = [max(len(row[k]) for row in [header, *rows]) for k in range(len(header))]
    lines = []
    for row in [header, *rows]:
        padded = zip(row, widths, strict=True)
        cells = [c.ljust(w) if k < left else c.rjust(w) for k, (c, w) in enumerate(padded)]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)
