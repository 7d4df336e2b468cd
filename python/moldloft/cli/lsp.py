"""``moldloft lsp``: the language server, for editors.

The server is a program of its own, ``moldloft-lsp``; this finds it and hands over to it.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

from moldloft.errors import Error

__all__ = ["add", "run", "server"]

_NAME = "moldloft-lsp" + (".exe" if os.name == "nt" else "")


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    parser.add_argument(
        "--stdio", action="store_true", help="speak on standard input and output (always so)"
    )
    parser.add_argument(
        "--where", action="store_true", help="print the path of the server and exit"
    )


def run(options: argparse.Namespace) -> int:
    """Becomes the server."""
    path = server()
    if options.where:
        print(path)
        return 0
    if os.name == "nt":
        return subprocess.run([str(path)], check=False).returncode
    sys.stdout.flush()
    return os.execv(path, [str(path)])


def server() -> Path:
    """The path of the server.

    ``MOLDLOFT_LSP``, beside this Python, in the package, in a checkout, on the path: the first.

    Raises
    ------
    Error
        When it is nowhere; the message says how to build it.
    """
    given = os.environ.get("MOLDLOFT_LSP")
    if given:
        if not Path(given).is_file():
            raise Error(f"MOLDLOFT_LSP names `{given}`, which is not a file")
        return Path(given)
    package = Path(__file__).resolve().parents[1] / "bin" / _NAME
    checkout = Path(__file__).resolve().parents[3]
    target = Path(os.environ.get("CARGO_TARGET_DIR", checkout / "target"))
    candidates = [Path(sys.executable).parent / _NAME, package]
    candidates += [target / profile / _NAME for profile in ("release", "debug")]
    for candidate in candidates:
        if candidate.is_file():
            if os.name != "nt" and not os.access(candidate, os.X_OK):
                # An unpacked wheel may have lost the mark of a program.
                with contextlib.suppress(OSError):
                    candidate.chmod(0o755)
            return candidate
    found = shutil.which(_NAME)
    if found:
        return Path(found)
    raise Error(
        "the language server moldloft-lsp is not installed\n"
        "help: build it with `cargo install --path crates/lsp` in a checkout of Moldloft"
    )
