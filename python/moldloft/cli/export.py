"""``moldloft export``: a model as one page that opens offline."""

from __future__ import annotations

import argparse
from pathlib import Path

from moldloft.cli.console import add_model

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser)
    parser.add_argument(
        "--html",
        action="store_true",
        required=True,
        help="a page with the model's text, scene, numbers and dependencies; needs no server",
    )
    parser.add_argument("-o", "--output", metavar="FILE", help="default: MODEL.html")


def run(options: argparse.Namespace) -> int:
    """Writes the page."""
    from moldloft.files import Output, commit
    from moldloft.workbench.still import still_page

    source = Path(options.model)
    page = still_page(source, values=dict(options.set), library=options.library)
    path = Path(options.output or f"{source.stem}.html")
    commit(path.parent, [Output(path.name, page)])
    print(path)
    return 0
