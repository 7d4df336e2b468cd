"""Ordinary parts at random sizes: each body is OCCT's, and so is its STEP file.

A few here; with MOLDLOFT_SOAK=1 a thousand sizes of each family.
"""

from __future__ import annotations

import os

import pytest

pytest.importorskip("OCP")

import moldloft
from moldloft import Sketch
from sketch_machined import MACHINED
from sketch_ordinary import FAMILIES, Sizes, box, cut, joined, measures, read_volume, rod

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

#: OCCT's edges between round faces are splines within 1e-7.
BOUND = 1e-7


@pytest.mark.parametrize("family", FAMILIES)
def test_ordinary_parts_are_those_of_occt(family: str) -> None:
    refused = []
    for k in range(1000 if SOAK else 1):
        part = FAMILIES[family](Sizes(f"{family} {k}"))
        volume, area = measures(part.solid)
        sketch = Sketch()
        try:
            sketch.run(f"{part.text}USING {part.name}")
        except moldloft.SketchError as error:
            refused.append((k, str(error)))
            continue
        assert sketch.volume == pytest.approx(volume, rel=BOUND), (k, part.text)
        assert sketch.area == pytest.approx(area, rel=10 * BOUND), (k, part.text)
    assert not refused


#: Families of parts that touch themselves along a line, or whose faces touch.
TOUCHING = ("wall posts", "edge holes", "edge bosses", "counterbores", "tee", "ribbed boss")

#: Edges between round faces are splines within 1e-7 of the size of the part.
STEP_BOUND = 1e-6


@pytest.mark.parametrize("family", {**FAMILIES, **MACHINED} if SOAK else TOUCHING)
def test_the_step_file_has_the_volume(family: str, tmp_path) -> None:
    for k in range(100 if SOAK else 1):
        part = {**FAMILIES, **MACHINED}[family](Sizes(f"{family} step {k}"))
        sketch = Sketch()
        sketch.run(f"{part.text}USING {part.name}")
        path = tmp_path / "part.step"
        path.write_bytes(sketch.run(f"EXPORT STEP {part.name} part.step")[-1].file[1])
        assert read_volume(path) == pytest.approx(sketch.volume, rel=STEP_BOUND), (k, part.text)


def test_parts_of_one_cylinder_are_one_face() -> None:
    for k in range(200 if SOAK else 4):
        n = Sizes(f"coaxial {k}")
        r, d = n(5, 20), n(20, 40)
        first, second = n(5, 30), n(5, 30)
        # Bars of one radius that overlap or meet, and holes from both ends of a block.
        bar = joined(
            "B",
            rod("B1", "x", r, (0.0, 0.0, 0.0), d),
            rod("B2", "x", r, (n.pick(d, d - 1.0, d / 2), 0.0, 0.0), d + 7.0),
        )
        block = box("A", (0.0, -50.0, -50.0), (first + second, 100.0, 100.0))
        drills = [
            rod("D1", "x", r, (-1.0, 0.0, 0.0), first + 1.0 + n.pick(0.0, 1.0)),
            rod("D2", "x", r, (first, 0.0, 0.0), second + 1.0),
        ]
        for part, faces in ((bar, 3), (cut("P", block, *n.shuffled(drills)), 7)):
            volume, area = measures(part.solid)
            sketch = Sketch()
            sketch.run(f"{part.text}USING {part.name}")
            assert sketch.volume == pytest.approx(volume, rel=BOUND), (k, part.text)
            assert sketch.area == pytest.approx(area, rel=10 * BOUND), (k, part.text)
            file = sketch.run(f"EXPORT STEP {part.name} part.step")[-1].file
            assert file is not None
            assert file[1].count(b"ADVANCED_FACE") == faces, (k, part.text)
