"""Control of the engine process: start with a text, requests, stop, end."""

from __future__ import annotations

import asyncio
import contextlib
import os
import struct
import sys
from collections.abc import Sequence

from moldloft._engine import command
from moldloft.pipes import broken_pipes_raise

if sys.platform == "linux":
    import fcntl

__all__ = ["Engine", "EngineLostError"]

_CANCEL = b'{"kind":"cancel"}'
_LARGEST_FRAME = 1 << 30
#: Bytes that are read ahead: most frames at once, where the standard 64 KiB take a turn each.
_BUFFER = 1 << 20


def _widen(process: asyncio.subprocess.Process) -> None:
    """Enlarges the buffer of the pipe of answers to a frame, if the system permits."""
    if sys.platform == "linux":
        transport = getattr(process, "_transport", None)
        answers = transport.get_pipe_transport(1) if transport else None
        if answers is not None:
            with contextlib.suppress(OSError):
                fcntl.fcntl(answers.get_extra_info("pipe"), fcntl.F_SETPIPE_SZ, _BUFFER)


class EngineLostError(Exception):
    """The engine process ended or was killed before it answered."""


class Engine:
    """A child process that holds the document.

    Parameters
    ----------
    name
        Name of the model; its extension gives the format.
    folder
        The folder that the model may read.
    library
        Further folders.
    memory
        The most bytes of the model.
    budget
        Seconds for one request; then the work is stopped, and a little later the process ended.
    work
        Task of the process: ``"model"``, ``"board"`` for the drawing board of a sketch,
        ``"desk"`` for the fairing desk, or ``"files"`` for exports.
    starting
        Further seconds for the first request: those of the imports on a busy machine.
    """

    def __init__(
        self,
        name: str,
        folder: str | None,
        library: Sequence[str] = (),
        *,
        memory: int = 8 << 30,
        budget: float = 20.0,
        work: str = "model",
        starting: float = 0.0,
    ) -> None:
        self._arguments = [work, str(memory), name, folder or "", *library]
        self._budget, self._starting = budget, starting
        self._fresh = False
        self._process: asyncio.subprocess.Process | None = None

    @property
    def pid(self) -> int | None:
        """The running process, if any."""
        return self._process.pid if self._process else None

    async def start(self, text: str) -> None:
        """Start a process with a text; a running one is ended."""
        await self.end()
        self._process = await asyncio.create_subprocess_exec(
            *command(*self._arguments),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.DEVNULL,
            limit=_BUFFER,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        _widen(self._process)
        self._fresh = True
        await self._send(text.encode())

    async def end(self) -> None:
        """End the process, if one is running."""
        process, self._process = self._process, None
        if process is None:
            return
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()

    async def ask(self, request: bytes) -> bytes:
        """The frame that answers a request.

        Raises
        ------
        EngineLostError
            If there is no answer.
        """
        await self._send(request)
        seconds = self._budget + (self._starting if self._fresh else 0.0)
        self._fresh = False
        try:
            return await asyncio.wait_for(asyncio.shield(reading := self._reading()), seconds)
        except TimeoutError:
            await self._send(_CANCEL)
        try:
            return await asyncio.wait_for(reading, 2.0)
        except TimeoutError:
            await self.end()
            raise EngineLostError(f"no answer within {seconds:g} s") from None

    def cancel(self) -> None:
        """Have the request that runs end early; its answer comes as always."""
        process = self._process
        if process is not None and process.stdin is not None:
            process.stdin.write(struct.pack("<I", len(_CANCEL)) + _CANCEL)

    def _reading(self) -> asyncio.Task[bytes]:
        reading = asyncio.ensure_future(self._receive())
        # The requester may be gone when the engine ends, as with a stopped server.
        reading.add_done_callback(lambda done: done.cancelled() or done.exception())
        return reading

    async def _send(self, message: bytes) -> None:
        process = self._process
        if process is None or process.stdin is None:
            raise EngineLostError("the engine is not running")
        try:
            with broken_pipes_raise():
                process.stdin.write(struct.pack("<I", len(message)) + message)
            await process.stdin.drain()
        except (BrokenPipeError, ConnectionResetError):
            raise EngineLostError(await self._why()) from None

    async def _receive(self) -> bytes:
        process = self._process
        if process is None or process.stdout is None:
            raise EngineLostError("the engine is not running")
        try:
            (length,) = struct.unpack("<I", await process.stdout.readexactly(4))
            if length > _LARGEST_FRAME:
                raise EngineLostError("the engine sent nonsense")
            return await process.stdout.readexactly(length)
        except (asyncio.IncompleteReadError, ConnectionResetError):
            raise EngineLostError(await self._why()) from None

    async def _why(self) -> str:
        process, self._process = self._process, None
        if process is None:
            return "the engine is not running"
        status = await process.wait()
        if status == -6:
            return "the engine ended: most likely the model needs more memory than it may have"
        return f"the engine ended with status {status}"
