"""Random parts as sketches and as OCCT solids of the same construction.

Prisms with holes, pockets and bosses, oblique solids, round ones, and Booleans of up to five.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.random import Generator
from OCP.Bnd import Bnd_Box
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_Sewing,
    BRepBuilderAPI_Transform,
)
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeRevol,
    BRepPrimAPI_MakeTorus,
)
from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Shape

from sketch_quadrature import (
    Body,
    block_of,
    column,
    joined,
    measured,
    moved,
    polytope,
    ring_about_z,
    turned_about_z,
)

Values = dict[str, float]

#: Numbers of pieces, by the piece and the name.
Numbers = dict[tuple[int, str], float]


@dataclass
class Piece:
    """An object of one drawing; OCCT's solid is None when it crosses itself."""

    text: str
    values: Values
    solid: Callable[[Values], TopoDS_Shape | None]
    #: The same for quadrature.
    body: Callable[[Values], Body]
    #: The least and greatest that a number is changed to.
    ranges: dict[str, tuple[float, float]]
    curved: bool = False


@dataclass
class Drawn:
    """A part: its commands, the object's name, and how OCCT makes it."""

    text: str
    name: str
    values: Numbers
    ranges: dict[tuple[int, str], tuple[float, float]]
    #: At a scale if one is given: OCCT's splines between round faces miss by 1e-7 at any size.
    solid: Callable[..., TopoDS_Shape | None]
    #: Volume, area and centroid by quadrature.
    quadrature: Callable[[Numbers], np.ndarray]
    curved: bool = False
    words: list[str] = field(default_factory=list)

    def named(self, known: Iterable[str]) -> dict[tuple[int, str], str]:
        """The names of the numbers in the object: those of a piece may have a prefix."""
        out = {}
        for k, n in self.values:
            own = [x for x in known if x in (n, f"P{k}.{n}") or x.endswith(f".P{k}.{n}")]
            out[k, n] = max(own, key=len)
        return out


# -- OCCT -------------------------------------------------------------------------------------


def prism(
    corners: list[tuple[float, float, float]], by: tuple[float, float, float]
) -> TopoDS_Shape:
    """A polygon moved along a vector; points in one place count once."""
    wire = BRepBuilderAPI_MakePolygon()
    for p, before in zip(corners, corners[-1:] + corners[:-1], strict=True):
        if p != before:
            wire.Add(gp_Pnt(*p))
    wire.Close()
    return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(wire.Wire()).Face(), gp_Vec(*by)).Shape()


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> TopoDS_Shape:
    """A box between two corners."""
    return BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()


def polyhedron(faces: list[list[tuple[float, float, float]]]) -> TopoDS_Shape:
    """A solid of plane faces, counter-clockwise from outside."""
    sewing = BRepBuilderAPI_Sewing(1e-7)
    for face in faces:
        wire = BRepBuilderAPI_MakePolygon()
        for p in face:
            wire.Add(gp_Pnt(*p))
        wire.Close()
        sewing.Add(BRepBuilderAPI_MakeFace(wire.Wire()).Face())
    sewing.Perform()
    shell = TopoDS.Shell(sewing.SewedShape())
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shell, found)
    if found.Mass() < 0:
        shell = TopoDS.Shell(shell.Reversed())
    return BRepBuilderAPI_MakeSolid(shell).Solid()


def measures(shape: TopoDS_Shape, *, curved: bool) -> np.ndarray | None:
    """Volume, area and centroid; None of nothing."""
    faces = TopExp_Explorer(shape, TopAbs_FACE)
    if not faces.More():
        return None
    volume, area = GProp_GProps(), GProp_GProps()
    if curved:
        # With 1e-9 its centroids are off by as much.
        BRepGProp.VolumeProperties_s(shape, volume, 1e-11, False, False)
        BRepGProp.SurfaceProperties_s(shape, area, 1e-11, False)
    else:
        BRepGProp.VolumeProperties_s(shape, volume)
        BRepGProp.SurfaceProperties_s(shape, area)
    if abs(volume.Mass()) < 1e-9:
        return None
    c = volume.CentreOfMass()
    return np.array([volume.Mass(), area.Mass(), c.X(), c.Y(), c.Z()])


