"""Signs of curvature and limits on ordinary shapes: what is there is found."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.optimize import linprog

import moldloft

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

KINDS = ("ellipse", "superellipse", "midship", "deadrise", "parabola", "exponential")


def section(flat: float, radius: float, side: float, rise: float, s: np.ndarray) -> np.ndarray:
    """A bottom with a deadrise, a bilge and a side at fractions of the length."""
    turn = np.pi / 2 - rise
    s = s * (flat + radius * turn + side)
    along, up = np.array([np.cos(rise), np.sin(rise)]), np.array([-np.sin(rise), np.cos(rise)])
    angle = rise + np.clip((s - flat) / radius, 0, turn)
    bilge = flat * along + radius * up
    arc = bilge + radius * np.c_[np.sin(angle), -np.cos(angle)]
    out = arc + np.c_[0 * s, np.maximum(s - flat - radius * turn, 0)]
    return np.where((s <= flat)[:, None], s[:, None] * along, out)


def shape(kind: str, rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
    """Points of a convex shape of a unit's size, which turn to the left."""
    if kind == "ellipse":
        angle = rng.uniform(0, 6) + rng.uniform(0.5, 3) * t
        return np.c_[np.cos(angle), rng.uniform(0.2, 1) * np.sin(angle)]
    if kind == "superellipse":
        power, angle = 2 / rng.uniform(1.2, 4), np.pi / 2 * t
        x, y = np.sin(angle).clip(0) ** power, 1 - np.cos(angle).clip(0) ** power
        return np.c_[x, rng.uniform(0.4, 1.5) * y]
    if kind in ("midship", "deadrise"):
        radius, half, depth = rng.uniform(0.15, 0.6), rng.uniform(1, 2), rng.uniform(0.8, 1.5)
        rise = rng.uniform(0, 0.25) if kind == "deadrise" else 0.0
        return section(half - radius, radius, depth - radius, rise, t)
    if kind == "parabola":
        return np.c_[t, rng.uniform(0.05, 2) * (t - rng.uniform(0.2, 0.8)) ** 2]
    return np.c_[t, rng.uniform(0.2, 1.5) * np.exp(rng.uniform(0.5, 6) * (t - 1))]


def drawn(seed: int) -> tuple[np.ndarray, float, str, dict[str, Any]]:
    """Points of a shape with noise just below the tolerance, and the word for its turn."""
    rng = np.random.default_rng([48, seed])
    kind, count = KINDS[seed % len(KINDS)], int(rng.integers(10, 50))
    t = np.linspace(0, 1, count)
    form = int(rng.integers(3))
    if form == 1:
        t[1:-1] += rng.uniform(-0.35, 0.35, count - 2) / (count - 1)
    if form == 2:
        t = (np.sort(np.r_[0, 1, rng.uniform(0, 1, count - 2)]) + t / 2) / 1.5
    exact = shape(kind, rng, t)
    size = float(np.ptp(exact, axis=0).max())
    tolerance = size * 10 ** rng.uniform(-4, -2.3)
    options: dict[str, Any] = {}
    if kind in ("parabola", "exponential") and rng.random() < 0.5:
        options = {"motion": (0, 1), "spacing": "x"}
        noise = np.c_[0 * t, rng.uniform(-1, 1, count)]
    else:
        noise = rng.uniform(-1, 1, (count, 2))
        noise /= np.maximum(1, np.hypot(*noise.T))[:, None]
    points, word = exact + 0.999 * tolerance * noise, "convex"
    if rng.random() < 0.3:
        points, word = points[::-1], "concave"
    return points, tolerance, "one-way" if rng.random() < 0.2 else word, options


def scipy_of(faired: Any) -> BSpline:
    own = faired.spline
    return BSpline(np.asarray(own.knots), np.asarray(own.control_points)[:, :2], own.degree)


def least_turn(curve: BSpline, word: str) -> float:
    """The least curvature in the direction of a word, over the largest, at 20 places a span."""
    knots = np.unique(curve.t)
    t = (knots[:-1, None] + np.diff(knots)[:, None] * np.linspace(0, 1, 21)).ravel()
    d, dd = curve.derivative(1)(t), curve.derivative(2)(t)
    k = (d[:, 0] * dd[:, 1] - d[:, 1] * dd[:, 0]) / np.hypot(*d.T) ** 3
    k *= {"convex": 1.0, "concave": -1.0, "one-way": np.sign(k[np.argmax(abs(k))])}[word]
    return float(k.min() / abs(k).max())


