"""Wrong digits and knuckles among points that stand in several lines."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np

from moldloft import _core
from moldloft.fairing.report import Finding

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


def along_lines(
    points: Floats, lines: Sequence[tuple[list[int], bool]], marked: Collection[int] = ()
) -> tuple[tuple[int, Finding], ...]:
    """What stands out along lines through numbered points: the line and the finding.

    A line is its points and whether it is closed. A wrong digit shows in all lines that judge its
    point, a knuckle in one.
    """
    rows = _core.line_findings(points, [(list(own), closed) for own, closed in lines], [*marked])
    return tuple((k, Finding.of(row)) for k, row in rows)


def grid_lines(shape: tuple[int, int], closed: tuple[bool, bool]) -> list[tuple[list[int], bool]]:
    """The lines of a grid ``(m, n)``: those along v, then those along u."""
    places = np.arange(shape[0] * shape[1]).reshape(shape)
    lines = [(row.tolist(), closed[1]) for row in places]
    return lines + [(column.tolist(), closed[0]) for column in places.T]


def lines_exact(
    grid: Floats, closed: tuple[bool, bool], breaks: tuple[Sequence[int], Sequence[int]] = ((), ())
) -> bool:
    """Whether all lines of a grid are exact from break to break."""
    m, n = grid.shape[:2]
    places = np.arange(m * n).reshape(m, n)
    marked = {*places[list(breaks[0])].ravel(), *places[:, list(breaks[1])].ravel()}
    lines = grid_lines((m, n), closed)
    return _core.are_exact(grid.reshape(-1, 3), lines, sorted(int(k) for k in marked))
