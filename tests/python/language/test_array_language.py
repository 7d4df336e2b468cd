# ruff: noqa: E501 -- programs of one line
"""The array language against NumPy and Python's own integers and texts: masks, sections, reductions, remainders.

Every case is a statement over small arrays of dyadic numbers, on which NumPy's sums are exact, so results are compared
bit for bit. `MOLDLOFT_SOAK=1` runs many more.
"""

from __future__ import annotations

import os
import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

Array = np.ndarray[Any, Any]


def spelled(x: float) -> str:
    return repr(float(x))


def row(rng: random.Random, n: int) -> Array:
    return np.array([rng.randint(-40, 40) / 8 for _ in range(n)])


def declared(name: str, a: Array) -> str:
    """The statements that make an farray of these numbers."""
    if a.ndim == 1:
        return f"farray {name} = list({', '.join(map(spelled, a))});\n"
    lines = [f"farray {name}[{a.shape[0]},{a.shape[1]}];\n"]
    lines += [
        f"{name}[{i + 1},{j + 1}] = {spelled(a[i, j])};\n"
        for i in range(a.shape[0])
        for j in range(a.shape[1])
    ]
    return "".join(lines)


COMPARISONS: dict[str, Callable[[Any, Any], Any]] = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": np.not_equal,
}


def mask_of(rng: random.Random, name: str, a: Array) -> tuple[str, Array]:
    """A mask of an array, and NumPy's; with `and`, `or`, `not` at times."""
    text, holds = [], []
    for _ in range(rng.choice((1, 1, 2))):
        op, x = rng.choice(list(COMPARISONS)), rng.randint(-40, 40) / 8
        text.append(f"{name} {op} {spelled(x)}")
        holds.append(COMPARISONS[op](a, x))
    if len(text) == 2:
        word = rng.choice(("and", "or"))
        both = np.logical_and if word == "and" else np.logical_or
        made, held = f"({text[0]}) {word} ({text[1]})", both(*holds)
    else:
        made, held = text[0], holds[0]
    if rng.random() < 0.2:
        made, held = f"not ({made})", ~held
    return f"({made})", held


def index_of(rng: random.Random, n: int) -> tuple[str, Array]:
    """Positions from 1 that are no mask by chance, in braces or a list."""
    while True:
        at = [rng.randint(1, n) for _ in range(rng.randint(1, n + 1))]
        if not (len(at) == n and set(at) == {1}):
            break
    inside = ", ".join(map(str, at))
    return rng.choice((f"{{{inside}}}", f"list({inside})")) if len(
        at
    ) > 1 else f"list({inside})", np.array(at) - 1


