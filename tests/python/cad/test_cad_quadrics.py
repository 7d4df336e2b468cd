"""Ellipsoids, elliptic cylinders and cones to STEP and IGES as exact faces, judged by OCCT.

`MOLDLOFT_SOAK=1` draws 20 of each kind.
"""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.random import Generator

import moldloft

pytest.importorskip("OCP")

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

Floats = np.ndarray[Any, np.dtype[np.float64]]


@dataclass
class Drawn:
    """A body: its text, its box, and what is known of it by formula."""

    text: str
    box: str
    volume: float | None = None
    faces: int | None = None


def numbers(p: Floats) -> str:
    return "{" + ", ".join(repr(float(x)) for x in p) + "}"


def frame(rng: Generator) -> tuple[str, Floats, Floats]:
    """Planes along turned axes through a point, as fields x, y and z; the point and the axes."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    if np.linalg.det(turn) < 0:
        turn[2] *= -1
    at = rng.uniform(-2, 2, 3)
    text = "".join(
        f"field {name} = plane({numbers(row)}, {numbers(at)}); "
        for name, row in zip("xyz", turn, strict=True)
    )
    return text, at, turn


def around(at: Floats, reach: float) -> str:
    return f"{numbers(at - reach)}, {numbers(at + reach)}"


def lengths(rng: Generator, count: int, low: float = 0.5, high: float = 1.7) -> list[float]:
    return [float(x) for x in rng.uniform(low, high, count)]


def ellipsoid(rng: Generator) -> Drawn:
    """A whole ellipsoid."""
    text, at, _ = frame(rng)
    a, b, c = lengths(rng, 3)
    text += f"set s = set((x/{a})^2 + (y/{b})^2 + (z/{c})^2 - 1);"
    return Drawn(text, around(at, 2.3), 4 / 3 * math.pi * a * b * c, 1)


def cut_ellipsoid(rng: Generator) -> Drawn:
    """The part of an ellipsoid below an oblique plane: the image of a ball's segment."""
    text, at, _ = frame(rng)
    a, b, c = lengths(rng, 3)
    p, q, r = (float(x) for x in rng.uniform(-0.4, 0.4, 3))
    # p x + q y + z <= r is the image of a plane at the distance d from the ball's middle.
    d = r / math.sqrt((p * a) ** 2 + (q * b) ** 2 + c**2)
    segment = math.pi * (1 + d) ** 2 * (2 - d) / 3
    text += (
        f"set s = set((x/{a})^2 + (y/{b})^2 + (z/{c})^2 - 1) & set(({p})*x + ({q})*y + z - ({r}));"
    )
    return Drawn(text, around(at, 2.3), segment * a * b * c, 2)


def bar(rng: Generator) -> Drawn:
    """An elliptic cylinder between two planes, of which one is oblique."""
    text, at, _ = frame(rng)
    a, b = lengths(rng, 2)
    p, q = (float(x) for x in rng.uniform(-0.5, 0.5, 2))
    text += (
        f"set s = set((x/{a})^2 + (y/{b})^2 - 1) & set(-z - 1) & set(z - 1.5 - ({p})*x - ({q})*y);"
    )
    return Drawn(text, around(at, 5.0), math.pi * a * b * 2.5, 3)


def cone(rng: Generator) -> Drawn:
    """An elliptic cone with its apex, below an oblique plane across it."""
    text, at, _ = frame(rng)
    a, b = lengths(rng, 2, 0.4, 0.9)
    p = float(rng.uniform(-0.4, 0.4))
    h = float(rng.uniform(1, 2))
    # z <= h + p x: the image of a cone of revolution, cut at the slope p a.
    k = p * a
    volume = math.pi / 3 * h**3 * a * b / (1 - k * k) ** 1.5
    text += f"set s = set((x/{a})^2 + (y/{b})^2 - z^2) & set(-z) & set(z - {h} - ({p})*x);"
    return Drawn(text, around(at, 4.5), volume, 2)