# -- drawings ---------------------------------------------------------------------------------

LETTERS = {"x": "X", "y": "Y", "z": "Z", "xy": "H", "xz": "F", "yz": "P", "xyz": "O"}


def drawing(
    rng: Generator,
    name: str,
    points: list[tuple[float, float, float]],
    lines: list[tuple[int, int]],
) -> str:
    """The picture of a wireframe, shaken a little, its lines typed."""
    angles = np.radians([345, 40, 90])
    out = [f"SKETCH {name}", "AXES 345 40 90"]
    for k, p in enumerate(points, 1):
        u, v = (20 * float(np.dot(p, f(angles))) + rng.uniform(-1, 1) for f in (np.cos, np.sin))
        out.append(f"POINT {k} AT {u:.3f} {v:.3f}")
    for a, b in lines:
        changed = "".join(
            x for x, s, t in zip("xyz", points[a - 1], points[b - 1], strict=True) if s != t
        )
        out.append(f"LINE {a} {b} TYPE {LETTERS[changed]}")
    return "\n".join(out)


def ring(first: int, count: int) -> list[tuple[int, int]]:
    """The lines round points of successive numbers."""
    return [(first + k, first + (k + 1) % count) for k in range(count)]


BOX_LINES = [*ring(1, 4), *ring(5, 4), (1, 5), (2, 6), (3, 7), (4, 8)]


def corners(low: tuple[float, float, float], high: tuple[float, float, float]) -> list:
    """The corners of a box: the bottom's, then the top's."""
    (a, b, c), (d, e, f) = low, high
    return [(x, y, z) for z in (c, f) for x, y in ((a, b), (d, b), (d, e), (a, e))]


def block(rng: Generator, name: str, kind: str | None = None) -> Piece:
    """A box, with a hole, a pocket or a boss or without."""
    w, d, h = (float(rng.integers(4, 12)) for _ in range(3))
    kind = kind or str(rng.choice(["plain", "hole", "pocket", "boss"]))
    points, lines = corners((0, 0, 0), (w, d, h)), list(BOX_LINES)
    dims = [f"DIM W X 1 2 {w}", f"DIM D Y 1 4 {d}", f"DIM H Z 1 5 {h}"]
    values = {"W": w, "D": d, "H": h}
    ranges = {"W": (2, 14), "D": (2, 14), "H": (2, 14)}
    if kind != "plain":
        p = float(rng.integers(1, int(h)))
        x, y = 1.0, 1.5
        a, b = w - 2.5, d - 3.0 + 0.25
        base = {"hole": 0.0, "pocket": h - p, "boss": h + p}[kind]
        points += corners((x, y, h), (x + a, y + b, h))[:4]
        points += [(q[0], q[1], base) for q in points[8:12]]
        lines += [*ring(9, 4), *ring(13, 4), *((9 + k, 13 + k) for k in range(4))]
        dims += ["ALIGN Z 5 9", f"DIM HX X 1 9 {x}", f"DIM HY Y 1 9 {y}", f"DIM HW X 9 10 {a}"]
        dims += [f"DIM HD Y 9 12 {b}"]
        values |= {"HX": x, "HY": y, "HW": a, "HD": b}
        ranges |= {"HX": (-4, 14), "HY": (-4, 14), "HW": (0.5, 9), "HD": (0.5, 9)}
        if kind == "hole":
            dims.append("ALIGN Z 1 13")
        else:
            dims.append(f"DIM P Z {'13 9' if kind == 'pocket' else '9 13'} {p}")
            values["P"], ranges["P"] = p, (0.5, 16)

    def solid(v: Values) -> TopoDS_Shape:
        body = box((0, 0, 0), (v["W"], v["D"], v["H"]))
        if kind == "plain":
            return body
        low, high = (v["HX"], v["HY"]), (v["HX"] + v["HW"], v["HY"] + v["HD"])
        top = v["H"]
        span = {
            "hole": (0, top),
            "pocket": (top - v.get("P", 0), top),
            "boss": (top, top + v.get("P", 0)),
        }[kind]
        tool = box((*low, span[0]), (*high, span[1]))
        joined = BRepAlgoAPI_Fuse if kind == "boss" else BRepAlgoAPI_Cut
        return joined(body, tool).Shape()

    def body(v: Values) -> Body:
        whole = block_of((0, 0, 0), (v["W"], v["D"], v["H"]))
        if kind == "plain":
            return whole
        low, high = (v["HX"], v["HY"]), (v["HX"] + v["HW"], v["HY"] + v["HD"])
        top, deep = v["H"], v.get("P", 0)
        span = {"hole": (0, top), "pocket": (top - deep, top), "boss": (top, top + deep)}[kind]
        tool = block_of((*low, span[0]), (*high, span[1]))
        return joined("UNION" if kind == "boss" else "CUT", whole, tool)

    text = "\n".join([drawing(rng, name, points, lines), *dims, "GENERATE FACES"])
    return Piece(text, values, solid, body, ranges)


