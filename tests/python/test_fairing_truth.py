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
    far = sum(s.pieces > 2 for s in scores)
    assert far <= (20 if kind == "random" and name == "helix" else 7 if SOAK else 0)


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
