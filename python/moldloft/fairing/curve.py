"""Fairing of curves."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import direction, points_of, radii
from moldloft.fairing.asked import (
    EXACT,
    EXACT_NEAREST,
    ends_of,
    index_of,
    only_data,
    stays_near,
)
from moldloft.fairing.conditions import join_conditions, linear_conditions
from moldloft.fairing.control import Own, left, prepared, result, spread
from moldloft.fairing.data import Data, fair_data
from moldloft.fairing.faired import Fairing
from moldloft.fairing.spline import Spline

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["fair_curve"]

ROLES = ("control", "points", "fit")


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
    spacing: Any = "auto",
    at: ArrayLike | None = None,
    goal: Any = "near",
    release: Sequence[int] | str = (),
    bends: bool = False,
    shape: Iterable[str] | str = (),
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
    accuracy: float | None = None,
    draft: bool = False,
    log: bool = False,
) -> Fairing:
    """Fair a curve within a tolerance.

    Parameters
    ----------
    points
        ``(n, 2)`` or ``(n, 3)``, or a :class:`Spline`; or the :class:`Fairing` of points, which are
        then faired again: from the points as they were read, at the same parameters.
    tol
        Maximum distance that the curve, or each point, may move; ``None`` for no limit.
    as_
        Meaning of the points: ``"fit"``, data on the curve, which stays within the tolerance of
        each;
        ``"points"``, moved themselves, each within the tolerance; ``"control"``, the control points
        of a uniform spline, whose parameter is the index: the rule of the report of 1991. By
        default data for the optimum, control points for the other modes, which are the report's.
        A spline is its own.
    closed
        True for a closed curve, whose first point is not repeated at the end.
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
        Fixed quantities of open ends: ``"free"``, ``"position"``, ``"tangent"``, ``"curvature"`` or
        a number of control points; or two of these. By default nothing of data that the curve is
        near, the tangent where control points of fits and splines move, and two points otherwise.
    motion
        ``"ball"``; ``"box"``, each coordinate separately; a direction such as ``(0, 1)``, the only
        one in which points move (offsets at fixed stations); ``("across", direction)``, a plane in
        which they stay.
    through, tangents
        Conditions of an optimum: pairs of a parameter in [0, 1] and the point or the direction
        that the curve has there.
    keep
        Further quantities that an optimum keeps, to first order: ``"area"`` (swept about the origin
        in the xy plane), ``"volume"`` (of revolution about the x axis), ``"centroid"`` (of the
        control points).
    joins
        Open splines that begin or end where the curve does: an optimum continues them with the
        same tangent direction and curvature. They are unchanged.
    spacing
        Parameters of the points: ``"chord"``, ``"centripetal"``, a coordinate (``"x"``, ``"y"``,
        ``"z"``) or a direction along which the points run, ``"index"``, or ``"curvature"``, lengths
        times (1 + (k / 2 m)^2)^(1/4), where k is the curvature of the curve of budget 1 and m its
        mean. ``"auto"`` is ``"curvature"`` for the goals ``"near"`` and ``"budget"`` where ends
        keep no tangents and there are no shapes, conditions, joins or directions of the motion,
        else ``"chord"``.
    at
        The parameters themselves, rising, in [0, 1].
    goal
        Choice among the curves within the tolerances. ``"near"``: the fairest whose squared
        residuals are at most half (of curves that are not plane, or whose points move in one
        direction, four fifths) of what noise has that fills the tolerances evenly, and the data's
        own curve where there is little to gain: exact data stay. ``"fairest"``: the least of the
        measure. ``("budget", fraction)``: the first with another fraction. ``("nearest",
        fraction)``: the nearest to the data whose measure exceeds the minimum by at most this
        fraction.
        ``("energy", most)``: the nearest whose measure is at most this. ``"closest"``: the nearest
        that has the ``shape``, whatever its measure. Data that meet the goal already do not move.
        Other modes than optima of data have ``"near"``, which leaves points on a line, conic,
        plane cubic or helix as they are, and ``"fairest"``.
    shape
        Shape conditions of an optimum of data, as in the command and in models, points counted from
        1:
        ``"convex=4-10"`` or ``"concave=1-4"``, a turn to the left or to the right only between two
        points (seen from above, or in a vertical plane with z up: of a graph over x from left to
        right what these words mean); ``"one-way=1-9"``, no inflection there; ``"straight=1-9"``, or
        ``"straight=1-9:0,1"`` in a direction; ``"arc=9-15"``, a circle, tangent to straight runs
        and arcs that begin or end at its ends or one point from these; ``"pieces=2"``, at most so
        many pieces of monotone curvature; ``"within=0,1:4.6"``, the largest value along a
        direction; ``"side=0,-1"``, it leaves the points only against this direction. A word alone
        applies to the whole curve. Signs, lines and limits hold on the whole curve, not only at
        samples.
    release
        Points, from 0, that are wrong and may be left; ``"auto"``: the wrong digits among
        :attr:`Fairing.findings`. No point is released automatically.
    original
        The points as they were read, when ``points`` were faired already: tolerances are counted
        from these, so that fairing a result again is fairing the original.
    bends
        True if the curve may have more inflections, and more than two monotone pieces of curvature
        more, than the fairest within the tolerance.
    count
        Number of control points of a least-squares fit, instead of a curve through all points.
    knots, weights, period
        Knots and weights of your own, of control points or of a fit; see :class:`Spline` and
        :meth:`Spline.fit`. Weights are fixed.
    steps
        Local steps (by default one per point), sweeps (10) or cycles of levels (2).
    least_move, least_drop, stop_gap, stop_pieces
        Local steps end when a move is shorter than this fraction of the tolerance, a step lowers
        the measure by less than this fraction, the certified gap is below this fraction, or n steps
        bring no fewer monotone pieces.
    accuracy
        Maximum certified gap of an optimum, relative to the measure; by default as small as
        rounding allows.
    draft
        True to accept a draft of an optimum of data, for interactive use: within the
        tolerances and the budget of the goal, but without control of inflections.
    log
        True to record local steps.

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
            # Feet follow from the points.
            at = None if again.thin else again.parameters
            closed = again.spline.closed
        as_ = as_ or again.as_
        points = again.data[:, : again.points.shape[1]]
    shape = [shape] if isinstance(shape, str) else list(shape)
    if as_ is None:
        as_ = "fit" if mode == "optimum" else "control"
    if original is not None:
        reference, _ = points_of(original)
        if isinstance(points, Spline) or len(reference) != len(points_of(points)[0]):
            raise FairingError("the original has as many points as there are points")
        points = original
    if as_ not in ROLES:
        raise FairingError(f"points are `control`, `points` or `fit`, not `{as_}`")
    started = time.perf_counter()
    own = Own(knots, weights, period)
    through, tangents = list(through), list(tangents)
    if not isinstance(points, Spline) and mode == "optimum":
        # Points that move are those of the curve through them.
        moves = as_ == "points" and bound is None and spacing != "index"
        if (as_ == "fit" or moves) and not own.given and count is None and bound in (None, "data"):
            asked = Data(
                points,
                tol,
                as_,
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
                goal,
                bends,
                shape,
                accuracy,
                through,
                tangents,
                keep,
                joins,
                draft,
            )
            return fair_data(asked, started)
    if shape:
        raise FairingError('shapes are for optima of data, `as_="fit"` without knots of their own')
    only_data(goal)
    if bound == "data":
        raise FairingError('bound `data` is for optima of data, `as_="fit"`')
    if len(release):
        raise FairingError('release is for optima of data, `as_="fit"`')
    if draft:
        raise FairingError('drafts are of optima of data, `as_="fit"`')
    if at is not None:
        raise FairingError('parameters of your own are for optima of data, `as_="fit"`')
    measure = measure or "second"
    spacing = "chord" if spacing == "auto" else spacing
    if not isinstance(spacing, str) or spacing not in ("chord", "centripetal", "index"):
        raise FairingError(
            f"spacing {spacing!r} is for optima of data; here: chord, centripetal or index"
        )
    made = prepared(points, as_, closed, degree, spacing, count, breaks, own)
    spline, data, width = made.spline, made.data, made.width
    fitted = made.role in ("fit", "spline")
    n = len(spline.control_points)
    # A result is near the points, and exact points are as fair as can be.
    free = spline.weights is None and not (through or tangents or keep or joins)
    stay = stays_near(goal, free) and _core.is_exact(data, list(made.breaks), spline.closed)
    limits = radii(tol, n) if made.parameters is None else spread(left(tol, made), made, n)
    for finding in made.corrected:
        if finding.kind == "outlier" and made.role != "fit":
            limits[finding.index] += float(np.linalg.norm(finding.vector))
    word, way = direction(motion)
    if bound is None:
        bound = "curve" if fitted else "points"
    default = {"sweeps": 10, "levels": 2}.get(mode, n)
    kept = list(ends_of(ends if ends is not None else ("tangent" if fitted else 2), spline.closed))
    kept = [word or "free" for word in kept]
    if stay:
        limits = [0.0] * n
    conditions, labels = linear_conditions(through, tangents, keep)
    if spline.weights is not None and (conditions or joins):
        raise FairingError("through, tangents, keep and joins are for splines without weights")
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
        "fixed": [index_of(f, n) for f in fixed],
        "measure": measure,
        "mode": mode,
        "bound": bound,
        "steps": default if steps is None else steps,
        "stops": (least_move, least_drop, stop_gap, stop_pieces),
        "conditions": conditions,
        "labels": labels,
        "accuracy": 1e-9 if accuracy is None else accuracy,
        "log": log,
    }
    if conditions and mode != "optimum":
        raise FairingError("only the optimum keeps conditions; take mode `optimum`")
    core, reported = spline._core.fair(chosen)
    if stay and tol is not None:
        # The fairest curve was not computed.
        reported["certificate"]["gap"] = reported["certificate"]["value"]
        own_knots = made.role == "fit" and (own.given or count is not None)
        reported["notes"] = [*reported["notes"], EXACT_NEAREST if own_knots else EXACT]
    seconds = time.perf_counter() - started
    return result(made, Spline._of(core), reported, tol, mode, width, seconds, data)


explain(globals())
