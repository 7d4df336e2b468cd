"""Fairing of curves that share points."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import narrowed, points_of, too_large
from moldloft.fairing.asked import EXACT, goal_of, index_of, only_data, spacing_of
from moldloft.fairing.findings import along_lines
from moldloft.fairing.lines import NetworkLines
from moldloft.fairing.report import Finding, certificate_of, claims_optimum, lines_of
from moldloft.fairing.spline import Spline
from moldloft.fairing.suspects import Suspect, suspects

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["NetworkFairing", "network"]


@dataclass(frozen=True)
class NetworkFairing:
    """A faired network, with its report."""

    points: Floats
    """The faired points, with as many columns as were given."""
    curves: tuple[Spline, ...]
    """The curves through them: at a shared point they all pass through the same coordinates."""
    originals: tuple[Spline, ...]
    """The curves before."""
    data: Floats
    """The given points, in three columns."""
    lists: tuple[tuple[int, ...], ...]
    """Points of each curve, from 0; a closed one repeats the first at the end."""
    tol: float | None
    """The largest tolerance; ``None`` for no limit."""
    mode: str
    """Fairing mode."""
    measure: str
    """The measure that was minimised."""
    shared: int
    """Number of points in more than one curve."""
    measure_before: float
    """The measure over all curves before."""
    measure_after: float
    """The measure of the result."""
    jumps_before: float
    """Sum of squared jumps over all curves before."""
    jumps_after: float
    """Sum of squared jumps of the result."""
    deviation_certified: float
    """No point has moved farther than this."""
    deviation_curves: float
    """The largest distance of a curve from its original, found by sampling: between points a curve
    may swing farther than they moved."""
    deviation_curves_certified: float
    """No curve is farther from its original than this anywhere."""
    value: float
    """The measure of the result, from the certificate."""
    gap: float
    """No network within the tolerance has a measure below ``value - gap``."""
    seconds: float
    """Time of the fairing."""
    goal: str = "fairest"
    """Goal: choice among the networks within the tolerance."""
    used: float | None = None
    """The mean of the squared moves over tolerances; 1 is noise that fills these evenly."""
    findings: tuple[tuple[int, Finding], ...] = ()
    """Wrong digits and knuckles along curves: the curve, from 0, and the finding,
    whose index is the point's."""
    notes: tuple[str, ...] = ()
    """Warnings and notes for the user."""
    names: tuple[str, ...] = ()
    """Names of the curves, such as ``station 3``; by default their numbers."""
    point_names: tuple[str, ...] = ()
    """Names of the points; by default their numbers."""
    released: tuple[int, ...] = ()
    """Released points, which are excluded from all distances."""
    axes: tuple[str, ...] = ()
    """The axes along which each point may move, such as ``"y"``; for an inclined direction, all
    axes of its components.
    """

    def suspects(
        self, most: int = 10, *, readings: dict[tuple[int, int], str] | None = None
    ) -> tuple[Suspect, ...]:
        """The points that contradict their neighbours on all their curves, the clearest first.

        Fixed points are excluded. See :func:`~moldloft.fairing.suspects`.

        Parameters
        ----------
        most
            The length of the list at most.
        readings
            The text of the cell of a point and an axis.

        Returns
        -------
        tuple of Suspect
            With the readings that were probably meant.
        """
        hull = np.asarray(np.isfinite(self.data).all(axis=1))
        return suspects(
            np.where(hull[:, None], self.data, 0.0),
            self.tol or 0.0,
            self.lists,
            motion=self.axes,
            most=most,
            names=[self.name(k) for k in range(len(self.lists))],
            point_names=[self.point_name(k) for k in range(len(self.data))],
            readings=readings,
        )

    def name(self, curve: int) -> str:
        """Name of a curve in messages and pages.

        Parameters
        ----------
        curve
            The curve, from 0.
        """
        return self.names[curve] if self.names else f"curve {curve + 1}"

    def point_name(self, point: int) -> str:
        """Name of a point in messages and pages.

        Parameters
        ----------
        point
            The point, from 0.
        """
        return self.point_names[point] if self.point_names else f"point {point + 1}"

    def text(self, finding: Finding) -> str:
        """A finding in words, with the name of its point.

        Parameters
        ----------
        finding
            One of :attr:`findings`.
        """
        number = f"point {finding.index + 1}"
        return finding.text.replace(number, self.point_name(finding.index), 1)

    @property
    def deviation_sampled(self) -> float:
        """The largest move of a point."""
        moved = self.points - narrowed(self.data, self.points.shape[1])
        far = np.linalg.norm(moved, axis=1)
        far[list(self.released)] = 0.0
        return float(np.nanmax(far))

    @property
    def gap_relative(self) -> float:
        """The gap relative to the measure (of at least a trillionth of the original one)."""
        size = max(self.value, 1e-12 * self.measure_before)
        return self.gap / size if size > 0 else 0.0

    def as_dict(self) -> dict[str, Any]:
        """The report as plain data, as printed by ``moldloft fair --json``.

        Returns
        -------
        dict
            Numbers, texts and lists only, so that JSON takes it.
        """
        return {
            "points": len(self.data),
            "curves": len(self.curves),
            "shared": self.shared,
            "mode": self.mode,
            "measure": self.measure,
            "tolerance": self.tol,
            "deviation_certified": self.deviation_certified,
            "deviation_sampled": self.deviation_sampled,
            "deviation_curves": self.deviation_curves,
            "deviation_curves_certified": self.deviation_curves_certified,
            "goal": self.goal,
            "budget_used": self.used,
            "findings": [
                {
                    "curve": k + 1,
                    "name": self.name(k),
                    "kind": f.kind,
                    "point": f.index + 1,
                    "text": self.text(f),
                }
                for k, f in self.findings
            ],
            "notes": list(self.notes),
            "measure_before": self.measure_before,
            "measure_after": self.measure_after,
            "jumps_before": self.jumps_before,
            "jumps_after": self.jumps_after,
            "value": self.value,
            "gap": self.gap,
            "gap_relative": self.gap_relative,
            "optimum_claimed": claims_optimum(self.gap, self.gap_relative),
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        rows = [
            (self.measure, f"{self.measure_before:.6e}", f"{self.measure_after:.6e}"),
            ("squared jumps", f"{self.jumps_before:.6e}", f"{self.jumps_after:.6e}"),
        ]
        moved = self.deviation_certified > 0
        proved = certificate_of(self.value, self.gap, self.gap_relative, moved=moved)
        tail = [
            ("network", f"{len(self.curves)} curves, {self.shared} shared points"),
            (
                "deviation",
                f"certified {self.deviation_certified:.6e} at points, "
                f"{self.deviation_curves_certified:.6e} along curves "
                f"(sampled {self.deviation_curves:.6e})",
            ),
            ("certificate", proved),
            ("time", f"{1e3 * self.seconds:.3g} ms"),
        ]
        said = [f"note: {self.name(k)}, {self.text(f)}" for k, f in self.findings]
        said += [f"note: {note}" for note in self.notes]
        return "\n".join([lines_of(rows, tail), *said])

    def plot(self, path: str | PathLike[str]) -> None:
        """Draw the curves before and after, and where points moved, into a file (PNG or SVG).

        Parameters
        ----------
        path
            The file.
        """
        from moldloft.fairing.plot import plot_network

        plot_network(self, path)


def network(
    points: ArrayLike | NetworkFairing,
    curves: Sequence[Sequence[int]],
    tol: ArrayLike | Mapping[str | int, float] | None,
    *,
    names: Sequence[str] = (),
    degree: int = 3,
    measure: str = "third",
    mode: str = "optimum",
    spacing: Any = "chord",
    goal: Any = "near",
    shape: Sequence[str] | str = (),
    breaks: Sequence[int | str] | str = (),
    release: Sequence[int] | str = (),
    fixed: Sequence[int] | str = "corners",
    motion: Any = "ball",
    bound: str = "points",
    keep: Sequence[str] | str = (),
    passes: int = 1,
    steps: int | None = None,
    original: ArrayLike | None = None,
) -> NetworkFairing:
    """Fair curves that share points, all at once: stations, waterlines, buttocks of a hull.

    Parameters
    ----------
    points
        ``(n, 3)`` or ``(n, 2)``; or the :class:`NetworkFairing` of points, which are then faired
        again from the points as they were read. A row of NaN is a cell without a hull: curves end
        beside it.
    curves
        The points of each curve, from 0; a closed curve ends with its first point. A number that
        stands in several lists is one point of all these curves.
    tol
        Maximum distance that each point may move: one number, one for each point, or those of
        curves by name (or number, from 0), ``""`` for all others; the least of several curves
        counts.
    names
        Names of the curves in options and messages; by default ``curve 1`` and so on.
    degree
        Polynomial degree of the curves.
    measure
        The measure to minimise, summed over all curves; see :func:`~moldloft.fairing.fair`.
    mode
        ``"optimum"``, ``"faithful"`` (curve after curve, ``passes`` times) or ``"sweeps"``.
    spacing
        Parameters of the points along each curve: ``"chord"``, ``"centripetal"``, a coordinate
        (``"x"``) or a direction where it rises or falls along a curve (chords elsewhere), or
        ``"index"``, the rule of the report of 1991, which the modes other than the optimum keep.
    goal
        Choice among the networks within the tolerance; see :func:`~moldloft.fairing.fair`.
        ``"near"``, or ``("near", share)``, is the fairest where its squared residuals are no more
        than those of noise that fills the tolerances evenly, give or take one and a half of their
        standard deviations: the data do not speak against it. Where they are a quarter more the
        measure is not that of the hull, and the squares are at most ``share`` (0.3) of noise's;
        between the two the budget is continuous, and it falls to 0.05 where they are much more.
        Fewer than 40 moving points do not tell: theirs is ``share``.
    shape
        Exact shapes of curves: ``"WL 2: convex"``, ``"WL 2: straight=3-9:1,0,0"``
        (points from 1), ``"WL 2..WL 5 at station 4..station 8: straight:1,0,0"`` (a parallel body:
        the points of these curves on those), the same with ``flat`` or ``flat:0,1,0`` (all
        these points in one plane), ``"station 5: arc=3-9"`` (these points on one circle, tangent to
        straight runs beside it), ``"sheer: tangent=start:1,0,0"``; ``one-way``, ``concave``,
        ``within`` and ``side`` as for :func:`~moldloft.fairing.fair`; ``all`` are all curves. For
        the optimum at parameters.
    breaks
        Intended breaks: a number is a point, of all its curves; a name is a curve, along which all
        curves that cross it break and it does not; ``"auto"`` are the knuckles that stand out along
        curves, and where these lie on a curve of the network, all along that.
    release
        Points that are wrong: they move wherever the curves through the others are, and count
        nowhere; ``"auto"`` are the wrong digits of the findings.
    fixed
        Points that do not move: ``"corners"`` (at which every curve that has them ends),
        ``"ends"``, ``"none"``, or numbers.
    motion
        As for curves: ``(0, 1, 0)`` moves only half-breadths of stations and waterlines. Or a
        list with the axes of each point, such as ``"y"``, ``"yz"`` or ``""`` for one that stays. Or
        by curves as tolerances: ``{"": (0, 1, 0), "sheer": ("across", (1, 0, 0))}`` moves a sheer
        in the planes of the stations.
    bound
        ``"points"``: the tolerance is that of the points, between which a curve may swing farther:
        a note names those that are more than 1.5 tolerances off. ``"curve"``: no curve is farther
        from its original than the smaller tolerance of the two points next to it, all along. Of the
        optimum at parameters.
    keep
        ``"volume"`` and its ``"centroid"`` stay, by splines through the sections (curves in planes
        across x); where points move along one direction.
    passes, steps
        Maximum number of sweeps of the faithful mode.
    original
        The points as they were read, when ``points`` were faired already: tolerances are counted
        from these, so that fairing a result again is fairing the original.

    Returns
    -------
    NetworkFairing
        The curves faired, with the reports before and after.

    Examples
    --------
    >>> import numpy as np
    >>> x, z = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(0, 1, 7), indexing="ij")
    >>> y = np.round((1 - x**2) * (1 - z**2), 2)
    >>> grid = np.arange(x.size).reshape(x.shape)
    >>> lines = [*grid, *grid.T]                          # stations and waterlines
    >>> offsets = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    >>> faired = network(offsets, lines, 0.005, measure="jumps", motion=(0, 1, 0))
    >>> faired.shared, faired.deviation_certified <= 0.005
    (63, True)
    >>> faired.jumps_after < 0.01 * faired.jumps_before
    True
    """
    if isinstance(points, NetworkFairing):
        points = points.data[:, : points.points.shape[1]]
    whole, hull = _where_hull(points)
    data, width = points_of(whole)
    if original is not None:
        count = len(data)
        read, where = _where_hull(original)
        data, width = points_of(read)
        if len(data) != count:
            raise FairingError("the original has as many points as there are points")
        hull &= where
    started = time.perf_counter()
    wanted = goal_of(goal)
    if mode != "optimum":
        only_data(goal)
    word_spaced, spaced_way = spacing_of(spacing)
    index = mode != "optimum" or word_spaced == "index"
    shapes = [shape] if isinstance(shape, str) else list(shape)
    kept_words = [keep] if isinstance(keep, str) else list(keep)
    if bound not in ("points", "curve"):
        raise FairingError(f"a bound is one on points or curve, not `{bound}`")
    if bound == "curve" and index:
        raise FairingError(
            "a bound all along the curves is for the optimum of curves at parameters: "
            "take another spacing than `index`"
        )
    count = len(data)
    given = NetworkLines.of(curves, count, names)
    lines, cut = given.where_hull(hull, degree)
    lines.refuse_short(degree)
    lists = lines.lists
    uses = np.zeros(count, int)
    ends = np.zeros(count, int)
    for own, closed in lists:
        uses[own] += 1
        if not closed:
            ends[[own[0], own[-1]]] += 1
    if isinstance(fixed, str):
        kept = {
            "corners": (ends > 0) & (ends == uses),
            "ends": ends > 0,
            "none": np.zeros(count, bool),
        }.get(fixed)
        if kept is None:
            raise FairingError(
                f"fixed: expected corners, ends, none or numbers of points, found `{fixed}`"
            )
        still = [int(i) for i in np.flatnonzero(kept)]
    else:
        still = [index_of(i, count) for i in fixed]
    marks = lines.marks(breaks, data)
    marked = {own[c] for (own, _), places in zip(lists, marks, strict=True) for c in places}
    findings = along_lines(data, lists, marked)
    if isinstance(release, str) and release != "auto":
        raise FairingError(f"released points are numbers or auto, not `{release}`")
    released = (
        sorted({f.index for _, f in findings if f.kind == "outlier"})
        if isinstance(release, str)
        else [index_of(i, count) for i in release]
    )
    word, way, held, steady = lines.motions(motion, count)
    tolerances = lines.tolerances(tol, count)
    for i in released:
        tolerances[i] = np.inf
    moves = (uses > 0) & ~np.asarray(steady)
    tolerances = [t if moving else 0.0 for t, moving in zip(tolerances, moves, strict=True)]
    still = [i for i in still if i not in released]
    asked = bool(shapes or kept_words or released)
    # The optimum along curves at parameters knows exact points itself.
    stay = index and tol is not None and goal_of(goal)[0] == "near" and not asked
    stay = stay and _core.are_exact(data, lists, sorted(marked))
    web = _core.Web(data, [(o, c, m) for (o, c), m in zip(lists, marks, strict=True)], degree)
    faired, pairs, reported = web.fair(
        {
            "tolerance": [0.0] * count if stay else tolerances,
            "held": held,
            "motion": word,
            "direction": way,
            "fixed": still,
            "measure": measure,
            "mode": mode,
            "bound": bound,
            "spacing": "index" if index else word_spaced,
            "spacing_direction": spaced_way,
            "goal": wanted if mode == "optimum" else None,
            "names": lines.names,
            "shape": shapes,
            "keep": kept_words,
            "release": released,
            "conditions": [],
            "labels": [],
            "passes": passes,
            "steps": {"faithful": 3, "sweeps": 50}.get(mode, 0) if steps is None else steps,
        }
    )
    if stay:
        # The fairest network was not computed.
        reported["certificate"]["gap"] = reported["certificate"]["value"]
    seconds = time.perf_counter() - started
    moved = np.linalg.norm(faired - data, axis=1)
    moved[released] = 0.0
    said = [
        f"point {i + 1} was released: it moves by {np.linalg.norm(faired[i] - data[i]):.3e}"
        for i in released
    ]
    if reported["bent"]:
        named = ", ".join(lines.name(k) for k in reported["bent"])
        said.append(
            f"{named}: more inflections than the points require; crossing curves or conditions "
            "leave no fewer within the tolerance"
        )
    said += [
        f"{lines.name(curve)}: between points, beside point {point + 1}, up to {share:.2f} "
        "tolerances from its original; bound `curve` keeps it within them"
        for curve, point, share in reported["swings"]
    ]
    said += [
        f"{lines.name(curve)}: an arc from point {lists[curve][0][first] + 1} to point "
        f"{lists[curve][0][last] + 1}, radius {radius:.6g}"
        for curve, (first, last), radius in reported["arcs"]
    ]
    shown = faired.copy()
    shown[~hull] = np.nan
    limits = [t for k, t in enumerate(tolerances) if k not in released and uses[k]]
    most = None if tol is None else float(max(limits, default=0.0))
    return NetworkFairing(
        points=narrowed(shown, width),
        curves=tuple(Spline._of(p[1]) for p in pairs),
        originals=tuple(Spline._of(p[0]) for p in pairs),
        data=data if hull.all() else np.where(hull[:, None], data, np.nan),
        lists=tuple(tuple(o + o[:1]) if c else tuple(o) for o, c in lists),
        tol=most,
        mode=mode,
        measure=measure,
        shared=int((uses > 1).sum()),
        measure_before=reported["measure_before"],
        measure_after=reported["measure_after"],
        jumps_before=reported["jumps_before"],
        jumps_after=reported["jumps_after"],
        deviation_certified=float(moved.max()) if released else reported["certified"],
        deviation_curves=max(p[3] for p in pairs),
        deviation_curves_certified=max(p[2] for p in pairs),
        goal=wanted[0],
        used=reported["used"],
        findings=findings,
        notes=(*too_large(most, data[hull]), *cut, *said, *((EXACT,) if stay else ())),
        names=tuple(lines.names),
        released=tuple(released),
        axes=lines.axes(motion, count),
        value=reported["certificate"]["value"],
        gap=reported["certificate"]["gap"],
        seconds=seconds,
    )


def _where_hull(points: Any) -> tuple[Any, NDArray[np.bool_]]:
    """Points with zeros where there is no hull, and where there is one."""
    try:
        given = np.array(points, dtype=np.float64)
    except (TypeError, ValueError):
        given = np.zeros((0, 0))
    if given.ndim != 2:
        return points, np.ones(len(given), bool)
    hull = np.asarray(~np.isnan(given).any(axis=1), np.bool_)
    given[~hull] = 0.0
    return given, hull


explain(globals())
