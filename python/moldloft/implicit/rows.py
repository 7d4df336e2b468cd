"""Functions of fields and sets, made from the rows of the language.

Names, arguments, defaults, ranges and documentation are those of the rows. A line of a model is a
point and a direction here. Functions of one set, and those called ``set_...``, are operators and
methods of :class:`Set`.
"""

from __future__ import annotations

import inspect
import operator
from collections.abc import Callable
from typing import Any

from moldloft import _core
from moldloft.arguments import explain
from moldloft.implicit.fields import Field, required
from moldloft.implicit.moving import triple
from moldloft.implicit.sets import Set
from moldloft.language import docstring, meaning, python_name, reference

#: Annotation of an argument, by its class.
_TYPES = {
    "field": "Field | float",
    "set": "Set | Field",
    "number": "float",
    "integer": "int",
    "text": "str",
    "point": "Triple",
    "vector": "Triple",
}


def _is_function(row: dict[str, Any]) -> bool:
    fields = row["fields"]
    classes = [field["class"] for field in fields]
    if row["is_kind"] or row["class"] not in ("field", "set") or row["name"].startswith("set_"):
        return False
    if classes.count("set") == 1 and not any(field["many"] for field in fields):
        return False
    return all(class_ in _TYPES or class_ == "line" for class_ in classes)


def line_names(row: dict[str, Any], name: str) -> tuple[str, str]:
    """The names of a line's point and direction, prefixed by the name of the line if ambiguous."""
    names = [field["name"] for field in row["fields"]]
    lines = [field for field in row["fields"] if field["class"] == "line"]
    if len(lines) > 1 or {"point", "direction"} & set(names):
        return f"{name}_point", f"{name}_direction"
    return "point", "direction"


def _parameters(row: dict[str, Any], field: dict[str, Any]) -> list[tuple[inspect.Parameter, str]]:
    """The parameters of an argument with their meanings."""
    parameter = inspect.Parameter
    kind = parameter.POSITIONAL_OR_KEYWORD
    if field["class"] == "line":
        point, direction = (
            parameter(name, kind, annotation="Triple") for name in line_names(row, field["name"])
        )
        return [
            (point, f"Start, ``(3,)``. {meaning(field)}"),
            (direction, "Direction of the line, of any length, ``(3,)``."),
        ]
    name, annotation = python_name(field["name"]), _TYPES[field["class"]]
    if field["many"]:
        return [(parameter(name, parameter.VAR_POSITIONAL, annotation=annotation), meaning(field))]
    default = parameter.empty
    if not field["required"]:
        default = field["default"]
        if default is None:
            annotation += " | None"
        elif field["class"] == "integer":
            default = int(default)
    return [(parameter(name, kind, default=default, annotation=annotation), meaning(field))]


def _core_of(shape: object) -> _core.Field | _core.Set:
    return shape._core if isinstance(shape, Set) else required(shape)._core


def _value(class_: str, name: str, given: Any) -> Any:
    """An argument as the row takes it."""
    if given is None:
        return None
    if class_ == "set":
        return _core_of(given)
    if class_ == "field":
        return required(given)._core
    if class_ == "number":
        return float(given)
    if class_ == "integer":
        return float(operator.index(given))
    return str(given) if class_ == "text" else triple(given, name)


def _function(row: dict[str, Any]) -> Callable[..., Field | Set]:
    fields, of = row["fields"], {"field": Field, "set": Set}[row["class"]]
    described = [pair for field in fields for pair in _parameters(row, field)]
    signature = inspect.Signature([p for p, _ in described], return_annotation=of.__name__)

    def call(*arguments: Any, **named: Any) -> Any:
        bound = signature.bind(*arguments, **named)
        bound.apply_defaults()
        given, values = iter(bound.arguments.items()), []
        for field in fields:
            name, value = next(given)
            if field["class"] == "line":
                other, direction = next(given)
                values.append((triple(value, name), triple(direction, other)))
            elif field["many"]:
                values.append([_value(field["class"], name, item) for item in value])
            else:
                values.append(_value(field["class"], name, value))
        return of(_core.call_row(row["name"], values))

    call.__name__ = call.__qualname__ = row["name"]
    call.__signature__ = signature  # type: ignore[attr-defined]
    heads = [(str(p).split(":")[0].split("=")[0], text) for p, text in described]
    call.__doc__ = docstring(row, heads, of.__name__)
    return call


_FUNCTIONS = {row["name"]: _function(row) for row in reference() if _is_function(row)}
globals().update(_FUNCTIONS)
__all__ = sorted(_FUNCTIONS)

explain(globals())