def cases(rng: random.Random) -> tuple[str, dict[str, Any]]:
    """A program, and the arrays that its variables must hold."""
    n = rng.randint(1, 9)
    a, b = row(rng, n), row(rng, n)
    m, k = rng.randint(1, 4), rng.randint(1, 4)
    s = row(rng, m * k).reshape(m, k)
    text = declared("a", a) + declared("b", b) + declared("s", s)
    want: dict[str, Any] = {}

    def add(statement: str, name: str, value: Any) -> None:
        nonlocal text
        text += statement + "\n"
        want[name] = value

    made, held = mask_of(rng, "a", a)
    add(f"farray m0 = {made} + 0;", "m0", held.astype(float))
    add(f"farray w = where({made}, a, b);", "w", np.where(held, a, b))
    add(f"float n1 = any({made}), n2 = all({made}), n3 = count({made});", "n1", float(held.any()))
    want |= {"n2": float(held.all()), "n3": float(held.sum())}
    if held.any():
        add(f"farray p = a[{made}];", "p", a[held])
        add(f"farray f = find({made});", "f", np.flatnonzero(held) + 1.0)
        changed = b.copy()
        changed[held] = a[held]
        add(f"farray c = b; c[{made}] = a[{made}];", "c", changed)
        raised = b.copy()
        raised[held] += 2
        add(f"farray d = b; d[{made}] += 2;", "d", raised)
    words, at = index_of(rng, n)
    add(f"farray i0 = a[{words}];", "i0", a[at])
    written = a.copy()
    written[at] = b[at]
    add(f"farray i1 = a; i1[{words}] = b[{words}];", "i1", written)
    add("farray u = max(a, b), v = min(a, b, 0), t = clamp(a, -1, 1);", "u", np.maximum(a, b))
    want |= {"v": np.minimum(np.minimum(a, b), 0), "t": np.clip(a, -1, 1)}
    add("farray so = sort(a), cu = cumsum(a);", "so", np.sort(a))
    want["cu"] = np.cumsum(a)
    if n > 1:
        add("farray di = diff(a);", "di", np.diff(a))
    add("float su = sum(a), mx = max(a), mn = min(a);", "su", a.sum())
    want |= {"mx": a.max(), "mn": a.min()}
    for axis in (1, 2):
        add(
            f"farray x{axis} = sum(s, axis = {axis}), y{axis} = max(s, axis = {axis}), z{axis} = min(s, axis = {axis});",
            f"x{axis}",
            s.sum(axis=axis - 1),
        )
        want |= {f"y{axis}": s.max(axis=axis - 1), f"z{axis}": s.min(axis=axis - 1)}
        add(
            f"farray e{axis} = mean(s, axis = {axis});",
            f"e{axis}",
            s.sum(axis=axis - 1) / s.shape[axis - 1],
        )
    words, at = index_of(rng, m)
    columns, there = index_of(rng, k)
    add(f"farray g0 = s[{words}, {columns}];", "g0", s[np.ix_(at, there)])
    j = rng.randint(1, k)
    add(f"farray g1 = s[{words}, {j}];", "g1", s[at, j - 1])
    put = s.copy()
    put[:, there] = 9
    add(f"farray g2[{m},{k}] = s; g2[, {columns}] = 9;", "g2", put)
    made, held = mask_of(rng, "s", s)
    if held.any():
        add(f"farray g3 = s[{made}];", "g3", s[held])
        put = s.copy()
        put[held] = -put[held]
        add(f"farray g4[{m},{k}] = s; g4[{made}] = -s[{made}];", "g4", put)
    return text, want


