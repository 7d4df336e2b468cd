"""The least wetted area of a yacht's canoe body by 400 offsets, in reverse mode.

A B-spline surface up to the water plane, whose half-breadths at 20 stations and 20 waterlines are
the inputs; displacement, centre of buoyancy, profile and length are fixed. The derivatives of all
outputs by all inputs take a few evaluations: the area's by reverse mode, those of displacement and
centre of buoyancy by weights on the vertices of the mesh, as an adjoint solver has them.
`python fine_hull.py [trust-constr]`
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import moldloft
from moldloft import study

HERE = Path(__file__).parent

#: Stations and waterlines with free offsets.
STATIONS, WATERLINES = 20, 20

LENGTH, HALF_BREADTH, DRAUGHT = 10.0, 1.5, 0.7

#: Half-breadths stay within these shares of those that are drawn.
NARROW, WIDE = 0.5, 1.5


def offsets() -> np.ndarray:
    """The control points as drawn, ``(stations, waterlines, 3)``, ends and keel included."""
    t, s = np.meshgrid(
        np.linspace(-1, 1, STATIONS + 2), np.linspace(0, 1, WATERLINES + 1), indexing="ij"
    )
    half = HALF_BREADTH * (1 - t**2) * np.sin(np.pi / 2 * s) ** 0.8
    depth = DRAUGHT * (1 - t**4) * np.cos(np.pi / 2 * s)
    return np.stack([LENGTH / 2 * (1 + t), half, -depth], axis=2)


def program() -> str:
    """The model: half of the hull, mirrored in y = 0, water at z = 0."""
    points = offsets()
    lines = ['Model info(symmetry = "y", units = "m");']
    for i, station in enumerate(points.tolist()):
        lines += [f"AbsPoint P{i}_{j}({x!r}, {y!r}, {z!r});" for j, (x, y, z) in enumerate(station)]
    rows, columns = points.shape[:2]
    names = ", ".join(f"P{i}_{j}" for i in range(rows) for j in range(columns))
    size = "divisions = {24, 60}"
    lines.append(f"BSurf hull({{{names}}}, nu = {rows}, nv = {columns}, {size});")
    return "\n".join(lines)


def volume_and_centre(model: moldloft.Model) -> dict[str, Any]:
    """Displacement and its centre along x, each with its derivatives by the vertices.

    The integrals of y and x y over the panels, two triangles each, projected on the centre plane.
    """
    mesh = model.mesh()
    corners = np.concatenate([mesh.faces[:, [0, 1, 2]], mesh.faces[:, [0, 2, 3]]])
    x, y, z = np.moveaxis(mesh.vertices[corners], 2, 0)
    # Twice the projected area, and its derivatives by the corners.
    ahead, behind = np.roll(x, -1, 1) - np.roll(x, 1, 1), np.roll(z, -1, 1) - np.roll(z, 1, 1)
    double = np.sum(z * np.roll(x, -1, 1) - x * np.roll(z, -1, 1), axis=1)[:, None]
    of_y, of_xy = y.sum(1, keepdims=True), (x * y).sum(1, keepdims=True)
    both = of_xy + x.sum(1, keepdims=True) * of_y
    volume, moment = float((double * of_y).sum() / 6), float((double * both).sum() / 24)
    slopes = []
    for shape, by_x, by_y, scale in (
        (of_y, 0 * x, 1 + 0 * x, 6),
        (both, y + of_y, x + x.sum(1, keepdims=True), 24),
    ):
        by = np.stack([double * by_x - behind * shape, double * by_y, ahead * shape], axis=2)
        row = np.zeros_like(mesh.vertices)
        np.add.at(row, corners, by / scale)
        slopes.append(row)
    centre = moment / volume
    return {
        "volume": (2 * volume, {"mesh": 2 * slopes[0]}),
        "lcb": (centre, {"mesh": (slopes[1] - centre * slopes[0]) / volume}),
    }


def definition(folder: Path, method: str = "slsqp", evaluations: int = 100) -> study.Study:
    """The study; writes its model into the folder."""
    place = folder / "fine_hull.sdl"
    place.write_text(program())
    drawn = volume_and_centre(moldloft.load(place))
    fixed = {name: float(value) for name, (value, _) in drawn.items()}
    rows = offsets()[1:-1, 1:, 1]
    return study.Study(
        model=place,
        inputs=tuple(
            study.Input(f"P{i}_{j}.y", NARROW * y, WIDE * y)
            for i, row in enumerate(rows.tolist(), start=1)
            for j, y in enumerate(row, start=1)
        ),
        outputs={"area": "2 * mesh.area"},
        analyses=(
            study.Analysis(
                "shape", f"{Path(__file__).name}:volume_and_centre", tuple(fixed), adjoint=True
            ),
        ),
        constraints=tuple(study.Bound(f"fixed {n}", n, v, v) for n, v in fixed.items()),
        goal=study.Goal((study.Objective("area"),), method, evaluations, tolerance=1e-7),
        folder=HERE,
    )


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        stated = definition(Path(place), *sys.argv[1:2])
        best = study.optimize(stated, Path(place) / "fine_hull.sqlite")
        print(best.outputs, best.message, f"{best.evaluations} evaluations")
