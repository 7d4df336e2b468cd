"""Faults: their causes, their lines, and no traceback for a command's user."""

from __future__ import annotations

import copy
import os
import pickle
import subprocess
import sys
import threading
import traceback
from pathlib import Path

import pytest

import moldloft
from conftest import SAILBOAT, Run
from moldloft.cli import main
from moldloft.errors import Error, ModelError

TEXT = "param float a = 1 in [0, 9]; AbsPoint P(0, 0, g(a));"
HULL = SAILBOAT / "hull.sdl"


# Functions of models.


def test_a_function_cannot_use_its_own_model() -> None:
    box: dict[str, moldloft.Model] = {}

    def g(x: float) -> float:
        if "m" in box:
            box["m"].eval("1 + 1")
        return x

    box["m"] = moldloft.loads(TEXT, functions={"g": g})
    done = threading.Event()

    def change() -> None:
        with pytest.raises(ModelError, match="cannot use the model that calls it") as raised:
            box["m"]["a"] = 2
            box["m"].check()
        assert isinstance(raised.value.__cause__, ModelError)
        done.set()

    worker = threading.Thread(target=change, daemon=True)
    worker.start()
    assert done.wait(30), "it waits for itself"
    # The model lives on.
    m = box.pop("m")
    m["a"] = 3
    assert m["P"].z == 3


def test_other_models_can_be_used_by_a_function() -> None:
    other = moldloft.loads("param float k = 5 in [0, 9];")
    m = moldloft.loads(TEXT, functions={"g": lambda x: other.eval("k") + float(x)})
    assert m["P"].z == 6


def test_an_error_of_a_function_keeps_cause_and_line() -> None:
    def g(x: float) -> float:
        return {}["the key"]  # the line

    with pytest.raises(ModelError, match="g raised KeyError") as raised:
        moldloft.loads(TEXT, functions={"g": g})
    cause = raised.value.__cause__
    assert isinstance(cause, KeyError)
    assert "# the line" in "".join(traceback.format_exception(cause))


@pytest.mark.parametrize("kind", [KeyboardInterrupt, SystemExit])
def test_an_interrupt_in_a_function_is_one(kind: type[BaseException]) -> None:
    def g(x: float) -> float:
        raise kind

    with pytest.raises(kind):
        moldloft.loads(TEXT, functions={"g": g})


# Copies.


def test_everything_pickles_and_copies() -> None:
    m = moldloft.load(HULL)
    m["beam"] = 11
    for again in (pickle.loads(pickle.dumps(m)), copy.copy(m), copy.deepcopy(m)):
        assert again is not m and again["beam"] == 11
        assert (again.mesh().vertices == m.mesh().vertices).all()
        again["beam"] = 9
        assert m["beam"] == 11
    for thing in (m["P21"], m["hull"], m.mesh(), m.hydrostatics()):
        for again in (pickle.loads(pickle.dumps(thing)), copy.deepcopy(thing)):
            assert type(again) is type(thing)


# The command.


def test_a_fault_of_ours_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(_: object) -> int:
        raise AttributeError("'NoneType' object\nhas no attribute")

    monkeypatch.setattr("moldloft.cli.formats.run", fail)
    assert main(["formats"]) == 1
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "please report it" in said and "AttributeError" in said
    with pytest.raises(AttributeError):
        main(["formats", "--traceback"])


@pytest.mark.skipif(os.name == "nt", reason="arguments are text there")
def test_arguments_that_are_no_text() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "moldloft", "eval", str(HULL), b"\xff"], capture_output=True
    )
    assert done.returncode == 1
    assert b"Traceback" not in done.stderr and b"please report" not in done.stderr


def test_the_tracebacks_that_were_found(cli: Run, tmp_path: Path) -> None:
    (tmp_path / "points.sdl").write_text("AbsPoint A(0, 0, 0); AbsPoint B(1, 2, 3);\n")
    for form in ("offsets", "gdf-high", "volume-p3d"):
        done = cli("build", "points.sdl", "--to", form, status=1)
        assert "please report" not in done.stderr, done.stderr
    (tmp_path / "long.csv").write_text("x,y,z\n" + "1" * 200_000 + ",2,3\n")
    for command in (["convert", "long.csv"], ["fair", "long.csv", "--tol", "1"]):
        assert "please report" not in cli(*command, status=1).stderr


