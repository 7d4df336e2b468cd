"""A page that is treated badly: typing, slides, drags, undo and lost engines lose nothing."""

from __future__ import annotations

import json
import os
import random
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from conftest import ROOT
from page_in_browser import HULL, Bench, children, needs_page

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
KEYS = ["Shift+X", "z", "k", "b", "m", "c", "o", "f", "r", "s", "1", "2", "3", "4"]
MOVES = ["PageUp", "PageDown", "ArrowRight", "Home", "End"]
VALUES = ["1.5", "2*w", "2 m", "", "9+", "nobody", "-1e3", "0.75"]
FORMS = {
    "AbsPoint": {"x": VALUES, "y": VALUES, "z": VALUES},
    "Line": {"p1": ["A", "P", "s", "nobody"], "p2": ["B", "D", ""]},
    "param": {"value": ["1", "w", "2*w", "x"], "least": ["", "0"], "largest": ["", "5"]},
}
DRAGGED = """() => window.moldloft.model.objects
  .filter((o) => ['point', 'bead', 'magnet', 'ring'].includes(o.class))
  .map((o) => [o.name, window.moldloft.project(o.name)]).filter(([, at]) => at)"""


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
    if chance.random() < 0.5:
        # Half of what does not go together is taken back at once, as a person does.
        b.page.evaluate("() => window.moldloft.settled()")
        if any(f["severity"] == "error" for f in b.hand("model.faults")):
            b.page.keyboard.press("Control+z")


def slid(b: Bench, chance: random.Random) -> None:
    """A slider is moved."""
    sliders = b.page.locator(".params input[type=range]")
    if count := sliders.count():
        # In one step: a parameter may go with the text that it is in.
        sliders.evaluate_all("(all, k) => all[k]?.focus()", chance.randrange(count))
        for _ in range(chance.randrange(1, 4)):
            b.page.keyboard.press(chance.choice(MOVES))


def entered(b: Bench, chance: random.Random) -> None:
    """A value is typed into the field of a parameter."""
    fields = b.page.locator(".params input[type=text]")
    if count := fields.count():
        fields.evaluate_all(
            "(all, k) => { all[k]?.focus(); all[k]?.select() }", chance.randrange(count)
        )
        b.page.keyboard.insert_text(chance.choice(VALUES))
        b.page.keyboard.press("Enter")


def dragged(b: Bench, chance: random.Random) -> None:
    """A point is dragged, and now and then let go of at once or taken back."""
    points = b.page.evaluate(DRAGGED)
    if not points:
        return
    _, at = chance.choice(points)
    b.page.mouse.move(*at)
    b.page.mouse.down()
    for _ in range(chance.randrange(1, 5)):
        b.page.mouse.move(at[0] + chance.uniform(-80, 80), at[1] + chance.uniform(-80, 80))
    if chance.random() < 0.3:
        b.page.keyboard.press(chance.choice(["Escape", "x", "Shift+Y", "s"]))
    b.page.mouse.up()


def added(b: Bench, chance: random.Random) -> None:
    """A form is filled in, with right and wrong words."""
    kind = chance.choice(sorted(FORMS))
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("Shift+A")
    search = b.page.get_by_role("searchbox", name="search kinds")
    b.until(lambda: search.is_visible())
    search.fill(kind)
    search.press("Enter")
    panel = b.page.get_by_role("region", name="add an object")
    for name, words in FORMS[kind].items():
        panel.get_by_role("textbox", name=name, exact=True).fill(chance.choice(words))
    panel.get_by_role("button", name="Add", exact=True).click()
    if chance.random() < 0.7:
        b.page.evaluate("() => window.moldloft.settled()")
    panel.get_by_role("button", name="close").click()


def changed(b: Bench, chance: random.Random) -> None:
    """An object of the list is deleted or duplicated, by keys."""
    # In one step: the row may go with the object.
    picked = b.page.evaluate(
        """(share) => { const rows = [...document.querySelectorAll('.tree .object')]
        const row = rows[Math.floor(share * rows.length)]
        row?.click(); row?.focus(); return !!row }""",
        chance.random(),
    )
    if picked:
        b.page.keyboard.press(chance.choice(["Delete", "Control+d", "Control+d"]))


def reverted(b: Bench, chance: random.Random) -> None:
    """The file is saved, or the text of the file comes back."""
    if chance.random() < 0.5:
        b.page.keyboard.press("Control+s")
        return
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("Control+k")
    b.page.keyboard.insert_text("revert")
    b.page.keyboard.press("Enter")


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


def restarted(b: Bench, chance: random.Random) -> None:
    """The server ends; something is typed, and the page finds the next server by itself."""
    b.kill()
    b.page.get_by_text("The server does not answer").wait_for()
    for _ in range(chance.randrange(3)):
        chance.choice([typed_alone, undone])(b, chance)
    b.serve()
    b.connected()


