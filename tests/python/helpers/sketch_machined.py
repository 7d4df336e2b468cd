"""Machined parts at random sizes, with cones, balls and rings; and numbers that pass tangency."""

from __future__ import annotations

import re
from collections.abc import Callable

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakePolygon
from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol, BRepPrimAPI_MakeSphere, BRepPrimAPI_MakeTorus
from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Pnt

from sketch_ordinary import AXES, Place, Sizes, Tool, box, combined, cut, joined, rod, turned

# -- primitives about z -----------------------------------------------------------------------


def ball(name: str, radius: float, at: Place) -> Tool:
    """A ball by its centre."""
    r = radius
    text = f"SKETCH {name} 2D XZ; RECTANGLE {r!r} {2 * r!r} AT 0 {-r!r}\n"
    text += f"ARC CORNER 2 1 3 RADIUS {r!r}; ARC CORNER 3 2 4 RADIUS {r!r}\n"
    text += f"GENERATE FACES; REVOLVE {name} 4 360\n" + "MOVE {} {!r} {!r} {!r}\n".format(name, *at)
    return Tool(name, text, BRepPrimAPI_MakeSphere(gp_Pnt(*at), r).Shape())


def cone(name: str, low: float, high: float, height: float, at: Place) -> Tool:
    """A cone about z from the centre of its lower end."""
    text = f"SKETCH {name} 2D XZ; POINT 1 0 0; POINT 2 60 0; POINT 3 40 90; POINT 4 0 90\n"
    text += "LINE 1 2 TYPE X; LINE 2 3 TYPE F; LINE 3 4 TYPE X; LINE 4 1 TYPE Z\n"
    text += f"DIM X 1 2 {low!r}; DIM X 1 3 {high!r}; DIM Z 1 4 {height!r}\n"
    text += f"GENERATE FACES; REVOLVE {name} 4 360\n" + "MOVE {} {!r} {!r} {!r}\n".format(name, *at)
    wire = BRepBuilderAPI_MakePolygon()
    x, y, z = at
    for r, h in ((0.0, 0.0), (low, 0.0), (high, height), (0.0, height)):
        wire.Add(gp_Pnt(x + r, y, z + h))
    wire.Close()
    face = BRepBuilderAPI_MakeFace(wire.Wire()).Face()
    axis = gp_Ax1(gp_Pnt(*at), gp_Dir(*AXES["z"]))
    return Tool(name, text, BRepPrimAPI_MakeRevol(face, axis).Shape())


def ring(name: str, big: float, small: float, at: Place) -> Tool:
    """A torus about z by its centre."""
    text = f"SKETCH {name} 2D XZ; POINT 1 0 -50; POINT 2 0 140; LINE 1 2 TYPE Z\n"
    text += "DIM Z 1 2 9; REFERENCE 1 0 -3\n"
    text += f"CIRCLE DIAMETER {2 * small!r} AT {big!r} 0\n"
    text += f"GENERATE FACES; REVOLVE {name} 1 360\n" + "MOVE {} {!r} {!r} {!r}\n".format(name, *at)
    frame = gp_Ax2(gp_Pnt(*at), gp_Dir(*AXES["z"]))
    return Tool(name, text, BRepPrimAPI_MakeTorus(frame, big, small).Shape())


# -- families ---------------------------------------------------------------------------------


def t_slot(n: Sizes) -> Tool:
    w, d, h = n(50, 90), n(30, 60), n(20, 35)
    neck, head, deep, tall = n(4, 10), n(12, 24), n(5, 9), n(4, 9)
    x = n.pick(w / 2, n(15, 35))
    open_ = n.pick(True, False)
    start, long = (-1.0, d + 2.0) if open_ else (n(8, 12), d)
    tools = [
        box("N", (x - neck / 2, start, h - deep), (neck, long, deep + n.pick(0.0, 1.0))),
        box("K", (x - head / 2, start, h - deep - tall), (head, long, tall)),
    ]
    if not open_:
        tools.append(rod("R", "z", neck / 2, (x, start, h - deep), 2 * deep))
        tools.append(rod("Q", "z", head / 2, (x, start, h - deep - tall), tall))
    block = box("A", (0.0, 0.0, 0.0), (w, d, h))
    tools = n.shuffled(tools)
    return cut("P", block, joined("T", *tools)) if n.pick(True, False) else cut("P", block, *tools)


