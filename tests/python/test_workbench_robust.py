"""A page that is treated badly: typing, slides, drags, undo and lost engines lose nothing."""

from __future__ import annotations

import json
import os
import random
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

from page_in_browser import Bench, children, needs_page

pytestmark = needs_page

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

MODEL = (
    "param float w = 2 in [1, 3];\nparam float h = 1 in [0.5, 2];\n"
    "AbsPoint A(0, 0, 0); AbsPoint B(w, 0, 0); AbsPoint C(0, 1, h); AbsPoint D(2, 1, 1);\n"
    "Line l(A, B); Line m(C, D); RuledSurf s(l, m);\nAbsPoint P(0.5, 0.5, 1);\n"
)

SCRAPS = [
    "(", ")", '"', "AbsPoint Z(1, 2, 3);\n", "w", "\n", ";", "# no more\n", "Line z(P, A);\n",
    "1e", "-", "for (", "print(w);\n", "}", "P", "visible = 0", "é", "\U0001f6a4",
    "Line t(P, P);\n", "w = 9;\n", 'load "x";\n',
]  # fmt: skip
KEYS = ["Shift+X", "z", "k", "b", "m", "c", "o", "f", "r", "s"]
MOVES = ["PageUp", "PageDown", "ArrowRight", "Home", "End"]


def typed(b: Bench, chance: random.Random) -> None:
    """Something is typed, or taken out, somewhere."""
    program = b.page.get_by_role("textbox", name="program")
    program.focus()
    b.page.keyboard.press("Control+Home")
    for _ in range(chance.randrange(7)):
        b.page.keyboard.press("ArrowDown")
    for _ in range(chance.randrange(5)):
        b.page.keyboard.press("Control+ArrowRight")
    if chance.random() < 0.3:
        for _ in range(chance.randrange(1, 6)):
            b.page.keyboard.press("Backspace")
    else:
        b.page.keyboard.insert_text(chance.choice(SCRAPS))


def slid(b: Bench, chance: random.Random) -> None:
    """A slider is moved."""
    sliders = b.page.locator(".params input[type=range]")
    if count := sliders.count():
        # In one step: a parameter may go with the text that it is in.
        sliders.evaluate_all("(all, k) => all[k]?.focus()", chance.randrange(count))
        for _ in range(chance.randrange(1, 4)):
            b.page.keyboard.press(chance.choice(MOVES))


def dragged(b: Bench, chance: random.Random) -> None:
    """A point is dragged, and now and then let go of at once or taken back."""
    at = b.hand(f"project('{chance.choice('ABCDP')}')")
    if at is None:
        return
    b.page.mouse.move(*at)
    b.page.mouse.down()
    for _ in range(chance.randrange(1, 5)):
        b.page.mouse.move(at[0] + chance.uniform(-80, 80), at[1] + chance.uniform(-80, 80))
    if chance.random() < 0.3:
        b.page.keyboard.press(chance.choice(["Escape", "x", "Shift+Y", "s"]))
    b.page.mouse.up()


def undone(b: Bench, chance: random.Random) -> None:
    """Steps back and forth."""
    b.page.get_by_role("textbox", name="program").focus()
    for _ in range(chance.randrange(1, 6)):
        b.page.keyboard.press(chance.choice(["Control+z", "Control+z", "Control+y"]))


def looked(b: Bench, chance: random.Random) -> None:
    """Sheets, colours and sections while the model changes."""
    if chance.random() < 0.5:
        tabs = b.page.locator(".tabs [role=tab]:visible")
        tabs.nth(chance.randrange(tabs.count())).click()
        b.page.get_by_role("tab", name="Model").click()
    else:
        b.page.get_by_role("application", name="model").focus()
        b.page.keyboard.press(chance.choice(KEYS))


def killed(b: Bench, _: random.Random) -> None:
    """The engine ends."""
    for child in children(b.process.pid):
        os.kill(child, signal.SIGKILL)


def kept(b: Bench) -> str:
    """What the disk has: the draft, else the file."""
    try:
        found = (b.path.parent / f".{b.path.name}.draft").read_text(encoding="utf-8")
        return str(json.loads(found)["text"])
    except FileNotFoundError:
        return b.path.read_text(encoding="utf-8")


def test_nothing_is_lost_by_a_wild_hand(bench: Callable[..., Bench]) -> None:
    b = bench(MODEL, "wild.sdl")
    chance = random.Random(5)
    acts = [typed, typed, slid, slid, dragged, dragged, undone, looked, looked]
    rounds = 1000 if SOAK else 24
    for k in range(rounds):
        act = killed if k % 10 == 9 else chance.choice(acts)
        act(b, chance)
        if k % 6 == 5:
            b.page.evaluate("() => window.moldloft.settled()")
            # The page is there, something of the model is seen, and the disk has the text.
            assert b.hand("items()"), (k, b.text())
            b.until(lambda: kept(b) == b.text())
    # A text that is whole again is followed as if nothing had been.
    program = b.page.get_by_role("textbox", name="program")
    program.focus()
    b.page.keyboard.press("Control+a")
    b.page.keyboard.insert_text(MODEL + "AbsPoint Last(3, 3, 3);\n")
    b.until(lambda: b.text() == MODEL + "AbsPoint Last(3, 3, 3);\n", 60)
    b.until(lambda: any(i["object"] == "Last" and not i["stale"] for i in b.hand("items()")), 60)
    b.until(lambda: all(not i["stale"] for i in b.hand("items()")), 60)
    # Where a test puts many lines at once the browser itself tries to style them, in vain.
    assert not [f for f in b.faults if "inline style" not in f]


def test_nothing_is_lost_when_servers_are_killed(tmp_path: Path, browser: Any) -> None:
    path = tmp_path / "killed.sdl"
    path.write_text(MODEL, encoding="utf-8")
    chance = random.Random(7)
    accepted = MODEL
    for k in range(20 if SOAK else 3):
        b = Bench(path, browser)
        try:
            # All that the page reported as accepted is there, whenever the server ended.
            assert b.text() == accepted
            assert [i for i in b.hand("items()") if i["object"] == "s"]
            slid(b, chance)
            program = b.page.get_by_role("textbox", name="program")
            program.focus()
            b.page.keyboard.press("Control+End")
            b.page.keyboard.insert_text(f"AbsPoint K{k}({k}, 0, 0);\n")
            b.page.evaluate("() => window.moldloft.settled()")
            accepted = b.text()
            if chance.random() < 0.5:
                b.page.keyboard.type("# and more")
            b.process.kill()
            b.process.wait(60)
            b.page.get_by_text("The server does not answer").wait_for()
            # The page has its text and its picture still, and takes more of it.
            b.page.keyboard.insert_text("# typed alone\n")
            assert b.text().startswith(accepted) and b.text().endswith("# typed alone\n")
            assert b.hand("items()")
            # What was on its way when the server ended may have arrived.
            found = kept(b)
            assert b.text().startswith(found) and found.startswith(accepted)
            accepted = found
        finally:
            b.close()


def test_a_server_that_is_stopped_says_nothing(bench: Callable[..., Bench]) -> None:
    b = bench()
    # Questions are under way when it ends.
    b.page.evaluate(
        """() => { const s = document.querySelector('input[type=range]')
        for (let k = 0; k < 20; k++) { s.value = Number(s.min) + k * 0.01
          s.dispatchEvent(new Event('input', { bubbles: true })) } }"""
    )
    b.process.terminate()
    _, said = b.process.communicate(timeout=60)
    assert "Traceback" not in said and "never retrieved" not in said, said