@pytest.mark.parametrize("seed", range(400 if SOAK else 12))
def test_masks_sections_and_reductions_are_those_of_numpy(seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(10):
        text, want = cases(rng)
        model = moldloft.loads(text)
        assert not model.diagnostics, (text, model.diagnostics)
        for name, value in want.items():
            found = np.asarray(model[name])
            assert found.shape == np.shape(value), (name, text)
            assert np.array_equal(found, value), (name, found, value, text)


def test_points_are_chosen_and_written_by_masks() -> None:
    rng = random.Random(5)
    for _ in range(200 if SOAK else 20):
        n = rng.randint(2, 7)
        points = np.array([row(rng, 3) for _ in range(n)])
        text = f"curve c[{n}];\n"
        text += "".join(
            f"c[{i + 1}] = {{{', '.join(map(spelled, p))}}};\n" for i, p in enumerate(points)
        )
        x = rng.randint(-40, 40) / 8
        held = points[:, 0] > x
        if not held.any():
            continue
        text += f"curve d = c[c.x > {x}]; curve e = c; e[c.x > {x}].y = 0; curve f = c; f[c.x > {x}] = {{1, 2, 3}};\n"
        text += "vector low = min(c), total = sum(c), mid = mean(c);\n"
        model = moldloft.loads(text)
        flat, put = points.copy(), points.copy()
        flat[held, 1] = 0
        put[held] = [1, 2, 3]
        assert np.array_equal(model["d"], points[held])
        assert np.array_equal(model["e"], flat)
        assert np.array_equal(model["f"], put)
        assert np.array_equal(model["low"], points.min(axis=0))
        assert np.array_equal(model["total"], points.sum(axis=0))
        assert np.array_equal(model["mid"], points.sum(axis=0) / n)


def test_remainders_and_quotients_are_exact() -> None:
    rng = random.Random(1)
    sizes = (10, 10**6, 10**12, 2**53 - 1, 10**17, 10**300)
    pairs = [(10**17, 3), (-(10**17), 3), (7, -3), (-7, 3), (0, 5)]
    for _ in range(20_000 if SOAK else 300):
        big, small = rng.choice(sizes), rng.choice(sizes)
        # Whole numbers that a float holds exactly.
        pairs.append(
            (
                int(float(rng.randint(-big, big))),
                int(float(rng.randint(1, small))) * rng.choice((1, -1)),
            )
        )
    for begin in range(0, len(pairs), 100):
        part = pairs[begin : begin + 100]
        lines = [
            f"float r{k} = mod({float(a)!r}, {float(b)!r}), q{k} = div({float(a)!r}, {float(b)!r});"
            for k, (a, b) in enumerate(part)
        ]
        model = moldloft.loads("\n".join(lines))
        for k, (a, b) in enumerate(part):
            assert float(model[f"r{k}"]) == float(a % b) or abs(a % b - b) < abs(b) * 1e-15, (
                a,
                b,
                model[f"r{k}"],
            )
            q = a // b
            if abs(q) < 2**52:
                assert float(model[f"q{k}"]) == float(q), (a, b, model[f"q{k}"])


def test_remainders_have_derivatives() -> None:
    model = moldloft.loads(
        "param float p = 7.3; float y = mod(p * p, 2) * mod(p, 3); float z = mod(10, p);"
    )
    h = 1e-6
    for name in ("y", "z"):
        value = [
            float(
                moldloft.loads(
                    f"float p = {7.3 + d!r}; float y = mod(p * p, 2) * mod(p, 3); float z = mod(10, p);"
                )[name]
            )
            for d in (h, -h)
        ]
        assert model.derivative(name, "p") == pytest.approx(
            (value[0] - value[1]) / (2 * h), abs=1e-7
        )


def test_new_routines_have_derivatives() -> None:
    """Of every routine against central differences, away from places where the order of numbers changes."""
    program = """farray a = p * list(3, 1, 2) + list(0, p^2, -1); farray b = list(1, 2, 3) * p;
        float y0 = sum(where(a > 1.5, a^2, -a)), y1 = sum(clamp(a, 0.2, 2.5) * list(1, 2, 3)), y2 = sum(sort(a) * list(1, 2, 3));
        float y3 = cumsum(a)[2], y4 = diff(a)[1] * p, y5 = interp(1.3 * p, b, a), y6 = mean(a * a), y7 = max(a, b)[2];
        float y8 = sum(a[a > 1]), y9 = a[{3, 1}][1] * p;
        farray c = b; c[c > 2] = a[1] * p; float y10 = sum(c); c[{1, 2}] *= p; float y11 = c[1];
        surface s[2,2] = {1, 2, 3} * p; s[1,2] = {p, p, p^2}; float y12 = sum(max(s.z, axis = 1)), y13 = average(s).z, y14 = min(s).x;"""
    names = [f"y{k}" for k in range(15)]
    p, h = 1.1, 1e-6
    model = moldloft.loads(f"param float p = {p};\n{program}")
    ends = [moldloft.loads(f"float p = {p + d!r};\n{program}") for d in (h, -h)]
    for name in names:
        slope = (float(ends[0][name]) - float(ends[1][name])) / (2 * h)
        assert model.derivative(name, "p") == pytest.approx(slope, rel=1e-7, abs=1e-7), name


def test_texts_are_joined_compared_and_kept_in_arrays() -> None:
    rng = random.Random(2)
    letters = "abAB zé_9"
    for _ in range(300 if SOAK else 30):
        words = ["".join(rng.choice(letters) for _ in range(rng.randint(0, 4))) for _ in range(4)]
        quoted = [f'"{w}"' for w in words]
        text = f'string t[4] = {{{", ".join(quoted)}}}; string joined = ""; foreach (w in t) joined = joined + w;\n'
        text += "".join(
            f"float c{k} = t[1] {op} t[2];\n"
            for k, op in enumerate(("<", "<=", ">", ">=", "==", "!="))
        )
        text += 'string u[3]; u = "x"; u[2] = t[1] + t[2]; string first = u[1], second = u[2]; float n = u.d1, m = count(t);'
        model = moldloft.loads(text)
        a, b = words[0], words[1]
        assert model["joined"] == "".join(words)
        assert [float(model[f"c{k}"]) for k in range(6)] == [
            a < b,
            a <= b,
            a > b,
            a >= b,
            a == b,
            a != b,
        ]
        assert (model["first"], model["second"], float(model["n"]), float(model["m"])) == (
            "x",
            a + b,
            3,
            4,
        )


def test_ints_are_exact_or_refused() -> None:
    rng = random.Random(3)
    for _ in range(300 if SOAK else 40):
        x, y = rng.randint(-(2**31), 2**31), rng.randint(-(2**23), 2**23)
        for op, value in (("+", x + y), ("-", x - y), ("*", x * y)):
            text = f"int a = {x}; int b = {y}; int c = a {op} b;"
            if abs(value) < 2**53:
                assert int(moldloft.loads(text)["c"]) == value
            else:
                with pytest.raises(moldloft.Error, match="int-overflow"):
                    moldloft.loads(text)
    for text in (
        "int i = 9007199254740993;",
        "int i = 2^70;",
        "int i = 1; for (k = 1:60) i *= 2;",
        "int i = -2^53;",
    ):
        with pytest.raises(moldloft.Error, match="int-overflow"):
            moldloft.loads(text)
    assert int(moldloft.loads("int i = 9007199254740991;")["i"]) == 2**53 - 1


@pytest.mark.parametrize(
    "expression",
    [
        "1/z",
        "z/z",
        "sqrt(-1 + z)",
        "log(z)",
        "z^(-1)",
        "z^(-0.5)",
        "(z - 1)^0.5",
        "div(1, z)",
        "mod(1, z)",
        "1e308*10 + z",
        "exp(1000 + z)",
        "1/(1/z)",
    ],
)
def test_what_has_no_finite_value_is_an_error_with_a_place(expression: str) -> None:
    """One rule for numbers and arrays; `ieee()` lets them pass."""
    array = expression.replace("z", "a")
    numbers = [
        f"float z = 0; float y = {expression};",
        f"float z = 0; for (k = 1:3) {{ float y = {expression}; }}",
    ]
    if expression != "1e308*10 + z":
        numbers += [
            f"farray a[5]; farray y = {array};",
            f"farray a = list(1, 0, 2); for (k = 1:4) {{ farray y = {array}; }}"
            if "sqrt" not in expression and "- 1" not in expression and "exp" not in expression
            else f"farray a[3]; farray y = {array};",
        ]
    for text in numbers:
        with pytest.raises(moldloft.Error, match="not-finite") as raised:
            moldloft.loads(text)
        assert "model.sdl:1:" in str(raised.value)
        assert not moldloft.loads("ieee();\n" + text).diagnostics


def test_calls_nest_ten_thousand_deep() -> None:
    model = moldloft.loads(
        """function float d(int n) { if (n == 0) return 0; return 1 + d(n - 1); }
        function float even(int n) { if (n == 0) { return 1; } return odd(n - 1); }
        function float odd(int n) { if (n == 0) { return 0; } return even(n - 1); }
        float x = d(10000), y = even(9999);"""
    )
    assert (float(model["x"]), float(model["y"])) == (10000, 0)
    with pytest.raises(moldloft.Error, match="nested-too-deep"):
        moldloft.loads("function float d(int n) { return 1 + d(n + 1); } float x = d(0);")


def test_routines_are_arguments() -> None:
    model = moldloft.loads(
        """function float square(float x) { return x * x; }
        function float simpson(function f, float a, float b, int n) {
            float h = (b - a) / n, s = f(a) + f(b);
            for (i = 1:n - 1) s += where(mod(i, 2) == 1, 4, 2) * f(a + i * h);
            return s * h / 3;
        }
        function float twice(function f, float x) { return passed(f, passed(f, x)); }
        function float passed(function f, float x) { return f(x); }
        subroutine fill(returned farray a, float x) { a = x; }
        subroutine each(subroutine s, returned farray a) { s(a, 3); }
        farray a[2]; each(fill, a);
        float s = simpson(square, 0, 3, 10), c = simpson(cos, 0, PI / 2, 40), t = twice(square, 3), e = sum(a);"""
    )
    assert float(model["s"]) == pytest.approx(9, abs=1e-12)
    assert float(model["c"]) == pytest.approx(1, abs=1e-7)
    assert (float(model["t"]), float(model["e"])) == (81, 6)
    for text in ("1", '"square"', "none", "x"):
        program = (
            f"function float f(function g) {{ return g(1); }} float x = 2; float y = f({text});"
        )
        with pytest.raises(moldloft.Error):
            moldloft.loads(program)


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("subroutine f(float a) { foo(a); curve c = 5; }", {"unknown-name", "wrong-type"}),
        ("if (0) foo(1);", {"unknown-name"}),
        ("function float f(float a) { return a + bb; }", {"unknown-name"}),
        ("subroutine f() { f(1); }", {"too-many-arguments"}),
        (
            "subroutine g(float a) {} subroutine f() { g(); g(1, b = 2); }",
            {"missing-argument", "unknown-argument"},
        ),
        ("subroutine f() { float x = atan2(1); }", {"missing-argument"}),
        ("subroutine f() { Pointt P(1, 2, 3); }", {"unknown-entity"}),
        ("subroutine f() { curv c[3]; }", {"unknown-type"}),
        ("subroutine f() { curve c[3], d[4]; c = d; }", {"shapes-differ"}),
        ("subroutine f() { curve c[3], d[4]; c = c + d; }", {"shapes-differ"}),
        ('subroutine f() { float x; x = "a"; }', {"wrong-type"}),
        ("function float f(float a) { if (a > 0) return 1; }", {"missing-return"}),
        ("function float f(float a) { return 1; print 2; }", {"unreachable"}),
        ("for (i = 1:3) { break; print i; }", {"unreachable"}),
        ("float a = 1; float a = 2;", {"declared-again"}),
        ("curve c[5]; int c;", {"declared-again"}),
        ("float t = 1; subroutine f() { float t = 2; print t; }", {"shadowed"}),
        ("function float sin(float x) { return 42; }", {"redefined"}),
        ("float PI = 3;", {"redefined"}),
        # What is right stays without a word.
        (
            "subroutine f(returned curve c) { c.x = later(2) + top; } function float later(float x) { return x; } float top = 1;",
            set(),
        ),
        ("for (i = 1:2) { float t = i; } for (i = 1:2) { float t = 2*i; }", set()),
        ("function float f(float a) { if (a > 0) return 1; else return 2; }", set()),
        ("function float f(float a) { while (1) { a += 1; if (a > 9) return a; } }", set()),
        (
            'load "stdsubs.sdl"\nsubroutine f(returned curve c) { line(c); dline(c, d_tanh(0, 1, .1, .1, c.d1)); }',
            set(),
        ),
        ("subroutine f(curve c...) { foreach (k in c) print k.d1, count(c); }", set()),
        (
            "subroutine f() { AbsPoint P(1, 2, 3); print P.x; leg l(P); print l.tip; } subroutine leg(AbsPoint p) { RelPoint tip(p, 0, 0, 1); }",
            set(),
        ),
    ],
)
def test_code_that_is_not_executed_is_judged(text: str, ids: set[str]) -> None:
    model = moldloft.loads(text)
    assert {d.id for d in model.diagnostics} == ids, model.diagnostics
    assert all(d.primary for d in model.diagnostics) if ids else True


