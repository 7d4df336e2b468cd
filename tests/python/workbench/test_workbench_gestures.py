"""Hands on the picture: locks, surfaces, snaps, typed numbers, keys, measures, planes of blocks."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pytest

from page_in_browser import PLATE, Bench, needs_page

pytestmark = needs_page

POINTS = "AbsPoint P(1, 2, 3);\nAbsPoint Q(9, 0, 0);\nAbsPoint R(0, 9, 9);\n"


def opened(make: Callable[..., Bench], text: str = POINTS, side: str = "-90, 90") -> Bench:
    b = make(text, "points.sdl")
    b.page.evaluate(f"() => window.moldloft.camera_set({side})")
    b.page.wait_for_timeout(200)
    return b


def place(b: Bench, name: str = "P") -> tuple[float, ...]:
    found = re.search(rf"{name}\(([-\d.]+), ([-\d.]+), ([-\d.]+)", b.text())
    assert found, b.text()
    return tuple(float(x) for x in found.groups())


def test_a_drag_that_is_over_is_over(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    mouse = b.page.mouse
    for k in range(6):
        # Taken back, and the button let go at once: nothing of it is written.
        x, y = b.hand("project('P')")
        mouse.move(x, y)
        mouse.down()
        mouse.move(x + 30, y + 5 * k)
        mouse.move(x + 45, y)
        b.page.keyboard.press("Escape")
        mouse.up()
        # Before that the point may still be on its way there and back.
        b.page.evaluate("() => window.moldloft.settled()")
        b.until(lambda at=(x, y): b.hand("project('P')") == pytest.approx(at, abs=1e-6))
        assert b.text() == POINTS
    # A flick that ends before the engine has heard of its beginning counts whole.
    x, y = b.hand("project('P')")
    mouse.move(x, y)
    mouse.down()
    mouse.move(x + 25, y)
    mouse.move(x + 50, y)
    mouse.up()
    b.until(lambda: "P(1," not in b.text())
    b.until(lambda: abs(b.hand("project('P')")[0] - (x + 50)) < 2)
    assert place(b)[1:] == (2, 3) and not b.faults


def test_a_plane_keeps_its_coordinate(bench: Callable[..., Bench]) -> None:
    b = opened(bench, side="-128, 24")
    x, y = b.hand("project('P')")
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    b.page.mouse.move(x + 10, y)
    b.page.keyboard.press("Shift+Z")
    for k in range(1, 6):
        b.page.mouse.move(x + 12 * k, y + 6 * k)
        b.page.wait_for_timeout(20)
    b.page.mouse.up()
    b.until(lambda: "P(1, 2, 3)" not in b.text())
    px, py, pz = place(b)
    assert pz == 3 and px != 1 and py != 2


def test_a_point_is_laid_on_the_surface_below_the_pointer(bench: Callable[..., Bench]) -> None:
    b = opened(bench, PLATE)
    x, y = b.hand("project('P')")
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    b.page.mouse.move(x + 5, y + 5)
    b.page.keyboard.press("s")
    b.page.mouse.move(x + 20, y + 15)
    b.page.mouse.move(x + 25, y + 20)
    b.page.mouse.up()
    b.until(lambda: "P(0.5, 0.5, 1)" not in b.text())
    px, py, pz = place(b)
    assert abs(pz) < 1e-2 and 0.5 < px < 1 and 0 < py < 0.5


def test_points_snap_to_points_and_alt_suspends_it(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    for key, same in ((None, True), ("Alt", False)):
        x, y = b.hand("project('P')")
        to_x, to_y = b.hand("project('Q')")
        b.page.mouse.move(x, y)
        b.page.mouse.down()
        if key:
            b.page.keyboard.down(key)
        for share in (0.3, 0.7, 1.0):
            b.page.mouse.move(x + share * (to_x + 5 - x), y + share * (to_y - 4 - y))
            b.page.wait_for_timeout(30)
        b.page.mouse.up()
        if key:
            b.page.keyboard.up(key)
        b.until(lambda: "P(1, 2, 3)" not in b.text())
        assert (place(b) == (9, 0, 0)) == same, b.text()
        b.page.get_by_role("textbox", name="program").focus()
        b.page.keyboard.press("Control+z")
        b.until(lambda: b.text() == POINTS)
        b.until(lambda at=(x, y): b.hand("project('P')") == pytest.approx(at, abs=1e-6))


def test_a_number_is_typed_while_dragging(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    x, y = b.hand("project('P')")
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    b.page.get_by_text("digits enter a value").wait_for()
    b.page.mouse.move(x + 8, y)
    b.page.keyboard.press("y")
    b.page.keyboard.press("7")
    entry = b.page.get_by_role("textbox", name="value", exact=True)
    assert entry.get_attribute("placeholder") == "P.position.y" or "y" in entry.get_attribute(
        "placeholder"
    )
    # The pointer does not speak while a number is typed, and letting go does not end it.
    b.page.mouse.move(x + 60, y + 60)
    b.page.mouse.up()
    b.page.keyboard.type(".25")
    b.page.keyboard.press("Enter")
    b.until(lambda: "7.25" in b.text())
    assert place(b) == (1, 7.25, 3)


def test_a_point_is_moved_by_keys_alone(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    item = b.page.get_by_role("tree", name="objects").get_by_role("treeitem", name="Points")
    if item.get_attribute("aria-expanded") == "false":
        item.press("Enter")
    b.page.get_by_role("treeitem", name=re.compile("^P")).last.click()
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("g")
    b.page.get_by_text("arrows move it").wait_for()
    for _ in range(3):
        b.page.keyboard.press("Shift+ArrowRight")
    b.page.keyboard.press("Enter")
    b.until(lambda: b.text() != POINTS)
    moved = [n for n in "PQR" if f"{n}(" in b.text() and f"AbsPoint {n}" in b.text()]
    assert len(moved) == 3
    kept = b.text()
    b.page.keyboard.press("g")
    b.page.get_by_text("arrows move it").wait_for()
    b.page.keyboard.press("ArrowUp")
    b.page.keyboard.press("Escape")
    b.page.wait_for_timeout(300)
    assert b.text() == kept and not b.faults


def test_distances_and_angles_are_measured(bench: Callable[..., Bench]) -> None:
    b = opened(bench, "AbsPoint P(0, 0, 0);\nAbsPoint Q(4, 0, 0);\nAbsPoint R(4, 3, 0);\n")
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("d")
    for name in "PQ":
        b.page.mouse.click(*b.hand(f"project('{name}')"))
    b.page.get_by_text("distance 4").wait_for()
    b.page.mouse.click(*b.hand("project('R')"))
    b.page.get_by_text("angle 90°").wait_for()
    assert b.text().startswith("AbsPoint P(0, 0, 0)")


HALF = (
    'Model info(units = "m kg");\n'
    "param float beam = 4 in [2, 6];\nparam float depth = 3 in [1, 5];\n"
    "AbsPoint P(1, beam / 2, 1.5);\nAbsPoint Q(0, 0, 0);\nAbsPoint R(3, 3, 3);\n"
)


def by(b: Bench, name: str, dx: float, dy: float) -> tuple[float, float]:
    """Drags a point in steps; where the pointer is let go."""
    x, y = b.hand(f"project('{name}')")
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    b.page.get_by_text("lock an axis").wait_for()
    for k in range(1, 6):
        b.page.mouse.move(x + dx * k / 5, y + dy * k / 5)
        b.page.wait_for_timeout(20)
    return x + dx, y + dy


def test_what_own_numbers_cannot_follow_a_parameter_does(bench: Callable[..., Bench]) -> None:
    b = opened(bench, HALF)
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("4")
    x, y = by(b, "P", 25, -15)
    b.until(
        lambda: abs(b.hand("project('P')")[0] - x) < 2 and abs(b.hand("project('P')")[1] - y) < 2
    )
    offered = b.page.get_by_role("group", name="what to move")
    assert offered.get_by_role("button", pressed=True).inner_text() == "beam"
    b.page.mouse.up()
    b.until(lambda: b.text() != HALF)
    assert "P(1, beam / 2, " in b.text() and "beam = 4 in" not in b.text()
    assert "depth = 3 in" in b.text() and not b.faults
    assert b.hand("steps().done") == ["Drag P"]
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == HALF and b.param("beam") == 4)
    # At the end of the range it stays behind, and the reason is given.
    by(b, "P", 300, 0)
    b.page.get_by_text("beam is at the end of its range").wait_for()
    b.page.keyboard.press("Escape")
    b.page.mouse.up()
    b.until(lambda: b.param("beam") == 4)
    assert b.text() == HALF


def test_chosen_parameters_share_a_motion(bench: Callable[..., Bench]) -> None:
    text = (
        "param float beam = 4 in [0, 8];\nparam float lift = 1 in [0, 8];\n"
        "param float rise = 1 in [0, 8];\n"
        "AbsPoint P(0, 0, beam / 2 + lift + rise);\nAbsPoint Q(0, 4, 8);\nAbsPoint R(4, 0, 0);\n"
    )
    b = opened(bench, text)
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("4")
    b.page.mouse.click(*b.hand("project('P')"))
    b.page.keyboard.press("g")
    for _ in range(3):
        b.page.keyboard.press("Shift+ArrowUp")
    offered = b.page.get_by_role("group", name="what to move")
    b.until(lambda: offered.is_visible())
    on = offered.get_by_role("button", pressed=True)
    [alone] = on.all_inner_texts()
    others = sorted({"beam", "lift", "rise"} - {alone})
    before = b.param(others[0])
    # A second chip: both pay, each by what moves the point and by its range.
    offered.get_by_role("button", name=others[0], exact=True).click()
    b.until(lambda: sorted(on.all_inner_texts()) == sorted([alone, others[0]]))
    b.until(lambda: b.param(others[0]) > before)
    # By keys: Tab to the chips, Space takes the first from them, arrows move on.
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("Tab")
    while b.page.evaluate("() => document.activeElement.textContent") != alone:
        b.page.keyboard.press("Tab")
    b.page.keyboard.press("Space")
    b.until(lambda: on.all_inner_texts() == [others[0]])
    start = {"beam": 4.0, "lift": 1.0, "rise": 1.0}
    b.until(lambda: b.param(alone) == start[alone])
    b.page.keyboard.press("ArrowUp")
    b.page.keyboard.press("Enter")
    b.until(lambda: b.text() != text)
    b.hand("settled()")
    assert b.hand("steps().done") == ["Drag P"]
    assert b.param(others[0]) > start[others[0]]
    assert all(b.param(n) == start[n] for n in (alone, others[1]))
    assert not b.faults


def test_a_number_along_the_line_of_sight_stays(bench: Callable[..., Bench]) -> None:
    text = "AbsPoint Q(0, -2, -2);\nAbsPoint R(4, 4, 4);\nAbsPoint P(1, R.y + Q.y, R.z + Q.z);\n"
    b = opened(bench, text)
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("4")
    by(b, "P", 40, 10)
    b.page.get_by_text("does not move that way in this view").wait_for()
    b.page.mouse.up()
    b.page.evaluate("() => window.moldloft.settled()")
    assert b.text() == text and not b.hand("steps().done.length")


def test_numbers_are_typed_as_expressions(bench: Callable[..., Bench]) -> None:
    b = opened(bench, HALF)
    field = b.page.get_by_role("textbox", name="beam, value", exact=True)
    field.fill("depth + 2^0.5 * 0")
    field.press("Enter")
    b.until(lambda: "beam = 3 in" in b.text())
    # A field shows what the model has, never what it refused.
    for wrong, said in (("25", "out of its range"), ("nothing", "nothing")):
        field.fill(wrong)
        field.press("Enter")
        b.page.locator(".status").get_by_text(said).wait_for()
        b.until(lambda: field.input_value() == "3")
    assert "beam = 3 in" in b.text()
    field.fill("2500 mm")
    field.press("Enter")
    b.until(lambda: "beam = 2.5 in" in b.text())


SOLID = (
    "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(2, 1, 0);\n"
    "Line l(A, B); Line m(C, D); RuledSurf s(l, m);\n"
    "AbsPoint E(0, 0, 1); AbsPoint F(2, 0, 1); AbsPoint G(0, 1, 1); AbsPoint H(2, 1, 1);\n"
    "Line n(E, F); Line o(G, H); RuledSurf t(n, o);\nRuledSolid b(s, t);\n"
)


def test_planes_of_a_block_show_its_cells(bench: Callable[..., Bench]) -> None:
    b = opened(bench, SOLID, "-128, 24")
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("b")
    group = b.page.get_by_role("group", name="plane of a block")
    group.get_by_text("no folded cell").wait_for()
    slider = group.get_by_role("slider")
    last = int(slider.get_attribute("max"))
    assert last >= 1 and slider.input_value() == "0"
    slider.focus()
    b.page.keyboard.press("End")
    b.until(lambda: slider.get_attribute("aria-valuetext") == f"k = {last + 1} of {last + 1}")
    # The top turned over: cells are folded, and counted.
    program = b.page.get_by_role("textbox", name="program")
    program.focus()
    b.page.keyboard.press("Control+End")
    b.page.evaluate("() => 0")
    b.page.keyboard.type("RuledSolid c(t, s);\n")
    group.get_by_text("folded cells").wait_for()
    group.get_by_role("button").click()
    b.until(lambda: group.count() == 0 or not group.is_visible())
    assert not b.faults


def test_every_colour_is_drawn(bench: Callable[..., Bench]) -> None:
    b = bench()
    colour = b.page.get_by_role("combobox", name="colour")
    seen: dict[str, Any] = {}
    for name in ("patches", "zebra", "reflection", "isophotes", "highlight"):
        colour.select_option(name)
        b.page.wait_for_timeout(250)
        seen[name] = b.page.evaluate(
            "() => { const c = document.querySelector('.view canvas'); "
            "return c.toDataURL().length + ':' + c.toDataURL().slice(-400) }"
        )
    assert len(set(seen.values())) == len(seen)
    assert not b.faults
