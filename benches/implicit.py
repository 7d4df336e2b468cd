"""Implicit solids beside Manifold's `level_set`: the svLis manual's T-piece at equal cell size.

Manifold takes a Python function of one point, so most of its time is Python's; its times are
reported for what they are. Quality is compared too: distance of triangle centres from the surface,
self-intersections, volume. fidget is timed by a program of its own, `cargo run --release` in
`benches/fidget`. libfive is in no registry (PyPI has an old source package only): its figures in
docs/performance.md are those of another day, with fidget's of that day beside them.

Run with `python benches/implicit.py [depth …]` on a release build; RAYON_NUM_THREADS=1 for one
thread.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable

import numpy as np
from pairs import missing

from moldloft import implicit as im

LOW, HIGH = (-4.0, -4.0, -4.0), (4.0, 4.0, 4.0)


def tee() -> im.Set:
    """The T-piece with a fillet of lambda = 0.6."""
    x, y, z = im.axes()
    s, u = (x + z) / math.sqrt(2), (x - z) / math.sqrt(2)
    c1, c2 = y**2 + z**2 - 1, u**2 + y**2 - 0.36
    k = u**2 + y**2 - ((s - 4.5 * math.sqrt(2)) * math.tan(math.radians(8.5))) ** 2
    q = 0.6 * c1 * c2 - 0.4 * k**2
    top = im.Set(-s) & im.Set(s - 4)
    run = im.Set(c1) & im.Set(x - 3.5) & im.Set(-x - 3.5)
    return run | im.Set(c2) & top | im.Set(q) & im.Set(k) & top


def best(runs: int, work: Callable[[], object]) -> tuple[float, object]:
    """The shortest of several runs, and the last result."""
    times = []
    for _ in range(runs):
        started = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - started)
    return min(times), result


def report(name: str, seconds: float, triangles: int, rms: float, volume: float, cut: int) -> None:
    print(
        f"{name:28} {1e3 * seconds:9.1f} ms  {triangles:7} triangles  centre rms {rms:.2e}  "
        f"volume {volume - 25.097:+.4f}  crossing pairs {cut}"
    )


def centre_rms(part: im.Set, vertices: np.ndarray, triangles: np.ndarray) -> float:
    """Root mean square of |f| / |f'| at the triangles' centres, by the primitive that decides."""
    centres = vertices[triangles].mean(axis=1)
    winners = part.winner(centres)
    out = np.zeros(len(centres))
    for k, leaf in enumerate(part.leaves):
        at = centres[winners == k]
        if len(at):
            slope = np.linalg.norm(leaf.field.gradient(at), axis=1)
            out[winners == k] = leaf.field(at) / slope
    return float(np.sqrt(np.mean(out**2)))


class Fresh:
    """Facets of another box each time, so that nothing is taken over from before."""

    def __init__(self, part: im.Set, depth: int) -> None:
        self.part, self.depth, self.shift = part, depth, 0.0

    def __call__(self) -> im.Facets:
        """The facets."""
        self.shift += 1e-9
        return self.part.facets((LOW[0] - self.shift, *LOW[1:]), HIGH, depth=self.depth)


def main() -> None:
    depths = [int(d) for d in sys.argv[1:]] or [6, 7, 8]
    part = tee()
    points = np.random.default_rng(1).uniform(-4, 4, (1_000_000, 3))
    seconds, _ = best(5, lambda: part(points))
    print(f"values at 10^6 points: {1e9 * seconds / len(points):.1f} ns per point")
    for depth in depths:
        seconds, facets = best(5, Fresh(part, depth))
        rms = float(np.sqrt(np.mean(facets.centre_distances() ** 2)))
        count = len(facets.triangles)
        report(f"depth {depth}", seconds, count, rms, facets.volume, facets.crossings())
        print(f"{'':28} undecided boxes {len(facets.undecided)} of {facets.summary['cells']} cells")
        if depth > 6:
            seconds, simple = best(1, lambda facets=facets, rms=rms: facets.simplified(4 * rms))
            rms = float(np.sqrt(np.mean(simple.centre_distances() ** 2)))
            count = len(simple.triangles)
            report("  simplified", seconds, count, rms, simple.volume, simple.crossings())
    seconds, mass = best(3, lambda: part.mass(LOW, HIGH, depth=7))
    low, high = mass.volume_bracket
    print(f"mass at depth 7: {1e3 * seconds:.1f} ms, {mass.volume:.6f} in [{low:.4f}, {high:.4f}]")
    try:
        import manifold3d
    except ImportError as error:
        missing("manifold3d", error)
        return

    for depth in depths[:2]:
        edge = 8 / 2**depth

        def scalar(x: float, y: float, z: float) -> float:
            s, u = (x + z) / math.sqrt(2), (x - z) / math.sqrt(2)
            c1, c2 = y * y + z * z - 1, u * u + y * y - 0.36
            k = u * u + y * y - ((s - 4.5 * math.sqrt(2)) * math.tan(math.radians(8.5))) ** 2
            q = 0.6 * c1 * c2 - 0.4 * k * k
            top = max(-s, s - 4)
            return -min(max(c1, abs(x) - 3.5), max(c2, top), max(q, k, top))

        box = [*LOW, *HIGH]
        seconds, solid = best(
            1, lambda edge=edge, box=box: manifold3d.Manifold.level_set(scalar, box, edge)
        )
        mesh = solid.to_mesh()
        vertices = np.asarray(mesh.vert_properties)[:, :3].astype(float)
        triangles = np.asarray(mesh.tri_verts)
        rms = centre_rms(part, vertices, triangles)
        report(f"manifold level_set, {edge}", seconds, len(triangles), rms, solid.volume(), -1)


if __name__ == "__main__":
    main()
