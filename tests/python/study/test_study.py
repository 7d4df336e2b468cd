"""Studies: plans, cases that fail alone, stops and restarts, optima, bad input."""

from __future__ import annotations

import base64
import importlib.util
import json
import math
import os
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest

import moldloft
from moldloft import study
from study_campaign import known

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

BOX = """
param float a = 2 in [1, 4];
param float b = 3 in [1, 4];
param int n = 2 in [1, 5];
AbsPoint P(a, b, a * b);
if (a > 3.9) { print undefined_name; }
"""

DEFINITION = """
model = "box.sdl"
seconds = 20
[inputs]
a = [1, 3]
b = {}
[outputs]
area = "P.z"
side = "sqrt(a*a + b*b)"
"""

ANALYSIS = """
import os, signal, time

def faulty(model):
    a = model["a"]
    if a > 2.9:
        os.kill(os.getpid(), signal.SIGSEGV)
    if a > 2.7:
        raise ValueError("no flow")
    if a > 2.5:
        return {"other": 1}
    if a > 2.3:
        return float("nan")
    return {"drag": 2 * a}

def slow(model):
    time.sleep(60)
"""


def write(folder: Path, more: str = "", text: str = DEFINITION) -> Path:
    (folder / "box.sdl").write_text(BOX)
    (folder / "analysis.py").write_text(ANALYSIS)
    path = folder / "box.toml"
    path.write_text(text + more)
    return path


def command(*words: str | Path, **options) -> subprocess.CompletedProcess[str]:
    run = [sys.executable, "-m", "moldloft", "study", *map(str, words)]
    return subprocess.run(run, capture_output=True, text=True, encoding="utf-8", **options)


def test_a_sweep_gives_the_numbers_of_the_model(tmp_path):
    definition = study.read(write(tmp_path, "[plan]\nmethod = 'grid'\nlevels = 4\n"))
    results = study.sweep(definition, tmp_path / "box.sqlite")
    assert len(results) == 16 and results.counts == {"done": 16}
    a, b = results.inputs["a"], results.inputs["b"]
    assert sorted(set(a)) == list(np.linspace(1, 3, 4)) and sorted(set(b)) == [1, 2, 3, 4]
    assert (results.outputs["area"] == a * b).all()
    assert np.allclose(results.outputs["side"], np.hypot(a, b), rtol=1e-15)
    frame = results.to_pandas()
    assert list(frame) == ["a", "b", "area", "side", "state", "id", "message"]
    assert results.to_xarray()["area"].shape == (16,)


def test_derivatives_are_columns(tmp_path):
    text = DEFINITION.replace("seconds = 20", "derivatives = true")
    definition = study.read(write(tmp_path, "[plan]\ncount = 8\n", text))
    results = study.sweep(definition, tmp_path / "box.sqlite")
    assert (results.derivatives["area"]["a"] == results.inputs["b"]).all()
    table = results.to_pandas() if importlib.util.find_spec("pandas") else results.columns()
    assert (np.asarray(table["d area / d b"]) == results.inputs["a"]).all()
    assert b"d area / d a" in results.csv().splitlines()[0]
    spread = study.spreads(results, {"a": 0.1, "b": 0.2})["area"]
    exact = np.hypot(0.1 * results.inputs["b"], 0.2 * results.inputs["a"])
    assert np.allclose(spread, exact, rtol=1e-14)