def typed_alone(b: Bench, chance: random.Random) -> None:
    """Something is typed at the end, or the end is taken out."""
    b.page.get_by_role("textbox", name="program").focus()
    b.page.keyboard.press("Control+End")
    if chance.random() < 0.5:
        b.page.keyboard.insert_text(chance.choice(SCRAPS))
    for _ in range(chance.randrange(4)):
        b.page.keyboard.press("Backspace")


def kept(b: Bench) -> str:
    """The text on the disk: the draft, else the file."""
    try:
        found = (b.path.parent / f".{b.path.name}.draft").read_text(encoding="utf-8")
        return str(json.loads(found)["text"])
    except FileNotFoundError:
        return b.path.read_text(encoding="utf-8")


def back_and_again(b: Bench, begin: str) -> None:
    """All steps are taken back, and all that there are then are done again: the same texts."""
    b.page.evaluate("() => window.moldloft.settled()")
    b.page.get_by_role("textbox", name="program").focus()
    end, ahead = b.text(), b.hand("steps().undone")
    seen = [(end, b.hand("steps()"))]
    while seen[-1][1]["done"]:
        b.page.keyboard.press("Control+z")
        b.page.evaluate("() => window.moldloft.settled()")
        seen.append((b.text(), b.hand("steps()")))
    assert seen[-1][0] == begin
    for text, steps in seen[-2::-1]:
        b.page.keyboard.press("Control+Shift+Z")
        b.page.evaluate("() => window.moldloft.settled()")
        assert (b.text(), b.hand("steps()")) == (text, steps)
    assert b.text() == end and b.hand("steps().undone") == ahead
    b.until(lambda: kept(b) == end)


ACTS = [
    typed, typed, slid, slid, entered, dragged, dragged, added, changed, reverted, undone, looked,
]  # fmt: skip
EXAMPLES = {
    "small": (MODEL, 1400, 25),
    "hull": (HULL, 300, 2),
    "bottle": ((ROOT / "examples/gallery/bottle.sdl").read_text(encoding="utf-8"), 300, 2),
}
"""Text, acts of the long run, acts of the ordinary run."""


@pytest.mark.parametrize("name", EXAMPLES)
def test_nothing_is_lost_by_a_wild_hand(name: str, bench: Callable[..., Bench]) -> None:
    begin, long, few = EXAMPLES[name]
    b = bench(begin, "wild.sdl", sharpness=0.25)
    chance = random.Random(5)
    for k in range(long if SOAK else few):
        act = restarted if k % 50 == 24 else killed if k % 10 == 9 else chance.choice(ACTS)
        act(b, chance)
        if k % 6 == 5:
            b.page.evaluate("() => window.moldloft.settled()")
            # The page is there, something of the model is seen, and the disk has the text.
            assert b.hand("items()"), (k, b.text())
            b.until(lambda: kept(b) == b.text())
        if k % 200 == 199:
            back_and_again(b, begin)
    back_and_again(b, begin)
    # A text that is whole again is followed as if nothing had been.
    program = b.page.get_by_role("textbox", name="program")
    program.focus()
    b.page.keyboard.press("Control+a")
    b.page.keyboard.insert_text(begin + "AbsPoint Last(3, 3, 3);\n")
    b.until(lambda: b.text() == begin + "AbsPoint Last(3, 3, 3);\n", 60)
    b.until(lambda: any(i["object"] == "Last" and not i["stale"] for i in b.hand("items()")), 60)
    b.until(lambda: all(not i["stale"] for i in b.hand("items()")), 60)
    # Where a test puts many lines at once the browser itself tries to style them, in vain; and
    # connections to a server that has ended are refused.
    expected = ("inline style", "ERR_CONNECTION", "WebSocket connection")
    assert not [f for f in b.faults if not any(words in f for words in expected)]


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


def test_a_page_finds_the_next_server_and_joins_both_texts(bench: Callable[..., Bench]) -> None:
    b = bench(MODEL, "again.sdl", sharpness=0.25)
    program = b.page.get_by_role("textbox", name="program")
    program.focus()
    b.page.keyboard.press("Control+End")
    b.page.keyboard.insert_text("AbsPoint Q(1, 1, 1);\n")
    b.page.keyboard.press("Control+s")
    b.until(lambda: b.path.read_text(encoding="utf-8") == b.text())
    # Saved is what has no draft.
    b.until(lambda: not b.path.with_name(f".{b.path.name}.draft").exists())
    saved = b.text()
    b.kill()
    b.page.get_by_text("The server does not answer").wait_for()
    b.page.keyboard.insert_text("# alone\n")
    b.path.write_text("# another program\n" + saved, encoding="utf-8")
    b.serve()
    b.connected()
    b.until(lambda: b.text() == "# another program\n" + saved + "# alone\n")
    b.until(lambda: kept(b) == b.text())
    # What was done before and since is taken back, what the other program did is not.
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == "# another program\n" + saved)
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.text() == "# another program\n" + MODEL)
    b.until(lambda: all(not i["stale"] for i in b.hand("items()")))


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
