"""Result of a state of a fairing desk: its faired lines, with notes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import FairingError
from moldloft.fairing.curve import fair_curve
from moldloft.fairing.desk_source import DeskSource, Place, place
from moldloft.fairing.desk_state import DeskDraft, DeskState
from moldloft.fairing.faired import Fairing
from moldloft.fairing.network import NetworkFairing, network
from moldloft.fairing.report import Finding, claims_optimum
from moldloft.fairing.spline import Spline
from moldloft.fairing.surface import SurfaceFairing, fair_surface

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["DeskCurve", "DeskResult", "DeskSuspect", "Task", "cut", "draft_task", "faired"]

KEPT = 256
"""Fairings that are remembered: undo and the line before last cost nothing."""

_STANDS_OUT = 3.0
"""Deviation, in errors of the prediction, above which a reading of a network is listed. The largest
in 144 clean tables is 2.7; 93 % of 144 planted errors of ten tolerances or more exceed it.
"""

ON_PLANE = 1e-9
"""Maximum distance of a point on a plane, relative to the extent."""

PER_SPAN = 16
"""Samples on a span between which a plane is looked for."""

DEGREE = 3

STEEP = 0.2
"""The least cosine between an error across a curve and the direction in which points move."""


@dataclass(frozen=True)
class Task:
    """A line that is faired separately: all data that determine its result."""

    points: tuple[Place, ...]
    width: int
    tolerances: tuple[float, ...]
    fixed: tuple[int, ...] = ()
    breaks: tuple[int, ...] = ()
    released: tuple[int, ...] = ()
    shape: tuple[str, ...] = ()
    goal: str = "near"
    motion: str | Place | tuple[str, Place] = "ball"
    closed: bool = False
    span: tuple[int, int] | None = None
    draft: bool = False
    options: tuple[tuple[str, Any], ...] = ()


@dataclass(frozen=True)
class _NetTask:
    points: tuple[Place, ...]
    width: int
    lines: tuple[tuple[int, ...], ...]
    tolerances: tuple[float, ...]
    fixed: tuple[int, ...]
    breaks: tuple[int, ...]
    goal: str
    motion: str | Place


@dataclass(frozen=True)
class _SurfaceTask:
    points: tuple[Place, ...]
    grid: tuple[int, int]
    tolerances: tuple[float, ...]
    fixed: tuple[int, ...]
    breaks: tuple[tuple[int, ...], tuple[int, ...]]
    goal: str
    motion: str | Place


@dataclass(frozen=True)
class DeskCurve:
    """A line of a desk, before and after."""

    name: str
    """Name of the line."""
    points: tuple[int, ...]
    """Its points, from 0."""
    before: Spline
    """The curve through its points."""
    after: Spline
    """The faired curve."""
    moved: Floats
    """Distance of each point from the curve, or its displacement."""
    limits: Floats
    """The tolerance of each."""
    inflections: tuple[int, int]
    """Sign changes of the curvature before and after."""
    pieces: tuple[int, int]
    """Monotone pieces of the curvature before and after."""
    jumps: tuple[Floats, Floats]
    """The jumps of the third derivative at the knots before and after."""
    certified: bool
    """True if the result is proved to be the optimum, up to :attr:`gap`."""
    gap: float
    """The gap relative to the measure."""
    locked: bool
    """True if the line is locked in an earlier state."""
    draft: bool
    """True if it is a draft for interactive use."""
    notes: tuple[str, ...] = ()
    """Notes for the user."""

    @property
    def share(self) -> float:
        """The largest used fraction of a limit; 0 if no point moves."""
        shares = self.moved / np.where(self.limits > 0, self.limits, np.inf)
        return float(shares[np.isfinite(shares)].max(initial=0.0))

    @property
    def worst(self) -> int:
        """Index of the point with the largest displacement."""
        return self.points[int(np.argmax(self.moved))]

    @property
    def kept(self) -> bool:
        """True if every point without a release is within its limit."""
        finite = np.isfinite(self.limits)
        scale = float(np.abs(self.before.control_points).max(initial=0.0))
        rounding = 1e-6 * self.limits[finite] + 64 * np.finfo(float).eps * scale
        return bool((self.moved[finite] <= self.limits[finite] + rounding).all())


@dataclass(frozen=True)
class DeskSuspect:
    """A point whose deviation noise does not explain."""

    point: int
    """The point, from 0."""
    line: int
    """Index of the line on which it was found, from 0."""
    kind: str
    """``"outlier"``, ``"corner"`` or ``"order"``."""
    text: str
    """A sentence about it."""
    reading: Place | None
    """Position that was meant, or else predicted by its neighbours, for a wrong reading."""
    accepted: bool
    """True if the suspicion was accepted."""


@dataclass(frozen=True)
class DeskResult:
    """A state, faired."""

    state: DeskState
    """The state."""
    curves: tuple[DeskCurve, ...]
    """Its lines."""
    points: tuple[Place, ...]
    """Positions of the points."""
    suspects: tuple[DeskSuspect, ...]
    """Suspects and notes of the lines."""
    parts: tuple[Fairing | NetworkFairing | SurfaceFairing, ...]
    """The fairings: one for each curve, or the one of the network or surface."""


Progress = Callable[[int, int, str], object]
"""Callback with the number of finished lines, their total, and the name of the next; false ends the
work.
"""


def faired(
    source: DeskSource, state: DeskState, *, draft: bool = False, progress: Progress | None = None
) -> DeskResult:
    """A state with its lines faired; the bits do not depend on earlier fairings."""
    if source.kind == "network":
        return _of_network(source, state)
    if source.kind == "surface":
        return _of_surface(source, state)
    points = list(state.points)
    parts, curves = [], []
    suspects: list[DeskSuspect] = []
    for k, line in enumerate(state.lines):
        if progress is not None and progress(k, len(state.lines), line.name) is False:
            raise FairingError(f"fairing was stopped before {line.name}")
        asked = task(source, state, k, draft)
        try:
            fairing = fair_line(asked)
        except FairingError as error:
            named = str(error) if len(state.lines) == 1 else f"{line.name}: {error}"
            raise FairingError(named) from error
        parts.append(fairing)
        for own, at in zip(line.points, fairing.points, strict=True):
            points[own] = place(at)
        curves.append(_curve(state, k, asked, fairing))
        found = () if source.control else (*fairing.findings, *fairing.corrected)
        suspects += [_suspect(source.motion, state, line.points[f.index], k, f) for f in found]
    suspects.sort(key=lambda s: (s.line, s.point))
    return DeskResult(state, tuple(curves), tuple(points), tuple(suspects), tuple(parts))


def task(source: DeskSource, state: DeskState, k: int, draft: bool = False) -> Task:
    """The data that determine the result of a line that is faired separately."""
    if k in state.locked:
        return task(source, state.locked[k], k)
    line = state.lines[k]
    at = {p: i for i, p in enumerate(line.points)}

    def own(points: frozenset[int]) -> tuple[int, ...]:
        return tuple(sorted(at[p] for p in points if p in at))

    span = state.span[1:] if state.span is not None and state.span[0] == k else None
    goal = state.goal
    if state.span is not None and span is None:
        # Outside of the range nothing moves, other lines neither.
        span = (0, 0)
    fixed = own(state.fixed)
    if source.control and span is not None:
        # Of the curve through control points, those inside of the range are free.
        inside = range(span[0], span[1] + 1)
        fixed = tuple(k for k in range(len(line.points)) if k in fixed or k not in inside)
    return Task(
        points=tuple(state.points[p] for p in line.points),
        width=source.width,
        tolerances=tuple(state.limit(p, k) for p in line.points),
        fixed=fixed,
        breaks=own(state.knuckles),
        released=own(state.released),
        shape=tuple(text for of, text in state.shapes if of == k),
        goal=goal,
        motion=source.motion,
        closed=line.closed,
        span=span,
        draft=draft and span is None and not source.control,
        options=source.options,
    )


@lru_cache(maxsize=KEPT)
def fair_line(asked: Task) -> Fairing:
    """A line faired separately."""
    points = np.array(asked.points)[:, : asked.width]
    if asked.span is not None and not asked.options:
        return _ranged(asked, points)
    return fair_curve(
        points,
        asked.tolerances,
        closed=asked.closed,
        fixed=asked.fixed,
        breaks=asked.breaks,
        release=asked.released,
        shape=asked.shape,
        goal=asked.goal,
        motion=asked.motion,
        draft=asked.draft,
        **{"as_" if name == "as" else name: value for name, value in asked.options},
    )


def _ranged(asked: Task, points: Floats) -> Fairing:
    """The curve through the points, faired between two of them.

    Control points of which the curve outside hangs stay, so that it stays there to the bit.
    """
    first, last = asked.span or (0, 0)
    if asked.shape or asked.released or asked.closed:
        raise FairingError(
            "a range of an open line takes knuckles and fixed points: clear its shapes and "
            "released readings, or end the range"
        )
    spline, at, marks = Spline._interpolated(points, DEGREE, "chord", False, asked.breaks)
    knots, (low, high) = spline.knots, spline.domain
    t = low + (high - low) * np.asarray(at)
    count = len(spline.control_points)
    free = [
        j
        for j in range(count)
        if knots[j] >= t[first] and knots[j + DEGREE + 1] <= t[last] and j not in marks
    ]
    if first < last and not free:
        raise FairingError(
            f"expected a range of at least {DEGREE + 2} points, found {last - first + 1}"
        )
    held = {j for j in range(count) if j not in free}
    for k in asked.fixed:
        held |= {j for j in range(count) if knots[j] <= t[k] <= knots[j + DEGREE + 1]}
    limit = np.array(asked.tolerances)
    inside = limit[first : last + 1]
    # The bound is one of the curve from the curve, and so of each point.
    bound = float(inside.min()) if first < last else 0.0
    done = fair_curve(
        points,
        bound,
        as_="fit",
        bound="curve",
        breaks=asked.breaks,
        fixed=sorted(held),
        ends="free",
        goal=asked.goal,
        motion=asked.motion,
        measure="variation",
    )
    rows = done.points.copy()
    outside = np.ones(len(rows), bool)
    outside[first + 1 : last] = False
    rows[outside] = points[outside]
    return replace(done, points=rows)


def _curve(state: DeskState, k: int, asked: Task, fairing: Fairing) -> DeskCurve:
    line = state.lines[k]
    limits = np.array(asked.tolerances)
    limits[list(asked.fixed)] = 0.0
    limits[list(asked.breaks)] = 0.0
    limits[list(asked.released)] = np.inf
    if asked.span is not None:
        outside = np.ones(len(limits), bool)
        outside[asked.span[0] : asked.span[1] + 1] = False
        limits[outside] = 0.0
    moved = fairing.residuals
    if moved is None:
        moved = np.linalg.norm(fairing.points - np.array(asked.points)[:, : asked.width], axis=1)
    before, after = fairing.before, fairing.after
    return DeskCurve(
        name=line.name,
        points=line.points,
        before=fairing.original,
        after=fairing.spline,
        moved=np.asarray(moved),
        limits=limits,
        inflections=(before.inflections, after.inflections),
        pieces=(before.pieces, after.pieces),
        jumps=(fairing.jump_lengths_before, fairing.jump_lengths_after),
        certified=not asked.draft and claims_optimum(fairing.gap, fairing.gap_relative),
        gap=fairing.gap_relative,
        locked=k in state.locked,
        draft=asked.draft,
        notes=fairing.notes,
    )


def _reading(at: Place, off: Place, motion: str | Place) -> Place:
    """Correct position of a wrong point, whose motion may be restricted to a direction."""
    error = np.array(off)
    if not isinstance(motion, str):
        way = np.array(motion) / np.linalg.norm(motion)
        across = float(error @ way)
        # A curve along the direction has no definite distance in it.
        if abs(across) > STEEP * float(np.linalg.norm(error)):
            error = way * (float(error @ error) / across)
    return place(np.array(at) - error)


def _suspect(
    motion: str | Place,
    state: DeskState,
    point: int,
    line: int,
    finding: Finding,
    text: str | None = None,
) -> DeskSuspect:
    outlier = finding.kind == "outlier"
    reading = _reading(state.points[point], finding.vector, motion) if outlier else None
    accepted = point in (state.knuckles if finding.kind == "corner" else state.released)
    words = text or finding.text.replace(f"point {finding.index + 1}", f"point {point + 1}", 1)
    return DeskSuspect(point, line, finding.kind, words, reading, accepted)


def _jumps(spline: Spline) -> Floats:
    """The sizes of the jumps at the knots of a curve."""
    return np.asarray(np.linalg.norm(spline.jumps()[1], axis=-1))


# -- networks ------------------------------------------------------------------------------------


def corners(lines: Sequence[tuple[int, ...]], closed: Sequence[bool], count: int) -> list[int]:
    """Points that are ends of all lines through them."""
    uses, ends = np.zeros(count, int), np.zeros(count, int)
    for own, around in zip(lines, closed, strict=True):
        uses[list(own)] += 1
        if not around:
            ends[[own[0], own[-1]]] += 1
    return [int(k) for k in np.flatnonzero((ends > 0) & (ends == uses))]


def _still(source: DeskSource, state: DeskState) -> set[int]:
    """Points that do not move: fixed and locked ones, and those outside of the range."""
    still = set(state.fixed) | set(state.held)
    if state.span is not None:
        line, first, last = state.span
        inside = state.lines[line].points[first : last + 1]
        still |= set(range(len(state.points))) - set(inside)
    return still


def _placed(state: DeskState) -> list[Place]:
    points = list(state.points)
    for k, at in state.held.items():
        points[k] = at
    return points


def _of_network(source: DeskSource, state: DeskState) -> DeskResult:
    if state.shapes:
        word = state.shapes[0][1].partition("=")[0]
        raise FairingError(f"{word}: shape conditions apply to single curves, not to networks")
    lists = tuple(o.points + o.points[:1] if o.closed else o.points for o in state.lines)
    own = [line.points for line in state.lines]
    closed = [o.closed for o in state.lines]
    still = _still(source, state) | set(corners(own, closed, len(state.points)))
    asked = _NetTask(
        points=tuple(_placed(state)),
        width=source.width,
        lines=lists,
        tolerances=tuple(state.limit(k) for k in range(len(state.points))),
        fixed=tuple(sorted(still)),
        breaks=tuple(sorted(state.knuckles)),
        goal=state.goal,
        motion=source.motion,
    )
    made = _fair_network(asked)
    moves = np.linalg.norm(made.points - np.array(asked.points)[:, : source.width], axis=1)
    limits = np.array(asked.tolerances)
    limits[list(asked.fixed)] = 0.0
    limits[list(asked.breaks)] = 0.0
    curves = []
    for k, (line, before, after) in enumerate(
        zip(state.lines, made.originals, made.curves, strict=True)
    ):
        at = list(line.points)
        curves.append(
            DeskCurve(
                line.name, line.points, before, after, moves[at], limits[at],
                (before.inflections(), after.inflections()),
                (before.monotone_pieces(), after.monotone_pieces()),
                (_jumps(before), _jumps(after)),
                claims_optimum(made.gap, made.gap_relative), made.gap_relative,
                k in state.locked, False, made.notes,
            )
        )  # fmt: skip
    others = [
        _suspect(source.motion, state, f.index, k, f, made.text(f))
        for k, f in made.findings
        if f.kind != "outlier"
    ]
    points = tuple(place(p) for p in made.points)
    return DeskResult(state, tuple(curves), points, (*_readings(state, made), *others), (made,))


def _readings(state: DeskState, made: NetworkFairing) -> tuple[DeskSuspect, ...]:
    """The wrong readings of a network, the clearest first: of all lines of a point together."""
    out = []
    for found in made.suspects():
        if found.score < _STANDS_OUT:
            continue
        reading = list(state.points[found.index])
        reading[found.axis] = found.expected if found.meant is None else found.meant
        line = next(k for k, own in enumerate(made.lists) if found.index in own)
        accepted = found.index in state.released
        out.append(DeskSuspect(found.index, line, "outlier", str(found), place(reading), accepted))
    return tuple(out)


@lru_cache(maxsize=KEPT // 8)
def _fair_network(asked: _NetTask) -> NetworkFairing:
    return network(
        np.array(asked.points)[:, : asked.width],
        asked.lines,
        asked.tolerances,
        measure="third",
        goal=asked.goal,
        breaks=asked.breaks,
        fixed=list(asked.fixed),
        motion=asked.motion,
    )


# -- surfaces ------------------------------------------------------------------------------------


def _of_surface(source: DeskSource, state: DeskState) -> DeskResult:
    if state.shapes:
        raise FairingError("shape conditions apply to single curves, not to surfaces")
    m, n = source.grid
    knuckles = sorted(state.knuckles)
    rows = sorted({k // n for k in knuckles if all(k // n * n + j in knuckles for j in range(n))})
    columns = sorted({k % n for k in knuckles if all(i * n + k % n in knuckles for i in range(m))})
    alone = [k for k in knuckles if k // n not in rows and k % n not in columns]
    if alone:
        raise FairingError(
            f"knuckle {alone[0] + 1}: on a surface, knuckles are whole rows or columns of points"
        )
    asked = _SurfaceTask(
        points=tuple(_placed(state)),
        grid=(m, n),
        tolerances=tuple(state.limit(k) for k in range(m * n)),
        fixed=tuple(sorted(_still(source, state))),
        breaks=(tuple(rows), tuple(columns)),
        goal=state.goal,
        motion=source.motion,
    )
    made = _fair_surface(asked)
    data = np.array(asked.points).reshape(m, n, 3)
    moves = np.linalg.norm(made.points - data, axis=-1).ravel()
    limits = np.array(asked.tolerances)
    limits[list(asked.fixed)] = 0.0
    curves = []
    for k, line in enumerate(state.lines):
        at = list(line.points)
        flat = made.points.reshape(-1, 3)
        before, after = (Spline.interpolate(p[at]) for p in (data.reshape(-1, 3), flat))
        curves.append(
            DeskCurve(
                line.name, line.points, before, after, moves[at], limits[at],
                (before.inflections(), after.inflections()),
                (before.monotone_pieces(), after.monotone_pieces()),
                (_jumps(before), _jumps(after)),
                claims_optimum(made.gap, made.gap_relative), made.gap_relative,
                k in state.locked, False, made.notes,
            )
        )  # fmt: skip
    suspects = []
    for f in made.findings:
        on = m + f.index % n if f.index // n in (0, m - 1) else f.index // n
        suspects.append(_suspect(source.motion, state, f.index, on, f))
    places = tuple(place(p) for p in made.points.reshape(-1, 3))
    return DeskResult(state, tuple(curves), places, tuple(suspects), (made,))


@lru_cache(maxsize=KEPT // 8)
def _fair_surface(asked: _SurfaceTask) -> SurfaceFairing:
    m, n = asked.grid
    return fair_surface(
        np.array(asked.points).reshape(m, n, 3),
        np.array(asked.tolerances).reshape(m, n),
        as_="fit",
        goal=asked.goal,
        breaks=asked.breaks,
        fixed=[(k // n, k % n) for k in asked.fixed],
        motion=asked.motion,
    )


# -- lines cut from a network --------------------------------------------------------------------


def cut(source: DeskSource, state: DeskState, normal: Place, at: float, name: str) -> DeskDraft:
    """The line along which a plane meets the faired lines of a network."""
    made = faired(source, state)
    n = np.array(normal)
    extent = float(np.ptp(np.array(made.points), axis=0).max())
    met: list[tuple[Floats, int, int]] = []
    for k, curve in enumerate(made.curves):
        samples = curve.after.samples(PER_SPAN)
        off = samples.points @ n - at
        if (np.abs(off) <= ON_PLANE * extent).all():
            raise FairingError(f"cut {name}: {curve.name} is in this plane")
        for t in _roots(curve.after, samples.t, off, n, at):
            own = np.array([made.points[p] for p in curve.points])
            before = int(np.searchsorted(_parameters(curve.after, own, samples), t))
            met.append((curve.after(np.array([t]))[0], k, before))
    joined: list[tuple[Floats, list[tuple[int, int]]]] = []
    for p, k, before in met:
        near = next((j for j in joined if np.linalg.norm(j[0] - p) <= 1e-6 * extent), None)
        if near is None:
            joined.append((p, [(k, before)]))
        else:
            near[1].append((k, before))
    if len(joined) < DEGREE + 2:
        raise FairingError(
            f"cut {name}: expected at least {DEGREE + 2} crossings, found {len(joined)}"
        )
    places = np.array([p for p, _ in joined])
    way = _along(places)
    order = np.argsort(places @ way, kind="stable")
    steps = np.diff((places @ way)[order])
    if (steps <= ON_PLANE * extent).any():
        raise FairingError(f"cut {name}: the crossings are not one line")
    known = []
    own = np.array(made.points)
    for p in places[order]:
        far = np.linalg.norm(own - p, axis=1)
        k = int(np.argmin(far))
        known.append(k if far[k] <= 1e-6 * extent else -1)
    points = tuple(
        made.points[k] if k >= 0 else place(p) for k, p in zip(known, places[order], strict=True)
    )
    on = tuple(
        () if k >= 0 else tuple(joined[int(i)][1]) for k, i in zip(known, order, strict=True)
    )
    return DeskDraft(name, normal, points, on, tuple(known))


def _along(places: Floats) -> Floats:
    """The direction of largest spread of the points."""
    _, _, axes = np.linalg.svd(places - places.mean(axis=0))
    way: Floats = axes[0]
    return way if way[int(np.argmax(np.abs(way)))] > 0 else -way


def _parameters(spline: Spline, points: Floats, samples: Any) -> Floats:
    """Parameters of points on a curve, ascending."""
    at, start = [], 0
    for p in points:
        far = np.linalg.norm(samples.points[start:] - p, axis=1)
        start += int(np.argmin(far))
        at.append(float(samples.t[start]))
    return np.array(at)


def _roots(spline: Spline, t: Floats, off: Floats, n: Floats, at: float) -> list[float]:
    """Parameters at which a curve meets a plane."""
    out = []
    for k in np.flatnonzero(np.diff(np.sign(off)) != 0):
        low, high = float(t[k]), float(t[k + 1])
        if off[k] == 0:
            out.append(low)
            continue
        if off[k + 1] == 0 or low == high:
            if off[k + 1] == 0 and k + 2 == len(off):
                out.append(high)
            continue
        sign = np.sign(off[k])
        for _ in range(60):
            middle = 0.5 * (low + high)
            value = float(spline(np.array([middle]))[0] @ n) - at
            low, high = (middle, high) if np.sign(value) == sign else (low, middle)
        out.append(0.5 * (low + high))
    return out


def draft_task(source: DeskSource, state: DeskState, draft: DeskDraft) -> Task:
    """A section line, faired separately in its plane; points of the network do not move."""
    motion: str | Place | tuple[str, Place] = ("across", draft.normal)
    if not isinstance(source.motion, str):
        along = sum(a * b for a, b in zip(source.motion, draft.normal, strict=True))
        if abs(along) <= ON_PLANE:
            motion = source.motion
    return Task(
        points=draft.points,
        width=3,
        tolerances=tuple(state.tolerance for _ in draft.points),
        fixed=tuple(k for k, known in enumerate(draft.known) if known >= 0),
        goal=state.goal,
        motion=motion,
    )
