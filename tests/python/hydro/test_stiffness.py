"""The hydrostatic stiffness matrix: closed forms, energies of inclined bodies, Capytaine."""

from __future__ import annotations

import json
import math
import re

import numpy as np
import pytest

import moldloft
from test_hydrostatics import BARGE, B, L

BALL = """Model info(units = "m");
param float radius = 0.5 in [0.2, 1];
AbsPoint a(-radius, 0, -3); AbsPoint b(radius, 0, -3); Line axis(a, b);
Arc half(a, {0, 0, -3 + radius}, b, type = 1); RevSurf body(half, axis, 0, 2*PI);
"""

#: A wedge with inclined sides and ends, asymmetric fore and aft, without symmetry across.
WEDGE = """Model info(units = "m");
param float rise = 0.3 in [0, 1];
AbsPoint a(0, -1, -1); AbsPoint b(7, -0.5, -1.2); AbsPoint c(6, 1.2, -1); AbsPoint d(-0.5, 1, -0.8);
AbsPoint e(-1, -1.6, 2 + rise); AbsPoint f(8, -1.4, 2); AbsPoint g(7, 2, 2); AbsPoint h(-1, 1.5, 2);
Line ab(a, b); Line bc(b, c); Line dc(d, c); Line ad(a, d);
Line ef(e, f); Line fg(f, g); Line hg(h, g); Line eh(e, h);
RuledSurf bottom(ab, dc); RuledSurf top(ef, hg); RuledSurf port(ab, ef);
RuledSurf starboard(dc, hg); RuledSurf fore(bc, fg); RuledSurf aft(ad, eh);
"""


def test_a_box_by_closed_forms(tmp_path):
    draft, cg, rho, g = 1.3, (5.0, 0.0, 1.0), 1025.0, 9.81
    state = moldloft.loads(BARGE).hydrostatics(draft=draft, density=rho, gravity=g, cg=cg)
    k = state.stiffness(cg)
    gamma, area, volume = rho * g, L * B, L * B * draft
    expected = np.zeros((6, 6))
    expected[2, 2] = gamma * area
    expected[2, 4] = expected[4, 2] = -gamma * area * (6 - 5)
    expected[3, 3] = gamma * (L * B**3 / 12 + volume * (draft / 2 - 1))
    expected[4, 4] = gamma * (B * L**3 / 12 + area + volume * (draft / 2 - 1))
    expected[3, 5] = -gamma * volume * (6 - 5)
    np.testing.assert_allclose(k, expected, rtol=1e-9, atol=1e-6 * gamma)
    assert k[3, 3] == pytest.approx(gamma * volume * state.gmt, rel=1e-9)
    # Half the weight hangs on a mooring at G: what it carries does not incline.
    half = state.stiffness(cg, mass=state.displacement / 2)
    assert half[3, 3] - k[3, 3] == pytest.approx(0, abs=1e-6 * gamma)
    shifted = state.stiffness(cg, mass=state.displacement / 2, about=(5, 0, 0))
    assert shifted[3, 3] == pytest.approx(
        gamma * (L * B**3 / 12 + volume * (draft / 2 - 0.5 * 1.0)), rel=1e-9
    )
    paths = state.write_kh(tmp_path, cg)
    np.testing.assert_allclose(np.loadtxt(paths[0]), k, rtol=1e-6, atol=1e-6 * gamma)
    text = paths[1].read_text()
    assert "XF =   6.000 - XG =   5.000" in text and "ZF =  -0.650 - ZG =  -0.300" in text
    assert f"Displacement = {volume:E}"[:-6] in text and len(text.splitlines()) == 5


def test_a_body_under_water_has_its_moments_alone():
    m = moldloft.loads(BALL)
    cg = (0.4, 0.1, -3.2)
    state = m.hydrostatics(density=1000, gravity=10, by=["radius"], cg=cg)
    k = state.stiffness(cg)
    weight = 1e4 * 4 / 3 * math.pi * 0.5**3
    expected = np.zeros((6, 6))
    expected[3, 3] = expected[4, 4] = weight * 0.2
    expected[3, 5], expected[4, 5] = weight * 0.4, weight * 0.1
    np.testing.assert_allclose(k, expected, rtol=1e-6, atol=1e-6 * weight)
    slope = state.stiffness(cg, by="radius")
    assert slope[3, 3] == pytest.approx(3 * k[3, 3] / 0.5, rel=1e-6)
    assert state.stable is True
    top_heavy = m.hydrostatics(density=1000, cg=(0, 0, -2.9))
    assert top_heavy.stable is False
    assert top_heavy.stiffness((0, 0, -2.9))[4, 4] < 0


