"""Suspects: table cells that contradict their neighbours, with the probable readings.

Each offset is predicted by the neighbours on each of its lines: by polynomials of different degree
and width, whose disagreement is the error of the prediction. The predictions of its lines are
weighed by their errors. The clearest suspect is put aside before the next is looked for, so that it
hides no other and accuses no neighbour. The list is a ranking, not a test of significance.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.arguments import explain
from moldloft.errors import FairingError
from moldloft.fairing.arrays import points_of
from moldloft.fairing.cells import notation, sixteenths
from moldloft.fairing.tables import length

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["Suspect", "suspects"]

#: Neighbours on either side that predict, at most and at least.
_SIDE, _LEAST = 3, 2

#: Fraction of an error along the fixed axis that enters a prediction, through the slope.
_SLOPE = 0.5

#: A point whose sides both predict it to this share of what both together miss is a knuckle.
_KNUCKLE = 0.35

#: Errors of the prediction within which a reading is one that was meant.
_WITHIN = 2.5

#: Deviations of fewer tolerances are noise.
_BEYOND = 2.0

#: Two neighbours are swapped where this share of the measure beside them is gone so.
_SWAPPED = 0.9

#: Smallest deviation of a listed suspect, in errors.
_WORTH = 0.8

#: Cost of a slip beside the squared deviation, in squared errors: less of likelier ones.
_COSTS = {
    "an inch": 0.0,
    "eighths": 0.3,
    "a digit": 0.3,
    "a foot": 0.5,
    "two inches": 1.0,
    "two digits swapped": 1.0,
    "inches and eighths swapped": 1.0,
    "the sign": 1.0,
    "the decimal point": 1.5,
}


@dataclass(frozen=True)
class Suspect:
    """A coordinate of a point that contradicts its neighbours."""

    index: int
    """The point, from 0."""
    axis: int
    """The coordinate: 0, 1 or 2."""
    name: str
    """The name of the point, such as ``station 8, sheer``."""
    value: float
    """The coordinate as it was read."""
    expected: float
    """The coordinate that the neighbours predict."""
    error: float
    """Error of the prediction."""
    score: float
    """The deviation as a multiple of its error; the rank is by this times the deviation."""
    meant: float | None
    """The probable reading; ``None`` if no slip of the pen explains the deviation."""
    reading: str
    """The coordinate as it is written in the table."""
    meant_reading: str
    """The probable reading in the notation of the table; empty if unknown."""
    slip: str
    """The kind of slip, such as ``an inch`` or ``a digit``; empty if unknown."""
    gain: float
    """Relative reduction of the squared third differences near the point, on all its lines, by the
    probable reading, or else the predicted one.
    """
    lines: tuple[str, ...]
    """The names of its lines."""

    def __str__(self) -> str:
        said = f"{self.name}: {self.reading}"
        if self.slip:
            said += f", meant {self.meant_reading}? ({self.slip})"
        else:
            said += ", no slip of the pen explains it"
        shown = sixteenths(self.expected) if notation(self.reading) == "eighths" else ""
        expected = shown or f"{self.expected:.6g}"
        return (
            f"{said}; its neighbours have it at {expected}, {self.score:.1f} times their error; "
            f"gain {100 * self.gain:.0f} %"
        )

    def as_dict(self) -> dict[str, Any]:
        """The suspect as plain data; points count from 1.

        Returns
        -------
        dict
            Numbers, texts and lists.
        """
        return {
            "point": self.index + 1,
            "axis": "xyz"[self.axis],
            "name": self.name,
            "reading": self.reading,
            "meant": self.meant_reading or None,
            "slip": self.slip or None,
            "value": self.value,
            "expected": self.expected,
            "score": self.score,
            "gain": self.gain,
            "lines": list(self.lines),
        }


@dataclass(frozen=True)
class _Prediction:
    off: float
    error: float


def suspects(
    points: ArrayLike,
    tol: float,
    curves: Sequence[Sequence[int]] | None = None,
    *,
    motion: Sequence[str] | str | None = None,
    most: int = 10,
    names: Sequence[str] = (),
    point_names: Sequence[str] = (),
    readings: dict[tuple[int, int], str] | None = None,
) -> tuple[Suspect, ...]:
    """Ranked list of probably wrong coordinates, with the probable readings.

    Parameters
    ----------
    points
        ``(n, 2)`` or ``(n, 3)``.
    tol
        The noise of the data, such as half of their last digit: a length.
    curves
        Of each line its points, from 0, as of :func:`~moldloft.fairing.network`; by default one
        line through all.
    motion
        Axes in which a point may be wrong, such as ``"y"``; or a list with those of each point. By
        default all in which the points differ.
    most
        The length of the list at most.
    names, point_names
        Names of lines and points.
    readings
        The text of the cell of a point and an axis.

    Returns
    -------
    tuple of Suspect
        The clearest first.

    Examples
    --------
    >>> import numpy as np
    >>> x = np.arange(15.0)
    >>> y = np.round(40 + 12 * np.sin(x / 5), 1)
    >>> y[6] += 1                                          # 51.2 written as 52.2
    >>> first = suspects(np.column_stack([x, y]), 0.05, motion="y")[0]
    >>> first.index, first.reading, first.meant_reading, first.slip
    (6, '52.2', '51.2', 'a digit')
    """
    data, _ = points_of(points)
    count = len(data)
    lines = [list(range(count))] if curves is None else [list(own) for own in curves]
    if bad := next((i for own in lines for i in own if not 0 <= i < count), None):
        raise FairingError(f"expected points from 0 to {count - 1}, found {bad}")
    axes = _axes(data, motion)
    floor = max(float(tol), 1e-12 * float(np.ptp(data, axis=0).max(initial=0.0)))
    search = _Search(data, lines, axes, floor)
    texts = readings or {}
    out = []
    for index, axis, off, error in search.ranked(most):
        value = float(data[index, axis])
        text = texts.get((index, axis), f"{value:.12g}")
        meant, slip = _meant(text, value, value - off, error)
        gain = search.gain(index, {(index, axis): value - off if meant is None else meant})
        for other in search.neighbours(index, axis):
            there = float(data[other, axis])
            both = search.gain(index, {(index, axis): there, (other, axis): value})
            if both > max(_SWAPPED, gain) and length(text) is not None:
                meant, slip, gain = there, "swapped with its neighbour", both
        shown = "" if meant is None else _shown(meant, text)
        own = [k for k, line in enumerate(lines) if index in line]
        out.append(
            Suspect(
                index=index,
                axis=axis,
                name=point_names[index] if point_names else f"point {index + 1}",
                value=value,
                expected=value - off,
                error=error,
                score=abs(off) / error,
                meant=meant,
                reading=text,
                meant_reading=shown,
                slip=slip,
                gain=gain,
                lines=tuple(names[k] if names else f"curve {k + 1}" for k in own),
            )
        )
    return tuple(out)


def _axes(data: Floats, motion: Sequence[str] | str | None) -> list[str]:
    if motion is None:
        motion = "".join("xyz"[a] for a in range(3) if np.ptp(data[:, a]) > 0)
    each = [motion] * len(data) if isinstance(motion, str) else list(motion)
    if len(each) != len(data):
        raise FairingError(f"expected the axes of {len(data)} points, found {len(each)}")
    if odd := next((own for own in each if set(own) - set("xyz")), None):
        raise FairingError(f"expected axes of x, y and z, found `{odd}`")
    return each


class _Search:
    """The search for suspects, one after the other."""

    def __init__(self, data: Floats, lines: list[list[int]], axes: list[str], floor: float) -> None:
        self.lines, self.axes, self.floor = lines, axes, floor
        # Short lists of numbers: NumPy's calls would take longer than what they compute.
        self.data: list[list[float]] = data.tolist()
        self.columns: list[list[float]] = data.T.tolist()
        self.gone: set[int] = set()
        self.found = [self._line(own) for own in lines]

    def ranked(self, most: int) -> list[tuple[int, int, float, float]]:
        """Point, axis, deviation and its error, in descending order of certainty."""
        out: list[tuple[int, int, float, float]] = []
        while len(out) < most:
            each: dict[tuple[int, int], list[_Prediction]] = {}
            for own in self.found:
                for cell, prediction in own.items():
                    each.setdefault(cell, []).append(prediction)
            combined = [(cell, *_combined(own)) for cell, own in each.items()]
            least = _BEYOND * self.floor
            combined = [c for c in combined if abs(c[1]) >= max(_WORTH * c[2], least)]
            # A large slip at a steep end comes before a small one where all is flat.
            combined.sort(key=lambda c: (-(c[1] ** 2) / c[2], c[0]))
            # Where the measure rises without it the point is not what spoils its lines.
            gains = (
                c
                for c in combined
                if self.gain(c[0][0], {c[0]: self.data[c[0][0]][c[0][1]] - c[1]}) > 0
            )
            best = next(gains, None)
            if best is None:
                break
            (index, axis), off, error = best
            out.append((index, axis, off, error))
            self.gone.add(index)
            for k, line in enumerate(self.lines):
                if index in line:
                    self.found[k] = self._line(line)
        return out

    def _span(self, points: list[int], axis: int) -> float:
        column = self.columns[axis]
        own = [column[i] for i in points]
        return max(own) - min(own)

    def neighbours(self, index: int, axis: int) -> list[int]:
        """Neighbours of a point on the lines along which the coordinate varies."""
        out = []
        for line in self.lines:
            if index in line and self._span(line, axis) > 0:
                k = line.index(index)
                out += [line[j] for j in (k - 1, k + 1) if 0 <= j < len(line)]
        return out

    def gain(self, index: int, values: dict[tuple[int, int], float]) -> float:
        """Relative reduction of the squared third differences near a point by other values."""
        before = after = 0.0
        axes = {axis for _, axis in values}
        for line in self.lines:
            if index in line and len(line) > _SIDE:
                at = line.index(index)
                own = [self.data[i] for i in line]
                moved = list(own)
                for (point, axis), value in values.items():
                    for k, i in enumerate(line):
                        if i == point:
                            moved[k] = [*moved[k][:axis], value, *moved[k][axis + 1 :]]
                for axis in axes:
                    before += _third(own, axis, at)
                    after += _third(moved, axis, at)
        return 1 - after / before if before > 0 else 0.0

    def _line(self, own: list[int]) -> dict[tuple[int, int], _Prediction]:
        closed = len(own) > 1 and own[0] == own[-1]
        ring = own[:-1] if closed else own
        varies = [axis for axis in range(3) if self._span(ring, axis) > 0]
        out: dict[tuple[int, int], _Prediction] = {}
        for at, index in enumerate(ring):
            if index in self.gone:
                continue
            for axis in varies:
                if "xyz"[axis] in self.axes[index]:
                    prediction = self._predicted(ring, at, axis, closed)
                    if prediction is not None:
                        out[index, axis] = prediction
        return out

    def _predicted(self, own: list[int], at: int, axis: int, closed: bool) -> _Prediction | None:
        """A point from its neighbours on a line, over the coordinate that is held."""
        n = len(own)
        order = range(1, n // 2 + 1) if closed else range(1, n)

        def side(way: int) -> list[int]:
            kept: list[int] = []
            for k in order:
                place = at + way * k
                if not closed and not 0 <= place < n:
                    break
                if own[place % n] not in self.gone:
                    kept.append(own[place % n])
                if len(kept) == _SIDE:
                    break
            return kept

        low, high = side(-1)[::-1], side(1)
        if len(low) < _LEAST or len(high) < _LEAST:
            return None
        near = low[-_LEAST:] + high[:_LEAST]
        held = max((a for a in range(3) if a != axis), key=lambda a: self._span(near, a))
        here, value = self.columns[held][own[at]], self.columns[axis][own[at]]

        def numbers(points: list[int]) -> tuple[list[float], list[float]]:
            along, across = self.columns[held], self.columns[axis]
            return [along[i] - here for i in points], [across[i] for i in points]

        t, v = numbers(near)
        if not _monotone(t, _LEAST):
            return None
        size = max(map(abs, t))
        t = [x / size for x in t]
        guesses = [_at_zero(t, v), 0.5 * (_at_zero(t[:3], v[:3]) + _at_zero(t[1:], v[1:]))]
        wide = low + high
        s, w = numbers(wide)
        if len(wide) > 4 and _monotone(s, len(low)):
            s = [x / size for x in s]
            guesses += [_at_zero(s, w), _fitted(s, w)]
        middle = median(guesses)
        sides = [numbers(low), numbers(high)]
        if _is_knuckle(sides, value, middle):
            return None
        slope = _slope(t, v) / size
        noise = self.floor * math.hypot(1.0, _SLOPE * slope)
        return _Prediction(value - middle, math.hypot(max(guesses) - min(guesses), noise))


def _is_knuckle(sides: list[tuple[list[float], list[float]]], value: float, middle: float) -> bool:
    """True if extrapolation from each side meets the point, and interpolation misses it."""
    if any(len(t) < _SIDE for t, _ in sides):
        return False
    ends = []
    for t, v in sides:
        # No side has its quadratic and its line on different sides of the point by more.
        if not _monotone(t, 0 if t[-1] * t[0] > 0 and abs(t[0]) < abs(t[-1]) else len(t)):
            return False
        inner = sorted(range(len(t)), key=lambda k: abs(t[k]))[:2]
        guesses = [_at_zero(t, v), _at_zero([t[k] for k in inner], [v[k] for k in inner])]
        ends.append(min(abs(value - guess) for guess in guesses))
    return max(ends) < _KNUCKLE * abs(value - middle)


def _combined(own: list[_Prediction]) -> tuple[float, float]:
    """Combined prediction of several lines, weighted by their errors, uncertain if they differ."""
    weights = [1 / p.error**2 for p in own]
    total = sum(weights)
    mean = sum(w * p.off for w, p in zip(weights, own, strict=True)) / total
    differ = 1.0
    if len(own) > 1:
        spread = sum(w * (p.off - mean) ** 2 for w, p in zip(weights, own, strict=True))
        differ = max(1.0, spread / (len(own) - 1))
    return mean, math.sqrt(differ / total)


def _monotone(t: list[float], before: int) -> bool:
    """True if positions along a line, counted from the point itself, are monotone with it."""
    pairs = list(pairwise([*t[:before], 0.0, *t[before:]]))
    return all(a < b for a, b in pairs) or all(a > b for a, b in pairs)


def _at_zero(t: list[float], v: list[float]) -> float:
    """The polynomial through all points at 0, by Lagrange's formula."""
    total = 0.0
    for i, (a, value) in enumerate(zip(t, v, strict=True)):
        factor = value
        for j, b in enumerate(t):
            if j != i:
                factor *= b / (b - a)
        total += factor
    return total


