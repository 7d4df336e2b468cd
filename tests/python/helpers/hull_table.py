"""A table of offsets for the fairing desk."""

from __future__ import annotations

import numpy as np


def hull(
    noise: float = 0.004,
    halves: tuple[float, ...] = (),
    wrong: tuple[float, float, float] | None = None,
) -> str:
    """A table of offsets with a matrix of half-breadths, to three decimals.

    `halves` are stations between the whole ones; `wrong` is a station, a waterline's number and
    what its reading is off by.
    """
    rng = np.random.default_rng(7)
    whole, levels = np.linspace(0, 20, 11), np.linspace(0.2, 2, 7)
    stations = np.sort(np.concatenate([whole, halves]))
    rows = ["waterline," + ",".join(f"{x:g}" for x in stations)]
    for k, z in enumerate(levels):
        y = 2.5 * (1 - ((stations - 10) / 11) ** 2) * (1 - (1 - z / 2.2) ** 2)
        y = y + rng.uniform(-noise, noise, len(y))
        if wrong is not None and k == wrong[1]:
            y[stations == wrong[0]] += wrong[2]
        rows.append(f"{z:g}," + ",".join(f"{v:.3f}" for v in y))
    return "\n".join(rows) + "\n"
