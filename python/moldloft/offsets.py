"""Tables of offsets: stations, waterlines and half-breadths, in and out.

A table is comma-separated text with the columns ``station``, ``waterline`` and ``half_breadth``
in any order, a row for each point: x, z and y >= 0 in the model's axes and unit. Other columns and
lines that begin with ``#`` are skipped. Or it is a matrix of half-breadths: the header has
``waterline`` and the stations, each row a waterline and its half-breadths; or ``station`` and the
waterlines.

A blank half-breadth means no hull at that height. A height may have several half-breadths: a flat
of keel, a knuckle. Zeros below the hull, as at a skeg or deadwood, and above it are not part of its
sections.
"""

from __future__ import annotations

import csv
import io
import math
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from moldloft.arguments import explain
from moldloft.budget import limited
from moldloft.errors import Error
from moldloft.storage import read_text

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from moldloft.models import Model

__all__ = ["Offsets", "encode", "even", "measure", "parse", "read"]

_COLUMNS = ("station", "waterline", "half_breadth")
_OTHER = {
    "x": "station",
    "z": "waterline",
    "y": "half_breadth",
    "halfbreadth": "half_breadth",
    "half-breadth": "half_breadth",
    "half breadth": "half_breadth",
}


@dataclass(frozen=True)
class Offsets:
    """A table of offsets.

    Examples
    --------
    >>> table = Offsets({0.0: ((0.0, 0.0), (1.0, 2.0)), 4.0: ((0.0, 1.0), (1.0, 3.0))})
    >>> print(table.csv(), end="")
    station,waterline,half_breadth
    0.0,0.0,0.0
    0.0,1.0,2.0
    4.0,0.0,1.0
    4.0,1.0,3.0
    >>> import moldloft
    >>> hull = moldloft.loads(table.program())["hull"]
    >>> hull(1, 1)
    array([4., 3., 1.])
    """

    stations: dict[float, tuple[tuple[float, float], ...]]
    """For each station x its points (waterline z, half-breadth y), from the keel up."""

    def section(self, station: float) -> tuple[tuple[float, float], ...]:
        """The points of a station's curve, without zeros below and above the hull.

        Parameters
        ----------
        station
            The station x.

        Returns
        -------
        tuple of (float, float)
            Waterline z and half-breadth y, from the keel up.

        Examples
        --------
        >>> Offsets({0.0: ((0.0, 0.0), (1.0, 0.0), (2.0, 0.5), (3.0, 0.8))}).section(0.0)
        ((1.0, 0.0), (2.0, 0.5), (3.0, 0.8))
        """
        points = self.stations[station]
        wide = [k for k, (_, y) in enumerate(points) if y > 0]
        if not wide:
            return points
        return points[max(wide[0] - 1, 0) : wide[-1] + 2]

    def csv(self) -> str:
        """The table as text, a row for each point.

        Returns
        -------
        str
            A header, then station, waterline and half-breadth.
        """
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(_COLUMNS)
        for x, points in self.stations.items():
            for z, y in points:
                writer.writerow([repr(x), repr(z), repr(y)])
        return text.getvalue()

    def program(self, *, curves: str = "CCurve", units: str = "", closed: bool = False) -> str:
        """A model of the half hull: a curve for each station and a loft through them.

        Parameters
        ----------
        curves
            ``"CCurve"`` passes through the points, ``"BCurve"`` has them as control points.
        units
            The unit of length, for the model's header.
        closed
            Closes the hull to the plane of symmetry: a deck, a transom or a blunt bow where an end
            station has a breadth, and a flat keel.

        Returns
        -------
        str
            A program of the language.

        Raises
        ------
        Error
            For other curves, or fewer than two stations.
        """
        if curves not in ("CCurve", "BCurve"):
            raise Error(f"stations are CCurve or BCurve, not `{curves}`")
        if len(self.stations) < 2:
            raise Error("a hull needs at least two stations")
        unit = f', units = "{units}"' if units else ""
        lines = [
            "# A half hull from a table of offsets; y = 0 is its plane of symmetry.",
            f'Model info(symmetry = "y"{unit});',
        ]
        names = []
        sections = [(x, self.section(x)) for x in self.stations]
        for k, (x, points) in enumerate(sections):
            own = []
            for j, (z, y) in enumerate(points):
                name = f"P{k}_{j}"
                own.append(name)
                lines.append(f"AbsPoint {name}({x!r}, {y!r}, {z!r});")
            names.append(f"station_{k}")
            lines.append(f"{curves} station_{k}({{{', '.join(own)}}});")
        divisions = f"{{{max(8, 2 * max(len(points) for _, points in sections))}, "
        divisions += f"{max(8, 4 * (len(names) - 1))}}}"
        lines.append(f"CLoftSurf hull({{{', '.join(names)}}}, divisions = {divisions});")
        if closed:
            breadths = {
                "deck": (2, [points[-1][1] for _, points in sections]),
                "transom": (1, [y for _, y in sections[0][1]]),
                "bow": (3, [y for _, y in sections[-1][1]]),
                "keel": (4, [points[0][1] for _, points in sections]),
            }
            for name, (edge, widths) in breadths.items():
                if any(y > 0 for y in widths):
                    lines += [
                        f"EdgeSnake {name}_edge({edge}, hull);",
                        f'ProjCurve {name}_centre({name}_edge, "y=0");',
                        f"RuledSurf {name}({name}_edge, {name}_centre, divisions = {{0, 4}});",
                    ]
        return "\n".join(lines) + "\n"