def section(rng: Generator, name: str) -> Piece:
    """An L or T or trapezoid of a plane picture, with a triangular hole or without, extruded."""
    w, h, t, s = 8.0, 7.0, 2.0, 3.0
    shape = rng.choice(["angle", "dam"])
    hole = bool(rng.integers(2))
    length = float(rng.integers(2, 9))

    def outline(v: Values) -> list[tuple[float, float]]:
        if shape == "angle":
            return [
                (0, 0),
                (v["W"], 0),
                (v["W"], v["T"]),
                (v["S"], v["T"]),
                (v["S"], v["H"]),
                (0, v["H"]),
            ]
        return [(0, 0), (v["W"], 0), (v["S"], v["H"]), (0, v["H"])]

    values = {"W": w, "H": h, "S": s, "L": length}
    ranges = {"W": (3.5, 12), "H": (2.5, 12), "S": (0.5, 9), "L": (0.5, 12)}
    if shape == "angle":
        values["T"], ranges["T"] = t, (0.5, 9)
    ring_ = outline(values)
    flat = [(20 * x + rng.uniform(-1, 1), 20 * z + rng.uniform(-1, 1)) for x, z in ring_]
    if hole:
        values |= {"A": 0.5, "B": 0.5, "C": 1.0, "E": 1.25}
        ranges |= {"A": (-2, 8), "B": (-2, 8), "C": (0.5, 4), "E": (0.5, 4)}
        flat += [(10.0, 10.0), (30.0, 10.0), (10.0, 35.0)]
    out = [f"SKETCH {name} 2D XZ"]
    out += [f"POINT {k} {u:.3f} {v:.3f}" for k, (u, v) in enumerate(flat, 1)]
    n = len(ring_)
    for a, b in ring(1, n):
        p, q = ring_[a - 1], ring_[b - 1]
        out.append(f"LINE {a} {b} TYPE {'X' if p[1] == q[1] else 'Z' if p[0] == q[0] else 'F'}")
    if hole:
        k = n + 1
        out += [
            f"LINE {k} {k + 1} TYPE X",
            f"LINE {k + 1} {k + 2} TYPE F",
            f"LINE {k + 2} {k} TYPE Z",
        ]
        out += [
            f"DIM A X 1 {k} 0.5",
            f"DIM B Z 1 {k} 0.5",
            f"DIM C X {k} {k + 1} 1",
            f"DIM E Z {k} {k + 2} 1.25",
        ]
    if shape == "angle":
        out += [f"DIM W X 1 2 {w}", f"DIM H Z 1 6 {h}", f"DIM S X 1 4 {s}", f"DIM T Z 1 3 {t}"]
    else:
        out += [f"DIM W X 1 2 {w}", f"DIM H Z 1 4 {h}", f"DIM S X 1 3 {s}"]
    out += [f"VARIABLE L {length}", 'EXTRUDE "L"']

    def solid(v: Values) -> TopoDS_Shape | None:
        if shape == "angle" and v["S"] > v["W"] and v["T"] > v["H"]:
            # Its outline crosses itself.
            return None
        body = prism([(x, 0, z) for x, z in outline(v)], (0, v["L"], 0))
        if not hole:
            return body
        a, b, c, e = (v[n] for n in "ABCE")
        tool = prism([(a, 0, b), (a + c, 0, b), (a, 0, b + e)], (0, v["L"], 0))
        return BRepAlgoAPI_Cut(body, tool).Shape()

    def body(v: Values) -> Body:
        w, h, across, length = v["W"], v["H"], v["S"], v["L"]
        if shape == "dam":
            whole = column(outline(v), 0, length)
        else:
            up = v["T"]
            wide, tall = ((w, up), (across, h)) if up <= h else ((w, h), (w, up))
            whole = block_of((0, 0, 0), (wide[0], length, wide[1]))
            if tall[1] > wide[1] and (up <= h or across < w):
                left = 0.0 if up <= h else across
                rest = block_of((left, 0, wide[1]), (tall[0], length, tall[1]))
                whole = joined("UNION", whole, rest)
        if not hole:
            return whole
        a, b, c, e = (v[n] for n in "ABCE")
        return joined("CUT", whole, column([(a, b), (a + c, b), (a, b + e)], 0, length))

    return Piece("\n".join(out), values, solid, body, ranges)


