"""Pen, fingers and palm on the drawing board and at the fairing desk; choices that are dragged."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from board_by_hand import BoardHand
from desk_by_hand import DeskHand
from page_in_browser import needs_page
from pen_and_fingers import Tablet

pytestmark = needs_page

#: A square of a cross section, each corner a little beside its place.
SQUARE = """SKETCH P 2D XZ
POINT 1 AT 0 0
POINT 2 AT 200 2
POINT 3 AT 201 150
POINT 4 AT 1 149
LINE 1 FROM 1 TO 2
LINE 2 FROM 2 TO 3
LINE 3 FROM 3 TO 4
LINE 4 FROM 4 TO 1
"""
POINTS = "x,y\n" + "".join(f"{k},{0.1 * k * k + 0.3 * (k % 2)}\n" for k in range(12))


@pytest.fixture
def room(tmp_path: Path, browser: Any) -> Iterator[Callable[..., Any]]:
    made: list[Any] = []

    def make(kind: type[Any], text: str, name: str) -> Any:
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        made.append(kind(path, browser))
        return made[-1]

    yield make
    for each in made:
        each.close()


def drag(b: BoardHand, start: tuple[float, float], by: tuple[float, float]) -> None:
    """Press at a place of the drawing and let go so many pixels beside it."""
    x, y = b.at(*start)
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    b.page.mouse.move(x + by[0] / 2, y + by[1] / 2)
    b.page.mouse.move(x + by[0], y + by[1])
    b.page.mouse.up()
    b.settle()


def places(b: BoardHand) -> dict[int, tuple[float, float]]:
    return {p[0]: (p[1], p[2]) for p in b.settle()["drawn"]["points"]}


def test_lines_and_the_whole_choice_are_dragged(room: Callable[..., Any]) -> None:
    b = room(BoardHand, SQUARE, "part.skt")
    before = places(b)
    b.key("v")
    # A pixel of the screen on the page.
    (x0, _), (x1, _) = b.at(0, 0), b.at(100, 0)
    pixel = 100 / (x1 - x0)
    side = ((before[2][0] + before[3][0]) / 2, before[2][1] + 0.3 * 150)
    drag(b, side, (40, -20))
    after = places(b)
    for k in (2, 3):
        by = (after[k][0] - before[k][0], after[k][1] - before[k][1])
        assert by == pytest.approx((40 * pixel, 20 * pixel), abs=1.1 * pixel), k
    assert after[1] == before[1] and after[4] == before[4]
    # Numbers are changed where they are written, as one step.
    assert b.text().count("POINT 2 AT") == 1 and len(b.hand("steps().done")) == 1
    b.key("Control+z")
    b.until(lambda: places(b) == before)
    assert b.text() == SQUARE
    # A line and a point beside it: the drag of either moves all three, and no point is welded.
    b.click(*side)
    b.page.keyboard.down("Shift")
    b.click(*before[1])
    b.page.keyboard.up("Shift")
    drag(b, before[1], (-30, 12))
    after = places(b)
    for k in (1, 2, 3):
        by = (after[k][0] - before[k][0], after[k][1] - before[k][1])
        assert by == pytest.approx((-30 * pixel, -12 * pixel), abs=1.1 * pixel), k
    assert after[4] == before[4] and "WELD" not in b.text()
    b.key("Control+z")
    b.until(lambda: places(b) == before)
    # While it moves it is seen, and the text waits.
    x, y = b.at(*before[1])
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    b.page.mouse.move(x + 60, y)
    b.until(lambda: b.look()["drawn"]["points"][0][1] > before[1][0] + 30 * pixel)
    assert b.text() == SQUARE
    b.page.mouse.up()
    b.key("Control+z")
    assert not b.faults


def test_lines_of_a_lit_plane_are_lit(room: Callable[..., Any]) -> None:
    b = room(BoardHand, SQUARE, "part.skt")
    b.settle()
    mark = next(m for m in b.look()["drawn"]["next"] if m["axis"] == "X")
    box = b.page.locator(f"[data-mark='{mark['name']}'] rect").bounding_box()
    assert box
    b.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    lit = b.page.locator("[data-line].from, [data-line].to")
    b.until(lambda: lit.count() == 2)
    # Both upright sides, each with the ends that are lit.
    ends = {ln[0]: ln[1:3] for ln in b.look()["drawn"]["lines"]}
    found = {int(line.get_attribute("data-line") or 0) for line in lit.all()}
    assert found == {2, 4}
    for line, kind in ((2, "to"), (4, "from")):
        assert b.page.locator(f"[data-line='{line}'].{kind}").count() == 1
        for end in ends[line]:
            assert b.page.locator(f"[data-point='{end}'].{kind}").count() == 1


def test_a_pen_draws_and_fingers_move_the_board(room: Callable[..., Any]) -> None:
    b = room(BoardHand, "SKETCH P 2D XZ\nPOINT 1 AT -90 -90\n", "part.skt")
    b.settle()
    tablet = Tablet(b.page)
    # Before a pen was seen a finger draws.
    tablet.finger(1, b.at(0, 0))
    tablet.finger(1, b.at(60, 2))
    tablet.finger(1, b.at(100, 2))
    tablet.lift(1)
    assert len(b.settle()["drawn"]["lines"]) == 1
    # A hand that is down when the pen arrives stops drawing, and does not disturb the pen.
    tablet.finger(1, b.at(150, 20))
    tablet.finger(1, b.at(150, 80))
    a, c = b.at(0, 60), b.at(100, 61)
    tablet.pen("pressed", a)
    tablet.finger(1, b.at(160, 140))
    tablet.pen("moved", b.at(50, 60))
    tablet.finger(1, b.at(170, 150))
    tablet.pen("moved", c)
    tablet.finger(2, b.at(190, 150))
    tablet.pen("released", c)
    tablet.lift(1)
    tablet.lift(2)
    drawn = b.settle()["drawn"]
    assert len(drawn["lines"]) == 2
    new = {p[0]: p[1:3] for p in drawn["points"]}
    assert all(math.dist(new[drawn["lines"][1][k]], (x, 60)) < 4 for k, x in ((1, 0), (2, 100)))
    # A palm that comes down beside a resting pen, however late, is nothing.
    text = b.text()
    tablet.pen("pressed", b.at(0, 120))
    tablet.pen("moved", b.at(50, 120))
    b.page.wait_for_timeout(700)
    origin = b.at(0, 0)
    tablet.finger(1, b.at(150, -40))
    tablet.finger(1, b.at(180, 40))
    assert b.at(0, 0) == origin
    tablet.pen("released", b.at(100, 120))
    tablet.lift(1)
    assert len(b.settle()["drawn"]["lines"]) == 3 and b.at(0, 0) == origin
    text = b.text()
    # Then one finger pans, and two pinch.
    b.page.wait_for_timeout(700)
    x, y = b.at(140, 100)
    tablet.finger(1, (x, y))
    tablet.finger(1, (x + 20, y + 10))
    tablet.finger(1, (x + 40, y + 30))
    b.until(lambda: b.at(0, 0) == pytest.approx((origin[0] + 40, origin[1] + 30), abs=0.1))
    tablet.finger(2, (x + 140, y + 30))
    wide = b.at(100, 0)[0] - b.at(0, 0)[0]
    tablet.finger(2, (x + 240, y + 30))
    b.until(lambda: b.at(100, 0)[0] - b.at(0, 0)[0] == pytest.approx(2 * wide, rel=1e-6))
    tablet.lift(2)
    tablet.lift(1)
    # A contact as wide as a palm is one.
    origin = b.at(0, 0)
    tablet.finger(1, (x, y), wide=50)
    tablet.finger(1, (x + 40, y), wide=50)
    tablet.lift(1)
    assert b.at(0, 0) == origin and b.settle() and b.text() == text
    assert not b.faults


def test_the_same_contacts_at_the_desk(room: Callable[..., Any]) -> None:
    d = room(DeskHand, "AbsPoint A(0, 0, 0);\n", "boat.sdl")
    d.table("line.csv", POINTS)
    tablet = Tablet(d.page)
    before = d.look()
    # A finger that drags a point gives it up when the pen arrives.
    x, y = d.at(6)
    tablet.finger(1, (x, y))
    tablet.finger(1, (x, y - 20))
    tablet.finger(1, (x, y - 40))
    d.until(lambda: d.look()["facts"]["detail"]["data"] != before["facts"]["detail"]["data"])
    tablet.pen("hovers", d.at(9))
    state = d.settle()
    assert state["log"] == [] and state["facts"]["detail"] == before["facts"]["detail"]
    x, y = d.at(3)
    tablet.pen_stroke(d.at(9), (d.at(9)[0], d.at(9)[1] - 30))
    # The palm that was down, and one that comes at once.
    tablet.finger(1, (x + 20, y + 20))
    tablet.lift(1)
    tablet.finger(2, (x, y))
    tablet.finger(2, (x + 30, y))
    tablet.lift(2)
    state = d.settle()
    assert len(state["log"]) == 1 and state["log"][0].startswith("move 9 ")
    assert d.at(3) == (x, y)
    # Then a finger that pans, over a point as well, and two that pinch.
    d.page.wait_for_timeout(700)
    tablet.finger(1, (x, y))
    tablet.finger(1, (x + 20, y))
    tablet.finger(1, (x + 50, y - 10))
    d.until(lambda: d.at(3) == pytest.approx((x + 50, y - 10), abs=0.1))
    tablet.finger(2, (x + 150, y - 10))
    scale = d.look()["scale"]
    tablet.finger(2, (x + 200, y - 10))
    d.until(lambda: d.look()["scale"] == pytest.approx(1.5 * scale, rel=1e-6))
    tablet.lift(2)
    tablet.lift(1)
    assert len(d.settle()["log"]) == 1
    assert not d.faults
