"""Files that come out of the page and go into it: every format, remarks, CAD."""

from __future__ import annotations

import base64
import re
from pathlib import Path
from typing import Any

import pytest

import moldloft
from conftest import SAILBOAT, Run
from moldloft.formats import formats
from moldloft.workbench.conversion import Converter
from moldloft.workbench.frames import head_of
from page_in_browser import in_browser

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


def same(one: bytes, other: bytes, format: str) -> bool:
    """True for the same file, but for what other projects leave to chance."""
    if format == "3dm":
        # rhino3dm gives its objects random names.
        return len(one) == len(other)
    if format.endswith("dxf"):
        # ezdxf lists its classes in the order of a set.
        return sorted(one.split(b"\n")) == sorted(other.split(b"\n"))
    return one == other


@pytest.mark.parametrize("text", [HULL, SOLID], ids=["hull", "solid"])
def test_every_format_is_that_of_the_command(text: str, cli: Run, tmp_path: Path) -> None:
    (tmp_path / "hull.sdl").write_text(text, encoding="utf-8")
    converter = Converter("hull.sdl", [str(tmp_path)])
    converter.sync(text)
    made = 0
    wanted = [f for f in formats() if text == HULL or formats()[f].volume]
    cli(
        "build",
        "hull.sdl",
        "--keep-going",
        "--to",
        *wanted,
        "-o",
        "out",
        "-q",
        status=int(text == HULL),
    )
    for format in wanted:
        frame = converter.answer({"kind": "export", "id": 7, "format": format, "stem": "hull"})
        head = head_of(frame)
        assert head["id"] == 7
        for name, data in files_of(frame).items():
            written = (tmp_path / "out" / name).read_bytes()
            assert same(written, data, format), name
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
    # A file of a mirrored model has both sides.
    model = moldloft.loads(head_of(frame)["text"])
    area = 2 * sum(whole[patch.name].area for patch in whole.mesh().patches)
    assert model.mesh().area == pytest.approx(area, rel=1e-3)
    broken = base64.b64encode(path.read_bytes()[:400]).decode()
    for wrong in (broken, "%%%"):
        faulty = {**ask, "name": "../../part.step", "data": wrong}
        error = head_of(Converter("x.sdl", []).answer(faulty))["error"]
        assert error and str(tmp_path.parent.parent) not in error


def exported(b: Any, format: str) -> tuple[str, bytes]:
    """What the page gives for a format that is chosen in the list of commands."""
    b.page.get_by_role("button", name="Export").click()
    with b.page.expect_download(timeout=240_000) as found:
        b.page.get_by_role("combobox", name="command").fill(f"Export: {format},")
        b.page.keyboard.press("Enter")
    return found.value.suggested_filename, Path(found.value.path()).read_bytes()


@in_browser
def test_the_page_shows_what_the_command_remarks(bench: Any, cli: Run, tmp_path: Path) -> None:
    pytest.importorskip("ezdxf")
    b = bench(HULL, "hull.sdl")
    done = cli("build", "hull.sdl", "--to", "step", "dxf", "-o", "out")
    log = b.page.get_by_role("log")
    for format, name in (("step", "hull.step"), ("dxf", "hull.dxf")):
        found, data = exported(b, format)
        assert found == name and same(data, (tmp_path / "out" / name).read_bytes(), format)
    exported(b, "step")
    said = re.search(r"note\[fitted-surfaces\]: (.*)", done.stderr)
    assert said, done.stderr
    log.get_by_text(said.group(1).replace("`", "")).or_(log.get_by_text(said.group(1))).wait_for()
    log.get_by_text("hull.step").first.wait_for()
    b.page.locator(".status").get_by_text("among the messages").wait_for()
    # Another file has remarks of its own.
    exported(b, "dxf")
    b.until(lambda: not log.get_by_text("hull.step").count())
    assert not b.faults


DROP = """([name, data]) => {
  const held = new DataTransfer()
  held.items.add(new File([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], name))
  document.querySelector('.view').dispatchEvent(
    new DragEvent('drop', { dataTransfer: held, bubbles: true, cancelable: true }))
}"""


@in_browser
def test_cad_files_are_dropped_and_opened(bench: Any, tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    text = 'Model info(units = "ft");\n' + SOLID
    solid = moldloft.loads(text)
    for name in ("part.step", "part.igs"):
        solid.write(tmp_path / name)
    b = bench(text.replace("AbsPoint E(0, 0, 1)", "AbsPoint E(0, 0, 1.5)"), "box.sdl")
    before = b.text()
    for name in ("part.step", "part.igs"):
        data = base64.b64encode((tmp_path / name).read_bytes()).decode()
        b.page.evaluate(DROP, [name, data])
        b.page.locator(".status").get_by_text(f"{name}.ply: rms").wait_for(timeout=240_000)
        assert b.text() == before
    b.page.get_by_role("button", name="Open it instead").click()
    b.until(lambda: "NURBSurf" in b.text())
    b.hand("settled()")
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == before)
    # On an empty program it is opened at once.
    empty = bench("", "empty.sdl")
    empty.page.get_by_label("open a program").set_input_files(tmp_path / "part.step")
    empty.until(lambda: "NURBSurf" in empty.text(), 240)
    empty.until(lambda: any(i["kind"] == "patch" for i in empty.hand("items()")))
    assert not b.faults and not empty.faults
