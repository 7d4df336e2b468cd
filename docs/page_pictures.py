"""A page of `moldloft view` in a browser, and pictures of it for the docs.

It needs Playwright and Chromium, as the tests of the page do.
"""

from __future__ import annotations

import io
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


@contextmanager
def opened_page(
    text: str, size: tuple[int, int], before: str = "", name: str = "boat.sdl"
) -> Iterator[Any]:
    """The page of a model of this text, alive; `before` is a script that runs first."""
    chromium = next(filter(None, map(shutil.which, ["chromium", "chromium-browser"])), None)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as play:
        model = Path(folder) / name
        model.write_text(text)
        command = [sys.executable, "-m", "moldloft", "view", str(model), "--no-browser"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
            assert server.stdout is not None
            browser = play.chromium.launch(executable_path=chromium, args=FLAGS)
            page = browser.new_page(viewport={"width": size[0], "height": size[1]})
            if before:
                page.add_init_script(before)
            page.goto(server.stdout.readline().strip())
            page.locator("body[data-state=alive]").wait_for(timeout=60_000)
            yield page
            browser.close()
            server.terminate()


def picture(target: Any, name: str, width: int) -> None:
    """A page or a part of it, `width` pixels wide, in 128 colours."""
    with Image.open(io.BytesIO(target.screenshot())) as drawn:
        height = round(drawn.height * width / drawn.width)
        small = drawn.convert("RGB").resize((width, height), Image.Resampling.LANCZOS)
    out = io.BytesIO()
    few = small.quantize(128, Image.Quantize.MAXCOVERAGE, kmeans=10, dither=Image.Dither.NONE)
    few.save(out, "PNG", optimize=True)
    (IMAGES / f"{name}.png").write_bytes(out.getvalue())
    print(f"{name}.png: {len(out.getvalue()) / 1000:.0f} kB")
