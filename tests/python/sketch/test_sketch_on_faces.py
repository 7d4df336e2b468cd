"""Sections on plane faces of bodies: where they are, and that they stay there."""

from __future__ import annotations

import math

import numpy as np
import pytest

from moldloft import Sketch

BOX = """SKETCH PART 2D XY
POINT 1 AT 0 0; POINT 2 AT 100 0; POINT 3 AT 100 60; POINT 4 AT 0 60
POLYLINE 1 2 3 4 CLOSE
DIMENSION W X 1 TO 2 = 10; DIMENSION H Y 1 TO 4 = 6
EXTRUDE 4
"""
TURNED = BOX + "ROTATE PART Y 30 FEATURE INTO TURNED\n"
POCKET = "EXTRUDE F -2 INTO POCKET\nCUT PART POCKET INTO PIECE\n"


def section(on: str, plane: str = "XY", size: tuple[float, float] = (2, 3), name: str = "F") -> str:
    """A rectangle from (1, 1) on a face."""
    a, b = plane
    return f"""SKETCH {name} 2D {plane} ON {on}
POINT 1 AT 10 10; POINT 2 AT 30 10; POINT 3 AT 30 40; POINT 4 AT 10 40
POLYLINE 1 2 3 4 CLOSE
REFERENCE 1 1 1
DIMENSION A {a} 1 TO 2 = {size[0]}; DIMENSION B {b} 1 TO 4 = {size[1]}
"""


def sketch(text: str) -> Sketch:
    """The sketch of a text, read back from what it saves."""
    made = Sketch()
    made.run(text)
    again = Sketch()
    again.run(made.text)
    assert again.text == made.text
    assert again.objects == made.objects
    return made


@pytest.mark.parametrize(
    ("face", "plane", "height", "centre"),
    [
        ("6", "XY", 2, (2, 2.5, 5)),
        ("TOP Z", "XY", 2, (2, 2.5, 5)),
        ("2", "XY", -2, (2, 2.5, -1)),
        ("4", "YZ", 2, (11, 2, 2.5)),
        ("3", "YZ", -2, (-1, 2, 2.5)),
        ("1", "XZ", -2, (2, -1, 2.5)),
        ("5", "XZ", 2, (2, 7, 2.5)),
    ],
)
def test_each_face_of_a_box(
    face: str, plane: str, height: float, centre: tuple[float, float, float]
) -> None:
    body = sketch(
        BOX + section(f"PART {face}", plane) + f"EXTRUDE F {height} INTO PAD\n"
        "UNION PART PAD INTO WHOLE\n"
    )
    assert body.objects["PAD"]["volume"] == pytest.approx(12, rel=1e-12)
    assert body.objects["PAD"]["centroid"] == pytest.approx(centre, abs=1e-12)
    assert body.objects["WHOLE"]["volume"] == pytest.approx(240 + 12, rel=1e-12)


@pytest.mark.parametrize("face", ["1", "2", "3", "4", "5", "6"])
def test_the_faces_of_a_turned_box(face: str) -> None:
    plane = {"1": "XZ", "2": "XY", "3": "YZ", "4": "YZ", "5": "XZ", "6": "XY"}[face]
    out = 1 if face in "456" else -1
    body = sketch(
        TURNED + section(f"TURNED {face}", plane, (1, 1)) + f"EXTRUDE F {2 * out} INTO PAD\n"
    )
    turn = math.radians(30)
    s, c = math.sin(turn), math.cos(turn)
    rows = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    normal = rows @ {"1": (0, -1, 0), "2": (0, 0, -1), "3": (-1, 0, 0)}.get(
        face, {"4": (1, 0, 0), "5": (0, 1, 0), "6": (0, 0, 1)}.get(face)
    )
    level = {"4": 10, "5": 6, "6": 4}.get(face, 0)
    # Each section is 1 away from its face, on the outside.
    assert body.objects["PAD"]["volume"] == pytest.approx(2, rel=1e-12)
    assert normal @ body.objects["PAD"]["centroid"] == pytest.approx(level + 1, abs=1e-12)


def test_it_moves_with_its_face() -> None:
    text = BOX + section("PART 6") + "EXTRUDE F 2\nUNION PART F INTO WHOLE\nUSING PART\nSET D1 7"
    body = sketch(text)
    assert body.objects["F"]["centroid"] == pytest.approx((2, 2.5, 8), abs=1e-12)
    assert body.objects["WHOLE"]["volume"] == pytest.approx(420 + 12, rel=1e-12)
    # Derivatives go through the face.
    found = body.gradient(["PART.D1"], name="WHOLE").volume[0]
    assert found == pytest.approx(60, rel=1e-12)


