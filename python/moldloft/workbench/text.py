"""Texts as editors see them: change sets in UTF-16 units, and files with their line ends kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from moldloft.storage import digest, read_bytes

__all__ = ["Stored", "applied", "change_set", "decoded", "encoded", "read"]

LARGEST = 16 << 20


def applied(text: str, changes: Sequence[Any]) -> str:
    r"""The text after a change set: lengths to keep, and ``[removed, line, line ...]``.

    >>> applied("one two", [4, [3, "x", "y"]])
    'one x\ny'
    """
    data = text.encode("utf-16-le", "surrogatepass")
    at, made = 0, []
    for step in changes:
        removed = step if isinstance(step, int) else step[0]
        if not isinstance(removed, int) or removed < 0 or at + 2 * removed > len(data):
            raise ValueError("the change set is of another text")
        if isinstance(step, int):
            made.append(data[at : at + 2 * step])
        else:
            if not all(isinstance(line, str) for line in step[1:]):
                raise ValueError("a change set inserts lines of text")
            made.append("\n".join(step[1:]).encode("utf-16-le", "surrogatepass"))
        at += 2 * removed
    if at != len(data):
        raise ValueError("the change set is of another text")
    new = b"".join(made).decode("utf-16-le", "surrogatepass")
    if len(new) > LARGEST:
        raise ValueError("the text is too long")
    return new


def change_set(old: str, new: str) -> list[Any]:
    """The change set that makes one text of another: one replacement.

    >>> change_set("ab1.25c", "ab1.5c")
    [4, [1, ''], 2]
    """

    def units(part: str) -> int:
        return len(part.encode("utf-16-le", "surrogatepass")) // 2

    most = min(len(old), len(new))
    start = next((k for k in range(most) if old[k] != new[k]), most)
    end = next((k for k in range(most - start) if old[-1 - k] != new[-1 - k]), most - start)
    removed, inserted = old[start : len(old) - end], new[start : len(new) - end]
    steps: list[Any] = [units(old[:start])] if start else []
    if removed or inserted:
        steps.append([units(removed), *inserted.split("\n")] if inserted else [units(removed)])
        if not inserted:
            steps[-1] = [units(removed), ""]
    if end:
        steps.append(units(old[len(old) - end :]))
    return steps


@dataclass(frozen=True)
class Stored:
    """The text of a file, with the data to write it back."""

    text: str
    """The text, its lines ended by line feeds."""
    digest: str
    """Of the bytes."""
    crlf: bool
    """True when lines end in carriage return and line feed."""
    encoding: str
    """Encoding of the file."""


def read(path: Path) -> Stored:
    """The text of a regular file.

    Raises
    ------
    FileError
        If there is no readable file.
    """
    return decoded(read_bytes(path, LARGEST))


def decoded(data: bytes) -> Stored:
    """The text of a file's bytes."""
    encoding = "utf-8-sig" if data.startswith(b"\xef\xbb\xbf") else "utf-8"
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        encoding = "latin-1"
        text = data.decode(encoding)
    crlf = "\r\n" in text
    return Stored(text.replace("\r\n", "\n").replace("\r", "\n"), digest(data), crlf, encoding)


def encoded(text: str, like: Stored) -> bytes:
    """The bytes of a text, with the encoding and line ends of a file."""
    text = text.replace("\n", "\r\n") if like.crlf else text
    try:
        return text.encode(like.encoding)
    except UnicodeEncodeError:
        return text.encode("utf-8")
