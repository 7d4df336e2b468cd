"""Entities of models: every option that Python has, with the same result."""

from __future__ import annotations

import argparse
import ast
import inspect

import numpy as np
import pytest

import moldloft
import moldloft.cli.fair
from conftest import ROOT
from moldloft.fairing import network, patches
from moldloft.fairing.curve import fair_curve
from moldloft.fairing.surface import fair_surface

STUBS = ROOT / "python/moldloft/kinds.pyi"

NAMES = {
    "tol": ("tolerance",),
    "as_": ("as_",),
    "motion": ("along", "motion"),
    "goal": ("goal", "share"),
}
"""Names of Python's options in models, where they are others."""

OF_CURVES = {
    "tol": ("tolerance", "tolerances"),
    "ends": ("ends", "last_end"),
    "through": ("through", "through_at"),
    "tangents": ("tangents", "tangents_at"),
}

KINDS = {
    "FairCurve": (fair_curve, OF_CURVES, {"original", "accuracy", "log", "draft"}),
    "FairSnake": (
        fair_curve,
        {**OF_CURVES, "points": ("magnets",)},
        {"original", "accuracy", "log", "draft", "joins", "keep"},
    ),
    "FairSurf": (
        fair_surface,
        {
            "tol": ("tolerance", "tolerances"),
            "degree": ("degree", "degree_v"),
            "closed": ("closed_u", "closed_v"),
            "knots": ("knots_u", "knots_v"),
            "breaks": ("breaks_u", "breaks_v"),
            "through": ("through", "through_u", "through_v"),
            "normals": ("normals", "normals_u", "normals_v"),
            # What ends keep is asked of rims.
            "ends": ("rims",),
        },
        {"original"},
    ),
    "FairNet": (
        network,
        {"tol": ("tolerance", "tolerances", "tolerances_at"), "points": ("curves",)},
        {"original", "names"},
    ),
    "FairPatches": (patches, {"degree": ("degree", "degree_v"), "goal": ("goal",)}, set()),
}
"""Python's function, its options that have other names in models, and those that models lack."""

COMMAND = {
    "points": "file",
    "curves": "file",
    "names": "file",
    "surfaces": "file",
    "tol": "tol",
    "as_": "role",
    "motion": "along",
    "tangents": "tangent",
    "normals": "normal",
    "joins": "join",
    "least_move": "stop",
    "least_drop": "stop",
    "stop_gap": "stop",
    "stop_pieces": "stop",
}
"""Names of Python's options in the command, where they are others."""

BY_ORDER = {"order", "draft"}
"""A pass of the command fairs curves of constant v first."""


def declared(kind):
    tree = ast.parse(STUBS.read_text())
    return next(n for n in tree.body if isinstance(n, ast.FunctionDef) and n.name == kind)


def options_of(kind):
    made = declared(kind)
    given = made.args.posonlyargs + made.args.args + made.args.kwonlyargs
    return {a.arg for a in given}


def lacking(python, have, names, absent):
    """Options of Python that others have not, by the names that these have there."""
    wanted = {(o, n) for o in python - absent for n in names.get(o, (o,))}
    return sorted((o, n) for o, n in wanted if n not in have)


@pytest.mark.parametrize("kind", KINDS)
def test_entities_have_the_options_of_python(kind):
    function, names, absent = KINDS[kind]
    have = options_of(kind)
    python = set(inspect.signature(function).parameters)
    names = {**NAMES, **names}
    assert not lacking(python, have, names, absent)
    # What is said to be absent is, so that the list does not grow old.
    assert absent <= python and not {a for a in absent if a in have}, kind
    # The reference says why.
    words = {"log": "the log of single", "names": "Options refer to curves by number"}
    said = " ".join(
        (ast.get_docstring(declared(kind)) + ast.get_docstring(declared("FairCurve"))).split()
    )
    for option in absent:
        assert words.get(option, f"`{option}`") in said, (kind, option)
    # Another option of Python's, or one taken from the kind, is missed.
    assert lacking({*python, "sheen"}, have, names, absent) == [("sheen", "sheen")]
    for option in sorted(python - absent):
        for name in names.get(option, (option,)):
            assert (option, name) in lacking(python, have - {name}, names, absent)