def test_more_derivatives_than_a_table_has_columns(tmp_path):
    inputs = [f"P{k}.y" for k in range(2100)]
    rng = np.random.default_rng(5)
    made = []
    for k in range(3):
        values = dict(zip(inputs, rng.random(len(inputs)).tolist(), strict=True))
        slopes = {n: dict(zip(inputs, rng.random(len(inputs)).tolist(), strict=True)) for n in "xy"}
        made.append(study.Outcome(f"k{k}", "done", "", "", 1.0, values, {"x": k, "y": 2.0}, slopes))
    # The same names in another order, and a case of another plan.
    last = made[-1]
    back = {n: dict(reversed(row.items())) for n, row in last.derivatives.items()}
    made[-1] = replace(last, inputs=dict(reversed(last.inputs.items())), derivatives=back)
    other = study.Outcome("other", "refused", "id", "said", 1.0, {"a": 1.0}, {})
    with study.Store(tmp_path / "s.sqlite", writing=True) as store:
        store.begin({}, ["k0", "k2", "none", "k1"])
        for each in (*made, other):
            store.add(each)
        results = store.results()
        assert {each.key: each for each in store.outcomes()} == {e.key: e for e in (*made, other)}
    assert results.state.tolist() == ["done", "done", "pending", "done"]
    for row, each in ((0, made[0]), (1, made[2]), (3, made[1])):
        assert {n: c[row] for n, c in results.inputs.items()} == dict(each.inputs)
        assert {n: c[row] for n, c in results.outputs.items()} == dict(each.outputs)
        for name, own in each.derivatives.items():
            assert {n: c[row] for n, c in results.derivatives[name].items()} == dict(own)
    assert all(np.isnan(c[2]) for c in results.inputs.values())


QUADRATIC = """
def numbers(model):
    a, b = model["a"], model["b"]
    return {"f": a * a * b + b * b, "g": a * b}

def weighed(model):
    a, b = model["a"], model["b"]
    return {"f": (a * a * b, {"P.z": a, "a": a * b}), "g": (a, {"P.x": 1.0})}

def bare(model):
    return {"f": 1.0, "g": 2.0}
"""


def of_quadratic(folder: Path, keys: str, levels: int = 3) -> study.Results:
    more = f"[plan]\nmethod = 'grid'\nlevels = {levels}\n[analysis.q]\noutputs = ['f', 'g']\n{keys}"
    path = write(folder, more, DEFINITION.replace("seconds = 20", "derivatives = true"))
    (folder / "analysis.py").write_text(QUADRATIC)
    return study.sweep(study.read(path), folder / "q.sqlite")


def test_differences_of_an_analysis_are_of_second_order(tmp_path):
    """Exact for squares, in the range and at its ends."""
    results = of_quadratic(tmp_path, "python = 'analysis.py:numbers'\ndifferences = 0.01\n")
    assert results.counts == {"done": 9}, set(results.message)
    a, b = results.inputs["a"], results.inputs["b"]
    for name, by, exact in (
        ("f", "a", 2 * a * b),
        ("f", "b", a * a + 2 * b),
        ("g", "a", b),
        ("area", "a", b),
    ):
        assert np.allclose(results.derivatives[name][by], exact, rtol=1e-11), (name, by)


def test_an_adjoint_analysis_gives_weights(tmp_path):
    results = of_quadratic(tmp_path, "python = 'analysis.py:weighed'\nadjoint = true\n")
    assert results.counts == {"done": 9}, set(results.message)
    a, b = results.inputs["a"], results.inputs["b"]
    assert np.allclose(results.derivatives["f"]["a"], 2 * a * b, rtol=1e-13)
    assert np.allclose(results.derivatives["f"]["b"], a * a, rtol=1e-13)
    assert (results.derivatives["g"]["a"] == 1).all() and (results.derivatives["g"]["b"] == 0).all()


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        (
            "python = 'analysis.py:bare'\nadjoint = true\n",
            "returned no number with its weights `f`",
        ),
        ("python = 'analysis.py:wrong'\nadjoint = true\n", "the weights of `f`"),
        ("python = 'analysis.py:late'\ndifferences = 0.25\n", "differences by `a`, at 2.5"),
    ],
)
def test_a_failed_derivative_fails_its_case(tmp_path, monkeypatch, keys, said):
    more = """
def wrong(model):
    return {n: (1.0, {"P.q": 1.0}) for n in "fg"}
def late(model):
    if model["a"] > 2.4:
        raise ValueError("separated")
    return {"f": 1.0, "g": 2.0}
"""
    monkeypatch.setattr(sys.modules[__name__], "QUADRATIC", QUADRATIC + more)
    results = of_quadratic(tmp_path, keys)
    assert set(results.state) <= {"solver failed", "done"} and "done" not in results.state[3:6]
    assert any(said in message for message in results.message), set(results.message)


