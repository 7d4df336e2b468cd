"""Frames of the engine: facts in JSON and arrays of bytes, see ``crates/session/src/frame.rs``."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

__all__ = ["MAGIC", "frame_of", "head_of", "without"]

#: The first bytes of a frame.
MAGIC = b"MLFT"
_VERSION = 1
#: Files begin at multiples of this.
_GRAIN = 8


def head_of(frame: bytes) -> dict[str, Any]:
    """The facts of a frame.

    Parameters
    ----------
    frame
        The frame.
    """
    (length,) = struct.unpack_from("<I", frame, 8)
    head: dict[str, Any] = json.loads(frame[16 : 16 + length])
    return head


def frame_of(head: Mapping[str, Any], files: Mapping[str, bytes]) -> bytes:
    """A frame of facts with the files of an export.

    Parameters
    ----------
    head
        The facts; ``files`` is added.
    files
        The bytes of each file by its name.

    Examples
    --------
    >>> frame = frame_of({"id": 3}, {"a.stl": b"solid"})
    >>> head_of(frame)["files"]
    [{'role': 'file', 'type': 'u8', 'offset': 0, 'count': 5, 'name': 'a.stl'}]
    """
    parts: list[dict[str, Any]] = []
    data = bytearray()
    for name, content in files.items():
        part = {"role": "file", "type": "u8", "offset": len(data), "count": len(content)}
        parts.append({**part, "name": name})
        data += content + bytes(-len(content) % _GRAIN)
    return _framed({**head, "files": parts}, bytes(data))


def without(frame: bytes, fact: str) -> bytes:
    """A frame with one fact less.

    Examples
    --------
    >>> head_of(without(frame_of({"id": 3, "watched": []}, {}), "watched"))
    {'id': 3, 'files': []}
    """
    (length,) = struct.unpack_from("<I", frame, 8)
    head = {name: value for name, value in head_of(frame).items() if name != fact}
    return _framed(head, frame[16 + length + -length % _GRAIN :])


def _framed(head: Mapping[str, Any], data: bytes) -> bytes:
    facts = json.dumps(head).encode()
    words = struct.pack("<4I", int.from_bytes(MAGIC, "little"), _VERSION, len(facts), 0)
    return words + facts + bytes(-len(facts) % _GRAIN) + data
