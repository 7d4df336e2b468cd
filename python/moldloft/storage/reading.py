"""Reading files that a person or a model names: regular ones, of bounded size."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from pathlib import Path

from moldloft.errors import FileError
from moldloft.storage.system import reason

__all__ = ["LARGEST", "digest", "digest_of", "read_bytes", "read_text", "utf8_path"]

LARGEST = 256 << 20
"""The most bytes of one file."""

_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)


def digest(data: bytes) -> str:
    """The hash of a content."""
    return hashlib.sha256(data).hexdigest()


def read_bytes(path: str | os.PathLike[str], largest: int = LARGEST) -> bytes:
    """The bytes of a regular file.

    Parameters
    ----------
    path
        The file; links are followed.
    largest
        The most bytes.

    Raises
    ------
    FileError
        If it does not exist, cannot be read, is a folder, a pipe or a device, or is too large.
    """
    try:
        # Opening a pipe without a writer would wait for one.
        file = os.open(path, _FLAGS)
    except OSError as error:
        hint = _similar(path) if error.errno == errno.ENOENT else ""
        raise FileError(f"cannot read `{path}`: {reason(error)}{hint}") from error
    except ValueError as error:
        raise FileError(f"cannot read `{path!s}`: {error}") from error
    try:
        status = os.fstat(file)
        if stat.S_ISDIR(status.st_mode):
            raise FileError(f"cannot read `{path}`: it is a folder")
        if not stat.S_ISREG(status.st_mode):
            raise FileError(f"cannot read `{path}`: it is not a regular file")
        # One byte more than allowed shows a file that is too large, whatever its length claims.
        parts, room = [], largest + 1
        while room and (part := os.read(file, min(room, 1 << 24))):
            parts.append(part)
            room -= len(part)
    except FileError:
        raise
    except OSError as error:
        raise FileError(f"cannot read `{path}`: {reason(error)}") from error
    finally:
        os.close(file)
    if not room:
        raise FileError(f"cannot read `{path}`: it is larger than {_size(largest)}")
    return b"".join(parts)


def read_text(path: str | os.PathLike[str], largest: int = LARGEST) -> str:
    """The text of a regular file in UTF-8, its lines ended by line feeds.

    Raises
    ------
    FileError
        See :func:`read_bytes`, and if it is not UTF-8.
    """
    try:
        text = read_bytes(path, largest).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise FileError(f"cannot read `{path}`: it is not UTF-8 text") from error
    return text.replace("\r\n", "\n").replace("\r", "\n")


def utf8_path(path: str | os.PathLike[str]) -> str:
    r"""The path as UTF-8 text, as required by models, sketches and the workbench.

    A file whose name has other bytes is accepted as points, drawing or table, but refused as a
    model.

    Raises
    ------
    FileError
        If it is not UTF-8.

    Examples
    --------
    >>> utf8_path("boats/modèle.sdl")
    'boats/modèle.sdl'
    >>> utf8_path(os.fsdecode(b"mod\xe8le.sdl"))
    Traceback (most recent call last):
      ...
    moldloft.errors.FileError: cannot read `mod\xe8le.sdl`: its name is not UTF-8 text
    help: give the file, or the folder, a name in UTF-8
    """
    text = os.fspath(path)
    try:
        text.encode("utf-8")
    except UnicodeEncodeError as error:
        # Python keeps a byte that is not UTF-8 as a surrogate.
        letters = (f"\\x{ord(c) & 0xFF:02x}" if "\udc80" <= c <= "\udcff" else c for c in text)
        shown = "".join(letters).encode("utf-8", "backslashreplace").decode()
        raise FileError(
            f"cannot read `{shown}`: its name is not UTF-8 text\n"
            "help: give the file, or the folder, a name in UTF-8"
        ) from error
    return text


def digest_of(path: str | os.PathLike[str]) -> str | None:
    """The hash of a file's content; ``None`` when there is no file.

    Raises
    ------
    FileError
        If there is one that cannot be read.
    """
    try:
        return digest(read_bytes(path))
    except FileError as error:
        cause = error.__cause__
        if isinstance(cause, OSError) and cause.errno in (errno.ENOENT, errno.ENOTDIR):
            return None
        raise


def _similar(path: str | os.PathLike[str]) -> str:
    """Hint about a missing file: one in the same folder with a similar name."""
    from moldloft.spelling import nearest

    place = Path(os.fsdecode(path))
    if not place.name:
        return ""
    try:
        names = [entry.name for entry in os.scandir(place.parent)]
    except OSError:
        return ""
    near = nearest(place.name, sorted(names))
    return f"\nhelp: a similar name exists: `{place.with_name(near)}`" if near else ""


def _size(length: int) -> str:
    return f"{length >> 20} MiB" if length >= 1 << 20 else f"{length} bytes"
