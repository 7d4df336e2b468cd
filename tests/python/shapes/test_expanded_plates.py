"""Derivatives of plates laid flat, across the fans of developable surfaces."""

from __future__ import annotations

import os

import numpy as np
import pytest

import moldloft

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def plate(seed: int) -> str:
    """A plate between two sheers whose ends are not opposite: it has fans at its ends."""
    rng = np.random.default_rng([78, seed])
    text = ["param float w = 1.25 in [0.5, 2];"]
    for name, z in (("a", 0.0), ("b", 2.0)):
        for k, (x, y) in enumerate(((0.0, 0.0), (2.0, 1.5), (4.0, 0.0))):
            dx, dy, dz = (float(d) for d in rng.uniform(-0.1, 0.1, 3))
            text.append(f"AbsPoint {name}{k}({x} * w + {dx!r}, {y + dy!r}, {z + dz!r});")
        text.append(f"BCurve {name}({{{name}0, {name}1, {name}2}}, degree = 2);")
    text.append("DevSurf s(a, b); ExpandedSurf flat(s);")
    text += [f"AbsMagnet m{k}(flat, {u}, {v});" for k, (u, v) in enumerate(PLACES)]
    return "\n".join(text)


PLACES = ((0.02, 0.5), (0.5, 0.0), (0.97, 0.3), (1.0, 0.0), (1.0, 1.0))


@pytest.mark.parametrize("seed", range(300 if SOAK else 12))
def test_derivatives_are_those_of_differences(seed: int) -> None:
    m = moldloft.loads(plate(seed))
    names = [f"m{k}.{axis}" for k in range(len(PLACES)) for axis in "xy"] + ["flat.area"]
    exact = [m.derivative(name, "w") for name in names]
    found = []
    for w in (1.25 + 1e-4, 1.25 - 1e-4):
        m["w"] = w
        found.append(np.array([m.eval(name) for name in names]))
    np.testing.assert_allclose(exact, (found[0] - found[1]) / 2e-4, rtol=0, atol=2e-6)
