"""The drawing board: edits of a sketch with the pointer, written as commands to its text.

It runs in a process of its own, which :class:`~moldloft.workbench.engine.Engine` starts, and speaks
frames of JSON. The text is the only truth: a session runs it, what a hand does becomes an edit
of it, and the edit counts when the whole text runs without a new fault.
"""

from __future__ import annotations

import contextlib
import json
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from moldloft import _core
from moldloft.errors import Error
from moldloft.shapes.sketch_values import Reply, SketchStroke
from moldloft.workbench.handles import drawn_handles, faces, made_handles, section_place
from moldloft.workbench.outlines import outlines
from moldloft.workbench.room import answer_frames
from moldloft.workbench.snaps import Axes, snapped
from moldloft.workbench.statements import (
    MAKING,
    Statement,
    block,
    place,
    replaced,
    statements,
    units,
)

__all__ = ["Board", "serve"]

#: Words that may follow a value of DIMENSION and GIVE.
_AFTER_VALUE = {"REVERSED", "FORWARD", "ONLY"}
_PLAIN = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?", re.IGNORECASE)
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?\s*[a-z]*", re.IGNORECASE)

#: A dimension that ACCEPT ALL has taken, and its points.
_TAKEN = re.compile(r"(E\d+) [A-Z] (\d+) TO (\d+) = ")

#: The code of a wireframe that several solids fit.
_SEVERAL = 702

#: Commands in the next step that a reply names.
_FIX = re.compile(r"\b(?:WELD|TYPE|ALIGN|DELETE) [A-Z0-9 ]*[A-Z0-9]")

Places = list[tuple[int, int, str]]


class RefusedError(Exception):
    """An edit that would make the sketch invalid; the message gives reason and remedy."""


