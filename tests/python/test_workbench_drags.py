"""A law of drags: what is dragged in any view, and taken back, leaves the text bit for bit.

Every object of the examples that can be dragged is, in standard views and in perspective. The point
follows the pointer, or the status line gives the reason; the program stays without new errors; and
after undo the text and every place of the picture are those of before.
"""

from __future__ import annotations

import math
import os
import random
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from conftest import ROOT
from page_in_browser import Bench, needs_page

pytestmark = needs_page

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

EXAMPLES = sorted(
    path
    for path in (ROOT / "examples").rglob("*.sdl")
    if any(kind in path.read_text(encoding="utf-8") for kind in ("Point ", "Bead ", "Magnet "))
)
#: Drags of one example, and the examples of the ordinary run.
DRAGS = 25 if SOAK else 3
CHOSEN = EXAMPLES if SOAK else random.Random(3).sample(EXAMPLES, 3)

#: Views by their keys; O turns perspective on.
VIEWS = ["1", "2", "3", "4"]
#: Picture points that a place may be beside the pointer.
BESIDE = 3.0

#: What the status line has when a point is not where the pointer is.
REASON = re.compile(r"px behind|Turn the view|· on \w")

#: Places of all that is drawn, as text: numbers of 32 bits are written in full.
PLACES = """() => JSON.stringify(window.moldloft.items().map(
  (i) => [i.name, i.stale, window.moldloft.positions(i.object)]))"""
DRAGGABLE = """() => window.moldloft.model.objects
  .filter((o) => ['point', 'bead', 'magnet', 'ring'].includes(o.class))
  .filter((o) => o.state === 'ok' && o.shown)
  .map((o) => o.name)"""


@pytest.fixture
def example(tmp_path: Path, browser: Any) -> Iterator[Any]:
    made: list[Bench] = []

    def make(path: Path) -> Bench:
        # With the files beside it that it may read.
        folder = tmp_path / "copy"
        shutil.copytree(path.parent, folder)
        made.append(Bench(folder / path.name, browser))
        return made[-1]

    yield make
    for each in made:
        each.close()


def errors(b: Bench) -> list[str]:
    return [f["message"] for f in b.hand("model.faults") if f["severity"] == "error"]


def drag(b: Bench, name: str, chance: random.Random) -> str:
    """One drag and its undo; what was seen, in a word."""
    at = b.page.evaluate("(name) => window.moldloft.project(name)", name)
    box = b.page.locator(".view").bounding_box()
    assert box
    inside = at and (
        box["x"] + 20 < at[0] < box["x"] + box["width"] - 20
        and box["y"] + 120 < at[1] < box["y"] + box["height"] - 120
    )
    if not inside:
        return "outside"
    text, places, faults = b.text(), b.page.evaluate(PLACES), errors(b)
    steps = len(b.hand("steps().done"))
    way = [chance.uniform(-60, 60), chance.uniform(-60, 60)]
    b.page.mouse.move(*at)
    b.page.mouse.down()
    for k in range(1, 5):
        b.page.mouse.move(at[0] + way[0] * k / 4, at[1] + way[1] * k / 4)
    b.page.wait_for_timeout(60)
    b.hand("settled()")
    b.page.mouse.up()
    b.hand("settled()")
    said = b.page.locator(".status").inner_text()
    moved = text != b.text()
    words = (b.path.name, name, way, said)
    assert errors(b) == faults, (words, errors(b))
    done = b.hand("steps().done")[steps:]
    count = len(done)
    # Another point may be in front of it.
    after = b.page.evaluate("(name) => window.moldloft.project(name)", name)
    if moved and done == [f"Drag {name}"]:
        beside = math.dist(after, (at[0] + way[0], at[1] + way[1]))
        assert beside <= BESIDE or REASON.search(said), (words, beside)
    assert count in (0, 1) and moved <= count, (words, count)
    if count:
        b.page.keyboard.press("Control+z")
        b.hand("settled()")
    assert b.text() == text, words
    b.until(lambda: b.page.evaluate(PLACES) == places)
    return "moved" if moved else "stayed"


@pytest.mark.parametrize("path", CHOSEN, ids=lambda p: p.stem)
def test_what_is_dragged_is_taken_back(path: Path, example: Any) -> None:
    b = example(path)
    names = b.page.evaluate(DRAGGABLE)
    if not names:
        pytest.skip("nothing of it can be dragged")
    chance = random.Random(path.stem)
    b.page.get_by_role("application", name="model").focus()
    seen: list[str] = []
    for k in range(DRAGS):
        if k % 4 == 3:
            b.page.keyboard.press("o")
        b.page.keyboard.press(chance.choice(VIEWS))
        b.page.wait_for_timeout(250)
        for name in chance.sample(names, min(8, len(names))):
            if (found := drag(b, name, chance)) != "outside":
                seen.append(found)
                break
    assert not b.faults
    assert seen
