"""Reference area, refinement and a point in the water of the case."""

from __future__ import annotations

import math
from pathlib import Path

import moldloft

#: Refinement of the background mesh at the body; each level halves its cells.
LEVEL = 2


def prepare(model: moldloft.Model, folder: Path) -> dict[str, float]:
    """The words of the template beside the inputs."""
    length, diameter = float(model["length"]), float(model["diameter"])
    return {
        "length": length,
        "x_inlet": -2 * length,
        "x_outlet": 5 * length,
        "far": 2 * length,
        "area": math.pi * diameter**2 / 8,
        "level": LEVEL,
        "near_low": -0.25 * length,
        "near_high": 1.5 * length,
        "near_side": diameter,
        # Not on a face of a cell.
        "inside_x": -1.013 * length,
        "inside_y": 0.513 * length,
        "inside_z": 0.507 * length,
    }
