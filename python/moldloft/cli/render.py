"""``moldloft render``: a picture without a display."""

from __future__ import annotations

import argparse
import re
from pathlib import Path

from moldloft.cli.console import Progress, add_model, open_model, report

__all__ = ["add", "run"]

_LARGEST = 8192


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d+)x(\d+)", text)
    if not match or not all(16 <= int(side) <= _LARGEST for side in match.groups()):
        raise argparse.ArgumentTypeError(
            f"`{text}` is no size WIDTHxHEIGHT of 16 to {_LARGEST} pixels a side"
        )
    return int(match[1]), int(match[2])


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser)
    parser.add_argument("-o", "--output", metavar="FILE", help="by default MODEL.png here")
    parser.add_argument(
        "--size", metavar="WxH", type=_size, default=(1200, 800), help="pixels; default 1200x800"
    )


def run(options: argparse.Namespace) -> int:
    """Draws what has a value; errors are reported besides."""
    from moldloft.files import Output, commit

    with Progress() as progress:
        progress.stage(f"running {options.model}")
        model = open_model(options)
        report(model.diagnostics)
        progress.stage("drawing")
        path = Path(options.output or f"{Path(options.model).stem}.png")
        picture = model._document.picture(*options.size)
        commit(path.parent, [Output(path.name, picture)])
    print(path)
    return 1 if model._document.has_errors() else 0
