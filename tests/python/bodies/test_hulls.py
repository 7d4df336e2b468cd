"""Convex hulls and Minkowski sums beside SciPy, Steiner's formula and support functions."""

from __future__ import annotations

import os

import numpy as np
import pytest
from scipy.spatial import ConvexHull

import moldloft
from moldloft import implicit as im

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))


def steiner(points: np.ndarray, radius: float) -> float:
    """The volume of a polyhedron with a ball at each point: V + A r + M r² + 4/3 pi r³."""
    hull = ConvexHull(points)
    edges: dict[tuple[int, int], list[int]] = {}
    for k, triangle in enumerate(hull.simplices):
        for i in range(3):
            a, b = sorted((triangle[i], triangle[(i + 1) % 3]))
            edges.setdefault((a, b), []).append(k)
    mean = 0.0
    for (a, b), (k, m) in edges.items():
        n, o = hull.equations[k, :3], hull.equations[m, :3]
        turn = np.arctan2(np.linalg.norm(np.cross(n, o)), n @ o)
        mean += 0.5 * turn * np.linalg.norm(points[a] - points[b])
    return hull.volume + hull.area * radius + mean * radius**2 + 4 / 3 * np.pi * radius**3


def polytope(points: np.ndarray) -> im.Set:
    """The set of the half-spaces of SciPy's hull."""
    body = im.everything()
    for *normal, offset in np.unique(ConvexHull(points).equations.round(13), axis=0):
        body = body & im.Set(im.plane(tuple(normal), tuple(-offset * np.array(normal))))
    return body


def near(body: im.Set, exact: float, depth: int = 5, rel: float = 1e-5) -> None:
    mass = body.mass(depth=depth)
    low, high = mass.volume_bracket
    assert low <= exact * (1 + 1e-12) and exact * (1 - 1e-12) <= high
    assert mass.volume == pytest.approx(exact, rel=rel)


@pytest.mark.parametrize("seed", range(200 if SOAK else 4))
def test_hulls_and_sums_of_polyhedra_are_those_of_their_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a = rng.normal(size=(rng.integers(4, 9), 3))
    b = rng.normal(size=(rng.integers(4, 7), 3)) * 0.6 + rng.normal(size=3) * 2
    both = im.convex_hull(polytope(a), polytope(b))
    near(both, ConvexHull(np.vstack([a, b])).volume, rel=1e-6)
    faces = np.unique(ConvexHull(np.vstack([a, b])).equations.round(9), axis=0)
    assert len(both.leaves) == len(faces)
    total = im.minkowski_sum(polytope(a), polytope(b))
    near(total, ConvexHull((a[:, None] + b[None]).reshape(-1, 3)).volume, rel=1e-6)