def bored_pattern(n: Sizes) -> Tool:
    """Counterbored holes in a grid: the holes one by one, or by a PATTERN of a tool."""
    t, r, big = n(10, 20), n(2, 4), n(5, 7)
    deep, p, q, x, y = n(2, 8), n(15, 25), n(15, 25), n(8, 15), n(8, 15)
    tools = []
    for i in range(n.count(1, 3)):
        for j in range(n.count(1, 2)):
            at = (x + i * p, y + j * q)
            tools.append(rod(f"H{i}{j}", "z", r, (*at, n.pick(-1.0, 0.0)), t + 1.0))
            tools.append(rod(f"B{i}{j}", "z", big, (*at, t - deep), n.pick(deep, 30.0)))
    return cut("P", box("A", (0.0, 0.0, 0.0), (90.0, 60.0, t)), *n.shuffled(tools))


def ribbed_boss(n: Sizes) -> Tool:
    t, r, h = n(4, 10), n(8, 15), n(12, 30)
    rib, bore = n(2, 6), n(2, 6)
    x, y = n(30, 50), 30.0
    up = n.pick(h, t + n(2, 6))
    parts = [
        box("A", (0.0, 0.0, 0.0), (90.0, 60.0, t)),
        rod("B", "z", r, (x, y, n.pick(0.0, t)), h),
    ]
    level = n.pick(0.0, t)
    side = n.pick(-rib / 2, r - rib, -r)
    parts.append(box("R", (n.pick(0.0, 5.0), y + side, level), (80.0, rib, up - level + t)))
    if n.pick(True, False):
        parts.append(box("S", (x - rib / 2, n.pick(0.0, 5.0), level), (rib, 50.0, up - level + t)))
    body = joined("U", *n.shuffled(parts))
    return cut("P", body, rod("D", "z", bore, (x, y, n.pick(-1.0, t)), 80.0))


def pocketed_bar(n: Sizes) -> Tool:
    r, b = n(10, 25), n(2, 8)
    bar = rod("A", "x", r, (0.0, 0.0, 0.0), 100.0)
    at, long, floor = n(20, 40), n(10, 30), n.pick(0.0, n(-5, 8))
    tools = [
        box("M", (at, -b, floor), (long, 2 * b, 40.0)),
        rod("C", "z", b, (at, 0.0, floor), 40.0),
        rod("D", "z", b, (at + long, 0.0, floor), 40.0),
    ]
    if n.pick(True, False):
        tools.append(rod("E", "x", n(1, 0.6 * r), (-1.0, 0.0, 0.0), n.pick(102.0, at + 1.0)))
    return cut("P", bar, *n.shuffled(tools))


def flat_bar(n: Sizes) -> Tool:
    """A round bar with flats: opposite, square or a single one, and a cross bore."""
    r = n(10, 25)
    off = n(0.3 * r, r - 1)
    bar = rod("A", "x", r, (0.0, 0.0, 0.0), 90.0)
    at, long = n.pick(-1.0, 20.0), n(10, 30)
    sides = [(off, -40.0), (-off - 40.0, -40.0), (-40.0, off), (-40.0, -off - 40.0)]
    tools = [
        box(f"F{k}", (at, y, z), (long, 40.0 if k < 2 else 80.0, 80.0 if k < 2 else 40.0))
        for k, (y, z) in enumerate(sides)
    ]
    tools = n.shuffled(tools)[: n.count(1, 4)]
    if n.pick(True, False):
        tools.append(rod("E", "y", n(1, 8), (at + long / 2, -40.0, 0.0), 80.0))
    return cut("P", bar, *tools)


