"""Resistance: the published example of Holtrop and Mennen, Michell's integral of a Wigley hull."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

import moldloft
from moldloft.resistance import GRAVITY, Ship, holtrop, michell

# The ship of Holtrop and Mennen 1982, section 6.
CONTAINER = Ship(
    length=205,
    beam=32,
    draft=10,
    volume=37500,
    cm=0.98,
    cwp=0.75,
    lcb=-0.75,
    bulb_area=20,
    bulb_height=4,
    transom_area=16,
    stern=10,
)
KNOTS = 1852 / 3600


def test_the_example_of_the_paper():
    found = holtrop(CONTAINER, 25 * KNOTS, appendages=50, appendage_factor=1.5)
    # As printed, in kN; lcb is printed to two digits.
    assert abs(CONTAINER.cp - 0.5833) < 2e-4
    assert abs(found.wetted_area - 7381.45) < 0.1
    assert abs(found.form_factor - 1.156) < 6e-4
    for part, printed, off in (
        ("friction", 869.63, 0.5),
        ("appendages", 8.83, 0.01),
        ("wave", 557.11, 1.2),
        ("bulb", 0.049, 6e-4),
        ("transom", 0.0, 0.0),
        ("correlation", 221.98, 0.2),
        ("total", 1793.26, 0.5),
    ):
        assert abs(getattr(found, part) / 1000 - printed) <= off, part
    # The printed coefficient is 0.000352, of hull and appendages.
    pressure = 0.5 * 1025 * (25 * KNOTS) ** 2 * (found.wetted_area + 50)
    assert abs(found.correlation / pressure - 0.000352) < 1e-6
    assert found.outside == ()


def test_what_the_regression_does_not_cover_is_said():
    with pytest.raises(moldloft.Error, match=r"ends at the Froude number 0.45"):
        holtrop(CONTAINER, 45 * KNOTS)
    with pytest.raises(moldloft.Error, match="above 0 m/s"):
        holtrop(CONTAINER, 0)
    slim = Ship(length=200, beam=15, draft=6, volume=9000, cm=0.95, cwp=0.7, lcb=0)
    assert "length / beam is 13.3, outside 3.9 to 9.5" in holtrop(slim, 8).outside
    for change, said in (
        ({"beam": -1}, "`beam`"),
        ({"volume": 80000}, "`cb` of a ship is below 1"),
    ):
        with pytest.raises(moldloft.Error, match=said):
            Ship(**{**vars(CONTAINER), **change})
    with pytest.raises(moldloft.Error, match="two thirds"):
        Ship(**{**vars(CONTAINER), "bulb_height": 8})


def wigley(length: float, beam: float, draft: float, nx: int, nz: int):
    """One side of the parabolic hull of Wigley, below and a little above the water."""
    x, z = np.linspace(-length / 2, length / 2, nx + 1), np.linspace(-draft, 0, nz + 1)
    gx, gz = np.meshgrid(x, z, indexing="ij")
    y = beam / 2 * (1 - (2 * gx / length) ** 2) * (1 - (gz / draft) ** 2)
    number = np.arange(gx.size).reshape(gx.shape)
    faces = np.stack(
        [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1
    ).reshape(-1, 4)
    return np.stack([gx, y, gz], axis=-1).reshape(-1, 3), faces


def exact(length: float, beam: float, draft: float, speed: float) -> float:
    """Michell's integral of that hull in kN / (t/m³), integrals over the hull in closed form."""
    k = GRAVITY / speed**2

    def spectrum(t: float) -> float:
        s = math.sqrt(1 + t * t)
        c, q = k * s * length / 2, k * s * s * draft
        # The integrals of -4 beam x / length² sin(k s x) and of (1 - z²/draft²) exp(k s² z).
        along = (
            -4 * beam / length**2 * 2 * (length / 2) ** 2 * (math.sin(c) / c**2 - math.cos(c) / c)
        )
        deep = draft * ((1 - math.exp(-q)) / q - (2 - math.exp(-q) * (q * q + 2 * q + 2)) / q**3)
        return (along * deep) ** 2 * s

    whole = sum(
        quad(spectrum, a, a + 0.5, epsrel=1e-10, limit=200)[0] for a in np.arange(0, 40, 0.5)
    )
    return 4 * GRAVITY**2 / (math.pi * speed**2) * whole


@pytest.mark.parametrize("froude", [0.25, 0.316, 0.408])
def test_michell_s_integral_of_wigley_s_hull(froude):
    speed = froude * math.sqrt(GRAVITY * 10)
    truth = exact(10, 1, 0.625, speed)
    off = [
        abs(float(michell(wigley(10, 1, 0.625, n, n // 4), speed, density=1.0)) / truth - 1)
        for n in (32, 64)
    ]
    # Flat panels: the error falls with the square of their length.
    assert off[1] < 4e-3 and off[1] < 0.4 * off[0], off


def test_meshes_that_michell_cannot_take_are_said():
    hull = wigley(10, 1, 0.625, 8, 2)
    with pytest.raises(moldloft.Error, match="below the water"):
        michell((hull[0] + [0, 0, 5], hull[1]), 3.0)
    with pytest.raises(moldloft.Error, match="above 0 m/s"):
        michell(hull, [3.0, 0.0])


def test_michell_takes_both_sides_and_cuts_at_the_water():
    points, faces = wigley(10, 1, 0.625, 16, 4)
    one = michell((points, faces), [3.0, 4.0])
    other = points * [1, -1, 1]
    both = (
        np.concatenate([points, other]),
        np.concatenate([faces, faces[:, [0, 3, 2, 1]] + len(points)]),
    )
    assert np.allclose(michell(both, [3.0, 4.0], symmetric=False), one, rtol=1e-9)
    # A freeboard adds nothing.
    top = points.reshape(17, 5, 3)[:, -1]
    wall = np.stack([top, top + np.array([0, 0, 0.5])], axis=1).reshape(-1, 3)
    number = np.arange(34).reshape(17, 2)
    more = np.stack([number[:-1, 0], number[1:, 0], number[1:, 1], number[:-1, 1]], axis=-1)
    high = np.concatenate([points, wall]), np.concatenate([faces, more + len(points)])
    assert np.allclose(michell(high, [3.0, 4.0]), one, rtol=1e-12)
