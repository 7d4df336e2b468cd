"""Random bodies of sets, as engineers draw them: plates with holes, pipes, tees, turned parts.

Each is a text of the language with a set `s` and its body `b`, at any place and, for half of
them, any angle.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.random import Generator

Numbers = tuple[float, ...]


class Workshop:
    """Primitives as texts, in axes of its own."""

    def __init__(self, rng: Generator) -> None:
        self.rng = rng
        self.lines: list[str] = []
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        turn[:, 0] *= np.linalg.det(turn)
        self.turn = turn if rng.random() < 0.5 else np.eye(3)
        self.place = rng.uniform(-3, 3, 3)

    def vector(self, v: Numbers) -> str:
        return "{" + ", ".join(repr(float(x)) for x in self.turn @ np.array(v)) + "}"

    def point(self, p: Numbers) -> str:
        return "{" + ", ".join(repr(float(x)) for x in self.turn @ np.array(p) + self.place) + "}"

    def line(self, a: Numbers, b: Numbers) -> str:
        name = f"l{len(self.lines)}"
        self.lines.append(f"Line {name}({self.point(a)}, {self.point(b)});")
        return name

    def half(self, normal: Numbers, point: Numbers) -> str:
        return f"set(plane({self.vector(normal)}, {self.point(point)}))"

    def box(self, low: Numbers, high: Numbers) -> str:
        sides = []
        for axis in range(3):
            unit = tuple(float(k == axis) for k in range(3))
            sides += [self.half(unit, high), self.half(tuple(-x for x in unit), low)]
        return "(" + " & ".join(sides) + ")"

    def cylinder(self, a: Numbers, b: Numbers, radius: float) -> str:
        return f"set(cylinder({self.line(a, b)}, {float(radius)!r}))"

    def rod(self, a: Numbers, b: Numbers, radius: float) -> str:
        along = tuple(q - p for p, q in zip(a, b, strict=True))
        back = tuple(-x for x in along)
        return f"({self.cylinder(a, b, radius)} & {self.half(along, b)} & {self.half(back, a)})"

    def cone(self, apex: Numbers, along: Numbers, angle: float) -> str:
        return f"set(cone({self.line(apex, along)}, {float(angle)!r}))"

    def torus(self, centre: Numbers, along: Numbers, major: float, minor: float) -> str:
        return f"set(torus({self.line(centre, along)}, {float(major)!r}, {float(minor)!r}))"

    def ball(self, centre: Numbers, radius: float) -> str:
        return f"set(sphere({self.point(centre)}, {float(radius)!r}))"

    def unit(self) -> tuple[float, float, float]:
        x, y, z = self.rng.normal(size=3)
        size = math.sqrt(x * x + y * y + z * z)
        return x / size, y / size, z / size


def times(v: Numbers, factor: float) -> Numbers:
    return tuple(factor * x for x in v)


def plate(w: Workshop) -> str:
    """A plate with plain, stepped and countersunk holes."""
    r = w.rng
    long, wide, thick = r.uniform(3, 8), r.uniform(2, 5), r.uniform(0.4, 1.2)
    text = w.box((0, 0, 0), (long, wide, thick))
    holes: list[Numbers] = []
    for _ in range(r.integers(1, 6)):
        q, x, y = r.uniform(0.15, 0.45), r.uniform(0.6, long - 0.6), r.uniform(0.6, wide - 0.6)
        if any(math.hypot(x - u, y - v) < q + p + 0.1 for u, v, p in holes):
            continue
        holes.append((x, y, q))
        low, high = (x, y, -1.0), (x, y, thick + 1)
        match r.integers(3):
            case 0:
                text += f" - {w.cylinder(low, high, q)}"
            case 1:
                text += f" - {w.cylinder(low, high, 0.6 * q)}"
                text += f" - {w.rod((x, y, 0.6 * thick), high, q)}"
            case _:
                text += f" - {w.cylinder(low, high, 0.5 * q)}"
                apex = (x, y, thick - q)
                sink = f"{w.cone(apex, (x, y, thick), math.pi / 2)} & {w.half((0, 0, -1), apex)}"
                text += f" - ({sink})"
    return text


def pipe(w: Workshop) -> str:
    """A pipe, often with a branch."""
    r = w.rng
    radius, long, wall = r.uniform(0.6, 1.5), r.uniform(3, 6), r.uniform(0.15, 0.4)
    bore = w.cylinder((0, 0, -1), (0, 0, long + 1), radius - wall)
    body = w.rod((0, 0, 0), (0, 0, long), radius)
    if r.random() < 0.4:
        return f"{body} - {bore}"
    inner, slope = r.uniform(0.2, 0.8) * (radius - wall), r.uniform(-0.5, 0.5)
    start, end = (0.0, 0.0, long / 2), (3 * radius, 0.0, long / 2 + 3 * radius * slope)
    branch = w.rod(start, end, inner + 0.1)
    hole = f"({w.cylinder(start, end, inner)} & {w.half((-1, 0, -slope), start)})"
    return f"({body} | {branch}) - {bore} - {hole}"


def tee(w: Workshop) -> str:
    """Two rods, of equal radii in some, the second set off and inclined in some."""
    r = w.rng
    radius = r.uniform(0.7, 1.3)
    own = radius * (r.uniform(0.3, 1) if r.random() < 0.7 else 1)
    off = r.uniform(0, 0.4) * (radius - own)
    slope = r.uniform(-0.6, 0.6) if r.random() < 0.5 else 0
    branch = w.rod((0, off, 0), (4, off, 4 * slope), own)
    return f"{w.rod((0, 0, -3), (0, 0, 3), radius)} | {branch}"


def chamfered(w: Workshop) -> str:
    """A block cut by planes at any angle."""
    text = w.box((0, 0, 0), (4, 3, 2))
    for _ in range(w.rng.integers(1, 6)):
        n = w.unit()
        reach = abs(n[0]) * 2 + abs(n[1]) * 1.5 + abs(n[2])
        share = w.rng.uniform(0.55, 0.9) * reach
        point = tuple(c + x * share for c, x in zip((2, 1.5, 1), n, strict=True))
        text += f" & {w.half(n, point)}"
    return text


def cut_ball(w: Workshop) -> str:
    """A ball with flats, often bored."""
    r = w.rng
    text = w.ball((0, 0, 0), 1.5)
    for _ in range(r.integers(1, 4)):
        n = w.unit()
        text += f" & {w.half(n, times(n, r.uniform(0.5, 1.2)))}"
    if r.random() < 0.6:
        n = w.unit()
        text = f"({text}) - {w.cylinder(times(n, -3), times(n, 3), r.uniform(0.2, 0.5))}"
    return text


def ring(w: Workshop) -> str:
    """A torus: cut across its axis or at any angle, bored, or a bend between two rods."""
    r = w.rng
    major, minor = r.uniform(1.5, 3), r.uniform(0.3, 0.9)
    text = w.torus((0, 0, 0), (0, 0, 1), major, minor)
    match r.integers(4):
        case 0:
            return f"{text} & {w.half((0, 0, 1), (0, 0, r.uniform(-0.5, 0.8) * minor))}"
        case 1:
            n = w.unit()
            return f"{text} & {w.half(n, times(n, r.uniform(-0.3, 0.6) * major))}"
        case 2:
            bore = minor * r.uniform(0.3, 0.7)
            return f"{text} - {w.cylinder((major, 0, -3), (major, 0.3, 3), bore)}"
    quarter = f"{text} & {w.half((-1, 0, 0), (0, 0, 0))} & {w.half((0, -1, 0), (0, 0, 0))}"
    ends = [
        w.rod((major, 0, 0), (major, -2, 0), minor),
        w.rod((0, major, 0), (-2, major, 0), minor),
    ]
    return f"({quarter}) | {ends[0]} | {ends[1]}"


def turned(w: Workshop) -> str:
    """A stepped shaft, with a point, a hollow and a hole across in some."""
    r = w.rng
    a = r.uniform(0.5, 1)
    text = f"{w.rod((0, 0, 0), (0, 0, 1), a)} | "
    text += w.rod((0, 0, 1), (0, 0, 2.5), a * r.uniform(0.4, 0.8))
    if r.random() < 0.6:
        cone = w.cone((0, 0, 2.5 + a), (0, 0, 0), r.uniform(0.5, 1.2))
        top = w.half((0, 0, 1), (0, 0, 2.5 + a * r.uniform(0.2, 1.2)))
        text += f" | ({cone} & {w.half((0, 0, -1), (0, 0, 2))} & {top})"
    if r.random() < 0.5:
        text = f"({text}) - {w.ball((0, 0, 0), 0.5 * a)}"
    if r.random() < 0.5:
        text = f"({text}) - {w.cylinder((1.1 * a, -2, 0.5), (1.1 * a, 2, 0.5), 0.3)}"
    return text


def hollow(w: Workshop) -> str:
    """A block with two cavities."""
    r = w.rng
    ball = w.ball((1.2, 1.3, 1), r.uniform(0.3, 0.7))
    rod = w.rod((2.7, 0.8, 0.6), (3, 2.2, 1.3), r.uniform(0.15, 0.3))
    return f"{w.box((0, 0, 0), (4, 3, 2))} - {ball} - {rod}"


def slotted(w: Workshop) -> str:
    """A plate with a slot of round ends."""
    long, half = w.rng.uniform(1, 3), w.rng.uniform(0.3, 0.7)
    ends = [w.cylinder((x, 0, -1), (x, 0, 2), half) for x in (0, long)]
    slot = f"{w.box((0, -half, -1), (long, half, 2))} | {ends[0]} | {ends[1]}"
    return f"{w.box((-2, -1.5, 0), (long + 2, 1.5, 1))} - ({slot})"


def rounded(w: Workshop) -> str:
    """A block with four round edges: planes touch cylinders."""
    q = w.rng.uniform(0.2, 0.6)
    rods = [w.rod((x, y, 0), (x, y, 2), q) for x in (q, 4 - q) for y in (q, 3 - q)]
    boxes = [w.box((0, q, 0), (4, 3 - q, 2)), w.box((q, 0, 0), (4 - q, 3, 2))]
    return " | ".join(boxes + rods)


def capsule(w: Workshop) -> str:
    """A rod with round ends, bored across in some."""
    r = w.rng
    q, long = r.uniform(0.4, 1), r.uniform(1, 4)
    text = f"{w.rod((0, 0, 0), (0, 0, long), q)} | {w.ball((0, 0, 0), q)}"
    text += f" | {w.ball((0, 0, long), q)}"
    if r.random() < 0.5:
        bore = w.cylinder((-3, 0, long / 2), (3, 0.1, long / 2 + 0.3), 0.4 * q)
        text = f"({text}) - {bore}"
    return text


KINDS: list[Callable[[Workshop], str]] = [
    plate, pipe, tee, chamfered, cut_ball, ring, turned, hollow, slotted, rounded, capsule,
]  # fmt: skip


def program(seed: int) -> str:
    """A body of the kind that the seed's remainder says."""
    workshop = Workshop(np.random.default_rng(seed))
    text = KINDS[seed % len(KINDS)](workshop)
    return "\n".join([*workshop.lines, f"set s = {text};", "SetBody b(s);"])