def three_bars(n: Sizes) -> Tool:
    r = n(6, 20)
    rods = []
    for k, along in enumerate("xyz"):
        start, long = n.pick((-40.0, 80.0), (0.0, 40.0))
        at = [0.0, 0.0, 0.0]
        at[k] = start
        rods.append(rod("ABC"[k], along, n.pick(r, r, n(6, 20)), (at[0], at[1], at[2]), long))
    return joined("P", *n.shuffled(rods))


def drawn_pin(n: Sizes) -> Tool:
    """Cylinder, cone and ball on one axis, flush where their sizes agree."""
    r, tip = n(6, 12), n(1, 5)
    long, point = n(20, 40), n(4, 15)
    parts = [
        rod("A", "z", r, (0.0, 0.0, 0.0), long),
        cone("K", n.pick(r, n(6, 12)), tip, point, (0.0, 0.0, long)),
    ]
    if n.pick(True, False):
        parts.append(ball("B", n.pick(r, n(7, 13)), (0.0, 0.0, 0.0)))
    body = joined("U", *n.shuffled(parts))
    return cut("P", body, rod("D", "x", n(1, 4), (-40.0, n.pick(0.0, 2.0), n(4, 16)), 80.0))


def countersunk(n: Sizes) -> Tool:
    t, r = n(8, 20), n(2, 5)
    x, y, apart, more = n(15, 30), n(20, 40), n(5, 25), n(1, 5)
    tools = []
    for k in range(2):
        at = (x + k * apart, y)
        tools.append(rod(f"H{k}", "z", r, (*at, -1.0), 40.0))
        tools.append(cone(f"K{k}", r, r + more, more, (*at, t - more)))
    return cut("P", box("A", (0.0, 0.0, 0.0), (90.0, 60.0, t)), *n.shuffled(tools))


def ball_slot(n: Sizes) -> Tool:
    """A groove by a ball cutter: a cylinder with balls at its ends."""
    r, t = n(2, 7), n(10, 20)
    a, long = n(15, 30), n(10, 40)
    depth = t + n.pick(0.0, n(-1, 1))
    tools = [
        rod("C", "x", r, (a, 30.0, depth), long),
        ball("B", r, (a, 30.0, depth)),
        ball("D", r, (a + long, 30.0, depth)),
    ]
    block = box("A", (0.0, 0.0, 0.0), (90.0, 60.0, t))
    tools = n.shuffled(tools)
    return cut("P", block, joined("T", *tools)) if n.pick(True, False) else cut("P", block, *tools)


def grooved_shaft(n: Sizes) -> Tool:
    r, groove = n(10, 20), n(1, 4)
    shaft = rod("A", "z", r, (0.0, 0.0, 0.0), 60.0)
    tools = [ring("G", r + n.pick(0.0, n(-1, 1)), groove, (0.0, 0.0, n(10, 25)))]
    if n.pick(True, False):
        tools.append(ring("H", r, n(1, 4), (0.0, 0.0, n(30, 50))))
    tools.append(rod("D", "z", n(2, 5), (0.0, 0.0, -1.0), n.pick(62.0, 40.0)))
    return cut("P", shaft, *n.shuffled(tools))


def halves(n: Sizes) -> Tool:
    """A round solid cut in two by a plane and united again: the same solid."""
    r = n(6, 15)
    kind = n.pick("rod", "cone", "ball", "ring")
    both = []
    plane, off = n.pick("x", "y", "z"), n(-4, 4)
    if kind == "ring" and plane == "z":
        # The plane meets the tube.
        off *= (r / 2 - 0.5) / 4
    for k in "AB":
        made = {
            "rod": lambda k: rod(k, "z", r, (0.0, 0.0, -20.0), 40.0),
            "cone": lambda k: cone(k, r, r + 5.0, 30.0, (0.0, 0.0, -15.0)),
            "ball": lambda k: ball(k, r, (0.0, 0.0, 0.0)),
            "ring": lambda k: ring(k, r + 8.0, r / 2, (0.0, 0.0, 0.0)),
        }[kind](k)
        low = [-50.0, -50.0, -50.0]
        low["xyz".index(plane)] = off - (0.0 if k == "A" else 100.0)
        keep = box(f"W{k}", (low[0], low[1], low[2]), (100.0, 100.0, 100.0))
        both.append(combined("COMMON", f"H{k}", made, keep))
    return joined("P", *n.shuffled(both))


