"""Studies on a Dask cluster: each worker is sent the model's files once.

A cluster is a scheduler that runs, processes of this machine, or jobs of a queue by
`dask-jobqueue`; the last two grow with the cases that wait and shrink when none do.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

from moldloft.errors import Error
from moldloft.study.extras import needed
from moldloft.study.workers import install

__all__ = ["QUEUES", "ClusterExecutor", "ConnectedCluster", "executor_of"]

#: Seconds in which a scheduler answers.
CONNECT_SECONDS = 10

#: Processes of a local cluster, or jobs of a queue, without a number.
USUAL_WORKERS = {"local": 2, "queue": 10}

QUEUES = {
    "slurm": "SLURMCluster",
    "pbs": "PBSCluster",
    "sge": "SGECluster",
    "lsf": "LSFCluster",
    "htcondor": "HTCondorCluster",
    "oar": "OARCluster",
}
"""The classes of `dask-jobqueue` by the name of the queue."""


class ClusterExecutor(Executor):
    """An executor of a Dask client.

    Parameters
    ----------
    client
        A ``distributed.Client``.
    workers
        The number that a cluster grows to; 0 for those that it has.
    """

    def __init__(self, client: Any, workers: int = 0) -> None:
        self.client = client
        self._of = client.get_executor(pure=False)
        self._sent: set[str] = set()
        self._max_workers = workers or max(sum(client.nthreads().values()), 1)

    bundle = 16
    """Cases of one call at most: each call costs the scheduler some milliseconds."""

    def submit(  # type: ignore[override]
        self, function: Callable[..., Any], requests: Sequence[Mapping[str, Any]]
    ) -> Future[Any]:
        """Submit some cases; the model's files are sent before the first one."""
        digest = requests[0]["digest"]
        if digest not in self._sent:
            self._send(digest, requests[0]["model"], requests[0]["root"])
            self._sent.add(digest)
        found: Future[Any] = self._of.submit(function, list(requests))
        return found

    def _send(self, digest: str, model: str, root: str) -> None:
        from distributed import WorkerPlugin

        files = {
            str(path.relative_to(root)): path.read_bytes()
            for path in sorted(Path(root).rglob("*"))
            if path.is_file()
        }
        main = str(Path(model).relative_to(root))

        def setup(plugin: Any, worker: Any) -> None:
            """Writes the files on each worker, including those that join later."""
            install(digest, files, main)

        members = {"name": f"moldloft-{digest[:16]}", "setup": setup}
        self.client.register_plugin(type("ModelFiles", (WorkerPlugin,), members)())


def executor_of(client: Any) -> ClusterExecutor:
    """The executor of a Dask client, for :func:`moldloft.study.sweep`.

    Parameters
    ----------
    client
        A ``distributed.Client``.
    """
    return ClusterExecutor(client)


class ConnectedCluster:
    """A cluster that exists for the duration of a run.

    Parameters
    ----------
    address
        ``tcp://host:port`` of a scheduler, ``local``, or the name of a queue of :data:`QUEUES`,
        whose jobs `dask-jobqueue` describes in its own configuration.
    workers
        Processes or jobs at most, for clusters that are started here; 0 for the usual number.

    Raises
    ------
    Error
        If the cluster cannot be reached or started.
    MissingPackageError
        If its package is not installed.
    """

    def __init__(self, address: str, workers: int = 0) -> None:
        distributed = needed("distributed", "cluster", "a Dask cluster")
        self._cluster: Any = None
        self._client: Any = None
        try:
            if address == "local" or address in QUEUES:
                workers = workers or USUAL_WORKERS["local" if address == "local" else "queue"]
                self._cluster = _started(distributed, address)
                self._cluster.adapt(minimum=1, maximum=workers)
                self._client = distributed.Client(self._cluster)
            else:
                workers = 0
                self._client = distributed.Client(address, timeout=CONNECT_SECONDS)
        except (OSError, TimeoutError, ValueError, RuntimeError) as error:
            self.close()
            raise Error(f"cannot reach the cluster at `{address}`: {error}") from None
        self.executor = ClusterExecutor(self._client, workers)

    def close(self) -> None:
        """Leave the cluster, and end it if it was started here."""
        for part in (self._client, self._cluster):
            if part is not None:
                part.close()

    def __enter__(self) -> ClusterExecutor:
        return self.executor

    def __exit__(self, *_: object) -> None:
        self.close()


def _started(distributed: Any, address: str) -> Any:
    """A cluster without workers yet."""
    if address == "local":
        return distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=True, dashboard_address=":0"
        )
    jobqueue = needed("dask_jobqueue", "jobqueue", f"a cluster of {address.upper()} jobs")
    return getattr(jobqueue, QUEUES[address])()
