"""STEP and IGES files of another program, OCCT, as models: joined, closed, of the same size."""

from __future__ import annotations

import itertools
import math
import os
import random
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft

pytest.importorskip("OCP")

ROUNDS = 12 if os.environ.get("MOLDLOFT_SOAK") == "1" else 1


def written(path: Path, *shapes: Any) -> Path:
    """The shapes in a STEP or IGES file of OCCT, in millimetres."""
    from moldloft.cad.occt import _quiet

    with _quiet():
        if path.suffix == ".igs":
            from OCP.IGESControl import IGESControl_Controller, IGESControl_Writer

            IGESControl_Controller.Init_s()
            iges = IGESControl_Writer()
            for shape in shapes:
                iges.AddShape(shape)
            iges.Write(str(path))
        else:
            from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

            step = STEPControl_Writer()
            for shape in shapes:
                step.Transfer(shape, STEPControl_AsIs)
            step.Write(str(path))
    return path


def measures(shape: Any) -> tuple[float, float]:
    """Area and volume by OCCT, in square and cubic metres."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    area, volume = GProp_GProps(), GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, area, 1e-9)
    BRepGProp.VolumePropertiesGK_s(shape, volume, 1e-8)
    return area.Mass() * 1e-6, volume.Mass() * 1e-9


def filleted(shape: Any, radius: float) -> Any:
    """All edges rounded."""
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    fillet = BRepFilletAPI_MakeFillet(shape)
    edges = TopExp_Explorer(shape, TopAbs_EDGE)
    while edges.More():
        fillet.Add(radius, TopoDS.Edge(edges.Current()))
        edges.Next()
    return fillet.Shape()


def solids(rng: random.Random) -> dict[str, Any]:
    """Ordinary solids of OCCT, turned and moved."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.BRepPrimAPI import (
        BRepPrimAPI_MakeBox,
        BRepPrimAPI_MakeCylinder,
        BRepPrimAPI_MakeSphere,
        BRepPrimAPI_MakeTorus,
        BRepPrimAPI_MakeWedge,
    )
    from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf

    a, b, c = (rng.uniform(500, 3000) for _ in range(3))
    r = rng.uniform(0.1, 0.3) * min(a, b)
    cuboid = BRepPrimAPI_MakeBox(a, b, c).Shape()
    bore = gp_Ax2(gp_Pnt(a / 2, b / 2, -1), gp_Dir(0, 0, 1))
    bar = BRepPrimAPI_MakeBox(gp_Pnt(a / 3, b / 4, c / 5), gp_Pnt(2 * a, b / 2, c / 2)).Shape()
    made = {
        "box": cuboid,
        "cylinder": BRepPrimAPI_MakeCylinder(r, c).Shape(),
        "sphere": BRepPrimAPI_MakeSphere(r).Shape(),
        "torus": BRepPrimAPI_MakeTorus(a, rng.uniform(0.1, 0.8) * a).Shape(),
        "wedge": BRepPrimAPI_MakeWedge(a, b, c, a * rng.uniform(0.1, 0.9)).Shape(),
        "rounded": filleted(cuboid, 0.2 * min(a, b, c)),
        "bored": BRepAlgoAPI_Cut(cuboid, BRepPrimAPI_MakeCylinder(bore, r, 2 * c).Shape()).Shape(),
        "fused": BRepAlgoAPI_Fuse(cuboid, bar).Shape(),
    }
    place = gp_Trsf()
    place.SetRotation(
        gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(*(rng.uniform(0.1, 1) for _ in "xyz"))), rng.uniform(0, 6)
    )
    # OCCT's integrals of turned faces with steps in their outline do not end.
    turned = {n: s for n, s in made.items() if n != "fused"}
    return {
        "fused": made["fused"],
        **{n: BRepBuilderAPI_Transform(s, place, True).Shape() for n, s in turned.items()},
    }


CASES = [(name, seed) for seed in range(ROUNDS) for name in (
    "box", "cylinder", "sphere", "torus", "wedge", "rounded", "bored", "fused",
)]  # fmt: skip
if ROUNDS == 1:
    # Corners of which OCCT writes the sides with errors towards the pole.
    CASES += [("rounded", 7), ("rounded", 8)]


@pytest.mark.parametrize(("name", "seed"), CASES)
def test_solids_of_another_program_stay_solids(name: str, seed: int, tmp_path: Path) -> None:
    from cad_reading import read
    from moldloft.cad.importing import program

    shape = solids(random.Random(seed))[name]
    area, volume = measures(shape)
    text, remarks = program(written(tmp_path / "part.step", shape))
    assert not remarks
    model = moldloft.loads(text)
    # The panels are one closed body, outward.
    mesh = model.mesh()
    assert mesh.closed and mesh.summary["components"] == 1 and mesh.volume > 0
    assert mesh.volume == pytest.approx(volume, rel=0.25)
    # And so is what we write.
    found = read(model.write(tmp_path / "again.step")[0], accuracy=1e-6)
    assert found.valid and (found.solids, found.closed) == (1, 1)
    assert found.area == pytest.approx(area, rel=1e-5)
    assert found.volume == pytest.approx(volume, rel=1e-6)


