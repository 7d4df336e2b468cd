"""The result of a fairing desk as statements of a model, which give the same curves."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import FairingError
from moldloft.fairing.desk_lines import DeskResult, corners, task
from moldloft.fairing.desk_source import DeskSource
from moldloft.fairing.desk_state import DeskState

if TYPE_CHECKING:
    from moldloft.fairing.spline import Spline

__all__ = ["program"]

WIDTH = 96
"""Columns of a line of a program."""

_NAME = re.compile(r"[A-Za-z]\w*")


def program(source: DeskSource, result: DeskResult, name: str) -> str:
    """The result as statements, the last of which are the faired objects."""
    if not _NAME.fullmatch(name):
        raise FairingError(f"expected a name of an object, found `{name}`")
    state = result.state
    if source.kind == "network":
        body = _network(source, state, name)
    elif source.kind == "surface":
        body = _surface(source, state, name)
    else:
        body = _curves(source, state, result, name)
    # A file's name is no statement, whatever is in it.
    title = " ".join("".join(c if c.isprintable() else " " for c in source.name).split())
    return f"# {title}, faired\n" + "".join(f"{_wrapped(s)}\n" for s in body)


def _number(x: float) -> str:
    return repr(float(x) + 0.0).removesuffix(".0")


def _place(p: Sequence[float]) -> str:
    return "{" + ", ".join(_number(c) for c in p) + "}"


def _value(value: Any) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    return _number(value) if np.ndim(value) == 0 else _list(map(_number, value))


def _list(items: Iterable[Any]) -> str:
    return "{" + ", ".join(map(str, items)) + "}"


def _wrapped(statement: str) -> str:
    """A statement wrapped between words."""
    out, line = [], ""
    for word in statement.split(" "):
        if line and len(line) + 1 + len(word) > WIDTH:
            out.append(line)
            line = f"  {word}"
        else:
            line = f"{line} {word}" if line else word
    return "\n".join([*out, line])


def _called(name: str, line: str, taken: set[str]) -> str:
    """The name of a line's object: that of the whole and of the line."""
    own = re.sub(r"\W+", "_", line.replace("-", "m")).strip("_").lower()
    made = base = f"{name}_{own}" if own else name
    number = 2
    while made in taken:
        made, number = f"{base}_{number}", number + 1
    taken.add(made)
    return made


def _limits(tolerances: Sequence[float], usual: float) -> tuple[str, list[str]]:
    """The tolerance of an object, and its option where points have their own."""
    if len(set(tolerances)) == 1:
        return _number(tolerances[0]), []
    return _number(usual), [f"tolerances = {_list(map(_number, tolerances))}"]


def _direction(source: DeskSource) -> list[str]:
    return [] if isinstance(source.motion, str) else [f"along = {_place(source.motion)}"]


def _goal(state: DeskState) -> list[str]:
    return [] if state.goal == "near" else [f'goal = "{state.goal}"']


def _curves(source: DeskSource, state: DeskState, result: DeskResult, name: str) -> list[str]:
    out = []
    taken: set[str] = set()
    alone = len(state.lines) == 1
    for k, line in enumerate(state.lines):
        called = name if alone else _called(name, line.name, taken)
        asked = task(source, state, k)
        if asked.span is not None and not source.control:
            out.append(_as_it_is(called, result.curves[k].after))
            continue
        points = [
            source.objects[p]
            if source.objects and source.objects[p] and asked.points[i] == source.points[p]
            else _place(asked.points[i])
            for i, p in enumerate(line.points)
        ]
        limit, more = _limits(asked.tolerances, state.tolerance)
        options = [*more, *_direction(source)]
        if asked.goal != "near":
            options.append(f'goal = "{asked.goal}"')
        for word, numbers in (
            ("fixed", asked.fixed),
            ("breaks", asked.breaks),
            ("release", asked.released),
        ):
            if numbers:
                options.append(f"{word} = {_list(i + 1 for i in numbers)}")
        if asked.shape:
            quoted = ", ".join(f'"{s}"' for s in asked.shape)
            options.append(f"shape = {{{quoted}}}")
        if asked.closed:
            options.append("closed = 1")
        options += [f"{word} = {_value(value)}" for word, value in source.options]
        out.append(f"FairCurve {called}({', '.join([_list(points), limit, *options])});")
    return out


