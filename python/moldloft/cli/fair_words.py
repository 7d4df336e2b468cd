"""Values of arguments of ``moldloft fair``."""

from __future__ import annotations

import argparse
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

from moldloft.errors import Error, FairingError

__all__ = [
    "condition",
    "degrees",
    "goal",
    "motion",
    "places",
    "spacing",
    "step",
    "stop",
    "tolerance",
    "vector",
]


def tolerance(text: str) -> float | str | None:
    """A length, a file of lengths, or ``None`` for no limit."""
    if text.lower() == "none":
        return None
    try:
        # A decimal comma, as tables have.
        return float(_COMMA.sub(r"\1.\2", text))
    except ValueError:
        if Path(text).is_file():
            return text
        raise argparse.ArgumentTypeError(
            f"`{text}` is neither a length, nor `none`, nor a file of lengths"
        ) from None


_COMMA = re.compile(r"^(\d*),(\d+)$")


def step(text: str) -> float:
    """A step of written numbers, as a number or a fraction."""
    try:
        value = float(Fraction(_COMMA.sub(r"\1.\2", text)))
    except (ValueError, ZeroDivisionError):
        value = -1.0
    if value < 0:
        raise argparse.ArgumentTypeError(f"expected a step such as 0.001 or 1/16, found `{text}`")
    return value


STOPS = {"move": "least_move", "drop": "least_drop", "gap": "stop_gap", "pieces": "stop_pieces"}


def stop(text: str) -> tuple[str, float | bool]:
    """Criterion that ends local steps, and its fraction."""
    word, equals, share = text.partition("=")
    if word == "pieces" and not equals:
        return STOPS[word], True
    try:
        if word not in STOPS or word == "pieces" or not float(share) >= 0:
            raise ValueError
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"expected move=FRACTION, drop=FRACTION, gap=FRACTION or pieces, found `{text}`"
        ) from None
    return STOPS[word], float(share)


def spacing(text: str) -> Any:
    """Parametrisation of points: a word, or a direction."""
    return tuple(vector(text)) if "," in text else text


def goal(text: str) -> Any:
    """Choice among the curves within the tolerance: a word, and its fraction."""
    word, equals, share = text.partition("=")
    try:
        return (word, float(share)) if equals else word
    except ValueError:
        raise argparse.ArgumentTypeError(f"`{share}` is not a number") from None


def vector(text: str) -> list[float]:
    """Two or three coordinates."""
    try:
        vector = [float(c) for c in text.split(",")]
    except ValueError:
        vector = []
    if len(vector) not in (2, 3):
        raise argparse.ArgumentTypeError(f"`{text}` is not of the form X,Y or X,Y,Z")
    return vector


def condition(text: str) -> tuple[list[float], list[float]]:
    """Parameters with a vector at each."""
    place, equals, given = text.partition("=")
    try:
        at = [float(t) for t in place.split(",")]
    except ValueError:
        at = []
    if not equals or len(at) not in (1, 2) or not all(0 <= t <= 1 for t in at):
        raise argparse.ArgumentTypeError(
            f"`{text}` is not of the form T=X,Y (of surfaces U,V=X,Y,Z) with T in [0, 1]"
        )
    return at, vector(given)


def degrees(text: str) -> int | tuple[int, int]:
    """A degree, or one along u and one along v."""
    words = text.split(",")
    if len(words) > 2 or not all(w.isdigit() for w in words):
        raise argparse.ArgumentTypeError(f"`{text}` is not a degree or a pair of degrees")
    return int(words[0]) if len(words) == 1 else (int(words[0]), int(words[1]))


def places(text: str, count: int | None = None, what: str = "--breaks") -> list[int]:
    """Indices from 0 for numbers from 1."""
    out = []
    for word in filter(None, (w.strip() for w in text.split(","))):
        if not word.isdigit() or int(word) < 1 or (count is not None and int(word) > count):
            to = f" to {count}" if count else ""
            raise FairingError(f"{what}: expected points from 1{to}, found `{word}`")
        out.append(int(word) - 1)
    return out


def motion(options: argparse.Namespace) -> Any:
    """The motion that ``--along``, ``--across`` and ``--box`` name."""
    given = [options.along is not None, options.across is not None, options.box]
    if sum(given) > 1:
        raise Error("--along, --across and --box: one of these")
    if options.across is not None:
        return "across", tuple(options.across)
    if options.along is not None:
        return tuple(options.along)
    return "box" if options.box else "ball"
