"""Times two pieces of work in turns and prints the ratio of their medians."""

import gc
import statistics
import time
from collections.abc import Callable


def timed(work: Callable[[], object]) -> float:
    """Seconds of one call."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def compare(
    ours: Callable[[], object],
    theirs: Callable[[], object],
    *,
    name: str,
    pairs: int = 15,
    inner: int = 1,
) -> float:
    """Run both in turns and print medians and their ratio.

    ``inner`` calls are timed as one. Returns the median over the pairs of ours / theirs.
    """

    def block(work: Callable[[], object]) -> Callable[[], None]:
        def run() -> None:
            for _ in range(inner):
                work()

        return run

    a, b = block(ours), block(theirs)
    a(), b()
    gc.disable()
    try:
        times = [(timed(a), timed(b)) for _ in range(pairs)]
    finally:
        gc.enable()
    ratio = statistics.median(x / y for x, y in times)
    ms = [statistics.median(column) / inner * 1e3 for column in zip(*times, strict=True)]
    print(f"{name:<34} ours {ms[0]:9.4f} ms   peer {ms[1]:9.4f} ms   ours/peer {ratio:7.3f}")
    return ratio


def missing(name: str, error: Exception) -> None:
    """Say that a peer is not installed."""
    print(f"{name:<34} not measured: {error}")
