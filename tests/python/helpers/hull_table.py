"""A table of offsets for the fairing desk."""

from __future__ import annotations

import numpy as np


def hull(noise: float = 0.004) -> str:
    """A table of offsets with a matrix of half-breadths, to three decimals."""
    rng = np.random.default_rng(7)
    stations, levels = np.linspace(0, 20, 11), np.linspace(0.2, 2, 7)
    rows = ["waterline," + ",".join(f"{x:g}" for x in stations)]
    for z in levels:
        y = 2.5 * (1 - ((stations - 10) / 11) ** 2) * (1 - (1 - z / 2.2) ** 2)
        y = y + rng.uniform(-noise, noise, len(y))
        rows.append(f"{z:g}," + ",".join(f"{v:.3f}" for v in y))
    return "\n".join(rows) + "\n"
