"""A million points of a 20 x 20 bicubic B-spline surface, beside its peers.

Run with `python benches/surface.py`; peers that are not installed are named.
"""

from __future__ import annotations

import numpy as np
from pairs import compare, missing

import moldloft
from moldloft import kinds as k
from moldloft.builder import Builder

N, M = 20, 1000
KNOTS = np.concatenate([[0] * 4, np.arange(1, N - 3) / (N - 3), [1] * 4]).astype(float)
RNG = np.random.default_rng(7)
NET = np.stack(
    [*np.meshgrid(np.arange(N) / 2, np.arange(N) / 2, indexing="ij"), RNG.random((N, N))], axis=-1
)


def surface() -> moldloft.Object:
    """The surface as a model."""
    with Builder() as builder:
        k.BSurf("S", NET.reshape(-1, 3).tolist(), nu=N, nv=N)
    return builder.model()["S"]


def scipy_tensor(t: np.ndarray) -> object:
    """SciPy's design matrices, multiplied through."""
    from scipy.interpolate import BSpline

    def work() -> np.ndarray:
        basis = BSpline.design_matrix(t, KNOTS, 3)
        half = (basis @ NET.reshape(N, -1)).reshape(len(t), N, 3)
        half = np.ascontiguousarray(half.transpose(1, 0, 2)).reshape(N, -1)
        return (basis @ half).reshape(len(t), len(t), 3)

    return work


def geomcore_scattered(uv: np.ndarray) -> object:
    """Geomcore, a list of parameters in and points out."""
    from geomcore import Point
    from geomcore.surfaces import BSplineSurface

    poles = [[Point(*p) for p in row] for row in NET.tolist()]
    knots, counts = np.unique(KNOTS, return_counts=True)
    once = (knots.tolist(), counts.tolist())
    spline = BSplineSurface(3, 3, poles, *once, *once, False, False)
    pairs = [tuple(p) for p in uv.tolist()]
    return lambda: spline.eval_points(pairs)


def splinepy_scattered(uv: np.ndarray) -> object:
    """Splinepy, an array in and an array out, one thread."""
    import splinepy

    net = NET.transpose(1, 0, 2).reshape(-1, 3)
    spline = splinepy.BSpline([3, 3], [KNOTS.tolist(), KNOTS.tolist()], net)
    return lambda: spline.evaluate(uv, nthreads=1)


def main() -> None:
    """Print a line for each case."""
    s = surface()
    t = np.linspace(0, 1 - 1e-12, M)
    try:
        theirs = scipy_tensor(t)
        compare(lambda: s.grid(M, M), theirs, name="tensor grid, SciPy")  # type: ignore[arg-type]
    except ImportError as error:
        missing("tensor grid, SciPy", error)
    uv = RNG.random((M * M, 2))
    u, v = np.ascontiguousarray(uv[:, 0]), np.ascontiguousarray(uv[:, 1])
    for name, peer in {"geomcore": geomcore_scattered, "splinepy": splinepy_scattered}.items():
        try:
            theirs = peer(uv)
        except (ImportError, AttributeError, TypeError) as error:
            missing(f"scattered, {name}", error)
            continue
        compare(lambda: s(u, v), theirs, name=f"scattered, {name}", pairs=5)  # type: ignore[arg-type]


if __name__ == "__main__":
    main()