def frustum(rng: Generator, name: str) -> Piece:
    """A rectangle below and another one above, anywhere; or a pyramid of any apex."""
    pointed = bool(rng.integers(2))
    w, d, h, x, y = 7.0, 6.0, 5.0, 2.0, 1.0
    values = {"W": w, "D": d, "H": h, "U": x, "V": y}
    ranges = {"W": (1, 12), "D": (1, 12), "H": (1, 9), "U": (-6, 9), "V": (-6, 9)}
    points = corners((0, 0, 0), (w, d, h))[:4]
    if pointed:
        points.append((x, y, h))
        lines = [*ring(1, 4), *((k, 5) for k in range(1, 5))]
    else:
        values |= {"A": 3.0, "B": 2.0}
        ranges |= {"A": (0.5, 9), "B": (0.5, 9)}
        points += [(x, y, h), (x + 3, y, h), (x + 3, y + 2, h), (x, y + 2, h)]
        lines = BOX_LINES
    dims = [f"DIM W X 1 2 {w}", f"DIM D Y 1 4 {d}", f"DIM H Z 1 5 {h}"]
    dims += [f"DIM U X 1 5 {x}", f"DIM V Y 1 5 {y}"]
    if not pointed:
        dims += ["DIM A X 5 6 3", "DIM B Y 5 8 2"]

    def faces(v: Values) -> list[list[tuple[float, float, float]]]:
        w, d = v["W"], v["D"]
        base = [(0.0, 0.0, 0.0), (w, 0.0, 0.0), (w, d, 0.0), (0.0, d, 0.0)]
        if pointed:
            top = [(v["U"], v["V"], v["H"])] * 4
        else:
            top = corners((v["U"], v["V"], v["H"]), (v["U"] + v["A"], v["V"] + v["B"], v["H"]))[:4]
        sides = []
        for k in range(4):
            j = (k + 1) % 4
            face = [base[k], base[j], top[j], top[k]]
            sides.append(face[:3] if pointed else face)
        return [base[::-1], *sides] if pointed else [base[::-1], top, *sides]

    def solid(v: Values) -> TopoDS_Shape:
        return polyhedron(faces(v))

    text = "\n".join([drawing(rng, name, points, lines), *dims, "GENERATE FACES"])
    return Piece(text, values, solid, lambda v: polytope(faces(v)), ranges)


