"""Draws the pictures of a boat that is made by hand: `python docs/making_pictures.py`.

A browser opens an empty model in the page of `moldloft view` and takes the steps of
`docs/tutorials/by-hand.md`. It needs Playwright and Chromium, as the tests of the page do.
"""

from __future__ import annotations

import re
from typing import Any

from page_pictures import opened_page, picture

SIZE = (1400, 800)
WIDTH = 1000
"""Picture points of a picture's width."""

#: Of each section: x, half-breadth, height of the keel.
SECTIONS = ((0, 0.02, 0.5), (4, 1.4, -0.5), (8, 1.5, -0.45), (11, 1.0, 0.2))


def settle(page: Any) -> None:
    """All acts are in the text and in the picture."""
    page.evaluate("() => window.moldloft.settled()")
    page.wait_for_timeout(600)


def shown(page: Any, name: str) -> None:
    """The page as it is."""
    settle(page)
    page.mouse.move(4, 4)
    picture(page, name, WIDTH)


def form(page: Any, kind: str) -> Any:
    """The form of a kind, by its keys."""
    page.keyboard.press("Escape")
    page.get_by_role("application", name="model").focus()
    page.keyboard.press("Shift+A")
    search = page.get_by_role("searchbox", name="search kinds")
    search.fill(kind)
    search.press("Enter")
    return page.get_by_role("region", name="add an object")


def points(page: Any, *places: tuple[float, float, float]) -> None:
    """Points by their numbers, in the form that is open."""
    panel = page.get_by_role("region", name="add an object")
    for place in places:
        for axis, value in zip("xyz", place, strict=True):
            panel.get_by_role("textbox", name=axis, exact=True).fill(f"{value:g}")
        panel.get_by_role("textbox", name="z", exact=True).press("Enter")
        settle(page)


def picked(page: Any, kind: str, *parents: str, **given: str) -> Any:
    """The form of a kind with its parents, which are picked in the list of objects."""
    panel = form(page, kind)
    folded = page.locator('.tree [data-key=":Points"][aria-expanded=false]')
    if folded.count():
        folded.click()
    for parent in parents:
        page.get_by_role("treeitem", name=re.compile(rf"^{parent} ")).click()
    if given:
        panel.get_by_text("Options").click()
    for name, value in given.items():
        panel.get_by_role("textbox", name=name, exact=True).fill(value)
    return panel


def add(page: Any, panel: Any) -> None:
    """Adds what the form describes."""
    panel.get_by_role("button", name="Add", exact=True).click()
    settle(page)


def draw(page: Any) -> None:
    """All pictures."""
    start = page.get_by_role("region", name="start")
    start.get_by_role("checkbox").check()
    shown(page, "by-hand-start")
    start.get_by_role("button", name="Begin with points").click()
    for x, beam, keel in SECTIONS:
        points(page, (x, beam, 1.2), (x, beam, 0.3), (x, beam / 2, keel), (x, 0, keel))
    page.keyboard.press("f")
    curves = []
    for k in range(4):
        panel = picked(page, "BCurve", *(f"P{4 * k + j}" for j in (1, 2, 3, 4)), degree="2")
        if k == 1:
            shown(page, "by-hand-section")
        add(page, panel)
        curves.append(f"c{k + 1}")
    add(page, picked(page, "CLoftSurf", *curves))
    form(page, "AbsPoint")
    points(page, (5, 0, -0.4), (6, 0.12, -0.4), (7.5, 0, -0.4))
    points(page, (5.6, 0, -1.8), (6.3, 0.1, -1.8), (7.3, 0, -1.8))
    add(page, picked(page, "BCurve", "P17", "P18", "P19", degree="2"))
    add(page, picked(page, "BCurve", "P20", "P21", "P22", degree="2"))
    add(page, picked(page, "RuledSurf", "c5", "c6"))
    page.keyboard.press("Escape")
    page.get_by_role("application", name="model").focus()
    page.keyboard.press("f")
    shown(page, "by-hand-boat")
    page.keyboard.press("q")
    shown(page, "by-hand-views")


if __name__ == "__main__":
    with opened_page("", SIZE) as opened:
        draw(opened)
