"""The library `solids.sdl` against closed forms and sums over random points."""

from __future__ import annotations

import math
import os
from typing import Any

import numpy as np
import pytest

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
HEAD = 'load "solids.sdl"\n'
SEEDS = range(30 if SOAK else 2)

Points = np.ndarray[Any, np.dtype[np.float64]]


#: Accuracy of volumes beside random points: a tenth of their deviation.
ROUGH = 1e-2


def volume(text: str, box: str = "", accuracy: float | None = None) -> float:
    model = moldloft.loads(HEAD + text)
    how = "" if accuracy is None else f", accuracy = {accuracy}"
    return float(model.eval(f"volume(body{box}{how})"))


@pytest.mark.parametrize("seed", SEEDS)
def test_a_thread_has_the_volume_of_its_profile(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pitch = float(rng.uniform(0.5, 2))
    diameter = float(rng.uniform(5, 12)) * pitch
    length = float(rng.uniform(1, 3)) * pitch
    left = int(rng.integers(2))
    # Half a period of the profile: crest, flank of 30 degrees, root.
    crest, root = pitch / 16, pitch / 8
    outer = diameter / 2
    inner = outer - 5 * math.sqrt(3) / 16 * pitch
    flank = 5 * pitch / 16 * (outer**2 + outer * inner + inner**2) / 3
    mean = (crest * outer**2 + flank + root * inner**2) / (pitch / 2)
    r = diameter
    found = volume(
        f"set body = threaded_bar({diameter}, {pitch}, {length}, {left});",
        f", {{{-r}, {-r}, 0}}, {{{r}, {r}, {length}}}",
    )
    assert found == pytest.approx(math.pi * mean * length, rel=1e-4)


@pytest.mark.parametrize("left", [0, 1])
def test_a_right_handed_crest_rises_counter_clockwise(left: int) -> None:
    model = moldloft.loads(HEAD + f"set body = threaded_bar(10, 1.5, 9, {left});")
    for angle in np.linspace(0, 2 * math.pi, 13):
        turn = -angle if left else angle
        # A crest begins on the x axis at half a pitch.
        z = 1.5 * (0.5 + 1 + angle / (2 * math.pi))
        at = f"{4.99 * math.cos(turn)}, {4.99 * math.sin(turn)}"
        assert model.eval(f'member(body, {{{at}, {z}}}) == "solid"')
        assert model.eval(f'member(body, {{{at}, {z + 0.75}}}) == "air"')


@pytest.mark.parametrize("seed", SEEDS)
def test_a_twisted_prism_has_the_volume_of_a_straight_one(seed: int) -> None:
    rng = np.random.default_rng([5, seed])
    angles = np.sort(rng.uniform(0, 2 * math.pi, 5))
    corners = np.c_[np.cos(angles), np.sin(angles)] * rng.uniform(0.5, 1.5)
    x, y = corners.T
    area = abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2
    height, angle = rng.uniform(1, 4), rng.uniform(-120, 120)
    points = "".join(f"AbsPoint p{k}({a}, {b}, 0); " for k, (a, b) in enumerate(corners))
    outline = points + "BCurve outline({p0, p1, p2, p3, p4, p0}, degree = 1);"
    box = f", {{-3, -3, 0}}, {{3, 3, {height}}}, accuracy = 2e-3"
    for size in (1.0, float(rng.uniform(0.3, 2))):
        text = f"{outline} set body = twisted_prism(outline, {height}, {angle}, {size});"
        true = area * height * (1 + size + size**2) / 3
        assert volume(text, box) == pytest.approx(true, rel=2e-3)


def test_struts_along_edges_have_the_volume_of_cylinders() -> None:
    a, r = 4.0, 0.5
    text = f"set body = cubic_struts({a}, {r}) & cuboid({{-2, -2, -2}}, {{2, 2, 2}});"
    three = 8 * (2 - math.sqrt(2)) * r**3
    true = 3 * math.pi * r**2 * a - 3 * 16 / 3 * r**3 + three
    assert volume(text) == pytest.approx(true, rel=1e-4)


def points_in(rng: np.random.Generator, low: float, high: float) -> Points:
    return rng.uniform(low, high, (200_000, 3))


def close(found: float, inside: Any, whole: float) -> bool:
    """True within four deviations of a share of random points."""
    share = float(np.mean(inside))
    deviation = math.sqrt(share * (1 - share) / len(inside))
    return abs(found / whole - share) < 4 * deviation


def test_struts_along_diagonals() -> None:
    p = points_in(np.random.default_rng(1), -2, 2)
    directions = np.array([(1, 1, 1), (-1, 1, 1), (1, -1, 1), (1, 1, -1)]) / math.sqrt(3)
    along = p @ directions.T
    across = np.sum(p**2, axis=1)[:, None] - along**2
    text = "set body = diagonal_struts(4, 0.3) & cuboid({-2, -2, -2}, {2, 2, 2});"
    # Within a cube about a corner of cells, its struts are all there is.
    assert close(volume(text, accuracy=ROUGH), across.min(axis=1) < 0.09, 64)


@pytest.mark.parametrize("name", ["gyroid", "schwarz_p"])
def test_walls_about_minimal_surfaces(name: str) -> None:
    p = points_in(np.random.default_rng(2), 0, 4)
    k = math.pi / 2
    (sx, sy, sz), (cx, cy, cz) = np.sin(k * p).T, np.cos(k * p).T
    if name == "gyroid":
        g = sx * cy + sy * cz + sz * cx
        slope = (cx * cy - sz * sx) ** 2 + (cy * cz - sx * sy) ** 2 + (cz * cx - sy * sz) ** 2
        area = 3.0915  # of a cell of side 1; Gandy, Bardhan, Mackay, Klinowski 2001
    else:
        g, slope, area = cx + cy + cz, sx**2 + sy**2 + sz**2, 2.3451
    half = np.abs(g) / (k * np.sqrt(slope))
    body = f"set body = {name}(4, {{}}) & cuboid({{{{0, 0, 0}}}}, {{{{4, 4, 4}}}});"
    found = volume(body.format(0.4), accuracy=ROUGH)
    assert close(found, half < 0.2, 64)
    # A thin wall is the surface times its thickness.
    thin = volume(body.format(0.15), accuracy=ROUGH)
    assert thin == pytest.approx(area * 16 * 0.15, rel=2e-2)
    graded = volume(
        "field z = plane({0, 0, 1}, {0, 0, 0});\n" + body.format("0.2 + 0.05*z"), accuracy=ROUGH
    )
    assert close(graded, half < (0.2 + 0.05 * p[:, 2]) / 2, 64)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_foam_is_the_points_nearly_as_far_from_two_seeds(seed: int) -> None:
    rng = np.random.default_rng([9, seed])
    seeds = rng.uniform(0, 4, (10, 3))
    wall = float(rng.uniform(0.05, 0.2))
    gaps = np.linalg.norm(seeds[:, None] - seeds, axis=2)
    if gaps[gaps > 0].min() <= wall:
        pytest.skip("seeds closer than a wall")
    p = points_in(rng, 0, 4)
    # Distance from each bisecting plane of the nearest seed.
    squares = np.sum((p[:, None] - seeds) ** 2, axis=2)
    nearest = np.argmin(squares, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        planes = (squares - squares[np.arange(len(p)), nearest][:, None]) / (2 * gaps[nearest])
    planes[np.arange(len(p)), nearest] = np.inf
    listed = ", ".join("{" + ", ".join(map(repr, map(float, s))) + "}" for s in seeds)
    text = f"set body = voronoi_foam(points({listed}), {wall}, {{0, 0, 0}}, {{4, 4, 4}});"
    assert close(volume(text), planes.min(axis=1) < wall / 2, 64)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("threaded_bar(3, 2, 5)", "a thread has a pitch"),
        ("gyroid(0, 1)", "the cell has a length"),
        (
            "voronoi_foam(points({0, 0, 0}, {0.1, 0, 0}), 0.2, {0, 0, 0}, {1, 1, 1})",
            "seeds 1 and 2",
        ),
    ],
)
def test_what_cannot_be_is_refused_at_the_call(call: str, said: str) -> None:
    with pytest.raises(moldloft.ModelError, match=said):
        moldloft.loads(HEAD + f"set body = {call};\n")
