"""Rest, righting arms and their zeros of ordinary ships of plane faces, against NumPy."""

from __future__ import annotations

import math
import os

import numpy as np
import pytest
from scipy.optimize import brentq

import moldloft
import random_models
from test_random_models import into_water, wet_parts

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))


def buoyancy(corners, level):
    """Volume and centre below a level, in the axes of the corners."""
    p = wet_parts(corners, level)
    a, b = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    up = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    depth = p[:, :, 2] - level
    volume = (up * depth.mean(1)).sum()
    # By the divergence theorem; means of products over a triangle.
    mixed = (p.sum(1) * depth.sum(1)[:, None] + (p * depth[:, :, None]).sum(1)) / 12
    squares = (depth.sum(1) ** 2 + (depth**2).sum(1)) / 24
    moment = (up[:, None] * mixed).sum(0)
    moment[2] = (up * squares).sum() + level * volume
    return volume, moment / volume


class Floating:
    """A ship of triangles with a mass and a centre of gravity."""

    def __init__(self, ship, volume, gravity):
        self.ship, self.volume, self.gravity = ship, volume, np.array(gravity)

    def state(self, level, heel, trim):
        """What is left of the volume, and the arms from gravity to buoyancy along, across, up."""
        axes = into_water(heel, trim)
        volume, centre = buoyancy(self.ship.triangles @ axes.T, level)
        return volume / self.volume - 1, centre - axes @ self.gravity

    def level(self, heel, trim):
        heights = (self.ship.triangles @ into_water(heel, trim).T)[:, :, 2]
        ends = heights.min() + 1e-9 * self.ship.depth, heights.max()
        return brentq(lambda z: self.state(z, heel, trim)[0], *ends, xtol=1e-13, rtol=1e-14)

    def height(self, heel, trim):
        """How far gravity is above buoyancy: the energy over the weight."""
        return -self.state(self.level(heel, trim), heel, trim)[1][2]

    def arm(self, row):
        """The arm across at an attitude, which is that of a rest lengthwise."""
        left, arms = self.state(row.level, row.heel, row.trim)
        assert abs(left) < 1e-9 and abs(arms[0]) < 1e-7 * self.ship.length
        return arms[1]


@pytest.mark.parametrize("seed", range(200 if SOAK else 10))
def test_rest_arms_and_their_zeros(seed):
    rng = np.random.default_rng(seed)
    ship = random_models.faceted_ship(rng)
    model = moldloft.loads(ship.text)
    model.check()
    assert not model.diagnostics and not model.junctions()
    whole, centre = buoyancy(ship.triangles, 100.0)
    assert model.hydrostatics(level=100).volume == pytest.approx(whole, rel=1e-9)
    volume = whole * rng.uniform(0.2, 0.7)
    off = rng.uniform(-0.02, 0.02) * ship.length, 0, rng.uniform(-0.3, 0.4) * ship.depth
    gravity = centre + np.array(off)
    oracle = Floating(ship, volume, gravity)
    size = ship.length

    stability = model.stability(volume, cg=gravity, density=1, accuracy=1e-9)
    for heel in np.radians([0, 7, 23, 48, 90, 140]):
        row = stability.at(heel)
        assert row.heel == heel and row.gz == pytest.approx(oracle.arm(row), abs=1e-8 * size)
    # Heel is about the body's own axis, the metacentre about a level one.
    slope = oracle.arm(stability.at(1e-4)) / 1e-4 / math.cos(stability.at(0.0).trim)
    assert stability.gmt == pytest.approx(slope, rel=1e-5, abs=1e-5 * ship.beam)

    loll, vanishing = stability.loll(), stability.vanishing()
    for angle in (loll, vanishing):
        if angle is not None and abs(oracle.arm(stability.at(angle))) > 1e-7 * size:
            # No zero: the body turns over its ends there, and the arm jumps.
            sides = [stability.at(angle + turn) for turn in (-1e-6, 1e-6)]
            arms = [oracle.arm(row) for row in sides]
            assert angle == vanishing and arms[0] > 0 > arms[1]
            assert abs(sides[0].trim - sides[1].trim) > 0.2
    # Between upright and loll the ship is pushed on, between rest and vanishing it is righted.
    if loll is not None:
        assert all(oracle.arm(stability.at(share * loll)) < 0 for share in (0.2, 0.5, 0.8))
    if vanishing is not None:
        rest = loll or 0.0
        turns = [rest + share * (vanishing - rest) for share in (0.2, 0.5, 0.8)]
        assert all(oracle.arm(stability.at(heel)) > 0 for heel in turns)

    # Free in heel and trim, with gravity off the middle: at rest, and called stable exactly when
    # all small turns raise the energy.
    for across in (0.0, rng.uniform(-0.1, 0.1) * ship.beam):
        moved = Floating(ship, volume, gravity + np.array([0, across, 0]))
        row = model.equilibrium(volume, cg=moved.gravity, density=1, accuracy=1e-9)
        assert row.status == "converged"
        left, arms = moved.state(row.level, row.heel, row.trim)
        assert abs(left) < 1e-9 and max(abs(arms[:2])) < 1e-7 * size
        here = moved.height(row.heel, row.trim)
        angles = np.linspace(0, 2 * math.pi, 9)[:-1]
        around = [
            moved.height(row.heel + 1e-3 * math.cos(a), row.trim + 1e-3 * math.sin(a)) - here
            for a in angles
        ]
        assert row.stable == (min(around) > 0), (row.stable, around)
