"""The drawing board without its page: what a hand does is an edit of the text, and nothing else."""

from __future__ import annotations

import os
import random
from typing import Any

import pytest

from moldloft import Sketch, _core
from moldloft.workbench.board import Board, answered
from moldloft.workbench.statements import block, statements
from moldloft.workbench.text import applied

SLAB = """\
! A slab, \N{GRINNING FACE}
SKETCH SLAB 2D XZ
POINT 1 AT 0 0; POINT 2 AT 90 2 ! right
POINT 3 AT 91 30
POINT 4 AT 1 29
POLYLINE 1 2 3 4 CLOSE
DIMENSION W X 1 2 = 8 IN 1 20; DIM H Z 1 4 "W/4"
EXTRUDE 5
"""


class Hand:
    """A page without a page: it applies what the board answers, as the editor does."""

    def __init__(self, text: str = "") -> None:
        self.board = Board()
        self.text = text
        self.past: list[str] = []
        self.tell("board_open")

    def tell(self, kind: str, **fields: Any) -> dict[str, Any]:
        return answered(self.board, {"kind": kind, "text": self.text, "id": 1, **fields})

    def does(self, *changes: dict[str, Any]) -> dict[str, Any]:
        reply = self.tell("board_edit", changes=list(changes))
        if reply["kind"] == "refused":
            return reply
        steps: list[Any] = []
        at = 0
        for e in reply["edits"]:
            steps += [e["from"] - at, [e["to"] - e["from"], *e["insert"].split("\n")]]
            at = e["to"]
        size = len(self.text.encode("utf-16-le")) // 2
        self.past.append(self.text)
        self.text = applied(self.text, [*steps, size - at])
        assert self.text == self.board._text
        return reply

    def run(self, command: str, **more: Any) -> dict[str, Any]:
        return self.does({"do": "run", "command": command, **more})


#: A house whose roof falls to all four sides: no end of the ridge is level with one of the eaves.
HIP_ROOF = """\
SKETCH PART
AXES 345 40 90
POINT 1 AT -1 0; POINT 2 AT 285 -77; POINT 3 AT 456 66; POINT 4 AT 169 143
POINT 5 AT -1 156; POINT 6 AT 285 79; POINT 7 AT 456 222; POINT 8 AT 169 299
POLYLINE 1 2 3 4 CLOSE; POLYLINE 5 6 7 8 CLOSE
LINE 9 FROM 1 TO 5; LINE 10 FROM 2 TO 6; LINE 11 FROM 3 TO 7; LINE 12 FROM 4 TO 8
POINT 9 AT 154 335; POINT 10 AT 302 295; LINE 13 FROM 9 TO 10
LINE 14 FROM 5 TO 9 TYPE O; LINE 15 FROM 6 TO 10 TYPE O
LINE 16 FROM 7 TO 10 TYPE O; LINE 17 FROM 8 TO 9 TYPE O
"""


def test_every_missing_dimension_has_a_place() -> None:
    hand = Hand(HIP_ROOF)
    base = [(0, 0), (12, 0), (12, 8), (0, 8)]
    corners = [(x, y, z) for z in (0.0, 3.0) for x, y in base] + [(3, 4, 5.5), (9, 4, 5.5)]
    drawn = hand.tell("board_open")
    for _ in range(7):
        assert len(drawn["next"]) == sum(drawn["missing"].values())
        mark = drawn["next"][0]
        axis, p, q = mark["axis"], mark["p"], mark["q"]
        k = "XYZ".index(axis)
        value = corners[q - 1][k] - corners[p - 1][k]
        drawn = hand.run(f"DIMENSION {axis} {p} TO {q} = {value}")
        assert drawn["kind"] == "board", drawn
    assert not drawn["next"] and not any(drawn["missing"].values())
    assert len(drawn["marks"]) == 7
    solid = hand.tell("board_solid")["solid"]
    roof = 8 * 2.5 * 6 / 2 + 2 * 3 * 8 * 2.5 / 3
    assert solid["exact"] and solid["volume"] == pytest.approx(12 * 8 * 3 + roof, rel=1e-12)


def test_numbers_and_types_are_written_where_they_are() -> None:
    hand = Hand(SLAB)
    hand.does({"do": "value", "name": "W", "value": "10"})
    assert "DIMENSION W X 1 2 = 10 IN 1 20; DIM H" in hand.text
    hand.does({"do": "value", "name": "h", "value": "W/5 + 0"})
    assert 'DIM H Z 1 4 "W/5 + 0"\n' in hand.text
    hand.does({"do": "move", "point": 2, "at": [95.25, -3]})
    assert "POINT 2 AT 95.25 -3 ! right\n" in hand.text
    # Lines of a POLYLINE have no statement of their own.
    hand.does({"do": "type", "lines": [2], "type": "Z"})
    assert hand.text.index("TYPE 2 AS Z") < hand.text.index("EXTRUDE")
    hand.does({"do": "type", "lines": [2], "type": "F"})
    assert hand.text.count("TYPE") == 1 and "TYPE 2 AS F" in hand.text
    s = Sketch()
    s.run(hand.text)
    assert s["W"] == 10 and s["H"] == 2
    # What is refused changes nothing.
    before = hand.text
    refused = hand.does({"do": "value", "name": "W", "value": "30"})
    assert "outside its range" in refused["error"] and hand.text == before
    assert hand.tell("board_open")["numbers"]["W"] == 10


