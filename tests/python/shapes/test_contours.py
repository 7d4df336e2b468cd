"""Sections of surfaces and bodies against closed forms, SciPy, and differences."""

from __future__ import annotations

import os

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))


def ball(r: float, rest: str) -> moldloft.Model:
    return moldloft.loads(f"""
        param float r = {r}; AbsPoint S(0, 0, -r); AbsPoint E(0, 0, r); AbsPoint Q(r, 0, 0);
        Arc profile(S, Q, E); Line axis(S, E, visible = 0); RevSurf ball(profile, axis);
        {rest}""")


@pytest.mark.parametrize("seed", range(200 if SOAK else 12))
def test_balls_cut_by_any_plane(seed: int) -> None:
    rng = np.random.default_rng(seed)
    r, normal = rng.uniform(0.5, 5), rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    tip = ", ".join(f"{x:.15g}" for x in normal)
    heights = np.sort(rng.uniform(-0.95 * r, 0.95 * r, 2))
    step = heights[1] - heights[0]
    m = ball(
        r,
        f"AbsPoint O(0, 0, 0); AbsPoint N({tip}); TwoPointPlane p(O, N);"
        f"PlaneContours c(p, 0, 1, {heights[0]:.17g}, {step:.17g});",
    )
    radius = np.sqrt(r * r - heights**2)
    np.testing.assert_allclose(m["c"].lengths, 2 * np.pi * radius, rtol=2e-8)
    np.testing.assert_allclose(m["c"].areas, np.pi * radius**2, rtol=2e-8)
    slopes = m.derivative("c.areas", "r")
    np.testing.assert_allclose(slopes, np.full(2, 2 * np.pi * r), rtol=1e-5)
    slopes = m.derivative("c.lengths", "r")
    np.testing.assert_allclose(slopes, 2 * np.pi * r / radius, rtol=1e-5)


def test_a_torus_has_a_hole_between_its_circles() -> None:
    m = moldloft.loads("""
        AbsPoint A(2, 0, 0); AbsPoint B(3, 0, 1); AbsPoint C(4, 0, 0); AbsPoint D(3, 0, -1);
        AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z, visible = 0);
        Arc upper(A, B, C); Arc lower(C, D, A); PolyCurve ring({upper, lower});
        RevSurf torus(ring, axis); ZContours z(0, 2, 0, 0.3); YContours y(0, 0, 0, 1);
        CylinderContours c(axis, 1, 1, 1.5, 1.5);
        AngleContours a(axis, 0, 3, 0.2, 1);""")
    z = np.array([0, 0.3, 0.6])
    np.testing.assert_allclose(m["z"].areas, 4 * np.pi * 3 * np.sqrt(1 - z**2), rtol=1e-8)
    np.testing.assert_allclose(m["z"].lengths, np.full(3, 12 * np.pi), rtol=1e-8)
    np.testing.assert_allclose(m["y"].areas, [2 * np.pi], rtol=1e-8)
    np.testing.assert_allclose(m["a"].areas, np.full(4, np.pi), rtol=1e-8)
    np.testing.assert_allclose(m["c"].lengths, [12 * np.pi], rtol=1e-8)
    with pytest.raises(moldloft.Error, match="not plane"):
        m.eval("c.areas")


