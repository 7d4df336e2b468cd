"""Points that no other point betters in every objective: the Pareto front."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["front"]


def front(objectives: Floats) -> NDArray[np.int64]:
    """The rows of the Pareto front, with all objectives minimised.

    Parameters
    ----------
    objectives
        ``(points, objectives)``; rows with a NaN or an infinity belong to no front.

    Returns
    -------
    numpy.ndarray
        Rows in the order of the first objective. Of equal rows the first one.

    >>> front(np.array([[1.0, 3.0], [2.0, 1.0], [3.0, 2.0], [2.5, 0.5]])).tolist()
    [0, 1, 3]
    """
    values = np.asarray(objectives, dtype=np.float64)
    rows = np.flatnonzero(np.isfinite(values).all(axis=1))
    rows = rows[np.lexsort(values[rows].T[::-1])]
    chosen: list[int] = []
    kept = np.empty((rows.size, values.shape[1]))
    for row in rows:
        # In this order a later row betters no earlier one.
        if not (kept[: len(chosen)] <= values[row]).all(axis=1).any():
            kept[len(chosen)] = values[row]
            chosen.append(int(row))
    return np.array(chosen, dtype=np.int64)
