"""Limits of a run: memory, steps, objects, seconds."""

from __future__ import annotations

import ctypes
import inspect
import math
import os
import re
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any, NamedTuple, TypeVar, cast

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import FileError, ModelError

__all__ = ["Limits", "limited", "limits", "parsed", "within_limits"]

F = TypeVar("F", bound=Callable[..., Any])

_UNITS = {"": 1, "k": 1 << 10, "m": 1 << 20, "g": 1 << 30, "t": 1 << 40}

#: Minimum without which nothing runs.
_LEAST_MEMORY = 16 << 20
_MOST_COUNT = (1 << 63) - 1


class Limits(NamedTuple):
    """Limits of a run, beyond which it ends with an error.

    Attributes
    ----------
    memory
        Bytes of all models of the process.
    steps
        Statements and calls of one run.
    objects
        Objects of one model.
    seconds
        Time of one run, one mesh, one measure; ``inf`` by default: work on one set has
        10 s of processor time then, and CAD files have theirs.
    """

    memory: int
    steps: int
    objects: int
    seconds: float


def limits(
    *,
    memory: int | str | None = None,
    steps: float | None = None,
    objects: float | None = None,
    seconds: float | None = None,
) -> Limits:
    """The limits of all runs of this process; given arguments are set.

    Parameters
    ----------
    memory
        Bytes, or a text such as ``"2G"`` or ``"500M"``; at least 16 MiB.
    steps, objects
        Whole numbers of at least 1; ``1e9`` is one.
    seconds
        Above 0; ``math.inf`` for no limit.

    Returns
    -------
    Limits
        All four, as they are now.

    Raises
    ------
    ModelError
        If a value is not a valid limit.

    Examples
    --------
    >>> import moldloft
    >>> before = moldloft.limits()
    >>> moldloft.limits(memory="2G", seconds=10).memory
    2147483648
    >>> moldloft.limits(steps=1e9).steps
    1000000000
    >>> moldloft.limits(steps=0)
    Traceback (most recent call last):
      ...
    moldloft.errors.ModelError: `steps` is a whole number of at least 1, found 0
    >>> moldloft.limits(**before._asdict()) == before
    True
    """
    old = Limits(*_core.limits())
    new = Limits(
        old.memory if memory is None else _bytes(memory),
        old.steps if steps is None else _count("steps", steps),
        old.objects if objects is None else _count("objects", objects),
        old.seconds if seconds is None else _seconds(seconds),
    )
    if new != old:
        _core.set_limits(*new)
    return new


def parsed(text: str) -> dict[str, str | int | float]:
    """The arguments of :func:`limits` from texts ``NAME=VALUE``.

    >>> parsed("memory=500M")
    {'memory': '500M'}
    """
    name, equals, value = text.partition("=")
    if not equals or name not in Limits._fields:
        raise ModelError(
            f"`{text}` is not NAME=VALUE with one of the names {', '.join(Limits._fields)}"
        )
    if name == "memory":
        _bytes(value)
        return {name: value}
    try:
        number = float(value)
    except ValueError:
        raise ModelError(f"`{name}` is a number, found `{value}`") from None
    if name == "seconds":
        return {name: _seconds(number)}
    return {name: _count(name, number)}


@contextmanager
def within_limits(subject: str = "") -> Iterator[None]:
    """Apply the limits of time and memory to Python code, such as readers of foreign files.

    The call ends as by Ctrl-C, including its calls of other libraries, except inside compiled code.
    Memory is the growth of the process, where the system reports it. Within such a call another
    one changes nothing.

    Parameters
    ----------
    subject
        The work, for the message.

    Raises
    ------
    FileError
        If the work inside takes more than is allowed.
    """
    if getattr(_watched, "by", None) is not None:
        yield
        return
    watch = _watched.by = _Watch(limits())
    watch.start()
    try:
        try:
            yield
        finally:
            watch.end()
    except _OverspentError:
        watch.end()
        raise FileError(f"{subject}: {watch.reason}" if subject else watch.reason) from None
    finally:
        _watched.by = None


