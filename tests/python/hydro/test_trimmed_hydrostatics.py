"""Hydrostatics of trimmed faces beside OCCT: parts of CAD files at random attitudes and levels.

OCCT cuts the solid at the water plane. `MOLDLOFT_SOAK=1` draws hundreds of cases.
"""

from __future__ import annotations

import math
import os
import random
from pathlib import Path
from typing import Any

import pytest

import moldloft

pytest.importorskip("OCP")

import occt_parts

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def turned(shape: Any, rng: random.Random) -> Any:
    """The shape turned about its origin, by any angles."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf

    for direction in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
        move = gp_Trsf()
        axis = gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(*map(float, direction)))
        move.SetRotation(axis, rng.uniform(-math.pi, math.pi))
        shape = BRepBuilderAPI_Transform(shape, move, True).Shape()
    return shape


def heights(shape: Any) -> tuple[float, float]:
    """Lowest and highest z."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    return low.Z(), high.Z()


def below(shape: Any, level: float) -> tuple[float, float, float, tuple[float, float, float]]:
    """Volume, wetted area, waterplane area and centre of the part below a level."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepGProp import BRepGProp
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.GeomAbs import GeomAbs_Plane
    from OCP.gp import gp_Pnt
    from OCP.GProp import GProp_GProps
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopoDS import TopoDS

    from moldloft.cad.sewing import faces_of

    far = 1e4
    air = BRepPrimAPI_MakeBox(gp_Pnt(-far, -far, level), gp_Pnt(far, far, level + far)).Shape()
    wet = BRepAlgoAPI_Cut(shape, air).Shape()
    solid, skin = GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(wet, solid, 1e-9, False, False)
    BRepGProp.SurfaceProperties_s(wet, skin, 1e-9)
    plane = 0.0
    for face in faces_of(wet, TopAbs_FACE):
        found = BRepAdaptor_Surface(TopoDS.Face(face))
        if found.GetType() != GeomAbs_Plane:
            continue
        flat = found.Plane()
        if abs(flat.Axis().Direction().Z()) > 1 - 1e-12 and abs(flat.Location().Z() - level) < 1e-7:
            area = GProp_GProps()
            BRepGProp.SurfaceProperties_s(face, area, 1e-9)
            plane += area.Mass()
    c = solid.CentreOfMass()
    return solid.Mass(), skin.Mass() - plane, plane, (c.X(), c.Y(), c.Z())


@pytest.mark.parametrize("seed", range(200 if SOAK else 4))
def test_parts_of_files_float_as_in_occt(seed: int, tmp_path: Path) -> None:
    from moldloft.cad.importing import program

    rng = random.Random(4300 + seed)
    name = list(occt_parts.PARTS)[seed % len(occt_parts.PARTS)]
    shape = turned(occt_parts.PARTS[name](rng), rng)
    text, _ = program(occt_parts.write(tmp_path / "part.step", "MM", shape), units="mm")
    model = moldloft.loads(text)
    low, high = heights(shape)
    for _ in range(2):
        level = low + (high - low) * rng.uniform(0.1, 0.9)
        volume, wetted, plane, centre = below(shape, level)
        found = model.hydrostatics(level=level)
        assert not found.on_triangles and found.open_edges == 0, name
        size = high - low
        # OCCT's cut is exact to about 1e-7 of a length.
        near = 1e-7 * wetted
        what = f"{name} at {level}: {found.volume} {volume}, {found.bounds}"
        assert abs(found.volume - volume) <= found.bounds["volume"] + near, what
        assert found.volume == pytest.approx(volume, rel=1e-6, abs=near), what
        assert found.wetted_area == pytest.approx(wetted, rel=2e-6), what
        assert found.waterplane_area == pytest.approx(plane, rel=2e-6, abs=1e-6 * wetted), what
        assert found.bounds["volume"] < 1e-4 * volume + near, what
        buoyancy = (found.lcb, found.tcb, found.vcb)
        assert buoyancy == pytest.approx(centre, abs=2e-6 * size), what
