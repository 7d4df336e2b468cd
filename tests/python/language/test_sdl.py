"""The array language from outside: run, eval, repl, the language server, files, derivatives."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import moldloft
import moldloft.grids
from moldloft.cli import main
from moldloft.cli.repl import Session
from moldloft.errors import Error, ModelError

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "missile"


def command(*arguments: str, text: str = "") -> subprocess.CompletedProcess[str]:
    """Runs the command in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "moldloft", *arguments],
        input=text,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


def test_run_prints_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program = tmp_path / "p.sdl"
    program.write_text(
        'curve c[2] = {1, 2, 3}; print "hello", c.d1;\n'
        'file f = open("sub/points.txt", "w"); write(f, c); close(f);\n'
    )
    out = tmp_path / "out"
    assert main(["run", str(program), "-o", str(out)]) == 0
    reported = capsys.readouterr().out
    assert reported.startswith("hello 2\nwrote ")
    assert (out / "sub" / "points.txt").read_text() == "1 2 3\n1 2 3\n"
    assert main(["run", str(program), "-o", str(out), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["ok"] and data["printed"] == ["hello 2"] and data["files"][0]["bytes"] == 12


def test_run_with_errors_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program = tmp_path / "p.sdl"
    program.write_text('file f = open("a.txt", "w"); write(f, 1); close(f); print nothing;')
    assert main(["run", str(program), "-o", str(tmp_path / "out")]) == 1
    captured = capsys.readouterr()
    assert "unknown-name" in captured.err and "nothing was written" in captured.out
    assert not (tmp_path / "out").exists()


def test_run_does_not_follow_links_out_of_the_folder(tmp_path: Path) -> None:
    program = tmp_path / "p.sdl"
    program.write_text('file f = open("link/a.txt", "w"); write(f, 1); close(f);')
    out, elsewhere = tmp_path / "out", tmp_path / "elsewhere"
    out.mkdir()
    elsewhere.mkdir()
    (out / "link").symlink_to(elsewhere)
    assert main(["run", str(program), "-o", str(out)]) == 1
    assert list(elsewhere.iterdir()) == []


def test_run_writes_grids(tmp_path: Path) -> None:
    program = tmp_path / "p.sdl"
    program.write_text(
        "surface s[3, 2], t[2, 2] = {0, 0, 9}; farray x = uniform(0, 2, 3);"
        "for (j = 1:2) s[, j] = {x, j + 0*x, 0*x};"
    )
    out = tmp_path / "out"
    assert main(["run", str(program), "-o", str(out), "--to", "p3d", "vts", "stl"]) == 0
    blocks = moldloft.grids.read_plot3d(out / "p.p3d")[0]
    model = moldloft.load(program)
    assert [b.shape[:2] for b in blocks] == [(3, 2), (2, 2)]
    np.testing.assert_array_equal(blocks[0].reshape(3, 2, 3), model["s"])
    assert (out / "p.stl").stat().st_size > 84
    program.write_text("float x = 1;")
    assert main(["run", str(program), "-o", str(out), "--to", "p3d"]) == 1


def test_eval_of_arrays(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program = tmp_path / "p.sdl"
    program.write_text(
        "surface body[60,20] = {1, 2, 3}; vector a = {1, 0, 0}, b = {0, 2, 0}; curve c[3] = a;"
    )
    arguments = ["body[60,1]", "|a .* b|", "c[2:].x", "body[ ,1].d1"]
    assert main(["eval", str(program), *arguments]) == 0
    assert capsys.readouterr().out.split("\n") == ["{1, 2, 3}", "2", "{1, 1}", "60", ""]


def test_arrays_in_python() -> None:
    model = moldloft.loads(
        "param float r = 2; curve c[3]; farray t = uniform(0, 1, 3);"
        "c = {r*t, r^2 + 0*t, 0*t};"
        "surface s[2, 3]; s[1,] = c; s[2,] = 2*c;"
    )
    assert model["s"].shape == (2, 3, 3)
    np.testing.assert_array_equal(model["c"], [[0, 4, 0], [1, 4, 0], [2, 4, 0]])
    assert model.derivative("c[3]", "r").tolist() == [1, 4, 0]
    assert set(model.variables) == {"c", "s", "t"}


@pytest.mark.parametrize("name", ["half", "finned"])
def test_examples_run(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program = str(EXAMPLES / f"{name}.sdl")
    assert main(["run", program, "-o", str(tmp_path)]) == 0
    assert "body" in capsys.readouterr().out
    coarse = moldloft.load(program)
    points = np.loadtxt(tmp_path / f"{name}.txt")
    body = coarse["body"]
    np.testing.assert_array_equal(
        points[: body.shape[0] * body.shape[1]], body.transpose(1, 0, 2).reshape(-1, 3)
    )
    # Grids of a family are nested.
    plane = "upper" if name == "half" else "top"
    for times in (1, 2):
        assert main(["eval", program, "--refine", str(times), "--json", "body", plane]) == 0
        for found, grid in zip(json.loads(capsys.readouterr().out), ["body", plane], strict=True):
            fine = np.array(found)[:: 2**times, :: 2**times]
            assert np.abs(fine - coarse[grid]).max() < 1e-12


def test_repl() -> None:
    session = Session()
    assert session.run('load "stdsubs.sdl"') == []
    assert session.run("curve c[3]") == []
    assert session.run("arc(c, 0, PI_d2, 2)") == []
    assert session.run("c[1]") == ["{2, 0, 0}"]
    assert session.run("|c[3] - c[1]|")[0].startswith("2.828")
    assert session.run("uniform(0, 1, 100)")[0].endswith("farray[100]")
    assert session.run("for (i = 1:2) print i;") == ["1", "2"]
    assert session.run("print 3") == ["3"]
    with pytest.raises(ModelError, match="shapes differ"):
        session.run("c = uniform(0, 1, 4)*{1, 0, 0}")
    with pytest.raises(Error, match="unknown name"):
        session.run("nothing + 1")
    assert session.variables() == ["c: curve[3]", "i: number"]
    # A line with errors is left out; one can be taken back.
    assert session.run("c[1].x") == ["2"]
    assert session.run("c[1].x = 7") == []
    assert session.run("c[1].x") == ["7"]
    assert session.undo() and session.run("c[1].x") == ["2"]
    found = session.model._document.complete("transf")
    assert found == ["transfinite"]
    assert session.model._document.complete("c[1].") == ["x", "y", "z"]


def test_repl_reads_a_stream() -> None:
    text = (
        "float x = 2\nx + 1\nsubroutine f(returned float y) {\n  y = 3;\n}\nf(x)\nx\n:vars\n:quit\n"
    )
    done = command("repl", text=text)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split("\n") == ["3", "3", "x: number", ""]
    failed = command("repl", text="y\n")
    assert failed.returncode == 1 and "unknown-name" in failed.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals")
def test_repl_goes_on_after_an_interrupt() -> None:
    import os
    import pty
    import select
    import time

    pid, terminal = pty.fork()
    if pid == 0:
        os.execv(sys.executable, [sys.executable, "-m", "moldloft", "repl"])

    def until(wanted: bytes, seconds: float = 100) -> bytes:
        seen, end = b"", time.monotonic() + seconds
        while wanted not in seen and time.monotonic() < end:
            if select.select([terminal], [], [], 0.2)[0]:
                seen += os.read(terminal, 4096)
        return seen

    try:
        # The prompt's blank is a motion of the cursor.
        until(b">")
        os.write(terminal, b"float x = 2;\r")
        until(b"> ")
        # One call that lasts: a loop would come to the limit of steps.
        os.write(
            terminal,
            b"surface s[300,300]; for (i = 1:300) for (j = 1:300) s[i,j] = {i, j, 0}; "
            b"s[2:299,2:299].x += 0.2; s = elliptic(s, 1000000, 0);\r",
        )
        until(b"}")
        # One that comes before the line runs is a key of the prompt.
        for patience in (2, 10, 30, 100):
            time.sleep(1)
            os.write(terminal, b"\x03")
            if b"the entry is discarded" in until(b"discarded", patience):
                break
        else:
            pytest.fail("it was not interrupted")
        os.write(terminal, b"20*x + 2\r")
        assert b"42" in until(b"42")
        os.write(terminal, b"exit\r")
    finally:
        os.close(terminal)
        os.waitpid(pid, 0)


@pytest.mark.parametrize(("result", "found"), [(None, "None"), ("text", "str 'text'")])
def test_python_functions_tell_what_they_returned(result: object, found: str) -> None:
    with pytest.raises(ModelError, match=f"the function returned {found}; expected a number"):
        moldloft.loads("float x = f(2);", functions={"f": lambda _: result})


def test_repl_ends() -> None:
    for word in ("exit", "quit", "exit();", ":q", ":quit"):
        done = command("repl", text=f"1 + 1\n{word}\n2 + 2\n")
        assert (done.returncode, done.stdout) == (0, "2\n"), word
    # A variable of that name is a variable.
    assert command("repl", text="float quit = 3\nquit\nexit\n").stdout == "3\n"


def test_python_functions_with_arrays() -> None:
    def raised(c: np.ndarray, by: float) -> np.ndarray:
        return c + np.array([0, 0, 1.0]) * by

    def radii(c: np.ndarray) -> np.ndarray:
        return np.sqrt(c[..., 1] ** 2 + c[..., 2] ** 2)

    def sheet(c: np.ndarray, n: float) -> np.ndarray:
        return np.stack([c * (1 + k) for k in range(int(n))], axis=1)

    text = """load "stdsubs.sdl"
    param float h = 2;
    curve c[5]; arc(c, 0, PI, 3);
    curve up = raised(c, h);
    farray r = radii(up);
    surface s = sheet(up, 4);
    transfinite(s);
    for (k = 1:3) up = raised(up, h/2) + {0, 0, 1};
    """
    functions = {"raised": raised, "radii": radii, "sheet": sheet}
    m = moldloft.loads(text, functions=functions)
    assert m["up"].shape == (5, 3) and m["s"].shape == (5, 4, 3)
    assert np.abs(m["r"] - np.hypot(m["c"][:, 1], 2)).max() < 1e-15
    assert np.abs(m["up"][:, 2] - 8).max() < 1e-14
    # Derivatives run through them: dz/dh = 1 + 3/2.
    assert abs(m.derivative("up[2].z", "h") - 2.5) < 1e-12
    with pytest.raises(ModelError, match=r"function-failed.*axes don't match|raised"):
        moldloft.loads(text + "float x = radii(3);", functions=functions)
    with pytest.raises(ModelError, match=r"wrong-result|returned an array"):
        moldloft.loads("float x = odd();", functions={"odd": lambda: np.zeros((2, 2, 2, 2))})


def test_files_outside_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "secret.txt").write_text("1 2 3")
    folder = tmp_path / "model"
    folder.mkdir()
    program = folder / "p.sdl"
    program.write_text('file f = open("../secret.txt", "r");')
    assert main(["run", str(program), "-o", str(tmp_path / "out")]) == 1
    assert "outside the model's folders" in capsys.readouterr().err
    for path in ["/tmp/x.txt", "../x.txt"]:
        program.write_text(f'file f = open("{path}", "w");')
        assert main(["run", str(program), "-o", str(tmp_path / "out")]) == 1
        assert "outside-folder" in capsys.readouterr().err


def test_wrong_use(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["run"]) == 2
    assert main(["run", str(tmp_path / "none.sdl")]) == 1
    program = tmp_path / "p.sdl"
    program.write_text("float x = refined(3);")
    assert main(["run", str(program), "--refine", "99"]) == 1
    assert main(["run", str(program), "--refine", "-1"]) == 1
    capsys.readouterr()
