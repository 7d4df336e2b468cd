"""Programs beside the same in Python: routines, loops, records, lists, texts, sections, masks.

Each program is written twice as a text, in the language and in Python with NumPy, and run; at the
end all variables and all that was printed are compared. Mutants of the programs are run as well:
they end with values or with errors that have a place. `MOLDLOFT_SOAK=1` runs thousands.
"""

from __future__ import annotations

import copy
import os
import random
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))

# A text of the language and one of Python; the same as lines.
Twin = tuple[str, str]
Lines = tuple[list[str], list[str]]

HEAD = """record part { float w = 1; farray y[4] = 2; string tag = "a"; }
function float small(float v) { while (|v| > 100) v /= 1024; return v; }
float n0 = 1, n1 = -2, total = 0; farray a0 = uniform(1, 4, 4), a1 = {3, -1, 0.5, 2};
curve c0 = {a0, a1, 0}; string t0 = "ab-b", t1 = ""; part p0 = part(3), p1;
farray l0[] = {a0, a1}; part fleet[2]; fleet[2] = p0;
"""


def small(v: float) -> float:
    while abs(v) > 100:
        v /= 1024
    return float(v)


@dataclass
class Part:
    """The record of the programs."""

    w: float = 1.0
    y: np.ndarray[Any, Any] = field(default_factory=lambda: np.full(4, 2.0))
    tag: str = "a"


def put(section: Any, value: Any) -> None:
    section[...] = value


def names() -> dict[str, Any]:
    """The variables as the head of the programs makes them, and what the twins call."""
    a0, a1 = np.array([1.0, 2, 3, 4]), np.array([3, -1, 0.5, 2])
    return {
        "np": np,
        "copy": copy.deepcopy,
        "small": small,
        "put": put,
        "printed": [],
        "n0": 1.0,
        "n1": -2.0,
        "total": 0.0,
        "a0": a0,
        "a1": a1,
        "c0": np.stack([a0, a1, 0 * a0], -1),
        "t0": "ab-b",
        "t1": "",
        "p0": Part(3.0),
        "p1": Part(),
        "l0": [a0.copy(), a1.copy()],
        "fleet": [Part(), Part(3.0)],
    }


