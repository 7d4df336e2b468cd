"""Thin bodies at any angle and place: right, or refused with what would do.

Plates, rods, rings, shells, wedges of 2 to 10 degrees, pipes and bent wires, of thickness 1e-1 to
1e-4 of their size, beside closed forms. MOLDLOFT_SOAK makes them 500.
"""

from __future__ import annotations

import math
import os
import re
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest

import moldloft
from moldloft import implicit as im

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
CELLS = 400_000 if SOAK else 60_000
KINDS = ("plate", "rod", "ring", "shell", "wedge", "pipe", "wire")


def half(normal: tuple[float, ...], point: tuple[float, ...]) -> im.Set:
    return im.Set(im.plane(normal, point))


def between(body: im.Set, low: float, high: float) -> im.Set:
    return body & half((0, 0, -1), (0, 0, low)) & half((0, 0, 1), (0, 0, high))


@dataclass
class Body:
    """A thin body with its closed forms."""

    kind: str
    thickness: float
    set: im.Set
    volume: float
    euler: int


def thin(seed: int) -> Body:
    rng = np.random.default_rng([7, seed])
    kind, t = KINDS[seed % len(KINDS)], float(10 ** rng.uniform(-4, -1))
    o, z, r = (0, 0, 0), (0, 0, 1), 0.5 * t
    if kind == "plate":
        a, b = rng.uniform(0.5, 1.5, 2)
        body, volume, euler = im.cuboid(o, (a, b, t)), a * b * t, 2
    elif kind == "rod":
        body, volume, euler = between(im.Set(im.cylinder(o, z, r)), 0, 1), math.pi * r * r, 2
    elif kind == "ring":
        body, volume, euler = im.Set(im.torus(o, z, 1, r)), 2 * (math.pi * r) ** 2, 0
    elif kind == "shell":
        body = im.Set(im.sphere(o, 1)) - im.sphere(o, 1 - t)
        volume, euler = 4 * math.pi * t * (1 - t + t * t / 3), 4
    elif kind == "wedge":
        angle = math.radians(rng.uniform(2, 10))
        slope = half((-math.sin(angle), 0, math.cos(angle)), o)
        body = slope & half((0, 0, -1), o) & half((1, 0, 0), (1, 0, 0))
        body = body & half((0, -1, 0), o) & half((0, 1, 0), (0, 1, 0))
        volume, euler = 0.5 * math.tan(angle), 2
    elif kind == "pipe":
        wall = im.Set(im.cylinder(o, z, 0.3)) - im.cylinder(o, z, 0.3 - t)
        body, volume, euler = between(wall, 0, 1), math.pi * t * (0.6 - t), 0
    else:
        bend = im.Set(im.torus(o, z, 0.5, r)) & half((0, -1, 0), o)
        leg = half((0, 1, 0), o) & half((0, -1, 0), (0, -1, 0))
        body = bend
        for x in (0.5, -0.5):
            body = body | (im.Set(im.cylinder((x, 0, 0), (0, 1, 0), r)) & leg)
        volume, euler = math.pi * r * r * (0.5 * math.pi + 2), 2
    body = body.turned((0.1, 0.2, 0.3), tuple(rng.normal(size=3)), float(rng.uniform(0, 6)))
    body = body.translated(tuple(rng.uniform(-3, 3, 3)))
    return Body(kind, t, body, float(volume), euler)


@pytest.fixture
def unhurried() -> Iterator[None]:
    """Time for development builds, which are many times slower."""
    before = moldloft.limits()
    moldloft.limits(seconds=900)
    yield
    moldloft.limits(**before._asdict())


@pytest.mark.usefixtures("unhurried")
@pytest.mark.parametrize("seed", range(500) if SOAK else [0, 1, 3, 4])
def test_the_volume_is_proved_or_refused_with_what_is_reached(seed: int) -> None:
    of = thin(seed)
    asked = float(10 ** np.random.default_rng([8, seed]).uniform(-4, -1.5)) * of.volume
    try:
        mass = of.set.mass(accuracy=asked, cells=CELLS)
    except moldloft.Error as error:
        reached = float(re.search(r"known to (\S+), not", str(error))[1])
        assert reached > asked
        mass = of.set.mass(accuracy=1.01 * reached, cells=CELLS)
        asked = 1.01 * reached
    low, high = mass.volume_bracket
    assert low <= mass.volume <= high
    assert low <= of.volume * (1 + 1e-9) and high >= of.volume * (1 - 1e-9), of
    assert abs(mass.volume - of.volume) <= asked


