"""SWEEP along random chains of lines and arcs: Pappus's theorem, and OCCT's pipe of the same.

A few here; with MOLDLOFT_SOAK=1 the whole.
"""

from __future__ import annotations

import math
import os

import numpy as np
import pytest

from moldloft import Sketch
from test_sketch_holes import occt_volume

pytest.importorskip("OCP")

from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakePipe
from OCP.GC import GC_MakeArcOfCircle
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt

from sketch_ordinary import measures

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


class Way:
    """A chain in the plane of x and z that starts upwards from the origin, its corners round."""

    def __init__(self, rng: np.random.Generator, wide: float) -> None:
        n = int(rng.integers(2, 5))
        turns = np.cumsum([0.0, *rng.uniform(0.4, 1.4, n - 1) * rng.choice([-1, 1])])
        lengths = np.round(rng.uniform(8 * wide, 14 * wide, n), 1)
        steps = np.stack([np.sin(turns), np.cos(turns)], axis=1) * lengths[:, None]
        self.points = np.vstack([[0.0, 0.0], np.cumsum(steps, axis=0)])
        self.radii = np.round(rng.uniform(1.5 * wide, 3 * wide, n - 1), 2)
        self.turns = np.abs(np.diff(turns))
        self.length = float(lengths.sum())
        for radius, turn in zip(self.radii, self.turns, strict=True):
            self.length += radius * (turn - 2 * math.tan(turn / 2))

    def text(self) -> str:
        points = enumerate(self.points.tolist())
        draw = "".join(f"POINT {k + 1} {x!r} {z!r}\n" for k, (x, z) in points)
        ids = " ".join(str(k + 1) for k in range(len(self.points)))
        arcs = (
            f"ARC A{k} CORNER {k + 2} RADIUS {r!r}\n" for k, r in enumerate(self.radii.tolist())
        )
        head = "SKETCH WAY 2D XZ\nSET EXACT ON\nSET UNITS MM\n"
        return f"{head}{draw}POLYLINE {ids}\nACCEPT ALL\n{''.join(arcs)}"

    def wire(self):
        made = BRepBuilderAPI_MakeWire()
        at = lambda p: gp_Pnt(float(p[0]), 0.0, float(p[1]))  # noqa: E731
        start = self.points[0]
        for k in range(1, len(self.points)):
            corner = self.points[k]
            if k == len(self.points) - 1:
                made.Add(BRepBuilderAPI_MakeEdge(at(start), at(corner)).Edge())
                break
            before = corner - self.points[k - 1]
            after = self.points[k + 1] - corner
            a, b = before / np.hypot(*before), after / np.hypot(*after)
            radius, turn = self.radii[k - 1], self.turns[k - 1]
            cut = radius * math.tan(turn / 2)
            first, last = corner - a * cut, corner + b * cut
            middle = corner + (b - a) / np.hypot(*(b - a)) * radius * (1 / math.cos(turn / 2) - 1)
            made.Add(BRepBuilderAPI_MakeEdge(at(start), at(first)).Edge())
            arc = GC_MakeArcOfCircle(at(first), at(middle), at(last)).Value()
            made.Add(BRepBuilderAPI_MakeEdge(arc).Edge())
            start = last
        return made.Wire()


def section(rng: np.random.Generator, wide: float) -> tuple[str, float, float, object]:
    """Commands of a section around the start, its area, the x of its centroid, and its face."""
    if rng.random() < 0.5:
        r = round(float(rng.uniform(0.3, 0.8)) * wide, 2)
        circle = gp_Circ(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), r)
        wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire()
        face = BRepBuilderAPI_MakeFace(wire).Face()
        return f"CIRCLE DIAMETER {2 * r!r} AT 0 0\n", math.pi * r * r, 0.0, face
    a, b = (round(float(x) * wide, 2) for x in rng.uniform(0.4, 1.0, 2))
    p, q = (round(float(x) * wide, 2) for x in rng.uniform(-0.9, 0.0, 2))
    polygon = BRepBuilderAPI_MakePolygon()
    for x, y in [(p, q), (p + a, q), (p + a, q + b), (p, q + b)]:
        polygon.Add(gp_Pnt(x, y, 0))
    polygon.Close()
    face = BRepBuilderAPI_MakeFace(polygon.Wire()).Face()
    return f"RECTANGLE {a!r} {b!r} AT {p!r} {q!r}\n", a * b, p + a / 2, face


