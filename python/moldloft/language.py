"""The language itself: its reference, canonical texts, and the shapes that expressions have."""

from __future__ import annotations

from typing import Any

from moldloft import _core
from moldloft._core import Shape

__all__ = ["Shape", "format_text", "reference"]


def reference() -> list[dict[str, Any]]:
    """The rows of the registry: all kinds and functions with their fields, docs and examples.

    >>> row = next(row for row in reference() if row["name"] == "RuledSurf")
    >>> row["class"], row["is_kind"]
    ('surface', True)
    """
    return _core.reference()


def format_text(name: str, text: bytes) -> str:
    r"""The canonical text of a program.

    Parameters
    ----------
    name
        What messages call it.
    text
        In UTF-8 or an older code.

    Raises
    ------
    ModelError
        When it is not a program.

    Examples
    --------
    >>> format_text("a.sdl", b"AbsPoint   P ( 1,2,3 );")
    'AbsPoint P(1, 2, 3);\n'
    """
    return _core.format_text(name, text)
