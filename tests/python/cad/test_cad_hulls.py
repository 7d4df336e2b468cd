"""Hulls that another program, OCCT, has written, against SciPy.

Lines, hydrostatics, panels, and a keel of ours on them. `MOLDLOFT_SOAK=1` draws 60 of them.
"""

from __future__ import annotations

import os
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.random import Generator

import moldloft

pytest.importorskip("OCP")
interpolate = pytest.importorskip("scipy.interpolate")

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

Floats = np.ndarray[Any, np.dtype[np.float64]]


@dataclass
class Drawn:
    """The port side of a hull: a B-spline of degree 3; v runs from the deck to the keel."""

    poles: Floats
    knots: tuple[Floats, Floats]
    #: The v at which z is 0, as z is a function of v alone.
    waterline: float

    def at(self, u: Floats, v: Floats, slopes: tuple[int, int] = (0, 0)) -> Floats:
        """Points, or derivatives, of a grid of parameters."""
        along = interpolate.BSpline(self.knots[0], self.poles, 3)
        rows = (along.derivative(slopes[0]) if slopes[0] else along)(u)
        across = interpolate.BSpline(self.knots[1], np.moveaxis(rows, 1, 0), 3)
        found = (across.derivative(slopes[1]) if slopes[1] else across)(v)
        return np.moveaxis(found, 0, 1)

    def places(self, u: Floats, v: Floats) -> Floats:
        """The points at pairs of parameters."""
        along, across = (
            interpolate.BSpline.design_matrix(at, knots, 3).toarray()
            for at, knots in zip((u, v), self.knots, strict=True)
        )
        return np.einsum("ni,nj,ijk->nk", along, across, self.poles)

    def below(self) -> tuple[Floats, Floats, Floats]:
        """Points, u x v and weights of a rule of the part below z = 0, exact for polynomials."""
        places, weights = np.polynomial.legendre.leggauss(10)
        rules = []
        for knots, low in zip(self.knots, (0.0, self.waterline), strict=True):
            ends = np.unique(np.concatenate([[low], knots[knots > low]]))
            half = np.diff(ends)[:, None] / 2
            rules.append(
                (((ends[:-1] + ends[1:])[:, None] / 2 + half * places).ravel(),
                 (half * weights).ravel())
            )  # fmt: skip
        (u, wu), (v, wv) = rules
        cross = np.cross(self.at(u, v, (1, 0)), self.at(u, v, (0, 1)))
        return self.at(u, v), cross, np.outer(wu, wv)


def greville(knots: Floats) -> Floats:
    return (knots[1:-3] + knots[2:-2] + knots[3:-1]) / 3


def drawn(rng: Generator) -> Drawn:
    """A hull with a raked or upright stem, a stern or a transom, flare, and a keel at y = 0."""
    n, m = int(rng.integers(7, 12)), int(rng.integers(6, 9))
    knots = []
    for count in (n, m):
        inner = np.sort(rng.uniform(0.08, 0.92, count - 4))
        knots.append(np.concatenate([[0] * 4, inner, [1] * 4]))
    length, beam = rng.uniform(20, 200), rng.uniform(0.06, 0.1)
    beam *= length
    draft, deck = rng.uniform(0.3, 0.5) * beam, rng.uniform(0.1, 0.3) * beam
    u, v = (greville(k) for k in knots)
    shape = 1 - np.abs(2 * u - 1) ** rng.uniform(2, 5)
    if rng.random() < 0.5:
        shape = np.where(u < 0.5, 0.4 + 0.6 * shape, shape)
    section = (1 - v ** rng.uniform(2.5, 6)) * (1 + rng.uniform(0, 0.2) * (1 - v))
    y = beam / 2 * np.outer(shape, section) * (1 + rng.uniform(-0.03, 0.03, (n, m)))
    y[:, -1] = 0
    y[-1] = 0
    z = deck - (deck + draft) * v
    rake = rng.uniform(0, 0.3) * rng.integers(0, 2)
    x = length * u[:, None] + rake * np.outer(u**2, deck - (deck + draft) * v)
    poles = np.stack([x, y, np.broadcast_to(z, (n, m))], axis=-1)
    return Drawn(poles, (knots[0], knots[1]), deck / (deck + draft))


def is_open(hull: Drawn) -> bool:
    """True if the forward end has a breadth."""
    return bool(hull.poles[0, :, 1].max() > 1e-9 * np.ptp(hull.poles[..., 0]))


