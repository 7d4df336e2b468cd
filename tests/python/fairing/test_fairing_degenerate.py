"""Degenerate calls of fairing: an error of ours, or a finite result that is what it says."""

from __future__ import annotations

import os

import numpy as np
import pytest
from scipy.interpolate import BSpline

import moldloft
from moldloft.fairing import network

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

MEASURES = ["second", "third", "jumps", "jump-lengths", "bending", "variation"]
GOALS = ["near", "fairest", "budget", "nearest", "closest"]


def row(rng, n):
    """So many points that are at one place, on a line, doubled, on a step, in order or not."""
    u = np.linspace(0, 1, n) if rng.random() < 0.5 else np.sort(rng.random(n))
    flat = 0 * u
    points = [
        np.c_[u, np.sin(4 * u), flat],
        np.c_[u, flat, flat],
        np.tile(rng.normal(size=3), (n, 1)),
        np.c_[np.cos(6.3 * u), np.sin(6.3 * u), flat],
        np.c_[np.tile([0.0, 1.0], n)[:n], flat, flat],
        rng.normal(size=(n, 3)),
        np.c_[u, np.round(np.sin(4 * u), 1), flat],
        np.c_[u, np.where(u > 0.5, 1.0, 0.0), flat],
        np.c_[100 * u**3, np.sin(4 * u), flat],
    ][rng.integers(9)]
    if rng.random() < 0.4:
        points[rng.integers(n)] = points[rng.integers(n)]
    if rng.random() < 0.4:
        points = points + rng.normal(size=points.shape) * 10.0 ** rng.integers(-12, -1)
    return points[::-1] if rng.random() < 0.3 else points


def scaled(rng, points):
    points = points * 10.0 ** rng.integers(-9, 10)
    if rng.random() < 0.05:
        points = points.copy()
        points[rng.integers(len(points)), 0] = rng.choice([np.nan, np.inf])
    return points


def options(rng, **choices):
    return {name: rng.choice(of).item() for name, of in choices.items() if rng.random() < 0.3}


def is_what_it_says(faired, points, tol, size):
    """The tolerance and the distances, by SciPy's evaluation of the spline."""
    assert np.isfinite(faired.points).all()
    slack = 1e-9 * tol + 1e-12 * size
    assert np.linalg.norm(faired.points - points, axis=-1).max() <= tol + slack
    assert np.isfinite([faired.value, faired.gap, faired.deviation_certified]).all()
    assert str(faired) and faired.as_dict()
    if getattr(faired, "parameters", None) is None or faired.spline.closed:
        return
    knots, control = faired.spline.open_form()[:2]
    low, high = faired.spline.domain
    spline = BSpline(np.asarray(knots), np.asarray(control), faired.spline.degree)
    off = np.linalg.norm(spline(low + (high - low) * faired.parameters) - points, axis=1).max()
    assert off <= min(tol, faired.deviation_data) + slack


@pytest.mark.parametrize("seed", range(100 if SOAK else 3))
def test_curves(seed):
    rng = np.random.default_rng(seed)
    done = 0
    for _ in range(40):
        points = scaled(rng, row(rng, int(rng.choice([1, 2, 3, 4, 5, 6, 8, 12, 20]))))
        size = np.abs(points[np.isfinite(points)]).max()
        tol = float(rng.choice([0, 1e-12, 1e-6, 1e-3, 0.05, 1, 100])) * size
        asked = options(
            rng,
            as_=["fit", "points", "control"],
            measure=MEASURES,
            goal=GOALS,
            mode=["optimum", "faithful", "vertex", "sweeps", "levels"],
            closed=[True],
            degree=[1, 2, 4, 5],
            spacing=["centripetal", "x", "index"],
            ends=["position", "tangent", "curvature"],
            bends=[True],
        )
        try:
            faired = moldloft.fair(points, tol, **asked)
        except moldloft.Error:
            continue
        is_what_it_says(faired, points, tol, size)
        done += 1
    assert done > 3


@pytest.mark.parametrize("seed", range(100 if SOAK else 3))
def test_surfaces_and_networks(seed):
    rng = np.random.default_rng(1000 + seed)
    done = 0
    for _ in range(20):
        m, n = (int(k) for k in rng.choice([1, 3, 5, 6, 7, 8, 9, 10], 2))
        x, z = np.meshgrid(np.sort(rng.random(m)), np.sort(rng.random(n)), indexing="ij")
        grid = np.stack([x, (1 - x**2) * (1 - z**2), z], -1)
        grid[..., 1] += rng.normal(size=x.shape) * 10.0 ** rng.integers(-8, -1)
        for place, kind in ((np.s_[:], 0), (np.s_[0], 1), (np.s_[0, :1], 2)):
            if rng.integers(8) == kind:
                grid[place] = grid[-1, -1]
        points = scaled(rng, grid.reshape(-1, 3))
        size = np.abs(points[np.isfinite(points)]).max()
        tol = float(rng.choice([0, 1e-12, 1e-6, 1e-3, 0.05, 1, 100])) * size
        asked = options(rng, measure=MEASURES, goal=GOALS, mode=["optimum", "faithful", "sweeps"])
        places = np.arange(m * n).reshape(m, n)
        lines = [*places.tolist(), *places.T.tolist()]
        word = ["fit", "control"][rng.integers(2)]
        for run, own in (
            (
                lambda p, t, a, w=word, s=grid.shape: moldloft.fair(p.reshape(s), t, as_=w, **a),
                grid,
            ),
            (lambda p, t, a, at=lines: network(p, at, t, **a), points),
        ):
            try:
                faired = run(points, tol, asked)
            except moldloft.Error:
                continue
            is_what_it_says(faired, points.reshape(own.shape), tol, size)
            done += 1
    assert done > 2


def test_points_in_one_place_are_counted_by_places():
    for points, places in [([[1.0, 2, 3]] * 9, 1), ([[0.0, 0], [0, 0], [1, 1], [1, 1], [2, 0]], 3)]:
        wanted = f"at least 4 different places .* found {places}: of {len(points)} points"
        with pytest.raises(moldloft.FairingError, match=wanted):
            moldloft.fair(points, 1e-3)
