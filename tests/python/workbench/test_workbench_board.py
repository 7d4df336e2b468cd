"""The drawing board: pictures by pointer and keys become solids, every gesture in the text."""

from __future__ import annotations

import base64
import itertools
import math
import os
import random
import re
import shutil
import signal
import struct
import time
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from board_by_hand import BoardHand
from conftest import ROOT
from moldloft import Sketch
from page_in_browser import children, needs_page

pytestmark = needs_page

DAM_PAGE = {
    1: (1, 2), 2: (251, -66), 3: (39, 188), 4: (39, 250), 5: (1, 259),
    6: (149, 123), 7: (399, 59), 8: (187, 313), 9: (188, 374), 10: (150, 383),
}  # fmt: skip
DAM = {
    1: (0, 0, 0), 2: (70, 0, 0), 3: (16, 0, 72), 4: (16, 0, 90), 5: (0, 0, 90),
    6: (0, 50, 0), 7: (70, 50, 0), 8: (16, 50, 72), 9: (16, 50, 90), 10: (0, 50, 90),
}  # fmt: skip


@pytest.fixture
def board(tmp_path: Path, browser: Any) -> Iterator[Callable[..., BoardHand]]:
    made: list[BoardHand] = []

    def make(text: str = "", name: str = "part.skt") -> BoardHand:
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        made.append(BoardHand(path, browser))
        return made[-1]

    yield make
    for each in made:
        each.close()


def draw_dam(b: BoardHand) -> None:
    b.begin("Pictorial")
    b.chain(*(DAM_PAGE[k] for k in (1, 2, 3, 4, 5, 1)))
    b.chain(*(DAM_PAGE[k] for k in (1, 6, 7, 8, 9, 10, 6)))
    for near, far in ((2, 7), (3, 8), (4, 9), (5, 10)):
        b.stroke(DAM_PAGE[near], DAM_PAGE[far])


def test_a_dam_from_nothing(board: Callable[..., BoardHand]) -> None:
    begin = time.monotonic()
    b = board()
    texts = [b.text()]
    assert texts == [""]
    draw_dam(b)
    state = b.settle()
    assert len(state["drawn"]["points"]) == 10 and len(state["drawn"]["lines"]) == 15, b.text()
    # Two lines are inclined: nobody says so but the hand.
    found = {frozenset(ln[1:3]): ln[3] for ln in state["drawn"]["lines"]}
    assert [found[frozenset(e)] for e in ((1, 2), (3, 4), (1, 6), (5, 10))] == ["X", "Z", "Y", "Y"]
    b.key("v")
    for p, q in ((2, 3), (7, 8)):
        (a, c), (d, e) = DAM_PAGE[p], DAM_PAGE[q]
        b.click((2 * a + d) / 3, (2 * c + e) / 3)
        b.key("f")
        assert b.type_of(p, q) == "XZ", b.text()
    assert b.dimension_all(DAM) == 5
    state = b.settle()
    assert state["solid"]["exact"] and state["solid"]["volume"] == pytest.approx(169_200, rel=1e-9)
    b.key("Enter")
    b.settle()
    text = b.text()
    assert text.rstrip().endswith("GENERATE FACES")
    # The text says it all.
    s = Sketch()
    s.run(text)
    assert s.volume == pytest.approx(169_200, rel=1e-9)
    assert s.area == pytest.approx(20_968, rel=1e-9)
    drawn = [s.parts().lines[k].type for k in sorted(s.parts().lines)]
    assert sorted(drawn) == sorted(["X"] * 4 + ["Y"] * 5 + ["Z"] * 4 + ["XZ"] * 2)
    # The model beside it has the body.
    b.until(lambda: any(i["kind"] == "patch" or "solid" in i["name"] for i in b.hand("items()")))
    # From the empty page to the file of a printer: the signed volume of its triangles.
    b.page.get_by_role("button", name="Export").click()
    with b.page.expect_download(timeout=60_000) as found:
        b.page.get_by_role("option", name="Export: stl, ").click()
    stl = Path(found.value.path()).read_bytes()
    facets = np.frombuffer(stl[84:], np.dtype([("f", "<f4", (4, 3)), ("pad", "<u2")]))["f"]
    a, p, q = facets[:, 1:].astype(float).transpose(1, 0, 2)
    assert abs(np.einsum("ij,ij->", a, np.cross(p, q)) / 6) == pytest.approx(169_200, rel=1e-6)
    assert time.monotonic() - begin < 180
    b.page.locator("svg.paper").focus()
    # Each gesture is one step back, to the start, and forth again.
    steps = 0
    while b.text():
        b.key("Control+z")
        b.settle()
        steps += 1
        assert steps < 60
    # The object, 15 lines, 2 types, 5 dimensions, the body.
    assert steps == 24 and b.text() == ""
    for _ in range(steps):
        b.key("Control+Shift+z")
    b.settle()
    assert b.text() == text
    assert b.events < 150 and not b.faults


