"""Fairing beside SciPy's smoothing splines, on the same data and within the same bound.

SciPy's splines have no bound on the deviation: `make_splprep` takes a budget for the sum of
squares and `make_smoothing_spline` a weight, so both are sought by bisection until the largest
distance of a data point is just within the bound; the time of one call at the end is reported, and
that of the search. All curves are compared where the data are: largest distance, squared jumps of
the third derivative (in units of the mean distance of the data's parameters), monotone pieces of
the curvature. Ends are free, as SciPy's are.

Run with `python benches/fair.py [points …]`.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from pairs import missing

from moldloft import fair
from moldloft.fairing import monotone_runs


def noisy(n: int) -> tuple[np.ndarray, float]:
    """A waisted body of n points with noise, and a bound that the noise does not pass."""
    x = np.arange(n) / (n - 1)
    random = np.random.default_rng(1)
    noise = 2e-4 * 60 / n
    y = 0.05 - 0.02 * np.exp(-(((x - 0.55) / 0.15) ** 2)) + 0.01 * (1 - (2 * x - 1) ** 2)
    return np.column_stack([x, y + noise * (random.random(n) - 0.5)]), noise


def reported(name: str, seconds: float, curve: object, points: np.ndarray, at: np.ndarray) -> str:
    """A line about a curve that gives positions and derivatives at data parameters."""
    here = curve(at, 0)
    far = np.linalg.norm(here - points, axis=1).max()
    fine = np.linspace(at[0], at[-1], 16 * len(points))
    d1, d2 = curve(fine, 1), curve(fine, 2)
    bend = (d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0]) / np.hypot(*d1.T) ** 3
    pieces = monotone_runs(bend)
    # The third derivative is constant between knots: its total jumps between data parameters.
    third = curve(0.5 * (at[1:] + at[:-1]), 3) * np.mean(np.diff(at)) ** 3
    jumps = (np.diff(third, axis=0) ** 2).sum()
    return (
        f"{name:34} {1e3 * seconds:10.2f} ms  deviation {far:.3e}  jumps {jumps:.3e}  "
        f"pieces {pieces}"
    )


def ours(points: np.ndarray, tol: float, **options: object) -> tuple[float, object]:
    """Our curve through the points, faired; the parameter of point i is i."""
    times = []
    for _ in range(5):
        started = time.perf_counter()
        chosen = {"as_": "fit", "spacing": "index", "ends": "free", **options}
        result = fair(points, tol, **chosen)
        times.append(time.perf_counter() - started)
    spline, n = result.spline, len(points)

    def curve(t: np.ndarray, order: int) -> np.ndarray:
        samples = spline.at(np.asarray(t) / (n - 1))
        rows = (samples.points, samples.first, samples.second, samples.third)[order]
        return rows[:, :2] / (n - 1.0) ** order

    return float(np.median(times)), curve


def sought(make: object, points: np.ndarray, at: np.ndarray, tol: float, low: float, high: float):
    """The smoothest curve within the bound, by bisection of the logarithm of its weight."""
    started = time.perf_counter()
    for _ in range(30):
        middle = np.sqrt(low * high)
        curve = make(middle)
        far = np.linalg.norm(curve(at, 0) - points, axis=1).max()
        low, high = (middle, high) if far <= tol else (low, middle)
    search = time.perf_counter() - started
    started = time.perf_counter()
    curve = make(low)
    return time.perf_counter() - started, search, curve


def main() -> None:
    sizes = [int(a) for a in sys.argv[1:]] or [61, 1000, 10_000]
    try:
        from scipy.interpolate import make_smoothing_spline, make_splprep
    except ImportError as error:
        missing("SciPy", error)
        return
    for n in sizes:
        points, tol = noisy(n)
        at = np.arange(n, dtype=float)
        print(f"{n} points, bound {tol:.2e}")
        for measure in ("second", "jumps"):
            seconds, curve = ours(points, tol, measure=measure)
            print("  " + reported(f"ours, optimum of {measure}", seconds, curve, points, at))
        seconds, curve = ours(points, tol, measure="jumps", as_="points")
        print("  " + reported("ours, optimum of jumps, points", seconds, curve, points, at))
        seconds, curve = ours(points, tol, mode="faithful")
        print("  " + reported("ours, faithful, n steps", seconds, curve, points, at))

        def smoothing(weight: float, points: np.ndarray = points, at: np.ndarray = at) -> object:
            parts = [make_smoothing_spline(at, points[:, c], lam=weight) for c in (0, 1)]
            return lambda t, k: np.column_stack([p(t, nu=k) for p in parts])

        one, search, curve = sought(smoothing, points, at, tol, 1e-8, 1e12)
        print("  " + reported("SciPy make_smoothing_spline", one, curve, points, at))
        print(f"  {'  with its search':34} {1e3 * search:10.2f} ms")
        if n <= 2000:

            def knots(budget: float, points: np.ndarray = points, at: np.ndarray = at) -> object:
                spline, _ = make_splprep(points.T, u=at, s=budget)
                return lambda t, k: spline(t, nu=k).T

            one, search, curve = sought(knots, points, at, tol, 1e-6 * n * tol**2, 4.0 * n * tol**2)
            print("  " + reported("SciPy make_splprep", one, curve, points, at))
            print(f"  {'  with its search':34} {1e3 * search:10.2f} ms")


if __name__ == "__main__":
    main()
