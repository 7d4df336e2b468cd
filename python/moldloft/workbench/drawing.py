"""The processes of the drawing board, the fairing desk and of files, and their queues of requests.

Each is started by the first request, so that models without a sketch or a desk have none. It is
asked one thing at a time, the newest of its kind: a pointer that has moved on is not answered.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from moldloft.workbench.engine import Engine, EngineLostError
from moldloft.workbench.frames import MAGIC

__all__ = ["BOARD", "DESK", "FILES", "Drawing", "Room"]

_MOST_WAITING = 64


@dataclass(frozen=True)
class Room:
    """Kinds of processes in addition to the engine."""

    work: str
    """As for :class:`~moldloft.workbench.engine.Engine`."""
    title: str
    """Its name in messages."""
    newest: frozenset[str]
    """Requests that a newer one of the same page supersedes."""
    others: frozenset[str]
    """Further requests of a page."""
    last: frozenset[str]
    """Requests of low priority."""
    stop: str = ""
    """The request that cancels the current one."""
    patience: float = 1.0
    """Its time limit, as a multiple of that of a model change."""

    def takes(self, kind: Any) -> bool:
        """True if this subprocess answers a request."""
        return isinstance(kind, str) and kind in self.newest | self.others | {self.stop} - {""}


#: Bodies and checks take longest.
BOARD = Room(
    "board",
    "the drawing board",
    frozenset({"board_pointer", "board_drag", "board_solid", "board_check", "board_open"}),
    frozenset({"board_edit", "board_place", "board_stroke"}),
    frozenset({"board_solid", "board_check"}),
)
DESK = Room(
    "desk",
    "the fairing desk",
    frozenset({"desk_slide", "desk_show"}),
    frozenset({"desk_open", "desk_run", "desk_line", "desk_apply", "desk_save"}),
    frozenset(),
    "desk_stop",
)
FILES = Room(
    "files",
    "the writing of files",
    frozenset(),
    frozenset({"export", "import"}),
    frozenset(),
    # Nobody drags while a file is made, and libraries of other projects start slowly.
    patience=10.0,
)

#: Seconds in which a process starts on a busy machine.
_STARTING = 60.0

Say = Callable[["str | bytes"], None]


class Drawing:
    """A subprocess of the workbench for a model's text: board, desk or files.

    Parameters
    ----------
    room
        Which one.
    text
        Gives the name, the version and the text that a request is about.
    name, folder, library, memory, budget
        As for :class:`~moldloft.workbench.engine.Engine`.
    """

    def __init__(
        self,
        room: Room,
        text: Callable[[dict[str, Any]], tuple[str, int, str]],
        name: str,
        folder: str,
        library: Sequence[str],
        memory: int,
        budget: float,
    ) -> None:
        self.room = room
        self._text = text
        self._engine = Engine(
            name, folder, library, memory=memory, budget=room.patience * budget, work=room.work,
            starting=_STARTING,
        )  # fmt: skip
        self._stopped = False
        self._known: tuple[str, int] | None = None
        self._waiting: list[tuple[int, dict[str, Any], Say]] = []
        self._task: asyncio.Task[None] | None = None
        self._ending: asyncio.Task[None] | None = None

    def ask(self, tab: int, request: dict[str, Any], say: Say) -> None:
        """Answer a request, unless the page repeats it for a newer state first."""
        kind = request["kind"]
        if kind == self.room.stop:
            self.leave(tab)
            self._stopped = True
            self._ending = asyncio.ensure_future(self._engine.end())
            say(json.dumps({"kind": self.room.work, "id": request.get("id", 0)}))
            return
        if kind in self.room.newest:
            for k, (other, old, _) in enumerate(self._waiting):
                if other == tab and old["kind"] == kind:
                    say(json.dumps({"kind": "superseded", "id": old.get("id", 0)}))
                    del self._waiting[k]
                    break
        if sum(t == tab for t, _, _ in self._waiting) >= _MOST_WAITING:
            say(json.dumps(_refused(request, "too many requests")))
            return
        self._waiting.append((tab, request, say))
        if self._task is None or self._task.done():
            self._task = asyncio.ensure_future(self._work())

    def leave(self, tab: int) -> None:
        """A page has gone."""
        self._waiting = [w for w in self._waiting if w[0] != tab]

    async def end(self) -> None:
        """End the process."""
        self._waiting.clear()
        if self._task is not None:
            self._task.cancel()
        await self._engine.end()

    async def _work(self) -> None:
        while self._waiting:
            first = next(
                (k for k, w in enumerate(self._waiting) if w[1]["kind"] not in self.room.last), 0
            )
            _, request, say = self._waiting.pop(first)
            try:
                reply = await self._answer(request)
                say(reply if reply.startswith(MAGIC) else reply.decode())
            except EngineLostError as lost:
                say(json.dumps(_refused(request, f"{self.room.title} was stopped: {lost}")))
            except ValueError as error:
                say(json.dumps(_refused(request, f"not a request: {error}")))

    async def _answer(self, request: dict[str, Any]) -> bytes:
        self._stopped = False
        name, version, text = self._text(request)
        sent = {**request, "version": version}
        known = self._engine.pid is not None
        if known:
            if (name, version) != self._known:
                sent["text"] = text
            self._known = name, version
            try:
                return await self._engine.ask(_data(sent))
            except EngineLostError:
                late = self._engine.pid is not None or request["kind"] in self.room.last
                if late or self._stopped:
                    raise
        # A new process has everything in the text, so the request is sent once more.
        await self._engine.start(text)
        self._known = name, version
        return await self._engine.ask(_data({**request, "version": version}))


def _data(request: dict[str, Any]) -> bytes:
    return json.dumps(request, allow_nan=False, ensure_ascii=False).encode()


def _refused(request: dict[str, Any], why: str) -> dict[str, Any]:
    return {"kind": "refused", "id": request.get("id", 0), "error": why}
