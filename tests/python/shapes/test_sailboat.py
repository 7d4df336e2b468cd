"""The hull of the Relational Geometry paper's Figure 1, in the repo's own words."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import moldloft
from conftest import SAILBOAT

TABLE_2 = {
    "P11": (0.000, 0.000, 3.600),
    "P12": (1.367, 0.000, 0.602),
    "P13": (2.324, 0.000, -0.800),
    "P14": (3.000, 0.000, -0.900),
    "P21": (15.000, 4.815, 2.560),
    "P22": (15.000, 5.046, 0.628),
    "P23": (15.000, 3.603, -0.870),
    "P24": (15.000, 0.000, -1.175),
    "P31": (30.000, 3.500, 2.760),
    "P32": (30.000, 3.500, 1.320),
    "P33": (30.000, 2.500, 0.120),
    "P34": (30.000, 0.000, 0.120),
}


@pytest.fixture(params=["hull.sdl", "hull.ms2"])
def hull(request) -> moldloft.Model:
    model = moldloft.load(SAILBOAT / request.param)
    model.check()
    return model


def test_the_points_are_those_of_the_table(hull):
    for name, xyz in TABLE_2.items():
        assert tuple(hull.eval(name)) == xyz, name
    kinds = {name: hull[name].kind for name in hull.objects if hull[name].kind != "Model"}
    assert list(kinds)[:5] == ["P11", "P12", "P13", "P14", "MC1"]
    curves = {"MC1": "BCurve", "MC2": "BCurve", "MC3": "BCurve", "hull": "CLoftSurf"}
    contours = {"stations": "XContours", "waterlines": "ZContours"}
    assert kinds == dict.fromkeys(TABLE_2, "AbsPoint") | curves | contours


@pytest.mark.parametrize(
    ("u", "v", "expected"),
    [
        (0.5, 0.25, (8.6422, 2.9203, -0.2053)),
        (0.5, 0.5, (15.6002, 4.3938, -0.1043)),
        (0.5, 0.75, (22.7195, 4.4203, 0.2042)),
        (0.0, 0.25, (7.2339, 3.1440, 2.9322)),
        (1.0, 0.25, (9.7675, 0.0, -1.1976)),
    ],
)
def test_points_of_the_surface(hull, u, v, expected):
    np.testing.assert_allclose(hull["hull"](u, v), expected, rtol=0, atol=1e-4)


def test_the_widest_of_the_sheer(hull):
    sheer = hull["hull"](0.0, np.linspace(0, 1, 20_001))
    assert sheer[:, 1].max() == pytest.approx(5.0284, abs=5e-5)


def test_both_files_are_the_same_model():
    a, b = (moldloft.load(SAILBOAT / name) for name in ("hull.sdl", "hull.ms2"))
    assert a.symmetry == b.symmetry == "y"
    np.testing.assert_array_equal(a.mesh().vertices, b.mesh().vertices)
    np.testing.assert_array_equal(a.mesh().faces, b.mesh().faces)
    ours, theirs = (dataclasses.asdict(m.hydrostatics()) for m in (a, b))
    # The model file of 1995 does not state the unit of length.
    for name in ("units",):
        del ours[name], theirs[name]
    assert ours == theirs


def fine(nu: int, nv: int) -> moldloft.Model:
    text = (SAILBOAT / "hull.ms2").read_text()
    assert "10 1 20 1" in text
    return moldloft.loads(text.replace("10 1 20 1", f"{nu} 1 {nv} 1"), name="fine.ms2")


def test_the_waterline_and_the_volume():
    figures = fine(160, 240).hydrostatics()
    assert figures.sides == "both"
    assert figures.waterline_low_x == pytest.approx(1.781, abs=2e-3)
    assert figures.waterline_high_x == pytest.approx(29.167, abs=2e-3)
    assert figures.volume == pytest.approx(117.45, abs=0.1)


def test_the_volume_of_the_panels_converges_at_second_order():
    coarse, middle, dense = (fine(20 * k, 30 * k).panel_figures()["volume"] for k in (1, 2, 4))
    rate = np.log2((middle - coarse) / (dense - middle))
    assert 1.7 < rate < 2.3


def test_one_side_is_half_of_both(hull):
    both, one = hull.hydrostatics(), hull.hydrostatics(sides="one")
    assert one.sides == "one"
    assert both.volume == pytest.approx(2 * one.volume, rel=1e-14)


def test_the_panels(hull):
    mesh = hull.mesh()
    assert mesh.patch("hull").divisions == (10, 20)
    assert mesh.faces.shape == (200, 4)
    assert not mesh.closed


def test_beam_scales_the_sections():
    model = moldloft.load(SAILBOAT / "hull.sdl")
    scale = 9.0 / model["beam"]
    model["beam"] = 9.0
    for name, (x, y, z) in TABLE_2.items():
        assert tuple(model.eval(name)) == pytest.approx((x, y * scale, z), rel=1e-15)
    # Chord lengths change with the beam, and the loft with them: the sheer follows closely.
    sheer = model["hull"](0.0, np.linspace(0, 1, 20_001))
    assert 2 * sheer[:, 1].max() == pytest.approx(9.0, rel=3e-3)
