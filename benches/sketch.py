"""Sketches from Python: a dimension changed, to the updated solid, and the peers of it.

`python benches/sketch.py`; `cargo run --release -p moldloft-sketch --example timing` times the
library alone, faces of large wireframes included. The peers are SolveSpace's solver (`pip install
py-slvs`, GPL: for this comparison only), which solves the same section's dimensions as equations,
and OCCT (`pip install cadquery-ocp-novtk`), which rebuilds the same bodies. Round bodies and the
drawing board are in processor time, so that other processes count little.
"""

import math
import statistics
import sys
import time
from pathlib import Path

import moldloft


def stair(steps: int) -> str:
    """A stair as a section, extruded: 4 steps + 4 points, two dimensions a step."""
    corners = [(0, 0), (10 * steps, 0)]
    for k in range(steps - 1, -1, -1):
        corners += [(10 * (k + 1), 10 * (steps - k)), (10 * k, 10 * (steps - k))]
    lines = ["SKETCH STAIR 2D XZ"]
    lines += [f"POINT {k} {u} {v}" for k, (u, v) in enumerate(corners, 1)]
    lines.append(f"POLYLINE {' '.join(str(k + 1) for k in range(len(corners)))} CLOSE")
    for k in range(steps):
        low, high = 2 * k + 3, 2 * k + 4
        lines.append(f"DIM W{k} X {high} {low} = 1")
        lines.append(f"DIM H{k} Z {2 if k == 0 else 2 * k + 1} {low} = 1")
    return "\n".join([*lines, "EXTRUDE 5"])


def best(n, work):
    """The best time of n runs in milliseconds."""
    times = []
    for k in range(n):
        start = time.perf_counter()
        work(k)
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


def solvespace(steps: int):
    """The section of the stair among SolveSpace's constraints: the system and a distance of it."""
    from py_slvs import slvs

    system = slvs.System()
    origin, normal = system.addPoint3dV(0, 0, 0, 1), system.addNormal3dV(1, 0, 0, 0, 1)
    plane = system.addWorkplane(origin, normal, 1)
    corners = [(0, 0), (10 * steps, 0)]
    for k in range(steps - 1, -1, -1):
        corners += [(10 * (k + 1), 10 * (steps - k)), (10 * k, 10 * (steps - k))]
    group = [1] + [2] * (len(corners) - 1)
    points = [
        system.addPoint2dV(plane, float(u), float(v), g)
        for (u, v), g in zip(corners, group, strict=True)
    ]
    system.addPointsHorizontal(points[0], points[1], plane, 2)
    chosen = None
    for k in range(steps):
        below, low, high = (points[i] for i in (1 if k == 0 else 2 * k + 1, 2 * k + 2, 2 * k + 3))
        system.addPointsVertical(low, below, plane, 2)
        system.addPointsHorizontal(low, high, plane, 2)
        system.addPointsDistance(10.0, low, below, plane, 2)
        width = system.addPointsDistance(10.0, high, low, plane, 2)
        chosen = width if k == min(3, steps - 1) else chosen
    system.addPointsVertical(points[-1], points[0], plane, 2)
    assert system.solve(2) == 0
    return system, system.getConstraint(chosen)


def median(n, work):
    """The median processor time of n runs in milliseconds."""
    times = []
    for k in range(n):
        start = time.process_time()
        work(k)
        times.append(time.process_time() - start)
    return 1e3 * statistics.median(times)


def stairs_in_space(steps: int):
    """A drawn solid of 6 steps + 6 lines: places on the page, and pairs of points."""
    corners = [(0, 0)]
    for k in range(steps):
        corners += [(k, k + 1), (k + 1, k + 1)]
    corners.append((steps, 0))
    n = len(corners)
    axes = [(math.cos(math.radians(a)), math.sin(math.radians(a))) for a in (345, 40, 90)]
    page = [
        [20 * (x * axes[0][k] + y * axes[1][k] + z * axes[2][k]) for k in (0, 1)]
        for y in (0, 3)
        for x, z in corners
    ]
    rings = [[first + k, first + (k + 1) % n] for first in (0, n) for k in range(n)]
    return page, rings + [[k, n + k] for k in range(n)]


