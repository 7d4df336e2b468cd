"""Fairing of splines, their control points and fits of data: conversion of input and result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.errors import FairingError
from moldloft.fairing.arrays import narrowed, points_of, radii, refuse_repeats
from moldloft.fairing.asked import index_of
from moldloft.fairing.faired import Fairing
from moldloft.fairing.report import Finding, Numbers
from moldloft.fairing.spline import Spline

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


@dataclass
class Own:
    """Knots and weights given by the user."""

    knots: ArrayLike | None
    weights: ArrayLike | None
    period: float | None

    @property
    def given(self) -> bool:
        """True if knots or weights are given."""
        return self.knots is not None or self.weights is not None

    def control(self, data: Floats, degree: int, closed: bool) -> Spline:
        """The same spline with these control points."""
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
class Prepared:
    """The spline to fair, with its source."""

    spline: Spline
    data: Floats
    width: int
    role: str
    breaks: tuple[int, ...]
    marks: list[int]
    parameters: Floats | None
    findings: tuple[Finding, ...]
    corrected: tuple[Finding, ...]
    own: bool = False
    """True if knots or weights were given."""


def prepared(
    points: ArrayLike | Spline,
    role: str,
    closed: bool,
    degree: int,
    spacing: str,
    count: int | None,
    breaks: Sequence[int] | str,
    own: Own,
) -> Prepared:
    """The spline to fair, with properties found in the data."""
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
        chosen = sorted({index_of(b, len(data)) for b in breaks})
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
    return Prepared(
        spline,
        data,
        width,
        role,
        tuple(chosen),
        marks,
        parameters,
        tuple(found),
        tuple(corrected),
        own.given,
    )


def _least_squares(
    points: Floats, degree: int, count: int, spacing: str, closed: bool
) -> tuple[Spline, Floats, float, float]:
    core, at, largest, rms = _core.Spline.least_squares(points, degree, count, spacing, closed)
    return Spline._of(core), at, largest, rms


def left(tol: ArrayLike | None, made: Prepared) -> ArrayLike | None:
    """Tolerances of the data minus the residuals of the fit."""
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


def spread(tol: ArrayLike | None, made: Prepared, n: int) -> list[float]:
    """Tolerances of control points from those of data points: the smallest near each."""
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


UNEVEN = 1.8
"""Ratio of steps between points above which the spacing is uneven: half stations give 2."""


def uneven(data: Floats) -> list[str]:
    """Warning for points spaced unevenly although their index is the parameter."""
    steps = np.linalg.norm(np.diff(data, axis=0), axis=1)
    if len(steps) < 2 or not (steps > 0).all():
        return []
    ratio = np.maximum(steps[1:] / steps[:-1], steps[:-1] / steps[1:])
    k = int(ratio.argmax())
    if ratio[k] < UNEVEN:
        return []
    return [
        f"the index is the parameter here, but at point {k + 2} the step between points changes by "
        f"a factor of {ratio[k]:.3g}: `fit` follows their spacing"
    ]


def result(
    made: Prepared,
    faired: Spline,
    reported: dict[str, Any],
    tol: ArrayLike | None,
    mode: str,
    width: int,
    seconds: float,
    data: Floats,
) -> Fairing:
    """The report of a faired spline."""
    original, spline = made.spline, faired
    before, after = Numbers(**reported["before"]), Numbers(**reported["after"])
    far, certificate = reported["deviation"], reported["certificate"]
    certified, sampled = far["certified"], far["sampled"]
    notes = list(reported["notes"])
    if made.role in ("points", "control") and not made.own:
        notes += uneven(data)
    if made.role == "points":
        rows = faired.control_points
        certified = sampled = far["control"]
        closed = original.closed
        laid = [
            Spline._interpolated(p, original.degree, "index", closed, made.breaks)[0]
            for p in (data, rows)
        ]
        original, spline = laid
        before, after = (_counted(n, s) for n, s in ((before, laid[0]), (after, laid[1])))
    elif made.parameters is not None:
        rows = faired(made.parameters)
    else:
        rows = faired.control_points
    log = (reported["log_index"], reported["log_to"]) if "log_index" in reported else None
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
        measure=reported["measure"],
        breaks=made.breaks,
        before=before,
        after=after,
        deviation_certified=certified,
        deviation_sampled=sampled,
        deviation_control=far["control"],
        length=original.length if made.role == "points" else far["length"],
        value=certificate["value"],
        gap=certificate["gap"],
        steps=reported["steps"],
        stopped=reported["stopped"],
        active=reported["active"],
        findings=made.findings,
        corrected=made.corrected,
        jump_lengths_before=reported["jumps_before"],
        jump_lengths_after=reported["jumps_after"],
        notes=tuple(notes),
        seconds=seconds,
        log=log,
    )


def _counted(numbers: Numbers, spline: Spline) -> Numbers:
    """The same sums with the counts of the curve through the points."""
    curvature = spline.samples().curvature
    return Numbers(
        numbers.measure,
        numbers.jumps,
        numbers.largest_jump,
        spline.monotone_pieces(),
        spline.inflections(),
        float(np.abs(curvature).max()),
    )
