"""TEXT: letters as sections and solids, against Green's formula, quadrature and OCCT."""

from __future__ import annotations

import math
import os
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("fontTools")
pytest.importorskip("OCP")

from fontTools.pens.recordingPen import RecordingPen

import moldloft
from moldloft import Sketch, SketchError
from sketch_ordinary import measures, read_step
from small_font import ADVANCES, CAPITAL, KERN, draw, glyph_area, small_font

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

#: OCCT's edges between round faces are splines within 1e-7.
BOUND = 1e-7


@pytest.fixture(params=[False, True], ids=["quadratic", "cubic"])
def cubic(request: Any) -> bool:
    return bool(request.param)


@pytest.fixture
def font(tmp_path: Path, cubic: bool) -> Path:
    return small_font(tmp_path / f"letters.{'otf' if cubic else 'ttf'}", cubic)


def area(text: str, cubic: bool) -> float:
    return sum(glyph_area(c, cubic) for c in text if c != " ")


def integral(name: str, cubic: bool, over: Callable[[Any], Any], size: float) -> float:
    """The integral of a function of y over a glyph of a size that is centred on y = 0."""
    pen = RecordingPen()
    draw(name, pen, cubic)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    t, total, here = 0.5 * (nodes + 1), 0.0, np.zeros(2)
    for word, given in pen.value:
        points = [np.array(p) / CAPITAL * size for p in given]
        if word == "moveTo":
            here = points[0]
        elif points:
            hull = [here, *points]
            n = len(hull) - 1
            basis = [math.comb(n, k) * t**k * (1 - t) ** (n - k) for k in range(n + 1)]
            rate = [n * math.comb(n - 1, k) * t**k * (1 - t) ** (n - 1 - k) for k in range(n)]
            x, y = (sum(b * p[i] for b, p in zip(basis, hull, strict=True)) for i in (0, 1))
            dy = sum(r * (hull[k + 1][1] - hull[k][1]) for k, r in enumerate(rate))
            total += 0.5 * float(np.sum(weights * x * over(y - size / 2) * dy))
            here = points[-1]
    return abs(total)


def step_of(sketch: Sketch, name: str, path: Path) -> Any:
    file = sketch.run(f"EXPORT STEP {name} part.step")[-1].file
    assert file is not None
    path.write_bytes(file[1])
    return read_step(path)


def test_sections_have_the_areas_of_their_letters(font: Path, cubic: bool) -> None:
    s = Sketch()
    s.run(f'TEXT L "HO i" "OH" FONT "{font}" SIZE 7 AT 3 4 ANGLE 30 CENTRE MIDDLE')
    assert s.area == pytest.approx(49 * area("HOiOH", cubic), rel=1e-12)
    s.run("SET L.SIZE1 2.5")
    assert s.objects["L"]["area"] == pytest.approx(6.25 * area("HOiOH", cubic), rel=1e-12)


def test_embossed_and_engraved_plates(font: Path, cubic: bool, tmp_path: Path) -> None:
    """Volumes, those of the STEP files in OCCT, and the boundary's own agree."""
    choose = random.Random(f"text {cubic}")
    for _ in range(100 if SOAK else 2):
        size, turn, deep = choose.uniform(4, 9), choose.uniform(-40, 40), choose.uniform(0.5, 4)
        text = choose.choice(["HO i", "OV", "iH"])
        s = Sketch()
        s.run("SKETCH PLATE 2D XY; SET UNITS MM; RECTANGLE 90 60; EXTRUDE PLATE 5")
        s.run(f'TEXT L "{text}" FONT "{font}" SIZE {size!r} AT 45 30 ANGLE {turn!r} CENTRE')
        for word, sign in (("UNION", 1), ("CUT", -1)):
            s.run(f"EXTRUDE L {sign * deep!r} INTO T; MOVE T ON PLATE TOP Z INTO T{word}")
            s.run(f"{word} PLATE T{word} INTO P{word}")
            found = s.objects[f"P{word}"]
            letters = size**2 * area(text, cubic)
            assert found["volume"] == pytest.approx(27000 + sign * deep * letters, rel=1e-12)
            volume, surface = measures(step_of(s, f"P{word}", tmp_path / "p.step"))
            assert volume == pytest.approx(found["volume"], rel=BOUND)
            assert surface == pytest.approx(found["area"], rel=10 * BOUND)


def test_letters_on_a_round_bar(font: Path, cubic: bool, tmp_path: Path) -> None:
    """Walls over curves meet a cylinder in splines."""
    s = Sketch()
    s.run("SKETCH BAR 2D YZ; SET UNITS MM; CIRCLE DIAMETER 40 AT 0 0; EXTRUDE BAR 60")
    s.run(f'TEXT L "O" FONT "{font}" SIZE 8 AT 30 0 CENTRE MIDDLE; EXTRUDE L 9 INTO T')
    s.run("MOVE T 0 0 15; CUT BAR T INTO P")
    removed = integral("O", cubic, lambda y: np.sqrt(400 - y * y) - 15, 8.0)
    exact = math.pi * 400 * 60 - removed
    assert s.objects["P"]["volume"] == pytest.approx(exact, rel=1e-10)
    volume, _ = measures(step_of(s, "P", tmp_path / "p.step"))
    assert volume == pytest.approx(exact, rel=BOUND)


