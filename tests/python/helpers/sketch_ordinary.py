"""Ordinary parts at random sizes: their commands, and OCCT's solid of the same construction."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
SECTIONS = {"x": "YZ", "y": "XZ", "z": "XY"}

Place = tuple[float, float, float]


@dataclass
class Tool:
    """An object of the sketch and the solid that it is."""

    name: str
    text: str
    solid: Any


def box(name: str, at: Place, size: Place) -> Tool:
    """A block from its lowest corner."""
    a, b, c = size
    text = f"SKETCH {name} 2D XY; RECTANGLE {a!r} {b!r}; EXTRUDE {name} {c!r}\n"
    text += "MOVE {} {!r} {!r} {!r}\n".format(name, *at)
    return Tool(name, text, BRepPrimAPI_MakeBox(gp_Pnt(*at), a, b, c).Shape())


def rod(name: str, along: str, radius: float, at: Place, length: float) -> Tool:
    """A cylinder from the centre of its first end."""
    text = f"SKETCH {name} 2D {SECTIONS[along]}; CIRCLE DIAMETER {2 * radius!r} AT 0 0\n"
    text += f"EXTRUDE {name} {length!r}\n" + "MOVE {} {!r} {!r} {!r}\n".format(name, *at)
    frame = gp_Ax2(gp_Pnt(*at), gp_Dir(*AXES[along]))
    return Tool(name, text, BRepPrimAPI_MakeCylinder(frame, radius, length).Shape())


def turned(tool: Tool, along: str, degrees: float, at: Place) -> Tool:
    """The tool turned about an axis through a point."""
    turn = gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(*at), gp_Dir(*AXES[along])), math.radians(degrees))
    line = "ROTATE {} {} {!r} THROUGH {!r} {!r} {!r}\n".format(
        tool.name, along.upper(), degrees, *at
    )
    solid = BRepBuilderAPI_Transform(tool.solid, turn, True).Shape()
    return Tool(tool.name, tool.text + line, solid)


def combined(kind: str, name: str, a: Tool, b: Tool) -> Tool:
    made = {"UNION": BRepAlgoAPI_Fuse, "CUT": BRepAlgoAPI_Cut, "COMMON": BRepAlgoAPI_Common}[kind]
    text = a.text + b.text + f"{kind} {a.name} {b.name} INTO {name}\n"
    return Tool(name, text, made(a.solid, b.solid).Shape())


def joined(name: str, a: Tool, *others: Tool) -> Tool:
    for k, b in enumerate(others):
        a = combined("UNION", name if k + 1 == len(others) else f"{name}{k}J", a, b)
    return a


def cut(name: str, a: Tool, *others: Tool) -> Tool:
    for k, b in enumerate(others):
        a = combined("CUT", name if k + 1 == len(others) else f"{name}{k}C", a, b)
    return a


def measures(solid: Any) -> tuple[float, float]:
    """Volume and area."""
    volume, area = GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, volume, 1e-10)
    BRepGProp.SurfaceProperties_s(solid, area, 1e-10)
    return volume.Mass(), area.Mass()


class Sizes:
    """Random sizes: whole numbers half the time, so that surfaces are often level or touch."""

    def __init__(self, seed: str) -> None:
        self.random = random.Random(seed)
        self.digits = 0 if self.random.random() < 0.5 else 2

    def __call__(self, low: float, high: float) -> float:
        return float(round(self.random.uniform(low, high), self.digits))

    def count(self, low: int, high: int) -> int:
        return self.random.randint(low, high)

    def shuffled(self, items: list[Tool]) -> list[Tool]:
        return self.random.sample(items, len(items))

    def pick(self, *items: Any) -> Any:
        return self.random.choice(items)


def round_end(n: Sizes, proud: float = 0.0) -> tuple[Tool, float, float, float]:
    r, t, h = n(8, 30), n(5, 40), n(30, 70)
    block = box("M", (-r, 0.0, 0.0), (2 * r, t, h))
    disc = rod("C", "y", r, (0.0, -proud, h), t + 2 * proud)
    pair = [block, disc] if n.pick(True, False) else [disc, block]
    return joined("L", *pair), r, t, h


def rounded_end(n: Sizes) -> Tool:
    return round_end(n)[0]


def proud_disc(n: Sizes) -> Tool:
    return round_end(n, 1.0)[0]


def lug(n: Sizes) -> Tool:
    body, r, t, h = round_end(n)
    bore = rod("D", "y", n(2, 0.6 * r), (0.0, -2.0, h), t + 4.0)
    foot = box("F", (-r - 12.0, 0.0, -8.0), (2 * r + 24.0, t, 8.0))
    return joined("P", cut("N", body, bore), foot)


def clevis(n: Sizes) -> Tool:
    body, r, t, h = round_end(n)
    gap = n(2, 0.5 * t)
    fork = box("G", (-r - 1.0, (t - gap) / 2, n(8, 20)), (2 * r + 2.0, gap, h + r))
    bore = rod("D", "y", n(2, 0.6 * r), (0.0, -1.0, h), t + 2.0)
    shank = rod("S", "z", n(1, 0.4 * min(t, 2 * r)), (0.0, t / 2, -20.0), 20.0)
    tools = n.shuffled([fork, bore])
    return joined("P", cut("N", body, *tools), shank)


def slot(n: Sizes) -> Tool:
    r, t, x, y, s = n(2, 8), n(4, 12), n(12, 25), n(12, 40), n(5, 50)
    plate = box("A", (0.0, 0.0, 0.0), (90.0, 55.0, t))
    parts = [
        box("M", (x, y - r, -1.0), (s, 2 * r, t + 2.0)),
        rod("B", "z", r, (x, y, -1.0), t + 2.0),
        rod("C", "z", r, (x + s, y, -1.0), t + 2.0),
    ]
    parts = n.shuffled(parts)
    if n.pick(True, False):
        return cut("P", plate, joined("S", *parts))
    return cut("P", plate, *parts)


def plate(n: Sizes) -> Tool:
    return box("A", (0.0, 0.0, 0.0), (120.0, 80.0, n(4, 15)))


def row(n: Sizes) -> Tool:
    x, y, r, k = n(10, 20), n(10, 60), n(2, 6), n.count(2, 5)
    step = n(13, 22)
    dy = n.pick(0.0, 0.0, n(-2, 2))
    holes = [rod(f"H{j}", "z", r, (x + j * step, y + j * dy, -1.0), 30.0) for j in range(k)]
    return cut("P", plate(n), *n.shuffled(holes))


def grid(n: Sizes) -> Tool:
    x, y, p, q = n(10, 15), n(10, 15), n(14, 30), n(14, 30)
    radii = [n(2, 6)] * 6 if n.pick(True, False) else [n(2, 6) for _ in range(6)]
    places = [(x + i * p, y + j * q) for i in range(3) for j in range(2)]
    holes = [rod(f"H{k}", "z", radii[k], (*at, -1.0), 30.0) for k, at in enumerate(places)]
    return cut("P", plate(n), *n.shuffled(holes))


def polar(n: Sizes) -> Tool:
    big, t, k, first = n(40, 60), n(5, 20), n.count(3, 8), n.pick(0.0, 0.0, n(0, 90))
    disc = rod("A", "z", big, (0.0, 0.0, 0.0), t)
    ring, r = n(22, 32), n(2, 6)
    holes = []
    for j in range(k):
        hole = rod(f"H{j}", "z", r, (ring, 0.0, -1.0), t + 2.0)
        holes.append(turned(hole, "z", first + 360.0 * j / k, (0.0, 0.0, 0.0)))
    bore = rod("I", "z", n(4, 14), (0.0, 0.0, -1.0), t + 2.0)
    return cut("P", disc, *n.shuffled([*holes, bore]))


def two_bars(n: Sizes, *, equal: bool) -> tuple[list[Tool], float, float, Place]:
    r = n(6, 20)
    q = r if equal else n(3, 20)
    long, wide = n(30, 50), n(30, 50)
    at = (n(-9, 9), n(-9, 9), n(-9, 9)) if n.pick(True, False) else (0.0, 0.0, 0.0)
    a = rod("A", "x", r, (at[0] - long, at[1], at[2]), 2 * long)
    b = rod("B", "y", q, (at[0], at[1] - wide, at[2]), 2 * wide)
    return [a, b], r, q, at


def equal_cross(n: Sizes) -> Tool:
    bars, *_ = two_bars(n, equal=True)
    return joined("P", *n.shuffled(bars))


def unequal_cross(n: Sizes) -> Tool:
    bars, *_ = two_bars(n, equal=False)
    return joined("P", *n.shuffled(bars))


def tee(n: Sizes) -> Tool:
    r = n(8, 20)
    q = r if n.pick(True, False) else n(3, 20)
    a = rod("A", "x", r, (-50.0, 0.0, 0.0), 100.0)
    b = rod("B", "z", q, (n(-10, 10), 0.0, 0.0), n(30, 60))
    return joined("P", *n.shuffled([a, b]))


def bored_cross(n: Sizes) -> Tool:
    (a, b), r, q, at = two_bars(n, equal=n.pick(True, False))
    body = joined("U", a, b)
    i = n(1, max(1.0, 0.8 * r))
    j = i if n.pick(True, False) else n(1, max(1.0, 0.8 * q))
    bores = [
        rod("C", "x", i, (-80.0, *at[1:]), 160.0),
        rod("D", "y", j, (at[0], -80.0, at[2]), 160.0),
    ]
    return cut("P", body, *n.shuffled(bores)[: n.count(1, 2)])


def off_centre_cross(n: Sizes) -> Tool:
    r, q = n(8, 20), n(5, 20)
    off = n(0, 12)
    a = rod("A", "x", r, (-50.0, 0.0, 0.0), 100.0)
    b = rod("B", "y", q, (0.0, -50.0, off), 100.0)
    body = joined("U", *n.shuffled([a, b]))
    bores = [
        rod("C", "x", n(1, 0.8 * r), (-80.0, 0.0, 0.0), 160.0),
        rod("D", "y", n(1, 0.8 * q), (0.0, -80.0, off), 160.0),
    ]
    return cut("P", body, *n.shuffled(bores)[: n.count(0, 2)])


def pipes(n: Sizes) -> Tool:
    r, q = n(10, 20), n(5, 20)
    s, p = r - n(1, 4), q - n(1, 4)
    off = n.pick(0.0, 0.0, n(0, 10))
    a = rod("A", "x", r, (-50.0, 0.0, 0.0), 100.0)
    b = rod("B", "y", q, (0.0, 0.0, off), 55.0)
    i = rod("I", "x", s, (-50.0, 0.0, 0.0), 100.0)
    j = rod("J", "y", p, (0.0, 0.0, off), 55.0)
    return cut("P", joined("U", a, b), *n.shuffled([i, j]))


def bored_pipes(n: Sizes) -> Tool:
    """Pipes united, and bored again where each reaches into the other."""
    r, q = n(10, 20), n(5, 20)
    s, p = r - n(1, 4), q - n(1, 4)
    off = n.pick(0.0, 0.0, n(0, 10))
    a = rod("A", "x", r, (-50.0, 0.0, 0.0), 100.0)
    b = rod("B", "y", q, (0.0, 0.0, off), 55.0)
    first, second = [rod(name, "x", s, (-50.0, 0.0, 0.0), 100.0) for name in ("I", "K")]
    third, fourth = [rod(name, "y", p, (0.0, 0.0, off), 55.0) for name in ("J", "L")]
    both = joined("U", *n.shuffled([cut("V", a, first), cut("W", b, third)]))
    return cut("P", both, *n.shuffled([second, fourth]))


def inner_posts(n: Sizes) -> Tool:
    r, post, t = n(20, 40), n(2, 6), n(3, 9)
    h = t + n(5, 20)
    floor = rod("A", "z", r, (0.0, 0.0, 0.0), t)
    off = r - post
    places = [(off, 0.0), (0.0, off), (-off, 0.0), (0.0, -off)]
    posts = [rod(f"H{k}", "z", post, (*at, 0.0), h) for k, at in enumerate(places)]
    return joined("P", floor, *n.shuffled(posts)[: n.count(1, 4)])


def wall_posts(n: Sizes) -> Tool:
    r, wall, post, h, floor = n(18, 40), n(2, 4), n(2, 5), n(8, 20), 2.0
    inner, k = r - wall, n.count(1, 4)
    first = n.pick(0.0, 30.0, 45.0, 7.0, 88.0, n(1, 89))
    cup = cut(
        "C",
        rod("A", "z", r, (0.0, 0.0, 0.0), h),
        rod("I", "z", inner, (0.0, 0.0, floor), h),
    )
    posts = []
    for j in range(k):
        post_ = rod(f"S{j}", "z", post, (inner - post, 0.0, 0.0), h)
        posts.append(turned(post_, "z", first + 360.0 * j / k, (0.0, 0.0, 0.0)))
    return joined("P", cup, *n.shuffled(posts))


def keyway(n: Sizes) -> Tool:
    r, b, long = n(10, 30), n(2, 4), n(10, 25)
    depth = round(n.random.uniform(1, 4), 2)
    shaft = rod("A", "z", r, (0.0, 0.0, 0.0), 60.0)
    at = n.pick(-1.0, 8.0)
    tools = [box("M", (-b, r - depth, at), (2 * b, 20.0, long))]
    tools.append(rod("C", "y", b, (0.0, r - depth, at + long), 20.0))
    if at > 0:
        tools.append(rod("D", "y", b, (0.0, r - depth, at), 20.0))
    tools = n.shuffled(tools)
    if n.pick(True, False):
        return cut("P", shaft, joined("T", *tools))
    return cut("P", shaft, *tools)


def edge_bosses(n: Sizes) -> Tool:
    t, r, up = n(4, 12), n(5, 14), n(3, 15)
    x = n.pick(0.0, r, n(0, 10))
    y = n.pick(0.0, r, n(20, 40))
    base = box("A", (0.0, 0.0, 0.0), (90.0, 60.0, t))
    boss = rod("B", "z", r, (x, y, n.pick(0.0, t)), t + up)
    body = joined("U", *n.shuffled([base, boss]))
    return cut("P", body, rod("D", "z", n(1, 0.7 * r), (x, y, -1.0), 60.0))


def counterbores(n: Sizes) -> Tool:
    t, r, x, y = n(8, 20), n(2, 4), n(20, 30), n(20, 40)
    big, deep, apart = n(5, 9), n(2, 6), n(5, 19)
    dy = n.pick(0.0, n(-5, 5))
    tools = [
        rod("C", "z", r, (x, y, -1.0), 40.0),
        rod("D", "z", r, (x + apart, y + dy, -1.0), 40.0),
        rod("E", "z", big, (x, y, t - deep), 40.0),
        rod("F", "z", big, (x + apart, y + dy, t - n.pick(deep, n(2, 6))), 40.0),
    ]
    return cut("P", box("A", (0.0, 0.0, 0.0), (90.0, 60.0, t)), *n.shuffled(tools))


def edge_holes(n: Sizes) -> Tool:
    t, r = n(4, 12), n(3, 12)
    x = n.pick(0.0, r, -r + 1.0, n(-2, 12))
    tools = [
        rod("C", "z", r, (x, n(15, 45), n.pick(-1.0, 2.0)), 40.0),
        rod("D", "z", n(3, 9), (n(20, 85), n.pick(0.0, 60.0, n(0, 8)), -1.0), 40.0),
    ]
    return cut("P", box("A", (0.0, 0.0, 0.0), (90.0, 60.0, t)), *n.shuffled(tools))


def touching_posts(n: Sizes) -> Tool:
    r, q = n(4, 12), n(4, 12)
    at, h = (n(20, 40), n(20, 40)), n(5, 20)
    base = box("A", (0.0, 0.0, 0.0), (100.0, 60.0, n(4, 10)))
    post = rod("B", "z", r, (*at, 0.0), 10.0 + h)
    other = rod(
        "C", "z", q, (at[0] + r + q - n.pick(1.0, 0.5, n(1, 3)), at[1], 0.0), 10.0 + n(5, 20)
    )
    return joined("P", base, *n.shuffled([post, other]))


def cross_drilled(n: Sizes) -> Tool:
    r = n(8, 20)
    shaft = rod("A", "z", r, (0.0, 0.0, 0.0), 80.0)
    bore = rod("B", "z", n(2, 0.6 * r), (0.0, 0.0, n.pick(-1.0, 30.0)), 90.0)
    k = n.count(1, 3)
    tools: list[Tool] = [bore]
    for j in range(k):
        q = n(1, 5)
        tool = rod(
            f"H{j}", "x", q, (n.pick(-30.0, 0.0), n.pick(0.0, 0.0, n(-4, 4)), n(8, 70)), 60.0
        )
        tools.append(turned(tool, "z", n.pick(0.0, 90.0, 120.0, n(0, 360)), (0.0, 0.0, 0.0)))
    return cut("P", shaft, *n.shuffled(tools))


def oblique_hole(n: Sizes) -> Tool:
    t = n(10, 30)
    hole = rod("B", "z", n(2, 8), (45.0, 30.0, -80.0), 200.0)
    hole = turned(hole, n.pick("x", "y"), n(5, 50), (45.0, 30.0, t))
    upright = rod("C", "z", n(2, 8), (n(40, 60), 30.0, -1.0), 60.0)
    return cut("P", box("A", (0.0, 0.0, 0.0), (90.0, 60.0, t)), *n.shuffled([hole, upright]))


def stepped_shaft(n: Sizes) -> Tool:
    radii = [n(8, 20) for _ in range(4)]
    lengths = [n(6, 25) for _ in range(4)]
    parts, z = [], 0.0
    for k in range(4):
        parts.append(rod(f"S{k}", "z", radii[k], (0.0, 0.0, z), lengths[k]))
        z += lengths[k]
    flat = box("F", (radii[1] - n(1, 3), -30.0, lengths[0]), (60.0, 60.0, lengths[1]))
    return cut("P", joined("U", *parts), flat)


FAMILIES: dict[str, Callable[[Sizes], Tool]] = {
    "rounded end": rounded_end,
    "proud disc": proud_disc,
    "lug": lug,
    "clevis": clevis,
    "slot": slot,
    "row": row,
    "grid": grid,
    "polar": polar,
    "equal cross": equal_cross,
    "unequal cross": unequal_cross,
    "tee": tee,
    "bored cross": bored_cross,
    "off-centre cross": off_centre_cross,
    "pipes": pipes,
    "bored pipes": bored_pipes,
    "inner posts": inner_posts,
    "wall posts": wall_posts,
    "keyway": keyway,
    "edge bosses": edge_bosses,
    "counterbores": counterbores,
    "edge holes": edge_holes,
    "touching posts": touching_posts,
    "cross-drilled shaft": cross_drilled,
    "oblique holes": oblique_hole,
    "stepped shaft": stepped_shaft,
}


def read_step(path: Any) -> Any:
    """The shape of a STEP file."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    return reader.OneShape()


def read_volume(path: Any) -> float:
    """The volume of a STEP file's solids, in its own unit of millimetres."""
    return measures(read_step(path))[0]
