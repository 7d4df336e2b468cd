"""``moldloft fmt``: canonical text."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from moldloft.cli.console import expanded
from moldloft.errors import FileError

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    parser.add_argument(
        "files", metavar="FILE", nargs="+", help=".sdl programs, patterns; - is standard input"
    )
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--check", action="store_true", help="name the files that would change")
    how.add_argument("-w", "--write", action="store_true", help="write the files")


def run(options: argparse.Namespace) -> int:
    """Formats each file; a program that does not parse stays as it is and is reported."""
    from moldloft.errors import Error
    from moldloft.files import Output, commit
    from moldloft.language import format_text

    status = 0
    for file in expanded(options.files):
        path = Path(file)
        try:
            old = sys.stdin.buffer.read() if file == "-" else path.read_bytes()
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise FileError(f"cannot read `{file}`: {reason}") from error
        try:
            new = format_text(file, old).encode()
        except Error as error:
            print(error.rendered, file=sys.stderr)
            status = 1
            continue
        if options.check:
            if new != old:
                print(f"{file} would be formatted")
                status = 1
        elif options.write and file != "-":
            if new != old:
                commit(path.parent, [Output(path.name, new)])
        else:
            sys.stdout.write(new.decode())
    return status
