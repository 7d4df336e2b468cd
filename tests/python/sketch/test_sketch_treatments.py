"""Fillets, chamfers and shells of random parts through random changes, or refused.

Fillets and chamfers against OCCT's of the same construction, shells of convex bodies against SciPy.
"""

from __future__ import annotations

import os
from collections.abc import Callable

import numpy as np
import pytest

from moldloft import Sketch, SketchError

pytest.importorskip("OCP")

from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_Transform,
)
from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer, BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
from OCP.GeomAbs import GeomAbs_Line
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopAbs import TopAbs_EDGE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Shape
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection

import sketch_parts as parts

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

#: OCCT's own surfaces of revolution are integrated to about this.
BOUND = 1e-7

#: Whether a run of three points of an edge is wanted.
Wanted = Callable[[np.ndarray, bool], bool]


def edges(shape: TopoDS_Shape, wanted: Wanted) -> list[TopoDS_Edge]:
    """The edges of a shape, each once."""
    found: list[TopoDS_Edge] = []
    seen: list[TopoDS_Edge] = []
    explorer = TopExp_Explorer(shape, TopAbs_EDGE)
    while explorer.More():
        edge = TopoDS.Edge(explorer.Current())
        explorer.Next()
        if any(edge.IsSame(other) for other in seen):
            continue
        seen.append(edge)
        curve = BRepAdaptor_Curve(edge)
        low, high = curve.FirstParameter(), curve.LastParameter()
        places = [curve.Value(low + t * (high - low)) for t in (0.0, 0.5, 1.0)]
        run = np.array([[p.X(), p.Y(), p.Z()] for p in places])
        if wanted(run, curve.GetType() == GeomAbs_Line):
            found.append(edge)
    return found


def along(axis: int) -> Wanted:
    def wanted(run: np.ndarray, straight: bool) -> bool:
        way = run[2] - run[0]
        return straight and abs(abs(way[axis]) - np.linalg.norm(way)) < 1e-9

    return wanted


def level(shape: TopoDS_Shape, axis: int, *, top: bool) -> Wanted:
    """Edges in the highest or lowest plane."""
    ends: list[float] = []
    edges(shape, lambda run, _: bool(ends.extend(run[:, axis])))
    at = max(ends) if top else min(ends)
    return lambda run, _: bool(np.all(abs(run[:, axis] - at) < 1e-9))


def treated(shape: TopoDS_Shape, wanted: Wanted, size: float, *, fillet: bool) -> np.ndarray | None:
    """OCCT's measures; None when it refuses."""
    make = BRepFilletAPI_MakeFillet(shape) if fillet else BRepFilletAPI_MakeChamfer(shape)
    try:
        for edge in edges(shape, wanted):
            make.Add(size, edge)
        make.Build()
        return parts.measures(make.Shape(), curved=True)
    except Exception:
        return None


def test_random_edges_of_random_parts():
    counts = {"same": 0, "refused": 0, "occt": 0}
    for seed in range(400 if SOAK else 14):
        rng = np.random.default_rng(seed)
        make = [parts.block, parts.section, parts.bar, parts.rounded][rng.integers(4)]
        piece = make(rng, "P")
        upright = 1 if make is parts.section else 2
        kind = str(rng.choice(["X", "Y", "Z", "TOP", "BOTTOM"]))
        size, fillet = float(rng.choice([0.125, 0.25, 0.4])), bool(rng.integers(2))
        choice = f"ALONG {kind}" if kind in "XYZ" else f"OF {kind} {'XYZ'[upright]}"
        word = "FILLET" if fillet else "CHAMFER"
        sketch = Sketch()
        sketch.run(piece.text)
        try:
            sketch.run(f"{word} P {size} EDGES {choice} INTO Q; USING Q")
        except SketchError:
            counts["refused"] += 1
            continue
        old = dict(piece.values) | {f"{word}1": size}
        for change in range(6 if SOAK else 3):
            new = dict(old)
            if change:
                name = str(rng.choice(sorted(piece.ranges)))
                low, high = piece.ranges[name]
                new[name] = round(float(rng.uniform(low, high)), 3)
                new[f"{word}1"] = float(rng.choice([0.1, 0.2, 0.3]))
            for name, value in new.items():
                if value != old[name]:
                    sketch[name] = value
            old = new
            what = (seed, make.__name__, word, choice, new)
            found = sketch.objects["Q"]
            if found["volume"] is None:
                counts["refused"] += 1
                continue
            shape = piece.solid(new)
            assert shape is not None, what
            wanted = (
                along("XYZ".index(kind))
                if kind in "XYZ"
                else level(shape, upright, top=kind == "TOP")
            )
            truth = treated(shape, wanted, new[f"{word}1"], fillet=fillet)
            if truth is None:
                counts["occt"] += 1
                continue
            got = np.array([found["volume"], found["area"], *found["centroid"]])
            off = np.abs(got - truth) / np.maximum(1, np.abs(truth))
            assert off.max() < BOUND, (what, got, truth)
            counts["same"] += 1
    print(counts)
    assert counts["same"] > sum(counts.values()) / 2, counts


