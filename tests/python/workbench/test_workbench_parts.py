"""Parts that are drawn by hand with noise and dimensioned through the page become exact solids.

The hand knows places of the page only: outlines at wrong scales, each corner beside its place. The
volumes are closed forms. One part in the ordinary run, all under `MOLDLOFT_SOAK`.
"""

from __future__ import annotations

import itertools
import math
import os
import random
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from board_by_hand import BoardHand
from moldloft import Sketch
from page_in_browser import needs_page

pytestmark = needs_page

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

Place = tuple[float, float, float]


@dataclass
class Part:
    """Corners, chains of lines as a hand draws them, single strokes, and the volume."""

    corners: list[Place]
    chains: list[list[int]]
    strokes: list[tuple[int, int]]
    volume: float


def prism(depth: float, *outline: tuple[float, float]) -> Part:
    """An outline in x and z, drawn out along y."""
    n = len(outline)
    ends = zip(outline, [*outline[1:], outline[0]], strict=True)
    area = abs(sum(p[0] * q[1] - q[0] * p[1] for p, q in ends)) / 2
    return Part(
        [(x, y, z) for y in (0.0, depth) for x, z in outline],
        [[*range(n), 0], [0, *range(n, 2 * n), n]],
        [(k, k + n) for k in range(1, n)],
        area * depth,
    )


def pierced(outer: Part, *hole: tuple[float, float]) -> Part:
    """A prism with a hole through all of it, an outline in x and z."""
    depth = max(y for _, y, _ in outer.corners)
    inner, n = prism(depth, *hole), len(outer.corners)
    return Part(
        outer.corners + inner.corners,
        outer.chains + [[k + n for k in chain] for chain in inner.chains],
        outer.strokes + [(p + n, q + n) for p, q in inner.strokes],
        outer.volume - inner.volume,
    )


def hipped(length: float, width: float, wall: float, hip: float, rise: float) -> Part:
    """A house whose roof falls to all four sides, as steep at the ends as its hips are long."""
    base = [(0.0, 0.0), (length, 0.0), (length, width), (0.0, width)]
    corners = [(x, y, z) for z in (0.0, wall) for x, y in base]
    corners += [(hip, width / 2, wall + rise), (length - hip, width / 2, wall + rise)]
    # The roof: a prism as long as the ridge, and a pyramid of both ends.
    ridge = length - 2 * hip
    roof = width * rise * ridge / 2 + 2 * hip * width * rise / 3
    return Part(
        corners,
        [[0, 1, 2, 3, 0], [0, 4, 5, 6, 7, 4], [4, 8, 9, 5]],
        [(1, 5), (2, 6), (3, 7), (7, 8), (6, 9)],
        length * width * wall + roof,
    )


PARTS = {
    "dam": prism(50, (0, 0), (70, 0), (16, 72), (16, 90), (0, 90)),
    "bracket": prism(3, (0, 0), (6, 0), (6, 1), (1, 1), (1, 4), (0, 4)),
    "hip roof": hipped(12, 8, 3, 3, 2.5),
    "gable": prism(9, (0, 0), (6, 0), (6, 3), (3, 5), (0, 3)),
    "block": prism(4, (0, 0), (7, 0), (7, 5), (0, 5)),
    "stair": prism(10, (0, 0), (30, 0), (30, 17), (20, 17), (20, 34), (10, 34), (10, 51), (0, 51)),
    "tee": prism(20, (30, 0), (40, 0), (40, 60), (70, 60), (70, 75), (0, 75), (0, 60), (30, 60)),
    "channel": prism(25, (0, 0), (40, 0), (40, 30), (32, 30), (32, 6), (8, 6), (8, 30), (0, 30)),
    "zed": prism(8, (0, 0), (24, 0), (24, 16), (40, 16), (40, 22), (18, 22), (18, 6), (0, 6)),
    "ramp": prism(12, (0, 0), (40, 0), (0, 15)),
    "trapezoid": prism(6, (0, 0), (20, 0), (15, 8), (4, 8)),
    "wall": prism(30, (0, 0), (9, 0), (9, 2), (4, 2), (3, 14), (1, 14), (1, 2), (0, 2)),
    "vee block": prism(15, (0, 0), (30, 0), (30, 20), (15, 6), (0, 20)),
    "chamfered": prism(18, (0, 0), (25, 0), (25, 12), (20, 16), (0, 16)),
    "dovetail": prism(
        22, (0, 0), (40, 0), (40, 10), (26, 10), (30, 18), (10, 18), (14, 10), (0, 10)
    ),
    "shed": prism(7, (0, 0), (8, 0), (8, 3), (0, 5)),
    "hexagon": prism(5, (4, 0), (12, 0), (16, 6), (12, 12), (4, 12), (0, 6)),
    "anvil": prism(9, (6, 0), (18, 0), (15, 9), (24, 15), (24, 19), (0, 19), (0, 15), (9, 9)),
    "keel": prism(33, (0, 10), (4, 0), (9, 0), (13, 10), (13, 24), (0, 24)),
    "step": prism(11, (0, 0), (21, 0), (21, 6), (9, 6), (9, 13), (0, 13)),
    "notch": prism(6, (0, 0), (28, 0), (28, 14), (17, 14), (17, 8), (11, 8), (11, 14), (0, 14)),
    "saddle": prism(14, (0, 0), (36, 0), (36, 12), (28, 12), (23, 5), (13, 5), (8, 12), (0, 12)),
    "hopper": prism(10, (8, 0), (14, 0), (22, 11), (22, 17), (0, 17), (0, 11)),
    "retaining": prism(40, (0, 0), (19, 0), (19, 3), (8, 3), (6, 25), (3, 25), (3, 3), (0, 3)),
    # examples/sketch/lock_wall.skt
    "lock wall": pierced(
        prism(35, (0, 0), (42, 0), (42, 8), (30, 8), (30, 30), (14, 52), (14, 60), (0, 60)),
        (6, 6), (18, 6), (18, 20), (6, 20),
    ),
}  # fmt: skip
CHOSEN = sorted(PARTS) if SOAK else ["bracket"]

