"""Sketches from Python: a dimension changed, to the updated solid, and the peer of it.

`python benches/sketch.py`; `cargo run --release -p moldloft-sketch --example timing` times the
library alone, faces of large wireframes included. The peer is SolveSpace's solver (`pip install
py-slvs`, GPL: for this comparison only), which solves the same section's dimensions as equations.
"""

import time

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


def main() -> None:
    """Prints the times."""
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
