"""MultiSurf model files: a model that goes into one comes back with its bits and relations."""

from __future__ import annotations

import os
import random
import re
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

import moldloft
import random_models

ROOT = Path(__file__).parents[3]
SEVEN = [
    "sailboat/hull",
    "sailboat/yacht",
    "platform/platform",
    "propeller/propeller",
    "submarine/submarine",
    "wing/wing",
    "wingbody/wingbody",
]
DRAWS = 400 if os.environ.get("MOLDLOFT_SOAK") == "1" else 25


def converted(model: moldloft.Model, to: str) -> tuple[str, list[str]]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        text = model.convert(to)
    return text, [str(remark.message) for remark in caught]


def loaded(text: str, folder: Path, name: str) -> moldloft.Model:
    path = folder / name
    path.write_text(text)
    model = moldloft.load(path)
    assert not model.has_errors, [str(d) for d in model.diagnostics][:3]
    return model


@pytest.mark.parametrize("name", SEVEN)
def test_examples_go_to_model_files_and_back_with_the_same_bits(name: str, tmp_path: Path) -> None:
    model = moldloft.load(ROOT / "examples" / f"{name}.sdl")
    text, _ = converted(model, "ms2")
    file = loaded(text, tmp_path, "there.ms2")
    program, _ = converted(file, "sdl")
    back = loaded(program, tmp_path, "back.sdl")
    # A second time there nothing is lost any more.
    assert converted(back, "ms2") == (text, [])
    mesh = model.mesh()
    for other in (file, back):
        again = other.mesh()
        assert np.array_equal(mesh.vertices, again.vertices)
        assert np.array_equal(mesh.faces, again.faces)


def test_random_models_go_there_and_back_with_the_same_bits(tmp_path: Path) -> None:
    """Hulls with chines, lofted hulls, prisms, platforms, wings with flaps."""
    for seed in range(150 if DRAWS > 100 else 10):
        model = moldloft.loads(random_models.drawn(seed).text)
        text, _ = converted(model, "ms2")
        file = loaded(text, tmp_path, "there.ms2")
        back = loaded(converted(file, "sdl")[0], tmp_path, "back.sdl")
        assert converted(back, "ms2") == (text, [])
        mesh = model.mesh()
        for other in (file, back):
            again = other.mesh()
            assert np.array_equal(mesh.vertices, again.vertices), seed
            assert np.array_equal(mesh.faces, again.faces), seed