def test_what_is_drawn_comes_before_the_body() -> None:
    hand = Hand(SLAB + "\nSKETCH B 2D XZ\nPOINT 1 AT 0 0; POINT 2 AT 9 0; LINE 1 FROM 1 TO 2\n")
    hand.tell("board_open", object="SLAB")
    hand.run("VARIABLE R 1")
    assert hand.text.index("VARIABLE R 1") < hand.text.index("EXTRUDE")
    hand.tell("board_open", object="B")
    hand.run("POINT 3 AT 9 9; LINE 2 FROM 2 TO 3")
    hand.run("ACCEPT ALL", last=True)
    assert hand.text.endswith("LINE 2 FROM 2 TO 3\nACCEPT ALL\n")
    own = block(statements(hand.text), "slab")
    assert [s.word(0) for s in own][:2] == ["SKETCH", "POINT"] and own[-1].word(0) == "EXTRUDE"


def test_axes_and_an_empty_text() -> None:
    hand = Hand()
    assert hand.tell("board_open")["object"] is None
    hand.run("SKETCH A", last=True)
    hand.does({"do": "axes", "axes": "0 45 90"})
    assert hand.text == "SKETCH A\nAXES 0 45 90\n"
    hand.does({"do": "axes", "axes": "ISO"})
    assert hand.text == "SKETCH A\nAXES ISO\n"
    facts = hand.tell("board_open")
    assert facts["angles"] == [330, 30, 90] and facts["axes"]["Z"] == [0, 1]


def test_a_pointer_means_the_strongest_thing_within_reach() -> None:
    hand = Hand()
    hand.run("SKETCH A\nAXES 0 45 90", last=True)
    hand.run("POINT 1 AT 0 0; POINT 2 AT 100 0; POINT 3 AT 0 80; LINE 1 2; LINE 1 3")

    def aim(u: float, v: float, **more: Any) -> dict[str, Any]:
        return hand.tell("board_pointer", at=[u, v], reach=5, **more)

    assert aim(98, 1)["point"] == 2
    assert aim(52, 1) == {**aim(52, 1), "why": "mid", "part": 0.5, "at": [50, 0]}
    assert aim(30, 1)["why"] == "line"
    # The corner that finishes a parallelogram: across from point 3, above point 2.
    corner = aim(97, 83, start=[0, 80])
    assert corner["why"] == "cross" and corner["at"] == pytest.approx([100, 80])
    assert corner["of"] == [2] and corner["type"] == "X"
    assert aim(97, 83, start=[0, 80], free=True)["why"] is None
    along = aim(60, 82, start=[0, 80])
    assert along["why"] == "axis" and along["at"] == [60, 80] and along["type"] == "X"
    # An axis through a point that was not rested on is none.
    assert aim(103, 40)["why"] is None and aim(103, 40, woken=[2])["at"] == pytest.approx([100, 40])
    assert aim(60, 30, start=[0, 80])["type"] == ""


def test_what_is_missing_is_offered_where_it_stands() -> None:
    hand = Hand(SLAB.replace('; DIM H Z 1 4 "W/4"', "").replace("EXTRUDE 5\n", ""))
    facts = hand.tell("board_open")
    [mark] = facts["next"]
    assert (mark["axis"], mark["p"]) == ("Z", 1) and mark["line"] and facts["missing"]["Z"] == 1
    # The picture with the width that is known.
    assert mark["value"] == pytest.approx(8 / 90 * 30, rel=0.1)
    assert hand.tell("board_solid")["solid"]["exact"] is False
    hand.run(f"DIMENSION D1 Z {mark['p']} TO {mark['q']} = 2")
    solid = hand.tell("board_solid")["solid"]
    assert solid["exact"] and solid["area"] == 16


def test_contradictions_come_with_what_mends_them() -> None:
    hand = Hand(SLAB.replace("EXTRUDE 5\n", ""))
    hand.does({"do": "type", "lines": [2], "type": "X"})
    checks = hand.tell("board_check")["checks"]
    assert checks and all(c["about"]["kind"] for c in checks)
    assert any(2 in c["about"]["lines"] for c in checks)


