"""What a model is written as, and writing it whole or not at all."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from moldloft.errors import Error, FileError

if TYPE_CHECKING:
    from moldloft.models import Model

__all__ = ["FORMATS", "SOLVERS", "Output", "commit", "file_name", "format_named", "produce"]

FORMATS = {
    "gdf": "WAMIT low-order panels",
    "gdf-high": "WAMIT high-order B-spline patches (.high.gdf)",
    "nemoh": "Nemoh panels (.mar)",
    "hydrostar": "HydroStar panels (.hst)",
    "hams": "HAMS panels (.pnl)",
    "aqwa": "AQWA geometry decks (.dat)",
    "stl": "triangles, binary STL",
    "3mf": "triangles with names and colours, for printers",
    "obj": "Wavefront OBJ",
    "ply": "binary PLY",
    "glb": "glTF with patch names and colours",
    "vtp": "VTK polygons",
    "vts": "VTK structured grids, one per patch",
    "p3d": "Plot3D surface grids",
    "cgns": "CGNS structured surface zones with interfaces (needs h5py)",
    "volume-p3d": "the cells of solids as Plot3D volume grids",
    "volume-vts": "the cells of solids as VTK structured grids, one per block, and a .vtm",
    "volume-vtu": "the cells of solids as VTK unstructured hexahedra",
    "volume-cgns": "the cells of solids as CGNS zones (needs h5py)",
    "blockmesh": "the blocks of solids as OpenFOAM's blockMeshDict",
    "offsets": "stations, waterlines and half-breadths (.csv)",
    "svg": "body plan, waterlines and buttocks, each with its scale",
    "png": "a picture",
    "sdl": "the model as a program",
    "ms2": "the model as a MultiSurf model file",
}
"""The formats by name, with a line about each."""

_ALIASES = {
    "plot3d": "p3d",
    "xyz": "p3d",
    "vtk": "vtp",
    "wamit": "gdf",
    "mar": "nemoh",
    "hst": "hydrostar",
    "pnl": "hams",
    "gltf": "glb",
    "csv": "offsets",
}

SOLVERS = ("gdf", "nemoh", "hydrostar", "hams", "aqwa")
"""The formats of panel codes."""

_SUFFIXES = {
    "gdf-high": "high.gdf",
    "nemoh": "mar",
    "hydrostar": "hst",
    "hams": "pnl",
    "aqwa": "dat",
    "offsets": "csv",
    "volume-p3d": "volume.p3d",
    "volume-vts": "volume.vts",
    "volume-vtu": "volume.vtu",
    "volume-cgns": "volume.cgns",
    "blockmesh": "blockMeshDict",
}
"""Endings of file names where they are not the format's name."""


@dataclass(frozen=True)
class Output:
    """A file to be written."""

    name: str
    """Its name, without folder."""
    data: bytes
    """Its content."""


def format_named(name: str) -> str:
    """The format of that name or alias.

    >>> format_named("Plot3D")
    'p3d'
    """
    wanted = name.lower()
    wanted = _ALIASES.get(wanted, wanted)
    if wanted == "dat":
        raise Error("files of Nemoh and of AQWA end in `.dat`; say which format: `nemoh` or `aqwa`")
    if wanted not in FORMATS:
        raise Error(f"there is no format `{name}`; there are: {', '.join(FORMATS)}")
    return wanted


def file_name(stem: str, format: str) -> str:
    """The name of a model's file in a format.

    >>> file_name("hull", "gdf"), file_name("hull", "nemoh")
    ('hull.gdf', 'hull.mar')
    """
    return f"{stem}.{_SUFFIXES.get(format, format)}"


def produce(
    model: Model,
    format: str,
    path: Path,
    *,
    lids: bool = False,
    immersed: bool = False,
    tags: Sequence[str] = (),
    tolerance: float | None = None,
) -> list[Output]:
    """The files of a model in one format; ``path`` gives their names.

    ``lids`` and ``immersed`` are for the files of panel codes, see :meth:`Model.write`; ``tags``
    names the patches to write, ``tolerance`` is how far fitted patches may be off.
    """
    wanted = format_named(format)
    if tolerance is not None and wanted != "gdf-high":
        raise Error("a tolerance is for fitted patches, gdf-high")
    if wanted == "gdf-high" and not immersed and not tags:
        from moldloft import high_order

        return [
            Output(path.name, high_order.write(model, path.stem, tolerance=tolerance, lids=lids))
        ]
    volume = wanted == "blockmesh" or wanted.startswith("volume-")
    if (volume or wanted in ("gdf-high", "cgns", "offsets")) and (immersed or tags):
        named = "immersed" if immersed else "tags"
        raise Error(f"`{named}` is not for {wanted}, which takes whole surfaces")
    if (lids or immersed) and wanted not in SOLVERS:
        named = "lids" if lids else "immersed"
        raise Error(f"`{named}` is for the files of panel codes, {', '.join(SOLVERS)}")
    if volume:
        return model.blocks().outputs(wanted.removeprefix("volume-"), path)
    if wanted == "cgns":
        from moldloft import cgns

        return [Output(path.name, cgns.write(model, path.stem))]
    if wanted == "offsets":
        from moldloft import offsets

        return [Output(path.name, offsets.even(model).csv().encode())]
    if wanted in ("sdl", "ms2"):
        return [Output(path.name, model.convert(wanted).encode())]
    files = model._document.write(wanted, path.stem, lids, immersed, list(tags))
    main = file_name(path.stem, wanted)
    return [Output(path.name if name == main else name, data) for name, data in files]


def commit(folder: Path, outputs: Sequence[Output]) -> list[Path]:
    """Write all files or none: under temporary names first, synced, then renamed.

    Parameters
    ----------
    folder
        Where to; made when it is not there.
    outputs
        What to write.

    Raises
    ------
    FileError
        When the folder or the disk refuses; then nothing has changed.
    """
    made = _make_folder(folder)
    pending: list[tuple[Path, Path]] = []
    try:
        for output in outputs:
            target = folder / output.name
            if target.is_dir():
                raise FileError(f"cannot write `{target}`: it is a folder")
            draft = folder / f".{output.name}.{os.getpid()}.part"
            pending.append((draft, target))
            _write_synced(draft, output.data)
        for draft, target in pending:
            draft.replace(target)
    except BaseException as error:
        for draft, _ in pending:
            with contextlib.suppress(OSError):
                draft.unlink(missing_ok=True)
        for new in made:
            with contextlib.suppress(OSError):
                new.rmdir()
        if isinstance(error, OSError) and not isinstance(error, FileError):
            where = pending[-1][1] if pending else folder
            raise FileError(f"cannot write `{where}`: {_reason(error)}") from error
        raise
    return [target for _, target in pending]


def _make_folder(folder: Path) -> list[Path]:
    """Makes a folder; the new ones, innermost first."""
    missing = []
    at = folder
    while not at.exists() and at != at.parent:
        missing.append(at)
        at = at.parent
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"cannot make the folder `{folder}`: {_reason(error)}") from error
    return missing


def _write_synced(path: Path, data: bytes) -> None:
    with path.open("xb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()
