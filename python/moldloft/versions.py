"""The version of the language that a program is written in.

A program may state it in its first line, ``# moldloft 1``. Without that line it is version 1.
"""

from __future__ import annotations

import re

from moldloft._core import __version__
from moldloft.errors import FileError

__all__ = ["LANGUAGE", "check_language"]

LANGUAGE = 1
"""The newest version that this package reads."""

_STATED = re.compile(r"\ufeff?\s*#[ \t]*moldloft[ \t]+([0-9]{1,9})[ \t]*(?:\n|\r|\Z)")


def check_language(text: str, name: str) -> None:
    r"""Refuse a program of a later version of the language before anything is made of it.

    Parameters
    ----------
    text
        The program.
    name
        What the message calls it.

    Raises
    ------
    FileError
        When its first line states a version that is not read here.

    Examples
    --------
    >>> check_language("# moldloft 1\nAbsPoint P(1, 2, 3);", "a.sdl")
    >>> check_language("# moldloft 2\nAbsPoint P(1, 2, 3);", "a.sdl")
    Traceback (most recent call last):
      ...
    moldloft.errors.FileError: `a.sdl` is written in version 2 of the language; ... reads version 1
    help: install a newer moldloft
    """
    stated = _STATED.match(text)
    if stated and int(stated[1]) > LANGUAGE:
        raise FileError(
            f"`{name}` is written in version {int(stated[1])} of the language; moldloft "
            f"{__version__} reads version {LANGUAGE}\nhelp: install a newer moldloft"
        )