def overlapping_kinds(n: Sizes) -> Tool:
    """Two parts of one cone, ball or ring that overlap or meet."""
    r, more = n(8, 15), n(2, 8)
    kind = n.pick("cone", "ball", "ring")
    shift = n.pick(0.0, n(0, 5))
    both = []
    for k, low, high in (("A", -40.0, shift), ("B", 0.0, 40.0)):
        made = {
            "cone": lambda k: cone(k, r, r + more, 40.0, (0.0, 0.0, -20.0)),
            "ball": lambda k: ball(k, r, (0.0, 0.0, 0.0)),
            "ring": lambda k: ring(k, r + 10.0, more, (0.0, 0.0, 0.0)),
        }[kind](k)
        at = n.pick((low, -40.0, -40.0), (-40.0, -40.0, low))
        size = (high - low, 80.0, 80.0) if at[0] == low else (80.0, 80.0, high - low)
        both.append(combined("COMMON", f"H{k}", made, box(f"W{k}", at, size)))
    return joined("P", *n.shuffled(both))


def cup_with_ball(n: Sizes) -> Tool:
    """A dome: a cylinder with a ball of its radius, hollowed by smaller ones."""
    r, wall, h = n(10, 25), n(1, 4), n(10, 30)
    outer = joined("U", rod("A", "z", r, (0.0, 0.0, 0.0), h), ball("B", r, (0.0, 0.0, h)))
    tools = [
        rod("C", "z", r - wall, (0.0, 0.0, n.pick(-1.0, 0.0)), h + n.pick(1.0, 0.0)),
        ball("D", r - wall, (0.0, 0.0, h)),
    ]
    return cut("P", outer, *n.shuffled(tools))


def plate_with_all(n: Sizes) -> Tool:
    """A plate with a slot, a bolt circle, a boss with rib and a notch."""
    t = n(6, 12)
    plate = box("A", (0.0, 0.0, 0.0), (120.0, 80.0, t))
    boss = rod("B", "z", n(8, 14), (85.0, 40.0, 0.0), t + n(5, 15))
    rib = box("R", (60.0, 38.0, 0.0), (25.0, 4.0, t + 4.0))
    body = joined("U", *n.shuffled([plate, boss, rib]))
    tools = [rod("D", "z", n(2, 6), (85.0, 40.0, -1.0), 80.0)]
    r, x = n(2, 6), n(10, 20)
    tools += [
        box("M", (x, 20.0 - r, -1.0), (20.0, 2 * r, 40.0)),
        rod("S", "z", r, (x, 20.0, -1.0), 40.0),
        rod("T", "z", r, (x + 20.0, 20.0, -1.0), 40.0),
    ]
    k = n.count(2, 5)
    for j in range(k):
        hole = rod(f"H{j}", "z", 2.0, (85.0 + 22.0, 40.0, -1.0), 40.0)
        tools.append(turned(hole, "z", 360.0 * j / k, (85.0, 40.0, 0.0)))
    tools.append(box("N", (-1.0, n.pick(0.0, 60.0), -1.0), (n(4, 12), 20.0, 60.0)))
    return cut("P", body, *n.shuffled(tools))


MACHINED: dict[str, Callable[[Sizes], Tool]] = {
    "t-slot": t_slot,
    "bored pattern": bored_pattern,
    "ribbed boss": ribbed_boss,
    "pocketed bar": pocketed_bar,
    "flat bar": flat_bar,
    "three bars": three_bars,
    "drawn pin": drawn_pin,
    "countersunk": countersunk,
    "ball slot": ball_slot,
    "grooved shaft": grooved_shaft,
    "halves": halves,
    "overlapping kinds": overlapping_kinds,
    "cup with ball": cup_with_ball,
    "plate with all": plate_with_all,
}


