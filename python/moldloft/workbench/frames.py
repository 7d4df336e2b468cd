"""Frames of the engine: facts in JSON and arrays of bytes, see ``crates/session/src/frame.rs``."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from typing import Any

__all__ = ["MAGIC", "frame_of", "head_of"]

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
    facts = json.dumps({**head, "files": parts}).encode()
    words = struct.pack("<4I", int.from_bytes(MAGIC, "little"), _VERSION, len(facts), 0)
    return words + facts + bytes(-len(facts) % _GRAIN) + bytes(data)
