"""Public functions and methods say what they take and what they return."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any

import pytest

import moldloft

#: Protocol of pickles, copies, containers and notebooks; documented by Python.
_NOTHING = ("None", "<class 'inspect._empty'>")


def public() -> Iterator[tuple[str, Any]]:
    seen = set()
    for name in moldloft.__all__:
        value = getattr(moldloft, name)
        if inspect.isclass(value):
            if issubclass(value, BaseException) or value.__module__ == "builtins":
                continue
            for owner in value.__mro__:
                if (
                    not owner.__module__.startswith("moldloft.")
                    or owner.__module__ == "moldloft._core"
                ):
                    continue
                for own, member in vars(owner).items():
                    function = getattr(member, "__func__", member)
                    if own.startswith("_") or not inspect.isfunction(function):
                        continue
                    if function not in seen:
                        seen.add(function)
                        yield f"{owner.__qualname__}.{own}", function
        elif inspect.isfunction(value):
            yield name, value


@pytest.mark.parametrize(("name", "function"), list(public()))
def test_arguments_and_results_are_documented(name: str, function: Any) -> None:
    text = inspect.getdoc(function) or ""
    signature = inspect.signature(function)
    arguments = [each for each in signature.parameters if each not in ("self", "cls")]
    assert not arguments or "Parameters\n---" in text, "no section Parameters"
    for each in arguments:
        assert each in text.partition("Parameters\n")[2], f"`{each}` is not described"
    if str(signature.return_annotation) not in _NOTHING:
        assert "Returns\n---" in text or "Yields\n---" in text, "no section Returns"
    first = text.split("\n")[0]
    assert first.endswith(".") and len(first) > 10, first


def test_there_are_enough_of_them() -> None:
    """Lest the search above finds nothing."""
    assert len(list(public())) > 110
