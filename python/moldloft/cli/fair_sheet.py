"""The suspects and the sheet of ``moldloft fair`` for a file of points."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from moldloft.fairing import Fairing, NetworkFairing, Suspect
    from moldloft.fairing.files import PointFile
    from moldloft.fairing.sheet import SheetDetails, SheetTable

__all__ = ["SHEET_SUSPECTS", "readings", "suspects_of", "write_sheet_of"]

#: Suspects of a sheet at most.
SHEET_SUSPECTS = 10


def suspects_of(
    file: PointFile, result: Fairing | NetworkFairing, rows: list[int], motion: Any, most: int
) -> tuple[Suspect, ...]:
    """The suspects among the points of a file, named as in the file.

    Parameters
    ----------
    file
        The file read.
    result
        The faired result.
    rows
        For each point of the result, its row in the curves of the file.
    motion
        The motion of the points: axes of each, a direction, or a word.
    most
        The length of the list at most.
    """
    from moldloft.fairing import NetworkFairing, suspects

    cells = readings(file, rows)
    if isinstance(result, NetworkFairing):
        return result.suspects(most, readings=cells)
    axes: Any = motion if isinstance(motion, list) else None
    if isinstance(motion, tuple) and not isinstance(motion[0], str):
        axes = "".join(a for a, c in zip("xyz", motion, strict=False) if c)
    elif isinstance(motion, tuple):
        axes = "".join(a for a, c in zip("xyz", motion[1], strict=False) if not c)
    tol = 0.0 if result.tol is None else result.tol
    return suspects(result.data, tol, motion=axes, most=most, readings=cells)
    return suspects(result.data, tol, motion=axes, most=most, readings=cells)


def readings(file: PointFile, rows: list[int]) -> dict[tuple[int, int], str]:
    """The cells of points, by point and axis.

    Parameters
    ----------
    file
        The file read.
    rows
        For each point, its row in the curves of the file.
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


def write_sheet_of(
    file: PointFile,
    result: Fairing | NetworkFairing,
    path: Path,
    written: tuple[Any, Any, float | None],
    details: SheetDetails,
) -> Path:
    """Write the sheet of a file of points.

    Parameters
    ----------
    file
        The file read.
    result
        The result of its fairing.
    path
        The sheet.
    written
        The rows of the file as they are faired, their tolerances, and the step of the digits.
    details
        The rest; source, table and notation are added.

    Returns
    -------
    pathlib.Path
        The file.
    """
    from moldloft.fairing.files import cell_texts
    from moldloft.fairing.sheet import write_sheet
    from moldloft.storage import read_bytes

    if file.offsets and file.cells is not None:
        details.table = _table(file, cell_texts(written[0], file, *written[1:]))
    data = read_bytes(file.path)
    digest = hashlib.sha256(data).hexdigest()
    source = ("source", f"{file.path}, {len(data)} bytes, SHA-256 {digest}")
    details.facts = [source, *details.facts]
    details.eighths = file.inches
    return write_sheet(result, path, f"Fairing of {file.path.name}", details)


def _table(file: PointFile, texts: list[str | None]) -> SheetTable:
    """The offsets of a table before and after, in its own notation."""
    from moldloft.fairing.sheet import SheetTable

    assert file.cells is not None
    twice = {row for row, own in enumerate(file.motions or []) if len(own) > 1}
    in_both = {file.point_names[row].partition(", ")[2] for row in twice}
    out = SheetTable([], [], {})
    for k, (row, axis) in enumerate(file.cells.owners):
        if file.motions is None and axis != file.moves:
            continue
        station, _, line = file.point_names[row].partition(", ")
        if line in in_both:
            line += ", height" if axis == 2 else ", half-breadth"
        for name, own in ((line, out.lines), (station, out.stations)):
            if name not in own:
                own.append(name)
        out.cells[line, station] = (file.cells.cell(k), texts[k])
    return out
