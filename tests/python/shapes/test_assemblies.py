"""Assemblies whose parts meet along an intersection, of random sizes and attitudes.

Closedness is judged by the faces of the mesh and the closed forms of planes, cones, spheres and a
biquadratic hull: a vertex on both shapes is on their intersection, where each edge of the mesh
belongs to two faces.
"""

from __future__ import annotations

import os
from collections.abc import Callable

import numpy as np
import pytest

import moldloft
from mesh_edges import edge_uses

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
CASES = 200 if SOAK else 12
SETTINGS = 400 if SOAK else 3

Distance = Callable[[moldloft.Model, np.ndarray], np.ndarray]
Kind = Callable[[np.random.Generator], tuple[list[str], str, Distance]]


def frame(rng: np.random.Generator) -> np.ndarray:
    """Three random orthogonal unit vectors, as rows."""
    axes: np.ndarray = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return axes


def place(name: str, *terms: tuple[np.ndarray, str]) -> str:
    """A point object, the sum of vectors times expressions."""
    axes = (" + ".join(f"({float(v[k])!r})*({by})" for v, by in terms) for k in range(3))
    return f"AbsPoint {name}({', '.join(axes)});"


def point(model: moldloft.Model, name: str) -> np.ndarray:
    return np.array([model[name].x, model[name].y, model[name].z])


def plane(model: moldloft.Model, places: np.ndarray) -> np.ndarray:
    a, b, c = (point(model, name) for name in ("W0", "W1", "W2"))
    normal = np.cross(b - a, c - a)
    off: np.ndarray = (places - a) @ normal / np.linalg.norm(normal)
    return off


def cone(model: moldloft.Model, places: np.ndarray) -> np.ndarray:
    p, q, g, h = (point(model, name) for name in "PQGH")
    along = (q - p) / np.linalg.norm(q - p)
    t = (places - p) @ along
    radii = np.linalg.norm(g - p), np.linalg.norm(h - q)
    wanted = radii[0] + (radii[1] - radii[0]) * t / np.linalg.norm(q - p)
    off: np.ndarray = np.linalg.norm(places - p - t[:, None] * along, axis=1) - wanted
    return off


def ball(model: moldloft.Model, places: np.ndarray) -> np.ndarray:
    north, south = (point(model, name) for name in ("N", "S"))
    middle, radius = (north + south) / 2, np.linalg.norm(north - south) / 2
    off: np.ndarray = np.linalg.norm(places - middle, axis=1) - radius
    return off


def shaft(rng: np.random.Generator, e: np.ndarray) -> str:
    """A cone about the third axis through the origin, from -2 to 2, with a radius near 0.4 r."""
    turn = rng.uniform(0, 2 * np.pi)
    out = e[0] * np.cos(turn) + e[1] * np.sin(turn)
    off, taper = (
        e[0] * rng.uniform(-0.3, 0.3) + e[1] * rng.uniform(-0.3, 0.3),
        rng.uniform(0.8, 1.25),
    )
    return " ".join(
        (
            place("P", (e[2], "-2"), (off, "d")),
            place("Q", (e[2], "2"), (off, "d")),
            place("G", (e[2], "-2"), (off, "d"), (out, "0.4*r")),
            place("H", (e[2], "2"), (off, "d"), (out, f"0.4*r*{taper!r}")),
            "Line axis(P, Q); Line rule(G, H); RevSurf shaft(rule, axis, 0, 2*PI, visible = 0);",
        )
    )


def pipe_through_plate(rng: np.random.Generator) -> tuple[list[str], str, Distance]:
    """Also a leg on the deck of a pontoon."""
    e, size = frame(rng), rng.uniform(1.6, 3)
    lean = rng.uniform(-0.4, 0.4, 2)
    a, b = e[0] + e[2] * lean[0], e[1] + e[2] * lean[1]
    corners = [
        place(f"W{k}", (a, f"{x * size!r}"), (b, f"{y * size!r}"), (e[2] * x, "0.2*k"))
        for k, (x, y) in enumerate([(-1, -1), (1, -1), (-1, 1), (1, 1)])
    ]
    wall = " ".join(corners) + " Line w(W0, W1); Line v(W2, W3); RuledSurf base(w, v, visible = 0);"
    return [wall, shaft(rng, e)], "TrimSurf plate(base, {hole}, whole = 1);", plane


