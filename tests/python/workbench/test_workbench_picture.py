"""The picture by hand: given numbers, ghost, control polygon, cube, sections, files, links."""

from __future__ import annotations

import gzip
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import moldloft
from conftest import SAILBOAT, Run
from moldloft.workbench.export import exported_page
from page_in_browser import HULL, PAGE, PLATE, Bench, needs_page

pytestmark = needs_page

#: Two sides of a rectangle: area a*b, diagonal from both.
SIDES = (
    "param float a = 3 in [1, 10];\nparam float b = 4 in [1, 10];\n"
    "AbsPoint A(0, 0, 0); AbsPoint B(a, 0, 0); AbsPoint C(0, b, 0); AbsPoint D(a, b, 0);\n"
    "Line l(A, B); Line m(C, D); RuledSurf s(l, m, divisions = {2, 2});\n"
)
#: A closed box from (0, 0, 0) to (2, 3, 4), as an implicit body.
BLOCK = (
    "set block = set(plane({-1, 0, 0}, {0, 0, 0})) & set(plane({1, 0, 0}, {2, 0, 0})) &\n"
    "    set(plane({0, -1, 0}, {0, 0, 0})) & set(plane({0, 1, 0}, {0, 3, 0})) &\n"
    "    set(plane({0, 0, -1}, {0, 0, 0})) & set(plane({0, 0, 1}, {0, 0, 4}));\n"
    "SetBody part(block, {-1, -1, -1}, {5, 5, 5}, depth = 3);\n"
)


def segments(b: Bench, name: str) -> NDArray[np.float64]:
    """The segments of an overlay: ends by coordinates."""
    return np.array(b.hand(f"over('{name}')") or []).reshape(-1, 2, 3)


def watched(b: Bench, expression: str) -> float:
    rows = b.hand("model")["watched"]
    return float(next(w["value"] for w in rows if w["expression"] == expression))


def watch(b: Bench, *expressions: str) -> None:
    for each in expressions:
        field = b.page.get_by_label("watch an expression")
        field.fill(each)
        field.press("Enter")
        b.until(
            lambda e=each: any(
                w.get("value") for w in b.hand("model")["watched"] if w["expression"] == e
            )
        )


def give(b: Bench, expression: str, value: str, *, stays: tuple[str, ...] = ()) -> None:
    """Opens a number, types its value and leaves."""
    b.page.get_by_role("button", name=f"give {expression} a value").click()
    panel = b.page.get_by_role("group", name="give a value")
    for each in stays:
        panel.get_by_label(each, exact=True).check()
    field = panel.get_by_label(f"value of {expression}")
    field.fill(value)
    field.press("Enter")


def test_a_number_is_typed_and_parameters_pay(bench: Callable[..., Bench]) -> None:
    b = bench(SIDES, "sides.sdl")
    watch(b, "a*b", "a + b")
    give(b, "a*b", "10", stays=("a + b",))
    b.until(lambda: abs(watched(b, "a*b") - 10) < 1e-6)
    b.hand("settled()")
    found = re.search(r"a = ([\d.]+) in .*\nparam float b = ([\d.]+) in", b.text())
    assert found
    sides = sorted(float(x) for x in found.groups())
    # The roots of x² - 7 x + 10.
    assert sides == pytest.approx([2, 5], abs=1e-6)
    assert len(b.hand("steps().done")) == 1
    b.page.keyboard.press("Escape")
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == SIDES)
    # Out of reach with the sum held: the largest product is 12.25.
    give(b, "a*b", "20", stays=("a + b",))
    b.page.locator(".status").get_by_text("reach").wait_for()
    b.hand("settled()")
    assert b.text() == SIDES and not b.faults


def test_weights_say_who_pays(bench: Callable[..., Bench]) -> None:
    b = bench(SIDES.replace("4 in [1, 10]", "3 in [1, 10]"), "sides.sdl")
    watch(b, "a + b")
    start = b.text()
    field = b.page.get_by_role("group", name="give a value").get_by_label("weight of a")
    b.page.get_by_role("button", name="give a + b a value").click()
    assert field.input_value() == "1"
    # Least (2 (a - 3))² + (b - 3)² on a + b = 8: 0.4 and 1.6.
    for weight, wanted in (("2", (3.4, 4.6)), ("-1", (3.4, 4.6)), ("1", (4.0, 4.0))):
        field.fill(weight)
        field.press("Tab")
        if weight == "-1":
            b.page.locator(".status").get_by_text("expected a weight above 0").wait_for()
            assert field.input_value() == "2"
        value = b.page.get_by_label("value of a + b")
        value.fill("8")
        value.press("Enter")
        b.until(lambda: b.text() != start)
        b.hand("settled()")
        assert [b.param("a"), b.param("b")] == pytest.approx(wanted, abs=1e-6)
        b.page.keyboard.press("Escape")
        b.page.get_by_role("application", name="model").focus()
        b.page.keyboard.press("Control+z")
        b.until(lambda: b.text() == start)
        b.page.get_by_role("button", name="give a + b a value").click()
    assert not b.faults


