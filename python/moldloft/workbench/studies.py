"""Studies of the model beside its page: made, started, watched and browsed.

A study is a file beside the model, and runs as ``moldloft study`` does, in a process of its own:
the page watches its store, and a page or server that ends leaves a store that the next run
continues.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import Error
from moldloft.storage import put

if TYPE_CHECKING:
    from moldloft.study import Results, Study

__all__ = ["KINDS", "Studies"]

#: What a page may ask.
KINDS = frozenset({
    "studies", "study_make", "study_run", "study_stop", "study_state", "study_rows",
})  # fmt: skip

#: Files of a folder that are looked at, and their size in bytes: a folder may be any.
MOST_FILES = 500
LONGEST_FILE = 1 << 20

#: Rows of one answer, and points of its plot.
MOST_ROWS = 500
MOST_POINTS = 2_000

#: Bytes of what a run that failed has said.
LONGEST_WORDS = 4_000

#: Seconds that a run has for ending.
GRACE = 10.0

PLANS = ("sobol", "latin-hypercube", "grid", "one-at-a-time")


@dataclass
class _Run:
    """A run of a study."""

    process: subprocess.Popen[bytes]
    said: IO[bytes]
    """Its error output."""
    verb: str
    began: float
    before: int
    """Cases in the store at the start."""
    stopped: bool = False

    @property
    def running(self) -> bool:
        """True while the study is running."""
        return self.process.poll() is None

    def words(self) -> str:
        """The last lines of its output."""
        size = self.said.seek(0, os.SEEK_END)
        self.said.seek(max(size - LONGEST_WORDS, 0))
        return self.said.read().decode("utf-8", "replace").strip()

    def end(self) -> None:
        """Stop the study; evaluated cases are in the store."""
        self.stopped = self.stopped or self.running
        self.process.terminate()
        try:
            self.process.wait(GRACE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


class Studies:
    """The studies of a model.

    Parameters
    ----------
    path
        The model's file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path.resolve()
        self._runs: dict[str, _Run] = {}
        self._table: tuple[object, Results] | None = None

    async def answer(self, message: Mapping[str, Any], *, dirty: bool) -> dict[str, Any]:
        """The answer to a request of a page.

        Parameters
        ----------
        message
            A request of :data:`KINDS`.
        dirty
            True when the text differs from the file's: a study reads the file.

        Raises
        ------
        Error
            When a request cannot be carried out.
        """
        kind = message["kind"]
        if kind == "studies":
            return {"studies": await asyncio.to_thread(self.listed)}
        if kind == "study_make":
            return {"name": await asyncio.to_thread(self.make, message)}
        name = self._known(message.get("name"))
        if kind == "study_run":
            if dirty:
                raise Error("a study reads the model's file: save the text first")
            await asyncio.to_thread(self._run, name, message)
        elif kind == "study_stop":
            await asyncio.to_thread(self._stop, name)
        elif kind == "study_rows":
            return await asyncio.to_thread(self.rows, name, message)
        return await asyncio.to_thread(self.state, name)

    # Definitions.

    def _files(self) -> list[Path]:
        """The files beside the model that are studies of it."""
        found = []
        for file in sorted(self.path.parent.glob("*.toml"))[:MOST_FILES]:
            with contextlib.suppress(OSError, ValueError):
                if file.stat().st_size > LONGEST_FILE:
                    continue
                model = tomllib.loads(file.read_text(encoding="utf-8")).get("model")
                if isinstance(model, str) and (file.parent / model).resolve() == self.path:
                    found.append(file)
        return found

    def _known(self, name: object) -> str:
        if name not in {file.name for file in self._files()}:
            raise Error(f"there is no study `{name}` of this model")
        return str(name)

    def _store(self, name: str) -> Path:
        return (self.path.parent / name).with_suffix(".sqlite")

    def listed(self) -> list[dict[str, Any]]:
        """All studies of the model with their status."""
        from moldloft.study import read

        found = []
        for file in self._files():
            try:
                found.append({"name": file.name, **_summary(read(file)), "error": ""})
            except Error as error:
                found.append({"name": file.name, "error": str(error)})
        return found

    def make(self, given: Mapping[str, Any]) -> str:
        """Write a study of inputs over their ranges.

        Parameters
        ----------
        given
            ``inputs`` (names with ``[low, high]`` or null for the range that the model states),
            ``outputs`` (expressions), ``plan`` and ``count``.

        Returns
        -------
        str
            The name of the file, which is beside the model.
        """
        inputs, outputs = given.get("inputs"), given.get("outputs")
        if not isinstance(inputs, dict) or not inputs:
            raise Error("choose an input at least")
        if not isinstance(outputs, list) or not outputs:
            raise Error("choose an output at least: a watched number")
        plan, count = given.get("plan"), given.get("count")
        if plan not in PLANS:
            raise Error(f"`{plan}` is no plan; expected one of: {', '.join(PLANS)}")
        if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= 1_000_000:
            raise Error(f"the number of cases is 1 to 1 000 000, found {count}")
        size = "levels" if plan in ("grid", "one-at-a-time") else "count"
        lines = [f"model = {_quoted(self.path.name)}", "", "[inputs]"]
        for name, ends in inputs.items():
            lines.append(f"{_quoted(name)} = {_range(ends)}")
        lines += ["", "[outputs]"]
        names: dict[str, str] = {}
        for text in outputs:
            word = str(text).rsplit(".", 1)[-1]
            plain = word.isidentifier() and word not in names and word not in inputs
            names[word if plain else str(text)] = str(text)
        lines += [f"{_quoted(name)} = {_quoted(text)}" for name, text in names.items()]
        lines += ["", "[plan]", f"method = {_quoted(plan)}", f"{size} = {count}", ""]
        number = 1
        while (file := self.path.parent / _file_name(self.path.stem, number)).exists():
            number += 1
        put(file, "\n".join(lines).encode(), expected=None)
        return file.name

    # Runs.

    def _run(self, name: str, message: Mapping[str, Any]) -> None:
        """Start a sweep or an optimisation; what the store has is not evaluated again."""
        if (run := self._runs.get(name)) and run.running:
            raise Error(f"`{name}` is running")
        verb = "optimize" if message.get("verb") == "optimize" else "sweep"
        processes = message.get("processes", 1)
        if not isinstance(processes, int) or not 1 <= processes <= (os.cpu_count() or 1):
            raise Error(f"the number of processes is 1 to {os.cpu_count()}, found {processes}")
        words = ["study", verb, name, "--quiet", "--processes", str(processes)]
        if verb == "sweep" and message.get("retry"):
            words += ["--retry", "failed"]
        _, counts = self._counted(name)
        said = tempfile.TemporaryFile()  # noqa: SIM115
        process = subprocess.Popen(
            [sys.executable, "-m", "moldloft", *words],
            cwd=self.path.parent,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=said,
        )
        self._forget(name)
        self._runs[name] = _Run(process, said, verb, time.monotonic(), sum(counts.values()))

    def _forget(self, name: str) -> None:
        if run := self._runs.pop(name, None):
            run.said.close()

    def _stop(self, name: str) -> None:
        """End a run, which stores what it has."""
        if run := self._runs.get(name):
            run.end()

    async def close(self) -> None:
        """End all runs."""
        names = list(self._runs)
        await asyncio.gather(*(asyncio.to_thread(self._stop, name) for name in names))
        for name in names:
            self._forget(name)

    def _counted(self, name: str) -> tuple[int, dict[str, int]]:
        """The cases of the plan, and of those with a result how many are in each state."""
        from moldloft.study import Store

        place = self._store(name)
        if not place.exists():
            return 0, {}
        with Store(place) as store:
            return store.progress()

    def state(self, name: str) -> dict[str, Any]:
        """The progress of a study."""
        planned, counts = self._counted(name)
        run = self._runs.get(name)
        running = run is not None and run.running
        found: dict[str, Any] = {
            "name": name, "running": running, "planned": planned, "counts": counts, "failed": "",
        }  # fmt: skip
        if run is None:
            return found
        done = sum(counts.values())
        new = done - run.before
        if running and run.verb == "sweep" and new > 0 and planned > done:
            found["left"] = (time.monotonic() - run.began) * (planned - done) / new
        if not running and not run.stopped:
            # Status 1 without words: cases failed, or an optimiser did not converge.
            status = run.process.returncode
            ended = "" if status in (0, 1) else f"the run ended with status {status}"
            found["failed"] = run.words() or ended
        return found

    # Rows.

    def _results(self, name: str) -> Results | None:
        """The table, read again when the store has changed."""
        from moldloft.study import Store

        place = self._store(name)
        if not place.exists():
            return None
        beside = place.with_name(f"{place.name}-wal")
        stamp = [name] + [
            (f.stat().st_mtime_ns, f.stat().st_size) for f in (place, beside) if f.exists()
        ]
        if self._table is None or self._table[0] != stamp:
            with Store(place) as store:
                self._table = (stamp, store.results())
        return self._table[1]

    def rows(self, name: str, asked: Mapping[str, Any]) -> dict[str, Any]:
        """Rows of the table in an order, and points of a plot.

        Parameters
        ----------
        name
            The study.
        asked
            ``sort`` (a column, or empty for the order of the plan), ``down``, ``state`` (or empty
            for all), ``first`` row, and the columns ``x`` and ``y`` of the plot.
        """
        results = self._results(name)
        if results is None:
            return {"inputs": [], "outputs": [], "count": 0, "rows": [], "points": []}
        numbers = {**results.inputs, **results.outputs}
        chosen = np.flatnonzero(results.state != "pending")
        if state := asked.get("state"):
            chosen = chosen[results.state[chosen] == state]
        if (column := numbers.get(str(asked.get("sort", "")))) is not None:
            key = column[chosen]
            # Cases without the number are last in both directions.
            order = np.argsort(-key if asked.get("down") else key, kind="stable")
            chosen = chosen[order]
        first = asked.get("first", 0)
        first = first if isinstance(first, int) and first >= 0 else 0
        rows = [_row(results, numbers, k) for k in chosen[first : first + MOST_ROWS].tolist()]
        return {
            "inputs": list(results.inputs),
            "outputs": list(results.outputs),
            "objectives": results.objectives,
            "count": len(chosen),
            "first": first,
            "rows": rows,
            "points": _points(results, numbers, asked, chosen),
        }