class Board:
    """A sketch's text, and its objects as a page shows them.

    Parameters
    ----------
    folder
        The folder that the text may read.
    """

    def __init__(self, folder: str | None = None) -> None:
        self._folder = folder
        self._text = ""
        self._faults: list[dict[str, Any]] = []
        self._left = False
        self._asked: list[list[int]] | None = None
        self._steps = False
        self._session = self._new()
        self._guesses = self._new()
        self._guessed: list[str] = []
        self._object: str | None = None
        self._placed: tuple[Any, dict[str, Any] | None] = (None, None)

    def _new(self, steps: bool = False) -> _core.SketchSession:
        session = _core.SketchSession(self._folder)
        session.confine(True)
        if not steps:
            session.forgo_steps()
        return session

    # -- the text ----------------------------------------------------------------------------

    def sync(self, text: str) -> None:
        """Run a text; if it only appends to the previous one, run the new lines only."""
        if text == self._text:
            return
        old, new = self._text.split("\n"), text.split("\n")
        while old and not old[-1].strip():
            old.pop()
        if new[: len(old)] != old or self._left:
            self._session, self._steps, self._faults, old = self._new(), False, [], []
        rows = self._session.run_lines(new[len(old) :])
        if self._session.stepped() and not self._steps:
            # UNDO in a text takes back steps, which are kept of such a text alone.
            self._session, self._steps, self._faults, old = self._new(True), True, [], []
            rows = self._session.run_lines(new)
        for k, row in rows:
            reply = Reply.from_row(row)
            if not reply.is_error:
                self._asked = _face(reply.text)
            else:
                fault = {"line": len(old) + k + 1, "text": reply.text, "next": reply.next}
                self._faults.append({**fault, "code": reply.code})
        # A question at the end of a text, such as which of several solids is meant, is left open:
        # the drawing is shown, and lines that answer it are run with the whole text.
        self._left = self._session.asks()
        if not self._left:
            self._asked = None
        else:
            self._session.run_line(f'USING "{self._session.active()}"')
        self._text = text

    def _changed(self, edits: Places) -> list[dict[str, Any]]:
        """Edits of the text for the page, once the text after them runs without a new fault."""
        before, faults = self._text, {(f["text"], f["code"]) for f in self._faults}
        after = replaced(before, edits)
        self.sync(after)
        new = [f for f in self._faults if (f["text"], f["code"]) not in faults]
        if new:
            self.sync(before)
            hint = f"; {new[0]['next']}" if new[0]["next"] else ""
            raise RefusedError(f"{new[0]['text']}{hint}")
        return [
            {"from": units(before, a), "to": units(before, b), "insert": insert}
            for a, b, insert in edits
        ]

    # -- edits -------------------------------------------------------------------------------

    def edit(self, changes: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
        """Apply an action of the mouse as one edit of the text.

        Parameters
        ----------
        changes
            Each with ``do``: ``run``, ``move``, ``value``, ``type``, ``place`` or ``axes``, and its
            arguments.

        Returns
        -------
        list of dict
            Spans of the old text, in UTF-16 units, and their new content.
        """
        every = statements(self._text)
        own = block(every, self._object) if self._object else []
        edits: Places = []
        added: list[str] = []
        after: list[str] = []
        ending: list[str] = []
        for change in changes:
            do = change.get("do")
            if do == "run":
                command = str(change["command"])
                last = change.get("last")
                (ending if last == "end" else after if last else added).append(command)
            elif do == "move":
                u, v = (_number(x) for x in change["at"])
                p = int(change["point"])
                edits += self._over(
                    self._point(own, p), 2, f"{u} {v}", added, f"POINT {p} AT {u} {v}"
                )
            elif do == "type":
                for line in change["lines"]:
                    edits += self._type(own, int(line), str(change["type"]), added)
            elif do == "value":
                edits += self._value(own, str(change["name"]), str(change["value"]), ending)
            elif do == "place":
                edits += self._place(own, int(change["point"]), change["at"], added)
            elif do == "axes":
                edits += self._axes(own, str(change["axes"]))
            else:
                raise RefusedError(f"`{do}` is nothing that the board does")
        if added:
            if any(change.get("drawn") for change in changes):
                added += self._first_place(added)
            edits.append(self._written(every, own, place(own), "; ".join(added)))
        if after:
            edits.append(self._written(every, own, own[-1] if own else None, "\n".join(after)))
        if ending:
            end = len(self._text.rstrip())
            edits.append((end, len(self._text), "\n" * (end > 0) + "\n".join(ending) + "\n"))
        edits.sort(key=lambda e: e[:2])
        return self._changed(edits)

    def _written(
        self, every: Sequence[Statement], own: Sequence[Statement], last: Statement | None, new: str
    ) -> tuple[int, int, str]:
        """The edit that writes commands after a statement of the object, or at the end."""
        if last is None:
            end = len(self._text.rstrip())
            before = "\n" if end else ""
            using = f'USING "{self._object}"\n' if self._object and not own and every else ""
            return end, len(self._text), f"{before}{using}{new}\n"
        if not last.last:
            return last.end, last.end, f"; {new}"
        end = self._text.find("\n", last.end)
        end = len(self._text) if end < 0 else end
        return end, end, f"\n{new}"

    @staticmethod
    def _over(
        found: tuple[Statement, int] | None, count: int, new: str, added: list[str], command: str
    ) -> Places:
        """Words of a statement replaced, or a command more where no statement has them."""
        if found is None:
            added.append(command)
            return []
        s, k = found
        return [(s.tokens[k].start, s.tokens[k + count - 1].end, new)]

    @staticmethod
    def _point(own: Sequence[Statement], point: int) -> tuple[Statement, int] | None:
        """The last statement that draws a point, and the span of its numbers."""
        found = None
        for s in own:
            if s.verb == "POINT" and s.word(1) == str(point):
                k = 3 if s.word(2) == "AT" else 2
                if len(s.tokens) == k + 2:
                    found = (s, k)
            elif s.verb in ("SPLIT", "WELD", "STROKES", "IMPORT", "INPUT", "MOVE", "SCALE"):
                found = None
        return found

    @staticmethod
    def _type(own: Sequence[Statement], line: int, letter: str, added: list[str]) -> Places:
        found: tuple[Statement, int, bool] | None = None
        for s in own:
            if s.verb == "LINE" and s.word(1) == str(line) and s.word(2) == "FROM":
                typed = s.word(6) == "TYPE" and len(s.tokens) == 8
                if typed or len(s.tokens) == 6:
                    found = (s, 7 if typed else 5, typed)
            elif s.verb == "TYPE" and str(line) in [t.text for t in s.tokens[1:-1]]:
                alone = [t for t in s.tokens[1:-1] if t.upper != "AS"]
                found = (s, len(s.tokens) - 1, True) if len(alone) == 1 else None
                if found is None:
                    break
        if found is None:
            added.append(f"TYPE {line} AS {letter}")
            return []
        s, k, over = found
        if over:
            return [(s.tokens[k].start, s.tokens[k].end, letter)]
        return [(s.end, s.end, f" TYPE {letter}")]

    def _value(self, own: Sequence[Statement], name: str, value: str, ending: list[str]) -> Places:
        value = value.strip().replace("−", "-")
        if not value or "\n" in value:
            raise RefusedError("give a number or an expression")
        plain = _NUMBER.fullmatch(value) is not None
        quote = "'" if '"' in value else '"'
        given = value if plain else f"{quote}{value.strip(quote)}{quote}"
        # A range is kept by SET alone: DIMENSION states both anew.
        replies: list[Reply] = []
        self._aside(
            lambda: replies.extend(
                map(Reply.from_row, self._session.run_line(f"SET {name} {given}"))
            )
        )
        for reply in replies:
            if reply.is_error:
                raise RefusedError(f"{reply.text}; {reply.next}" if reply.next else reply.text)
        found: tuple[Statement, int] | None = None
        for s in own:
            named = s.word(1) == name.upper()
            words = [t.upper for t in s.tokens]
            end = words.index("IN") if "IN" in words[2:] else len(words)
            while end and words[end - 1] in _AFTER_VALUE:
                end -= 1
            if named and s.verb in ("SET", "VARIABLE", "DECLARE"):
                found = (s, 2)
            elif named and s.verb in ("DIMENSION", "GIVE"):
                along = words[2] in ("X", "Y", "Z")
                least = (6 if "TO" in words else 5) if along else 4
                found = (s, end - 1) if end > least else None
        if found is None:
            spans = self._literal(name, float(value)) if _PLAIN.fullmatch(value) else []
            if not spans:
                ending.append(f'USING "{self._object}"\nSET {name} {given}')
            return [(*span, given) for span in spans]
        s, k = found
        return [(s.tokens[k].start, s.tokens[k].end, given)]

    def _literal(self, name: str, value: float) -> list[tuple[int, int]]:
        """The one word that is a number of a body, such as the length of EXTRUDE."""

        def numbers(session: _core.SketchSession) -> dict[str, float | None]:
            known = self._object in session.names()
            return {n: x for n, x, *_ in session.numbers(str(self._object))} if known else {}

        before = numbers(self._session)
        rest = {n: x for n, x in before.items() if n != name}
        for s in statements(self._text):
            for token in s.tokens[1:] if s.verb in MAKING else ():
                if not _PLAIN.fullmatch(token.text) or float(token.text) != before.get(name):
                    continue
                session = self._new()
                tried = replaced(self._text, [(token.start, token.end, f"{value!r}")])
                for line in tried.split("\n"):
                    session.run_line(line)
                if numbers(session) == {**rest, name: value}:
                    return [(token.start, token.end)]
        return []

    def _first_place(self, added: Sequence[str]) -> list[str]:
        """The position of the first point that is drawn on a face: where it is drawn."""
        axes = self._axes_of(self._object)[1].units
        if self._section_place(axes) is None or self._data()["points"]:
            return []
        for s in statements("; ".join(added)):
            if s.verb == "POINT" and len(s.tokens) > 3:
                u, v = (float(t.text) for t in s.tokens[-2:])
                at = [(u * a + v * b) / (a * a + b * b) for a, b in axes.values()]
                return [f"REFERENCE {s.word(1)} {' '.join(f'{x + 0.0:.9g}' for x in at)}"]
        return []

    def _place(
        self, own: Sequence[Statement], point: int, at: Sequence[Any], added: list[str]
    ) -> Places:
        section = self._axes_of(self._object)[0]
        shown = [x for x, axis in zip(at, "XYZ", strict=True) if section is None or axis in section]
        words = " ".join(f"{float(x):.12g}" for x in shown)
        found = None
        for s in own:
            k = 1 if s.verb == "REFERENCE" else 2
            if (s.verb == "REFERENCE" or s.word(1) == "REFERENCE") and s.word(k) == str(point):
                found = (s, k + 1) if len(s.tokens) == k + 1 + len(shown) else None
        return self._over(found, len(shown), words, added, f"REFERENCE {point} {words}")

    @staticmethod
    def _axes(own: Sequence[Statement], axes: str) -> Places:
        for s in own:
            if s.verb == "AXES":
                return [(s.tokens[1].start, s.end, axes)]
        for s in own:
            if s.verb == "SKETCH":
                return [(s.end, s.end, f"\nAXES {axes}")]
        raise RefusedError("the object has no SKETCH command in this text")

    # -- facts -------------------------------------------------------------------------------

    def choose(self, name: str | None) -> None:
        """Show an object; the active one if there is no object of this name."""
        names = {n.upper(): n for n in self._session.names()}
        self._object = names.get((name or "").upper()) or self._session.active()

    def _aside(self, look: Callable[[], None]) -> None:
        """Look at the object as if more had been done; the session stays as it is."""
        self._session.begin()
        try:
            if self._object != self._session.active():
                self._session.run_line(f'USING "{self._object}"')
            look()
        finally:
            self._session.rollback()

    def _data(self) -> dict[str, Any]:
        found = json.loads(self._session.objects_json())["objects"]
        return next((o for o in found if o["name"] == self._object), {})

    def facts(self, moves: Sequence[dict[str, Any]] = ()) -> dict[str, Any]:
        """The object as the page draws it.

        Parameters
        ----------
        moves
            Points, and where they are meanwhile: ``{"point": 3, "at": [u, v]}``.
        """
        session, name = self._session, self._object
        out: dict[str, Any] = {"object": name, "objects": session.names(), "faults": self._faults}
        out["asked"] = self._asked if name == session.active() else None
        if name is None:
            return out

        def look() -> None:
            for move in moves:
                u, v = (_number(x) for x in move["at"])
                session.run_line(f"POINT {int(move['point'])} AT {u} {v}")
            out.update(self._object_facts(self._data()))
            out["marks"] = [_mark(m) for m in session.marks(name, None)]
            given = {m["name"] for m in out["marks"]}
            taken = self._taken()
            labels, places = session.points(name)
            guess = dict(zip(labels.tolist(), places.tolist(), strict=True))
            for p in out["points"]:
                p[3] = [x if math.isfinite(x) else None for x in guess.get(p[0], [math.nan] * 3)]
            out["next"] += [m for m in self._marks(taken, given) if "q" in m]

        self._aside(look)
        return out

    def _axes_of(self, name: str | None) -> tuple[str | None, Axes]:
        """The plane of a section, and the axes of the drawing."""
        section, rows = self._session.axes(name or "")
        letters, angles, scale = zip(*rows, strict=True)
        return section, Axes("".join(letters), list(angles), list(scale))

    def _object_facts(self, data: dict[str, Any]) -> dict[str, Any]:
        session = self._session
        section, axes = self._axes_of(self._object)
        planes = [
            [a.axis, list(a.points), a.value]
            for a in (Reply.from_row(row).about for row in session.run_line("EXTENSIONS"))
            if a is not None and a.axis is not None
        ]
        points = [
            [p["id"], *p["page"], None, [x is not None for x in p["at"]]]
            for p in data["points"]
            if p["page"] is not None
        ]
        lines = [
            [ln["id"], *ln["points"], ln["type"] or "", ln["source"], ln["certainty"]]
            for ln in data["lines"]
        ]
        return {
            "section": section,
            "axes": axes.units,
            "angles": axes.angles,
            "points": points,
            "lines": lines,
            "planes": planes,
            "missing": data["missing"],
            "faces": len(data["faces"]) or int(self._made(data)),
            "place": self._section_place(axes.units),
            "numbers": {d["name"]: d["value"] for d in data["dimensions"]},
            "next": [],
        }

    @staticmethod
    def _made(data: dict[str, Any]) -> bool:
        """True for an object with a body: drawn with its faces, or made of others."""
        return bool(data["faces"]) or (data["state"] == "solid" and data["volume"] is not None)

    def _section_place(self, units: dict[str, list[float]]) -> dict[str, Any] | None:
        """The face on which the object is drawn, computed once for a text."""
        key = self._text, self._object
        if self._placed[0] != key:
            found = section_place(self._session, self._object or "", units)
            self._placed = key, found
        return self._placed[1]

    def check(self) -> list[dict[str, Any]]:
        """Doubtful and contradictory parts, with remedies."""
        found: list[dict[str, Any]] = []
        if self._object is None:
            return found

        def look() -> None:
            for row in self._session.run_line(f'CHECK "{self._object}"'):
                reply = Reply.from_row(row)
                about = reply.about
                if about is not None and about.kind != "missing-dimension":
                    fixes = [f for f in _FIX.findall(reply.next or "") if not f.endswith(" AS")]
                    found.append({**reply.to_dict(), "next": reply.next, "fixes": fixes})

        self._aside(look)
        return found

    def proposals(self) -> list[dict[str, Any]]:
        """The types suggested by all strokes together, where they differ from the present ones."""
        if self._object is None:
            return []
        before = {ln["id"]: ln["type"] for ln in self._data().get("lines", [])}
        return [
            {"line": line, "type": kind, "share": share, "alternatives": [list(o) for o in others]}
            for line, kind, share, others in self._session.type_proposals(self._object)
            if kind != before.get(line)
        ]

    def stroke(self, request: dict[str, Any]) -> dict[str, Any]:
        """A stroke of a pen as pieces, and the commands that draw them.

        Parameters
        ----------
        request
            ``samples``, rows of u and v, of time and of pressure; ``trial``, true to leave the text
            as it is.

        Returns
        -------
        dict
            ``pieces`` with ``closed``, ``noise`` and ``tolerance`` of the stroke, the ``commands``,
            the ``remarks`` on what the sketch cannot hold, and unless it is a trial the ``edits``
            and the facts as after an edit.
        """
        stroke = SketchStroke.of(request["samples"])
        replies: list[Reply] = []
        commands: list[str] = []

        def look() -> None:
            replies.extend(map(Reply.from_row, self._session.run_line(stroke.command)))
            commands.extend(self._session.pending()[-1:])

        if self._object is None:
            raise RefusedError("there is no object to draw in: SKETCH starts one")
        self._aside(look)
        for reply in replies:
            if reply.is_error:
                raise RefusedError(f"{reply.text}; {reply.next}" if reply.next else reply.text)
        out: dict[str, Any] = asdict(stroke)
        del out["command"]
        out["commands"] = "; ".join(commands)
        out["remarks"] = [r.text for r in replies if r.severity == "warning"]
        if not request.get("trial") and commands:
            out["edits"] = self.edit([{"do": "run", "command": out["commands"], "drawn": True}])
            out.update(self.facts())
        return out

    def solid(self, trial: str | None = None) -> dict[str, Any]:
        """The body from drawing and dimensions; exact if no dimension is missing.

        Parameters
        ----------
        trial
            A command that is carried out for it alone.
        """
        out: dict[str, Any] = {"exact": False, "made": False, "why": None}
        name = self._object
        if name is None:
            return out

        def look() -> None:
            session = self._session
            if trial is not None:
                session.run_line(trial)
            data = self._data()
            given = {m[0] for m in session.marks(name, None)}
            out["exact"] = not any(data["missing"].values())
            out["made"] = self._made(data)
            taken = self._taken()
            several = out["made"]
            if not out["made"]:
                for reply in map(Reply.from_row, session.run_line("GENERATE FACES")):
                    several |= reply.code == _SEVERAL
                    if reply.is_error:
                        out["why"] = {"text": reply.text, "code": reply.code}
            data = self._data()
            out.update({"volume": data["volume"], "area": data["area"]})
            if trial is None:
                out["handles"] = self._handles(data, taken, given)
            if not self._made(data):
                labels, places = session.points(name)
                ends = [(ln["points"][0], ln["points"][1]) for ln in data["lines"]]
                at = dict(zip(labels.tolist(), places.tolist(), strict=True))
                out["outlines"] = outlines(ends, at)
            try:
                out.update(faces(session, name))
            except Error:
                return
            if not (out["made"] and out["exact"]):
                out["names"] = []
            # Of a wireframe that several solids fit, all are shown.
            if not several:
                return
            with contextlib.suppress(Error):
                fits = [_shape(*fit) for fit in session.candidates(name, False)]
                out["candidates"] = fits if len(fits) > 1 else []

        self._aside(look)
        return out

    def _taken(self) -> dict[str, tuple[int, int]]:
        """Take all missing dimensions from the picture; the points that each is between."""
        replies = map(Reply.from_row, self._session.run_line("ACCEPT ALL"))
        found = (m for r in replies if not r.is_error for m in _TAKEN.finditer(r.text))
        return {m[1]: (int(m[2]), int(m[3])) for m in found}

    def _marks(self, taken: dict[str, tuple[int, int]], given: set[str]) -> list[dict[str, Any]]:
        """The dimensions of the object; those not given before with ``p`` and ``q``."""
        marks = [_mark(m) for m in self._session.marks(str(self._object), None)]
        for mark in marks:
            ends = taken.get(mark["name"])
            if mark["name"] not in given and ends is not None:
                mark |= {"p": ends[0], "q": ends[1]}
        return marks

    def _handles(
        self, data: dict[str, Any], taken: dict[str, tuple[int, int]], given: set[str]
    ) -> list[dict[str, Any]]:
        """The arrows of the object, whose missing dimensions have the values of the picture."""
        name = str(self._object)
        if not data["lines"]:
            return made_handles(self._session, name)
        own = block(statements(self._text), name)
        facts = self._object_facts(data)
        labels, places = self._session.points(name)
        at = dict(zip(labels.tolist(), places.tolist(), strict=True))
        marks = self._marks(taken, given)
        return drawn_handles(own, data, facts["section"], facts["planes"], at, marks)

    def pointer(self, request: dict[str, Any]) -> dict[str, Any]:
        """Meaning of a pointer position: a snap, and the type of a line to that position.

        Parameters
        ----------
        request
            ``at`` and ``reach`` on the page; ``start``, the place that the line comes from;
            ``free``, true to suspend snapping; ``woken``, points that the pointer has rested on.
        """
        at = (float(request["at"][0]), float(request["at"][1]))
        start = request.get("start")
        name = self._object
        out: dict[str, Any] = {"at": list(at), "why": None}
        if name is None or not math.isfinite(sum(at)):
            return out
        if not request.get("free"):
            out.update(
                snapped(
                    self._session, name, at, float(request["reach"]),
                    None if start is None else (float(start[0]), float(start[1])),
                    [int(p) for p in request.get("woken", [])],
                )
            )  # fmt: skip
        if start is not None:
            out.update(self._guess(start, out["at"]))
        return out

    def _guess(self, start: Sequence[float], end: Sequence[float]) -> dict[str, Any]:
        """The type of a line by its slope, as inferred by the command LINE."""
        head = [
            re.sub(r" ON .*", "", line)
            for line in self._session.text(self._object).splitlines()
            if line.startswith(("SKETCH ", "AXES "))
        ]
        if head != self._guessed:
            self._guesses, self._guessed = self._new(), head
            for line in head:
                self._guesses.run_line(line)
        ends = [f"POINT {k} AT {_number(p[0])} {_number(p[1])}" for k, p in ((1, start), (2, end))]
        self._guesses.begin()
        try:
            self._guesses.run_line("; ".join([*ends, "LINE 1 FROM 1 TO 2"]))
            found = json.loads(self._guesses.objects_json())["objects"][0]["lines"]
        finally:
            self._guesses.rollback()
        if not found:
            return {}
        return {"type": found[0]["type"] or "", "certainty": found[0]["certainty"]}

    # -- requests ----------------------------------------------------------------------------

    def answer(self, request: dict[str, Any]) -> dict[str, Any]:
        """The answer to a request of the page."""
        if isinstance(request.get("text"), str):
            self.sync(request["text"])
        self.choose(request.get("object") or self._object)
        kind = request["kind"]
        if kind == "board_edit":
            edits = self.edit(request["changes"])
            self.choose(request.get("object") or self._object)
            return {"edits": edits, **self.facts()}
        if kind == "board_drag":
            return self.facts(request["moves"])
        if kind == "board_stroke":
            return self.stroke(request)
        if kind in ("board_pointer", "board_place"):
            return self.pointer(request)
        if kind == "board_solid":
            return {"solid": self.solid(request.get("trial"))}
        if kind == "board_check":
            return {"checks": self.check(), "proposals": self.proposals()}
        return self.facts()


def _face(text: str) -> list[list[int]] | None:
    """The loops of the face that a reply asks about, the outer one first; None for others."""
    found = re.fullmatch(r"is this a face: ([\d HOLE]+)\?", text)
    if found is None:
        return None
    return [[int(point) for point in loop.split()] for loop in found[1].split(" HOLE ")]


def _shape(vertices: Any, faces: Any) -> dict[str, list[float]]:
    return {"vertices": vertices.ravel().tolist(), "quads": faces.ravel().tolist()}


def _mark(row: Any) -> dict[str, Any]:
    names = ("name", "text", "value", "reference", "axis", "at", "line", "witnesses")
    return dict(zip(names, row, strict=True))


def _number(x: Any) -> str:
    """A coordinate of the page, to a thousandth."""
    value = round(float(x), 3)
    if not math.isfinite(value):
        raise RefusedError(f"{x} is not a position on the page")
    return f"{value + 0.0:g}" if value == int(value) and abs(value) < 1e6 else repr(value)


def answered(board: Board, request: dict[str, Any]) -> dict[str, Any]:
    """The answer to a request, or an error."""
    try:
        reply = {"kind": "board", **board.answer(request)}
    except (RefusedError, Error) as error:
        reply = {"kind": "refused", "error": str(error)}
    except (KeyError, TypeError, ValueError, IndexError) as error:
        reply = {"kind": "refused", "error": f"not a request of the board: {error!r}"}
    return {**reply, "id": request.get("id", 0), "version": request.get("version")}


def serve(memory: int, folder: str | None) -> None:
    """Serve requests of the parent process until it ends."""
    board = Board(str(Path(folder)) if folder else None)
    answer_frames(memory, board.sync, lambda request: answered(board, request))
