"""A model afloat: closed forms, symmetric models, derivatives, and what cannot float."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest

import moldloft
from conftest import SAILBOAT

# An open box barge, half of it (y >= 0), its keel at z = 0.
BARGE = """
Model info(symmetry = "y", units = "m");
param float length = 12 in [6, 20];
param float beam = 4 in [2, 8];
param float height = 3 in [1, 5];
AbsPoint a(0, 0, 0); AbsPoint b(length, 0, 0);
AbsPoint c(0, beam/2, 0); AbsPoint d(length, beam/2, 0);
AbsPoint e(0, 0, height); AbsPoint f(length, 0, height);
AbsPoint g(0, beam/2, height); AbsPoint h(length, beam/2, height);
BCurve fore({a, c, g}, degree = 1); BCurve aft({b, d, h}, degree = 1);
Line stem(a, e); Line post(b, f);
RuledSurf hull(fore, aft, divisions = {6, 6});
RuledSurf bow(fore, stem, divisions = {6, 3}, orientation = 1);
RuledSurf stern(aft, post, divisions = {6, 3});
"""

# A cone with its tip down, of 48 sides, and a cylinder.
CONE = """
AbsPoint tip(0, 0, 0); AbsPoint rim(2, 0, 4); AbsPoint top(0, 0, 4);
Line side(tip, rim); Line axis(tip, top);
RevSurf cone(side, axis, divisions = {8, 48}, orientation = 1);
"""
CYLINDER = """
AbsPoint low(0, 0, 0); AbsPoint edge(1, 0, 0); AbsPoint rim(1, 0, 3); AbsPoint high(0, 0, 3);
Line axis(low, high);
BCurve profile({low, edge, rim}, degree = 1);
RevSurf cylinder(profile, axis, divisions = {8, 96}, orientation = 1);
"""
L, B, H, T = 12.0, 4.0, 3.0, 1.3
KG = 1.1


@pytest.fixture
def barge() -> moldloft.Model:
    return moldloft.loads(BARGE)


def test_a_barge_by_closed_forms(barge):
    afloat = barge.hydrostatics(draft=T, cg=(6, 0, KG), density=1.025)
    mass = 1.025 * L * B * T
    gmt, gml = T / 2 + B**2 / (12 * T) - KG, T / 2 + L**2 / (12 * T) - KG
    expected = {
        "volume": L * B * T,
        "displacement": mass,
        "weight": mass * 9.80665,
        "lcb": 6,
        "vcb": T / 2,
        "lcf": 6,
        "bmt": B**2 / (12 * T),
        "bml": L**2 / (12 * T),
        "kmt": T / 2 + B**2 / (12 * T),
        "gmt": gmt,
        "gml": gml,
        "tpc": 1.025 * L * B / 100,
        "mtc": mass * gml / (100 * L),
        "cb": 1,
        "cp": 1,
        "cm": 1,
        "cwp": 1,
        "freeboard": H - T,
        "draft_mid": T,
    }
    for name, value in expected.items():
        assert getattr(afloat, name) == pytest.approx(value, rel=1e-12), name
    assert (afloat.sides, afloat.status, afloat.floods) == ("both", "given", False)


def test_a_wall_sided_righting_curve(barge):
    heels = np.radians([-20, -5, 0, 10, 25])
    curve = barge.righting_curve(heels, L * B * T, cg=(6, 0, KG), density=1)
    bm = B**2 / (12 * T)
    gm = T / 2 + bm - KG
    expected = (gm + bm * np.tan(heels) ** 2 / 2) * np.sin(heels)
    np.testing.assert_allclose(curve.gz, expected, atol=1e-12)
    assert all(row.status == "converged" for row in curve)
    assert not curve.floods
    np.testing.assert_allclose(curve.column("displacement"), L * B * T, rtol=1e-12)
    area = curve.area(0, heels[-1])
    assert 0 < area < heels[-1] * expected[-1]


def test_where_the_water_enters_no_figure_is_given(barge, cli, model_file):
    curve = barge.righting_curve(np.radians([0, 30, 60]), L * B * T, cg=(6, 0, KG), density=1)
    assert [row.floods for row in curve] == [False, False, True]
    assert np.isfinite(curve.gz).tolist() == [True, True, False]
    assert math.isnan(curve.rows[2].volume) and curve.rows[2].freeboard < 0
    path = model_file(BARGE)
    mass = ["--displacement", L * B * T, f"--cg=6,0,{KG}", "--density", 1]
    done = cli("hydro", path, *mass, "--gz", "0,60,7", "--json")
    assert "open edge below the waterline" in done.stderr
    rows = json.loads(done.stdout)
    assert len(rows) == 7 and rows[-1]["freeboard"] < 0 and rows[-1]["gz"] is None
    table = barge.hydrostatic_table([T, H + 0.5])
    assert np.isfinite(table.column("volume")).tolist() == [True, False]
    with pytest.raises(moldloft.ModelError, match="open below the water"):
        barge.hydrostatics(draft=H + 0.5)
    draft = 1.6
    s = barge.stability(L * B * draft, cg=(6, 0, KG), density=1)
    edge = s.deck_edge()
    # The sheer comes down on one side as B / 2 tan(heel), in a box that keeps its draft.
    assert edge == pytest.approx(math.atan(2 * (H - draft) / B), rel=1e-9)
    assert s.flooding() == (edge, "open edge") and s.vanishing() is None
    assert s.range() == pytest.approx(edge) and s.largest()[0] <= edge
    assert math.isnan(s.area(0, edge + 0.1)) and math.isfinite(s.area(0, edge))
    assert "none before the open edge is immersed" in s.summary()
    assert "the water enters over the open edge" in s.summary()


def test_a_rim_at_the_level_of_the_water_is_dry(barge):
    for draft in (H, H * (1 + 1e-12), H * (1 - 1e-12)):
        afloat = barge.hydrostatics(draft=draft)
        assert afloat.freeboard == 0 and not afloat.floods and not afloat.remarks
        assert afloat.volume == pytest.approx(L * B * H, rel=1e-9)


BOTTOMLESS = """Model info(symmetry = "y", units = "m");
AbsPoint a(0,0,0.3); AbsPoint b(4,0,0.3); AbsPoint c(0,0,-0.5); AbsPoint d(4,0,-0.5);
AbsPoint e(2,0.8,0.3); AbsPoint f(2,0.8,-0.5);
BCurve u({a,e,b}, degree = 2); BCurve l({c,f,d}, degree = 2);
RuledSurf side(u, l, divisions = {40, 10});
"""


def test_a_hull_without_a_bottom_has_no_figures(cli, model_file):
    model = moldloft.loads(BOTTOMLESS)
    asked = [
        model.hydrostatics,
        lambda: model.hydrostatics(draft=0.2),
        lambda: model.eval("hydrostatics.volume"),
        lambda: model.derivatives(["hydrostatics.volume"], by=["a.z"]),
        lambda: moldloft.loads(BOTTOMLESS + "float v = hydrostatics.volume;"),
    ]
    for ask in asked:
        with pytest.raises(moldloft.ModelError, match=r"(?s)open below the water.*`side`"):
            ask()
    with pytest.raises(moldloft.ModelError, match="immersed open edge"):
        model.righting_curve([0.1, 0.2], 0.5, cg=(2, 0, 0), density=1)
    model.partial = True
    state = model.hydrostatics()
    assert state.partial and state.open_edges == 1 and state.bounds == {}
    assert "not those of a body" in " ".join(state.remarks)
    path = model_file(BOTTOMLESS)
    assert "open below the water" in cli("hydro", path, status=1).stderr
    assert "not those of a body" in cli("hydro", path, "--keep-going").stdout
    assert "no hydrostatics" in cli("build", path).stdout
    closed = "BCurve m({c, d}, degree = 1); RuledSurf bottom(l, m, divisions = {40, 10});\n"
    whole = moldloft.loads(BOTTOMLESS + closed)
    # Both sides: twice the height times the parabola's area, 2/3 of 4 by 0.4.
    assert whole.hydrostatics().volume == pytest.approx(0.5 * 2 * 2 / 3 * 4 * 0.4, rel=1e-9)


def test_a_cone_by_closed_forms():
    model = moldloft.loads(CONE)
    # The cone itself, not the pyramid of its panels; radius = draft / 2.
    draft = 3.0
    afloat = model.hydrostatics(draft=draft)
    radius = draft / 2
    assert afloat.volume == pytest.approx(math.pi * radius**2 * draft / 3, rel=1e-8)
    assert afloat.vcb == pytest.approx(0.75 * draft, rel=1e-8)
    # BM = I / V = 3 r^2 / (4 T) for the circle.
    assert afloat.bmt == pytest.approx(3 * radius**2 / (4 * draft), rel=1e-7)
    rest = model.equilibrium(afloat.volume, cg=(0, 0, 2.0), free=["trim", "heel"], density=1)
    assert rest.draft_mid == pytest.approx(draft, rel=1e-8)
    assert rest.status == "converged" and rest.stable is True


def test_a_cylinder_by_closed_forms():
    model = moldloft.loads(CYLINDER)
    draft = 1.2
    rest = model.equilibrium(math.pi * draft * 1.025, density=1.025)
    assert rest.draft == pytest.approx(draft, rel=1e-8)
    assert rest.bmt == pytest.approx(1 / (4 * draft), rel=1e-7)
    assert rest.cm == pytest.approx(1, rel=1e-8)


def test_equilibrium_with_a_weight_off_the_middle(barge):
    rest = barge.equilibrium(L * B * T, cg=(6.4, 0.1, KG), density=1)
    assert rest.status == "converged" and rest.stable and rest.iterations < 15
    assert rest.trim > 0 and rest.heel > 0
    assert abs(rest.gz) < 1e-12 and abs(rest.trim_arm) < 1e-12
    upright = barge.equilibrium(L * B * T, cg=(6.4, 0, KG), density=1)
    assert upright.heel == 0 and upright.trim > 0, "a symmetric model stays upright"
    both = barge.equilibrium(L * B * T, cg=(6.4, 0, KG), free=["trim", "heel"], density=1)
    assert both.trim == pytest.approx(upright.trim, rel=1e-10)


def test_a_quarter_counts_four_times():
    text = BARGE.replace('"y"', '"xy"')
    whole, quarter = moldloft.loads(BARGE), moldloft.loads(text)
    quarter["length"] = 6
    afloat = quarter.hydrostatics(draft=T)
    assert afloat.volume == pytest.approx(whole.hydrostatics(draft=T).volume, rel=1e-12)
    assert afloat.lcb == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("model", ["barge", "yacht"])
def test_derivatives_equal_central_differences(model):
    if model == "barge":
        m, by, base = moldloft.loads(BARGE), "beam", 4.0
        mass, cg = L * B * T, (6.3, 0.05, KG)
    else:
        m = moldloft.load(SAILBOAT / "hull.sdl")
        (by, param), *_ = m.params.items()
        base = param.value
        at = m.hydrostatics()
        mass, cg = 0.8 * at.volume, (at.lcb + 0.2, 0.05, at.vcb + 0.5)
    heels = [0.1, 0.3]
    options = {"density": 1, "accuracy": 1e-9}
    rest = m.equilibrium(mass, cg=cg, by=[by], **options)
    curve = m.righting_curve(heels, mass, cg=cg, by=[by], **options)
    h = 1e-5 * base

    def at(value: float) -> tuple[moldloft.Hydrostatics, np.ndarray]:
        m[by] = value
        arms = m.righting_curve(heels, mass, cg=cg, **options).gz
        return m.equilibrium(mass, cg=cg, **options), arms

    (up, gz_up), (down, gz_down) = at(base + h), at(base - h)
    for name in ["level", "trim", "heel", "lcb", "vcb", "gmt", "gml", "wetted_area", "tpc", "mtc"]:
        difference = (getattr(up, name) - getattr(down, name)) / (2 * h)
        slope = rest.derivatives[name][by]
        assert slope == pytest.approx(difference, rel=2e-5, abs=1e-6), name
    difference = (gz_up - gz_down) / (2 * h)
    np.testing.assert_allclose(curve.derivative("gz", by), difference, rtol=2e-5, atol=1e-7)


def test_tables_as_csv_and_plot(barge, tmp_path):
    table = barge.hydrostatic_table(np.linspace(0.5, 2.5, 5), cg=(6, 0, KG), by=["length"])
    np.testing.assert_allclose(table.column("volume"), L * B * table.column("draft"))
    np.testing.assert_allclose(table.derivative("volume", "length"), B * table.column("draft"))
    path = table.write_csv(tmp_path / "table.csv")
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert len(rows) == 5 and float(rows[0]["kmt [m]"]) == table.rows[0].kmt
    assert b"<svg" in table.plot(tmp_path / "table.svg").read_bytes()
    curve = barge.righting_curve(np.radians([0, 20, 70]), L * B * T, cg=(6, 0, KG), density=1)
    assert curve.plot(tmp_path / "gz.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(moldloft.Error, match="no plot ends in"):
        curve.plot(tmp_path / "gz.dwg")
    with pytest.raises(moldloft.Error, match="unknown figure"):
        table.csv(["gmx"])


def test_what_cannot_float(barge):
    with pytest.raises(moldloft.ModelError, match="exceeds"):
        barge.equilibrium(1000, density=1)
    with pytest.raises(moldloft.ModelError, match="not a positive number"):
        barge.equilibrium(-1, density=1)
    with pytest.raises(moldloft.ModelError, match="centre of gravity"):
        barge.equilibrium(50, free=["trim"], density=1)
    with pytest.raises(moldloft.ModelError, match="half a body cannot heel"):
        barge.equilibrium(20, cg=(6, 0, 1), free=["heel"], sides="one", density=1)
    with pytest.raises(moldloft.Error, match="not both"):
        barge.hydrostatics(level=1, draft=1)
    with pytest.raises(moldloft.Error, match="finite"):
        barge.hydrostatics(draft=math.nan)
    with pytest.raises(moldloft.Error, match="free are"):
        barge.equilibrium(50, cg=(6, 0, 1), free=["sway"])
    plate = moldloft.loads(
        "AbsPoint a(0,0,0); AbsPoint b(1,0,0); AbsPoint c(0,1,0); AbsPoint d(1,1,0);"
        "Line ab(a, b); Line cd(c, d); RuledSurf plate(ab, cd);"
    )
    with pytest.raises(moldloft.ModelError, match="enclose no body"):
        plate.equilibrium(1, density=1)


def test_on_the_command_line(cli, model_file, tmp_path):
    path = model_file(BARGE)
    done = cli("hydro", path, "--draft", 1.3, "--cg=6,0,1.1", "--by", "beam")
    assert "gmt" in done.stdout and "d/dbeam" in done.stdout
    done = cli("hydro", path, "--displacement", 62.4, "--cg=6.2,0.1,1.1", "--density", 1, "--json")
    assert json.loads(done.stdout)["status"] == "converged"
    done = cli("hydro", path, "--table", "0.5,2.5,5", "--csv", "t.csv", "--plot", "t.svg")
    assert done.stdout.splitlines()[0].split()[:4] == ["draft", "[m]", "lcb", "[m]"]
    assert (tmp_path / "t.csv").exists() and (tmp_path / "t.svg").exists()
    done = cli("hydro", path, "--displacement", 62.4, "--cg=6,0,1.1", "--density", 1, "--gz=0,25,6")
    assert "largest arm" in done.stdout
    cli("hydro", path, "--gz=0,25,6", status=1)
    cli("hydro", path, "--displacement", 1e9, status=1)
    cli("hydro", path, "--table", "0.5,2.5,1", status=2)
    cli("hydro", path, "--cg", "1,2", status=2)


@pytest.mark.parametrize(
    ("units", "kilograms", "newtons", "metres"),
    [
        ("m kg", 1.0, 1.0, 1.0),
        ("m t", 1000.0, 1.0, 1.0),
        ("m t kN", 1000.0, 1000.0, 1.0),
        ("cm kg", 1.0, 1.0, 0.01),
        ("ft lb", 0.45359237, 4.4482216152605, 0.3048),
        ("ft lb kN", 0.45359237, 1000.0, 0.3048),
    ],
)
def test_righting_moments_are_in_the_unit_that_is_stated(
    units: str, kilograms: float, newtons: float, metres: float
) -> None:
    """Displacement times standard gravity times the arm, by SI."""
    from moldloft.starter import BOX

    m = moldloft.loads(f'Model info(units = "{units}");\n{BOX}')
    mass = 0.8 * m.hydrostatics(density="salt").displacement
    row = m.righting_curve([0.1], mass, cg=(0, 0, 0.2), density="salt").rows[0]
    moment = mass * kilograms * 9.80665 * row.gz * metres
    assert row.righting_moment * newtons * metres == pytest.approx(moment, rel=1e-9)


def test_a_figure_below_the_requested_accuracy_has_a_remark(barge):
    state = barge.hydrostatics(level=T)
    assert state.remarks == [] and state.accuracy == 1e-6
    assert max(state.bounds[name] for name in ("volume", "waterplane_area")) < 1e-6
    worse = replace(state, bounds={**state.bounds, "volume": 3e-5 * state.volume}, open_edges=2)
    assert worse.remarks == [
        "2 open edges of the skin below the water, which enters there: the figures are not "
        "those of a body",
        "volume: relative accuracy 3e-05; requested: 1e-06",
    ]
    assert "relative accuracy 3e-05" in worse._repr_html_()


def test_wetted_areas_of_parts_add_up() -> None:
    # A half box with a plate keel: closed forms upright, and the whole skin when heeled.
    m = moldloft.loads("""
