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

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
SHAPES = {shape.__name__: shape for shape in fair_truth.SHAPES}


@pytest.mark.parametrize("kind", fair_truth.SPACINGS)
@pytest.mark.parametrize("name", SHAPES)
def test_known_shapes(name, kind):
    """The tolerance is the noise. Random places leave gaps, which may hide a nose."""
    method = fair_truth.METHODS["moldloft near"]
    seeds = range(1, 41 if SOAK else 3)
    scores = [fair_truth.score(method, SHAPES[name], kind, seed) for seed in seeds]
    # A polyline of the curve is off it by as much as this.
    assert max(s.data for s in scores) <= 1.002
    rms = np.array([s.rms for s in scores])
    random = kind == "random"
    if not (random and name == "naca"):
        assert np.median(rms) <= 0.5
    elif SOAK:
        # Of 40 draws 0.476, SciPy 0.555. Draws that leave so wide a gap near the nose that a curve
        # through exact points is 0.3 to 0.9 off are worse, and the median of few draws says little.
        assert np.median(rms) <= 0.5
        assert sum(s.inflections > 0 for s in scores) <= 4
    if not random:
        # Of 720 draws one is at 0.575, an aerofoil at half stations.
        assert sorted(rms)[-2] <= 0.52
        assert rms.max() <= (0.58 if SOAK else 0.52)
        assert max(s.inflections for s in scores) <= 0
        assert max(s.pieces for s in scores) <= 3
