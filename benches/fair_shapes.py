"""Eight shapes under noise: inflections, monotone pieces and distance from the truth, beside peers.

Each shape has 15, 31 and 61 points at even, half and jittered places, with noise of a thousandth
of its length in a ball, the tolerance. For each method: the mean number of inflections and of
monotone pieces of the curvature, counted alike for all, and the median distance from the truth over
the noise; beside the shape its own numbers. Peers that are not installed are left out.

    python benches/fair_shapes.py [SEEDS]
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
from fair_truth import METHODS as PEERS
from fair_truth import Curve, Floats, bends, changes, distances, ours, runs

DENSE = np.linspace(-0.01, 1.01, 20001)
COUNTS = (15, 31, 61)
SPACINGS = ("even", "half", "jitter")
METHODS = {
    "near": PEERS["moldloft near"],
    "near, chord": ours(spacing="chord"),
    "fairest": PEERS["moldloft fairest"],
    "OCCT": PEERS["OCCT variational"],
    "SciPy": PEERS["SciPy make_splprep"],
}


def plane(x: Callable[[Floats], Floats], y: Callable[[Floats], Floats]) -> Curve:
    return lambda t: np.stack([x(t), y(t)], -1)


SHAPES: dict[str, Curve] = {
    "line": plane(lambda t: 10 * t, lambda t: t),
    "parabola": plane(lambda t: 10 * t, lambda t: 4 * t * (1 - t)),
    "arc": plane(lambda t: 5 * np.cos(2 * t), lambda t: 5 * np.sin(2 * t)),
    "catenary": plane(lambda t: 10 * t - 5, lambda t: 2 * np.cosh(4 * t - 2)),
    "sheer": plane(lambda t: 10 * t, lambda t: 1.2 - 0.9 * t + 1.1 * t**2 + 0.35 * t**4),
    "S": plane(lambda t: 10 * t, lambda t: np.tanh(4 * (t - 0.5))),
    "spiral": plane(
        lambda t: 3 * np.exp(1.2 * t) * np.cos(2.6 * t),
        lambda t: 3 * np.exp(1.2 * t) * np.sin(2.6 * t),
    ),
    "Bezier": plane(
        lambda t: 3 * t * (1 - t) ** 2 + 21 * t**2 * (1 - t) + 10 * t**3,
        lambda t: 12 * t * (1 - t) ** 2 + 15 * t**2 * (1 - t) + t**3,
    ),
}


def places(kind: str, n: int, g: np.random.Generator) -> Floats:
    t = np.linspace(0, 1, n)
    if kind == "jitter":
        t[1:-1] += g.uniform(-0.35, 0.35, n - 2) / (n - 1)
    if kind == "half":
        t = np.linspace(0, 1, n - n // 3)
        middle = (t[1:4] + t[:3]) / 2
        t = np.sort(np.concatenate([t, middle, 1 - middle]))
    return t


def counted(curve: Curve, most: float) -> tuple[int, int]:
    """Inflections and monotone pieces of the curvature, without the outer two hundredths.

    A curvature counts from 2 % of ``most`` on, a reversal from 1 % of the range, which is none
    below 1 % of it.
    """
    bend = bends(curve, np.linspace(0.005, 0.995, 1481))
    straight = np.ptp(bend) <= 0.01 * most
    return changes(bend, 0.02 * most), 1 if straight else runs(bend, 0.01 * np.ptp(bend))


def cases(shape: Curve, noise: float, seeds: int) -> list[Floats]:
    out = []
    for kind in SPACINGS:
        for n in COUNTS:
            for seed in range(seeds):
                g = np.random.default_rng(7 * seed + n)
                p = shape(places(kind, n, g))
                e = g.uniform(-1, 1, p.shape)
                out.append(p + noise * e / np.maximum(1, np.hypot(*e.T))[:, None])
    return out


def main() -> None:
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 2
    print(f"{'':20} " + " ".join(f"{name:>16}" for name in METHODS))
    for name, shape in SHAPES.items():
        truth = shape(DENSE)
        inner = shape(np.linspace(0, 1, 2001))
        length = float(np.linalg.norm(np.diff(inner, axis=0), axis=1).sum())
        noise = 1e-3 * length
        bend = bends(shape, np.linspace(0.0025, 0.9975, 1991))
        most = max(float(np.abs(bend).max()), 0.05 / length)
        data = cases(shape, noise, seeds)
        row = []
        for method in METHODS.values():
            try:
                curves = [method(points, noise) for points in data]
            except ImportError:
                row.append("not installed")
                continue
            counts = np.array([counted(c, most) for c in curves], float).mean(axis=0)
            fine = np.linspace(0, 1, 1001)
            rms = [np.sqrt((distances(c(fine), truth) ** 2).mean()) / noise for c in curves]
            row.append(f"{counts[0]:.2f} {counts[1]:.1f} {np.median(rms):.2f}")
        own = counted(shape, most)
        head = f"{name} ({own[0]}, {own[1]})"
        print(f"{head:20} " + " ".join(f"{x:>16}" for x in row), flush=True)


if __name__ == "__main__":
    main()
