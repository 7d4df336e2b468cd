"""Parameters of a model fitted to reference geometry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import Error
from moldloft.overlays.deviation import Deviation, _facing, _normals, deviation

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from moldloft.models import Model
    from moldloft.overlays.overlay import Overlay

    Floats = NDArray[np.float64]

__all__ = ["Fit", "fit"]


@dataclass(frozen=True, eq=False)
class Fit:
    """Result of a fit."""

    values: dict[str, float]
    """The parameters, which are also set in the model."""
    deviation: Deviation
    """The remaining distances."""
    before: float
    """The rms of the distances at the start."""
    steps: int
    """Steps taken."""
    converged: bool
    """True if converged: the last step was small."""

    def __repr__(self) -> str:
        how = "" if self.converged else ", not converged"
        return (
            f"<Fit: rms {self.before:.4g} to {self.deviation.rms:.4g} in {self.steps} steps{how}>"
        )


def fit(
    model: Model,
    to: Overlay | ArrayLike,
    parameters: Sequence[str],
    *,
    objects: Sequence[str] | str = (),
    most: int = 400,
    steps: int = 40,
) -> Fit:
    """Sets parameters of a model to minimise the distance of its surfaces from points.

    The sum of the squares of the distances is minimised (Gauss and Newton's method, damped as by
    Levenberg and Marquardt): the derivative of a distance with respect to a parameter is exact:
    that of the surface's point at fixed (u, v), along the normal.

    Parameters
    ----------
    model
        The model; it is changed.
    to
        An overlay, or points ``(n, 3)``.
    parameters
        Names of parameters, or literals such as ``"P21.y"``. Ranges are kept.
    objects
        See :func:`moldloft.overlays.deviation`.
    most
        Maximum number of points used in the steps, evenly distributed over their order.
    steps
        Steps at most.

    Returns
    -------
    Fit
        The parameters, their previous values, and the remaining deviation.

    Raises
    ------
    Error
        Without parameters, and for fewer points than parameters.
    """
    from moldloft.overlays.overlay import Overlay

    names = [parameters] if isinstance(parameters, str) else list(parameters)
    points = to.samples() if isinstance(to, Overlay) else np.asarray(to, dtype=np.float64)
    if not names:
        raise Error("a fit needs a parameter at least")
    if len(points) < len(names):
        raise Error(f"{len(points)} points do not determine {len(names)} parameters")
    first = deviation(model, points, objects=objects)
    few = points[np.unique(np.linspace(0, len(points) - 1, min(most, len(points))).astype(int))]
    known = model.params
    low = np.array(
        [-np.inf if n not in known or known[n].low is None else known[n].low for n in names]
    )
    high = np.array(
        [np.inf if n not in known or known[n].high is None else known[n].high for n in names]
    )
    x = np.array([float(model.eval(name)) for name in names])
    now = deviation(model, few, objects=objects)
    damping, done, taken = 1e-3, False, 0
    while taken < steps and not done:
        taken += 1
        slopes = _slopes(model, now, names)
        # A parameter at a bound that would pass it stays.
        gradient = slopes.T @ now.distances
        free = ~(((x <= low) & (gradient > 0)) | ((x >= high) & (gradient < 0)))
        if not free.any() or not np.abs(slopes[:, free]).max() > 0:
            done = True
            break
        matrix = slopes[:, free].T @ slopes[:, free]
        while True:
            damped = matrix + damping * np.diag(np.maximum(np.diag(matrix), 1e-12 * matrix.max()))
            step = np.zeros(len(x))
            step[free] = -np.linalg.lstsq(damped, gradient[free], rcond=None)[0]
            trial = np.clip(x + step, low, high)
            after = _tried(model, names, trial, few, objects)
            small = bool(np.all(np.abs(trial - x) <= 1e-10 * (1 + np.abs(x))))
            if after is not None and after.rms <= now.rms:
                gain = now.rms - after.rms
                done = small or gain <= 1e-12 * (after.rms + 1e-300)
                x, now, damping = trial, after, max(damping / 10, 1e-12)
                break
            if small or damping > 1e12:
                done = True
                break
            damping *= 10
    model.set(dict(zip(names, x.tolist(), strict=True)))
    left = deviation(model, points, objects=objects)
    return Fit(dict(zip(names, x.tolist(), strict=True)), left, first.rms, taken, done)


def _tried(
    model: Model, names: list[str], x: Floats, points: Floats, objects: Sequence[str] | str
) -> Deviation | None:
    """The deviation at these values; None if the model has an error there."""
    try:
        model.set(dict(zip(names, x.tolist(), strict=True)))
        return deviation(model, points, objects=objects)
    except Error:
        return None


def _slopes(model: Model, now: Deviation, names: list[str]) -> Floats:
    """Derivatives of the distances with respect to the parameters, ``(points, parameters)``."""
    expressions = [
        f"{name}({float(u)!r}, {float(v)!r})"
        for name, (u, v) in zip(now.surfaces.tolist(), now.parameters, strict=True)
    ]
    rows = np.array(model.derivatives(expressions, names), dtype=np.float64)
    off = now.points - now.feet
    directions = np.empty_like(off)
    for name in set(now.surfaces.tolist()):
        own = now.surfaces == name
        # Back from the image in a plane of symmetry to the surface itself.
        at = model[name](*now.parameters[own].T)
        off[own] *= np.where(at * now.feet[own] < 0, -1.0, 1.0)
        normals = _normals(model[name], now.parameters[own])
        directions[own] = _facing(model, name) * _unit(normals)
    # Beside an edge the distance is along the offset itself.
    beside = now.beside
    directions[beside] = (np.sign(now.distances)[:, None] * _unit(off))[beside]
    slopes: Floats = -np.einsum("ijk,ik->ij", rows, directions)
    return slopes


def _unit(vectors: Floats) -> Floats:
    """The directions of vectors; zero for zero vectors."""
    size = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: Floats = np.divide(vectors, size, out=np.zeros_like(vectors), where=size > 0)
    return unit


explain(globals())
