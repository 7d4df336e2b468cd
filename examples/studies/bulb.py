"""Resistance of the hull with its bulb at 7.3 m/s, the Froude number 0.3."""

from __future__ import annotations

import math

import moldloft
from moldloft.resistance import michell

SPEED, LENGTH, DENSITY, VISCOSITY = 7.3, 60.0, 1025.0, 1.19e-6


def resistance(model: moldloft.Model) -> dict[str, float]:
    """Wave resistance by Michell's integral and friction by the line of ITTC 1957, in kN."""
    mesh = model.mesh()
    wave = float(michell(mesh, SPEED, density=DENSITY, accuracy=1e-3))
    # One side is panelled.
    area = 2 * float(model.eval("mesh.area"))
    reynolds = SPEED * LENGTH / VISCOSITY
    plate = 0.075 / (math.log10(reynolds) - 2) ** 2
    friction = plate * DENSITY / 2 * SPEED**2 * area
    return {
        "wave": wave / 1e3,
        "friction": friction / 1e3,
        "resistance": (wave + friction) / 1e3,
    }
