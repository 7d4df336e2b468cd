"""Statements of a sketch file with their positions, and insertion of new ones.

What is drawn on the board is written as commands: beside those that it continues, or over the one
that it changes. A sketch session divides the text. Places are counted in code points here, in
UTF-16 units for the page.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from moldloft import _core

__all__ = ["MAKING", "Statement", "Token", "block", "replaced", "statements", "units"]

#: What makes a body of a drawing, or looks at it: drawing and dimensions are written before it.
MAKING = {
    "CONVERT", "GENERATE", "CREATE", "FACE", "CHOOSE", "OFFSET", "SWEEP", "LOFT", "EXTRUDE",
    "REVOLVE", "CLEAN", "MEASURE", "END", "CHECK", "LIST", "UNION", "CUT", "COMMON", "MERGE",
    "PATTERN", "FILLET", "CHAMFER", "SHELL", "DRAFT", "HOLE", "COPY", "MOVE", "ROTATE", "MIRROR",
    "SCALE", "SAVE", "EXPORT", "ESTIMATE",
}  # fmt: skip


@dataclass(frozen=True)
class Token:
    """A word, number or text of a statement."""

    text: str
    """As written, without quotes."""
    start: int
    end: int
    """Its span, quotes included."""

    @property
    def upper(self) -> str:
        """The word in capitals."""
        return self.text.upper()


@dataclass(frozen=True)
class Statement:
    """A command of a text."""

    verb: str
    """Its command in full; empty for an answer to a question."""
    words: Sequence[tuple[str, int, int]]
    """Its words as written, without quotes, and their spans."""
    last: bool
    """True if it is the last one of its line."""

    @cached_property
    def tokens(self) -> tuple[Token, ...]:
        """Its words."""
        return tuple(Token(*word) for word in self.words)

    @property
    def start(self) -> int:
        """Start offset."""
        return self.words[0][1]

    @property
    def end(self) -> int:
        """End offset."""
        return self.words[-1][2]

    def word(self, k: int) -> str:
        """The word with an index; empty beyond the end."""
        return self.words[k][0].upper() if k < len(self.words) else ""


def statements(text: str) -> list[Statement]:
    """The commands of a text, in order, without invalid ones.

    >>> [s.verb for s in statements("POI 1 0 0; LINE 1 2 ! LINE 3 4")]
    ['POINT', 'LINE']
    """
    return [
        Statement(verb, words, last) for verb, words, last in _core.SketchSession.commands(text)
    ]


def block(every: Sequence[Statement], name: str) -> list[Statement]:
    """The statements that are run while an object is active, including its SKETCH.

    >>> found = statements("SKETCH A; POINT 1 0 0; SKETCH B; POINT 1 2 3; USING A; LINE 1 2")
    >>> [s.word(0) for s in block(found, "a")]
    ['SKETCH', 'POINT', 'USING', 'LINE']
    """
    active, found = "", []
    for s in every:
        if s.verb in ("SKETCH", "MODIFY", "USING") and len(s.words) > 1:
            active = s.word(1)
        if active == name.upper():
            found.append(s)
    return found


def place(own: Sequence[Statement]) -> Statement | None:
    """The statement after which new drawing commands are inserted.

    The last one before the object's body is made.
    """
    last = None
    for s in own:
        if s.verb in MAKING:
            break
        last = s
    return last


def replaced(text: str, edits: Sequence[tuple[int, int, str]]) -> str:
    """The text after edits: start, end and replacement, with positions in the old text.

    >>> replaced("abcd", [(0, 1, "x"), (3, 4, "")])
    'xbc'
    """
    made, at = [], 0
    for start, end, insert in sorted(edits):
        made += [text[at:start], insert]
        at = end
    return "".join(made) + text[at:]


def units(text: str, at: int) -> int:
    r"""A position in UTF-16 units.

    >>> units("a\N{GRINNING FACE}b", 2)
    3
    """
    return at + sum(ord(c) > 0xFFFF for c in text[:at])
