"""Volume, area and centroid of random parts by quadrature of their faces, without a modeller.

A part is a tree of convex bodies of planes, cylinders, cones and rings. Each carrier is run through
by its rulings: parallel lines of a plane, lines of a cylinder or cone, circles of a ring. A ruling
meets the other carriers at roots of polynomials; between two of them it is on the boundary if the
body is on one side of it only. Integrals along the ruling are exact, those across are Gauss'
between the places where the pattern of the ruling changes, which are bisected.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

#: Rulings at first; features that are thinner are found where integrals do not settle.
FIRST = 96

_GAUSS = {n: np.polynomial.legendre.leggauss(n) for n in (4, 20, 32, 40)}


@dataclass(frozen=True)
class Carrier:
    """A surface: where its function is negative is inside."""

    kind: str
    #: Where its axis passes, or a point of a plane.
    at: np.ndarray
    #: The axis or the normal.
    way: np.ndarray
    #: A cylinder's radius, a cone's at its place and growth along its way, a ring's two.
    size: tuple[float, ...] = ()

    def value(self, p: np.ndarray) -> np.ndarray:
        """A polynomial with the surface (and a cone's other half) as its roots."""
        q = p - self.at
        z = q @ self.way
        if self.kind == "plane":
            return z
        square = np.einsum("...i,...i", q, q)
        if self.kind == "ring":
            big, small = self.size
            return (square + big * big - small * small) ** 2 - 4 * big * big * (square - z * z)
        radius, grows = self.size
        return square - z * z - (radius + grows * z) ** 2

    def inside(self, p: np.ndarray) -> np.ndarray:
        """Whether points are inside."""
        if self.kind == "plane":
            return self.value(p) < 0
        if self.kind == "ring":
            return self.value(p) < 0
        z = (p - self.at) @ self.way
        return (self.value(p) < 0) & (self.size[0] + self.size[1] * z > 0)

    def same(self, other: Carrier) -> bool:
        """Whether two are one surface."""
        if self is other:
            return True
        if self.kind != other.kind or abs(abs(self.way @ other.way) - 1) > 1e-12:
            return False
        off = other.at - self.at
        along = off @ self.way
        if self.kind == "plane":
            return bool(abs(along) < 1e-9)
        across = float(np.linalg.norm(off - along * self.way))
        if self.kind == "ring":
            return bool(np.linalg.norm(off) < 1e-9) and np.allclose(
                self.size, other.size, atol=1e-9
            )
        sign = float(np.sign(self.way @ other.way))
        grows = abs(self.size[1] - sign * other.size[1]) < 1e-12
        radius = self.size[0] + self.size[1] * along
        return bool(across < 1e-9 and grows and abs(radius - other.size[0]) < 1e-9)


#: A convex body of carriers, or two joined: ("UNION", a, b), ("CUT", a, b), ("COMMON", a, b).
Body = tuple


def convex(*carriers: Carrier) -> Body:
    """What is inside of all."""
    return ("ALL", *carriers)


def joined(word: str, a: Body, b: Body) -> Body:
    """Two bodies as one."""
    return (word, a, b)


def _turns(body: Body, own: Carrier, known: dict[int, int]) -> None:
    """Which carriers of a body are a given one: 1, or -1 where inside and outside change."""
    word, *parts = body
    for x in parts:
        if word != "ALL":
            _turns(x, own, known)
        elif x.same(own):
            known[id(x)] = -1 if x.kind == "plane" and x.way @ own.way < 0 else 1


def holds(body: Body, p: np.ndarray, known: dict[int, int], side: int) -> np.ndarray:
    """Whether the body is beside points of a carrier, on its outer side (1) or inner one (-1)."""
    word, *parts = body
    if word == "ALL":
        found = np.ones(len(p), dtype=bool)
        for c in parts:
            turn = known.get(id(c))
            found &= c.inside(p) if turn is None else side * turn < 0
        return found
    a, b = (holds(x, p, known, side) for x in parts)
    return {"UNION": a | b, "CUT": a & ~b, "COMMON": a & b}[word]


def carriers(body: Body) -> list[Carrier]:
    """Its surfaces, each once."""
    word, *parts = body
    found = parts if word == "ALL" else [c for x in parts for c in carriers(x)]
    out: list[Carrier] = []
    for c in found:
        if not any(c.same(o) for o in out):
            out.append(c)
    return out


def moved(body: Body, turn: np.ndarray, shift: np.ndarray) -> Body:
    """Turned about the origin and shifted."""
    word, *parts = body
    if word == "ALL":
        return (word, *(Carrier(c.kind, turn @ c.at + shift, turn @ c.way, c.size) for c in parts))
    return (word, *(moved(x, turn, shift) for x in parts))


# -- bodies -----------------------------------------------------------------------------------


def plane(at: Sequence[float], outward: Sequence[float]) -> Carrier:
    """A plane by a point and what is outside."""
    way = np.array(outward, dtype=float)
    return Carrier("plane", np.array(at, dtype=float), way / np.linalg.norm(way))


def polytope(faces: Sequence[Sequence[Sequence[float]]]) -> Body:
    """A convex polyhedron of faces in any order of their corners."""
    middle = np.mean([p for f in faces for p in f], axis=0)
    out = []
    for f in np.array([f[:3] for f in faces], dtype=float):
        normal = np.cross(f[1] - f[0], f[2] - f[0])
        out.append(plane(f[0], normal * np.sign(normal @ (f[0] - middle))))
    return convex(*out)


def block_of(low: Sequence[float], high: Sequence[float]) -> Body:
    """A box."""
    axes = np.eye(3)
    return convex(*(plane(low, -a) for a in axes), *(plane(high, a) for a in axes))


def column(polygon: Sequence[tuple[float, float]], low: float, high: float) -> Body:
    """A convex polygon of x and z from y = low to y = high."""
    ends = [[(x, y, z) for x, z in polygon] for y in (low, high)]
    n = len(polygon)
    sides = [[ends[0][k], ends[0][(k + 1) % n], ends[1][(k + 1) % n], ends[1][k]] for k in range(n)]
    return polytope([*ends, *sides])


def turned_about_z(
    at: Sequence[float], radius: float, grows: float, low: float, high: float
) -> Body:
    """A cylinder or a part of a cone: the radius at `at`, and how it grows along z."""
    side = Carrier("cone", np.array(at, dtype=float), np.array([0.0, 0.0, 1.0]), (radius, grows))
    return convex(side, plane((0, 0, low), (0, 0, -1)), plane((0, 0, high), (0, 0, 1)))


def ring_about_z(at: Sequence[float], big: float, small: float) -> Body:
    """A ring."""
    return convex(Carrier("ring", np.array(at, dtype=float), np.array([0.0, 0, 1]), (big, small)))


# -- rulings ----------------------------------------------------------------------------------


def _frame(way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two directions at right angles to one, not along the axes."""
    u = np.cross(way, [0.5403, 0.8415, 0.2903])
    if np.linalg.norm(u) < 0.1:
        u = np.cross(way, [0.8415, -0.2903, 0.5403])
    u = u / np.linalg.norm(u)
    return u, np.cross(way, u)


def line_roots(o: np.ndarray, d: np.ndarray, c: Carrier, reach: float) -> list[float]:
    """Where a line meets a plane, cylinder or cone; none where it lies in it."""
    q = o - c.at
    z, w = float(q @ c.way), float(d @ c.way)
    if c.kind == "plane":
        return [] if abs(w) < 1e-13 else [-z / w]
    radius, grows = c.size
    r, g = radius + grows * z, grows * w
    square = float(d @ d) - w * w - g * g
    half = float(q @ d) - z * w - r * g
    rest = float(q @ q) - z * z - r * r
    if max(abs(square), abs(half) / reach, abs(rest) / reach**2) < 1e-11:
        return []
    if abs(square) < 1e-13:
        return [] if abs(half) < 1e-13 else [-rest / (2 * half)]
    root = half * half - square * rest
    if root <= 0:
        return []
    x = -(half + math.copysign(math.sqrt(root), half))
    return [x / square, *([rest / x] if x else [])]


class _Ruled:
    """A carrier by its rulings: the span across, and along each."""

    def __init__(self, carrier: Carrier, body: Body, middle: np.ndarray, reach: float):
        self.carrier = carrier
        self.known: dict[int, int] = {}
        _turns(body, carrier, self.known)
        self.u, self.v = _frame(carrier.way)
        self.middle, self.reach = middle, reach
        if carrier.kind == "plane":
            foot = middle - carrier.way * ((middle - carrier.at) @ carrier.way)
            self.foot = foot
            self.across, self.along = (-reach, reach), (-reach, reach)
        elif carrier.kind == "ring":
            self.across, self.along = (0.0, 2 * math.pi), (0.0, 2 * math.pi)
        else:
            z = float((middle - carrier.at) @ carrier.way)
            low, high = z - reach, z + reach
            radius, grows = carrier.size
            # Up to the point of the cone.
            if grows > 0:
                low = max(low, -radius / grows)
            elif grows < 0:
                high = min(high, -radius / grows)
            self.across, self.along = (0.0, 2 * math.pi), (low, high)

    def points(self, s: float, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points of a ruling, outward normals, and the area for a step of s and t."""
        c = self.carrier
        t = np.atleast_1d(np.asarray(t, dtype=float))
        if c.kind == "plane":
            p = self.foot + self.u * s + self.v * t[:, None]
            return p, np.broadcast_to(c.way, p.shape), np.ones(len(t))
        out = self.u * math.cos(s) + self.v * math.sin(s)
        if c.kind == "ring":
            big, small = c.size
            n = out * np.cos(t)[:, None] + c.way * np.sin(t)[:, None]
            p = c.at + out * big + n * small
            return p, n, small * (big + small * np.cos(t))
        radius, grows = c.size
        r = radius + grows * t
        slant = math.hypot(1.0, grows)
        n = (out - c.way * grows) / slant
        p = c.at + c.way * t[:, None] + out * r[:, None]
        return p, np.broadcast_to(n, p.shape), r * slant

    def crossings(self, s: float, others: Sequence[Carrier]) -> list[tuple[float, int]]:
        """Where a ruling meets other carriers."""
        low, high = self.along
        out: list[tuple[float, int]] = []
        for k, other in enumerate(others):
            if other is self.carrier:
                continue
            for t in self._roots(s, other):
                if low < t < high:
                    out.append((t, k))
        return sorted(out)

    def _roots(self, s: float, other: Carrier) -> list[float]:
        if self.carrier.kind != "ring" and other.kind != "ring":
            o, d = self.points(s, np.array([0.0, 1.0]))[0]
            return line_roots(o, d - o, other, self.reach)
        low, high = self.along
        degree = {"plane": 1, "cone": 2, "ring": 4}[other.kind]
        scale = self.reach ** (degree if degree < 4 else 4)
        if self.carrier.kind == "ring":
            count = 4 * degree + 4
            t = 2 * math.pi * np.arange(count) / count
            f = other.value(self.points(s, t)[0])
            coefficients = np.fft.fft(f) / count
            laurent = np.array([coefficients[k] for k in range(degree, -degree - 1, -1)])
            if np.abs(laurent).max() < 1e-11 * scale:
                return []
            z = np.roots(laurent)
            near = z[np.abs(np.abs(z) - 1) < 1e-5]
            guesses = np.mod(np.angle(near), 2 * math.pi)
        else:
            middle, half = (low + high) / 2, (high - low) / 2
            t = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
            f = other.value(self.points(s, middle + half * t)[0])
            poly = np.polynomial.chebyshev.Chebyshev.fit(t, f, degree, domain=[-1, 1])
            if np.abs(poly.coef).max() < 1e-11 * scale:
                return []
            roots = poly.roots()
            real = roots[np.abs(roots.imag) < 1e-5].real
            guesses = middle + half * real
        out: list[float] = []
        for t in guesses:
            # Polished; what was a near miss goes astray and is left out.
            x = float(t)
            for _ in range(4):
                h = 1e-6 * (high - low)
                a, b, c = other.value(self.points(s, np.array([x - h, x, x + h]))[0])
                slope = (c - a) / (2 * h)
                if slope == 0:
                    break
                x -= float(np.clip(b / slope, -1e-3 * (high - low), 1e-3 * (high - low)))
            miss = abs(float(other.value(self.points(s, np.array([x]))[0])[0]))
            if miss < 1e-11 * scale and all(abs(x - o) > 1e-13 * (high - low) for o in out):
                out.append(x)
        return out


#: What is integrated: volume, area, and volume times the centroid.
def _integrand(p: np.ndarray, n: np.ndarray, middle: np.ndarray) -> np.ndarray:
    q = p - middle
    return np.column_stack(
        [
            np.einsum("ij,ij->i", q, n) / 3,
            np.ones(len(p)),
            *(q[:, i] ** 2 * n[:, i] / 2 for i in range(3)),
        ]
    )


def _line(
    ruled: _Ruled, s: float, body: Body, others: Sequence[Carrier], middle: np.ndarray
) -> tuple[np.ndarray, tuple]:
    """The integral along a ruling, and its pattern."""
    low, high = ruled.along
    hits = ruled.crossings(s, others)
    stops = [low, *(t for t, _ in hits), high]
    names = [-1, *(k for _, k in hits), -1]
    middles = np.array([(a + b) / 2 for a, b in itertools.pairwise(stops)])
    p, n, _ = ruled.points(s, middles)
    within, without = (holds(body, p, ruled.known, side) for side in (-1, 1))
    total, pattern = np.zeros(5), []
    x, w = _GAUSS[32 if ruled.carrier.kind == "ring" else 4]
    for k in np.flatnonzero(within != without):
        a, b = stops[k], stops[k + 1]
        sign = 1.0 if within[k] else -1.0
        t = (a + b) / 2 + (b - a) / 2 * x
        p, n, area = ruled.points(s, t)
        rows = _integrand(p, n * sign, middle)
        total += (rows * (w * area * (b - a) / 2)[:, None]).sum(axis=0)
        pattern.append((names[k], names[k + 1], sign))
    return total, tuple(pattern)


def _across(
    line: Callable[[float], tuple[np.ndarray, tuple]], low: float, high: float, scale: np.ndarray
) -> np.ndarray:
    """The integral across the rulings."""
    s = low + (high - low) * (np.arange(FIRST + 1) + 0.137 * np.sin(np.arange(FIRST + 1))) / FIRST
    s[0], s[-1] = low, high
    patterns = [line(x)[1] for x in s]
    cuts = [low]
    for k in range(FIRST):
        cuts += _changes(line, s[k], s[k + 1], patterns[k], patterns[k + 1], 6)
    cuts.append(high)
    total = np.zeros(5)
    for a, b in itertools.pairwise(cuts):
        if b - a > 1e-13 * (high - low):
            total += _piece(line, a, b, scale, 0)
    return total


def _changes(
    line: Callable, a: float, b: float, left: tuple, right: tuple, deeper: int
) -> list[float]:
    """Where the pattern changes between two rulings."""
    if left == right:
        return []
    first, last = a, b
    while last - first > 4e-16 * max(abs(first), abs(last), 1e-3):
        middle = (first + last) / 2
        if middle in (first, last):
            break
        if line(middle)[1] == left:
            first = middle
        else:
            last = middle
    # Another one may come after the first.
    beyond = last + 1e-12 * (b - a) + 1e-14
    rest = (
        []
        if deeper == 0 or beyond >= b
        else _changes(line, beyond, b, line(beyond)[1], right, deeper - 1)
    )
    return [last, *rest]


def _piece(line: Callable, a: float, b: float, scale: np.ndarray, depth: int) -> np.ndarray:
    """Between two changes; ends like roots of the step are smooth in the angle."""
    sums, patterns = [], set()
    for n in (20, 40):
        x, w = _GAUSS[n]
        angle = (x + 1) * math.pi / 2
        rows = []
        for f in angle:
            row, pattern = line((a + b) / 2 - (b - a) / 2 * math.cos(f))
            rows.append(row)
            patterns.add(pattern)
        weight = w * math.pi / 2 * (b - a) / 2 * np.sin(angle)
        sums.append((np.array(rows) * weight[:, None]).sum(axis=0))
    if (np.abs(sums[1] - sums[0]) <= 1e-12 * scale).all() or depth >= 7 or b - a < 1e-11:
        return sums[1]
    middle = (a + b) / 2
    if len(patterns) > 1:
        ends = [line(x)[1] for x in (a + 1e-9 * (b - a), middle, b - 1e-9 * (b - a))]
        cuts = _changes(line, a, middle, ends[0], ends[1], 6)
        cuts += _changes(line, middle, b, ends[1], ends[2], 6)
        stops = [a, *(x for x in cuts if a < x < b), b]
        if len(stops) == 2:
            stops = [a, middle, b]
    else:
        stops = [a, middle, b]
    return sum(
        (_piece(line, x, y, scale, depth + 1) for x, y in itertools.pairwise(stops)),
        np.zeros(5),
    )


def measured(body: Body, middle: Sequence[float], reach: float) -> np.ndarray:
    """Volume, area and centroid of a body within a ball."""
    centre = np.array(middle, dtype=float)
    all_ = carriers(body)
    scale = np.array([reach**3, reach**2, *[reach**4] * 3]) * 1e-2
    total = np.zeros(5)
    for c in all_:
        ruled = _Ruled(c, body, centre, reach)
        low, high = ruled.across

        def line(s: float, ruled: _Ruled = ruled) -> tuple[np.ndarray, tuple]:
            return _line(ruled, s, body, all_, centre)

        total += _across(line, low, high, scale)
    total[2:] = total[2:] / total[0] + centre
    return total