@limited
def read(path: str | os.PathLike[str]) -> Offsets:
    """The table of a file.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Offsets
        In the unit of the table.

    Raises
    ------
    FileError
        If the file cannot be read.
    Error
        If it is not a table of offsets; the message names the line.
    """
    return parse(read_text(path), os.fspath(path))


def parse(text: str, name: str = "offsets") -> Offsets:
    """The table of a text; ``name`` is its name in messages.

    Parameters
    ----------
    text
        The text.
    name
        Name of the text in messages.

    Returns
    -------
    Offsets
        In the unit of the table.
    """

    def fault(line: int, expected: str, found: str) -> Error:
        return Error(f"{name}, line {line}: expected {expected}, found {found}")

    lines = [(n, row) for n, row in enumerate(text.splitlines(), 1) if row.strip()]
    rows = []
    for n, line in lines:
        if not line.lstrip().startswith("#"):
            try:
                rows.append((n, next(csv.reader([line]))))
            except csv.Error as error:
                raise fault(n, "fields of at most 128 kB", str(error)) from error
    if not rows:
        raise fault(1, "the columns " + ", ".join(_COLUMNS), "no table")
    number, header = rows[0]
    words = [word.strip().lower() for word in header]
    words = [_OTHER.get(word, word) for word in words]
    matrix = _matrix(words, rows, fault)
    if matrix is None:
        missing = [column for column in _COLUMNS if column not in words]
        if missing:
            raise fault(number, "a column " + " and ".join(missing), ", ".join(header))
        places = [words.index(column) for column in _COLUMNS]
        entries = [
            (number, [row[place].strip() if place < len(row) else "" for place in places])
            for number, row in rows[1:]
        ]
    else:
        entries = matrix
    stations: dict[float, list[tuple[float, float]]] = {}
    for number, texts in entries:
        if not texts[2] and texts[0] and texts[1]:
            # No hull there.
            continue
        values = []
        for word, column in zip(texts, _COLUMNS, strict=True):
            try:
                value = float(word)
            except ValueError:
                value = math.nan
            if not math.isfinite(value):
                raise fault(number, f"a number for {column}", f"`{word}`")
            values.append(value + 0.0)
        x, z, y = values
        if y < 0:
            raise fault(number, "a half-breadth of 0 or more", repr(y))
        points = stations.setdefault(x, [])
        if (z, y) in points and matrix:
            # The row repeats for the flat of another station.
            continue
        if (z, y) in points:
            place = f"station {x!r}, waterline {z!r}"
            raise fault(number, f"half-breadth {y!r} once at {place}", "it twice")
        points.append((z, y))
    if not stations:
        raise fault(rows[0][0], "half-breadths", "none")
    for x, points in stations.items():
        if len(points) < 2:
            raise Error(f"{name}: station {x!r} has one point; it needs two or more")
    return Offsets({x: _upwards(stations[x]) for x in sorted(stations)})


def _matrix(
    words: list[str],
    rows: list[tuple[int, list[str]]],
    fault: Callable[[int, str, str], Error],
) -> list[tuple[int, list[str]]] | None:
    """The entries (station, waterline, half-breadth) of a matrix; ``None`` for other tables."""
    heads = [word for word in words[1:] if word]
    if words[0] not in ("", "station", "waterline") or not heads:
        return None
    try:
        [float(word) for word in heads]
    except ValueError:
        return None
    entries = []
    for number, row in rows[1:]:
        if not row or not row[0].strip():
            raise fault(number, "a station or waterline in the first column", "none")
        if len(row) > len(words):
            raise fault(number, f"{len(words)} fields", str(len(row)))
        for head, word in zip(words[1:], row[1:], strict=False):
            if head:
                pair = [row[0].strip(), head] if words[0] == "station" else [head, row[0].strip()]
                entries.append((number, [*pair, word.strip()]))
    return entries


