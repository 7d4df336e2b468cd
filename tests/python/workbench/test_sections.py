"""Sections of a network's lines by planes, beside the closed form of the surface."""

from __future__ import annotations

import math

import numpy as np
import pytest

from moldloft.workbench.sections import sections

LENGTH, BEAM, DEPTH = 20.0, 2.5, 2.2


def half_breadth(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    return BEAM * (1 - ((x - 10) / 11) ** 2) * (1 - (1 - z / DEPTH) ** 2)


def station(x: float) -> np.ndarray:
    z = np.linspace(0, DEPTH, 400)
    return np.column_stack([np.full_like(z, x), half_breadth(np.full_like(z, x), z), z])


def waterline(z: float) -> np.ndarray:
    x = np.linspace(0, LENGTH, 300)
    return np.column_stack([x, half_breadth(x, np.full_like(x, z)), np.full_like(x, z)])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_sections_of_a_hull_are_on_it(side: float) -> None:
    lines = [station(x) for x in np.linspace(0, LENGTH, 11)] + [waterline(z) for z in (0.5, 1, 2)]
    found = sections([line * [1, side, 1] for line in lines])
    assert len(found["diagonals"]) == 5 and len(found["buttocks"]) == 3
    for diagonal in found["diagonals"]:
        x, along = np.array(diagonal).T
        assert (np.diff(x) > 0).all()
        y = along / math.sqrt(2)
        # All points are in one plane at 45 degrees: of each x the z that is on the hull.
        z = np.array([height(*place) for place in zip(x, y, strict=True)])
        assert np.ptp(z + y) < 1e-4
    for buttock in found["buttocks"]:
        x, z = np.array(buttock).T
        assert np.ptp(half_breadth(x, z)) < 1e-4


def height(x: float, y: float) -> float:
    """Where the hull has that half-breadth."""
    low, high = 0.0, DEPTH
    for _ in range(60):
        middle = (low + high) / 2
        if half_breadth(np.float64(x), np.float64(middle)) < y:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def test_a_network_with_buttocks_keeps_its_own() -> None:
    x = np.linspace(0, 4, 9)
    own = [np.column_stack([x, np.full_like(x, y), 0.1 * x**2 + y]) for y in (0.5, 1.0, 1.5)]
    across = [np.array([[k, y, 0.1 * k**2 + y] for y in (0.0, 1.0, 2.0)]) for k in x]
    assert sections(own + across)["buttocks"] == []
    assert len(sections(across)["buttocks"]) == 3
