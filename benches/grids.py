"""Structured grids: transfinite interpolation and elliptic sweeps beside NumPy and Gmsh.

Run with `python benches/grids.py`; peers that are not installed are named. A sheet of 500 x 500
points whose edges are curved and unevenly spaced. Times are the least of several repetitions, ours
those of a statement inside a running program: the difference of two runs.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import moldloft

N = 500
HEAD = f"""load "stdsubs.sdl"
int n = {N};
surface s[n,n];
farray a = d_tanh(0, 1, .001, .004, n), b = d_tanh(0, 1, .004, .001, n), e = uniform(0, 1, n);
s[,1] = {{a, .2*sin(PI*e), 0*e}};
s[,n] = {{b + .1, 1 + 0*e, 0*e}};
s[1,] = {{.1*b^2, b, 0*b}};
s[n,] = {{1 + .1*a^2, a, 0*a}};
s[1,1] = {{0, 0, 0}}; s[n,1] = {{1, 0, 0}}; s[1,n] = {{.1, 1, 0}}; s[n,n] = {{1.1, 1, 0}};
surface t[n,n];
"""


def least(work: Callable[[], object], seconds: float = 2.0) -> float:
    """The least time of one call, in seconds."""
    end = time.perf_counter() + seconds
    best = float("inf")
    while time.perf_counter() < end:
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
    return best


def ours(statement: str, repeats: int) -> float:
    """Seconds for one execution of a statement."""
    count = iter(range(1, 1_000_000))

    def run(body: str) -> Callable[[], object]:
        model = moldloft.loads(HEAD)

        def once() -> object:
            # Other edges each time, so that no result is remembered.
            each = f"s[2,1].y += 1e-9*({next(count)} + k/1000);"
            return model._document.set_text(HEAD + f"for (k = 1:{repeats}) {{ {each} {body} }}")

        return once

    return (least(run(statement)) - least(run(";"), 0.5)) / repeats


def edges() -> NDArray[np.float64]:
    """The same sheet, its inside not yet filled."""
    return np.array(moldloft.loads(HEAD)["s"])


def numpy_tfi(s: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same formula in whole arrays."""

    def fractions(c: NDArray[np.float64]) -> NDArray[np.float64]:
        sums = np.r_[0, np.cumsum(np.linalg.norm(np.diff(c, axis=0), axis=1))]
        return sums / sums[-1]

    s1, s2 = fractions(s[:, 0])[:, None], fractions(s[:, -1])[:, None]
    t1, t2 = fractions(s[0])[None, :], fractions(s[-1])[None, :]
    whole = 1 - (s2 - s1) * (t2 - t1)
    x = ((s1 + t1 * (s2 - s1)) / whole)[..., None]
    y = ((t1 + s1 * (t2 - t1)) / whole)[..., None]
    edge = (1 - x) * s[0] + x * s[-1] + (1 - y) * s[:, :1] + y * s[:, -1:]
    corners = (1 - x) * (1 - y) * s[0, 0] + x * (1 - y) * s[-1, 0]
    corners = corners + (1 - x) * y * s[0, -1] + x * y * s[-1, -1]
    return np.asarray(edge - corners)


def gmsh_tfi() -> float | None:
    """Seconds that Gmsh takes for a transfinite surface of as many points; `None` without it."""
    try:
        import gmsh
    except (ImportError, OSError):
        return None
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    best = float("inf")
    for _ in range(5):
        gmsh.model.add("sheet")
        geo = gmsh.model.geo
        p = [geo.addPoint(*xyz) for xyz in [(0, 0, 0), (1, 0, 0), (1.1, 1, 0), (0.1, 1, 0)]]
        middle = geo.addPoint(0.5, 0.2, 0)
        lines = [geo.addSpline([p[0], middle, p[1]])]
        lines += [geo.addLine(p[k], p[(k + 1) % 4]) for k in (1, 2, 3)]
        sheet = geo.addPlaneSurface([geo.addCurveLoop(lines)])
        for k in lines:
            geo.mesh.setTransfiniteCurve(k, N, "Progression", 1.003)
        geo.mesh.setTransfiniteSurface(sheet)
        geo.mesh.setRecombine(2, sheet)
        geo.synchronize()
        gmsh.model.mesh.generate(1)
        start = time.perf_counter()
        gmsh.model.mesh.generate(2)
        best = min(best, time.perf_counter() - start)
        gmsh.model.remove()
    gmsh.finalize()
    return best


def numpy_sweep(s: NDArray[np.float64]) -> None:
    """One Jacobi sweep of the same equations, points moved in place."""
    x, y = (s[2:] - s[:-2])[:, 1:-1] / 2, (s[:, 2:] - s[:, :-2])[1:-1] / 2
    a, b, c = (y * y).sum(-1), (x * y).sum(-1), (x * x).sum(-1)
    mixed = (s[2:, 2:] - s[2:, :-2] - s[:-2, 2:] + s[:-2, :-2]) / 4
    along = (s[2:] + s[:-2])[:, 1:-1]
    across = (s[:, 2:] + s[:, :-2])[1:-1]
    top = a[..., None] * along + c[..., None] * across - 2 * b[..., None] * mixed
    s[1:-1, 1:-1] = top / (2 * (a + c))[..., None]


def main() -> None:
    """Prints the tables."""
    print("Both processors may have other work: compare times of one run only.")
    s = edges()
    mine = ours('t = tfi(s, "arc");', 10)
    theirs = least(lambda: numpy_tfi(s))
    other = gmsh_tfi()
    same = np.abs(numpy_tfi(s) - np.array(moldloft.loads(HEAD + 't = tfi(s, "arc");')["t"])).max()
    print(f"{N} x {N}, transfinite by arc length: ours {mine * 1e3:.2f} ms")
    print(
        f"  NumPy {theirs * 1e3:.1f} ms ({theirs / mine:.0f} times), greatest difference {same:.1e}"
    )
    print("  gmsh is not installed" if other is None else f"  gmsh {other * 1e3:.0f} ms")
    for method in ("laplace", "middlecoff"):
        t = ours(f't = elliptic(tfi(s, "arc"), 200, 0, "{method}");', 1)
        print(f"200 line sweeps, {method}: ours {t:.3f} s")
    grid = numpy_tfi(s)
    t = least(lambda: numpy_sweep(grid), 3)
    print(f"  200 point (Jacobi) sweeps in NumPy: {200 * t:.1f} s")


if __name__ == "__main__":
    main()
