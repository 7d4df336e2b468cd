"""Report of the fairing of a curve."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import narrowed
from moldloft.fairing.report import Finding, Numbers, certificate_of, claims_optimum, lines_of
from moldloft.fairing.spline import Spline

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["Arc", "Fairing"]


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
    """Sampled distance of the spline from the circle."""

    def __str__(self) -> str:
        x = ", ".join(f"{c:.6g}" for c in self.centre)
        return (
            f"points {self.first + 1} to {self.last + 1} are on an arc of radius "
            f"{self.radius:.6g} about ({x}), which the cubic follows to {self.off:.1e}"
        )


@dataclass(frozen=True)
class Fairing:
    """A faired curve, with its report."""

    points: Floats
    """The faired points, in the number and with the columns of the input: control points, points,
    or the faired curve at the parameters of the points.
    """
    spline: Spline
    """The faired curve."""
    original: Spline
    """The curve before."""
    data: Floats
    """The given points, in three columns."""
    tol: float | None
    """The largest tolerance; ``None`` for no limit."""
    as_: str
    """Meaning of the points: ``"control"``, ``"points"`` or ``"fit"``."""
    mode: str
    """Fairing mode."""
    measure: str
    """The measure that was minimised."""
    breaks: tuple[int, ...]
    """Points, from 0, that were intended breaks."""
    before: Numbers
    """The curve before."""
    after: Numbers
    """The faired curve."""
    deviation_certified: float
    """Proved bound on the distance of the curve from its original. For
    ``as_="points"`` the largest move of a point."""
    deviation_sampled: float
    """The largest distance found by sampling."""
    deviation_control: float
    """The largest move of a control point."""
    length: float
    """The length of the original curve."""
    value: float
    """The measure of the result, from the certificate."""
    gap: float
    """No curve within the tolerance and with the conditions has a measure below ``value - gap``."""
    steps: int
    """Newton steps, local steps or sweeps."""
    stopped: str | None
    """Criterion that ended local steps: steps, move, drop, gap, pieces, stalled or done."""
    active: int | None
    """Number of limits that an optimum reaches."""
    findings: tuple[Finding, ...]
    """Corners and wrong points that were found and not taken into account."""
    corrected: tuple[Finding, ...]
    """Corners and wrong points taken into account by ``breaks="auto"``."""
    jump_lengths_before: Floats
    """The jump at each knot before."""
    jump_lengths_after: Floats
    """The jump at each knot of the result."""
    notes: tuple[str, ...]
    """Warnings and notes for the user."""
    seconds: float
    """Time of the fairing."""
    goal: str = "fairest"
    """Goal: choice among the curves within the tolerances."""
    residuals: Floats | None = field(default=None, repr=False)
    """The distance of each point that was given from the curve at its parameter, for fits."""
    used: float | None = None
    """The mean of the squared residuals over tolerances; 1 is noise that fills these evenly."""
    parameters: Floats | None = field(default=None, repr=False)
    """Parameters of the given points on the curve, from 0 to 1."""
    arcs: tuple[Arc, ...] = ()
    """The circular arcs of ``shape`` conditions."""
    thin: bool = False
    """True if the spline has fewer knots than there are points: their feet are their parameters."""
    fairer: float = 0.0
    """Position of the curve between the goal's own (0) and the fairest (1; 2 with chord lengths as
    parameters), chosen to avoid additional inflections.
    """
    log: tuple[NDArray[np.uint32], Floats] | None = field(default=None, repr=False)
    """Local steps in order, if requested: point and new position. Replayed on the original they
    give the result to the bit.
    """

    @property
    def deviation_data(self) -> float:
        """Bound of the distance of the given points from the curve.

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
        """The gap relative to the measure, or to a trillionth of the original one if larger."""
        size = max(self.value, 1e-12 * self.before.measure)
        return self.gap / size if size > 0 else 0.0

    @cached_property
    def displacement(self) -> tuple[Floats, Floats]:
        """Displacement along the curve: fraction of arc length, and distance in percent."""
        if self.spline.closed != self.original.closed:
            raise FairingError("the faired curve and its original are not alike")
        before, after = self.original.samples(8), self.spline.samples(8)
        far = np.linalg.norm(after.points - before.points, axis=1)
        return before.arc, 100.0 * far / self.length if self.length > 0 else far

    def as_dict(self) -> dict[str, Any]:
        """The report as plain data, as printed by ``moldloft fair --json``.

        Returns
        -------
        dict
            Numbers, texts and lists only, so that JSON takes it.
        """
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
            "optimum_claimed": claims_optimum(self.gap, self.gap_relative),
            "steps": self.steps,
            "stopped": self.stopped,
            "active": self.active,
            "findings": [_finding(f) for f in self.findings],
            "corrected": [_finding(f) for f in self.corrected],
            "notes": list(self.notes),
            "budget_used": self.used,
            "fairer": self.fairer,
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
        moved = self.deviation_control > 0
        proved = certificate_of(self.value, self.gap, self.gap_relative, moved=moved)
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
            ("certificate", proved),
            ("steps", ended),
            ("time", f"{1e3 * self.seconds:.3g} ms"),
        ]
        text = lines_of(rows, tail)
        reported = [f"corrected: {f.text}" for f in self.corrected]
        reported += [f"note: {f.text}" for f in self.findings]
        reported += [f"note: {note}" for note in self.notes]
        return "\n".join([text, *reported])

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


explain(globals())
