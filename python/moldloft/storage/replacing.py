"""Atomic writing of one file."""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import stat
from pathlib import Path

from moldloft.errors import FileError
from moldloft.storage import system
from moldloft.storage.locks import folder_lock
from moldloft.storage.reading import digest_of

__all__ = ["ABANDONED", "ChangedError", "Draft", "Target", "beside", "put"]

ABANDONED = re.compile(r"\..+\.[0-9a-f]{16}\.(?:part|old)", re.S)
"""Names of drafts and of second names of old files, which a killed process may leave."""

#: The longest name of most systems is 255 bytes; what is put round it takes 23.
_LONGEST_NAME = 220


class ChangedError(FileError):
    """Another program has changed a file since it was read."""


def beside(target: Path, token: str, ending: str) -> Path:
    """A hidden name in a file's folder."""
    name = os.fsencode(target.name)[:_LONGEST_NAME].decode("utf-8", "ignore")
    return target.with_name(f".{name}.{token}.{ending}")


class Target:
    """Destination of a file: links are followed, so that a link stays a link.

    Parameters
    ----------
    path
        Its name.

    Raises
    ------
    FileError
        If something is there that is not a file, or that may not be written.
    """

    def __init__(self, path: Path) -> None:
        self.asked = path
        try:
            # Not `Path.resolve`, which fails on circles of links.
            self.path = Path(os.path.realpath(path))
            self.was: os.stat_result | None = self.path.stat(follow_symlinks=False)
        except FileNotFoundError:
            self.was = None
        except (OSError, ValueError) as error:
            why = system.reason(error) if isinstance(error, OSError) else str(error)
            raise FileError(f"cannot write `{path}`: {why}") from error
        if self.was is None:
            return
        kind = self.was.st_mode
        why = ""
        if stat.S_ISDIR(kind):
            why = "it is a folder"
        elif stat.S_ISLNK(kind):
            why = "its links lead in a circle"
        elif not stat.S_ISREG(kind):
            why = "it is not a regular file"
        elif not kind & 0o222 or not os.access(self.path, os.W_OK):
            # Replacing a file needs no right on it, so nothing but this respects the wish.
            why = "it is read-only"
        if why:
            raise FileError(f"cannot write `{path}`: {why}")


class Draft:
    """The new content of a file, on disk under a hidden name until it replaces the file.

    Parameters
    ----------
    target
        File to replace.
    data
        The content.
    token
        A part of its name; random by default.
    private
        True if a new file is private to its owner.
    """

    def __init__(
        self, target: Target, data: bytes, token: str | None = None, *, private: bool = False
    ) -> None:
        self.target = target
        was = target.was
        while True:
            self.path = beside(target.path, token or secrets.token_hex(8), "part")
            self._file = system.open_new(self.path, 0o600 if was or private else 0o666)
            try:
                # While it is locked nobody takes it for an abandoned one; who did has removed it.
                if system.lock(self._file) and os.fstat(self._file).st_nlink:
                    break
            except BaseException:
                self.drop()
                raise
            self._close()
        try:
            system.write_all(self._file, data)
            if was is not None:
                system.keep_attributes(self._file, target.path, was)
            system.synced(self._file)
        except BaseException:
            self.drop()
            raise

    def place(self) -> None:
        """Rename the draft to the file's name."""
        if os.name == "nt":
            # An open file cannot be renamed there.
            self._close()
        system.replace(self.path, self.target.path)
        self._close()

    def drop(self) -> None:
        """Remove it."""
        with contextlib.suppress(OSError):
            if os.name == "nt":
                self._close()
            system.remove(self.path)
        self._close()

    def _close(self) -> None:
        file, self._file = self._file, -1
        if file >= 0:
            with contextlib.suppress(OSError):
                system.close(file)


def put(path: Path, data: bytes, *, expected: str | None = None, private: bool = False) -> None:
    """Write a file atomically, synced, with its mode, owner and links.

    Parameters
    ----------
    path
        The file.
    data
        Its content.
    expected
        Expected digest of the file: the write fails if its content differs.
    private
        True if a new file is private to its owner.

    Raises
    ------
    ChangedError
        If the file is not what was expected.
    FileError
        If it cannot be written; the file is then unchanged.
    """
    try:
        target = Target(path)
        with contextlib.ExitStack() as held:
            if expected is not None:
                # Two that compare and then write must not do so at once.
                held.enter_context(folder_lock(target.path.parent))
            draft = Draft(target, data, private=private)
            try:
                if expected is not None and digest_of(path) != expected:
                    raise ChangedError(
                        f"cannot write `{path}`: it was changed meanwhile by somebody else"
                    )
                draft.place()
            except BaseException:
                draft.drop()
                raise
            # The new content is there under its name. A folder that cannot be synced may after a
            # power cut still show the old one, whole.
            with contextlib.suppress(OSError):
                system.folder_synced(target.path.parent)
    except FileError:
        raise
    except OSError as error:
        raise FileError(f"cannot write `{path}`: {system.reason(error)}") from error
