"""The command ``moldloft``. Each subcommand is a module; this one finds and guards them."""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
from collections.abc import Sequence
from importlib import import_module

__all__ = ["main"]

COMMANDS = {
    "build": "run, mesh and measure a model, and write files",
    "hydro": "hydrostatics, equilibrium, tables over drafts, righting arms",
    "check": "report what is wrong with a model",
    "run": "run a program that prints and writes its own files",
    "repl": "interactive prompt",
    "lsp": "start the language server for editors",
    "eval": "print values of expressions in a model's names",
    "new": "write a starter model",
    "fmt": "format as canonical text",
    "convert": "convert between programs, model files, tables of offsets and sketches",
    "formats": "print the table of file formats",
    "graph": "draw the dependency graph as SVG",
    "view": "open the workbench: see, edit and drag a model in the browser",
    "export": "write a model as one page that opens offline",
    "render": "render a picture without a display",
    "sketch": "run a sketch file, or open a sketch prompt",
    "fair": "fair points, a curve or a surface within a certified tolerance",
    "doc": "show the reference of entity kinds and functions",
}
"""Commands with a line about each; the module of the same name has ``add`` and ``run``."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; exit status 0: success, 1: errors in the model, 2: usage error."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    try:
        status = _run(arguments)
        sys.stdout.flush()
    except KeyboardInterrupt:
        # Work that was abandoned must not hold up the end.
        _leave(130)
    except BrokenPipeError:
        # The reader has gone (`moldloft doc --list | head`).
        with contextlib.suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        print(f"error: {(error.strerror or str(error)).lower()}", file=sys.stderr)
        return 1
    except MemoryError:
        print("error: there is not enough memory for this model", file=sys.stderr)
        return 1
    return status


def _run(arguments: list[str]) -> int:
    if arguments[:1] in (["--version"], ["-V"]):
        from moldloft import __version__

        print(f"moldloft {__version__}")
        return 0
    from moldloft.errors import Error

    try:
        options = _parser(arguments).parse_args(arguments)
    except SystemExit as end:
        return int(end.code or 0)
    try:
        status: int = options.run(options)
    except Error as error:
        print(error.rendered, file=sys.stderr)
        return 1
    return status


def _parser(arguments: list[str]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="moldloft",
        description="Describe a shape, relate its parts, panel it, measure it.",
        epilog="`moldloft COMMAND --help` describes each.",
    )
    parser.add_argument("-V", "--version", action="store_true", help="print the version")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for name, line in COMMANDS.items():
        command = commands.add_parser(name, help=line, description=line[0].upper() + line[1:] + ".")
        if name in arguments:
            module = import_module(f"moldloft.cli.{name}")
            module.add(command)
            command.set_defaults(run=module.run)
    return parser


def _leave(status: int) -> None:
    with contextlib.suppress(OSError, ValueError):
        sys.stdout.flush()
    os._exit(status)
