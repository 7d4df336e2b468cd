"""Types that catch mistakes: kinds and functions from the registry, objects by class."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import moldloft
from moldloft import functions as f
from moldloft import kinds as k
from moldloft import stubs
from moldloft.builder import Builder
from moldloft.language import attributes, entry, reference

HERE = Path(moldloft.__file__).parent

#: Lines that end in `# wrong` must be errors of a type checker, the others none.
USER = """
import numpy as np

import moldloft
from moldloft import functions as f
from moldloft import kinds as k


@moldloft.model
def plate(length: float = 4) -> None:
    p = k.AbsPoint("A", 0, 0, 0)
    q = k.AbsPoint("B", length / 2, np.float64(1), 0)
    a = k.Line("a", p, q, divisions=4, colour=3)
    b = k.BCurve("b", [p, (0, 1, 2), q], degree=2, relabel=k.CosRelabel("r"))
    s = k.RuledSurf("s", a, b, divisions=[4, 4], spacing=["cosine", 1.2], tags="wetted")
    snake = k.UVSnake("snake", s, "u", 0.5)
    ring = k.AbsRing("ring", snake, 0.5)
    k.RelPoint("c", ring, 0, 0, 1)
    k.Line("d", ring, s(0.5, 0.5))
    k.AbsPoint("e", s.area, a.length, ring.u)
    k.FairSurf("fs", [[p, q], [q, p]], 0.1, as_="fit")
    ball = f.set(f.sphere([0, 0, 0], 1)) & f.set(f.plane([0, 0, 1], [0, 0, 0]) - 0.5)
    k.SetBody("body", ball | f.cuboid([0, 0, 0], [1, 1, 1]), depth=4)
    f.liming(f.sphere(p, 1), f.sphere(q, 2), f.sphere(q, 3), lambda_=0.4)
    k.Lien("x", a)  # wrong
    k.Line("x", p, q, wrong=3)  # wrong
    k.Line("x", p)  # wrong
    k.BCurve("c", 5)  # wrong
    k.BCurve("c", [p, q], degre=2)  # wrong
    k.RuledSurf("x", p, q)  # wrong
    k.RuledSurf("x", a, "b")  # wrong
    k.UVSnake("x", a, "u", 0.5)  # wrong
    k.AbsRing("x", a, 0.5)  # wrong
    k.AbsPoint("x", "0", 0, 0)  # wrong
    k.AbsPoint("x", a, 0, 0)  # wrong
    k.SetBody("x", a)  # wrong
    f.sphere(a, 1)  # wrong
    f.spere(p, 1)  # wrong
    s.aera  # wrong
    a(0.5, 0.5)  # wrong
    f.sphere(p, 1) | f.sphere(q, 1)  # wrong


plate(length=3)
plate(3)
plate(lenght=3)  # wrong
plate("3")  # wrong
m = moldloft.load("hull.sdl")
x: float = m["beam"] + 1
m["beam"] = 3
m["hull"].grid(3, 4).shape
m["hull"](0.5, [0, 1])
m["hull"].area + m["P"].x
m["P"].x = 3
hull = m["hull"]
if isinstance(hull, moldloft.Surface):
    points, normals = hull.grid(3, 4, normals=True)
