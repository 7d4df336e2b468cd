"""The process that evaluates cases: ``python -m moldloft.study.worker``."""

from __future__ import annotations

from typing import Any

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


if __name__ == "__main__":
    serve(_evaluated, IDLE_SECONDS)
