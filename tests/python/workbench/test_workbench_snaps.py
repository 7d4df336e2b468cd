"""What a pointer on the drawing board snaps to."""

from __future__ import annotations

import math
from typing import Any

import pytest

from moldloft import _core
from moldloft.workbench.snaps import snapped

#: A line along x, and an oblique one from its end.
SKETCH = (
    "SKETCH PART; AXES 345 40 90; POINT 1 AT 0 0; POINT 2 AT 100 0; POINT 3 AT 130 70; LINE 1 2 3"
)
OBLIQUE = math.atan2(70, 30)


def snap(
    at: tuple[float, float], *, start: tuple[float, float] | None = None, woken: Any = ()
) -> dict[str, Any]:
    session = _core.SketchSession(None)
    session.run_line(SKETCH)
    return snapped(session, "PART", at, 5.0, start, list(woken))


def beyond(origin: tuple[float, float], way: float, far: float, off: float) -> tuple[float, float]:
    """A place along a direction from another, and off it to the left."""
    c, s = math.cos(way), math.sin(way)
    return (origin[0] + far * c - off * s, origin[1] + far * s + off * c)


@pytest.mark.parametrize("off", [-4.0, 0.0, 3.0])
def test_a_woken_end_continues_its_line(off: float) -> None:
    found = snap(beyond((130, 70), OBLIQUE, 60, off), woken=[3])
    assert (found["why"], found["axes"], found["of"]) == ("extension", ["line 1"], [3])
    assert found["at"] == pytest.approx(beyond((130, 70), OBLIQUE, 60, 0))
    assert snap(beyond((130, 70), OBLIQUE, 60, off)) == {}
    assert snap(beyond((130, 70), OBLIQUE, 60, 9), woken=[3]) == {}


def test_a_line_is_drawn_parallel_to_one_whose_end_was_woken() -> None:
    start = (300.0, -40.0)
    at = beyond(start, OBLIQUE, 55, 3)
    found = snap(at, start=start, woken=[2])
    assert (found["why"], found["axes"], found["of"]) == ("parallel", ["line 1"], [])
    assert found["at"] == pytest.approx(beyond(start, OBLIQUE, 55, 0))
    assert snap(at, start=start) == {}


def test_an_extension_crosses_an_axis_through_another_woken_point() -> None:
    # Above point 1 along z, and beyond the line's lower end: where x = 0 on the page.
    at = (0.0, 0.0 - 70 * 100 / 30)
    found = snap((at[0] + 2, at[1] - 2), woken=[1, 2])
    assert found["why"] == "cross" and set(found["of"]) == {1, 2}
    assert found["at"] == pytest.approx(at)


def test_axes_come_before_lines_along_them() -> None:
    session = _core.SketchSession(None)
    along = beyond((0, 0), math.radians(40), 90, 0)
    session.run_line(
        f"SKETCH PART; AXES 345 40 90; POINT 1 AT 0 0; POINT 2 AT {along[0]} {along[1]}; LINE 1 1 2"
    )
    found = snapped(session, "PART", beyond((0, 0), math.radians(40), 150, 2), 5.0, None, [2])
    assert (found["why"], found["axes"]) == ("axis", ["Y"])
