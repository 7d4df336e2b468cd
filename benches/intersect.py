"""Intersections of the 20 x 20 bicubic surface with a plane and a second such surface, with peers.

Run with `python benches/intersect.py`; peers that are not installed are named
(`pip install geomcore cadquery-ocp-novtk`). Shapes are built beforehand, and so is our search
structure.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from nearest import occt_surface
from pairs import compare, missing, timed
from surface import KNOTS, NET, N, surface

import moldloft
from moldloft import kinds as k
from moldloft.builder import Builder

LEVEL = 0.5
SECOND = np.concatenate([NET[..., :2], np.random.default_rng(8).random((N, N, 1))], axis=-1)


def second() -> moldloft.Object:
    """A second surface over the same net."""
    with Builder() as builder:
        k.BSurf("S", SECOND.reshape(-1, 3).tolist(), nu=N, nv=N)
    return builder.model()["S"]


def geomcore_spline(net: np.ndarray) -> object:
    """A surface in geomcore."""
    from geomcore import Point
    from geomcore.surfaces import BSplineSurface

    poles = [[Point(*p) for p in row] for row in net.tolist()]
    knots, counts = np.unique(KNOTS, return_counts=True)
    once = (knots.tolist(), counts.tolist())
    return BSplineSurface(3, 3, poles, *once, *once, False, False)


def geomcore_plane() -> Callable[[], int]:
    """Geomcore, with a bilinear sheet for the plane."""
    from geomcore import Point
    from geomcore.surfaces import BSplineSurface

    spline = geomcore_spline(NET)
    corners = [[Point(x, y, LEVEL) for y in (-1.0, 11.0)] for x in (-1.0, 11.0)]
    ends = ([0.0, 1.0], [2, 2])
    sheet = BSplineSurface(1, 1, corners, *ends, *ends, False, False)
    return lambda: len(spline.intersect(sheet).curves)  # type: ignore[attr-defined]


def geomcore_second() -> Callable[[], int]:
    """Geomcore, both surfaces."""
    first, other = geomcore_spline(NET), geomcore_spline(SECOND)
    return lambda: len(first.intersect(other).curves)  # type: ignore[attr-defined]


def occt_plane() -> Callable[[], int]:
    """OCCT, with a plane."""
    from OCP.Geom import Geom_Plane
    from OCP.GeomAPI import GeomAPI_IntSS
    from OCP.gp import gp_Dir, gp_Pnt

    spline = occt_surface(NET)
    plane = Geom_Plane(gp_Pnt(0, 0, LEVEL), gp_Dir(0, 0, 1))
    return lambda: int(GeomAPI_IntSS(spline, plane, 1e-7).NbLines())


def occt_second() -> Callable[[], int]:
    """OCCT, both surfaces."""
    from OCP.GeomAPI import GeomAPI_IntSS

    first, other = occt_surface(NET), occt_surface(SECOND)
    return lambda: int(GeomAPI_IntSS(first, other, 1e-7).NbLines())


def main() -> None:
    """Print a line for each case."""
    s, other = surface(), second()
    cases: dict[str, Callable[[], moldloft.Intersection]] = {
        f"plane z = {LEVEL}": lambda: s.intersect(f"z={LEVEL}"),
        "a second such surface": lambda: s.intersect(other),
    }
    for name, ours in cases.items():
        found = ours()
        best = min(timed(ours) for _ in range(15))
        points = sum(len(b) for b in found.branches)
        print(
            f"{name:<34} ours {best * 1e3:9.3f} ms, {len(found.branches)} branches of {points} "
            f"points, complete {found.complete}"
        )
    peers = {
        "plane, geomcore": (0, geomcore_plane),
        "plane, OCP": (0, occt_plane),
        "second, geomcore": (1, geomcore_second),
        "second, OCP": (1, occt_second),
    }
    for name, (case, peer) in peers.items():
        ours = list(cases.values())[case]
        try:
            theirs = peer()
            print(f"{name:<34} finds {theirs()} curves")
        except (ImportError, AttributeError, TypeError) as error:
            missing(name, error)
            continue
        compare(ours, theirs, name=name, pairs=5)


if __name__ == "__main__":
    main()
