"""``moldloft eval``: the value of expressions in a model's names."""

from __future__ import annotations

import argparse
import sys
import warnings
from typing import Any

from moldloft.cli.colour import painted
from moldloft.cli.console import add_model, open_model, print_json, report
from moldloft.cli.parser import Parser

__all__ = ["add", "as_data", "as_text", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser)
    if isinstance(parser, Parser):
        parser.minus_is_a_value()
    parser.add_argument("expressions", metavar="EXPR", nargs="+", help="such as 'hull(.5,.25)'")
    parser.add_argument("--json", action="store_true", help="one list, vectors as [x, y, z]")


def run(options: argparse.Namespace) -> int:
    """Evaluates and prints."""
    model = open_model(options)
    if model.has_errors:
        report(model.diagnostics)
    values = []
    for expression in options.expressions:
        with warnings.catch_warnings(record=True) as remarks:
            warnings.simplefilter("always")
            values.append(model.eval(expression))
        for remark in remarks:
            print(painted(str(remark.message), sys.stderr), file=sys.stderr)
    if options.json:
        print_json([as_data(value) for value in values])
    else:
        for value in values:
            print(as_text(value))
    return 1 if model.has_errors else 0


def as_data(value: Any) -> Any:
    """The value for JSON; a shape is represented by its class."""
    from numpy import ndarray

    from moldloft.implicit import Field, Set
    from moldloft.language import Shape

    if isinstance(value, ndarray):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [as_data(item) for item in value]
    if isinstance(value, Shape):
        return {"class": value.class_}
    if isinstance(value, (Field, Set)):
        return {"class": type(value).__name__.lower(), "text": repr(value).strip("<>")}
    if isinstance(value, dict):
        # A body: its triangles by number only.
        counts = {"class": "mesh", "triangles": len(value["triangles"])}
        return counts | {k: as_data(value[k]) for k in ("volume", "area", "centroid")}
    return value


def as_text(value: Any) -> str:
    """The value as text, with all digits, and a line for each row of a surface.

    >>> as_text(2.0), as_text([1.0, 2.5]), as_text(1 / 3)
    ('2', '{1, 2.5}', '0.3333333333333333')
    """
    data = as_data(value)
    if isinstance(data, float):
        return repr(data + 0.0).removesuffix(".0")
    if isinstance(data, list):
        rows = data and isinstance(data[0], list) and data[0] and isinstance(data[0][0], list)
        return "{" + (",\n " if rows else ", ").join(as_text(item) for item in data) + "}"
    if isinstance(data, dict) and "triangles" in data:
        return f"a mesh of {data['triangles']} triangles, volume {as_text(data['volume'])}"
    if isinstance(data, dict):
        return str(data.get("text") or f"a {data['class']}")
    return str(data)
