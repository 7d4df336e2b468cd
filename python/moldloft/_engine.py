"""Engine processes, which run models within limits and can be ended without loss of data.

The workbench and the language server start one with :func:`command` and speak to it by its standard
input and output.
"""

from __future__ import annotations

import sys

from moldloft import _core

__all__ = ["command", "main"]

#: Runs :func:`main`. Python looks for modules in the working directory first, which may be a
#: stranger's: that place is taken away before anything is imported.
_START = """\
import sys
if sys.path[:1] == [""]:
    del sys.path[0]
from moldloft._engine import main
main()
"""


def command(*arguments: str) -> list[str]:
    """The command that starts such a process."""
    return [sys.executable, "-c", _START, *arguments]


def main() -> None:
    """Serve requests of the parent process until the connection closes.

    The arguments are ``language``, or ``model MEMORY NAME FOLDER [LIBRARY ...]``, or the same for
    ``board``, which draws, ``desk``, which fairs, and ``files``, which exports.
    """
    work, *arguments = sys.argv[1:]
    if work == "language":
        sys.exit(0 if _core.language_engine() else 1)
    if work == "board":
        from moldloft.workbench.board import serve

        serve(int(arguments[0]), arguments[2] or None)
        return
    if work == "desk":
        from moldloft.workbench.desk import serve as serve_desk

        serve_desk(int(arguments[0]), arguments[1], arguments[2] or None)
        return
    memory, name, folder, *library = arguments
    if work == "files":
        from moldloft.workbench.conversion import serve as serve_files

        serve_files(int(memory), name, [*([folder] if folder else []), *library])
        return
    _core.engine(int(memory), name, folder or None, library)