@pytest.mark.parametrize("seed", range(200 if SOAK else 1))
def test_a_polyhedron_and_a_ball_sum_to_steiners_volume(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    points = rng.normal(size=(rng.integers(4, 9), 3))
    radius = float(rng.uniform(0.05, 0.8))
    centre = rng.normal(size=3)
    body = im.minkowski_sum(polytope(points), im.sphere(tuple(centre), radius))
    near(body, steiner(points, radius))
    facets = body.facets(depth=5)
    assert facets.closed and len(facets.patches) > 1
    same = im.convex_hull(*(im.sphere(tuple(p + centre), radius) for p in points))
    near(same, steiner(points, radius))


@pytest.mark.parametrize("seed", range(300 if SOAK else 6))
def test_the_hull_of_balls_is_what_their_support_function_bounds(seed: int) -> None:
    rng = np.random.default_rng(200 + seed)
    count = int(rng.integers(2, 9))
    centres = rng.normal(size=(count, 3)) * 1.5
    if seed % 3 == 0:
        centres[:, 2] = 0  # in a plane
    if seed % 4 == 1:
        centres = np.outer(rng.normal(size=count) * 2, (0.6, 0.0, 0.8))  # in a line
    radii = rng.uniform(0.1, 1.2, count)
    if seed % 5 == 2:
        radii[:] = 0.4
    hull = im.convex_hull(
        *(im.sphere(tuple(c), float(r)) for c, r in zip(centres, radii, strict=True))
    )
    normals = rng.normal(size=(4000, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    support = (normals @ centres.T + radii).max(axis=1)
    points = rng.uniform(-3.5, 3.5, (400, 3))
    # A point beyond a plane of support is outside; a mixture of points of the balls is inside.
    beyond = (points @ normals.T - support > 1e-9).any(axis=1)
    assert (np.asarray(hull.member(points[beyond])) == 1).all()
    weights = rng.dirichlet(np.full(count, 0.5), 400)
    inner = weights @ centres + rng.uniform(0, 0.999, (400, 1)) ** (1 / 3) * (
        normals[:400] * (weights @ radii)[:, None]
    )
    assert (np.asarray(hull.member(inner)) == -1).all()
    # All of the bracket is between the hull of many points of the balls and the body of the planes.
    spread = np.concatenate([c + r * normals for c, r in zip(centres, radii, strict=True)])
    least = ConvexHull(spread).volume
    low, high = hull.mass(depth=5).volume_bracket
    assert high >= least and low <= least * 1.02
    facets = hull.facets(depth=5)
    assert facets.closed and facets.bodies == 1


@pytest.mark.parametrize("seed", range(100 if SOAK else 3))
def test_cylinders_of_one_axis_between_two_planes(seed: int) -> None:
    rng = np.random.default_rng(300 + seed)
    count, height = int(rng.integers(1, 6)), float(rng.uniform(0.5, 2))
    centres, radii = rng.normal(size=(count, 2)) * 2, rng.uniform(0.2, 1, count)
    axis, turned = np.array([1.0, 2.0, -0.5]), np.linalg.qr(rng.normal(size=(3, 3)))[0]
    axis = turned[:, 2]

    def column(c: np.ndarray, r: float) -> im.Set:
        foot = turned[:, :2] @ c
        top = im.plane(tuple(axis), tuple(foot + height * axis))
        side = im.Set(im.cylinder(tuple(foot), tuple(axis), float(r)))
        return side & im.Set(im.plane(tuple(-axis), tuple(foot))) & im.Set(top)

    columns = [column(c, r) for c, r in zip(centres, radii, strict=True)]
    angle = np.linspace(0, 2 * np.pi, 40001)[:-1]
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    outline = ConvexHull(np.vstack([c + r * ring for c, r in zip(centres, radii, strict=True)]))
    area, length = outline.volume, outline.area
    plate = im.convex_hull(*columns)
    near(plate, area * height)
    # Steiner's formula of a right prism: its mean breadth is that of the outline and of its height.
    r = 0.15
    body = im.minkowski_sum(plate, im.sphere((0, 0, 0), r)) if count == 1 else None
    if body is not None:
        surface, mean = 2 * area + length * height, np.pi * height + np.pi * length / 2
        near(body, area * height + surface * r + mean * r**2 + 4 / 3 * np.pi * r**3)


def test_what_has_no_hull_in_closed_form_is_refused_by_name() -> None:
    pillar = im.Set(im.cylinder((0, 0, 0), (0, 0, 1), 1))
    flattened = pillar & im.cuboid((-0.5, -2, 0), (2, 2, 1))
    for sets, words in (
        ((im.Set(im.sphere((0, 0, 0), 2)) & pillar,), "two round primitives"),
        ((-im.Set(im.sphere((0, 0, 0), 1)),), "outside of a sphere"),
        ((im.Set(im.plane((0, 0, 1), (0, 0, 0))),), "unbounded"),
        ((flattened,), "not across its axis"),
    ):
        with pytest.raises(moldloft.Error, match=words):
            im.convex_hull(*sets)
    empty = im.cuboid((0, 0, 0), (1, 1, 1)) & im.cuboid((2, 0, 0), (3, 1, 1))
    assert im.convex_hull(im.nothing(), empty).is_nothing
    # Sides of the box that are outside of the cylinder are no faces of the body.
    near(im.convex_hull(pillar & im.cuboid((-2, -2, 0), (2, 2, 1))), np.pi)


def test_derivatives_follow_the_balls() -> None:
    """A hull in a model: its volume by radius and place, beside the capsule's closed form."""
    model = moldloft.loads(
        "param float r = 0.5 in [0.1, 2]; param float x = 3 in [1, 9]; param float s = 0.5;"
        "SetBody pill(convex_hull({set(sphere({0, 0, 0}, r)), set(sphere({x, 0, 0}, s))}));"
    )
    area = model.derivative("pill.volume", "x")
    assert area == pytest.approx(np.pi * 0.25, rel=2e-2)
    both = [model.derivative("pill.volume", name) for name in ("r", "s")]
    # Equal by symmetry, and together the capsule's surface.
    assert both[0] == pytest.approx(both[1], rel=2e-2)
    assert sum(both) == pytest.approx(2 * np.pi * 0.5 * 3 + 4 * np.pi * 0.25, rel=2e-2)
