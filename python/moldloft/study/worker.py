"""The process that evaluates cases: ``python -m moldloft.study.worker``."""

from __future__ import annotations

import json
import os
import signal
import struct
import sys
import threading

from moldloft.budget import limits
from moldloft.study.cases import evaluate
from moldloft.study.workers import frame

#: After this time without a request the process ends, in seconds.
IDLE_SECONDS = 60.0


def _bounded(memory: int) -> None:
    """Bounds the memory of this process, where the system can."""
    try:
        import resource
    except ImportError:
        return
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    held = memory if most == resource.RLIM_INFINITY else min(memory, most)
    resource.setrlimit(resource.RLIMIT_AS, (held, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _main() -> None:
    # Only frames go to the parent; what functions print goes to standard error.
    answers = os.dup(1)
    os.dup2(2, 1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    bounded: str | None = None
    with os.fdopen(answers, "wb") as target:
        while True:
            timer = threading.Timer(IDLE_SECONDS, os._exit, (0,))
            timer.daemon = True
            timer.start()
            body = frame(sys.stdin.buffer)
            timer.cancel()
            if body is None:
                os._exit(0)
            request = json.loads(body)
            if bounded != request["memory"]:
                bounded = request["memory"]
                # Beside models there are libraries and what analyses hold.
                _bounded(2 * limits(memory=bounded).memory + (1 << 30))
            answer = json.dumps(evaluate(request)).encode()
            target.write(struct.pack("<Q", len(answer)) + answer)
            target.flush()


if __name__ == "__main__":
    _main()
