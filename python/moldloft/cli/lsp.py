"""``moldloft lsp``: the language server, for editors."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from moldloft import __version__
from moldloft.errors import Error
from moldloft.language_server import serve

__all__ = ["add", "main", "run"]

_NAME = "moldloft-lsp" + (".exe" if os.name == "nt" else "")


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    parser.add_argument(
        "--stdio", action="store_true", help="speak on standard input and output (always so)"
    )
    parser.add_argument(
        "--where",
        action="store_true",
        help="print the path of moldloft-lsp, the server as a program without arguments, and exit",
    )


def run(options: argparse.Namespace) -> int:
    """Serves until the editor closes the connection."""
    if options.where:
        path = Path(sys.executable).parent / _NAME
        if not path.is_file():
            raise Error(f"`{path}` is not there\nhelp: `moldloft lsp` is the same server")
        print(path)
        return 0
    return 0 if serve() else 1


def main() -> int:
    """The program ``moldloft-lsp``."""
    parser = argparse.ArgumentParser(
        prog="moldloft-lsp", description="The language server of Moldloft, for editors."
    )
    parser.add_argument("-V", "--version", action="version", version=f"%(prog)s {__version__}")
    add(parser)
    return run(parser.parse_args())
