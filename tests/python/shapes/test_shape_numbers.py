"""Measures of shapes as functions, coordinates as vectors, numbers of objects as unknowns."""

from __future__ import annotations

import os

import numpy as np
import pytest
from scipy.optimize import brentq

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

BOX = """
AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(0, 1, 0); AbsPoint D(2, 1, 0);
AbsPoint E(0, 0, 3); AbsPoint F(2, 0, 3); AbsPoint G(0, 1, 3); AbsPoint H(2, 1, 3);
Line a(A, B); Line b(C, D); Line c(E, F); Line d(G, H);
RuledSurf low(a, b); RuledSurf high(c, d); RuledSolid box(low, high);
SetBody body(cuboid({0, 0, 0}, {1, 2, 3}));
"""


def test_area_volume_and_distance_take_shapes() -> None:
    m = moldloft.loads(BOX)
    assert m.eval("area(low)") == pytest.approx(2, rel=1e-12)
    assert m.eval("volume(box)") == pytest.approx(6, rel=1e-12)
    assert m.eval("volume(body)") == pytest.approx(6, rel=1e-9)
    assert m.eval("area(body)") == pytest.approx(22, rel=1e-9)
    assert m.eval("distance(A, H)") == pytest.approx(np.sqrt(14), rel=1e-15)
    assert m.eval("distance({1, 0.5, 2}, low)") == pytest.approx(2, rel=1e-15)
    assert m.eval("distance(high, {3, 0.5, 3})") == pytest.approx(1, rel=1e-15)
    assert m.eval("distance(E, a)") == pytest.approx(3, rel=1e-15)
    assert m.eval("distance(A, a)") == 0
    with pytest.raises(moldloft.Error, match="from a point"):
        m.eval("distance(low, high)")
    with pytest.raises(moldloft.Error):
        m.eval("volume(low)")
    with pytest.raises(moldloft.Error):
        m.eval("area(a)")


@pytest.mark.parametrize("seed", range(100 if SOAK else 10))
def test_distances_from_balls_and_circles(seed: int) -> None:
    rng = np.random.default_rng(seed)
    r, place = rng.uniform(0.5, 2), rng.normal(size=3) * 3
    m = moldloft.loads(f"""
        param float r = {r:.17g}; param float x = {place[0]:.17g};
        AbsPoint S(0, 0, -r); AbsPoint E(0, 0, r); AbsPoint Q(r, 0, 0); Arc half(S, Q, E);
        Line axis(S, E, visible = 0); RevSurf ball(half, axis);
        AbsPoint P(x, {place[1]:.17g}, {place[2]:.17g});""")
    far = np.linalg.norm(place)
    assert m.eval("distance(P, ball)") == pytest.approx(abs(far - r), rel=1e-9)
    sign = np.sign(far - r)
    assert m.derivative("distance(P, ball)", "x") == pytest.approx(sign * place[0] / far, rel=1e-7)
    assert m.derivative("distance(P, ball)", "r") == pytest.approx(-sign, rel=1e-7)


def test_coordinates_may_be_a_vector() -> None:
    m = moldloft.loads("""
        param float w = 2; AbsPoint A(0, 0, 0); AbsPoint B(w, 4, 6); AbsPoint M(0.5*(A + B));
        AbsPoint N({1, 2, 3});
        RelPoint R(M, {1, 0, w}); AbsPoint K(A + {0, 0, 1}, layer = 3);""")
    assert np.asarray(m["M"]).tolist() == [1, 2, 3] and np.asarray(m["N"]).tolist() == [1, 2, 3]
    assert np.asarray(m["R"]).tolist() == [2, 2, 5] and np.asarray(m["K"]).tolist() == [0, 0, 1]
    assert m.derivative("R.z", "w") == 1
    for name in ("M.x", "N.x", "N.y"):
        with pytest.raises(moldloft.Error):
            m[name] = 3.0
    with pytest.raises(moldloft.Error, match="number"):
        moldloft.loads("AbsPoint A({1, 2, 3}, 4);").check()


def test_numbers_of_objects_are_unknowns() -> None:
    m = moldloft.loads("""
        param float reach = 5;
        AbsPoint A(0, 0, 0); AbsPoint B(4, 1, 0); Line l(A, B); AbsBead q(l, 0.2);
        SolveSet s({B.y, q.t}, {l.length - reach, q.x - 3});
        Line after(A, B);""")
    assert not m.diagnostics
    assert m.eval("B.y") == pytest.approx(3, rel=1e-12) and m.eval("q.t") == pytest.approx(
        0.75, rel=1e-12
    )
    assert m.eval("after.length") == pytest.approx(5, rel=1e-12)
    assert m.eval("s.y") == pytest.approx(3, rel=1e-12) and m.eval("s.status") == "solved"
    # y = sqrt(reach^2 - 16)
    assert m.derivative("B.y", "reach") == pytest.approx(5 / 3, rel=1e-10)
    assert m.derivative("after.length", "reach") == pytest.approx(1, rel=1e-10)
    m["reach"] = 4.5
    assert m.eval("B.y") == pytest.approx(np.sqrt(4.5**2 - 16), rel=1e-12)
    m["B.x"] = 3.6
    assert m.eval("l.length") == pytest.approx(4.5, rel=1e-12)
    assert "AbsPoint B(3.6, 1, 0)" in m.text


