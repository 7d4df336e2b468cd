"""A study of many cheap cases that is killed on the way, by all engines.

About 1 % of the cases end their process and 5 % are refused.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

from moldloft import study
from moldloft.errors import Error

MODEL = """
param float a = 0.5 in [0, 1]; param float b = 0.5 in [0, 1];
AbsPoint P(a, b, a * b);
if (a > 0.95) { print undefined_name; }
"""
ANALYSIS = """
import os, signal
def rare(model):
    if int(model["b"] * 1e6) % 100 == 7:
        os.kill(os.getpid(), signal.SIGKILL)
    return 2 * model["a"]
"""
DEFINITION = """
model = "box.sdl"
[inputs]
a = {}
b = {}
[outputs]
area = "P.z"
[analysis.rare]
python = "rare.py:rare"
outputs = ["twice"]
[plan]
method = "sobol"
"""


def written(folder: Path, count: int) -> Path:
    """The definition of the study, with its model and analysis beside it."""
    (folder / "box.sdl").write_text(MODEL)
    (folder / "rare.py").write_text(ANALYSIS)
    path = folder / "box.toml"
    path.write_text(f"{DEFINITION}count = {count}\n")
    return path


def known(place: Path) -> int:
    """The cases that a store has."""
    try:
        with study.Store(place) as store:
            return len(store.known())
    except Error:
        # The store is being made.
        return 0


def killed(path: Path, store: Path, count: int) -> int:
    """Runs the command on two processes, killed after a third and two thirds of the cases."""
    words = [sys.executable, "-m", "moldloft", "study", "sweep", str(path), "-q"]
    for third in (1, 2):
        with subprocess.Popen([*words, "--store", str(store)], stderr=subprocess.DEVNULL) as run:
            while known(store) < third * count // 3 and run.poll() is None:
                time.sleep(0.02)
            run.kill()
    return known(store)


def by_dask(definition: study.Study, store: Path, count: int) -> bytes:
    """The table by two workers of Dask; one is killed on the way, and both once more."""
    from distributed import Client, LocalCluster

    from moldloft.study.cluster import executor_of

    def end(client: Any, each: slice) -> None:
        for pid in list(client.run(os.getpid).values())[each]:
            os.kill(pid, signal.SIGKILL)

    def kill(client: Any) -> None:
        for third, each in ((1, slice(1)), (2, slice(None))):
            while known(store) < third * count // 3:
                time.sleep(0.05)
            end(client, each)

    with (
        LocalCluster(2, threads_per_worker=1, dashboard_address=":0") as cluster,
        Client(cluster) as client,
    ):
        killer = threading.Thread(target=kill, args=(client,), daemon=True)
        killer.start()
        table = study.sweep(definition, store, executor=executor_of(client)).csv()
        killer.join(60)
        assert not killer.is_alive()
        return table