def test_a_number_is_dragged(bench: Callable[..., Bench]) -> None:
    b = bench(SIDES, "sides.sdl")
    watch(b, "a*b")
    number = b.page.get_by_role("button", name="give a*b a value")
    box = number.bounding_box()
    assert box
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    # A tenth of 400 points is a tenth of the number.
    for k in range(1, 9):
        b.page.mouse.move(x + 5 * k, y)
    b.until(lambda: abs(watched(b, "a*b") - 13.2) < 1e-6)
    assert b.text() == SIDES
    b.page.mouse.up()
    b.until(lambda: b.text() != SIDES)
    b.hand("settled()")
    assert len(b.hand("steps().done")) == 1
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == SIDES and abs(watched(b, "a*b") - 12) < 1e-12)
    assert not b.faults


def test_the_shape_before_stays_in_grey_while_a_hand_moves_it(bench: Callable[..., Bench]) -> None:
    b = bench(PLATE.replace("AbsPoint P(0.5, 0.5, 1);\n", ""), "plate.sdl")
    b.page.evaluate("() => window.moldloft.camera_set(-90, 90)")
    assert b.hand("over('ghost')") is None
    x, y = b.hand("project('D')")
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    for k in range(1, 6):
        b.page.mouse.move(x + 12 * k, y - 4 * k)
    b.until(lambda: abs(b.hand("project('D')")[0] - (x + 60)) < 2)
    ghost = segments(b, "ghost")
    # What was there: the square of side 1, though its corner has gone.
    assert np.allclose(ghost.reshape(-1, 3).min(axis=0), 0, atol=1e-6)
    assert np.allclose(ghost.reshape(-1, 3).max(axis=0), [1, 1, 0], atol=1e-6)
    assert max(b.hand("positions('s')")) > 1.02
    b.page.mouse.up()
    b.until(lambda: b.hand("over('ghost')") is None)
    # So do sliders.
    assert not b.faults


def test_a_slider_has_a_ghost_too(bench: Callable[..., Bench]) -> None:
    b = bench(SIDES, "sides.sdl")
    box = b.page.get_by_role("slider", name="a", exact=True).bounding_box()
    assert box
    y = box["y"] + box["height"] / 2
    b.page.mouse.move(box["x"] + box["width"] * 0.22, y)
    b.page.mouse.down()
    b.page.mouse.move(box["x"] + box["width"] * 0.8, y, steps=4)
    b.until(lambda: max(b.hand("positions('s')")) > 7)
    assert segments(b, "ghost").max() == pytest.approx(4)
    b.page.mouse.up()
    b.until(lambda: b.hand("over('ghost')") is None)


def test_the_control_polygon_is_that_of_the_selected_curve(bench: Callable[..., Bench]) -> None:
    b = bench()
    expected = [[15, 4.815, 2.56], [15, 5.046, 0.628], [15, 3.603, -0.87], [15, 0, -1.175]]
    b.page.get_by_role("treeitem", name=re.compile("^MC2 ")).click()
    b.until(lambda: len(segments(b, "polygon")) == 3)
    polygon = segments(b, "polygon")
    assert np.allclose(polygon[:, 0], expected[:-1], atol=1e-5)
    assert np.allclose(polygon[:, 1], expected[1:], atol=1e-5)
    # It follows the model, and a point shows those that it is in.
    b.page.get_by_role("slider", name="beam", exact=True).focus()
    b.page.keyboard.press("PageUp")
    b.until(lambda: segments(b, "polygon")[0, 0, 1] > 4.82)
    b.page.get_by_role("treeitem", name="Points").click()
    b.page.get_by_role("treeitem", name=re.compile("^P31 ")).click()
    b.until(lambda: np.allclose(segments(b, "polygon")[:, :, 0], 30))
    b.page.get_by_role("treeitem", name=re.compile("^stations ")).click()
    b.until(lambda: b.hand("over('polygon')") is None)


