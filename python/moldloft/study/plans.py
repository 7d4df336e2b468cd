"""The points of a study: grids, tables, one input at a time, Latin hypercubes, Sobol sequences."""

from __future__ import annotations

import csv
import io
import itertools
import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.budget import limited
from moldloft.storage import read_text
from moldloft.study.definition import Input, Study, StudyError
from moldloft.study.extras import needed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from moldloft.models import Model

    Floats = NDArray[np.float64]

__all__ = ["case_list", "listed", "points", "ranges"]

#: A plan of more cases is refused: its store would outgrow a disk.
MAX_CASES = 100_000_000


def ranges(study: Study, model: Model) -> Floats:
    """The ranges of the inputs, ``(inputs, 2)``: from the study, or from the model.

    Parameters
    ----------
    study
        The definition.
    model
        Its model.

    Raises
    ------
    StudyError
        If an input has no range, or a range beyond the model's.
    """
    known = model.params
    rows = []
    for each in study.inputs:
        low, high = each.low, each.high
        if each.name in known:
            own = known[each.name]
            low = own.low if low is None else low
            high = own.high if high is None else high
            for limit, side, past in (
                (own.low, "below", low is not None and own.low is not None and low < own.low),
                (own.high, "above", high is not None and own.high is not None and high > own.high),
            ):
                if past:
                    raise StudyError(
                        f"`inputs.{each.name}`: the range runs {side} the model's own, {limit:g}"
                    )
        if low is None or high is None:
            raise StudyError(
                f"`inputs.{each.name}` has no range: write `{each.name} = [low, high]`, "
                "or state one in the model"
            )
        rows.append((low, high))
    return np.array(rows)


def points(study: Study, model: Model) -> Floats:
    """The points of the plan, ``(cases, inputs)``.

    Parameters
    ----------
    study
        The definition.
    model
        Its model: ranges that the study does not state, and values of inputs at rest.

    Returns
    -------
    numpy.ndarray
        The same for the same definition on every machine.

    Raises
    ------
    StudyError
        For a plan that cannot be made.
    """
    method = study.plan.method
    if method == "table":
        return _table(Path(study.plan.file), study)
    box = ranges(study, model)
    made: Floats
    if method == "grid":
        levels = [
            _levels(each, row, study.plan.levels)
            for each, row in zip(study.inputs, box, strict=True)
        ]
        _limited(math.prod(map(len, levels)))
        made = np.array(list(itertools.product(*levels)))
    elif method == "one-at-a-time":
        rest = np.array([float(model.eval(each.name)) for each in study.inputs])
        rows = [rest]
        for k, (each, row) in enumerate(zip(study.inputs, box, strict=True)):
            for value in _levels(each, row, study.plan.levels):
                if value != rest[k]:
                    rows.append(np.concatenate([rest[:k], [value], rest[k + 1 :]]))
        made = np.array(rows)
    else:
        unit = _unit(method, len(box), study.plan.count, study.plan.seed)
        # Rounding must not take the end of a range beyond it.
        made = np.clip(box[:, 0] + (box[:, 1] - box[:, 0]) * unit, box[:, 0], box[:, 1])
    for k, each in enumerate(study.inputs):
        own = model.params.get(each.name)
        if own is not None and own.whole:
            made[:, k] = np.round(made[:, k])
    return made


