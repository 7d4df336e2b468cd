"""Ordinary models for CAD exchange: what they are made of is random, what they enclose is known."""

from __future__ import annotations

import random
from dataclasses import dataclass
from itertools import product


@dataclass
class Case:
    """A model and what it must come to."""

    name: str
    text: str
    area: float | None = None
    volume: float | None = None
    faces: int | None = None
    closed: bool = True
    exact: bool | None = True


def box(a: float, b: float, c: float, *, shift: float = 0, lift: float = 0) -> str:
    """A box from (0, shift, lift), of six faces between lines."""
    places = product((0, 1), repeat=3)
    corners = {f"P{i}{j}{k}": (i * a, j * b + shift, k * c + lift) for i, j, k in places}
    points = " ".join(f"AbsPoint {n}({x!r}, {y!r}, {z!r});" for n, (x, y, z) in corners.items())
    lines, faces = [], []
    for axis, name in enumerate("xyz"):
        for side in (0, 1):
            names = []
            for s in (0, 1):
                ends = []
                for t in (0, 1):
                    place = [0, 0, 0]
                    place[axis] = side
                    place[(axis + 1) % 3] = s
                    place[(axis + 2) % 3] = t
                    ends.append("P" + "".join(map(str, place)))
                line = f"l{name}{side}{s}"
                lines.append(f"Line {line}({ends[0]}, {ends[1]});")
                names.append(line)
            faces.append(f"RuledSurf {name}{side}({names[0]}, {names[1]}, colour = {axis + 1});")
    return points + " ".join(lines) + " ".join(faces)


def cylinder(r: float, h: float) -> str:
    """A closed cylinder about z, of three surfaces of revolution."""
    return f"""
        AbsPoint O(0, 0, 0); AbsPoint T(0, 0, {h!r}); Line axis(O, T);
        AbsPoint A({r!r}, 0, 0); AbsPoint B({r!r}, 0, {h!r});
        Line low(O, A); Line side(A, B); Line high(B, T);
        RevSurf bottom(low, axis); RevSurf wall(side, axis); RevSurf top(high, axis);
    """


def turned(points: list[tuple[float, float]], degree: int) -> str:
    """A B-spline (r, z) turned about z, its ends on the axis."""
    names = [f"Q{k}" for k in range(len(points))]
    text = "AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z);"
    for name, (r, z) in zip(names, points, strict=True):
        text += f" AbsPoint {name}({r!r}, 0, {z!r});"
    return text + f" BCurve c({{{', '.join(names)}}}, {degree}); RevSurf body(c, axis);"


def torus(big: float, small: float) -> str:
    """A torus about z."""
    return f"""
        AbsPoint O(0, 0, 0); AbsPoint Z(0, 0, 1); Line axis(O, Z);
        AbsPoint A({big + small!r}, 0, 0); AbsPoint M({big!r}, 0, 0); AbsPoint U({big!r}, 0, 1);
        Arc ring(A, M, U, type = 6); RevSurf body(ring, axis);
    """


def wigley(length: float, beam: float, draft: float) -> str:
    """Half of a Wigley hull without deck, mirrored in y = 0 by the model's symmetry."""
    b = beam / 2
    rows = []
    # y = b (1 - x^2) (1 - z^2): Bezier values along each direction are 0, 2, 0 and 1, 1, 0.
    for i, fx in enumerate((0.0, 2.0, 0.0)):
        for j, fz in enumerate((1.0, 1.0, 0.0)):
            rows.append((length * (i / 2 - 0.5), b * fx * fz, -draft * j / 2))
    points = ", ".join(f"{{{x!r}, {y!r}, {z!r}}}" for x, y, z in rows)
    return f"""
        Model info(symmetry = "y");
        NURBSurf hull({{{points}}}, nu = 3, nv = 3, degree_u = 2, degree_v = 2);
    """


def random_box(rng: random.Random) -> Case:
    """A box."""
    a, b, c = (rng.choice([rng.uniform(0.5, 9), float(rng.randint(1, 5))]) for _ in range(3))
    return Case("box", box(a, b, c), 2 * (a * b + b * c + c * a), a * b * c, 6)


def random_cylinder(rng: random.Random) -> Case:
    """A cylinder."""
    from math import pi

    r, h = rng.uniform(0.2, 5), rng.uniform(0.2, 9)
    area = 2 * pi * r * (r + h)
    return Case("cylinder", cylinder(r, h), area, pi * r * r * h, 3, closed=False)


def random_torus(rng: random.Random) -> Case:
    """A torus."""
    from math import pi

    small = rng.uniform(0.2, 1)
    big = small * rng.uniform(1.5, 6)
    return Case("torus", torus(big, small), 4 * pi**2 * big * small, 2 * pi**2 * big * small**2, 1)


def random_sphere(rng: random.Random) -> Case:
    """A sphere: a half circle turned."""
    from math import pi

    r = rng.uniform(0.3, 6)
    text = f"""
        AbsPoint S(0, 0, {-r!r}); AbsPoint N(0, 0, {r!r}); AbsPoint E({r!r}, 0, 0); Line axis(S, N);
        Arc half(S, N, E, type = 5); RevSurf ball(half, axis);
    """
    return Case("sphere", text, 4 * pi * r * r, 4 / 3 * pi * r**3, 1)


def random_turned(rng: random.Random) -> Case:
    """A body of revolution; its volume by Gauss' rule on the spline itself."""
    from math import pi

    import numpy as np
    from scipy.interpolate import BSpline

    n, degree = rng.randint(4, 7), 3
    points = [(0.0, 0.0)]
    points += [(rng.uniform(0.4, 2), (k + rng.uniform(-0.2, 0.2)) * 1.0) for k in range(1, n - 1)]
    points += [(0.0, float(n - 1))]
    knots = np.r_[[0] * 3, np.linspace(0, 1, n - degree + 1), [1] * 3]
    curve = BSpline(knots, np.array(points), degree)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    area = volume = 0.0
    for a, b in zip(np.unique(knots)[:-1], np.unique(knots)[1:], strict=True):
        t = a + (b - a) * (nodes + 1) / 2
        r, _ = curve(t).T
        dr, dz = curve(t, 1).T
        w = weights * (b - a) / 2
        area += 2 * pi * float(np.sum(w * r * np.hypot(dr, dz)))
        volume += pi * float(np.sum(w * r * r * dz))
    return Case("turned", turned(points, degree), area, volume, 1)


GENERATORS = (random_box, random_cylinder, random_torus, random_sphere, random_turned)
