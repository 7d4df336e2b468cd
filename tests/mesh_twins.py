"""Mesh files of other programs, by our readers and by trimesh: the same triangles, or both refuse.

    python tests/mesh_twins.py FOLDER [...] > table.txt

One line for each file whose outcomes differ, and the counts of all outcomes. Compared are the
number of triangles and the area, and of closed meshes the volume, without triangles of two equal
corners. trimesh keeps y up in GLB files, which area and volume do not see. The exit status is 1
where both read a file and the results differ, or our reader raises an error that is not its own.
Meshes are not in the repository: those of trimesh, assimp, meshio, common-3d-test-models and
libigl-tests-data serve.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import sys
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

import moldloft
from moldloft import overlays

ENDINGS = ("stl", "obj", "ply", "off", "glb", "3mf")
LARGEST = 20 << 20

#: Relative difference of areas and volumes: single precision, and sums in another order.
NEAR = 1e-5


def figures(corners: np.ndarray) -> tuple[int, float, float]:
    """Number, area and signed volume of triangles ``(n, 3, 3)`` with three different corners."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    kept = (a != b).any(axis=1) & (b != c).any(axis=1) & (c != a).any(axis=1)
    a, b, c = a[kept], b[kept], c[kept]
    normals = np.cross(b - a, c - a)
    area = float(np.linalg.norm(normals, axis=1).sum() / 2)
    return len(a), area, float(np.einsum("ij,ij->", a, normals) / 6)


def ours(path: Path) -> tuple[int, float, float]:
    """By our reader; a quadrilateral is two triangles."""
    found = overlays.read(path)
    corners = found.points[found.faces.astype(np.int64)]
    four = (corners[:, 2] != corners[:, 3]).any(axis=1)
    return figures(np.concatenate([corners[:, :3], corners[four][:, [0, 2, 3]]]))


def theirs(path: Path) -> tuple[int, float, float]:
    """By trimesh, without its repairs."""
    import trimesh

    scene: Any = trimesh.load_scene(path, process=False, skip_materials=True)
    mesh = scene.to_mesh()
    return figures(np.asarray(mesh.vertices, dtype=np.float64)[np.asarray(mesh.faces)])


def closed(path: Path) -> bool:
    """True if trimesh finds the mesh closed once its vertices are merged."""
    import trimesh

    mesh: Any = trimesh.load_scene(path).to_mesh()
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    return bool(mesh.is_watertight)


def compared(path: Path) -> tuple[str, str]:
    """An outcome, and what there is to say of it."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            own: tuple[int, float, float] | str = ours(path)
        except moldloft.Error as error:
            own = str(error).splitlines()[0]
        except Exception as error:
            return "ERROR", f"{type(error).__name__}: {error}"
        try:
            other: tuple[int, float, float] | str = theirs(path)
            if not other[0]:
                other = "no triangles"
        except Exception as error:
            # Its loaders raise what their parsers meet.
            other = f"{type(error).__name__}: {error}"
    if isinstance(own, str):
        return ("both refuse" if isinstance(other, str) else "refused here"), own
    if isinstance(other, str):
        return "read here only", other.splitlines()[0] if other else ""
    near = [
        abs(x - y) <= NEAR * max(abs(x), abs(y), 1e-300) for x, y in zip(own, other, strict=True)
    ]
    if not near[1] or (not near[2] and closed(path)):
        return "DIFFERS", f"{own} here, {other} by trimesh"
    return ("the same" if own[0] == other[0] else "the same area"), f"{own[0]} and {other[0]}"


def main(folders: list[Path]) -> int:
    """Compares all mesh files below the folders."""
    warnings.simplefilter("ignore")
    counts: Counter[tuple[str, str]] = Counter()
    for folder in folders:
        for path in sorted(folder.rglob("*")):
            ending = path.suffix.lower().lstrip(".")
            if ending not in ENDINGS or not path.is_file() or path.stat().st_size > LARGEST:
                continue
            outcome, why = compared(path)
            counts[ending, outcome] += 1
            if outcome != "the same":
                print(f"{outcome}: {path}: {why[:200]}", flush=True)
    for (ending, outcome), count in sorted(counts.items()):
        print(f"{ending:5}{outcome:16}{count:5}")
    return int(any(outcome in ("DIFFERS", "ERROR") for _, outcome in counts))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folders", nargs="+", type=Path)
    sys.exit(main(parser.parse_args().folders))
