"""CAD files in, meshed and floated, beside OCCT, CadQuery and meshio, in one script.

    python benches/cad.py [HULL]

Import of 20, 160 and 2 000 faces (STEP: blocks with four bores, no two alike), with OCCT's reading
and CadQuery's; panels of 160 faces within a chord and an angle, and OCCT's; the panels' STL, read
by us and by meshio; hydrostatics of HULL, a STEP or IGES file of a closed hull in metres that
floats at z = 0 (without it the tug of the gallery), and of the cut of OCCT. Least processor time of
three runs, those of child processes included; peers that are not installed are named.
"""

from __future__ import annotations

import os
import random
import sys
import tempfile
import warnings
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import moldloft
from moldloft.cad.importing import load_cad

#: Chord in millimetres and angle in radians of panels.
CHORD, ANGLE = 0.02, 0.2

HULL = Path(__file__).parents[1] / "examples" / "gallery" / "tug.sdl"


def spent() -> float:
    """Processor time of this process and its ended children."""
    return sum(os.times()[:4])


def least(work: Callable[[], object], runs: int = 3) -> float:
    """The least processor time of some runs, in seconds."""
    times = []
    for _ in range(runs):
        began = spent()
        work()
        times.append(spent() - began)
    return min(times)


def row(what: str, ours: float, peers: dict[str, float | None]) -> None:
    """Prints our time, and those of peers with the ratio of ours to theirs."""
    said = [
        f"{name}: not installed" if t is None else f"{name} {t:.3f} s ({ours / t:.1f})"
        for name, t in peers.items()
    ]
    print(f"{what}: ours {ours:.3f} s; {'; '.join(said)}", flush=True)


def blocks(path: Path, count: int) -> Path:
    """So many blocks with four bores each, ten faces a block."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    from moldloft.cad.occt import _quiet

    rng = random.Random(count)
    writer = STEPControl_Writer()
    with _quiet():
        for k in range(count):
            x, y = 150.0 * (k % 20), 150.0 * (k // 20)
            a, b, c = (rng.uniform(60, 100) for _ in range(3))
            shape = BRepPrimAPI_MakeBox(gp_Pnt(x, y, 0), a, b, c).Shape()
            for u in (0.25, 0.75):
                for v in (0.25, 0.75):
                    axis = gp_Ax2(gp_Pnt(x + u * a, y + v * b, -1), gp_Dir(0, 0, 1))
                    bore = BRepPrimAPI_MakeCylinder(axis, rng.uniform(3, 10), 2 * c).Shape()
                    shape = BRepAlgoAPI_Cut(shape, bore).Shape()
            writer.Transfer(shape, STEPControl_AsIs)
        writer.Write(str(path))
    return path


def occt(path: Path) -> Any:
    """The shape that OCCT reads, in millimetres."""
    from OCP.IGESControl import IGESControl_Reader
    from OCP.STEPControl import STEPControl_Reader

    from moldloft.cad.occt import _quiet

    reader: Any = STEPControl_Reader() if path.suffix == ".step" else IGESControl_Reader()
    with _quiet():
        reader.ReadFile(str(path))
        reader.TransferRoots()
    return reader.OneShape()


def imports(folder: Path) -> None:
    """Times of reading, by number of faces."""
    for faces in (20, 160, 2000):
        path = blocks(folder / f"{faces}.step", faces // 10)
        peers: dict[str, float | None] = {
            "OCCT": least(lambda path=path: occt(path)),
            "CadQuery": None,
        }
        if find_spec("cadquery"):
            import cadquery

            peers["CadQuery"] = least(lambda path=path: cadquery.importers.importStep(str(path)))
        ours = least(lambda path=path: load_cad(path, units="mm"), 3 if faces < 1000 else 1)
        row(f"import, {faces} faces", ours, peers)


def meshes(folder: Path) -> None:
    """Times of panels within a chord and an angle, and of reading them as STL."""
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools

    path = folder / "160.step"
    shape = occt(path)
    model = load_cad(path, units="mm")

    def theirs() -> None:
        BRepTools.Clean_s(shape)
        BRepMesh_IncrementalMesh(shape, CHORD, False, ANGLE)

    chords = iter(CHORD * (1 + 1e-9 * k) for k in range(9))
    # Another chord each time, since a mesh is kept.
    ours = least(lambda: model.mesh(tolerance=next(chords), angle=ANGLE))
    count = len(model.mesh(tolerance=CHORD, angle=ANGLE).faces)
    row(f"panels, 160 faces, {count} panels", ours, {"OCCT": least(theirs)})
    (stl,) = model.write(folder / "160.stl", tolerance=CHORD, angle=ANGLE)
    peers: dict[str, float | None] = {"meshio": None}
    if find_spec("meshio"):
        import meshio

        peers["meshio"] = least(lambda: meshio.read(stl))
    row("STL in", least(lambda: moldloft.overlays.read(stl)), peers)


def floated(hull: Path | None, folder: Path) -> None:
    """Times of the volume under water and its centre, of the exact hull."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepGProp import BRepGProp
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
    from OCP.gp import gp_Pnt
    from OCP.GProp import GProp_GProps

    if hull is None:
        (hull,) = moldloft.load(HULL).write(folder / "hull.step")
    model = load_cad(hull)
    shape = occt(hull)
    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    low, high = box.CornerMin(), box.CornerMax()
    below = BRepPrimAPI_MakeBox(
        gp_Pnt(low.X() - 1, low.Y() - 1, low.Z() - 1), gp_Pnt(high.X() + 1, high.Y() + 1, 0)
    ).Shape()
    volumes = [0.0, 0.0]

    def theirs() -> None:
        figures = GProp_GProps()
        BRepGProp.VolumeProperties_s(
            BRepAlgoAPI_Common(shape, below).Shape(), figures, 1e-6, False, False
        )
        volumes[1] = figures.Mass() * 1e-9

    levels = iter(1e-12 * k for k in range(9))

    def ours() -> None:
        volumes[0] = model.hydrostatics(level=next(levels)).volume

    mine = least(ours)
    row(f"hydrostatics, {hull.name}", mine, {"OCCT's cut": least(theirs)})
    print(f"  volumes {volumes[0]:.9g} and {volumes[1]:.9g} m³")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        imports(place)
        meshes(place)
        floated(Path(sys.argv[1]) if len(sys.argv) > 1 else None, place)