def face(hull: Drawn, metre: float, *, other_side: bool = False) -> Any:
    """The hull as a face of OCCT, whose unit is the millimetre."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.collections import Array1_double, Array1_int, Array2_gp_Pnt
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt

    n, m = hull.poles.shape[:2]
    net = Array2_gp_Pnt(1, n, 1, m)
    for i in range(n):
        for j in range(m):
            x, y, z = (hull.poles[i, j] * metre).tolist()
            net.SetValue(i + 1, j + 1, gp_Pnt(x, -y if other_side else y, z))
    lists = []
    for knots in hull.knots:
        values, times = np.unique(knots, return_counts=True)
        places, counts = Array1_double(1, len(values)), Array1_int(1, len(values))
        for k, (value, time) in enumerate(zip(values.tolist(), times.tolist(), strict=True)):
            places.SetValue(k + 1, value)
            counts.SetValue(k + 1, time)
        lists.append((places, counts))
    (ku, tu), (kv, tv) = lists
    return BRepBuilderAPI_MakeFace(
        Geom_BSplineSurface(net, ku, kv, tu, tv, 3, 3, False, False), 1e-6
    ).Face()


def cut(shape: Any, xs: list[float]) -> Any:
    """The shape in several faces, cut by OCCT in planes across."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Splitter
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.collections import List_TopoDS_Shape
    from OCP.gp import gp_Dir, gp_Pln, gp_Pnt

    shapes, tools = List_TopoDS_Shape(), List_TopoDS_Shape()
    shapes.Append(shape)
    for x in xs:
        plane = gp_Pln(gp_Pnt(x, 0, 0), gp_Dir(1, 0, 0))
        tools.Append(BRepBuilderAPI_MakeFace(plane, -1e6, 1e6, -1e6, 1e6).Face())
    splitter = BRepAlgoAPI_Splitter()
    splitter.SetArguments(shapes)
    splitter.SetTools(tools)
    splitter.Build()
    return splitter.Shape()


def imported(path: Path, joined: int = 0) -> str:
    """The program of a file, of a half of a hull, of which so many edges are found to be shared."""
    from moldloft.cad.importing import program

    text, remarks = program(path)
    said = [r for r in remarks if f": {joined} edges of two faces are within" in r]
    assert len(remarks) == len(said) == int(joined > 0), remarks
    return text.replace('units = "m"', 'units = "m t", symmetry = "y"')


