"""Conditions of shape as texts: ``"straight 1-5"``, ``"convex"``, ``"pieces 3"``."""

from __future__ import annotations

from typing import Any

from moldloft import _core
from moldloft.arguments import explain


def read_shape(text: str, count: int) -> tuple[Any, ...]:
    """The condition of a text, as the argument ``shape`` of :func:`moldloft.fair` takes it.

    Parameters
    ----------
    text : str
        A word of the conditions and its numbers, such as ``"arc 4-9"``.
    count : int
        The number of points of the curve, at least 1.

    Returns
    -------
    tuple
        The word, and what belongs to it.

    Raises
    ------
    FairingError
        An unknown word, or places that the curve does not have.
    """
    word, first, last, way, number = _core.fair_shape(text, count)
    rest: dict[str, tuple[Any, ...]] = {
        "pieces": (first,),
        "within": (way, number),
        "side": (way,),
        "straight": (first, last, way),
    }
    return (word, *rest.get(word, (first, last)))


explain(globals())
