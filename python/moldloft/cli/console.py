"""What the commands share: models from arguments, diagnostics, JSON, progress."""

from __future__ import annotations

import argparse
import json
import math
import sys
import threading
import time
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from moldloft import Diagnostic
    from moldloft.models import Model

__all__ = [
    "Progress",
    "add_model",
    "assignment",
    "block_problems",
    "open_model",
    "print_json",
    "report",
    "table",
    "water",
]


def assignment(text: str) -> tuple[str, float]:
    """The name and the number of ``name=number``."""
    name, equals, value = text.partition("=")
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not equals or not name.strip() or not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"`{text}` is not of the form name=number")
    return name.strip(), number


def add_model(parser: argparse.ArgumentParser) -> None:
    """Arguments of every command that runs a model."""
    parser.add_argument(
        "model", metavar="MODEL", help="an .sdl program, an .ms2 model file or a .skt sketch"
    )
    parser.add_argument(
        "--set",
        metavar="NAME=NUMBER",
        type=assignment,
        action="append",
        default=[],
        help="a parameter, or a literal of an object such as P21.y; may be repeated",
    )
    parser.add_argument(
        "--library",
        metavar="DIR",
        action="append",
        default=[],
        help="a further folder for `load`; may be repeated",
    )
    parser.add_argument(
        "--refine",
        metavar="TIMES",
        type=int,
        default=0,
        help="refinement level: each level halves the spacing of refined() sizes; default 0",
    )


def open_model(options: argparse.Namespace) -> Model:
    """The model of the arguments, with the values of ``--set``."""
    from moldloft.errors import Error
    from moldloft.files import ending
    from moldloft.formats import formats
    from moldloft.models import load

    named = ending(Path(options.model))
    written = [row for row in formats().values() if named in (row.name, row.suffix) and named]
    if written and named not in ("sdl", "ms2"):
        raise Error(
            f"{options.model} is not a model but what models are written to: {written[0].about};"
            " expected a program (.sdl), a model file (.ms2) or a sketch (.skt)"
        )
    model = load(options.model, library=options.library, strict=False)
    if options.refine:
        if options.refine < 0:
            raise Error("--refine takes a whole number of at least 0")
        model.refine(options.refine)
    if options.set and not model.has_errors:
        model.set(dict(options.set))
    return model


def report(diagnostics: list[Diagnostic]) -> None:
    """Prints diagnostics on standard error."""
    for diagnostic in diagnostics:
        print(str(diagnostic), file=sys.stderr)


def block_problems(model: Model) -> list[Diagnostic]:
    """What is wrong with the cells of the model's solids, if it has any: folded ones, and joins."""
    from moldloft.errors import ModelError

    facts = (model.facts(name) for name in model.objects)
    if not any(fact["ok"] and fact["class"] == "solid" for fact in facts):
        return []
    try:
        return model.blocks().problems
    except ModelError as error:
        return list(error.diagnostics)


def print_json(data: Any) -> None:
    """Prints data as JSON on standard output; non-finite numbers become null."""
    print(json.dumps(_finite(data), indent=2, ensure_ascii=False, allow_nan=False))


def _finite(data: Any) -> Any:
    if isinstance(data, float):
        return data if math.isfinite(data) else None
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_finite(value) for value in data]
    return data


def table(header: list[str], rows: list[list[str]], *, left: int = 1) -> str:
    """A table; the first ``left`` columns to the left, the others to the right.

    >>> print(table(["patch", "panels"], [["hull", "200"]]))
    patch  panels
    hull      200
    """
    widths = [max(len(row[k]) for row in [header, *rows]) for k in range(len(header))]
    lines = []
    for row in [header, *rows]:
        padded = zip(row, widths, strict=True)
        cells = [c.ljust(w) if k < left else c.rjust(w) for k, (c, w) in enumerate(padded)]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


class Progress:
    """Says on standard error what is being done, once it takes more than a second.

    On a terminal one line is kept up to date; elsewhere each stage is said once.
    """

    def __init__(self) -> None:
        self._stage = ""
        self._said = ""
        self._began = time.monotonic()
        self._over = threading.Event()
        self._terminal = sys.stderr.isatty()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def stage(self, words: str) -> None:
        """What is being done from now on."""
        self._stage = words

    def __enter__(self) -> Progress:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._over.set()
        self._thread.join()
        if self._said and self._terminal:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)

    def _watch(self) -> None:
        wait = 1.0
        while not self._over.wait(wait):
            wait = 0.25
            seconds = time.monotonic() - self._began
            if self._terminal:
                line = f"\r\x1b[K{self._stage} … {seconds:.0f} s"
                print(line, end="", file=sys.stderr, flush=True)
            elif self._said != self._stage:
                print(f"{self._stage} …", file=sys.stderr, flush=True)
            self._said = self._stage


def water(text: str) -> float | str:
    """A water by name, or its density."""
    from moldloft.units import WATERS

    if text in WATERS:
        return text
    try:
        return float(text)
    except ValueError:
        names = ", ".join(WATERS)
        raise argparse.ArgumentTypeError(f"`{text}` is neither {names} nor a number") from None
