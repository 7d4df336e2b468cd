"""Tables of points, bumps, tangent curves and subdivision meshes against closed forms, SciPy and
trimesh."""

from __future__ import annotations

import math
import os
import random
from pathlib import Path

import numpy as np
import pytest

import moldloft

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
DRAWS = 300 if SOAK else 20


def written(folder: Path, name: str, points: np.ndarray) -> None:
    lines = (", ".join(repr(float(x)) for x in p) for p in points)
    (folder / name).write_text("\n".join(lines) + "\n")


def opened(folder: Path, program: str, name: str = "model.sdl") -> moldloft.Model:
    (folder / name).write_text(program)
    return moldloft.load(folder / name)


def test_curves_through_tables_are_splines(tmp_path: Path) -> None:
    interpolate = pytest.importorskip("scipy.interpolate")
    rng = np.random.default_rng(147)
    for k in range(DRAWS):
        points = np.cumsum(rng.uniform(0.1, 2, (int(rng.integers(4, 40)), 3)), axis=0)
        points[:, 1] += rng.normal(0, 1, len(points))
        written(tmp_path, f"t{k}.csv", points)
        model = opened(tmp_path, f'TabCurve c("t{k}.csv"); TabPoint p("t{k}.csv", row = 3);')
        s = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        oracle = interpolate.CubicSpline(s / s[-1], points, bc_type="not-a-knot")
        t = np.linspace(0, 1, 17)
        found = np.array([model["c"](x) for x in t])
        assert np.abs(found - oracle(t)).max() < 1e-10 * np.abs(points).max()
        assert np.array_equal(np.asarray(model["p"]), points[2])


