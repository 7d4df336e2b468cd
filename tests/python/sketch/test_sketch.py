"""Sketches from outside: the command, the journal, the class, the files."""

from __future__ import annotations

import copy
import dataclasses
import json
import os
import pickle
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import moldloft
from moldloft import Sketch, SketchError, UnknownNameError

EXAMPLES = Path(__file__).parents[3] / "examples" / "sketch"
VOLUMES = {
    "dam": ("DAM", 169_200.0),
    "lock_wall": ("WALL", 49_840.0),
    "shed": ("SHED", 240.0),
    "bracket": ("BRACKET", 27.0 + 0.75 * (1.0 - np.pi / 4.0)),
}

SLAB = """SKETCH SLAB 2D XZ
POINT 1 0 0; POINT 2 90 2; POINT 3 91 30; POINT 4 1 29
POLYLINE 1 2 3 4 CLOSE
DIMENSION W X 1 2 = 8; DIMENSION H Z 1 4 = 2 IN 1 5
EXTRUDE 5
"""


@pytest.fixture
def environment(tmp_path):
    return {**os.environ, "XDG_STATE_HOME": str(tmp_path / "state"), "PYTHONUNBUFFERED": "1"}


def command(*arguments, environment=None, text=None, folder=None):
    line = [sys.executable, "-m", "moldloft", "sketch", *map(str, arguments)]
    return subprocess.run(
        line, input=text, capture_output=True, text=True, env=environment, cwd=folder, check=False
    )


# -- the command ------------------------------------------------------------------------------


@pytest.mark.parametrize("name", VOLUMES)
def test_a_file_is_run(name, environment):
    done = command(EXAMPLES / f"{name}.skt", "--json", environment=environment)
    assert done.returncode == 0 and done.stderr == ""
    data = json.loads(done.stdout)
    [one] = data["objects"]
    object_name, volume = VOLUMES[name]
    assert one["name"] == object_name and data["ok"] is True
    assert one["volume"] == pytest.approx(volume, rel=1e-9)
    for key in ("points", "lines", "faces", "area", "centroid", "missing", "dimensions"):
        assert one[key]
    assert one["missing"] == {"X": 0, "Y": 0, "Z": 0}
    text = command(EXAMPLES / f"{name}.skt", environment=environment)
    assert text.returncode == 0 and "complete" in text.stdout


def test_dimensions_are_set_from_the_command_line(environment):
    done = command(EXAMPLES / "dam.skt", "--set", "CREST=20", "--json", environment=environment)
    assert json.loads(done.stdout)["objects"][0]["volume"] == pytest.approx(187_200.0)


def test_errors_say_where_and_what_next(tmp_path, environment):
    path = tmp_path / "bad.skt"
    path.write_text("SKETCH A\nPOINT 1 0 0\nCONVERT\nDIM W X 1.2.3 4\n")
    done = command(path, environment=environment)
    assert done.returncode == 1 and "Traceback" not in done.stderr
    assert f"{path}:3: error 102:" in done.stderr
    assert f"{path}:4: error: two decimal points in 1.2.3" in done.stderr
    assert done.stderr.count("next:") == 2
    data = json.loads(command(path, "--json", environment=environment).stdout)
    assert data["ok"] is False
    assert [r["code"] for r in data["replies"] if r["severity"] == "error"] == [102, None]
    missing = command(tmp_path / "none.skt", environment=environment)
    assert missing.returncode == 1 and "no such file" in missing.stderr
    binary = tmp_path / "x.skt"
    binary.write_bytes(b"\xff\xfe\x00")
    assert "UTF-8" in command(binary, environment=environment).stderr


def test_a_pipe_talks_to_the_prompt(tmp_path, environment):
    text = SLAB + "MEASURE VOLUME\nSAVE slab.skt\nNONSENSE\nQUIT\nSKETCH LATER\n"
    done = command(environment=environment, text=text, folder=tmp_path)
    assert "80" in done.stdout and "wrote slab.skt" in done.stdout
    assert "no command NONSENSE" in done.stderr and done.returncode == 1
    assert (tmp_path / "slab.skt").exists()
    # Saved before the end: nothing is left to go on with.
    assert "not saved" not in done.stderr
    again = command("--json", environment=environment, text='INPUT "slab.skt"\n', folder=tmp_path)
    assert json.loads(again.stdout)["objects"][0]["volume"] == 80.0


