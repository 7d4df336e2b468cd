"""The wing as AVL has it: reference figures, two sections, their aerofoils."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

import moldloft

#: Points of an aerofoil from the tail over the upper side to the nose and back.
POINTS = 81


def aerofoil(model: moldloft.Model, section: str) -> np.ndarray:
    """X and z in chords in the axes of the chord, ``(points, 2)``."""
    t = 0.5 * (1 - np.cos(np.pi * np.linspace(0, 1, POINTS)))
    points = np.asarray(model[f"{section}.foil"](t))[:, [0, 2]]
    nose, tail = (np.asarray(model[f"{section}.{p}"])[[0, 2]] for p in ("nose", "tail"))
    chord = tail - nose
    along = chord / math.hypot(*chord)
    turned = (points - nose) @ np.array([along, [-along[1], along[0]]]).T
    return turned / math.hypot(*chord)


def prepare(model: moldloft.Model, folder: Path) -> dict[str, float]:
    """Writes `root.dat` and `tip.dat`; the words of the template."""
    for section in ("root", "tip"):
        rows = [f"{x:10.6f} {z:10.6f}" for x, z in aerofoil(model, section)]
        (folder / f"{section}.dat").write_text("\n".join([section, *rows]) + "\n")
    names = ("half_span", "root_chord", "taper", "sweep", "dihedral", "washout")
    b, root, taper, sweep, dihedral, washout = (float(model[n]) for n in names)
    mean = root * (1 + taper) / 2
    return {
        "area": 2 * b * mean,
        "chord": 2 / 3 * root * (1 + taper + taper**2) / (1 + taper),
        "span": 2 * b,
        "x_ref": 0.25 * root + b * math.tan(sweep) * (1 + 2 * taper) / (3 * (1 + taper)),
        "x_tip": b * math.tan(sweep),
        "y_tip": b,
        "z_tip": b * math.tan(dihedral),
        "tip_chord": taper * root,
        "incidence": -math.degrees(washout),
    }
