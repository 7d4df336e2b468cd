"""Models out and back in STEP, IGES, 3DM and BREP: closed, the same side out, names and colours.

`MOLDLOFT_SOAK=1` takes all examples with closed bodies and 20 random models; without it a few.
"""

from __future__ import annotations

import os
import re
import warnings
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import moldloft
import random_models
from moldloft.cad import identifier

pytest.importorskip("OCP")
pytest.importorskip("rhino3dm")

EXAMPLES = Path(__file__).parents[3] / "examples"
SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
#: Examples with closed bodies.
CLOSED = ("car_body", "caisson", "bracket", "lock", "semisubmersible", "spar", "tug")
SOURCES = [*(f"gallery/{n}.sdl" for n in (CLOSED if SOAK else CLOSED[:2]))]
SOURCES += [f"random {k}" for k in range(20 if SOAK else 4)]
CASES = [(name, ending) for name in SOURCES for ending in ("step", "igs", "3dm", "brep")]


@cache
def source(name: str) -> moldloft.Model:
    if name.startswith("random"):
        seed = int(name.split()[1])
        return moldloft.loads(random_models.drawn(seed).text)
    return moldloft.load(EXAMPLES / name)


def written(model: moldloft.Model, path: Path) -> Path:
    """The file; a BREP file is that of OCCT."""
    if path.suffix != ".brep":
        return model.write(path)[0]
    from OCP.BRepTools import BRepTools

    BRepTools.Write_s(model.to_ocp(), str(path))
    return path


def back(path: Path, units: str) -> moldloft.Model:
    from moldloft.cad.importing import load_cad

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return load_cad(path, units=units)


def volume(model: moldloft.Model, mesh: moldloft.Mesh) -> float:
    """The volume of the body, of its surfaces and not of panels."""
    over = float(mesh.vertices[:, 2].max() + np.ptp(mesh.vertices, axis=0).max())
    return model.hydrostatics(level=over).volume


def kinds(mesh: moldloft.Mesh) -> set[tuple[str, int]]:
    """Names and colours of faces; parts and images of a surface have its name and a number."""
    found = set()
    for patch in mesh.patches:
        name = patch.name.replace(".mirror_x", "").replace(".mirror_y", "")
        found.add((identifier(name, set()).rstrip("_0123456789"), patch.colour))
    return found


@pytest.mark.parametrize(("name", "ending"), CASES)
def test_a_closed_model_comes_back(name: str, ending: str, tmp_path: Path) -> None:
    model = source(name)
    unit = model.length_unit[0]
    mesh = model.mesh(whole=True)
    assert mesh.closed
    # OCCT's shape has no unit: it is in millimetres.
    found = back(written(model, tmp_path / f"model.{ending}"), "mm" if ending == "brep" else unit)
    again = found.mesh()
    assert again.closed and again.volume > 0
    # The volume of the surfaces themselves, all under water.
    # A set has that of its triangles.
    near = 2e-3 if any(model[n].kind == "SetBody" for n in model.objects) else 1e-5
    assert volume(found, again) == pytest.approx(volume(model, mesh), rel=near)
    if ending == "brep":
        return
    assert kinds(again) == kinds(mesh)


SHELLS = """
AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z); AbsPoint K(3, 0, 0);
AbsPoint L(4, 0, 1); AbsPoint M(5, 0, 0); AbsPoint N(4, 0, -1);
CCurve ring({K, L, M, N, K}, ends = "periodic");
RevSurf donut(ring, axis, colour = 4, tags = "outer");
AbsPoint D(0, 0, -9); AbsPoint E(0, 0, -5); AbsPoint F(2, 0, -7);
Arc half(D, F, E, type = 1); RevSurf ball(half, axis, colour = 2, tags = "core");
AbsPoint A(9, 0, 0); AbsPoint B(9, 2, 0); AbsPoint C(11, 0, 0); Line ab(A, B); Line ac(A, C);
TranSurf sheet(ab, ac);
"""


def test_doubly_closed_faces_and_levels_in_iges(tmp_path: Path) -> None:
    """Faces without a loop have their names, levels theirs."""
    model = moldloft.loads(SHELLS)
    path = model.write(tmp_path / "shells.igs")[0]
    # No loops, no outer boundary, no associativities, one property.
    assert len(re.findall(r"^144,\d+,0,0,0,0,1,\d+;", path.read_text(), re.M)) == 2
    found = back(path, "m").mesh()
    told = {patch.name: (patch.colour, patch.tags) for patch in found.patches}
    assert told == {"donut": (4, ["outer"]), "ball": (2, ["core"]), "sheet": (10, [])}
    assert found.area == pytest.approx(model.mesh().area, rel=0.1)
