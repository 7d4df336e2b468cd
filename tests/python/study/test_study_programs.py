"""External programs of studies: folders, commands, results; the ready cases with stand-ins."""

from __future__ import annotations

import math
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import moldloft
from conftest import ROOT
from moldloft import study
from stand_ins import PROGRAMS

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
STAND_INS = ROOT / "tests" / "python" / "helpers" / "stand_ins.py"
CASES = ROOT / "examples" / "studies"

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="scripts and signals of POSIX")


@pytest.fixture
def stand_ins(tmp_path, monkeypatch):
    """Stand-ins for all programs are first on PATH."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for name in PROGRAMS:
        script = folder / name
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{STAND_INS}" {name} "$@"\n')
        script.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")
    return folder


def ready(tmp_path: Path, name: str, **changes) -> study.Study:
    """A ready case in a folder of its own: it writes beside its definition."""
    folder = tmp_path / "studies"
    if not folder.exists():
        shutil.copytree(CASES, folder, ignore=shutil.ignore_patterns("__pycache__", "*.cases"))
        shutil.copytree(ROOT / "examples" / "wing", tmp_path / "wing")
    return replace(study.read(folder / name), **changes)


def rows(definition: study.Study, store: Path) -> study.Results:
    results = study.sweep(definition, store)
    assert results.counts == {"done": len(results)}, set(results.message)
    return results


def of_plan(count: int, seed: int = 0) -> study.Plan:
    return study.Plan("latin-hypercube", count, seed=seed)


def test_xfoil_polar(tmp_path, stand_ins):
    plan = of_plan(3)
    definition = ready(tmp_path, "xfoil/section.toml", plan=plan, constraints=())
    results = rows(definition, tmp_path / "s.sqlite")
    assert (results.outputs["cl"] == 0.5).all()
    thick = results.outputs["thickness"]
    # The form factor of the stand-in's estimate, as printed with five digits.
    plate = 2 * 0.075 / (math.log10(3e6) - 2) ** 2
    assert np.allclose(results.outputs["cd"], plate * (1 + 2 * thick + 60 * thick**4), atol=5e-5)


def test_avl_forces(tmp_path, stand_ins):
    names = {"half_span": 6.0, "sweep": 0.4}
    definition = ready(tmp_path, "avl/wing.toml", plan=of_plan(4))
    results = rows(definition, tmp_path / "s.sqlite")
    assert (results.outputs["cl"] == 0.5).all()
    span, root = 2 * names["half_span"], 2.0
    ratio = span**2 / (span * root * (1 + results.inputs["taper"]) / 2)
    efficiency = 0.25 / (math.pi * ratio * results.outputs["cd_induced"])
    # Out of the plane of the span, a wing with dihedral may better an ellipse a little.
    assert ((efficiency > 0.9) & (efficiency < 1.03)).all(), efficiency


def test_su2_history(tmp_path, stand_ins):
    definition = ready(tmp_path, "su2/section.toml", plan=study.Plan("grid", levels=2))
    results = rows(definition, tmp_path / "s.sqlite")
    assert (results.outputs["cl"] == 0.5).all() and (results.outputs["cd"] > 0).all()
    assert len(set(results.outputs["cd"])) == 4


def test_openfoam_coefficients(tmp_path, stand_ins):
    definition = ready(tmp_path, "openfoam/body.toml", plan=study.Plan("grid", levels=2))
    results = rows(definition, tmp_path / "s.sqlite")
    # Friction of the stand-in: more wetted area by frontal area on the thinner body.
    thin = results.inputs["diameter"] < 0.7
    assert results.outputs["cd"][thin].min() > results.outputs["cd"][~thin].max()
    assert (results.outputs["cells"] > 0).all()


@pytest.mark.parametrize("program", ["hams", "nemoh"])
def test_heave_periods_by_panel_codes(tmp_path, stand_ins, program):
    pytest.importorskip("capytaine")
    definition = ready(tmp_path, f"{program}/float.toml", plan=of_plan(2 if SOAK else 1))
    results = rows(definition, tmp_path / "s.sqlite")
    check_heave(results)


def check_heave(results: study.Results) -> None:
    """Between the bounds of a buoy without added mass and with twice that of a disc."""
    radius, draft = results.inputs["radius"], results.inputs["draft"]
    for factor, side in ((0.0, 1), (2.0, -1)):
        added = factor * 4 / 3 * radius / math.pi
        period = 2 * math.pi * np.sqrt((draft + added) / 9.81)
        assert (side * (results.outputs["heave_period"] - period) > 0).all()


# -- the programs themselves, where they are installed -------------------------------------


def untrapped(tmp_path: Path) -> str:
    """A library that leaves floating-point exceptions untrapped: Debian's XFOIL stops by them."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    (tmp_path / "trap.c").write_text("void _gfortran_set_fpe(int mask) { (void)mask; }\n")
    library = tmp_path / "trap.so"
    command = [compiler, "-shared", "-fPIC", "-o", library, tmp_path / "trap.c"]
    subprocess.run(command, check=True)
    return str(library)


