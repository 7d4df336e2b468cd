"""The volume of a part of a sketch in five ways, and by OCCT."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import moldloft
from moldloft import Sketch
from moldloft.cad.importing import load_cad
from sketch_machined import numbered
from sketch_ordinary import read_volume

#: Greatest distance of the mesh from the surfaces.
MESH = 1e-2

#: The scale of all lengths of a part: a number of it, which is 1.
SCALE = "TABLE.K"


def scaled(text: str) -> tuple[str, list[float]]:
    """As `numbered`, with all lengths multiplied by a number: a part of any shape grows with it."""
    text, values = numbered(text)
    text = text.replace("SKETCH TABLE\n", "SKETCH TABLE\nVARIABLE K 1\n", 1)
    text = re.sub(r'"(TABLE\.N\d+)"', rf'"{SCALE}*\1"', text)
    # Angles are not lengths.
    return re.sub(rf'(ROTATE \w+ \w ")({SCALE}\*)', r"\1", text), values


def changes(old: list[float], new: list[float]) -> str:
    """The commands that change a part's numbers."""
    changed = (j for j, x in enumerate(new) if x != old[j])
    return "\n".join(f"SET TABLE.N{j} {new[j]!r}" for j in changed)


def apart(sketch: Sketch, name: str, folder: Path) -> dict[str, float]:
    """What each way differs by from MEASURE, relative to the volume; of the mesh, to its bound.

    The volume is homogeneous of degree three in the lengths, so its derivative by their scale is
    three times the volume (Euler), whatever touches. OCCT's way is the STEP file's.
    """
    found = sketch.objects[name]
    volume, area = found["volume"], found["area"]
    gradient = sketch.gradient([SCALE], name=name)
    differences = {
        "derivative": gradient.volume[0] / (3 * volume) - 1,
        "derivative of the area": gradient.area[0] / (2 * area) - 1,
    }
    (folder / "part.skt").write_text(sketch.text)
    (folder / "m.sdl").write_text('load "part.skt";')
    model = moldloft.load(folder / "m.sdl")
    name = name.lower()
    differences["model"] = model.eval(f"{name}.volume") / volume - 1
    differences["set"] = model.eval(f"volume({name}.body)") / volume - 1
    mesh = model.mesh(tolerance=MESH)
    assert mesh.closed
    differences["mesh"] = (mesh.volume - volume) / (1.01 * MESH * area)
    path = folder / "part.step"
    path.write_bytes(sketch.run(f"EXPORT STEP {name} part.step")[-1].file[1])
    differences["OCCT"] = read_volume(path) / volume - 1
    step = read(path)
    if step is not None:
        top = float(mesh.vertices.max()) + 1.0
        try:
            differences["STEP"] = step.hydrostatics(level=top).volume / volume - 1
        except moldloft.ModelError as error:
            # Loops within a chord of touching are read, but do not join their neighbours.
            assert "the skin is open" in str(error), str(error)
    return differences


def read(path: Path) -> moldloft.Model | None:
    """The file as a model; none where a face's loops touch, which is said of that face."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return load_cad(path, units="mm")
        except UserWarning as remark:
            said = str(remark)
            assert re.search(r"loop \d+ (crosses loop \d+|is not inside the outer one)", said), said
            return None


#: What the ways may differ by.
BOUNDS = {"mesh": 1.0, "OCCT": 1e-7, "STEP": 1e-9}

#: In files, edges between round faces about different axes are splines within 1e-7.
SPLINES = {**BOUNDS, "STEP": 1e-7}


def wrong(differences: dict[str, float], bounds: dict[str, float] = BOUNDS) -> dict[str, float]:
    """Those beyond their bounds, or not known."""
    return {k: x for k, x in differences.items() if not abs(x) <= bounds.get(k, 1e-9)}
