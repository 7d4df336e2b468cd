"""The hub: owner of the text, queue of requests to the engine, and messages to each tab.

The text is here, not in the engine and not in a page: a page's change counts once the hub has it,
and it is on disk before the page hears so. The engine is asked one thing at a time; what has become
out of date while it waited is left out. Nothing here waits for a page: each has an outbox.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import secrets
from collections.abc import Callable, Coroutine, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from moldloft.errors import Error, FileError
from moldloft.formats import formats
from moldloft.language import check_language
from moldloft.storage import ChangedError, digest, put, utf8_path
from moldloft.workbench.draft import Draft
from moldloft.workbench.drawing import BOARD, DESK, FILES, Drawing
from moldloft.workbench.engine import Engine, EngineLostError
from moldloft.workbench.frames import frame_of, head_of
from moldloft.workbench.making import shape_functions
from moldloft.workbench.outbox import Outbox, Send
from moldloft.workbench.recent import recent_models
from moldloft.workbench.studies import KINDS as STUDY_KINDS
from moldloft.workbench.studies import Studies
from moldloft.workbench.text import Stored, applied, change_set, decoded, encoded, read

__all__ = ["Hub", "Tab"]

#: Requests of which only the newest of a tab counts.
NEWEST = {
    "set", "solve_for", "drag_to", "sync", "hover", "complete", "inspect", "field",
    "combs", "deviation", "measure", "blocks",
}  # fmt: skip

#: What a page may ask of the engine.
ASKED = NEWEST | {
    "open", "commit", "reset", "write", "drag_begin", "drag_end", "watch", "evaluate", "show",
    "lines_plan", "mesh", "hydrostatics", "section_areas", "overlay", "remove_overlay",
    "definition", "locate", "rename", "format", "words", "ping",
    "kinds", "add", "delete", "duplicate", "rename_object",
}  # fmt: skip

#: After these other tabs have something new, too.
CHANGING = {
    "set", "solve_for", "drag_to", "commit", "reset", "write", "drag_end", "show",
    "add", "delete", "duplicate", "rename_object",
}  # fmt: skip

MOST_TABS = 32
#: Bytes of a frame that says no more than what is wrong.
LONGEST_FAULT = 2000
#: Requests of one page that wait for the engine.
MOST_WAITING = 64
MOST_UPDATES = 20_000
#: Pages that were dropped and may ask why.
MOST_DROPPED = 4 * MOST_TABS


@dataclass
class Tab:
    """A page that is connected."""

    number: int
    outbox: Outbox
    known: int
    """The version of the text that it has, once what waits is sent."""
    dropped: str = ""
    """Why its last connection was ended, if the server ended it."""


@dataclass
class _Job:
    kind: str
    tab: int
    request: dict[str, Any]


@dataclass
class Hub:
    """A model, its text and its tabs.

    Parameters
    ----------
    path
        The model's file.
    library
        Folders, besides the model's own, that it may read.
    budget, memory
        As for :class:`Engine`.
    """

    path: Path
    library: Sequence[str] = ()
    budget: float = 20.0
    memory: int = 8 << 30
    tabs: dict[int, Tab] = field(default_factory=dict)
    beside: Callable[[Path], str] | None = None
    """Opens another model and returns the address of its page."""
    secret: str = ""
    """Pages prove with it to the next server that they were here."""

    def __post_init__(self) -> None:
        utf8_path(self.path)
        self.stored = read(self.path)
        check_language(self.stored.text, str(self.path))
        self.draft = Draft(self.path)
        self.text = self.stored.text
        self.recovered = False
        left = self.draft.left()
        if left is not None and left["text"] != self.text:
            self.text, self.recovered = left["text"], True
        self.version = 0
        self.instance = secrets.token_hex(8)
        self._first = 0
        self._updates: list[dict[str, Any]] = []
        folder = str(self.path.resolve().parent)
        self.engine = Engine(
            self.path.name, folder, self.library, memory=self.memory, budget=self.budget
        )
        self.rooms = [
            Drawing(
                room, lambda: (self.version, self.text), self.path.name, folder, self.library,
                self.memory, self.budget,
            )
            for room in (BOARD, DESK, FILES)
        ]  # fmt: skip
        self.studies = Studies(self.path)
        self._jobs: list[_Job] = []
        self._wake = asyncio.Event()
        self._count = 0
        self._failed: tuple[int, int] = (-1, 0)
        self._tasks: list[asyncio.Task[None]] = []
        self._sending: set[asyncio.Task[None]] = set()
        self._dropped: dict[int, str] = {}
        self._served = 0
        self._noted = self.stored.digest
        self._disk = asyncio.Lock()
        self._published = 0
        self._unkept = ""

    @property
    def dirty(self) -> bool:
        """True when the text differs from the file's."""
        return self.text != self.stored.text

    def start(self) -> None:
        """Begin to work."""
        self._tasks = [asyncio.ensure_future(self._work()), asyncio.ensure_future(self._watch())]

    async def stop(self) -> None:
        """End the engine; the draft stays when something is unsaved."""
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(self._publish(), 5)
        left = {task for task in (*self._tasks, *self._sending) if not task.done()}
        while left:
            # Once is not enough: until Python 3.12, `wait_for` forgets a cancellation that comes
            # together with the answer.
            for task in left:
                task.cancel()
            _, left = await asyncio.wait(left, timeout=0.5)
        for tab in list(self.tabs.values()):
            tab.outbox.close()
        await self.engine.end()
        for room in self.rooms:
            await room.end()
        await self.studies.close()
        self.draft.close(keep=self.dirty)

    # Tabs.

    def join(self, send: Send, drop: Callable[[], None] = lambda: None, *, before: int = 0) -> Tab:
        """A new tab.

        Parameters
        ----------
        send
            Sends one message, and returns when it is taken.
        drop
            Ends the connection at once.
        before
            The number that the page had in its last connection, if it had one.
        """
        if len(self.tabs) >= MOST_TABS:
            raise Error(f"{MOST_TABS} pages are open: close one first")
        self._count += 1
        number = self._count

        def give_up(why: str) -> None:
            self._dropped[number] = why
            while len(self._dropped) > MOST_DROPPED:
                del self._dropped[next(iter(self._dropped))]
            self.leave(tab)
            drop()

        outbox = Outbox(send, give_up, room=self._wake.set)
        tab = Tab(number, outbox, self.version, self._dropped.pop(before, ""))
        self.tabs[number] = tab
        return tab

    def leave(self, tab: Tab) -> None:
        """A tab has gone."""
        tab.outbox.close()
        if self.tabs.pop(tab.number, None) is None:
            return
        self._jobs = [job for job in self._jobs if job.tab != tab.number]
        for room in self.rooms:
            room.leave(tab.number)
        self._queue(_Job("close", tab.number, {"kind": "close", "tab": tab.number}))

    def hello(self, tab: Tab) -> dict[str, Any]:
        """First message to a page."""
        tab.known = self.version
        return {
            "kind": "hello",
            "instance": self.instance,
            "secret": self.secret,
            "tab": tab.number,
            "name": self.path.name,
            "text": self.text,
            "version": self.version,
            "dirty": self.dirty,
            "recovered": self.recovered,
            "dropped": tab.dropped,
        }

    def _tell(
        self, kind: str, state: Callable[[Tab], dict[str, Any]], *, but: int | None = None
    ) -> None:
        """Has all tabs sent a state, as it is when their turn comes."""
        for tab in self.tabs.values():
            if tab.number != but:
                tab.outbox.put_newest(kind, partial(_message, kind, state, tab))

    def _tell_saved(self, *, but: int | None = None) -> None:
        self._tell("saved", lambda _: {"version": self.version, "dirty": self.dirty}, but=but)

    def _tell_conflict(self, theirs: str) -> None:
        self._tell("conflict", lambda _: {"theirs": theirs})

    def _tell_engine(self, **state: str) -> None:
        self._tell("engine", lambda _: state)

    def _news(self, tab: Tab) -> dict[str, Any]:
        """The changes that are on disk and that a tab has not been sent."""
        first = max(min(tab.known, self._published), self._first)
        updates = self._updates[first - self._first : self._published - self._first]
        tab.known = max(tab.known, self._published)
        return {"from": first, "updates": updates, "dirty": self.dirty}

    def _to(self, tab: Tab | None, message: dict[str, Any] | bytes) -> None:
        if tab is not None:
            tab.outbox.put(message if isinstance(message, bytes) else json.dumps(message))

    # What pages say.

    async def hear(self, tab: Tab, message: dict[str, Any]) -> None:
        """Take a message of a page."""
        kind, number = message.get("kind"), message.get("id", 0)
        if kind == "push":
            self._push(tab, message)
        elif kind == "pull":
            self._pull(tab, message)
        elif kind == "save":
            await self._save(tab, message)
        elif kind == "revert":
            await self._revert(tab, number)
        elif kind == "recent":
            files = [{"name": p.name, "path": str(p)} for p in self._others()]
            self._to(tab, {"kind": "recent", "id": number, "files": files})
        elif kind == "open_recent":
            self._open_recent(tab, message)
        elif kind == "functions":
            self._to(tab, frame_of({"id": number, "functions": shape_functions()}, {}))
        elif kind == "formats":
            rows = [[row.name, row.about] for row in formats().values()]
            self._to(tab, frame_of({"id": number, "formats": rows}, {}))
        elif isinstance(kind, str) and kind in ASKED:
            self._ask(tab, kind, message)
        elif isinstance(kind, str) and kind in STUDY_KINDS:
            self._later(self._study(tab, message))
        elif room := next((r for r in self.rooms if r.room.takes(kind)), None):
            room.ask(tab.number, message, tab.outbox.put)
        else:
            self.refuse(tab, number, "no such request")

    async def _study(self, tab: Tab, message: dict[str, Any]) -> None:
        """Answer about the studies of the model; none of it waits for the engine."""
        number = message.get("id", 0)
        try:
            found = await self.studies.answer(message, dirty=self.dirty)
        except (Error, OSError) as error:
            self.refuse(tab, number, str(error))
            return
        self._to(tab, {"kind": "study", "id": number, **found})

    def _others(self) -> list[Path]:
        """Models that were opened before, but for this one."""
        return [path for path in recent_models() if path != self.path.resolve()]

    def _open_recent(self, tab: Tab, message: dict[str, Any]) -> None:
        """The address of a page of a model that was opened before; a page can open no other."""
        number = message.get("id", 0)
        path = next((p for p in self._others() if str(p) == message.get("path")), None)
        if path is None or self.beside is None:
            self.refuse(tab, number, f"`{message.get('path')}` is no longer there")
            return
        try:
            url = self.beside(path)
        except (Error, OSError) as error:
            self.refuse(tab, number, str(error))
            return
        self._to(tab, {"kind": "opened", "id": number, "url": url})

    def refuse(self, tab: Tab | None, number: Any, error: str) -> None:
        """Tell a page that a request is not carried out, by the id that it gave."""
        self._to(tab, {"kind": "refused", "id": number, "error": error})

    def _push(self, tab: Tab, message: dict[str, Any]) -> None:
        """Changes of the text. They count when the page knew the newest version."""
        number, updates = message.get("id", 0), message.get("updates")
        reply = {"kind": "pushed", "id": number, "ok": False, "version": self.version}
        try:
            if message.get("version") == self.version and isinstance(updates, list):
                text = self.text
                for update in updates:
                    text = applied(text, update["changes"])
                self._accept(text, [
                    {"changes": u["changes"], "clientID": str(u["clientID"])[:40]} for u in updates
                ])  # fmt: skip
                self._later(self._pushed(tab, {**reply, "ok": True, "version": self.version}))
                return
            if isinstance(message.get("version"), int) and message["version"] < self._first:
                # Too long away for the changes since: it takes the whole text.
                reply["text"] = self.text
        except (ValueError, KeyError, TypeError, IndexError) as error:
            reply = {**reply, "error": str(error), "text": self.text}
        self._to(tab, reply)

    async def _pushed(self, tab: Tab, reply: dict[str, Any]) -> None:
        """Says that changes count, once the draft is on disk: moves of sliders do not wait."""
        await self._publish()
        if self._unkept:
            reply["error"] = self._unkept
        self._to(tab, reply)

    def _accept(self, text: str, updates: list[dict[str, Any]]) -> None:
        """A new text, which counts at once; :meth:`_publish` has to follow."""
        self.text = text
        self.version += len(updates)
        self._updates += updates
        if len(self._updates) > MOST_UPDATES:
            gone = len(self._updates) - MOST_UPDATES
            self._first += gone
            del self._updates[:gone]
        self._queue(_Job("text", 0, {}))

    async def _publish(self) -> None:
        """Brings the newest text to disk, then to the pages; meanwhile the engine works on.

        Changes that come meanwhile go with the next draft. When it cannot be written, the text
        counts all the same, and the answers of pushes say so.
        """
        async with self._disk:
            version = self.version
            if self._published == version:
                return
            try:
                if self.dirty:
                    await asyncio.to_thread(self.draft.keep, self.text, self.stored.digest)
                else:
                    await asyncio.to_thread(self.draft.drop)
                self._unkept = ""
            except (OSError, Error) as error:
                self._unkept = f"the draft cannot be written: {error}"
            self._published = version
            self._tell("updates", self._news)

    def _pull(self, tab: Tab, message: dict[str, Any]) -> None:
        """The updates after the version of a page, or the whole text when they are not kept."""
        version = message.get("version")
        reply = {"kind": "pulled", "id": message.get("id", 0), "version": self.version}
        if isinstance(version, int) and self._first <= version <= self.version:
            reply.update({"from": version, "updates": self._updates[version - self._first :]})
        else:
            reply["text"] = self.text
        self._to(tab, reply)

    async def _save(self, tab: Tab, message: dict[str, Any]) -> None:
        """Write the text to the model's file, unless that has changed meanwhile."""
        async with self._disk:
            await self._write(tab, message)

    async def _write(self, tab: Tab, message: dict[str, Any]) -> None:
        number = message.get("id", 0)
        try:
            now = read(self.path) if self.path.exists() else None
            if now and now.digest != self.stored.digest and not message.get("force"):
                self._noted = now.digest
                self._to(tab, {"kind": "conflict", "id": number, "theirs": now.text})
                return
            expected = now.digest if now else None
            data = encoded(self.text, self.stored)
            self._noted = digest(data)
            await asyncio.to_thread(put, self.path, data, expected=expected)
            self.stored = decoded(data)
            self.draft.drop()
        except ChangedError:
            # Between looking and writing; what is there now is shown.
            await self._write(tab, message)
            return
        except (Error, OSError) as error:
            self.refuse(tab, number, str(error))
            return
        self.recovered = False
        self._to(tab, {"kind": "saved", "id": number, "version": self.version})
        self._tell_saved(but=tab.number)

    async def _watch(self) -> None:
        """Follow the file on disk."""
        stamp = None
        while True:
            await asyncio.sleep(0.5)
            try:
                status = self.path.stat()
                new = (status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns)
                if new == stamp:
                    continue
                stamp = new
                now = read(self.path)
            except (OSError, FileError):
                # It is being written, or has gone: the text is here.
                continue
            if now.digest == self._noted:
                continue
            if self.dirty and now.text != self.text:
                self._noted = now.digest
                self._tell_conflict(now.text)
                continue
            try:
                await self._outside(now)
            except (OSError, Error):
                # The draft cannot be written just now: the next look tries again.
                stamp = None

    async def _revert(self, tab: Tab, number: int) -> None:
        """The file's text for a page, which applies it as a step of its own history."""
        try:
            now = read(self.path)
            self.stored, self._noted = now, now.digest
            if now.text == self.text:
                await self._outside(now)
            reply = {"kind": "reverted", "id": number, "text": now.text}
        except (OSError, Error) as error:
            reply = {"kind": "refused", "id": number, "error": str(error)}
        self.recovered = False
        self._to(tab, reply)

    async def _outside(self, now: Stored) -> None:
        """Replace our text with that of the file."""
        self.stored = now
        if now.text != self.text:
            update = {"changes": change_set(self.text, now.text), "clientID": "disk"}
            self._accept(now.text, [update])
            await self._publish()
        else:
            async with self._disk:
                self.draft.drop()
            self._tell_saved()
        self._noted = now.digest

    # The engine.

    def _ask(self, tab: Tab, kind: str, message: dict[str, Any]) -> None:
        request = {**message, "tab": tab.number}
        if kind in NEWEST:
            for job in self._jobs:
                if job.kind == kind and job.tab == tab.number:
                    self._to(tab, {"kind": "superseded", "id": job.request.get("id", 0)})
                    old, new = job.request.get("values"), request.get("values")
                    if kind == "set" and isinstance(old, dict) and isinstance(new, dict):
                        request["values"] = {**old, **new}
                    job.request = request
                    return
        self._queue(_Job(kind, tab.number, request))

    def _later(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.ensure_future(work)
        self._sending.add(task)
        task.add_done_callback(self._sending.discard)

    def _queue(self, job: _Job) -> None:
        if job.kind in ("text", "sync") and any(
            j.kind == job.kind and j.tab == job.tab for j in self._jobs
        ):
            return
        if job.kind == "text":
            self._jobs.insert(0, job)
        elif job.kind == "close" or sum(j.tab == job.tab for j in self._jobs) < MOST_WAITING:
            self._jobs.append(job)
        else:
            self.refuse(self.tabs.get(job.tab), job.request.get("id", 0), "too many requests")
        self._wake.set()

    def _next(self) -> _Job | None:
        """The first job of a page other than the last one's, else the first.

        Requests of a page that is behind wait, so that it receives only the newest state.
        """
        ready = [
            (job.tab == self._served, k)
            for k, job in enumerate(self._jobs)
            if job.tab not in self.tabs or not self.tabs[job.tab].outbox.behind
        ]
        if not ready:
            return None
        job = self._jobs.pop(min(ready)[1])
        self._served = job.tab
        return job

    async def _work(self) -> None:
        while True:
            while (job := self._next()) is None:
                self._wake.clear()
                await self._wake.wait()
            try:
                await self._carry_out(job)
            except EngineLostError as lost:
                await self._lost(job, str(lost))

    async def _carry_out(self, job: _Job) -> None:
        fresh = self.engine.pid is None
        version = self.version
        if fresh:
            if self._failed[0] == version and self._failed[1] >= 2:
                raise EngineLostError("this text made the engine fail twice: change it to go on")
            await self.engine.start(self.text)
        request = job.request
        if job.kind == "text":
            tab = next((n for n, tab in self.tabs.items() if not tab.outbox.behind), 0)
            request = {"kind": "text", "tab": tab, "version": version, "text": self.text, "id": 0}
            job = _Job("text", tab, request)
        if fresh and job.kind not in ("open", "text", "close"):
            # What a new engine needs first: the version it has, and the viewers it sends to.
            await self.engine.ask(_data({"kind": "text", "version": version, "text": self.text}))
        try:
            data = _data(request)
        except ValueError as error:
            self.refuse(self.tabs.get(job.tab), request.get("id", 0), f"not a request: {error}")
            return
        frame = await self.engine.ask(data)
        if fault := _unread(frame):
            self.refuse(self.tabs.get(job.tab), request.get("id", 0), fault)
        else:
            self._to(self.tabs.get(job.tab), frame)
        if self._failed[0] == version:
            self._failed = (-1, 0)
            self._tell_engine(state="back")
        if job.kind == "text" or job.kind in CHANGING:
            for number in self.tabs:
                if number != job.tab:
                    self._queue(_Job("sync", number, {"kind": "sync", "tab": number, "id": 0}))

    async def _lost(self, job: _Job, why: str) -> None:
        """Start a new engine after a loss, and send every tab the complete state."""
        await self.engine.end()
        version, count = self._failed
        count = count + 1 if version == self.version else 1
        again = count < 2
        if why.startswith("this text"):
            count -= 1
        self._failed = (self.version, count)
        self.refuse(self.tabs.get(job.tab), job.request.get("id", 0), why)
        self._tell_engine(state="lost", reason=why)
        if again:
            for number in self.tabs:
                request = {"kind": "open", "tab": number, "id": 0}
                self._queue(_Job("open", number, request))


def _message(kind: str, state: Callable[[Tab], dict[str, Any]], tab: Tab) -> str:
    return json.dumps({"kind": kind, **state(tab)})


def _data(request: dict[str, Any]) -> bytes:
    """A request for the engine; ValueError for numbers and texts that JSON cannot represent."""
    return json.dumps(request, allow_nan=False, ensure_ascii=False).encode()


def _unread(frame: bytes) -> str:
    """The error of a request that the engine could not parse, and so not answer by its id."""
    if len(frame) > LONGEST_FAULT:
        return ""
    head = head_of(frame)
    return str(head.get("error", "")) if head.get("id") is None else ""
