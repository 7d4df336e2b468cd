"""Functions of the language, for models that are written in Python.

>>> from moldloft import functions as f
>>> f.sphere([0, 0, 0], 2) - 1
FieldShape('sphere({0, 0, 0}, 2) - 1')

The names are those of the language; ``moldloft doc --list`` lists them. Kinds of objects are in
:mod:`moldloft.kinds`.
"""

from __future__ import annotations

from moldloft.builder import Function


def __getattr__(name: str) -> Function:
    if name.startswith("_"):
        raise AttributeError(name)
    from moldloft import _core

    rows = {row["name"] for row in _core.reference() if not row["is_kind"]}
    if name not in rows:
        from moldloft.spelling import nearest

        near = nearest(name, sorted(rows))
        hint = f"; did you mean `{near}`?" if near else ""
        raise AttributeError(f"the language has no function `{name}`{hint}")
    return Function(name)