@pytest.mark.parametrize(
    "limit", ["memory", "memory=", "memory=1", "memory=-2G", "steps=0", "steps=1.5", "x=1",
              "seconds=0", "seconds=nan", "objects=1e999", "=", ""],
)  # fmt: skip
def test_wrong_limits_are_usage_errors(cli: Run, limit: str) -> None:
    assert "--limit" in cli("check", HULL, "--limit", limit, status=2).stderr


def test_limits_of_a_command(cli: Run) -> None:
    cli("check", HULL, "--limit", "memory=2G", "--limit", "seconds=60", "--limit", "steps=1e6")
    done = cli("check", HULL, "--limit", "objects=3", status=1)
    assert "3" in done.stderr and "please report" not in done.stderr


# Wrong arguments of Python.


@pytest.mark.parametrize("value", [10**400, -(10**30), "x", None, [1], 1j, float("nan")])
def test_wrong_numbers_for_limits(value: object) -> None:
    before = moldloft.limits()
    for name in ("memory", "steps", "objects", "seconds"):
        if value is None or (name, value) == ("seconds", 10**400):
            continue
        with pytest.raises(Error, match=f"`{name}`"):
            moldloft.limits(**{name: value})  # type: ignore[arg-type]
    assert moldloft.limits() == before


def test_wrong_arguments_are_named(tmp_path: Path) -> None:
    import numpy as np

    from moldloft import fairing, grids, implicit

    m = moldloft.load(HULL)
    s = implicit.Set(implicit.sphere((0, 0, 0), 1))
    calls = [
        ("level", lambda: m.hydrostatics(level=len)),
        ("level", lambda: m.hydrostatics(level=10**400)),
        ("path", lambda: m.write(np.zeros(3))),
        ("expression", lambda: m.eval(3)),
        ("name", lambda: m.__getitem__(np.zeros(3))),
        ("path", lambda: grids.read_aerofoil([5, 5])),
        ("folder", lambda: moldloft.Sketch(3)),
        ("tol", lambda: fairing.fair(np.arange(18).reshape(9, 2), "x")),
        ("name", lambda: s.sdl(len)),
        ("path", lambda: s.save(None)),
    ]
    for name, call in calls:
        with pytest.raises(Error, match=f"`{name}`") as raised:
            call()
        assert isinstance(raised.value, (TypeError, ValueError, KeyError)), name
    with pytest.raises(Error, match="three coordinates, found 2"):
        implicit.plane((0, 0), (1, 0, 0))
    # What Python says of itself stays.
    with pytest.raises(TypeError, match="positional"):
        m.eval()


def test_errors_that_are_no_fault_of_arguments_stay() -> None:
    from moldloft import arguments

    def public(number: float, names: list[str] | None = None) -> None:
        """A function."""
        raise KeyError("other")

    module = {"__name__": public.__module__, "__all__": ["public"], "public": public}
    arguments.explain(module)
    with pytest.raises(KeyError, match="other"):
        module["public"](1.0)
    with pytest.raises(arguments.ArgumentError, match=r"`number` of .*: expected a number, found"):
        module["public"]([])


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("for (i = 1:3) x = i; end", "in braces"),
        ("farray a = {1, 2}; print a[end];", "a.d1"),
        ("begin x = 2; end", "in braces"),
        ("if (0) x = 1; elif (1) x = 2;", "else if"),
        ("x = 2 ** 3;", "a^b"),
        ("x++;", "i += 1"),
        ("x = 3; // three", "#"),
        ("def f(x): return x", "function float"),
    ],
)
def test_habits_of_other_languages_have_their_equivalent(text: str, hint: str) -> None:
    with pytest.raises(ModelError) as raised:
        moldloft.loads(f"float x;\n{text}\n")
    assert hint in str(raised.value)