def bar(rng: Generator, name: str) -> Piece:
    """A round bar along z, its lower end's square at the origin."""
    r, h = 1.0 + float(rng.integers(1, 5)) / 2, float(rng.integers(3, 14))
    points = corners((0, 0, 0), (2 * r, 2 * r, h))
    dims = [f"VARIABLE R {r}", 'DIM X 1 2 "2*R"', 'DIM Y 1 4 "2*R"', f"DIM H Z 1 5 {h}"]
    dims += ["CIRCLE C1 CORNER 1 2 4", "CIRCLE C2 CORNER 5 6 8"]

    def solid(v: Values) -> TopoDS_Shape:
        axis = gp_Ax2(gp_Pnt(v["R"], v["R"], 0), gp_Dir(0, 0, 1))
        return BRepPrimAPI_MakeCylinder(axis, v["R"], v["H"]).Shape()

    def body(v: Values) -> Body:
        return turned_about_z((v["R"], v["R"], 0), v["R"], 0, 0, v["H"])

    text = "\n".join([drawing(rng, name, points, BOX_LINES), *dims, "GENERATE FACES"])
    return Piece(text, {"R": r, "H": h}, solid, body, {"R": (0.5, 4), "H": (1, 14)}, True)


def rounded(rng: Generator, name: str) -> Piece:
    """A box with one vertical edge rounded."""
    w, d, h, r = 8.0, 6.0, 4.0, 2.0
    points = corners((0, 0, 0), (w, d, h))
    dims = [f"DIM W X 1 2 {w}", f"DIM D Y 1 4 {d}", f"DIM H Z 1 5 {h}", f"VARIABLE R {r}"]
    dims += ["ARC C1 CORNER 2 1 3 RADIUS R", "ARC C2 CORNER 6 5 7 RADIUS R"]

    def solid(v: Values) -> TopoDS_Shape:
        w, d, h, r = (v[n] for n in "WDHR")
        body = box((0, 0, 0), (w, d, h))
        corner = box((w - r, 0, 0), (w, r, h))
        axis = gp_Ax2(gp_Pnt(w - r, r, 0), gp_Dir(0, 0, 1))
        tool = BRepAlgoAPI_Cut(corner, BRepPrimAPI_MakeCylinder(axis, r, h).Shape()).Shape()
        return BRepAlgoAPI_Cut(body, tool).Shape()

    def round_body(v: Values) -> Body:
        w, d, h, r = (v[n] for n in "WDHR")
        corner = block_of((w - r, 0, 0), (w, r, h))
        tool = joined("CUT", corner, turned_about_z((w - r, r, 0), r, 0, 0, h))
        return joined("CUT", block_of((0, 0, 0), (w, d, h)), tool)

    text = "\n".join([drawing(rng, name, points, BOX_LINES), *dims, "GENERATE FACES"])
    ranges = {"W": (4, 12), "D": (4, 12), "H": (1, 9), "R": (0.25, 3.5)}
    return Piece(text, {"W": w, "D": d, "H": h, "R": r}, solid, round_body, ranges, True)


