"""Studies on many machines: one table by all engines, clusters that grow, queues of jobs."""

from __future__ import annotations

import os
import re
import shutil
import stat
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from moldloft import study
from moldloft.cli import main
from study_campaign import by_dask, killed, written

SOAK = os.environ.get("MOLDLOFT_SOAK") == "1"

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")


def test_one_table_by_all_engines(tmp_path: Path) -> None:
    """Every sound case once and in order, whatever was killed on the way."""
    count = 10_000 if SOAK else 120
    path = written(tmp_path, count)
    definition = study.read(path)
    serial = study.sweep(definition, tmp_path / "serial.sqlite", processes=1)
    a, b = serial.inputs["a"], serial.inputs["b"]
    crashing = (a <= 0.95) & ((b * 1e6).astype(int) % 100 == 7)
    assert (serial.state == np.select([a > 0.95, crashing], ["refused", "crashed"], "done")).all()
    assert (serial.outputs["twice"][serial.done] == 2 * a[serial.done]).all()
    assert serial.counts["refused"] > 0.03 * count
    assert not SOAK or serial.counts["crashed"] > 0.005 * count
    kept = killed(path, tmp_path / "two.sqlite", count)
    left: list[int] = []
    two = study.sweep(
        definition, tmp_path / "two.sqlite", progress=lambda _, all_, __: left.append(all_)
    )
    assert two.csv() == serial.csv()
    # What was stored before the kills was not evaluated again.
    assert kept >= count // 3 and (left[0] if left else 0) == count - kept
    pytest.importorskip("distributed")
    assert by_dask(definition, tmp_path / "dask.sqlite", count) == serial.csv()


class Bundling(ThreadPoolExecutor):
    """An executor that is given short cases together, and loses each call with one of them."""

    bundle = 8

    def __init__(self, lost: float) -> None:
        super().__init__(2)
        self.lost = lost
        self.calls: list[list[float]] = []

    def submit(  # type: ignore[override]
        self, function: Callable[..., Any], requests: list[dict[str, Any]]
    ) -> Future[Any]:
        self.calls.append([request["inputs"]["a"] for request in requests])
        if self.lost not in self.calls[-1]:
            return super().submit(function, requests)
        gone: Future[Any] = Future()
        gone.set_exception(OSError("the machine is gone"))
        return gone


def test_a_case_that_loses_its_machine_costs_no_other_one(tmp_path: Path) -> None:
    definition = study.read(written(tmp_path, 64))
    serial = study.sweep(definition, tmp_path / "serial.sqlite", processes=1)
    at = int(np.flatnonzero(serial.done)[-1])
    executor = Bundling(float(serial.inputs["a"][at]))
    found = study.sweep(definition, tmp_path / "lossy.sqlite", executor=executor)
    assert 1 < max(map(len, executor.calls)) <= Bundling.bundle
    # Together with others once at most, then alone.
    assert [len(call) for call in executor.calls if executor.lost in call][1:] == [1, 1, 1]
    assert found.state[at] == "crashed"
    others = np.arange(64) != at
    assert (found.state == serial.state)[others].all()
    assert np.array_equal(
        found.outputs["twice"][others], serial.outputs["twice"][others], equal_nan=True
    )


@pytest.mark.skipif(sys.platform != "linux", reason="copies of processes are of Linux")
def test_a_crash_costs_a_copy_of_the_process(tmp_path: Path) -> None:
    """The supervising process continues, and the next case has one with all imports."""
    from moldloft.study.running import Cases
    from moldloft.study.workers import _idle, end_workers, evaluate_apart

    path = written(tmp_path, 4)
    (tmp_path / "rare.py").write_text(
        "import os\ndef rare(model):\n"
        "    if model['a'] > 0.5: os._exit(3)\n    return os.getpid()\n"
    )
    end_workers()
    with Cases(study.read(path)) as cases:
        of = [evaluate_apart(cases.request(str(a), [a, 0.1])) for a in (0.1, 0.2, 0.9, 0.3)]
        (worker,) = _idle
    end_workers()
    assert [answer["state"] for answer in of] == ["done", "done", "crashed", "done"]
    assert of[2]["message"] == "the process of the case ended (status 3)"
    first, second, last = (of[k]["outputs"]["twice"] for k in (0, 1, 3))
    assert first == second != last and not worker.alive


