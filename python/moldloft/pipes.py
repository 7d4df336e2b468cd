"""Writing to processes that may have ended."""

from __future__ import annotations

import contextlib
import signal
import sys
from collections.abc import Iterator

__all__ = ["broken_pipes_raise"]


@contextlib.contextmanager
def broken_pipes_raise() -> Iterator[None]:
    """Context in which a write to a process that has ended raises an exception.

    Python ignores the signal of a broken pipe, but libraries such as Gmsh let it end the process.
    """
    if sys.platform == "win32":
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGPIPE})
    try:
        yield
    finally:
        if signal.SIGPIPE not in before:
            # One that came is taken before it could be heard.
            if signal.SIGPIPE in signal.sigpending():
                signal.sigwait({signal.SIGPIPE})
            signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGPIPE})