def strut_on_ball(rng: np.random.Generator) -> tuple[list[str], str, Distance]:
    """A strut on the round end of a torpedo; its other side is not reached."""
    e, size = frame(rng), rng.uniform(1.2, 1.6)
    # The shaft, from -2 to 2, meets the ball about 2 e3 once.
    tilt = rng.uniform(0, 2 * np.pi)
    up = e[0] * np.cos(tilt) + e[1] * np.sin(tilt)
    side = np.cross(up, e[2])
    body = " ".join(
        (
            place("N", (e[2], "2.4"), (up, f"{size!r}*(1 + 0.1*k)")),
            place("S", (e[2], "2.4"), (up, f"-{size!r}*(1 + 0.1*k)")),
            place("M", (e[2], "2.4"), (side, f"{size!r}*(1 + 0.1*k)")),
            "Arc meridian(N, M, S); Line poles(N, S);",
            "RevSurf base(meridian, poles, 0, 2*PI, visible = 0);",
        )
    )
    return [body, shaft(rng, e)], "TrimSurf plate(base, {hole}, whole = 1);", ball


def vessel(rng: np.random.Generator, taper: float) -> tuple[list[str], str, Distance]:
    """A shaft across the half of a cone."""
    e, radius = frame(rng), rng.uniform(1.4, 2)
    # A turn about e0 from `out` passes through -e2, where the shaft comes from.
    out = -e[1] * np.dot(np.cross(e[0], e[1]), e[2])
    slope = rng.uniform(-0.2, 0.2)
    ends = [e[0] * x + e[2] * (radius - 0.3 + slope * x) for x in (-2.2, 2.2)]
    grown = ["(1 + 0.1*k)", f"(1 + 0.1*k)*{taper!r}"]
    body = " ".join(
        (
            place("I", (ends[0], "1")),
            place("J", (ends[1], "1")),
            place("U", (ends[0], "1"), (out, f"{radius!r}*{grown[0]}")),
            place("V", (ends[1], "1"), (out, f"{radius!r}*{grown[1]}")),
            "Line spine(I, J); Line wall(U, V); RevSurf base(wall, spine, 0, PI, visible = 0);",
        )
    )

    def distance(model: moldloft.Model, places: np.ndarray) -> np.ndarray:
        p, q, u, v = (point(model, name) for name in "IJUV")
        axis = (q - p) / np.linalg.norm(q - p)
        t = (places - p) @ axis
        # Radii of the wall at the heights of its ends.
        heights = [(w - p) @ axis for w in (u, v)]
        radii = [np.linalg.norm(w - p - h * axis) for w, h in zip((u, v), heights, strict=True)]
        wanted = radii[0] + (radii[1] - radii[0]) * (t - heights[0]) / (heights[1] - heights[0])
        off: np.ndarray = np.linalg.norm(places - p - t[:, None] * axis, axis=1) - wanted
        return off

    return [body, shaft(rng, e)], "TrimSurf plate(base, {hole}, whole = 1);", distance


def leg_on_pontoon(rng: np.random.Generator) -> tuple[list[str], str, Distance]:
    """A leg on a round pontoon."""
    return vessel(rng, 1.0)


def nozzle_on_vessel(rng: np.random.Generator) -> tuple[list[str], str, Distance]:
    """A nozzle on a conical vessel."""
    return vessel(rng, float(rng.uniform(0.8, 1.2)))