def test_files_go_where_they_are_asked_for(tmp_path, environment):
    path = tmp_path / "slab.skt"
    path.write_text(SLAB + 'EXPORT STL\nEXPORT SVG "part/slab.svg"\nSAVE SLAB AS slab.json\n')
    done = command(path, "-o", tmp_path / "out", environment=environment)
    assert done.returncode == 0, done.stderr
    for name in ("SLAB.stl", "part/slab.svg", "slab.json"):
        assert (tmp_path / "out" / name).stat().st_size > 100
    twin = command(tmp_path / "out" / "slab.json", "--json", environment=environment)
    assert json.loads(twin.stdout)["objects"][0]["volume"] == 80.0
    # RUN and INPUT look beside the script.
    path.with_name("two.skt").write_text("RUN slab.skt\n")
    done = command(tmp_path / "two.skt", "-o", tmp_path / "out", "--json", environment=environment)
    assert json.loads(done.stdout)["objects"][0]["name"] == "SLAB"


# -- the journal ------------------------------------------------------------------------------


def test_an_unsaved_session_can_be_gone_on_with(tmp_path, environment):
    first = command(environment=environment, text=SLAB)
    assert "--recover" in first.stderr
    second = command("--recover", "--json", environment=environment, text="SET H 3\n")
    assert "restored" in second.stderr
    assert json.loads(second.stdout)["objects"][0]["volume"] == pytest.approx(120.0)
    third = command("--recover", "--json", environment=environment, text="")
    assert json.loads(third.stdout)["objects"][0]["volume"] == pytest.approx(120.0)


def test_answers_are_restored_with_their_questions(environment):
    text = SLAB + "DELETE DIMENSION H\nDIM T Z 1 4\nYES\nUNDO\nREDO\nGENERATE FACES ASK\nACCEPT\n"
    first = command(environment=environment, text=text)
    wanted = command("--json", environment=environment, text=text)
    assert first.returncode == wanted.returncode == 0
    restored = command("--recover", "--json", environment=environment, text="")
    assert json.loads(restored.stdout)["objects"] == json.loads(wanted.stdout)["objects"]