def limited(read: F) -> F:
    """A reader of a file, its path first, that keeps the limits by :func:`within_limits`.

    Parameters
    ----------
    read
        The reader.
    """

    @wraps(read)
    def within(*arguments: Any, **options: Any) -> Any:
        path = arguments[0] if arguments else options.get("path")
        with within_limits(f"cannot read `{path}`"):
            return read(*arguments, **options)

    # A function with a `__wrapped__` has its arguments explained elsewhere.
    del within.__wrapped__
    within.__signature__ = inspect.signature(read)  # type: ignore[attr-defined]
    return cast(F, within)


_watched = threading.local()
"""The watch of each thread."""


class _OverspentError(BaseException):
    """Raised in the watched thread; readers do not mistake it for an error of their file."""


class _Watch(threading.Thread):
    """Watches the resources of the creating thread, and raises :class:`_OverspentError` in it."""

    _LOOK = 0.02
    """Seconds between two looks."""
    _AGAIN = 1.0
    """Seconds after which code that continues is interrupted again."""

    def __init__(self, allowed: Limits) -> None:
        super().__init__(daemon=True)
        self.reason = ""
        self._allowed = allowed
        self._whom = ctypes.c_ulong(threading.get_ident())
        self._began, self._before = time.monotonic(), _resident() - _core.held_memory()
        self._ended = threading.Event()
        self._lock = threading.Lock()

    def run(self) -> None:
        wait = self._LOOK
        while not self._ended.wait(wait):
            self.reason = self._spent()
            wait = self._AGAIN if self.reason else self._LOOK
            with self._lock:
                if self.reason and not self._ended.is_set():
                    self._raise(ctypes.py_object(_OverspentError))

    def end(self) -> None:
        """Stop the timer: nothing is raised after this call."""
        with self._lock:
            self._ended.set()
            self._raise(None)

    def _raise(self, error: ctypes.py_object[type[BaseException]] | None) -> None:
        ctypes.pythonapi.PyThreadState_SetAsyncExc(self._whom, error)

    def _spent(self) -> str:
        seconds, memory = self._allowed.seconds, self._allowed.memory
        if time.monotonic() - self._began > seconds:
            return (
                f"this takes longer than the {seconds:g} s that are allowed\n"
                "help: allow more: `--limit seconds=600`, `moldloft.limits(seconds=...)`"
            )
        needed = _resident() - self._before
        if needed > memory:
            return (
                f"this needs {needed / 2**30:.2f} GiB of memory, {memory / 2**30:.2f} are allowed\n"
                "help: allow more: `--limit memory=8G`, `moldloft.limits(memory=...)`"
            )
        return ""


def _resident() -> int:
    """Resident memory of the process in bytes; 0 if the system does not report it."""
    try:
        return int(_STATM.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, AttributeError):
        return 0


_STATM = Path("/proc/self/statm")


def _bytes(memory: int | str) -> int:
    found: float = -1
    if isinstance(memory, str):
        match = re.fullmatch(r"\s*(\d{1,18}(?:\.\d{1,9})?)\s*([kmgt]?)(?:i?b)?\s*", memory, re.I)
        if match:
            found = float(match[1]) * _UNITS[match[2].lower()]
    elif isinstance(memory, int) and not isinstance(memory, bool):
        found = memory
    if not _LEAST_MEMORY <= found <= _MOST_COUNT:
        raise ModelError(
            f'`memory` is a number of bytes of at least 16 MiB, such as "2G", found {memory!r}'
        )
    return int(found)


def _count(name: str, value: object) -> int:
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= _MOST_COUNT:
        raise ModelError(f"`{name}` is a whole number of at least 1, found {value!r}")
    return value


def _seconds(value: float) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ModelError(f"`seconds` is a number above 0, found {value!r}")
    # Whole numbers may be longer than any float.
    if isinstance(value, int) and value > 1 << 60:
        return math.inf
    if math.isnan(value) or value <= 0:
        raise ModelError(f"`seconds` is a number above 0, found {value!r}")
    return float(value)


explain(globals())