def _row(results: Results, numbers: Mapping[str, Any], k: int) -> dict[str, Any]:
    plain = [float(column[k]) for column in numbers.values()]
    front = results.front
    return {
        "row": k,
        "numbers": [x if np.isfinite(x) else None for x in plain],
        "state": str(results.state[k]),
        "message": str(results.message[k]),
        "front": bool(front is not None and front[k]),
    }


def _points(
    results: Results, numbers: Mapping[str, Any], asked: Mapping[str, Any], chosen: Any
) -> list[list[float]]:
    """The row and two numbers of cases that have both; evenly chosen of many."""
    x, y = (numbers.get(str(asked.get(axis, ""))) for axis in "xy")
    if x is None or y is None:
        return []
    both = np.sort(chosen[np.isfinite(x[chosen]) & np.isfinite(y[chosen])])
    if both.size > MOST_POINTS:
        both = both[np.linspace(0, both.size - 1, MOST_POINTS).astype(int)]
    return [[int(k), float(x[k]), float(y[k])] for k in both.tolist()]


def _summary(study: Study) -> dict[str, Any]:
    """Summary of a definition for a page."""
    goal = study.goal
    return {
        "inputs": [each.name for each in study.inputs],
        "outputs": list(study.names),
        "plan": study.plan.method,
        "goal": [o.output for o in goal.objectives] if goal else [],
        "method": goal.method if goal else "",
        # Other programs that a study runs are stated before it starts.
        "programs": [
            each.python or " ".join(word for command in each.command for word in command)
            for each in study.analyses
        ],
    }


def _quoted(text: str) -> str:
    """A text of TOML."""
    return json.dumps(str(text), ensure_ascii=False).replace("\x7f", "\\u007f")


def _range(ends: object) -> str:
    if ends is None:
        return "{}"
    if not isinstance(ends, list) or len(ends) != 2:
        raise Error("a range is [low, high]")
    try:
        low, high = (float(x) for x in ends)
    except (TypeError, ValueError):
        raise Error("a range is two numbers") from None
    if not (np.isfinite([low, high]).all() and low <= high):
        raise Error(f"a range is two finite numbers, the lower one first, found {low} and {high}")
    return f"[{low!r}, {high!r}]"


def _file_name(stem: str, number: int) -> str:
    return f"{stem}-study{'' if number == 1 else f'-{number}'}.toml"