@pytest.mark.parametrize("form", ["rows", "blank", "p3d"])
def test_surfaces_pass_through_their_tables(form: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    for k in range(DRAWS // 4):
        m, n = (int(x) for x in rng.integers(2, 9, 2))
        x, y = np.meshgrid(np.sort(rng.uniform(0, 9, n)), np.arange(m) * 1.5)
        grid = np.stack([x, y, np.sin(x) + 0.2 * y**2], axis=-1)
        stated = f", rows = {m}" if form == "rows" else ""
        suffix = "p3d" if form == "p3d" else "csv"
        path = tmp_path / f"g{k}.{suffix}"
        if form == "p3d":
            flat = [" ".join(repr(float(v)) for v in grid[..., c].ravel()) for c in range(3)]
            path.write_text(f"1\n{n} {m} 1\n" + "\n".join(flat) + "\n")
        else:
            rows = ["\n".join(", ".join(repr(float(v)) for v in p) for p in row) for row in grid]
            path.write_text(("\n\n" if form == "blank" else "\n").join(rows) + "\n")
        model = opened(tmp_path, f'TabSurf s("{path.name}"{stated});')
        surface = model["s"]
        for p in grid.reshape(-1, 3).tolist():
            near = model.eval(f"distance({{{p[0]!r}, {p[1]!r}, {p[2]!r}}}, s)")
            assert near < 1e-9
        assert np.allclose(surface(0, 0), grid[0, 0]) and np.allclose(surface(1, 1), grid[-1, -1])


def test_tables_follow_their_files_into_model_files(tmp_path: Path) -> None:
    written(tmp_path, "deck.csv", np.array([[0, 0, 1], [2, 1, 1.2], [5, 1, 1.1], [8, 0, 1]]))
    model = opened(tmp_path, 'TabCurve deck("deck.csv"); AbsBead b(deck, 0.25);')
    text = model.convert("ms2")
    assert 'TabCurve deck 11 1 8x4 / * "deck.csv" 3;' in text
    again = opened(tmp_path, text, "model.ms2")
    assert np.array_equal(np.asarray(again["b"]), np.asarray(model["b"]))
    back = opened(tmp_path, again.convert("sdl"), "back.sdl")
    assert np.array_equal(np.asarray(back["b"]), np.asarray(model["b"]))


@pytest.mark.parametrize(
    ("program", "content", "said"),
    [
        ('TabCurve c("lost.csv");', None, "lost.csv"),
        ("TabCurve c;", None, ""),
        ("TabCurve c();", None, "there is no table"),
        ('TabCurve c("t.csv", points = {{0, 0, 0}, {1, 1, 1}});', "0 0 0\n1 1 1\n", "not both"),
        ('TabCurve c("t.csv");', "1 2 3\n", "two points"),
        ('TabCurve c("t.csv");', "0 0 0\n1 1 1\n1 1 1\n2 0 0\n", "t.csv|points"),
        ('TabCurve c("t.csv");', "0 0 0\n1 nan 1\n2 0 0\n", "line 2"),
        ('TabCurve c("t.csv");', "\x00\x01\x02", "t.csv"),
        ('TabPoint p("t.csv", row = 9);', "0 0 0\n1 1 1\n", "no row 9"),
        ('TabSurf s("t.csv", rows = 2);', "0 0 0\n1 1 1\n2 0 0\n", "2 rows"),
        ('TabSurf s("t.csv");', "0 0 0\n1 1 1\n2 0 0\n", "0 rows"),
        ('TabPoint p("../outside.csv");', None, ""),
    ],
)
def test_bad_tables_are_refused(
    program: str, content: str | None, said: str, tmp_path: Path
) -> None:
    if content is not None:
        (tmp_path / "t.csv").write_text(content)
    with pytest.raises(moldloft.Error) as refused:
        opened(tmp_path, program)
    text = str(refused.value)
    assert any(word in text for word in said.split("|")) and "internal" not in text, text


def test_points_on_tangents_of_circles_and_helices() -> None:
    """On tangents of a circle the points are on a circle again; TanPoint says the same anywhere."""
    rng = random.Random(3)
    for _ in range(DRAWS):
        r, d = rng.uniform(0.5, 3), rng.uniform(-2, 2)
        pitch, turn = rng.uniform(-2, 2), rng.uniform(1, 9)
        model = moldloft.loads(
            f"param float d = {d} in [-3, 3]; AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1);"
            "Line axis(O, Z);"
            f"AbsPoint P({r}, 0, 0); Helix h(P, axis, {turn}, {pitch}); TanCurve c(h, d);"
            "AbsBead b(h, 0.37); TanPoint p(b, d);"
        )
        assert np.allclose(model["c"](0.37), np.asarray(model["p"]), rtol=0, atol=1e-12)
        for t in (0.0, 0.2, 1.0):
            x, y, _ = model["c"](t)
            run = r * turn / math.hypot(r * turn, pitch * turn / (2 * math.pi))
            assert math.hypot(x, y) == pytest.approx(math.hypot(r, d * run), rel=1e-12)
        (slope,) = np.ravel(model.derivative("c(0.6).x", "d"))
        step = 1e-6
        ends = []
        for s in (step, -step):
            model.set({"d": d + s})
            ends.append(model.eval("c(0.6).x"))
        assert slope == pytest.approx((ends[0] - ends[1]) / (2 * step), abs=1e-8)


def test_curves_without_one_tangent_have_no_tangent_curve() -> None:
    for program, said in [
        ("CCurve c({{0,0,0}, {1,1,0}, {2,0,0}}, degree = 1);", "corner"),
        ("AbsPoint A(1, 1, 1); BCurve c({A, A, A});", "zero tangent|coincide|no length"),
    ]:
        text = program.replace("{{0,0,0}, {1,1,0}, {2,0,0}}", "{A, B, C}")
        points = "AbsPoint A(0,0,0); AbsPoint B(1,1,0); AbsPoint C(2,0,0); " if "B" in text else ""
        points = points if "{A, B, C}" in text else ""
        with pytest.raises(moldloft.Error) as refused:
            moldloft.loads(points + text + " TanCurve t(c, 1);")
        assert any(word in str(refused.value) for word in said.split("|"))


PROFILES = {
    ("sharp", "pointed"): lambda v: v,
    ("sharp", "round"): lambda v: v * (2 - v),
    ("tangent", "pointed"): lambda v: v**2,
    ("tangent", "round"): lambda v: v**2 * (3 - 2 * v),
    ("curvature", "pointed"): lambda v: v**3,
    ("curvature", "round"): lambda v: v**3 * (4 - 3 * v),
}


@pytest.mark.parametrize("profile", PROFILES)
def test_bumps_on_planes_have_the_volume_of_their_profile(profile: tuple[str, str]) -> None:
    """Bump and flat cap make a closed body: V = 2 A h times the integral of b(1 - r) r."""
    rng = random.Random(str(profile))
    nodes, weights = np.polynomial.legendre.leggauss(12)
    r = 0.5 + 0.5 * nodes
    moment = float(np.sum(0.5 * weights * PROFILES[profile](1 - r) * r))
    for _ in range(max(DRAWS // 5, 3)):
        size, height = rng.uniform(2, 9), rng.uniform(0.2, 2) * rng.choice([-1, 1])
        radius = rng.uniform(0.1, 0.4)
        a, b = (rng.uniform(-1, 1) for _ in range(2))
        model = moldloft.loads(
            f"AbsPoint A(0, 0, -50); AbsPoint B({size}, 0, {a} - 50);"
            f"AbsPoint C(0, {size}, {b} - 50); RelPoint D(B, 0, {size}, {b});"
            "Line l(A, B); Line m(C, D); RuledSurf S(l, m, visible = 0); AbsMagnet c(S, 0.5, 0.5);"
            f"AbsMagnet p(S, {0.5 + radius}, 0.5); AbsMagnet q(S, 0.5, {0.5 + radius});"
            "ConicSnake ring(c, p, q, 0, 2*PI, type = 1);"
            f'Blister bump(ring, c, {height}, "{profile[0]}", "{profile[1]}", '
            "divisions = {64, 24});"
            "SubSurf floor({ring, c}, divisions = {64, 4});"
        )
        floor = model.eval("floor.area")
        # Far under water: the volume is that of the shapes, not of their panels.
        found = model.hydrostatics()
        assert found.open_edges == 0 and not model.junctions()
        assert found.volume == pytest.approx(abs(2 * floor * height * moment), rel=1e-6)
        # At its foot it leaves the surface as it says.
        normal = np.cross([size, 0, a], [0, size, b])
        normal /= np.linalg.norm(normal)
        foot = model["bump"](0.3, 0.0)
        h = 1e-4
        rise = float((model["bump"](0.3, h) - foot) @ normal) / height
        assert rise == pytest.approx(float(PROFILES[profile](h)), rel=1e-6, abs=1e-13)


def test_bumps_on_bodies_are_joined_and_differentiable() -> None:
    program = (
        "param float h = 0.3 in [-0.5, 0.8]; AbsPoint O(0, 0, -9); AbsPoint X(6, 0, -9);"
        "Line axis(O, X);"
        "AbsPoint P(0, 1, -9); AbsPoint Q(6, 1, -9); Line side(P, Q);"
        "RevSurf pipe(side, axis, 0, 2*PI, visible = 0);"
        "AbsMagnet c(pipe, 0.5, 0.4); AbsMagnet p(pipe, 0.6, 0.4); AbsMagnet q(pipe, 0.5, 0.45);"
        "ConicSnake ring(c, p, q, 0, 2*PI, type = 1);"
        "Blister bump(ring, c, h, divisions = {48, 12});"
        "SubSurf plug({ring, c}, divisions = {48, 12});"
    )
    model = moldloft.loads(program)
    assert not model.junctions()
    here = model.eval("hydrostatics.volume")
    (slope,) = np.ravel(model.derivative("hydrostatics.volume", "h"))
    ends = []
    for s in (1e-4, -1e-4):
        model.set({"h": 0.3 + s})
        ends.append(model.eval("hydrostatics.volume"))
    assert here > 0 and slope == pytest.approx((ends[0] - ends[1]) / 2e-4, rel=1e-5)
    for text, said in [
        ("LineSnake open(p, q); Blister no(open, c, 1);", "closed"),
        ("AbsMagnet far(pipe, 0.9, 0.4); Blister no(ring, far, 1);", "fold"),
        ('Blister no(ring, c, 1, "soft");', "unknown option"),
    ]:
        with pytest.raises(moldloft.Error) as refused:
            moldloft.loads(program + text)
        assert said in str(refused.value)


SHAPES = {
    "octahedron": (
        [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]],
        [[1, 3, 5], [3, 2, 5], [2, 4, 5], [4, 1, 5], [3, 1, 6], [2, 3, 6], [4, 2, 6], [1, 4, 6]],
    ),
    # trimesh takes edges within a sheet from border to border for borders: here there are none.
    "sheet": (
        [
            [0, 0, 0.5],
            [2, 0, 0],
            [1, 1.7, 0.1],
            [-1, 1.7, 0],
            [-2, 0, 0.2],
            [-1, -1.7, 0],
            [1, -1.7, 0],
        ],
        [[1, 2, 3], [1, 3, 4], [1, 4, 5], [1, 5, 6], [1, 6, 7], [1, 7, 2]],
    ),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("levels", [1, 2, 3])
def test_subdivision_is_loops(shape: str, levels: int) -> None:
    remesh = pytest.importorskip("trimesh.remesh")
    rng = np.random.default_rng(levels)
    points, triangles = SHAPES[shape]
    for _ in range(max(DRAWS // 10, 2)):
        moved = np.array(points, dtype=float) + rng.normal(0, 0.1, (len(points), 3))
        lines = [
            f"AbsPoint v{k}({p[0]!r}, {p[1]!r}, {p[2]!r});" for k, p in enumerate(moved.tolist())
        ]
        names = ", ".join(f"v{k}" for k in range(len(points)))
        corners = ", ".join(str(v) for t in triangles for v in t)
        model = moldloft.loads(
            "".join(lines) + f"TriMesh t({{{names}}}, {{{corners}}}, levels = {levels});"
        )
        oracle, _ = remesh.subdivide_loop(moved, np.array(triangles) - 1, iterations=levels)
        found = model.mesh().vertices
        distance = np.linalg.norm(found[:, None] - oracle[None], axis=2)
        assert len(found) == len(oracle)
        assert distance.min(axis=0).max() < 1e-12 and distance.min(axis=1).max() < 1e-12


def test_bad_meshes_are_refused() -> None:
    head = "AbsPoint A(0,0,0); AbsPoint B(1,0,0); AbsPoint C(0,1,0); AbsPoint D(0,0,1);"
    for text, said in [
        ("TriMesh t({A, B, C}, {1, 2});", "at least 3"),
        ("TriMesh t({A, B, C}, {1, 2, 4});", "no vertex 4"),
        ("TriMesh t({A, B, C}, {1, 2, 2});", "twice"),
        ("TriMesh t({A, B, C, D}, {1, 2, 3, 1, 2, 4});", "same direction"),
        ("TriMesh t({A, B, C}, {1, 2, 3}, levels = 99);", "8"),
    ]:
        with pytest.raises(moldloft.Error) as refused:
            moldloft.loads(head + text)
        assert said in str(refused.value)
