"""Area and centroid of a surface with bounds of their errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["SurfaceMeasures"]

COORDINATES = ("x", "y", "z")


@dataclass(frozen=True)
class SurfaceMeasures:
    """Area and centroid of a surface, by quadrature on its shape, piece by piece.

    ``bounds`` and ``derivative_bounds`` have the names ``area``, ``x``, ``y`` and ``z``.
    """

    area: float
    """Area, in the square of the model's unit."""
    centroid: Floats
    """Centroid of the area, of shape ``(3,)``."""
    bounds: dict[str, float]
    """Estimates of the errors of quadrature and of the interpolation of the surface."""
    derivatives: dict[str, dict[str, float]]
    """Derivatives ``[figure][parameter]`` for the requested parameters."""
    derivative_bounds: dict[str, dict[str, float]]
    """Estimates of the errors of :attr:`derivatives`: the difference from those for a hundredfold
    ``accuracy``, plus ``accuracy`` times the derivative."""

    @classmethod
    def _of(
        cls, values: list[list[float]], slopes: list[list[list[float]]], by: list[str]
    ) -> SurfaceMeasures:
        names = ("area", *COORDINATES)
        (area, *centre), bounds = values
        rates, rate_bounds = (
            {name: dict(zip(by, row, strict=True)) for name, row in zip(names, rows, strict=True)}
            for rows in slopes
        )
        named = dict(zip(names, bounds, strict=True))
        return cls(area, np.array(centre), named, rates, rate_bounds)
