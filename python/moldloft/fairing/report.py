"""Reports about fairings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

__all__ = ["Finding", "Numbers", "certificate_of", "claims_optimum", "lines_of"]


@dataclass(frozen=True)
class Numbers:
    """Counts and sums over a curve."""

    measure: float
    """The requested measure."""
    jumps: float
    """Sum of squared jumps of the highest derivative."""
    largest_jump: float
    """The largest jump."""
    pieces: int
    """Monotone pieces of the curvature, reversals below a thousandth of its range ignored."""
    inflections: int
    """Sign changes of the curvature."""
    largest_curvature: float
    """The largest curvature."""


@dataclass(frozen=True)
class Finding:
    """A feature of the data that noise does not explain."""

    kind: str
    """``"corner"``, probably an intended break, ``"outlier"``, probably a wrong digit, or
    ``"order"``, a point that probably belongs behind the next one."""
    index: int
    """The point, from 0."""
    vector: tuple[float, float, float]
    """Change of direction per parameter step of a corner, or error of an outlier."""
    text: str
    """A sentence about it; it counts points from 1."""

    @staticmethod
    def of(row: tuple[str, int, Any, str]) -> Finding:
        """Convert the report of the extension module.

        Parameters
        ----------
        row
            The extension's row.
        """
        kind, index, vector, text = row
        return Finding(kind, index, (float(vector[0]), float(vector[1]), float(vector[2])), text)


def lines_of(rows: list[tuple[str, str, str]], tail: list[tuple[str, str]]) -> str:
    """The report's table: a line for each number before and after, then single facts."""
    width = max(len(name) for name, *_ in [*rows, *tail])
    wide = max(len(cell) for _, *cells in rows for cell in cells)
    out = [f"{'':{width}}  {'before':>{wide}}  {'after':>{wide}}"]
    out += [f"{name:{width}}  {b:>{wide}}  {a:>{wide}}" for name, b, a in rows]
    out += [f"{name:{width}}  {fact}" for name, fact in tail]
    return "\n".join(out)


def claims_optimum(gap: float, relative: float) -> bool:
    """True if the gap gives a better lower bound than 0."""
    return math.isfinite(gap) and (gap <= 0 or relative < 1)


def certificate_of(value: float, gap: float, relative: float, *, moved: bool) -> str:
    """The proved property of a result, as a line of reports.

    Parameters
    ----------
    value, gap, relative
        The measure of the result, the bound on how much less another may measure, and their ratio.
    moved
        True if a point moved.

    Returns
    -------
    str
        The measure and its distance from the minimum, or a note that there is no bound.
    """
    said = f"relative optimality gap <= {relative:.1e} with these knots and parameters"
    if not math.isfinite(gap):
        said = "without a tolerance there is no optimality bound"
    elif not claims_optimum(gap, relative):
        why = "the proved gap exceeds the measure"
        said = f"no optimum is claimed: {why if moved else 'the points are unchanged'}"
    elif not moved and gap > 0:
        said += ": the points are unchanged"
    return f"{value:.9e}, {said}"
