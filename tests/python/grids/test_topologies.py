# ruff: noqa: E501 -- programs of one line
"""Grids of several blocks by topologies.sdl, against closed forms and cell volumes by NumPy."""

from __future__ import annotations

import itertools
import os
import re
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import moldloft
from moldloft import grids

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
HEAD = 'load "topologies.sdl";\n'


def aerofoil(
    rng: np.random.Generator, n: int, base: float, turn: float = 0.0, thickest: float = 0.3
) -> np.ndarray:
    """A NACA 4-digit section of n points (odd), its tail `base` thick; turned about its middle."""
    m, p, t = rng.uniform(0, 0.06), rng.uniform(0.25, 0.6), rng.uniform(0.06, thickest)
    x = (1 - np.cos(np.linspace(0, np.pi, n // 2 + 1))) / 2
    y = 5 * t * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    y += base / 2 * x
    fore = x < p
    line = np.where(
        fore, m / p**2 * (2 * p * x - x**2), m / (1 - p) ** 2 * (1 - 2 * p + 2 * p * x - x**2)
    )
    upper, lower = np.stack([x, line + y], -1), np.stack([x, line - y], -1)
    c = np.concatenate([upper[::-1], lower[1:]])
    c = (c - [0.5, 0]) @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    c = np.concatenate([c, np.zeros((len(c), 1))], -1)
    return c if rng.random() < 0.5 else c[::-1].copy()


def constant(value: np.ndarray) -> Callable[[], np.ndarray]:
    return lambda: value


def of(text: str, **curves: np.ndarray) -> moldloft.Model:
    """A program in which these curves and surfaces are functions."""
    functions = {name: constant(value) for name, value in curves.items()}
    return moldloft.loads(HEAD + text, functions=functions)


def blocks_of(model: moldloft.Model) -> list[np.ndarray]:
    """The blocks of the Plot3D file that a program writes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "g.x"
        path.write_bytes(model.written["g.x"])
        return [np.asarray(b) for b in grids.read_plot3d(path)[0]]


def cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def areas(s: np.ndarray) -> np.ndarray:
    """The crosses at the four corners of each cell of a plane grid."""
    s = s[..., :2]
    a, b, c, d = s[:-1, :-1], s[1:, :-1], s[1:, 1:], s[:-1, 1:]
    return np.stack(
        [cross(b - a, d - a), cross(c - b, a - b), cross(d - c, b - c), cross(a - d, c - d)]
    )


def sound(surfaces: Iterable[np.ndarray]) -> float:
    """No corner of a cell is turned over or left-handed; the area of all."""
    total = 0.0
    for s in surfaces:
        corners = areas(s)
        assert (corners > 0).all(), corners.min()
        total += float((corners[0] + corners[2]).sum() / 2)
    return total


def jacobians(b: np.ndarray) -> np.ndarray:
    """The triple products at the eight corners of each cell of a block."""
    first, last = slice(None, -1), slice(1, None)
    out = []
    for at in itertools.product((0, 1), repeat=3):
        here = [last if end else first for end in at]
        steps = []
        for axis in range(3):
            other = list(here)
            other[axis] = first if at[axis] else last
            steps.append((b[tuple(other)] - b[tuple(here)]) * (-1 if at[axis] else 1))
        out.append(np.einsum("...c,...c", np.cross(steps[0], steps[1]), steps[2]))
    return np.stack(out)


def area_of(c: np.ndarray) -> float:
    """The area of a polygon in x and y (the shoelace formula)."""
    d = c[:, :2] - c[0, :2]
    x, y = d.T
    return float(abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2)


def distance(line: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The distances of points from a line of points, in x and y."""
    a, b = line[:-1, None, :2], line[1:, None, :2]
    p = points[None, :, :2]
    step = b - a
    square = (step**2).sum(-1)
    share = np.clip(((p - a) * step).sum(-1) / np.where(square > 0, square, 1), 0, 1)
    return np.asarray(np.linalg.norm(p - a - share[..., None] * step, axis=-1).min(0))


def ring(c: np.ndarray) -> np.ndarray:
    """A line of points closed."""
    return np.concatenate([c, c[:1]])


def heights(rng: np.random.Generator, far: float) -> tuple[str, np.ndarray]:
    n = int(rng.integers(21, 33))
    first = float(rng.choice([1e-3, 3e-4, 1e-4]))
    return f"geometric(0, {far}, {first}, {n})", np.array([first])


@pytest.mark.parametrize("seed", range(60 if SOAK else 6))
def test_c_grids_of_blunt_tails(seed: int) -> None:
    rng = np.random.default_rng(seed)
    base = float(np.exp(rng.uniform(np.log(0.001), np.log(0.05))))
    section = aerofoil(rng, int(rng.choice([61, 81, 101])), base)
    law, (first,) = heights(rng, 8)
    wake, n, cells = float(rng.uniform(4, 9)), int(rng.integers(20, 33)), int(rng.integers(2, 13))
    m = of(
        f'surface g[] = c_blocks(section(), {law}, {wake}, {n}, {cells}); write_p3d("g.x", g);',
        section=section,
    )
    around, behind = blocks_of(m)
    sound([around, behind])
    # The section to the bit, and the wake points of both blocks.
    assert np.array_equal(np.sort(around[n:-n, 0], 0), np.sort(section, 0))
    assert np.array_equal(around[: n + 1, 0][::-1], behind[:, 0]) and np.array_equal(
        around[-n - 1 :, 0], behind[:, -1]
    )
    # The first cell off the section, at its corners by the distance to the wall.
    high = distance(section, around[n:-n, 1])
    assert np.abs(high / first - 1).max() < 0.01
    # The outline of both blocks has the area of all cells and of the section.
    rim = np.concatenate([around[:, -1], around[-1, -2::-1], behind[-1, -2:0:-1], around[0, :-1]])
    assert sound([around, behind]) == pytest.approx(area_of(rim) - area_of(section), rel=1e-9)


def cascade(rng: np.random.Generator) -> tuple[np.ndarray, float, float]:
    """A blade in its stagger, its pitch, and the stagger."""
    stagger = float(rng.uniform(0, np.radians(60)))
    base = 0.0 if rng.random() < 0.4 else float(rng.uniform(0.005, 0.03))
    return (
        aerofoil(rng, int(rng.choice([81, 101])), base, stagger, 0.15),
        float(rng.uniform(0.8, 1.4)),
        stagger,
    )


@pytest.mark.parametrize("kind", ["h_o_h", "h_c_h"])
@pytest.mark.parametrize("seed", range(60 if SOAK else 4))
def test_cascades(kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    blade, pitch, stagger = cascade(rng)
    far = float(0.15 * pitch * np.cos(stagger))
    ahead, behind = float(rng.uniform(0.6, 1)), float(rng.uniform(0.6, 1))
    n, across = int(rng.integers(14, 25)), int(rng.integers(8, 17))
    law = f"geometric(0, {far}, 1e-3, 15)"
    m = of(
        f"surface g[] = {kind}(blade(), {law}, {pitch}, {ahead}, {behind}, {n}, {across}); "
        'write_p3d("g.x", g); string report = interfaces(g, {"j1 = blade wall", "", "j1 = low periodic, jn = high periodic", '
        '"j1 = low periodic, jn = high periodic"});',
        blade=blade,
    )
    around, passage, inlet, outlet = blocks_of(m)
    # The whole is a strip one pitch high without the blade.
    nose = np.argmax(np.linalg.norm(blade - (blade[0] + blade[-1]) / 2, axis=-1))
    length = outlet[-1, 0, 0] - inlet[0, 0, 0]
    assert inlet[0, 0, 0] == pytest.approx(blade[nose, 0] - ahead, abs=1e-12)
    area = sound([around, passage, inlet, outlet])
    assert area == pytest.approx(pitch * length - area_of(blade), rel=1e-9)
    # Periodic sides are moved by the pitch, and smoothed: their points are not on a straight line.
    for block in (inlet, outlet):
        assert np.abs(block[:, -1] - block[:, 0] - [0, pitch, 0]).max() < 1e-12
    # Across the periodic side the grid is as smooth as inside: the second difference there is that of a solution.
    for block in (inlet, outlet):
        middle = block[1:-1]
        below = middle[:, -2] - [0, pitch, 0]
        turn = np.linalg.norm(middle[:, 1] - 2 * middle[:, 0] + below, axis=-1) / np.linalg.norm(
            middle[:, 1] - below, axis=-1
        )
        inner = np.linalg.norm(middle[:, 2:] - 2 * middle[:, 1:-1] + middle[:, :-2], axis=-1)
        inner /= np.linalg.norm(middle[:, 2:] - middle[:, :-2], axis=-1)
        assert (turn < 2 * inner.max() + 1e-3).all()
    # The first cell off the blade.
    inside = around[:, 1] if kind == "h_o_h" else around[1:-1, 1]
    high = distance(ring(blade) if kind == "h_o_h" else blade, inside)
    assert np.abs(high / 1e-3 - 1).max() < 0.01


@pytest.mark.parametrize("seed", range(40 if SOAK else 4))
def test_o_grids_are_smooth_across_their_cut(seed: int) -> None:
    """A ring between a section and an outer curve: turned cuts give the same grid, and no kink is left."""
    rng = np.random.default_rng(seed)
    n, m = 16, 41
    t = np.linspace(0, 2 * np.pi, m)
    a, shift = float(rng.uniform(0.4, 1)), rng.uniform(-1, 1, 2)
    start = float(rng.uniform(0, 6))
    inner = np.stack([np.cos(t + start), a * np.sin(t + start), 0 * t], -1)
    outer = np.stack(
        [5 * np.cos(t + start) + shift[0], 5 * np.sin(t + start) + shift[1], 0 * t], -1
    )
    inner[-1], outer[-1] = inner[0], outer[0]
    ds = float(rng.uniform(0.02, 0.1))
    m_ = of(
        f'surface g = o_between(inner(), outer(), {n}, {ds}); write_p3d("g.x", g);',
        inner=inner,
        outer=outer,
    )
    (block,) = blocks_of(m_)
    g = block
    area = sound([g])
    assert area == pytest.approx(area_of(outer) - area_of(inner), rel=1e-9)
    assert np.array_equal(g[0], g[-1])
    first = np.linalg.norm(g[:, 1] - g[:, 0], axis=-1)
    assert np.abs(first / ds - 1).max() < 1e-3
    # Angles between steps along each layer, over the cut and elsewhere.
    ring = np.concatenate([g[-2:-1], g[:-1], g[:1]])[:, 1:-1, :2]
    step = np.diff(ring, axis=0)
    heading = np.arctan2(step[..., 1], step[..., 0])
    turn = np.abs((np.diff(heading, axis=0) + np.pi) % (2 * np.pi) - np.pi)
    assert (turn[0] <= 1.5 * turn[1:].max(0)).all()


def rims(rng: np.random.Generator, q: int, stations: int) -> tuple[np.ndarray, float]:
    """Rims from a superellipse to another, along a line that may bend; corners of squares are points."""
    t = 2 * np.pi * np.arange(4 * q) / (4 * q) + np.pi / 4
    first, last = rng.choice([2.0, 4.0, np.inf], 2)
    out = []
    for f in np.linspace(0, 1, stations):
        shapes = []
        for power in (first, last):
            c, s = np.cos(t), np.sin(t)
            r = (
                1 / np.maximum(abs(c), abs(s))
                if np.isinf(power)
                else (abs(c) ** power + abs(s) ** power) ** (-1 / power)
            )
            shapes.append(np.stack([r * c, r * s], -1))
        flat = (1 - f) * shapes[0] + f * shapes[1]
        flat *= [1 + 0.5 * f, 1 - 0.2 * f]
        out.append(np.concatenate([flat, np.full((4 * q, 1), 3 * f)], -1))
    wall = np.stack(out, 1)
    return np.concatenate([wall, wall[:1]]), float(first)


@pytest.mark.parametrize("seed", range(60 if SOAK else 5))
def test_ducts_with_a_butterfly_core(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q, stations, n = int(rng.integers(4, 9)), int(rng.integers(3, 7)), int(rng.integers(8, 16))
    (wall, first), ds = rims(rng, q, stations), float(rng.choice([0.02, 5e-3]))
    given = wall[::-1] if rng.random() < 0.5 else wall
    m = of(
        f'block g[] = butterfly(wall(), {n}, {ds}); write_p3d("g.x", g); string report = interfaces(g);',
        wall=given.copy(),
    )
    blocks = blocks_of(m)
    volume = 0.0
    for b in blocks:
        assert (jacobians(b) > 0).all()
        volume += hexahedra(b)
    # Rims move linearly between stations: the area is quadratic, and Simpson's rule exact.
    areas_of = [area_of(wall[:, k]) for k in range(stations)]
    middle = [area_of((wall[:, k] + wall[:, k + 1]) / 2) for k in range(stations - 1)]
    height = 3 / (stations - 1)
    exact = sum(
        height / 6 * (areas_of[k] + 4 * middle[k] + areas_of[k + 1]) for k in range(stations - 1)
    )
    assert volume == pytest.approx(exact, rel=1e-9)
    # Eight inner faces, and nothing else is joined.
    assert str(m["report"]).count(" = ") == 8
    for number, b in enumerate(blocks[:4]):
        # The first rim is a circle or a square, for which the distance from the wall is exact.
        p = b[:, 1, 0, :2]
        if first == 2.0:
            high = 1 - np.linalg.norm(p, axis=-1)
        elif np.isinf(first):
            high = 1 - np.abs(p).max(-1)
        else:
            continue
        assert np.abs(high / ds - 1).max() < 0.015, number


def hexahedra(b: np.ndarray) -> float:
    """The volume of a block with bilinear faces: the divergence theorem over its cells, exact."""
    total = 0.0
    for axis in range(3):
        p = np.moveaxis(b, axis, 0)
        for end, sign in ((0, -1.0), (-1, 1.0)):
            s = p[end]
            a, b_, c, d = s[:-1, :-1], s[1:, :-1], s[1:, 1:], s[:-1, 1:]
            # A bilinear patch: the integral of r . n / 3 by its closed form, the mean of both divisions into triangles.
            one = np.einsum("...c,...c", a, np.cross(b_, c)) + np.einsum(
                "...c,...c", a, np.cross(c, d)
            )
            two = np.einsum("...c,...c", a, np.cross(b_, d)) + np.einsum(
                "...c,...c", b_, np.cross(c, d)
            )
            turned = -1.0 if axis == 1 else 1.0
            total += sign * turned * float((one + two).sum()) / 12
    return total


@pytest.mark.parametrize("seed", range(30 if SOAK else 3))
def test_wings(seed: int) -> None:
    rng = np.random.default_rng(seed)
    base = 0.0 if seed % 2 else float(rng.uniform(0.005, 0.03))
    section = aerofoil(rng, 61, base)
    stations, span = 5, float(rng.uniform(2, 4))
    taper, sweep, thin = rng.uniform(0.4, 1), rng.uniform(0, 0.6), rng.uniform(0.1, 1)
    wall = np.stack(
        [
            section * (1 - (1 - taper) * f) * [1, 1 - (1 - thin) * f, 1]
            + [sweep * f * span, 0, span * f]
            for f in np.linspace(0, 1, stations)
        ],
        1,
    )
    m = of(
        'block g[] = o_h_wing(wing(), geometric(0, 6, 1e-3, 25), geometric(0, 3, 0.01, 11), 8); write_p3d("g.x", g); '
        'write_su2("g.su2", g, {"j1 = wing wall, jn = far farfield, k1 = root symmetry", "jn kn = far farfield", '
        '"k1 = tip wall, kn = far farfield"});',
        wing=wall.copy(),
    )
    assert not m.diagnostics, m.diagnostics
    around, beyond, cut = blocks_of(m)
    assert (jacobians(around) > 0).all() and (jacobians(beyond) > 0).all()
    inside = jacobians(cut)
    # A sharp tail is a pole: only the corners there are collapsed.
    assert (inside[:, :-1] > 0).all() and (
        (inside[:, -1] > 0).all() if base else (inside[:, -1] > -1e-15).all()
    )
    # All of it: what is inside the far field, less the wing between its sections.
    for k in range(stations):
        high = distance(ring(wall[:, k]), around[:, 1, k])
        assert np.abs(high / 1e-3 - 1).max() < 0.01
    assert cut.shape[1] == 9 and hexahedra(cut) == pytest.approx(3 * area_of(wall[:, -1]), rel=1e-9)


@pytest.mark.parametrize(
    ("call", "match"),
    [
        ("surface g[] = c_blocks(sharp, {0, 1e-2, 3e-2}, 2, 8);", "tail of the section is sharp"),
        ("surface g[] = c_blocks(-blunt, {0, 1e-2, 3e-2}, 2, 8);", "greatest x"),
        (
            "surface g[] = c_blocks(sharp[1:4], {0, 1e-2, 3e-2}, 2, 8);",
            "at least 5 points, found 4",
        ),
        ("surface g = o_between(sharp, sharp[1:40], 8, 0.1);", "41 and 40 points"),
        (
            "surface g[] = h_o_h(sharp, {0, 1e-2, 3e-2}, 1, 0.001, 1, 8, 8);",
            "beyond the layers round the blade",
        ),
        ("block g[] = butterfly(tube[1:10, ], 4, 1e-3);", "4 q \\+ 1 points, found 10"),
        ("block g[] = o_h_wing(tube[1:40, ], {0, 1e-2}, {0, 1, 2});", "odd number of points"),
        ("block g[] = o_h_wing(flat, {0, 1e-2, 3e-2}, {0, 1, 2});", "has no thickness"),
        ('surface g = elliptic(tube, 10, 1e-6, periodic = "i1 jn");', "unknown pair of edges"),
        ('surface g = elliptic(tube, 10, 1e-6, periodic = "i1 im");', "not plane"),
        ('surface g = elliptic(ring*{1, 1, 0}, 10, 1e-6, periodic = "j1 jn");', "same vector"),
        (
            'surface g = elliptic(ring, 9, 1e-6, "sorenson", walls = "i1", spacing = 0.1, periodic = "i1 im");',
            "is a wall and periodic",
        ),
    ],
)
def test_refusals(call: str, match: str) -> None:
    text = """load "naca.sdl"; curve sharp[41], lower[21], upper[21], blunt[41], c[41];
naca4s(sharp, 0, 0, 12); naca4l(lower, 0, 0, 12); naca4(upper, 0, 0, 12); blunt[1:21] = lower[21:1:-1]; blunt[21:41] = upper;
arc(c, 0, 2*PI, 1); c[41] = c[1]; surface tube[41, 3], ring[41, 3], flat[41, 3];
for (j = 1:3) { tube[, j] = c + {0, 0, j}; ring[, j] = j*c; flat[, j] = sharp*{1, 0, 1} + {0, 0, j}; }
"""
    with pytest.raises(moldloft.ModelError, match=match):
        moldloft.loads(HEAD + text + call)


@pytest.mark.parametrize("end", ["default", "low", "high"])
def test_the_blocks_of_a_nacelle(end: str) -> None:
    """The example, also at the ends of its ranges: no corner folded, and the volume of the frusta of its rims."""
    m = moldloft.load(Path(__file__).resolve().parents[3] / "examples/nacelle/blocks.sdl")
    assert not m.diagnostics, m.diagnostics
    m.set({name: getattr(p, end) for name, p in m.params.items()})
    assert not m.has_errors
    found: dict[str, Any] = {name: m[name] for name in ("grid", "inside", "outside")}
    blocks = [np.asarray(b) for b in found["grid"]]
    assert len(blocks) == 36
    assert all((jacobians(b) > 0).all() for b in blocks)
    volume = sum(hexahedra(b) for b in blocks)

    def frusta(line: np.ndarray) -> float:
        """The body of 32-sided frusta between rims of these places and radii."""
        x, r = line[:, 0], line[:, 1]
        whole = (np.diff(x) * (r[1:] ** 2 + r[1:] * r[:-1] + r[:-1] ** 2)).sum() / 3
        return float(16 * np.sin(2 * np.pi / 32) * whole)

    inside = [np.asarray(c) for c in found["inside"]]
    outside = [np.asarray(c) for c in found["outside"]]
    far = np.array([0, 5 * float(m["chord"]), 0])
    exact = sum(frusta(c + far) for c in outside) - frusta(outside[1]) + frusta(inside[1])
    assert volume == pytest.approx(exact, rel=1e-9)
    # The walls of the SU2 mesh are those of the nacelle, and every other face is named.
    text = m.written["nacelle.su2"].decode()
    tags = dict(re.findall(r"MARKER_TAG= (\S+)\nMARKER_ELEMS= (\d+)", text))
    assert tags["duct"] == tags["cowl"] == str(4 * 8 * 24) and set(tags) == {
        "duct",
        "cowl",
        "far",
        "inlet",
        "outlet",
    }


def test_topologies_have_derivatives() -> None:
    """Through marching, smoothing across a cut and the core of a duct, against central differences."""
    text = """load "naca.sdl"; param float h = 0.3 in [0, 1];
curve lower[11], upper[11], c[21], a[21], b[21], r[17]; naca4l(lower, 0, 0, 12); naca4(upper, 0, 0, 12);
c[1:11] = lower[11:1:-1]; c[11:21] = upper; c.y = c.y*(1 + h);
surface g[] = c_blocks(c, geometric(0, 2, 0.02, 9), 2 + h, 8, 4);
arc(a, 2*PI, 0, 1); arc(b, 2*PI, 0, 4); a[21] = a[1]; b[21] = b[1]; b.x = b.x + h;
surface o = o_between(a, b, 8, 0.1 + 0.1*h);
arc(r, 0, 2*PI, 1); r[17] = r[1]; surface w[17, 2]; w[, 1] = r; w[, 2] = r*(1 + h) + {0, 0, 1};
block d[] = butterfly(w, 5, 0.05);
vector p = g[1][10, 4], q = g[2][4, 3], s = o[1, 4], t = d[2][3, 3, 2], u = d[5][3, 2, 2];
"""
    model = moldloft.loads(HEAD + text)
    step = 1e-5
    high, low = (
        moldloft.loads(HEAD + text.replace("h = 0.3", f"h = {0.3 + d!r}")) for d in (step, -step)
    )
    for name in [f"{point}.{axis}" for point in "pqstu" for axis in "xy"]:
        differences = (high.eval(name) - low.eval(name)) / (2 * step)
        assert model.derivative(name, "h") == pytest.approx(differences, rel=1e-4, abs=1e-5), name