SITE = """load "dam.skt";
load "lock_wall.skt";
AbsPoint gate(dam.p4.x, 0, dam.p4.z);
print dam.volume;
"""


def test_sketches_of_a_model_are_drawn_beside_it(
    board: Callable[..., BoardHand], tmp_path: Path
) -> None:
    for name in ("dam.skt", "lock_wall.skt"):
        shutil.copy(ROOT / "examples/sketch" / name, tmp_path)
    dam, wall = tmp_path / "dam.skt", tmp_path / "lock_wall.skt"
    before = dam.read_text(encoding="utf-8")
    b = board(SITE, "site.sdl")
    assert not b.page.locator(".message.error").count()

    def text(path: Path) -> str:
        return str(b.page.evaluate("(f) => window.moldloft.text(f)", str(path)))

    # The first sketch that the model reads; the model follows each gesture before it is saved.
    assert b.settle()["drawn"]["object"] == "DAM"
    b.page.locator("g.mark.given text").filter(has_text=re.compile("CREST|16")).first.click()
    b.page.keyboard.type("20")
    b.key("Enter")
    b.settle()
    after = before.replace("= 16 IN", "= 20 IN")
    assert text(dam) == after and b.text() == SITE
    b.until(lambda: b.param("dam.CREST") == 20)
    wider = 169_200 + 4 * 90 * 50
    b.until(lambda: [float(x) for x in b.hand("model.printed")] == [pytest.approx(wider)])
    # The board shows the sketch whose tab is chosen, and the history is one over all of them.
    b.page.get_by_role("tab", name="lock_wall.skt").click()
    b.until(lambda: b.settle()["drawn"]["object"] == "WALL")
    b.key("Control+z")
    b.until(lambda: b.param("dam.CREST") == 16)
    b.until(lambda: b.settle()["drawn"]["object"] == "DAM")
    assert text(dam) == before
    b.key("Control+Shift+z")
    b.until(lambda: b.param("dam.CREST") == 20)
    b.settle()
    b.key("Control+s")
    b.until(lambda: dam.read_text(encoding="utf-8") == after)
    assert wall.read_text(encoding="utf-8") == text(wall)
    assert not b.faults


STEPS = {1: (0, 0), 2: (300, 3), 3: (298, 100), 4: (150, 98), 5: (152, 220), 6: (2, 221)}
STAIR = {1: (0, 0, 0), 2: (40, 0, 0), 3: (40, 0, 15), 4: (20, 0, 15), 5: (20, 0, 50), 6: (0, 0, 50)}


def test_a_section_is_drawn_dimensioned_and_extruded(board: Callable[..., BoardHand]) -> None:
    b = board()
    b.begin("Cross section in xz")
    b.chain(*(STEPS[k] for k in (1, 2, 3, 4, 5, 6, 1)))
    state = b.settle()
    assert [ln[3] for ln in state["drawn"]["lines"]] == ["X", "Z"] * 3
    assert state["solid"]["area"] > 0 and not state["solid"]["exact"]
    # A point is dragged: its own numbers in the text are others, and one step takes it back.
    before = b.text()
    b.key("v")
    x, y = b.at(*STEPS[6])
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    b.page.mouse.move(x + 8, y)
    b.page.mouse.move(x, y - 30)
    b.page.mouse.up()
    b.settle()
    moved = b.look()["drawn"]["points"][5]
    assert moved[1:3] == pytest.approx([2, 251], abs=1.5)
    assert b.text().count("POINT 6") == 1 and b.text() != before
    b.key("Control+z")
    b.settle()
    assert b.text() == before
    assert b.dimension_all(STAIR) == 4
    state = b.settle()
    assert state["solid"]["exact"]
    # A value is changed where it stands.
    b.page.locator("g.mark.given text").filter(has_text=" 15").first.click()
    b.page.keyboard.type("20")
    b.key("Enter")
    b.settle()
    assert b.text().count("= 20") >= 1 and " = 15\n" not in b.text()
    b.page.get_by_role("button", name="Extrude").click()
    b.page.keyboard.type("10")
    b.key("Enter")
    b.settle()
    s = Sketch()
    s.run(b.text())
    corners = [s.parts().points[k].at for k in range(1, 7)]
    assert corners[2][2] == 20
    ends = zip(corners, [*corners[1:], corners[0]], strict=True)
    twice = sum(p[0] * q[2] - q[0] * p[2] for p, q in ends)
    assert s.volume == pytest.approx(twice / 2 * 10, rel=1e-12)
    assert not b.faults


