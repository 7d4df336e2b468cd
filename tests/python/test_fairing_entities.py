"""Entities of models: every option that Python has, with the same result."""

from __future__ import annotations

import ast
import inspect

import numpy as np
import pytest

import moldloft
from conftest import ROOT
from moldloft.fairing import network, patches
from moldloft.fairing.curve import fair_curve
from moldloft.fairing.surface import fair_surface

STUBS = ROOT / "python/moldloft/kinds.pyi"

NAMES = {
    "tol": ("tolerance",),
    "as_": ("as_",),
    "motion": ("along",),
    "through": ("through", "through_at"),
    "tangents": ("tangents", "tangents_at"),
}
"""Names of Python's options in models, where they are others."""

LOCAL = {"least_move", "least_drop", "stop_gap", "stop_pieces", "log"}
"""Stops and records of single steps: models have the faithful mode alone, a step per point."""

SAME = {"original", "accuracy"}
"""A model's points are the original, and its optima are solved to rounding."""

KINDS = {
    # Of control points and curves between the data, and of the modes of the report.
    "FairCurve": (fair_curve, {}, LOCAL | SAME | {"bound", "count", "period", "steps"}),
    # A path between magnets is data in the parameter plane, and open.
    "FairSnake": (
        fair_curve,
        {"points": ("magnets",)},
        LOCAL
        | SAME
        | {"as_", "closed", "bound", "motion", "through", "tangents", "keep", "joins", "at"}
        | {"count", "knots", "weights", "period", "steps"},
    ),
    "FairSurf": (
        fair_surface,
        {
            "degree": ("degree", "degree_v"),
            "closed": ("closed_u", "closed_v"),
            "knots": ("knots_u", "knots_v"),
            "breaks": ("breaks_u", "breaks_v"),
            "through": ("through", "through_u", "through_v"),
            "normals": ("normals", "normals_u", "normals_v"),
            # What ends keep is asked of rims.
            "ends": ("rims",),
        },
        SAME,
    ),
    "FairNet": (
        network,
        {"tol": ("tolerance", "tolerances", "tolerances_at"), "points": ("curves",)},
        SAME,
    ),
    "FairPatches": (patches, {"degree": ("degree", "degree_v")}, SAME),
}


def options_of(kind):
    tree = ast.parse(STUBS.read_text())
    made = next(n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name == kind)
    given = made.args.posonlyargs + made.args.args + made.args.kwonlyargs
    return {a.arg for a in given}


@pytest.mark.parametrize("kind", KINDS)
def test_entities_have_the_options_of_python(kind):
    function, names, absent = KINDS[kind]
    have = options_of(kind)
    python = set(inspect.signature(function).parameters)
    for option in python - absent:
        for name in {**NAMES, **names}.get(option, (option,)):
            assert name in have, (kind, option, name)
    # What is said to be absent is, so that the list does not grow old.
    assert not {a for a in absent & python if a in have}, kind


def number(x):
    text = repr(float(x))
    return text if "e" not in text else f"{float(x):.20f}"


def vector(p):
    return "{" + ", ".join(number(c) for c in p) + "}"


def points_text(points, name="p"):
    at = (f"AbsPoint {name}{k}({', '.join(map(number, p))});" for k, p in enumerate(points))
    return " ".join(at)


def names(indices, name="p"):
    return "{" + ", ".join(f"{name}{i}" for i in indices) + "}"


def hull(m=9, n=7, seed=5, noise=0.01):
    rng = np.random.default_rng(seed)
    x = np.sort(np.r_[0, 4, rng.uniform(0.2, 3.8, m - 2)])
    z = np.sort(np.r_[0, 2, rng.uniform(0.1, 1.9, n - 2)])
    a, b = (v.ravel() for v in np.meshgrid(x, z, indexing="ij"))
    y = np.sin(a / 1.5) * (1.2 - b**2 / 8) + noise * rng.uniform(-1, 1, m * n)
    at = np.arange(m * n).reshape(m, n)
    return np.column_stack([a, y, b]), [*at.tolist(), *at.T.tolist()]


def assert_passes(m, lines, points, curves, index=False):
    """Curves pass through points at their stations and heights, or numbers: the parameters."""
    for curve, k in curves.items():
        at = points[lines[k]]
        axis = 0 if np.ptp(at[:, 0]) else 2
        t = np.linspace(0, 1, len(at)) if index else at[:, axis] / at[-1, axis]
        here = np.array([m.eval(f"{curve}({number(x)})") for x in t], float)
        assert np.abs(here - at).max() < 2e-6, curve


