"""The law of exact data for grids, networks and entities, open and closed; what entities report."""

from __future__ import annotations

import os

import numpy as np
import pytest

import moldloft
from moldloft.fairing import network, patches

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def along(rng, n, most=100):
    """Places in [0, 1] whose steps differ by factors of up to ``most``."""
    steps = np.exp(rng.uniform(-0.5, 0.5, n - 1) * np.log(rng.choice([1, 2, 10, most])))
    x = np.concatenate([[0], np.cumsum(steps)])
    return x / x[-1]


def around(rng, n):
    """Angles of a full turn, the first not repeated."""
    return 2 * np.pi * along(rng, n + 1, 10)[:-1]


def plane(rng, m, n):
    u, v = np.meshgrid(along(rng, m), along(rng, n), indexing="ij")
    return np.stack([3 * u, 0.4 * u - 0.2 * v, 2 * v], -1), (False, False)


def translated(rng, m, n):
    """A parabola moved along a parabola."""
    u, v = np.meshgrid(2 * along(rng, m) - 1, along(rng, n), indexing="ij")
    return np.stack([3 * u, u**2 - 0.5 * v**2, 2 * v], -1), (False, False)


def tube(rng, m, n):
    a, z = np.meshgrid(2.5 * along(rng, m), along(rng, n), indexing="ij")
    return np.stack([np.cos(a), np.sin(a), 3 * z], -1), (False, False)


def cylinder(rng, m, n):
    a, z = np.meshgrid(around(rng, m), along(rng, n), indexing="ij")
    return np.stack([np.cos(a), np.sin(a), 3 * z], -1), (True, False)


def hemisphere(rng, m, n):
    """With a pole."""
    a, b = np.meshgrid(around(rng, m), 0.5 * np.pi * along(rng, n), indexing="ij")
    grid = np.stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)], -1)
    grid[:, -1] = 0, 0, 1
    return grid, (True, False)


def torus(rng, m, n):
    a, b = np.meshgrid(around(rng, m), around(rng, n), indexing="ij")
    far = 3 + np.cos(b)
    return np.stack([far * np.cos(a), far * np.sin(a), np.sin(b)], -1), (True, True)


def helicoid(rng, m, n):
    a, r = np.meshgrid(4 * along(rng, m), 1 + along(rng, n), indexing="ij")
    return np.stack([r * np.cos(a), r * np.sin(a), 0.9 * a], -1), (False, False)


GRIDS = {f.__name__: f for f in (plane, translated, tube, cylinder, hemisphere, torus, helicoid)}


def drawn(name, seed):
    """A grid anywhere, of any size, with which directions are closed and its extent."""
    rng = np.random.default_rng([seed, list(GRIDS).index(name)])
    grid, closed = GRIDS[name](rng, int(rng.integers(12, 18)), int(rng.integers(10, 15)))
    if rng.random() < 0.5:
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        grid = grid @ turn.T + rng.normal(size=3)
        if name == "hemisphere":
            grid[:, -1] = grid[0, -1]
    grid = grid * 10.0 ** rng.integers(-3, 4)
    return grid, closed, np.abs(grid).max() + np.ptp(grid)


def lines_of(shape, closed):
    """The lines of a grid as curves of a network, closed ones returning to their first point."""
    m, n = shape
    places = np.arange(m * n).reshape(m, n)
    rows = [[*row, row[0]] if closed[1] else [*row] for row in places.tolist()]
    columns = [[*row, row[0]] if closed[0] else [*row] for row in places.T.tolist()]
    return rows + columns


@pytest.mark.parametrize("name", GRIDS)
def test_exact_grids_stay(name):
    for seed in range(40 if SOAK else 3):
        grid, closed, size = drawn(name, seed)
        for measure in ("variation", "second", "bending", "third"):
            for tol in (1e-3, 3e-2):
                faired = moldloft.fair(grid, tol * size, as_="fit", closed=closed, measure=measure)
                far = np.linalg.norm(faired.points - grid, axis=2).max()
                assert far <= 1e-12 * size, (seed, measure, tol, grid.shape)


