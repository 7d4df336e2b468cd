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
from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer, BRepFilletAPI_MakeFillet
from OCP.GeomAbs import GeomAbs_Line
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


def _centre(planes: np.ndarray) -> tuple[np.ndarray, object, float]:
    """The centre of the greatest ball inside of planes, and its radius."""
    norms = np.linalg.norm(planes[:, :3], axis=1)
    rows = np.c_[planes[:, :3], norms]
    found = linprog([0, 0, 0, -1], A_ub=rows, b_ub=-planes[:, 3], bounds=[(None, None)] * 4)
    if not found.success:
        return np.zeros(3), found, -1.0
    return found.x[:3], found, float(found.x[3])
