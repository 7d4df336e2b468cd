"""A study of many cheap cases whose workers crash and whose run is killed: one table, and its cost.

    python benches/study_cases.py [CASES]

About 1 % of the cases end their process and 5 % are refused. The plan is run serially; on two
processes, killed twice and resumed; and by Dask on two workers, one killed, then both. The tables
are compared bit for bit. Times are elapsed and of processor, workers included.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from moldloft import study

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "python" / "helpers"))
from study_campaign import by_dask, killed, written


@contextmanager
def timed(name: str, count: int) -> Iterator[None]:
    """Prints the times of what is within for each case."""

    def now() -> tuple[float, float]:
        used = [resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
        return time.perf_counter(), sum(u.ru_utime + u.ru_stime for u in used)

    before = now()
    yield
    wall, cpu = (1e3 * (b - a) / count for a, b in zip(before, now(), strict=True))
    print(f"{name:28} {wall:7.2f} ms elapsed, {cpu:7.2f} ms of processor a case", flush=True)


def main(count: int) -> int:
    """Runs all, and states whether the tables are the same."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = written(folder, count)
        definition = study.read(path)
        with timed("serial", count):
            serial = study.sweep(definition, folder / "serial.sqlite", processes=1)
        print(serial.counts)
        with timed("two processes, two kills", count):
            kept = killed(path, folder / "two.sqlite", count)
            left: list[int] = []
            two = study.sweep(
                definition, folder / "two.sqlite", progress=lambda _, all_, __: left.append(all_)
            )
        print(f"{kept} kept, {left[0] if left else 0} evaluated after the second kill")
        with timed("Dask, workers killed", count):
            dask = by_dask(definition, folder / "dask.sqlite", count)
        same = serial.csv() == two.csv() == dask
        print("the tables are the same" if same else "THE TABLES DIFFER")
        return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000))
