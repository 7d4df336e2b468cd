"""Assemblies of another program, OCCT, as components: each part once, in all of its places.

`MOLDLOFT_SOAK=1` draws 20 assemblies.
"""

from __future__ import annotations

import contextlib
import os
import random
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft
import occt_parts
from moldloft.cli import main

pytest.importorskip("OCP")

SEEDS = range(20) if os.environ.get("MOLDLOFT_SOAK") == "1" else (0, 4)


class Assembly:
    """A document of OCCT with products, places, colours and layers, in millimetres."""

    def __init__(self) -> None:
        from OCP.TCollection import TCollection_ExtendedString
        from OCP.TDocStd import TDocStd_Document
        from OCP.XCAFDoc import XCAFDoc_DocumentTool

        self.document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
        XCAFDoc_DocumentTool.SetLengthUnit_s(self.document, 1e-3)
        self.shapes = XCAFDoc_DocumentTool.ShapeTool_s(self.document.Main())
        self.colours = XCAFDoc_DocumentTool.ColorTool_s(self.document.Main())
        self.layers = XCAFDoc_DocumentTool.LayerTool_s(self.document.Main())

    def product(self, name: str, shape: Any = None) -> Any:
        label = self.shapes.AddShape(shape, False) if shape else self.shapes.NewShape()
        self.name(label, name)
        return label

    @staticmethod
    def name(label: Any, name: str) -> None:
        from OCP.TCollection import TCollection_ExtendedString
        from OCP.TDataStd import TDataStd_Name

        TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))

    def place(self, whole: Any, part: Any, place: Any, name: str = "") -> Any:
        from OCP.TopLoc import TopLoc_Location

        label = self.shapes.AddComponent(whole, part, TopLoc_Location(place))
        if name:
            self.name(label, name)
        return label

    def colour(self, label: Any, rgb: tuple[float, float, float]) -> None:
        from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
        from OCP.XCAFDoc import XCAFDoc_ColorSurf

        self.colours.SetColor(label, Quantity_Color(*rgb, Quantity_TOC_sRGB), XCAFDoc_ColorSurf)

    def layer(self, label: Any, name: str) -> None:
        from OCP.TCollection import TCollection_ExtendedString

        self.layers.SetLayer(label, TCollection_ExtendedString(name))

    def write(self, path: Path) -> Path:
        from OCP.STEPCAFControl import STEPCAFControl_Writer

        from moldloft.cad.occt import _quiet

        self.shapes.UpdateAssemblies()
        writer = STEPCAFControl_Writer()
        writer.SetColorMode(True)
        writer.SetNameMode(True)
        writer.SetLayerMode(True)
        with _quiet():
            writer.Transfer(self.document)
            writer.Write(str(path))
        return path


def placement(rng: random.Random, away: float = 400.0) -> Any:
    """A rotation and a translation."""
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec

    place, move = gp_Trsf(), gp_Trsf()
    axis = gp_Dir(*(rng.uniform(0.1, 1) for _ in "xyz"))
    place.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), axis), rng.uniform(0, 6))
    move.SetTranslation(gp_Vec(*(rng.uniform(-away, away) for _ in "xyz")))
    return move.Multiplied(place)


def converted(path: Path, target: Path) -> dict[str, str]:
    """The programs that `convert` writes, by name."""
    assert main(["convert", str(path), "-o", str(target), "--units", "mm"]) == 0
    return {file.name: file.read_text() for file in target.parent.glob("*.sdl")}


