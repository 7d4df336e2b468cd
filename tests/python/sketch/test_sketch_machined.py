"""Machined parts at random sizes, and parts whose numbers pass through tangency, against OCCT.

A few here; with MOLDLOFT_SOAK=1 a thousand sizes of each family.
"""

from __future__ import annotations

import math
import os
import random

import pytest

pytest.importorskip("OCP")

from scipy.integrate import quad

from moldloft import Sketch
from sketch_machined import MACHINED, OFFSETS, PASSING, halves, numbered
from sketch_ordinary import FAMILIES, Sizes, measures
from sketch_treated import TREATED

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

#: OCCT's edges between round faces are splines within 1e-7.
BOUND = 1e-7


@pytest.mark.parametrize("family", MACHINED)
def test_machined_parts_are_those_of_occt(family: str) -> None:
    for k in range(1000 if SOAK else 1):
        part = MACHINED[family](Sizes(f"{family} {k}"))
        volume, area = measures(part.solid)
        sketch = Sketch()
        sketch.run(f"{part.text}USING {part.name}")
        assert sketch.volume == pytest.approx(volume, rel=BOUND), (k, part.text)
        assert sketch.area == pytest.approx(area, rel=10 * BOUND), (k, part.text)


def bored(n: Sizes, t: float) -> float:
    """The volume of a bar with a cross bore; OCCT's is wrong by 1 % where it touches the side."""
    r, q = n(10, 20), n(2, 6)

    def height(angle: float) -> float:
        z = r - q + t + q * math.sin(angle)
        return 4 * math.sqrt(max(0.0, r * r - z * z)) * (q * math.cos(angle)) ** 2

    top = math.pi / 2 if t <= 0 else math.asin((q - t) / q)
    removed, _ = quad(height, -math.pi / 2, top, epsabs=1e-11, epsrel=1e-12, limit=500)
    return math.pi * r * r * 80 - removed


@pytest.mark.parametrize("family", PASSING)
def test_numbers_pass_through_tangency(family: str) -> None:
    for k in range(100 if SOAK else 1):
        sketch, values = Sketch(), [0.0]
        for t in OFFSETS:
            part = PASSING[family](Sizes(f"{family} {k}"), t)
            text, new = numbered(part.text)
            if t == OFFSETS[0]:
                sketch.run(text)
            else:
                changed = [j for j, x in enumerate(new) if x != values[j]]
                sketch.run("\n".join(f"SET TABLE.N{j} {new[j]!r}" for j in changed))
            values = new
            found = sketch.objects[part.name]
            volume, area = measures(part.solid)
            if family == "breakout":
                volume = bored(Sizes(f"{family} {k}"), t)
            assert found["volume"] == pytest.approx(volume, rel=BOUND), (k, t)
            if family != "breakout" or t != 0.0:
                assert found["area"] == pytest.approx(area, rel=10 * BOUND), (k, t)


class Changed(Sizes):
    """The sizes of a seed, each changed by up to 2 %: what is built of them is the same."""

    def __init__(self, seed: str, change: int) -> None:
        super().__init__(seed)
        self.other = random.Random(f"{seed} change {change}") if change else None

    def __call__(self, low: float, high: float) -> float:
        size = super().__call__(low, high)
        return size if self.other is None else round(size * self.other.uniform(0.98, 1.02), 3)


#: Forty kinds of ordinary parts.
KINDS = {**FAMILIES, **MACHINED, **TREATED}


@pytest.mark.parametrize("family", KINDS if SOAK else ("lug", "keyway", *TREATED))
def test_all_numbers_change(family: str) -> None:
    seed = f"{family} changes"
    sketch = Sketch()
    values: list[float] = []
    for change in range(21 if SOAK else 3):
        part = KINDS[family](Changed(seed, change))
        text, new = numbered(part.text)
        if change == 0:
            sketch.run(text)
        else:
            assert len(new) == len(values)
            changed = [j for j, x in enumerate(new) if x != values[j]]
            with sketch.drag():
                sketch.run("\n".join(f"SET TABLE.N{j} {new[j]!r}" for j in changed))
        values = new
        volume, area = measures(part.solid)
        found = sketch.objects[part.name]
        assert found["volume"] == pytest.approx(volume, rel=BOUND), (change, part.text)
        assert found["area"] == pytest.approx(area, rel=10 * BOUND), (change, part.text)


def test_halves_are_the_whole() -> None:
    """Two halves of a cylinder, cone, ball or ring are one solid with the faces of the whole."""
    for k in range(100 if SOAK else 6):
        part = halves(Sizes(f"halves {k}"))
        sketch = Sketch()
        sketch.run(f"{part.text}USING {part.name}")
        whole = sketch.run("EXPORT STEP A part.step")[-1].file
        both = sketch.run(f"EXPORT STEP {part.name} part.step")[-1].file
        assert whole is not None and both is not None
        faces = [text[1].count(b"ADVANCED_FACE") for text in (whole, both)]
        assert faces[0] == faces[1], (k, part.text)