def test_random_shells_of_convex_bodies():
    compared = 0
    for seed in range(300 if SOAK else 20):
        rng = np.random.default_rng(seed)
        piece = parts.frustum(rng, "P")
        sketch = Sketch()
        sketch.run(piece.text)
        for name, (low, high) in piece.ranges.items():
            sketch[name] = round(float(rng.uniform(low, high)), 3)
        size = float(rng.choice([0.05, 0.125, 0.25]))
        try:
            sketch.run(f"SHELL P {size} OPEN BOTTOM Z INTO Q")
        except SketchError:
            continue
        hull = ConvexHull(sketch.mesh(name="P")[0])
        # Inside of all planes moved inward, but for the lowest one.
        planes = np.unique(np.round(hull.equations, 12), axis=0)
        planes[planes[:, 2] > -1 + 1e-9, 3] += size
        middle, _, depth = _centre(planes)
        if depth < 1e-3:
            continue
        inner = ConvexHull(HalfspaceIntersection(planes, middle).intersections)
        assert sketch.objects["Q"]["volume"] == pytest.approx(hull.volume - inner.volume, rel=1e-8)
        compared += 1
    assert compared >= 5


#: A bracket, and a block with a pocket or a boss: corners where edges of both kinds meet.
MIXED = {
    "bracket": """SKETCH A 2D XZ
        POINT 1 0 0; POINT 2 90 1; POINT 3 91 30; POINT 4 30 29; POINT 5 31 90; POINT 6 1 91
        POLYLINE 1 2 3 4 5 6 CLOSE
        DIM W X 1 2 10; DIM H Z 1 6 9; DIM T Z 2 3 3; DIM U X 1 4 3; EXTRUDE 8""",
    "block": """SKETCH B 2D XZ
        POINT 1 0 0; POINT 2 90 1; POINT 3 91 30; POINT 4 1 29; POLYLINE 1 2 3 4 CLOSE
        DIM W X 1 2 10; DIM H Z 1 4 5; EXTRUDE 8
        SKETCH D 2D XZ
        POINT 1 0 0; POINT 2 90 1; POINT 3 91 30; POINT 4 1 29; POLYLINE 1 2 3 4 CLOSE
        DIM U X 1 2 3; DIM V Z 1 4 4; EXTRUDE 3
        MOVE D 3 2 {low}
        {word} B D INTO A""",
}