def turned(rng: Generator, name: str) -> Piece:
    """A trapezoid or a circle turned about z: a cylinder, a cone, a pipe, a ring."""
    kind = rng.choice(["cone", "pipe", "ring"])
    values, ranges = {"A": 1.0, "B": 3.0, "H": 4.0}, {"A": (0.5, 4), "B": (0.5, 4), "H": (0.5, 9)}
    out = [f"SKETCH {name} 2D XZ"]
    if kind == "cone":
        # The axis is its left side.
        out += ["POINT 1 0 0; POINT 2 20 0; POINT 3 60 80; POINT 4 0 80"]
        out += ["LINE 1 2 TYPE X; LINE 2 3 TYPE F; LINE 3 4 TYPE X; LINE 4 1 TYPE Z"]
        out += ["DIM A X 1 2 1; DIM B X 1 3 3; DIM H Z 1 4 4; GENERATE FACES; REVOLVE 4"]
    else:
        out += ["POINT 1 0 -40; POINT 2 0 140; LINE 1 2 TYPE Z"]
        out += ["POINT 3 20 0; POINT 4 80 0; POINT 5 80 80; POINT 6 20 80; POLYLINE 3 4 5 6 CLOSE"]
        out += ["DIM A X 1 3 1; DIM B X 3 4 3; DIM Z 1 2 9; DIM Z 1 3 2"]
        out += ["DIM H Z 3 6 4" if kind == "pipe" else 'DIM H Z 3 6 "B"; CIRCLE CORNER 3 4 6']
        out += ["REFERENCE 1 0 -2", "GENERATE FACES", "REVOLVE 1"]
        if kind == "ring":
            values.pop("H"), ranges.pop("H")

    def solid(v: Values) -> TopoDS_Shape:
        a, b, h = v["A"], v["B"], v.get("H", v["B"])
        if kind == "ring":
            axis = gp_Ax2(gp_Pnt(0, 0, b / 2), gp_Dir(0, 0, 1))
            return BRepPrimAPI_MakeTorus(axis, a + b / 2, b / 2).Shape()
        flat = (
            [(0, 0), (a, 0), (b, h), (0, h)]
            if kind == "cone"
            else [(a, 0), (a + b, 0), (a + b, h), (a, h)]
        )
        wire = BRepBuilderAPI_MakePolygon()
        for x, z in flat:
            wire.Add(gp_Pnt(x, 0, z))
        wire.Close()
        face = BRepBuilderAPI_MakeFace(wire.Wire()).Face()
        axis = gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
        return BRepPrimAPI_MakeRevol(face, axis).Shape()

    def body(v: Values) -> Body:
        a, b, h = v["A"], v["B"], v.get("H", v["B"])
        if kind == "ring":
            return ring_about_z((0, 0, b / 2), a + b / 2, b / 2)
        if kind == "cone":
            return turned_about_z((0, 0, 0), a, (b - a) / h, 0, h)
        outer, inner = (turned_about_z((0, 0, 0), r, 0, 0, h) for r in (a + b, a))
        return joined("CUT", outer, inner)

    return Piece("\n".join(out), values, solid, body, ranges, True)


PLANE = (block, section, frustum)
ROUND = (bar, rounded, turned)


