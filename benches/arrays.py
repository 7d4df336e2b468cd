"""Array statements: the Bezier curve of the SDL paper, beside NumPy and a fused compiled loop.

Run with `python benches/arrays.py`; peers that are not installed are named. Times are the least of
several repetitions, per point, and processor time, so that other work on the machine counts little;
all run on one thread. Ours are of a statement inside a running program, taken as the difference of
two runs, so that starting and parsing do not count.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

import moldloft

SIZES = [60, 1_000, 10_000, 100_000, 1_000_000]
STATEMENT = "c = p0*(1 - u)^3 + 3*p1*u*(1 - u)^2 + 3*p2*u^2*(1 - u) + p3*u^3;"
POINTS = np.array([[0.0, 0, 0], [1, 2, 0], [3, 2, 1], [4, 0, 1]])


def least(work: Callable[[], object], seconds: float = 1.0) -> float:
    """The least processor time of one call, in seconds."""
    start = time.process_time()
    work()
    # Short calls in batches, so that reading the clock does not count.
    count = max(1, int(1e-3 / max(time.process_time() - start, 1e-7)))
    end = time.perf_counter() + seconds
    best = float("inf")
    while time.perf_counter() < end:
        start = time.process_time()
        for _ in range(count):
            work()
        best = min(best, (time.process_time() - start) / count)
    return best


def ours(n: int) -> float:
    """Seconds for one statement on n points."""
    repeats = max(16, min(2_000, 4_000_000 // n))
    head = "vector p0 = {0, 0, 0}, p1 = {1, 2, 0}, p2 = {3, 2, 1}, p3 = {4, 0, 1};\n"
    head += f"farray u = uniform(0, 1, {n}); curve c[{n}];\n"

    def model(statement: str) -> moldloft.Model:
        return moldloft.loads(head + f"for (k = 1:{repeats}) {{ {statement} }}")

    full, empty = model(STATEMENT), model(";")
    text = [full.text, empty.text]

    def run(m: moldloft.Model, t: str) -> Callable[[], object]:
        return lambda: m._document.set_text(t)

    return (least(run(full, text[0])) - least(run(empty, text[1]), 0.3)) / repeats


def numpy_rows(n: int) -> Callable[[], object]:
    """NumPy's expression, points as rows."""
    u = np.linspace(0, 1, n)[:, None]
    p0, p1, p2, p3 = POINTS
    return lambda: (
        p0 * (1 - u) ** 3 + 3 * p1 * u * (1 - u) ** 2 + 3 * p2 * u**2 * (1 - u) + p3 * u**3
    )


def numba_planes(n: int) -> Callable[[], object]:
    """A fused compiled loop over three planes."""
    import numba

    @numba.njit(fastmath=False)
    def bezier(p: np.ndarray, u: np.ndarray, out: np.ndarray) -> None:
        for i in range(u.size):
            v = 1 - u[i]
            a, b = v * v * v, 3 * u[i] * v * v
            c, d = 3 * u[i] * u[i] * v, u[i] * u[i] * u[i]
            for k in range(3):
                out[k, i] = p[0, k] * a + p[1, k] * b + p[2, k] * c + p[3, k] * d

    u, out = np.linspace(0, 1, n), np.empty((3, n))
    bezier(POINTS, u, out)
    return lambda: bezier(POINTS, u, out)


def main() -> None:
    """Prints the table."""
    print("Bezier statement, ns per point")
    print(f"{'points':>9} {'ours':>8} {'NumPy':>8} {'ratio':>7} {'compiled':>9} {'ratio':>7}")
    for n in SIZES:
        mine, theirs = ours(n) / n * 1e9, least(numpy_rows(n)) / n * 1e9
        try:
            compiled = least(numba_planes(n)) / n * 1e9
            last = f"{compiled:9.2f} {mine / compiled:7.2f}"
        except ImportError:
            last = "   (numba is not installed)"
        print(f"{n:9d} {mine:8.2f} {theirs:8.1f} {theirs / mine:7.1f} {last}")


if __name__ == "__main__":
    main()
