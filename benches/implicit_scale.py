"""Unions of many primitives beside Manifold, and models of fidget in their text form.

`python benches/implicit_scale.py` compares 10 000 random balls at depth 7 and a lattice of 9 450
struts at depth 7 with Manifold's batch union of meshes, of so many segments that the balls end
with about as many triangles. `python benches/implicit_scale.py MODEL.vm DEPTH` reads a model of
fidget; its interpreter is timed by `cargo run --release --bin interpreter` in `benches/fidget`.
Seconds are of the processor, of all threads together.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from pairs import missing

from moldloft import implicit as im

BALLS, SEGMENTS = 10_000, 24
SIDE, ROUND = 14, 64


def seconds(work: Callable[[], object]) -> tuple[float, object]:
    start = time.process_time()
    result = work()
    return time.process_time() - start, result


def balls() -> tuple[np.ndarray, float]:
    """Centres in the unit cube, and the radius by which their volume stays the same."""
    return np.random.default_rng(1).uniform(0, 1, (BALLS, 3)), 0.5 * BALLS ** (-1 / 3)


def struts() -> list[tuple[np.ndarray, int]]:
    """Start and axis of each strut of a cubic lattice in the unit cube."""
    out = []
    for i in range(SIDE + 1):
        for j in range(SIDE + 1):
            for k in range(SIDE + 1):
                at = np.array([i, j, k])
                out += [(at / SIDE, axis) for axis in range(3) if at[axis] < SIDE]
    return out


def strut(start: np.ndarray, axis: int) -> im.Set:
    along = np.eye(3)[axis]
    bar = im.Set(im.cylinder(tuple(start), tuple(along), 0.12 / SIDE))
    near, far = tuple(start), tuple(start + along / SIDE)
    return bar & im.plane(tuple(-along), near) & im.plane(tuple(along), far)


def report(name: str, work: Callable[[], tuple[int, str]]) -> None:
    spent, (triangles, more) = seconds(work)  # type: ignore[misc]
    per = 1e6 * spent / max(triangles, 1)
    print(f"{name:40} {spent:7.2f} s  {triangles:8} triangles  {per:5.1f} us each  {more}")


def ours(body: im.Set, low: float, high: float, depth: int) -> tuple[int, str]:
    facets = body.facets((low,) * 3, (high,) * 3, depth=depth)
    facts = f"closed {facets.closed}, blunt {len(facets.blunt)}, undecided {len(facets.undecided)}"
    return len(facets.triangles), f"{facts}, unresolved {len(facets.unresolved)}"


def main() -> None:
    if len(sys.argv) == 3:
        model = Path(sys.argv[1])
        body = im.Set(im.read_fidget(model.read_text()))
        depth = int(sys.argv[2])
        report(f"{model.name}, depth {depth}", lambda: ours(body, -1, 1, depth))
        return
    centres, radius = balls()
    body = im.union(*(im.sphere(tuple(p), radius) for p in centres))
    report(f"{BALLS} balls, depth 7", lambda: ours(body, -0.1, 1.1, 7))
    lattice = im.union(*(strut(*s) for s in struts()))
    report(f"{len(struts())} struts, depth 7", lambda: ours(lattice, -0.1, 1.1, 7))
    try:
        import manifold3d
    except ImportError as error:
        missing("manifold3d", error)
        return

    def union(parts: list[manifold3d.Manifold]) -> tuple[int, str]:
        return manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add).num_tri(), ""

    ball = manifold3d.Manifold.sphere(radius, SEGMENTS)
    name = f"Manifold, balls of {SEGMENTS} segments"
    report(name, lambda: union([ball.translate(p) for p in centres]))
    bar = manifold3d.Manifold.cylinder(1 / SIDE, 0.12 / SIDE, 0.12 / SIDE, ROUND)
    ways = [bar.rotate([0, 90, 0]), bar.rotate([-90, 0, 0]), bar]
    name = f"Manifold, struts of {ROUND} segments"
    report(name, lambda: union([ways[axis].translate(p) for p, axis in struts()]))


if __name__ == "__main__":
    main()
