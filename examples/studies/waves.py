"""Motions of the platform and of the sailing yacht's hull in regular waves, by Capytaine.

Radiation and diffraction of all six degrees of freedom; SI units throughout. Amplitudes are those
of the response amplitude operators (RAO): metres per metre of wave amplitude, and for rotations
radians per radian of the wave's slope.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from heave import coarse

import moldloft

DENSITY, GRAVITY = 1025.0, 9.81

#: Periods of the platform's and of the hull's numbers in s.
PLATFORM_PERIODS = (8.0, 12.0, 16.0, 24.0)
HULL_PERIODS = (3.0, 4.0, 6.0, 8.0)


def operators(
    model: moldloft.Model,
    periods: Sequence[float],
    *,
    heading: float,
    centre: Sequence[float],
    gyration: Sequence[float],
) -> Mapping[str, np.ndarray]:
    """Complex responses of a body afloat, by degree of freedom.

    Parameters
    ----------
    model
        Its model; panels below z = 0.
    periods
        Periods of the waves in s, deep water.
    heading
        Direction in which they travel in radians: 0 along x.
    centre
        Centre of gravity in the model's axes and unit; rotations are about it.
    gyration
        Radii of gyration of roll, pitch and yaw in the model's unit.

    Returns
    -------
    dict
        For each degree of freedom an array of one number for each period, per metre of wave
        amplitude; rotations in radians.
    """
    import capytaine
    import xarray

    capytaine.set_logging("ERROR")
    metres = model.length_unit[1]
    body = model.to_capytaine(centre=centre)
    mass = DENSITY * body.volume
    inertia = np.diag([1.0, 1.0, 1.0, *((metres * k) ** 2 for k in gyration)])
    labels = list(body.dofs)
    dimensions = ("influenced_dof", "radiating_dof")
    body.inertia_matrix = xarray.DataArray(
        mass * inertia, dims=dimensions, coords=dict.fromkeys(dimensions, labels)
    )
    body.hydrostatic_stiffness = body.compute_hydrostatic_stiffness(rho=DENSITY, g=GRAVITY)
    omega = 2 * math.pi / np.asarray(periods, dtype=np.float64)
    matrix = xarray.Dataset(
        coords={
            "omega": omega,
            "wave_direction": [heading],
            "radiating_dof": labels,
            "rho": [DENSITY],
            "g": [GRAVITY],
            "water_depth": [math.inf],
        }
    )
    found = capytaine.BEMSolver().fill_dataset(matrix, body, hydrostatics=True, progress_bar=False)
    # It sorts frequencies.
    response = capytaine.post_pro.rao(found).squeeze(("wave_direction",)).sel(omega=omega)
    return {name: response.sel(radiating_dof=name).values for name in labels}


def slope(period: float) -> float:
    """Slope of a wave of unit amplitude in deep water: its wave number in 1/m."""
    return (2 * math.pi / period) ** 2 / GRAVITY


def platform(model: moldloft.Model) -> Mapping[str, float]:
    """Amplitudes of heave and surge of the platform without its tethers, waves along x."""
    panels = coarse(model.text)
    panels.set({name: each.value for name, each in model.params.items()})
    # The centre of gravity in the middle of the draught, below the metacentre.
    centre = (0.0, 0.0, -0.5 * model["draft"])
    radius = 0.45 * model["spacing"]
    found = operators(
        panels, PLATFORM_PERIODS, heading=0.0, centre=centre, gyration=(radius, radius, radius)
    )
    return {
        f"{dof.lower()}_{period:g}": float(abs(value))
        for dof in ("Heave", "Surge")
        for period, value in zip(PLATFORM_PERIODS, found[dof], strict=True)
    }


def hull(model: moldloft.Model) -> Mapping[str, float]:
    """Amplitudes of heave, and of pitch by the slope of the waves, of a hull in head seas."""
    state = model.hydrostatics()
    length = state.waterline_length
    found = operators(
        model,
        HULL_PERIODS,
        heading=0.0,
        centre=(state.lcb, 0.0, 0.0),
        gyration=(0.35 * state.waterline_beam, 0.25 * length, 0.25 * length),
    )
    heave = dict(zip(HULL_PERIODS, np.abs(found["Heave"]), strict=True))
    pitch = {
        period: abs(value) / slope(period)
        for period, value in zip(HULL_PERIODS, found["Pitch"], strict=True)
    }
    rows = {"heave": heave, "pitch": pitch}
    return {
        f"{name}_{period:g}": float(value)
        for name, by in rows.items()
        for period, value in by.items()
    }