def test_corners_of_edges_that_stand_out_and_in():
    counts = {"same": 0, "refused": 0, "occt": 0}
    for seed in range(300 if SOAK else 3):
        rng = np.random.default_rng([seed, 3])
        kind = str(rng.choice(["bracket", "pocket", "boss"]))
        size = round(float(rng.uniform(0.1, 0.45)), 3)
        w, h = (float(x) for x in rng.uniform([8, 4.5], [12, 6]))
        u, v, low = (float(x) for x in rng.uniform([2, 3, 2], [4, 4, 2.5]))
        sketch = Sketch()
        if kind == "bracket":
            sketch.run(MIXED["bracket"])
            new = {"W": w, "H": h + 3, "T": v, "U": u}
            outline = [(0, 0), (w, 0), (w, v), (u, v), (u, h + 3), (0, h + 3)]
            shape = parts.prism([(x, 0, z) for x, z in outline], (0, 8, 0))
        else:
            word = "CUT" if kind == "pocket" else "UNION"
            sketch.run(MIXED["block"].format(low=low, word=word))
            new = {"B.W": w, "B.H": h, "D.U": u, "D.V": v}
            tool = parts.box((3, 2, low), (3 + u, 5, low + v))
            join = BRepAlgoAPI_Cut if kind == "pocket" else BRepAlgoAPI_Fuse
            shape = join(parts.box((0, 0, 0), (w, 8, h)), tool).Shape()
        for name, value in new.items():
            sketch[name] = value
        try:
            sketch.run(f"FILLET A {size} EDGES ALL INTO Q")
        except SketchError:
            counts["refused"] += 1
            continue
        found = sketch.objects["Q"]
        got = np.array([found["volume"], found["area"], *found["centroid"]])
        truth = treated(shape, lambda *_: True, size, fillet=True)
        if truth is None:
            counts["occt"] += 1
            continue
        off = np.abs(got - truth) / np.maximum(1, np.abs(truth))
        assert off.max() < BOUND, (seed, kind, size, new, got, truth)
        counts["same"] += 1
    print(counts)
    assert counts["same"] > sum(counts.values()) / 2, counts


def test_only_a_part_of_such_a_corner_is_refused_with_the_place():
    sketch = Sketch()
    sketch.run(MIXED["bracket"])
    with pytest.raises(
        SketchError, match=r"stand out and edges that stand in meet at 3 0 3"
    ) as said:
        sketch.run("FILLET A 0.25 EDGES ALONG X ALONG Y INTO Q")
    assert "all three edges" in str(said.value)
    with pytest.raises(SketchError, match="the order of chamfers decides") as said:
        sketch.run("CHAMFER A 0.25 EDGES ALL INTO Q")
    assert "then the others by another command" in str(said.value)


def test_chamfers_of_such_a_corner_one_after_the_other():
    for seed in range(300 if SOAK else 8):
        rng = np.random.default_rng([seed, 25])
        first, second = (round(float(x), 3) for x in rng.uniform(0.1, 0.45, 2))
        w, h, u, v = (round(float(x), 3) for x in rng.uniform([8, 7, 2, 2], [12, 10, 4, 4]))
        side = str(rng.choice(["TOP Y", "BOTTOM Y"]))
        sketch = Sketch()
        sketch.run(MIXED["bracket"])
        for name, value in {"W": w, "H": h, "T": v, "U": u}.items():
            sketch[name] = value
        # Line 16 is the edge that stands in.
        sketch.run(f"CHAMFER A {first} EDGES LINE 16 INTO Q")
        sketch.run(f"CHAMFER Q {second} EDGES OF {side} INTO R")
        inner = [(u + first, v), (u, v + first)]
        outline = [(0, 0), (w, 0), (w, v), *inner, (u, h), (0, h)]
        shape = parts.prism([(x, 0, z) for x, z in outline], (0, 8, 0))
        truth = treated(shape, level(shape, 1, top=side == "TOP Y"), second, fillet=False)
        found = sketch.objects["R"]
        got = np.array([found["volume"], found["area"], *found["centroid"]])
        assert truth is not None
        off = np.abs(got - truth) / np.maximum(1, np.abs(truth))
        assert off.max() < BOUND, (seed, got, truth)


