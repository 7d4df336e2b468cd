"""Derivatives of bodies on a grid, where faces, edges and corners of the pieces meet by chance.

A body there has often two derivatives by a number, one on each side. Both are found by differences
on their side: where they agree, the derivative is theirs; where not, it is refused with the place.
A few here; with MOLDLOFT_SOAK=1 two thousand bodies.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import moldloft
from moldloft import Sketch, SketchError
from sketch_parts import BOX_LINES, corners, drawing

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
BODIES = 2000 if SOAK else 60

STEP = 1e-3

#: The numbers of the pieces, but those that follow from them.
NUMBERS = {"A", "B", "C", "D", "H", "R", "W", "MX", "MY", "MZ"}


def box(rng: np.random.Generator, name: str) -> str:
    """A box of whole sizes."""
    w, d, h = (int(x) for x in rng.integers(2, 5, 3))
    text = drawing(rng, name, corners((0, 0, 0), (w, d, h)), BOX_LINES)
    return f"{text}\nDIM W X 1 2 {w}\nDIM D Y 1 4 {d}\nDIM H Z 1 5 {h}\nGENERATE FACES"


def wedge(rng: np.random.Generator, name: str) -> str:
    """A prism over a right triangle."""
    a, b, d = (int(x) for x in rng.integers(2, 5, 3))
    points = [(x, y, z) for y in (0.0, d) for x, z in ((0.0, 0.0), (a, 0.0), (0.0, b))]
    lines = [(1, 2), (2, 3), (3, 1), (4, 5), (5, 6), (6, 4), (1, 4), (2, 5), (3, 6)]
    text = drawing(rng, name, points, lines)
    return f"{text}\nDIM A X 1 2 {a}\nDIM B Z 1 3 {b}\nDIM D Y 1 4 {d}\nGENERATE FACES"


def corner(rng: np.random.Generator, name: str) -> str:
    """A tetrahedron with three square edges."""
    a, b, c = (int(x) for x in rng.integers(2, 6, 3))
    points = [(0.0, 0.0, 0.0), (a, 0.0, 0.0), (0.0, b, 0.0), (0.0, 0.0, c)]
    lines = [(1, 2), (1, 3), (1, 4), (2, 3), (2, 4), (3, 4)]
    text = drawing(rng, name, points, lines)
    return f"{text}\nDIM A X 1 2 {a}\nDIM B Y 1 3 {b}\nDIM C Z 1 4 {c}\nGENERATE FACES"


def bar(rng: np.random.Generator, name: str) -> str:
    """A round bar along z."""
    r, h = int(rng.integers(1, 3)), int(rng.integers(2, 6))
    text = drawing(rng, name, corners((0, 0, 0), (2 * r, 2 * r, h)), BOX_LINES)
    dims = f'VARIABLE R {r}\nDIM X 1 2 "2*R"\nDIM Y 1 4 "2*R"\nDIM H Z 1 5 {h}'
    return f"{text}\n{dims}\nCIRCLE C1 CORNER 1 2 4\nCIRCLE C2 CORNER 5 6 8\nGENERATE FACES"


def body(rng: np.random.Generator, *, curved: bool) -> tuple[Sketch, str] | None:
    """Two or three pieces at whole places, combined; None where that is refused or empty."""
    kinds = [box, wedge, corner, *([bar] if curved else [])]
    count = int(rng.integers(2, 4))
    text, name = [], "P0"
    for k in range(count):
        make = bar if curved and k == 1 else kinds[int(rng.integers(len(kinds)))]
        text.append(make(rng, f"P{k}"))
        if k:
            at = [int(x) for x in rng.integers(-2, 4, 3)]
            text += [f"VARIABLE M{n} {x}" for n, x in zip("XYZ", at, strict=True)]
            text.append(f"MOVE P{k} MX MY MZ FEATURE")
            text.append(f"{rng.choice(['UNION', 'CUT', 'COMMON'])} {name} P{k} INTO U{k}")
            name = f"U{k}"
    sketch = Sketch()
    try:
        sketch.run("\n".join(text))
        sketch.run(f"USING {name}")
    except SketchError:
        return None
    return None if sketch.volume is None else (sketch, name)


def sides(sketch: Sketch, name: str, step: float = STEP) -> tuple[np.ndarray, np.ndarray] | None:
    """The derivatives of volume, area and centroid from below and from above."""
    x = sketch[name]
    rows = sketch.sweep(name, x + step * np.array([-4, -3, -2, -1, 0, 1, 2, 3, 4]))
    if np.isnan(rows).any():
        return None
    weights = np.array([-25, 48, -36, 16, -3]) / (12 * step)
    return -(weights @ rows[4::-1]), weights @ rows[4:]


@pytest.mark.parametrize("curved", [False, True], ids=["plane", "round"])
def test_derivatives_on_a_grid(curved):
    compared = one_sided = refused = bodies = 0
    # A round body takes thirty times as long.
    for seed in range(BODIES // 15 if curved and not SOAK else BODIES):
        rng = np.random.default_rng([seed, 77, int(curved)])
        made = body(rng, curved=curved)
        if made is None:
            continue
        sketch, _ = made
        names = [n for n in sketch.dimensions if n.split(".")[-1] in NUMBERS]
        chosen = [str(n) for n in rng.permutation(names)[:3]]
        gradient = sketch.gradient(chosen)
        bodies += 1
        for k, name in enumerate(chosen):
            found = sides(sketch, name)
            if found is None:
                continue
            below, above = found
            got = np.array([gradient.volume[k], gradient.area[k], *gradient.centroid[k]])
            # The area alone has two where an edge leaves a face.
            for part in (slice(1, 2), slice(0, 1), slice(2, 5)):
                b, a, g = below[part], above[part], got[part]
                size = max(1.0, np.abs(b).max(), np.abs(a).max())
                apart = np.abs(a - b).max() / size
                what = (seed, name, g, b, a, gradient.kinks[k])
                if np.isnan(g).any():
                    assert gradient.kinks[k], what
                    if apart < 1e-6:
                        refused += 1
                    else:
                        one_sided += 1
                elif apart < 1e-5:
                    assert np.abs(g - (a + b) / 2).max() < 1e-5 * size, what
                    compared += 1
                else:
                    # Where a round face begins to be cut differences come to the derivative as the
                    # root of their step; two derivatives stay apart.
                    nearer = sides(sketch, name, STEP / 100)
                    assert curved, what
                    if nearer is None:
                        continue
                    b, a = nearer[0][part], nearer[1][part]
                    assert np.abs(a - b).max() / size < 0.2 * apart, (what, b, a)
                    assert np.abs(g - (a + b) / 2).max() < 0.2 * apart * size, (what, b, a)
    print(bodies, compared, one_sided, refused)
    assert compared > 3 * bodies
    # What is refused has two derivatives but for a few.
    assert refused <= 0.05 * compared


def test_a_corner_of_four_planes_by_chance():
    # A corner of a box cut off through three others of its vertices: the volume is smooth there.
    sketch = Sketch()
    rng = np.random.default_rng(0)
    box_text = drawing(rng, "A", corners((0, 0, 0), (4, 4, 4)), BOX_LINES)
    sketch.run(f"{box_text}\nDIM W X 1 2 4\nDIM D Y 1 4 4\nDIM H Z 1 5 4\nGENERATE FACES")
    points = [(0.0, 0.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0), (0.0, 0.0, 4.0)]
    text = drawing(rng, "B", points, [(1, 2), (1, 3), (1, 4), (2, 3), (2, 4), (3, 4)])
    sketch.run(f'{text}\nVARIABLE T 4\nDIM X 1 2 "T"\nDIM Y 1 3 "T"\nDIM Z 1 4 "T"\nGENERATE FACES')
    sketch.run("CUT A B INTO U; USING U")
    gradient = sketch.gradient(["A.W", "B.T"])
    assert gradient.volume == pytest.approx([16, -8], rel=1e-12)
    # Three faces lose T²/2 each, and an equilateral triangle comes.
    assert gradient.area == pytest.approx([16, 4 * np.sqrt(3) - 12], rel=1e-12)
    assert gradient.kinks == (None, None)


def one_on_another() -> Sketch:
    """Two cubes of 4, B on A."""
    sketch = Sketch()
    rng = np.random.default_rng(0)
    for name in "AB":
        text = drawing(rng, name, corners((0, 0, 0), (4, 4, 4)), BOX_LINES)
        sketch.run(f"{text}\nDIM W X 1 2 4\nDIM D Y 1 4 4\nDIM H Z 1 5 4\nGENERATE FACES")
    sketch.run("VARIABLE MZ 4; MOVE B 0 0 MZ FEATURE; UNION A B INTO U; USING U")
    return sketch


def test_a_body_on_another_one_has_two_derivatives():
    sketch = one_on_another()
    gradient = sketch.gradient(["MZ", "A.W", "H"])
    assert np.isnan(gradient.volume[0]) and gradient.kinks[0].startswith(
        "faces lie in each other at"
    )
    # The sides are in one plane: the area alone has two derivatives, by the step that comes.
    assert gradient.volume[1:] == pytest.approx([16, 16], rel=1e-12)
    assert np.isnan(gradient.area[1]) and "an edge lies in another face" in gradient.kinks[1]
    assert gradient.kinks[2] is None


def test_a_model_refuses_a_derivative_that_does_not_exist(tmp_path: Path) -> None:
    sketch = one_on_another()
    sketch.save(tmp_path / "two.skt")
    (tmp_path / "two.sdl").write_text('load "two.skt";')
    model = moldloft.load(tmp_path / "two.sdl")
    assert model.eval("U.volume") == pytest.approx(128, rel=1e-12)
    with pytest.raises(moldloft.Error, match=r"no-derivative.*`U.volume` has no derivative here"):
        model.derivatives(["U.volume"], ["B.MZ"])
