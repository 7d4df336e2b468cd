"""The engine process of the workbench: a model runs here, within limits, and can be ended."""

from __future__ import annotations

import contextlib
import os
import sys
import threading
import time

from moldloft import _core

__all__ = ["main"]


#: What a process takes besides models: the program itself, stacks of its threads.
_OWN = 1 << 30

_LOOK_SECONDS = 0.5


def _limit(memory: int) -> None:
    """No more memory than that, no files written, no core left behind."""
    _, steps, objects, seconds = _core.limits()
    _core.set_limits(memory, steps, objects, seconds)
    try:
        import resource
    except ImportError:
        return
    limits = [("RLIMIT_AS", memory + _OWN), ("RLIMIT_CORE", 0), ("RLIMIT_FSIZE", 0)]
    for name, value in limits:
        with contextlib.suppress(AttributeError, OSError, ValueError):
            resource.setrlimit(getattr(resource, name), (value, value))


def _end_with_parent() -> None:
    """Work that is under way goes on after its input has ended, but not without a parent."""
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(_LOOK_SECONDS)
        os._exit(0)

    threading.Thread(target=watch, daemon=True).start()


def main() -> None:
    """Answers the parent until it goes: ``_engine MEMORY NAME FOLDER [LIBRARY ...]``."""
    memory, name, folder, *library = sys.argv[1:]
    _limit(int(memory))
    if os.name == "posix":
        _end_with_parent()
    _core.engine(name, folder or None, library)


if __name__ == "__main__":
    main()
