"""The section as the coordinates that XFOIL reads, and its thickness."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import moldloft

#: Points of a side, denser towards nose and tail.
POINTS = 100


def side(model: moldloft.Model, name: str) -> np.ndarray:
    """x and y of a side from the nose to the tail, ``(points, 2)``."""
    t = 0.5 * (1 - np.cos(np.linspace(0, np.pi, POINTS)))
    return np.asarray(model[name](t))[:, :2]


def write(model: moldloft.Model, folder: Path) -> None:
    """`section.dat` in Selig's order: from the tail over the upper side to the nose and back."""
    points = np.concatenate([side(model, "upper")[::-1], side(model, "lower")[1:]])
    lines = [f"{x:12.8f} {y:12.8f}" for x, y in points]
    (folder / "section.dat").write_text("\n".join(["section", *lines]) + "\n")


def thickness(model: moldloft.Model) -> dict[str, float]:
    """The greatest thickness and that at 75 % of the chord."""
    upper, lower = side(model, "upper"), side(model, "lower")
    x = np.linspace(0.01, 0.99, 197)
    thick = np.interp(x, *upper.T) - np.interp(x, *lower.T)
    return {"thickness": float(thick.max()), "aft": float(np.interp(0.75, x, thick))}
