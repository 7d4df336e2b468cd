"""``moldloft view``: the workbench, in the browser."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import signal
from importlib import import_module
from pathlib import Path

from moldloft.cli.console import add_model

__all__ = ["add", "run"]


def add(parser: argparse.ArgumentParser) -> None:
    """Declares the arguments."""
    add_model(parser, piped=False, values=False, refined=False, foreign=False)
    parser.add_argument(
        "--port",
        metavar="N",
        type=int,
        default=0,
        help="port on this machine; default: the last one of the model if it is free, else any",
    )
    parser.add_argument(
        "--no-browser", action="store_true", help="print the address and open no browser"
    )
    parser.add_argument(
        "--budget",
        metavar="S",
        type=float,
        default=20.0,
        help="seconds that one change may take before the engine is stopped; default 20",
    )
    parser.add_argument(
        "--memory",
        metavar="GIB",
        type=float,
        default=8.0,
        help="GiB of memory that the model may have; default 8",
    )


def run(options: argparse.Namespace) -> int:
    """Serves until Ctrl-C."""
    from moldloft.errors import Error

    try:
        # The server imports this one itself, and without it no page could connect.
        import_module("websockets")
        from moldloft.workbench.hub import Hub
        from moldloft.workbench.server import Server
    except ImportError as error:
        raise Error(
            f"the workbench needs the package `{error.name}`: install `moldloft[view]`"
        ) from None
    return asyncio.run(_serve(options, Hub, Server))


async def _serve(options: argparse.Namespace, hub_type: type, server_type: type) -> int:
    hub = hub_type(
        Path(options.model),
        options.library,
        budget=options.budget,
        memory=int(options.memory * (1 << 30)),
    )
    # Each address opens one browser; the next is printed when it has been used.
    server = server_type(hub, options.port, lambda url: print(url, flush=True))

    def ready() -> None:
        print(server.url, flush=True)
        if not options.no_browser:
            import webbrowser

            webbrowser.open(server.url)

    task = asyncio.ensure_future(server.run(ready))
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        with contextlib.suppress(NotImplementedError):
            loop.add_signal_handler(number, task.cancel)
    with contextlib.suppress(asyncio.CancelledError):
        await task
    for text in hub.texts:
        if text.dirty:
            print(f"unsaved changes are kept in {text.draft.path}")
    return 0
