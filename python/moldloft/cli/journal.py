"""The journal of a sketch prompt: a killed process loses nothing, every change is on disk at once.

A journal is a text file of commands, one a line, after a first line that says what it is. A line
counts once its line break is there: one cut short by a crash is left out. The living process holds
a lock on its journal, so an unlocked one belongs to a process that ended without closing it.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO

__all__ = ["Journal", "Left", "beside", "left_behind", "state_folder"]

HEAD = "! moldloft sketch journal 1"
ENDING = ".skj"
LAST = "last" + ENDING


def state_folder() -> Path:
    """Where journals of prompts without a file are: ``$XDG_STATE_HOME/moldloft/sketch``."""
    given = os.environ.get("XDG_STATE_HOME") or os.environ.get("LOCALAPPDATA")
    return Path(given or Path.home() / ".local" / "state") / "moldloft" / "sketch"


def beside(path: Path) -> Path:
    """The journal of a prompt that edits a file."""
    return path.with_name(path.name + ENDING)


@dataclass(frozen=True)
class Left:
    """A journal that was not closed, and its commands."""

    path: Path
    commands: list[str]

    @property
    def when(self) -> str:
        """When it was last written."""
        return time.strftime("%Y-%m-%d %H:%M", time.localtime(self.path.stat().st_mtime))


def _lock(file: IO[str]) -> bool:
    """Takes the lock on a file; false when another process has it."""
    try:
        import fcntl
    except ImportError:
        import msvcrt

        try:
            file.seek(1 << 30)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
        except OSError:
            return False
        finally:
            file.seek(0, os.SEEK_END)
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def read(path: Path) -> list[str] | None:
    """The complete commands of a journal; ``None`` when it is none."""
    try:
        text = path.read_bytes().decode("utf-8", errors="replace")
    except OSError:
        return None
    lines = text.split("\n")
    # What follows the last line break was cut short.
    return lines[1:-1] if lines[0].startswith(HEAD) and len(lines) > 1 else None


def left_behind(paths: Sequence[Path]) -> list[Left]:
    """Journals with commands that no living process holds, the newest first."""
    found: list[tuple[float, Left]] = []
    for path in paths:
        try:
            with path.open("r+", encoding="utf-8") as file:
                if not _lock(file):
                    continue
            stamp = path.stat().st_mtime
        except OSError:
            continue
        commands = read(path)
        if commands:
            found.append((stamp, Left(path, commands)))
    return [left for _, left in sorted(found, key=lambda pair: pair[0], reverse=True)]


class Journal:
    """A journal under way.

    Parameters
    ----------
    path
        The file; made anew.
    begin
        Commands that stand in it from the start.
    """

    def __init__(self, path: Path, begin: Sequence[str] = ()) -> None:
        self.path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = path.open("w", encoding="utf-8", newline="\n")
        _lock(self._file)
        self._write([HEAD, *begin])

    @classmethod
    def in_state_folder(cls, begin: Sequence[str] = ()) -> Journal:
        """A journal of its own name in the state folder."""
        stamp = time.strftime("%Y%m%d-%H%M%S")
        return cls(state_folder() / f"{stamp}-{os.getpid()}{ENDING}", begin)

    def append(self, commands: Sequence[str]) -> None:
        """Adds commands; they are on the disk when this returns."""
        if commands:
            self._write(commands)

    def restart(self) -> None:
        """Empties it: what it held is in the file that it stands beside."""
        self._file.seek(0)
        self._file.truncate()
        self._write([HEAD])

    def _write(self, lines: Sequence[str]) -> None:
        # One write, so that a process killed at any moment leaves whole lines and perhaps a part.
        self._file.write("".join(line.replace("\n", " ") + "\n" for line in lines))
        self._file.flush()
        os.fsync(self._file.fileno())

    def close(self, *, keep: bool) -> None:
        """Ends it: kept as the last session in the state folder, or removed."""
        self._file.close()
        with contextlib.suppress(OSError):
            if keep:
                last = state_folder() / LAST
                last.parent.mkdir(parents=True, exist_ok=True)
                self.path.replace(last)
            else:
                self.path.unlink()
