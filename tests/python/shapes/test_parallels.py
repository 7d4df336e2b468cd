"""Parallels of parallels: each is one of the first shape, at the sum of the distances."""

from __future__ import annotations

import numpy as np
import pytest

import moldloft
from moldloft import Model


def patch(rng: np.random.Generator) -> str:
    """A gently bent surface, open or a tube."""
    if rng.random() < 0.3:
        r = rng.uniform(0.8, 1.5)
        return (
            "AbsPoint O(0, 0, 0); AbsPoint X(0, 0, 1);"
            f"AbsPoint P({r}, 0, 0); AbsPoint Q({r}, 0, 3);"
            "Line axis(O, X); Line ruling(P, Q); RevSurf s0(ruling, axis, 0, 6.283185307179586);"
        )
    rows = []
    for i in range(3):
        for j in range(3):
            x, y, z = 2 * i, 2 * j + rng.uniform(-0.3, 0.3), rng.uniform(-0.4, 0.4)
            rows.append(f"AbsPoint p{i}{j}({x}, {y}, {z});")
    curves = "".join(f"BCurve c{i}({{p{i}0, p{i}1, p{i}2}});" for i in range(3))
    return "".join(rows) + curves + "BLoftSurf s0({c0, c1, c2});"


def chained(text: str, kind: str, name: str, distances: list[float], after: str = "") -> Model:
    """The shape, and each parallel of the one before."""
    steps = [f"param float d{k} = {d};" for k, d in enumerate(distances, 1)]
    steps += [
        f"{kind} {name}{k}({name}{k - 1}, d{k}{after});" for k in range(1, len(distances) + 1)
    ]
    return moldloft.loads(text + "".join(steps))


@pytest.mark.parametrize("seed", range(12))
def test_a_parallel_surface_of_a_parallel_has_the_sum_of_the_distances(seed: int) -> None:
    rng = np.random.default_rng(seed)
    distances = [float(d) for d in rng.uniform(-0.08, 0.08, int(rng.integers(2, 7)))]
    model = chained(patch(rng), "OffsetSurf", "s", distances)
    last = f"s{len(distances)}"
    h = 1e-5
    for u, v in rng.uniform(0.1, 0.9, (4, 2)):
        at = lambda a, b: np.array(model.eval(f"s0({a}, {b})"))  # noqa: E731
        n = np.cross(at(u + h, v) - at(u - h, v), at(u, v + h) - at(u, v - h))
        n /= np.linalg.norm(n)
        found = np.array(model.eval(f"{last}({u}, {v})"))
        assert np.abs(found - (at(u, v) + sum(distances) * n)).max() < 1e-8
        for k in range(1, len(distances) + 1):
            slopes = [model.derivative(f"{last}({u}, {v}).{c}", f"d{k}") for c in "xyz"]
            assert np.abs(np.array(slopes) - n).max() < 1e-8


@pytest.mark.parametrize("seed", range(8))
def test_a_parallel_curve_of_a_parallel_has_the_sum_of_the_distances(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = [(float(k), *(float(x) for x in rng.uniform(-0.2, 0.2, 2))) for k in range(5)]
    text = "".join(f"AbsPoint p{k}({x}, {y}, {z});" for k, (x, y, z) in enumerate(points))
    text += "BCurve c0({p0, p1, p2, p3, p4});"
    distances = [float(d) for d in rng.uniform(-0.1, 0.1, int(rng.integers(2, 7)))]
    model = chained(text, "OffsetCurve", "c", distances, ', "z=0"')
    last = f"c{len(distances)}"
    h = 1e-5
    for t in rng.uniform(0.1, 0.9, 5):
        at = lambda a: np.array(model.eval(f"c0({a})"))  # noqa: E731
        side = np.cross(at(t + h) - at(t - h), [0.0, 0.0, 1.0])
        side /= np.linalg.norm(side)
        found = np.array(model.eval(f"{last}({t})"))
        assert np.abs(found - (at(t) + sum(distances) * side)).max() < 1e-8
    # In another plane it is a parallel of the parallel.
    both = moldloft.loads(text + 'OffsetCurve c1(c0, 0.1, "z=0"); OffsetCurve c2(c1, 0.1, "y=0");')
    t = 0.4
    at = lambda a: np.array(both.eval(f"c1({a})"))  # noqa: E731
    side = np.cross(at(t + h) - at(t - h), [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    assert np.abs(np.array(both.eval(f"c2({t})")) - (at(t) + 0.1 * side)).max() < 1e-8


def test_a_long_chain_of_parallels_is_as_quick_as_one() -> None:
    rng = np.random.default_rng(99)
    model = chained(patch(rng), "OffsetSurf", "s", [0.002] * 90)
    one = moldloft.loads(patch(np.random.default_rng(99)) + "OffsetSurf s1(s0, 0.18);")
    a, b = model.eval("s90(0.3, 0.7)"), one.eval("s1(0.3, 0.7)")
    assert np.abs(np.array(a) - np.array(b)).max() < 1e-12