def test_typing_is_drawing_and_a_lost_process_loses_nothing(
    board: Callable[..., BoardHand],
) -> None:
    drawn, typed = board(name="a.skt"), board(name="b.skt")
    drawn.begin("Pictorial")
    drawn.chain((0, 0), (200, 0))
    drawn.key("z", "Escape")
    drawn.chain((200, 0), (60, 110))
    drawn.key("Escape")
    line = typed.page.get_by_role("textbox", name="sketch command")
    drawn.settle()
    for command in drawn.text().splitlines():
        line.fill(command)
        line.press("Enter")
        typed.hand("board.settled()")
    typed.settle()
    assert typed.text() == drawn.text()
    own = ("id", "version", "edits")
    one, two = (
        {k: v for k, v in x.look()["drawn"].items() if k not in own} for x in (typed, drawn)
    )
    assert one == two and len(one["lines"]) == 2
    # The board's process is killed: the next gesture finds another, with everything.
    [pid] = [p for p in children(drawn.process.pid) if "board" in arguments(p)]
    os.kill(pid, signal.SIGKILL)
    drawn.chain((60, 110), (60, 200))
    state = drawn.settle()
    assert len(state["drawn"]["lines"]) == 3 and not drawn.faults


def test_a_section_becomes_a_body_by_keys_alone(board: Callable[..., BoardHand]) -> None:
    b = board()
    press, status = b.page.keyboard.press, b.page.locator(".status")
    focus = """() => {
      const found = document.activeElement
      return found.matches('button, input') ? `${found.ariaLabel} ${found.textContent}` : ''
    }"""

    def tab_to(words: str, tab: str = "Shift+Tab") -> None:
        """Tab until something of that name has the focus."""
        for _ in range(20):
            press(tab)
            if words in b.page.evaluate(focus):
                return
        raise AssertionError(f"Tab does not come to {words}")

    b.page.get_by_role("button", name="Cross section in xz").wait_for()
    tab_to("Cross section in xz", "Tab")
    press("Enter")
    b.until(lambda: b.look()["drawn"]["object"])
    tab_to("sketch command", "Tab")
    for command in ("POINT 1 AT 0 0; POINT 2 AT 90 2; POINT 3 AT 91 40; POINT 4 AT 2 60",
                    "POLYLINE 1 2 3 4 CLOSE"):  # fmt: skip
        b.page.keyboard.type(command)
        b.key("Enter")
    press("Escape")
    # Points and lines are a list, one after the other announced with their types.
    told = []
    for _ in range(8):
        press("n")
        told.append(status.inner_text())
    assert told[:4] == [f"point {k}" for k in (1, 2, 3, 4)]
    assert told[4].startswith("line 1, 1 to 2, along x"), told
    assert told[5].startswith("line 2, 2 to 3, along z"), told
    assert "line 3, 3 to 4" in told[6] and "along" not in told[6]
    assert status.get_attribute("aria-live") == "polite" or status.get_attribute("role") == "status"
    b.key("z")
    press("Shift+n")
    press("n")
    assert status.inner_text() == "line 4, 4 to 1, along z, locked"
    lines = b.page.get_by_role("list", name="lines").get_by_role("listitem")
    assert lines.count() == 4 and lines.last.get_attribute("aria-label") == status.inner_text()
    # A point is moved, and each missing number opens where it is missing.
    b.key("n", "Shift+ArrowUp")
    assert b.settle()["drawn"]["points"][0][2] > 1
    b.key("Control+z")
    b.key("Escape")
    assert b.dimension_all({1: (0, 0, 0), 2: (9, 0, 0), 3: (9, 0, 4), 4: (0, 0, 6)}) == 3
    b.key("Escape")
    tab_to("Extrude")
    press("Enter")
    b.page.keyboard.type("2")
    b.key("Enter")
    solid = b.settle()["solid"]
    assert solid["exact"] and solid["volume"] == pytest.approx(2 * 9 * (4 + 6) / 2, rel=1e-12)
    assert not b.faults


def arguments(pid: int) -> list[str]:
    """The words that a process was started with."""
    return Path(f"/proc/{pid}/cmdline").read_text(encoding="utf-8").split("\0")


#: A picture of one grey pixel.
PIXEL = (
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNoAAAAggCBd81ytgAAAABJRU5ErkJggg=="
)


