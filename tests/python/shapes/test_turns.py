"""Closed means periodic: moving a seam changes no answer; what is nearest to a knuckle is found.

Oracles are closed forms in NumPy.
"""

import itertools
import os

import numpy as np
import pytest

import moldloft

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"


def cases(few: int, many: int) -> range:
    return range(many if SOAK else few)


def point(name, p):
    x, y, z = (repr(float(c)) for c in p)
    return f"AbsPoint {name}({x}, {y}, {z}); "


def at_angle(r, z, angle):
    return np.array([r * np.cos(angle), r * np.sin(angle), z])


def sphere(radius, seam):
    """A sphere about the origin; its seam, v = 0, is at the angle ``seam`` about the axis z."""
    return (
        point("N", (0, 0, radius))
        + point("M", at_angle(radius, 0, seam))
        + point("S", (0, 0, -radius))
        + "Line axis(S, N); Arc meridian(N, M, S); RevSurf ball(meridian, axis); "
    )


def solved(text, *names):
    """Values of points, without a remark of any kind."""
    model = moldloft.loads(text)
    assert not model.diagnostics, [str(d) for d in model.diagnostics]
    return [np.asarray(model.eval(name), float) for name in names]


@pytest.mark.parametrize("case", cases(30, 1000))
def test_moving_the_seam_of_a_sphere_changes_no_answer(case):
    random = np.random.default_rng(case)
    radius = random.uniform(0.5, 3)
    q = random.normal(size=3)
    q *= random.uniform(0.3, 3) * radius / np.linalg.norm(q)
    foot = radius * q / np.linalg.norm(q)
    # A start within 70 degrees of the foot, and away from the poles.
    away = random.uniform(-1.2, 1.2)
    angle = np.arctan2(foot[1], foot[0]) + away
    polar = np.clip(np.arccos(foot[2] / radius) + random.uniform(-0.3, 0.3), 0.2, np.pi - 0.2)
    ray = random.normal(size=3)
    ray /= np.linalg.norm(ray)
    hit = ray * radius
    for seam in random.uniform(-np.pi, np.pi, 2 if not SOAK else 4):
        v = (angle - seam) / (2 * np.pi) % 1
        start = f"AbsMagnet start(ball, {float(polar / np.pi)!r}, {float(v)!r}); "
        hit_v = (np.arctan2(hit[1], hit[0]) - seam) / (2 * np.pi) % 1
        hit_v = (hit_v + random.uniform(-0.05, 0.05)) % 1
        # At the pole itself Newton's method has no start.
        hit_u = np.arccos(hit[2] / radius) / np.pi + random.uniform(-0.02, 0.02)
        hit_u = np.clip(hit_u, 0.005, 0.995)
        text = (
            sphere(radius, seam)
            + point("q", q)
            + start
            + point("inside", 0.1 * hit)
            + point("outside", 3 * hit)
            + f"AbsMagnet near_hit(ball, {float(hit_u)!r}, {float(hit_v)!r}); "
            + "Line through(inside, outside); "
            + "ProjMagnet whole(q, ball); ProjMagnet from_start(q, start); "
            + "ProxMagnet prox(q, ball); "
            + "IntMagnet hit(through, ball); IntMagnet hit_near(through, near_hit); "
        )
        whole, from_start, prox, crossed, crossed_near = solved(
            text, "whole", "from_start", "prox", "hit", "hit_near"
        )
        for found in (whole, from_start, prox):
            assert np.abs(found - foot).max() <= 1e-9 * radius, (seam, found, foot)
        for found in (crossed, crossed_near):
            assert np.abs(found - hit).max() <= 1e-9 * radius, (seam, found, hit)


