"""Making: the start page, objects of kinds, handles; by the pointer and keys of a person."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from page_in_browser import Bench, needs_page

pytestmark = needs_page

POINTS = (
    "AbsPoint A(0, 0, 0);\nAbsPoint B(4, 0, 0);\nAbsPoint C(4, 3, 0);\nAbsPoint D(0, 3, 1);\n"
    "BCurve c({A, B, C}, degree = 2);\n"
)


def opened(make: Callable[..., Bench], text: str = POINTS) -> Bench:
    b = make(text, "made.sdl")
    b.page.evaluate("() => window.moldloft.camera_set(-90, 90)")
    b.page.wait_for_timeout(200)
    return b


def form(b: Bench, kind: str) -> Any:
    """Opens the form of a kind by the keyboard."""
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("Shift+A")
    search = b.page.get_by_role("searchbox", name="search kinds")
    search.fill(kind)
    search.press("Enter")
    return b.page.get_by_role("region", name="add an object")


def click(b: Bench, name: str) -> None:
    x, y = b.hand(f"project('{name}')")
    b.page.mouse.click(x, y)


def test_parents_are_picked_in_the_picture(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    panel = form(b, "Line")
    assert panel.get_by_text("Line", exact=True).is_visible()
    for name in ("A", "C"):
        click(b, name)
    panel.get_by_role("button", name="Add", exact=True).click()
    b.until(lambda: "Line c1(A, C);" in b.text())
    # What is no point is refused where a point is wanted, and the text stays.
    b.page.keyboard.press("Escape")
    panel = form(b, "Line")
    b.page.get_by_role("treeitem", name=re.compile("^c ")).click()
    b.page.locator(".status").get_by_text("takes").wait_for()
    panel.get_by_role("button", name="Add", exact=True).click()
    panel.get_by_role("alert").get_by_text("is missing").wait_for()
    text = b.text()
    # Several, one taken out again, with an option.
    b.page.keyboard.press("Escape")
    panel = form(b, "CCurve")
    for name in ("A", "B", "B", "C", "D"):
        click(b, name)
    panel.get_by_text("Options").click()
    panel.get_by_role("textbox", name="degree").fill("1")
    panel.get_by_role("button", name="Add", exact=True).click()
    b.until(lambda: b.text() != text)
    assert "CCurve c2({A, C, D}, degree = 1);" in b.text(), b.text()
    assert b.hand("steps().done") == ["Add c1", "Add c2"]
    for _ in range(2):
        b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == POINTS)
    assert not b.faults


def test_a_fault_of_the_engine_stays_in_the_form(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    panel = form(b, "AbsPoint")
    for axis, value in zip("xyz", ("1", "nobody", "2"), strict=True):
        panel.get_by_role("textbox", name=axis, exact=True).fill(value)
    panel.get_by_role("textbox", name="z", exact=True).press("Enter")
    panel.get_by_role("alert").get_by_text("nobody").wait_for()
    assert b.text() == POINTS
    panel.get_by_role("textbox", name="y", exact=True).fill("1.5")
    panel.get_by_role("textbox", name="y", exact=True).press("Enter")
    b.until(lambda: "D(0, 3, 1);\nAbsPoint P1(1, 1.5, 2);" in b.text())


def test_objects_are_renamed_duplicated_and_deleted(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    click(b, "D")
    name = b.page.get_by_role("textbox", name="name of the object")
    name.fill("tip")
    name.press("Enter")
    b.until(lambda: "AbsPoint tip(0, 3, 1);" in b.text())
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("Control+d")
    b.until(lambda: "AbsPoint tip1(0, 3, 1);" in b.text())
    b.page.keyboard.press("Delete")
    b.until(lambda: "AbsPoint tip(" not in b.text())
    # What others are built on stays, and the reason is given.
    click(b, "A")
    b.page.evaluate("() => window.moldloft.settled()")
    b.page.keyboard.press("Delete")
    b.page.locator(".status").get_by_text("cannot be deleted").wait_for()
    assert "AbsPoint A(" in b.text()
    done = ["Rename D to tip", "Duplicate tip", "Delete tip"]
    assert b.hand("steps().done") == done and not b.faults
    for _ in done:
        b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == POINTS)


def test_statements_are_reordered_by_keys_and_by_drag(bench: Callable[..., Bench]) -> None:
    bow, b_row = "AbsPoint A(0, 0, 0);  # bow\n", "AbsPoint B(4, 0, 0);\n"
    c_row, line = "AbsPoint C(0, 3, 0);\n", "Line l(A, B);\n"
    text = bow + b_row + c_row + line
    b = bench(text, "order.sdl")
    page = b.page

    def row(name: str) -> Any:
        return page.get_by_role("treeitem", name=re.compile(f"^{name} "))

    page.get_by_role("treeitem", name="Points").click()
    row("C").focus()
    page.keyboard.press("Alt+ArrowUp")
    b.until(lambda: b.text() == bow + c_row + b_row + line)
    # The row keeps the focus, and the next press moves it on.
    b.until(lambda: row("C").evaluate("e => e === document.activeElement"))
    page.keyboard.press("Alt+ArrowUp")
    b.until(lambda: b.text() == c_row + bow + b_row + line)
    b.hand("settled()")
    row("A").drag_to(row("B"), target_position={"x": 60, "y": 20})
    b.until(lambda: b.text() == c_row + b_row + bow + line)
    b.hand("settled()")
    # A line comes after the points that it reads.
    row("l").drag_to(row("B"), target_position={"x": 60, "y": 2})
    page.locator(".status").get_by_text("cannot be moved there").wait_for()
    assert b.text() == c_row + b_row + bow + line
    done = ["Move C before B", "Move C before A", "Move A behind B"]
    assert b.hand("steps().done") == done and not b.faults
    for _ in done:
        page.keyboard.press("Control+z")
    b.until(lambda: b.text() == text)


def test_a_handle_moves_along_its_axis_or_plane(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    b.page.evaluate("() => window.moldloft.camera_set(-128, 24)")
    b.page.wait_for_timeout(200)
    click(b, "C")
    begin = b.hand("project('C')")

    def pull(handle: str, dx: float, dy: float) -> tuple[float, ...]:
        found_handle = b.page.locator(f'[data-handle="{handle}"]').last
        found_handle.wait_for()
        box = found_handle.bounding_box()
        assert box
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        b.page.mouse.move(x, y)
        b.page.mouse.down()
        before = b.text()
        for k in range(1, 6):
            b.page.mouse.move(x + dx * k / 5, y + dy * k / 5)
        b.until(lambda: b.page.locator(".tip").is_visible())
        b.page.mouse.up()
        b.until(lambda: b.text() != before)
        found = re.search(r"C\(([-\d.]+), ([-\d.]+), ([-\d.]+)", b.text())
        assert found
        return tuple(float(x) for x in found.groups())

    x, y, z = pull("along z", 0, -40)
    assert (x, y) == (4, 3) and z > 0
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == POINTS and b.hand("project('C')") == begin)
    b.page.wait_for_timeout(200)
    x, y, z = pull("in the plane xy", 30, 8)
    assert z == 0 and x != 4 and y != 3
    assert not b.faults


def test_a_shape_is_made_from_nothing_by_the_pointer(bench: Callable[..., Bench]) -> None:
    b = bench("", "new.sdl")
    start = b.page.get_by_role("region", name="start")
    start.get_by_role("button", name="Begin with points").click()
    panel = b.page.get_by_role("region", name="add an object")
    panel.get_by_text("or click in the picture").wait_for()
    b.page.evaluate("() => window.moldloft.camera_set(-90, 90)")
    canvas = b.page.get_by_role("application", name="model").bounding_box()
    assert canvas and not start.is_visible()
    middle = (canvas["x"] + canvas["width"] * 0.6, canvas["y"] + canvas["height"] / 2)
    for k, (dx, dy) in enumerate([(-150, 100), (150, 100), (-150, -100), (150, -100)], 1):
        b.page.mouse.click(middle[0] + dx, middle[1] + dy)
        b.until(lambda k=k: f"AbsPoint P{k}(" in b.text())
    b.page.keyboard.press("Escape")
    for first, second in (("P1", "P2"), ("P3", "P4")):
        panel = form(b, "Line")
        click(b, first)
        click(b, second)
        panel.get_by_role("button", name="Add", exact=True).click()
        b.until(lambda s=second: f", {s});" in b.text())
        b.page.keyboard.press("Escape")
    panel = form(b, "RuledSurf")
    for name in ("c1", "c2"):
        b.page.get_by_role("treeitem", name=re.compile(f"^{name} ")).click()
    panel.get_by_role("button", name="Add", exact=True).click()
    b.until(lambda: "RuledSurf s1(c1, c2);" in b.text())
    b.until(lambda: any(i["kind"] == "patch" for i in b.hand("items()")))
    for _ in b.hand("steps().done"):
        b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == "")
    b.until(start.is_visible)
    # An example is a step of the history, too.
    start.get_by_role("button", name=re.compile("^Bottle")).click()
    b.until(lambda: any(i["kind"] == "patch" for i in b.hand("items()")))
    assert not start.is_visible() and not b.faults


def test_the_list_of_objects_has_a_menu(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    page = b.page
    page.get_by_role("treeitem", name="Points").click()
    row = page.get_by_role("treeitem", name=re.compile("^D "))
    row.click(button="right")
    menu = page.get_by_role("menu", name="D")
    menu.get_by_role("menuitem", name="Hide").click()
    b.until(lambda: not next(i for i in b.hand("items()") if i["object"] == "D")["seen"])
    # By keys: the menu, the row's name as a field, deletion.
    page.keyboard.press("Shift+F10")
    menu.get_by_role("menuitem", name=re.compile("^Show ?Space")).wait_for()
    page.keyboard.press("Escape")
    assert not menu.is_visible()
    page.keyboard.press("F2")
    field = page.get_by_role("textbox", name="new name of D")
    field.fill("tip")
    field.press("Enter")
    b.until(lambda: "AbsPoint tip(0, 3, 1);" in b.text())
    row = page.get_by_role("treeitem", name=re.compile("^tip "))
    row.click()
    page.keyboard.press("Control+d")
    b.until(lambda: "AbsPoint tip1(" in b.text())
    row.focus()
    page.keyboard.press("Delete")
    b.until(lambda: "AbsPoint tip(" not in b.text())
    b.hand("settled()")
    assert b.hand("steps().done") == ["Rename D to tip", "Duplicate tip", "Delete tip"]
    # What is hidden is remembered for this model alone.
    keys = page.evaluate("() => Object.keys(localStorage).filter((k) => k.includes('hidden'))")
    assert keys == ["moldloft.hidden.made.sdl"] and not b.faults


def test_a_file_is_opened_from_the_start_page(bench: Callable[..., Bench], tmp_path: Path) -> None:
    b = bench("", "new.sdl")
    (tmp_path / "other.sdl").write_text(POINTS, encoding="utf-8")
    b.page.get_by_label("open a program").set_input_files(tmp_path / "other.sdl")
    b.until(lambda: b.text() == POINTS)
    b.until(lambda: b.hand("items()"))
    assert b.hand("steps().done") == ["Open other.sdl"] and not b.faults


def test_models_that_were_opened_before_are_opened_again(
    bench: Callable[..., Bench], tmp_path: Path
) -> None:
    first = bench(POINTS, "first.sdl")
    b = bench("", "empty.sdl")
    entry = b.page.get_by_role("button", name=re.compile("first.sdl"))
    entry.click()
    b.page.locator(".status").get_by_text("is open in another workbench").wait_for()
    first.process.terminate()
    first.process.wait(60)
    entry.click()
    b.until(lambda: "first.sdl" in b.page.title())
    b.page.locator("body[data-state=alive]").wait_for(timeout=30_000)
    b.until(lambda: b.text() == POINTS)
    b.page.get_by_role("button", name=re.compile("Commands")).click()
    b.page.get_by_role("combobox", name="command").fill("Open again: empty.sdl")
    b.page.get_by_text(f"Open again: {tmp_path / 'empty.sdl'}").wait_for()
    assert not [fault for fault in b.faults if "WebSocket" not in fault]


SETS = (
    "AbsPoint O(0, 0, 0);\nAbsPoint P(2, 2, 2);\nSet A(cuboid(O, P));\nSet B(set(sphere(P, 1)));\n"
)


def test_sets_are_combined_by_the_pointer(bench: Callable[..., Bench]) -> None:
    b = opened(bench, SETS)
    # Points are folded in the list.
    b.page.get_by_role("treeitem", name=re.compile("Points")).click()

    def combined(operator: str, *names: str) -> None:
        panel = form(b, operator)
        for name in names:
            b.page.get_by_role("treeitem", name=re.compile(f"^{name} ")).click()
        panel.get_by_role("button", name="Add", exact=True).click()

    combined("difference", "A", "B")
    b.until(lambda: "Set part1(A - B);" in b.text())
    b.page.keyboard.press("Escape")
    combined("union", "A")
    b.page.get_by_role("alert").get_by_text("at least 2").wait_for()
    b.page.keyboard.press("Escape")
    # A function: its points are picked, its value has a name.
    combined("cuboid", "O", "P")
    b.until(lambda: "Set part2(cuboid(O, P));" in b.text())
    b.page.keyboard.press("Escape")
    panel = form(b, "sphere")
    b.page.get_by_role("treeitem", name=re.compile("^P ")).click()
    panel.get_by_role("textbox", name="radius").fill("1.5")
    panel.get_by_role("button", name="Add", exact=True).click()
    b.until(lambda: "Field f1(sphere(P, 1.5));" in b.text())
    b.page.keyboard.press("Escape")
    combined("intersection", "part1", "part2", "f1")
    b.until(lambda: "Set part3(part1 & part2 & f1);" in b.text())
    assert not [f for f in b.hand("model.faults") if f["severity"] == "error"]
    assert b.hand("steps().done") == ["Add part1", "Add part2", "Add f1", "Add part3"]
    for _ in range(4):
        b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == SETS)
    assert not b.faults


class Maker:
    """A hand that makes a model from the start page: forms, clicks and numbers, no statement."""

    def __init__(self, bench: Callable[..., Bench], name: str, unit: str, *, half: bool) -> None:
        self.b = bench("", name)
        start = self.b.page.get_by_role("region", name="start")
        start.get_by_role("combobox", name="unit of length").select_option(unit)
        if half:
            start.get_by_role("checkbox").check()
        start.get_by_role("button", name="Begin with points").click()
        self.panel = self.b.page.get_by_role("region", name="add an object")

    def points(self, *places: tuple[float, float, float]) -> None:
        """Points by their numbers, Enter after each; the form is open after the last one."""
        for place in places:
            before = self.b.text()
            for axis, value in zip("xyz", place, strict=True):
                self.panel.get_by_role("textbox", name=axis, exact=True).fill(f"{value:g}")
            self.panel.get_by_role("textbox", name="z", exact=True).press("Enter")
            self.b.until(lambda before=before: self.b.text() != before)

    def make(self, kind: str, *parents: str, **given: str) -> str:
        """An object of a kind on parents that are picked in the list; its name."""
        self.b.page.keyboard.press("Escape")
        panel = form(self.b, kind)
        panel.get_by_text(kind, exact=True).wait_for()
        folded = self.b.page.locator('.tree [data-key=":Points"][aria-expanded=false]')
        if folded.count():
            folded.click()
        for parent in parents:
            row = self.b.page.get_by_role("treeitem", name=re.compile(rf"^{re.escape(parent)} "))
            row.click()
        hidden = [n for n in given if not panel.get_by_role("textbox", name=n).is_visible()]
        if hidden and (options := panel.get_by_text("Options")).count():
            options.click()
        for name, value in given.items():
            panel.get_by_role("textbox", name=name, exact=True).fill(value)
        before = {o["name"] for o in self.b.hand("model.objects")}
        panel.get_by_role("button", name="Add", exact=True).click()

        def new() -> list[str]:
            return [o["name"] for o in self.b.hand("model.objects") if o["name"] not in before]

        [made] = self.b.until(new)
        self.b.page.keyboard.press("Escape")
        return str(made)

    def done(self, seen: int) -> None:
        """All that was made is there, without errors, and is taken back by as many steps."""
        b = self.b
        patches = b.until(lambda: [i for i in b.hand("items()") if i["kind"] == "patch"])
        assert len(patches) == seen
        assert not [f for f in b.hand("model.faults") if f["severity"] == "error"]
        assert not b.faults
        for _ in b.hand("steps().done"):
            b.page.keyboard.press("Control+z")
        b.until(lambda: b.text() == "")


def test_a_hull_with_a_keel_is_made_from_the_start_page(bench: Callable[..., Bench]) -> None:
    m = Maker(bench, "boat.sdl", "m", half=True)
    sections = []
    for x, beam, keel in ((0, 0.02, 0.5), (4, 1.4, -0.5), (8, 1.5, -0.45), (11, 1.0, 0.2)):
        m.points((x, beam, 1.2), (x, beam, 0.3), (x, beam / 2, keel), (x, 0, keel))
    for k in range(4):
        names = [f"P{4 * k + j}" for j in (1, 2, 3, 4)]
        sections.append(m.make("BCurve", *names, degree="2"))
    hull = m.make("CLoftSurf", *sections)
    # The keel is hung below: a root and a tip, each a foil of three points, and a surface between.
    form(m.b, "AbsPoint")
    m.points((5, 0, -0.4), (6, 0.12, -0.4), (7.5, 0, -0.4), (5.6, 0, -1.8), (6.3, 0.1, -1.8))
    m.points((7.3, 0, -1.8))
    root = m.make("BCurve", "P17", "P18", "P19", degree="2")
    tip = m.make("BCurve", "P20", "P21", "P22", degree="2")
    m.make("RuledSurf", root, tip)
    assert hull in m.b.text()
    m.done(2)


def test_a_bottle_is_made_from_the_start_page(bench: Callable[..., Bench]) -> None:
    m = Maker(bench, "bottle.sdl", "mm", half=False)
    m.points((0, 0, 0), (30, 0, 0), (34, 0, 60), (33, 0, 130), (12, 0, 160), (12, 0, 200))
    m.points((0, 0, 200))
    side = m.make("BCurve", *(f"P{k}" for k in range(1, 7)), degree="3")
    axis = m.make("Line", "P1", "P7")
    m.make("RevSurf", side, axis)
    m.done(1)


def test_a_propeller_is_made_from_the_start_page(bench: Callable[..., Bench]) -> None:
    m = Maker(bench, "propeller.sdl", "mm", half=False)
    # The shaft's ends, the hub's side, and two edges of a blade.
    m.points((-60, 0, 0), (60, 0, 0), (-60, 0, 40), (60, 0, 40))
    m.points((-30, -22, 34), (-50, -80, 110), (-40, -60, 190), (0, 0, 240))
    m.points((30, 22, 34), (45, 70, 110), (35, 60, 190))
    shaft = m.make("Line", "P1", "P2")
    side = m.make("Line", "P3", "P4")
    m.make("RevSurf", side, shaft)
    leading = m.make("CCurve", "P5", "P6", "P7", "P8")
    trailing = m.make("CCurve", "P9", "P10", "P11", "P8")
    blade = m.make("RuledSurf", leading, trailing)
    for k in range(1, 5):
        m.make("RotatSurf", blade, shaft, angle=f"{0.4 * k:g} * PI")
    m.done(6)
