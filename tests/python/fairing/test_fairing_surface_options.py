"""Surfaces of models: every option that Python has, with the same result."""

from __future__ import annotations

import numpy as np
import pytest

import moldloft


def number(x):
    text = repr(float(x))
    return text if "e" not in text else f"{float(x):.20f}"


def vector(p):
    return "{" + ", ".join(number(c) for c in p) + "}"


def model(grid, rest, before=""):
    m, n = grid.shape[:2]
    cells = [f"g[{i + 1},{j + 1}] = {vector(grid[i, j])};" for i in range(m) for j in range(n)]
    return f"surface g[{m},{n}]; " + " ".join(cells) + f" {before} FairSurf s(g, {rest});"


def hull(seed=3, m=9, n=7, noise=0.01):
    rng = np.random.default_rng(seed)
    x = np.sort(np.r_[0, 4, rng.uniform(0.2, 3.8, m - 2)])
    z = np.sort(np.r_[0, 2, rng.uniform(0.1, 1.9, n - 2)])
    u, v = np.meshgrid(x, z, indexing="ij")
    grid = np.stack([u, np.sin(u / 1.5) * (1.2 - v**2 / 8), v], -1)
    grid[..., 1] += noise * rng.uniform(-1, 1, (m, n))
    return grid


def tube(m=12, n=8, noise=0.01):
    rng = np.random.default_rng(8)
    a = 2 * np.pi * np.arange(m) / m
    z = np.linspace(0, 3, n)
    u, v = np.meshgrid(a, z, indexing="ij")
    grid = np.stack([np.cos(u), 0.7 * np.sin(u), v], -1)
    return grid + noise * rng.uniform(-1, 1, grid.shape) * [1, 1, 0]


def places(surface_at, n=6):
    t = np.linspace(0, 1, n)
    return np.array([[surface_at(u, v) for v in t] for u in t], float)


OPEN = {
    "degrees": ("degree = 3, degree_v = 4", {"degree": (3, 4)}),
    "share": ('goal = "budget", share = 0.4', {"goal": ("budget", 0.4)}),
    "nearest": ('goal = "nearest", share = 0.3', {"goal": ("nearest", 0.3)}),
    "fixed": ("fixed = {30, 33}", {"fixed": [(4, 1), (4, 4)]}),
    "volume": ('keep = {"volume"}', {"keep": ["volume"]}),
    "area": ('keep = {"area"}', {"keep": ["area"]}),
    "normal": (
        "normals = {{-0.45, 1, 0.13}}, normals_u = {0.4}, normals_v = {0.3}",
        {"normals": [((0.4, 0.3), (-0.45, 1, 0.13))]},
    ),
}


@pytest.mark.parametrize("name", OPEN)
def test_the_options_of_python(name):
    grid = hull()
    text, options = OPEN[name]
    common = 'measure = "variation", spacing = "centripetal"'
    m = moldloft.loads(model(grid, f"0.02, {common}, {text}"))
    wanted = moldloft.fair(grid, 0.02, as_="fit", spacing="centripetal", **options)
    t = np.linspace(0, 1, 6)
    here = places(lambda u, v: m.eval(f"s({u}, {v})"))
    assert np.abs(here - wanted.surface.grid(t, t)).max() < 2e-6
    assert m.eval("s.deviation") == pytest.approx(wanted.deviation_data, rel=1e-3)
    assert m.eval("s.used") == pytest.approx(wanted.used, rel=1e-3)


def test_points_are_passed_and_limits_are_each_points_own():
    grid = hull()
    common = 'measure = "variation", spacing = "centripetal", goal = "budget"'
    still = moldloft.loads(model(grid, f"0, {common}"))
    middle = np.array(still.eval("s(0.5, 0.5)"), float) + np.array([0, 4e-3, 0])
    point = f"AbsPoint P({', '.join(number(c) for c in middle)});"
    text = f"0.02, {common}, through = {{P}}, through_u = {{0.5}}, through_v = {{0.5}}"
    m = moldloft.loads(model(grid, text, point))
    assert np.abs(np.array(m.eval("s(0.5, 0.5)"), float) - middle).max() < 1e-9
    # Tolerances of their own: tight for three rows, so that these hardly move.
    tight = np.full(grid.shape[:2], 0.02)
    tight[3:6] = 1e-4
    cells = " ".join(
        f"w[{i + 1},{j + 1}] = {number(tight[i, j])};"
        for i in range(tight.shape[0])
        for j in range(tight.shape[1])
    )
    before = f"farray w[{tight.shape[0]},{tight.shape[1]}]; {cells}"
    m = moldloft.loads(model(grid, f"0.02, {common}, tolerances = w", before))
    wanted = moldloft.fair(grid, tight, as_="fit", goal="budget", spacing="centripetal")
    assert (wanted.residuals <= tight * (1 + 1e-9)).all()
    t = np.linspace(0, 1, 6)
    here = places(lambda u, v: m.eval(f"s({u}, {v})"))
    assert np.abs(here - wanted.surface.grid(t, t)).max() < 2e-6


NETS = {
    "bound": ('goal = "fairest", bound = "points"', {"bound": "points"}),
    "curve": ('goal = "fairest", bound = "curve"', {"bound": "curve"}),
    "sweeps": ('goal = "fairest", mode = "sweeps"', {"mode": "sweeps"}),
    "some": ('goal = "fairest", mode = "sweeps", steps = 1', {"mode": "sweeps", "steps": 1}),
    "faithful": ('mode = "faithful"', {"mode": "faithful"}),
    "steps": ('mode = "faithful", steps = 1', {"mode": "faithful", "steps": 1}),
    "order": ('mode = "faithful", order = "uv"', {"mode": "faithful", "order": "uv"}),
    "passes": ('mode = "faithful", passes = 2', {"mode": "faithful", "passes": 2}),
}


