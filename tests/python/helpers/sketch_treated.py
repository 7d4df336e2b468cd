"""Drilled, rounded and hollow parts: their commands, and OCCT's solid of the same numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from OCP.BRep import BRep_Tool
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer, BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

from sketch_ordinary import Sizes, Tool, rod


def _rod(x: float, y: float, z: float, r: float, h: float) -> Any:
    frame = gp_Ax2(gp_Pnt(x, y, z), gp_Dir(0, 0, 1))
    return BRepPrimAPI_MakeCylinder(frame, r, h).Shape()


def _without(shape: Any, *tools: Any) -> Any:
    for tool in tools:
        shape = BRepAlgoAPI_Cut(shape, tool).Shape()
    return shape


def _upright(shape: Any) -> list[Any]:
    """The edges along z, each once."""
    found: dict[int, Any] = {}
    walk = TopExp_Explorer(shape, TopAbs_EDGE)
    while walk.More():
        edge = TopoDS.Edge(walk.Current())
        curve = BRep_Tool.Curve_s(edge, 0.0, 1.0)
        along = curve.DN(0.5, 1)
        if abs(along.Z()) > 0.999:
            found.setdefault(hash(edge), edge)
        walk.Next()
    return list(found.values())


def _block(name: str, a: float, b: float, c: float) -> str:
    return f"SKETCH {name} 2D XY; RECTANGLE {a!r} {b!r}; EXTRUDE {name} {c!r}\n"


def drilled_flange(n: Sizes) -> Tool:
    """A flange with a bore and a bolt circle, by HOLE."""
    r, t, bore, d, k = n(50, 60), n(8, 20), n(20, 40), n(4, 9), n.count(3, 8)
    ring = n(36, 42)
    text = rod("A", "z", r, (0.0, 0.0, 0.0), t).text
    text += f"HOLE A {bore!r} AT 0 0 INTO B\n"
    text += f"HOLE B {d!r} AT {ring!r} 0 POLAR {k} {360 / k!r} INTO P\n"
    tools = [_rod(0, 0, -1, bore / 2, t + 2)]
    for j in range(k):
        a = 2 * math.pi * j / k
        tools.append(_rod(ring * math.cos(a), ring * math.sin(a), -1, d / 2, t + 2))
    return Tool("P", text, _without(_rod(0, 0, 0, r, t), *tools))


def sunk_plate(n: Sizes) -> Tool:
    """A plate with a grid of counterbored or countersunk holes, through or blind."""
    t, d, more, deep = n(14, 20), n(4, 7), n(2, 5), n(2, 4)
    p, q, cols, rows = n(15, 22), n(15, 22), n.count(1, 4), n.count(1, 2)
    bored, blind = n.pick(True, False), n.pick(True, False)
    depth = n(10, 13)
    wide = d + 2 * more
    head = f"COUNTERBORE {wide!r} {deep!r}" if bored else f"COUNTERSINK {wide!r} 90"
    text = _block("A", 110.0, 60.0, t)
    text += f"HOLE A {d!r} AT 20 20 {f'DEPTH {depth!r} ' if blind else ''}{head} "
    text += f"LINEAR {cols} {p!r} 0 LINEAR {rows} 0 {q!r} INTO P\n"
    tools = []
    for i in range(cols):
        for j in range(rows):
            x, y = 20 + i * p, 20 + j * q
            low = t - depth if blind else -1.0
            tools.append(_rod(x, y, low, d / 2, 40.0))
            if bored:
                tools.append(_rod(x, y, t - deep, wide / 2, 40.0))
            else:
                frame = gp_Ax2(gp_Pnt(x, y, t - more), gp_Dir(0, 0, 1))
                tools.append(BRepPrimAPI_MakeCone(frame, d / 2, wide / 2, more).Shape())
    return Tool("P", text, _without(BRepPrimAPI_MakeBox(110.0, 60.0, t).Shape(), *tools))


def rounded_plate(n: Sizes) -> Tool:
    """A block with four round edges and a hole."""
    a, b, c, r, d = n(50, 90), n(40, 60), n(8, 20), n(3, 9), n(5, 15)
    text = _block("A", a, b, c) + f"FILLET A {r!r} EDGES ALONG Z INTO B\n"
    text += f"HOLE B {d!r} AT 20 20 INTO P\n"
    box = BRepPrimAPI_MakeBox(a, b, c).Shape()
    make = BRepFilletAPI_MakeFillet(box)
    for edge in _upright(box):
        make.Add(r, edge)
    return Tool("P", text, _without(make.Shape(), _rod(20, 20, -1, d / 2, c + 2)))


def bevelled_plate(n: Sizes) -> Tool:
    a, b, c, r, d = n(50, 90), n(40, 60), n(8, 20), n(3, 9), n(5, 15)
    text = _block("A", a, b, c) + f"HOLE A {d!r} AT 20 20 INTO B\n"
    text += f"CHAMFER B {r!r} EDGES ALONG Z INTO P\n"
    box = BRepPrimAPI_MakeBox(a, b, c).Shape()
    make = BRepFilletAPI_MakeChamfer(box)
    for edge in _upright(box):
        make.Add(r, edge)
    return Tool("P", text, _without(make.Shape(), _rod(20, 20, -1, d / 2, c + 2)))


def bin_with_holes(n: Sizes) -> Tool:
    """A shell, open above, with holes in its floor."""
    a, b, c, w, d = n(60, 90), n(40, 60), n(20, 40), n(1, 4), n(3, 8)
    text = _block("A", a, b, c) + f"SHELL A {w!r} OPEN TOP Z INTO B\n"
    text += f"HOLE B {d!r} AT 15 15 LINEAR 2 {n(12, 25)!r} 0 INTO P\n"
    step = float(text.split("LINEAR 2 ")[1].split()[0])
    inner = BRepPrimAPI_MakeBox(gp_Pnt(w, w, w), a - 2 * w, b - 2 * w, c).Shape()
    tools = [inner, *(_rod(15 + k * step, 15, -1, d / 2, c + 2) for k in (0, 1))]
    return Tool("P", text, _without(BRepPrimAPI_MakeBox(a, b, c).Shape(), *tools))


TREATED: dict[str, Callable[[Sizes], Tool]] = {
    "drilled flange": drilled_flange,
    "sunk plate": sunk_plate,
    "rounded plate": rounded_plate,
    "bevelled plate": bevelled_plate,
    "bin with holes": bin_with_holes,
}