@pytest.mark.skipif(shutil.which("xfoil") is None, reason="XFOIL is not installed")
def test_xfoil_itself(tmp_path):
    definition = ready(tmp_path, "xfoil/section.toml", plan=of_plan(2), constraints=())
    shape, flow = definition.analyses
    flow = replace(flow, environment={"LD_PRELOAD": untrapped(tmp_path)})
    results = rows(replace(definition, analyses=(shape, flow)), tmp_path / "s.sqlite")
    assert (results.outputs["cl"] == 0.5).all()
    # Laminar to turbulent: between a quarter of and three times the friction of a plate.
    plate = 2 * 0.075 / (math.log10(3e6) - 2) ** 2
    cd = results.outputs["cd"]
    assert ((cd > plate / 4) & (cd < 3 * plate)).all(), cd


def test_avl_itself_reads_the_case(tmp_path, stand_ins, monkeypatch):
    optvl = pytest.importorskip("optvl")
    definition = ready(tmp_path, "avl/wing.toml", plan=of_plan(2))
    kept = tuple(replace(a, keep="all") for a in definition.analyses)
    results = rows(replace(definition, analyses=kept), tmp_path / "s.sqlite")
    for folder in (definition.folder / "wing.cases").glob("*/flow"):
        monkeypatch.chdir(folder)
        solver = optvl.OVLSolver(geo_file="wing.avl")
        solver.set_constraint("alpha", "CL", 0.5)
        solver.execute_run()
        induced = solver.get_total_forces()["CDff"]
        assert np.abs(results.outputs["cd_induced"] / induced - 1).min() < 0.03


@pytest.mark.skipif(not SOAK or shutil.which("simpleFoam") is None, reason="OpenFOAM, minutes")
def test_openfoam_itself(tmp_path, monkeypatch):
    if Path("/usr/share/openfoam").is_dir():
        monkeypatch.setenv("WM_PROJECT_DIR", "/usr/share/openfoam")
    definition = ready(tmp_path, "openfoam/body.toml", plan=of_plan(1))
    kept = tuple(replace(a, keep="all") for a in definition.analyses)
    results = rows(replace(definition, analyses=kept), tmp_path / "s.sqlite")
    assert 10_000 < results.outputs["cells"][0] < 100_000
    # Friction on a coarse mesh against the ITTC line of 1957, pressure drag above it.
    model = moldloft.load(definition.model)
    model.set({name: column[0] for name, column in results.inputs.items()})
    frontal = math.pi * model["diameter"] ** 2 / 4
    line = 0.075 / (math.log10(5 * model["length"] / 1.19e-6) - 2) ** 2
    (log,) = (definition.folder / "body.cases").glob("*/flow/command.log")
    friction = float(re.findall(r"viscous: (\S+)\)", log.read_text())[-1])
    assert 0.5 < friction / (line * 2 * model.eval("mesh.area") / frontal) < 1.1
    assert friction < results.outputs["cd"][0] < 3 * friction


@pytest.mark.parametrize(
    ("case", "programs"),
    [("hams/float.toml", ["HAMS_Prog"]), ("nemoh/float.toml", ["preProc", "solver", "postProc"])],
)
def test_panel_codes_themselves(tmp_path, case, programs):
    if any(shutil.which(name) is None for name in programs):
        pytest.skip("not installed")
    check_heave(rows(ready(tmp_path, case, plan=of_plan(1)), tmp_path / "s.sqlite"))


