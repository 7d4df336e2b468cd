"""``moldloft convert``: between programs and model files."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from moldloft.cli.console import add_model, open_model, report

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser)
    parser.add_argument(
        "--to", choices=["sdl", "ms2"], help="the form; by default that of -o, else the other one"
    )
    parser.add_argument("-o", "--output", metavar="FILE", help="by default standard output")


def run(options: argparse.Namespace) -> int:
    """Converts the text; what the other form cannot hold is an error or a remark."""
    from moldloft.files import Output, commit

    model = open_model(options)
    report(model.diagnostics)
    if model._document.has_errors():
        return 1
    target = Path(options.output) if options.output else None
    form = options.to or (target.suffix.lstrip(".").lower() if target else "")
    if form not in ("sdl", "ms2"):
        form = "ms2" if options.model.lower().endswith(".sdl") else "sdl"
    text = model.convert(form)
    if target is None:
        sys.stdout.write(text)
    else:
        commit(target.parent, [Output(target.name, text.encode())])
    return 0
