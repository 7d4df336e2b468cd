"""The results of a study in one SQLite file: the plan in order, and a row for each evaluated case.

A case is known by the digest of everything that decides its numbers, so that a study that was
stopped continues, and equal points of several plans are evaluated once.
"""

from __future__ import annotations

import contextlib
import csv
import io
import json
import os
import sqlite3
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain, compress
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import Error, FileError
from moldloft.storage import Lock, Output, commit
from moldloft.study.extras import needed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["Outcome", "Results", "Store"]

#: The layout of the file; others are refused.
SCHEMA_VERSION = 2

#: Rows that are tuples of Python at a time while a table is read: more of them leave the cache.
ROWS_AT_ONCE = 1_024

DONE = "done"
"""State of a completed case."""

PENDING = "pending"
"""State of a case not evaluated yet."""


@dataclass(frozen=True)
class Outcome:
    """Result of one case."""

    key: str
    state: str
    """``"done"``, ``"refused"``, ``"timed out"``, ``"crashed"`` or ``"solver failed"``."""
    id: str
    """The id of the diagnostic, empty when done."""
    message: str
    seconds: float
    inputs: Mapping[str, float]
    outputs: Mapping[str, float]
    derivatives: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Derivatives of the outputs that have some, by output and input."""


class RowLayout:
    """The names of a case's numbers, stored as one value, since SQLite allows 2000 columns.

    Parameters
    ----------
    inputs, outputs, derived
        Names of inputs, of outputs, and of outputs with derivatives by all inputs.
    """

    def __init__(
        self, inputs: Sequence[str], outputs: Sequence[str], derived: Sequence[str]
    ) -> None:
        self.inputs, self.outputs, self.derived = tuple(inputs), tuple(outputs), tuple(derived)

    @classmethod
    def of(cls, found: Outcome) -> RowLayout:
        """The order of the numbers in an outcome."""
        return cls(tuple(found.inputs), tuple(found.outputs), tuple(found.derivatives))

    @property
    def text(self) -> str:
        """The names in stored form."""
        return json.dumps([self.inputs, self.outputs, self.derived])

    def packed(self, found: Outcome) -> bytes:
        """The numbers of an outcome."""
        rows = [found.derivatives[name] for name in self.derived]
        numbers = [
            *(found.inputs[n] for n in self.inputs),
            *(found.outputs[n] for n in self.outputs),
            *(row[n] for row in rows for n in self.inputs),
        ]
        return np.array(numbers, dtype="<f8").tobytes()

    def columns(self) -> Iterator[tuple[str, str, str]]:
        """The meaning of each number: in, out or d; the output; the input."""
        yield from (("in", "", name) for name in self.inputs)
        yield from (("out", name, "") for name in self.outputs)
        yield from (("d", name, by) for name in self.derived for by in self.inputs)

    def outcome(self, head: Sequence[Any], data: bytes) -> Outcome:
        """The outcome with this key, state, id, message and time, and these numbers."""
        inputs: dict[str, float] = {}
        outputs: dict[str, float] = {}
        slopes: dict[str, dict[str, float]] = {}
        values = np.frombuffer(data, "<f8").tolist()
        for (kind, name, by), value in zip(self.columns(), values, strict=True):
            if kind == "out":
                outputs[name] = value
            else:
                (inputs if kind == "in" else slopes.setdefault(name, {}))[by] = value
        key, state, reason, message, seconds = head
        return Outcome(key, state, reason, message, seconds, inputs, outputs, slopes)


class Store:
    """The file of a study's results, open for reading or for one run.

    Parameters
    ----------
    path
        The SQLite file; created if missing.
    writing
        True if results are added: one process at a time may.

    Raises
    ------
    BusyError
        If another process runs the study.
    FileError
        If the file is not a store of this version, is damaged, or cannot be made.
    """

    def __init__(self, path: str | os.PathLike[str], *, writing: bool = False) -> None:
        self.path = Path(path)
        self._lock: Lock | None = None
        if writing:
            self._lock = Lock(
                self.path.with_name(f".{self.path.name}.lock"), f"the study `{self.path}`"
            )
        elif not self.path.exists():
            raise FileError(
                f"`{self.path}`: there are no results; `moldloft study sweep` makes them"
            )
        try:
            with self._named():
                # Threads of an executor hand their results to the one that writes.
                self._db = sqlite3.connect(self.path, isolation_level=None)
                self._prepare(writing)
        except BaseException:
            self.close()
            raise

    def _named(self) -> _Named:
        return _Named(self.path)

    def _prepare(self, writing: bool) -> None:
        (version,) = self._db.execute("PRAGMA user_version").fetchone()
        (tables,) = self._db.execute("SELECT count(*) FROM sqlite_master").fetchone()
        if tables and version != SCHEMA_VERSION:
            raise FileError(
                f"`{self.path}` is a store of layout {version}, this version reads {SCHEMA_VERSION}"
            )
        if writing:
            self._db.execute("PRAGMA journal_mode = WAL")
            self._db.execute("PRAGMA synchronous = NORMAL")
        elif not tables:
            # Another process is about to make it: until then it is empty.
            self._db.close()
            self._db = sqlite3.connect(":memory:", isolation_level=None)
        if not tables:
            self._db.executescript(
                f"""
                BEGIN;
                CREATE TABLE study (name TEXT PRIMARY KEY, value TEXT);
                CREATE TABLE cases (position INTEGER PRIMARY KEY, key TEXT NOT NULL);
                CREATE TABLE layouts (layout INTEGER PRIMARY KEY, names TEXT NOT NULL UNIQUE);
                CREATE TABLE results (
                    key TEXT PRIMARY KEY, state TEXT NOT NULL, id TEXT NOT NULL,
                    message TEXT NOT NULL, seconds REAL NOT NULL,
                    layout INTEGER NOT NULL, numbers BLOB NOT NULL
                ) WITHOUT ROWID;
                PRAGMA user_version = {SCHEMA_VERSION};
                COMMIT;
                """
            )
        self._layouts = self._known_layouts()

    def _known_layouts(self) -> dict[str, int]:
        return dict(self._db.execute("SELECT names, layout FROM layouts"))

    @contextlib.contextmanager
    def _at_once(self) -> Iterator[None]:
        """A transaction: all writes within are stored, or no write."""
        with self._named():
            self._db.execute("BEGIN")
            try:
                yield
            except BaseException:
                self._db.execute("ROLLBACK")
                self._layouts = self._known_layouts()
                raise
            self._db.execute("COMMIT")

    # -- writing ---------------------------------------------------------------------------

    def begin(self, facts: Mapping[str, str], keys: Iterator[str] | Sequence[str]) -> None:
        """Record the definition and the plan.

        Parameters
        ----------
        facts
            The definition: texts by name.
        keys
            The keys of all cases, in the order of the plan.
        """
        with self._at_once():
            self._db.execute("DELETE FROM cases")
            self._db.execute("DELETE FROM study")
            self._db.executemany(
                "INSERT INTO cases VALUES (?, ?)", ((k, key) for k, key in enumerate(keys))
            )
            self._db.executemany("INSERT INTO study VALUES (?, ?)", facts.items())

    def note(self, facts: Mapping[str, str]) -> None:
        """Add results of the run to the definition.

        Parameters
        ----------
        facts
            Texts by name; they replace those of the same name.
        """
        with self._at_once():
            self._db.executemany("INSERT OR REPLACE INTO study VALUES (?, ?)", facts.items())

    def append(self, key: str) -> None:
        """Add one case at the end of the plan.

        Parameters
        ----------
        key
            The case's key.
        """
        with self._named():
            self._db.execute(
                "INSERT INTO cases SELECT coalesce(max(position) + 1, 0), ? FROM cases", (key,)
            )

    def add(self, outcome: Outcome) -> None:
        """Record the outcome of a case durably.

        Parameters
        ----------
        outcome
            The case with its state and numbers; it replaces an earlier one of the same key.
        """
        layout = RowLayout.of(outcome)
        text = layout.text
        with self._named():
            if text not in self._layouts:
                made = self._db.execute("INSERT INTO layouts (names) VALUES (?)", (text,))
                self._layouts[text] = int(made.lastrowid or 0)
            self._db.execute(
                "INSERT OR REPLACE INTO results VALUES (?, ?, ?, ?, ?, ?, ?)",
                (
                    outcome.key,
                    outcome.state,
                    outcome.id,
                    outcome.message,
                    outcome.seconds,
                    self._layouts[text],
                    layout.packed(outcome),
                ),
            )

    def forget(self, states: Sequence[str]) -> int:
        """Forget results, so that their cases are evaluated again.

        Parameters
        ----------
        states
            The states of the results to forget.

        Returns
        -------
        int
            The number of results forgotten.
        """
        marks = ", ".join("?" * len(states))
        with self._named():
            return self._db.execute(
                f"DELETE FROM results WHERE state IN ({marks})", list(states)
            ).rowcount

    def collect(self, other: Store) -> int:
        """Copy missing results from another store.

        Parameters
        ----------
        other
            The store that the results are read from.

        Returns
        -------
        int
            The number of results taken.
        """
        taken = 0
        with self._at_once():
            known = self.known()
            for outcome in other.outcomes():
                if outcome.key not in known:
                    self.add(outcome)
                    taken += 1
        return taken

    # -- reading ---------------------------------------------------------------------------

    def known(self) -> set[str]:
        """The keys of all cases with a result."""
        with self._named():
            return {key for (key,) in self._db.execute("SELECT key FROM results")}

    def progress(self) -> tuple[int, dict[str, int]]:
        """The number of cases of the plan, and the number of them in each state.

        Returns
        -------
        tuple of int and dict
            Cases without a result are in no state.
        """
        with self._named():
            (planned,) = self._db.execute("SELECT count(*) FROM cases").fetchone()
            states = self._db.execute(
                "SELECT state, count(*) FROM cases JOIN results USING (key) GROUP BY state"
            )
            return int(planned), dict(states)

    def facts(self) -> dict[str, str]:
        """The definition as it was recorded."""
        with self._named():
            return dict(self._db.execute("SELECT name, value FROM study"))

    def find(self, key: str) -> Outcome | None:
        """The outcome of a case.

        Parameters
        ----------
        key
            The case's key.

        Returns
        -------
        Outcome or None
            ``None`` when the case has no result.
        """
        return next(self._outcomes("WHERE key = ?", (key,)), None)

    def outcomes(self) -> Iterator[Outcome]:
        """All outcomes, by key."""
        return self._outcomes("", ())

    def _outcomes(self, where: str, values: Sequence[str]) -> Iterator[Outcome]:
        with self._named():
            layouts = self._read_layouts()
            rows = self._db.execute(f"SELECT * FROM results {where} ORDER BY key", values)
            for *head, layout, data in rows:
                yield layouts[layout].outcome(head, data)

    def _read_layouts(self) -> dict[int, RowLayout]:
        rows = self._db.execute("SELECT layout, names FROM layouts")
        return {number: RowLayout(*json.loads(names)) for number, names in rows}

    def results(self) -> Results:
        """The table of the plan, in its order."""
        # One state of the file, although a run may be adding to it.
        with self._at_once():
            rows = self._db.execute("SELECT key FROM cases ORDER BY position")
            keys = _texts(list(chain.from_iterable(rows)))
            # The rows of results are in the order of their keys: no join of a million texts.
            known, seconds, numbers = self._numbers()
            texts = self._db.execute(
                f"SELECT key, state, id, message FROM results WHERE state <> '{DONE}'"
                " OR id <> '' OR message <> ''"
            ).fetchall()
        # Sorted texts are found faster.
        order = np.argsort(keys)
        row = np.empty(len(keys), dtype=np.int64)
        row[order] = np.minimum(np.searchsorted(known, keys[order]), max(len(known) - 1, 0))
        has = known[row] == keys if len(known) else np.zeros(len(keys), dtype=bool)
        states, ids, messages = words = [
            np.full(len(known) + 1, word, dtype=object) for word in (DONE, "", "")
        ]
        if texts:
            failed, *found = zip(*texts, strict=True)
            at = np.searchsorted(known, np.array(failed, dtype=known.dtype))
            for column, said in zip(words, found, strict=True):
                column[at] = said
        # The row behind the last is that of a case without a result.
        states[-1] = PENDING
        row = np.where(has, row, len(known))
        inputs: dict[str, Floats] = {}
        outputs: dict[str, Floats] = {}
        slopes: dict[str, dict[str, Floats]] = {}
        for (kind, name, by), values in numbers.items():
            column = values[row]
            if kind == "out":
                outputs[name] = column
            elif not np.isnan(column).all():
                # Not of another plan of the store.
                (inputs if kind == "in" else slopes.setdefault(name, {}))[by] = column
        facts = self.facts()
        objectives = json.loads(facts.get("objectives", "{}"))
        held, best = (
            np.isin(keys, np.array(json.loads(facts.get(name, "[]")), dtype=keys.dtype))
            if objectives
            else None
            for name in ("feasible", "front")
        )
        return Results(
            inputs,
            outputs,
            states[row],
            ids[row],
            messages[row],
            seconds[row],
            objectives,
            held,
            best if len(objectives) > 1 else None,
            slopes,
        )

    def _numbers(self) -> tuple[NDArray[np.bytes_], Floats, dict[tuple[str, str, str], Floats]]:
        """Keys, seconds and columns of all results by key, and a row without numbers at the end."""
        layouts = self._read_layouts()
        names = dict.fromkeys(name for layout in layouts.values() for name in layout.columns())
        keys, seconds = [_texts([])], []
        parts: dict[int, list[bytes]] = {number: [] for number in layouts}
        places: dict[int, list[NDArray[np.int64]]] = {number: [] for number in layouts}
        rows = self._db.execute("SELECT key, seconds, layout, numbers FROM results ORDER BY key")
        count = 0
        while part := rows.fetchmany(ROWS_AT_ONCE):
            texts, times, which, data = zip(*part, strict=True)
            keys.append(_texts(texts))
            seconds.append(np.array(times))
            kinds = np.array(which)
            for number in set(which):
                own = kinds == number
                parts[number].append(b"".join(compress(data, own.tolist())))
                places[number].append(count + np.flatnonzero(own))
            count += len(part)
        found = {name: np.full(count + 1, np.nan) for name in names}
        for number, blobs in parts.items():
            if blobs:
                at = np.concatenate(places[number])
                table = np.frombuffer(b"".join(blobs), "<f8").reshape(len(at), -1)
                for name, column in zip(layouts[number].columns(), table.T, strict=True):
                    found[name][at] = column
        return np.concatenate(keys), np.concatenate([*seconds, [np.nan]]), found

    def close(self) -> None:
        """Releases the file."""
        try:
            if hasattr(self, "_db"):
                with self._named():
                    self._db.close()
        finally:
            if self._lock is not None:
                self._lock.release()
                self._lock = None

    def __enter__(self) -> Store:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _texts(keys: Sequence[str]) -> NDArray[np.bytes_]:
    return np.array(keys, dtype=np.bytes_) if keys else np.empty(0, dtype="S1")


class _Named:
    """Errors of SQLite name the file."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __enter__(self) -> None:
        return None

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if isinstance(error, sqlite3.Error):
            raise FileError(f"`{self.path}`: {error}") from None


