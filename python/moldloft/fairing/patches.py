"""Fairing of surfaces with common edges."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import direction, points_of, radii
from moldloft.fairing.findings import lines_exact
from moldloft.fairing.report import certificate_of, claims_optimum, lines_of
from moldloft.fairing.surface import SplineSurface, _rims

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["PatchesFairing", "patches"]

ROUNDING = 1e-13
"""Displacement due to rounding, relative to the size."""

_EDGES = (("u0", "u1"), ("v0", "v1"))


@dataclass(frozen=True)
class PatchesFairing:
    """Faired surfaces, with their report."""

    grids: tuple[Floats, ...]
    """The faired grids: control points, or the surfaces at the parameters of the points."""
    surfaces: tuple[SplineSurface, ...]
    """The faired surfaces."""
    originals: tuple[SplineSurface, ...]
    """The surfaces before."""
    seams: tuple[tuple[tuple[int, str], tuple[int, str]], ...]
    """Shared edges: the surfaces, from 0, and their edges, such as ``"u1"``."""
    keeps: str
    """Continuity across seams."""
    tol: float | None
    """The largest tolerance; ``None`` for no limit."""
    as_: str
    """Meaning of the points: ``"control"`` or ``"fit"``."""
    measure: str
    """The measure that was minimised."""
    measure_before: float
    """The measure over all curves of the nets before."""
    measure_after: float
    """The measure of the result."""
    jumps_before: float
    """Sum of squared jumps over all curves of the nets before."""
    jumps_after: float
    """Sum of squared jumps of the result."""
    deviation_certified: float
    """No point of a surface is farther from its original than this."""
    deviation_sampled: float
    """The largest distance found by sampling."""
    value: float
    """The measure of the result, from the certificate."""
    gap: float
    """No surfaces within the tolerance and with the same continuity have a measure below ``value -
    gap``.
    """
    seconds: float
    """Time of the fairing."""

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
            "surfaces": [list(g.shape[:2]) for g in self.grids],
            "seams": [[[k, e], [m, f]] for (k, e), (m, f) in self.seams],
            "keeps": self.keeps,
            "as": self.as_,
            "mode": "optimum",
            "measure": self.measure,
            "tolerance": self.tol,
            "deviation_certified": self.deviation_certified,
            "deviation_sampled": self.deviation_sampled,
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
        names = [f"{k + 1}.{e} = {m + 1}.{f}" for (k, e), (m, f) in self.seams]
        moved = self.deviation_certified > 0
        proved = certificate_of(self.value, self.gap, self.gap_relative, moved=moved)
        tail = [
            ("seams", f"{', '.join(names) or 'none'}: continuous {self.keeps}"),
            (
                "deviation",
                f"certified {self.deviation_certified:.6e}, sampled {self.deviation_sampled:.6e}",
            ),
            ("certificate", proved),
            ("time", f"{1e3 * self.seconds:.3g} ms"),
        ]
        return lines_of(rows, tail)


def patches(
    surfaces: Sequence[ArrayLike | SplineSurface],
    tol: float | Sequence[ArrayLike] | None,
    *,
    seams: str = "curvature",
    as_: str = "fit",
    degree: int | tuple[int, int] = 3,
    measure: str = "second",
    bound: str = "points",
    rims: str | Mapping[str, str] = "corners",
    motion: Any = "ball",
    goal: str = "near",
) -> PatchesFairing:
    """Fair surfaces that share edges together, with continuity across the edges.

    Edges of two surfaces (or of one) with the same control points, in either direction, are a seam,
    whose points move for both. Degree and knots along it must agree.

    Parameters
    ----------
    surfaces
        Grids ``(m, n, 3)`` or :class:`SplineSurface`, on clamped knots.
    tol
        Maximum distance that each control point may move; ``None`` for no limit. A list has one
        for each surface, or for each point of it, ``(m, n)``; on a seam the smaller one holds, and
        points with 0 do not move.
    seams
        Continuity across seams: ``"position"``, ``"tangent"`` or ``"curvature"``. The ratio
        of the speeds of the parameters on both sides is read from the surfaces as they are.
    as_, degree
        Meaning of the points of grids, ``"fit"`` or ``"control"``, and their degree.
    measure, bound, rims, motion
        As for surfaces; ``seams`` applies to rims that are seams.
    goal
        ``"fairest"``, or ``"near"``, which differs where all lines of all grids are exact (lines,
        conics, plane cubics, helices): these move no farther than continuity across the seams asks
        for, give or take a factor of eight.

    Returns
    -------
    PatchesFairing
        The surfaces faired, with the reports before and after.

    Raises
    ------
    FairingError
        If surfaces cannot be joined, or not run on within the tolerance.

    Examples
    --------
    >>> import numpy as np
    >>> x, y = np.meshgrid(np.arange(9.0), np.arange(6.0), indexing="ij")
    >>> z = np.round(0.05 * x * (8 - x) + 0.02 * y * y, 1)
    >>> grid = np.stack([x, y, z], axis=-1)
    >>> faired = patches([grid[:5], grid[4:]], 0.4)
    >>> faired.seams
    (((0, 'u1'), (1, 'u0')),)
    >>> a, b = (s.look([u], [0.5]) for s, u in zip(faired.surfaces, (1.0, 0.0)))
    >>> bool(abs(a.mean - b.mean) < 1e-9)
    True
    """
    if as_ not in ("control", "fit"):
        raise FairingError(f"points of a surface are `control` or `fit`, not `{as_}`")
    if seams not in ("position", "tangent", "curvature"):
        raise FairingError(f"seams keep position, tangent or curvature, not `{seams}`")
    if goal not in ("near", "fairest"):
        raise FairingError(f"the goal of surfaces with seams is near or fairest, not `{goal}`")
    if not surfaces:
        raise FairingError("expected one surface or more, found 0")
    started = time.perf_counter()
    before: list[SplineSurface] = []
    at: list[tuple[Floats, Floats] | None] = []
    stays = goal == "near"
    for given in surfaces:
        if isinstance(given, SplineSurface):
            before.append(given)
            at.append(None)
            net = given.control_points
            stays = stays and not given._core.rational and lines_exact(net, given.closed)
            continue
        data, _ = points_of(given, 3)
        stays = stays and lines_exact(data, (False, False))
        if as_ == "fit":
            made, places, _ = SplineSurface._interpolated(data, degree, ((), ()))
            before.append(made)
            at.append(places)
        else:
            before.append(SplineSurface(data, degree=degree))
            at.append(None)
    limits = _limits(tol, before)
    most = max(limits)
    stays = stays and 0 < most < np.inf
    word, way = direction(motion)
    chosen = {
        "tolerance": limits,
        "motion": word,
        "direction": way,
        "rims": _rims(rims),
        "measure": measure,
        "mode": "optimum",
        "bound": bound,
        "goal": None,
        "passes": 1,
        "steps": 0,
        "conditions": [],
        "labels": [],
    }
    parts = [s._core for s in before]
    tries = [most]
    if stays:
        # Of exact surfaces the smallest move that lets them run on.
        size = max(float(np.abs(s.control_points).max()) for s in before)
        moves = [ROUNDING * size * 8**k for k in range(16)]
        tries = [*(move for move in moves if move < most), most]
    for least in tries:
        chosen["tolerance"] = [min(least, limit) for limit in limits]
        try:
            cores, found, reported = _core.Net.joined(parts, seams, chosen)
        except FairingError:
            if least == tries[-1]:
                raise
            continue
        if least != most:
            reported["certificate"]["gap"] = reported["certificate"]["value"]
        break
    faired = [SplineSurface._of(core) for core in cores]
    seconds = time.perf_counter() - started
    return PatchesFairing(
        grids=tuple(
            s.control_points if a is None else s.grid(*a) for s, a in zip(faired, at, strict=True)
        ),
        surfaces=tuple(faired),
        originals=tuple(before),
        seams=tuple(((k, _EDGES[d][e]), (m, _EDGES[f][g])) for (k, d, e), (m, f, g) in found),
        keeps=seams,
        tol=most if most < np.inf else None,
        as_=as_,
        measure=measure,
        measure_before=reported["measure_before"],
        measure_after=reported["measure_after"],
        jumps_before=reported["jumps_before"],
        jumps_after=reported["jumps_after"],
        deviation_certified=reported["certified"],
        deviation_sampled=reported["sampled"],
        value=reported["certificate"]["value"],
        gap=reported["certificate"]["gap"],
        seconds=seconds,
    )


def _limits(tol: Any, surfaces: Sequence[SplineSurface]) -> list[float]:
    """The tolerances of the control points of all surfaces."""
    counts = [s._core.shape[0] * s._core.shape[1] for s in surfaces]
    if not isinstance(tol, (list, tuple)):
        return radii(tol, sum(counts))
    if len(tol) != len(surfaces):
        raise FairingError(f"expected the tolerances of {len(surfaces)} surfaces, found {len(tol)}")
    return [limit for own, count in zip(tol, counts, strict=True) for limit in radii(own, count)]


explain(globals())
