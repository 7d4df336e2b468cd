"""Geometry report of the propeller, measured on its blade: sections, and the ratios of the sheet.

    python examples/propeller/report.py [name=value ...]

Every figure is that of the surface, between the master sections as at them: places on the cylinder
of the radius r, unrolled to x and r theta. The ratios are defined as in Carlton, Marine Propellers
and Propulsion, chapter 3.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

import moldloft

PROGRAM = Path(__file__).with_name("propeller.sdl")


def section(model: moldloft.Model, v: float) -> dict[str, float]:
    """Pitch, chord, thickness, camber, skew and rake of the blade at v, even from hub to tip."""
    # Even in the square root of the distance from the nose at u = 0.5, where the sides meet.
    s = np.linspace(0, 1, 201) ** 2 / 2
    sides = [np.asarray(model["one.skin"](0.5 + side * s, v)) for side in (-1, 1)]
    x = np.array([side[:, 0] for side in sides])
    radius = np.hypot(sides[0][0, 1], sides[0][0, 2])
    angle = np.unwrap(np.arctan2(*np.concatenate([p[:, 1:].T for p in sides], axis=1)))
    y = radius * angle.reshape(2, -1)
    nose, tail = np.array([x[0, 0], y[0, 0]]), np.array([x[0, -1], y[0, -1]])
    chord = float(np.hypot(*(tail - nose)))
    along = (tail - nose) / chord
    across = np.array([along[1], -along[0]])
    offsets = np.stack([x - nose[0], y - nose[1]], axis=-1)
    lengths, heights = offsets @ along, offsets @ across
    stations = np.linspace(0.01, 0.99, 197) * chord
    back, face = (np.interp(stations, lengths[k], heights[k]) for k in (0, 1))
    middle = (nose + tail) / 2
    pitch = 2 * math.pi * radius * abs(along[0] / along[1])
    return {
        "radius": float(radius),
        "pitch": pitch,
        "chord": chord,
        "thickness": float(np.abs(back - face).max()),
        "camber": float(np.abs(back + face).max() / 2),
        "skew": abs(math.degrees(middle[1] / radius)),
        # What the line of the middles is ahead of the pitch helix.
        "rake": float(middle[0] - abs(middle[1] / radius) * pitch / (2 * math.pi)),
    }


def report(model: moldloft.Model) -> dict[str, float]:
    """Area ratios, mean width ratio, blade thickness fraction, mean pitch ratio."""
    diameter, blades = float(model["diameter"]), float(model.eval("blades"))
    disc = math.pi * diameter**2 / 4
    # Even in the square root of the distance from the tip, where the chord falls to zero.
    v = 1 - np.linspace(1, 0, 401)[:-1] ** 2
    points = np.asarray(model["one.skin"](np.array([0.0, 0.5])[:, None], v[None]))
    radius = np.hypot(points[0, :, 1], points[0, :, 2])
    angle = np.unwrap(np.arctan2(points[..., 1], points[..., 2]), axis=0)
    turn = np.abs(angle[0] - angle[1])
    chord = np.hypot(points[0, :, 0] - points[1, :, 0], radius * turn)
    pitch = 2 * math.pi * np.abs(points[0, :, 0] - points[1, :, 0]) / turn
    tip = diameter / 2
    ends = np.append(radius, tip)
    area = np.trapezoid(np.append(chord, 0), ends)
    radii = np.linspace(0.3, 0.9, 7)
    thick = [section(model, (r - 0.2) / 0.8)["thickness"] / diameter for r in radii]
    return {
        "expanded area ratio": blades * area / disc,
        "projected area ratio": blades * np.trapezoid(np.append(radius * turn, 0), ends) / disc,
        "mean width ratio": area / (tip - radius[0]) / diameter,
        "blade thickness fraction": float(np.polyfit(radii, thick, 1)[1]),
        "mean pitch ratio": float(
            np.trapezoid(pitch * radius, radius) / np.trapezoid(radius, radius) / diameter
        ),
        "pitch ratio at 0.7 R": section(model, 0.625)["pitch"] / diameter,
    }


def main() -> None:
    """Prints the report."""
    model = moldloft.load(PROGRAM)
    model.set({name: float(value) for name, _, value in (a.partition("=") for a in sys.argv[1:])})
    diameter = float(model["diameter"])
    print("   r/R     P/D     c/D     t/D     f/D    skew  rake/D")
    for at in (0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.975):
        found = section(model, (at - 0.2) / 0.8)
        ratios = [found[name] / diameter for name in ("pitch", "chord", "thickness", "camber")]
        print(f"{at:6.3f}", *(f"{x:7.4f}" for x in ratios), f"{found['skew']:7.2f}", end="")
        print(f" {found['rake'] / diameter:7.4f}")
    for name, value in report(model).items():
        print(f"{name:25}{value:8.4f}")


if __name__ == "__main__":
    main()