# -- folders, commands, results ------------------------------------------------------------

BOX = "param float a = 2 in [1, 4]; param float b = 3 in [1, 4]; AbsPoint P(a, b, a * b);"


def box(tmp_path: Path, analysis: str, files: dict[str, str], more: str = "") -> Path:
    """A study of two cases with one analysis, its files beside it."""
    (tmp_path / "box.sdl").write_text(BOX)
    for name, text in files.items():
        place = tmp_path / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text)
    path = tmp_path / "box.toml"
    path.write_text(
        f"model = 'box.sdl'\nseconds = 30\n{more}[inputs]\na = [2, 3]\n[outputs]\narea = 'P.z'\n"
        f"[plan]\nmethod = 'grid'\nlevels = 2\n[analysis.flow]\n{analysis}"
    )
    return path


def swept(path: Path) -> study.Results:
    return study.sweep(study.read(path), path.with_suffix(".sqlite"))


SCRIPT = """#!/bin/sh
read first; echo "$first $SCALE" > read.txt
"""

WRITER = """
import json, sys
a = float(open("words.txt").read().split()[0])
if len(sys.argv) > 1:
    import h5py
    with h5py.File("r.h5", "w") as out:
        out["forces/total"] = [[0, 1, 2], [3, 4, a]]
open("wide.dat", "w").write(
    f"% a comment\\n# Time   Cd(f)  Cl\\n  ----  ----  ---\\n1 2 3\\n\\n2 {3 * a} 4\\n")
open("wide.csv", "w").write(f'"n";"x, y"\\n1;{5 * a}\\n')
"""

PARSER = """
from helper import twice
def half(model, folder):
    (folder / "extra.txt").write_text("extra")
    return {"half": model["a"] / 2, "title": "case"}
def read(file):
    return twice(float(file.read_text().split()[1]))
"""


def test_a_case_of_every_key(tmp_path):
    pytest.importorskip("h5py")
    analysis = f"""
prepare = "parser.py:half"
template = "case"
formats = {{ stl = "mesh/box.stl" }}
options = {{ whole = true }}
command = [["./first.sh"], ["{sys.executable}", "{{folder}}/writer.py", "hdf5"]]
stdin = "words.txt"
environment = {{ SCALE = "7" }}
keep = "all"
[analysis.flow.results]
h = {{ file = "r.h5", dataset = "forces/total", index = [1, 2] }}
cd = {{ file = "wide.dat", column = "Cd(f)" }}
first = {{ file = "wide.dat", column = "Cd(f)", row = 0 }}
x = {{ file = "wide.csv", column = "x, y" }}
p = {{ file = "words.txt", python = "parser.py:read" }}
s = {{ file = "read.txt", pattern = '(\\d+)$' }}
"""
    files = {
        "case/words.txt": "{a} {half:.3f} {title} {b} {area} {unknown} ${a} { a }\n",
        "case/first.sh": SCRIPT,
        "writer.py": WRITER,
        "parser.py": PARSER,
        "helper.py": "def twice(x):\n    return 2 * x\n",
    }
    path = box(tmp_path, analysis, files)
    # The model is a point: an STL needs a face.
    (tmp_path / "box.sdl").write_text(
        BOX + "Line l({0, 0, 0}, {a, 0, 0}); Line n({0, b, 0}, {a, b, 0}); RuledSurf s(l, n);"
    )
    (tmp_path / "case" / "first.sh").chmod(0o755)
    results = swept(path)
    assert results.counts == {"done": 2}, set(results.message)
    a = results.inputs["a"]
    expected = {"h": a, "cd": 3 * a, "first": 2 + 0 * a, "x": 5 * a, "p": a, "s": 7 + 0 * a}
    for name, values in expected.items():
        assert (results.outputs[name] == values).all(), name
    for folder in (tmp_path / "box.cases").glob("*/flow"):
        words = (folder / "words.txt").read_text().split(" ", 5)
        assert float(words[1]) == float(words[0]) / 2 and words[2:4] == ["case", "3.0"]
        assert float(words[4]) == 3 * float(words[0])
        # What is no word of the case is left as it is.
        assert words[5] == "{unknown} ${a} { a }\n"
        assert (folder / "extra.txt").exists() and (folder / "mesh" / "box.stl").exists()


