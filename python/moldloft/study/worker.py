"""The process that evaluates cases: ``python -m moldloft.study.worker``."""

from __future__ import annotations

import os
import signal
from typing import Any, NoReturn

from moldloft.budget import limits
from moldloft.child_process import bounded, serve
from moldloft.study.cases import evaluate

#: After this time without a request the process ends, in seconds.
IDLE_SECONDS = 60.0


def _evaluated(request: dict[str, Any]) -> dict[str, Any]:
    if request.get("begin"):
        return {"state": "begun"}
    # Beside models there are libraries and what analyses hold.
    bounded(2 * limits(memory=request["memory"]).memory + (1 << 30))
    return evaluate(request)


def _stopped(*_: object) -> NoReturn:
    """A program that runs for the case is ended on the way out."""
    raise SystemExit(1)


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, _stopped)
    try:
        serve(_evaluated, IDLE_SECONDS)
    except SystemExit:
        # Destructors of libraries are not waited for.
        os._exit(1)
