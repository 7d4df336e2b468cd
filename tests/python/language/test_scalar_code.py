# ruff: noqa: E501 -- programs of one line
"""Statements on numbers against Python: the same random programs in both languages, bit for bit."""

from __future__ import annotations

import math
import os
import random

import pytest

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
NAMES = ("x", "y", "z")


def number(r: random.Random, depth: int) -> tuple[str, str]:
    """An expression in both languages; whatever its value, it has one."""
    if depth == 0 or r.random() < 0.25:
        value = r.choice([*NAMES, "1", "2.5", "0.125", "3", "i", "a"])
        if value == "a":
            k = r.randint(1, 5)
            return f"a[{k}]", f"a[{k - 1}]"
        return value, value
    (a, b), (c, d) = number(r, depth - 1), number(r, depth - 1)
    kind = r.randrange(11)
    if kind < 4:
        op = r.choice("+-*")
        return f"({a} {op} {c})", f"({b} {op} {d})"
    if kind == 4:
        return f"({a})/(|{c}| + 1)", f"({b})/(abs({d}) + 1)"
    if kind == 5:
        return f"min({a}, {c})", f"min({b}, {d})"
    if kind == 6:
        return f"sqrt(|{a}|)", f"math.sqrt(abs({b}))"
    if kind == 7:
        return f"floor({a})", f"float(math.floor({b}))"
    if kind == 8:
        return f"mod({a}, 7)", f"modulo({b})"
    if kind == 9:
        return f"f(mod({a}, 5), {c})", f"f(modulo({b}, 5), {d})"
    return f"({a} < {c})", f"float({b} < {d})"


def statement(r: random.Random, depth: int) -> tuple[list[str], list[str]]:
    """Lines of both languages."""
    value, python = number(r, 3)
    name = r.choice(NAMES)
    kind = r.randrange(9 if depth else 5)
    if kind < 2:
        return [f"{name} = small({value});"], [f"{name} = small({python})"]
    if kind == 2:
        return [f"{name} += small({value});"], [f"{name} += small({python})"]
    if kind < 5:
        sdl = [f"a[mod(floor({value}), 5) + 1] = small({name});"]
        return sdl, [f"a[int(modulo(math.floor({python}), 5))] = small({name})"]
    parts = [statement(r, depth - 1) for _ in range(r.randint(1, 3))]
    body = [line for part in parts for line in part[0]]
    lines = ["    " + line for part in parts for line in part[1]]
    if kind < 7:
        return [f"if ({value} > 1) {{", *body, "}"], [f"if {python} > 1:", *lines]
    n = r.randint(1, 4)
    sdl = [f"for (i = 1:{n}) {{", *body, f"if ({name} > 1e3) break;", "}"]
    return sdl, [f"for i in range(1, {n + 1}):", *lines, f"    if {name} > 1e3:", "        break"]


SDL = """float x = 1; float y = .5; float z = 2; farray a[5]; a = 1; int i = 1;
function float small(float v) { while (|v| > 1e4) v /= 1024; return v; }
function float f(float n, float v) { if (n < 1) return v; float w = f(n - 1, v*0.5); return w + n; }
for (i = 1:3) {
"""


def modulo(x: float, n: float = 7.0) -> float:
    """The remainder with the sign of n."""
    return float(x) % n


def small(v: float) -> float:
    while abs(v) > 1e4:
        v /= 1024
    return v


def f(n: float, v: float) -> float:
    return v if n < 1 else f(n - 1, v * 0.5) + n


def test_loops_and_routines_say_what_python_says() -> None:
    r = random.Random(5)
    for _ in range(3000 if SOAK else 20):
        parts = [statement(r, 2) for _ in range(r.randint(2, 6))]
        names: dict[str, object] = {"math": math, "modulo": modulo, "small": small, "f": f}
        lines = ["    " + line for part in parts for line in part[1]]
        python = "\n".join(["x, y, z, a = 1.0, 0.5, 2.0, [1.0]*5", "for i in range(1, 4):", *lines])
        exec(python, names)
        sdl = SDL + "\n".join(line for part in parts for line in part[0]) + "\n}"
        model = moldloft.loads(sdl)
        for name in NAMES:
            assert float(model.eval(name)) == names[name], (name, sdl, python)
        assert [float(v) for v in model.eval("a")] == names["a"], (sdl, python)


# Loops of 8 000 turns, 4 000 with three calls in each; what stands before them is done once.
CODE = {
    "numbers": "float s = 0; for (k = 1:8000) { s += 1/k; if (s > 5) s -= 5; }",
    "elements": "farray a[50]; for (k = 1:8000) { int i = mod(k, 50) + 1; a[i] = a[i]*.5 + k; }",
    "vectors": "vector v; for (k = 1:8000) { v = v*.5 + {k, 1, v.x}; v.y -= |v|; }",
    "points": "curve c[9]; surface s[9,9]; for (k = 1:8000) { int i = mod(k, 9) + 1; c[i] += {1, k, 0}; s[i,2] = c[i]; s[2,i].z = c[i].x; }",
    "products": "vector v = {1, 2, 3}; float s = 0; for (k = 1:8000) { vector w = v .* {0, k, 1}; s = v . w + |w|; }",
    "functions": "function vector f(vector v, float t) { vector w = v*t; w.x += t; return w/2; } vector v; for (k = 1:4000) { v = f(v, .5); v = f(v, 1) + f(v, 0); }",
    "foreach": "farray a = uniform(0, 1, 8000); curve c[9]; float s = 0; foreach (x in a) { s += x; s *= .5; } for (k = 1:800) foreach (p in c) { s += p.x; s *= .5; }",
    "a variable by reference": "curve c[50]; float n = 0; subroutine f(returned curve d, returned float m) { for (k = 1:8000) { d[mod(k, 50) + 1].x += k; m += 1; } } f(c, n);",
    "a variable of another call by reference": "subroutine f(returned farray a) { for (k = 1:8000) { a[mod(k, 9) + 1] += k; a[1] *= .5; } } subroutine g() { farray b[9]; f(b); } g();",
    "calls by reference": "farray a[9]; float s = 0; subroutine f(returned farray b, int k) { b[mod(k, 9) + 1] += k; b[1] = 0; } for (k = 1:8000) { f(a, k); s += a[2]; }",
    "recursion": "function vector f(vector v, int n) { if (n < 1) return v; return f(v*.5, n - 1); } vector v; for (k = 1:800) { v = f({k, 1, 2}, 10); }",
}


@pytest.mark.parametrize("program", CODE.values(), ids=CODE.keys())
def test_what_is_not_whole_arrays_is_code(program: str) -> None:
    # Sixteen steps of code count as one; those of the interpreter alone are more than three a turn, and
    # four more for each call.
    before = moldloft.limits()
    try:
        moldloft.limits(steps=8000)
        model = moldloft.loads(program)
    finally:
        moldloft.limits(steps=before.steps)
    assert not [d for d in model.diagnostics if d.severity == "error"], model.diagnostics