@pytest.mark.parametrize("seed", range(300 if SOAK else 6))
def test_pipes_are_those_of_pappus_and_occt(seed: int, tmp_path) -> None:
    rng = np.random.default_rng(4600 + seed)
    wide = float(round(rng.uniform(2, 8), 1))
    way = Way(rng, wide)
    text, area, centre, face = section(rng, wide)
    sketch = Sketch()
    sketch.run(f"SKETCH S 2D XY\nSET UNITS MM\n{text}{way.text()}SWEEP S ALONG WAY INTO PIPE")
    # Turns to the right are about axes at larger x: the way of the centroid is shorter there.
    side = 1.0 if way.points[2][0] > 0 else -1.0
    length = way.length - side * centre * float(way.turns.sum())
    assert sketch.volume == pytest.approx(area * length, rel=1e-9)
    assert sketch.objects["PIPE"]["area"] is not None
    volume, surface = measures(BRepOffsetAPI_MakePipe(way.wire(), face).Shape())
    assert sketch.volume == pytest.approx(volume, rel=1e-6)
    assert sketch.area == pytest.approx(surface, rel=1e-6)
    (tmp_path / "pipe.step").write_bytes(sketch.run("EXPORT STEP PIPE pipe.step")[-1].file[1])
    assert occt_volume(tmp_path / "pipe.step") == pytest.approx(sketch.volume, rel=1e-7)
    # A change of the path, and a bar through the first side.
    sketch.run(f"USING WAY; SET A0.R {2 * wide!r}", strict=False)
    sketch.run(
        f"SKETCH BAR 2D XZ\nCIRCLE DIAMETER {0.2 * wide!r} AT {centre!r} {2 * wide!r}\n"
        f"EXTRUDE BAR {6 * wide!r}\nMOVE BAR 0 {-3 * wide!r} 0\nCUT PIPE BAR INTO DRILLED"
    )
    assert sketch.objects["DRILLED"]["volume"] < sketch.objects["PIPE"]["volume"]


@pytest.mark.parametrize("seed", range(100 if SOAK else 3))
def test_mitred_frames(seed: int, tmp_path) -> None:
    rng = np.random.default_rng(4700 + seed)
    width, height = (float(x) for x in rng.integers(40, 90, 2))
    a, b = (float(x) for x in rng.integers(2, 9, 2))
    p = float(rng.integers(-4, 2))
    sketch = Sketch()
    sketch.run(
        f"SKETCH S 2D YZ\nSET UNITS MM\nRECTANGLE {a} {b} AT {p} 0\nSKETCH WAY 2D XY\n"
        f"SET UNITS MM\nRECTANGLE {width} {height} AT {-width / 3!r} 0\nSWEEP S ALONG WAY INTO F"
    )
    for _ in range(2):
        # The frame between two rectangles: the first side is at y = 0, the inside above it.
        outer = (width - 2 * p) * (height - 2 * p)
        inner = (width - 2 * p - 2 * a) * (height - 2 * p - 2 * a)
        assert sketch.objects["F"]["volume"] == pytest.approx((outer - inner) * b, rel=1e-10)
        (tmp_path / "f.step").write_bytes(sketch.run("EXPORT STEP F f.step")[-1].file[1])
        assert occt_volume(tmp_path / "f.step") == pytest.approx((outer - inner) * b, rel=1e-9)
        width += 7.0
        sketch.run(f"USING WAY; SET WIDTH1 {width!r}")
