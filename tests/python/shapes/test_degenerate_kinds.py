"""Every kind and function on degenerate input: an error or remark that names it, or a finite shape.

The example of each entry is varied: its points coincide, pairwise or all, lie on a line or in a
plane, are tiny, huge or far away; each of its numbers becomes 0, negative, tiny or huge.
`MOLDLOFT_SOAK=1` takes all variants of all entries.
"""

from __future__ import annotations

import math
import os
import re
import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import moldloft
from moldloft.language import reference

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

#: What writes or reads files, and what stops a run on purpose.
PASSED_OVER = {"open", "close", "read", "write", "plot", "rewind", "assert"}

_NUMBER = re.compile(r"(?<![\w.\"])-?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w.\"])")
_POINT = re.compile(r"(AbsPoint \w+\()([^()]*)(\))|(\{)([^{}()\"]*,[^{}()\"]*,[^{}()\"]*)(\})")
VALUES = ("0", "-1", "1e-300", "1e300", "-1e12", "1e-9")


def triples(text: str) -> list[re.Match[str]]:
    """The points of a program that are written as three numbers."""

    def three(match: re.Match[str]) -> bool:
        parts = (match[2] or match[5]).split(",")
        return len(parts) == 3 and all(_NUMBER.fullmatch(part.strip()) for part in parts)

    return [match for match in _POINT.finditer(text) if three(match)]


def moved(text: str, change: Any) -> str:
    """The program with its points changed: ``change(k, xyz)``."""
    out, end = [], 0
    for k, match in enumerate(triples(text)):
        group = 2 if match[2] else 5
        xyz = np.array([float(part) for part in match[group].split(",")])
        new = ", ".join(f"{x:.17g}" for x in change(k, xyz))
        out += [text[end : match.start(group)], new]
        end = match.end(group)
    return "".join([*out, text[end:]])


def variants(text: str) -> Iterator[tuple[str, str]]:
    """Names and programs."""
    points = triples(text)
    if points:
        first = np.array([float(x) for x in (points[0][2] or points[0][5]).split(",")])
        yield "all points one", moved(text, lambda k, p: first)
        yield "on a line", moved(text, lambda k, p: (p[0] + 2 * p[1] + 3 * p[2], 0, 0))
        yield "in a plane", moved(text, lambda k, p: (p[0], p[1], 0))
        yield "tiny", moved(text, lambda k, p: 1e-12 * p)
        yield "huge", moved(text, lambda k, p: 1e12 * p)
        yield "beyond", moved(text, lambda k, p: 1e200 * p)
        yield "far away", moved(text, lambda k, p: p + 1e9)
        for j in range(1, len(points)):
            other = [float(x) for x in (points[j - 1][2] or points[j - 1][5]).split(",")]
            yield (
                f"point {j} on the one before",
                moved(text, lambda k, p, j=j, other=other: other if k == j else p),
            )
    inside = [range(m.start(), m.end()) for m in points]
    numbers = [m for m in _NUMBER.finditer(text) if not any(m.start() in r for r in inside)]
    for k, match in enumerate(numbers):
        for value in VALUES:
            yield (
                f"number {k} is {value}",
                text[: match.start()] + value + text[match.end() :],
            )


def cases() -> list[tuple[str, str, str]]:
    found = []
    for row in reference():
        if not row["example"] or row["name"] in PASSED_OVER or row["name"].startswith("write"):
            continue
        # The assertions of an example are about its own numbers.
        text = re.sub(r"assert [^;]*;", "", row["example"])
        found += [(row["name"], name, program) for name, program in variants(text)]
    return found


CASES = cases()


def judged(program: str) -> str | None:
    """What is wrong with how a program ends; nothing where all is well."""
    try:
        model = moldloft.loads(program, strict=False)
        said = list(model.diagnostics)
        try:
            mesh = model.mesh()
            said += list(model.diagnostics)
        except moldloft.Error as error:
            said += [error]
            mesh = None
    except moldloft.Error as error:
        said, mesh, model = [error], None, None
    words = " ".join(str(d) for d in said)
    if "internal" in words or "panicked" in words:
        return f"a fault of ours: {words[:300]}"
    if mesh is not None and not np.isfinite(mesh.vertices).all():
        return "positions that are not finite"
    if model is None or words:
        return None
    for name in model:
        made = model[name]
        for measure in ("length", "area", "volume"):
            try:
                value = getattr(made, measure, None)
            except moldloft.Error:
                return None
            if isinstance(value, float) and math.isnan(value):
                return f"{name}.{measure} is {value}"
            # That of a ring is its place.
            if measure != "volume" and value == 0.0 and made.class_ not in ("ring", "bead"):
                return f"{name}.{measure} is 0 and nothing says so"
    return None


@pytest.fixture
def ten_seconds() -> Iterator[None]:
    """What takes longer than anyone waits is refused in time."""
    moldloft.limits(seconds=10.0)
    yield
    moldloft.limits(seconds=math.inf)


@pytest.mark.parametrize("part", range(8))
@pytest.mark.usefixtures("ten_seconds")
def test_degenerate_input_is_said(part: int) -> None:
    chosen = CASES if SOAK else [c for c in CASES if zlib.crc32(repr(c).encode()) % 160 == 0]
    faults = [
        (name, variant, fault, program)
        for name, variant, program in chosen[part::8]
        if (fault := judged(program)) is not None
    ]
    assert not faults, "\n".join(map(str, faults[:20]))