def hull(length: float, beam: float, draft: float, side: float = 1) -> Any:
    """A side of a Wigley hull as another program has it: one B-spline face, in millimetres."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.collections import Array2_gp_Pnt
    from OCP.Geom import Geom_BezierSurface
    from OCP.GeomConvert import GeomConvert
    from OCP.gp import gp_Pnt

    net = Array2_gp_Pnt(1, 3, 1, 3)
    for (i, fx), (j, fz) in itertools.product(enumerate((0, 2, 0)), enumerate((1, 1, 0))):
        y = side * 500 * beam * fx * fz
        net.SetValue(i + 1, j + 1, gp_Pnt(1000 * length * (i / 2 - 0.5), y, -500 * draft * j))
    spline = GeomConvert.SurfaceToBSplineSurface_s(Geom_BezierSurface(net))
    return BRepBuilderAPI_MakeFace(spline, 1e-7).Face()


@pytest.mark.parametrize("ending", ["step", "igs"])
def test_a_hull_of_another_program_is_built_upon(ending: str, tmp_path: Path) -> None:
    from moldloft.cad.importing import program

    length, beam, draft = 10.0, 1.0, 0.625
    path = written(tmp_path / f"wigley.{ending}", hull(length, beam, draft))
    text, remarks = program(path)
    assert not remarks
    text = text.replace('units = "m"', 'units = "m t", symmetry = "y"')
    model = moldloft.loads(text)
    (name,) = [n for n in model.objects if "pole" not in n and n != "info"]
    text = text.replace(name, "face1")
    model = moldloft.loads(text)
    surface = model["face1"]

    def half_breadth(x: np.ndarray, z: np.ndarray) -> np.ndarray:
        return beam / 2 * (1 - (2 * x / length) ** 2) * (1 - (z / draft) ** 2)

    # Stations and waterlines.
    for plane in ("x=-2.5", "x=0", "x=3.125", "z=-0.125", "z=-0.5"):
        (branch,) = surface.intersect(plane).branches
        x, y, z = branch.points.T
        assert np.abs(y - half_breadth(x, z)).max() < 1e-12
    # Hydrostatics: of the hull 4/9 L B T, of the waterplane 2/3 L B.
    figures = model.hydrostatics(density="salt")
    assert figures.volume == pytest.approx(4 / 9 * length * beam * draft, rel=1e-6)
    assert figures.waterplane_area == pytest.approx(2 / 3 * length * beam, rel=1e-6)
    # Panels for a solver, and back: GDF holds the half of them, of a body with y = 0 as mirror.
    (gdf,) = model.write(tmp_path / "hull.gdf")
    lines = gdf.read_text().splitlines()
    assert lines[2].split() == ["0", "1"] and int(lines[3]) == len(model.mesh().faces)
    # Derivatives by what is ours.
    moved = moldloft.loads(
        text + "param float at = 0.3 in [0, 1]; AbsMagnet place(face1, at, 0.5);"
    )
    assert moved.derivative("place.x", "at") == pytest.approx(length)
    # A keel of ours stands on the hull: its panels share the hull's vertices.
    keel = moldloft.loads(
        text
        + """
        param float depth = 0.5 in [0.2, 1];
        EdgeSnake bottom(3, face1);
        Line foot({-2, 0, -1.2}, {2, 0, -1.2}); RuledSurf keel(bottom, foot, divisions = {0, 3});
        """
    )
    mesh = keel.mesh()
    assert mesh.summary["components"] == 1 and not keel.junctions()
    ours, theirs = ({*mesh.faces[p.start : p.stop].ravel().tolist()} for p in mesh.patches)
    assert len(ours & theirs) == mesh.patches[0].divisions[0] + 1


def test_both_sides_and_a_deck_of_another_program_are_one_hull(tmp_path: Path) -> None:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing

    from moldloft.cad.importing import program

    sewing = BRepBuilderAPI_Sewing(1e-3)
    for side in (-1.0, 1.0):
        sewing.Add(hull(10, 1, 0.625, side))
    sewing.Perform()
    text, _ = program(written(tmp_path / "hull.step", sewing.SewedShape()))
    model = moldloft.loads(text)
    assert text.count("Join ") == 3
    assert model.mesh().summary["components"] == 1
    assert model.hydrostatics().volume == pytest.approx(4 / 9 * 10 * 0.625, rel=1e-6)


@pytest.mark.parametrize("model", ["sailboat/hull.sdl", "gallery/spar.sdl", "wing/wing.sdl"])
def test_our_files_come_back_as_they_are(model: str, tmp_path: Path) -> None:
    from cad_reading import read
    from moldloft.cad.importing import load_cad

    source = moldloft.load(Path(__file__).parents[3] / "examples" / model)
    (first,) = source.write(tmp_path / "first.step")
    (second,) = load_cad(first).write(tmp_path / "second.step")
    one, other = read(first, accuracy=1e-6), read(second, accuracy=1e-6)
    assert other.valid and (one.solids, one.shells, one.faces) == (
        other.solids, other.shells, other.faces,
    )  # fmt: skip
    assert other.area == pytest.approx(one.area, rel=1e-5)
    assert other.volume == pytest.approx(one.volume, rel=1e-8)


def test_edges_that_cannot_be_joined_are_remarks(tmp_path: Path) -> None:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

    from moldloft.cad.importing import program

    # Two boxes that only touch share no edge in the file.
    boxes = [BRepPrimAPI_MakeBox(10, 10, 10).Shape() for _ in range(2)]
    text, remarks = program(written(tmp_path / "boxes.step", *boxes))
    model = moldloft.loads(text)
    assert not remarks and model.mesh().summary["components"] == 2
    assert math.isclose(model.mesh().volume, 2e-6, rel_tol=1e-9)


@pytest.mark.parametrize("lift", [0, 1000])
def test_solids_that_touch_in_an_edge_or_a_corner_stay_two(lift: float, tmp_path: Path) -> None:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    from cad_reading import read
    from moldloft.cad.importing import program

    # One vertex, or one edge of four faces, is shared in the file.
    one = BRepPrimAPI_MakeBox(1000, 1000, 1000).Shape()
    other = BRepPrimAPI_MakeBox(gp_Pnt(1000, 1000, lift), 1000, 1000, 1000).Shape()
    text, remarks = program(written(tmp_path / "touch.step", BRepAlgoAPI_Fuse(one, other).Shape()))
    model = moldloft.loads(text)
    mesh = model.mesh()
    assert not remarks and mesh.closed and mesh.summary["components"] == 2
    assert mesh.summary["manifold"] and mesh.volume == pytest.approx(2)
    found = read(model.write(tmp_path / "again.step")[0], accuracy=1e-9)
    assert found.valid and (found.solids, found.closed, found.faces) == (2, 2, 12)
    assert found.volume == pytest.approx(2) and found.area == pytest.approx(12)


def test_an_open_shell_stays_open(tmp_path: Path) -> None:
    from OCP.BRep import BRep_Builder
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS_Shell

    from cad_reading import read
    from moldloft.cad.importing import program

    builder, shell = BRep_Builder(), TopoDS_Shell()
    builder.MakeShell(shell)
    faces = TopExp_Explorer(BRepPrimAPI_MakeBox(1000, 1000, 1000).Shape(), TopAbs_FACE)
    faces.Next()
    while faces.More():
        builder.Add(shell, faces.Current())
        faces.Next()
    text, remarks = program(written(tmp_path / "open.step", shell))
    model = moldloft.loads(text)
    mesh = model.mesh()
    assert not remarks and not mesh.closed and mesh.summary["components"] == 1
    (rim,) = mesh.summary["open_loops"]
    assert rim["length"] == pytest.approx(4)
    found = read(model.write(tmp_path / "again.step")[0], accuracy=1e-9)
    assert found.valid and (found.solids, found.shells, found.closed) == (0, 1, 0)
    assert found.area == pytest.approx(5)


def test_the_sixteen_colours_come_back_and_others_become_the_nearest(tmp_path: Path) -> None:
    from moldloft.cad.importing import program

    text = "".join(
        f"Line a{k}({{0, 0, {k}}}, {{1, 0, {k}}}); Line b{k}({{0, 1, {k}}}, {{1, 1, {k}}});"
        f"RuledSurf s{k}(a{k}, b{k}, colour = {k});"
        for k in range(16)
    )
    (path,) = moldloft.loads(text).write(tmp_path / "all.step")
    source, remarks = program(path)
    assert remarks == []
    colours = {patch.name: patch.colour for patch in moldloft.loads(source).mesh().patches}
    assert colours == {f"s{k}": k for k in range(16)}
    # The first colour of the file becomes red.
    path.write_text(
        re.sub(r"COLOUR_RGB\('',[^)]*\)", "COLOUR_RGB('',1.,0.,0.)", path.read_text(), count=1)
    )
    source, remarks = program(path)
    assert remarks == ["colours become the nearest of the sixteen of a model"]
    again = [patch.colour for patch in moldloft.loads(source).mesh().patches]
    assert sorted(again) == sorted([4, *range(1, 16)])
