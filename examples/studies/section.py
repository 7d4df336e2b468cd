"""The section as the coordinates that XFOIL reads, as a grid of SU2, and its thickness."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import moldloft

#: Points of a side, denser towards nose and tail.
POINTS = 100

#: Grid of SU2: cells away from the section; radius of the far field and first cell in chords.
CELLS, FAR, FIRST = 48, 25.0, 2e-3


def side(model: moldloft.Model, name: str) -> np.ndarray:
    """X and y of a side from the nose to the tail, ``(points, 2)``."""
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


def grid(model: moldloft.Model) -> np.ndarray:
    """An O-grid, ``(around, away, 2)``: from the tail below the section round the nose and back."""
    lower, upper = side(model, "lower"), side(model, "upper")
    # The tail is closed in its middle; the last point would be the first again.
    tail = (lower[-1] + upper[-1]) / 2
    wall = np.concatenate([[tail], lower[-2:0:-1], upper[:-1]])
    turn = np.linspace(0, -2 * np.pi, len(wall), endpoint=False)
    circle = np.stack([0.5 + FAR * np.cos(turn), FAR * np.sin(turn)], axis=1)
    # Lengths grow from the first cell by one ratio to the far field.
    ratio = _ratio(FIRST, FAR, CELLS)
    t = (ratio ** np.arange(CELLS + 1) - 1) / (ratio**CELLS - 1)
    return wall[:, None] * (1 - t)[:, None] + circle[:, None] * t[:, None]


def _ratio(first: float, total: float, count: int) -> float:
    low, high = 1.0 + 1e-9, 10.0
    for _ in range(200):
        middle = (low + high) / 2
        if first * (middle**count - 1) / (middle - 1) < total:
            low = middle
        else:
            high = middle
    return low


def write_su2(model: moldloft.Model, folder: Path) -> None:
    """`section.su2`: quadrilaterals, the markers `section` and `farfield`."""
    points = grid(model)
    around, away = points.shape[:2]
    number = np.arange(around * away).reshape(around, away)
    after = np.roll(number, -1, axis=0)
    # The section runs clockwise, the cells counter-clockwise.
    cells = np.stack([number[:, :-1], after[:, :-1], after[:, 1:], number[:, 1:]], axis=-1)
    lines = ["NDIME= 2", f"NELEM= {cells.shape[0] * cells.shape[1]}"]
    # VTK's types: 9 a quadrilateral, 3 a line.
    lines += [f"9 {a} {b} {c} {d} {k}" for k, (a, b, c, d) in enumerate(cells.reshape(-1, 4))]
    lines.append(f"NPOIN= {number.size}")
    lines += [f"{x:.15e} {y:.15e} {k}" for k, (x, y) in enumerate(points.reshape(-1, 2))]
    lines.append("NMARK= 2")
    for name, column in (("section", 0), ("farfield", away - 1)):
        lines += [f"MARKER_TAG= {name}", f"MARKER_ELEMS= {around}"]
        lines += [f"3 {a} {b}" for a, b in zip(number[:, column], after[:, column], strict=True)]
    (folder / "section.su2").write_text("\n".join(lines) + "\n")
