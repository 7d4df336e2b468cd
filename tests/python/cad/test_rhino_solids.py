"""Solids in 3DM files: one closed B-rep that openNURBS finds valid, its normals outward."""

from __future__ import annotations

import os
import random
from pathlib import Path

import pytest

import moldloft
import occt_parts

rhino3dm = pytest.importorskip("rhino3dm")
pytest.importorskip("OCP")

EXAMPLES = Path(__file__).parents[3] / "examples" / "gallery"
SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
NAMES = ("caisson", "bracket", "lock", "car_body", "semisubmersible", "spar", "tug", "twin_shafts")


def breps(model: moldloft.Model, path: Path) -> list[object]:
    """The B-reps of a file, all valid."""
    model.write(path)
    found = [thing.Geometry for thing in rhino3dm.File3dm.Read(str(path)).Objects]
    held = [g for g in found if isinstance(g, rhino3dm.Brep)]
    assert all(g.IsValid for g in held), [g.IsValidWithLog for g in held if not g.IsValid]
    return held


@pytest.mark.parametrize("name", NAMES if SOAK else NAMES[:2])
def test_closed_examples_are_solids(name: str, tmp_path: Path) -> None:
    model = moldloft.load(EXAMPLES / f"{name}.sdl")
    assert model.mesh(whole=True).closed
    held = breps(model, tmp_path / "model.3dm")
    assert held and all(brep.IsSolid and brep.IsManifold for brep in held)


@pytest.mark.parametrize("name", occt_parts.PARTS if SOAK else ("flange", "dome", "pipe", "tray"))
def test_parts_of_another_program_are_solids(name: str, tmp_path: Path) -> None:
    from moldloft.cad.importing import load_cad

    shape = occt_parts.PARTS[name](random.Random(1))
    area, volume = occt_parts.measures(shape)
    model = load_cad(occt_parts.write(tmp_path / "part.step", "MM", shape), units="mm")
    path = tmp_path / "part.3dm"
    (brep,) = breps(model, path)
    assert brep.IsSolid
    # And OCCT finds its size in what comes back.
    again = load_cad(path, units="mm")
    assert again.mesh().closed
    found = sum(again[patch.name].area for patch in again.mesh().patches)
    assert found == pytest.approx(area, rel=1e-5)
    assert abs(again.hydrostatics(level=1e4).volume) == pytest.approx(volume, rel=1e-5)


def test_names_and_colours_of_the_faces_of_a_solid_come_back(tmp_path: Path) -> None:
    from moldloft.cad.importing import load_cad

    corners = {"a": (0, 0, 0), "b": (1, 0, 0), "c": (0, 1, 0), "d": (0, 0, 1)}
    text = 'Model info(units = "mm");'
    text += "".join(f"AbsPoint {name}{at};" for name, at in corners.items())
    text += "".join(f"Line {p}{q}({p}, {q});" for p, q in ("ab", "ac", "ad", "bc", "bd", "cd"))
    text += (
        "RuledSurf floor(ab, ac, colour = 4); RuledSurf front(ab, ad, colour = 1);"
        "RuledSurf side(ac, ad, colour = 2); RuledSurf top(bc, bd, colour = 4);"
    )
    model = moldloft.loads(text)
    assert model.mesh().closed
    (brep,) = breps(model, tmp_path / "tetrahedron.3dm")
    assert brep.IsSolid and len(brep.Faces) == 4
    again = load_cad(tmp_path / "tetrahedron.3dm", units="mm").mesh()
    assert again.closed and again.volume == pytest.approx(1 / 6)
    assert {p.name: p.colour for p in again.patches} == {
        "floor": 4, "front": 1, "side": 2, "top": 4,
    }  # fmt: skip
