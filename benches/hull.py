"""The hull of Table 2 after an edit of one coordinate, gridded 51 x 101, beside its peers.

Ours evaluates points and unit normals from Python through the whole model (direct edit, graph,
loft, grid); the peers evaluate points only. Run with `python benches/hull.py`; peers that are not
installed are named.
"""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
from pairs import compare, missing

import moldloft

NU, NV = 51, 101
STEM = np.array([[0, 0, 3.6], [1.367, 0, 0.602], [2.324, 0, -0.8], [3, 0, -0.9]])
MIDSHIP = np.array([[15, 4.815, 2.56], [15, 5.046, 0.628], [15, 3.603, -0.87], [15, 0, -1.175]])
TRANSOM = np.array([[30, 3.5, 2.76], [30, 3.5, 1.32], [30, 2.5, 0.12], [30, 0, 0.12]])
EDITS = itertools.cycle(5.046 + 1e-3 * k for k in range(97))


def master_basis(t: np.ndarray) -> np.ndarray:
    """Clamped uniform quadratic B-splines of four points, knots 0 0 0 1/2 1 1 1."""
    from scipy.interpolate import BSpline

    knots = np.array([0, 0, 0, 0.5, 1, 1, 1.0])
    return BSpline.design_matrix(np.minimum(t, 1 - 1e-16), knots, 2).toarray()


def numpy_grid(arranged: bool = False) -> object:
    """The product of cached basis matrices: the tensor surface of the same net.

    It is another surface than ours, whose loft follows the chord lengths at every u; it stands for
    what NumPy needs at least. ``arranged`` orders the product by hand for the fewest operations.
    """
    u = master_basis(np.linspace(0, 1, NU))
    t = np.linspace(0, 1, NV)
    # The parabola through three masters at v = 0, 1/2, 1.
    v = np.stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)], axis=1)
    net = np.stack([STEM, MIDSHIP, TRANSOM], axis=1)

    def product() -> np.ndarray:
        net[1, 1, 1] = next(EDITS)
        return np.einsum("ia,jb,abc->ijc", u, v, net, optimize=True)

    def by_hand() -> np.ndarray:
        net[1, 1, 1] = next(EDITS)
        along = (u @ net.reshape(4, 9)).reshape(NU, 3, 3)
        return v @ along

    assert np.allclose(product(), by_hand(), atol=1e-2)
    return by_hand if arranged else product


def splipy_grid() -> object:
    """Splipy: three curves, a loft, a grid."""
    import splipy
    import splipy.surface_factory as factory

    basis = splipy.BSplineBasis(3, [0, 0, 0, 0.5, 1, 1, 1])
    u, v = np.linspace(0, 1, NU), np.linspace(0, 1, NV)

    def work() -> np.ndarray:
        midship = MIDSHIP.copy()
        midship[1, 1] = next(EDITS)
        curves = [splipy.Curve(basis, net) for net in (STEM, midship, TRANSOM)]
        return factory.loft(curves)(u, v)

    return work


def splinepy_grid() -> object:
    """Splinepy: own loft matrix, then sampling."""
    import splinepy

    def work() -> np.ndarray:
        midship = MIDSHIP.copy()
        midship[1, 1] = next(EDITS)
        middle = 2 * midship - 0.5 * (STEM + TRANSOM)
        points = np.concatenate([STEM, middle, TRANSOM])
        surface = splinepy.BSpline([2, 2], [[0, 0, 0, 0.5, 1, 1, 1], [0, 0, 0, 1, 1, 1]], points)
        return surface.sample([NU, NV])

    return work


def ocp_grid() -> object:
    """OCCT through cadquery-ocp: ThruSections, then one call a point."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
    from OCP.BRepOffsetAPI import BRepOffsetAPI_ThruSections
    from OCP.collections import Array1_double, Array1_gp_Pnt, Array1_int
    from OCP.Geom import Geom_BSplineCurve
    from OCP.gp import gp_Pnt
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    def wire(net: np.ndarray) -> object:
        points = Array1_gp_Pnt(1, 4)
        for k, p in enumerate(net):
            points.SetValue(k + 1, gp_Pnt(*map(float, p)))
        knots, counts = Array1_double(1, 3), Array1_int(1, 3)
        for k, (t, m) in enumerate([(0.0, 3), (0.5, 1), (1.0, 3)]):
            knots.SetValue(k + 1, t)
            counts.SetValue(k + 1, m)
        edge = BRepBuilderAPI_MakeEdge(Geom_BSplineCurve(points, knots, counts, 2)).Edge()
        return BRepBuilderAPI_MakeWire(edge).Wire()

    def work() -> np.ndarray:
        midship = MIDSHIP.copy()
        midship[1, 1] = next(EDITS)
        loft = BRepOffsetAPI_ThruSections(False, False)
        for net in (STEM, midship, TRANSOM):
            loft.AddWire(wire(net))
        loft.Build()
        face = TopoDS.Face(TopExp_Explorer(loft.Shape(), TopAbs_FACE).Current())
        surface = BRep_Tool.Surface_s(face)
        u0, u1, v0, v1 = surface.Bounds()
        out = np.empty((NU, NV, 3))
        p = gp_Pnt()
        for i, u in enumerate(np.linspace(u0, u1, NU)):
            for j, v in enumerate(np.linspace(v0, v1, NV)):
                surface.D0(float(u), float(v), p)
                out[i, j] = p.X(), p.Y(), p.Z()
        return out

    return work


def main() -> None:
    """Print a line for each peer."""
    model = moldloft.load(Path(__file__).parent / "hull.sdl")
    hull = model["hull"]
    midship = model["P22"]

    def ours() -> object:
        midship.y = next(EDITS)
        return hull.grid(NU, NV, normals=True)

    peers = {
        "NumPy, cached basis matrices": (numpy_grid, 1),
        "NumPy, product arranged by hand": (lambda: numpy_grid(arranged=True), 1),
        "splipy": (splipy_grid, 1),
        "splinepy": (splinepy_grid, 1),
        "OCP (ThruSections, D0)": (ocp_grid, 1),
    }
    for name, (peer, inner) in peers.items():
        try:
            theirs = peer()
        except ImportError as error:
            missing(name, error)
            continue
        compare(ours, theirs, name=name, inner=inner)  # type: ignore[arg-type]


if __name__ == "__main__":
    main()
