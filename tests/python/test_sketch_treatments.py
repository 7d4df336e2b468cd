"""Fillets, chamfers and shells of random parts through random changes: OCCT's of the same construction, or refused."""

from __future__ import annotations

import os
from collections.abc import Callable

import numpy as np
import pytest
from moldloft import Sketch, SketchError


pytest.importorskip("OCP")

from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer, BRepFilletAPI_MakeFillet
from OCP.BRepOffset import BRepOffset_Mode
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeThickSolid
from OCP.GeomAbs import GeomAbs_JoinType, GeomAbs_Line
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Shape
from OCP.TopTools import TopTools_ListOfShape

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
            wanted = along("XYZ".index(kind)) if kind in "XYZ" else level(shape, upright, top=kind == "TOP")
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


def test_random_shells():
    same = 0
    for seed in range(100 if SOAK else 6):
        rng = np.random.default_rng(seed)
        piece = (parts.section if seed % 2 else parts.frustum)(rng, "P")
        axis, size = (1 if seed % 2 else 2), float(rng.choice([0.125, 0.25]))
        sketch = Sketch()
        sketch.run(piece.text)
        try:
            sketch.run(f"SHELL P {size} OPEN BOTTOM {'XYZ'[axis]} INTO Q")
        except SketchError:
            continue
        shape = piece.solid(piece.values)
        low = min(p[axis] for p in sketch.points) if sketch.active == "P" else 0.0
        opened = TopTools_ListOfShape()
        explorer = TopExp_Explorer(shape, TopAbs_FACE)
        while explorer.More():
            face = TopoDS.Face(explorer.Current())
            ends: list[float] = []
            edges(face, lambda run, _, ends=ends: bool(ends.extend(run[:, axis])))
            if max(abs(x - low) for x in ends) < 1e-9:
                opened.Append(face)
            explorer.Next()
        make = BRepOffsetAPI_MakeThickSolid()
        make.MakeThickSolidByJoin(
            shape, opened, -size, 1e-6, BRepOffset_Mode.BRepOffset_Skin, False, False,
            GeomAbs_JoinType.GeomAbs_Intersection,
        )
        truth = parts.measures(make.Shape(), curved=False)
        if truth is None:
            continue
        found = sketch.objects["Q"]
        got = np.array([found["volume"], found["area"], *found["centroid"]])
        off = np.abs(got - np.abs(truth) * np.sign(got)) / np.maximum(1, np.abs(truth))
        assert off.max() < 1e-7, (seed, piece.text, got, truth)
        same += 1
    assert same >= 3
