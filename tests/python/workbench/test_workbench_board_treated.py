"""Edges rounded and cut, and bodies repeated, on the drawing board by hand."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from board_by_hand import BoardHand
from moldloft import Sketch
from page_in_browser import needs_page

pytestmark = needs_page

SIZE = (10, 6, 4)
#: Corners of the box by their number, and the directions of the axes on the page.
CORNERS = {
    k: (x, y, z)
    for k, (x, y, z) in enumerate(
        [(x, y, z) for z in (0, 4) for x, y in ((0, 0), (10, 0), (10, 6), (0, 6))], 1
    )
}
AXES = [(math.cos(math.radians(a)), math.sin(math.radians(a))) for a in (345, 40, 90)]


@pytest.fixture
def board(tmp_path: Path, browser: Any) -> Iterator[BoardHand]:
    path = tmp_path / "part.skt"
    path.write_text("", encoding="utf-8")
    b = BoardHand(path, browser)
    yield b
    b.close()


def draw_box(b: BoardHand) -> None:
    """A box of 10, 6 and 4 with its corners where a hand puts them, dimensioned and made."""
    chance = random.Random(5)
    page = {
        k: tuple(
            20 * sum(x * a[j] for x, a in zip(at, AXES, strict=True)) + chance.uniform(-1.5, 1.5)
            for j in (0, 1)
        )
        for k, at in CORNERS.items()
    }
    b.begin("Pictorial")
    b.chain(*((page[k][0], page[k][1]) for k in (1, 2, 3, 4, 1)))
    b.chain(*((page[k][0], page[k][1]) for k in (5, 6, 7, 8, 5)))
    for k in (1, 2, 3, 4):
        b.stroke((page[k][0], page[k][1]), (page[k + 4][0], page[k + 4][1]))
    assert b.dimension_all({k: tuple(map(float, at)) for k, at in CORNERS.items()}) == 3
    assert b.settle()["solid"]["volume"] == pytest.approx(240, rel=1e-9)
    b.key("Enter", "v")
    b.settle()


def choose(b: BoardHand, *edges: tuple[int, int]) -> list[int]:
    """Clicks on lines, from the second on with Shift; their numbers."""
    drawn = b.settle()["drawn"]
    places = {p[0]: p[1:3] for p in drawn["points"]}
    found = []
    for k, (p, q) in enumerate(edges):
        (a, c), (d, e) = places[p], places[q]
        if k:
            b.page.keyboard.down("Shift")
        b.click((2 * a + d) / 3, (2 * c + e) / 3)
        b.page.keyboard.up("Shift")
        found.append(next(ln[0] for ln in drawn["lines"] if {ln[1], ln[2]} == {p, q}))
    return found


def answer(b: BoardHand, words: str, value: str) -> None:
    bar = b.page.get_by_role("toolbar", name="drawing")
    bar.get_by_role("button", name=words).click()
    b.page.locator(".board-box input[type=text]").wait_for()
    b.page.keyboard.type(value)
    b.key("Enter")
    b.settle()


def show(b: BoardHand, name: str) -> Any:
    b.page.get_by_label("object", exact=True).select_option(name)
    b.until(lambda: b.look()["drawn"]["object"] == name)
    return b.settle()["solid"]


def volume(b: BoardHand, name: str) -> float:
    sketch = Sketch()
    sketch.run(b.text())
    return float(sketch.objects[name]["volume"])


def test_edges_and_copies_by_gesture(board: BoardHand) -> None:
    b = board
    draw_box(b)
    drawn = b.text()
    # Two edges rounded: the body is the page's and that of the text.
    lines = choose(b, (2, 6), (3, 7))
    answer(b, "Fillet", "1 into ROUNDED")
    assert b.text() == f"{drawn}FILLET PART 1 EDGES LINE {lines[0]} {lines[1]} INTO ROUNDED\n"
    rounded = 240 - 2 * (1 - math.pi / 4) * 4
    assert show(b, "ROUNDED")["volume"] == pytest.approx(rounded, rel=1e-9)
    assert volume(b, "ROUNDED") == pytest.approx(rounded, rel=1e-9)
    # A row of three.
    answer(b, "Pattern", "3 12 0 0")
    assert b.text().endswith("\nPATTERN ROUNDED LINEAR 3 12 0 0\n")
    assert b.settle()["solid"]["volume"] == pytest.approx(3 * rounded, rel=1e-9)
    assert volume(b, "ROUNDED") == pytest.approx(3 * rounded, rel=1e-9)
    # One edge cut off, of the box that is still drawn; what is too large leaves the text.
    show(b, "PART")
    [line] = choose(b, (5, 6))
    text = b.text()
    answer(b, "Chamfer", "9")
    assert b.text() == text and b.page.locator(".board-box.refused").is_visible()
    b.page.keyboard.press("Escape")
    answer(b, "Chamfer", "0.5 into CUT")
    assert f"\nCHAMFER PART 0.5 EDGES LINE {line} INTO CUT\n" in b.text()
    cut = 240 - 0.5**2 / 2 * 10
    assert show(b, "CUT")["volume"] == pytest.approx(cut, rel=1e-9)
    # The three gestures are three steps.
    end = b.text()
    b.page.locator("svg.paper").focus()
    for _ in range(3):
        b.key("Control+z")
        b.settle()
    assert b.text() == drawn and volume(b, "PART") == pytest.approx(240, rel=1e-9)
    for _ in range(3):
        b.key("Control+Shift+z")
        b.settle()
    assert b.text() == end and volume(b, "CUT") == pytest.approx(cut, rel=1e-9)
    assert not b.faults, b.faults


def test_all_edges_without_a_choice(board: BoardHand) -> None:
    b = board
    draw_box(b)
    b.key("Escape")
    answer(b, "Chamfer", "1")
    assert b.text().endswith("\nCHAMFER PART 1 EDGES ALL\n")
    # Half a cube for each length of an edge but its last at both ends; of the cubes of the corners
    # a quarter is left, where x + y, y + z and z + x are at least 1.
    exact = 240 - 4 * sum(side - 2 for side in SIZE) / 2 - 8 * 3 / 4
    assert b.settle()["solid"]["volume"] == pytest.approx(volume(b, "PART"), rel=1e-12)
    assert volume(b, "PART") == pytest.approx(exact, rel=1e-9)
    assert not b.faults, b.faults