def case_list(study: Study, plan: Floats) -> bytes:
    """The points of a plan as a CSV file: the number of each case, from 1, and its inputs.

    Parameters
    ----------
    study
        The definition.
    plan
        Its points, by :func:`points`.
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([_NUMBER, *(each.name for each in study.inputs)])
    for number, row in enumerate(plan.tolist(), start=1):
        # The shortest text of the same number.
        writer.writerow([number, *map(repr, row)])
    return out.getvalue().encode()


_NUMBER = "case"
"""Header of the column of numbers in a list of cases."""


def listed(study: Study, plan: Floats, place: str | os.PathLike[str]) -> list[int]:
    """The rows of the plan that a list of cases names, from 0.

    Parameters
    ----------
    study
        The definition.
    plan
        Its points, by :func:`points`.
    place
        A file by :func:`case_list`, or some of its rows below its header.

    Raises
    ------
    StudyError
        If a row is not a case of the plan; the message states the row.
    """
    rows = list(csv.reader(io.StringIO(read_text(place))))
    header = [_NUMBER, *(each.name for each in study.inputs)]
    if not rows or [word.strip() for word in rows[0]] != header:
        raise StudyError(f"{place}: expected the header `{','.join(header)}`")
    found = []
    for number, row in enumerate(rows[1:], start=2):
        if not row:
            continue
        where = f"{place}: row {number}"
        word = row[0].strip()
        if not word.isdecimal() or len(word) > 12 or not 1 <= int(word) <= len(plan):
            raise StudyError(f"{where}: expected a case of 1 to {len(plan)}, found `{word}`")
        try:
            values = [float(each) for each in row[1:]]
        except ValueError as error:
            raise StudyError(f"{where}: {error}") from None
        if values != plan[int(word) - 1].tolist():
            raise StudyError(
                f"{where}: case {word} has other inputs in the plan; write the list again by "
                "`moldloft study cases`"
            )
        found.append(int(word) - 1)
    if not found:
        raise StudyError(f"{place}: the list has a header and no cases")
    return found


def _limited(count: int) -> None:
    if count > MAX_CASES:
        raise StudyError(f"`plan`: {count} cases, at most {MAX_CASES} are possible")


def _levels(each: Input, row: Any, count: int) -> list[float]:
    if each.values:
        return list(each.values)
    return [float(v) for v in np.linspace(row[0], row[1], count)]


def _unit(method: str, size: int, count: int, seed: int) -> Floats:
    """Points of the unit cube."""
    qmc = needed("scipy.stats.qmc", "study", f"the plan `{method}`")
    if method == "latin-hypercube":
        _limited(count)
        found: Floats = qmc.LatinHypercube(size, rng=seed).random(count)
        return found
    if method == "sobol":
        _limited(count)
        return _sobol(qmc, size, count, seed)
    # Saltelli's scheme: A, B, and A with column k of B for each k.
    _limited(count * (size + 2))
    both = _sobol(qmc, 2 * size, count, seed)
    a, b = both[:, :size], both[:, size:]
    mixed = []
    for k in range(size):
        row = a.copy()
        row[:, k] = b[:, k]
        mixed.append(row)
    return np.concatenate([a, b, *mixed])


def _sobol(qmc: Any, size: int, count: int, seed: int) -> Floats:
    # Whole powers of two are balanced; what is beyond `count` is left out.
    power = max(count - 1, 0).bit_length()
    found: Floats = qmc.Sobol(size, scramble=True, rng=seed).random_base2(power)[:count]
    return found


@limited
def _table(place: Path, study: Study) -> Floats:
    rows = list(csv.reader(io.StringIO(read_text(place))))
    rows = [row for row in rows if row and not row[0].lstrip().startswith("#")]
    if not rows:
        raise StudyError(f"{place}: the table is empty")
    header = [word.strip() for word in rows[0]]
    missing = [each.name for each in study.inputs if each.name not in header]
    if missing:
        raise StudyError(f"{place}: no column `{missing[0]}`; columns: {', '.join(header)}")
    columns = [header.index(each.name) for each in study.inputs]
    found = []
    for number, row in enumerate(rows[1:], start=2):
        values = []
        for column in columns:
            word = row[column].strip() if column < len(row) else ""
            try:
                value = float(word)
            except ValueError:
                value = math.nan
            if not math.isfinite(value):
                raise StudyError(
                    f"{place}: row {number}, column `{header[column]}`: expected a number, "
                    f"found `{word}`"
                )
            values.append(value)
        found.append(values)
    if not found:
        raise StudyError(f"{place}: the table has a header and no rows")
    return np.array(found)