def plan(tmp_path: Path, more: str, text: str = DEFINITION) -> np.ndarray:
    from moldloft.study.plans import points

    definition = study.read(write(tmp_path, more, text))
    return points(definition, moldloft.load(definition.model))


def test_latin_hypercubes_have_a_point_in_each_slice(tmp_path):
    found = plan(tmp_path, "[plan]\nmethod = 'latin-hypercube'\ncount = 40\nseed = 5\n")
    slices = np.floor((found - [1, 1]) / [2, 3] * 40).astype(int)
    for column in slices.T:
        assert sorted(column) == list(range(40))


def test_plans_repeat_and_follow_the_seed(tmp_path):
    one = plan(tmp_path, "[plan]\nmethod = 'sobol'\ncount = 33\nseed = 1\n")
    assert (one == plan(tmp_path, "[plan]\nmethod = 'sobol'\ncount = 33\nseed = 1\n")).all()
    assert (one != plan(tmp_path, "[plan]\nmethod = 'sobol'\ncount = 33\nseed = 2\n")).any()


def test_one_at_a_time_keeps_the_others(tmp_path):
    found = plan(tmp_path, "[plan]\nmethod = 'one-at-a-time'\nlevels = 3\n")
    # a = 2 and b = 3 at rest; the middle of a's range is the rest again.
    assert found.tolist() == [[2, 3], [1, 3], [3, 3], [2, 1], [2, 2.5], [2, 4]]


def test_whole_parameters_are_whole(tmp_path):
    text = DEFINITION.replace("b = {}", "n = {}")
    found = plan(tmp_path, "[plan]\ncount = 20\n", text)
    assert set(found[:, 1]) <= {1, 2, 3, 4, 5}


def test_tables_are_read_by_their_header(tmp_path):
    (tmp_path / "rows.csv").write_text("# points\nb, other, a\n2, x, 1.5\n3, y, 2.5\n")
    found = plan(tmp_path, "[plan]\nmethod = 'table'\nfile = 'rows.csv'\n")
    assert found.tolist() == [[1.5, 2], [2.5, 3]]


def test_sobol_indices_of_the_ishigami_function(tmp_path):
    (tmp_path / "ishigami.sdl").write_text(
        "param float x = 0 in [-PI, PI]; param float y = 0 in [-PI, PI];"
        "param float z = 0 in [-PI, PI]; AbsPoint P(x, y, z);"
    )
    path = tmp_path / "i.toml"
    path.write_text(
        "model = 'ishigami.sdl'\n[inputs]\nx = {}\ny = {}\nz = {}\n[outputs]\n"
        "f = 'sin(x) + 7 * sin(y)^2 + 0.1 * z^4 * sin(x)'\n"
        "[plan]\nmethod = 'saltelli'\ncount = 1024\nseed = 3\n"
    )
    results = study.sweep(study.read(path), tmp_path / "i.sqlite")
    found = study.sobol_indices(results, 1024)["f"]
    # Ishigami and Homma 1990, a = 7, b = 0.1.
    exact = {"x": (0.3139, 0.5576), "y": (0.4424, 0.4424), "z": (0.0, 0.2437)}
    for name, pair in exact.items():
        assert np.allclose(found[name], pair, atol=0.03), name