def test_methods_of_nets():
    """Each has the result of Python, and none that of another."""
    grid = hull()
    t = np.linspace(0, 1, 6)
    seen = []
    for name, (text, options) in NETS.items():
        m = moldloft.loads(model(grid, f'0.02, spacing = "index", {text}'))
        chosen = {"goal": "fairest", "measure": "second", **options}
        wanted = moldloft.fair(grid, 0.02, as_="fit", **chosen).surface.grid(t, t)
        here = places(lambda u, v, m=m: m.eval(f"s({u}, {v})"))
        assert np.abs(here - wanted).max() < 1e-9, name
        # Fifty sweeps of so small a net end at the optimum under the same bound.
        if name != "sweeps":
            assert all(np.abs(here - other).max() > 1e-7 for other in seen), name
            seen.append(here)


CONTROL = {
    "plain": ("", {}),
    "bound": ('bound = "curve"', {"bound": "curve"}),
    "degrees": ("degree = 4, degree_v = 3", {"degree": (4, 3)}),
    "rims": ('rims = "position"', {"rims": "position"}),
    "faithful": ('mode = "faithful"', {"mode": "faithful"}),
    "along": ("along = {0, 1, 0}", {"motion": (0, 1, 0)}),
}


@pytest.mark.parametrize("name", CONTROL)
def test_control_points(name):
    """Those of a uniform surface, as in Python."""
    grid = hull()
    text, options = CONTROL[name]
    m = moldloft.loads(model(grid, ", ".join(filter(None, ['0.02, as = "control"', text]))))
    wanted = moldloft.fair(grid, 0.02, as_="control", measure="second", **options)
    t = np.linspace(0, 1, 6)
    here = places(lambda u, v: m.eval(f"s({u}, {v})"))
    assert np.abs(here - wanted.surface.grid(t, t)).max() <= 1e-12 * np.ptp(grid)
    assert np.abs(here - wanted.original.grid(t, t)).max() > 1e-4


def test_closed_surfaces():
    grid = tube()
    text = '0.02, measure = "variation", goal = "budget", spacing = "centripetal"'
    for turned in (False, True):
        own = np.swapaxes(grid, 0, 1) if turned else grid
        way = "closed_v = 1" if turned else "closed_u = 1"
        m = moldloft.loads(model(own, f"{text}, {way}"))
        closed = (False, True) if turned else (True, False)
        wanted = moldloft.fair(
            own, 0.02, as_="fit", goal="budget", spacing="centripetal", closed=closed
        )
        t = np.linspace(0, 1, 6)
        here = places(lambda u, v, m=m: m.eval(f"s({u}, {v})"))
        assert np.abs(here - wanted.surface.grid(t, t)).max() < 2e-6
        first, last = (here[:, 0], here[:, -1]) if turned else (here[0], here[-1])
        assert np.abs(first - last).max() < 1e-12
        assert m.eval("s.deviation") == pytest.approx(wanted.deviation_data, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('keep = {"length"}', "cannot be kept"),
        ('degree_v = 2, measure = "variation"', "degree 3 or more"),
        ("fixed = {64}", "1 to 63"),
        ("fixed = {0}", "there is no point 0"),
        ("normals = {{0, 1, 0}}", "parameter along u"),
        ("normals = {{0, 0, 0}}, normals_u = {0.5}, normals_v = {0.5}", "no length"),
        ("normals = {{0, 1, 0}}, normals_u = {1.5}, normals_v = {0.5}", "out of range"),
        ('goal = "energy"', "largest measure"),
        ('mode = "faithful", closed_u = 1', "near their points"),
        ('as = "control", fixed = {3}', "near their points"),
        ('spacing = "index", keep = {"volume"}', "near their points"),
        ("tolerances = w", "grid like the points"),
        ("steps = 4", "`steps` is for another mode"),
        ('mode = "sweeps", order = "uv"', "`order` is for another mode"),
        ("passes = 2", "`passes` is for another mode"),
        ('mode = "sweeps", passes = 2', "`passes` is for another mode"),
        ('mode = "sweeps", share = 0.3', "`share` is for surfaces near their points"),
        ('as = "control", share = 0.3', "`share` is for surfaces near their points"),
        ('bound = "curve", spacing = "centripetal"', "`spacing` is for surfaces near their points"),
        (
            'mode = "faithful", spacing = "centripetal"',
            "`spacing` is for surfaces near their points",
        ),
        ('mode = "faithful", bound = "curve"', "`bound` is for another mode"),
        ('mode = "faithful", order = "u"', "vu"),
        ('bound = "surface"', "points"),
        ('as = "control", bound = "data"', "near their points"),
        ('as = "control", goal = "budget"', "near their points"),
        ('mode = "levels"', "sweeps"),
        (
            "normals = {{0, 1, 0}, {1, 0, 0}}, normals_u = {0.5, 0.5}, normals_v = {0.5, 0.5}",
            "cannot hold within the tolerance",
        ),
    ],
)
def test_what_cannot_be_is_refused(text, words):
    with pytest.raises(moldloft.ModelError) as caught:
        moldloft.loads(model(hull(), f"0.02, {text}", "farray w[2,2]; w[1,1] = 1; w[1,2] = 1; "
                             "w[2,1] = 1; w[2,2] = 1;"))  # fmt: skip
    assert words in str(caught.value), str(caught.value)
