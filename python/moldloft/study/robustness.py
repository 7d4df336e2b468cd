"""Robust design: validity of the space, tolerances of manufacture, Sobol indices."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from moldloft.errors import Error
from moldloft.study.cases import DONE, REFUSED, SOLVER_FAILED
from moldloft.study.store import Results

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["Validity", "sobol_indices", "spreads", "validity", "worst_cases"]

#: The quantile of the normal distribution for 95 % of both sides.
NORMAL_95 = 1.959963984540054


@dataclass(frozen=True)
class Validity:
    """Number of valid shapes of a plan."""

    cases: int
    """Cases with a valid or invalid shape, without pending, crashed and timed-out ones."""
    valid: int
    """Cases with a valid model, including those with a failed solver."""
    low: float
    """Lower 95 % confidence bound of the valid fraction of the space, for a plan of independent
    draws.
    """
    high: float
    """Greatest one (Wilson 1927)."""

    @property
    def fraction(self) -> float:
        """Valid cases of all."""
        return self.valid / self.cases


def validity(results: Results) -> Validity | None:
    """Fraction of valid shapes of a plan.

    With ``closed`` in the definition open shapes are invalid.

    Parameters
    ----------
    results
        The table.

    Returns
    -------
    Validity or None
        None before a case was evaluated.
    """
    counts = results.counts
    valid = counts.get(DONE, 0) + counts.get(SOLVER_FAILED, 0)
    cases = valid + counts.get(REFUSED, 0)
    if not cases:
        return None
    z, p = NORMAL_95 / math.sqrt(cases), valid / cases
    middle = (p + z * z / 2) / (1 + z * z)
    half = z * math.sqrt(p * (1 - p) + z * z / 4) / (1 + z * z)
    return Validity(cases, valid, max(middle - half, 0.0), min(middle + half, 1.0))


def _terms(results: Results, tolerances: Mapping[str, float]) -> dict[str, list[Floats]]:
    """Absolute deviations of the outputs by one tolerance of each input, to first order."""
    for name, tolerance in tolerances.items():
        if not tolerance >= 0 or not math.isfinite(tolerance):
            raise Error(f"the tolerance of `{name}` is at least 0, found {tolerance}")
        if name not in results.inputs:
            raise Error(f"unknown input `{name}`; inputs: {', '.join(results.inputs)}")
    found = {}
    # An output without derivatives has no spread, not one of 0.
    for output, slopes in results.derivatives.items():
        if terms := [np.abs(slopes[n]) * t for n, t in tolerances.items() if t > 0]:
            found[output] = terms
    return found


def spreads(results: Results, tolerances: Mapping[str, float]) -> dict[str, Floats]:
    """Standard deviations of the outputs for independent deviations of the inputs, to first order.

    Parameters
    ----------
    results
        A table with derivatives.
    tolerances
        Standard deviations by input.

    Returns
    -------
    dict
        ``sqrt(sum((d output / d input * tolerance)**2))`` by output, ``(cases,)``: RSS, the root of
        the sum of squares.

    Raises
    ------
    Error
        For a negative tolerance, or a name that is not an input.
    """
    return {
        name: np.sqrt(np.sum(np.square(terms), axis=0))
        for name, terms in _terms(results, tolerances).items()
    }


def worst_cases(results: Results, tolerances: Mapping[str, float]) -> dict[str, Floats]:
    """Maximum deviations of the outputs for deviations of each input within its tolerance.

    Parameters
    ----------
    results
        A table with derivatives.
    tolerances
        Maximum deviations by input.

    Returns
    -------
    dict
        ``sum(abs(d output / d input) * tolerance)`` by output, ``(cases,)``, to first order.

    Raises
    ------
    Error
        For a negative tolerance, or a name that is not an input.
    """
    return {n: np.sum(terms, axis=0) for n, terms in _terms(results, tolerances).items()}


def sobol_indices(results: Results, count: int) -> dict[str, dict[str, tuple[float, float]]]:
    """First-order and total Sobol indices of a plan by Saltelli's scheme (Jansen's estimators).

    Parameters
    ----------
    results
        The table of a plan ``saltelli``.
    count
        The `count` of the plan: the table has ``count (inputs + 2)`` rows.

    Returns
    -------
    dict
        ``(first, total)`` by output and input. Rows with a case that is not done are left out.
        Empty for tables of other plans.
    """
    names = list(results.inputs)
    if len(results) != count * (len(names) + 2):
        return {}
    found: dict[str, dict[str, tuple[float, float]]] = {}
    for output, values in results.outputs.items():
        blocks = values.reshape(len(names) + 2, count)
        blocks = blocks[:, np.isfinite(blocks).all(axis=0)]
        a, b = blocks[0], blocks[1]
        variance = np.concatenate([a, b]).var() if a.size else 0.0
        if variance == 0.0:
            continue
        found[output] = {
            name: (
                float(1 - ((b - mixed) ** 2).mean() / (2 * variance)),
                float(((a - mixed) ** 2).mean() / (2 * variance)),
            )
            for name, mixed in zip(names, blocks[2:], strict=True)
        }
    return found
