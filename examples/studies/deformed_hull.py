"""The canoe body as a mesh of another program, faired by free-form deformation.

The mesh has neither curves nor parameters: five variables of a B-spline box move it. Least wetted
area at fixed displacement and centre of buoyancy, by exact derivatives. `python deformed_hull.py`
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import moldloft
from moldloft import study
from moldloft.deformation import Box, Deformation

HERE = Path(__file__).parent


def deformation(folder: Path) -> Deformation:
    """The box around the fore body, mid body and aft body below the deck edge."""
    mesh = folder / "canoe.stl"
    moldloft.load(HERE / "canoe.sdl").write(mesh)
    # Two layers at both ends and at the deck: stem, transom and deck line stay, tangents too.
    box = Box((0.4, -1.7, -0.8), np.diag([9.4, 3.4, 1.6]), (9, 7, 5), 3, ((2, 2), (0, 0), (0, 2)))
    variables = [
        box.move(f"beam_{name}", np.s_[row, 4:, 1:3], "y", low=-0.3, high=0.3)
        for name, row in (("fore", 3), ("mid", 4), ("aft", 5))
    ]
    variables += [
        box.move(f"keel_{name}", np.s_[rows, :, 0], "z", low=-0.2, high=0.2)
        for name, rows in (("fore", slice(2, 5)), ("aft", slice(5, 7)))
    ]
    return Deformation.of_file(mesh, variables, symmetry="y", file_units="m")


def best(folder: Path) -> tuple[study.Optimum, dict[str, float]]:
    """The optimum, and the numbers of the undeformed hull."""
    program = folder / "deformed.sdl"
    program.write_text(deformation(folder).text)
    outputs = {
        "area": "hydrostatics.wetted_area",
        "volume": "hydrostatics.volume",
        "lcb": "hydrostatics.lcb",
    }
    model = moldloft.load(program)
    drawn = {name: float(model.eval(text)) for name, text in outputs.items()}
    definition = study.Study(
        model=program,
        inputs=tuple(study.Input(name) for name in model.params),
        outputs=outputs,
        constraints=(
            study.Bound("displacement", "volume", drawn["volume"], drawn["volume"]),
            study.Bound("centre", "lcb", drawn["lcb"], drawn["lcb"]),
        ),
        goal=study.Goal((study.Objective("area"),), evaluations=40, tolerance=1e-7),
        folder=folder,
    )
    return study.optimize(definition, folder / "deformed.sqlite"), drawn


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        found, drawn = best(Path(place))
        print("drawn  ", drawn)
        print("optimum", found.outputs, "\nat", found.inputs)
        if len(sys.argv) > 1:
            model = moldloft.load(Path(place) / "deformed.sdl")
            model.set(found.inputs)
            model.write(sys.argv[1])
