"""Values of sketches: replies and changes of commands, and the parts of an object."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import Error

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "DimensionMark",
    "Gradient",
    "ObjectChange",
    "PlaneOfPoints",
    "Reply",
    "ReplySubject",
    "SketchChain",
    "SketchDimension",
    "SketchFace",
    "SketchLine",
    "SketchObject",
    "SketchPoint",
    "SketchProposal",
    "SketchSnap",
    "SketchStroke",
    "SketchStrokePiece",
    "SketchSuggestion",
]


@dataclass(frozen=True)
class ReplySubject:
    """Subject of a reply.

    Attributes
    ----------
    kind
        Type of the message, a stable word: ``"missing-dimension"``, ``"doubtful-type"``, ``"gap"``,
        ``"planes-passed"``, ``"type-contradiction"``, ``"chain"``, ``"open-body"``, ...
    points, lines, faces
        Labels, in the order of the sentence; the points of a chain from its start to its end, the
        line of a contradiction that is likeliest to be wrong first.
    names
        Dimensions, variables and curves.
    axis
        ``"X"``, ``"Y"``, ``"Z"`` or None.
    value
        The number of the sentence: a distance, a coordinate, a confidence from 0 to 1.
    place
        Position in space, ``(x, y, z)``.
    suggestion
        The dimension that would supply what is missing.
    """

    kind: str
    points: tuple[int, ...] = ()
    lines: tuple[int, ...] = ()
    faces: tuple[int, ...] = ()
    names: tuple[str, ...] = ()
    axis: str | None = None
    value: float | None = None
    place: tuple[float, float, float] | None = None
    suggestion: SketchSuggestion | None = None

    @staticmethod
    def _of(row: Any) -> ReplySubject:
        kind, points, lines, faces, names, axis, value, place, suggestion = row
        return ReplySubject(
            kind,
            tuple(points),
            tuple(lines),
            tuple(faces),
            tuple(names),
            axis,
            value,
            None if place is None else (place[0], place[1], place[2]),
            None if suggestion is None else SketchSuggestion(*suggestion),
        )

    def to_dict(self) -> dict[str, Any]:
        """The same as plain data."""
        return asdict(self)


@dataclass(frozen=True)
class Reply:
    """Reply of a command.

    Attributes
    ----------
    severity
        ``"error"`` (the command was refused and changed nothing), ``"warning"`` or ``"note"``.
    text
        Text of the reply.
    next
        The next step, for errors and questions.
    code
        The number of the manual's table of errors, where it has one.
    file
        Name and content of a file that SAVE or EXPORT made.
    about
        Subject of the sentence, as data; None for plain answers.
    """

    severity: str
    text: str
    next: str | None = None
    code: int | None = None
    file: tuple[str, bytes] | None = None
    about: ReplySubject | None = None

    @staticmethod
    def from_row(row: Any) -> Reply:
        """The reply for an answer of the session.

        Parameters
        ----------
        row
            Severity, number, text, next input, file and subject.

        Returns
        -------
        Reply
            The same as an object.
        """
        severity, code, text, following, file, about = row
        subject = None if about is None else ReplySubject._of(about)
        return Reply(severity, text, following, code, file, subject)

    @property
    def is_error(self) -> bool:
        """True if the command failed."""
        return self.severity == "error"

    def __str__(self) -> str:
        number = f" {self.code}" if self.code is not None else ""
        head = "" if self.severity == "note" else f"{self.severity}{number}: "
        lines = head + self.text
        return f"{lines}\n  next: {self.next}" if self.next else lines

    def to_dict(self) -> dict[str, Any]:
        """The reply as plain data, without the bytes of its file."""
        return {
            "severity": self.severity,
            "code": self.code,
            "text": self.text,
            "next": self.next,
            "file": self.file[0] if self.file else None,
            "about": self.about.to_dict() if self.about else None,
        }


@dataclass(frozen=True)
class Gradient:
    """Exact derivatives with respect to dimensions, in the requested order.

    Attributes
    ----------
    by
        The names.
    volume, area
        Shape ``(n,)``.
    centroid
        Shape ``(n, 3)``.
    points
        Derivatives of the vertices of :meth:`Sketch.mesh` that are corners of the body, ``(n,
        vertices, 3)``; NaN where a vertex splits.
    kinks
        For each name None, or where and why the area, or all three figures, have no derivative
        but one on each side; those are NaN.
    """

    by: tuple[str, ...]
    volume: NDArray[np.float64]
    area: NDArray[np.float64]
    centroid: NDArray[np.float64]
    points: NDArray[np.float64]
    kinks: tuple[str | None, ...] = ()


@dataclass(frozen=True)
class ObjectChange:
    """Change of an object of a sketch.

    Attributes
    ----------
    name
        The object.
    added, removed
        True if it is new, or deleted.
    body
        True if the finished body has changed.
    drawn
        Points that are new or elsewhere on the page.
    moved
        Points whose coordinates are others.
    removed_points
        Points that are gone.
    lines, faces
        Lines and faces that are new, changed or gone.
    numbers
        Dimensions, variables and curves that are new, changed or gone.
    """

    name: str
    added: bool
    removed: bool
    body: bool
    drawn: tuple[int, ...]
    moved: tuple[int, ...]
    removed_points: tuple[int, ...]
    lines: tuple[int, ...]
    faces: tuple[int, ...]
    numbers: tuple[str, ...]

    @staticmethod
    def _of(row: tuple[str, list[bool], list[list[int]], list[str]]) -> ObjectChange:
        name, flags, parts, numbers = row
        drawn, moved, removed, lines, faces = (tuple(p) for p in parts)
        added, gone, body = flags
        return ObjectChange(
            name, added, gone, body, drawn, moved, removed, lines, faces, tuple(numbers)
        )


@dataclass(frozen=True)
class SketchSnap:
    """A position on the page to which the pointer snaps.

    Attributes
    ----------
    at
        Position, ``(u, v)``.
    kind
        ``"point"``, ``"cross"`` (of two directions), ``"mid"`` (of a line), ``"line"``, ``"axis"``,
        ``"extension"`` (of a line) or ``"parallel"`` (of a line, through the start).
    point
        The point at the position.
    line
        The line at the position.
    part
        The part of the line's length, 0 to 1.
    directions
        The directions through the position: axes, or lines such as ``"line 4"``; two of a crossing.
    of
        The points that the directions start from.
    """

    at: tuple[float, float]
    kind: str
    point: int | None = None
    line: int | None = None
    part: float | None = None
    directions: tuple[str, ...] = ()
    of: tuple[int, ...] = ()

    @staticmethod
    def from_row(row: Any) -> SketchSnap:
        """The snap for a row of the session.

        Parameters
        ----------
        row
            Position, kind, point, line with the part of its length, directions and their points.

        Returns
        -------
        SketchSnap
            The same as an object.
        """
        (u, v), kind, point, line, directions, of = row
        on, part = (None, None) if line is None else line
        return SketchSnap((u, v), kind, point, on, part, tuple(directions), tuple(of))


@dataclass(frozen=True)
class SketchProposal:
    """The likeliest type of a line by the judgement of the whole drawing.

    Attributes
    ----------
    line
        Its label.
    type
        Coordinates that change along it: ``"X"``, ``"XY"``, ``"O"``, ...
    probability
        Of the type, 0 to 1.
    alternatives
        Other types with their probabilities, the likeliest first; None for an inclined line
        without a type.
    """

    line: int
    type: str
    probability: float
    alternatives: tuple[tuple[str | None, float], ...] = ()


@dataclass(frozen=True)
class SketchStrokePiece:
    """A piece of a stroke of a pen.

    Attributes
    ----------
    kind
        ``"line"``, ``"arc"``, ``"circle"``, ``"elliptical arc"``, ``"ellipse"`` or ``"spline"``.
    points
        The ends of a line; start, middle and end of an arc; none of a circle or ellipse; the
        3 n + 1 Bezier points of a spline of n cubics.
    centre
        Centre of an arc, circle or ellipse.
    radius
        Radius of an arc or circle.
    half_axes
        Half-axes of an ellipse as vectors, the longer one first.
    residual
        Root mean square distance of the samples.
    smooth
        True if the next piece continues it without a corner.
    """

    kind: str
    points: tuple[tuple[float, float], ...]
    centre: tuple[float, float] | None
    radius: float | None
    half_axes: tuple[tuple[float, float], tuple[float, float]] | None
    residual: float
    smooth: bool


@dataclass(frozen=True)
class SketchStroke:
    """A stroke of a pen as lines, arcs, ellipses and splines, joined end to start.

    Attributes
    ----------
    pieces
        The pieces in the order of the stroke.
    closed
        True if the last piece ends at the start of the first one.
    noise
        Standard deviation of the samples across the stroke.
    tolerance
        Distance within which ends are one point.
    command
        The command that draws it.
    """

    pieces: tuple[SketchStrokePiece, ...]
    closed: bool
    noise: float
    tolerance: float
    command: str

    @staticmethod
    def of(samples: ArrayLike) -> SketchStroke:
        """Fit pieces to the samples of one stroke, in time proportional to their number.

        The stroke is divided into lines and arcs of least description length by dynamic
        programming (Horng and Li, Pattern Recognition Letters 22, 2001; Schwarz, Annals of
        Statistics 6, 1978); the noise of the hand is estimated with them.

        Parameters
        ----------
        samples
            Rows of position ``(n, 2)``, with time ``(n, 3)`` and pressure ``(n, 4)``. Samples are
            put in the order of time; those of pressure 0 are not drawn.

        Returns
        -------
        SketchStroke
            Pieces, noise and tolerance in units of the page.

        Raises
        ------
        Error
            A sample is not finite, or all are at one position.

        Examples
        --------
        >>> from moldloft.shapes.sketch_values import SketchStroke
        >>> corner = [(5 * k, 0) for k in range(20)] + [(100, 5 * k) for k in range(20)]
        >>> [piece.kind for piece in SketchStroke.of(corner).pieces]
        ['line', 'line']
        """
        rows = np.asarray(samples, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] not in (2, 3, 4):
            raise Error(f"samples: expected rows of 2 to 4 numbers, found shape {rows.shape}")
        times, pressures = (rows[:, k].tolist() if rows.shape[1] > k else None for k in (2, 3))
        found = _core.sketch_stroke(rows[:, :2].tolist(), times, pressures)
        pieces, closed, noise, tolerance, command = found

        def pair(at: Any) -> tuple[float, float]:
            return (at[0], at[1])

        def piece(row: Any) -> SketchStrokePiece:
            kind, points, centre, radius, axes, residual, smooth = row
            return SketchStrokePiece(
                kind,
                tuple(map(pair, points)),
                None if centre is None else pair(centre),
                radius,
                None if axes is None else (pair(axes[0]), pair(axes[1])),
                residual,
                smooth,
            )

        return SketchStroke(tuple(map(piece, pieces)), closed, noise, tolerance, command)


@dataclass(frozen=True)
class SketchSuggestion:
    """A missing dimension with the value suggested by the drawing.

    Attributes
    ----------
    axis
        ``"X"``, ``"Y"`` or ``"Z"``.
    p, q
        From the point ``p`` to the point ``q``.
    value
        The distance.
    guess
        True when the picture leaves the depth open.
    """

    axis: str
    p: int
    q: int
    value: float
    guess: bool


@dataclass(frozen=True)
class SketchChain:
    """The dimensions that determine a distance along an axis.

    Attributes
    ----------
    axis
        ``"X"``, ``"Y"`` or ``"Z"``.
    points
        Intermediate points.
    names
        The dimensions between them; empty for points of one plane.
    value
        The distance; None while it is not determined.
    lines
        For points of one plane, the lines that put them there.
    """

    axis: str
    points: tuple[int, ...]
    names: tuple[str, ...]
    value: float | None
    lines: tuple[int, ...] = ()


@dataclass(frozen=True)
class PlaneOfPoints:
    """A dimensioning plane.

    Attributes
    ----------
    axis
        The axis that it is perpendicular to.
    points
        The points in it.
    at
        Its coordinate; None while it is free.
    """

    axis: str
    points: tuple[int, ...]
    at: float | None


@dataclass(frozen=True)
class DimensionMark:
    """Position of a dimension on a drawing, v up.

    Attributes
    ----------
    name
        The dimension.
    text
        Text, in brackets for a measured dimension.
    value
        Its value; None while it is unknown.
    reference
        True for a measured dimension.
    axis
        Its axis; None for lengths, slopes, angles and equal lengths.
    at
        The middle of the text, ``(u, v)``.
    line
        The dimension line, ``((u, v), (u, v))``; None without one.
    witnesses
        The witness lines.
    """

    name: str
    text: str
    value: float | None
    reference: bool
    axis: str | None
    at: tuple[float, float]
    line: tuple[tuple[float, float], tuple[float, float]] | None
    witnesses: tuple[tuple[tuple[float, float], tuple[float, float]], ...]

    @staticmethod
    def _of(row: Any) -> DimensionMark:
        name, text, value, reference, axis, at, line, witnesses = row

        def ends(pair: Any) -> tuple[tuple[float, float], tuple[float, float]]:
            (a, b), (c, d) = pair
            return ((a, b), (c, d))

        return DimensionMark(
            name,
            text,
            value,
            reference,
            axis,
            (at[0], at[1]),
            None if line is None else ends(line),
            tuple(ends(w) for w in witnesses),
        )


@dataclass(frozen=True)
class SketchPoint:
    """A point of an object.

    Attributes
    ----------
    id
        Its label.
    at
        Its coordinates, None for free ones.
    page
        Position in the drawing; None for a tangent point of a curve.
    """

    id: int
    at: tuple[float | None, float | None, float | None]
    page: tuple[float, float] | None


@dataclass(frozen=True)
class SketchLine:
    """A line of an object.

    Attributes
    ----------
    id
        Its label.
    points
        Its ends.
    type
        Coordinates that change along it: ``"X"``, ``"XY"``, ``"O"``, ...; empty while unknown.
    source
        Who typed it: ``"user"``, ``"auto"`` by its slope or all strokes together, ``"inferred"``
        from the planes of the others.
    certainty
        Confidence of the type, from 0 to 1; 1 for a type set by the user.
    """

    id: int
    points: tuple[int, int]
    type: str
    source: str
    certainty: float


@dataclass(frozen=True)
class SketchFace:
    """A face of an object.

    Attributes
    ----------
    id
        Its number.
    outer
        The points round it.
    holes
        The points round each of its holes.
    """

    id: int
    outer: tuple[int, ...]
    holes: tuple[tuple[int, ...], ...]


@dataclass(frozen=True)
class SketchDimension:
    """A dimension of an object.

    Attributes
    ----------
    name
        Its name.
    measures
        Measured quantity, in the form of a command: ``"X 1 TO 2"``, ``"LENGTH 4"``, ...
    value
        Its value; None while it is unknown.
    """

    name: str
    measures: str
    value: float | None


@dataclass(frozen=True)
class SketchObject:
    """An object with its parts.

    Attributes
    ----------
    name
        Its name.
    state
        ``"sketch"``, ``"planes"`` (fully dimensioned) or ``"solid"``.
    points, lines, faces
        Its parts by label.
    dimensions
        Its dimensions by name.
    missing
        Number of missing dimensions on each axis.
    volume, area, centroid
        Measures of the finished body; None without one, except the volume of a cross section.
    """

    name: str
    state: str
    points: dict[int, SketchPoint]
    lines: dict[int, SketchLine]
    faces: dict[int, SketchFace]
    dimensions: dict[str, SketchDimension]
    missing: dict[str, int]
    volume: float | None
    area: float | None
    centroid: NDArray[np.float64] | None

    @staticmethod
    def _of(data: dict[str, Any]) -> SketchObject:
        def point(row: dict[str, Any]) -> SketchPoint:
            x, y, z = row["at"]
            page = row["page"]
            return SketchPoint(row["id"], (x, y, z), None if page is None else (page[0], page[1]))

        points = [point(row) for row in data["points"]]
        lines = [
            SketchLine(
                row["id"],
                (row["points"][0], row["points"][1]),
                row["type"] or "",
                row["source"],
                row["certainty"],
            )
            for row in data["lines"]
        ]
        faces = [
            SketchFace(row["id"], tuple(row["outer"]), tuple(tuple(h) for h in row["holes"]))
            for row in data["faces"]
        ]
        dimensions = [
            SketchDimension(row["name"], row["measures"], row["value"])
            for row in data["dimensions"]
        ]
        centre = data["centroid"]
        return SketchObject(
            data["name"],
            data["state"],
            {p.id: p for p in points},
            {line.id: line for line in lines},
            {f.id: f for f in faces},
            {d.name: d for d in dimensions},
            data["missing"],
            data["volume"],
            data["area"],
            None if centre is None else np.array(centre, dtype=np.float64),
        )


explain(globals())
