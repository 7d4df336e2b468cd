"""What callers ask for, in the words of the kernel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import direction

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass
class Asked:
    """How data are to be faired."""

    closed: bool
    degree: int
    measure: str | None
    breaks: Sequence[int] | str
    release: Sequence[int] | str
    fixed: Sequence[int]
    ends: Any
    motion: Any
    spacing: Any
    at: ArrayLike | None
    goal: tuple[str, float | None]
    bends: bool
    shape: list[Any]
    accuracy: float


BUDGET = 0.8
"""Of what noise has in squared residuals that fills the tolerances evenly."""


def goal_of_curve(given: Any) -> tuple[str, float | None]:
    """The word of a goal and its share; none where it goes by the dimension of the curve."""
    word, share = goal_of(given)
    own = isinstance(given, tuple) or word not in ("near", "budget")
    return word, share if own else None


def goal_of(given: Any) -> tuple[str, float]:
    """The word of a goal and its share."""
    word, share = given if isinstance(given, tuple) and len(given) == 2 else (given, None)
    known = {"near": BUDGET, "budget": BUDGET, "fairest": 0.0, "nearest": 0.1, "closest": 0.0}
    if word == "energy":
        if share is None:
            raise FairingError('the goal `energy` takes the largest measure: ("energy", 2.5)')
        return "energy", float(share)
    if word not in known:
        raise FairingError(f"unknown goal `{word}`; there are: {', '.join(known)}, energy")
    return str(word), known[word] if share is None else float(share)


def only_data(goal: Any) -> None:
    """Refuse goals that tell one result from another where there are no data to be near to."""
    word, _ = goal_of(goal)
    if word not in ("near", "fairest"):
        raise FairingError(f'the goal `{word}` is for optima of data, `as_="fit"`')


EXACT = (
    "the points are on lines, conics, plane cubics or helices and stay as they are: the goal "
    "`fairest` moves them"
)
"""What is said where exact points stay although others would move."""

EXACT_NEAREST = (
    "the points are on lines, conics, plane cubics or helices: of the splines with these knots the "
    "one nearest to them is taken; the goal `fairest` moves it"
)
"""The same of splines that need not pass through them."""


def stays_near(goal: Any, free: bool) -> bool:
    """Whether a goal leaves exact points where they are: nothing else is asked of them."""
    return free and goal_of(goal)[0] == "near"


def curve_spacing(asked: Asked, conditioned: bool) -> Any:
    """The spacing of the points of a curve: by its turns where it is to be near the truth."""
    if asked.spacing != "auto":
        return asked.spacing
    plain = not conditioned and not asked.shape and asked.motion == "ball"
    ends = ends_of(asked.ends or "free", asked.closed)
    plain = plain and set(ends) <= {"free", "position"}
    return "curvature" if plain and asked.goal[0] in ("near", "budget") else "chord"


def spacing_of(given: Any) -> tuple[str, tuple[float, float, float]]:
    """The word and the direction of a spacing."""
    given = "chord" if isinstance(given, str) and given == "auto" else given
    axes = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    if isinstance(given, str):
        return ("along", axes[given]) if given in axes else (given, (0.0, 0.0, 0.0))
    return "along", direction(given)[1]


def ends_of(ends: Any, closed: bool) -> tuple[str, str]:
    """What the first and the last end keep."""
    both = ends if isinstance(ends, (tuple, list)) and len(ends) == 2 else (ends, ends)
    words = tuple(f"points:{e}" if isinstance(e, int) else str(e) for e in both)
    return ("free", "free") if closed else (words[0], words[1])


def index_of(given: Any, count: int) -> int:
    """The number of a point, from 0."""
    k = int(given)
    if not 0 <= k < count:
        raise FairingError(f"expected points from 0 to {count - 1}, found {k}", index=max(k, 0))
    return k


explain(globals())
