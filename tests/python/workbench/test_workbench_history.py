"""One history: Ctrl+Z from any focus takes back the last change, Ctrl+Shift+Z does it again."""

from __future__ import annotations

import os
import random
from collections.abc import Callable

from page_in_browser import Bench, children, needs_page

pytestmark = needs_page

TEXT = (
    "param float w = 2 in [1, 9];\nparam int n = 3 in [1, 9];\nparam float twice = 2 * w;\n"
    "AbsPoint P(1, 2, 3);\nAbsPoint Q(w, n, twice);\nLine l(P, Q);\n"
)


def opened(make: Callable[..., Bench]) -> Bench:
    b = make(TEXT, "steps.sdl")
    b.page.evaluate("() => window.moldloft.camera_set(-90, 90)")
    b.page.wait_for_timeout(200)
    return b


def came_to(b: Bench, text: str) -> None:
    b.until(lambda: b.text() == text)


def slide(b: Bench, name: str, share: float) -> None:
    """With the pointer, in many moves."""
    box = b.page.get_by_role("slider", name=name, exact=True).bounding_box()
    assert box
    y = box["y"] + box["height"] / 2
    b.page.mouse.move(box["x"] + box["width"] * 0.2, y)
    b.page.mouse.down()
    for k in range(1, 9):
        b.page.mouse.move(box["x"] + box["width"] * (0.2 + (share - 0.2) * k / 8), y)
    b.page.mouse.up()
    b.page.evaluate("() => window.moldloft.settled()")


def drag(b: Bench, name: str, dx: float, dy: float) -> None:
    x, y = b.hand(f"project('{name}')")
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    for k in range(1, 5):
        b.page.mouse.move(x + dx * k / 4, y + dy * k / 4)
    b.page.mouse.up()
    b.page.evaluate("() => window.moldloft.settled()")


