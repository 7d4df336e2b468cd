"""Fairing of curves through data, under tolerances at these."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.errors import FairingError
from moldloft.fairing.arrays import direction, narrowed, points_of, radii
from moldloft.fairing.asked import ends_of, goal_of, index_of, spacing_of
from moldloft.fairing.conditions import join_conditions, linear_conditions
from moldloft.fairing.faired import Arc, Fairing
from moldloft.fairing.findings import order_of
from moldloft.fairing.report import Finding, Numbers
from moldloft.fairing.simpler import simpler
from moldloft.fairing.spline import Spline

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


def chosen(given: Sequence[int] | str, found: list[Finding], kind: str, count: int) -> list[int]:
    """Points by number, or those proposed by findings of a kind."""
    if isinstance(given, str):
        if given != "auto":
            raise FairingError(f"expected numbers of points or `auto`, found `{given}`")
        return sorted({f.index for f in found if f.kind == kind})
    return sorted({index_of(k, count) for k in given})


@dataclass
class Data:
    """Data and the options of the curve near them, as given by the caller."""

    points: ArrayLike
    tol: ArrayLike | None
    as_: str
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
    goal: Any
    bends: bool
    shape: list[str]
    accuracy: float | None
    through: list[tuple[float, ArrayLike]]
    tangents: list[tuple[float, ArrayLike]]
    keep: Sequence[str]
    joins: Sequence[Spline]
    draft: bool = False


def fair_data(asked: Data, started: float) -> Fairing:
    """Data under tolerances."""
    tol = asked.tol
    data, width = points_of(asked.points)
    n = len(data)
    least = 2 * asked.degree + 2 if asked.closed else asked.degree + 2
    if n < least:
        raise FairingError(f"expected at least {least} points for degree {asked.degree}, found {n}")
    found = [Finding.of(row) for row in _core.data_findings(data, asked.closed)]
    found += order_of(data, asked.closed)
    breaks = chosen(asked.breaks, found, "corner", n)
    release = chosen(asked.release, found, "outlier", n)
    # Neighbours in one place have one parameter.
    places = 1 + int((data[1:] != data[:-1]).any(axis=1).sum())
    if places <= asked.degree:
        raise FairingError(
            f"expected at least {asked.degree + 1} different places for degree {asked.degree}, "
            f"found {places}: of {n} points the others coincide with the one before"
        )
    notes = []
    word, way = direction(asked.motion)
    kept = list(ends_of(asked.ends, asked.closed))
    spaced, spacing_way = spacing_of(asked.spacing)
    conditions, labels = linear_conditions(asked.through, asked.tangents, asked.keep)
    if asked.joins:
        rough = Spline.interpolate(data, degree=asked.degree, closed=asked.closed)
        for k, join in enumerate(join_conditions(asked.joins, rough)):
            kept[int(join[1])] = "position"
            conditions.append(join)
            labels.append(f"join {k + 1}")
    at = None
    if asked.at is not None:
        at = [float(t) for t in np.asarray(asked.at, np.float64).ravel()]
        rises = len(at) == n and all(a < b for a, b in pairwise(at)) and at[0] >= 0 and at[-1] <= 1
        if not rises:
            raise FairingError(f"expected {n} rising parameters in [0, 1]")
    core, original, reported = _core.Spline.fair_data(
        data,
        {
            "tolerance": radii(tol, n),
            "fixed": [index_of(k, n) for k in asked.fixed],
            "release": release,
            "breaks": breaks,
            "motion": word,
            "direction": way,
            "ends": kept,
            "closed": asked.closed,
            "degree": asked.degree,
            "spacing": spaced,
            "spacing_direction": spacing_way,
            "at": at,
            "measure": asked.measure,
            "goal": goal_of(asked.goal),
            "conditions": conditions,
            "labels": labels,
            "shape": asked.shape,
            "bends": asked.bends,
            "accuracy": asked.accuracy,
            "draft": asked.draft,
        },
    )
    for k in release:
        off = float(reported["residuals"][k])
        notes.append(f"point {k + 1} was released: the curve passes {off:.3e} from it")
    faired, before = Spline._of(core), Spline._of(original)
    if reported["thin"]:
        count = len(original.control_points)
        notes.append(
            f"{n} points are fitted by a spline of {count} control points, a number derived from "
            "the data; `before` is the least-squares spline; a spacing such as `chord` gives a "
            "knot at each point"
        )
    if reported["refined"]:
        count = len(original.control_points)
        notes.append(
            f"no curve with knots at the points alone was found with this shape: {count} control "
            "points, with knots between them"
        )
    after = Numbers(**reported["after"])
    if not (breaks or asked.shape or conditions or asked.draft):
        limits = np.array(radii(tol, n))
        limits[release] = np.inf
        length = reported["deviation"]["length"]
        note = simpler(data, limits, (word, np.asarray(way)), after, length)
        notes += [note] if note else []
    arcs = tuple(Arc(a, b, r, np.asarray(c), off) for (a, b), r, c, off in reported["arcs"])
    notes += [str(arc) for arc in arcs]
    rows = faired(reported["at"])
    axis = np.asarray(way)
    if word == "along":
        # Fixed points are unchanged to the bit.
        rows = data + np.outer((rows - data) @ axis, axis) / (axis @ axis)
    elif word == "across" and np.count_nonzero(axis) == 1:
        rows[:, axis != 0] = data[:, axis != 0]
    # Points on the curve to rounding are unchanged to the bit.
    still = reported["residuals"] <= 64 * np.finfo(float).eps * np.abs(data).max()
    rows[still] = data[still]
    far, certificate = reported["deviation"], reported["certificate"]
    taken = {*breaks, *release}
    return Fairing(
        points=narrowed(rows, width),
        spline=faired,
        original=before,
        data=data,
        tol=None if tol is None else float(np.max(np.asarray(tol, np.float64))),
        as_=asked.as_,
        mode="optimum",
        measure=reported["measure"],
        breaks=tuple(breaks),
        before=Numbers(**reported["before"]),
        after=after,
        deviation_certified=far["certified"],
        deviation_sampled=far["sampled"],
        deviation_control=far["control"],
        length=far["length"],
        value=certificate["value"],
        gap=certificate["gap"],
        steps=reported["steps"],
        stopped=None,
        active=reported["active"],
        findings=tuple(f for f in found if f.index not in taken),
        corrected=tuple(f for f in found if f.index in taken),
        jump_lengths_before=reported["jumps_before"],
        jump_lengths_after=reported["jumps_after"],
        notes=(*reported["notes"], *notes),
        seconds=time.perf_counter() - started,
        goal=goal_of(asked.goal)[0],
        residuals=reported["residuals"],
        used=reported["used"],
        parameters=reported["at"],
        arcs=arcs,
        thin=reported["thin"],
        fairer=reported["fairer"],
    )
