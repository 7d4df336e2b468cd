"""Wrong digits and knuckles along lines that share points, and points in the wrong order."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np

from moldloft import _core
from moldloft.fairing.report import Finding

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


#: Ratio of steps to distances between nearest points from which a list counts as shuffled.
_SHUFFLED = 3.0

#: Fraction of its points at which a shuffled list turns back.
_TURNS_BACK = 0.25

#: Another order is proposed where the way through the points is shorter by a tenth or more.
_SHORTER = 0.9

#: A jump is a step of at least this multiple of the median step, and this fraction of the extent.
_JUMP = 4.0
_WIDE = 0.25

#: Jumps that are looked at, at most.
_MOST_JUMPS = 8

#: Largest turn of a smooth seam, as a multiple of the largest turn beside it.
_SMOOTH = 1.5

#: Cosine of the largest turn at which a way runs on.
_RUNS_ON = 0.5

#: Points of a list whose order is judged, at least.
_FEWEST = 7


def order_of(points: Floats, closed: bool) -> list[Finding]:
    """Findings about points out of order, reversed runs, and closed curves given as open.

    Swapped neighbours are found with the wrong digits.
    """
    n = len(points)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if n < _FEWEST or not steps.any():
        return []
    if _shuffled(points):
        return [_order(0, f"points 1 to {n}: out of order? the line through them turns back")]
    ring = not closed and (points[0] == points[-1]).all()
    if ring and _smooth_seam(points):
        return [
            _order(
                n - 1,
                f"point {n} is point 1, and the curve runs on there: a closed curve?",
            )
        ]
    return [] if closed or ring else _reversed_run(points, steps)


def _order(index: int, text: str) -> Finding:
    return Finding("order", index, (0.0, 0.0, 0.0), text)


def _shuffled(points: Floats) -> bool:
    """True if the points jump to and fro; of very many a sample tells, which jumps as they do."""
    way = np.diff(points, axis=0)
    if ((way > 0).all(axis=0) | (way < 0).all(axis=0)).any():
        return False
    own = points[np.linspace(0, len(points) - 1, min(len(points), 400)).astype(int)]
    way = np.diff(own, axis=0)
    if ((way[1:] * way[:-1]).sum(axis=1) < 0).mean() < _TURNS_BACK:
        return False
    apart = np.linalg.norm(own[:, None] - own[None], axis=2)
    apart[apart == 0] = np.inf
    steps = np.linalg.norm(way, axis=1)
    return bool(np.median(steps) > _SHUFFLED * np.median(apart.min(axis=1)))


def _smooth_seam(points: Floats) -> bool:
    """True if a closed curve turns as much at its seam as beside it."""
    way = np.diff(points, axis=0)
    round_ = np.vstack([way[-3:], way[:3]])
    units = round_ / np.maximum(np.linalg.norm(round_, axis=1), 1e-300)[:, None]
    turns = np.arccos(np.clip((units[1:] * units[:-1]).sum(axis=1), -1, 1))
    return bool(turns[2] <= _SMOOTH * max(turns[1], turns[3]))


def _reversed_run(points: Floats, steps: Floats) -> list[Finding]:
    """The run of points whose reversal, or exchange with the rest, shortens the polyline most."""
    n = len(points)
    usual = float(np.median(steps))
    extent = float(np.linalg.norm(np.ptp(points, axis=0)))
    jumps = np.flatnonzero(steps > max(_JUMP * usual, _WIDE * extent))
    jumps = np.sort(jumps[np.argsort(steps[jumps])[::-1][:_MOST_JUMPS]]).tolist()
    if not jumps:
        return []

    def apart(a: int, b: int) -> float:
        return float(np.linalg.norm(points[a] - points[b]))

    def smooth(order: list[int], joints: list[int]) -> bool:
        """True if the polyline in another order is smooth at its new joints."""
        way = np.diff(points[order], axis=0)
        size = np.linalg.norm(way, axis=1)
        for k in joints:
            for a in (k - 1, k):
                if a >= 0 and a + 1 < len(way):
                    dot = float(way[a] @ way[a + 1])
                    if dot < _RUNS_ON * float(size[a] * size[a + 1]):
                        return False
        return True

    best = (_JUMP * usual, 0, "")
    every = list(range(n))
    cuts = [-1, *jumps, n - 1]
    for a, i in enumerate(cuts):
        for j in cuts[a + 1 :]:
            # The run from i + 1 to j, reversed; at an end of the list only one step changes.
            gain, joints = 0.0, []
            if i >= 0:
                gain += apart(i, i + 1) - apart(i, j)
                joints.append(i)
            if j < n - 1:
                gain += apart(j, j + 1) - apart(i + 1, j + 1)
                joints.append(j)
            if j - i > 1 and joints and gain > best[0]:
                order = every[: i + 1] + every[i + 1 : j + 1][::-1] + every[j + 1 :]
                if smooth(order, joints):
                    best = (gain, i + 1, f"points {i + 2} to {j + 1}: in reversed order?")
    for j in jumps:
        gain = apart(j, j + 1) - apart(n - 1, 0)
        if gain > best[0] and smooth(every[j + 1 :] + every[: j + 1], [n - j - 2]):
            best = (gain, j + 1, f"points {j + 2} to {n}: before the others?")
    gain, index, text = best
    whole = float(steps.sum())
    if not text or whole - gain > _SHORTER * whole:
        return []
    share = f"{100 * gain / whole:.0f} %"
    return [_order(index, f"{text} the line through all points is {share} shorter so")]


def along_lines(
    points: Floats, lines: Sequence[tuple[list[int], bool]], marked: Collection[int] = ()
) -> tuple[tuple[int, Finding], ...]:
    """Findings along lines through numbered points: line and finding.

    A line is given by its points and true if closed. A wrong digit is found if all lines agree on
    it, a knuckle on one line.
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
    """True if all lines of a grid are exact from break to break."""
    m, n = grid.shape[:2]
    places = np.arange(m * n).reshape(m, n)
    marked = {*places[list(breaks[0])].ravel(), *places[:, list(breaks[1])].ravel()}
    lines = grid_lines((m, n), closed)
    return _core.are_exact(grid.reshape(-1, 3), lines, sorted(int(k) for k in marked))
