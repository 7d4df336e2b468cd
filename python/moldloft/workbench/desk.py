"""The fairing desk of the page: requests of a hand answered from the log of its commands.

It runs in a process of its own, as the drawing board does. The page has what was opened and the log
of commands, so that a process that was lost loses nothing; this one keeps what it has faired.
"""

from __future__ import annotations

import hashlib
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import Error
from moldloft.fairing.desk import Desk, as_base64, summary
from moldloft.fairing.desk_lines import DeskCurve, DeskResult, fair_line, task
from moldloft.fairing.desk_source import DeskSource
from moldloft.fairing.faired import Fairing
from moldloft.workbench.room import answer_frames
from moldloft.workbench.sections import sections
from moldloft.workbench.statements import units

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["DeskRoom", "serve"]

#: Samples of a line in a picture, about, and the least and most on a span.
_SAMPLES = 900
_LEAST, _MOST = 3, 16

#: Sessions that are kept; others are replayed from their logs.
_KEPT = 8


class DeskRoom:
    """Fairing sessions of a page, by source.

    Parameters
    ----------
    folder
        The folder that a model may read.
    name
        The model's name.
    """

    def __init__(self, folder: str | None, name: str = "model.sdl") -> None:
        self._folder, self._name = folder, name
        self._text = ""
        self._desks: dict[str, Desk] = {}
        self._last: dict[str, DeskResult] = {}

    def sync(self, text: str) -> None:
        """Have that text of the model."""
        self._text = text

    # -- opening ---------------------------------------------------------------------------------

    def open(self, request: dict[str, Any]) -> dict[str, Any]:
        """A session of a table or an object: its source, for the page to keep.

        Parameters
        ----------
        request
            ``table`` with a name and a text, or ``object`` with a name.
        """
        if "table" in request:
            name, text = (str(word) for word in request["table"])
            source = DeskSource.of_file(name, text.encode())
        else:
            from moldloft import loads

            library = [self._folder] if self._folder else []
            model = loads(self._text, name=self._name, library=library, strict=False)
            source = DeskSource.of_object(model, str(request["object"]))
        desk = Desk(source)
        tolerance = desk.suggested
        opened = {"source": source.as_dict(), "tolerance": tolerance}
        desk = self._kept(opened, [])
        return {**opened, "log": [], **self.facts(desk, request)}

    def _kept(self, session: dict[str, Any], log: list[str]) -> Desk:
        """The desk of a session with that log."""
        whole = json.dumps([session["source"], session["tolerance"]], sort_keys=True)
        key = hashlib.sha256(whole.encode()).hexdigest()
        desk = self._desks.pop(key, None)
        if desk is None:
            source = DeskSource.from_dict(session["source"])
            desk = Desk(source, float(session["tolerance"]))
        self._desks[key] = desk
        while len(self._desks) > _KEPT:
            del self._desks[next(iter(self._desks))]
        desk.follow(log)
        session["key"] = key
        return desk

    def _asked(self, request: dict[str, Any]) -> Desk | None:
        """The desk of a request; None if the page has to send its source."""
        log = [str(command) for command in request["log"]]
        if "source" in request:
            return self._kept(request, log)
        desk = self._desks.get(str(request.get("key")))
        if desk is not None:
            desk.follow(log)
        return desk

    # -- facts -----------------------------------------------------------------------------------

    def facts(
        self, desk: Desk, request: dict[str, Any], result: DeskResult | None = None
    ) -> dict[str, Any]:
        """What the page draws: the list of lines, suspects, marks, and one line in full.

        Parameters
        ----------
        desk
            The session.
        request
            ``line``, which one is shown, and ``brief``, true to leave out what does not move.
        result
            The result, if it is not the session's own.
        """
        shown = desk.result if result is None else result
        state = shown.state
        line = max(0, min(int(request.get("line") or 0), len(shown.curves) - 1))
        out: dict[str, Any] = {
            "log": list(desk.log),
            "title": desk.source.name,
            "kind": desk.source.kind,
            "goal": state.goal,
            "limit": state.line_tolerances.get(line, state.tolerance),
            "list": [summary(c) for c in shown.curves],
            "line": line,
            "detail": _detail(desk, shown, line),
            "span": None if state.span is None else [state.span[0], *_ends(shown)],
            "shapes": [
                {"line": k, "text": text, "ends": _shape_ends(shown, k, text)}
                for k, text in state.shapes
            ],
        }
        if desk.source.kind != "curves":
            out["views"] = [_polyline(c.after) for c in shown.curves]
            out["extents"] = _extents(shown)
            out["sections"] = sections(out["views"])
        if request.get("brief"):
            return out
        out["suspects"] = [
            {
                "point": s.point,
                "line": s.line,
                "kind": s.kind,
                "text": s.text,
                "reading": s.reading,
                "accepted": s.accepted,
            }
            for s in shown.suspects
        ]
        out["names"] = list(desk.source.point_names)
        if desk.source.kind != "curves":
            out["views_before"] = [_polyline(c.before) for c in shown.curves]
        moved = desk.compared()
        out["compared"] = [float(x) if math.isfinite(x) else None for x in moved]
        made = desk.cut
        if made is not None and state.draft is not None:
            out["cut"] = {"name": state.draft.name, **_cut(desk, made)}
        return out

    # -- requests --------------------------------------------------------------------------------

    def answer(self, request: dict[str, Any]) -> dict[str, Any]:
        """The answer to a request of the page."""
        if isinstance(request.get("text"), str):
            self.sync(request["text"])
        kind = request["kind"]
        if kind == "desk_open":
            return self.open(request)
        desk = self._asked(request)
        if desk is None:
            return {"unknown": True}
        if kind == "desk_run":
            desk.run(str(request["command"]))
        elif kind == "desk_slide":
            made = desk.preview(str(request["command"]), draft=not request.get("final"))
            return self.facts(desk, {**request, "brief": True}, made)
        elif kind == "desk_line":
            k = int(request["only"])
            state = desk.after(str(request["command"]))
            fair_line(task(desk.source, state, k))
            return {"done": k, "of": len(state.lines)}
        elif kind == "desk_apply":
            return self.apply(desk, request)
        elif kind == "desk_save":
            return {"name": request["name"], "data": as_base64(desk.encoded(request["name"]))}
        return {"key": request.get("key"), **self.facts(desk, request)}

    def apply(self, desk: Desk, request: dict[str, Any]) -> dict[str, Any]:
        """The edit that writes the result into the model's text.

        Parameters
        ----------
        desk
            The session.
        request
            ``name`` of the object, and ``applied``, what was written before and is replaced.
        """
        new = desk.program(str(request["name"]))
        old = request.get("applied")
        text = self._text
        if isinstance(old, str) and old and old in text:
            start = text.index(old)
            end = start + len(old)
        else:
            start = end = len(text)
            new = ("" if not text or text.endswith("\n") else "\n") + new
        edit = {"from": units(text, start), "to": units(text, end), "insert": new}
        return {"edits": [edit], "applied": new.lstrip("\n")}


