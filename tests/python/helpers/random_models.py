"""Ordinary models of ships, platforms and wings, drawn at random and closed.

Each is a text with one parameter `w`, a stretch of the breadth (1 as it is written), so that
derivatives can be asked for; `fine` multiplies the divisions of all surfaces.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.random import Generator


@dataclass
class Drawn:
    """A drawn model."""

    text: str
    #: Heights between which a water level cuts the model.
    low: float
    high: float


class _Text:
    """Statements and fresh names."""

    def __init__(self, header: str) -> None:
        self.lines = [header, "param float w = 1 in [0.5, 2];"]
        self.count = 0

    def name(self, stem: str) -> str:
        self.count += 1
        return f"{stem}{self.count}"

    def point(self, x: float, y: float, z: float) -> str:
        name = self.name("p")
        across = f"{y!r}*w" if y else "0"
        self.lines.append(f"AbsPoint {name}({x!r}, {across}, {z!r});")
        return name

    def points(self, table: Sequence[Sequence[float]]) -> list[str]:
        return [self.point(*map(float, row)) for row in table]

    def add(self, kind: str, arguments: str, stem: str = "c") -> str:
        name = self.name(stem)
        self.lines.append(f"{kind} {name}({arguments});")
        return name

    def spline(self, rng: Generator, points: Sequence[str]) -> str:
        """A curve through or by points, of a kind that is drawn."""
        listed = "{" + ", ".join(points) + "}"
        if len(points) == 2:
            return self.add("Line", ", ".join(points))
        kind = rng.integers(3)
        if kind == 0:
            return self.add("CCurve", listed)
        return self.add("BCurve", f"{listed}, degree = {min(len(points) - 1, int(kind) + 1)}")

    def polyline(self, points: Sequence[str]) -> str:
        if len(points) == 2:
            return self.add("Line", ", ".join(points))
        sides = [self.add("Line", f"{a}, {b}") for a, b in pairwise(points)]
        return self.add("PolyCurve", "{" + ", ".join(sides) + "}")

    def text(self) -> str:
        return "\n".join(self.lines) + "\n"


def _divisions(a: int, b: int, fine: int) -> str:
    return f"divisions = {{{a * fine}, {b * fine}}}"


def chine_hull(rng: Generator, fine: int = 1) -> Drawn:
    """Strips between keel, chines and sheer, with deck and transom; half of it, mirrored."""
    t = _Text('Model info(symmetry = "y", units = "m t");')
    length, half, depth = rng.uniform(8, 40), rng.uniform(1, 4), rng.uniform(1.5, 4)
    chines = int(rng.integers(1, 4))
    stations = int(rng.integers(3, 6))
    stem = t.point(0.0, 0.0, float(depth * rng.uniform(0.5, 0.6)))
    x = np.linspace(0, length, stations)
    fullness = (x / length) ** rng.uniform(0.4, 0.8) * np.where(x < length, 1, rng.uniform(0.6, 1))
    # From keel to sheer: breadths and heights as shares, increasing.
    breadth = np.concatenate([[0], np.sort(rng.uniform(0.35, 0.95, chines)), [1]])
    height = np.concatenate([[-0.5], np.sort(rng.uniform(-0.45, 0.3, chines)), [0.5]])
    curves, ends = [], []
    for k in range(chines + 2):
        rise = rng.uniform(0, 0.15) * (1 - x / length) ** 2
        table = np.column_stack(
            [x, half * breadth[k] * fullness, depth * (height[k] + rise * (k < chines + 1))]
        )
        names = [stem, *t.points(table[1:])]
        curves.append(t.spline(rng, names))
        ends.append(names)
    for a, b in pairwise(curves):
        t.add("RuledSurf", f"{a}, {b}, {_divisions(16, 3, fine)}", "side")
    # Deck: between the sheer and a line in the plane of symmetry below or above it.
    camber = float(rng.choice([0.0, 0.05 * depth]))
    over = [t.point(float(a), 0.0, float(depth * 0.5 + camber)) for a in x[1:]]
    middle = t.spline(rng, [stem, *over])
    t.add("RuledSurf", f"{curves[-1]}, {middle}, {_divisions(16, 3, fine)}", "deck")
    # Transom: from the centre line to the outline of the strips' ends.
    outline = t.polyline([names[-1] for names in ends])
    centre = t.add("Line", f"{ends[0][-1]}, {over[-1]}")
    if camber:
        # The beam's edge belongs to the outline.
        outline = t.polyline([*(names[-1] for names in ends), over[-1]])
    # As many panels as those of the strips, and of the deck, that end there.
    along = 3 * (chines + 1 + bool(camber))
    t.add("RuledSurf", f"{centre}, {outline}, {_divisions(along, 3, fine)}", "transom")
    return Drawn(t.text(), -0.45 * depth, 0.35 * depth)


def round_hull(rng: Generator, fine: int = 1) -> Drawn:
    """A lofted hull of round sections with a transom and a deck; half of it, mirrored."""
    t = _Text('Model info(symmetry = "y", units = "m t");')
    length, half, depth = rng.uniform(8, 40), rng.uniform(1, 4), rng.uniform(1.5, 4)
    count, rows = int(rng.integers(3, 6)), int(rng.integers(3, 6))
    masters, sheer, keel = [], [], []
    for i, s in enumerate(np.linspace(0, 1, count)):
        full = 0.0 if i == 0 else float(np.sin(np.pi * (0.08 + 0.72 * s)) ** 0.7)
        names = []
        for j, v in enumerate(np.linspace(0, 1, rows)):
            low = depth * (0.35 if i == 0 else rng.uniform(0.45, 0.5))
            y = half * full * v ** rng.uniform(0.4, 0.7) if j else 0.0
            z = -low + (depth * 0.5 + low) * v ** rng.uniform(1.2, 2) if j else -low
            if j == rows - 1:
                y, z = half * full, depth * 0.5
            forward = -0.05 * length * v if i == 0 else 0.0
            names.append(t.point(float(length * s + forward), float(y), float(z)))
        masters.append(t.add("BCurve", "{" + ", ".join(names) + "}, degree = 2"))
        keel.append(names[0])
        sheer.append(names[-1])
    kind = ["CLoftSurf", "BLoftSurf"][int(rng.integers(2))]
    t.add(kind, "{" + ", ".join(masters) + f"}}, {_divisions(8, 16, fine)}", "hull")
    # Deck to the centre line straight over the sheer, transom to a line in the plane of symmetry.
    degree = min(3, count - 1)
    listed = "{" + ", ".join(sheer) + "}"
    edge = (
        t.add("CCurve", listed) if kind == "CLoftSurf" else t.add("BCurve", f"{listed}, {degree}")
    )
    centre = t.add("ProjCurve", f'{edge}, "y=0"')
    t.add("RuledSurf", f"{edge}, {centre}, {_divisions(16, 4, fine)}", "deck")
    foot = t.add("ProjCurve", f'{masters[-1]}, "y=0"')
    t.add("RuledSurf", f"{masters[-1]}, {foot}, {_divisions(8, 4, fine)}", "transom")
    return Drawn(t.text(), -0.4 * depth, 0.4 * depth)


def _chains(rng: Generator, corners: int) -> tuple[np.ndarray, np.ndarray]:
    """A convex polygon as two chains between its lowest and its highest corner."""
    angles = np.sort(rng.uniform(0, np.pi, corners))
    right = np.column_stack([np.sin(angles), -np.cos(angles)])
    left = np.column_stack([-np.sin(angles[::-1]), -np.cos(angles[::-1])])[::-1]
    ends = np.array([[0.0, -1.0]]), np.array([[0.0, 1.0]])
    return np.vstack([ends[0], right, ends[1]]), np.vstack([ends[0], left, ends[1]])


def _prism(
    t: _Text, rng: Generator, at: Sequence[float], size: float, length: float, fine: int
) -> None:
    """A prism along x on a convex polygon, of two swept chains and two lids."""
    corners = int(rng.integers(1, 5))
    chains = []
    ends = None
    for chain in _chains(rng, corners):
        table = np.column_stack(
            [np.full(len(chain), at[0]), at[1] + size * chain[:, 0], at[2] + size * chain[:, 1]]
        )
        if ends is None:
            names = t.points(table)
            ends = names[0], names[-1]
        else:
            names = [ends[0], *t.points(table[1:-1]), ends[1]]
        chains.append(t.polyline(names))
    assert ends is not None
    step = t.add("Line", f"{ends[0]}, {t.point(at[0] + length, at[1], at[2] - size)}", "along")
    across = _divisions(4 * (corners + 1), 3, fine)
    along = _divisions(4 * (corners + 1), 6, fine)
    for c in chains:
        t.add("TranSurf", f"{c}, {step}, {along}", "wall")
    t.add("RuledSurf", f"{chains[0]}, {chains[1]}, {across}", "lid")
    far = t.add("AbsPoint", f"{at[0] + length!r}, 0, 0", "q")
    copies = []
    near = t.add("AbsPoint", f"{at[0]!r}, 0, 0", "q")
    for c in chains:
        copies.append(t.add("CopyCurve", f"{c}, {near}, {far}"))
    t.add("RuledSurf", f"{copies[0]}, {copies[1]}, {across}", "lid")


def prisms(rng: Generator, fine: int = 1) -> Drawn:
    """Pontoons: one to three prisms side by side, nothing mirrored."""
    t = _Text('Model info(units = "m t");')
    size = float(rng.uniform(0.5, 2))
    for k in range(int(rng.integers(1, 4))):
        _prism(t, rng, (float(rng.uniform(-1, 1)), 3.0 * size * k, 0.0), size, 12 * size, fine)
    return Drawn(t.text(), -0.8 * size, 0.8 * size)


def platform(rng: Generator, fine: int = 1) -> Drawn:
    """Columns: bodies of revolution about upright axes, a quarter mirrored twice."""
    t = _Text('Model info(symmetry = "xy", units = "m t");')
    for k in range(int(rng.integers(1, 3))):
        x, y = 10.0 * (k + 1), float(rng.uniform(6, 9))
        r, low, high = float(rng.uniform(1, 3)), -float(rng.uniform(5, 9)), 6.0
        foot, head = t.point(x, y, low), t.point(x, y, high)
        axis = t.add("Line", f"{foot}, {head}", "axis")
        # Off the axis by lengths that do not stretch, so that it stays round.
        a = t.add("RelPoint", f"{foot}, {r!r}, 0, 0", "q")
        b = t.add("RelPoint", f"{head}, {r * float(rng.uniform(0.5, 1))!r}, 0, 0", "q")
        m = t.add("RelPoint", f"{foot}, {0.6 * r!r}, 0, {0.5 * (high - low)!r}", "q")
        wall = (
            t.add("Line", f"{a}, {b}")
            if rng.integers(2)
            else t.add("BCurve", f"{{{a}, {m}, {b}}}, 2")
        )
        bottom, top = t.add("Line", f"{foot}, {a}"), t.add("Line", f"{b}, {head}")
        for c in (bottom, wall, top):
            t.add("RevSurf", f"{c}, {axis}, {_divisions(4, 16, fine)}, orientation = 1", "shell")
    return Drawn(t.text(), -4.0, 5.0)


def wing(rng: Generator, fine: int = 1) -> Drawn:
    """A wing from the plane of symmetry to a lid at its tip, with or without a flap behind it."""
    t = _Text('Model info(symmetry = "y", units = "m t");')
    span = float(rng.uniform(3, 9))
    for part in range(int(rng.integers(1, 3))):
        curves: list[list[str]] = [[], [], [], []]
        chord = float(rng.uniform(1, 2)) * (0.4 if part else 1.0)
        x0 = 2.2 * part
        for share in (0.0, 1.0):
            c = chord * (1 - 0.5 * share)
            x, y, z = x0 + 0.3 * share, span * share, 0.1 * part + 0.2 * share
            thick = 0.06 * c * float(rng.uniform(0.8, 1.6))
            spots = [
                (x + c, y, z),
                (x + 0.3 * c, y, z + thick),
                (x, y, z),
                (x + 0.3 * c, y, z - thick),
            ]
            for row, place in zip(curves, spots, strict=True):
                row.append(t.point(*map(float, place)))
        tail, upper, nose, lower = (t.add("Line", ", ".join(c)) for c in curves)
        family = str(rng.choice(["4-digit", "16", "63", "65A", "5-digit"]))
        t.add(
            "FoilLoftSurf",
            f'{{{tail}, {upper}, {nose}, {lower}, {tail}}}, "{family}", {_divisions(8, 24, fine)}',
            "skin",
        )
        tip = [c[1] for c in curves]
        section = t.add("FoilCurve", f'{{{", ".join([*tip, tip[0]])}}}, "{family}"')
        nose_bead, *tails = (t.add("AbsBead", f"{section}, {a}", "b") for a in (0.5, 0.0, 1.0))
        top, under = (t.add("SubCurve", f"{bead}, {nose_bead}") for bead in tails)
        t.add("RuledSurf", f"{top}, {under}, {_divisions(12, 2, fine)}", "tip")
    return Drawn(t.text(), -0.01, 0.05)


@dataclass
class Faceted:
    """A ship of plane faces, and its faces as triangles, (n, 3, 3), outward."""

    text: str
    triangles: np.ndarray
    length: float
    beam: float
    depth: float


def faceted_ship(rng: Generator) -> Faceted:
    """A hard-chine ship or a catamaran of two such hulls, every face plane.

    The sections of a hull are alike: of different size and height, so that strips between them are
    trapezoids.
    """
    catamaran = bool(rng.integers(2))
    t = _Text('Model info(symmetry = "y", units = "m t");')
    length, half, depth = rng.uniform(10, 40), rng.uniform(1, 5), rng.uniform(2, 5)
    chines = int(rng.integers(0, 3))
    # A convex half section from keel to the middle of the deck: slopes increase from keel to sheer.
    angles = np.sort(rng.uniform(0, 0.5 * np.pi, chines + 1))
    steps = rng.uniform(0.5, 1, chines + 1)[:, None] * np.column_stack(
        [np.cos(angles), np.sin(angles)]
    )
    section = np.vstack([[0, 0], np.cumsum(steps, axis=0)])
    section *= np.array([half, depth]) / section[-1]
    section = np.vstack([section, [0, depth]])
    count = int(rng.integers(2, 6))
    stations = np.concatenate([[0], np.sort(rng.uniform(0.1, 0.9, count - 2)), [1]]) * length
    sizes, lifts = rng.uniform(0.4, 1, count), rng.uniform(0, 0.3, count) * depth
    middle = float(half * rng.uniform(1.3, 3)) if catamaran else 0.0

    def ring(k: int, side: int) -> list[list[float]]:
        y, z = (section * sizes[k]).T
        return [
            [float(stations[k]), middle + side * float(a), float(b) + lifts[k]]
            for a, b in zip(y, z, strict=True)
        ]

    sides = (1, -1) if catamaran else (1,)
    rings = {(k, side): ring(k, side) for k in range(count) for side in sides}
    outlines = {}
    for k in range(count):
        ends = t.points([rings[k, 1][0], rings[k, 1][-1]])
        for side in sides:
            names = [ends[0], *t.points(rings[k, side][1:-1]), ends[1]]
            outlines[k, side] = t.polyline(names)
        if not catamaran:
            outlines[k, -1] = t.add("Line", ", ".join(ends))
    count_along = _divisions(2 * (chines + 2), 2, 1)
    for a, b in pairwise(range(count)):
        for side in sides:
            t.add("RuledSurf", f"{outlines[a, side]}, {outlines[b, side]}, {count_along}", "side")
    for k in (0, count - 1):
        t.add("RuledSurf", f"{outlines[k, 1]}, {outlines[k, -1]}, {count_along}", "end")

    faces = []
    for side in (1, -1):
        # Seen from outside, the starboard side runs from the first station to the last.
        for a, b in pairwise(range(count)):
            for (p, q), (r, s) in zip(
                pairwise(ring(a, side)), pairwise(ring(b, side)), strict=True
            ):
                faces += [[p, q, r][::side], [q, s, r][::side]]
        for k, out in ((0, -side), (count - 1, side)):
            keel, *rim = ring(k, side)
            faces += [[keel, p, q][::out] for p, q in pairwise(rim)]
    corners = np.array(faces)
    if catamaran:
        corners = np.vstack([corners, (corners * [1, -1, 1])[:, ::-1]])
    return Faceted(t.text(), corners, float(length), 2 * (float(half) + middle), float(depth))


FAMILIES: tuple[Callable[..., Drawn], ...] = (chine_hull, round_hull, prisms, platform, wing)


def drawn(seed: int, fine: int = 1) -> Drawn:
    """The model of a seed; the families take turns."""
    family = FAMILIES[seed % len(FAMILIES)]
    return family(np.random.default_rng(seed), fine)