def test_the_command_has_the_options_of_python():
    parser = argparse.ArgumentParser()
    moldloft.cli.fair.add(parser)
    have = {action.dest for action in parser._actions}
    names = {o: (n,) for o, n in COMMAND.items()}
    for function, _, _ in KINDS.values():
        python = set(inspect.signature(function).parameters)
        assert not lacking(python, have, names, BY_ORDER)
        assert lacking({*python, "sheen"}, have, names, BY_ORDER) == [("sheen", "sheen")]


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
    "bound": ('bound = "curve"', {"bound": "curve"}),
    "shape": ('shape = {"10..16: concave"}', {"shape": ["10..16: concave"]}),
    "keep": ('keep = {"volume"}', {"keep": ["volume"]}),
    "knuckles": ("knuckles = {12}", {"breaks": ["curve 12"]}),
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
    options = {"goal": ("near", 0.8), "spacing": "chord", **options}
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
        ('spacing = "z"', "unknown spacing"),
        ('goal = "energy"', "largest measure"),
        ('shape = {"convex=9-99"}', "expected"),
        ('mode = "faithful", goal = "budget"', "near their points"),
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
    wanted = moldloft.fair(points, 0.01, at=at, goal="budget")
    list_ = "{" + ", ".join(map(number, at)) + "}"
    text = f"{points_text(points)} FairCurve c({names(range(12))}, 0.01"
    rest = 'goal = "budget"'
    m = moldloft.loads(f"{text}, {rest}, at = {list_});")
    t = np.linspace(0, 1, 17)
    here = np.array([m.eval(f"c({x})") for x in t], float)
    assert np.abs(here - wanted.spline(t)).max() < 2e-6
    back = "{" + ", ".join(map(number, at[::-1])) + "}"
    for wrong, said in (("{0, 1}", "too many or too few parameters"), (back, "parameters rise")):
        with pytest.raises(moldloft.Error, match=said):
            moldloft.loads(f"{text}, {rest}, at = {wrong});").eval("c(0.5)")


def draws(n=20, seed=4, noise=2e-3):
    rng = np.random.default_rng(seed)
    t = np.sort(np.r_[0, 1, rng.uniform(0, 1, n - 2)])
    wave = np.column_stack([t, 0.3 * np.sin(2.4 * t), 0.2 * t**2])
    return wave + noise * rng.uniform(-1, 1, (n, 3)) * [0.2, 1, 1]


KNOTS = [0, 0, 0, 0, 0.2, 0.4, 0.5, 0.7, 0.9, 1, 1, 1, 1]

CURVES = {
    # What Python has, in models: options of the kind, of the function, and a closed curve.
    "bound": ('bound = "curve"', {"bound": "curve"}),
    "bound, centripetal": (
        'bound = "curve", spacing = "centripetal", last_end = "tangent"',
        {"bound": "curve", "spacing": "centripetal"},
    ),
    "count": ("count = 9", {"count": 9}),
    "knots": (f"knots = {{{', '.join(map(str, KNOTS))}}}", {"knots": KNOTS}),
    "weights": ("weights = {weights}", {"weights": True}),
    "faithful": ('mode = "faithful", as = "fit"', {"mode": "faithful"}),
    "literal": ('mode = "literal", as = "points"', {"mode": "literal", "as_": "points"}),
    "vertex": (
        'mode = "vertex", as = "points", measure = "third", steps = 55',
        {"mode": "vertex", "as_": "points", "measure": "third", "steps": 55},
    ),
    "least move": (
        'mode = "vertex", as = "points", steps = 9999, least_move = 0.02',
        {"mode": "vertex", "as_": "points", "steps": 9999, "least_move": 0.02},
    ),
    "least drop": (
        'mode = "vertex", as = "points", steps = 9999, least_drop = 0.002',
        {"mode": "vertex", "as_": "points", "steps": 9999, "least_drop": 0.002},
    ),
    "stop gap": (
        'mode = "faithful", as = "points", steps = 9999, stop_gap = 0.2',
        {"mode": "faithful", "as_": "points", "steps": 9999, "stop_gap": 0.2},
    ),
    "stop pieces": (
        'mode = "faithful", as = "points", steps = 9999, stop_pieces = 1',
        {"mode": "faithful", "as_": "points", "steps": 9999, "stop_pieces": True},
    ),
    "sweeps": (
        'mode = "sweeps", as = "points", steps = 7',
        {"mode": "sweeps", "as_": "points", "steps": 7},
    ),
    "levels": ('mode = "levels", as = "points"', {"mode": "levels", "as_": "points"}),
    "box": ('motion = "box"', {"motion": "box", "as_": "data"}),
    "across": (
        'along = {1, 0, 0}, motion = "across"',
        {"motion": ("across", (1, 0, 0)), "as_": "data"},
    ),
    "last end": (
        'last_end = "curvature", goal = "fairest"',
        {"ends": (None, "curvature"), "as_": "data", "goal": "fairest"},
    ),
    "centroid": ('keep = {"centroid"}', {"keep": ["centroid"], "as_": "data"}),
    "ring": (
        'as = "control", closed = 1, period = 1.1, knots = {ring}',
        {"as_": "control", "closed": True, "period": 1.1, "knots": True},
    ),
    "tolerances": ('bound = "curve", tolerances = {each}', {"bound": "curve", "tol": True}),
}


