"""A parameter is changed and the panels are asked for again, from Python: milliseconds a change.

The hull of the yacht at 100 x 200 panels, 30 patches of about 20 000 panels that share curves, and
every example of the paper with its divisions raised until it has nearly 20 000 panels, each of its
parameters changed by itself: the slowest one is printed.
Run with `python benches/panels.py [name of an example ...]`. The aim is 16 ms, a picture's time.
"""

from __future__ import annotations

import gc
import itertools
import re
import statistics
import sys
import time
from pathlib import Path

import numpy as np

import moldloft

EXAMPLES = Path(__file__).parent.parent / "examples"
HULL = EXAMPLES / "sailboat" / "hull.sdl"
CHANGES = 60

# Figures 3 to 9 of the paper.
PAPER = (
    "wing/wing.sdl",
    "wingbody/wingbody.sdl",
    "platform/platform.sdl",
    "sailboat/yacht.sdl",
    "submarine/submarine.sdl",
    "propeller/propeller.sdl",
)


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


def finer(text: str, times: float) -> str:
    """The text with more divisions."""

    def more(found: re.Match[str]) -> str:
        return f"divisions = {{{round(int(found[1]) * times)}, {round(int(found[2]) * times)}}}"

    text = re.sub(r"divisions = \{(\d+), (\d+)\}", more, text)
    return re.sub(
        r"int fine = (\d+);", lambda n: f"int fine = {2 * round(int(n[1]) * times / 2)};", text
    )


def raised(text: str, panels: int = 20_000) -> str:
    """The text with so many divisions, in steps of a half, that it has nearly as many panels."""
    best = text
    for k in range(3, 21):
        more = finer(text, k / 2)
        if len(moldloft.loads(more).mesh().faces) > panels:
            break
        best = more
    return best


def timed(model: moldloft.Model, param: str, values: list[float], changes: int) -> list[float]:
    """Milliseconds of changes of a parameter, with the mesh taken from Python."""
    np.asarray(model.mesh().vertices)
    turn = itertools.cycle(values)
    times = []
    gc.disable()
    for _ in range(changes):
        value = next(turn)
        start = time.perf_counter()
        model.set({param: value})
        np.asarray(model.mesh().vertices)
        times.append(1e3 * (time.perf_counter() - start))
    gc.enable()
    return times


def measure(name: str, model: moldloft.Model, param: str, values: list[float]) -> None:
    """Prints the median and the longest time of a change."""
    times = timed(model, param, values, CHANGES)
    print(
        f"{name:<24} {len(model.mesh().faces):>6} panels: "
        f"{statistics.median(times):7.2f} ms, least {min(times):7.2f}, longest {max(times):7.2f} ms"
    )


def measure_all(name: str, model: moldloft.Model) -> None:
    """Prints the slowest parameter of a model by its median, and its times."""
    slowest = ("", [0.0])
    for param, range_ in model.params.items():
        low, high = range_.low, range_.high
        if low is None or high is None:
            continue
        values = [low + share * (high - low) for share in (0.35, 0.45, 0.55, 0.62)]
        default = range_.value
        times = timed(model, param, values, CHANGES // 4)
        model.set({param: default})
        slowest = max(slowest, (param, times), key=lambda entry: statistics.median(entry[1]))
    param, times = slowest
    print(
        f"{name:<12} {param:<18} {len(model.mesh().faces):>6} panels: "
        f"{statistics.median(times):7.2f} ms, least {min(times):7.2f}, longest {max(times):7.2f} ms"
    )


def main() -> None:
    """Measures all models, or the examples that are named."""
    if len(sys.argv) > 1:
        for path in PAPER:
            if Path(path).stem in sys.argv[1:]:
                text = raised((EXAMPLES / path).read_text())
                measure_all(Path(path).stem, moldloft.loads(text))
        return
    text = HULL.read_text().replace("divisions = {10, 20}", "divisions = {100, 200}")
    measure("hull, 100 x 200", moldloft.loads(text), "beam", [9.0, 9.5, 10.5, 11.0])
    measure("30 patches, one changes", moldloft.loads(patches()), "swell", [0.9, 1.1, 1.2])
    text = patches().replace("param float swell", "param float all").replace("(0, 0, ", "(0, all, ")
    text = text.replace("swell", "all")
    measure("30 patches, all change", moldloft.loads(text), "all", [0.9, 1.1, 1.2])
    for path in PAPER:
        measure_all(Path(path).stem, moldloft.loads(raised((EXAMPLES / path).read_text())))


if __name__ == "__main__":
    main()