def _fitted(t: list[float], v: list[float]) -> float:
    """The cubic of least squares at 0, nearer points weighed more."""
    weight = 1 / (1 + np.abs(t))
    columns = np.vander(t, 4) * weight[:, None]
    return float(np.linalg.lstsq(columns, np.asarray(v) * weight, rcond=None)[0][-1])


def _slope(t: list[float], v: list[float]) -> float:
    """The size of the slope at 0 of the quadratic of least squares."""
    columns = np.vander(t, 3)
    return abs(float(np.linalg.lstsq(columns, np.asarray(v), rcond=None)[0][1]))


def _third(points: list[list[float]], axis: int, at: int) -> float:
    """Squared third divided differences of a coordinate in which a point has part, in sum."""
    t = [0.0]
    for p, q in pairwise(points):
        t.append(t[-1] + max(math.dist(p, q), 1e-300))
    first = max(at - _SIDE, 0)
    near = slice(first, at + _SIDE + 1)
    t, v = [x / t[-1] for x in t[near]], [p[axis] for p in points[near]]
    for order in range(1, 4):
        v = [(b - a) / max(t[k + order] - t[k], 1e-300) for k, (a, b) in enumerate(pairwise(v))]
    return sum(x * x for x in v)


def _shown(value: float, like: str) -> str:
    """A reading in the notation of the cell."""
    if notation(like) == "eighths":
        return sixteenths(value)
    digits = len(like.replace(",", ".").partition(".")[2])
    text = f"{value:.{digits}f}" if re.fullmatch(r"[+-]?[\d.,]+", like) else f"{value:.9g}"
    return text.replace(".", ",") if "," in like else text