@pytest.mark.parametrize("seed", range(60 if SOAK else 8))
def test_an_unknown_of_a_loft_against_brentq(seed: int) -> None:
    """The height of a point of a profile so that the area of the surface is what it should be."""
    rng = np.random.default_rng(seed)
    y = rng.uniform(0.5, 1.5, 3)

    def text(z: float, rest: str = "") -> str:
        return f"""
            AbsPoint A(0, {y[0]:.15g}, 0); AbsPoint B(1, {y[1]:.15g}, {z:.17g});
            AbsPoint C(3, {y[2]:.15g}, 0); AbsPoint O(0, 0, 0); AbsPoint U(0.2, 1, 0);
            BCurve low({{A, B, C}}, 2); Line up(O, U); TranSurf s(low, up); {rest}"""

    target = moldloft.loads(text(rng.uniform(1, 2))).eval("s.area")
    exact = brentq(lambda z: moldloft.loads(text(z)).eval("s.area") - target, 0.3, 3, xtol=1e-12)
    m = moldloft.loads(text(0.8, f"SolveSet q({{B.z}}, {{s.area - {target:.17g}}});"))
    assert m.eval("B.z") == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("AbsPoint A(0, 0, 0); SolveSet s({A.w}, {A.x});", "A.w"),
        ("param float w = 1; AbsPoint A(2*w, 0, 0); SolveSet s({A.x}, {A.x - 3});", "of its own"),
        ("AbsPoint A(1, 0, 0); SolveSet s({A.x, A.x}, {A.x, A.x});", "already"),
        ("AbsPoint A(1, 0, 0); SolveSet s({B.x}, {A.x});", "B"),
        (
            "for (i = 1:2) { AbsPoint A(1, 0, 0); } SolveSet s({A[1].x}, {A[1].x});",
            "of its own",
        ),
    ],
)
def test_what_is_no_unknown_is_refused(text: str, says: str) -> None:
    with pytest.raises(moldloft.Error, match=says):
        moldloft.loads(text).check()


SHEETS = {
    # A square of 2 by 2 less a circle of 0.2 in (u, v): of 0.4 in space.
    "hole": (
        "Line l({0, 0, 0}, {2, 0, 0}); Line m({0, 2, 0}, {2, 2, 0}); RuledSurf S(l, m);"
        "AbsMagnet p(S, 0.5, 0.5); AbsMagnet q(S, 0.7, 0.5); AbsMagnet r(S, 0.5, 0.7);"
        "ArcSnake ring(q, p, r, type = 6); TrimSurf T(S, {ring}, whole = 1{more});",
        4 - np.pi * 0.16,
    ),
    # A quarter of a cylinder of radius 1 and length 3, cut along a diagonal of (u, v).
    "wrap": (
        "Line o({0, 0, 0}, {3, 0, 0}); Line l({0, 1, 0}, {3, 1, 0});"
        "RevSurf S(l, o, 0, radians(90));"
        "AbsMagnet a(S, 0, 0); AbsMagnet b(S, 1, 0); AbsMagnet c(S, 1, 1);"
        "LineSnake ab(a, b); LineSnake bc(b, c); LineSnake ca(c, a);"
        "TrimSurf T(S, {ab, bc, ca}{more});",
        3 * np.pi / 4,
    ),
}


@pytest.mark.parametrize("name", SHEETS)
def test_trimmed_surfaces_have_the_area_of_the_surface_not_of_their_panels(name: str) -> None:
    text, area = SHEETS[name]
    for more in ("", ", rim = 3, nu = 2, nv = 2"):
        m = moldloft.loads(text.replace("{more}", more))
        assert m.eval("T.area") == pytest.approx(area, rel=1e-9)
        assert m.eval("area(T)") == pytest.approx(area, rel=1e-9)
    # Panels are chords of it.
    assert m.mesh().patches[0].area != pytest.approx(area, rel=1e-3)


def test_trimmed_surfaces_weigh_by_their_area() -> None:
    plate = """
    Line {n}a({{{x}, 0, {z}}}, {{{x} + 4, 0, {z}}});
    Line {n}b({{{x}, 2, {z}}}, {{{x} + 4, 2, {z}}});
    RuledSurf {n}s({n}a, {n}b, visible = 0);
    AbsMagnet {n}1({n}s, 0, 0); AbsMagnet {n}2({n}s, {share}, 0);
    AbsMagnet {n}3({n}s, {share}, 1); AbsMagnet {n}4({n}s, 0, 1);
    LineSnake {n}k({n}1, {n}2); LineSnake {n}l({n}2, {n}3);
    LineSnake {n}m({n}3, {n}4); LineSnake {n}n({n}4, {n}1);
    TrimSurf {n}({n}s, {{{n}k, {n}l, {n}m, {n}n}});
    """
    text = plate.format(n="p", x=0, z=1, share=0.5) + plate.format(n="q", x=10, z=7, share=0.25)
    model = moldloft.loads(text + "CentroidPoint c({p, q}); Weight w(p, per = 3);")
    # Areas of 4 and 2, with their middles at x = 1 and 10.5: not the cones from the origin.
    assert model.eval("p.area") == pytest.approx(4, rel=1e-9)
    assert model["c"].value == pytest.approx([(4 * 1 + 2 * 10.5) / 6, 1, 3], rel=1e-9)
    assert model.eval("w.mass") == pytest.approx(12, rel=1e-9)
