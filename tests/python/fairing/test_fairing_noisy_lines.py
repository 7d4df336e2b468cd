"""Straight lines whose points noise has put in the wrong order stay straight."""

from __future__ import annotations

import os

import numpy as np
import pytest

import moldloft

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def noisy_line(rng, dimension, even):
    """Points of a line in any direction, with even noise of 0.2 to 3 spacings."""
    n = int(rng.integers(9, 100))
    places = np.linspace(0, 1, n) if even else np.sort(rng.uniform(0, 1, n))
    way = rng.normal(size=dimension)
    tol = 10 ** rng.uniform(np.log10(0.2), np.log10(3)) / n
    noise = rng.uniform(-tol, tol, (n, dimension)) / np.sqrt(dimension)
    return np.outer(places, way / np.linalg.norm(way)) + noise, tol


@pytest.mark.parametrize("even", [True, False], ids=["even", "random"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_noisy_lines_have_no_bends(dimension, even):
    rng = np.random.default_rng([7, dimension, even])
    draws = 500 if SOAK else 25
    bends = dict.fromkeys(("near", "fairest"), 0)
    back = 0
    for _ in range(draws):
        points, tol = noisy_line(rng, dimension, even)
        back += (np.diff(points @ (points[-1] - points[0])) < 0).any()
        for goal in bends:
            faired = moldloft.fair(points, tol, as_="fit", goal=goal)
            moved = np.linalg.norm(faired.points - points, axis=1)
            assert moved.max() <= tol * (1 + 1e-9)
            bends[goal] += faired.spline.inflections() > 0
    assert back > draws // 4
    assert max(bends.values()) <= draws // 100, bends


def test_lines_with_close_points_have_no_bends():
    """Noise far below the mean spacing, but above that of some points."""
    rng = np.random.default_rng(77)
    draws = 500 if SOAK else 50
    bends = 0
    for _ in range(draws):
        n = int(rng.integers(9, 120))
        x = np.sort(rng.uniform(0, 10, n)) + 1e-3 * np.arange(n)
        tol = 10 ** rng.uniform(-3, -1.5)
        noise = rng.uniform(-tol, tol, (n, 2)) / np.sqrt(2)
        points = np.column_stack([x, rng.uniform(-1, 1) * x]) + noise
        bends += moldloft.fair(points, tol, as_="fit").spline.inflections() > 0
    assert bends <= draws // 100


def test_parameters_of_noisy_order_are_continuous():
    """A point that passes its neighbour moves the curve by little."""
    rng = np.random.default_rng(3)
    points, tol = noisy_line(rng, 2, even=True)
    k = len(points) // 2
    line = points[-1] - points[0]
    line /= np.linalg.norm(line)
    start = points[k] - line * ((points[k] - points[k - 1]) @ line)
    at = np.linspace(0, 1, 64)
    for by in (-0.5 * tol, 0.0, 0.5 * tol):
        curves = []
        for step in (-1e-7, 1e-7):
            points[k] = start + line * (by + step * tol)
            curves.append(moldloft.fair(points, tol, as_="fit").spline(at))
        assert np.abs(curves[0] - curves[1]).max() <= 1e-5 * tol, by


def test_a_hairpin_wider_than_its_noise_turns_back():
    s = np.linspace(-1, 1, 41)
    hairpin = np.column_stack([1 - s**2, 0.1 * s])
    rng = np.random.default_rng(6)
    noisy = hairpin + rng.uniform(-1e-3, 1e-3, hairpin.shape)
    faired = moldloft.fair(noisy, 1.5e-3)
    assert faired.spline.inflections() == 0
    assert abs(faired.spline(np.linspace(0, 1, 400))[:, 0].max() - 1) < 3e-3