# -- parts whose numbers pass through tangency ------------------------------------------------


def passing_lug(n: Sizes, t: float) -> Tool:
    r, h = n(8, 30), n(30, 70)
    block = box("M", (-r - t, 0.0, 0.0), (2 * (r + t), 20.0, h))
    return joined("P", block, rod("C", "y", r, (0.0, 0.0, h), 20.0))


def passing_flush(n: Sizes, t: float) -> Tool:
    r, h = n(8, 30), n(30, 70)
    block = box("M", (-r, 0.0, 0.0), (2 * r, 20.0, h))
    return joined("P", block, rod("C", "y", r, (0.0, -t, h), 20.0 + 2 * t))


def passing_slot(n: Sizes, t: float) -> Tool:
    r, x = n(3, 8), n(12, 25)
    plate = box("A", (0.0, 0.0, 0.0), (90.0, 55.0, 8.0))
    parts = [
        box("M", (x, 25.0 - r, -1.0), (20.0, 2 * r, 10.0)),
        rod("B", "z", r + t, (x, 25.0, -1.0), 10.0),
        rod("C", "z", r, (x + 20.0, 25.0, -1.0), 10.0),
    ]
    return cut("P", plate, *parts)


def passing_edge(n: Sizes, t: float) -> Tool:
    r = n(4, 12)
    plate = box("A", (0.0, 0.0, 0.0), (90.0, 60.0, 8.0))
    return cut("P", plate, rod("C", "z", r, (r + t, n(20, 40), -1.0), 10.0))


def passing_holes(n: Sizes, t: float) -> Tool:
    r, q, y = n(4, 10), n(4, 10), n(20, 40)
    plate = box("A", (0.0, 0.0, 0.0), (90.0, 60.0, 8.0))
    other = rod("D", "z", q, (20.0 + r + q + t, y, -1.0), 10.0)
    return cut("P", plate, rod("C", "z", r, (20.0, y, -1.0), 10.0), other)


def passing_level(n: Sizes, t: float) -> Tool:
    r, y = n(4, 10), n(20, 40)
    plate = box("A", (0.0, 0.0, 0.0), (90.0, 60.0, 8.0))
    other = rod("D", "z", r, (60.0, y + t, -1.0), 10.0)
    return cut("P", plate, rod("C", "z", r, (20.0, y, -1.0), 10.0), other)


def passing_cross(n: Sizes, t: float) -> Tool:
    r = n(6, 20)
    return joined(
        "P",
        rod("A", "x", r, (-40.0, 0.0, 0.0), 80.0),
        rod("B", "y", r + t, (0.0, -40.0, 0.0), 80.0),
    )


def passing_post(n: Sizes, t: float) -> Tool:
    r, post = n(18, 40), n(2, 5)
    cup = cut(
        "C", rod("A", "z", r, (0.0, 0.0, 0.0), 15.0), rod("I", "z", r - 3.0, (0.0, 0.0, 2.0), 15.0)
    )
    return joined("P", cup, rod("S", "z", post, (r - 3.0 - post + t, 0.0, 0.0), 15.0))


def passing_breakout(n: Sizes, t: float) -> Tool:
    r, q = n(10, 20), n(2, 6)
    bar = rod("A", "x", r, (0.0, 0.0, 0.0), 80.0)
    return cut("P", bar, rod("B", "y", q, (40.0, -40.0, r - q + t), 80.0))


def passing_bore(n: Sizes, t: float) -> Tool:
    """A counterbore that becomes the hole itself."""
    r, deep = n(4, 10), n(2, 6)
    plate = box("A", (0.0, 0.0, 0.0), (60.0, 60.0, 12.0))
    hole = rod("C", "z", r, (30.0, 30.0, -1.0), 20.0)
    return cut("P", plate, hole, rod("D", "z", r + t, (30.0, 30.0, 12.0 - deep), 20.0))


