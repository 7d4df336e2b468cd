"""Drilled parts: MEASURE, the set of the parts, the panels and OCCT on the STEP file agree."""

from __future__ import annotations

import math
import os

import numpy as np
import pytest

import moldloft
from moldloft import Sketch

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def disc(d: float) -> float:
    return math.pi * d * d / 4


def occt_volume(path) -> float:
    pytest.importorskip("OCP")
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(reader.OneShape(), properties, 1e-9)
    return float(properties.Mass())


@pytest.mark.parametrize("seed", range(100 if SOAK else 4))
def test_flanges_and_plates(seed, tmp_path):
    rng = np.random.default_rng(300 + seed)
    whole = lambda low, high: int(rng.integers(low, high + 1))  # noqa: E731
    thick, hole = whole(6, 20), whole(5, 11)
    head = hole + whole(3, 7)
    if seed % 2:
        outer, bore, count = whole(100, 140), whole(20, 50), whole(3, 8)
        ring = (outer / 2 + bore / 2) / 2
        lines = [
            "SKETCH A 2D XY", "SET UNITS MM", f"CIRCLE DIAMETER {outer} AT 0 0", "GENERATE FACES",
            f"EXTRUDE {thick}", f"HOLE A {bore} AT 0 0 INTO B",
        ]  # fmt: skip
        copies, at = f"POLAR {count} {360 / count!r}", f"{ring!r} 0"
        body = (disc(outer) - disc(bore)) * thick
    else:
        count, rows = whole(2, 4), whole(1, 3)
        width, height = 20 + count * (head + 4), 20 + rows * (head + 4)
        lines = [
            "SKETCH B 2D XZ", "SET UNITS MM", f"RECTANGLE {width} {height}", "GENERATE FACES",
            f"EXTRUDE {thick}",
        ]  # fmt: skip
        copies = f"LINEAR {count} {head + 4} 0 LINEAR {rows} 0 {head + 4}"
        at, body = f"{5 + head} {5 + head}", width * height * thick
        count *= rows
    side = "" if seed % 2 else "FROM TOP Y"
    depth = whole(1, 3)
    if seed % 4 < 2:
        mouth, form = (disc(head) - disc(hole)) * depth, f"COUNTERBORE {head} {depth}"
    else:
        r, s = head / 2, hole / 2
        mouth = math.pi / 3 * (r - s) * (r * r + r * s + s * s) - disc(hole) * (r - s)
        form = f"COUNTERSINK {head} 90"
    if seed % 4 >= 2 and (head - hole) / 2 >= thick:
        pytest.skip("the cone is deeper than the plate")
    sketch = Sketch()
    sketch.run("\n".join([*lines, f"HOLE B {hole} AT {at} {side} {form} {copies} INTO C"]))
    expected = body - count * (disc(hole) * thick + mouth)
    assert sketch.volume == pytest.approx(expected, rel=1e-9)
    (tmp_path / "part.skt").write_text(sketch.text)
    (tmp_path / "m.sdl").write_text('load "part.skt";')
    model = moldloft.load(tmp_path / "m.sdl")
    assert model.eval("c.volume") == pytest.approx(expected, rel=1e-9)
    assert model.eval("volume(c.body)") == pytest.approx(expected, rel=1e-9)
    wide = "cuboid({-900, -900, -900}, {900, 900, 900})"
    assert model.eval(f"volume(c.body & {wide})") == pytest.approx(expected, rel=1e-6)
    mesh = model.mesh(tolerance=1e-3)
    assert mesh.closed and mesh.volume == pytest.approx(expected, rel=2e-3)
    (tmp_path / "part.step").write_bytes(sketch.run("EXPORT STEP C part.step")[-1].file[1])
    assert occt_volume(tmp_path / "part.step") == pytest.approx(expected, rel=1e-7)