FAULTY = """
[plan]
method = "grid"
levels = 9
[analysis.flow]
python = "analysis.py:faulty"
outputs = ["drag"]
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_each_failure_costs_its_case_alone(tmp_path):
    definition = study.read(write(tmp_path, FAULTY, DEFINITION.replace("[1, 3]", "[1, 3.95]")))
    results = study.sweep(definition, tmp_path / "box.sqlite")
    a = results.inputs["a"]
    refused, crashed = a > 3.9, (a > 2.9) & (a <= 3.9)
    failed = (a > 2.3) & (a <= 2.9)
    assert (results.state[refused] == "refused").all() and refused.any()
    assert (results.state[crashed] == "crashed").all() and crashed.any()
    assert (results.state[failed] == "solver failed").all() and failed.any()
    good = a <= 2.3
    assert (results.state[good] == "done").all()
    assert (results.outputs["drag"][good] == 2 * a[good]).all()
    assert np.isnan(results.outputs["drag"][~good]).all()
    assert any("SIGSEGV" in m for m in results.message) and any(
        "no flow" in m for m in results.message
    )
    # The second time nothing is evaluated; with `retry` the failures alone are.
    count = []
    again = study.sweep(definition, tmp_path / "box.sqlite", progress=lambda *_: count.append(1))
    assert not count and again.csv() == results.csv()
    study.sweep(
        definition, tmp_path / "box.sqlite", retry=["crashed"], progress=lambda *_: count.append(1)
    )
    assert len(count) == crashed.sum()


def test_a_case_that_hangs_is_ended(tmp_path):
    slow = FAULTY.replace("faulty", "slow").replace("levels = 9", "levels = 1")
    text = DEFINITION.replace("seconds = 20", "seconds = 1").replace("b = {}", "b = [2, 2]")
    definition = study.read(write(tmp_path, slow, text))
    results = study.sweep(definition, tmp_path / "box.sqlite")
    assert results.counts == {"timed out": 1} and "longer than 1 s" in results.message[0]


def test_constraints_decide_which_cases_are_evaluated(tmp_path):
    more = "[constraints]\nslender = { value = 'b / a', low = 1.5 }\n[plan]\nmethod = 'grid'\n"
    results = study.sweep(study.read(write(tmp_path, more)), tmp_path / "box.sqlite")
    held = results.inputs["b"] / results.inputs["a"] >= 1.5
    assert (results.done == held).all() and held.any() and not held.all()
    assert "slender" in results.message[~held][0]


def test_any_executor_and_any_parts_give_the_same_table(tmp_path):
    definition = study.read(write(tmp_path, "[plan]\nmethod = 'sobol'\ncount = 24\n"))
    serial = study.sweep(definition, tmp_path / "one.sqlite", processes=1).csv()
    assert study.sweep(definition, tmp_path / "four.sqlite", processes=4).csv() == serial
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        assert study.sweep(definition, tmp_path / "pool.sqlite", executor=pool).csv() == serial
    stores = []
    for k in (1, 2, 3):
        stores.append(tmp_path / f"part{k}.sqlite")
        study.sweep(definition, stores[-1], part=(k, 3))
    path = tmp_path / "box.toml"
    whole = tmp_path / "whole.sqlite"
    done = command("collect", path, *stores, "--store", whole, "--csv", "-", check=True)
    assert done.stdout.encode() == serial


def test_a_result_is_in_the_file_at_once(tmp_path: Path):
    path = tmp_path / "s.sqlite"
    made = study.Outcome("k", "done", "", "", 0.1, {"a": 1.0}, {"b": 2.0})
    with study.Store(path, writing=True) as kept:
        kept.begin({}, ["k", "l"])
        kept.add(made)
        assert known(path) == 1
        kept.forget(["done"])
        assert known(path) == 0
        # What comes from another store comes whole or not at all.
        other = study.Store(tmp_path / "t.sqlite", writing=True)
        other.add(made)
        monkey = [made, None]
        other.outcomes = lambda: iter(monkey)  # type: ignore[method-assign]
        with pytest.raises(AttributeError):
            kept.collect(other)
        assert known(path) == 0
        monkey.pop()
        assert kept.collect(other) == known(path) == 1
        other.close()


SOLVER = """
import sys, json
text = open(sys.argv[1]).read()
values = dict(line.split("=") for line in text.split())
a, b = float(values["a"]), float(values["b"])
mode = sys.argv[2]
if mode == "status": print("licence missing"); sys.exit(3)
if mode == "hang":
    import time; time.sleep(60)
if mode == "nothing": sys.exit(0)
if mode == "garbage": open("out.log", "w").write("CD = abc\\n"); sys.exit(0)
open("out.log", "w").write(f"step 1 CD = 9\\nCD = {a / b!r}\\n")
open("forces.csv", "w").write(f"step,fx\\n1,0\\n2,{a + b!r}\\n")
json.dump({"forces": [0, {"z": a - b}]}, open("r.json", "w"))
"""


def external(folder: Path, mode: str) -> study.Results:
    (folder / "case").mkdir()
    (folder / "case" / "input.txt").write_text("a={a}\nb={b}\n")
    (folder / "solver.py").write_text(SOLVER)
    more = f"""