def passing_boss(n: Sizes, t: float) -> Tool:
    r, h = n(5, 14), n(3, 15)
    base = box("A", (0.0, 0.0, 0.0), (90.0, 60.0, 8.0))
    return joined("P", base, rod("B", "z", r, (r + t, 30.0, 0.0), 8.0 + h))


def passing_ball(n: Sizes, t: float) -> Tool:
    r = n(5, 14)
    return joined("P", rod("A", "z", r, (0.0, 0.0, 0.0), 40.0), ball("B", r + t, (0.0, 0.0, 40.0)))


def passing_cone(n: Sizes, t: float) -> Tool:
    r = n(6, 14)
    pin = cone("K", r + t, n(1, 4), n(5, 20), (0.0, 0.0, 30.0))
    return joined("P", rod("A", "z", r, (0.0, 0.0, 0.0), 30.0), pin)


def passing_floor(n: Sizes, t: float) -> Tool:
    """A pocket whose floor passes through the plate's bottom."""
    r = n(4, 12)
    plate = box("A", (0.0, 0.0, 0.0), (60.0, 60.0, 12.0))
    return cut("P", plate, rod("C", "z", r, (30.0, 30.0, t), 20.0))


def passing_groove(n: Sizes, t: float) -> Tool:
    """A ring that touches the end of a shaft."""
    r, q = n(10, 20), n(2, 4)
    shaft = rod("A", "z", r, (0.0, 0.0, 0.0), 40.0)
    return cut("P", shaft, ring("G", r, q, (0.0, 0.0, q + t)))


def passing_bored_lug(n: Sizes, t: float) -> Tool:
    """A lug with its bore and foot: the walls meet the round end tangentially at 0."""
    r, h, thick = n(10, 30), n(30, 70), n(5, 30)
    block = box("M", (-r - t, 0.0, 0.0), (2 * (r + t), thick, h))
    body = joined("L", block, rod("C", "y", r, (0.0, 0.0, h), thick))
    bored = cut("N", body, rod("D", "y", n(2, 0.6 * r), (0.0, -2.0, h), thick + 4.0))
    return joined("P", bored, box("F", (-r - 12.0, 0.0, -8.0), (2 * r + 24.0, thick, 8.0)))


def passing_clevis(n: Sizes, t: float) -> Tool:
    """A fork with round ends and a shank, which touches its sides at 0."""
    r, h, thick = n(10, 25), n(40, 60), n(16, 40)
    block = box("M", (-r, 0.0, 0.0), (2 * r, thick, h))
    body = joined("L", block, rod("C", "y", r + t, (0.0, 0.0, h), thick))
    gap = n(4, 0.5 * thick)
    fork = box("G", (-r - 4.0, (thick - gap) / 2, n(10, 18)), (2 * r + 8.0, gap, h + r + 4.0))
    bore = rod("D", "y", n(2, 0.5 * r), (0.0, -1.0, h), thick + 2.0)
    shank = rod("S", "z", min(thick / 2, r) + t, (0.0, thick / 2, -20.0), 20.0)
    return joined("P", cut("N", body, fork, bore), shank)


def passing_keyway(n: Sizes, t: float) -> Tool:
    r, b, long, deep = n(12, 30), n(3, 5), n(10, 25), n(2, 4)
    slot = box("M", (-b, r - deep, 8.0), (2 * b, 20.0, long))
    ends = [
        rod(k, "y", b + t, (0.0, r - deep, z), 20.0) for k, z in (("C", 8.0), ("D", 8.0 + long))
    ]
    return cut("P", rod("A", "z", r, (0.0, 0.0, 0.0), 60.0), *n.shuffled([slot, *ends]))


def passing_row(n: Sizes, t: float) -> Tool:
    """Three holes in a row, which touch each other at 0."""
    r, y = n(3, 8), n(20, 40)
    gap = 2 * r + t
    holes = [rod(f"H{k}", "z", r, (12.0 + k * gap, y, -1.0), 12.0) for k in range(3)]
    return cut("P", box("A", (0.0, 0.0, 0.0), (90.0, 60.0, 8.0)), *n.shuffled(holes))