def test_lines_are_duplicated_over_a_picture(board: Callable[..., BoardHand]) -> None:
    b = board()
    b.begin("Pictorial: a solid with its depth")
    b.chain((0, 0), (0, 80), (70, 60), (75, -15), (0, 0))
    before = b.settle()["drawn"]
    assert len(before["lines"]) == 4
    # N goes through four points, then to the first line.
    for _ in range(5):
        b.page.keyboard.press("n")
    b.page.keyboard.press("Control+d")
    b.until(lambda: len(b.settle()["drawn"]["lines"]) == 5)
    after = b.settle()["drawn"]
    old, new = after["lines"][0], after["lines"][4]
    places = {p[0]: (p[1], p[2]) for p in after["points"]}
    moved = [[places[new[k]][c] - places[old[k]][c] for c in (0, 1)] for k in (1, 2)]
    assert len(places) == 6 and moved[0] == pytest.approx(moved[1]) and moved[0][0] > 0
    assert new[3] == old[3] and "LINE 5 FROM 5 TO 6" in b.text()
    b.page.keyboard.press("Control+z")
    b.until(lambda: len(b.settle()["drawn"]["lines"]) == 4)
    # A picture to trace over is below the drawing, follows the page, and is in no text.
    text = b.text()
    picture = {"name": "scan.png", "mimeType": "image/png", "buffer": base64.b64decode(PIXEL)}
    b.page.get_by_label("picture underneath").set_input_files([picture])
    image = b.page.locator("image.underlay")
    b.page.get_by_label("strength of the picture").wait_for()
    width = float(image.get_attribute("width") or 0)
    b.page.mouse.move(*b.at(30, 30))
    b.page.mouse.wheel(0, -200)
    b.until(lambda: float(image.get_attribute("width") or 0) > 1.2 * width)
    b.page.get_by_role("button", name="remove the picture").click()
    assert not image.is_visible() and b.text() == text
    # What the browser keeps is written after the click.
    b.page.wait_for_timeout(500)
    b.reload()
    assert not image.is_visible()
    words = {"name": "scan.png", "mimeType": "image/png", "buffer": b"no picture"}
    b.page.get_by_label("picture underneath").set_input_files([words])
    b.page.locator(".status").get_by_text("is no picture").wait_for()
    assert not b.faults


def framed(b: BoardHand) -> tuple[float, float, float, float]:
    """The picture underneath: left, top, width and height on the screen."""
    box = b.page.locator("image.underlay").bounding_box()
    assert box
    return box["x"], box["y"], box["width"], box["height"]


def pulled(b: BoardHand, handle: str, by: tuple[float, float]) -> None:
    box = b.page.locator(f"[data-underlay='{handle}']").bounding_box()
    assert box
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    b.page.mouse.move(x + by[0] / 2, y + by[1] / 2)
    b.page.mouse.move(x + by[0], y + by[1])
    b.page.mouse.up()


def laid(b: BoardHand) -> None:
    picture = {"name": "scan.png", "mimeType": "image/png", "buffer": base64.b64decode(PIXEL)}
    b.page.get_by_label("picture underneath").set_input_files([picture])
    b.page.get_by_label("strength of the picture").wait_for()


def test_a_picture_is_moved_scaled_and_kept(board: Callable[..., BoardHand]) -> None:
    b = board("SKETCH P\nAXES 345 40 90\nPOINT 1 AT 0 0\n")
    b.settle()
    laid(b)
    grips = b.page.locator("[data-underlay]")
    assert not grips.first.is_visible()
    b.key("v")
    x, y, width, height = framed(b)
    pulled(b, "move", (-40, 30))
    assert framed(b) == pytest.approx((x - 40, y + 30, width, height), abs=0.6)
    # The corner follows, the opposite one stays, and so do the proportions.
    pulled(b, "right lower", (0.25 * width, 0.25 * height))
    assert framed(b) == pytest.approx((x - 40, y + 30, 1.25 * width, 1.25 * height), abs=0.6)
    pulled(b, "left upper", (0.25 * width, 0.25 * height))
    x, y = x - 40 + 0.25 * width, y + 30 + 0.25 * height
    assert framed(b) == pytest.approx((x, y, width, height), abs=0.6)
    # By keys: a pixel, or ten.
    b.page.locator("[data-underlay='move']").focus()
    for key in ("ArrowLeft", "Shift+ArrowUp"):
        b.page.keyboard.press(key)
    assert framed(b) == pytest.approx((x - 1, y - 10, width, height), abs=0.6)
    # It goes with the page, and is there again after a reload, as strong as it was.
    b.page.get_by_label("strength of the picture").fill("0.8")
    origin, text = b.at(0, 0), b.text()
    before = [v / width for v in (x - 1 - origin[0], y - 10 - origin[1])]
    b.reload()
    image = b.page.locator("image.underlay")
    b.until(image.is_visible)

    def kept() -> bool:
        x, y, width, _ = framed(b)
        origin = b.at(0, 0)
        found = [(x - origin[0]) / width, (y - origin[1]) / width]
        return bool(found == pytest.approx(before, abs=0.01))

    b.until(kept)
    assert image.get_attribute("opacity") == "0.8" and b.text() == text
    assert not b.faults


