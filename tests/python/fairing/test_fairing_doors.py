"""One answer: Python, models and the command give the same curve, whatever the options."""

from __future__ import annotations

import json
import os
import re

import numpy as np
import pytest

import moldloft
from moldloft.cli import main
from moldloft.language import reference

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def draw(seed):
    """Points of a slender or a strongly curved line with noise, and its bound."""
    rng = np.random.default_rng(9000 + seed)
    n = int(rng.integers(9, 60))
    t = np.sort(np.r_[0, 1, rng.uniform(0.02, 0.98, n - 2)])
    t = 0.5 * t + 0.5 * np.linspace(0, 1, n)
    forms = [
        np.column_stack([10 * t, 0.1 * t]),
        np.column_stack([10 * t, 1.2 - 0.9 * t + 1.1 * t**2]),
        np.column_stack([10 * t, np.tanh(4 * (t - 0.5))]),
        np.column_stack([3 * np.cos(0.1 + 2.9 * t), np.sin(0.1 + 2.9 * t)]),
        np.column_stack([5 * t, (1 - (2 * t - 1) ** 2) ** 2]),
    ]
    rows = forms[seed % len(forms)]
    tol = 2e-3 * np.ptp(rows, axis=0).max()
    return rows + tol * rng.uniform(-0.7, 0.7, rows.shape), tol


OPTIONS = {
    "default": ("", {}, []),
    "fairest": ('goal = "fairest"', {"goal": "fairest"}, ["--goal", "fairest"]),
    "budget": (
        'goal = "budget", share = 0.4',
        {"goal": ("budget", 0.4)},
        ["--goal", "budget=0.4"],
    ),
    "nearest": (
        'goal = "nearest", share = 0.2',
        {"goal": ("nearest", 0.2)},
        ["--goal", "nearest=0.2"],
    ),
    "closest": (
        'goal = "closest", shape = {"one-way=1-4"}',
        {"goal": "closest", "shape": ["one-way=1-4"]},
        ["--goal", "closest", "--shape", "one-way=1-4"],
    ),
    "measure": ('measure = "third"', {"measure": "third"}, ["--measure", "third"]),
    "degree": ("degree = 4", {"degree": 4}, ["--degree", "4"]),
    "ends": (
        'ends = "position", last_end = "tangent"',
        {"ends": ("position", "tangent")},
        ["--ends", "position,tangent"],
    ),
    "chord": ('spacing = "chord"', {"spacing": "chord"}, ["--spacing", "chord"]),
    "curvature": ('spacing = "curvature"', {"spacing": "curvature"}, ["--spacing", "curvature"]),
    "bends": ("bends = 1", {"bends": True}, ["--bends"]),
    "along": ("along = {0, 1, 0}", {"motion": (0, 1)}, ["--along", "0,1"]),
    "across": (
        'along = {1, 0, 0}, motion = "across"',
        {"motion": ("across", (1, 0, 0))},
        ["--across", "1,0"],
    ),
    "box": ('motion = "box"', {"motion": "box"}, ["--box"]),
    "bound": ('bound = "curve"', {"bound": "curve"}, ["--bound", "curve"]),
    "points": ('bound = "points"', {"bound": "points"}, ["--bound", "points"]),
    "control": ('as = "control"', {"as_": "control"}, ["--as", "control"]),
    "moved": (
        'as = "points", spacing = "index"',
        {"as_": "points", "spacing": "index"},
        ["--as", "points", "--spacing", "index"],
    ),
    "index": ('spacing = "index"', {"spacing": "index"}, ["--spacing", "index"]),
    "centripetal": (
        'spacing = "centripetal"',
        {"spacing": "centripetal"},
        ["--spacing", "centripetal"],
    ),
    "x": (
        'spacing = "x", goal = "fairest"',
        {"spacing": "x", "goal": "fairest"},
        ["--spacing", "x", "--goal", "fairest"],
    ),
    "faithful": ('mode = "faithful"', {"mode": "faithful"}, ["--mode", "faithful"]),
    "faithful fit": (
        'mode = "faithful", as = "fit"',
        {"mode": "faithful", "as_": "fit"},
        ["--mode", "faithful", "--as", "fit"],
    ),
    "bound of moved": (
        'as = "points", bound = "curve"',
        {"as_": "points", "bound": "curve"},
        ["--as", "points", "--bound", "curve"],
    ),
    "keep": ('keep = {"area"}', {"keep": ["area"]}, ["--keep", "area"]),
}


def listed(values):
    return "{" + ", ".join(repr(float(x)) for x in values) + "}"


