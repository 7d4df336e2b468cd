"""Parts of surfaces across the joints and knuckles of the whole: measures, derivatives, panels."""

from __future__ import annotations

import math

import numpy as np
import pytest

import moldloft

# Two planes that meet in a ridge, and a part of them whose sides run askew over it.
ROOF = """
param float low = 0.75 in [0.6, 0.95];
param float ridge = 1 in [0.8, 1.2];
AbsPoint A(0, 0, 0); AbsPoint B(1, 0, ridge); AbsPoint C(2, 0, 0);
Line l(A, B); Line r(B, C); PolyCurve p({l, r});
AbsPoint O(0, 0, 0); AbsPoint Y(0, 4, 0); Line path(O, Y); TranSurf roof(p, path, visible = 0);
AbsMagnet a(roof, 0, 0); AbsMagnet b(roof, low, 0);
AbsMagnet c(roof, 1, 1); AbsMagnet d(roof, 0.25, 1);
LineSnake s1(a, b); LineSnake s2(b, c); LineSnake s3(d, c); LineSnake s4(a, d);
SubSurf part({s1, s2, s3, s4}, divisions = {8, 8});
"""

# A round nose on a cylinder, tangent to each other, cut off behind the joint along a curve.
NOSE = """
param float far = 0.9 in [0.8, 0.98];
AbsPoint T(-1, 0, 0); AbsPoint C(0, 0, 1); AbsPoint E(4, 0, 1); AbsPoint X(4, 0, 0);
AbsPoint M(-sqrt(0.5), 0, sqrt(0.5)); Arc nose(T, M, C); Line wall(C, E);
PolyCurve profile({nose, wall}); Line axis(T, X); RevSurf bulb(profile, axis, 0, 2*PI, visible = 0);
EdgeSnake pole(4, bulb);
AbsMagnet a(bulb, far, 0); AbsMagnet b(bulb, 0.55, 0.5); AbsMagnet c(bulb, far, 1);
BSnake cut({a, b, c}, degree = 2);
SubSurf skin({pole, cut});
"""


def test_a_part_across_a_ridge_has_the_area_of_both_sides() -> None:
    m = moldloft.loads(ROOF)
    # Without the stretch the part is a trapezoid: half the sum of its sides, over 4.
    for low in (0.75, 0.9, 0.6):
        m["low"] = low
        assert m.eval("part.area") == pytest.approx(math.sqrt(2) * 4 * (low + 0.75), rel=1e-12)
        assert m.derivative("part.area", "low") == pytest.approx(4 * math.sqrt(2), rel=1e-9)
        # By the height of the ridge: along both planes alike.
        slope = 4 * (low + 0.75) / math.sqrt(2)
        assert m.derivative("part.area", "ridge") == pytest.approx(slope, rel=1e-9)
    for copy in (
        'MirrSurf other(part, "x=0");',
        "RotatSurf other(part, path, 1);",
        "CopySurf other(part, O, Y, 1, 1, 1);",
        "OffsetSurf other(part, 0);",
        "SubSurf other({part.v0, part.u1, part.v1, part.u0});",
    ):
        other = moldloft.loads(ROOF + copy)
        assert other.eval("other.area") == pytest.approx(6 * math.sqrt(2), rel=1e-10), copy


def test_panels_that_cut_a_knuckle_off_are_named() -> None:
    m = moldloft.loads(ROOF)
    m.mesh()
    (warning,) = [d for d in m.diagnostics if d.id == "knuckle-across-panels"]
    assert warning.object == "part" and not warning.is_error
    # Two parts that meet at the ridge keep it.
    halves = (
        ROOF.replace("SubSurf part({s1, s2, s3, s4}, divisions = {8, 8});", "")
        + """
    UVSnake top(roof, "u", 0.5); IntRing e(s1, top); IntRing f(s3, top);
    AbsMagnet g(roof, 0.5, 0); AbsMagnet h(roof, 0.5, 1); LineSnake crest(g, h);
    LineSnake q1(a, g); LineSnake q3(d, h); SubSurf port({q1, crest, q3, s4}, divisions = {4, 8});
    """
    )
    m = moldloft.loads(halves)
    m.mesh()
    assert not [d for d in m.diagnostics if d.id == "knuckle-across-panels"]


def test_a_nose_on_a_cylinder_has_its_area() -> None:
    m = moldloft.loads(NOSE)

    def area(far: float) -> float:
        # The sphere as far as the joint, and the cylinder up to the cut, of length 8 (u - 1/2).
        v = (np.polynomial.legendre.leggauss(40)[0] + 1) / 2
        w = np.polynomial.legendre.leggauss(40)[1] / 2
        t = v
        u = (1 - t) ** 2 * far + 2 * t * (1 - t) * 0.55 + t**2 * far
        around = 2 * (1 - t) * t * 0.5 + t**2
        slope = 2 * (1 - t) * 0.5 + 2 * t * 0.5
        assert np.allclose(around, t)
        return 2 * math.pi + float(np.sum(w * 8 * (u - 0.5) * slope)) * 2 * math.pi

    for far in (0.9, 0.83, 0.96):
        m["far"] = far
        assert m.eval("skin.area") == pytest.approx(area(far), rel=1e-9)
        slope = (area(far + 1e-5) - area(far - 1e-5)) / 2e-5
        assert m.derivative("skin.area", "far") == pytest.approx(slope, rel=1e-8)
