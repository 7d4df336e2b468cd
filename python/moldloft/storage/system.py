"""The operating system calls used for writing.

Nothing else in the package creates, replaces or removes files: tests make the n-th of these calls
fail, for every n, and look at what is left.
"""
# Each function is one call of the system, on paths and descriptors alike.
# ruff: noqa: PTH102, PTH105, PTH106, PTH108

from __future__ import annotations

import contextlib
import errno
import os
import stat
import sys
import time
from pathlib import Path

__all__ = [
    "close",
    "folder_synced",
    "keep_attributes",
    "link",
    "lock",
    "make_folder",
    "open_new",
    "reason",
    "remove",
    "remove_folder",
    "replace",
    "synced",
    "unlock",
    "write_all",
]

_NEW = os.O_RDWR | os.O_CREAT | os.O_EXCL
_SAFE = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)

#: Scanners and indexers of Windows hold new files for a moment.
_WINDOWS_BUSY = {5, 32, 33}
_WINDOWS_PATIENCE = 2.5


def open_new(path: Path, mode: int) -> int:
    """A descriptor of a new file; the umask applies to the mode."""
    return os.open(path, _NEW | _SAFE, mode)


def write_all(file: int, data: bytes) -> None:
    """Write all bytes; a short write is continued."""
    rest = memoryview(data)
    while rest:
        rest = rest[os.write(file, rest[: 1 << 24]) :]


def synced(file: int) -> None:
    """Sync a file: it is on disk when this returns."""
    if sys.platform == "darwin":
        import fcntl

        # There `fsync` leaves the data in the cache of the drive. Not every file system has this.
        with contextlib.suppress(OSError):
            fcntl.fcntl(file, fcntl.F_FULLFSYNC)
            return
    os.fsync(file)


def folder_synced(folder: Path) -> None:
    """Sync a folder: its names are on disk when this returns, if the system supports it."""
    if os.name == "nt":
        return
    file = os.open(folder, os.O_RDONLY | getattr(os, "O_DIRECTORY", 0) | _SAFE)
    try:
        os.fsync(file)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP, errno.EOPNOTSUPP):
            raise
    finally:
        os.close(file)


def close(file: int) -> None:
    """Close a descriptor."""
    os.close(file)


def replace(old: Path, new: Path) -> None:
    """Rename a file, replacing an existing one."""
    end = time.monotonic() + _WINDOWS_PATIENCE
    wait = 0.01
    while True:
        try:
            os.replace(old, new)
            return
        except PermissionError as error:
            busy = getattr(error, "winerror", None) in _WINDOWS_BUSY
            if not busy or time.monotonic() > end:
                raise
            time.sleep(wait)
            wait *= 2


def link(old: Path, new: Path) -> None:
    """Make a second name (hard link) of a file."""
    os.link(old, new, follow_symlinks=False)


def remove(path: Path, *, there: bool = False) -> None:
    """Remove a file name; a missing one is an error only if ``there`` is true."""
    try:
        os.unlink(path)
    except FileNotFoundError:
        if there:
            raise


def make_folder(path: Path) -> None:
    """Make a folder in an existing one."""
    os.mkdir(path)


def remove_folder(path: Path) -> None:
    """Remove an empty folder."""
    os.rmdir(path)


def keep_attributes(file: int, old: Path, was: os.stat_result) -> None:
    """Give an open draft the owner, mode and extended attributes of the file that it replaces."""
    if not hasattr(os, "fchown"):
        return
    now = os.fstat(file)
    mode = stat.S_IMODE(was.st_mode)
    if (was.st_uid, was.st_gid) != (now.st_uid, now.st_gid):
        try:
            os.fchown(file, was.st_uid, was.st_gid)
        except PermissionError:
            # Another owner may not get more rights than before.
            mode &= ~(stat.S_ISUID | stat.S_ISGID)
            try:
                os.fchown(file, -1, was.st_gid)
            except PermissionError:
                mode &= ~0o070 | ((mode & 0o007) << 3)
    if stat.S_IMODE(now.st_mode) != mode:
        os.fchmod(file, mode)
    if hasattr(os, "listxattr"):
        # Access lists are among them; some of others need rights that we need not have.
        with contextlib.suppress(OSError):
            for name in os.listxattr(old):
                with contextlib.suppress(OSError):
                    os.setxattr(file, name, os.getxattr(old, name))


def lock(file: int) -> bool:
    """Lock an open file; false if it is already locked, in this process or another."""
    try:
        import fcntl
    except ImportError:
        import msvcrt

        try:
            os.lseek(file, 1 << 30, os.SEEK_SET)
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
        except OSError:
            return False
        finally:
            os.lseek(file, 0, os.SEEK_SET)
        return True
    try:
        # Not `lockf`: that is lost when any descriptor of the file is closed.
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def unlock(file: int) -> None:
    """Release the lock, also of copies of the descriptor in forked children."""
    with contextlib.suppress(ImportError, OSError):
        import fcntl

        fcntl.flock(file, fcntl.LOCK_UN)


def reason(error: OSError) -> str:
    """The system's error message, in lower case."""
    return (error.strerror or str(error)).lower()