@pytest.mark.parametrize("name", [n for n in GRIDS if n != "hemisphere"])
def test_exact_networks_stay(name):
    for seed in range(40 if SOAK else 3):
        grid, closed, size = drawn(name, seed)
        data = grid.reshape(-1, 3)
        curves = lines_of(grid.shape[:2], closed)
        for measure in ("third", "second"):
            faired = network(data, curves, 1e-2 * size, measure=measure)
            far = np.linalg.norm(faired.points - data, axis=1).max()
            assert far <= 1e-12 * size, (seed, measure, grid.shape)


@pytest.mark.parametrize("name", [n for n in GRIDS if n != "hemisphere"])
def test_exact_grids_stay_in_every_mode(name):
    ways = [{"as_": as_, "mode": m} for as_ in ("control", "fit") for m in ("faithful", "sweeps")]
    ways += [
        {"as_": "control"},
        {"as_": "fit", "bound": "curve"},
        {"as_": "fit", "bound": "points"},
    ]
    for seed in range(10 if SOAK else 2):
        grid, closed, size = drawn(name, seed)
        for way in ways:
            faired = moldloft.fair(grid, 1e-2 * size, closed=closed, **way)
            assert np.abs(faired.points - grid).max() <= 1e-12 * size, way
            assert any("are unchanged" in note for note in faired.notes)
            assert "note: the points are on lines" in str(faired)
        moved = moldloft.fair(grid, 1e-2 * size, closed=closed, as_="control", goal="fairest")
        if name != "plane":
            assert np.abs(moved.points - grid).max() > 1e-4 * size
        if name in ("hemisphere", "torus"):
            continue
        data, curves = grid.reshape(-1, 3), lines_of(grid.shape[:2], closed)
        for way in ({"mode": "faithful"}, {"mode": "sweeps"}, {"spacing": "index"}):
            net = network(data, curves, 1e-2 * size, **way)
            assert np.abs(net.points - data).max() <= 1e-12 * size, way


@pytest.mark.parametrize("seams", ["position", "tangent", "curvature"])
def test_exact_patches_move_by_what_their_seams_ask_for(seams):
    rng = np.random.default_rng(2)
    u, v = np.meshgrid(np.arange(15.0), np.arange(7.0), indexing="ij")
    flat = np.stack([u, 0.3 * u - 0.1 * v, v], -1)
    bent = np.stack([u, 0.02 * u**2 + 0.01 * v**2, v], -1)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    for name, grid in (("flat", flat), ("bent", bent), ("turned", bent @ turn.T)):
        for as_ in ("fit", "control"):
            both = [grid[:8], grid[7:]]
            faired = patches(both, 0.05, seams=seams, as_=as_)
            far = max(np.abs(a - b).max() for a, b in zip(faired.grids, both, strict=True))
            # The knots of control points at an end are not even: parabolas do not run on.
            exact = name == "flat" or as_ == "fit" or seams == "position"
            size = np.abs(grid).max() + np.ptp(grid)
            assert far <= (1e-12 * size if exact else 0.05), (name, as_, far)
            if name != "flat" and as_ == "fit":
                moved = patches(both, 0.05, seams=seams, as_=as_, goal="fairest", measure="bending")
                assert np.abs(moved.grids[0] - both[0]).max() > 1e-3
    angle = np.linspace(0, 1.5, 15)
    arc = np.stack([np.cos(angle), np.sin(angle), 0 * angle], -1)
    tube = arc[:, None] + np.arange(6.0)[:, None] * np.array([0, 0, 0.3])
    both = [tube[:8], tube[7:]]
    faired = patches(both, 0.05, seams=seams)
    far = max(np.abs(a - b).max() for a, b in zip(faired.grids, both, strict=True))
    assert far < 2e-4, far


