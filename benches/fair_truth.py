"""How near to the truth fairing comes, beside SciPy, geomdl and OCCT: known shapes, bounded noise.

Six shapes at 49 places of four spacings, noise of uniform coordinates within a ball, the tolerance
that ball. Printed for each method: the root mean square distance of the curve from the truth over
the noise, the median and the largest of the cases, the largest distance of a datum over the noise,
and the time of a case. Peers that are not installed are left out.

    python benches/fair_truth.py [SEEDS]
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import moldloft

Floats = NDArray[np.float64]
Curve = Callable[[Floats], Floats]

DENSE = np.linspace(0, 1, 20001)


class Lcg:
    """u <- (1103515245 u + 12345) mod 2^31; values in [-1/2, 1/2)."""

    def __init__(self, seed: int) -> None:
        self.u = seed

    def __call__(self) -> float:
        self.u = (1103515245 * self.u + 12345) % 2**31
        return self.u / 2**31 - 0.5


def clothoid(u: Floats) -> Floats:
    t = np.linspace(0, 1, 40001)
    out = []
    for g in (np.cos(2.2 * t * t), np.sin(2.2 * t * t)):
        whole = np.concatenate([[0], np.cumsum((g[1:] + g[:-1]) / 2 * np.diff(t))])
        out.append(np.interp(u, t, whole))
    return np.stack(out, -1)


def naca(u: Floats) -> Floats:
    s = 2 * u - 1
    a, x = abs(s), s * s
    y = 0.2969 * a - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4
    return np.stack([x, np.sign(s) * 0.6 * y], -1)


def hollow(u: Floats) -> Floats:
    return np.stack([10 * u, 1.2 * (6 * u**5 - 15 * u**4 + 10 * u**3)], -1)


def helix(u: Floats) -> Floats:
    return np.stack([np.cos(4 * u), np.sin(4 * u), 0.9 * u], -1)


def ellipse(u: Floats) -> Floats:
    return np.stack([1.5 * np.cos(0.2 + 2.9 * u), 0.6 * np.sin(0.2 + 2.9 * u)], -1)


def areas(u: Floats) -> Floats:
    w = 2 * u - 1
    return np.stack([5 * u, (1 - w * w) ** 2 * (1 + 0.3 * w)], -1)


SHAPES = (clothoid, naca, hollow, helix, ellipse, areas)
SPACINGS = ("even", "half", "jitter", "random")


def places(kind: str, g: Lcg, n: int = 49) -> Floats:
    if kind == "even":
        return np.linspace(0, 1, n)
    if kind == "half":
        u = np.concatenate([np.arange(0, 8, 0.5), np.arange(8, 24), np.arange(24, 32.1, 0.5)])
        return u / u[-1]
    if kind == "jitter":
        u = np.arange(n) + np.array([0.7 * g() for _ in range(n)])
        u[0], u[-1] = 0, n - 1
        return u / (n - 1)
    drawn = [0.0, 1.0]
    while len(drawn) < n:
        x = g() + 0.5
        if min(abs(x - y) for y in drawn) > 2e-3:
            drawn.append(x)
    return np.sort(drawn)


def case(shape: Callable[[Floats], Floats], kind: str, seed: int) -> tuple[Floats, Floats, float]:
    g = Lcg(seed)
    u = places(kind, g)
    truth = shape(DENSE)
    noise = 2e-4 * float(np.linalg.norm(np.diff(truth, axis=0), axis=1).sum())
    p = shape(u)
    d = p.shape[1]
    e = np.array([[2 * g() for _ in range(d)] for _ in u]) * noise / np.sqrt(d)
    return truth, p + e, noise


def distances(points: Floats, line: Floats) -> Floats:
    """Distances of points from a fine polyline."""
    out = []
    for p in points:
        k = int(np.argmin(((line - p) ** 2).sum(1)))
        best = np.inf
        for a in (k - 1, k):
            if 0 <= a < len(line) - 1:
                v = line[a + 1] - line[a]
                s = np.clip((p - line[a]) @ v / (v @ v), 0, 1)
                best = min(best, float(np.linalg.norm(p - line[a] - s * v)))
        out.append(best)
    return np.array(out)


def ours(**options: object) -> Callable[[Floats, float], Curve]:
    def run(data: Floats, noise: float) -> Curve:
        spline = moldloft.fair(data, noise, **options).spline
        return lambda t: spline(t)[:, : data.shape[1]]

    return run


def scipy_spline(data: Floats, noise: float) -> Curve:
    from scipy.interpolate import make_splprep

    spline, _ = make_splprep(data.T, s=len(data) * noise**2 / 3)
    return lambda t: np.asarray(spline(t)).T


def geomdl_least_squares(data: Floats, noise: float) -> Curve:
    from geomdl import fitting

    curve = fitting.approximate_curve(data.tolist(), 3, ctrlpts_size=20)
    return lambda t: np.array(curve.evaluate_list([float(x) for x in t]))


def occt_variational(data: Floats, noise: float) -> Curve:
    from OCP.GeomAbs import GeomAbs_Shape
    from OCP.GeomAPI import GeomAPI_PointsToBSpline
    from OCP.gp import gp_Pnt
    from OCP.TColgp import TColgp_Array1OfPnt

    rows = TColgp_Array1OfPnt(1, len(data))
    for k, p in enumerate(data, 1):
        rows.SetValue(k, gp_Pnt(*[float(x) for x in p], *[0.0] * (3 - len(p))))
    made = GeomAPI_PointsToBSpline(rows, 0.2, 0.4, 0.4, 5, GeomAbs_Shape.GeomAbs_C2, noise).Curve()
    low, high = made.FirstParameter(), made.LastParameter()

    def at(t: Floats) -> Floats:
        points = [made.Value(low + (high - low) * float(x)) for x in t]
        return np.array([[p.X(), p.Y(), p.Z()] for p in points])[:, : data.shape[1]]

    return at


METHODS: dict[str, Callable[[Floats, float], Curve]] = {
    "moldloft near": ours(),
    "moldloft fairest": ours(goal="fairest"),
    "SciPy make_splprep": scipy_spline,
    "geomdl, 20 control points": geomdl_least_squares,
    "OCCT variational": occt_variational,
}


def main() -> None:
    seeds = range(1, 1 + int(sys.argv[1] if len(sys.argv) > 1 else 2))
    print(f"{'':28} {'spacing':8} {'rms median':>10} {'largest':>8} {'data':>6} {'ms':>7}")
    for name, method in METHODS.items():
        for kind in SPACINGS:
            rms, far, spent = [], [], []
            try:
                for shape in SHAPES:
                    for seed in seeds:
                        truth, data, noise = case(shape, kind, seed)
                        started = time.perf_counter()
                        curve = method(data, noise)
                        spent.append(time.perf_counter() - started)
                        line = curve(np.linspace(0, 1, 2001))
                        rms.append(float(np.sqrt((distances(line, truth) ** 2).mean())) / noise)
                        fine = curve(np.linspace(0, 1, 8001))
                        far.append(float(distances(data, fine).max()) / noise)
            except ImportError as error:
                print(f"{name:28} not installed: {error.name}")
                break
            print(
                f"{name:28} {kind:8} {np.median(rms):10.2f} {max(rms):8.2f} {max(far):6.2f} "
                f"{1e3 * np.median(spent):7.2f}"
            )


if __name__ == "__main__":
    main()
