"""Statements on numbers, vectors and texts beside CPython, and whole programs.

Run with `python benches/scalar.py [words of the rows]` and an optimised build. Both run on one
thread, one after the other; times are the least of several repetitions, of processor time. Those of
a loop are for one turn: the difference of a long and a short loop, so that starting and parsing do
not count. Those of a program are for all of it, without an empty program.
"""

from __future__ import annotations

import sys
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


def copied(n: int) -> str:
    t = ""
    for _ in range(n):
        t = "name"
    return t


def joined(n: int) -> str:
    s, t = "x", ""
    for _ in range(n):
        t = s + "y"
    return t


def formatted(n: int) -> str:
    t = ""
    for i in range(n):
        t = "%d" % i  # noqa: UP031
    return t


def compared(n: int) -> int:
    s, k = "abc", 0
    for _ in range(n):
        k += s == "abd"
    return k


def remainders(n: int) -> int:
    c = 0
    for i in range(n):
        c += i % 3 == 0
    return c


def halves(n: int) -> float:
    k = 0.0
    for i in range(n):
        k = i / 2
    return k


def integers(n: int) -> int:
    k = 0
    for i in range(n):
        k = 3 * i + 1
    return k


def counted(n: int) -> int:
    k = m = 0
    while k < n:
        k += 1
        if k > 5:
            m += 1
    return m


def fib(n: int) -> int:
    return n if n < 2 else fib(n - 1) + fib(n - 2)


def fact(n: int) -> int:
    return 1 if n < 2 else n * fact(n - 1)


