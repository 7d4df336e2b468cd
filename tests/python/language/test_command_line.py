"""The command line as people expect one today: pipes, patterns, hints, colours, completion."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import threading

import pytest

from conftest import SAILBOAT
from moldloft.text_table import table

HULL = SAILBOAT / "hull.sdl"
TEXT = HULL.read_text(encoding="utf-8")


def test_a_model_from_standard_input(cli) -> None:
    done = cli("eval", "-", "P21.x", input=TEXT)
    assert done.stdout == "15\n"
    assert "no errors" in cli("check", "-", input=TEXT).stdout
    assert "stdin.sdl:1:" in cli("check", "-", input="AbsPoint P(1);", status=1).stderr
    ms2 = (SAILBOAT / "hull.ms2").read_text(encoding="utf-8")
    assert cli("eval", "-", "P21.x", input=ms2).stdout == "15\n"
    formatted = cli("fmt", "-", input="AbsPoint   P(1,2,3);").stdout
    assert formatted == "AbsPoint P(1, 2, 3);\n"


def test_a_file_to_standard_output(tmp_path) -> None:
    def run(*words: object) -> bytes:
        command = [sys.executable, "-m", "moldloft", *map(str, words)]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert run("render", HULL, "-o", "-", "--size", "64x64").startswith(b"\x89PNG")
    assert run("graph", HULL, "-o", "-").lstrip().startswith(b"<")
    gdf = run("build", HULL, "--to", "gdf", "-o", "-")
    run("build", HULL, "--to", "gdf", "-o", "out")
    assert gdf == (tmp_path / "out" / "hull.gdf").read_bytes()
    assert run("convert", HULL, "--to", "stl", "-o", "-") == run(
        "build", HULL, "--to", "stl", "-o", "-", "-q"
    )
    rows = run("hydro", HULL, "--table", "1,2,3", "--csv", "-").decode()
    assert rows.startswith("draft") or "draft" in rows.splitlines()[0]
    assert not (tmp_path / "-").exists()


def test_standard_output_takes_one_file(cli) -> None:
    assert "one format" in cli("build", HULL, "--to", "stl", "gdf", "-o", "-", status=1).stderr
    several = ["build", HULL, HULL.with_name("yacht.sdl"), "--to", "stl", "-o", "-"]
    assert "one model" in cli(*several, status=1).stderr


def test_several_models_and_patterns(cli, tmp_path) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.sdl").write_text(TEXT)
    (tmp_path / "c.sdl").write_text("AbsPoint P(1);")
    done = cli("check", "*.sdl", status=1)
    assert done.stdout.count("no errors") == 2 and "c.sdl:1" in done.stderr
    assert cli("check", "a.sdl", "b.sdl", "-q").stdout == ""
    rows = json.loads(cli("check", "*.sdl", "--json", status=1).stdout)
    assert [(row["model"], row["ok"]) for row in rows] == [
        ("a.sdl", True),
        ("b.sdl", True),
        ("c.sdl", False),
    ]
    cli("build", "[ab].sdl", "--to", "stl", "-q", "-o", "out")
    names = {p.name for p in (tmp_path / "out").iterdir()}
    assert names == {".moldloft-written", "a.stl", "b.stl"}
    assert "no file matches" in cli("check", "*.ms2", status=1).stderr
    assert cli("fmt", "--check", "[ab].sdl").stdout == ""


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (["bulid", HULL], "did you mean `build`?"),
        (["build", HULL, "--wach"], "did you mean `--watch`?"),
        (["build", HULL, "--imm"], "unknown option `--imm`"),
        (["build", HULL, "--to", "gdff"], "did you mean `gdf`?"),
        (["build", HULL, "--to", "ply", "nemho"], "did you mean `nemoh`?"),
        (["hydro", HULL, "--sides", "bot"], "did you mean `both`?"),
        (["convert", HULL, "--to", "step2"], "did you mean `step`?"),
        (["check", HULL, "--qality"], "did you mean `--quality`?"),
        (["--quiet"], "no command was given"),
        (["xyzzy"], "unknown command `xyzzy`"),
    ],
)
def test_a_wrong_word_is_a_line_with_the_right_one(cli, words, reported) -> None:
    done = cli(*words, status=2)
    assert reported in done.stderr and done.stdout == ""
    assert done.stderr.startswith("error: ") and done.stderr.count("\n") <= 3


def test_alone_it_greets_with_the_help(cli) -> None:
    done = cli()
    assert done.stdout == cli("--help").stdout == cli("--color", "never").stdout
    assert "moldloft new hull.sdl" in done.stdout and "build" in done.stdout


def test_tables_fit_narrow_terminals() -> None:
    header, rows = ["name", "what"], [["hull", "a surface from three curves and a line"]]
    assert table(header, rows, left=2, width=30).splitlines() == [
        "name  what",
        "hull  a surface from three",
        "      curves and a line",
    ]
    assert table(header, rows, left=2, width=24).splitlines() == [
        "name",
        "    what",
        "hull",
        "    a surface from three",
        "    curves and a line",
    ]
    assert table(["z", "area", "volume"], [["1", "2.5", "3.75"]], width=12).splitlines() == [
        "z  area",
        "1   2.5",
        "",
        "z  volume",
        "1    3.75",
    ]


def test_help_at_the_prompt(cli) -> None:
    done = cli("repl", input="help\nAbsPoint help(1, 2, 3);\nhelp.y\n")
    assert ":save" in done.stdout and done.stdout.splitlines()[-1] == "2"


def test_no_abbreviations(cli) -> None:
    cli("build", HULL, "--quie", status=2)
    cli("hydro", HULL, "--dens", "1", status=2)


def test_negative_numbers_are_values(cli) -> None:
    for words in (
        ["--cg", "-1,0,2", "--displacement", "100", "--density", "1", "--fixed", "both"],
        ["--level", "-0.2"],
        ["--table", "-0.5,1,4", "--sections", "0,30,4"],
        ["--displacement", "100", "--cg", "15,0,0", "--density", "1", "--gz", "-10,10,3"],
    ):
        cli("hydro", HULL, *words, "--json")
    assert cli("eval", HULL, "-P21.x", "-2 + 1").stdout == "-15\n-1\n"
    assert cli("eval", HULL, "--set", "P34.z=-0.5", "P34.z").stdout == "-0.5\n"


def test_colours_are_asked_for_or_on_terminals(cli, model_file) -> None:
    path = model_file("AbsPoint P(1);")
    plain = cli("check", path, status=1).stderr
    assert "\x1b[" not in plain
    painted = cli("check", path, "--color", "always", status=1).stderr
    assert "\x1b[31;1merror[" in painted
    import re

    assert re.sub(r"\x1b\[[\d;]*m", "", painted) == plain
    assert "\x1b[" not in cli("check", path, "--color", "never", status=1).stderr


def test_formats_that_cannot_be_written(cli, tmp_path, model_file) -> None:
    """All refusals at once; with --keep-going the others are written."""
    path = model_file(
        "set ball = set(sphere({0, 0, 0}, 1));SetBody b(ball, {-2, -2, -2}, {2, 2, 2}, depth = 4);",
        "ball.sdl",
    )
    words = ["build", path, "--to", "stl", "vts", "blockmesh", "-o", "out"]
    done = cli(*words, status=1)
    assert "vts:" in done.stderr and "blockmesh:" in done.stderr and "--keep-going" in done.stderr
    assert not (tmp_path / "out").exists()
    done = cli(*words, "--keep-going", status=1)
    assert (tmp_path / "out" / "ball.stl").exists() and "vts:" in done.stderr
    data = json.loads(cli(*words, "--keep-going", "--json", status=1).stdout)
    assert data["ok"] is False and set(data["refused"]) == {"vts", "blockmesh"}


def test_quiet(cli) -> None:
    done = cli("build", HULL, "--to", "stl", "-q")
    assert done.stdout == ""
    assert cli("render", HULL, "--size", "64x64", "-q").stdout == ""


def test_help_has_groups_and_examples(cli) -> None:
    from moldloft.cli import COMMANDS, EXAMPLES, GROUPS

    text = cli("--help").stdout
    assert all(f"{group}:" in text for group in GROUPS)
    assert all(f"  {name}" in text for name in COMMANDS)
    for name in ("build", "hydro"):
        assert "Examples:" in cli(name, "--help").stdout
    assert set(EXAMPLES) == set(COMMANDS) - {"formats", "lsp", "fair"}


def test_doc_searches(cli) -> None:
    for word, wanted in (
        ("loft", "CLoftSurf"),
        ("snake", "GeoSnake"),
        ("revolution", "RevSurf"),
        ("aerofoil", "FoilCurve"),
        ("geodesic", "GeoSnake"),
        ("rolling", "RollFillet"),
    ):
        rows = {row["name"] for row in json.loads(_doc(cli, word))}
        assert wanted in rows, (word, rows)
    assert "unknown" in cli("doc", "xyzzyplugh", status=1).stderr


def _doc(cli, word: str) -> str:
    text = cli("doc", word, "--json").stdout
    return text if text.lstrip().startswith("[") else f"[{text}]"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish", "powershell"])
def test_completion_scripts(cli, shell, tmp_path) -> None:
    script = cli("completion", shell).stdout
    for word in ("build", "--keep-going", "gdf", "completion"):
        assert word.lstrip("-") in script
    if shell in ("bash", "zsh", "fish") and shutil.which(shell):
        path = tmp_path / "script"
        path.write_text(script)
        subprocess.run([shell, "-n", str(path)], check=True)


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
def test_bash_completes(cli, tmp_path) -> None:
    path = tmp_path / "script"
    path.write_text(cli("completion", "bash").stdout)

    def complete(*words: str) -> set[str]:
        line = " ".join(f"'{word}'" for word in words)
        text = (
            f"source {path}; COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; "
            '_moldloft; printf "%s\\n" "${COMPREPLY[@]}"'
        )
        done = subprocess.run(["bash", "-c", text], capture_output=True, text=True, check=True)
        return set(done.stdout.split())

    assert complete("moldloft", "ch") == {"check"}
    assert "--keep-going" in complete("moldloft", "build", "--k")
    assert complete("moldloft", "build", "h.sdl", "--to", "stl", "nem") == {"nemoh"}
    assert complete("moldloft", "hydro", "--sides", "b") == {"both"}
    assert complete("moldloft", "completion", "f") == {"fish"}


def test_the_command_starts_quickly() -> None:
    """At most 0.15 s of processor time, help included; a busy machine adds to the clock only."""
    import resource

    for words in (["--version"], ["--help"]):
        best = 9.0
        for _ in range(3):
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            command = [sys.executable, "-m", "moldloft", *words]
            subprocess.run(command, check=True, capture_output=True)
            best = min(best, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)
        assert best < 0.15, (words, best)


def test_a_prompt_completes_and_remembers(tmp_path) -> None:
    """Keys as a person types them: a word, Tab, Enter; then a line from the history."""
    pytest.importorskip("prompt_toolkit")
    from prompt_toolkit.application import create_app_session
    from prompt_toolkit.input import create_pipe_input
    from prompt_toolkit.output import DummyOutput

    from moldloft.cli.editor import line_editor

    def complete(line: str) -> list[str]:
        return [word for word in ("hull.area", "hull.volume") if word.startswith(line)]

    with create_pipe_input() as keys, create_app_session(input=keys, output=DummyOutput()):
        editor = line_editor(tmp_path / "history", complete, delimiters=" ")
        with editor as ask:
            keys.send_text("hull.a\t")
            # Completion runs beside the prompt: Enter comes later, as a finger does.
            threading.Timer(0.5, keys.send_text, ["\r"]).start()
            assert ask("> ") == "hull.area"
            keys.send_text("\x1b[A\r")
            assert ask("> ") == "hull.area"
            keys.send_text("\x04")
            with pytest.raises(EOFError):
                ask("> ")
    assert "hull.area" in (tmp_path / "history.lines").read_text()


def test_options_of_all_commands_may_stand_before_the_command(tmp_path, cli) -> None:
    (tmp_path / "bad.sdl").write_text("AbsPoint P(1, 2);\n")
    for words in (["--color", "always"], ["--color=always", "--limit", "steps=1e6"]):
        assert "\x1b[31;1merror[" in cli(*words, "check", "bad.sdl", status=1).stderr
    assert "unknown command `chekc`" in cli("--color", "never", "chekc", status=2).stderr
    assert "unknown command" not in cli("--color", status=2).stderr


def test_values_are_set_where_those_of_the_text_are_errors(cli, tmp_path) -> None:
    path = tmp_path / "m.sdl"
    path.write_text("param float n = 0 in [0, 10]; float y = 1/n; print y;")
    done = cli("run", path, "--set", "n=4")
    assert (done.stdout.strip(), done.stderr) == ("0.25", "")
    assert "not-finite" in cli("run", path, status=1).stderr
    path.write_text("param float n = 0;\nfloat y = = ;")
    assert "unexpected `=`" in cli("run", path, "--set", "n=4", status=1).stderr