def _upwards(points: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """The points from the keel up; of equal heights the one nearest to the last comes first."""
    ordered: list[tuple[float, float]] = []
    for z in sorted({z for z, _ in points}):
        flat = sorted(y for height, y in points if height == z)
        if ordered and abs(ordered[-1][1] - flat[-1]) < abs(ordered[-1][1] - flat[0]):
            flat.reverse()
        ordered += [(z, y) for y in flat]
    return tuple(ordered)


def encode(model: Model, title: str = "") -> bytes:
    """The file of :func:`even`; the format has no title.

    Parameters
    ----------
    model
        The model.
    title
        A title, for formats that have one.

    Returns
    -------
    bytes
        The content of the file.
    """
    return even(model).csv().encode()


def measure(model: Model, stations: Iterable[float], waterlines: Iterable[float]) -> Offsets:
    """The half-breadths of a model's panels: the largest y >= 0 at each station and waterline.

    Panels are cut as bilinear patches split along one diagonal; points without an intersection of
    station and waterline are omitted.

    Parameters
    ----------
    model
        The model; of one mirrored in y = 0 the modelled side counts, whichever it is.
    stations
        Coordinates x.
    waterlines
        Coordinates z.

    Returns
    -------
    Offsets
        In the model's unit.
    """
    import numpy as np

    mesh = model.mesh()
    points = mesh.vertices.copy()
    faces = mesh.faces
    skin = np.zeros(len(faces), dtype=bool)
    for patch in mesh.patches:
        skin[patch.start : patch.stop] = patch.tag not in ("lid", "waterline", "symmetry")
    faces = faces[skin]
    if "y" in model.symmetry and len(points) and -points[:, 1].min() > points[:, 1].max():
        points[:, 1] *= -1
    triangles = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    corners = points[triangles[triangles[:, 1] != triangles[:, 2]]]
    levels = sorted({float(z) + 0.0 for z in waterlines})
    found: dict[float, tuple[tuple[float, float], ...]] = {}
    for x in sorted({float(x) + 0.0 for x in stations}):
        cut = _cut(corners, x)
        row = [(z, y) for z in levels if (y := _breadth(cut, z)) is not None]
        if row:
            found[x] = tuple(row)
    if not found:
        raise Error("no station meets a waterline within the model")
    return Offsets(found)


def even(model: Model, *, stations: int = 21, waterlines: int = 11) -> Offsets:
    """The half-breadths at even stations and waterlines over the whole model.

    Parameters
    ----------
    model
        The model.
    stations
        The number of stations.
    waterlines
        The number of waterlines.

    Returns
    -------
    Offsets
        In the model's unit.
    """
    import numpy as np

    vertices = model.mesh().vertices
    if not len(vertices):
        raise Error("the model has no panels to measure offsets of")
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    xs = np.linspace(low[0], high[0], stations)
    zs = np.linspace(low[2], high[2], waterlines)
    return measure(model, xs, zs)


def _cut(corners: NDArray[np.float64], x: float) -> NDArray[np.float64]:
    """The pieces (two ends, y and z) in which a station cuts triangles."""
    import numpy as np

    distance = corners[..., 0] - x
    touched = corners[(distance.min(axis=1) <= 0) & (distance.max(axis=1) >= 0)]
    pieces: list[Sequence[NDArray[np.float64]]] = []
    for triangle in touched:
        ends = []
        for p, q in ((0, 1), (1, 2), (2, 0)):
            a, b = triangle[p], triangle[q]
            da, db = a[0] - x, b[0] - x
            if da == 0 and db == 0:
                pieces.append((a[1:], b[1:]))
            elif (da <= 0 <= db) or (db <= 0 <= da):
                share = da / (da - db)
                ends.append((a + share * (b - a))[1:])
        for p, q in pairwise(ends):
            pieces.append((p, q))
    return np.array(pieces, dtype=np.float64).reshape(-1, 2, 2)


def _breadth(cut: NDArray[np.float64], z: float) -> float | None:
    """The largest y >= 0 of the pieces at a height."""
    best: float | None = None
    for (ya, za), (yb, zb) in cut:
        if min(za, zb) <= z <= max(za, zb):
            share = 0.0 if za == zb else (z - za) / (zb - za)
            here = max(ya, yb) if za == zb else ya + share * (yb - ya)
            if here > -1e-12 and (best is None or here > best):
                best = max(float(here), 0.0)
    return best


explain(globals())