#: Directions of the axes on the page, in degrees.
AXES = (345.0, 40.0, 90.0)
#: Picture points that a corner is drawn beside its place.
NOISE = 2.5


@pytest.fixture
def board(tmp_path: Path, browser: Any) -> Iterator[BoardHand]:
    path = tmp_path / "part.skt"
    path.write_text("", encoding="utf-8")
    made = BoardHand(path, browser)
    yield made
    made.close()


def on_page(part: Part, chance: random.Random) -> list[tuple[float, float]]:
    """Where a hand draws the corners: the axes at scales of their own, none of them right, and
    so chosen that no corner is drawn on another one or on a line that it is not of."""
    sizes = [max(c[k] for c in part.corners) - min(c[k] for c in part.corners) for k in range(3)]
    ways = [(math.cos(math.radians(a)), math.sin(math.radians(a))) for a in AXES]
    lines = [pair for c in part.chains for pair in itertools.pairwise(c)] + part.strokes

    def drawn() -> list[tuple[float, float]]:
        scales = [chance.uniform(170, 300) / size for size in sizes]
        return [
            tuple(
                sum(c[k] * scales[k] * ways[k][i] for k in range(3)) + chance.uniform(-NOISE, NOISE)
                for i in range(2)
            )
            for c in part.corners
        ]  # type: ignore[misc]

    def room(places: list[tuple[float, float]]) -> float:
        apart = [math.dist(p, q) for p, q in itertools.combinations(places, 2)]
        beside = [
            distance(places[k], places[i], places[j])
            for i, j in lines
            for k in range(len(places))
            if k not in (i, j)
        ]
        return min(*apart, *beside)

    return max((drawn() for _ in range(40)), key=room)


def distance(at: tuple[float, float], p: tuple[float, float], q: tuple[float, float]) -> float:
    """From a place to a line."""
    u, v = q[0] - p[0], q[1] - p[1]
    t = ((at[0] - p[0]) * u + (at[1] - p[1]) * v) / (u * u + v * v)
    t = min(1.0, max(0.0, t))
    return math.dist(at, (p[0] + t * u, p[1] + t * v))


def type_of(p: Place, q: Place) -> str:
    """The type of a line: the axes along which its ends differ."""
    along = "".join(a for a, x, y in zip("XYZ", p, q, strict=True) if x != y)
    return along if len(along) < 3 else "O"


KEYS = {"X": "x", "Y": "y", "Z": "z", "XY": "h", "YZ": "p", "XZ": "f", "O": "o"}


def away(p: tuple[float, float], q: tuple[float, float], others: list[Any]) -> tuple[float, float]:
    """The place on a line that is farthest from all others."""

    def gap(at: tuple[float, float]) -> float:
        return min(distance(at, *other) for other in others)

    steps = [k / 20 for k in range(3, 18)]
    return max(((p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])) for t in steps), key=gap)