@pytest.mark.parametrize("seed", range(60 if SOAK else 6))
def test_a_hull_is_measured_and_built_upon(seed: int, tmp_path: Path) -> None:
    from test_cad_import import written

    rng = np.random.default_rng(2200 + seed)
    hull = drawn(rng)
    ending = ("step", "igs")[seed % 2]
    text = imported(written(tmp_path / f"hull.{ending}", face(hull, 1000)))
    model = moldloft.loads(text)
    (name,) = [n for n in model.objects if model[n].kind == "NURBSurf"]
    surface = model[name]
    length = float(np.ptp(hull.poles[..., 0]))

    def off(points: Floats) -> float:
        """How far points of the model are from the hull in y, by a search for u at their v."""
        x, z = points[:, 0], points[:, 2]
        top, bottom = hull.poles[0, 0, 2], hull.poles[0, -1, 2]
        v = np.clip((top - z) / (top - bottom), 0, 1)
        low, high = np.zeros(len(x)), np.ones(len(x))
        for _ in range(60):
            middle = (low + high) / 2
            before = hull.places(middle, v)[:, 0] < x
            low, high = np.where(before, middle, low), np.where(before, high, middle)
        return float(np.abs(hull.places((low + high) / 2, v) - points).max())

    # Stations and waterlines.
    for x in rng.uniform(0.1, 0.9, 3) * length:
        branches = surface.intersect(f"x={float(x)!r}").branches
        assert branches
        for branch in branches:
            assert off(branch.points[::4]) < 1e-9 * length
    for z in rng.uniform(0.1, 0.8, 2) * hull.poles[0, -1, 2]:
        branches = surface.intersect(f"z={float(z)!r}").branches
        assert branches
        for branch in branches:
            assert off(branch.points[::4]) < 1e-9 * length
    # Hydrostatics: twice the integrals of one side.
    points, cross, weights = hull.below()
    y = points[..., 1]
    volume = 2 * abs(float((y * cross[..., 1] * weights).sum()))
    first = 2 * abs(float((points[..., 0] * y * cross[..., 1] * weights).sum()))
    wetted = 2 * float((np.linalg.norm(cross, axis=-1) * weights).sum())
    transom = is_open(hull)
    # Twice the moment across has no share of an open transom; the program states that it is open.
    model.partial = transom
    figures = model.hydrostatics(density="salt")
    assert (figures.open_edges > 0) == transom
    assert figures.volume == pytest.approx(volume, rel=1e-6)
    assert figures.lcb == pytest.approx(first / volume, rel=1e-6)
    if not transom:
        assert figures.wetted_area == pytest.approx(wetted, rel=1e-4)
    places = np.linspace(0, 1, 20_001)
    line = hull.at(places, np.array([hull.waterline]))[:, 0]
    plane = 2 * float(np.trapezoid(line[:, 1], line[:, 0]))
    assert figures.waterplane_area == pytest.approx(plane, rel=1e-6)
    # Panels are on the hull; GDF holds as many.
    mesh = model.mesh()
    assert off(mesh.vertices) < 1e-9 * length
    said = pytest.warns(UserWarning, match="open below the water") if transom else nullcontext()
    with said:
        lines = model.write(tmp_path / "hull.gdf")[0].read_text().splitlines()
    assert lines[2].split() == ["0", "1"] and int(lines[3]) == len(mesh.faces)
    # A keel of ours on it: its panels share the hull's vertices, and follow a changed depth.
    lowest = [k for k in range(1, 5) if _is_keel(text, name, k, hull)]
    assert len(lowest) == 1
    bottom = float(hull.poles[0, -1, 2])
    ends = sorted([float(hull.poles[0, -1, 0]), float(hull.poles[-1, -1, 0])])
    keel = moldloft.loads(
        text
        + f"""
        param float depth = {0.2 * abs(bottom)!r} in [0, {abs(bottom)!r}];
        EdgeSnake bottom({lowest[0]}, {name});
        Line foot({{{ends[0]!r}, 0, {bottom!r} - depth}}, {{{ends[1]!r}, 0, {bottom!r} - depth}});
        RuledSurf keel(bottom, foot, divisions = {{0, 3}});
        """
    )
    for _ in range(2):
        mesh = keel.mesh()
        assert mesh.summary["components"] == 1 and not keel.junctions()
        parts = {p.name: {*mesh.faces[p.start : p.stop].ravel().tolist()} for p in mesh.patches}
        both = parts["keel"] & parts[name]
        assert len(both) >= 2
        assert np.abs(mesh.vertices[sorted(both)][:, 2] - bottom).max() < 1e-9 * length
        area = keel["depth"] * (ends[1] - ends[0])
        # A strip: what its area may miss is a share of its length squared.
        assert keel["keel"].area == pytest.approx(area, rel=1e-8)
        keel.set({"depth": 0.5 * abs(bottom)})
    slope = np.ravel(keel.derivative("keel(0.5, 1).z", "depth"))[0]
    assert slope == pytest.approx(-1, rel=1e-12)


def _is_keel(text: str, name: str, k: int, hull: Drawn) -> bool:
    model = moldloft.loads(f"{text} EdgeSnake side({k}, {name});")
    zs = [model["side"](t)[2] for t in (0.0, 0.5, 1.0)]
    return max(zs) - hull.poles[0, -1, 2] < 1e-9


@pytest.mark.parametrize("seed", range(30 if SOAK else 3))
def test_a_hull_of_several_faces_is_one_hull(seed: int, tmp_path: Path) -> None:
    from test_cad_import import written

    rng = np.random.default_rng(4200 + seed)
    hull = drawn(rng)
    length = float(np.ptp(hull.poles[..., 0]))
    cuts = np.sort(rng.uniform(0.2, 0.8, int(rng.integers(1, 4)))) * length * 1000
    shape = cut(face(hull, 1000), cuts.tolist())
    # OCCT writes them one by one: no edge is shared in the file.
    text = imported(written(tmp_path / "hull.step", shape), len(cuts))
    assert text.count("Join ") == len(cuts)
    model = moldloft.loads(text)
    mesh = model.mesh()
    assert mesh.summary["components"] == 1 and len(mesh.patches) == len(cuts) + 1
    points, cross, weights = hull.below()
    volume = 2 * abs(float((points[..., 1] * cross[..., 1] * weights).sum()))
    wetted = 2 * float((np.linalg.norm(cross, axis=-1) * weights).sum())
    model.partial = is_open(hull)
    figures = model.hydrostatics(density="salt")
    # Surfaces within snakes are measured up to their rims.
    assert not figures.on_triangles
    if is_open(hull):
        # The skin of an open body has no bounds.
        assert not figures.bounds and figures.volume == pytest.approx(volume, rel=1e-2)
    else:
        slack = figures.bounds["volume"]
        assert abs(figures.volume - volume) <= slack + 1e-6 * volume
        assert slack < 1e-5 * volume
        assert abs(figures.wetted_area - wetted) <= figures.bounds["wetted_area"] + 1e-4 * wetted