def _killed_at(moment: float, environment, lines: list[str]) -> int:
    """Feeds lines to a prompt, kills it after a while; how many lines had been answered."""
    process = subprocess.Popen(
        [sys.executable, "-m", "moldloft", "sketch"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=environment,
        text=True,
        bufsize=1,
    )
    answered = 0
    end = None
    for line in lines:
        try:
            process.stdin.write(line + "\n")
            process.stdin.flush()
        except BrokenPipeError:
            break
        if process.stdout.readline() == "":
            break
        answered += 1
        if end is None:
            end = time.monotonic() + moment
        if time.monotonic() > end:
            # Kill it while the next command may be under way.
            process.stdin.write(lines[min(answered, len(lines) - 1)] + "\n")
            break
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    process.stdout.close()
    process.stdin.close()
    return answered


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL here")
def test_a_killed_process_loses_no_completed_command(environment):
    rounds = 25 if os.environ.get("MOLDLOFT_SOAK") else 4
    chance = random.Random(7)
    # Each command is answered by one line, so the reader knows when it was completed.
    lines = ["SKETCH A; POINT 1 1"] + [f"POINT {k} {k % 7}" for k in range(2, 400)]
    for _ in range(rounds):
        answered = _killed_at(chance.uniform(0.0, 0.15), environment, lines)
        assert answered > 0
        offered = command(environment=environment, text="")
        assert "--recover" in offered.stderr
        done = command("--recover", "--json", environment=environment, text="")
        points = json.loads(done.stdout)["objects"][0]["points"]
        # All that was answered, and at most the one that was under way.
        assert answered <= len(points) <= answered + 1


def test_a_torn_line_is_left_out(tmp_path, environment):
    folder = tmp_path / "state" / "moldloft" / "sketch"
    folder.mkdir(parents=True)
    journal = folder / "20260101-000000-1.skj"
    journal.write_text("! moldloft sketch journal 1\nSKETCH A\nPOINT 1 0 0\nPOINT 2 5")
    done = command("--recover", "--json", environment=environment, text="")
    assert len(json.loads(done.stdout)["objects"][0]["points"]) == 1
    assert not journal.exists()
    assert "no unsaved session" not in done.stderr


def test_an_edited_file_keeps_its_journal_beside_it(tmp_path, environment):
    path = tmp_path / "slab.skt"
    path.write_text(SLAB)
    process = subprocess.Popen(
        [sys.executable, "-m", "moldloft", "sketch", str(path), "--edit"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=environment,
        text=True,
    )
    process.stdin.write("SET H 4\nMEASURE VOLUME\n")
    process.stdin.flush()
    while "160" not in (line := process.stdout.readline()):
        assert line
    assert (tmp_path / "slab.skt.skj").exists()
    process.kill()
    process.communicate()
    done = command(path, "--recover", "--json", environment=environment, text="SAVE slab.skt\n",
                   folder=tmp_path)  # fmt: skip
    assert json.loads(done.stdout)["objects"][0]["volume"] == pytest.approx(160.0)
    # Saved, so its journal is gone, and the file by itself is the new state.
    assert not (tmp_path / "slab.skt.skj").exists()
    assert Sketch.load(path).volume == pytest.approx(160.0)


# -- the class --------------------------------------------------------------------------------


def test_the_class(tmp_path):
    s = Sketch.load(EXAMPLES / "dam.skt")
    assert s.names == ["DAM"] and "dam" in s and len(s) == 1
    assert s.volume == pytest.approx(169_200.0) and s.area == pytest.approx(20_968.0)
    assert s.centroid == pytest.approx([22.93617, 25.0, 32.93617])
    assert s.points.shape == (10, 3) and list(s.labels) == list(range(1, 11))
    assert s["crest"] == 16.0 and s.dimensions["RUN"] == 54.0
    s["CREST"] = 20
    assert s.volume == pytest.approx(187_200.0)
    s["CREST"] = "HEIGHT/4.5"
    assert s.volume == pytest.approx(169_200.0)
    vertices, faces = s.mesh()
    assert vertices.shape == (10, 3) and faces.shape[1] == 4
    path = s.save(tmp_path / "copy.skt")
    assert Sketch.load(path).objects == s.objects
    twin = s.save(tmp_path / "copy.json")
    assert Sketch.load(twin).objects == s.objects
    assert s.text == path.read_text()
    assert s.picture(200, 150).startswith(b"\x89PNG")
    with pytest.raises(SketchError, match="unknown dimension") as caught:
        s["NOTHING"] = 1
    assert caught.value.replies[-1].next
    with pytest.raises(UnknownNameError):
        s["NOTHING"]
    with pytest.raises(UnknownNameError):
        s.mesh(name="other")
    with pytest.raises(UnknownNameError):
        _ = Sketch().volume
    assert isinstance(caught.value, (moldloft.Error, ValueError))


@pytest.mark.parametrize("name", VOLUMES)
def test_copies_and_pickles_are_the_same_sketch(name):
    sketch = Sketch.load(EXAMPLES / f"{name}.skt", strict=False)
    for other in (pickle.loads(pickle.dumps(sketch)), copy.deepcopy(sketch), copy.copy(sketch)):
        assert other.text == sketch.text
        assert (other.volume, other.active) == (sketch.volume, sketch.active)
        dimension, value = next(iter(sketch.dimensions.items()))
        before = sketch.text
        other[dimension] = 1.01 * value
        assert sketch.text == before != other.text


def test_gradients_are_differences():
    s = Sketch.load(EXAMPLES / "bracket.skt")
    g = s.gradient()
    assert g.by == ("R", "THICK", "LEG", "WIDTH", "BASE", "UPRIGHT")
    before = s.points
    for k, name in enumerate(g.by):
        x, h = s[name], 1e-5
        rows = s.sweep(name, [x - h, x + h])
        slope = (rows[1] - rows[0]) / (2 * h)
        assert g.volume[k] == pytest.approx(slope[0], abs=1e-6)
        assert g.area[k] == pytest.approx(slope[1], abs=1e-5)
        assert g.centroid[k] == pytest.approx(slope[2:], abs=1e-6)
    assert np.array_equal(before, s.points)
    assert g.points.shape[0] == 6 and g.points.shape[2] == 3
    assert np.isnan(Sketch.load(EXAMPLES / "dam.skt").sweep("HEIGHT", [np.nan])).all()
    with pytest.raises(UnknownNameError):
        s.gradient(["nothing"])


def test_threads_do_not_disturb_each_other():
    from concurrent.futures import ThreadPoolExecutor

    def volume(crest):
        s = Sketch.load(EXAMPLES / "dam.skt")
        s["CREST"] = crest
        return s.volume

    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(volume, [16, 18, 20, 22] * 3))
    assert found == [volume(c) for c in [16, 18, 20, 22]] * 3


# -- files ------------------------------------------------------------------------------------


def _of_3mf(path: Path):
    """Vertices, triangles and unit of a 3MF package, read as its specification has them."""
    import zipfile
    from xml.etree import ElementTree

    with zipfile.ZipFile(path) as package:
        assert package.testzip() is None
        assert "[Content_Types].xml" in package.namelist()
        root = ElementTree.fromstring(package.read("3D/3dmodel.model"))
    space = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    vertices = [[float(v.get(c)) for c in "xyz"] for v in root.iter(f"{space}vertex")]
    corners = ("v1", "v2", "v3")
    triangles = [[int(t.get(c)) for c in corners] for t in root.iter(f"{space}triangle")]
    assert root.find(f"{space}build/{space}item") is not None
    return vertices, triangles, root.get("unit")


def _of_dxf(path: Path) -> list[dict[int, str]]:
    """The entities of a DXF file: its group codes come in pairs of lines."""
    lines = path.read_text().splitlines()
    assert len(lines) % 2 == 0
    entities: list[dict[int, str]] = []
    for code, value in zip(lines[::2], lines[1::2], strict=True):
        if int(code) == 0:
            entities.append({})
        entities[-1][int(code)] = value
    assert entities[-1][0] == "EOF"
    return entities


@pytest.mark.parametrize("name", VOLUMES)
def test_exports_are_read_back(name, tmp_path):
    import meshio
    import trimesh

    s = Sketch.load(EXAMPLES / f"{name}.skt")
    # Chords keep within a thousandth of the size of the body.
    exact = pytest.approx(VOLUMES[name][1], rel=1e-3 if name == "bracket" else 1e-6)
    vertices, triangles, unit = _of_3mf(s.export(tmp_path / f"{name}.3mf"))
    assert unit == {"dam": "foot", "lock_wall": "foot", "shed": "meter"}.get(name, "millimeter")
    meshes = {"3mf": trimesh.Trimesh(vertices, triangles, process=False)}
    for format in ("stl", "obj", "gltf"):
        path = s.export(tmp_path / f"{name}.{format}")
        meshes[format] = trimesh.load(path, force="mesh")
        meshes[format].merge_vertices()
    # glTF is in metres.
    meshes["gltf"].apply_scale(1 / {"foot": 0.3048, "meter": 1.0, "millimeter": 0.001}[unit])
    for format, mesh in meshes.items():
        assert mesh.is_watertight and mesh.is_winding_consistent, format
        assert mesh.volume == exact, format
        assert len(mesh.faces) == len(triangles)
    # glTF is y up; a turn keeps the volume.
    assert meshes["gltf"].extents[1] == pytest.approx(np.ptp(s.points[:, 2]), rel=1e-6)
    # meshio first tries a text as a binary file.
    with np.errstate(over="ignore"):
        stl = meshio.read(tmp_path / f"{name}.stl")
    assert sum(len(c.data) for c in stl.cells) == len(triangles)
    entities = _of_dxf(s.export(tmp_path / f"{name}.dxf"))
    facets = [e for e in entities if e[0] == "3DFACE"]
    assert len(facets) == len(triangles)
    length = 0.0
    for e in (e for e in entities if e[0] == "LINE"):
        ends = np.array([[float(e[10 * c + k]) for c in (1, 2, 3)] for k in (0, 1)])
        length += float(np.linalg.norm(ends[1] - ends[0]))
    assert np.isfinite(length) and length > 3 * max(meshes["stl"].extents)
    data = json.loads(s.export(tmp_path / f"{name}.json").read_text())
    assert data["volume"] == pytest.approx(VOLUMES[name][1], rel=1e-9)
    svg = s.export(tmp_path / f"{name}.svg").read_text()
    from xml.etree import ElementTree

    assert ElementTree.fromstring(svg).tag.endswith("svg")


def step_solid(path):
    """Volume in cubic millimetres, kinds of surfaces and whether OCCT finds the solid valid."""
    pytest.importorskip("OCP")
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    shape = reader.OneShape()
    props = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, props, 1e-9, False, False)
    kinds = []
    faces = TopExp_Explorer(shape, TopAbs_FACE)
    while faces.More():
        kinds.append(
            BRepAdaptor_Surface(TopoDS.Face(faces.Current()))
            .GetType()
            .name.removeprefix("GeomAbs_")
        )
        faces.Next()
    return props.Mass(), kinds, BRepCheck_Analyzer(shape).IsValid()


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("bracket", {"Plane", "Cylinder"}),
        ("dam", {"Plane"}),
        ("rounded", {"Plane", "Cylinder", "Sphere"}),
        ("ring", {"Plane", "Cylinder", "Torus"}),
        ("drilled", {"Plane", "Cylinder"}),
        ("sunk", {"Plane", "Cylinder", "Cone"}),
    ],
)
def test_step_has_the_surfaces_of_the_solid(name, kinds, tmp_path):
    s = Sketch.load(EXAMPLES / f"{name}.skt") if (EXAMPLES / f"{name}.skt").exists() else Sketch()
    if not s.names:
        s.run(SLAB + "SET UNITS CM")
        drill = """SKETCH DRILL 2D XZ
            POINT 1 0 0; POINT 2 90 1; POINT 3 91 90; POINT 4 1 91; POLYLINE 1 2 3 4 CLOSE
            SET UNITS CM; DIM B X 1 2 1; DIM C Z 1 4 1; EXTRUDE 9
            CIRCLE C1 CORNER 1 4 2; CIRCLE C2 CORNER 5 8 6; MOVE DRILL 3 -2 0.5; CUT SLAB DRILL"""
        s.run(
            {
                "rounded": "FILLET SLAB 0.5 EDGES ALL",
                "ring": f"{drill}; FILLET SLAB 0.25 EDGES BETWEEN BOTTOM Y DRILL.C1",
                "drilled": drill,
                "sunk": f"{drill}; CHAMFER SLAB 0.25 EDGES BETWEEN BOTTOM Y DRILL.C1",
            }[name]
        )
    path = s.export(tmp_path / f"{name}.step")
    volume, found, valid = step_solid(path)
    size = {"bracket": 1, "dam": 304.8}.get(name, 10)
    assert volume == pytest.approx(s.volume * size**3, rel=1e-8)
    assert set(found) == kinds
    assert valid