def test_random_gestures_are_the_text() -> None:
    rounds, gestures = (20, 100) if os.environ.get("MOLDLOFT_SOAK") else (2, 30)
    for seed in range(rounds):
        rng = random.Random(seed)
        hand = Hand()
        begin = "SKETCH R\nAXES 345 40 90" if seed % 2 else "SKETCH R 2D XZ"
        for _ in range(gestures):
            if hand.tell("board_open")["object"] is None:
                # The text is empty, at first and after every step was undone.
                hand.run(begin, last=True)
            facts = hand.tell("board_open")
            points = [p[0] for p in facts["points"]]
            lines = [ln[0] for ln in facts["lines"]]
            u, v = rng.uniform(0, 400), rng.uniform(0, 300)
            new = max(points, default=0) + 1
            what = rng.choice(["line", "line", "move", "type", "dim", "undo", "delete", "axes"])
            if what == "line":
                first = rng.choice([*points, new])
                drawn = f"POINT {new} AT {u:.1f} {v:.1f}"
                far = new + 1 if first == new else new
                if first == new:
                    drawn += f"; POINT {far} AT {v:.1f} {u:.1f}"
                hand.run(f"{drawn}; LINE {max(lines, default=0) + 1} FROM {first} TO {far}")
            elif what == "move" and points:
                hand.does({"do": "move", "point": rng.choice(points), "at": [u, v]})
            elif what == "type" and lines:
                letter = rng.choice("XZF" if facts["section"] else "XYZHPFO")
                hand.does({"do": "type", "lines": [rng.choice(lines)], "type": letter})
            elif what == "dim" and facts["next"]:
                m = rng.choice(facts["next"])
                hand.run(
                    f"DIMENSION N{new} {m['axis']} {m['p']} TO {m['q']} = {rng.randint(1, 40)}"
                )
            elif what == "undo" and hand.past:
                hand.text = hand.past.pop()
            elif what == "delete" and len(lines) > 2:
                hand.run(f"DELETE LINE {rng.choice(lines)}")
            elif what == "axes" and not facts["section"]:
                hand.does({"do": "axes", "axes": f"{rng.randint(330, 350)} 40 90"})
            # Who reads the text alone sees the same.
            here = hand.tell("board_open")
            anew = answered(Board(), {"kind": "board_open", "text": hand.text, "id": 1})
            assert here == anew, (seed, what)
        # What a drag shows meanwhile leaves nothing behind.
        if points := [p[0] for p in here["points"]]:
            moves = [{"point": p, "at": [k, 2 * k]} for k, p in enumerate(points)]
            seen = hand.tell("board_drag", moves=moves)["points"]
            assert [p[1:3] for p in seen] == [[k, 2 * k] for k in range(len(points))]
            assert hand.tell("board_open") == here


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"do": "fly"},
        {"do": "move"},
        {"do": "move", "point": 1, "at": ["x", 0]},
        {"do": "move", "point": 1, "at": [float("nan"), 0]},
        {"do": "run"},
        {"do": "run", "command": "LINE 1 TO 77"},
        {"do": "value", "name": "W", "value": "8*"},
    ],
)
def test_nonsense_is_refused(change: dict[str, Any]) -> None:
    hand = Hand(SLAB)
    reply = hand.does(change)
    assert reply["kind"] == "refused" and reply["error"] and hand.board._text == SLAB


def test_steps_are_kept_only_of_texts_that_undo() -> None:
    lines = ["SKETCH A 2D XZ", "POINT 1 0 0", "POINT 2 50 0", "POINT 3 50 30", "UNDO", "LINE 1 2"]
    board = Board()
    for count in (4, 5, 6):
        board.sync("\n".join(lines[:count]))
        plain = Sketch()
        plain.run("\n".join(lines[:count]))
        board.choose("A")
        shown = [p[0] for p in board.facts()["points"]]
        assert shown == [p["id"] for p in plain.objects["A"]["points"]]
    assert shown == [1, 2]
    board.sync("\n".join([*lines, "UNDO 2", "LINE 1 7"]))
    assert [f["line"] for f in board.facts()["faults"]] == [8]
    board.choose("A")
    assert [p[0] for p in board.facts()["points"]] == [1]


def test_a_session_without_steps_says_the_same() -> None:
    rng = random.Random(11)
    words = [
        "POINT {a} {u} {v}", "LINE {a} {b}", "POLYLINE {a} {b} {c} CLOSE",
        "LINE {n} FROM {a} TO {b}", "POINT {u}", "LINE {a} {a}", "DELETE LINE {n}", "SKETCH S{n}",
        "USING S1", "TYPE {n} AS X", "DIMENSION X {a} {b} 7", "GENERATE FACES", "WELD {a} {b}",
        "OFFSET 2", "EXTRUDE 3", "UNION S1 S2 INTO T", "CHECK", "EXTENSIONS",
    ]  # fmt: skip
    for _ in range(40):
        sessions = [_core.SketchSession(None) for _ in range(2)]
        sessions[1].forgo_steps()
        lines = ["SKETCH S1 2D XZ"]
        for _ in range(40):
            given = {k: rng.randint(1, 8) for k in "abcn"}
            places = {k: rng.randint(-50, 50) for k in "uv"}
            weighed = rng.choices(words, [5, 4, 2, 3] + [1] * (len(words) - 4))
            lines.append(weighed[0].format(**given, **places))
        one_by_one = [(k, row) for k, ln in enumerate(lines) for row in sessions[0].run_line(ln)]
        assert sessions[1].run_lines(lines) == one_by_one, lines
        assert sessions[0].objects_json() == sessions[1].objects_json()
        assert not sessions[1].stepped()
        [no] = sessions[1].run_line("UNDO")
        assert sessions[1].stepped() and "nothing to undo" in no[2], no
