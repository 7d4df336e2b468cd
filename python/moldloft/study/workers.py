"""Processes that evaluate cases: bounded in time and memory, ended and begun again alone.

An executor runs :func:`evaluate_apart` in its threads, processes or machines; each call uses a
process of :mod:`moldloft.study.worker` beside it, so that a case that ends its process costs that
case only.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

from moldloft.pipes import broken_pipes_raise

__all__ = ["CRASHED", "TIMED_OUT", "end_workers", "evaluate_apart", "frame", "install"]

TIMED_OUT = "timed out"
CRASHED = "crashed"

#: Time that a worker may take to begin: import of the package, reading of the model.
STARTUP_SECONDS = 60.0


class CaseWorker:
    """A process that evaluates cases one after the other."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "moldloft.study.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        self._used = False

    def ask(self, request: Mapping[str, Any]) -> dict[str, Any] | None:
        """The answer; a failure when the process ended; None when it had ended before."""
        process, seconds = self._process, float(request["seconds"])
        assert process.stdin is not None and process.stdout is not None
        late = threading.Event()

        def end() -> None:
            late.set()
            process.kill()

        # The first case also waits for the start.
        timer = threading.Timer(seconds + (0 if self._used else STARTUP_SECONDS), end)
        timer.daemon = True
        timer.start()
        sent = False
        try:
            message = json.dumps(request).encode()
            with broken_pipes_raise():
                process.stdin.write(struct.pack("<Q", len(message)) + message)
                process.stdin.flush()
            sent = True
            body = frame(process.stdout)
            if body is not None:
                self._used = True
                found: dict[str, Any] = json.loads(body)
                return found
        except (BrokenPipeError, ValueError):
            pass
        finally:
            timer.cancel()
        process.kill()
        process.wait()
        if late.is_set():
            return {
                "state": TIMED_OUT,
                "id": "timed-out",
                "message": f"the case took longer than {seconds:g} s",
                "seconds": seconds,
            }
        if self._used and (not sent or process.returncode == 0):
            return None
        number = -process.returncode
        how = (
            signal.Signals(number).name
            if number in {*signal.Signals}
            else f"status {process.returncode}"
        )
        return {
            "state": CRASHED,
            "id": "crashed",
            "message": f"the process of the case ended ({how})",
            "seconds": 0.0,
        }

    @property
    def alive(self) -> bool:
        """Whether the process lives."""
        return self._process.poll() is None

    def kill(self) -> None:
        """Ends the process."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with broken_pipes_raise(), contextlib.suppress(OSError):
                    pipe.close()


#: Models whose files were sent here, by digest: paths of the model and of its folder.
_installed: dict[str, dict[str, str]] = {}


def install(digest: str, files: Mapping[str, bytes], model: str) -> None:
    """Write the files of a model that cases here are to use.

    Parameters
    ----------
    digest
        The digest of the files, as requests state it.
    files
        Contents by relative path.
    model
        The relative path of the model.
    """
    if digest in _installed:
        return
    root = Path(tempfile.mkdtemp(prefix="moldloft-model-"))
    atexit.register(shutil.rmtree, root, ignore_errors=True)
    for name, data in files.items():
        place = root / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(data)
    _installed[digest] = {"model": str(root / model), "root": str(root)}


_idle: list[CaseWorker] = []
_busy: set[CaseWorker] = set()
_guard = threading.Lock()
_owner = os.getpid()


def evaluate_apart(request: Mapping[str, Any]) -> dict[str, Any]:
    """The answer of a worker process to a request.

    Parameters
    ----------
    request
        As for :func:`moldloft.study.cases.evaluate`, with ``seconds`` and ``memory``.

    Returns
    -------
    dict
        As there; ``state`` may also be ``"timed out"`` or ``"crashed"``.
    """
    global _owner
    if request["digest"] in _installed:
        request = {**request, **_installed[request["digest"]]}
    while True:
        with _guard:
            if _owner != os.getpid():
                # After a fork the workers belong to the parent.
                _idle.clear()
                _busy.clear()
                _owner = os.getpid()
            worker = _idle.pop() if _idle else None
        if worker is not None and not worker.alive:
            worker.kill()
            continue
        worker = worker or CaseWorker()
        with _guard:
            _busy.add(worker)
        answer = None
        try:
            answer = worker.ask(request)
        finally:
            with _guard:
                _busy.discard(worker)
                if worker.alive and answer is not None:
                    _idle.append(worker)
                else:
                    worker.kill()
        if answer is not None:
            return answer


def end_workers() -> None:
    """Ends all worker processes of this process, busy ones too."""
    with _guard:
        if _owner == os.getpid():
            for worker in (*_idle, *_busy):
                worker.kill()
        _idle.clear()


atexit.register(end_workers)


def frame(source: BinaryIO | Any) -> bytes | None:
    """The next message of a pipe; None at its end."""
    head = source.read(8)
    if len(head) < 8:
        return None
    (length,) = struct.unpack("<Q", head)
    body: bytes = source.read(length)
    return body if len(body) == length else None
