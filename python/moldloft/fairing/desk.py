"""The fairing desk: a session to inspect, mark and fair lines step by step.

Every step is a command, a line of text; the log of commands is the session. Replayed on what the
desk was opened on it gives the same bits, and taking back a step is leaving out its command.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.desk_lines import (
    DeskCurve,
    DeskResult,
    DeskSuspect,
    Progress,
    cut,
    draft_task,
    fair_line,
    faired,
)
from moldloft.fairing.desk_source import DeskSource, Place, place
from moldloft.fairing.desk_state import COMMANDS, DeskDraft, DeskState, changed
from moldloft.fairing.desk_text import program
from moldloft.fairing.faired import Fairing

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray

    from moldloft.fairing.files import PointFile
    from moldloft.fairing.spline import Spline
    from moldloft.fairing.surface import SplineSurface
    from moldloft.models import Model

    Floats = NDArray[np.float64]

__all__ = ["COMMANDS", "Desk", "DeskCurve", "DeskResult", "DeskSource", "DeskSuspect"]

REMEMBERED = 64
"""States whose results are kept."""


class Desk:
    """A fairing session: the points and lines, their marks, and the log of commands.

    Parameters
    ----------
    what
        Points ``(n, 2)`` or ``(n, 3)``, a grid ``(m, n, 3)``, a :class:`Spline`, a
        :class:`SplineSurface`, a :class:`~moldloft.fairing.files.PointFile`, or a
        :class:`DeskSource`.
    tolerance
        Maximum distance of curves from points; default :attr:`suggested`.
    log
        Commands to begin with, see :data:`COMMANDS`.

    Examples
    --------
    >>> import numpy as np
    >>> x = np.linspace(0, 10, 41)
    >>> noise = 0.01 * np.sin(37 * x**2)
    >>> desk = Desk(np.column_stack([x, 2 * np.sin(0.3 * x) + noise]), 0.02)
    >>> desk.result.curves[0].inflections[1]
    0
    >>> desk.run("fix 21")
    >>> bool(desk.result.curves[0].moved[20] < 1e-12)
    True
    >>> desk.run("range 5-30")
    >>> desk.log
    ('fix 21', 'range 5-30')
    >>> before = desk.result.points
    >>> desk.undo(), desk.redo()
    ('range 5-30', 'range 5-30')
    >>> desk.result.points == before and Desk.replay(desk.text).result.points == before
    True
    """

    def __init__(
        self,
        what: ArrayLike | Spline | SplineSurface | PointFile | DeskSource,
        tolerance: float | None = None,
        log: Sequence[str] = (),
    ) -> None:
        self.source = DeskSource.of(what)
        self._begin = self.suggested if tolerance is None else float(tolerance)
        if not (np.isfinite(self._begin) and self._begin >= 0):
            raise FairingError(f"expected a tolerance of at least 0, found {self._begin:g}")
        self._states = [self._first()]
        self._log: list[str] = []
        self._undone: list[str] = []
        self._results: dict[tuple[str, ...], DeskResult] = {}
        self.follow(log)

    @staticmethod
    def open(
        path: str | PathLike[str], tolerance: float | None = None, *, data: bytes | None = None
    ) -> Desk:
        """A desk with the lines of a file of points or of a table of offsets.

        Parameters
        ----------
        path
            The file.
        tolerance
            As for :class:`Desk`.
        data
            The bytes of the file, if they are in memory.
        """
        return Desk(DeskSource.of_file(str(path), data), tolerance)

    @staticmethod
    def of_object(model: Model, name: str, tolerance: float | None = None) -> Desk:
        """A desk with a curve or a surface of a model.

        Parameters
        ----------
        model
            The model.
        name
            The object.
        tolerance
            As for :class:`Desk`.
        """
        return Desk(DeskSource.of_object(model, name), tolerance)

    def _first(self) -> DeskState:
        source = self.source
        return DeskState(
            self._begin, source.points, source.lines, knuckles=frozenset(source.breaks)
        )

    # -- history ---------------------------------------------------------------------------------

    @property
    def state(self) -> DeskState:
        """The state after all commands."""
        return self._states[-1]

    @property
    def log(self) -> tuple[str, ...]:
        """The commands that were run and not undone."""
        return tuple(self._log)

    @property
    def undone(self) -> tuple[str, ...]:
        """The commands that :meth:`redo` runs again, the next one last."""
        return tuple(self._undone)

    @property
    def text(self) -> str:
        """The whole session as text (JSON): source, initial tolerance and log."""
        whole = {"source": self.source.as_dict(), "tolerance": self._begin, "log": self._log}
        return json.dumps(whole)

    @staticmethod
    def replay(text: str) -> Desk:
        """The session recorded in a text, the value of :attr:`text`.

        Parameters
        ----------
        text
            A session as text.
        """
        whole = json.loads(text)
        source = DeskSource.from_dict(whole["source"])
        return Desk(source, whole["tolerance"], whole["log"])

    def follow(self, log: Sequence[str]) -> None:
        """Replace the log; commands in common with the current one are not run again.

        Parameters
        ----------
        log
            Commands.
        """
        same = 0
        while same < min(len(log), len(self._log)) and log[same] == self._log[same]:
            same += 1
        del self._log[same:], self._states[same + 1 :]
        self._undone.clear()
        for command in log[same:]:
            self._take(command)

    def _take(self, command: str) -> DeskState:
        """The state after a command, which is appended to the log."""
        state = changed(self.source, self.state, command, self)
        self._states.append(state)
        self._log.append(command)
        return state

    def run(self, command: str) -> None:
        """Run a command; one that cannot be faired changes nothing.

        Parameters
        ----------
        command
            A line of text, see :data:`COMMANDS`; points and lines are counted from 1.

        Raises
        ------
        FairingError
            With the reason.
        """
        state = self._take(" ".join(command.split()))
        try:
            self._made(self.log, state)
            if state.draft is not None:
                fair_line(draft_task(self.source, state, state.draft))
        except FairingError:
            self._states.pop()
            self._log.pop()
            raise
        self._undone.clear()

    def undo(self) -> str | None:
        """Take the last command back.

        Returns
        -------
        str or None
            The command; ``None`` if there is no command.
        """
        if not self._log:
            return None
        self._states.pop()
        self._undone.append(self._log.pop())
        return self._undone[-1]

    def redo(self) -> str | None:
        """Run the last undone command again.

        Returns
        -------
        str or None
            The command; ``None`` if there is no command.
        """
        if not self._undone:
            return None
        left = self._undone[:-1]
        command = self._undone[-1]
        self.run(command)
        self._undone = left
        return command

    # -- results ---------------------------------------------------------------------------------

    def _made(
        self, key: tuple[str, ...], state: DeskState, progress: Progress | None = None
    ) -> DeskResult:
        known = self._results.get(key)
        if known is None:
            known = faired(self.source, state, progress=progress)
            while len(self._results) >= REMEMBERED:
                del self._results[next(iter(self._results))]
            self._results[key] = known
        return known

    @property
    def result(self) -> DeskResult:
        """The state, faired."""
        return self._made(self.log, self.state)

    def fair(self, progress: Progress | None = None) -> DeskResult:
        """The state, faired line by line.

        Parameters
        ----------
        progress
            Called before each line with how many are done, of how many, and its name; when it
            returns ``False`` the work ends with an error and nothing has changed.

        Returns
        -------
        DeskResult
            As :attr:`result`.
        """
        return self._made(self.log, self.state, progress)

    def preview(self, command: str, *, draft: bool = True) -> DeskResult:
        """Result of a command without running it in the session.

        Parameters
        ----------
        command
            As for :meth:`run`.
        draft
            True to accept drafts of curves, for interactive use: within the tolerances
            and the budget, but without control of inflections.

        Returns
        -------
        DeskResult
            The result; :attr:`DeskCurve.draft` is true for a draft.
        """
        return faired(self.source, self.after(command), draft=draft)

    def after(self, command: str) -> DeskState:
        """The state after a command, which is not run.

        Parameters
        ----------
        command
            As for :meth:`run`.
        """
        return changed(self.source, self.state, " ".join(command.split()), self)

    @property
    def cut(self) -> Fairing | None:
        """The faired section line, not yet merged into the network."""
        draft = self.state.draft
        return None if draft is None else fair_line(draft_task(self.source, self.state, draft))

    @property
    def previous(self) -> DeskResult | None:
        """The state before the last command, faired; ``None`` at the beginning."""
        return self._made(self.log[:-1], self._states[-2]) if self._log else None

    def compared(self) -> Floats:
        """Distance that each line moved by the last command, sampled.

        Returns
        -------
        numpy.ndarray
            The largest distance between the curves before and after it at the same parameters,
            ``(lines,)``; NaN for lines that were not there.
        """
        now, last = self.result, self.previous
        if last is None:
            return np.zeros(len(now.curves))
        t = np.linspace(0, 1, 257)
        out = np.full(len(now.curves), np.nan)
        for k, (a, b) in enumerate(zip(last.curves, now.curves, strict=False)):
            out[k] = float(np.linalg.norm(a.after(t) - b.after(t), axis=1).max())
        return out

    @property
    def suggested(self) -> float:
        """The object's own tolerance, or the scatter of points about their neighbours."""
        if self.source.tolerance is not None:
            return self.source.tolerance
        found = [_scatter(np.array(self.source.points)[list(o.points)]) for o in self.source.lines]
        most = float(np.median([x for x in found if x > 0] or [0.0]))
        extent = float(np.ptp(np.array(self.source.points), axis=0).max())
        value = 2.0 * most if most > 1e-9 * extent else 1e-4 * extent
        return float(f"{value:.1e}")

    # -- what commands see -----------------------------------------------------------------------

    def places(self, state: DeskState) -> tuple[Place, ...]:
        """Positions of the points of a state after fairing.

        Parameters
        ----------
        state
            A state of this desk.
        """
        return faired(self.source, state).points

    def suspicion(self, state: DeskState, point: int) -> tuple[str, Place | None] | None:
        """Suspicion about a point of a state, with a suggested reading, if there is one.

        Parameters
        ----------
        state
            A state of this desk.
        point
            The point, from 0.
        """
        found = faired(self.source, state).suspects
        return next(((s.kind, s.reading) for s in found if s.point == point), None)

    def cut_along(self, state: DeskState, normal: Place, at: float, name: str) -> DeskDraft:
        """The line along which a plane meets the lines of a state.

        Parameters
        ----------
        state
            A state of this desk.
        normal, at
            The plane, normal · p = at.
        name
            Name of the line.
        """
        return cut(self.source, state, normal, at, name)

    def drafted(self, state: DeskState) -> tuple[Place, ...]:
        """The faired points of the section line of a state.

        Parameters
        ----------
        state
            A state of this desk.
        """
        if state.draft is None:
            return ()
        made = fair_line(draft_task(self.source, state, state.draft))
        return tuple(
            given if known >= 0 else place(p)
            for p, given, known in zip(
                made.points, state.draft.points, state.draft.known, strict=True
            )
        )

    # -- out -------------------------------------------------------------------------------------

    def program(self, name: str = "faired") -> str:
        """The result as statements of a model: ``FairCurve``, ``FairNet`` or ``FairSurf``.

        Parameters
        ----------
        name
            Name of the object, and prefix of the names of further objects.

        Returns
        -------
        str
            Statements that give the same curves, to rounding.
        """
        return program(self.source, self.result, name)

    def encoded(self, name: str) -> bytes:
        """The result as a file: a table, splines or a sheet.

        Parameters
        ----------
        name
            The file's name: ``.csv``, ``.tsv``, ``.txt`` and ``.dat`` in the form of the table that
            was read, ``.igs``, ``.iges``, ``.dxf`` or ``.json`` the splines, ``.html`` the sheet
            with the commands.
        """
        from moldloft.fairing.desk_files import encoded

        return encoded(self.source, self.result, self.log, self._begin, name)

    def save(self, path: str | PathLike[str]) -> Path:
        """Write the result as a file.

        Parameters
        ----------
        path
            The file, see :meth:`encoded`.

        Returns
        -------
        pathlib.Path
            The file.
        """
        from moldloft.exchange.files import Output, commit

        path = Path(path)
        commit(path.parent, [Output(path.name, self.encoded(path.name))])
        return path


