"""CAD and mesh files of public repositories, by our readers and by other programs.

    python tests/public_files.py FOLDER [--only TEXT] [--seconds 120] [--measure] > rows.txt

`public_files.tsv` beside this script lists repository, commit, path, SHA-256 and size of each file,
and what OCCT finds in it: solids, faces, area in mm² and, if every face is of a closed solid, the
volume in mm³. The files are not in the repository: FOLDER/OWNER/NAME/PATH is where they are
expected, other contents are named and skipped. `--measure` writes OCCT's figures anew.

One line for each CAD file: the outcome, our faces, the differences of exact area and volume and of
those of panels, whether the panels are closed, seconds of import (processor time of this process,
without OCCT's), and size of the program relative to the file. Outcomes are `same`; `differs`, if
exact area or volume is more than 1e-6 off, or panels more than 1e-3; `open`, if panels of closed
solids are open; `refused`, `died` and `late`. Remarks follow. Meshes are compared with trimesh, as
by `mesh_twins.py`. The exit status is 1 if a file with faces gives nothing.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import json
import os
import resource
import signal
import subprocess
import sys
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

TABLE = Path(__file__).with_suffix(".tsv")

CAD = (".step", ".stp", ".stpz", ".iges", ".igs", ".brep", ".3dm")

#: Largest relative differences of exact figures, and of panels.
EXACT, PANELS = 1e-6, 1e-3


def listed() -> list[list[str]]:
    """The rows of the table."""
    rows = [line.split("\t") for line in TABLE.read_text().splitlines()]
    return [row for row in rows if not row[0].startswith("#")]


def by_occt(path: Path) -> dict[str, Any]:
    """Solids, faces, area and volume, in millimetres."""
    sys.path.insert(0, str(Path(__file__).parent / "python" / "helpers"))
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.BRepGProp import BRepGProp
    from OCP.BRepTools import BRepTools
    from OCP.GProp import GProp_GProps
    from OCP.TopAbs import TopAbs_FACE, TopAbs_SHELL, TopAbs_SOLID
    from OCP.TopoDS import TopoDS_Shape

    from cad_reading import read
    from moldloft.cad.occt import _quiet
    from moldloft.cad.sewing import faces_of

    if path.suffix == ".3dm":
        return {}
    with _quiet():
        if path.suffix == ".brep":
            shape = TopoDS_Shape()
            BRepTools.Read_s(shape, str(path), BRep_Builder())
        else:
            shape = read(path, unit=1e-3, accuracy=1e-2).shape
    faces, solids = faces_of(shape, TopAbs_FACE), faces_of(shape, TopAbs_SOLID)
    area = 0.0
    for face in faces:
        figures = GProp_GProps()
        BRepGProp.SurfaceProperties_s(face, figures, 1e-9)
        area += figures.Mass()
    held = sum(len(faces_of(solid, TopAbs_FACE)) for solid in solids)
    closed = all(BRep_Tool.IsClosed_s(s) for solid in solids for s in faces_of(solid, TopAbs_SHELL))
    volume = None
    if faces and held == len(faces) and closed:
        volume = 0.0
        for solid in solids:
            figures = GProp_GProps()
            BRepGProp.VolumeProperties_s(solid, figures, 1e-9, False, False)
            volume += figures.Mass()
    return {"solids": len(solids), "faces": len(faces), "area": area, "volume": volume}


def spent() -> float:
    """Seconds of processor time of this process and its ended children."""
    return sum(os.times()[:4])


def by_us(path: Path) -> dict[str, Any]:
    """What becomes of a file as a model, in millimetres."""
    import moldloft
    from moldloft.cad.importing import imported

    began = spent()
    try:
        text, model, remarks = imported(path, units="mm")
    except moldloft.Error as error:
        return {"refused": str(error).splitlines()[0][:300]}
    found: dict[str, Any] = {
        "seconds": spent() - began,
        "program": len(text) / path.stat().st_size,
        "remarks": remarks,
    }
    mesh = model.mesh()
    names = list(dict.fromkeys(patch.name for patch in mesh.patches))
    found |= {"faces": len(names), "closed": bool(mesh.closed and names)}
    found |= {"panel_area": mesh.area, "panel_volume": mesh.volume}
    found["area"] = sum(model[name].area for name in names)
    if found["closed"]:
        level = float(mesh.vertices[:, 2].max())
        size = float((mesh.vertices.max(axis=0) - mesh.vertices.min(axis=0)).max())
        with contextlib.suppress(moldloft.Error):
            found["volume"] = model.hydrostatics(level=level + size).volume
    return found


#: How long a file waits for its processor time on a busy machine.
PATIENCE = 10


def asked(task: str, path: Path, seconds: float) -> dict[str, Any]:
    """The answer of another process, which ends after so many seconds of processor time."""
    command = [sys.executable, __file__, f"--{task}", str(path), "--seconds", str(seconds)]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=PATIENCE * seconds, check=False
        )
    except subprocess.TimeoutExpired:
        return {"late": seconds}
    if done.returncode == -signal.SIGXCPU:
        return {"late": seconds}
    if done.returncode:
        said = done.stderr.strip().splitlines() or [f"status {done.returncode}"]
        return {"died": said[-1][:300]}
    answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return answer


def off(ours: float | None, theirs: float | None) -> float | None:
    """The relative difference of two figures, if both are known."""
    if ours is None or theirs is None or not theirs:
        return None
    return ours / theirs - 1


def judged(ours: dict[str, Any], known: dict[str, float | None]) -> tuple[str, str]:
    """An outcome, and the figures of its line."""
    for outcome in ("refused", "died", "late"):
        if outcome in ours:
            return outcome, str(ours[outcome])
    exact = [off(ours.get(k), known[k]) for k in ("area", "volume")]
    panels = [off(ours.get(f"panel_{k}"), known[k]) for k in ("area", "volume")]
    near = all(d is None or abs(d) <= EXACT for d in exact)
    near = near and all(d is None or abs(d) <= PANELS for d in panels)
    outcome = "same" if near else "differs"
    if known["volume"] is not None and not ours["closed"]:
        outcome = "open"
    shown = ["-" if d is None else f"{d:+.1e}" for d in (*exact, *panels)]
    figures = f"{ours['faces']} of {known['faces']} faces, exact {' '.join(shown[:2])}, "
    figures += f"panels {' '.join(shown[2:])}, {'closed' if ours['closed'] else 'open'}, "
    figures += f"{ours['seconds']:.1f} s, {ours['program']:.2f}"
    return outcome, "; ".join([figures, *ours["remarks"]])


def mesh_outcome(path: Path) -> tuple[str, str]:
    """A mesh beside trimesh."""
    from mesh_twins import compared

    return compared(path)


def main(folder: Path, only: str, seconds: float, measure: bool) -> int:
    """Compares the files of the table that are in the folder."""
    warnings.simplefilter("ignore")
    counts: Counter[str] = Counter()
    lost = False
    kept = [line for line in TABLE.read_text().splitlines() if line.startswith("#")]
    for row in listed():
        repository, _, name, digest, _, *known = row
        path = folder / repository / name
        label = f"{repository}/{name}"
        wanted = only in label
        if wanted and not path.is_file():
            wanted = False
            counts["missing"] += 1
        elif wanted and hashlib.sha256(path.read_bytes()).hexdigest() != digest:
            wanted = False
            print(f"another file: {label}")
        is_cad = path.suffix.lower() in CAD
        if wanted and measure and is_cad:
            found = asked("occt", path, seconds)
            known = [str(found.get(k, "")) for k in ("solids", "faces", "area", "volume")]
            row[5:] = [text.replace("None", "") for text in known]
            print(f"{label}: {found}", flush=True)
        elif wanted and not is_cad:
            outcome, why = mesh_outcome(path)
            counts[outcome] += 1
            print(f"{outcome}: {label}: {why[:200]}", flush=True)
        elif wanted:
            keys = ("solids", "faces", "area", "volume")
            figures = dict(zip(keys, (float(x) if x else None for x in known), strict=True))
            outcome, why = judged(asked("ours", path, seconds), figures)
            counts[outcome] += 1
            lost = lost or (outcome in ("refused", "died", "late") and bool(figures["faces"]))
            print(f"{outcome}: {label}: {why}", flush=True)
        kept.append("\t".join(row))
    if measure:
        TABLE.write_text("\n".join(kept) + "\n")
    for outcome, count in sorted(counts.items()):
        print(f"{count:5} {outcome}")
    return int(lost)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, nargs="?")
    parser.add_argument("--only", default="", help="files whose name contains this")
    parser.add_argument(
        "--seconds", type=float, default=120.0, help="of processor time for each file"
    )
    parser.add_argument("--measure", action="store_true", help="write OCCT's figures anew")
    parser.add_argument("--occt", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--ours", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.occt or given.ours:
        resource.setrlimit(resource.RLIMIT_CPU, (int(given.seconds), int(given.seconds) + 5))
        answer = by_occt(given.occt) if given.occt else by_us(given.ours)
        print(json.dumps(answer))
        sys.exit(0)
    if not given.folder:
        parser.error("a folder is needed")
    sys.exit(main(given.folder, given.only, given.seconds, given.measure))
