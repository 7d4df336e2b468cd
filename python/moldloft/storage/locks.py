"""Locks: a file beside the locked one that identifies the owner."""

from __future__ import annotations

import contextlib
import getpass
import json
import os
import random
import socket
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from moldloft.errors import FileError
from moldloft.storage import system

__all__ = ["LOCK", "BusyError", "Lock", "Owner", "folder_lock"]

LOCK = ".moldloft.lock"
"""The name of the lock of a folder, held while files are compared or replaced together."""

_FLAGS = os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0)


@dataclass(frozen=True)
class Owner:
    """Owner of a lock, for messages only.

    Process numbers are reused, so no decision depends on them.
    """

    pid: int
    host: str
    user: str
    program: str
    since: str

    @classmethod
    def here(cls) -> Owner:
        """The process that asks."""
        user = ""
        # Containers run under numbers without names.
        with contextlib.suppress(KeyError, OSError, ImportError):
            user = getpass.getuser()
        program = " ".join([Path(sys.argv[0] or "python").name, *sys.argv[1:2]])
        stamp = time.strftime("%Y-%m-%d %H:%M:%S")
        return cls(os.getpid(), socket.gethostname(), user, program, stamp)

    def __str__(self) -> str:
        user = f" of {self.user}" if self.user else ""
        return f"process {self.pid} ({self.program}){user} on {self.host}, since {self.since}"


class BusyError(FileError):
    """Another process has the file.

    Attributes
    ----------
    owner : Owner or None
        The owner; ``None`` if the lock does not identify it.
    """

    owner: Owner | None

    def __init__(self, message: str, owner: Owner | None = None) -> None:
        super().__init__(message)
        self.owner = owner


class Lock:
    """A lock that is held until it is released or its process ends.

    Parameters
    ----------
    path
        The lock's own file. It is not the file that is protected: replacing that would leave the
        lock on a file without a name.
    what
        Protected object, for messages.
    wait
        Seconds to wait for it.

    Raises
    ------
    BusyError
        If somebody has it for longer than that.
    OSError
        If the lock's file cannot be made.
    """

    def __init__(self, path: Path, what: str, *, wait: float = 0.0) -> None:
        self.path = path
        end = time.monotonic() + wait
        while True:
            file = self._open()
            held = False
            try:
                held = system.lock(file)
                # Its holder removes the file with the lock: who waited for that one starts again.
                current = held and self._is_current(file)
            except BaseException:
                if held:
                    self._file = file
                    self.release()
                else:
                    system.close(file)
                raise
            if current:
                break
            owner = None if held else _owner(file)
            with contextlib.suppress(OSError):
                system.close(file)
            if not held and time.monotonic() >= end:
                by = f" by {owner}" if owner else " by another process"
                raise BusyError(f"`{what}` is in use{by}", owner)
            if not held:
                time.sleep(random.uniform(0.001, 0.01))
        self._file = file
        with contextlib.suppress(OSError):
            os.ftruncate(file, 0)
            os.lseek(file, 0, os.SEEK_SET)
            system.write_all(file, json.dumps(vars(Owner.here())).encode())

    def _open(self) -> int:
        try:
            return os.open(self.path, os.O_RDWR | _FLAGS, 0o666)
        except PermissionError as denied:
            # That of another user, whose folder this is, too.
            try:
                return os.open(self.path, os.O_RDONLY | (_FLAGS & ~os.O_CREAT))
            except FileNotFoundError:
                raise denied from None

    def _is_current(self, file: int) -> bool:
        if os.name == "nt":
            return True
        try:
            return os.path.samestat(os.fstat(file), self.path.stat(follow_symlinks=False))
        except FileNotFoundError:
            return False

    def release(self) -> None:
        """Release the lock; may be called twice."""
        file, self._file = self._file, -1
        if file < 0:
            return
        if os.name != "nt":
            # A second time for a system that refused once: others would see the file.
            for _ in range(2):
                with contextlib.suppress(OSError):
                    if self._is_current(file):
                        system.remove(self.path)
                    break
        system.unlock(file)
        with contextlib.suppress(OSError):
            system.close(file)

    def __enter__(self) -> Lock:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.release()


def folder_lock(folder: Path, wait: float = 60.0) -> Lock:
    """The lock of a folder; it is held only briefly."""
    return Lock(folder / LOCK, str(folder), wait=wait)


def _owner(file: int) -> Owner | None:
    with contextlib.suppress(OSError, ValueError, TypeError):
        os.lseek(file, 0, os.SEEK_SET)
        return Owner(**json.loads(os.read(file, 4096)))
    return None
