"""All numbers of ordinary parts changed at once, beside OCCT building the same bodies.

Run with `python benches/sketch_parts.py`; it needs `cadquery-ocp`. The parts are the kinds of the
tests; times are processor time, medians of five changes.
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1] / "tests" / "python"
sys.path[:0] = [str(TESTS / "helpers"), str(TESTS / "sketch")]

from moldloft import Sketch  # noqa: E402
from sketch_ordinary import measures  # noqa: E402
from test_sketch_machined import KINDS, Changed, numbered  # noqa: E402

CHANGES = 5


def times(kind: str) -> tuple[float, float]:
    """Milliseconds of a change of all numbers, and of OCCT's part with its volume."""
    sketch = Sketch()
    values: list[float] = []
    ours, theirs = [], []
    for change in range(CHANGES + 1):
        start = time.process_time()
        part = KINDS[kind](Changed(f"{kind} changes", change))
        measures(part.solid)
        theirs.append(time.process_time() - start)
        text, new = numbered(part.text)
        if change == 0:
            sketch.run(text)
        else:
            changed = [j for j, x in enumerate(new) if x != values[j]]
            lines = "\n".join(f"SET TABLE.N{j} {new[j]!r}" for j in changed)
            start = time.process_time()
            with sketch.drag():
                sketch.run(lines)
            ours.append(time.process_time() - start)
        values = new
    return statistics.median(ours) * 1e3, statistics.median(theirs) * 1e3


def main() -> None:
    """Prints a line for each kind, by its ratio."""
    rows = sorted(((times(kind), kind) for kind in KINDS), key=lambda row: row[0][0] / row[0][1])
    for (ours, theirs), kind in rows:
        print(
            f"{kind:<22} ours {ours:7.1f} ms   OCCT {theirs:7.1f} ms   ratio {ours / theirs:6.2f}"
        )
    ratios = [ours / theirs for (ours, theirs), _ in rows]
    over = sum(ratio > 1.5 for ratio in ratios)
    print(f"median {statistics.median(ratios):.2f}; {over} of {len(ratios)} above 1.5")


if __name__ == "__main__":
    main()