NETS = {
    "share": ('goal = "near", share = 0.6', {"goal": ("near", 0.6)}),
    "budget": ('goal = "budget", share = 0.4', {"goal": ("budget", 0.4)}),
    "nearest": ('goal = "nearest", share = 0.3', {"goal": ("nearest", 0.3)}),
    "energy": ('goal = "energy", share = {most}', {"goal": ("energy", None)}),
    "steps": ('mode = "faithful", steps = 2', {"mode": "faithful", "steps": 2}),
}


@pytest.mark.parametrize("name", NETS)
def test_networks_of_models(name):
    data, lines = hull()
    text, options = NETS[name]
    options = dict(options)
    if name == "energy":
        least = network(data, lines, 0.012, measure="third", motion=(0, 1, 0), goal="fairest")
        most = 0.5 * (least.measure_before + least.measure_after)
        text, options["goal"] = text.format(most=number(most)), ("energy", most)
    wanted = network(data, lines, 0.012, measure="third", motion=(0, 1, 0), **options)
    lists = ", ".join(names(own) for own in lines)
    m = moldloft.loads(
        f'{points_text(data)} FairNet n({{{lists}}}, 0.012, measure = "third", '
        f"along = {{0, 1, 0}}, {text}); NetCurve w(n, 2); NetCurve s(n, 12);"
    )
    assert_passes(m, lines, wanted.points, {"w": 1, "s": 11}, index=name == "steps")


def test_points_of_networks_stay_and_have_tolerances_of_their_own():
    data, lines = hull()
    tolerances = np.full(len(data), 0.012)
    tolerances[[16, 30]] = 0.002, 0.03
    corners = [0, 6, 56, 62]
    options = {"measure": "third", "motion": (0, 1, 0), "goal": "budget"}
    wanted = network(data, lines, tolerances, fixed=[*corners, 24], **options)
    lists = ", ".join(names(own) for own in lines)
    head = f"{points_text(data)} AbsPoint q(9, 9, 9); FairNet n({{{lists}}}, 0.012"
    rest = 'measure = "third", along = {0, 1, 0}, goal = "budget"'
    own = "tolerances = {0.002, 0.03}, tolerances_at = {p16, p30}, fixed = {p24}"
    m = moldloft.loads(f"{head}, {rest}, {own}); NetCurve w(n, 3); NetCurve s(n, 13);")
    assert_passes(m, lines, wanted.points, {"w": 2, "s": 12})
    assert (wanted.points[24] == data[24]).all()
    for wrong, said in (
        ("fixed = {q}", "a fixed point is not a point of the network"),
        ("tolerances = {0.1}, tolerances_at = {q}", "is not a point of the network"),
        ("tolerances = {0.1}, tolerances_at = {p16, p30}", "has a tolerance"),
    ):
        with pytest.raises(moldloft.Error, match=said):
            moldloft.loads(f"{head}, {rest}, {wrong});").eval("n")


def path(n=12, seed=2):
    rng = np.random.default_rng(seed)
    t = np.linspace(0.05, 0.95, n)
    v = 0.5 + 0.3 * np.sin(3 * t) + 0.01 * rng.uniform(-1, 1, n)
    return np.column_stack([t, v, np.zeros(n)])


SNAKES = {
    "budget": ('goal = "budget", share = 0.4', {"goal": ("budget", 0.4)}),
    "fairest": ('goal = "fairest"', {"goal": "fairest"}),
    "spacing": ('spacing = "x"', {"spacing": "x"}),
    "curvature": ('spacing = "curvature"', {"spacing": "curvature"}),
    "shape": ('shape = {"concave"}', {"shape": ["concave"]}),
    "fixed": ("fixed = {4}", {"fixed": [3]}),
    "release": ("release = {6}", {"release": [5]}),
    "breaks": ("breaks = {7}", {"breaks": [6]}),
    "bends": ("bends = 0", {"bends": False}),
    "tolerances": (
        "tolerances = {0.01, 0.01, 0.002, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.02, 0.01, 0.01}",
        {"tol": [0.01, 0.01, 0.002, *[0.01] * 6, 0.02, 0.01, 0.01]},
    ),
}

PLANE = (
    "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(1, 1, 0); "
    "Line l(A, C); Line m(B, D); RuledSurf S(l, m);"
)


def snake(uv, rest):
    magnets = " ".join(
        f"AbsMagnet a{k}(S, {number(p[0])}, {number(p[1])});" for k, p in enumerate(uv)
    )
    return f"{PLANE} {magnets} FairSnake f({names(range(len(uv)), 'a')}, 0.01, {rest});"