def test_the_axes_of_a_picture_are_set_by_four_clicks(board: Callable[..., BoardHand]) -> None:
    b = board("SKETCH P\nAXES 345 40 90\nPOINT 1 AT 0 0\nPOINT 2 AT 60 5\nLINE 1 2\n")
    b.settle()
    laid(b)
    b.page.get_by_role("button", name="Axes of the picture").click()
    ways = {"x": 350.0, "z": 80.0}
    for axis, degrees in ways.items():
        if axis == "z":
            # The second line is along z, not y.
            b.page.keyboard.press("z")
        a = math.radians(degrees)
        b.click(30, 20)
        # A second end on the first is none.
        b.click(30, 20)
        b.click(30 + 120 * math.cos(a), 20 + 120 * math.sin(a))
    b.settle()
    found = re.search(r"^AXES ([\d.]+) ([\d.]+) ([\d.]+)$", b.text(), re.M)
    assert found
    angles = [float(x) for x in found.groups()]
    assert angles == pytest.approx([350, 40, 80], abs=0.6), b.text()
    assert "POINT 3" not in b.text() and len(b.hand("steps().done")) == 1
    b.key("Control+z")
    assert "AXES 345 40 90" in b.text()
    # Escape leaves all as it was.
    b.page.get_by_role("button", name="Axes of the picture").click()
    b.click(30, 20)
    b.key("Escape")
    b.click(30, 80)
    b.settle()
    assert "AXES 345 40 90" in b.text() and b.look()["chain"] == 1


def test_the_picture_of_a_section_is_turned(board: Callable[..., BoardHand]) -> None:
    text = "SKETCH P 2D XZ\nPOINT 1 AT 0 0\n"
    b = board(text)
    b.settle()
    laid(b)
    b.page.get_by_role("button", name="Axes of the picture").click()
    # The picture is drawn 6 degrees aslant.
    for degrees in (6, 96):
        a = math.radians(degrees)
        b.click(10, 10)
        b.click(10 + 150 * math.cos(a), 10 + 150 * math.sin(a))
    turned = b.page.locator("image.underlay").get_attribute("transform") or ""
    angle = re.match(r"rotate\(([-\d.]+) ", turned)
    # Clockwise on the screen.
    assert angle and float(angle[1]) == pytest.approx(6, abs=0.4), turned
    assert b.text() == text and not b.faults


#: A retaining wall in metres, and where its corners are in a scan that lies 6 degrees aslant.
WALL = {
    1: (0, 0, 0), 2: (4, 0, 0), 3: (4, 0, 0.6), 4: (1.6, 0, 0.6), 5: (1.1, 0, 4), 6: (0, 0, 4),
}  # fmt: skip
ASLANT = math.radians(6)


def in_scan(corner: int) -> tuple[float, float]:
    """A corner of the wall as fractions of the width and the height of the scan."""
    x, _, z = WALL[corner]
    u, v = (
        x * math.cos(ASLANT) - z * math.sin(ASLANT),
        x * math.sin(ASLANT) + z * math.cos(ASLANT),
    )
    return (70 + 70 * u) / 400, (310 - 70 * v) / 340


def scan() -> bytes:
    """The scan as PNG: dark lines on grey paper."""
    paper = np.full((340, 400), 215, np.uint8)
    ring = [*range(1, 7), 1]
    for a, b in itertools.pairwise(map(in_scan, ring)):
        way = np.linspace(a, b, 400) * (400, 340)
        paper[way[:, 1].astype(int), way[:, 0].astype(int)] = 20

    def chunk(kind: bytes, data: bytes) -> bytes:
        check = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", check)

    rows = b"".join(b"\0" + row.tobytes() for row in paper)
    head = struct.pack(">IIBBBBB", 400, 340, 8, 0, 0, 0, 0)
    parts = chunk(b"IHDR", head), chunk(b"IDAT", zlib.compress(rows)), chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