def test_what_depends_on_an_unknown_entity_is_left_out_alone(tmp_path: Path) -> None:
    """Converted with it, built without it on request."""
    text = """MultiSurf 1.44
BeginModel;
AbsPoint A 14 1 / 0 0 0;
AbsPoint B 14 1 / 0 0 2;
AbsPoint C 14 1 / 3 0 0;
AbsPoint D 14 1 / 3 0 2;
Line l 11 1 8x4 / * A B;
Line m 11 1 8x4 / * C D;
RuledSurf s 10 1 4x1 4x1 0 / * l m;
Strange n 11 1 8x4 / * A D 7;
RuledSurf t 10 1 4x1 4x1 0 / * l n;
EndModel;
"""
    path = tmp_path / "strange.ms2"
    path.write_text(text)
    command = [sys.executable, "-m", "moldloft"]

    def run(*words: str | Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run([*command, *words], capture_output=True, text=True, cwd=tmp_path)

    assert run("convert", path, "-o", "strange.sdl").returncode == 0
    assert "#ms2 Strange n 11 1 8x4 / * A D 7;" in (tmp_path / "strange.sdl").read_text()
    refused = run("build", path, "--to", "stl", "-o", "out")
    assert refused.returncode == 1 and "unknown entity `Strange`" in refused.stderr
    kept = run("build", path, "--to", "stl", "-o", "out", "--keep-going")
    assert (tmp_path / "out" / "strange.stl").exists(), kept.stderr
    assert kept.returncode == 1 and "not built for want of it: t" in kept.stderr
    assert "what is written is without t, which could not be made" in kept.stderr


def test_conditions_and_assertions_are_left_out_with_a_remark(tmp_path: Path) -> None:
    model = moldloft.loads(
        "param float beam = 2 in [1, 3]; AbsPoint A(0, beam, 1); AbsPoint B(4, 0, 0); Line l(A, B);"
        "AbsBead b(l, 0.5); SolveSet s({b.t}, {b.x - 1}); assert l.length > 1;"
    )
    text, (remark,) = converted(model, "ms2")
    assert "a model file cannot hold SolveSet `s`, an assertion" in remark
    assert "Rem Moldloft: a model file cannot hold SolveSet `s`, an assertion" in text
    assert "SolveSet s" not in text and "AbsBead b 14 1 / l 0.25;" in text
    assert float(loaded(text, tmp_path, "s.ms2")["b"].x) == 1


def test_what_a_parameter_moves_is_moved_or_named(tmp_path: Path) -> None:
    """A parameter of the file moves what it moved, but for the objects that the remark names."""
    model = moldloft.load(ROOT / "examples/platform/platform.sdl")
    text, (remark,) = converted(model, "ms2")
    assert "numbers-fixed" in remark and "78 objects have computed numbers" in remark
    assert "Rem Moldloft: 78 objects have computed numbers" in text
    file = loaded(text, tmp_path, "platform.ms2")
    assert set(file.params) < set(model.params)
    command = [sys.executable, "-m", "moldloft", "convert"]
    source = ROOT / "examples/platform/platform.sdl"
    run = subprocess.run(
        [*command, source, "-o", tmp_path / "p.ms2"], capture_output=True, text=True, check=True
    )
    assert run.stderr.startswith("warning[numbers-fixed]: 78 objects") and not run.stdout


def drawn(rng: random.Random) -> str:
    """A program of numbers, variables and points in which all that is stated stays a relation."""
    names: list[str] = []
    lines = []

    def number(depth: int = 0) -> str:
        pick = rng.random()
        if names and pick < 0.45:
            return rng.choice(names)
        if depth > 2 or pick < 0.65:
            return f"{rng.uniform(-4, 4):.{rng.randint(0, 6)}f}"
        a, b = number(depth + 1), number(depth + 1)
        forms = ["{a} + {b}", "({a} - {b})*0.5", "sqrt(1 + abs({a}))", "{a}*({b})", "-({a})"]
        forms += ["max({a}, {b})", "sin({a})", "({a})/(2 + abs({b}))", "{a} + PI*({b})"]
        return rng.choice(forms).format(a=a, b=b)

    for k in range(rng.randint(1, 4)):
        value = round(rng.uniform(0.5, 3), 3)
        lines.append(f"param float p{k} = {value} in [{value - 0.4:.3f}, {value + 0.4:.3f}];")
        names.append(f"p{k}")
    for k in range(rng.randint(2, 6)):
        lines.append(f"float v{k} = {number()};")
        names.append(f"v{k}")
        lines.append(f"AbsPoint a{k}({number()}, {number()}, {number()});")
        names += [f"a{k}.x", f"a{k}.z"]
    count = sum(line.startswith("AbsPoint") for line in lines)
    points = ", ".join(f"a{k}" for k in range(count))
    lines.append(f"BCurve c({{{points}}}, degree = {rng.randint(1, 3)});")
    lines.append(f"AbsBead b(c, ({number()})*0.01 + 0.5);")
    lines.append("Line axis(a0, a1);")
    lines.append(f"RotatPoint r(b, axis, {rng.choice(names)}*0.3);")
    return "\n".join(lines) + "\n"


def test_relations_of_random_programs(tmp_path: Path) -> None:
    """Programs and the files made of them stay the same when parameters move."""
    rng = random.Random(145)
    tried = 0
    for k in range(DRAWS):
        program = drawn(rng)
        try:
            model = moldloft.loads(program)
        except moldloft.Error:
            continue
        tried += 1
        text, remarks = converted(model, "ms2")
        assert remarks == [], program
        file = loaded(text, tmp_path, f"{k}.ms2")
        back = loaded(converted(file, "sdl")[0], tmp_path, f"{k}.sdl")
        for _ in range(3):
            values = {}
            for name in file.params:
                low, high = file.params[name].low, file.params[name].high
                values[name] = rng.uniform(low, high)
            for other in (model, file, back):
                other.set(values)
            for name in [n for n in model.objects if re.fullmatch(r"a\d+|b|r", n)]:
                here = np.asarray(model[name])
                for other in (file, back):
                    there = np.asarray(other[name])
                    assert np.allclose(here, there, rtol=1e-13, atol=1e-13), (program, name)
    assert tried >= DRAWS // 2
