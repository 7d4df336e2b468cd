"""``moldloft run``: a program that prints and writes its own files."""

from __future__ import annotations

import argparse
from pathlib import Path

from moldloft.cli.console import add_model, open_model, print_json, report
from moldloft.errors import Error, FileError
from moldloft.models import Model

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
    parser.add_argument("--json", action="store_true", help="one object: lines printed, files")


def run(options: argparse.Namespace) -> int:
    """Runs the program; its files are written when it has no errors."""
    model = open_model(options)
    failed = model.has_errors
    report(model.diagnostics)
    if not options.json:
        for line in model.printed:
            print(line)
    written = [] if failed else _write(Path(options.output), model.written)
    if options.to and not failed:
        written += _grids(model, Path(options.output) / Path(options.model).stem, options.to)
    if options.json:
        files = [{"path": str(path), "bytes": path.stat().st_size} for path in written]
        diagnostics = [d.to_dict() for d in model.diagnostics]
        data = {"ok": not failed, "printed": model.printed, "files": files}
        print_json(data | {"diagnostics": diagnostics})
    elif failed and model.written:
        print(f"{options.model}: errors; nothing was written")
    else:
        for path in written:
            print(f"wrote {path} ({path.stat().st_size} bytes)")
    return 1 if failed else 0


def _grids(model: Model, stem: Path, formats: list[str]) -> list[Path]:
    """Writes the surfaces among the variables, in the order of their declaration."""
    from moldloft import grids

    surfaces = [name for name, type_ in model.types.items() if type_.startswith("surface[")]
    if not surfaces:
        raise Error("the program has no surface to write")
    values = model.variables
    found = [values[name] for name in surfaces]
    stem.parent.mkdir(parents=True, exist_ok=True)
    written: list[Path] = []
    for name in dict.fromkeys(formats):
        written += grids.write(stem.with_suffix(f".{name}"), found, names=surfaces)
    return written


def _write(folder: Path, files: dict[str, bytes]) -> list[Path]:
    from moldloft.files import Output, commit

    # A link inside the folder must not lead out of it.
    root = folder.resolve()
    for name in files:
        if not (folder / name).resolve().is_relative_to(root):
            raise FileError(f"cannot write `{name}`: a link leads out of `{folder}`")
    by_folder: dict[Path, list[Output]] = {}
    for name, data in files.items():
        path = folder / name
        by_folder.setdefault(path.parent, []).append(Output(path.name, data))
    written: list[Path] = []
    for parent, outputs in by_folder.items():
        written += commit(parent, outputs)
    return written
