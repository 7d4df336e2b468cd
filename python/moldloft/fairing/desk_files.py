"""Results of a fairing desk as files: the table in its original form, splines, the sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from moldloft.errors import FairingError
from moldloft.fairing.desk_lines import DeskResult
from moldloft.fairing.desk_source import DeskSource
from moldloft.fairing.faired import Fairing
from moldloft.fairing.files import points_text, read_points
from moldloft.fairing.network import NetworkFairing
from moldloft.fairing.page import page
from moldloft.fairing.spline_files import POINTS, SPLINES
from moldloft.fairing.spline_files import encoded as encoded_splines

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["encoded"]


def encoded(
    source: DeskSource, result: DeskResult, log: Sequence[str], begin: float, name: str
) -> bytes:
    """The result as the content of a file with this name."""
    path = Path(name)
    ending = path.suffix.lower()
    if ending in SPLINES:
        return encoded_splines([c.after for c in result.curves], path, source.unit)
    if ending in (".html", ".htm"):
        return _sheet(source, result, log, begin).encode()
    if ending in POINTS or (source.table and ending == Path(source.table[0]).suffix.lower()):
        return _table(source, result, ending).encode()
    known = ", ".join((*POINTS, *SPLINES, ".html"))
    raise FairingError(f"`{name}`: expected an ending of {known}")


def _table(source: DeskSource, result: DeskResult, ending: str) -> str:
    """The points in the form in which they were read, or as rows."""
    count = len(source.points)
    points = np.array(result.points)[:count, : source.width]
    if source.table is None:
        return points_text(points, None, {".csv": ",", ".tsv": "\t"}.get(ending, " "))
    name, text = source.table
    file = read_points(name, text.encode())
    # Points of a network are those that differ, in the order of the rows.
    known: dict[bytes, int] = {}
    of_row = []
    for row in file.points:
        of_row.append(known.setdefault((row + 0.0).tobytes(), len(known)))
    if source.kind == "curves":
        of_row = list(range(len(file.points)))
    rows = points[of_row]
    if file.table is not None:
        table = file.table.copy()
        table[file.places] = rows
        return points_text(table, replace(file, blocks=[range(len(table))]))
    same = ending == Path(name).suffix.lower()
    return points_text(rows, file if same else None, {".csv": ",", ".tsv": "\t"}.get(ending, " "))


def _sheet(source: DeskSource, result: DeskResult, log: Sequence[str], begin: float) -> str:
    """The page of the fairing, with the commands that repeat it."""
    facts = [
        ("source", source.name),
        ("unit", source.unit or "not stated"),
        ("first tolerance", f"{begin:g}"),
        *(("commands" if k == 0 else "", command) for k, command in enumerate(log)),
    ]
    pages = []
    for part, curve in zip(result.parts, result.curves, strict=False):
        if isinstance(part, NetworkFairing):
            lines = tuple(c.name for c in result.curves)
            part = replace(part, names=lines, point_names=_names(source, result))
        several = isinstance(part, Fairing) and len(result.parts) > 1
        title = f"{source.name}: {curve.name}" if several else source.name
        pages.append(page(part, title, facts))
    if len(pages) == 1:
        return pages[0]
    # One document: the bodies after the first, apart.
    first, *others = pages
    bodies = [p[p.index("<h1>") : p.rindex("</html>")] for p in others]
    return first[: first.rindex("</html>")] + "".join(f"<hr>{b}" for b in bodies) + "</html>\n"


def _names(source: DeskSource, result: DeskResult) -> tuple[str, ...]:
    if not source.point_names:
        return ()
    more = range(len(source.point_names), len(result.points))
    return (*source.point_names, *(f"point {k + 1}" for k in more))