m["hull"].gird(3, 4)  # wrong
m["hull"].aera  # wrong
m["beam"] = "wide"  # wrong
m.hydrostatics(heal=3)  # wrong
m.mesh().closd  # wrong
moldloft.load(3)  # wrong
m.jacobian(3)  # wrong
"""


def test_a_type_checker_finds_each_mistake_and_no_other(tmp_path: Path) -> None:
    path = tmp_path / "user.py"
    path.write_text(USER, encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", str(path)]
    config = tmp_path / "mypy.ini"
    config.write_text("[mypy]\n", encoding="utf-8")
    command += ["--config-file", str(config), "--cache-dir", str(tmp_path / "cache")]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    found = {int(n) for n in re.findall(r"^user\.py:(\d+): error", done.stdout, re.M)}
    lines = USER.splitlines()
    wrong = {k for k, line in enumerate(lines, 1) if line.endswith("# wrong")}
    missed = [lines[k - 1].strip() for k in sorted(wrong - found)]
    assert not missed, f"not found: {missed}"
    assert found == wrong, done.stdout


def pyright() -> str | None:
    """The command, where it can be had: the package needs Node.js and fetches the program once."""
    command = shutil.which("pyright", path=str(Path(sys.executable).parent)) or shutil.which(
        "pyright"
    )
    if command is None:
        return None
    try:
        done = subprocess.run([command, "--version"], capture_output=True, text=True, timeout=120)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return command if done.stdout.strip().startswith("pyright ") else None


def test_pyright_finds_each_mistake_and_no_other(tmp_path: Path) -> None:
    command = pyright()
    if command is None:
        pytest.skip("pyright is not there: it needs Node.js and a package registry")
    path = tmp_path / "user.py"
    path.write_text(USER, encoding="utf-8")
    settings: dict[str, object] = {"typeCheckingMode": "strict", "include": ["user.py"]}
    # Expressions are there for their types only; and what a model holds under a name is of every
    # class to a checker, so that an `isinstance` seems needless in its strict mode.
    for rule in ("UnusedExpression", "UnusedVariable", "UnnecessaryIsInstance"):
        settings[f"report{rule}"] = False
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    call = [command, "--outputjson", "--pythonpath", sys.executable, "--project", str(tmp_path)]
    done = subprocess.run(call, capture_output=True, text=True, cwd=tmp_path, timeout=300)
    reported = json.loads(done.stdout)["generalDiagnostics"]
    found = {row["range"]["start"]["line"] + 1 for row in reported if row["severity"] == "error"}
    lines = USER.splitlines()
    wrong = {k for k, line in enumerate(lines, 1) if line.endswith("# wrong")}
    missed = [lines[k - 1].strip() for k in sorted(wrong - found)]
    assert not missed, f"not found: {missed}"
    assert found == wrong, [
        row for row in reported if row["range"]["start"]["line"] + 1 not in wrong
    ]


def test_the_stubs_are_those_of_the_registry() -> None:
    assert (HERE / "kinds.pyi").read_text(encoding="utf-8") == stubs.kinds_stub()
    assert (HERE / "functions.pyi").read_text(encoding="utf-8") == stubs.functions_stub()
    assert (HERE / "implicit" / "rows.pyi").read_text(encoding="utf-8") == stubs.solids_stub()


def test_every_kind_and_function_has_a_page_and_a_signature() -> None:
    import inspect

    for row in reference():
        thing = getattr(k if row["is_kind"] else f, row["name"])
        assert row["summary"].split("\n")[0] in thing.__doc__
        names = list(inspect.signature(thing).parameters)
        for field in row["fields"]:
            assert field["name"] in names or field["name"] + "_" in names
            assert field["help"].split()[0] in thing.__doc__
        if row["is_kind"]:
            assert {field["name"] for field in attributes()} <= set(names)


def test_misspelt_names_are_refused_with_the_right_one() -> None:
    with pytest.raises(AttributeError, match="did you mean Line"):
        k.Lien  # noqa: B018
    with pytest.raises(AttributeError, match="did you mean `sphere`"):
        f.spere  # noqa: B018
    with Builder():
        a = k.Line("a", k.AbsPoint("A", 0, 0, 0), k.AbsPoint("B", 1, 0, 0))
        with pytest.raises(AttributeError, match="did you mean `length`"):
            a.lenght  # noqa: B018


def test_words_of_python_are_arguments_with_an_underscore() -> None:
    with Builder() as b:
        p = k.AbsPoint("P", 0, 0, 0)
        cone = f.liming(
            f.sphere(p, 2), f.sphere([3, 0, 0], 2), f.plane([1, 0, 0], [1, 0, 0]), lambda_=0.4
        )
        b.field("blend", cone)
    assert "lambda = 0.4" in b.text
    b.model()


def test_the_classes_that_the_types_accept_are_those_of_the_language() -> None:
    """Each argument of each kind: a handle of a class passes mypy if and only if it runs."""
    handles = {
        "point": "AbsPoint",
        "curve": "Line",
        "surface": "RuledSurf",
        "snake": "UVSnake",
        "bead": "AbsBead",
        "magnet": "AbsMagnet",
        "ring": "AbsRing",
        "plane": "ZPlane",
        "frame": "RPYFrame",
        "relabel": "CosRelabel",
    }
    made = """