def of_data(name, rows, tol):
    """Options of which data are a part: text, options, words; values for files by their option."""
    n = len(rows)
    k, m = n // 3, 2 * n // 3
    ring = np.linspace(0, 1, n + 1)
    ring[1:-1] += 0.2 / n * np.sin(np.arange(1, n))
    # Beside the means of neighbouring parameters, so that the fit is well determined.
    lengths = np.r_[0, np.cumsum(np.linalg.norm(np.diff(rows, axis=0), axis=1))]
    means = np.convolve(lengths / lengths[-1], np.ones(3) / 3, "valid")[1:-1]
    knots = np.r_[[0.0] * 4, means, [1.0] * 4]
    weights = 1 + 0.5 * np.sin(np.arange(n))
    tols = tol * (1 + 0.5 * np.cos(np.arange(n)))
    at = np.linspace(0, 1, n) ** 1.1
    x, y = map(float, rows[k])
    by = [float(d) for d in rows[m] - rows[k]]
    local = {"as_": "control", "steps": 5}
    return {
        "breaks": (f"breaks = {{{k + 1}}}", {"breaks": [k]}, ["--breaks", str(k + 1)], {}),
        "closed": ("closed = 1", {"closed": True}, ["--closed"], {}),
        "fixed": (f"fixed = {{{k + 1}}}", {"fixed": [k]}, ["--fixed", str(k + 1)], {}),
        "release": (f"release = {{{k + 1}}}", {"release": [k]}, ["--release", str(k + 1)], {}),
        "through": (
            f"through = {{{{{x!r}, {y!r}, 0}}}}, through_at = {{0.3}}",
            {"through": [(0.3, rows[k])]},
            ["--through", f"0.3={x!r},{y!r}"],
            {},
        ),
        "tangents": (
            f"tangents = {{{{{by[0]!r}, {by[1]!r}, 0}}}}, tangents_at = {{0.5}}",
            {"tangents": [(0.5, by)]},
            ["--tangent", f"0.5={by[0]!r},{by[1]!r}"],
            {},
        ),
        "tolerances": (f"tolerances = {listed(tols)}", {"tol": tols}, [], {"--tol": tols}),
        "at": (f"at = {listed(at)}", {"at": at}, [], {"--at": at}),
        "count": ("count = 7", {"count": 7}, ["--count", "7"], {}),
        "energy": (
            'goal = "energy", share = 1e9',
            {"goal": ("energy", 1e9)},
            ["--goal", "energy=1e9"],
            {},
        ),
        "weights": (
            f"weights = {listed(weights)}",
            {"weights": weights},
            [],
            {"--weights": weights},
        ),
        "knots": (
            f"knots = {listed(knots)}",
            {"knots": knots},
            [],
            {"--knots": knots},
        ),
        "period": (
            f"closed = 1, period = 2, knots = {listed(2 * ring[:-1])}",
            {"closed": True, "period": 2.0, "knots": 2 * ring[:-1]},
            ["--closed", "--period", "2"],
            {"--knots": 2 * ring[:-1]},
        ),
        "joins": (
            "joins = {before}",
            {"joins": [moldloft.fairing.Spline.interpolate(neighbour(rows))]},
            [],
            {"--join": neighbour(rows)},
        ),
        "joins of fits": (
            'joins = {before}, bound = "curve"',
            {"joins": [moldloft.fairing.Spline.interpolate(neighbour(rows))], "bound": "curve"},
            ["--bound", "curve"],
            {"--join": neighbour(rows)},
        ),
        "joins and keep": (
            'joins = {before}, keep = {"area"}, goal = "fairest"',
            {
                "joins": [moldloft.fairing.Spline.interpolate(neighbour(rows))],
                "keep": ["area"],
                "goal": "fairest",
            },
            ["--keep", "area", "--goal", "fairest"],
            {"--join": neighbour(rows)},
        ),
        "least_move": (
            'mode = "faithful", as = "control", least_move = 0.5',
            {"mode": "faithful", "as_": "control", "least_move": 0.5},
            ["--mode", "faithful", "--as", "control", "--stop", "move=0.5"],
            {},
        ),
        "least_drop": (
            'mode = "faithful", as = "control", least_drop = 0.05',
            {"mode": "faithful", "as_": "control", "least_drop": 0.05},
            ["--mode", "faithful", "--as", "control", "--stop", "drop=0.05"],
            {},
        ),
        "stop_gap": (
            'mode = "faithful", as = "control", stop_gap = 0.1',
            {"mode": "faithful", "as_": "control", "stop_gap": 0.1},
            ["--mode", "faithful", "--as", "control", "--stop", "gap=0.1"],
            {},
        ),
        "stop_pieces": (
            'mode = "faithful", as = "control", stop_pieces = 1',
            {"mode": "faithful", "as_": "control", "stop_pieces": True},
            ["--mode", "faithful", "--as", "control", "--stop", "pieces"],
            {},
        ),
        **{
            mode: (
                f'mode = "{mode}", as = "control", steps = 5',
                {"mode": mode, **local},
                ["--mode", mode, "--as", "control", "--steps", "5"],
                {},
            )
            for mode in ("literal", "vertex", "sweeps", "levels")
        },
    }[name]


