"""Nearest points and intersections from Python."""

from __future__ import annotations

import os

import numpy as np
import pytest
from scipy.spatial import cKDTree

import moldloft
from moldloft import kinds as k
from moldloft.builder import Builder

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

TUBE = """
AbsPoint O(0, 0, 0); AbsPoint X(1, 0, 0); Line axis(O, X); AbsPoint A(0, 2, 0); AbsPoint B(4, 2, 0);
Line m(A, B); RevSurf S(m, axis, 0, 6.283185307179586); XPlane half(1.5);
AbsPoint C(0.5, 1, 3); AbsPoint D(3, 1, -3); Line through(C, D);
AbsPoint E(2, -3, 0); AbsPoint F(2, 3, 0); Line post(E, F);
AbsPoint G(2.7, -3, 0); AbsPoint H(2.7, 3, 0); Line g(G, H);
RevSurf T(g, post, 0, 6.283185307179586);
"""


@pytest.fixture(scope="module")
def tube() -> moldloft.Model:
    return moldloft.loads(TUBE)


def bumpy(seed: int = 7, n: int = 12) -> moldloft.Object:
    rng = np.random.default_rng(seed)
    axes = np.meshgrid(np.arange(n) / 2, np.arange(n) / 2, indexing="ij")
    net = np.stack([*axes, rng.random((n, n))], axis=-1)
    with Builder() as builder:
        k.BSurf("S", net.reshape(-1, 3).tolist(), nu=n, nv=n)
    return builder.model()["S"]


def test_nearest_on_a_tube_is_known(tube: moldloft.Model) -> None:
    rng = np.random.default_rng(1)
    points = rng.uniform([0, -5, -5], [4, 5, 5], (40, 50, 3))
    near = tube["S"].nearest(points)
    radius = np.hypot(points[..., 1], points[..., 2])
    assert near.parameters.shape == (40, 50, 2)
    assert near.points.shape == points.shape
    assert near.statuses.shape == near.distances.shape == (40, 50)
    np.testing.assert_allclose(near.distances, abs(radius - 2), atol=1e-9)
    u, v = np.moveaxis(near.parameters, -1, 0)
    np.testing.assert_allclose(tube["S"](u, v), near.points, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(near.points - points, axis=-1), near.distances)
    outside = tube["S"].nearest([9, 2, 0])
    assert outside.statuses == "edge-clamped" and outside.parameters[0] == 1
    assert outside.distances.shape == ()


def test_many_points_come_as_single_ones() -> None:
    s = bumpy()
    points = np.random.default_rng(2).uniform([-1, -1, -1], [7, 7, 2], (3000, 3))
    many = s.nearest(points)
    for i in range(0, 3000, 100):
        one = s.nearest(points[i])
        assert (one.parameters == many.parameters[i]).all()
        assert one.distances == many.distances[i]
    u = np.linspace(0, 1, 201)
    grid = s.grid(201, 201).reshape(-1, 3)
    sample = points[:200]
    dense = np.array([np.linalg.norm(grid - p, axis=1).min() for p in sample])
    assert (many.distances[:200] <= dense + 1e-12).all()
    assert (many.distances[:200] >= dense - 0.05).all()
    assert len(u) == 201


def test_nearest_follows_the_model() -> None:
    m = moldloft.loads("AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); Line edge(A, B);")
    assert m["edge"].nearest([1, 3, 0]).distances == 3
    m["A"].y = m["B"].y = 1
    assert m["edge"].nearest([1, 3, 0]).distances == 2
    near = m["edge"].nearest([[[1, 3, 0]], [[1, 1, 5]]])
    assert near.parameters.shape == (2, 1)
    assert m["edge"].nearest(np.empty((0, 3))).distances.shape == (0,)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([1, 2], "last extent of 3"),
        (np.zeros((3, 4)), r"\(3, 4\)"),
        (5.0, "last extent of 3"),
        ("abc", "arrays of numbers"),
        ([[0, 0, 0], [np.nan, 0, 0]], r"point \[1\] is not finite"),
        ([0, np.inf, 0], "not finite"),
    ],
)
def test_bad_points_are_refused(tube: moldloft.Model, points: object, message: str) -> None:
    for name in ("S", "m"):
        with pytest.raises(moldloft.Error, match=message) as error:
            tube[name].nearest(points)  # type: ignore[arg-type]
        assert isinstance(error.value, ValueError)


