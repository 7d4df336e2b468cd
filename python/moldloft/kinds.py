"""The kinds of entities, for models written in Python.

Each kind of the registry is an attribute, made from the registry on first use:

>>> from moldloft import kinds
>>> kinds.AbsPoint
<Kind: AbsPoint>
>>> "CLoftSurf" in dir(kinds)
True
"""

from functools import cache

from moldloft.builder import Kind


@cache
def _names() -> tuple[str, ...]:
    from moldloft import _core

    return tuple(row["name"] for row in _core.reference() if row["is_kind"])


def __getattr__(name: str) -> Kind:
    if name.startswith("_"):
        raise AttributeError(name)
    if name not in _names():
        from moldloft.spelling import nearest

        near = nearest(name, _names())
        hint = f"; did you mean {near}?" if near else ""
        raise AttributeError(f"unknown kind {name}{hint}")
    return Kind(name)


def __dir__() -> list[str]:
    return list(_names())
