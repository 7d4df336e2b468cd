"""Simpler curves within the tolerances: named where they are, and nowhere else."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.optimize import minimize

from moldloft import fair


def noisy(points, tol, seed):
    noise = np.random.default_rng(seed).uniform(-1, 1, points.shape)
    return points + tol * noise / np.maximum(1, np.hypot(*noise.T))[:, None]


T = np.linspace(0, 1, 21)
CURVES = {
    "a straight line": np.column_stack([10 * T, T]),
    "a circle": np.column_stack([5 * np.cos(2 * T), 5 * np.sin(2 * T)]),
    "nothing": np.column_stack([10 * T, np.tanh(4 * (T - 0.5))]),
}


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", CURVES)
def test_a_simpler_curve_within_the_tolerances_is_named(name, seed):
    points = noisy(CURVES[name], 0.01, seed)
    faired = fair(points, 0.01)
    named = [note for note in faired.notes if "of the tolerances" in note]
    simple = faired.after.pieces == 1 and faired.after.largest_curvature * faired.length < 1e-3
    if name == "nothing" or (name == "a straight line" and simple):
        assert not named
        return
    assert named[0].startswith(name)
    share = float(re.search(r"within ([\d.]+) of", named[0])[1])
    if name == "a circle":
        radius, x, y = (float(v) for v in re.findall(r"-?\d[\d.e-]*", named[0])[:3])
        off = abs(np.hypot(*(points - [x, y]).T) - radius)
        assert off.max() / 0.01 == pytest.approx(share, abs=0.01)
        # No circle is nearer than by a tenth: the least largest distance of a direct search.
        most = lambda c: abs(np.hypot(*(points - c[:2]).T) - c[2]).max()  # noqa: E731
        least = minimize(most, [x, y, radius], method="Nelder-Mead").fun
        assert off.max() <= 1.1 * least


def test_points_that_move_one_way_and_rings():
    x = np.linspace(0, 10, 15)
    rng = np.random.default_rng(0)
    bent = np.column_stack([x, 0.05 * x * (10 - x) + rng.uniform(-0.01, 0.01, 15)])
    turned = bent[:, ::-1]
    for points, way in ((bent, (0, 1)), (turned, (1, 0))):
        notes = fair(points, 0.01, motion=way, goal=("budget", 0.1), bends=True).notes
        assert any(
            n.startswith(("a parabola", "an ellipse", "a hyperbola", "a circle")) for n in notes
        )
    ring = 2 * np.pi * np.arange(12) / 12
    points = noisy(np.column_stack([np.cos(ring), np.sin(ring)]), 0.006, 0)
    faired = fair(points, 0.006, closed=True)
    assert faired.after.pieces > 1 and any(n.startswith("a circle") for n in faired.notes)


@pytest.mark.filterwarnings("error")
def test_points_without_limit_and_degenerate_lists():
    points = noisy(CURVES["a circle"], 0.01, 0)
    points[10] += 0.5
    notes = fair(points, 0.01, release=[10]).notes
    assert any(n.startswith("a circle") for n in notes)
    for tol in (None, np.where(np.arange(21) < 18, np.inf, 0.01)):
        assert not any("of the tolerances" in n for n in fair(points, tol).notes)
    spike = np.column_stack([T, np.where(np.arange(21) == 10, 0.3, 0.0)])
    for points in (spike, spike[:, ::-1], np.column_stack([T, T**9])):
        for motion in ("ball", (0, 1)):
            if motion == "ball" or (np.diff(points[:, 0]) > 0).all():
                fair(points, 0.2, motion=motion)
