"""Ordinary parts as CAD programs make them, by OCCT: holes, rounds, lofts, pipes, shells."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

UNITS = {"MM": 1e-3, "INCH": 0.0254, "M": 1.0}
"""Units of files, in metres."""


def _box(a: float, b: float, c: float) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

    return BRepPrimAPI_MakeBox(a, b, c).Shape()


def _rod(x: float, y: float, z: float, r: float, h: float, along: str = "z") -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    direction = gp_Dir(*(float(along == k) for k in "xyz"))
    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, y, z), direction), r, h).Shape()


def _cut(shape: Any, *tools: Any) -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    for tool in tools:
        shape = BRepAlgoAPI_Cut(shape, tool).Shape()
    return shape


def _edges(shape: Any) -> list[Any]:
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopoDS import TopoDS

    from moldloft.cad.sewing import faces_of

    return [TopoDS.Edge(e) for e in faces_of(shape, TopAbs_EDGE)]


def _upright(edge: Any) -> bool:
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.GeomAbs import GeomAbs_Line

    curve = BRepAdaptor_Curve(edge)
    return bool(curve.GetType() == GeomAbs_Line and abs(curve.Line().Direction().Z()) > 0.999)


def _sizes(rng: random.Random) -> tuple[float, float, float]:
    return rng.uniform(60, 200), rng.uniform(40, 100), rng.uniform(8, 40)


def flange(rng: random.Random) -> Any:
    """A disc with a bore and a ring of holes."""
    r, h, n = rng.uniform(40, 80), rng.uniform(6, 20), rng.randint(3, 8)
    holes = [
        _rod(0.7 * r * math.cos(2 * math.pi * k / n), 0.7 * r * math.sin(2 * math.pi * k / n), -1,
             0.1 * r, h + 2)
        for k in range(n)
    ]  # fmt: skip
    return _cut(_rod(0, 0, 0, r, h), _rod(0, 0, -1, 0.4 * r, h + 2), *holes)


def rounded_plate(rng: random.Random) -> Any:
    """A plate with rounded upright edges and a hole."""
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet

    a, b, c = _sizes(rng)
    plate = _box(a, b, c)
    fillet = BRepFilletAPI_MakeFillet(plate)
    for edge in filter(_upright, _edges(plate)):
        fillet.Add(0.2 * b, edge)
    return _cut(fillet.Shape(), _rod(a / 2, b / 2, -1, 0.2 * b, c + 2))


def chamfered(rng: random.Random) -> Any:
    """A block whose edges are all chamfered."""
    from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer

    block = _box(*_sizes(rng))
    chamfer = BRepFilletAPI_MakeChamfer(block)
    for edge in _edges(block):
        chamfer.Add(1.5, edge)
    return chamfer.Shape()


def loft(rng: random.Random) -> Any:
    """A solid through a rectangle, a circle and a smaller circle."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
    from OCP.BRepOffsetAPI import BRepOffsetAPI_ThruSections
    from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt

    made = BRepOffsetAPI_ThruSections(True, False)
    for z, r in [
        (0.0, 30.0),
        (rng.uniform(20, 40), rng.uniform(15, 40)),
        (80.0, rng.uniform(10, 30)),
    ]:
        circle = gp_Circ(gp_Ax2(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)), r)
        made.AddWire(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire())
    return made.Shape()


