"""Numbers beyond double precision in whole arrays: each fault is found and placed.

The judge is NumPy, which computes the same expression operator by operator.
"""

from __future__ import annotations

import os
import random
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

import moldloft

SOAK = bool(os.environ.get("MOLDLOFT_SOAK"))
CASES = 4_000 if SOAK else 120

Row = NDArray[np.float64]


def faults(text: str) -> list[moldloft.Diagnostic]:
    """The errors of a program."""
    try:
        moldloft.loads(text)
    except moldloft.ModelError as error:
        return [d for d in error.diagnostics if d.severity == "error"]
    return []


@dataclass
class Written:
    """An expression: its text, what NumPy makes of it, and the text of its first fault."""

    text: str
    value: Row
    fault: str | None


def judged(text: str, value: Row, parts: list[Written]) -> Written:
    """The result of an operator on parts, the faults of which come first."""
    fault = next((part.fault for part in parts if part.fault), None)
    if fault is None and not np.isfinite(value).all():
        fault = text
    return Written(f"({text})", value, fault)


def expression(draw: random.Random, rows: dict[str, Row], depth: int) -> Written:
    """A random expression of the rows and of numbers."""
    if depth == 0 or draw.random() < 0.15:
        name = draw.choice(sorted(rows))
        return Written(name, rows[name], None)
    a = expression(draw, rows, depth - 1)
    kind = draw.choice(["+", "-", "*", "*", "/", "over", "part", "scaled", "square", "max", "atan"])
    if kind == "square":
        return judged(f"{a.text}^2", a.value * a.value, [a])
    if kind == "atan":
        return judged(f"atan({a.text})", np.arctan(a.value), [a])
    if kind in ("over", "part", "scaled"):
        number = draw.choice([0.5, 3.0, 1e150, 1e-150])
        if kind == "over":
            return judged(f"{number!r}/{a.text}", number / a.value, [a])
        sign, value = ("/", a.value / number) if kind == "part" else ("*", a.value * number)
        return judged(f"{a.text}{sign}{number!r}", value, [a])
    b = expression(draw, rows, depth - 1)
    if kind == "max":
        return judged(f"max({a.text}, {b.text})", np.maximum(a.value, b.value), [a, b])
    value = {
        "+": np.add,
        "-": np.subtract,
        "*": np.multiply,
        "/": np.divide,
    }[kind](a.value, b.value)
    return judged(f"{a.text} {kind} {b.text}", value, [a, b])


@pytest.mark.parametrize("seed", range(CASES))
def test_the_first_fault_is_placed(seed: int) -> None:
    draw = random.Random(seed)
    n = draw.choice([1, 2, 5, 33, 1_001])
    size = draw.choice([1, 120, 180])
    rows = {
        name: np.array([draw.uniform(-1, 1) * 10.0 ** draw.uniform(-size, size) for _ in range(n)])
        for name in "abc"
    }
    with np.errstate(all="ignore"):
        written = expression(draw, rows, draw.randint(1, 5))
    fault = written.fault
    head = "".join(
        f"farray {name} = {{{', '.join(map(repr, row.tolist()))}}};\n" for name, row in rows.items()
    )
    statement = f"farray r = {written.text};\n"
    # Twice: the second time by what was recorded of the first.
    text = f"{head}for (k = 1:{draw.choice([1, 3])}) {{\n{statement}}}\n"
    errors = faults(text)
    if fault is None:
        assert not errors, (statement, errors)
        return
    assert errors, statement
    found = errors[0]
    assert found.id == "not-finite", found
    line = text.splitlines()[found.primary.line - 1]
    assert line[found.primary.column - 1 :].startswith(fault), (fault, str(found))


@pytest.mark.parametrize("n", [1, 3, 4, 5, 31, 1_000, 5_003])
def test_one_element_anywhere(n: int) -> None:
    for at in {0, n // 2, n - 1}:
        row = np.ones(n)
        row[at] = 1e200
        text = f"farray a[{n}]; for (k = 1:{n}) a[k] = 1; a[{at + 1}] = 1e200;\n"
        for statement in ("farray b = a*a;", "farray b = 1/(a*a);", "farray b = atan(a*a + 1);"):
            assert [d.id for d in faults(text + statement)] == ["not-finite"]
        assert not faults(text + "farray b = a + a*2;")


def test_vectors_and_magnitudes() -> None:
    head = "curve c = {{1e200, 1, 0}, {0, 1, 0}};\n"
    for statement, place in [
        ("farray m = |c|;", "|c|"),
        ("farray m = c . c;", "c . c"),
        ("curve m = c*1e200;", "c*1e200"),
        ("float m = |{1e200, 1, 0}|;", "|{1e200"),
    ]:
        errors = faults(head + statement)
        assert [d.id for d in errors] == ["not-finite"], (statement, errors)
        assert statement[errors[0].primary.column - 1 :].startswith(place)


def test_ieee_lets_it_pass() -> None:
    assert not faults("ieee(); farray a = {1e200, 2}; farray b = a*a; farray c = 1/b;")


def test_a_variable_keeps_its_value() -> None:
    """What could not be computed changes nothing."""
    text = "farray a = {1e200, 2}; a = a*a; assert a[2] == 2;"
    assert [d.id for d in faults(text)] == ["not-finite"]
