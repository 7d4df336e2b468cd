"""Numbers that are given: parameters follow by the least change, or a refusal has the range."""

from __future__ import annotations

import os
import random
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

import moldloft
from conftest import ROOT
from moldloft.errors import Error, ModelError

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
#: Examples that are measured in a moment; those of sets and sketches are not.
QUICK = {"arch_dam", "caisson", "car_body", "catamaran", "spar"}
EXAMPLES = [p for p in sorted((ROOT / "examples").rglob("*.sdl")) if SOAK or p.stem in QUICK]
NUMBERS = ["hydrostatics.volume", "hydrostatics.lcb", "mesh.area", "mesh.volume"]

BOX = (
    "param float l = 10 in [5, 20]; param float b = 4 in [2, 6]; param float t = 2 in [1, 3];\n"
    "AbsPoint P(l * b * t, l / b, t);\n"
)


HOME, WIDTH = np.array([10, 4, 2.0]), np.array([15, 4, 2.0])


def by_another_solver(wish: dict[str, float], weights: dict[str, float]) -> Any:
    w = np.array([weights[n] for n in "lbt"])
    return minimize(
        lambda x: float(np.sum((w * (x - HOME) / WIDTH) ** 2)),
        HOME,
        method="SLSQP",
        bounds=[(5, 20), (2, 6), (1, 3)],
        constraints=[
            {"type": "eq", "fun": lambda x: x[0] * x[1] * x[2] / wish["P.x"] - 1},
            {"type": "eq", "fun": lambda x: x[0] / x[1] / wish["P.y"] - 1},
        ],
        options={"ftol": 1e-14, "maxiter": 300},
    ).x


def test_the_least_change_is_that_of_another_solver() -> None:
    for seed in range(5):
        r = random.Random(seed)
        m = moldloft.loads(BOX)
        wish = {"P.x": r.uniform(70, 100), "P.y": r.uniform(2.2, 2.9)}
        weights = {name: r.uniform(0.5, 2) for name in "lbt"}
        found = m.solve_for(wish, by=weights)
        mine = np.array([m[n] for n in "lbt"])
        assert m.eval("P.x") == pytest.approx(wish["P.x"], rel=1e-8)
        assert m.eval("P.y") == pytest.approx(wish["P.y"], rel=1e-8)
        assert mine == pytest.approx(by_another_solver(wish, weights), abs=2e-3)
        assert sum(a.share for a in found.adjustments.values()) == pytest.approx(1)
        assert {n: a.after for n, a in found.adjustments.items()} == {n: m[n] for n in "lbt"}


def test_a_refusal_has_the_range_and_changes_nothing() -> None:
    m = moldloft.loads(BOX)
    text = m.text
    # l b t from 10 to 360; with l / b = 2.5 held at most l = 15, b = 6, t = 3.
    with pytest.raises(ModelError, match=r"out of reach") as refused:
        m.solve_for({"P.x": 1000}, by=["l", "b", "t"])
    low, high = found_range(str(refused.value))
    assert (low, high) == (pytest.approx(10, rel=1e-5), pytest.approx(360, rel=1e-5))
    with pytest.raises(ModelError) as refused:
        m.solve_for({"P.x": 1000, "P.y": 2.5}, by=["l", "b", "t"])
    assert found_range(str(refused.value))[1] == pytest.approx(270, rel=1e-3)
    assert m.text == text and (m["l"], m["b"], m["t"]) == (10, 4, 2)
    with pytest.raises(ModelError, match="no effect"):
        m.solve_for({"P.z": 2.5}, by=["l", "b"])
    for wrong in ({"P": 3}, {"nothing": 1}, {"P.x": float("nan")}, {}):
        with pytest.raises(Error):
            m.solve_for(wrong, by=["l"])
    for by in (["nobody"], [], ["l", "l"], {"l": -1.0}):
        with pytest.raises(Error):
            m.solve_for({"P.x": 90}, by=by)


def found_range(message: str) -> tuple[float, float]:
    found = re.search(r"from (-?[\d.e+-]+) to (-?[\d.e+-]+)", message)
    assert found, message
    return float(found[1]), float(found[2])


def numbers_of(m: Any) -> list[str]:
    found = []
    for text in NUMBERS:
        try:
            x = m.eval(text)
        except Error:
            continue
        # Not one that is zero but for rounding, such as the LCB of a body that is symmetric.
        if isinstance(x, float) and abs(x) > 1e-12:
            found.append(text)
    return found


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_two_numbers_of_an_example_by_three_parameters(path: Path) -> None:
    m = moldloft.load(path)
    free = [n for n, p in m.params.items() if not p.whole and p.low is not None]
    if not free or m.has_errors:
        pytest.skip("no parameters with ranges")
    numbers = numbers_of(m)
    if not numbers:
        pytest.skip("no numbers")
    r = random.Random(path.stem)
    start = {n: m[n] for n in free}
    reached = refused = 0
    for k in range(20 if SOAK else 2):
        by = r.sample(free, min(3, len(free)))
        wanted = r.sample(numbers, min(2, len(numbers), len(by)))
        if k % 2:
            wish = {text: m.eval(text) * r.uniform(0.8, 1.25) for text in wanted}
        else:
            there = {}
            for n in by:
                p = m.params[n]
                there[n] = min(
                    p.high, max(p.low, start[n] + 0.2 * r.uniform(-1, 1) * (p.high - p.low))
                )
            try:
                m.set(there)
                wish = {text: m.eval(text) for text in wanted}
            except Error:
                m.set(start)
                continue
            m.set(start)
        try:
            found = m.solve_for(wish, by=by)
        except ModelError as error:
            refused += 1
            assert "out of reach" in str(error) and {n: m[n] for n in free} == start
            assert re.search("from .* to |where|on the way|no effect", str(error)), error
            continue
        reached += 1
        for text, x in wish.items():
            assert m.eval(text) == pytest.approx(x, rel=1e-6), (text, by)
            assert found.reached[text] == pytest.approx(x, rel=1e-6)
        for n in free:
            p = m.params[n]
            assert p.low <= m[n] <= p.high and (n in by or m[n] == start[n])
        m.set(start)
    print(f"{path.stem}: {reached} reached, {refused} refused")
