"""Colours of printed text: on a terminal, unless ``NO_COLOR`` or an option disables them."""

from __future__ import annotations

import os
import re
from typing import IO

from moldloft.cli.shown import OwnText, shown

__all__ = ["choose", "painted"]

_RED, _YELLOW, _BLUE, _CYAN, _GREEN = "31;1", "33;1", "34;1", "36;1", "32;1"

#: What is painted of a line, with its colour: the first that matches.
_RULES = (
    (re.compile(r"(error(?:\[[^\]]*\])?:)"), _RED),
    (re.compile(r"(warning(?:\[[^\]]*\])?:)"), _YELLOW),
    (re.compile(r"((?:note|remark|info)(?:\[[^\]]*\])?:)"), _BLUE),
    (re.compile(r"((?:help|expected|found)(?:\[[^\]]*\])?:)"), _CYAN),
    (
        re.compile(r"((?:usage|examples|positional arguments|options|[A-Z][a-z]+(?: [a-z]+)*):)"),
        _GREEN,
    ),
)
#: The margin of source lines, with or without a number, and the text to the right of it.
_MARGIN = re.compile(r"^( *(\d*) *\|)(.*)$")
_PLACE = re.compile(r"^( *(?:-->|:::) )(.*)$")

_choice = "auto"


def choose(word: str) -> None:
    """Colours ``"always"``, ``"never"`` or, with ``"auto"``, on terminals."""
    global _choice
    _choice = word


def _wanted(stream: IO[str]) -> bool:
    if _choice != "auto":
        return _choice == "always"
    if os.environ.get("NO_COLOR"):
        return False
    if os.environ.get("FORCE_COLOR") or os.environ.get("CLICOLOR_FORCE"):
        return True
    return stream.isatty() and os.environ.get("TERM") != "dumb"


def painted(text: str, stream: IO[str]) -> str:
    """A text for a stream: with colours if the stream has them.

    Diagnostics and help texts keep their words; only escapes are added.
    """
    if not _wanted(stream):
        return text
    return OwnText("\n".join(_line(line) for line in shown(text).split("\n")))


def _line(line: str) -> str:
    place = _PLACE.match(line)
    if place:
        return f"\x1b[{_BLUE}m{place[1]}\x1b[0m{place[2]}"
    margin = _MARGIN.match(line)
    if margin:
        rest = margin[3]
        if not margin[2] and rest.strip():
            # Marks and their words: of the fault red, of what explains it blue.
            rest = f"\x1b[{_RED if '^' in rest else _BLUE}m{rest}\x1b[0m"
        return f"\x1b[{_BLUE}m{margin[1]}\x1b[0m{rest}"
    stripped = line.lstrip(" =")
    for rule, colour in _RULES:
        found = rule.match(stripped)
        if found:
            at = len(line) - len(stripped)
            end = at + found.end(1)
            return f"{line[:at]}\x1b[{colour}m{line[at:end]}\x1b[0m{line[end:]}"
    return line
