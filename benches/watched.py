"""Processor time of what users wait for, compared with kept figures of the same type of machine.

    python benches/watched.py FILE [--bound 0.1] [--keep]

Without FILE, or with `--keep`, the figures are written there; otherwise each is compared, and the
status is 1 where one is beyond its bound after three tries. A figure is the processor time of all
threads as a multiple of a fixed piece of work of NumPy's, done in turns with it: machines of one
type differ in clock and in neighbours, hardly in that ratio. `make optimised` first.
"""

from __future__ import annotations

import argparse
import gc
import itertools
import json
import platform
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from surface import surface

import moldloft

ROOT = Path(__file__).resolve().parent.parent
GALLERY = ROOT / "examples" / "gallery"
TURNS, TRIES = 15, 3
POINTS = "AbsPoint A(0, 0, 0); AbsPoint B(1, 0, 0); AbsPoint C(1, 1, 0); AbsPoint D(0, 1, 0);"
PATCH = POINTS + "Line l(A, B); Line n(D, C); RuledSurf s(l, n, divisions = {{{0}, {0}}});"
STATEMENT = "c = p0*(1 - u)^3 + 3*p1*u*(1 - u)^2 + 3*p2*u^2*(1 - u) + p3*u^3;"


def reference() -> Callable[[], object]:
    """The piece of work that all figures are multiples of: arithmetic, memory, a sort."""
    a = np.random.default_rng(1).random(200_000)
    return lambda: np.sort(np.sqrt(a * a + 1.0)).sum()


def statements(count: int, turns: int) -> Callable[[], object]:
    """A program with one array statement, many times."""
    head = "vector p0 = {0, 0, 0}, p1 = {1, 2, 0}, p2 = {3, 2, 1}, p3 = {4, 0, 1};"
    body = f"farray u = uniform(0, 1, {count}); curve c[{count}];"
    text = f"{head}{body} for (k = 1:{turns}) {{ {STATEMENT} }}"
    return lambda: moldloft.loads(text)


def edits(model: moldloft.Model) -> Callable[[], object]:
    """A point of the yacht is moved and its panels are made anew."""
    name = next(n for n in model.objects if model[n].kind == "AbsPoint")
    x = model.eval(f"{name}.x")
    steps = itertools.cycle([1e-3, 0.0])

    def work() -> object:
        model[f"{name}.x"] = x + next(steps)
        return model.mesh().area

    return work


def rows() -> Iterator[tuple[str, Callable[[], object]]]:
    """Names and pieces of work."""
    s = surface()
    t = np.linspace(0, 1 - 1e-12, 1000)
    near = s.grid(32, 32).reshape(-1, 3)[:1000] + np.array([0, 0, 4e-3])
    yield "tensor grid of 10^6 points", lambda: s.grid(1000, 1000)
    yield "grid at 1000 x 1000 parameters", lambda: s(t[:, None], t[None, :])
    yield "nearest 1 000 points", lambda: s.nearest(near)
    yield "array statement, 60 points", statements(60, 4_000)
    yield "array statement, 10^4 points", statements(10_000, 40)
    yield "array statement, 10^6 points", statements(1_000_000, 4)
    sheet = "surface s[500,500]; for (i = 1:500) s[i,].x = i; for (j = 1:500) s[,j].y = j;"
    sheets = f"{sheet} for (k = 1:20) s = tfi(s);"
    yield "transfinite sheets, 500 x 500", lambda: moldloft.loads(sheets)
    loop = "float x = 0; for (k = 1:1e6) x = x + sqrt(k);"
    yield "loop on numbers", lambda: moldloft.loads(loop)
    rng = np.random.default_rng(3)
    x = np.linspace(0, 10, 1000)
    noisy = np.column_stack([x, np.sin(x) + 1e-3 * rng.uniform(-1, 1, len(x))])
    yield "fairing 1 000 points", lambda: moldloft.fair(noisy, 1e-3)
    tee = (ROOT / "examples" / "implicit" / "tee.sdl").read_text(encoding="utf-8")
    yield "facets of a tee", lambda: moldloft.loads(tee).mesh()
    large = moldloft.loads(PATCH.format(1000))
    yield "STL of 10^6 panels", lambda: large.encoded("stl", "plate")
    yacht = ROOT / "examples" / "sailboat" / "hull.sdl"
    yield "yacht opened", lambda: moldloft.load(yacht)
    yield "yacht after a change", edits(moldloft.load(yacht))
    merchant = moldloft.load(GALLERY / "merchant.sdl")
    floating = merchant.hydrostatics(density=1.025)
    mass, cg = floating.displacement, (floating.lcb, 0, 5)
    heels = np.radians(np.arange(0, 61, 5.0))
    yield (
        "righting arms at 13 heels, free trim",
        lambda: merchant.righting_curve(heels, mass, cg=cg, density=1.025),
    )


def figure(work: Callable[[], object], beside: Callable[[], object]) -> float:
    """Median over the turns of the ratio of processor times."""

    def spent(work: Callable[[], object]) -> float:
        begin = time.process_time()
        work()
        return time.process_time() - begin

    work(), beside()
    gc.disable()
    try:
        return statistics.median(spent(work) / spent(beside) for _ in range(TURNS))
    finally:
        gc.enable()


def machine() -> str:
    """The type of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if "model name" in line)
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def main() -> int:
    """Measure, and compare or keep."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("--bound", type=float, default=0.1)
    parser.add_argument("--keep", action="store_true")
    options = parser.parse_args()
    kept: dict[str, float] = {}
    if options.file.exists() and not options.keep:
        found = json.loads(options.file.read_text(encoding="utf-8"))
        kept = found["figures"] if found["machine"] == machine() else {}
    beside, measured, slower = reference(), {}, []
    for name, work in rows():
        most = kept.get(name, np.inf) * (1 + options.bound)
        measured[name] = figure(work, beside)
        for _ in range(TRIES - 1):
            if measured[name] > most:
                measured[name] = min(measured[name], figure(work, beside))
        was = f"{kept[name]:10.3f}" if name in kept else "         -"
        print(f"{name:<40}{was}{measured[name]:10.3f}", flush=True)
        if measured[name] > most:
            slower.append(name)
    if not kept:
        options.file.parent.mkdir(parents=True, exist_ok=True)
        text = json.dumps({"machine": machine(), "figures": measured}, indent=1)
        options.file.write_text(text + "\n", encoding="utf-8")
    for name in slower:
        print(f"slower than kept: {name}: {measured[name] / kept[name]:.2f} times", file=sys.stderr)
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
