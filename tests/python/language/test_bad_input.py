"""What a person may do wrong: always a diagnostic with a way out, never a traceback."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest

import moldloft
from conftest import SAILBOAT
from moldloft.fairing.files import read_points

HULL = SAILBOAT / "hull.sdl"
POINTS = "AbsPoint A(0, 0, 0);\nAbsPoint B(1, 0, 0);\nAbsPoint C(1, 1, 0);\nAbsPoint D(0, 1, 0);\n"

CASES = {
    # name: (text, line of the fault, words that must be said)
    "unknown kind": (POINTS + "Lien ab(A, B);", 5, ["Lien", "Line"]),
    "unknown object": (POINTS + "Line ab(A, Bb);", 5, ["Bb", "`B`"]),
    "unknown argument": (POINTS + "BCurve c({A, B}, degre = 1);", 5, ["degre", "degree"]),
    "missing argument": (POINTS + "Line ab(A);", 5, ["Line"]),
    "too many arguments": ("AbsPoint P(1, 2, 3, 4);", 1, ["AbsPoint"]),
    "wrong class": (
        POINTS + "Line ab(A, B);\nLine dc(D, C);\nRuledSurf s(ab, dc);\nRuledSurf t(ab, s);",
        8,
        ["a curve", "a surface"],
    ),
    "duplicate name": ("AbsPoint A(0, 0, 0);\nAbsPoint A(1, 0, 0);", 2, ["`A`"]),
    "not a number": ("AbsPoint P(0 / 0, 0, 0);", 1, []),
    "infinity": ("AbsPoint P(1e308 * 10, 0, 0);", 1, []),
    "degree 0": (POINTS + "BCurve c({A, B}, degree = 0);", 5, ["`degree` = 0", "from 1"]),
    "coincident points": (POINTS + "CCurve c({A, B, B, C});", 5, ["`c`"]),
    "too many divisions": (POINTS + "Line ab(A, B, divisions = 1000000000);", 5, ["divisions"]),
    "endless loop": ("float x = 0;\nwhile (1 > 0) { x = x + 1; }", 2, ["steps"]),
    "endless recursion": (
        "subroutine down(float n) { down(n + 1); }\ndown(0);",
        1,
        [],
    ),
    "use before declaration": ("Line ab(A, B);\n" + POINTS, 1, ["`A`"]),
    "unfinished text": (POINTS + "BCurve c({A, B", 5, ["expected"]),
    "local hides its argument": (
        "subroutine f(float x) {\n  float y = x;\n  if (y > 0) {\n    float x = 1;\n  }\n}",
        4,
        ["`x` is an argument already", "the argument", "assign to the argument"],
    ),
    "parameter out of range": ("param float b = 9 in [1, 3];", 1, ["range"]),
}


@pytest.mark.parametrize("name", CASES)
def test_programs(cli, model_file, name):
    text, line, words = CASES[name]
    path = model_file(text)
    done = cli("check", path, "--json", status=1)
    errors = [d for d in json.loads(done.stdout)["diagnostics"] if d["severity"] == "error"]
    assert errors
    first = errors[0]
    assert first["primary"]["line"] == line, done.stdout
    for word in words:
        assert word in first["rendered"], first["rendered"]
    # The same for a person, with the line shown.
    shown = cli("check", path, status=1).stderr
    assert first["rendered"].strip() in shown
    assert f"model.sdl:{line}:" in shown
    # No command gets further.
    assert cli("build", path, "--to", "gdf", status=1).stdout.endswith("nothing was written\n")
    assert not list(path.parent.glob("*.gdf"))


HEAD = "MultiSurf 0.35\n"

MODEL_FILES = {
    "truncated": (HEAD + "AbsPoint A 14 1 0 0", 2, []),
    "unknown object": (
        HEAD + "AbsPoint A 14 1 0 0 0;\nLine l 11 1 10 * A B;\nEndModel\n",
        3,
        ["B"],
    ),
    "duplicate name": (
        HEAD + "AbsPoint A 14 1 0 0 0;\nAbsPoint A 14 1 0 0 1;\nEndModel\n",
        3,
        ["`A`"],
    ),
    "not a number": (HEAD + "AbsPoint A 14 1 0 nan 0;\nEndModel\n", 2, []),
    "cycle": (
        HEAD
        + "RelPoint A 14 1 B 0 0 0;\nRelPoint B 14 1 C 0 0 0;\n"
        + "RelPoint C 14 1 A 0 0 0;\nEndModel\n",
        None,
        ["A", "B", "C"],
    ),
}


@pytest.mark.parametrize("name", MODEL_FILES)
def test_model_files(cli, model_file, name):
    text, line, words = MODEL_FILES[name]
    path = model_file(text, "model.ms2")
    done = cli("check", path, "--json", status=1)
    errors = [d for d in json.loads(done.stdout)["diagnostics"] if d["severity"] == "error"]
    assert errors
    if line is not None:
        assert errors[0]["primary"]["line"] == line, done.stdout
    for word in words:
        assert word in errors[0]["rendered"], errors[0]["rendered"]


def test_an_unknown_entity_is_kept_and_reported(cli, model_file):
    line = "BCurv MC1 11 1 10 * 2 { A A };"
    path = model_file(f"{HEAD}AbsPoint A 14 1 0 0 0;\n{line}\nEndModel\n", "model.ms2")
    done = cli("convert", path, "--to", "ms2")
    assert line in done.stdout
    assert "`BCurv`" in done.stderr and "`BCurve`" in done.stderr


def test_a_failed_object_blocks_its_children_only(cli, model_file):
    path = model_file(POINTS + "CCurve bad({A, A});\nLine good(A, B);\nSubCurve child(bad, 0, 1);")
    data = json.loads(cli("build", path, "--json", status=1).stdout)
    ok = {o["name"]: o["ok"] for o in data["objects"]}
    assert ok["good"] and not ok["bad"] and not ok.get("child", False)
    assert data["ok"] is False and data["files"] == []


@pytest.mark.parametrize("command", ["build", "check", "eval", "convert", "graph", "render"])
@pytest.mark.parametrize("kind", ["missing", "folder", "binary", "empty name"])
def test_files_that_cannot_be_read(cli, tmp_path, command, kind):
    path: str | Path = tmp_path / "model.sdl"
    if kind == "folder":
        Path(path).mkdir()
    elif kind == "binary":
        Path(path).write_bytes(b"\x7fELF\0\1\2\xff\xfe")
    elif kind == "empty name":
        path = ""
    more = ["1 + 1"] if command == "eval" else []
    done = cli(command, path, *more, status=1)
    assert "error" in done.stderr
    assert not list(tmp_path.glob("*.png")) or command == "render"


def test_a_name_nearly_right(cli, model_file):
    model_file(POINTS, "boat.sdl")
    assert "`boat.sdl`" in cli("check", "baot.sdl", status=1).stderr


def test_wrong_encoding(cli, model_file):
    path = model_file("# é\nAbsPoint P(1, 2, 3);".encode("latin-1"))
    assert "UTF-8" in cli("check", path, status=1).stderr


def test_wrong_values_of_set(cli):
    assert "`beam`" in cli("build", HULL, "--set", "baem=5", status=1).stderr
    assert "7 to 14" in cli("build", HULL, "--set", "beam=99", status=1).stderr
    done = cli("build", HULL, "--set", "P21.y=4", status=1)
    assert "beam" in done.stderr


def test_wrong_expressions(cli):
    assert "`hull`" in cli("eval", HULL, "hul(.5, .5)", status=1).stderr
    for expression in ("hull(", "1 +", "P21.w", "hull(0.5)", "length()", ""):
        done = cli("eval", HULL, expression, status=1)
        assert "error" in done.stderr and done.stdout == ""


def test_loads_stay_inside_the_model_s_folder(cli, tmp_path):
    (tmp_path / "inside").mkdir()
    (tmp_path / "secret.sdl").write_text("AbsPoint secret(1, 2, 3);")
    model = tmp_path / "inside" / "model.sdl"
    for name in ("../secret.sdl", str(tmp_path / "secret.sdl")):
        model.write_text(f'load "{name}";\n')
        done = cli("check", model, status=1)
        assert "outside" in done.stderr
    if os.name != "nt":
        (tmp_path / "inside" / "link.sdl").symlink_to(tmp_path / "secret.sdl")
        model.write_text('load "link.sdl";\n')
        assert "outside" in cli("check", model, status=1).stderr
    # The library path opens a folder.
    model.write_text('load "secret.sdl";\n')
    assert "no such file" in cli("check", model, status=1).stderr
    assert cli("eval", model, "secret.y", "--library", tmp_path).stdout == "2\n"


def test_a_file_is_loaded_from_beside_the_model(cli, tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "a.sdl").write_text('load "b.sdl";\n')
    (tmp_path / "parts" / "b.sdl").write_text("AbsPoint deep(1, 2, 3);")
    (tmp_path / "model.sdl").write_text('load "parts/a.sdl";\n')
    assert cli("eval", "model.sdl", "deep.z").stdout == "3\n"


def test_an_output_folder_that_cannot_be(cli, tmp_path):
    (tmp_path / "file").write_text("not a folder")
    done = cli("build", HULL, "--to", "gdf", "-o", "file/below", status=1)
    assert "file/below`: not a directory" in done.stderr
    done = cli("build", HULL, "--to", "gdf", "-o", "file", status=1)
    assert "cannot" in done.stderr
    assert (tmp_path / "file").read_text() == "not a folder"


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_without_permission(cli, tmp_path):
    folder = tmp_path / "locked"
    folder.mkdir(mode=0o500)
    assert "permission denied" in cli("build", HULL, "--to", "gdf", "-o", folder, status=1).stderr


@pytest.mark.skipif(sys.platform != "linux", reason="limits of a process")
def test_a_disk_that_fills_up(cli, tmp_path):
    import resource

    def small_files() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (30_000, 30_000))

    # The STL fits, the GDF does not: neither is left.
    done = cli("build", HULL, "--to", "stl", "gdf", "-o", "out", status=1, preexec_fn=small_files)
    assert "cannot write" in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform != "linux", reason="the system keeps names in UTF-8")
def test_names_of_files_in_other_encodings(tmp_path, cli):
    folder = tmp_path / os.fsdecode(b"entw\xfcrfe")
    folder.mkdir()
    for name, text in (("hull.sdl", POINTS), (os.fsdecode(b"mod\xe8le.sdl"), POINTS)):
        place = folder if name == "hull.sdl" else tmp_path
        path = place / name
        path.write_text(text)
        for read in (moldloft.load, moldloft.Sketch.load):
            with pytest.raises(moldloft.FileError, match="its name is not UTF-8") as refused:
                read(path)
            assert "\\x" in str(refused.value)
        for command in ("check", "build", "eval", "view", "sketch"):
            more = ["1"] if command == "eval" else []
            assert "not UTF-8" in cli(command, path, *more, status=1).stderr, command
    # What reads points takes any name.
    table = tmp_path / os.fsdecode(b"punkte-\xe4.csv")
    table.write_text("0,0,0\n1,0.1,0\n2,0,0\n3,0.1,0\n4,0,0\n")
    assert len(read_points(table).points) == 5
