"""``moldloft fmt``: canonical text."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from moldloft.cli.console import expanded, put_text

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    parser.add_argument(
        "files", metavar="FILE", nargs="+", help=".sdl programs, patterns; - is standard input"
    )
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--check", action="store_true", help="name the files that would change")
    how.add_argument("-w", "--write", action="store_true", help="write the files")


def _ended_as(old: bytes, new: bytes) -> bytes:
    r"""Canonical text with the ends of lines that the file has.

    >>> _ended_as(b"a\r\nb", b"a\nb\n"), _ended_as(b"a\rb", b"a\nb\n")
    (b'a\r\nb\r\n', b'a\rb\r')
    """
    if b"\r\n" in old:
        return new.replace(b"\r\n", b"\n").replace(b"\n", b"\r\n")
    return new.replace(b"\n", b"\r") if b"\r" in old and b"\n" not in old else new


def run(options: argparse.Namespace) -> int:
    """Formats each file; a program with syntax errors is unchanged and reported."""
    from moldloft.errors import Error
    from moldloft.language import format_text
    from moldloft.storage import digest, put, read_bytes, recover

    status = 0
    for file in expanded(options.files):
        path = Path(file)
        old = sys.stdin.buffer.read() if file == "-" else read_bytes(path)
        try:
            new = _ended_as(old, format_text(file, old).encode())
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
                recover(path.resolve().parent)
                # A file saved meanwhile by another program is kept.
                put(path, new, expected=digest(old))
        else:
            put_text(new.decode())
    return status
