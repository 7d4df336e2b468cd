"""The journal of a sketch prompt, which stores every change on disk at once.

A journal is a text file of commands, one per line, after a header line. Each line begins with a
checksum over the journal's own number, the line's number and the command: zeros, partial lines and
lines of another journal, which a power cut may leave, are therefore rejected. A line ``! file
DIGEST`` states that the commands before it are in the file beside the journal, if that has this
content. A lock beside the journal identifies its owner; without a lock it is abandoned.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import time
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from moldloft.errors import FileError
from moldloft.storage import system
from moldloft.storage.folders import make_folders
from moldloft.storage.locks import BusyError, Lock
from moldloft.storage.reading import read_bytes
from moldloft.storage.replacing import put

__all__ = ["ENDING", "Journal", "Left", "beside", "ended", "left_behind", "lock", "state_folder"]

HEAD = "! moldloft sketch journal"
ENDING = ".skj"

#: How names of journals begin whose sessions were ended without a save; and how many are kept.
_ENDED = "ended-"
_KEPT = 20

_IN_FILE = "! file "


def state_folder() -> Path:
    """Folder of journals of prompts without a file: ``$XDG_STATE_HOME/moldloft/sketch``."""
    given = os.environ.get("XDG_STATE_HOME") or os.environ.get("LOCALAPPDATA")
    return Path(given or Path.home() / ".local" / "state") / "moldloft" / "sketch"


def ended(journal: Path) -> bool:
    """True if its session ended without saving, according to its name."""
    return journal.name.startswith(_ENDED)


def beside(path: Path) -> Path:
    """The journal of a prompt that edits a file."""
    return path.with_name(path.name + ENDING)


def lock(journal: Path) -> Lock:
    """The lock of a journal.

    Raises
    ------
    BusyError
        If somebody does.
    """
    return Lock(journal.with_name(f".{journal.name}.lock"), journal.name)


@dataclass(frozen=True)
class Left:
    """A journal that was not closed, and its commands."""

    path: Path
    commands: list[str]
    stale: bool = False
    """True if another program has changed its file since."""
    damaged: int = 0
    """Complete lines that are not readable."""
    when: str = field(default="")
    """Time of the last write."""


def _checked(seed: str, number: int, command: str) -> str:
    sum_ = zlib.crc32(f"{seed} {number} {command}".encode("utf-8", "surrogatepass"))
    return f"{sum_:08x} {command}"


def read(path: Path, present: str | None = None) -> Left | None:
    """The complete commands of a journal; ``None`` if the file is not a journal.

    Parameters
    ----------
    path
        The journal.
    present
        Digest of the file that it belongs to: commands already in that file are omitted.

    Raises
    ------
    FileError
        If a later version wrote it.
    """
    try:
        text = read_bytes(path).decode("utf-8", errors="replace")
        when = time.strftime("%Y-%m-%d %H:%M", time.localtime(path.stat().st_mtime))
    except OSError:
        return None
    # The text after the last line break was cut short.
    head, *lines = text.split("\n")[:-1] or [""]
    if not head.startswith(HEAD):
        return None
    version, _, seed = head.removeprefix(HEAD).strip().partition(" ")
    if version == "1":
        return Left(path, lines, when=when)
    if version != "2":
        raise FileError(f"`{path}` is a journal of a later version of moldloft: {version}")
    commands: list[str] = []
    names_files, found, good = False, False, 0
    for number, line in enumerate(lines):
        command = line[9:]
        if line != _checked(seed, number, command):
            break
        good += 1
        if not command.startswith(_IN_FILE):
            commands.append(command)
        elif present is not None and command == _IN_FILE + present:
            # The file holds what came before.
            commands, found = [], True
        else:
            # Another content: that before a save, or one that was not written any more.
            names_files = True
    stale = present is not None and names_files and not found
    return Left(path, commands, stale, len(lines) - good, when)


def left_behind(
    paths: Sequence[Path], present: str | None = None, held: Lock | None = None
) -> list[Left]:
    """Journals with commands but without a running owner, the newest first.

    ``present`` is as for :func:`read`; ``held`` is the lock on the only journal, if it is held.
    """
    found: list[tuple[float, Left]] = []
    for path in paths:
        try:
            with contextlib.nullcontext() if held else lock(path):
                left = read(path, present)
            stamp = path.stat().st_mtime
        except BusyError:
            continue
        except FileError:
            raise
        except OSError:
            continue
        if left is not None and left.commands:
            found.append((stamp, left))
    return [left for _, left in sorted(found, key=lambda pair: pair[0], reverse=True)]


def _age(path: Path) -> float:
    with contextlib.suppress(OSError):
        return path.stat().st_mtime
    return 0.0


class Journal:
    """An open journal.

    Parameters
    ----------
    path
        The file; replaced if it exists.
    begin
        Commands that are in it from the start.
    base
        Digest of the file that it belongs to.
    held
        Its lock, when that is held already; it is taken otherwise.

    Raises
    ------
    BusyError
        If somebody else keeps it.
    """

    def __init__(
        self,
        path: Path,
        begin: Sequence[str] = (),
        *,
        base: str | None = None,
        held: Lock | None = None,
    ) -> None:
        self.path = path
        self._base = base
        make_folders(path.parent)
        self._lock = held or lock(path)
        self._file = -1
        self._begin([*([] if base is None else [_IN_FILE + base]), *begin])

    @classmethod
    def in_state_folder(cls, begin: Sequence[str] = ()) -> Journal:
        """A journal with a unique name in the state folder."""
        stamp = time.strftime("%Y%m%d-%H%M%S")
        name = f"{stamp}-{os.getpid()}-{secrets.token_hex(2)}{ENDING}"
        return cls(state_folder() / name, begin)

    def _begin(self, commands: Sequence[str]) -> None:
        self._seed = secrets.token_hex(8)
        self._count = 0
        head = f"{HEAD} 2 {self._seed}\n"
        # In place of the old one at once: a kill leaves one of the two.
        data = (head + self._lines(commands)).encode()
        put(self.path, data, private=True)
        self._length = len(data)
        old, self._file = self._file, -1
        if old >= 0:
            with contextlib.suppress(OSError):
                system.close(old)
        self._open()

    def _open(self) -> None:
        flags = os.O_WRONLY | os.O_APPEND | getattr(os, "O_CLOEXEC", 0)
        self._file = os.open(self.path, flags | getattr(os, "O_BINARY", 0))

    def _lines(self, commands: Sequence[str]) -> str:
        made = []
        for command in commands:
            # As it will be read back.
            plain = command.replace("\n", " ").encode("utf-8", "replace").decode()
            made.append(_checked(self._seed, self._count, plain) + "\n")
            self._count += 1
        return "".join(made)

    def append(self, commands: Sequence[str]) -> None:
        """Adds commands; they are on the disk when this returns."""
        if commands:
            # One write: a process killed at any moment leaves whole lines and perhaps a part.
            if self._file < 0:
                self._open()
            count, data = self._count, self._lines(commands).encode()
            try:
                # The remainder of a failed write would corrupt the next line.
                os.ftruncate(self._file, self._length)
                system.write_all(self._file, data)
                system.synced(self._file)
            except BaseException:
                self._count = count
                raise
            self._length += len(data)

    @property
    def beside_file(self) -> bool:
        """True if it is in the folder of the edited file, not in the state folder."""
        return self._base is not None

    def saving(self, digest: str) -> None:
        """Record that the file is about to be written with all commands so far."""
        self.append([_IN_FILE + digest])

    def saved(self, digest: str) -> None:
        """Restart the journal: the file is complete."""
        self._begin([_IN_FILE + digest])

    def close(self, *, keep: bool) -> None:
        """Ends it: kept, or removed.

        The journal of a file stays beside it if its commands begin with those of the file; others
        stay in the state folder, the last twenty of them.
        """
        if self._file >= 0:
            with contextlib.suppress(OSError):
                system.close(self._file)
        with contextlib.suppress(OSError):
            if not keep:
                system.remove(self.path)
            elif self._base is None:
                # Under a name of its own: another prompt may end at the same moment.
                system.replace(self.path, self.path.with_name(_ENDED + self.path.name))
                kept = sorted(self.path.parent.glob(f"{_ENDED}*{ENDING}"), key=_age)
                for old in kept[:-_KEPT]:
                    system.remove(old)
        self._lock.release()