def braces(a: Array) -> str:
    """An array of any depth in braces."""
    return spelled(a) if a.ndim == 0 else "{" + ", ".join(map(braces, a)) + "}"


def test_rows_in_braces_are_the_array_that_numpy_makes_of_them() -> None:
    rng = random.Random(12)
    for _ in range(1500 if SOAK else 150):
        m, n = rng.randint(1, 4), rng.randint(1, 4)
        a = row(rng, m * n).reshape(m, n)
        s, t = (row(rng, m * n * 3).reshape(m, n, 3) for _ in range(2))
        text = f"farray a = {braces(a)}, b[{m}, {n}]; b = {braces(a)}; surface s = {braces(s)}, t[{m}, {n}] = {braces(t)};\n"
        # Rows that are variables; a row of one number is written with a comma's worth of list.
        text += "".join(f"curve c{i}; c{i} = s[{i + 1},];\n" for i in range(m))
        text += f"surface u = {{{', '.join(f'c{i}' for i in range(m))}}};\n"
        text += "surface v = s; v[,] = u + t; v[1:1,] = {c0}; farray z = (s - t).z;\n"
        text += f"farray w[{m}, {n}]; for (i = 1:{m}) w[i,] = a[i,]; surface x = s; x.y = {braces(a)};\n"
        text += (
            f"farray sums = sum({braces(a)}, axis = 1);\n" if n != 3 and (m, n) != (3, 1) else ""
        )
        model = moldloft.loads(text)
        both = s + t
        both[0] = s[0]
        high = s.copy()
        high[..., 1] = a
        want = {
            "a": a,
            "b": a,
            "s": s,
            "t": t,
            "u": s,
            "v": both,
            "w": a,
            "z": (s - t)[..., 2],
            "x": high,
        }
        if "sums" in text:
            want["sums"] = a.sum(axis=0)
        for name, value in want.items():
            assert np.array_equal(model[name], value), (name, text)


