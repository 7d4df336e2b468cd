"""The gallery: every model builds; its figures are closed forms or those of other sums."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np
import pytest

import moldloft

GALLERY = Path(__file__).resolve().parents[3] / "examples" / "gallery"
NAMES = sorted(path.stem for path in GALLERY.glob("*.sdl"))
SETS = {name for name in NAMES if "SetBody" in (GALLERY / f"{name}.sdl").read_text()}
SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))


def model(name: str) -> moldloft.Model:
    return moldloft.load(GALLERY / f"{name}.sdl")


def test_there_are_models_for_every_trade() -> None:
    assert len(NAMES) >= 20


#: Bodies of sets take seconds each: in the ordinary run one of them stands for all.
QUICK = [n for n in NAMES if SOAK or n not in SETS or n == "swath"]


@pytest.mark.parametrize("name", QUICK)
def test_a_model_is_short_and_has_parameters(name: str) -> None:
    text = (GALLERY / f"{name}.sdl").read_text(encoding="utf-8")
    assert text.startswith("# ") and text.count("\n") < 150
    m = model(name)
    assert not [d for d in m.diagnostics if d.is_error]
    assert len(m.params) >= 3
    assert all(p.low <= p.default <= p.high for p in m.params.values())
    page = (GALLERY.parents[1] / "docs" / "gallery.md").read_text(encoding="utf-8")
    for p in m.params.values():
        assert f"| `{p.name}` | {p.default:g} | {p.low:g} to {p.high:g} |" in page


@pytest.mark.parametrize(
    "name", [n for n in NAMES if n not in SETS and (SOAK or n not in ("spar", "ducted_fan"))]
)
def test_panels_stay_connected_at_the_ends_of_all_ranges(name: str) -> None:
    m = model(name)
    faces = m.mesh().faces.copy()
    for end in ("low", "high"):
        for p in list(m.params.values()):
            before = m[p.name]
            m[p.name] = getattr(p, end)
            assert not m.has_errors, (name, p.name, end)
            np.testing.assert_array_equal(m.mesh().faces, faces)
            m[p.name] = before
    assert not [d for d in m.junctions() if d.is_error]


@pytest.mark.soak
@pytest.mark.skipif(not SOAK, reason="MOLDLOFT_SOAK=1")
@pytest.mark.parametrize("name", sorted(SETS))
def test_bodies_of_sets_are_closed(name: str) -> None:
    assert model(name).mesh().closed


@pytest.mark.soak
@pytest.mark.skipif(not SOAK, reason="MOLDLOFT_SOAK=1")
def test_spar() -> None:
    m = model("spar")
    for radius in (4.7, 5.5):
        m["radius"] = radius
        tank, height, taper, draft = (m[n] for n in ("tank", "tank_height", "taper", "draft"))
        cone = math.pi * taper / 3 * (tank**2 + tank * radius + radius**2)
        rest = math.pi * radius**2 * (draft - height - taper)
        h = m.hydrostatics(by=["radius"])
        assert h.volume == pytest.approx(math.pi * tank**2 * height + cone + rest, rel=1e-9)
        slope = math.pi * (taper / 3 * (tank + 2 * radius) + 2 * radius * (draft - height - taper))
        assert h.derivatives["volume"]["radius"] == pytest.approx(slope, rel=1e-7)
        assert h.waterplane_area == pytest.approx(math.pi * radius**2, rel=1e-9)


def test_the_spar_floats_upright_at_its_draft() -> None:
    m = model("spar")
    for radius in (4.7, 5.5):
        m["radius"] = radius
        found = m.equilibrium(density="salt")
        assert found.status == "converged"
        assert found.level == pytest.approx(0, abs=1e-6)
        assert found.heel == pytest.approx(0, abs=1e-9)
        assert found.trim == pytest.approx(0, abs=1e-9)
        assert found.gmt > 1 and found.stable


@pytest.mark.parametrize("changed", [{}, {"centre": 9, "draft": 24}, {"diameter": 15, "height": 6}])
def test_semisubmersible(changed: dict[str, float]) -> None:
    m = model("semisubmersible")
    for name, value in changed.items():
        m[name] = value
    spacing, height, draft = (m[n] for n in ("spacing", "height", "draft"))
    r, c = m["diameter"] / 2, m["centre"] / 2
    # A sixth of the pontoons: a trapezium from the middle to the column, and a quarter of a disc.
    pontoons = 6 * (r * (2 * spacing - r / math.sqrt(3)) / 2 + math.pi * r**2 / 4)
    columns = math.pi * (3 * r**2 + c**2)
    inertia = math.pi * (3 * r**4 + c**4) / 4 + 1.5 * math.pi * r**2 * spacing**2
    h = m.hydrostatics(by=["spacing"])
    assert not h.remarks and not h.floods and h.freeboard is None
    assert h.volume == pytest.approx(pontoons * height + columns * (draft - height), rel=1e-12)
    assert h.waterplane_area == pytest.approx(columns, rel=1e-9)
    assert h.waterplane_it == pytest.approx(inertia, rel=1e-8)
    assert h.waterplane_il == pytest.approx(inertia, rel=1e-8)
    assert abs(h.lcb) < 1e-9 * spacing
    assert h.derivatives["volume"]["spacing"] == pytest.approx(6 * r * height, rel=1e-9)
    # Columns are wall-sided: the righting arm is a closed form.
    heel, centre = math.radians(5), -2.0
    bm = inertia / h.volume
    arm = math.sin(heel) * (h.vcb + bm - centre + bm / 2 * math.tan(heel) ** 2)
    curve = m.righting_curve([heel], h.volume, cg=(0, 0, centre), density=1)
    assert curve.gz[0] == pytest.approx(arm, rel=1e-8)
    if not changed:
        # 20 206 m3 are published.
        assert round(h.volume) == 20206


@pytest.mark.soak
@pytest.mark.skipif(not SOAK, reason="MOLDLOFT_SOAK=1")
def test_the_semisubmersible_heaves_as_published() -> None:
    """A period of 20.4 s, with the published mass of 20 093 t."""
    capytaine = pytest.importorskip("capytaine")
    m = model("semisubmersible")
    body = m.to_capytaine(dofs=False)
    body.add_translation_dof(name="Heave")
    problem = capytaine.RadiationProblem(
        body=body, radiating_dof="Heave", omega=0.3, water_depth=math.inf, rho=1025, g=9.81
    )
    added = float(capytaine.BEMSolver().solve(problem).added_masses["Heave"])
    stiffness = 1025 * 9.81 * m.hydrostatics().waterplane_area
    assert 2 * math.pi * math.sqrt((20_093e3 + added) / stiffness) == pytest.approx(20.4, abs=0.1)


def test_caisson() -> None:
    m = model("caisson")
    for length in (24, 30):
        m["length"] = length
        assert m.eval("volume(caisson)") == pytest.approx(m.eval("concrete"), rel=1e-9)


def test_bottle_holds_what_its_profile_holds() -> None:
    m = model("bottle")
    for wall in (1.2, 2.0):
        m["wall"] = wall
        volumes = []
        for name in ("outer", "inner"):
            x, _, z = m[f"{name}.profile"](np.linspace(0, 1, 200_001)).T
            cones = (x[1:] ** 2 + x[1:] * x[:-1] + x[:-1] ** 2) / 3
            volumes.append(math.pi * float(np.sum(cones * np.diff(z))))
        mesh = m.mesh()
        assert mesh.closed
        # The panels' volume comes from below, by their chords.
        assert mesh.volume == pytest.approx(volumes[0] - volumes[1], rel=0.01)
    assert 500e3 < volumes[1] < 900e3


def test_arch_dam() -> None:
    m = model("arch_dam")
    exact = m.eval("dam.volume")
    # Slices across the dam at even heights, by the shoelace of their outlines.
    v = np.linspace(0, 1, 401)
    water, air = (
        m[n](np.linspace(0, 1, 201)[None, :], v[:, None]) for n in ("upstream", "downstream")
    )
    outline = np.concatenate([water, air[:, ::-1]], axis=1)
    x, y, z = np.moveaxis(outline, -1, 0)
    if np.ptp(z[0]) > 1e-6:
        water, air = (
            m[n](v[:, None], np.linspace(0, 1, 201)[None, :]) for n in ("upstream", "downstream")
        )
        outline = np.concatenate([water.swapaxes(0, 1), air.swapaxes(0, 1)[:, ::-1]], axis=1)
        x, y, z = np.moveaxis(outline, -1, 0)
    areas = 0.5 * np.abs(np.sum(x * np.roll(y, -1, 1) - np.roll(x, -1, 1) * y, axis=1))
    heights = z.mean(axis=1)
    slices = abs(float(np.sum((areas[1:] + areas[:-1]) / 2 * np.diff(heights))))
    assert exact == pytest.approx(slices, rel=0.02)
    assert not m.blocks().problems


def test_catamaran_by_the_parallel_axis() -> None:
    m = model("catamaran")
    first = m.hydrostatics(by=["spacing"])
    assert first.derivatives["volume"]["spacing"] == pytest.approx(0, abs=1e-6)
    s = m["spacing"]
    m["spacing"] = 11
    second = m.hydrostatics()
    moved = second.waterplane_area * (11**2 - s**2) / 4
    assert second.waterplane_it - first.waterplane_it == pytest.approx(moved, rel=1e-6)
    assert second.volume == pytest.approx(first.volume, rel=1e-9)


def below_water(patches: list[moldloft.Surface], n: int = 1500) -> tuple[float, float]:
    """Volume of both sides below z = 0, and its centre along x, by the flux of y e_y."""
    t = (np.arange(n) + 0.5) / n
    volume = moment = 0.0
    for patch in patches:
        x, y, z = np.moveaxis(patch(t[:, None], t[None, :]), -1, 0)
        corners = np.linspace(0, 1, n + 1)
        a, _, c = np.moveaxis(patch(corners[:, None], corners[None, :]), -1, 0)
        # The projection of each cell on y = 0, by its diagonals.
        cells = 0.5 * (
            (a[1:, 1:] - a[:-1, :-1]) * (c[:-1, 1:] - c[1:, :-1])
            - (c[1:, 1:] - c[:-1, :-1]) * (a[:-1, 1:] - a[1:, :-1])
        )
        cells = np.where(z < 0, cells, 0)
        sign = np.sign(np.sum(y * cells))
        volume += 2 * sign * float(np.sum(y * cells))
        moment += 2 * sign * float(np.sum(x * y * cells))
    return volume, moment / volume


def test_a_yacht_with_twin_shafts_is_one_closed_skin(tmp_path: Path) -> None:
    """The hull round a shaft against the hull with its hole; the solid by another program."""
    text = (GALLERY / "twin_shafts.sdl").read_text(encoding="utf-8")
    m = moldloft.loads(text + "TrimSurf rest(aft, {shaft.hole}, whole = 1, visible = 0);")
    patches = [f"shaft.{n}[{k}]" for n in ("ring", "strip", "corner") for k in range(1, 5)]
    assert sum(m[n].area for n in patches) == pytest.approx(m["rest"].area, rel=1e-8)
    assert m.mesh().closure()["closed_with_lids_and_mirror"]
    quality = m.mesh().quality()
    hull = [measures for name, measures in quality.items() if name.startswith(("keel.", "shaft."))]
    assert len(hull) == 20
    pytest.importorskip("OCP")
    from cad_reading import read

    (path,) = m.write(tmp_path / "yacht.step")
    found = read(path)
    assert found.valid and found.solids == 1
    volume = 2 * m.eval("mesh.volume")
    assert abs(found.volume - volume) < 0.02 * volume


def test_merchant_ship_floats_as_its_flux_says() -> None:
    m = model("merchant")
    for beam in (24, 28):
        m["beam"] = beam
        h = m.hydrostatics()
        volume, lcb = below_water([m["hull"]])
        assert h.volume == pytest.approx(volume, rel=1e-3)
        assert h.lcb == pytest.approx(lcb, abs=2e-4 * m["length"])
        assert 0.55 < h.cb < 0.85 and h.draft == pytest.approx(m["draft"], rel=1e-9)
        assert h.waterline_beam == pytest.approx(beam, rel=1e-9)
    # The middle body is as broad as asked and flat below.
    section = m["s6.line"](np.linspace(0, 1, 201))
    assert section[:, 1].max() == pytest.approx(14) and section[-1, 2] == pytest.approx(-9)


def test_planing_hull_has_its_waterline() -> None:
    m = model("planing")
    for width in (3.2, 4.0):
        m["chine_beam"] = width
        h = m.hydrostatics()
        patches = [m["bottom"], m["topside"]]
        volume, lcb = below_water(patches)
        assert h.volume == pytest.approx(volume, rel=2e-3)
        assert h.lcb == pytest.approx(lcb, abs=2e-3 * m["length"])
        # Rulings are straight: where each meets the water, and where the keel does.
        t = np.linspace(0, 1, 20_001)
        breadths, places = [], []
        for patch in patches:
            low, high = patch(t, 0.0), patch(t, 1.0)
            wet = (low[:, 2] < 0) & (high[:, 2] >= 0)
            share = -low[wet, 2] / (high[wet, 2] - low[wet, 2])
            at = low[wet] + share[:, None] * (high[wet] - low[wet])
            breadths += [at[:, 1].max()] if wet.any() else []
            places += [at[:, 0].min()] if wet.any() else []
        assert h.waterline_beam == pytest.approx(2 * max(breadths), rel=1e-6)
        assert h.waterline_length == pytest.approx(m["length"] - min(places), rel=1e-4)


def test_planing_hull_has_its_deadrise() -> None:
    m = model("planing")
    m["deadrise"] = 20
    keel, chine = m["k5"], m["c5"]
    assert math.degrees(math.atan2(chine.z - keel.z, chine.y)) == pytest.approx(20, abs=1e-9)


def test_nacelle() -> None:
    m = model("nacelle")
    assert m.eval("fan_face.area") == pytest.approx(math.pi * m["fan"] ** 2 / 2, rel=1e-9)
    # Cowl and duct share the highlight, and both leave it along the radius.
    cowl, duct = m["cowl_line"], m["duct_line"]
    assert np.allclose(cowl(0), duct(1))
    for curve, t in ((cowl, 1e-6), (duct, 1 - 1e-6)):
        way = curve(t) - m["highlight"].value
        assert abs(way[0]) < 1e-3 * abs(way[2])


def test_turbine_blade_has_its_chords() -> None:
    m = model("turbine_blade")
    for k, (width, place) in enumerate(
        zip(m.variables["width"], m.variables["place"], strict=True), 1
    ):
        tail, nose = (np.asarray(m[f"{n}[{k}]"]) for n in ("tail", "nose"))
        assert np.linalg.norm(tail - nose) == pytest.approx(m["chord"] * width)
        assert tail[2] == pytest.approx(place * m["radius"])
    assert m.derivative("blade.area", "chord") > 0


def test_the_rower_sinks_the_shell_by_her_mass() -> None:
    m = model("rowing_shell")
    mass = m.weights().mass
    assert mass == pytest.approx(88 + 1.6 * 2 * m["hull"].area * 1.1, rel=1e-6)
    h = m.hydrostatics(density="fresh")
    assert 0.05 < h.volume < 0.2


def test_ducted_fan_has_equal_blades() -> None:
    m = model("ducted_fan")
    areas = [m.eval(f"b{k}.skin.area") for k in range(1, 6)]
    assert np.allclose(areas, areas[0], rtol=1e-6)


def test_naca_duct_in_closed_form() -> None:
    m = model("naca_duct")
    for angle in (7, 9):
        m["angle"] = angle
        slope = math.tan(math.radians(angle))
        x, y, _ = m["edge"](np.linspace(0, 1, 100_001)).T
        plan = float(np.sum((y[1:] + y[:-1]) / 2 * np.diff(x)))
        assert m.eval("ramp.area") == pytest.approx(plan / math.cos(math.atan(slope)), rel=1e-6)
        steps = np.hypot(np.diff(x), np.diff(y))
        wall = slope * float(np.sum((x[1:] + x[:-1]) / 2 * steps))
        assert m.eval("wall.area") == pytest.approx(wall, rel=1e-6)
        throat = m["width"] / 2 * slope * m["length"]
        assert m.eval("throat.area") == pytest.approx(throat, rel=1e-9)
        whole = (m["width"] / 2 + m["margin"]) * (m["length"] + m["margin"])
        skin = m.eval("skin.area") + m.eval("nose1.area") + m.eval("nose2.area")
        assert skin + plan == pytest.approx(whole, rel=1e-6)
    assert not [d for d in m.junctions() if d.is_error]


def test_francis_runner_by_guldin_and_by_its_blades() -> None:
    m = model("francis")
    for name in ("crown", "band"):
        points = m[f"{name}_line"](np.linspace(0, 1, 20_001))
        r = np.hypot(points[:, 0], points[:, 1])
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        area = 2 * math.pi * float(np.sum((r[1:] + r[:-1]) / 2 * steps))
        assert m.eval(f"{name}.area") == pytest.approx(area, rel=1e-6)
    # Sheets that enclose nothing face away from the water, at every setting.
    faces = m.mesh().faces.copy()

    def normals(name: str) -> tuple[np.ndarray, np.ndarray]:
        patch = m.mesh().patch(name)
        corners = m.mesh().vertices[faces[patch.start : patch.stop]]
        across = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        return across, corners.mean(axis=1)

    across, _ = normals("crown")
    assert (across[:, 2] > 0).all()
    across, middles = normals("band")
    assert ((across * middles)[:, :2].sum(axis=1) > 0).all()
    rng = np.random.default_rng(3)
    for _ in range(40 if SOAK else 6):
        m.set({p.name: float(rng.uniform(p.low, p.high)) for p in m.params.values()})
        np.testing.assert_array_equal(m.mesh().faces, faces)
    m = model("francis")
    n = int(m.variables["blades"])
    areas = [m.eval(f"blade[{k}].area") for k in range(1, n + 1)]
    assert np.allclose(areas, areas[0], rtol=1e-6)
    # A blade is the one before it, turned by its share; its edges are on crown and band.
    first, second = (m[f"blade[{k}]"].grid(9, 9) for k in (1, 2))
    c, s = math.cos(2 * math.pi / n), math.sin(2 * math.pi / n)
    turned = first @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    assert np.abs(turned - second).max() < 1e-9
    for edge, line in ((first[:, 0], "crown_line"), (first[:, -1], "band_line")):
        meridian = m[line](np.linspace(0, 1, 20_001))
        profile = np.c_[np.hypot(edge[:, 0], edge[:, 1]), edge[:, 2]]
        apart = np.linalg.norm(profile[:, None] - meridian[None, :, [0, 2]], axis=-1).min(axis=1)
        assert apart.max() < 1e-4


def test_manifold_is_hollow_where_it_should_be() -> None:
    m = model("manifold")
    rng = np.random.default_rng(7)
    p = rng.uniform([-200, -45, -45], [200, 165, 45], (4000, 3))
    x, y, z = p.T
    end, bore, plenum, wall, reach = 190, 19, 34, 4, 160
    about = np.hypot(y, z)
    shell = (about < plenum + wall) & (abs(x) < end + wall)
    hollow = (about < plenum) & (abs(x) < end)
    plate = (abs(x) < end) & (y > reach - 12) & (y < reach) & (abs(z) < bore + 18)
    runner = np.min([np.hypot(x - k * 90, z) for k in (-1.5, -0.5, 0.5, 1.5)], axis=0)
    tube = (runner < bore + wall) & (y > 0) & (y < reach)
    mouth = (about < 0.85 * plenum) & (x > end - 1)
    inside = (shell | tube | plate) & ~hollow & ~((runner < bore) & (y > 0)) & ~mouth
    np.testing.assert_array_equal(m["manifold"](p) < 0, inside)


def test_car_body_is_as_wide_as_asked() -> None:
    m = model("car_body")
    y = m.mesh().vertices[:, 1]
    assert y.min() > -1e-9 and 0.93 * m["width"] < 2 * y.max() < 1.05 * m["width"]


def test_lattice_and_bracket_in_closed_form() -> None:
    if not SOAK:
        pytest.skip("MOLDLOFT_SOAK=1")
    m = model("lattice")
    assert m.eval("volume(lattice)") == pytest.approx(m["size"] ** 3 / 2, rel=1e-6)
    m = model("bracket")
    assert m.eval("volume(bracket)") == pytest.approx(m.eval("metal"), rel=1e-3)


def test_solid_where_it_should_be() -> None:
    """Points in walls, cells, culverts, slots and vents."""

    def inside(name: str, set_: str, points: dict[tuple[float, float, float], bool]) -> None:
        values = model(name)[set_](list(points))
        assert ((values < 0) == list(points.values())).all(), (name, values)

    swath = {(20, 9, -3.4): True, (20, 9, 1): True, (20, 10.4, 0): False, (20, 9, 3): False}
    inside("swath", "side", swath)
    if not SOAK:
        return
    lock = {(40, 1, 8): True, (40, 9, 8): False, (40, 1.5, 2.5): False, (40, 9, 1): True}
    inside("lock", "lock", lock)
    inside("bracket", "bracket", {(35, 30, 4): True, (4, 30, 40): True, (49, 15, 4): False})
    inside("bracket", "bracket", {(9, 30, 9): True, (15, 30, 19): False})
    inside("helmet", "helmet", {(0, 95, 10): True, (0, 0, 0): False, (-130, 0, 10): True})


@pytest.mark.parametrize("seed", range(20 if SOAK else 3))
def test_the_bulb_of_the_tug_grows_by_its_section(seed: int) -> None:
    m = model("tug")
    rng = np.random.default_rng(seed)
    for p in m.params.values():
        m[p.name] = float(rng.uniform(p.low, p.high))
    m["bulb_nose"] = float(rng.uniform(-2, -1.2))
    h = m.hydrostatics(by=["bulb_nose"])
    section = math.pi * m["bulb_radius"] ** 2
    assert h.derivatives["volume"]["bulb_nose"] == pytest.approx(-section, rel=1e-7)
    ahead = h.volume
    m["bulb_nose"] -= 0.1
    assert m.hydrostatics().volume - ahead == pytest.approx(0.1 * section, rel=1e-4)
    # Parts of the hull and the bulb's skin, of which a longer bulb has more.
    assert sum(m.wetted_areas().values()) == pytest.approx(m.hydrostatics().wetted_area, rel=1e-6)


def test_the_struts_of_a_swath_end_on_its_hulls() -> None:
    """Solids of revolution, and struts from their skin to the water, by quadrature."""
    m = model("swath_struts")
    for thickness, radius in ((1.0, 1.5), (1.4, 1.2)):
        m["thickness"], m["radius"] = thickness, radius
        ends = 2 / 3 * math.pi * radius**2 * 5 + math.pi * radius**2 * 15
        s = (np.arange(2000) + 0.5) / 2000
        tail = math.pi * radius**2 * float(np.mean((1 - s**2) ** 2 * (12 - 8 * s)))
        # Half the lens at even distances: the arc of a circle above its chord.
        chord, sag = m["chord"], thickness / 2
        circle = (chord**2 / 4 + sag**2) / (2 * sag)
        x = 3.5 + chord * (np.arange(20_000) + 0.5) / 20_000
        half = np.sqrt(circle**2 - (x - 3.5 - chord / 2) ** 2) - circle + sag
        s = (np.sqrt(np.maximum(36 - 4 * (x - 20), 0)) - 6) / -4
        r = np.where(
            x < 5, np.sqrt(np.maximum(1 - ((x - 5) / 5) ** 2, 0)), 1 - np.maximum(s, 0) ** 2
        )
        r *= radius
        inner = half * np.sqrt(r**2 - half**2) + r**2 * np.arcsin(half / r)
        above = 2 * m["depth"] * half - inner
        strut = chord * float(np.mean(above))
        h = m.hydrostatics(by=["depth"])
        assert h.volume == pytest.approx(2 * (ends + tail + strut), rel=1e-7)
        # Deeper hulls have longer struts.
        plan = h.waterplane_area
        assert h.derivatives["volume"]["depth"] == pytest.approx(plan, rel=1e-6)
        assert not m.junctions() and m.mesh().closed
    assert not m.diagnostics


def test_the_workboat_has_the_volume_of_its_bottom_and_skeg() -> None:
    m = model("workboat")
    for changed in ({}, {"beam": 4.2, "deadrise": 12}):
        for name, value in changed.items():
            m[name] = value
        h = m.hydrostatics()
        # The flux through the chine flat is inward: it faces the centre plane.
        bare = below_water([m["bottom"], m["topside"], m["transom"]])[0]
        bare -= below_water([m["chine_flat"]])[0]
        # The half section of the skeg, from the sole to the bottom above it.
        x, y, _ = m["plan"](np.linspace(0, 1, 4001)).T
        xs, ys = np.meshgrid(*[(np.arange(400) + 0.5) / 400] * 2, indexing="ij")
        ys = ys * np.interp(6.6 + 4 * xs, x, y)
        u = np.linspace(0, 1, 2001)
        keel, chine = m["keel"](u), m["chine"](u)
        along = 6.6 + 4 * xs
        # Rules of the bottom have the same parameter on keel and chine.
        t = np.interp(along, keel[:, 0], u)
        for _ in range(30):
            k, c = (
                np.stack([np.interp(t, u, q[:, i]) for i in range(3)], -1) for q in (keel, chine)
            )
            part = ys / c[..., 1]
            t += (along - k[..., 0] - part * (c[..., 0] - k[..., 0])) / 11
        bottom = k[..., 2] + part * (c[..., 2] - k[..., 2])
        skeg = 2 * 4 * float(np.mean((bottom + m["skeg"]) * np.interp(along, x, y)))
        assert h.volume == pytest.approx(bare + skeg, rel=1.5e-4)
        assert not h.remarks and h.kb == pytest.approx(h.vcb + m["skeg"], rel=1e-9)
        assert m.mesh().closure()["closed_with_lids_and_mirror"] and not m.junctions()
    # Immersed below its skeg alone: the section of the foil with a closed tail.
    low = m.hydrostatics(level=-0.7)
    assert low.waterplane_area == pytest.approx(0.68088 * 4 * m["thickness"], rel=1e-5)
    assert not m.diagnostics
