"""Programs beside the same in Python: lists, records, default arguments, masks, texts.

Each statement is made twice, in the language and as a Python function on a dictionary of values; at
the end all variables are compared. `MOLDLOFT_SOAK=1` runs thousands.
"""

from __future__ import annotations

import copy
import os
import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
Run = Callable[[dict[str, Any]], Any]
Twin = tuple[str, Run]


class Twins:
    """A program under construction and its twin."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.lines: list[str] = []
        self.steps: list[Run] = []
        self.kinds: dict[str, str] = {}
        self.count = 0

    def name(self, kind: str) -> str:
        self.count += 1
        return f"{kind[0]}{self.count}"

    def of(self, kind: str) -> str | None:
        names = [name for name, own in self.kinds.items() if own == kind]
        return self.random.choice(names) if names else None

    def say(self, line: str, step: Run) -> None:
        self.lines.append(line)
        self.steps.append(step)

    def number(self, depth: int = 2) -> Twin:
        """A number: literals, variables, members, items, calls, operators."""
        r = self.random
        ways: list[Callable[[], Twin | None]] = [
            self.literal,
            self.variable,
            self.item,
            self.member,
            self.found,
            self.length,
            self.read,
        ]
        if depth > 0:
            ways += [
                lambda: self.binary(depth),
                lambda: self.compared(depth),
                lambda: self.called(depth),
            ] * 2
        while True:
            twin = r.choice(ways)()
            if twin is not None:
                return twin

    def literal(self) -> Twin:
        x = self.random.choice([self.random.randint(-4, 9), round(self.random.uniform(-3, 3), 2)])
        return (f"({x})" if x < 0 else repr(x)), lambda _: float(x)

    def variable(self) -> Twin | None:
        name = self.of("float")
        return None if name is None else (name, lambda v: v[name])

    def item(self) -> Twin | None:
        name = self.of("row")
        if name is None:
            return None
        k = self.random.randint(1, 4)
        return f"{name}[{k}]", lambda v: float(v[name][k - 1])

    def member(self) -> Twin | None:
        name, r = self.of("wing"), self.random
        if name is None:
            return None
        k, j = r.randint(1, 2), r.randint(1, 3)
        return r.choice(
            [
                (f"{name}.span", lambda v: v[name]["span"]),
                (f"{name}.ribs[{k}].chord", lambda v: v[name]["ribs"][k - 1]["chord"]),
                (f"{name}.ribs[{k}].y[{j}]", lambda v: float(v[name]["ribs"][k - 1]["y"][j - 1])),
                (
                    f"sum({name}.ribs[{k}].y)",
                    lambda v: float(np.add.reduce(list(v[name]["ribs"][k - 1]["y"]))),
                ),
            ]
        )

    def found(self) -> Twin | None:
        name = self.of("string")
        if name is None:
            return None
        part = self.random.choice(["a", "b", "ab", "-", "x7"])
        return f'find({name}, "{part}")', lambda v: float(v[name].find(part) + 1)

    def length(self) -> Twin | None:
        kind = self.random.choice(["string", "list", "texts"])
        name = self.of(kind)
        return None if name is None else (f"len({name})", lambda v: float(len(v[name])))

    def read(self) -> Twin:
        x = round(self.random.uniform(-9, 9), 3)
        return f'number(" {x} ")', lambda _: x

    def binary(self, depth: int) -> Twin:
        (a, f), (b, g) = self.number(depth - 1), self.number(depth - 1)
        op, h = self.random.choice(
            [
                ("+", lambda x, y: x + y),
                ("-", lambda x, y: x - y),
                ("*", lambda x, y: x * y),
                ("and", lambda x, y: float(x != 0 and y != 0)),
                ("or", lambda x, y: float(x != 0 or y != 0)),
            ]
        )
        return f"({a} {op} {b})", lambda v: h(f(v), g(v))

    def compared(self, depth: int) -> Twin:
        (a, f), (b, g) = self.number(depth - 1), self.number(depth - 1)
        op, h = self.random.choice(
            [("<", lambda x, y: x < y), (">=", lambda x, y: x >= y), ("==", lambda x, y: x == y)]
        )
        return f"({a} {op} {b})", lambda v: float(h(f(v), g(v)))

    def called(self, depth: int) -> Twin:
        """A function whose last arguments have values of their own."""
        (a, f), (b, g) = self.number(depth - 1), self.number(depth - 1)
        return self.random.choice(
            [
                (f"scaled({a})", lambda v: f(v) * 2 + (f(v) + 1)),
                (f"scaled({a}, {b})", lambda v: f(v) * g(v) + (f(v) + 1)),
                (f"scaled({a}, c = {b})", lambda v: f(v) * 2 + g(v)),
                (f"scaled(c = {b}, a = {a})", lambda v: f(v) * 2 + g(v)),
            ]
        )

    def mask(self, depth: int = 2) -> Twin:
        """A mask of four, numbers on either side of `and` and `or` among it."""
        (a, f), (x, g) = self.row(), self.number(1)
        twin: Twin = (f"({a} > {x})", lambda v: f(v) > g(v))
        for _ in range(self.random.randint(0, depth)):
            twin = self.combined(twin)
        return twin

    def combined(self, twin: Twin) -> Twin:
        (a, f), r = twin, self.random
        op = r.choice(["and", "or"])
        b, g = self.number(1) if r.random() < 0.6 else self.mask(0)
        h = np.logical_and if op == "and" else np.logical_or
        if r.random() < 0.2:
            return f"(not {a})", lambda v: np.logical_not(f(v))
        if r.random() < 0.5:
            return f"({a} {op} {b})", lambda v: h(np.asarray(f(v)) != 0, np.asarray(g(v)) != 0)
        return f"({b} {op} {a})", lambda v: h(np.asarray(g(v)) != 0, np.asarray(f(v)) != 0)

    def row(self) -> Twin:
        name = self.of("row")
        if name is None or self.random.random() < 0.2:
            start, end = self.random.randint(-3, 0), self.random.randint(1, 5)
            return f"uniform({start}, {end}, 4)", lambda _: start + (end - start) * np.arange(4) / 3
        return name, lambda v: np.array(v[name])

    def text(self) -> Twin:
        name, r = self.of("string"), self.random
        word = "".join(r.choice("ab-x7") for _ in range(r.randint(0, 5)))
        if name is None or r.random() < 0.3:
            return f'"{word}"', lambda _: word
        first = r.randint(1, 2)
        part = r.choice(["a", "b", "-"])
        return r.choice(
            [
                (name, lambda v: v[name]),
                (f'({name} + "{word}")', lambda v: v[name] + word),
                (f'cut({name} + "--", {first})', lambda v: (v[name] + "--")[first - 1 :]),
                (f'replace({name}, "{part}", "{word}")', lambda v: v[name].replace(part, word)),
                (f"upper({name})", lambda v: v[name].upper()),
                (f'trim(" " + {name} + " ")', lambda v: v[name]),
            ]
        )

    # Statements.

    def declare(self) -> None:
        kind = self.random.choice(["float", "row", "string", "wing", "list", "texts"])
        name = self.name(kind)
        if kind == "float":
            a, f = self.number()
            self.say(f"float {name} = {a};", lambda v: v.__setitem__(name, f(v)))
        elif kind == "row":
            a, f = self.row()
            self.say(
                f"farray {name}[4] = {a};", lambda v: v.__setitem__(name, np.array(f(v), float))
            )
        elif kind == "string":
            a, f = self.text()
            self.say(f"string {name} = {a};", lambda v: v.__setitem__(name, f(v)))
        elif kind == "texts":
            a, f = self.text()
            self.say(
                f'string {name}[] = split({a}, "-");',
                lambda v: v.__setitem__(name, f(v).split("-")),
            )
        elif kind == "wing":
            a, f = self.number(1)
            self.say(f"wing {name} = wing(span = {a});", lambda v: v.__setitem__(name, wing(f(v))))
        else:
            rows = [self.row() for _ in range(self.random.randint(1, 3))]
            items = ", ".join(a for a, _ in rows)
            self.say(
                f"farray {name}[] = {{{items}}};",
                lambda v: v.__setitem__(name, [np.array(f(v), float) for _, f in rows]),
            )
        # Known to what follows: a declaration does not read its own variable.
        self.kinds[name] = kind

    def assign(self) -> None:
        r = self.random
        a, f = self.number(1)
        k, j = r.randint(1, 2), r.randint(1, 3)
        if (name := self.of("wing")) and r.random() < 0.5:
            what = r.randint(0, 3)
            if what == 0:
                self.say(f"{name}.span = {a};", lambda v: v[name].__setitem__("span", f(v)))
            elif what == 1:
                self.say(
                    f"{name}.ribs[{k}].y[{j}] += {a};",
                    lambda v: v[name]["ribs"][k - 1]["y"].__setitem__(
                        j - 1, v[name]["ribs"][k - 1]["y"][j - 1] + f(v)
                    ),
                )
            elif what == 2:
                self.say(
                    f"raise({name}.ribs[{k}].y, {a});",
                    lambda v: v[name]["ribs"][k - 1].__setitem__(
                        "y", v[name]["ribs"][k - 1]["y"] + f(v)
                    ),
                )
            elif other := self.of("wing"):
                self.say(
                    f"{name} = {other};", lambda v: v.__setitem__(name, copy.deepcopy(v[other]))
                )
        elif (name := self.of("list")) and r.random() < 0.6:
            b, g = self.row()
            if r.random() < 0.5:
                self.say(
                    f"{name} = append({name}, {b});",
                    lambda v: v[name].append(np.array(g(v), float)),
                )
            else:
                self.say(
                    f"foreach (q in {name}) {name}[1] = {name}[1] + q;",
                    lambda v: [v[name].__setitem__(0, v[name][0] + q) for q in list(v[name])],
                )
        elif name := self.of("row"):
            m, h = self.mask()

            def put(v: dict[str, Any]) -> None:
                held = np.asarray(h(v))
                v[name][held] = f(v)

            self.say(f"{name}[{m}] = {a};", put)

    def repeat(self) -> None:
        """A loop or a branch around what follows."""
        name = self.of("float")
        if name is None:
            return
        (a, f), (b, g), n = self.number(1), self.number(1), self.random.randint(1, 3)

        def loop(v: dict[str, Any]) -> None:
            for i in range(1, n + 1):
                if g(v) > i:
                    v[name] = v[name] * 0.5 + f(v)
                else:
                    v[name] -= i

        self.say(
            f"for (i=1:{n}) {{ if ({b} > i) {name} = {name}*0.5 + {a}; else {name} -= i; }}", loop
        )


def wing(span: float) -> dict[str, Any]:
    rib = {"chord": 1.0, "y": np.zeros(3)}
    return {"span": span, "ribs": [copy.deepcopy(rib), copy.deepcopy(rib)]}


HEAD = """record rib { float chord = 1; farray y[3]; }
record wing { float span; rib ribs[2]; }
function float scaled(float a, float b = 2, float c = a + 1) { return a*b + c; }
subroutine raise(returned farray y, float by) { y += by; }
"""


def same(found: Any, wanted: Any) -> bool:
    if isinstance(wanted, dict):
        return all(same(found[key], wanted[key]) for key in wanted)
    if isinstance(wanted, str):
        return bool(found == wanted)
    if isinstance(wanted, list):
        return len(found) == len(wanted) and all(map(same, found, wanted))
    return np.shape(found) == np.shape(wanted) and np.allclose(
        found, wanted, rtol=1e-13, atol=1e-13
    )


@pytest.mark.parametrize("seed", range(4000 if SOAK else 60))
def test_programs_are_their_twins(seed: int) -> None:
    twins = Twins(seed)
    for _ in range(twins.random.randint(6, 16)):
        twins.random.choice([twins.declare, twins.declare, twins.assign, twins.repeat])()
    values: dict[str, Any] = {}
    for step in twins.steps:
        step(values)
    text = HEAD + "\n".join(twins.lines)
    model = moldloft.loads(text)
    assert not model.has_errors, f"{text}\n{model.diagnostics}"
    for name, wanted in values.items():
        assert same(model[name], wanted), f"{name}: {model[name]} is not {wanted}\n{text}"