def test_only_curves_and_surfaces_search(tube: moldloft.Model) -> None:
    with pytest.raises(moldloft.Error, match="`A` is a point"):
        tube["A"].nearest([0, 0, 0])
    with pytest.raises(moldloft.Error, match="`half` is a plane"):
        tube["half"].intersect("z=0")
    with pytest.raises(moldloft.Error, match="`A` is a point"):
        tube["S"].intersect(tube["A"])
    for bad in ("w=1", "z", "z=abc", 7, ([0, 0, 0],), ([0, 0], [0, 1])):
        with pytest.raises(moldloft.Error, match="plane"):
            tube["S"].intersect(bad)  # type: ignore[arg-type]
    for point, normal in (([0, 0, 0], [0, 0, 0]), ([np.nan, 0, 0], [0, 0, 1])):
        with pytest.raises(moldloft.Error, match="finite"):
            tube["S"].intersect((point, normal))


def test_a_plane_cuts_a_tube(tube: moldloft.Model) -> None:
    s = tube["S"]
    for plane in (tube["half"], "x=1.5", ([1.5, 0, 0], [2, 0, 0])):
        cut = s.intersect(plane)
        assert cut and cut.complete and len(cut.branches) == 1
        (branch,) = cut.branches
        assert branch.closed and branch.ends == ("closed", "closed")
        assert len(branch) == len(branch.points) == len(branch.parameters)
        assert branch.other_parameters.shape == (len(branch), 0)
        np.testing.assert_allclose(branch.points[:, 0], 1.5, atol=1e-12)
        np.testing.assert_allclose(np.hypot(*branch.points[:, 1:].T), 2, atol=1e-12)
        np.testing.assert_allclose(s(*branch.parameters.T), branch.points, atol=1e-11)
        np.testing.assert_allclose(np.linalg.norm(branch.tangents, axis=1), 1)
    lines = s.intersect("z=1")
    assert [b.ends for b in lines.branches] == [("edge", "edge")] * 2
    assert not s.intersect("x=9") and s.intersect("x=9").points.shape == (0, 3)


def test_surfaces_and_curves_meet(tube: moldloft.Model) -> None:
    cut = tube["S"].intersect(tube["T"])
    assert len(cut.branches) == 2 and all(b.closed for b in cut.branches) and cut.smallest > 0
    for b in cut.branches:
        np.testing.assert_allclose(tube["T"](*b.other_parameters.T), b.points, atol=1e-11)
    hits = tube["S"].intersect(tube["through"])
    back = tube["through"].intersect(tube["S"])
    assert hits.parameters.shape == (2, 2) and hits.other_parameters.shape == (2, 1)
    assert back.parameters.shape == (2, 1) and back.other_parameters.shape == (2, 2)
    np.testing.assert_allclose(hits.points, back.points, atol=1e-11)
    np.testing.assert_allclose(np.hypot(*hits.points[:, 1:].T), 2, atol=1e-11)
    assert not hits.tangent.any() and not hits.branches
    one = tube["m"].intersect("x=1")
    np.testing.assert_allclose(one.points, [[1, 2, 0]], atol=1e-12)
    np.testing.assert_allclose(one.parameters, [[0.25]], atol=1e-12)
    assert len(tube["axis"].intersect(tube["m"]).points) == 0
    other = moldloft.loads("AbsPoint A(3, 0, 0); AbsPoint B(3, 4, 0); Line l(A, B);")["l"]
    np.testing.assert_allclose(tube["m"].intersect(other).points, [[3, 2, 0]], atol=1e-11)


def test_branches_of_a_random_surface_are_those_of_a_fine_net() -> None:
    s = bumpy(3)
    cut = s.intersect("z=0.5")
    n = 801
    above = s.grid(n, n)[..., 2] > 0.5
    # Every side of the net that the level crosses has a branch near it.
    i, j = np.nonzero(above[1:] != above[:-1])
    points = s.grid(n, n)[i, j]
    stations = np.concatenate([b.points for b in cut.branches])
    apart = np.linalg.norm(points[:, None] - stations[None], axis=-1).min(axis=1)
    assert apart.max() < 0.2
    assert cut.complete


def occt_curve(points: np.ndarray, degree: int) -> object:
    """A clamped uniform B-spline in OCCT."""
    from OCP.collections import Array1_double, Array1_gp_Pnt, Array1_int
    from OCP.Geom import Geom_BSplineCurve
    from OCP.gp import gp_Pnt

    spans = len(points) - degree
    poles = Array1_gp_Pnt(1, len(points))
    knots, counts = Array1_double(1, spans + 1), Array1_int(1, spans + 1)
    for n, p in enumerate(points.tolist(), 1):
        poles.SetValue(n, gp_Pnt(*p))
    for n in range(spans + 1):
        knots.SetValue(n + 1, n / spans)
        counts.SetValue(n + 1, degree + 1 if n in (0, spans) else 1)
    return Geom_BSplineCurve(poles, knots, counts, degree)


