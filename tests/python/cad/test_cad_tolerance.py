"""Faces that share an edge in a file are joined along it within the tolerance of the edge.

`MOLDLOFT_SOAK=1` draws 40 pairs.
"""

from __future__ import annotations

import os
import random
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft
import occt_parts

pytest.importorskip("OCP")

ROUNDS = 40 if os.environ.get("MOLDLOFT_SOAK") == "1" else 2


def sheet(rng: random.Random, side: float, gap: float) -> Any:
    """A wavy face from y = 0 to `side`; its edge at y = 0 has a wave of height `gap` more."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.collections import Array2_gp_Pnt
    from OCP.GeomAPI import GeomAPI_PointsToBSplineSurface
    from OCP.gp import gp_Pnt

    count, phase = 9, rng.uniform(0, 3)
    grid = Array2_gp_Pnt(1, count, 1, count)
    for i, x in enumerate(np.linspace(0, 1, count)):
        for j, y in enumerate(np.linspace(0, 1, count)):
            z = 0.1 * np.sin(2 * x) + y * y * 0.2 * np.sin(3 * x + phase)
            z += gap * np.sin(np.pi * x) ** 2 * (1 - y) ** 3
            grid.SetValue(i + 1, j + 1, gp_Pnt(float(x), float(side * y), float(z)))
    surface = GeomAPI_PointsToBSplineSurface(grid).Surface()
    return BRepBuilderAPI_MakeFace(surface, 1e-6).Face()


def sewn(rng: random.Random, gap: float, tolerance: float) -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing

    sewing = BRepBuilderAPI_Sewing(tolerance)
    sewing.Add(sheet(rng, 1.0, 0.0))
    sewing.Add(sheet(rng, -1.0, gap))
    sewing.Perform()
    return sewing.SewedShape()


@pytest.mark.parametrize("seed", range(ROUNDS))
def test_faces_apart_within_the_tolerance_share_vertices(seed: int, tmp_path: Path) -> None:
    from OCP.Interface import Interface_Static

    from moldloft.cad.importing import program

    rng = random.Random(seed)
    gap = rng.uniform(2e-3, 8e-3)
    path = tmp_path / "two.step"
    Interface_Static.SetIVal_s("write.precision.mode", 2)
    Interface_Static.SetRVal_s("write.precision.val", 0.01)
    try:
        occt_parts.write(path, "MM", sewn(rng, gap, 0.02))
    finally:
        Interface_Static.SetIVal_s("write.precision.mode", 0)
    text, remarks = program(path, units="mm")
    (remark,) = (r for r in remarks if "tolerance" in r)
    said = re.search(r"up to ([\d.e-]+) apart", remark)
    assert said is not None and float(said[1]) == pytest.approx(gap, rel=0.05)
    model = moldloft.loads(text)
    mesh = model.mesh()
    one, other = (set(mesh.faces[p.start : p.stop].ravel()) for p in mesh.patches)
    assert len(one & other) > 8
    assert not [d for d in model.diagnostics if "join" in d.id or "apart" in d.id]
