"""What a model is written as, and writing it whole or not at all."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from moldloft.errors import Error, FileError
from moldloft.formats import format_named as _row
from moldloft.formats import formats

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
]

FORMATS = {row.name: row.about for row in formats().values()}
"""The formats by name, with a line about each; all about them is in :mod:`moldloft.formats`."""

SOLVERS = tuple(row.name for row in formats().values() if row.panel_code)
"""The formats of panel codes."""


@dataclass(frozen=True)
class Output:
    """A file to be written."""

    name: str
    """Its name, without folder."""
    data: bytes
    """Its content."""


def format_named(name: str) -> str:
    """The name of the format of that name or alias.

    >>> format_named("Plot3D")
    'p3d'
    """
    return _row(name).name


def file_name(stem: str, format: str) -> str:
    """The name of a model's file in a format.

    >>> file_name("hull", "gdf"), file_name("hull", "nemoh")
    ('hull.gdf', 'hull.mar')
    """
    return _row(format).file_name(stem)


def ending(path: Path) -> str:
    """What the name of a file says of its format: its ending, or the format of a longer one.

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
    whole: bool = False,
    triangles: bool = False,
) -> list[Output]:
    """The files of a model in one format; ``path`` gives their names.

    ``lids`` and ``immersed`` are for the files of panel codes, see :meth:`Model.write`; ``tags``
    names the patches to write, ``tolerance`` is how far fitted patches may be off, ``whole`` asks
    for both sides of a symmetric model, ``triangles`` for triangles only.
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
            whole=whole,
            triangles=triangles,
        )
        return [Output(name, data) for name, data in found.items()]
    given = {"lids": lids, "immersed": immersed, "tags": bool(tags), "tolerance": tolerance}
    if row.holds == "surfaces":
        del given["tolerance"]
    given |= {"whole": whole, "triangles": triangles}
    for option, value in given.items():
        if value is not None and value is not False:
            raise Error(f"`{option}` is not for {row.name}, which takes whole surfaces")
    source = model.blocks() if row.volume else model
    return [Output(path.name, row.encode(source, path.stem, tolerance=tolerance))]


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
