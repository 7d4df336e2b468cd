"""Nearest points of the 20 x 20 bicubic surface for many points at once, beside its peers.

Run with `python benches/nearest.py`; peers that are not installed are named
(`pip install geomcore splinepy cadquery-ocp-novtk`). The search structures are built beforehand.
Points are lifted by 0.004 along the normal, as in the comparison of the peers, and anywhere around.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pairs import compare, missing, timed
from surface import KNOTS, NET, N, surface

COUNT = 1000
RNG = np.random.default_rng(11)


def lifted() -> np.ndarray:
    """Points near the surface."""
    s = surface()
    look = s.look(np.sort(RNG.random(32)), np.sort(RNG.random(32)))
    return (look.points + 0.004 * look.normals).reshape(-1, 3)[:COUNT]


def geomcore_nearest(points: np.ndarray) -> Callable[[], object]:
    """Geomcore, a list of points in and a list of projections out."""
    from geomcore import Point
    from geomcore.surfaces import BSplineSurface

    poles = [[Point(*p) for p in row] for row in NET.tolist()]
    knots, counts = np.unique(KNOTS, return_counts=True)
    once = (knots.tolist(), counts.tolist())
    spline = BSplineSurface(3, 3, poles, *once, *once, False, False)
    objects = [Point(*p) for p in points.tolist()]
    return lambda: spline.project_points(objects)


def splinepy_nearest(points: np.ndarray) -> Callable[[], object]:
    """Splinepy, an array in and an array out, one thread, starts on a 40 x 40 grid."""
    import splinepy

    net = NET.transpose(1, 0, 2).reshape(-1, 3)
    spline = splinepy.BSpline([3, 3], [KNOTS.tolist(), KNOTS.tolist()], net)
    spline.proximities(points[:1], initial_guess_sample_resolutions=[40, 40], nthreads=1)
    return lambda: spline.proximities(points, initial_guess_sample_resolutions=[40, 40], nthreads=1)


def occt_surface(net: np.ndarray) -> object:
    """A surface in OCCT."""
    from OCP.collections import Array1_double, Array1_int, Array2_gp_Pnt
    from OCP.Geom import Geom_BSplineSurface
    from OCP.gp import gp_Pnt

    poles = Array2_gp_Pnt(1, N, 1, N)
    for i in range(N):
        for j in range(N):
            poles.SetValue(i + 1, j + 1, gp_Pnt(*net[i, j].tolist()))
    values, counts = np.unique(KNOTS, return_counts=True)
    knots = Array1_double(1, len(values))
    times = Array1_int(1, len(values))
    for i, (value, count) in enumerate(zip(values, counts, strict=True), start=1):
        knots.SetValue(i, float(value))
        times.SetValue(i, int(count))
    return Geom_BSplineSurface(poles, knots, knots, times, times, 3, 3, False, False)


def occt_nearest(points: np.ndarray) -> Callable[[], object]:
    """OCCT, a call for each point."""
    from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
    from OCP.gp import gp_Pnt

    spline = occt_surface(NET)
    objects = [gp_Pnt(*p) for p in points.tolist()]
    return lambda: [GeomAPI_ProjectPointOnSurf(p, spline).LowerDistance() for p in objects]


def main() -> None:
    """Print a line for each case."""
    s = surface()
    s.nearest(NET[0, 0])
    near = lifted()
    wide = RNG.uniform([-2, -2, -3], [11.5, 11.5, 4], (COUNT, 3))
    for name, points in (("near", near), ("anywhere", wide)):
        many = np.tile(points, (100, 1))
        best = min(timed(lambda many=many: s.nearest(many)) for _ in range(7))
        print(f"{name:<34} ours {best / len(many) * 1e6:9.2f} us a point, {len(many)} at once")
    found = s.nearest(near)
    off = abs(found.distances - 0.004) > 1e-9
    print(f"{'':<34} {int(off.sum())} of {COUNT} points near have another foot that is nearer")
    peers = {
        "geomcore": geomcore_nearest,
        "splinepy": splinepy_nearest,
        "OCP": occt_nearest,
    }
    for name, peer in peers.items():
        try:
            theirs = peer(near)
            theirs()
        except (ImportError, AttributeError, TypeError) as error:
            missing(f"{COUNT} points near, {name}", error)
            continue
        compare(lambda: s.nearest(near), theirs, name=f"{COUNT} points near, {name}", pairs=5)


if __name__ == "__main__":
    main()
