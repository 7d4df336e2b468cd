"""The hub: owner of the texts, queue of requests to the engine, and messages to each tab.

The texts are here, not in the engine and not in a page: that of the model, and those of the files
beside it that pages have opened. The engine is asked one thing at a time; what has become out of
date while it waited is left out. Nothing here waits for a page: each has an outbox.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import secrets
from collections.abc import Callable, Coroutine, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from moldloft.errors import Error
from moldloft.formats import formats
from moldloft.language import check_language
from moldloft.storage import utf8_path
from moldloft.workbench.draft import Draft
from moldloft.workbench.drawing import BOARD, DESK, FILES, Drawing
from moldloft.workbench.engine import Engine, EngineLostError
from moldloft.workbench.frames import frame_of, head_of, without
from moldloft.workbench.making import shape_functions
from moldloft.workbench.outbox import Outbox, Send
from moldloft.workbench.recent import recent_models
from moldloft.workbench.shared_text import Reader, SharedText
from moldloft.workbench.studies import KINDS as STUDY_KINDS
from moldloft.workbench.studies import Studies
from moldloft.workbench.text import read

__all__ = ["Hub", "Tab"]

#: Requests of which only the newest of a tab counts.
NEWEST = {
    "set", "solve_for", "drag_to", "sync", "hover", "complete", "inspect", "field",
    "combs", "deviation", "measure", "blocks", "settle",
}  # fmt: skip

#: What a page may ask of the engine.
ASKED = NEWEST | {
    "open", "commit", "reset", "write", "drag_begin", "drag_end", "watch", "evaluate", "show",
    "lines_plan", "mesh", "hydrostatics", "section_areas", "overlay", "remove_overlay",
    "definition", "locate", "rename", "format", "words", "ping",
    "kinds", "add", "delete", "duplicate", "rename_object", "reorder",
}  # fmt: skip

#: After these other tabs have something new, too.
CHANGING = {
    "set", "solve_for", "drag_to", "settle", "commit", "reset", "write", "drag_end", "show",
    "add", "delete", "duplicate", "rename_object", "reorder", "text", "text_beside",
}  # fmt: skip

#: Results for a hand that rests.
RESULTS = {"measure", "settle"}

#: Moves of a hand: results for the shape before them are no longer asked for.
MOVES = {"set", "solve_for", "drag_begin", "drag_to"}

#: Requests about a text, which name its file; that of the model has no name.
OF_TEXTS = {"push", "pull", "save", "revert"}

#: Jobs of the hub itself: no page hears their answers but for what has changed.
OWN = {"text", "text_beside"}

MOST_TABS = 64
#: Bytes of a frame that says no more than what is wrong.
LONGEST_FAULT = 2000
#: Requests of one page that wait for the engine.
MOST_WAITING = 64
#: Files beside the model that are open at a time.
MOST_FILES = 32
#: Pages that were dropped and may ask why.
MOST_DROPPED = 4 * MOST_TABS


@dataclass
class Tab:
    """A connected page."""

    number: int
    outbox: Outbox
    known: dict[str, int]
    """The versions of texts that the page has once its queue is sent."""
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
    """Secret with which pages identify themselves to the next server."""

    def __post_init__(self) -> None:
        utf8_path(self.path)
        check_language(read(self.path).text, str(self.path))
        self.main = SharedText(self.path, self)
        self.others: dict[str, SharedText] = {}
        self._files: dict[str, tuple[int, ...]] = {}
        self.instance = secrets.token_hex(8)
        folder = str(self.path.resolve().parent)
        self.engine = Engine(
            self.path.name, folder, self.library, memory=self.memory, budget=self.budget
        )
        self.rooms = [
            Drawing(
                room, self._text_of, self.path.name, folder,
                self.library, self.memory, self.budget,
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
        self._running = ""
        self._given_up = False

    @property
    def texts(self) -> list[SharedText]:
        """The model's text, and those of files beside it."""
        return [self.main, *self.others.values()]

    def start(self) -> None:
        """Begin to work."""
        self._tasks = [asyncio.ensure_future(self._work()), asyncio.ensure_future(self._watch())]

    async def stop(self) -> None:
        """End the engine; drafts with unsaved changes are kept."""
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(asyncio.gather(*(text.publish() for text in self.texts)), 5)
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
        for text in self.texts:
            text.close()

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
            # A page that does not read makes room for one that does.
            behind = next((tab for tab in self.tabs.values() if tab.outbox.behind), None)
            if behind is not None:
                behind.outbox.give_up(f"{MOST_TABS} pages are open, and it is behind")
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
        known = {"": self.main.version}
        tab = Tab(number, outbox, known, self._dropped.pop(before, ""))
        self.tabs[number] = tab
        return tab

    def leave(self, tab: Tab) -> None:
        """A tab has gone."""
        tab.outbox.close()
        if self.tabs.pop(tab.number, None) is None:
            return
        for name in list(tab.known):
            self._close_file(tab, name)
        self._jobs = [job for job in self._jobs if job.tab != tab.number]
        for room in self.rooms:
            room.leave(tab.number)
        self._queue(_Job("close", tab.number, {"kind": "close", "tab": tab.number}))

    def hello(self, tab: Tab) -> dict[str, Any]:
        """First message to a page."""
        return {
            "kind": "hello",
            "instance": self.instance,
            "secret": self.secret,
            "tab": tab.number,
            "name": self.path.name,
            "dropped": tab.dropped,
            **self.main.state(tab),
            "unsaved": [name for name, text in self.others.items() if text.dirty],
        }

    def _tell_engine(self, **state: str) -> None:
        message = json.dumps({"kind": "engine", **state})
        for tab in self.tabs.values():
            tab.outbox.put_newest("engine", lambda: message)

    def _to(self, tab: Tab | None, message: dict[str, Any] | bytes) -> None:
        if tab is not None:
            tab.outbox.put(message if isinstance(message, bytes) else json.dumps(message))

    # What pages say.

    async def hear(self, tab: Tab, message: dict[str, Any]) -> None:
        """Handle a message of a page."""
        kind, number = message.get("kind"), message.get("id", 0)
        if kind in OF_TEXTS:
            name = message.get("file", "")
            text = self.main if name == "" else self.others.get(name)
            if text is None or name not in tab.known:
                self.refuse(tab, number, f"`{name}` is not open here")
            else:
                await text.hear(tab, message)
        elif kind == "open_file":
            self._open_file(tab, number, message.get("file"))
        elif kind == "close_file":
            self._close_file(tab, message.get("file"))
            self._to(tab, {"kind": "closed", "id": number})
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
            self.later(self._study(tab, message))
        elif room := next((r for r in self.rooms if r.room.takes(kind)), None):
            own = message.get("file") or ""
            if own and not (isinstance(own, str) and own in self.others):
                self.refuse(tab, number, f"`{own}` is not open here")
            elif unsaved := self._unsaved(own):
                # Rooms read files, not the texts that count before they are saved.
                self.refuse(
                    tab, number, f"save {unsaved} first: this reads files as they are saved"
                )
            else:
                room.ask(tab.number, message, tab.outbox.put)
        else:
            self.refuse(tab, number, "no such request")

    async def _study(self, tab: Tab, message: dict[str, Any]) -> None:
        """Answer about the studies of the model; none of it waits for the engine."""
        number = message.get("id", 0)
        try:
            found = await self.studies.answer(message, dirty=any(text.dirty for text in self.texts))
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
        """Report to a page that a request, given by id, was refused."""
        self._to(tab, {"kind": "refused", "id": number, "error": error})

    # Texts.

    def _text_of(self, request: dict[str, Any]) -> tuple[str, int, str]:
        """The name, version and text of a request: the model's, or of a file beside it."""
        name = request.get("file") or ""
        text = self.others.get(name) if name else self.main
        if text is None:
            raise ValueError(f"`{name}` is no longer open")
        return name, text.version, text.text

    def _unsaved(self, own: str) -> str:
        """Names of unsaved files that a room may read beside the text that it is about."""
        dirty = [
            Path(name).name for name, text in self.others.items() if text.dirty and name != own
        ]
        # A sketch reads the files that it names.
        return ", ".join(name for name in dirty if not own or name in self.others[own].text)

    def readers(self) -> list[Reader]:
        """All pages, to be notified of changes of a text."""
        return list(self.tabs.values())

    def text_changed(self, text: SharedText) -> None:
        """Send a text to the engine."""
        kind = "text" if text is self.main else "text_beside"
        self._queue(_Job(kind, 0, {"name": text.name}))

    def later(self, work: Coroutine[Any, Any, None]) -> None:
        """Start a background task."""
        task = asyncio.ensure_future(work)
        self._sending.add(task)
        task.add_done_callback(self._sending.discard)

    def _open_file(self, tab: Tab, number: Any, name: Any) -> None:
        """Opens a file that the model reads; pages can open no other."""
        try:
            if not isinstance(name, str) or name not in self._files:
                raise Error(f"the model reads no file `{name}`")
            text = self.others.get(name) or self._opened(name)
        except (Error, OSError) as error:
            self.refuse(tab, number, str(error))
            return
        self._to(tab, {"kind": "file", "id": number, "file": name, **text.state(tab)})

    def _opened(self, name: str) -> SharedText:
        """The text of a file beside the model, from now on the one that counts."""
        if len(self.others) >= MOST_FILES:
            raise Error(f"{MOST_FILES} files are open: close one first")
        text = SharedText(Path(name), self, name)
        if "\0" in text.text:
            text.close()
            raise Error(f"`{name}` is not a text")
        self.others[name] = text
        if text.dirty:
            self.text_changed(text)
            for tab in self.tabs.values():
                self._to(tab, {"kind": "unsaved", "file": name})
        return text

    def _close_file(self, tab: Tab, name: Any) -> None:
        """A page no longer shows a file; one that is as it is on disk is that of the disk again."""
        text = self.others.get(name) if isinstance(name, str) else None
        if text is None:
            return
        tab.known.pop(name, None)
        if not text.dirty and not any(name in other.known for other in self.tabs.values()):
            del self.others[name]
            text.close()
            self._queue(_Job("text_beside", 0, {"name": name}))

    def _read_by_model(self, names: list[str]) -> None:
        """Takes in which files the model reads; what an earlier server left of them is open."""
        known = self._files
        self._files = {n: known[n] if n in known else _stamp(n) for n in names}
        for name in names:
            if name not in self.others and Draft.waits(Path(name)):
                # Another workbench may have it.
                with contextlib.suppress(Error, OSError):
                    self._opened(name)

    async def _watch(self) -> None:
        """Follow the files on disk."""
        while True:
            await asyncio.sleep(0.5)
            for text in self.texts:
                await text.look()
            changed = False
            for name, known in list(self._files.items()):
                stamp = _stamp(name)
                changed |= stamp != known and name not in self.others
                self._files[name] = stamp
            if changed:
                self.text_changed(self.main)

    # The engine.

    def _ask(self, tab: Tab, kind: str, message: dict[str, Any]) -> None:
        request = {**message, "tab": tab.number}
        if kind in MOVES:
            self._give_up_results()
        if kind in NEWEST:
            for job in self._jobs:
                if job.kind == kind and job.tab == tab.number:
                    self._superseded(job)
                    old, new = job.request.get("values"), request.get("values")
                    if kind == "set" and isinstance(old, dict) and isinstance(new, dict):
                        request["values"] = {**old, **new}
                    job.request = request
                    return
        self._queue(_Job(kind, tab.number, request))

    def _give_up_results(self) -> None:
        """Numbers and exact bodies that wait or are computed give way to a move of a hand."""
        for job in [job for job in self._jobs if job.kind in RESULTS]:
            self._jobs.remove(job)
            self._superseded(job)
        if self._running in RESULTS and not self._given_up:
            self._given_up = True
            self.engine.cancel()

    def _superseded(self, job: _Job) -> None:
        self._to(self.tabs.get(job.tab), {"kind": "superseded", "id": job.request.get("id", 0)})

    def _queue(self, job: _Job) -> None:
        if job.kind in OWN | {"sync"} and any(
            (j.kind, j.tab, j.request.get("name")) == (job.kind, job.tab, job.request.get("name"))
            for j in self._jobs
        ):
            return
        if job.kind in OWN:
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
        version = self.main.version
        if self.engine.pid is None:
            if self._failed[0] == version and self._failed[1] >= 2:
                raise EngineLostError("this text made the engine fail twice: change it to continue")
            await self._begin(job)
        request = job.request
        if job.kind in OWN:
            tab = next((n for n, tab in self.tabs.items() if not tab.outbox.behind), 0)
            request = {**self._own(job), "tab": tab, "id": 0}
            job = _Job(job.kind, tab, request)
        try:
            data = _data(request)
        except ValueError as error:
            self.refuse(self.tabs.get(job.tab), request.get("id", 0), f"not a request: {error}")
            return
        self._running, self._given_up = job.kind, False
        try:
            frame = await self.engine.ask(data)
        finally:
            self._running = ""
        if self._given_up:
            # What the page is to know besides is in the frame; the numbers are not.
            frame = without(frame, "watched")
        if fault := _unread(frame):
            self.refuse(self.tabs.get(job.tab), request.get("id", 0), fault)
        else:
            self._to(self.tabs.get(job.tab), frame)
        if self._failed[0] == version:
            self._failed = (-1, 0)
            self._tell_engine(state="back")
        if job.kind in OWN:
            await self._ask_files()
        if job.kind in CHANGING:
            for number in self.tabs:
                if number != job.tab:
                    self._queue(_Job("sync", number, {"kind": "sync", "tab": number, "id": 0}))

    def _own(self, job: _Job) -> dict[str, Any]:
        """The request that brings a text to the engine, as the text is now."""
        if job.kind == "text":
            return {"kind": "text", "version": self.main.version, "text": self.main.text}
        name = job.request["name"]
        text = self.others.get(name)
        return {"kind": "text_beside", "name": name, "text": text and text.text}

    async def _begin(self, job: _Job) -> None:
        """A new engine: it needs the version of the text, and the texts of files beside it."""
        await self.engine.start(self.main.text)
        if job.kind not in ("open", "text", "close"):
            await self.engine.ask(_data(self._own(_Job("text", 0, {}))))
        await self._ask_files()
        for name in self.others:
            await self.engine.ask(_data(self._own(_Job("text_beside", 0, {"name": name}))))

    async def _ask_files(self) -> None:
        head = head_of(await self.engine.ask(_data({"kind": "reads"})))
        self._read_by_model(list(head.get("reads", [])))

    async def _lost(self, job: _Job, why: str) -> None:
        """Start a new engine after a loss, and send every tab the complete state."""
        await self.engine.end()
        version, count = self._failed
        count = count + 1 if version == self.main.version else 1
        again = count < 2
        if why.startswith("this text"):
            count -= 1
        self._failed = (self.main.version, count)
        self.refuse(self.tabs.get(job.tab), job.request.get("id", 0), why)
        self._tell_engine(state="lost", reason=why)
        if again:
            for number in self.tabs:
                request = {"kind": "open", "tab": number, "id": 0}
                self._queue(_Job("open", number, request))


def _stamp(name: str) -> tuple[int, ...]:
    """A stamp that changes with a file on disk; empty if the file is missing."""
    try:
        status = Path(name).stat()
    except OSError:
        return ()
    return status.st_ino, status.st_size, status.st_mtime_ns


def _data(request: dict[str, Any]) -> bytes:
    """A request for the engine; ValueError for numbers and texts that JSON cannot represent."""
    return json.dumps(request, allow_nan=False, ensure_ascii=False).encode()


def _unread(frame: bytes) -> str:
    """The error of a request that the engine could not parse, and so not answer by its id."""
    if len(frame) > LONGEST_FAULT:
        return ""
    head = head_of(frame)
    return str(head.get("error", "")) if head.get("id") is None else ""
