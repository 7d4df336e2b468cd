"""Input of a fairing desk: numbered points, and the lines through them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import points_of
from moldloft.fairing.files import PointFile, read_points
from moldloft.fairing.objects import sampled
from moldloft.fairing.spline import Spline
from moldloft.fairing.surface import SplineSurface
from moldloft.storage import read_bytes

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]

__all__ = ["DeskLine", "DeskSource"]

LARGEST = 20_000
"""Points that a desk takes: each of its steps is seen on a screen."""

SAMPLES = 65
"""Number of sampled points of a spline, and twice that of each direction of a surface."""

Place = tuple[float, float, float]


@dataclass(frozen=True)
class DeskLine:
    """A line through points of a desk."""

    name: str
    """Its name, such as ``waterline 1.5``."""
    points: tuple[int, ...]
    """Its points, from 0; of a closed line the first is not repeated."""
    closed: bool = False
    """True if the last point is followed by the first."""


@dataclass(frozen=True)
class DeskSource:
    """Input of a desk, to which a log of commands applies.

    Examples
    --------
    >>> source = DeskSource.of([(0, 0), (1, 0.5), (2, 0.9), (3, 1.1), (4, 1.2)], name="rail")
    >>> source.kind, [line.name for line in source.lines], len(source.points)
    ('curves', ['rail'], 5)
    """

    kind: str
    """``"curves"``, each faired by itself; ``"network"``, curves that share points; ``"surface"``,
    a grid of data."""
    name: str
    """What was opened."""
    points: tuple[Place, ...]
    """All points, in three coordinates."""
    width: int
    """Number of coordinates in the input."""
    lines: tuple[DeskLine, ...]
    """The lines through them: of a surface the rows of its grid, then its columns."""
    point_names: tuple[str, ...] = ()
    """Names of the points; empty for numbers."""
    motion: str | Place = "ball"
    """In which directions points move: ``"ball"``, or the one of offsets."""
    unit: str | None = None
    """The unit of length, if known."""
    objects: tuple[str, ...] = ()
    """The model's own point objects, where the points are these."""
    table: tuple[str, str] | None = None
    """Name and text of the table that the points are from."""
    breaks: tuple[int, ...] = ()
    """Points at which an object of a model has corners."""
    options: tuple[tuple[str, Any], ...] = ()
    """Arguments of the object beside points and marks: the role of the points, knots, degree."""
    tolerance: float | None = None
    """The tolerance of the object, if it has one."""

    @property
    def control(self) -> bool:
        """True if the points are control points, which the curve does not pass through."""
        return ("as", "control") in self.options

    @property
    def grid(self) -> tuple[int, int]:
        """Rows and columns of the grid of a surface."""
        rows = len(self.lines[0].points) if self.lines else 1
        return len(self.points) // rows, rows

    def as_dict(self) -> dict[str, Any]:
        """The source as plain data for JSON, without loss."""
        return asdict(self)

    @staticmethod
    def from_dict(given: dict[str, Any]) -> DeskSource:
        """The source that :meth:`as_dict` wrote.

        Parameters
        ----------
        given
            Numbers, texts and lists.
        """
        lines = tuple(
            DeskLine(str(o["name"]), tuple(int(k) for k in o["points"]), bool(o["closed"]))
            for o in given["lines"]
        )
        motion = given.get("motion", "ball")
        table = given.get("table")
        source = DeskSource(
            kind=str(given["kind"]),
            name=str(given["name"]),
            points=places([tuple(p) for p in given["points"]]),
            width=int(given["width"]),
            lines=lines,
            point_names=tuple(map(str, given.get("point_names") or ())),
            motion=motion if isinstance(motion, str) else place(motion),
            unit=given.get("unit"),
            objects=tuple(map(str, given.get("objects") or ())),
            table=None if table is None else (str(table[0]), str(table[1])),
            breaks=tuple(int(k) for k in given.get("breaks") or ()),
            options=tuple(
                (str(name), tuple(value) if isinstance(value, (list, tuple)) else value)
                for name, value in given.get("options") or ()
            ),
            tolerance=given.get("tolerance"),
        )
        return source._checked()

    def _checked(self) -> DeskSource:
        count = len(self.points)
        if self.kind not in ("curves", "network", "surface") or not self.lines:
            raise FairingError("expected curves, a network or a surface, found no lines")
        if count > LARGEST:
            raise FairingError(f"expected at most {LARGEST} points at a desk, found {count}")
        if any(not 0 <= k < count for line in self.lines for k in line.points):
            raise FairingError(f"a line has points that are not among the {count}")
        return self

    @staticmethod
    def of(
        what: ArrayLike | Spline | SplineSurface | PointFile | DeskSource,
        *,
        name: str = "curve",
        closed: bool = False,
        motion: str | Place = "ball",
    ) -> DeskSource:
        """The points and lines of points, splines, surfaces and tables.

        Parameters
        ----------
        what
            Points ``(n, 2)`` or ``(n, 3)``, one curve; a grid ``(m, n, 3)``, a surface; a
            :class:`Spline` or a :class:`SplineSurface`, which are sampled; a table of offsets or
            several curves as :func:`~moldloft.fairing.files.read_points` has read them.
        name
            Name of the curve or the surface.
        closed
            True for a closed curve.
        motion
            ``"ball"``, or the direction in which points move.
        """
        if isinstance(what, DeskSource):
            return what
        if isinstance(what, PointFile):
            return of_table(what, None)
        if isinstance(what, Spline):
            t = np.linspace(0, 1, SAMPLES)
            closed = what.closed
            return DeskSource.of(what(t[:-1] if closed else t), name=name, closed=closed)
        if isinstance(what, SplineSurface):
            return DeskSource.of(what.grid(SAMPLES // 2 + 1, SAMPLES // 2 + 1), name=name)
        if np.ndim(what) == 3:
            data, width = points_of(what, 3)
            m, n = data.shape[:2]
            at = np.arange(m * n).reshape(m, n)
            rows = [DeskLine(f"row {k + 1}", tuple(map(int, r))) for k, r in enumerate(at)]
            columns = [DeskLine(f"column {k + 1}", tuple(map(int, c))) for k, c in enumerate(at.T)]
            lines, kind = (*rows, *columns), "surface"
            data = data.reshape(-1, 3)
        else:
            data, width = points_of(what)
            lines, kind = (DeskLine(name, tuple(range(len(data))), closed),), "curves"
        way = motion if isinstance(motion, str) else place(motion)
        return DeskSource(kind, name, places(data), width, lines, motion=way)._checked()

    @staticmethod
    def of_file(path: str | Path, data: bytes | None = None) -> DeskSource:
        """The lines of a file of points or of a table of offsets.

        Parameters
        ----------
        path
            The file, or only its name where ``data`` are its bytes.
        data
            The bytes of the file.
        """
        data = read_bytes(Path(path)) if data is None else data
        try:
            text = data.decode("utf-8")
        except UnicodeDecodeError:
            text = data.decode("latin-1")
        return of_table(read_points(path, data), text)

    @staticmethod
    def of_object(model: Model, name: str) -> DeskSource:
        """A curve or a surface of a model; for fair curves and B-splines their own points.

        Parameters
        ----------
        model
            The model.
        name
            The object.
        """
        document = model._document
        facts = document.object(name) if document.has(name) else None
        if facts is not None and (made := _controlled(model, name, facts)) is not None:
            return made._checked()
        own = [] if facts is None else [p for p in facts["parents"] if is_point(document, p)]
        kind = "" if facts is None else facts["kind"]
        alone = len(set(own)) == len(own) > 4 and facts is not None and facts["parents"] == own
        if kind == "FairCurve" and alone:
            data = np.array([model.eval(p) for p in own], np.float64)
            line = DeskLine(name, tuple(range(len(own))))
            source = DeskSource("curves", name, places(data), 3, (line,), objects=tuple(own))
            return source._checked()
        found = sampled(model, name, None)
        source = DeskSource.of(found.points, name=name, closed=found.closed)
        if found.breaks:
            source = DeskSource.from_dict({**source.as_dict(), "breaks": found.breaks})
        return source


_PLAIN = {"degree": 3, "mode": "optimum", "goal": "near", "spacing": "auto", "ends": None}
"""Arguments that are left out of a text if they have these values."""

_CARRIED = ("as", "degree", "knots", "weights", "period", "measure", "ends", "bound", "mode")
"""Arguments of control points that a desk keeps as they are."""

_OWN = ("points", "tolerance", "closed", "breaks", "goal")
"""Arguments of control points that are its points and its marks."""


def _controlled(model: Model, name: str, facts: dict[str, Any]) -> DeskSource | None:
    """The control points of a B-spline of a model; None for other objects."""
    given = {k: v for k, v in facts["arguments"].items() if v is not None}
    kind = facts["kind"]
    spline = kind in ("BCurve", "NURBCurve")
    if not spline and (kind != "FairCurve" or given.get("as") != "control"):
        return None
    given = {k: v for k, v in given.items() if np.ndim(v) or v not in (_PLAIN.get(k), 0)}
    rows = given["points"]
    data = [model.eval(row) if isinstance(row, str) else row for row in rows]
    count, degree = len(rows), int(given.get("degree", 3))
    if spline:
        degree = min(degree, count - 1)
        inner = np.arange(1, count - degree) / (count - degree)
        clamped = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
        given = {"knots": clamped, **given, "as": "control", "degree": degree, "tolerance": 0.0}
    steps = np.linalg.norm(np.diff(data, axis=0), axis=1)
    if set(given) - {*_CARRIED, *_OWN} or count < degree + 2 or not steps.all():
        return None
    if given.get("goal", "near") != "near":
        return None
    options = [
        (k, tuple(map(float, v)) if np.ndim(v) else int(v) if k == "degree" else v)
        for k in _CARRIED
        if (v := given.get(k)) is not None and (np.ndim(v) or v != _PLAIN.get(k))
    ]
    return DeskSource(
        "curves", name, places(data), 3,
        (DeskLine(name, tuple(range(count)), bool(given.get("closed"))),),
        objects=tuple(row if isinstance(row, str) else "" for row in rows),
        breaks=tuple(int(k) - 1 for k in given.get("breaks", ())),
        options=tuple(options), tolerance=float(given.get("tolerance", 0.0)),
    )  # fmt: skip


def is_point(document: Any, name: str) -> bool:
    """True if an object of a model is a point."""
    return bool(document.object(name)["class"] == "point")


def place(p: Any) -> Place:
    """Three coordinates as Python floats, which JSON stores exactly."""
    x, y, z = (float(c) for c in (*p, 0.0, 0.0)[:3])
    if not np.isfinite([x, y, z]).all():
        raise FairingError(f"expected a place, found {p}")
    return x, y, z


def places(points: Any) -> tuple[Place, ...]:
    """Rows of points as plain tuples."""
    return tuple(place(p) for p in (points.tolist() if hasattr(points, "tolist") else points))


def of_table(file: PointFile, text: str | None) -> DeskSource:
    """The lines of a file of points; those of a table of offsets share points."""
    width = file.width
    rows: list[int] = []
    known: dict[bytes, int] = {}
    of_row = []
    for k, point in enumerate(file.points):
        key = (point + 0.0).tobytes()
        if key not in known:
            known[key] = len(rows)
            rows.append(k)
        of_row.append(known[key])
    blocks = [b for b in file.blocks if len(b) > 1]
    lists = [[of_row[i] for i in block] for block in blocks]
    shared = len(rows) < sum(map(len, lists)) and len(lists) > 1
    kind = "network" if file.offsets or shared else "curves"
    if kind == "curves":
        # Without shared points every row is a point of its own, so that rows write back.
        rows, lists = list(range(len(file.points))), [list(b) for b in blocks]
    data, _ = points_of(file.points[rows])
    lines = []
    for k, own in enumerate(lists):
        closed = len(own) > 3 and own[0] == own[-1]
        named = _line_name(file, data[own], k) if file.offsets else f"curve {k + 1}"
        lines.append(DeskLine(named, tuple(own[:-1] if closed else own), closed))
    if len(lines) == 1:
        lines[0] = DeskLine(file.path.stem, lines[0].points, lines[0].closed)
    names = tuple(_point_name(file, p) for p in data) if file.offsets else ()
    moves: str | Place = "ball"
    if file.offsets:
        moves = (0.0, 1.0, 0.0) if file.moves == 1 else (0.0, 0.0, 1.0)
    table = None if text is None else (file.path.name, text)
    source = DeskSource(
        kind, file.path.name, places(data), width, tuple(lines), names, moves, file.unit,
        table=table,
    )  # fmt: skip
    return source._checked()


def _line_name(file: PointFile, points: Floats, k: int) -> str:
    other = 3 - file.moves
    if points[0, 0] == points[1, 0]:
        return f"station {points[0, 0]:g}"
    return f"{'waterline' if other == 2 else 'buttock'} {points[0, other]:g}"


def _point_name(file: PointFile, point: Floats) -> str:
    other = 3 - file.moves
    word = "waterline" if other == 2 else "buttock"
    return f"station {point[0]:g}, {word} {point[other]:g}"


explain(globals())