def test_coordinates_may_be_rows_and_numbers() -> None:
    rng = random.Random(13)
    for _ in range(100):
        n = rng.randint(2, 6)
        parts = [rng.choice((row(rng, n), np.array(rng.randint(-9, 9) / 4))) for _ in range(3)]
        if all(p.ndim == 0 for p in parts):
            continue
        text = "".join(
            f"farray p{k} = list({', '.join(map(spelled, p))}); "
            for k, p in enumerate(parts)
            if p.ndim
        )
        point = ", ".join(f"p{k}" if p.ndim else spelled(float(p)) for k, p in enumerate(parts))
        model = moldloft.loads(
            f"{text}curve c = {{{point}}}, d[{n}]; d = {{{point}}}; d += {{{point}}};"
        )
        want = np.stack(np.broadcast_arrays(*parts), axis=-1)
        assert np.array_equal(model["c"], want) and np.array_equal(model["d"], 2 * want)


def test_rows_of_texts_go_by_element() -> None:
    rng = random.Random(14)
    for _ in range(100):
        n = rng.randint(1, 5)
        a, b = (["".join(rng.choices("abc", k=rng.randint(0, 3))) for _ in range(n)] for _ in "ab")
        one = rng.choice(a)
        text = "".join(
            f"string {name}[{n}]; "
            + "".join(f'{name}[{k + 1}] = "{t}"; ' for k, t in enumerate(row))
            for name, row in (("a", a), ("b", b))
        )
        for k, op in enumerate(COMPARISONS):
            text += f'farray m{k} = a {op} b, n{k} = a {op} "{one}"; '
        text += f'print a + b; print "{one}" + a;'
        model = moldloft.loads(text)
        for k, holds in enumerate(COMPARISONS.values()):
            assert np.array_equal(model[f"m{k}"], holds(np.array(a), np.array(b)).astype(float))
            assert np.array_equal(model[f"n{k}"], holds(np.array(a), one).astype(float))
        assert model.printed[0] == "{" + ", ".join(x + y for x, y in zip(a, b, strict=True)) + "}"
        assert model.printed[1] == "{" + ", ".join(one + x for x in a) + "}"