Model info(symmetry = "y", units = "m t");
AbsPoint a(0, 0, -2); AbsPoint b(6, 0, -2); AbsPoint c(0, 1, -2); AbsPoint d(6, 1, -2);
AbsPoint e(0, 1, 1); AbsPoint f(6, 1, 1); AbsPoint g(0, 0, 1); AbsPoint h(6, 0, 1);
Line ab(a, b); Line cd(c, d); Line ef(e, f); Line gh(g, h);
RuledSurf bottom(ab, cd, tags = {"flat", "hull"}); RuledSurf wall(cd, ef, tags = "hull");
Line ac(a, c); Line ge(g, e); RuledSurf aft(ac, ge); Line bd(b, d); Line hf(h, f);
RuledSurf fore(bd, hf); RuledSurf deck(gh, ef);
""")
    assert m.wetted_areas() == pytest.approx(
        {"bottom": 12, "wall": 24, "aft": 4, "fore": 4, "deck": 0}, abs=1e-9
    )
    assert m.wetted_areas(by="tag") == pytest.approx({"flat": 12, "hull": 36})
    assert sum(m.wetted_areas(sides="one").values()) == pytest.approx(22)
    for level, trim, heel in [(0.2, 0.03, 0.0), (0.1, 0.02, 0.3), (-0.4, -0.1, -0.5)]:
        place = {"level": level, "trim": trim, "heel": heel}
        whole = m.hydrostatics(**place).wetted_area
        assert sum(m.wetted_areas(**place).values()) == pytest.approx(whole, rel=1e-6)
    with pytest.raises(moldloft.errors.Error, match="heel alone"):
        m.wetted_areas(heel=0.1, sides="one")
    with pytest.raises(moldloft.errors.Error, match="object"):
        m.wetted_areas(by="colour")
