"""Laws of fairing: exact data stay at any spacing; networks come nearer to the truth."""

from __future__ import annotations

import os

import numpy as np
import pytest

import moldloft
from moldloft.fairing import network

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

CURVES = {
    "line": lambda u: np.c_[3 * u, 0.4 * u, 0 * u],
    "parabola": lambda u: np.c_[3 * u - 1, 0.5 * (3 * u - 1) ** 2, 0 * u],
    "cubic": lambda u: np.c_[3 * u - 1, 0.3 * (3 * u - 1) ** 3 - 0.6 * u, 0 * u],
    "circle": lambda u: np.c_[np.cos(2.5 * u), np.sin(2.5 * u), 0 * u],
    "ellipse": lambda u: np.c_[1.5 * np.cos(2.5 * u), 0.6 * np.sin(2.5 * u), 0 * u],
    "helix": lambda u: np.c_[np.cos(4 * u), np.sin(4 * u), 0.9 * u],
    "ring": lambda u: np.c_[np.cos(2 * np.pi * u), np.sin(2 * np.pi * u), 0 * u][:-1],
}


def stations(rng, n):
    """Places in [0, 1] whose steps differ by factors of up to a hundred."""
    most = rng.choice([1, 2, 10, 100])
    steps = np.exp(rng.uniform(-0.5, 0.5, n - 1) * np.log(most))
    x = np.concatenate([[0], np.cumsum(steps)])
    return x / x[-1]


@pytest.mark.parametrize("name", CURVES)
def test_exact_data_stay_at_any_spacing(name):
    rng = np.random.default_rng(list(CURVES).index(name))
    for _ in range(200 if SOAK else 6):
        points = CURVES[name](stations(rng, int(rng.integers(16, 60))))
        if rng.random() < 0.5:
            turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
            points = points @ turn.T + rng.normal(size=3)
        points = points * 10.0 ** rng.integers(-3, 4)
        if rng.random() < 0.5:
            points = points[::-1]
        size = np.abs(points).max() + np.ptp(points)
        for as_ in ("fit", "points"):
            for spacing in ("chord", "centripetal"):
                for measure in ("variation", "third", "second", "jumps"):
                    faired = moldloft.fair(
                        points,
                        1e-3 * size,
                        as_=as_,
                        spacing=spacing,
                        measure=measure,
                        closed=name == "ring",
                    )
                    far = np.linalg.norm(faired.points - points, axis=1).max()
                    assert far <= 1e-12 * size, (as_, spacing, measure, len(points))


def test_a_circle_and_a_line_are_one_piece():
    u = np.linspace(0, 1, 65)
    ring = moldloft.fair(CURVES["ring"](u), 1e-3, closed=True)
    assert ring.before.pieces == ring.after.pieces == 1
    line = moldloft.fair(CURVES["line"](u), 1e-3)
    assert line.before.pieces == line.after.pieces == 1


def bends(values, places):
    slopes = np.diff(values) / np.diff(places)
    turns = np.diff(slopes) / (places[2:] - places[:-2])
    signs = np.sign(turns[np.abs(turns) > 1e-9])
    return int((signs[1:] != signs[:-1]).sum())


HULLS = {
    "Wigley": lambda s, z: 0.9 * (1 - s**2) * (1 - z**2),
    "round": lambda s, z: 0.9 * (1 - abs(s) ** 3) * (1 - z**2) ** 0.75,
    "fine bow": lambda s, z: 0.9 * np.cos(0.5 * np.pi * s) ** 1.6 * (1 - 0.55 * z**2),
    "parallel body": lambda s, z: (
        0.9 * (1 - np.clip((abs(s) - 0.4) / 0.6, 0, 1) ** 2.2) * (1 - z**6)
    ),
}


@pytest.mark.parametrize("name", HULLS)
def test_networks_come_nearer_to_the_truth(name):
    """Offsets read to 0.01 at uneven stations and waterlines."""
    rng = np.random.default_rng(1)
    x = np.sort(np.concatenate([[0, 10], rng.uniform(0, 10, 19)]))
    z = np.sort(np.concatenate([[0, 1.25], rng.uniform(0, 1.25, 9)]))
    m, n = len(x), len(z)
    a, b = (v.ravel() for v in np.meshgrid(x, z, indexing="ij"))
    truth = HULLS[name](a / 5 - 1, (1.25 - b) / 1.25)
    read = np.column_stack([a, np.round(truth, 2), b])
    places = np.arange(m * n).reshape(m, n)
    curves = [*places.tolist(), *places.T.tolist()]
    # Least third derivatives have the Wigley hull, and no other of these.
    goal = "fairest" if name == "Wigley" else "near"
    faired = network(read, curves, 0.005, motion=(0, 1, 0), goal=goal)
    y = faired.points[:, 1]
    assert np.abs(y - read[:, 1]).max() <= 0.005 * (1 + 1e-9)
    gain = np.sqrt(((read[:, 1] - truth) ** 2).mean() / ((y - truth) ** 2).mean())
    assert gain > (10 if name == "Wigley" else 1)
    if name == "Wigley":
        grid = y.reshape(m, n)
        assert sum(bends(row, z) for row in grid) + sum(bends(col, x) for col in grid.T) == 0


def test_a_wigley_network_over_draws_of_noise():
    rng = np.random.default_rng(1)
    x = np.sort(np.concatenate([[0, 10], rng.uniform(0, 10, 19)]))
    z = np.sort(np.concatenate([[0, 1.25], rng.uniform(0, 1.25, 9)]))
    a, b = (v.ravel() for v in np.meshgrid(x, z, indexing="ij"))
    truth = HULLS["Wigley"](a / 5 - 1, (1.25 - b) / 1.25)
    places = np.arange(len(a)).reshape(len(x), len(z))
    curves = [*places.tolist(), *places.T.tolist()]
    gains = []
    for seed in range(1, 40 if SOAK else 7):
        noise = np.random.default_rng(seed).uniform(-0.005, 0.005, len(a))
        read = np.column_stack([a, truth + noise, b])
        y = network(read, curves, 0.005, motion=(0, 1, 0), fixed=(), goal="fairest").points[:, 1]
        gains.append(np.sqrt((noise**2).mean() / ((y - truth) ** 2).mean()))
    assert np.exp(np.mean(np.log(gains))) > 8
