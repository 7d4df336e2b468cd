"""The types of kinds and functions, written from the registry.

``python -m moldloft.stubs`` writes ``kinds.pyi``, ``functions.pyi`` and ``implicit/rows.pyi``
beside this file (``make stubs`` runs it). They give type checkers the arguments of each kind
and function, and editors its documentation.
"""

from __future__ import annotations

import inspect
import keyword
import textwrap
from pathlib import Path
from typing import Any

from moldloft.language import attributes, page, python_name, reference

__all__ = ["functions_stub", "kinds_stub", "solids_stub"]

_HEAD = '''# Made by `make stubs` from the declarations in `crates/`; not edited by hand.
"""{title}"""

from collections.abc import Sequence
from typing import Any, TypeAlias

from numpy.typing import NDArray

from moldloft.expressions import (
    AnyHandle,
    AnyShape,
    BeadHandle,
    BodyHandle,
    ContoursHandle,
    CurveHandle,
    Expr,
    FieldShape,
    FrameHandle,
    MagnetHandle,
    PlaneHandle,
    PointHandle,
    RelabelHandle,
    RingHandle,
    SetShape,
    SnakeHandle,
    SolidHandle,
    SurfaceHandle,
)

_Any: TypeAlias = AnyHandle | AnyShape
_Number: TypeAlias = float | Expr | _Any
_Integer: TypeAlias = int | Expr | _Any
_Text: TypeAlias = str | _Any
_Array: TypeAlias = NDArray[Any]
_Vector: TypeAlias = PointHandle | Sequence[float | Expr] | _Array | _Any
_Numbers: TypeAlias = Sequence[float | Expr] | _Array | _Any
_Item: TypeAlias = PointHandle | Sequence[float | Expr] | _Array
_Vectors: TypeAlias = Sequence[_Item | Sequence[_Item]] | _Array | _Any
_Point: TypeAlias = _Vector
_Bead: TypeAlias = BeadHandle | _Any
_Magnet: TypeAlias = MagnetHandle | _Any
_Ring: TypeAlias = RingHandle | _Any
_Curve: TypeAlias = CurveHandle | _Any
_Snake: TypeAlias = SnakeHandle | _Any
_Surface: TypeAlias = SurfaceHandle | _Any
_Solid: TypeAlias = SolidHandle | _Any
_Plane: TypeAlias = PlaneHandle | str | _Any
_Mirror: TypeAlias = _Plane | _Point | CurveHandle
_Side: TypeAlias = SnakeHandle | MagnetHandle | _Any
_Along: TypeAlias = CurveHandle | BeadHandle | _Any
_AlongSnake: TypeAlias = SnakeHandle | RingHandle | _Any
_Onto: TypeAlias = SurfaceHandle | MagnetHandle | _Any
_Target: TypeAlias = _Plane | SurfaceHandle | CurveHandle | _Point | FieldShape
_Frame: TypeAlias = FrameHandle | _Point
_Contours: TypeAlias = ContoursHandle | _Any
_Relabel: TypeAlias = RelabelHandle | _Any
_Field: TypeAlias = FieldShape | PlaneHandle | float | Expr | _Any
_Set: TypeAlias = SetShape | FieldShape | PlaneHandle | _Any
_Body: TypeAlias = BodyHandle | _Any
'''

#: What each class of the registry accepts; `Class::accepts` of the crate `registry` is the law.
_ARGUMENTS = {
    "value": "object",
    "number": "_Number",
    "integer": "_Integer",
    "text": "_Text",
    "vector": "_Vector",
    "farray": "_Numbers",
    "curve or surface": "_Vectors",
    "point": "_Point",
    "bead": "_Bead",
    "magnet": "_Magnet",
    "ring": "_Ring",
    "curve": "_Curve",
    "line": "_Curve",
    "snake": "_Snake",
    "surface": "_Surface",
    "solid": "_Solid",
    "plane": "_Plane",
    "mirror": "_Mirror",
    "side": "_Side",
    "curve or bead": "_Along",
    "snake or ring": "_AlongSnake",
    "surface or magnet": "_Onto",
    "target": "_Target",
    "frame": "_Frame",
    "contours": "_Contours",
    "relabel": "_Relabel",
    "field": "_Field",
    "set": "_Set",
    "mesh": "_Body",
    "list": "Sequence[object] | _Any",
    "block": "_Array | Sequence[object] | _Any",
    "record": "_Any",
}

#: What an argument of several accepts, where that is more than a sequence of single ones.
_LISTS = {
    "number": "_Numbers",
    "integer": "Sequence[_Integer] | _Array | _Any",
    "point": "_Vectors",
    "vector": "_Vectors",
    "value": "Sequence[object] | _Array | _Any",
}

_RESULTS = {
    "number": "Expr",
    "integer": "Expr",
    "vector": "PointHandle",
    "point": "PointHandle",
    "bead": "BeadHandle",
    "magnet": "MagnetHandle",
    "ring": "RingHandle",
    "curve": "CurveHandle",
    "snake": "SnakeHandle",
    "surface": "SurfaceHandle",
    "solid": "SolidHandle",
    "mesh": "BodyHandle",
    "plane": "PlaneHandle",
    "frame": "FrameHandle",
    "contours": "ContoursHandle",
    "relabel": "RelabelHandle",
    "field": "FieldShape",
    "set": "SetShape",
}

