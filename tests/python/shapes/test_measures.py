"""Measures of the shape: closed forms within the printed bounds, and the figures of a hull."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import moldloft
from boxes import box
from conftest import SAILBOAT

# The hull of Table 2, with its transom and a deck straight athwart.
DECKED = Path(SAILBOAT, "hull.sdl").read_text().split("XContours")[0] + (
    "YPlane centre(0); EdgeSnake sheer(4, hull); ProjCurve middle(sheer, centre);\n"
    "RuledSurf deck(sheer, middle, divisions = {20, 4});\n"
    "EdgeSnake back(3, hull); ProjCurve spine(back, centre);\n"
    "RuledSurf transom(back, spine, divisions = {10, 4});\n"
)

# z: volume, wetted area, lcb, vcb, waterplane area, lcf, transverse and longitudinal moment: an
# independent NumPy program in two orders of integration.
TABLE = {
    -0.5: (41.966654223, 122.23265276, 13.659945889, -0.730919960, 118.48102572, 14.74983699),
    -0.25: (75.921713075, 159.46294672, 14.399563526, -0.569434305, 152.06891156, 15.81270065),
    0.0: (117.453999868, 192.05333931, 15.073137006, -0.411078637, 179.19962223, 16.74642807),
    0.1: (135.846612851, 204.06330355, 15.322525073, -0.348594876, 188.52022001, 17.07675415),
    0.5: (215.952805244, 238.83527425, 16.088020689, -0.106820383, 208.43815411, 17.52576395),
    1.0: (323.047651209, 273.68753080, 16.574846234, 0.177880663, 218.70295213, 17.56171829),
}
NAMES = ("volume", "wetted_area", "lcb", "vcb", "waterplane_area", "lcf")
MOMENTS = {0.0: (895.6279812, 7415.017331), 0.5: (1226.1415636, 9967.550461)}


@pytest.fixture(scope="module")
def hull() -> moldloft.Model:
    return moldloft.loads(DECKED)


def test_the_first_figure_printed_is_that_of_the_shape(cli):
    done = cli("build", Path(SAILBOAT, "hull.sdl"))
    assert "volume 117.45 ft³" in done.stdout
    done = cli("build", Path(SAILBOAT, "hull.sdl"), "--quality")
    assert "panels against the shape: volume -1.43 %" in done.stdout


@pytest.mark.parametrize("level", TABLE)
@pytest.mark.parametrize("accuracy", [1e-4, 1e-6])
def test_the_figures_of_the_hull_within_their_bounds(hull, level, accuracy):
    found = hull.hydrostatics(level=level, accuracy=accuracy)
    for name, exact in zip(NAMES, TABLE[level], strict=True):
        off = abs(getattr(found, name) - exact)
        # Nine or ten digits of the reference.
        assert off <= found.bounds[name] + 2e-9 * abs(exact) + 1e-9, (name, off)
        assert found.bounds[name] <= accuracy * max(abs(exact), 30), name
    if level in MOMENTS:
        exact = MOMENTS[level]
        assert found.waterplane_it == pytest.approx(exact[0], rel=max(accuracy, 1e-9))
        assert found.waterplane_il == pytest.approx(exact[1], rel=max(accuracy, 1e-9))
    assert found.open_edges == 0 and found.waterplane_error < 1e-8


def test_lengths_and_coefficients_at_the_waterline(hull):
    found = hull.hydrostatics(accuracy=1e-9)
    expected = {
        "waterline_low_x": 1.78069889,
        "waterline_high_x": 29.16690854,
        "waterline_length": 27.38620965,
        "waterline_beam": 9.17429864,
        "draft": 1.21509060,
        "midship_area": 7.250252319,
        "cb": 0.38472849,
        "cm": 0.65038660,
        "cp": 0.59153815,
        "cwp": 0.71323441,
        "bmt": 7.62535105,
        "bml": 63.1312458,
        "kb": 0.80401196,
        "kmt": 8.42936301,
    }
    for name, exact in expected.items():
        assert getattr(found, name) == pytest.approx(exact, rel=2e-8), name


# heel, trim in degrees, level: volume, centre of buoyancy, waterplane area, wetted area.
TURNED = {
    (10, 0, 0): (130.222854657, (15.587283214, 1.178358015, -0.268185023), 172.96089622, 190.55701),
    (20, 0, 0): (162.155892572, (16.366341174, 1.880339700, 0.036020340), 165.39736565, 193.85206),
    (30, 0, 0): (205.404060330, (16.914222944, 2.248807837, 0.385475896), 159.0038285, 209.25392),
    (0, 1, 0): (176.256815276, (16.714525768, 0, -0.213593387), 203.09707849, 224.45898),
    (0, -1, 0): (73.378948685, (13.236159086, 0, -0.570783967), 139.63384418, 148.27941),
    (15, 1, 0.2): (236.363975171, (17.112277723, 1.313718471, 0.125752335), 197.38663622, 237.1011),
    (60, 0, 0.5): (349.359071666, (16.787717428, 1.926300069, 0.882719176), 111.171628, 307.26658),
    (90, 0, 0): (347.690084789, (16.737864436, 1.988000928, 1.070801723), 104.448961, 311.01873),
}


@pytest.mark.parametrize("attitude", TURNED)
def test_heeled_and_trimmed(hull, attitude):
    heel, trim, level = attitude
    volume, centre, plane, area = TURNED[attitude]
    found = hull.hydrostatics(
        level=level, heel=math.radians(heel), trim=math.radians(trim), accuracy=1e-8
    )
    assert found.volume == pytest.approx(volume, rel=1e-8)
    assert (found.lcb, found.tcb, found.vcb) == pytest.approx(centre, abs=1e-7)
    assert found.waterplane_area == pytest.approx(plane, rel=2e-8)
    assert found.wetted_area == pytest.approx(area, rel=1e-7)


def test_righting_arms_with_free_trim(hull):
    exact = {10: 0.946689234, 20: 1.474187799, 40: 1.785045732, 60: 1.414431771, 90: 0.202115397}
    stability = hull.stability(117.45399986762, cg=(15.073137006, 0, 1.0), density=1)
    for heel, arm in exact.items():
        assert stability.gz(math.radians(heel)) == pytest.approx(arm, abs=2e-8), heel
    assert stability.gmt == pytest.approx(6.21427241, abs=1e-7)
    heel, largest = stability.largest()
    assert (math.degrees(heel), largest) == pytest.approx((38.949180, 1.7861857), abs=1e-5)
    assert math.degrees(stability.vanishing()) == pytest.approx(94.4211764, abs=1e-5)
    # The area is a difference of energies.
    assert stability.area(0, math.radians(30)) == pytest.approx(0.5861274096, abs=1e-8)


def test_angles_of_openings(hull):
    places = {"hatch": (10, 2, 2.9), "vent": (20, 2.5, 2.9)}
    stability = hull.stability(
        117.45399986762, cg=(15.073137006, 0, 1.0), density=1, openings=places
    )
    angle, name = stability.flooding()
    assert name == "hatch" and math.degrees(angle) == pytest.approx(85.28844, abs=1e-4)
    central = moldloft.hydro.stability.Opening("middle", (20, 1, 3))
    assert stability.immersed(central, math.radians(120)) is None


def test_derivatives_by_the_beam(hull):
    found = hull.hydrostatics(by=["beam"], accuracy=1e-9).derivatives
    # dV, dI: both ways in the reference.
    expected = {"volume": 11.714063486, "waterplane_it": 265.38368}
    for name, exact in expected.items():
        assert found[name]["beam"] == pytest.approx(exact, rel=1e-7), name
    # By central differences of 1e-11 with steps of 0.01 and 0.001.
    assert found["waterplane_area"]["beam"] == pytest.approx(17.7980255, rel=1e-8)
    assert found["wetted_area"]["beam"] == pytest.approx(17.0585600, rel=1e-7)


def test_bonjean_curves(hull):
    stations, levels = [5, 15, 25], [-0.75, -0.5, -0.25, 0, 0.25, 0.5, 1.0]
    exact = [
        [0.29019878, 0.83339899, 1.52655367, 2.31198821, 3.15887956, 4.05436691, 5.96406636],
        [1.45793867, 3.13145296, 5.11292066, 7.27004101, 9.52682827, 11.84947945, 16.61626199],
        [0, 0.00431967, 0.82739910, 2.38653113, 4.29128478, 6.36682347, 10.76120241],
    ]
    assert hull.section_areas(stations, levels) == pytest.approx(np.array(exact), abs=2e-8)


def sphere(divisions: str) -> str:
    return (
        "AbsPoint a(0, 0, -1.5); AbsPoint b(1.5, 0, 0); AbsPoint c(0, 0, 1.5);\n"
        "Arc half(a, b, c); Line axis(a, c);\n"
        f"RevSurf ball(half, axis, orientation = 1, divisions = {divisions});\n"
    )


@pytest.mark.parametrize("divisions", ["{3, 4}", "{40, 80}"])
@pytest.mark.parametrize("height", [0.1, 0.75, 1.5, 2.2])
def test_a_sphere_at_any_panelling(divisions, height):
    ball = moldloft.loads(sphere(divisions))
    r, h = 1.5, height
    found = ball.hydrostatics(level=h - r, heel=0.3, trim=-0.2)
    exact = {
        "volume": math.pi * h**2 * (3 * r - h) / 3,
        "wetted_area": 2 * math.pi * r * h,
        "waterplane_area": math.pi * h * (2 * r - h),
        "waterplane_it": math.pi / 4 * (h * (2 * r - h)) ** 2,
    }
    for name, value in exact.items():
        off = abs(getattr(found, name) - value)
        assert off <= found.bounds[name] + 1e-12 * value, name
        # Of small draughts the bound is relative to the half immersed body.
        assert found.bounds[name] <= 1e-5 * max(value, 3), name
    assert ball.eval("ball.area") == pytest.approx(4 * math.pi * r**2, rel=1e-6)
    assert ball.eval("ball.volume") == pytest.approx(4 / 3 * math.pi * r**3, rel=1e-6)


def test_areas_are_those_of_the_surface():
    text = (
        "AbsPoint a(1, 0, 0); AbsPoint b(1, 0, 2); AbsPoint c(0, 0, 0); AbsPoint d(0, 0, 2);\n"
        "Line g(a, b); Line axis(c, d); RevSurf s(g, axis);\n"
        "float skin = s.area;\n"
    )
    model = moldloft.loads(text)
    assert model.eval("s.area") == pytest.approx(4 * math.pi, rel=1e-7)
    assert model.eval("s.centroid") == pytest.approx((0, 0, 1), abs=1e-7)
    with pytest.raises(moldloft.ModelError, match="encloses no volume"):
        model.eval("s.volume")


def test_a_wigley_hull():
    # y = B/2 (1 - (2x/L)^2) (1 - (z/T)^2), L 10, B 1, T 0.625: a Bezier patch of degree 2 x 2.
    rows = []
    for i, (x, p) in enumerate([(-5, 0.0), (0, 2.0), (5, 0.0)]):
        for j, (z, q) in enumerate([(0.0, 1.0), (-0.3125, 1.0), (-0.625, 0.0)]):
            rows.append(f"AbsPoint p{i}{j}({x}, {0.5 * p * q}, {z});")
    names = ", ".join(f"p{i}{j}" for i in range(3) for j in range(3))
    text = 'Model info(symmetry = "y");\n' + "\n".join(rows)
    text += f"\nBSurf hull({{{names}}}, nu = 3, nv = 3, degree_u = 2, degree_v = 2);\n"
    found = moldloft.loads(text).hydrostatics()
    exact = {
        "volume": 25 / 9,
        "wetted_area": 14.8790631050,
        "cb": 4 / 9,
        "cp": 2 / 3,
        "cm": 2 / 3,
        "cwp": 2 / 3,
        "kb": 5 * 0.625 / 8,
        "bmt": 3 / (35 * 0.625),
        "bml": 12.0,
    }
    for name, value in exact.items():
        assert getattr(found, name) == pytest.approx(value, rel=2e-7), name


def test_numbers_of_the_model_in_its_program():
    text = DECKED + (
        "float v = hydrostatics.volume; float panels = mesh.volume;\n"
        "AbsPoint at(hydrostatics.lcb, 0, hydrostatics.vcb);\n"
    )
    model = moldloft.loads(text)
    assert model.eval("v") == pytest.approx(117.453999868, rel=1e-7)
    assert model.eval("at.x") == pytest.approx(15.073137006, rel=1e-7)
    model["beam"] = 10.5
    same = moldloft.loads(text.replace("beam = 10.0568 in", "beam = 10.5 in"))
    assert model.eval("v") == pytest.approx(same.eval("v"), rel=1e-14)
    assert model.derivative("at.x", "beam") == pytest.approx(
        model.hydrostatics(by=["beam"]).derivatives["lcb"]["beam"], rel=1e-9
    )


def test_a_solve_set_for_the_displacement():
    model = moldloft.loads(DECKED + "SolveSet s({beam}, {hydrostatics.volume - 110});\n")
    assert model.hydrostatics().volume == pytest.approx(110, rel=1e-9)
    # dV/dbeam at the solution.
    slope = model.hydrostatics(by=["P24.z"]).derivatives["volume"]["P24.z"]
    assert slope == pytest.approx(0, abs=1e-7)


def test_a_model_that_shows_both_sides_is_refused(cli, tmp_path):
    text = Path(SAILBOAT, "hull.sdl").read_text() + 'MirrSurf other(hull, "y=0");\n'
    path = tmp_path / "double.sdl"
    path.write_text(text)
    done = cli("check", path, status=1)
    assert "would count twice" in done.stdout + done.stderr
    both = text.replace('Model info(symmetry = "y", units = "ft");', "")
    assert moldloft.loads(both).hydrostatics().volume == pytest.approx(117.453999868, rel=1e-6)
    across = DECKED + "AbsPoint k(1, -1, -2); AbsPoint l(2, -1, -2); AbsPoint n(1, -1, -1);\n"
    across += "AbsPoint o(2, -1, -1); Line kl(k, l); Line no(n, o); RuledSurf fin(kl, no);\n"
    with pytest.raises(moldloft.ModelError, match="shows both sides"):
        moldloft.loads(across).hydrostatics()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ({"accuracy": 0.0}, "accuracy"),
        ({"density": "syrup"}, "unknown water"),
        ({"density": 0.0}, "positive"),
        ({"density": -1.0}, "positive"),
        ({"level": math.inf}, "finite"),
    ],
)
def test_bad_requests(hull, call, words):
    with pytest.raises(moldloft.Error, match=words):
        hull.hydrostatics(**call)


@pytest.mark.parametrize("count", [1, 4])
def test_bounds_of_boxes_include_the_rounding_of_coordinates(count):
    # Decimals, of which the products are exact in fractions; the union of those in a row.
    rng = np.random.default_rng(count)
    for _ in range(20):
        low = [
            Fraction(round(float(x), 3)) for x in rng.uniform(-1, 1, 3) * 10 ** rng.uniform(-1, 3)
        ]
        start, volume, text = low[0], Fraction(0), []
        for k in range(count):
            size = [Fraction(str(round(float(x), 2))) for x in rng.uniform(0.1, 5, 3)]
            corner = [start, *low[1:]]
            text.append(box(k, [float(x) for x in corner], [float(x) for x in size]))
            volume += math.prod(size)
            start += size[0]
        body = moldloft.loads("\n".join(text))
        found = (body.united() if count > 1 else body).hydrostatics(level=float(low[2]) + 6)
        off = abs(Fraction(found.volume) - volume)
        assert off <= found.bounds["volume"] <= 1e-9 * (1 + abs(float(low[0])))
