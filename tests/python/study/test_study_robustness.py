"""Robust design: valid shapes, tolerances, Sobol indices, against closed forms and SALib."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import moldloft
from moldloft import study
from moldloft.study.report import html

# A tetrahedron that loses a face where a is above 2.
SOLID = """
param float a = 1 in [1, 3]; param float b = 1 in [1, 2];
int n = 4; if (a > 2) { n = 3; }
MeshBody body({{0, 0, 0}, {a, 0, 0}, {0, b, 0}, {0, 0, 1}},
    triangles = {1, 3, 2, 1, 2, 4, 2, 3, 4, 1, 4, 3}[1:3 * n]);
"""


def solid(folder: Path, **changes) -> study.Study:
    (folder / "solid.sdl").write_text(SOLID)
    return study.Study(
        model=folder / "solid.sdl",
        inputs=(study.Input("a", tolerance=0.02), study.Input("b", tolerance=0.01)),
        outputs={"volume": "a * b / 6", "b2": "b^2"},
        plan=study.Plan("grid", levels=5),
        folder=folder,
        **changes,
    )


def test_open_shapes_are_invalid(tmp_path):
    results = study.sweep(solid(tmp_path, closed=True), tmp_path / "s.sqlite")
    is_open = results.inputs["a"] > 2
    assert (results.done == ~is_open).all() and is_open.sum() == 10
    assert set(results.id[is_open]) == {"not-closed"} and "open at the edge" in results.message[-1]
    found = study.validity(results)
    assert (found.cases, found.valid) == (25, 15)
    # Wilson's interval of 15 of 25, from its quadratic equation.
    for p in (found.low, found.high):
        assert abs((p - 0.6) ** 2 - 1.959963984540054**2 * p * (1 - p) / 25) < 1e-12
    assert b"Valid: 15 of 25 shapes, 60.0 %" in html(results, "s", {})
    # Without the flag all are evaluated.
    assert study.validity(study.sweep(solid(tmp_path), tmp_path / "t.sqlite")).valid == 25


def test_tolerances_give_rss_and_worst_cases(tmp_path):
    results = study.sweep(solid(tmp_path, derivatives=True), tmp_path / "s.sqlite")
    a, b = results.inputs["a"], results.inputs["b"]
    sizes = {"a": 0.02, "b": 0.01}
    rss, worst = study.spreads(results, sizes), study.worst_cases(results, sizes)
    assert np.allclose(rss["volume"], np.hypot(0.02 * b, 0.01 * a) / 6, rtol=1e-14)
    assert np.allclose(worst["volume"], (0.02 * b + 0.01 * a) / 6, rtol=1e-14)
    assert np.allclose(worst["b2"], 0.02 * b, rtol=1e-14) and (rss["b2"] == worst["b2"]).all()
    page = html(results, "s", {}, tolerances=sizes).decode()
    assert "Tolerances of manufacture" in page and f"{worst['volume'].max():.6g}" in page
    plain = study.sweep(solid(tmp_path), tmp_path / "t.sqlite")
    assert study.spreads(plain, sizes) == {} and "Tolerances" not in html(plain, "s", {}).decode()
    for wrong, said in (({"a": -1}, "at least 0"), ({"c": 1}, "unknown input `c`")):
        with pytest.raises(moldloft.Error, match=said):
            study.worst_cases(results, wrong)


def table(points: np.ndarray, values: np.ndarray) -> study.Results:
    texts = np.array([""] * len(values), dtype=object)
    state = np.array(["done"] * len(values), dtype=object)
    inputs = {f"x{k}": c for k, c in enumerate(points.T)}
    return study.Results(inputs, {"f": values}, state, texts, texts, np.zeros(len(values)))


def test_sobol_indices_are_those_of_salib_and_of_closed_forms():
    saltelli = pytest.importorskip("SALib.analyze.sobol")
    from moldloft.study.plans import _unit

    count = 4096
    unit = _unit("saltelli", 3, count, 5)
    x, y, z = (2 * np.pi * (unit - 0.5)).T
    values = np.sin(x) + 7 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)
    found = study.sobol_indices(table(unit, values), count)["f"]
    # Ishigami and Homma 1990, a = 7, b = 0.1.
    exact = {"x0": (0.3139, 0.5576), "x1": (0.4424, 0.4424), "x2": (0.0, 0.2437)}
    for name, pair in exact.items():
        assert np.allclose(found[name], pair, atol=0.015), name
    # SALib orders a point's mixtures one after another; its total index is Jansen's as well.
    blocks = values.reshape(5, count)
    order = np.stack([blocks[0], *blocks[2:], blocks[1]], axis=1).ravel()
    problem = {"num_vars": 3, "names": ["x0", "x1", "x2"], "bounds": [[0, 1]] * 3}
    peer = saltelli.analyze(problem, order, calc_second_order=False, seed=1)
    for k, name in enumerate(problem["names"]):
        assert abs(found[name][1] - peer["ST"][k]) < 2e-3
        assert abs(found[name][0] - peer["S1"][k]) < 2e-2


def test_a_store_that_is_being_made_is_empty(tmp_path):
    import sqlite3

    from moldloft.study.store import Store

    path = tmp_path / "a.sqlite"
    made = sqlite3.connect(path)
    made.execute("PRAGMA journal_mode = WAL")
    made.close()
    assert path.exists()
    with Store(path) as store:
        assert list(store.outcomes()) == []