def _slips(text: str, value: float) -> list[tuple[float, str]]:
    """Readings that a single writing error turns into this one."""
    out: list[tuple[float, str]] = [(-value, "the sign")]
    found = re.fullmatch(r"[-\u2212]?(\d+)-(\d+)-(\d+)([+\u00bd-]?)", text)
    if found or notation(text) == "feet":
        for step, slip in ((12.0, "a foot"), (1.0, "an inch"), (2.0, "two inches")):
            out += [(value - step, slip), (value + step, slip)]
        for eighths in range(1, 8):
            out += [(value - eighths / 8, "eighths"), (value + eighths / 8, "eighths")]
    if found:
        feet, inches, eighths = (int(found[k]) for k in (1, 2, 3))
        swapped = 12 * feet + eighths + inches / 8
        out.append((swapped, "inches and eighths swapped"))
        return out
    bare = text.replace(",", ".").lstrip("+-")
    if not re.fullmatch(r"\d*\.?\d*", bare) or not any(c.isdigit() for c in bare):
        return out
    sign = -1.0 if value < 0 else 1.0
    digits = [k for k, c in enumerate(bare) if c.isdigit()]
    for k in digits:
        for other in "0123456789":
            if other != bare[k]:
                out.append((sign * float(bare[:k] + other + bare[k + 1 :]), "a digit"))
    for a, b in pairwise(digits):
        if bare[a] != bare[b]:
            own = list(bare)
            own[a], own[b] = own[b], own[a]
            out.append((sign * float("".join(own)), "two digits swapped"))
    out += [(value / 10, "the decimal point"), (value * 10, "the decimal point")]
    return out


def _meant(text: str, value: float, expected: float, error: float) -> tuple[float | None, str]:
    """The most likely intended reading, and the writing error."""
    best: tuple[float, float | None, str] = (_WITHIN**2, None, "")
    for reading, slip in _slips(text, value):
        if reading == value:
            continue
        cost = ((reading - expected) / error) ** 2 + _COSTS[slip]
        if cost < best[0] and abs(reading - expected) < 0.5 * abs(value - expected):
            best = (cost, reading, slip)
    return best[1], best[2]


explain(globals())
