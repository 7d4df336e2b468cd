"""Detection of changed files by their content."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable
from pathlib import Path

from moldloft.errors import FileError
from moldloft.storage.reading import digest_of

__all__ = ["Watch"]

#: Larger files are read again only when the system says that they were written.
_READ_ALWAYS = 4 << 20

#: Editors remove a file for a moment while they save it.
_GONE_SECONDS = 1.0

#: The system's clock of files may be this much behind.
_CLOCK_NS = 20_000_000


class Watch:
    """Files read by some work; no change is missed, not even during the work.

    Parameters
    ----------
    paths
        Known files before the first work.
    """

    def __init__(self, paths: Iterable[str]) -> None:
        self._known: dict[str, str] = dict.fromkeys(paths, "")
        self._stamps: dict[str, tuple[tuple[int, ...], str]] = {}
        self._gone: dict[str, float] = {}
        self._began = 0
        self._late = False

    def begin(self) -> None:
        """Start of the work: files are compared with their state from now on."""
        self._began = time.time_ns()
        self._late = False
        self._known = {path: self._content(path) for path in self._known}

    def end(self, paths: Iterable[str]) -> None:
        """End of the work, with the files that it read."""
        before, self._known = self._known, {}
        for path in paths:
            self._known[path] = before.get(path) or self._content(path)
            if path not in before:
                # Nobody knows what was in it when it was read, but when it was written last.
                self._late |= self._written(path) >= self._began - _CLOCK_NS

    def changed(self) -> bool:
        """True if one of the files has changed since the work began."""
        found = False
        for path, before in self._known.items():
            now = self._content(path)
            if now == before:
                self._gone.pop(path, None)
            elif now or time.monotonic() > self._gone.setdefault(path, time.monotonic()) + (
                _GONE_SECONDS
            ):
                found = True
        return found or self._late

    def _written(self, path: str) -> int:
        try:
            status = Path(path).stat()
        except OSError:
            return 0
        return max(status.st_mtime_ns, status.st_ctime_ns)

    def _content(self, path: str) -> str:
        """The digest of a file; empty if it does not exist."""
        try:
            status = Path(path).stat()
            stamp = (status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns)
            old = self._stamps.get(path)
            if old is not None and old[0] == stamp and status.st_size > _READ_ALWAYS:
                return old[1]
            content = digest_of(os.fspath(path)) or ""
            self._stamps[path] = (stamp, content)
            return content
        except FileError as error:
            return str(error)
        except OSError:
            return ""