def test_a_slide_is_one_step_from_the_slider_s_own_focus(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    slide(b, "w", 0.7)
    b.until(lambda: b.text() != TEXT)
    moved = b.text()
    assert b.page.evaluate("() => document.activeElement.type") == "range"
    b.page.keyboard.press("Control+z")
    came_to(b, TEXT)
    b.until(lambda: b.param("w") == 2)
    b.page.keyboard.press("Control+Shift+z")
    came_to(b, moved)
    # Keys on a slider are one step when they have rested, and Ctrl+Z does not wait for that.
    b.page.keyboard.press("Control+z")
    came_to(b, TEXT)
    b.page.get_by_role("slider", name="w", exact=True).focus()
    for _ in range(3):
        b.page.keyboard.press("ArrowRight")
    b.page.keyboard.press("Control+z")
    # What another slider does at once is not lost in what is taken back.
    b.page.get_by_role("slider", name="n", exact=True).focus()
    for _ in range(3):
        b.page.keyboard.press("ArrowRight")
    came_to(b, TEXT.replace("n = 3", "n = 6"))
    # One step, unless the machine was slower than a hand that rests.
    steps = b.hand("steps().done")
    assert 1 <= len(steps) <= 3 and steps[0].startswith("n: 3 → ")
    for _ in steps:
        b.page.keyboard.press("Control+z")
    came_to(b, TEXT)
    b.until(lambda: b.param("w") == 2 and b.param("n") == 3)
    assert not b.faults


def test_drags_forms_fixes_and_reverts_are_steps(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    texts = [TEXT]

    def came() -> None:
        b.until(lambda: b.text() != texts[-1])
        texts.append(b.text())

    drag(b, "P", 60, 0)
    came()
    field = b.page.get_by_role("textbox", name="w, value", exact=True)
    field.fill("4.5")
    field.press("Enter")
    came()
    program = b.page.get_by_role("textbox", name="program")
    program.focus()
    b.page.keyboard.press("Control+End")
    # At once: a pause between keys would begin another step.
    b.page.keyboard.insert_text("AbsPoint R(0, 0, 0);")
    came_to(b, texts[-1] + "AbsPoint R(0, 0, 0);")
    texts.append(b.text())
    b.page.keyboard.press("Control+k")
    b.page.keyboard.type("revert")
    b.page.keyboard.press("Enter")
    came_to(b, TEXT)
    texts.append(TEXT)
    b.until(lambda: b.page.locator(".saved").get_attribute("data-state") == "saved")
    done = b.hand("steps().done")
    assert len(done) == 4 and done[0] == "Drag P" and done[1] == "w: 2 → 4.5", done
    assert done[2].startswith("Typing") and done[3].startswith("Revert"), done
    # From the buttons, and from the picture's focus.
    b.page.get_by_role("button", name="undo", exact=True).click()
    came_to(b, texts[3])
    b.page.get_by_role("application", name="model").focus()
    for text in texts[2::-1]:
        b.page.keyboard.press("Control+z")
        came_to(b, text)
    for text in texts[1:]:
        b.page.keyboard.press("Control+y")
        came_to(b, text)
    # The list goes to any of them.
    b.page.get_by_role("button", name="history", exact=True).click()
    listed = b.page.get_by_role("group", name="steps")
    assert listed.get_by_role("button").all_inner_texts()[-1] == "As opened"
    listed.get_by_role("button", name="Drag P").click()
    came_to(b, texts[1])
    b.until(lambda: listed.locator(".now").inner_text() == "Drag P")
    assert len(b.hand("steps().undone")) == 3
    b.page.keyboard.press("Escape")
    assert not listed.is_visible() and not b.faults


def test_a_field_takes_back_what_is_typed_in_it_first(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    drag(b, "P", 60, 0)
    b.until(lambda: b.text() != TEXT)
    moved = b.text()
    search = b.page.get_by_role("searchbox", name="search objects")
    search.focus()
    b.page.keyboard.type("Q")
    b.page.keyboard.press("Control+z")
    b.until(lambda: search.input_value() == "")
    assert b.text() == moved
    b.page.keyboard.press("Control+z")
    came_to(b, TEXT)


def test_a_value_that_the_text_does_not_state_is_a_step(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    slide(b, "twice", 0.9)
    b.until(lambda: b.param("twice") > 5)
    came = b.param("twice")
    b.until(lambda: b.hand("steps().done.length") == 1)
    assert b.text() == TEXT
    b.page.keyboard.press("Control+z")
    b.until(lambda: b.param("twice") == 4)
    # It follows its expression again.
    slide(b, "w", 0.5)
    b.until(lambda: b.param("w") != 2 and b.param("twice") == 2 * b.param("w"))
    b.page.keyboard.press("Control+z")
    came_to(b, TEXT)
    b.until(lambda: b.param("twice") == 4)
    slide(b, "twice", 0.9)
    b.until(lambda: b.param("twice") == came)
    b.page.keyboard.press("Control+z")
    b.page.keyboard.press("Control+Shift+z")
    b.until(lambda: b.param("twice") == came and not b.hand("steps().undone.length"))
    assert not b.faults


def test_wild_acts_are_undone_to_the_start_and_done_again(bench: Callable[..., Bench]) -> None:
    b = opened(bench)
    acts = 2000 if os.environ.get("MOLDLOFT_SOAK") == "1" else 40
    choose = random.Random(7)

    def act() -> None:
        kind = choose.choice(["slide", "keys", "drag", "field", "type", "undo", "redo"])
        if kind == "slide":
            slide(b, choose.choice(["w", "n"]), choose.uniform(0.05, 0.95))
        elif kind == "keys":
            b.page.get_by_role("slider", name="w", exact=True).focus()
            for _ in range(choose.randint(1, 4)):
                b.page.keyboard.press(choose.choice(["ArrowRight", "ArrowLeft"]))
        elif kind == "drag":
            drag(b, "P", choose.uniform(-40, 40), choose.uniform(-40, 40))
            b.page.evaluate("() => window.moldloft.camera_set(-90, 90)")
        elif kind == "field":
            field = b.page.get_by_role("textbox", name="w, value", exact=True)
            field.fill(f"{choose.uniform(1, 9):.3f}")
            field.press("Enter")
        elif kind == "type":
            b.page.get_by_role("textbox", name="program").focus()
            b.page.keyboard.press("Control+End")
            b.page.keyboard.type(f"# {choose.randint(0, 9)}\n")
        elif kind in ("undo", "redo"):
            keys = {"undo": "Control+z", "redo": "Control+Shift+z"}
            for _ in range(choose.randint(1, 3)):
                b.page.keyboard.press(keys[kind])
        b.page.evaluate("() => window.moldloft.settled()")

    for k in range(acts):
        act()
        if k % 500 == 250:
            # The engine goes; nothing of the history does.
            for pid in children(b.process.pid):
                os.kill(pid, 9)
    b.page.evaluate("() => window.moldloft.settled()")
    end, steps = b.text(), b.hand("steps().done.length")
    b.page.get_by_role("application", name="model").focus()
    for _ in range(steps):
        b.page.keyboard.press("Control+z")
    b.page.evaluate("() => window.moldloft.settled()")
    b.until(lambda: not b.hand("steps().done.length"))
    came_to(b, TEXT)
    for _ in range(steps):
        b.page.keyboard.press("Control+Shift+z")
    b.page.evaluate("() => window.moldloft.settled()")
    b.until(lambda: b.hand("steps().done.length") == steps)
    came_to(b, end)