#: Attributes that take one number, or one for each parameter.
_PER_PARAMETER = {
    "divisions": "_Integer | str | Sequence[_Integer | str] | _Array",
    "subdivisions": "_Integer | Sequence[_Integer]",
    "size": "_Number | Sequence[_Number]",
    "spacing": "str | _Number | Sequence[str | _Number]",
    "tags": "str | Sequence[str]",
}


def _type(field: dict[str, Any]) -> str:
    class_ = field["class"]
    if not field["many"]:
        return _ARGUMENTS[class_]
    return _LISTS.get(class_) or f"Sequence[{_ARGUMENTS[class_]}] | _Any"


def _parameters(row: dict[str, Any]) -> list[str]:
    """The arguments as in a signature; those with invalid Python names are positional only."""
    fields = row["fields"]
    if row["in_run"]:
        # Some take any number of arguments, or words before them.
        optional = [f["name"] for f in fields if not f["required"] and not f["variadic"]]
        return ["*args: object", *(f"{python_name(name)}: object = ..." for name in optional)]
    lines: list[str] = []
    by_name: list[str] = []
    if row["is_kind"]:
        lines += ["name: str", "/"]
    left_out = starred = False
    for field in fields:
        name, type_ = python_name(field["name"]), _type(field)
        if field["variadic"]:
            item = _ARGUMENTS[field["class"]]
            lines.append(f"*{name}: {item} | {type_}" if item != "object" else f"*{name}: object")
            starred = True
            continue
        if field["required"]:
            (by_name if left_out else lines).append(f"{name}: {type_}")
        else:
            left_out = True
            lines.append(f"{name}: {type_} | None = ...")
    if row["is_kind"]:
        own = {field["name"] for field in fields}
        for field in attributes():
            if field["name"] not in own:
                type_ = _PER_PARAMETER.get(field["name"]) or _ARGUMENTS[field["class"]]
                by_name.append(f"{field['name']}: {type_} | None = ...")
    if by_name and not starred:
        lines.append("*")
    return lines + by_name


def _function(row: dict[str, Any]) -> str:
    if row["is_kind"]:
        made = _RESULTS.get(row["class"], "AnyHandle")
        made = made if made.endswith("Handle") else "AnyHandle"
    else:
        made = _RESULTS.get(row["class"], "AnyShape")
    parameters = _parameters(row)
    lines = [f"def {row['name']}("]
    lines += [f"    {parameter}," for parameter in parameters]
    lines = [*lines, f") -> {made}:"] if parameters else [f"{lines[0]}) -> {made}:"]
    return "\n".join([*lines, _body(page(row))])


def _body(text: str) -> str:
    doc = text.rstrip().replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
    if doc.endswith('"'):
        doc += " "
    return textwrap.indent(f'"""{doc}\n"""\n...', "    ", lambda line: bool(line.strip()))


def _stub(title: str, rows: list[dict[str, Any]]) -> str:
    named = [row for row in rows if row["name"].isidentifier() and row["name"] != "name"]
    parts = [_HEAD.format(title=title)]
    parts += [_function(row) for row in named if not keyword.iskeyword(row["name"])]
    return "\n".join(parts) + "\n"


def kinds_stub() -> str:
    """The text of ``kinds.pyi``."""
    rows = [row for row in reference() if row["is_kind"]]
    return _stub("The kinds of entities, for models written in Python.", rows)


def functions_stub() -> str:
    """The text of ``functions.pyi``."""
    rows = [row for row in reference() if not row["is_kind"]]
    return _stub("Functions of the language, for models that are written in Python.", rows)


_SOLIDS_HEAD = '''# Made by `make stubs` from the declarations in `crates/`; not edited by hand.
"""Functions of fields and sets, made from the rows of the language."""

from collections.abc import Sequence
from typing import TypeAlias

from moldloft.implicit.fields import Field
from moldloft.implicit.sets import Set

Triple: TypeAlias = Sequence[float]

'''


def solids_stub() -> str:
    """The text of ``implicit/rows.pyi``."""
    from moldloft.implicit import rows

    parts = [f"__all__ = {rows.__all__!r}"]
    for name in rows.__all__:
        function = getattr(rows, name)
        signature = inspect.signature(function)
        lines = [f"def {name}("]
        for parameter in signature.parameters.values():
            star = "*" if parameter.kind is parameter.VAR_POSITIONAL else ""
            left_out = "" if parameter.default is parameter.empty else " = ..."
            lines.append(f"    {star}{parameter.name}: {parameter.annotation}{left_out},")
        end = f") -> {signature.return_annotation}:"
        lines = [*lines, end] if signature.parameters else [lines[0] + end]
        parts.append("\n".join([*lines, _body(function.__doc__)]))
    return _SOLIDS_HEAD + "\n".join(parts) + "\n"


def main() -> None:
    """Writes the files beside this one."""
    folder = Path(__file__).parent
    texts = {
        "kinds": kinds_stub(),
        "functions": functions_stub(),
        "implicit/rows": solids_stub(),
    }
    for name, text in texts.items():
        (folder / f"{name}.pyi").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
