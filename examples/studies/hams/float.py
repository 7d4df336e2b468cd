"""Mass and stiffness of the float for HAMS, and its heave period from what HAMS writes."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

import moldloft

DENSITY, GRAVITY = 1025.0, 9.81


def prepare(model: moldloft.Model, folder: Path) -> dict[str, float]:
    """The words of the template: a float whose mass is spread over its cylinder, but 20 % lower."""
    for name in ("Hams", "Hydrostar", "Wamit"):
        (folder / "Output" / f"{name}_format").mkdir(parents=True)
    found = model.hydrostatics()
    radius, draft = float(model["radius"]), float(model["draft"])
    mass, weight = DENSITY * found.volume, DENSITY * GRAVITY * found.volume
    centre = 1.2 * found.vcb
    inertia = mass * (3 * radius**2 + draft**2) / 12
    return {
        "centre": centre,
        "mass": mass,
        "i_x": inertia,
        "i_y": inertia,
        "i_z": mass * radius**2 / 2,
        "c_33": DENSITY * GRAVITY * found.waterplane_area,
        "c_44": weight * (found.vcb + found.bmt - centre),
        "c_55": weight * (found.vcb + found.bml - centre),
    }


def heave_period(file: Path) -> float:
    """The natural period of heave in s, where w^2 (m + A33(w)) = C33, from `Buoy.1`.

    Its columns are frequency, i, j, added mass / density, damping / (density frequency).
    """
    rows = np.loadtxt(file, ndmin=2)
    heave = rows[(rows[:, 1] == 3) & (rows[:, 2] == 3)]
    mass, stiffness = _of_body(file.parents[2] / "Input" / "Hydrostatic.in")
    frequency, added = heave[:, 0], DENSITY * heave[:, 3]
    order = np.argsort(frequency)
    frequency, added = frequency[order], added[order]
    excess = frequency**2 * (mass + added) - stiffness
    above = int(np.searchsorted(excess > 0, True))
    if not 0 < above < len(excess):
        raise ValueError("the resonance is outside the frequencies of ControlFile.in")
    pair = slice(above - 1, above + 1)
    return 2 * math.pi / float(np.interp(0.0, excess[pair], frequency[pair]))


def _of_body(file: Path) -> tuple[float, float]:
    """Mass and heave stiffness of `Hydrostatic.in`: its matrices have a title and six rows each."""
    lines = file.read_text().splitlines()
    mass = float(lines[lines.index(" Body Mass Matrix:") + 3].split()[2])
    stiffness = float(lines[lines.index(" Hydrostatic Restoring Matrix:") + 3].split()[2])
    return mass, stiffness