@pytest.mark.parametrize("seed", range(200 if SOAK else 12))
def test_prisms_of_polygons(seed: int) -> None:
    """A wall round a polygon: the section is the polygon, moved and turned corners included."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 9))
    angle = np.sort(rng.uniform(0, 2 * np.pi, n))
    radius = rng.uniform(0.6, 2, n)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    points = "".join(
        f"AbsPoint A{k}({x[k]:.17g}*w, {y[k]:.17g}, 0);"
        f"AbsPoint B{k}({x[k]:.17g}*w, {y[k]:.17g}, 2);"
        for k in range(n)
    )
    ring = [", ".join(f"{side}{k % n}" for k in range(n + 1)) for side in "AB"]
    m = moldloft.loads(f"""param float w = 1; {points}
        BCurve low({{{ring[0]}}}, 1); BCurve high({{{ring[1]}}}, 1); RuledSurf wall(low, high);
        ZContours z(0, 1, 0.5, 0.7);""")
    area = 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    steps = np.hypot(np.roll(x, -1) - x, np.roll(y, -1) - y)
    if n > 2 and area > 1e-3:
        np.testing.assert_allclose(m["z"].areas, [area, area], rtol=1e-12)
        np.testing.assert_allclose(m.derivative("z.areas", "w"), [area, area], rtol=1e-9)
    np.testing.assert_allclose(m["z"].lengths, np.full(2, steps.sum()), rtol=1e-12)
    slope = np.sum((np.roll(x, -1) - x) ** 2 / steps)
    np.testing.assert_allclose(m.derivative("z.lengths", "w"), [slope, slope], rtol=1e-9)


def test_half_hulls_have_the_area_of_both_sides_up_to_the_chord() -> None:
    m = moldloft.loads("""
        Model info(symmetry = "y"); param float b = 2;
        AbsPoint K1(0, 0, -1); AbsPoint K2(9, 0, -1); AbsPoint D1(0, b, 1); AbsPoint D2(9, b/2, 1);
        Line keel(K1, K2); Line sheer(D1, D2); RuledSurf side(keel, sheer);
        XContours x(0, 3, 0, 3); YContours y(0, 0, 0.5, 1);""")
    beam = 2 - np.array([0, 3, 6, 9]) / 9
    with pytest.warns(UserWarning, match="straight chords"):
        areas = m["x"].areas
    np.testing.assert_allclose(areas, 2 * beam, rtol=1e-12)
    np.testing.assert_allclose(m["x"].lengths, 2 * np.hypot(beam, 2), rtol=1e-12)
    # A buttock is on one side alone.
    lines = m["y"].sections[0]
    assert len(lines) == 1 and np.allclose(lines[0].points[:, 1], 0.5)


def test_bodies_and_surfaces_are_chosen_by_name() -> None:
    m = moldloft.loads("""
        param float a = 2; set block = cuboid({0, 0, 0}, {a, 3, 1});
        set hole = cuboid({0.5, 1, -1}, {1, 2, 2});
        SetBody body(block - hole); SetBody plug(hole);
        AbsPoint P(0, 0, 0.5); AbsPoint Q(9, 0, 0.5); AbsPoint R(0, 9, 0.2); AbsPoint T(9, 9, 0.2);
        Line p(P, Q); Line q(R, T); RuledSurf sheet(p, q);
        EntityList both({body, plug});
        ZContours z(0, 0, 0.5, 1, surfaces = {body}); ZContours w(0, 0, 0.5, 1, surfaces = {both});
        XContours x(0, 0, 1.5, 1, surfaces = {body, sheet});""")
    np.testing.assert_allclose(m["z"].areas, [5.5], rtol=1e-12)
    np.testing.assert_allclose(m["z"].lengths, [13], rtol=1e-12)
    np.testing.assert_allclose(m["w"].areas, [6], rtol=1e-12)
    np.testing.assert_allclose(m.derivative("z.areas", "a"), [3], rtol=1e-9)
    np.testing.assert_allclose(m["x"].lengths, [8 + np.hypot(9, 0.3)], rtol=1e-12)
    with pytest.raises(moldloft.Error, match="SetBody"):
        moldloft.loads(
            "set s = sphere({0, 0, 0}, 1); ZContours z(0, 0, 0, 1, surfaces = {s});"
        ).check()
    with pytest.raises(moldloft.Error):
        moldloft.loads(
            "AbsPoint A(0, 0, 0); ZContours z(0, 0, 0, 1, surfaces = {A}); print(z.lengths);"
        ).check()


@pytest.mark.parametrize("seed", range(100 if SOAK else 8))
def test_lofts_against_roots_and_quadrature(seed: int) -> None:
    """Stations of a random hull-like loft: its x inverted by SciPy, the length by quadrature."""
    rng = np.random.default_rng(seed)
    rows = []
    for k in range(4):
        x = 3 * k + rng.uniform(-0.6, 0.6, 3)
        breadth = np.array([0, rng.uniform(0.8, 1.6), rng.uniform(1.6, 2.4)])
        depth = np.array([-1.5, -0.8, 0.7]) + rng.uniform(-0.2, 0.2, 3)
        for j in range(3):
            rows.append(f"AbsPoint P{k}{j}({x[j]:.15g}, s*{breadth[j]:.15g}, {depth[j]:.15g});")
        rows.append(f"BCurve M{k}({{P{k}0, P{k}1, P{k}2}}, 2);")
    station = rng.uniform(2, 7)
    m = moldloft.loads(
        "param float s = 1;"
        + "".join(rows)
        + f"BLoftSurf hull({{M0, M1, M2, M3}}, 3); XContours c(0, 0, {station:.17g}, 1);"
    )
    hull = m["hull"]

    def at(v: float) -> np.ndarray:
        # Curves of the masters run along u, from master to master along v.
        return np.asarray(hull(v, brentq(lambda w: hull(v, w)[0] - station, 0, 1, xtol=1e-14)))

    def speed(v: float) -> float:
        h = 1e-4
        d = (-at(v + 2 * h) + 8 * at(v + h) - 8 * at(v - h) + at(v - 2 * h)) / (12 * h)
        return float(np.linalg.norm(d))

    length = (
        quad(speed, 0, 1, epsabs=1e-9, epsrel=1e-9, points=[0.5])[0] if hull(0.5, 0.5)[0] else 0
    )
    np.testing.assert_allclose(m["c"].lengths, [length], rtol=3e-7)
    slope = m.derivative("c.lengths", "s")[0]
    sides = []
    for change in (1e-4, -1e-4):
        m["s"] = 1 + change
        sides.append(m["c"].lengths[0])
    np.testing.assert_allclose(slope, (sides[0] - sides[1]) / 2e-4, rtol=1e-6)


def test_sections_in_an_edge() -> None:
    """The first and last station are edges; one in the middle is shared by two surfaces."""
    m = moldloft.loads("""
        AbsPoint A(0, 0, 0); AbsPoint B(0, 1, 2); AbsPoint C(4, 0, 0); AbsPoint D(4, 2, 2);
        AbsPoint E(6, 0, 0); AbsPoint F(6, 1, 1); AbsPoint Q(4, 1.5, 0.5);
        Line a(A, B); BCurve c({C, Q, D}, 2); Line e(E, F);
        RuledSurf fore(a, c); RuledSurf aft(e, c);
        XContours x(0, 3, 0, 2); ZContours z(0, 0, 0, 1);""")
    np.testing.assert_allclose(m["x"].lengths[[0, 3]], [np.sqrt(5), np.sqrt(2)], rtol=1e-12)
    np.testing.assert_allclose(m["x"].lengths[2], m.eval("c.length"), rtol=1e-10)
    np.testing.assert_allclose(m["z"].lengths, [6], rtol=1e-12)


def test_sections_that_meet_nothing_are_empty() -> None:
    m = ball(1, "ZContours z(0, 1, 0.5, 2);")
    assert m["z"].lengths[1] == 0 and m["z"].areas[1] == 0
    assert m["z"].sections[1] == []
    line = m["z"].sections[0][0]
    assert m.eval("z.lines[1].d1") == len(line.points) + line.closed
