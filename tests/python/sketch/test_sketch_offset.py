"""OFFSET of random outlines against shapely, and the bodies made of them against OCCT on the STEP.

A few here; with MOLDLOFT_SOAK=1 the whole.
"""

from __future__ import annotations

import itertools
import math
import os
from typing import Any

import numpy as np
import pytest

from moldloft import Sketch
from test_sketch_holes import occt_volume

shapely = pytest.importorskip("shapely")

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

#: Chords of a quarter of an arc of shapely, and of a round corner.
CHORDS = 256

#: The relative error of the area of such an arc is 6e-6, of outlines less.
BOUND = 5e-6

Corners = list[tuple[float, float]]


def star(rng: np.random.Generator, grid: bool) -> Corners:
    """A polygon around the origin, with reflex corners."""
    n = int(rng.integers(5, 12))
    turns = np.sort(rng.uniform(0, 0.7, n) + np.arange(n)) * 2 * math.pi / n
    points = rng.uniform(15, 50, n)[:, None] * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    return [tuple(p) for p in (np.round(points) if grid else np.round(points, 3)).tolist()]


def comb(rng: np.random.Generator, grid: bool) -> Corners:
    """A bar with teeth of random gaps and heights."""
    size = (
        (lambda a, b: float(rng.integers(a, b)))
        if grid
        else (lambda a, b: float(rng.uniform(a, b)))
    )
    x, up = 0.0, []
    for _ in range(int(rng.integers(2, 5))):
        width, gap, height = size(3, 12), size(2, 9), size(8, 30)
        up += [(x, height), (x + width, height), (x + width, 6.0), (x + width + gap, 6.0)]
        x += width + gap
    return [(0.0, 0.0), (x, 0.0), *reversed(up)]


def rounded(corners: Corners, k: int, radius: float) -> Corners:
    """A polygon with one corner replaced by points of its arc."""
    at = np.array(corners[k])
    sides = [np.array(corners[k - 1]) - at, np.array(corners[(k + 1) % len(corners)]) - at]
    a, b = (s / np.hypot(*s) for s in sides)
    half = math.acos(np.clip(a @ b, -1, 1)) / 2
    centre = at + (a + b) / np.hypot(*(a + b)) * radius / math.sin(half)
    first, last = (at + s * radius / math.tan(half) - centre for s in (a, b))
    turn = math.atan2(first[0] * last[1] - first[1] * last[0], first @ last)
    angles = math.atan2(first[1], first[0]) + turn * np.linspace(0, 1, CHORDS)
    arc = centre + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return [*corners[:k], *map(tuple, arc.tolist()), *corners[k + 1 :]]


def buffered(outline: Any, by: float, style: str) -> Any:
    """The offset by its definition: a buffer of a whole outline drops points of inner arcs."""
    if style == "mitre":
        return outline.buffer(by, join_style=style, mitre_limit=1e9)
    ring = list(outline.exterior.coords)
    sides = [shapely.LineString(pair) for pair in itertools.pairwise(ring)]
    margin = shapely.unary_union([side.buffer(abs(by), quad_segs=CHORDS) for side in sides])
    return outline.union(margin) if by > 0 else outline.difference(margin)


def drawn(corners: Corners) -> str:
    """The section of a polygon, as drawn."""
    ids = " ".join(str(k + 1) for k in range(len(corners)))
    points = "".join(f"POINT {k + 1} {u!r} {v!r}\n" for k, (u, v) in enumerate(corners))
    x, y = corners[0]
    text = f"SKETCH P 2D XY\nSET EXACT ON\nSET UNITS MM\n{points}POLYLINE {ids} CLOSE\n"
    return f"{text}REFERENCE 1 {x!r} {y!r} 0\nACCEPT ALL\n"


