"""Water and grid of the picture; plane faces that are one grey; numbers by the kind of model."""

from __future__ import annotations

import io
import itertools
import math
import re
from collections import defaultdict
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from conftest import ROOT
from page_in_browser import HULL, Bench, needs_page

pytestmark = needs_page

#: A closed box from (0, 0, 0) to (2, 3, 4), as an implicit body.
BLOCK = (
    'Model info(units = "m");\n'
    "set block = set(plane({-1, 0, 0}, {0, 0, 0})) & set(plane({1, 0, 0}, {2, 0, 0})) &\n"
    "    set(plane({0, -1, 0}, {0, 0, 0})) & set(plane({0, 1, 0}, {0, 3, 0})) &\n"
    "    set(plane({0, 0, -1}, {0, 0, 0})) & set(plane({0, 0, 1}, {0, 0, 4}));\n"
    "Set whole(block);\nSetBody part(whole, {-1, -1, -1}, {5, 5, 5}, depth = 3);\n"
)


def pixels(b: Bench) -> Any:
    """The picture without what is over it, as the renderer has drawn it: rows of RGB."""
    shot = b.page.evaluate(
        "() => document.querySelector('.view canvas').toDataURL('image/png').split(',')[1]"
    )
    return picture(shot)


def picture(data: str) -> Any:
    import base64

    image = pytest.importorskip("PIL.Image")
    return np.asarray(image.open(io.BytesIO(base64.b64decode(data))).convert("RGB")).astype(int)


@pytest.mark.parametrize("name", ["bracket", "lock wall"])
def test_a_plane_is_one_grey(name: str, bench: Callable[..., Bench]) -> None:
    if name == "bracket":
        text = (ROOT / "examples/gallery/bracket.sdl").read_text(encoding="utf-8")
        b = bench(text, "bracket.sdl")
    else:
        b = bench((ROOT / "examples/sketch/lock_wall.skt").read_text(encoding="utf-8"), "wall.skt")
        b.page.get_by_role("tab", name="Model", exact=True).click()
        b.ready()
    b.page.get_by_role("application", name="model").focus()
    for view in ("iso", "perspective"):
        if view == "perspective":
            b.page.keyboard.press("o")
        b.page.wait_for_timeout(500)
        rows = pixels(b)
        ratio = rows.shape[1] / b.page.evaluate(
            "() => document.querySelector('.view canvas').clientWidth"
        )
        greys: dict[tuple[Any, ...], list[Any]] = defaultdict(list)
        for triangle in b.hand("triangles()"):
            corners = np.array(triangle["corners"])
            u, v = corners[1] - corners[0], corners[2] - corners[0]
            sides = [np.linalg.norm(p - q) for p, q in itertools.combinations(corners, 2)]
            twice = abs(u[0] * v[1] - u[1] * v[0])
            # Far from all lines.
            if twice / sum(sides) < 4:
                continue
            x, y = (corners.mean(axis=0) * ratio).astype(int)
            normal = tuple(round(n, 6) + 0.0 for n in triangle["normal"])
            if 0 <= y < rows.shape[0] and 0 <= x < rows.shape[1]:
                greys[triangle["object"], *normal].append(rows[y, x])
        planes = {key: np.array(found) for key, found in greys.items() if len(found) > 1}
        assert len(planes) >= 2, (view, len(greys))
        for key, found in planes.items():
            assert (np.ptp(found, axis=0) <= 1).all(), (view, key, found)


def test_water_and_grid_are_toggled_and_not_fitted(bench: Callable[..., Bench]) -> None:
    b = bench(HULL)
    b.until(lambda: b.hand("ground()")["water"])
    first = b.hand("ground()")
    assert not first["grid"]
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("f")
    reach = b.hand("camera()")["reach"]
    bar = b.page.get_by_role("toolbar", name="view")
    bar.get_by_role("button", name="Grid at z = 0").click()
    bar.get_by_role("button", name="Water plane").click()
    second = b.hand("ground()")
    assert second["grid"] and not second["water"] and second["bounds"] == first["bounds"]
    b.page.get_by_role("application", name="model").focus()
    b.page.keyboard.press("f")
    assert b.hand("camera()")["reach"] == reach
    # They are as they were after a reload.
    b.page.reload()
    b.page.locator("body[data-state=alive]").wait_for(timeout=30_000)
    b.ready()
    b.until(lambda: bar.get_by_role("button", name="Water plane").count())
    third = b.hand("ground()")
    assert third["grid"] and not third["water"]
    # What does not float has no water.
    other = bench(BLOCK, "block.sdl")
    assert not other.hand("ground()")["water"]
    assert not other.page.get_by_role("button", name="Water plane").count()
    assert not b.faults and not other.faults


