"""Meshes and panel files of other programs as models of one body."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import FileError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.models import Model

__all__ = ["holds_mesh", "mesh_of_file", "mesh_program", "mesh_statement", "read_mesh"]

_ENDINGS = {"stl", "obj", "ply", "off", "msh", "vtk", "vtu", "vtp"}
"""Files of meshes."""

_METRES = {"gdf", "mar", "dat", "pnl", "hst"}
"""Panel files of flow solvers: their numbers are metres."""

_STATED = {"3dm", "3mf", "glb"}
"""Files that state their unit of length."""


def holds_mesh(path: str | os.PathLike[str]) -> bool:
    """True if the extension is that of a readable mesh file.

    Parameters
    ----------
    path
        The file.

    Examples
    --------
    >>> holds_mesh("hull.gdf"), holds_mesh("hull.sdl")
    (True, False)
    """
    ending = Path(path).suffix.lower().lstrip(".")
    return ending in _ENDINGS | _METRES | _STATED


def mesh_program(
    path: str | os.PathLike[str], *, units: str = "", file_units: str = ""
) -> tuple[str, list[str]]:
    """A mesh as a program of one ``MeshBody``, and remarks about omitted or doubtful content.

    Parameters
    ----------
    path
        A file of triangles and quadrilaterals; panel files come with their images in planes of
        symmetry.
    units
        The unit of the model, into which lengths are converted; by default that of the file, and
        metres for 3DM, 3MF and GLB files.
    file_units
        The unit of the file's numbers: m, cm, mm, ft or in. By default metres for panel files, and
        the one that a 3DM, 3MF or GLB file states; other files do not state it.

    Raises
    ------
    FileError
        If the file cannot be read, or contains no face.
    """
    unit, points, faces, remarks = mesh_of_file(path, units=units, file_units=file_units)
    head = f'Model info(units = "{unit}");\n' if unit else ""
    listed = ", ".join(f"{{{x!r}, {y!r}, {z!r}}}" for x, y, z in points.tolist())
    return f"# {Path(path).name}\n{head}{mesh_statement('{' + listed + '}', faces)}", remarks


def mesh_of_file(
    path: str | os.PathLike[str], *, units: str = "", file_units: str = ""
) -> tuple[str, NDArray[np.float64], NDArray[np.int64], list[str]]:
    """Unit, points and faces of a mesh, and remarks about omitted or doubtful content.

    Parameters
    ----------
    path, units, file_units
        See :func:`mesh_program`.

    Returns
    -------
    tuple
        The unit, or an empty text; points ``(n, 3)`` without coincident ones; corners from 0
        ``(m, 4)``, a triangle repeats its last; remarks.

    Raises
    ------
    FileError
        If the file cannot be read, or contains no face.
    """
    from moldloft.overlays import read

    path = Path(path)
    stated = file_units
    ending = path.suffix.lower().lstrip(".")
    if not stated and ending in _METRES:
        stated = "m"
    if ending in _STATED:
        units = units or "m"
    found = read(path, units=units, file_units=stated if units else "")
    if not len(found.faces):
        raise FileError(f"cannot read `{path}`: it contains no face")
    remarks = list(found.remarks)
    if not stated and ending not in _STATED:
        remarks.append("the file does not state its unit of length")
    return units or stated, *_joined(found.points, found.faces), remarks


def read_mesh(path: str | os.PathLike[str], *, units: str = "", file_units: str = "") -> Model:
    r"""A mesh or panel file of another program as a model of one body, ``body``.

    It is used like any other model: ``m.hydrostatics()``,
    ``m.mesh().summary()``, ``m.write("hull.gdf")``. Remarks are warnings of Python.

    Parameters
    ----------
    path, units, file_units
        See :func:`mesh_program`.

    Returns
    -------
    Model
        Its panels are those of the file; coincident vertices are merged.

    Raises
    ------
    FileError
        If the file cannot be read, or contains no face.

    Examples
    --------
    >>> import pathlib, tempfile, moldloft
    >>> text = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    >>> text += "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder) / "corner.off"
    ...     _ = path.write_text(text)
    ...     m = moldloft.read_mesh(path, file_units="m")  # doctest: +SKIP
    """
    import warnings

    from moldloft.loading import loads

    text, remarks = mesh_program(path, units=units, file_units=file_units)
    for remark in remarks:
        warnings.warn(f"{path}: {remark}", stacklevel=2)
    return loads(text, name=f"{Path(path).stem}.sdl")


def mesh_statement(points: str, faces: NDArray[np.int64]) -> str:
    """A ``MeshBody`` named ``body``.

    Parameters
    ----------
    points
        The points, as an expression.
    faces
        Corners from 0, ``(m, 4)``; a triangle repeats its last.
    """
    threes = faces[:, 2] == faces[:, 3]
    text = f"MeshBody body({points}"
    if threes.any():
        text += f", triangles = {{{_numbers(faces[threes][:, :3])}}}"
    if not threes.all():
        text += f", quads = {{{_numbers(faces[~threes])}}}"
    return text + ");\n"


def _numbers(corners: NDArray[np.int64]) -> str:
    return ", ".join(map(str, (corners + 1).ravel().tolist()))


def _joined(
    points: NDArray[np.float64], faces: NDArray[np.uint32]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Merged coincident vertices, and the remaining faces: a triangle repeats its last vertex."""
    kept, number = np.unique(points + 0.0, axis=0, return_inverse=True)
    corners = np.asarray(number).ravel()[faces.astype(np.int64)]
    found = []
    for a, b, c, d in corners.tolist():
        ring = [p for k, p in enumerate((a, b, c, d)) if p != (a, b, c, d)[k - 1]]
        if len(set(ring)) == len(ring) >= 3:
            found.append((ring + ring[-1:])[:4])
    return kept, np.array(found, dtype=np.int64).reshape(-1, 4)


explain(globals())
