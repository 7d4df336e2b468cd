"""Hydrostatics of vessels with parts: the first figures, and the righting arms.

Run with `python benches/hydrostatics.py`. Processor time; the least of three runs, each of a model
that is opened anew. Targets: 0.3 s for the first figures, 0.1 s for each heel with free trim.
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

import moldloft

GALLERY = Path(__file__).parent.parent / "examples"
VESSELS = [
    "gallery/merchant.sdl",
    "gallery/twin_shafts.sdl",
    "gallery/semisubmersible.sdl",
    "gallery/catamaran.sdl",
    "gallery/planing.sdl",
    "gallery/spar.sdl",
    "gallery/tug.sdl",
    "gallery/workboat.sdl",
    "gallery/swath.sdl",
    "gallery/swath_struts.sdl",
    "sailboat/yacht.sdl",
    "submarine/submarine.sdl",
    "platform/platform.sdl",
]
HEELS = np.radians([0.0, 10.0, 20.0, 30.0, 40.0])
TIMES = 3


def times(name: str) -> tuple[float, float]:
    """Seconds of the first figures and of each heel."""
    best = [float("inf")] * 2
    for _ in range(TIMES):
        model = moldloft.load(GALLERY / name)
        model.mesh()
        start = time.process_time()
        figures = model.hydrostatics()
        first = time.process_time() - start
        centre = (figures.lcb, 0.0, figures.vcb)
        start = time.process_time()
        model.righting_curve(HEELS, figures.volume, cg=centre, density=1.0)
        heel = (time.process_time() - start) / len(HEELS)
        best = [min(best[0], first), min(best[1], heel)]
    return best[0], best[1]


def main() -> None:
    """Prints a row for each vessel."""
    print(f"{'vessel':32} {'first figures':>14} {'each heel':>10}")
    for name in VESSELS:
        try:
            first, heel = times(name)
        except moldloft.errors.Error as error:
            print(f"{name:32} {str(error).splitlines()[0]}")
            continue
        print(f"{name:32} {first:12.3f} s {heel:8.3f} s")


if __name__ == "__main__":
    main()