def test_a_local_cluster_grows_with_the_cases(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    from moldloft.study.cluster import ConnectedCluster

    definition = study.read(written(tmp_path, 60))
    serial = study.sweep(definition, tmp_path / "one.sqlite").csv()
    cluster = ConnectedCluster("local", 2)
    try:
        table = study.sweep(definition, tmp_path / "two.sqlite", executor=cluster.executor).csv()
    finally:
        cluster.close()
    assert table == serial


def commands(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Puts `moldloft` on the path, as that of this Python."""
    place = folder / "bin" / "moldloft"
    place.parent.mkdir()
    place.write_text(f'#!/bin/sh\nexec {sys.executable} -m moldloft "$@"\n')
    place.chmod(place.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{place.parent}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.chdir(folder)


def recipe(language: str, word: str) -> str:
    """A block of the page on studies that has a word."""
    text = (Path(__file__).parents[3] / "docs" / "studies.md").read_text(encoding="utf-8")
    (found,) = (b for b in re.findall(rf"```{language}\n(.*?)```", text, re.S) if word in b)
    return found.replace("yacht.toml", "box.toml")


def test_a_job_array_by_a_list_of_cases(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    written(tmp_path, 24)
    commands(tmp_path, monkeypatch)
    serial = study.sweep(study.read("box.toml"), "serial.sqlite").csv()
    assert main(["study", "cases", "box.toml", "-o", "cases.csv"]) == 0
    assert Path("cases.csv").read_text().splitlines()[0] == "case,a,b"
    Path("job.sh").write_text(recipe("sh", "SLURM_ARRAY").replace("100", "5"))
    for k in range(1, 6):
        monkeypatch.setenv("SLURM_ARRAY_TASK_ID", str(k))
        assert subprocess.run(["sh", "job.sh"]).returncode in (0, 1)
        with study.Store(f"part-{k}.sqlite") as store:
            assert 4 <= len(store.known()) <= 5
    parts = [f"part-{k}.sqlite" for k in range(1, 6)]
    capsys.readouterr()
    main(["study", "collect", "box.toml", *parts, "--store", "all.sqlite", "--csv", "all.csv"])
    assert Path("all.csv").read_bytes() == serial


@pytest.mark.skipif(shutil.which("snakemake") is None, reason="snakemake is not installed")
def test_a_workflow_of_snakemake(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written(tmp_path, 60)
    commands(tmp_path, monkeypatch)
    serial = study.sweep(study.read("box.toml"), "serial.sqlite").csv()
    Path("Snakefile").write_text(recipe("snakemake", "# Snakefile"))
    subprocess.run(["snakemake", "-c", "2", "table"], check=True)
    assert Path("yacht.csv").read_bytes() == serial
    assert len(list(Path("parts").glob("*.sqlite"))) == 3


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("a,b\n1,2\n", "expected the header `case,a,b`"),
        ("case,a,b\n", "a header and no cases"),
        ("case,a,b\n9,0.5,0.5\n", "row 2: expected a case of 1 to 8, found `9`"),
        ("case,a,b\nx,0.5,0.5\n", "row 2: expected a case of 1 to 8, found `x`"),
        ("case,a,b\n1,0.5,q\n", "row 2: could not convert"),
        ("case,a,b\n1,0.5,0.5\n", "row 2: case 1 has other inputs in the plan"),
        ("case,a,b\n1,0.5\n", "row 2: case 1 has other inputs in the plan"),
    ],
)
def test_lists_that_are_not_of_the_plan_are_refused(
    tmp_path: Path, rows: str, message: str
) -> None:
    definition = study.read(written(tmp_path, 8))
    (tmp_path / "list.csv").write_text(rows)
    with pytest.raises(study.StudyError, match=message):
        study.sweep(definition, tmp_path / "a.sqlite", cases=tmp_path / "list.csv")


#: Commands of SLURM that run a job at once on this machine.
SLURM = {
    "sbatch": """#!/bin/sh
script=$(cat "$1" 2>/dev/null || cat)
number=$$
printf '%s' "$script" > "$JOBS/$number.sh"
setsid sh "$JOBS/$number.sh" > "$JOBS/$number.log" 2>&1 &
echo $! > "$JOBS/$number.pid"
echo "Submitted batch job $number"
""",
    "scancel": """#!/bin/sh
for number in "$@"; do
  kill -TERM -- "-$(cat "$JOBS/$number.pid")" 2>/dev/null
  : > "$JOBS/$number.cancelled"
done
""",
}


def test_jobs_of_a_queue_are_the_workers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By `dask-jobqueue` as it is, with commands of SLURM that start jobs here."""
    pytest.importorskip("dask_jobqueue")
    import dask

    from moldloft.study.cluster import ConnectedCluster

    (tmp_path / "bin").mkdir()
    (tmp_path / "jobs").mkdir()
    for name, text in SLURM.items():
        place = tmp_path / "bin" / name
        place.write_text(text)
        place.chmod(place.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("JOBS", str(tmp_path / "jobs"))
    definition = study.read(written(tmp_path, 40))
    serial = study.sweep(definition, tmp_path / "one.sqlite").csv()
    job: dict[str, Any] = {
        "jobqueue.slurm.cores": 1,
        "jobqueue.slurm.memory": "1GB",
        "jobqueue.slurm.processes": 1,
        "jobqueue.slurm.log-directory": None,
        "jobqueue.slurm.local-directory": str(tmp_path),
        "jobqueue.slurm.interface": None,
        "jobqueue.slurm.python": sys.executable,
        "jobqueue.slurm.scheduler-options": {"dashboard_address": ":0"},
    }
    with dask.config.set(job):
        cluster = ConnectedCluster("slurm", 1)
        try:
            table = study.sweep(
                definition, tmp_path / "two.sqlite", executor=cluster.executor
            ).csv()
        finally:
            cluster.close()
    assert table == serial
    assert list((tmp_path / "jobs").glob("*.log"))