@pytest.mark.parametrize("seed", range(600 if SOAK else 12))
def test_random_outlines_are_those_of_shapely(seed: int) -> None:
    rng = np.random.default_rng(4400 + seed)
    corners = (star if seed % 2 else comb)(rng, seed % 4 < 2)
    outline = shapely.Polygon(corners)
    if not outline.is_valid or outline.area < 100:
        pytest.skip("no simple polygon")
    text, polygon = drawn(corners), corners
    if seed % 3 == 0:
        k = int(rng.integers(len(corners)))
        ends = [math.dist(corners[k], corners[(k + s) % len(corners)]) for s in (-1, 1)]
        radius = round(0.2 * min(ends), 2)
        text += f"ARC C CORNER {k + 1} RADIUS {radius!r}\n"
        polygon = rounded(corners, k, radius)
        straight = all(
            (b[0] - a[0]) * (c[1] - b[1]) == (b[1] - a[1]) * (c[0] - b[0])
            for a, b, c in [[corners[(k + s) % len(corners)] for s in (-1, 0, 1)]]
        )
        if straight or not shapely.Polygon(polygon).is_valid:
            pytest.skip("no round corner")
    outline = shapely.Polygon(polygon)
    sketch = Sketch()
    sketch.run(text + "GENERATE FACES")
    assert sketch.objects["P"]["area"] == pytest.approx(outline.area, rel=BOUND)
    for by in [
        float(rng.integers(1, 9)),
        -float(rng.integers(1, 4)),
        *rng.uniform(-4, 9, 2).tolist(),
    ]:
        for corner, style in (("ROUND", "round"), ("MITRED", "mitre")):
            if style == "mitre" and polygon is not corners:
                continue
            made = buffered(outline, by, style)
            if style == "mitre" and by > 0 and len(made.interiors):
                continue  # Their corners in closed gaps are no offsets.
            replies = sketch.run(f"OFFSET P {by!r} {corner} INTO Q", strict=False)
            if made.is_empty:
                assert "leaves nothing" in str(replies[-1]), (by, corner)
                continue
            assert "area" in str(replies[-1]), (by, corner, text, str(replies[-1]))
            found = sketch.objects["Q"]["area"]
            bound = (1e-9 if style == "mitre" else BOUND) * max(outline.area, made.area)
            assert found == pytest.approx(made.area, abs=bound), (by, corner, text)


@pytest.mark.parametrize("seed", range(60 if SOAK else 2))
def test_rims_of_plates_agree_with_occt(seed: int, tmp_path) -> None:
    rng = np.random.default_rng(4500 + seed)
    width, height = int(rng.integers(60, 100)), int(rng.integers(40, 60))
    bore, wall, tall = int(rng.integers(8, 16)), int(rng.integers(1, 4)), int(rng.integers(5, 30))
    corners = "ROUND" if seed % 2 else "MITRED"
    sketch = Sketch()
    sketch.run(
        f"SKETCH P 2D XZ\nSET UNITS MM\nVARIABLE WALL {wall}\nRECTANGLE {width} {height}\n"
        f"CIRCLE DIAMETER {bore} AT 20 20\nSLOT 20 8 AT 30 10\nOFFSET P WALL {corners} INTO Q\n"
        f"EXTRUDE Q {tall} INTO B\nEXTRUDE P {tall} INTO A\nCUT B A INTO RIM"
    )
    for t in (wall, wall + 0.5, 0.75):
        sketch.run(f"USING P; SET WALL {t!r}; USING RIM")
        corner = math.pi * t * t if seed % 2 else 4 * t * t
        outer = 2 * (width + height) * t + corner
        ring = math.pi * ((bore / 2) ** 2 - (bore / 2 - t) ** 2)
        slot = 12 * 2 * t + math.pi * (16 - (4 - t) ** 2)
        assert sketch.volume == pytest.approx((outer + ring + slot) * tall, rel=1e-10)
        step = sketch.run("EXPORT STEP RIM rim.step")[-1].file[1]
        (tmp_path / "rim.step").write_bytes(step)
        assert occt_volume(tmp_path / "rim.step") == pytest.approx(sketch.volume, rel=1e-7)


def test_the_largest_inward_distance_is_named() -> None:
    sketch = Sketch()
    sketch.run("SKETCH P 2D XY\nPOLYGON 3 20")
    refused = str(sketch.run("OFFSET P -6 INTO Q", strict=False)[-1])
    assert "an inward offset of 6 leaves nothing" in refused and "below 5" in refused
    sketch.run("OFFSET P -4.999 INTO Q")
    assert sketch.objects["Q"]["area"] == pytest.approx(3 * math.sqrt(3) * 0.001**2, rel=1e-6)
