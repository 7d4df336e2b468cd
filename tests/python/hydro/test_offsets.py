"""Tables of offsets as they are published: blanks, matrices, flats, skegs, closed hulls."""

from __future__ import annotations

import pytest

import moldloft
from moldloft import offsets
from moldloft.errors import Error

MATRIX = """
waterline, 0, 10, 20, 30
0,        , 0, 0, 0
0,        , 1, 2,
1,       0, 3, 4, 0
2,       0, 4, 5, 0
3,     0.5, 5, 5, 1
"""


def test_a_matrix_says_what_a_list_says() -> None:
    table = offsets.parse(MATRIX)
    assert table.stations[10.0] == ((0, 0), (0, 1), (1, 3), (2, 4), (3, 5))
    assert table.stations[0.0] == ((1, 0), (2, 0), (3, 0.5))
    assert offsets.parse(table.csv()).stations == table.stations
    turned = "station,1,2\n0,0.5,0.7\n4,,1\n4,0.9,\n"
    assert offsets.parse(turned).stations == {0.0: ((1, 0.5), (2, 0.7)), 4.0: ((1, 0.9), (2, 1))}


def test_zeros_below_and_above_the_hull_are_no_part_of_its_sections() -> None:
    table = offsets.Offsets({0.0: ((0, 0), (1, 0), (2, 0.5), (3, 0.2), (4, 0), (5, 0))})
    assert table.section(0.0) == ((1, 0), (2, 0.5), (3, 0.2), (4, 0))


def test_a_hull_that_is_closed_holds_water() -> None:
    table = offsets.parse(MATRIX)
    open_hull = moldloft.loads(table.program())
    closed = moldloft.loads(table.program(closed=True))
    assert not open_hull.mesh().closed
    assert closed.mesh().closure(level=None)["closed_with_lids_and_mirror"]
    assert closed.junctions() == [] and not closed.has_errors
    found = closed.hydrostatics(level=2.0)
    assert found.open_edges == 0 and not found.floods


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "station,waterline,half_breadth\n0,0,1\n0,0,1\n",
            "line 3: expected half-breadth 1.0 once",
        ),
        ("waterline,0,4\n0,1,x\n", "line 2: expected a number for half_breadth"),
        ("waterline,0,4\n0,1,2,3\n", "line 2: expected 3 fields, found 4"),
        ("waterline,0,4\n,1,2\n", "line 2: expected a station or waterline"),
        ("station,waterline,half_breadth\n0,0,\n0,1,\n", "expected half-breadths, found none"),
    ],
)
def test_what_is_wrong_has_a_line(text: str, message: str) -> None:
    with pytest.raises(Error, match=message):
        offsets.parse(text)