def test_the_cube_turns_the_picture_and_the_bar_tells_its_size(bench: Callable[..., Bench]) -> None:
    b = bench()
    cube = b.page.locator(".cube").bounding_box()
    assert cube and cube["width"] == 88
    middle = (cube["x"] + 44, cube["y"] + 44)

    def turned(azimuth: float, elevation: float) -> bool:
        camera = b.hand("camera()")
        return bool((camera["azimuth"], camera["elevation"]) == (azimuth, elevation))

    # The face +z is the upper one of the first view; in plan, a click in the middle is on it again.
    b.page.mouse.click(middle[0], middle[1] - 24)
    b.until(lambda: turned(-90, 90))
    b.page.mouse.click(*middle)
    assert turned(-90, 90)
    b.page.keyboard.press("1")
    b.until(lambda: turned(-128, 24))
    b.page.mouse.click(middle[0] - 12, middle[1] + 12)
    b.until(lambda: turned(180, 0))
    # Seen along x, the bar is as long as the model says between two points across.
    b.page.keyboard.press("3")
    b.until(lambda: turned(-90, 90))
    bar = b.page.locator(".scale-bar")

    def right() -> bool:
        found = re.fullmatch(r"([\d.]+) ft", bar.inner_text().strip())
        width = bar.evaluate("e => e.getBoundingClientRect().width")
        a, c = b.hand("project('P11')"), b.hand("project('P34')")
        feet = width / (c[0] - a[0]) * 30
        return bool(found and abs(feet / float(found.group(1)) - 1) < 0.03)

    b.until(right)


def paper(b: Bench) -> int:
    """Pixels of the paper between the lines of a hatch."""
    return int(
        b.page.evaluate("""() => {
  const c = document.querySelector('.view > canvas')
  const k = document.createElement('canvas')
  k.width = c.width
  k.height = c.height
  const g = k.getContext('2d')
  g.drawImage(c, 0, 0)
  const { data } = g.getImageData(0, 0, c.width, c.height)
  let found = 0
  for (let p = 0; p < data.length; p += 4)
    if (Math.max(...[247, 237, 209].map((x, j) => Math.abs(data[p + j] - x))) < 6) found++
  return found
}""")
    )


def test_a_section_is_hatched_and_dragged(bench: Callable[..., Bench]) -> None:
    b = bench(BLOCK, "block.sdl")
    b.page.evaluate("() => window.moldloft.camera_set(-128, 24)")
    b.page.get_by_role("application", name="model").focus()
    assert paper(b) < 50
    b.page.keyboard.press("Shift+X")
    field = b.page.get_by_label("section at x, value")
    field.wait_for()
    b.page.wait_for_timeout(200)
    outline = segments(b, "section")
    assert np.allclose(outline[:, :, 0], 1, atol=1e-6)
    lengths = np.linalg.norm(outline[:, 1] - outline[:, 0], axis=1)
    # The outline of 3 by 4, and its face is seen: the eye is at -x, and the nearer half has gone.
    assert lengths.sum() == pytest.approx(14, rel=1e-3)
    assert paper(b) > 4000
    knob = b.page.locator(".knob").bounding_box()
    assert knob
    x, y = knob["x"] + 9, knob["y"] + 9
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    b.page.mouse.move(x + 20, y - 4, steps=3)
    b.page.mouse.up()
    moved = float(field.input_value().replace("−", "-"))
    assert 1 < moved < 2 and np.allclose(segments(b, "section")[:, :, 0], moved, atol=1e-4)
    field.fill("0.25 + 0.25")
    field.press("Enter")
    b.until(lambda: np.allclose(segments(b, "section")[:, :, 0], 0.5, atol=1e-6))
    # The other half hides the face; Escape ends the section.
    b.page.get_by_role("button", name="Flip").click()
    b.until(lambda: paper(b) < 50)
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("Escape")
    b.until(lambda: b.hand("over('section')") is None)
    assert not b.page.locator(".knob").is_visible() and not b.faults


def test_an_open_shell_has_no_face(bench: Callable[..., Bench]) -> None:
    b = bench()
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("Shift+X")
    b.until(lambda: len(segments(b, "section")))
    b.page.wait_for_timeout(200)
    # Both sides are outlined; nothing closes the hull above.
    outline = segments(b, "section").reshape(-1, 3)
    assert outline[:, 1].min() == pytest.approx(-outline[:, 1].max(), abs=1e-6)
    assert paper(b) < 50 and not b.faults


def exported(b: Bench, words: str) -> tuple[str, bytes]:
    b.page.get_by_role("button", name="Export").click()
    with b.page.expect_download(timeout=60_000) as found:
        b.page.get_by_role("combobox", name="command").fill(f"Export: {words}")
        b.page.keyboard.press("Enter")
    return found.value.suggested_filename, Path(found.value.path()).read_bytes()