@pytest.mark.parametrize("case", cases(15, 500))
def test_tangents_geodesics_projections_and_sections_over_the_seam(case):
    random = np.random.default_rng(1000 + case)
    radius = random.uniform(0.5, 3)
    at, across = random.uniform(-np.pi, np.pi), random.uniform(0.2, 1.2)
    height = random.uniform(-0.6, 0.6)
    a = at_angle(2 * radius, height * radius, at - across / 2)
    b = at_angle(2 * radius, random.uniform(-0.6, 0.6) * radius, at + across / 2)
    cut = random.uniform(-0.8, 0.8) * radius
    measured = []
    for seam in [at + np.pi, at, *random.uniform(-np.pi, np.pi, 2)]:
        v = (at - 0.1 - seam) / (2 * np.pi) % 1
        text = (
            sphere(radius, seam)
            + point("a", a)
            + point("b", b)
            + "Line line(a, b); ProjSnake shadow(line, ball); "
            + f"AbsMagnet m(ball, 0.45, {float(v)!r}); "
            + f"TanMagnet t(m, {float(0.1 * radius)!r}, {float(0.4 * radius)!r}); "
            + "ProjMagnet from_(a, ball); ProjMagnet to(b, ball); GeoSnake way(from_, to); "
            + f"XPlane plane({float(cut)!r}); IntSnake section(ball, plane); "
        )
        names = ("shadow(0)", "shadow(0.5)", "shadow(1)", "t", "way(0.5)")
        found = solved(text, *names, "shadow.length", "way.length", "section.length")
        measured.append(np.concatenate([np.atleast_1d(x) for x in found]))
        # The shadow of a chord from the centre, and the geodesic, are one great circle.
        cosine = a @ b / np.linalg.norm(a) / np.linalg.norm(b)
        arc = radius * np.arccos(cosine)
        assert abs(found[5] - arc) <= 1e-9 * radius and abs(found[6] - arc) <= 1e-8 * radius
        assert abs(found[7] - 2 * np.pi * np.sqrt(radius**2 - cut**2)) <= 1e-9 * radius
    spread = np.ptp(np.array(measured), axis=0).max()
    assert spread <= 1e-8 * radius, spread


@pytest.mark.parametrize("case", cases(15, 500))
def test_sections_between_rings_over_the_seam(case):
    random = np.random.default_rng(3000 + case)
    radius = random.uniform(0.5, 3)
    cut = random.uniform(-0.8, 0.8) * radius
    begin, end = random.uniform(0, 1, 2)
    whole = 2 * np.pi * np.sqrt(radius**2 - cut**2)
    for seam in random.uniform(-np.pi, np.pi, 3):
        text = (
            sphere(radius, seam)
            + f"XPlane plane({float(cut)!r}); IntSnake whole(ball, plane); "
            + f"AbsRing a(whole, {float(begin)!r}); AbsRing b(whole, {float(end)!r}); "
            + "IntSnake part(ball, plane, start = a, end = b); "
        )
        found = solved(text, "whole.length", "part.length")
        assert abs(found[0] - whole) <= 1e-9 * radius
        assert abs(found[1] - (end - begin) % 1 * whole) <= 1e-8 * radius


@pytest.mark.parametrize("case", cases(20, 1000))
def test_moving_the_seam_of_a_closed_curve_changes_no_answer(case):
    """A periodic spline through points, begun at each of them in turn."""
    random = np.random.default_rng(2000 + case)
    n = int(random.integers(5, 10))
    angles = np.sort(random.uniform(0, 2 * np.pi, n) * 0.1 + np.arange(n) * 2 * np.pi / n)
    radii = random.uniform(0.8, 1.2, n)
    points = np.stack(
        [radii * np.cos(angles), radii * np.sin(angles), 0.3 * random.normal(size=n)], 1
    )
    q = 1.5 * random.normal(size=3)
    share = random.uniform(0.05, 2.3)
    answers = []
    for first in (0, int(random.integers(1, n))):
        order = np.roll(np.arange(n), -first)
        names = [f"P{k}" for k in order]
        text = "".join(point(f"P{k}", points[k]) for k in range(n)) + point("q", q)
        # Knots go with the chords, so that the curve is the same from each beginning.
        text += f'CCurve c({{{", ".join([*names, names[0]])}}}, 3, ends = "periodic"); '
        model = moldloft.loads(text + "ProxBead near(c, q);")
        near = np.asarray(model.eval("near"))
        length = float(model.eval("c.length"))
        # From the same place in space, a length round and round.
        start = "ProxBead origin(c, P0); " + f"ArcLenBead on(origin, {float(share * length)!r}); "
        start += f"ArcLenBead back(origin, {float(-share * length)!r}); RelBead same(origin, 1); "
        model = moldloft.loads(text + start)
        values = [np.asarray(model.eval(name)) for name in ("on", "back", "same")]
        assert np.abs(values[2] - points[0]).max() <= 1e-9
        answers.append(np.concatenate([near, [length], *values]))
    assert np.abs(answers[0] - answers[1]).max() <= 1e-7, answers


