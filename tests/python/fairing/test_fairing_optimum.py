"""Curves near their data beside a conic solver: an own statement with SciPy's splines."""

from __future__ import annotations

import os
import sys
import warnings

import numpy as np
import pytest

import moldloft
from conftest import ROOT

pytest.importorskip("scipy")
sys.path.insert(0, str(ROOT / "benches"))
import fair_truth

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
SHAPES = {shape.__name__: shape for shape in fair_truth.SHAPES}
# Clarabel says itself when it has not reached what it was asked for.
EXACTLY = [dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas"), e) for e in (1e-9, 1e-8, 1e-7)]


class Stated:
    """The least third derivative of the cubic with knots at the data, within balls round these."""

    def __init__(self, data, tol):
        from scipy.interpolate import BSpline

        t = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(data, axis=0), axis=1))])
        t /= t[-1]
        knots = np.concatenate([[t[0]] * 4, t[2:-2], [t[-1]] * 4])
        basis = BSpline(knots, np.eye(len(t)), 3)
        spans = np.unique(knots)
        self.values = basis(t)
        third = basis.derivative(3)((spans[1:] + spans[:-1]) / 2)
        self.third = np.sqrt(np.diff(spans))[:, None] * third
        self.knots, self.data, self.tol = knots, data, tol
        self.start = np.linalg.solve(self.values, data)

    def energy(self, control):
        return float(((self.third @ control) ** 2).sum())

    def least(self, cp, size, extra=None):
        """Its value by Clarabel, with the displacement in tolerances and the energy in `size`."""
        x = cp.Variable(self.start.shape)
        # The unknowns are the residuals, so that the balls are single rows.
        from_residuals = np.linalg.inv(self.values) * self.tol
        rows = (self.third @ self.start + (self.third @ from_residuals) @ x) / np.sqrt(size)
        inside = [cp.norm(x, axis=1) <= 1]
        wanted = cp.Minimize(cp.sum_squares(rows))
        more = extra(cp, x, self) if extra else []
        problem = cp.Problem(wanted, [*inside, *more])
        for asked in EXACTLY:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                problem.solve(solver="CLARABEL", **asked)
            if problem.status == "optimal":
                break
        assert problem.status == "optimal"
        return self.energy(self.start + from_residuals @ x.value)


def budget(share):
    return lambda cp, x, p: [cp.sum_squares(x) <= share * len(p.data) / 3]


def one_sided(cp, x, p):
    """No point beyond its datum along the last axis."""
    return [x[:, -1] <= 0]


def fixed_ends(cp, x, p):
    return [x[0] == 0, x[-1] == 0]


PROBLEMS = {
    "fairest": ({"goal": "fairest"}, None),
    "budget": ({"goal": ("budget", 0.8)}, budget(0.8)),
    "tight": ({"goal": ("budget", 0.3)}, budget(0.3)),
    "fixed": ({"goal": "fairest", "fixed": [0, 48]}, fixed_ends),
}
ROWS = [
    (shape, kind, name)
    for k, shape in enumerate(SHAPES)
    for j, kind in enumerate(fair_truth.SPACINGS)
    for i, name in enumerate(PROBLEMS)
    if SOAK or (k + j + i) % 6 == 0
]


@pytest.mark.parametrize(("shape", "kind", "name"), ROWS)
def test_the_optimum_is_a_conic_solvers(shape, kind, name):
    cp = pytest.importorskip("cvxpy")
    _, data, noise = fair_truth.case(SHAPES[shape], kind, 1)
    options, extra = PROBLEMS[name]
    stated = Stated(data, noise)
    faired = moldloft.fair(data, noise, measure="variation", bends=True, spacing="chord", **options)
    dim = data.shape[1]
    assert np.abs(np.asarray(faired.spline.knots) - stated.knots).max() < 1e-12
    control = np.asarray(faired.spline.control_points)[:, :dim]
    off = np.linalg.norm(stated.values @ control - data, axis=1)
    assert off.max() <= noise * (1 + 1e-9)
    ours = stated.energy(control)
    least = stated.least(cp, ours, extra)
    assert ours == pytest.approx(least, rel=1e-6)
    assert faired.gap_relative < 1e-6


@pytest.mark.parametrize(
    ("count", "share"),
    [(k, b) for k in (120, 200) for b in (0.3, 0.8) if SOAK or (k, b) != (200, 0.3)],
)
def test_a_budget_of_many_points_is_a_conic_solvers(count, share):
    """Beyond some hundred points the search for a budget ends where rounding hides the limits."""
    cp = pytest.importorskip("cvxpy")
    rng = np.random.default_rng(count)
    u, noise = np.linspace(0, 1, count), 2e-3
    data = np.column_stack([10 * u, 1.2 * u**2 + 0.5 * np.sin(3 * u)])
    data += rng.uniform(-noise, noise, data.shape) / np.sqrt(2)
    stated = Stated(data, noise)
    options = {"measure": "variation", "bends": True, "spacing": "chord"}
    faired = moldloft.fair(data, noise, goal=("budget", share), **options)
    control = np.asarray(faired.spline.control_points)[:, :2]
    off = np.linalg.norm(stated.values @ control - data, axis=1) / noise
    assert off.max() <= 1 + 1e-9
    assert (off**2).sum() <= share * count / 3 * (1 + 1e-4)
    ours = stated.energy(control)
    least = stated.least(cp, ours, budget(share))
    assert ours == pytest.approx(least, rel=2e-4)
    assert ours <= least / (1 - faired.gap_relative) * (1 + 1e-6)
