"""What a foreign model or sketch may read and write: a test for each row of SECURITY.md."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from conftest import Run
from moldloft import Sketch
from moldloft.errors import Error, FileError
from moldloft.permissions import RECORD, checked_name, write_outputs

posix = pytest.mark.skipif(os.name == "nt", reason="POSIX files")

ESCAPES = [
    "/abs.txt", "../up.txt", "a/../../up.txt", "a/../b.txt", "..", ".", "", "a/", "//x",
    ".bashrc", ".ssh/authorized_keys", ".git/hooks/pre-commit", "a/.hidden", "./.env",
    "x.py", "X.PY", "a.sh", "evil.pth", "run.desktop", "Makefile", "a/makefile", "package.json",
    "a.txt:stream", "C:\\x.txt", "\\\\host\\share",
    "CON", "con.txt", "aux.skt", "a/NUL", "com1.dat",
    "a.txt.", "a.txt ", " a.txt", "a\nb", "a\x00b", "a\x1b[2J", "a\u202etxt.exe", "x" * 300,
    "1/2/3/4/5/6/7/8/9.txt", "a*b", "a|b", 'a"b', "a?b",
]  # fmt: skip


@pytest.mark.parametrize("name", ESCAPES)
def test_names_that_a_model_may_not_write(tmp_path: Path, name: str) -> None:
    with pytest.raises(FileError, match="cannot write"):
        checked_name(name)
    (tmp_path / "out").mkdir()
    with pytest.raises(FileError):
        write_outputs(tmp_path / "out", {"fine.txt": b"", name: b""})
    assert list(tmp_path.rglob("*.*")) == []


@pytest.mark.parametrize("name", ["a.txt", "grids/wing.p3d", "naca 1.dat", "é.stl", "a..b", "x"])
def test_names_that_a_model_may_write(tmp_path: Path, name: str) -> None:
    assert write_outputs(tmp_path, {name: b"1"}) == [tmp_path / name]
    assert (tmp_path / name).read_bytes() == b"1"


def test_only_what_the_last_run_wrote_is_overwritten(tmp_path: Path) -> None:
    theirs = tmp_path / "a.txt"
    theirs.write_bytes(b"theirs")
    with pytest.raises(FileError, match="was not written by an earlier run; `--force`"):
        write_outputs(tmp_path, {"a.txt": b"1", "b.txt": b"1"})
    assert theirs.read_bytes() == b"theirs" and not (tmp_path / "b.txt").exists()
    # The same bytes hurt nobody.
    write_outputs(tmp_path, {"a.txt": b"theirs"})
    write_outputs(tmp_path, {"a.txt": b"2"})
    theirs.write_bytes(b"edited")
    with pytest.raises(FileError, match="was changed since"):
        write_outputs(tmp_path, {"a.txt": b"3"})
    write_outputs(tmp_path, {"a.txt": b"3"}, force=True)
    write_outputs(tmp_path, {"a.txt": b"4"})
    assert theirs.read_bytes() == b"4"
    assert sorted(p.name for p in tmp_path.iterdir()) == [RECORD, "a.txt"]


@posix
def test_links_do_not_lead_out(tmp_path: Path) -> None:
    out, secret = tmp_path / "out", tmp_path / "secret"
    out.mkdir()
    secret.mkdir()
    (secret / "a.txt").write_bytes(b"old")
    (out / "folder").symlink_to(secret)
    (out / "a.txt").symlink_to(secret / "a.txt")
    (out / "dangling.txt").symlink_to(secret / "new.txt")
    for name in ("folder/a.txt", "a.txt", "dangling.txt", "folder/new.txt"):
        with pytest.raises(FileError, match="a link leads out"):
            write_outputs(out, {name: b"new"}, force=True)
    os.mkfifo(out / "pipe.txt")
    with pytest.raises(FileError, match="not a regular file"):
        write_outputs(out, {"pipe.txt": b"new"}, force=True)
    assert [p.name for p in secret.iterdir()] == ["a.txt"]
    assert (secret / "a.txt").read_bytes() == b"old"


# `moldloft run` and `build`.


WRITER = 'file f = open("{name}", "w"); write(f, 1); close(f);\n'
READER = 'file f = open("{name}", "r"); float x; read(f, x); print x;\n'


@pytest.mark.parametrize("name", [".bashrc", ".git/hooks/pre-commit", "evil.sdl", "../up.txt"])
def test_run_overwrites_no_file_of_the_user(cli: Run, tmp_path: Path, name: str) -> None:
    program = WRITER.format(name=name)
    (tmp_path / "evil.sdl").write_text(program)
    (tmp_path / ".bashrc").write_text("mine")
    done = cli("run", "evil.sdl", status=1)
    assert "cannot write" in done.stderr
    assert (tmp_path / ".bashrc").read_text() == "mine"
    assert (tmp_path / "evil.sdl").read_text() == program
    assert sorted(p.name for p in tmp_path.iterdir()) == [".bashrc", "evil.sdl"]


def test_run_writes_its_own_files_again(cli: Run, tmp_path: Path) -> None:
    (tmp_path / "a.sdl").write_text(WRITER.format(name="out.txt"))
    cli("run", "a.sdl")
    cli("run", "a.sdl")
    (tmp_path / "out.txt").write_text("mine")
    assert "was changed since" in cli("run", "a.sdl", status=1).stderr
    cli("run", "a.sdl", "--force")
    assert (tmp_path / "out.txt").read_text() != "mine"


def test_build_leaves_sources_and_files_of_others(cli: Run, tmp_path: Path) -> None:
    text = "AbsPoint A(0, 0, 0);   AbsPoint B(1, 0, 0); Line l(A, B);\n"
    (tmp_path / "a.sdl").write_text(text)
    assert "it was read for this" in cli("build", "a.sdl", "--to", "sdl", status=1).stderr
    assert (tmp_path / "a.sdl").read_text() == text
    cli("build", "a.sdl", "--to", "ms2")
    cli("build", "a.sdl", "--to", "ms2")
    for command in (["convert", "a.sdl", "--to", "sdl"], ["graph", "a.sdl"]):
        assert "it was read for this" in cli(*command, "-o", "a.sdl", status=1).stderr
    assert (tmp_path / "a.sdl").read_text() == text


# Reading.


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_model_reads_no_hidden_files(cli: Run, tmp_path: Path, command: str) -> None:
    (tmp_path / ".env").write_text("SECRET=1\n")
    (tmp_path / "a.sdl").write_text(READER.format(name=".env"))
    done = cli(command, "a.sdl", status=1)
    assert "SECRET" not in done.stdout + done.stderr
    assert "hidden" in done.stderr


@posix
def test_a_pipe_is_no_model(cli: Run, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "f.sdl")
    assert "not a regular file" in cli("check", "f.sdl", status=1).stderr
    (tmp_path / "a.sdl").write_text('load "f.sdl";\n')
    assert "not a regular file" in cli("check", "a.sdl", status=1).stderr
    os.mkfifo(tmp_path / "f.skt")
    assert "not a regular file" in cli("sketch", "f.skt", status=1).stderr
    os.mkfifo(tmp_path / "f.csv")
    assert "not a regular file" in cli("convert", "f.csv", status=1).stderr
    assert "not a regular file" in cli("fair", "f.csv", "--tol", "1", status=1).stderr


# Sketches.

SLAB = "SKETCH SLAB 2D XZ\nPOINT 1 0 0; POINT 2 90 2; POINT 3 91 30; POINT 4 1 29\n"


@pytest.mark.parametrize("name", ["../up.skt", ".bashrc", "{}/abs.skt", "e.skt"])
def test_a_sketch_file_saves_into_its_output_alone(cli: Run, tmp_path: Path, name: str) -> None:
    inside = tmp_path / "in"
    inside.mkdir()
    name = name.format(tmp_path)
    text = SLAB + f'SAVE SLAB AS "{name}"\n'
    (tmp_path / "e.skt").write_text(text)
    (tmp_path / ".bashrc").write_text("mine")
    for output in ([], ["-o", "in"]):
        if output and name == "e.skt":
            continue
        done = cli("sketch", "e.skt", *output, status=1)
        assert "cannot write" in done.stderr
        assert (tmp_path / ".bashrc").read_text() == "mine"
        assert (tmp_path / "e.skt").read_text() == text
    assert not (tmp_path.parent / "up.skt").exists() and not (tmp_path / "abs.skt").exists()


def test_a_sketch_file_that_is_read_in_has_its_own_rights(cli: Run, tmp_path: Path) -> None:
    (tmp_path / "e.skt").write_text(SLAB + 'SAVE SLAB AS ".bashrc"\n')
    for line in ('INPUT "e.skt"', 'RUN "e.skt"', "POINT 9 1 1; input e.skt"):
        cli("sketch", input=line + "\n", status=1, env={**os.environ, "XDG_STATE_HOME": "state"})
        assert not (tmp_path / ".bashrc").exists()


@posix
def test_a_sketch_file_reads_inside_of_its_folder(cli: Run, tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "secret.skt").write_text("TOPSECRET 1\n")
    (tmp_path / "in" / ".env").write_text("TOPSECRET 1\n")
    (tmp_path / "in" / "link.skt").symlink_to(tmp_path / "secret.skt")
    for name in ("/etc/passwd", "../secret.skt", ".env", "link.skt", str(tmp_path / "secret.skt")):
        (tmp_path / "in" / "e.skt").write_text(f'INPUT "{name}"\n')
        done = cli("sketch", "in/e.skt", status=1)
        assert "TOPSECRET" not in done.stderr + done.stdout
        assert "root:" not in done.stderr + done.stdout
        with pytest.raises(Error) as refused:
            Sketch.load(tmp_path / "in" / "e.skt")
        assert "TOPSECRET" not in str(refused.value)