def test_files_come_out_of_the_page(bench: Callable[..., Bench], cli: Run, tmp_path: Path) -> None:
    b = bench()
    for words, name, begin in (
        ("step", "hull.step", b"ISO-10303-21;"),
        ("iges", "hull.igs", b""),
        ("3mf", "hull.3mf", b"PK"),
        ("glb", "hull.glb", b"glTF"),
        ("svg", "hull.body-plan.svg", b"<"),
        ("picture as", "hull.png", b"\x89PNG"),
    ):
        found, data = exported(b, words)
        assert found == name and data.startswith(begin) and len(data) > 1000, found
    # The page and the command write the same triangles, of the model as it is now.
    slider = b.page.get_by_role("slider", name="beam", exact=True)
    slider.focus()
    b.page.keyboard.press("PageUp")
    b.hand("settled()")
    _, stl = exported(b, "stl, ")
    (tmp_path / "now.sdl").write_text(b.text(), encoding="utf-8")
    cli("build", "now.sdl", "--to", "stl", "-o", "out")
    assert stl[80:] == (tmp_path / "out" / "now.stl").read_bytes()[80:]
    assert b.text() != HULL and not b.faults


def test_a_link_holds_the_model(bench: Callable[..., Bench]) -> None:
    b = bench(SIDES, "sides.sdl")
    b.context.grant_permissions(["clipboard-read", "clipboard-write"])
    b.page.get_by_role("button", name="Link", exact=True).click()
    b.page.locator(".status").get_by_text("Link copied").wait_for()
    address = b.page.evaluate("() => navigator.clipboard.readText()")
    assert re.search(r"#m=[\w-]+$", address)
    give_up = SIDES.replace("a = 3", "a = 5")
    editor = b.page.get_by_role("textbox", name="program")
    editor.focus()
    b.page.keyboard.press("Control+a")
    b.page.keyboard.insert_text(give_up)
    b.until(lambda: b.text() == give_up)
    b.hand("settled()")
    b.page.goto("about:blank")
    b.page.goto(address)
    take = b.page.get_by_role("button", name="Open it")
    take.wait_for(timeout=30_000)
    assert b.text() == give_up and "#" not in b.page.url
    take.click()
    b.until(lambda: b.text() == SIDES)
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == give_up)
    b.hand("settled()")
    # One that was cut short is an error, and nothing is taken.
    b.page.goto("about:blank")
    b.page.goto(address[:-6])
    b.page.get_by_role("alert").get_by_text("damaged or cut short").wait_for(timeout=30_000)
    assert b.text() == give_up


DROP = """([name, text]) => {
  const data = new DataTransfer()
  data.items.add(new File([text], name))
  const at = document.querySelector('.view')
  at.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }))
}"""


def test_files_are_dropped_on_the_picture(bench: Callable[..., Bench], tmp_path: Path) -> None:
    b = bench(SIDES, "sides.sdl")
    b.page.evaluate(DROP, ["other.sdl", PLATE])
    b.until(lambda: b.text() == PLATE)
    b.page.locator(".status").get_by_text("other.sdl has replaced").wait_for()
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == SIDES)
    b.page.evaluate(DROP, ["part.skt", "SKETCH A\n"])
    b.page.locator(".status").get_by_text("another kind of model").wait_for()
    assert b.text() == SIDES
    b.page.evaluate(DROP, ["table.csv", "0,0,0.5\n3,0,0.5\n0,4,0.5\n"])
    b.page.locator(".status").get_by_text("rms 0.5").wait_for()
    assert not b.faults


def test_a_sheet_that_no_longer_applies_does_not_move_the_picture(
    bench: Callable[..., Bench],
) -> None:
    b = bench()
    tabs = [b.page.get_by_role("tab", name=name) for name in ("Hydrostatics", "Section areas")]
    for tab in tabs:
        tab.wait_for()
        assert tab.is_enabled()
    view = b.page.locator(".view")
    before = view.bounding_box()
    b.page.evaluate(DROP, ["other.sdl", PLATE])
    b.until(lambda: b.text() == PLATE)
    # A plate does not float: the tabs stay where they are, and lead nowhere.
    b.until(lambda: all(tab.is_disabled() for tab in tabs))
    assert view.bounding_box() == before
    b.page.keyboard.press("Control+z")
    b.until(lambda: all(tab.is_enabled() for tab in tabs))
    assert view.bounding_box() == before and not b.faults


