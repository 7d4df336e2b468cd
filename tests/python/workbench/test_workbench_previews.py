"""Bodies of sets while a hand moves a number, and when it rests."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from page_in_browser import Bench, needs_page

pytestmark = needs_page

#: A tee of two pipes in a block, at a depth that takes a while.
TEE = """Model info(units = "mm");
param float r = 3 in [2, 4];
AbsPoint a(-20, 0, 0); AbsPoint b(20, 0, 0); AbsPoint c(0, 0, 20); AbsPoint o(0, 0, 0);
Line run(a, b); Line branch(o, c);
field main = cylinder(run, r + 1); field side = cylinder(branch, r);
set tee = (set(main) | set(side)) & cuboid({-10, -10, -10}, {10, 10, 12});
SetBody body(tee, {-11, -11, -11}, {11, 11, 13}, depth = 8);
"""


def vertices(b: Bench) -> int:
    return sum(i["vertices"] for i in b.hand("items()") if i["object"] == "body")


def test_a_heavy_body_follows_the_hand_coarsely_and_is_exact_at_rest(
    bench: Callable[..., Bench],
) -> None:
    b = bench(TEE, "tee.sdl", sharpness=0.25)
    exact = vertices(b)
    slider = b.page.get_by_role("slider", name="r", exact=True)
    box = slider.bounding_box()
    assert box is not None
    y = box["y"] + box["height"] / 2
    mouse = b.page.mouse
    mouse.move(box["x"] + box["width"] / 2, y)
    mouse.down()
    seen = []
    for k in range(40):
        mouse.move(box["x"] + box["width"] * (0.5 + 0.25 * (k % 20) / 20), y)
        b.page.wait_for_timeout(120)
        seen.append(vertices(b))
        if seen[-1] < exact / 3:
            break
    assert min(seen) < exact / 3, (exact, seen)
    mouse.up()
    b.page.evaluate("() => window.moldloft.settled()")
    b.until(lambda: vertices(b) > 0.7 * exact)
    # What is shown is what the text says, cell by cell.
    shown = b.hand("positions('body')")
    b.page.reload()
    b.ready()
    assert b.hand("positions('body')") == pytest.approx(shown, abs=1e-6)
    assert not b.faults
