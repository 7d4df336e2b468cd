"""Suggestions for misspelt names."""

from __future__ import annotations

from collections.abc import Iterable

__all__ = ["distance", "nearest"]


def distance(a: str, b: str) -> int:
    """Number of edits: insertion, deletion, substitution, transposition of neighbours.

    The restricted Damerau-Levenshtein distance (Boytsov 2011, section 2.1.1).

    Parameters
    ----------
    a, b
        Two words.

    Examples
    --------
    >>> distance("bulid", "build"), distance("degre", "degree"), distance("hull", "keel")
    (1, 1, 3)
    """
    before: list[int] = []
    row = list(range(len(b) + 1))
    for i, letter in enumerate(a, 1):
        older, before, row = before, row, [i] + [0] * len(b)
        for j, other in enumerate(b, 1):
            row[j] = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (letter != other))
            if i > 1 and j > 1 and letter == b[j - 2] and other == a[i - 2]:
                row[j] = min(row[j], older[j - 2] + 1)
    return row[-1]


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The known name with the fewest edits, at most a third of its letters.

    Parameters
    ----------
    word
        The word as written.
    known
        Known names; of two at equal distance the first is the result.

    Examples
    --------
    >>> nearest("CBurve", ["XCurve", "BCurve"]), nearest("Line", ["RuledSurf"])
    ('BCurve', None)
    """

    def away(name: str) -> float:
        # Letters in the wrong case are half a mistake.
        return (distance(word, name) + distance(word.lower(), name.lower())) / 2

    # Lengths alone differ by more in others: a word of a million letters is not compared.
    near = (
        name for name in known if 3 * abs(len(name) - len(word)) <= max(3, len(name), len(word))
    )
    found = min(near, key=away, default=None)
    if found is None or away(found) > max(1, max(len(word), len(found)) / 3):
        return None
    return found