@pytest.mark.parametrize("name", SNAKES)
def test_snakes_of_models(name):
    """On a plane square whose parameters are lengths a snake is the curve of its magnets."""
    uv = path()
    text, options = SNAKES[name]
    options = {"goal": ("near", 0.8), "spacing": "chord", "bends": True, **options}
    tol = options.pop("tol", 0.01)
    m = moldloft.loads(snake(uv, f'measure = "variation", ends = "position", {text}'))
    place = np.array([m.eval(f"a{k}") for k in range(len(uv))], float)
    axes = [0, 1] if np.abs(place - uv).max() < 1e-12 else [1, 0]
    wanted = moldloft.fair(uv, tol, ends="position", **options)
    t = np.linspace(0, 1, 17)
    here = np.array([m.eval(f"f({x})") for x in t], float)
    assert np.abs(here[:, axes] - wanted.spline(t)[:, :2]).max() < 2e-6
    assert m.eval("f.deviation") == pytest.approx(wanted.deviation_data, rel=1e-3, abs=1e-9)


def test_snakes_refuse_what_they_cannot_do():
    uv = path()
    for text, said in (
        ('spacing = "index"', "unknown spacing"),
        ('goal = "energy"', "largest measure"),
        ('shape = {"convex=9-99"}', "expected"),
        ('mode = "faithful", goal = "budget"', "is for the optimum"),
        ("tolerances = {0.1}", "too many or too few tolerances"),
        ("fixed = {99}", "no point 99"),
    ):
        with pytest.raises(moldloft.Error, match=said):
            moldloft.loads(snake(uv, text)).eval("f(0.5)")


def sheet(points, name):
    m, n = points.shape[:2]
    cells = (f"{name}[{i + 1},{j + 1}] = {vector(points[i, j])};" for i, j in np.ndindex(m, n))
    return f"surface {name}[{m},{n}]; " + " ".join(cells)


@pytest.mark.parametrize(
    ("text", "options"),
    [
        ("along = {0, 1, 0}", {"motion": (0, 1, 0)}),
        ("degree_v = 4", {"degree": (3, 4)}),
        ('bound = "curve"', {"bound": "curve"}),
    ],
)
def test_patches_of_models(text, options):
    data, _ = hull(13, 8, noise=0.002)
    grid = data.reshape(13, 8, 3)
    fore, aft = grid[:7], grid[6:]
    # Where points move in one direction tangents across seams may not meet.
    seams = "position" if "along" in text else "tangent"
    wanted = patches([fore, aft], 0.05, seams=seams, **options)
    m = moldloft.loads(
        f"{sheet(fore, 'g')} {sheet(aft, 'h')} "
        f'FairPatches n({{g, h}}, 0.05, seams = "{seams}", {text}); '
        "NetSurf a(n, 1); NetSurf b(n, 2);"
    )
    t = np.linspace(0, 1, 6)
    for name, surface in zip("ab", wanted.surfaces, strict=True):
        here = np.array([[m.eval(f"{name}({u}, {v})") for v in t] for u in t], float)
        assert np.abs(here - surface.grid(t, t)).max() < 2e-6
    if "along" in text:
        for before, after in zip((fore, aft), wanted.surfaces, strict=True):
            spline = moldloft.fairing.SplineSurface.interpolate(before)
            moved = after.control_points - spline.control_points
            assert np.abs(moved[..., [0, 2]]).max() < 1e-12 < np.abs(moved[..., 1]).max()


def test_a_curve_at_parameters_of_its_own():
    points, at = path(), np.linspace(0, 1, 12) ** 1.3
    wanted = moldloft.fair(points, 0.01, at=at, ends="position", bends=True, goal="budget")
    list_ = "{" + ", ".join(map(number, at)) + "}"
    text = f"{points_text(points)} FairCurve c({names(range(12))}, 0.01"
    rest = 'measure = "variation", goal = "budget"'
    m = moldloft.loads(f"{text}, {rest}, at = {list_});")
    t = np.linspace(0, 1, 17)
    here = np.array([m.eval(f"c({x})") for x in t], float)
    assert np.abs(here - wanted.spline(t)).max() < 2e-6
    back = "{" + ", ".join(map(number, at[::-1])) + "}"
    for wrong, said in (("{0, 1}", "too many or too few parameters"), (back, "parameters rise")):
        with pytest.raises(moldloft.Error, match=said):
            moldloft.loads(f"{text}, {rest}, at = {wrong});").eval("c(0.5)")