def test_other_extruded_curves_are_written_exactly(tmp_path: Path) -> None:
    """Walls over a parabola and over a quarter of an ellipse."""
    s = Sketch()
    s.run("SKETCH P 2D XY; SET UNITS MM; POINT 1 0 0; POINT 2 90 0; POINT 3 45 80")
    s.run(
        "LINE 1 2 TYPE X; LINE 2 3 TYPE F; LINE 3 1 TYPE F; DIM X 1 2 9; DIM X 1 3 4; DIM Y 1 3 6"
    )
    s.run("QUADRATIC Q LINES 2 3; GENERATE FACES; EXTRUDE 5")
    s.run("SKETCH E 2D XY; SET UNITS MM; RECTANGLE 9 6; ELLIPSE A ARC CORNER 3 2 4 SEMI 4 5")
    s.run("GENERATE FACES; EXTRUDE 5")
    for name in "PE":
        found = s.objects[name]
        volume, surface = measures(step_of(s, name, tmp_path / "p.step"))
        assert volume == pytest.approx(found["volume"], rel=1e-9)
        assert surface == pytest.approx(found["area"], rel=1e-9)


def test_numbers_have_derivatives(font: Path, cubic: bool) -> None:
    s = Sketch()
    s.run(f'TEXT L "HO" FONT "{font}" SIZE 7 AT 3 4; EXTRUDE L 2 INTO T; USING T')
    gradient = s.gradient(["L.SIZE1", "L.TEXTP1", "L.TURN1"])
    assert gradient.volume == pytest.approx([2 * 2 * 7 * area("HO", cubic), 0, 0], abs=1e-9)
    assert gradient.centroid[1] == pytest.approx([1, 0, 0], abs=1e-12)
    turn = math.radians(1)
    x, y, _ = s.centroid if s.centroid is not None else (0.0, 0.0, 0.0)
    assert gradient.centroid[2] == pytest.approx([-(y - 4) * turn, (x - 3) * turn, 0], abs=1e-12)


def test_sketches_are_saved_with_their_texts(font: Path, tmp_path: Path) -> None:
    s = Sketch()
    place = "SIZE 3 AT 1 2 ANGLE 5 RIGHT TOP PLANE XZ MIRRORED"
    s.run(f'TEXT L "H i" "O" FONT "{font.name}" {place}'.replace(font.name, str(font)))
    saved = s.run("SAVE L AS all.skt")[-1].file
    assert saved is not None
    (tmp_path / "all.skt").write_bytes(saved[1].replace(str(font).encode(), font.name.encode()))
    other = Sketch.load(tmp_path / "all.skt")
    assert other.objects["L"]["area"] == s.objects["L"]["area"]
    assert other.objects["L"]["centroid"] == s.objects["L"]["centroid"]
    # In a program the font is read as other files are.
    (tmp_path / "m.sdl").write_text('load "all.skt"; param float x = 1;')
    assert not [d for d in moldloft.load(tmp_path / "m.sdl").diagnostics if d.severity == "error"]


def test_refusals_name_the_character_and_the_font(font: Path) -> None:
    s = Sketch()
    for command, words in [
        (f'TEXT L "HB" FONT "{font}"', "no glyph of 'B'"),
        (f'TEXT L "  " FONT "{font}"', "nothing of the text is visible"),
        (f'TEXT L "HI" FONT "{font}" BOLD', "the end of the command"),
        ('TEXT L "H" FONT "no such font"', "no font of that name is installed"),
        ('TEXT L "H" FONT missing.ttf', "missing.ttf cannot be read"),
        (f'TEXT L "H" FONT "{font}" SIZE 0', "no height"),
        (f'TEXT L FONT "{font}"', "expected a text in quotation marks"),
        (f'TEXT L "H" "{font}"', "expected FONT"),
    ]:
        with pytest.raises(SketchError, match=words):
            s.run(command)
    assert "L" not in s.objects


def test_a_font_of_the_system_by_its_name() -> None:
    """The first that is found; a machine without fonts has none."""
    found = sorted(Path("/usr/share/fonts").rglob("DejaVuSans.ttf"))
    if not found:
        pytest.skip("no such font here")
    areas = []
    for name in ("DejaVu Sans", str(found[0])):
        s = Sketch()
        s.run(f'TEXT L "Rs8" FONT "{name}" SIZE 5')
        areas.append(s.area)
    assert areas[0] == areas[1]


def test_outlines_in_a_program(font: Path, cubic: bool, tmp_path: Path) -> None:
    """Letters of straight sides are exact sets; a ring is one face inside and one outside."""
    (tmp_path / "m.sdl").write_text(
        "param float size = 7 in [1, 20];\n"
        f'set s = extruded_region(text_outlines("HV", "{font.name}", size = size), {{0, 0, 2}});\n'
        f'set a = extruded(text_outlines("H", "{font.name}", 7, "right")[1], {{0, 0, 2}});\n'
        f'set o = extruded_region(text_outlines("O", "{font.name}", 7), {{0, 0, 2}});\n'
        "SetBody ring(o, {0, -1, -1}, {8, 8, 3}, depth = 6);\n"
    )
    model = moldloft.load(tmp_path / "m.sdl")
    exact = 98 * area("HV", cubic)
    assert model.eval("volume(s)") == pytest.approx(exact, rel=1e-9)
    model["size"] = 3.5
    assert model.eval("volume(s)") == pytest.approx(exact / 4, rel=1e-9)
    assert model.eval("volume(a)") == pytest.approx(98 * area("H", cubic), rel=1e-9)
    assert model.eval("ring.volume") == pytest.approx(98 * area("O", cubic), rel=1e-2)
    assert ADVANCES["A"] + KERN + ADVANCES["V"] == 1200
