"""Queue of messages to a page, so that the server never waits for a page that does not read."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

__all__ = ["Outbox"]

Send = Callable[["str | bytes"], Awaitable[None]]

#: Bytes that may wait behind a message that a page does not take.
MOST_BYTES = 8 << 20
#: Seconds that a page has to take a message, and bytes for which it has a second more.
PATIENCE, BYTES_PER_SECOND = 10.0, 1 << 20
#: Seconds after which a page that does not take a message may have no more than MOST_BYTES waiting.
STALLED = 1.0
#: Bytes of a waiting message besides its text.
OVERHEAD = 500
#: Bytes that wait beyond which a page is not listened to: it asks for more than it takes.
DEAF = 2 << 20
#: Bytes under way or waiting, or messages that wait, beyond which a page is behind: it is sent the
#: newest state later.
BEHIND, BEHIND_MESSAGES = 1 << 20, 8


@dataclass
class _Message:
    make: Callable[[], str | bytes]
    size: int
    key: str


class Outbox:
    """Messages to one page, sent in order by a separate task.

    Among messages with the same key only the newest is sent, built at that time. A page that
    receives nothing for :data:`PATIENCE` seconds, or has more than :data:`MOST_BYTES` queued, is
    disconnected: its queue is cleared, and it starts again when it reconnects.

    Parameters
    ----------
    send
        Sends one message; returns when the page, or the system for it, has taken it.
    drop
        Ends the connection at once; is given the reason.
    room
        Called when the page is no longer behind.
    patience
        Seconds that the page has for a message.
    """

    def __init__(
        self,
        send: Send,
        drop: Callable[[str], None] = lambda why: None,
        room: Callable[[], None] = lambda: None,
        patience: float = PATIENCE,
    ) -> None:
        self._send, self._drop, self._room = send, drop, room
        self._patience = patience
        self._waiting: deque[_Message] = deque()
        self._newest: dict[str, _Message] = {}
        self._bytes = 0
        self._under_way = 0
        # What the system may still hold of it.
        self._last = 0
        self._since = 0.0
        self._task: asyncio.Task[None] | None = None
        self._closed = False
        self._listening = asyncio.Event()
        self._listening.set()

    @property
    def behind(self) -> bool:
        """True while more than :data:`BEHIND` bytes, or :data:`BEHIND_MESSAGES`, are queued."""
        return self._bytes + self._under_way > BEHIND or len(self._waiting) > BEHIND_MESSAGES

    async def heard(self) -> None:
        """Return when the page may be listened to: fewer than :data:`DEAF` bytes wait for it."""
        await self._listening.wait()

    def put(self, data: str | bytes) -> None:
        """Queue a message."""
        self._add(_Message(lambda: data, len(data) + OVERHEAD, ""))

    def put_newest(self, key: str, make: Callable[[], str]) -> None:
        """Queue a message that ``make`` builds at sending, unless one is queued under the key."""
        old = self._newest.get(key)
        if old is not None:
            old.make = make
            return
        message = _Message(make, 0, key)
        self._newest[key] = message
        self._add(message)

    def close(self) -> None:
        """Clear the queue; nothing more is sent."""
        self._closed = True
        self._listening.set()
        self._waiting.clear()
        self._newest.clear()
        self._bytes = 0
        if self._task is not None:
            self._task.cancel()

    def _add(self, message: _Message) -> None:
        if self._closed:
            return
        self._waiting.append(message)
        self._bytes += message.size
        if self._bytes > DEAF:
            self._listening.clear()
        if self._task is None or self._task.done():
            self._since = time.monotonic()
            self._task = asyncio.ensure_future(self._run())
        elif self._bytes > MOST_BYTES and time.monotonic() - self._since > STALLED:
            self.give_up(f"{MOST_BYTES >> 20} MB waited for it")

    async def _run(self) -> None:
        while self._waiting and not self._closed:
            was = self.behind
            message = self._waiting.popleft()
            self._newest.pop(message.key, None)
            self._bytes -= message.size
            if self._bytes <= DEAF:
                self._listening.set()
            data = message.make()
            self._under_way, self._since = len(data), time.monotonic()
            seconds = self._patience + (self._last + len(data)) / BYTES_PER_SECOND
            self._last = len(data)
            try:
                await asyncio.wait_for(self._send(data), seconds)
            except TimeoutError:
                self.give_up(f"it took nothing for {seconds:.0f} s")
                return
            except Exception:
                # The page has gone, as its own reader notices.
                self.close()
                return
            was, self._under_way = was or self.behind, 0
            if was and not self.behind:
                self._room()

    def give_up(self, why: str) -> None:
        """Disconnect the page, for a reason that it is told when it is back."""
        self.close()
        self._drop(why)
