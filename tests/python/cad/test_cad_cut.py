"""The yacht in another program: imported from STEP, closed at the water plane and cut in two.

By the kernel that CadQuery is made of, and by CadQuery itself where it is installed.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import moldloft

pytest.importorskip("OCP")

YACHT = Path(__file__).parents[3] / "examples" / "sailboat" / "yacht.sdl"
FOOT = 304.8

#: The cut, between keel and rudder, and what is wider than any yacht, in millimetres.
AFT, FAR = 20 * FOOT, 100e3


def by_cadquery(path: Path) -> tuple[float, float, float, bool]:
    """Volumes of the yacht, of what is forward of the cut and of what is aft; all valid?"""
    cq = pytest.importorskip("cadquery")
    faces = cq.importers.importStep(str(path)).faces().vals()
    edges = [e for f in faces for e in f.Edges()]
    # Edges of one face alone bound the lid.
    rim = [e for e in edges if sum(e.isSame(o) for o in edges) == 1]
    lid = cq.Face.makeFromWires(cq.Wire.assembleEdges(rim))
    hull = cq.Workplane(cq.Solid.makeSolid(cq.Shell.makeShell([*faces, lid])))
    box = cq.Workplane().box(FAR, 2 * FAR, 2 * FAR).translate((AFT + FAR / 2, 0, 0))
    shapes = [hull.val(), hull.cut(box).val(), hull.intersect(box).val()]
    # CadQuery's own volumes are by few places.
    whole, fore, aft = (volume(s.wrapped) for s in shapes)
    return whole, fore, aft, all(s.isValid() for s in shapes)


def volume(shape: object) -> float:
    """By the kernel's integrals."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    figures = GProp_GProps()
    BRepGProp.VolumePropertiesGK_s(shape, figures, 1e-6)
    return abs(float(figures.Mass()))


def by_kernel(path: Path) -> tuple[float, float, float, bool]:
    """The same by OCCT."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepLib import BRepLib
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt
    from OCP.ShapeAnalysis import ShapeAnalysis_FreeBounds
    from OCP.TopAbs import TopAbs_SHELL, TopAbs_WIRE
    from OCP.TopoDS import TopoDS, TopoDS_Solid

    from cad_reading import _unique, read

    # One thousandth of a metre for the unit: in millimetres.
    shape = read(path, unit=1e-3, accuracy=1e-3).shape
    (rim,) = _unique(ShapeAnalysis_FreeBounds(shape).GetClosedWires(), TopAbs_WIRE)
    sewing = BRepBuilderAPI_Sewing(1e-3)
    sewing.Add(shape)
    sewing.Add(BRepBuilderAPI_MakeFace(TopoDS.Wire(rim), True).Face())
    sewing.Perform()
    (shell,) = _unique(sewing.SewedShape(), TopAbs_SHELL)
    hull = TopoDS_Solid()
    BRep_Builder().MakeSolid(hull)
    BRep_Builder().Add(hull, shell)
    BRepLib.OrientClosedSolid_s(hull)
    box = BRepPrimAPI_MakeBox(gp_Pnt(AFT, -FAR, -FAR), gp_Pnt(AFT + FAR, FAR, FAR)).Shape()
    shapes = [hull, BRepAlgoAPI_Cut(hull, box).Shape(), BRepAlgoAPI_Common(hull, box).Shape()]
    whole, fore, aft = (volume(s) for s in shapes)
    return whole, fore, aft, all(BRepCheck_Analyzer(s).IsValid() for s in shapes)


@pytest.mark.parametrize("program", [by_kernel, by_cadquery])
def test_the_yacht_is_imported_and_cut(
    program: Callable[[Path], tuple[float, float, float, bool]], tmp_path: Path
) -> None:
    model = moldloft.load(YACHT)
    (path,) = model.write(tmp_path / "yacht.step")
    whole, fore, aft, valid = program(path)
    assert valid and fore > 0.05 * whole and aft > 0.05 * whole
    assert fore + aft == pytest.approx(whole, rel=1e-5)
    # The water that the yacht displaces, by integrals of ours.
    assert whole / FOOT**3 == pytest.approx(model.hydrostatics().volume, rel=1e-4)
