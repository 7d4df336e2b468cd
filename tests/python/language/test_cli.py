"""The command, as a person runs it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree

import pytest

import moldloft
from conftest import SAILBOAT

HULL = SAILBOAT / "hull.sdl"


def strict(text: str):
    """JSON without the numbers that JSON does not have."""

    def refuse(word: str):
        raise ValueError(word)

    return json.loads(text, parse_constant=refuse)


def test_build_writes_and_tells(cli, tmp_path):
    formats = ["gdf", "stl", "obj", "vtp", "vts", "p3d", "svg", "png"]
    done = cli("build", HULL, "--to", *formats, "-o", "out/new")
    for name in ("hull.gdf", "hull.stl", "hull.obj", "hull.vtp", "hull.p3d", "hull.png"):
        assert (tmp_path / "out" / "new" / name).stat().st_size > 0
        assert name in done.stdout
    assert "hydrostatics at z = 0, both sides" in done.stdout
    assert "CLoftSurf" in done.stdout
    assert not list(tmp_path.rglob("*.part"))


def test_build_as_data(cli, tmp_path):
    data = strict(cli("build", HULL, "--to", "gdf", "--json").stdout)
    (mesh,) = data["meshes"]
    assert (mesh["name"], mesh["kind"]) == ("hull", "CLoftSurf")
    assert (mesh["panels"], mesh["vertices"], mesh["closed"]) == (200, 231, False)
    assert mesh["area"] == pytest.approx(data["total"]["area"])
    assert isinstance(mesh["volume"], float) and not mesh["closed"]
    assert mesh["quality"]["aspect"]["max"] >= mesh["quality"]["aspect"]["min"] >= 1
    assert data["hydrostatics"]["sides"] == "both"
    assert data["hydrostatics"]["volume"] == pytest.approx(117.45, rel=0.03)
    point = next(o for o in data["objects"] if o["name"] == "P21")
    assert point == {"name": "P21", "kind": "AbsPoint", "class": "point", "ok": True, "parents": []}
    (file,) = data["files"]
    assert (tmp_path / file["path"]).stat().st_size == file["bytes"]
    assert data["ok"] is True


def test_build_sets_parameters_and_literals(cli):
    narrow = strict(cli("build", HULL, "--set", "beam=8", "--json").stdout)
    wide = strict(cli("build", HULL, "--set", "beam=12", "--json").stdout)
    assert narrow["hydrostatics"]["volume"] < wide["hydrostatics"]["volume"]
    assert narrow["params"]["beam"] == 8
    literal = cli("eval", SAILBOAT / "hull.ms2", "P21.y", "--set", "P21.y=5", "--json")
    assert strict(literal.stdout) == [5.0]


def test_build_at_another_level(cli):
    deep = strict(cli("build", HULL, "--level", "0.1", "--json").stdout)["hydrostatics"]
    one = strict(cli("build", HULL, "--sides", "one", "--density", "2", "--json").stdout)
    assert deep["level"] == 0.1 and deep["volume"] == pytest.approx(135.84661285, rel=1e-6)
    figures = one["hydrostatics"]
    assert figures["displacement"] == pytest.approx(2 * figures["volume"])


def test_eval(cli):
    done = cli("eval", HULL, "hull(.5,.25)", "length(MC2)", "P21.x", "--json")
    point, length, x = strict(done.stdout)
    assert point == pytest.approx([8.6422, 2.9203, -0.2053], abs=1e-4)
    assert length > 6 and x == 15.0
    assert cli("eval", HULL, "P21.x").stdout == "15\n"
    assert cli("eval", HULL, "P21 + {1, 0, 0}").stdout.startswith("{16, 4.815")


def test_check(cli, model_file):
    assert "no errors" in cli("check", HULL).stdout
    model_file("AbsPoint P(1, 2);\nLine L(P, Q);\n")
    done = cli("check", "model.sdl", status=1)
    assert done.stderr.count("error[") == 2
    assert "model.sdl:1:" in done.stderr and "model.sdl:2:" in done.stderr
    data = strict(cli("check", "model.sdl", "--json", status=1).stdout)
    assert data["ok"] is False
    assert [d["primary"]["line"] for d in data["diagnostics"]] == [1, 2]


def test_fmt(cli, model_file):
    path = model_file("AbsPoint   P( 1,2,3 ) ;")
    assert cli("fmt", "--check", path, status=1).stdout == f"{path} would be formatted\n"
    text = cli("fmt", path).stdout
    assert text == "AbsPoint P(1, 2, 3);\n"
    cli("fmt", "-w", path)
    assert path.read_text() == text
    assert cli("fmt", "--check", path).stdout == ""
    cli("fmt", "--check", HULL)


def test_convert(cli, tmp_path):
    text = cli("convert", HULL).stdout
    assert text.startswith("MultiSurf")
    cli("convert", HULL, "-o", "boat.ms2")
    assert (tmp_path / "boat.ms2").read_text() == text
    back = cli("convert", "boat.ms2").stdout
    assert moldloft.loads(back).eval("P21.y") == 4.815


def test_graph(cli, tmp_path):
    cli("graph", HULL)
    root = ElementTree.parse(tmp_path / "hull.graph.svg").getroot()
    words = set(root.itertext())
    assert {"hull", "MC1", "P11", "CLoftSurf"} <= words
    data = strict(cli("graph", HULL, "--json").stdout)
    assert ["MC2", "hull"] in data["edges"] and ["P21", "MC2"] in data["edges"]


def test_new_then_build(cli, tmp_path):
    cli("new", "boat")
    text = (tmp_path / "boat.sdl").read_text()
    assert cli("fmt", "--check", "boat.sdl").stdout == ""
    data = strict(cli("build", "boat.sdl", "--json").stdout)
    assert data["hydrostatics"]["volume"] > 0
    assert data["hydrostatics"]["open_edges"] >= 0
    assert "there already" in cli("new", "boat", status=1).stderr
    assert (tmp_path / "boat.sdl").read_text() == text


def test_render(cli, tmp_path):
    cli("render", HULL, "-o", "small.png", "--size", "320x200")
    data = (tmp_path / "small.png").read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    assert int.from_bytes(data[16:20]) == 320 and int.from_bytes(data[20:24]) == 200
    cli("render", HULL, "--size", "0x200", status=2)


def test_arrays_of_a_program_are_drawn(cli, tmp_path):
    model = tmp_path / "grids.sdl"
    model.write_text(
        "surface sheet[3,4]; for (i = 1:3) { for (j = 1:4) sheet[i,j] = {2*i, 3*j, 0}; }\n"
        "curve c[5]; for (i = 1:5) c[i] = {20, i, 0};\n"
    )
    cli("render", model, "-o", "all.png", "--size", "320x200")
    cli("render", model, "--only", "sheet", "-o", "s.png", "--size", "320x200")
    cli("render", model, "--only", "sheet", "c", "-o", "both.png", "--size", "320x200")
    pictures = [(tmp_path / name).read_bytes() for name in ("all.png", "s.png", "both.png")]
    assert pictures[0] == pictures[2] != pictures[1]
    assert "did you mean" in cli("render", model, "--only", "shet", status=1).stderr
    model.write_text("surface s[3,4];\n")
    assert "nothing to see" in cli("render", model, "-o", "none.png", status=1).stderr
    assert not (tmp_path / "none.png").exists()


def test_render_traced(cli, tmp_path):
    tee = str(SAILBOAT.parent / "implicit/tee.sdl")
    cli("render", tee, "--traced", "tee", "-o", "tee.png", "--size", "160x120", "--samples", "1")
    whole = (tmp_path / "tee.png").read_bytes()
    assert int.from_bytes(whole[16:20]) == 160 and int.from_bytes(whole[20:24]) == 120
    corners = ("--low=-1,-1,-1", "--high=1,1,1")
    cli("render", tee, "--traced", "tee - tee", "-o", "x.png", "--size", "16x16", *corners)
    assert "is not a set" in cli("render", tee, "--traced", "r1", status=1).stderr
    assert "nothere" in cli("render", tee, "--traced", "nothere", status=1).stderr
    assert "both" in cli("render", tee, "--traced", "tee", "--low=0,0,0", status=1).stderr
    assert "is not a point" in cli("render", tee, "--traced", "tee", "--low=0,0", status=2).stderr


def test_sections_of_a_set(cli, tmp_path):
    """Planes cut bodies as they cut surfaces: the two rings of a torus."""
    (tmp_path / "ring.sdl").write_text(
        "AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z);\n"
        "set ring = set(torus(axis, 2, 0.5)); SetBody body(ring, depth = 5);\n"
        "YContours cut(0, 0, 0, 1);\n"
    )
    cli("build", "ring.sdl", "--to", "svg", "-o", "out")
    drawing = next((tmp_path / "out").glob("*.svg")).read_text()
    assert drawing.count("<path") + drawing.count("<poly") >= 2


def test_files_are_what_their_names_say(cli, tmp_path):
    (tmp_path / "a.sdl").write_text("AbsPoint A(0, 0, 0);")
    for name in ("a.jpg", "a.svg"):
        assert "PNG" in cli("render", "a.sdl", "-o", name, status=1).stderr
        assert not (tmp_path / name).exists()
    (tmp_path / "a.gdf").write_text("title")
    (tmp_path / "a.png").write_bytes(b"\x89PNG")
    for command in ("convert", "check"):
        assert "expected ULEN and GRAV" in cli(command, "a.gdf", status=1).stderr
        assert "not a model" in cli(command, "a.png", status=1).stderr


def test_check_states_the_line_that_joins(cli, tmp_path):
    text = """AbsPoint A(0, 0, 0); AbsPoint B(4, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(4, 1, 0);
        AbsPoint P(0, 0, 0); AbsPoint Q(4, 0, 0); AbsPoint E(0, -1, 0); AbsPoint F(4, -1, 0);
        Line ab(A, B); Line qp(Q, P); Line cd(C, D); Line ef(F, E);
        RuledSurf top(ab, cd); RuledSurf low(ef, qp);"""
    (tmp_path / "two.sdl").write_text(text)
    said = cli("check", "two.sdl", status=1)
    assert "edges-not-joined" in said.stderr + said.stdout
    line = "Join j(top.v0, low.v1);"
    assert line in said.stderr + said.stdout
    (tmp_path / "one.sdl").write_text(text + line)
    assert "no errors" in cli("check", "one.sdl").stdout


def test_doc(cli):
    rows = strict(cli("doc", "--list", "--json").stdout)
    kinds = {row["name"]: row for row in rows}
    curve = kinds["BCurve"]
    assert curve["class"] == "curve"
    assert {"name", "class", "help", "required"} <= curve["fields"][0].keys()
    assert all(row["summary"] for row in rows)
    assert "BCurve" in cli("doc", "BCurve").stdout
    page = cli("doc", "Component").stdout
    assert page.startswith("Component name(") and "keel.tip" in page
    assert "`Component`" in cli("doc", "Componnt", status=1).stderr
    assert "`BCurve`" in cli("doc", "BCurv", status=1).stderr
    wanted = """AbsPoint RelPoint MirrPoint ProjPoint AbsBead RelBead AbsMagnet AbsRing Line Arc
        BCurve CCurve SubCurve MirrCurve LineSnake BSnake EdgeSnake UVSnake RuledSurf BLoftSurf
        CLoftSurf RevSurf TranSurf SubSurf MirrSurf XContours YContours ZContours"""
    assert set(wanted.split()) <= set(kinds)


def test_version_and_help(cli):
    assert cli("--version").stdout == f"moldloft {moldloft.__version__}\n"
    assert "build" in cli("--help").stdout
    for command in ("build", "check", "eval", "new", "fmt", "convert", "graph", "render", "doc"):
        assert "usage" in cli(command, "--help").stdout
        assert command in cli("--help").stdout


@pytest.mark.parametrize(
    "wrong",
    [
        ["bild"],
        ["build"],
        ["build", HULL, "--to", "dwg"],
        ["build", HULL, "--set", "beam"],
        ["build", HULL, "--set", "beam=wide"],
        ["build", HULL, "--set", "beam=nan"],
        ["eval", HULL],
        ["convert", HULL, "--to", "catpart"],
    ],
)
def test_wrong_use(cli, wrong):
    assert cli(*wrong, status=2).stdout == ""


def test_a_reader_that_leaves(tmp_path):
    done = subprocess.run(
        f"'{sys.executable}' -m moldloft doc --list | head -1",
        shell=True,
        capture_output=True,
        text=True,
    )
    assert done.stdout.startswith("name ") and done.stderr == ""


def wait_for(condition, seconds: float = 300) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_watch_builds_again_and_ends_quietly(model_file, tmp_path):
    path = model_file(HULL.read_text(), "boat.sdl")
    command = [sys.executable, "-m", "moldloft", "build", "boat.sdl", "--watch", "--to", "gdf"]
    with (tmp_path / "log").open("w") as log:
        process = subprocess.Popen(command, cwd=tmp_path, stdout=log, stderr=log)
    written = tmp_path / "boat.gdf"
    wait_for(lambda: written.exists() and "watching" in (tmp_path / "log").read_text())
    assert (tmp_path / "boat.png").exists()
    before = written.read_bytes()
    path.write_text(path.read_text() + "\nnonsense(")
    wait_for(lambda: "error[" in (tmp_path / "log").read_text())
    assert written.read_bytes() == before
    path.write_text(HULL.read_text().replace("4.815", "4.9"))
    wait_for(lambda: written.read_bytes() != before)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=300) == 130
    assert "Traceback" not in (tmp_path / "log").read_text()


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_ctrl_c_during_a_long_run(model_file, tmp_path):
    model_file("float s = 0;\nfor (i = 1:2000000000) { s = s + sin(i); }\nAbsPoint P(s, 0, 0);\n")
    # It tells when the guarded part begins: a machine may need any time to start Python.
    begun = (
        "import sys; from moldloft import cli; run = cli._run\n"
        "cli._run = lambda words: (print('begun', flush=True), run(words))[1]\n"
        "sys.exit(cli.main())"
    )
    command = [sys.executable, "-c", begun, "check", "--limit", "steps=1e12", "model.sdl"]
    with (tmp_path / "log").open("w") as log:
        process = subprocess.Popen(command, cwd=tmp_path, stderr=log, stdout=subprocess.PIPE)
    assert process.stdout is not None
    with process.stdout:
        assert process.stdout.readline().strip() == b"begun"
    time.sleep(0.6)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=300) == 130
    assert "error" not in (tmp_path / "log").read_text()
    assert "Traceback" not in (tmp_path / "log").read_text()
