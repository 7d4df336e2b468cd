"""What a run may use: texts that ask for too much are refused by name and take little memory."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import moldloft
from moldloft import _core

resource = pytest.importorskip("resource", reason="limits of a process")

# Runs a text in a child and prints the ids of what is wrong, the peak of its memory in MB, and
# whether the process can still build a model afterwards.
CHILD = """
import json, resource, sys
import moldloft
text = open(sys.argv[1]).read()
given = json.loads(sys.argv[2])
mesh = given.pop("mesh", False)
moldloft.limits(**given)
try:
    m = moldloft.loads(text)
    if mesh:
        m.mesh()
    ids = [d.id for d in m.diagnostics]
except moldloft.Error as error:
    ids = [d.id for d in getattr(error, "diagnostics", [])] or [str(error)]
alive = len(moldloft.loads("AbsPoint A(1, 2, 3);").keys())
try:
    # The largest of this program; getrusage remembers that of the process it was forked from.
    status = open("/proc/self/status").read()
    peak = int(status.split("VmHWM:")[1].split()[0]) // 1024
except OSError:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
print(json.dumps([ids, peak, alive]))
"""

POINTS = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(1, 1, 0); AbsPoint D(0, 1, 0); "
PATCH = POINTS + "Line l(A, B); Line n(D, C); "
BALL = "set s = set(sphere({0, 0, 0}, 1)); "


def run(tmp_path: Path, text: str, **limits: float) -> tuple[list[str], int]:
    """Ids of what is wrong, and the peak of memory in MB; CPU time ends endless work only."""
    path = tmp_path / "bomb.sdl"
    path.write_text(text)
    child = subprocess.run(
        [sys.executable, "-c", CHILD, str(path), json.dumps(limits)],
        capture_output=True,
        text=True,
        env={**os.environ, "RAYON_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (60, 60)),
    )
    assert child.returncode == 0, child.stderr[-2000:]
    ids, peak, alive = json.loads(child.stdout)
    assert alive == 1
    return ids, peak


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("for (i = 1:10000000) AbsPoint p(i, 0, 0);", ["too-many-objects"]),
        ("float s = 0; for (i = 1:1000000000000) s = s + 1;", ["too-many-steps"]),
        ("while (1) print 1;", ["too-much-output"]),
        (
            "".join(f"subroutine f{k}() {{ f{k + 1}(); f{k + 1}(); }} " for k in range(40))
            + "subroutine f40() {} f0();",
            ["too-many-steps"],
        ),
        (BALL + "SetBody b(s, {-2, -2, -2}, {2, 2, 2}, depth = 12);", ["out-of-memory"]),
        (PATCH + "RuledSurf s(l, n, divisions = {30000, 30000});", ["too-many-panels"]),
        (PATCH + "RuledSurf s(l, n, divisions = {4000, 4000});", ["out-of-memory"]),
        ("surface s[100000, 100000];", ["too-many-elements"]),
        ("".join(f"curve c{k}[1e6]; " for k in range(2000)), ["out-of-memory"]),
        (
            "subroutine f(int n) { farray a[1e6]; a[1] = n; if (n > 0) { f(n - 1); } } f(2000);",
            ["out-of-memory"],
        ),
        ("string s[1e7];", ["too-many-elements"]),
        ("#" + "a" * (65 << 20), ["file-too-large"]),
    ],
    ids=[
        "objects",
        "steps",
        "prints",
        "calls",
        "cells",
        "panels",
        "mesh",
        "elements",
        "arrays",
        "calls",
        "texts",
        "text",
    ],
)
def test_what_grows_without_end_is_refused(tmp_path: Path, text: str, ids: list[str]) -> None:
    # The usual limit of steps is seconds of compiled loops, on an unoptimised build more.
    steps = {"steps": 2_000_000} if ids == ["too-many-steps"] else {}
    found, peak = run(tmp_path, text, memory=1 << 30, mesh=True, **steps)
    assert [i for i in found if i in ids], found
    assert peak < 500


def test_shared_parts_of_sets_are_made_once(tmp_path: Path) -> None:
    turns = "for (i = 1:60) s = s & (s | set(sphere({i/60., 0, 0}, 1))); "
    body = "SetBody b(s, {-2, -2, -2}, {2, 2, 2}, depth = 5);"
    found, peak = run(tmp_path, BALL + turns + body)
    assert (found, peak < 300) == ([], True)


def test_a_loop_makes_a_set_of_many(tmp_path: Path) -> None:
    text = "set s = nothing(); for (i = 1:100000) s = s | set(sphere({i, 0, 0}, 0.6));"
    assert run(tmp_path, text)[0] == []


def test_a_model_lives_on_after_a_refusal() -> None:
    before = moldloft.limits()
    text = POINTS + "param float r = 1 in [0.1, 2]; " + BALL.replace("1)", "r)")
    m = moldloft.loads(text + "SetBody b(s, {-3, -3, -3}, {3, 3, 3}, depth = 6);")
    volume = m.mesh().volume
    try:
        # Below the least that users may set, so that a small model suffices.
        _core.set_limits(_core.held_memory() + (1 << 20), *before[1:])
        with pytest.raises(moldloft.Error, match="GiB of memory"):
            m["r"] = 1.5
            m.check()
            m.mesh()
    finally:
        moldloft.limits(**before._asdict())
    m["r"] = 1.0
    assert m.mesh().volume == volume
    m["r"] = 1.5
    assert m.mesh().volume == pytest.approx(volume * 1.5**3, rel=1e-2)


def test_time_is_limited() -> None:
    before = moldloft.limits()
    try:
        # A quick machine takes a second for this loop, a slow one is ended as early.
        moldloft.limits(seconds=1e-3, steps=10**9)
        with pytest.raises(moldloft.Error, match=r"longer than the 0\.001 s"):
            moldloft.loads("float s = 0; for (i = 1:200000000) s = s + 1;")
    finally:
        moldloft.limits(**before._asdict())
    assert moldloft.loads("AbsPoint A(1, 0, 0);").eval("A.x") == 1


def test_steps_and_objects_are_raised_by_who_may() -> None:
    before = moldloft.limits()
    text = "for (i = 1:40) AbsPoint p(i, 0, 0);"
    try:
        moldloft.limits(objects=30)
        with pytest.raises(moldloft.ModelError, match="too many objects") as error:
            moldloft.loads(text)
        assert [d.id for d in error.value.diagnostics] == ["too-many-objects"]
        moldloft.limits(objects=50)
        assert moldloft.loads(text).eval("p[40].x") == 40
    finally:
        moldloft.limits(**before._asdict())


def test_held_memory_comes_back() -> None:
    def once() -> None:
        m = moldloft.loads(BALL + "SetBody b(s, {-2, -2, -2}, {2, 2, 2}, depth = 6);")
        m.mesh()

    once()
    held = _core.held_memory()
    for _ in range(5):
        once()
    assert _core.held_memory() < held + (8 << 20)


def test_a_table_of_many_drafts_ends_with_its_time() -> None:
    hull = moldloft.load(Path(__file__).parents[3] / "examples" / "sailboat" / "hull.sdl")
    old = moldloft.limits().seconds
    moldloft.limits(seconds=0.2)
    try:
        with pytest.raises(moldloft.ModelError, match=r"longer than the 0\.2 s"):
            hull.hydrostatic_table([0.5 + 1e-6 * k for k in range(100_000)])
    finally:
        moldloft.limits(seconds=old)
    assert len(hull.hydrostatic_table([0.5, 0.6])) == 2
