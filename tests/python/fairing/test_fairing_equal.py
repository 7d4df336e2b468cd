"""Results do not depend on numbering, direction, units and place: every mode and dimension."""

from __future__ import annotations

import itertools
import os

import numpy as np
import pytest

import moldloft
from moldloft.fairing import network

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def noisy(rng, kind, n):
    """A line of points with noise, in a plane or in space, open or closed."""
    if kind == "ring":
        t = 2 * np.pi * (np.arange(n) + rng.uniform(-0.3, 0.3, n)) / n
        rows = np.c_[2 * np.cos(t), np.sin(t), np.zeros(n)]
    else:
        t = np.sort(np.r_[0, rng.uniform(0.02, 0.98, n - 2), 1])
        t = np.arange(n) / (n - 1) * 0.7 + 0.3 * t
        rows = np.c_[5 * t, np.sin(4 * t), (0.3 * t**2 if kind == "space" else 0 * t)]
    wild = rng.uniform(-1, 1, rows.shape) * [1, 1, kind == "space"]
    return rows + 4e-3 * wild, 6e-3


DATA = [
    {"goal": goal, "measure": measure, **more}
    for goal in ("near", "budget", "fairest", ("nearest", 0.2))
    for measure in ("variation", "bending", "second", "third")
    for more in ({}, {"degree": 4}, {"spacing": "centripetal"}, {"spacing": "curvature"})
    if not (more.get("degree") == 4 and measure in ("second", "third"))
]
"""Optima of data."""

OTHERS = [
    {"as_": role, "mode": mode, "measure": measure}
    for role in ("control", "points")
    for mode in ("optimum", "faithful", "literal", "vertex", "sweeps", "levels")
    for measure in ("second", "third", "jumps")
    if not (mode in ("faithful", "literal", "levels") and measure != "second")
]
"""The other modes, where the index is the parameter."""


def placed(rng):
    """A turn, a unit and a shift."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return turn, 10.0 ** rng.integers(-6, 7), rng.normal(size=3)


@pytest.mark.parametrize("kind", ["plane", "space", "ring"])
def test_curves_of_every_mode(kind):
    """Reversed, turned, moved and scaled points, and rings begun elsewhere, are faired alike."""
    rng = np.random.default_rng([5, ["plane", "space", "ring"].index(kind)])
    every = [*DATA, *OTHERS]
    chosen = every if SOAK else [every[k] for k in rng.permutation(len(every))[:16]]
    rounds = 4 if SOAK else 1
    for one, _ in itertools.product(chosen, range(rounds)):
        # At the edge of a count of turns rounding decides: they are left as they come.
        options = {**one, "bends": True}
        if kind == "ring":
            if options.get("mode") == "levels":
                continue
            options = {**options, "closed": True}
        points, tol = noisy(rng, kind, 24)
        turn, scale, shift = placed(rng)
        base = moldloft.fair(points, tol, **options).points
        if options.get("goal") == "fairest":
            # The others may leave the points as they are, with a note where turns are in the way.
            assert np.abs(base - points).max() > 1e-6, options
        moved = moldloft.fair(scale * (points @ turn.T + shift), scale * tol, **options).points
        # Limits that are reached decide; where the measure is flat only so many digits are left.
        assert np.abs((moved / scale - shift) @ turn - base).max() < 2e-2 * tol, options
        if options.get("mode") in ("sweeps", "levels"):
            # They go through the points in their order.
            continue
        back = moldloft.fair(points[::-1], tol, **options).points[::-1]
        assert np.abs(back - base).max() < 2e-2 * tol, options
        if kind == "ring" and "mode" not in options:
            first = int(rng.integers(1, 24))
            other = np.roll(
                moldloft.fair(np.roll(points, -first, 0), tol, **options).points, first, 0
            )
            assert np.abs(other - base).max() < 2e-2 * tol, options


@pytest.mark.parametrize("kind", ["surface", "network"])
def test_grids_of_every_mode(kind):
    rng = np.random.default_rng([6, kind == "network"])
    goals = ("near", "budget", "fairest")
    measures = ("third", "second") if kind == "network" else ("variation", "bending")
    for goal, measure in itertools.product(goals, measures):
        m, n = 9, 7
        a, b = np.meshgrid(
            np.arange(m) + rng.uniform(-0.2, 0.2, m), np.arange(n) * 1.3, indexing="ij"
        )
        grid = np.stack([a, np.sin(0.5 * a) * (1 - b**2 / 90), b], -1)
        points = (grid + 5e-3 * rng.uniform(-1, 1, grid.shape)).reshape(-1, 3)
        order = np.arange(m * n).reshape(m, n)
        turn, scale, shift = placed(rng)

        def run(data, tol, places, goal=goal, measure=measure):
            if kind == "network":
                lines = [*places.tolist(), *places.T.tolist()]
                return network(data, lines, tol, goal=goal, measure=measure).points
            out = np.empty_like(data)
            made = moldloft.fair(data[places], tol, goal=goal, measure=measure, as_="fit")
            out[places.ravel()] = made.points.reshape(-1, 3)
            return out

        base = run(points, 8e-3, order)
        moved = run(scale * (points @ turn.T + shift), scale * 8e-3, order)
        close = 2e-2 * 8e-3
        assert np.abs((moved / scale - shift) @ turn - base).max() < close, (goal, measure)
        assert np.abs(run(points, 8e-3, order[::-1]) - base).max() < close, (goal, measure)
        assert np.abs(run(points, 8e-3, order.T) - base).max() < close, (goal, measure)
