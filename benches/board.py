"""Answers of the drawing board: from a request of the page to its reply as JSON.

Processor time of a stair of 150 lines and of one of 500 points without dimensions, and wall time
beside it.
"""

from __future__ import annotations

import gc
import json
import math
import statistics
import time
from typing import Any

from moldloft.workbench.board import Board, answered
from moldloft.workbench.room import GARBAGE

#: Directions of x and y on the page.
_X, _Y = math.radians(345), math.radians(40)


def stair(steps: int) -> str:
    """The picture of a stair: 4 points and 6 lines a step, and the walls."""
    outline = [(0, 0), *(((k + on) * 10, (k + 1) * 10) for k in range(steps) for on in (0, 1))]
    outline.append((10 * steps, 0))
    n = len(outline)
    rows = ["SKETCH PART", "AXES 345 40 90"]
    for i, (x, y, z) in enumerate(((x, y, z) for y in (0, 80) for x, z in outline), 1):
        u = x * math.cos(_X) + y * math.cos(_Y)
        v = x * math.sin(_X) + y * math.sin(_Y) + z
        rows.append(f"POINT {i} AT {u:.3f} {v:.3f}")
    for first in (1, n + 1):
        rows.append(f"POLYLINE {' '.join(map(str, range(first, first + n)))} CLOSE")
    rows += [f"LINE {2 * n + i} FROM {i} TO {n + i}" for i in range(1, n + 1)]
    return "\n".join(rows) + "\n"


def main() -> None:
    """Print median times in ms."""
    gc.set_threshold(GARBAGE)
    for steps in (24, 124):
        board = Board()
        opened = answered(board, {"kind": "board_open", "text": stair(steps), "id": 1})
        _, u, v, *_ = opened["points"][4]

        def asked(kind: str, k: int, u: float = u, v: float = v) -> dict[str, Any]:
            moved = {"point": 5, "at": [u + k % 7 / 10, v + k % 5 / 10]}
            return {
                "board_pointer": {"at": [50 + k, 60], "reach": 8, "start": [10, 10]},
                "board_drag": {"moves": [moved]},
                "board_edit": {"changes": [{"do": "move", **moved}]},
                "board_solid": {},
            }[kind]

        for kind in ("board_pointer", "board_drag", "board_edit", "board_solid"):
            wall, processor = [], []
            for k in range(21):
                request = {"kind": kind, "id": 1, **asked(kind, k)}
                begin = time.perf_counter(), time.process_time()
                json.dumps(answered(board, request))
                wall.append(time.perf_counter() - begin[0])
                processor.append(time.process_time() - begin[1])
            times = [1e3 * statistics.median(all_) for all_ in (processor, wall)]
            print(
                f"{len(opened['points'])} points, {len(opened['lines'])} lines, {kind}: "
                f"{times[0]:.1f} ms, wall {times[1]:.1f} ms"
            )


if __name__ == "__main__":
    main()
