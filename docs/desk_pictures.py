"""Draws the pictures of the fairing desk: `python docs/desk_pictures.py`.

A browser opens the page of `moldloft view` and does what the pictures show. It needs Playwright and
Chromium, as the tests of the page do.
"""

from __future__ import annotations

import io
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
SIZE = {"width": 1500, "height": 900}
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


def picture(page: Any, name: str) -> None:
    """The desk alone, in 128 colours."""
    page.mouse.move(4, 4)
    with Image.open(io.BytesIO(page.locator(".desk").screenshot())) as drawn:
        height = round(drawn.height * WIDTH / drawn.width)
        small = drawn.convert("RGB").resize((WIDTH, height), Image.Resampling.LANCZOS)
    out = io.BytesIO()
    few = small.quantize(128, Image.Quantize.MAXCOVERAGE, kmeans=10, dither=Image.Dither.NONE)
    few.save(out, "PNG", optimize=True)
    (IMAGES / f"{name}.png").write_bytes(out.getvalue())
    print(f"{name}.png: {len(out.getvalue()) / 1000:.0f} kB")


def draw(page: Any) -> None:
    """Both pictures."""
    opened(page, "section.csv", section())
    run(page, "knuckle 21", "tolerance 0.02")
    page.locator(".desk-shape").focus()
    picture(page, "desk-section")
    page.get_by_role("button", name="Open").click()
    opened(page, "hull.csv", hull())
    run(page, "tolerance 0.005", "cut y 1.4")
    page.get_by_role("listbox", name="lines").get_by_text("waterline 1.23").click()
    settle(page)
    picture(page, "desk-hull")


def main() -> None:
    """Draws them."""
    chromium = next(filter(None, map(shutil.which, ["chromium", "chromium-browser"])), None)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        model = Path(folder) / "boat.sdl"
        model.write_text("AbsPoint A(0, 0, 0);\n")
        command = [sys.executable, "-m", "moldloft", "view", str(model), "--no-browser"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
            assert server.stdout is not None
            browser = play.chromium.launch(executable_path=chromium, args=FLAGS)
            page = browser.new_page(viewport=SIZE)
            # The program and the panels give way.
            page.add_init_script(f"localStorage.setItem('moldloft.sizes', '{PANELS}')")
            page.goto(server.stdout.readline().strip())
            page.locator("body[data-state=alive]").wait_for(timeout=60_000)
            draw(page)
            browser.close()
            server.terminate()


if __name__ == "__main__":
    main()
