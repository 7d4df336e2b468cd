"""The process that evaluates cases: ``python -m moldloft.study.worker``.

On Linux it only supervises: a copy of it (`fork`) answers, and a case that ends the copy costs a
new copy, not a start of Python with all imports. Elsewhere the process answers itself.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import warnings
from typing import Any, NoReturn

from moldloft.budget import limits
from moldloft.child_process import bounded, send_end, serve
from moldloft.study.cases import evaluate

#: After this time without a request the process ends, in seconds.
IDLE_SECONDS = 60.0

#: Time between two looks at the process that asks, in seconds.
LOOK_SECONDS = 0.25

#: Of `prctl`: the signal that a process is sent when its parent ends.
PR_SET_PDEATHSIG = 1


def _evaluated(request: dict[str, Any]) -> dict[str, Any]:
    if request.get("begin"):
        return {"state": "begun"}
    # Beside models there are libraries and what analyses hold.
    bounded(2 * limits(memory=request["memory"]).memory + (1 << 30))
    return evaluate(request)


def _stopped(*_: object) -> NoReturn:
    """A program that runs for the case is ended on the way out."""
    raise SystemExit(1)


def _supervised() -> None:
    """Returns in a copy of this process that is to answer; this one replaces copies that end."""
    asker = os.getppid()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    watched = {signal.SIGCHLD, signal.SIGTERM}
    signal.pthread_sigmask(signal.SIG_BLOCK, watched)
    # The library of linear algebra has threads, and prepares for copies itself.
    warnings.simplefilter("ignore", DeprecationWarning)
    supervisor = os.getpid()
    while True:
        copy = os.fork()
        if copy == 0:
            ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
            if os.getppid() != supervisor:
                os._exit(1)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, watched)
            return
        status = _end_of(copy, asker)
        if status is None:
            os._exit(1)
        if status == 0:
            # There has been no request for a while, or there will be none.
            os._exit(0)
        send_end(status)


def _end_of(copy: int, asker: int) -> int | None:
    """The status with which a copy ended by itself; None if it was to end."""
    stopped = False
    while True:
        found = signal.sigtimedwait({signal.SIGCHLD, signal.SIGTERM}, LOOK_SECONDS)
        asked = found is not None and found.si_signo == signal.SIGTERM
        if (asked or os.getppid() != asker) and not stopped:
            stopped = True
            os.kill(copy, signal.SIGTERM)
        ended, status = os.waitpid(copy, os.WNOHANG)
        if ended:
            return None if stopped else os.waitstatus_to_exitcode(status)


if __name__ == "__main__":
    try:
        if sys.platform == "linux":
            _supervised()
        signal.signal(signal.SIGTERM, _stopped)
        serve(_evaluated, IDLE_SECONDS)
    except (SystemExit, BrokenPipeError):
        # The study was killed, or destructors of libraries are not waited for.
        os._exit(1)
