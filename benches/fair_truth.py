"""How near to the truth fairing comes, beside SciPy, geomdl and OCCT: known shapes, bounded noise.

Six shapes at 49 places of four spacings, noise of uniform coordinates within a ball, the tolerance
that ball. Printed for each method: the root mean square distance of the curve from the truth over
the noise, the median and the largest of the cases; the largest distance of a datum over the noise;
the most inflections and monotone pieces of the curvature beyond those of the truth; the time of a
case. Peers that are not installed are left out.

    python benches/fair_truth.py [SEEDS]
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

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


TRUE_FORM = {
    "clothoid": (0, 1),
    "naca": (0, 2),
    "hollow": (1, 3),
    "helix": (0, 1),
    "ellipse": (0, 2),
    "areas": (2, 2),
}
"""Inflections and monotone pieces of the curvature of the shapes, as `form` counts them."""

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
    near = cKDTree(line).query(points)[1]
    out = np.full(len(points), np.inf)
    for first in (near - 1, near):
        a = np.clip(first, 0, len(line) - 2)
        v = line[a + 1] - line[a]
        off = points - line[a]
        s = np.clip((off * v).sum(1) / (v * v).sum(1), 0, 1)
        out = np.minimum(out, np.linalg.norm(off - s[:, None] * v, axis=1))
    return out


def form(curve: Curve, n: int = 3001) -> tuple[int, int]:
    """Inflections (of plane curves) and monotone pieces of the curvature.

    At places even in arc length, without the outer hundredths; a reversal counts from 1 % of the
    range and 2 % of the largest curvature on. Central differences, so that all curves are alike.
    """
    t = np.linspace(0, 1, 8001)
    arc = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(curve(t), axis=0), axis=1))])
    t = np.interp(np.linspace(0.01, 0.99, n) * arc[-1], arc, t)
    bend = bends(curve, t)
    most = float(np.abs(bend).max())
    floor = max(0.01 * np.ptp(bend), 0.02 * most)
    return changes(bend, 1e-3 * most), runs(bend, floor)


def changes(bend: Floats, least: float) -> int:
    """Changes of the sign of values above ``least``."""
    signs = np.sign(bend[np.abs(bend) > least])
    return int((signs[1:] != signs[:-1]).sum())


def runs(bend: Floats, floor: float) -> int:
    """Monotone runs of values, where reversals above ``floor`` count."""
    pieces, way, low, high = 1, 0, bend[0], bend[0]
    for x in bend:
        low, high = min(low, x), max(high, x)
        if way >= 0 and high - x > floor:
            pieces, way, low = pieces + (way > 0), -1, x
        elif way <= 0 and x - low > floor:
            pieces, way, high = pieces + (way < 0), 1, x
    return pieces


def bends(curve: Curve, t: Floats) -> Floats:
    """The curvature, signed for plane curves, by central differences."""
    h = 1e-4
    before, here, after = curve(t - h), curve(t), curve(t + h)
    d1, d2 = (after - before) / (2 * h), (after - 2 * here + before) / h**2
    speed = np.linalg.norm(d1, axis=1)
    if here.shape[1] == 2:
        return (d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0]) / speed**3
    return np.linalg.norm(np.cross(d1, d2), axis=1) / speed**3


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

    try:
        from OCP.TColgp import TColgp_Array1OfPnt as PointArray
    except ImportError:  # since OCCT 8
        from OCP.collections import Array1_gp_Pnt as PointArray

    rows = PointArray(1, len(data))
    for k, p in enumerate(data, 1):
        rows.SetValue(k, gp_Pnt(*[float(x) for x in p], *[0.0] * (3 - len(p))))
    made = GeomAPI_PointsToBSpline(rows, 0.2, 0.4, 0.4, 8, GeomAbs_Shape.GeomAbs_C2, noise)
    curve = made.Curve()
    low, high = curve.FirstParameter(), curve.LastParameter()

    def at(t: Floats) -> Floats:
        out = np.empty((len(t), 3))
        for k, x in enumerate(t):
            p = curve.Value(low + (high - low) * float(x))
            out[k] = p.X(), p.Y(), p.Z()
        return out[:, : data.shape[1]]

    return at


METHODS: dict[str, Callable[[Floats, float], Curve]] = {
    "moldloft near": ours(),
    "moldloft fairest": ours(goal="fairest"),
    "SciPy make_splprep": scipy_spline,
    "geomdl, 20 control points": geomdl_least_squares,
    "OCCT variational": occt_variational,
}


@dataclass(frozen=True)
class Score:
    """How well a method did on a case."""

    rms: float
    """Root mean square distance from the truth over the noise."""
    data: float
    """The largest distance of a datum over the noise."""
    inflections: int
    """Inflections beyond those of the truth."""
    pieces: int
    """Monotone pieces of the curvature beyond those of the truth."""
    seconds: float


def score(method: Callable[[Floats, float], Curve], shape: Curve, kind: str, seed: int) -> Score:
    truth, data, noise = case(shape, kind, seed)
    started = time.perf_counter()
    curve = method(data, noise)
    seconds = time.perf_counter() - started
    fine = curve(np.linspace(0, 1, 8001))
    inflections, pieces = form(curve)
    true_inflections, true_pieces = TRUE_FORM[shape.__name__]
    return Score(
        float(np.sqrt((distances(fine[::4], truth) ** 2).mean())) / noise,
        float(distances(data, fine).max()) / noise,
        0 if data.shape[1] == 3 else inflections - true_inflections,
        pieces - true_pieces,
        seconds,
    )


def main() -> None:
    seeds = range(1, 1 + int(sys.argv[1] if len(sys.argv) > 1 else 2))
    heads = ("spacing", "rms median", "largest", "data", "inflections", "pieces", "ms")
    print(f"{'':28} " + " ".join(f"{h:>{max(7, len(h))}}" for h in heads))
    for name, method in METHODS.items():
        for kind in SPACINGS:
            try:
                all_ = [score(method, shape, kind, seed) for shape in SHAPES for seed in seeds]
            except ImportError as error:
                print(f"{name:28} not installed: {error.name}")
                break
            rms = [s.rms for s in all_]
            print(
                f"{name:28} {kind:>7} {np.median(rms):10.2f} {max(rms):7.2f} "
                f"{max(s.data for s in all_):7.2f} {max(s.inflections for s in all_):11d} "
                f"{max(s.pieces for s in all_):7d} "
                f"{1e3 * np.median([s.seconds for s in all_]):7.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
