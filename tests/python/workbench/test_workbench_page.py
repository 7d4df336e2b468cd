"""The page of the workbench in a browser: real pointers and keys, end to end."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from conftest import ROOT, SAILBOAT
from page_in_browser import ENGINE, HULL, PLATE, Bench, File, children, needs_page

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
EXAMPLES = sorted(
    p.relative_to(ROOT / "examples").as_posix() for p in ROOT.glob("examples/*/*.sdl")
)

pytestmark = needs_page


def test_a_slider_moves_the_model_and_then_the_text(bench: Callable[..., Bench]) -> None:
    b = bench()
    before = b.hand("positions('hull')")
    slider = b.page.get_by_role("slider", name="beam", exact=True)
    # A factor has no unit, nor is that of another parameter known.
    assert 'units = "ft"' in HULL and slider.get_attribute("aria-valuetext") == "10.0568"
    slider.focus()
    b.page.keyboard.press("PageUp")
    b.until(lambda: b.hand("positions('hull')") != before)
    b.until(lambda: "beam = 10.0568" not in b.text())
    value = float(re.search(r"beam = ([\d.]+) in", b.text())[1])
    assert value == pytest.approx(10.0568 + 0.7, abs=0.01) and b.param("beam") == value
    assert float(slider.get_attribute("aria-valuetext") or "") == value
    # One step of the history takes it back, in the text and in the model.
    b.page.get_by_role("textbox", name="program").focus()
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.hand("positions('hull')") == before)
    assert b.text() == HULL
    assert not b.faults
    assert all("127.0.0.1" in url or url.startswith(("blob:", "data:")) for url in b.requests)


def test_typing_is_followed_and_faults_are_listed(bench: Callable[..., Bench]) -> None:
    b = bench()
    shown = len(b.hand("items()"))
    program = b.page.get_by_role("textbox", name="program")
    program.focus()
    b.page.keyboard.press("Control+End")
    b.page.keyboard.type("AbsPoint Top(15, 0, 9);\n")
    b.until(lambda: any(i["object"] == "Top" for i in b.hand("items()")))
    b.page.keyboard.type("Line broken(Top, nothing);")
    log = b.page.get_by_role("log", name="diagnostics")
    log.get_by_text("nothing").first.wait_for()
    # The rest of the model stays.
    assert len(b.hand("items()")) >= shown
    assert b.page.locator(".cm-lintRange-error").count() > 0
    b.until(lambda: "broken" in (b.path.parent / ".hull.sdl.draft").read_text())
    b.page.keyboard.press("Control+s")
    b.until(lambda: "broken" in b.path.read_text())


def test_a_dragged_point_changes_its_number_in_one_step(bench: Callable[..., Bench]) -> None:
    b = bench("AbsPoint P(1, 2, 3);\nAbsPoint Q(9, 0, 0);\nAbsPoint R(0, 9, 9);\n", "points.sdl")
    b.page.evaluate("() => window.moldloft.camera_set(-90, 90)")
    b.page.wait_for_timeout(200)
    x, y = b.hand("project('P')")
    mouse = b.page.mouse
    mouse.move(x, y)
    mouse.down()
    for k in range(1, 9):
        mouse.move(x + 5 * k, y - 3 * k)
        b.page.wait_for_timeout(20)
    mouse.up()
    b.until(lambda: "P(1, 2, 3)" not in b.text())
    px, py, pz = (
        float(v) for v in re.search(r"P\(([-\d.]+), ([-\d.]+), (\S+)\)", b.text()).groups()
    )
    # Seen from above: along x and y, and z stays as it was spelled.
    assert px > 1 and py > 2 and pz == 3 and "3)" in b.text()
    gone_x, gone_y = b.hand("project('P')")
    assert abs(gone_x - (x + 40)) < 2 and abs(gone_y - (y - 24)) < 2
    b.page.get_by_role("textbox", name="program").focus()
    b.page.keyboard.press("Control+z")
    b.until(lambda: "P(1, 2, 3)" in b.text())
    # Along an axis only; and taken back by Esc.
    b.until(lambda: b.hand("project('P')") == pytest.approx([x, y], abs=1e-6))
    mouse.move(x, y)
    mouse.down()
    mouse.move(x + 10, y - 10)
    b.page.keyboard.press("x")
    mouse.move(x + 30, y - 30)
    mouse.move(x + 40, y - 40)
    mouse.up()
    b.until(lambda: re.search(r"P\([\d.]+, 2, 3\)", b.text()) and "P(1," not in b.text())
    kept = b.text()
    x, y = b.hand("project('P')")
    mouse.move(x, y)
    mouse.down()
    mouse.move(x + 20, y)
    mouse.move(x + 40, y)
    b.page.keyboard.press("Escape")
    mouse.up()
    b.page.wait_for_timeout(300)
    assert b.text() == kept
    b.until(lambda: b.hand("project('P')") == pytest.approx([x, y], abs=1e-6))


def test_an_expression_is_dragged_by_its_parameter(bench: Callable[..., Bench]) -> None:
    text = "param float w = 2 in [1, 9];\nAbsPoint P(w * w, 0 * w, 0 * w);\n"
    text += "AbsPoint Q(0, 5, 0);\nAbsPoint R(30, -5, 0);\n"
    b = bench(text, "wide.sdl")
    b.page.evaluate("() => window.moldloft.camera_set(-90, 90)")
    b.page.wait_for_timeout(200)
    x, y = b.hand("project('P')")
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    for k in range(1, 11):
        b.page.mouse.move(x + 8 * k, y)
        b.page.wait_for_timeout(30)
    assert (
        b.page.get_by_role("group", name="what to move").get_by_text("w", exact=True).count() == 1
    )
    b.page.mouse.up()
    b.until(lambda: "w = 2 in" not in b.text())
    assert b.param("w") > 2
    gone = b.hand("project('P')")
    assert abs(gone[0] - (x + 80)) < 3


def test_every_part_has_its_role_and_keys(bench: Callable[..., Bench]) -> None:
    b = bench()
    page = b.page
    assert page.get_by_role("slider", name="beam", exact=True).count() == 1
    assert page.get_by_role("textbox", name="program").count() == 1
    assert page.get_by_role("application", name="model").count() == 1
    assert page.get_by_role("log", name="diagnostics").count() == 1
    tree = page.get_by_role("tree", name="objects")
    item = tree.get_by_role("treeitem", name=re.compile("^hull"))
    item.click()
    page.get_by_role("region", name="inspector").get_by_text("CLoftSurf").wait_for()
    item.press(" ")
    b.until(lambda: not next(i for i in b.hand("items()") if i["object"] == "hull")["seen"])
    tree.locator("[role=treeitem][tabindex='0']").press(" ")
    b.until(lambda: next(i for i in b.hand("items()") if i["object"] == "hull")["seen"])
    # Commands by name, and by key from the model.
    page.keyboard.press("Control+k")
    page.get_by_role("combobox", name="command").fill("profile")
    page.keyboard.press("Enter")
    b.until(lambda: b.hand("camera()")["elevation"] == 0)
    page.get_by_role("application", name="model").focus()
    page.keyboard.press("3")
    b.until(lambda: b.hand("camera()")["elevation"] == 90)
    page.keyboard.press("ArrowDown")
    b.until(lambda: b.hand("camera()")["elevation"] == 90)
    page.keyboard.press("ArrowUp")
    b.until(lambda: b.hand("camera()")["elevation"] == 75)
    page.keyboard.press("F1")
    page.get_by_role("dialog", name="help").wait_for()
    page.keyboard.press("Escape")
    assert not b.faults


def test_sheets_follow_the_model(bench: Callable[..., Bench]) -> None:
    b = bench()
    page = b.page
    for name, part in [
        ("Hydrostatics", "immersed volume, both sides"),
        ("Mesh", "panels"),
        ("Dependencies", "MC1"),
        ("Curvature", "Curvature of"),
        ("Lines plan", "body plan"),
    ]:
        page.get_by_role("tab", name=name).click()
        page.locator(".sheet").get_by_text(part).first.wait_for(timeout=20_000)
    page.get_by_role("tab", name="Hydrostatics").click()
    # A model has no density: nothing is called by the name of a mass.
    page.locator(".sheet").get_by_text("ft³").first.wait_for()
    assert "displacement" not in page.locator(".sheet").inner_text()
    cell = page.locator(".sheet tbody tr").first.locator("td").first
    cell.wait_for()
    before = cell.inner_text()
    slider = page.get_by_role("slider", name="beam", exact=True)
    slider.focus()
    page.keyboard.press("PageUp")
    b.until(lambda: cell.inner_text() != before)
    page.get_by_role("tab", name="Model").click()
    for colour in ("zebra", "gaussian_curvature", "mean_curvature", "d:beam", "aspect", "patches"):
        page.get_by_role("combobox", name="colour").select_option(colour)
        page.wait_for_timeout(80)
    assert not b.faults


FORM = (
    "param float w = 2 in [1, 3];\nAbsPoint A(0, 0, 0); AbsPoint B(w, 0, 1); AbsPoint C(0, 1, 0);\n"
    "AbsPoint D(2, 1, 2); Line l(A, B); Line m(C, D);\n"
    'CLoftSurf s({l, m}, ends = "natural", divisions = {4, 4});\n'
)


def test_the_inspector_is_a_form_of_all_arguments(bench: Callable[..., Bench]) -> None:
    b = bench(FORM, "form.sdl")
    inspector = b.page.get_by_role("region", name="inspector")
    tree = b.page.get_by_role("tree", name="objects")
    tree.get_by_role("treeitem", name=re.compile("^s ?CLoftSurf")).click()
    # One of several words.
    ends = inspector.get_by_role("combobox", name="ends")
    ends.wait_for()
    assert {"notaknot", "natural", "periodic"} <= set(ends.locator("option").all_inner_texts())
    ends.select_option("bessel")
    b.until(lambda: 'ends = "bessel"' in b.text())
    # A list of parents, as the program spells it.
    curves = inspector.get_by_role("textbox", name="curves")
    b.until(lambda: curves.input_value() == "{l, m}")
    curves.fill("{m, l}")
    curves.press("Enter")
    b.until(lambda: "CLoftSurf s({m, l}" in b.text())
    # What is not given is written by its name.
    degree = inspector.get_by_role("textbox", name="degree")
    degree.fill("1")
    degree.press("Enter")
    b.until(lambda: "degree = 1" in b.text())
    b.until(lambda: not b.hand("model.faults"))
    # An expression, and a number that becomes one; each is a step of the history.
    folded = tree.get_by_role("treeitem", name=re.compile("^▸? ?Points"))
    if folded.get_attribute("aria-expanded") == "false":
        folded.click()
    tree.get_by_role("treeitem", name=re.compile("^B ?AbsPoint")).click()
    x = inspector.get_by_role("textbox", name="x", exact=True)
    b.until(lambda: x.input_value() == "w")
    x.fill("2*w")
    x.press("Enter")
    b.until(lambda: "B(2*w, 0, 1)" in b.text())
    z = inspector.get_by_role("textbox", name="B.z")
    z.fill("w/2")
    z.press("Enter")
    b.until(lambda: "B(2*w, 0, w/2)" in b.text())
    b.page.get_by_role("textbox", name="program").focus()
    steps = ["B(2*w, 0, 1)", "B(w, 0, 1)", 's({m, l}, ends = "bessel", div', "s({l, m}, ends"]
    for text in steps:
        b.page.keyboard.press("Control+z")
        b.until(lambda text=text: text in b.text())
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == FORM)
    assert not b.faults


HOSTILE = "<img src=x onerror=alert(1)>"


def test_names_are_texts(bench: Callable[..., Bench]) -> None:
    b = bench(
        f'print("{HOSTILE}");\nprint("</script><b>x</b> $& \u202e");\nAbsPoint P(0, 0, 0);\n'
        f'assert(1 > 2, "{HOSTILE}");\n',
        "hostile.sdl",
    )
    b.page.get_by_text(HOSTILE).first.wait_for()
    assert b.page.locator("img").count() == 0 and b.page.locator(".log b").count() == 0


def test_nothing_is_lost_when_engine_or_server_go(bench: Callable[..., Bench]) -> None:
    b = bench("AbsPoint P(1, 2, 3);\n", "small.sdl")
    b.page.get_by_role("textbox", name="program").focus()
    b.page.keyboard.press("Control+End")
    for child in children(b.process.pid):
        subprocess.run(["kill", "-9", str(child)], check=True)
    b.page.keyboard.type("AbsPoint Q(4, 5, 6);\n")
    b.until(lambda: any(i["object"] == "Q" for i in b.hand("items()")), 30)
    b.process.kill()
    b.process.wait(60)
    b.page.get_by_text("The server does not answer").wait_for()
    b.page.keyboard.type("# typed alone\n")
    assert "Q(4" in (b.path.parent / ".small.sdl.draft").read_text()
    assert b.text().endswith("# typed alone\n")


def test_a_still_file_opens_without_a_server(browser: Any, cli: Any, tmp_path: Path) -> None:
    cli("export", "--html", "--still", SAILBOAT / "hull.sdl", "-o", "hull.html")
    assert (tmp_path / "hull.html").stat().st_size < 1_600_000
    file = File(tmp_path / "hull.html", browser)
    assert len(file.hand("items()")) > 5
    assert file.page.get_by_role("slider", name="beam", exact=True).is_disabled()
    file.close()


needs_engine = pytest.mark.skipif(
    not ENGINE.exists(),
    reason="the engine for pages is not built: `make engine` needs the target "
    "wasm32-unknown-unknown",
)


@needs_engine
def test_a_file_is_alive_without_a_server(browser: Any, cli: Any, tmp_path: Path) -> None:
    cli("export", "--html", SAILBOAT / "hull.sdl", "-o", "hull.html")
    file = File(tmp_path / "hull.html", browser)
    # The scene is there before the engine is.
    first = file.hand("positions('hull')")
    assert len(first) > 300
    file.running()
    assert file.hand("positions('hull')") == first
    page = file.page
    slider = page.get_by_role("slider", name="beam", exact=True)
    slider.focus()
    area = file.until(lambda: file.hand("model.watched"))[0]["value"]
    # Two quick presses are two steps, and both are in the text.
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    file.until(lambda: "beam = 10.071 in" in file.hand("text()"))
    file.until(lambda: file.hand("model.params")[0]["value"] == 10.071)
    file.until(lambda: file.hand("model.watched")[0]["value"] > area)
    assert not file.hand("model.faults")
    # A broken text keeps the last shape; a repaired one is followed.
    count = len(file.hand("items()"))
    editor = page.get_by_role("textbox", name="program")
    editor.focus()
    page.keyboard.press("Control+End")
    page.keyboard.type("AbsPoint Q(1, 2")
    file.until(lambda: file.hand("model.faults"))
    assert len(file.hand("items()")) == count
    page.keyboard.type(", 3);")
    file.until(lambda: not file.hand("model.faults") and len(file.hand("items()")) == count + 1)
    # What was changed is there again after a reload, and goes when it is dropped.
    file.open()
    file.running()
    file.until(lambda: "AbsPoint Q(1, 2, 3);" in file.hand("text()"))
    file.until(lambda: len(file.hand("items()")) == count + 1)
    page.keyboard.press("Control+K")
    page.keyboard.type("as it came")
    page.keyboard.press("Enter")
    file.until(lambda: file.hand("text()") == HULL)
    file.close()


@needs_engine
@pytest.mark.skipif(not SOAK, reason="the long run")
@pytest.mark.parametrize("name", EXAMPLES)
def test_every_example_is_alive_in_a_file(
    name: str, browser: Any, cli: Any, tmp_path: Path
) -> None:
    cli("export", "--html", ROOT / "examples" / name, "-o", "alive.html")
    file = File(tmp_path / "alive.html", browser)
    file.running()
    assert file.hand("items()")
    file.close()


@needs_engine
def test_a_text_that_fails_in_a_file_can_be_changed(
    browser: Any, cli: Any, tmp_path: Path, model_file: Callable[..., Path]
) -> None:
    cli("export", "--html", model_file("AbsPoint P(1, 2, 3);\n"), "-o", "small.html")
    file = File(tmp_path / "small.html", browser)
    file.running()
    # A subroutine that calls itself needs more than a browser's stack.
    editor = file.page.get_by_role("textbox", name="program")
    editor.focus()
    file.page.keyboard.press("Control+End")
    file.page.keyboard.insert_text("float f(float x) { return f(x + 1) + 1; }\nfloat y = f(0);\n")
    stopped = "engine was stopped"
    file.until(
        lambda: file.hand("model.faults") or stopped in file.page.locator(".banner").inner_text()
    )
    for _ in range(2):
        file.page.keyboard.press("Control+Z")
    file.until(lambda: file.hand("text()") == "AbsPoint P(1, 2, 3);\n")
    file.until(lambda: not file.hand("model.faults"))
    file.page.keyboard.press("Control+End")
    file.page.keyboard.insert_text("AbsPoint Q(2, 2, 3);\n")
    file.until(lambda: len(file.hand("items()")) == 2)
    file.close()


@needs_engine
def test_a_file_carries_what_the_model_reads(browser: Any, cli: Any, tmp_path: Path) -> None:
    cli("export", "--html", ROOT / "examples" / "wingbody" / "layers.sdl", "-o", "layers.html")
    text = (tmp_path / "layers.html").read_text(encoding="utf-8")
    assert str(ROOT) not in text, "a page says nothing of the machine that it was made on"
    file = File(tmp_path / "layers.html", browser)
    first = file.hand("items()")
    file.running()
    file.until(lambda: file.hand("items()") == first)
    assert not [f for f in file.hand("model.faults") if f["severity"] == "error"]
    file.close()


OFFSETS = "x, y, z\n0.5, 0.25, 0\n0.5, 0.5, 0.1\n0.25, 0.75, -0.2\n"


def test_foreign_points_have_their_deviation(bench: Callable[..., Bench], tmp_path: Path) -> None:
    b = bench(PLATE)
    (tmp_path / "offsets.csv").write_text(OFFSETS)
    with b.page.expect_file_chooser() as chosen:
        b.page.keyboard.press("Control+K")
        b.page.keyboard.type("lay a file")
        b.page.keyboard.press("Enter")
    chosen.value.set_files(str(tmp_path / "offsets.csv"))
    # rms of 0, 0.1, 0.2 and the largest.
    b.page.get_by_text("offsets.csv: rms 0.1291, largest 0.2").wait_for()
    assert not b.faults


def test_section_areas_follow(bench: Callable[..., Bench]) -> None:
    b = bench(HULL)
    b.page.get_by_role("tab", name="Section areas").click()
    b.page.get_by_role("img", name="section areas").wait_for()
    label = b.page.get_by_role("img", name="section areas").get_attribute("aria-label")
    slider = b.page.get_by_role("slider", name="beam", exact=True)
    # A factor has no unit, nor is that of another parameter known.
    assert 'units = "ft"' in HULL and slider.get_attribute("aria-valuetext") == "10.0568"
    slider.focus()
    b.page.keyboard.press("PageUp")
    b.until(
        lambda: b.page.get_by_role("img", name="section areas").get_attribute("aria-label") != label
    )
    assert b.page.locator(".plot .before").count() == 1 and not b.faults