[plan]
method = "grid"
levels = 2
[analysis.flow]
template = "case"
command = ["{sys.executable}", "{{folder}}/solver.py", "input.txt", "{mode}"]
seconds = 2
[analysis.flow.results]
cd = {{ file = "out.log", pattern = 'CD = (\\S+)' }}
fx = {{ file = "forces.csv", column = "fx" }}
fz = {{ file = "r.json", key = "forces.1.z" }}
"""
    return study.sweep(study.read(write(folder, more)), folder / "box.sqlite")


def test_an_external_program_runs_in_the_case_s_folder(tmp_path):
    results = external(tmp_path, "good")
    a, b = results.inputs["a"], results.inputs["b"]
    assert results.counts == {"done": 4}
    assert (results.outputs["cd"] == a / b).all()
    assert (results.outputs["fx"] == a + b).all() and (results.outputs["fz"] == a - b).all()
    # Folders of cases that ended well are removed.
    assert not list((tmp_path / "box.cases").glob("*/flow"))


@pytest.mark.parametrize(
    ("mode", "said"),
    [
        ("status", "ended with status 3: licence missing"),
        ("hang", "took longer than 2 s"),
        ("nothing", "wrote no `out.log`"),
        ("garbage", "expected a number, found `abc`"),
    ],
)
def test_a_solver_that_fails_is_said_and_its_folder_kept(tmp_path, mode, said):
    results = external(tmp_path, mode)
    assert results.counts == {"solver failed": 4}
    assert all(said in message for message in results.message)
    assert len(list((tmp_path / "box.cases").glob("*/flow/command.log"))) == 4


TANK = """
param float length = 3 in [0.5, 6];
param float width = 1.5 in [0.5, 6];
param float height = 3 in [0.2, 6];
AbsPoint P(length, width, height);
"""


def tank(folder: Path, method: str, **keys: str) -> study.Optimum:
    (folder / "tank.sdl").write_text(TANK)
    more = "".join(f"{name} = {value}\n" for name, value in keys.items())
    (folder / "tank.toml").write_text(f"""
