"""``moldloft render``: a picture without a display."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

from moldloft.cli.console import (
    Progress,
    add_model,
    add_quiet,
    emit,
    open_model,
    report,
    say,
    stem_of,
)

if TYPE_CHECKING:
    from moldloft.models import Model

__all__ = ["add", "run"]

_LARGEST = 8192


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d+)x(\d+)", text)
    if not match or not all(16 <= int(side) <= _LARGEST for side in match.groups()):
        raise argparse.ArgumentTypeError(
            f"`{text}` is not a size WIDTHxHEIGHT of 16 to {_LARGEST} pixels a side"
        )
    return int(match[1]), int(match[2])


def _corner(text: str) -> tuple[float, float, float]:
    parts = text.strip("{}() ").split(",")
    try:
        x, y, z = (float(part) for part in parts)
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"`{text}` is not a point: expected three numbers like -1,0,2.5"
        ) from None
    return x, y, z


def _traced(options: argparse.Namespace, model: Model) -> bytes:
    """The picture of one set."""
    from moldloft.errors import Error
    from moldloft.implicit import Set

    name = options.traced
    thing = model.eval(name)
    if not isinstance(thing, Set):
        raise Error(
            f"`{name}` is not a set: --traced takes the name of a set, or an expression of sets"
        )
    if (options.low is None) != (options.high is None):
        raise Error("a box has two corners: give both --low and --high, or neither")
    return thing.picture(
        low=options.low, high=options.high, size=options.size, samples=options.samples
    )


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser)
    parser.add_argument(
        "-o", "--output", metavar="FILE", help="default: MODEL.png; - is standard output"
    )
    add_quiet(parser)
    parser.add_argument(
        "--size", metavar="WxH", type=_size, default=(1200, 800), help="pixels; default 1200x800"
    )
    parser.add_argument(
        "--only",
        metavar="NAME",
        nargs="+",
        default=[],
        help="draw these objects, patches, contours or arrays, with their parts; default: all",
    )
    parser.add_argument(
        "--traced",
        metavar="SET",
        help="ray trace this set: its exact surface with lights, shadows and colours",
    )
    parser.add_argument(
        "--low", metavar="X,Y,Z", type=_corner, help="low corner of the box that is traced"
    )
    parser.add_argument("--high", metavar="X,Y,Z", type=_corner, help="its high corner")
    parser.add_argument(
        "--samples",
        metavar="N",
        type=int,
        choices=range(1, 9),
        default=2,
        help="rays along each side of a picture point, 1 to 8; default 2",
    )


def run(options: argparse.Namespace) -> int:
    """Draws objects that have a value and reports errors. Writes no file if no object has one."""
    from moldloft.errors import Error

    if options.output not in (None, "-") and Path(options.output).suffix.lower() != ".png":
        found = Path(options.output).name
        raise Error(f"a picture is a PNG file: name it with `.png`, not `{found}`")
    with Progress() as progress:
        progress.stage(f"running {options.model}")
        model = open_model(options)
        report(model.diagnostics)
        if model.has_errors and not any(model.facts(name)["ok"] for name in model.objects):
            return 1
        progress.stage("drawing")
        path = options.output or f"{stem_of(options)}.png"
        if options.traced is None:
            picture = model.picture(*options.size, only=options.only)
        else:
            picture = _traced(options, model)
        emit(path, picture, [options.model])
    if path != "-":
        say(options, path)
    return 1 if model.has_errors else 0
