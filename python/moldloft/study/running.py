"""Running of a study: cases go to an executor, results to the store in order of completion."""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    CancelledError,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from dataclasses import asdict
from itertools import islice
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft import _core
from moldloft.errors import Error
from moldloft.loading import load
from moldloft.storage import digest, read_bytes
from moldloft.study.cases import SOLVER_FAILED, number
from moldloft.study.definition import Study, StudyError
from moldloft.study.plans import listed, points, ranges
from moldloft.study.sources import check_programs, source_files
from moldloft.study.store import Outcome, Results, Store
from moldloft.study.workers import CRASHED, OTHER_VERSION, TIMED_OUT, end_workers, evaluate_each

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["RETRIED", "Cases", "sweep"]

RETRIED = (TIMED_OUT, CRASHED, SOLVER_FAILED)
"""The states whose cases are evaluated again on request."""

#: Cases handed to an executor beyond those under way, for each of its workers: the back-pressure.
QUEUED_PER_WORKER = 4

#: Duration of a call that has several cases, by the longest of those before.
BUNDLE_SECONDS = 0.2

#: Times that a case is handed out again after an executor lost its machine.
MAX_LOST = 3


class Cases:
    """The cases of a study: a snapshot of its model, the requests for workers, their keys.

    Parameters
    ----------
    study
        The definition.

    Raises
    ------
    StudyError
        If an input or output is unknown to the model.
    ModelError
        If the model has an error.
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        self.model = load(study.model, library=study.library)
        self._check()
        self.digest = self._bundle_digest()
        self._place = study.folder.absolute() / f"{study.model.stem}.cases"
        self._snapshot: tempfile.TemporaryDirectory[str] | None = None
        self._fixed = self._common()

    def _check(self) -> None:
        """Check expressions before the first case; an error names the table."""
        for each in self.study.inputs:
            try:
                self.model.set({each.name: float(self.model.eval(each.name))})
            except Error as error:
                raise StudyError(f"`inputs.{each.name}`: {error}") from None
        for table, expressions in (
            ("outputs", self.study.outputs),
            ("constraints", {b.name: b.value for b in self.study.constraints}),
        ):
            for name, text in expressions.items():
                try:
                    number(self.model.eval(text), text)
                except Error as error:
                    raise StudyError(f"`{table}.{name}`: {error}") from None

    def _files(self) -> list[Path]:
        names = [Path(name) for name in self.model.sources]
        return [name.absolute() for name in names if name.is_file()]

    def _bundle_digest(self) -> str:
        found = hashlib.sha256(_core.__version__.encode())
        for path in self._files():
            found.update(path.name.encode() + b"\0" + digest(read_bytes(path)).encode())
        return found.hexdigest()

    def _common(self) -> dict[str, Any]:
        study = self.study
        differences = study.derivatives and any(each.differences for each in study.analyses)
        box = ranges(study, self.model) if differences else np.empty((0, 2))
        return {
            # Differences stay within them.
            "ranges": dict(zip(self.names if differences else (), box.tolist(), strict=True)),
            "outputs": dict(study.outputs),
            "derivatives": study.derivatives,
            "closed": study.closed,
            "constraints": [
                (
                    b.name,
                    b.value,
                    b.low if math.isfinite(b.low) else None,
                    b.high if math.isfinite(b.high) else None,
                )
                for b in study.constraints
            ],
            "analyses": [_plain(asdict(each)) for each in study.analyses],
            "sources": [(f.name, digest(read_bytes(f))) for f in source_files(study)],
        }

    @property
    def names(self) -> list[str]:
        """The names of the inputs."""
        return [each.name for each in self.study.inputs]

    def key(self, point: Sequence[float] | Floats) -> str:
        """The digest of everything that determines a case's numbers."""
        inputs = {name: float(v).hex() for name, v in zip(self.names, point, strict=True)}
        text = json.dumps([self.digest, self._fixed, inputs], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:40]

    def request(self, key: str, point: Sequence[float] | Floats) -> dict[str, Any]:
        """The request to a worker for a case."""
        study = self.study
        return {
            **self._fixed,
            "key": key,
            "version": _core.__version__,
            "digest": self.digest,
            "model": str(self.snapshot),
            "root": self._snapshot.name if self._snapshot else "",
            "library": list(study.library),
            "inputs": {name: float(v) for name, v in zip(self.names, point, strict=True)},
            "folder": str(study.folder.absolute()),
            "place": str(self._place / key[:16]),
            "seconds": study.seconds,
            "memory": study.memory,
        }

    @property
    def snapshot(self) -> Path:
        """The model's file as it was at the start: edits during a study change nothing."""
        files = self._files()
        if self._snapshot is None:
            self._snapshot = tempfile.TemporaryDirectory(prefix="moldloft-study-")
            root = Path(os.path.commonpath([str(f.parent) for f in files]))
            for file in files:
                target = Path(self._snapshot.name) / file.relative_to(root)
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(file, target)
            self._model_at = self.study.model.absolute().relative_to(root)
        return Path(self._snapshot.name) / self._model_at

    def close(self) -> None:
        """Remove the snapshot, and the folder of the cases if it is empty."""
        with contextlib.suppress(OSError):
            self._place.rmdir()
        if self._snapshot is not None:
            self._snapshot.cleanup()
            self._snapshot = None

    def __enter__(self) -> Cases:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _plain(data: Any) -> Any:
    if isinstance(data, Mapping):
        return {key: _plain(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_plain(value) for value in data]
    return data


def outcome(request: Mapping[str, Any], answer: Mapping[str, Any]) -> Outcome:
    """The outcome in a worker's answer."""
    return Outcome(
        request["key"],
        answer["state"],
        answer.get("id", ""),
        answer.get("message", ""),
        float(answer.get("seconds", 0.0)),
        request["inputs"],
        answer.get("outputs", {}),
        {
            name: dict(zip(request["inputs"], row, strict=True))
            for name, row in answer.get("derivatives", {}).items()
        },
    )


def sweep(
    study: Study,
    store: str | os.PathLike[str],
    *,
    executor: Executor | None = None,
    processes: int = 2,
    retry: Sequence[str] = (),
    part: tuple[int, int] = (1, 1),
    cases: str | os.PathLike[str] = "",
    progress: Callable[[int, int, Mapping[str, int]], None] | None = None,
) -> Results:
    """Evaluate the plan of a study; stored cases are not evaluated again.

    Parameters
    ----------
    study
        The definition.
    store
        The SQLite file of the results.
    executor
        Any executor of :mod:`concurrent.futures`, such as that of a Dask client. Each of its
        calls evaluates a case in a process beside it. Default: threads.
    processes
        The number of cases at a time without an executor.
    retry
        States whose cases are evaluated again, of :data:`RETRIED`.
    part
        ``(k, n)``: the k-th of n parts of the plan, for job arrays; from 1.
    cases
        A list of cases, by `moldloft study cases`: only these are evaluated.
    progress
        Called with the number of cases evaluated, of all, and the counts of states.

    Returns
    -------
    Results
        The table in the order of the plan.

    Raises
    ------
    StudyError
        For a definition that the model does not fit, and when a worker has another version.
    BusyError
        If another process runs the study.

    Notes
    -----
    A case depends on its inputs only, so the table is bit-identical for every executor.
    """
    with Cases(study) as made, Store(store, writing=True) as kept:
        plan = points(study, made.model)
        if cases:
            plan = plan[listed(study, plan, cases)]
        if retry:
            kept.forget(retry)
        if executor is None:
            check_programs(study)
        plan = plan[part[0] - 1 :: part[1]]
        keys = [made.key(point) for point in plan]
        kept.begin(
            {"model": str(study.model), "digest": made.digest, "plan": study.plan.method}, keys
        )
        known = kept.known()
        # Equal points are one case.
        missing = {key: point for key, point in zip(keys, plan, strict=True) if key not in known}
        _evaluate(made, kept, missing, executor, processes, progress)
        return kept.results()


def _evaluate(
    cases: Cases,
    store: Store,
    missing: Mapping[str, Floats],
    executor: Executor | None,
    processes: int,
    progress: Callable[[int, int, Mapping[str, int]], None] | None,
) -> None:
    if not missing:
        return
    requests = (cases.request(key, point) for key, point in missing.items())
    used = executor or ThreadPoolExecutor(processes)
    counts: dict[str, int] = {}
    try:
        for number, (request, answer) in enumerate(_answers(used, requests, processes), start=1):
            store.add(outcome(request, answer))
            counts[answer["state"]] = counts.get(answer["state"], 0) + 1
            if progress:
                progress(number, len(missing), counts)
    finally:
        end_workers()
        if executor is None:
            used.shutdown(cancel_futures=True)


def _answers(
    executor: Executor, requests: Iterator[dict[str, Any]], processes: int
) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """The answers to requests in order of completion; the number in progress is limited.

    An executor with a `bundle` is given several short cases in a call.
    """
    workers = getattr(executor, "_max_workers", None) or processes
    window = max(workers, processes) * (1 + QUEUED_PER_WORKER)
    most, size = getattr(executor, "bundle", 1), 1
    under_way: dict[Future[list[dict[str, Any]]], tuple[list[dict[str, Any]], int]] = {}
    left = True
    try:
        while left or under_way:
            while left and len(under_way) < window:
                bundle = list(islice(requests, size))
                if not bundle:
                    left = False
                    break
                under_way[executor.submit(evaluate_each, bundle)] = (bundle, 0)
            ended, _ = wait(under_way, return_when=FIRST_COMPLETED)
            for future in ended:
                bundle, lost = under_way.pop(future)
                try:
                    answers = future.result()
                except (Exception, CancelledError) as error:
                    # The executor lost the machine or the process of the call.
                    if lost < MAX_LOST:
                        for one in bundle:
                            under_way[executor.submit(evaluate_each, [one])] = ([one], lost + 1)
                        continue
                    answers = [
                        {
                            "state": CRASHED,
                            "id": "worker-lost",
                            "message": f"the worker was lost {lost + 1} times "
                            f"({type(error).__name__}: {error})",
                        }
                    ] * len(bundle)
                for answer in answers:
                    if answer.get("id") == OTHER_VERSION:
                        raise StudyError(answer["message"])
                yield from zip(bundle, answers, strict=True)
                longest = max(float(answer.get("seconds", 0.0)) for answer in answers)
                size = max(min(most, int(BUNDLE_SECONDS / max(longest, 1e-6))), 1)
    finally:
        for future in under_way:
            future.cancel()
