"""A parameter is changed and the panels are asked for again, from Python: milliseconds a change.

The hull of the yacht at 100 x 200 panels, 30 patches of about 20 000 panels that share curves, and
the platform and the whole yacht, whose snakes are projections and intersections, as they are and
finer.
Run with `python benches/panels.py`. The aim is 16 ms, a picture's time.
"""

from __future__ import annotations

import gc
import itertools
import re
import statistics
import time
from pathlib import Path

import numpy as np

import moldloft

EXAMPLES = Path(__file__).parent.parent / "examples"
HULL = EXAMPLES / "sailboat" / "hull.sdl"
CHANGES = 60


def patches(count: int = 30, nu: int = 33, nv: int = 20) -> str:
    """A tower of ruled bands between B-splines; one parameter swells one curve in the middle."""
    lines = ["param float swell = 1 in [0.5, 2];"]
    for k in range(count + 1):
        bulge = "swell" if k == count // 2 else "1"
        lines.append(
            f"AbsPoint A{k}(0, 0, {k}); AbsPoint B{k}(1, {bulge} + 0.1 * {k % 3}, {k}); "
            f"AbsPoint C{k}(3, {bulge}, {k}); AbsPoint D{k}(4, 0, {k}); "
            f"BCurve c{k}({{A{k}, B{k}, C{k}, D{k}}});"
        )
    for k in range(count):
        divisions = f"{{{nu}, {nv}}}" if k == 0 else f"{{0, {nv}}}"
        lines.append(f"RuledSurf S{k}(c{k}, c{k + 1}, divisions = {divisions});")
    return "\n".join(lines)


def finer(text: str, times: int) -> str:
    """The text with more divisions."""

    def more(found: re.Match[str]) -> str:
        return f"divisions = {{{int(found[1]) * times}, {int(found[2]) * times}}}"

    return re.sub(r"divisions = \{(\d+), (\d+)\}", more, text)


def measure(name: str, model: moldloft.Model, param: str, values: list[float]) -> None:
    """Prints the median and the longest time of a change."""
    np.asarray(model.mesh().vertices)
    turn = itertools.cycle(values)
    times = []
    gc.disable()
    for _ in range(CHANGES):
        value = next(turn)
        start = time.perf_counter()
        model.set({param: value})
        mesh = model.mesh()
        vertices = mesh.vertices
        times.append(1e3 * (time.perf_counter() - start))
    gc.enable()
    print(
        f"{name:<24} {len(mesh.faces):>6} panels, {len(vertices):>6} vertices: "
        f"{statistics.median(times):7.2f} ms, longest {max(times):7.2f} ms"
    )


def main() -> None:
    """Measures both models."""
    text = HULL.read_text().replace("divisions = {10, 20}", "divisions = {100, 200}")
    measure("hull, 100 x 200", moldloft.loads(text), "beam", [9.0, 9.5, 10.5, 11.0])
    measure("30 patches, one changes", moldloft.loads(patches()), "swell", [0.9, 1.1, 1.2])
    text = patches().replace("param float swell", "param float all").replace("(0, 0, ", "(0, all, ")
    text = text.replace("swell", "all")
    measure("30 patches, all change", moldloft.loads(text), "all", [0.9, 1.1, 1.2])
    for path, param, values, times in (
        ("platform/platform.sdl", "leg_radius", [7.5, 8.5, 9.0], (1,)),
        ("sailboat/yacht.sdl", "beam", [9.5, 10.0, 10.5], (1, 4)),
    ):
        for k in times:
            text = finer((EXAMPLES / path).read_text(), k)
            name = Path(path).stem + (f", divisions x {k}" if k > 1 else "")
            measure(name, moldloft.loads(text), param, values)


if __name__ == "__main__":
    main()
