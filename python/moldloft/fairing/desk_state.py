"""The state of a fairing desk, and the commands that change it.

A command is a line of text: a keyword and its arguments. Points and lines are counted from 1. The
state is a value: a command makes another one, so that a log of commands is the whole history.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.desk_source import DeskLine, DeskSource, Place, place

__all__ = ["COMMANDS", "DeskDraft", "DeskState", "changed"]

COMMANDS: dict[str, str] = {
    "tolerance": "tolerance X; tolerance X line L; tolerance X point K",
    "weight": "weight W point K: its tolerance is divided by W",
    "goal": "goal near or goal fairest",
    "knuckle": "knuckle K: an intended break",
    "fix": "fix K: the curve passes through the point",
    "free": "free K: removes marks of the point; a moved one returns",
    "move": "move K X Y Z: moves and fixes the point",
    "accept": "accept K: the suspect is a wrong reading, without a tolerance",
    "straight": "straight A-B, or straight A-B X,Y in a direction",
    "flat": "flat A-B: straight along the axis nearest to it",
    "arc": "arc A-B: a circular arc",
    "one-way": "one-way A-B: no inflection",
    "convex": "convex A-B: turns to the left only",
    "concave": "concave A-B: turns to the right only",
    "side": "side X,Y line L: the curve leaves its points only against this direction",
    "within": "within X,Y:MAX line L: the largest value along a direction",
    "pieces": "pieces N line L: at most N pieces of monotone curvature",
    "clear": "clear line L: removes its shape conditions",
    "range": "range A-B: points outside do not move; range off",
    "lock": "lock L: keeps the line in its current state",
    "unlock": "unlock L",
    "cut": "cut z 1.5, or cut X,Y,Z:C: section of the network by a plane",
    "put": "put back: adds the section line to the network",
    "drop": "drop: deletes the section line",
}
"""The commands, with their arguments."""

_SPANS = ("straight", "flat", "arc", "one-way", "convex", "concave")
_SPAN = re.compile(r"(\d+)\s*-\s*(\d+)")


@dataclass(frozen=True)
class DeskDraft:
    """A section line of a network, not yet merged into it."""

    name: str
    """Such as ``z = 1.5``."""
    normal: Place
    """The normal of its plane."""
    points: tuple[Place, ...]
    """Intersections of the plane with the lines."""
    on: tuple[tuple[tuple[int, int], ...], ...]
    """For each point, the lines through it, each with its number of points before; empty for a
    point of the network.
    """
    known: tuple[int, ...]
    """Index of each point in the network, -1 for a new one."""


@dataclass(frozen=True)
class DeskState:
    """The decisions made at a desk. Points and lines are counted from 0."""

    tolerance: float
    """Maximum distance of curves from points."""
    points: tuple[Place, ...]
    """The points, with moved ones at their new positions."""
    lines: tuple[DeskLine, ...]
    """The lines, including merged section lines."""
    goal: str = "near"
    """``"near"`` or ``"fairest"``."""
    line_tolerances: Mapping[int, float] = field(default_factory=dict)
    """Individual tolerances of lines."""
    point_tolerances: Mapping[int, float] = field(default_factory=dict)
    """Individual tolerances of points."""
    weights: Mapping[int, float] = field(default_factory=dict)
    """Weights of points, which divide their tolerances."""
    knuckles: frozenset[int] = frozenset()
    """Intended breaks."""
    fixed: frozenset[int] = frozenset()
    """Points that curves pass through."""
    released: frozenset[int] = frozenset()
    """Wrong readings."""
    shapes: tuple[tuple[int, str], ...] = ()
    """Shape conditions of lines; their points are numbered along the line from 1."""
    span: tuple[int, int, int] | None = None
    """A line, with the first and last index along it of the faired range."""
    locked: Mapping[int, DeskState] = field(default_factory=dict)
    """Locked lines, each with the state at its locking."""
    held: Mapping[int, Place] = field(default_factory=dict)
    """Positions of points of locked lines of a network."""
    draft: DeskDraft | None = None
    """A line that was cut."""

    def limit(self, point: int, line: int | None = None) -> float:
        """The tolerance of a point, on a line.

        Parameters
        ----------
        point, line
            Numbers from 0; without a line the smallest of its lines.
        """
        own = self.point_tolerances.get(point)
        if own is None:
            of = [line] if line is not None else [
                k for k, o in enumerate(self.lines) if point in o.points
            ]  # fmt: skip
            own = min((self.line_tolerances.get(k, self.tolerance) for k in of), default=0.0)
        return own / self.weights.get(point, 1.0)

    def line_of(self, a: int, b: int) -> tuple[int, int, int]:
        """The line through two points, and their indices along it, ascending.

        Parameters
        ----------
        a, b
            Points from 0.
        """
        for k, line in enumerate(self.lines):
            if a in line.points and b in line.points:
                first, last = sorted((line.points.index(a), line.points.index(b)))
                return k, first, last
        raise FairingError(f"points {a + 1} and {b + 1} are on no line together")


class Eyes(Protocol):
    """Queries of commands about the faired result of a state."""

    def places(self, state: DeskState) -> tuple[Place, ...]:
        """Positions of the points."""

    def suspicion(self, state: DeskState, point: int) -> tuple[str, Place | None] | None:
        """Suspicion about a point, with a suggested reading, if there is one."""

    def cut_along(self, state: DeskState, normal: Place, at: float, name: str) -> DeskDraft:
        """The line along a plane."""

    def drafted(self, state: DeskState) -> tuple[Place, ...]:
        """The faired points of the section line."""


def changed(source: DeskSource, state: DeskState, command: str, eyes: Eyes) -> DeskState:
    """The state after a command.

    Parameters
    ----------
    source
        The input of the desk.
    state
        The state before.
    command
        A line of text, see :data:`COMMANDS`.
    eyes
        Queries about the faired result of a state.

    Raises
    ------
    FairingError
        If it is not a command, or not applicable to the state.
    """
    words = command.replace("\u2212", "-").split()
    word = words[0].lower() if words else ""
    if word not in COMMANDS:
        raise FairingError(f"`{command}` is not a command; expected one of: {', '.join(COMMANDS)}")
    parse = _Words(source, state, word, words[1:])
    if word in _SPANS:
        return _shaped(state, word, parse)
    if word in ("side", "within", "pieces"):
        text = parse.next()
        line = parse.line("line")
        return _with_shape(state, line, f"{word}={text}")
    if word == "clear":
        line = parse.line("line")
        return replace(state, shapes=tuple(s for s in state.shapes if s[0] != line))
    if word == "range":
        return _ranged(state, parse)
    if word in ("tolerance", "weight"):
        return _limited(state, word, parse)
    if word == "goal":
        goal = parse.next()
        if goal not in ("near", "fairest"):
            raise FairingError(f"goal: expected near or fairest, found `{goal}`")
        return replace(state, goal=goal)
    if word == "accept":
        return _accepted(source, state, parse.point(), eyes)
    if word in ("knuckle", "fix", "free", "move"):
        return _marked(source, state, word, parse)
    if word in ("lock", "unlock"):
        return _locked(source, state, parse.line(None), word == "lock", eyes)
    if word == "cut":
        normal, at, name = parse.plane()
        if source.kind != "network":
            raise FairingError("cut: only networks have sections")
        return replace(state, draft=eyes.cut_along(state, normal, at, name))
    if state.draft is None:
        raise FairingError(f"{command}: no line was cut")
    if word == "put":
        return put_back(state, state.draft, eyes.drafted(state))
    return replace(state, draft=None)


class _Words:
    """The words of a command, taken one by one."""

    def __init__(self, source: DeskSource, state: DeskState, word: str, rest: list[str]) -> None:
        self._state, self._word, self._rest, self._source = state, word, rest, source

    def fault(self, found: str) -> FairingError:
        return FairingError(f"expected {COMMANDS[self._word]}; found {found}")

    @property
    def left(self) -> bool:
        return bool(self._rest)

    def next(self) -> str:
        if not self._rest:
            raise self.fault("its end")
        return self._rest.pop(0)

    def number(self) -> float:
        text = self.next()
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.fault(f"`{text}`")
        return value

    def point(self, key: str | None = None) -> int:
        return self._counted(key, len(self._state.points), "point")

    def line(self, key: str | None) -> int:
        if key is not None and not self._rest and len(self._state.lines) == 1:
            return 0
        return self._counted(key, len(self._state.lines), "line")

    def _counted(self, key: str | None, count: int, what: str) -> int:
        if key is not None and (word := self.next()) != key:
            raise self.fault(f"`{word}`")
        text = self.next()
        if not text.isdigit() or not 1 <= int(text) <= count:
            raise FairingError(f"{self._word}: expected a {what} from 1 to {count}, found `{text}`")
        return int(text) - 1

    def ends(self) -> tuple[int, int, int]:
        text = self.next()
        found = _SPAN.fullmatch(text)
        count = len(self._state.points)
        if found is None or not all(1 <= int(k) <= count for k in found.groups()):
            raise FairingError(
                f"{self._word}: expected points A-B from 1 to {count}, found `{text}`"
            )
        return self._state.line_of(int(found[1]) - 1, int(found[2]) - 1)

    def plane(self) -> tuple[Place, float, str]:
        text = self.next()
        if text in ("x", "y", "z"):
            at = self.number()
            normal = (float(text == "x"), float(text == "y"), float(text == "z"))
            return normal, at, f"{text} = {at:g}"
        direction, colon, level = text.partition(":")
        try:
            x, y, z = (float(c) for c in direction.split(","))
            at = float(level)
        except ValueError:
            raise self.fault(f"`{text}`") from None
        size = math.hypot(x, y, z)
        if not colon or not math.isfinite(size) or size == 0 or not math.isfinite(at):
            raise self.fault(f"`{text}`")
        return (x / size, y / size, z / size), at / size, f"plane {text}"


def _with_shape(state: DeskState, line: int, text: str) -> DeskState:
    pair = (line, text)
    kept = tuple(s for s in state.shapes if s != pair)
    # Marking it again takes the mark away.
    return replace(state, shapes=kept if len(kept) < len(state.shapes) else (*kept, pair))


def _shaped(state: DeskState, word: str, words: _Words) -> DeskState:
    line, first, last = words.ends()
    span = f"{first + 1}-{last + 1}"
    if word == "flat":
        own = state.lines[line].points
        a, b = state.points[own[first]], state.points[own[last]]
        way = max(range(3), key=lambda c: abs(b[c] - a[c]))
        axis = ",".join("1" if c == way else "0" for c in range(3))
        return _with_shape(state, line, f"straight={span}:{axis}")
    toward = f":{words.next()}" if word == "straight" and words.left else ""
    return _with_shape(state, line, f"{word}={span}{toward}")


def _ranged(state: DeskState, words: _Words) -> DeskState:
    if words._rest == ["off"]:
        return replace(state, span=None)
    return replace(state, span=words.ends())


def _limited(state: DeskState, word: str, words: _Words) -> DeskState:
    value = words.number()
    if value < 0 or (word == "weight" and value == 0):
        raise words.fault(f"{value:g}")
    if word == "weight":
        return replace(state, weights={**state.weights, words.point("point"): value})
    if not words.left:
        return replace(state, tolerance=value)
    if words._rest[0] == "line":
        return replace(state, line_tolerances={**state.line_tolerances, words.line("line"): value})
    own = {**state.point_tolerances, words.point("point"): value}
    return replace(state, point_tolerances=own)


def _toggled(of: frozenset[int], point: int) -> frozenset[int]:
    return of ^ {point}


def _marked(source: DeskSource, state: DeskState, word: str, words: _Words) -> DeskState:
    point = words.point()
    if word == "knuckle":
        return replace(state, knuckles=_toggled(state.knuckles, point))
    if word == "fix":
        return replace(state, fixed=_toggled(state.fixed, point))
    points = list(state.points)
    if word == "move":
        to = [words.number() for _ in range(min(3, max(2, len(words._rest))))]
        goal = place([*to, points[point][2]] if len(to) == 2 else to)
        points[point] = along(source.motion, points[point], goal)
        return replace(state, points=tuple(points), fixed=state.fixed | {point})
    if point < len(source.points) and points[point] != source.points[point]:
        # Of two that were swapped both return.
        read, now = source.points[point], points[point]
        for k, given in enumerate(source.points):
            if given == now and points[k] == read:
                points[k] = given
        points[point] = read

    def without(own: Mapping[int, float]) -> dict[int, float]:
        return {k: v for k, v in own.items() if k != point}

    return replace(
        state,
        points=tuple(points),
        fixed=state.fixed - {point},
        knuckles=state.knuckles - {point},
        released=state.released - {point},
        weights=without(state.weights),
        point_tolerances=without(state.point_tolerances),
    )


def _accepted(source: DeskSource, state: DeskState, point: int, eyes: Eyes) -> DeskState:
    """The state with a suspicion accepted, or no longer."""
    if point in state.released:
        points = list(state.points)
        points[point] = source.points[point]
        return replace(state, released=state.released - {point}, points=tuple(points))
    found = eyes.suspicion(state, point)
    kind, reading = found if found is not None else ("outlier", None)
    if kind == "corner":
        return replace(state, knuckles=_toggled(state.knuckles, point))
    points = list(state.points)
    if kind == "order":
        own = next(o.points for o in state.lines if point in o.points)
        after = own[(own.index(point) + 1) % len(own)]
        points[point], points[after] = points[after], points[point]
        return replace(state, points=tuple(points))
    if source.kind != "curves":
        # If lines share points, the probable reading replaces the other.
        if reading is None:
            raise FairingError(f"accept {point + 1}: nothing is suspected of this point")
        points[point] = along(source.motion, points[point], reading)
    return replace(state, released=state.released | {point}, points=tuple(points))


def along(motion: str | Place, at: Place, to: Place) -> Place:
    """The permitted position of a point nearest to a given one."""
    if isinstance(motion, str):
        return to
    size = sum(c * c for c in motion)
    far = sum((b - a) * c for a, b, c in zip(at, to, motion, strict=True)) / size
    x, y, z = (a + far * c for a, c in zip(at, motion, strict=True))
    return x, y, z


def _locked(source: DeskSource, state: DeskState, line: int, on: bool, eyes: Eyes) -> DeskState:
    if on == (line in state.locked):
        name = state.lines[line].name
        raise FairingError(f"{name} is {'locked' if on else 'not locked'}")
    if on:
        locked = {**state.locked, line: replace(state, locked={}, held=state.held, draft=None)}
        held = dict(state.held)
        if source.kind != "curves":
            where = eyes.places(state)
            held.update({k: where[k] for k in state.lines[line].points})
        return replace(state, locked=locked, held=held)
    locked = {k: s for k, s in state.locked.items() if k != line}
    still = {k for other in locked for k in state.lines[other].points}
    held = {k: p for k, p in state.held.items() if k in still}
    return replace(state, locked=locked, held=held)


def put_back(state: DeskState, draft: DeskDraft, faired: tuple[Place, ...]) -> DeskState:
    """The state with a section line merged into the network.

    Its points are inserted in the lines that it crosses. These points are fixed at their faired
    positions, since they are not readings.
    """
    points, fixed = list(state.points), set(state.fixed)
    lists = [list(line.points) for line in state.lines]
    numbers = []
    inserted: dict[int, list[tuple[int, int]]] = {}
    for at, on, known in zip(faired, draft.on, draft.known, strict=True):
        if known >= 0:
            numbers.append(known)
            continue
        number = len(points)
        numbers.append(number)
        points.append(at)
        fixed.add(number)
        for line, before in on:
            inserted.setdefault(line, []).append((before, number))
    for line, pairs in inserted.items():
        for before, number in sorted(pairs, reverse=True):
            lists[line].insert(before, number)
    lines = [
        DeskLine(line.name, tuple(own), line.closed)
        for line, own in zip(state.lines, lists, strict=True)
    ]
    lines.append(DeskLine(draft.name, tuple(numbers)))
    shapes = state.shapes
    if any(line in inserted for line, _ in shapes):
        raise FairingError("put back: clear the shapes of the lines that it crosses first")
    return replace(
        state, points=tuple(points), lines=tuple(lines), fixed=frozenset(fixed), draft=None
    )


explain(globals())