@pytest.mark.parametrize(("trim", "heel"), [(0.0, 0.0), (0.05, 0.0), (-0.03, 0.3), (0.1, -0.6)])
def test_the_matrix_is_the_slope_of_the_forces(trim, heel):
    """Heave, roll and pitch of an inclined wedge, by differences of volume and arms."""
    m = moldloft.loads(WEDGE)
    cg, rho, g = np.array([2.7, 0.2, 0.4]), 2.0, 3.0

    def state(level, trim, heel):
        return m.hydrostatics(
            level=level, trim=trim, heel=heel, density=rho, gravity=g, accuracy=1e-9
        )

    def axes(trim, heel):
        s, c, sf, cf = math.sin(trim), math.cos(trim), math.sin(heel), math.cos(heel)
        return np.array([[c, -s * sf, s * cf], [0, cf, sf], [-s, -c * sf, c * cf]])

    base = state(0.1, trim, heel)
    k = base.stiffness(cg)
    r = axes(trim, heel)
    h = 1e-4
    weight = base.weight

    def forces(found, r):
        """Vertical force, and moments about G in the level axes of the attitude asked for."""
        b = np.array([found.lcb, found.tcb, found.vcb]) - cg
        up = found.weight * r[2]
        moment = np.cross(b, up)
        return found.weight - weight, moment

    # Heave: the body rises by h, the water falls.
    up, down = (forces(state(0.1 + s * h, trim, heel), r) for s in (-1, 1))
    assert (up[0] - down[0]) / (2 * h) == pytest.approx(-k[2, 2], rel=1e-6)
    moment = r @ ((up[1] - down[1]) / (2 * h))
    np.testing.assert_allclose(moment[:2], -k[[3, 4], 2], rtol=1e-5, atol=1e-5 * k[2, 2])

    # Turns about level axes through G: the attitude whose up is the turned one.
    for axis in (0, 1):
        found = []
        for sign in (1, -1):
            # The body turns by +angle about the axis: in the body, up turns by -angle.
            angle = -sign * h
            e = r[axis]
            n = r[2] * math.cos(angle) + np.cross(e, r[2]) * math.sin(angle)
            trim1 = math.atan2(-n[0], math.hypot(n[1], n[2]))
            heel1 = math.atan2(-n[1], n[2])
            level = 0.1 - (r[2] @ cg) + (n @ cg)
            turned = axes(trim1, heel1)
            np.testing.assert_allclose(turned[2], n, atol=1e-12)
            force, moment = forces(state(level, trim1, heel1), turned)
            # Level axes that turned with nothing but the body: those of before, seen from the body.
            level_axes = [
                a * math.cos(angle)
                + np.cross(e, a) * math.sin(angle)
                + e * (e @ a) * (1 - math.cos(angle))
                for a in r[:2]
            ]
            found.append((force, np.array([moment @ a for a in level_axes])))
        (f1, m1), (f2, m2) = found
        assert (f1 - f2) / (2 * h) == pytest.approx(-k[2, 3 + axis], rel=1e-5, abs=1e-4 * k[2, 2])
        np.testing.assert_allclose(
            (m1 - m2) / (2 * h), -k[[3, 4], 3 + axis], rtol=1e-5, atol=1e-4 * np.abs(k).max()
        )


def test_derivatives_equal_differences():
    m = moldloft.loads(WEDGE)
    cg = (2.7, 0.2, 0.4)
    asked = {"trim": 0.05, "heel": 0.2, "density": 2.0, "gravity": 3.0, "accuracy": 1e-9}
    exact = m.hydrostatics(by=["rise"], **asked).stiffness(cg, by="rise")

    def at(rise):
        m["rise"] = rise
        return m.hydrostatics(**asked).stiffness(cg)

    difference = (at(0.3 + 1e-4) - at(0.3 - 1e-4)) / 2e-4
    np.testing.assert_allclose(exact, difference, rtol=1e-5, atol=1e-5 * np.abs(exact).max())
    assert np.abs(exact).max() > 0


def test_beside_capytaine():
    cpt = pytest.importorskip("capytaine")
    m = moldloft.loads(WEDGE)
    cg = (2.7, 0.2, 0.4)
    state = m.hydrostatics(density=1025, gravity=9.81)
    sheets = re.sub(r"(Surf \w+\(\w+, \w+)\)", r"\1, divisions = {30, 30})", WEDGE)
    mesh = moldloft.loads(sheets).mesh()
    body = cpt.FloatingBody(
        mesh=cpt.Mesh(vertices=mesh.vertices, faces=mesh.faces).immersed_part(),
        dofs=cpt.rigid_body_dofs(rotation_center=cg),
        center_of_mass=cg,
    )
    theirs = body.compute_hydrostatic_stiffness(rho=1025, g=9.81).values
    ours = state.stiffness(cg, mass=1025 * float(body.volume))
    np.testing.assert_allclose(ours[2:, 2:5], theirs[2:, 2:5], rtol=2e-3, atol=2e-3 * ours[2, 2])


def test_what_has_no_stiffness():
    state = moldloft.loads(BARGE).hydrostatics(draft=1.0)
    with pytest.raises(moldloft.Error, match="needs the density"):
        state.stiffness((0, 0, 0))
    one = moldloft.loads(BARGE).hydrostatics(draft=1.0, density=1, sides="one")
    with pytest.raises(moldloft.Error, match="whole body"):
        one.stiffness((0, 0, 0))
    wet = moldloft.loads(BARGE).hydrostatics(draft=1.0, density=1)
    with pytest.raises(moldloft.Error, match="three finite numbers"):
        wet.stiffness((0, 0, math.nan))
    with pytest.raises(moldloft.UnknownNameError, match="no derivatives by `beam`"):
        wet.stiffness((0, 0, 0), by="beam")
    with pytest.raises(moldloft.FileError):
        wet.write_kh("no/such/folder", (0, 0, 0))


def test_the_command(cli, model_file):
    path = model_file(BARGE)
    asked = ["--draft", 1.3, "--cg=5,0,1", "--density", "salt"]
    found = json.loads(cli("hydro", path, *asked, "--stiffness", "--json", "--kh", ".").stdout)
    state = moldloft.loads(BARGE).hydrostatics(draft=1.3, density="salt")
    np.testing.assert_allclose(found["stiffness"], state.stiffness((5, 0, 1)), rtol=1e-12)
    np.testing.assert_allclose(np.loadtxt(path.parent / "KH.dat"), found["stiffness"], rtol=1e-6)
    text = cli("hydro", path, *asked, "--stiffness").stdout
    assert "stiffness about the centre of gravity" in text and "pitch" in text
    for more in (["--table", "1,2,3"], ["--units", "ft"]):
        assert (
            "of one attitude" in cli("hydro", path, *asked, "--stiffness", *more, status=1).stderr
        )
