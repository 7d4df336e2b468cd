"""Branches by their number: one branch at all values of a parameter, or an error where not."""

from __future__ import annotations

import os

import numpy as np
import pytest
from numpy.polynomial import Polynomial

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
CASES = 100 if SOAK else 6
VALUES = 400 if SOAK else 12


def bernstein(heights: np.ndarray) -> Polynomial:
    """The polynomial of a Bézier curve, in powers of u."""
    degree = len(heights) - 1
    u = Polynomial([0, 1])
    terms = (heights[k] * u**k * (1 - u) ** (degree - k) for k in range(degree + 1))
    binomials = np.cumprod([1, *((degree - k) / (k + 1) for k in range(degree))])
    total = Polynomial([0])
    for term, factor in zip(terms, binomials, strict=True):
        total = total + term * factor
    return total


def roots(curve: Polynomial, level: float) -> np.ndarray:
    all_roots = (curve - level).roots()
    real = all_roots[abs(all_roots.imag) < 1e-9].real
    return np.sort(real[(real > 0) & (real < 1)])


@pytest.mark.parametrize("seed", range(CASES))
def test_a_numbered_branch_is_one_branch(seed: int) -> None:
    """z = f(u) + slope v, cut at a level: the branches are f(u) = level - slope v."""
    rng = np.random.default_rng(seed)
    heights = rng.uniform(-1, 1, 6)
    slope = 0.0 if seed % 2 else float(rng.uniform(-0.1, 0.1))
    curve = bernstein(heights)
    net = ", ".join(
        f"{{{4 * k / 5!r}, {2 * v}, {float(h + slope * v)!r}}}"
        for k, h in enumerate(heights)
        for v in (0, 1)
    )
    # A level at which there are two branches or more.
    low, high = heights.min(), heights.max()
    # The same number of roots at all v, none of which is near another or an edge.
    places = {}
    for z in np.linspace(low, high, 200):
        at = [roots(curve, z - slope * v) for v in np.linspace(0, 1, 41)]
        if len({len(r) for r in at}) == 1 and len(at[0]):
            lows, highs = np.min(at, axis=0), np.max(at, axis=0)
            if min([*(lows[1:] - highs[:-1]), lows[0], 1 - highs[-1]]) > 0.02:
                places[float(z)] = len(at[0])
    if not places:
        pytest.skip("every branch is near an edge")
    start, count = max(places.items(), key=lambda item: item[1])
    number = int(rng.integers(1, count + 1))
    text = (
        f"param float level = {start!r} in [{float(low)!r}, {float(high)!r}]; ZPlane water(level);"
        f"BSurf skin({{{net}}}, 6, 2, 5, 1);"
        f"IntSnake cut(skin, water, branch = {{{number}, {count}}});"
    )
    model = moldloft.loads(text)
    found = 0
    for level in rng.uniform(low, high, VALUES):
        model.set({"level": float(level)})
        at = [roots(curve, level - slope * v) for v in np.linspace(0, 1, 41)]
        same = {len(r) for r in at} == {count}
        faults = {d.id for d in model.diagnostics if d.is_error}
        if faults:
            # A branch may touch an edge between two of the samples.
            assert faults <= {"branch-count", "branch-order", "tangent-contact"}, text
            ranges = np.array(at) if same else None
            if ranges is not None and len(at[0]) == count:
                lows, highs = ranges.min(axis=0), ranges.max(axis=0)
                near = min([*(lows[1:] - highs[:-1]), lows[0], 1 - highs[-1]])
                assert near < 0.02, (text, level)
            continue
        for t in (0, 0.3, 1):
            x, y, z = model.eval(f"cut({t})")
            assert z == pytest.approx(level, abs=1e-9)
            assert abs(curve(x / 4) + slope * y / 2 - level) < 1e-9, (text, level)
        if not same:
            # A branch ends on an edge across.
            continue
        found += 1
        for t in (0, 0.3, 1):
            x, y, z = model.eval(f"cut({t})")
            assert z == pytest.approx(level, abs=1e-9)
            assert x / 4 == pytest.approx(
                roots(curve, level - slope * y / 2)[number - 1], abs=1e-9
            ), text
    assert found, text