def _drilled(
    block: tuple[float, ...], drill: tuple[float, ...], place: tuple[float, ...], by: float
) -> TopoDS_Shape:
    """A block with a hole by a pointed drill, turned about x; its faces moved outwards."""
    (w, d, h), (r, length, tip), (turn, x, y, z) = block, drill, place
    slope = float(np.hypot(tip - length, r))
    # The drill's faces move the other way.
    t = -by
    section = [
        (0, 0, -t),
        (r + t, 0, -t),
        (r + t, 0, length + t * (slope - (tip - length)) / r),
        (0, 0, tip + t * slope / r),
    ]
    polygon = BRepBuilderAPI_MakePolygon()
    for p in section:
        polygon.Add(gp_Pnt(*p))
    polygon.Close()
    face = BRepBuilderAPI_MakeFace(polygon.Wire()).Face()
    tool = BRepPrimAPI_MakeRevol(face, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape()
    turned, moved = gp_Trsf(), gp_Trsf()
    turned.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), float(np.radians(turn)))
    moved.SetTranslation(gp_Vec(x, y, z))
    tool = BRepBuilderAPI_Transform(tool, moved.Multiplied(turned), True).Shape()
    top = h if by < 0 else h + by
    body = parts.box((-by, -by, -by), (w + by, d + by, top))
    return BRepAlgoAPI_Cut(body, tool).Shape()


def test_shells_of_drilled_blocks():
    counts = {"same": 0, "refused": 0}
    for seed in range(300 if SOAK else 8):
        rng = np.random.default_rng([seed, 4])
        w, d, h = (round(float(x), 3) for x in rng.uniform([9, 8, 5], [12, 10, 7]))
        r, length, more = (round(float(x), 3) for x in rng.uniform([0.5, 3, 0.2], [1.2, 4, 1.2]))
        turn = 180.0 + round(float(rng.uniform(-25, 25)), 2) * int(rng.integers(2))
        x, y = round(w / 2, 3), round(d / 2, 3)
        size = float(rng.choice([0.25, 0.375, 0.5]))
        sketch = Sketch()
        sketch.run(
            f"""SKETCH B 2D XZ
            POINT 1 0 0; POINT 2 90 1; POINT 3 91 30; POINT 4 1 29; POLYLINE 1 2 3 4 CLOSE
            DIM W X 1 2 {w}; DIM H Z 1 4 {h}; EXTRUDE {d}
            SKETCH D 2D XZ
            POINT 1 0 0; POINT 2 30 1; POINT 3 31 90; POINT 4 1 120; POLYLINE 1 2 3 4 CLOSE
            DIM R X 1 2 0.75; DIM L Z 2 3 {length}; DIM M Z 1 4 {length + more}
            REVOLVE D 4 360 INTO E; ROTATE E X {turn}; MOVE E {x} {y} {h + 1}
            CUT B E INTO A
            SHELL A {size} OPEN TOP Z INTO Q"""
        )
        sketch["R"] = r
        found = sketch.objects["Q"]
        if found["volume"] is None:
            counts["refused"] += 1
            continue
        drill, place = (r, length, length + more), (turn, x, y, h + 1)
        outer = _drilled((w, d, h), drill, place, 0.0)
        inner = _drilled((w, d, h), drill, place, -size)
        truth = parts.measures(BRepAlgoAPI_Cut(outer, inner).Shape(), curved=True)
        assert truth is not None
        got = np.array([found["volume"], found["area"], *found["centroid"]])
        off = np.abs(got - truth) / np.maximum(1, np.abs(truth))
        assert off.max() < BOUND, (seed, got, truth)
        counts["same"] += 1
    print(counts)
    assert counts["same"] > 0.8 * sum(counts.values()), counts


def _centre(planes: np.ndarray) -> tuple[np.ndarray, object, float]:
    """The centre of the greatest ball inside of planes, and its radius."""
    norms = np.linalg.norm(planes[:, :3], axis=1)
    rows = np.c_[planes[:, :3], norms]
    found = linprog([0, 0, 0, -1], A_ub=rows, b_ub=-planes[:, 3], bounds=[(None, None)] * 4)
    if not found.success:
        return np.zeros(3), found, -1.0
    return found.x[:3], found, float(found.x[3])