def test_a_dxf_drawing_becomes_a_sketch(tmp_path):
    path = tmp_path / "plan.dxf"
    corners = [(0, 0), (90, 0), (90, 30), (0, 30)]
    text = "0\nSECTION\n2\nENTITIES\n"
    for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1], strict=True):
        text += f"0\nLINE\n8\n0\n10\n{a}\n20\n{b}\n30\n0\n11\n{c}\n21\n{d}\n31\n0\n"
    path.write_text(text + "0\nENDSEC\n0\nEOF\n")
    s = Sketch(tmp_path)
    s.run('SKETCH PLAN 2D XY\nIMPORT "plan.dxf"\nDIM W X 1 2 = 9; DIM H Y 2 3 = 3; EXTRUDE 2')
    assert s.volume == pytest.approx(54.0)


# -- in models --------------------------------------------------------------------------------


def test_a_sketch_is_a_model(tmp_path):
    m = moldloft.load(EXAMPLES / "dam.skt")
    assert list(m.params) == ["dam.CREST", "dam.LENGTH1", "dam.HEIGHT", "dam.PARAPET"]
    assert (m.params["dam.CREST"].low, m.params["dam.CREST"].high) == (10.0, 30.0)
    assert m.mesh().summary["closed"] and m.mesh().summary["volume"] == pytest.approx(169_200.0)
    m["dam.CREST"] = 20
    assert m.eval("dam.volume") == pytest.approx(187_200.0)
    assert m.derivative("dam.volume", "dam.CREST") == pytest.approx(4_500.0)
    assert m.jacobian(["dam.CREST", "dam.HEIGHT"]).shape == (10, 3, 2)
    assert m["dam.p4"].z == pytest.approx(90.0)
    solid = m.eval("dam.solid")
    assert solid["vertices"].shape == (10, 3) and solid["volume"] == pytest.approx(187_200.0)
    with pytest.raises(moldloft.ModelError, match="out of its range"):
        m["dam.CREST"] = 99
    with pytest.raises(moldloft.ModelError, match=r"dam\.CREST"):
        m["dam.p4.z"] = 3


