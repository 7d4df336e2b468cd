"""``moldloft new``: a model to start from."""

from __future__ import annotations

import argparse
from pathlib import Path

from moldloft.errors import FileError

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    parser.add_argument("file", metavar="FILE", help="the file to make, such as boat.sdl")


def run(options: argparse.Namespace) -> int:
    """Writes the starter, never over an existing file."""
    from moldloft.exchange.files import Output, commit
    from moldloft.starter import STARTER

    path = Path(options.file)
    if path.suffix == "":
        path = path.with_suffix(".sdl")
    if path.suffix != ".sdl":
        raise FileError(f"a new model is a program: give `{path.stem}.sdl`, not `{path}`")
    if path.exists():
        raise FileError(f"`{path}` is there already; give another name")
    text = STARTER.format(name=path.stem, file=path.name)
    commit(path.parent, [Output(path.name, text.encode())])
    print(f"made {path}; next: moldloft build {path}")
    return 0