class Programs:
    """One random program and its twin."""

    def __init__(self, seed: int) -> None:
        self.r = random.Random(seed)
        self.kinds = {
            "number": ["n0", "n1", "total"],
            "row": ["a0", "a1"],
            "curve": ["c0"],
            "text": ["t0", "t1"],
            "part": ["p0", "p1"],
        }
        # Functions that may be called: name and whether it takes a row.
        self.functions: list[str] = []
        self.rows: list[str] = []
        self.routines: list[str] = []
        self.loops = 0
        self.count = 0
        self.file = True
        self.calls = 0

    def of(self, kind: str) -> str:
        return self.r.choice(self.kinds[kind])

    def new(self, kind: str) -> str:
        self.count += 1
        return f"{kind}_{self.count}"

    def pick(self, *ways: Callable[[], Twin]) -> Twin:
        return self.r.choice(ways)()

    def called(self) -> bool:
        """True when another call is made: their number doubles with each level of recursion."""
        self.calls += 1
        return self.calls < 3

    # Expressions.

    def number(self, depth: int = 2) -> Twin:
        simple = [self.literal, self.literal, lambda: (self.of("number"),) * 2, self.element]
        simple += [self.member, self.measured]
        if depth <= 0:
            return self.pick(*simple)
        return self.pick(*simple, *[lambda: self.operated(depth - 1)] * 6)

    def literal(self) -> Twin:
        x = self.r.choice([self.r.randint(-3, 5), round(self.r.uniform(-3, 3), 2)])
        return (f"({x})" if x < 0 else repr(x)), f"({float(x)})"

    def element(self) -> Twin:
        k = self.r.randint(1, 4)
        if self.r.random() < 0.3:
            name, c = self.of("curve"), self.r.randrange(3)
            return f"{name}[{k}].{'xyz'[c]}", f"float({name}[{k - 1}, {c}])"
        name = self.of("row")
        return f"{name}[{k}]", f"float({name}[{k - 1}])"

    def member(self) -> Twin:
        name, k = self.of("part"), self.r.randint(1, 2)
        return self.r.choice(
            [
                (f"{name}.w", f"{name}.w"),
                (f"fleet[{k}].w", f"fleet[{k - 1}].w"),
                (f"{name}.y[{k}]", f"float({name}.y[{k - 1}])"),
                (f"l0[{k}][{k}]", f"float(l0[{k - 1}][{k - 1}])"),
            ]
        )

    def measured(self) -> Twin:
        name, part = self.of("text"), self.r.choice(["a", "b", "-", "ab"])
        return self.r.choice(
            [
                (f"len({name})", f"float(len({name}))"),
                (f'find({name}, "{part}")', f'float({name}.find("{part}") + 1)'),
                (f'({name} == "{part}")', f'float({name} == "{part}")'),
                (f'({name} < "b")', f'float({name} < "b")'),
                ("len(l0)", "float(len(l0))"),
            ]
        )

    def operated(self, depth: int) -> Twin:
        (a, f), (b, g), k = self.number(depth), self.number(depth), self.r.randrange(12)
        if k < 4:
            op = "+-*+"[k]
            return f"({a} {op} {b})", f"({f} {op} {g})"
        if k == 4:
            op = self.r.choice(["<", ">=", "==", "!="])
            return f"({a} {op} {b})", f"float({f} {op} {g})"
        if k == 5:
            op = self.r.choice(["and", "or"])
            return f"({a} {op} {b})", f"float(({f}) != 0 {op} ({g}) != 0)"
        if k == 6:
            return f"({a})/(|{b}| + 1)", f"(({f})/(abs({g}) + 1))"
        if k == 7:
            return f"max({a}, {b})", f"max({f}, {g})"
        if k == 8:
            return f"(not {a})", f"float(({f}) == 0)"
        if k == 9 and self.functions and self.called():
            name, (x, y) = self.r.choice(self.functions), self.row(0)
            return self.r.choice(
                [(f"{name}({a}, {x})", f"{name}({f}, {y})"), (f"{name}({a})", f"{name}({f})")]
            )
        if k == 10:
            (x, y) = self.row(0)
            return f"any({x} > {a})", f"float(bool(np.any({y} > {f})))"
        return f"-({a})^2", f"(-(({f})**2))"

    def row(self, depth: int = 2) -> Twin:
        name, part, k = self.of("row"), self.of("part"), self.r.randint(1, 2)
        c = self.r.randrange(3)
        curve = self.of("curve")
        simple: list[Twin] = [
            (name, name),
            (f"{name}[::-1]", f"{name}[::-1]"),
            (f"{curve}.{'xyz'[c]}", f"{curve}[:, {c}]"),
            (f"{part}.y", f"{part}.y"),
            (f"l0[{k}]", f"l0[{k - 1}]"),
            (f"fleet[{k}].y", f"fleet[{k - 1}].y"),
        ]
        if depth <= 0:
            return self.r.choice(simple)
        (a, f), (b, g) = self.row(depth - 1), self.row(depth - 1)
        (x, y), (m, h) = self.number(1), self.mask()
        both = [
            (f"({a} + {b})", f"({f} + {g})"),
            (f"({a} - {b})", f"({f} - {g})"),
            (f"{a}*({x})", f"{f}*({y})"),
            (f"({x})*{a}", f"({y})*{f}"),
            (f"({a})/(|{x}| + 1)", f"(({f})/(abs({y}) + 1))"),
            (f"-({a})^3", f"(-(({f})**3))"),
            (f"where({m}, {a}, {b})", f"np.where({h}, {f}, {g})"),
            (f"abs({a})", f"np.abs({f})"),
            (f"floor({a})", f"np.floor({f})"),
            (f"({a})*({b})", f"(({f})*({g}))"),
            (f"|{curve}.x|", f"np.abs({curve}[:, 0])"),
        ]
        if self.rows and self.r.random() < 0.3 and self.called():
            name = self.r.choice(self.rows)
            both = [(f"{name}({a}, {x})", f"{name}({f}, {y})")]
        return self.r.choice(both if self.r.random() < 0.7 else simple)

    def mask(self) -> Twin:
        (a, f), (b, g) = self.row(0), self.number(0)
        op = self.r.choice(["<", ">", ">="])
        twin = f"({a} {op} {b})", f"({f} {op} {g})"
        k = self.r.randrange(6)
        if k == 0:
            return f"(not {twin[0]})", f"np.logical_not({twin[1]})"
        if k == 1:
            (x, y) = self.number(0)
            op = self.r.choice(["and", "or"])
            return f"({x} {op} {twin[0]})", f"np.logical_{op}(({y}) != 0, {twin[1]})"
        return twin

    def curve(self) -> Twin:
        name, other = self.of("curve"), self.of("curve")
        (a, f), (x, y) = self.row(1), self.number(1)
        (b, g) = self.row(0)
        return self.r.choice(
            [
                (f"{name}[::-1]", f"{name}[::-1]"),
                (f"({name} + {other})*0.5", f"({name} + {other})*0.5"),
                (f"{{{a}, {b}, {a}}}", f"np.stack([{f}, {g}, {f}], -1)"),
                (f"{name}*({x})", f"{name}*({y})"),
                (f"({b})*{name}", f"({g})[:, None]*{name}"),
                (f"{name} - {{1, {x}, 2}}", f"{name} - np.array([1, {y}, 2])"),
                (f"{name}*{{1, 2, {x}}}", f"{name}*np.array([1, 2, {y}])"),
            ]
        )

    def text(self) -> Twin:
        name, part = self.of("text"), self.of("part")
        word = "".join(self.r.choice("ab-x") for _ in range(self.r.randint(0, 3)))
        k = self.r.randint(0, 99)
        return self.r.choice(
            [
                (f'"{word}"', f'"{word}"'),
                (name, name),
                (f"{part}.tag", f"{part}.tag"),
                (f'cut({name} + "{word}---", 2, 3)', f'({name} + "{word}---")[1:3]'),
                (f'cut({name} + "--", 2)', f'({name} + "--")[1:]'),
                (f'replace({name}, "a", "{word}")', f'{name}.replace("a", "{word}")'),
                (f"upper({name})", f"{name}.upper()"),
                (f'"{word}" + {part}.tag', f'("{word}" + {part}.tag)'),
                (f'format("%02d{word}", {k})', f'"%02d{word}" % {k}'),
            ]
        )

    # Statements: lines of both.

    def damped(self, twin: Twin) -> Twin:
        return f"small({twin[0]})", f"small({twin[1]})"

    def simple(self) -> Twin:
        r = self.r
        n, a, c, t, p = (self.of(kind) for kind in ("number", "row", "curve", "text", "part"))
        (x, y), (b, g), (m, h) = self.damped(self.number()), self.row(), self.mask()
        (v, w), (s, u) = self.curve(), self.text()
        k, j, q = r.randint(1, 4), r.randint(1, 2), r.randrange(3)
        op = r.choice("+-*")
        # Rows are scaled back, so that nothing grows without end.
        row, back = f"({b})/(1 + max({b})^2)", f"({g})/(1 + max({g})**2)"
        other = self.of("part")
        return r.choice(
            [
                (f"{n} = {x};", f"{n} = {y}"),
                (f"{n} {op}= {x}; {n} = small({n});", f"{n} {op}= {y}; {n} = small({n})"),
                (f"{a} = {row};", f"{a} = np.array({back})"),
                (f"{a}[{k}] = {x};", f"{a}[{k - 1}] = {y}"),
                (f"{a}[{k}] += {x};", f"{a}[{k - 1}] += {y}"),
                (f"{a}[{m}] = {x};", f"put_where({a}, {h}, {y})"),
                (f"{a}[2:] = {a}[1:3];", f"{a}[1:] = {a}[:3].copy()"),
                (f"{a}[2:3] = {a}[4:3:-1]*0.5;", f"{a}[1:3] = {a}[3:1:-1]*0.5"),
                (f"{a} += {row};", f"{a} = {a} + {back}"),
                (f"{a}[:2] *= 0.5;", f"{a}[:2] *= 0.5"),
                (f"{c} = ({v})/9;", f"{c} = ({w})/9"),
                (f"{c}.{'xyz'[q]} = {row};", f"{c}[:, {q}] = np.array({back})"),
                (f"{c}[{k}] = {{1, {x}, 2}};", f"{c}[{k - 1}] = [1, {y}, 2]"),
                (f"{c}[2:4].y -= {x};", f"{c}[1:4, 1] -= {y}"),
                (f"{t} = {s};", f"{t} = {u}"),
                (f"{p}.w = {x};", f"{p}.w = {y}"),
                (f"{p}.y = {row};", f"{p}.y = np.array({back})"),
                (f"{p}.y[{k}] -= {x};", f"{p}.y[{k - 1}] -= {y}"),
                (f"{p}.tag = {s};", f"{p}.tag = {u}"),
                (f"{p} = {other};", f"{p} = copy({other})"),
                (f"fleet[{j}] = {p};", f"fleet[{j - 1}] = copy({p})"),
                (f"fleet[{j}].w += {x};", f"fleet[{j - 1}].w += {y}"),
                (f"l0[{j}] = {row};", f"l0[{j - 1}] = np.array({back})"),
                (f"l0[{j}][{k}] = {x};", f"l0[{j - 1}][{k - 1}] = {y}"),
                (f"print {t};", f"printed.append({t})"),
                self.routine_call(),
            ]
        )

    def routine_call(self) -> Twin:
        """A routine that writes to a row, or to a part of it."""
        if not self.routines or not self.called():
            return ("total += 1;", "total += 1")
        name, (x, y) = self.r.choice(self.routines), self.damped(self.number(1))
        a, p = self.of("row"), self.of("part")
        place, view = self.r.choice(
            [(a, a), (f"{a}[2:]", f"{a}[1:]"), (f"{p}.y", f"{p}.y"), (f"{a}[::-1]", f"{a}[::-1]")]
        )
        n = self.of("number")
        return (
            f"{name}({place}, {x}); {n} = small({n} + {place}[1]);",
            f"{name}({view}, {y}); {n} = small({n} + float({view}[0]))",
        )

    def block(self, depth: int) -> Lines:
        sdl: list[str] = []
        python: list[str] = []
        for _ in range(self.r.randint(1, 3)):
            a, b = self.statement(depth)
            sdl += a
            python += b
        return sdl, python

    def statement(self, depth: int) -> Lines:
        if depth == 0 or self.r.random() < 0.5:
            if self.loops and self.r.random() < 0.08:
                (x, y), word = self.number(1), self.r.choice(["break", "continue"])
                return [f"if ({x} > 2) {word};"], [f"if {y} > 2: {word}"]
            line, twin = self.simple()
            return [line], [twin]
        kind = self.r.randrange(8)
        x, y = self.number(1)
        if kind == 0:
            (a, f), (b, g) = self.block(depth - 1), self.block(depth - 1)
            return (
                [f"if ({x} > 0) {{", *a, "} else {", *b, "}"],
                [f"if {y} > 0:", *indented(f), "else:", *indented(g)],
            )
        before = {kind: list(names) for kind, names in self.kinds.items()}
        self.loops += 1
        head, walk = self.head(kind)
        lines, twins = self.block(depth - 1)
        self.loops -= 1
        self.kinds = before
        return [head, *lines, "}" * head.count("{")], [*walk, *indented(twins)]

    def head(self, kind: int) -> tuple[str, list[str]]:
        """The head of a loop, whose variable is known in its body."""
        name, end = self.new("i"), self.r.randint(0, 3)
        of = {3: "number", 4: "row", 5: "part", 6: "text"}.get(kind, "number")
        row, twin = self.row(1)
        if kind < 7:
            self.kinds[of].append(name)
        if kind == 7:
            head = f"{{ float {name} = 0; while ({name} < {end}) {{ {name} += 1;"
            return head, [f"{name} = 0.0", f"while {name} < {end}:", f"    {name} += 1"]
        head, walked = [
            (f"for ({name} = 1:{end})", f"map(float, range(1, {end + 1}))"),
            (f"for ({name} = {end}:0:-1)", f"map(float, range({end}, -1, -1))"),
            (f"foreach ({name} in {row})", f"list(map(float, {twin}))"),
            (f"foreach ({name} in l0)", "copy(l0)"),
            (f"foreach ({name} in fleet)", "copy(fleet)"),
            (f'foreach ({name} in split(t0 + "-x", "-"))', '(t0 + "-x").split("-")'),
        ][kind - 1]
        return head + " {", [f"for {name} in {walked}:"]

    # Routines.

    def routine(self) -> Lines:
        outer = {kind: list(names) for kind, names in self.kinds.items()}
        self.calls = 0
        kind = self.r.choice(["function", "rows", "routine"])
        name = self.new("f")
        x, a, n, t, p = (f"{letter}_{self.count}" for letter in "xantp")
        # Of the file, a routine knows what its twin declares as global.
        self.kinds = {
            "number": [x, "total", n],
            "row": [a],
            "curve": ["c" + x],
            "text": ["t0", t],
            "part": ["p0", p],
        }
        local = [f'float {n} = {x}; string {t} = "q"; part {p} = part({x});']
        local += [f"curve c{x} = {{{a}, {a}, 0}};"]
        twin = ["global total, t0, p0, p1, l0, fleet"]
        twin += [f"{a} = np.array(a0 if {a} is None else {a})"] if kind != "routine" else []
        twin += [f'{n}, {t}, {p} = {x}, "q", Part({x})']
        twin += [f"c{x} = np.stack([{a}, {a}, 0*{a}], -1)"]
        body, lines = self.block(2)
        (r, s), (b, g) = self.damped(self.number(1)), self.row(1)
        if kind == "function":
            # Each call of itself is one level deeper.
            again = f"{name}({x} - 1, {a}, left - 1)"
            sdl = [f"function float {name}(float {x}, farray {a} = a0, int left = 2) {{", *local]
            sdl += [f"if (left < 1) return {x};", *body, f"return small({r} + {again}); }}"]
            twin += [f"if left < 1: return {x}", *lines, f"return small({s} + {again})"]
            head = f"def {name}({x}, {a}=None, left=2):"
        elif kind == "rows":
            sdl = [f"function farray {name}(farray {a}, float {x}) {{", *local, *body]
            sdl += [f"if ({x} > 1) return {a}; return ({b})/(1 + max({b})^2); }}"]
            twin += [*lines, f"if {x} > 1: return {a}", f"return ({g})/(1 + max({g})**2)"]
            head = f"def {name}({a}, {x}):"
        else:
            # What is passed may be a part of any length.
            sdl = [f"subroutine {name}(returned farray {a}, float {x}) {{", f"farray b{a} = {a};"]
            sdl += [f"{a} *= 0.5; {a}[1] += {x}; if ({x} > 0) {a} = {a}[::-1] + b{a}*0;"]
            sdl += [f"total += sum({a} > 0); }}"]
            twin = [twin[0], f"{a} *= 0.5; {a}[0] += {x}"]
            twin += [f"if {x} > 0: {a}[...] = {a}[::-1].copy()"]
            twin += [f"total += float(np.sum({a} > 0))"]
            head = f"def {name}({a}, {x}):"
        self.kinds = outer
        {"function": self.functions, "rows": self.rows, "routine": self.routines}[kind].append(name)
        return sdl, [head, *indented(twin)]

    def program(self) -> Twin:
        sdl: list[str] = []
        python = ["def put_where(a, mask, x):", "    a[np.asarray(mask)] = x"]
        for _ in range(self.r.randint(0, 4)):
            lines, twins = self.routine()
            sdl += lines
            python += twins
        for _ in range(self.r.randint(2, 6)):
            self.calls = 0
            a, b = self.statement(3)
            sdl += a
            python += b
        return HEAD + "\n".join(sdl), "\n".join(python)