PLATE_AND_DRILL = """SKETCH B 2D XY
POINT 1 0 0; POINT 2 90 0; POINT 3 90 90; POINT 4 0 90; POLYLINE 1 2 3 4 CLOSE
DIM X 1 2 60; DIM Y 1 4 40; EXTRUDE 8
SKETCH H 2D XY
POINT 1 0 0; POINT 2 90 0; POINT 3 90 90; POINT 4 0 90; POLYLINE 1 2 3 4 CLOSE
DIM X 1 2 10; DIM Y 1 4 10; EXTRUDE 12
MOVE H 25 15 -2
CUT B H INTO P
"""


def test_a_model_shows_results_and_no_tools(tmp_path):
    path = tmp_path / "part.skt"
    path.write_text(PLATE_AND_DRILL)
    m = moldloft.load(path)
    assert m.mesh().summary["volume"] == pytest.approx(60 * 40 * 8 - 10 * 10 * 8)
    # The tool keeps its names.
    assert m.eval("H.volume") == pytest.approx(1200.0)
    path.write_text(PLATE_AND_DRILL + "KEEP H\n")
    kept = moldloft.load(path).mesh().summary["volume"]
    assert kept == pytest.approx(60 * 40 * 8 - 10 * 10 * 8 + 1200)


def test_sweeps_over_dimensions():
    m = moldloft.load(EXAMPLES / "dam.skt")
    found = []
    for crest in (12, 16, 20):
        m["dam.CREST"] = crest
        found.append(m.eval("dam.volume"))
    assert np.diff(found) == pytest.approx([18_000.0, 18_000.0])


