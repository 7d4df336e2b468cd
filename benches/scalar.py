"""Statements on numbers and vectors beside CPython: sums, calls, elements, branches, loops, points.

Run with `python benches/scalar.py`. Both run on one thread, one after the other; times are the
least of several repetitions, of processor time, for one turn of the loop: the difference of a long
and a short loop, so that starting and parsing do not count.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import moldloft

SHORT, LONG, TIMES = 20_000, 100_000, 5


def least(work: Callable[[], object]) -> float:
    """The least processor time of some calls, in seconds."""
    best = float("inf")
    for _ in range(TIMES):
        start = time.process_time()
        work()
        best = min(best, time.process_time() - start)
    return best


def turn(loop: Callable[[int], object]) -> float:
    """Nanoseconds of one turn."""
    return (least(lambda: loop(LONG)) - least(lambda: loop(SHORT))) / (LONG - SHORT) * 1e9


def total(n: int) -> float:
    s = 0.0
    for i in range(1, n + 1):
        s += 1 / i**2
    return s


def calls(n: int) -> float:
    def f(x: float) -> float:
        return x * x + 1

    s = 0.0
    for i in range(1, n + 1):
        s += f(i)
    return s


def elements(n: int) -> list[float]:
    a = [0.0] * 100
    for i in range(n):
        a[i % 100] = a[(i + 1) % 100] + 1
    return a


def updates(n: int) -> list[float]:
    a = [0.0] * n
    for i in range(n):
        a[i] = a[i] * 0.5 + 1
    return a


def branches(n: int) -> float:
    s = 0.0
    for i in range(1, n + 1):
        if s > 10:
            s -= 9.5
        else:
            s += i % 3
    return s


def nested(n: int) -> float:
    s = 0.0
    for i in range(1, n // 10 + 1):
        for j in range(1, 11):
            s += i * j
    return s


def vectors(n: int) -> tuple[float, float, float]:
    v = (1.0, 2.0, 3.0)
    for i in range(1, n + 1):
        v = (v[0] * 0.5 + i, v[1] * 0.5 + 1, v[2] * 0.5 + v[0])
    return v


def smoothed(n: int) -> list[tuple[float, float, float]]:
    c = [(float(k), k % 2.0, 0.0) for k in range(100)]

    def smooth(d: list[tuple[float, float, float]], turns: int) -> None:
        for _ in range(turns):
            for k in range(1, 99):
                (x, y, z), (u, v, w) = d[k - 1], d[k + 1]
                d[k] = ((x + u) / 2, (y + v) / 2, (z + w) / 2)

    smooth(c, n // 98)
    return c


def walked(n: int) -> float:
    a = [0.5] * n
    s = 0.0
    for x in a:
        s = s * 0.5 + x
    return s


CASES: list[tuple[str, Callable[[int], object], str]] = [
    ("sum", total, "float s = 0; for (i = 1:{n}) s += 1/i^2;"),
    (
        "function call",
        calls,
        "function float f(float x) {{ return x*x + 1; }} float s = 0; for (i = 1:{n}) s += f(i);",
    ),
    (
        "element",
        elements,
        "farray a[100]; for (i = 0:{n}-1) a[mod(i, 100) + 1] = a[mod(i + 1, 100) + 1] + 1;",
    ),
    (
        "indexed update",
        updates,
        "farray a[{n}]; for (i = 1:{n}) a[i] = a[i]*.5 + 1;",
    ),
    (
        "branch",
        branches,
        "float s = 0; for (i = 1:{n}) {{ if (s > 10) s -= 9.5; else s += mod(i, 3); }}",
    ),
    (
        "loop in a loop",
        nested,
        "float s = 0; for (i = 1:{n}/10) for (j = 1:10) s += i*j;",
    ),
    (
        "vector",
        vectors,
        "vector v = {{1, 2, 3}}; for (i = 1:{n}) v = v*.5 + {{i, 1, v.x}};",
    ),
    (
        "points by reference",
        smoothed,
        "curve c[100]; for (k = 1:100) c[k] = {{k - 1, mod(k - 1, 2), 0}};"
        "subroutine smooth(returned curve d, int turns) {{"
        " for (t = 1:turns) for (k = 2:99) d[k] = (d[k - 1] + d[k + 1])/2; }}"
        "smooth(c, floor({n}/98));",
    ),
    (
        "foreach",
        walked,
        "farray a[{n}]; a = .5; float s = 0; foreach (x in a) s = s*.5 + x;",
    ),
]


def main() -> None:
    """Prints a line for each case."""
    print(f"{'one turn':18}{'ours, ns':>10}{'CPython, ns':>13}{'ratio':>8}")
    for name, python, program in CASES:
        ours = turn(lambda n, p=program: moldloft.loads(p.format(n=n)))  # type: ignore[misc]
        theirs = turn(python)
        print(f"{name:18}{ours:10.0f}{theirs:13.0f}{ours / theirs:8.2f}")


if __name__ == "__main__":
    main()