def _scatter(points: Floats) -> float:
    """The usual distance of points from cubics through two neighbours on either side."""
    if len(points) < 5:
        return 0.0
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    at = np.concatenate([[0.0], np.cumsum(steps)])
    out = []
    for k in range(2, len(points) - 2):
        near = [k - 2, k - 1, k + 1, k + 2]
        factors = np.array(
            [
                np.prod([(at[k] - at[j]) / (at[i] - at[j]) for j in near if j != i])
                if len({at[j] for j in near}) == 4
                else np.nan
                for i in near
            ]
        )
        off = points[k] - factors @ points[near]
        # Noise of one size at all five.
        out.append(float(np.linalg.norm(off) / np.sqrt(1.0 + np.sum(factors**2))))
    usual = [x for x in out if np.isfinite(x)]
    return float(np.median(usual)) if usual else 0.0


def as_base64(data: bytes) -> str:
    """Bytes as text for a page."""
    return base64.b64encode(data).decode()


def summary(curve: DeskCurve) -> dict[str, Any]:
    """Summary of a line for a list, as plain data."""
    return {
        "name": curve.name,
        "points": list(curve.points),
        "inflections": list(curve.inflections),
        "pieces": list(curve.pieces),
        "moved": float(curve.moved.max(initial=0.0)),
        "worst": curve.worst,
        "share": curve.share,
        "kept": curve.kept,
        "certified": curve.certified,
        "gap": curve.gap if np.isfinite(curve.gap) else None,
        "locked": curve.locked,
        "draft": curve.draft,
        "notes": list(curve.notes),
    }


explain(globals())
