"""Solids of OCCT at random places, with its volume and area."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from numpy.random import Generator

Triple = tuple[float, float, float]


def _axes(rng: Generator, place: Triple) -> Any:
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    return gp_Ax2(gp_Pnt(*place), gp_Dir(*map(float, rng.normal(size=3))))


def _place(rng: Generator) -> Triple:
    x, y, z = map(float, rng.uniform(-2, 2, 3))
    return x, y, z


def ball(rng: Generator, radius: float, place: Triple | None = None) -> Any:
    """A ball with its poles anywhere."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere

    return BRepPrimAPI_MakeSphere(_axes(rng, place or _place(rng)), radius).Shape()


def box(place: Triple, size: Triple) -> Any:
    """A box along the axes."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt

    return BRepPrimAPI_MakeBox(gp_Pnt(*place), *size).Shape()


def _torus(rng: Generator) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus

    return BRepPrimAPI_MakeTorus(_axes(rng, _place(rng)), 5.0, float(rng.uniform(0.5, 3))).Shape()


def _cone(rng: Generator) -> Any:
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone

    end = float(rng.uniform(0.2, 2))
    return BRepPrimAPI_MakeCone(_axes(rng, _place(rng)), 3.0, end, 4.0).Shape()


def cylinder(rng: Generator, radius: float, height: float, place: Triple | None = None) -> Any:
    """A cylinder along a random axis."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder

    axes = _axes(rng, place or _place(rng))
    return BRepPrimAPI_MakeCylinder(axes, radius, height).Shape()


def without(shape: Any, *tools: Any) -> Any:
    """A shape without others."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut

    for tool in tools:
        shape = BRepAlgoAPI_Cut(shape, tool).Shape()
    return shape


def _drilled(rng: Generator) -> Any:
    place = _place(rng)
    return without(ball(rng, 3.0, place), cylinder(rng, 1.0, 6.0, place))


def _two_balls(rng: Generator) -> tuple[Any, Any]:
    x, y, z = place = _place(rng)
    aside = rng.uniform(0.5, 1.5, 3)
    near = (x + float(aside[0]), y + float(aside[1]), z + float(aside[2]))
    return ball(rng, 3.0, place), ball(rng, 2.5, near)


def _bitten(rng: Generator) -> Any:
    return without(*_two_balls(rng))


def _lens(rng: Generator) -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Common

    return BRepAlgoAPI_Common(*_two_balls(rng)).Shape()


def _crossed(rng: Generator) -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse

    place = _place(rng)
    tools = cylinder(rng, 1.5, 8.0, place), cylinder(rng, 1.0, 8.0, place)
    return BRepAlgoAPI_Fuse(*tools).Shape()


_MAKERS: dict[str, Callable[[Generator], Any]] = {
    "ball": lambda rng: ball(rng, 3.0),
    "torus": _torus,
    "cone": _cone,
    "cylinder": lambda rng: cylinder(rng, 2.0, float(rng.uniform(0.5, 30))),
    "drilled ball": _drilled,
    "crossed cylinders": _crossed,
    "bitten ball": _bitten,
    "lens": _lens,
}

#: Names of solids.
SOLIDS = tuple(_MAKERS)


def solid(name: str, rng: Generator) -> Any:
    """The solid of a name."""
    return _MAKERS[name](rng)


def measures(shape: Any) -> tuple[float, float]:
    """OCCT's volume and area."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    volume, area = GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, volume, 1e-9)
    BRepGProp.SurfaceProperties_s(shape, area, 1e-9)
    return float(volume.Mass()), float(area.Mass())


def written(shape: Any, path: Path) -> Path:
    """The shape as STEP, or as IGES with solids."""
    from OCP.IGESControl import IGESControl_Controller, IGESControl_Writer
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    if path.suffix == ".step":
        step = STEPControl_Writer()
        step.Transfer(shape, STEPControl_AsIs)
        step.Write(str(path))
    else:
        IGESControl_Controller.Init_s()
        iges = IGESControl_Writer("MM", 1)
        iges.AddShape(shape)
        iges.ComputeModel()
        iges.Write(str(path))
    return path
