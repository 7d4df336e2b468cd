"""Known shapes under bounded noise: near to the truth, of its form, and within the tolerance."""

from __future__ import annotations

import os
import sys

import numpy as np
import pytest

from conftest import ROOT

pytest.importorskip("scipy")
sys.path.insert(0, str(ROOT / "benches"))
import fair_truth

import moldloft
from moldloft.fairing import network

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
SHAPES = {shape.__name__: shape for shape in fair_truth.SHAPES}


@pytest.mark.parametrize("kind", fair_truth.SPACINGS)
@pytest.mark.parametrize("name", SHAPES)
def test_known_shapes(name, kind):
    """The tolerance is the noise; no curve has an inflection more than its shape, at any places."""
    method = fair_truth.METHODS["moldloft near"]
    seeds = range(1, 41 if SOAK else 3)
    scores = [fair_truth.score(method, SHAPES[name], kind, seed) for seed in seeds]
    # A polyline of the curve is off it by as much as this.
    assert max(s.data for s in scores) <= 1.002
    assert max(s.inflections for s in scores) <= 0
    rms = np.array([s.rms for s in scores])
    if not (kind == "random" and name == "naca"):
        # Of 920 draws the worst has 0.49; of 690 fresh ones three have 0.53 to 0.74.
        assert rms.max() <= 0.5
    elif SOAK:
        # Gaps beside a nose hide its shape: see the oracle below.
        assert np.median(rms) <= 0.5
    # Of forty draws 15 helices at random places have more than two pieces more, up to six at
    # others, and up to three aerofoils; no other curve has.
    far = sum(s.pieces > 2 for s in scores)
    most = {"helix": 16 if kind == "random" else 6, "naca": 3}.get(name, 0)
    assert far <= (most if SOAK or most == 16 else 0)


def test_an_aerofoil_at_random_places_beside_an_oracle():
    """An oracle that knows the truth picks the budget and the spacing, true arc lengths among them.

    Where it is more than half the noise off no choice of these comes nearer.
    """
    near, best = [], []
    t = np.linspace(0, 1, 2001)
    shares = (0.03, 0.1, 0.2, 0.3, 0.5, 0.8, 1.2)
    for seed in range(1, 41 if SOAK else 5):
        truth, data, noise = fair_truth.case(fair_truth.naca, "random", seed)
        u = fair_truth.places("random", fair_truth.Lcg(seed))
        steps = np.linalg.norm(np.diff(truth, axis=0), axis=1)
        arc = np.concatenate([[0], np.cumsum(steps)])
        true = np.interp(u, fair_truth.DENSE, arc) / arc[-1]

        def off(truth=truth, data=data, noise=noise, **options):
            points = moldloft.fair(data, noise, **options).spline(t)[:, :2]
            return np.sqrt((fair_truth.distances(points, truth) ** 2).mean()) / noise

        near.append(off())
        spacings = ({"spacing": "curvature"}, {"spacing": "chord"}, {"at": true})
        best.append(min(off(goal=("budget", s), **one) for s in shares for one in spacings))
    ratio = np.array(near) / np.array(best)
    assert np.median(ratio) < 1.5 and ratio.max() < 2.5, ratio


def test_a_network_beside_oracles():
    """What can be known of a rounded Wigley hull from few offsets.

    One oracle knows the truth and picks the best of four goals and two spacings; one knows the nine
    functions that the measure does not see; one knows the hull but for its beam, a single number.
    None of these comes ten times nearer to the truth than the data on every grid.
    """
    gains = []
    for seed in range(42 if SOAK else 3):
        rng = np.random.default_rng([42, seed])
        m, n = [(15, 7), (21, 11), (26, 13)][seed % 3]
        x = np.sort(np.r_[0, 10, rng.uniform(0, 10, m - 2)])
        z = np.sort(np.r_[0, 1.25, rng.uniform(0, 1.25, n - 2)])
        a, b = (v.ravel() for v in np.meshgrid(x, z, indexing="ij"))
        s, w = a / 5 - 1, b / 1.25
        hull = 0.9 * (1 - s**2) * (1 - (1 - w) ** 2)
        read = np.c_[a, np.round(hull, 2), b]
        at = np.arange(m * n).reshape(m, n)
        lines = [*at.tolist(), *at.T.tolist()]

        def gain(y, read=read, hull=hull):
            return np.sqrt(((read[:, 1] - hull) ** 2).sum() / ((y - hull) ** 2).sum())

        def run(read=read, lines=lines, gain=gain, **options):
            options = {"motion": (0, 1, 0), **options}
            return gain(network(read, lines, 0.005 * (1 + 1e-9), **options).points[:, 1])

        near = run()
        goals = ("fairest", ("budget", 0.3), ("budget", 0.6), ("budget", 0.9))
        best = max(near, run(goal="fairest", spacing="z"), *(run(goal=g) for g in goals))
        nine = np.stack([s**i * w**j for i in range(3) for j in range(3)], axis=1)
        known = gain(nine @ np.linalg.lstsq(nine, read[:, 1], rcond=None)[0])
        beam = gain(hull * (hull @ read[:, 1]) / (hull @ hull))
        gains.append((near, best, known, beam))
    near, best, known, beam = np.array(gains).T
    # Lines that are weighed one by one, with no more bends than they need, cost a tenth at most.
    assert np.median(near / best) > 0.9 and (near / best).min() > 0.25, gains
    assert np.median(near / known) > 1, gains
    assert near.min() > 2, gains
    if SOAK:
        assert np.median(near) > 10 and near[2::3].min() > 8
        assert (beam < 10).any() and (known < 10).mean() > 0.5 and (best < 10).any()