@pytest.mark.parametrize("name", CURVES)
def test_curves_of_models(name):
    points = draws()
    n = len(points)
    text, options = CURVES[name]
    rng = np.random.default_rng(8)
    weights = 1 + 0.3 * rng.random(n)
    ring = np.sort(rng.random(n))
    each = 2e-3 * (0.5 + rng.random(n))
    lists = {"weights": weights, "ring": ring, "each": each}
    for word, values in lists.items():
        text = text.replace(f"{{{word}}}", "{" + ", ".join(map(number, values)) + "}")
    options = {"as_": "fit", **options}
    if options["as_"] == "data":
        options["as_"] = "fit"
    tol = 3e-3
    if options.get("weights"):
        options["weights"] = weights
    if options.get("knots") is True:
        options["knots"] = ring
    elif options.get("knots"):
        tol = 0.03
    if options.pop("tol", False):
        tol = each
    one = tol if np.ndim(tol) == 0 else 1.0
    m = moldloft.loads(
        f"{points_text(points)} FairCurve c({names(range(n))}, {number(one)}, {text});"
    )
    wanted = moldloft.fair(points, tol, **options)
    t = np.linspace(0, 1, 33)
    here = np.array([m.eval(f"c({number(x)})") for x in t], float)
    there = wanted.spline(t)
    assert np.abs(here - there).max() < 2e-7, np.abs(here - there).max()
    assert np.abs(there - wanted.original(t)).max() > 1e-5
    if options.get("mode", "optimum") != "optimum":
        assert m.eval("c.steps") == wanted.steps
    if "count" in options or ("knots" in options and options["as_"] == "fit"):
        assert m.eval("c.deviation") == pytest.approx(wanted.deviation_data, rel=1e-6)
    if "bound" in options or "mode" in options:
        assert m.eval("c.value") == pytest.approx(wanted.value, rel=1e-6)


REFUSED = {
    'bound = "curve", goal = "budget"': "`goal` is for curves near their points",
    'bound = "round"': "unknown bound",
    "count = 99": "expected",
    "count = 9, tolerances = {"
    + ", ".join(20 * ["0.0001"])
    + "}": "use more control points or a larger tolerance",
    'count = 9, as = "control"': "cannot be combined with",
    "count = 9, breaks = {4}": "cannot be combined with",
    'mode = "literal", bound = "curve"': "cannot be combined with",
    'mode = "literal", measure = "jump-lengths"': "local steps do not apply",
    'mode = "slow"': "unknown mode",
    "steps = 3": "for another mode",
    "stop_pieces = 1": "for another mode",
    'mode = "sweeps", least_move = 0.1': "for another mode",
    'mode = "levels", shape = {"convex"}': "near their points",
    "period = 2": "knots of a closed curve",
    'motion = "across"': "not determined",
    'motion = "box", along = {0, 1, 0}': "not determined",
    'motion = "round"': "unknown motion",
    'last_end = "round"': "unknown end condition",
    'as = "control", spacing = "chord"': "cannot be combined with",
    'as = "points", weights = {1, 1}, spacing = "index"': "of control points and fits",
    "knots = {0, 0, 0, 0, 1, 1, 1, 1}": "expected",
    'as = "control", fixed = {99}': "no point 99",
    'as = "control", tolerances = {1}': "too many or too few",
    'through = {p3}, through_at = {0.5}, mode = "vertex"': "cannot be combined with",
}


@pytest.mark.parametrize("text", REFUSED)
def test_curves_refuse_what_they_cannot_do(text):
    points = draws()
    made = f"{points_text(points)} FairCurve c({names(range(20))}, 0.003, {text});"
    with pytest.raises(moldloft.Error) as caught:
        moldloft.loads(made).eval("c(0.5)")
    assert REFUSED[text] in str(caught.value), str(caught.value)