def test_a_section_is_traced_over_a_scan(board: Callable[..., BoardHand]) -> None:
    b = board()
    b.begin("Cross section in xz")
    picture = {"name": "wall.png", "mimeType": "image/png", "buffer": scan()}
    b.page.get_by_label("picture underneath").set_input_files([picture])
    b.page.get_by_label("strength of the picture").wait_for()

    def seen(corner: int) -> tuple[float, float]:
        """Where a corner of the scan is on the screen."""
        x, y = b.page.evaluate(
            """([u, v]) => {
              const i = document.querySelector('image.underlay')
              const of = (name) => Number(i.getAttribute(name))
              const p = new DOMPoint(of('x') + u * of('width'), of('y') + v * of('height'))
              const { x, y } = p.matrixTransform(i.getScreenCTM())
              return [x, y]
            }""",
            in_scan(corner),
        )
        return float(x), float(y)

    def click(corner: int) -> None:
        x, y = seen(corner)
        b.page.mouse.move(x + 6, y + 4)
        b.page.mouse.move(x + chance.uniform(-1, 1), y + chance.uniform(-1, 1))
        b.page.mouse.down()
        b.page.mouse.up()
        b.hand("board.settled()")

    chance = random.Random(8)
    # The base along x and the back along z: then the scan is straight under the page.
    b.page.get_by_role("button", name="Axes of the picture").click()
    for corner in (1, 2, 1, 6):
        click(corner)
    (x1, y1), (x2, y2), (x6, y6) = map(seen, (1, 2, 6))
    assert abs(y2 - y1) < 0.015 * (x2 - x1) and abs(x6 - x1) < 0.015 * (y1 - y6)
    # Each corner is a click on the scan, and the last one is on the first.
    b.key("d")
    for corner in (1, 2, 3, 4, 5, 6, 1):
        click(corner)
    lines = b.settle()["drawn"]["lines"]
    assert [ln[3] for ln in lines][:3] == ["X", "Z", "X"] and len(lines) == 6, lines
    assert [ln[3] for ln in lines][4:] == ["X", "Z"] and lines[3][3] not in ("X", "Z")
    # What was traced is the wall before any dimension: its widths to a pixel's worth.
    places = {p[0]: p[1:3] for p in b.look()["drawn"]["points"]}
    size = places[2][0] - places[1][0]
    for corner, (x, _, z) in WALL.items():
        u, v = ((places[corner][k] - places[1][k]) / size * 4 for k in (0, 1))
        assert (u, v) == pytest.approx((x, z), abs=0.06), corner
    assert b.dimension_all(WALL) == 5
    b.page.get_by_role("button", name="Extrude").click()
    b.page.keyboard.type("2")
    b.key("Enter")
    solid = b.settle()["solid"]
    area = 4 * 0.6 + (1.6 + 1.1) / 2 * 3.4
    assert solid["exact"] and solid["volume"] == pytest.approx(2 * area, rel=1e-9)
    sketch = Sketch()
    sketch.run(b.text())
    assert sketch.volume == pytest.approx(2 * area, rel=1e-9)
    assert not b.faults


def cuboid() -> str:
    """A cube's picture, whose three dimensions are given: 6, 4 and 3."""
    kept = [row for row in nested().splitlines() if not row.startswith("DIMENSION")]
    drawn = [row for row in kept if " TYPE O" not in row and not inner(row)]
    given = ["DIMENSION X 1 2 6", "DIMENSION Y 2 3 4", "DIMENSION Z 1 5 3"]
    return "\n".join(drawn + given) + "\n"


def test_faces_are_traced_one_by_one(board: Callable[..., BoardHand]) -> None:
    text = cuboid()
    b = board(text, "cube.skt")
    b.until(lambda: b.settle()["solid"] and b.look()["solid"]["exact"])
    b.page.get_by_role("button", name="Trace the faces").click()
    b.settle()
    assert b.text() == text + "GENERATE FACES ASK\n"
    asked = b.page.get_by_role("group", name="face to judge")
    first = b.look()["drawn"]["asked"]
    assert len(first) == 1 and len(first[0]) == 4
    assert asked.get_by_role("status").inner_text() == f"Face {' '.join(map(str, first[0]))}?"
    assert b.page.locator("path.asked").count() == 1 and b.page.locator("path.run").count() == 4
    # The first may be run through either way.
    asked.get_by_role("button", name="Reverse").click()
    b.settle()
    assert b.look()["drawn"]["asked"] == [first[0][::-1]]
    asked.get_by_role("button", name="Reverse").click()
    b.settle()
    asked.get_by_role("button", name="Accept").click()
    b.settle()
    # Its neighbour may not: the reason is given, and the text stays.
    before = b.text()
    second = b.look()["drawn"]["asked"]
    assert second != first
    if set(second[0]) & set(first[0]):
        asked.get_by_role("button", name="Reverse").click()
        b.page.locator(".status").get_by_text("cannot be reversed").wait_for()
        assert b.text() == before and b.look()["drawn"]["asked"] == second
    # Undo asks again about the first.
    b.key("Control+z")
    b.until(lambda: b.settle()["drawn"]["asked"] == first)
    b.key("Control+Shift+z")
    b.until(lambda: b.settle()["drawn"]["asked"] == second)
    b.key("Enter")
    while b.look()["drawn"]["asked"] is not None:
        asked.get_by_role("button", name="Accept").click()
        b.settle()
    state = b.settle()
    assert not asked.is_visible() and state["drawn"]["faces"] == 6
    assert b.text().count("ACCEPT") == 6
    volume = float(b.page.locator(".board-solid").get_attribute("data-volume") or "nan")
    assert abs(volume) == pytest.approx(72, rel=1e-9)
    s = Sketch()
    s.run(b.text())
    assert abs(s.volume) == pytest.approx(72, rel=1e-9)
    assert not b.faults


