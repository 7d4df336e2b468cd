"""Untrusted text on a terminal: control characters are shown as symbols."""

from __future__ import annotations

import re
from typing import Any, TextIO

__all__ = ["STEERING", "OwnText", "ShownStream", "shown"]

STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""Controls but tabs and line feeds (ECMA-48, 5.2 and 5.3), and those of writing directions."""


def shown(text: str) -> str:
    r"""The text with symbols (U+2400 to U+2421) for control characters, and codes for others.

    >>> shown("a\x1b]0;title\x07b\tc")
    'a␛]0;title␇b\tc'
    >>> shown("\x9b2J")
    '<9B>2J'
    """
    return STEERING.sub(_picture, text) if STEERING.search(text) else text


def _picture(found: re.Match[str]) -> str:
    code = ord(found[0])
    if code < 0x20:
        return chr(0x2400 + code)
    return "\u2421" if code == 0x7F else f"<{code:02X}>"


class OwnText(str):
    """Text of this program, written unchanged with its colours and cursor movements."""

    __slots__ = ()

    def __str__(self) -> str:
        return self


class ShownStream:
    """A stream that escapes all text except :class:`OwnText`.

    Parameters
    ----------
    stream
        Destination of the text.
    """

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """As in the stream."""
        return self._stream.write(text if isinstance(text, OwnText) else shown(text))

    def writelines(self, lines: Any) -> None:
        """As in the stream."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