def test_a_program_loads_a_sketch(tmp_path):
    line = [sys.executable, "-m", "moldloft", "build", str(EXAMPLES / "site.sdl")]
    line += ["--set", "dam.CREST=20", "--json", "--to", "stl", "-o", str(tmp_path)]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    data = json.loads(done.stdout)
    assert data["params"]["dam.CREST"] == 20
    [patch] = data["meshes"]
    assert patch["name"] == "dam.solid" and patch["closed"]
    assert patch["volume"] == pytest.approx(187_200.0)
    import trimesh

    mesh = trimesh.load(tmp_path / "site.stl", force="mesh")
    mesh.merge_vertices()
    assert mesh.is_watertight and mesh.volume == pytest.approx(187_200.0)


def test_faults_of_a_sketch_point_into_it(tmp_path):
    (tmp_path / "a.skt").write_text("SKETCH A\nPOINT 1 0 0\nCONVERT\n")
    (tmp_path / "m.sdl").write_text('load "a.skt";\n')
    line = [sys.executable, "-m", "moldloft", "check", str(tmp_path / "m.sdl")]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "a.skt:3:1" in done.stderr and "[102]" in done.stderr


# -- documentation ----------------------------------------------------------------------------


def test_the_python_of_the_page_runs(tmp_path, monkeypatch):
    import re
    import shutil

    page = (Path(__file__).parents[3] / "docs" / "sketch.md").read_text(encoding="utf-8")
    shutil.copytree(EXAMPLES, tmp_path / "examples" / "sketch")
    monkeypatch.chdir(tmp_path)
    for block in re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL):
        namespace: dict[str, object] = {}
        exec(compile(block, "sketch.md", "exec"), namespace)
    assert (tmp_path / "dam.3mf").exists() and (tmp_path / "dam.skt").exists()
    program = page.split("```\nload ")[1].split("```")[0]
    path = tmp_path / "examples" / "sketch" / "page.sdl"
    path.write_text("load " + program)
    assert moldloft.load(path)["gate"].z == pytest.approx(92.0)


def test_the_pictures_are_those_of_the_scripts(tmp_path):
    images = Path(__file__).parents[3] / "docs" / "images"
    for name in VOLUMES:
        s = Sketch.load(EXAMPLES / f"{name}.skt")
        s.run("SHOW PLANES")
        drawn = s.export(tmp_path / f"{name}.svg").read_text()
        assert drawn == (images / f"sketch-{name}.svg").read_text()
        assert (images / f"sketch-{name}.png").read_bytes().startswith(b"\x89PNG")


# -- edits as data ----------------------------------------------------------------------------


def test_edits_are_data():
    s = Sketch()
    s.run("SKETCH PLATE 2D XZ")
    ends = [[0, 1], [1, 2], [2, 3], [3, 0]]
    points, lines = s.draw([[0, 0], [90, 1], [91, 30], [1, 29]], ends)
    assert list(points) == [1, 2, 3, 4] and list(lines) == [1, 2, 3, 4]
    # Drawn at once: one step.
    s.run("UNDO")
    assert len(s.points) == 0
    s.run("REDO")
    (change,) = s.dimension("X", points[0], points[1], 8, name="W")
    assert change.numbers == ("W",) and set(change.moved) == {2, 3}
    (missing,) = s.suggestions()
    assert missing is not None and missing.axis == "Z"
    assert missing.value == pytest.approx(2.6, abs=0.2)
    s.edit("ACCEPT ALL; EXTRUDE 5")
    assert s.volume == pytest.approx(40 * missing.value)
    before = s.session.journal_length()
    with s.drag() as drag:
        for k in range(50):
            drag.move(3, 91 + k, 33)
    assert drag.changes[0].drawn == (3,) and s.session.journal_length() == before + 1
    with pytest.raises(RuntimeError), s.drag():
        drag.move(3, 0, 0)
        raise RuntimeError
    snapped = s.snaps(140.5, 33, reach=2)[0]
    assert (snapped.kind, snapped.point, snapped.at) == ("point", 3, (140.0, 33.0))
    middle, on_line = s.snaps(45, 0.4, reach=1)[:2]
    assert (middle.kind, middle.line, middle.part) == ("mid", 1, 0.5)
    assert on_line.line == 1 and on_line.part == pytest.approx(0.5, abs=0.01)
    assert s.snaps(1e6, 1e5, reach=1) == []
    with pytest.raises(SketchError, match="expected indices"):
        s.draw([[0, 0]], [[0, 1]])
    with pytest.raises(SketchError):
        s.edit("SET NOTHING 5")


