"""Closed plane outlines of a drawing, before its body is known."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

__all__ = ["outlines"]

#: Largest distance of points from a plane, as a part of the outline's size: pictures are rough.
_FLAT = 0.03
#: Longer outlines are no faces that a hand has just closed.
_LONGEST = 40


def outlines(
    lines: Iterable[tuple[int, int]], places: Mapping[int, Sequence[float]]
) -> list[list[int]]:
    """The shortest closed outlines through each line in a plane, without duplicates.

    Parameters
    ----------
    lines
        The ends of each line.
    places
        The points in space as the picture suggests them.

    Returns
    -------
    list of list of int
        Points in order.

    >>> square = {1: (0, 0, 0), 2: (1, 0, 0), 3: (1, 1, 0), 4: (0, 1, 0), 5: (0, 0, 9)}
    >>> outlines([(1, 2), (2, 3), (3, 4), (4, 1), (1, 5)], square)
    [[1, 2, 3, 4]]
    """
    near: dict[int, list[int]] = {}
    ends = [(p, q) for p, q in lines if p in places and q in places]
    for p, q in ends:
        near.setdefault(p, []).append(q)
        near.setdefault(q, []).append(p)
    found: dict[frozenset[int], list[int]] = {}
    for p, q in ends:
        for way in _ways(near, p, q):
            if frozenset(way) not in found and _flat([places[k] for k in way]):
                found[frozenset(way)] = way
    return list(found.values())


def _ways(near: Mapping[int, Sequence[int]], p: int, q: int) -> Iterable[list[int]]:
    """The shortest paths from p to q without their line, one through each neighbour of p."""
    for first in near[p]:
        if first == q:
            continue
        before = {p: 0, first: p}
        waiting = deque([(first, 2)])
        while waiting:
            k, count = waiting.popleft()
            if k == q:
                break
            if count < _LONGEST:
                for n in near[k]:
                    if n not in before:
                        before[n] = k
                        waiting.append((n, count + 1))
        if q not in before:
            continue
        way = [q]
        while way[-1] != p:
            way.append(before[way[-1]])
        start = way.index(min(way))
        way = way[start:] + way[:start]
        yield way if way[1] < way[-1] else [way[0], *way[:0:-1]]


def _flat(corners: Sequence[Sequence[float]]) -> bool:
    at = np.asarray(corners, dtype=np.float64)
    if len(at) < 3 or not np.isfinite(at).all():
        return False
    spread = np.linalg.svd(at - at.mean(axis=0), compute_uv=False)
    return bool(spread[2] <= _FLAT * spread[0] and spread[1] > _FLAT * spread[0])
