"""Every face of a function or kind has the arguments of its row: names, order, defaults.

`tools/renames.py` changes rows and runs this file.
"""

from __future__ import annotations

import ast
import inspect
import json
from typing import Any

import pytest

import moldloft
from moldloft import _core, functions, implicit, kinds, language
from moldloft.cli.doc import _page
from moldloft.implicit import rows as solids
from moldloft.implicit.rows import line_names
from moldloft.language import python_name
from moldloft.workbench.frames import head_of

ROWS: dict[str, dict[str, Any]] = {row["name"]: row for row in _core.reference()}
#: Rows whose arguments have classes; those of the interpreter are evaluated by their bodies.
TYPED = {name: row for name, row in ROWS.items() if not row["in_run"]}

Argument = tuple[str, bool, object]


def wanted(row: dict[str, Any]) -> list[Argument]:
    """Name, whether it is required, default."""
    return [
        (python_name(field["name"]), field["required"], field["default"]) for field in row["fields"]
    ]


def of_signature(signature: inspect.Signature) -> list[Argument]:
    """The arguments of a function, as those of a row."""
    found = []
    for p in signature.parameters.values():
        required = p.default is p.empty
        found.append((p.name, required, None if required else p.default))
    return found


def test_python_s_kinds_and_functions() -> None:
    shared = {field["name"]: field["default"] for field in language.attributes()}
    for name, row in TYPED.items():
        thing = getattr(kinds if row["is_kind"] else functions, name)
        found = {each[0]: each for each in of_signature(inspect.signature(thing))}
        if not row["fields"] and not row["is_kind"]:
            continue
        for argument in wanted(row):
            assert found.pop(argument[0]) == argument, name
        if row["is_kind"]:
            assert found.pop("name")[1]
        assert {each: default for each, _, default in found.values()}.items() <= shared.items()


def test_stubs() -> None:
    from moldloft import stubs

    for module, text in (("kinds", stubs.kinds_stub()), ("functions", stubs.functions_stub())):
        tree = ast.parse(text)
        for made in (node for node in tree.body if isinstance(node, ast.FunctionDef)):
            row = TYPED.get(made.name)
            if row is None:
                continue
            arguments = made.args
            left_out = len(arguments.args) - len(arguments.defaults)
            found = {a.arg: k < left_out for k, a in enumerate(arguments.args)}
            by_name = zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
            found |= {a.arg: default is None for a, default in by_name}
            if arguments.vararg:
                found[arguments.vararg.arg] = True
            for name, required, _ in wanted(row):
                assert found[name] is required, f"{module}.{made.name}"
    text = stubs.solids_stub()
    names = {node.name for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)}
    assert names == set(solids.__all__) <= set(implicit.__all__)


def test_a_line_beside_a_point_has_names_of_its_own() -> None:
    fields = [
        {"name": name, "class": class_} for name, class_ in (("axis", "line"), ("at", "point"))
    ]
    assert line_names({"fields": fields}, "axis") == ("point", "direction")
    fields[1]["name"] = "point"
    assert line_names({"fields": fields}, "axis") == ("axis_point", "axis_direction")


@pytest.mark.parametrize("name", solids.__all__)
def test_implicit_solids(name: str) -> None:
    arguments = []
    for field, argument in zip(ROWS[name]["fields"], wanted(ROWS[name]), strict=True):
        if field["class"] == "line":
            # A line of a model is a point and a direction.
            arguments += [(each, True, None) for each in line_names(ROWS[name], field["name"])]
        else:
            arguments.append(argument)
    assert of_signature(inspect.signature(getattr(implicit, name))) == arguments


def test_other_functions_of_implicit_solids() -> None:
    """Those written by hand: functions of fields have the names of the language's functions."""
    hand = {n for n in implicit.__all__ if inspect.isfunction(getattr(implicit, n))}
    for name in (hand & set(ROWS)) - set(solids.__all__):
        found = [each[0] for each in of_signature(inspect.signature(getattr(implicit, name)))]
        assert found == [each[0] for each in wanted(ROWS[name])], name


#: Methods of sets, and the rows of the same operations.
METHODS = {
    "bounds": "bounds",
    "chamfered": "set_chamfer",
    "offset": "set_offset",
    "range": "range",
    "regularized": "regularized",
    "remapped": "remapped",
    "rounded": "set_round",
    "scaled": "scaled",
    "shell": "set_shell",
    "thin": "thin",
    "translated": "translated",
}


@pytest.mark.parametrize("method", METHODS)
def test_methods_of_sets(method: str) -> None:
    """The arguments of a row after the set itself."""
    found = of_signature(inspect.signature(getattr(implicit.Set, method)))[1:]
    for each, (name, required, default) in zip(
        found, wanted(ROWS[METHODS[method]])[1:], strict=True
    ):
        assert each[:2] == (name, required)
        assert default is None or each[2] == default


def test_the_command_and_the_reference() -> None:
    for name, row in ROWS.items():
        page = _page(row)
        for field in row["fields"]:
            assert f"  {field['name']}" in page, name
            if isinstance(field["default"], float):
                assert f"{field['default']:g}" in page, (name, field["name"])


def test_the_page_s_forms() -> None:
    session = _core.Session("x.sdl", "", None, [])
    session.answer(json.dumps({"kind": "open"}))
    frame = head_of(session.answer(json.dumps({"kind": "kinds"})))["kinds"]
    forms = {row["name"]: row for row in frame}
    for name, row in ROWS.items():
        if row["is_kind"]:
            found = [(f["name"], f["required"], f["default"]) for f in forms[name]["fields"]]
            assert found == [(f["name"], f["required"], f["default"]) for f in row["fields"]]


def test_the_language() -> None:
    """A named argument of each row is known, another one is not."""
    for name, row in ROWS.items():
        if name == "curvature":
            # Without its curve it may be that of the points of an array, `curvatures`.
            continue
        head = f"{name} x(" if row["is_kind"] else f"print {name}("
        for field in row["fields"]:
            assert "unknown-argument" not in ids(f"{head}{field['name']} = 0);"), (
                name,
                field["name"],
            )
        if row["fields"]:
            assert "unknown-argument" in ids(f"{head}no_such_argument = 0);"), name


def ids(text: str) -> set[str]:
    """The ids of the diagnostics of a program."""
    document = _core.Document.from_text("x.sdl", text, None, [])
    return {d.id for d in document.diagnostics()}


def test_completion() -> None:
    model = moldloft.loads("")
    for name, row in TYPED.items():
        if row["is_kind"] and row["fields"]:
            words = model._document.complete(f"{name} x(")
            assert {field["name"] for field in row["fields"]} <= {w.split(" ")[0] for w in words}
