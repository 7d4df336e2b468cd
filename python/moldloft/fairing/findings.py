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
    found: list[tuple[int, Finding]] = []
    seen: dict[int, int] = {}
    judged: dict[int, int] = {}
    for k, (own, closed) in enumerate(lines):
        row_of = np.ascontiguousarray(points[own])
        for i, least in zip(own, _core.detectable(row_of, closed), strict=True):
            judged[i] = judged.get(i, 0) + int(np.isfinite(least))
        for row in _core.data_findings(row_of, closed):
            one = Finding.of(row)
            i = own[one.index]
            if i in marked:
                continue
            text = one.text.replace(f"point {one.index + 1}", f"point {i + 1}", 1)
            found.append((k, Finding(one.kind, i, one.vector, text)))
            if one.kind == "outlier":
                seen[i] = seen.get(i, 0) + 1
    out = []
    told = set()
    for k, f in found:
        if f.kind == "outlier":
            if f.index in told or seen[f.index] < min(2, judged[f.index]):
                continue
            told.add(f.index)
        out.append((k, f))
    return tuple(out)
