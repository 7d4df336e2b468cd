"""A hundred ordinary models to STEP and IGES, judged by OCCT, and back through our reader.

Areas and volumes are by integrals of OCCT, and closed forms where there are any.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.random import Generator

import moldloft
import random_models

pytest.importorskip("OCP")

SKETCHES = Path(__file__).parents[3] / "examples" / "sketch"
#: The last has a face whose border goes through one line in several places.
SEEDS = [*range(104)] if os.environ.get("MOLDLOFT_SOAK") == "1" else [*range(8), 51]


@dataclass
class Drawn:
    """A model, and what is known of it."""

    model: moldloft.Model
    #: By formula, in cubic metres.
    volume: float | None = None
    area: float | None = None
    #: Its objects.
    names: tuple[str, ...] = ()


def family(make: Callable[..., random_models.Drawn]) -> Callable[[Generator, Path], Drawn]:
    """A family of closed models in metres."""

    def draw(rng: Generator, folder: Path) -> Drawn:
        return Drawn(moldloft.loads(make(rng).text))

    draw.__name__ = make.__name__
    return draw


def rounded_bar(rng: Generator, folder: Path) -> Drawn:
    """A bar with a rectangular section of rounded corners: lines, arcs, swept walls, two lids."""
    a, b, length = (float(x) for x in rng.uniform(0.5, 3, 3))
    r = float(rng.uniform(0.1, 0.45)) * 2 * min(a, b)
    text = 'Model info(units = "m t");'
    for name, s in (("top", 1.0), ("low", -1.0)):
        spots = {
            "a": (-a, 0.0), "b": (-a, s * (b - r)), "c": (-a + r, s * b), "d": (a - r, s * b),
            "e": (a, s * (b - r)), "f": (a, 0.0), "m": (-a + r, s * (b - r)),
            "n": (a - r, s * (b - r)),
        }  # fmt: skip
        for key, (y, z) in spots.items():
            # Both halves begin and end in the same points.
            label = key if key in "af" else name + key
            if name == "top" or key not in "af":
                text += f"AbsPoint {label}(0, {y!r}, {z!r});"
        text += f"""
            Line {name}1(a, {name}b); Arc {name}2({name}b, {name}m, {name}c, type = 2);
            Line {name}3({name}c, {name}d); Arc {name}4({name}d, {name}n, {name}e, type = 2);
            Line {name}5({name}e, f);
        """
        sides = ", ".join(f"{name}{k}" for k in range(1, 6))
        text += f"PolyCurve {name}({{{sides}}});"
    text += f"""
        AbsPoint o(0, 0, 0); AbsPoint q({length!r}, 0, 0); Line axis(o, q);
        AbsPoint far({length!r}, {-a!r}, 0); Line along(a, far);
        TranSurf upper(top, along, colour = 4); TranSurf lower(low, along, colour = 5);
        RuledSurf lid(top, low);
        CopyCurve top_far(top, o, q); CopyCurve low_far(low, o, q); RuledSurf end(top_far, low_far);
    """
    section = 4 * a * b - (4 - math.pi) * r * r
    round_ = 4 * (a + b) - (8 - 2 * math.pi) * r
    area = 2 * section + round_ * length
    return Drawn(moldloft.loads(text), section * length, area, ("upper", "lower", "lid", "end"))


def sharp_set(rng: Generator, folder: Path) -> Drawn:
    """A block less another and with a third, each with some of its faces anywhere."""
    # No corner is nearer to another than a quarter of the scale: a set's cells do not pass it over.
    scale = float(rng.uniform(0.8, 1.3))
    steps = np.array([rng.permutation(16)[:4] for _ in "xyz"])
    boxes = [
        (
            0.25 * scale * np.sort(steps[:, k : k + 2]).T[0],
            0.25 * scale * np.sort(steps[:, k : k + 2]).T[1],
        )
        for k in (0, 2)
    ]
    boxes.insert(0, (np.full(3, 0.625 * scale), np.array([4.125, 3.375, 2.875]) * scale))
    corner = [", ".join(f"{{{', '.join(map(repr, map(float, p)))}}}" for p in b) for b in boxes]
    text = f"""
        set block = cuboid({corner[0]}); set cut = cuboid({corner[1]});
        set more = cuboid({corner[2]});
        SetBody body((block - cut) | more, {{-1, -1, -1}}, {{6, 6, 6}}, depth = 7);
    """
    # Volume and area over the grid of all corners.
    cuts = [np.unique([p[k] for b in boxes for p in b]) for k in range(3)]
    middle = np.meshgrid(*[(c[1:] + c[:-1]) / 2 for c in cuts], indexing="ij")
    inside = [
        np.all([(b[0][k] < middle[k]) & (middle[k] < b[1][k]) for k in range(3)], axis=0)
        for b in boxes
    ]
    full = (inside[0] & ~inside[1]) | inside[2]
    steps = [np.diff(c) for c in cuts]
    sizes = steps[0][:, None, None] * steps[1][None, :, None] * steps[2][None, None, :]
    area = 0.0
    for k in range(3):
        faces = sizes / np.moveaxis(steps[k][:, None, None], 0, k)
        wide = [(0, 0)] * 3
        wide[k] = (1, 1)
        change = np.diff(np.pad(full, wide).astype(int), axis=k) != 0
        low = np.take(faces, [0], axis=k)
        area += float((change * low).sum())
    return Drawn(moldloft.loads(text), float(sizes[full].sum()), area)


def sketch(rng: Generator, folder: Path) -> Drawn:
    """The dam of the examples in other sizes."""
    text = (SKETCHES / "dam.skt").read_text(encoding="utf-8")
    (folder / "dam.skt").write_text(text, encoding="utf-8")
    crest = float(rng.uniform(12, 30))
    source = folder / "site.sdl"
    source.write_text(f'Sketch low("dam.skt", CREST = {crest!r});\n', encoding="utf-8")
    return Drawn(moldloft.load(source))


FAMILIES = (
    family(random_models.chine_hull),
    rounded_bar,
    family(random_models.platform),
    sharp_set,
    family(random_models.wing),
    sketch,
    family(random_models.round_hull),
    family(random_models.prisms),
)


def faces_of_voids(text: str) -> set[str]:
    """The names of the faces round cavities in a STEP file."""
    shells = set(re.findall(r"ORIENTED_CLOSED_SHELL\('',\*,#(\d+)", text))
    held = dict(re.findall(r"#(\d+)=CLOSED_SHELL\('[^']*',\(([^)]*)\)", text))
    numbers = {n for shell in shells for n in re.findall(r"#(\d+)", held[shell])}
    named = dict(re.findall(r"#(\d+)=ADVANCED_FACE\('([^']*)'", text))
    return {named[n] for n in numbers}


@pytest.mark.parametrize("seed", SEEDS)
def test_models_leave_and_come_back_as_they_are(seed: int, tmp_path: Path) -> None:
    from cad_reading import read
    from moldloft.cad.importing import program

    draw = FAMILIES[seed % len(FAMILIES)]
    drawn = draw(np.random.default_rng(1000 + seed), tmp_path)
    model = drawn.model
    (step,) = model.write(tmp_path / "model.step")
    (iges,) = model.write(tmp_path / "model.igs")
    text = step.read_text()
    stated = re.search(r"UNCERTAINTY_MEASURE_WITH_UNIT\(LENGTH_MEASURE\(([^)]*)\)", text)
    assert stated
    unit = 1.0 if ".METRE." in text and "CONVERSION_BASED_UNIT('FOOT'" not in text else 0.3048
    gap = float(stated[1]) * unit
    one, flat = read(step, accuracy=1e-7), read(iges, accuracy=1e-7)
    # Valid, closed where the file says so, with names and colours.
    assert one.valid and flat.valid
    assert one.faces == flat.faces == text.count("=ADVANCED_FACE(")
    assert one.closed == text.count("=CLOSED_SHELL(") > 0
    assert one.solids == text.count("=MANIFOLD_SOLID_BREP(") + text.count("=BREP_WITH_VOIDS(")
    assert one.colours and flat.colours
    faces = set(re.findall(r"=ADVANCED_FACE\('([^']*)'", text))
    # OCCT's reader gives the faces of voids no names.
    assert faces - faces_of_voids(text) <= one.names and set(drawn.names) <= faces
    assert one.tolerance <= max(2 * gap, 2e-7) and flat.tolerance <= max(10 * gap, 2e-5)
    # Both alike, and as the formula has it.
    bound = gap * math.sqrt(one.area) * 10 + 1e-6 * one.area
    assert abs(flat.area - one.area) <= bound
    if drawn.volume is not None and drawn.area is not None:
        assert one.volume == pytest.approx(drawn.volume, rel=1e-6)
        assert one.area == pytest.approx(drawn.area, rel=1e-6)
    # Back, and out again: as many closed bodies of the same size.
    source, remarks = program(step)
    assert not remarks
    again = moldloft.loads(source)
    assert again.mesh().closed
    assert again.mesh().volume == pytest.approx(one.volume, rel=1e-3)
    found = read(again.write(tmp_path / "again.step")[0], accuracy=1e-7)
    assert found.valid and (found.solids, found.closed) == (one.solids, one.closed)
    assert abs(found.volume - one.volume) <= gap * one.area + 1e-6 * one.volume
    assert abs(found.area - one.area) <= bound


def test_a_cavity_is_one_of_its_solid(tmp_path: Path) -> None:
    from cad_reading import read

    corner = "set block = cuboid({0, 0, 0}, {4, 4, 4}); set hole = cuboid({1, 1, 2}, {2, 2, 3});"
    box = "{-1, -1, -1}, {12, 5, 5}"
    model = moldloft.loads(f"{corner} SetBody body(block - hole, {box});")
    found = read(model.write(tmp_path / "hollow.step")[0])
    assert found.valid and (found.solids, found.shells, found.closed) == (1, 2, 2)
    # A cube of 4 with a void of 1.
    assert found.area == pytest.approx(102, rel=1e-9)
    assert found.volume == pytest.approx(63, rel=1e-9)
    assert read(model.write(tmp_path / "hollow.igs")[0]).area == pytest.approx(102, rel=1e-9)
    # Beside another body the cavity is in the one that is round it.
    model = moldloft.loads(
        f"{corner} set other = cuboid({{6, 0, 0}}, {{8, 4, 4}});"
        f"SetBody body((block - hole) | other, {box});"
    )
    found = read(model.write(tmp_path / "two.step")[0])
    assert found.valid and (found.solids, found.shells) == (2, 3)
    assert found.volume == pytest.approx(63 + 32, rel=1e-9)
    # A body in the cavity has the outer one round it as well.
    model = moldloft.loads(
        "set block = cuboid({0, 0, 0}, {4, 4, 4}); set hole = cuboid({1, 1, 1}, {3, 3, 3});"
        "set core = cuboid({1.5, 1.5, 1.5}, {2.5, 2.5, 2.5});"
        "SetBody body((block - hole) | core, {-1, -1, -1}, {5, 5, 5});"
    )
    found = read(model.write(tmp_path / "core.step")[0])
    assert found.valid and (found.solids, found.shells) == (2, 3)
    assert found.volume == pytest.approx(64 - 8 + 1, rel=1e-9)