# Beyond the first: wedges with layers that enclosed nothing, as shells and as a handle, and a
# plate as thick as the finest cells.
@pytest.mark.parametrize("seed", [*range(500 if SOAK else 7), 634, 704, 1435, 2069])
def test_facets_to_an_accuracy_are_one_body_with_the_right_holes(seed: int) -> None:
    of = thin(seed)
    accuracy = float(10 ** np.random.default_rng([9, seed]).uniform(-3.5, -1.5))
    try:
        facets = of.set.facets(accuracy=accuracy, limit=2e5 if SOAK else 3e4)
    except moldloft.Error as error:
        # What would do is named: a depth for what is thin, a limit for what is fine.
        assert re.search(r"depth = \d+ resolves it|limit", str(error)), error
        return
    assert facets.closed and facets.bodies == 1 and facets.euler == of.euler, of
    assert facets.best_volume == pytest.approx(of.volume, rel=0.02)


@pytest.mark.parametrize(("kind", "thickness"), [("disc", 0.03), ("ring", 0.1)])
def test_the_depth_that_is_named_shows_the_part(kind: str, thickness: float) -> None:
    o, z, turn = (0, 0, 0), (0, 0, 1), ((0, 0, 0), (1, 2, 3), 0.7)
    body, euler = {
        "disc": (im.Set(im.cylinder(o, z, 0.5)) & im.cuboid((-1, -1, 0), (1, 1, thickness)), 2),
        "ring": (im.Set(im.torus(o, z, 1, 0.5 * thickness)), 0),
    }[kind]
    body = body.turned(*turn)
    with pytest.raises(moldloft.Error, match="resolves it") as refused:
        body.facets(accuracy=0.2 * thickness, limit=600)
    depth = int(re.search(r"depth = (\d+)", str(refused.value))[1])
    assert depth <= 9
    facets = body.facets(depth=depth)
    assert facets.closed and facets.bodies == 1 and facets.euler == euler


@pytest.mark.parametrize("offset", [0.0, 1.0, 1e3, 1e6])
@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1.0, 1e6])
def test_measures_do_not_depend_on_place_and_size(offset: float, scale: float) -> None:
    def part(s: float, at: float) -> im.Set:
        ball = im.Set(im.sphere((at, -at, at), s))
        return ball - im.cylinder((at + 0.3 * s, -at, at), (0, 0, 1), 0.4 * s)

    first, at = part(1.0, 0.0).mass(), offset * scale
    other = part(scale, at).mass()
    assert other.volume == pytest.approx(first.volume * scale**3, rel=1e-9)
    centre = (np.array(other.centroid) - [at, -at, at]) / scale
    assert np.abs(centre - first.centroid).max() < 1e-9
    assert np.abs(other.inertia / scale**5 - first.inertia).max() < 1e-9


#: Bodies of walls far thinner than the cells of the default depth.
NAMED = {
    "a shell": "set_shell(set(sphere({0, 0, 0}, 1)), 0.002)",
    "a chamfered sheet": "thin(set_chamfer(cuboid({-1, -0.22, -0.5}, {0.36, 1, 1.1}), 0.61))",
    "a shell as a difference": "set(sphere({0, 0, 0}, 1)) - set(sphere({0, 0, 0}, 0.999))",
    "a sheet": "thin(cuboid({-1, -0.2, -0.5}, {0.4, 1, 1.1}))",
    "a chamfered plate": "set_chamfer(cuboid({0, 0, 0}, {2, 1, 0.004}), 0.001)",
    "a hollow box": "set_shell(cuboid({0, 0, 0}, {2, 1, 1}), 0.003)",
}


@pytest.mark.parametrize("name", NAMED if SOAK else list(NAMED)[:2])
def test_thin_bodies_by_the_default_depth_are_done_or_refused_with_the_remedy(name: str) -> None:
    before = moldloft.limits()
    if not SOAK:
        # By default 10 s.
        moldloft.limits(seconds=1)
    began = time.process_time()
    try:
        model = moldloft.loads(f"SetBody b({NAMED[name]});", strict=False)
        faults = [d for d in model.diagnostics if d.is_error]
        if not faults:
            assert model.mesh().volume > 0
    finally:
        moldloft.limits(**before._asdict())
    for fault in faults:
        assert fault.help and fault.primary.line == 1, fault
        assert fault.id in ("out-of-time", "thin-part", "thin-box"), fault
    if SOAK:
        assert time.process_time() - began < 12
