"""Common parts of pages and pictures of fairings: colours, round numbers, comb teeth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from moldloft.colours import COLOURS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.fairing.spline import Samples, Spline

    Floats = NDArray[np.float64]

__all__ = [
    "AFTER",
    "BEFORE",
    "MOVE",
    "QUIET",
    "WRONG",
    "by_length",
    "even_turns",
    "exaggeration",
    "round_below",
    "teeth",
]

BEFORE, AFTER, MOVE = COLOURS["before"], COLOURS["after"], COLOURS["moved"]
QUIET, WRONG = COLOURS["quiet"], COLOURS["wrong"]


def round_below(x: float) -> float:
    """1, 2 or 5 times a power of ten, at most `x`.

    Parameters
    ----------
    x
        A positive number.
    """
    if not (np.isfinite(x) and x > 0):
        return 1.0
    power = 10.0 ** np.floor(np.log10(x))
    return float(next(k * power for k in (5.0, 2.0, 1.0) if k * power <= x * (1 + 1e-12)))


def exaggeration(moves: Floats, extent: float) -> float:
    """A round factor that shows the largest move as about a twentieth of the extent.

    Parameters
    ----------
    moves
        Displacements of the points.
    extent
        Size of the drawing.

    Examples
    --------
    >>> exaggeration(np.array([0.001, 0.0004]), 10.0)
    500.0
    """
    largest = float(np.max(moves, initial=0.0))
    return max(1.0, round_below(0.05 * extent / largest)) if largest > 0 else 1.0


def even_turns(spline: Spline, most: float = 0.05, rows: int = 400) -> Samples:
    """Samples distributed by length and turning, so that sharp turns have enough comb teeth.

    Parameters
    ----------
    spline
        A curve.
    most
        The turn of the tangent between two samples, in radians.
    rows
        The number of samples at most.
    """
    fine = spline.samples(24)
    steps = np.linalg.norm(np.diff(fine.points, axis=0), axis=1)
    length = float(steps.sum()) or 1.0
    bend = np.abs(fine.curvature)
    turn = 0.5 * (bend[1:] + bend[:-1]) * steps
    way = steps / length / 0.005 + turn / most
    run = np.concatenate([[0.0], np.cumsum(way)])
    count = int(min(max(run[-1], 60), rows))
    keep = np.linspace(0.0, run[-1], count + 1)
    t = np.interp(keep, run, fine.t)
    return spline.at(np.clip(t, 0, 1))


def by_length(samples: Samples) -> Floats:
    """Magnitude of the curvature at points evenly spaced in arc length.

    Parameters
    ----------
    samples
        Samples of a curve.
    """
    bend = np.interp(np.linspace(0, 1, 1001), samples.arc, np.abs(samples.curvature))
    return np.asarray(bend)


def teeth(samples: Samples, ij: list[int], cut: float, scale: float) -> tuple[Floats, Floats]:
    """Feet and tips of a comb; longer teeth than `cut` are truncated.

    Parameters
    ----------
    samples
        Samples of a curve.
    ij
        The two axes of the view.
    cut, scale
        The largest curvature that is drawn, and the length of a tooth of curvature 1.
    """
    tangent = samples.first[:, ij]
    size = np.linalg.norm(tangent, axis=1, keepdims=True)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]]) / np.where(size > 0, size, 1)
    feet = samples.points[:, ij]
    # Outside of the bend, from whichever side of its plane a curve is seen.
    facing = np.cross(np.eye(3)[ij[0]], np.eye(3)[ij[1]])
    sign = -1.0 if samples.plane is not None and np.dot(samples.plane, facing) < 0 else 1.0
    return feet, feet - np.clip(samples.curvature, -cut, cut)[:, None] * (sign * scale) * normal
