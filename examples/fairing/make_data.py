"""Writes the data of these examples: shapes with a formula, rounded or made noisy.

The noise comes from a generator that any program can repeat: u <- (1103515245 u + 12345) mod 2^31
from u = 1, each value u / 2^31 - 1/2. Run it in this folder.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


class Random:
    """Numbers in [-1/2, 1/2)."""

    def __init__(self, seed: int = 1) -> None:
        self.u = seed

    def __call__(self) -> float:
        """The next one."""
        self.u = (1103515245 * self.u + 12345) % 2**31
        return self.u / 2**31 - 0.5


def naca0012() -> np.ndarray:
    """81 points of the section with an open trailing edge, at x = s^2, s from -1 to 1."""
    s = np.arange(-40, 41) / 40
    x = s**2
    t = 0.2969 * np.abs(s) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4
    return np.column_stack([x, np.sign(s) * 0.6 * t])


def waisted() -> np.ndarray:
    """61 points of a body with a waist."""
    x = np.arange(61) / 60
    waist = 0.02 * np.exp(-(((x - 0.55) / 0.15) ** 2))
    return np.column_stack([x, 0.05 - waist + 0.01 * (1 - (2 * x - 1) ** 2)])


def noisy_waist() -> np.ndarray:
    """The same with noise of 2e-4 in y."""
    points, random = waisted(), Random()
    for p in points:
        random()
        p[1] += 2e-4 * random()
    return points


def circle() -> np.ndarray:
    """64 points of a unit circle with noise of 2e-3 in x and y."""
    angle = 2 * np.pi * np.arange(64) / 64
    points, random = np.column_stack([np.cos(angle), np.sin(angle)]), Random()
    for p in points:
        p[0] += 2e-3 * random()
        p[1] += 2e-3 * random()
    return points


def wigley(noise: float = 2e-4) -> np.ndarray:
    """Half a Wigley hull as 41 x 17 points, noise in y."""
    random = Random()
    grid = np.empty((41, 17, 3))
    for i in range(41):
        for j in range(17):
            x, z = -0.5 + i / 40, -0.0625 * j / 16
            y = 0.05 * (1 - 4 * x * x) * (1 - (z / 0.0625) ** 2)
            grid[i, j] = x, y + noise * random(), z
    return grid


def section() -> np.ndarray:
    """A midship section as somebody read it off a drawing: keel to sheer with a knuckle.

    Two decimals of a metre, the knuckle at point 21, and one wrong digit at point 33.
    """
    t = np.linspace(0, 1, 21)
    bottom = np.column_stack([6.2 * t, 1.9 * t**2.2])
    s = np.linspace(0, 1, 26)[1:]
    side = np.column_stack([6.2 + 0.9 * s - 0.55 * s**2, 1.9 + 4.1 * s])
    points = np.round(np.vstack([bottom, side]), 2)
    points[32, 0] += 0.3
    return points


def lines() -> list[np.ndarray]:
    """Offsets of a small hull: stations and waterlines that share their points.

    Half-breadths to the nearest centimetre, 21 stations by 13 waterlines.
    """
    x = np.linspace(0, 20, 21)
    z = np.linspace(0.4, 2.8, 13)
    u = x / 10 - 1
    breadth = 2.6 * (1 - u**2)[:, None] * (1 - (1 - z / 2.8) ** 2)[None, :]
    grid = np.empty((21, 13, 3))
    grid[..., 0], grid[..., 2] = x[:, None], z[None, :]
    grid[..., 1] = np.round(breadth, 2)
    return [*grid, *grid.transpose(1, 0, 2)]


def table(name: str, points: np.ndarray, head: str = "x, y") -> None:
    """Writes points as CSV."""
    rows = [head, *(", ".join(repr(float(c)) for c in p) for p in points)]
    (HERE / name).write_text("\n".join(rows) + "\n")


def main() -> None:
    """Writes everything."""
    table("naca0012-4.csv", np.round(naca0012(), 4))
    table("naca0012-3.csv", np.round(naca0012(), 3))
    table("waisted-4.csv", np.round(waisted(), 4))
    table("waisted-noise.csv", noisy_waist())
    table("circle.csv", circle())
    table("section.csv", section())
    grid = wigley()
    numbers = [repr(float(c)) for axis in range(3) for c in grid[..., axis].T.ravel()]
    rows = [" ".join(numbers[k : k + 4]) for k in range(0, len(numbers), 4)]
    (HERE / "wigley.p3d").write_text("\n".join(["1", "41 17 1", *rows]) + "\n")
    blocks = ["\n".join(", ".join(f"{c:g}" for c in p) for p in line) for line in lines()]
    (HERE / "lines.csv").write_text("x, y, z\n" + "\n\n".join(blocks) + "\n")


if __name__ == "__main__":
    main()