def indented(lines: list[str]) -> list[str]:
    return ["    " + line for line in lines]


def same(found: Any, wanted: Any) -> bool:
    if isinstance(wanted, Part):
        return all(same(found[key], getattr(wanted, key)) for key in ("w", "y", "tag"))
    if isinstance(wanted, str):
        return bool(found == wanted)
    if isinstance(wanted, list):
        return len(found) == len(wanted) and all(map(same, found, wanted))
    return np.shape(found) == np.shape(wanted) and bool(
        np.allclose(found, wanted, rtol=1e-12, atol=1e-12)
    )


def checked(seed: int) -> str:
    sdl, python = Programs(seed).program()
    values = names()
    values["Part"] = Part
    exec(python, values)
    model = moldloft.loads(sdl)
    assert not model.has_errors, f"{sdl}\n{model.diagnostics}"
    for name in ("n0", "n1", "total", "a0", "a1", "c0", "t0", "t1", "p0", "p1", "l0", "fleet"):
        found, wanted = model[name], values[name]
        assert same(found, wanted), f"{seed}: {name}: {found} is not {wanted}\n{sdl}\n{python}"
    assert model.printed == values["printed"], f"{sdl}\n{python}"
    return sdl


@pytest.mark.parametrize("seed", range(4000 if SOAK else 80))
def test_programs_do_what_their_twins_do(seed: int) -> None:
    checked(seed)


WORD = re.compile(r"\w+|[^\w\s]")


def mutant(r: random.Random, text: str) -> str:
    """A text with some of its words left out, doubled, exchanged or taken from elsewhere."""
    words = list(WORD.finditer(text))
    for _ in range(r.randint(1, 3)):
        word, other = r.choice(words), r.choice(words)
        new = r.choice(
            ["", word.group() * 2, other.group(), "0", "1e300", "-1", "[", "}", "a0", "p0"]
        )
        text = text[: word.start()] + new + text[word.end() :]
        words = list(WORD.finditer(text))
    return text


@pytest.mark.parametrize("seed", range(40 if SOAK else 2))
def test_mutants_end_with_values_or_errors_that_have_a_place(seed: int) -> None:
    r = random.Random(seed)
    before = moldloft.limits()
    try:
        moldloft.limits(steps=200_000)
        for k in range(50):
            text = mutant(r, Programs(1000 * seed + k).program()[0])
            try:
                found = tuple(moldloft.loads(text).diagnostics)
            except moldloft.ModelError as error:
                found = error.diagnostics
                assert found, text
            for diagnostic in found:
                assert diagnostic.severity != "error" or diagnostic.primary, (text, diagnostic)
    finally:
        moldloft.limits(steps=before.steps)