def test_a_rejected_face_is_left_out(board: Callable[..., BoardHand]) -> None:
    b = board(cuboid() + "GENERATE FACES ASK\n", "cube.skt")
    b.settle()
    asked = b.page.get_by_role("group", name="face to judge")
    first = b.look()["drawn"]["asked"]
    asked.get_by_role("button", name="Reject").click()
    b.settle()
    assert b.text().endswith("GENERATE FACES ASK\nREJECT\n")
    assert b.look()["drawn"]["asked"] not in (None, first)


def nested() -> str:
    """A cube in a cube with lines between their corners: three solids fit."""
    ways = [(math.cos(math.radians(a)), math.sin(math.radians(a))) for a in (345, 40, 90)]
    lines = ["SKETCH C", "AXES 345 40 90"]
    cubes = [
        (x, y, z)
        for low, high in ((0, 60), (20, 40))
        for z in (low, high)
        for x, y in ((low, low), (high, low), (high, high), (low, high))
    ]
    for k, place in enumerate(cubes, 1):
        u, v = (sum(x * w[i] for x, w in zip(place, ways, strict=True)) for i in (0, 1))
        lines.append(f"POINT {k} AT {u:.6f} {v:.6f}")
    edges = {
        "X": [(1, 2), (3, 4), (5, 6), (7, 8)],
        "Y": [(2, 3), (4, 1), (6, 7), (8, 5)],
        "Z": [(1, 5), (2, 6), (3, 7), (4, 8)],
    }
    for axis, ends in edges.items():
        for first in (0, 8):
            lines += [f"LINE FROM {first + a} TO {first + b} TYPE {axis}" for a, b in ends]
    lines += [f"LINE FROM {k} TO {k + 8} TYPE O" for k in range(1, 9)]
    for axis, (a, b, c, d) in {"X": (1, 2, 9, 10), "Y": (2, 3, 10, 11), "Z": (1, 5, 9, 13)}.items():
        lines += [f"DIMENSION {axis} {p} {q} {x}" for p, q, x in ((a, b, 6), (a, c, 2), (c, d, 2))]
    return "\n".join(lines) + "\n"


def test_one_of_several_solids_is_chosen_by_its_picture(board: Callable[..., BoardHand]) -> None:
    text = nested()
    b = board(text, "nested.skt")
    b.settle()
    fits = b.page.get_by_role("group", name="solids that fit").get_by_role("button")
    b.until(lambda: fits.count() == 3)
    fits.nth(1).click()
    b.settle()
    assert b.text() == text + "GENERATE FACES\nCHOOSE 2\n"
    b.until(lambda: fits.nth(1).get_attribute("aria-pressed") == "true")
    # The drawing stays, though the question is still open; another choice is one command more.
    assert len(b.look()["drawn"]["lines"]) == 32
    fits.nth(2).click()
    b.settle()
    assert b.text().endswith("CHOOSE 2\nCHOOSE 3\n")
    b.until(lambda: fits.nth(2).get_attribute("aria-pressed") == "true")
    volume = float(b.page.locator(".board-solid").get_attribute("data-volume") or "nan")
    assert volume == pytest.approx(416 / 3, rel=1e-9)


def test_the_drawing_lies_over_the_picture_of_the_solid(board: Callable[..., BoardHand]) -> None:
    # The outer cube and the inner one, in a page that was moved under the picture.
    b = board(nested(), "nested.skt")
    solid = b.page.locator(".board-solid")
    b.settle()
    b.until(lambda: solid.get_attribute("data-volume"))
    drawn = b.look()["drawn"]
    places = {p: (u, v) for p, u, v, *_ in drawn["points"]}
    ends = [(places[p], places[q]) for _, p, q, *_ in drawn["lines"]]
    (p, q) = ends[0]
    middle = ((p[0] + q[0]) / 2, (p[1] + q[1]) / 2)
    box = solid.bounding_box()
    assert box
    x, y = b.at(*middle)
    b.page.mouse.move(x, y)
    b.page.mouse.down(button="right")
    b.page.mouse.move(x + 20, y)
    b.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    b.page.mouse.up(button="right")
    b.key("v")
    b.click(*middle)
    number = drawn["lines"][0][0]
    assert b.page.locator(f"[data-line='{number}'].chosen").count() == 1
    b.key("Escape")
    # Beside the lines it is the picture that is turned, and nothing else moves.
    screen = [(b.at(*p), b.at(*q)) for p, q in ends]

    def free(at: tuple[float, float]) -> float:
        return min(beside(at, *line) for line in screen)

    inside = [
        (box["x"] + box["width"] * i / 12, box["y"] + box["height"] * j / 12)
        for i in range(2, 11)
        for j in range(2, 11)
    ]
    at = max((one for one in inside if not marked(b, one)), key=free)
    assert free(at) > 12
    text, seen = b.text(), solid.locator("canvas").screenshot()
    b.page.mouse.move(*at)
    b.page.mouse.down()
    b.page.mouse.move(at[0] + 10, at[1] + 2)
    b.page.mouse.move(at[0] + 60, at[1] + 20)
    b.page.mouse.up()
    b.settle()
    assert solid.locator("canvas").screenshot() != seen
    assert [(b.at(*p), b.at(*q)) for p, q in ends] == screen and b.text() == text
    assert not b.faults