def drawn(rng: Generator, *, curved: bool) -> Drawn:
    """A part of one to five pieces, each but the first placed by numbers of its own."""
    count = int(rng.integers(1, 6)) if not curved else int(rng.integers(1, 4))
    text, values, ranges, makers, words = [], {}, {}, [], []
    any_round = False
    for k in range(count):
        pool = PLANE if not curved or k % 2 else ROUND
        piece = pool[int(rng.integers(len(pool)))](rng, f"P{k}")
        any_round |= piece.curved
        own = dict(piece.values)
        text.append(piece.text)
        bounds = dict(piece.ranges)
        if k:
            axis = "XYZ"[int(rng.integers(3))]
            turn = float(rng.choice([0, 0, 90, 30, 17.5]))
            place = [
                float(rng.integers(-2, 7)) + float(rng.choice([0, 0.5, 0.37])) for _ in range(3)
            ]
            # Names that no piece has.
            for n, x in zip(("MX", "MY", "MZ"), place, strict=True):
                own[n], bounds[n] = x, (-4.0, 9.0)
            own["TURN"], bounds["TURN"] = turn, (-180, 180)
            lines = [f"USING P{k}", *(f"VARIABLE {n} {own[n]}" for n in ("MX", "MY", "MZ", "TURN"))]
            lines += [f"ROTATE P{k} {axis} TURN FEATURE", f"MOVE P{k} MX MY MZ FEATURE"]
            text += lines
        else:
            axis = "Z"
        values |= {(k, n): x for n, x in own.items()}
        ranges |= {(k, n): x for n, x in bounds.items()}
        makers.append((piece, k, axis))
    name = "P0"
    operations: list[str] = []
    if count > 1:
        name = "U"
        for k in range(1, count):
            word = str(rng.choice(["UNION", "CUT", "UNION", "CUT", "COMMON"]))
            operations.append(word)
            text.append(f"{word} {'P0' if k == 1 else 'U'} P{k} INTO U")

    def place(piece: Piece, k: int, axis: str, v: Numbers) -> TopoDS_Shape | None:
        own = {n: x for (of, n), x in v.items() if of == k}
        shape = piece.solid(own)
        if shape is None or k == 0 or shape.IsNull():
            return shape
        turn, shift = gp_Trsf(), gp_Trsf()
        direction = gp_Dir(*(float(axis == a) for a in "XYZ"))
        turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), direction), math.radians(own["TURN"]))
        shift.SetTranslation(gp_Vec(own["MX"], own["MY"], own["MZ"]))
        return BRepBuilderAPI_Transform(shape, shift.Multiplied(turn), True).Shape()

    def enlarged(shape: TopoDS_Shape, scale: float) -> TopoDS_Shape:
        bigger = gp_Trsf()
        bigger.SetScale(gp_Pnt(0, 0, 0), scale)
        return BRepBuilderAPI_Transform(shape, bigger, True).Shape()

    def quadrature(v: Numbers) -> np.ndarray:
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        whole: Body | None = None
        for piece, k, axis in makers:
            own = {n: x for (of, n), x in v.items() if of == k}
            shape = place(piece, k, axis, v)
            box = Bnd_Box()
            BRepBndLib.Add_s(shape, box)
            p, q = (np.array([c.X(), c.Y(), c.Z()]) for c in (box.CornerMin(), box.CornerMax()))
            low, high = np.minimum(low, p), np.maximum(high, q)
            body = piece.body(own)
            if k:
                way = "XYZ".index(axis)
                c, s = math.cos(math.radians(own["TURN"])), math.sin(math.radians(own["TURN"]))
                turn = np.eye(3)
                i, j = (way + 1) % 3, (way + 2) % 3
                turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
                body = moved(body, turn, np.array([own["MX"], own["MY"], own["MZ"]]))
            whole = body if whole is None else joined(operations[k - 1], whole, body)
        assert whole is not None
        return measured(whole, (low + high) / 2, 0.51 * float(np.linalg.norm(high - low)))

    kinds = {"UNION": BRepAlgoAPI_Fuse, "CUT": BRepAlgoAPI_Cut, "COMMON": BRepAlgoAPI_Common}

    def solid(v: Numbers, scale: float = 1.0) -> TopoDS_Shape | None:
        shapes = [place(*m, v) for m in makers]
        if any(s is None for s in shapes):
            return None
        if scale != 1:
            shapes = [enlarged(s, scale) for s in shapes]
        body = shapes[0]
        for word, other in zip(operations, shapes[1:], strict=True):
            body = kinds[word](body, other).Shape()
        return body

    words = [m[0].text.split("\n")[0] for m in makers]
    return Drawn(
        "\n".join(text), name, values, ranges, solid, quadrature, any_round, words + operations
    )


def changed(rng: Generator, low: float, high: float) -> float:
    """A value in a range: half of the draws are multiples of a quarter, so that faces meet."""
    x = float(rng.uniform(low, high))
    return round(4 * x) / 4 if rng.integers(2) else x
