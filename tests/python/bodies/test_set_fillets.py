"""Fillets between random pairs of bodies: rails where prescribed, tangent along them, edges filled.

MOLDLOFT_SOAK makes them 200.
"""

from __future__ import annotations

import os
from functools import reduce
from operator import and_

import numpy as np
import pytest
from numpy.typing import NDArray

from moldloft import implicit as im

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"
Floats = NDArray[np.float64]
Faces = dict[str, im.Field]


def capped(
    side: im.Field, at: Floats, axis: Floats, height: float, name: str
) -> tuple[im.Set, Faces]:
    top, end = tuple(at + 0.5 * height * axis), tuple(at - 0.5 * height * axis)
    faces = {
        f"{name} side": side,
        f"{name} top": im.plane(tuple(axis), top),
        f"{name} end": im.plane(tuple(-axis), end),
    }
    return reduce(and_, (im.Set(f, name=n) for n, f in faces.items())), faces


def body(rng: np.random.Generator, name: str, at: Floats) -> tuple[im.Set, Faces]:
    """A ball, a bar, a block or a ring, with the distances of its faces by name."""
    kind = rng.integers(4)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    size = float(rng.uniform(0.7, 1.2))
    if kind == 0:
        faces = {f"{name} ball": im.sphere(tuple(at), size, distance=True)}
        return im.Set(faces[f"{name} ball"], name=f"{name} ball"), faces
    if kind == 1:
        side = im.cylinder(tuple(at), tuple(axis), 0.6 * size, distance=True)
        return capped(side, at, axis, 3.5, name)
    if kind == 2:
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        half = rng.uniform(0.5, 1.2, 3)
        faces = {}
        for k in range(3):
            for sign in (1.0, -1.0):
                n = sign * turn[:, k]
                faces[f"{name} {2 * k + (sign < 0)}"] = im.plane(tuple(n), tuple(at + half[k] * n))
        return reduce(and_, (im.Set(f, name=n) for n, f in faces.items())), faces
    # The distance from a ring, by its circle: the field of a torus is a polynomial.
    x, y, z = im.axes()
    across, _ = np.linalg.qr(np.column_stack([axis, rng.normal(size=(3, 2))]))
    u, v, w = (
        float(c[0]) * (x - at[0]) + float(c[1]) * (y - at[1]) + float(c[2]) * (z - at[2])
        for c in (across[:, 1], across[:, 2], axis)
    )
    tube = im.sqrt((im.sqrt(u**2 + v**2) - size) ** 2 + w**2) - 0.35 * size
    ring = im.Set(im.torus(tuple(at), tuple(axis), size, 0.35 * size), name=f"{name} ring")
    return ring, {f"{name} ring": tube}


def unit(field: im.Field, points: Floats) -> Floats:
    slope = field.gradient(points)
    return slope / np.linalg.norm(slope, axis=1)[:, None]


def onto(points: Floats, a: im.Field, b: im.Field, at: tuple[float, float]) -> Floats:
    """Points moved to where two distances have given values, by Newton steps of least norm."""
    for _ in range(40):
        f, g = a(points) - at[0], b(points) - at[1]
        m, n = a.gradient(points), b.gradient(points)
        mm, nn, mn = (m * m).sum(1), (n * n).sum(1), (m * n).sum(1)
        det = np.maximum(mm * nn - mn**2, 1e-9)
        s, t = (f * nn - g * mn) / det, (g * mm - f * mn) / det
        step = m * s[:, None] + n * t[:, None]
        size = np.linalg.norm(step, axis=1)[:, None]
        points = points - step * np.minimum(1, 0.3 / np.maximum(size, 1e-300))
    return points[(abs(a(points) - at[0]) < 1e-11) & (abs(b(points) - at[1]) < 1e-11)]


@pytest.mark.parametrize("seed", range(200 if SOAK else 6))
def test_a_fillet_touches_along_its_rails_and_fills_its_edges(seed: int) -> None:
    rng = np.random.default_rng([31, seed])
    a, faces_a = body(rng, "a", np.zeros(3))
    b, faces_b = body(rng, "b", rng.uniform(-0.9, 0.9, 3))
    widths = tuple(float(w) for w in rng.uniform(0.05, 0.15, 2))
    joined = a.filleted(b, *widths)
    blends = [leaf.field for leaf in joined.leaves if leaf.name == "fillet"]
    starts = rng.uniform(-2.2, 2.2, (4000, 3))
    rails = edges = 0
    for f in faces_a.values():
        for g in faces_b.values():
            # The edge: both faces, each on its body, outside of the other.
            edge = onto(starts, f, g, (0.0, 0.0))
            edge = edge[(abs(a(edge)) < 1e-9) & (abs(b(edge)) < 1e-9)] if len(edge) else edge
            if len(edge):
                n, m = unit(f, edge), unit(g, edge)
                sharp = (n * m).sum(1)
                # Into the corner that both leave free, unless they are nearly parallel there.
                edge = edge[abs(sharp) < 0.9]
                n, m = unit(f, edge), unit(g, edge)
                away = 0.03 * min(widths)
                corner = edge + away * (n + m) / (1 + (n * m).sum(1))[:, None]
                free = (a(corner) > 0) & (b(corner) > 0)
                # At the ends of an edge the faces beside it cut the blend.
                for own, faces in ((f, faces_a), (g, faces_b)):
                    for other in faces.values():
                        if other is not own:
                            free &= other(edge) < -8 * away
                edges += int(free.sum())
                assert (joined(corner[free]) < 0).all(), "an edge is not filled"
            # The rails: on one face, as far from the other as prescribed.
            for at, own in (((0.0, widths[1]), f), ((widths[0], 0.0), g)):
                rail = onto(starts[:600], f, g, at)
                if not len(rail):
                    continue
                rail = rail[abs(joined(rail)) < 1e-9]
                least = np.full(len(rail), np.inf)
                for blend in blends:
                    slope = np.linalg.norm(blend.gradient(rail), axis=1)
                    on = (slope > 1e-6) & (abs(blend(rail)) < 1e-9 * slope)
                    if on.any():
                        n, m = unit(own, rail[on]), unit(blend, rail[on])
                        sine, cosine = np.linalg.norm(np.cross(n, m), axis=1), (n * m).sum(1)
                        least[on] = np.minimum(least[on], np.degrees(np.arctan2(sine, cosine)))
                # Blends of other faces may pass through the same point; its own is tangent.
                met = least[np.isfinite(least)]
                rails += len(met)
                assert (met < 1e-3).all(), met.max()
    assert edges == 0 or rails > 0
    # What is added lies between the rails.
    points = rng.uniform(-2.2, 2.2, (40_000, 3))
    added = points[(joined(points) < 0) & (a(points) > 0) & (b(points) > 0)]
    if len(added):
        near = np.full(len(added), np.inf)
        for f in faces_a.values():
            for g in faces_b.values():
                near = np.minimum(near, np.maximum(abs(f(added)), abs(g(added))))
        assert near.max() <= max(widths) + 1e-9