def test_quarter_turns_are_exact_and_have_derivatives() -> None:
    head = 'load "stdsubs.sdl"\n'
    for k in range(-9, 10):
        a = k * (np.pi / 2)
        model = moldloft.loads(
            f"{head}param float a = {a!r}; farray c = axis_cos(list(a, a + 0.3)), s = axis_sin(list(a, a + 0.3));"
            "vector v = rotate({1, 2, 3}, {0, 0, 1}, a); surface r = revolve({{1, 2, 3}, {2, 5, 1}}, a, a + 1, 2);"
        )
        exact = [(1, 0), (0, 1), (-1, 0), (0, -1)][k % 4]
        assert (model["c"][0], model["s"][0]) == exact
        assert (model["c"][1], model["s"][1]) == pytest.approx(
            (np.cos(a + 0.3), np.sin(a + 0.3)), abs=1e-15
        )
        assert np.array_equal(model["v"], [exact[0] - 2 * exact[1], exact[1] + 2 * exact[0], 3])
        assert np.array_equal(
            model["r"][0, 0], [1, 2 * exact[0] - 3 * exact[1], 2 * exact[1] + 3 * exact[0]]
        )
        assert (
            model.derivative("c[1]", "a") == -exact[1] and model.derivative("s[1]", "a") == exact[0]
        )
        assert model.derivative("s[2]", "a") == pytest.approx(np.cos(a + 0.3), abs=1e-14)
        assert model.derivative("v.x", "a") == -exact[1] - 2 * exact[0]


def test_what_is_printed_can_be_read_again() -> None:
    rng = random.Random(15)
    for _ in range(60):
        m, n = rng.randint(1, 4), rng.randint(1, 5)
        s = np.array([rng.uniform(-9, 9) * 10 ** rng.randint(-30, 30) for _ in range(3 * m * n)])
        s = s.reshape(m, n, 3)
        text = "".join(
            f"s[{i + 1}, {j + 1}] = {braces(s[i, j])}; " for i in range(m) for j in range(n)
        )
        model = moldloft.loads(f"surface s[{m}, {n}]; {text} print s; print s.x; print s[1,];")
        whole, x, line = model.printed
        assert len(whole.splitlines()) == len(x.splitlines()) == m
        again = moldloft.loads(f"surface s = {whole}; farray x = {x}; curve c = {line};")
        assert np.array_equal(again["s"], s)
        assert np.array_equal(again["x"], s[..., 0]) and np.array_equal(again["c"], s[0])