def keel_on_canoe_body(rng: np.random.Generator) -> tuple[list[str], str, Distance]:
    """A round keel under a hull of the depth D (1 - x^2 / l^2) (1 - y^2 / b^2)."""
    e, half, beam = frame(rng), rng.uniform(2, 3), rng.uniform(1.4, 2)
    deep = "(0.9 + 0.2*k)"
    net = [
        place(f"W{i}{j}", (e[0], f"{x * half!r}"), (e[1], f"{y * beam!r}"), (e[2], f"-{z}*{deep}"))
        for j, y in enumerate((-1, 0, 1))
        for i, x in enumerate((-1, 0, 1))
        for z in [4 if x == y == 0 else 0]
    ]
    names = ", ".join(f"W{i}{j}" for j in range(3) for i in range(3))
    body = " ".join(net) + f" BSurf base({{{names}}}, 3, 3, 2, 2, visible = 0);"

    def distance(model: moldloft.Model, places: np.ndarray) -> np.ndarray:
        x, y, z = (places @ axis for axis in e)
        depth = -(point(model, "W11") @ e[2]) / 4
        off: np.ndarray = z + depth * (1 - (x / half) ** 2) * (1 - (y / beam) ** 2)
        return off

    return [body, shaft(rng, e)], "TrimSurf plate(base, {hole}, whole = 1);", distance


def bulb_on_chine_hull(rng: np.random.Generator) -> tuple[list[str], str, Distance]:
    """A bulb on two planes that meet in a chine, over poly-lines, across the chine."""
    e = frame(rng)
    y, z = rng.uniform(-0.15, 0.15), rng.uniform(0.2, 0.5)
    back = e[0] * -2.2
    body = " ".join(
        (
            place("W0", (back, "1"), (e[1], "-2"), (e[2], f"{rng.uniform(-0.3, 0.1)!r}")),
            place("W1", (back, "1"), (e[1], f"{y!r}"), (e[2], f"{-z!r}*(1 + 0.4*k)")),
            place("W2", (back, "1"), (e[1], "2"), (e[2], f"{rng.uniform(-0.1, 0.3)!r}")),
            place("W3", (e[0], "2.2"), (e[1], f"{y!r}"), (e[2], f"{-z!r}*(1 + 0.4*k)")),
            "Line w(W0, W1); Line v(W1, W2); PolyCurve station({w, v}); Line chine(W1, W3);",
            "TranSurf base(station, chine, visible = 0);",
        )
    )

    def distance(model: moldloft.Model, places: np.ndarray) -> np.ndarray:
        a, b, c, d = (point(model, f"W{k}") for k in range(4))
        off = []
        for side in (a, c):
            normal = np.cross(side - b, d - b)
            off.append(abs((places - b) @ normal / np.linalg.norm(normal)))
        return np.minimum(*off)

    return [body, shaft(rng, e)], "TrimSurf plate(base, {hole}, whole = 1);", distance


KINDS = (
    pipe_through_plate,
    strut_on_ball,
    leg_on_pontoon,
    nozzle_on_vessel,
    keel_on_canoe_body,
    bulb_on_chine_hull,
)


def assembly(rng: np.random.Generator, kind: Kind) -> tuple[str, Distance]:
    """The program of an assembly, and the distance from its base."""
    parts, cut, distance = kind(rng)
    sides = ["base", "shaft"][:: 1 if rng.random() < 0.5 else -1]
    named = [
        f"Intersection x({sides[0]}, {sides[1]}); IntSnake hole(base, x); IntSnake rim(shaft, x);",
        "IntSnake hole(base, shaft); IntSnake rim(shaft, base);",
    ]
    count = int(rng.integers(8, 30))
    faces = [cut, f"SubSurf tube({{rim, shaft.u0}}, divisions = {{{count}, 3}});"]
    text = [
        "param float r = 1 in [0.7, 1.3];",
        "param float d = 0 in [-1, 1]; param float k = 0 in [-1, 1];",
        *(parts[k] for k in rng.permutation(2)),
        named[rng.integers(2)],
        *(faces[k] for k in rng.permutation(2)),
    ]
    return "\n".join(text), distance


