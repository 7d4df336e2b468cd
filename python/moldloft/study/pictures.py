"""Pictures of the variants of a study that its page shows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from moldloft.errors import Error

if TYPE_CHECKING:
    from moldloft.study.definition import Study
    from moldloft.study.store import Results

__all__ = ["pictures", "variants"]

#: Pictures of a page, and the outputs whose ends they show.
MOST_PICTURES = 8
MOST_OUTPUTS = 3

WIDTH, HEIGHT = 360, 240


def variants(results: Results) -> dict[int, str]:
    """The rows to draw, each with the reason.

    Parameters
    ----------
    results
        The table.

    Returns
    -------
    dict
        Captions by row: of an optimisation the first point, the best feasible one and some of the
        front, of a plan the cases with the least and the greatest of each output.
    """
    done = np.flatnonzero(results.done)
    found: dict[int, list[str]] = {}

    def take(row: int, caption: str) -> None:
        if row in found or len(found) < MOST_PICTURES:
            found.setdefault(row, []).append(caption)

    if done.size == 0:
        return {}
    if results.objectives and results.feasible is not None:
        take(int(done[0]), "first point")
        good = done[results.feasible[done]]
        for name, sign in results.objectives.items():
            if good.size:
                word = "least" if sign > 0 else "greatest"
                best = good[np.argmin(sign * results.outputs[name][good])]
                take(int(best), f"{word} {name} within the constraints")
        if results.front is not None:
            front = np.flatnonzero(results.front & results.done)
            first = results.outputs[next(iter(results.objectives))]
            front = front[np.argsort(first[front], kind="stable")]
            for k in np.linspace(0, front.size - 1, min(front.size, 4)).astype(int):
                take(int(front[k]), "on the front")
    else:
        for name in list(results.outputs)[:MOST_OUTPUTS]:
            values = results.outputs[name][done]
            take(int(done[np.argmin(values)]), f"least {name}")
            take(int(done[np.argmax(values)]), f"greatest {name}")
    return {row: ", ".join(captions) for row, captions in found.items()}


def pictures(study: Study, results: Results, facts: Mapping[str, str]) -> list[tuple[str, bytes]]:
    """Pictures of variants as PNG, with captions.

    Parameters
    ----------
    study
        The definition.
    results
        The table.
    facts
        The definition as the store recorded it: the pictures are of that model or not made.

    Returns
    -------
    list of tuple
        Empty for a model that has changed since, or that has no panels.
    """
    from moldloft.study.running import Cases

    rows = variants(results)
    if not rows:
        return []
    made = []
    try:
        with Cases(study) as cases:
            if cases.digest != facts.get("digest"):
                return []
            for row, caption in rows.items():
                inputs = {name: float(column[row]) for name, column in results.inputs.items()}
                cases.model.set(inputs)
                outputs = ", ".join(f"{n} {c[row]:.6g}" for n, c in results.outputs.items())
                picture = cases.model.picture(WIDTH, HEIGHT)
                made.append((f"case {row}: {caption} ({outputs})", picture))
    except Error:
        # A model without panels has no pictures; the table is as it is.
        return []
    return made
