"""``moldloft export``: a model as one page that opens offline."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from moldloft.cli.console import add_model, emit, open_model, report

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser, piped=False, refined=False)
    parser.add_argument(
        "--html",
        action="store_true",
        required=True,
        help="a page that opens without server and network; it computes on its own where this "
        "package has the engine for pages",
    )
    parser.add_argument(
        "--still",
        action="store_true",
        help="leave the engine out: a smaller page of the model as it is",
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE", help="default: MODEL.html; - is standard output"
    )


def run(options: argparse.Namespace) -> int:
    """Writes the page of a model that has no errors."""
    from moldloft.errors import Error
    from moldloft.workbench.export import exported_page
    from moldloft.workbench.page import NO_ENGINE, engine_packed

    if options.model == "-":
        raise Error("a page is made of a model's file, not of standard input")
    model = open_model(options)
    report(model.diagnostics)
    if model.has_errors:
        return 1
    source = Path(options.model)
    page = exported_page(
        source, values=dict(options.set), library=options.library, living=not options.still
    )
    if not options.still and engine_packed() is None:
        print(f"note: the page shows the model as it is: {NO_ENGINE}", file=sys.stderr)
    path = options.output or f"{source.stem}.html"
    if emit(path, page, [options.model]) is not None:
        print(path)
    return 0
