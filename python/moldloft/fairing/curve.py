"""Fairing of curves."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import direction, narrowed, points_of, radii, refuse_repeats
from moldloft.fairing.conditions import join_conditions, linear_conditions, shape_conditions
from moldloft.fairing.report import Finding, Numbers, lines_of
from moldloft.fairing.spline import Spline

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["Fairing", "fair_curve"]

MODES = ("optimum", "faithful", "literal", "vertex", "sweeps", "levels")
MEASURES = ("second", "third", "jumps", "jump-lengths", "bending", "variation")
ROLES = ("control", "points", "fit")


@dataclass(frozen=True)
class Arc:
    """A circular arc of a faired curve."""

    first: int
    """Its first point, from 0."""
    last: int
    """Its last point."""
    radius: float
    """Its radius."""
    centre: Floats
    """Its centre."""
    off: float
    """How far the spline is from the circle, sampled."""

    def __str__(self) -> str:
        x = ", ".join(f"{c:.6g}" for c in self.centre)
        return (
            f"points {self.first + 1} to {self.last + 1} are on an arc of radius "
            f"{self.radius:.6g} about ({x}), which the cubic follows to {self.off:.1e}"
        )


@dataclass(frozen=True)
class Fairing:
    """A faired curve and all that is to be said about it."""

    points: Floats
    """The faired points, as many and with as many columns as were given: the control points, the
    points, or where the faired curve has the parameters of the points."""
    spline: Spline
    """The faired curve."""
    original: Spline
    """The curve before."""
    data: Floats
    """The points that were given, in three columns."""
    tol: float | None
    """The largest tolerance; ``None`` for no limit."""
    as_: str
    """What the points were: ``"control"``, ``"points"`` or ``"fit"``."""
    mode: str
    """How it was done."""
    measure: str
    """The measure that was minimised."""
    breaks: tuple[int, ...]
    """Points, from 0, that were intended breaks."""
    before: Numbers
    """The curve before."""
    after: Numbers
    """The faired curve."""
    deviation_certified: float
    """No point of the curve is farther from its original than this: proved, not sampled. For
    ``as_="points"`` the largest move of a point."""
    deviation_sampled: float
    """The largest distance found by sampling."""
    deviation_control: float
    """The largest move of a control point."""
    length: float
    """The length of the original curve."""
    value: float
    """The measure of the result, as the certificate has it."""
    gap: float
    """No curve within the tolerance and with the conditions measures less than ``value - gap``."""
    steps: int
    """Newton steps, local steps or sweeps."""
    stopped: str | None
    """Which rule ended local steps: steps, move, drop, gap, pieces, stalled or done."""
    active: int | None
    """How many limits an optimum reaches."""
    findings: tuple[Finding, ...]
    """Corners and wrong points that stand out and were not taken into account."""
    corrected: tuple[Finding, ...]
    """Those that were, by ``breaks="auto"``."""
    jump_lengths_before: Floats
    """The jump at each knot before."""
    jump_lengths_after: Floats
    """The jump at each knot of the result."""
    notes: tuple[str, ...]
    """What the user should know."""
    seconds: float
    """Time of the fairing."""
    goal: str = "fairest"
    """Which of the curves within the tolerances was wanted."""
    residuals: Floats | None = field(default=None, repr=False)
    """The distance of each point that was given from the curve at its parameter, for fits."""
    used: float | None = None
    """The mean of the squared residuals over tolerances; 1 is noise that fills these evenly."""
    parameters: Floats | None = field(default=None, repr=False)
    """Where the points that were given are on the curve, from 0 to 1."""
    arcs: tuple[Arc, ...] = ()
    """The circular arcs that were asked for."""
    log: tuple[NDArray[np.uint32], Floats] | None = field(default=None, repr=False)
    """Local steps in order, when asked for: which point went where. Replayed on the original they
    give the result's bits."""

    @property
    def deviation_data(self) -> float:
        """No point that was given is farther from the curve than this.

        The distance from the curve's point at its parameter, or the move of the point itself.
        """
        if self.residuals is not None and len(self.residuals):
            return float(self.residuals.max())
        if self.as_ == "points":
            moved = self.points - narrowed(self.data, self.points.shape[1])
            return float(np.linalg.norm(moved, axis=1).max())
        return self.deviation_control

    @property
    def control_points(self) -> Floats:
        """The faired control points, ``(n, 3)``."""
        return self.spline.control_points

    @property
    def jumps_before(self) -> float:
        """Sum of squared jumps before."""
        return self.before.jumps

    @property
    def jumps_after(self) -> float:
        """Sum of squared jumps of the result."""
        return self.after.jumps

    @property
    def deviation_percent(self) -> float:
        """The certified deviation in percent of the length."""
        return 100.0 * self.deviation_certified / self.length if self.length > 0 else 0.0

    @property
    def gap_relative(self) -> float:
        """The gap as a share of the measure (at least a trillionth of the one before)."""
        size = max(self.value, 1e-12 * self.before.measure)
        return self.gap / size if size > 0 else 0.0

    @cached_property
    def displacement(self) -> tuple[Floats, Floats]:
        """How far each place of the curve has moved: share of the arc length and percent of it."""
        if self.spline.closed != self.original.closed:
            raise FairingError("the faired curve and its original are not alike")
        before, after = self.original.samples(8), self.spline.samples(8)
        far = np.linalg.norm(after.points - before.points, axis=1)
        return before.arc, 100.0 * far / self.length if self.length > 0 else far

    def as_dict(self) -> dict[str, Any]:
        """The report as plain data: what ``moldloft fair --json`` prints."""
        return {
            "points": len(self.data),
            "control_points": len(self.control_points),
            "degree": self.spline.degree,
            "closed": self.spline.closed,
            "as": self.as_,
            "mode": self.mode,
            "measure": self.measure,
            "tolerance": self.tol,
            "breaks": [b + 1 for b in self.breaks],
            "goal": self.goal,
            "deviation_data": self.deviation_data,
            "deviation_certified": self.deviation_certified,
            "deviation_sampled": self.deviation_sampled,
            "deviation_control": self.deviation_control,
            "deviation_percent": self.deviation_percent,
            "length": self.length,
            "measure_before": self.before.measure,
            "measure_after": self.after.measure,
            "jumps_before": self.before.jumps,
            "jumps_after": self.after.jumps,
            "largest_jump_before": self.before.largest_jump,
            "largest_jump_after": self.after.largest_jump,
            "monotone_pieces_before": self.before.pieces,
            "monotone_pieces_after": self.after.pieces,
            "inflections_before": self.before.inflections,
            "inflections_after": self.after.inflections,
            "largest_curvature_before": self.before.largest_curvature,
            "largest_curvature_after": self.after.largest_curvature,
            "value": self.value,
            "gap": self.gap,
            "gap_relative": self.gap_relative,
            "steps": self.steps,
            "stopped": self.stopped,
            "active": self.active,
            "findings": [_finding(f) for f in self.findings],
            "corrected": [_finding(f) for f in self.corrected],
            "notes": list(self.notes),
            "budget_used": self.used,
            "arcs": [
                {
                    "points": [a.first + 1, a.last + 1],
                    "radius": a.radius,
                    "centre": a.centre.tolist(),
                    "off": a.off,
                }
                for a in self.arcs
            ],
            "spline": {
                "degree": self.spline.degree,
                "closed": self.spline.closed,
                "knots": [float(k) for k in self.spline.knots],
                "control_points": self.spline.control_points.tolist(),
                "weights": None if self.spline.weights is None else self.spline.weights.tolist(),
            },
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        b, a = self.before, self.after
        rows = [
            (self.measure, f"{b.measure:.6e}", f"{a.measure:.6e}"),
            ("squared jumps", f"{b.jumps:.6e}", f"{a.jumps:.6e}"),
            ("largest jump", f"{b.largest_jump:.6e}", f"{a.largest_jump:.6e}"),
            ("largest curvature", f"{b.largest_curvature:.6g}", f"{a.largest_curvature:.6g}"),
            ("monotone pieces", str(b.pieces), str(a.pieces)),
            ("inflections", str(b.inflections), str(a.inflections)),
        ]
        left = f"relative optimality gap <= {self.gap_relative:.1e}"
        if not np.isfinite(self.gap):
            left = "without a tolerance there is no optimality bound"
        ended = f"{self.steps}"
        if self.mode == "optimum":
            ended += f" Newton steps, {self.active} limits reached"
        elif self.stopped:
            ended += f", ended by: {self.stopped}"
        tail = [
            (
                "deviation",
                f"to the data {self.deviation_data:.6e}; curve to curve certified "
                f"{self.deviation_certified:.6e}, sampled {self.deviation_sampled:.6e}, "
                f"{self.deviation_percent:.4g} % of the arc length",
            ),
            ("certificate", f"{self.value:.9e}, {left}"),
            ("steps", ended),
            ("time", f"{1e3 * self.seconds:.3g} ms"),
        ]
        text = lines_of(rows, tail)
        told = [f"corrected: {f.text}" for f in self.corrected]
        told += [f"note: {f.text}" for f in self.findings]
        told += [f"note: {note}" for note in self.notes]
        return "\n".join([text, *told])

    def plot(self, path: str | PathLike[str]) -> None:
        """Draw shape, zoom, curvature, comb, jumps, metric and displacement into a file.

        PNG or SVG by the name's end. Needs Matplotlib: ``pip install 'moldloft[plot]'``.

        Parameters
        ----------
        path
            The file.
        """
        from moldloft.fairing.plot import plot_curve

        plot_curve(self, path)


def _finding(f: Finding) -> dict[str, Any]:
    return {"kind": f.kind, "point": f.index + 1, "vector": list(f.vector), "text": f.text}


def _ends(ends: Any, closed: bool) -> tuple[str, str]:
    both = ends if isinstance(ends, (tuple, list)) and len(ends) == 2 else (ends, ends)
    words = tuple(f"points:{e}" if isinstance(e, int) else str(e) for e in both)
    return ("free", "free") if closed else (words[0], words[1])


def fair_curve(
    points: ArrayLike | Spline | Fairing,
    tol: ArrayLike | None,
    *,
    as_: str | None = None,
    closed: bool = False,
    degree: int = 3,
    measure: str | None = None,
    mode: str = "optimum",
    bound: str | None = None,
    breaks: Sequence[int] | str = (),
    fixed: Sequence[int] = (),
    ends: Any = None,
    motion: Any = "ball",
    through: Iterable[tuple[float, ArrayLike]] = (),
    tangents: Iterable[tuple[float, ArrayLike]] = (),
    keep: Sequence[str] = (),
    joins: Sequence[Spline] = (),
    spacing: Any = "chord",
    at: ArrayLike | None = None,
    goal: Any = "near",
    release: Sequence[int] | str = (),
    bends: bool = False,
    shape: Iterable[Any] = (),
    original: ArrayLike | None = None,
    count: int | None = None,
    knots: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    period: float | None = None,
    steps: int | None = None,
    least_move: float = 0.0,
    least_drop: float = 0.0,
    stop_gap: float = 0.0,
    stop_pieces: bool = False,
    accuracy: float = 1e-9,
    log: bool = False,
) -> Fairing:
    """Fair a curve within a tolerance.

    Parameters
    ----------
    points
        ``(n, 2)`` or ``(n, 3)``, or a :class:`Spline`; or the :class:`Fairing` of points, which are
        then faired again: from the points as they were read, at the same parameters.
    tol
        How far the curve, or each point, may move; ``None`` for no limit.
    as_
        What points are: ``"fit"``, data on the curve, which stays within the tolerance of each;
        ``"points"``, moved themselves, each within the tolerance; ``"control"``, the control points
        of a uniform spline, whose parameter is the index: the rule of the report of 1991. By
        default data for the optimum, control points for the other modes, which are the report's.
        A spline is its own.
    closed
        Whether the last point is followed by the first, which is not repeated.
    degree
        Polynomial degree.
    measure
        The measure to minimise. ``"second"``: squared second differences (the measure of the
        knot steps); ``"third"``: squared third differences; ``"jumps"``: squared jumps of the
        highest derivative; ``"jump-lengths"``: their lengths, which leaves few polynomial pieces;
        ``"bending"`` and ``"variation"``: integrals of the squared second and third derivative. By
        default ``"variation"`` for data, ``"second"`` otherwise.
    mode
        ``"optimum"``: the least there is, with a certificate; continuous in the input.
        ``"faithful"``: knots removed and re-inserted one by one, the longest achievable move first
        (Farin and Sapidis); a small change of the input may change which comes first.
        ``"literal"``: the largest jump first, as the report of 1991 has it; may stall.
        ``"vertex"``: one control point at a time to its own best place. ``"sweeps"``: all points in
        order. ``"levels"``: waves of all lengths, the longest first.
    bound
        ``"data"``: the tolerance bounds the distance of each point from the curve; ``"curve"``:
        that of the curve from the one through the points, everywhere; ``"points"``: the move of
        each control point. By default the data for fits, the curve for splines, points otherwise.
    breaks
        Points, from 0, that are intended breaks: they do not move by a bit and nothing is smoothed
        across them; a fitted curve has corners there. ``"auto"`` takes the corners among
        :attr:`Fairing.findings`; of control points it also lets single wrong points move by their
        error besides the tolerance.
    fixed
        Points (control points of fits and splines), from 0, that do not move.
    ends
        What open ends keep: ``"free"``, ``"position"``, ``"tangent"``, ``"curvature"`` or a number
        of control points; or two of these. By default the tangent for fits and splines, two points
        otherwise.
    motion
        ``"ball"``; ``"box"``, each coordinate by itself; a direction such as ``(0, 1)``, the only
        one in which points move (offsets at fixed stations); ``("across", direction)``, a plane in
        which they stay.
    through, tangents
        Conditions of an optimum: pairs of a parameter in [0, 1] and the point or the direction
        that the curve has there.
    keep
        What else an optimum keeps, to first order: ``"area"`` (swept about the origin in the xy
        plane), ``"volume"`` (of revolution about the x axis), ``"centroid"`` (of the control
        points).
    joins
        Open splines that begin or end where the curve does: an optimum runs on from them with the
        same tangent direction and curvature. They stay as they are.
    spacing
        Parameters of the points: ``"chord"``, ``"centripetal"``, a coordinate (``"x"``, ``"y"``,
        ``"z"``) or a direction along which the points run, or ``"index"``.
    at
        The parameters themselves, rising, in [0, 1].
    goal
        Which of the curves within the tolerances. ``"near"``: the fairest whose squared residuals
        are at most four fifths of what noise has that fills the tolerances evenly, and the data's
        own curve where there is little to gain: exact data stay. ``"fairest"``: the least of the
        measure. ``("budget", share)``: the first with a share of your own. ``("nearest", share)``:
        the nearest to the data whose measure exceeds the least by at most this share.
        ``("energy", most)``: the nearest whose measure is at most this. ``"closest"``: the nearest
        that has the ``shape``, whatever it measures. Data that are as fair as asked do not move.
    shape
        What shape an optimum of data has, all points counted from 0: ``("convex", i, j)`` or
        ``("concave", i, j)``, a turn to the left or to the right only between two points (seen
        from above, or in a vertical plane with z up: of a graph over x from left to right what
        these words mean); ``("one-way", i, j)``, no inflection there; ``("straight", i, j)``, or
        ``("straight", i, j, direction)``; ``("arc", i, j)``, a circle, tangent to straight runs
        and arcs that begin or end at its ends or one point from these; ``("pieces", k)``, at most
        k pieces of monotone curvature; ``("within", direction, most)``, the curve stays where
        ``direction . x`` is at most that; ``("side", direction)``, it leaves the points only
        against this direction. ``"convex"``, ``"concave"`` and ``"one-way"`` alone are about the
        whole curve. Signs, lines and limits hold of the whole curve, not of samples.
    release
        Points, from 0, that are wrong and may be left; ``"auto"``: the wrong digits among
        :attr:`Fairing.findings`. Nothing is released by itself.
    original
        The points as they were read, when ``points`` were faired already: tolerances are counted
        from these, so that fairing a result again is fairing the original.
    bends
        Whether third derivatives may buy smoothness with inflections that the curve of least
        bending does not have.
    count
        Fit by least squares with so many control points instead of through all points.
    knots, weights, period
        Knots and weights of your own, of control points or of a fit; see :class:`Spline` and
        :meth:`Spline.fit`. Weights stay as they are.
    steps
        Local steps (by default one per point), sweeps (10) or cycles of levels (2).
    least_move, least_drop, stop_gap, stop_pieces
        Local steps end when a move is shorter than this share of the tolerance, a step lowers the
        measure by less than this share, the certified gap is below this share, or n steps bring no
        fewer monotone pieces.
    accuracy
        The certified gap of an optimum, as a share of the measure.
    log
        Whether local steps are written down.

    Returns
    -------
    Fairing

    Raises
    ------
    FairingError
        With :attr:`~moldloft.errors.FairingError.index`, the point at fault.
    """
    if isinstance(points, Fairing):
        again = points
        if again.parameters is not None and at is None:
            at = again.parameters
            closed = again.spline.closed
        as_ = as_ or again.as_
        points = again.data[:, : again.points.shape[1]]
    shape = [shape] if isinstance(shape, str) else list(shape)
    if as_ is None:
        as_ = "fit" if mode == "optimum" and bound in (None, "data") else "control"
    if original is not None:
        reference, _ = points_of(original)
        if isinstance(points, Spline) or len(reference) != len(points_of(points)[0]):
            raise FairingError("the original has as many points as there are points")
        points = original
    if as_ not in ROLES:
        raise FairingError(f"points are `control`, `points` or `fit`, not `{as_}`")
    started = time.perf_counter()
    own = _Own(knots, weights, period)
    word, share = _goal(goal)
    if not isinstance(points, Spline) and mode == "optimum":
        asked = _Asked(
            closed,
            degree,
            measure,
            breaks,
            release,
            fixed,
            ends,
            motion,
            spacing,
            at,
            (word, share),
            bends,
            shape,
            accuracy,
        )
        through, tangents = list(through), list(tangents)
        # Points that move are those of the curve through them.
        moves = as_ == "points" and bound is None and spacing not in ("index", "uniform")
        if (as_ == "fit" or moves) and not own.given and count is None and bound in (None, "data"):
            return _fair_data(points, tol, asked, (through, tangents, keep, joins), as_, started)
    if shape:
        raise FairingError('shapes are for optima of data, `as_="fit"` without knots of their own')
    if word in ("energy", "closest"):
        raise FairingError(f'the goal `{word}` is for optima of data, `as_="fit"`')
    if bound == "data":
        raise FairingError('bound `data` is for optima of data, `as_="fit"`')
    if len(release):
        raise FairingError('release is for optima of data, `as_="fit"`')
    measure = measure or "second"
    if spacing == "index":
        spacing = "uniform"
    if not isinstance(spacing, str) or spacing not in ("chord", "centripetal", "uniform"):
        raise FairingError(
            f"spacing {spacing!r} is for optima of data; here: chord, centripetal or index"
        )
    made = _prepared(points, as_, closed, degree, spacing, count, breaks, own)
    spline, data, width = made.spline, made.data, made.width
    fitted = made.role in ("fit", "spline")
    n = len(spline.control_points)
    limits = radii(tol, n) if made.parameters is None else _spread(_left(tol, made), made, n)
    for finding in made.corrected:
        if finding.kind == "outlier" and made.role != "fit":
            limits[finding.index] += float(np.linalg.norm(finding.vector))
    word, way = direction(motion)
    if bound is None:
        bound = "curve" if fitted else "points"
    default = {"sweeps": 10, "levels": 2}.get(mode, n)
    kept = list(_ends(ends if ends is not None else ("tangent" if fitted else 2), spline.closed))
    conditions, labels = linear_conditions(through, tangents, keep)
    for k, join in enumerate(join_conditions(joins, spline)):
        kept[int(join[1])] = "position"
        conditions.append(join)
        labels.append(f"join {k + 1}")
    chosen = {
        "tolerance": limits,
        "motion": word,
        "direction": way,
        "ends": tuple(kept),
        "marks": made.marks,
        "fixed": [_index(f, n) for f in fixed],
        "measure": measure,
        "mode": mode,
        "bound": bound,
        "steps": default if steps is None else steps,
        "stops": (least_move, least_drop, stop_gap, stop_pieces),
        "conditions": conditions,
        "labels": labels,
        "accuracy": accuracy,
        "log": log,
    }
    if conditions and mode != "optimum":
        raise FairingError("only the optimum keeps conditions; take mode `optimum`")
    core, told = spline._core.fair(chosen)
    seconds = time.perf_counter() - started
    return _result(made, Spline._of(core), told, tol, mode, width, seconds, data)


@dataclass
class _Asked:
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
    goal: tuple[str, float]
    bends: bool
    shape: list[Any]
    accuracy: float


BUDGET = 0.8
"""Of what noise has in squared residuals that fills the tolerances evenly."""


def _goal(given: Any) -> tuple[str, float]:
    word, share = given if isinstance(given, tuple) and len(given) == 2 else (given, None)
    known = {"near": BUDGET, "budget": BUDGET, "fairest": 0.0, "nearest": 0.1, "closest": 0.0}
    if word == "energy":
        if share is None:
            raise FairingError('the goal `energy` takes the largest measure: ("energy", 2.5)')
        return "energy", float(share)
    if word not in known:
        raise FairingError(f"unknown goal `{word}`; there are: {', '.join(known)}, energy")
    return str(word), known[word] if share is None else float(share)


def spacing_of(given: Any) -> tuple[str, tuple[float, float, float]]:
    """The word and the direction of a spacing."""
    axes = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
    if isinstance(given, str):
        return ("along", axes[given]) if given in axes else (given, (0.0, 0.0, 0.0))
    return "along", direction(given)[1]


def _chosen(given: Sequence[int] | str, found: list[Finding], kind: str, count: int) -> list[int]:
    """Points by number, or those that findings of a kind propose."""
    if isinstance(given, str):
        if given != "auto":
            raise FairingError(f"expected numbers of points or `auto`, found `{given}`")
        return sorted({f.index for f in found if f.kind == kind})
    return sorted({_index(k, count) for k in given})


def _released(
    limits: list[float], release: list[int], found: list[Finding], data: Floats
) -> list[float]:
    """Tolerances with room for wrong points to go to their place."""
    out = list(limits)
    for k in release:
        error = next((float(np.linalg.norm(f.vector)) for f in found if f.index == k), None)
        size = float(np.ptp(data, axis=0).max())
        out[k] = out[k] + 2.0 * error if error is not None else size
    return out


def _data_measure(measure: str | None, degree: int) -> str:
    return measure or ("variation" if degree >= 3 else "bending")


def _fair_data(
    points: ArrayLike, tol: ArrayLike | None, asked: _Asked, wanted: Any, as_: str, started: float
) -> Fairing:
    """Data under tolerances."""
    data, width = points_of(points)
    n = len(data)
    least = 2 * asked.degree + 2 if asked.closed else asked.degree + 2
    if n < least:
        raise FairingError(f"expected at least {least} points for degree {asked.degree}, found {n}")
    found = [Finding.of(row) for row in _core.data_findings(data, asked.closed)]
    breaks = _chosen(asked.breaks, found, "corner", n)
    release = _chosen(asked.release, found, "outlier", n)
    limits = radii(tol, n)
    notes = []
    for k in asked.fixed:
        limits[_index(k, n)] = 0.0
    limits = _released(limits, release, found, data)
    if asked.closed and tol is None:
        raise FairingError("a closed curve without a tolerance shrinks to a point")
    word, way = direction(asked.motion)
    spaced, spacing_way = spacing_of(asked.spacing)
    kept = list(_ends(asked.ends if asked.ends is not None else "free", asked.closed))
    through, tangents, keep, joins = wanted
    conditions, labels = linear_conditions(through, tangents, keep)
    if joins:
        rough = Spline.interpolate(data, degree=asked.degree, closed=asked.closed)
        for k, join in enumerate(join_conditions(joins, rough)):
            kept[int(join[1])] = "position"
            conditions.append(join)
            labels.append(f"join {k + 1}")
    at = None
    if asked.at is not None:
        at = [float(t) for t in np.asarray(asked.at, np.float64).ravel()]
        rises = len(at) == n and all(a < b for a, b in pairwise(at)) and at[0] >= 0 and at[-1] <= 1
        if not rises:
            raise FairingError(f"expected {n} rising parameters in [0, 1]")
    measure = _data_measure(asked.measure, asked.degree)
    shape, shape_labels = shape_conditions(asked.shape, n)
    core, original, told = _core.Spline.fair_data(
        data,
        {
            "tolerance": limits,
            "motion": word,
            "direction": way,
            "ends": tuple(kept),
            "closed": asked.closed,
            "degree": asked.degree,
            "breaks": breaks,
            "spacing": spaced,
            "spacing_direction": spacing_way,
            "at": at,
            "measure": measure,
            "goal": asked.goal,
            "conditions": conditions,
            "labels": labels,
            "shape": shape,
            "shape_labels": shape_labels,
            "bends": asked.bends or measure == "jump-lengths",
            "accuracy": asked.accuracy,
        },
    )
    for k in release:
        off = float(told["residuals"][k])
        notes.append(f"point {k + 1} was released: the curve passes {off:.3e} from it")
    faired, before = Spline._of(core), Spline._of(original)
    arcs = tuple(Arc(a, b, r, np.asarray(c), off) for (a, b), r, c, off in told["arcs"])
    notes += [str(arc) for arc in arcs]
    rows = faired(told["at"])
    # What the curve passes through to rounding has not moved by a bit.
    still = told["residuals"] <= 64 * np.finfo(float).eps * np.abs(data).max()
    rows[still] = data[still]
    far, certificate = told["deviation"], told["certificate"]
    taken = {*breaks, *release}
    return Fairing(
        points=narrowed(rows, width),
        spline=faired,
        original=before,
        data=data,
        tol=None if tol is None else float(np.max(np.asarray(tol, np.float64))),
        as_=as_,
        mode="optimum",
        measure=measure,
        breaks=tuple(breaks),
        before=Numbers(**told["before"]),
        after=Numbers(**told["after"]),
        deviation_certified=far["certified"],
        deviation_sampled=far["sampled"],
        deviation_control=far["control"],
        length=far["length"],
        value=certificate["value"],
        gap=certificate["gap"],
        steps=told["steps"],
        stopped=None,
        active=told["active"],
        findings=tuple(f for f in found if f.index not in taken),
        corrected=tuple(f for f in found if f.index in taken),
        jump_lengths_before=told["jumps_before"],
        jump_lengths_after=told["jumps_after"],
        notes=(*told["notes"], *notes),
        seconds=time.perf_counter() - started,
        goal=asked.goal[0],
        residuals=told["residuals"],
        used=told["used"],
        parameters=told["at"],
        arcs=arcs,
    )


def laid(
    before: Floats, after: Floats, degree: int, spacing: Any, closed: bool, breaks: Sequence[int]
) -> tuple[Spline, Spline, float, float]:
    """The splines through points before and after on the same knots.

    Also how far these are apart: certified by their control points, and sampled.
    """
    word, way = spacing_of(spacing)
    core, at, _ = _core.Spline.interpolate(before, degree, word, closed, list(breaks), way)
    first = Spline._of(core)
    low, high = first.domain
    own = np.asarray(first.knots)
    if len(first.control_points) == len(before) and first.closed == closed:
        period = high - low if closed else None
        second, _ = Spline._fit(
            after, degree, own, None, None, closed, period, "chord", np.asarray(at)
        )
        moved = second.control_points - first.control_points
        certified = float(np.linalg.norm(moved, axis=1).max())
    else:
        core, _, _ = _core.Spline.interpolate(after, degree, word, closed, list(breaks), way)
        second = Spline._of(core)
        certified = float("nan")
    a, b = first.samples(16).points, second.samples(16).points
    return first, second, certified, float(np.linalg.norm(a - b, axis=1).max())


@dataclass
class _Own:
    """Knots and weights of the user's."""

    knots: ArrayLike | None
    weights: ArrayLike | None
    period: float | None

    @property
    def given(self) -> bool:
        return self.knots is not None or self.weights is not None

    def control(self, data: Floats, degree: int, closed: bool) -> Spline:
        """The spline with these control points."""
        return Spline(
            data,
            degree=degree,
            knots=self.knots,
            weights=self.weights,
            closed=closed,
            clamped=False,
            period=self.period,
        )


@dataclass
class _Prepared:
    spline: Spline
    data: Floats
    width: int
    role: str
    breaks: tuple[int, ...]
    marks: list[int]
    parameters: Floats | None
    findings: tuple[Finding, ...]
    corrected: tuple[Finding, ...]


def _index(given: Any, count: int) -> int:
    k = int(given)
    if not 0 <= k < count:
        raise FairingError(f"expected points from 0 to {count - 1}, found {k}", index=max(k, 0))
    return k


def _prepared(
    points: ArrayLike | Spline,
    role: str,
    closed: bool,
    degree: int,
    spacing: str,
    count: int | None,
    breaks: Sequence[int] | str,
    own: _Own,
) -> _Prepared:
    """The spline to fair, and what the data give away."""
    if own.given and (isinstance(points, Spline) or role == "points"):
        raise FairingError("knots and weights are for control points and fits")
    if isinstance(points, Spline):
        data, width = points.control_points, 3
        spline: Spline = points
        plain, role, parameters = points, "spline", None
    else:
        data, width = points_of(points)
        refuse_repeats(data, closed)
        least = 2 * degree + 2 if closed else degree + 2
        if len(data) < least:
            raise FairingError(
                f"expected at least {least} points for degree {degree}, found {len(data)}"
            )
        plain = Spline(data, degree=degree, closed=closed, clamped=False)
        spline = own.control(data, degree, closed) if own.given and role == "control" else plain
        parameters = None
    # A fit's own jumps tell less than those of its points.
    found = (plain if role == "fit" else spline).findings()
    corrected: list[Finding] = []
    if isinstance(breaks, str):
        if breaks != "auto":
            raise FairingError(f"breaks are numbers of points or `auto`, not `{breaks}`")
        corrected, found = found, []
        chosen = sorted({f.index for f in corrected if f.kind == "corner"})
    else:
        chosen = sorted({_index(b, len(data)) for b in breaks})
        found = [f for f in found if f.index not in chosen]
    marks = list(chosen)
    moved = data
    if role == "fit":
        # A wrong digit is put right before the curve is laid through it.
        moved = data.copy()
        for f in corrected:
            if f.kind == "outlier":
                moved[f.index] -= f.vector
        if own.given:
            if marks:
                raise FairingError("a fit with knots or weights has its breaks in the knots")
            spline, parameters = Spline._fit(
                moved, degree, own.knots, count, own.weights, closed, own.period, spacing, None
            )
        elif count is not None:
            core, parameters, _, _ = _least_squares(moved, degree, count, spacing, closed)
            spline = core
            if marks:
                raise FairingError("a least-squares fit has no breaks: fit all points")
        else:
            spline, parameters, marks = Spline._interpolated(moved, degree, spacing, closed, chosen)
    return _Prepared(
        spline,
        data,
        width,
        role,
        tuple(chosen),
        marks,
        parameters,
        tuple(found),
        tuple(corrected),
    )


def _least_squares(
    points: Floats, degree: int, count: int, spacing: str, closed: bool
) -> tuple[Spline, Floats, float, float]:
    core, at, largest, rms = _core.Spline.least_squares(points, degree, count, spacing, closed)
    return Spline._of(core), at, largest, rms


def _left(tol: ArrayLike | None, made: _Prepared) -> ArrayLike | None:
    """What a fit that misses its data leaves of their tolerances."""
    if tol is None or made.role != "fit" or made.parameters is None:
        return tol
    each = np.asarray(radii(tol, len(made.data)))
    off = np.linalg.norm(made.spline(made.parameters) - made.data, axis=1)
    noise = 1e-9 * float(np.ptp(made.data, axis=0).max())
    if off.max() <= noise:
        return tol
    short = off - each
    if short.max() > 0:
        k = int(short.argmax())
        raise FairingError(
            f"a spline of {len(made.spline.control_points)} control points is "
            f"{off[k]:.3e} off point {k + 1}: more control points, or a larger tolerance",
            index=k,
        )
    limits: NDArray[np.float64] = each - off
    return limits


def _spread(tol: ArrayLike | None, made: _Prepared, n: int) -> list[float]:
    """The tolerance of data points as that of control points: the least near each."""
    if tol is None or np.ndim(tol) == 0:
        return radii(tol, n)
    each = np.asarray(radii(tol, len(made.data)))
    assert made.parameters is not None
    p = made.spline.degree
    knots = made.spline.knots
    start, end = made.spline.domain
    at = start + (end - start) * made.parameters
    out = []
    for j in range(n):
        if made.spline.closed:
            away = np.abs(
                (at - knots[j] + 0.5 * (end - start)) % (end - start) - 0.5 * (end - start)
            )
            near = away <= (p + 1) * (end - start) / n
        else:
            near = (at >= knots[j]) & (at <= knots[j + p + 1])
        out.append(float(each[near].min() if near.any() else each.min()))
    return out


def _result(
    made: _Prepared,
    faired: Spline,
    told: dict[str, Any],
    tol: ArrayLike | None,
    mode: str,
    width: int,
    seconds: float,
    data: Floats,
) -> Fairing:
    original, spline = made.spline, faired
    before, after = Numbers(**told["before"]), Numbers(**told["after"])
    far, certificate = told["deviation"], told["certificate"]
    certified, sampled = far["certified"], far["sampled"]
    notes = list(told["notes"])
    if made.role == "points":
        rows = faired.control_points
        certified = sampled = far["control"]
        closed = original.closed
        laid = [
            Spline._interpolated(p, original.degree, "uniform", closed, made.breaks)[0]
            for p in (data, rows)
        ]
        original, spline = laid
        before, after = (_counted(n, s) for n, s in ((before, laid[0]), (after, laid[1])))
    elif made.parameters is not None:
        rows = faired(made.parameters)
    else:
        rows = faired.control_points
    log = (told["log_index"], told["log_to"]) if "log_index" in told else None
    largest = None if tol is None else float(np.max(np.asarray(tol, np.float64)))
    residuals = None
    if made.parameters is not None:
        residuals = np.linalg.norm(faired(made.parameters) - made.data, axis=1)
    return Fairing(
        residuals=residuals,
        parameters=made.parameters,
        points=narrowed(rows, width),
        spline=spline,
        original=original,
        data=data,
        tol=largest,
        as_="control" if made.role == "spline" else made.role,
        mode=mode,
        measure=told["measure"],
        breaks=made.breaks,
        before=before,
        after=after,
        deviation_certified=certified,
        deviation_sampled=sampled,
        deviation_control=far["control"],
        length=original.length if made.role == "points" else far["length"],
        value=certificate["value"],
        gap=certificate["gap"],
        steps=told["steps"],
        stopped=told["stopped"],
        active=told["active"],
        findings=made.findings,
        corrected=made.corrected,
        jump_lengths_before=told["jumps_before"],
        jump_lengths_after=told["jumps_after"],
        notes=tuple(notes),
        seconds=seconds,
        log=log,
    )


def _counted(numbers: Numbers, spline: Spline) -> Numbers:
    """The same sums with the counts of the curve that is laid through the points."""
    curvature = spline.samples().curvature
    return Numbers(
        numbers.measure,
        numbers.jumps,
        numbers.largest_jump,
        spline.monotone_pieces(),
        spline.inflections(),
        float(np.abs(curvature).max()),
    )


explain(globals())
