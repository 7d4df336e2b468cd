"""Options of callers, translated for the kernel."""

from __future__ import annotations

from typing import Any

from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import direction


def goal_of(given: Any) -> tuple[str, float | None]:
    """The keyword of a goal and its fraction, if given."""
    word, share = given if isinstance(given, tuple) and len(given) == 2 else (given, None)
    return str(word), None if share is None else float(share)


def only_data(goal: Any) -> None:
    """Reject goals that need data if there are none."""
    word, _ = goal_of(goal)
    if word not in ("near", "fairest"):
        raise FairingError(f'the goal `{word}` is for optima of data, `as_="fit"`')


EXACT = (
    "the points are on lines, conics, plane cubics or helices and are unchanged: the goal "
    "`fairest` moves them"
)
"""Note for exact points, which the goal does not move."""

EXACT_NEAREST = (
    "the points are on lines, conics, plane cubics or helices: the result is the nearest spline "
    "with these knots; the goal `fairest` moves it"
)
"""The same note for splines that need not pass through the points."""


def stays_near(goal: Any, free: bool) -> bool:
    """True if exact points do not move: goal ``"near"`` without conditions."""
    return free and goal_of(goal)[0] == "near"


def spacing_of(given: Any) -> tuple[str, tuple[float, float, float]]:
    """The word for a spacing, or "along" with its direction."""
    if isinstance(given, str):
        return given, (0.0, 0.0, 0.0)
    return "along", direction(given)[1]


def ends_of(ends: Any, closed: bool) -> tuple[str | None, str | None]:
    """End conditions of the first and the last end, if given."""
    both = ends if isinstance(ends, (tuple, list)) and len(ends) == 2 else (ends, ends)
    words = tuple(None if e is None else str(e) for e in both)
    return (None, None) if closed else (words[0], words[1])


def index_of(given: Any, count: int) -> int:
    """The number of a point, from 0."""
    k = int(given)
    if not 0 <= k < count:
        raise FairingError(f"expected points from 0 to {count - 1}, found {k}", index=max(k, 0))
    return k


explain(globals())