def test_a_page_in_a_file_has_the_usual_numbers() -> None:
    page = exported_page(SAILBOAT / "hull.sdl", living=False).decode()
    found = re.search(r'id="moldloft-model">(.*?)</script>', page, re.DOTALL)
    assert found
    watched = {w["expression"]: w["value"] for w in json.loads(found.group(1))["hello"]["watched"]}
    figures = moldloft.load(SAILBOAT / "hull.sdl").hydrostatics()
    assert watched["hydrostatics.volume"] == pytest.approx(figures.volume, rel=1e-12)
    assert watched["hydrostatics.lcb"] == pytest.approx(figures.lcb, rel=1e-12)
    usual = json.loads((PAGE.parents[1] / "usual.json").read_text(encoding="utf-8"))
    assert set(watched) == {*usual["floating"], *usual["other"]}


def test_the_first_view_loads_a_small_base() -> None:
    def of(name: str) -> int:
        """The chunk of a name, packed."""
        [chunk] = (PAGE.parent / "assets").glob(f"{name}-*.js")
        return len(gzip.compress(chunk.read_bytes(), 9))

    # The picture with its frame; the editor comes beside it, and rooms when they are shown.
    assert of("index") + of("three") <= 220_000
    assert of("board") < 24_000 and of("desk") < 20_000 and of("editor") < 140_000


def test_everything_is_in_reach_on_a_small_screen(bench: Callable[..., Bench]) -> None:
    b = bench()
    b.page.set_viewport_size({"width": 1280, "height": 720})
    b.page.get_by_role("treeitem", name=re.compile("^MC2 ")).click()
    b.page.get_by_role("textbox", name="name of the object").wait_for()

    def inside(locator: Any) -> bool:
        box = locator.bounding_box()
        return bool(
            box
            and box["x"] >= 0
            and box["x"] + box["width"] <= 1280
            and box["y"] + box["height"] <= 720
        )

    assert inside(b.page.get_by_role("textbox", name="name of the object"))
    assert inside(b.page.get_by_role("treeitem", name=re.compile("^MC2 ")))
    for each in b.page.get_by_role("tab").all():
        assert not each.is_visible() or inside(each)
    b.page.get_by_role("tab", name="Fairing desk").click()
    b.page.get_by_label("fairing command").wait_for()
    assert not b.page.locator(".cube").is_visible()
    assert b.page.evaluate("() => document.documentElement.scrollWidth") <= 1280


def test_columns_of_a_program_are_a_table(bench: Callable[..., Bench]) -> None:
    text = (
        "farray x = {0, 1, 2};  # stations\nfarray h = {0.5, .75, 1e0};\n"
        "curve p = {{0, 0, 0}, {1, 0, 0}, {2, 0.5, 0}};\n"
        "AbsPoint A(x[1], 0, h[1]); AbsPoint B(x[2], 1, h[2]); AbsPoint C(x[3], 0, h[3]);\n"
        "BCurve c({A, B, C});\n"
    )
    b = bench(text, "columns.sdl")
    b.page.get_by_role("tab", name="Tables").click()
    cell = b.page.get_by_label("h, row 2", exact=True)
    assert cell.input_value() == ".75"
    cell.fill("1/4 + 0.5")
    cell.press("Enter")
    b.until(lambda: b.text() == text.replace(".75", "0.75"))
    # The next cell has the focus; what is no number is refused, and the cell is as it was.
    last = b.page.get_by_label("h, row 3", exact=True)
    b.until(lambda: last.evaluate("e => e === document.activeElement"))
    last.fill("nobody")
    last.press("Tab")
    b.page.locator(".status").get_by_text("nobody").wait_for()
    assert last.input_value() == "1e0"
    b.page.get_by_role("button", name="Add a row").click()
    b.until(lambda: "x = {0, 1, 2, 2}" in b.text() and "1e0, 1e0}" in b.text())
    assert "{2, 0.5, 0}, {2, 0.5, 0}};" in b.text()
    point = b.page.get_by_label("p.z, row 4", exact=True)
    point.fill("-0.25")
    point.press("Enter")
    b.until(lambda: "{2, 0.5, 0}, {2, 0.5, -0.25}};" in b.text())
    b.page.get_by_label("x, row 4", exact=True).fill("3")
    b.page.keyboard.press("Enter")
    b.until(lambda: "x = {0, 1, 2, 3}" in b.text())
    b.page.get_by_role("img", name="h from 0.5 to 1").wait_for()
    names = [
        "h, row 2: 0.75",
        "Add row 4 of x, h, p",
        "p.z, row 4: -0.25",
        "x, row 4: 3",
    ]
    assert b.hand("steps().done") == names
    b.page.get_by_role("tab", name="Model").click()
    for _ in names:
        b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == text)
    assert not b.faults