def board() -> None:
    """What a drawing board asks at 150 lines."""
    page, lines = stairs_in_space(24)
    sketch = moldloft.Sketch()
    sketch.run("SKETCH A\nAXES 345 40 90")
    points, drawn = sketch.draw(page, lines)
    sketch.run("TYPE AUTO; ACCEPT ALL; GENERATE FACES")
    print(f"a picture of {len(drawn)} lines:")
    u, v = page[25]
    meant = median(50, lambda k: sketch.snaps(u + 0.1 * k, v, reach=8))
    print(f"  meanings of a pointer   {meant:8.3f} ms")

    def line(k):
        sketch.run(f"POINT 900 {u + k} {v - 9}; LINE {points[3]} 900")
        sketch.run("DELETE POINT 900")

    print(f"  a line drawn, deleted   {median(15, line):8.3f} ms")
    with sketch.drag() as drag:
        moved = median(25, lambda k: drag.move(points[25], u + 0.01 * k, v))
        print(f"  a step of a drag        {moved:8.3f} ms")
    name = next(iter(sketch.dimensions))
    value = sketch[name]

    def change(k):
        sketch[name] = value * (1 + 1e-3 * k)
        sketch.mesh()

    print(f"  a number, to the mesh   {median(25, change):8.3f} ms")


FLANGE = """SKETCH FLANGE 2D XY; CIRCLE DIAMETER 120 AT 0 0; GENERATE FACES
EXTRUDE FLANGE 12 INTO DISC
HOLE DISC 40 AT 0 0 INTO BORED; HOLE BORED 11 AT 45 0 POLAR 8 45 INTO DRILLED"""


def flange() -> None:
    """One number of a flange with a bolt circle, and all of them, beside OCCT."""
    sketch = moldloft.Sketch()
    sketch.run(FLANGE)

    def one(k):
        sketch.run(f"SET DRILLED.HOLE2 {11 + 0.01 * k}")
        assert sketch.objects["DRILLED"]["volume"]

    def every(k):
        x = 0.01 * k
        with sketch.drag():
            sketch.run(f"SET FLANGE.DIAMETER1 {120 + x}; SET DISC.EXTRUDE1 {12 + x}")
            sketch.run(f"SET BORED.HOLE1 {40 + x}; SET DRILLED.HOLE2 {11 + x}")
        assert sketch.objects["DRILLED"]["volume"]

    print(f"a hole of a flange with nine  {median(9, one):8.1f} ms")
    print(f"all of its numbers            {median(9, every):8.1f} ms")
    sys.path.insert(0, str(Path(__file__).parents[1] / "tests/python/helpers"))
    try:
        from sketch_ordinary import cut, measures, rod, turned
    except ImportError:
        return

    def rebuilt(k):
        disc = rod("A", "z", 60.0 + k, (0.0, 0.0, 0.0), 12.0)
        tools = [rod("B", "z", 20.0, (0.0, 0.0, -1.0), 14.0)]
        for j in range(8):
            tool = rod(f"H{j}", "z", 5.5, (45.0, 0.0, -1.0), 14.0)
            tools.append(turned(tool, "z", 45.0 * j, (0.0, 0.0, 0.0)))
        assert measures(cut("P", disc, *tools).solid)[0]

    print(f"OCCT, the same body           {median(9, rebuilt):8.1f} ms")


def main() -> None:
    """Prints the times."""
    board()
    flange()
    sketch = moldloft.Sketch()
    start = time.perf_counter()
    sketch.run(stair(249))
    print(f"{len(sketch.points)} points drawn, dimensioned, extruded   "
          f"{1e3 * (time.perf_counter() - start):8.1f} ms")  # fmt: skip

    def change(k):
        sketch.run(f"SET W3 {1 + 1e-3 * k}")

    print(f"SET of a dimension, with all checks         {best(200, change):8.3f} ms")
    values = [1 + 1e-3 * k for k in range(200)]
    swept = best(5, lambda k: sketch.sweep("W3", values))
    print(f"a value of a sweep: volume, area, centroid  {swept / 200:8.3f} ms")
    try:
        import py_slvs  # noqa: F401
    except ImportError:
        return
    for steps in (30, 249):
        system, width = solvespace(steps)

        def solve(k, system=system, width=width):
            width.valA = 10 + 1e-3 * k
            assert system.solve(2) == 0

        name = f"SolveSpace, the section's {2 * steps + 2} points alone"
        print(f"{name:44}{best(3, solve):8.3f} ms")


if __name__ == "__main__":
    main()
