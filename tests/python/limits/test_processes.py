"""Parallel work after `fork`, in new processes, in threads: no child waits for its parent."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

import process_jobs

#: Seconds until a child counts as one that waits for ever.
HANGS = 60.0

METHODS = multiprocessing.get_all_start_methods()
forks = pytest.mark.skipif("fork" not in METHODS, reason="the system has no fork")


@pytest.fixture(scope="module")
def known() -> dict[str, str]:
    """What this process finds."""
    return {name: process_jobs.run(name) for name in process_jobs.JOBS}


def forked(name: str, expected: str, depth: int = 1) -> None:
    """Run a call in a child by `fork`, or in one of its own children."""
    process = os.fork()
    if process == 0:
        status = 1
        try:
            if depth > 1:
                process_jobs.run(name)
                forked(name, expected, depth - 1)
            status = 0 if process_jobs.run(name) == expected else 2
        finally:
            os._exit(status)
    begin = time.monotonic()
    while time.monotonic() - begin < HANGS:
        ended, status = os.waitpid(process, os.WNOHANG)
        if ended:
            assert os.waitstatus_to_exitcode(status) == 0, name
            return
        time.sleep(0.002)
    os.kill(process, signal.SIGKILL)
    os.waitpid(process, 0)
    pytest.fail(f"{name} does not end in a child by fork")


@forks
@pytest.mark.parametrize("first", process_jobs.JOBS)
def test_every_call_after_every_call_and_a_fork(first: str, known: dict[str, str]) -> None:
    assert process_jobs.run(first) == known[first]
    for name in process_jobs.JOBS:
        forked(name, known[name])


@forks
def test_children_of_children(known: dict[str, str]) -> None:
    for name in ("body", "hydrostatics", "fair"):
        forked(name, known[name], depth=3)


@pytest.mark.parametrize("method", METHODS)
def test_pools_of_processes(method: str, known: dict[str, str]) -> None:
    context = multiprocessing.get_context(method)
    names = list(process_jobs.JOBS)
    pool = context.Pool(2)
    try:
        found = pool.map_async(process_jobs.run, names, chunksize=1).get(HANGS)
    finally:
        pool.terminate()
        pool.join()
    assert dict(zip(names, found, strict=True)) == known


def test_threads(known: dict[str, str]) -> None:
    names = [*process_jobs.JOBS] * 2
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(process_jobs.run, names))
    assert found == [known[name] for name in names]


@forks
@pytest.mark.skipif(sys.platform != "linux", reason="threads outlive a fork nowhere")
def test_a_fork_in_the_middle_of_work(known: dict[str, str]) -> None:
    with ThreadPoolExecutor(1) as pool:
        for name in ("points", "hydrostatics", "fair"):
            busy = pool.submit(process_jobs.run, "body")
            forked(name, known[name])
            assert busy.result(HANGS) == known["body"]
