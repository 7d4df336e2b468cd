"""Functions of implicit solids have the arguments of their rows, in Python as in a model."""

import inspect
import keyword

import pytest

from moldloft import _core
from moldloft import implicit as im

ROWS = {row["name"]: row for row in _core.reference()}

# A line of a model is a point and a direction in Python.
AXES = {"cone": "apex", "cylinder": "point", "torus": "point", "cyclide": "centre"}
# A plane of a model is a field in Python, and functions of numbers take fields.
PLAIN = {name for name in im.__all__ if inspect.isfunction(getattr(im, name))}


def fields(name: str) -> list[str]:
    """The arguments of a row, as Python can write them."""
    names = [field["name"] for field in ROWS[name]["fields"] or []]
    return [name + "_" if keyword.iskeyword(name) else name for name in names]


@pytest.mark.parametrize("name", sorted(PLAIN & set(ROWS) - set(AXES)))
def test_a_function_has_the_arguments_of_its_row(name: str) -> None:
    assert list(inspect.signature(getattr(im, name)).parameters) == fields(name)