#: Names of `of_data`.
OF_DATA = (
    "breaks", "closed", "fixed", "release", "through", "tangents", "tolerances", "at", "count",
    "energy", "weights", "knots", "period", "joins", "joins of fits", "joins and keep",
    "least_move", "least_drop", "stop_gap", "stop_pieces", "literal", "vertex", "sweeps", "levels",
)  # fmt: skip


def neighbour(rows):
    """Points of a curve that ends where the data begin, with their direction."""
    step = rows[1] - rows[0]
    lift = np.array([[0, 0.05], [0, 0.03], [0, 0.01], [0, 0], [0, 0], [0, 0]]) * np.ptp(rows)
    return rows[0] - np.arange(5, -1, -1)[:, None] * step + lift


def program(rows, tol, text):
    points = [f"AbsPoint p{k}({float(x)!r}, {float(y)!r}, 0);" for k, (x, y) in enumerate(rows)]
    names = ", ".join(f"p{k}" for k in range(len(rows)))
    if "before" in text:
        for k, (x, y) in enumerate(neighbour(rows)[:-1]):
            points.append(f"AbsPoint b{k}({float(x)!r}, {float(y)!r}, 0);")
        points.append('FairCurve before({b0, b1, b2, b3, b4, p0}, 0, spacing = "chord");')
    rest = f", {text}" if text else ""
    whole = " ".join(points) + f" FairCurve c({{{names}}}, {float(tol)!r}{rest});"
    return re.sub(r"(?<=\d)e-", "E-", whole)


def by_command(rows, tol, words, files, folder, capsys):
    """The control points of the command in this process, or its status."""
    path = folder / "rows.csv"
    path.write_text("\n".join(f"{float(x)!r},{float(y)!r}" for x, y in rows) + "\n")
    given = {"--tol": repr(float(tol))}
    for word, values in files.items():
        given[word] = folder / f"{word.strip('-')}.txt"
        lines = (",".join(repr(float(x)) for x in np.atleast_1d(row)) for row in values)
        given[word].write_text("\n".join(lines) + "\n")
    capsys.readouterr()
    options = [str(part) for pair in given.items() for part in pair]
    status = main(["fair", str(path), *options, *words, "--json"])
    out = capsys.readouterr().out
    return status if status else np.array(json.loads(out)["spline"]["control_points"])


@pytest.mark.parametrize("name", [*OPTIONS, *OF_DATA])
def test_one_answer(name, tmp_path, capsys):
    """Every option in 200 draws in a long run; a draw each otherwise."""
    every = [*OPTIONS, *OF_DATA]
    for seed in range(200) if SOAK else [every.index(name)]:
        rows, tol = draw(seed)
        text, options, words, files = (
            (*OPTIONS[name], {}) if name in OPTIONS else of_data(name, rows, tol)
        )
        here = f"{name}, draw {seed}"
        options = dict(options)
        bound = options.pop("tol", tol)
        written = program(rows, tol, text)
        try:
            faired = moldloft.fair(rows, bound, **options)
        except moldloft.FairingError:
            with pytest.raises(moldloft.Error):
                moldloft.loads(written).eval("c(0)")
            assert by_command(rows, tol, words, files, tmp_path, capsys) == 1, here
            continue
        model = moldloft.loads(written)
        t = np.linspace(0, 1, 41)
        wanted = faired.spline(t)
        found = np.array([model.eval(f"c({float(x)!r})") for x in t], float)
        size = np.ptp(rows, axis=0).max()
        assert np.abs(found - wanted).max() <= 1e-12 * size, here
        control = by_command(rows, tol, words, files, tmp_path, capsys)
        assert np.abs(control - faired.control_points).max() <= 1e-12 * size, here


def test_every_option_of_curves_is_asked_for():
    """A new option of the row is one of these, or of no data here."""
    rows, tol = draw(3)
    asked = [text for text, *_ in OPTIONS.values()]
    asked += [of_data(name, rows, tol)[0] for name in OF_DATA]
    named = set(re.findall(r"(\w+) = ", ", ".join(asked)))
    (row,) = (row for row in reference() if row["name"] == "FairCurve")
    options = {field["name"] for field in row["fields"][2:]}
    assert options - named == {"relabel"}