def _as_it_is(name: str, spline: Spline) -> str:
    """A spline of these control points and knots, since no other statement has ranges."""
    knots, control, _ = spline.open_form()
    rows = ", ".join(_place(p) for p in control)
    return (
        f'FairCurve {name}({{{rows}}}, 0, as = "control", '
        f"knots = {_list(_number(x) for x in knots)});"
    )


def _network(source: DeskSource, state: DeskState, name: str) -> list[str]:
    points = list(state.points)
    for k, at in state.held.items():
        points[k] = at
    names = []
    out = []
    for k, at in enumerate(points):
        own = k < len(source.objects) and at == source.points[k]
        names.append(source.objects[k] if own else f"{name}_{k + 1}")
        if not own:
            out.append(f"AbsPoint {names[-1]}({', '.join(map(_number, at))});")
    if state.span is not None:
        raise FairingError("a range cannot be a statement of a network: end it, or lock its line")
    lists = [
        _list(names[p] for p in (line.points + line.points[:1] if line.closed else line.points))
        for line in state.lines
    ]
    closed = [line.closed for line in state.lines]
    own_corners = corners([line.points for line in state.lines], closed, len(points))
    still = sorted(set(state.fixed) | set(state.held))
    limits = [state.limit(k) for k in range(len(points))]
    options = ['measure = "third"', *_goal(state), *_direction(source)]
    if still:
        options += [f"fixed = {_list(names[k] for k in sorted({*still, *own_corners}))}"]
    if state.knuckles:
        options.append(f"breaks = {_list(names[k] for k in sorted(state.knuckles))}")
    other = [k for k, x in enumerate(limits) if x != state.tolerance]
    if other:
        options.append(f"tolerances = {_list(_number(limits[k]) for k in other)}")
        options.append(f"tolerances_at = {_list(names[k] for k in other)}")
    out.append(f"FairNet {name}({', '.join([_list(lists), _number(state.tolerance), *options])});")
    taken = {name, *names}
    for k, line in enumerate(state.lines):
        out.append(f"NetCurve {_called(name, line.name, taken)}({name}, {k + 1});")
    return out


def _surface(source: DeskSource, state: DeskState, name: str) -> list[str]:
    if state.span is not None or state.held:
        raise FairingError("ranges and locks cannot be statements of a surface: end them")
    m, n = source.grid
    grid = np.array(state.points).reshape(m, n, 3)
    out = [f"surface {name}_points[{m}, {n}];"]
    for i, row in enumerate(grid.tolist()):
        out.append(f"{name}_points[{i + 1},] = {_list(map(_place, row))};")
    limits = np.array([state.limit(k) for k in range(m * n)])
    options = [*_goal(state), *_direction(source)]
    if state.fixed:
        options.append(f"fixed = {_list(k + 1 for k in sorted(state.fixed))}")
    rows = [i for i in range(m) if all(i * n + j in state.knuckles for j in range(n))]
    columns = [j for j in range(n) if all(i * n + j in state.knuckles for i in range(m))]
    for word, numbers in (("breaks_u", rows), ("breaks_v", columns)):
        if numbers:
            options.append(f"{word} = {_list(k + 1 for k in numbers)}")
    if (limits != state.tolerance).any():
        rows_of = [_list(map(_number, row)) for row in limits.reshape(m, n).tolist()]
        options.append(f"tolerances = {_list(rows_of)}")
    start = [f"{name}_points", _number(state.tolerance), 'measure = "variation"', *options]
    out.append(f"FairSurf {name}({', '.join(start)});")
    return out