def test_a_picture_without_dimensions_has_a_body():
    s = Sketch()
    s.run(
        "SKETCH BOX; AXES 345 40 90; POINT 1 0 0; POINT 2 97 -26; POINT 3 1 50; POINT 4 97 24\n"
        "POINT 5 61 52; POINT 6 158 25; POINT 7 62 102; POINT 8 159 76\n"
        "LINE 1 2 TYPE X; LINE 3 4 TYPE X; LINE 5 6 TYPE X; LINE 7 8 TYPE X; LINE 1 3 TYPE Z\n"
        "LINE 2 4 TYPE Z; LINE 5 7 TYPE Z; LINE 6 8 TYPE Z; LINE 1 5 TYPE Y; LINE 2 6 TYPE Y\n"
        "LINE 3 7 TYPE Y; LINE 4 8 TYPE Y"
    )
    found = s.preview()
    assert found is not None
    vertices, faces = found
    assert vertices.shape == (8, 3) and len(faces) == 12
    assert np.ptp(vertices, axis=0) == pytest.approx([100, 80, 50], rel=0.05)
    assert s.volume is None
    s.run("ACCEPT ALL")
    assert len(s.candidates()) == 1


def test_a_program_has_the_unit_of_its_sketches(tmp_path):
    for name, unit in (("a", "FT"), ("b", "MM"), ("c", "FT")):
        (tmp_path / f"{name}.skt").write_text(SLAB.replace("SLAB", name) + f"SET UNITS {unit}\n")

    def load(text):
        path = tmp_path / "site.sdl"
        path.write_text(text)
        return moldloft.load(path)

    m = load('load "a.skt"; load "c.skt";')
    size = 304.8 if pytest.importorskip("OCP") else 0
    path = tmp_path / "site.step"
    m.write(path)
    assert step_solid(path)[0] == pytest.approx(2 * 80 * size**3, rel=1e-8)
    load('Model info(units = "ft"); load "a.skt";')
    for text in (
        'load "a.skt"; load "b.skt";',
        'Model info(units = "m"); load "a.skt";',
        'load "a.skt"; Model info(units = "mm kg");',
        'Sketch s("a.skt", W = 3); load "b.skt";',
    ):
        with pytest.raises(moldloft.ModelError, match=r"is in (ft|mm)"):
            load(text)


BLOCK = """SKETCH B; AXES 345 40 90
POINT 1 0 0; POINT 2 100 -27; POINT 3 177 37; POINT 4 77 64
POINT 5 0 100; POINT 6 100 73; POINT 7 177 137; POINT 8 77 164
POLYLINE 1 2 3 4 CLOSE; POLYLINE 5 6 7 8 CLOSE; LINE 1 5; LINE 2 6; LINE 3 7; LINE 4 8
DIM W X 1 2 10; DIM D Y 2 3 6"""


def test_what_is_missing_as_data():
    sketch = Sketch()
    sketch.run(BLOCK)
    (missing,) = (r for r in sketch.check() if r.about.kind == "missing-dimension")
    assert missing.about.kind == "missing-dimension"
    assert (missing.about.axis, missing.about.points) == ("Z", (5, 6, 7, 8))
    suggested = missing.about.suggestion
    assert (suggested.axis, suggested.p, suggested.guess) == ("Z", 1, False)
    sketch.dimension("Z", suggested.p, suggested.q, suggested.value, name="H")
    assert all(r.about.kind != "missing-dimension" for r in sketch.check())
    assert missing.to_dict()["about"]["suggestion"]["value"] == suggested.value


def test_check_of_another_object_leaves_the_active_one():
    sketch = Sketch()
    sketch.run(BLOCK)
    sketch.run("SKETCH C 2D XZ; POINT 1 0 0; POINT 2 9 0; LINE 1 2")
    assert "Z" in [r.about.axis for r in sketch.check(name="B")]
    assert sketch.active == "C"