def test_a_body_has_its_volume_centre_and_inertia(bench: Callable[..., Bench]) -> None:
    b = bench(BLOCK + "Weight steel(part, per = 8);\n", "block.sdl")
    rows: dict[str, Any] = {}

    def known() -> bool:
        rows.update({w["expression"]: w for w in b.hand("model")["watched"]})
        return "steel.mass" in rows

    b.until(known)
    got = {name: row["value"] for name, row in rows.items()}
    assert not any(row.get("error") for row in rows.values()), rows
    assert got["part.volume"] == pytest.approx(24, rel=1e-9)
    assert got["part.centroid"] == pytest.approx([1, 1.5, 2], rel=1e-9)
    inertia = [got[f"inertia(whole)[{k}].{c}"] for k, c in zip((1, 2, 3), "xyz", strict=True)]
    sides = (2, 3, 4)
    exact = [24 * (sum(s * s for s in sides) - s * s) / 12 for s in sides]
    assert inertia == pytest.approx(exact, rel=1e-6)
    assert got["steel.mass"] == pytest.approx(8 * 24, rel=1e-9)
    assert got["steel.centre"] == pytest.approx([1, 1.5, 2], rel=1e-9)
    assert got["mesh.area"] == pytest.approx(52, rel=1e-6)
    # Units, and full names beside them.
    strip = b.page.get_by_role("group", name="watched numbers")
    box = strip.locator(".number-box").filter(has_text="part.volume")
    assert box.locator(".unit").inner_text() == "m³"
    assert "volume that the surface or body encloses" in (box.get_attribute("title") or "")
    turned = strip.locator(".number-box").filter(has_text="inertia(whole)[2].y")
    assert turned.locator(".unit").inner_text() == "m⁵"
    # Nothing of it floats.
    assert not re.search(r"displac|hydrostat", strip.inner_text())


def test_no_number_is_computed_while_a_hand_moves(bench: Callable[..., Bench]) -> None:
    b = bench()
    b.until(lambda: b.hand("model")["watched"])
    b.page.evaluate(
        """() => {
          window.asked = []
          const moved = () => window.asked.push(['move', performance.now()])
          addEventListener('pointermove', moved, true)
          const send = WebSocket.prototype.send
          WebSocket.prototype.send = function (data) {
            if (typeof data === 'string')
              window.asked.push([JSON.parse(data).kind, performance.now()])
            return send.call(this, data)
          }
        }"""
    )

    def measured() -> int:
        """How often numbers were asked for, each time after the hand had rested."""
        last, count = -math.inf, 0
        for kind, at in b.page.evaluate("() => window.asked"):
            if kind == "move":
                last = at
            elif kind in ("measure", "evaluate"):
                assert at - last > 145, (kind, at - last)
                count += 1
        return count

    slider = b.page.get_by_role("slider", name="beam", exact=True)
    box = slider.bounding_box()
    assert box
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    for k in range(40):
        b.page.mouse.move(x + 20 * np.sin(k / 4), y)
        b.page.wait_for_timeout(20)
    measured()
    before = {w["expression"]: w["value"] for w in b.hand("model")["watched"]}
    # A hand that rests has them, though it still holds the slider.
    b.page.mouse.move(x + 30, y)
    b.until(lambda: measured())
    b.until(lambda: {w["expression"]: w["value"] for w in b.hand("model")["watched"]} != before)
    b.page.mouse.up()
    b.hand("settled()")
    assert not b.faults
