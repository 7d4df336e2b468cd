"""Sketches: a rough picture, types of lines and a few dimensions become an exact solid."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import Error, FileError, UnknownNameError
from moldloft.shapes.sketch_values import (
    DimensionMark,
    Gradient,
    ObjectChange,
    PlaneOfPoints,
    Reply,
    ReplySubject,
    SketchChain,
    SketchDimension,
    SketchFace,
    SketchLine,
    SketchObject,
    SketchPoint,
    SketchProposal,
    SketchSnap,
    SketchStroke,
    SketchStrokePiece,
    SketchSuggestion,
)
from moldloft.storage import read_text, utf8_path

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "DimensionMark",
    "Drag",
    "Gradient",
    "ObjectChange",
    "PlaneOfPoints",
    "Reply",
    "ReplySubject",
    "Sketch",
    "SketchChain",
    "SketchDimension",
    "SketchError",
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


class SketchError(Error, ValueError):
    """An invalid command; ``replies`` has all replies to the text up to it."""

    def __init__(self, message: str, replies: Sequence[Reply] = ()) -> None:
        super().__init__(message)
        self.replies = tuple(replies)

    @property
    def rendered(self) -> str:
        """The replies unchanged, or the message after ``error:``."""
        return str(self).rstrip() if self.replies else super().rendered


def _restored(folder: str | os.PathLike[str] | None, text: str) -> Sketch:
    sketch = Sketch(folder)
    sketch.run(text)
    return sketch


class Sketch:
    """A session of the sketch language, with its objects.

    Parameters
    ----------
    folder
        First folder in which INPUT and RUN look; the second is the current one.

    Examples
    --------
    >>> from moldloft import Sketch
    >>> s = Sketch()
    >>> _ = s.run('''
    ...     SKETCH SLAB 2D XZ
    ...     POINT 1 0 0; POINT 2 90 2; POINT 3 91 30; POINT 4 1 29
    ...     POLYLINE 1 2 3 4 CLOSE
    ...     DIMENSION W X 1 2 = 8; DIMENSION H Z 1 4 = 2 IN 1 5; EXTRUDE 5
    ... ''')
    >>> s.volume
    80.0
    >>> s["H"] = 3
    >>> s.volume, s.gradient(["H"]).volume
    (120.0, array([40.]))
    >>> s.sweep("H", [1, 2])[:, 0]
    array([40., 80.])
    >>> s.run("SET H 9")
    Traceback (most recent call last):
      ...
    moldloft.shapes.sketches.SketchError: error: H = 9 is outside its range, 1 to 5
      next: give a number in it, or another range: SET H 9 IN lo hi
    """

    def __init__(self, folder: str | os.PathLike[str] | None = None) -> None:
        # `os.path` answers for names that no system takes, too.
        if folder is not None and not os.path.isdir(os.fspath(folder)):  # noqa: PTH112
            raise FileError(f"`{folder}` is not a folder; `Sketch.load(path)` reads a file")
        self._folder = folder
        self._session = _core.SketchSession(None if folder is None else utf8_path(folder))

    def __reduce__(self) -> tuple[Callable[..., Sketch], tuple[Any, ...]]:
        """Copies and pickles hold the commands that reproduce the objects, without the history."""
        return _restored, (self._folder, self.text)

    @property
    def session(self) -> _core.SketchSession:
        """The underlying session, for line-by-line use."""
        return self._session

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, strict: bool = True) -> Sketch:
        """Run a file of commands, or read a JSON twin.

        Parameters
        ----------
        path
            The file.
        strict
            True to raise an error at an invalid command instead of continuing.

        Returns
        -------
        Sketch
            It has been run.

        Raises
        ------
        FileError
            If it cannot be read.
        SketchError
            If a command was refused and ``strict`` is true.
        """
        path = Path(utf8_path(path))
        text = read_text(path)
        sketch = cls(path.parent)
        # Its lines are somebody else's: they read inside of the file's folder.
        sketch.session.confine(True)
        if text.lstrip().startswith(("[", "{")):
            sketch.run(f'INPUT "{path.name}"', strict=strict)
        else:
            sketch.run(text, strict=strict)
        sketch.session.confine(False)
        return sketch

    # -- commands ----------------------------------------------------------------------------

    def run(self, text: str, *, strict: bool = True) -> list[Reply]:
        """Run one or more lines of commands.

        The bodies of features that they change are made once, after the last line.

        Parameters
        ----------
        text
            The lines.
        strict
            Raise when a command is refused; the lines after it are then not run.

        Returns
        -------
        list of Reply
            Files that SAVE and EXPORT made are in the replies; nothing is written to disk.

        Raises
        ------
        SketchError
            For the first refused command.
        """
        replies: list[Reply] = []
        bad: Reply | None = None
        self._session.hold()
        try:
            for line in text.splitlines():
                new = [Reply.from_row(row) for row in self._session.run_line(line)]
                replies += new
                bad = next((r for r in new if r.is_error), None)
                if strict and bad is not None:
                    break
        finally:
            replies += [Reply.from_row(row) for row in self._session.settle()]
        if strict and bad is not None:
            raise SketchError(str(bad), replies)
        return replies

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write all objects as commands or, by the extension, as JSON; atomically.

        Parameters
        ----------
        path
            The file.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        SketchError
            If there is nothing to save.
        FileError
            If there is no such folder, or it cannot be written to.
        """
        from moldloft.exchange.files import Output, commit

        path = Path(path)
        reply = self.run(f'SAVE AS "{path.name}"')[-1]
        assert reply.file is not None
        return commit(path.parent, [Output(path.name, reply.file[1])], make=False)[0]

    def export(
        self, path: str | os.PathLike[str], *, format: str | None = None, name: str | None = None
    ) -> Path:
        """Write an object: STEP, STL, OBJ, glTF, GLB, 3MF, DXF, SVG, JSON or PNG.

        Parameters
        ----------
        path
            The file.
        format
            By default what the file's name ends in.
        name
            The object; by default the active one.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        UnknownNameError
            If there is no such object, or no object is active.
        SketchError
            If it has no body.
        FileError
            If there is no such folder, or it cannot be written to.
        """
        from moldloft.exchange.files import Output, commit

        path = Path(path)
        wanted = (format or path.suffix.lstrip(".")).lower()
        if wanted == "png":
            data = self.picture(name=name)
        else:
            reply = self.run(f'EXPORT {wanted} "{self._name(name)}" "{path.name}"')[-1]
            assert reply.file is not None
            data = reply.file[1]
        return commit(path.parent, [Output(path.name, data)], make=False)[0]

    # -- edits as data -----------------------------------------------------------------------

    def edit(self, text: str) -> list[ObjectChange]:
        """Run one line of commands and report its changes.

        Parameters
        ----------
        text
            The line.

        Returns
        -------
        list of ObjectChange
            The objects that changed, each with its points, lines, faces and dimensions.

        Raises
        ------
        SketchError
            If a command is refused.
        """
        rows, changes = self._session.report(text)
        replies = [Reply.from_row(row) for row in rows]
        bad = next((r for r in replies if r.is_error), None)
        if bad is not None:
            raise SketchError(str(bad), replies)
        return [ObjectChange._of(row) for row in changes]

    def draw(
        self, points: ArrayLike, lines: ArrayLike = (), *, types: Sequence[str | None] | None = None
    ) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
        """Draw points and lines into the active object.

        Parameters
        ----------
        points
            Points on the page, ``(n, 2)``.
        lines
            Ends of lines as rows of ``points``, from 0, ``(m, 2)``.
        types
            The type of each line (``"X"``, ``"H"``, ``"O"``, ...); ``None`` to infer it from the
            slope.

        Returns
        -------
        tuple
            The labels of the new points ``(n,)`` and of the new lines ``(m,)``.
        """
        places = _pairs("points", points, np.float64)
        ends = _pairs("lines", lines, np.int64)
        if ends.size and (ends.min() < 0 or ends.max() >= len(places)):
            raise SketchError(f"lines: expected indices of the {len(places)} points")
        kinds = [None] * len(ends) if types is None else list(types)
        if len(kinds) != len(ends):
            raise SketchError(f"{len(kinds)} types for {len(ends)} lines")
        first = int(self.labels.max(initial=0)) + 1
        commands = [f"POINT {first + k} AT {u!r} {v!r}" for k, (u, v) in enumerate(places.tolist())]
        for (p, q), kind in zip(ends.tolist(), kinds, strict=True):
            typed = f" TYPE {kind}" if kind else ""
            commands.append(f"LINE FROM {first + p} TO {first + q}{typed}")
        with self.drag() as drag:
            self.run("; ".join(commands))
        made = [n for change in drag.changes for n in change.lines]
        labels = np.arange(first, first + len(places), dtype=np.uint32)
        return labels, np.array(sorted(made), dtype=np.uint32)

    def dimension(
        self, axis: str, p: int, q: int, value: float | str, *, name: str | None = None
    ) -> list[ObjectChange]:
        """Set the difference between the coordinates of point ``q`` and point ``p``.

        Parameters
        ----------
        axis
            ``"X"``, ``"Y"`` or ``"Z"``.
        p, q
            Labels of points.
        value
            A number or an expression.
        name
            The name of the dimension; by default a new one.

        Returns
        -------
        list of ObjectChange
            The objects that changed, as :meth:`edit` gives them.
        """
        given = f'"{value}"' if isinstance(value, str) else repr(float(value))
        return self.edit(f"DIMENSION {name or ''} {axis} {p} TO {q} = {given}")

    def drag(self) -> Drag:
        """Edits that count as one step of UNDO and one line of the journal.

        Returns
        -------
        Drag
            To be used in a `with` statement; an exception in it takes all edits back.

        Examples
        --------
        >>> from moldloft import Sketch
        >>> s = Sketch()
        >>> _ = s.run("SKETCH A 2D XZ; POINT 1 0 0; POINT 2 9 0; LINE 1 2")
        >>> with s.drag() as drag:
        ...     for u in range(100):
        ...         drag.move(2, 9 + u, 0.1 * u)
        >>> drag.changes[0].drawn
        (2,)
        >>> _ = s.run("UNDO")
        >>> s.snaps(9.2, 0.1, 1)[0].at
        (9.0, 0.0)
        """
        return Drag(self)

    def snaps(
        self,
        u: float,
        v: float,
        reach: float,
        *,
        start: tuple[float, float] | None = None,
        awake: Sequence[int] = (),
        name: str | None = None,
    ) -> list[SketchSnap]:
        """Meanings of a pointer position, the likeliest first.

        In this order: the nearest point; crossings of a direction through ``start`` with an axis
        through a point, or of two through points of ``awake``; the middle of the nearest line; that
        line; directions through the start and the points of ``awake``; axes through other points.
        Directions are the axes, the lines that end at a point of ``awake``, as extensions of it,
        and their parallels through the start.

        Parameters
        ----------
        u, v
            Position on the page.
        reach
            Maximum distance.
        start
            Start of a line under construction.
        awake
            Points whose directions are wanted, such as those under which the pointer rested.
        name
            The object; by default the active one.

        Returns
        -------
        list of SketchSnap
            Empty if nothing is within reach.
        """
        begin = None if start is None else [float(start[0]), float(start[1])]
        rows = self._session.snaps(
            self._name(name), [float(u), float(v)], float(reach), begin, [int(p) for p in awake]
        )
        return [SketchSnap.from_row(row) for row in rows]

    def proposals(self, *, name: str | None = None) -> list[SketchProposal]:
        """The likeliest types of the lines that the user has not typed.

        ``TYPE AUTO`` writes those of a probability of at least ``SET CERTAINTY``.

        Parameters
        ----------
        name
            The object; by default the active one.

        Returns
        -------
        list of SketchProposal
            By number of the line.
        """
        rows = self._session.type_proposals(self._name(name))
        return [SketchProposal(line, kind, p, tuple(others)) for line, kind, p, others in rows]

    def stroke(self, samples: ArrayLike) -> tuple[SketchStroke, list[ObjectChange]]:
        """Draw a stroke of a pen into the active object as lines, arcs, circles and ellipses.

        Ends are those of the drawing's points within the tolerance of the stroke.

        Parameters
        ----------
        samples
            As for :meth:`SketchStroke.of`.

        Returns
        -------
        tuple
            The pieces, and the changes.
        """
        stroke = SketchStroke.of(samples)
        return stroke, self.edit(stroke.command)

    def suggestions(self, *, name: str | None = None) -> list[SketchSuggestion | None]:
        """The missing dimensions suggested by the drawing, one for each undetermined part.

        Parameters
        ----------
        name
            The object; by default the active one.

        Returns
        -------
        list of SketchSuggestion or None
            One for each separate part; None if the picture does not determine a value.
        """
        rows = self._session.suggestions(self._name(name))
        return [None if row is None else SketchSuggestion(*row) for row in rows]

    def candidates(
        self, *, name: str | None = None
    ) -> list[tuple[NDArray[np.float64], NDArray[np.uint32]]]:
        """The bodies that fit the wireframe, most likely first, in the form of :meth:`mesh`.

        Parameters
        ----------
        name
            The object; by default the active one.

        Returns
        -------
        list of (ndarray, ndarray)
            Vertices, ``(n, 3)``, and faces, ``(m, 4)``, of each body; a triangle has its last
            vertex twice.
        """
        return self._session.candidates(self._name(name), False)

    def preview(
        self, *, name: str | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.uint32]] | None:
        """The body estimated from drawing and dimensions, in the form of :meth:`mesh`.

        Parameters
        ----------
        name
            The object; by default the active one.

        Returns
        -------
        (ndarray, ndarray) or None
            Vertices, ``(n, 3)``, and faces, ``(m, 4)``, a triangle with its last vertex twice; None
            without a known body.
        """
        found = self._session.candidates(self._name(name), True)
        return found[0] if found else None

    def check(self, *, name: str | None = None) -> list[Reply]:
        """Doubtful, missing or contradictory data.

        Parameters
        ----------
        name
            The object; by default the active one, and it stays the active one.

        Returns
        -------
        list of Reply
            Replies with a subject in ``about``: doubtful types, gaps, contradictions, missing
            dimensions with a suggestion, planes in the wrong order, faults of the body.

        Examples
        --------
        >>> from moldloft import Sketch
        >>> s = Sketch()
        >>> _ = s.run("SKETCH A 2D XZ; POINT 1 0 0; POINT 2 90 0; LINE 1 2")
        >>> [(r.about.kind, r.about.points, r.about.suggestion.value) for r in s.check()]
        [('missing-dimension', (2,), 90.0)]
        """
        active = self.active
        try:
            replies = self.run(f'CHECK "{self._name(name)}"')
        finally:
            if active is not None and active != self.active:
                self.run(f'USING "{active}"')
        return [reply for reply in replies if reply.about is not None]

    def why(self, axis: str, p: int, q: int) -> SketchChain:
        """The chain of dimensions that determines the distance of two points of the active object.

        Parameters
        ----------
        axis
            ``"X"``, ``"Y"`` or ``"Z"``.
        p, q
            Labels of points.

        Returns
        -------
        SketchChain
            Points and dimensions between ``p`` and ``q``, and the distance.
        """
        about = self.run(f"WHY {axis} {int(p)} {int(q)}")[-1].about
        assert about is not None and about.axis is not None
        return SketchChain(about.axis, about.points, about.names, about.value, about.lines)

    def planes(self) -> list[PlaneOfPoints]:
        """The dimensioning planes of the active object, by axis and coordinate, free ones last.

        Returns
        -------
        list of PlaneOfPoints
            Each with its points.
        """
        found = [reply.about for reply in self.run("EXTENSIONS")]
        return [
            PlaneOfPoints(one.axis, one.points, one.value)
            for one in found
            if one is not None and one.axis is not None
        ]

    def marks(self, *, name: str | None = None, view: str | None = None) -> list[DimensionMark]:
        """Layout of the dimensions on the drawing: dimension lines, witness lines, texts.

        Parameters
        ----------
        name
            The object; by default the active one.
        view
            ``"TOP"``, ``"FRONT"``, ``"SIDE"``, ``"ISO"``, ... for a view of the body; by default
            the page as it was drawn.

        Returns
        -------
        list of DimensionMark
            In the order of the dimensions; those that a view looks along are left out.

        Raises
        ------
        UnknownNameError
            If there is no such object or view.

        Examples
        --------
        >>> from moldloft import Sketch
        >>> s = Sketch()
        >>> _ = s.run("SKETCH A 2D XZ; POINT 1 0 0; POINT 2 90 0; LINE 1 2; DIM W X 1 2 = 8")
        >>> mark = s.marks()[0]
        >>> mark.text, mark.line[1][0] - mark.line[0][0]
        ('W 8', 90.0)
        """
        return [DimensionMark._of(row) for row in self._session.marks(self._name(name), view)]

    # -- objects -----------------------------------------------------------------------------

    def parts(self, name: str | None = None) -> SketchObject:
        """An object with its points, lines, faces and dimensions as values.

        Parameters
        ----------
        name
            The object; by default the active one.

        Returns
        -------
        SketchObject
            A snapshot: later edits do not change it.

        Raises
        ------
        UnknownNameError
            If there is no such object, or no object is active.

        Examples
        --------
        >>> from moldloft import Sketch
        >>> s = Sketch()
        >>> _ = s.run("SKETCH A 2D XZ; POINT 1 0 0; POINT 2 90 0; LINE 1 2; DIM W X 1 2 = 8")
        >>> a = s.parts()
        >>> a.lines[1].type, a.points[2].at, a.points[2].page
        ('X', (8, 0, 0), (90, 0))
        """
        wanted = self._name(name).lower()
        for known, data in self.objects.items():
            if known.lower() == wanted:
                return SketchObject._of(data)
        raise UnknownNameError(f"unknown object `{name}` in this sketch")

    @property
    def active(self) -> str | None:
        """The name of the active object, to which the properties below refer."""
        return self._session.active()

    @property
    def names(self) -> list[str]:
        """The names of all objects."""
        return self._session.names()

    @property
    def objects(self) -> dict[str, dict[str, Any]]:
        """All objects by name as data: the output of ``moldloft sketch --json``."""
        found = json.loads(self._session.objects_json())["objects"]
        return {one["name"]: one for one in found}

    @property
    def volume(self) -> float | None:
        """Enclosed volume of the active object; ``None`` without faces."""
        volume = self._data()["volume"]
        return None if volume is None else float(volume)

    @property
    def area(self) -> float | None:
        """Area of all faces of the active object; ``None`` without faces."""
        area = self._data()["area"]
        return None if area is None else float(area)

    @property
    def centroid(self) -> NDArray[np.float64] | None:
        """Centre of the volume, or of the area of a cross section, ``(3,)``."""
        centre = self._data()["centroid"]
        return None if centre is None else np.array(centre, dtype=np.float64)

    @property
    def points(self) -> NDArray[np.float64]:
        """Coordinates of the active object's points, ``(n, 3)``; NaN where they are free."""
        return self._session.points(self._name(None))[1]

    @property
    def labels(self) -> NDArray[np.uint32]:
        """The labels of :attr:`points`, ``(n,)``."""
        return self._session.points(self._name(None))[0]

    @property
    def dimensions(self) -> dict[str, float | None]:
        """Variables and dimensions of the active object with their values."""
        return {row[0]: row[1] for row in self._session.numbers(self._name(None))}

    @property
    def missing(self) -> dict[str, int]:
        """Number of missing dimensions on each axis of the active object."""
        missing: dict[str, int] = self._data()["missing"]
        return missing

    @property
    def text(self) -> str:
        """The commands that reproduce all objects."""
        return self._session.text(None)

    def mesh(
        self, *, name: str | None = None, tolerance: float | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
        """Vertices ``(n, 3)`` and faces ``(m, 4)`` of the body, counter-clockwise from outside.

        Parameters
        ----------
        name
            The object; by default the active one.
        tolerance
            Maximum distance of chords from curves; default: a thousandth of the body's size.

        Returns
        -------
        tuple of two numpy.ndarray
            Positions, and numbers of the corners of each face.

        Raises
        ------
        UnknownNameError
            If there is no such object, or no object is active.

        Notes
        -----
        A triangle has its last vertex twice.
        """
        return self._session.mesh(self._name(name), tolerance)

    def gradient(self, by: Sequence[str] | None = None, *, name: str | None = None) -> Gradient:
        """Exact derivatives of volume, area, centroid and corners with respect to dimensions.

        Parameters
        ----------
        by
            Dimensions and variables; by default all that have a value.
        name
            The object; by default the active one.

        Returns
        -------
        Gradient
            For each dimension the derivative of each figure. It is NaN where the two one-sided
            derivatives differ: where faces of combined bodies coincide, or an edge is in a face,
            and they move differently. ``kinks`` gives the positions; :meth:`sweep` gives
            differences.

        Raises
        ------
        UnknownNameError
            If there is no such object or dimension.
        """
        of = self._name(name)
        if by is None:
            by = [row[0] for row in self._session.numbers(of) if row[1] is not None]
        volume, area, centroid, points, kinks = self._session.gradient(of, list(by))
        return Gradient(tuple(by), volume, area, centroid, points, tuple(kinks))

    def sweep(self, by: str, values: ArrayLike, *, name: str | None = None) -> NDArray[np.float64]:
        """Volume, area and centroid at values of a dimension, ``(n, 5)``; the sketch is unchanged.

        Rows are NaN where there is no body.

        Parameters
        ----------
        by
            The name of a dimension or variable.
        values
            Its values, ``(n,)``.
        name
            The object; by default the active one.

        Returns
        -------
        numpy.ndarray
            A row for each value: volume, area, centroid x, y, z.

        Raises
        ------
        UnknownNameError
            If there is no such object or dimension.
        """
        wanted = np.asarray(values, dtype=np.float64).ravel().tolist()
        return self._session.sweep(self._name(name), by, wanted)

    def picture(
        self,
        width: int = 1200,
        height: int = 800,
        *,
        name: str | None = None,
        azimuth: float = -60.0,
        elevation: float = 25.0,
    ) -> bytes:
        """A PNG of the body, seen from the direction of two angles in degrees.

        Parameters
        ----------
        width
            Width of the picture, pixels.
        height
            Height of the picture, pixels.
        name
            The object; by default the active one.
        azimuth
            Direction of the view about z, degrees.
        elevation
            Height of the view, degrees.

        Returns
        -------
        bytes
            The PNG file.

        Raises
        ------
        UnknownNameError
            If there is no such object, or no object is active.
        """
        return self._session.picture(self._name(name), width, height, azimuth, elevation)

    def __getitem__(self, name: str) -> float:
        for known, value, _, _ in self._session.numbers(self._name(None)):
            if known.lower() == name.lower():
                if value is None:
                    raise UnknownNameError(f"`{known}` has no value")
                return value
        raise UnknownNameError(f"unknown dimension or variable `{name}`")

    def __setitem__(self, name: str, value: float | str) -> None:
        given = f'"{value}"' if isinstance(value, str) else repr(float(value))
        self.run(f"SET {name} {given}")

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name.lower() in (n.lower() for n in self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        return f"<Sketch: {', '.join(self.names) or 'no objects'}>"

    def _repr_png_(self) -> bytes | None:
        # A notebook shows the body; without one its text.
        try:
            return self.picture(480, 320)
        except Error:
            return None

    def _name(self, name: str | None) -> str:
        found = name or self._session.active()
        if found is None:
            raise UnknownNameError("no object is active: start one with SKETCH")
        return found

    def _data(self) -> dict[str, Any]:
        return self.objects[self._name(None)]


class Drag:
    """A sequence of edits of a :class:`Sketch` that counts as one; see :meth:`Sketch.drag`.

    Attributes
    ----------
    changes
        Total change, after the end.
    replies
        Warnings of features that lost their bodies, after the end.
    """

    def __init__(self, sketch: Sketch) -> None:
        self.changes: list[ObjectChange] = []
        self.replies: list[Reply] = []
        self._sketch = sketch

    def move(self, point: int, u: float, v: float) -> None:
        """Move a point of the active object on the page.

        Parameters
        ----------
        point
            Its label.
        u, v
            New position.
        """
        self._sketch.run(f"POINT {int(point)} AT {float(u)!r} {float(v)!r}")

    def __enter__(self) -> Drag:
        self._sketch.session.begin()
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            self._sketch.session.rollback()
            return
        replies, changes = self._sketch.session.commit()
        self.replies = [Reply.from_row(row) for row in replies]
        self.changes = [ObjectChange._of(row) for row in changes]


def _pairs(name: str, values: ArrayLike, kind: type[np.generic]) -> NDArray[Any]:
    """Rows of two numbers of a kind; an empty array has no rows."""
    found = np.asarray(values)
    if found.size and (found.ndim != 2 or found.shape[1] != 2):
        raise SketchError(f"`{name}`: expected an array of shape (n, 2), found {found.shape}")
    try:
        return found.astype(kind).reshape(-1, 2)
    except (TypeError, ValueError, OverflowError):
        raise SketchError(f"`{name}`: expected numbers, found {found.dtype}") from None


explain(globals())
