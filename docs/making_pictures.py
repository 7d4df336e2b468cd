"""Draws the pictures of models that are made by hand: `python docs/making_pictures.py`.

A browser opens an empty model in the page of `moldloft view` and takes the steps of
`docs/tutorials/by-hand.md`, and those on the drawing board of `docs/tutorials/dam.md`. It needs Playwright and Chromium, as the tests of the page do.
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
    """The page as it is, the pointer aside."""
    page.mouse.move(4, 4)
    held(page, name)


def held(page: Any, name: str) -> None:
    """The page while the pointer holds something."""
    settle(page)
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
    if given and (options := panel.get_by_text("Options")).count():
        options.click()
    for name, value in given.items():
        panel.get_by_role("textbox", name=name, exact=True).fill(value)
    return panel


def add(page: Any, panel: Any) -> str:
    """Adds what the form describes; its name."""
    objects = "() => window.moldloft.model.objects.map((o) => o.name)"
    before = set(page.evaluate(objects))
    panel.get_by_role("button", name="Add", exact=True).click()
    settle(page)
    [made] = set(page.evaluate(objects)) - before
    return str(made)


def boat(page: Any) -> None:
    """A hull with a keel."""
    start = page.get_by_role("region", name="start")
    start.get_by_role("checkbox").check()
    shown(page, "by-hand-start")
    start.get_by_role("button", name="Begin with points").click()
    for x, beam, keel in SECTIONS:
        points(page, (x, beam, 1.2), (x, beam, 0.3), (x, beam / 2, keel), (x, 0, keel))
    page.keyboard.press("f")
    curves: list[str] = []
    for k in range(4):
        panel = picked(page, "BCurve", *(f"P{4 * k + j}" for j in (1, 2, 3, 4)), degree="2")
        if k == 1:
            shown(page, "by-hand-section")
        curves.append(add(page, panel))
    add(page, picked(page, "CLoftSurf", *curves))
    form(page, "AbsPoint")
    points(page, (5, 0, -0.4), (6, 0.12, -0.4), (7.5, 0, -0.4))
    points(page, (5.6, 0, -1.8), (6.3, 0.1, -1.8), (7.3, 0, -1.8))
    root = add(page, picked(page, "BCurve", "P17", "P18", "P19", degree="2"))
    tip = add(page, picked(page, "BCurve", "P20", "P21", "P22", degree="2"))
    add(page, picked(page, "RuledSurf", root, tip))
    page.keyboard.press("Escape")
    page.get_by_role("application", name="model").focus()
    page.keyboard.press("f")
    shown(page, "by-hand-boat")
    page.keyboard.press("q")
    shown(page, "by-hand-views")


def begun(page: Any, unit: str) -> None:
    """The start page has the unit; the form of points is open."""
    start = page.get_by_role("region", name="start")
    start.get_by_role("combobox", name="unit of length").select_option(unit)
    start.get_by_role("button", name="Begin with points").click()


def seen(page: Any, *keys: str) -> None:
    """The picture after keys."""
    page.keyboard.press("Escape")
    page.get_by_role("application", name="model").focus()
    for key in (*keys, "f"):
        page.keyboard.press(key)
    settle(page)


def bottle(page: Any) -> None:
    """A body of revolution."""
    begun(page, "mm")
    points(page, (0, 0, 0), (30, 0, 0), (34, 0, 60), (33, 0, 130), (12, 0, 160), (12, 0, 200))
    points(page, (0, 0, 200))
    side = add(page, picked(page, "BCurve", *(f"P{k}" for k in range(1, 7)), degree="3"))
    axis = add(page, picked(page, "Line", "P1", "P7"))
    seen(page, "2")
    panel = picked(page, "RevSurf", side, axis)
    shown(page, "by-hand-bottle-side")
    add(page, panel)
    seen(page, "1")
    shown(page, "by-hand-bottle")


def propeller(page: Any) -> None:
    """A hub and five blades."""
    begun(page, "mm")
    points(page, (-60, 0, 0), (60, 0, 0), (-60, 0, 40), (60, 0, 40))
    points(page, (-30, -22, 34), (-50, -80, 110), (-40, -60, 190), (0, 0, 240))
    points(page, (30, 22, 34), (45, 70, 110), (35, 60, 190))
    shaft = add(page, picked(page, "Line", "P1", "P2"))
    side = add(page, picked(page, "Line", "P3", "P4"))
    add(page, picked(page, "RevSurf", side, shaft))
    leading = add(page, picked(page, "CCurve", "P5", "P6", "P7", "P8"))
    trailing = add(page, picked(page, "CCurve", "P9", "P10", "P11", "P8"))
    blade = add(page, picked(page, "RuledSurf", leading, trailing))
    # The flat of the blade.
    seen(page, "1", *["ArrowLeft"] * 4)
    shown(page, "by-hand-blade")
    for k in range(1, 5):
        add(page, picked(page, "RotatSurf", blade, shaft, angle=f"{0.4 * k:g} * PI"))
    seen(page, "1")
    shown(page, "by-hand-propeller")


#: The dam: where a hand draws its corners, and where they are, in feet.
DAM_PAGE = {
    1: (1, 2), 2: (251, -66), 3: (39, 188), 4: (39, 250), 5: (1, 259),
    6: (149, 123), 7: (399, 59), 8: (187, 313), 9: (188, 374), 10: (150, 383),
}  # fmt: skip
DAM = {
    1: (0, 0, 0), 2: (70, 0, 0), 3: (16, 0, 72), 4: (16, 0, 90), 5: (0, 0, 90),
    6: (0, 50, 0), 7: (70, 50, 0), 8: (16, 50, 72), 9: (16, 50, 90), 10: (0, 50, 90),
}  # fmt: skip


def drawn(page: Any) -> Any:
    """What the drawing board shows, when it has come to rest."""
    page.evaluate("() => window.moldloft.board.settled()")
    page.wait_for_timeout(300)
    return page.evaluate("() => window.moldloft.board.look()")


def pressed(page: Any, *way: tuple[float, float]) -> None:
    """A press at a place of the drawing, let go at the last one."""
    for k, (u, v) in enumerate(way):
        x, y = page.evaluate(f"() => window.moldloft.board.onScreen([{u}, {v}])")
        page.mouse.move(x - 3, y + 2)
        page.mouse.move(x, y)
        if k == 0:
            page.mouse.down()
    page.mouse.up()
    drawn(page)


def dam(page: Any) -> None:
    """A dam on the drawing board."""
    page.get_by_role("button", name="Pictorial").click()
    drawn(page)
    for chain in ((1, 2, 3, 4, 5, 1), (1, 6, 7, 8, 9, 10, 6)):
        for k in chain:
            pressed(page, DAM_PAGE[k])
    for near, far in ((2, 7), (3, 8), (4, 9), (5, 10)):
        pressed(page, DAM_PAGE[near], DAM_PAGE[far])
    page.keyboard.press("0")
    shown(page, "board-lines")
    page.keyboard.press("v")
    for p, q in ((2, 3), (7, 8)):
        (a, c), (d, e) = DAM_PAGE[p], DAM_PAGE[q]
        pressed(page, ((2 * a + d) / 3, (2 * c + e) / 3))
        page.keyboard.press("f")
        drawn(page)
    page.keyboard.press("Tab")
    given = 0
    while mark := drawn(page)["open"]:
        if given == 1:
            shown(page, "board-dimension")
        k = "XYZ".index(mark["axis"])
        page.keyboard.type(f"{DAM[mark['q']][k] - DAM[mark['p']][k]:g}")
        page.keyboard.press("Enter")
        given += 1
    page.keyboard.press("Enter")
    drawn(page)
    shown(page, "board-dam")
    gallery(page)


def gallery(page: Any) -> None:
    """A gallery through the dam: a section on its near face, sunk, and its arrows."""
    page.keyboard.press("v")
    while True:
        page.keyboard.press("b")
        if drawn(page)["face"]["name"] == "1":
            break
    shown(page, "board-face")
    page.keyboard.press("s")
    axes = drawn(page)["drawn"]["axes"]
    for x, z in ((6, 6), (22, 6.4), (21.8, 30), (6, 30), (6, 6)):
        pressed(page, tuple(x * axes["X"][k] + z * axes["Z"][k] for k in (0, 1)))
    page.locator("svg.paper").focus()
    page.keyboard.press("Tab")
    for value in ("16", "24"):
        drawn(page)
        page.keyboard.type(value)
        page.keyboard.press("Enter")
    drawn(page)
    shown(page, "board-section")
    page.keyboard.press("k")
    page.keyboard.type("20")
    page.keyboard.press("Enter")
    drawn(page)
    page.keyboard.press("v")
    # The arrow of the depth, dragged to the far face.
    found = drawn(page)
    depth = next(h for h in found["handles"] if h["name"].startswith("POCKET1."))
    x, y = (a + b for a, b in zip(found["origin"], depth["at"], strict=True))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 20 * depth["unit"][0], y + 20 * depth["unit"][1], steps=4)
    held(page, "board-arrows")
    page.mouse.up()


if __name__ == "__main__":
    for name, make in (("boat.sdl", boat), ("bottle.sdl", bottle), ("propeller.sdl", propeller)):
        with opened_page("", SIZE, name=name) as opened:
            make(opened)
    with opened_page("", SIZE, name="dam.skt") as opened:
        dam(opened)
