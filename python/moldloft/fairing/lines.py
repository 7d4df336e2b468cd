"""Lines of a network as options name them: motions, tolerances, breaks, cells without a hull."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import direction, motions_of, radii
from moldloft.fairing.asked import index_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Vector = tuple[float, float, float]

__all__ = ["NetworkLines"]

_ACROSS = 1e-9
"""Directions are across each other where their cosine is no larger."""


@dataclass
class NetworkLines:
    """The curves of a network: their points, from 0, whether each is closed, their names."""

    lists: list[tuple[list[int], bool]]
    names: list[str]

    @staticmethod
    def of(curves: Sequence[Sequence[int]], count: int, names: Sequence[str]) -> NetworkLines:
        """The curves in the form of input: a closed one ends with its first point."""
        given = [str(name) for name in names]
        if given and len(given) != len(curves):
            raise FairingError(f"expected {len(curves)} names of curves, found {len(given)}")
        twice = {name for name in given if given.count(name) > 1}
        if twice:
            raise FairingError(f"two curves are called `{min(twice)}`")
        lists: list[tuple[list[int], bool]] = []
        lines = NetworkLines(lists, given)
        for k, row in enumerate(curves):
            own = [index_of(i, count) for i in row]
            closed = len(own) > 1 and own[0] == own[-1]
            own = own[:-1] if closed else own
            if len(set(own)) < len(own):
                raise FairingError(f"{lines.name(k)} passes twice through a point")
            lists.append((own, closed))
        if not lists:
            raise FairingError("no curves")
        return lines

    def name(self, k: int) -> str:
        """Name of curve ``k``, or its number."""
        return self.names[k] if self.names else f"curve {k + 1}"

    def find(self, given: Any) -> int:
        """The number of a curve, from 0, given by number or name."""
        if isinstance(given, str):
            known = self.names or [self.name(k) for k in range(len(self.lists))]
            if given in known:
                return known.index(given)
            near = ", ".join(known[:4])
            raise FairingError(f"expected a curve such as {near}, found `{given}`")
        k = int(given)
        if not 0 <= k < len(self.lists):
            raise FairingError(f"expected curves from 0 to {len(self.lists) - 1}, found {k}")
        return k

    def refuse_short(self, degree: int) -> None:
        """Refuse curves of too few points."""
        for k, (own, closed) in enumerate(self.lists):
            least = 2 * degree + 2 if closed else degree + 2
            if len(own) < least:
                raise FairingError(
                    f"expected at least {least} points of {self.name(k)}, found {len(own)}"
                )

    def where_hull(self, hull: NDArray[np.bool_], degree: int) -> tuple[NetworkLines, list[str]]:
        """The curves divided at cells outside the hull, and the omitted parts."""
        if hull.all():
            return self, []
        out = NetworkLines([], [])
        short = 0
        for k, (own, closed) in enumerate(self.lists):
            here = hull[own]
            if here.all():
                out.lists.append((own, closed))
                out.names.append(self.name(k))
                continue
            if closed:
                gap = int(np.flatnonzero(~here)[0])
                own = own[gap:] + own[:gap]
            parts: list[list[int]] = [[]]
            for i in own:
                if hull[i]:
                    parts[-1].append(i)
                elif parts[-1]:
                    parts.append([])
            long = [part for part in parts if len(part) >= degree + 2]
            short += sum(0 < len(part) < degree + 2 for part in parts)
            for number, part in enumerate(long, 1):
                out.lists.append((part, False))
                several = f", part {number}" if len(long) > 1 else ""
                out.names.append(self.name(k) + several)
        if not out.lists:
            raise FairingError(f"no curve has {degree + 2} neighbouring points with a hull")
        some = "part of a curve" if short == 1 else "parts of curves"
        said = [f"{short} {some} with fewer than {degree + 2} points: not faired"] if short else []
        return out, said

    def tolerances(self, tol: Any, count: int) -> list[float]:
        """The tolerance of each point, from one for all, one for each, or one for each curve.

        Curves are given by name (or number, from 0), ``""`` being all others; a point has the least
        of its curves.
        """
        if not isinstance(tol, Mapping):
            return radii(tol, count)
        rest = tol.get("", None)
        out = np.full(count, np.inf)
        known = np.zeros(count, bool)
        for given, value in tol.items():
            if given == "":
                continue
            own = self.lists[self.find(given)][0]
            out[own] = np.minimum(out[own], radii(value, 1)[0])
            known[own] = True
        if not known.all():
            if rest is None and "" not in tol:
                raise FairingError("expected a tolerance for all other curves, by the name ``")
            out[~known] = radii(rest, 1)[0]
        return [float(x) for x in out]

    def marks(self, breaks: Sequence[Any] | str, points: Floats) -> list[list[int]]:
        """The breaks of each curve, as indices along it.

        A number is a point and breaks all curves through it; a name is a curve at which all
        crossing curves break; ``"auto"`` are the knuckles found, breaks of all curves that cross
        them.
        """
        out: list[set[int]] = [set() for _ in self.lists]
        if isinstance(breaks, str) and breaks == "auto":
            rows = [(list(own), closed) for own, closed in self.lists]
            for k, i in _core.shared_knuckles(points, rows):
                out[k].add(i)
        else:
            given = [breaks] if isinstance(breaks, str) else breaks
            for one in given:
                if isinstance(one, str):
                    along = self.find(one)
                    for k, (own, _) in enumerate(self.lists):
                        if k != along:
                            out[k] |= set(own) & set(self.lists[along][0])
                else:
                    i = index_of(one, len(points))
                    for k, (own, _) in enumerate(self.lists):
                        if i in own:
                            out[k].add(i)
        return [
            [c for c, i in enumerate(own) if i in marked]
            for (own, _), marked in zip(self.lists, out, strict=True)
        ]

    def motions(
        self, motion: Any, count: int
    ) -> tuple[str, Vector, list[tuple[int, Vector]], list[bool]]:
        """The motion of all points, the fixed directions of single points, and the fixed points.

        A list has the axes of each point; a mapping has the motions of curves by name (or
        number, from 0), ``""`` being all others; for a point on several, the last decides.
        """
        if not isinstance(motion, Mapping):
            whole, axes, steady = motions_of(motion, count)
            return (*direction(whole), axes, steady)
        rest = direction(motion.get("", "ball"))
        own = [rest] * count
        for given, wanted in motion.items():
            if given != "":
                for i in self.lists[self.find(given)][0]:
                    own[i] = direction(wanted)
        kinds = sorted(set(own))
        if any(word == "box" for word, _ in kinds):
            raise FairingError(
                "expected motions along, across or in a ball where curves have their own"
            )
        steady = [False] * count
        if len(kinds) == 1:
            return (*kinds[0], [], steady)
        free = {kind: _directions(kind) for kind in kinds}
        # The plane across one direction, where all points move in it.
        across = [np.asarray(d) for word, d in kinds if word == "across"] + list(np.eye(3))
        common = next(
            (
                d / np.linalg.norm(d)
                for d in across
                if all((np.abs(f @ d) <= _ACROSS * np.linalg.norm(d)).all() for f in free.values())
            ),
            None,
        )
        held = []
        for kind in kinds:
            here = [i for i in range(count) if own[i] == kind]
            spanned = free[kind] if common is None else np.vstack([free[kind], common])
            held += [(i, _triple(d)) for d in _complement(spanned) for i in here]
        if common is None:
            return "ball", (0.0, 0.0, 0.0), held, steady
        return "across", _triple(common), held, steady

    def axes(self, motion: Any, count: int) -> tuple[str, ...]:
        """The axes along which each point may move."""
        word, way, held, steady = self.motions(motion, count)
        size = float(np.linalg.norm(way))
        unit = np.asarray(way) / size if size else np.asarray(way)
        along = np.outer(unit, unit)
        whole = {"along": along, "across": np.eye(3) - along}.get(word, np.eye(3))
        blocked: list[list[Vector]] = [[] for _ in range(count)]
        for i, d in held:
            blocked[i].append(d)

        def of(i: int) -> str:
            if steady[i]:
                return ""
            free = whole
            if blocked[i]:
                rows = np.linalg.svd(np.asarray(blocked[i]))[2][: len(blocked[i])]
                rest = np.eye(3) - rows.T @ rows
                free = rest @ whole @ rest
            return "".join(a for a, x in zip("xyz", np.diag(free), strict=True) if x > _ACROSS)

        return tuple(of(i) for i in range(count))


def _directions(kind: tuple[str, tuple[float, float, float]]) -> Floats:
    """Orthogonal unit vectors that span the directions of a motion."""
    word, d = kind
    if word == "along":
        vector = np.asarray([d], np.float64)
        return np.asarray(vector / np.linalg.norm(vector), np.float64)
    if word == "across":
        return _complement(np.asarray([d]))
    if word == "ball":
        return np.eye(3)
    raise FairingError(f"a motion is ball, box, a direction, or across one, not `{word}`")


def _complement(rows: Floats) -> Floats:
    """Orthogonal unit vectors across all rows."""
    _, sizes, basis = np.linalg.svd(rows)
    rank = int((sizes > _ACROSS * sizes[0]).sum())
    return np.asarray(basis[rank:], np.float64)


def _triple(d: Floats) -> tuple[float, float, float]:
    return float(d[0]), float(d[1]), float(d[2])


explain(globals())
