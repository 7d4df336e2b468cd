"""A Python process that answers requests one after the other, and that a request may crash.

Requests and answers are JSON, each behind its length; only answers come from the process's standard
output, whatever its libraries print.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import signal
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, BinaryIO

from moldloft.pipes import broken_pipes_raise

__all__ = ["ChildProcess", "ProcessEnd", "bounded", "send_end", "serve"]

_HEAD = struct.Struct("<Q")

#: The key of the message of a process whose copy has ended over a request.
_ENDED = "process-ended"


@dataclass(frozen=True)
class ProcessEnd:
    """End of a process that sent no answer."""

    status: int
    """Its return code; below zero the number of a signal."""
    late: bool
    """True if it was ended because it exceeded the time limit."""
    asked: bool
    """True if the process had received the request."""

    @property
    def by(self) -> str:
        """The name of the signal, or the status."""
        known = -self.status in {*signal.Signals}
        return signal.Signals(-self.status).name if known else f"status {self.status}"


class ChildProcess:
    """A process that runs a module, whose main part is :func:`serve`.

    Parameters
    ----------
    module
        The module's full name.
    quiet
        True to discard its standard error.
    grace
        Seconds from SIGTERM, which lets the process end what it has begun, to its kill; 0: killed
        at once.
    """

    def __init__(self, module: str, *, quiet: bool = False, grace: float = 0.0) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", module],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL if quiet else None,
        )
        self.answered = False
        """True if it has answered a request."""
        self._grace = grace
        self._killed_at = math.inf

    @property
    def alive(self) -> bool:
        """True if the process is running."""
        return self._process.poll() is None

    def ask(self, request: Mapping[str, Any], seconds: float) -> dict[str, Any] | ProcessEnd:
        """The answer to a request, or the end of the process.

        Parameters
        ----------
        request
            A message of JSON.
        seconds
            Maximum time for an answer in seconds; the process is ended after it.

        Returns
        -------
        dict or ProcessEnd
            The message of the process, or its end.
        """
        source, target = self._process.stdout, self._process.stdin
        assert source is not None and target is not None
        late = threading.Event()

        def end() -> None:
            late.set()
            self._stop()

        timer = threading.Timer(seconds, end)
        timer.daemon = True
        timer.start()
        asked = False
        try:
            with broken_pipes_raise():
                _write(target, request)
            asked = True
            answer = _read(source)
            if answer is not None and _ENDED in answer:
                return ProcessEnd(answer[_ENDED], False, asked)
            if answer is not None:
                self.answered = True
                return answer
        except (BrokenPipeError, ValueError):
            pass
        except BaseException:
            self._process.kill()
            raise
        finally:
            timer.cancel()
        self.end()
        return ProcessEnd(self._process.returncode, late.is_set(), asked)

    def terminate(self) -> None:
        """Let the process finish its work; :meth:`end` waits for that."""
        if self._grace > 0 and math.isinf(self._killed_at):
            self._killed_at = time.monotonic() + self._grace
            self._process.terminate()

    def _stop(self) -> None:
        self.terminate()
        if self._grace > 0:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(max(self._killed_at - time.monotonic(), 0.0))
        self._process.kill()
        self._process.wait()

    def end(self) -> None:
        """Ends the process and closes its pipes; if it is already ending, its status is kept."""
        self._stop()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with broken_pipes_raise(), contextlib.suppress(OSError):
                    pipe.close()


def send_end(status: int) -> None:
    """Report to the parent that the forked copy of this process has ended without an answer.

    Parameters
    ----------
    status
        Its return code; below zero the number of a signal.
    """
    body = json.dumps({_ENDED: status}).encode()
    os.write(1, _HEAD.pack(len(body)) + body)


def serve(answer: Callable[[dict[str, Any]], dict[str, Any]], idle: float) -> None:
    """Answer requests of the parent process until it closes the connection.

    Parameters
    ----------
    answer
        Makes the answer of a request.
    idle
        Seconds without a request after which the process ends.
    """
    answers = os.dup(1)
    os.dup2(2, 1)
    # Ctrl-C is for the process that asks.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with os.fdopen(answers, "wb") as target:
        while True:
            timer = threading.Timer(idle, os._exit, (0,))
            timer.daemon = True
            timer.start()
            request = _read(sys.stdin.buffer)
            timer.cancel()
            if request is None:
                # Destructors of libraries are not waited for.
                os._exit(0)
            _write(target, answer(request))


def bounded(memory: int, seconds: float = math.inf) -> None:
    """Limits the resources of this process, if the system supports it.

    Parameters
    ----------
    memory
        Bytes of address space.
    seconds
        Processor time; the system ends the process after it.
    """
    try:
        import resource
    except ImportError:
        return
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    held = memory if most == resource.RLIM_INFINITY else min(memory, most)
    resource.setrlimit(resource.RLIMIT_AS, (held, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if math.isfinite(seconds):
        until = math.ceil(time.process_time() + seconds)
        resource.setrlimit(resource.RLIMIT_CPU, (until, resource.getrlimit(resource.RLIMIT_CPU)[1]))


def _write(target: BinaryIO | Any, message: Mapping[str, Any]) -> None:
    body = json.dumps(message).encode()
    target.write(_HEAD.pack(len(body)) + body)
    target.flush()


def _read(source: BinaryIO | Any) -> dict[str, Any] | None:
    """The next message; None at the end of output, even within a message."""
    head = source.read(_HEAD.size)
    if len(head) < _HEAD.size:
        return None
    (length,) = _HEAD.unpack(head)
    body = source.read(length)
    if len(body) < length:
        return None
    found: dict[str, Any] = json.loads(body)
    return found
