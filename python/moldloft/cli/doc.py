"""``moldloft doc``: the reference in the terminal, as data, or as a page."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from textwrap import fill, wrap
from typing import Any

from moldloft.cli.console import print_json
from moldloft.cli.reference_page import example_lines, signature, synonyms
from moldloft.errors import UnknownNameError
from moldloft.library import picture, pictured, routines
from moldloft.spelling import nearest
from moldloft.text_table import table, terminal_width

__all__ = ["add", "pictures", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    parser.add_argument(
        "name",
        metavar="NAME",
        nargs="?",
        help="a kind, a function, an argument of all kinds, the id of a diagnostic, "
        "or words to search for",
    )
    parser.add_argument(
        "--list", action="store_true", help="list all of them, with class and fields"
    )
    parser.add_argument("--json", action="store_true", help="the same as data")
    parser.add_argument(
        "--pictures", metavar="DIR", help="a PNG of the example of each kind, or of NAME"
    )


def run(options: argparse.Namespace) -> int:
    """Prints the reference."""
    from moldloft.explanations import EXPLANATIONS
    from moldloft.language import SITE, attributes, guides, reference, search, statements

    rows = reference()
    libraries = routines()
    if options.pictures and options.name is None:
        _draw([*rows, *libraries], options.pictures)
        return 0
    rows = [*rows, *libraries]
    if options.name is None:
        if options.json:
            print_json(rows)
        else:
            print(_list(rows))
        return 0
    statement = next((row for row in statements() if row["name"] == options.name), None)
    if statement and not options.pictures:
        if options.json:
            print_json({**statement, "statement": True})
        else:
            print(_statement_page(statement))
        return 0
    if options.name in EXPLANATIONS and not options.pictures:
        text = EXPLANATIONS[options.name]
        if options.json:
            print_json({"name": options.name, "diagnostic": True, "doc": text})
        else:
            page = f"{SITE}/diagnostics/{options.name}.html"
            print(f"{options.name}: a diagnostic\n\n{fill(text, _columns())}\n\nExample: {page}")
        return 0
    shared = next((field for field in attributes() if field["name"] == options.name), None)
    if shared and not options.pictures:
        if options.json:
            print_json(shared)
        else:
            print(f"{shared['name']} = {shared['class']}\n\n{shared['help']}\n")
            print("An argument of every kind, by name:\n")
            print(f"  BCurve c({{A, B, C}}, degree = 2, {_ATTRIBUTES[shared['name']]});")
            _print_guides(guides(options.name))
        return 0
    row = next((row for row in rows if row["name"] == options.name), None)
    known = [*(row["name"] for row in rows), *(row["name"] for row in statements())]
    near = nearest(options.name, known)
    # A misspelt name is an error; a word that names nothing is searched for.
    misspelt = near is not None and options.name[:1].isupper()
    other = row is not None or misspelt or bool(options.pictures)
    found = [] if other else search(options.name)
    pages = [] if other else guides(options.name)
    if found or pages:
        if options.json:
            print_json(found)
        else:
            print(f"no entry named `{options.name}`" + ("; related entries:" if found else ""))
            if found:
                print("\n" + _list(found[:_MOST_FOUND], summary=True))
            _print_guides(pages)
        return 0
    if row is None:
        hint = f"; did you mean `{near}`?" if near else "; see `moldloft doc --list`"
        raise UnknownNameError(f"unknown kind or function `{options.name}`{hint}")
    if options.pictures:
        _draw([row], options.pictures)
    elif options.json:
        print_json(row)
    else:
        print(_page(row))
    return 0


def _print_guides(pages: list[tuple[str, str]]) -> None:
    if pages:
        print("\nPages of the documentation:")
        for about, address in pages[:4]:
            print(f"  {address}  {about}")


#: How each argument of all kinds is written.
_ATTRIBUTES = {
    "colour": "colour = 14",
    "visible": "visible = 0",
    "layer": "layer = 2",
    "divisions": "divisions = 20",
    "subdivisions": "subdivisions = 4",
    "size": "size = 0.25",
    "spacing": 'spacing = "cosine"',
    "tags": 'tags = {"wetted", "fine"}',
    "orientation": "orientation = 1",
    "attributes": 'attributes = "..."',
}


def _statement_page(row: dict[str, Any]) -> str:
    width = max(len(name) for name, _ in row["arguments"]) + 2
    arguments = [
        line for name, text in row["arguments"] for line in _beside(f"  {name:<{width}}", text)
    ]
    example = [f"  {line}" for line in row["example"].splitlines()]
    return "\n".join([row["signature"], "", row["doc"], "", *arguments, "", "Example:", *example])


#: What shows in a picture. Laws, numbers and the model itself have no shape.
_SHAPES = {
    "bead", "contours", "curve", "frame", "magnet", "mesh", "plane", "point", "ring", "snake",
    "solid", "surface",
}  # fmt: skip


def _has_picture(row: dict[str, Any]) -> bool:
    if "library" in row:
        return pictured(row) is not None
    return bool(row["is_kind"] and row["example"] and row["class"] in _SHAPES)


def pictures(rows: list[dict[str, Any]]) -> Iterator[tuple[str, bytes]]:
    """The names of entries whose examples have a shape, each with its picture as PNG.

    Parameters
    ----------
    rows
        The entries.
    """
    import moldloft

    for row in filter(_has_picture, rows):
        if "library" in row:
            yield row["name"], picture(row) or b""
            continue
        model = moldloft.loads(row["example"], name=f"{row['name']}.sdl")
        yield row["name"], model.kind_picture(row["name"], 360, 240)


def _draw(rows: list[dict[str, Any]], folder: str) -> None:
    from pathlib import Path

    from moldloft.exchange.files import Output, commit

    outputs = [Output(f"{name}.png", image) for name, image in pictures(rows)]
    commit(Path(folder), outputs)
    print(f"{len(outputs)} pictures in {folder}")


#: The most rows of a search.
_MOST_FOUND = 15


def _list(rows: list[dict[str, Any]], *, summary: bool = False) -> str:
    if summary:
        cells = [[row["name"], row["class"], _first_line(row["summary"])] for row in rows]
        return table(["name", "class", "what"], cells, left=3, width=terminal_width())
    return table(
        ["name", "class", "arguments"],
        [[row["name"], row["class"], ", ".join(f["name"] for f in row["fields"])] for row in rows],
        left=3,
        width=terminal_width(),
    )


def _first_line(text: str) -> str:
    line = " ".join(str(text).split())
    return line if len(line) <= 76 else line[:75].rsplit(" ", 1)[0] + " …"


def _columns() -> int:
    return min(terminal_width() or 96, 96)


def _beside(head: str, text: str) -> list[str]:
    """A head with a text beside it, which is wrapped in a terminal."""
    width = terminal_width()
    if width is None:
        return [head + text]
    lines = wrap(text, max(width - len(head), 20)) or [""]
    return [head + lines[0], *(" " * len(head) + line for line in lines[1:])]


def _page(row: dict[str, Any]) -> str:
    lines = [signature(row), "", str(row["doc"]).partition("\n\nCalled as ")[0], ""]
    if "library" in row:
        lines[2] = fill(lines[2], _columns())
        lines[3:] = ["", f'A routine of a library: load "{row["library"]}";', ""]
    rows = [
        [f"  {f['name']}", f"{f['class']}{' list' if f['many'] else ''}"] for f in row["fields"]
    ]
    width = max((len(cell) for cells in rows for cell in cells), default=0) + 2
    for cells, field in zip(rows, row["fields"], strict=True):
        head = "".join(cell.ljust(width) for cell in cells)
        lines += _beside(head, str(field["help"]))
    words = synonyms(row)
    if words:
        lines += ["", f"Also found as: {', '.join(words)}."]
    if row["example"]:
        lines += ["", "Example:", *(f"  {line}" for line in example_lines(row["example"]))]
    return "\n".join(line.rstrip() for line in lines)