def nearest_on_polyline(points, q):
    best = None
    for a, b in itertools.pairwise(points):
        t = np.clip((q - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        x = a + t * (b - a)
        if best is None or np.linalg.norm(x - q) < np.linalg.norm(best - q):
            best = x
    return best


@pytest.mark.parametrize("case", cases(40, 2000))
def test_nearest_to_polylines_and_their_walls(case):
    random = np.random.default_rng(3000 + case)
    n = int(random.integers(3, 8))
    closed = bool(random.integers(2))
    points = np.cumsum(random.normal(size=(n, 3)), axis=0)
    points[:, 2] = 0.0
    names = [f"P{k}" for k in range(n)]
    chain = [*range(n), 0] if closed else list(range(n))
    height = random.uniform(0.5, 2)
    text = "".join(point(f"P{k}", points[k]) for k in range(n))
    if random.integers(2):
        text += f"BCurve c({{{', '.join(names[k] for k in chain)}}}, 1); "
    else:
        pairs = list(itertools.pairwise(chain))
        text += "".join(f"Line l{i}({names[a]}, {names[b]}); " for i, (a, b) in enumerate(pairs))
        text += f"PolyCurve c({{{', '.join(f'l{i}' for i in range(len(pairs)))}}}); "
    text += point("low", (0, 0, 0)) + point("high", (0, 0, height))
    text += "Line up(low, high); TranSurf wall(c, up); "
    for _ in range(4):
        q = points.mean(axis=0) + 2.5 * random.normal(size=3)
        model = moldloft.loads(text + point("q", q) + "ProxBead b(c, q); ProxMagnet m(q, wall); ")
        line = points[chain]
        foot = nearest_on_polyline(line, q)
        found = np.asarray(model.eval("b"))
        size = np.ptp(points, axis=0).max()
        assert abs(np.linalg.norm(found - q) - np.linalg.norm(foot - q)) <= 1e-9 * size
        flat = nearest_on_polyline(line, np.array([q[0], q[1], 0.0]))
        foot = np.array([flat[0], flat[1], np.clip(q[2], 0, height)])
        found = np.asarray(model.eval("m"))
        assert abs(np.linalg.norm(found - q) - np.linalg.norm(foot - q)) <= 1e-9 * size


def test_what_depends_on_a_knuckle_has_exact_derivatives():
    """A corner that moves carries the nearest point with it, also where its parameter moves."""
    text = (
        "param w = 3; AbsPoint A(0, 0, 0); AbsPoint B(w, 1, 0.2*w); AbsPoint C(4, 4, 0);"
        "AbsPoint q(4, 0, 0.8);"
        "Line l(A, B); Line k(B, C); PolyCurve c({l, k}); ProxBead b(c, q);"
        "AbsPoint O(0, 0, -1); AbsPoint Z(0, 0, 2); Line up(O, Z); TranSurf wall(c, up);"
        "ProxMagnet m(q, wall);"
    )
    model = moldloft.loads(text)
    assert np.abs(np.asarray(model.eval("b")) - [3, 1, 0.6]).max() <= 1e-12
    slope = [model.derivative(f"b.{axis}", "w") for axis in "xyz"]
    assert np.abs(np.array(slope) - [1, 0, 0.2]).max() <= 1e-9
    assert np.abs(np.asarray(model.eval("m"))[:2] - [3, 1]).max() <= 1e-12
    slope = [model.derivative(f"m.{axis}", "w") for axis in "xy"]
    assert np.abs(np.array(slope) - [1, 0]).max() <= 1e-9


def test_a_descent_goes_on_over_a_pole():
    for angle in np.linspace(0.1, 6.2, 7):
        text = (
            sphere(2.0, 0.3)
            + point("q", (-0.5, 0.1, 3))
            + f"AbsMagnet s(ball, 0.05, {float(angle / 7)!r}); "
        )
        (found,) = solved(text + "ProjMagnet k(q, s); ", "k")
        q = np.array([-0.5, 0.1, 3])
        assert np.abs(found - 2 * q / np.linalg.norm(q)).max() <= 1e-9


def test_a_part_of_a_closed_curve_runs_over_its_seam():
    text = (
        "AbsPoint A(1, 0, 0); AbsPoint B(0, 1, 0); AbsPoint C(-1, -0.2, 0);"
        'CCurve c({A, B, C, A}, 3, ends = "periodic");'
        "AbsBead b0(c, 0.9); AbsBead b1(c, 1.1); SubCurve part(b0, b1);"
    )
    m = moldloft.loads(text)
    c, part = m["c"], m["part"]
    for t in np.linspace(0, 1, 11):
        where = (0.9 + 0.2 * t) % 1
        assert np.abs(np.asarray(part(t)) - np.asarray(c(where))).max() <= 1e-12
    whole = m.eval("c.length")
    rest = moldloft.loads(text + "AbsBead b2(c, 0.1); SubCurve rest(b2, b0);").eval("rest.length")
    assert abs(m.eval("part.length") + rest - whole) <= 1e-9