def torpedo(rng: Generator) -> Drawn:
    """A cylinder between half spheroids that touch it."""
    text, at, turn = frame(rng)
    r, nose, tail = lengths(rng, 3, 0.4, 1.6)
    end = at + 1.5 * turn[0]
    text += (
        f"Line axis({numbers(at)}, {numbers(end)});"
        f"set barrel = set(cylinder(axis, {r})) & set(-x) & set(x - 1.5);"
        f"set s = barrel | set((x/{nose})^2 + (y/{r})^2 + (z/{r})^2 - 1)"
        f" | set(((x - 1.5)/{tail})^2 + (y/{r})^2 + (z/{r})^2 - 1);"
    )
    volume = math.pi * r * r * (1.5 + 2 / 3 * (nose + tail))
    return Drawn(text, around(at, 4.5), volume, 3)


def egg(rng: Generator) -> Drawn:
    """Halves of two spheroids that touch in one circle: no cylinder between."""
    text, at, _ = frame(rng)
    r, nose, tail = lengths(rng, 3, 0.5, 1.6)
    text += (
        f"set s = (set((x/{nose})^2 + (y/{r})^2 + (z/{r})^2 - 1) & set(x))"
        f" | (set((x/{tail})^2 + (y/{r})^2 + (z/{r})^2 - 1) & set(-x));"
    )
    return Drawn(text, around(at, 2.5), 2 / 3 * math.pi * r * r * (nose + tail), 2)


def shell(rng: Generator) -> Drawn:
    """Between two ellipsoids of one centre, above a plane through it."""
    text, at, _ = frame(rng)
    a, b, c = lengths(rng, 3, 0.8, 1.7)
    t = float(rng.uniform(0.1, 0.3))
    volume = 2 / 3 * math.pi * (a * b * c - (a - t) * (b - t) * (c - t))
    text += (
        f"set s = (set((x/{a})^2 + (y/{b})^2 + (z/{c})^2 - 1)"
        f" - set((x/{a - t})^2 + (y/{b - t})^2 + (z/{c - t})^2 - 1)) & set(-z);"
    )
    return Drawn(text, around(at, 2.3), volume, 3)


def bored(rng: Generator) -> Drawn:
    """An ellipsoid with an elliptic bore, across or along, and a notch."""
    text, at, _ = frame(rng)
    a, b, c = lengths(rng, 3, 0.9, 1.6)
    p, q = lengths(rng, 2, 0.2, 0.45)
    u, v = ("xy", "yz", "zx")[int(rng.integers(3))]
    text += (
        f"set s = set((x/{a})^2 + (y/{b})^2 + (z/{c})^2 - 1)"
        f" - set((({u} - 0.1)/{p})^2 + (({v} + 0.05)/{q})^2 - 1)"
        f" - (set(x - 0.9*{a}) & set(-x + 0.7*{a}) & set(-y + 0.2*{b}));"
    )
    return Drawn(text, around(at, 2.3))


def crossed(rng: Generator) -> Drawn:
    """Two ellipsoids, one of them turned, and a ball as one body."""
    text, at, _ = frame(rng)
    a, b, c = lengths(rng, 3, 0.8, 1.3)
    p, q, r = lengths(rng, 3, 0.5, 0.9)
    text += (
        f"field u = x + 0.4*y - 0.6, v = y - 0.3*z, w = z + 0.2*x - 0.3;"
        f"set s = set((x/{a})^2 + (y/{b})^2 + (z/{c})^2 - 1)"
        f" | set((u/{p})^2 + (v/{q})^2 + (w/{r})^2 - 1)"
        f" | set((x + {a})^2 + y^2 + z^2 - 0.3);"
    )
    return Drawn(text, around(at, 3.2))


KINDS: tuple[Callable[[Generator], Drawn], ...] = (
    ellipsoid, cut_ellipsoid, bar, cone, torpedo, egg, shell, bored, crossed,
)  # fmt: skip

CASES = [(kind.__name__, seed) for seed in range(20 if SOAK else 1) for kind in KINDS]


