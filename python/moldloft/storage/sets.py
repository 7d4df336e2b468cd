"""Sets of files that are replaced together, and recovery after a killed process.

A set is first written as drafts. The old files then get second names, and a record in the folder
lists the operation; the drafts take the files' names; finally the record is removed, which is the
moment at which the set is written. A process that is killed before it leaves the record, and the
next writer there restores the old files.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import secrets
import stat
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from moldloft.errors import FileError
from moldloft.storage import system
from moldloft.storage.folders import make_folders
from moldloft.storage.locks import LOCK, BusyError, folder_lock
from moldloft.storage.reading import digest, digest_of, read_bytes
from moldloft.storage.replacing import ABANDONED, Draft, Target, beside, put

__all__ = ["RECORD", "Output", "commit", "read_set", "recover"]

RECORD = ".moldloft.commit"
"""The name of the record of a set that is being written."""

_WAIT = 60.0
_LARGEST_RECORD = 16 << 20


@dataclass(frozen=True)
class Output:
    """A file to be written."""

    name: str
    """Its name, without folder."""
    data: bytes
    """Its content."""


@dataclass(frozen=True)
class _Entry:
    """A file of a set, as the record has it."""

    name: str
    existed: bool
    digest: str


def commit(folder: Path, outputs: Sequence[Output], *, make: bool = True) -> list[Path]:
    """Write all files or no file: first synced drafts, then renames.

    Concurrent readers by :func:`read_set` get all old or all new files. Mode, owner and links
    of old files are kept.

    Parameters
    ----------
    folder
        Destination.
    outputs
        Content.
    make
        Make the folder when it is not there, as commands do with the folder of ``-o``.

    Raises
    ------
    FileError
        If a file may not be written, or the folder or the disk refuses; then nothing has changed.
    """
    if not outputs:
        return []
    folder = Path(folder)
    if not make and not folder.is_dir():
        raise FileError(f"cannot write `{folder / outputs[0].name}`: there is no folder `{folder}`")
    paths = [folder / output.name for output in outputs]
    made: list[Path] = []
    try:
        made = make_folders(folder)
        recover(folder)
        if len(outputs) == 1:
            put(paths[0], outputs[0].data)
        else:
            _Set(folder, outputs).write()
    except BaseException as error:
        for new in made:
            with contextlib.suppress(OSError):
                system.remove_folder(new)
        if isinstance(error, OSError) and not isinstance(error, FileError):
            raise FileError(f"cannot write in `{folder}`: {system.reason(error)}") from error
        raise
    return paths


class _Set:
    """Several files of one folder in progress."""

    def __init__(self, folder: Path, outputs: Sequence[Output]) -> None:
        self._folder = folder
        self._outputs = outputs
        self._targets = [Target(folder / output.name) for output in outputs]
        places = [target.path for target in self._targets]
        twice = next((p for k, p in enumerate(places) if p in places[:k]), None)
        if twice is not None:
            raise FileError(f"cannot write `{twice}`: two files of the set have this name")
        self._token = secrets.token_hex(8)
        self._entries = [
            _Entry(output.name, target.was is not None, digest(output.data))
            for output, target in zip(outputs, self._targets, strict=True)
        ]

    def write(self) -> None:
        folders = sorted({self._folder.resolve(), *(t.path.parent for t in self._targets)})
        with contextlib.ExitStack() as held:
            # In one order everywhere, so that two sets never wait for one another.
            for folder in folders:
                held.enter_context(folder_lock(folder))
            _undo_left(self._folder)
            drafts: list[Draft] = []
            try:
                self._prepare(drafts)
                for folder in folders:
                    # The record and the second names are there before the first file changes.
                    system.folder_synced(folder)
                for draft in drafts:
                    draft.place()
                for folder in folders:
                    system.folder_synced(folder)
                system.remove(self._folder / RECORD, there=True)
            except BaseException:
                _undo(self._folder, self._token, self._entries)
                for draft in drafts:
                    draft.drop()
                raise
            # Should the disk lose this removal, the next start puts the old files back, whole.
            with contextlib.suppress(OSError):
                system.folder_synced(self._folder)
            for target in self._targets:
                with contextlib.suppress(OSError):
                    system.remove(beside(target.path, self._token, "old"))

    def _prepare(self, drafts: list[Draft]) -> None:
        """The drafts, the second names of old files, and the record."""
        for target, output in zip(self._targets, self._outputs, strict=True):
            try:
                drafts.append(Draft(target, output.data, self._token))
            except OSError as error:
                why = system.reason(error)
                raise FileError(f"cannot write `{target.asked}`: {why}") from error
        for target in self._targets:
            if target.was is not None:
                _second_name(target, beside(target.path, self._token, "old"))
        files = [vars(entry) for entry in self._entries]
        data = json.dumps({"version": 1, "token": self._token, "files": files}).encode()
        record = Draft(Target(self._folder / RECORD), data)
        try:
            record.place()
        except BaseException:
            record.drop()
            raise


def _second_name(target: Target, path: Path) -> None:
    """Keeps an old file under another name, as a copy where there are no hard links."""
    try:
        system.link(target.path, path)
    except OSError:
        copy = system.open_new(path, 0o600)
        try:
            system.write_all(copy, read_bytes(target.path))
            if target.was is not None:
                system.keep_attributes(copy, target.path, target.was)
            system.synced(copy)
        finally:
            system.close(copy)


def _undo(folder: Path, token: str, entries: Sequence[_Entry]) -> None:
    """Restores the old files as far as the system allows, then removes the record."""
    complete = True
    for entry in entries:
        target = Path(os.path.realpath(folder / entry.name))
        draft, old = beside(target, token, "part"), beside(target, token, "old")
        try:
            if draft.exists():
                # Not placed: what is there is the old file.
                system.remove(draft)
                system.remove(old)
            elif entry.existed and old.exists():
                # A file written by another program since is neither old nor new, and is kept.
                if digest_of(target) in (entry.digest, None):
                    system.replace(old, target)
                else:
                    system.remove(old)
            elif not entry.existed and digest_of(target) == entry.digest:
                system.remove(target)
        except OSError:
            complete = False
    if complete:
        with contextlib.suppress(OSError):
            system.folder_synced(folder)
            system.remove(folder / RECORD)


def _undo_left(folder: Path) -> None:
    """Puts back what a killed process left half-written; its lock is ours."""
    record = folder / RECORD
    try:
        data = json.loads(read_bytes(record, _LARGEST_RECORD))
        token, entries = data["token"], [_Entry(**entry) for entry in data["files"]]
    except FileError:
        return
    except (ValueError, KeyError, TypeError):
        # Not ours, or from before the record was whole: nothing was placed then.
        with contextlib.suppress(OSError):
            system.remove(record)
        return
    # A record is a file like others, perhaps from elsewhere: it names files of its folder alone.
    plain = all(Path(e.name).name == e.name and e.name not in ("", "..") for e in entries)
    if plain and re.fullmatch(r"[0-9a-f]{16}", str(token)):
        _undo(folder, token, entries)
    else:
        system.remove(record)


_swept: set[tuple[int, int]] = set()
_sweeping = threading.Lock()


def recover(folder: Path) -> None:
    """Undo and remove the unfinished writes of killed processes in a folder.

    A half-written set is undone immediately; drafts are searched once per process. Files of running
    processes are not touched.
    """
    try:
        status = folder.stat()
        pending = (folder / RECORD).exists()
    except OSError:
        return
    with _sweeping:
        fresh = (status.st_dev, status.st_ino) not in _swept
        _swept.add((status.st_dev, status.st_ino))
    if pending or (fresh and any(_abandoned(folder))):
        # Without permission to write here, nothing can be restored.
        with (
            contextlib.suppress(BusyError, OSError),
            folder_lock(folder, _WAIT if pending else 0.0),
        ):
            _undo_left(folder)
            for path in _abandoned(folder):
                if path.name != LOCK:
                    _sweep(path)


def _abandoned(folder: Path) -> Iterator[Path]:
    """Possible leftovers; the lock among them is removed by its new owner."""
    with os.scandir(folder) as entries:
        names = [entry.name for entry in entries]
    return (folder / name for name in names if ABANDONED.fullmatch(name) or name == LOCK)


def _sweep(path: Path) -> None:
    """Removes a draft whose writer has ended."""
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    with contextlib.suppress(OSError):
        file = os.open(path, flags)
        try:
            if stat.S_ISREG(os.fstat(file).st_mode) and system.lock(file):
                system.remove(path)
        finally:
            system.close(file)


def read_set(folder: Path, names: Sequence[str]) -> dict[str, bytes | None]:
    """Files of a folder as one consistent set: all before a concurrent write, or all after it.

    Parameters
    ----------
    folder
        Folder of the files.
    names
        Their names.

    Returns
    -------
    dict
        The contents; ``None`` for a file that is not there.

    Raises
    ------
    FileError
        If one cannot be read, or the folder is being written all the time.
    """
    folder = Path(folder)
    end = time.monotonic() + _WAIT
    while True:
        recover(folder)
        before = _state(folder, names)
        found = {name: _content(folder / name) for name in names}
        if before is not None and _state(folder, names) == before:
            return found
        if time.monotonic() > end:
            raise FileError(f"cannot read in `{folder}`: it is being written all the time")
        time.sleep(0.002)


def _content(path: Path) -> bytes | None:
    try:
        return read_bytes(path)
    except FileError:
        if path.exists():
            raise
        return None


def _state(folder: Path, names: Sequence[str]) -> list[object] | None:
    """A value that changes with any of the files; ``None`` while a set is being written."""
    if (folder / RECORD).exists():
        return None
    found: list[object] = []
    for name in names:
        try:
            status = (folder / name).stat()
            found.append((status.st_dev, status.st_ino, status.st_ctime_ns, status.st_size))
        except OSError:
            found.append(None)
    return found