model = "tank.sdl"
[inputs]
length = {{}}
width = {{}}
height = {{}}
[outputs]
sheet = "length * width + 2 * height * (length + width)"
volume = "length * width * height"
[constraints]
filled = {{ value = "volume", equal = 4 }}
[optimize]
minimize = "sheet"
method = "{method}"
{more}""")
    return study.optimize(study.read(folder / "tank.toml"), folder / "tank.sqlite")


@pytest.mark.parametrize(("method", "most"), [("slsqp", 30), ("trust-constr", 30)])
def test_the_open_tank_of_least_sheet(tmp_path, method, most):
    # Of volume 4: 2 by 2 by 1, 12 of sheet.
    best = tank(tmp_path, method)
    assert best.converged and best.feasible, best
    assert abs(best.outputs["sheet"] - 12) < 1e-5
    assert np.allclose(list(best.inputs.values()), [2, 2, 1], atol=2e-3)
    assert best.evaluations <= most


def test_an_optimum_by_values_alone(tmp_path):
    best = tank(tmp_path, "cobyqa", tolerance="1e-6")
    assert best.feasible and abs(best.outputs["sheet"] - 12) < 1e-3


def test_an_objective_of_an_analysis_needs_a_method_by_values(tmp_path):
    more = FAULTY + "[optimize]\nminimize = 'drag'\n"
    with pytest.raises(
        study.StudyError,
        match=r"`adjoint`, or .* derivatives: cobyqa, differential-evolution, nsga2, tpe",
    ):
        study.optimize(study.read(write(tmp_path, more)), tmp_path / "b.sqlite")
    more = more.replace("'drag'", "'drag'\nmethod = 'cobyqa'\nevaluations = 40")
    best = study.optimize(study.read(write(tmp_path, more)), tmp_path / "b.sqlite")
    assert math.isclose(best.outputs["drag"], 2.0, abs_tol=1e-3)


@pytest.mark.parametrize("method", ["slsqp", "trust-constr"])
def test_the_example_has_the_least_area_at_its_displacement(tmp_path, method):
    """All 20 coordinates when there is time, else the four of the midship section."""
    root = Path(__file__).parents[3] / "examples" / "studies"
    definition = study.read(root / "least_area.toml")
    if not SOAK:
        chosen = tuple(i for i in definition.inputs if i.name.startswith(("C3", "C4", "C2.z")))
        definition = replace(definition, inputs=chosen, constraints=definition.constraints[:1])
    definition = replace(definition, goal=replace(definition.goal, method=method))
    best = study.optimize(definition, tmp_path / "least.sqlite")
    assert best.converged and best.feasible and best.evaluations <= 30
    assert abs(best.outputs["volume"] - 7.5) < 1e-5
    if SOAK:
        assert abs(best.outputs["area"] - 19.42041) < (2e-5 if method == "slsqp" else 5e-5)
        assert abs(best.outputs["lcb"] - 4.95) < 1e-5 and best.outputs["length"] > 9 - 1e-5
    with study.Store(tmp_path / "least.sqlite") as store:
        seen = list(store.outcomes())
    held = [o.outputs["area"] for o in seen if abs(o.outputs["volume"] - 7.5) < 1e-6]
    assert min(held) > best.outputs["area"] - 1e-6


def test_the_command(tmp_path):
    path = write(tmp_path, "[plan]\nmethod = 'grid'\n")
    page, rows = tmp_path / "box.html", tmp_path / "box.csv"
    done = command("sweep", path, "--html", page, "--csv", rows)
    assert done.returncode == 0 and "done" in done.stdout, done.stderr
    text = page.read_text(encoding="utf-8")
    assert text.count("<svg") > 4 and "http" not in text.replace("http-equiv", "")
    assert len(rows.read_text().splitlines()) == 26
    shown = command("show", path, "--json")
    assert json.loads(shown.stdout)["counts"] == {"done": 25}
    assert command("resume", path, "-q").returncode == 0
    assert "no results" in command("show", path, "--store", tmp_path / "none.sqlite").stderr


def test_the_page_has_pictures_of_variants(tmp_path):
    """The ends of each output, of the model that the table is of."""
    plate = (
        "param float b = 1 in [0.5, 3]; AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0);"
        "AbsPoint C(0, b, 0); AbsPoint D(1, b, 0); Line l(A, B); Line m(C, D); RuledSurf s(l, m);"
    )
    (tmp_path / "plate.sdl").write_text(plate)
    path = tmp_path / "plate.toml"
    path.write_text(
        "model = 'plate.sdl'\n[inputs]\nb = {}\n[outputs]\narea = 's.area'\nwidth = 'C.y'\n"
        "[plan]\nmethod = 'grid'\nlevels = 5\n"
    )
    page = tmp_path / "plate.html"
    assert command("sweep", path, "--html", page, "-q").returncode == 0
    text = page.read_text()
    pictures = re.findall(
        r'<img alt="([^"]+)" width="300" src="data:image/png;base64,([^"]+)"', text
    )
    assert [alt for alt, _ in pictures] == [
        "case 0: least area, least width (area 0.5, width 0.5)",
        "case 4: greatest area, greatest width (area 3, width 3)",
    ]
    for (_, data), value in zip(pictures, (0.5, 3.0), strict=True):
        shape = moldloft.load(tmp_path / "plate.sdl")
        shape.set({"b": value})
        assert base64.b64decode(data) == shape.picture(360, 240)
    # Of another model than that of the table there are none.
    (tmp_path / "plate.sdl").write_text(plate.replace("AbsPoint B(1,", "AbsPoint B(2,"))
    assert command("show", path, "--html", page, "-q").returncode == 0
    assert "<img" not in page.read_text()


def test_a_page_of_many_cases_counts_them_by_cells():
    """No case is left out of a plot, and the page does not grow with them."""
    from moldloft.study.report import html, sensitivities

    rng = np.random.default_rng(2)
    sizes = []
    for count in (5_000, 50_000):
        corner = rng.integers(0, 2, (2, count)).astype(float)
        corner[:, -1] = 0.5
        words = np.full(count, "", dtype=object)
        results = study.Results(
            {"a": corner[0]},
            {"f": corner[1], "g": corner[0] - 2 * corner[1]},
            np.full(count, "done", dtype=object),
            words,
            words,
            np.zeros(count),
        )
        page = html(results, "many", {"plan": "sobol"}).decode()
        sizes.append(len(page))
        # Four corners, and the one case between them.
        plot = page.partition('aria-label="f by a, ')[2].partition("</svg>")[0]
        assert plot.count("M") - 1 == 5 and "<circle" not in plot
        assert f"f by a, {count} cases in 60 x 40 cells" in page
        assert f"2000 cases, {count - 2000} more not drawn" in page
        slope = sensitivities(results)["g"]["a"]
        assert math.isclose(slope, np.corrcoef(corner[0], results.outputs["g"])[0, 1], rel_tol=1e-9)
    assert sizes[1] < 1.1 * sizes[0] < 1e6


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("seconds = 20", "secnds = 20", "`secnds` is unknown; did you mean `seconds`?"),
        ("seconds = 20", "seconds = 0", "`seconds` is above 0"),
        ("seconds = 20", "seconds = 'x'", "`seconds` is a number, found a text"),
        ("seconds = 20", "memory = 'much'", "memory"),
        ('"box.sdl"', '"none.sdl"', "none.sdl"),
        ('model = "box.sdl"', "", "`model` is missing"),
        ("a = [1, 3]", "a = [3, 1]", "runs from 3 down to 1"),
        ("a = [1, 3]", "a = [1, 2, 3]", "is a range"),
        ("a = [1, 3]", "a = [0, 3]", "below the model's own"),
        ("a = [1, 3]", "a = [1, inf]", "finite"),
        ("a = [1, 3]", "c = [1, 3]", "`inputs.c`"),
        ('"P.z"', '"P.q"', "`outputs.area`"),
        ('"P.z"', '"P"', "`outputs.area`"),
        ('area = "P.z"', 'a = "P.z"', "named twice"),
        ("[outputs]", "[plan]\nmethod = 'sobl'\n[outputs]", "did you mean `sobol`"),
        ("[outputs]", "[plan]\nmethod = 'table'\n[outputs]", "`plan.file` is missing"),
        ("[outputs]", "[optimize]\nminimize = 'x'\n[outputs]", "unknown output `x`"),
        ("[outputs]", "[optimize]\nmethod = 'slsqp'\n[outputs]", "needs `minimize` or `maximize`"),
        ("[outputs]", "[analysis.x]\n[outputs]", "either `python` or `command`"),
        (
            "[outputs]",
            "[analysis.x]\ncommand = 'x'\nadjoint = true\nresults.y = {file = 'f', key = 'y'}\n"
            "[outputs]",
            "`analysis.x.adjoint` needs `python`",
        ),
        (
            "[outputs]",
            "[analysis.x]\npython = 'a.py:f'\ndifferences = 0.5\noutputs = ['y']\n[outputs]",
            "is a fraction up to 0.25",
        ),
        ("[outputs]", "[constraints]\nx = {value = 'a'}\n[outputs]", "needs `low`"),
        ("[inputs]", "[inputs", "not valid TOML"),
    ],
)
def test_what_is_wrong_with_a_definition_is_said(tmp_path, old, new, said):
    assert old in DEFINITION
    path = write(tmp_path, "", DEFINITION.replace(old, new))
    done = command("sweep", path)
    assert done.returncode == 1 and said in done.stderr, done.stderr
    assert "Traceback" not in done.stderr and "internal fault" not in done.stderr


def test_a_damaged_store_is_named(tmp_path):
    path = write(tmp_path)
    (tmp_path / "box.sqlite").write_bytes(b"no database" * 100)
    done = command("sweep", path)
    assert done.returncode == 1 and "box.sqlite" in done.stderr and "Traceback" not in done.stderr


def test_one_run_at_a_time(tmp_path):
    definition = study.read(write(tmp_path))
    store = tmp_path / "s.sqlite"
    with study.Store(store, writing=True), pytest.raises(moldloft.Error, match="in use"):
        study.sweep(definition, store)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_loses_nothing(tmp_path):
    more = "[plan]\ncount = 400\n[analysis.s]\npython = 'analysis.py:pause'\noutputs = ['x']\n"
    path = write(tmp_path, more)
    (tmp_path / "analysis.py").write_text(
        "import time\ndef pause(model):\n    time.sleep(0.05)\n    return 1\n"
    )
    words = [sys.executable, "-m", "moldloft", "study", "sweep", str(path)]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as run:
        deadline = time.monotonic() + 60
        while known(tmp_path / "box.sqlite") < 3 and time.monotonic() < deadline:
            time.sleep(0.02)
        run.send_signal(signal.SIGINT)
        _, said = run.communicate(timeout=30)
    assert run.returncode == 130 and "study resume" in said, said
    kept = known(tmp_path / "box.sqlite")
    assert 3 <= kept < 400


def test_a_cluster_that_cannot_be_reached_is_said(tmp_path):
    pytest.importorskip("distributed")
    done = command("sweep", write(tmp_path), "--cluster", "tcp://127.0.0.1:9")
    assert done.returncode == 1 and "cannot reach the cluster" in done.stderr


def test_a_cluster_gives_the_same_table(tmp_path):
    distributed = pytest.importorskip("distributed")
    from moldloft.study.cluster import executor_of

    definition = study.read(write(tmp_path, "[plan]\nmethod = 'sobol'\ncount = 24\n"))
    serial = study.sweep(definition, tmp_path / "one.sqlite").csv()
    with (
        distributed.LocalCluster(2, threads_per_worker=1, dashboard_address=":0") as cluster,
        distributed.Client(cluster) as client,
    ):
        executor = executor_of(client)
        assert study.sweep(definition, tmp_path / "c.sqlite", executor=executor).csv() == serial


class OtherVersion(ThreadPoolExecutor):
    """An executor whose workers take the request of another version for theirs."""

    def submit(self, function, requests):
        return super().submit(function, [{**each, "version": "0.0.9"} for each in requests])


def test_workers_of_another_version_end_the_run(tmp_path):
    definition = study.read(write(tmp_path, "[plan]\ncount = 8\n"))
    store = tmp_path / "s.sqlite"
    with OtherVersion(2) as pool:
        with pytest.raises(study.StudyError, match=r"has Moldloft .*, the study 0\.0\.9"):
            study.sweep(definition, store, executor=pool)
        assert known(store) == 0
    assert study.sweep(definition, store).counts == {"done": 8}


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
def test_a_full_disk_is_said_and_costs_nothing_that_was_stored(tmp_path):
    """No file may grow past 100 kB: the store is full on the way."""
    import resource

    path = write(tmp_path, "[plan]\nmethod = 'sobol'\ncount = 400\n")
    store = tmp_path / "box.sqlite"

    def small() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))

    full = command("sweep", path, "-q", preexec_fn=small)
    assert full.returncode == 1 and "Traceback" not in full.stderr, full.stderr
    assert "box.sqlite`: " in full.stderr
    before = known(store)
    assert before < 400
    count: list[int] = []
    results = study.sweep(study.read(path), store, progress=lambda n, left, _: count.append(left))
    assert results.counts == {"done": 400} and count[0] == 400 - before


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
def test_a_full_disk_of_a_page_leaves_no_part_of_it(tmp_path):
    import resource

    path = write(tmp_path, "[plan]\ncount = 200\n")
    study.sweep(study.read(path), tmp_path / "box.sqlite")

    page = tmp_path / "box.html"
    full = command(
        "show",
        path,
        "--html",
        page,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000)),
    )
    assert full.returncode == 1 and "box.html" in full.stderr and "Traceback" not in full.stderr
    assert not page.exists()
