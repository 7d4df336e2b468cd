"""The process of a room beside the engine: frames of a length in four bytes and JSON."""

from __future__ import annotations

import gc
import json
import struct
import sys
from collections.abc import Callable
from typing import Any

__all__ = ["answer_frames"]

#: Objects that are made before garbage is looked for: more than a reply is made of.
GARBAGE = 100_000

#: Cancelled work has no answer of its own.
_SILENT = "cancel"


def answer_frames(
    memory: int,
    begin: Callable[[str], None],
    answer: Callable[[dict[str, Any]], dict[str, Any] | bytes],
    *,
    files: bool = False,
) -> None:
    """Serve requests of the parent process until it ends.

    Parameters
    ----------
    memory
        The most bytes of the process.
    begin
        Is given the model's text, the first frame.
    answer
        The answer to a request: facts, or a frame.
    files
        True if the process may write files.
    """
    if sys.platform != "win32":
        import resource

        if not files:
            resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
        if sys.platform == "linux":
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    gc.set_threshold(GARBAGE)
    given, taken = sys.stdin.buffer, sys.stdout.buffer
    first = True
    while len(head := given.read(4)) == 4:
        message = given.read(struct.unpack("<I", head)[0])
        if first:
            begin(message.decode())
            first = False
            continue
        request = json.loads(message)
        if request.get("kind") == _SILENT:
            continue
        made = answer(request)
        reply = made if isinstance(made, bytes) else json.dumps(made).encode()
        taken.write(struct.pack("<I", len(reply)) + reply)
        taken.flush()