def marked(b: BoardHand, at: tuple[float, float]) -> bool:
    """True where a dimension or another control is."""
    found = "([x, y]) => document.elementFromPoint(x, y).matches('svg.paper') ? '' : 'x'"
    return bool(b.page.evaluate(found, list(at)))


def beside(at: tuple[float, float], p: tuple[float, float], q: tuple[float, float]) -> float:
    """The distance of a place from a line."""
    u, v = q[0] - p[0], q[1] - p[1]
    t = ((at[0] - p[0]) * u + (at[1] - p[1]) * v) / max(u * u + v * v, 1e-9)
    t = min(1.0, max(0.0, t))
    return math.dist(at, (p[0] + t * u, p[1] + t * v))


def test_a_depth_that_nothing_determines_is_slid(board: Callable[..., BoardHand]) -> None:
    # The outer cube alone, without dimensions.
    kept = [row for row in nested().splitlines() if not row.startswith("DIMENSION")]
    last = [row for row in kept if " TYPE O" in row]
    text = "\n".join(row for row in kept if row not in last and not inner(row)) + "\n"
    b = board(text, "cube.skt")
    b.settle()
    solid = b.page.locator(".board-solid")
    b.until(lambda: float(solid.get_attribute("data-volume") or 0) > 0)
    before = float(solid.get_attribute("data-volume") or 0)
    b.key("Tab")
    slider = b.page.locator(".board-box input[type=range]")
    box = slider.bounding_box()
    assert box
    y, x = box["y"] + box["height"] / 2, box["x"] + box["width"] / 2
    b.page.mouse.move(x, y)
    b.page.mouse.down()
    b.page.mouse.move(x + box["width"] / 4, y, steps=5)
    b.until(lambda: float(solid.get_attribute("data-volume") or 0) > 1.5 * before)
    assert b.text() == text
    b.page.mouse.up()
    b.settle()
    added = b.text().replace(text, "")
    assert re.fullmatch(r"DIMENSION D1 [XYZ] \d TO \d = [\d.]+\n", added), b.text()
    # The estimate is now of that dimension, and what was tried without it is gone.
    b.until(lambda: float(solid.get_attribute("data-volume") or 0) > 1.5 * before)
    b.page.keyboard.press("Escape")
    b.page.keyboard.press("Control+z")
    b.settle()
    assert b.text() == text
    b.until(lambda: abs(float(solid.get_attribute("data-volume") or 0) / before - 1) < 1e-9)


def inner(row: str) -> bool:
    """True for a command with a point of the cube inside."""
    words = row.split()
    points = words[1:2] if words[0] == "POINT" else words[2:5:2] if words[0] == "LINE" else []
    return any(int(p) > 8 for p in points)


def test_strokes_become_lines_arcs_and_circles(board: Callable[..., BoardHand]) -> None:
    b = board()
    b.begin("xy")

    def along(*corners: tuple[float, float]) -> list[tuple[float, float]]:
        # A steady hand: half a unit of tremor.
        parts = [(p, q, k / 25) for p, q in itertools.pairwise(corners) for k in range(25)]
        path = [(p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])) for p, q, t in parts]
        path.append(corners[-1])
        return [
            (u + 0.5 * math.sin(1.7 * k), v + 0.5 * math.cos(2.3 * k))
            for k, (u, v) in enumerate(path)
        ]

    b.trace(along((0, 0), (300, 2), (299, 200), (1, 198), (2, 3)))
    state = b.settle()
    assert len(state["drawn"]["lines"]) == 4 and len(state["drawn"]["points"]) == 4
    # A line drawn nearly straight stays one line, from corner to corner.
    b.trace(along((0, 0), (299, 200)))
    assert len(b.settle()["drawn"]["lines"]) == 5
    b.key("Control+z")
    turn = [k * math.tau / 60 for k in range(61)]
    b.trace([(150 + 60 * math.cos(a), 100 + 60 * math.sin(a)) for a in turn])
    assert re.search("CIRCLE", b.text())
    for _ in range(2):
        b.key("Control+z")
    assert b.settle()["drawn"]["lines"] == []
    assert not b.faults