def test_corners_between_exact_parts_stay():
    rng = np.random.default_rng(3)
    for _ in range(40 if SOAK else 5):
        a = np.pi * along(rng, 14)
        arc = np.c_[np.cos(a), np.sin(a), 0 * a]
        leg = np.c_[-1 + 0 * a, -3 * along(rng, 14), 0 * a]
        data = np.concatenate([arc, leg[1:]])
        for measure in ("variation", "second"):
            faired = moldloft.fair(data, 0.02, as_="fit", measure=measure, breaks=(13,))
            assert np.abs(faired.points - data).max() <= 1e-12
        closing = np.c_[-1 + 2 * along(rng, 12), -3 + 0 * along(rng, 12), 0 * along(rng, 12)]
        right = np.c_[1 + 0 * a, -3 + 3 * along(rng, 14), 0 * a]
        ring = np.concatenate([data, closing[1:], right[1:-1]])
        corners = (0, 13, 26, 37)
        faired = moldloft.fair(ring, 0.02, as_="fit", closed=True, breaks=corners)
        assert np.abs(faired.points - ring).max() <= 1e-12


def number(x):
    return repr(float(x))


def vector(p):
    return "{" + ", ".join(number(c) for c in p) + "}"


def curve_text(points, rest):
    return f"FairCurve c({{{', '.join(vector(p) for p in points)}}}, {rest});"


def grid_text(grid, rest):
    m, n = grid.shape[:2]
    cells = [f"g[{i + 1},{j + 1}] = {vector(grid[i, j])};" for i in range(m) for j in range(n)]
    return f"surface g[{m},{n}]; " + " ".join(cells) + f" FairSurf s(g, {rest});"


@pytest.mark.parametrize("measure", ["second", "variation"])
def test_exact_entities_stay(measure):
    rng = np.random.default_rng(5)
    u = along(rng, 20)
    curves = {
        "line": np.c_[3 * u, 0.4 * u, u],
        "parabola": np.c_[3 * u - 1, 0.5 * (3 * u - 1) ** 2, 0 * u],
        "circle": np.c_[np.cos(2.5 * u), np.sin(2.5 * u), 0 * u],
        "helix": np.c_[np.cos(4 * u), np.sin(4 * u), 0.9 * u],
    }
    for name, points in curves.items():
        text = curve_text(points, f'0.05, measure = "{measure}"')
        assert moldloft.loads(text).eval("c.deviation") <= 1e-12, name
    a = around(rng, 18)
    ring = np.c_[np.cos(a), np.sin(a), 0 * a]
    text = curve_text(ring, f'0.05, measure = "{measure}", closed = 1')
    assert moldloft.loads(text).eval("c.deviation") <= 1e-12
    for name in ("plane", "translated", "tube", "helicoid"):
        grid, _, size = drawn(name, 2)
        text = grid_text(grid, f'{number(0.01 * size)}, measure = "{measure}"')
        assert moldloft.loads(text).eval("s.deviation") <= 1e-12 * size, name
    grid, closed, size = drawn("cylinder", 4)
    points = "".join(
        f"AbsPoint P{k}({number(p[0])}, {number(p[1])}, {number(p[2])}); "
        for k, p in enumerate(grid.reshape(-1, 3))
    )
    lines = ", ".join(
        "{" + ", ".join(f"P{k}" for k in line) + "}" for line in lines_of(grid.shape[:2], closed)
    )
    net = f'FairNet n({{{lines}}}, {number(0.01 * size)}, measure = "{measure}");'
    model = moldloft.loads(points + net + " NetCurve a(n, 1); NetCurve b(n, 20);")
    assert model.eval("a.deviation") <= 1e-12 * size
    assert model.eval("b.deviation") <= 1e-12 * size


def samples(model, name, n=9):
    return np.array([model.eval(f"{name}({t})") for t in np.linspace(0, 1, n)], float)