MORE_SNAKES = {
    "at": ("at = {at}", {"at": True}),
    "along": ("along = {0, 1, 0}", {"motion": (0, 1, 0), "spacing": "auto"}),
    "bound": ('bound = "curve"', {"bound": "curve"}),
    "count": ("count = 9", {"count": 9}),
    "literal": (
        'mode = "literal", as = "points", measure = "second"',
        {"mode": "literal", "as_": "points", "measure": "second", "ends": 1},
    ),
    "through": ("through = {x}, through_at = {0.4}", {"through": [(0.4, (0.43, 0.78))]}),
    "tangents": (
        "tangents = {{1, 0.5, 0}}, tangents_at = {0.3}",
        {"tangents": [(0.3, (1, 0.5))]},
    ),
}


@pytest.mark.parametrize("name", MORE_SNAKES)
def test_snakes_have_the_options_of_curves(name):
    uv = path()
    text, options = MORE_SNAKES[name]
    at = np.linspace(0, 1, 12) ** 1.1
    text = text.replace("{at}", "{" + ", ".join(map(number, at)) + "}")
    options = {"ends": "position", "measure": "variation", "as_": "fit", **options}
    if options.get("at"):
        options["at"] = at
    data = not {"bound", "count", "mode"} & set(options)
    if data:
        options = {"goal": ("near", 0.8), "spacing": "chord", **options}
    if "measure" not in text:
        text += ', measure = "variation"'
    model = snake(uv, f'ends = "position", {text}').replace(
        "FairSnake", "AbsMagnet x(S, 0.43, 0.78); FairSnake"
    )
    if "through" in options:
        model = model.replace("0.01, ends", "0.05, ends")
    m = moldloft.loads(model)
    place = np.array([m.eval(f"a{k}") for k in range(len(uv))], float)
    axes = [0, 1] if np.abs(place - uv).max() < 1e-12 else [1, 0]
    wanted = moldloft.fair(uv, 0.05 if "through" in options else 0.01, **options)
    t = np.linspace(0, 1, 17)
    here = np.array([m.eval(f"f({x})") for x in t], float)
    assert np.abs(here[:, axes] - wanted.spline(t)[:, :2]).max() < 2e-6
    with pytest.raises(moldloft.Error, match="leaves the parameter plane"):
        moldloft.loads(snake(uv, "along = {0, 1, 1}")).eval("f(0.5)")


def test_a_closed_snake():
    a = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    rng = np.random.default_rng(1)
    uv = 0.5 + 0.3 * np.column_stack([np.cos(a), np.sin(a)]) + 0.004 * rng.uniform(-1, 1, (16, 2))
    m = moldloft.loads(snake(uv, 'closed = 1, goal = "fairest"'))
    wanted = moldloft.fair(uv, 0.01, closed=True, goal="fairest", spacing="chord")
    place = np.array([m.eval(f"a{k}") for k in range(16)], float)[:, :2]
    axes = [0, 1] if np.abs(place - uv).max() < 1e-12 else [1, 0]
    t = np.linspace(0, 1, 17)
    here = np.array([m.eval(f"f({x})") for x in t], float)
    assert np.abs(here[:, axes] - wanted.spline(t)[:, :2]).max() < 2e-6
    assert np.abs(here[0] - here[-1]).max() < 1e-12


@pytest.mark.parametrize("word", ["box", "across"])
def test_motions_of_networks_and_surfaces(word):
    data, lines = hull()
    motion = "box" if word == "box" else ("across", (1, 0, 0))
    text = 'motion = "box"' if word == "box" else 'along = {1, 0, 0}, motion = "across"'
    options = {"measure": "third", "motion": motion, "goal": "fairest"}
    wanted = network(data, lines, 0.012, spacing="index", **options)
    lists = ", ".join(names(own) for own in lines)
    m = moldloft.loads(
        f"{points_text(data)} FairNet n({{{lists}}}, 0.012, {text}, "
        'measure = "third", goal = "fairest", spacing = "index"); NetCurve w(n, 2);'
    )
    assert_passes(m, lines, wanted.points, {"w": 1}, index=True)
    grid = data.reshape(9, 7, 3)
    options["measure"] = "variation"
    surface = fair_surface(grid, 0.012, as_="fit", spacing="centripetal", **options)
    m = moldloft.loads(
        f'{sheet(grid, "g")} FairSurf s(g, 0.012, measure = "variation", '
        f'spacing = "centripetal", goal = "fairest", {text});'
    )
    t = np.linspace(0, 1, 6)
    here = np.array([[m.eval(f"s({u}, {v})") for v in t] for u in t], float)
    assert np.abs(here - surface.surface.grid(t, t)).max() < 2e-6