@dataclass(frozen=True)
class Results:
    """The table of a study: one row for each case, in the order of the plan.

    Numbers of cases that are not done are NaN.
    """

    inputs: dict[str, Floats]
    """The inputs by name, ``(cases,)`` each."""
    outputs: dict[str, Floats]
    """The outputs by name, ``(cases,)`` each."""
    state: NDArray[np.object_]
    """The states, ``(cases,)``; ``"pending"`` before a case was evaluated."""
    id: NDArray[np.object_]
    """The ids of failures."""
    message: NDArray[np.object_]
    """The messages of failures."""
    seconds: Floats
    """The time that each case took."""
    objectives: dict[str, float] = field(default_factory=dict)
    """Objectives of an optimisation, by name: 1 to minimise, -1 to maximise."""
    feasible: NDArray[np.bool_] | None = None
    """Mask of the points that satisfy the constraints of an optimisation, ``(cases,)``."""
    front: NDArray[np.bool_] | None = None
    """The points of the Pareto front of several objectives, ``(cases,)``."""
    derivatives: dict[str, dict[str, Floats]] = field(default_factory=dict)
    """Derivatives of the outputs that have some, by output and input, ``(cases,)`` each."""

    def __len__(self) -> int:
        return len(self.state)

    @cached_property
    def counts(self) -> dict[str, int]:
        """The number of cases in each state."""
        return dict(sorted(Counter(self.state.tolist()).items()))

    @cached_property
    def done(self) -> NDArray[np.bool_]:
        """Mask of the completed cases, ``(cases,)``."""
        found: NDArray[np.bool_] = self.state == DONE
        return found

    def columns(self) -> dict[str, Any]:
        """All columns by name.

        Inputs, outputs, derivatives (``d output / d input``), state, id, message; feasible and
        front if known.
        """
        columns: dict[str, Any] = {**self.inputs, **self.outputs}
        for name, row in self.derivatives.items():
            columns |= {f"d {name} / d {by}": values for by, values in row.items()}
        columns |= {"state": self.state, "id": self.id, "message": self.message}
        for name, chosen in (("feasible", self.feasible), ("front", self.front)):
            if chosen is not None and name not in columns:
                columns[name] = chosen
        return columns

    def csv(self) -> bytes:
        """The table as CSV; numbers with all digits, missing ones empty."""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        columns = self.columns()
        writer.writerow(columns)
        for row in zip(*columns.values(), strict=True):
            writer.writerow(
                ""
                if isinstance(v, float) and v != v
                else repr(float(v))
                if isinstance(v, float)
                else v
                for v in row
            )
        return out.getvalue().encode()

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with a row for each case."""
        return needed("pandas", "tables", "a table").DataFrame(self.columns())

    def to_xarray(self) -> Any:
        """An ``xarray.Dataset`` over the dimension ``case``."""
        return needed("xarray", "tables", "a data set").Dataset(
            {name: ("case", column) for name, column in self.columns().items()}
        )

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Write the table as ``.csv`` or ``.parquet``.

        Parameters
        ----------
        path
            The file; Parquet needs pandas and pyarrow.

        Returns
        -------
        Path
            The file written.
        """
        place = Path(path)
        if place.suffix.lower() == ".parquet":
            out = io.BytesIO()
            needed("pyarrow", "tables", "Parquet")
            self.to_pandas().to_parquet(out, index=False)
            data = out.getvalue()
        elif place.suffix.lower() == ".csv":
            data = self.csv()
        else:
            raise Error(f"`{place}`: a table is written as .csv or .parquet")
        return commit(place.parent, [Output(place.name, data)])[0]