AbsPoint a_point(0.1, 0.2, 0.3); AbsPoint p2(1, 0, 0);
AbsPoint p3(0, 1, 0.2); AbsPoint p4(1, 1, 0);
Line a_curve(a_point, p2); Line c2(p3, p4); RuledSurf a_surface(a_curve, c2);
UVSnake a_snake(a_surface, "u", 0.5); AbsBead a_bead(a_curve, 0.5);
AbsMagnet a_magnet(a_surface, 0.5, 0.5);
AbsRing a_ring(a_snake, 0.5); ZPlane a_plane(1); RPYFrame a_frame(a_point); CosRelabel a_relabel();
"""
    source = stubs.kinds_stub()
    aliases = dict(re.findall(r"^(_\w+): TypeAlias = (.*)$", source, re.M))

    def members(text: str) -> set[str]:
        found: set[str] = set()
        for word in re.findall(r"(?<![\w\[])(_?\w+)(?![\w\]])", re.sub(r"\[[^][]*\]", "", text)):
            found |= members(aliases[word]) if word in aliases else {word}
        return found

    def accepted(class_: str) -> set[str]:
        words = members(stubs._ARGUMENTS[class_])
        names = {"point", "curve", "surface", "snake", "bead", "magnet", "ring", "plane"}
        names |= {"frame", "relabel"}
        if "object" in words:
            return names
        parents = {
            "snake": {"SnakeHandle", "CurveHandle"},
            "ring": {"RingHandle", "BeadHandle", "MagnetHandle", "PointHandle"},
            "bead": {"BeadHandle", "PointHandle"},
            "magnet": {"MagnetHandle", "PointHandle"},
        }
        return {n for n in names if words & parents.get(n, {f"{n.capitalize()}Handle"})}

    arrays = ("farray", "curve or surface", "list", "block", "record", "field", "set", "mesh")
    tried = 0
    for class_ in stubs._ARGUMENTS:
        rows = [row for row in reference() if row["is_kind"] and row["fields"]]
        row = next(
            (r for r in rows if r["fields"][0]["class"] == class_ and not r["fields"][0]["many"]),
            None,
        )
        if row is None or class_ in ("value", "text", "number", "integer", *arrays):
            continue
        for name in handles:
            model = moldloft.loads(f"{made}{row['name']} it(a_{name});", strict=False)
            ids = {d.id for d in model.diagnostics if d.primary and d.primary.line == 8}
            refused = "wrong-class" in ids or "wrong-parent" in ids
            assert not ids & {"unexpected-token", "unknown-name"}
            assert refused == (name not in accepted(class_)), (row["name"], class_, name, ids)
            tried += 1
    assert tried > 60
    assert entry("Line")["class"] == "curve"


PUBLIC = (
    "adapters builder cad exchange.files fairing fairing.tables formats grids high_order "
    "hydro.hydrostatics hydro.stability hydro.weights implicit language lines_plan loading models "
    "offsets shapes.blocks shapes.mesh shapes.nurbs shapes.objects shapes.sketches study units"
)


def test_docstrings_describe_every_argument() -> None:
    """Public functions and methods: numpydoc's ``Parameters`` names each argument."""
    import importlib
    import inspect

    modules = [moldloft, *(importlib.import_module(f"moldloft.{n}") for n in PUBLIC.split())]
    functions: dict[str, object] = {}
    for module in modules:
        for name in getattr(module, "__all__", []):
            thing = getattr(module, name)
            if not str(getattr(thing, "__module__", "")).startswith("moldloft"):
                continue
            where = f"{thing.__module__}.{name}"
            if inspect.isclass(thing):
                for key, value in vars(thing).items():
                    value = getattr(value, "__func__", value)
                    if inspect.isfunction(value) and not key.startswith("_"):
                        functions[f"{where}.{key}"] = value
            elif inspect.isfunction(thing):
                functions[where] = thing
    assert len(functions) > 250
    missing = []
    for where, function in functions.items():
        doc = inspect.getdoc(function) or ""
        names = [n for n in inspect.signature(function).parameters if n not in ("self", "cls")]
        _, begun, rest = doc.partition("Parameters\n----------\n")
        described = set(re.findall(r"^\**(\w+(?:, \**\w+)*)(?: :.*)?$", rest, re.M))
        words = {word.strip("* ") for names_ in described for word in names_.split(",")}
        if names and not (begun and set(names) <= words):
            missing.append(f"{where}: {sorted(set(names) - words)}")
    assert not missing, "\n".join(missing)