def passing_grid(n: Sizes, t: float) -> Tool:
    """A grid of holes, of which two rows touch the plate's sides at 0."""
    r, p = n(4, 8), n(20, 30)
    wide = 60.0
    places = [(15.0 + i * p, y) for i in range(2) for y in (r + t, wide - r - t)]
    holes = [rod(f"H{k}", "z", r, (*at, -1.0), 12.0) for k, at in enumerate(places)]
    return cut("P", box("A", (0.0, 0.0, 0.0), (90.0, wide, 8.0)), *n.shuffled(holes))


def passing_polar(n: Sizes, t: float) -> Tool:
    """A bolt circle whose holes touch the bore at 0, at any angle."""
    bore, r, k, first = n(8, 14), n(3, 6), n.count(2, 5), n.pick(0.0, n(0, 90))
    disc = rod("A", "z", 50.0, (0.0, 0.0, 0.0), 8.0)
    holes = []
    for j in range(k):
        hole = rod(f"H{j}", "z", r, (bore + r + t, 0.0, -1.0), 10.0)
        holes.append(turned(hole, "z", first + 360.0 * j / k, (0.0, 0.0, 0.0)))
    return cut("P", disc, *n.shuffled([*holes, rod("I", "z", bore, (0.0, 0.0, -1.0), 10.0)]))


def passing_inner_posts(n: Sizes, t: float) -> Tool:
    """Posts on a floor, which touch its border from inside at 0."""
    r, post, high = n(20, 40), n(3, 6), n(5, 20)
    floor = rod("A", "z", r, (0.0, 0.0, 0.0), 5.0)
    off = r - post + t
    posts = [rod(f"S{k}", "z", post, (x, y, 0.0), 5.0 + high)
             for k, (x, y) in enumerate([(off, 0.0), (0.0, off), (-off, 0.0)])]  # fmt: skip
    return joined("P", floor, *n.shuffled(posts))


def passing_equal_cross(n: Sizes, t: float) -> Tool:
    """Bars of one diameter, whose axes meet at 0."""
    r = n(6, 20)
    bars = [rod("A", "x", r, (-40.0, 0.0, 0.0), 80.0), rod("B", "y", r, (0.0, -40.0, t), 80.0)]
    return joined("P", *n.shuffled(bars))


PASSING: dict[str, Callable[[Sizes, float], Tool]] = {
    "lug": passing_lug,
    "bored lug": passing_bored_lug,
    "clevis": passing_clevis,
    "keyway": passing_keyway,
    "row": passing_row,
    "grid": passing_grid,
    "polar": passing_polar,
    "inner posts": passing_inner_posts,
    "equal cross": passing_equal_cross,
    "flush": passing_flush,
    "slot": passing_slot,
    "edge": passing_edge,
    "holes": passing_holes,
    "level": passing_level,
    "cross": passing_cross,
    "post": passing_post,
    "breakout": passing_breakout,
    "bore": passing_bore,
    "boss": passing_boss,
    "ball": passing_ball,
    "cone": passing_cone,
    "floor": passing_floor,
    "groove": passing_groove,
}

#: Distances from the tangent position, in the order in which a number passes them.
OFFSETS = (-2.0, -0.3, -1e-2, -1e-4, 0.0, 1e-4, 1e-2, 0.3, 2.0, 0.0)

NUMBER = re.compile(r"(?<![\w.])-?\d+\.\d+(?:e-?\d+)?(?!\w)")


def numbered(text: str) -> tuple[str, list[float]]:
    """The commands with each of their numbers as a variable N0, N1, … of an object TABLE."""
    values: list[float] = []

    def name(found: re.Match[str]) -> str:
        values.append(float(found.group()))
        return f'"TABLE.N{len(values) - 1}"'

    out = NUMBER.sub(name, text)
    table = "".join(f"VARIABLE N{k} {v!r}\n" for k, v in enumerate(values))
    return f"SKETCH TABLE\n{table}{out}", values
