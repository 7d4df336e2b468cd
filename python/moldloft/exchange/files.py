"""Formats of a model's files, and writing of whole files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from moldloft.arguments import explain
from moldloft.errors import FormatError
from moldloft.formats import format_named as _row
from moldloft.formats import formats
from moldloft.storage import Output, commit, read_set

if TYPE_CHECKING:
    from moldloft.models import Model

__all__ = [
    "FORMATS",
    "SOLVERS",
    "Output",
    "commit",
    "ending",
    "file_name",
    "format_named",
    "produce",
    "read_set",
]

FORMATS = {row.name: row.about for row in formats().values()}
"""The formats by name, with a line about each; all about them is in :mod:`moldloft.formats`."""

SOLVERS = tuple(row.name for row in formats().values() if row.panel_code)
"""The formats of panel codes."""


def format_named(name: str) -> str:
    """The name of a format, by name or alias.

    Parameters
    ----------
    name
        A name or an alias of a format.

    Examples
    --------
    >>> format_named("Plot3D")
    'p3d'
    """
    return _row(name).name


def file_name(stem: str, format: str) -> str:
    """The name of a model's file in a format.

    Parameters
    ----------
    stem
        Name of the file without its ending.
    format
        The name of a format, see :data:`moldloft.exchange.files.FORMATS`.

    Examples
    --------
    >>> file_name("hull", "gdf"), file_name("hull", "nemoh")
    ('hull.gdf', 'hull.mar')
    """
    return _row(format).file_name(stem)


def ending(path: Path) -> str:
    """Format of a file name: its extension, or a longer known one.

    Parameters
    ----------
    path
        The name of a file.

    Examples
    --------
    >>> ending(Path("hull.gdf")), ending(Path("hull.high.gdf")), ending(Path("hull"))
    ('gdf', 'gdf-high', '')
    """
    name = path.name.lower()
    for row in formats().values():
        if "." in row.suffix and name.endswith(f".{row.suffix}"):
            return row.name
    return path.suffix.lstrip(".").lower()


def produce(
    model: Model,
    format: str,
    path: Path,
    *,
    lids: bool = False,
    immersed: bool = False,
    tags: Sequence[str] = (),
    tolerance: float | None = None,
    angle: float | None = None,
    whole: bool = False,
    triangles: bool = False,
) -> list[Output]:
    """The files of a model in one format; ``path`` gives their names.

    ``lids`` and ``immersed`` are for the files of panel codes, see :meth:`Model.write`; ``tags``
    names the patches to write, ``tolerance`` is the maximum error of fitted patches and panels,
    ``whole`` selects both sides of a symmetric model, ``triangles`` only triangles.

    Parameters
    ----------
    model
        The model.
    format
        The name of a format, see :data:`moldloft.exchange.files.FORMATS`.
    path
        Gives the names of the files; nothing is written.
    lids
        Include lids.
    immersed
        Cut at z = 0 and keep what is below, for panel codes.
    tags
        Only patches with one of these tags; by default all.
    tolerance
        The largest error of fitted surfaces, or distance of panels from their surfaces.
    angle
        The largest turn along a panel, in radians.
    whole
        Both sides of a symmetric model, in files of plain panels.
    triangles
        Triangles only, in files of plain panels.
    """
    row = _row(format)
    if not row.writer:
        found = model.encoded(
            row.name,
            path.name,
            lids=lids,
            immersed=immersed,
            tags=tags,
            tolerance=tolerance,
            angle=angle,
            whole=whole,
            triangles=triangles,
        )
        return [Output(name, data) for name, data in found.items()]
    given = {"lids": lids, "immersed": immersed, "tags": bool(tags), "tolerance": tolerance}
    given["angle"] = angle
    if row.holds == "surfaces":
        del given["tolerance"]
    given |= {"whole": whole, "triangles": triangles}
    for option, value in given.items():
        if value is not None and value is not False:
            raise FormatError(f"`{option}` is not for {row.name}, which takes whole surfaces")
    source = model.blocks() if row.volume else model
    return [Output(path.name, row.encode(source, path.stem, tolerance=tolerance))]


explain(globals())