def prism_loft(rng: random.Random) -> Any:
    """A ruled solid between two polygons."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakePolygon
    from OCP.BRepOffsetAPI import BRepOffsetAPI_ThruSections
    from OCP.gp import gp_Pnt

    n, turn = rng.randint(3, 7), rng.uniform(0, 0.5)
    made = BRepOffsetAPI_ThruSections(True, True)
    for z, r, t in [(0.0, 30.0, 0.0), (rng.uniform(20, 90), rng.uniform(10, 50), turn)]:
        wire = BRepBuilderAPI_MakePolygon()
        for k in range(n):
            at = 2 * math.pi * k / n + t
            wire.Add(gp_Pnt(r * math.cos(at), r * math.sin(at), z))
        wire.Close()
        made.AddWire(wire.Wire())
    return made.Shape()


def pipe(rng: random.Random) -> Any:
    """A round bar along a line, an arc and a line."""
    from OCP.BRepBuilderAPI import (
        BRepBuilderAPI_MakeEdge,
        BRepBuilderAPI_MakeFace,
        BRepBuilderAPI_MakeWire,
    )
    from OCP.BRepOffsetAPI import BRepOffsetAPI_MakePipe
    from OCP.GC import GC_MakeArcOfCircle
    from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt

    bend, r = rng.uniform(30, 60), rng.uniform(4, 12)
    turn = gp_Pnt(100 + bend * math.sin(math.pi / 4), bend * (1 - math.cos(math.pi / 4)), 0)
    ends = gp_Pnt(100, 0, 0), gp_Pnt(100 + bend, bend, 0)
    spine = BRepBuilderAPI_MakeWire()
    spine.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), ends[0]).Edge())
    spine.Add(BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(ends[0], turn, ends[1]).Value()).Edge())
    spine.Add(BRepBuilderAPI_MakeEdge(ends[1], gp_Pnt(100 + bend, bend + 70, 0)).Edge())
    circle = gp_Circ(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), r)
    wire = BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle).Edge()).Wire()
    return BRepOffsetAPI_MakePipe(spine.Wire(), BRepBuilderAPI_MakeFace(wire).Face()).Shape()


def tray(rng: random.Random) -> Any:
    """A box hollowed from its top."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeThickSolid
    from OCP.collections import List_TopoDS_Shape
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopoDS import TopoDS

    from moldloft.cad.sewing import faces_of

    a, b, c = _sizes(rng)
    box = _box(a, b, c)
    top = List_TopoDS_Shape()
    for face in faces_of(box, TopAbs_FACE):
        plane = BRepAdaptor_Surface(TopoDS.Face(face)).Plane()
        if abs(plane.Axis().Direction().Z()) > 0.9 and plane.Location().Z() > 0.5 * c:
            top.Append(face)
    made = BRepOffsetAPI_MakeThickSolid()
    made.MakeThickSolidByJoin(box, top, -rng.uniform(1, 3), 1e-3)
    return made.Shape()


def turned(rng: random.Random) -> Any:
    """A turned part with steps, a cone and a groove."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt

    r = [rng.uniform(5, 30) for _ in range(3)]
    profile = [
        (2, 0),
        (r[0], 0),
        (r[0], 10),
        (r[1], 15),
        (r[1], 30),
        (r[2], 30),
        (r[2], 45),
        (2, 45),
    ]
    wire = BRepBuilderAPI_MakePolygon()
    for x, z in profile:
        wire.Add(gp_Pnt(x, 0, z))
    wire.Close()
    axis = gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
    return BRepPrimAPI_MakeRevol(BRepBuilderAPI_MakeFace(wire.Wire()).Face(), axis).Shape()


def cross(rng: random.Random) -> Any:
    """Two rods through one another, of different radii."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse

    r = rng.uniform(10, 20)
    one, other = _rod(0, 0, -50, r, 100), _rod(-60, 0, 0, rng.uniform(0.4, 0.9) * r, 120, "x")
    return BRepAlgoAPI_Fuse(one, other).Shape()


def dome(rng: random.Random) -> Any:
    """A ball cut flat, with a blind hole."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere

    r = rng.uniform(20, 60)
    ball = BRepPrimAPI_MakeSphere(r).Shape()
    flat = _cut(ball, _moved(_box(4 * r, 4 * r, 2 * r), -2 * r, -2 * r, -2.5 * r))
    return _cut(flat, _rod(0, 0, 0.4 * r, 0.2 * r, r))


def _moved(shape: Any, x: float, y: float, z: float) -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
    from OCP.gp import gp_Trsf, gp_Vec

    move = gp_Trsf()
    move.SetTranslation(gp_Vec(x, y, z))
    return BRepBuilderAPI_Transform(shape, move, True).Shape()


_ALL = (
    flange, rounded_plate, chamfered, loft, prism_loft, pipe, tray, turned, cross, dome,
)  # fmt: skip

PARTS: dict[str, Callable[[random.Random], Any]] = {made.__name__: made for made in _ALL}


def measures(shape: Any) -> tuple[float, float]:
    """Area and volume, in square and cubic millimetres."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    area, volume = GProp_GProps(), GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, area, 1e-9)
    BRepGProp.VolumePropertiesGK_s(shape, volume, 1e-8)
    return area.Mass(), volume.Mass()


def write(path: Path, unit: str, *shapes: Any) -> Path:
    """A STEP or IGES file of shapes in millimetres, stated in a unit."""
    from OCP.Interface import Interface_Static

    from moldloft.cad.occt import _quiet

    with _quiet():
        if path.suffix == ".igs":
            from OCP.IGESControl import IGESControl_Controller, IGESControl_Writer

            IGESControl_Controller.Init_s()
            iges = IGESControl_Writer(unit, 0)
            for shape in shapes:
                iges.AddShape(shape)
            iges.Write(str(path))
        else:
            from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

            step = STEPControl_Writer()
            Interface_Static.SetCVal_s("write.step.unit", unit)
            for shape in shapes:
                step.Transfer(shape, STEPControl_AsIs)
            step.Write(str(path))
            Interface_Static.SetCVal_s("write.step.unit", "MM")
    return path