def nearest_by_occt(a: object, b: object) -> list[tuple[float, float, float]]:
    """Distances of curves at their extrema, ends included, ascending, with parameters."""
    from OCP.GeomAPI import GeomAPI_ExtremaCurveCurve, GeomAPI_ProjectPointOnCurve

    found = GeomAPI_ExtremaCurveCurve(a, b)
    all_ = []
    for n in range(1, found.NbExtrema() + 1):
        t, s = found.Parameters(n)
        all_.append((found.Distance(n), t, s))
    for end in (0.0, 1.0):
        for first, second, turned in ((a, b, False), (b, a, True)):
            p = first.Value(end)
            feet = GeomAPI_ProjectPointOnCurve(p, second)
            for n in range(1, feet.NbPoints() + 1):
                foot = feet.Parameter(n)
                pair = (foot, end) if turned else (end, foot)
                all_.append((feet.Distance(n), *pair))
            for other in (0.0, 1.0):
                pair = (other, end) if turned else (end, other)
                all_.append((p.Distance(second.Value(other)), *pair))
    return sorted(all_)


@pytest.mark.parametrize("seed", range(250) if SOAK else (0, 112))
def test_pairs_of_curves_meet_where_dense_polylines_cross(seed: int) -> None:
    """Forty pairs each, plane and in space, beside sign changes and OCCT's extrema."""
    pytest.importorskip("OCP")
    rng = np.random.default_rng(seed)
    for _ in range(40):
        flat = rng.random() < 0.6
        nets, degrees = [], []
        for _ in range(2):
            degrees.append(int(rng.integers(1, 4)))
            net = rng.normal(size=(degrees[-1] + int(rng.integers(1, 5)), 3))
            net[:, 2] *= not flat
            nets.append(net)
        with Builder() as builder:
            for name, net, degree in zip("ab", nets, degrees, strict=True):
                k.BCurve(name, net.tolist(), degree=degree)
        m = builder.model()
        found = m["a"].intersect(m["b"])
        assert found.complete
        a, b = (occt_curve(n, d) for n, d in zip(nets, degrees, strict=True))
        best = nearest_by_occt(a, b)[0][0]
        t = np.linspace(0, 1, 1201)
        p, q = m["a"](t), m["b"](t)
        if len(found.points):
            on = [
                m[n](w[:, 0]) for n, w in (("a", found.parameters), ("b", found.other_parameters))
            ]
            np.testing.assert_allclose(on[0], on[1], atol=1e-9)
            assert found.nearest is None
        else:
            (at, other), distance = found.nearest
            gap = np.linalg.norm(m["a"](at) - m["b"](other))
            assert gap == pytest.approx(distance, rel=1e-9)
            # OCCT's extrema may miss the least one.
            least = cKDTree(p).query(q)[0].min()
            assert distance <= min(best, least) * (1 + 1e-9)
            assert distance == pytest.approx(least, abs=0.05) or distance < least
        if flat:
            assert len(found.points) == crossings(p[:, :2], q[:, :2])


def test_beginnings_may_be_the_nearest_points() -> None:
    m = moldloft.loads(
        "AbsPoint A(0, 0, 0); AbsPoint B(0, -1, 0); AbsPoint C(-0.3, 0.4, 0); AbsPoint D(-1, 1, 0);"
        "Line a(A, B); Line b(C, D);"
    )
    found = m["a"].intersect(m["b"])
    assert found.complete and not len(found.points)
    assert found.nearest == ((0, 0), pytest.approx(0.5))


def crossings(p: np.ndarray, q: np.ndarray) -> int:
    """The number of crossings of two polylines in the plane."""
    d, e = np.diff(p, axis=0)[:, None], np.diff(q, axis=0)[None]
    g = q[None, :-1] - p[:-1, None]
    det = d[..., 0] * e[..., 1] - d[..., 1] * e[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (g[..., 0] * e[..., 1] - g[..., 1] * e[..., 0]) / det
        s = (g[..., 0] * d[..., 1] - g[..., 1] * d[..., 0]) / det
    return int(np.sum((t >= 0) & (t < 1) & (s >= 0) & (s < 1)))
