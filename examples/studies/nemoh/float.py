"""Counts of the panels for Nemoh, and the heave period from what Nemoh writes."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np

import moldloft

DENSITY, GRAVITY = 1025.0, 9.81

#: The columns of heave in heave among the pairs A, B of six forces, behind the frequency.
ADDED = 1 + 2 * 2


def prepare(model: moldloft.Model, folder: Path) -> dict[str, float]:
    """The words of the template: the counts of the panels, and the centre of gravity."""
    for name in ("mesh", "results"):
        (folder / name).mkdir()
    found = model.hydrostatics()
    # The parser has mass and stiffness from here.
    mass, stiffness = DENSITY * found.volume, DENSITY * GRAVITY * found.waterplane_area
    (folder / "body.txt").write_text(f"{mass!r} {stiffness!r}\n")
    mesh = model.mesh()
    counts = {"points": len(mesh.vertices), "panels": len(mesh.faces)}
    return {**counts, "centre": 1.2 * found.vcb}


def heave_period(file: Path) -> float:
    """The natural period of heave in s, where w^2 (m + A33(w)) = C33.

    `RadiationCoefficients.tec` has a zone for each motion, a line for each frequency.
    """
    mass, stiffness = (float(word) for word in (file.parents[1] / "body.txt").read_text().split())
    zones = re.split(r"(?i)^ *zone.*$", file.read_text(), flags=re.M)[1:]
    heave = np.array(
        [[float(word) for word in line.split()] for line in zones[2].split("\n")[1:-1]]
    )
    frequency, added = heave[:, 0], heave[:, ADDED]
    excess = frequency**2 * (mass + added) - stiffness
    above = int(np.searchsorted(excess > 0, True))
    if not 0 < above < len(excess):
        raise ValueError("the resonance is outside the frequencies of Nemoh.cal")
    pair = slice(above - 1, above + 1)
    return 2 * math.pi / float(np.interp(0.0, excess[pair], frequency[pair]))
