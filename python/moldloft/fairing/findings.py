"""Wrong digits and knuckles among points that stand in several lines."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

from moldloft import _core
from moldloft.fairing.report import Finding

if TYPE_CHECKING:
    import numpy as np
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
