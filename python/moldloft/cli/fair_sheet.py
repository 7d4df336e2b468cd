"""The suspects and the sheet of ``moldloft fair``: what a file of points adds to a result."""

from __future__ import annotations

import argparse
import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from moldloft.fairing import Fairing, NetworkFairing, Suspect
    from moldloft.fairing.files import PointFile
    from moldloft.fairing.sheet import SheetTable

__all__ = ["readings", "sheet_table", "source_facts", "suspects_of"]

#: Suspects of a page and of a sheet.
MOST = 10


def suspects_of(
    file: PointFile, result: Fairing | NetworkFairing, rows: list[int], motion: Any, most: int
) -> tuple[Suspect, ...]:
    """The suspects among the points of a file, named as in the file.

    Parameters
    ----------
    file
        The file read.
    result
        What was made of it.
    rows
        Of each point of the result its row in the curves of the file.
    motion
        The motion of the points: axes of each, a direction, or a word.
    most
        The length of the list at most.
    """
    import numpy as np

    from moldloft.fairing import suspects

    axes: Any = motion if isinstance(motion, list) else None
    if isinstance(motion, tuple) and not isinstance(motion[0], str):
        axes = "".join(a for a, c in zip("xyz", motion, strict=False) if c)
    elif isinstance(motion, tuple):
        axes = "".join(a for a, c in zip("xyz", motion[1], strict=False) if not c)
    lists = getattr(result, "lists", None)
    return suspects(
        result.data,
        float(np.max(result.tol)) if result.tol is not None else 0.0,
        lists,
        motion=axes,
        most=most,
        names=[result.name(k) for k in range(len(lists))] if lists else (),
        point_names=[result.point_name(k) for k in range(len(result.data))] if lists else (),
        readings=readings(file, rows),
    )


def readings(file: PointFile, rows: list[int]) -> dict[tuple[int, int], str]:
    """The cells of points, by point and axis.

    Parameters
    ----------
    file
        The file read.
    rows
        Of each point its row in the curves of the file.
    """
    if file.cells is None:
        return {}
    at = {owner: k for k, owner in enumerate(file.cells.owners)}
    out = {}
    for point, row in enumerate(rows):
        own = file.places[row] if file.table is not None else row
        for axis in range(3):
            if (own, axis) in at:
                out[point, axis] = file.cells.cell(at[own, axis])
    return out


def sheet_table(file: PointFile, texts: list[str | None]) -> SheetTable | None:
    """The offsets of a table before and after, in its own notation; ``None`` for other files.

    Parameters
    ----------
    file
        The file read.
    texts
        Its cells as they are written now; ``None`` for those that did not change.
    """
    from moldloft.fairing.sheet import SheetTable

    if file.cells is None or not file.point_names:
        return None
    moving = {"x": 0, "y": 1, "z": 2}
    twice = {row for row, own in enumerate(file.motions or []) if len(own) > 1}
    out = SheetTable([], [], {})
    for k, (row, axis) in enumerate(file.cells.owners):
        if file.motions is None and axis != file.moves:
            continue
        station, _, line = file.point_names[row].partition(", ")
        if row in twice or line in {file.point_names[r].partition(", ")[2] for r in twice}:
            line += ", height" if axis == moving["z"] else ", half-breadth"
        for name, own in ((line, out.lines), (station, out.stations)):
            if name not in own:
                own.append(name)
        out.cells[line, station] = (file.cells.cell(k), texts[k])
    return out


def source_facts(path: Path, options: argparse.Namespace) -> list[tuple[str, str]]:
    """The source with its hash, and the options that are not those by default.

    Parameters
    ----------
    path
        The file read.
    options
        The arguments of the command.
    """
    from moldloft.storage import read_bytes

    data = read_bytes(path)
    digest = hashlib.sha256(data).hexdigest()
    facts = [("source", f"{path}, {len(data)} bytes, SHA-256 {digest}")]
    shown = ("goal", "measure", "mode", "spacing", "bound", "breaks", "fixed", "ends", "shape")
    given = [f"{name} {getattr(options, name)}" for name in shown if getattr(options, name, None)]
    return [*facts, ("options", ", ".join(given))]