def test_faces_of_a_body_that_was_cut() -> None:
    text = BOX + section("PART 6") + POCKET
    floor = section('PIECE "POCKET.END"', "XY", (1, 1), "G") + "EXTRUDE G 1 INTO PIN\n"
    body = sketch(text + floor + "UNION PIECE PIN INTO WHOLE\n")
    assert body.objects["PIN"]["centroid"] == pytest.approx((1.5, 1.5, 2.5), abs=1e-12)
    assert body.objects["WHOLE"]["volume"] == pytest.approx(240 - 12 + 1, rel=1e-12)


def test_a_face_that_is_gone() -> None:
    text = BOX + section("PART 6") + POCKET + section('PIECE "POCKET.END"', "XY", (1, 1), "G")
    through = text.replace("EXTRUDE F -2", "EXTRUDE F -5")
    made = Sketch()
    replies = [r for line in through.splitlines() for r in made.run(line, strict=False)]
    (warning,) = [r for r in replies if r.severity == "warning"]
    assert warning.text == "there is no face POCKET.END" or "POCKET.END" in warning.text
    (fault,) = [r for r in made.run("EXTRUDE G 1 INTO PIN", strict=False) if r.is_error]
    assert "POCKET.END" in fault.text
    # What is drawn is there, and on the face once that is there again.
    made.run("USING POCKET; SET EXTRUDE1 -2; EXTRUDE G 1 INTO PIN")
    assert made.objects["PIN"]["centroid"] == pytest.approx((1.5, 1.5, 2.5), abs=1e-12)


def test_names_follow() -> None:
    made = sketch(BOX + section("PART 6") + POCKET + section('PIECE "PART.6"', "XY", (1, 1), "G"))
    made.run("RENAME PART TO BASE; RENAME PIECE TO REST")
    assert 'SKETCH G 2D XY ON REST "BASE.6"' in made.text
    assert "SKETCH F 2D XY ON BASE 6" in made.text
    again = sketch(made.text + "EXTRUDE G 1 INTO PIN\n")
    assert again.objects["PIN"]["centroid"][2] == pytest.approx(4.5, abs=1e-12)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("SKETCH G ON NOBODY 1", "there is no object NOBODY"),
        ("SKETCH G ON F 1", "F"),
        ("SWEEP F ALONG PART INTO G", "is drawn on a face of PART"),
        ("LOFT F F2 INTO G", "is drawn on a face of PART"),
    ],
)
def test_refused(line: str, words: str) -> None:
    made = sketch(BOX + section("PART 6") + section("PART 6", "XY", (1, 1), "F2"))
    faults = [r for r in made.run(line, strict=False) if r.is_error]
    assert len(faults) == 1 and words in faults[0].text


def test_without_a_plane_the_nearest_is_taken() -> None:
    made = sketch(TURNED + "SKETCH G ON TURNED 6\n")
    assert "SKETCH G 2D XY ON TURNED 6" in made.text
    made = sketch(TURNED + "SKETCH G ON TURNED 4\n")
    assert "SKETCH G 2D YZ ON TURNED 4" in made.text


def test_a_revolution_and_an_offset_are_there() -> None:
    text = BOX + section("PART 6", "XY", (2, 2)) + "OFFSET F 0.5 MITRED INTO WIDE\n"
    body = sketch(text + "EXTRUDE WIDE 1 INTO PAD\nREVOLVE F 1 360 INTO RING\n")
    assert body.objects["PAD"]["centroid"] == pytest.approx((2, 2, 4.5), abs=1e-12)
    assert body.objects["PAD"]["volume"] == pytest.approx(9, rel=1e-12)
    assert body.objects["RING"]["centroid"][2] == pytest.approx(4, abs=1e-9)
    assert body.objects["RING"]["volume"] == pytest.approx(math.pi * 4 * 2, rel=1e-9)


def test_an_inclined_face_for_a_body() -> None:
    text = TURNED + section("PART 6").replace(" ON PART 6", "") + "EXTRUDE F 2\n"
    made = sketch(text)
    (fault,) = [r for r in made.run("MOVE F ON TURNED 6", strict=False) if r.is_error]
    assert "inclined" in fault.text
    made.run("MOVE F ON TURNED 6 ALONG Z INTO G")
    again = sketch(made.text)
    same = sketch(TURNED + section("TURNED 6") + "EXTRUDE F 2 INTO G\n")
    assert again.objects["G"]["centroid"] == pytest.approx(same.objects["G"]["centroid"], abs=1e-12)
