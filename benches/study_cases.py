"""A study of many cheap cases whose workers crash and whose run is killed: one table, and its cost.

    python benches/study_cases.py [CASES]

About 1 % of the cases end their process and 5 % are refused. The plan is run serially; on two
processes, killed twice and resumed; and by Dask on two workers of which one is killed. The tables
are compared bit for bit. Times are elapsed and of processor, workers included.
"""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from moldloft import study
from moldloft.errors import Error

MODEL = """
param float a = 0.5 in [0, 1]; param float b = 0.5 in [0, 1];
AbsPoint P(a, b, a * b);
if (a > 0.95) { print undefined_name; }
"""
ANALYSIS = """
import os, signal
def rare(model):
    if int(model["b"] * 1e6) % 100 == 7:
        os.kill(os.getpid(), signal.SIGKILL)
    return 2 * model["a"]
"""
DEFINITION = """
model = "box.sdl"
[inputs]
a = {}
b = {}
[outputs]
area = "P.z"
[analysis.rare]
python = "rare.py:rare"
outputs = ["twice"]
[plan]
method = "sobol"
"""


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


def known(place: Path) -> int:
    """The cases that a store has."""
    try:
        with study.Store(place) as store:
            return len(store.known())
    except Error:
        # The store is being made.
        return 0


def killed(path: Path, store: Path, count: int) -> int:
    """Runs the command and kills it after a third and two thirds of the cases."""
    words = [sys.executable, "-m", "moldloft", "study", "sweep", str(path), "-q"]
    for third in (1, 2):
        with subprocess.Popen([*words, "--store", str(store)], stderr=subprocess.DEVNULL) as run:
            while known(store) < third * count // 3 and run.poll() is None:
                time.sleep(0.2)
            run.kill()
    return known(store)


def by_dask(definition: study.Study, store: Path, count: int) -> bytes:
    """The table by two workers of Dask, one of them killed on the way."""
    from distributed import Client, LocalCluster

    from moldloft.study.cluster import executor_of

    with (
        LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        pids = list(client.run(os.getpid).values())

        def kill() -> None:
            while known(store) < count // 3:
                time.sleep(0.2)
            os.kill(pids[0], signal.SIGKILL)

        threading.Thread(target=kill, daemon=True).start()
        return study.sweep(definition, store, executor=executor_of(client)).csv()


def main(count: int) -> int:
    """Runs all, and states whether the tables are the same."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "box.sdl").write_text(MODEL)
        (folder / "rare.py").write_text(ANALYSIS)
        path = folder / "box.toml"
        path.write_text(f"{DEFINITION}count = {count}\n")
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
        with timed("Dask, a worker killed", count):
            dask = by_dask(definition, folder / "dask.sqlite", count)
        same = serial.csv() == two.csv() == dask
        print("the tables are the same" if same else "THE TABLES DIFFER")
        return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000))