def factorials(n: int) -> int:
    v = 0
    for _ in range(n // 100):
        v = fact(100)
    return v


def two(x: float) -> float:
    return x + 1


def outer(x: float) -> float:
    return two(x) * 2


def nested_calls(n: int) -> float:
    s = 0.0
    for i in range(n):
        s += outer(i)
    return s


def added(n: int) -> list[float]:
    a = [0.0] * 100
    for i in range(n):
        a[i % 100] += 1
    return a


def turns(n: int) -> float:
    y = 0.0
    a = [1.0, 2.0, 3.0, 4.0] * 25
    for _ in range(n // 100):
        for x in a:
            y = x
    return y


def collatz(n: int) -> int:
    best = 0
    for first in range(1, n + 1):
        k, c = first, 0
        while k != 1:
            k = k // 2 if k % 2 == 0 else 3 * k + 1
            c += 1
        best = max(best, c)
    return best


def sieve(n: int) -> int:
    a, c = [1] * (n + 1), 0
    for i in range(2, n + 1):
        if a[i]:
            c += 1
            for j in range(2 * i, n + 1, i):
                a[j] = 0
    return c


def thomas(n: int) -> list[float]:
    a, b, c = [1.0] * n, [4.0] * n, [1.0] * n
    d = [float(i % 7) for i in range(n)]
    for i in range(1, n):
        w = a[i] / b[i - 1]
        b[i] -= w * c[i - 1]
        d[i] -= w * d[i - 1]
    x = [0.0] * n
    x[-1] = d[-1] / b[-1]
    for i in range(n - 2, -1, -1):
        x[i] = (d[i] - c[i] * x[i + 1]) / b[i]
    return x


def gauss_seidel(sweeps: int) -> float:
    n = 100
    u = [[0.0] * n for _ in range(n)]
    u[0] = [1.0] * n
    for _ in range(sweeps):
        for i in range(1, n - 1):
            for j in range(1, n - 1):
                u[i][j] = 0.25 * (u[i - 1][j] + u[i + 1][j] + u[i][j - 1] + u[i][j + 1])
    return u[5][50]


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
    (
        "foreach, copied",
        turns,
        "farray a = uniform(1, 4, 100); float y;for (r = 1:{n}/100) foreach (x in a) y = x;",
    ),
    ("mod(i, 3) == 0", remainders, "int c = 0; for (i = 1:{n}) c += (mod(i, 3) == 0);"),
    ("i/2 to a float", halves, "float k; for (i = 1:{n}) k = i/2;"),
    ("int k = 3*i + 1", integers, "int k; for (i = 1:{n}) k = 3*i + 1;"),
    (
        "while with if",
        counted,
        "int k = 0, n = 0; while (k < {n}) {{ k += 1; if (k > 5) n += 1; }}",
    ),
    ("a[mod] += 1", added, "farray a[100]; for (i = 1:{n}) a[1 + mod(i, 100)] += 1;"),
    (
        "two nested calls",
        nested_calls,
        "function float two(float x) {{ return x + 1; }}"
        "function float outer(float x) {{ return two(x)*2; }}"
        "float s = 0; for (i = 1:{n}) s += outer(i);",
    ),
    (
        "factorial, a call",
        factorials,
        "function float fact(float n) {{ if (n < 2) return 1; return n*fact(n - 1); }}"
        "float v; for (i = 1:{n}/100) v = fact(100);",
    ),
    ("text copied", copied, 'string t; for (i = 1:{n}) t = "name";'),
    ("texts joined", joined, 'string s = "x", t; for (i = 1:{n}) t = s + "y";'),
    ("text of %d", formatted, 'string t; for (i = 1:{n}) t = format("%d", i);'),
    ("texts compared", compared, 'string s = "abc"; int k = 0; for (i = 1:{n}) k += (s == "abd");'),
]

FIB = "function float fib(float n) {{ if (n < 2) return n; return fib(n - 1) + fib(n - 2); }}"

# With the number that both are given.
PROGRAMS: list[tuple[str, int, Callable[[int], object], str]] = [
    ("fib(20)", 20, fib, FIB + "assert fib({n}) == {r};"),
    ("Collatz to 20 000", 20_000, collatz,
     "int best = 0; for (n = 1:{n}) {{ int k = n, c = 0; while (k != 1) {{"
     " if (mod(k, 2) == 0) k = k/2; else k = 3*k + 1; c += 1; }}"
     " if (c > best) best = c; }} assert best == {r};"),
    ("sieve to 300 000", 300_000, sieve,
     "farray a[{n}]; a = 1; int c = 0; for (i = 2:{n}) if (a[i] == 1) {{"
     " c += 1; for (j = 2*i:{n}:i) a[j] = 0; }} assert c == {r};"),
    ("Thomas, 100 000", 100_000, thomas,
     "int n = {n}; farray a[n], b[n], c[n], d[n], x[n]; a = 1; b = 4; c = 1;"
     " for (i = 1:n) d[i] = mod(i - 1, 7);"
     " for (i = 2:n) {{ float w = a[i]/b[i - 1]; b[i] -= w*c[i - 1]; d[i] -= w*d[i - 1]; }}"
     " x[n] = d[n]/b[n]; for (i = n-1:1:-1) x[i] = (d[i] - c[i]*x[i + 1])/b[i];"
     " assert abs(x[n/2] - {r[49999]}) < 1e-12;"),
    ("Gauss-Seidel, 100 x 100, 20 sweeps", 20, gauss_seidel,
     "int n = 100; farray u[n,n]; u[1,] = 1; for (s = 1:{n}) for (i = 2:n-1) for (j = 2:n-1)"
     " u[i,j] = .25*(u[i-1,j] + u[i+1,j] + u[i,j-1] + u[i,j+1]);"
     " assert abs(u[6,51] - {r}) < 1e-14;"),
]  # fmt: skip


def main() -> None:
    """Prints a line for each case and program whose name has one of the words."""
    words = sys.argv[1:] or [""]
    print(f"{'one turn':36}{'ours, ns':>10}{'CPython, ns':>13}{'ratio':>8}")
    for name, python, program in CASES:
        if not any(word in name for word in words):
            continue
        ours = turn(lambda n, p=program: moldloft.loads(p.format(n=n)))  # type: ignore[misc]
        theirs = turn(python)
        print(f"{name:36}{ours:10.1f}{theirs:13.1f}{ours / theirs:8.2f}", flush=True)
    empty = least(lambda: moldloft.loads("float x = 0;"))
    print(f"{'whole program':36}{'ours, ms':>10}{'CPython, ms':>13}{'ratio':>8}")
    for name, n, python, program in PROGRAMS:
        if not any(word in name for word in words):
            continue
        text = program.format(n=n, r=python(n))
        ours = (least(lambda t=text: moldloft.loads(t)) - empty) * 1e3  # type: ignore[misc]
        theirs = least(lambda n=n, p=python: p(n)) * 1e3  # type: ignore[misc]
        print(f"{name:36}{ours:10.2f}{theirs:13.2f}{ours / theirs:8.2f}", flush=True)


if __name__ == "__main__":
    main()
