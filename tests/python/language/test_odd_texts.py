"""Texts at their edges: twelve of them, each before eight commands.

A command reads the text or refuses it by name; nothing that a text holds steers a terminal; files
that are written back keep the ends of their lines.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from moldloft.cli import main

GOOD = (
    "# a patch\nparam float w = 2 in [1, 3];\nAbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0);\n"
    "AbsPoint C(0, 1, 1); AbsPoint D(2, 1, 1);\nLine l(A, B); Line m(C, D);\n"
    "RuledSurf s(l, m);\n"
)

ESCAPES = "\x1b]52;c;eA==\x07\x9b2J"

#: Each text, and whether it is a model.
TEXTS: dict[str, tuple[bytes, bool]] = {
    "empty": (b"", True),
    "blanks": (b" \n\t\n", True),
    "CR alone": (GOOD.replace("\n", "\r").encode(), True),
    "CR LF": (GOOD.replace("\n", "\r\n").encode(), True),
    "no last line end": (GOOD.rstrip("\n").encode(), True),
    "byte order mark": (b"\xef\xbb\xbf" + GOOD.encode(), True),
    "Latin-1": (("# b\xe9ton\n" + GOOD).encode("latin-1"), False),
    "NUL": (GOOD.encode() + b"\0\n", False),
    "escapes in a comment": ((f"# {ESCAPES}\n" + GOOD).encode(), True),
    "escapes in a print": ((GOOD + f'print "{ESCAPES}";\n').encode(), True),
    "escapes in a fault": ((GOOD + f'load "{ESCAPES}";\n').encode(), False),
    "accents and emoji": (("# \u00e9 \U0001f6a4\n" + GOOD).encode(), True),
}

COMMANDS = {
    "build": ["--to", "stl", "-o", "out"],
    "check": [],
    "eval": ["1 + 1"],
    "fmt": [],
    "graph": ["-o", "graph.svg"],
    "hydro": ["--draft", "0.5"],
    "render": ["-o", "picture.png", "--size", "60x40"],
    "run": ["-o", "out"],
}

STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f]")


class Done(NamedTuple):
    returncode: int
    stdout: bytes
    stderr: bytes


@pytest.fixture
def ran(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfdbinary: pytest.CaptureFixture[bytes]
) -> Callable[..., Done]:
    """Runs the command in the empty folder, in this process."""
    monkeypatch.chdir(tmp_path)

    def run(*words: str) -> Done:
        capfdbinary.readouterr()
        status = main(list(words))
        return Done(status, *capfdbinary.readouterr())

    return run


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("name", TEXTS)
def test_odd_texts(ran: Callable[..., Done], tmp_path: Path, name: str, command: str) -> None:
    data, sound = TEXTS[name]
    path = tmp_path / "odd.sdl"
    path.write_bytes(data)
    done = ran(command, "odd.sdl", *COMMANDS[command])
    out, error = done.stdout.decode(), done.stderr.decode()
    assert "Traceback" not in error and "internal" not in error
    assert path.read_bytes() == data
    # A text that does not run may be canonical all the same; without a body there is no flotation.
    if not sound and (command != "fmt" or name in ("Latin-1", "NUL")):
        assert done.returncode == 1 and error
    elif command == "build" and name in ("empty", "blanks"):
        assert done.returncode == 1 and "there are no panels to write" in error
    elif command not in ("hydro", "render"):
        assert done.returncode == 0, error
    # What is written into a pipe is the text itself.
    shown = error if command == "fmt" else out + error
    assert not STEERING.search(shown), shown
    if command == "check" and sound:
        count = 0 if name in ("empty", "blanks") else 7
        assert f"{count} object" in out


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"], ids=["LF", "CR LF", "CR"])
def test_formatting_keeps_the_ends_of_lines(
    ran: Callable[..., Done], tmp_path: Path, end: str
) -> None:
    path = tmp_path / "ends.sdl"
    path.write_bytes(
        ("AbsPoint   A(1,2,3);\n# two\nAbsPoint B( 1 ,2,3);\n").replace("\n", end).encode()
    )
    assert ran("fmt", "-w", "ends.sdl").returncode == 0
    expected = "AbsPoint A(1, 2, 3);\n# two\nAbsPoint B(1, 2, 3);\n".replace("\n", end)
    assert path.read_bytes() == expected.encode()
    assert ran("fmt", "--check", "ends.sdl").returncode == 0


@pytest.mark.skipif(os.name == "nt", reason="names that Windows refuses")
def test_names_that_other_systems_refuse(ran: Callable[..., Done], tmp_path: Path) -> None:
    for name in ("hull 12:30.sdl", "h" * 240 + ".sdl"):
        (tmp_path / name).write_text(GOOD)
        assert ran("check", name).returncode == 0
        done = ran("build", name, "--to", "stl")
        assert done.returncode == 1 and b"--name STEM" in done.stderr, done.stderr
        done = ran("build", name, "--to", "stl", "--name", "hull", "--force")
        assert done.returncode == 0 and (tmp_path / "hull.stl").stat().st_size > 84
    done = ran("build", "hull 12:30.sdl", "--to", "stl", "--name", "../hull")
    assert done.returncode == 1 and b"leads out" in done.stderr


@pytest.mark.skipif(os.name == "nt", reason="names that Windows refuses")
def test_names_of_files_steer_no_terminal(ran: Callable[..., Done], tmp_path: Path) -> None:
    name = f"{ESCAPES}.sdl"
    (tmp_path / name).write_text(GOOD)
    for words in (["check", name], ["check", f"{ESCAPES}*x"], ["build", name, "--to", "stl"]):
        done = ran(*words)
        said = (done.stdout + done.stderr).decode()
        assert said and not STEERING.search(said), said


def test_data_keep_what_messages_show(ran: Callable[..., Done], tmp_path: Path) -> None:
    path = tmp_path / "print.sdl"
    path.write_text(f'print "{ESCAPES}";\n')
    done = ran("run", "print.sdl", "--json")
    assert not STEERING.search(done.stdout.decode())
    data: dict[str, Any] = json.loads(done.stdout)
    assert data["printed"] == [ESCAPES]
