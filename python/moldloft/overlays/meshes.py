"""Meshes: STL, OBJ, PLY and OFF by our own readers, others by meshio (MIT); panel files."""

from __future__ import annotations

from contextlib import redirect_stderr, redirect_stdout
from importlib import import_module
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.errors import Error, FileError
from moldloft.overlays.overlay import Overlay
from moldloft.overlays.panel_files import read_panels
from moldloft.storage import read_bytes

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["mesh", "panels", "surface"]

_CORNERS = {"triangle": 3, "triangle6": 3, "quad": 4, "quad8": 4, "quad9": 4}
"""Corners of surface elements by meshio's names: nodes on edges are left out."""

_MARKS = {"msh": (b"$EndNodes", b"$EndElements")}
"""Marks of a complete file, without some of which meshio does not return."""


def surface(name: str, ending: str, data: bytes) -> Overlay:
    """Points and faces of an STL, OBJ, PLY or OFF file.

    Parameters
    ----------
    name
        The name of the file, for the overlay.
    ending
        Its ending.
    data
        Its bytes.
    """
    points, faces, groups, remarks = _core.read_mesh(data, ending)
    return Overlay(name, points, faces, tuple(groups), remarks=tuple(remarks))


def mesh(path: Path, ending: str) -> Overlay:
    """Points and surface elements of a mesh file, by meshio.

    Parameters
    ----------
    path
        The file.
    ending
        Its ending.
    """
    meshio = _module("meshio", "meshio")
    data = read_bytes(path)
    for mark in _MARKS.get(ending, ()):
        if mark not in data:
            raise FileError(
                f"`{mark.decode()}` is missing; the file is of another kind, or cut short"
            )
    kind = {"msh": "gmsh"}.get(ending, ending)
    try:
        # It prints its remarks; what is wrong is raised.
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
            found = meshio.read(path, file_format=kind)
    except (Exception, SystemExit) as error:
        # meshio ends the program for some files, and raises what its parsers meet.
        said = str(error) or type(error).__name__
        raise FileError(f"not a file that meshio takes, or cut short: {said}") from error
    blocks: list[NDArray[np.int64]] = []
    groups: list[tuple[str, int, int]] = []
    names = {int(tag): name for name, (tag, dim) in found.field_data.items() if dim == 2}
    physical = found.cell_data.get("gmsh:physical")
    start = 0
    left = 0
    for k, block in enumerate(found.cells):
        corners = _CORNERS.get(block.type)
        if corners is None:
            left += len(block.data) if block.type not in ("vertex", "line", "line3") else 0
            continue
        own = np.asarray(block.data, dtype=np.int64)[:, :corners]
        tags = np.zeros(len(own)) if physical is None else np.asarray(physical[k])
        order = np.argsort(tags, kind="stable")
        own, tags = own[order], tags[order]
        for tag in np.unique(tags):
            count = int((tags == tag).sum())
            groups.append((names.get(int(tag), "faces"), start, start + count))
            start += count
        blocks.append(np.concatenate([own, own[:, -1:]], axis=1)[:, :4])
    points = np.asarray(found.points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise FileError(f"points are of shape (n, 3), not {points.shape}")
    points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    faces = np.concatenate(blocks) if blocks else np.empty((0, 4), dtype=np.int64)
    remarks = (f"{left} elements that are not faces are omitted",) if left else ()
    return _checked(path.name, points, faces, tuple(groups), remarks)


def panels(path: Path, ending: str) -> Overlay:
    """The panels of a file for a flow solver, with their images.

    Parameters
    ----------
    path
        The file.
    ending
        Its ending.
    """
    points, faces, remarks = read_panels(read_bytes(path), ending)
    return _checked(path.name, points, faces, (("panels", 0, len(faces)),), tuple(remarks))


def _checked(
    name: str,
    points: NDArray[np.float64],
    faces: NDArray[np.int64],
    groups: tuple[tuple[str, int, int], ...],
    remarks: tuple[str, ...],
) -> Overlay:
    if not np.isfinite(points).all():
        raise FileError("a coordinate is not a finite number")
    if faces.size and not (faces.min() >= 0 and faces.max() < len(points)):
        raise FileError(f"a face has a vertex number beyond the {len(points)} vertices")
    return Overlay(name, points, faces.astype(np.uint32), groups, remarks=remarks)


def _module(name: str, install: str) -> Any:
    try:
        return import_module(name)
    except ImportError as error:
        raise Error(f"reading this needs {name}: pip install {install} ({error})") from error
