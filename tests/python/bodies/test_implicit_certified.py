"""Implicit solids from outside: nothing vanishes, numbers hold everywhere, sets are kept."""

import copy
import math
import os
import pickle

import numpy as np
import pytest

import moldloft
from moldloft import implicit as im

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


@pytest.mark.parametrize("direction", [(0, 0, 1), (1, 2, 3)] if SOAK else [(0, 0, 1)])
def test_a_thin_ring_is_whole(direction):
    ring = im.Set(im.torus((0, 0, 0), direction, 2, 0.02))
    facets = ring.facets()
    exact = 2 * math.pi**2 * 2 * 0.02**2
    assert facets.closed and facets.bodies == 1 and facets.euler == 0
    # What could not be proved is listed, and holds next to nothing.
    assert sum(cell.volume for cell in facets.unresolved) < 1e-6 * exact
    assert facets.volume == pytest.approx(exact, rel=0.1)
    mass = ring.mass()
    assert mass.volume == pytest.approx(exact, rel=1e-6)
    low, high = mass.volume_bracket
    assert low <= mass.volume <= high and low <= exact * (1 + 1e-9) and high >= exact * (1 - 1e-9)


@pytest.mark.parametrize("thickness", [0.03, 0.01, 1e-3])
def test_plates_have_one_volume_in_python_and_in_the_language(thickness):
    plate = im.cuboid((0, 0, 0), (1, 1, thickness))
    model = moldloft.loads(f"set p = cuboid({{0, 0, 0}}, {{1, 1, {thickness}}});")
    volume = model.eval("volume(p)")
    low, high = model.eval("volume_bracket(p)")
    assert volume == pytest.approx(thickness, rel=1e-9) and low <= volume <= high
    assert plate.mass().volume == pytest.approx(volume, rel=1e-9)


def test_what_is_too_thin_is_listed_or_refused():
    plate = im.cuboid((-1, -1, 0), (1, 1, 1e-4)) & im.Set(im.sphere((0, 0, 0), 0.8))
    facets = plate.facets(depth=5)
    assert facets.unresolved and all(u.missed for u in facets.unresolved)
    with pytest.raises(moldloft.Error, match="depth = "):
        plate.facets(accuracy=1e-5, limit=100_000)


def test_a_volume_that_is_not_known_as_well_as_asked_is_warned_of():
    # Faces that touch in points leave cusps thinner than any cell.
    touching = im.Set(im.sphere((0, 0, 0), 1))
    for x in (-0.5, 0.5):
        touching = touching & -im.Set(im.sphere((x, 0, 0), 0.5))
    with pytest.warns(UserWarning, match=r"volume-uncertain\]: the volume is accurate") as caught:
        mass = touching.mass()
    assert caught[0].filename == __file__
    assert mass.uncertain >= mass.estimate > 1e-6 * mass.volume
    assert abs(mass.volume - math.pi) <= mass.uncertain


def test_a_volume_of_facets_with_edges_cut_off_is_warned_of():
    # Corners of a curved profile are none of the set's edges.
    model = moldloft.loads(
        "AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(1, 1, 0); Arc a(A, C, B);"
        "Line l(B, A); PolyCurve c({a, l}); set s = extruded(c, {0, 0, 1});"
    )
    facets = model["s"].value.facets((-1, -1, -0.1), (3.1, 2, 1.2), depth=4)
    assert facets.blunt and facets.volume > 0
    with pytest.warns(UserWarning, match=r"the facets may deviate from the set in \d+ cells"):
        assert facets.best_volume > 0
    assert im.cuboid((0, 0, 0), (1, 1, 1)).facets().best_volume == pytest.approx(1)


@pytest.mark.parametrize("offset", [0.0, 1e3, 1e5, 1e6])
def test_moments_do_not_depend_on_the_place(offset):
    cube = im.cuboid((offset,) * 3, (offset + 1,) * 3).mass()
    assert np.allclose(cube.inertia, np.eye(3) / 6, atol=1e-9)
    assert np.allclose(cube.centroid - offset, 0.5, atol=1e-9)
    assert np.ptp(cube.inertia_bracket, axis=2).max() < 1e-6


def test_an_accuracy_is_reached_or_said_not_to_be():
    ball = im.Set(im.sphere((0, 0, 0), 1))
    low, high = ball.mass(accuracy=0.005).volume_bracket
    assert high - low <= 0.01 and low <= 4 / 3 * math.pi <= high
    with pytest.raises(moldloft.Error, match="cells"):
        ball.mass(accuracy=1e-9, cells=1000)
    assert im.nothing().mass().volume == 0
    with pytest.raises(ValueError, match="depth"):
        ball.facets(depth=-1)


def test_clearances_that_are_plateaus():
    cubes = [im.cuboid((x, 0, 0), (x + 1, 1, 1)) for x in (0, 2)]
    found = cubes[0].distance(cubes[1])
    assert found.distance == pytest.approx(1) and found.at_least == pytest.approx(1)
    balls = [im.Set(im.sphere((0, 0, 0), r)) for r in (1, 2, 3)]
    gap = balls[0].distance(balls[2] - balls[1])
    assert gap.at_least <= 1 <= gap.distance and gap.distance == pytest.approx(1, rel=1e-4)
    assert balls[0].nearest((0, 0, 0)).distance == pytest.approx(1)


# In the box of the set itself the contact is a corner of cells.
@pytest.mark.parametrize("box", [((-1.5, -1.3, -1.1), (3.3, 1.4, 1.7)), ()])
def test_balls_that_touch_are_two_bodies(box):
    balls = im.Set(im.sphere((0, 0, 0), 1)) | im.Set(im.sphere((2, 0, 0), 1))
    facets = balls.facets(*box)
    assert facets.bodies == 2 and len(facets.touching) == 1


def test_sets_are_kept(tmp_path):
    part = im.Set(im.sphere((0.1, 0, 0), 1), name="ball", tags={"batch": "7"}) - im.cuboid(
        (0, 0, 0), (2, 2, 2)
    )
    for other in (pickle.loads(pickle.dumps(part)), copy.deepcopy(part), im.loads(part.dumps())):
        assert other.same(part)
    part.save(tmp_path / "part.set")
    assert im.load(tmp_path / "part.set").same(part)
    assert part.leaves[0].attributes.tags == {"batch": "7"}
    model = moldloft.loads(part.sdl("part"))
    points = np.random.default_rng(0).uniform(-1.5, 1.5, (100, 3))
    assert (model["part"].value(points) == part(points)).all()
    with pytest.raises(moldloft.Error, match="line 1"):
        im.loads("something else")


def test_fillets_between_sets():
    plate, post = im.cuboid((-3, -3, -1), (3, 3, 0)), im.cuboid((-1, -1, -0.5), (1, 1, 2))
    joined = plate.filleted(post, 0.5)
    exact = 36 + 8 + 4 * 2 * 0.25 * (1 - math.pi / 4)
    assert joined.mass().volume == pytest.approx(exact, abs=1e-4)
    with pytest.raises(moldloft.Error, match="no edge"):
        plate.filleted(post, 0.5, edges=[("top", "side")])
