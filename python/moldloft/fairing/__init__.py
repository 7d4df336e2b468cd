"""Fairing within a certified tolerance, and the interrogation of curves and surfaces.

>>> import numpy as np
>>> from moldloft import fair
>>> x = np.linspace(0, 1, 41)
>>> y = np.round(0.1 * np.sin(np.pi * x), 3)           # a curve read off to three decimals
>>> faired = fair(np.column_stack([x, y]), 5e-4)       # never farther than half the last digit
>>> faired.deviation_data <= 5e-4
True
>>> faired.jumps_after < 1e-3 * faired.jumps_before
True
>>> faired.gap < 1e-6                                  # optimality gap, proved
True

A row of points is a curve, a grid ``(m, n, 3)`` the net of a surface; :func:`network` fairs curves
that share points, such as the lines of a hull, :func:`patches` surfaces that share edges.
:class:`Spline` and :class:`SplineSurface` answer questions about curves and surfaces, :class:`Look`
about how light plays on them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from moldloft.arguments import explain
from moldloft.fairing.curve import fair_curve
from moldloft.fairing.desk import Desk
from moldloft.fairing.faired import Arc, Fairing
from moldloft.fairing.look import Look
from moldloft.fairing.network import NetworkFairing, network
from moldloft.fairing.page import page, write_page
from moldloft.fairing.patches import PatchesFairing, patches
from moldloft.fairing.report import Finding, Numbers
from moldloft.fairing.spline import (
    Samples,
    Spline,
    divided_differences,
    grid_metric,
    monotone_runs,
)
from moldloft.fairing.surface import SplineSurface, SurfaceFairing, fair_surface
from moldloft.fairing.suspects import Suspect, suspects

__all__ = [
    "Arc",
    "Desk",
    "Fairing",
    "Finding",
    "Look",
    "NetworkFairing",
    "Numbers",
    "PatchesFairing",
    "Samples",
    "Spline",
    "SplineSurface",
    "SurfaceFairing",
    "Suspect",
    "divided_differences",
    "fair",
    "grid_metric",
    "monotone_runs",
    "network",
    "page",
    "patches",
    "suspects",
    "write_page",
]


def fair(
    points: ArrayLike | Spline | SplineSurface | Fairing | SurfaceFairing,
    tol: ArrayLike | None,
    **options: Any,
) -> Fairing | SurfaceFairing:
    """Fair a curve or a surface within a tolerance.

    Parameters
    ----------
    points
        A row of points ``(n, 2)`` or ``(n, 3)``, a :class:`Spline` or a :class:`Fairing` of a
        curve; a grid ``(m, n, 3)``, a :class:`SplineSurface` or a :class:`SurfaceFairing`, a
        surface.
    tol
        Maximum distance of the result from the original: a length, or one per point. 0 leaves a
        point unchanged. ``None`` means no limit and is an error for closed curves.
    **options
        Those of :func:`~moldloft.fairing.curve.fair_curve` or
        :func:`~moldloft.fairing.surface.fair_surface`.

    Returns
    -------
    Fairing or SurfaceFairing
        The faired points, with a report.

    Raises
    ------
    FairingError
        If there is too little to fair, a number is not finite, the tolerance is negative, or
        conditions contradict each other.

    Examples
    --------
    >>> import numpy as np
    >>> angle = np.arange(48) * 2 * np.pi / 48
    >>> ring = np.round(np.column_stack([np.cos(angle), np.sin(angle)]), 2)
    >>> faired = fair(ring, 0.01, closed=True, as_="fit")
    >>> faired.after.inflections, faired.before.inflections > 10
    (0, True)
    """
    if isinstance(points, (Spline, Fairing)):
        return fair_curve(points, tol, **options)
    if isinstance(points, (SplineSurface, SurfaceFairing)):
        return fair_surface(points, tol, **options)
    if np.ndim(points) == 3:
        return fair_surface(points, tol, **options)
    return fair_curve(points, tol, **options)


explain(globals())
