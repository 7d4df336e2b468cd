"""Costs of Dask's scheduler for a study: cases that do nothing on many workers of one process.

    python benches/study_scheduler.py [CASES] [WORKERS]

The requests and answers are those of a study with four inputs and three outputs; scheduler,
workers, the client with its back-pressure and the store run in this process, so that its processor
time is that of all of them.
"""

from __future__ import annotations

import logging
import resource
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

from distributed import Client, LocalCluster

from moldloft import study
from moldloft.study import running
from moldloft.study.cluster import ClusterExecutor

INPUTS, OUTPUTS = ("beam", "draft", "length", "rake"), ("area", "volume", "kmt")


def nothing(requests: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The answers of cases, without the cases."""
    sums = [sum(request["inputs"].values()) for request in requests]
    outputs = [{name: x + k for k, name in enumerate(OUTPUTS)} for x in sums]
    return [{"state": "done", "outputs": o, "derivatives": {}, "seconds": 0.0} for o in outputs]


class Cluster(Executor):
    """As `ClusterExecutor`, with :func:`nothing` for each case."""

    def __init__(self, client: Any) -> None:
        self._of = client.get_executor(pure=False)
        self._max_workers = sum(client.nthreads().values())

    bundle = ClusterExecutor.bundle

    def submit(  # type: ignore[override]
        self, function: Callable[..., Any], requests: Sequence[Mapping[str, Any]]
    ) -> Future[Any]:
        """Submit some cases."""
        found: Future[Any] = self._of.submit(nothing, list(requests))
        return found


def requests(count: int) -> Iterator[dict[str, Any]]:
    """Requests of the size of a study's."""
    fixed = {
        "outputs": {name: f"hydrostatics.{name}" for name in OUTPUTS},
        "constraints": [["slender", "length / beam", 2.5, None]],
        "analyses": [],
        "model": "/tmp/moldloft-study-00000000/hull.sdl",
        "folder": "/home/user/studies",
        "digest": "0" * 64,
    }
    for k in range(count):
        inputs = {name: (k * 7919 + n) % 100_003 / 100_003 for n, name in enumerate(INPUTS)}
        yield {**fixed, "key": f"{k:040x}", "inputs": inputs}


def main(count: int, workers: int) -> None:
    """Prints times of a case, and memory."""
    logging.disable(logging.WARNING)
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalCluster(
            workers, threads_per_worker=8, processes=False, dashboard_address=":0", memory_limit=0
        ) as cluster,
        Client(cluster) as client,
        study.Store(Path(folder) / "noop.sqlite", writing=True) as store,
    ):
        executor = Cluster(client)
        store.begin({}, (f"{k:040x}" for k in range(count)))
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        wall, cpu = time.perf_counter(), time.process_time()
        for number, (request, answer) in enumerate(
            running._answers(executor, requests(count), 1), start=1
        ):
            store.add(running.outcome(request, answer))
            if number % (count // 10 or 1) == 0:
                each = (time.perf_counter() - wall) / number
                print(f"{number} cases: {1e3 * each:.2f} ms a case", flush=True)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
        assert store.progress() == (count, {"done": count})
    print(
        f"{count} cases on {workers} workers of 8 threads: {1e3 * wall / count:.2f} ms elapsed and "
        f"{1e3 * cpu / count:.2f} ms of processor a case; {grown:.0f} MB more than at the start"
    )


if __name__ == "__main__":
    main(
        int(sys.argv[1]) if len(sys.argv) > 1 else 100_000,
        int(sys.argv[2]) if len(sys.argv) > 2 else 100,
    )
