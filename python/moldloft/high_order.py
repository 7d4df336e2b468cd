"""WAMIT's high-order geometry: B-spline patches (GDF with IGDEF = 1).

A file has a title; ``ULEN GRAV``; ``ISX ISY``; ``NPATCH 1``; for each patch ``NUG NVG`` (spans),
``KUG KVG`` (orders, degree + 1), the NUG + 2 KUG - 1 knots in u, those in v, on [-1, 1], and
(NUG + KUG - 1)(NVG + KVG - 1) control points, u running fastest (WAMIT User Manual 7.6; the layout
is the one that BEMRosetta reads and writes). S_u x S_v points out of the water, into the body.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from moldloft import _core
from moldloft.arguments import explain

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]

__all__ = ["SplinePatch", "patches", "write"]


@dataclass(frozen=True)
class SplinePatch:
    """A B-spline patch with clamped uniform knots on [-1, 1]."""

    name: str
    """The surface that it is, or is a part of."""
    degree: tuple[int, int]
    """Degrees in u and v."""
    spans: tuple[int, int]
    """Spans in u and v."""
    points: Floats
    """Control points, ``(nu, nv, 3)``."""
    deviation: float
    """The largest distance found from the surface; rounding where the form is exact."""

    def knots(self, axis: int) -> Floats:
        """The knot vector of u (0) or v (1), end knots included.

        Parameters
        ----------
        axis
            0 for u, 1 for v.
        """
        return _core.spline_patch_knots(self.degree[axis], self.spans[axis])

    def __call__(self, u: Floats, v: Floats) -> Floats:
        """Positions on the grid of ``u`` and ``v`` in [-1, 1], ``(nu, nv, 3)``."""
        us, vs = (np.ascontiguousarray(t, dtype=np.float64).ravel() for t in (u, v))
        points = np.ascontiguousarray(self.points, dtype=np.float64)
        return _core.spline_patch_grid(self.degree, points, us, vs)


def patches(
    model: Model, *, tolerance: float | None = None, lids: bool = False
) -> list[SplinePatch]:
    """The model's skin as B-spline patches, in the order of its patches.

    Surfaces that are B-splines of uniform knots and degrees up to 5 (lofts, rulings and
    translations of such curves) are exact. Others are fitted by cubics within ``tolerance``, and
    halved where that fails.

    Parameters
    ----------
    model
        The model.
    tolerance
        Largest distance from the surface, checked at four points per span and direction; default:
        1e-5 of the model's diagonal.
    lids
        True to include lids.
    """
    return [
        SplinePatch(name, (degree[0], degree[1]), (spans[0], spans[1]), points, deviation)
        for name, degree, spans, points, deviation in model._document.spline_patches(
            tolerance, lids
        )
    ]


def write(model: Model, title: str, *, tolerance: float | None = None, lids: bool = False) -> bytes:
    """The file. Patches above the water are included; WAMIT trims them (ITRIMWL = 1).

    Parameters
    ----------
    model
        The model.
    title
        A title, for formats that have one.
    tolerance
        The largest error of fitted patches.
    lids
        Include lids.
    """
    name = f"{title}.gdf"
    return model.encoded("gdf-high", name, tolerance=tolerance, lids=lids)[name]


explain(globals())
