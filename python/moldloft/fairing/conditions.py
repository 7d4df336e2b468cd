"""Conditions on fair curves: points, tangents, joins, shape."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from moldloft.errors import FairingError
from moldloft.fairing.arrays import points_of
from moldloft.fairing.spline import Spline

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["join_conditions", "linear_conditions"]

Condition = tuple[str, float, tuple[float, float, float], tuple[float, float, float]]

TOGETHER = 1e-9
"""Maximum distance of coincident ends, relative to the extent of a curve."""


def _vector(vector: ArrayLike) -> tuple[float, float, float]:
    v, _ = points_of([np.asarray(vector, np.float64).ravel()])
    return float(v[0, 0]), float(v[0, 1]), float(v[0, 2])


def linear_conditions(
    through: Iterable[tuple[float, ArrayLike]],
    tangents: Iterable[tuple[float, ArrayLike]],
    keep: Sequence[str],
) -> tuple[list[Condition], list[str]]:
    """The conditions, with their names for error messages."""
    out: list[Condition] = []
    labels = []
    none = (0.0, 0.0, 0.0)
    for word, rows in (("through", through), ("tangent", tangents)):
        for t, vector in rows:
            v = _vector(vector)
            if not 0 <= t <= 1:
                raise FairingError(f"expected a parameter from 0 to 1, found {t:g}")
            if word == "tangent" and not any(v):
                raise FairingError(f"the tangent at {t:g} has no direction")
            out.append((word, float(t), v, none))
            labels.append(f"{word} at {t:g}")
    for word in keep:
        out.append((word, 0.0, none, none))
        labels.append(f"keep {word}")
    return out, labels


def join_conditions(joins: Sequence[Spline], spline: Spline) -> list[Condition]:
    """Joins at the ends of the curve: conditions with parameter 0 or 1."""
    if joins and spline.closed:
        raise FairingError("a closed curve has no ends to join")
    out: dict[int, Condition] = {}
    own = spline([0.0, 1.0])
    extent = float(np.ptp(spline.control_points, axis=0).max())
    for k, other in enumerate(joins):
        if not isinstance(other, Spline) or other.closed:
            raise FairingError(f"join {k + 1} is not an open spline")
        ends = other.at([0.0, 1.0])
        away = np.linalg.norm(own[:, None] - ends.points[None], axis=2)
        a, b = (int(i) for i in np.unravel_index(int(np.argmin(away)), away.shape))
        if not away[a, b] <= TOGETHER * extent:
            raise FairingError(
                f"join {k + 1} does not begin or end where the curve does: its nearest end "
                f"is {away[a, b]:.3e} off (a fitted curve ends at its points: as `fit`)"
            )
        if a in out:
            raise FairingError(f"two curves join at the {('start', 'end')[a]} of the curve")
        # The neighbour's parameter runs into the start, or on from the end, or the other way.
        first = ends.first[b] * (-1.0 if a == b else 1.0)
        out[a] = ("join", float(a), _vector(first), _vector(ends.second[b]))
    return list(out.values())
