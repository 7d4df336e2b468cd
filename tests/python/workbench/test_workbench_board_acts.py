"""Random gestures on the drawing board: undone, done again, replayed, with lost processes.

20 gestures in the ordinary run, 2 000 under `MOLDLOFT_SOAK`.
"""

from __future__ import annotations

import json
import os
import random
import signal
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from board_by_hand import BoardHand
from moldloft.workbench.board import Board, answered
from page_in_browser import children, needs_page

pytestmark = needs_page

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
GESTURES = 2000 if SOAK else 20
#: A drawing larger than that is begun anew, so that each gesture stays quick.
LARGEST = 24

#: Of an answer, what is not of the sketch.
OWN = ("id", "version", "edits", "kind")


@pytest.fixture
def board(tmp_path: Path, browser: Any) -> Iterator[BoardHand]:
    path = tmp_path / "part.skt"
    path.write_text("", encoding="utf-8")
    made = BoardHand(path, browser, sharpness=0.25)
    yield made
    made.close()


def drawn(b: BoardHand) -> dict[str, Any]:
    shown = b.settled("m.board.look().drawn")
    return {k: v for k, v in shown.items() if k not in OWN}


def replayed(text: str) -> dict[str, Any]:
    """What a board that has only the text shows."""
    reply = answered(Board(), {"kind": "board_open", "text": text, "id": 1})
    return {k: v for k, v in json.loads(json.dumps(reply)).items() if k not in OWN}


def lose(b: BoardHand) -> None:
    """Ends the process of the board."""
    for pid in children(b.process.pid):
        if "board" in Path(f"/proc/{pid}/cmdline").read_text(encoding="utf-8").split("\0"):
            os.kill(pid, signal.SIGKILL)


def dragged(b: BoardHand, start: tuple[float, float], by: tuple[float, float]) -> None:
    x, y = b.at(*start)
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    for k in (1, 2, 3):
        b.page.mouse.move(x + by[0] * k / 3, y + by[1] * k / 3)
    b.page.mouse.up()
    b.hand("board.settled()")


def gesture(b: BoardHand, chance: random.Random, facts: dict[str, Any]) -> str:
    """One act of a hand; what it was."""
    places = {p[0]: (p[1], p[2]) for p in facts["points"]}
    lines = facts["lines"]

    def somewhere() -> tuple[float, float]:
        if places and chance.random() < 0.4:
            return chance.choice(list(places.values()))
        return chance.uniform(-60, 260), chance.uniform(-80, 160)

    def middle(line: Any) -> tuple[float, float]:
        (a, c), (d, e) = places[line[1]], places[line[2]]
        return (a + d) / 2, (c + e) / 2

    acts = ["chain", "stroke", "stroke", "axis"]
    if lines:
        acts += ["move", "move line", "type", "delete", "duplicate", "dimension", "confirm"]
        acts += ["undo", "undo", "redo", "lose", "pull", "pull by keys"]
    act = chance.choice(acts) if len(places) < LARGEST else "undo"
    if act == "chain":
        b.key("d")
        b.chain(*(somewhere() for _ in range(chance.randint(2, 4))))
        b.key("Escape")
    elif act == "stroke":
        b.key("d")
        b.stroke(somewhere(), somewhere())
        b.key("Escape")
    elif act == "axis":
        tip = b.page.locator("[data-axis]")
        if tip.count():
            box = tip.nth(chance.randrange(tip.count())).bounding_box()
            assert box
            x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
            b.page.mouse.move(x, y)
            b.page.mouse.down()
            b.page.mouse.move(x + chance.uniform(-12, 12), y + chance.uniform(-12, 12), steps=2)
            b.page.mouse.up()
    elif act in ("move", "move line"):
        b.key("v", "Escape")
        start = (
            chance.choice(list(places.values())) if act == "move" else middle(chance.choice(lines))
        )
        dragged(b, start, (chance.uniform(-40, 40), chance.uniform(-40, 40)))
    elif act in ("type", "delete", "duplicate"):
        b.key("v", "Escape")
        b.click(*middle(chance.choice(lines)))
        b.key({"delete": "Delete", "duplicate": "Control+d"}.get(act, chance.choice("xyzhpfo")))
    elif act == "dimension":
        b.page.locator("svg.paper").focus()
        b.key("Tab")
        if b.look()["open"]:
            b.page.keyboard.type(str(chance.randint(1, 40)))
            b.key("Enter", "Escape")
    elif act == "confirm":
        b.key("t")
    elif act == "pull":
        b.key("v", "Escape")
        found = b.settle()
        if found["handles"]:
            (x, y), (left, top) = chance.choice(found["handles"])["at"], found["origin"]
            b.page.mouse.move(left + x, top + y)
            b.page.mouse.down()
            b.page.mouse.move(
                left + x + chance.uniform(-40, 40), top + y + chance.uniform(-40, 40), steps=3
            )
            b.page.mouse.up()
            b.hand("board.settled()")
    elif act == "pull by keys":
        b.page.locator("svg.paper").focus()
        b.key("g")
        b.key(
            *chance.choices(["ArrowUp", "ArrowDown", "g"], k=3), chance.choice(["Enter", "Escape"])
        )
        b.page.locator("svg.paper").focus()
    elif act == "undo":
        for _ in range(chance.randint(1, 3)):
            b.key("Control+z")
    elif act == "redo":
        b.key("Control+Shift+z")
    else:
        lose(b)
    return act


def test_random_gestures(board: BoardHand) -> None:
    b, chance = board, random.Random(46)
    b.begin("Pictorial")
    begin = b.text()
    seen: dict[str, dict[str, Any]] = {}
    acts: Counter[str] = Counter()
    for k in range(GESTURES):
        facts = drawn(b)
        if facts["object"] is None:
            # All is taken back: the first step again.
            b.key("Control+Shift+z")
            facts = drawn(b)
            if facts["object"] is None:
                b.begin("Pictorial")
                facts = drawn(b)
        act = gesture(b, chance, facts)
        acts[act] += 1
        facts, text = drawn(b), b.text()
        # However a text was come to, the board shows the same.
        assert seen.setdefault(text, facts) == facts, (k, act, text)
        assert not b.faults, (k, act, b.faults)
    end, steps = b.text(), b.hand("steps().done")
    assert replayed(end) == drawn(b)
    lose(b)
    for _ in steps:
        b.key("Control+z")
    b.settle()
    assert b.text() == "" and not b.hand("steps().done")
    lose(b)
    for _ in steps:
        b.key("Control+Shift+z")
    assert drawn(b) == seen[end] and b.text() == end and b.hand("steps().done") == steps
    assert begin in end or not end
    # A text here and there among those that were come to.
    for text in chance.sample(sorted(seen), min(len(seen), 60)):
        assert replayed(text) == seen[text], text
    print(dict(acts), len(seen), "texts")
