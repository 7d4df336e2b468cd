"""Time to open, filter and draw the table of a study of a million cases.

    python benches/study_rows.py [ROWS]

The store is made first: four inputs, three outputs, 5 % refused, 1 % crashed.
"""

from __future__ import annotations

import hashlib
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from moldloft import study
from moldloft.study.report import html

INPUTS, OUTPUTS = ("beam", "draft", "length", "rake"), ("area", "volume", "kmt")


def made(place: Path, count: int) -> None:
    """Writes a store as a run leaves it, its rows in one transaction."""
    rng = np.random.default_rng(1)
    inputs = rng.random((count, len(INPUTS)))
    outputs = inputs @ rng.random((len(INPUTS), len(OUTPUTS)))
    fault = rng.random(count)
    keys = [hashlib.sha256(str(k).encode()).hexdigest()[:40] for k in range(count)]

    def outcomes() -> Iterator[study.Outcome]:
        for k, key in enumerate(keys):
            state = "crashed" if fault[k] < 0.01 else "refused" if fault[k] < 0.06 else "done"
            yield study.Outcome(
                key,
                state,
                "" if state == "done" else state,
                "" if state == "done" else f"the case is {state}",
                0.01,
                dict(zip(INPUTS, inputs[k].tolist(), strict=True)),
                dict(zip(OUTPUTS, outputs[k].tolist(), strict=True)) if state == "done" else {},
            )

    with study.Store(place, writing=True) as store:
        store.begin({"plan": "latin-hypercube"}, keys)
        other = _Outcomes(outcomes())
        store.collect(other)  # type: ignore[arg-type]


class _Outcomes:
    """What `Store.collect` takes from another store."""

    def __init__(self, found: Iterator[study.Outcome]) -> None:
        self._found = found

    def outcomes(self) -> Iterator[study.Outcome]:
        return self._found


def step(at: list[tuple[float, float]], name: str) -> None:
    """Prints the times since the step before."""
    at.append((time.perf_counter(), time.process_time()))
    wall, cpu = (b - a for a, b in zip(at[-2], at[-1], strict=True))
    print(f"{name:8} {wall:6.2f} s elapsed, {cpu:6.2f} s of processor")


def main(count: int) -> None:
    """Prints processor and elapsed times."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "rows.sqlite"
        made(place, count)
        print(f"{count} cases, {place.stat().st_size / 1e6:.0f} MB")
        for _ in range(3):
            at = [(time.perf_counter(), time.process_time())]
            with study.Store(place) as store:
                results = store.results()
            step(at, "opened")
            chosen = results.done & (results.inputs["beam"] > 0.5)
            area = results.outputs["area"][chosen].min()
            step(at, "filtered")
            page = html(results, "rows", {"plan": "latin-hypercube"})
            step(at, "drawn")
            total = at[-1][1] - at[0][1]
            print(f"   {total:.2f} s of processor; least area {area:.6f}, {len(page)} bytes")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000)