def test_differences_of_a_program(tmp_path):
    analysis = f"""
command = ["{sys.executable}", "-c", "open('r.txt', 'w').write('{{a:.17g}} {{area:.17g}}')"]
differences = 0.01
[analysis.flow.results]
first = {{ file = "r.txt", pattern = '^(\\S+)' }}
second = {{ file = "r.txt", pattern = '(\\S+)$' }}
"""
    results = swept(box(tmp_path, analysis, {}, "derivatives = true\n"))
    assert results.counts == {"done": 2}, set(results.message)
    assert np.allclose(results.derivatives["first"]["a"], 1, rtol=1e-9)
    # The words of the template are those of the step: area = 3 a.
    assert np.allclose(results.derivatives["second"]["a"], 3, rtol=1e-9)
    assert not (tmp_path / "box.cases").exists()


@pytest.mark.parametrize(
    "changed", ["case/words.txt", "case/first.sh", "writer.py", "parser.py", "helper.py", "data"]
)
def test_a_changed_file_makes_new_cases(tmp_path, changed):
    analysis = f"""
prepare = "parser.py:half"
template = "case"
files = ["data"]
command = ["{sys.executable}", "{{folder}}/writer.py"]
[analysis.flow.results]
cd = {{ file = "wide.dat", column = "Cd(f)" }}
"""
    files = {
        "case/words.txt": "{a}\n",
        "case/first.sh": SCRIPT,
        "writer.py": WRITER,
        "parser.py": PARSER,
        "helper.py": "def twice(x):\n    return 2 * x\n",
        "data": "1",
    }
    path = box(tmp_path, analysis, files)
    assert swept(path).counts == {"done": 2}
    count: list[int] = []
    definition = study.read(path)
    study.sweep(definition, tmp_path / "box.sqlite", progress=lambda *_: count.append(1))
    assert not count
    with (tmp_path / changed).open("a") as out:
        out.write("\n# changed\n")
    study.sweep(definition, tmp_path / "box.sqlite", progress=lambda *_: count.append(1))
    assert len(count) == 2


WRONG_FILES = {
    "column": ("{ file = 'f', column = 'y' }", "x\n1\n", "has no column `y`"),
    "row": ("{ file = 'f', column = 'x', row = 3 }", "x\n1\n", "has no row 3"),
    "words": ("{ file = 'f', column = 'x' }", "x y\n1 2 3\n", "has 3 words, its header 2"),
    "no number": ("{ file = 'f', column = 'x' }", "x\n1.#IND\n", "found `1.#IND`"),
    "fortran": ("{ file = 'f', column = 'x' }", "x\n********\n", "found `********`"),
    "infinite": ("{ file = 'f', column = 'x' }", "x\ninf\n", "expected a finite number"),
    "binary": ("{ file = 'f', key = 'x' }", "\x00\x01", "has no value `x`"),
    "hdf5": ("{ file = 'f', dataset = 'x' }", "no HDF5", "has no value `x`"),
    "empty": ("{ file = 'f', pattern = 'x' }", "", "has no match of `x`"),
    "python": ("{ file = 'f', python = 'p.py:fails' }", "", "raised KeyError: 'CD'"),
    "none": ("{ file = 'f', python = 'p.py:none' }", "", "expected a number, found `None`"),
}


@pytest.mark.parametrize("name", WRONG_FILES)
def test_a_file_without_the_number(tmp_path, name):
    if name == "hdf5":
        pytest.importorskip("h5py")
    result, text, said = WRONG_FILES[name]
    parser = "def fails(file):\n    return {}['CD']\ndef none(file):\n    return None\n"
    path = box(
        tmp_path,
        f"template = 'case'\ncommand = ['true']\n[analysis.flow.results]\nr = {result}\n",
        {"case/f": text, "p.py": parser},
    )
    results = swept(path)
    assert results.counts == {"solver failed": 2} and said in results.message[0], results.message


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{aera}", "`case/f`: `{aera}` is unknown; did you mean `area`?"),
        ("{q:.3f}", "`case/f`: `{q}` is unknown"),
        ("{a:d}", "`case/f`: `{a:d}`: Unknown format code 'd'"),
    ],
)
def test_a_wrong_word_of_a_template(tmp_path, text, said):
    analysis = (
        "template = 'case'\ncommand = ['true']\n[analysis.flow.results]\n"
        "r = { file = 'f', pattern = 'x' }\n"
    )
    results = swept(box(tmp_path, analysis, {"case/f": text}))
    assert results.counts == {"solver failed": 2} and said in results.message[0], results.message


