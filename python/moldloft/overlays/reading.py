"""Files of other programs as overlays, by extension."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from moldloft import _core
from moldloft.arguments import explain
from moldloft.budget import within_limits
from moldloft.errors import Error, FileError, FormatError
from moldloft.overlays.overlay import Overlay
from moldloft.storage import read_bytes

if TYPE_CHECKING:
    Reader = Callable[[str, bytes], tuple[Overlay, float | None]]

__all__ = ["ENDINGS", "METRES", "program", "read"]

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "in": 0.0254}
"""Units of length in metres."""

_SURFACES = {
    "stl": "triangles, text or binary",
    "obj": "vertices and faces",
    "ply": "points and faces, text or binary",
    "off": "vertices and faces",
}
"""By our own readers."""

_MESHES = {
    "msh": "nodes and surface elements of Gmsh",
    "vtk": "points and surface elements of VTK's old format",
    "vtu": "points and surface elements of VTK's XML",
}
"""By meshio; PolyData in ``vtk`` by our own reader."""

_POLYGONS = {"vtp": "polygons of VTK's XML"}

_SCENES = {
    "glb": "triangles of glTF, each at the position of its node; metres, y up becomes z",
    "3mf": "triangles of the items of a build; the file states its unit",
}

_RHINO = {"3dm": "meshes of Rhino"}
"""By rhino3dm."""

_PANELS = {
    "gdf": "panels of WAMIT, low order",
    "mar": "panels of Nemoh",
    "dat": "panels of Nemoh",
    "pnl": "panels of HAMS",
    "hst": "panels of HydroStar",
}
"""Panels of flow solvers; bodies with planes of symmetry are read whole."""

_POINTS = {
    "xyz": "points, three coordinates to a line",
    "txt": "points, two or three coordinates to a line",
    "csv": "points, two or three coordinates to a line, or a table of offsets",
    "pts": "points, three coordinates to a line",
}
_DRAWINGS = {
    "dxf": "lines, arcs, polylines, ellipses, splines, points and faces",
    "svg": "paths and basic shapes",
}

ENDINGS = {
    **_SURFACES,
    **_MESHES,
    **_POLYGONS,
    **_SCENES,
    **_RHINO,
    **_PANELS,
    **_POINTS,
    **_DRAWINGS,
}
"""Extensions of readable files, with the content that is read."""


def read(path: str | os.PathLike[str], *, units: str = "", file_units: str = "") -> Overlay:
    """A file of another program as reference geometry.

    Curves of DXF and SVG files are exact NURBS in the order of the file; :meth:`Overlay.to_sdl`
    makes them objects of a model. SVG's y axis, which points down, is reversed.

    Parameters
    ----------
    path
        The file; :data:`ENDINGS` lists the formats.
    units
        The unit of length of the model, m, cm, mm, ft or in: lengths are converted into it. By
        default numbers stay as they are in the file.
    file_units
        The unit of the file's numbers. DXF, SVG, 3DM, 3MF and GLB files state it themselves; others
        do not, so with ``units`` it is needed for them.

    Returns
    -------
    Overlay
        Points, curves and faces of the file, by layer or group.

    Raises
    ------
    FileError
        If the file cannot be read, is not of the format of its extension, or is truncated: the
        message says where.
    """
    path = Path(path)
    for unit in (units, file_units):
        if unit and unit not in METRES:
            raise Error(f"unknown unit `{unit}`; expected one of: {', '.join(METRES)}")
    found, stated = _located(path)
    if not len(found.points) and not found.curves:
        raise FileError(f"cannot read `{path}`: it contains no points, faces or curves")
    if not units:
        return found
    metres = METRES[file_units] if file_units else stated
    if metres is None:
        raise Error(
            f'`{path.name}` does not state its unit of length\nhelp: file_units = "mm" states it'
        )
    return found.scaled(metres / METRES[units])


def program(path: str | os.PathLike[str], *, units: str = "m") -> tuple[str, list[str]]:
    """The curves of a drawing (DXF, SVG) as a program, with remarks about other content.

    Parameters
    ----------
    path
        The file.
    units
        The unit of length of the model, into which lengths are converted where the file states its
        own; else its numbers stay as they are.

    Raises
    ------
    FileError
        If the file cannot be read or contains no curve.
    """
    path = Path(path)
    found, metres = _located(path)
    remarks = list(found.remarks)
    if metres is None:
        remarks.append(f"the file names no unit of length; its numbers are taken as {units}")
    else:
        found = found.scaled(metres / METRES[units])
    if not found.curves:
        raise FileError(f"`{path}` contains no curve; points and faces can only be overlays")
    return f'# {path.name}\nModel info(units = "{units}");\n{found.to_sdl()}', remarks


def _located(path: Path) -> tuple[Overlay, float | None]:
    """As :func:`_read`, within the limits of the process; errors name the file."""
    ending = path.suffix.lower().lstrip(".")
    if ending not in ENDINGS:
        known = ", ".join(ENDINGS)
        raise Error(f"`{path.name}`: unknown extension of an overlay; expected one of: {known}")
    data = read_bytes(path)
    try:
        with within_limits():
            return _read(path, ending, data)
    except (FileError, FormatError) as error:
        raise FileError(f"cannot read `{path}`: {error}") from error


def _read(path: Path, ending: str, data: bytes) -> tuple[Overlay, float | None]:
    """The overlay, and the unit that the file states in metres."""
    if ending == "dxf":
        from moldloft.overlays.dxf import parse as parse_dxf

        return parse_dxf(path.name, data)
    if ending == "svg":
        from moldloft.overlays.svg import parse as parse_svg

        return parse_svg(path.name, data)
    if ending in _POINTS:
        return _points(path.name, ending, data), None
    if ending == "glb":
        from moldloft.overlays.gltf import parse as parse_gltf

        return parse_gltf(path.name, data)
    if ending == "3mf":
        from moldloft.overlays.threemf import parse as parse_threemf

        return parse_threemf(path.name, data)
    from moldloft.cad.apart import read_meshes
    from moldloft.overlays import polydata
    from moldloft.overlays.meshes import mesh, panels, surface

    if ending in _POLYGONS:
        return polydata.xml(path.name, data), None
    if ending == "vtk" and polydata.is_legacy(data):
        return polydata.legacy(path.name, data), None
    if ending in _RHINO:
        points, faces, groups, metres = read_meshes(path)
        return Overlay(path.name, points, faces, tuple(groups)), metres
    if ending in _SURFACES:
        return surface(path.name, ending, data), None
    return (mesh if ending in _MESHES else panels)(path, ending), None


def _points(name: str, ending: str, data: bytes) -> Overlay:
    if ending == "csv":
        import numpy as np

        from moldloft.offsets import parse

        head = data[:4096].decode("utf-8", "replace").lower()
        if "station" in head and "waterline" in head:
            table = parse(data.decode("utf-8", "replace"), name)
            all_rows = [(x, y, z) for x, own in table.stations.items() for z, y in own]
            return Overlay(name, np.array(all_rows, dtype=np.float64))
    rows, _ = _core.read_points(data)
    return replace(Overlay(name), points=rows)


explain(globals())
