"""Strokes of a pen, proposed types and snaps as data, in Python and on the board."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest

from moldloft import Error, Sketch
from moldloft.shapes.sketch_values import SketchStroke
from moldloft.workbench.board import Board, answered


def along(*corners: tuple[float, float]) -> np.ndarray:
    """Samples of a polyline, 30 for each side."""
    part = np.linspace(0, 1, 30, endpoint=False)[:, None]
    rows = [np.array(a) + part * (np.array(b) - np.array(a)) for a, b in pairwise(corners)]
    return np.vstack([*rows, [corners[-1]]])


SQUARE = along((0, 0), (300, 2), (299, 200), (1, 198), (0, 0))


def test_a_square_has_four_lines_and_becomes_a_solid() -> None:
    sketch = Sketch()
    sketch.run("SKETCH A 2D XZ")
    stroke, changes = sketch.stroke(SQUARE + np.random.default_rng(1).normal(0, 0.5, SQUARE.shape))
    assert stroke.closed and [p.kind for p in stroke.pieces] == ["line"] * 4
    assert 0 < stroke.noise < 2 and stroke.tolerance >= 5 * stroke.noise
    assert len(changes[0].drawn) == len(changes[0].lines) == 4
    sketch.edit("ACCEPT ALL; EXTRUDE 10")
    assert sketch.volume == pytest.approx(300 * 199 * 10, rel=0.03)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_a_circle_has_its_radius(scale: float) -> None:
    t = np.linspace(0, 2 * np.pi, 120)
    [piece] = SketchStroke.of(scale * np.c_[3 + 2 * np.cos(t), 2 * np.sin(t)]).pieces
    assert piece.kind == "circle" and piece.centre is not None
    assert piece.radius == pytest.approx(2 * scale, rel=1e-3)
    assert piece.centre == pytest.approx((3 * scale, 0), abs=1e-3 * scale)


def test_time_orders_samples_and_pressure_lifts_the_pen() -> None:
    rows = np.c_[SQUARE, np.arange(len(SQUARE)), np.full(len(SQUARE), 0.5)]
    lifted = [[900.0, 900.0, -1.0, 0.0]]
    mixed = np.random.default_rng(2).permutation(np.vstack([rows, lifted]))
    assert SketchStroke.of(mixed) == SketchStroke.of(rows)


@pytest.mark.parametrize(
    ("samples", "words"),
    [
        ([[1, 2]], "no length"),
        ([[1, 2]] * 9, "no length"),
        ([[0, 0], [np.nan, 1]], "sample 2"),
        ([1, 2, 3], "rows of 2 to 4"),
        (np.zeros((4, 5)), "rows of 2 to 4"),
    ],
)
def test_no_strokes(samples: object, words: str) -> None:
    with pytest.raises(Error, match=words):
        SketchStroke.of(samples)  # type: ignore[arg-type]


def test_the_board_writes_the_commands_of_a_stroke() -> None:
    board = Board()
    board.sync("SKETCH A 2D XZ\n")
    request = {"kind": "board_stroke", "samples": SQUARE.tolist()}
    trial = answered(board, {**request, "trial": True})
    assert trial["kind"] == "board" and "edits" not in trial
    assert [p["kind"] for p in trial["pieces"]] == ["line"] * 4
    assert trial["commands"].startswith("POINT 1 AT ") and "STROKES" not in trial["commands"]
    assert json.loads(json.dumps(trial)) is not None
    drawn = answered(board, request)
    assert drawn["commands"] == trial["commands"]
    assert len(drawn["points"]) == len(drawn["lines"]) == 4 and drawn["edits"]
    typed = Sketch()
    typed.run("SKETCH A 2D XZ; " + trial["commands"])
    again = Sketch()
    again.run("SKETCH A 2D XZ")
    again.stroke(SQUARE)
    assert typed.text == again.text
    bad = answered(board, {"kind": "board_stroke", "samples": [[1, 1]]})
    assert bad["kind"] == "refused" and "no length" in bad["error"]


def test_uncertain_types_are_proposed() -> None:
    sketch = Sketch()
    sketch.run("SKETCH A; AXES 345 40 90")
    rng = np.random.default_rng(5)
    ways = [np.array([np.cos(a), np.sin(a)]) for a in np.radians([345, 40, 90])]
    corners = [(k & 1, k >> 1 & 1, k >> 2 & 1) for k in range(8)]
    places = [sum(100 * c * w for c, w in zip(k, ways, strict=True)) for k in corners]
    lines = [(a, a | b) for a in range(8) for b in (1, 2, 4) if not a & b]
    sketch.draw(np.array(places) + rng.normal(0, 3, (8, 2)), lines)
    sketch.run("SET CERTAINTY 1; TYPE AUTO")
    proposals = {p.line: p for p in sketch.proposals()}
    assert len(proposals) == 12 and all(0 <= p.probability <= 1 for p in proposals.values())
    assert all(not line.type for line in sketch.parts().lines.values())
    sketch.run("SET CERTAINTY 0; TYPE AUTO")
    for number, line in sketch.parts().lines.items():
        assert line.type == proposals[number].type


def test_snaps_are_data() -> None:
    sketch = Sketch()
    sketch.run("SKETCH A 2D XZ; POINT 1 0 0; POINT 2 100 0; POINT 3 160 80; LINE 1 2; LINE 2 3")
    cross = sketch.snaps(101, 79, 5, start=(60, 80))[0]
    assert (cross.kind, cross.at, cross.of) == ("cross", (100.0, 80.0), (2,))
    far = sketch.snaps(208, 144, 2, awake=[3])[0]
    assert (far.kind, far.directions, far.of) == ("extension", ("line 2",), (3,))
