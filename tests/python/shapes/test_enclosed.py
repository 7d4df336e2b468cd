"""The volume enclosed by several surfaces as one expression."""

from __future__ import annotations

import math

import pytest

import moldloft

CYLINDER = """
param float r = 1.5 in [1, 2];
AbsPoint O(3, -2, 1); RelPoint T(O, 0, 0, 2); RelPoint A(O, r, 0, 0); RelPoint B(O, r, 0, 2);
Line axis(O, T); Line low(O, A); Line side(A, B); Line high(B, T);
RevSurf bottom(low, axis); RevSurf wall(side, axis, visible = 0); RevSurf top(high, axis);
"""


@pytest.mark.parametrize(
    "call",
    ["volume(bottom, wall, top)", "volume({top, wall, bottom})", "volume({wall}, {top, bottom})"],
)
def test_a_cylinder_of_three_surfaces(call: str) -> None:
    model = moldloft.loads(CYLINDER)
    assert float(model.eval(call)) == pytest.approx(2 * math.pi * 1.5**2, rel=1e-9)
    slope = model.derivatives([call], ["r"])
    assert float(slope[0][0] if not hasattr(slope, "shape") else slope.ravel()[0]) == pytest.approx(
        4 * math.pi * 1.5, rel=1e-8
    )


def test_knuckles_trims_and_reversed_surfaces() -> None:
    """A prism of a swept chain, a trimmed lid on a larger plane, and a ruled lid."""
    model = moldloft.loads("""
        AbsPoint A(0, 0, 0); AbsPoint B(2, 0, 0); AbsPoint C(3, 1, 0); AbsPoint D(0, 2, 0);
        Line ab(A, B); Line bc(B, C); Line cd(C, D); Line da(D, A);
        PolyCurve ring({ab, bc, cd, da}); AbsPoint E(0.5, 0.2, 4); Line up(A, E);
        TranSurf wall(ring, up, orientation = 1);
        AbsPoint P(-5, -5, 0); AbsPoint Q(5, -5, 0); AbsPoint R(-5, 5, 0); AbsPoint S(5, 5, 0);
        Line pq(P, Q); Line rs(R, S); RuledSurf plane(pq, rs, visible = 0);
        ProjSnake foot(ring, plane); TrimSurf low(plane, {foot});
        AbsPoint P2(-5, -5, 4); AbsPoint Q2(5, -5, 4); AbsPoint R2(-5, 5, 4); AbsPoint S2(5, 5, 4);
        Line pq2(P2, Q2); Line rs2(R2, S2); RuledSurf over(rs2, pq2, visible = 0);
        CopyCurve head(ring, A, E); ProjSnake top(head, over); TrimSurf lid(over, {top});
    """)
    area = 0.5 * (2 * 1 - 3 * 0 + 3 * 2 - 0 * 1)
    assert float(model.eval("volume(wall, low, lid)")) == pytest.approx(4 * area, rel=1e-9)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("volume(bottom, wall)", "are open"),
        ("volume(bottom, wall, top, other)", "surface 4"),
        ("volume(bottom, wall, top, ball)", "2 volumes"),
    ],
)
def test_what_bounds_no_single_body_is_refused(call: str, said: str) -> None:
    more = """
    AbsPoint X(9, 0, 0); AbsPoint Y(9, 1, 0); AbsPoint Z(9, 0, 1); Line xy(X, Y); Line xz(X, Z);
    TranSurf other(xy, xz); AbsPoint N(20, 0, 1); AbsPoint M(21, 0, 0); AbsPoint L(20, 0, -1);
    Line pole(L, N); Arc half(L, M, N, type = 1); RevSurf ball(half, pole);
    """
    model = moldloft.loads(CYLINDER + more)
    with pytest.raises(moldloft.ModelError, match=said) as caught:
        model.eval(call)
    assert caught.value.diagnostics[0].id == "not-closed"
