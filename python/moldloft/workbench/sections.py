"""Sections of a network's lines for its views: buttocks, and diagonals in planes at 45 degrees."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["sections"]

#: Planes of each view, evenly spaced.
_DIAGONALS, _BUTTOCKS = 5, 3
#: A line is in a plane if it leaves it by no more than this fraction of the network's extent.
_FLAT = 1e-3
#: Fewest crossings that are drawn.
_FEWEST = 3


def sections(lines: Sequence[Any]) -> dict[str, list[list[list[float]]]]:
    """Sections of a network by planes in which it has no lines.

    Parameters
    ----------
    lines
        The lines as polylines ``(n, 3)``.

    Returns
    -------
    dict
        ``diagonals`` as x and the length along the plane from y = 0, in planes y + z = c for
        points with y of 0 or more and z - y = c for others; ``buttocks`` as x and z, in planes of
        constant y, empty for a network that has buttocks of its own.
    """
    every = [np.asarray(line, dtype=float) for line in lines]
    extent = float(np.ptp(np.vstack(every), axis=0).max())
    flat = [np.ptp(line, axis=0) <= _FLAT * extent for line in every]
    stations = [line for line, on in zip(every, flat, strict=True) if on[0] and not on[1:].all()]
    used = stations if len(stations) >= _FEWEST else every
    own = any(on[1] and not on[0] and np.abs(line[:, 1]).max() > _FLAT * extent
              for line, on in zip(every, flat, strict=True))  # fmt: skip
    digits = 8 - math.ceil(math.log10(extent)) if extent > 0 else 8
    slopes = _cut(used, lambda p: p[:, 2] + np.abs(p[:, 1]), _DIAGONALS, _along_diagonal)
    sides = [] if own else _cut(used, lambda p: p[:, 1], _BUTTOCKS, lambda p: p[:, [0, 2]])
    rounded = [[np.round(line, digits).tolist() for line in cut] for cut in (slopes, sides)]
    return {"diagonals": rounded[0], "buttocks": rounded[1]}


def _along_diagonal(points: Floats) -> Floats:
    return np.column_stack([points[:, 0], math.sqrt(2) * np.abs(points[:, 1])])


def _cut(lines: list[Floats], height: Any, count: int, seen: Any) -> list[Floats]:
    """Crossings of lines with surfaces of constant height, by x."""
    heights = [height(line) for line in lines]
    low, high = min(h.min() for h in heights), max(h.max() for h in heights)
    out = []
    for k in range(1, count + 1):
        at = low + (high - low) * k / (count + 1)
        met = [p for line, h in zip(lines, heights, strict=True) for p in _crossings(line, h - at)]
        if len(met) >= _FEWEST:
            points = np.array(sorted(met, key=lambda p: p[0]))
            out.append(seen(points))
    return out


def _crossings(line: Floats, off: Floats) -> list[Floats]:
    """The points of a polyline where a height changes its sign."""
    k = np.flatnonzero((off[:-1] < 0) != (off[1:] < 0))
    t = (off[k] / (off[k] - off[k + 1]))[:, None]
    return list(line[k] + t * (line[k + 1] - line[k]))
