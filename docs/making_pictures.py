"""Draws the pictures of a boat that is made by hand: `python docs/making_pictures.py`.

A browser opens an empty model in the page of `moldloft view` and takes the steps of
`docs/tutorials/by-hand.md`. It needs Playwright and Chromium, as the tests of the page do.
"""

from __future__ import annotations

import io
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
SIZE = {"width": 1400, "height": 800}
WIDTH = 1000
"""Picture points of a picture's width."""

#: Of each section: x, half-breadth, height of the keel.
SECTIONS = ((0, 0.02, 0.5), (4, 1.4, -0.5), (8, 1.5, -0.45), (11, 1.0, 0.2))


def settle(page: Any) -> None:
    """All acts are in the text and in the picture."""
    page.evaluate("() => window.moldloft.settled()")
    page.wait_for_timeout(600)


def picture(page: Any, name: str) -> None:
    """The page in 128 colours."""
    settle(page)
    page.mouse.move(4, 4)
    with Image.open(io.BytesIO(page.screenshot())) as drawn:
        height = round(drawn.height * WIDTH / drawn.width)
        small = drawn.convert("RGB").resize((WIDTH, height), Image.Resampling.LANCZOS)
    out = io.BytesIO()
    few = small.quantize(128, Image.Quantize.MAXCOVERAGE, kmeans=10, dither=Image.Dither.NONE)
    few.save(out, "PNG", optimize=True)
    (IMAGES / f"{name}.png").write_bytes(out.getvalue())
    print(f"{name}.png: {len(out.getvalue()) / 1000:.0f} kB")


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
    picture(page, "by-hand-start")
    start.get_by_role("button", name="Begin with points").click()
    for x, beam, keel in SECTIONS:
        points(page, (x, beam, 1.2), (x, beam, 0.3), (x, beam / 2, keel), (x, 0, keel))
    page.keyboard.press("f")
    curves = []
    for k in range(4):
        panel = picked(page, "BCurve", *(f"P{4 * k + j}" for j in (1, 2, 3, 4)), degree="2")
        if k == 1:
            picture(page, "by-hand-section")
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
    picture(page, "by-hand-boat")
    page.keyboard.press("q")
    picture(page, "by-hand-views")


def main() -> None:
    """Draws them."""
    chromium = next(filter(None, map(shutil.which, ["chromium", "chromium-browser"])), None)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        model = Path(folder) / "boat.sdl"
        model.write_text("")
        command = [sys.executable, "-m", "moldloft", "view", str(model), "--no-browser"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
            assert server.stdout is not None
            browser = play.chromium.launch(executable_path=chromium, args=FLAGS)
            page = browser.new_page(viewport=SIZE)
            page.goto(server.stdout.readline().strip())
            page.locator("body[data-state=alive]").wait_for(timeout=60_000)
            draw(page)
            browser.close()
            server.terminate()


if __name__ == "__main__":
    main()