def test_chains_and_planes_as_data():
    sketch = Sketch()
    sketch.run(BLOCK + "\nDIM H1 Z 1 5 4")
    chain = sketch.why("X", 4, 7)
    assert (chain.names, chain.value, chain.points[0], chain.points[-1]) == (("W",), 10.0, 4, 7)
    assert sketch.why("X", 1, 4) == dataclasses.replace(
        sketch.why("X", 1, 4), names=(), value=0.0, points=(1, 4)
    )
    planes = sketch.planes()
    assert [(p.axis, p.at) for p in planes] == [
        ("X", 0), ("X", 10), ("Y", 0), ("Y", 6), ("Z", 0), ("Z", 4),
    ]  # fmt: skip
    assert planes[1].points == (2, 3, 6, 7)
    sketch.run("UNSET H1")
    assert sketch.planes()[-1].at is None and sketch.why("Z", 1, 5).value is None


def test_parts_as_values():
    sketch = Sketch()
    sketch.run(BLOCK + "\nDIM H1 Z 1 5 4\nGENERATE FACES")
    block = sketch.parts("b")
    assert (block.name, block.state, block.volume, block.area) == ("B", "solid", 240.0, 248.0)
    assert block.points[7].at == (10.0, 6.0, 4.0) and block.points[7].page == (177.0, 137.0)
    assert block.lines[1].points == (1, 2) and block.lines[1].type == "X"
    assert len(block.faces) == 6 and all(len(f.outer) == 4 for f in block.faces.values())
    assert block.dimensions["W"].value == 10.0 and block.dimensions["W"].measures == "X 1 TO 2"
    with pytest.raises(UnknownNameError):
        sketch.parts("nobody")


def test_dimension_lines_are_parallel_to_their_axis_and_apart():
    sketch = Sketch()
    sketch.run(BLOCK + "\nDIM H1 Z 1 5 4\nGENERATE FACES")
    angles = {"X": 345, "Y": 40, "Z": 90}
    marks = sketch.marks()
    assert [m.text for m in marks] == ["W 10", "D 6", "H1 4"]
    for mark in marks:
        (a, b), (c, d) = mark.line
        along = np.radians(angles[mark.axis])
        # In the direction of the dimension, for a picture that is drawn to within a unit.
        assert abs((c - a) * np.sin(along) - (d - b) * np.cos(along)) < 1e-9
        assert (c - a) * np.cos(along) + (d - b) * np.sin(along) > 70
        assert mark.at == pytest.approx(((a + c) / 2, (b + d) / 2))
        for witness, end in zip(mark.witnesses, mark.line, strict=True):
            ends = np.array(witness)
            way = ends[1] - ends[0]
            off = np.array(end) - ends[0]
            assert abs(way[0] * off[1] - way[1] * off[0]) < 1e-6 * np.hypot(*way)
    # From the front the depth is not seen, and lengths are true.
    front = sketch.marks(view="front")
    assert [m.name for m in front] == ["W", "H1"]
    (a, b), (c, d) = front[0].line
    assert (c - a, d - b) == pytest.approx((10, 0))
    with pytest.raises(UnknownNameError):
        sketch.marks(view="below")


def test_hidden_edges_are_dashed_where_they_are_hidden():
    sketch = Sketch()
    sketch.run(BLOCK + "\nDIM H1 Z 1 5 4\nGENERATE FACES\nVIEW ISO\nSHOW LABELS OFF")
    picture = sketch.run("EXPORT SVG a.svg")[-1].file[1].decode()
    lines = re.findall(r"<line [^>]*>", picture)
    dashed = [line for line in lines if "dasharray" in line]
    assert (len(lines), len(dashed)) == (12, 3)
    assert "paint-order" not in picture
    sketch.run("SHOW DIMENSIONS ON")
    picture = sketch.run("EXPORT SVG a.svg")[-1].file[1].decode()
    assert picture.count("<polygon") == 6 and ">W 10</text>" in picture


def test_a_saved_body_is_loaded_without_a_warning():
    sketch = Sketch()
    sketch.run(
        """SKETCH A 2D XZ
        POINT 1 0 0; POINT 2 90 1; POINT 3 91 30; POINT 4 1 29; POLYLINE 1 2 3 4 CLOSE
        DIM W X 1 2 10; DIM H Z 1 4 5; EXTRUDE 8"""
    )
    file = sketch.run('SAVE A AS "a.skt"')[-1].file
    assert file
    text = file[1].decode()
    assert [r.text for r in Sketch().run(text) if r.severity != "note"] == []
    # One that lacks a face is open at its end.
    lines = [line for line in text.splitlines() if not line.startswith("FACE 6")]
    found = [r for r in Sketch().run("\n".join(lines)) if r.severity == "warning"]
    assert len(found) == 1 and "is open, so it has no volume" in found[0].text