def furthest(faired: Any, curve: BSpline, points: np.ndarray) -> float:
    t = curve.t[0] + (curve.t[-1] - curve.t[0]) * np.asarray(faired.parameters)
    return float(np.hypot(*(curve(t) - points).T).max())


@pytest.mark.parametrize("goal", ["near", "fairest"])
def test_a_convex_shape_is_never_refused(goal: str) -> None:
    # Goals with a budget take ten times as long as the fairest.
    for seed in range(1200 if SOAK else 36 if goal == "fairest" else 12):
        points, tolerance, word, options = drawn(seed)
        faired = moldloft.fair(points, tolerance, shape=word, goal=goal, **options)
        curve = scipy_of(faired)
        assert furthest(faired, curve, points) <= tolerance * (1 + 1e-9), seed
        assert least_turn(curve, word) >= -1e-9, seed


def yard(seed: int) -> np.ndarray:
    """The midship section of a yard with noise of 4 mm: half-breadth 16, bilge 2.2, depth 12 m."""
    a, arc, b = np.linspace(0, 13.8, 9), np.linspace(0, np.pi / 2, 8)[1:-1], np.linspace(2.2, 12, 9)
    bilge = np.c_[13.8 + 2.2 * np.sin(arc), 2.2 - 2.2 * np.cos(arc)]
    exact = np.r_[np.c_[a, 0 * a], bilge, np.c_[0 * b + 16, b]]
    noise = np.random.default_rng(seed).uniform(-1, 1, exact.shape)
    return exact + 0.004 * noise / np.maximum(1, np.hypot(*noise.T))[:, None]


@pytest.mark.parametrize("goal", ["near", "fairest"])
def test_a_midship_section_is_convex_within_its_half_breadth(goal: str) -> None:
    """Knots at the points alone cannot follow flat, bilge and side: some between them can."""
    for seed in range(60 if SOAK else 3 if goal == "fairest" else 1):
        points = yard(seed)
        for shapes in (["convex"], ["within=1,0:16", "within=0,-1:0"], ["convex", "within=1,0:16"]):
            faired = moldloft.fair(points, 0.004, shape=shapes, goal=goal)
            curve = scipy_of(faired)
            assert furthest(faired, curve, points) <= 0.004 * (1 + 1e-9)
            place = curve(np.linspace(curve.t[0], curve.t[-1], 20001))
            if "convex" in shapes:
                assert least_turn(curve, "convex") >= -1e-9
            if "within=1,0:16" in shapes:
                assert place[:, 0].max() <= 16 + 1e-12
            if "within=0,-1:0" in shapes:
                assert place[:, 1].min() >= -1e-12


def test_refused_graphs_have_no_convex_polygon() -> None:
    """Offsets are refused where a linear program finds no convex polygon, and there alone."""
    refused = 0
    for seed in range(400 if SOAK else 40):
        rng = np.random.default_rng([49, seed])
        x = np.linspace(0, 1, int(rng.integers(7, 25)))
        dent = rng.uniform(0, 2e-2) * np.exp(-(((x - rng.uniform(0.2, 0.8)) / 0.1) ** 2))
        y = 0.3 * (x - 0.4) ** 2 + dent + rng.uniform(-2e-3, 2e-3, len(x))
        second = np.diff(np.eye(len(x)), 2, axis=0)
        # How far the points have to move for the least slope to rise everywhere.
        rows = np.c_[-second, np.zeros(len(second))]
        box = np.r_[
            np.c_[np.eye(len(x)), -np.ones(len(x))], np.c_[-np.eye(len(x)), -np.ones(len(x))]
        ]
        cost = np.r_[np.zeros(len(x)), 1.0]
        most = np.r_[second @ y, np.zeros(2 * len(x))]
        needed = linprog(cost, np.r_[rows, box], most, bounds=[(None, None)] * (len(x) + 1)).fun
        if abs(needed - 2e-3) < 2e-5:
            continue
        points = np.c_[x, y]
        try:
            faired = moldloft.fair(
                points, 2e-3, motion=(0, 1), spacing="x", shape="convex", goal="fairest"
            )
        except moldloft.FairingError as error:
            assert needed > 2e-3, (seed, needed)
            assert "no curve with this shape is within the tolerance: point" in str(error)
            refused += 1
            continue
        assert needed < 2e-3, (seed, needed)
        assert least_turn(scipy_of(faired), "convex") >= -1e-9
    assert refused > 5