@pytest.mark.parametrize(("name", "seed"), CASES)
def test_quadrics_are_exact_faces(name: str, seed: int, tmp_path: Path) -> None:
    from cad_reading import read

    kind = next(k for k in KINDS if k.__name__ == name)
    drawn = kind(np.random.default_rng([2200, seed, KINDS.index(kind)]))
    model = moldloft.loads(
        f'Model info(units = "m"); {drawn.text} SetBody b(s, {drawn.box}, depth = 5);'
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        (step,) = model.write(tmp_path / "b.step")
    if model.export_remarks:
        # Corners of thin wedges that cells pass over: patches or triangles, which is said.
        assert SOAK and name in ("bored", "crossed"), model.export_remarks
        assert {d.id for d in model.export_remarks} <= {"as-triangles", "fitted-surfaces"}
        return
    (iges,) = model.write(tmp_path / "b.igs")
    text = step.read_text()
    assert {d.id for d in model.export_remarks} == {"curves-in-space"}
    found, flat = read(step, accuracy=1e-7, gauss=True), read(iges, accuracy=1e-7, gauss=True)
    assert found.valid and found.solids == found.shells == found.closed == 1
    assert found.faces == text.count("=ADVANCED_FACE(") <= 12
    if drawn.faces is not None:
        assert found.faces == drawn.faces
    # OCCT makes the edges' curves in parameters anew, of either file, and is off by up to a
    # millionth of the size; of IGES it may divide a face along its seam, as the remark says.
    alike = flat.valid and flat.faces == found.faces
    alike = alike and flat.area == pytest.approx(found.area, rel=1e-5)
    assert alike or (SOAK and name == "crossed")
    low, high = model.eval("volume_bracket(s)")
    slack = 1e-6 * found.area * float(np.ptp(model.mesh().vertices, axis=0).max())
    assert low - slack <= found.volume <= high + slack
    if drawn.volume is not None:
        assert abs(found.volume - drawn.volume) <= slack
    assert found.tolerance < 3e-5


@pytest.mark.parametrize("name", ["helmet", "swath"] if SOAK else ["swath"])
def test_examples_of_quadrics_are_few_exact_faces(name: str, tmp_path: Path) -> None:
    from cad_reading import read

    folder = Path(__file__).parents[3] / "examples" / "gallery"
    model = moldloft.load(folder / f"{name}.sdl")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        (step,) = model.write(tmp_path / "b.step")
    assert not model.export_remarks
    metre = 1.0 if name == "swath" else 1e-3
    found = read(step, accuracy=1e-7, gauss=True)
    assert found.valid and found.solids == found.closed and found.faces < 100
    low, high = model.eval("volume_bracket(side)" if name == "swath" else "volume_bracket(helmet)")
    images = 2 if name == "swath" else 1
    slack = 5e-6 * high * images
    assert low * images - slack <= found.volume / metre**3 <= high * images + slack


def test_exact_quadrics_come_back(tmp_path: Path) -> None:
    from cad_reading import read
    from moldloft.cad.importing import program

    text = (
        "field x = plane({1, 0, 0}, {0, 0, 0}), y = plane({0, 1, 0}, {0, 0, 0}); "
        "field z = plane({0, 0, 1}, {0, 0, 0}); "
        "set s = set((x/2)^2 + y^2 + (z/0.7)^2 - 1) & set(z + 0.1*x - 0.2); SetBody b(s);"
    )
    model = moldloft.loads(text)
    (file,) = model.write(tmp_path / "b.step")
    source, remarks = program(file)
    again = moldloft.loads(source)
    assert not remarks and again.mesh().closed
    found = [read(f, accuracy=1e-7) for f in (file, again.write(tmp_path / "again.step")[0])]
    assert found[1].valid and found[1].solids == found[1].closed == 1
    assert found[1].volume == pytest.approx(found[0].volume, rel=1e-6)
    assert found[1].area == pytest.approx(found[0].area, rel=1e-6)
