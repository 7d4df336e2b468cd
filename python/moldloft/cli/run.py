"""``moldloft run``: a program that prints and writes its own files."""

from __future__ import annotations

import argparse
from pathlib import Path

from moldloft.cli.console import (
    add_force,
    add_model,
    add_name,
    open_model,
    print_json,
    report,
    stem_of,
)
from moldloft.errors import Error
from moldloft.models import Model
from moldloft.permissions import write_outputs

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    from moldloft.formats import formats

    grids = [row.name for row in formats().values() if row.of_grids]
    add_model(parser)
    parser.add_argument(
        "-o",
        "--output",
        metavar="DIR",
        default=".",
        help="folder for the files that the program writes; default: the current one",
    )
    parser.add_argument(
        "--to",
        metavar="FORMAT",
        nargs="+",
        action="extend",
        choices=grids,
        default=[],
        help="the surfaces of the program as structured grids: " + ", ".join(grids),
    )
    add_name(parser)
    add_force(parser)
    parser.add_argument("--json", action="store_true", help="one object: lines printed, files")


def run(options: argparse.Namespace) -> int:
    """Runs the program; its files are written if it has no errors."""
    model = open_model(options)
    failed = model.has_errors
    report(model.diagnostics)
    if not options.json:
        # In one piece: a line at a time takes as long as the run where nothing is buffered.
        print("".join(f"{line}\n" for line in model.printed), end="")
    files = {} if failed else model.written
    if options.to and not failed:
        files |= _grids(model, stem_of(options), options.to)
    written = write_outputs(
        Path(options.output), files, sources=[options.model, *model.sources], force=options.force
    )
    if options.json:
        sizes = [{"path": str(path), "bytes": path.stat().st_size} for path in written]
        diagnostics = [d.to_dict() for d in model.diagnostics]
        data = {"ok": not failed, "printed": model.printed, "files": sizes}
        print_json(data | {"diagnostics": diagnostics})
    elif failed and model.written_names:
        print(f"{options.model}: errors; nothing was written")
    else:
        for path in written:
            print(f"wrote {path} ({path.stat().st_size} bytes)")
    return 1 if failed else 0


def _grids(model: Model, stem: str, formats: list[str]) -> dict[str, bytes]:
    """The surfaces among the variables as files, in the order of their declaration."""
    from moldloft import grids

    surfaces = [name for name, type_ in model.types.items() if type_.startswith("surface[")]
    if not surfaces:
        raise Error("the program has no surface to write")
    values = model.variables
    found = [values[name] for name in surfaces]
    files: dict[str, bytes] = {}
    for name in dict.fromkeys(formats):
        files |= grids.encoded(f"{stem}.{name}", found, surfaces)
    return files
