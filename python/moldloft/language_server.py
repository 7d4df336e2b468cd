"""The language server: the protocol of editors on standard input and output."""

from __future__ import annotations

import signal

from moldloft import _core
from moldloft._engine import command

__all__ = ["serve"]


def serve() -> bool:
    """Serves an editor on standard input and output until it disconnects.

    Texts are run in a separate process, which is restarted if a text ends it. An
    interrupt (Ctrl-C) ends the server.

    Returns
    -------
    bool
        False when the editor went without the protocol's goodbye.
    """
    # Nothing of Python runs while it serves: an interrupt ends the process, as it does any program.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    program, *arguments = command("language")
    return _core.language_server(program, arguments)
