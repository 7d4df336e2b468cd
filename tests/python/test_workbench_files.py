"""Files that come out of the page and go into it: every format, remarks, CAD."""

from __future__ import annotations

import base64
from pathlib import Path

import pytest

import moldloft
from conftest import SAILBOAT, Run
from moldloft.formats import formats
from moldloft.workbench.conversion import Converter
from moldloft.workbench.frames import head_of

HULL = (SAILBOAT / "hull.sdl").read_text(encoding="utf-8")
SOLID = (
    "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(2, 1, 0); AbsPoint D(0, 1, 0);\n"
    "Line a(A, B); Line b(D, C); RuledSurf low(a, b, divisions = {2, 2});\n"
    "AbsPoint E(0, 0, 1); AbsPoint F(2, 0, 1); AbsPoint G(2, 1, 1); AbsPoint H(0, 1, 1);\n"
    "Line c(E, F); Line d(H, G); RuledSurf top(c, d, divisions = {2, 2});\n"
    "RuledSolid s(low, top);\n"
)


def files_of(frame: bytes) -> dict[str, bytes]:
    """The files of a frame by name, as the page reads them."""
    length = int.from_bytes(frame[8:12], "little")
    start = -(-(16 + length) // 8) * 8
    parts = head_of(frame)["files"]
    return {p["name"]: frame[start + p["offset"] :][: p["count"]] for p in parts}


@pytest.mark.parametrize("text", [HULL, SOLID], ids=["hull", "solid"])
def test_every_format_is_that_of_the_command(text: str, cli: Run, tmp_path: Path) -> None:
    (tmp_path / "hull.sdl").write_text(text, encoding="utf-8")
    converter = Converter("hull.sdl", [str(tmp_path)])
    converter.sync(text)
    made = 0
    wanted = [f for f in formats() if text == HULL or formats()[f].volume]
    cli("build", "hull.sdl", "--keep-going", "--to", *wanted, "-o", "out", "-q", status=1)
    for format in wanted:
        frame = converter.answer({"kind": "export", "id": 7, "format": format, "stem": "hull"})
        head = head_of(frame)
        assert head["id"] == 7
        for name, data in files_of(frame).items():
            written = (tmp_path / "out" / name).read_bytes()
            # rhino3dm gives its objects random names.
            assert written == data or (format == "3dm" and len(written) == len(data)), name
            made += 1
        if "error" in head:
            assert not (tmp_path / "out" / formats()[format].file_name("hull")).exists(), head
    assert made >= (20 if text == HULL else 5)


def test_values_that_hold_are_in_the_file() -> None:
    converter = Converter("a.sdl", [])
    converter.sync("param float b = 2;\nparam float h = 2 * b;\nAbsPoint P(0, 0, h);\n")
    ask = {"kind": "export", "format": "ms2", "stem": "../a b", "values": {"h": 7.5}}
    [(name, data)] = files_of(converter.answer(ask)).items()
    assert name == "___a_b.ms2" and b"7.5" in data
    assert head_of(converter.answer({**ask, "values": {"nobody": 1}}))["error"]
    assert "unknown" in head_of(converter.answer({**ask, "format": "nothing"}))["error"]
    assert "request" in head_of(converter.answer({"kind": "export"}))["error"]


def test_a_cad_file_is_a_program_with_panels(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    path = tmp_path / "part.step"
    whole = moldloft.loads(HULL)
    whole.write(path)
    ask = {"kind": "import", "name": "part.step", "units": "ft"}
    data = base64.b64encode(path.read_bytes()).decode()
    frame = Converter("x.sdl", []).answer({**ask, "data": data})
    [(name, ply)] = files_of(frame).items()
    assert name == "part.step.ply" and ply.startswith(b"ply")
    model = moldloft.loads(head_of(frame)["text"])
    assert model.mesh().area == pytest.approx(whole.mesh().area, rel=1e-3)
    broken = base64.b64encode(path.read_bytes()[:400]).decode()
    for wrong in (broken, "%%%"):
        faulty = {**ask, "name": "../../part.step", "data": wrong}
        error = head_of(Converter("x.sdl", []).answer(faulty))["error"]
        assert error and str(tmp_path.parent.parent) not in error
