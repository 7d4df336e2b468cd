"""Processes that evaluate cases, bounded in time and memory, each restarted on its own.

An executor runs :func:`evaluate_apart` in its threads, processes or machines; each call uses a
process of :mod:`moldloft.study.worker` beside it, so that a case that ends its process costs that
case only.
"""

from __future__ import annotations

import atexit
import os
import shutil
import socket
import tempfile
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from moldloft import _core
from moldloft.child_process import ChildProcess, ProcessEnd

__all__ = [
    "CRASHED",
    "OTHER_VERSION",
    "TIMED_OUT",
    "end_workers",
    "evaluate_apart",
    "evaluate_each",
    "install",
]

TIMED_OUT = "timed out"
CRASHED = "crashed"

OTHER_VERSION = "other-version"
"""The id of the answer of a machine with another version of the package: its numbers may differ."""

#: Time that a worker may take to begin: import of the package.
STARTUP_SECONDS = 60.0

#: Time that a worker has for ending the program that it runs.
GRACE_SECONDS = 2.0


def _case(end: ProcessEnd, seconds: float) -> dict[str, Any]:
    """The answer for a case over which its process ended."""
    late = {
        "state": TIMED_OUT,
        "id": "timed-out",
        "message": f"the case took longer than {seconds:g} s",
        "seconds": seconds,
    }
    crashed = {
        "state": CRASHED,
        "id": "crashed",
        "message": f"the process of the case ended ({end.by})",
        "seconds": 0.0,
    }
    return late if end.late else crashed


#: Models whose files were sent here, by digest: paths of the model and of its folder.
_installed: dict[str, dict[str, str]] = {}


def install(digest: str, files: Mapping[str, bytes], model: str) -> None:
    """Write the files of a model for cases on this machine.

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


_idle: list[ChildProcess] = []
_busy: set[ChildProcess] = set()
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
        As for that function; ``state`` may also be ``"timed out"`` or ``"crashed"``.
    """
    global _owner
    if request["version"] != _core.__version__:
        return {
            "state": CRASHED,
            "id": OTHER_VERSION,
            "message": f"a worker ({socket.gethostname()}) has Moldloft {_core.__version__}, the "
            f"study {request['version']}; install the same version on all machines",
        }
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
            worker.end()
            continue
        worker = worker or ChildProcess("moldloft.study.worker", grace=GRACE_SECONDS)
        with _guard:
            _busy.add(worker)
        seconds, old = float(request["seconds"]), worker.answered
        answer: dict[str, Any] | ProcessEnd | None = None
        try:
            # A new process first says that it has begun: the time of a case is its own.
            begun = None if old else worker.ask({"begin": True}, STARTUP_SECONDS)
            answer = begun if isinstance(begun, ProcessEnd) else worker.ask(request, seconds)
        finally:
            with _guard:
                _busy.discard(worker)
                # A process that has replaced the one which ended answers the next request.
                if answer is not None and worker.alive:
                    _idle.append(worker)
                else:
                    worker.end()
        if isinstance(answer, dict):
            return answer
        # A process without requests for a while may have ended just then.
        if answer.late or not old or (answer.asked and answer.status != 0):
            return _case(answer, seconds)


def evaluate_each(requests: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The answers to requests, one after the other; see :func:`evaluate_apart`."""
    return [evaluate_apart(request) for request in requests]


def end_workers() -> None:
    """Ends all worker processes of this process, busy ones too."""
    with _guard:
        if _owner == os.getpid():
            for worker in (*_idle, *_busy):
                worker.terminate()
            for worker in (*_idle, *_busy):
                worker.end()
        _idle.clear()


atexit.register(end_workers)
