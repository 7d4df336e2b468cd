"""Lines and points of sets in CAD files, by OCCT: lengths by formula, beside sheets and alone.

`MOLDLOFT_SOAK=1` draws 200 sets.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cad_reading
import moldloft

pytest.importorskip("OCP")

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
FORMATS = ("step", "iges")


def text(v: Any) -> str:
    return "{" + ", ".join(f"{x:.17g}" for x in v) + "}"


def sheet_plane(normal: Any, point: Any) -> str:
    return f"set(abs(plane({text(normal)}, {text(point)})))"


def sheet_ball(centre: Any, radius: float) -> str:
    return f"set(abs(sphere({text(centre)}, {radius!r})))"


def drawn(seed: int) -> tuple[str, float]:
    """A set that is one closed line somewhere in space, and its length."""
    rng = np.random.default_rng(seed)
    scale = 10 ** rng.uniform(-2, 2)
    centre = scale * rng.uniform(-2, 2, 3)
    normal = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    r = scale * rng.uniform(0.5, 1.5)
    kind = seed % 3
    if kind == 0:
        off = r * rng.uniform(-0.9, 0.9)
        shape = f"{sheet_ball(centre, r)} & {sheet_plane(normal, centre + off * normal)}"
        return f"set s = {shape};", 2 * math.pi * math.sqrt(r * r - off * off)
    if kind == 1:
        d, q = r * rng.uniform(0.4, 1.2), r * rng.uniform(0.7, 1.3)
        if not abs(r - q) + 0.05 * r < d < r + q - 0.05 * r:
            d, q = r, r
        along = (d * d + r * r - q * q) / (2 * d)
        radius = math.sqrt(r * r - along * along)
        shape = f"{sheet_ball(centre, r)} & {sheet_ball(centre + d * normal, q)}"
        return f"set s = {shape};", 2 * math.pi * radius
    # An oblique plane cuts a cylinder in an ellipse.
    special = pytest.importorskip("scipy.special")
    tilt = rng.uniform(0, 1.1)
    side = np.cross(normal, rng.normal(size=3))
    side /= np.linalg.norm(side)
    cut = math.cos(tilt) * normal + math.sin(tilt) * side
    long = r / math.cos(tilt)
    length = 4 * long * special.ellipe(1 - (r / long) ** 2)
    axis = f"Line axis({text(centre)}, {text(centre + scale * normal)}, visible = 0);"
    shape = f"set(abs(cylinder(axis, {r!r}))) & {sheet_plane(cut, centre)}"
    return f"{axis} set s = {shape};", length


def written(program: str, folder: Path, form: str) -> Any:
    """The shape that OCCT reads."""
    from OCP.IGESControl import IGESControl_Reader
    from OCP.STEPControl import STEPControl_Reader

    model = moldloft.loads(f'{program} Model unit(units = "mm");', name="lines.sdl")
    path = folder / f"lines.{form}"
    model.write(path)
    reader = STEPControl_Reader() if form == "step" else IGESControl_Reader()
    assert int(reader.ReadFile(str(path))) == 1
    reader.TransferRoots()
    return reader.OneShape()


def length_of(shape: Any) -> float:
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    found = GProp_GProps()
    BRepGProp.LinearProperties_s(shape, found)
    return float(found.Mass())


def count(shape: Any, kind: Any) -> int:
    return len(cad_reading._unique(shape, kind))


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("seed", range(200 if SOAK else 9))
def test_a_line_has_its_length(seed: int, form: str, tmp_path: Path) -> None:
    from OCP.TopAbs import TopAbs_EDGE

    program, expected = drawn(seed)
    shape = written(f"{program} SetBody b(s, depth = 5);", tmp_path, form)
    assert length_of(shape) == pytest.approx(expected, rel=3e-6)
    # A spline for each line, not a chord for each cell.
    assert count(shape, TopAbs_EDGE) == 1


@pytest.mark.parametrize("seed", range(200 if SOAK else 9))
def test_a_line_is_measured(seed: int) -> None:
    program, expected = drawn(seed)
    model = moldloft.loads(f"{program} float length = wire_length(s);")
    assert model["length"] == pytest.approx(expected, rel=2e-6)


@pytest.mark.parametrize("form", FORMATS)
def test_lines_stay_beside_sheets(form: str, tmp_path: Path) -> None:
    program = """
    set a = set(abs(plane({1, 0, 0}, {0, 0, 0}))); set c = set(abs(plane({0, 1, 0}, {0, 0, 0})));
    set s = ((a | c) - cuboid({-.5, -.5, -.5}, {.5, .5, .5})) | (a & c);
    SetBody b(s, {-1, -1, -1}, {1, 1, 1}, depth = 4);
    """
    from OCP.TopAbs import TopAbs_FACE

    shape = written(program, tmp_path, form)
    assert count(shape, TopAbs_FACE) == 2
    # Two squares with square holes, and the line of length 1 through both holes.
    edges = 2 * (8 + 4) + 1
    shared = length_of(shape)
    assert shared == pytest.approx(edges, rel=1e-12)


@pytest.mark.parametrize("form", FORMATS)
def test_points_of_sets_are_points(form: str, tmp_path: Path) -> None:
    from OCP.TopAbs import TopAbs_VERTEX

    planes = [
        sheet_plane(normal, (3, 0.3, 0.1)) for normal in ((1, 0, 0), (0, 1, 0.2), (0.1, 0, 1))
    ]
    shape = written(
        f"set s = {' & '.join(planes)}; SetBody b(s, {{2, -1, -1}}, {{4, 1, 1}}, depth = 4);",
        tmp_path,
        form,
    )
    assert count(shape, TopAbs_VERTEX) == 1


def test_a_body_of_lines_builds(cli: Any, tmp_path: Path) -> None:
    path = tmp_path / "ring.sdl"
    program, _ = drawn(0)
    path.write_text(f"{program} SetBody b(s, depth = 4);")
    done = cli("build", path, "--to", "step", "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "fitted within" in done.stderr
