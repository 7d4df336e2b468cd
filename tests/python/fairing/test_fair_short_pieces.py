"""Derivatives of curves through data with few points between knuckles."""

from __future__ import annotations

import os

import numpy as np
import pytest

import moldloft

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def curve(rng: np.random.Generator, options: str) -> str:
    """A poly-line of noisy points whose pieces between knuckles have two to five."""
    pieces = [int(n) for n in rng.integers(2, 6, int(rng.integers(2, 4)))]
    pieces[-1] = max(pieces[-1], 4)
    breaks = np.cumsum([n - 1 for n in pieces])[:-1] + 1
    x = np.cumsum(rng.uniform(0.5, 1.5, sum(n - 1 for n in pieces) + 1))
    y = 0.4 * np.sin(x) + 0.02 * rng.normal(size=len(x))
    rows = ", ".join(
        f"{{{float(a)!r} * w, {float(b)!r} * w * w, 0}}" for a, b in zip(x, y, strict=True)
    )
    marks = ", ".join(map(str, breaks))
    return (
        f'curve p = {{{rows}}}; FairCurve c(p, {options}, spacing = "chord", breaks = {{{marks}}});'
    )


@pytest.mark.parametrize("options", ["0", "0.05, bends = 1"])
@pytest.mark.parametrize("seed", range(200 if SOAK else 15))
def test_derivatives_are_those_of_differences(seed: int, options: str) -> None:
    rng = np.random.default_rng([31, seed])
    text = curve(rng, options)
    places = rng.uniform(0, 1, 6).tolist()
    beads = "".join(f"AbsBead b{k}(c, {t!r});" for k, t in enumerate(places))
    m = moldloft.loads(f"param float w = 1.1 in [0.5, 2]; {text} {beads}")
    names = [f"b{k}.{axis}" for k in range(len(places)) for axis in "xy"]
    try:
        exact = [m.derivative(name, "w") for name in names]
    except moldloft.ModelError as error:
        # One of several fairest, or a limit that is reached and does not push.
        assert "no derivatives are available" in str(error)
        assert options != "0"
        return
    found = []
    for w in (1.1 + 1e-5, 1.1 - 1e-5):
        m["w"] = w
        found.append(np.array([m.eval(name) for name in names]))
    np.testing.assert_allclose(
        exact, (found[0] - found[1]) / 2e-5, rtol=0, atol=1e-6 if options == "0" else 1e-4
    )


@pytest.mark.parametrize("seed", range(200 if SOAK else 40))
def test_a_digit_of_the_data_turns_no_curve(seed: int) -> None:
    """The last digits of the data do not decide what is used of the tolerances."""
    m = moldloft.loads(
        f"param float w = 1.1 in [0.5, 2]; {curve(np.random.default_rng([31, seed]), '0.05')}"
    )
    used = []
    for w in (1.1, 1.1 + 1e-9, 1.1 - 1e-9, 1.1 + 1e-7):
        m["w"] = w
        used.append(m.eval("c.used"))
    assert np.ptp(used) < 1e-4