def _ends(result: DeskResult) -> list[int]:
    """The first and last point of the range."""
    line, first, last = result.state.span or (0, 0, 0)
    own = result.state.lines[line].points
    return [own[first], own[last]]


def _shape_ends(result: DeskResult, line: int, text: str) -> list[int] | None:
    """The points between which a shape condition of a line applies; None for the whole line."""
    span = text.partition("=")[2].partition(":")[0]
    first, dash, last = span.partition("-")
    if not dash or not (first + last).isdigit():
        return None
    own = result.state.lines[line].points
    return [own[int(first) - 1], own[int(last) - 1]]


def _per_span(curve: Any) -> int:
    spans = max(1, len(curve.knots) - 2 * int(curve.degree) - 1)
    return max(_LEAST, min(_MOST, _SAMPLES // spans))


def _rounded(values: Floats) -> list[Any]:
    """Numbers for a picture: eight digits, null for NaN and infinity."""
    out = np.where(np.isfinite(values), values, np.nan)
    size = float(np.nanmax(np.abs(out), initial=0.0))
    digits = 8 - math.ceil(math.log10(size)) if size > 0 else 8
    listed: list[Any] = np.round(out, min(max(digits, 0), 300)).tolist()
    return [None if isinstance(x, float) and math.isnan(x) else x for x in listed]


def _polyline(curve: Any) -> list[Any]:
    return _rounded(curve.samples(min(6, _per_span(curve))).points)


def _extents(result: DeskResult) -> list[list[float]]:
    points = np.array(result.points)
    return [points.min(axis=0).tolist(), points.max(axis=0).tolist()]


def _axes(points: Floats) -> tuple[int, int]:
    """The two coordinates in which a line is seen best."""
    spread = np.ptp(points, axis=0)
    least = 2 if spread[2] <= 1e-12 * spread.max() else int(np.argmin(spread))
    i, j = (c for c in range(3) if c != least)
    return i, j


def _seen(curve: Any, axes: tuple[int, int]) -> dict[str, Any]:
    """A curve for a picture: points, fraction of the length, signed curvature."""
    samples = curve.samples(_per_span(curve))
    ij = list(axes)
    first, second = samples.first[:, ij], samples.second[:, ij]
    speed = np.linalg.norm(first, axis=1)
    turn = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    bend = np.divide(turn, speed**3, out=np.zeros_like(turn), where=speed > 0)
    return {
        "at": _rounded(samples.points[:, ij]),
        "arc": _rounded(samples.arc),
        "bend": _rounded(bend),
    }


def _knots(curve: Any, count: int) -> list[float]:
    """Positions of knots along the curve, from 0 to 1."""
    at = np.asarray(curve.jumps()[0])
    return [float(t) for t in (at if len(at) == count else np.linspace(0, 1, count))]


def _detail(desk: Desk, result: DeskResult, k: int) -> dict[str, Any]:
    """All details of a line."""
    curve = result.curves[k]
    state = result.state
    given = np.array([state.points[p] for p in curve.points])
    axes = _axes(given)
    last = None
    if desk.log and result is desk.result:
        before = desk.previous
        if before is not None and k < len(before.curves):
            last = _polyline_in(before.curves[k], axes)
    return {
        "line": k,
        "axes": list(axes),
        "points": list(curve.points),
        "data": _rounded(given[:, list(axes)]),
        "faired": _rounded(np.array([result.points[p] for p in curve.points])[:, list(axes)]),
        "place": given.tolist(),
        "moved": curve.moved.tolist(),
        "limits": [float(x) if math.isfinite(x) else None for x in curve.limits],
        "before": _seen(curve.before, axes),
        "after": _seen(curve.after, axes),
        "last": last,
        "jumps": [_rounded(j) for j in curve.jumps],
        "knots": _knots(curve.after, len(curve.jumps[1])),
        "fixed": [p for p in curve.points if p in state.fixed],
        "knuckles": [p for p in curve.points if p in state.knuckles],
        "released": [p for p in curve.points if p in state.released],
        "closed": curve.after.closed,
        "control": desk.source.control,
        "certificate": _certificate(curve),
    }


def _polyline_in(curve: DeskCurve, axes: tuple[int, int]) -> list[Any]:
    return _rounded(curve.after.samples(_per_span(curve.after)).points[:, list(axes)])


def _certificate(curve: DeskCurve) -> dict[str, Any]:
    """The badge with the proved property of a line."""
    if curve.draft:
        return {"state": "draft", "words": "draft: inflections are counted when the drag ends"}
    if not curve.kept:
        return {"state": "broken", "words": "a tolerance is not kept"}
    if curve.certified:
        gap = curve.gap
        return {"state": "certified", "words": f"within its limits; optimum to {gap:.1e}, proved"}
    return {"state": "kept", "words": "within its limits; no optimum is claimed"}


def _cut(desk: Desk, made: Fairing) -> dict[str, Any]:
    """The line that was cut, before and after."""
    points = np.column_stack([made.data]) if made.data.shape[1] == 3 else made.data
    axes = _axes(points)
    return {
        "axes": list(axes),
        "data": _rounded(points[:, list(axes)]),
        "before": _seen(made.original, axes),
        "after": _seen(made.spline, axes),
        "inflections": [made.before.inflections, made.after.inflections],
        "pieces": [made.before.pieces, made.after.pieces],
        "polyline": _polyline(made.spline),
    }


def answered(room: DeskRoom, request: dict[str, Any]) -> dict[str, Any]:
    """The answer to a request, or an error."""
    try:
        reply = {"kind": "desk", **room.answer(request)}
    except Error as error:
        reply = {"kind": "refused", "error": str(error)}
    except (KeyError, TypeError, ValueError, IndexError) as error:
        reply = {"kind": "refused", "error": f"not a request of the desk: {error!r}"}
    return {**reply, "id": request.get("id", 0), "version": request.get("version")}


def serve(memory: int, name: str, folder: str | None) -> None:
    """Answer the parent until its end."""
    room = DeskRoom(str(Path(folder)) if folder else None, name)
    answer_frames(memory, room.sync, lambda request: answered(room, request))