RESULT = "[analysis.flow.results]\nr = { file = 'f', pattern = 'x' }\n"


@pytest.mark.parametrize(
    ("analysis", "said"),
    [
        ("command = ['no-such-program']\n" + RESULT, "no program `no-such-program` on PATH"),
        ("command = ['true']\ntemplate = 'none'\n" + RESULT, "none` is no folder"),
        ("command = ['true']\nprepare = 'none.py:f'\n" + RESULT, "none.py` is no Python file"),
        ("command = ['true']\nfiles = ['none']\n" + RESULT, "none` is not there"),
        ("command = ['true']\nprepare = 'none.py'\n" + RESULT, "expected `file.py:function`"),
        ("command = []\n" + RESULT, "a command is a list of texts"),
        ("command = [['true'], []]\n" + RESULT, "a command is a list of texts"),
        ("command = [1]\n" + RESULT, "is a list of texts"),
        ("command = ['true']\nformats = ['stll']\n" + RESULT, "stll"),
        ("command = ['true']\noptions = { wole = true }\n" + RESULT, "did you mean `whole`"),
        ("command = ['true']\nenvironment = { A = 1 }\n" + RESULT, "is a text, found a number"),
        ("command = ['true']\nstdinn = 'x'\n" + RESULT, "did you mean `stdin`"),
        ("command = ['true']\n" + RESULT.replace("'x'", "'('"), "is no regular expression"),
        ("command = ['true']\n" + RESULT.replace("'x'", "'x', key = 'y'"), "needs one of"),
        ("command = ['true']\n" + RESULT.replace("'x'", "'x', row = 1.5"), "is a whole number"),
    ],
)
def test_a_wrong_analysis_is_refused_before_the_first_case(tmp_path, analysis, said):
    with pytest.raises(moldloft.Error) as error:
        swept(box(tmp_path, analysis, {}))
    assert said in str(error.value)


def test_a_missing_standard_input(tmp_path):
    results = swept(box(tmp_path, "command = ['true']\nstdin = 'none.txt'\n" + RESULT, {}))
    assert "`stdin`: no file `none.txt`" in results.message[0]


def alive(pid: int) -> bool:
    try:
        text = Path(f"/proc/{pid}/stat").read_text()
    except OSError:
        return False
    return text.rpartition(")")[2].split()[0] != "Z"


@pytest.mark.skipif(not Path("/proc").exists(), reason="processes of Linux")
@pytest.mark.parametrize("by", ["limit", "interrupt", "kill"])
def test_no_program_outlives_its_study(tmp_path, by):
    """It is ended with its case, on Ctrl-C, and after a kill of the study."""
    analysis = (
        f"command = ['sh', '-c', 'echo $$ > {tmp_path}/pid-$$; sleep 300 & wait']\n"
        "seconds = 200\n" + RESULT
    )
    path = box(tmp_path, analysis, {}, "seconds = 2\n" if by == "limit" else "")
    text = path.read_text()
    path.write_text(text.replace("seconds = 30\n", "", 1) if by == "limit" else text)
    words = [sys.executable, "-m", "moldloft", "study", "sweep", str(path), "-q"]
    with subprocess.Popen(words, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL) as run:
        deadline = time.monotonic() + 120
        while len(list(tmp_path.glob("pid-*"))) < 2 and time.monotonic() < deadline:
            time.sleep(0.05)
        if by != "limit":
            run.send_signal(signal.SIGINT if by == "interrupt" else signal.SIGKILL)
        run.wait(timeout=120)
    started = [int(place.read_text()) for place in tmp_path.glob("pid-*")]
    deadline = time.monotonic() + 30
    while any(map(alive, started)) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert len(started) == 2 and not any(map(alive, started))
    if by == "limit":
        with study.Store(tmp_path / "box.sqlite") as store:
            assert store.results().counts == {"timed out": 2}
