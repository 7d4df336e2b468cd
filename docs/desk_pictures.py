"""Draws the pictures of the fairing desk: `python docs/desk_pictures.py`.

A browser opens the page of `moldloft view` and does what the pictures show. It needs Playwright and
Chromium, as the tests of the page do.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from page_pictures import opened_page, picture

SIZE = (1500, 900)
PANELS = '{"left": 190, "right": 190, "messages": 80}'
WIDTH = 1100
"""Picture points of a page's width."""


def section() -> str:
    """Points with a knuckle, noise and one wrong reading."""
    x = np.linspace(0, 10, 41)
    y = 0.02 * x**2 + np.maximum(x - 5, 0)
    points = np.column_stack([x, y]) + np.random.default_rng(9).uniform(-0.01, 0.01, (41, 2))
    points[30, 1] += 0.4
    return "x,y\n" + "".join(f"{a:.4f},{b:.4f}\n" for a, b in points)


def hull() -> str:
    """Half-breadths of a round hull, read to the centimetre."""
    stations, levels = np.linspace(0, 20, 13), np.linspace(0.2, 2, 8)
    rows = ["waterline," + ",".join(f"{x:g}" for x in stations)]
    for z in levels:
        y = 2.5 * (1 - ((stations - 10) / 11) ** 2) * (1 - (1 - z / 2.2) ** 2)
        rows.append(f"{z:.3g}," + ",".join(f"{v:.2f}" for v in y))
    return "\n".join(rows) + "\n"


def opened(page: Any, name: str, text: str) -> None:
    """A table at the desk."""
    page.get_by_role("tab", name="Fairing desk").click()
    file = {"name": name, "mimeType": "text/csv", "buffer": text.encode()}
    page.get_by_label("a table of offsets").set_input_files([file])
    page.wait_for_function("() => window.moldloft.desk.look().session")
    settle(page)


def settle(page: Any) -> None:
    """All acts are done."""
    page.evaluate("() => window.moldloft.desk.settled()")


def run(page: Any, *commands: str) -> None:
    """Commands in the desk's own line."""
    line = page.get_by_label("fairing command")
    for command in commands:
        line.fill(command)
        line.press("Enter")
        settle(page)


def shown(page: Any, name: str) -> None:
    """The desk alone."""
    page.mouse.move(4, 4)
    picture(page.locator(".desk"), name, WIDTH)


def draw(page: Any) -> None:
    """Both pictures."""
    opened(page, "section.csv", section())
    run(page, "knuckle 21", "tolerance 0.02")
    page.locator(".desk-shape").focus()
    shown(page, "desk-section")
    page.get_by_role("button", name="Open").click()
    opened(page, "hull.csv", hull())
    run(page, "tolerance 0.005", "cut y 1.4")
    page.get_by_role("listbox", name="lines").get_by_text("waterline 1.23").click()
    settle(page)
    shown(page, "desk-hull")


if __name__ == "__main__":
    # The program and the panels give way.
    sizes = f"localStorage.setItem('moldloft.sizes', '{PANELS}')"
    with opened_page("AbsPoint A(0, 0, 0);\n", SIZE, sizes) as page_of_desk:
        draw(page_of_desk)