def test_exact_entities_stay_in_every_mode():
    rng = np.random.default_rng(6)
    for _ in range(10 if SOAK else 2):
        u = along(rng, 20, 10)
        for points in (
            np.c_[3 * u, 0.4 * u, u],
            np.c_[3 * u - 1, 0.5 * (3 * u - 1) ** 2, 0 * u],
            np.c_[np.cos(2.5 * u), np.sin(2.5 * u), 0 * u],
        ):
            for way in ('as = "control"', 'as = "points"', 'mode = "faithful"'):
                near = moldloft.loads(curve_text(points, f"0.05, {way}"))
                still = moldloft.loads(curve_text(points, f"0, {way}"))
                far = np.abs(samples(near, "c") - samples(still, "c")).max()
                assert far <= 1e-12, (way, far)
        for name in ("plane", "translated", "tube"):
            grid, _, size = drawn(name, int(rng.integers(100)))
            for way in ('as = "control"', 'mode = "faithful"'):
                models = [
                    moldloft.loads(grid_text(grid, f"{number(tol)}, {way}"))
                    for tol in (0.01 * size, 0)
                ]
                values = [np.array(m.eval("s(0.37, 0.61)"), float) for m in models]
                assert np.abs(values[0] - values[1]).max() <= 1e-12 * size, (name, way)


def test_an_exact_path_on_a_surface_stays():
    text = (
        "Line l({0, 0, 0}, {4, 0, 0}); Line m({0, 0, 3}, {4, 1, 3}); RuledSurf S(l, m); "
        "AbsMagnet p0(S, 0, 0.1); AbsMagnet p1(S, 0.1, 0.14); AbsMagnet p2(S, 0.15, 0.16); "
        "AbsMagnet p3(S, 0.4, 0.26); AbsMagnet p4(S, 0.7, 0.38); AbsMagnet p5(S, 0.8, 0.42); "
        "AbsMagnet p6(S, 0.9, 0.46); AbsMagnet p7(S, 1, 0.5); "
    )
    for way in ("", ', mode = "faithful"'):
        model = moldloft.loads(
            f"{text} FairSnake f({{p0, p1, p2, p3, p4, p5, p6, p7}}, 0.05{way});"
        )
        for p in samples(model, "f"):
            # On S y is u v, v is z / 3 and u is x / 4; the path is v = 0.1 + 0.4 u.
            assert abs(p[2] / 3 - 0.1 - 0.4 * p[0] / 4) < 1e-12, way


def test_entities_report_how_they_came_out():
    rng = np.random.default_rng(7)
    x = np.linspace(0, 10, 24)
    points = np.c_[x, np.sin(x / 3) + 0.02 * rng.uniform(-1, 1, 24), 0 * x]
    model = moldloft.loads(curve_text(points, '0.02, goal = "fairest", measure = "variation"'))
    faired = moldloft.fair(points, 0.02, as_="fit", goal="fairest")
    for name, expected in (
        ("deviation", faired.deviation_data),
        ("value", faired.value),
        ("active", faired.active),
        ("used", faired.used),
        ("findings", len(faired.findings)),
    ):
        assert model.eval(f"c.{name}") == pytest.approx(expected, rel=1e-6), name
    assert model.eval("c.fairest_used") == model.eval("c.used")
    assert 0 <= model.eval("c.gap") < 1e-9
    assert not model.diagnostics
    # A wrong digit, and a tolerance far below the noise.
    points[11, 1] += 0.5
    model = moldloft.loads(curve_text(points, "0.02"))
    assert model.eval("c.findings") == 1
    assert [d.id for d in model.diagnostics] == ["unlike-neighbours"]
    wide = np.c_[x, np.sin(x / 3) + 0.1 * rng.uniform(-1, 1, 24), 0 * x]
    model = moldloft.loads(curve_text(wide, '0.002, goal = "budget"'))
    assert [d.id for d in model.diagnostics] == ["at-its-tolerance"]
    assert model.eval("c.fairest_used") > 2.6
    # A grid.
    u, v = np.meshgrid(np.linspace(0, 4, 15), np.linspace(0, 2, 13), indexing="ij")
    grid = np.stack([u, np.sin(u) * (1 - v**2 / 8), v], -1)
    grid = grid + 0.01 * rng.uniform(-1, 1, grid.shape)
    model = moldloft.loads(grid_text(grid, '0.02, measure = "variation", goal = "budget"'))
    faired = moldloft.fair(grid, 0.02, as_="fit", goal="budget", spacing="chord")
    assert model.eval("s.deviation") == pytest.approx(faired.deviation_data, rel=1e-3)
    assert model.eval("s.used") == pytest.approx(0.8, rel=1e-5)
    assert model.eval("s.findings") == 0
