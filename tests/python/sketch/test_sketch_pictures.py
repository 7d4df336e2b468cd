"""Pictures that show what the text says, or something else: the text decides.

Blocks with holes, pockets, bosses and cavities, against sums of boxes. The boxes stand anywhere on
the page, the proportions are wrong, dimensions run up or down, from any point whose place is known,
in any order.
A few here; with MOLDLOFT_SOAK=1 a thousand drawings and cavities at five hundred places.
"""

from __future__ import annotations

import os

import numpy as np
import pytest

from moldloft import Sketch
from sketch_parts import BOX_LINES, corners, drawing

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
DRAWINGS = 1000 if SOAK else 40
PLACES = 500 if SOAK else 25

Box = tuple[tuple[float, float, float], tuple[float, float, float]]


def features(rng: np.random.Generator) -> tuple[Box, list[tuple[str, Box]]]:
    """A block and one to three things in it or on it, beside each other."""
    count = int(rng.integers(1, 4))
    size = tuple(float(x) for x in rng.integers((5 * count, 6, 5), (7 * count + 1, 14, 11)))
    out = []
    for k in range(count):
        kind = str(rng.choice(["hole", "pocket", "boss", "cavity"]))
        wide = size[0] / count
        x = np.sort(rng.choice(np.arange(1, 4 * wide - 1), 2, replace=False)) / 4 + k * wide
        y = np.sort(rng.choice(np.arange(1, 4 * size[1] - 1), 2, replace=False)) / 4
        z = np.sort(rng.choice(np.arange(1, 4 * size[2] - 1), 2, replace=False)) / 4
        low, high = {
            "hole": (0.0, size[2]),
            "pocket": (z[0], size[2]),
            "boss": (size[2], size[2] + z[0]),
            "cavity": (z[0], z[1]),
        }[kind]
        box = (float(x[0]), float(y[0]), float(low)), (float(x[1]), float(y[1]), float(high))
        out.append((kind, box))
    return ((0.0, 0.0, 0.0), size), out


def measures(block: Box, inner: list[tuple[str, Box]]) -> tuple[float, np.ndarray]:
    """Volume and centroid."""
    boxes = np.array([block, *(b for _, b in inner)])
    signs = np.array([1.0, *(1.0 if kind == "boss" else -1.0 for kind, _ in inner)])
    volumes = signs * np.prod(boxes[:, 1] - boxes[:, 0], axis=1)
    return volumes.sum(), volumes @ boxes.mean(axis=1) / volumes.sum()


def text_of(rng: np.random.Generator, block: Box, inner: list[tuple[str, Box]]) -> str:
    """A drawing of it whose picture has other places and proportions than its dimensions."""
    points: list[tuple[float, float, float]] = []
    lines: list[tuple[int, int]] = []
    for box in (block, *(b for _, b in inner)):
        lines += [(a + len(points), b + len(points)) for a, b in BOX_LINES]
        points += corners(*box)
    # What is drawn: every box stretched and somewhere.
    shown = np.array(points)
    relation = str(rng.choice(["true", "stretched", "anywhere"]))
    if relation != "true":
        shown *= rng.uniform(0.4, 2.5, 3)
    if relation == "anywhere":
        for k in range(1, len(inner) + 1):
            shown[8 * k : 8 * k + 8] += rng.uniform(-8, 8, 3)
    text = drawing(rng, "A", [tuple(map(float, p)) for p in shown], lines)
    dims = []
    for axis, letter in enumerate("XYZ"):
        # Planes by box: points 1 to 8 of it, low and high.
        known = [1]
        todo = [(k, side) for k in range(len(inner) + 1) for side in (0, 1) if (k, side) != (0, 0)]
        at = np.array(points)[:, axis]
        members = {
            (k, side): [
                8 * k + j + 1
                for j in range(8)
                if at[8 * k + j] == (block, *(b for _, b in inner))[k][side][axis]
            ]
            for k in range(len(inner) + 1)
            for side in (0, 1)
        }
        known = list(members[0, 0])
        for k in rng.permutation(len(todo)):
            plane = members[todo[k]]
            p, q = int(rng.choice(known)), int(rng.choice(plane))
            known += plane
            way = float(at[q - 1] - at[p - 1])
            if rng.integers(2):
                p, q, way = q, p, -way
            if way == 0 and rng.integers(2):
                dims.append(f"ALIGN {letter} {p} {q}")
            else:
                dims.append(f"DIM {letter} {p} TO {q} = {way}")
    order = rng.permutation(len(dims))
    return "\n".join([text, *(dims[k] for k in order), "GENERATE FACES"])


@pytest.mark.parametrize("share", range(4))
def test_drawings_whose_picture_shows_something_else(share):
    for seed in range(share, DRAWINGS, 4):
        rng = np.random.default_rng([seed, 20])
        block, inner = features(rng)
        volume, centroid = measures(block, inner)
        sketch = Sketch()
        sketch.run(text_of(rng, block, inner))
        assert sketch.volume == pytest.approx(volume, rel=1e-12), (seed, inner)
        assert np.allclose(sketch.centroid, centroid, rtol=0, atol=1e-11), (seed, inner)


def test_a_cavity_at_any_place_of_the_page():
    block: Box = (0.0, 0.0, 0.0), (12.0, 6.0, 6.0)
    inner: list[tuple[str, Box]] = [("cavity", ((8.0, 2.0, 1.0), (10.0, 3.5, 4.0)))]
    rng = np.random.default_rng(25)
    text = text_of(np.random.default_rng(0), block, inner).splitlines()
    for _ in range(PLACES):
        du, dv = rng.uniform(-300, 300, 2)
        moved = []
        for line in text:
            words = line.split()
            if words[0] == "POINT" and int(words[1]) > 8:
                line = f"POINT {words[1]} AT {float(words[3]) + du} {float(words[4]) + dv}"
            moved.append(line)
        sketch = Sketch()
        sketch.run("\n".join(moved))
        assert sketch.volume == pytest.approx(423, rel=1e-12), (du, dv)
