"""Functions of the language that a form of the page makes objects with."""

from __future__ import annotations

from functools import cache
from typing import Any

from moldloft.language import reference

__all__ = ["shape_functions"]

#: The kind that gives a name to what a function of a class returns.
_KINDS = {"set": "Set", "field": "Field"}


@cache
def shape_functions() -> list[dict[str, Any]]:
    """The functions that return sets and fields, with their arguments.

    >>> row = next(row for row in shape_functions() if row["name"] == "cuboid")
    >>> row["made"], [field["name"] for field in row["fields"]]
    ('Set', ['low', 'high'])
    """
    return [
        {
            "name": row["name"],
            "class": row["class"],
            "made": _KINDS[row["class"]],
            "about": row["summary"],
            "also": None,
            "fields": [
                {
                    "name": field["name"],
                    "help": field["help"],
                    "class": field["class"],
                    "many": field["many"],
                    "least": 0,
                    "required": field["required"],
                    "default": field["default"],
                    # The permitted words are quoted in the help, as for kinds.
                    "words": field["help"].split('"')[1::2] if field["class"] == "text" else [],
                }
                for field in row["fields"]
            ],
        }
        for row in reference()
        if not row["is_kind"] and row["class"] in _KINDS
    ]
