"""The picture of the solid by hand: sections on its faces, and numbers by their arrows."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from board_by_hand import BoardHand
from moldloft import Sketch
from moldloft.workbench.board import Board, answered
from page_in_browser import needs_page

pytestmark = needs_page

BOX = """SKETCH PART 2D XY
POINT 1 AT 0 0; POINT 2 AT 100 0; POINT 3 AT 100 60; POINT 4 AT 0 60
POLYLINE 1 2 3 4 CLOSE
DIMENSION W X 1 TO 2 = 10; DIMENSION H Y 1 TO 4 = 6
EXTRUDE 4
"""
FACES = {"1": "XZ", "2": "XY", "3": "YZ", "4": "YZ", "5": "XZ", "6": "XY"}
OWN = ("id", "version", "edits", "kind")


@pytest.fixture
def board(tmp_path: Path, browser: Any) -> Iterator[Callable[..., BoardHand]]:
    made: list[BoardHand] = []

    def begin(text: str) -> BoardHand:
        path = tmp_path / "part.skt"
        path.write_text(text, encoding="utf-8")
        made.append(BoardHand(path, browser))
        made[-1].settle()
        return made[-1]

    yield begin
    for b in made:
        b.close()


def handle(b: BoardHand, name: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """Where an arrow is on the screen, and what a change of its value by 1 is there."""
    found = b.settle()
    one = next(h for h in found["handles"] if h["name"] == name)
    (x, y), (left, top) = one["at"], found["origin"]
    return (left + x, top + y), tuple(one["unit"])


def pull(b: BoardHand, name: str, change: float, drop: bool = True) -> None:
    """Drags an arrow until its value has changed that much."""
    (x, y), (u, v) = handle(b, name)
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    b.page.mouse.move(x + change * u, y + change * v, steps=4)
    if drop:
        b.page.mouse.up()
        b.settle()


def pick(b: BoardHand, face: str) -> None:
    """Clicks in the picture until the face is the chosen one, without an arrow in the way."""
    box = b.page.locator(".board-solid").bounding_box()
    assert box
    chance = random.Random(7)
    middle = box["x"] + box["width"] / 2
    for k in range(400):
        if k % 25 == 24:
            # Not seen from there: the picture is turned beside the solid.
            b.page.mouse.move(middle, box["y"] + box["height"] - 12)
            b.page.mouse.down()
            b.page.mouse.move(middle + 80, box["y"] + box["height"] - 2, steps=3)
            b.page.mouse.up()
        x = box["x"] + box["width"] * chance.uniform(0.1, 0.9)
        y = box["y"] + box["height"] * chance.uniform(0.1, 0.85)
        b.page.mouse.move(x, y)
        if b.page.evaluate(f"() => document.elementFromPoint({x}, {y}).closest('[data-handle]')"):
            continue
        b.page.mouse.click(x, y)
        found = b.look()["face"]
        if found and found["name"] == face:
            return
        if found:
            b.page.mouse.click(x, y)
    raise AssertionError(f"face {face} is not seen")


def rectangle(b: BoardHand, low: tuple[float, float], high: tuple[float, float]) -> None:
    """A rectangle on the face, by the coordinates of the section, drawn with noise."""
    axes = b.settle()["drawn"]["axes"]
    (_, first), (_, second) = sorted(axes.items())
    chance = random.Random(3)

    def at(p: float, q: float) -> tuple[float, float]:
        u, v = (p * a + q * c for a, c in zip(first, second, strict=True))
        return u + chance.uniform(-0.4, 0.4), v + chance.uniform(-0.4, 0.4)

    b.key("d")
    ends = [low, (high[0], low[1]), high, (low[0], high[1]), low]
    b.chain(*(at(*end) for end in ends))


def dimensioned(b: BoardHand, *values: float) -> None:
    b.page.locator("svg.paper").focus()
    b.key("Tab")
    for value in values:
        assert b.look()["open"]
        b.page.keyboard.type(str(value))
        b.key("Enter")
    assert b.settle()["drawn"]["next"] == []


def answer(b: BoardHand, key: str, words: str) -> None:
    b.page.locator("svg.paper").focus()
    b.key(key)
    b.page.keyboard.type(words)
    b.key("Enter")
    b.settle()


def drawn(b: BoardHand) -> dict[str, Any]:
    return {k: v for k, v in b.settle()["drawn"].items() if k not in OWN}


def replayed(b: BoardHand) -> None:
    """A board that has only the text shows the same, and a sketch of it has the same bits."""
    shown = drawn(b)
    request = {"kind": "board_open", "text": b.text(), "object": shown["object"], "id": 1}
    reply = json.loads(json.dumps(answered(Board(), request)))
    assert {k: v for k, v in reply.items() if k not in OWN} == shown
    sketch = Sketch()
    sketch.run(b.text())
    again = Sketch()
    again.run(sketch.text)
    assert again.objects == sketch.objects
    solid = b.look()["solid"]
    if solid["made"] and solid["exact"]:
        assert sketch.objects[shown["object"]]["volume"] == solid["volume"]


def test_a_section_is_drawn_on_a_face_and_raised(board: Callable[..., BoardHand]) -> None:
    b = board(BOX)
    b.key("v")
    pick(b, "6")
    b.page.get_by_role("button", name="Sketch on face 6").click()
    b.until(lambda: b.look()["drawn"]["object"] == "FACE1")
    assert b.text().endswith("SKETCH FACE1 2D XY ON PART 6\nAXES 0 90 225 SCALE 10 10 10\n")
    place = b.settle()["drawn"]["place"]
    assert (place["body"], place["face"], place["outward"]) == ("PART", "6", 1)
    assert len(place["border"]) == 4
    rectangle(b, (2, 1), (6, 4))
    # The first point is where it was drawn.
    written = next(ln for ln in b.text().splitlines() if "REFERENCE 1" in ln)
    x, y = map(float, written.split("REFERENCE 1 ")[1].split())
    assert abs(x - 2) < 0.15 and abs(y - 1) < 0.15
    dimensioned(b, 4, 3)
    answer(b, "e", "2")
    look = b.look()
    assert look["drawn"]["object"] == "PART1" and look["solid"]["exact"]
    assert look["solid"]["volume"] == pytest.approx(240 + 4 * 3 * 2, rel=1e-12)
    assert b.text().endswith("EXTRUDE FACE1 2 INTO PAD1\nUNION PART PAD1 INTO PART1\n")
    replayed(b)

    # A pocket in a side of the result.
    b.key("v")
    pick(b, '"PART.1"')
    b.page.locator("svg.paper").focus()
    b.key("s")
    b.until(lambda: b.look()["drawn"]["object"] == "FACE2")
    assert 'SKETCH FACE2 2D XZ ON PART1 "PART.1"\n' in b.text()
    assert b.settle()["drawn"]["place"]["outward"] == -1
    rectangle(b, (7, 1), (9, 3))
    dimensioned(b, 2, 2)
    answer(b, "k", "1.5")
    volume = 240 + 4 * 3 * 2 - 2 * 2 * 1.5
    assert b.look()["solid"]["volume"] == pytest.approx(volume, rel=1e-12)
    assert b.text().endswith("EXTRUDE FACE2 1.5 INTO POCKET1\nCUT PART1 POCKET1 INTO PART2\n")
    replayed(b)

    # Undone to the beginning and done again; the page is loaded again.
    end, steps = b.text(), b.hand("steps().done")
    for _ in steps:
        b.key("Control+z")
    b.settle()
    assert b.text() == BOX
    for _ in steps:
        b.key("Control+Shift+z")
    b.settle()
    assert b.text() == end
    b.reload()
    b.page.get_by_label("object", exact=True).select_option("PART2")
    b.until(lambda: b.look()["drawn"]["object"] == "PART2")
    assert b.settle()["solid"]["volume"] == pytest.approx(volume, rel=1e-12)

    # A later dimension moves the face: pad and pocket go with it, and the pocket stays a pocket.
    b.key("v")
    pull(b, "PART.D1", 2)
    found = b.look()["solid"]
    assert found["volume"] == pytest.approx(volume + 120, rel=1e-9)
    assert "\nEXTRUDE 6\n" in b.text()
    assert len(b.hand("steps().done")) == 1
    assert not b.faults, b.faults
    replayed(b)


def test_typing_is_drawing_on_a_face(board: Callable[..., BoardHand]) -> None:
    b = board(BOX)
    b.key("v", "b")
    assert b.look()["face"]["name"] == "1"
    b.key("Shift+B")
    assert b.look()["face"]["name"] == "6"
    b.key("s")
    b.until(lambda: b.look()["drawn"]["object"] == "FACE1")
    rectangle(b, (2, 1), (6, 4))
    dimensioned(b, 4, 3)
    answer(b, "e", "2")
    by_hand = b.text()
    facts = drawn(b)
    # The same lines, typed into the editor.
    b.page.locator(".cm-content").click()
    b.page.keyboard.press("Control+A")
    b.page.keyboard.press("Delete")
    b.page.keyboard.insert_text(by_hand)
    b.settle()
    assert b.text() == by_hand
    b.until(lambda: b.look()["drawn"]["objects"] == facts["objects"])
    assert drawn(b) == facts
    assert not b.faults, b.faults


@pytest.mark.parametrize("face", ["4", "6"])
def test_faces_of_a_turned_body(face: str, board: Callable[..., BoardHand]) -> None:
    b = board(BOX + "ROTATE PART Y 30 FEATURE INTO TURNED\n")
    assert b.settle()["drawn"]["object"] == "TURNED"
    b.key("v")
    pick(b, face)
    b.key("s")
    b.until(lambda: b.look()["drawn"]["object"] == "FACE1")
    place = b.settle()["drawn"]["place"]
    columns = place["columns"]
    axis = {"4": 0, "6": 2}[face]
    turn = math.radians(30)
    normal = [(math.cos(turn), 0, -math.sin(turn)), None, (math.sin(turn), 0, math.cos(turn))][axis]
    assert columns[axis] == pytest.approx(normal, abs=1e-12)
    # The border of the face is on the page, to draw by.
    flat = [p for side in place["border"] for p in side]
    units = place_units(b)
    low = [min(p[k] for p in flat) / units[k] for k in (0, 1)]
    rectangle(b, (low[0] + 1, low[1] + 1), (low[0] + 2, low[1] + 3))
    dimensioned(b, 1, 2)
    answer(b, "e", "0.5")
    assert b.look()["solid"]["volume"] == pytest.approx(240 + 1, rel=1e-12)
    replayed(b)
    assert not b.faults, b.faults


def place_units(b: BoardHand) -> list[float]:
    return [math.hypot(*unit) for _, unit in sorted(b.settle()["drawn"]["axes"].items())]


def test_a_face_disappears(board: Callable[..., BoardHand]) -> None:
    pocket = (
        "SKETCH FACE1 2D XY ON PART 6\nPOINT 1 AT 10 10; POINT 2 AT 30 10; POINT 3 AT 30 40\n"
        "POINT 4 AT 10 40; POLYLINE 1 2 3 4 CLOSE\nREFERENCE 1 1 1\n"
        "DIMENSION A X 1 TO 2 = 2; DIMENSION B Y 1 TO 4 = 3\n"
        "EXTRUDE FACE1 -2 INTO POCKET\nCUT PART POCKET INTO PIECE\n"
    )
    b = board(BOX + pocket)
    b.key("v")
    pick(b, '"POCKET.END"')
    b.key("s")
    b.until(lambda: b.look()["drawn"]["object"] == "FACE2")
    rectangle(b, (1.5, 1.5), (2.5, 2.5))
    dimensioned(b, 1, 1)
    answer(b, "e", "1")
    assert b.look()["solid"]["volume"] == pytest.approx(240 - 12 + 1, rel=1e-12)
    # A pocket through the body has no floor: the arrow is refused with the reason, and a text that
    # says so is shown with its fault.
    text = b.text()
    b.page.get_by_label("object", exact=True).select_option("POCKET")
    b.until(lambda: b.look()["drawn"]["object"] == "POCKET")
    b.key("v")
    pull(b, "EXTRUDE1", -3)
    assert b.text() == text
    assert "POCKET.END" in b.page.locator("output.status").inner_text()
    through = text.replace("EXTRUDE FACE1 -2", "EXTRUDE FACE1 -5")
    b.page.locator(".cm-content").click()
    b.page.keyboard.press("Control+A")
    b.page.keyboard.insert_text(through)
    b.until(lambda: b.settle()["drawn"]["faults"])
    assert any("POCKET.END" in fault["text"] for fault in b.look()["drawn"]["faults"])
    b.page.locator("svg.paper").focus()
    b.key("Control+z")
    b.until(lambda: not b.settle()["drawn"]["faults"])
    assert b.text() == text
    b.page.get_by_label("object", exact=True).select_option("PIECE1")
    b.until(lambda: b.look()["drawn"]["object"] == "PIECE1")
    assert b.settle()["solid"]["volume"] == pytest.approx(240 - 12 + 1, rel=1e-12)
    replayed(b)


def test_arrows_change_numbers_where_they_are_written(board: Callable[..., BoardHand]) -> None:
    b = board(BOX)
    b.key("v")
    names = [h["name"] for h in b.settle()["handles"]]
    assert names == ["W", "H", "D1", "point 1 X", "point 1 Y", "point 1 Z"]
    pull(b, "D1", 2, drop=False)
    # The solid follows, the text waits.
    b.until(lambda: b.page.locator(".board-solid").get_attribute("data-volume") == "360")
    assert b.text() == BOX
    b.page.mouse.up()
    b.settle()
    assert b.text() == BOX.replace("EXTRUDE 4", "EXTRUDE 6") and b.hand("steps().done") == [
        "D1 = 6"
    ]
    pull(b, "W", -1)
    assert "DIMENSION W X 1 TO 2 = 9;" in b.text()
    assert b.look()["solid"]["volume"] == pytest.approx(9 * 6 * 6, rel=1e-12)
    pull(b, "point 1 Y", 3)
    assert b.text().count("REFERENCE 1 0 3 0") == 1
    pull(b, "point 1 X", 1)
    assert b.text().count("REFERENCE") == 1 and "REFERENCE 1 1 3 0" in b.text()
    assert len(b.hand("steps().done")) == 4
    replayed(b)
    # A length does not become nothing, however far it is pulled.
    pull(b, "W", -40)
    assert b.look()["solid"]["volume"] > 0
    for _ in range(5):
        b.key("Control+z")
    b.settle()
    assert b.text() == BOX
    # Given up by a second button.
    pull(b, "W", 3, drop=False)
    b.page.evaluate(
        "() => document.querySelector('svg.paper').dispatchEvent("
        "new PointerEvent('pointercancel', {pointerId: 1, bubbles: true}))"
    )
    b.page.mouse.up()
    b.settle()
    assert b.text() == BOX and b.look()["solid"]["volume"] == 240
    assert not b.faults, b.faults


def test_an_arrow_by_keys(board: Callable[..., BoardHand]) -> None:
    b = board(BOX)
    b.key("v")
    b.page.locator("svg.paper").focus()
    b.key("g")
    arrow = b.page.locator("[data-handle]:focus")
    assert arrow.get_attribute("aria-label") == "W" and arrow.get_attribute("role") == "slider"
    b.key("ArrowUp", "ArrowUp")
    tried = float(arrow.get_attribute("aria-valuenow") or 0)
    assert tried > 10 and b.text() == BOX
    b.key("Escape")
    b.settle()
    assert b.text() == BOX
    b.page.locator("svg.paper").focus()
    b.key("g", "g", "ArrowDown", "Enter")
    b.settle()
    (row,) = [ln for ln in b.text().splitlines() if "DIMENSION H" in ln]
    assert 5 < float(row.split("1 TO 4 = ")[1]) < 6
    assert len(b.hand("steps().done")) == 1
    assert not b.faults, b.faults


def test_a_missing_depth_is_pulled(board: Callable[..., BoardHand]) -> None:
    b = board("")
    b.begin("Pictorial")
    turn = math.radians(345), math.radians(40)

    def at(x: float, y: float, z: float) -> tuple[float, float]:
        u = x * math.cos(turn[0]) + y * math.cos(turn[1])
        return u, x * math.sin(turn[0]) + y * math.sin(turn[1]) + z

    corners = [(x, y, z) for z in (0, 60) for x, y in ((0, 0), (90, 0), (90, 50), (0, 50))]
    b.chain(*(at(*corners[k]) for k in (0, 1, 2, 3, 0)))
    b.chain(*(at(*corners[k]) for k in (4, 5, 6, 7, 4)))
    for k in range(4):
        b.stroke(at(*corners[k]), at(*corners[k + 4]))
    b.key("v")
    marks = b.settle()["drawn"]["next"]
    assert sorted(m["axis"] for m in marks) == ["X", "Y", "Z"]
    steps = len(b.hand("steps().done"))
    for k in range(3):
        mark = b.settle()["drawn"]["next"][0]
        pull(b, mark["name"], 5)
        assert len(b.hand("steps().done")) == steps + k + 1
        line = b.text().rstrip().splitlines()[-1]
        assert line.startswith(f"DIMENSION D{k + 1} {mark['axis']} {mark['p']} TO {mark['q']} = ")
        assert float(line.split(" = ")[1]) == pytest.approx(mark["value"] + 5, abs=1.5)
    look = b.settle()
    assert look["solid"]["exact"] and look["solid"]["volume"] > 0
    replayed(b)
    assert not b.faults, b.faults


def test_the_tabs_are_one_row(board: Callable[..., BoardHand]) -> None:
    b = board(BOX)
    b.page.set_viewport_size({"width": 1280, "height": 800})
    tabs = b.page.get_by_role("tablist", name="what is shown").get_by_role("tab")
    boxes = [box for tab in tabs.all() if (box := tab.bounding_box())]
    stage = b.page.locator(".tabs").bounding_box()
    assert stage and len(boxes) >= 6 and len({box["y"] for box in boxes}) == 1
    assert max(box["x"] + box["width"] for box in boxes) <= stage["x"] + stage["width"]
