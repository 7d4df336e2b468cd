"""Latency of the workbench: from a slider's event to the new buffers in the page, drawing off.

With `--picture` it is to the end of the frame that shows them, at the page as it opens, with its
numbers; where no graphics card is, that is the time of drawing by software.

Every parameter of an example is moved 40 times, in a page that computes by itself
(`export --html`, the engine in WebAssembly) and in one behind the server (`view`). Needs
`playwright` and a Chromium. Machines are shared: a fixed computation in the page is timed between
the moves, and beside each figure stands the one that the machine would have given at its best
speed in that run: times are divided by how much longer than its quickest the fixed computation
took in the median of that row.

    python benches/workbench.py [--moves N] [--picture] [MODEL ...]
"""

from __future__ import annotations

import argparse
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

from moldloft.workbench.export import exported_page
from moldloft.workbench.page import engine_packed

EXAMPLES = Path(__file__).parents[1] / "examples"
MODELS = [
    "sailboat/hull.sdl",
    "sailboat/yacht.sdl",
    "wing/wing.sdl",
    "submarine/submarine.sdl",
    "wingbody/wingbody.sdl",
    "platform/platform.sdl",
    "propeller/propeller.sdl",
]
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]

MOVES = """async ([name, count, picture]) => {
  const slider = document.querySelector(`input[type=range][aria-label="${name}"]`)
  const [low, high] = [Number(slider.min), Number(slider.max)]
  const { stamps } = window.moldloft
  // About 2 ms on a quiet machine.
  const fixed = () => {
    const from = performance.now()
    let x = 0.5
    for (let k = 0; k < 6e5; k++) x = 3.9 * x * (1 - x)
    return performance.now() - from + 0 * x
  }
  const gl = picture && document.querySelector('.view canvas').getContext('webgl2')
  if (picture && !gl) throw new Error('the picture has no context that can be read')
  const pixel = () => gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4))
  stamps.length = 0
  const beside = [fixed()]
  const seen = []
  for (let k = 0; k < count; k++) {
    const before = stamps.length
    slider.value = low + (high - low) * (0.3 + (0.4 * ((k * 7) % count)) / count)
    const from = performance.now()
    slider.dispatchEvent(new Event('input', { bubbles: true }))
    const end = from + 5000
    while (stamps.length === before && performance.now() < end)
      await new Promise((r) => setTimeout(r))
    // The frame that draws it was asked for before this one; reading a pixel waits for all of it.
    if (picture) await new Promise((r) => requestAnimationFrame(() => r(pixel())))
    seen.push(performance.now() - from)
    beside.push(fixed())
  }
  return { times: picture ? seen : stamps.map((s) => s.to - s.from), beside }
}"""


def row(times: list[float]) -> str:
    """Lowest, median and the 95 % quantile."""
    all_ = sorted(times)
    late = all_[min(len(all_) - 1, int(0.95 * len(all_)))]
    return f"{all_[0]:6.1f} {statistics.median(all_):6.1f} {late:6.1f}"


def measured(page: Any, moves: int, what: str, picture: bool) -> None:
    """A row for each parameter."""
    page.evaluate("() => moldloft.settled()")
    found = {}
    for name in page.evaluate("() => moldloft.model.params.map((p) => p.name)"):
        page.evaluate(MOVES, [name, moves, picture])  # The second compilation comes while it runs.
        found[name] = page.evaluate(MOVES, [name, moves, picture])
    best = min((x for f in found.values() for x in f["beside"]), default=1.0)
    for name, f in found.items():
        times, beside = f["times"], f["beside"]
        if len(times) != moves:
            print(f"  {what:8} {name:18} {len(times)} of {moves} answers")
            continue
        slower = statistics.median(beside) / best
        ours = row([t / slower for t in times])
        print(
            f"  {what:8} {name:18} {row(times)}   at best speed {ours} ms"
            f"   (fixed {best:.1f}, here {best * slower:.1f} ms)",
            flush=True,
        )


def main() -> None:
    """Runs."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--moves", type=int, default=40)
    parser.add_argument("--picture", action="store_true")
    parser.add_argument("models", nargs="*", default=MODELS)
    options = parser.parse_args()
    quiet = "" if options.picture else "?norender"
    with sync_playwright() as p, tempfile.TemporaryDirectory() as folder:
        browser = p.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        for name in options.models:
            model = EXAMPLES / name
            print(f"{name}: lowest, median, 95 %")
            # Drawing is off, but the window is still painted, by software where no graphics card
            # is: a small one takes little of the processor from the engine.
            size = (1280, 720) if options.picture else (640, 400)
            page = browser.new_page(viewport={"width": size[0], "height": size[1]})
            if engine_packed() is not None:
                file = Path(folder) / "page.html"
                file.write_bytes(exported_page(model))
                page.goto(file.as_uri() + quiet)
                page.locator("body[data-engine=ready]").wait_for(timeout=120_000)
                measured(page, options.moves, "worker", options.picture)
            else:
                print("  worker   not measured: `make engine` builds the engine of pages")
            command = [sys.executable, "-m", "moldloft", "view", str(model), "--no-browser"]
            server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
            try:
                assert server.stdout is not None
                url = server.stdout.readline().strip()
                page.goto(url.replace("/#", f"/{quiet}#"))
                page.locator("body[data-state=alive]").wait_for(timeout=120_000)
                measured(page, options.moves, "server", options.picture)
            finally:
                server.terminate()
                server.wait()
            page.close()
        browser.close()


if __name__ == "__main__":
    main()
