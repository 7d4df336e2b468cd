"""The drawing board's process beside the engine, and what waits for it.

It is started by the first request, so that models other than sketches have none. It is asked one
thing at a time, the newest of its kind: a pointer that has moved on is not answered.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from typing import Any

from moldloft.workbench.engine import Engine, EngineLostError

__all__ = ["DRAWN", "Drawing"]

#: Requests of which only the newest of a page counts.
_NEWEST = {"board_pointer", "board_drag", "board_solid", "board_check", "board_open"}

#: What a page may ask of the board.
DRAWN = _NEWEST | {"board_edit", "board_place"}

#: What waits while there is anything else: bodies and checks take longest.
_LAST = {"board_solid", "board_check"}
_MOST_WAITING = 64

Say = Callable[[str], None]


class Drawing:
    """The drawing board of a model's text.

    Parameters
    ----------
    text
        Gives the version of the text and the text.
    name, folder, memory, budget
        As for :class:`~moldloft.workbench.engine.Engine`.
    """

    def __init__(
        self,
        text: Callable[[], tuple[int, str]],
        name: str,
        folder: str,
        memory: int,
        budget: float,
    ) -> None:
        self._text = text
        self._engine = Engine(name, folder, memory=memory, budget=budget, work="board")
        self._known = -1
        self._waiting: list[tuple[int, dict[str, Any], Say]] = []
        self._task: asyncio.Task[None] | None = None

    def ask(self, tab: int, request: dict[str, Any], say: Say) -> None:
        """Have a request answered, unless the page asks the same of a newer state first."""
        kind = request["kind"]
        if kind in _NEWEST:
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
            first = next((k for k, w in enumerate(self._waiting) if w[1]["kind"] not in _LAST), 0)
            _, request, say = self._waiting.pop(first)
            try:
                say((await self._answer(request)).decode())
            except EngineLostError as lost:
                say(json.dumps(_refused(request, f"the drawing board was stopped: {lost}")))
            except ValueError as error:
                say(json.dumps(_refused(request, f"not a request: {error}")))

    async def _answer(self, request: dict[str, Any]) -> bytes:
        version, text = self._text()
        sent = {**request, "version": version}
        known = self._engine.pid is not None
        if known:
            if version != self._known:
                sent["text"] = text
            self._known = version
            try:
                return await self._engine.ask(_data(sent))
            except EngineLostError:
                if self._engine.pid is not None or request["kind"] in _LAST:
                    raise
        # A new process has everything in the text, so the request is sent once more.
        await self._engine.start(text)
        self._known = version
        return await self._engine.ask(_data({**request, "version": version}))


def _data(request: dict[str, Any]) -> bytes:
    return json.dumps(request, allow_nan=False, ensure_ascii=False).encode()


def _refused(request: dict[str, Any], why: str) -> dict[str, Any]:
    return {"kind": "refused", "id": request.get("id", 0), "error": why}