@pytest.mark.parametrize("seed", range(CASES))
def test_parts_meet_along_their_intersection(seed: int) -> None:
    rng = np.random.default_rng(seed)
    text, distance = assembly(rng, KINDS[seed % len(KINDS)])
    # The direction of the intersection is that of the product of the normals.
    try:
        model = moldloft.loads(text)
    except moldloft.ModelError as error:
        assert {fault.id for fault in error.diagnostics} == {"folded-patch"}, text
        back = "AbsMagnet b0(shaft, 0, 1); AbsMagnet b1(shaft, 0, 0); LineSnake back(b0, b1);\n"
        text = text.replace("shaft.u0", "back").replace("SubSurf tube", back + "SubSurf tube")
        model = moldloft.loads(text)
    counts = set()
    for _ in range(SETTINGS):
        mesh = model.mesh()
        off = np.maximum(abs(distance(model, mesh.vertices)), abs(cone(model, mesh.vertices)))
        on_both = off < 1e-9
        edges, uses = edge_uses(mesh.faces)
        seam = uses[on_both[edges].all(axis=1)]
        assert len(seam) >= 8, text
        assert set(seam) == {2}, f"open along the intersection\n{text}"
        ring = mesh.vertices[on_both]
        apart = np.linalg.norm(ring[:, None] - ring[None], axis=2) + np.eye(len(ring))
        assert apart.min() > 1e-6, f"a vertex is there twice\n{text}"
        assert len(ring) == len(seam), text
        # The triangles of a trimmed face follow its shape; the edge that it shares does not.
        counts.add(len(seam))
        assert len(counts) == 1, text
        model.set(
            {
                "r": float(rng.uniform(0.7, 1.3)),
                "d": float(rng.uniform(-1, 1)),
                "k": float(rng.uniform(-1, 1)),
            }
        )


def prism(name: str, axes: np.ndarray, count: int, middle: np.ndarray, width: float) -> str:
    """A body of plane faces along the third axis, eight long."""
    turns = 2 * np.pi * np.arange(count) / count
    rows = []
    for k, turn in enumerate(turns):
        out = width * (axes[0] * np.cos(turn) + axes[1] * np.sin(turn))
        for end, along in (("L", -4), ("H", 4)):
            x, y, z = (float(c) for c in middle + out + axes[2] * along)
            rows.append(f"AbsPoint {end}{name}{k}({x!r}, {y!r}, {z!r});")
        rows.append(f"Line edge{name}{k}(L{name}{k}, H{name}{k});")
    for k in range(count):
        rows.append(f"RuledSurf f{name}{k}(edge{name}{k}, edge{name}{(k + 1) % count});")
    faces = ", ".join(f"f{name}{k}" for k in range(count))
    return "\n".join([*rows, f'PolySurf {name}({{{faces}}}, "v");'])


@pytest.mark.parametrize("seed", range(1000 if SOAK else 24))
def test_bodies_of_several_faces_meet_in_one_closed_curve(seed: int) -> None:
    rng = np.random.default_rng(seed)
    axes = frame(rng), frame(rng)
    while abs(axes[0][2] @ axes[1][2]) > 0.8:
        axes = axes[0], frame(rng)
    counts = rng.integers(3, 7, 2)
    wide = prism("a", axes[0], counts[0], np.zeros(3), 1.0)
    narrow = prism("b", axes[1], counts[1], rng.uniform(-0.2, 0.2, 3), 0.25)
    cut = (
        "AbsMagnet near(b, 0.9, 0.5); Intersection x(a, near); IntSnake s(a, x); IntSnake t(b, x);"
    )
    model = moldloft.loads(f"{wide}\n{narrow}\n{cut}")
    assert not [d for d in model.diagnostics if d.severity == "error"]
    curve, first, second = (model[name] for name in "xst")
    ts = np.linspace(0, 1, 60)
    places = curve(ts)
    np.testing.assert_allclose(places[0], places[-1], atol=1e-13)
    np.testing.assert_allclose(first(ts), places, atol=1e-13)
    np.testing.assert_allclose(second(ts), places, atol=1e-13)
