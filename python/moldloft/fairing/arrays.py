"""Points as arrays, with checks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import FairingError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["direction", "motions_of", "narrowed", "points_of", "radii", "refuse_repeats"]


def points_of(points: ArrayLike, dimensions: int = 2) -> tuple[Floats, int]:
    """Points in three columns, and the number of columns of the input."""
    try:
        given = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise FairingError(f"the points are not an array of numbers: {error}") from error
    if given.ndim != dimensions or given.shape[-1] not in (2, 3):
        wanted = "(n, 2) or (n, 3)" if dimensions == 2 else "(m, n, 3)"
        raise FairingError(f"expected points {wanted}, found an array {given.shape}")
    width = given.shape[-1]
    if width == 2:
        given = np.concatenate([given, np.zeros((*given.shape[:-1], 1))], axis=-1)
    flat = np.isfinite(given.reshape(-1, 3)).all(axis=1)
    if not flat.all():
        bad = int(np.flatnonzero(~flat)[0])
        raise FairingError(f"point {bad + 1} is not finite", index=bad)
    return np.ascontiguousarray(given), width


def refuse_repeats(points: Floats, closed: bool) -> None:
    """Rejects coincident neighbours, which have no direction between them."""
    after = np.roll(points, -1, axis=0) if closed else points[1:]
    before = points if closed else points[:-1]
    same = (after == before).all(axis=1)
    if same.any():
        k = int(np.flatnonzero(same)[0])
        second = (k + 1) % len(points)
        hint = "a closed curve does not repeat its first point" if second == 0 else "remove one"
        raise FairingError(
            f"points {k + 1} and {second + 1} coincide: {hint}", index=max(k, second)
        )


def radii(tol: ArrayLike | None, count: int) -> list[float]:
    """The tolerance of each point; infinite without a limit."""
    if tol is None:
        return [np.inf] * count
    given = np.asarray(tol, dtype=np.float64)
    try:
        each = np.broadcast_to(given.ravel() if given.ndim else given, count)
    except ValueError as error:
        raise FairingError(
            f"expected one tolerance or {count} of them, found {given.size}"
        ) from error
    bad = np.flatnonzero(np.isnan(each) | (each < 0))
    if len(bad):
        value = each[bad[0]]
        raise FairingError(f"expected a tolerance of at least 0, found {value:g}")
    return [float(r) for r in each]


def direction(motion: Any) -> tuple[str, tuple[float, float, float]]:
    """``"ball"``, ``"box"``, or a direction to move along, or ``("across", direction)``."""
    if isinstance(motion, str):
        return motion, (0.0, 0.0, 0.0)
    word = "along"
    if isinstance(motion, tuple) and len(motion) == 2 and isinstance(motion[0], str):
        word, motion = motion
    vector = np.asarray(motion, dtype=np.float64).ravel()
    if vector.size == 2:
        vector = np.append(vector, 0.0)
    if vector.size != 3 or not np.isfinite(vector).all() or not vector.any():
        raise FairingError(f"expected a direction of some length, found {motion!r}")
    return word, (float(vector[0]), float(vector[1]), float(vector[2]))


def motions_of(
    motion: Any, count: int
) -> tuple[Any, list[tuple[int, tuple[float, float, float]]], list[bool]]:
    """The motion of all points, the points restricted to an axis, and the fixed points.

    Axes for each point, such as ``["y", "z", "yz", ""]``, become the motion along all of them.
    """
    if not isinstance(motion, list) or not all(isinstance(axes, str) for axes in motion):
        return motion, [], [False] * count
    if len(motion) != count:
        raise FairingError(f"expected the axes of {count} points, found {len(motion)}")
    if odd := next((axes for axes in motion if set(axes) - set("xyz")), None):
        raise FairingError(f"expected axes of x, y and z, found `{odd}`")
    every = {axis for axes in motion for axis in axes} or {"y"}
    unit = {axis: tuple(float(axis == a) for a in "xyz") for axis in "xyz"}
    whole: Any = "box"
    if len(every) == 1:
        whole = unit[min(every)]
    elif len(every) == 2:
        whole = "across", unit[min(set("xyz") - every)]
    held = [
        (k, unit[axis])
        for k, axes in enumerate(motion)
        if axes
        for axis in sorted(every - set(axes))
    ]
    return whole, held, [not axes for axes in motion]  # type: ignore[return-value]


def too_large(tol: ArrayLike | None, points: Floats) -> tuple[str, ...]:
    """A warning about a tolerance above a twentieth of the extent."""
    if tol is None or not len(points):
        return ()
    most = float(np.max(np.asarray(tol, np.float64)))
    extent = float(np.linalg.norm(np.ptp(points.reshape(-1, points.shape[-1]), axis=0)))
    if not 0 < extent < 20 * most < np.inf:
        return ()
    return (
        f"the tolerance, {most:.3e}, is {100 * most / extent:.0f} % of the extent of the data: "
        "check its unit",
    )


def narrowed(points: Floats, width: int) -> Floats:
    """Points with the number of columns of the input."""
    return np.ascontiguousarray(points[..., :width])


def vector_of(v: ArrayLike) -> list[float]:
    """The three numbers of a vector."""
    flat = [float(c) for c in np.asarray(v, np.float64).ravel()]
    if len(flat) != 3:
        raise FairingError(f"expected a vector of three numbers, found {len(flat)}")
    return flat