@pytest.mark.parametrize("name", CHOSEN)
def test_a_part_is_drawn_and_dimensioned(name: str, board: BoardHand) -> None:
    b, part = board, PARTS[name]
    chance = random.Random(name)
    places = on_page(part, chance)
    b.begin("Pictorial")
    for chain in part.chains:
        b.chain(*(places[k] for k in chain))
        if chain[-1] not in chain[:-1]:
            b.key("Escape")
    for p, q in part.strokes:
        b.stroke(places[p], places[q])
    drawn = b.settle()["drawn"]
    at = {k: (u, v) for k, u, v, *_ in drawn["points"]}
    # Whichever number the board gave a corner, it is the one that is drawn there.
    corner = {
        k: min(range(len(places)), key=lambda j, w=w: math.dist(places[j], w))
        for k, w in at.items()
    }
    assert sorted(corner.values()) == list(range(len(part.corners))), b.text()
    wanted = {frozenset(pair) for c in part.chains for pair in itertools.pairwise(c)}
    wanted |= {frozenset(pair) for pair in part.strokes}
    found = {frozenset((corner[ln[1]], corner[ln[2]])) for ln in drawn["lines"]}
    assert found == wanted, b.text()
    # What the hand knows better than the guess is said by a click and a key.
    b.key("v")
    for _, p, q, kind, *_ in drawn["lines"]:
        right = type_of(part.corners[corner[p]], part.corners[corner[q]])
        if kind != right:
            others = [(at[r], at[s]) for _, r, s, *_ in drawn["lines"] if {r, s} != {p, q}]
            b.click(*away(at[p], at[q], others))
            b.key(KEYS[right])
            assert b.type_of(p, q) == right, b.text()
    # The faces of a hole are in the planes of those around it: a click on what is proposed.
    aligned = b.page.get_by_role("log", name="doubts and contradictions").get_by_role(
        "button", name="ALIGN"
    )
    for _ in range(6):
        if not aligned.count():
            break
        aligned.first.click()
        b.events += 1
        b.settle()
    b.dimension_all({k: part.corners[j] for k, j in corner.items()})
    state = b.settle()
    assert state["solid"]["exact"], b.text()
    assert state["solid"]["volume"] == pytest.approx(part.volume, rel=1e-9)
    b.key("Enter")
    b.settle()
    s = Sketch()
    s.run(b.text())
    assert s.volume == pytest.approx(part.volume, rel=1e-9), b.text()
    assert not b.faults
    print(name, len(drawn["lines"]), "lines", b.events, "events")


def test_an_l_bracket_with_a_fillet_in_sixty_events(board: BoardHand) -> None:
    b = board
    outline = [(0, 0), (6, 0), (6, 1), (1, 1), (1, 4), (0, 4)]
    page = [(0, 2), (298, 0), (301, 62), (52, 60), (50, 214), (2, 212)]
    b.begin("Cross section in xz")
    b.chain(*page, page[0])
    places = {k: (x, 0.0, z) for k, (x, z) in enumerate(outline, 1)}
    given = b.dimension_all(places)
    # Each number is one digit.
    b.events += given
    b.key("v")
    b.click(*page[3])
    b.key("r", "1", "Enter")
    b.page.get_by_role("button", name="Extrude").click()
    b.key("3", "Enter")
    b.events += 1
    state = b.settle()
    volume = 3 * (9 + 1 - math.pi / 4)
    s = Sketch()
    s.run(b.text())
    assert s.volume == pytest.approx(volume, rel=1e-9), b.text()
    assert state["drawn"]["faces"] or state["solid"]["made"]
    assert b.events <= 60, b.events
    for _ in b.hand("steps().done"):
        b.page.keyboard.press("Control+z")
        b.settle()
    assert b.text() == ""
    assert not b.faults
    print("L-bracket:", b.events, "events")


def test_shapes_are_made_of_what_is_chosen(board: BoardHand) -> None:
    b = board
    b.begin("Cross section in xz")
    page = [(100, 0), (250, 2), (248, 120), (102, 121)]
    b.chain(*page, page[0])
    b.dimension_all({1: (5, 0, 0), 2: (9, 0, 0), 3: (9, 0, 3), 4: (5, 0, 3)})
    bar = b.page.get_by_role("toolbar", name="drawing")

    def answer(words: str, value: str) -> None:
        bar.get_by_role("button", name=words).click()
        b.page.locator(".board-box input[type=text]").wait_for()
        b.page.keyboard.type(value)
        b.key("Enter")
        b.settle()

    # A ring: the section turned about its left side, which is then the axis.
    b.key("v")
    at = b.look()["drawn"]["points"]
    left = [p for p in at if p[0] in (1, 4)]
    (_, a, c, *_), (_, d, e, *_) = left
    b.click((3 * a + d) / 4, (3 * c + e) / 4)
    answer("Revolve", "360")
    s = Sketch()
    s.run(b.text())
    assert s.volume == pytest.approx(math.pi * 16 * 3, rel=1e-9), b.text()
    b.page.keyboard.press("Control+z")
    b.settle()
    # A plate, drilled from its top; what is refused leaves the text.
    answer("Extrude", "2")
    s = Sketch()
    s.run(b.text())
    assert s.volume == pytest.approx(24, rel=1e-9)
    text = b.text()
    answer("Hole", "nothing")
    assert b.text() == text and b.page.locator(".board-box.refused").is_visible()
    b.page.keyboard.press("Escape")
    answer("Hole", "1 at 2 1")
    s = Sketch()
    s.run(b.text())
    assert s.volume == pytest.approx(24 - 3 * math.pi / 4, rel=1e-9), b.text()
    assert not b.faults
