"""One answer: Python, models and the command give the same curve, whatever the options."""

from __future__ import annotations

import json
import os

import numpy as np
import pytest

import moldloft

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
    "faithful": (
        'mode = "faithful", as = "control"',
        {"mode": "faithful", "as_": "control"},
        ["--mode", "faithful", "--as", "control"],
    ),
    "keep": ('keep = {"area"}', {"keep": ["area"]}, ["--keep", "area"]),
}


def test_one_answer(cli, tmp_path):
    """200 draws in a long run, each with the default or one of the options."""
    for seed in range(200 if SOAK else len(OPTIONS)):
        name = list(OPTIONS)[seed % len(OPTIONS)] if seed % 2 or not SOAK else "default"
        text, options, words = OPTIONS[name]
        rows, tol = draw(seed)
        here = f"{name}, draw {seed}"
        n = len(rows)
        points = " ".join(
            f"AbsPoint p{k}({float(x)!r}, {float(y)!r}, 0);" for k, (x, y) in enumerate(rows)
        ).replace("e-", "E-")
        listed = "{" + ", ".join(f"p{k}" for k in range(n)) + "}"
        rest = f", {text}" if text else ""
        try:
            faired = moldloft.fair(rows, tol, **options)
        except moldloft.FairingError:
            with pytest.raises(moldloft.Error):
                moldloft.loads(f"{points} FairCurve c({listed}, {float(tol)!r}{rest});").eval(
                    "c(0)"
                )
            continue
        model = moldloft.loads(f"{points} FairCurve c({listed}, {float(tol)!r}{rest});")
        t = np.linspace(0, 1, 41)
        drawn = faired
        if options.get("as_") == "control":
            # Those of models are control points of a clamped spline, which ends at them.
            rest = {word: value for word, value in options.items() if word != "as_"}
            drawn = moldloft.fair(moldloft.fairing.Spline(rows), tol, **rest)
        wanted = drawn.spline(t)
        found = np.array([model.eval(f"c({float(x)!r})") for x in t], float)
        size = np.ptp(rows, axis=0).max()
        assert np.abs(found - wanted).max() <= 1e-12 * size, here
        if seed < len(OPTIONS):
            path = tmp_path / "rows.csv"
            path.write_text("\n".join(f"{float(x)!r},{float(y)!r}" for x, y in rows) + "\n")
            done = cli("fair", path, "--tol", repr(float(tol)), *words, "--json")
            told = json.loads(done.stdout)["spline"]
            control = np.array(told["control_points"])
            assert np.abs(control - faired.control_points).max() <= 1e-12 * size, here
