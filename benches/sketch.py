"""Sketches from Python: a dimension changed, to the updated solid; faces of a large wireframe.

`cargo run --release -p moldloft-sketch --example timing` times the library alone.
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


if __name__ == "__main__":
    main()
