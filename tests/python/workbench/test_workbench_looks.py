"""First views of examples at five sizes in both themes, and what screen readers announce.

Under `MOLDLOFT_SOAK` all examples are drawn into the folder `MOLDLOFT_LOOKS`, to be looked at;
in the ordinary run one.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from board_by_hand import BoardHand
from conftest import ROOT
from desk_by_hand import DeskHand
from page_in_browser import HULL, Bench, needs_page

pytestmark = needs_page

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

SIZES = {
    "wide": (1920, 1080), "small": (1280, 720), "tablet": (820, 1180), "phone": (390, 844),
    "least": (360, 740),
}  # fmt: skip
EXAMPLES = [
    "sailboat/hull.sdl", "sailboat/yacht.sdl", "propeller/propeller.sdl", "wing/wing.sdl",
    "platform/platform.sdl", "submarine/submarine.sdl", "missile/finned.sdl",
    "wingbody/wingbody.sdl", "implicit/manifold.sdl", "implicit/tee.sdl", "sketch/site.sdl",
    "gallery/arch_dam.sdl", "gallery/bottle.sdl", "gallery/bracket.sdl", "gallery/car_body.sdl",
    "gallery/catamaran.sdl", "gallery/ducted_fan.sdl", "gallery/helmet.sdl", "gallery/lattice.sdl",
    "gallery/lock.sdl", "gallery/merchant.sdl", "gallery/rowing_shell.sdl", "gallery/spar.sdl",
    "gallery/turbine_blade.sdl",
]  # fmt: skip
CHOSEN = EXAMPLES if SOAK else ["gallery/bottle.sdl"]

AXE = ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js"

#: Whether the picture has something in it: how many colours the middle of it has.
COLOURS = """() => new Promise((done) => requestAnimationFrame(() => {
  const canvas = document.querySelector('.view canvas')
  const small = document.createElement('canvas')
  ;[small.width, small.height] = [64, 64]
  const flat = small.getContext('2d')
  flat.drawImage(canvas, 0, 0, 64, 64)
  const d = flat.getImageData(0, 0, 64, 64).data
  const seen = new Set()
  for (let k = 0; k < d.length; k += 4) seen.add((d[k] << 16) | (d[k + 1] << 8) | d[k + 2])
  done(seen.size)
}))"""


@pytest.mark.parametrize("name", CHOSEN)
def test_an_example_at_first_view(name: str, tmp_path: Path, browser: Any) -> None:
    out = Path(os.environ.get("MOLDLOFT_LOOKS", tmp_path / "looks"))
    out.mkdir(parents=True, exist_ok=True)
    folder = tmp_path / "model"
    shutil.copytree((ROOT / "examples" / name).parent, folder)
    b = Bench(folder / Path(name).name, browser)
    try:
        for size, (width, height) in SIZES.items():
            for theme in ("light", "dark"):
                b.page.set_viewport_size({"width": width, "height": height})
                b.page.emulate_media(color_scheme=theme)
                b.page.reload()
                b.page.locator("body[data-state=alive]").wait_for(timeout=60_000)
                b.ready()
                b.page.wait_for_timeout(700)
                words = (name, size, theme)
                # Nothing is beside the page, and what a hand needs is on it.
                wide = b.page.evaluate("() => document.scrollingElement.scrollWidth")
                assert wide <= width, (words, wide)
                if width >= 1280:
                    for part in ("model objects", "inspector", "parameters"):
                        box = b.page.get_by_role("region", name=part).bounding_box()
                        assert box, (words, part)
                        assert box["y"] + 60 < height, (words, part, box)
                assert b.page.evaluate("() => document.documentElement.dataset.theme") == theme
                stem = f"{Path(name).stem}-{size}-{theme}"
                b.page.screenshot(path=out / f"{stem}.png")
        assert not b.faults
    finally:
        b.close()


def violations(b: Bench) -> list[str]:
    """What axe finds wrong on the page as it is."""
    b.page.evaluate(AXE.read_text(encoding="utf-8"))
    found = b.page.evaluate("() => axe.run(document, { resultTypes: ['violations'] })")
    return [
        f"{v['id']}: {n['html'][:160]} {n['failureSummary']}"
        for v in found["violations"]
        for n in v["nodes"]
    ]


@pytest.mark.skipif(not AXE.exists(), reason="axe is not here: `make web` installs it with Node.js")
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing(
    theme: str, bench: Callable[..., Bench], tmp_path: Path, browser: Any
) -> None:
    b = bench(HULL)
    b.page.emulate_media(color_scheme=theme)
    b.page.get_by_role("treeitem").nth(1).click()
    b.page.wait_for_timeout(300)
    found = {"model": violations(b)}
    for tab in ("Lines plan", "Hydrostatics", "Section areas", "Mesh", "Dependencies", "Curvature"):
        b.page.get_by_role("tab", name=tab).click()
        b.page.wait_for_timeout(300)
        found[tab] = violations(b)
    b.page.get_by_role("tab", name="Model").click()
    b.page.get_by_role("application", name="model").focus()
    for name, key in (("form", "Shift+A"), ("palette", "Control+k")):
        b.page.keyboard.press(key)
        b.page.wait_for_timeout(200)
        found[name] = violations(b)
        b.page.keyboard.press("Escape")
    empty = bench("", "empty.sdl")
    empty.page.emulate_media(color_scheme=theme)
    empty.page.get_by_role("region", name="start").wait_for()
    found["start"] = violations(empty)
    for path, text, room in (
        ("board.skt", (ROOT / "examples/sketch/dam.skt").read_text(encoding="utf-8"), BoardHand),
        ("desk.sdl", "", DeskHand),
    ):
        place = tmp_path / path
        place.write_text(text, encoding="utf-8")
        made = room(place, browser)
        try:
            made.page.emulate_media(color_scheme=theme)
            made.page.wait_for_timeout(500)
            found[path] = violations(made)
        finally:
            made.close()
    assert not any(found.values()), "\n".join(
        f"{k}: {line}" for k, lines in found.items() for line in lines
    )