def centres(shape: Any) -> np.ndarray:
    """Volumes and centres of the solids of a shape, by OCCT."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.TopAbs import TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer

    rows = []
    found = TopExp_Explorer(shape, TopAbs_SOLID)
    while found.More():
        figures = GProp_GProps()
        BRepGProp.VolumeProperties_s(found.Current(), figures, 1e-9, False, False)
        at = figures.CentreOfMass()
        rows.append((figures.Mass(), at.X(), at.Y(), at.Z()))
        found.Next()
    return np.array(rows)


def ours(model: moldloft.Model) -> dict[str, tuple[float, float, float, float]]:
    """Volumes and centres of the panels of each component, by its name."""
    mesh = model.mesh()
    found: dict[str, np.ndarray] = {}
    for patch in mesh.patches:
        faces = mesh.vertices[mesh.faces[patch.start : patch.stop]]
        a, b, c, d = (faces[:, k] for k in range(4))
        for p, q, r in ((a, b, c), (a, c, d)):
            six = np.einsum("ij,ij->i", p, np.cross(q, r))
            moment = (six[:, None] * (p + q + r)).sum(axis=0) / 24
            row = np.array([six.sum() / 6, *moment])
            name = patch.name.rpartition(".")[0]
            found[name] = found.get(name, np.zeros(4)) + row
    return {name: (row[0], *(row[1:] / row[0])) for name, row in found.items()}


@pytest.mark.parametrize("seed", SEEDS)
def test_a_part_placed_ten_times_is_one_component_ten_times(seed: int, tmp_path: Path) -> None:
    rng = random.Random(seed)
    made = Assembly()
    whole = made.product("machine")
    unit = made.product("unit")
    parts = rng.sample(["flange", "dome", "chamfered", "rounded_plate", "prism_loft", "tray"], 3)
    bolt, pin, plate = (
        made.product(name, occt_parts.PARTS[kind](rng))
        for name, kind in zip(("bolt", "x_axis", "plate"), parts, strict=True)
    )
    made.colour(bolt, (1.0, 0.0, 0.0))
    made.layer(bolt, "steel parts")
    # A unit of two bolts and a pin, three times; four more bolts, a plate.
    for part in (bolt, bolt, pin):
        made.place(unit, part, placement(rng))
    for _ in range(3):
        made.place(whole, unit, placement(rng, 4000))
    for k in range(4):
        made.place(whole, bolt, placement(rng, 4000), f"bolt {k}")
    made.place(whole, plate, placement(rng, 4000))
    path = made.write(tmp_path / "machine.step")
    texts = converted(path, tmp_path / "out" / "machine.sdl")
    # The pin is used in one product alone, the plate once.
    assert {*texts} == {"machine.sdl", "machine.bolt.sdl", "machine.unit.sdl"}
    uses = {name: len(re.findall(r"^Component ", text, re.M)) for name, text in texts.items()}
    assert uses == {"machine.sdl": 7, "machine.bolt.sdl": 0, "machine.unit.sdl": 2}
    assert sum(map(len, texts.values())) < 3 * path.stat().st_size
    model = moldloft.load(tmp_path / "out" / "machine.sdl")
    assert model.diagnostics == [] and model.mesh().closed
    # Each is where OCCT has it.
    theirs = centres(made.shapes.GetShape_s(whole))
    found = ours(model)
    # The unit's own faces are those of its pin, the machine's those of its plate.
    names = {"", *(f"bolt_{k}" for k in range(4))}
    units = sorted({n.partition(".")[0] for n in found} - names)
    assert len(units) == 3 and len(found) == 14 == len(theirs)
    assert all(len([n for n in found if n.startswith(f"{u}.")]) == 2 for u in units)
    for volume, *centre in found.values():
        away = np.linalg.norm(theirs[:, 1:] - centre, axis=1)
        k = int(away.argmin())
        assert away[k] < 0.5 and volume == pytest.approx(theirs[k, 0], rel=5e-3)
        theirs = np.delete(theirs, k, axis=0)
    # Exactly, and as one text: the same faces.
    from moldloft.cad.importing import load_cad

    with pytest.warns(UserWarning, match="nearest of the sixteen"):
        flat = load_cad(path, units="mm")
    one, other = model.mesh(), flat.mesh()
    assert len(one.patches) == len(other.patches)
    assert one.volume == pytest.approx(other.volume, rel=1e-11)
    tags = {tuple(p.tags) for p in one.patches if p.name.startswith("bolt_1.")}
    assert tags == {("bolt", "steel_parts")}
    assert {p.colour for p in one.patches if p.name.startswith("bolt_1.")} == {4}
    assert {tuple(p.tags) for p in one.patches if "." not in p.name} == {("machine", "plate")}
    # Measures of placed faces.
    area = sum(model[p.name].area for p in one.patches)
    assert area == pytest.approx(sum(flat[p.name].area for p in other.patches), rel=1e-11)


def test_a_placement_with_a_colour_of_its_own_is_no_component(tmp_path: Path) -> None:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Trsf, gp_Vec

    made = Assembly()
    whole = made.product("pair")
    box = made.product("box", BRepPrimAPI_MakeBox(10, 20, 30).Shape())
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(50, 0, 0))
    made.place(whole, box, gp_Trsf())
    made.colour(made.place(whole, box, move), (1.0, 0.0, 0.0))
    texts = converted(made.write(tmp_path / "pair.step"), tmp_path / "out" / "pair.sdl")
    assert {*texts} == {"pair.sdl"}
    patches = moldloft.load(tmp_path / "out" / "pair.sdl").mesh().patches
    assert sorted(p.colour for p in patches) == [4] * 6 + [10] * 6 and len(patches) == 12


@pytest.mark.parametrize("ending", ["step", "igs"])
def test_layers_come_back_as_tags(ending: str, tmp_path: Path) -> None:
    from moldloft.cad.importing import load_cad

    source = moldloft.loads(
        "Line a({0, 0, 0}, {1, 0, 0}); Line b({0, 1, 0}, {1, 1, 0}); Line c({0, 1, 1}, {1, 1, 1});"
        'RuledSurf s(a, b, tags = "hull"); RuledSurf t(a, c, tags = {"deck", "wood"});'
    )
    (path,) = source.write(tmp_path / f"layers.{ending}")
    with pytest.warns() if ending == "igs" else contextlib.nullcontext():
        model = load_cad(path)
    tags = {p.name: {*p.tags} - {"s__t"} for p in model.mesh().patches}
    # IGES has one level for each entity.
    known = {"s": {"hull"}, "t": {"deck", "wood"}}
    assert tags == (known if ending == "step" else {"s": {"hull"}, "t": {"deck"}})
